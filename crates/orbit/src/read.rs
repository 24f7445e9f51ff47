//! From equations to a field: values put in, multiplied out, forces as waves, functions of the unknowns
//! gathered.

use crate::Failure;
use crate::field::{Field, Function as Named, Varying};
use crate::operation::Operation;
use crate::polynomial::{Polynomial, Spread, Term};
use crate::reader::Reader;
use crate::sum::{By, Key, Sum};
use crate::upward::Up;
use lindstedt_algebra::common_measure;
use lindstedt_equation::{AccelerationFault, Expression, Problem};
use lindstedt_number::ball::{Ball, Balls};
use rug::ops::Pow;
use rug::{Complete, Rational};
use std::collections::BTreeMap;

/// The largest degree in the variables and the largest harmonic of a force: more would only fill memory.
const MOST_DEGREE: u32 = 64;
const MOST_HARMONIC: u32 = 10_000;

impl Field {
    /// The field of an equation (= 0) with values for its parameters and for the small parameter,
    /// which goes by the name `small`.
    ///
    /// # Errors
    /// [`Failure::Acceleration`], [`Failure::NoValue`], [`Failure::NotPolynomial`],
    /// [`Failure::NotSmooth`], and those of what is too large.
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// use lindstedt_orbit::Field;
    /// use std::collections::BTreeMap;
    /// let x = Expression::DISPLACEMENT;
    /// let duffing = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
    /// let values = BTreeMap::from([("eps".to_owned(), (1, 2).into())]);
    /// assert_eq!(Field::new(&duffing, "eps", &values)?.degree(), 3);
    /// # Ok::<(), lindstedt_orbit::Failure>(())
    /// ```
    pub fn new(
        equation: &Expression,
        small: &str,
        values: &BTreeMap<String, Rational>,
    ) -> Result<Self, Failure> {
        Self::of_equations(&[equation], small, values)
    }

    /// The field of several equations (= 0), as many as unknowns, of which each x_i'' has constant factors.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// use lindstedt_orbit::Field;
    /// // x_1'' + 2 x_1 - x_2 = 0, x_2'' + 2 x_2 - x_1 = 0.
    /// let equation = |i: usize| {
    ///     let [x, other] = [i, 1 - i].map(|k| Expression::unknown(k, 0));
    ///     Expression::unknown(i, 2) + 2 * x - other
    /// };
    /// let field = Field::of_equations(&[&equation(0), &equation(1)], "eps", &Default::default())?;
    /// assert_eq!((field.unknowns(), field.degree()), (2, 1));
    /// # Ok::<(), lindstedt_orbit::Failure>(())
    /// ```
    pub fn of_equations(
        equations: &[&Expression],
        small: &str,
        values: &BTreeMap<String, Rational>,
    ) -> Result<Self, Failure> {
        let equations: Vec<_> = equations.iter().map(|e| valued(e, small, values)).collect();
        read(&equations, small, &BTreeMap::new(), Balls::new(64), None)
    }

    /// The field of an equation with parameters that are known within balls: what is proved holds for
    /// all numbers in them.
    ///
    /// # Errors
    /// As [`Self::new`].
    ///
    /// ```
    /// use lindstedt_equation::Expression;
    /// use lindstedt_number::ball::Balls;
    /// use lindstedt_orbit::Field;
    /// use std::collections::BTreeMap;
    /// let stiff = Expression::parameter("k") * Expression::DISPLACEMENT;
    /// let values = BTreeMap::from([("k".to_owned(), Balls::new(200).pi())]);
    /// let field = Field::within(&(Expression::ACCELERATION + stiff), "eps", &values, 200)?;
    /// assert_eq!(field.degree(), 1);
    /// # Ok::<(), lindstedt_orbit::Failure>(())
    /// ```
    pub fn within(
        equation: &Expression,
        small: &str,
        values: &BTreeMap<String, Ball>,
        bits: u32,
    ) -> Result<Self, Failure> {
        let named =
            |e: &Expression| (*e == Expression::Small).then(|| Expression::parameter(small));
        read(&[equation.substitute(&named)], small, values, Balls::new(bits), None)
    }

    /// The same of several equations, the small parameter a parameter, and with how the field depends on the one
    /// named.
    pub(crate) fn varying(
        equations: &[Expression],
        small: &str,
        (name, within): (&str, &Ball),
        balls: Balls,
    ) -> Result<Self, Failure> {
        let values = BTreeMap::from([(name.to_owned(), within.clone())]);
        read(equations, small, &values, balls, Some(name))
    }

    /// The field of a problem, its time-domain form where it has one.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_problem(
        problem: &Problem,
        values: &BTreeMap<String, Rational>,
    ) -> Result<Self, Failure> {
        Self::of_equations(&in_time(problem), &problem.small, values)
    }

    /// x'' + kappa sin x = 0 with x(0) = a, 0 < a < pi, by u = sin(x/2): u'' = -kappa (1 + k^2) u + 2 kappa u^3
    /// with u(0) = k = sin(a/2), from u'^2 = kappa (1 - u^2)(k^2 - u^2). The orbit of u has the period of
    /// the pendulum, x = 2 arcsin u. k is irrational: it is known within a ball of about
    /// 10^-(digits + 15). Returns the field and the question.
    ///
    /// # Errors
    /// [`Failure::NotSwinging`] for an amplitude that is not between 0 and pi.
    pub fn pendulum(
        kappa: &Rational,
        amplitude: &Rational,
        digits: u32,
    ) -> Result<(Self, crate::Kind), Failure> {
        let bits = (f64::from(digits + 15) * std::f64::consts::LOG2_10) as u32 + 8;
        let balls = Balls::new(bits);
        Self::swinging(kappa, &half_sine(amplitude, balls)?, balls)
    }

    /// The same for all k within a ball.
    pub(crate) fn swinging(
        kappa: &Rational,
        k: &Ball,
        balls: Balls,
    ) -> Result<(Self, crate::Kind), Failure> {
        let u = Expression::DISPLACEMENT;
        let number = |q: Rational| Expression::Number(q);
        let linear = Expression::parameter("k").pow(2) * u.clone() + u.clone();
        let cubic = number(-2 * kappa.clone()) * u.pow(3);
        let equation = Expression::ACCELERATION + number(kappa.clone()) * linear + cubic;
        let field = Self::varying(&[equation], "eps", ("k", k), balls)?;
        let (value, error) = parts(k).ok_or(Failure::NoStart)?;
        let error = Rational::from_f64(error.0).unwrap_or_default();
        Ok((field, crate::Kind::InitialWithin { value, error }))
    }
}

/// sin(a/2) for 0 < a < pi.
pub(crate) fn half_sine(angle: &Rational, balls: Balls) -> Result<Ball, Failure> {
    let angle = balls.from_rational(angle);
    if !angle.is_positive() || !balls.sub(&balls.pi(), &angle).is_positive() {
        return Err(Failure::NotSwinging);
    }
    Ok(balls.sin(&balls.mul_power_of_two(&angle, -1)))
}

/// An equation with the values of the small parameter and of others.
pub(crate) fn valued(
    equation: &Expression,
    small: &str,
    values: &BTreeMap<String, Rational>,
) -> Expression {
    let order = values.get(small).cloned().map(Expression::Number);
    let value = |e: &Expression| order.clone().filter(|_| *e == Expression::Small);
    equation.substitute(&value).with_values(values)
}

/// The equations of a problem, the one in time where there is one.
pub(crate) fn in_time(problem: &Problem) -> Vec<&Expression> {
    let mut equations: Vec<&Expression> = problem.equations().collect();
    if let (Some(equation), [first]) = (&problem.time_domain, &mut equations[..]) {
        *first = equation;
    }
    equations
}

fn read(
    equations: &[Expression],
    small: &str,
    values: &BTreeMap<String, Ball>,
    balls: Balls,
    varies: Option<&str>,
) -> Result<Field, Failure> {
    let unknown = |e: &Expression| match e {
        Expression::Parameter(name) => !values.contains_key(name),
        e => *e == Expression::Small,
    };
    let equations: Vec<_> = equations.iter().map(Expression::canonical).collect();
    match equations.iter().find_map(|e| e.find(&unknown)) {
        Some(Expression::Parameter(name)) => return Err(Failure::NoValue(name.clone())),
        Some(_) => return Err(Failure::NoValue(small.to_owned())),
        None => {}
    }
    let mut reader = Reader::new(equations.len());
    let forces = match &equations[..] {
        [equation] => {
            let alone = equation.acceleration_alone().map_err(Failure::Acceleration)?;
            let rest = reader.rest(&alone, &[])?;
            vec![rest.scaled(&Rational::from(-1))]
        }
        several => accelerations(several, &mut reader)?,
    };
    let force = measure(&forces, &reader.functions);
    let collector = Collector { force, values, balls, varies };
    collector.field(&forces, &reader.functions)
}

/// x_i'' from M x'' + rest = 0 with a rational matrix M.
fn accelerations(equations: &[Expression], reader: &mut Reader) -> Result<Vec<Sum>, Failure> {
    let n = equations.len();
    let mut rows: Vec<(Vec<Rational>, Sum)> = Vec::new();
    for equation in equations {
        let rest = reader.rest(equation, &[])?;
        let minus = rest.scaled(&Rational::from(-1));
        let mut masses = Vec::new();
        for k in 0..n {
            let inside = || Failure::Acceleration(AccelerationFault::Inside(equation.clone()));
            let mut mass = |at: i64| -> Result<Rational, Failure> {
                let mut accelerations = vec![0; k + 1];
                accelerations[k] = at;
                let rest = reader.rest(equation, &accelerations)?;
                rest.plus(&minus).as_number().ok_or_else(inside)
            };
            let one = mass(1)?;
            // Linear: twice the acceleration gives twice the force.
            if mass(2)? != Rational::from(2 * &one) {
                return Err(inside());
            }
            masses.push(one);
        }
        rows.push((masses, minus));
    }
    // Gauss and Jordan.
    for k in 0..n {
        let missing = || Failure::Acceleration(AccelerationFault::Missing);
        let pivot = (k..n).find(|i| !rows[*i].0[k].is_zero()).ok_or_else(missing)?;
        rows.swap(k, pivot);
        let factor = Rational::from(rows[k].0[k].recip_ref());
        rows[k].0.iter_mut().for_each(|m| *m *= &factor);
        rows[k].1 = rows[k].1.scaled(&factor);
        let (masses, force) = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = Rational::from(-&row.0[k]);
            row.0.iter_mut().zip(&masses).for_each(|(m, other)| *m += (&factor * other).complete());
            row.1 = row.1.clone().plus(&force.scaled(&factor));
        }
    }
    Ok(rows.into_iter().map(|(_, force)| force).collect())
}

/// The largest frequency of which all frequencies are multiples.
fn measure(forces: &[Sum], functions: &[(Operation, Sum)]) -> Option<Rational> {
    let sums = forces.iter().chain(functions.iter().map(|(_, argument)| argument));
    let waves = sums.flat_map(|sum| sum.0.values());
    let angles = waves.flat_map(|waves| waves.keys().cloned()).filter(|q| !q.is_zero());
    angles.reduce(|a, b| common_measure(&a, &b))
}

/// From sums to polynomials: harmonics of one frequency, balls in the place of parameters.
struct Collector<'a> {
    force: Option<Rational>,
    values: &'a BTreeMap<String, Ball>,
    balls: Balls,
    varies: Option<&'a str>,
}

impl Collector<'_> {
    fn field(self, forces: &[Sum], functions: &[(Operation, Sum)]) -> Result<Field, Failure> {
        let n = forces.len();
        let too_large = || Failure::TooManyTerms;
        let by =
            |sum: &Sum, v: usize| sum.by(By::Variable(v), 2 * n, functions).ok_or_else(too_large);
        let varying = self.varying(forces, functions)?;
        let (mut first, mut second, mut flow) = (Vec::new(), Vec::new(), Vec::new());
        for (i, g) in forces.iter().enumerate() {
            let row = (0..2 * n).map(|v| by(g, v)).collect::<Result<Vec<_>, _>>()?;
            let mut sum = Sum::default();
            for (v, derivative) in row.iter().enumerate() {
                if v >= n {
                    let part = derivative.times(&Sum::variable(v)).ok_or_else(too_large)?;
                    sum = sum.plus(&part);
                }
                for w in v..2 * n {
                    let twice = by(derivative, w)?;
                    if !twice.0.is_empty() {
                        second.push((i, [v, w], self.polynomial(&twice)?));
                    }
                }
            }
            first.push(row.iter().map(|p| self.polynomial(p)).collect::<Result<_, _>>()?);
            flow.push(self.polynomial(&sum)?);
        }
        let named = |(kind, argument): &(Operation, Sum)| {
            Ok(Named { kind: *kind, argument: self.polynomial(argument)? })
        };
        let functions = functions.iter().map(named).collect::<Result<_, _>>()?;
        let forces = forces.iter().map(|g| self.polynomial(g)).collect::<Result<_, _>>()?;
        let field = Field { forces, first, second, flow, functions, force: self.force, varying };
        let terms = field.forces.iter().flat_map(|g| &g.terms);
        let harmonic = terms.filter_map(|t| t.factor.keys().max()).max().copied().unwrap_or(0);
        let degree = field.degree();
        if degree > MOST_DEGREE {
            return Err(Failure::Degree { degree, most: MOST_DEGREE });
        }
        if harmonic > MOST_HARMONIC {
            return Err(Failure::Harmonic { harmonic, most: MOST_HARMONIC });
        }
        Ok(field)
    }

    /// The derivatives by s, p = p_0 + s r with the radius r of the ball of the parameter that varies.
    fn varying(
        &self,
        forces: &[Sum],
        functions: &[(Operation, Sum)],
    ) -> Result<Option<Varying>, Failure> {
        let ball = self.varies.and_then(|name| Some((name, self.values.get(name)?)));
        let Some((name, half)) = ball.and_then(|(name, b)| Some((name, parts(b)?.1))) else {
            return Ok(None);
        };
        let (n, half) = (forces.len(), Rational::from_f64(half.0).unwrap_or_default());
        let too_large = || Failure::TooManyTerms;
        let by = |sum: &Sum, by: By<'_>| sum.by(by, 2 * n, functions).ok_or_else(too_large);
        let along = |sum: &Sum| Ok(by(sum, By::Parameter(name))?.scaled(&half));
        let slopes = forces.iter().map(along).collect::<Result<Vec<_>, Failure>>()?;
        let polynomials = |list: &[Sum]| -> Result<Vec<_>, Failure> {
            list.iter().map(|sum| self.polynomial(sum)).collect()
        };
        let mixed = |slope: &Sum| {
            let row = (0..2 * n).map(|v| by(slope, By::Variable(v)));
            polynomials(&row.collect::<Result<Vec<_>, _>>()?)
        };
        let bends = slopes.iter().map(along).collect::<Result<Vec<_>, Failure>>()?;
        Ok(Some(Varying {
            forces: polynomials(&slopes)?,
            first: slopes.iter().map(mixed).collect::<Result<_, _>>()?,
            second: polynomials(&bends)?,
            from: -1.0,
            // Nothing is known of the ends.
            slack: Up(2.0),
        }))
    }

    fn polynomial(&self, sum: &Sum) -> Result<Polynomial, Failure> {
        let mut polynomial = Polynomial::default();
        for (key, waves) in &sum.0 {
            let (middle, radius) = self.parameters(key)?;
            let harmonic = |q: &Rational| match &self.force {
                Some(base) => Rational::from(q / base).numer().to_u32().unwrap_or(u32::MAX),
                None => 0,
            };
            let scaled = |(q, (a, b)): (&Rational, &(Rational, Rational))| {
                (harmonic(q), (Rational::from(a * &middle), Rational::from(b * &middle)))
            };
            let factor = waves.iter().map(scaled).collect();
            polynomial.terms.push(Term { factor, powers: key.powers.clone() });
            if radius != Up::ZERO {
                let factor = waves.iter().map(|(q, wave)| (harmonic(q), wave.clone())).collect();
                let (size, powers) = (radius, key.powers.clone());
                polynomial.spread.push(Spread { size, powers, factor });
            }
        }
        Ok(polynomial)
    }

    /// The product of the powers of the parameters and what is uncertain of it; of the one that varies at the
    /// middle of its ball.
    fn parameters(&self, key: &Key) -> Result<(Rational, Up), Failure> {
        if key.parameters.is_empty() {
            return Ok((Rational::from(1), Up::ZERO));
        }
        let mut product = self.balls.one();
        for (name, n) in &key.parameters {
            let value = self.values.get(name).and_then(|v| self.balls.powi(v, i64::from(*n)));
            let value = value.ok_or_else(|| Failure::NoValue(name.clone()))?;
            product = self.balls.mul(&product, &value);
        }
        let name = || key.parameters.keys().next().cloned().unwrap_or_default();
        let (middle, radius) = parts(&product).ok_or_else(|| Failure::NoValue(name()))?;
        let varies = self.varies.and_then(|v| Some((self.values.get(v)?, key.parameters.get(v)?)));
        let of_middle = varies.filter(|_| key.parameters.len() == 1).and_then(|(ball, n)| {
            let (p, _) = parts(ball)?;
            (!p.is_zero() || *n > 0).then(|| p.pow(*n))
        });
        Ok(match of_middle {
            None => (middle, radius),
            Some(exact) => {
                let off = Up::of(&Rational::from(&exact - &middle));
                (exact, radius + off)
            }
        })
    }
}

/// The midpoint and the radius of a ball.
pub(crate) fn parts(ball: &Ball) -> Option<(Rational, Up)> {
    let radius = ball.is_finite().then(|| Up::of_float(ball.radius()))?;
    Some((ball.midpoint().to_rational()?, radius))
}
