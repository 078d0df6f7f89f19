//! Programs and libraries while they run.

use crate::desk::{Desk, text};
use crate::tools::tools;
use gonio::plugins::{Fault, Isolation, Program};
use std::io::Read;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// The library that does `deed` lives, has the value of one that got nothing, and these
/// incidents are told.
#[track_caller]
fn gets_nothing(deed: &str, told: &[&str]) {
    let desk = Desk::hostile();
    assert_eq!(desk.library(deed), Ok(0.25), "{deed}");
    desk.told(told);
}

/// The library that does `deed` is ended, which is told.
#[track_caller]
fn is_ended(deed: &str, how: &str, told: &[&str]) {
    let mut desk = Desk::hostile();
    desk.sandbox.allowance.disk = 20 << 20;
    desk.sandbox.allowance.processes = 8;
    let start = Instant::now();
    match desk.library(deed) {
        Err(Fault::Ended(why)) => assert!(why.contains(how), "{deed}: {why}"),
        other => panic!("{deed}: {other:?}"),
    }
    assert!(start.elapsed() < Duration::from_secs(20), "{deed}: {:?}", start.elapsed());
    desk.told(told);
}

#[test]
fn an_honest_library() {
    gets_nothing("none", &[]);
    gets_nothing("thread", &[]);
}

#[test]
fn files_of_others_are_not_there() {
    gets_nothing("rubric", &["opened /rubric.toml", "opened /source/x", "opened /neighbour/brdf.c"]);
    gets_nothing("passwd", &["opened /etc/passwd", "opened /etc/shadow"]);
}

#[test]
fn the_environment_of_gonio_is_not_there() {
    let desk = Desk::hostile();
    let _ = desk.library("environ");
    desk.told(&["opened /proc/1/environ", "opened /proc/1/cmdline"]);
}

#[test]
fn nothing_can_be_written_but_temporary_files() {
    let told = [
        "wrote /autograder/results/results.json",
        "results.json",
        "wrote /results.json",
        "wrote /usr/results.json",
    ];
    gets_nothing("results", &told);
    gets_nothing("sysctl", &["wrote /proc/sys/kernel/core_pattern"]);
    gets_nothing("remove", &["wrote /rubric.toml", "wrote /x"]);
}

#[test]
fn there_are_no_processes_but_it() {
    gets_nothing("fork", &["started a process"]);
    gets_nothing("daemon", &["started a process"]);
    gets_nothing("clone3", &["started a process"]);
    gets_nothing("shell", &["started /bin/sh", "started a process"]);
    let desk = Desk::hostile();
    desk.library("fork").unwrap();
    assert_eq!(desk.incidents()[0].times, 100);
}

#[test]
fn there_is_no_network() {
    gets_nothing("socket", &["opened a socket (IPv4)", "connected to 127.0.0.1:80"]);
    gets_nothing("local", &["connected to /run/docker.sock"]);
}

#[test]
fn nobody_else_can_be_reached() {
    gets_nothing(
        "stop",
        &["sent signal 19 to process", "sent signal 9 to process 1", "sent signal 9 to process -1"],
    );
    gets_nothing("ptrace", &["called ptrace()"]);
    gets_nothing("namespace", &["called unshare()", "called mount()"]);
    gets_nothing("filter", &["called seccomp()"]);
}

#[test]
fn limits_end_it() {
    is_ended("disk", "it was ended for more than 20 MiB of files in eval()", &["more than 20 MiB of files"]);
    is_ended("files", "more than 20 MiB of files", &["more than 20 MiB of files"]);
    is_ended("threads", "more than 64 threads", &["more than 64 threads at a time"]);
    is_ended("allocate", "more than 1024 MiB of memory", &["more than 1024 MiB of memory"]);
}

#[test]
fn it_may_not_loop_or_print_without_end() {
    is_ended("loop", "did not answer eval() of 1 rows within 5 s", &[]);
    is_ended("print", "did not answer eval()", &[]);
}

#[test]
fn processor_time_is_limited() {
    let mut desk = Desk::hostile();
    desk.sandbox.allowance.run = Some(Duration::from_secs(1));
    let why = desk.library("loop").unwrap_err().to_string();
    assert!(why.contains("it was ended for more than 1 s of processor time"), "{why}");
    desk.told(&["more than 1 s of processor time"]);
}

#[cfg(target_arch = "x86_64")]
#[test]
fn the_door_of_32_bit_programs_is_closed() {
    let desk = Desk::hostile();
    let why = desk.library("door32").unwrap_err().to_string();
    assert!(why.contains("SIGSYS"), "{why}");
    desk.told(&["called the system by another architecture's door"]);
}

/// What a Python program that does `deed` gives.
fn python(deed: &str) -> (Desk, Result<f64, Fault>) {
    let mut desk = Desk::new(&[("brdf.py", &text("hostile.py"))]);
    // Where the venv has sdk/python.
    desk.sandbox.read = vec![concat!(env!("CARGO_MANIFEST_DIR"), "/sdk/python/src").into()];
    let program = tools().python.join("python3");
    let value = desk.command(&[program.to_str().unwrap(), "brdf.py", deed]);
    (desk, value)
}

#[test]
fn honest_python() {
    for deed in ["none", "honest", "numpy", "environment"] {
        let (desk, value) = python(deed);
        assert_eq!(value, Ok(0.25), "{deed}");
        desk.told(&[]);
    }
}

#[test]
fn hostile_python() {
    for (deed, told) in [
        ("rubric", &["opened /rubric.toml", "opened /hidden.toml", "looked for /neighbour"][..]),
        ("results", &["results.json"]),
        ("fork", &["started a process"]),
        ("subprocess", &["started a process"]),
        ("socket", &["opened a socket (IPv4)"]),
        ("exec", &["started /bin/sh"]),
    ] {
        let (desk, value) = python(deed);
        assert_eq!(value, Ok(0.25), "{deed}");
        desk.told(told);
    }
}

#[test]
fn python_sees_no_file_of_others_and_its_incidents_are_bounded() {
    let (desk, value) = python("walk");
    assert_eq!(value, Ok(0.25));
    let all = desk.incidents();
    assert!(all.iter().any(|i| i.what == "more of the kind" && i.times > 10), "{all:#?}");
    assert!(all.len() < 50, "{}", all.len());
}

#[test]
fn scripts_find_their_interpreter() {
    let desk = Desk::new(&[("brdf", &format!("#!/usr/bin/env python3\n{}", text("hostile.py")))]);
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(desk.path("brdf"), std::fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(desk.command(&["./brdf", "none"]), Ok(0.25));
    desk.told(&[]);
    let desk = Desk::new(&[("run.sh", "exec python3 brdf.py none\n"), ("brdf.py", &text("hostile.py"))]);
    assert_eq!(desk.command(&["sh", "run.sh"]), Ok(0.25));
    desk.told(&[]);
}

#[test]
fn a_program_that_is_not_there() {
    let desk = Desk::new(&[]);
    let why = desk.command(&["./none"]).unwrap_err().to_string();
    assert!(why.contains("cannot start `./none`"), "{why}");
    let why = desk.command(&["no-such-program"]).unwrap_err().to_string();
    assert!(why.contains("there is no program `no-such-program` in PATH"), "{why}");
    desk.told(&[]);
}

#[test]
fn nothing_outlives_its_guard() {
    let desk = Desk::new(&[]);
    // It makes no call that the guard would have to answer.
    let code = "import time; print('runs', flush=True); time.sleep(100)";
    let words = ["/usr/bin/python3", "-c", code].map(Into::into).to_vec();
    let mut command = desk.sandbox.command(&Program::Command(words), &desk.limits).unwrap();
    let pipes = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut guard = pipes.spawn().unwrap();
    let mut said = [0; 5];
    guard.stdout.take().unwrap().read_exact(&mut said).unwrap();
    assert_eq!(&said, b"runs\n");
    guard.kill().unwrap();
    guard.wait().unwrap();
    let _ = desk.incidents();
}

#[test]
fn without_a_filter_it_gets_no_more() {
    let mut desk = Desk::hostile();
    let Isolation::Bubblewrap { unwatched, .. } = &mut desk.sandbox.isolation else { panic!() };
    *unwatched = Some("a test".into());
    for deed in ["none", "rubric", "passwd", "results", "sysctl", "daemon"] {
        assert_eq!(desk.library(deed), Ok(0.25), "{deed}");
    }
    desk.told(&[]);
    desk.sandbox.allowance.processes = 8;
    let value = desk.library("fork");
    // Forks in a row may be counted only after the answer.
    assert!(value == Ok(42.0) || value.is_err_and(|e| e.to_string().contains("more than 8 processes")));
    let _ = desk.incidents();
}

#[test]
fn without_bubblewrap_there_are_limits() {
    let mut desk = Desk::hostile().limited();
    assert_eq!(desk.library("none"), Ok(0.25));
    // It is not kept from reading: this is what the caller must warn of.
    assert_eq!(desk.library("rubric"), Ok(42.0));
    desk.told(&[]);
    desk.sandbox.allowance.processes = 8;
    desk.limits.memory = 300 << 20;
    for (deed, how) in [("fork", "more than 8 processes"), ("loop", "did not answer")] {
        let value = desk.library(deed);
        // Forks in a row may be counted only after the answer.
        assert!(value == Ok(42.0) || value.as_ref().is_err_and(|e| e.to_string().contains(how)), "{value:?}");
    }
    let _ = desk.incidents();
}
