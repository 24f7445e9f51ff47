//! Every bound against what it bounds, computed another way: left out, the truth exceeds it.

mod first;
mod moving;
mod second;
mod uncertain;

use super::*;
use crate::exact::Exact;
use crate::function::from_units;
use crate::linear::Step;
use crate::newton::{balance, invert, linearised};
use crate::operation::Operation;
use crate::product::Products;
use crate::proof::{conclude, divergence, frequency_error};
use crate::radii::decide;
use crate::task::{Kind, Rows};
use crate::transform::samples_to_modes;
use crate::{Condition, Parity, Start};
use lindstedt_equation::{Expression, Function};
use nalgebra::Complex;
use rug::{Integer, Rational};

type C = Complex<f64>;

fn x() -> Expression {
    Expression::DISPLACEMENT
}

fn v() -> Expression {
    Expression::VELOCITY
}

fn field(rest: Expression) -> Field {
    Field::new(&(Expression::ACCELERATION + rest), "eps", &Default::default()).unwrap()
}

/// x'' + x + (x^2 - 1) x' = 0.
fn van_der_pol() -> Field {
    field(x() + (x().pow(2) - 1) * v())
}

/// Two unknowns, x_i'' + rest_i = 0.
fn pair(rests: [Expression; 2]) -> Field {
    let [a, b] = [0, 1].map(|i| Expression::unknown(i, 2) + rests[i].clone());
    Field::of_equations(&[&a, &b], "eps", &Default::default()).unwrap()
}

/// A task, a centre and an inverse that need not belong together.
struct Case {
    task: Task,
    centre: Centre,
    inverse: Inverse,
}

impl Case {
    /// Cosines by unknowns at the rate omega, and the inverse there.
    fn at(
        field: Field,
        condition: Option<Condition>,
        omega: f64,
        cosines: &[&[f64]],
        modes: usize,
    ) -> Self {
        let parity = Parity::default();
        let rows = Rows { parity, condition };
        let half = |(k, a): (usize, &f64)| C::new(if k == 0 { *a } else { a / 2.0 }, 0.0);
        let unknowns: Vec<Vec<C>> =
            cosines.iter().map(|list| list.iter().enumerate().map(half).collect()).collect();
        let task = Task {
            field,
            rows,
            value: Rational::new(),
            error: Rational::new(),
            stop: Default::default(),
        };
        let centre = Centre::from_doubles(72, omega, &unknowns);
        let inverse = invert(&linearised(&task, &centre).unwrap().1, modes).unwrap();
        Self { task, centre, inverse }
    }

    /// Van der Pol's cycle balanced on 40 modes.
    fn cycle(modes: usize) -> Self {
        let start = Start { frequency: 0.94, cosines: vec![0.0, 2.0], sines: vec![] };
        let (task, guess) =
            Task::new(&van_der_pol(), &Kind::LimitCycle, &[start], &Default::default()).unwrap();
        let centre = balance(&task, guess, 40).unwrap();
        let inverse = invert(&linearised(&task, &centre).unwrap().1, modes).unwrap();
        Self { task, centre, inverse }
    }

    fn with<T>(&self, nu: f64, then: impl FnOnce(&mut Frame<'_>, &Weights) -> T) -> T {
        let (values, linear) = linearised(&self.task, &self.centre).unwrap();
        let mut frame = Frame::new(&self.task, &self.centre, &values, &linear, &self.inverse);
        let weights = frame.weights(nu).unwrap();
        then(&mut frame, &weights)
    }

    fn linear(&self) -> Linear {
        linearised(&self.task, &self.centre).unwrap().1
    }

    /// The frequency and the waves up to a mode.
    fn directions(&self, modes: usize) -> Vec<Option<Wave>> {
        let free = self.task.is_free().then_some(None);
        free.into_iter().chain(self.linear().basis(modes).into_iter().map(Some)).collect()
    }
}

/// A direction of size 1 but for its weight, on so many modes.
fn step(unknowns: usize, direction: Option<Wave>, modes: usize) -> Step {
    let mut step = Step { frequency: 0.0, unknowns: vec![vec![C::default(); modes + 1]; unknowns] };
    match direction {
        None => step.frequency = 1.0,
        Some(w) => step.unknowns[w.unknown][w.k] = w.complex(1.0),
    }
    step
}

fn sizes(list: &[Vec<C>], nu: f64, power: i32) -> f64 {
    let one = |(k, c): (usize, &C)| {
        let size = if k == 0 { c.re.abs() } else { 2.0 * (c.re.abs() + c.im.abs()) };
        size * (k.max(1) as f64).powi(power) * nu.powi(k as i32)
    };
    list.iter().flat_map(|f| f.iter().enumerate().map(one)).sum()
}

fn norm(step: &Step, scale: f64, nu: f64) -> f64 {
    scale * step.frequency.abs() + sizes(&step.unknowns, nu, 1)
}

/// |(1 - A DF) h|/|h|.
fn defect(linear: &Linear, inverse: &Inverse, h: Option<Wave>, scale: f64, nu: f64) -> f64 {
    let modes = inverse.modes.max(h.map_or(0, |w| w.k)).max(linear.by_frequency[0].len())
        + linear.band()
        + 1;
    let h = step(linear.unknowns, h, modes);
    let (condition, rows) = Products::new(linear, modes).apply(&h);
    let mut image = linear.precondition(inverse, condition, &rows);
    image.frequency -= h.frequency;
    for (a, b) in image.unknowns.iter_mut().flatten().zip(h.unknowns.iter().flatten()) {
        *a -= b;
    }
    norm(&image, scale, nu) / norm(&h, scale, nu)
}

/// The largest defect of the DF of `truth` over all directions that differ.
fn worst(case: &Case, truth: &Linear, scale: f64, nu: f64) -> f64 {
    let last = case.inverse.modes + 2 * truth.band() + 2;
    let of = |h: &Option<Wave>| defect(truth, &case.inverse, *h, scale, nu);
    case.directions(last).iter().map(of).fold(0.0, f64::max)
}

fn exactly(x: f64) -> Rational {
    Rational::from_f64(x).unwrap()
}
fn at_mode(list: &[C], k: usize) -> C {
    list.get(k).copied().unwrap_or_default()
}
