//! Symmetries of an equation, and what they keep from an expansion: parity, reversibility.

use crate::{Expression, Function};
use rug::Rational;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parity {
    Even,
    Odd,
}

/// Whether the form of an equation shows that its solutions can be run backwards: it does not
/// change under t -> -t, or changes its sign under t -> -t, x -> -x. Then no amplitude drifts.
pub fn is_reversible(equation: &Expression) -> bool {
    let even = |t: &Expression| parity(t, false) == Some(Parity::Even);
    let terms = || equation.terms().iter();
    terms().all(even) || terms().all(|t| parity_in_x(t) == Some(Parity::Odd))
}

/// A function in the equation that is singular at places which the motion passes at times that change
/// with the small parameter; nothing if there is none.
///
/// The derivatives of a force like |x| or sgn x hold delta functions at x = 0. In an expansion about a
/// motion that is known there they have no part as long as all corrections vanish at these times: where x
/// is odd about a quarter of the period (an odd equation that can be run backwards) for singularities
/// at x = 0, where x can be run backwards for those at x' = 0. Everywhere else an expansion by
/// values of the derivatives drops them.
///
/// ```
/// use lindstedt_equation::{Expression, Function, symmetry::moving_singularity};
/// let x = Expression::DISPLACEMENT;
/// let kink = x.clone().apply(Function::Abs);
/// let linear = Expression::ACCELERATION + x.clone();
/// assert_eq!(moving_singularity(&(linear.clone() + kink.clone() * x)), None);
/// assert_eq!(moving_singularity(&(linear + kink.clone())), Some(kink));
/// ```
pub fn moving_singularity(equation: &Expression) -> Option<Expression> {
    let equation = equation.smooth_powers().canonical();
    let is_reversible = is_reversible(&equation);
    let is_odd = equation.terms().iter().all(|t| parity(t, true) == Some(Parity::Odd));
    let vanishes = |e: &Expression, at: &Expression| {
        let zero = |e: &Expression| (e == at).then(|| Expression::integer(0));
        e.contains(at) && e.substitute(&zero).canonical() == Expression::integer(0)
    };
    let (x, velocity) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let is_harmless = |argument: &Expression| {
        let alone = |of: &Expression, other: &Expression| {
            is_power_of(argument, of) && !argument.contains(other)
        };
        is_reversible && (is_odd && alone(&x, &velocity) || alone(&velocity, &x))
    };
    let moves = |e: &Expression| match e {
        Expression::Function(Function::Abs | Function::Sign, z) => {
            !z.is_constant() && !is_harmless(z)
        }
        Expression::Function(Function::Ln, z) => {
            (vanishes(z, &x) || vanishes(z, &velocity)) && !is_harmless(z)
        }
        Expression::Power(base, exponent) => {
            let smooth = exponent.as_number().is_some_and(|n| n.is_integer() && n >= 0);
            !smooth && (vanishes(base, &x) || vanishes(base, &velocity)) && !is_harmless(base)
        }
        _ => false,
    };
    equation.find(&moves).cloned()
}

/// Whether an expression vanishes nowhere but where `of` does: a product of constants and powers of it.
fn is_power_of(e: &Expression, of: &Expression) -> bool {
    match e {
        Expression::Product(factors) => {
            factors.iter().all(|e| e.is_constant() || is_power_of(e, of))
        }
        Expression::Power(base, _) | Expression::Function(Function::Abs, base) => {
            is_power_of(base, of)
        }
        other => other == of,
    }
}

/// How an expression changes under x -> -x, t -> -t.
pub(crate) fn parity_in_x(e: &Expression) -> Option<Parity> {
    let same = parity(e, true)? == parity(e, false)?;
    Some(if same { Parity::Even } else { Parity::Odd })
}

/// How an expression changes under (x, x') -> (-x, -x'), or under x' -> -x' alone.
pub(crate) fn parity(e: &Expression, both: bool) -> Option<Parity> {
    use Parity::{Even, Odd};
    let times = |a: Parity, b: Parity| if a == b { Even } else { Odd };
    e.fold(&mut |e, below: &[Option<Parity>]| match (e, below) {
        // A delay has a direction in time.
        (Expression::Unknown(unknown), _) if unknown.delay.is_some() && !both => None,
        (Expression::Unknown(unknown), _) => {
            Some(if both || unknown.derivative % 2 == 1 { Odd } else { Even })
        }
        (Expression::Sum(_), [first, rest @ ..]) => {
            first.filter(|_| rest.iter().all(|p| p == first))
        }
        (Expression::Product(_), list) => list.iter().try_fold(Even, |p, e| Some(times(p, (*e)?))),
        (Expression::Power(_, exponent), [base, of_exponent]) => {
            let n = exponent.as_number().filter(Rational::is_integer);
            match ((*base)?, n) {
                (Even, _) => of_exponent.filter(|p| *p == Even),
                (Odd, Some(n)) => Some(if n.numer().is_even() { Even } else { Odd }),
                (Odd, None) => None,
            }
        }
        (Expression::Function(Function::Sin | Function::Sign, _), [z]) => *z,
        (Expression::Function(Function::Cos | Function::Abs, _), [z]) => z.map(|_| Even),
        (Expression::Function(..) | Expression::Formal(..), [z]) => z.filter(|p| *p == Even),
        _ => Some(Even),
    })
}
