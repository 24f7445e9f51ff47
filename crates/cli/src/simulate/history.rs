//! The motion before t = 0: constant, free flight, or an expression in t; start values from it.

use crate::failure::{Failure, NO_ANSWER};
use lindstedt::equation::Function::{Cos, Exp, Sin};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Expression, Function, Operations};
use lindstedt::simulate::Parameters;
use rug::{Float, Rational};

/// Evaluates expressions in parameters (and t) at t = 0.
pub struct Evaluator<'a> {
    pub parameters: &'a Parameters,
    pub small: &'a str,
    pub bits: u32,
}

impl Evaluator<'_> {
    fn number(&self, x: impl Into<f64>) -> Float {
        Float::with_val(self.bits, x.into())
    }

    /// 2 pi/frequency; nothing when the frequency has no value.
    pub fn period(&self, frequency: &Expression) -> Result<Option<Float>, Failure> {
        let Some(omega) = self.value(frequency) else { return Ok(None) };
        if omega > 0 {
            let pi = Float::with_val(self.bits, rug::float::Constant::Pi);
            return Ok(Some(pi * 2u32 / omega));
        }
        let frequency = frequency.print(self.small, Style::Text);
        Err(Failure {
            exit: NO_ANSWER,
            code: "outside-domain",
            message: format!("the frequency of the force, {frequency}, is outside its domain > 0"),
            hint: String::new(),
        })
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
        let ([f, df], [n, dn]) = (self.0.value_and_rate(base)?, self.0.value_and_rate(exponent)?);
        if !dn.is_zero() {
            return None;
        }
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

/// d + k x + c x' + m x'' + p cos(omega t) + q sin(omega t).
#[derive(Clone)]
struct Affine {
    parts: [Float; 6],
}

/// The equation without delays as a linear one with constant factors and one force.
struct Linear<'a> {
    evaluator: &'a Evaluator<'a>,
    omega: Option<Float>,
}

impl Linear<'_> {
    fn single(&self, place: usize, value: Float) -> Affine {
        let mut parts = [0; 6].map(|_| Float::new(self.evaluator.bits));
        if let Some(part) = parts.get_mut(place) {
            *part = value;
        }
        Affine { parts }
    }

    /// What has no unknown in it.
    fn value(&self, e: &Expression) -> Option<Affine> {
        Some(self.single(0, self.evaluator.value(e)?))
    }
}

impl Operations for Linear<'_> {
    type Value = Affine;

    fn number(&mut self, q: &Rational) -> Option<Affine> {
        Some(self.single(0, Float::with_val(self.evaluator.bits, q)))
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Affine> {
        let one = Float::with_val(self.evaluator.bits, 1);
        match leaf {
            // T = 0.
            Expression::Unknown(unknown) => Some(self.single(1 + unknown.derivative as usize, one)),
            constant => self.value(constant),
        }
    }

    fn add(&mut self, mut a: Affine, b: Affine) -> Option<Affine> {
        a.parts.iter_mut().zip(b.parts).for_each(|(a, b)| *a += b);
        Some(a)
    }

    fn multiply(&mut self, a: Affine, b: Affine) -> Option<Affine> {
        let is_number = |f: &Affine| f.parts.iter().skip(1).all(Float::is_zero);
        let (number, mut other) = match (is_number(&a), is_number(&b)) {
            (true, _) => (a.parts[0].clone(), b),
            (_, true) => (b.parts[0].clone(), a),
            _ => return None,
        };
        other.parts.iter_mut().for_each(|part| *part *= &number);
        Some(other)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Affine> {
        self.value(&base.clone().pow(exponent.clone()))
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Affine> {
        if !(matches!(function, Cos | Sin) && argument.contains(&Expression::Time)) {
            return self.value(&argument.clone().apply(function));
        }
        // cos(phase + omega t).
        let [phase, omega] = self.evaluator.value_and_rate(argument)?;
        let bent = argument.nodes().any(|e| {
            matches!(e, Expression::Function(..) | Expression::Power(..))
                && e.contains(&Expression::Time)
        });
        if bent || self.omega.as_ref().is_some_and(|known| *known != omega) {
            return None;
        }
        self.omega = Some(omega);
        let (sin, cos) = phase.sin_cos(Float::new(self.evaluator.bits));
        let mut f = self.single(0, Float::new(self.evaluator.bits));
        let (p, q) = if function == Cos { (cos, -sin) } else { (sin, cos) };
        [f.parts[4], f.parts[5]] = [p, q];
        Some(f)
    }
}

/// What a failure of a history says.
fn no_history(message: &str) -> Failure {
    Failure {
        exit: NO_ANSWER,
        code: "no-history",
        message: message.to_owned(),
        hint: "give an expression: --history \"cos(t)\"; or --history constant".into(),
    }
}

/// The motion through `start` without delay as an expression in t; its numbers become parameters.
/// Only of linear equations with constant factors, damping below the critical one and at most one
/// harmonic force: x = d + P cos(omega t) + Q sin(omega t) + e^(r t) (C cos(W t) + D sin(W t)).
pub fn free_flight(
    equation: &Expression,
    start: &[Float; 2],
    small: &str,
    bits: u32,
    parameters: &mut Parameters,
) -> Result<Expression, Failure> {
    let evaluator = Evaluator { parameters, small, bits };
    let mut linear = Linear { evaluator: &evaluator, omega: None };
    let found = equation.evaluate(&mut linear);
    let omega = linear.omega.take().unwrap_or_else(|| Float::with_val(bits, 1));
    let Some(Affine { parts: [d, k, c, m, p, q] }) = found else {
        return Err(no_history(
            "free flight as a history: without delay the equation is not linear, with one force",
        ));
    };
    let over = |x: Float| x / &m;
    let [d, k, c, p, q] = [d, k, c, p, q].map(over);
    let rate = Float::with_val(bits, -&c) / 2u32;
    let square = Float::with_val(bits, &k - Float::with_val(bits, rate.square_ref()));
    // (k - omega^2) P + c omega Q = -p, (k - omega^2) Q - c omega P = -q.
    let stiff = Float::with_val(bits, &k - Float::with_val(bits, omega.square_ref()));
    let damped = Float::with_val(bits, &c * &omega);
    let size =
        Float::with_val(bits, stiff.square_ref()) + Float::with_val(bits, damped.square_ref());
    let forced = !(p.is_zero() && q.is_zero());
    if !square.is_finite() || square <= 0 || (forced && size.is_zero()) {
        return Err(no_history(
            "the history of free flight is written for damping below the critical one, away from undamped resonance",
        ));
    }
    let times = |a: &Float, b: &Float| Float::with_val(bits, a * b);
    let (cos, sin) = if forced {
        (
            (times(&damped, &q) - times(&stiff, &p)) / &size,
            -(times(&damped, &p) + times(&stiff, &q)) / &size,
        )
    } else {
        (Float::new(bits), Float::new(bits))
    };
    let w = square.sqrt();
    let rest = -d / &k;
    let first = Float::with_val(bits, &start[0] - &rest) - &cos;
    let second =
        (Float::with_val(bits, &start[1] - times(&omega, &sin)) - times(&rate, &first)) / &w;
    // No parameter of an equation has a name with a space.
    let mut name = |name: &str, value: Float| {
        let name = format!("history {name}");
        parameters.set(&name, value);
        Expression::parameter(&name)
    };
    let t = || Expression::Time;
    let (omega, w) = (name("omega", omega), name("W", w));
    let flight =
        name("C", first) * (w.clone() * t()).apply(Cos) + name("D", second) * (w * t()).apply(Sin);
    let force = name("P", cos) * (omega.clone() * t()).apply(Cos)
        + name("Q", sin) * (omega * t()).apply(Sin);
    Ok(name("d", rest) + force + (name("r", rate) * t()).apply(Exp) * flight)
}

/// x = x(0) before t = 0.
pub fn constant(x: Float, parameters: &mut Parameters) -> Expression {
    parameters.set("history x", x);
    Expression::parameter("history x")
}
