//! The residual of an averaged expansion: the finished series go back into the equation.
//!
//! Nothing is taken from the derivation but A_n, B_n and u_n. Powers and products are those of
//! truncated series in full; the time derivative is the operator D applied to whole series; and a
//! delayed value is exp(-T D) x in Horner's form, 1 - T D' (1 - T D'/2 (1 - ...)), followed by the
//! shift of the phases. The delayed velocity is exp(-T D) applied to the velocity, where the
//! derivation differentiates the delayed displacement.
//!
//! A linear equation is judged in two parts, whose sum is the whole: the functions of eta alone, as above with A = B =
//! 0, and a e^(i psi) without the force, on which D is the product with the number lambda.

use super::complex::{Complex, Pair, factor};
use super::{AveragedExpansion, Constant, step_back};
use crate::ExpandError;
use crate::compile::{Equation, Node};
use crate::residual::polynomial_value;
use lindstedt_algebra::{AveragingAlgebra, RationalAlgebra, Ring};
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
    if !is_linear(&equation.nodes) {
        return judge.residual(equation);
    }
    let none = vec![algebra.constants().zero(); judge.order + 1];
    let mut forced = AveragedExpansion {
        linear: expansion.linear.clone(),
        amplitude_rate: none.clone(),
        phase_rate: none,
        solution: expansion.solution.clone(),
        work: Vec::new(),
    };
    if let Some(x) = forced.solution.first_mut() {
        *x = algebra.sub(x, &algebra.generating_solution());
    }
    let moves = |x: &A::Element| {
        let slopes = [algebra.by_amplitude(x), algebra.by_phase(x)];
        slopes.iter().any(|slope| !algebra.may_vanish(slope))
    };
    if let Some(order) = forced.solution.iter().position(moves) {
        return Err(ExpandError::Residual { order });
    }
    Judge { expansion: &forced, ..judge }.residual(equation)?;
    judge.free(equation)
}

/// Whether no unknown is multiplied by an unknown or by a force.
fn is_linear<E>(nodes: &[Node<E>]) -> bool {
    // 0: constant; 1: with a force; 2: with an unknown.
    let mut kinds: Vec<u8> = Vec::new();
    for node in nodes {
        let kind = match node {
            Node::Constant(_) | Node::Small => 0,
            Node::Forcing(_) => 1,
            Node::Displacement | Node::Velocity | Node::Unknown { .. } => 2,
            Node::Sum(terms) => terms.iter().map(|(_, term)| kinds[*term]).max().unwrap_or(0),
            &Node::Product(a, b) if kinds[a].min(kinds[b]) == 0 || kinds[a].max(kinds[b]) < 2 => {
                kinds[a].max(kinds[b])
            }
            _ => return false,
        };
        kinds.push(kind);
    }
    true
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

    /// The whole expansion in the equation.
    fn residual(&self, equation: &Equation<A>) -> Result<usize, ExpandError> {
        let algebra = self.algebra;
        let x = Series::truncated(self.expansion.solution.clone());
        let velocity = self.rate(&x);
        let mut values: Vec<Series<A::Element>> = Vec::new();
        for node in &equation.nodes {
            let value = match node {
                Node::Displacement => x.clone(),
                Node::Velocity => velocity.clone(),
                Node::Unknown { index: 0, velocity: false, delay: Some(delay) } => {
                    self.delayed(&x, *delay)?
                }
                Node::Unknown { index: 0, velocity: true, delay: Some(delay) } => {
                    self.delayed(&velocity, *delay)?
                }
                &Node::Forcing(index) => Series::polynomial(vec![equation.forcing[index].clone()]),
                node => {
                    polynomial_value(algebra, node, &values, self.order).ok_or_else(unsupported)?
                }
            };
            values.push(value);
        }
        let acceleration = self.rate(&velocity);
        self.vanishes(algebra, &acceleration.add(algebra, &values[equation.root()]))
    }

    fn vanishes<R: Ring>(&self, ring: &R, sum: &Series<R::Element>) -> Result<usize, ExpandError> {
        match sum.coefficients.iter().position(|c| !ring.may_vanish(c)) {
            Some(order) => Err(ExpandError::Residual { order }),
            None if sum.known() <= self.order => Err(ExpandError::Residual { order: sum.known() }),
            None => Ok(self.order),
        }
    }

    /// a e^(i psi) in a linear equation without its force: the sum of the factors of a e^(i psi).
    fn free(&self, equation: &Equation<A>) -> Result<usize, ExpandError> {
        let constants = self.algebra.constants();
        let complex = Complex(constants);
        let root = self.root()?;
        let real = |c: Constant<A>| [c, constants.zero()];
        let mut values: Vec<Series<Pair<Constant<A>>>> = Vec::new();
        for node in &equation.nodes {
            let value = match node {
                Node::Constant(c) => Series::polynomial(vec![real(c.clone())]),
                Node::Small => Series::polynomial(vec![complex.zero(), complex.one()]),
                Node::Forcing(_) => Series::polynomial(Vec::new()),
                Node::Displacement => Series::polynomial(vec![complex.one()]),
                Node::Velocity => root.clone(),
                &Node::Unknown { velocity, delay: Some(delay), .. } => {
                    let late = self.exponential(&root, delay)?;
                    if velocity { late.mul(&complex, &root, self.order) } else { late }
                }
                Node::Sum(terms) => {
                    let mut sum = Series::polynomial(Vec::new());
                    for (q, term) in terms {
                        let q = constants.rational(q);
                        let scaled = |z: &Pair<_>| z.each_ref().map(|c| constants.mul(c, &q));
                        sum = sum.add(&complex, &values[*term].map(scaled));
                    }
                    sum
                }
                &Node::Product(a, b) => values[a].mul(&complex, &values[b], self.order),
                _ => return Err(unsupported()),
            };
            values.push(value);
        }
        let square = root.mul(&complex, &root.clone(), self.order);
        self.vanishes(&complex, &square.add(&complex, &values[equation.root()]))
    }

    /// lambda = i omega_0 + sum (A_n/a + i B_n) eps^n, a number at every order.
    fn root(&self) -> Result<Series<Pair<Constant<A>>>, ExpandError> {
        let (algebra, constants) = (self.algebra, self.algebra.constants());
        let generating = algebra.generating_solution();
        let [amplitude, _] = algebra.first_harmonic_of(&generating);
        let slope = |f: &Constant<A>| algebra.by_amplitude(&algebra.embed(f));
        let leading = factor(algebra, &algebra.by_time(&algebra.by_amplitude(&generating)));
        let mut root = Vec::new();
        for (order, (a, b)) in
            self.expansion.amplitude_rate.iter().zip(&self.expansion.phase_rate).enumerate()
        {
            let broken = ExpandError::Residual { order };
            let growth = algebra.as_constant(&slope(a)).ok_or(broken.clone())?;
            let rest = constants.sub(a, &constants.mul(&growth, &amplitude));
            if !constants.may_vanish(&rest) || !algebra.may_vanish(&slope(b)) {
                return Err(broken);
            }
            root.push([growth, b.clone()]);
        }
        let complex = Complex(constants);
        let first = root.first_mut().ok_or(ExpandError::Residual { order: 0 })?;
        complex.add_assign(first, &leading);
        Ok(Series::truncated(root))
    }

    /// e^(-lambda T): with delta = lambda - lambda_0, of order 1, the product of e^(-lambda_0 T) and
    /// 1 - T delta (1 - T delta/2 (1 - ...)).
    fn exponential(
        &self,
        root: &Series<Pair<Constant<A>>>,
        delay: usize,
    ) -> Result<Series<Pair<Constant<A>>>, ExpandError> {
        let (algebra, constants) = (self.algebra, self.algebra.constants());
        let complex = Complex(constants);
        let cosine = algebra.by_amplitude(&algebra.generating_solution());
        let turn = factor(algebra, &algebra.shift(&cosine, delay).ok_or_else(unsupported)?);
        let one = Series::polynomial(vec![complex.one()]);
        let mut sum = one.clone();
        for i in (1..=self.order).rev() {
            let step = step_back(algebra, delay, i).ok_or_else(unsupported)?;
            let mut change = root.map(|z| z.each_ref().map(|part| constants.mul(part, &step)));
            if let Some(first) = change.coefficients.first_mut() {
                *first = complex.zero();
            }
            // The sum begins with one and is wanted up to the order N + 1 - i.
            let product = change.mul(&complex, &sum, self.order + 1 - i);
            sum = one.add(&complex, &product);
        }
        Ok(sum.map(|z| complex.mul(z, &turn)))
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
