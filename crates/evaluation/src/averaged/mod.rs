//! The motion of an averaged oscillator: a(t), psi(t) and x(t) from given initial data.
//!
//!   a' = sum eps^n A_n(a),   psi' = omega_0 + sum eps^n B_n(a),   x = sum eps^n u_n(a, psi, omega t)
//!
//! (`Krylov, Bogoliubov, Mitropolsky`). Everything is estimated. The error has two parts: that of
//! integrating a' and psi', which is measured with more digits (for linear problems a is an
//! exponential and there is none), and that of breaking off the series at order N: the rates are
//! changed by what the orders to come are estimated to add (`rest.rs`), and the motions compared. The
//! series is asymptotic: the estimate means something only while its terms decrease, and is
//! withheld otherwise.

mod cycles;
mod flow;
mod json;
mod rest;
mod start;
mod truncated;

use crate::digits::bits_for;
use crate::error::EvaluationError as Error;
use crate::few::plain;
use crate::setting::{check_names, small_value};
pub use cycles::SummedCycle;
pub(crate) use cycles::exponent;
pub use flow::Ended;
use flow::Flow;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::averaging::numbers::{Numbers, numbers};
use lindstedt_derivation::{DerivationError, Work};
use lindstedt_equation::symmetry::is_reversible;
use lindstedt_equation::{Condition, Problem};
use lindstedt_number::ball::Balls;
use lindstedt_number::{Exact, Number};
use rest::{Rest, looked_at};
use rug::Float;
pub use start::Start;
use std::collections::BTreeMap;
pub use truncated::Truncated;

/// A quantity at one time.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its value; nothing where not one digit is supported.
    pub value: Option<Number>,
    /// As a double.
    pub double: f64,
    /// The estimated error; infinite where there is no estimate.
    pub error: f64,
}

/// The motion at one time.
#[derive(Clone, Debug)]
pub struct Moment {
    /// The time.
    pub time: Exact,
    /// a.
    pub amplitude: Quantity,
    /// psi, not reduced to one turn.
    pub phase: Quantity,
    /// x.
    pub displacement: Quantity,
}

/// An averaged motion.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The parameters with their values, the small one included.
    pub at: Vec<(String, Exact)>,
    /// N.
    pub order: usize,
    /// a(0), psi(0) of order N.
    pub start: [f64; 2],
    /// The growth rate R of a = a(0) exp(R t) and the frequency psi', where neither depends on a;
    /// nothing in place of one of which not one digit is supported.
    pub linear: Option<[Option<Number>; 2]>,
    /// a' and psi' at the start with their errors, estimated; nothing where not one digit is
    /// supported.
    pub rate_numbers: [Option<Number>; 2],
    /// By how much the terms of x, a' and psi' fall per order, at the start and then at the largest
    /// amplitude evaluated; nothing where none is known.
    pub ratio: Option<f64>,
    /// The largest difference of two integrations, with the digits asked for and with more, among
    /// the times evaluated; nothing while no time but 0 was, 0 where a is an exponential.
    pub integration_error: Option<f64>,
    /// Why the integration ended before the last time, if it did.
    pub ended: Option<Ended>,
    /// Whether delayed values occur: then the past before t = 0 is the averaged motion's own.
    pub is_delayed: bool,
    /// Whether there is a wall, which the averaged motion does not see: it holds between impacts.
    pub has_wall: bool,
    /// The motion at the times asked for, those that are reached.
    pub moments: Option<Vec<Moment>>,
    /// The limit cycles whose amplitude tends to a number other than 0 with the small parameter, by increasing amplitude; nothing
    /// where the coefficients are irrational, no rate depends on a, or a wall is near.
    pub cycles: Option<Vec<SummedCycle>>,
    /// Amplitudes at multiple zeros of the leading rate, where whether there are cycles is not decided.
    pub degenerate: Vec<Number>,
    /// Whether there may be cycles that are not looked for: the coefficients are irrational.
    pub not_looked_for: bool,
    full: Truncated,
    rest: Rest,
    /// Whether a time other than 0 was asked for.
    goes_on: bool,
    /// What the start may be off by, where it was computed from x and x'.
    start_error: [f64; 2],
    digits: usize,
}

/// a(0), psi(0), as given or with the given x(0), x'(0).
fn resolved(
    problem: &Problem,
    start: &Start,
    full: &Truncated,
    bits: u32,
) -> Result<[Float; 2], Error> {
    let float = |value: &Exact| Float::with_val(bits, value.ball(Balls::new(bits)).midpoint());
    match start {
        Start::Amplitude(a, psi) => Ok([float(a), float(psi)]),
        Start::State(x, v) => {
            full.invert(&[float(x), float(v)]).ok_or_else(|| Error::NoSuchStart {
                problem: problem.name.to_string(),
                displacement: x.to_string(),
                velocity: v.to_string(),
            })
        }
    }
}

/// Rates with their errors, if these are known.
fn rate_numbers(
    rates: &[Float; 2],
    errors: Option<[f64; 2]>,
    digits: usize,
) -> [Option<Number>; 2] {
    [0, 1].map(|k| {
        let (rate, balls) = (&rates[k], Balls::new(rates[k].prec()));
        match errors {
            Some(errors) => {
                let error = Float::with_val(53, errors[k]);
                Number::estimated(&balls.from_parts(rate, &error), digits)
            }
            None => plain(&balls.from_parts(rate, &Float::new(53)), digits, false),
        }
    })
}

/// Orders without which nothing is known of the rest.
const FEWEST: usize = 2;

impl Motion {
    /// The averaged expansion with its start.
    ///
    /// # Errors
    /// [`DerivationError::UnknownCondition`] for a problem that does not offer a free amplitude;
    /// [`DerivationError::Unset`] for a parameter without a value; [`Error::NoSuchStart`]; those of
    /// [`lindstedt_derivation::averaging::average`].
    pub fn new(
        problem: &Problem,
        given: &BTreeMap<String, Exact>,
        order: usize,
        start: &Start,
        work: &Work,
    ) -> Result<Self, Error> {
        if !problem.conditions.contains(&Condition::FreeAmplitude) {
            return Err(
                DerivationError::UnknownCondition { problem: problem.name.to_string() }.into()
            );
        }
        check_names(problem, given)?;
        let (small, at) = small_value(problem, given)?;
        let listed = |name: &String| problem.parameters.iter().any(|card| card.name == *name);
        // The small parameter has its value in the sum, not in the coefficients; an amplitude is
        // free.
        let parameters =
            at.iter().filter(|(name, _)| listed(name)).cloned().collect::<BTreeMap<_, _>>();
        let digits = work.printed_digits();
        let bits = bits_for(digits.saturating_add(16));
        let averaging =
            AveragingSettings { order, parameters, digits, ..AveragingSettings::default() };
        let found = numbers(problem, &averaging, bits, &mut |progress| work.goes_on(progress))?;
        let float = Float::with_val(bits, small.ball(Balls::new(bits)).midpoint());
        let cycles = found.cycles.as_ref().filter(|_| problem.impact.is_none());
        let degenerate = cycles.map_or_else(Vec::new, |found| found.degenerate.clone());
        let full = Truncated::new(&found, &float, order);
        let rest = Rest::new(&found, &float, false);
        let near = |a: &Float| [rest.quotient(&full, std::slice::from_ref(a)), rest.turn(a)];
        let cycles = cycles.map(|found| cycles::summed(found, &small, digits, &near, &work.stop));
        let drifts = found.amplitude_rate.iter().flatten().any(|(exponent, _)| *exponent != 1);
        let not_looked_for = drifts && found.cycles.is_none() && problem.impact.is_none();
        Ok(Self {
            cycles,
            degenerate,
            not_looked_for,
            ..Self::of_numbers(problem, (start, digits), &found, &float, at)?
        })
    }

    fn of_numbers(
        problem: &Problem,
        (start, digits): (&Start, usize),
        found: &Numbers,
        small: &Float,
        at: Vec<(String, Exact)>,
    ) -> Result<Self, Error> {
        let order = found.solution.len().saturating_sub(1);
        let mut full = Truncated::new(found, small, order);
        full.start = resolved(problem, start, &full, small.prec())?;
        let given = start;
        let start = full.start.clone();
        let is_autonomous = found.forcing.is_zero() && found.delays.is_empty();
        let is_reversible = is_autonomous && is_reversible(&problem.equation);
        let rest = Rest::new(found, small, is_reversible);
        let near = looked_at(std::iter::once(start[0].clone()));
        let ratio = Some(rest.quotient(&full, &near)).filter(|q| !q.is_nan());
        let known = ratio.filter(|q| *q < 1.0 && order >= FEWEST);
        let errors = known.map(|q| rest.rates(q, &near));
        let numbers = |rates: [Float; 2], scale: f64| {
            let errors = errors.map(|[first, second]| [first * scale, second]);
            rate_numbers(&rates, errors, digits)
        };
        let linear = full.linear().map(|rates| numbers(rates, 1.0));
        let rate_numbers = numbers(full.rate(&start[0]), start[0].to_f64());
        let start_error = match (given, ratio) {
            (Start::Amplitude(..), _) => [0.0; 2],
            (Start::State(..), None) => [f64::INFINITY; 2],
            (Start::State(..), Some(q)) => {
                // x and x'/omega_0 are off by about the rest of x; the turn to a and a psi adds
                // at most a factor sqrt 2.
                let error = 2.0 * rest.displacement(&full, q, &near);
                [error, if start[0].is_zero() { 0.0 } else { error / start[0].to_f64() }]
            }
        };
        Ok(Self {
            at,
            order,
            start: start.map(|x| x.to_f64()),
            linear,
            rate_numbers,
            ratio,
            integration_error: full.linear().map(|_| 0.0),
            ended: None,
            is_delayed: !found.delays.is_empty(),
            has_wall: problem.impact.is_some(),
            moments: None,
            cycles: None,
            degenerate: Vec::new(),
            not_looked_for: false,
            full,
            rest,
            goes_on: false,
            start_error,
            digits,
        })
    }

    /// a' and psi' of order N at the start.
    #[must_use]
    pub fn rates(&self) -> [f64; 2] {
        self.full.rate(&self.full.start[0]).map(|x| x.to_f64())
    }

    /// 2 pi over psi' at the start.
    #[must_use]
    pub fn turn(&self) -> f64 {
        std::f64::consts::TAU / self.rates()[1]
    }

    /// Whether the known terms say something about the rest: they decrease, and there are two of
    /// them.
    #[must_use]
    pub fn has_estimate(&self) -> bool {
        self.order >= FEWEST && self.ratio.is_some_and(|ratio| ratio < 1.0)
    }

    /// The motion at times in increasing order. Times that the integration does not reach, because
    /// it ends or the work is stopped (asked at every step), are left out.
    pub fn at(&mut self, times: &[Exact], work: &Work) -> Vec<Moment> {
        let mut goes_on = || !work.stop.asked();
        let bits = self.full.start[0].prec();
        let float = |value: &Exact| Float::with_val(bits, value.ball(Balls::new(bits)).midpoint());
        let floats: Vec<Float> = times.iter().map(float).collect();
        self.goes_on |= floats.iter().any(|time| !time.is_zero());
        let mut flow = |system: &Truncated| Flow::new(system, &floats, self.digits, &mut goes_on);
        let found = flow(&self.full);
        let amplitudes = found.states.iter().flatten().map(|state| state.values[0].clone());
        let near = looked_at(amplitudes.chain(std::iter::once(self.full.start[0].clone())));
        self.ratio = Some(self.rest.quotient(&self.full, &near)).filter(|q| !q.is_nan());
        self.ended = found.ended.clone();
        // With a' too large and too small by the estimated rest.
        let mut changed = Vec::new();
        if let Some(q) = self.ratio.filter(|_| self.has_estimate()) {
            let [of_a, of_psi] = self.rest.rates(q, &near);
            for sign in [1.0, -1.0] {
                let mut system = self.full.changed([sign * of_a, of_psi]);
                system.start[0] += sign * self.start_error[0];
                system.start[1] += self.start_error[1];
                changed.push(flow(&system));
            }
        }
        let mut list = Vec::new();
        // Errors accumulate: the largest difference so far.
        let mut truncation = [0.0f64; 2];
        for (i, time) in times.iter().enumerate() {
            if work.stop.asked() {
                break;
            }
            let Some(Some(state)) = found.states.get(i) else { continue };
            if !floats[i].is_zero() {
                let known = self.integration_error.unwrap_or(0.0);
                self.integration_error = Some(state.errors.iter().copied().fold(known, f64::max));
            }
            for (k, truncation) in truncation.iter_mut().enumerate() {
                for flow in &changed {
                    let other = flow.states.get(i).and_then(Option::as_ref);
                    let apart = other.map_or(f64::INFINITY, |other| {
                        let difference = &other.values[k] - &state.values[k];
                        Float::with_val(53, difference).to_f64().abs()
                    });
                    *truncation = truncation.max(apart);
                }
            }
            let [a, _] = &state.values;
            let at = self.full.value(&state.values, &floats[i]);
            let [of_amplitude, of_phase] = self.full.sensitivity(a);
            let here = looked_at(std::iter::once(a.clone()));
            let quotient = self.ratio.unwrap_or(1.0);
            let rest_of_x = self.rest.displacement(&self.full, quotient, &here);
            let total = [0, 1].map(|k| truncation[k] + state.errors[k]);
            let of_x = of_amplitude * total[0] + of_phase * total[1] + rest_of_x;
            let quantity = |x: &Float, error: f64| self.quantity(x, error);
            list.push(Moment {
                time: time.clone(),
                amplitude: quantity(a, total[0]),
                phase: quantity(&state.values[1], total[1]),
                displacement: quantity(&at, of_x),
            });
        }
        list
    }

    fn quantity(&self, x: &Float, error: f64) -> Quantity {
        let balls = Balls::new(x.prec());
        let double = x.to_f64();
        if !self.has_estimate() || !error.is_finite() {
            let value = plain(&balls.from_parts(x, &Float::new(53)), self.digits.min(17), false);
            return Quantity { value, double, error: f64::INFINITY };
        }
        let ball = balls.from_parts(x, &Float::with_val(53, error));
        Quantity { value: Number::estimated(&ball, self.digits), double, error }
    }

    /// What the numbers are worth, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let mut parts = vec![format!("averaged to order {}", self.order)];
        parts.push(match self.ratio {
            _ if self.order < FEWEST => "no estimate from so few orders".to_owned(),
            Some(0.0) => "all orders known vanish".to_owned(),
            Some(ratio) if ratio < 1.0 => format!(
                "the error of breaking off is estimated: the terms fall by {ratio:.1e} per order, \
                 the series being asymptotic"
            ),
            Some(ratio) => {
                format!("no estimate: the terms do not decrease, they grow by {ratio:.1} per order")
            }
            None => "no estimate of the error of breaking off".to_owned(),
        });
        parts.push(if self.full.linear().is_some() {
            "a is an exponential, without an error of integration".to_owned()
        } else {
            match self.integration_error {
                // Two integrations that agree in all their bits.
                Some(0.0) => format!(
                    "a and psi are integrated, with {} digits and with more: no difference",
                    self.digits
                ),
                Some(error) => format!("a and psi are integrated, error {error:.0e}"),
                None if self.goes_on => {
                    "a and psi are integrated to none of the times after 0".to_owned()
                }
                None => "a and psi are not integrated: no time after 0 was asked for".to_owned(),
            }
        });
        if self.is_delayed {
            parts.push("before t = 0 the motion is taken to be the same averaged one".to_owned());
        }
        if self.has_wall {
            parts.push("the wall is not seen: this is the motion between impacts".to_owned());
        }
        if let Some(reason) = &self.ended {
            parts.push(format!("the integration of a, psi ends early: {reason}"));
        }
        parts.join("; ")
    }
}
