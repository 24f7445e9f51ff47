//! Changes of variable x = x(w), w = 0 at x = 0, and the series re-expanded in w.

use super::ResummationError;
use lindstedt_algebra::Stop;
use rug::Float;
use rug::ops::Pow;

/// Bits to which w is bisected before Newton's rule doubles them.
const BISECTED: u32 = 64;

/// A change of variable.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Map {
    /// x = s u/(1 - u), u = x/(s + x): x = infinity becomes u = 1, x = -s infinity.
    Rational {
        /// s > 0.
        scale: Float,
    },
    /// The plane cut along the two rays arg x = +-pi a, |x| >= R, onto the unit disc:
    /// x = C w (1 - w)^(-2a) (1 + w)^(-2(1-a)), C = 4 R a^a (1-a)^(1-a) (derivation: on |w| = 1
    /// the phase of x is constant, +-pi a, and |x| is least, R, at sin^2(arg(w)/2) = a).
    /// a = 1 is the cut (-infinity, -R].
    Wedge {
        /// R > 0.
        modulus: Float,
        /// 0 <= a <= 1.
        fraction: Float,
    },
}

/// The coefficients of (1 + s w)^p, w^0 to w^order.
fn binomial_series(p: &Float, sign: i32, order: usize, bits: u32) -> Vec<Float> {
    let mut list = vec![Float::with_val(bits, 1)];
    for k in 0..order {
        let factor = Float::with_val(bits, p - k as u64) * sign / (k as u64 + 1);
        list.push(Float::with_val(bits, &list[k] * factor));
    }
    list
}

/// The product, truncated to the length of the first factor.
pub(super) fn multiply(a: &[Float], b: &[Float], bits: u32) -> Vec<Float> {
    let coefficient = |n: usize| {
        let mut sum = Float::new(bits);
        for (k, x) in a.iter().enumerate().take(n + 1) {
            if let Some(y) = b.get(n - k) {
                sum += Float::with_val(bits, x * y);
            }
        }
        sum
    };
    (0..a.len()).map(coefficient).collect()
}

/// The product with s w/(1 - w), truncated to the same length: s times the sum of all lower coefficients.
fn shifted_sums(a: &[Float], scale: &Float, bits: u32) -> Vec<Float> {
    let mut sum = Float::new(bits);
    let next = |c: &Float| {
        let value = Float::with_val(bits, &sum * scale);
        sum += c;
        value
    };
    a.iter().map(next).collect()
}

/// C of the wedge.
pub(super) fn wedge_constant(modulus: &Float, fraction: &Float, bits: u32) -> Float {
    let rest = Float::with_val(bits, 1 - fraction);
    let power = |x: &Float| Float::with_val(bits, x.pow(x));
    Float::with_val(bits, modulus * 4u32) * power(fraction) * power(&rest)
}

impl Map {
    /// (x/(x'(0) w))^p at x = x(w): what [`Self::expand`] divides by.
    pub(super) fn factor(&self, x: &Float, w: &Float, p: &Float, bits: u32) -> Float {
        let slope = match self {
            Self::Rational { scale } => scale.clone(),
            Self::Wedge { modulus, fraction } => wedge_constant(modulus, fraction, bits),
        };
        if w.is_zero() {
            return Float::with_val(bits, 1);
        }
        let ratio = Float::with_val(bits, x / w) / slope;
        Float::with_val(bits, ratio.pow(p))
    }

    /// The coefficients of x(w).
    fn series(&self, order: usize, bits: u32) -> Vec<Float> {
        let mut list = match self {
            Self::Rational { scale } => vec![Float::with_val(bits, scale); order],
            Self::Wedge { modulus, fraction } => {
                let twice = Float::with_val(bits, fraction * 2u32);
                let upper = binomial_series(&Float::with_val(bits, -&twice), -1, order, bits);
                let lower = binomial_series(&(twice - 2u32), 1, order, bits);
                let constant = wedge_constant(modulus, fraction, bits);
                let product = multiply(&upper, &lower, bits);
                product.into_iter().take(order).map(|c| c * &constant).collect()
            }
        };
        list.insert(0, Float::new(bits));
        list.truncate(order + 1);
        list
    }

    /// w at x.
    ///
    /// # Errors
    /// [`ResummationError::OutsideMap`] for x <= -s, and where w is +-1 to a quarter of the bits;
    /// [`ResummationError::Stopped`].
    pub fn inverse(&self, x: &Float, bits: u32, stop: &Stop) -> Result<Float, ResummationError> {
        let (modulus, fraction) = match self {
            Self::Rational { scale } => {
                let denominator = Float::with_val(bits, x + scale);
                let inside = denominator > 0 && x.is_finite();
                return if inside {
                    Ok(Float::with_val(bits, x / denominator))
                } else {
                    Err(ResummationError::OutsideMap)
                };
            }
            Self::Wedge { modulus, fraction } => (modulus, fraction),
        };
        // ln |x/C| = ln |w| - 2a ln(1 - w) - 2(1 - a) ln(1 + w) is monotone in w on (-1, 0)
        // and (0, 1): bisection for |w|.
        if x.is_zero() {
            return Ok(Float::new(bits));
        }
        let quotient = Float::with_val(bits, x / wedge_constant(modulus, fraction, bits));
        let goal = Float::with_val(bits, quotient.abs_ref()).ln();
        let negative = x.is_sign_negative();
        let twice = Float::with_val(bits, fraction * 2u32);
        let rest = Float::with_val(bits, 2 - &twice);
        let (ahead, behind) = if negative { (&rest, &twice) } else { (&twice, &rest) };
        let height = |w: &Float| {
            let log = Float::with_val(bits, w.ln_ref());
            let minus = Float::with_val(bits, -w).ln_1p() * ahead;
            log - minus - Float::with_val(bits, w.ln_1p_ref()) * behind
        };
        let mut high = Float::with_val(bits, 1);
        // |w| ~ |x/C| for small x; a factor of 16 covers (1 - w)^2 (1 + w)^2 for |w| < 1.
        let mut low = Float::with_val(bits, quotient.abs_ref()) >> 4u32;
        low = low.min(&(Float::with_val(bits, 1) >> 5u32));
        let mut width = Float::with_val(bits, &high - &low);
        while width > Float::with_val(53, &low) >> bits {
            if stop.asked() {
                return Err(ResummationError::Stopped);
            }
            let rest = Float::with_val(53, 1 - &high).min(&Float::with_val(53, &low));
            if width < rest >> BISECTED {
                for _ in 0..(bits / BISECTED).max(1).ilog2() + 2 {
                    let slope = Float::with_val(bits, low.recip_ref())
                        + Float::with_val(bits, ahead / Float::with_val(bits, 1 - &low))
                        - Float::with_val(bits, behind / Float::with_val(bits, &low + 1u32));
                    low -= (height(&low) - &goal) / slope;
                }
                break;
            }
            let middle = Float::with_val(bits, &low + &high) >> 1u32;
            if middle == low || middle == high {
                break;
            }
            if height(&middle) < goal {
                low = middle;
            } else {
                high = middle;
            }
            width = Float::with_val(bits, &high - &low);
        }
        if Float::with_val(bits, 1 - &low) < Float::with_val(bits, 1) >> (bits / 4) {
            return Err(ResummationError::OutsideMap);
        }
        Ok(if negative { -low } else { low })
    }

    /// The coefficients in w of (x'(0) w/x)^p sum c_n x(w)^n, bounded for f ~ x^p: the same order,
    /// O(N^3) products, O(N^2) for the rational map. The first factor is (1 - w)^p for the rational map.
    /// It means nothing once `stop` said so.
    #[must_use]
    pub fn expand(&self, c: &[Float], prefactor: &Float, bits: u32, stop: &Stop) -> Vec<Float> {
        let order = c.len().saturating_sub(1);
        let x = self.series(order, bits);
        let mut power = match self {
            Self::Rational { .. } => binomial_series(prefactor, -1, order, bits),
            Self::Wedge { fraction, .. } => {
                let upper = Float::with_val(bits, fraction * prefactor) << 1u32;
                let lower = Float::with_val(bits, prefactor << 1u32) - &upper;
                let lower = binomial_series(&lower, 1, order, bits);
                multiply(&binomial_series(&upper, -1, order, bits), &lower, bits)
            }
        };
        let mut sum = vec![Float::new(bits); c.len()];
        for coefficient in c {
            if stop.asked() {
                break;
            }
            for (total, p) in sum.iter_mut().zip(&power) {
                *total += Float::with_val(bits, coefficient * p);
            }
            power = match self {
                Self::Rational { scale } => shifted_sums(&power, scale, bits),
                Self::Wedge { .. } => multiply(&power, &x, bits),
            };
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BITS: u32 = 200;

    fn float(x: f64) -> Float {
        Float::with_val(BITS, x)
    }

    fn maps() -> Vec<Map> {
        let mut list = vec![Map::Rational { scale: float(2.0) }];
        for fraction in [0.0, 0.3, 0.57, 1.0] {
            list.push(Map::Wedge { modulus: float(3.0), fraction: float(fraction) });
        }
        list
    }

    /// The series of x(w) at the inverse gives x back.
    #[test]
    fn inverse_and_series_agree() {
        for map in maps() {
            for x in [-0.2, -1e-30, 1e-40, 0.1, 0.25] {
                let w = map.inverse(&float(x), BITS, &Stop::default()).unwrap();
                let terms = map.series(120, BITS);
                let value = terms.iter().rev().fold(Float::new(BITS), |sum, c| sum * &w + c);
                let error = (value - float(x)).to_f64() / x;
                assert!(error.abs() < 1e-20, "{map:?} {x}: {error}");
            }
        }
    }

    /// w at some bits is w at twice as many, to the last few of them.
    #[test]
    fn inverse_to_all_bits() {
        for map in maps() {
            for x in [-0.2, -1e-30, 1e-40, 0.25, 3.0, 1e6] {
                let [low, high] = [BITS, 2 * BITS].map(|bits| {
                    map.inverse(&Float::with_val(bits, x), bits, &Stop::default())
                        .map(|w| Float::with_val(BITS, w))
                });
                let (Ok(low), Ok(high)) = (low, high) else { continue };
                let error = (Float::with_val(53, &low - &high) / &high).abs();
                assert!(error < 1e-56, "{map:?} {x}: {error}");
            }
        }
    }

    /// 1/(1 + x) re-expanded and summed outside its own disc.
    #[test]
    fn continuation() {
        let c: Vec<Float> = (0..61).map(|n| float(if n % 2 == 0 { 1.0 } else { -1.0 })).collect();
        let map = Map::Wedge { modulus: float(1.0), fraction: float(1.0) };
        let w = map.inverse(&float(5.0), BITS, &Stop::default()).unwrap();
        let terms = map.expand(&c, &float(0.0), BITS, &Stop::default());
        let value = terms.iter().rev().fold(Float::new(BITS), |sum, c| sum * &w + c);
        assert!((value * 6u32 - 1u32).abs() < 1e-15);
        // sqrt(1 + x + x^2) ~ x, bounded by the prefactor; its branch points by the wedge.
        let mut c = vec![float(1.0), float(0.5)];
        for n in 2..61usize {
            let k = n as f64;
            let next = float(3.0 - 2.0 * k) * &c[n - 1] + float(6.0 - 2.0 * k) * &c[n - 2];
            c.push(next / (2.0 * k));
        }
        let map = Map::Wedge { modulus: float(1.0), fraction: float(2.0) / 3u32 };
        let (x, p) = (float(20.0), float(1.0));
        let w = map.inverse(&x, BITS, &Stop::default()).unwrap();
        let terms = map.expand(&c, &p, BITS, &Stop::default());
        let value = terms.iter().rev().fold(Float::new(BITS), |sum, c| sum * &w + c);
        let value = value * map.factor(&x, &w, &p, BITS);
        // Without the factor 2e-2.
        assert!((value - float(421.0).sqrt()).abs() < 1e-6);
        let rational = Map::Rational { scale: float(1.0) };
        assert_eq!(
            rational.inverse(&float(-1.0), BITS, &Stop::default()),
            Err(ResummationError::OutsideMap)
        );
    }
}
