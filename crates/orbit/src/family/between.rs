//! A field for all values of one parameter between two numbers.

use crate::{Failure, Field};
use lindstedt_equation::{Expression, Problem};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// Bits of the ball of the parameter: its ends are rounded outwards.
const BITS: u32 = 128;

impl Field {
    /// The field of a problem for all values of the parameter `name` from `ends[0]` to `ends[1]`: what is
    /// proved of it holds for each.
    ///
    /// Where the frequencies of the force are proportional to the parameter, the unit of time is: with c the
    /// middle, r = name/c and s = r t, d^2x/ds^2 = r^-2 g(x, r dx/ds, c s). The field is that of x(s), whose
    /// force has the frequency at the middle; Fourier coefficients and extrema are those of x(t).
    ///
    /// # Errors
    /// As [`Field::new`]; [`Failure::NotPolynomial`] where only some of the frequencies depend on it.
    ///
    /// ```
    /// use lindstedt_equation::{Expression, Problem};
    /// use lindstedt_orbit::Field;
    /// use std::collections::BTreeMap;
    /// let duffing = Problem::new(
    ///     "duffing",
    ///     Expression::ACCELERATION + Expression::DISPLACEMENT + Expression::Small * Expression::DISPLACEMENT.pow(3),
    /// );
    /// let ends = [(1, 2).into(), (3, 5).into()];
    /// assert_eq!(Field::between(&duffing, &BTreeMap::new(), "eps", &ends)?.degree(), 3);
    /// # Ok::<(), lindstedt_orbit::Failure>(())
    /// ```
    pub fn between(
        problem: &Problem,
        values: &BTreeMap<String, Rational>,
        name: &str,
        ends: &[Rational; 2],
    ) -> Result<Self, Failure> {
        let equation = problem.time_domain.as_ref().unwrap_or(&problem.equation);
        let value = |e: &Expression| {
            let known = match e {
                Expression::Small => &*problem.small,
                Expression::Parameter(parameter) => parameter,
                _ => return None,
            };
            let number = || values.get(known).cloned().map(Expression::Number);
            if known == name { Some(Expression::parameter(name)) } else { number() }
        };
        let equation = equation.substitute(&value);
        let balls = Balls::new(BITS);
        let parameter = interval(balls, ends);
        let middle = middle(ends);
        let mut known = BTreeMap::from([(name.to_owned(), parameter.clone())]);
        let equation = match in_an_angle(&equation, name) {
            false => equation,
            true => {
                let ratio = balls.mul_rational(&parameter, &Rational::from(middle.recip_ref()));
                let inverse = balls.powi(&ratio, -2).filter(|_| !middle.is_zero());
                let rates = [ratio, inverse.ok_or(Failure::NoStart)?];
                known.extend(RATES.map(str::to_owned).into_iter().zip(rates));
                scaled(&equation, name, &middle)?
            }
        };
        Self::within(&equation, &problem.small, &known, BITS)
    }
}

/// r and r^-2.
const RATES: [&str; 2] = ["rate of time", "its square, inverted"];

/// A ball around all numbers between two.
pub(crate) fn interval(balls: Balls, ends: &[Rational; 2]) -> Ball {
    let half = Rational::from(&ends[1] - &ends[0]).abs() / 2u32;
    let error = Float::with_val_round(53, &half, rug::float::Round::Up).0;
    balls.add_error(&balls.from_rational(&middle(ends)), &error)
}

pub(super) fn middle(ends: &[Rational; 2]) -> Rational {
    Rational::from(&ends[0] + &ends[1]) / 2u32
}

/// Whether the parameter stands in the argument of a function.
fn in_an_angle(equation: &Expression, name: &str) -> bool {
    let parameter = Expression::parameter(name);
    let holds =
        |e: &Expression| matches!(e, Expression::Function(_, angle) if angle.contains(&parameter));
    equation.find(&holds).is_some()
}

/// The equation in the time s: every angle is proportional to the parameter.
fn scaled(equation: &Expression, name: &str, middle: &Rational) -> Result<Expression, Failure> {
    let parameter = Expression::parameter(name);
    let alone = equation.acceleration_alone().map_err(Failure::Acceleration)?;
    let zero = |e: &Expression| (*e == Expression::ACCELERATION).then(|| Expression::integer(0));
    let rest = alone.substitute(&zero);
    let put = |angle: &Expression, by: &Expression| {
        angle.substitute(&|e| (*e == parameter).then(|| by.clone()))
    };
    let proportional = |angle: &Expression| {
        let times = Expression::parameter(RATES[0]);
        let more = put(angle, &(times.clone() * parameter.clone())).multiplied_out();
        more.is_some() && more == (times * angle.clone()).multiplied_out()
    };
    let angles = |e: &Expression| matches!(e, Expression::Function(_, a) if !proportional(a));
    if let Some(other) = rest.find(&angles) {
        return Err(Failure::NotPolynomial(other.clone()));
    }
    let number = Expression::Number(middle.clone());
    let change = |e: &Expression| match e {
        Expression::Function(function, angle) => Some(put(angle, &number).apply(*function)),
        e if *e == Expression::VELOCITY => Some(Expression::parameter(RATES[0]) * e.clone()),
        _ => None,
    };
    Ok(Expression::ACCELERATION + Expression::parameter(RATES[1]) * rest.map(&change))
}
