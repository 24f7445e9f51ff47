//! The parameter that is fixed order by order so that a motion has no slow change.
//!
//! Where the equations contain eps p, order n of g changes by -p_{n-1} T, T the slope of order one of F by p
//! along order zero of the motion. With T = 2 i nu phi + conj + (D_0^2 + nu^2) rho, split as g is, p_{n-1}
//! takes p_{n-1} phi from f_n and p_{n-1} rho from u_n; it is the ratio of f_n and phi, which has to be a real
//! constant, the same for all unknowns.
//!
//! Of one unknown it may be complex: then the motion turns. Order n of g is affine in the multiple beta of
//! w = x_0' that x_{n-1} contains, n > 1, as w solves order zero; f_n = R + beta J. So Im conj(phi) (R + beta J) = 0
//! fixes beta where the direction of x_0 is a simple root of Im conj(phi) f_1 = 0, whose slope J is.

use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::evaluator::Evaluator;
use lindstedt_algebra::{AmplitudeAlgebra, LinearPart, Split};

pub(super) struct Balance<E> {
    /// p_0, p_1, ...
    pub(super) values: Vec<E>,
    /// phi_j and rho_j.
    reaction: Vec<[E; 2]>,
    /// An unknown with phi_j != 0, and 1/|phi_j|^2.
    lead: (usize, E),
    /// w, and the multiples of it in x_0, x_1, ...
    pub(super) tangent: E,
    pub(super) turned: Vec<E>,
    /// Whether coefficients n or n + 1 of a node depend on p_n.
    sensitive: Vec<bool>,
}

impl<E: Clone + PartialEq> Balance<E> {
    /// The reaction to p, at order zero of the motion.
    pub(super) fn new<A: AmplitudeAlgebra<Element = E>>(
        algebra: &A,
        equation: &Equation<A>,
        linear: &[LinearPart<E>],
        [x, velocity]: [&[Vec<E>]; 2],
    ) -> Result<Self, ExpandError> {
        let sought = Node::unknown(equation.roots.len(), false, None);
        let tangents = |value: E| {
            let mut alone = Evaluator::new(algebra, equation);
            for (j, (x, velocity)) in x.iter().zip(velocity).enumerate() {
                alone.assign(&Node::unknown(j, false, None), 0, x[0].clone());
                alone.assign(&Node::unknown(j, true, None), 0, velocity[0].clone());
            }
            alone.assign(&sought, 0, value);
            alone.tangents(&|node| (*node == sought).then(|| [algebra.one(), algebra.zero()]))
        };
        let (at_zero, at_one) = (tangents(algebra.zero())?, tangents(algebra.one())?);
        let mut reaction = Vec::new();
        for (j, root) in equation.roots.iter().enumerate() {
            let slope = &at_zero[*root][1];
            let changes = !algebra.may_vanish(&algebra.sub(slope, &at_one[*root][1]));
            if changes || !algebra.is_zero(&at_zero[*root][0]) {
                return Err(ExpandError::NotBalanced { order: 1 });
            }
            let phase = |source| ExpandError::Phase { order: 1, source };
            let Split { flow, response, .. } =
                algebra.split(j, &linear[j], slope).map_err(phase)?;
            reaction.push([flow, response]);
        }
        let inverse = |(j, [flow, _]): (usize, &[E; 2])| {
            let square = algebra.mul(flow, &algebra.conjugate(flow));
            Some((j, algebra.reciprocal(&square)?))
        };
        let lead = reaction.iter().enumerate().find_map(inverse);
        let lead = lead.ok_or(ExpandError::NotBalanced { order: 1 })?;
        let depends = |tangent: &[E; 2]| !tangent.iter().all(|t| algebra.is_zero(t));
        let sensitive = at_one.iter().zip(&at_zero).map(|(a, b)| depends(a) || depends(b));
        let (sensitive, tangent) = (sensitive.collect(), algebra.by_time(&x[0][0]));
        Ok(Self { values: Vec::new(), lead, sensitive, reaction, tangent, turned: Vec::new() })
    }

    /// 2 i Im conj(phi) f, of f in the flow of the unknown that leads.
    pub(super) fn aside<A: AmplitudeAlgebra<Element = E>>(
        &self,
        algebra: &A,
        parts: &[Split<A>],
    ) -> E {
        let (lead, _) = self.lead;
        let along = algebra.mul(&parts[lead].flow, &algebra.conjugate(&self.reaction[lead][0]));
        algebra.sub(&along, &algebra.conjugate(&along))
    }

    /// Fixes p_{n-1}, with which the flow of order n vanishes, and changes the parts of order n.
    pub(super) fn settle<A: AmplitudeAlgebra<Element = E>>(
        &mut self,
        evaluator: &mut Evaluator<'_, A>,
        n: usize,
        parts: &mut [Split<A>],
    ) -> Result<(), ExpandError> {
        let algebra = evaluator.algebra;
        let (lead, inverse) = &self.lead;
        let [flow, _] = &self.reaction[*lead];
        let ratio = algebra.mul(&parts[*lead].flow, &algebra.conjugate(flow));
        let ratio = algebra.mul(&ratio, inverse);
        // Of a complex or varying ratio the real part at most is balanced.
        let value = algebra.scale(&algebra.twice_real(&ratio), &(1, 2).into());
        for (part, [flow, response]) in parts.iter_mut().zip(&self.reaction) {
            part.flow = algebra.sub(&part.flow, &algebra.mul(&value, flow));
            part.response = algebra.sub(&part.response, &algebra.mul(&value, response));
            if !algebra.may_vanish(&part.flow) || algebra.as_constant(&value).is_none() {
                return Err(ExpandError::NotBalanced { order: n });
            }
            part.flow = algebra.zero();
        }
        evaluator.forget_from(n - 1, &self.sensitive);
        let sought = Node::unknown(evaluator.equation.roots.len(), false, None);
        evaluator.assign(&sought, n - 1, value.clone());
        self.values.push(value);
        Ok(())
    }
}
