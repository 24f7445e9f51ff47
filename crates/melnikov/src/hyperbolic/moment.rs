//! Integrals with powers of the argument.

use super::line_fourier;
use lindstedt_number::ball::{Ball, Balls};
use rug::{Integer, Rational};

/// c_0 + c_1 pi + c_2 pi^2 + ... with rational coefficients, without trailing zeros.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PiPolynomial {
    /// c_0, c_1, ...
    pub coefficients: Vec<Rational>,
}

impl PiPolynomial {
    /// An enclosure at the precision of the context.
    #[must_use]
    pub fn ball(&self, balls: Balls) -> Ball {
        let pi = balls.pi();
        self.coefficients
            .iter()
            .rev()
            .fold(balls.zero(), |sum, c| balls.add(&balls.mul(&sum, &pi), &balls.from_rational(c)))
    }
}

/// The integral of z^n sech^p z tanh^q z over the line, exactly; `None` for p = 0.
///
/// With J_{p,q}(w) of [`line_fourier`] it is (-1)^(n div 2) n! [w^n] J_{p,q}(w), 0 for odd n + q:
/// the integrals of cos(w z) and sin(w z) are the generating functions of the even and the odd
/// powers. The kernels are expanded by
///
///   pi sech(pi w/2) = pi/cosh x,   pi w csch(pi w/2) = 2/(sinh x/x),   x = pi w/2,
///
/// whose Taylor coefficients are rational in x^2. Cost O(n^2 + p + q) rational products.
///
/// ```
/// use lindstedt_melnikov::hyperbolic::line_moment;
/// use rug::Rational;
/// // The integral of z^2 sech^2 z is pi^2/6, that of z^2 sech z is pi^3/4.
/// let of = |n, p, q| line_moment(n, p, q).map(|m| m.coefficients);
/// let zero = Rational::new;
/// assert_eq!(of(2, 2, 0), Some(vec![zero(), zero(), Rational::from((1, 6))]));
/// assert_eq!(of(2, 1, 0), Some(vec![zero(), zero(), zero(), Rational::from((1, 4))]));
/// ```
#[must_use]
pub fn line_moment(n: u32, p: u32, q: u32) -> Option<PiPolynomial> {
    let form = line_fourier(p, q)?;
    let mut result = PiPolynomial::default();
    if (n + q) % 2 == 1 {
        return Some(result);
    }
    let order = n as usize;
    let kernels = [
        (&form.sech, reciprocal_kernel(order, 0), Rational::from(1), 1),
        (&form.csch, reciprocal_kernel(order, 1), Rational::from(2), 0),
    ];
    let sign = if (n / 2) % 2 == 1 { -1 } else { 1 };
    let factorial = Rational::from(Integer::from(Integer::factorial(n))) * sign;
    for (polynomial, kernel, scale, pi_power) in kernels {
        for (k, c) in polynomial.iter().enumerate().take(order + 1) {
            // [w^(n-k)] of the kernel: kernel[j] x^(2j) = kernel[j] (pi/2)^(2j) w^(2j).
            let rest = order - k;
            if rest % 2 == 1 {
                continue;
            }
            let half = Rational::from((1, Integer::from(1) << u32::try_from(rest).ok()?));
            let value = Rational::from(c * &kernel[rest / 2]) * half * &scale * &factorial;
            let index = rest + pi_power;
            if result.coefficients.len() <= index {
                result.coefficients.resize(index + 1, Rational::new());
            }
            result.coefficients[index] += value;
        }
    }
    while result.coefficients.last().is_some_and(Rational::is_zero) {
        result.coefficients.pop();
    }
    Some(result)
}

/// The Taylor coefficients in x^2 of 1/cosh x (shift 0) or of x/sinh x (shift 1): the reciprocal
/// of sum_j x^(2j)/(2j + shift)!.
fn reciprocal_kernel(order: usize, shift: u32) -> Vec<Rational> {
    let series = |j: usize| {
        let argument = u32::try_from(2 * j).unwrap_or(u32::MAX).saturating_add(shift);
        Rational::from((1, Integer::from(Integer::factorial(argument))))
    };
    let mut reciprocal = vec![Rational::from(1)];
    for m in 1..=order / 2 {
        let sum: Rational = (1..=m).map(|j| series(j) * &reciprocal[m - j]).sum();
        reciprocal.push(-sum);
    }
    reciprocal
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trapezoid rule, which converges geometrically for these integrands.
    fn quadrature(n: u32, p: u32, q: u32) -> f64 {
        let h = 0.05;
        (-1200..=1200)
            .map(|i| {
                let z = f64::from(i) * h;
                z.powi(n as i32) * z.cosh().recip().powi(p as i32) * z.tanh().powi(q as i32) * h
            })
            .sum()
    }

    #[test]
    fn moments_agree_with_quadrature() {
        let balls = Balls::new(120);
        for n in 0..8 {
            for p in 1..6 {
                for q in 0..6 {
                    let exact = line_moment(n, p, q).unwrap().ball(balls).midpoint().to_f64();
                    let expected = quadrature(n, p, q);
                    let error = (exact - expected).abs();
                    assert!(
                        error <= 1e-11 * (1.0 + expected.abs()),
                        "{n} {p} {q}: {exact} {expected}"
                    );
                }
            }
        }
        assert_eq!(line_moment(3, 0, 1), None);
    }
}
