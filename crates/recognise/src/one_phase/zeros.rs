//! The zeros of a function that is known within an error, as far as a grid shows them.

use lindstedt_algebra::Stop;

/// As many amplitudes in a row without a sign are no zero at one of them.
const STEADY: usize = 3;

/// What a grid shows of the zeros of a function: places with an error, intervals.
#[derive(Default)]
pub(super) struct Zeros {
    pub roots: Vec<[f64; 2]>,
    pub touching: Vec<[f64; 2]>,
    pub steady: Vec<[f64; 2]>,
    pub unresolved: Vec<[f64; 2]>,
}

/// A function with its estimated error.
pub(super) type Rate<'a> = dyn Fn(f64) -> Option<[f64; 2]> + 'a;
/// A place and the function there.
type Sampled = (f64, [f64; 2]);

/// Zero up to rounding errors has no sign.
fn sign((_, [value, error]): &Sampled) -> Option<bool> {
    (value.abs() > *error).then_some(*value > 0.0)
}

/// The changes of sign of a function between neighbouring points at which its sign is clear, its least sizes between
/// points of one sign, and where it is zero or nothing over several points.
pub(super) fn zeros(points: &[f64], rate: &Rate<'_>, stop: &Stop) -> Zeros {
    let mut found = Zeros::default();
    let mut run: Vec<Sampled> = Vec::new();
    let mut lost: Option<[f64; 2]> = None;
    for a in points {
        if stop.asked() {
            break;
        }
        match rate(*a) {
            Some(here) => {
                found.unresolved.extend(lost.take());
                run.push((*a, here));
            }
            None => {
                found.of_run(&std::mem::take(&mut run), rate);
                lost = Some([lost.map_or(*a, |[from, _]| from), *a]);
            }
        }
    }
    found.unresolved.extend(lost);
    found.of_run(&run, rate);
    found
}

impl Zeros {
    fn of_run(&mut self, run: &[Sampled], rate: &Rate<'_>) {
        let clear: Vec<usize> = (0..run.len()).filter(|k| sign(&run[*k]).is_some()).collect();
        let ends = |from: usize, to: usize| {
            let unclear = run.get(from..to).filter(|list| list.len() >= STEADY)?;
            Some([unclear.first()?.0, unclear.last()?.0])
        };
        let (Some(first), Some(last)) = (clear.first(), clear.last()) else {
            self.steady.extend(ends(0, run.len()));
            return;
        };
        self.steady.extend(ends(0, *first));
        for pair in clear.windows(2) {
            let [left, right] = *pair else { continue };
            if let Some(steady) = ends(left + 1, right) {
                self.steady.push(steady);
            } else if sign(&run[left]) != sign(&run[right]) {
                self.root(run[left].0, run[right].0, rate);
            } else if right > left + 1 {
                self.least(run[left].0, run[right].0, rate);
            } else {
                // The least of three of one sign; of two equal ones the first.
                let size = |k: usize| run[k].1[0].abs();
                let after = run.get(right + 1).filter(|_| clear.contains(&(right + 1)));
                let same = after.is_some_and(|after| sign(after) == sign(&run[right]));
                if same && size(right) < size(left) && size(right) <= size(right + 1) {
                    self.least(run[left].0, run[right + 1].0, rate);
                }
            }
        }
        self.steady.extend(ends(last + 1, run.len()));
    }

    fn root(&mut self, low: f64, high: f64, rate: &Rate<'_>) {
        match root(low, high, rate) {
            Some(found) => self.roots.push(found),
            None => self.unresolved.push([low, high]),
        }
    }

    /// The least size of a function of one sign at both ends: two roots where it changes the sign in between.
    fn least(&mut self, low: f64, high: f64, rate: &Rate<'_>) {
        let Some(sign) = rate(low).map(|[value, _]| value.signum()) else { return };
        // Golden sections: of sign * f, until it is below zero or the places are one.
        let inner = (5f64.sqrt() - 1.0) / 2.0;
        let at = |a: f64| Some((a, sign * rate(a)?[0]));
        let (mut from, mut to) = (low, high);
        let places = [to - inner * (to - from), from + inner * (to - from)];
        let [Some(mut left), Some(mut right)] = places.map(at) else { return };
        for _ in 0..80 {
            let lower = if left.1 <= right.1 { left } else { right };
            if lower.1 < 0.0 && rate(lower.0).is_some_and(|[value, error]| value.abs() > error) {
                self.root(low, lower.0, rate);
                self.root(lower.0, high, rate);
                return;
            }
            if left.1 <= right.1 {
                (to, right) = (right.0, left);
                let Some(next) = at(to - inner * (to - from)) else { return };
                left = next;
            } else {
                (from, left) = (left.0, right);
                let Some(next) = at(from + inner * (to - from)) else { return };
                right = next;
            }
        }
        let a = f64::midpoint(left.0, right.0);
        let Some([value, error]) = rate(a) else { return };
        if value.abs() <= error {
            self.touching.push([a, flat(a, [low, high], error, rate)]);
        }
    }
}

/// How far from its least size, zero, a function stays within its error.
fn flat(a: f64, [low, high]: [f64; 2], error: f64, rate: &Rate<'_>) -> f64 {
    let within = |a: f64| rate(a).is_none_or(|[value, own]| value.abs() <= error.max(own));
    let reach = |end: f64| {
        // From the end on to the place: the first within the error.
        let (mut outside, mut inside) = (end, a);
        for _ in 0..60 {
            let middle = f64::midpoint(outside, inside);
            if within(middle) { inside = middle } else { outside = middle }
        }
        (outside - a).abs()
    };
    reach(low).max(reach(high)) + 4.0 * f64::EPSILON * a
}

/// The change of sign between two places of different signs, with an error from that of the function.
fn root(mut low: f64, mut high: f64, rate: &Rate<'_>) -> Option<[f64; 2]> {
    let sign = rate(low)?[0] > 0.0;
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if (rate(middle)?[0] > 0.0) == sign { low = middle } else { high = middle }
    }
    let a = f64::midpoint(low, high);
    let h = 1e-5 * a;
    let slope = (rate(a + h)?[0] - rate(a - h)?[0]) / (2.0 * h);
    Some([a, rate(a)?[1] / slope.abs() + 4.0 * f64::EPSILON * a])
}
