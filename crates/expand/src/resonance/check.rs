//! The residual of a slow flow: the finished series go back into the equations.
//!
//! Nothing is taken from the derivation but f_{j,n}, u_{j,n} and sigma_{l,n}, and nothing is split: powers and
//! products are those of truncated series in full, and the time derivative is the vector field
//! D = sum_j (z_j' d/dz_j + zbar_j' d/dzbar_j) + sum_l eta_l' d/deta_l with z_j' = i nu_j z_j + sum eps^n f_{j,n}
//! whole, where the derivation has D_0 as eigenvalues. A delayed value is exp(-T D) x in Horner's form,
//! 1 - T D' (1 - T D'/2 (1 - ...)) with D' = D - D_0, followed by the shift of the phases, where the derivation builds the
//! powers order by order. The delayed velocity is the velocity shifted so, where the derivation has the rate of change of
//! the delayed value. Where D' z_j = mu_j z_j with constant mu_j, exp(-T D') multiplies z_j by exp(-T mu_j), the exponential
//! of a series in full ([`Series::exponential`]; a test compares it with Horner's form), once for all values of the delay.
//!
//! Of one linear equation the same is one number, the characteristic function at lambda, and the response apart. That the equation
//! is linear is read off the graph by the derivation's predicate ([`Affine`]); what it does with it is not shared.

use super::SlowFlow;
use super::linear::Affine;
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::residual::polynomial_value;
use lindstedt_algebra::{AmplitudeAlgebra, LinearParts, Ring};
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
    let interrupted = Err(ExpandError::Interrupted { order: found.order() });
    if algebra.interrupted() {
        return interrupted;
    }
    let residual = substituted(algebra, equation, found);
    // What was multiplied after the work was stopped means nothing, for better or worse.
    if algebra.interrupted() {
        return interrupted;
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
    let residuals = match judge.linear(equation, found)? {
        Some(residual) => vec![residual],
        None => {
            let (velocity, values) = judge.values(equation, found)?;
            let roots = velocity.iter().zip(&equation.roots);
            roots.map(|(v, root)| judge.rate(v).add(algebra, &values[*root])).collect()
        }
    };
    for residual in residuals {
        vanishes(algebra, &residual, order)?;
        all.extend(residual.coefficients);
    }
    Ok(all)
}

/// An energy along a flow, order by order: what is left of the first equation of `energy` without its acceleration. Its rate
/// of change along the flow must vanish identically.
///
/// # Errors
/// [`ExpandError::Residual`] with the first order of the energy that changes; those of [`check_flow`].
pub fn energy<A: AmplitudeAlgebra>(
    algebra: &A,
    energy: &Equation<A>,
    found: &SlowFlow<A::Element>,
) -> Result<Vec<A::Element>, ExpandError> {
    let judge = Judge::new(algebra, found);
    let sum = judge.values(energy, found)?.1[energy.root()].clone();
    let rate = judge.rate(&sum);
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: judge.order });
    }
    vanishes(algebra, &rate, judge.order)?;
    Ok(sum.coefficients)
}

/// Whether a series vanishes up to an order.
fn vanishes<A: AmplitudeAlgebra>(
    algebra: &A,
    series: &Series<A::Element>,
    order: usize,
) -> Result<(), ExpandError> {
    let broken = series.coefficients.iter().position(|c| !algebra.may_vanish(c));
    let short = || Some(series.known()).filter(|known| *known <= order);
    broken.or_else(short).map_or(Ok(()), |order| Err(ExpandError::Residual { order }))
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
                _ => match found.turned.get(order) {
                    Some(turned) => algebra.sub(x, turned),
                    None => x.clone(),
                },
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

/// The value of a node, where it is known.
type Known<'a, A> =
    dyn Fn(&Node<Element<A>>) -> Result<Option<Series<Element<A>>>, ExpandError> + 'a;

type Values<A> = Vec<Series<Element<A>>>;

type Element<A> = <A as Ring>::Element;

/// The index, the delay and whether it is the rate, of an unknown.
fn variable<E>(node: &Node<E>) -> Option<(usize, Option<usize>, bool)> {
    match node {
        Node::Displacement => Some((0, None, false)),
        Node::Velocity => Some((0, None, true)),
        &Node::Unknown { index, velocity, delay } => Some((index, delay, velocity)),
        _ => None,
    }
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
        let sought = Series::truncated(found.parameter.clone());
        let stretched: Vec<_> =
            (0..algebra.delays()).map(|delay| self.stretched(delay, self.order)).collect();
        let value = |node: &Node<_>| {
            if let &Node::Forcing(index) = node {
                return Ok(Some(Series::polynomial(vec![equation.forcing[index].clone()])));
            }
            let Some((index, delay, rate)) = variable(node) else { return Ok(None) };
            let now = if rate { velocity.get(index) } else { x.get(index) };
            match (now, delay) {
                (Some(now), None) => Ok(Some(now.clone())),
                (Some(now), Some(delay)) => {
                    let stretched = stretched.get(delay).and_then(Option::as_deref);
                    self.delayed(now, delay, stretched).map(Some)
                }
                (None, None) if !rate => Ok(Some(sought.clone())),
                (None, _) => Err(unsupported()),
            }
        };
        let values = self.nodes(equation, &value)?;
        Ok((velocity, values))
    }

    /// The values of the nodes of a graph: those that `known` has, and the others of them.
    fn nodes(
        &self,
        equation: &Equation<A>,
        known: &Known<'_, A>,
    ) -> Result<Values<A>, ExpandError> {
        let mut values = Vec::new();
        for node in &equation.nodes {
            if self.algebra.interrupted() {
                return Err(ExpandError::Interrupted { order: self.order });
            }
            let value = match known(node)? {
                Some(value) => value,
                None => polynomial_value(self.algebra, node, &values, self.order)
                    .ok_or_else(unsupported)?,
            };
            values.push(value);
        }
        Ok(values)
    }

    /// The residual of an equation that is linear in its one unknown, x'' + F = 0, where f = h z and x = z + zbar + p
    /// with a response p to the force: 2 Re(L z) + p'' + F(p) with the characteristic function
    ///
    ///   L = lambda^2 + F(1) - F(0),   lambda = i nu + h,
    ///
    /// F being taken of x = 1, x' = lambda, x(t - T) = e^(-lambda T) without forces. No amplitude is multiplied.
    fn linear(
        &self,
        equation: &Equation<A>,
        found: &SlowFlow<A::Element>,
    ) -> Result<Option<Series<A::Element>>, ExpandError> {
        let algebra = self.algebra;
        let affine = Affine::of(algebra, equation, self.order);
        let Some(affine) = affine.filter(|_| self.forces_stand()) else { return Ok(None) };
        let Some(p) = self.response(found) else { return Ok(None) };
        // A factor of order m leaves m orders of the delayed value unseen; series know how far they go.
        let seen = |delay| self.order - affine.first(algebra, delay).unwrap_or(0).min(self.order);
        let Some(characteristic) = self.characteristic(equation, &seen)? else { return Ok(None) };
        let z = algebra.amplitude(0);
        let free = characteristic.map(|c| algebra.twice_real(&algebra.mul(c, &z)));
        let rate = self.rate(&p);
        let forced = |node: &Node<_>| match (node, variable(node)) {
            (&Node::Forcing(index), _) => {
                Ok(Some(Series::polynomial(vec![equation.forcing[index].clone()])))
            }
            (_, Some((_, delay, velocity))) => {
                let p = if velocity { &rate } else { &p };
                delay.map_or_else(|| Ok(p.clone()), |delay| self.shifted(p, delay)).map(Some)
            }
            _ => Ok(None),
        };
        let forced = self.rate(&rate).add(algebra, &self.root(equation, &forced)?);
        Ok(Some(free.add(algebra, &forced)))
    }

    /// L, where z' is a multiple of z; of delayed values as many orders as are seen.
    fn characteristic(
        &self,
        equation: &Equation<A>,
        seen: &dyn Fn(usize) -> usize,
    ) -> Result<Option<Series<A::Element>>, ExpandError> {
        let algebra = self.algebra;
        let z = algebra.amplitude(0);
        let late = |delay| {
            let turn = algebra.by_amplitude(&algebra.shift(&z, delay)?, 0);
            let late = self.stretched(delay, seen(delay))?;
            Some(late.first()?.map(|c| algebra.mul(c, &turn)))
        };
        let late: Option<Vec<_>> = (0..algebra.delays()).map(late).collect();
        let Some((late, lambda)) = late.zip(self.multiple(0, &self.whole[0][0])) else {
            return Ok(None);
        };
        let still = || Series::polynomial(Vec::new());
        let factor = |node: &Node<_>| match (node, variable(node)) {
            (Node::Forcing(_), _) => Ok(Some(still())),
            (_, Some((_, None, true))) => Ok(Some(lambda.clone())),
            (_, Some((_, None, false))) => Ok(Some(Series::polynomial(vec![algebra.one()]))),
            (_, Some((_, Some(delay), rate))) => {
                let late = late.get(delay).ok_or_else(unsupported)?;
                let rate = rate.then(|| lambda.mul(algebra, late, self.order));
                Ok(Some(rate.unwrap_or_else(|| late.clone())))
            }
            _ => Ok(None),
        };
        let constant = |node: &Node<_>| {
            let moves = matches!(node, Node::Forcing(_)) || variable(node).is_some();
            Ok(moves.then(still))
        };
        let square = lambda.mul(algebra, &lambda, self.order);
        let constant = self.root(equation, &constant)?.map(|c| algebra.neg(c));
        let sum = square.add(algebra, &self.root(equation, &factor)?);
        Ok(Some(sum.add(algebra, &constant)))
    }

    /// The value of the first equation; see [`Self::nodes`].
    fn root(
        &self,
        equation: &Equation<A>,
        known: &Known<'_, A>,
    ) -> Result<Series<A::Element>, ExpandError> {
        Ok(self.nodes(equation, known)?.swap_remove(equation.root()))
    }

    /// x - z - zbar of one unknown, if no amplitude occurs in it.
    fn response(&self, found: &SlowFlow<A::Element>) -> Option<Series<A::Element>> {
        let algebra = self.algebra;
        let mut p = found.solution.first()?.clone();
        *p.first_mut()? = algebra.sub(p.first()?, &algebra.twice_real(&algebra.amplitude(0)));
        let free = |f: &A::Element| algebra.is_zero(&algebra.by_amplitude(f, 0));
        p.iter().all(free).then(|| Series::truncated(p))
    }

    /// Whether the phases of the forces turn as at order zero.
    fn forces_stand(&self) -> bool {
        self.slow[1].iter().flat_map(|rate| &rate.coefficients).all(|c| self.algebra.is_zero(c))
    }

    /// The constants that z_j is multiplied with in f, if f is that product.
    fn multiple(&self, j: usize, f: &Series<A::Element>) -> Option<Series<A::Element>> {
        let algebra = self.algebra;
        let own = |f| {
            let (mut parts, rest) = algebra.linear_parts(f)?;
            let own = std::mem::replace(&mut parts.get_mut(j)?[0], algebra.zero());
            let others = parts.iter().flatten().chain([&rest]).all(|f| algebra.is_zero(f));
            others.then(|| algebra.as_constant(&own)).flatten()
        };
        let own = f.coefficients.iter().map(own).collect::<Option<_>>()?;
        Some(Series::truncated(own))
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
        let slid = match late.and_then(|late| self.times(f, late)) {
            Some(slid) => slid,
            None => self.slid(f, delay).ok_or_else(unsupported)?,
        };
        self.shifted(&slid, delay)
    }

    /// exp(-T D_0) f.
    fn shifted(
        &self,
        f: &Series<A::Element>,
        delay: usize,
    ) -> Result<Series<A::Element>, ExpandError> {
        let shifted = f.coefficients.iter().map(|c| self.algebra.shift(c, delay));
        let shifted = shifted.collect::<Option<_>>().ok_or_else(unsupported)?;
        Ok(Series::truncated(shifted))
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

    /// exp(-T mu_j) up to an order, if D' z_j = mu_j z_j with constants mu_j and D' does not turn the forces.
    fn stretched(&self, delay: usize, order: usize) -> Option<Vec<Series<A::Element>>> {
        let algebra = self.algebra;
        if !self.forces_stand() {
            return None;
        }
        let time = algebra.neg(&algebra.delay(delay)?);
        let exponential = |(j, rate): (usize, &Series<A::Element>)| {
            let mut back = self.multiple(j, rate)?.map(|c| algebra.mul(c, &time));
            back.coefficients.truncate(order + 1);
            back.exponential(algebra)
        };
        self.slow[0].iter().enumerate().map(exponential).collect()
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
            let own = parts.iter().map(own).collect::<Option<_>>()?;
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
    use super::*;
    use crate::compile::compile_system;
    use crate::resonance::resonant;
    use crate::resonance::tests::{Named, algebra, delay_loop};
    use lindstedt_equation::Expression;

    /// Both forms of the residual of a linear equation, of flows that solve it and that do not; of others there is one.
    #[test]
    fn a_root_is_put_into_its_characteristic_equation() {
        let (algebra, order) = (algebra(), 3);
        let graph =
            |more| compile_system(&algebra, &[delay_loop(more)], &Named(&algebra), order).unwrap();
        let equation = graph(Expression::integer(0));
        let found = resonant(&algebra, &equation, order, &[], &mut |_| true).unwrap();
        let both = |found: &SlowFlow<_>| {
            let judge = Judge::new(&algebra, found);
            let (velocity, values) = judge.values(&equation, found).unwrap();
            let general = judge.rate(&velocity[0]).add(&algebra, &values[equation.root()]);
            assert!(judge.linear(&equation, found).unwrap().unwrap() == general);
            general.coefficients.iter().filter(|c| !algebra.is_zero(c)).count()
        };
        assert_eq!(both(&found), 0);
        let mut wrong = found.clone();
        wrong.flow[0][2] = algebra.by_time(&algebra.amplitude(0));
        wrong.solution[0][1] = algebra.one();
        assert_eq!(both(&wrong), order);
        let judge = Judge::new(&algebra, &wrong);
        let x = Expression::DISPLACEMENT;
        assert_eq!(judge.linear(&graph(x.clone() * x), &wrong), Ok(None));
        wrong.flow[0][2] = algebra.one();
        assert_eq!(Judge::new(&algebra, &wrong).linear(&equation, &wrong), Ok(None));
    }

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
        let late = judge.stretched(0, order).unwrap();
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
            assert!(Judge::new(&algebra, &wrong).stretched(0, order).is_none());
        }
        wrong.flow[0][2] = algebra.zero();
        wrong.detuning = vec![vec![algebra.one()]];
        assert!(Judge::new(&algebra, &wrong).stretched(0, order).is_none());
    }
}
