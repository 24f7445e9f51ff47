//! The residual of an averaged expansion: the finished series go back into the equation.
//!
//! Nothing is taken from the derivation but A_n, B_n and u_n. Powers and products are those of
//! truncated series in full; the time derivative is the operator D applied to whole series; and a
//! delayed value is exp(-T D) x in Horner's form, 1 - T D' (1 - T D'/2 (1 - ...)), followed by the
//! shift of the phases. The delayed velocity is exp(-T D) applied to the velocity, where the
//! derivation differentiates the delayed displacement.

use super::{AveragedExpansion, Constant, step_back};
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::residual::polynomial_value;
use lindstedt_algebra::{AveragingAlgebra, Ring};
use lindstedt_series::Series;

/// Substitutes an averaged expansion into its equation; every order must vanish identically (in a
/// ring of enclosures: must enclose zero), and x - a cos psi must have no first harmonic. Returns
/// the highest order checked.
///
/// # Errors
/// [`ExpandError::Residual`] or [`ExpandError::Normalisation`] with the first order that fails;
/// [`ExpandError::UnsupportedTerm`] for equations that are not polynomial.
pub fn check_averaged<A: AveragingAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    expansion: &AveragedExpansion<A>,
) -> Result<usize, ExpandError> {
    let result = substitute(algebra, equation, expansion);
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: expansion.order() });
    }
    result
}

fn substitute<A: AveragingAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    expansion: &AveragedExpansion<A>,
) -> Result<usize, ExpandError> {
    let judge = Judge { algebra, expansion, order: expansion.order() };
    judge.normalisation()?;
    let x = Series::truncated(expansion.solution.clone());
    let velocity = judge.rate(&x);
    let mut values: Vec<Series<A::Element>> = Vec::new();
    for node in &equation.nodes {
        let value = match node {
            Node::Displacement => x.clone(),
            Node::Velocity => velocity.clone(),
            Node::Unknown { index: 0, velocity: false, delay: Some(delay) } => {
                judge.delayed(&x, *delay)?
            }
            Node::Unknown { index: 0, velocity: true, delay: Some(delay) } => {
                judge.delayed(&velocity, *delay)?
            }
            Node::Forcing { multiple, sine } => {
                let (cos, sin) = algebra.forcing(*multiple).ok_or_else(unsupported)?;
                Series::polynomial(vec![if *sine { sin } else { cos }])
            }
            node => {
                polynomial_value(algebra, node, &values, judge.order).ok_or_else(unsupported)?
            }
        };
        values.push(value);
    }
    let residual = judge.rate(&velocity).add(algebra, &values[equation.root()]);
    let broken = |c: &A::Element| !algebra.may_vanish(c);
    match residual.coefficients.iter().position(broken) {
        Some(order) => Err(ExpandError::Residual { order }),
        None if residual.known() <= judge.order => {
            Err(ExpandError::Residual { order: residual.known() })
        }
        None => Ok(judge.order),
    }
}

fn unsupported() -> ExpandError {
    ExpandError::UnsupportedTerm { term: "a function that is not polynomial".into() }
}

struct Judge<'a, A: AveragingAlgebra> {
    algebra: &'a A,
    expansion: &'a AveragedExpansion<A>,
    order: usize,
}

impl<A: AveragingAlgebra> Judge<'_, A> {
    /// x - a cos psi has no first harmonic.
    fn normalisation(&self) -> Result<(), ExpandError> {
        let (algebra, constants) = (self.algebra, self.algebra.constants());
        for (order, x) in self.expansion.solution.iter().enumerate() {
            let mut rest = x.clone();
            if order == 0 {
                rest = algebra.sub(x, &algebra.generating_solution());
            }
            if algebra.first_harmonic_of(&rest).iter().any(|c| !constants.may_vanish(c)) {
                return Err(ExpandError::Normalisation { order });
            }
        }
        Ok(())
    }

    /// D' f = (A d/da + B d/dpsi) f as products of whole series.
    fn drift(&self, f: &Series<A::Element>) -> Series<A::Element> {
        let algebra = self.algebra;
        let rate = |list: &[Constant<A>]| {
            Series::truncated(list.iter().map(|c| algebra.embed(c)).collect())
        };
        let along_a = f.map(|f| algebra.by_amplitude(f));
        let along_phase = f.map(|f| algebra.by_phase(f));
        let a = rate(&self.expansion.amplitude_rate).mul(algebra, &along_a, self.order);
        let b = rate(&self.expansion.phase_rate).mul(algebra, &along_phase, self.order);
        Series::truncated(a.add(algebra, &b).coefficients)
    }

    /// D f.
    fn rate(&self, f: &Series<A::Element>) -> Series<A::Element> {
        self.drift(f).add(self.algebra, &f.map(|f| self.algebra.by_time(f)))
    }

    /// f(t - T). Every application of D' raises the order, so the inner sums are short.
    fn delayed(
        &self,
        f: &Series<A::Element>,
        delay: usize,
    ) -> Result<Series<A::Element>, ExpandError> {
        let algebra = self.algebra;
        let shortened = |length: usize| {
            Series::truncated(f.coefficients.iter().take(length).cloned().collect())
        };
        let mut sum = shortened(1);
        for i in (1..=self.order).rev() {
            let factor = step_back(algebra, delay, i).ok_or_else(unsupported)?;
            let change = self.drift(&sum).map(|c| algebra.scale_by(c, &factor));
            sum = shortened(self.order + 2 - i).add(algebra, &change);
        }
        let shifted: Option<Vec<_>> =
            sum.coefficients.iter().map(|c| algebra.shift(c, delay)).collect();
        Ok(Series::truncated(shifted.ok_or_else(unsupported)?))
    }
}
