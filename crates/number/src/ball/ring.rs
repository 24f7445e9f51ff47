//! Balls as coefficients of an expansion: every coefficient of the result encloses the exact one.
//!
//! The axioms of a ring hold for the enclosed numbers, not for the balls: distributivity holds up
//! to the radii. The driver needs no axiom at run time, only enclosures; what it must decide about
//! a coefficient it asks as `may_vanish` and `reciprocal`, both of which are honest here.

use crate::ball::{Ball, Balls};
use lindstedt_algebra::{RationalAlgebra, Ring};
use rug::Rational;

/// The real numbers, enclosed at a precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BallRing {
    /// The context.
    pub balls: Balls,
}

/// A ball that compares as data: equal when midpoint and radius are.
#[derive(Clone, Debug)]
pub struct Enclosure(pub Ball);

impl PartialEq for Enclosure {
    fn eq(&self, other: &Self) -> bool {
        self.0.midpoint() == other.0.midpoint() && self.0.radius() == other.0.radius()
    }
}

impl Ring for BallRing {
    type Element = Enclosure;

    fn zero(&self) -> Enclosure {
        Enclosure(self.balls.zero())
    }
    fn one(&self) -> Enclosure {
        Enclosure(self.balls.one())
    }
    /// Whether it is the exact zero.
    fn is_zero(&self, a: &Enclosure) -> bool {
        a.0.is_exact() && a.0.midpoint().is_zero()
    }
    /// Whether the ball contains zero.
    fn may_vanish(&self, a: &Enclosure) -> bool {
        a.0.contains_zero()
    }
    fn add_assign(&self, a: &mut Enclosure, b: &Enclosure) {
        a.0 = self.balls.add(&a.0, &b.0);
    }
    fn neg(&self, a: &Enclosure) -> Enclosure {
        Enclosure(self.balls.neg(&a.0))
    }
    fn mul(&self, a: &Enclosure, b: &Enclosure) -> Enclosure {
        Enclosure(self.balls.mul(&a.0, &b.0))
    }
    fn sum_of_products(&self, pairs: &[(&Enclosure, &Enclosure)]) -> Enclosure {
        let pairs: Vec<_> = pairs.iter().map(|(a, b)| (&a.0, &b.0)).collect();
        Enclosure(self.balls.sum_of_products(&pairs))
    }
}

impl RationalAlgebra for BallRing {
    fn rational(&self, q: &Rational) -> Enclosure {
        Enclosure(self.balls.from_rational(q))
    }
    fn scale(&self, a: &Enclosure, q: &Rational) -> Enclosure {
        Enclosure(self.balls.mul_rational(&a.0, q))
    }
    fn reciprocal(&self, a: &Enclosure) -> Option<Enclosure> {
        self.balls.div(&self.balls.one(), &a.0).map(Enclosure)
    }
    /// The midpoint of an exact ball.
    fn as_rational(&self, a: &Enclosure) -> Option<Rational> {
        a.0.is_exact().then(|| a.0.midpoint().to_rational()).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rug::Float;

    #[test]
    fn zero_is_known_or_possible() {
        let ring = BallRing { balls: Balls::new(60) };
        let of = |n: i64, error: f64| {
            Enclosure(ring.balls.add_error(&ring.balls.from_i64(n), &Float::with_val(53, error)))
        };
        let (zero, around, three, wide) = (of(0, 0.0), of(0, 1.0), of(3, 0.0), of(3, 0.5));
        assert!(ring.is_zero(&zero) && ring.may_vanish(&zero));
        assert!(!ring.is_zero(&around) && ring.may_vanish(&around));
        assert!(!ring.is_zero(&three) && !ring.may_vanish(&three) && !ring.may_vanish(&wide));
        assert!(three == of(3, 0.0) && three != wide && three != of(4, 0.0) && zero != three);
        let mut sum = of(1, 0.25);
        ring.add_assign(&mut sum, &wide);
        assert!(sum.0.lower() <= 3.25 && sum.0.upper() >= 4.75 && sum.0.lower() > 3.24);
        let third = ring.reciprocal(&three).unwrap();
        assert!(third.0.contains(&Rational::from((1, 3))) && ring.reciprocal(&around).is_none());
        assert_eq!(ring.as_rational(&three), Some(Rational::from(3)));
        assert_eq!(ring.as_rational(&wide), None);
    }
}
