//! Modules that do harm while they run: each is stopped soon, and told by name.

use super::shell::{call, end, eval, open, shell, start};
use crate::plugins::instance::{Fault, Function};
use std::time::{Duration, Instant};

/// Of what an eval with this body dies.
fn end_of_eval(body: &str) -> String {
    end(&[("gonio_eval", &eval(body))], Function::Eval)
}

#[test]
fn loops_without_end() {
    assert_eq!(
        end_of_eval("(loop $l (br $l)) (i32.const 0)"),
        "the module looped without end: used 100160000 units of fuel in eval() of 16 rows (raise \
         --call-limit if it only needs longer)"
    );
}

/// The number of units does not depend on the machine, nor on what ran before.
#[test]
fn fuel_is_the_same_every_time() {
    // Fuel grows with the rows, and what is used grows faster: at some number it is not enough.
    let body = "(local.set 6 (i64.mul (i64.extend_i32_u (local.get 3)) (i64.const 600000)))
        (loop $l (br_if $l (i64.ne (i64.const 0) (local.tee 6 (i64.sub (local.get 6) (i64.const 1))))))
        (i32.const 0)";
    let changes = [("gonio_eval", &*eval(body))];
    let most = |warm: bool| {
        (1..).map(|i| 8 * i).find(|rows| {
            let mut it = start(&changes).unwrap();
            if warm {
                call(&mut *it, Function::Eval, 8).unwrap();
            }
            call(&mut *it, Function::Eval, *rows).is_err()
        })
    };
    assert_eq!(most(false), most(true));
}

#[test]
fn what_is_slower_than_its_fuel_is_stopped_by_the_clock() {
    // The sine of a number that takes a long time to bring into one turn.
    let sine = r#"(import "env" "sin" (func $sin (param f64) (result f64)))"#;
    let body = eval("(loop $l (drop (call $sin (f64.const 1e300))) (br $l)) (i32.const 0)");
    let begun = Instant::now();
    assert_eq!(
        end(&[("imports", sine), ("gonio_eval", &body)], Function::Eval),
        "the module took longer than 1 s in eval() of 16 rows (raise --call-limit if it only needs longer)"
    );
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
}

#[test]
fn memory_without_end() {
    // As much as there is, and then a panic.
    assert_eq!(
        end_of_eval(
            "(loop $l (br_if $l (i32.ne (i32.const -1) (memory.grow (i32.const 16))))) (unreachable)"
        ),
        "the module wanted more than 64 MiB of memory, and then executed `unreachable` (a panic or an \
         assertion) in eval() of 16 rows"
    );
    // As much as there is, again and again.
    let why = end_of_eval("(loop $l (drop (memory.grow (i32.const 1))) (br $l)) (i32.const 0)");
    assert!(why.starts_with("the module wanted more than 64 MiB of memory, and then looped"), "{why}");
    // Refused, and no harm done.
    let mut it =
        start(&[("gonio_eval", &eval("(drop (memory.grow (i32.const 65535))) (i32.const 0)"))]).unwrap();
    assert!(call(&mut *it, Function::Eval, 16).is_ok());
}

#[test]
fn tables_do_not_grow() {
    let grow = "(drop (table.grow $t (ref.null func) (i32.const 100000000))) (i32.const 0)";
    let mut it = start(&[("a table", "(table $t 1 funcref)"), ("gonio_eval", &eval(grow))]).unwrap();
    assert!(call(&mut *it, Function::Eval, 16).is_ok());
}

/// Instructions that do more than compute, each without end: none takes so much of
/// gonio's own stack that it overflows before the fuel ends.
#[test]
fn no_instruction_takes_the_stack_of_gonio() {
    let more = r#"(import "env" "sin" (func $sin (param f64) (result f64)))
        (table $t 4 4 funcref) (table $s 4 funcref) (elem $e func $nothing) (data $d "abcd")
        (global $g (mut i64) (i64.const 0)) (type $nothing (func)) (func $nothing)
        (elem (i32.const 1) func $nothing)"#;
    let range = "(i32.const 0) (i32.const 0) (i32.const 0)";
    for body in [
        "(drop (memory.grow (i32.const 0)))",
        "(drop (memory.grow (i32.const 1)))",
        "(drop (memory.grow (i32.const -1)))",
        "(drop (memory.size))",
        &format!("(memory.copy {range})"),
        &format!("(memory.fill {range})"),
        &format!("(memory.init $d {range})"),
        "(data.drop $d)",
        "(drop (table.grow $t (ref.null func) (i32.const 0)))",
        "(drop (table.grow $t (ref.null func) (i32.const 1)))",
        "(drop (table.grow $s (ref.null func) (i32.const 1)))",
        "(drop (table.size $t))",
        "(table.set $t (i32.const 0) (table.get $t (i32.const 1)))",
        &format!("(table.copy $t $s {range})"),
        "(table.fill $t (i32.const 0) (ref.null func) (i32.const 2))",
        &format!("(table.init $t $e {range})"),
        "(elem.drop $e)",
        "(drop (ref.is_null (ref.func $nothing)))",
        "(global.set $g (i64.add (global.get $g) (i64.const 1)))",
        "(call $nothing)",
        "(call_indirect $t (type $nothing) (i32.const 1))",
        "(drop (call $sin (f64.const 1)))",
        "(block $a (block $b (br_table $a $b (local.get 3))))",
        "(drop (f64.nearest (f64.floor (f64.convert_i32_s (local.get 3)))))",
    ] {
        let body = format!("(loop $l {body} (br $l)) (i32.const 0)");
        let why = end(&[("more", more), ("gonio_eval", &eval(&body))], Function::Eval);
        assert!(why.contains("looped without end") || why.contains("took longer"), "{body}: {why}");
    }
}

#[test]
fn what_cannot_be_interrupted_is_not_run() {
    let body = "(drop (memory.grow (i32.const 0)))".repeat(100_000) + "(i32.const 0)";
    assert_eq!(
        end_of_eval(&body),
        "the module has a stretch without a branch in eval() of 16 rows, which uses 25600002 units of fuel and \
         cannot be interrupted; write it as a loop"
    );
    // All of a memory at once is much, and not too much.
    let memory = r#"(memory (export "memory") 1024)"#;
    let body = eval("(memory.fill (i32.const 0) (i32.const 1) (i32.const 0x4000000)) (i32.const 0)");
    let mut it = start(&[("memory", memory), ("gonio_eval", &body)]).unwrap();
    assert!(call(&mut *it, Function::Eval, 16).is_ok());
}

#[test]
fn outside_of_memory() {
    assert_eq!(
        end_of_eval("(drop (i32.load (i32.const -8))) (i32.const 0)"),
        "the module read or wrote outside its memory in eval() of 16 rows"
    );
    assert_eq!(
        end_of_eval("(memory.fill (i32.const 8) (i32.const 0) (i32.const -1)) (i32.const 0)"),
        "the module read or wrote outside its memory in eval() of 16 rows"
    );
}

#[test]
fn recursion_without_end() {
    let deeper =
        "(call $eval (local.get 0) (local.get 1) (local.get 2) (local.get 3) (local.get 4) (local.get 5))";
    let why = "the module recursed without end in eval() of 16 rows";
    assert_eq!(end_of_eval(&format!("(i32.add (i32.const 1) {deeper})")), why);
    // Many values in each call: the stack of values ends before that of calls.
    let locals = "(local i64 i64 i64 i64 i64 i64 i64 i64)".repeat(1000);
    assert_eq!(end_of_eval(&format!("{locals} (i32.add (i32.const 1) {deeper})")), why);
}

#[test]
fn traps() {
    let told = |did: &str| format!("the module {did} in eval() of 16 rows");
    assert_eq!(end_of_eval("(unreachable)"), told("executed `unreachable` (a panic or an assertion)"));
    assert_eq!(end_of_eval("(i32.div_u (i32.const 1) (i32.const 0))"), told("divided by zero"));
    assert_eq!(
        end_of_eval("(i32.div_s (i32.const 0x80000000) (i32.const -1))"),
        told("divided the smallest integer by -1")
    );
    assert_eq!(
        end_of_eval("(i32.trunc_f64_s (f64.const nan))"),
        told("converted to an integer what is none (NaN, or too large)")
    );
    let pointer = |index: &str, did: &str| {
        let body = format!("(call_indirect (result i32) (i32.const {index}))");
        let table = "(table 2 funcref) (elem (i32.const 0) func $eval)";
        assert_eq!(
            end(&[("gonio_eval", &(eval(&body) + table))], Function::Eval),
            told(&format!("called a function pointer {did}"))
        );
    };
    pointer("0", "as a function of another type");
    pointer("1", "that is null");
    pointer("2", "that is outside its table");
}

#[test]
fn errors_that_the_module_tells_do_not_end_it() {
    let mut it = start(&[("gonio_eval", &eval("(i32.const 3)"))]).unwrap();
    let not_today = Err(Fault::Refused("not today".to_owned()));
    assert_eq!(call(&mut *it, Function::Eval, 16), not_today);
    assert_eq!(call(&mut *it, Function::Eval, 16), not_today);
    assert!(call(&mut *it, Function::Pdf, 16).is_ok());

    let silent = [
        ("gonio_error", r#"(func (export "gonio_error") (result i32) (i32.const 0))"#),
        ("gonio_eval", &*eval("(i32.const 3)")),
    ];
    assert_eq!(
        call(&mut *start(&silent).unwrap(), Function::Eval, 16),
        Err(Fault::Refused("eval() of 16 rows failed, and gonio_error() does not say why".to_owned()))
    );
}

#[test]
fn addresses_that_are_none() {
    let alloc = |address: &str| {
        let text = format!(
            r#"(func (export "gonio_alloc") (param i32) (result i32) (i32.const {address}))
               (func (export "gonio_free") (param i32 i32))"#
        );
        match call(&mut *start(&[("alloc", &text)]).unwrap(), Function::Eval, 16) {
            Err(Fault::Ended(why) | Fault::Refused(why)) => why,
            Ok(_) => panic!("{address} should not have been taken"),
        }
    };
    assert_eq!(alloc("0"), "gonio_alloc(536) returned 0: the module found no memory in its 262144 bytes");
    assert_eq!(
        alloc("-16"),
        "the module returned address 4294967280 in gonio_alloc(536): its memory ends at 262144"
    );
    assert_eq!(
        alloc("261640"),
        "the module returned address 261640 in gonio_alloc(536): its memory ends at 262144"
    );
    assert_eq!(alloc("12"), "the module returned address 12 in gonio_alloc(536): not a multiple of 8");

    let describe = |address: &str| {
        let text =
            format!(r#"(func (export "gonio_describe") (param i32) (result i32) (i32.const {address}))"#);
        start(&[("gonio_describe", &text)]).unwrap().describe().unwrap_err().to_string()
    };
    assert_eq!(
        describe("-1"),
        "the module returned a text at address 4294967295 in describe(): its memory ends at 262144"
    );
    assert_eq!(describe("0"), "not today");
    let endless = [
        ("memory", r#"(memory (export "memory") 40)"#),
        (
            "gonio_eval",
            &*eval("(memory.fill (i32.const 1024) (i32.const 65) (i32.const 2000000)) (i32.const 1)"),
        ),
        ("gonio_error", r#"(func (export "gonio_error") (result i32) (i32.const 4096))"#),
    ];
    assert_eq!(
        end(&endless, Function::Eval),
        "the module returned a text in gonio_error() that does not end with 0 within 1048576 bytes"
    );
}

#[test]
fn too_many_rows_for_the_memory_are_refused() {
    let alloc = r#"(func (export "gonio_alloc") (param i32) (result i32)
            (if (i32.eq (i32.const -1) (memory.grow (i32.const 65000))) (then (return (i32.const 0))))
            (unreachable))
        (func (export "gonio_free") (param i32 i32))"#;
    assert_eq!(
        call(&mut *start(&[("alloc", alloc)]).unwrap(), Function::Eval, 16),
        Err(Fault::Refused("the module wanted more than 64 MiB of memory in gonio_alloc(536)".to_owned()))
    );
}

#[test]
fn start_functions_are_limited_too() {
    let spin = "(func $spin (loop $l (br $l)))";
    for text in [format!("{spin} (start $spin)"), format!(r#"{spin} (export "_initialize" (func $spin))"#)] {
        let begun = Instant::now();
        let Err(Fault::Ended(why)) = start(&[("gonio_eval", &(eval("(i32.const 0)") + &text))]) else {
            panic!("it should have ended")
        };
        assert!(why.contains("units of fuel in its start function"), "{why}");
        assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
    }
}

#[test]
fn start_functions_run_and_command_starts_do_not() {
    let count = r#"(global $n (mut i32) (i32.const 0))
        (func $once (global.set $n (i32.add (global.get $n) (i32.const 1))))
        (start $once) (export "_initialize" (func $once)) (func (export "_start") (unreachable))"#;
    // 0, no error, if both have run; the start section is in front of and behind the exports.
    let body = eval("(i32.ne (i32.const 2) (global.get $n))");
    let mut it = start(&[("gonio_eval", &(body + count))]).unwrap();
    assert!(call(&mut *it, Function::Eval, 1).is_ok());
}

#[test]
fn segments_outside_of_memory() {
    let data = r#"(data (i32.const 262143) "xyz")"#;
    let Err(Fault::Ended(why)) = open(&shell(&[("texts", data)])).unwrap().start() else {
        panic!("it should not start")
    };
    assert!(why.starts_with("the module cannot be started: "), "{why}");
}
