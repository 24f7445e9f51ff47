//! Limit cycles at one value of the small parameter: partial sums of their exact series.

use lindstedt_derivation::averaging::{Cycle, Cycles};
use lindstedt_number::Number;
use lindstedt_number::ball::Balls;
use rug::Float;
use serde::Serialize;

/// A limit cycle; its numbers are estimated, the error being the last term of each series.
#[derive(Clone, Debug, Serialize)]
pub struct CycleAt {
    /// The amplitude of the first harmonic; nothing where the square is not positive.
    pub amplitude: Option<Number>,
    /// The frequency.
    pub frequency: Option<Number>,
    /// The Floquet exponent per unit of t.
    pub exponent: Option<Number>,
    /// Whether the exponent is negative; nothing where its error leaves the sign open.
    pub stable: Option<bool>,
}

/// All cycles.
pub(super) fn at(found: Option<&Cycles>, small: &Float, digits: usize) -> Vec<CycleAt> {
    found
        .map_or_else(Vec::new, |found| found.cycles.iter().map(|c| one(c, small, digits)).collect())
}

fn one(cycle: &Cycle, small: &Float, digits: usize) -> CycleAt {
    let balls = Balls::new(small.prec());
    let value = balls.from_parts(small, &Float::new(53));
    let sum = |series| {
        let [sum, last] = cycle.sum(series, &value, balls);
        (sum.midpoint().clone(), last.abs_upper())
    };
    let number = |(x, error): &(Float, Float)| Number::with_error(x, error, digits);
    let [square, frequency, exponent] =
        [&cycle.squared_amplitude, &cycle.frequency, &cycle.exponent].map(|list| sum(list));
    let root = (square.0 > 0).then(|| {
        let root = square.0.clone().sqrt();
        let error = Float::with_val(53, &square.1 / 2u32) / &root;
        (root, error)
    });
    let decided = exponent.0.clone().abs() > exponent.1;
    CycleAt {
        amplitude: root.as_ref().and_then(number),
        frequency: number(&frequency),
        stable: decided.then_some(exponent.0 < 0),
        exponent: number(&exponent),
    }
}
