//! Exact integrals over the line.

use super::Hyperbolic;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::fmt;

/// A number r + s pi with rational r and s.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineIntegral {
    /// r.
    pub rational: Rational,
    /// s.
    pub pi: Rational,
}

impl LineIntegral {
    /// An enclosure at the precision of the context.
    #[must_use]
    pub fn ball(&self, balls: Balls) -> Ball {
        let pi = balls.mul_rational(&balls.pi(), &self.pi);
        balls.add(&pi, &balls.from_rational(&self.rational))
    }
    fn scaled(mut self, q: &Rational) -> Self {
        self.rational *= q;
        self.pi *= q;
        self
    }
}

impl fmt::Display for LineIntegral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.rational.is_zero(), self.pi.is_zero()) {
            (_, true) => write!(f, "{}", self.rational),
            (true, false) => write!(f, "{} pi", self.pi),
            (false, false) => write!(f, "{} + {} pi", self.rational, self.pi),
        }
    }
}

/// I_{p,q}, the integral of sech^p z tanh^q z over the line, exactly; `None` for p = 0.
///
/// I_{p,q} = B((q+1)/2, p/2) for even q and 0 for odd q: rational for even p, a rational multiple
/// of pi for odd p. Computed from I_{1,0} = pi, I_{2,0} = 2 by
/// I_{p+2,0} = p/(p+1) I_{p,0} and I_{p,q} = (q-1)/(p+q-1) I_{p,q-2}. Cost O(p + q) products.
///
/// ```
/// use lindstedt_melnikov::hyperbolic::line_integral;
/// assert_eq!(line_integral(4, 4).map(|i| i.to_string()).as_deref(), Some("4/35"));
/// assert_eq!(line_integral(1, 2).map(|i| i.to_string()).as_deref(), Some("1/2 pi"));
/// ```
#[must_use]
pub fn line_integral(p: u32, q: u32) -> Option<LineIntegral> {
    if p == 0 {
        return None;
    }
    if q % 2 == 1 {
        return Some(LineIntegral::default());
    }
    let mut factor = Rational::from(1);
    let start = if p.is_multiple_of(2) { 2 } else { 1 };
    for n in (start..p).step_by(2) {
        factor *= Rational::from((n, n + 1));
    }
    for n in (2..=q).step_by(2) {
        factor *= Rational::from((n - 1, u64::from(p) + u64::from(n) - 1));
    }
    let seed = if start == 1 {
        LineIntegral { rational: Rational::new(), pi: Rational::from(1) }
    } else {
        LineIntegral { rational: Rational::from(2), pi: Rational::new() }
    };
    Some(seed.scaled(&factor))
}

impl Hyperbolic {
    /// The integral over the line, `None` where a term does not decay.
    #[must_use]
    pub fn integrate(&self) -> Option<LineIntegral> {
        let mut sum = LineIntegral::default();
        for (c, p, tanh) in self.terms() {
            let part = line_integral(p, u32::from(tanh))?.scaled(c);
            sum.rational += part.rational;
            sum.pi += part.pi;
        }
        Some(sum)
    }
}
