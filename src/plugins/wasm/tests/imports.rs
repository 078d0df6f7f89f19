//! What modules import.

use super::shell::{call, end, eval, mistake, shell, start};
use crate::plugins::instance::{Fault, Function};

/// What `body`, which leaves an f64, gives, with these imports.
fn value(imports: &str, body: &str) -> f64 {
    let body = eval(&format!("(f64.store (local.get 5) {body}) (i32.const 0)"));
    call(&mut *start(&[("imports", imports), ("gonio_eval", &body)]).unwrap(), Function::Eval, 1).unwrap()[0]
}

#[test]
fn mathematics() {
    let one = |module: &str, name: &str, x: f64| {
        value(
            &format!(r#"(import "{module}" "{name}" (func $f (param f64) (result f64)))"#),
            &format!("(call $f (f64.const {x}))"),
        )
    };
    assert_eq!(one("env", "sin", 1.0), libm::sin(1.0));
    assert_eq!(one("env", "erf", 0.5), libm::erf(0.5));
    assert_eq!(one("env", "nearbyint", 2.5), 2.0);
    // JavaScript's, which AssemblyScript calls JSMath.
    assert_eq!(one("env", "Math.round", -2.5), -2.0);
    assert_eq!(one("env", "Math.sign", -0.25), -1.0);
    assert_eq!(one("env", "Math.abs", -0.25), 0.25);
    assert_eq!(
        value(
            r#"(import "env" "powf" (func $f (param f32 f32) (result f32)))"#,
            "(f64.promote_f32 (call $f (f32.const 2) (f32.const 0.5)))"
        ),
        f64::from(libm::powf(2.0, 0.5))
    );
    assert_eq!(value(r#"(import "env" "seed" (func $f (result f64)))"#, "(call $f)"), 0.5);
    assert!(
        value(
            r#"(import "env" "Math.max" (func $f (param f64 f64) (result f64)))"#,
            "(call $f (f64.const 1) (f64.const nan))"
        )
        .is_nan()
    );
}

#[test]
fn what_does_not_exist_is_named() {
    let import = |text: &str| mistake(&shell(&[("imports", text)]));
    let rest = "; it has the functions of C's math.h in `env`, `abort`, `trace` and `seed` of \
                AssemblyScript, and WASI preview 1 (which fails): link the rest into the module";
    assert_eq!(
        import(r#"(import "env" "asinn" (func (param f64) (result f64)))"#),
        format!("`test.wasm` imports `env.asinn`, which gonio does not have (is `env.asin` meant?){rest}")
    );
    assert_eq!(
        import(r#"(import "env" "malloc" (func (param i32) (result i32))) (import "js" "now" (func))"#),
        format!("`test.wasm` imports `env.malloc`, `js.now`, which gonio does not have{rest}")
    );
    assert_eq!(
        import(r#"(import "env" "sin" (func (param f32) (result f32)))"#),
        "`test.wasm` imports `env.sin` as (f32) → f32; it is (f64) → f64"
    );
    assert_eq!(
        import(r#"(import "env" "__indirect_function_table" (table 1 funcref))"#),
        "`test.wasm` imports the table `env.__indirect_function_table`; gonio provides functions only: let \
         the module have its own"
    );
}

#[test]
fn exit_and_abort() {
    let ends =
        |imports: &str, body: &str| end(&[("imports", imports), ("gonio_eval", &eval(body))], Function::Eval);
    assert_eq!(
        ends(
            r#"(import "wasi_snapshot_preview1" "proc_exit" (func $exit (param i32)))"#,
            "(call $exit (i32.const 3)) (i32.const 0)"
        ),
        "the module called exit(3) in eval() of 16 rows"
    );
    assert_eq!(
        ends(r#"(import "env" "abort" (func $abort))"#, "(call $abort) (i32.const 0)"),
        "the module called abort() in eval() of 16 rows"
    );
    let texts =
        r#"(data (i32.const 12) "\06\00\00\00n\00\F6\00!\00") (data (i32.const 28) "\02\00\00\00a\00")"#;
    let imports = r#"(import "env" "abort" (func $abort (param i32 i32 i32 i32)))"#;
    let body = "(call $abort (i32.const 16) (i32.const 32) (i32.const 5) (i32.const 9)) (i32.const 0)";
    assert_eq!(
        end(&[("imports", imports), ("texts", texts), ("gonio_eval", &eval(body))], Function::Eval),
        "the module called abort(\"nö!\") at a:5:9 in eval() of 16 rows"
    );
    // Texts that are none.
    let body = "(call $abort (i32.const 0) (i32.const -1) (i32.const 5) (i32.const 9)) (i32.const 0)";
    assert_eq!(ends(imports, body), "the module called abort(\"\") at :5:9 in eval() of 16 rows");
}

const FD_WRITE: &str =
    r#"(import "wasi_snapshot_preview1" "fd_write" (func $write (param i32 i32 i32 i32) (result i32)))"#;
/// Two pieces at 64: "alpha " and "is 0".
const PIECES: &str = r#"(data (i32.const 16) "alpha is 0")
    (data (i32.const 64) "\10\00\00\00\06\00\00\00\16\00\00\00\04\00\00\00")"#;

#[test]
fn what_it_said_is_told_when_it_ends() {
    let body =
        "(drop (call $write (i32.const 2) (i32.const 64) (i32.const 2) (i32.const 128))) (unreachable)";
    assert_eq!(
        end(&[("imports", FD_WRITE), ("texts", PIECES), ("gonio_eval", &eval(body))], Function::Eval),
        "the module executed `unreachable` (a panic or an assertion) in eval() of 16 rows; it said: alpha \
         is 0"
    );
    // Gigabytes of it, and not only text: the end is kept.
    let pieces = r#"(data (i32.const 262140) "a\1b[m") (data (i32.const 64) "\00\00\00\00\00\00\04\00")"#;
    let body =
        "(loop $l (drop (call $write (i32.const 1) (i32.const 64) (i32.const 1) (i32.const 128))) (br $l))
        (i32.const 0)";
    let why = end(&[("imports", FD_WRITE), ("texts", pieces), ("gonio_eval", &eval(body))], Function::Eval);
    assert!(why.contains("looped without end") || why.contains("took longer"), "{why}");
    assert!(why.ends_with("a\u{fffd}[m") && why.len() < 16_384, "{why}");
}

#[test]
fn wasi_fails() {
    let number = |imports: &str, body: &str| {
        let body = format!("(f64.convert_i32_s {body})");
        value(imports, &body)
    };
    let four = |fd: &str, count: &str| {
        format!("(call $write (i32.const {fd}) (i32.const 65528) (i32.const {count}) (i32.const -1))")
    };
    assert_eq!(number(FD_WRITE, &four("3", "1")), 8.0);
    assert_eq!(number(FD_WRITE, &four("1", "0")), 21.0);
    let two = |name: &str| {
        format!(r#"(import "wasi_snapshot_preview1" "{name}" (func $f (param i32 i32) (result i32)))"#)
    };
    assert_eq!(number(&two("random_get"), "(call $f (i32.const 64) (i32.const 8))"), 52.0);
    assert_eq!(number(&two("fd_prestat_get"), "(call $f (i32.const 3) (i32.const 64))"), 8.0);
    // Nothing in the environment, which is not a failure.
    assert_eq!(number(&two("environ_sizes_get"), "(call $f (i32.const 64) (i32.const 68))"), 0.0);
    assert_eq!(number(&two("environ_sizes_get"), "(call $f (i32.const 64) (i32.const -2))"), 21.0);
}

#[test]
fn functions_that_are_left_out_are_refused() {
    let mut it = start(&[("gonio_pdf", "")]).unwrap();
    assert_eq!(
        call(&mut *it, Function::Pdf, 1),
        Err(Fault::Refused(
            "the module does not export gonio_pdf; leave \"pdf\" out of \"has\" in its description"
                .to_owned()
        ))
    );
    assert!(call(&mut *it, Function::Eval, 1).is_ok());
}
