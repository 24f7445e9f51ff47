//! Ctrl-C: exit code 130, from inside an order, a step, a chart.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// It takes longer than this only where nobody looks for the interruption.
const HANGS: Duration = Duration::from_secs(60);

fn interrupted(arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lindstedt"));
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    assert!(child.try_wait().unwrap().is_none(), "{arguments:?} was done too soon");
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > HANGS {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments:?} does not stop");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn an_interruption_ends_the_work() {
    let cases: [&[&str]; 6] = [
        &["derive", "pendulum", "--order", "16"],
        &["simulate", "pendulum", "--set", "amplitude=3", "--digits", "600", "--periods", "4000"],
        &["simulate", "power-law", "--set", "n=-0.99", "--digits", "40"],
        &[
            "stability",
            "vibro-impact",
            "--sweep",
            "A=-1/3..1/3:3001",
            "--sweep",
            "B=-1/3..1/3:3001",
        ],
        &["evaluate", "power-law", "--order", "400", "--digits", "800"],
        &["paper", "--quick"],
    ];
    for arguments in cases {
        let (code, message) = interrupted(arguments);
        assert_eq!(code, Some(130), "{arguments:?}: {message}");
        assert!(message.contains("stopping after the step in progress"), "{message}");
    }
}
