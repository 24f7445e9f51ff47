//! What tests cost, in CPU seconds of the program and of all that it started: the clock on the wall
//! tells how busy the machine is.

use std::error::Error;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

/// The most that one executable of tests may cost, in CPU seconds. `.ci/run` holds every one
/// against it. Generous, for a busy machine counts more: it finds the test that runs away.
pub const MOST: f64 = 600.0;

/// The CPU seconds of all programs that this process started and waited for, in steps of 0.01 s;
/// nothing where there is no `/proc`.
#[must_use]
pub fn waited_for() -> Option<f64> {
    seconds(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// From a line of proc(5): user and system time of waited-for children, fields 16 and 17, in
/// hundredths of a second. The second field, the name, may have blanks and brackets.
fn seconds(stat: &str) -> Option<f64> {
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(13);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
}

/// Runs a program to its end: how it ended, and its CPU seconds where they can be known.
///
/// # Errors
/// The program cannot be started.
pub fn run(command: &mut Command) -> std::io::Result<(ExitStatus, Option<f64>)> {
    let before = waited_for();
    let status = command.status()?;
    Ok((status, waited_for().zip(before).map(|(after, before)| after - before)))
}

/// Runs an executable of tests, says what it cost, and fails where that is more than [`MOST`]: a
/// `runner` of cargo.
///
/// # Errors
/// The executable cannot be started.
pub fn within(program: &OsStr, arguments: &[std::ffi::OsString]) -> Result<bool, Box<dyn Error>> {
    let (status, cost) = run(Command::new(program).args(arguments))?;
    let Some(cost) = cost else { return Ok(status.success()) };
    let name = Path::new(program).file_stem().unwrap_or(program).to_string_lossy();
    println!("CPU seconds: {cost:.1} of at most {MOST}, {name}");
    Ok(status.success() && cost <= MOST)
}

/// The executables of tests in what `cargo test --no-run --message-format json` prints, each with
/// the folder in which cargo would run it.
#[must_use]
pub fn executables(messages: &str) -> Vec<(PathBuf, PathBuf)> {
    let executable = |line: &str| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        let test = message["profile"]["test"].as_bool()?;
        let folder = Path::new(message["manifest_path"].as_str()?).parent()?.to_path_buf();
        test.then_some((message["executable"].as_str()?.into(), folder))
    };
    messages.lines().filter_map(executable).collect()
}

/// The tests in what an executable prints for `--list --format terse`.
pub fn tests(list: &str) -> impl Iterator<Item = &str> {
    list.lines().filter_map(|line| line.strip_suffix(": test"))
}

#[cfg(test)]
mod unit {
    use super::{executables, run, seconds, tests};
    use std::process::Command;

    #[test]
    fn lines_are_read() {
        let stat = "7 (a (b) c) S 1 2 3 4 5 6 7 8 9 10 11 12 250 50 20 0";
        assert_eq!(seconds(stat), Some(3.0));
        assert_eq!(seconds("7 (a)"), None);
        let list: Vec<_> = tests("a::b: test\nc: benchmark\n\n1 test, 1 benchmark\n").collect();
        assert_eq!(list, ["a::b"]);
        let messages = "{\"reason\":\"compiler-artifact\",\"manifest_path\":\"x/Cargo.toml\",\
                        \"profile\":{\"test\":true},\"executable\":\"y/z\"}\n{}\nwords";
        assert_eq!(executables(messages), [("y/z".into(), "x".into())]);
    }

    /// A program that counts costs something, and its end is told.
    #[test]
    #[cfg(target_os = "linux")]
    fn programs_are_measured() -> std::io::Result<()> {
        let count = "i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done; exit 3";
        let (status, cost) = run(Command::new("sh").args(["-c", count]))?;
        assert_eq!(status.code(), Some(3));
        assert!(cost.is_some_and(|cost| cost > 0.01), "{cost:?}");
        Ok(())
    }
}
