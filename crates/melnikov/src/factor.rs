//! Perturbations that depend on x: factors g(x), and the terms c g(x) x'^j of friction.

use crate::{LARGEST_DEGREE, MelnikovError};
use lindstedt_number::Exact;
use rug::ops::Pow;
use rug::{Float, Rational};

/// The largest power of x in a factor.
pub const LARGEST_POWER: usize = 100;

/// A factor g(x) of a force or of friction.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Factor {
    /// x^n; 1 for n = 0.
    Power(u32),
    /// sin(k x).
    Sine(Rational),
    /// cos(k x).
    Cosine(Rational),
}

impl Factor {
    /// g = 1.
    pub const ONE: Self = Self::Power(0);

    /// The sign p in g(-x) = p g(x).
    #[must_use]
    pub fn parity(&self) -> i64 {
        match self {
            Self::Power(n) if n % 2 == 1 => -1,
            Self::Sine(_) => -1,
            _ => 1,
        }
    }

    /// g(x) at the precision of x.
    #[must_use]
    pub fn value(&self, x: &Float) -> Float {
        let angle = |k: &Rational| Float::with_val(x.prec(), x * k);
        match self {
            Self::Power(n) => Float::with_val(x.prec(), x.pow(*n)),
            Self::Sine(k) => angle(k).sin(),
            Self::Cosine(k) => angle(k).cos(),
        }
    }

    /// No power beyond [`LARGEST_POWER`].
    ///
    /// # Errors
    /// [`MelnikovError::DegreeTooLarge`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        match self {
            Self::Power(n) => within(*n, LARGEST_POWER),
            Self::Sine(_) | Self::Cosine(_) => Ok(()),
        }
    }
}

fn within(degree: u32, limit: usize) -> Result<(), MelnikovError> {
    let degree = degree as usize;
    if degree > limit { Err(MelnikovError::DegreeTooLarge { degree, limit }) } else { Ok(()) }
}

/// The term c g(x) x'^j of friction: the force on the mass is -eps c g(x) x'^j.
///
/// ```
/// use lindstedt_melnikov::{Branch, Damping, Factor, Forcing, Friction, PolynomialFriction, Potential, System};
/// use lindstedt_number::{Exact, ball::Balls, digits::decimal};
///
/// // x'' = x - x^3 - eps x^2 x': int x^2 x'^2 dt = 16/15 on a loop.
/// let none = PolynomialFriction { dry: Exact::from(0), coefficients: Vec::new() };
/// let well = Potential::DoubleWell { a: Exact::from(1), b: Exact::from(1) };
/// let system = System::new(well, Friction::Polynomial(none), Forcing::none(), Exact::from(0))?;
/// let term = Damping { factor: Factor::Power(2), velocity: 1, coefficient: Exact::from(1) };
/// let (work, _) = system.damped(vec![term])?.dissipation(Balls::new(100), Branch::Positive)?;
/// assert_eq!(decimal(&work, 12).as_deref(), Some("1.06666666667"));
/// # Ok::<(), lindstedt_melnikov::MelnikovError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damping {
    /// g.
    pub factor: Factor,
    /// j.
    pub velocity: u32,
    /// c.
    pub coefficient: Exact,
}

impl Damping {
    /// No power of x beyond [`LARGEST_POWER`], of x' beyond [`LARGEST_DEGREE`].
    ///
    /// # Errors
    /// [`MelnikovError::DegreeTooLarge`].
    pub fn check(&self) -> Result<(), MelnikovError> {
        within(self.velocity, LARGEST_DEGREE)?;
        self.factor.check()
    }
}
