//! An independent judge: the monodromy matrix of the linearised delayed impact system by Chebyshev
//! collocation of the second-order equation on one flight, with an orbit from a 4x4 exponential.
//! Shares no code with the library.

use crate::support::Random;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::map::Verdict;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, Parameters};
use lindstedt_impact::zeros::{exact_verdict, multipliers};
use nalgebra::{DMatrix, Matrix2, Matrix4, Vector2};

/// (v, sigma) of the periodic orbit from the exponential of (x, x', P0 cos, P0 sin).
pub fn orbit_by_exponential(p: &Parameters<f64>) -> Option<(f64, f64)> {
    let w = p.omega;
    let time = 2.0 * std::f64::consts::PI * f64::from(p.periods) / w;
    #[rustfmt::skip]
    let generator = Matrix4::new(
        0.0, 1.0, 0.0, 0.0,
        -p.alpha * p.alpha, -p.damping, p.force, 0.0,
        0.0, 0.0, 0.0, -w,
        0.0, 0.0, w, 0.0,
    );
    let x = (generator * time).exp();
    let k = Matrix2::new(x[(0, 2)], x[(0, 3)], x[(1, 2)], x[(1, 3)]).try_inverse()?;
    let r = p.restitution;
    let fixed = k * Vector2::new((1.0 - x[(0, 0)]) * p.wall, -x[(1, 0)] * p.wall);
    let per_v = k * Vector2::new(r * x[(0, 1)], 1.0 + r * x[(1, 1)]);
    let (a, h, g) = (per_v.norm_squared(), fixed.dot(&per_v), fixed.norm_squared() - 1.0);
    let root = (h * h - a * g).sqrt();
    let v = if p.branch == Branch::Plus { (-h + root) / a } else { (-h - root) / a };
    let phase = fixed + per_v * v;
    let sigma = (1.0 + r) * (p.force * phase[0] - p.alpha * p.alpha * p.wall) / v;
    (v > 0.0).then_some((v, sigma))
}

fn differentiation(n: usize) -> DMatrix<f64> {
    let x: Vec<f64> =
        (0..n).map(|j| -(std::f64::consts::PI * j as f64 / (n - 1) as f64).cos()).collect();
    // Barycentric weights by products, without the closed form.
    let weights: Vec<f64> = (0..n)
        .map(|i| (0..n).filter(|&j| j != i).map(|j| 2.0 * (x[i] - x[j])).product::<f64>().recip())
        .collect();
    let mut d =
        DMatrix::from_fn(
            n,
            n,
            |i, j| {
                if i == j { 0.0 } else { weights[j] / weights[i] / (x[i] - x[j]) }
            },
        );
    for i in 0..n {
        d[(i, i)] = -d.row(i).sum();
    }
    d
}

/// Moduli of the multipliers, descending.
pub fn monodromy(p: &Parameters<f64>, sigma: f64, chi: f64, n: usize) -> Vec<f64> {
    let time = 2.0 * std::f64::consts::PI * f64::from(p.periods) / p.omega;
    let (a, b, r) = (p.displacement_gain, p.velocity_gain, p.restitution);
    let d = differentiation(n) * (2.0 / time);
    let identity = DMatrix::<f64>::identity(n, n);
    let mut left = &d * &d + &d * (p.damping - b) + &identity * (p.alpha * p.alpha - a);
    let mut right = -(&identity * a) - &d * b;
    // The start of the next flight: first and last rows.
    left.row_mut(0).copy_from(&identity.row(0));
    left.row_mut(n - 1).copy_from(&d.row(0));
    right.row_mut(0).copy_from(&(identity.row(n - 1) * -r));
    let kick = chi * b * (1.0 + r);
    let start = identity.row(n - 1) * (sigma - kick) - d.row(n - 1) * r;
    right.row_mut(n - 1).copy_from(&start);
    // State: the flight and the end value of the flight before it (for the kick).
    let mut extended = DMatrix::zeros(n, n + 1);
    extended.view_mut((0, 0), (n, n)).copy_from(&right);
    extended[(n - 1, n)] = kick;
    let flight = left.lu().solve(&extended).unwrap();
    let mut map = DMatrix::zeros(n + 1, n + 1);
    map.view_mut((0, 0), (n, n + 1)).copy_from(&flight);
    map[(n, n - 1)] = 1.0;
    let mut moduli: Vec<f64> =
        map.complex_eigenvalues().iter().map(|gamma| gamma.re.hypot(gamma.im)).collect();
    moduli.sort_by(|x, y| y.total_cmp(x));
    moduli
}

#[test]
fn exact_verdict_agrees_with_collocation_at_500_random_points() {
    let mut random = Random(7);
    let (mut points, mut stable, mut worst) = (0, 0, 0.0_f64);
    while points < 500 {
        let p = Parameters {
            alpha: random.between(0.5, 1.5),
            omega: random.between(0.7, 4.0),
            periods: random.between(1.0, 3.999) as u32,
            restitution: random.between(0.0, 1.0),
            wall: random.between(-0.4, 0.4),
            damping: random.between(0.0, 0.4),
            force: 1.0,
            displacement_gain: random.between(-0.3, 0.3),
            velocity_gain: random.between(-0.3, 0.3),
            branch: if points % 10 == 0 { Branch::Minus } else { Branch::Plus },
        };
        let kick = [Kick::None, Kick::Mean, Kick::Before, Kick::After][points % 4];
        let Ok(found) = orbit(&p) else {
            assert!(
                p.branch == Branch::Minus || p.wall > 0.0 || orbit_by_exponential(&p).is_none(),
                "{p:?}"
            );
            continue;
        };
        let (v, sigma) = orbit_by_exponential(&p).unwrap();
        assert!((v - found.velocity).abs() < 1e-9 * (1.0 + v), "{p:?} {v} {}", found.velocity);
        if found.saltation.abs() > 1e3 || found.period > 15.0 {
            continue;
        }
        let moduli = monodromy(&p, sigma, kick.factor(&p.restitution), 40);
        if (moduli[0] - 1.0).abs() < 1e-6 {
            continue;
        }
        points += 1;
        let g = Characteristic::new(&p, &found, kick);
        let (verdict, zeros) = exact_verdict(&g);
        let outside = moduli.iter().filter(|&&modulus| modulus > 1.0).count();
        assert_eq!(zeros, Some(u32::try_from(outside).unwrap()), "{p:?} {kick:?} {moduli:?}");
        assert_eq!(verdict == Verdict::Stable, outside == 0);
        stable += u32::from(outside == 0);
        let list = multipliers(&g, 0.9 * moduli[0].min(1.0)).unwrap();
        let leading = list.values[0].norm_squared().sqrt();
        let error = (leading - moduli[0]).abs() / moduli[0];
        worst = worst.max(error);
        assert!(error < 1e-5, "{p:?} {kick:?}: {leading} {} {error:e}", moduli[0]);
    }
    println!("500 points, {stable} stable, leading multiplier differs by at most {worst:e}");
    assert!(stable > 50 && stable < 450);
}
