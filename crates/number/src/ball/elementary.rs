//! Elementary functions of balls.
//!
//! With m the midpoint, r the radius and |d| <= r, each function states the bound of
//! |f(m + d) - f(m)| that becomes the propagated radius.

use super::{Ball, Balls, down, magnitude, radius_zero, up};
use rug::Float;

/// Beyond 2^this a sine is answered by [-1, 1]: reducing the argument modulo pi takes as many
/// bits of pi as the exponent says, which would be a denial of service at 2^(10^9).
const LARGEST_PERIODIC_EXPONENT: i32 = 1 << 22;

impl Balls {
    /// The square root, `None` where a contains negative numbers.
    ///
    /// |sqrt(m+d) - sqrt m| = |d| / (sqrt(m+d) + sqrt m) <= r / (sqrt(m-r) + sqrt m).
    #[must_use]
    pub fn sqrt(self, a: &Ball) -> Option<Ball> {
        if a.midpoint < a.radius {
            return None;
        }
        let mut radius = radius_zero();
        if !a.is_exact() {
            let near = down(a.abs_lower().sqrt_ref());
            let middle = down(down(&a.midpoint).sqrt_ref());
            radius = up(&a.radius / &down(&near + &middle));
        }
        Some(self.enclose(a.midpoint.sqrt_ref(), radius))
    }

    /// The natural logarithm, `None` unless every number of a is positive.
    ///
    /// |ln(m+d) - ln m| <= -ln(1 - r/m) <= r / (m - r).
    #[must_use]
    pub fn ln(self, a: &Ball) -> Option<Ball> {
        let lower = a.abs_lower();
        if !a.is_positive() || lower.is_zero() {
            return None;
        }
        Some(self.enclose(a.midpoint.ln_ref(), up(&a.radius / &lower)))
    }

    /// ln(1 + x), accurate for small x; `None` unless x > -1 in all of a.
    ///
    /// |ln(1+m+d) - ln(1+m)| <= r / (1 + m - r), as for the logarithm.
    #[must_use]
    pub fn ln_1p(self, a: &Ball) -> Option<Ball> {
        let lower = down(&down(&a.midpoint - &a.radius) + 1u32);
        if !a.is_finite() || lower.is_zero() || lower.is_sign_negative() {
            return None;
        }
        Some(self.enclose(a.midpoint.ln_1p_ref(), up(&a.radius / &lower)))
    }

    /// The exponential function.
    ///
    /// |e^(m+d) - e^m| <= e^m (e^r - 1) <= e^(m+r). The last form is used for r > 1: for m near
    /// -r it does not overflow in between.
    #[must_use]
    pub fn exp(self, a: &Ball) -> Ball {
        // m rounded up keeps e^m an upper bound; the loss of 2^-53 |m| is relative to the radius.
        let radius = if a.radius > 1 {
            up(up(&a.midpoint + &a.radius).exp_ref())
        } else {
            scaled_growth(&up(up(&a.midpoint).exp_ref()), a)
        };
        self.enclose(a.midpoint.exp_ref(), radius)
    }

    /// The hyperbolic sine.
    ///
    /// sinh(m+d) - sinh m = sinh m (cosh d - 1) + cosh m sinh d, and |sinh m| <= cosh m, so the
    /// difference is at most cosh m (cosh r - 1 + sinh r) = cosh m (e^r - 1).
    #[must_use]
    pub fn sinh(self, a: &Ball) -> Ball {
        let size = up(magnitude(&a.midpoint).cosh_ref());
        self.enclose(a.midpoint.sinh_ref(), scaled_growth(&size, a))
    }

    /// The hyperbolic cosine; the same bound as for the hyperbolic sine.
    #[must_use]
    pub fn cosh(self, a: &Ball) -> Ball {
        let size = up(magnitude(&a.midpoint).cosh_ref());
        self.enclose(a.midpoint.cosh_ref(), scaled_growth(&size, a))
    }

    /// The sine: Lipschitz constant 1.
    ///
    /// Beyond |x| = 2^(2^22) (about 10^1262611) and for radii above 2 the answer is [-1, 1].
    #[must_use]
    pub fn sin(self, a: &Ball) -> Ball {
        if a.is_finite() && undetermined_phase(a) {
            return self.unit_interval();
        }
        self.enclose(a.midpoint.sin_ref(), a.radius.clone())
    }

    /// The cosine: Lipschitz constant 1; limits as for [`Balls::sin`].
    #[must_use]
    pub fn cos(self, a: &Ball) -> Ball {
        if a.is_finite() && undetermined_phase(a) {
            return self.unit_interval();
        }
        self.enclose(a.midpoint.cos_ref(), a.radius.clone())
    }

    /// The tangent, `None` where the bound below cannot exclude a pole.
    ///
    /// tan(m+d) - tan m = sin d / (cos m cos(m+d)), and with c <= |cos m|, r < c the absolute
    /// value is at most r / (c (c - r)).
    #[must_use]
    pub fn tan(self, a: &Ball) -> Option<Ball> {
        if !a.is_finite() || undetermined_phase(a) {
            return None;
        }
        let cosine = self.cos(&Ball { midpoint: a.midpoint.clone(), radius: radius_zero() });
        let near = cosine.abs_lower();
        let far = down(&near - &a.radius);
        if far.is_zero() || far.is_sign_negative() {
            return None;
        }
        let radius = up(&a.radius / &down(&near * &far));
        Some(self.enclose(a.midpoint.tan_ref(), radius))
    }

    /// The inverse tangent in (-pi/2, pi/2).
    ///
    /// By the mean value theorem the difference is at most r / (1 + s^2), s = max(|m| - r, 0).
    #[must_use]
    pub fn atan(self, a: &Ball) -> Ball {
        let square = down(a.abs_lower().square_ref());
        let radius = up(&a.radius / &down(&square + 1u32));
        self.enclose(a.midpoint.atan_ref(), radius)
    }

    /// [-1, 1].
    fn unit_interval(self) -> Ball {
        self.enclose(0, up(1))
    }
}

/// size (e^r - 1), rounded up; 0 for an exact ball even where `size` overflowed.
fn scaled_growth(size: &Float, a: &Ball) -> Float {
    if a.is_exact() {
        return radius_zero();
    }
    up(size * &up(a.radius.exp_m1_ref()))
}

/// Whether a sine of this ball says no more than [-1, 1], or would take too long to find out.
fn undetermined_phase(a: &Ball) -> bool {
    let exponent = a.midpoint.get_exp().unwrap_or(0);
    a.radius > 2 || exponent > LARGEST_PERIODIC_EXPONENT
}
