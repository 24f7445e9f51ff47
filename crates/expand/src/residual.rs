//! The residual check: the finished expansion goes back into the equation.
//!
//! It shares no code with the driver's step: truncated power series are multiplied in full, the
//! time derivatives are taken of the whole series, and logarithms, exponentials and formal
//! functions are not recomputed by their recurrences in the small parameter but recognised by
//! their differential equations in the *phase*, with their values at psi = 0:
//!
//!   L = ln|y|:  L' y = y',   exp L(0) = y(0);      E = exp g:  E' = g' E,  E(0) = exp g(0);
//!   F^(j)(g):   its derivative is g' F^(j+1)(g),   its value at psi = 0 is F_j when g(0) = 0.
//!
//! What must vanish is every coefficient of omega^2 d^2x/dpsi^2 + F, an element of the algebra:
//! identically, not at sample points.

use crate::ExpandError;
use crate::compile::{Equation, Node, NodeId};
use crate::expansion::Expansion;
use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Ring};
use lindstedt_equation::Condition;
use lindstedt_series::Series;
use rug::Rational;

/// Substitutes the expansion into the equation; every order must vanish identically, and the
/// normalisation must hold. Returns the number of the highest order checked.
///
/// The amplitude of the last order of a limit cycle shows only in the order after it: there the
/// secular term in sin psi must vanish, which is checked too.
///
/// # Errors
/// [`ExpandError::Residual`] or [`ExpandError::Normalisation`] with the first order that fails;
/// [`ExpandError::Interrupted`] where the algebra was interrupted and nothing is known.
pub fn check<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    expansion: &Expansion<A>,
) -> Result<usize, ExpandError> {
    check_from(algebra, equation, expansion, 0)
}

/// The same where the orders below `first` are known to be right: what enters none of the others is not formed, and
/// nothing is said about them.
///
/// # Errors
/// Those of [`check`].
pub fn check_from<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    expansion: &Expansion<A>,
    first: usize,
) -> Result<usize, ExpandError> {
    let result = substitute(algebra, equation, expansion, first);
    if algebra.interrupted() {
        return Err(ExpandError::Interrupted { order: expansion.order() });
    }
    result
}

fn substitute<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Equation<A>,
    expansion: &Expansion<A>,
    first: usize,
) -> Result<usize, ExpandError> {
    check_normalisation(algebra, expansion)?;
    let constants = algebra.constants();
    let mut solution = expansion.solution.clone();
    let mut squared = expansion.frequency_squared.clone();
    let order = expansion.order();
    if expansion.condition == Condition::LimitCycle {
        // x_{N+1} and W_{N+1} have no part in sin psi in the residual of order N + 1.
        solution.push(algebra.zero());
        squared.push(constants.zero());
    }
    let judge = Judge {
        order: solution.len() - 1,
        solution: Series::truncated(solution),
        squared: Series::truncated(squared),
        first,
        ..Judge::new(algebra, equation, expansion, order)
    };
    let values = judge.values();
    judge.transcendental_nodes(&values)?;
    let inertia = judge.over_frequency(
        &judge.squared.map(|w| constants.mul(w, &expansion.stiffness)),
        &judge.solution.map(|x| algebra.derivative(&algebra.derivative(x))),
        first,
    );
    let mut residual = inertia.add(algebra, &values[equation.root()]);
    let after = residual.coefficients.split_off(residual.coefficients.len().min(order + 1));
    let known = residual.coefficients.len().min(first);
    residual.coefficients[..known].fill(algebra.zero());
    judge.must_vanish(&residual, order + 1)?;
    if judge.order > order {
        let broken = ExpandError::Residual { order: judge.order };
        let (_, sine) = algebra
            .first_harmonic(after.first().ok_or(broken.clone())?)
            .map_err(|source| ExpandError::Phase { order: judge.order, source })?;
        if !constants.is_zero(&sine) {
            return Err(broken);
        }
    }
    Ok(order)
}

/// x_0 = a_0 cos psi; then, for n >= 1, x_n(0) = x_n'(0) = 0, or no first harmonic, or x_n'(0) = 0,
/// as the condition of the expansion says. Together with the equation this determines it.
///
/// # Errors
/// [`ExpandError::Normalisation`] with the first order that fails.
pub fn check_normalisation<A: PhaseAlgebra>(
    algebra: &A,
    expansion: &Expansion<A>,
) -> Result<(), ExpandError> {
    let constants = algebra.constants();
    let vanishes = |f: &A::Element| algebra.at_zero(f).is_some_and(|c| constants.is_zero(&c));
    for (order, x) in expansion.solution.iter().enumerate() {
        let holds = match expansion.condition {
            _ if order == 0 => expansion
                .amplitude
                .first()
                .is_some_and(|a| *x == algebra.scale_by(&algebra.cosine(), a)),
            Condition::InitialAmplitude => vanishes(x) && vanishes(&algebra.derivative(x)),
            Condition::LimitCycle => vanishes(&algebra.derivative(x)),
            Condition::FundamentalAmplitude | Condition::FreeAmplitude => algebra
                .first_harmonic(x)
                .is_ok_and(|(c, s)| constants.is_zero(&c) && constants.is_zero(&s)),
        };
        if !holds {
            return Err(ExpandError::Normalisation { order });
        }
    }
    Ok(())
}

/// The value of a node that is a constant, a sum or a product of the nodes before it.
pub(crate) fn polynomial_value<A: FunctionAlgebra>(
    algebra: &A,
    node: &Node<<A::Constants as Ring>::Element>,
    values: &[Series<A::Element>],
    order: usize,
) -> Option<Series<A::Element>> {
    match node {
        Node::Constant(c) => Some(Series::polynomial(vec![algebra.embed(c)])),
        Node::Small => Some(Series::polynomial(vec![algebra.zero(), algebra.one()])),
        Node::Sum(terms) => {
            let mut sum = Series::polynomial(Vec::new());
            for (q, term) in terms {
                sum = sum.add(algebra, &values[*term].map(|c| algebra.scale(c, q)));
            }
            Some(sum)
        }
        &Node::Product(a, b) => Some(values[a].mul(algebra, &values[b], order)),
        _ => None,
    }
}

/// A series expansion and its equation, to be multiplied out up to an order.
pub(crate) struct Judge<'a, A: PhaseAlgebra> {
    algebra: &'a A,
    equation: &'a Equation<A>,
    expansion: &'a Expansion<A>,
    order: usize,
    /// The first order of the residual that is asked for.
    first: usize,
    pub(crate) solution: Series<A::Element>,
    pub(crate) squared: Series<<A::Constants as Ring>::Element>,
}

impl<'a, A: PhaseAlgebra> Judge<'a, A> {
    pub(crate) fn new(
        algebra: &'a A,
        equation: &'a Equation<A>,
        expansion: &'a Expansion<A>,
        order: usize,
    ) -> Self {
        let solution = Series::truncated(expansion.solution.clone());
        let squared = Series::truncated(expansion.frequency_squared.clone());
        Self { algebra, equation, expansion, order, first: 0, solution, squared }
    }

    /// The values of all nodes, each from the first order on that enters what is asked for.
    pub(crate) fn values(&self) -> Vec<Series<A::Element>> {
        let mut values: Vec<Series<A::Element>> = Vec::new();
        for (id, first) in self.needed().into_iter().enumerate() {
            let value = self.value(id, first, &values);
            values.push(value);
        }
        values
    }

    /// The first order of every node that enters the residual: of what is multiplied by eps one less than that of the
    /// product, of other factors order zero.
    fn needed(&self) -> Vec<usize> {
        let nodes = &self.equation.nodes;
        let mut needed = vec![usize::MAX; nodes.len()];
        let root = self.equation.root();
        needed[root] = self.first;
        for (id, node) in nodes.iter().enumerate().rev() {
            let own = needed[id];
            let mut ask = |operand: NodeId, first: usize| {
                needed[operand] = needed[operand].min(first);
            };
            match node {
                _ if own == usize::MAX => {}
                Node::Sum(terms) => terms.iter().for_each(|(_, term)| ask(*term, own)),
                &Node::Product(a, b) if nodes[a] == Node::Small => ask(b, own.saturating_sub(1)),
                &Node::Product(a, b) if nodes[b] == Node::Small => ask(a, own.saturating_sub(1)),
                &Node::Product(a, b) => [a, b].into_iter().for_each(|operand| ask(operand, 0)),
                _ => {}
            }
        }
        let transcendental = |node: &Node<_>| {
            !matches!(node, Node::Constant(_) | Node::Small | Node::Sum(_) | Node::Product(..))
                && !matches!(node, Node::Displacement | Node::Velocity)
        };
        if nodes.iter().any(transcendental) { vec![0; nodes.len()] } else { needed }
    }

    /// A series of constants times a series of functions, with zero below the order `first`.
    pub(crate) fn over_frequency(
        &self,
        constants: &Series<<A::Constants as Ring>::Element>,
        f: &Series<A::Element>,
        first: usize,
    ) -> Series<A::Element> {
        let is_zero = |c| self.algebra.constants().is_zero(c);
        let coefficient = |n: usize| {
            if n < first {
                return self.algebra.zero();
            }
            let pairs = constants.coefficients.iter().zip(f.coefficients[..=n].iter().rev());
            let terms: Vec<_> = pairs.filter(|(c, _)| !is_zero(c)).map(|(c, f)| (f, c)).collect();
            self.algebra.linear_combination(&terms)
        };
        Series::truncated((0..f.coefficients.len()).map(coefficient).collect())
    }

    fn value(&self, id: NodeId, first: usize, values: &[Series<A::Element>]) -> Series<A::Element> {
        let algebra = self.algebra;
        match &self.equation.nodes[id] {
            Node::Displacement => self.solution.clone(),
            Node::Velocity => {
                let frequency = self.squared.square_root(algebra.constants());
                let frequency = frequency.unwrap_or(Series::truncated(Vec::new()));
                self.over_frequency(&frequency, &self.solution.map(|x| algebra.derivative(x)), 0)
            }
            &Node::Product(a, b) => {
                values[a].mul_from(algebra, &values[b], first.min(self.order), self.order)
            }
            node => polynomial_value(algebra, node, values, self.order)
                .unwrap_or_else(|| Series::truncated(self.expansion.certificates[id].clone())),
        }
    }

    pub(crate) fn must_vanish(
        &self,
        series: &Series<A::Element>,
        needed: usize,
    ) -> Result<(), ExpandError> {
        let broken = |c: &A::Element| !self.algebra.is_zero(c);
        match series.coefficients.iter().position(broken) {
            Some(order) => Err(ExpandError::Residual { order }),
            None if series.known() < needed => Err(ExpandError::Residual { order: series.known() }),
            None => Ok(()),
        }
    }

    pub(crate) fn transcendental_nodes(
        &self,
        values: &[Series<A::Element>],
    ) -> Result<(), ExpandError> {
        let algebra = self.algebra;
        let slope = |id: NodeId| values[id].map(|c| algebra.derivative(c));
        let product =
            |a: &Series<A::Element>, b: &Series<A::Element>| a.mul(algebra, b, self.order);
        for (id, node) in self.equation.nodes.iter().enumerate() {
            if !values[id].is_polynomial && values[id].coefficients.is_empty() {
                continue;
            }
            let (left, right) = match node {
                Node::Logarithm(y) => (product(&slope(id), &values[*y]), slope(*y)),
                Node::Exponential(g) => (slope(id), product(&slope(*g), &values[id])),
                Node::Formal { derivative, argument, .. } => {
                    (slope(id), product(&slope(*argument), &values[*derivative]))
                }
                // Only algebras of values have these: nothing to verify identically.
                Node::Power(..) | Node::Circular { .. } => {
                    return Err(ExpandError::UnsupportedTerm {
                        term: "the identical residual of an elementary function".into(),
                    });
                }
                _ => continue,
            };
            let minus_one = Rational::from(-1);
            let difference = left.add(algebra, &right.map(|c| algebra.scale(c, &minus_one)));
            self.must_vanish(&difference, values[id].known().min(right.known()))?;
            self.initial_value(id, node, values)?;
        }
        Ok(())
    }

    /// The values at psi = 0.
    fn initial_value(
        &self,
        id: NodeId,
        node: &Node<<A::Constants as Ring>::Element>,
        values: &[Series<A::Element>],
    ) -> Result<(), ExpandError> {
        let constants = self.algebra.constants();
        let at_zero = |id: NodeId| {
            let list = values[id].coefficients.iter();
            let coefficients: Option<_> = list.map(|c| self.algebra.at_zero(c)).collect();
            coefficients.map(|coefficients| Series {
                coefficients,
                is_polynomial: values[id].is_polynomial,
            })
        };
        let undecided = || ExpandError::UnsupportedTerm {
            term: "a value at psi = 0 that the algebra cannot give".into(),
        };
        let own = at_zero(id).ok_or_else(undecided)?;
        let expected = match node {
            &Node::Logarithm(y) => {
                let value = at_zero(y).ok_or_else(undecided)?;
                return self.same(&self.exponential(&own), &value, own.known());
            }
            &Node::Exponential(g) => self.exponential(&at_zero(g).ok_or_else(undecided)?),
            Node::Formal { leading, argument, .. } => {
                let argument = at_zero(*argument).ok_or_else(undecided)?;
                if argument.coefficients.iter().any(|c| !constants.is_zero(c)) {
                    return Err(ExpandError::UnsupportedTerm {
                        term: "a formal function whose argument does not vanish at psi = 0".into(),
                    });
                }
                let zeros = own.map(|_| constants.zero());
                zeros.add(constants, &Series::polynomial(vec![leading.clone()]))
            }
            _ => return Ok(()),
        };
        self.same(&own, &expected, own.known())
    }

    /// sum_j g^j/j! for a series of constants without a term of order zero.
    fn exponential(
        &self,
        g: &Series<<A::Constants as Ring>::Element>,
    ) -> Series<<A::Constants as Ring>::Element> {
        let constants = self.algebra.constants();
        let mut term = Series::polynomial(vec![constants.one()]);
        let mut sum = term.clone();
        // g has no term of order zero, so g^j starts at order j.
        for j in 1..=self.order {
            term = term.mul(constants, g, self.order);
            term = term.map(|c| constants.scale(c, &Rational::from((1, j))));
            sum = sum.add(constants, &term);
        }
        sum
    }

    /// Whether two series of constants agree in their first `length` coefficients, both known.
    fn same(
        &self,
        a: &Series<<A::Constants as Ring>::Element>,
        b: &Series<<A::Constants as Ring>::Element>,
        length: usize,
    ) -> Result<(), ExpandError> {
        let zero = self.algebra.constants().zero();
        let get = |s: &Series<_>, n: usize| match s.coefficients.get(n) {
            None if s.is_polynomial => Some(zero.clone()),
            other => other.cloned(),
        };
        let differs = |&n: &usize| get(a, n).is_none() || get(a, n) != get(b, n);
        match (0..length.min(self.order + 1)).find(differs) {
            Some(order) => Err(ExpandError::Residual { order }),
            None => Ok(()),
        }
    }
}
