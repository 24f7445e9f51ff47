//! Largest Lyapunov exponent and 0-1 test: numbers that tell chaos from regular motion.

use super::report::bound;
use super::setup::Setup;
use crate::arguments::SimulateOptions;
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::session::Session;
use lindstedt::equation::Expression;
use lindstedt::evaluate::with_error;
use lindstedt::simulate::{
    self, Doubles, LyapunovExponent, LyapunovSettings, PoincareMap, Settings, SimulateError,
    Surface, ZeroOne, largest_lyapunov_exponent, zero_one_while,
};
use rug::Float;
use serde_json::{Value as Json, json};
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// Intervals averaged over, points of the series.
const KEPT: u32 = 2000;
/// Left out before.
const SKIPPED: u32 = 500;
/// Fewer tell nothing.
const LEAST: u32 = 100;
/// A part of the period with no simple fraction near: impacts of orbits of few periods are elsewhere.
const PHASE: f64 = 0.381_966;
/// Every m-th point, m up to this: an attractor in m bands looks regular to the 0-1 test.
const STRIDES: usize = 4;

/// What was asked, and what came of it.
pub struct Diagnosis {
    setup: Setup,
    /// Time between two renormalisations and, with a force, between two points.
    interval: f64,
    /// When the first interval begins: with a force and a wall off the impacts of the orbit, which
    /// begins just after one and may have the period of the force.
    phase: f64,
    forced: bool,
    skipped: u32,
    kept: u32,
    exponent: Option<LyapunovExponent>,
    growth: Option<Vec<(usize, ZeroOne)>>,
}

/// Whether one of the two was asked for.
pub fn wanted(options: &SimulateOptions) -> bool {
    options.lyapunov || options.zero_one
}

impl Diagnosis {
    pub fn compute(
        options: &SimulateOptions,
        mut setup: Setup,
        session: &Session<'_>,
    ) -> Result<Self, Failure> {
        let usage = |message: &str, hint: &str| Failure::usage("chaos", message.to_owned(), hint);
        let others =
            options.until.is_some() || options.impacts.is_some() || options.times.is_some();
        if others
            || options.section.is_some()
            || options.figure.is_some()
            || !options.plot.is_empty()
        {
            let message = "--lyapunov and --zero-one count periods and have no figure";
            return Err(usage(message, "--periods 2000 --skip 500"));
        }
        let kept = options.periods.unwrap_or(KEPT);
        if kept < LEAST {
            let message = format!("{kept} periods tell nothing, at least {LEAST} do");
            return Err(Failure::usage("chaos", message, "--periods 2000"));
        }
        if setup.orbit.is_some() {
            setup.remarks.push(
                "an unstable orbit is left by rounding errors alone: few periods tell of the orbit, \
                 many of where the motion ends; --state starts elsewhere"
                    .to_owned(),
            );
        }
        let period = setup.forcing.as_ref().map(|q| q.float(53).to_f64());
        let mut diagnosis = Self {
            interval: period.unwrap_or(1.0),
            phase: period.filter(|_| setup.wall).map_or(0.0, |period| PHASE * period),
            forced: period.is_some(),
            skipped: options.skip.unwrap_or(SKIPPED),
            kept,
            exponent: None,
            growth: None,
            setup,
        };
        if options.lyapunov {
            diagnosis.exponent = Some(diagnosis.lyapunov(session)?);
        }
        if options.zero_one {
            diagnosis.growth = Some(diagnosis.zero_one(session)?);
        }
        Ok(diagnosis)
    }

    fn start(&self) -> [f64; 2] {
        self.setup.start.each_ref().map(|q| q.float(53).to_f64())
    }

    /// The state at the beginning of the first interval.
    fn shifted(&self, session: &Session<'_>) -> Result<(f64, Vec<f64>), Failure> {
        let start = self.start().to_vec();
        if self.phase == 0.0 {
            return Ok((0.0, start));
        }
        let system = self.setup.model.compile(Doubles, &self.setup.parameters).map_err(refused)?;
        let (section, settings) = (simulate::Section::Period(self.phase), Settings::for_digits(16));
        let mut map = PoincareMap::new(&system, &0.0, &start, section, settings)?;
        match map.next_point_while(&|| flow(session)) {
            Err(SimulateError::Stopped) => Err(stopped(session)),
            point => Ok(point?.map_or((0.0, start), |point| (point.time, point.state))),
        }
    }

    fn lyapunov(&self, session: &Session<'_>) -> Result<LyapunovExponent, Failure> {
        let system = self.setup.model.clone().linearised();
        let system = system.compile(Doubles, &self.setup.parameters).map_err(refused)?;
        let settings = LyapunovSettings {
            interval: self.interval,
            transient: self.skipped,
            averaged: self.kept,
            integration: Settings::for_digits(16),
        };
        let (time, state) = self.shifted(session)?;
        let found = largest_lyapunov_exponent(&system, &time, &state, &settings, &mut |n| {
            session.say(format!("interval {n} of {}", self.skipped.saturating_add(self.kept)));
            flow(session)
        });
        found.map_err(refused)?.ok_or_else(|| stopped(session))
    }

    fn zero_one(&self, session: &Session<'_>) -> Result<Vec<(usize, ZeroOne)>, Failure> {
        let mut model = self.setup.model.clone();
        let section = if self.forced && self.phase > 0.0 {
            simulate::Section::Strobe { first: self.phase, period: self.interval }
        } else if self.forced {
            simulate::Section::Period(self.interval)
        } else {
            model = model.with_section(Expression::VELOCITY);
            let surface = Surface::Section(0);
            simulate::Section::Events { surface, rising: Some(false), patience: 1e3 }
        };
        let system = model.compile(Doubles, &self.setup.parameters).map_err(refused)?;
        let settings = Settings::for_digits(16);
        let mut map = PoincareMap::new(&system, &0.0, &self.start(), section, settings)?;
        let tick = || flow(session);
        let (mut series, all) = (Vec::new(), self.skipped.saturating_add(self.kept));
        for n in 0..all {
            session.say(format!("point {n} of {all}"));
            let point = match map.next_point_while(&tick) {
                Err(SimulateError::Stopped) => return Err(stopped(session)),
                point => point?,
            };
            let Some(point) = point else {
                return Err(Failure {
                    exit: NO_ANSWER,
                    code: "no-series",
                    message: format!("the maxima of x cease after {n}: no series to test"),
                    hint: "another start".into(),
                });
            };
            if n >= self.skipped {
                series.extend(point.state.first().copied());
            }
        }
        let mut list = Vec::new();
        for stride in 1..=STRIDES {
            let thinned: Vec<f64> = series.iter().copied().step_by(stride).collect();
            match zero_one_while(&thinned, &tick) {
                Some(test) => list.push((stride, test)),
                None if !session.goes_on() => return Err(stopped(session)),
                None => {}
            }
        }
        Ok(list)
    }

    /// The test whose K is largest.
    fn largest(&self) -> Option<&(usize, ZeroOne)> {
        self.growth.as_ref()?.iter().max_by(|a, b| a.1.k.total_cmp(&b.1.k))
    }

    pub fn verdict(&self) -> String {
        let mut parts = Vec::new();
        if let Some(LyapunovExponent { value, error }) = self.exponent {
            parts.push(if value == f64::NEG_INFINITY {
                "every perturbation is forgotten (the motion sticks or rests): regular".to_owned()
            } else {
                // Regular motion without dissipation lets perturbations grow like a power of t.
                let growth = value * self.interval * f64::from(self.kept);
                let share = f64::from(self.kept) / f64::from(self.skipped.max(1));
                let power = 3.0 * share.ln_1p() + 3.0;
                let word = match value {
                    value if value > 4.0 * error && growth > power && self.setup.linear => {
                        "a linear equation is not chaotic: its motions and perturbations grow alike"
                    }
                    value if value > 4.0 * error && growth > power => "chaotic: perturbations grow",
                    value if value < -4.0 * error && growth < -3.0 => {
                        "regular: perturbations decay"
                    }
                    _ if !self.forced => {
                        "no exponential growth (the exponent of a regular motion that no force drives is 0)"
                    }
                    _ => "undecided: no exponential growth, no decay",
                };
                format!("{word}, largest Lyapunov exponent {}", with_error(value, error))
            });
        }
        if let Some((stride, ZeroOne { k, quartiles })) = self.largest() {
            let word = match *k {
                _ if self.setup.linear => "says nothing of a linear equation, which is not chaotic",
                // One wide distribution of K is no growth at all frequencies.
                k if k > 0.8 && quartiles.0 > 0.5 => "chaotic",
                k if k < 0.3 => "regular",
                _ => "undecided",
            };
            let every =
                ["", "", " at every 2nd point", " at every 3rd point", " at every 4th point"];
            let every = every.get(*stride).copied().unwrap_or_default();
            parts.push(format!("0-1 test {word}: K = {k:.4}{every}"));
        }
        parts.join("; ")
    }

    fn how(&self) -> (&'static str, &'static str) {
        let exponent = "mean of ln(growth)/interval in doubles; error: standard error of the mean \
                        from 20 blocks, which knows nothing of slow transients";
        let growth = "median of K over 100 frequencies in doubles; error: half the distance of the \
                      quartiles; several bands look regular, so every 2nd, 3rd, 4th point is tested too";
        (exponent, growth)
    }

    pub fn json(&self, session: &Session<'_>) -> Json {
        let number = |value: f64, error: f64| {
            let error = Float::with_val(53, error);
            json!({"exact": null, "decimal": decimal(value), "error": bound(&error), "status": "estimated"})
        };
        let at: serde_json::Map<_, _> =
            self.setup.at.iter().map(|(n, v)| (n.clone(), v.clone().into())).collect();
        let (exponent, growth) = self.how();
        let mut result = json!({
            "problem": self.setup.name,
            "at": at,
            "digits": 16,
            "skip": self.skipped,
            "kept": self.kept,
            "verdict": self.verdict(),
            "remarks": self.setup.remarks,
            "seconds": session.elapsed().as_secs_f64(),
        });
        if let Some(LyapunovExponent { value, error }) = self.exponent {
            let mut value = number(value, error);
            value["estimate"] = exponent.into();
            value["interval"] = self.interval.into();
            result["lyapunov"] = value;
        }
        if let Some(list) = &self.growth {
            let test = |(stride, test): &(usize, ZeroOne)| {
                let mut value = number(test.k, (test.quartiles.1 - test.quartiles.0) / 2.0);
                value["every"] = (*stride).into();
                value["quartiles"] = json!([test.quartiles.0, test.quartiles.1]);
                value
            };
            let series = if self.forced { "x once per period of the force" } else { "maxima of x" };
            result["zero_one"] = json!({
                "series": series,
                "estimate": growth,
                "k": list.iter().map(test).collect::<Vec<_>>(),
            });
        }
        result
    }

    pub fn text(&self) -> String {
        let parts: Vec<String> = self.setup.at.iter().map(|(n, v)| format!("{n} = {v}")).collect();
        let mut text = format!("{}: {}\n", self.setup.name, parts.join(", "));
        for remark in &self.setup.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        let (exponent, growth) = self.how();
        if let Some(LyapunovExponent { value, error }) = self.exponent {
            let shown = if value.is_finite() { with_error(value, error) } else { decimal(value) };
            let _ = writeln!(text, "\nlargest Lyapunov exponent\n  {shown}");
            let _ = writeln!(
                text,
                "  ({} intervals of {} after {}; {exponent})",
                self.kept, self.interval, self.skipped
            );
        }
        if let Some(list) = &self.growth {
            let _ = writeln!(text, "\n0-1 test");
            for (stride, ZeroOne { k, quartiles }) in list {
                let _ = writeln!(
                    text,
                    "  every {stride}: K = {k:.4}, quartiles {:.4} and {:.4}",
                    quartiles.0, quartiles.1
                );
            }
            let _ = writeln!(text, "  ({growth})");
        }
        let _ = writeln!(text, "\n  {}", self.verdict());
        text
    }
}

fn decimal(value: f64) -> String {
    if value.is_finite() { format!("{value:.6}") } else { format!("{value}") }
}

fn flow(session: &Session<'_>) -> ControlFlow<()> {
    if session.goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
}

fn stopped(session: &Session<'_>) -> Failure {
    let (exit, code) = if session.interrupted() {
        (INTERRUPTED, "interrupted")
    } else {
        (UNDECIDED, "limit-seconds")
    };
    let message = "stopped before the average was complete".to_owned();
    Failure { exit, code, message, hint: "fewer --periods".into() }
}

fn refused(error: SimulateError) -> Failure {
    let mut failure = Failure::from(error.clone());
    if error == SimulateError::LinearisationWithDelay {
        failure.hint = "the linearised flow needs A = B = 0; --zero-one goes with a delay".into();
    }
    failure
}
