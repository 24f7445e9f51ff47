//! What the threshold of a file is about: the term, the parameter, the saddles.

use super::{File, decimal};
use crate::program::refuses;

fn text(file: &File, arguments: &[&str]) -> String {
    let output = file.run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn number(value: &serde_json::Value) -> f64 {
    decimal(value).parse().unwrap()
}

/// gamma_c is a value of the whole coefficient; of a parameter, where there is just one.
#[test]
fn the_term_and_the_parameter_are_named() {
    let parameters = [("m", "2"), ("gamma", "1"), ("h", "3"), ("omega", "1"), ("delta", "1/5")];
    let file = |name: &str, force: &str| {
        let equation = format!("m x'' - m x + m x^3 = eps ({force} cos(omega t + 1) - m delta x')");
        File::new(name, &equation, &parameters)
    };
    let plain =
        File::new("plain", "x'' - x + x^3 = eps (gamma cos(omega t) - delta x')", &parameters[1..]);
    let expected = plain.json(&["--digits", "20"]);
    assert_eq!(expected["harmonic"]["term"], "cos(omega*t)");
    assert_eq!(expected["harmonic"]["parameter"], "gamma");
    assert_eq!(expected["harmonic"]["threshold"], expected["gamma_c"]);
    assert!(text(&plain, &[]).contains("gamma, the coefficient of cos(omega*t) in x''\n"));
    // gamma/m: twice as much gamma for the same coefficient.
    let heavy = file("heavy", "gamma");
    let found = heavy.json(&["--digits", "20"]);
    assert_eq!(found["gamma_c"], expected["gamma_c"]);
    assert_eq!(found["harmonic"]["parameter"], "gamma");
    assert_eq!(number(&found["harmonic"]["threshold"]), 2.0 * number(&found["gamma_c"]));
    assert!(text(&heavy, &[]).contains("gamma_c as a value of gamma"));
    // -3 gamma/m: of absolute values.
    let found = file("negative", "-3 gamma").json(&["--digits", "20"]);
    let ratio = number(&found["harmonic"]["threshold"]) / number(&expected["gamma_c"]);
    assert!((ratio - 2.0 / 3.0).abs() < 1e-15);
    // gamma h/m: of the coefficient alone; so is a sum, and what is damped by gamma, too.
    for (name, force) in [("two", "gamma h"), ("sum", "(gamma + h)"), ("square", "gamma^2")] {
        let file = file(name, force);
        let found = file.json(&["--digits", "20"]);
        assert_eq!(found["gamma_c"], expected["gamma_c"]);
        assert!(found["harmonic"]["parameter"].is_null(), "{found}");
        let shown = text(&file, &[]);
        assert!(shown.contains("a threshold of no single parameter"), "{shown}");
        assert!(!shown.contains("gamma_c as a value of"), "{shown}");
    }
    let equation = "x'' - x + x^3 = eps gamma (cos(omega t) - delta x')";
    let found = File::new("damped", equation, &parameters[1..]).json(&["--digits", "20"]);
    assert!(found["harmonic"]["parameter"].is_null());
}

/// Where the force is zero it is still the same force.
#[test]
fn forces_that_are_zero() {
    let values = |gamma: &'static str, h: &'static str| {
        [("gamma", gamma), ("h", h), ("omega", "1"), ("delta", "1/5")]
    };
    let equation =
        "x'' - x - x^2/2 + x^3 = eps (gamma cos(omega t) + gamma/2 cos(2 omega t) - delta x')";
    let loud = File::new("loud", equation, &values("1", "0")).json(&["--digits", "12"]);
    let silent = File::new("silent", equation, &values("0", "0")).json(&["--digits", "12"]);
    assert_eq!(silent["gamma_c"], loud["gamma_c"]);
    assert_eq!((&silent["amplitude"], &loud["amplitude"]), (&"0".into(), &"1".into()));
    // Two parameters: their proportion is open.
    let equation = "x'' - x + x^3 = eps (gamma cos(omega t) + h cos(2 omega t) - delta x')";
    let open = File::new("open-ratio", equation, &values("0", "0"));
    refuses(&["threshold", &open.0], 3, "which of them grows is open");
    // One of them is zero: the threshold is that of the other, and it says so.
    let other = File::new("other", equation, &values("0", "1"));
    let found = other.json(&["--digits", "12"]);
    assert_eq!(found["harmonic"]["term"], "cos(2*omega*t)");
    assert_eq!(found["harmonic"]["parameter"], "h");
    let remark = found["remarks"][0].as_str().unwrap();
    assert!(remark.contains("gamma*cos(omega*t) is zero"), "{remark}");
}

#[test]
fn the_small_parameter_is_said_to_have_no_effect() {
    let parameters = [("gamma", "1"), ("omega", "1"), ("delta", "1/5")];
    let smooth = "x'' - x + x^3 = eps (gamma cos(omega t) - delta x')";
    let file = File::new("smooth", smooth, &parameters);
    let (without, with) = (file.json(&[]), file.json(&["--set", "eps=1/100"]));
    assert_eq!(without["gamma_c"], with["gamma_c"]);
    assert_eq!(without["remarks"], serde_json::json!([]));
    assert!(with["remarks"][0].as_str().unwrap().contains("eps has no effect"));
    let dry = "x'' - x + x^3 = eps (gamma cos(omega t) - delta sign(x' - 1/5))";
    let file = File::new("dry-eps", dry, &parameters);
    let (large, small) = (file.json(&["--set", "eps=1"]), file.json(&["--set", "eps=1/1000"]));
    assert!(small["remarks"][0].as_str().unwrap().contains("only in the verdict"));
    assert_ne!(large["validity"]["verdict"], small["validity"]["verdict"]);
}

/// The orbits of every saddle. The numbers: mpmath 1.3.0, D by quadrature over x, F by the Taylor
/// series of the motion (odefun).
#[test]
fn orbits_of_all_saddles() {
    let parameters =
        [("gamma", "1"), ("omega", "1"), ("delta", "1/5"), ("mu", "1/10"), ("v", "3/10")];
    // Saddles at -1 and 1 on one level, centres at -2, 0, 2.
    let equation =
        "x'' = -x (x^2 - 1)(x^2 - 4) + eps (gamma cos(omega t) - delta (x' - v) - mu sign(x' - v))";
    let three = [
        ("right loop at x = 1", 0.816_401_019_892),
        ("left loop at x = -1", 0.816_401_019_892),
        ("upper orbit", 0.241_010_457_834),
        ("lower orbit", 0.423_940_874_711),
    ];
    // Saddles at 0 and, lower, at 3: its left loop encloses the other ones.
    let levels = "x'' = x (x - 1)(x - 3)(4 - x)(x + 2) + eps (gamma cos(omega t) - delta x')";
    let four = [
        ("right loop at x = 0", 0.866_176_940_787),
        ("left loop at x = 0", 6.363_296_249_894),
        ("right loop at x = 3", 2.030_471_447_147),
        ("left loop at x = 3", 3.643_899_991_721),
    ];
    for (name, equation, expected) in [("three", equation, three), ("levels", levels, four)] {
        let file = File::new(name, equation, &parameters);
        let found = file.json(&["--digits", "10"]);
        let orbits = found["orbits"].as_array().unwrap();
        assert_eq!(orbits.len(), 4, "{name} {found}");
        let least = expected.iter().map(|(_, gamma)| *gamma).fold(f64::INFINITY, f64::min);
        assert!((number(&found["gamma_c"]) / least - 1.0).abs() < 1e-9);
        for (orbit, gamma) in expected {
            let named = |o: &&serde_json::Value| o["name"].as_str().unwrap().starts_with(orbit);
            let entry = orbits.iter().find(named);
            let entry = entry.unwrap_or_else(|| panic!("{name}: no {orbit} in {orbits:?}"));
            let own = number(&entry["gamma_c"]);
            assert!((own / gamma - 1.0).abs() < 1e-9, "{name} {orbit}: {own} {gamma}");
            assert_eq!(entry["least"], gamma == least, "{orbit}");
        }
        if name == "three" {
            let shown = text(&file, &["--digits", "10"]);
            assert_eq!(shown.matches("(the least)").count(), 1, "{shown}");
            assert!(shown.contains("orbits of several saddles"));
        }
    }
    // A periodic force has infinitely many saddles, all alike.
    let swift = "x'' + 2 sin x = eps (gamma cos(omega t) - delta x')";
    let found = File::new("alike", swift, &parameters).json(&["--digits", "10"]);
    let names: Vec<&str> =
        found["orbits"].as_array().unwrap().iter().map(|o| o["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["upper orbit", "lower orbit"]);
    assert!(found["orbits"][0]["least"].is_null());
}

/// The range of `swept`; `fixed` is not varied.
#[test]
fn keys_of_the_file_hold_for_sweeps() {
    let body = "name = \"keys\"\nequation = \"x'' - x + x^3 = eps (gamma cos(omega t) - delta x')\"\n\
                condition = []\nfixed = [\"omega\"]\nswept = [\"delta=1/10..3/10:3\"]\n[parameters]\n\
                gamma = { value = \"1\" }\nomega = { value = \"1\" }\ndelta = { value = \"1/5\" }\n";
    let file = File::with_text("keys", body);
    let found = file.json(&["--sweep", "delta"]);
    assert_eq!(found["curve"], file.json(&["--sweep", "delta=1/10..3/10:3"])["curve"]);
    assert_eq!(found["curve"].as_array().unwrap().len(), 3);
    for arguments in [["--sweep", "omega=1..2:3"], ["--zeros", "omega=1..2"]] {
        refuses(&[&["threshold", &file.0], &arguments[..]].concat(), 2, "fixed");
    }
    // A range gives a parameter its values, where it has none of its own.
    let file = File::with_text("open", &body.replace("{ value = \"1/5\" }", "{}"));
    let [curve, zeros] =
        ["--sweep", "--zeros"].map(|range| [range, "delta=-1/10..3/10"].map(String::from));
    let points = format!("{}:3", curve[1]);
    let swept = file.json(&[&curve[0], &points]);
    let own = ["--set", "delta=1"];
    assert_eq!(swept["curve"], file.json(&[&own[..], &[&curve[0], &points]].concat())["curve"]);
    let found = file.json(&zeros.each_ref().map(String::as_str));
    assert_eq!(found["zeros"].as_array().unwrap().len(), 1);
}

/// A frequency through zero: a cosine has the same threshold at -omega, and none at 0, with the reason.
#[test]
fn values_without_a_threshold_are_blank_with_the_reason() {
    let parameters = [("gamma", "1"), ("omega", "1"), ("delta", "1/5")];
    let equation = "x'' - x + x^3 = eps (gamma cos(omega t) - delta x')";
    let file = File::new("through-zero", equation, &parameters);
    let sweep = ["--sweep", "omega=-1..1:5"];
    let doubles = [&sweep[..], &["--f64"]].concat();
    for arguments in [&sweep[..], &doubles] {
        let found = file.json(arguments);
        let value = |n: usize| found["curve"][n][1].as_f64();
        assert_eq!((value(0), value(1), value(2)), (value(4), value(3), None), "{found}");
        assert_eq!(found["curve_status"], "certified");
        let blank = &found["blanks"][0];
        assert_eq!(blank["points"], serde_json::json!([[0.0]]));
        assert_eq!(blank["reason"], "there is no harmonic force");
        let shown = text(&file, arguments);
        let head = "  omega  gamma_c with the sign of D\n";
        let count = "5 points (certified), 1 without a value\n";
        assert!(shown.contains(&format!("{count}\n{head}")), "{shown}");
        assert!(shown.contains("  0      - (there is no harmonic force)"), "{shown}");
        assert!(!shown.contains("NaN"), "{shown}");
    }
    // A range that begins there, of a frequency without a value.
    let set = ["--set", "gamma=1", "--set", "delta=1/5", "--sweep", "omega=0,1/2,1"];
    let found = crate::program::json(&[&["threshold", equation][..], &set].concat());
    assert_eq!(found["blanks"][0]["points"], serde_json::json!([[0.0]]), "{found}");
    // A potential without a loop, along the second sweep.
    let found = file.json(&["--sweep", "omega=1..2:2", "--sweep", "delta=0..1:2"]);
    assert_eq!(found["blanks"], serde_json::json!([]));
    // Section 3 by its name is an equation like any other: outside the domain of its formula too.
    for more in [&[][..], &["--f64"]] {
        let all = [&["threshold", "stick-slip", "--sweep", "omega=-1..1:5"], more].concat();
        let output = super::lindstedt(&all);
        let shown = String::from_utf8(output.stdout).unwrap();
        assert_eq!(shown.matches("- (there is no harmonic force)").count(), 1, "{shown}");
        assert!(shown.contains(", 1 without a value") && !shown.contains("NaN"), "{shown}");
        let all = [&["threshold", "stick-slip", "--sweep", "b=-1,1"], more].concat();
        let shown = String::from_utf8(super::lindstedt(&all).stdout).unwrap();
        assert!(shown.contains("- (no homoclinic") && shown.contains(", 1 without"), "{shown}");
    }
    let table = std::env::temp_dir().join(format!("lindstedt-blank-{}.csv", std::process::id()));
    text(&file, &[&sweep[..], &["--plot", table.to_str().unwrap()]].concat());
    let rows = std::fs::read_to_string(&table).unwrap();
    assert!(rows.contains("\n0.0,,\n") && !rows.contains("NaN"), "{rows}");
    let _ = std::fs::remove_file(table);
}

/// Friction without a belt and without a jump has no condition on v*.
#[test]
fn the_validity_is_that_of_the_law() {
    let parameters = [("gamma", "1"), ("omega", "1"), ("d", "1/5"), ("v", "3/10")];
    let verdict = |name: &str, friction: &str| {
        let equation = format!("x'' - x + x^3 = eps (gamma cos(omega t) - {friction})");
        let found = File::new(name, &equation, &parameters).json(&["--digits", "8"]);
        found["validity"]["verdict"].as_str().unwrap().to_owned()
    };
    let bends = "holds to first order in eps: the slope of friction jumps, friction does not";
    for (name, friction) in [
        ("square", "d x' |x'|"),
        ("bend", "d |x'|"),
        ("belt", "d (x' - v) |x' - v|"),
        ("soft", "d x'/(1 + |x'|)"),
        ("start", "d sign(x') (1 - exp(-|x'|))"),
        ("round", "d x' (1 + |x'|)^(1/2)"),
    ] {
        let words = verdict(name, friction);
        assert!(words.starts_with(bends), "{friction}: {words}");
    }
    // A jump at rest, also in a law that is more than a sign; a slope without bound.
    for (name, friction) in [
        ("dry", "d sign(x')"),
        ("stribeck", "d sign(x') (1 + exp(-|x'|))"),
        ("root", "d sign(x') |x'|^(1/2)"),
    ] {
        let words = verdict(name, friction);
        assert!(words.starts_with("fails: v* = 0"), "{friction}: {words}");
    }
    let words = verdict("viscous", "d x'");
    assert!(words.contains("the perturbation is smooth"), "{words}");
}
