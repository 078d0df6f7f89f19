//! Files that are no modules, or none that gonio can run.

use super::shell::{limits, mistake, open, shell};
use crate::plugins::wasm::Module;
use crate::plugins::wasm::probe::{MODULE, places, stays_level};
use std::path::Path;
use std::time::{Duration, Instant};

fn number(mut value: usize) -> Vec<u8> {
    let mut out = Vec::new();
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
    out
}

/// A module of these sections.
fn module(sections: &[(u8, Vec<u8>)]) -> Vec<u8> {
    let mut out = b"\0asm\x01\0\0\0".to_vec();
    for (id, content) in sections {
        out.push(*id);
        out.extend(number(content.len()));
        out.extend(content);
    }
    out
}

#[test]
fn files_of_other_kinds() {
    let other = |bytes: &[u8], why: &str| assert_eq!(mistake(bytes), format!("`test.wasm` {why}"));
    other(b"", "is not a WebAssembly module: it is empty");
    other(
        b"#!/bin/sh\necho",
        "is not a WebAssembly module: it begins with \"#!/bin/s\", not with \"\\0asm\"",
    );
    other(
        b"\x7fELF\x02\x01",
        "is not a WebAssembly module: it is a program or library of Linux; build it with --target=wasm32",
    );
    other(
        b"\n (module)",
        "is not a WebAssembly module: it is its text form; translate it with wat2wasm or `wasm-tools parse`",
    );
    other(b"\0asm\x02\0\0\0", "is of WebAssembly version 2; gonio runs version 1");
    other(
        b"\0asm\x0d\0\x01\0\x07",
        "is a WebAssembly component, and gonio runs core modules: build for wasm32-unknown-unknown or \
         wasm32-wasip1 (not wasip2), or leave out `wasm-tools component new`",
    );
    let missing = Module::open(Path::new("/no/such/file.wasm"), &limits()).unwrap_err().to_string();
    assert!(missing.starts_with("`/no/such/file.wasm` cannot be read: No such file"), "{missing}");
    let folder = Module::open(Path::new("/"), &limits()).unwrap_err().to_string();
    assert!(folder.starts_with("`/` cannot be read: Is a directory"), "{folder}");
}

#[test]
fn the_probe_is_its_text() {
    assert_eq!(MODULE, wat::parse_str(include_str!("../probe.wat")).unwrap());
    assert_eq!(places().unwrap().len(), 100);
    assert!(stays_level());
}

#[test]
fn a_file_that_never_ends() {
    let endless = Module::open(Path::new("/dev/zero"), &limits()).unwrap_err().to_string();
    assert_eq!(endless, "`/dev/zero` has 67108865 bytes; a module may have 67108864");
}

/// Wherever it is cut.
#[test]
fn files_that_are_cut_off() {
    let whole = shell(&[]);
    for end in 0..whole.len() {
        // Between two sections it is a module: it lacks exports, or its texts, the last of all.
        if let Err(error) = open(&whole[..end]) {
            assert!(error.to_string().len() > 30, "{error}");
        }
    }
    let why = mistake(&whole[..whole.len() - 3]);
    assert!(why.contains("is cut off: its data section has 37 bytes at byte"), "{why}");
}

#[test]
fn a_million_exports() {
    let mut exports = number(1_000_000);
    for i in 0..1_000_000 {
        let name = i.to_string();
        exports.extend(number(name.len()));
        exports.extend(name.bytes());
        exports.extend([2, 0]);
    }
    let bytes = module(&[(5, vec![1, 0, 1]), (7, exports)]);
    let begun = Instant::now();
    assert_eq!(mistake(&bytes), "`test.wasm` has 1000000 exports; gonio takes modules of at most 10000");
    assert!(begun.elapsed() < Duration::from_secs(1));
}

#[test]
fn too_many_of_other_things() {
    let many = |id: u8, count: usize, what: &str| {
        let why = mistake(&module(&[(id, number(count))]));
        assert!(why.starts_with(&format!("`test.wasm` has {count} {what}; gonio takes")), "{why}");
    };
    many(1, 10_001, "types");
    many(2, 4_000_000_000, "imports");
    many(3, 50_001, "functions");
    many(5, 2, "memories");
    many(6, 10_001, "global variables");
}

/// A few bytes of a function can declare tens of thousands of variables.
#[test]
fn too_many_local_variables() {
    let with = |functions: usize, locals: usize| {
        let body = [&[1][..], &number(locals), &[0x7c, 0x0b]].concat();
        let bodies = [number(body.len()), body].concat().repeat(functions);
        let types = [number(functions), vec![0; functions]].concat();
        let code = [number(functions), bodies].concat();
        mistake(&module(&[(1, vec![1, 0x60, 0, 0]), (3, types), (10, code)]))
    };
    let begun = Instant::now();
    let most = with(50_000, 40);
    assert!(most.contains("does not export"), "{most}");
    assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", begun.elapsed());
    assert_eq!(
        with(50_000, 30_000),
        "`test.wasm` has 2010000 local variables; gonio takes modules of at most 2000000"
    );
    assert!(with(1, 4_000_000_000).contains("has 4000000000 local variables"));
}

#[test]
fn numbers_and_sections_that_are_none() {
    assert_eq!(
        mistake(&[b"\0asm\x01\0\0\0\x01", &[0xff; 9][..]].concat()),
        "`test.wasm` is damaged: there should be a number at byte 9; build or copy it again"
    );
    let why = mistake(&module(&[(77, vec![])]));
    assert!(why.contains("is not valid WebAssembly") && why.contains("no section 77 (at byte 8)"), "{why}");
    let why = mistake(&module(&[(8, vec![0])]));
    assert!(why.contains("is not valid WebAssembly"), "{why}");
    let why = mistake(&wat::parse_str("(module (func (result v128) (v128.const i64x2 0 0)))").unwrap());
    assert!(
        why.contains("(2.0, without SIMD, threads and 64-bit memories)") && why.contains("SIMD"),
        "{why}"
    );
}

#[test]
fn exports_that_lack_or_differ() {
    assert_eq!(
        mistake(&shell(&[("gonio_error", ""), ("alloc", "")])),
        "`test.wasm` does not export `gonio_error`, `gonio_alloc`, `gonio_free`; mark each with GONIO_EXPORT \
         (C), `#[unsafe(no_mangle)] pub extern \"C\"` (Rust) or `export` (AssemblyScript); `memory` is \
         exported by the linker"
    );
    let missing = mistake(&wat::parse_str("(module)").unwrap());
    assert!(missing.contains("`gonio_error` and 3 more; mark each"), "{missing}");
    assert_eq!(
        mistake(&shell(&[("gonio_destroy", r#"(func (export "gonio_destroy") (param i64))"#)])),
        "`test.wasm` exports `gonio_destroy` as (i64) → nothing; gonio calls it as (i32) → nothing (pointers, \
         sizes and modes are i32)"
    );
    assert_eq!(
        mistake(&shell(&[("gonio_error", r#"(global (export "gonio_error") i32 (i32.const 0))"#)])),
        "`test.wasm` exports `gonio_error` as a global variable; gonio calls it as () → i32 (pointers, sizes \
         and modes are i32)"
    );
    assert_eq!(
        mistake(&shell(&[("memory", r#"(memory (export "memory") 1025)"#)])),
        "`test.wasm` begins with 65 MiB of memory; it may have 64 MiB (--memory)"
    );
}
