//! Section 2 of the paper: verdicts, corrections, mutations; the symbolic impact map against numbers
//! computed outside this project.

use lindstedt::unstable::coeff::quotient::Quotient;
use lindstedt::unstable::impact::linearised::{ImpactMap, characteristic, coefficient, replace};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::number::ball::ring::{BallRing, Enclosure};
use lindstedt_paper::{Row, Section, Verdict, reread};
use rug::{Float, Rational};
use std::collections::BTreeMap;

fn section() -> &'static Section {
    crate::paper::numbered(2)
}

fn row(label: &str) -> &'static Row {
    section().row(label).unwrap_or_else(|| panic!("no row {label}"))
}

#[test]
fn every_formula_has_a_row() {
    for number in 1..=17 {
        let name = format!("({number})");
        let found = section().rows.iter().any(|row| row.label.contains(&name));
        assert!(found, "no row {name}");
    }
}

/// The verdicts that are not "agrees" and what the program finds; all found before by hand, with
/// a computer algebra system and by simulation.
#[test]
fn verdicts() {
    let expected = BTreeMap::from([
        ("f, (4)", (Verdict::Misprint, "the bracket closes after")),
        ("(8)", (Verdict::Wrong, "no change of one place")),
        ("sin phi", (Verdict::Misprint, "exp(-beta*c) and exp(beta*c) are interchanged")),
        ("F", (Verdict::Misprint, "alpha in the place of alpha0")),
        ("lambda", (Verdict::Wrong, "no change of one place")),
        ("C, D in (8)", (Verdict::Wrong, "no change of one place")),
        ("(9)", (Verdict::Misprint, "R*tau in the place of R_tau")),
        ("tau, below (9)", (Verdict::Misprint, "k in the place of l")),
        ("T, below (9)", (Verdict::Misprint, "a factor k is missing")),
        ("dx', slip 1", (Verdict::Misprint, "the sign of R*alpha0*dtau*(D*cos(alpha0*tau)")),
        ("dx', slip 2", (Verdict::Misprint, "the sign of D*sin(alpha0*tau) is +")),
        ("a", (Verdict::Wrong, "no change of one place")),
        ("(12), 3", (Verdict::Misprint, "C in the place of D in -2*R*alpha0*D")),
        ("(13)", (Verdict::Misprint, "dT_(i-1)")),
        ("below (17)", (Verdict::Misprint, "(16) in the place of (15)")),
        ("x_(1-)", (Verdict::Misprint, "a dot is missing")),
        ("simulations", (Verdict::NotReproducible, "not the stability region of (1)")),
    ]);
    for row in &section().rows {
        let usual = (Verdict::Agrees, "");
        let (verdict, evidence) = expected.get(&*row.label).copied().unwrap_or(usual);
        assert_eq!(row.verdict, verdict, "{}: {}", row.label, row.evidence);
        assert!(row.evidence.contains(evidence), "{}: {}", row.label, row.evidence);
    }
    for label in expected.keys() {
        row(label);
    }
    let agreeing = section().count(Verdict::Agrees);
    assert_eq!(section().rows.len() - expected.len(), agreeing);
    assert_eq!(agreeing, 36);
}

/// What stands beside the verdicts.
#[test]
fn evidence() {
    assert!(row("A = B = 0").derived.ends_with("-1/8*alpha^(-1)*c^2"));
    assert!(row("A = B = 0").independent.contains("up to 4 are the expansion of the roots"));
    assert!(row("(8)").evidence.contains("orders 0 to 3"));
    assert!(row("(3)").independent.ends_with("the same"));
    // The slip of (12) did not reach (16).
    assert!(row("(12), 3").evidence.contains("would change b_0 and b_1;"));
    assert!(row("b_2, (16)").evidence.contains("x'_-"));
    assert!(row("b_0, (16)").evidence.contains("R_r^2 e^(4 beta R)"));
    assert!(row("b_1, (16)").independent.contains("has trace"));
    for label in ["C", "D", "cos phi", "sin phi"] {
        assert!(row(label).independent.starts_with("the solution put into"), "{label}");
    }
    assert!(row("(17)").independent.ends_with("exactly: 0 disagreements"));
}

fn reread_one(label: &str, text: &str) -> Row {
    let rows = reread(label, text).unwrap().unwrap_or_else(|| panic!("no statement {label}"));
    rows[0].clone()
}

/// With the correction in its place every formula holds.
#[test]
fn corrected_formulas_agree() {
    let printed =
        |label: &str, left: &str| row(label).printed.strip_prefix(left).unwrap().to_owned();
    let f = printed("f, (4)", "eps f = ");
    let sin = printed("sin phi", "sin phi = ");
    let slope = printed("dx', slip 1", "delta x' = ");
    let third = printed("(12), 3", "0 = ");
    let cases = [
        ("f, (4)", f.replacen("(1 - c/B*", "(1 - c/B)*", 1)),
        ("(8)", "P0/sqrt((alpha^2 - omega^2)^2 + c^2*omega^2)".to_owned()),
        (
            "sin phi",
            sin.replacen("exp(-beta*c) - R_r*exp(beta*c)", "exp(beta*c) - R_r*exp(-beta*c)]", 1),
        ),
        ("F", "P0/sqrt((alpha^2 - omega^2)^2 + c^2*omega^2)".to_owned()),
        ("lambda", "sqrt(alpha^2 - c^2/4)".to_owned()),
        ("C, D in (8)", "C/sin(2*beta*alpha0)*(exp(-2*beta*R) - cos(2*beta*alpha0))".to_owned()),
        ("(9)", printed("(9)", "x + delta x = ").replace("R_tau", "R*tau")),
        ("tau, below (9)", "2*pi*k/omega + dT".to_owned()),
        ("T, below (9)", "2*pi*k/omega".to_owned()),
        (
            "dx'",
            slope.replacen("[-R*alpha0*dtau*(D", "[R*alpha0*dtau*(D", 1).replacen(
                "- D*sin(alpha0*tau)) -",
                "+ D*sin(alpha0*tau)) -",
                1,
            ),
        ),
        ("(12), 3", third.replacen("- 2*R*alpha0*D", "- 2*R*alpha0*C", 1)),
    ];
    for (label, text) in cases {
        let row = reread_one(label, &text);
        assert_eq!(row.verdict, Verdict::Agrees, "{label}: {text}: {}", row.evidence);
    }
}

/// A slip put into a formula that is right is found; what is no formula, or another one, is wrong.
#[test]
fn spoiled_formulas_do_not() {
    let slips = [
        ("(1)", "x'' + c*x'", "x'' - c*x'", "the sign of c*x' is +"),
        ("(2)", "c/B", "c/A", "B in the place of A"),
        ("(3)", "alpha^2", "alpha^3", "alpha^2 in the place of alpha^3"),
        ("da/dt, (6)", "sin(alpha*T)", "cos(alpha*T)", "sin(alpha*T) in the place of cos(alpha*T)"),
        ("dpsi/dt, (6)", "alpha - A", "alpha + A", "the sign of A/(2*alpha) is -"),
        ("R, (7)", "1 - cos", "1 + cos", "the sign of cos(alpha*T) is -"),
        ("alpha_0, (7)", "B/2", "A/2", "B in the place of A"),
        ("C", "s - F", "v - F", "s in the place of v"),
        ("D", "exp(beta*c)", "exp(-beta*c)", "the sign of beta*c is +"),
        ("cos phi", "s/F", "s/v", "F in the place of v"),
        ("dx", "- a*dphi", "- a*omega*dphi", "omega does not belong there"),
        ("(11), 6", "+ dD*alpha0", "- dD*alpha0", "the sign of dD*alpha0"),
        ("(12), 2", "R*D - alpha0*C", "R*C - alpha0*D", "C and D are interchanged"),
        ("b_1, (16)", "(R_r - 1)", "(R_r + 1)", "the sign of 1 is -"),
        ("b_2, (16)", "R*D - alpha0*C", "R*D - C", "a factor alpha0 is missing"),
        ("b_0, (16)", "exp(4*beta*R)", "exp(2*beta*R)", "4 in the place of 2"),
    ];
    let mut failures = Vec::new();
    for (label, from, to, correction) in slips {
        let printed = &row(label).printed;
        assert!(printed.contains(from), "{label}: {printed}");
        // The label of an equation is its whole text; others have a left side in front.
        let right = match label {
            "(1)" | "(2)" => &**printed,
            _ => printed.split_once(" = ").unwrap().1,
        };
        let row = reread_one(label, &right.replacen(from, to, 1));
        if row.verdict != Verdict::Misprint || !row.evidence.starts_with(correction) {
            failures.push(format!("{label}: {} {}", row.verdict.name(), row.evidence));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
    for (label, text) in [
        ("R, (7)", "0"),
        ("R, (7)", "A*B*c*T"),
        ("b_0, (16)", "R_r*C*D"),
        ("cos phi", "s/F + lambda*c/omega"),
        ("beta", "unknown"),
        ("beta", "pi*k/"),
        ("beta", ""),
    ] {
        let row = reread_one(label, text);
        assert_eq!(row.verdict, Verdict::Wrong, "{label}: {text}: {}", row.evidence);
    }
    assert!(reread("no such label", "1").unwrap().is_none());
}

/// (16) without control with F and with the printed amplitude; mpmath 1.3.0 at 40 digits.
#[test]
fn multipliers_of_the_printed_amplitude() {
    let table = section().tables.iter().find(|t| t.name == "multipliers").unwrap();
    let cells = &table.rows[0];
    assert_eq!(cells[..2], ["O1", "omega > alpha"]);
    assert_eq!(cells[2], "-0.539524599962 +- 0.525424659530 i");
    assert_eq!(cells[3], "5.30294493584, 0.185100652887");
}

/// The region of (17) is not the stability region of (1): rates near those of the full grid.
#[test]
fn predictions_and_truth() {
    let table = section().tables.iter().find(|t| t.name == "agreement").unwrap();
    let names: Vec<&str> = table.rows.iter().map(|row| &*row[0]).collect();
    let expected = ["O1", "O2", "O3", "O4", "O5", "O6", "O7", "O8", "O9", "all but O8", "all"];
    assert_eq!(names, expected);
    // No loop, letter, own orbit, true orbit, R < 0, G: 21 x 21 points of the eight orbits.
    let full = [0.670, 0.579, 0.658, 0.692, 0.611, 0.999];
    for (cell, full) in table.rows[9][2..].iter().zip(full) {
        let rate: f64 = cell.parse().unwrap();
        assert!((rate - full).abs() < 0.03, "{cell} instead of about {full}");
    }
}

/// Numbers for the parameters of the symbolic map.
fn values(case: &serde_json::Value) -> BTreeMap<String, Float> {
    const BITS: u32 = 200;
    let float = |text: &str| Float::with_val(BITS, Float::parse(text).unwrap());
    let number = |v: &serde_json::Value| float(v.as_str().unwrap());
    let p = &case["params"];
    let [rate, frequency, omega] = ["R", "Omega", "omega"].map(|name| number(&p[name]));
    let turns = Float::with_val(BITS, p["k"].as_u64().unwrap() * 2);
    let time = Float::with_val(BITS, rug::float::Constant::Pi) * turns / &omega;
    let theta = Float::with_val(BITS, &frequency * &time);
    let growth = Float::with_val(BITS, &rate * &time).exp();
    let named = [
        ("R", rate),
        ("alpha0", frequency),
        ("omega", omega),
        ("R_r", number(&p["R_r"])),
        ("C", number(&case["C"])),
        ("D", number(&case["D"])),
        ("a", number(&p["F"])),
        ("E", growth),
        ("cos(theta)", theta.clone().cos()),
        ("sin(theta)", theta.sin()),
        ("cos(phi)", number(&case["cosphi"])),
        ("sin(phi)", number(&case["sinphi"])),
        ("s", number(&p["s"])),
        ("v", number(&case["v"])),
    ];
    named.map(|(name, value)| (name.to_owned(), value)).into()
}

/// The symbolic map at the reference cases: Jacobians computed elsewhere, independently.
#[test]
fn impact_map_has_the_reference_jacobians() {
    let map = ImpactMap::derive().unwrap();
    let text = include_str!("../data/vibro-impact/map_jacobian.json");
    let cases: Vec<serde_json::Value> = serde_json::from_str(text).unwrap();
    assert!(cases.len() > 3);
    let orbit = map.periodic_orbit().unwrap();
    assert!(map.is_periodic(&orbit));
    let [b0, b1, b2] = &map.characteristic;
    for case in cases {
        let values = values(&case);
        let ring = BallRing { balls: Balls::new(200) };
        let ulp = Float::with_val(53, Float::i_exp(1, -190));
        let image = |index: u16| {
            let name = &map.field.field.ring.parameters[usize::from(index)];
            let value = values.get(name).cloned().unwrap_or_else(|| Float::new(200));
            Enclosure(ring.balls.from_parts(&value, &ulp))
        };
        let check = |what: &str, f: &Quotient, expected: &serde_json::Value| {
            let found = map.field.evaluate(&ring, f, &image).unwrap().0;
            let expected = Float::with_val(200, Float::parse(expected.as_str().unwrap()).unwrap());
            let error = Float::with_val(53, found.midpoint() - &expected).abs().to_f64();
            let size = expected.to_f64().abs().max(1.0);
            assert!(error < 1e-25 * size, "{what}: {} for {expected}", found.midpoint());
        };
        check("b_0", b0, &case["b0"]);
        check("b_1", b1, &case["b1"]);
        check("b_2", b2, &case["b2"]);
        check("trace", &map.trace, &case["trace"]);
        check("determinant", &map.determinant, &case["det"]);
        check("v", &map.velocity_before, &case["v"]);
        check("C", &orbit[0], &case["C"]);
        check("D", &orbit[1], &case["D"]);
    }
}

/// On the periodic orbit det = (R_r E)^2 and x'_+ = -R_r x'_-, symbolically; and a wrong equation
/// has another determinant.
#[test]
fn impact_map_on_the_periodic_orbit() {
    let map = ImpactMap::derive().unwrap();
    let q = &map.field;
    let [r, e] = ["R_r", "E"].map(|name| q.parameter(name));
    let after = q.neg(&q.mul(&r, &map.velocity_before));
    // b_0/b_2 = -R_r E^2 x'_+/x'_-.
    let [b0, _, b2] = &map.characteristic;
    let ratio = q.product(&[&r, &r, &e, &e]);
    let left = q.mul(b0, &after);
    let right = q.product(&[&ratio, b2, &map.velocity_after]);
    assert!(q.equal(&left, &right));
    let [first, second, third] = map.equations.clone();
    let spoiled = replace(q, &third, &[("C", q.parameter("D"))]).unwrap();
    let other = characteristic(q, &[first, second, spoiled]).unwrap();
    assert!(!q.equal(&other[1], &map.characteristic[1]));
    let half = q.rational(&Rational::from((1, 2)));
    assert!(q.equal(&coefficient(q, &q.mul(&half, &r), "R_r"), &half));
    // An orbit with another C does not close.
    let mut orbit = map.periodic_orbit().unwrap();
    orbit[0] = q.add(&orbit[0], &r);
    assert!(!map.is_periodic(&orbit));
}
