//! `lindstedt derive`: the contract of its JSON, high orders, every kind of bad input.

use crate::program::{example, json, lindstedt, refusal, text};
use serde_json::Value;

#[test]
fn the_json_contract_holds() {
    for (problem, parameter, series) in [
        ("power-law", "delta", vec!["frequency_squared", "frequency", "period_over_2pi"]),
        ("pendulum", "delta", vec!["frequency_squared", "frequency", "period_over_2pi"]),
        ("duffing", "rho", vec!["frequency", "frequency_squared", "period_over_2pi"]),
        ("van-der-pol", "eps", vec!["frequency", "amplitude", "period_over_2pi"]),
    ] {
        for order in [0usize, 3] {
            let value = json(&["derive", problem, "--order", &order.to_string(), "--digits", "25"]);
            assert_eq!(value["problem"], problem);
            assert_eq!(value["parameter"], parameter);
            assert_eq!(value["order"], order);
            assert_eq!(value["tier"], "exact");
            assert_eq!(value["residual"]["checked_orders"], order);
            assert_eq!(value["residual"]["zero"], true);
            assert_eq!(value["solution"].as_array().unwrap().len(), order + 1);
            for name in &series {
                let list = value["series"][name].as_array().unwrap();
                assert_eq!(list.len(), order + 1, "{problem} {name}");
                for number in list {
                    assert!(number["exact"].is_string() && number["decimal"].is_string());
                    assert_eq!(number["status"], "exact");
                    let digits = number["decimal"].as_str().unwrap();
                    let digits = digits.chars().filter(char::is_ascii_digit).count();
                    assert!(digits >= 25 || number["decimal"] == "0");
                }
            }
        }
    }
}

/// x(0) over the first harmonic: at twice the amplitude the same series in eps A^2.
#[test]
fn initial_displacement_is_relative() {
    let file = example("duffing");
    for (amplitude, first) in [("amplitude=1", "1/32"), ("amplitude=2", "1/8")] {
        let found = json(&[
            "derive", &file, "--normalisation", "fundamental", "--order", "1", "--set", amplitude,
        ]);
        let series = &found["series"]["initial_displacement"];
        assert_eq!((&series[0]["exact"], &series[1]["exact"]), (&"1".into(), &first.into()));
    }
}

#[test]
fn high_orders_within_their_memory() {
    // Work, not time: the proof covers every order, and the record order of 1982 is exact here.
    let value = json(&["derive", "van-der-pol", "--order", "60", "--quiet"]);
    assert_eq!(value["residual"]["checked_orders"], 60);
    let value = json(&["derive", "duffing", "--order", "100", "--quiet"]);
    assert_eq!(value["residual"]["checked_orders"], 100);
    let value = json(&["derive", "power-law", "--order", "10", "--quiet"]);
    assert_eq!(value["terms"].as_array().unwrap()[..5], [1, 2, 5, 10, 19].map(Value::from));
}

#[test]
fn the_energy_integral_gives_the_same_numbers() {
    for problem in ["power-law", "pendulum"] {
        let options = ["derive", problem, "--order", "6", "--digits", "40"];
        let driver = json(&options);
        let energy = json(&[&options[..], &["--route", "energy"]].concat());
        assert_eq!(driver["series"], energy["series"]);
        assert_eq!(energy["residual"]["zero"], Value::Null);
        assert_eq!(energy["solution"], Value::Array(Vec::new()));
    }
}

#[test]
fn ten_thousand_digits() {
    let value = json(&["derive", "power-law", "--order", "1", "--digits", "10000"]);
    let decimal = value["series"]["frequency_squared"][1]["decimal"].as_str().unwrap();
    // 1 - 2 ln 2; the last digits from mpmath 1.3.0 at 10 020 digits.
    assert!(decimal.starts_with("-0.38629436111989061883446424291635313615100026872051"));
    assert_eq!(decimal.len(), "-0.".len() + 10_000);
}

/// It is put in by `evaluate`: a derivation is in powers of it, by every method.
#[test]
fn a_value_of_the_small_parameter_changes_no_derivation() {
    const EQUATION: &str = "x'' + x + eps*(x^3 - x'/5)";
    const METHODS: [&[&str]; 3] =
        [&[], &["--normalisation", "free"], &["--tier", "collocation", "--digits", "8"]];
    for method in METHODS {
        let ask = |equation: &str, set: &[&str]| {
            json(&[&["derive", equation, "--order", "2"], set, method].concat())
        };
        let equation = if method.contains(&"free") { EQUATION } else { "x'' + x + eps*x^3" };
        let (open, given) = (ask(equation, &[]), ask(equation, &["--set", "eps=1/10"]));
        assert_eq!([&open["series"], &open["at"]], [&given["series"], &given["at"]]);
        assert_eq!(given["remarks"][0], "no coefficient depends on eps = 1/10", "{method:?}");
    }
}

#[test]
fn problems_lists_what_is_built_in() {
    let value = json(&["problems"]);
    let names: Vec<&str> =
        value["problems"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    for name in ["power-law", "pendulum", "duffing", "van-der-pol"] {
        assert!(names.contains(&name));
    }
}

/// Over Q nothing is proved before the end, and the message says so; the code is that of all verbs.
#[test]
fn a_time_limit_over_the_rationals() {
    let arguments = ["derive", "van-der-pol", "--order", "200", "--quiet"];
    let limit = ["--limit-seconds", "0.2", "--format", "json"];
    let output = lindstedt(&[&arguments[..], &limit].concat());
    assert_eq!(output.status.code(), Some(4));
    let error: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(error["error"]["code"], "limit-seconds");
    let message = error["error"]["message"].as_str().unwrap();
    assert!(message.contains("over Q") && message.contains("proved at the end"), "{message}");
}

fn refused(arguments: &[&str]) -> String {
    let (code, error) = refusal(arguments);
    assert_ne!(code, Some(0), "{arguments:?}");
    error
}

/// Two forces whose frequencies add up to 2 with long fractions: the same resonance as with short ones, and the coefficient of
/// zbar of Nayfeh and Mook, section 4.1.4: -3 i/4 F G/((1 - w^2)(1 - v^2)), up to the sign of i by hand from
/// u_0 = F/(2 (1 - w^2)) E_1 + G/(2 (1 - v^2)) E_2 + c.c., f_1 = (i/2) 6 z-bar times both.
#[test]
fn forces_with_long_fractions_keep_their_combination_resonance() {
    let equation = "x'' + x + eps*x^3 = F*cos(0.70711*t) + G*cos(1.29289*t)";
    let found = text(&["derive", equation, "--order", "1"]);
    let rest = |w: f64| 1.0 - w * w;
    let expected = 0.75 / (rest(70711e-5) * rest(1.29289));
    let line = found.lines().find(|line| line.starts_with("  f_1")).unwrap();
    let term = line.split(" - ").nth(1).unwrap();
    let (size, factors) = term.split_once("*i*").unwrap();
    let (n, d) = size.split_once('/').unwrap();
    let size = -n.parse::<f64>().unwrap() / d.parse::<f64>().unwrap();
    assert!((size - expected).abs() < 1e-12 && factors.starts_with("F*G*zbar*E_1*E_2"), "{line}");
    assert!(found.contains("eta_2' = 129289/100000") && found.contains("vanishes identically"));
    // 7071 and 12929 times one phase went beyond its exponents.
    let shorter = "x'' + x + eps*x^3 = F*cos(0.7071*t) + G*cos(1.2929*t)";
    assert!(text(&["derive", shorter, "--order", "1"]).contains("zbar*E_1*E_2"));
}

/// (3/2) i/sqrt(2) z^2 zbar; and the mean square of the force's response is no part of order one.
#[test]
fn an_irrational_frequency_beside_a_force_is_enclosed() {
    let found = text(&["derive", "x'' + 2*x + eps*x^3 = eps*F*cos(t)", "--order", "1"]);
    assert!(found.contains("f_1 = 1.0606601717798212866"), "{found}");
    assert!(found.contains("encloses zero at orders 0 to 1"), "{found}");
}

#[test]
fn refusals_of_irrational_linear_parts_are_true() {
    let roots = "x'' + sqrt(2)*x + eps*x*y; y'' + 4*sqrt(2)*y + eps*x^2";
    assert!(refused(&["derive", roots]).contains("2^(1/2), a factor of x in the linear part"));
    // The golden ratio and its inverse differ by 1.
    let golden = refused(&["derive", "x'' + 2*x - y + eps*x*cos(t); y'' + y - x", "--order", "1"]);
    assert!(golden.contains("no --digits decide it where it is zero"), "{golden}");
    let other = refused(&["derive", "x'' + 2*x + eps*x^3 = eps*F*cos(sqrt(3)*t)"]);
    assert!(other.contains("irrational number") && other.contains("a fraction near it"), "{other}");
}

/// What is assumed of a symbol omega0 is said, in every form of the answer it stands beside the numbers, and a frequency given
/// beside a resonance is detuned as a number is.
#[test]
fn frequencies_in_multiples_of_a_symbol_or_a_root_are_shown_so() {
    let damped = "x'' + omega0^2*x + eps*x^3";
    let found = text(&["derive", &format!("{damped} = eps*F*cos(11/10*omega0*t)"), "--order", "1"]);
    for line in [
        "eta' = omega0 + eps*sigma",
        "Without a value, and positive: omega0",
        "sigma = (11/10*omega0 - omega0)/eps",
    ] {
        assert!(found.contains(line), "{line}: {found}");
    }
    let free =
        text(&["derive", &format!("{damped} = eps*F*cos((5*omega0 + eps*s)*t)"), "--order", "1"]);
    assert!(free.contains("a*psi' = omega0*a + eps*(3/8*omega0^(-1)*a^3)"), "{free}");
    let mode = text(&["derive", damped, "--mode", "1", "--order", "1"]);
    assert!(mode.contains("nu^2 = omega0^2;") && mode.contains("positive: omega0"), "{mode}");
    let root = "x'' + 2*x + eps*x^3 = eps*F*cos((3*sqrt(2) + eps*s)*t)";
    let found = json(&["derive", root, "--order", "1"]);
    assert_eq!((&found["unit"], &found["frequencies"][0]), (&"sqrt(2)".into(), &"sqrt(2)".into()));
    assert_eq!((&found["force"], &found["residual"]["zero"]), (&"3*sqrt(2)".into(), &true.into()));
    // 3/(2 sqrt 2).
    let first = &found["slow_flow"]["orders"]["1"][0][0];
    assert_eq!((&first["im"], &first["powers"]["sqrt(2)"]), (&"3/4".into(), &1.into()));
}

/// (mu^2 + (sigma - 3 a^2/(8 omega_0))^2) a^2 = (F/(2 omega_0))^2 with omega_0 = sqrt(2) and mu = 1/2, sigma as a parameter and
/// as what a frequency given beside the resonance is off by; the orbit in time has the error of the orders left out.
#[test]
fn a_root_has_its_value_in_responses_and_in_time() {
    let equation = |rate: &str| format!("x'' + 2*x + eps*(x' + x^3) = eps*F*cos(({rate})*t)");
    let (written, beside) = (equation("sqrt(2) + eps*sigma"), equation("11/10*sqrt(2)"));
    let set = ["--set", "F=1", "--order", "1"];
    let detuned = [&set[..], &["--set", "sigma=1/4"]].concat();
    let cases = [(&written, &detuned[..], 0.25), (&beside, &set[..], 0.2 * 2f64.sqrt())];
    for (equation, set, sigma) in cases {
        let found = json(&[&["respond", equation, "--set", "eps=1/2"], set].concat());
        let list = found["states"][0]["list"].as_array().unwrap();
        assert_eq!(list.len(), 1);
        let a: f64 = list[0]["amplitudes"][0]["decimal"].as_str().unwrap().parse().unwrap();
        let off = sigma - 3.0 * a * a / (8.0 * 2f64.sqrt());
        assert!(((0.25 + off * off) * a * a - 1.0 / 8.0).abs() < 1e-12, "{equation}: {a}");
    }
    let judged = text(&[&["verify", &written], &detuned[..]].concat());
    assert!(judged.contains("agrees: observed order 1.99"), "{judged}");
}

/// The same numbers by any name of the unknown.
#[test]
fn one_unknown_has_any_name() {
    let series = |equation| json(&["derive", equation, "--order", "3"])["series"].clone();
    let x = series("x'' + x + eps*x^3 = 0");
    assert!(!x.is_null() && x == series("y'' + y + eps*y^3 = 0"));
    assert_eq!(x, series("theta'' + theta + eps*theta^3"));
    let forced = text(&["derive", "y'' + y + eps*y^3 = eps*F*cos(t)", "--order", "1"]);
    assert!(forced.contains("  y = z + zbar") && forced.contains("f_1 = -1/4*i*F*E"), "{forced}");
    for mixed in ["y'' + x", "eps'' + eps", "sin'' + sin"] {
        assert!(refused(&["derive", mixed]).contains("is no function of time"), "{mixed}");
    }
}

#[test]
fn the_path_of_an_unreadable_file_is_whole() {
    let path =
        "a-folder/that/does/not/exist/with/a/rather/long/path/to/it/that/is/shown/whole.toml";
    assert!(refused(&["derive", path]).contains(path));
}

/// Forces that do work conserve no energy; the squares of both amplitudes are kept all the same.
#[test]
fn quadratic_invariants_need_no_energy() {
    let line = ["derive", "x'' + x + eps*x*y^2; y'' + 9*y + eps*y^3 = 0", "--order", "1"];
    let shown = text(&line);
    assert!(shown.contains("Q = z_1*zbar_1") && shown.contains("Q = z_2*zbar_2"), "{shown}");
    assert!(!shown.contains("Energy"), "{shown}");
    let found = json(&line);
    assert_eq!(found["quadratic_invariants"].as_array().unwrap().len(), 2);
    assert!(found["energy"].is_null());
}
