//! Diagonal Pade approximants, the last of them judged by those before.

use super::estimate::{distance, settle, tentative};
use super::fraction::convergents;
use super::once::Once;
use super::{Estimate, Outcome, Pade, ResummationError};
use lindstedt_algebra::Stop;
use rug::Float;
use std::sync::Arc;

/// Approximants before the last one that enter the error estimate.
pub(super) const APPROXIMANTS: usize = 9;
/// Approximants with a pole between 0 and the point before that is taken for a cut.
const CUT: usize = 3;

/// The last steps [k - k/2 / k/2], k = N - 9 .. N, of the staircase of a series, those that exist.
pub(super) struct Staircase {
    coefficients: Vec<Float>,
    bits: u32,
    steps: Vec<(usize, Pade)>,
    /// Those of the last one's order with a denominator of one degree more and less, where they are wanted.
    beside: Vec<Pade>,
    /// Whether a spurious pole is taken out of an approximant that it spoils.
    repairs: bool,
    /// Those that were repaired.
    repaired: Once<(usize, usize), Option<Arc<Pade>>>,
}

fn degrees(k: usize) -> (usize, usize) {
    (k - k / 2, k / 2)
}

impl Staircase {
    /// Builds them: O(N^2) products together, as convergents of one continued fraction; O(N^3) each where the table has a
    /// block.
    pub fn new(c: &[Float], bits: u32, stop: &Stop) -> Result<Self, ResummationError> {
        let order = c.len().saturating_sub(1);
        let first = order.saturating_sub(APPROXIMANTS);
        if let Some(steps) = convergents(c, first, bits, stop) {
            return Ok(Self::of(c, bits, steps));
        }
        let mut steps = Vec::new();
        for k in first..=order {
            let (l, m) = degrees(k);
            if stop.asked() {
                return Err(ResummationError::Stopped);
            }
            let Some(pade) = Pade::new(c, l, m, bits, stop) else { continue };
            // Inside a block of the table there is none: one of lower degree ignores coefficients.
            if pade.degrees() == (l, m) || pade.begins_with(&c[..=k]) {
                steps.push((k, pade));
            }
        }
        Ok(Self::of(c, bits, steps))
    }

    fn of(c: &[Float], bits: u32, steps: Vec<(usize, Pade)>) -> Self {
        let (coefficients, repaired) = (c.to_vec(), Once::new());
        Self { coefficients, bits, steps, beside: Vec::new(), repairs: true, repaired }
    }

    /// The same with the neighbours of the last one: O(N^3).
    pub fn with_neighbours(mut self, stop: &Stop) -> Self {
        let (l, m) = degrees(self.coefficients.len().saturating_sub(1));
        let pair = [Some((l + 1, m.wrapping_sub(1))), l.checked_sub(1).map(|l| (l, m + 1))];
        let pade = |(l, m)| Pade::new(&self.coefficients, l, m, self.bits, stop);
        self.beside = pair.into_iter().flatten().filter(|_| m > 0).filter_map(pade).collect();
        self
    }

    /// The approximants, the last one last.
    pub fn approximants(&self) -> impl DoubleEndedIterator<Item = &Pade> {
        self.steps.iter().map(|(_, pade)| pade)
    }

    /// The same to fewer bits, and without the repair of single approximants, which would take most of the time at many
    /// points: an error is then larger, where one is spurious.
    pub fn rounded(self, bits: u32) -> Self {
        let steps = self.steps.into_iter().map(|(k, pade)| (k, pade.rounded(bits))).collect();
        let beside = self.beside.into_iter().map(|pade| pade.rounded(bits)).collect();
        Self { repairs: false, bits, steps, beside, ..self }
    }

    /// The value at x.
    pub fn at(&self, x: &Float, stop: &Stop) -> Result<Outcome, ResummationError> {
        let value = |pade: &Pade| {
            let (top, bottom) = pade.parts(x);
            let value = top / bottom;
            value.is_finite().then(|| (value, pade.jump(x))).ok_or(ResummationError::Undefined)
        };
        self.judged(&settle, value, stop)
    }

    /// A value from all of them.
    ///
    /// `value` tells besides whether the denominator changes its sign between 0 and the point. Poles
    /// there that come and go with the degree are a cut across the path: that of a pair of branch
    /// points r exp(+-i phi) is an arc of the circle through 0, r and r exp(i phi), which meets the
    /// axis at r/cos phi (it is a straight line in 1/x: the set of least capacity, H. Stahl), and the
    /// approximants converge behind it to another branch. The error is then at least the jump of the
    /// cut, as large as any of these poles makes it.
    ///
    /// A step whose value stands apart from both neighbours by more than a thousand times their
    /// distance is computed again without its spurious poles.
    pub fn judged(
        &self,
        judge: &dyn Fn(&[Float], usize) -> Option<Estimate>,
        value: impl Fn(&Pade) -> Result<(Float, Option<Float>), ResummationError>,
        stop: &Stop,
    ) -> Result<Outcome, ResummationError> {
        let order = self.coefficients.len().saturating_sub(1);
        let robust = |(l, m)| {
            let pade = || Pade::robust(&self.coefficients, l, m, self.bits, stop);
            let pade = || self.repaired.get((l, m), stop, || pade().map(Arc::new));
            self.repairs.then(pade)?
        };
        let mut values = Vec::new();
        let mut jumps = Vec::new();
        let mut failure = ResummationError::Undefined;
        let mut last = None;
        for (k, pade) in &self.steps {
            match value(pade) {
                Ok((v, jump)) => {
                    values.push((*k, v));
                    jumps.extend(jump);
                    last = Some((*k, pade.degrees()));
                }
                Err(error) => {
                    failure = error;
                    // A pole next to the path: without the doublet it may be gone.
                    let robust = robust(degrees(*k)).filter(|p| p.degrees() != pade.degrees());
                    if let Some(pade) = robust
                        && let Ok((v, _)) = value(&pade)
                    {
                        values.push((*k, v));
                        last = Some((*k, pade.degrees()));
                    }
                }
            }
        }
        // Where the last of them have no value those before agree about something else.
        let Some((used, pade_degrees)) =
            last.filter(|(used, _)| values.len() > 1 && used + 1 >= order)
        else {
            return Err(failure);
        };
        for i in 1..values.len() {
            if stands_apart(&values, i)
                && let Some(pade) = robust(degrees(values[i].0))
                && let Ok((v, _)) = value(&pade)
            {
                values[i].1 = v;
            }
        }
        let list: Vec<Float> = values.into_iter().map(|(_, v)| v).collect();
        let mut tentative = tentative(&list, order);
        if let Some(tentative) = &mut tentative {
            tentative.beside = self.gap_to_neighbours(&list, &value);
        }
        let mut estimate = judge(&list, order).ok_or(ResummationError::Undefined)?;
        if jumps.len() >= CUT
            && let Some(jump) = jumps.into_iter().reduce(|a, b| a.max(&b))
        {
            estimate.error = estimate.error.max(&jump);
            tentative = None;
        }
        let degrees = Some(pade_degrees);
        Ok(Outcome { estimate, order: used, degrees, tentative, smallest_term: None })
    }
}

impl Staircase {
    /// The largest distance of the last value from its neighbours in the table; nothing unless there are all four.
    fn gap_to_neighbours(
        &self,
        list: &[Float],
        value: &impl Fn(&Pade) -> Result<(Float, Option<Float>), ResummationError>,
    ) -> Option<Float> {
        let [.., far, near, last] = list else { return None };
        let [more, less] = &self.beside[..] else { return None };
        let beside = [value(more).ok()?.0, value(less).ok()?.0];
        let distances = [far, near].into_iter().chain(&beside).map(|v| distance(v, last));
        distances.reduce(|a, b| a.max(&b))
    }
}

/// Whether a value is further from both neighbours than a thousand times their distance.
fn stands_apart(values: &[(usize, Float)], i: usize) -> bool {
    let far = |j: usize| Some(distance(&values.get(j)?.1, &values[i].1));
    let between = match values.get(i + 1) {
        Some(next) => distance(&next.1, &values[i - 1].1),
        None if i > 1 => distance(&values[i - 2].1, &values[i - 1].1),
        None => return false,
    };
    [far(i - 1), far(i + 1)].into_iter().flatten().all(|d| d > between.clone() * 1000u32)
}
