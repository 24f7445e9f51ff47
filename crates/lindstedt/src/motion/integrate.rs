//! Two integrations of one motion, with so many digits that their difference leaves those asked for.

use super::answer::Pair;
use super::plan::Plan;
use crate::refusal::Refused;
use crate::{Error, Progress, Work};
use lindstedt_simulate::{Course, SimulateError, align, cut};

/// Digits more, in which the second integration is made.
const MORE: u32 = 8;
/// Integrations with more and more digits, until those asked for are there.
const TRIES: u32 = 4;
/// The logarithm of an error that leaves not one digit.
const NOT_ONE_DIGIT: f64 = -1.0;
/// Of one integration that was broken off so many events, samples and points are kept, and ten times as many of the
/// line of a figure: to print millions takes longer than to compute them.
const KEPT: usize = 10_000;
/// What is said of a motion that was broken off.
const STOPPED: &str = "stopped before the end of the motion";
const DIGITS_MISSING: &str = "stopped before the digits were reached";

/// Two integrations, the second with more digits, both with so many that their difference leaves the
/// digits asked for; with them the working digits of the first.
///
/// In doubles there is one try; no second motion where it has not one digit or met other events.
/// Where the motion ends in a singularity, the plan is cut shortly before it.
/// Of stopped work the last integrations that reached the end, else what both came to, else what one came to.
pub(super) fn integrate(plan: &mut Plan, work: &Work) -> Result<(Pair, u32), Error> {
    let digits = u32::try_from(work.printed_digits()).unwrap_or(u32::MAX);
    let doubles = work.doubles;
    let mut working = if doubles { 16 } else { digits.saturating_add(4) };
    let (mut lost, mut same) = (0.0, false);
    let mut before = None;
    for left in (0..TRIES).rev() {
        work.tell(Progress::Digits(working));
        let (mut course, mut finer) = match both(plan, working, work) {
            Err(error) if plan.cut.is_none() && singular(&error).is_some() => {
                plan.cut_before(singular(&error).unwrap_or_default(), error.to_string());
                continue;
            }
            // Near a branch point, or a double root to working precision: more digits may tell.
            Err(error) if !doubles && degenerate(&error) && left > 0 => {
                working = working.saturating_mul(2);
                continue;
            }
            found => found?,
        };
        let stopped = work.stop.asked();
        if stopped && !(course.complete && finer.complete) {
            if before.is_some() {
                plan.cut.get_or_insert_with(|| DIGITS_MISSING.to_owned());
                return before.ok_or_else(nothing);
            }
            return Ok((finished(plan, course, finer)?, working));
        }
        align(&mut course, &mut finer);
        for course in [&mut course, &mut finer] {
            course.points.drain(..plan.skip.min(course.points.len()));
        }
        same = course.comparable(&finer);
        let error = course.log10_error(&finer);
        lost = error + f64::from(digits);
        if same && if doubles { error < NOT_ONE_DIGIT } else { lost <= 0.0 } {
            return Ok((Pair { course, finer: Some(finer), stopped: false }, working));
        }
        if doubles {
            return Ok((Pair { course, finer: None, stopped: false }, working));
        }
        if same {
            before = Some((Pair { course, finer: Some(finer), stopped: true }, working));
        }
        if stopped {
            plan.cut.get_or_insert_with(|| DIGITS_MISSING.to_owned());
            return before.ok_or_else(nothing);
        }
        let more = if same { lost.ceil().clamp(1.0, 1e4) as u32 + 2 } else { digits };
        working = working.saturating_add(more);
    }
    let message = if same {
        format!("{digits} digits were not reached, {:.0} are missing", lost.clamp(1.0, 1e6))
    } else {
        format!("{digits} digits were not reached: with {MORE} more the events are others")
    };
    let hint = "a shorter time, or more --digits; --f64 for a picture";
    Err(Refused::undecided("not-enough-digits", message, hint).into())
}

/// What stopped integrations came to.
fn finished(plan: &mut Plan, course: Course, finer: Course) -> Result<Pair, Error> {
    let all = course.events.len();
    let found = broken_off(course, finer, plan.skip);
    let kept = found.as_ref().map_or(0, |pair| pair.course.events.len());
    plan.cut.get_or_insert_with(|| match kept {
        KEPT if KEPT < all => format!("{STOPPED} (the first {KEPT} of {all} events)"),
        _ => STOPPED.to_owned(),
    });
    found.ok_or_else(nothing)
}

fn both(plan: &Plan, working: u32, work: &Work) -> Result<(Course, Course), SimulateError> {
    let course = plan.run(working, work.doubles, work)?;
    Ok((course, plan.run(working.saturating_add(MORE), false, work)?))
}

/// The time of a singularity that ends the motion.
fn singular(error: &SimulateError) -> Option<f64> {
    match error {
        SimulateError::Escape { time, .. } | SimulateError::UnboundedVelocity { time, .. } => {
            Some(*time)
        }
        _ => None,
    }
}

fn degenerate(error: &SimulateError) -> bool {
    matches!(
        error,
        SimulateError::BranchPoint { .. }
            | SimulateError::StepTooSmall { .. }
            | SimulateError::Grazing { .. }
    )
}

/// What two integrations that were broken off came to; nothing where that is the start alone.
fn broken_off(mut course: Course, mut finer: Course, skip: usize) -> Option<Pair> {
    let both = cut(&mut course, &mut finer) && course.comparable(&finer);
    for course in [&mut course, &mut finer] {
        course.points.drain(..skip.min(course.points.len()));
    }
    if both {
        return Some(Pair { course, finer: Some(finer), stopped: true });
    }
    course.events.truncate(KEPT);
    course.samples.truncate(KEPT);
    course.points.truncate(KEPT);
    course.line.truncate(10 * KEPT);
    (course.last.time > 0).then_some(Pair { course, finer: None, stopped: true })
}

fn nothing() -> Error {
    Refused::stopped(STOPPED, "a shorter time, or fewer --digits").into()
}
