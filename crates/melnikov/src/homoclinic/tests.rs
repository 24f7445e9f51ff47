//! The homoclinic Bogdanov-Takens orbit and others, against published coefficients and against
//! invariant manifolds.

use super::{PerturbationTerm, Saddle};
use crate::MelnikovError;
use rug::{Float, Rational};

fn term(position: u32, velocity: u32, known: i32, unknown: i32) -> PerturbationTerm {
    PerturbationTerm { position, velocity, known: known.into(), unknown: unknown.into() }
}

fn saddle(slope: i32, power: u32, leading: i32, perturbation: Vec<PerturbationTerm>) -> Saddle {
    Saddle { slope: slope.into(), power, leading: leading.into(), perturbation }
}

/// u'' = u^2 - 4 + eps u'(u + tau) in y = u - 2.
fn bogdanov_takens() -> Saddle {
    saddle(4, 2, 1, vec![term(0, 1, 2, 1), term(1, 1, 1, 0)])
}

fn sum(series: &[Rational], eps: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, c| sum * eps + c.to_f64())
}

/// tau to eps^2: Al-Hdaibat, Govaerts, Kuznetsov, Meijer, SIAM J. Appl. Dyn. Syst. 15 (2016); the
/// others: a computer algebra system, by a linear system per order.
#[test]
fn the_coefficients_of_bogdanov_and_takens() -> Result<(), MelnikovError> {
    let orbit = bogdanov_takens().homoclinic(7, &mut |_| true)?;
    let even = |c: &[Rational]| c.iter().step_by(2).map(ToString::to_string).collect::<Vec<_>>();
    let tau = ["10/7", "288/2401", "-240192/45294865", "-37647386496/11108339166925"];
    assert_eq!(even(&orbit.unknown), tau);
    let sigma = ["-6", "-18/49", "3888/84035", "-2113506/226474325"];
    assert_eq!(even(&orbit.amplitude), sigma);
    let rest = [&orbit.unknown, &orbit.amplitude].map(|c| c.iter().skip(1).step_by(2));
    assert!(rest.into_iter().flatten().all(|c| *c == 0));
    let polynomial = |c: &[(i64, i64)]| c.iter().map(|q| Rational::from(*q)).collect::<Vec<_>>();
    let omega = [
        polynomial(&[(1, 1)]),
        polynomial(&[(0, 1), (-6, 7)]),
        polynomial(&[(9, 98), (0, 1), (27, 98)]),
        polynomial(&[(0, 1), (-198, 2401), (0, 1), (18, 343)]),
        polynomial(&[(-10611, 672_280), (0, 1), (-513, 336_140), (0, 1), (-2349, 96040)]),
    ];
    assert_eq!(orbit.frequency[..5], omega);
    Ok(())
}

/// Every order to eps^20 solves the equation, and no neighbour of it does.
#[test]
fn tau_to_order_twenty_is_substituted_back() -> Result<(), MelnikovError> {
    let problem = bogdanov_takens();
    let mut orbit = problem.homoclinic(21, &mut |_| true)?;
    assert_eq!(orbit.unknown.len(), 21);
    assert!(problem.residual_vanishes(&orbit));
    orbit.unknown[20] += 1;
    assert!(!problem.residual_vanishes(&orbit));
    orbit.unknown[20] -= 1;
    orbit.frequency[21][3] += 1;
    assert!(!problem.residual_vanishes(&orbit));
    Ok(())
}

/// Problems with mu, at the given eps and at half of it, where the unstable and the stable manifold
/// of the saddle meet on y' = 0: the first by Dormand and Prince of order 8, the others by Runge
/// and Kutta's method extrapolated from the steps 1/500 and 1/1000, right to about 1e-11.
fn judged() -> [(Saddle, f64, [f64; 2]); 4] {
    let carr = saddle(1, 3, -1, vec![term(0, 1, 0, 1), term(2, 1, -1, 0)]);
    let quartic = vec![term(0, 1, 0, 1), term(3, 1, -1, 0), term(1, 0, 1, 0)];
    let cubic = vec![term(0, 1, 0, 1), term(0, 3, 1, 0), term(1, 1, -1, 0), term(0, 2, 1, 0)];
    [
        (bogdanov_takens(), 0.5, [1.458_180_989_686, 1.436_046_791_019_15]),
        (carr, 0.5, [0.803_491_414_753, 0.800_875_367_868]),
        (saddle(9, 4, -2, quartic), 0.125, [3.512_513_852_39, 3.486_291_835_23]),
        (saddle(4, 2, -3, cubic), 0.03125, [-0.579_777_978_354, -0.549_207_662_480]),
    ]
}

/// The sums leave errors of the order of the first term that they leave out.
#[test]
fn the_manifolds_meet_at_the_sum() -> Result<(), MelnikovError> {
    for (problem, eps, judged) in judged() {
        assert!(problem.residual_vanishes(&problem.homoclinic(4, &mut |_| true)?));
        let orbit = problem.homoclinic(9, &mut |_| true)?;
        let mut slopes = Vec::new();
        let size = |n: usize| orbit.unknown[n].to_f64().abs() * eps.powi(n as i32);
        for terms in 1..8 {
            let error =
                |i: usize| (sum(&orbit.unknown[..terms], [eps, eps / 2.0][i]) - judged[i]).abs();
            let next = (terms..9).find(|n| size(*n) > 0.0).unwrap_or(9);
            // Where a later term is as large no order shows, and below 1e-9 the judge's own error.
            if error(1) > 1e-9 && (next + 1..9).all(|n| 4.0 * size(n) < size(next)) {
                slopes.push((error(0) / error(1)).log2());
                let found = slopes[slopes.len() - 1];
                assert!((found - next as f64).abs() < 0.4, "{problem:?}: {found} for {next}");
            }
        }
        // All terms: the first one left out has order 10, or 9.
        let whole = (sum(&orbit.unknown, eps / 2.0) - judged[1]).abs();
        assert!(whole < 2e-9, "{problem:?}: {whole}");
        assert!(slopes.len() >= 2, "{problem:?}: {slopes:?}");
    }
    Ok(())
}

/// The manifolds of Bogdanov and Takens' saddle meet on u' = 0 at these tau, to 43 digits: power series of both about
/// the saddle, then Taylor series of order 60 in steps of 1/8, with 55 digits, outside this project.
#[test]
fn slopes_tend_to_the_orders() -> Result<(), MelnikovError> {
    let judged = [
        (4, "1.436046791019174385664924414585861987177340"),
        (8, "1.430444340188324922611319972551210367964701"),
        (16, "1.429039902223595913715662153169897560781231"),
    ];
    let orbit = bogdanov_takens().homoclinic(7, &mut |_| true)?;
    let error = |(eps, truth): (u32, &str), terms: usize| {
        let sum = orbit.unknown[..terms].iter().rev();
        let sum = sum.fold(Rational::new(), |sum, c| sum / eps + c);
        let truth = Float::with_val(150, Float::parse(truth).unwrap());
        (Float::with_val(150, sum) - truth).abs().to_f64()
    };
    for (terms, order) in [(1, 2.0), (3, 4.0), (5, 6.0), (7, 8.0)] {
        let errors = judged.map(|truth| error(truth, terms));
        let slopes = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2() - order);
        assert!(slopes[0].abs() < 0.05 && slopes[1].abs() < 0.3 * slopes[0].abs(), "{slopes:?}");
    }
    Ok(())
}

#[test]
fn first_orders_of_the_literature() -> Result<(), MelnikovError> {
    let carr =
        saddle(1, 3, -1, vec![term(0, 1, 0, 1), term(2, 1, -1, 0)]).homoclinic(1, &mut |_| true)?;
    assert_eq!(carr.unknown, [Rational::from((4, 5))]);
    // The same in another unit of time: t = 2 s.
    let carr =
        saddle(4, 3, -4, vec![term(0, 1, 0, 1), term(2, 1, -1, 0)]).homoclinic(1, &mut |_| true)?;
    assert_eq!(carr.unknown, [Rational::from((4, 5))]);
    Ok(())
}

#[test]
fn what_has_no_such_orbit_is_refused() {
    let friction = || vec![term(0, 1, 0, 1)];
    let even = saddle(1, 3, -1, vec![term(0, 1, 0, 1), term(1, 1, 1, 0)]);
    let leaves = MelnikovError::LeavesRing { position: 1, velocity: 1 };
    assert_eq!(even.homoclinic(1, &mut |_| true), Err(leaves));
    let moved = saddle(1, 2, -1, vec![term(0, 0, 1, 1)]);
    let moves = MelnikovError::LeavesRing { position: 0, velocity: 0 };
    assert_eq!(moved.homoclinic(1, &mut |_| true), Err(moves));
    let root = saddle(2, 2, 1, friction()).homoclinic(1, &mut |_| true);
    assert_eq!(root, Err(MelnikovError::NotSquare { slope: 2.into() }));
    let centre = saddle(-1, 3, 1, friction()).homoclinic(1, &mut |_| true);
    assert_eq!(centre, Err(MelnikovError::NotPositive { name: "slope" }));
    let open = saddle(1, 3, 1, friction()).homoclinic(1, &mut |_| true);
    assert_eq!(open, Err(MelnikovError::NotPositive { name: "-leading" }));
    let linear = saddle(1, 1, 1, friction()).homoclinic(1, &mut |_| true);
    assert_eq!(linear, Err(MelnikovError::NotPositive { name: "power - 1" }));
    // mu y'^2 does no work on a loop that returns.
    let idle =
        saddle(4, 2, 1, vec![term(0, 2, 0, 1), term(0, 1, 1, 0)]).homoclinic(1, &mut |_| true);
    assert_eq!(idle, Err(MelnikovError::UnknownWithoutWork));
}
