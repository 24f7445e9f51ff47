//! The threshold in f64 by stable forms; surfaces of them are in `surface`.
//!
//! gamma = G cosh(z)/(2z), z = pi omega/(2 sqrt a), G as in [`crate::StickSlip::g`]. Why
//! 1 - |v*|/V is not formed as it stands: `docs/src/melnikov.md`.

use crate::{FastPoint, MelnikovError};
use std::f64::consts::{FRAC_PI_2, LN_2};

/// A threshold in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastThreshold {
    /// D/F with its sign; infinite or 0 where it leaves the range of f64 (then use `ln_abs`).
    pub signed: f64,
    /// ln |signed|, finite wherever G != 0; absolute error at most 4e-15 + 4 eps |ln_abs| away
    /// from zeros of G.
    pub ln_abs: f64,
    /// An estimate of the absolute error of `signed` by rounding: 8 eps sum |terms of G| factor.
    /// Near a zero of G the relative error is not small, this one is.
    pub error: f64,
}

/// m 2^e with an exponent that does not overflow.
#[derive(Clone, Copy)]
struct Scaled {
    mantissa: f64,
    exponent: i64,
}

/// pi/2 - FRAC_PI_2, the second word of pi/2 in double-double.
const FRAC_PI_2_LOW: f64 = 6.123_233_995_736_766e-17;

const SPLIT: i32 = 1 << 10;

/// x = m 2^e, 1 <= |m| < 2, for finite x != 0 (by powers of two only: exact).
fn split(x: f64) -> (f64, i64) {
    if x == 0.0 || !x.is_finite() {
        return (x, 0);
    }
    let (x, shift) = if x.abs() < f64::MIN_POSITIVE { (x * 2f64.powi(60), -60) } else { (x, 0) };
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
    let mantissa = f64::from_bits((bits & !(0x7ff << 52)) | (1023 << 52));
    (mantissa, exponent + shift)
}

/// m 2^e rounded once (0 or infinite outside the range).
fn join(mantissa: f64, exponent: i64) -> f64 {
    let mut rest = exponent.clamp(-4200, 4200) as i32;
    let mut value = mantissa;
    while rest > SPLIT - 24 {
        value *= 2f64.powi(SPLIT - 24);
        rest -= SPLIT - 24;
    }
    // Downwards, all steps but the last are exact: 2^-1000 keeps m in [1, 2) normal.
    if rest < -1000 {
        let last = (rest + 1000).max(-1070);
        return value * 2f64.powi(-1000) * 2f64.powi(last);
    }
    value * 2f64.powi(rest)
}

impl Scaled {
    fn new(x: f64) -> Self {
        let (mantissa, exponent) = split(x);
        Self { mantissa, exponent }
    }
    fn mul(self, other: Self) -> Self {
        let product = Self::new(self.mantissa * other.mantissa);
        Self { exponent: product.exponent + self.exponent + other.exponent, ..product }
    }
    fn add(self, other: Self) -> Self {
        let (large, small) = match (self.mantissa == 0.0, other.mantissa == 0.0) {
            (true, _) => return other,
            (_, true) => return self,
            _ if self.exponent >= other.exponent => (self, other),
            _ => (other, self),
        };
        let sum = large.mantissa + join(small.mantissa, small.exponent - large.exponent);
        let sum = Self::new(sum);
        Self { exponent: sum.exponent + large.exponent, ..sum }
    }
    fn ln_abs(self) -> f64 {
        (self.exponent as f64).mul_add(LN_2, self.mantissa.abs().ln())
    }
}

/// 1 - |v|/V without cancellation: (a^2 - 2 b v^2)/(a (a + sqrt(2b)|v|)), the numerator by
/// two-products. a and v are scaled to [1, 2) by powers of two, which is exact. The sign is that of
/// the exact value.
fn speed_gap(a: f64, b: f64, v: f64) -> f64 {
    if v == 0.0 {
        return 1.0;
    }
    let (ma, ea) = split(a);
    let (mv, ev) = split(v.abs());
    let (mb, eb) = split(b);
    // y^2 = 2 b v^2/a^2 = 2 mb mv^2/ma^2 2^(eb + 2 ev - 2 ea).
    let exponent = eb + 2 * ev - 2 * ea;
    if exponent > 8 {
        return -1.0;
    }
    if exponent < -240 {
        return 1.0;
    }
    let twice_b = mb * 2f64.powi(exponent as i32 + 1);
    let p = twice_b * mv;
    let p_low = twice_b.mul_add(mv, -p);
    let q = p * mv;
    let q_low = p.mul_add(mv, -q);
    let square = ma * ma;
    let square_low = ma.mul_add(ma, -square);
    let numerator = (square - q) + ((square_low - q_low) - p_low * mv);
    numerator / (ma * (ma + twice_b.sqrt() * mv))
}

/// The factor cosh(z)/(2z) of gamma as a product.
#[derive(Clone, Copy)]
pub(crate) struct ForcingFactor {
    // 1, or e^{z/2}: neither half overflows for z < 1400.
    first: f64,
    second: f64,
}

/// z = pi omega/(2 sqrt a) as a double-double, cosh(zh + zl) = cosh zh + zl sinh zh.
pub(crate) fn forcing_factor(a: f64, omega: f64) -> ForcingFactor {
    let root = a.sqrt();
    let root_low = (-root).mul_add(root, a) / (2.0 * root);
    let u = omega / root;
    let u_low = ((-u).mul_add(root, omega) - u * root_low) / root;
    let u_low = if u_low.is_finite() { u_low } else { 0.0 };
    let high = u * FRAC_PI_2;
    let low = u.mul_add(FRAC_PI_2, -high) + u * FRAC_PI_2_LOW + u_low * FRAC_PI_2;
    let low = if low.is_finite() { low } else { 0.0 };
    let twice = 2.0 * high;
    if high < 350.0 {
        let e = high.exp();
        let inverse = 1.0 / e;
        let cosh = 0.5 * (e + inverse) + low * (0.5 * (e - inverse));
        // 2z = 2 zh + 2 zl: the low word is below half an ulp.
        let second = cosh / twice;
        return ForcingFactor { first: 1.0, second };
    }
    let half = (high / 2.0).exp();
    ForcingFactor { first: half, second: half * (1.0 + low) / (2.0 * twice) }
}

impl ForcingFactor {
    /// The factor itself, where it is far from the ends of the range.
    pub(crate) fn moderate(&self) -> Option<f64> {
        let factor = self.first * self.second;
        is_near_one(factor).then_some(factor)
    }

    /// ln of the factor, formed only on demand: ln cosh z = z + ln(1 + e^{-2z}) - ln 2.
    fn ln(a: f64, omega: f64) -> f64 {
        let z = omega / a.sqrt() * FRAC_PI_2;
        let ln_z = if z >= f64::MIN_POSITIVE && z.is_finite() {
            z.ln()
        } else {
            omega.ln() - 0.5 * a.ln() + FRAC_PI_2.ln()
        };
        z + (-2.0 * z).exp().ln_1p() - 2.0 * LN_2 - ln_z
    }
}

/// V = a/sqrt(2b) as the sum of a double and its rounding error, and 1/V.
#[derive(Clone, Copy)]
pub(crate) struct LoopSpeed {
    high: f64,
    low: f64,
    inverse: f64,
}

impl LoopSpeed {
    /// For a and b near 1.
    pub(crate) fn new(a: f64, b: f64) -> Self {
        let root = (2.0 * b).sqrt();
        let root_low = (-root).mul_add(root, 2.0 * b) / (2.0 * root);
        let high = a / root;
        let low = ((-high).mul_add(root, a) - high * root_low) / root;
        Self { high, low, inverse: 1.0 / high }
    }
}

/// What gamma is made of where nothing comes near the ends of the range.
#[derive(Clone, Copy)]
pub(crate) struct Terms {
    pub(crate) speed: LoopSpeed,
    /// 2 T0, 4 alpha V/3, 4 beta V, 32 beta V^3/35.
    pub(crate) dry: f64,
    pub(crate) linear: f64,
    pub(crate) mixed: f64,
    pub(crate) cubic: f64,
    pub(crate) belt: f64,
    pub(crate) factor: f64,
}

impl Terms {
    pub(crate) fn new(p: &FastPoint, speed: LoopSpeed, factor: f64) -> Self {
        let v = speed.high;
        Self {
            speed,
            dry: 2.0 * p.dry,
            linear: 4.0 / 3.0 * v * p.alpha,
            mixed: 4.0 * v * p.beta,
            cubic: 32.0 / 35.0 * p.beta * (v * v * v),
            belt: p.belt_speed,
            factor,
        }
    }

    /// 4 V/3.
    pub(crate) fn linear_slope(&self) -> f64 {
        4.0 / 3.0 * self.speed.high
    }

    /// gamma; the smaller it is the less it is worth, see [`is_certain`].
    #[inline(always)]
    pub(crate) fn value(&self) -> f64 {
        self.factor * self.bracket()
    }

    /// gamma without the factor.
    ///
    /// 1 - |v*|/V is ((V - |v*|) + V_low)/V: the difference is exact near |v*| = V, where it cancels.
    #[inline(always)]
    pub(crate) fn bracket(&self) -> f64 {
        let LoopSpeed { high, low, inverse } = self.speed;
        let gap = ((high - self.belt.abs()) + low) * inverse;
        let gap = if gap > 0.0 { gap } else { 0.0 };
        let dry = self.dry * gap.sqrt();
        let smooth = self.mixed * (self.belt * self.belt) + self.cubic;
        (dry - self.linear) + smooth
    }
}

/// Whether no product of a few such numbers reaches the upper end of the range.
pub(crate) fn is_moderate(x: f64) -> bool {
    x.abs() < 1e40
}

/// Nor the lower one.
pub(crate) fn is_near_one(x: f64) -> bool {
    (1e-40..1e40).contains(&x)
}

/// Whether underflow had no part in a sum of moderate terms.
#[inline(always)]
pub(crate) fn is_certain(value: f64) -> bool {
    value.abs() > 1e-240
}

/// G with exponents that cannot overflow.
fn g_scaled(p: &FastPoint) -> (Scaled, Scaled) {
    let (mb, eb) = split(p.b);
    // sqrt(2b) with an even exponent.
    let even = (eb + 1) & !1;
    let root = (mb * 2f64.powi((eb + 1 - even) as i32)).sqrt();
    let a = Scaled::new(p.a);
    let quotient = Scaled::new(a.mantissa / root);
    let speed = Scaled { exponent: quotient.exponent + a.exponent - even / 2, ..quotient };
    let gap = speed_gap(p.a, p.b, p.belt_speed);
    let dry = if gap > 0.0 {
        Scaled::new(2.0 * gap.sqrt()).mul(Scaled::new(p.dry))
    } else {
        Scaled::new(0.0)
    };
    let linear = Scaled::new(-4.0 / 3.0).mul(speed).mul(Scaled::new(p.alpha));
    let belt = Scaled::new(p.belt_speed);
    let beta = Scaled::new(p.beta).mul(speed);
    let mixed = Scaled::new(4.0).mul(beta).mul(belt).mul(belt);
    let cubic = Scaled::new(32.0 / 35.0).mul(beta).mul(speed).mul(speed);
    let size = [dry, linear, mixed, cubic].into_iter().fold(Scaled::new(0.0), |sum, term| {
        sum.add(Scaled { mantissa: term.mantissa.abs(), ..term })
    });
    (dry.add(linear).add(mixed.add(cubic)), size)
}

impl FastPoint {
    /// Finite parameters, positive a, b, omega.
    ///
    /// # Errors
    /// [`MelnikovError::NotFinite`] or [`MelnikovError::NotPositive`] with the name.
    pub fn check(&self) -> Result<(), MelnikovError> {
        let all = [
            ("a", self.a, true),
            ("b", self.b, true),
            ("T0", self.dry, false),
            ("alpha", self.alpha, false),
            ("beta", self.beta, false),
            ("omega", self.omega, true),
            ("vstar", self.belt_speed, false),
        ];
        for (name, value, positive) in all {
            if !value.is_finite() {
                return Err(MelnikovError::NotFinite { name });
            }
            if positive && value <= 0.0 {
                return Err(MelnikovError::NotPositive { name });
            }
        }
        Ok(())
    }

    /// The threshold with its logarithm and error. Relative error at most 4e-15 (measured: see
    /// the tests) away from zeros of G, for every omega and every range of the parameters.
    ///
    /// # Errors
    /// Those of [`FastPoint::check`].
    ///
    /// ```
    /// use lindstedt_melnikov::FastPoint;
    /// let paper = FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.4 };
    /// let threshold = paper.threshold()?;
    /// assert!((threshold.signed - 0.6370713428481636).abs() < 1e-15);
    /// assert!((threshold.ln_abs - threshold.signed.ln()).abs() < 1e-15);
    /// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
    /// ```
    pub fn threshold(&self) -> Result<FastThreshold, MelnikovError> {
        self.check()?;
        let factor = forcing_factor(self.a, self.omega);
        let (g, size) = g_scaled(self);
        let ln_abs = g.ln_abs() + ForcingFactor::ln(self.a, self.omega);
        let signed = value(self, &factor);
        let relative = join(size.mantissa / g.mantissa.abs(), size.exponent - g.exponent);
        let error =
            if g.mantissa == 0.0 { 0.0 } else { 8.0 * f64::EPSILON * relative * signed.abs() };
        Ok(FastThreshold { signed, ln_abs, error })
    }

    /// Whether the plain form of G serves.
    pub(crate) fn is_moderate(&self) -> bool {
        let others = [self.dry, self.alpha, self.beta, self.belt_speed];
        is_near_one(self.a) && is_near_one(self.b) && others.into_iter().all(is_moderate)
    }
}

/// G times the factor; the scaled path where the plain one may leave the range.
pub(crate) fn value(p: &FastPoint, factor: &ForcingFactor) -> f64 {
    if let (true, Some(factor)) = (p.is_moderate(), factor.moderate()) {
        let plain = Terms::new(p, LoopSpeed::new(p.a, p.b), factor).value();
        if is_certain(plain) {
            return plain;
        }
    }
    let (g, _) = g_scaled(p);
    let (first, second) = (Scaled::new(factor.first), Scaled::new(factor.second));
    if factor.first.is_finite() && factor.second.is_finite() {
        let product = g.mul(first).mul(second);
        return join(product.mantissa, product.exponent);
    }
    let ln = g.ln_abs() + ForcingFactor::ln(p.a, p.omega);
    if g.mantissa == 0.0 { 0.0 } else { ln.exp().copysign(g.mantissa) }
}
