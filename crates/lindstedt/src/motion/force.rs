//! The frequency of the forces of an equation or of a system.

use super::equation::without_phases;
use super::history::{Evaluator, at_time};
use crate::Exact;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use lindstedt_expand::Excitation;
use lindstedt_simulate::{Parameters, Quantity};
use rug::{Float, Rational};

/// Of the numbers that are compared.
const BITS: u32 = 160;
/// Moments at which the forces are compared with those later.
const MOMENTS: u32 = 16;
/// The parts of the common period of all harmonics that are tried; more than all together: constant.
const PARTS: [u32; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
const MOST: u32 = 10_000;
/// Stands for t: no name of a user has a blank.
const MOMENT: &str = "the moment";

/// The frequency 2 pi/T of the least period T of all forces; nothing where they have none in common. The small parameter is a
/// parameter by its name.
///
/// The harmonics as written are multiples of one frequency; those of their products and functions may be
/// multiples of a larger one: |cos t| has the period pi. A part of the period is one of the equations if all
/// of them have the same values that much later, at several moments, generic states and parameters.
pub(super) fn frequency(equations: &[&Expression], small: &str) -> Option<Expression> {
    let plain = equations.iter().map(|e| without_phases(e, small)).collect();
    let written = Excitation::of(&Expression::Sum(plain)).ok()?.frequency?;
    let moment = Expression::parameter(MOMENT);
    let forces: Vec<_> = equations.iter().map(|e| at_time(&generic(e, small), &moment)).collect();
    let mut parts = 1;
    for part in PARTS {
        while parts < MOST && repeat(&forces, &written, parts * part).unwrap_or(false) {
            parts *= part;
        }
    }
    (parts < MOST).then(|| (written * i64::from(parts)).canonical())
}

/// The equation with states and the small parameter as parameters, and with 1 + w^2 and w + w^3 for |w| and sign w: even and
/// odd as these are, and analytic, so that what acts for one sign of w only, or for a moment, is seen everywhere.
fn generic(e: &Expression, small: &str) -> Expression {
    e.map(&|e| match e {
        Expression::Small => Some(Expression::parameter(small)),
        Expression::Unknown(_) => {
            Some(Expression::parameter(&format!("now {}", e.print(small, Style::Text))))
        }
        Expression::Function(Function::Abs, w) => Some(generic(w, small).pow(2) + 1),
        Expression::Function(Function::Sign, w) => {
            let w = generic(w, small);
            Some(w.clone() + w.pow(3))
        }
        _ => None,
    })
}

/// Whether the forces are the same this part of 2 pi/frequency later; nothing where they have no values.
fn repeat(forces: &[Expression], frequency: &Expression, parts: u32) -> Option<bool> {
    for k in 0..MOMENTS {
        let mut parameters = Parameters::new();
        let names = forces.iter().chain([frequency]).flat_map(Expression::parameters);
        for (place, name) in (1..).zip(names) {
            // Multiples of the golden section, from 1/4 to 5/4.
            let turns = 618_034 * (u64::from(k) + 97 * place) % 1_000_003;
            parameters.set(&name, Rational::from((turns, 1_000_003)) + Rational::from((1, 4)));
        }
        parameters.set("pi", Exact::PiTimes(1.into()));
        let at = |time: &Float| {
            let mut parameters = parameters.clone();
            parameters.set(MOMENT, Quantity::Float(time.clone()));
            let evaluator = Evaluator { parameters: &parameters, small: "", bits: BITS };
            forces.iter().map(|force| evaluator.value(force)).collect::<Option<Vec<_>>>()
        };
        let evaluator = Evaluator { parameters: &parameters, small: "", bits: BITS };
        let period = evaluator.period(frequency).ok()??;
        let now = period.clone() * Float::with_val(BITS, parameters.get(MOMENT)?.float(BITS));
        let later = Float::with_val(BITS, &period / parts) + &now;
        let mut pairs = at(&now)?.into_iter().zip(at(&later)?);
        let same = |(x, y): (Float, Float)| {
            let size = Float::with_val(BITS, x.abs_ref()) + 1;
            (x - y).abs() <= size >> (BITS - 40)
        };
        if !pairs.all(same) {
            return Some(false);
        }
    }
    Some(true)
}
