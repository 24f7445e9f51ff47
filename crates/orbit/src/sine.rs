//! x'' + c sin(q x) = 0 is no polynomial, but its orbits are those of one: z = q x swings as
//! z'' + c q sin z = 0, and u = sin(z/2) obeys u'' = -c q ((1 + k^2) u - 2 u^3), k = sin(z(0)/2)
//! ([`Field::pendulum`]).

use crate::read::{half_sine, valued};
use crate::{Failure, Field, Kind, Start};
use lindstedt_equation::{Expression, Function, Operations};
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use rug::ops::Pow;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// x'' + c sin(q x) = 0 with c q > 0, q > 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sine {
    /// c.
    force: Rational,
    /// q.
    rate: Rational,
}

impl Sine {
    /// The sine of an equation (= 0) with values for its parameters and for the small parameter, which goes by
    /// the name `small`; nothing where the equation is another one.
    ///
    /// It may be written with |x| = (x^2)^(1/2) in even functions, as x sin(a |x|)/(a |x|).
    ///
    /// ```
    /// use lindstedt_equation::{Expression, Function};
    /// use lindstedt_orbit::{Request, Sine, prove};
    /// let pendulum = Expression::ACCELERATION + Expression::DISPLACEMENT.apply(Function::Sin);
    /// let sine = Sine::of(&pendulum, "eps", &Default::default()).ok_or("another equation")?;
    /// let (field, kind) = sine.field(&1.into(), 15)?;
    /// let proof = prove(&field, &kind, &sine.start(&1.into()), &Request::default())?;
    /// assert!((proof.period.midpoint().to_f64() - 6.699_975_664_370_45).abs() < 1e-13);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of(
        equation: &Expression,
        small: &str,
        values: &BTreeMap<String, Rational>,
    ) -> Option<Self> {
        let equation = valued(equation, small, values).canonical().acceleration_alone().ok()?;
        let rest = equation
            .substitute(&|e| (*e == Expression::ACCELERATION).then(|| Expression::integer(0)));
        let mut sum: BTreeMap<(i32, Option<Rational>), Rational> = BTreeMap::new();
        for (power, c) in rest.canonical().evaluate(&mut Waves)? {
            let (rate, of_size) = power.wave.map_or((None, false), |(q, s)| (Some(q), s));
            // An even function of |x| is the same function of x.
            if (power.size + i32::from(of_size)) % 2 != 0 {
                return None;
            }
            *sum.entry((power.x.checked_add(power.size)?, rate)).or_default() += c;
        }
        let mut rest = sum.into_iter().filter(|(_, c)| !c.is_zero());
        let (((0, Some(rate)), force), None) = (rest.next()?, rest.next()) else { return None };
        (force > 0).then_some(Self { force, rate })
    }

    /// The field of u and the question for x(0) = `amplitude` at rest, known to so many digits.
    ///
    /// # Errors
    /// [`Failure::NotSwinging`] where q x(0) is not between 0 and pi.
    pub fn field(&self, amplitude: &Rational, digits: u32) -> Result<(Field, Kind), Failure> {
        let stiffness = Rational::from(&self.force * &self.rate);
        Field::pendulum(&stiffness, &Rational::from(amplitude * &self.rate), digits)
    }

    /// The field of u and the question for all swings from x(0) = `amplitude` to that of another sine with the
    /// same stiffness c q.
    ///
    /// # Errors
    /// [`Failure::NotOneNumber`] for another stiffness, [`Failure::NotSwinging`] where q x(0) is not between 0
    /// and pi.
    pub fn between(
        &self,
        amplitude: &Rational,
        to: (&Self, &Rational),
    ) -> Result<(Field, Kind), Failure> {
        let (other, end) = to;
        let stiffness = Rational::from(&self.force * &self.rate);
        if stiffness != Rational::from(&other.force * &other.rate) {
            return Err(Failure::NotOneNumber);
        }
        let balls = Balls::new(128);
        let sine = |a: &Rational, rate: &Rational| half_sine(&Rational::from(a * rate), balls);
        let ends = [sine(amplitude, &self.rate)?, sine(end, &other.rate)?];
        let within = balls.hull(&ends[0], &ends[1]);
        let (field, kind) = Field::swinging(&stiffness, &within, balls)?;
        Ok((field.with_ends(ends, &within), kind))
    }

    /// u in doubles: k cd(t') with t' = sqrt(c q) t, by its Fourier series in the nome.
    ///
    /// k cd = (2 pi/K) sum_n (-1)^n p^(n+1/2)/(1 - p^(2n+1)) cos((2n+1) pi t'/(2K)), p = e^(-pi K'/K)
    /// (Gradshteyn, Ryzhik 8.146), K = pi/(2 agm(1, k')).
    #[must_use]
    pub fn start(&self, amplitude: &Rational) -> Start {
        let (k, other) = (self.rate.to_f64() * amplitude.to_f64() / 2.0).sin_cos();
        let quarter = |modulus: f64| FRAC_PI_2 / agm(1.0, modulus);
        let (whole, nome) = (quarter(other), (-PI * quarter(k) / quarter(other)).exp());
        let mut cosines = Vec::new();
        let mut sign = 1.0;
        while cosines.len() < 2 * MOST_HARMONICS {
            let half = nome.powf(cosines.len() as f64 / 2.0 + 0.5);
            let c = sign * TAU / whole * half / (1.0 - half * half);
            cosines.extend([0.0, c]);
            if c.abs() < f64::EPSILON * k / 16.0 {
                break;
            }
            sign = -sign;
        }
        let rate = (self.force.to_f64() * self.rate.to_f64()).sqrt();
        Start { frequency: FRAC_PI_2 / whole * rate, cosines, sines: Vec::new() }
    }

    /// (x, x') of (u, u'): x = 2 arcsin(u)/q; nothing where u can be 1.
    #[must_use]
    pub fn state(&self, u: &Ball, rate: &Ball) -> Option<(Ball, Ball)> {
        let balls = Balls::new(u.midpoint().prec());
        let cosine = balls.sqrt(&balls.sub(&balls.one(), &balls.mul(u, u)))?;
        let angle = balls.atan(&balls.div(u, &cosine)?);
        let double = Rational::from(2) / &self.rate;
        let velocity = balls.div(rate, &cosine)?;
        Some((balls.mul_rational(&angle, &double), balls.mul_rational(&velocity, &double)))
    }
}

/// x^x |x|^size times sin(q x), or sin(q |x|) where the mark stands.
#[derive(Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Power {
    x: i32,
    size: i32,
    wave: Option<(Rational, bool)>,
}

/// Harmonics of a guess.
const MOST_HARMONICS: usize = 2000;

/// The arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 4.0 * f64::EPSILON * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Sums of such products.
struct Waves;

type Sum = BTreeMap<Power, Rational>;

/// The largest power that is taken.
const MOST_POWER: i32 = 64;

impl Operations for Waves {
    type Value = Sum;

    fn number(&mut self, q: &Rational) -> Option<Sum> {
        let known = (!q.is_zero()).then(|| (Power::default(), q.clone()));
        Some(known.into_iter().collect())
    }

    fn leaf(&mut self, leaf: &Expression) -> Option<Sum> {
        let x = Power { x: 1, ..Power::default() };
        (*leaf == Expression::DISPLACEMENT).then(|| Sum::from([(x, Rational::from(1))]))
    }

    fn add(&mut self, mut a: Sum, b: Sum) -> Option<Sum> {
        b.into_iter().for_each(|(power, c)| *a.entry(power).or_default() += c);
        Some(a)
    }

    fn multiply(&mut self, a: Sum, b: Sum) -> Option<Sum> {
        let mut product = Sum::new();
        for (p, c) in &a {
            for (q, d) in &b {
                let wave = match (&p.wave, &q.wave) {
                    (Some(_), Some(_)) => return None,
                    (one, other) => one.clone().or_else(|| other.clone()),
                };
                let (x, size) = (p.x + q.x, p.size + q.size);
                if x.abs().max(size.abs()) > MOST_POWER {
                    return None;
                }
                *product.entry(Power { x, size, wave }).or_default() += Rational::from(c * d);
            }
        }
        Some(product)
    }

    fn power(&mut self, base: &Expression, exponent: &Expression) -> Option<Sum> {
        let (base, n) = (base.evaluate(self)?, exponent.as_number()?);
        let mut terms = base.into_iter();
        let (Some((Power { x, size, wave: None }, c)), None) = (terms.next(), terms.next()) else {
            return None;
        };
        let times = |power: i32| {
            let product = Rational::from(&n * power);
            let whole = product.denom() == &1;
            product.numer().to_i32().filter(|p| whole && p.abs() <= MOST_POWER)
        };
        let power = if *n.denom() == 1 {
            let whole = n.numer().to_i32().filter(|n| n.abs() <= MOST_POWER && !c.is_zero())?;
            return Some(Sum::from([(
                Power { x: times(x)?, size: times(size)?, wave: None },
                c.pow(whole),
            )]));
        } else {
            // A root of an even power is one of |x|.
            Power { x: 0, size: times(x)?.checked_add(times(size)?)?, wave: None }
        };
        (c == 1 && x % 2 == 0).then(|| Sum::from([(power, Rational::from(1))]))
    }

    fn function(&mut self, function: Function, argument: &Expression) -> Option<Sum> {
        let mut terms = argument.evaluate(self)?.into_iter();
        let (Some((power, rate)), None) = (terms.next(), terms.next()) else { return None };
        let of_size = match power {
            Power { x: 1, size: 0, wave: None } => false,
            Power { x: 0, size: 1, wave: None } => true,
            _ => return None,
        };
        let sign = if rate < 0 { -1 } else { 1 };
        let wave = Some((rate.abs(), of_size));
        let known = function == Function::Sin;
        known.then(|| Sum::from([(Power { wave, ..Power::default() }, Rational::from(sign))]))
    }
}
