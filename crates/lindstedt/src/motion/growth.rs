//! Growth of a perturbation of the periodic impact orbit, as long as it is linear.

use super::plan::Plan;
use lindstedt_simulate::{Course, EventKind};
use rug::Float;

/// Deviations that differ from twice those of half the perturbation by more than this part are
/// not linear; those that differ from the finer integration by more are rounding errors.
const PART: f64 = 0.02;
/// Fewer linear deviations tell nothing.
const LEAST: usize = 12;
/// Less change from one quarter of the deviations to another is none.
const CHANGE: f64 = 0.02;

/// How much later than on the orbit every impact comes, with the sign changed.
pub(super) fn shifts(plan: &Plan, course: &Course) -> Vec<Float> {
    let Some(period) = plan.setup.orbit.as_ref().map(|orbit| &orbit.period) else {
        return Vec::new();
    };
    let impacts = course.events.iter().filter(|e| matches!(e.kind, EventKind::Impact { .. }));
    (1u32..)
        .zip(impacts)
        .map(|(n, e)| Float::with_val(period.prec(), period * n) - &e.time)
        .collect()
}

/// How many of the deviations, from the first, are linear in the perturbation and no rounding
/// errors: those before the first three in sequence that are not (one alone may pass zero).
pub fn linear(all: &[Float], half: &[Float], finer: &[Float]) -> usize {
    let mut wrong = 0;
    for (index, ((a, h), f)) in all.iter().zip(half).zip(finer).enumerate() {
        let limit = Float::with_val(64, a).abs() * PART;
        let double = Float::with_val(a.prec(), h * 2u32);
        let good = |other: &Float| Float::with_val(64, a - other).abs() < limit;
        wrong = if good(&double) && good(f) { 0 } else { wrong + 1 };
        if wrong == 3 {
            return index - 2;
        }
    }
    all.len().min(half.len()).min(finer.len()) - wrong
}

/// Whether linear deviations grow: the largest of the last quarter against that of the two quarters
/// before it, in the same direction both times; nothing if there are too few or it cannot be told.
pub fn grows(shifts: &[Float]) -> Option<bool> {
    if shifts.len() < LEAST {
        return None;
    }
    let quarter = shifts.len() / 4;
    let largest = |back: usize| -> f64 {
        let end = shifts.len() - back * quarter;
        let part = shifts.get(end.saturating_sub(quarter)..end).unwrap_or_default();
        // As logarithms: deviations may be far below the smallest double.
        let logs = part.iter().map(|x| Float::with_val(64, x).abs().ln().to_f64());
        logs.fold(f64::NEG_INFINITY, f64::max)
    };
    let [third, second, first] = [largest(0), largest(1), largest(2)];
    match (third - second, second - first) {
        (a, b) if a > CHANGE && b > CHANGE => Some(true),
        (a, b) if a < -CHANGE && b < -CHANGE => Some(false),
        _ => None,
    }
}

/// The mean growth where single ratios tell nothing: a return map that is linear on either side of the
/// orbit only (B is not 0) has other ratios there, and the deviation may change sides every time.
fn mean(shifts: &[Float]) -> String {
    let size = |x: &Float| Float::with_val(64, x).abs().ln().to_f64();
    let [.., first, second, third] = shifts else { return String::new() };
    let [before, last] = [size(second) - size(first), size(third) - size(second)];
    // Even, so that both sides count equally.
    let count = shifts.len() / 4 * 2;
    let Some(start) = shifts.len().checked_sub(count + 1).and_then(|n| shifts.get(n)) else {
        return String::new();
    };
    if count == 0 || (last - before).abs() < CHANGE {
        return String::new();
    }
    let growth = ((size(third) - size(start)) / count as f64).exp();
    format!(" (the ratios vary; geometric mean of the last {count}: {growth:.6} per impact)")
}

/// In words.
pub fn verdict(shifts: &[Float], linear: usize) -> String {
    let used = shifts.get(..linear).unwrap_or_default();
    let last = match used {
        [.., before, last] => {
            let ratio = Float::with_val(last.prec(), last / before);
            format!(", last ratio {:.8}{}", ratio.to_f64(), mean(used))
        }
        _ => String::new(),
    };
    let within = if linear < shifts.len() {
        format!(" (of the first {linear} impacts: later ones are not linear, or rounding errors)")
    } else {
        String::new()
    };
    match grows(used) {
        Some(true) => format!("the perturbation grows{last}{within}"),
        Some(false) => format!("the perturbation decays{last}{within}"),
        None if linear < LEAST => format!(
            "whether the perturbation grows is undecided: it is linear for {linear} impacts only; \
             a smaller --perturb, more --digits, more --impacts{last}"
        ),
        None => {
            format!("whether the perturbation grows is undecided: it keeps its size{last}{within}")
        }
    }
}
