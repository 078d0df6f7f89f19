//! Programs while they are built.

use crate::desk::Desk;
use gonio::plugins::{BuildFailure, Phase};
use std::time::Duration;

const HONEST_C: &str =
    "#include <math.h>\n#include <stdio.h>\nint main(void) { printf(\"%g\\n\", sqrt(2)); return 0; }\n";

/// Building the files with `script` fails, and says so.
#[track_caller]
fn fails(desk: &Desk, script: &str, why: &str, told: &[&str]) -> BuildFailure {
    let failure = desk.sandbox.build(script, "brdf").expect_err(script);
    assert!(failure.why.contains(why), "{failure:#?}");
    desk.told(told);
    failure
}

#[test]
fn honest_builds_in_all_languages() {
    let cpp =
        "#include <vector>\n#include <iostream>\nint main() { std::vector<int> a{1}; std::cout << a[0]; }\n";
    let rust = "fn main() { println!(\"{}\", 2f64.sqrt()); }\n";
    for (file, source, script) in [
        ("brdf.c", HONEST_C, "gcc -O2 -o brdf brdf.c -lm"),
        ("brdf.c", HONEST_C, "clang -O2 -o brdf brdf.c -lm"),
        ("brdf.cpp", cpp, "g++ -O2 -o brdf brdf.cpp"),
        ("brdf.cpp", cpp, "clang++ -O2 -o brdf brdf.cpp"),
        (
            "brdf.c",
            "double one(void) { return 1; }",
            "clang --target=wasm32 -nostdlib -O2 -Wl,--no-entry -o brdf brdf.c",
        ),
        ("brdf.rs", rust, "rustc -O -o brdf brdf.rs"),
        ("brdf.c", HONEST_C, "mkdir -p out && (gcc -c -o out/a.o brdf.c & wait) && gcc -o brdf out/a.o -lm"),
    ] {
        let mut desk = Desk::new(&[(file, source)]);
        desk.sandbox.read = vec!["~/.rustup".into(), "/no/such/folder".into()];
        let made = desk.sandbox.build(script, "brdf").unwrap_or_else(|e| panic!("{script}: {e:#?}"));
        assert!(made.starts_with(b"\x7fELF") || made.starts_with(b"\0asm"), "{script}");
        desk.told(&[]);
    }
}

#[test]
fn mistakes_are_shown() {
    let desk = Desk::new(&[("brdf.c", "int main(void) { return x; }\n")]);
    let failure = fails(&desk, "gcc -o brdf brdf.c", "the build ended with exit code 1", &[]);
    assert!(failure.said.contains("brdf.c:1:25: error: ‘x’ undeclared"), "{}", failure.said);
    fails(&desk, "no-such-compiler brdf.c", "a program of it is not there", &[]);
    fails(&desk, "true", "made no `brdf`", &[]);
    fails(&desk, ": > brdf", "is empty", &[]);
    let failure = desk.sandbox.build("true", "../rubric.toml").unwrap_err();
    assert!(failure.why.contains("no path from the folder"), "{failure:?}");
}

#[test]
fn what_is_no_file_is_not_taken() {
    let desk = Desk::new(&[]);
    for script in ["ln -s /etc/passwd brdf", "ln -s ../rubric.toml brdf", "ln -s /bin/sh brdf", "mkdir brdf"]
    {
        fails(&desk, script, "is no file but a link, a folder or a device", &[]);
    }
    fails(&desk, "mkfifo brdf", "is no file but a link", &[]);
}

#[test]
fn huge_files_are_not_taken() {
    let mut desk = Desk::new(&[]);
    desk.sandbox.allowance.disk = 20 << 20;
    let more = &["more than 20 MiB of files"];
    let why = "it was ended for more than 20 MiB of files";
    fails(&desk, "head -c 30000000 /dev/zero > brdf; sleep 1", why, more);
    let two = "head -c 15000000 /dev/zero > brdf; head -c 15000000 /dev/zero > /tmp/b; sleep 1";
    fails(&desk, two, why, more);
    let failure = desk.sandbox.build("head -c 30000000 /dev/zero > brdf", "brdf").unwrap_err();
    assert!(failure.said.contains("No space left") || failure.why.contains(why), "{failure:?}");
}

#[test]
fn other_files_are_not_there() {
    let source = "#include \"/etc/passwd\"\n#include \"../rubric.toml\"\n#include \"/root/.bashrc\"\nint main(void) { return 0; }\n";
    let desk = Desk::new(&[("brdf.c", source)]);
    let failure = fails(&desk, "gcc -o brdf brdf.c", "exit code 1", &["/etc/passwd"]);
    assert!(failure.said.contains("/etc/passwd: No such file"), "{}", failure.said);
    assert!(!failure.said.contains("root:"), "{}", failure.said);
    let failure = desk.sandbox.build("clang -o brdf brdf.c", "brdf").unwrap_err();
    assert!(!failure.said.contains("root:") && !failure.said.contains("8231977"), "{}", failure.said);
    let script = "cat ../rubric.toml ../neighbour/* /source/../rubric.toml; env; cat /proc/1/environ";
    let failure = desk.sandbox.build(script, "brdf").unwrap_err();
    assert!(!failure.said.contains("8231977") && !failure.said.contains("solution"), "{}", failure.said);
    assert!(!failure.said.contains("CARGO"), "gonio's environment: {}", failure.said);
    let incidents = desk.incidents();
    assert!(incidents.iter().all(|i| i.phase == Phase::Build));
    assert!(incidents.iter().any(|i| i.what == "opened /rubric.toml"), "{incidents:#?}");
}

#[test]
fn a_build_is_private_and_leaves_nothing() {
    let desk = Desk::new(&[("brdf.c", HONEST_C)]);
    let script = "echo x > ../results.json; mkdir -p /autograder/results; echo x > /source/brdf.c; touch new /tmp/new; \
                  (setsid sleep 100 &) ; cp /bin/true brdf";
    desk.sandbox.build(script, "brdf").unwrap();
    desk.told(&["wrote /results.json", "wrote /autograder", "wrote /source/brdf.c"]);
}

#[test]
fn a_build_has_no_network() {
    let desk = Desk::new(&[("x.py", "import socket\nsocket.create_connection(('93.184.216.34', 80), 1)\n")]);
    let failure = fails(&desk, "/usr/bin/python3 x.py", "exit code 1", &["opened a socket (IPv4)"]);
    assert!(failure.said.contains("Operation not permitted"), "{}", failure.said);
}

#[test]
fn bombs_end() {
    let template = "template<int n> struct A { typename A<n * 2>::T a; typename A<n * 2 + 1>::T b; typedef A T; };\n\
                    template<int n> int f() { return f<n + 1>() + f<n + 2>(); }\nint main() { return f<0>(); }\n";
    let files = [
        ("zero.c", "#include \"/dev/zero\"\n"),
        ("huge.c", "char a[1 << 30] = {1}; int main(void) { return a[5]; }\n"),
        ("bomb.cpp", template),
        ("memory.sh", "for k in 1 2 3 4 5 6; do /usr/bin/python3 memory.py & done; wait\n"),
        ("memory.py", "import time\na = b'x' * (250 << 20)\ntime.sleep(5)\n"),
        // Nothing that is asked for: a child that ends meanwhile interrupts a call that waits.
        ("fork.sh", "f() { f | f & }; f; while :; do :; done\n"),
    ];
    let mut desk = Desk::new(&files);
    desk.sandbox.allowance.processor = Some(Duration::from_secs(2));
    desk.sandbox.allowance.clock = Some(Duration::from_secs(8));
    desk.sandbox.allowance.memory = 1 << 30;
    for script in [
        "gcc -o brdf zero.c",
        "gcc -o brdf huge.c",
        "g++ -ftemplate-depth=100000 -o brdf bomb.cpp",
        "sh fork.sh",
        "while :; do :; done",
        "yes",
        "sh memory.sh",
        "sleep 100",
    ] {
        let start = std::time::Instant::now();
        let failure = desk.sandbox.build(script, "brdf").expect_err(script);
        assert!(
            !failure.why.is_empty() && start.elapsed() < Duration::from_secs(20),
            "{script}: {failure:?}"
        );
        let ended = failure.why.contains("it was ended for") || failure.why.contains("exit code");
        assert!(ended, "{script}: {failure:?}");
    }
    let all: Vec<String> = desk.incidents().into_iter().map(|i| i.what).collect();
    for part in [
        "64 processes at a time",
        "2 s of processor time",
        "1 MiB of messages",
        "1024 MiB of memory",
        "more than 8 s",
    ] {
        assert!(all.iter().any(|what| what.contains(part)), "no `{part}` in {all:#?}");
    }
}

#[test]
fn without_bubblewrap() {
    let desk = Desk::new(&[("brdf.c", HONEST_C)]).limited();
    assert!(desk.sandbox.build("gcc -o brdf brdf.c -lm", "brdf").unwrap().starts_with(b"\x7fELF"));
    fails(&desk, "ln -s /etc/passwd brdf", "is no file but a link", &[]);
    let mut desk = desk;
    desk.sandbox.allowance.clock = Some(Duration::from_secs(1));
    fails(&desk, "(setsid sleep 100 &); sleep 100", "it was ended for more than 1 s", &["more than 1 s"]);
}
