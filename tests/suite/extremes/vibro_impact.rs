//! The orbit of the vibro-impact oscillator and the verdict about its stability.

use super::support::{Grid, rational};
use lindstedt::Exact;
use lindstedt_algebra::Stop;
use lindstedt_impact::parameters::{Branch, ExactParameters};
use lindstedt_impact::report::{Request, certified_stability, stability};
use rug::Float;
use rug::float::Constant;

/// The impact velocity, c < 2 alpha: with x = P cos + Q sin of omega t + e^(-ct/2)(C cos + D sin) of
/// Omega t, x(0) = x(T) = s, x'(T) = v, x'(0) = -R v, where (P, Q) is the forced response with any
/// phase, P^2 + Q^2 = F^2: linear in v except the last equation, a quadratic one. Both roots.
fn velocities(values: [&str; 6], periods: u32, bits: u32) -> Option<[Float; 2]> {
    let [alpha, omega, restitution, wall, damping, force] =
        values.map(|v| Float::with_val(bits, rational(v)));
    let f = |x: &Float| x.clone();
    let half = f(&damping) / 2u32;
    let square = f(&alpha).square() - f(&half).square();
    if square <= 0 {
        return None;
    }
    let free = square.sqrt();
    let period = Float::with_val(bits, Constant::Pi) * 2u32 * periods / &omega;
    let decay = (-f(&half) * &period).exp();
    let (sine, cosine) = (f(&free) * &period).sin_cos(Float::new(bits));
    // y = C cos + D sin with y(0) = C, y'(0) = W: y(T) = e (C (cos + h sin/W0) + V sin/W0) etc.;
    // P = s - C, and x(T) = s gives y(T) = C; x'(T) - x'(0) = (1 + R) v = y'(T) - y'(0).
    let h = f(&half) / &free;
    let yy = f(&decay) * (f(&cosine) + f(&h) * &sine);
    let yv = f(&decay) * &sine / &free;
    let vy = -f(&decay) * &sine * (f(&free) + f(&h) * &half);
    let vv = f(&decay) * (f(&cosine) - f(&h) * &sine);
    // (yy - 1) C + yv V = 0, vy C + (vv - 1) V = (1 + R) v.
    let one = Float::with_val(bits, 1);
    let det = (f(&yy) - &one) * (f(&vv) - &one) - f(&yv) * &vy;
    if det.is_zero() {
        return None;
    }
    let jump = f(&restitution) + 1u32;
    let c = -f(&yv) * &jump / &det;
    let slope = (yy - &one) * &jump / &det;
    // x'(0) = omega Q + V = -R v.
    let q = -(slope + &restitution) / &omega;
    // (s - c v)^2 + q^2 v^2 = F^2.
    let detuning = f(&alpha).square() - f(&omega).square();
    let forced = force.square() / (detuning.square() + (damping * &omega).square());
    let a = f(&c).square() + q.square();
    let b = f(&wall) * &c;
    let rest = wall.square() - forced;
    let discriminant = f(&b).square() - f(&a) * &rest;
    if discriminant < 0 {
        return None;
    }
    let root = discriminant.sqrt();
    // v = (b +- root)/a, the one without cancellation first.
    let large = if b.is_sign_negative() { f(&b) - &root } else { f(&b) + &root };
    Some([f(&large) / &a, rest / large])
}

fn grid_of(gains: &[&str], digits: &[u32]) -> Grid {
    let mut grid = Grid::default();
    let base = ["1", "13/5", "4/5", "0", "1/20", "1"];
    let mut sets = vec![base];
    for (position, _) in base.iter().enumerate() {
        for value in ["0", "1e-300", "1e-10", "1/3", "1", "10", "1e10", "1e300"] {
            let mut set = base;
            set[position] = value;
            sets.push(set);
        }
    }
    for values in sets {
        // The orbit is the same with every gain.
        let truth = velocities(values, 1, 16_000);
        for gain in gains {
            let [alpha, omega, restitution, wall, damping, force] =
                values.map(|v| Exact::Rational(rational(v)));
            let p = ExactParameters {
                alpha,
                omega,
                periods: 1,
                restitution,
                wall,
                damping,
                force,
                displacement_gain: rational(gain).into(),
                velocity_gain: rational("0").into(),
                branch: Branch::Plus,
            };
            for &digits in digits {
                let label = format!("{values:?} A = {gain} digits {digits}");
                grid.cell(&label, |grid| {
                    let report = match certified_stability(
                        &p,
                        &Request::default(),
                        digits,
                        &Stop::default(),
                    ) {
                        Ok(report) => report,
                        Err(error) => return grid.refused(&error),
                    };
                    let orbit = match &report.orbit {
                        Ok(orbit) => orbit,
                        Err(error) => return grid.refused(error),
                    };
                    let found = orbit.orbit.velocity.ball();
                    let Some([x, y]) = &truth else {
                        return grid.refused(&"NoTruth");
                    };
                    // The branch: the root with the larger velocity.
                    let larger = if x > y { x } else { y };
                    grid.certified(&label, found, larger, 4_000);
                });
                let label = format!("{label} in doubles");
                grid.cell(&label, |grid| {
                    let report =
                        match stability(&p.nearest(), &Request::default(), &Stop::default()) {
                            Ok(report) => report,
                            Err(error) => return grid.refused(&error),
                        };
                    match &report.orbit {
                        Ok(orbit) if !orbit.orbit.velocity.is_finite() => {
                            grid.defect(&label, format!("velocity {}", orbit.orbit.velocity));
                        }
                        Ok(_) => {}
                        Err(error) => grid.refused(error),
                    }
                });
            }
        }
    }
    grid
}

#[test]
fn orbits() {
    grid_of(&["2/25", "1e300"], &[16]).finish("orbits", 62);
}

#[test]
#[ignore = "minutes"]
fn every_orbit() {
    grid_of(&["0", "2/25", "1e-300", "1e300"], &[1, 3, 16, 100, 300]).finish("orbits", 70);
}
