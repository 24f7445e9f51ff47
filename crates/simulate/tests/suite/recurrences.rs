//! The recurrences against the expression tree, which the test evaluates by itself at random
//! points of random equations.

use lindstedt_equation::{Expression, Function, Unknown};
use lindstedt_simulate::{Digits, Doubles, Integrator, Model, Parameters, Real, Report, Settings};
use rug::ops::Pow;
use rug::{Float, Rational};
use std::ops::ControlFlow;

const BITS: u32 = 260;

/// A linear congruential generator (Knuth, MMIX): reproducible trees.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn rational(&mut self) -> Rational {
        Rational::from((self.below(41) as i64 - 20, 7 + self.below(9) as i64))
    }

    fn tree(&mut self, depth: u32) -> Expression {
        if depth == 0 {
            return match self.below(7) {
                0 | 1 => Expression::DISPLACEMENT,
                2 => Expression::VELOCITY,
                3 => Expression::Time,
                4 => Expression::parameter("p"),
                5 => Expression::Small,
                _ => Expression::Number(self.rational()),
            };
        }
        let inner = |this: &mut Self| this.tree(depth - 1);
        // Between 1 and 3: allowed under logarithms, powers and quotients.
        let positive = |this: &mut Self| this.tree(depth - 1).apply(Function::Sin) + 2;
        match self.below(14) {
            0 | 1 => inner(self) + inner(self) - inner(self),
            2 | 3 => inner(self) * inner(self),
            4 => inner(self).pow(self.below(5) as i64),
            5 => positive(self).pow(-1 - self.below(3) as i64),
            6 => positive(self).pow(Expression::Number(self.rational())),
            7 => positive(self).pow(inner(self).apply(Function::Cos)),
            8 => positive(self).ln(),
            9 => inner(self).apply(Function::Cos).apply(Function::Exp),
            10 => inner(self).apply(Function::Sin),
            11 => inner(self).apply(Function::Abs) * self.tree(0),
            12 => inner(self).apply(Function::Sign),
            _ => {
                let delayed = [Expression::DISPLACEMENT, Expression::VELOCITY, Expression::Time];
                let index = self.below(3) as usize;
                delayed[index].clone().delayed(Expression::Number(Rational::from((3, 2))))
            }
        }
    }
}

struct Point {
    x: Float,
    v: Float,
    t: Float,
}

/// x = cos t - t/3 before the start.
fn history(t: Float) -> Point {
    let (sin, cos) = t.clone().sin_cos(Float::new(BITS));
    let third = Float::with_val(BITS, Rational::from((1, 3)));
    Point { x: cos - Float::with_val(BITS, &t / 3u32), v: -sin - third, t }
}

fn evaluate(e: &Expression, at: &Point) -> Float {
    let float = |q: &Rational| Float::with_val(BITS, q);
    match e {
        Expression::Number(q) => float(q),
        Expression::Parameter(_) => float(&Rational::from((2, 3))),
        Expression::Small => float(&Rational::from((1, 5))),
        Expression::Unknown(Unknown { delay: Some(delay), index, derivative }) => {
            let then = Float::with_val(BITS, &at.t - evaluate(delay, at));
            evaluate(&Expression::unknown(*index, *derivative), &history(then))
        }
        Expression::Unknown(Unknown { derivative: 0, .. }) => at.x.clone(),
        Expression::Unknown(_) => at.v.clone(),
        Expression::Time => at.t.clone(),
        Expression::Sum(list) => list.iter().fold(Float::new(BITS), |sum, e| sum + evaluate(e, at)),
        Expression::Product(list) => {
            list.iter().fold(Float::with_val(BITS, 1), |product, e| product * evaluate(e, at))
        }
        Expression::Power(base, exponent) => evaluate(base, at).pow(evaluate(exponent, at)),
        Expression::Function(function, argument) => {
            let x = evaluate(argument, at);
            match function {
                Function::Ln => x.ln(),
                Function::Exp => x.exp(),
                Function::Sin => x.sin(),
                Function::Cos => x.cos(),
                Function::Abs => x.abs(),
                Function::Sign if x.is_zero() => x,
                Function::Sign => x.signum(),
            }
        }
        other => panic!("{other:?}"),
    }
}

/// |x'' + tree| inside the first segment, relative to the terms; nothing if the equation was
/// refused or blew up.
fn defect<R: Real>(real: &R, digits: u32, tree: &Expression) -> Option<f64> {
    let equation = Expression::ACCELERATION + tree.clone();
    let past = Expression::Time.apply(Function::Cos)
        - Expression::Time * Expression::Number(Rational::from((1, 3)));
    let parameters =
        Parameters::new().with("p", Rational::from((2, 3))).with("eps", Rational::from((1, 5)));
    let model = Model::second_order(&equation).unwrap().with_small("eps").with_history(&[past]);
    let system = model.compile(real.clone(), &parameters).unwrap();
    let start = [real.double(0.8125), real.double(-0.28125)];
    let time = real.double(0.375);
    let settings = Settings::for_digits(digits);
    let mut flow = Integrator::new(&system, &time, &start, settings).ok()?;
    let mut worst: Option<f64> = None;
    let outcome = flow.advance(&real.double(1.0), &mut |report| {
        let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
        for share in [0.0, 0.37, 0.81] {
            let s = real.product(segment.length, &real.double(share));
            let lift = |x: &R::Element| Float::with_val(BITS, real.to_float(x));
            let value = |state| lift(&segment.value(state, &s));
            let t = Float::with_val(BITS, lift(segment.start) + lift(&s));
            let at = Point { x: value(0), v: value(1), t };
            // x'' = sum k v_k s^(k-1).
            let c = segment.coefficients(1).unwrap();
            let mut second = Float::new(BITS);
            for (k, c) in c.iter().enumerate().skip(1).rev() {
                second = second * lift(&s) + lift(c) * k as u32;
            }
            let force = evaluate(tree, &at);
            let scale = 1.0 + force.to_f64().abs();
            let error = Float::with_val(BITS, second + force).to_f64().abs() / scale;
            worst = Some(worst.unwrap_or(0.0).max(error));
        }
        ControlFlow::Break(())
    });
    outcome.ok()?;
    worst
}

#[test]
fn random_equations() {
    let mut random = Random(20_261_120);
    let (mut done, mut worst, mut fast) = (0, 0f64, 0f64);
    for case in 0..400 {
        let tree = random.tree(1 + case % 4);
        let Some(error) = defect(&Digits::for_digits(40), 40, &tree) else { continue };
        assert!(error < 1e-34, "{tree:?} {error:e}");
        worst = worst.max(error);
        if let Some(error) = defect(&Doubles, 16, &tree) {
            assert!(error < 1e-9, "{tree:?} {error:e}");
            fast = fast.max(error);
        }
        done += 1;
    }
    println!("{done} equations, {worst:e} {fast:e}");
    assert!(done > 350);
}
