//! Orbits in the hyperbolic algebra, checked against their equation of motion.

use crate::MelnikovError;
use crate::hyperbolic::{Hyperbolic, HyperbolicRing};
use lindstedt_algebra::{RationalAlgebra, Ring};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;

/// c a^i b^j: how a force coefficient or a scale depends on the two parameters of a potential.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Monomial {
    /// c.
    pub coefficient: Rational,
    /// i.
    pub a: i32,
    /// j.
    pub b: i32,
}

impl Monomial {
    /// (n/d) a^i b^j; a denominator of 0 is read as 1.
    #[must_use]
    pub fn new(n: i32, d: u32, a: i32, b: i32) -> Self {
        Self { coefficient: Rational::from((n, d.max(1))), a, b }
    }
    /// The value at the given parameters, for coefficient and powers as they are.
    #[must_use]
    pub fn ball(&self, balls: Balls, a: &Exact, b: &Exact) -> Option<Ball> {
        let a = balls.powi(&a.ball(balls), i64::from(self.a))?;
        let b = balls.powi(&b.ball(balls), i64::from(self.b))?;
        Some(balls.mul_rational(&balls.mul(&a, &b), &self.coefficient))
    }
    fn mul(&self, other: &Self) -> Self {
        let coefficient = Rational::from(&self.coefficient * &other.coefficient);
        Self { coefficient, a: self.a + other.a, b: self.b + other.b }
    }
    fn recip(&self) -> Option<Self> {
        (!self.coefficient.is_zero()).then(|| Self {
            coefficient: Rational::from(self.coefficient.recip_ref()),
            a: -self.a,
            b: -self.b,
        })
    }
    /// The positive square root, if it is a monomial over Q.
    fn sqrt(&self) -> Option<Self> {
        let (n, d) = (self.coefficient.numer(), self.coefficient.denom());
        let square =
            !self.coefficient.is_negative() && n.is_perfect_square() && d.is_perfect_square();
        (square && self.a % 2 == 0 && self.b % 2 == 0).then(|| Self {
            coefficient: Rational::from((n.clone().sqrt(), d.clone().sqrt())),
            a: self.a / 2,
            b: self.b / 2,
        })
    }
}

/// x(t) = X xi(kappa t) as an orbit of x'' = sum_k f_k x^k.
///
/// The scaling z = kappa t, x = X xi turns the equation into xi'' = sum_k c_k xi^k with
/// c_k = f_k X^(k-1) / kappa^2. An orbit of a whole family has c_k free of the parameters a and b:
/// the relations between kappa, X, a and b are monomials, so this is decided exactly, and the
/// scaled equation is an identity in Q[sech, tanh].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OrbitDescription {
    /// f_k at index k, from the constant force on.
    pub force: Vec<Monomial>,
    /// kappa^2.
    pub rate_squared: Monomial,
    /// X^2; X is its positive root.
    pub amplitude_squared: Monomial,
    /// xi(z).
    pub shape: Hyperbolic,
}

impl OrbitDescription {
    /// The coefficients c_k of the scaled equation xi'' = sum_k c_k xi^k.
    ///
    /// # Errors
    /// [`MelnikovError::NotScaled`] if one depends on the parameters or is irrational.
    pub fn scaled_force(&self) -> Result<Vec<Rational>, MelnikovError> {
        let scale = |power: usize, force: &Monomial| -> Option<Rational> {
            if force.coefficient.is_zero() {
                return Some(Rational::new());
            }
            let mut c = force.mul(&self.rate_squared.recip()?);
            // X^(k-1): whole powers of X^2, and X itself where k is even.
            let exponent = i32::try_from(power).ok()? - 1;
            let square = if exponent < 0 {
                self.amplitude_squared.recip()?
            } else {
                self.amplitude_squared.clone()
            };
            for _ in 0..exponent.unsigned_abs() / 2 {
                c = c.mul(&square);
            }
            if exponent % 2 != 0 {
                c = c.mul(&square.sqrt()?);
            }
            (c.a == 0 && c.b == 0).then_some(c.coefficient)
        };
        let check = |(power, force)| scale(power, force).ok_or(MelnikovError::NotScaled { power });
        self.force.iter().enumerate().map(check).collect()
    }

    /// Checks xi'' = sum_k c_k xi^k in the hyperbolic algebra, exactly.
    ///
    /// # Errors
    /// [`MelnikovError::WrongOrbit`] with the residual, or [`MelnikovError::NotScaled`].
    ///
    /// ```
    /// use lindstedt_melnikov::hyperbolic::Hyperbolic;
    /// use lindstedt_melnikov::{Monomial, OrbitDescription};
    ///
    /// // x'' = a x - b x^3 with x = sqrt(2a/b) sech(sqrt(a) t).
    /// let zero = Monomial::new(0, 1, 0, 0);
    /// let mut orbit = OrbitDescription {
    ///     force: vec![zero.clone(), Monomial::new(1, 1, 1, 0), zero, Monomial::new(-1, 1, 0, 1)],
    ///     rate_squared: Monomial::new(1, 1, 1, 0),
    ///     amplitude_squared: Monomial::new(2, 1, 1, -1),
    ///     shape: Hyperbolic::sech(1),
    /// };
    /// assert!(orbit.check().is_ok());
    /// orbit.shape = Hyperbolic::sech(2);
    /// assert!(orbit.check().is_err());
    /// ```
    pub fn check(&self) -> Result<(), MelnikovError> {
        let ring = HyperbolicRing;
        let force = self.scaled_force()?;
        let mut residual = ring.derivative(&ring.derivative(&self.shape));
        let mut power = ring.one();
        for (k, c) in force.iter().enumerate() {
            if k > 0 {
                power = ring.mul(&power, &self.shape);
            }
            residual = ring.sub(&residual, &ring.scale(&power, c));
        }
        refuse(&residual)
    }
}

fn refuse(residual: &Hyperbolic) -> Result<(), MelnikovError> {
    if HyperbolicRing.is_zero(residual) {
        Ok(())
    } else {
        Err(MelnikovError::WrongOrbit { residual: residual.to_string() })
    }
}

/// Checks that angle velocity v, sine s and cosine c solve x'' = -sin x in z = sqrt(a) t:
/// s' = v c, c' = -v s, v' = -s and s^2 + c^2 = 1.
///
/// # Errors
/// [`MelnikovError::WrongOrbit`] with the first residual that does not vanish.
pub fn check_pendulum(v: &Hyperbolic, s: &Hyperbolic, c: &Hyperbolic) -> Result<(), MelnikovError> {
    let ring = HyperbolicRing;
    refuse(&ring.sub(&ring.derivative(s), &ring.mul(v, c)))?;
    refuse(&ring.add(&ring.derivative(c), &ring.mul(v, s)))?;
    refuse(&ring.add(&ring.derivative(v), s))?;
    let circle = ring.add(&ring.mul(s, s), &ring.mul(c, c));
    refuse(&ring.sub(&circle, &ring.one()))
}

/// Checks that u = x^2 solves u' = 2 u (1 - u) in z = kappa t, which is x' = x (1 - x^2): then
/// x'' = x (1 - x^2)(1 - 3 x^2), the phi^6 oscillator with saddles at 0 and +-1.
///
/// # Errors
/// [`MelnikovError::WrongOrbit`] with the residual.
pub fn check_phi_six(u: &Hyperbolic) -> Result<(), MelnikovError> {
    let ring = HyperbolicRing;
    let right = ring.mul(u, &ring.sub(&ring.one(), u));
    let right = ring.scale(&right, &Rational::from(2));
    refuse(&ring.sub(&ring.derivative(u), &right))
}
