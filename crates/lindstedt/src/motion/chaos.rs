//! Largest Lyapunov exponent and 0-1 test: numbers that tell chaos from regular motion.

use super::set_up;
use super::setup::Setup;
use super::{Start, answer, precomputed};
use crate::refusal::Refused;
use crate::{Answer, Error, Number, Oscillator, Progress, Remark, Standing, Status, Work};
use lindstedt_equation::Expression;
use lindstedt_number::ball::Balls;
use lindstedt_simulate::{
    Doubles, LyapunovExponent, LyapunovSettings, PoincareMap, Section, Settings, SimulateError,
    Surface, ZeroOne, is_in_bands, is_stationary, largest_lyapunov_exponent, recurs, zero_one,
};
use rug::Float;
use serde::Serialize;
use std::ops::ControlFlow;
use std::time::Instant;

/// Fewer intervals tell nothing.
const LEAST: u32 = 100;
/// A part of the period with no simple fraction near: impacts of orbits of few periods are elsewhere.
const PHASE: f64 = 0.381_966;
/// Every m-th point, m up to this: an attractor in m bands looks regular to the 0-1 test.
const STRIDES: usize = 4;
/// And up to this where the m bands are seen in x: other regular series, thinned more, may turn so slowly that they look
/// chaotic.
const BANDS: usize = 16;

/// The question whether a motion is chaotic, by the exponent, the test, or both.
///
/// ```
/// use lindstedt::{Oscillator, Work, motion::Chaos};
/// let duffing = Oscillator::builtin("duffing")?;
/// let question = Chaos { lyapunov: true, kept: 300, skipped: 100, ..Chaos::default() };
/// let answer = duffing.chaos(&question, &Work::default())?;
/// assert!(answer.value.verdict.starts_with("no exponential growth"));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chaos {
    /// Where the motion starts.
    pub start: Start,
    /// Whether the largest Lyapunov exponent is asked for.
    pub lyapunov: bool,
    /// Whether the 0-1 test is.
    pub zero_one: bool,
    /// Periods of the force averaged over, units of time without one; points of the series. At least
    /// 100.
    pub kept: u32,
    /// Left out before.
    pub skipped: u32,
}

impl Default for Chaos {
    /// Neither, over 2000 periods after 500.
    fn default() -> Self {
        Self { start: Start::default(), lyapunov: false, zero_one: false, kept: 2000, skipped: 500 }
    }
}

/// The largest Lyapunov exponent.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Exponent {
    /// Its value; minus infinity where every perturbation is forgotten.
    #[serde(flatten)]
    pub number: Number,
    /// How the error is estimated.
    pub estimate: &'static str,
    /// The time between two renormalisations.
    pub interval: f64,
    #[serde(skip)]
    found: LyapunovExponent,
}

/// The 0-1 test of every m-th point.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Test {
    /// K: 0 for regular, 1 for chaotic motion.
    #[serde(flatten)]
    pub k: Number,
    /// m.
    pub every: usize,
    /// The quartiles of K over the frequencies.
    pub quartiles: [f64; 2],
    #[serde(skip)]
    found: ZeroOne,
    /// Whether the two halves of these points are alike.
    #[serde(skip)]
    stationary: bool,
    /// Whether they return to themselves.
    #[serde(skip)]
    recurs: bool,
}

/// The 0-1 tests.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ZeroOneTest {
    /// What is tested.
    pub series: &'static str,
    /// Whether its two halves are alike, without which K says nothing.
    pub stationary: bool,
    /// How the error is estimated.
    pub estimate: &'static str,
    /// One per m, from 1.
    pub k: Vec<Test>,
}

/// The result of [`Oscillator::chaos`].
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Diagnosis {
    /// Those of doubles.
    pub digits: u32,
    /// The start.
    pub start: answer::Begin,
    /// The motion before the start, in words, where there is a delay.
    pub history: Option<&'static str>,
    /// Intervals left out.
    pub skip: u32,
    /// Intervals that count.
    pub kept: u32,
    /// The largest Lyapunov exponent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lyapunov: Option<Exponent>,
    /// The 0-1 test.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zero_one: Option<ZeroOneTest>,
    /// In words.
    pub verdict: String,
}

/// What is tested where x itself wanders.
const FORCED_STEPS: &str = "steps of x (which wanders) from one period of the force to the next";
const STEPS: &str = "steps of x (which wanders) from one maximum to the next";

impl Oscillator {
    /// The largest Lyapunov exponent and the 0-1 test of a motion, in doubles.
    ///
    /// Estimated: of the exponent the standard error of the mean from 20 blocks, of K half the
    /// distance of the quartiles. Cost: that of the motion, for the exponent with its linearisation.
    ///
    /// # Errors
    /// [`Refused`] for too few intervals, where there is no series, and for stopped work;
    /// [`Error::Simulate`], among them [`SimulateError::LinearisationWithDelay`]: with a delay there is
    /// the test alone.
    pub fn chaos(&self, question: &Chaos, work: &Work) -> Result<Answer<Diagnosis>, Error> {
        let begin = Instant::now();
        let Chaos { kept, skipped, .. } = *question;
        if kept < LEAST {
            let message = format!("{kept} periods tell nothing, at least {LEAST} do");
            return Err(Refused::usage("chaos", message, "--periods 2000").into());
        }
        self.single()?;
        let setup = set_up(self, &question.start, false, precomputed(work))?;
        let mut remarks = self.remarks().to_vec();
        remarks.extend(setup.remarks.iter().cloned().map(Remark));
        if setup.orbit.is_some() {
            let text = "an unstable orbit is left by rounding errors alone: few periods tell of the \
                        orbit, many of where the motion ends; --state starts elsewhere";
            remarks.push(Remark(text.to_owned()));
        }
        let period = setup.flow.forcing.as_ref().map(|q| q.float(53).to_f64());
        let run = Run {
            interval: period.unwrap_or(1.0),
            phase: period.filter(|_| setup.wall).map_or(0.0, |period| PHASE * period),
            forced: period.is_some(),
            skipped,
            kept,
            setup,
            work,
        };
        let lyapunov = question.lyapunov.then(|| run.lyapunov()).transpose()?;
        let zero_one = question.zero_one.then(|| run.zero_one()).transpose()?;
        let value = Diagnosis {
            digits: 16,
            start: answer::Begin::new(&run.setup),
            history: run.setup.history,
            skip: skipped,
            kept,
            verdict: run.verdict(lyapunov.as_ref(), zero_one.as_ref()),
            lyapunov,
            zero_one,
        };
        let header = self.header(run.setup.at, None, "doubles", begin);
        Ok(Answer { header, value, standing: Standing::Complete, remarks })
    }
}

/// A motion in doubles.
struct Run<'a> {
    setup: Setup,
    work: &'a Work,
    /// Time between two renormalisations and, with a force, between two points.
    interval: f64,
    /// When the first interval begins: with a force and a wall off the impacts of the orbit, which
    /// begins just after one and may have the period of the force.
    phase: f64,
    forced: bool,
    skipped: u32,
    kept: u32,
}

/// A number with an estimated error; infinities are said as they are.
fn number(value: f64, error: f64) -> Number {
    let balls = Balls::new(64);
    let ball = balls.from_parts(&Float::with_val(53, value), &Float::with_val(53, error));
    let number = if value.is_finite() { Number::measured(&ball, 17) } else { None };
    number.unwrap_or_else(|| Number {
        exact: None,
        decimal: value.to_string(),
        error: None,
        status: Status::Estimated,
    })
}

impl Run<'_> {
    fn tick(&self) -> ControlFlow<()> {
        if self.work.stop.asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn start(&self) -> [f64; 2] {
        self.setup.flow.start.each_ref().map(|q| q.float(53).to_f64())
    }

    /// The state at the beginning of the first interval.
    fn shifted(&self) -> Result<(f64, Vec<f64>), Error> {
        let start = self.start().to_vec();
        if self.phase == 0.0 {
            return Ok((0.0, start));
        }
        let system = self.setup.flow.model.compile(Doubles, &self.setup.flow.parameters)?;
        let settings = Settings::for_digits(16);
        let section = Section::Period(self.phase);
        let mut map = PoincareMap::new(&system, &0.0, &start, section, settings)?;
        let point = map.next_point(&|| self.tick()).map_err(stopped)?;
        Ok(point.map_or((0.0, start), |point| (point.time, point.state)))
    }

    fn lyapunov(&self) -> Result<Exponent, Error> {
        let system = self.setup.flow.model.clone().linearised();
        let system = system.compile(Doubles, &self.setup.flow.parameters)?;
        let settings = LyapunovSettings {
            interval: self.interval,
            transient: self.skipped,
            averaged: self.kept,
            integration: Settings::for_digits(16),
        };
        let (time, state) = self.shifted()?;
        let all = self.skipped.saturating_add(self.kept) as usize;
        let found = largest_lyapunov_exponent(&system, &time, &state, &settings, &mut |n| {
            self.work.tell(Progress::Parts(n as usize, all));
            self.tick()
        })?;
        let found = found.ok_or_else(|| stopped(SimulateError::Stopped))?;
        Ok(Exponent {
            number: number(found.value, found.error),
            estimate: "mean of ln(growth)/interval in doubles; error: standard error of the mean from \
                       20 blocks, which knows nothing of slow transients",
            interval: self.interval,
            found,
        })
    }

    /// x once per period of the force, or its maxima.
    fn series(&self) -> Result<Vec<f64>, Error> {
        let mut model = self.setup.flow.model.clone();
        let section = if self.forced && self.phase > 0.0 {
            Section::Strobe { first: self.phase, period: self.interval }
        } else if self.forced {
            Section::Period(self.interval)
        } else {
            model = model.with_section(Expression::VELOCITY);
            let surface = Surface::Section(0);
            Section::Events { surface, rising: Some(false), patience: 1e3 }
        };
        let system = model.compile(Doubles, &self.setup.flow.parameters)?;
        let settings = Settings::for_digits(16);
        let mut map = PoincareMap::new(&system, &0.0, &self.start(), section, settings)?;
        let (mut series, all) = (Vec::new(), self.skipped.saturating_add(self.kept));
        for n in 0..all {
            self.work.tell(Progress::Parts(n as usize, all as usize));
            let point = map.next_point(&|| self.tick()).map_err(stopped)?;
            let Some(point) = point else {
                let message = format!("the maxima of x cease after {n}: no series to test");
                return Err(Refused::no_answer("no-series", message, "another start").into());
            };
            if n >= self.skipped {
                series.extend(point.state.first().copied());
            }
        }
        Ok(series)
    }

    fn zero_one(&self) -> Result<ZeroOneTest, Error> {
        let mut series = self.series()?;
        let mut stationary = is_stationary(&series);
        let mut name = if self.forced { "x once per period of the force" } else { "maxima of x" };
        if !stationary {
            // The angle of a pendulum that turns over wanders, its steps do not.
            let steps: Vec<f64> = series.windows(2).map(|pair| pair[1] - pair[0]).collect();
            if is_stationary(&steps) {
                (series, stationary, name) =
                    (steps, true, if self.forced { FORCED_STEPS } else { STEPS });
            }
        }
        let mut k = Vec::new();
        let tested = |m: &usize| *m <= STRIDES || is_in_bands(&series, *m);
        for every in (1..=BANDS).filter(tested) {
            let thinned: Vec<f64> = series.iter().copied().step_by(every).collect();
            match zero_one(&thinned, &|| self.tick()) {
                Some(found) => {
                    let (low, high) = found.quartiles;
                    let number = number(found.k, (high - low) / 2.0);
                    let stationary = stationary && is_stationary(&thinned);
                    let (quartiles, recurs) = ([low, high], recurs(&thinned));
                    k.push(Test { k: number, every, quartiles, found, stationary, recurs });
                }
                None if self.work.stop.asked() => return Err(stopped(SimulateError::Stopped)),
                None => {}
            }
        }
        Ok(ZeroOneTest {
            series: name,
            stationary,
            estimate: "median of K over 100 frequencies in doubles; error: half the distance of the \
                       quartiles; several bands look regular, so every 2nd, 3rd, 4th point is tested \
                       too, and every m-th of m <= 16 bands that are apart in x",
            k,
        })
    }

    fn verdict(&self, exponent: Option<&Exponent>, test: Option<&ZeroOneTest>) -> String {
        let exponent = exponent.map(|exponent| self.of_exponent(exponent));
        // The first test whose K is largest.
        let largest =
            test.and_then(|t| t.k.iter().rev().max_by(|a, b| a.found.k.total_cmp(&b.found.k)));
        let test = largest.map(|test| self.of_test(test));
        exponent.into_iter().chain(test).collect::<Vec<_>>().join("; ")
    }

    fn of_exponent(&self, exponent: &Exponent) -> String {
        let LyapunovExponent { value, error } = exponent.found;
        if value == f64::NEG_INFINITY {
            return "every perturbation is forgotten (the motion sticks or rests): regular"
                .to_owned();
        }
        // Regular motion without dissipation lets perturbations grow like a power of t.
        let growth = value * self.interval * f64::from(self.kept);
        let share = f64::from(self.kept) / f64::from(self.skipped.max(1));
        let power = 3.0 * share.ln_1p() + 3.0;
        let word = match value {
            value if value > 4.0 * error && growth > power && self.setup.linear => {
                "a linear equation is not chaotic: its motions and perturbations grow alike"
            }
            value if value > 4.0 * error && growth > power => "chaotic: perturbations grow",
            value if value < -4.0 * error && growth < -3.0 => "regular: perturbations decay",
            _ if !self.forced => {
                "no exponential growth (the exponent of a regular motion that no force drives is 0)"
            }
            _ => "undecided: no exponential growth, no decay",
        };
        // As it stands above the verdict.
        let Number { decimal, error, .. } = &exponent.number;
        let error = error.as_deref().unwrap_or("0");
        format!("{word}, largest Lyapunov exponent {decimal} +- {error}")
    }

    fn of_test(&self, test: &Test) -> String {
        let word = match test.found {
            _ if self.setup.linear => "says nothing of a linear equation, which is not chaotic",
            ZeroOne { k, .. } if k >= 0.3 && !test.stationary => {
                "undecided, the two halves of the series differ (a transient? --skip leaves it out)"
            }
            ZeroOne { k, .. } if k >= 0.3 && test.recurs => {
                "undecided, the series returns to itself, as that of few frequencies does (more --periods tell)"
            }
            // One wide distribution of K is no growth at all frequencies.
            ZeroOne { k, quartiles } if k > 0.8 && quartiles.0 > 0.5 => "chaotic",
            ZeroOne { k, .. } if k < 0.3 => "regular",
            _ => "undecided",
        };
        let every = match test.every {
            1 => String::new(),
            2 => " at every 2nd point".to_owned(),
            3 => " at every 3rd point".to_owned(),
            m => format!(" at every {m}th point"),
        };
        format!("0-1 test {word}: K = {:.4}{every}", test.found.k)
    }
}

fn stopped(error: SimulateError) -> Error {
    match error {
        SimulateError::Stopped => {
            Refused::stopped("stopped before the average was complete", "fewer --periods").into()
        }
        error => error.into(),
    }
}
