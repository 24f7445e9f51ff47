//! Closed intervals with doubles as ends, every operation rounded outwards: what searches by subdivision
//! compute with, where a [`Ball`] per operation would be too slow.
//!
//! A result contains every value of the operation on points of its operands. Nearest rounding followed by a step to
//! the next double is outward rounding. What is not a number, and what overflows, becomes the whole line.

use crate::ball::{Ball, Balls};
use rug::float::Round;
use rug::{Float, Rational};
use std::ops::{Add, Mul, Neg, Sub};

/// All x with low <= x <= high.
///
/// ```
/// use lindstedt_number::interval::Interval;
/// let x = Interval::new(-1.0, 2.0);
/// let square = x.powi(2);
/// assert!(square.low() <= 0.0 && square.high() >= 4.0 && square.high() < 4.0 + 1e-14);
/// assert!((x * x).contains(-2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    /// 0.
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };
    /// 1.
    pub const ONE: Self = Self { low: 1.0, high: 1.0 };
    /// -1.
    pub const MINUS_ONE: Self = Self { low: -1.0, high: -1.0 };
    /// The whole line: nothing is known.
    pub const LINE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// [low, high]; the whole line where that is none.
    #[must_use]
    #[inline]
    pub fn new(low: f64, high: f64) -> Self {
        if low <= high { Self { low, high } } else { Self::LINE }
    }
    /// The double x alone.
    #[must_use]
    pub fn point(x: f64) -> Self {
        Self::new(x, x)
    }
    /// An enclosure of a rational number.
    #[must_use]
    pub fn of(q: &Rational) -> Self {
        let near = q.to_f64();
        if *q == near { Self::point(near) } else { Self::new(near.next_down(), near.next_up()) }
    }
    /// An enclosure of a ball.
    #[must_use]
    pub fn of_ball(ball: &Ball) -> Self {
        let (low, high) = (ball.lower(), ball.upper());
        Self::new(low.to_f64_round(Round::Down), high.to_f64_round(Round::Up))
    }
    /// A ball that contains the interval.
    #[must_use]
    pub fn ball(self) -> Ball {
        let balls = Balls::new(64);
        if !self.is_finite() {
            return balls.indeterminate();
        }
        let middle = self.middle();
        let radius = (self.high - middle).max(middle - self.low);
        let error = if radius > 0.0 { radius.next_up() } else { 0.0 };
        balls.from_parts(&Float::with_val(53, middle), &Float::with_val(53, error))
    }

    /// The lower end.
    #[must_use]
    pub fn low(self) -> f64 {
        self.low
    }
    /// The upper end.
    #[must_use]
    pub fn high(self) -> f64 {
        self.high
    }
    /// Whether both ends are finite.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }
    /// A point of it, near the middle; 0 for the whole line.
    #[must_use]
    pub fn middle(self) -> f64 {
        let middle = 0.5 * self.low + 0.5 * self.high;
        if middle.is_finite() { middle.clamp(self.low, self.high) } else { 0.0 }
    }
    /// An upper bound of high - low.
    #[must_use]
    pub fn width(self) -> f64 {
        if self.low == self.high { 0.0 } else { (self.high - self.low).next_up() }
    }
    /// The largest |x|.
    #[must_use]
    pub fn above(self) -> f64 {
        self.high.abs().max(self.low.abs())
    }
    /// The smallest |x|.
    #[must_use]
    pub fn below(self) -> f64 {
        if self.contains(0.0) { 0.0 } else { self.high.abs().min(self.low.abs()) }
    }
    /// Whether x lies in it.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }
    /// Whether it is a part of another.
    #[must_use]
    pub fn is_in(self, other: Self) -> bool {
        other.low <= self.low && self.high <= other.high
    }
    /// Whether it is a part of the inside of another.
    #[must_use]
    pub fn is_inside(self, other: Self) -> bool {
        other.low < self.low && self.high < other.high
    }
    /// The common part.
    #[must_use]
    pub fn meet(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low <= high).then_some(Self { low, high })
    }
    /// The smallest interval with both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
    /// The two halves.
    #[must_use]
    pub fn halves(self) -> [Self; 2] {
        let middle = self.middle();
        [Self { high: middle, ..self }, Self { low: middle, ..self }]
    }
    /// The square root of what is not negative.
    #[must_use]
    pub fn root(self) -> Self {
        let low = self.low.max(0.0).sqrt().next_down().max(0.0);
        Self::new(low, self.high.max(0.0).sqrt().next_up())
    }
    /// x^n; of even powers no negative values.
    #[must_use]
    pub fn powi(self, n: u32) -> Self {
        self.powers(n).last().unwrap_or(Self::ONE)
    }
    /// x^0, x^1, ..., x^largest, the ends of each from those of the one before.
    pub fn powers(self, largest: u32) -> impl Iterator<Item = Self> {
        let [low, high] = [self.low, self.high].map(Self::point);
        let mut ends = [Self::ONE; 2];
        (0..=largest).map(move |n| {
            if n > 0 {
                ends = [ends[0] * low, ends[1] * high];
            }
            match ends {
                _ if n == 0 => Self::ONE,
                [a, b] if n % 2 == 1 || self.low >= 0.0 => Self::new(a.low, b.high),
                [a, b] if self.high <= 0.0 => Self::new(b.low.max(0.0), a.high),
                [a, b] => Self::new(0.0, a.high.max(b.high)),
            }
        })
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        // Adding zero is exact.
        if self == Self::ZERO {
            return other;
        }
        if other == Self::ZERO {
            return self;
        }
        Self::new((self.low + other.low).next_down(), (self.high + other.high).next_up())
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self == Self::ONE {
            return other;
        }
        if other == Self::ONE {
            return self;
        }
        if self == Self::ZERO && other.is_finite() || other == Self::ZERO && self.is_finite() {
            return Self::ZERO;
        }
        let [a, b] = [self.low * other.low, self.low * other.high];
        let [c, d] = [self.high * other.low, self.high * other.high];
        if (a + b + c + d).is_nan() {
            return Self::LINE;
        }
        Self::new(a.min(b).min(c.min(d)).next_down(), a.max(b).max(c.max(d)).next_up())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on points of the operands, exactly, lies in the result.
    #[test]
    fn operations_enclose() {
        let ends = [-3.1, -1.0, -0.1, 0.0, 1e-3, 0.3, 1.0, 7.7];
        let (of, exact) = (Interval::new, |x: f64| Rational::from_f64(x).unwrap());
        let holds = |i: Interval, q: Rational| exact(i.low) <= q && q <= exact(i.high);
        let pairs =
            || ends.iter().enumerate().flat_map(|(n, a)| ends[n..].iter().map(|b| (*a, *b)));
        for (a, b) in pairs() {
            let x = Interval::new(a, b);
            for p in [a, b, x.middle()] {
                for n in 0..6 {
                    let power = (0..n).fold(Rational::from(1), |power, _| power * exact(p));
                    assert!(holds(x.powi(n), power), "{p}^{n}");
                }
            }
            for (c, d) in pairs() {
                let y = Interval::new(c, d);
                for (p, q) in [(a, c), (a, d), (b, c), (b, d), (x.middle(), y.middle())] {
                    assert!(holds(x + y, exact(p) + exact(q)));
                    assert!(holds(x - y, exact(p) - exact(q)));
                    assert!(holds(x * y, exact(p) * exact(q)));
                }
                // No end is two steps beyond the values there.
                let near = |end: f64, value: f64| {
                    end == value || end.next_up() == value || end.next_down() == value
                };
                let products = [a * c, a * d, b * c, b * d];
                let [low, high] = [f64::min, f64::max].map(|f| products.into_iter().fold(a * c, f));
                assert!(near((x * y).low, low) && near((x * y).high, high));
                assert!(near((x + y).low, a + c) && near((x + y).high, b + d));
                assert_eq!(x.contains(c), a <= c && c <= b);
                match x.meet(y) {
                    Some(part) => assert!(part == of(a.max(c), b.min(d))),
                    None => assert!(b < c || d < a),
                }
                assert_eq!(x.hull(y), of(a.min(c), b.max(d)));
            }
        }
        let third = Rational::from((1, 3));
        assert!(holds(Interval::of(&third), third.clone()));
        assert!(Interval::of(&third).ball().contains(&third));
        assert_eq!(Interval::LINE * Interval::ZERO, Interval::LINE);
        assert_eq!(of(1.0, 2.0) * Interval::ZERO, Interval::ZERO);
        let half = |low: f64| of(low, f64::INFINITY);
        assert_eq!(half(1.0) * of(1.5, 2.0), half(1.5_f64.next_down()));
        assert_eq!(half(0.0) * of(1.5, 2.0), half(0.0_f64.next_down()));
        assert_eq!(Interval::new(f64::NAN, 1.0), Interval::LINE);
    }

    #[test]
    fn ends_middle_and_parts() {
        let of = Interval::new;
        let x = of(2.0, 5.0);
        assert_eq!((x.low(), x.high(), x.middle()), (2.0, 5.0, 3.5));
        assert_eq!((x.below(), x.above(), x.width()), (2.0, 5.0, 3.0_f64.next_up()));
        assert_eq!((-x).below(), 2.0);
        assert_eq!((of(-2.0, 5.0).below(), of(-6.0, 5.0).above()), (0.0, 6.0));
        assert_eq!(x.halves(), [of(2.0, 3.5), of(3.5, 5.0)]);
        assert_eq!(of(-6.0, 5.0).powi(2), of(0.0, 36.0_f64.next_up()));
        assert!(*x.ball().midpoint() == 3.5 && *x.ball().radius() == 1.5_f64.next_up());
        let x = of(1.0, 3.0);
        assert!(Interval::ONE.ball().is_exact());
        assert!(x.is_in(x) && x.is_in(of(1.0, 4.0)) && !of(1.0, 4.0).is_in(x));
        assert!(x.is_inside(of(0.5, 4.0)));
        assert!(!x.is_inside(of(1.0, 4.0)) && !x.is_inside(of(0.5, 3.0)));
        assert!(!of(f64::NEG_INFINITY, 1.0).is_finite() && !of(1.0, f64::INFINITY).is_finite());
    }
}
