//! `lindstedt simulate`: events, digits, figures, exponents, refusals.

mod sections;

use crate::program::{self, Folder, example, float};
use serde_json::Value;
use std::process::{Command, Output};

fn command(arguments: &[&str]) -> Command {
    program::command(&[&["simulate", "--quiet"], arguments].concat())
}

fn run(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[&["simulate", "--quiet"], arguments].concat())
}

/// The period 4 K(sin(a/2)) of the pendulum and B(1/4, 1/2) sqrt(2) of x'' + x^3 = 0 (both from
/// mpmath 1.3.0).
#[test]
fn periods_to_thirty_digits() {
    let cases: [(&[&str], &str); 2] = [
        (&["pendulum", "--set", "amplitude=3"], PENDULUM),
        (&["power-law", "--set", "n=3"], CUBIC),
    ];
    for (arguments, period) in cases {
        let found = json(&[arguments, &["--periods", "1"]].concat());
        assert_eq!(found["final"]["t"]["decimal"], period, "{arguments:?}");
        assert_eq!(found["final"]["t"]["status"], "estimated");
    }
}
const PENDULUM: &str = "16.1555393723933747637602761155";
const CUBIC: &str = "7.41629870920548767373540138878";

/// tests/data/stick-slip/trajectories.json, first case: an independent event code.
#[test]
fn stick_slip_events() {
    let data =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/stick-slip/trajectories.json");
    let data: Value = serde_json::from_str(&std::fs::read_to_string(data).unwrap()).unwrap();
    let case = &data["trajectories"][0];
    let start = format!("{},{}", case["x0"].as_str().unwrap(), case["v0"].as_str().unwrap());
    let end = case["t_end"].as_str().unwrap();
    let found = json(&[
        "stick-slip", "--set", "gamma=0.6", "--state", &start, "--until", end, "--digits", "25",
    ]);
    let (known, events) = (case["events"].as_array().unwrap(), found["events"].as_array().unwrap());
    assert_eq!(known.len(), events.len());
    let head = |text: &Value| text.as_str().unwrap().chars().take(20).collect::<String>();
    let mut sticks = 0;
    for (known, event) in known.iter().zip(events) {
        assert_eq!(head(&known["t"]), head(&event["t"]["decimal"]));
        sticks += u32::from(event["kind"] == "stick");
    }
    assert!(sticks > 0 && float(&found["sticking_time"]) > 0.0);
    let x: f64 = case["final"]["x"].as_str().unwrap().parse().unwrap();
    assert!((float(&found["final"]["x"]) - x).abs() < 1e-14);
}

/// The uncontrolled orbit O3 repeats; at the flip gain perturbations alternate with ratio -1.
#[test]
fn vibro_impact_orbit_and_flip() {
    let orbit = json(&["vibro-impact", "--impacts", "5"]);
    let times: Vec<f64> =
        orbit["events"].as_array().unwrap().iter().map(|e| float(&e["t"])).collect();
    let period = 2.0 * std::f64::consts::PI / 3.3;
    for (n, time) in (1..).zip(&times) {
        assert!((time - f64::from(n) * period).abs() < 1e-13, "{n} {time}");
    }
    let at = ["--set", "A=-0.0292903246974", "--perturb", "1e-8", "--impacts", "40"];
    let flip = json(&[&["vibro-impact"], &at[..]].concat());
    let growth = flip["growth"].as_array().unwrap();
    assert_eq!(growth.len(), 39);
    assert!((float(&growth[38]) + 1.0).abs() < 2e-6, "{}", growth[38]);
    assert!(flip["verdict"].as_str().unwrap().contains("last ratio -"));
    // From any other state too, with the flight before it as history.
    let free = json(&["vibro-impact", "--state", "-1/2,0", "--impacts", "3", "--set", "A=1/20"]);
    assert_eq!(free["events"].as_array().unwrap().len(), 3);
}

#[test]
fn samples_and_sections() {
    let found = json(&["duffing", "--set", "eps=0", "--until", "10", "--times", "0..10:11"]);
    let samples = found["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 11);
    for (t, sample) in (0..).zip(samples) {
        assert!((float(&sample["x"]) - f64::from(t).cos()).abs() < 1e-15);
    }
    let strobe =
        ["stick-slip", "--set", "gamma=0.6", "--section", "stroboscopic", "--periods", "90"];
    let strobe = json(&[&strobe[..], &["--f64"]].concat());
    let points = strobe["section"]["points"].as_array().unwrap();
    assert_eq!(points.len(), 90);
    // The orbit of period two: every second point the same.
    let x = |n: usize| points[n][1].as_f64().unwrap();
    assert!((x(89) - x(87)).abs() < 1e-3 && (x(89) - x(88)).abs() > 1.0, "{} {}", x(88), x(89));
    let cycle = json(&["van-der-pol", "--periods", "8", "--section", "velocity", "--digits", "15"]);
    assert_eq!(cycle["section"]["points"].as_array().unwrap().len(), 8);
    // A section on which the force bends: steps end on it, exactly or beside it.
    let drag = ["x'' + x = -x'*abs(x')/5", "--state", "1,1", "--until", "20", "--section"];
    for way in [&["--digits", "10"][..], &["--digits", "15"], &["--digits", "30"], &["--f64"]] {
        let found = json(&[&drag[..], &["velocity"], way].concat());
        let points = found["section"]["points"].as_array().unwrap();
        let slow = |point: &Value| point[2].as_f64().is_some_and(|v| v.abs() < 1e-9);
        assert!(points.len() == 4 && points.iter().all(slow), "{way:?}: {points:?}");
    }
    // A mass that sticks at its maxima, where x' is zero but for rounding errors: one point for each of them.
    // 1.3034292: an event code of piecewise linear motion.
    let signs = ["sign(x')", "sign(2*x')", "-sign(-x'/3)", "sign(-x'^3/3)*(-1)", "sign(x'+x'^3)"];
    for friction in signs.iter().chain(&["sign(sin(x'))", "sign(x'*(1+x^2))"]) {
        let equation = format!("x'' + x + {friction}/2 = cos(t/2)");
        let sticks = [&equation, "--state", "1,0", "--section", "velocity", "--skip", "12"];
        for way in [&["--digits", "15"][..], &["--digits", "4"], &["--f64"]] {
            let found = json(&[&sticks[..], &["--periods", "20"], way].concat());
            let points = found["section"]["points"].as_array().unwrap();
            let top = |point: &Value| (point[1].as_f64().unwrap() - 1.303_429_2).abs() < 1e-6;
            assert!(points.len() > 6 && points.iter().all(top), "{friction} {way:?}: {points:?}");
        }
    }
}

#[test]
fn figures_show_what_happens() {
    let belt = ["stick-slip", "--f64", "--set", "gamma=0.6", "--periods", "10"];
    let bounce = ["vibro-impact", "--f64", "--impacts", "6"];
    let cases: [(&[&str], &str, &[&str]); 4] = [
        (&belt, "phase", &["sticking", "stick begins", "velocity x&apos;|velocity x'"]),
        (&belt, "section", &["Poincare section", "displacement x"]),
        (&bounce, "time", &["impact", "<polygon", "time t"]),
        (&bounce, "phase", &["impact", "phase portrait"]),
    ];
    let folder = Folder::new("figures");
    for (arguments, figure, words) in cases {
        let plot = ["--figure", figure, "--plot", &folder.path("x.svg")];
        assert!(run(&[arguments, &plot].concat()).status.success());
        let drawn = folder.text("x.svg");
        assert!(drawn.trim_end().ends_with("</svg>") && drawn.contains("width=\"960\""));
        for word in words {
            assert!(word.split('|').any(|word| drawn.contains(word)), "{figure}: {word}");
        }
    }
    assert!(run(&[&belt[..], &["--plot", &folder.path("x.csv")]].concat()).status.success());
    let table = folder.text("x.csv");
    assert!(
        table.contains("\nsticking,") && table.contains("\nstick,") && table.contains("\nslip,")
    );
}

#[test]
fn a_file_of_another_sweep_is_not_overwritten() {
    let folder = Folder::new("other");
    let path = folder.file("r", "mine\n");
    let other = ["--sweep", "gamma=0.6..0.7:2", "--resume", &path];
    assert_eq!(run(&[&["stick-slip"], &other[..]].concat()).status.code(), Some(5));
    assert_eq!(folder.text("r"), "mine\n");
}

/// A problem file is integrated with its small parameter set (Duffing's first integral holds at
/// the end), and what it contains is never ignored: a wall makes impacts, a delay has a history.
#[test]
fn problem_files() {
    let duffing = example("duffing");
    let result = json(&[&duffing, "--set", "eps=1/10", "--until", "3"]);
    let last = result["samples"].as_array().unwrap().last().unwrap();
    let (x, v) = (float(&last["x"]), float(&last["v"]));
    let energy = |x: f64, v: f64| 0.5 * v * v + 0.5 * x * x + 0.025 * x.powi(4);
    assert!((energy(x, v) - energy(1.0, 0.0)).abs() < 1e-14);
    let refused = run(&[&duffing, "--perturb", "1/1000"]);
    assert!(
        String::from_utf8_lossy(&refused.stderr).contains("begins on its periodic impact orbit")
    );
    for (name, word) in [
        ("vibro-impact", "impacts"),
        ("delayed-duffing", "the expression given, x(t) before t = 0"),
    ] {
        let output = run(&[&example(name)]);
        assert!(output.status.success(), "{name}");
        assert!(String::from_utf8_lossy(&output.stdout).contains(word), "{name}");
    }
}

/// 4 sqrt(pi/(2 (n+1))) Gamma(1/(n+1))/Gamma(1/(n+1) + 1/2), from mpmath 1.3.0: forces that are
/// singular at x = 0, a sign, or of infinite slope there.
#[test]
fn periods_of_singular_forces() {
    for (n, period) in SINGULAR {
        for digits in [10, 30] {
            let set = format!("n={n}");
            let digits = digits.to_string();
            let found = json(&["power-law", "--set", &set, "--periods", "1", "--digits", &digits]);
            let decimal = found["final"]["t"]["decimal"].as_str().unwrap();
            let known: f64 = period.parse().unwrap();
            assert!(period.starts_with(&decimal[..decimal.len() - 1]), "{n} {decimal} {period}");
            assert!(decimal.len() + 1 >= digits.parse::<usize>().unwrap());
            assert!((float(&found["final"]["t"]) - known).abs() < 1e-8);
        }
        let doubles = json(&["power-law", "--set", &format!("n={n}"), "--periods", "1", "--f64"]);
        let error = float(&doubles["final"]["t"]) - period.parse::<f64>().unwrap();
        assert!(error.abs() < 1e-13, "{n} {error:e}");
    }
}
const SINGULAR: [(&str, &str); 5] = [
    ("-2/5", "5.39816481648534820381952219966689769"),
    ("-1/4", "5.49540909521411535810152198281491242"),
    ("0", "5.65685424949238019520675489683879231"),
    ("1/8", "5.73705073589736300094902269672529676"),
    ("1/4", "5.81678920206024256262887253196809302"),
];

/// A verdict only from deviations that are linear: at A = 0.05 the orbit is unstable (multiplier
/// -1.405), and what is left after it has grown decays to another orbit.
#[test]
fn growth_is_judged_in_the_linear_regime() {
    let verdict = |gain: &str, perturbation: &str| -> (String, Value) {
        let gain = format!("A={gain}");
        let at = ["vibro-impact", "--set", &gain, "--perturb", perturbation, "--impacts", "60"];
        let found = json(&at);
        (found["verdict"].as_str().unwrap().to_owned(), found["linear_regime"]["grows"].clone())
    };
    let (text, grows) = verdict("0.05", "1e-2");
    assert!(text.contains("undecided") && grows.is_null(), "{text}");
    for gain in ["0.05", "-0.02"] {
        let (text, grows) = verdict(gain, "1e-6");
        assert!(text.contains("the perturbation grows") && grows == true, "{text}");
    }
    let (text, grows) = verdict("-0.04", "1e-2");
    assert!(text.contains("the perturbation decays") && grows == false, "{text}");
}

/// Infinitely many impacts in a finite time are named, to the digits and in doubles.
#[test]
fn chattering_is_named() {
    let at = ["vibro-impact", "--set", "R_r=3/10", "--set", "omega=1/3", "--state=-0.4,0"];
    let exact = json(&[&at[..], &["--until", "40", "--digits", "15"]].concat());
    assert!(exact["verdict"].as_str().unwrap().contains("chattering: infinitely many impacts"));
    let doubles = json(&[&at[..], &["--until", "40", "--f64"]].concat());
    let (a, b) = (&exact["chattering"], &doubles["chattering"]);
    assert!(
        a.as_array().unwrap().len() >= 2
            && a.as_array().unwrap().len() == b.as_array().unwrap().len()
    );
    for (a, b) in a.as_array().unwrap().iter().zip(b.as_array().unwrap()) {
        assert!((float(&a["t"]) - float(&b["t"])).abs() < 1e-7);
    }
    // The hundredth impact is among those that accumulate.
    let hundred = json(&[&at[..], &["--impacts", "100", "--digits", "15"]].concat());
    assert!(hundred["complete"] == true);
    assert!(hundred["verdict"].as_str().unwrap().contains("among them"));
    let error = float(&hundred["final"]["t"]) - float(&exact["chattering"][0]["t"]);
    assert!(error.abs() < 1e-13, "{error:e}");
}

/// The same where the force bends at every turn, which is an event between any two impacts: x'' = -2 - x' |x'|/5 above a wall
/// at 0 that gives back half of the speed, from rest at 1. Falls and flights have closed forms; their sum is where the impacts
/// accumulate.
#[test]
fn chattering_passes_what_switches_between_the_impacts() {
    let (g, k) = (2.0f64, 0.2f64);
    // acosh(e^(k h)) = 2 asinh(sqrt((e^(k h) - 1)/2)).
    let fall = |height: f64| 2.0 * (0.5 * (k * height).exp_m1()).sqrt().asinh() / (g * k).sqrt();
    let (mut height, mut end) = (1.0, fall(1.0));
    for _ in 0..80 {
        let speed = 0.5 * (-g / k * (-2.0 * k * height).exp_m1()).sqrt();
        height = (k * speed * speed / g).ln_1p() / (2.0 * k);
        end += (speed * (k / g).sqrt()).atan() / (g * k).sqrt() + fall(height);
    }
    let folder = Folder::new("drag");
    let wall = "[impact]\nposition = \"0\"\ncrossing = \"falling\"\nrestitution = \"1/2\"";
    let start = "[initial]\nx = \"1\"\nvelocity = \"0\"";
    let file = folder.problem("x'' + 2 = -x'*abs(x')/5", &[], &format!("{wall}\n{start}"));
    for way in [&["--digits", "10"][..], &["--f64"]] {
        let found = json(&[&[&*file, "--until", "5"], way].concat());
        let [at] = &found["chattering"].as_array().unwrap()[..] else { panic!("{found}") };
        assert!((float(&at["t"]) - end).abs() < 1e-9, "{way:?}: {at} {end}");
        assert!(found["complete"] == true && !found["final"]["x"]["error"].is_null());
    }
}

/// A chaotic motion without events: the doubles have not one digit at the end, and say so.
#[test]
fn doubles_that_lost_every_digit_are_no_answer() {
    let path = example("holmes-duffing");
    let at = [&*path, "--f64", "--set", "eps=1", "--format", "json", "--periods"];
    let end = |periods: &str| run(&[&at[..], &[periods]].concat());
    let early = end("2");
    assert_eq!(early.status.code(), Some(0));
    let late = end("200");
    assert_eq!(late.status.code(), Some(4));
    let late: Value = serde_json::from_slice(&late.stdout).unwrap();
    assert!(late["final"]["x"]["error"].is_null(), "{late}");
    assert!(late["verdict"].as_str().unwrap().starts_with("no digit is left in doubles"));
}

#[test]
fn exponents_and_the_zero_one_test() {
    let at = |gamma: &str, periods: &str| {
        let gamma = format!("gamma={gamma}");
        let both = ["--lyapunov", "--zero-one", "--periods", periods];
        json(&[&["stick-slip", "--set", &gamma], &both[..]].concat())
    };
    let chaotic = at("0.65", "2000");
    let exponent = &chaotic["lyapunov"];
    let error: f64 = exponent["error"].as_str().unwrap().parse().unwrap();
    assert!((float(exponent) - 0.0719).abs() < 4.0 * error && error < 0.01, "{exponent}");
    // Two bands: every second point looks chaotic.
    assert!(float(&chaotic["zero_one"]["k"][1]) > 0.95, "{}", chaotic["zero_one"]);
    assert!(chaotic["verdict"].as_str().unwrap().starts_with("chaotic"));
    // Seven bands.
    let bands = "x'' + 3/10*x' - x + x^3 = 42/100*cos(6/5*t)";
    let bands = json(&[bands, "--zero-one", "--periods", "1000"]);
    let tests = bands["zero_one"]["k"].as_array().unwrap();
    assert!(tests.len() == 5 && tests[4]["every"] == 7 && float(&tests[4]) > 0.95, "{tests:?}");
    assert!(tests.iter().take(4).all(|test| float(test) < 0.3), "{tests:?}");
    let regular = at("0.6", "500");
    assert!((float(&regular["lyapunov"]) + 0.0185).abs() < 1e-3);
    assert!(regular["verdict"].as_str().unwrap().starts_with("regular"));
    // Duffing's oscillator: perturbations grow like t.
    let linear = json(&["duffing", "--lyapunov", "--periods", "300", "--skip", "100"]);
    assert!(linear["verdict"].as_str().unwrap().starts_with("no exponential growth"));
}

/// Chaos in doubles: no digits, exit code 4, and what to do.
#[test]
fn chaos_in_doubles_says_what_to_do() {
    let output = run(&["stick-slip", "--f64", "--set", "gamma=1.2", "--periods", "400"]);
    assert_eq!(output.status.code(), Some(4));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("--lyapunov") && text.contains("without --f64"), "{text}");
}

/// Directions that decay beyond the range of doubles within one period of the force; those that a rest in the transient
/// forgets begin anew (the same orbit without a rest has this exponent, too).
#[test]
fn exponents_of_slow_forces_and_after_rests() {
    let slow = ["x'' + 8*x' + 40*x + x^3 = cos(t/28)", "--state", "1,0", "--f64", "--lyapunov"];
    let found = json(&[&slow[..], &["--periods", "100", "--skip", "1"]].concat());
    assert!((float(&found["lyapunov"]) + 4.0).abs() < 1e-3, "{found}");
    let rests = ["vibro-impact", "--set", "R_r=0", "--set", "omega=2.5", "--set", "s=0"];
    let found = json(&[&rests[..], &["--state", "-1,0", "--lyapunov"]].concat());
    assert!((float(&found["lyapunov"]) + 0.417_154_46).abs() < 1e-7, "{found}");
}

/// The orbit starts just after an impact and has the period of the force: looked at once per period
/// an impact is met every time. It is unstable, gamma = -1.167783795500397 (the characteristic
/// function, `lindstedt stability`); it leaves after some 150 periods for a stable orbit, where
/// ln |gamma|/T = ln(R)/T - c/2 of a complex pair of determinant R^2 exp(-c T).
#[test]
fn diagnostics_of_a_periodic_impact_orbit() {
    let period = 2.0 * std::f64::consts::PI / 3.3;
    let from = |start: &[&str], skip: &str, periods: &str| {
        let all =
            ["vibro-impact", "--lyapunov", "--zero-one", "--skip", skip, "--periods", periods];
        json(&[&all[..], start].concat())
    };
    let orbit = from(&[], "30", "100");
    let unstable = 1.167_783_795_500_397_5_f64.ln() / period;
    assert!((float(&orbit["lyapunov"]) - unstable).abs() < 1e-4, "{orbit}");
    // Rounding errors grow to a part in 10^8: that is neither the one nor the other.
    assert!(orbit["verdict"].as_str().unwrap().contains("0-1 test undecided"), "{orbit}");
    for start in [&[][..], &["--state", "-0.5,0.1"]] {
        let found = from(start, "1000", "2000");
        let stable = 0.6f64.ln() / period - 0.1;
        assert!((float(&found["lyapunov"]) - stable).abs() < 3e-3, "{start:?} {found}");
        let verdict = found["verdict"].as_str().unwrap();
        assert!(verdict.contains("regular: perturbations decay"), "{verdict}");
        let k = found["zero_one"]["k"][0]["decimal"].as_str().unwrap();
        assert!(k.parse::<f64>().unwrap().abs() < 0.3, "{found}");
    }
}

/// The powers of the series at x = 0 are too close together.
#[test]
fn a_power_near_minus_one_is_refused() {
    let line = ["simulate", "power-law", "--set", "n=-0.999", "--digits", "20"];
    program::refuses(&line, 4, "too near an integer");
}
