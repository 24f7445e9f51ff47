//! Polynomial friction of any degree, friction laws, several harmonics, other potentials.

use super::support::{assert_agrees, decimal, decimals, number, oracle, real};
use lindstedt::Exact;
use lindstedt::unstable::number::ball::Balls;
use lindstedt_melnikov::{
    Branch, Class, Factor, Forcing, Friction, Harmonic, MelnikovError, Monomial,
    PolynomialFriction, Potential, System, polynomial_dissipation, quadrature_dissipation,
};
use lindstedt_tests::Random;
use serde_json::Value;

const BALLS: u32 = 200;

fn double_well(row: &Value) -> Potential {
    Potential::DoubleWell { a: real(row, "a"), b: real(row, "b") }
}

#[test]
fn polynomial_friction() {
    let balls = Balls::new(BALLS);
    for row in oracle("general.json")["polynomial_friction"].as_array().unwrap() {
        let coefficients = row["t"].as_array().unwrap();
        let coefficients =
            coefficients.iter().map(|t| Exact::Rational(decimal(t.as_str().unwrap()))).collect();
        let law = PolynomialFriction { dry: real(row, "T0"), coefficients };
        for branch in [Branch::Positive, Branch::Negative] {
            let d =
                polynomial_dissipation(balls, &double_well(row), &law, branch, &real(row, "vstar"))
                    .unwrap();
            assert_agrees(&d, &row["D"], 29, "D");
        }
    }
}

fn law(name: &str) -> Friction {
    let q = |n, d| Exact::from((n, d));
    match name {
        "stribeck1" => Friction::Stribeck {
            coulomb: q(1, 5),
            stiction: q(7, 20),
            speed: q(1, 4),
            viscous: q(1, 20),
        },
        "rational" => Friction::Rational { dry: q(3, 10), slope: q(3, 1) },
        "tanh" => Friction::HyperbolicTangent { dry: q(3, 10), speed: q(1, 20) },
        "softsign" => Friction::SoftSign,
        "signed_power" => Friction::SignedPower { dry: q(3, 10), exponent: q(1, 2) },
        _ => panic!("{name}"),
    }
}

#[test]
fn friction_laws() {
    for row in oracle("general.json")["friction_laws"]["table"].as_array().unwrap() {
        let name = row["law"].as_str().unwrap();
        let estimate = quadrature_dissipation(
            100,
            &double_well(row),
            &law(name),
            Branch::Positive,
            &real(row, "vstar"),
        )
        .unwrap();
        let value = Balls::new(120).from_parts(&estimate.value, &estimate.error);
        assert_agrees(&value, &row["D"], 24, &format!("{name} {row}"));
    }
}

#[test]
fn several_harmonics() {
    let balls = Balls::new(BALLS);
    for row in oracle("general.json")["multi_harmonic"]["table"].as_array().unwrap() {
        let harmonics = row["harmonics"].as_array().unwrap().iter().map(|h| Harmonic {
            number: h["k"].as_u64().unwrap() as u32,
            weight: real(h, "g"),
            phase: real(h, "phase"),
            factor: Factor::ONE,
        });
        let friction =
            PolynomialFriction::cubic(real(row, "T0"), &real(row, "alpha"), real(row, "beta"));
        let forcing =
            Forcing::Harmonics { omega: real(row, "omega"), harmonics: harmonics.collect() };
        let system = System::new(
            double_well(row),
            Friction::Polynomial(friction),
            forcing,
            real(row, "vstar"),
        )
        .unwrap();
        let work = system.work(balls, Branch::Positive).unwrap();
        assert_agrees(&work.extreme(balls, false).unwrap(), &row["Fmax"], 29, "max F");
        assert_agrees(&work.extreme(balls, true).unwrap(), &row["Fmin"], 29, "min F");
        for (branch, name) in
            [(Branch::Positive, "gamma_c_right"), (Branch::Negative, "gamma_c_left")]
        {
            let threshold = system.threshold(balls, branch).unwrap();
            assert_eq!(threshold.class, Class::Certified);
            assert_agrees(&threshold.dissipation, &row["D"], 29, "D");
            assert_agrees(&threshold.gamma, &row[name], 29, name);
        }
    }
}

/// The square of a field.
fn squared(row: &Value, name: &str) -> Exact {
    Exact::Rational(number(row, name).square())
}

#[test]
fn potentials() {
    let balls = Balls::new(BALLS);
    for row in oracle("potentials.json").as_array().unwrap() {
        let potential = match row["potential"].as_str().unwrap() {
            "pendulum" => Potential::Pendulum { a: squared(row, "w0") },
            "kink" => Potential::SoftDuffing { a: real(row, "a"), b: real(row, "b") },
            "helmholtz" => Potential::Helmholtz { a: real(row, "a"), b: real(row, "b") },
            _ => Potential::PhiSix { a: squared(row, "kappa") },
        };
        potential.check().unwrap();
        let omega = real(row, "omega").ball(balls);
        let (c, s) = potential.transform(balls, &Factor::ONE, &omega).unwrap();
        let size = balls.sqrt(&balls.add(&balls.square(&c), &balls.square(&s))).unwrap();
        if row["kappa"].is_null() {
            assert_agrees(&size, &row["F"], 29, "F");
            let sign = potential.sign_integral(balls, &real(row, "vstar")).unwrap();
            assert_agrees(&sign, &row["sgn_integral"], 29, "sign integral");
        } else {
            assert_agrees(&size, &row["amplitude"], 29, "amplitude");
            let phase = balls.atan(&balls.div(&s, &c).unwrap());
            assert!(c.is_positive());
            assert_agrees(&phase, &row["phase"], 29, "phase");
            // |C + iS|^2 = 2 pi nu/sinh(2 pi nu), nu = omega/(2 kappa).
            let x = balls
                .div(&balls.mul(&balls.pi(), &omega), &potential.rate(balls).unwrap())
                .unwrap();
            let closed = balls.div(&x, &balls.sinh(&x)).unwrap();
            assert!(closed.overlaps(&balls.square(&size)));
        }
    }
}

/// Every closed D of every potential, both branches, against the finite integral of 4.2.
#[test]
fn potentials_by_quadrature() {
    let balls = Balls::new(120);
    let mut random = Random(11);
    for round in 0..30 {
        let mut q = |low, high| Exact::Rational(decimals(&mut random, low, high));
        let (a, b) = (q(0.3, 3.0), q(0.3, 3.0));
        let potential = match round % 5 {
            0 => Potential::DoubleWell { a, b },
            1 => Potential::SoftDuffing { a, b },
            2 => Potential::Helmholtz { a, b },
            3 => Potential::Pendulum { a },
            _ => Potential::PhiSix { a },
        };
        let law = PolynomialFriction {
            dry: q(-1.0, 1.0),
            coefficients: (0..5).map(|_| q(-1.0, 1.0)).collect(),
        };
        let friction = Friction::Polynomial(law.clone());
        let speed = potential.largest_speed(balls).unwrap().midpoint().to_f64();
        let fraction = q(-1.3, 1.3).to_f64();
        let belt = Exact::from_f64((fraction * speed * 1e6).round() / 1e6).unwrap();
        for branch in [Branch::Positive, Branch::Negative] {
            if branch == Branch::Negative && !potential.has_mirror_image() {
                continue;
            }
            let exact = polynomial_dissipation(balls, &potential, &law, branch, &belt).unwrap();
            let estimate =
                quadrature_dissipation(90, &potential, &friction, branch, &belt).unwrap();
            let difference = (exact.midpoint().clone() - &estimate.value).abs().to_f64();
            let scale = exact.abs_upper().to_f64().max(1.0);
            assert!(
                difference < 1e-24 * scale,
                "round {round} {potential:?} {branch:?}: {difference:e}"
            );
        }
    }
}

#[test]
fn incommensurate_and_parametric() {
    let balls = Balls::new(BALLS);
    let (a, b) = (Exact::from((17, 10)), Exact::from((23, 10)));
    let potential = Potential::DoubleWell { a, b };
    let law = || {
        Friction::Polynomial(PolynomialFriction {
            dry: Exact::from((3, 10)),
            coefficients: Vec::new(),
        })
    };
    let system =
        |forcing| System::new(potential.clone(), law(), forcing, Exact::from((1, 5))).unwrap();
    let omega = || Exact::from((13, 10));
    // Amplitude pi omega^2/b csch(pi omega/(2 sqrt a)), the same sign on both loops.
    let parametric = system(Forcing::multiplied(omega(), Factor::Power(1)));
    let right = parametric.threshold(balls, Branch::Positive).unwrap();
    let w = omega().ball(balls);
    let pi_w = balls.mul(&balls.pi(), &w);
    let x = balls.div(&pi_w, &balls.mul_i64(&potential.rate(balls).unwrap(), 2)).unwrap();
    let closed = balls.div(
        &balls.mul(&pi_w, &w),
        &balls.mul(&balls.from_rational(&decimal("2.3")), &balls.sinh(&x)),
    );
    assert!(closed.unwrap().overlaps(&right.forcing));
    let (m, _) = parametric
        .melnikov(balls, Branch::Positive, &Exact::from(1), &Exact::from((1, 2)))
        .unwrap();
    let (n, _) = parametric
        .melnikov(balls, Branch::Negative, &Exact::from(1), &Exact::from((1, 2)))
        .unwrap();
    assert!(m.overlaps(&n) && m.relative_accuracy_bits() > 100);
    let pendulum = Potential::Pendulum { a: Exact::from(1) };
    let forcing = Forcing::multiplied(omega(), Factor::Power(1));
    let refused = System::new(pendulum, law(), forcing, Exact::from((1, 5))).unwrap();
    let refused = refused.threshold(balls, Branch::Positive);
    assert!(matches!(refused, Err(MelnikovError::NoClosedForm)));
    // Two incommensurate frequencies: the amplitudes add.
    let one = system(Forcing::single(omega())).threshold(balls, Branch::Positive).unwrap();
    let other = system(Forcing::single(Exact::from(2))).threshold(balls, Branch::Positive).unwrap();
    let part = |omega, weight| {
        let phase = Exact::from(0);
        (omega, vec![Harmonic { number: 1, weight, phase, factor: Factor::ONE }])
    };
    let both = Forcing::Incommensurate(vec![
        part(omega(), Exact::from(1)),
        part(Exact::from(2), Exact::from(-1)),
    ]);
    let both = system(both).threshold(balls, Branch::Negative).unwrap();
    assert!(both.forcing.overlaps(&balls.add(&one.forcing, &other.forcing)));
}

#[test]
fn wrong_orbits_are_refused() {
    let helmholtz = Potential::Helmholtz { a: Exact::from(1), b: Exact::from(1) };
    let good = helmholtz.description().unwrap();
    assert_eq!(good.check(), Ok(()));
    let mut wrong = good.clone();
    wrong.force[2] = Monomial::new(-2, 1, 0, 1);
    assert!(
        matches!(wrong.check(), Err(MelnikovError::WrongOrbit { residual }) if residual == "6 sech^4")
    );
    let mut unscaled = good;
    unscaled.rate_squared = Monomial::new(1, 4, 0, 0);
    assert_eq!(unscaled.check(), Err(MelnikovError::NotScaled { power: 1 }));
    let friction =
        Friction::Polynomial(PolynomialFriction { dry: Exact::from(1), coefficients: Vec::new() });
    let system =
        System::new(helmholtz, friction, Forcing::single(Exact::from(1)), Exact::from(0)).unwrap();
    let mirror = system.threshold(Balls::new(80), Branch::Negative);
    assert!(matches!(mirror, Err(MelnikovError::NoMirrorImage)));
}

/// A described orbit runs through certified crossings; the built-in potentials, which have the
/// same things in closed form, are the check: two routes.
#[test]
fn described_orbits() {
    let balls = Balls::new(160);
    let mut random = Random(17);
    for round in 0..12 {
        let mut q = |low, high| Exact::Rational(decimals(&mut random, low, high));
        let (a, b) = (q(0.3, 3.0), q(0.3, 3.0));
        let known = match round % 3 {
            0 => Potential::DoubleWell { a: a.clone(), b: b.clone() },
            1 => Potential::SoftDuffing { a: a.clone(), b: b.clone() },
            _ => Potential::Helmholtz { a: a.clone(), b: b.clone() },
        };
        let orbit = Box::new(known.description().unwrap());
        let described = Potential::Described { orbit, a, b };
        described.check().unwrap();
        let speed = known.largest_speed(balls).unwrap();
        let found = described.largest_speed(balls).unwrap();
        assert!(found.overlaps(&speed) && found.relative_accuracy_bits() > 100, "{known:?}");
        let law = PolynomialFriction {
            dry: q(0.1, 1.0),
            coefficients: vec![q(-1.0, 1.0), q(-1.0, 1.0), q(-1.0, 1.0)],
        };
        let fraction = q(-1.3, 1.3).to_f64() * speed.midpoint().to_f64();
        let belt = Exact::from_f64((fraction * 1e6).round() / 1e6).unwrap();
        for branch in [Branch::Positive, Branch::Negative] {
            assert_eq!(known.has_mirror_image(), described.has_mirror_image());
            let closed = polynomial_dissipation(balls, &known, &law, branch, &belt).unwrap();
            let general = polynomial_dissipation(balls, &described, &law, branch, &belt).unwrap();
            assert!(
                general.overlaps(&closed) && general.relative_accuracy_bits() > 80,
                "{known:?} {belt}"
            );
        }
        let friction = Friction::Stribeck {
            coulomb: q(0.1, 0.3),
            stiction: q(0.3, 0.6),
            speed: q(0.1, 1.0),
            viscous: q(0.0, 0.2),
        };
        let one = quadrature_dissipation(60, &known, &friction, Branch::Positive, &belt).unwrap();
        let two =
            quadrature_dissipation(60, &described, &friction, Branch::Positive, &belt).unwrap();
        assert!((one.value.to_f64() - two.value.to_f64()).abs() < 1e-14, "{known:?} {belt}");
    }
    // An oscillator that is not built in: x = X sech^2 tanh z has no polynomial equation, and the
    // description says so; x = 1 - 2 tanh^2 (= 2 sech^2 - 1) is a shifted Helmholtz loop.
    let zero = || Monomial::new(0, 1, 0, 0);
    let one = || Monomial::new(1, 1, 0, 0);
    let shape = lindstedt_melnikov::hyperbolic::Hyperbolic::term((2).into(), 2, false);
    let ring = lindstedt_melnikov::hyperbolic::HyperbolicRing;
    let shape = lindstedt::unstable::algebra::Ring::sub(
        &ring,
        &shape,
        &lindstedt::unstable::algebra::Ring::one(&ring),
    );
    // xi = 2u - 1, u'' = 4u - 6u^2 gives xi'' = 1 - 2 xi - 3 xi^2.
    let force = vec![one(), Monomial::new(-2, 1, 0, 0), Monomial::new(-3, 1, 0, 0)];
    let orbit = lindstedt_melnikov::OrbitDescription {
        force,
        rate_squared: one(),
        amplitude_squared: one(),
        shape,
    };
    assert_eq!(orbit.check(), Ok(()));
    let wrong = lindstedt_melnikov::OrbitDescription { amplitude_squared: zero(), ..orbit.clone() };
    assert!(wrong.check().is_err());
    let shifted =
        Potential::Described { orbit: Box::new(orbit), a: Exact::from(1), b: Exact::from(1) };
    let helmholtz = Potential::Helmholtz { a: Exact::from(4), b: Exact::from(3) };
    let belt = Exact::from((1, 3));
    let (left, right) =
        (shifted.sign_integral(balls, &belt), helmholtz.sign_integral(balls, &belt));
    assert!(left.unwrap().overlaps(&right.unwrap()));
}
