//! The motion before t = 0: constant, free flight, or an expression in t; start values from it.

use crate::refusal::Refused;
use crate::{Error, Exact};
use lindstedt_equation::Function::{Cos, Exp, Sin};
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function, Operations};
use lindstedt_recognise::linear_in_time;
use lindstedt_simulate::Parameters;
use rug::{Float, Rational};

/// The equation without delay, multiplied out: a loop that is silent without delay is gone.
pub(super) fn flying(e: &Expression) -> Expression {
    let now = |e: &Expression| match e {
        Expression::Unknown(unknown) => {
            Some(Expression::unknown(unknown.index, unknown.derivative))
        }
        _ => None,
    };
    let flying = e.map(&now).canonical();
    flying.multiplied_out().unwrap_or(flying)
}

/// The expression at another time.
pub(super) fn at_time(e: &Expression, time: &Expression) -> Expression {
    e.substitute(&|leaf| (*leaf == Expression::Time).then(|| time.clone()))
}

/// Evaluates expressions in parameters (and t) at t = 0.
pub(super) struct Evaluator<'a> {
    pub parameters: &'a Parameters,
    pub small: &'a str,
    pub bits: u32,
}

impl Evaluator<'_> {
    fn number(&self, x: impl Into<f64>) -> Float {
        Float::with_val(self.bits, x.into())
    }

    /// 2 pi/frequency; nothing when the frequency has no value.
    pub fn period(&self, frequency: &Expression) -> Result<Option<Float>, Error> {
        let Some(omega) = self.value(frequency) else { return Ok(None) };
        if omega > 0 {
            return Ok(Some(Exact::PiTimes(2.into()).float(self.bits) / omega));
        }
        let frequency = frequency.print(self.small, Style::Text);
        let message = format!("the frequency of the force, {frequency}, is outside its domain > 0");
        Err(Refused::no_answer("outside-domain", message, "").into())
    }

    /// f(0) and f'(0); nothing when the expression has a state in it or no value.
    pub fn value_and_rate(&self, e: &Expression) -> Option<[Float; 2]> {
        let found = e.evaluate(&mut Rates(self))?;
        found.iter().all(Float::is_finite).then_some(found)
    }

    /// The value of an expression in parameters.
    pub fn value(&self, e: &Expression) -> Option<Float> {
        let [value, rate] = self.value_and_rate(e)?;
        rate.is_zero().then_some(value)
    }
}

/// f(0) and f'(0).
struct Rates<'a>(&'a Evaluator<'a>);

impl Rates<'_> {
    fn constant(&self, x: Float) -> [Float; 2] {
        [x, self.0.number(0)]
    }
}

impl Operations for Rates<'_> {
    type Value = [Float; 2];

    fn number(&mut self, q: &Rational) -> Option<[Float; 2]> {
        Some(self.constant(Float::with_val(self.0.bits, q)))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<[Float; 2]> {
        let parameter =
            |name: &str| Some(self.constant(self.0.parameters.get(name)?.float(self.0.bits)));
        match leaf {
            Expression::Parameter(name) => parameter(name),
            Expression::Small => parameter(self.0.small),
            Expression::Time => Some([self.0.number(0), self.0.number(1)]),
            _ => None,
        }
    }

    fn add(&mut self, [f, df]: [Float; 2], [g, dg]: [Float; 2]) -> Option<[Float; 2]> {
        Some([f + g, df + dg])
    }

    fn multiply(&mut self, [f, df]: [Float; 2], [g, dg]: [Float; 2]) -> Option<[Float; 2]> {
        Some([Float::with_val(self.0.bits, &f * &g), df * &g + f * dg])
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<[Float; 2]> {
        let ([f, df], n) = (self.0.value_and_rate(base)?, self.0.value(exponent)?);
        let power = |n: &Float| Float::with_val(self.0.bits, rug::ops::Pow::pow(&f, n));
        let below = Float::with_val(self.0.bits, &n - 1u32);
        let slope = if df.is_zero() { df } else { power(&below) * &n * df };
        Some([power(&n), slope])
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<[Float; 2]> {
        let [f, df] = self.0.value_and_rate(argument)?;
        let (value, slope) = match function {
            Sin => (f.clone().sin(), f.cos()),
            Cos => (f.clone().cos(), -f.sin()),
            Exp => (f.clone().exp(), f.exp()),
            Function::Ln => (f.clone().ln(), f.recip()),
            Function::Abs => (f.clone().abs(), f.signum()),
            Function::Sign => (f.signum(), self.0.number(0)),
        };
        Some([value, slope * df])
    }
}

/// d + k x + c x' + m x'' + p cos(omega t) + q sin(omega t) = 0.
pub(super) struct Linear {
    /// d, k, c, m, p, q.
    pub parts: [Float; 6],
    /// Of the force; 1 without one.
    pub omega: Float,
}

impl Linear {
    /// The equation without its delays; nothing where it is not linear with constant factors and at
    /// most one harmonic force.
    pub fn of(equation: &Expression, evaluator: &Evaluator<'_>) -> Option<Self> {
        let all = expand(&flying(equation))?;
        let mut parts = [0; 6].map(|_| Float::new(evaluator.bits));
        let mut known = None;
        for (m, q) in &all.terms {
            let (parameters, order) = (m.parameters.clone(), m.order);
            let bare = Monomial { order, parameters, ..Monomial::default() };
            let factor = evaluator.value(&all.tree(&bare, q))?;
            let atoms: Vec<_> = m.atoms.iter().map(|(key, n)| (all.atoms.get(key), *n)).collect();
            let place = match (m.x, m.velocity, &atoms[..]) {
                (0, 0, []) => 0,
                (1, 0, []) => 1,
                (0, 1, []) => 2,
                (0, 0, [(Some(Expression::Unknown(_)), 1)]) => 3,
                (0, 0, [(Some(Expression::Function(function @ (Cos | Sin), z)), 1)])
                    if linear_in_time(z) =>
                {
                    // cos(phase + omega t).
                    let [phase, omega] = evaluator.value_and_rate(z)?;
                    if known.as_ref().is_some_and(|known| *known != omega) {
                        return None;
                    }
                    known = Some(omega);
                    let (sin, cos) = phase.sin_cos(Float::new(evaluator.bits));
                    let (p, q) = if *function == Cos { (cos, -sin) } else { (sin, cos) };
                    parts[4] += p * &factor;
                    parts[5] += q * &factor;
                    continue;
                }
                _ => return None,
            };
            parts[place] += factor;
        }
        let omega = known.unwrap_or_else(|| evaluator.number(1));
        Some(Self { parts, omega })
    }
}

/// What a failure of a history says.
fn no_history(message: &str) -> Error {
    let hint = "give an expression: --history \"cos(t)\"; or --history constant";
    Refused::no_answer("no-history", message, hint).into()
}

/// The motion through `start` without delay as an expression in t; its numbers become parameters.
/// Only of linear equations with constant factors, damping below the critical one and at most one
/// harmonic force: x = d + P cos(omega t) + Q sin(omega t) + e^(r t) (C cos(W t) + D sin(W t)).
pub(super) fn free_flight(
    equation: &Expression,
    start: &[Float; 2],
    small: &str,
    bits: u32,
    parameters: &mut Parameters,
) -> Result<Expression, Error> {
    let found = Linear::of(equation, &Evaluator { parameters, small, bits });
    let Some(Linear { parts: [d, k, c, m, p, q], omega }) = found else {
        return Err(no_history(
            "free flight as a history: without delay the equation is not linear, with one force",
        ));
    };
    let over = |x: Float| x / &m;
    let [d, k, c, p, q] = [d, k, c, p, q].map(over);
    let times = |a: &Float, b: &Float| Float::with_val(bits, a * b);
    let rate = Float::with_val(bits, -&c) / 2u32;
    let square = k.clone() - times(&rate, &rate);
    // (k - omega^2) P + c omega Q = -p, (k - omega^2) Q - c omega P = -q.
    let stiff = k.clone() - times(&omega, &omega);
    let damped = times(&c, &omega);
    let size = times(&stiff, &stiff) + times(&damped, &damped);
    let forced = !(p.is_zero() && q.is_zero());
    if !square.is_finite() || square <= 0 || (forced && size.is_zero()) {
        return Err(no_history(
            "the history of free flight is written for damping below the critical one, away from \
             undamped resonance",
        ));
    }
    let zero = || (Float::new(bits), Float::new(bits));
    let force = || {
        let cos = (times(&damped, &q) - times(&stiff, &p)) / &size;
        (cos, -(times(&damped, &p) + times(&stiff, &q)) / &size)
    };
    let (cos, sin) = if forced { force() } else { zero() };
    let w = square.sqrt();
    let rest = -d / &k;
    let first = Float::with_val(bits, &start[0] - &rest) - &cos;
    let second =
        (Float::with_val(bits, &start[1] - times(&omega, &sin)) - times(&rate, &first)) / &w;
    let mut name = |name: &str, value: Float| named(parameters, name, value);
    let t = || Expression::Time;
    let (omega, w) = (name("omega", omega), name("W", w));
    let flight =
        name("C", first) * (w.clone() * t()).apply(Cos) + name("D", second) * (w * t()).apply(Sin);
    let force = name("P", cos) * (omega.clone() * t()).apply(Cos)
        + name("Q", sin) * (omega * t()).apply(Sin);
    Ok(name("d", rest) + force + (name("r", rate) * t()).apply(Exp) * flight)
}

/// A number under a name that no parameter of an equation has: it contains a space.
pub(super) fn named(parameters: &mut Parameters, name: &str, value: Float) -> Expression {
    let name = format!("history {name}");
    parameters.set(&name, value);
    Expression::parameter(&name)
}
