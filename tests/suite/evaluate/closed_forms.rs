//! The built-in problems against closed forms.

use super::support::{question, relative_error, relative_estimate, run, valued};
use lindstedt::unstable::series::resummation::{Kind, Method, ResummationError};
use lindstedt::{
    DerivationError, Error, Evaluate, EvaluationError, Exact, Work, unstable::problems,
};
use rug::Float;

/// Section 3 of the numbers: exponent and relative error of T at orders 2, 4, 8, 12, 20 by the
/// change of variable.
#[test]
fn one_expansion_for_every_exponent() {
    let table: [(&str, [f64; 5]); 5] = [
        ("0", [6.3e-3, 5.6e-4, 6.4e-6, 7.9e-8, 1.2e-11]),
        ("3", [1.8e-3, 4.2e-5, 3.1e-8, 2.3e-11, 1.4e-17]),
        ("5", [5.0e-3, 2.1e-4, 4.7e-7, 1.1e-9, 6.8e-15]),
        ("101", [2.2e-2, 2.0e-3, 2.1e-5, 2.4e-7, 3.1e-11]),
        ("10000", [2.3e-2, 2.2e-3, 2.6e-5, 3.1e-7, 4.8e-11]),
    ];
    for (n, errors) in table {
        for (order, expected) in [2, 4, 8, 12, 20].into_iter().zip(errors) {
            let found = run("power-law", order, Some(Method::Uniform), &[("n", n)]).unwrap();
            let exact = found.exact_period.as_ref().unwrap().decimal.clone();
            let error = relative_error(&found, &exact);
            assert!((error / expected - 1.0).abs() < 0.05, "n = {n}, order {order}: {error:e}");
        }
    }
    for n in ["0", "1/2", "2", "3", "5", "9", "101", "1e4", "1e9"] {
        let found = run("power-law", 20, Some(Method::Uniform), &[("n", n)]).unwrap();
        let exact = found.exact_period.as_ref().unwrap().decimal.clone();
        let error = relative_error(&found, &exact);
        assert!(error < 5e-11, "n = {n}: {error:e}");
        assert!(error <= relative_estimate(&found, &exact), "n = {n}");
    }
    // 4 Gamma(1/4)^2/sqrt(8 pi) and 4 sqrt 2, independent of the closed form's code.
    let exact = |n| run("power-law", 20, None, &[("n", n)]).unwrap().exact_period.unwrap().decimal;
    assert_eq!(exact("3"), "7.41629870920548767373540138878");
    assert_eq!(exact("0"), "5.65685424949238019520675489684");
}

#[test]
fn pade_of_the_cubic_oscillator() {
    let found = run("power-law", 20, Some(Method::Pade), &[("n", "3")]).unwrap();
    assert_eq!(found.resummed.outcome.degrees, Some((10, 10)));
    let error = relative_error(&found, "7.41629870920548767373540138878");
    assert!((6.4e-17..6.6e-17).contains(&error), "{error:e}");
    assert!(error <= relative_estimate(&found, "7.41629870920548767373540138878"));
}

/// Every exponent, amplitude and method: refused, or a true error below the estimate.
#[test]
fn estimates_of_the_power_law_hold() {
    let (mut checked, mut refused) = (0, 0);
    let exponents =
        ["-0.999", "-0.9", "-0.6", "-0.5", "-0.49", "-0.3", "0", "0.99", "1", "3.5", "40", "1e300"];
    for n in exponents {
        for order in [9, 24] {
            for method in [
                None,
                Some(Method::PartialSum),
                Some(Method::Pade),
                Some(Method::Uniform),
                Some(Method::UniformPade),
            ] {
                match run("power-law", order, method, &[("n", n)]) {
                    Ok(found) => {
                        let exact = found.exact_period.as_ref().unwrap().decimal.clone();
                        let error = relative_error(&found, &exact);
                        let estimate = relative_estimate(&found, &exact);
                        // The exact value is known to 30 digits here.
                        assert!(
                            error <= estimate + 1e-29,
                            "{n} {order} {method:?}: {error:e} {estimate:e}"
                        );
                        checked += 1;
                    }
                    Err(Error::Evaluation(EvaluationError::Resummation { reason, .. })) => {
                        assert!(matches!(reason, ResummationError::OutsideDisc { .. }), "{reason}");
                        assert_eq!(method, Some(Method::Uniform));
                        refused += 1;
                    }
                    Err(other) => panic!("{n}: {other}"),
                }
            }
        }
    }
    // n = -0.999, -0.9, -0.6, -0.5 at two orders: |u| >= 3.
    assert_eq!((checked, refused), (12 * 10 - 8, 8));
    assert!(matches!(
        run("power-law", 4, None, &[("n", "-1")]),
        Err(Error::Derivation(DerivationError::OutsideDomain { .. }))
    ));
}

#[test]
fn the_pendulum_is_asymptotic() {
    let found = run("pendulum", 24, None, &[]).unwrap();
    assert!(found.verdict.contains("diverges"), "{}", found.verdict);
    assert_eq!(found.best_truncation.as_ref().unwrap().0, 5);
    let error = relative_error(&found, "6.69997566437045271270121137916");
    assert!(error < 1e-9 && error <= relative_estimate(&found, "6.69997566437045271270121137916"));
    assert!(found.period.unwrap().decimal.starts_with("6.69997566"));
    // 4 K(sin(a/2)) and what the expansion supports.
    for (amplitude, exact, digits) in [
        ("1e-300", "6.28318530717958647692528676656", 29),
        ("0.1", "6.28711454931047998585118371157", 12),
        ("2", "8.34975292691849473440637164590", 5),
        ("3", "16.1555393723933747637602761155", 2),
    ] {
        let found = run("pendulum", 20, None, &[("amplitude", amplitude)]).unwrap();
        assert_eq!(found.exact_period.as_ref().unwrap().decimal, exact);
        let error = relative_error(&found, exact);
        let estimate = relative_estimate(&found, exact);
        assert!(error <= estimate + 1e-29, "{amplitude}: {error:e} {estimate:e}");
        assert!(estimate < 10f64.powi(-digits), "{amplitude}: {estimate:e}");
    }
    // Next to the saddle nothing is left of the expansion, and that is said.
    let found = run("pendulum", 20, None, &[("amplitude", "3.14159")]).unwrap();
    assert_eq!(found.period, None);
    assert!(found.verdict.contains("not one digit"));
    assert_eq!(found.exact_period.unwrap().decimal, "59.6761549495602934780033398169");
}

#[test]
fn duffing_inside_and_outside_the_radius() {
    for (eps, exact) in [
        ("1/10", "6.06065673695746678006716557694"),
        ("1", "4.76802202910246080630451847006"),
        ("100", "0.736288960821622358633127721265"),
        ("-9/10", "12.4087172255853295275427037843"),
    ] {
        for method in
            [None, Some(Method::Pade), Some(Method::ConformalPade), Some(Method::UniformPade)]
        {
            let found = run("duffing", 24, method, &[("eps", eps)]).unwrap();
            assert_eq!(found.exact_period.as_ref().unwrap().decimal, exact);
            let error = relative_error(&found, exact);
            let estimate = relative_estimate(&found, exact);
            assert!(error <= estimate + 1e-29, "{eps} {method:?}: {error:e} {estimate:e}");
            assert!(estimate < 1e-4 || method.is_some(), "{eps}: {estimate:e}");
        }
    }
    // The radius zero of the pendulum leaves no nearest singularity to report, at any order.
    for order in [12, 20] {
        let found = run("pendulum", order, None, &[]).unwrap();
        assert!(found.resummed.singularity.is_none(), "{order}");
    }
    let found = run("duffing", 30, None, &[]).unwrap();
    let singularity = found.resummed.singularity.unwrap();
    assert!((singularity.at.re.to_f64() + 1.0).abs() < 1e-6);
    assert_eq!(singularity.kind, Kind::Logarithm);
    assert!(matches!(
        run("duffing", 4, None, &[("eps", "-1")]),
        Err(Error::Derivation(DerivationError::OutsideDomain { .. }))
    ));
}

#[test]
fn van_der_pol_beyond_its_radius() {
    let exact = [
        ("1", 100, "6.663286859323130189699682030482328706812646", 1e-30),
        ("2", 60, "7.62987447967484", 1e-8),
        ("5", 100, "11.6122306677196", 1e-6),
    ];
    for (eps, order, exact, least) in exact {
        let found = run("van-der-pol", order, None, &[("eps", eps)]).unwrap();
        let error = relative_error(&found, exact);
        // The references for 2 and 5 have 15 digits.
        assert!(error <= relative_estimate(&found, exact) + 1e-14, "{eps}: {error:e}");
        assert!(error < least, "{eps}: {error:e}");
        if eps != "1" {
            continue;
        }
        let found = found.resummed.singularity.unwrap();
        let difference = |x: &Float, exact: &str| {
            let exact = Float::with_val(300, Float::parse(exact).unwrap());
            Float::with_val(300, x - exact).abs()
        };
        let re = difference(&found.at.re, "-0.751366562997634396907");
        let im = difference(&found.at.im, "3.336635074940298592");
        assert!(re < 5e-11 && im < 5e-11 && re <= found.error && im <= found.error, "{re} {im}");
        assert_eq!(found.kind, Kind::SquareRoot);
        assert!((found.exponent.to_f64() - 0.5).abs() < 1e-6);
    }
}

/// x(t) against Taylor integration with tolerance 1e-18 (mpmath 1.3.0, odefun), at
/// t = 1/2, 1, 2, 3.
#[test]
fn the_solution_at_asked_times() {
    let cases: [(&str, usize, [f64; 4], f64); 4] = [
        (
            "power-law",
            8,
            [0.88226639489044, 0.595976567672141, -0.103183615527762, -0.776571607370589],
            1e-3,
        ),
        (
            "pendulum",
            6,
            [0.896032544910296, 0.600085366127506, -0.306200957588524, -0.948751596946198],
            1e-2,
        ),
        (
            "duffing",
            20,
            [0.768801895376325, 0.233691791143141, -0.859349358101855, -0.661798490270232],
            1e-12,
        ),
        (
            "van-der-pol",
            30,
            [1.846349123078, 1.51808469155026, 0.344480964943823, -1.85438447940234],
            1e-9,
        ),
    ];
    for (name, order, expected, most) in cases {
        let problem = problems::find(name).unwrap();
        let work = Work { digits: 16, ..Work::default() };
        let (oscillator, asked) = (valued(&problem, &[]), question(order, None));
        let period = oscillator.evaluate(&asked, &work).unwrap().value;
        let path = oscillator.trajectory(&period, &asked, &work).unwrap();
        for (time, expected) in ["1/2", "1", "2", "3"].iter().zip(expected) {
            let found = path.at(&Exact::parse(time).unwrap());
            let error = (found.double - expected).abs();
            assert!(error <= found.error + 1e-14, "{name} {time}: {error:e} {:e}", found.error);
            assert!(error < most, "{name} {time}: {error:e}");
        }
        // Half a period later with phase pi: the same, by symmetry with the other sign.
        let half = Exact::PiTimes(rug::Rational::from(1));
        let half = Evaluate { phase: half, ..asked };
        let shifted = oscillator.trajectory(&period, &half, &work).unwrap();
        let (a, b) =
            (path.at(&Exact::parse("1").unwrap()), shifted.at(&Exact::parse("1").unwrap()));
        assert!((a.double + b.double).abs() < 1e-9);
    }
}
