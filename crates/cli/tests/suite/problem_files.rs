//! Problem files on the command line: what they print and what they say.

mod bad;

use crate::program::{Folder, example, json, lindstedt, refuses, text};
use serde_json::Value;

#[test]
fn built_in_problems_run_from_their_printed_files() {
    let folder = Folder::new("printed");
    for name in ["power-law", "pendulum", "duffing", "van-der-pol"] {
        let shown = text(&["problems", "--show", name]);
        let path = folder.file("printed.toml", &shown);
        let run = |problem: &str| -> Value {
            let arguments =
                ["derive", problem, "--order", "4", "--digits", "25", "--format", "json"];
            let mut value: Value = serde_json::from_str(&text(&arguments)).unwrap();
            value["seconds"] = 0.into();
            value
        };
        assert_eq!(run(name), run(&path), "{name}");
        // And what the file prints is the same file.
        assert_eq!(text(&["problems", "--show", &path]), shown, "{name}");
    }
    for name in ["stick-slip", "vibro-impact"] {
        let shown = text(&["problems", "--show", name]);
        let path = folder.file("printed.toml", &shown);
        assert_eq!(text(&["problems", "--show", &path]), shown, "{name}");
    }
}

/// Files with a delay are averaged: order 10 leaves a residual that encloses zero, and order 1 is
/// Nayfeh and Mook's da/dt = -(g/2) a sin T, dpsi/dt = 1 + (3/8) beta a^2 - (g/2) cos T.
#[test]
fn files_with_delays_are_averaged() {
    let name = example("delayed-duffing.toml");
    let values = ["--set", "beta=1", "--set", "g=1/10", "--set", "T=1"];
    let asked = ["derive", &name, "--order", "10", "--digits", "15", "--format", "json"];
    let shown = text(&[&asked[..], &values].concat());
    let result: Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(result["residual"]["checked_orders"], 10);
    assert_eq!(result["residual"]["encloses_zero"], true);
    let coefficient = |rate: &str, term: usize| -> f64 {
        let decimal = &result["series"][rate][1][term]["coefficient"]["decimal"];
        decimal.as_str().unwrap().parse().unwrap()
    };
    let (g, delay) = (0.1f64, 1.0f64);
    assert!((coefficient("amplitude_rate", 0) + g / 2.0 * delay.sin()).abs() < 1e-15);
    assert!((coefficient("phase_rate", 0) + g / 2.0 * delay.cos()).abs() < 1e-15);
    assert_eq!(coefficient("phase_rate", 1), 0.375);
    for file in ["wright.toml", "vibro-impact.toml"] {
        let shown = text(&["derive", &example(file), "--order", "3", "--format", "json"]);
        let result: Value = serde_json::from_str(&shown).unwrap();
        assert_eq!(result["residual"]["checked_orders"], 3, "{file}");
    }
}

/// A quantity of a file beyond its domain, whatever the verb: amplitudes and delays that are not
/// positive.
#[test]
fn values_of_a_file_are_judged_like_those_given() {
    let folder = Folder::new("domain");
    let file = |equation: &str, name: &str, value: &str| {
        let text = format!(
            "name = \"a\"\nequation = \"{equation}\"\n[parameters]\n{name} = {{ value = \"{value}\" }}\n"
        );
        folder.file("a.toml", text)
    };
    let check = |path: &str, verbs: &[&str], message: &str| {
        for verb in verbs {
            refuses(&[verb, path, "--order", "2"], 3, message);
        }
    };
    let all = ["derive", "evaluate", "verify"];
    for equation in ["x'' + x + eps*x^3 = 0", "x'' + x*(x^2)^eps = 0"] {
        for (value, reason) in
            [("0", "at amplitude 0"), ("-1", "the equation with -x in place of x")]
        {
            let path = file(equation, "amplitude", value);
            check(&path, &all, &format!("amplitude = {value} is outside its domain amplitude > 0"));
            check(&path, &all, reason);
            // What would be refused does not apply.
            let shown = text(&["problems", "--show", &path]);
            for method in ["Lindstedt-Poincare", "time domain"] {
                let line =
                    shown.lines().find(|line| line.starts_with(&format!("# {method}"))).unwrap();
                assert!(line.contains(" no: amplitude = ") && line.contains(reason), "{line}");
            }
        }
        let path = file(equation, "amplitude", "1");
        refuses(&["derive", &path, "--set", "amplitude=-1/2"], 3, "in place of x");
        assert!(text(&["problems", "--show", &path]).contains("# Lindstedt-Poincare  applies"));
    }
    let output = lindstedt(&["derive", "pendulum", "--set", "amplitude=-1/2"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("in place of x") && !error.contains("at pi"), "{error}");
    for value in ["0", "-1"] {
        let path = file("x'' + x + eps*x(t - T) = 0", "T", value);
        check(&path, &["derive"], "it is a delay");
    }
}

/// The exact text of a coefficient means its decimal: a root of the stiffness is written with
/// parentheses, and taken where it is rational.
#[test]
fn roots_of_the_stiffness_are_written_as_they_are_meant() {
    let folder = Folder::new("stiffness");
    for (stiffness, first) in
        [("2/3", "(2/3)^(1/2)"), ("4/9", "2/3"), ("3", "3^(1/2)"), ("1/3", "(1/3)^(1/2)")]
    {
        let text = format!("name = \"a\"\nequation = \"x'' + {stiffness}*x + eps*x^3 = 0\"\n");
        let path = folder.file("a.toml", text);
        let shown = lindstedt(&["derive", &path, "--order", "1", "--format", "json"]);
        let value: Value = serde_json::from_slice(&shown.stdout).unwrap();
        let series = value["series"]["frequency"][0]["exact"].as_str().unwrap();
        assert_eq!(series, first);
    }
}

/// What a file asks for and the derivation does not have, and a start that it does not use.
#[test]
fn what_has_no_effect_is_said() {
    let folder = Folder::new("asked");
    let file = |asked: &str, x: &str| {
        let text = format!(
            "name = \"asked\"\nequation = \"x'' + x + eps*x^3\"\nasked = [{asked}]\n\
             [parameters]\namplitude = {{ value = \"2\" }}\n[initial]\nx = \"{x}\"\nvelocity = \"0\"\n"
        );
        folder.file("asked.toml", text)
    };
    let messages = |path: &str, more: &[&str]| {
        let output = lindstedt(&[&["derive", path, "--order", "2", "--quiet"], more].concat());
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let path = file("\"frequency\", \"growth_rate\"", "3");
    let said = messages(&path, &[]);
    assert!(said.contains("not in this result: growth_rate\n"), "{said}");
    assert!(said.contains("x = 3 of [initial] has no effect here: the amplitude is"), "{said}");
    let said = messages(&path, &["--set", "amplitude=3"]);
    assert!(!said.contains("[initial]"), "{said}");
    let path = file("\"frequency\", \"solution\"", "2");
    let said = messages(&path, &["--set", "amplitude=2"]);
    assert!(said.is_empty(), "{said}");
}

/// x = sin t from x = 0, x' = 1.
#[test]
fn a_motion_begins_as_the_file_says() {
    let folder = Folder::new("initial");
    let text = "name = \"initial\"\nequation = \"x'' + x + eps*x^3\"\n[initial]\nx = \"0\"\n\
                velocity = \"1\"\n";
    let path = folder.file("initial.toml", text);
    let all = ["simulate", &path, "--set", "eps=0", "--until", "pi/2", "--format", "json"];
    let found: Value = serde_json::from_str(&text_of(&all)).unwrap();
    let x: f64 = found["final"]["x"]["decimal"].as_str().unwrap().parse().unwrap();
    assert!((x - 1.0).abs() < 1e-12, "{found}");
}

fn text_of(arguments: &[&str]) -> String {
    text(&[arguments, &["--quiet"]].concat())
}

/// All keys are named, however long the one that is not known.
#[test]
fn the_list_of_keys_is_whole() {
    let folder = Folder::new("keys");
    for key in ["conditions".to_owned(), "k".repeat(5000)] {
        let content = format!("name = 'a'\nequation = \"x'' + x + eps*x^3\"\n{key} = 'x'\n");
        let output = lindstedt(&["derive", &folder.file("keys.toml", content)]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(":3:1: unknown field `") && error.len() < 600, "{error}");
        for known in ["name", "title", "condition", "impact", "initial", "notes", "source"] {
            assert!(error.contains(&format!("`{known}`")), "{known}: {error}");
        }
    }
}

/// Every command says which of two starts it takes, and takes it.
#[test]
fn starts_that_contradict_each_other_are_said() {
    let folder = Folder::new("starts");
    let file = |amplitude: &str, x: &str, velocity: &str| {
        let text = format!(
            "name = \"starts\"\nequation = \"x'' + x + eps*x^3\"\n[parameters]\n{amplitude}\n\
             [initial]\nx = \"{x}\"\nvelocity = \"{velocity}\"\n"
        );
        folder.file("starts.toml", text)
    };
    let half = "amplitude = { value = \"1/2\" }";
    let commands: [(&[&str], bool); 5] = [
        (&["derive", "--order", "1"], true),
        (&["verify", "--order", "1"], true),
        (&["evaluate", "--order", "1", "--set", "eps=1/10"], false),
        (&["evaluate", "--order", "1", "--set", "eps=1/10", "--normalisation", "free"], false),
        (&["simulate", "--until", "1"], false),
    ];
    let said = |path: &str, command: &[&str], more: &[&str]| {
        let output = lindstedt(&[&[command[0], path, "--quiet"], &command[1..], more].concat());
        assert!(output.status.success(), "{command:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    for (command, amplitude) in commands {
        let message = said(&file(half, "3/4", "0"), command, &[]);
        let expected = match amplitude {
            true => "x = 3/4 of [initial] has no effect here: the amplitude is 1/2",
            false => "amplitude = 1/2 is not the start here: x = 3/4, velocity = 0 of [initial] is",
        };
        assert!(
            message.contains(expected) && message.lines().count() == 1,
            "{command:?}: {message}"
        );
        // The option that is named has the other start.
        let option = message.rsplit_once(" (--").map(|(_, option)| option.trim_end());
        let option = format!("--{}", option.and_then(|o| o.strip_suffix(')')).unwrap());
        let words: Vec<&str> = option.split(' ').collect();
        let message = said(&file(half, "3/4", "0"), command, &words);
        let silent = message.is_empty() || command[0] == "evaluate" && words[0] == "--set";
        assert!(silent, "{command:?} {words:?}: {message}");
        assert_eq!(said(&file(half, "1/2", "0"), command, &[]), "", "{command:?}");
        let moving = said(&file(half, "1/2", "1"), &["simulate", "--until", "1"], &[]);
        assert!(moving.contains("velocity = 1 of [initial] is"), "{moving}");
        if !amplitude {
            // A default that nobody wrote contradicts nothing.
            assert_eq!(said(&file("", "3/4", "0"), command, &[]), "", "{command:?}");
        }
    }
    let moving = said(&file(half, "1/2", "1"), &["derive", "--order", "1"], &[]);
    assert!(moving.contains("velocity = 1 of [initial] has no effect here"), "{moving}");
}

/// A value with pi on the card is taken like one with --set. lambda = i omega_0 + eps lambda_1 of
/// lambda^2 + 2 + eps k lambda e^(-lambda T): lambda_1 = -(k/2) e^(-i omega_0 T).
#[test]
fn a_delay_with_pi_on_the_card() {
    let folder = Folder::new("card");
    let text = "name = \"card\"\nequation = \"x'' + 2*x + eps*k*x'(t - T) = 0\"\n\
                condition = \"free-amplitude\"\n[parameters]\nk = { value = \"1/2\" }\n\
                T = { value = \"pi/3\" }\n";
    let path = folder.file("card.toml", text);
    let text = text_of(&["derive", &path, "--order", "1"]);
    let number = |name: &str| -> f64 {
        let line = text.lines().find_map(|line| line.trim().strip_prefix(name)).unwrap();
        line.trim_end_matches("*a").trim().parse().unwrap()
    };
    let (sin, cos) = (2f64.sqrt() * std::f64::consts::FRAC_PI_3).sin_cos();
    assert!((number("A_1 =") + cos / 4.0).abs() < 1e-15, "{text}");
    assert!((number("B_1 =") - sin / 4.0).abs() < 1e-15, "{text}");
}

/// What a file calls fixed no sweep varies, in both kinds of expansion; what it sweeps has the file's range.
#[test]
fn sweeps_go_by_the_file() {
    let folder = Folder::new("swept");
    let text = "equation = \"x'' + x + eps*k*x^3 = 0\"\ncondition = ['initial-amplitude', 'free-amplitude']\nfixed = ['k']\nswept = ['eps=0..1/5:3']\n\
                [parameters]\nk = { value = '1' }\n";
    let path = folder.file("ranged.toml", text);
    for start in
        [&["--normalisation", "initial"][..], &["--normalisation", "free", "--start", "1,0"]]
    {
        let asked = |sweep: &'static str| {
            [
                &[
                    "evaluate", &*path, "--order", "2", "--digits", "8", "--set", "eps=1/10",
                    "--sweep", sweep,
                ],
                start,
            ]
            .concat()
        };
        refuses(&asked("k=1..2:3"), 2, "it is fixed in");
        let found = json(&asked("eps"));
        assert_eq!(found["columns"]["values"].as_array().map(Vec::len), Some(3), "{found}");
    }
}
