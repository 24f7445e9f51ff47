//! From the equation to the polynomial: values put in, multiplied out, forces as waves.

use crate::Failure;
use crate::field::{Field, Spread, Term};
use crate::upward::Up;
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Complete, Integer, Rational};
use std::collections::BTreeMap;

/// The largest degree in (x, x') and the largest harmonic of a force: more would only fill memory.
const MOST_DEGREE: u32 = 64;
const MOST_HARMONIC: u32 = 10_000;

/// What x^n (x')^m is multiplied by: a cos q t + b sin q t by q.
type Waves = BTreeMap<Rational, (Rational, Rational)>;

impl Field {
    /// The field of an equation (= 0) with values for its parameters and for the small parameter,
    /// which goes by the name `small`.
    ///
    /// # Errors
    /// [`Failure::Acceleration`], [`Failure::NoValue`], [`Failure::NotPolynomial`],
    /// [`Failure::TooLarge`].
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
        let value = |e: &Expression| match e {
            Expression::Small => values.get(small).cloned().map(Expression::Number),
            Expression::Parameter(name) => values.get(name).cloned().map(Expression::Number),
            _ => None,
        };
        Self::read(&equation.substitute(&value), small, &BTreeMap::new(), Balls::new(64))
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
        Self::read(&equation.substitute(&named), small, values, Balls::new(bits))
    }

    /// The field of a problem, its time-domain form where it has one.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_problem(
        problem: &Problem,
        values: &BTreeMap<String, Rational>,
    ) -> Result<Self, Failure> {
        let equation = problem.time_domain.as_ref().unwrap_or(&problem.equation);
        Self::new(equation, &problem.small, values)
    }

    fn read(
        equation: &Expression,
        small: &str,
        values: &BTreeMap<String, Ball>,
        balls: Balls,
    ) -> Result<Self, Failure> {
        let equation = equation.canonical();
        let unknown = |e: &Expression| match e {
            Expression::Parameter(name) => !values.contains_key(name),
            e => *e == Expression::Small,
        };
        match equation.find(&unknown) {
            Some(Expression::Parameter(name)) => return Err(Failure::NoValue(name.clone())),
            Some(_) => return Err(Failure::NoValue(small.to_owned())),
            None => {}
        }
        let alone = equation.acceleration_alone().map_err(Failure::Acceleration)?;
        let rest =
            alone.substitute(&|e| (*e == Expression::ACCELERATION).then(|| Expression::integer(0)));
        let refused = || Failure::NotPolynomial(rest.clone());
        let expanded = expand(&rest).ok_or_else(refused)?;
        let mut terms: BTreeMap<(u32, u32), Waves> = BTreeMap::new();
        let mut spread = Vec::new();
        for (monomial, q) in &expanded.terms {
            let (middle, radius) = factor(monomial, q, values, balls).ok_or_else(refused)?;
            let waves = waves(monomial, -middle, &expanded.atoms)?;
            let fastest = waves.keys().max().cloned().unwrap_or_default();
            spread.push((radius, monomial.x, monomial.velocity, fastest));
            let sum = terms.entry((monomial.x, monomial.velocity)).or_default();
            waves.into_iter().for_each(|(angle, (a, b))| add(sum, angle, a, b));
        }
        Self::collect(terms, spread)
    }

    fn collect(
        terms: BTreeMap<(u32, u32), Waves>,
        spread: Vec<(Up, u32, u32, Rational)>,
    ) -> Result<Self, Failure> {
        let angles = terms.values().flat_map(BTreeMap::keys).filter(|q| !q.is_zero());
        let force = angles.cloned().reduce(|a, b| common_measure(&a, &b));
        let harmonic = |angle: Rational| match &force {
            Some(base) => (angle / base).numer().to_u32().unwrap_or(u32::MAX),
            None => 0,
        };
        let term = |((x, velocity), waves): (_, Waves)| {
            let nonzero = waves.into_iter().filter(|(_, (a, b))| !(a.is_zero() && b.is_zero()));
            let factor = nonzero.map(|(angle, wave)| (harmonic(angle), wave)).collect();
            Term { factor, x, velocity }
        };
        let terms = terms.into_iter().map(term).filter(|t| !t.factor.is_empty());
        let terms: Vec<Term> = terms.collect();
        let uncertain = spread.into_iter().filter(|(size, ..)| *size != Up::ZERO);
        let uncertain = uncertain.map(|(size, x, velocity, fastest)| Spread {
            size,
            x,
            velocity,
            harmonic: harmonic(fastest),
        });
        let field = Self { terms, spread: uncertain.collect(), force };
        let harmonics = field.terms.iter().filter_map(|t| t.factor.keys().max());
        let harmonic = harmonics.max().copied().unwrap_or(0);
        let degree = field.degree();
        if degree > MOST_DEGREE || harmonic > MOST_HARMONIC {
            return Err(Failure::TooLarge { degree, harmonic });
        }
        Ok(field)
    }

    /// x'' + kappa sin x = 0 with x(0) = a, 0 < a < pi, by u = sin(x/2): u'' = -kappa (1 + k^2) u + 2 kappa u^3
    /// with u(0) = k = sin(a/2), from u'^2 = kappa (1 - u^2)(k^2 - u^2). The orbit of u has the period of
    /// the pendulum, x = 2 arcsin u. k is irrational: it is known within a ball of about
    /// 10^-(digits + 15). Returns the field and the question.
    ///
    /// # Errors
    /// [`Failure::NoStart`] for an amplitude that is not between 0 and pi.
    pub fn pendulum(
        kappa: &Rational,
        amplitude: &Rational,
        digits: u32,
    ) -> Result<(Self, crate::Kind), Failure> {
        let bits = (f64::from(digits + 15) * std::f64::consts::LOG2_10) as u32 + 8;
        let balls = Balls::new(bits);
        Self::swinging(kappa, &balls.from_rational(amplitude), balls)
    }

    /// The same for all amplitudes within a ball.
    pub(crate) fn swinging(
        kappa: &Rational,
        angle: &Ball,
        balls: Balls,
    ) -> Result<(Self, crate::Kind), Failure> {
        if !angle.is_positive() || !balls.sub(&balls.pi(), angle).is_positive() {
            return Err(Failure::NoStart);
        }
        let half = balls.mul_power_of_two(angle, -1);
        let k = balls.sin(&half);
        let u = Expression::DISPLACEMENT;
        let number = |q: Rational| Expression::Number(q);
        let linear = Expression::parameter("k").pow(2) * u.clone() + u.clone();
        let cubic = number(-2 * kappa.clone()) * u.pow(3);
        let equation = Expression::ACCELERATION + number(kappa.clone()) * linear + cubic;
        let values = BTreeMap::from([("k".to_owned(), k.clone())]);
        let field = Self::within(&equation, "eps", &values, balls.bits())?;
        let (value, error) = parts(&k).ok_or(Failure::NoStart)?;
        let error = Rational::from_f64(error.0).unwrap_or_default();
        Ok((field, crate::Kind::InitialWithin { value, error }))
    }
}

/// The midpoint and the radius of a ball.
fn parts(ball: &Ball) -> Option<(Rational, Up)> {
    let radius = ball.is_finite().then(|| Up::of_float(ball.radius()))?;
    Some((ball.midpoint().to_rational()?, radius))
}

/// q times the powers of the parameters of a monomial: exactly where there are none.
fn factor(
    monomial: &Monomial,
    q: &Rational,
    values: &BTreeMap<String, Ball>,
    balls: Balls,
) -> Option<(Rational, Up)> {
    if monomial.parameters.is_empty() {
        return Some((q.clone(), Up::ZERO));
    }
    let mut product = balls.from_rational(q);
    for (name, n) in &monomial.parameters {
        product = balls.mul(&product, &balls.powi(values.get(name)?, i64::from(*n))?);
    }
    parts(&product)
}

/// The largest q of which a and b are integer multiples: gcd of numerators over lcm of
/// denominators.
fn common_measure(a: &Rational, b: &Rational) -> Rational {
    let numerator = Integer::from(a.numer() * b.denom()).gcd(&Integer::from(b.numer() * a.denom()));
    Rational::from((numerator, (a.denom() * b.denom()).complete()))
}

fn add(sum: &mut Waves, angle: Rational, a: Rational, b: Rational) {
    // cos and sin of a negative angle.
    let (angle, b) = if angle < 0 { (-angle, -b) } else { (angle, b) };
    let b = if angle.is_zero() { Rational::new() } else { b };
    let entry = sum.entry(angle).or_default();
    entry.0 += a;
    entry.1 += b;
}

/// q times the atoms of a monomial as a sum of a cos(angle t) + b sin(angle t).
fn waves(
    monomial: &Monomial,
    q: Rational,
    atoms: &BTreeMap<String, Expression>,
) -> Result<Waves, Failure> {
    let mut product = Waves::from([(Rational::new(), (q, Rational::new()))]);
    let refused = |key: &String| {
        Failure::NotPolynomial(atoms.get(key).cloned().unwrap_or(Expression::parameter(key)))
    };
    for (key, n) in &monomial.atoms {
        let wave = atoms.get(key).and_then(wave).ok_or_else(|| refused(key))?;
        for _ in 0..*n {
            product = times(&product, &wave);
        }
    }
    Ok(product)
}

/// cos(q t) or sin(q t): (q, whether it is the sine).
fn wave(e: &Expression) -> Option<(Rational, bool)> {
    let Expression::Function(function @ (Function::Cos | Function::Sin), angle) = e else {
        return None;
    };
    let one = angle.substitute(&|e| (*e == Expression::Time).then(|| Expression::integer(1)));
    let none = angle.substitute(&|e| (*e == Expression::Time).then(|| Expression::integer(0)));
    let rate = one.as_number()?;
    // Only q t: no phase, no power of t.
    let linear = Expression::Product(vec![Expression::Number(rate.clone()), Expression::Time]);
    let same = angle.multiplied_out()? == linear.multiplied_out()? || rate.is_zero();
    (none.as_number()? == 0 && same && !rate.is_zero())
        .then_some((rate, *function == Function::Sin))
}

/// A sum of waves times cos(q t) or sin(q t).
fn times(sum: &Waves, (q, sine): &(Rational, bool)) -> Waves {
    let mut product = Waves::new();
    for (p, (a, b)) in sum {
        let half = |q: &Rational| Rational::from(q / 2);
        let (a, b) = (half(a), half(b));
        let (plus, minus) = ((p + q).complete(), (p - q).complete());
        if *sine {
            // 2 cos p sin q = sin(p+q) - sin(p-q), 2 sin p sin q = cos(p-q) - cos(p+q).
            add(&mut product, plus, -b.clone(), a.clone());
            add(&mut product, minus, b, -a);
        } else {
            add(&mut product, plus, a.clone(), b.clone());
            add(&mut product, minus, a, b);
        }
    }
    product
}
