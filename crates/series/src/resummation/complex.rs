//! Complex numbers as pairs of floats, and the zeros of a real polynomial.

use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Constant;

/// re + i im, both at one precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Complex {
    /// The real part.
    pub re: Float,
    /// The imaginary part.
    pub im: Float,
}

impl Complex {
    /// A real number.
    #[must_use]
    pub fn real(re: Float) -> Self {
        let im = Float::new(re.prec());
        Self { re, im }
    }

    fn bits(&self) -> u32 {
        self.re.prec()
    }

    /// self + other.
    #[must_use]
    pub fn add(&self, other: &Self) -> Self {
        let bits = self.bits();
        Self {
            re: Float::with_val(bits, &self.re + &other.re),
            im: Float::with_val(bits, &self.im + &other.im),
        }
    }

    /// self - other.
    #[must_use]
    pub fn sub(&self, other: &Self) -> Self {
        let bits = self.bits();
        Self {
            re: Float::with_val(bits, &self.re - &other.re),
            im: Float::with_val(bits, &self.im - &other.im),
        }
    }

    /// self * other.
    #[must_use]
    pub fn mul(&self, other: &Self) -> Self {
        let bits = self.bits();
        Self {
            re: Float::with_val(bits, &self.re * &other.re - &self.im * &other.im),
            im: Float::with_val(bits, &self.re * &other.im + &self.im * &other.re),
        }
    }

    /// self / other; not finite for other = 0.
    #[must_use]
    pub fn div(&self, other: &Self) -> Self {
        let norm = Float::with_val(self.bits(), &other.re * &other.re + &other.im * &other.im);
        let conjugate = Self { re: other.re.clone(), im: -other.im.clone() };
        let mut quotient = self.mul(&conjugate);
        quotient.re /= &norm;
        quotient.im /= &norm;
        quotient
    }

    /// |self|.
    #[must_use]
    pub fn abs(&self) -> Float {
        Float::with_val(self.bits(), self.re.hypot_ref(&self.im))
    }

    /// arg self in (-pi, pi].
    #[must_use]
    pub fn arg(&self) -> Float {
        Float::with_val(self.bits(), self.im.atan2_ref(&self.re))
    }

    /// Whether both parts are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }

    /// self 2^k.
    #[must_use]
    pub fn shift(mut self, k: i32) -> Self {
        self.re <<= k;
        self.im <<= k;
        self
    }
}

/// p(z) for real coefficients from order 0, by Horner's rule.
#[must_use]
pub fn evaluate(polynomial: &[Float], z: &Complex) -> Complex {
    let mut sum = Complex::real(Float::new(z.bits()));
    for c in polynomial.iter().rev() {
        sum = sum.mul(z);
        sum.re += c;
    }
    sum
}

/// The derivative of a polynomial.
#[must_use]
pub fn derivative(polynomial: &[Float]) -> Vec<Float> {
    let indexed = polynomial.iter().enumerate().skip(1);
    indexed.map(|(k, c)| Float::with_val(c.prec(), c * (k as u64))).collect()
}

/// Sweeps of the simultaneous iteration before it is given up.
const MOST_SWEEPS: usize = 400;

/// All zeros of a real polynomial (coefficients from order 0; vanishing leading ones are
/// dropped), in ascending modulus: Aberth's simultaneous iteration from the radii of the Newton
/// polygon. Nothing where it does not settle to a quarter of the bits. O(n^2) per sweep, some
/// ten sweeps for simple zeros. More than 1024 bits and 32 per degree are not used: no zero is
/// asked for to 300 digits. Nothing once `stop` said so, which is asked for every zero of every sweep.
#[must_use]
pub fn zeros(polynomial: &[Float], bits: u32, stop: &Stop) -> Option<Vec<Complex>> {
    let degree = u32::try_from(polynomial.len()).unwrap_or(u32::MAX);
    let bits = bits.min(degree.saturating_mul(32).saturating_add(1024));
    let rounded: Vec<Float> = polynomial.iter().map(|c| Float::with_val(bits, c)).collect();
    let polynomial = rounded.as_slice();
    let used = polynomial.iter().rposition(|c| !c.is_zero())? + 1;
    let at_origin = polynomial.iter().position(|c| !c.is_zero())?;
    let p = &polynomial[at_origin..used];
    let slope = derivative(p);
    let mut list = starts(p, bits);
    let mut settled = vec![false; list.len()];
    let goal = -i64::from(bits) * 3 / 4;
    let mut last = i64::MAX;
    for _ in 0..MOST_SWEEPS {
        last = i64::MIN;
        for i in 0..list.len() {
            if settled[i] {
                continue;
            }
            if stop.asked() {
                return None;
            }
            let z = list[i].clone();
            // Newton's correction, repelled by the other approximations.
            let newton = evaluate(p, &z).div(&evaluate(&slope, &z));
            if !newton.is_finite() {
                // The derivative vanishes at the guess: step aside.
                list[i] = z.mul(&Complex {
                    re: Float::with_val(bits, 1.01),
                    im: Float::with_val(bits, 0.01),
                });
                last = 0;
                continue;
            }
            let one = Complex::real(Float::with_val(bits, 1));
            let mut repulsion = Complex::real(Float::new(bits));
            for (j, other) in list.iter().enumerate() {
                if j != i {
                    let term = one.div(&z.sub(other));
                    if term.is_finite() {
                        repulsion = repulsion.add(&term);
                    }
                }
            }
            let step = newton.div(&one.sub(&newton.mul(&repulsion)));
            if !step.is_finite() {
                continue;
            }
            let size = |x: &Float| x.get_exp().map_or(i64::MIN / 4, i64::from);
            let relative = size(&step.abs()) - size(&z.abs());
            settled[i] = relative < goal;
            last = last.max(relative);
            list[i] = z.sub(&step);
        }
        if last < goal {
            break;
        }
    }
    if last >= -i64::from(bits) / 4 {
        return None;
    }
    let origin = Complex::real(Float::new(bits));
    list.extend(std::iter::repeat_n(origin, at_origin));
    list.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    Some(list)
}

/// First guesses on circles whose radii are the slopes of the upper Newton polygon (Bini).
fn starts(p: &[Float], bits: u32) -> Vec<Complex> {
    let heights: Vec<Option<f64>> = p
        .iter()
        .map(|c| {
            let exponent = f64::from(c.get_exp()?);
            let (mantissa, _) = c.to_f64_exp();
            Some(exponent + mantissa.abs().log2())
        })
        .collect();
    let mut hull: Vec<(usize, f64)> = Vec::new();
    for (k, height) in heights.iter().enumerate() {
        let Some(height) = *height else { continue };
        while let [.., (i, a), (j, b)] = hull.as_slice() {
            let straight = a + (height - a) * ((j - i) as f64) / ((k - i) as f64);
            if *b <= straight {
                hull.pop();
            } else {
                break;
            }
        }
        hull.push((k, height));
    }
    let mut list = Vec::new();
    let turn = Float::with_val(bits, Constant::Pi) << 1u32;
    for pair in hull.windows(2) {
        let [(i, a), (j, b)] = pair else { continue };
        let count = j - i;
        let radius = Float::with_val(bits, (a - b) / count as f64).exp2();
        for k in 0..count {
            // An irrational offset breaks the symmetry of real polynomials.
            let fraction = (k as f64 + 0.3819 + 0.07 * *i as f64) / count as f64;
            let angle = Float::with_val(bits, &turn * fraction);
            let (sin, cos) = angle.sin_cos(Float::new(bits));
            list.push(Complex { re: cos * &radius, im: sin * &radius });
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zeros from 1e-6 to 1e9 and a pair: the product (z - a_k) multiplied out.
    #[test]
    fn zeros_of_a_product() {
        let bits = 400;
        let real: [f64; 5] = [1e-6, -0.5, 0.51, 3.0, 1e9];
        let mut p =
            vec![Float::with_val(bits, 5), Float::with_val(bits, 2), Float::with_val(bits, 1)];
        for root in real {
            let mut next = vec![Float::new(bits); p.len() + 1];
            for (k, c) in p.iter().enumerate() {
                next[k + 1] += c;
                next[k] -= Float::with_val(bits, c * root);
            }
            p = next;
        }
        let found = zeros(&p, bits, &Stop::default()).unwrap();
        assert_eq!(found.len(), 7);
        for root in real {
            let near = |z: &Complex| {
                let exact = Complex::real(Float::with_val(bits, root));
                z.sub(&exact).abs() / root.abs()
            };
            assert!(found.iter().any(|z| near(z) < 1e-60), "{root}");
        }
        let pair = Complex { re: Float::with_val(bits, -1), im: Float::with_val(bits, 2) };
        assert!(found.iter().any(|z| z.sub(&pair).abs() < 1e-60));
    }
}
