//! Coefficients of nodes, one order at a time, each computed once.

use crate::ExpandError;
use crate::ahead::Ahead;
use crate::compile::{Equation, Node, NodeId};
use lindstedt_algebra::{Elementary, FunctionAlgebra, Products, Ring};
use rug::Rational;
use std::ops::Range;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

/// The change of a variable: orders 0 and 1, or nothing where it does not change.
type Direction<'a, A> = dyn Fn(&Node<Constant<A>>) -> Option<[<A as Ring>::Element; 2]> + 'a;

/// The memory of the driver: coefficient n of every node, as far as it was asked for.
pub(crate) struct Evaluator<'a, A: FunctionAlgebra> {
    pub(crate) algebra: &'a A,
    pub(crate) equation: &'a Equation<A>,
    values: Vec<Vec<Option<A::Element>>>,
    /// Of products, what is summed before its order comes.
    ahead: Vec<Ahead<A::Element>>,
    /// The last order that will be asked for, if it is known.
    pub(crate) last: Option<usize>,
    /// Products of elements formed so far: the work counter.
    pub(crate) products: u64,
}

/// The highest order at which a node can be different from zero, if there is one.
fn degree<E>(node: &Node<E>) -> Option<usize> {
    match node {
        Node::Constant(_) | Node::Forcing(_) => Some(0),
        Node::Small => Some(1),
        _ => None,
    }
}

impl<'a, A: FunctionAlgebra> Evaluator<'a, A> {
    pub(crate) fn new(algebra: &'a A, equation: &'a Equation<A>) -> Self {
        let values = equation.nodes.iter().map(|_| Vec::new()).collect();
        let ahead = equation.nodes.iter().map(|_| Ahead::new()).collect();
        Self { algebra, equation, values, ahead, last: None, products: 0 }
    }

    /// The coefficient computed before, if any.
    pub(crate) fn known(&self, node: NodeId, n: usize) -> Option<&A::Element> {
        self.values.get(node)?.get(n)?.as_ref()
    }

    fn store(&mut self, node: NodeId, n: usize, value: A::Element) {
        let list = &mut self.values[node];
        if list.len() <= n {
            list.resize(n + 1, None);
        }
        list[n] = Some(value);
    }

    /// Sets the coefficient of the displacement or the velocity, if it occurs.
    pub(crate) fn assign(&mut self, variable: &Node<Constant<A>>, n: usize, value: A::Element) {
        if let Some(node) = self.equation.nodes.iter().position(|known| known == variable) {
            self.store(node, n, value);
        }
    }

    /// Forgets coefficient n and above of the nodes that are sensitive: those whose coefficient
    /// n depends on x_n. (x and x' themselves are, and are assigned anew.)
    pub(crate) fn forget_from(&mut self, n: usize, sensitive: &[bool]) {
        for (list, _) in self.values.iter_mut().zip(sensitive).filter(|(_, s)| **s) {
            list.truncate(n);
        }
        self.forget_ahead(n);
    }

    /// Coefficient n changes.
    fn forget_ahead(&mut self, n: usize) {
        self.ahead.iter_mut().for_each(|ahead| ahead.forget(n));
    }

    /// The coefficients up to `order` of the nodes that are not polynomial.
    pub(crate) fn certificates(self, order: usize) -> Vec<Vec<A::Element>> {
        let is_transcendental = |node: &Node<_>| {
            !matches!(
                node,
                Node::Constant(_)
                    | Node::Small
                    | Node::Displacement
                    | Node::Velocity
                    | Node::Sum(_)
                    | Node::Product(..)
            )
        };
        let prefix = |list: Vec<Option<A::Element>>| {
            list.into_iter().take(order + 1).map_while(|value| value).collect()
        };
        let nodes = self.equation.nodes.iter().zip(self.values);
        nodes
            .map(|(node, list)| if is_transcendental(node) { prefix(list) } else { Vec::new() })
            .collect()
    }

    /// Adds the corrections, one per node, to the coefficients of order n that are known, and
    /// forgets the orders above.
    pub(crate) fn correct(&mut self, n: usize, corrections: &[A::Element]) {
        for (list, correction) in self.values.iter_mut().zip(corrections) {
            list.truncate(n + 1);
            if let Some(Some(value)) = list.get_mut(n) {
                self.algebra.add_assign(value, correction);
            }
        }
        self.forget_ahead(n);
    }

    /// The coefficient of eps^n of a node.
    pub(crate) fn coefficient(
        &mut self,
        node: NodeId,
        n: usize,
    ) -> Result<A::Element, ExpandError> {
        if let Some(value) = self.known(node, n) {
            return Ok(value.clone());
        }
        let value = self.finished(node, n)?;
        self.store(node, n, value.clone());
        Ok(value)
    }

    /// Computes and remembers, without handing out a copy.
    fn ensure(&mut self, node: NodeId, n: usize) -> Result<(), ExpandError> {
        if self.known(node, n).is_none() {
            let value = self.finished(node, n)?;
            self.store(node, n, value);
        }
        Ok(())
    }

    /// A coefficient that was not broken off.
    fn finished(&mut self, node: NodeId, n: usize) -> Result<A::Element, ExpandError> {
        let value = self.compute(node, n);
        if self.algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: n });
        }
        value
    }

    fn compute(&mut self, node: NodeId, n: usize) -> Result<A::Element, ExpandError> {
        let algebra = self.algebra;
        let equation = self.equation;
        let unsupported = |what: &str| ExpandError::UnsupportedTerm { term: what.to_owned() };
        match &equation.nodes[node] {
            Node::Constant(c) if n == 0 => Ok(algebra.embed(c)),
            Node::Small if n == 1 => Ok(algebra.one()),
            &Node::Forcing(index) if n == 0 => Ok(equation.forcing[index].clone()),
            // Orders of x and x' beyond those assigned are the provisional zero.
            Node::Constant(_)
            | Node::Small
            | Node::Forcing(_)
            | Node::Displacement
            | Node::Velocity
            | Node::Unknown { .. } => Ok(algebra.zero()),
            Node::Sum(terms) => {
                let mut sum = algebra.zero();
                for (q, term) in terms {
                    self.ensure(*term, n)?;
                    match self.known(*term, n) {
                        Some(value) if *q == 1 => algebra.add_assign(&mut sum, value),
                        Some(value) => algebra.add_assign(&mut sum, &algebra.scale(value, q)),
                        None => {}
                    }
                }
                Ok(sum)
            }
            &Node::Product(a, b) => self.cauchy(node, [a, b], n),
            &Node::Logarithm(y) if n == 0 => {
                let leading = self.coefficient(y, 0)?;
                algebra.log_abs(&leading).ok_or_else(|| unsupported("ln"))
            }
            // n y_0 L_n = n y_n - sum_{k=1}^{n-1} k L_k y_{n-k}, from y L' = y'.
            &Node::Logarithm(y) => {
                let leading = self.coefficient(y, 0)?;
                let inverse = algebra.reciprocal(&leading).ok_or_else(|| unsupported("ln"))?;
                let sum = self.weighted(node, y, 1..n, n)?;
                let value = self.coefficient(y, n)?;
                let rest = algebra.sub(&value, &algebra.scale(&sum, &Rational::from((1, n))));
                self.products += 1;
                Ok(algebra.mul(&rest, &inverse))
            }
            &Node::Exponential(g) if n == 0 => {
                let leading = self.coefficient(g, 0)?;
                if algebra.is_zero(&leading) {
                    return Ok(algebra.one());
                }
                algebra.apply(&Elementary::Exp, &leading).ok_or_else(|| unsupported("exp"))
            }
            Node::Power(y, q) if n == 0 => {
                let leading = self.coefficient(*y, 0)?;
                let power = algebra.apply(&Elementary::Power(q.clone()), &leading);
                power.ok_or_else(|| unsupported("a power of a function that vanishes"))
            }
            // n y_0 P_n = sum_{k=1}^n (q k + k - n) y_k P_{n-k}, from y P' = q y' P.
            Node::Power(y, q) => {
                let leading = self.coefficient(*y, 0)?;
                let inverse = algebra.reciprocal(&leading).ok_or_else(|| unsupported("a power"))?;
                let weight = |k: usize| Rational::from(q + 1u32) * k - n;
                let sum = self.weighted_by(*y, node, 1..n + 1, n, &weight)?;
                self.products += 1;
                Ok(algebra.scale(&algebra.mul(&sum, &inverse), &Rational::from((1, n))))
            }
            &Node::Circular { argument, cosine, .. } if n == 0 => {
                let leading = self.coefficient(argument, 0)?;
                let function = if cosine { Elementary::Cos } else { Elementary::Sin };
                algebra.apply(&function, &leading).ok_or_else(|| unsupported("sin"))
            }
            // S' = g' C, C' = -g' S.
            &Node::Circular { argument, partner, cosine } => {
                let sum = self.weighted(argument, partner, 1..n + 1, n)?;
                let sign = if cosine { -1 } else { 1 };
                Ok(algebra.scale(&sum, &Rational::from((sign, n))))
            }
            // n E_n = sum_{k=1}^n k g_k E_{n-k}, from E' = g' E.
            &Node::Exponential(g) => {
                let sum = self.weighted(g, node, 1..n + 1, n)?;
                Ok(algebra.scale(&sum, &Rational::from((1, n))))
            }
            Node::Formal { argument, leading, .. } if n == 0 => {
                let value = self.coefficient(*argument, 0)?;
                let vanishes = algebra.is_zero(&value);
                vanishes.then(|| algebra.embed(leading)).ok_or_else(|| unsupported("F"))
            }
            // F' = g' F^(1).
            &Node::Formal { derivative, argument, .. } => {
                let sum = self.weighted(argument, derivative, 1..n + 1, n)?;
                Ok(algebra.scale(&sum, &Rational::from((1, n))))
            }
        }
    }

    /// sum_k a_k b_{n-k}; of a square, each product once.
    fn cauchy(
        &mut self,
        node: NodeId,
        [a, b]: [NodeId; 2],
        n: usize,
    ) -> Result<A::Element, ExpandError> {
        let algebra = self.algebra;
        let nodes = &self.equation.nodes;
        let last = degree(&nodes[a]).unwrap_or(n).min(n);
        let first = n.saturating_sub(degree(&nodes[b]).unwrap_or(n));
        let mut range: Vec<usize> = Vec::new();
        for k in first..=last {
            // A factor that is not needed because the other vanishes is not computed: below
            // the small parameter nothing of order n is asked for.
            let (cheap, k_cheap, dear, k_dear) =
                if degree(&nodes[b]).is_some() { (b, n - k, a, k) } else { (a, k, b, n - k) };
            self.ensure(cheap, k_cheap)?;
            if self.known(cheap, k_cheap).is_some_and(|value| algebra.is_zero(value)) {
                continue;
            }
            self.ensure(dear, k_dear)?;
            range.push(k);
        }
        self.look_ahead(node, [a, b], n)?;
        let ahead = &self.ahead[node];
        let below = ahead.below(n);
        let [once, twice] = self.pairs([a, b], n, &range, |k| k >= below);
        let mut sum = if a == b {
            algebra.coefficient_of_square(&twice, once.first().map(|(c, _)| *c))
        } else {
            algebra.sum_of_products(&once)
        };
        if let Some(ahead) = ahead.sum(n) {
            algebra.add_assign(&mut sum, ahead);
        }
        let formed = |k: &&usize| a != b || 2 * **k <= n;
        let count = range.iter().filter(formed).count();
        self.products += count as u64;
        Ok(sum)
    }

    /// The pairs of order n of a product whose larger order is wanted, once and twice.
    fn pairs(
        &self,
        [a, b]: [NodeId; 2],
        n: usize,
        range: &[usize],
        wanted: impl Fn(usize) -> bool,
    ) -> Products<'_, A::Element> {
        let pair = |&k: &usize| Some((self.known(a, k)?, self.known(b, n - k)?));
        let wanted = range.iter().filter(|&&k| wanted(k.max(n - k)));
        if a != b {
            return [wanted.filter_map(pair).collect(), Vec::new()];
        }
        let middle = wanted.clone().filter(|&&k| 2 * k == n);
        let half = wanted.clone().filter(|&&k| 2 * k < n);
        [middle.filter_map(pair).collect(), half.filter_map(pair).collect()]
    }

    /// Sums of order n of a product, and of some orders after it, where many sums at once cost less than one by one.
    /// Products are counted at their order.
    fn look_ahead(
        &mut self,
        node: NodeId,
        [a, b]: [NodeId; 2],
        n: usize,
    ) -> Result<(), ExpandError> {
        let series = [a, b].iter().all(|factor| degree(&self.equation.nodes[*factor]).is_none());
        let last = self.last.filter(|_| A::SUMS_AT_ONCE && series);
        let Some(next) = last.and_then(|last| self.ahead[node].next(n, last)) else {
            return Ok(());
        };
        let [coefficients, orders] = next.clone();
        for k in 0..coefficients.end {
            self.ensure(a, k)?;
            self.ensure(b, k)?;
        }
        let list = |n: usize| {
            let range: Vec<usize> = (n + 1 - coefficients.end..coefficients.end).collect();
            self.pairs([a, b], n, &range, |k| k >= coefficients.start)
        };
        let lists: Vec<_> = orders.map(list).collect();
        let (algebra, sums) = (self.algebra, self.algebra.sums_of_products(&lists));
        self.ahead[node].take(next, sums, |sum, rest| algebra.add_assign(sum, rest));
        Ok(())
    }

    /// sum_k k a_k b_{n-k} over the range.
    fn weighted(
        &mut self,
        a: NodeId,
        b: NodeId,
        range: Range<usize>,
        n: usize,
    ) -> Result<A::Element, ExpandError> {
        self.weighted_by(a, b, range, n, &|k| Rational::from(k))
    }

    /// sum_k w(k) a_k b_{n-k} over the range.
    fn weighted_by(
        &mut self,
        a: NodeId,
        b: NodeId,
        range: Range<usize>,
        n: usize,
        weight: &dyn Fn(usize) -> Rational,
    ) -> Result<A::Element, ExpandError> {
        let algebra = self.algebra;
        for k in range.clone() {
            self.ensure(a, k)?;
            if self.known(a, k).is_some_and(|value| !algebra.is_zero(value)) {
                self.ensure(b, n - k)?;
            }
        }
        let weights: Vec<A::Element> = range
            .clone()
            .filter_map(|k| Some(algebra.scale(self.known(a, k)?, &weight(k))))
            .collect();
        let zero = algebra.zero();
        let pairs: Vec<_> = weights
            .iter()
            .zip(range)
            .map(|(weight, k)| (weight, self.known(b, n - k).unwrap_or(&zero)))
            .filter(|(weight, _)| !algebra.is_zero(weight))
            .collect();
        let sum = algebra.sum_of_products(&pairs);
        let count = pairs.len() as u64;
        self.products += count;
        Ok(sum)
    }

    /// The derivative of the coefficients of order 0 and 1 of every node when x, x' and their
    /// delayed values change by `direction`; nothing for a variable that does not change.
    pub(crate) fn tangents(
        &mut self,
        direction: &Direction<'_, A>,
    ) -> Result<Vec<[A::Element; 2]>, ExpandError> {
        let algebra = self.algebra;
        let equation = self.equation;
        let still = || [algebra.zero(), algebra.zero()];
        let mut tangents: Vec<[A::Element; 2]> = Vec::new();
        for (id, node) in equation.nodes.iter().enumerate() {
            let product = |this: &mut Self, factor: NodeId, tangent: &[A::Element; 2]| {
                let f = [this.coefficient(factor, 0)?, this.coefficient(factor, 1)?];
                let first = algebra.sum_of_products(&[(&f[0], &tangent[1]), (&f[1], &tangent[0])]);
                Ok::<_, ExpandError>([algebra.mul(&f[0], &tangent[0]), first])
            };
            let tangent = match node {
                Node::Constant(_) | Node::Small | Node::Forcing(_) => still(),
                Node::Displacement | Node::Velocity | Node::Unknown { .. } => {
                    direction(node).unwrap_or_else(still)
                }
                Node::Sum(terms) => {
                    let mut sum = [algebra.zero(), algebra.zero()];
                    for (q, term) in terms {
                        for (s, t) in sum.iter_mut().zip(&tangents[*term]) {
                            algebra.add_assign(s, &algebra.scale(t, q));
                        }
                    }
                    sum
                }
                &Node::Product(a, b) => {
                    let (ta, tb) = (tangents[a].clone(), tangents[b].clone());
                    let [x, y] = [product(self, a, &tb)?, product(self, b, &ta)?];
                    [algebra.add(&x[0], &y[0]), algebra.add(&x[1], &y[1])]
                }
                // d ln y = dy/y: z_0 = t_0/y_0, z_1 = (t_1 - z_0 y_1)/y_0.
                &Node::Logarithm(y) => {
                    let (y0, y1) = (self.coefficient(y, 0)?, self.coefficient(y, 1)?);
                    let inverse = algebra
                        .reciprocal(&y0)
                        .ok_or_else(|| ExpandError::UnsupportedTerm { term: "ln".into() })?;
                    let z0 = algebra.mul(&tangents[y][0], &inverse);
                    let rest = algebra.sub(&tangents[y][1], &algebra.mul(&z0, &y1));
                    [z0, algebra.mul(&rest, &inverse)]
                }
                &Node::Exponential(g) => {
                    let tangent = tangents[g].clone();
                    product(self, id, &tangent)?
                }
                &Node::Formal { derivative, argument, .. } => {
                    let tangent = tangents[argument].clone();
                    product(self, derivative, &tangent)?
                }
                // d y^q = w dy with w = q y^q/y: w_0 = q P_0/y_0, w_1 = (q P_1 - w_0 y_1)/y_0.
                Node::Power(y, q) => {
                    let (y0, y1) = (self.coefficient(*y, 0)?, self.coefficient(*y, 1)?);
                    let inverse = algebra
                        .reciprocal(&y0)
                        .ok_or_else(|| ExpandError::UnsupportedTerm { term: "a power".into() })?;
                    let power = [self.coefficient(id, 0)?, self.coefficient(id, 1)?];
                    let [p0, p1] = power.map(|p| algebra.scale(&p, q));
                    let w0 = algebra.mul(&p0, &inverse);
                    let w1 = algebra.mul(&algebra.sub(&p1, &algebra.mul(&w0, &y1)), &inverse);
                    let [t0, t1] = &tangents[*y];
                    let first = algebra.sum_of_products(&[(&w0, t1), (&w1, t0)]);
                    [algebra.mul(&w0, t0), first]
                }
                &Node::Circular { argument, partner, cosine } => {
                    let tangent = tangents[argument].clone();
                    let [zero, one] = product(self, partner, &tangent)?;
                    if cosine { [algebra.neg(&zero), algebra.neg(&one)] } else { [zero, one] }
                }
            };
            tangents.push(tangent);
        }
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: 0 });
        }
        Ok(tangents)
    }
}
