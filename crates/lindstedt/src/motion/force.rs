//! The frequency of the forces of an equation or of a system.

use super::equation::without_phases;
use super::history::{Evaluator, at_time};
use crate::Exact;
use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;
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
    let free = |e: &Expression| match e {
        Expression::Small => Some(Expression::parameter(small)),
        Expression::Unknown(_) => {
            Some(Expression::parameter(&format!("now {}", e.print(small, Style::Text))))
        }
        _ => None,
    };
    let moment = Expression::parameter(MOMENT);
    let forces: Vec<_> = equations.iter().map(|e| at_time(&e.map(&free), &moment)).collect();
    let mut parts = 1;
    for part in PARTS {
        while parts < MOST && repeat(&forces, &written, parts * part).unwrap_or(false) {
            parts *= part;
        }
    }
    (parts < MOST).then(|| (written * i64::from(parts)).canonical())
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

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_problem_file::{Names, parse_equation};

    #[test]
    fn a_product_of_harmonics_may_have_a_shorter_period() {
        for (texts, expected) in [
            (&["x'' + x = F*cos(omega*t + 1/3)"][..], Some("omega")),
            (&["x'' + x = cos(omega*t) + a*cos(3/2*omega*t)"], Some("1/2*omega")),
            (&["x'' + x = F*(2*cos(3*t/5)^2 - 1)"], Some("6/5")),
            (&["x'' + x = F*cos(t)^2"], Some("2")),
            (&["x'' + x = x*abs(cos(t))"], Some("2")),
            (&["x'' + x = cos(t)*cos(t/3)"], Some("2/3")),
            (&["x'' + x = cos(t)*cos(t/3 + p)"], Some("2/3")),
            (&["x'' + x = cos(t)*(x + cos(t/3))"], Some("1/3")),
            (&["x'' + x = 16*cos(t)^5 - 20*cos(t)^3 + 5*cos(t)"], Some("5")),
            (&["x'' + sign(x' - cos(t)) + x = 0"], Some("1")),
            (&["x'' + sin(x + cos(t)^2) = 0"], Some("2")),
            (&["x'' + x = cos(t)^2 + sin(t)^2"], None),
            (&["x'' + x = cos(t) + cos(omega*t)"], None),
            (&["x'' + x = 0"], None),
            (&["x'' + x = cos((3 + eps)*t)*cos((3 + eps)*t + 1)"], Some("2*(3 + eps)")),
            (&["x'' + x = cos(2*t)", "y'' + 2*y = x - cos(3*t)"], Some("1")),
            (&["x'' + x = cos(t)", "y'' + y = x - cos(t)"], Some("1")),
        ] {
            let names = Names::any("eps").of_system(texts.iter().copied());
            let of = |text: &&str| parse_equation(text, &names);
            let list: Vec<Expression> = texts.iter().map(of).collect::<Result<_, _>>().unwrap();
            let found = frequency(&list.iter().collect::<Vec<_>>(), "eps");
            let found = found.map(|frequency| frequency.print("eps", Style::Text));
            assert_eq!(found.as_deref(), expected, "{texts:?}");
        }
    }
}
