//! Motions and expansions of problem files against closed forms: forces with a phase, masses, parameters that
//! follow, sweeps that are resumed, inelastic walls, exponents of motions that are no chaos.

use crate::program::{Folder, example, float, json, lindstedt, refuses, text};

/// x'' + x'/5 + x = cos(w t): |H| = 1/sqrt((1 - w^2)^2 + w^2/25) at every phase; the file of a sweep
/// belongs to one equation.
#[test]
fn a_resumed_sweep_belongs_to_one_equation() {
    let folder = Folder::new("resume");
    let points = folder.0.join("points");
    let points = points.to_str().unwrap();
    let sweep =
        ["--sweep", "w=1/2..1:2", "--section", "velocity", "--skip", "300", "--periods", "2"];
    let run = |damping: &str, resume: &str| {
        let path = folder.problem(&format!("x'' + x + {damping}*x' = cos(w*t)"), &[("w", "1")], "");
        let all = [&["simulate", &path], &sweep[..], &["--resume", resume]].concat();
        lindstedt(&all)
    };
    let found = run("1/5", points);
    let found = String::from_utf8(found.stdout).unwrap();
    assert!(found.contains("1.321637201") && found.contains("5.000000000"), "{found}");
    let other = run("1/2", points);
    assert_eq!(other.status.code(), Some(5));
    let fresh = run("1/2", folder.0.join("fresh").to_str().unwrap());
    let fresh = String::from_utf8(fresh.stdout).unwrap();
    assert!(fresh.contains("1.264911064") && fresh.contains("2.000000000"), "{fresh}");
}

/// Products and functions of harmonics may have a shorter period than these have together: |cos t| that of pi, eps 1/4.
#[test]
fn products_of_harmonics_have_their_period() {
    let section = ["--section", "stroboscopic", "--periods", "2", "--state", "1/2,0", "--f64"];
    let section = [&section[..], &["--set", "eps=1/4"]].concat();
    let eps = "eps*x^3 + x'/5 + x";
    for (equation, frequency) in [
        ("x'' + {} = cos(3*t/2 + 1/3)", 1.5),
        ("x'' + {} = cos(t) + cos(3/2*t)/5", 0.5),
        ("x'' + {} = 2*cos(3*t/5)^2 - 1", 1.2),
        ("x'' + {} = x*abs(cos(t))", 2.0),
        ("x'' + {} = cos(t)*cos(t/3 + 1)", 2.0 / 3.0),
        ("x'' + {} = cos(t)*(x + cos(t/3))", 1.0 / 3.0),
        ("x'' + {} = 16*cos(t)^5 - 20*cos(t)^3 + 5*cos(t)", 5.0),
        ("x'' + {} + sin(x + cos(t)^2) = 0", 2.0),
        ("x'' + {} = cos((3 + eps)*t)*cos((3 + eps)*t + 1)", 6.5),
        ("x'' + {} = cos(t) + x*sign(x - cos(t))/5", 1.0),
        // What acts for one sign of a state or of a parameter, or for a moment.
        ("x'' + {} = (abs(x) - x)*cos(t)/4 + cos(2*t)", 1.0),
        ("x'' + {} = (1 - sign(x'))*cos(t)/4 + cos(2*t)", 1.0),
        ("x'' + {} = (sign(x - 2) + 1)*cos(t) + cos(2*t)", 1.0),
        ("x'' + {} = sign(cos(t) - 999/1000) + cos(2*t)", 1.0),
        ("x'' + {} = sign(cos(t))*cos(t)", 2.0),
    ] {
        let equation = equation.replace("{}", eps);
        let found = json(&[&["simulate", &equation], &section[..]].concat());
        let time = found["section"]["points"][0][0].as_f64().unwrap();
        let turns = time * frequency / (2.0 * std::f64::consts::PI);
        assert!((turns - 1.0).abs() < 1e-12, "{equation}: {time}");
    }
    for force in ["cos(t)^2 + sin(t)^2", "cos(t) + cos(sqrt(2)*t)"] {
        let equation = format!("x'' + {eps} = {force}");
        let words = "no force with one period";
        refuses(&[&["simulate", &equation], &section[..]].concat(), 2, words);
    }
    let two = ["simulate", "x'' + x + eps*y = cos(2*t); y'' + 2*y = eps*x - cos(3*t)"];
    let found = json(&[&two[..], &section[..4], &section[6..]].concat());
    let time = found["section"]["points"][0][0].as_f64().unwrap();
    assert!((time - 2.0 * std::f64::consts::PI).abs() < 1e-12, "{time}");
}

/// cos(w t + p) has the period of cos(w t), whatever the frequency is made of.
#[test]
fn forces_with_a_phase_have_their_period() {
    let folder = Folder::new("phase");
    let frequencies = [("w1", "1/4"), ("w2", "1/4"), ("p", "1")];
    for force in ["cos(t/2 + 1)", "cos((w1 + w2)*t + p)", "sin(w1*(t + 4*p) + w2*t + pi/2)"] {
        let equation = format!("x'' + x + x'/5 = {force}").replace("pi/2", "1.5");
        let path = folder.problem(&equation, &frequencies, "");
        let found = json(&["simulate", &path, "--section", "stroboscopic", "--periods", "2"]);
        let points = found["section"]["points"].as_array().unwrap();
        let time = points[0][0].as_f64().unwrap();
        assert!((time - 4.0 * std::f64::consts::PI).abs() < 1e-12, "{force}: {time}");
    }
    // Averaging in amplitude and phase takes harmonics of one frequency, and says so; others go to the slow flow.
    for (force, taken) in [
        ("cos(3*w1*t) + sin(t*w1/2)", true),
        ("cos(w1*t) + cos(w2*t)", false),
        ("cos(w1*t + 1)", false),
    ] {
        let path = folder.problem(&format!("x'' + x + eps*x' = {force}"), &frequencies, "");
        let output = lindstedt(&["derive", &path, "--order", "1"]);
        assert!(output.status.success());
        let page = String::from_utf8(output.stdout).unwrap();
        assert_eq!(page.contains("a' = A_1(a)*eps"), taken, "{force}: {page}");
        let shown = text(&["problems", "--show", &path]);
        assert_eq!(shown.contains("averaging (KBM)     applies"), taken, "{shown}");
    }
    let path = folder.problem("x'' + x + x'/5 = cos((w1 + w2)*t)", &frequencies, "");
    refuses(&["simulate", &path, "--set", "w1=-1"], 3, "w1 + w2, is outside its domain");
}

/// m x'' + eps c x' + k x + eps k3 x^3 = p cos(w t) averaged: A_1 = -c a/(2 m), and B_1 =
/// (3 k3/(8 m w0)) (a^2 + 2 P^2), P = p/(k - m w^2); the motion in time agrees. Also a factor that is
/// not multiplied out, with a force at order zero in it.
#[test]
fn masses_are_averaged() {
    let folder = Folder::new("mass");
    let all = [("m", "2"), ("c", "1"), ("k", "8"), ("k3", "1"), ("p", "1"), ("w", "5")];
    let equation = "m x'' + eps c x' + k x + eps k3 x^3 = p cos(w t)";
    let typed = "2*x'' + eps*x' + 8*x + eps*x^3 = cos(5*t)";
    let factored = "x'' + (1/m)*(eps*x' + k*x + eps*x^3 - cos(5*t)) = 0";
    let derived = |equation: &str| {
        let path = folder.problem(equation, &all, "");
        let found = text(&["derive", &path, "--order", "2"]);
        let start = found.find("  u_0").unwrap();
        assert!(found.contains("A_1 = -1/4*a\n"), "{found}");
        found[start..].to_owned()
    };
    let expected = derived(typed);
    assert_eq!(derived(equation), expected);
    assert_eq!(derived(factored), expected);
    // No rational frequency: in balls.
    let path = folder.problem(equation, &all, "");
    let judged = text(&["verify", &path, "--set", "m=3", "--order", "1"]);
    assert!(judged.contains("agrees: observed order"), "{judged}");
    let spring = &*example("impact-spring");
    assert!(text(&["derive", spring, "--order", "1"]).contains("encloses zero at orders 0 to 1"));
}

/// b = 2 a is put in its place by every command.
#[test]
fn parameters_that_follow() {
    let folder = Folder::new("follows");
    let path = folder.problem("x'' + x + eps*b*x^3 = 0", &[("a", "1/2")], "");
    let file = std::fs::read_to_string(&path).unwrap() + "b = { follows = \"2*a\" }\n";
    std::fs::write(&path, file).unwrap();
    let sets = ["--set", "eps=1/2", "--digits", "12"];
    let own = json(&[&["evaluate", &path], &sets[..]].concat());
    let duffing = json(&[&["evaluate", "duffing"], &sets[..]].concat());
    assert_eq!(own["period"]["decimal"], duffing["period"]["decimal"]);
    let other = json(&[&["evaluate", &path, "--set", "a=1"], &sets[..]].concat());
    assert_ne!(other["period"]["decimal"], duffing["period"]["decimal"]);
    // c = 2 z is as small as z.
    let path = folder.problem("x'' + x + c*x' = 0", &[("z", "1")], "orders = { z = 1 }");
    let file = std::fs::read_to_string(&path).unwrap() + "c = { follows = \"2*z\" }\n";
    std::fs::write(&path, file).unwrap();
    let asked = ["derive", &path, "--normalisation", "free", "--order", "1", "--set", "z=1"];
    let found = text(&asked);
    assert!(found.contains("A_1 = -a\n"), "{found}");
}

/// With restitution 0 a hit is an impact, too, though the body may stay at the wall after it.
#[test]
fn inelastic_impacts_are_impacts() {
    let spring = &*example("impact-spring");
    let found = json(&["simulate", spring, "--set", "r=0", "--until", "8", "--section", "impact"]);
    let points = found["section"]["points"].as_array().unwrap();
    let events = found["events"].as_array().unwrap();
    let hits = events.iter().filter(|e| float(&e["v_before"]) < -1e-3).count();
    assert_eq!((points.len(), hits), (4, 4), "{events:?}");
    assert!(found["verdict"].as_str().unwrap().contains("4 impacts"));
    let ended = json(&["simulate", spring, "--set", "r=0", "--impacts", "3"]);
    assert!((float(&ended["final"]["t"]) - points[2][0].as_f64().unwrap()).abs() < 1e-9);
    let sweep = ["--sweep", "r=0..1/10:2", "--section", "impact", "--skip", "0", "--impacts", "4"];
    let swept = json(&[&["simulate", spring], &sweep[..]].concat());
    let column = swept["sweep"]["columns"][0]["points"].as_array().unwrap();
    for (one, many) in points.iter().zip(column) {
        assert!((one[2].as_f64().unwrap() - many[1].as_f64().unwrap()).abs() < 1e-9);
    }
}

/// A cycle has the exponent 0, within the error also over a time that is no whole number of periods;
/// what is linear is not chaotic, however its motions grow.
#[test]
fn growth_is_not_chaos() {
    let folder = Folder::new("growth");
    let cycle = folder.problem("x'' + x + (x^2 - 1)*x' = 0", &[], "");
    for (periods, skip) in [("200", "20"), ("200", "500")] {
        let found = json(&["simulate", &cycle, "--lyapunov", "--periods", periods, "--skip", skip]);
        let error: f64 = found["lyapunov"]["error"].as_str().unwrap().parse().unwrap();
        let value = float(&found["lyapunov"]);
        assert!(value.abs() <= error && error < 0.05, "{periods} {skip}: {value} +- {error}");
    }
    for equation in ["x'' - x'/10 + x = 0", "x'' + (1 + cos(2*t)/2)*x + x'/5 = 1"] {
        let path = folder.problem(equation, &[], "");
        let run = ["--lyapunov", "--zero-one", "--periods", "300", "--skip", "10"];
        let found = json(&[&["simulate", &path], &run[..]].concat());
        let verdict = found["verdict"].as_str().unwrap();
        assert!(verdict.starts_with("a linear equation is not chaotic"), "{verdict}");
        assert!(!verdict.contains("test chaotic"), "{verdict}");
    }
    let path = folder.problem("x'' + x = 0", &[], "");
    let still = json(&["simulate", &path, "--lyapunov", "--periods", "300", "--skip", "10"]);
    assert!(still["verdict"].as_str().unwrap().starts_with("no exponential growth"), "{still}");
    // Beyond the largest double, not at a pole.
    let path = folder.problem("x'' - x + x'/5 = 0", &[], "");
    refuses(&["simulate", &path, "--lyapunov"], 3, "largest double");
}

/// Cycles that order 1 does not decide are said to be decided elsewhere, and a centre is none.
#[test]
fn cycles_of_second_order() {
    let folder = Folder::new("cycles");
    for rest in ["", "eps*x^2 + ", "eps*x*x' + "] {
        let path = folder.problem(&format!("x'' + x + {rest}eps^2*(x^2 - 1)*x' = 0"), &[], "");
        refuses(&["derive", &path], 3, "of order 1 vanishes");
        let found = text(&["derive", &path, "--normalisation", "free", "--order", "2"]);
        assert!(found.contains("A_1 = 0") && found.contains("A_2 = 1/2*a - 1/8*a^3"), "{found}");
    }
    // v dv/(1 + eps v) = -g dx: all orbits are closed.
    let centre = "x'' + (x + eps*x^2) + eps*(x + eps*x^2)*x' = 0";
    let path = folder.problem(centre, &[], "condition = \"initial-amplitude\"");
    assert!(text(&["derive", &path, "--order", "4"]).contains("at orders 0 to 4"));
}

/// The function that --code writes deviates from the expansion by no more than it says, also where the force
/// is not smooth.
#[test]
fn the_deviation_of_code_is_found() {
    for (n, t) in [("1/10", 1.4), ("5", 0.5)] {
        let set = format!("n={n}");
        let code = text(&["evaluate", "power-law", "--set", &set, "--code", "python"]);
        let stated = code.split("deviation from the expansion ").nth(1).unwrap();
        let stated: f64 = stated.split(';').next().unwrap().parse().unwrap();
        let omega: f64 =
            code.split("phase = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let terms = code.lines().filter_map(|line| line.trim().strip_prefix('('));
        let term = |line: &str| -> Option<f64> {
            let mut parts = line.split(", ");
            let k: f64 = parts.next()?.parse().ok()?;
            let cosine: f64 = parts.next()?.parse().ok()?;
            // x(-t) = x(t).
            let sine: f64 = parts.next()?.trim_end_matches("),").parse().ok()?;
            assert!(sine.abs() < 1e-13, "{line}");
            Some(cosine * (k * omega * t).cos())
        };
        let sum: f64 = terms.filter_map(term).sum();
        let times = format!("{t}..{t}:1");
        let found = json(&["evaluate", "power-law", "--set", &set, "--times", &times]);
        let number = &found["solution"]["values"][0]["x"];
        let error: f64 = number["error"].as_str().unwrap().parse().unwrap();
        let deviation = (sum - float(number)).abs();
        assert!(deviation <= 1.1 * stated + error, "{n}: {deviation} > {stated}");
    }
}

/// A stiffness called k is a parameter like others; then `periods` says how many periods of the force lie
/// between two impacts.
#[test]
fn a_stiffness_named_k() {
    let folder = Folder::new("stiffness");
    let path = |k: &str| {
        let equation = format!("m*x'' + c*x' + {k}*x = F*cos(Omega*t)");
        let wall = "[impact]\nposition = '1/10'\ncrossing = 'rising'\nrestitution = '7/10'";
        let all = [("m", "2"), ("c", "0.4"), (k, "8"), ("F", "3"), ("Omega", "5")];
        folder.problem(&equation, &all, wall)
    };
    let of = |k: &str, periods: &str| {
        let set = format!("{periods}=2");
        let found = json(&["stability", &path(k), "--f64", "--set", &set]);
        (found["orbit"]["impact_velocity"].clone(), found["exact"]["multipliers"].clone())
    };
    assert_eq!(of("k", "periods"), of("K", "k"));
    let chart = |k: &str| {
        let sweep = format!("{k}=6..10:5");
        json(&["stability", &path(k), "--f64", "--sweep", &sweep])["grid"]["exact"].clone()
    };
    assert_eq!(chart("k"), chart("K"));
    refuses(&["stability", &path("K"), "--set", "periods=2"], 2, "has no parameter");
}

/// A constant force of order zero moves the centre, and averaging takes it, as it takes a force of frequency pi; a
/// parameter that follows a frequency in hertz is refused with the reason by what computes with rational numbers.
#[test]
fn preload_and_hertz() {
    let folder = Folder::new("preload");
    let path = folder.problem("x'' + x + eps*x^3 = F", &[("F", "1")], "");
    let shown = text(&["problems", "--show", &path]);
    assert!(shown.contains("averaging (KBM)     applies"), "{shown}");
    refuses(&["derive", &path], 3, "--normalisation free");
    let path_pi = folder.problem("x'' + x + eps*x^3 = cos(pi*t)", &[], "");
    // The response to a force cos(pi t) at order zero is -cos(pi t)/(pi^2 - 1), in balls.
    assert!(text(&["derive", &path_pi, "--order", "1"]).contains("-0.1127445999"));
    let path = folder.problem("x'' + x + eps*x^3 = F", &[("F", "1")], "");
    // (1 + a cos psi)^3: B_1 = 3/2 + 3 a^2/8.
    let asked = ["derive", &path, "--normalisation", "free", "--order", "1", "--set", "F=1"];
    let found = text(&asked);
    assert!(found.contains("B_1 = 3/2 + 3/8*a^2"), "{found}");
    let path = folder.problem("x'' + 4*x + eps*x' = cos(Omega*t)", &[("f", "5/2")], "");
    let file = std::fs::read_to_string(&path).unwrap() + "Omega = { follows = \"2*pi*f\" }\n";
    std::fs::write(&path, file).unwrap();
    for verb in ["derive", "evaluate", "verify"] {
        refuses(&[verb, &path], 2, "Omega follows: 2*pi*f; with pi only");
    }
}
