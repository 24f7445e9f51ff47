//! The right side of x'' = g(x, x', t) as a polynomial whose coefficients are trigonometric
//! polynomials of the phase.
//!
//! g = sum_t f_t(tau) x^(i_t) (x')^(j_t), f_t rational and of period 2 pi in tau = omega t. With
//! z = dx/dtau a velocity is omega z: every term is a monomial in (omega, x, z), which is all
//! that the residual, its derivatives and the bounds need.

use crate::upward::Up;
use crate::{Failure, Parity};
use lindstedt_equation::monomials::{Monomial, expand};
use lindstedt_equation::{Expression, Function, Problem};
use rug::{Complete, Integer, Rational};
use std::collections::BTreeMap;
use std::ops::Mul;

/// f = sum_h (a_h cos h tau + b_h sin h tau): (a_h, b_h) by h.
pub(crate) type Trigonometric = BTreeMap<u32, (Rational, Rational)>;

/// f(tau) x^x (x')^velocity.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub(crate) factor: Trigonometric,
    pub(crate) x: u32,
    pub(crate) velocity: u32,
}

/// x'' = g(x, x', t), g a polynomial in x and x' with rational coefficients that may be multiplied by cosines
/// and sines of multiples of one frequency.
#[derive(Clone, Debug)]
pub struct Field {
    pub(crate) terms: Vec<Term>,
    /// The largest frequency of which all the frequencies of the force are multiples.
    pub(crate) force: Option<Rational>,
}

/// What x -> x^n (x')^m are multiplied by: powers of cos and sin of angles q t.
type Waves = BTreeMap<Rational, (Rational, Rational)>;

impl Field {
    /// The field of an equation (= 0) with values for its parameters and for the small parameter,
    /// which goes by the name `small`.
    ///
    /// # Errors
    /// [`Failure::Acceleration`], [`Failure::NoValue`], [`Failure::NotPolynomial`].
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
        let equation = equation.substitute(&value).canonical();
        let unknown = |e: &Expression| matches!(e, Expression::Small | Expression::Parameter(_));
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
        for (monomial, q) in &expanded.terms {
            let waves = waves(monomial, -q.clone(), &expanded.atoms)?;
            let sum = terms.entry((monomial.x, monomial.velocity)).or_default();
            waves.into_iter().for_each(|(angle, (a, b))| add(sum, angle, a, b));
        }
        Ok(Self::collect(terms))
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

    fn collect(terms: BTreeMap<(u32, u32), Waves>) -> Self {
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
        let terms = terms.into_iter().map(term).filter(|t| !t.factor.is_empty()).collect();
        Self { terms, force }
    }

    /// The largest degree in (x, x').
    #[must_use]
    pub fn degree(&self) -> u32 {
        self.terms.iter().map(|t| t.x + t.velocity).max().unwrap_or(0)
    }

    /// Whether no force depends on time.
    #[must_use]
    pub fn is_autonomous(&self) -> bool {
        self.force.is_none()
    }

    /// The field for a period of `periods` periods of the force: harmonics are multiplied.
    pub(crate) fn over(&self, periods: u32) -> Self {
        let mut field = self.clone();
        for term in &mut field.terms {
            let factor = std::mem::take(&mut term.factor);
            term.factor = factor.into_iter().map(|(h, w)| (h.saturating_mul(periods), w)).collect();
        }
        field
    }

    /// Whether x(tau) -> -x(tau + pi) maps solutions to solutions: every term is odd.
    pub(crate) fn is_odd(&self) -> bool {
        let odd = |t: &Term| t.factor.keys().all(|h| (t.x + t.velocity + h) % 2 == 1);
        self.terms.iter().all(odd)
    }

    /// Whether x(tau) -> x(-tau) maps solutions to solutions: even powers of x', cosines.
    pub(crate) fn is_reversible(&self) -> bool {
        let even =
            |t: &Term| t.velocity.is_multiple_of(2) && t.factor.values().all(|(_, b)| b.is_zero());
        self.terms.iter().all(even)
    }

    /// The symmetry that F keeps.
    pub(crate) fn parity(&self, reversible: bool) -> Parity {
        Parity { odd: self.is_odd(), even: reversible && self.is_reversible() }
    }

    /// dg/dx'.
    pub(crate) fn by_velocity(&self) -> Self {
        let terms = self.terms.iter().filter(|t| t.velocity > 0);
        let derivative = |t: &Term| {
            let n = t.velocity;
            let times =
                |(a, b): &(Rational, Rational)| (Rational::from(a * n), Rational::from(b * n));
            let factor = t.factor.iter().map(|(h, wave)| (*h, times(wave))).collect();
            Term { factor, x: t.x, velocity: n - 1 }
        };
        Self { terms: terms.map(derivative).collect(), force: self.force.clone() }
    }

    /// sum_t |f_t| d^p/domega^p d^q/dx^q d^r/dz^r (omega^j x^i z^j) at nonnegative bounds: the
    /// derivative of the majorant polynomial. |f| = sum_h (|a_h| + |b_h|) nu^h.
    pub(crate) fn majorant(&self, at: [Up; 3], nu: Up, derivative: [u32; 3]) -> Up {
        let term = |t: &Term| {
            let size = t.factor.iter();
            let size: Up = size.map(|(h, (a, b))| (Up::of(a) + Up::of(b)) * nu.powi(*h)).sum();
            let exponents = [t.velocity, t.x, t.velocity];
            let factors = (0..3).map(|i| power(at[i], exponents[i], derivative[i]));
            factors.fold(size, Mul::mul)
        };
        self.terms.iter().map(term).sum()
    }
}

/// d^p x^n.
fn power(x: Up, n: u32, p: u32) -> Up {
    if p > n {
        return Up::ZERO;
    }
    let falling = (n - p + 1..=n).fold(Up::ONE, |f, k| f * Up(f64::from(k)));
    falling * x.powi(n - p)
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
    if let Some(key) = monomial.parameters.keys().next() {
        return Err(refused(key));
    }
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
