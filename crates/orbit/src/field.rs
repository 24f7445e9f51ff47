//! The right side of x'' = g(x, x', t) as a polynomial whose coefficients are trigonometric
//! polynomials of the phase.
//!
//! g = sum_t f_t(tau) x^(i_t) (x')^(j_t), f_t rational and of period 2 pi in tau = omega t. With
//! z = dx/dtau a velocity is omega z: every term is a monomial in (omega, x, z), which is all
//! that the residual, its derivatives and the bounds need.

use crate::Parity;
use crate::upward::Up;
use rug::Rational;
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

/// A coefficient known within `size`: an uncertain multiple of x^x (x')^velocity and of waves up to a harmonic.
#[derive(Clone, Debug)]
pub(crate) struct Spread {
    pub(crate) size: Up,
    pub(crate) x: u32,
    pub(crate) velocity: u32,
    pub(crate) harmonic: u32,
}

/// x'' = g(x, x', t), g a polynomial in x and x' with rational coefficients that may be multiplied by cosines
/// and sines of multiples of one frequency.
#[derive(Clone, Debug)]
pub struct Field {
    pub(crate) terms: Vec<Term>,
    /// What is uncertain of the coefficients.
    pub(crate) spread: Vec<Spread>,
    /// The largest frequency of which all the frequencies of the force are multiples.
    pub(crate) force: Option<Rational>,
}

impl Field {
    /// The largest degree in (x, x').
    #[must_use]
    pub fn degree(&self) -> u32 {
        self.terms.iter().map(|t| t.x.saturating_add(t.velocity)).max().unwrap_or(0)
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
        let spread = |s: &Spread| (s.x + s.velocity + s.harmonic) % 2 == 1;
        self.terms.iter().all(odd) && self.spread.iter().all(spread)
    }

    /// Whether x(tau) -> x(-tau) maps solutions to solutions: even powers of x', cosines.
    #[must_use]
    pub fn is_reversible(&self) -> bool {
        let even =
            |t: &Term| t.velocity.is_multiple_of(2) && t.factor.values().all(|(_, b)| b.is_zero());
        self.terms.iter().all(even) && self.spread.iter().all(|s| s.velocity.is_multiple_of(2))
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
        let spread = self.spread.iter().filter(|s| s.velocity > 0).map(|s| {
            let size = s.size * Up(f64::from(s.velocity));
            Spread { size, velocity: s.velocity - 1, ..s.clone() }
        });
        let spread = spread.collect();
        Self { terms: terms.map(derivative).collect(), spread, force: self.force.clone() }
    }

    /// sum_t |f_t| d^p/domega^p d^q/dx^q d^r/dz^r (omega^j x^i z^j) at nonnegative bounds: the
    /// derivative of the majorant polynomial, what is uncertain included. |f| = sum_h (|a_h| + |b_h|) nu^h.
    pub(crate) fn majorant(&self, at: [Up; 3], nu: Up, derivative: [u32; 3]) -> Up {
        let term = |t: &Term| {
            let size = t.factor.iter();
            let size: Up = size.map(|(h, (a, b))| (Up::of(a) + Up::of(b)) * nu.powi(*h)).sum();
            monomial(size, t.x, t.velocity, at, derivative)
        };
        let sum: Up = self.terms.iter().map(term).sum();
        sum + self.uncertainty(at, nu, derivative)
    }

    /// The same for what is uncertain alone.
    pub(crate) fn uncertainty(&self, at: [Up; 3], nu: Up, derivative: [u32; 3]) -> Up {
        let term =
            |s: &Spread| monomial(s.size * nu.powi(s.harmonic), s.x, s.velocity, at, derivative);
        self.spread.iter().map(term).sum()
    }
}

/// size d^p/domega^p d^q/dx^q d^r/dz^r (omega^j x^i z^j).
fn monomial(size: Up, x: u32, velocity: u32, at: [Up; 3], derivative: [u32; 3]) -> Up {
    let exponents = [velocity, x, velocity];
    (0..3).map(|i| power(at[i], exponents[i], derivative[i])).fold(size, Mul::mul)
}

/// d^p x^n.
fn power(x: Up, n: u32, p: u32) -> Up {
    if p > n {
        return Up::ZERO;
    }
    let falling = (n - p + 1..=n).fold(Up::ONE, |f, k| f * Up(f64::from(k)));
    falling * x.powi(n - p)
}
