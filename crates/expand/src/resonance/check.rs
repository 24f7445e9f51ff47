//! The residual of a slow flow: the finished series go back into the equations.
//!
//! Nothing is taken from the derivation but f_{j,n}, u_{j,n} and sigma_{l,n}, and nothing is split: powers and
//! products are those of truncated series in full, and the time derivative is the vector field
//! D = sum_j (z_j' d/dz_j + zbar_j' d/dzbar_j) + sum_l eta_l' d/deta_l with z_j' = i nu_j z_j + sum eps^n f_{j,n}
//! whole, where the derivation has D_0 as eigenvalues. A delayed value is exp(-T D) x in Horner's form,
//! 1 - T D' (1 - T D'/2 (1 - ...)) with D' = D - D_0, followed by the shift of the phases, where the derivation builds the
//! powers order by order. The delayed velocity is the velocity shifted so, where the derivation has the rate of change of
//! the delayed value. Where D' z_j = mu_j z_j with constant mu_j, exp(-T D') multiplies z_j by exp(-T mu_j): Horner's form
//! of that number, once for all values of the delay, where the derivation has the recurrence of its differential equation.

use super::SlowFlow;
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::residual::polynomial_value;
use lindstedt_algebra::{AmplitudeAlgebra, LinearParts};
use lindstedt_series::Series;
use rug::Rational;

/// Substitutes a slow flow into its equations; every order must vanish identically (in a ring of
/// enclosures: must enclose zero), and x_j - z_j - zbar_j must have no monomial with |lambda| = nu_j.
/// Returns the highest order checked.
///
/// # Errors
/// [`ExpandError::Residual`] or [`ExpandError::Normalisation`] with the first order that fails;
/// [`ExpandError::UnsupportedTerm`] for equations that are not polynomial.
pub fn check_flow<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    found: &SlowFlow<A::Element>,
) -> Result<usize, ExpandError> {
    checked_residual(algebra, equation, found).map(|_| found.order())
}

/// [`check_flow`], and what the residual is: zeros, or in a ring of enclosures what encloses them.
///
/// # Errors
/// Those of [`check_flow`].
pub fn checked_residual<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    found: &SlowFlow<A::Element>,
) -> Result<Vec<A::Element>, ExpandError> {
    let residual = substituted(algebra, equation, found);
    // What was multiplied after the work was stopped means nothing, for better or worse.
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: found.order() });
    }
    residual
}

fn substituted<A: AmplitudeAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    found: &SlowFlow<A::Element>,
) -> Result<Vec<A::Element>, ExpandError> {
    let order = found.order();
    let mut all = Vec::new();
    normalisation(algebra, found)?;
    let judge = Judge::new(algebra, found);
    let (velocity, values) = judge.values(equation, found)?;
    for (velocity, root) in velocity.iter().zip(&equation.roots) {
        let residual = judge.rate(velocity).add(algebra, &values[*root]);
        let broken = |c: &A::Element| !algebra.may_vanish(c);
        if let Some(order) = residual.coefficients.iter().position(broken) {
            return Err(ExpandError::Residual { order });
        }
        if residual.known() <= order {
            return Err(ExpandError::Residual { order: residual.known() });
        }
        all.extend(residual.coefficients);
    }
    Ok(all)
}

/// The energy sum_j weights_j x_j'^2/2 + V along a flow, order by order, V being what is left of the first equation of
/// `potential` without its acceleration. Its rate of change along the flow must vanish identically.
///
/// # Errors
/// [`ExpandError::Residual`] with the first order of the energy that changes; those of [`check_flow`].
pub fn energy<A: AmplitudeAlgebra>(
    algebra: &A,
    potential: &Equation<A>,
    weights: &[Rational],
    found: &SlowFlow<A::Element>,
) -> Result<Vec<A::Element>, ExpandError> {
    let judge = Judge::new(algebra, found);
    let (velocity, values) = judge.values(potential, found)?;
    let mut sum = values[potential.root()].clone();
    for (weight, velocity) in weights.iter().zip(&velocity) {
        let square = velocity.mul(algebra, velocity, judge.order);
        let half = Rational::from(weight / 2);
        sum = sum.add(algebra, &square.map(|c| algebra.scale(c, &half)));
    }
    let rate = judge.rate(&sum);
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: judge.order });
    }
    match rate.coefficients.iter().position(|c| !algebra.may_vanish(c)) {
        Some(order) => Err(ExpandError::Residual { order }),
        None => Ok(sum.coefficients),
    }
}

fn unsupported() -> ExpandError {
    ExpandError::UnsupportedTerm { term: "a function that is not polynomial".into() }
}

fn normalisation<A: AmplitudeAlgebra>(
    algebra: &A,
    found: &SlowFlow<A::Element>,
) -> Result<(), ExpandError> {
    for (j, list) in found.solution.iter().enumerate() {
        for (order, x) in list.iter().enumerate() {
            let rest = match order {
                // The harmonics nu_j of a motion without slow change are those it was started with.
                0 if !found.parameter.is_empty() => algebra.zero(),
                0 => algebra.sub(x, &algebra.twice_real(&algebra.amplitude(j))),
                _ => x.clone(),
            };
            if !algebra.is_off_resonance(j, &rest) {
                return Err(ExpandError::Normalisation { order });
            }
        }
    }
    Ok(())
}

struct Judge<'a, A: AmplitudeAlgebra> {
    algebra: &'a A,
    order: usize,
    /// z_j' and eta_l'.
    whole: Field<A::Element>,
    /// z_j' - i nu_j z_j and eta_l' - Omega_l.
    slow: Field<A::Element>,
}

/// A vector field: its components along z_j and along eta_l.
type Field<E> = [Vec<Series<E>>; 2];

impl<'a, A: AmplitudeAlgebra> Judge<'a, A> {
    fn new(algebra: &'a A, found: &SlowFlow<A::Element>) -> Self {
        let order = found.order();
        let force = |l: usize| {
            let mut rate = vec![algebra.zero()];
            rate.extend(found.detuning.get(l).into_iter().flatten().cloned());
            rate.resize(order + 1, algebra.zero());
            Series::truncated(rate)
        };
        let flow = found.flow.iter().map(|flow| Series::truncated(flow.clone())).collect();
        let slow: Field<_> = [flow, (0..algebra.forces()).map(force).collect()];
        let [mut amplitudes, mut forces] = slow.clone();
        for (j, series) in amplitudes.iter_mut().enumerate() {
            let rate = algebra.by_time(&algebra.amplitude(j));
            algebra.add_assign(&mut series.coefficients[0], &rate);
        }
        for (l, series) in forces.iter_mut().enumerate() {
            algebra.add_assign(&mut series.coefficients[0], &algebra.force_rate(l));
        }
        Self { algebra, order, whole: [amplitudes, forces], slow }
    }

    /// x_j', and the values of the nodes of a graph.
    #[allow(clippy::type_complexity, reason = "two lists of series")]
    fn values(
        &self,
        equation: &Equation<A>,
        found: &SlowFlow<A::Element>,
    ) -> Result<(Vec<Series<A::Element>>, Vec<Series<A::Element>>), ExpandError> {
        let algebra = self.algebra;
        let x: Vec<_> = found.solution.iter().map(|x| Series::truncated(x.clone())).collect();
        let velocity: Vec<_> = x.iter().map(|x| self.rate(x)).collect();
        let mut values: Vec<Series<A::Element>> = Vec::new();
        let sought = Series::truncated(found.parameter.clone());
        let stretched: Vec<_> = (0..algebra.delays()).map(|delay| self.stretched(delay)).collect();
        for node in &equation.nodes {
            let value = match node {
                Node::Displacement => x[0].clone(),
                Node::Velocity => velocity[0].clone(),
                Node::Unknown { index, velocity: false, delay: None } => {
                    x.get(*index).unwrap_or(&sought).clone()
                }
                Node::Unknown { index, velocity: true, delay: None } => velocity[*index].clone(),
                Node::Unknown { index, velocity: late, delay: Some(delay) } => {
                    let now = if *late { &velocity } else { &x };
                    let now = now.get(*index).ok_or_else(unsupported)?;
                    let stretched = stretched.get(*delay).and_then(Option::as_deref);
                    self.delayed(now, *delay, stretched)?
                }
                &Node::Forcing(index) => Series::polynomial(vec![equation.forcing[index].clone()]),
                node => {
                    polynomial_value(algebra, node, &values, self.order).ok_or_else(unsupported)?
                }
            };
            values.push(value);
        }
        Ok((velocity, values))
    }

    /// D f for a real series f.
    fn rate(&self, f: &Series<A::Element>) -> Series<A::Element> {
        self.along(&self.whole, f)
    }

    /// The derivative of a real series along a field.
    fn along(
        &self,
        [amplitudes, forces]: &Field<A::Element>,
        f: &Series<A::Element>,
    ) -> Series<A::Element> {
        let algebra = self.algebra;
        let moves = |rate: &&Series<_>| !rate.coefficients.iter().all(|c| algebra.is_zero(c));
        // Zero where nothing moves.
        let mut along = Series::polynomial(vec![algebra.zero(); self.order + 1]);
        for (j, amplitude) in amplitudes.iter().enumerate().filter(|(_, rate)| moves(rate)) {
            let slope = f.map(|f| algebra.by_amplitude(f, j));
            along = along.add(algebra, &amplitude.mul(algebra, &slope, self.order));
        }
        let mut along = along.map(|c| algebra.twice_real(c));
        for (l, force) in forces.iter().enumerate().filter(|(_, rate)| moves(rate)) {
            let turn = f.map(|f| algebra.by_force(f, l));
            along = along.add(algebra, &force.mul(algebra, &turn, self.order));
        }
        Series::truncated(along.coefficients)
    }

    /// f(t - T), where exp(-T D') is the product of z_j with `late`\[j\], if it is.
    fn delayed(
        &self,
        f: &Series<A::Element>,
        delay: usize,
        late: Option<&[Series<A::Element>]>,
    ) -> Result<Series<A::Element>, ExpandError> {
        let algebra = self.algebra;
        let slid = match late.and_then(|late| self.times(f, late)) {
            Some(slid) => slid,
            None => self.slid(f, delay).ok_or_else(unsupported)?,
        };
        let shifted: Option<Vec<_>> =
            slid.coefficients.iter().map(|c| algebra.shift(c, delay)).collect();
        Ok(Series::truncated(shifted.ok_or_else(unsupported)?))
    }

    /// exp(-T D') f. Every application of D' raises the order, so the inner sums are short.
    fn slid(&self, f: &Series<A::Element>, delay: usize) -> Option<Series<A::Element>> {
        let algebra = self.algebra;
        let shortened = |length: usize| {
            Series::truncated(f.coefficients.iter().take(length).cloned().collect())
        };
        let mut sum = shortened(1);
        let time = algebra.neg(&algebra.delay(delay)?);
        // -T D'.
        let back = |rate: &Series<_>| rate.map(|c| algebra.mul(c, &time));
        let back = self.slow.each_ref().map(|rates| rates.iter().map(back).collect());
        for i in (1..=self.order).rev() {
            let change = self.along(&back, &sum).map(|c| algebra.scale(c, &Rational::from((1, i))));
            sum = shortened(self.order + 2 - i).add(algebra, &change);
        }
        Some(sum)
    }

    /// exp(-T mu_j), if D' z_j = mu_j z_j with constants mu_j and D' does not turn the forces.
    fn stretched(&self, delay: usize) -> Option<Vec<Series<A::Element>>> {
        let algebra = self.algebra;
        let [amplitudes, forces] = &self.slow;
        let still = |rate: &Series<_>| rate.coefficients.iter().all(|c| algebra.is_zero(c));
        if !forces.iter().all(still) {
            return None;
        }
        let time = algebra.neg(&algebra.delay(delay)?);
        let exponential = |(j, rate): (usize, &Series<A::Element>)| {
            let back = |f| {
                let (mut parts, rest) = algebra.linear_parts(f)?;
                let own = parts.get_mut(j).map(|[own, _]| std::mem::replace(own, algebra.zero()));
                let others = parts.iter().flatten().chain([&rest]).all(|f| algebra.is_zero(f));
                let own = algebra.as_constant(&own.unwrap_or_else(|| algebra.zero()))?;
                others.then(|| algebra.mul(&own, &time))
            };
            let back: Vec<_> = rate.coefficients.iter().map(back).collect::<Option<_>>()?;
            let back = Series::truncated(back);
            let one = Series::polynomial(vec![algebra.one()]);
            let step = |sum: Series<_>, i: usize| {
                let change = back.mul(algebra, &sum, self.order + 1 - i);
                one.add(algebra, &change.map(|c| algebra.scale(c, &Rational::from((1, i)))))
            };
            Some((1..=self.order).rev().fold(one.clone(), step))
        };
        amplitudes.iter().enumerate().map(exponential).collect()
    }

    /// A real series with z_j multiplied by `factors`\[j\]; nothing where amplitudes do not stand alone.
    fn times(
        &self,
        f: &Series<A::Element>,
        factors: &[Series<A::Element>],
    ) -> Option<Series<A::Element>> {
        let algebra = self.algebra;
        let parts: Vec<_> =
            f.coefficients.iter().map(|c| algebra.linear_parts(c)).collect::<Option<_>>()?;
        let mut sum = Series::truncated(parts.iter().map(|(_, rest)| rest.clone()).collect());
        for (j, factor) in factors.iter().enumerate() {
            let own = |(parts, _): &LinearParts<A::Element>| Some(parts.get(j)?[0].clone());
            let Some(own) = parts.iter().map(own).collect::<Option<_>>() else { continue };
            let product = Series::truncated(own).mul(algebra, factor, self.order);
            let z = algebra.amplitude(j);
            let real = |c: &_| algebra.twice_real(&algebra.mul(c, &z));
            sum = sum.add(algebra, &product.map(real));
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test fails by panicking

    use super::*;
    use crate::compile::compile_system;
    use crate::resonance::resonant;
    use crate::resonance::tests::{Named, algebra, delay_loop};
    use lindstedt_algebra::Ring;
    use lindstedt_equation::Expression;

    /// Both forms of exp(-T D') of a linear flow, on what it delays; of others there is one.
    #[test]
    fn a_stretched_amplitude_is_a_delayed_one() {
        let (algebra, order) = (algebra(), 3);
        let found = |more| {
            let graph =
                compile_system(&algebra, &[delay_loop(more)], &Named(&algebra), order).unwrap();
            resonant(&algebra, &graph, order, &[], &mut |_| true).unwrap()
        };
        let linear = found(Expression::integer(0));
        let judge = Judge::new(&algebra, &linear);
        let late = judge.stretched(0).unwrap();
        let x = Series::truncated(linear.solution[0].clone());
        for f in [judge.rate(&x), x.clone()] {
            let times = judge.times(&f, &late).unwrap();
            assert_eq!(times.coefficients, judge.slid(&f, 0).unwrap().coefficients);
            assert_ne!(times.coefficients, f.coefficients);
        }
        // No amplitude alone.
        let square = x.mul(&algebra, &x, order);
        assert!(judge.times(&square, &late).is_none());
        let mut wrong = linear;
        let z = algebra.amplitude(0);
        for f in [algebra.conjugate(&z), algebra.mul(&z, &z), algebra.one()] {
            wrong.flow[0][2] = f;
            assert!(Judge::new(&algebra, &wrong).stretched(0).is_none());
        }
        wrong.flow[0][2] = algebra.zero();
        wrong.detuning = vec![vec![algebra.one()]];
        assert!(Judge::new(&algebra, &wrong).stretched(0).is_none());
    }
}
