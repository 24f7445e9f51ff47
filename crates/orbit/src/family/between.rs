//! A field for all values of one parameter between two numbers.

use crate::read::{in_time, parts};
use crate::upward::Up;
use crate::{Failure, Field};
use lindstedt_equation::{Expression, Problem, Unknown};
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
    /// As [`Field::new`]; [`Failure::NotPolynomial`] where only some of the frequencies depend on it, and
    /// [`Failure::Acceleration`] where a mass of several does.
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
        let value = |e: &Expression| {
            let known = match e {
                Expression::Small => &*problem.small,
                Expression::Parameter(parameter) => parameter,
                _ => return None,
            };
            let number = || values.get(known).cloned().map(Expression::Number);
            if known == name { Some(Expression::parameter(name)) } else { number() }
        };
        let equations = in_time(problem).into_iter();
        let equations: Vec<Expression> = equations.map(|e| e.substitute(&value)).collect();
        let balls = Balls::new(BITS);
        let clock = Clock { name, middle: &middle(ends) };
        let equations = match equations.iter().any(|e| clock.varies_in(e)) {
            false => equations,
            true if *clock.middle == 0 => return Err(Failure::NotOneNumber),
            true => clock.scaled(&equations)?.iter().map(|e| clock.in_parameter(e)).collect(),
        };
        let within = interval(balls, ends);
        let field = Self::varying(&equations, &problem.small, (name, &within), balls)?;
        Ok(field.with_ends(ends.each_ref().map(|end| balls.from_rational(end)), &within))
    }

    /// With where the ends of an interval are in the ball of the parameter.
    pub(crate) fn with_ends(mut self, ends: [Ball; 2], within: &Ball) -> Self {
        let Some(varying) = &mut self.varying else { return self };
        let [Some((middle, half)), Some((first, a)), Some((last, b))] =
            [within, &ends[0], &ends[1]].map(parts)
        else {
            return self;
        };
        let half = Rational::from_f64(half.0).unwrap_or_default();
        let missed = |(end, error): (Rational, Up)| {
            let error = Rational::from_f64(error.0).unwrap_or_default();
            let near = Rational::from(&end - &middle).abs() - error;
            Up::of(&(Rational::from(1) - near / &half))
        };
        varying.from = if first <= last { -1.0 } else { 1.0 };
        if !half.is_zero() {
            varying.slack = missed((first, a)).max(missed((last, b)));
        }
        self
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

/// The unit of time that varies with a parameter.
struct Clock<'a> {
    name: &'a str,
    middle: &'a Rational,
}

impl Clock<'_> {
    fn parameter(&self) -> Expression {
        Expression::parameter(self.name)
    }

    /// The rates as powers of the parameter.
    fn in_parameter(&self, equation: &Expression) -> Expression {
        let number = |q: Rational| Expression::Number(q);
        equation.map(&|e| match e {
            Expression::Parameter(name) if *name == RATES[0] => {
                Some(number(Rational::from(self.middle.recip_ref())) * self.parameter())
            }
            Expression::Parameter(name) if *name == RATES[1] => {
                Some(number(Rational::from(self.middle.square_ref())) * self.parameter().pow(-2))
            }
            _ => None,
        })
    }

    /// Whether the parameter stands in a function of time, outside of what does not turn.
    fn varies_in(&self, equation: &Expression) -> bool {
        let varies = |e: &Expression| match e {
            Expression::Function(_, angle) if turns(angle) => match turning(angle) {
                Some((_, rate)) => rate.contains(&self.parameter()),
                None => angle.contains(&self.parameter()),
            },
            _ => false,
        };
        equation.find(&varies).is_some()
    }

    /// The equations in the time s: every frequency is proportional to the parameter.
    fn scaled(&self, equations: &[Expression]) -> Result<Vec<Expression>, Failure> {
        let fixed = |e: &Expression| match e {
            Expression::Function(_, angle) => turns(angle) && self.moved(angle).is_none(),
            _ => false,
        };
        if let Some(other) = equations.iter().find_map(|e| e.find(&fixed)) {
            return Err(Failure::NotPolynomial(other.clone()));
        }
        let still = |e: &Expression| match e {
            Expression::Unknown(Unknown { derivative: 2, .. }) => Some(Expression::integer(0)),
            _ => None,
        };
        let times =
            |rest: &Expression| Expression::parameter(RATES[1]) * rest.map(&|e| self.change(e));
        let one = |equation: &Expression| match equations.len() {
            1 => {
                let alone = equation.acceleration_alone().map_err(Failure::Acceleration)?;
                Ok(Expression::ACCELERATION + times(&alone.substitute(&still)))
            }
            // The terms with accelerations are what differs from the rest.
            _ => {
                let rest = equation.substitute(&still);
                let inertia = (equation.clone() - rest.clone()).multiplied_out();
                let refused = || Failure::NotPolynomial(equation.clone());
                Ok(inertia.ok_or_else(refused)? + times(&rest))
            }
        };
        equations.iter().map(one).collect()
    }

    /// An angle that turns with a multiple of the parameter, in the time s.
    fn moved(&self, angle: &Expression) -> Option<Expression> {
        let (rest, rate) = turning(angle)?;
        let put =
            |by: &Expression| rate.substitute(&|e| (*e == self.parameter()).then(|| by.clone()));
        let times = Expression::parameter(RATES[0]);
        let more = put(&(times.clone() * self.parameter())).multiplied_out()?;
        let is_proportional = Some(more) == (times * rate.clone()).multiplied_out();
        let turned = put(&Expression::Number(self.middle.clone())) * Expression::Time;
        is_proportional.then(|| rest.map(&|e| self.change(e)) + turned)
    }

    fn change(&self, e: &Expression) -> Option<Expression> {
        match e {
            Expression::Function(function, angle) if turns(angle) => {
                Some(self.moved(angle)?.apply(*function))
            }
            Expression::Unknown(Unknown { derivative: 1, .. }) => {
                Some(Expression::parameter(RATES[0]) * e.clone())
            }
            _ => None,
        }
    }
}

/// Whether t stands in an angle outside of further functions.
fn turns(angle: &Expression) -> bool {
    let function = |e: &Expression| match e {
        Expression::Function(..) => Some(Expression::integer(0)),
        _ => None,
    };
    angle.map(&function).contains(&Expression::Time)
}

/// An angle as rest + rate t; nothing where it is no such sum.
fn turning(angle: &Expression) -> Option<(Expression, Expression)> {
    let at = |time: i64| {
        angle.substitute(&|e| (*e == Expression::Time).then(|| Expression::integer(time)))
    };
    let rest = at(0);
    let rate = (at(1) - rest.clone()).multiplied_out()?;
    let line = (rest.clone() + rate.clone() * Expression::Time).multiplied_out()?;
    (angle.multiplied_out()? == line).then_some((rest, rate))
}

#[cfg(test)]
mod tests {
    use super::{Clock, RATES};
    use crate::{Field, Kind, Request, guesses_all, prove_all};
    use lindstedt_equation::{Expression, Function};
    use rug::Rational;
    use std::collections::BTreeMap;

    fn number(numerator: i64, denominator: i64) -> Expression {
        Expression::Number((numerator, denominator).into())
    }

    /// With numbers in the place of the rates the equations in the time s have the harmonics of those in t.
    #[test]
    fn another_clock_shows_the_same_harmonics() {
        let [x, u] = [0, 1].map(|k| Expression::unknown(k, 0));
        let [y, v] = [0, 1].map(|k| Expression::unknown(k, 1));
        let [a, b] = [0, 1].map(|k| Expression::unknown(k, 2));
        let wave = |angle: Expression| angle.apply(Function::Cos);
        let turn = Expression::parameter("w") * Expression::Time;
        let damping = number(1, 2) * y.clone().apply(Function::Sin);
        let force = number(1, 5) * wave(turn + number(1, 10) * y);
        let single = a.clone() + damping + 2 * x.clone() - force;
        let other = 2 * b + number(1, 2) * v + 2 * u.clone() + u.clone().pow(3) - x;
        for equations in [vec![single.clone()], vec![single - u, other]] {
            let (w, middle) = (Rational::from((7, 5)), Rational::from((13, 10)));
            let ratio = Rational::from(&w / &middle);
            let square = Rational::from(ratio.square_ref()).recip();
            let pairs = [("w", w), (RATES[0], ratio), (RATES[1], square)];
            let values: BTreeMap<_, _> = pairs.map(|(name, q)| (name.to_owned(), q)).into();
            let scaled = Clock { name: "w", middle: &middle }.scaled(&equations).unwrap();
            let kind = Kind::Forced(1);
            let [plain, scaled] = [equations, scaled].map(|equations| {
                let list: Vec<_> = equations.iter().collect();
                let field = Field::of_equations(&list, "eps", &values).unwrap();
                let starts = guesses_all(&field, &kind, &Default::default()).unwrap();
                prove_all(&field, &kind, &starts[0], &Request::default()).unwrap()
            });
            assert!(!plain.frequency.overlaps(&scaled.frequency));
            assert!((1..4).all(|k| plain.harmonic(k).0.overlaps(&scaled.harmonic(k).0)));
            assert!((1..4).all(|k| plain.harmonic(k).1.overlaps(&scaled.harmonic(k).1)));
        }
    }
}
