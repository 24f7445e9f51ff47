//! Expansions of periodic solutions, at points of the phase, against the time domain.

use super::cycle::cycle;
use super::sampled::{largest_gaps, states};
use super::{Comparison, Verify};
use crate::{Derivation, Error, Oscillator};
use lindstedt_equation::{AmplitudeRole, Condition, Quantity};
use lindstedt_expand::ExpandError;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::evaluate::PhaseFunctions;
use lindstedt_phase::lobachevsky_function::Point;
use lindstedt_simulate::{Digits, Model, Parameters, Places, Real, Settings as Precision};
use rayon::prelude::*;
use rug::{Float, Rational};

/// An expansion at points of the phase, order by order, and its judge.
pub(super) struct Periodic {
    bits: u32,
    order: usize,
    /// kappa W_n, in the time of the problem.
    frequency_squared: Vec<Float>,
    /// tau_j/pi.
    turns: Vec<Rational>,
    /// a x_n(tau_j), by point and order.
    values: Vec<Vec<Float>>,
    /// a x_n(0) and a dx_n/dtau(0).
    start: [Vec<Float>; 2],
    condition: Condition,
    /// a: x is a times what was expanded.
    amplitude: Float,
    model: Model,
    parameters: Parameters,
    small: String,
}

impl Periodic {
    pub(super) fn new(
        oscillator: &Oscillator,
        d: &Derivation,
        question: &Verify,
        digits: u32,
    ) -> Result<Self, Error> {
        let problem = oscillator.problem();
        let bits = Digits::for_digits(digits + 8).bits();
        let balls = Balls::new(bits).with_guard(64);
        let float = |ball: &Ball| Float::with_val(bits, ball.midpoint());
        let ball = |n| d.ball(Quantity::FrequencySquared, n, balls).ok_or(Error::NoValue);
        let frequency_squared = (0..=d.order).map(|n| Ok(float(&ball(n)?)));
        let frequency_squared = frequency_squared.collect::<Result<Vec<_>, Error>>()?;
        // No point is an odd multiple of pi/2, where cos tau = 0 and ln|cos tau| has no value:
        // the denominator's factor 1009 does not cancel.
        let (periods, samples) = (question.periods.max(1), question.samples.max(2));
        let turn = |j: u32| {
            let numerator = (1009 * u64::from(j) + 504) * 2 * u64::from(periods);
            Rational::from((numerator, 1009 * u64::from(samples)))
        };
        let turns: Vec<Rational> = (0..samples).map(turn).collect();
        // The problem as it was written is integrated; what was expanded is x/a, unless the
        // amplitude is part of the equation or of the small parameter.
        let scaled = matches!(
            problem.amplitude,
            AmplitudeRole::Scaled | AmplitudeRole::ScalesFrequency { .. }
        );
        let amplitude = match &d.amplitude {
            Some(value) if scaled => float(&value.ball(balls)),
            _ => Float::with_val(bits, 1),
        };
        let functions = |derivative| d.phase_functions(derivative, balls).ok_or(Error::NoValue);
        let (displacement, velocity) = (functions(false)?, functions(true)?);
        let at = |functions: &PhaseFunctions, point: &Point| -> Option<Vec<Float>> {
            let values = functions.at(point)?;
            Some(values.iter().take(d.order + 1).map(|ball| float(ball) * &amplitude).collect())
        };
        let points = turns.par_iter().map(|q| at(&displacement, &Point::PiTimes(q.clone())));
        let values: Option<Vec<_>> = points.collect();
        let values = values.ok_or(Error::NoValue)?;
        let zero = Point::Rational(Rational::new());
        let [x, v] = [&displacement, &velocity].map(|f| at(f, &zero).ok_or(Error::NoValue));
        Ok(Self {
            bits,
            order: d.order,
            frequency_squared,
            turns,
            values,
            start: [x?, v?],
            condition: d.condition,
            amplitude,
            model: Model::of_problem(problem)?,
            parameters: Parameters::of_problem(problem, oscillator.given()),
            small: problem.small.to_string(),
        })
    }

    fn sum(&self, coefficients: &[Float], small: &Rational) -> Float {
        let eps = Float::with_val(self.bits, small);
        coefficients.iter().rev().fold(Float::new(self.bits), |sum, c| sum * &eps + c)
    }

    fn no_orbit(&self, small: &Rational) -> Error {
        Error::NoPeriodicOrbit { parameter: self.small.clone(), value: small.to_string() }
    }

    pub(super) fn compare(
        &self,
        small: &Rational,
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Comparison, Error> {
        let square = self.sum(&self.frequency_squared, small);
        if !(square.is_finite() && square > 0) {
            return Err(Error::NoTruncatedFrequency {
                order: self.order,
                square: format!("{:.2e}", square.to_f64()),
                parameter: self.small.clone(),
                value: small.to_string(),
            });
        }
        let frequency = square.sqrt();
        let pi = Float::with_val(self.bits, rug::float::Constant::Pi);
        let times: Vec<Float> =
            self.turns.iter().map(|q| Float::with_val(self.bits, &pi * q) / &frequency).collect();
        let coarse = self.run(small, &frequency, &times, digits, goes_on)?;
        let fine = self.run(small, &frequency, &times, digits + 8, goes_on)?;
        let expected: Vec<Float> = self.values.iter().map(|terms| self.sum(terms, small)).collect();
        Ok(largest_gaps(small, &expected, &coarse, &fine))
    }

    /// x at the times.
    fn run(
        &self,
        small: &Rational,
        frequency: &Float,
        times: &[Float],
        digits: u32,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Float>, Error> {
        let real = Digits::for_digits(digits);
        let parameters = self.parameters.clone().with(&self.small, small.clone());
        let precision = Precision::for_digits(digits);
        let expanded = self.start.each_ref().map(|terms| self.sum(terms, small));
        let start = match self.condition {
            Condition::InitialAmplitude => [real.float(&self.amplitude), real.zero()],
            Condition::LimitCycle => {
                let pi = Float::with_val(self.bits, rug::float::Constant::Pi);
                let guess = (expanded[0].clone(), pi * 2u32 / frequency);
                let system = self.model.clone().linearised().compile(real, &parameters)?;
                let cycle = cycle(&system, &guess, precision, goes_on)?;
                if !goes_on() {
                    return Err(self.interrupted());
                }
                [cycle.ok_or_else(|| self.no_orbit(small))?, real.zero()]
            }
            _ => [real.float(&expanded[0]), real.float(&(expanded[1].clone() * frequency))],
        };
        let system = self.model.compile(real, &parameters)?;
        Ok(states(&system, &start, &[0], (times, self.order), digits, goes_on)?.concat())
    }

    fn interrupted(&self) -> Error {
        ExpandError::Interrupted { order: self.order }.into()
    }
}
