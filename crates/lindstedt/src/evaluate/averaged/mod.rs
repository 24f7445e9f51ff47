//! The motion of an averaged oscillator: a(t), psi(t) and x(t) from given initial data.
//!
//!   a' = sum eps^n A_n(a),   psi' = omega_0 + sum eps^n B_n(a),   x = sum eps^n u_n(a, psi, omega t)
//!
//! (`Krylov, Bogoliubov, Mitropolsky`). Everything is estimated. The error has two parts: that of
//! integrating a' and psi', which is measured with more digits (for linear problems a is an
//! exponential and there is none), and that of breaking off the series at order N, which is taken
//! from the difference to the motions of order N - 1 and N - 2 with the same initial data. The
//! series is asymptotic: the estimate means something only while its terms decrease, and is
//! withheld otherwise.

mod flow;
mod truncated;

use super::few::plain;
use super::setting::{check_names, small_value};
use super::{bits_for, estimated};
use crate::averaging::AveragingSettings;
use crate::averaging::numbers::{Numbers, numbers};
use crate::number::Number;
use crate::{Error, Progress, Value};
use flow::Flow;
use lindstedt_coeff::ball::Balls;
use lindstedt_equation::{Condition, Problem};
use rug::Float;
use std::collections::BTreeMap;
use truncated::Truncated;

/// Where the motion starts, at t = 0.
#[derive(Clone, Debug)]
pub enum Start {
    /// a(0) and psi(0).
    Amplitude(Value, Value),
    /// x(0) and x'(0), which a(0) and psi(0) are computed from.
    State(Value, Value),
}

/// What to evaluate.
#[derive(Clone, Debug)]
pub struct MotionSettings {
    /// N.
    pub order: usize,
    /// Values of parameters by name, the small one included.
    pub parameters: BTreeMap<String, Value>,
    /// Digits asked for.
    pub digits: usize,
    /// The start.
    pub start: Start,
}

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
    pub time: Value,
    /// a.
    pub amplitude: Quantity,
    /// psi, not reduced to one turn.
    pub phase: Quantity,
    /// x.
    pub displacement: Quantity,
}

/// An averaged motion.
#[derive(Debug)]
pub struct Motion {
    /// The parameters with their values, the small one included.
    pub at: Vec<(String, Value)>,
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
    /// The ratio of the last two terms of x at the start: below one they decrease.
    pub ratio: Option<f64>,
    /// The largest difference of two integrations, with the digits asked for and with more, among
    /// the times evaluated; nothing while no time but 0 was, 0 where a is an exponential.
    pub integration_error: Option<f64>,
    /// Why the integration ended before the last time, if it did.
    pub ended: Option<lindstedt_simulate::SimulateError>,
    /// Whether delayed values occur: then the past before t = 0 is the averaged motion's own.
    pub is_delayed: bool,
    /// Whether there is a wall, which the averaged motion does not see: it holds between impacts.
    pub has_wall: bool,
    orders: Vec<Truncated>,
    digits: usize,
}

impl Motion {
    /// The averaged expansion with its start.
    ///
    /// # Errors
    /// [`Error::UnknownCondition`] for a problem that does not offer a free amplitude;
    /// [`Error::Unset`] for a parameter without a value; [`Error::NoSuchStart`]; those of
    /// [`crate::averaging::average`].
    ///
    /// ```
    /// use lindstedt::evaluate::averaged::{Motion, MotionSettings, Start};
    /// use lindstedt::{Value, problems};
    /// let problem = problems::find("van-der-pol").ok_or("no such problem")?;
    /// let start = Start::Amplitude(Value::parse("1")?, Value::parse("0")?);
    /// let parameters = [("eps".to_owned(), Value::parse("1/10")?)].into();
    /// let settings = MotionSettings { order: 4, parameters, digits: 12, start };
    /// let mut motion = Motion::new(&problem, &settings, &mut |_| true)?;
    /// let far = motion.at(&[Value::parse("100")?], &mut || true);
    /// // The limit cycle has amplitude 2 + O(eps^2).
    /// assert!((far[0].amplitude.double - 2.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        problem: &Problem,
        settings: &MotionSettings,
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Self, Error> {
        if !problem.conditions.contains(&Condition::FreeAmplitude) {
            return Err(Error::UnknownCondition { problem: problem.name.to_string() });
        }
        check_names(problem, &settings.parameters)?;
        let (small, at) = small_value(problem, &settings.parameters)?;
        let listed = |name: &String| problem.parameters.iter().any(|card| card.name == *name);
        // The small parameter has its value in the sum, not in the coefficients; an amplitude is
        // free.
        let parameters =
            at.iter().filter(|(name, _)| listed(name)).cloned().collect::<BTreeMap<_, _>>();
        let bits = bits_for(settings.digits.saturating_add(16));
        let averaging = AveragingSettings {
            order: settings.order,
            parameters,
            digits: settings.digits,
            ..AveragingSettings::default()
        };
        let found = numbers(problem, &averaging, bits, observer)?;
        let small = Float::with_val(bits, small.ball(Balls::new(bits)).midpoint());
        Self::of_numbers(problem, settings, &found, &small, at)
    }

    fn of_numbers(
        problem: &Problem,
        settings: &MotionSettings,
        found: &Numbers,
        small: &Float,
        at: Vec<(String, Value)>,
    ) -> Result<Self, Error> {
        let bits = small.prec();
        let order = found.solution.len().saturating_sub(1);
        let float = |value: &Value| Float::with_val(bits, value.ball(Balls::new(bits)).midpoint());
        // N, N - 1, N - 2.
        let mut orders = Vec::new();
        for n in (0..=order).rev().take(3) {
            let mut truncated = Truncated::new(found, small, n);
            truncated.start = match &settings.start {
                Start::Amplitude(a, psi) => [float(a), float(psi)],
                Start::State(x, v) => {
                    let state = [float(x), float(v)];
                    truncated.invert(&state).ok_or_else(|| Error::NoSuchStart {
                        problem: problem.name.to_string(),
                        displacement: x.to_string(),
                        velocity: v.to_string(),
                    })?
                }
            };
            orders.push(truncated);
        }
        let full = orders.first().ok_or(Error::NoValue)?;
        let start = full.start.clone();
        let sizes = [order, order.saturating_sub(1)].map(|n| full.size(n, &start[0]));
        let ratio = (order > 0 && !sizes[1].is_zero())
            .then(|| Float::with_val(53, &sizes[0] / &sizes[1]).to_f64());
        // A rate of order N with what the last orders add to it, N, N - 1, N - 2 in `rates`.
        let number = |rates: &[Option<[Float; 2]>], k: usize| {
            let x = &rates.first()?.as_ref()?[k];
            let apart = |i: usize, j: usize| {
                let (a, b) = (rates.get(i)?.as_ref()?, rates.get(j)?.as_ref()?);
                Some(Float::with_val(53, &a[k] - &b[k]).abs())
            };
            let quotient = ratio.filter(|ratio| *ratio < 1.0 && order > 1);
            let balls = Balls::new(bits);
            match quotient.zip(apart(0, 1)) {
                Some((quotient, last)) => {
                    let before = apart(1, 2).unwrap_or_else(|| Float::new(53)) * quotient;
                    estimated(&balls.from_parts(x, &last.max(&before)), settings.digits)
                }
                None => plain(&balls.from_parts(x, &Float::new(53)), settings.digits, false),
            }
        };
        let rates: Vec<_> = orders.iter().map(Truncated::linear).collect();
        let is_linear = rates.first().is_some_and(Option::is_some);
        let linear = is_linear.then(|| [number(&rates, 0), number(&rates, 1)]);
        let rates: Vec<_> = orders.iter().map(|order| Some(order.rate(&start[0]))).collect();
        let rate_numbers = [number(&rates, 0), number(&rates, 1)];
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
            orders,
            digits: settings.digits,
        })
    }

    /// a' and psi' of order N at the start.
    #[must_use]
    pub fn rates(&self) -> [f64; 2] {
        let rate = |order: &Truncated| order.rate(&order.start[0]).map(|x| x.to_f64());
        self.orders.first().map_or([f64::NAN; 2], rate)
    }

    /// 2 pi over psi' at the start.
    #[must_use]
    pub fn turn(&self) -> f64 {
        std::f64::consts::TAU / self.rates()[1]
    }

    /// Whether the last terms say something about the rest: those of x decrease at the start, and
    /// there are three orders (corrections of a or psi alone may vanish at every other order).
    #[must_use]
    pub fn has_estimate(&self) -> bool {
        self.orders.len() > 2 && self.ratio.is_some_and(|ratio| ratio < 1.0)
    }

    /// The motion at times in increasing order. Times that the integration does not reach, because
    /// it ends or `goes_on` says no (asked at every step), are left out.
    pub fn at(&mut self, times: &[Value], goes_on: &mut dyn FnMut() -> bool) -> Vec<Moment> {
        let Some(full) = self.orders.first() else { return Vec::new() };
        let bits = full.start[0].prec();
        let float = |value: &Value| Float::with_val(bits, value.ball(Balls::new(bits)).midpoint());
        let floats: Vec<Float> = times.iter().map(float).collect();
        let mut flow = |order| Flow::new(order, &floats, self.digits, goes_on);
        let flows: Vec<Flow> = self.orders.iter().map(&mut flow).collect();
        self.ended = flows.first().and_then(|flow| flow.ended.clone());
        let mut list = Vec::new();
        // Errors accumulate: the largest difference so far.
        let mut truncation = [0.0f64; 2];
        let quotient = self.ratio.unwrap_or(1.0).min(1.0);
        for (i, time) in times.iter().enumerate() {
            let states: Vec<Option<&flow::State>> =
                flows.iter().map(|flow| flow.states.get(i)?.as_ref()).collect();
            let Some(Some(state)) = states.first() else { continue };
            if !floats[i].is_zero() {
                let known = self.integration_error.unwrap_or(0.0);
                self.integration_error = Some(state.errors.iter().copied().fold(known, f64::max));
            }
            let mut differs = |k: usize| {
                let value = |j: usize| states.get(j).copied().flatten().map(|s| &s.values[k]);
                let apart = |a: usize, b: usize| {
                    let both = value(a).zip(value(b));
                    both.map(|(a, b)| Float::with_val(53, a - b).to_f64().abs())
                };
                let last = apart(0, 1).unwrap_or(f64::INFINITY);
                let before = apart(1, 2).unwrap_or(0.0) * quotient;
                truncation[k] = truncation[k].max(last).max(before);
                truncation[k]
            };
            let errors = [differs(0), differs(1)];
            let full = &self.orders[0];
            let at = full.value(&state.values, &floats[i]);
            let [of_amplitude, of_phase] = full.sensitivity(&state.values[0]);
            let sizes = [self.order, self.order.saturating_sub(1)]
                .map(|n| full.size(n, &state.values[0]).to_f64());
            let last = sizes[0].max(sizes[1] * quotient * quotient);
            let numeric = [state.errors[0], state.errors[1]];
            let total = [errors[0] + numeric[0], errors[1] + numeric[1]];
            let of_x = of_amplitude * total[0] + of_phase * total[1] + last;
            let quantity = |x: &Float, error: f64| self.quantity(x, error);
            list.push(Moment {
                time: time.clone(),
                amplitude: quantity(&state.values[0], total[0]),
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
        Quantity { value: estimated(&ball, self.digits), double, error }
    }

    /// What the numbers are worth, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let mut parts = vec![format!("averaged to order {}", self.order)];
        let ratio = self.ratio.filter(|_| self.orders.len() > 2);
        parts.push(match ratio {
            Some(ratio) if ratio < 1.0 => format!(
                "the error of breaking off is estimated by the last two orders (the last term of \
                 x is {ratio:.1e} of the one before), the series being asymptotic"
            ),
            Some(ratio) => format!(
                "no estimate: the last term of x is {ratio:.1} times the one before, the terms do \
                 not decrease"
            ),
            None if self.orders.len() > 2 => "no estimate: the last terms vanish".to_owned(),
            None => "no estimate from so few orders".to_owned(),
        });
        parts.push(if self.orders.first().is_some_and(|full| full.linear().is_some()) {
            "a is an exponential, without an error of integration".to_owned()
        } else {
            match self.integration_error {
                // Two integrations that agree in all their bits.
                Some(0.0) => format!(
                    "a and psi are integrated, with {} digits and with more: no difference",
                    self.digits
                ),
                Some(error) => format!("a and psi are integrated, error {error:.0e}"),
                None if self.ended.is_some() => {
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
