//! The smallest module that can be measured, to be changed in one place at a time.

use crate::bsdf::Transport;
use crate::plugins::Limits;
use crate::plugins::instance::{Call, Fault, Function, Instance};
use crate::plugins::wasm::{Module, ModuleError};
use std::time::Duration;

/// Its parts: eval is 0 everywhere, and nothing else is worth calling.
const PARTS: [(&str, &str); 10] = [
    ("memory", r#"(memory (export "memory") 4)"#),
    ("texts", r#"(data (i32.const 16) "{\"protocol\":1}\00") (data (i32.const 64) "not today\00")"#),
    (
        "gonio_describe",
        r#"(func (export "gonio_describe") (param i32) (result i32)
        (select (i32.const 16) (i32.const 0) (i32.eqz (local.get 0))))"#,
    ),
    ("gonio_create", r#"(func (export "gonio_create") (param i32 i32) (result i32) (i32.const 7))"#),
    (
        "gonio_eval",
        r#"(func (export "gonio_eval") (param i32 i32 i32 i32 i32 i32) (result i32) (i32.const 0))"#,
    ),
    (
        "gonio_pdf",
        r#"(func (export "gonio_pdf") (param i32 i32 i32 i32 i32 i32) (result i32) (i32.const 0))"#,
    ),
    (
        "gonio_sample",
        r#"(func (export "gonio_sample") (param i32 i32 i32 i32 i32 i32 i32 i32 i32) (result i32)
        (i32.const 0))"#,
    ),
    ("gonio_destroy", r#"(func (export "gonio_destroy") (param i32))"#),
    ("gonio_error", r#"(func (export "gonio_error") (result i32) (i32.const 64))"#),
    (
        "alloc",
        r#"(func (export "gonio_alloc") (param i32) (result i32) (i32.const 4096))
        (func (export "gonio_free") (param i32 i32))"#,
    ),
];

/// The shell with other parts, or with more of them.
pub fn shell(changes: &[(&str, &str)]) -> Vec<u8> {
    let changed = |name: &str| changes.iter().find(|(part, _)| *part == name).map(|(_, text)| *text);
    let more = changes.iter().filter(|(name, _)| PARTS.iter().all(|(part, _)| part != name));
    let parts = PARTS.iter().map(|(name, text)| changed(name).unwrap_or(text));
    // Imports come first in the text form, and only they are additions.
    let text: Vec<&str> = more.map(|(_, text)| *text).chain(parts).collect();
    wat::parse_str(format!("(module {})", text.join("\n"))).expect("the text of a test's module")
}

/// An eval whose body is `body`.
pub fn eval(body: &str) -> String {
    format!(
        r#"(func $eval (export "gonio_eval") (param i32 i32 i32 i32 i32 i32) (result i32) (local i64) {body})"#
    )
}

/// Small limits, so that tests of them end soon.
pub fn limits() -> Limits {
    Limits { call: Duration::from_secs(1), memory: 64 << 20, ..Limits::default() }
}

/// The module `bytes`, within [`limits`].
pub fn open(bytes: &[u8]) -> Result<Module, ModuleError> {
    Module::compile("test.wasm", bytes, &limits())
}

/// The error of the module `bytes`.
pub fn mistake(bytes: &[u8]) -> String {
    open(bytes).expect_err("a module with a mistake").to_string()
}

/// An instance of the shell with changes.
pub fn start(changes: &[(&str, &str)]) -> Result<Box<dyn Instance>, Fault> {
    open(&shell(changes)).expect("a module without mistakes").start()
}

/// Calls `function` with `rows` rows of zeros, three numbers in each.
pub fn call(instance: &mut dyn Instance, function: Function, rows: usize) -> Result<Vec<f64>, Fault> {
    let input = vec![0.0; 3 * rows];
    let call = Call {
        function,
        handle: 7,
        transport: Transport::Radiance,
        wo: [0.0, 0.0, 1.0],
        rows,
        channels: 1,
        input: &input,
    };
    let mut answer = vec![0.0; call.answer()];
    instance.call(&call, &mut answer)?;
    Ok(answer)
}

/// Of what a call of the shell with `changes` dies; that the instance is gone with it.
pub fn end(changes: &[(&str, &str)], function: Function) -> String {
    let mut instance = start(changes).expect("an instance");
    let Err(Fault::Ended(why)) = call(&mut *instance, function, 16) else {
        panic!("the instance should have ended");
    };
    let Err(Fault::Ended(again)) = instance.describe() else {
        panic!("an instance that has ended should not answer");
    };
    assert_eq!(again, format!("the module has ended before: {why}"));
    why
}
