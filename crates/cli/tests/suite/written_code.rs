//! What `evaluate --code` writes is compiled and run, and held against `evaluate`.

use crate::program::{self, Folder};
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Output};

/// Beside the program text: what prints the displacement at 0, 2, 4 and 6.
const PYTHON: &str = "
try:
    from numpy import array
    print(*displacement(array([0.0, 2.0, 4.0, 6.0])))
except ImportError:
    print(*map(displacement, (0.0, 2.0, 4.0, 6.0)))
";
const C: &str = r#"
#include <stdio.h>
int main(void)
{
    const double t[] = {0.0, 2.0, 4.0, 6.0};
    double x[4];
    displacements(4, t, x);
    return printf("%.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], x[3]) < 0;
}
"#;
const RUST: &str = r#"
fn main() {
    for t in [0.0, 2.0, 4.0, 6.0] {
        println!("{:?}", displacement(t));
    }
}
"#;

/// The same of functions of the parameters: at two points of them.
const OF_PARAMETERS: [&str; 3] = [
    "
try:
    from numpy import array
    print(*displacement(array([0.0, 2.0, 4.0, 6.0]), 0.05, array([1.0, 1.0, 2.0, 2.0])))
except ImportError:
    print(*(displacement(t, 0.05, a) for t, a in ((0.0, 1.0), (2.0, 1.0), (4.0, 2.0), (6.0, 2.0))))
",
    r#"
#include <stdio.h>
int main(void)
{
    const double t[] = {0.0, 2.0, 4.0, 6.0}, eps[] = {0.05, 0.05, 0.05, 0.05}, a[] = {1.0, 1.0, 2.0, 2.0};
    double x[4];
    displacements(4, t, eps, a, x);
    return printf("%.17g %.17g %.17g %.17g\n", x[0], x[1], x[2], x[3]) < 0;
}
"#,
    r#"
fn main() {
    for (t, a) in [([0.0, 2.0], 1.0), ([4.0, 6.0], 2.0)] {
        for x in displacements(&t, 0.05, a) {
            println!("{x:?}");
        }
    }
}
"#,
];

fn json(arguments: &[&str]) -> Value {
    let start = ["evaluate", "--quiet", "--order", "12", "--digits", "15"];
    program::json(&[&start[..], arguments].concat())
}

/// The output of a tool; nothing where this machine has it not.
fn output(folder: &Path, tool: &str, arguments: &[&str]) -> Option<Output> {
    match Command::new(tool).args(arguments).current_dir(folder).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        found => {
            let found = found.unwrap();
            let said = String::from_utf8_lossy(&found.stderr);
            assert!(found.status.success(), "{tool} {arguments:?}: {said}");
            Some(found)
        }
    }
}

/// What the program text of a language prints, run in a folder.
fn printed(
    folder: &Path,
    language: &str,
    code: &str,
    [python, c, rust]: [&str; 3],
) -> Option<Vec<f64>> {
    let (harness, file, compiler, options) = match language {
        "python" => (python, "x.py", None, &[][..]),
        "c" => (c, "x.c", Some("cc"), &["-std=c99", "-Wall", "-Werror", "x.c", "-lm"][..]),
        _ => (rust, "x.rs", Some("rustc"), &["--edition", "2024", "-D", "warnings", "x.rs"][..]),
    };
    std::fs::write(folder.join(file), [code, harness].concat()).unwrap();
    let found = match compiler {
        None => output(folder, "python3", &[file])?,
        Some(compiler) => {
            output(folder, compiler, &[options, &["-o", "x.out"]].concat())?;
            output(folder, folder.join("x.out").to_str().unwrap(), &[])?
        }
    };
    let text = String::from_utf8(found.stdout).unwrap();
    Some(text.split_whitespace().map(|number| number.parse().unwrap()).collect())
}

fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

/// Cosines and sines of a limit cycle: every language gives what `evaluate` gives, up to the deviation stated.
#[test]
fn every_language_gives_what_evaluate_gives() {
    let folder = Folder::new("code");
    let cycle = ["van-der-pol", "--set", "eps=1/5", "--harmonics", "9"];
    let found = json(&[&cycle[..], &["--times", "0..6:4"]].concat());
    let expected = found["solution"]["values"].as_array().unwrap();
    let mut run = 0;
    for language in ["python", "c", "rust"] {
        let written = json(&[&cycle[..], &["--code", language]].concat());
        let Some(x) =
            printed(&folder.0, language, written["code"].as_str().unwrap(), [PYTHON, C, RUST])
        else {
            continue;
        };
        run += 1;
        assert_eq!(x.len(), 4, "{language}");
        for (x, point) in x.iter().zip(expected) {
            let expected = &point["x"];
            let allowed = written["deviation"].as_f64().unwrap() + number(&expected["error"]);
            let distance = (x - number(&expected["decimal"])).abs();
            assert!(distance <= allowed, "{language}: {distance:e} {allowed:e}");
            assert!(allowed < 1e-6, "{language}: {allowed:e}");
        }
    }
    assert!(run > 0, "no tool on this machine");
}

/// Functions of time, the small parameter and the amplitude: where the last term is below rounding, `evaluate` with the closed
/// form of the period gives the same.
#[test]
fn functions_of_parameters_give_what_evaluate_gives() {
    let folder = Folder::new("functions");
    let at = |amplitude: &str, times: &str| {
        let set = format!("amplitude={amplitude}");
        let found = json(&["duffing", "--set", "eps=1/20", "--set", &set, "--times", times]);
        let values = found["solution"]["values"].as_array().unwrap().clone();
        values.iter().map(|point| number(&point["x"]["decimal"])).collect::<Vec<f64>>()
    };
    let expected = [at("1", "0..2:2"), at("2", "4..6:2")].concat();
    let mut run = 0;
    for language in ["python", "c", "rust"] {
        let written = json(&["duffing", "--harmonics", "25", "--functions", "--code", language]);
        assert_eq!(written["parameters"], serde_json::json!(["eps", "amplitude"]));
        let code = written["code"].as_str().unwrap();
        let Some(x) = printed(&folder.0, language, code, OF_PARAMETERS) else { continue };
        run += 1;
        assert_eq!(x.len(), 4, "{language}");
        for (place, (x, expected)) in x.iter().zip(&expected).enumerate() {
            // z = 1/20, then 1/5, where the first omitted term is 1e-9 of T.
            let allowed = if place < 2 { 1e-13 } else { 2e-8 };
            assert!((x - expected).abs() < allowed, "{language}, {place}: {x} {expected}");
        }
    }
    assert!(run > 0, "no tool on this machine");
}
