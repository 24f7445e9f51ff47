//! `lindstedt verify`: the observed order is N + 1, and not where the digits do not suffice.

use crate::program::{self, Folder, example, lindstedt};
use serde_json::Value;
use std::process::Output;

const VERIFY: &[&str] = &["verify", "--quiet"];

fn run(arguments: &[&str]) -> Output {
    lindstedt(&[VERIFY, arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[VERIFY, arguments].concat())
}

/// Fewer values than by default: two of them make a slope.
fn slopes(problem: &str, orders: std::ops::RangeInclusive<u32>, more: &[&str]) {
    for order in orders {
        let order_text = order.to_string();
        let base = [problem, "--order", &order_text, "--small", "1/4000,1/8000"];
        let found = json(&[&base, more].concat());
        let slope = found["observed_order"].as_f64().unwrap();
        assert!((slope - f64::from(order) - 1.0).abs() < 0.05, "{problem} {order} {slope}");
        assert_eq!(found["verdict"], "agrees");
        assert_eq!(found["expected_order"], order + 1);
    }
}

#[test]
fn duffing_and_van_der_pol() {
    slopes("duffing", 1..=6, &[]);
    slopes("van-der-pol", 1..=6, &[]);
}

/// Slopes that still rise are no wrong order: 2.67, 2.81, 2.90, 2.95 tends to 3.
#[test]
fn slopes_that_rise_slowly_do_not_disagree() {
    let found = json(&["duffing", "--order", "2", "--small", "1/2,1/4,1/8,1/16,1/32"]);
    assert_eq!((&found["verdict"], &found["settled"]), (&"agrees".into(), &true.into()));
    for few in ["1/4,1/8,1/16", "1/2,1/4,1/8"] {
        let output = run(&["duffing", "--order", "3", "--small", few]);
        assert_eq!(output.status.code(), Some(4), "{few}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("has not settled"), "{text}");
    }
}

/// Next to the separatrix the series in delta says nothing at these values: 10^7 times the motion.
#[test]
fn differences_as_large_as_the_motion_have_no_order() {
    let near = ["pendulum", "--order", "5", "--set", "amplitude=314159/100000"];
    let output = run(&near);
    assert_eq!(output.status.code(), Some(4));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("the difference is as large as the motion"), "{text}");
}

#[test]
fn power_law() {
    slopes("power-law", 1..=6, &[]);
}

/// At order 3 the end of the window is rounded past the last step of the integrator: it has a value.
#[test]
fn pendulum() {
    slopes("pendulum", 1..=1, &["--set", "amplitude=5/2"]);
    slopes("pendulum", 3..=3, &[]);
}

#[test]
fn keys_of_the_result() {
    let found = json(&["duffing", "--order", "2"]);
    for key in ["problem", "parameter", "at", "order", "digits", "periods", "table", "tolerance"] {
        assert!(!found[key].is_null(), "{key}");
    }
    let rows = found["table"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert!(rows[0]["slope"].is_null());
    assert_eq!(rows[1]["small"]["exact"], "1/2000");
    assert_eq!(rows[1]["difference"]["status"], "estimated");
    let number = |v: &Value| v.as_str().unwrap().parse::<f64>().unwrap();
    let (error, noise) =
        (number(&rows[3]["difference"]["decimal"]), number(&rows[3]["difference"]["error"]));
    assert!(noise < 1e-9 * error && error < 1e-11, "{error} {noise}");
}

#[test]
fn a_verdict_can_be_open() {
    // Far from small values the slopes have not settled: no verdict, code 4.
    for small in ["1,1/2", "1,1/2,1/4"] {
        let far = run(&["duffing", "--order", "3", "--small", small]);
        assert_eq!(far.status.code(), Some(4), "{small}");
        let text = String::from_utf8_lossy(&far.stdout);
        assert!(text.contains("undecided") && text.contains("smaller --small"), "{text}");
    }
    // Ten digits cannot see errors of 1e-30.
    let blind = run(&["duffing", "--order", "6", "--digits", "10"]);
    assert_eq!(blind.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&blind.stdout).contains("more --digits"));
}

#[test]
fn a_long_window_stops_at_its_limit() {
    for problem in ["duffing", "vibro-impact"] {
        // In full these take minutes.
        let arguments = [problem, "--order", "8", "--periods", "1000", "--limit-seconds", "0.3"];
        let output = run(&arguments);
        assert_eq!(output.status.code(), Some(4), "{problem}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("stopped"), "{problem}");
    }
}

/// Rayleigh, Helmholtz-Duffing, Duffing-van der Pol, delayed Duffing, Wright, the vibro-impact
/// flight: every order is right if the observed order is N + 1 at each N.
#[test]
fn files_at_low_orders_and_at_order_10() {
    let cases: [(&str, &[&str]); 10] = [
        ("rayleigh", &[]),
        (
            "helmholtz-duffing",
            &["--set", "alpha_2=3/2", "--set", "alpha_3=-1/3", "--set", "amplitude=1/2"],
        ),
        ("helmholtz-duffing", &["--set", "omega_0=5/3", "--set", "alpha_3=0"]),
        ("helmholtz-duffing", &["--set", "alpha_2=0", "--normalisation", "initial"]),
        ("duffing-van-der-pol", &["--set", "beta=1/3"]),
        ("delayed-duffing", &["--set", "g=2/3", "--set", "T=2", "--set", "amplitude=3/2"]),
        ("wright", &["--set", "T=pi/3", "--set", "c=-1/5"]),
        ("vibro-impact", &["--set", "A=1/3", "--set", "B=-1/5", "--set", "k=2"]),
        ("duffing", &["--set", "amplitude=2"]),
        ("pendulum", &["--set", "amplitude=1/2"]),
    ];
    for (file, more) in cases {
        let path = example(file);
        for order in [1u32, 2, 3, 10] {
            let order_text = order.to_string();
            let base = [&*path, "--order", &order_text, "--small", "1/2000,1/4000,1/8000"];
            let found = json(&[&base, more].concat());
            let slope = found["observed_order"].as_f64().unwrap();
            assert_eq!(found["verdict"], "agrees", "{file} {more:?} {order}: {slope}");
            // With alpha_2 = 0 the equation is one in eps^2: odd orders vanish.
            let above =
                f64::from(order + 1 + u32::from(more.contains(&"alpha_2=0") && order % 2 == 0));
            assert!((slope - above).abs() < 0.05, "{file} {more:?} {order}: {slope}");
        }
    }
}

/// A force at a fixed frequency beside a resonance is off resonance once eps is small: no symbol (omega - Omega)/eps is put in,
/// of a root in units of which it is 24/25 and of several unknowns.
#[test]
fn a_fixed_frequency_beside_a_resonance_is_not_detuned() {
    slopes("x''+2*x+eps*(x'/5+x^3)-eps*cos(24/25*sqrt(2)*t)", 2..=2, &[]);
    slopes("x''+x+eps*(x^3+x'/5)-eps*cos(24/25*t);y''+4*y+eps*(y'/5+x*y)", 1..=1, &[]);
}

/// Modes of frequencies sqrt(2) and 2 sqrt(2), with a force of sqrt(2): the ratio to sqrt(5), that of a row, does not count.
#[test]
fn a_root_that_is_the_frequency_of_a_mode() {
    let modes = "x''+5*x-3*y+eps*(x^3+x'/5)-eps*cos(sqrt(2)*t);y''+5*y-3*x+eps*y'/5";
    slopes(modes, 1..=1, &[]);
    let other = run(&[&modes.replace("sqrt(2)", "sqrt(3)")]);
    assert!(String::from_utf8_lossy(&other.stderr).contains("the frequency of a force"));
}

/// Amplitudes other than one in problems whose frequency they scale, free amplitudes of built-in
/// problems, and a time scale.
#[test]
fn amplitudes_and_scales() {
    slopes("power-law", 2..=3, &["--set", "amplitude=2"]);
    slopes("duffing", 1..=3, &["--normalisation", "free"]);
    slopes("duffing", 2..=2, &["--normalisation", "fundamental"]);
    slopes("van-der-pol", 1..=3, &["--normalisation", "free", "--set", "amplitude=1/2"]);
    slopes("vibro-impact", 1..=4, &["--set", "A=1/4", "--set", "B=1/7"]);
    let folder = Folder::new("scaled");
    let path = folder.problem("x'' + k x = eps (1 - x^2) x'", &[("k", "9/4")], "");
    slopes(&path, 1..=3, &[]);
    slopes(&path, 2..=2, &["--set", "k=1/9"]);
}

#[test]
fn text_and_figure() {
    let folder = Folder::new("figure");
    let output = run(&["duffing", "--order", "1", "--plot", &folder.path("x.svg")]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("duffing: order 1, 1 periods, integration with"), "{text}");
    assert_eq!(text.lines().count(), 9, "{text}");
    let drawn = folder.text("x.svg");
    assert!(drawn.matches("<circle").count() >= 4 && drawn.contains("slope 2"));
}

/// Expansions that leave nothing out: what differs are rounding errors.
#[test]
fn exact_expansions_agree() {
    for (equation, order) in [
        ("x'' + 2*x = eps*cos(t+1/3)", "1"),
        ("x'' + 2*x + eps*(-1/3)*cos(t+1/3) = 0", "3"),
        ("x'' + x = eps*cos(3*t)", "2"),
    ] {
        let output = run(&[equation, "--order", order]);
        let page = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success() && page.contains("rounding errors"), "{equation}: {page}");
    }
}

/// The amplitude of the motion in time is no parameter of a forced response.
#[test]
fn steady_states_beside_a_given_amplitude() {
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*cos((1 + eps)*t)";
    let asked = [equation, "--order", "2", "--set", "amplitude=2/3"];
    let page = String::from_utf8(run(&asked).stdout).unwrap();
    assert!(page.contains("differences of order 2 (3 of 3)"), "{page}");
}
