//! The same oscillator in other units, phases and orientations: scales, weights, signs.

use super::{File, decimal, example};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    decimal(value).parse().unwrap()
}

fn close(a: f64, b: f64, error: f64) -> bool {
    (a - b).abs() <= error * b.abs()
}

const FRICTION: [(&str, &str); 7] = [
    ("gamma", "1"),
    ("omega", "1"),
    ("mu", "1/10"),
    ("delta", "1/5"),
    ("beta", "1/7"),
    ("v", "3/10"),
    ("quarter", "pi/2"),
];

/// x = y/2 in x'' + sin(2x)/2: the force is half as large, dry friction too, speeds are halved, the
/// linear friction stays, the cubic one is four times as large; works are divided by 4 and 2.
#[test]
fn units_of_x() {
    let force = "eps (gamma cos(omega t) - mu sign(x' - v) - delta (x' - v) - beta (x' - v)^3)";
    let small = File::new("half", &format!("x'' + sin(2*x)/2 = {force}"), &FRICTION);
    let unit = File::new("unit", &format!("x'' + sin x = {force}"), &FRICTION);
    let small = small.json(&["--digits", "15"]);
    let set = ["--set", "mu=1/5", "--set", "v=3/5", "--set", "beta=1/28", "--digits", "15"];
    let unit = unit.json(&set);
    for (key, factor) in [("gamma_c", 2.0), ("D", 4.0), ("F", 2.0), ("V", 2.0)] {
        let (a, b) = (number(&small[key]) * factor, number(&unit[key]));
        assert!(close(a, b, 1e-13), "{key}: {a} {b}");
    }
    for n in [0, 1] {
        let gamma = |found: &Value| number(&found["orbits"][n]["gamma_c"]);
        assert!(close(gamma(&small) * 2.0, gamma(&unit), 1e-13));
    }
}

/// sin z = cos(z - pi/2), and forces weigh what is written.
#[test]
fn phases_and_weights() {
    let gamma = |name: &str, force: &str| {
        // One loop: of two mirror images the least would hide a sign.
        let equation = format!("x'' - x + x^2 = eps ({force} - delta x')");
        number(&File::new(name, &equation, &FRICTION).json(&["--digits", "12"])["gamma_c"])
    };
    let first = "gamma cos(omega t + 1)";
    let sine = gamma("sine", &format!("{first} + gamma sin(2*omega*t)"));
    let cosine = gamma("cosine", &format!("{first} + gamma cos(2*omega*t - quarter)"));
    let other = gamma("other-phase", &format!("{first} - gamma sin(2*omega*t)"));
    assert!(close(sine, cosine, 1e-11), "{sine} {cosine}");
    assert!(!close(sine, other, 1e-3), "{sine} {other}");
    let alone = gamma("alone", first);
    let light = gamma("light", &format!("{first} + gamma/1000000*sin(2*omega*t)"));
    assert!(close(light, alone, 1e-5) && !close(sine, alone, 1e-3), "{light} {alone}");
}

/// The loop lies on the side of the well; the sign of the force does not matter.
#[test]
fn orientations() {
    let escape = example("escape", &["--digits", "15"]);
    assert_eq!(escape["orbits"][0]["name"], "left loop");
    let turned = File::new(
        "turned",
        "x'' + x + x^2 = eps (-gamma sin(omega t) - delta x')",
        &[("gamma", "1/10"), ("omega", "17/20"), ("delta", "1/10")],
    );
    let turned = turned.json(&["--digits", "15"]);
    assert_eq!(turned["orbits"][0]["name"], "right loop");
    assert_eq!(turned["gamma_c"], escape["gamma_c"]);
    assert_eq!(turned["amplitude"], "-1/10");
    assert_eq!(turned["homoclinic_points"], "crossing");
    assert_eq!(turned["harmonic"]["threshold"], turned["gamma_c"]);
}

/// Two unequal loops followed numerically: a sweep has the least of both, and what is divided by a
/// mass counts so.
#[test]
fn numeric_orbits_in_sweeps_and_units() {
    let wells = "m x'' = m x + m x^2/2 - m x^3 + eps (gamma cos(omega t) - m delta x')";
    let parameters = [("m", "3"), ("gamma", "1"), ("omega", "1"), ("delta", "1/10")];
    let file = File::new("unequal", wells, &parameters);
    let found = file.json(&["--digits", "13", "--sweep", "delta=1/10,1/5"]);
    // The number of `orbits_followed_numerically`.
    let least = 0.056_896_427_395;
    assert!(close(number(&found["gamma_c"]), least, 1e-10));
    let curve = |n: usize| found["curve"][n][1].as_f64().unwrap();
    assert!(close(curve(0), least, 1e-10) && close(curve(1), 2.0 * least, 1e-10));
    assert_eq!(found["harmonic"]["parameter"], "gamma");
    assert!(close(number(&found["harmonic"]["threshold"]), 3.0 * least, 1e-10));
}
