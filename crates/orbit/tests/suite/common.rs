//! Equations, guesses and truths that several tests share.

use lindstedt_equation::{Expression, Function};
use lindstedt_number::ball::Ball;
use lindstedt_orbit::{Failure, Field, Kind, Proof, Request, Start, prove};
use lindstedt_simulate::{Digits, Integrator, Model, Parameters, Real, Settings, go_on};
use rug::{Float, Rational};

pub fn x() -> Expression {
    Expression::DISPLACEMENT
}

pub fn y() -> Expression {
    Expression::VELOCITY
}

pub fn q(numerator: i64, denominator: i64) -> Expression {
    Expression::Number(Rational::from((numerator, denominator)))
}

pub fn cosine(angle: Expression) -> Expression {
    angle.apply(Function::Cos)
}

/// x'' + rest = 0.
pub fn equation(rest: Expression) -> Expression {
    Expression::ACCELERATION + rest
}

pub fn field(equation: &Expression) -> Field {
    Field::new(equation, "eps", &Default::default()).unwrap()
}

/// x'' + x + eps (x^2 - 1) x' = 0.
pub fn van_der_pol(eps: Expression) -> Expression {
    equation(x() + eps * (x().pow(2) - 1) * y())
}

/// x'' + x + eps x^3 = 0.
pub fn duffing(eps: Expression) -> Expression {
    equation(x() + eps * x().pow(3))
}

/// x'' in doubles, the tree walked: crude, but a guess is all that it is for.
pub fn value(e: &Expression, at: [f64; 3]) -> f64 {
    match e {
        Expression::Number(q) => q.to_f64(),
        Expression::Unknown(unknown) => [at[0], at[1], 0.0][unknown.derivative as usize],
        Expression::Time => at[2],
        Expression::Sum(list) => list.iter().map(|e| value(e, at)).sum(),
        Expression::Product(list) => list.iter().map(|e| value(e, at)).product(),
        Expression::Power(base, n) => value(base, at).powf(value(n, at)),
        Expression::Function(Function::Cos, z) => value(z, at).cos(),
        Expression::Function(Function::Sin, z) => value(z, at).sin(),
        Expression::Function(Function::Exp, z) => value(z, at).exp(),
        other => panic!("{other:?}"),
    }
}

/// One step of Runge and Kutta.
fn step(equation: &Expression, state: [f64; 2], t: f64, h: f64) -> [f64; 2] {
    let f = |s: [f64; 2], t: f64| [s[1], -value(equation, [s[0], s[1], t])];
    let go = |s: [f64; 2], k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
    let a = f(state, t);
    let b = f(go(state, a, h / 2.0), t + h / 2.0);
    let c = f(go(state, b, h / 2.0), t + h / 2.0);
    let d = f(go(state, c, h), t + h);
    let mean = |i: usize| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
    [mean(0), mean(1)]
}

/// `n` samples of the motion over `period` after `settle`.
fn samples(equation: &Expression, state: [f64; 2], settle: f64, period: f64, n: usize) -> Vec<f64> {
    let (mut state, mut t) = (state, 0.0);
    let steps = (settle / 0.01).ceil().max(1.0) as usize;
    for _ in 0..steps {
        state = step(equation, state, t, settle / steps as f64);
        t += settle / steps as f64;
    }
    let fine = 4;
    let h = period / (n * fine) as f64;
    let mut list = Vec::new();
    for _ in 0..n {
        list.push(state[0]);
        for _ in 0..fine {
            state = step(equation, state, t, h);
            t += h;
        }
    }
    list
}

/// The time between two maxima of x after `settle`, and the second maximum.
fn period_by(equation: &Expression, state: [f64; 2], settle: f64, h: f64) -> Option<(f64, f64)> {
    let (mut state, mut t) = (state, 0.0);
    let mut last: Option<f64> = (settle == 0.0).then_some(0.0);
    while t < settle + 200.0 {
        let next = step(equation, state, t, h);
        if next[0].is_nan() || next[0].abs() > 100.0 {
            return None;
        }
        if state[1] > 0.0 && next[1] <= 0.0 && t + h > settle && t > h {
            let at = t + h * state[1] / (state[1] - next[1]);
            match last {
                Some(before) => return Some((at - before, next[0])),
                None => last = Some(at),
            }
        }
        state = next;
        t += h;
    }
    None
}

/// A guess from the motion from a state.
pub fn guess(equation: &Expression, state: [f64; 2], settle: f64) -> Option<Start> {
    guess_by(equation, state, settle, 0.004, 1024)
}

/// The same with a larger step and fewer samples.
pub fn rough_guess(equation: &Expression, state: [f64; 2], settle: f64) -> Option<Start> {
    guess_by(equation, state, settle, 0.02, 128)
}

fn guess_by(
    equation: &Expression,
    state: [f64; 2],
    settle: f64,
    h: f64,
    n: usize,
) -> Option<Start> {
    let (period, top) = period_by(equation, state, settle, h)?;
    let state = if settle == 0.0 { state } else { [top, 0.0] };
    Some(Start::from_samples(period, &samples(equation, state, 0.0, period, n)))
}

pub fn proved(
    equation: &Expression,
    kind: &Kind,
    start: &Start,
    digits: u32,
) -> Result<Proof, Failure> {
    prove(&field(equation), kind, start, &Request { digits, ..Request::default() })
}

/// Decimal digits of a ball: -log10 of its relative radius.
pub fn digits(ball: &Ball) -> f64 {
    ball.relative_accuracy_bits() as f64 * std::f64::consts::LOG10_2
}

/// x and x' at a time by Taylor series with `digits` digits: the independent judge.
pub fn integrate(
    equation: &Expression,
    state: &[Float; 2],
    time: &Float,
    digits: u32,
) -> [Float; 2] {
    let real = Digits::for_digits(digits);
    let system = Model::second_order(equation).unwrap().compile(real, &Parameters::new()).unwrap();
    let element = |x: &Float| real.float(x);
    let start = [element(&state[0]), element(&state[1])];
    let zero = element(&Float::new(53));
    let mut flow = Integrator::new(&system, &zero, &start, Settings::for_digits(digits)).unwrap();
    flow.advance(&element(time), &mut |_| go_on()).unwrap();
    [flow.state()[0].clone(), flow.state()[1].clone()]
}
