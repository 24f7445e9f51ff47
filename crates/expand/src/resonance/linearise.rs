//! The linear part of equations at order zero.

use super::linear::Affine;
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::evaluator::Evaluator;
use lindstedt_algebra::{AmplitudeAlgebra, LinearPart};

/// The linear part at order zero of an equation for one unknown; needs no frequency.
///
/// # Errors
/// [`ExpandError::NotTheFrequency`] when it is not linear with constant factors.
pub fn linear_part<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
) -> Result<LinearPart<A::Element>, ExpandError> {
    if let Some(affine) = Affine::read(algebra, equation, 0) {
        return Ok(affine.linear_part(algebra, algebra.delays()));
    }
    let generating = [algebra.twice_real(&algebra.amplitude(0))];
    let (mut parts, _) = linearise(algebra, equation, &generating)?;
    parts.pop().ok_or(ExpandError::NotWeaklyNonlinear)
}

/// The linear parts at x_j = `generating[j]`, none of which depends on another unknown, and the nodes whose order n
/// depends on order n of an unknown.
#[allow(clippy::type_complexity, reason = "two lists")]
pub(super) fn linearise<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    generating: &[A::Element],
) -> Result<(Vec<LinearPart<A::Element>>, Vec<bool>), ExpandError> {
    let mut evaluator = Evaluator::new(algebra, equation);
    for (j, x) in generating.iter().enumerate() {
        let late = (0..algebra.delays()).map(|delay| (Some(delay), algebra.shift(x, delay)));
        for (delay, x) in std::iter::once((None, Some(x.clone()))).chain(late) {
            let x = x.ok_or(ExpandError::NotWeaklyNonlinear)?;
            evaluator.assign(&Node::unknown(j, true, delay), 0, algebra.by_time(&x));
            evaluator.assign(&Node::unknown(j, false, delay), 0, x);
        }
    }
    let mut sensitive = vec![false; equation.nodes.len()];
    let mut factor = |index: usize, velocity, delay| {
        let variable = Node::unknown(index, velocity, delay);
        let unit = |node: &Node<_>| (*node == variable).then(|| [algebra.one(), algebra.zero()]);
        let tangents = evaluator.tangents(&unit)?;
        for (flag, tangent) in sensitive.iter_mut().zip(&tangents) {
            *flag |= !algebra.is_zero(&tangent[0]);
        }
        let other =
            |(j, root): &(usize, &usize)| *j != index && !algebra.may_vanish(&tangents[**root][0]);
        let broken = |unknown| ExpandError::NotTheFrequency { unknown };
        if let Some((unknown, _)) = equation.roots.iter().enumerate().find(other) {
            return Err(broken(unknown));
        }
        algebra.as_constant(&tangents[equation.roots[index]][0]).ok_or(broken(index))
    };
    let mut parts = Vec::new();
    for j in 0..generating.len() {
        let stiffness = factor(j, false, None)?;
        let damping = factor(j, true, None)?;
        let mut delayed = Vec::new();
        for delay in 0..algebra.delays() {
            delayed.push((factor(j, false, Some(delay))?, factor(j, true, Some(delay))?));
        }
        parts.push(LinearPart { stiffness, damping, delayed });
    }
    Ok((parts, sensitive))
}
