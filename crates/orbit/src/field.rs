//! The right sides of x_i'' = g_i(x, x', t) as polynomials in the unknowns, their velocities and functions
//! of these, with coefficients that are trigonometric polynomials of the phase.
//!
//! With z = dx/dtau a velocity is omega z: every term is a monomial in omega, x, z and the functions, which
//! is all that the residual, its derivatives and the bounds need. Functions (sines, exponentials, roots)
//! are elements of the same algebra, computed and enclosed where the orbit is known
//! ([`crate::function`]); their derivatives are polynomials in functions again, so that no further
//! unknowns, and no constraints that tie them, are needed.

use crate::operation::Operation;
use crate::polynomial::{Polynomial, Term};
use crate::space::Signs;
use crate::upward::Up;
use lindstedt_algebra::common_measure;
use rug::Rational;

/// A function of a polynomial in the variables before it.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) kind: Operation,
    pub(crate) argument: Polynomial,
}

/// x_i'' = g_i(x, x', t): each g_i a polynomial in the unknowns, their velocities, and sines, cosines,
/// exponentials and powers of such polynomials, with rational coefficients that may be multiplied by
/// cosines and sines of multiples of one frequency.
#[derive(Clone, Debug)]
pub struct Field {
    /// g_i.
    pub(crate) forces: Vec<Polynomial>,
    /// dg_i/dx_k, then dg_i/dx_k', by i and k.
    pub(crate) first: Vec<Vec<Polynomial>>,
    /// The second derivatives that are not 0: i, two variables, the derivative.
    pub(crate) second: Vec<(usize, [usize; 2], Polynomial)>,
    /// sum_k x_k' dg_i/dx_k'.
    pub(crate) flow: Vec<Polynomial>,
    pub(crate) functions: Vec<Function>,
    /// The largest frequency of which all the frequencies of the force are multiples.
    pub(crate) force: Option<Rational>,
    pub(crate) varying: Option<Varying>,
}

/// How a field depends on the one parameter that it is known within: p = p_0 + s times a half width,
/// -1 <= s <= 1; derivatives by s.
#[derive(Clone, Debug)]
pub(crate) struct Varying {
    /// dg_i/ds.
    pub(crate) forces: Vec<Polynomial>,
    /// d^2g_i/ds dx_k, then d^2g_i/ds dx_k', by i and k.
    pub(crate) first: Vec<Vec<Polynomial>>,
    /// d^2g_i/ds^2.
    pub(crate) second: Vec<Polynomial>,
    /// s at the first end of the interval, -1 or 1, but for the slack, as at the other one.
    pub(crate) from: f64,
    pub(crate) slack: Up,
}

impl Field {
    /// The largest degree in the unknowns, their velocities and the functions.
    #[must_use]
    pub fn degree(&self) -> u32 {
        let terms = self.forces.iter().flat_map(|g| &g.terms);
        terms.map(|t| t.powers.iter().fold(0, |s: u32, n| s.saturating_add(*n))).max().unwrap_or(0)
    }

    /// How many unknowns there are.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.forces.len()
    }

    /// Whether no force depends on time.
    #[must_use]
    pub fn is_autonomous(&self) -> bool {
        self.force.is_none()
    }

    /// The field for a period of `periods` periods of the force: harmonics are multiplied.
    pub(crate) fn over(&self, periods: u32) -> Self {
        let mut field = self.clone();
        for polynomial in field.polynomials() {
            let terms = polynomial.terms.iter_mut().map(|t| &mut t.factor);
            for factor in terms.chain(polynomial.spread.iter_mut().map(|s| &mut s.factor)) {
                let waves = std::mem::take(factor).into_iter();
                *factor = waves.map(|(h, w)| (h.saturating_mul(periods), w)).collect();
            }
        }
        field
    }

    /// Whether a coefficient is known within a ball.
    pub(crate) fn is_uncertain(&self) -> bool {
        let arguments = self.functions.iter().map(|f| &f.argument);
        self.forces.iter().chain(arguments).any(|p| !p.spread.is_empty())
    }

    fn polynomials(&mut self) -> impl Iterator<Item = &mut Polynomial> {
        let first = self.first.iter_mut().flatten();
        let second = self.second.iter_mut().map(|(.., p)| p);
        let arguments = self.functions.iter_mut().map(|f| &mut f.argument);
        let varying = self.varying.iter_mut().flat_map(|varying| {
            let mixed = varying.first.iter_mut().flatten();
            varying.forces.iter_mut().chain(mixed).chain(&mut varying.second)
        });
        let own = self.forces.iter_mut().chain(first).chain(second).chain(&mut self.flow);
        own.chain(arguments).chain(varying)
    }

    /// Whether x_k(tau + pi) = s_k x_k(tau) is kept, s_k = -1 where the bit is set.
    pub(crate) fn keeps_shift(&self, minus: u64) -> bool {
        self.keeps(&|v| minus >> (v % self.unknowns()) & 1 == 1, &|h, _, _| Some(h % 2 == 1), minus)
    }

    /// Whether x_k(-tau) = s_k x_k(tau) is kept, s_k = -1 where the bit is set.
    pub(crate) fn keeps_reversal(&self, minus: u64) -> bool {
        let n = self.unknowns();
        self.keeps(
            &|v| (minus >> (v % n) & 1 == 1) != (v >= n),
            &|_, a, b| match () {
                () if !a.is_zero() && !b.is_zero() => None,
                () => Some(!b.is_zero()),
            },
            minus,
        )
    }

    /// Whether g_i changes its sign as x_i does where the variables and the waves change theirs.
    fn keeps(
        &self,
        variable: &dyn Fn(usize) -> bool,
        wave: &dyn Fn(u32, &Rational, &Rational) -> Option<bool>,
        minus: u64,
    ) -> bool {
        let n = 2 * self.unknowns();
        let mut signs: Vec<Option<bool>> = (0..n).map(|v| Some(variable(v))).collect();
        for function in &self.functions {
            let sign = function.argument.sign(&signs, wave);
            signs.push(function.kind.sign(sign));
        }
        let kept = |(i, g): (usize, &Polynomial)| {
            g.is_zero() || g.sign(&signs, wave) == Some(minus >> i & 1 == 1)
        };
        self.forces.iter().enumerate().all(kept)
    }

    /// Whether x(tau) -> x(-tau) maps solutions to solutions; of several unknowns the further ones may
    /// change their sign.
    #[must_use]
    pub fn is_reversible(&self) -> bool {
        self.signs(false).iter().any(|minus| minus & 1 == 0)
    }

    /// The patterns of signs of one symmetry that F keeps: of the shift by pi (never all +), or of the
    /// reversal of time.
    pub(crate) fn signs(&self, shift: bool) -> Signs {
        let most = if self.unknowns() > MOST_SIGNS { 1 } else { self.unknowns() };
        let all = 0..1u64 << most;
        match shift {
            true => all.skip(1).filter(|minus| self.keeps_shift(*minus)).collect(),
            false => all.filter(|minus| self.keeps_reversal(*minus)).collect(),
        }
    }

    /// q where x (alone) occurs in sines and cosines of multiples of q x only: it is an angle.
    pub(crate) fn angle(&self) -> Option<f64> {
        let holds = |t: &Term| t.powers.first().is_some_and(|n| *n > 0);
        if self.unknowns() > 1 || self.forces[0].terms.iter().any(holds) {
            return None;
        }
        let mut rates: Vec<Rational> = Vec::new();
        for function in &self.functions {
            for term in function.argument.terms.iter().filter(|t| holds(t)) {
                let constant = term.factor.iter().next().filter(|_| term.factor.len() == 1)?;
                let waves = matches!(function.kind, Operation::Sine | Operation::Cosine);
                if term.powers != [1] || *constant.0 != 0 || !waves {
                    return None;
                }
                rates.push(constant.1.0.clone().abs());
            }
        }
        rates.into_iter().reduce(|a, b| common_measure(&a, &b)).map(|q| q.to_f64())
    }

    /// The sum of dg_i/dx_i'.
    pub(crate) fn divergence(&self) -> Polynomial {
        let n = self.unknowns();
        let mut sum = Polynomial::default();
        for (i, row) in self.first.iter().enumerate() {
            sum.terms.extend(row[n + i].terms.iter().cloned());
            sum.spread.extend(row[n + i].spread.iter().cloned());
        }
        sum
    }
}

/// Unknowns up to which all patterns of signs are tried.
const MOST_SIGNS: usize = 8;
