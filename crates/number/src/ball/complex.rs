//! Complex balls: a rectangle of two real balls, real and imaginary part.
//!
//! A [`Complex`] encloses one complex number z: Re z lies in `re` and Im z in `im`, always. As for
//! real balls the precision belongs to the context, [`ComplexBalls`]. With m the centre and
//! h = hypot(r_re, r_im) the half diagonal, every z of the rectangle has |z - m| <= h; where an
//! operation propagates h instead of the two radii, the bound stands beside it.

use super::{Ball, Balls, down, radius_zero, up};
use rug::{Float, Rational};

/// All complex numbers with real part in `re` and imaginary part in `im`.
#[derive(Clone, Debug)]
pub struct Complex {
    /// The real part.
    pub re: Ball,
    /// The imaginary part.
    pub im: Ball,
}

/// The context of complex ball arithmetic: real balls of one precision.
///
/// ```
/// use lindstedt_number::ball::{Balls, ComplexBalls};
/// use rug::Rational;
///
/// let complex = ComplexBalls::new(Balls::new(128));
/// let i = complex.i();
/// let e_to_i_pi = complex.exp(&complex.mul(&i, &complex.from_real(Balls::new(128).pi())));
/// assert!(e_to_i_pi.contains(&Rational::from(-1), &Rational::new()));
/// assert!(complex.div(&i, &complex.add(&e_to_i_pi, &complex.one())).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ComplexBalls {
    balls: Balls,
}

impl Complex {
    /// Whether both radii are finite, that is whether anything is known.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
    /// Whether both radii are 0.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.re.is_exact() && self.im.is_exact()
    }
    /// Whether 0 lies in the rectangle. Decided exactly.
    #[must_use]
    pub fn contains_zero(&self) -> bool {
        self.re.contains_zero() && self.im.contains_zero()
    }
    /// Whether p + i q lies in the rectangle. Decided exactly.
    #[must_use]
    pub fn contains(&self, p: &Rational, q: &Rational) -> bool {
        self.re.contains(p) && self.im.contains(q)
    }
    /// An upper bound of |z| (53 bits).
    #[must_use]
    pub fn abs_upper(&self) -> Float {
        up(self.re.abs_upper().hypot_ref(&self.im.abs_upper()))
    }
    /// A lower bound of |z| (53 bits), 0 where the rectangle contains 0.
    #[must_use]
    pub fn abs_lower(&self) -> Float {
        down(self.re.abs_lower().hypot_ref(&self.im.abs_lower()))
    }
    /// The half diagonal of the rectangle, rounded up: |z - m| is at most this.
    #[must_use]
    pub fn half_diagonal(&self) -> Float {
        up(self.re.radius().hypot_ref(self.im.radius()))
    }
    /// The rectangle shrunk to its centre.
    fn centre(&self) -> Self {
        let exact = |part: &Ball| Ball { midpoint: part.midpoint.clone(), radius: radius_zero() };
        Self { re: exact(&self.re), im: exact(&self.im) }
    }
}

impl ComplexBalls {
    /// The complex numbers over a context of real balls.
    #[must_use]
    pub fn new(balls: Balls) -> Self {
        Self { balls }
    }
    /// The context of the parts.
    #[must_use]
    pub fn real(self) -> Balls {
        self.balls
    }
    /// re + i im.
    #[must_use]
    pub fn from_parts(self, re: Ball, im: Ball) -> Complex {
        Complex { re, im }
    }
    /// A real number.
    #[must_use]
    pub fn from_real(self, re: Ball) -> Complex {
        Complex { re, im: self.balls.zero() }
    }
    /// p + i q, each part within half an ulp.
    #[must_use]
    pub fn from_rationals(self, p: &Rational, q: &Rational) -> Complex {
        Complex { re: self.balls.from_rational(p), im: self.balls.from_rational(q) }
    }
    /// 0, exactly.
    #[must_use]
    pub fn zero(self) -> Complex {
        self.from_real(self.balls.zero())
    }
    /// 1, exactly.
    #[must_use]
    pub fn one(self) -> Complex {
        self.from_real(self.balls.one())
    }
    /// The imaginary unit, exactly.
    #[must_use]
    pub fn i(self) -> Complex {
        Complex { re: self.balls.zero(), im: self.balls.one() }
    }
    /// All complex numbers: the answer where nothing is known.
    #[must_use]
    pub fn indeterminate(self) -> Complex {
        Complex { re: self.balls.indeterminate(), im: self.balls.indeterminate() }
    }
    /// The rectangle widened by `error` (its absolute value) in both directions; it contains the
    /// disc of this radius around every point of z.
    #[must_use]
    pub fn add_error(self, z: &Complex, error: &Float) -> Complex {
        self.parts(z, |part| self.balls.add_error(part, error))
    }

    fn parts(self, z: &Complex, map: impl Fn(&Ball) -> Ball) -> Complex {
        Complex { re: map(&z.re), im: map(&z.im) }
    }

    /// z + w.
    #[must_use]
    pub fn add(self, z: &Complex, w: &Complex) -> Complex {
        Complex { re: self.balls.add(&z.re, &w.re), im: self.balls.add(&z.im, &w.im) }
    }
    /// z - w.
    #[must_use]
    pub fn sub(self, z: &Complex, w: &Complex) -> Complex {
        Complex { re: self.balls.sub(&z.re, &w.re), im: self.balls.sub(&z.im, &w.im) }
    }
    /// -z.
    #[must_use]
    pub fn neg(self, z: &Complex) -> Complex {
        self.parts(z, |part| self.balls.neg(part))
    }
    /// Re z - i Im z.
    #[must_use]
    pub fn conj(self, z: &Complex) -> Complex {
        Complex { re: z.re.clone(), im: self.balls.neg(&z.im) }
    }
    /// z x for a real number x.
    #[must_use]
    pub fn mul_real(self, z: &Complex, x: &Ball) -> Complex {
        self.parts(z, |part| self.balls.mul(part, x))
    }
    /// z q for a rational number q.
    #[must_use]
    pub fn mul_rational(self, z: &Complex, q: &Rational) -> Complex {
        self.parts(z, |part| self.balls.mul_rational(part, q))
    }
    /// z / n for a small integer n; `None` for n = 0.
    #[must_use]
    pub fn div_i64(self, z: &Complex, n: i64) -> Option<Complex> {
        let (re, im) = (self.balls.div_i64(&z.re, n)?, self.balls.div_i64(&z.im, n)?);
        Some(Complex { re, im })
    }
    /// z w = (ac - bd) + i (ad + bc).
    #[must_use]
    pub fn mul(self, z: &Complex, w: &Complex) -> Complex {
        let product = |a, b| self.balls.mul(a, b);
        Complex {
            re: self.balls.sub(&product(&z.re, &w.re), &product(&z.im, &w.im)),
            im: self.balls.add(&product(&z.re, &w.im), &product(&z.im, &w.re)),
        }
    }
    /// z^2 = (a - b)(a + b) + 2i ab: no cancellation between squares of nearly equal parts.
    #[must_use]
    pub fn square(self, z: &Complex) -> Complex {
        let (below, above) = (self.balls.sub(&z.re, &z.im), self.balls.add(&z.re, &z.im));
        let product = self.balls.mul(&z.re, &z.im);
        Complex { re: self.balls.mul(&below, &above), im: self.balls.mul_power_of_two(&product, 1) }
    }
    /// z / w, `None` where w may vanish.
    ///
    /// With centres m, n and half diagonals h, k: |z/w - m/n| = |(z - m) - (m/n)(w - n)| / |w|
    /// <= (h + |m/n| k) / min |w|. A real w divides the parts.
    #[must_use]
    pub fn div(self, z: &Complex, w: &Complex) -> Option<Complex> {
        let least = w.abs_lower();
        if least.is_zero() || !w.is_finite() {
            return None;
        }
        if w.im.is_exact() && w.im.midpoint.is_zero() {
            let (re, im) = (self.balls.div(&z.re, &w.re)?, self.balls.div(&z.im, &w.re)?);
            return Some(Complex { re, im });
        }
        let (m, n) = (z.centre(), w.centre());
        let norm = self.balls.add(&self.balls.square(&n.re), &self.balls.square(&n.im));
        let product = self.mul(&m, &self.conj(&n));
        let (re, im) = (self.balls.div(&product.re, &norm)?, self.balls.div(&product.im, &norm)?);
        let quotient = Complex { re, im };
        if z.is_exact() && w.is_exact() {
            return Some(quotient);
        }
        let moved = up(&quotient.abs_upper() * &w.half_diagonal());
        let error = up(&up(&z.half_diagonal() + &moved) / &least);
        Some(self.add_error(&quotient, &error))
    }
    /// |z|, with the half diagonal as radius: ||z| - |m|| <= |z - m|.
    #[must_use]
    pub fn abs(self, z: &Complex) -> Ball {
        self.balls.enclose(z.re.midpoint.hypot_ref(&z.im.midpoint), z.half_diagonal())
    }
    /// The principal square root, Re >= 0, cut along the negative real axis; on the cut, for an
    /// exactly real z < 0, it is +i sqrt|z|. `None` where the rectangle meets the cut otherwise
    /// (also at 0: take [`Complex::abs_upper`] there).
    ///
    /// |sqrt z - sqrt m| = |z - m| / |sqrt z + sqrt m|. The segment from m to z is in the cut
    /// plane, so the two arguments differ by at most pi, those of the roots by at most pi/2, and
    /// |sqrt z + sqrt m|^2 >= |z| + |m|.
    #[must_use]
    pub fn sqrt(self, z: &Complex) -> Option<Complex> {
        if z.im.is_exact() && z.im.midpoint.is_zero() {
            if let Some(root) = self.balls.sqrt(&z.re) {
                return Some(self.from_real(root));
            }
            let root = self.balls.sqrt(&self.balls.neg(&z.re))?;
            return Some(Complex { re: self.balls.zero(), im: root });
        }
        if !z.is_finite() || z.im.contains_zero() && !z.re.is_positive() {
            return None;
        }
        let m = z.centre();
        let size = self.abs(&m);
        // The part without cancellation first: sqrt((|m| + |x|)/2), the other by y/2 over it.
        let sum = self.balls.add(&size, &self.balls.abs(&m.re));
        let large = self.balls.sqrt(&self.balls.mul_power_of_two(&sum, -1))?;
        let twice = self.balls.mul_power_of_two(&large, 1);
        let small = self.balls.div(&self.balls.abs(&m.im), &twice)?;
        let (re, im) =
            if m.re.midpoint.is_sign_negative() { (small, large) } else { (large, small) };
        let im = if m.im.midpoint.is_sign_negative() { self.balls.neg(&im) } else { im };
        let root = Complex { re, im };
        if z.is_exact() {
            return Some(root);
        }
        let slope = down(down(&z.abs_lower() + &m.abs_lower()).sqrt_ref());
        Some(self.add_error(&root, &up(&z.half_diagonal() / &slope)))
    }
    /// exp(x + iy) = e^x (cos y + i sin y).
    #[must_use]
    pub fn exp(self, z: &Complex) -> Complex {
        let phase = Complex { re: self.balls.cos(&z.im), im: self.balls.sin(&z.im) };
        self.mul_real(&phase, &self.balls.exp(&z.re))
    }
    /// sinh(x + iy) = sinh x cos y + i cosh x sin y.
    #[must_use]
    pub fn sinh(self, z: &Complex) -> Complex {
        let balls = self.balls;
        Complex {
            re: balls.mul(&balls.sinh(&z.re), &balls.cos(&z.im)),
            im: balls.mul(&balls.cosh(&z.re), &balls.sin(&z.im)),
        }
    }
    /// cosh(x + iy) = cosh x cos y + i sinh x sin y.
    #[must_use]
    pub fn cosh(self, z: &Complex) -> Complex {
        let balls = self.balls;
        Complex {
            re: balls.mul(&balls.cosh(&z.re), &balls.cos(&z.im)),
            im: balls.mul(&balls.sinh(&z.re), &balls.sin(&z.im)),
        }
    }
    /// sin z = -i sinh(iz).
    #[must_use]
    pub fn sin(self, z: &Complex) -> Complex {
        let turned = self.sinh(&self.times_i(z));
        Complex { re: turned.im, im: self.balls.neg(&turned.re) }
    }
    /// cos z = cosh(iz).
    #[must_use]
    pub fn cos(self, z: &Complex) -> Complex {
        self.cosh(&self.times_i(z))
    }
    /// i z, exactly.
    #[must_use]
    pub fn times_i(self, z: &Complex) -> Complex {
        Complex { re: self.balls.neg(&z.im), im: z.re.clone() }
    }
}

#[cfg(test)]
mod tests;
