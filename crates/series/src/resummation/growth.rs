//! The growth of coefficients: entire, a radius of convergence, or factorial.

use super::pade::log2;
use rug::Float;

/// What the coefficients c_n tell of the radius of convergence.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Growth {
    /// Too few coefficients that do not vanish, or contradictory ones.
    Undecided,
    /// |c_n| falls like 1/n!^g, g > 0: no singularity.
    Entire,
    /// A finite radius, estimated from the slope of log |c_n|.
    Radius {
        /// The radius.
        radius: f64,
        /// What it may be wrong by, estimated: its spread over shorter lists of coefficients, and
        /// 3/N of it for the power of n that a singularity adds to the slope.
        error: f64,
    },
    /// |c_n| grows like n!^g, g > 0: the series diverges for every argument, it is asymptotic.
    Factorial {
        /// g, estimated.
        rate: f64,
    },
}

/// The least number of non-zero coefficients to say anything, and to call a series factorial or
/// entire: the coefficients of a function with a radius may swell and ebb over twenty orders.
const FEWEST: usize = 8;
const FEWEST_TO_EXCLUDE_A_RADIUS: usize = 20;
/// Of |g|: a singularity (1 - x)^(-p) shows up as g = (p - 1)/n on a finite stretch; a larger one
/// contradicts a radius, and beyond the second bound in every fit it excludes one.
const MOST_WITH_A_RADIUS: f64 = 0.2;
const LEAST_WITHOUT: f64 = 0.4;

/// Fits ln |c_n| = a + b n + g ln n! and a + b n + h ln n over the last two thirds; once more
/// without the last few coefficients, to a quarter of them: g must agree in sign and be large in
/// all of these fits before a series is called factorial or entire.
///
/// |c_n| is replaced by its upper envelope over four orders, so that the oscillation from a
/// pair of complex singularities does not disturb. Heuristic: what a finite number of
/// coefficients can say.
#[must_use]
pub fn growth(c: &[Float]) -> Growth {
    let logs: Vec<(f64, f64)> = (0u32..)
        .zip(c)
        .skip(1)
        .filter_map(|(n, x)| Some((f64::from(n), log2(x)? * std::f64::consts::LN_2)))
        .collect();
    if logs.len() < FEWEST {
        return Growth::Undecided;
    }
    let Some((rate, radius)) = rate_and_radius(&logs) else { return Growth::Undecided };
    let shorter = (logs.len() - logs.len() / 4..=logs.len()).filter_map(|n| logs.get(..n));
    let fits: Vec<(f64, f64)> = shorter.filter_map(rate_and_radius).collect();
    let rates: Vec<f64> = fits.iter().map(|fit| fit.0).collect();
    let long = logs.len() >= FEWEST_TO_EXCLUDE_A_RADIUS;
    if long && rates.iter().all(|g| *g > LEAST_WITHOUT) {
        Growth::Factorial { rate }
    } else if long && rates.iter().all(|g| *g < -LEAST_WITHOUT) {
        Growth::Entire
    } else if rates.iter().all(|g| g.abs() < MOST_WITH_A_RADIUS)
        || long && rate.abs() < MOST_WITH_A_RADIUS
    {
        let spread = fits.iter().map(|fit| (fit.1 - radius).abs()).fold(0.0, f64::max);
        Growth::Radius { radius, error: spread + 3.0 * radius / logs.len() as f64 }
    } else {
        Growth::Undecided
    }
}

/// g, and exp(-b) of the fit without it.
fn rate_and_radius(logs: &[(f64, f64)]) -> Option<(f64, f64)> {
    let [_, slope, _] = fit(logs, |_| 0.0)?;
    let envelope: Vec<(f64, f64)> = logs
        .iter()
        .enumerate()
        .skip(logs.len() / 3)
        .map(|(i, &(n, _))| {
            let near = logs.iter().take(i + 1).filter(|(m, _)| n - m < 4.0);
            (n, near.fold(f64::NEG_INFINITY, |top, (m, y)| top.max(y + slope * (n - m))))
        })
        .collect();
    let (factorial, power) = (fit(&envelope, log_factorial)?, fit(&envelope, f64::ln)?);
    Some((factorial[2], (-power[1]).exp()))
}

/// ln n! for n >= 1 by Stirling's series (1e-3 at 1, where it does not matter).
fn log_factorial(n: f64) -> f64 {
    n * n.ln() - n + 0.5 * (std::f64::consts::TAU * n).ln() + 1.0 / (12.0 * n)
}

/// Least squares for y = a + b n + g f(n); without the last term where f vanishes.
fn fit(points: &[(f64, f64)], f: impl Fn(f64) -> f64) -> Option<[f64; 3]> {
    let mut normal = [[0.0f64; 4]; 3];
    // Centred at the mean for the sake of the conditioning.
    let count = points.len() as f64;
    let middle = points.iter().map(|p| p.0).sum::<f64>() / count;
    let level = points.iter().map(|p| f(p.0)).sum::<f64>() / count;
    for &(n, y) in points {
        let row = [1.0, n - middle, f(n) - level, y];
        for i in 0..3 {
            for j in 0..4 {
                normal[i][j] += row[i] * row[j];
            }
        }
    }
    let mut solution = [0.0; 3];
    // Symmetric and positive: no pivoting. A vanishing third pivot means no third term.
    for k in 0..3 {
        let pivot = normal[k][k];
        if pivot <= 1e-12 * count {
            if k < 2 {
                return None;
            }
            break;
        }
        for i in k + 1..3 {
            let factor = normal[i][k] / pivot;
            let pivot_row = normal[k];
            for (entry, above) in normal[i].iter_mut().zip(pivot_row).skip(k) {
                *entry -= factor * above;
            }
        }
    }
    for k in (0..3).rev() {
        if normal[k][k] > 1e-12 * count {
            let rest: f64 = (k + 1..3).map(|j| normal[k][j] * solution[j]).sum();
            solution[k] = (normal[k][3] - rest) / normal[k][k];
        }
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::ops::Pow;

    fn list(f: impl Fn(u32) -> Float) -> Vec<Float> {
        (0..41).map(f).collect()
    }

    fn float(x: f64) -> Float {
        Float::with_val(100, x)
    }

    #[test]
    fn kinds_of_growth() {
        let factorial = |n: u32| Float::with_val(100, Float::factorial(n));
        assert_eq!(growth(&list(|n| 1 / factorial(n))), Growth::Entire);
        for power in [0.5, 1.0, 2.0] {
            let found = growth(&list(|n| factorial(n).pow(power)));
            let Growth::Factorial { rate } = found else { panic!("{found:?}") };
            assert!((rate / power - 1.0).abs() < 0.25, "{power}: {rate}");
        }
        // (1 - x/3)^p, and a pair of poles at 2 exp(+-i phi).
        for p in [-2.0, -1.0, -0.5, 0.5, 1.5, 2.5] {
            let mut c = vec![float(1.0)];
            for n in 1..41 {
                let k = f64::from(n) - 1.0;
                c.push(float((k - p) / (k + 1.0) / 3.0) * &c[n as usize - 1]);
            }
            let found = growth(&c);
            let Growth::Radius { radius, error } = found else { panic!("{p}: {found:?}") };
            assert!((radius - 3.0).abs() < error.min(0.1), "{p}: {radius} +- {error}");
        }
        for phi in [0.3, 1.0, 1.79, 2.9] {
            let found = growth(&list(|n| float((f64::from(n) * phi).cos() / 2f64.powi(n as i32))));
            let Growth::Radius { radius, error } = found else { panic!("{phi}: {found:?}") };
            assert!((radius - 2.0).abs() < error.min(0.2), "{phi}: {radius} +- {error}");
        }
        // Factorial ones, too few to tell.
        let few: Vec<Float> = list(|n| factorial(n).pow(2.0f64)).into_iter().take(15).collect();
        assert_eq!(growth(&few), Growth::Undecided);
        assert_eq!(growth(&list(|n| float(if n < 3 { 1.0 } else { 0.0 }))), Growth::Undecided);
    }
}
