//! The paper's oscillator: thresholds, curves, zeros, cusps, M(t0).

use super::support::{assert_agrees, decimals, number, oracle, real, stick_slip};
use lindstedt::Exact;
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::number::digits::{certify, decimal};
use lindstedt_melnikov::{Branch, Friction, PolynomialFriction, StickSlip, quadrature_dissipation};
use lindstedt_paper::section_three;
use lindstedt_tests::Random;
use rug::Rational;
use serde_json::Value;

const BALLS: u32 = 220;

#[test]
fn paper_point_to_forty_digits() {
    let paper = section_three();
    let (digits, error) = certify(40, 4000, |balls| paper.signed_threshold(balls)).unwrap();
    assert_eq!(digits, "0.6370713428481635829717089604409953683799");
    assert!(error.ends_with("e-41") || error.ends_with("e-42"), "{error}");
    let row = &oracle("thresholds.json")["paper_point"];
    assert_agrees(
        &paper.signed_threshold(Balls::new(BALLS)).unwrap(),
        &row["gamma_c"],
        44,
        "paper point",
    );
}

#[test]
fn zeros_at_b_five() {
    let five = StickSlip { b: Exact::from(5), ..section_three() };
    let table = &oracle("thresholds.json")["zeros_b5"];
    let zeros = five.zeros(Balls::new(BALLS)).unwrap();
    assert_eq!(zeros.len(), 2);
    for (zero, expected) in zeros.iter().zip(table["zeros"].as_array().unwrap()) {
        assert_agrees(zero, expected, 44, "zero at b = 5");
    }
    assert_agrees(&five.loop_speed(Balls::new(BALLS)).unwrap(), &table["V"], 44, "V");
    let nth =
        |digits, n: usize| certify(digits, 20_000, |balls| five.zeros(balls).ok()?.get(n).cloned());
    assert_eq!(nth(40, 0).unwrap().0, "0.3104290218799228277350389082806589197186");
    assert_eq!(nth(40, 1).unwrap().0, "0.5572039038594314049984802875461271027828");
    // G vanishes at the printed zero to about a thousand digits, and changes its sign around it.
    let (text, _) = nth(1000, 0).unwrap();
    assert_eq!(text.len(), 1002);
    let mut at = five.clone();
    let zero = super::support::decimal(&text);
    let step = Rational::from(10).recip();
    let tiny = (0..1000).fold(Rational::from(1), |power, _| power * &step);
    let sign = |at: &mut StickSlip, v: Rational| {
        at.belt_speed = Exact::Rational(v);
        at.g(Balls::new(4000)).unwrap().is_positive()
    };
    assert!(sign(&mut at, Rational::from(&zero - &tiny)));
    assert!(!sign(&mut at, Rational::from(&zero + &tiny)));
}

#[test]
fn cusp_touches_zero() {
    let row = &oracle("thresholds.json")["cusp_touches_zero"];
    let b = section_three().touching_b().unwrap();
    assert_eq!(b.to_string(), row["b_star"].as_str().unwrap());
    let touching = StickSlip { b: Exact::Rational(b), ..section_three() };
    let speed = touching.loop_speed(Balls::new(BALLS)).unwrap();
    assert_agrees(&speed, &row["vstar"], 44, "cusp at zero");
    // G at v* = V is 0 there: v*^2 = 35/129 exactly, so G/V = (172/35) beta V^2 - (4/3) alpha.
    // So V itself is the one zero of the curve, decided over Q; and the threshold there is 0.
    let zeros = touching.zeros(Balls::new(BALLS)).unwrap();
    assert!(zeros.len() == 1 && zeros[0].overlaps(&speed));
    let value = touching.threshold_at_cusp(Balls::new(BALLS)).unwrap();
    assert!(value.is_exact() && value.contains_zero());
    // A little above b* there are two zeros v1 < V < v2, a little below none.
    let near = |n: i32| StickSlip { b: Exact::from((129_000 + n, 70_000)), ..section_three() };
    assert_eq!(near(1).zeros(Balls::new(BALLS)).unwrap().len(), 2);
    assert_eq!(near(-1).zeros(Balls::new(BALLS)).unwrap().len(), 0);
}

#[test]
fn random_thresholds() {
    let balls = Balls::new(BALLS);
    for row in oracle("thresholds.json")["random_points"].as_array().unwrap() {
        let point = stick_slip(row);
        assert_agrees(&point.loop_speed(balls).unwrap(), &row["V"], 29, "V");
        assert_agrees(&point.signed_threshold(balls).unwrap(), &row["gamma_signed"], 29, "gamma");
        for branch in [Branch::Positive, Branch::Negative] {
            let threshold = point.system().unwrap().threshold(balls, branch).unwrap();
            assert_agrees(&threshold.dissipation, &row["D"], 29, "D");
            assert_agrees(&threshold.forcing, &row["F"], 29, "F");
            assert_agrees(&threshold.signed, &row["gamma_signed"], 29, "D/F");
            assert!(!threshold.gamma.is_negative());
        }
    }
}

#[test]
fn curves() {
    let balls = Balls::new(BALLS);
    let table = oracle("threshold_curves.json");
    for (name, curve) in table["curves"].as_object().unwrap() {
        let mut point = stick_slip(curve);
        let mut at = |v: &Value| {
            point.belt_speed = Exact::Rational(super::support::decimal(v.as_str().unwrap()));
            point.signed_threshold(balls).unwrap()
        };
        for row in curve["points"].as_array().unwrap() {
            let what = format!("b = {name}, v* = {}", row["vstar"]);
            assert_agrees(&at(&row["vstar"]), &row["gamma_signed"], 28, &what);
        }
        assert_agrees(&at(&Value::from("0")), &curve["gamma_at_0"], 29, "at 0");
        let cusp = point.threshold_at_cusp(balls).unwrap();
        assert_agrees(&cusp, &curve["gamma_at_V"], 29, "at the cusp");
        let zeros = point.zeros(balls).unwrap();
        let expected = curve["zeros"].as_array().unwrap();
        assert_eq!(zeros.len(), expected.len(), "zeros at b = {name}");
        for (zero, expected) in zeros.iter().zip(expected) {
            assert_agrees(zero, expected, 29, &format!("zero at b = {name}"));
        }
        let stationary = point.stationary_points(balls).unwrap();
        let expected = curve["smooth_stationary"].as_array().unwrap();
        assert_eq!(stationary.len(), expected.len(), "stationary points at b = {name}");
        for (v, expected) in stationary.iter().zip(expected) {
            assert_agrees(v, &expected["vstar"], 29, "stationary point");
        }
    }
}

#[test]
fn melnikov_function() {
    let balls = Balls::new(BALLS);
    for row in oracle("melnikov_function.json").as_array().unwrap() {
        let system = stick_slip(row).system().unwrap();
        let branch =
            if row["loop"].as_i64() == Some(1) { Branch::Positive } else { Branch::Negative };
        let (m, _) = system.melnikov(balls, branch, &real(row, "gamma"), &real(row, "t0")).unwrap();
        // The file prints v* and M to 25 digits; M is a difference, so 23 of them are determined.
        assert_agrees(&m, &row["M"], 23, "M");
        assert_agrees(&m, &row["M_quad"], 23, "M by quadrature");
    }
}

/// The closed D against the finite integral of section 4.2, at random parameters.
#[test]
fn dissipation_by_quadrature() {
    let mut random = Random(3);
    let balls = Balls::new(120);
    for round in 0..25 {
        let mut q = |low, high| Exact::Rational(decimals(&mut random, low, high));
        let law = PolynomialFriction {
            dry: q(-1.0, 1.0),
            coefficients: (0..6).map(|_| q(-1.0, 1.0)).collect(),
        };
        let point = StickSlip {
            a: q(0.3, 3.0),
            b: q(0.3, 6.0),
            belt_speed: q(-1.5, 1.5),
            ..section_three()
        };
        let potential = point.potential();
        let exact = lindstedt_melnikov::polynomial_dissipation(
            balls,
            &potential,
            &law,
            Branch::Positive,
            &point.belt_speed,
        )
        .unwrap();
        let friction = Friction::Polynomial(law);
        let estimate =
            quadrature_dissipation(90, &potential, &friction, Branch::Positive, &point.belt_speed)
                .unwrap();
        let difference = (exact.midpoint().clone() - &estimate.value).abs().to_f64();
        assert!(
            difference < 1e-24 * exact.abs_upper().to_f64().max(1.0),
            "round {round}: {difference:e}"
        );
    }
}

#[test]
fn no_panic_and_typed_refusals() {
    let balls = Balls::new(64);
    for (a, b, omega) in [(0, 1, 1), (-1, 1, 1), (1, 0, 1), (1, -2, 1), (1, 1, 0), (1, 1, -1)] {
        let point = StickSlip {
            a: Exact::from(a),
            b: Exact::from(b),
            omega: Exact::from(omega),
            ..section_three()
        };
        assert!(point.check().is_err() && point.system().is_err() && point.zeros(balls).is_err());
        let _ = point.signed_threshold(balls);
        let _ = point.touching_b();
    }
    assert!(Exact::from_f64(f64::NAN).is_none() && Exact::from_f64(f64::INFINITY).is_none());
    // v* exactly at V (a = 2, b = 2: V = 1) keeps all its digits.
    let tangent = StickSlip {
        a: Exact::from(2),
        b: Exact::from(2),
        belt_speed: Exact::from(1),
        ..section_three()
    };
    let g = tangent.g(Balls::new(200)).unwrap();
    let expected = number(&serde_json::json!({"g": "0.3"}), "g") * Rational::from((172, 35))
        - Rational::from((4, 10));
    assert!(g.contains(&expected) && decimal(&g, 50).is_some());
}

/// Zeros in every parameter: a zero found in one is confirmed by the zeros in v*.
#[test]
fn zeros_in_any_parameter() {
    use lindstedt_melnikov::Axis;
    let balls = Balls::new(200);
    let five = StickSlip { b: Exact::from(5), ..section_three() };
    let both = five.zeros_in(balls, Axis::BeltSpeed, &Exact::from(-1), &Exact::from(1)).unwrap();
    assert!(both.complete && both.zeros.len() == 4);
    let right =
        five.zeros_in(balls, Axis::BeltSpeed, &Exact::from((2, 5)), &Exact::from(1)).unwrap();
    assert_eq!(right.zeros.len(), 1);
    // The same curve crossed in the other directions, at v* = 0.4 (inside or outside of V).
    let expected = [
        (Axis::B, 1),
        (Axis::A, 1),
        (Axis::Dry, 0),
        (Axis::Alpha, 1),
        (Axis::Beta, 1),
        (Axis::Omega, 0),
    ];
    for (axis, count) in expected {
        let found = five.zeros_in(balls, axis, &Exact::from((1, 100)), &Exact::from(6)).unwrap();
        assert_eq!(found.zeros.len(), count, "{axis:?}: {:?}", found.zeros);
        for zero in found.zeros {
            let value = Exact::Rational(zero.midpoint().to_rational().unwrap());
            let g = five.clone().with(axis, value).g(Balls::new(400)).unwrap();
            assert!(g.abs_upper().to_f64() < 1e-50, "{axis:?}");
        }
    }
    assert!(five.zeros_in(balls, Axis::B, &Exact::from(0), &Exact::from(6)).is_err());
}
