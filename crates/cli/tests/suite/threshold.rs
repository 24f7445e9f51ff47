//! `lindstedt threshold`: the contract's keys, the numbers of the issue, sweeps, figures, refusals.

use crate::program::{self, Folder, lindstedt, without};
use lindstedt::grid::Axis;
use lindstedt::{Oscillator, Standing, Threshold, Work};
use lindstedt_report::Present;
use serde_json::Value;
use std::f64::consts::PI;
use std::process::Output;

mod files;
mod forms;

const THRESHOLD: &[&str] = &["threshold", "stick-slip"];

fn run(arguments: &[&str]) -> Output {
    lindstedt(&[THRESHOLD, arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    program::json(&[THRESHOLD, arguments].concat())
}

/// What there is no time to write is left out, and that is said.
#[test]
fn a_map_is_cut_where_its_time_ends() {
    let sweep = ["vstar=0..1:4", "b=1..2:3"].map(|axis| Axis::parse(axis).unwrap()).into();
    let belt = Oscillator::builtin("stick-slip").unwrap();
    let question = Threshold { sweep, ..Threshold::default() };
    let mut answer = belt.threshold(&question, &Work::default()).unwrap();
    answer.shorten(12);
    assert_eq!(answer.standing, Standing::Complete);
    answer.shorten(5);
    let json: Value = serde_json::from_str(&lindstedt_report::json(&answer).unwrap()).unwrap();
    assert_eq!(json["standing"], "stopped, 5 done");
    let rows = json["grid"]["signed"].as_array().unwrap();
    assert_eq!(rows.iter().map(|row| row.as_array().unwrap().len()).collect::<Vec<_>>(), [4, 1]);
}

#[test]
fn the_numbers_of_the_paper() {
    let paper = json(&["--digits", "40"]);
    assert_eq!(paper["gamma_c"]["decimal"], "0.6370713428481635829717089604409953683799");
    assert_eq!(paper["cusp"]["touches_zero_at_b"], "129/70");
    for key in ["problem", "at", "gamma_c", "signed", "D", "F", "zeros", "curve", "validity"] {
        assert!(!paper[key].is_null(), "{key}");
    }
    let five = json(&["--set", "b=5", "--zeros", "vstar=0..1", "--digits", "40"]);
    let zero = |n: usize| five["zeros"][n]["decimal"].as_str().unwrap().to_owned();
    assert_eq!(zero(0), "0.3104290218799228277350389082806589197186");
    assert_eq!(zero(1), "0.5572039038594314049984802875461271027828");
    assert_eq!(five["zeros_of"]["complete"], true);
    // At b* the cusp lies on gamma = 0: one zero, decided exactly.
    let touching = json(&["--set", "b=129/70", "--zeros", "vstar=0..1"]);
    assert_eq!(touching["zeros"][0]["decimal"], "0.520881780692475690554725043195");
    assert_eq!(touching["cusp"]["signed"]["decimal"], "0");
}

/// Dry friction alone does no work where the belt is faster than the mass: intervals of zeros. In T0, alpha
/// and beta the threshold is linear: one zero, exactly where it is, also at the end of the range.
#[test]
fn zeros_that_a_grid_does_not_see() {
    let dry = ["--set", "alpha=0", "--set", "beta=0", "--digits", "12"];
    let found = json(&[&dry[..], &["--zeros", "vstar=-2..2"]].concat());
    let of = &found["zeros_of"];
    assert_eq!(
        (found["zeros"].as_array().unwrap().len(), &of["complete"]),
        (0, &Value::Bool(true))
    );
    let ends: Vec<&str> =
        (0..4).map(|n| of["intervals"][n / 2][n % 2]["decimal"].as_str().unwrap()).collect();
    assert_eq!(ends, ["-2.00000000000", "-0.707106781187", "0.707106781187", "2.00000000000"]);
    let inside = json(&[&dry[..], &["--zeros", "vstar=-1/2..1/2"]].concat());
    assert!(inside["zeros_of"]["intervals"].is_null());
    let cubic = ["--set", "T0=0", "--set", "alpha=0", "--digits", "12"];
    for range in ["beta=-1..1", "beta=0..1", "beta=-1..0"] {
        let found = json(&[&cubic[..], &["--zeros", range]].concat());
        assert_eq!(found["zeros"].as_array().unwrap().len(), 1, "{range}: {}", found["zeros"]);
        assert_eq!(found["zeros"][0]["decimal"], "0", "{range}");
    }
    let linear = json(&["--zeros", "alpha=0..2", "--digits", "12"]);
    assert_eq!(linear["zeros_of"]["complete"], true);
    let zero = format!("alpha={}", linear["zeros"][0]["decimal"].as_str().unwrap());
    let there = json(&["--set", &zero, "--digits", "3"]);
    assert!(there["gamma_c"]["decimal"].as_str().unwrap().parse::<f64>().unwrap() < 1e-9);
    let none =
        run(&["--set", "T0=0", "--set", "alpha=0", "--set", "beta=0", "--zeros", "vstar=0..1"]);
    assert_eq!(none.status.code(), Some(3));
}

#[test]
fn sweeps_in_one_and_two_parameters() {
    let curve = json(&["--sweep", "vstar=0..1:11"]);
    let points = curve["curve"].as_array().unwrap();
    assert_eq!((points.len(), curve["curve_status"].as_str().unwrap()), (11, "certified"));
    assert_eq!(points[4][1].as_f64().unwrap(), 0.637_071_342_848_163_6);
    let fast = json(&["--sweep", "vstar=0..1:11", "--f64"]);
    assert_eq!(fast["curve_status"], "estimated");
    let difference = fast["curve"][4][1].as_f64().unwrap() - points[4][1].as_f64().unwrap();
    assert!(difference.abs() < 1e-15);
    let grid = json(&["--sweep", "vstar=0..1:3", "--sweep", "b=1,5"]);
    assert_eq!(grid["grid"]["signed"].as_array().unwrap().len(), 2);
    assert!(grid["grid"]["signed"][1][1].as_f64().unwrap() < 0.0);
}

#[test]
fn figure_and_table() {
    let folder = Folder::new("plots");
    let (svg, csv) = (folder.path("x.svg"), folder.path("x.csv"));
    let sweeps = ["--sweep", "vstar=0..1:50", "--sweep", "b=1,2,5,10"];
    let plots = ["--plot", &svg, "--plot", &csv];
    assert!(run(&[&sweeps[..], &plots[..]].concat()).status.success());
    let (drawn, table) = (folder.text("x.svg"), folder.text("x.csv"));
    // Four cusps; two zeros each for b = 2, 5, 10.
    assert_eq!((drawn.matches("<circle").count(), drawn.matches("<polygon").count()), (6, 4));
    assert!(drawn.contains("b = 10") && drawn.trim_end().ends_with("</svg>"));
    assert_eq!(table.lines().count(), 1 + 200);
}

#[test]
fn a_cosine_does_not_see_the_sign_of_its_frequency() {
    let there =
        |omega: &str| json(&["--set", &format!("omega={omega}")])["gamma_c"]["decimal"].clone();
    assert_eq!(there("-1"), there("1"));
}

/// A file with this equation and these parameters; removed when dropped.
struct File(String, #[allow(dead_code, reason = "it lives as long")] Folder);

impl File {
    fn new(name: &str, equation: &str, parameters: &[(&str, &str)]) -> Self {
        let folder = Folder::new(name);
        let path = folder.problem(equation, parameters, "condition = []");
        Self(path, folder)
    }
    fn with_text(name: &str, text: &str) -> Self {
        let folder = Folder::new(name);
        let path = folder.file("problem.toml", text);
        Self(path, folder)
    }
    fn run(&self, arguments: &[&str]) -> Output {
        lindstedt(&[&["threshold", &self.0], arguments].concat())
    }
    fn json(&self, arguments: &[&str]) -> Value {
        program::json(&[&["threshold", &self.0], arguments].concat())
    }
}

fn example(name: &str, arguments: &[&str]) -> Value {
    program::json(&[&["threshold", &program::example(name)], arguments].concat())
}

fn decimal(number: &Value) -> &str {
    number["decimal"].as_str().unwrap()
}

#[test]
fn the_printed_file_and_the_example_are_the_built_in_problem() {
    let shown = lindstedt(&["problems", "--show", "stick-slip"]).stdout;
    let printed = File::with_text("printed", &String::from_utf8(shown).unwrap());
    let arguments = [
        "--set", "b=5", "--zeros", "vstar=0..1", "--sweep", "vstar=0..1:11", "--sweep", "b=1,5",
        "--digits", "25",
    ];
    let built_in = without(json(&arguments), &["seconds"]);
    assert_eq!(without(printed.json(&arguments), &["seconds"]), built_in);
    assert_eq!(built_in["zeros"].as_array().unwrap().len(), 2);
    // The same oscillator in other words: the same answer, name and wording of the equation apart;
    // its file does not list the small parameter.
    let mut other = without(example("stick-slip", &arguments), &["seconds"]);
    other["at"]["eps"] = "1".into();
    let own = ["problem", "equation", "units"];
    assert_eq!(without(other, &own), without(built_in, &own));
}

/// The same oscillator in other words: names, factors, order and form of the terms.
#[test]
fn other_words_for_the_oscillator_of_section_3() {
    let parameters = [
        ("p", "1"),
        ("q", "1"),
        ("mu", "3/10"),
        ("c1", "3/10"),
        ("c3", "3/10"),
        ("nu", "2"),
        ("belt", "2/5"),
        ("g", "13/20"),
    ];
    let equations = [
        "x'' - p x + q x^3 + eps (mu sign(x' - belt) - c1 (x' - belt) + c3 (x' - belt)^3) = eps g sin(nu t + 1)",
        "3 x'' = 3 x (p - q x^2) + 3 eps (g cos(nu t) + mu sign(2 belt - 2 x') + (x' - belt)(c1 - c3 (x'^2 - 2 x' belt + belt^2)))",
        "-x'' + p x - q x*x*x + eps g cos(-nu t) - eps mu (x' - belt)/|x' - belt| + eps c1 x' - eps c1 belt - eps c3 (x' - belt)^2 (x' - belt) = 0",
    ];
    let expected = json(&[]);
    for (n, equation) in equations.iter().enumerate().take(2) {
        let file = File::new(&format!("words-{n}"), equation, &parameters);
        let found = file.json(&["--sweep", "belt=0..1:3", "--zeros", "belt=0..1"]);
        for key in ["gamma_c", "signed", "D", "F", "V", "cusp", "validity", "homoclinic_points"] {
            assert_eq!(found[key], expected[key], "{equation}: {key}");
        }
        assert_eq!(found["zeros_of"]["complete"], true);
        assert_eq!(found["curve_status"], "certified");
    }
    // A quotient is no polynomial in x' and sign(x' - belt): the general route, estimated.
    let file = File::new("words-2", equations[2], &parameters);
    let found = file.json(&["--digits", "20"]);
    assert_eq!(decimal(&found["gamma_c"]), "0.63707134284816358297");
    assert_eq!(found["gamma_c"]["status"], "estimated");
}

/// J. Guckenheimer and P. Holmes, Nonlinear Oscillations (1983), section 4.5 (double well and
/// pendulum); J. M. T. Thompson, Proc. R. Soc. Lond. A 421 (1989) 195 (escape). The numbers are the
/// formulas of the notes in the files, evaluated by mpmath 1.3.
#[test]
fn classical_thresholds() {
    let expected = [
        ("forced-pendulum", "0.31947852638258523395"),
        ("escape", "0.063335299146323558925"),
        ("holmes-duffing", "0.18825452704050945619"),
    ];
    for (name, gamma) in expected {
        let found = example(name, &["--digits", "20"]);
        assert_eq!(decimal(&found["gamma_c"]), gamma, "{name}");
        assert_ne!(found["gamma_c"]["status"], "estimated", "{name}");
        let verdict = found["validity"]["verdict"].as_str().unwrap_or_default();
        assert!(verdict.ends_with("smooth; no bound on eps is known here"), "{name}: {verdict}");
    }
    let pendulum = example("forced-pendulum", &["--sweep", "delta=0.1..0.2:3"]);
    assert_eq!(pendulum["orbits"][1]["name"], "lower orbit");
    let curve = pendulum["curve"].as_array().unwrap();
    let ratio = curve[2][1].as_f64().unwrap() / curve[0][1].as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 1e-14 && curve.len() == 3);
    // A constant torque makes the separatrices different: D = 8 delta -+ 2 pi tau.
    let equation = "x'' + sin x = eps (gamma cos(omega t) - delta x' + tau)";
    let parameters = [("gamma", "1"), ("omega", "1"), ("delta", "1/5"), ("tau", "1/10")];
    let torque = File::new("torque", equation, &parameters).json(&["--zeros", "tau=0..1"]);
    let dissipation = |n: usize| {
        let signed: f64 = decimal(&torque["orbits"][n]["signed"]).parse().unwrap();
        signed * std::f64::consts::TAU / std::f64::consts::FRAC_PI_2.cosh()
    };
    assert!((dissipation(0) - (1.6 - 0.2 * PI)).abs() < 1e-14);
    assert!((dissipation(1) - (1.6 + 0.2 * PI)).abs() < 1e-14);
    // tau = 4 delta/pi.
    assert_eq!(&decimal(&torque["zeros"][0])[..20], "0.254647908947032537");
}

/// A pendulum of any length: gamma_c = (4 delta w0/pi) cosh(pi omega/(2 w0)), w0^2 = g/l irrational or not,
/// and dry friction at the largest speed 2 w0 of a pendulum with rational w0.
#[test]
fn pendulums_of_any_length() {
    for (a, w0) in [("2", 2f64.sqrt()), ("981/30", 32.7f64.sqrt()), ("9/4", 1.5)] {
        let equation = format!("x'' + {a} sin x = eps (gamma cos(omega t) - delta x')");
        let parameters = [("gamma", "1"), ("omega", "1"), ("delta", "1/10")];
        let found = File::new("swift", &equation, &parameters).json(&["--digits", "13"]);
        let closed = 0.4 * w0 / PI * (PI / (2.0 * w0)).cosh();
        let gamma: f64 = decimal(&found["gamma_c"]).parse().unwrap();
        assert!((gamma / closed - 1.0).abs() < 1e-12, "{a}: {gamma} {closed}");
        assert_eq!(found["gamma_c"]["status"], "certified");
    }
    // On the belt of speed V = 3 friction never changes its sign: D = mu 2 pi.
    let equation = "x'' + 9/4 sin x = eps (gamma cos(omega t) - mu sign(x' - 3))";
    let parameters = [("gamma", "1"), ("omega", "1"), ("mu", "1/10")];
    let found = File::new("edge", equation, &parameters).json(&["--digits", "13"]);
    let closed = 0.2 * PI / (2.0 * PI / (PI / 3.0).cosh());
    let gamma: f64 = decimal(&found["gamma_c"]).parse().unwrap();
    assert!((gamma / closed - 1.0).abs() < 1e-12, "{gamma} {closed}");
}

/// Orbits without closed form here; the numbers by mpmath 1.3: quadrature of the orbits
/// x = 1/(-q/3 +- sqrt(q^2/9 + 1/2) cosh t) (two unequal loops),
/// x = (1/4 + sqrt(1/16 + 1/9) cosh 2t)^(-1/2).
#[test]
fn orbits_followed_numerically() {
    let parameters = [
        ("gamma", "1"),
        ("omega", "1"),
        ("delta", "1/10"),
        ("mu", "1/5"),
        ("v", "3/10"),
        ("q", "1/2"),
    ];
    let wells = "x'' = x + q x^2 - x^3 + eps (gamma cos(omega t) - ";
    let cases = [
        ("asymmetric", format!("{wells} delta x')"), "0.056896427395", "0.103175188629"),
        ("dry", format!("{wells} mu sign(x' - v))"), "0.215268453934", "0.259861819455"),
        (
            "stribeck",
            format!("{wells} sign(x' - v)(mu + exp(-|x' - v|)))"),
            "0.870475198747",
            "0.877196507690",
        ),
        (
            "quintic",
            "x'' = x - x^3 - x^5/3 + eps (gamma cos(omega t) - delta x')".to_owned(),
            "0.068574182143",
            "0.068574182143",
        ),
    ];
    for (name, equation, least, first) in cases {
        let found = File::new(name, &equation, &parameters).json(&["--digits", "13"]);
        assert_eq!(&decimal(&found["gamma_c"])[..14], least, "{name}");
        assert_eq!(&decimal(&found["orbits"][0]["gamma_c"])[..14], first, "{name}");
        assert_eq!(found["gamma_c"]["status"], "estimated");
        assert!(found["gamma_c"]["error"].is_string());
        let check = found["orbits"][0]["check"].as_str().unwrap();
        let residual = check.split("energy residual ").nth(1).unwrap();
        let residual: f64 = residual.split(',').next().unwrap().parse().unwrap();
        assert!(residual < 1e-13, "{name}: {check}");
    }
}

#[test]
fn terms_that_do_not_fit_are_named() {
    let parameters = [("gamma", "1"), ("omega", "1"), ("delta", "1/10"), ("v", "1/5")];
    let cases = [
        ("x'' + sin x = gamma cos(omega t) - eps delta x'", ":2:27:", "no factor"),
        ("x'' - x + x^3 + delta x' = eps gamma cos(omega t)", ":2:29:", "delta*x' has no factor"),
        ("x'' - x + x^3 = eps (gamma cos(omega t) - delta exp(x) x')", ":2:", "depends on x"),
        ("x'' - x + x^3 = eps (gamma x sin(x) cos(omega t) - delta x')", ":2:", "factor of x"),
        ("x'' - x + x^3 = eps (gamma cos(omega t)^2 - delta x')", ":2:", "no harmonic force"),
        ("x'' - x + x^3 = eps (gamma cos(omega t) - delta x'(t - v))", ":2:", "is a delay"),
        ("x'' - x + x^3 + eps^2 x' = eps gamma cos(omega t)", ":2:", "first order"),
        ("x'' - x + x^3 = eps (gamma cos(omega t) - sign(x' - v) - sign(x'))", ":2:", "jumps"),
        ("x'' + x + x^3 = eps (gamma cos(omega t) - delta x')", "", "no homoclinic"),
        ("x'' - x + x^3 = -eps delta x'", "", "no harmonic force"),
        (
            "x'' - x + x^3 = eps (gamma cos(sqrt(2) t) - delta x')",
            ":2:",
            "has a frequency that is neither rational",
        ),
        // Its threshold is another than with the opposite sign.
        (
            "x'' - x - x^2/2 + x^3 = eps (-gamma cos(omega t) - gamma sin(2 omega t) - delta x')",
            "",
            "negative coefficient",
        ),
        // Nothing decays exponentially at a saddle without slope.
        ("x'' = x (x^2)^(1/3) - x^3 + eps (gamma cos(omega t) - delta x')", "", "no homoclinic"),
    ];
    for (n, (equation, place, words)) in cases.iter().enumerate() {
        let output = File::new(&format!("refused-{n}"), equation, &parameters).run(&[]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{equation}: {message}");
        assert!(message.contains(words) && message.contains(place), "{equation}: {message}");
        assert_eq!(message.lines().count(), 1);
    }
    let six =
        File::new("six", "x'' = x - x^3 - x^5 + eps (gamma cos(omega t) - delta x')", &parameters);
    assert_eq!(six.run(&["--digits", "100", "--limit-seconds", "0.2"]).status.code(), Some(4));
    let open = File::new("open", "x'' - x + x^3 = eps (g cos(2 t) - d x')", &[("g", "1")]);
    let text = std::fs::read_to_string(&open.0).unwrap() + "d = {}\n";
    std::fs::write(&open.0, text).unwrap();
    let output = open.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("without a value: d"));
    assert!(open.run(&["--set", "d=1/4"]).status.success());
}

/// The thresholds of the resonances tend to the homoclinic one; R_2 to R_5 of the paper's point are
/// those of tests/data and of an independent quadrature.
#[test]
fn subharmonic_thresholds() {
    let found = json(&["--subharmonics", "5", "--digits", "12"]);
    let list = found["subharmonics"].as_array().unwrap();
    let gamma = |m: u64, around: &str| {
        let entry = list.iter().find(|e| e["m"] == m && e["around"] == around);
        entry.map(|e| decimal(&e["gamma_c"]).to_owned())
    };
    // omega = 2 is faster than the small oscillations sqrt(2) in a well.
    assert_eq!(gamma(1, "one well"), None);
    assert_eq!(gamma(2, "both wells"), None);
    for (m, known, off) in
        [(2, 0.5917, 5e-5), (3, 0.63589, 5e-6), (4, 0.637_056, 5e-7), (5, 0.637_072_2, 5e-8)]
    {
        let found: f64 = gamma(m, "one well").unwrap().parse().unwrap();
        assert!((found - known).abs() < off, "{m}");
    }
    assert!(gamma(1, "both wells").is_some() && gamma(5, "both wells").is_some());
    let file = File::new("even", "x'' - x + x^2 = eps (g cos(2 t) - x')", &[("g", "1")]);
    assert_eq!(file.run(&["--subharmonics", "2"]).status.code(), Some(3));
}
