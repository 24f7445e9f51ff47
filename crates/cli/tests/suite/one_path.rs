//! The same question to a built-in name, to its own file, and to the library: one answer, the seconds apart.

use lindstedt::{Oscillator, Verify, Work};
use serde::Serialize;
use serde_json::Value;
use std::process::Command;

/// The answer without what a clock says.
fn masked(mut answer: Value) -> Value {
    answer.as_object_mut().unwrap().remove("seconds").unwrap();
    answer
}

fn library<T: Serialize>(answer: &T) -> Value {
    masked(serde_json::from_str(&serde_json::to_string(answer).unwrap()).unwrap())
}

fn run(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_lindstedt"))
        .args(arguments)
        .arg("--quiet")
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    output.stdout
}

fn asked(verb: &str, problem: &str, options: &[&str]) -> Value {
    let arguments = [&[verb, problem, "--format", "json"], options].concat();
    masked(serde_json::from_slice(&run(&arguments)).unwrap())
}

/// The file that the program prints of a built-in problem, in a folder of its own.
struct Printed(std::path::PathBuf);

impl Printed {
    fn new(problem: &str) -> Self {
        let name = format!("lindstedt-one-path-{}-{problem}.toml", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, run(&["problems", "--show", problem])).unwrap();
        Self(path)
    }
}

impl Drop for Printed {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Every number of an answer with its place.
fn numbers(answer: &Value) -> usize {
    match answer {
        Value::Object(map) if map.contains_key("decimal") => 1,
        Value::Object(map) => map.values().map(numbers).sum(),
        Value::Array(list) => list.iter().map(numbers).sum(),
        _ => 0,
    }
}

/// Forty numbers and more: those of the library are those of the name and of the file.
#[test]
fn name_file_and_library_answer_alike() {
    let work = Work { digits: 20, ..Work::default() };
    let digits = ["--digits", "20"];
    let mut compared = 0;
    let mut same = |library: Value, verb: &str, problem: &str, options: &[&str]| {
        let file = Printed::new(problem);
        for source in [problem, file.0.to_str().unwrap()] {
            assert_eq!(asked(verb, source, options), library, "{verb} {source} {options:?}");
        }
        compared += numbers(&library);
    };
    for problem in ["duffing", "van-der-pol", "power-law", "pendulum"] {
        let oscillator = Oscillator::builtin(problem).unwrap();
        let options = [&["--order", "3"], &digits[..]].concat();
        let derived = oscillator.derive(3, &work).unwrap();
        same(library(&derived), "derive", problem, &options);
    }
    let scaled = Oscillator::builtin("duffing").unwrap().set("amplitude", "1/3").unwrap();
    let options = [&["--order", "4", "--set", "amplitude=1/3"], &digits[..]].concat();
    same(library(&scaled.derive(4, &work).unwrap()), "derive", "duffing", &options);
    for problem in ["vibro-impact", "van-der-pol"] {
        let oscillator = Oscillator::builtin(problem).unwrap();
        let options = [&["--order", "2", "--normalisation", "free"], &digits[..]].concat();
        let averaged = oscillator.average(2, &work).unwrap();
        same(library(&averaged), "derive", problem, &options);
    }
    let oscillator = Oscillator::builtin("duffing").unwrap();
    let question = Verify { order: 2, ..Verify::default() };
    let verified = oscillator.verify(&question, &Work::default()).unwrap();
    same(library(&verified), "verify", "duffing", &["--order", "2"]);
    assert!(compared >= 40, "only {compared} numbers");
}

/// An equation in quotes is a problem; every name but those of unknowns is a parameter.
#[test]
fn an_equation_is_a_problem() {
    let equation = "x'' + x + eps*x^3 = 0";
    let work = Work { digits: 20, ..Work::default() };
    let derived = Oscillator::parse(equation).unwrap().derive(3, &work).unwrap();
    let options = ["--order", "3", "--digits", "20"];
    assert_eq!(asked("derive", equation, &options), library(&derived));
    let verdict = &asked("verify", equation, &["--order", "2"])["verdict"];
    assert_eq!(verdict, "agrees");
    let set = asked("derive", "x'' + x + eps*beta*x^3 = 0", &["--set", "beta=1/2", "--order", "1"]);
    assert_eq!(set["series"]["frequency"][1]["exact"], "3/16");
    for name in ["y", "x_2", "w", "x1"] {
        let equation = format!("x'' + x + eps*{name}*x^2 = 0");
        let program = env!("CARGO_BIN_EXE_lindstedt");
        let output = Command::new(program).args(["derive", &equation]).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {error}");
        assert!(error.contains(&format!("{name} is the name of an unknown")), "{error}");
    }
}
