//! Polynomials in the variables of a field, with coefficients that are trigonometric polynomials of the phase
//! and may be uncertain, and their majorants.

use crate::upward::Up;
use rug::Rational;
use std::collections::BTreeMap;

/// f = sum_h (a_h cos h tau + b_h sin h tau): (a_h, b_h) by h.
pub(crate) type Trigonometric = BTreeMap<u32, (Rational, Rational)>;

/// f(tau) times powers of the variables: x_1..x_N, x_1'..x_N', the functions; missing powers are 0.
#[derive(Clone, Debug)]
pub(crate) struct Term {
    pub(crate) factor: Trigonometric,
    pub(crate) powers: Vec<u32>,
}

/// What is uncertain of a coefficient: a monomial times f(tau), times a number of at most `size`.
#[derive(Clone, Debug)]
pub(crate) struct Spread {
    pub(crate) size: Up,
    pub(crate) powers: Vec<u32>,
    pub(crate) factor: Trigonometric,
}

/// A polynomial in the variables.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polynomial {
    pub(crate) terms: Vec<Term>,
    /// What is uncertain of the coefficients.
    pub(crate) spread: Vec<Spread>,
}

impl Polynomial {
    /// Whether there is no term.
    pub(crate) fn is_zero(&self) -> bool {
        self.terms.is_empty() && self.spread.is_empty()
    }

    /// sum_t |f_t| variables^powers at bounds of the variables, what is uncertain included.
    /// |f| = sum_h (|a_h| + |b_h|) nu^h.
    pub(crate) fn majorant(&self, at: &[Up], nu: Up) -> Up {
        let term = |t: &Term| size(&t.factor, nu) * monomial(&t.powers, at, None);
        self.terms.iter().map(term).sum::<Up>() + self.uncertainty(at, nu)
    }

    /// The same for what is uncertain alone.
    pub(crate) fn uncertainty(&self, at: &[Up], nu: Up) -> Up {
        let term = |s: &Spread| s.bound(nu) * monomial(&s.powers, at, None);
        self.spread.iter().map(term).sum()
    }

    /// A bound of the derivative of the majorant by one variable.
    pub(crate) fn slope(&self, at: &[Up], nu: Up, variable: usize) -> Up {
        let spread = self.spread.iter().map(|s| (s.bound(nu), &s.powers));
        let terms = self.terms.iter().map(|t| (size(&t.factor, nu), &t.powers));
        terms.chain(spread).map(|(size, powers)| size * monomial(powers, at, Some(variable))).sum()
    }

    /// By how much the polynomial can change where each variable changes by so much, up to these bounds.
    pub(crate) fn change(&self, at: &[Up], by: &[Up], nu: Up) -> Up {
        let part = |(v, by): (usize, &Up)| match by.0 {
            0.0 => Up::ZERO,
            _ => *by * self.slope(at, nu, v),
        };
        by.iter().enumerate().map(part).sum()
    }

    /// Whether the sign changes (`true`) where those of the variables and waves do; nothing where it has
    /// no one answer.
    pub(crate) fn sign(
        &self,
        signs: &[Option<bool>],
        wave: &dyn Fn(u32, &Rational, &Rational) -> Option<bool>,
    ) -> Option<bool> {
        let terms = self.terms.iter().map(|t| (&t.powers, &t.factor));
        // The middle of an uncertain coefficient may vanish where the others do not.
        let spread = self.spread.iter().map(|s| (&s.powers, &s.factor));
        let mut found = None;
        for (powers, factor) in terms.chain(spread) {
            let waves = factor.iter().filter(|(_, (a, b))| !a.is_zero() || !b.is_zero());
            if waves.clone().next().is_none() {
                continue;
            }
            let mut sign = false;
            for (v, n) in powers.iter().enumerate().filter(|(_, n)| **n > 0) {
                sign ^= signs[v]? && n % 2 == 1;
            }
            for (h, (a, b)) in waves {
                let sign = sign ^ wave(*h, a, b)?;
                if *found.get_or_insert(sign) != sign {
                    return None;
                }
            }
        }
        Some(found.unwrap_or(false))
    }
}

impl Spread {
    fn bound(&self, nu: Up) -> Up {
        self.size * size(&self.factor, nu)
    }
}

/// |f| = sum_h (|a_h| + |b_h|) nu^h.
fn size(factor: &Trigonometric, nu: Up) -> Up {
    factor.iter().map(|(h, (a, b))| (Up::of(a) + Up::of(b)) * nu.powi(*h)).sum()
}

/// The monomial, or its derivative by a variable.
fn monomial(powers: &[u32], at: &[Up], by: Option<usize>) -> Up {
    if by.is_some_and(|v| powers.get(v).is_none_or(|n| *n == 0)) {
        return Up::ZERO;
    }
    let power = |(v, n): (usize, &u32)| match by {
        Some(by) if by == v => Up(f64::from(*n)) * at[v].powi(n - 1),
        _ => at[v].powi(*n),
    };
    powers.iter().enumerate().filter(|(_, n)| **n > 0).map(power).fold(Up::ONE, |a, b| a * b)
}
