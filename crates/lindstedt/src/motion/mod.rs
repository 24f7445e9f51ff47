//! Motions in the time domain: their events and sections, the growth of a perturbation, numbers that
//! tell chaos from regular motion, bifurcation diagrams.
//!
//! The integrator is that of [`lindstedt_simulate`]. A motion is integrated twice, the second time
//! with eight digits more; the difference estimates the error of every number, and both are repeated
//! with more digits until those asked for are there. In chaotic motion digits are lost at a constant
//! rate, so a long motion ends with a refusal in place of digits that mean nothing; averages over it
//! ([`Chaos`]) and its sections over a parameter ([`Bifurcation`]) are computed in doubles.

pub(crate) mod answer;
mod chaos;
mod diagram;
pub(crate) mod equation;
mod follow;
mod force;
pub(crate) mod growth;
mod history;
mod integrate;
mod orbit;
mod plan;
mod setup;
mod several;

pub use answer::{Begin, Event, LinearRegime, Motion, Points, Rest, State, Steps};
pub use chaos::{Chaos, Diagnosis, Exponent, Test, ZeroOneTest};
pub use diagram::{Bifurcation, Column, Diagram, Journal, Swept};
pub(crate) use follow::{Harmonics, Reading};
pub use lindstedt_impact::parameters::Branch;
pub use lindstedt_simulate::{Cut as Section, Dot};

use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Oscillator, Remark, Standing, Work};
use integrate::integrate;
use lindstedt_simulate::{self as simulate, Quantity};
use plan::Plan;
use rug::{Float, Rational};
use setup::Setup;
use std::time::Instant;

/// Where nothing is said: so many impacts, periods, or units of time.
const USUAL: u32 = 20;

/// Where a motion starts, as far as it is said.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// x(0), x'(0), with several unknowns the same of all of them; by default those of the problem file, else on the
    /// periodic impact orbit where a wall and a delay of whole periods make one, else at rest at the amplitude.
    pub state: Option<Vec<Exact>>,
    /// The motion before t = 0, which a delay needs: `constant`, `free-flight`, or an expression in t.
    pub history: Option<String>,
    /// The root of the impact velocity of the periodic orbit; the larger one by default.
    pub branch: Option<Branch>,
    /// Velocity added on the periodic orbit, in units of the impact velocity; not zero.
    pub perturbation: Option<Rational>,
}

impl Start {
    /// Reads a state `X,V`, with several unknowns `X,V,Y,W,...`.
    ///
    /// # Errors
    /// [`Refused`] where the values do not come in pairs.
    pub fn read_state(text: &str) -> Result<Vec<Exact>, Error> {
        let parts: Vec<&str> = text.split(',').collect();
        if parts.len() % 2 == 1 {
            let message = format!("{text:?} is not X,V");
            return Err(Refused::usage("state", message, "--state 1,-1/2").into());
        }
        Ok(parts.into_iter().map(Exact::parse).collect::<Result<_, _>>()?)
    }

    /// The state of one unknown.
    fn pair(&self) -> Result<Option<[Exact; 2]>, Error> {
        let Some(state) = &self.state else { return Ok(None) };
        let [x, v] = &state[..] else {
            let message = format!("{} values are no state of one unknown", state.len());
            return Err(Refused::usage("state", message, "--state 1,-1/2").into());
        };
        Ok(Some([x.clone(), v.clone()]))
    }

    /// Reads a perturbation: a rational number other than zero.
    ///
    /// # Errors
    /// [`Refused`] for any other.
    pub fn read_perturbation(text: &str) -> Result<Rational, Error> {
        let value = Exact::parse(text)?.as_rational().filter(|q| !q.is_zero()).cloned();
        let wrong =
            || Refused::usage("perturb", "no rational number but zero", "--perturb 1e-6").into();
        value.ok_or_else(wrong)
    }
}

/// Where a motion ends.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// At this time.
    Time(Exact),
    /// After so many periods of the force, without one after so many maxima of x.
    Periods(u32),
    /// At the N-th impact.
    Impacts(u32),
}

/// What a figure of a motion shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// x' over x.
    Phase,
    /// x over t.
    Time,
    /// The points of the section.
    Section,
}

/// The question for a motion.
///
/// ```
/// use lindstedt::{Oscillator, Simulate, Work, motion::End};
/// let ball = Oscillator::builtin("vibro-impact")?;
/// let question = Simulate { end: Some(End::Impacts(1)), ..Simulate::default() };
/// let motion = ball.motion(&question, &Work { digits: 8, ..Work::default() })?.value;
/// assert_eq!(motion.events[0].t.decimal, "1.9039955");
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Simulate {
    /// Where it starts.
    pub start: Start,
    /// Where it ends; by default at the last of `times`, else after 20 impacts, periods of the force,
    /// or units of time.
    pub end: Option<End>,
    /// Times at which the state is given, in order, none negative; by default 21 of equal distance.
    pub times: Option<Vec<Exact>>,
    /// The section whose points are kept.
    pub section: Option<Section>,
    /// Points of the section that are left out at the beginning.
    pub skip: Option<u32>,
    /// Whether the line of a figure is kept.
    pub drawn: bool,
    /// What a figure shows; by default what the question is about.
    pub view: Option<View>,
}

impl Simulate {
    /// Reads times, `LO..HI:COUNT` or `T1,T2,...`.
    ///
    /// # Errors
    /// As [`Axis::parse`].
    pub fn read_times(text: &str) -> Result<Vec<Exact>, Error> {
        let usage = |message| Refused::usage("times", message, "LO..HI:COUNT, as in 0..1:11");
        let axis = Axis::parse(&format!("t={text}"));
        let times = axis.map_err(|error| usage(error.to_string()))?.values;
        increasing(&times).map_err(|message| usage(message).into()).map(|()| times)
    }
}

/// Refuses values that are not in order.
fn increasing(values: &[Exact]) -> Result<(), String> {
    let falls = values.windows(2).find(|pair| pair[1] < pair[0]);
    falls.map_or(Ok(()), |pair| Err(format!("{} comes after {}", pair[1], pair[0])))
}

/// The motion of one unknown or of several. What is computed beforehand has `digits` digits and some more.
fn set_up(
    oscillator: &Oscillator,
    start: &Start,
    swept: bool,
    digits: u32,
) -> Result<Setup, Error> {
    match oscillator.problem().others.is_empty() {
        true => Setup::single(oscillator, start, swept, digits),
        false => several::several(oscillator, start),
    }
}

impl Oscillator {
    /// The motion from a start to an end: its events, samples and section, integrated until the
    /// digits of `work` are there.
    ///
    /// Of stopped work what both integrations came to is kept; where there is but one, without errors.
    ///
    /// Estimated: every number has the difference to an integration with eight digits more as its
    /// error. In doubles there is one try; where it has not one digit the answer is undecided, a
    /// picture. A motion that escapes in a finite time is given up to shortly before, and is no
    /// answer to the question. Cost: two integrations, more where digits are lost on the way.
    ///
    /// # Errors
    /// [`Refused`] for a question that does not fit, where the digits cannot be reached, where there
    /// is no such start or history, and for work stopped at the start; [`Error::Simulate`], [`Error::Impact`].
    ///
    /// ```
    /// use lindstedt::{Exact, Oscillator, Work, motion::{End, Simulate}};
    /// let pendulum = Oscillator::builtin("pendulum")?.set("amplitude", "3")?;
    /// let question = Simulate { end: Some(End::Periods(1)), ..Simulate::default() };
    /// let answer = pendulum.motion(&question, &Work { digits: 12, ..Work::default() })?;
    /// assert_eq!(answer.value.last.t.decimal, "16.1555393724"); // 4 K(sin(3/2)), mpmath 1.3.0
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn motion(&self, question: &Simulate, work: &Work) -> Result<Answer<Motion>, Error> {
        self.second_order()?;
        let begin = Instant::now();
        let setup = set_up(self, &question.start, false, precomputed(work))?;
        let mut plan = plan(question, setup)?;
        let (pair, working) = integrate(&mut plan, work)?;
        let half = if plan.perturbed() && pair.finer.is_some() && !pair.stopped {
            plan.run_half(working, work).map(|half| growth::shifts(&plan, &half))
        } else {
            None
        };
        let mut remarks = self.remarks().to_vec();
        remarks.extend(plan.setup.remarks.iter().cloned().map(Remark));
        if plan.skip > 0 && pair.course.points.is_empty() {
            let text = format!("--skip {} leaves out every point of the section", plan.skip);
            remarks.push(Remark(text));
        }
        if pair.finer.is_none() && !pair.stopped {
            let text = "no digit is left in doubles (without --f64 there are some, over a shorter \
                        time; --lyapunov and --zero-one tell how chaotic)";
            remarks.push(Remark(text.to_owned()));
        }
        remarks.extend(plan.cut.iter().map(|why| Remark(format!("{why}: the motion up to there"))));
        let done = pair.course.events.len() + pair.course.samples.len() + pair.course.points.len();
        let standing = match (pair.course.complete, &pair.finer) {
            _ if pair.stopped => Standing::Stopped { done },
            (false, _) => Standing::NoAnswer,
            (true, None) => Standing::Undecided,
            (true, Some(_)) => Standing::Complete,
        };
        let header = self.header(plan.setup.at.clone(), None, tier(work), begin);
        let value = Motion::new(plan, pair, half, work);
        Ok(Answer { header, value, standing, remarks })
    }
}

fn tier(work: &Work) -> &'static str {
    if work.doubles { "doubles" } else { "Taylor series" }
}

/// What is computed beforehand has more digits than asked for: some are lost on the way.
fn precomputed(work: &Work) -> u32 {
    let digits = u32::try_from(work.printed_digits()).unwrap_or(u32::MAX);
    digits.saturating_add(if work.doubles { 40 } else { digits.saturating_add(40) })
}

/// Refuses a section that there is not.
fn section(asked: Option<Section>, wanted: bool, setup: &Setup) -> Result<Option<Section>, Error> {
    let usual = match &setup.flow.forcing {
        _ if setup.wall => Section::Impact,
        Some(_) => Section::Stroboscopic,
        None => Section::Velocity,
    };
    let section = asked.or(wanted.then_some(usual));
    if section == Some(Section::Stroboscopic) && setup.orbit.is_some() {
        let message = "the impacts of the orbit come at the times of this section, where x' jumps";
        return Err(Refused::usage("section", message, "--section impact, or --state").into());
    }
    if let (Some(Section::Stroboscopic), None, Some(frequency)) =
        (section, &setup.flow.forcing, &setup.frequency)
    {
        let names = frequency.parameters();
        let unset: Vec<&str> = names
            .iter()
            .map(|name| &**name)
            .filter(|name| setup.flow.parameters.get(name).is_none())
            .collect();
        let message = format!("{}: the frequency of the force has no value", setup.name);
        let hint = format!("--set {}=VALUE", unset.join("=VALUE --set "));
        return Err(Refused::usage("section", message, hint).into());
    }
    let reason = match section {
        Some(Section::Stroboscopic) if setup.flow.forcing.is_none() => "no force with one period",
        Some(Section::Impact) if !setup.wall => "no wall",
        _ => return Ok(section),
    };
    let message = format!("{} has {reason}", setup.name);
    Err(Refused::usage("section", message, "--section velocity").into())
}

/// The end asked for; at the last time asked for; else as long as is usual.
fn end(
    asked: Option<&End>,
    last: Option<&Quantity>,
    setup: &Setup,
) -> Result<simulate::End, Error> {
    let periods = |n: u32| match &setup.flow.forcing {
        Some(period) => simulate::End::Time(period.times(&Rational::from(n))),
        None => simulate::End::Maxima(n),
    };
    Ok(match (asked, last) {
        (Some(End::Time(time)), _) => simulate::End::Time(time.clone().into()),
        (Some(End::Periods(n)), _) => periods(*n),
        (Some(End::Impacts(_)), _) if !setup.wall => {
            let message = "there is no wall; use --until or --periods";
            return Err(Refused::usage("impacts", message, "").into());
        }
        (Some(End::Impacts(n)), _) => simulate::End::Impacts(*n),
        // As long as it takes.
        (None, Some(last)) if last.float(64) > 0 => simulate::End::Time(last.clone()),
        _ if setup.wall => simulate::End::Impacts(USUAL),
        _ if setup.flow.forcing.is_some() => periods(USUAL),
        _ => simulate::End::Time(Quantity::from(i64::from(USUAL))),
    })
}

/// What to integrate.
fn plan(question: &Simulate, setup: Setup) -> Result<Plan, Error> {
    let usage = |code, message: &str| Err(Refused::usage(code, message, "").into());
    let asked: Vec<Quantity> =
        question.times.iter().flatten().map(|t| Quantity::from(t.clone())).collect();
    let end = end(question.end.as_ref(), asked.last(), &setup)?;
    let empty = match &end {
        simulate::End::Time(time) => time.float(64) <= 0,
        simulate::End::Maxima(n) | simulate::End::Impacts(n) => *n == 0,
    };
    if empty {
        return usage("until", "the end is not after the start");
    }
    if let (Some(last), simulate::End::Time(time)) = (asked.last(), &end)
        && last.float(64) > time.float(64)
    {
        return usage("times", "times go on after the end: --until, --periods");
    }
    let times = match (&question.times, &end) {
        (None, simulate::End::Time(time)) => {
            (0..=USUAL).map(|k| time.times(&Rational::from((k, USUAL)))).collect()
        }
        _ => asked,
    };
    if times.first().is_some_and(|first| first.float(64) < 0) {
        return usage("times", "times begin at 0");
    }
    let section = section(question.section, question.view == Some(View::Section), &setup)?;
    if question.skip.is_some() && section.is_none() {
        return usage("skip", "--skip leaves out points of a section: --section");
    }
    let view = match (question.view, section) {
        (Some(view), _) => view,
        (None, Some(_)) => View::Section,
        (None, None) if setup.wall => View::Time,
        (None, None) => View::Phase,
    };
    let skip = question.skip.unwrap_or(0) as usize;
    let drawn = question.drawn;
    Ok(Plan { setup, end, times, section, skip, drawn, view, cut: None })
}

/// |a - b|.
fn difference(a: &Float, b: &Float) -> Float {
    Float::with_val(53, a - b).abs()
}
