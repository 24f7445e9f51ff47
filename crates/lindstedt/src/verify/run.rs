//! All comparisons, with digits enough.

use super::Verify;
use super::verdict::{Comparison, Verification};
use crate::{Error, Progress, Work};
use lindstedt_equation::Condition;
use lindstedt_expand::ExpandError;
use rayon::prelude::*;
use rug::{Float, Rational};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Integrations with more digits each, until the differences are resolved.
const MOST_TRIES: usize = 3;

/// With the digits asked for; otherwise with so many that the errors of the size eps^(N+1) are
/// resolved, and with more where a small constant in front of it needs them.
pub(super) fn with_digits(
    order: usize,
    condition: Condition,
    question: &Verify,
    run: &mut dyn FnMut(u32) -> Result<Verification, Error>,
) -> Result<Verification, Error> {
    if let Some(digits) = question.digits {
        return run(digits);
    }
    let mut digits = digits(order, condition, question);
    for _ in 1..MOST_TRIES {
        let found = run(digits)?;
        if found.resolved || found.exact {
            return Ok(found);
        }
        digits = digits.saturating_add(digits / 2);
    }
    run(digits)
}

/// A comparison at one value, which asks now and then whether to go on.
pub(super) type Compare<'a> =
    dyn Fn(&Rational, &dyn Fn() -> bool) -> Result<Comparison, Error> + Sync + 'a;

/// All comparisons, on as many threads as there are processors.
pub(super) fn compare_all(
    question: &Verify,
    order: usize,
    compare: &Compare<'_>,
    work: &Work,
) -> Result<Vec<Comparison>, Error> {
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let goes_on = || {
        let going = || work.goes_on(Progress::Integrating(done.load(Ordering::Relaxed)));
        if !stopped.load(Ordering::Relaxed) && !going() {
            stopped.store(true, Ordering::Relaxed);
        }
        !stopped.load(Ordering::Relaxed)
    };
    let one = |small: &Rational| {
        let found = goes_on().then(|| compare(small, &goes_on))?;
        done.fetch_add(1, Ordering::Relaxed);
        // The others are of no use any more.
        stopped.fetch_or(found.is_err(), Ordering::Relaxed);
        Some(found)
    };
    let found: Vec<Option<Result<Comparison, Error>>> =
        question.small.par_iter().map(one).collect();
    let is_reason = |e: &Error| !e.is_interrupted();
    let reason = found.iter().flatten().find_map(|r| r.as_ref().err().filter(|e| is_reason(e)));
    if let Some(reason) = reason {
        return Err(reason.clone());
    }
    let interrupted = || Error::from(ExpandError::Interrupted { order });
    found.into_iter().map(|result| result.unwrap_or_else(|| Err(interrupted()))).collect()
}

/// Enough for errors of the size eps^(N+1), and for the slow approach to a limit cycle, which
/// multiplies the errors of the return map by about 1/eps.
fn digits(order: usize, condition: Condition, question: &Verify) -> u32 {
    let sizes = question.small.iter().map(|q| -Float::with_val(80, q).abs().log10().to_f64());
    let decades = sizes.fold(0.0, f64::max).min(1e6);
    let cycle = if condition == Condition::LimitCycle { 2.0 * decades } else { 0.0 };
    ((order as f64 + 1.0) * decades + cycle).ceil() as u32 + 16
}
