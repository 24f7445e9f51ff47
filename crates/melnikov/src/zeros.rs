//! Zeros of the threshold in any parameter.

use crate::root::enclose_root;
use crate::{Axis, MelnikovError, StickSlip};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Float;
use std::cmp::Ordering;

/// Cells of the sign scan in parameters other than v*.
const CELLS: i64 = 512;

/// Zeros of the signed threshold in one parameter.
#[derive(Clone, Debug)]
pub struct ParameterZeros {
    /// The zeros, ascending; each enclosed by a proved change of sign.
    pub zeros: Vec<Ball>,
    /// Whole intervals of zeros: dry friction alone does no work where |v*| >= V.
    pub intervals: Vec<[Ball; 2]>,
    /// Whether there are provably no others in the range. In v* the zeros are those of a quartic
    /// and of a square root, T0, alpha and beta enter linearly; in a and b they are the sign changes
    /// on a grid.
    pub complete: bool,
}

impl ParameterZeros {
    fn all(zeros: Vec<Ball>) -> Self {
        Self { zeros, intervals: Vec::new(), complete: true }
    }
}

/// Whether a < b; nothing where it is not decided.
fn is_below(balls: Balls, a: &Ball, b: &Ball) -> Option<bool> {
    let gap = balls.sub(b, a);
    let decided = gap.is_positive() || gap.is_negative() || gap.is_exact();
    decided.then(|| gap.is_positive())
}

/// The zeros in a closed range; nothing where one is not told from an end.
fn within(
    balls: Balls,
    list: impl IntoIterator<Item = Ball>,
    [low, high]: &[Ball; 2],
) -> Option<Vec<Ball>> {
    let mut zeros = Vec::new();
    for zero in list {
        if !is_below(balls, &zero, low)? && !is_below(balls, high, &zero)? {
            zeros.push(zero);
        }
    }
    Some(zeros)
}

impl StickSlip {
    /// Zeros of the signed threshold for `axis` in [low, high].
    ///
    /// omega has none: G does not depend on it, and the factor cosh(z)/(2z) is positive.
    ///
    /// # Errors
    /// [`MelnikovError::NotPositive`] where a, b or omega would leave its domain,
    /// [`MelnikovError::Undecided`] where a sign or an order is not decided at this precision.
    pub fn zeros_in(
        &self,
        balls: Balls,
        axis: Axis,
        low: &Exact,
        high: &Exact,
    ) -> Result<ParameterZeros, MelnikovError> {
        let undecided = MelnikovError::Undecided { bits: balls.bits() };
        let mut changed = self.clone();
        if matches!(axis, Axis::A | Axis::B | Axis::Omega) {
            // Valid at the lower end, valid everywhere.
            changed = changed.with(axis, low.clone());
        }
        changed.check()?;
        if axis == Axis::Omega {
            return Ok(ParameterZeros::all(Vec::new()));
        }
        let range = [low.ball(balls), high.ball(balls)];
        match axis {
            Axis::BeltSpeed => {
                let positive = self.zeros(balls)?;
                if self.alpha.sign().is_eq() && self.beta.sign().is_eq() {
                    let intervals = self.idle_speeds(balls, &range).ok_or(undecided)?;
                    return Ok(ParameterZeros { intervals, ..ParameterZeros::all(Vec::new()) });
                }
                let mirrored = positive.iter().rev().map(|zero| balls.neg(zero));
                let list = mirrored.chain(positive.iter().cloned());
                within(balls, list, &range).ok_or(undecided).map(ParameterZeros::all)
            }
            Axis::Dry | Axis::Alpha | Axis::Beta => {
                let zero = self.linear_zero(balls, axis).ok_or(undecided.clone())?;
                within(balls, zero, &range).ok_or(undecided).map(ParameterZeros::all)
            }
            _ => {
                let zeros = self.scan(balls, axis, low, high).ok_or(undecided)?;
                Ok(ParameterZeros { complete: false, ..ParameterZeros::all(zeros) })
            }
        }
    }

    /// The part of a range where |v*| >= V.
    fn idle_speeds(&self, balls: Balls, [low, high]: &[Ball; 2]) -> Option<Vec<[Ball; 2]>> {
        let speed = self.loop_speed(balls)?;
        let mirror = balls.neg(&speed);
        let least =
            |a: &Ball, b: &Ball| Some(if is_below(balls, a, b)? { a.clone() } else { b.clone() });
        let greatest =
            |a: &Ball, b: &Ball| Some(if is_below(balls, a, b)? { b.clone() } else { a.clone() });
        let parts = [[low.clone(), least(high, &mirror)?], [greatest(low, &speed)?, high.clone()]];
        let mut found = Vec::new();
        for [from, to] in parts {
            if is_below(balls, &from, &to)? {
                found.push([from, to]);
            }
        }
        Some(found)
    }

    /// The zero in a parameter that G is linear in, -G(0)/(G(1) - G(0)), if there is one.
    fn linear_zero(&self, balls: Balls, axis: Axis) -> Option<Option<Ball>> {
        let zero = || Exact::from(0);
        // G is homogeneous in the three: what it is without the other two is the slope, exactly zero where
        // dry friction does no work.
        let alone = Self { dry: zero(), alpha: zero(), beta: zero(), ..self.clone() };
        let slope = alone.with(axis, Exact::from(1)).g(balls)?;
        let constant = self.clone().with(axis, zero()).g(balls)?;
        if slope.is_exact() && slope.contains_zero() {
            return (!constant.contains_zero()).then_some(None);
        }
        Some(Some(balls.div(&balls.neg(&constant), &slope)?))
    }

    fn scan(&self, balls: Balls, axis: Axis, low: &Exact, high: &Exact) -> Option<Vec<Ball>> {
        let (low, high) = (low.ball(balls), high.ball(balls));
        let step = balls.div_i64(&balls.sub(&high, &low), CELLS)?;
        if !step.is_positive() {
            return Some(Vec::new());
        }
        let at = |x: &Float| -> Option<Ball> {
            let value = Exact::Rational(x.to_rational()?);
            self.clone().with(axis, value).g(balls)
        };
        // The ends are rounded inwards, so the domain is not left.
        let node = |i: i64| match i {
            0 => low.upper(),
            CELLS => high.lower(),
            _ => balls.add(&low, &balls.mul_i64(&step, i)).midpoint().clone(),
        };
        let sign = |x: &Float| {
            let g = at(x)?;
            Some(match (g.is_positive(), g.is_negative()) {
                (true, _) => Ordering::Greater,
                (_, true) => Ordering::Less,
                _ => Ordering::Equal,
            })
        };
        let mut zeros = Vec::new();
        let mut before = (node(0), sign(&node(0))?);
        for i in 1..=CELLS {
            let x = node(i);
            let here = sign(&x)?;
            if here == Ordering::Equal {
                // A node on a zero, as far as this precision tells: go on to the next node.
                continue;
            }
            if before.1 != Ordering::Equal && here != before.1 {
                let function = |_: Balls, x: &Ball| at(x.midpoint());
                zeros.push(enclose_root(balls, &before.0, &x, function)?);
            }
            before = (x, here);
        }
        Some(zeros)
    }
}
