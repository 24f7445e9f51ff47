//! Nonlinear normal modes.

use lindstedt_coeff::print::Style;
use lindstedt_derivation::DerivationError;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{NormalMode, ResonanceError, normal_mode};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use lindstedt_problem_file::ProblemFile;

fn found(equations: &str, mode: usize, order: usize) -> Result<NormalMode, DerivationError> {
    let list: Vec<String> = equations.split(';').map(|text| format!("{text:?}")).collect();
    let file = format!("equations = [{}]", list.join(", "));
    let problem = ProblemFile::parse(&file).unwrap().problem;
    let settings = AveragingSettings { order, ..AveragingSettings::default() };
    normal_mode(&problem, mode, &settings, &mut |_| true)
}

const TWO_MASSES: &str = "x'' + 2*x - y + eps*x^3/2; y'' + 2*y - x";

/// Two masses of Kerschen et al. (Mechanical Systems and Signal Processing 23, 2009, 170), in-phase mode: rho is
/// the square of the first harmonic of (x + y)/2. To order 5 from an expansion with vectors, judged by the
/// periodic orbit with 40 digits; at rho = 0.4 the true frequency is 1.0333527927773.
#[test]
fn two_masses() {
    let mode = found(TWO_MASSES, 1, 8).unwrap();
    assert_eq!(mode.checked_orders, Some(8));
    let text = mode.print_in_amplitude(&mode.frequency_squared[..6], Style::Text);
    assert_eq!(
        text,
        "1 + 3/16*rho*eps - 101/2048*rho^2*eps^2 + 9365/786432*rho^3*eps^3 \
         - 2353051/1107296256*rho^4*eps^4 + 21113419/1169304846336*rho^5*eps^5"
    );
    let sum: f64 = (0i32..)
        .zip(&mode.frequency_squared)
        .map(|(n, terms)| terms[0].re.to_f64() * 0.4f64.powi(n))
        .sum();
    // Order 8 errs by 2.2e-9.
    let error = (sum.sqrt() - 1.0333527927773).abs();
    assert!((error / 2.2e-9 - 1.0).abs() < 0.05, "{error:e}");
    // Out of phase: nu^2 = 3 is no square, and x - y has no harmonic of the first order in eps but psi, 3 psi.
    let second = found(TWO_MASSES, 2, 1).unwrap();
    let shapes = second.solution.iter().map(|x| second.print_shape(&x[0], Style::Text));
    assert_eq!(shapes.collect::<Vec<_>>(), ["a*cos(psi)", "-a*cos(psi)"]);
}

/// Of one unknown it is the backbone: (1 + 3/8 a^2 eps - ...)^2 of Duffing, and a damped mode decays.
#[test]
fn one_unknown_and_damping() {
    let mode = found("x'' + 4*x + eps*(2*mu*x' + 4*x^3)", 1, 2).unwrap();
    let backbone = mode.print_in_amplitude(&mode.frequency_squared[..2], Style::Text);
    assert_eq!(backbone, "1 + 3/4*rho*eps");
    assert_eq!(mode.print_order(&mode.growth[1], Style::Text), "-1/2*mu");
}

/// The square of a root is put in: with c = sqrt(2), x'' + 2 x + eps c x^3 is, in its own time, x'' + x + eps c/2 x^3.
#[test]
fn a_root_that_is_the_unit() {
    let root = found("x'' + 2*x + eps*sqrt(2)*x^3", 1, 4).unwrap();
    let symbol = found("x'' + x + eps*c*x^3/2", 1, 4).unwrap();
    assert_eq!((&*root.symbols, root.checked_orders), (&["sqrt(2)".to_owned()][..], Some(4)));
    let put_in = |terms: &[AmplitudeTerm], place: usize| -> Vec<_> {
        let term = |t: &AmplitudeTerm| {
            let mut t = t.clone();
            let pairs = t.exponents[place] / 2;
            t.exponents[place] %= 2;
            [&mut t.re, &mut t.im].into_iter().for_each(|c| *c <<= pairs);
            (t.exponents, t.re, t.im)
        };
        terms.iter().map(term).collect()
    };
    for (place, ours, theirs) in [
        (1, &root.frequency_squared, &symbol.frequency_squared),
        (3, &root.solution[0], &symbol.solution[0]),
    ] {
        for (ours, theirs) in ours.iter().zip(theirs) {
            assert!(ours.iter().all(|term| term.exponents[place] < 2));
            assert_eq!(put_in(ours, place), put_in(theirs, place));
        }
    }
    let backbone = root.print_in_amplitude(&root.frequency_squared[..3], Style::Text);
    assert_eq!(backbone, "1 + 3/8*sqrt(2)*rho*eps + 3/256*rho^2*eps^2");
}

/// Modes without rational form are enclosed. By hand, to order one: q'' + lambda q + eps l_1 p_1^3 q^3 with the shape p = (1, 2 - lambda),
/// l = p/|p|^2, so that (Omega/nu)^2 = 1 + (3/4) rho l_1/lambda. To all orders: a stiffness beside a rational one gives nearly the
/// same numbers.
#[test]
fn modes_without_rational_form() {
    let golden = "x'' + 2*x - y + eps*x^3; y'' + y - x";
    for (number, sign) in [(1, -1.0), (2, 1.0)] {
        let mode = found(golden, number, 2).unwrap();
        let lambda = (3.0 + sign * 5f64.sqrt()) / 2.0;
        assert!((mode.square.to_f64() - lambda).abs() < 1e-14);
        let share = 1.0 / (1.0 + (2.0 - lambda).powi(2));
        let [first] = &mode.frequency_squared[1][..] else { panic!("one term") };
        assert!((first.re.to_f64() - 0.75 * share / lambda).abs() < 1e-14);
        let enclosed = mode.enclosed.unwrap();
        assert!(enclosed.radius < 1e-30 && enclosed.residual < 1e-30);
        assert_eq!(mode.checked_orders, Some(2));
    }
    let beside = "x'' + 2*x - y + eps*x^3/2; y'' + (2 + 1/10^13)*y - x";
    let (near, exact) = (found(beside, 1, 4).unwrap(), found(TWO_MASSES, 1, 4).unwrap());
    let lists = |mode: &NormalMode| -> Vec<AmplitudeTerm> {
        let shapes = mode.solution.iter().flatten();
        mode.frequency_squared.iter().chain(shapes).flatten().cloned().collect()
    };
    let (near, exact) = (lists(&near), lists(&exact));
    assert_eq!(near.len(), exact.len());
    for (a, b) in near.iter().zip(&exact) {
        assert_eq!(a.exponents, b.exponents);
        assert!((a.re.to_f64() - b.re.to_f64()).abs() < 1e-11, "{a:?} {b:?}");
    }
}

#[test]
fn refusals_of_normal_modes() {
    let refused = |equations, mode| match found(equations, mode, 2) {
        Err(DerivationError::Resonance(error)) => error,
        other => panic!("{:?}", other.map(|found| found.order)),
    };
    // The first mode drives the second at twice its frequency; the second moves alone.
    let spring = "x'' + x + eps*x*y; y'' + 4*y + eps*x^2";
    let expected = ResonanceError::InternalResonance { order: 1, mode: 2, multiple: 2 };
    assert_eq!(refused(spring, 1), expected);
    assert!(found(spring, 2, 2).is_ok());
    assert_eq!(refused(spring, 3), ResonanceError::NoSuchMode { mode: 3, modes: 2 });
    assert_eq!(refused("x'' + x = eps*cos(t)", 1), ResonanceError::ForcedMode);
    // Symbols that the answer is written with; y_1 is an order of y, h_1 is nothing.
    for (name, meaning) in [("rho", "the square of the amplitude"), ("y_1", "a coefficient")] {
        let taken = found(&format!("x'' + 2*x - y + eps*{name}*x^3; y'' + 2*y - x"), 1, 1);
        let error = taken.err().unwrap().to_string();
        assert!(
            error.starts_with(&format!("the answer is written with {name}, {meaning}:")),
            "{error}"
        );
    }
    assert!(found("x'' + 2*x - y + eps*h_1*x^3; y'' + 2*y - x", 1, 1).is_ok());
    let damped = "x'' + 2*x - y + eps*x'; y'' + 2*y - x";
    assert_eq!(refused(damped, 2), ResonanceError::IrrationalMode { square: "3".to_owned() });
}
