//! What cannot be answered: exit code and reason.

use super::run;
use serde_json::Value;

#[test]
fn bad_input_is_named() {
    let (a, b) = (["--sweep", "A=-0.3..0.3:5"], ["--sweep", "B=-0.3..0.3:5"]);
    let cases: [(&[&str], &str); 22] = [
        (&["--set", "x=1"], "no parameter \"x\""),
        (&["--set", "A=nan"], "nan"),
        (&["--set", "A"], "NAME=VALUE"),
        (&["--set", "k=0"], "k must be a positive integer"),
        (&["--set", "k=1.5"], "k must be a positive integer"),
        (&["--set", "k=pi"], "k must be a positive integer"),
        (&["--set", "R_r=2"], "R_r"),
        (&["--set", "R_r=-0.1"], "R_r"),
        (&["--set", "c=-1"], "c"),
        (&["--set", "omega=0"], "omega"),
        (&["--set", "branch=x"], "branch is + or -"),
        (&["--set", "branch=+", "--set", "branch=-"], "branch is set twice"),
        (&["--set", "A=1", "--set", "A=2"], "A is set twice"),
        (&["--sweep", "A=0..1"], "has no count"),
        (&["--sweep", "A=0..1:0"], "a range has 1 to"),
        (&["--sweep", "k=1..3:3"], "\"k\" cannot be swept"),
        (&[a[0], a[1], a[0], a[1]], "A is swept twice"),
        (&[a[0], a[1], b[0], b[1], "--sweep", "c=0..1:2"], "at most two sweeps"),
        (&["--plot", "x.svg"], "--plot needs a --sweep"),
        (&[a[0], a[1], b[0], b[1], "--plot", "x.png"], ".svg or .csv"),
        (&[a[0], a[1], "--plot", "x.svg"], "two sweeps"),
        (&["--order", "0"], "--order"),
    ];
    for (arguments, words) in cases {
        let output = run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
        assert_eq!(message.lines().count(), 1, "{message}");
        let output = run(&[arguments, &["--format", "json"]].concat());
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let [message, hint] = ["message", "hint"].map(|key| found["error"][key].as_str().unwrap());
        assert!(format!("{message} ({hint})").contains(words), "{found}");
    }
    let file = [a[0], a[1], b[0], b[1], "--plot", "/nonexistent/x.svg"];
    assert_eq!(run(&file).status.code(), Some(5));
    assert_eq!(run(&["--digits", "20000"]).status.code(), Some(4));
}

#[test]
fn orbits_that_do_not_exist_have_no_verdict() {
    let cases: [(&[&str], &str); 5] = [
        // The free flight has the period of the force.
        (&["--set", "alpha=2", "--set", "omega=1", "--set", "c=0"], "periodic"),
        // The wall beyond the fold.
        (&["--set", "s=5"], "fold"),
        // R_r E = 1 at theta = pi.
        (&["--set", "omega=2", "--set", "R_r=1", "--set", "c=0"], "resonance"),
        // The flight passes through the wall.
        (&["--set", "omega=4.4", "--set", "k=5", "--set", "s=-0.02"], "wall"),
        (&["--set", "P0=1e-30", "--set", "s=-1"], "fold"),
    ];
    for (arguments, words) in cases {
        let output = run(&[arguments, &["--format", "json"]].concat());
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(3), "{arguments:?}: {found}");
        assert_eq!(found["orbit"]["exists"], false, "{arguments:?}");
        assert!(found["exact"]["stable"].is_null());
        assert_eq!(found["error"]["code"], "no-orbit");
        let message = found["error"]["message"].as_str().unwrap();
        assert!(message.to_lowercase().contains(words), "{arguments:?}: {message}");
    }
}
