//! From an expression tree to a graph of recurrences.
//!
//! The equation x'' + F(x, x'; eps) = 0 becomes a list of nodes, each of which can compute its
//! coefficient of eps^n from coefficients of the nodes before it. Equal subexpressions share a
//! node, so that x^3 costs x*x and (x*x)*x, and x^2 + x^4 costs no square twice.

use crate::ExpandError;
use crate::excitation::Excitation;
use lindstedt_algebra::{Elementary, ForcedAlgebra, FunctionAlgebra, RationalAlgebra, Ring};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function, Unknown};
use rug::Rational;

/// The position of a node in the graph.
pub(crate) type NodeId = usize;

/// One operation on power series in the small parameter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Node<E> {
    /// A constant at order zero.
    Constant(E),
    /// The small parameter.
    Small,
    /// x.
    Displacement,
    /// x' (with respect to physical time).
    Velocity,
    /// Another unknown than the first, or an unknown at t - T_delay; or its derivative.
    Unknown {
        /// Which unknown.
        index: usize,
        /// Whether it is the velocity.
        velocity: bool,
        /// The position of the delay in [`Excitation::delays`].
        delay: Option<usize>,
    },
    /// cos(m eta) or sin(m eta) of the forcing phase eta = omega t: a position in [`Equation::forcing`].
    Forcing(usize),
    /// sum q_i node_i.
    Sum(Vec<(Rational, NodeId)>),
    /// The product of two nodes.
    Product(NodeId, NodeId),
    /// ln|node|.
    Logarithm(NodeId),
    /// exp(node); in exact rings without a term of order zero.
    Exponential(NodeId),
    /// node^q for a rational number q that is no natural number.
    Power(NodeId, Rational),
    /// sin(node) or cos(node); `partner` is the other one.
    Circular {
        /// The argument.
        argument: NodeId,
        /// The node of the other function of the same argument.
        partner: NodeId,
        /// Whether this is the cosine.
        cosine: bool,
    },
    /// The j-th derivative F^(j)(node) = sum_n F_{n+j} node^n/n!, node without a term of order
    /// zero, and the constant F_j.
    Formal {
        /// The node of F^(j+1), one position further.
        derivative: NodeId,
        /// The argument.
        argument: NodeId,
        /// F_j.
        leading: E,
    },
}

/// Values for the names that occur in an equation, as constants of the algebra's ring. A name without a
/// value is an error of [`compile`], never zero.
pub trait Binding<C: Ring> {
    /// The constant that a parameter stands for.
    fn parameter(&self, name: &str) -> Option<C::Element>;
    /// F_n of a formal function F; nothing where there are none.
    fn formal(&self, _: &str, _: usize) -> Option<C::Element> {
        None
    }
    /// Whether a parameter is a series in the small parameter that is found with the solution.
    fn is_sought(&self, _: &str) -> bool {
        false
    }
    /// A power of constants that is no natural one, as 1/m; nothing where the ring has none.
    fn power(&self, _: &Expression) -> Option<C::Element> {
        None
    }
}

impl<E> Node<E> {
    /// The node of an unknown or its derivative.
    pub(crate) fn unknown(index: usize, velocity: bool, delay: Option<usize>) -> Self {
        match (index, velocity, delay) {
            (0, false, None) => Self::Displacement,
            (0, true, None) => Self::Velocity,
            _ => Self::Unknown { index, velocity, delay },
        }
    }
}

/// x_j'' + F_j(x, x'; eps) = 0 as a graph of operations with known recurrences in eps; equal
/// subexpressions are one node; `roots` are the F_j.
#[derive(Clone, Debug)]
pub struct Equation<A: FunctionAlgebra> {
    pub(crate) nodes: Vec<Node<<A::Constants as Ring>::Element>>,
    pub(crate) roots: Vec<NodeId>,
    /// The functions of the forcing phase that occur.
    pub(crate) forcing: Vec<A::Element>,
}

impl<A: FunctionAlgebra> Equation<A> {
    /// Whether the velocity occurs.
    pub fn has_velocity(&self) -> bool {
        self.nodes.contains(&Node::Velocity)
    }

    /// F of the first equation.
    pub(crate) fn root(&self) -> NodeId {
        self.roots.first().copied().unwrap_or(0)
    }
}

/// Compiles the left side of `equation = 0` for expansion up to `order`; t and delays are what
/// [`compile_system`] takes.
///
/// # Errors
/// [`ExpandError`] naming the term that cannot be taken or the name without a value.
pub fn compile<A: FunctionAlgebra>(
    algebra: &A,
    equation: &Expression,
    binding: &dyn Binding<A::Constants>,
    order: usize,
) -> Result<Equation<A>, ExpandError> {
    compile_in_time(algebra, std::slice::from_ref(equation), binding, order, (0, &|_| None))
}

/// Compiles the left sides of `equations[j]` = 0, in each of which x_j'' stands alone, with the delays
/// and the forcing phase of the algebra.
///
/// # Errors
/// As [`compile`].
pub fn compile_system<A: ForcedAlgebra>(
    algebra: &A,
    equations: &[Expression],
    binding: &dyn Binding<A::Constants>,
    order: usize,
) -> Result<Equation<A>, ExpandError> {
    let forcing = |multiple| algebra.forcing(multiple);
    compile_in_time(algebra, equations, binding, order, (algebra.delays(), &forcing))
}

/// The number of delays, and (cos m eta, sin m eta) where there is a force.
type Time<'a, E> = (usize, &'a dyn Fn(u32) -> Option<(E, E)>);

fn compile_in_time<A: FunctionAlgebra>(
    algebra: &A,
    equations: &[Expression],
    binding: &dyn Binding<A::Constants>,
    order: usize,
    time: Time<'_, A::Element>,
) -> Result<Equation<A>, ExpandError> {
    let excitation = Excitation::of(&Expression::Sum(equations.to_vec()))?;
    let unknowns = equations.len();
    let (nodes, forcing) = (Vec::new(), Vec::new());
    let mut compiler =
        Compiler { algebra, binding, order, time, excitation, unknowns, nodes, forcing };
    let mut roots = Vec::new();
    for (j, equation) in equations.iter().enumerate() {
        let acceleration = Expression::unknown(j, 2);
        let is_acceleration = |term: &&Expression| **term == acceleration;
        let terms = equation.terms();
        if terms.iter().filter(is_acceleration).count() != 1 {
            return Err(ExpandError::AccelerationNotIsolated {
                term: equation.print("eps", Style::Text),
            });
        }
        let rest: Vec<_> = terms.iter().filter(|t| !is_acceleration(t)).cloned().collect();
        let root = compiler.node(&Expression::Sum(rest))?;
        let equation_degree = degree(&compiler.nodes, root);
        if equation_degree > LARGEST_DEGREE {
            let term = format!("a term of degree {equation_degree}, above {LARGEST_DEGREE},");
            return Err(ExpandError::UnsupportedTerm { term });
        }
        roots.push(root);
    }
    Ok(Equation { nodes: compiler.nodes, roots, forcing: compiler.forcing })
}

/// A larger degree is a different problem, and exponents of the algebras are bounded by it.
const LARGEST_DEGREE: usize = 1000;

/// The degree of a node in x, x' and ln|x|.
fn degree<E>(nodes: &[Node<E>], root: NodeId) -> usize {
    let mut degrees: Vec<usize> = Vec::new();
    for node in nodes {
        degrees.push(match node {
            Node::Constant(_) | Node::Small | Node::Forcing(_) => 0,
            Node::Displacement | Node::Velocity | Node::Unknown { .. } => 1,
            Node::Sum(terms) => terms.iter().map(|(_, t)| degrees[*t]).max().unwrap_or(0),
            Node::Product(a, b) => degrees[*a].saturating_add(degrees[*b]),
            Node::Logarithm(a) | Node::Exponential(a) | Node::Power(a, _) => degrees[*a],
            Node::Circular { argument, .. } => degrees[*argument],
            Node::Formal { argument, .. } => degrees[*argument],
        });
    }
    degrees.get(root).copied().unwrap_or(0)
}

struct Compiler<'a, A: FunctionAlgebra> {
    algebra: &'a A,
    binding: &'a dyn Binding<A::Constants>,
    order: usize,
    time: Time<'a, A::Element>,
    excitation: Excitation,
    unknowns: usize,
    nodes: Vec<Node<<A::Constants as Ring>::Element>>,
    forcing: Vec<A::Element>,
}

impl<A: FunctionAlgebra> Compiler<'_, A> {
    fn push(&mut self, node: Node<<A::Constants as Ring>::Element>) -> NodeId {
        if let Some(found) = self.nodes.iter().position(|known| *known == node) {
            return found;
        }
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn node(&mut self, expression: &Expression) -> Result<NodeId, ExpandError> {
        let constants = self.algebra.constants();
        let unsupported =
            || ExpandError::UnsupportedTerm { term: expression.print("eps", Style::Text) };
        let node = match expression {
            Expression::Number(q) => Node::Constant(constants.rational(q)),
            Expression::Parameter(name) if self.binding.is_sought(name) => {
                Node::unknown(self.unknowns, false, None)
            }
            Expression::Parameter(name) => Node::Constant(
                self.binding
                    .parameter(name)
                    .ok_or_else(|| ExpandError::UnknownName { name: name.clone() })?,
            ),
            Expression::Small => Node::Small,
            Expression::Unknown(unknown) => {
                self.unknown(unknown).ok_or_else(|| match (unknown.derivative, &unknown.delay) {
                    (2, None) => ExpandError::AccelerationNotIsolated { term: "x''".into() },
                    _ => unsupported(),
                })?
            }
            Expression::Sum(terms) => return self.sum(terms),
            Expression::Product(factors) => return self.product(factors),
            Expression::Power(base, exponent) => return self.power(base, exponent),
            Expression::Function(Function::Ln, argument) => return self.logarithm(argument),
            Expression::Function(Function::Exp, argument) => {
                Node::Exponential(self.node(argument)?)
            }
            Expression::Function(function @ (Function::Cos | Function::Sin), argument) => {
                if let Some(forcing) = self.forcing(*function, argument) {
                    return Ok(forcing);
                }
                let cosine = *function == Function::Cos;
                let elementary = if cosine { Elementary::Cos } else { Elementary::Sin };
                let known = self.offered(&elementary) && !argument.contains(&Expression::Time);
                known.then_some(()).ok_or_else(unsupported)?;
                return self.circular(argument, cosine);
            }
            Expression::Function(..) | Expression::Time => return Err(unsupported()),
            Expression::Formal(name, argument) => return self.formal(name, argument),
        };
        Ok(self.push(node))
    }

    /// x, x', or one of them at an earlier time that is known.
    fn unknown(&self, unknown: &Unknown) -> Option<Node<<A::Constants as Ring>::Element>> {
        if unknown.index >= self.unknowns || unknown.derivative > 1 {
            return None;
        }
        let (index, velocity) = (unknown.index, unknown.derivative == 1);
        let delay = match unknown.delay.as_deref() {
            None => None,
            Some(delay) => {
                let known = self.excitation.delays.iter().position(|known| known == delay);
                Some(known.filter(|&delay| delay < self.time.0)?)
            }
        };
        Some(Node::unknown(index, velocity, delay))
    }

    /// cos(m eta), and sin(-m eta) = -sin(m eta).
    fn forcing(&mut self, function: Function, argument: &Expression) -> Option<NodeId> {
        let signed = self.excitation.multiple(argument)?;
        let multiple = u32::try_from(signed.unsigned_abs()).ok()?;
        let (cos, sin) = (self.time.1)(multiple)?;
        let sine = function == Function::Sin;
        let element = if sine { sin } else { cos };
        let known = self.forcing.iter().position(|known| *known == element);
        let index = known.unwrap_or_else(|| {
            self.forcing.push(element);
            self.forcing.len() - 1
        });
        let node = self.push(Node::Forcing(index));
        let sign = Rational::from(if sine && signed < 0 { -1 } else { 1 });
        Some(self.push(Node::Sum(vec![(sign, node)])))
    }

    /// Whether the algebra evaluates this function at all: then it does so at 1.
    fn offered(&self, function: &Elementary) -> bool {
        self.algebra.apply(function, &self.algebra.one()).is_some()
    }

    /// The sine and the cosine, one after the other, and of them the one asked for.
    fn circular(&mut self, argument: &Expression, cosine: bool) -> Result<NodeId, ExpandError> {
        let argument = self.node(argument)?;
        let known = |node: &Node<_>| matches!(node, Node::Circular { argument: a, cosine: false, .. } if *a == argument);
        let sine = self.nodes.iter().position(known).unwrap_or(self.nodes.len());
        if sine == self.nodes.len() {
            self.nodes.push(Node::Circular { argument, partner: sine + 1, cosine: false });
            self.nodes.push(Node::Circular { argument, partner: sine, cosine: true });
        }
        Ok(sine + usize::from(cosine))
    }

    fn sum(&mut self, terms: &[Expression]) -> Result<NodeId, ExpandError> {
        let mut list = Vec::new();
        for term in terms {
            let (factor, rest) = split_number(term);
            list.push((factor, self.node(&rest)?));
        }
        if let [(factor, node)] = &list[..]
            && *factor == 1
        {
            return Ok(*node);
        }
        Ok(self.push(Node::Sum(list)))
    }

    /// Products are taken from the right, so that eps (1 - x^2) x' multiplies the functions
    /// first and shifts the order last.
    fn product(&mut self, factors: &[Expression]) -> Result<NodeId, ExpandError> {
        let (last, rest) = match factors {
            [] => return self.node(&Expression::integer(1)),
            [rest @ .., last] => (last, rest),
        };
        let mut product = self.node(last)?;
        for factor in rest.iter().rev() {
            let node = self.node(factor)?;
            product = self.push(Node::Product(node, product));
        }
        Ok(product)
    }

    /// Natural powers by multiplication, other rational ones where the algebra evaluates them;
    /// otherwise base^exponent = exp(exponent ln base).
    fn power(&mut self, base: &Expression, exponent: &Expression) -> Result<NodeId, ExpandError> {
        if let Expression::Number(q) = exponent {
            let integer = q.is_integer().then(|| q.numer().to_u32()).flatten();
            let unsupported = || {
                let whole = Expression::Power(Box::new(base.clone()), Box::new(exponent.clone()));
                let term = whole.print("eps", Style::Text);
                match base.as_number().is_some_and(|base| base.is_positive()) {
                    true => ExpandError::IrrationalNumber { number: term },
                    false => ExpandError::UnsupportedTerm { term },
                }
            };
            let natural = q.is_integer() && !q.is_negative();
            if !natural && self.offered(&Elementary::Power(q.clone())) {
                let base = self.node(base)?;
                return Ok(self.push(Node::Power(base, q.clone())));
            }
            if !natural && base.is_constant() {
                let whole = Expression::Power(Box::new(base.clone()), Box::new(exponent.clone()));
                if let Some(value) = self.binding.power(&whole) {
                    return Ok(self.push(Node::Constant(value)));
                }
            }
            // Multiplying repeatedly: a power as long as the expansion is a different problem.
            let n = integer.filter(|&n| n <= 1000).ok_or_else(unsupported)?;
            if n == 0 {
                return self.node(&Expression::integer(1));
            }
            let base = self.node(base)?;
            let mut result = None;
            let (mut square, mut n) = (base, n);
            loop {
                if n & 1 == 1 {
                    result = Some(match result {
                        None => square,
                        Some(r) => self.push(Node::Product(r, square)),
                    });
                }
                n >>= 1;
                if n == 0 {
                    break;
                }
                square = self.push(Node::Product(square, square));
            }
            return result.ok_or_else(unsupported);
        }
        let logarithm = self.logarithm(base)?;
        let exponent = self.node(exponent)?;
        let argument = self.push(Node::Product(exponent, logarithm));
        Ok(self.push(Node::Exponential(argument)))
    }

    /// ln y^(2n) = 2n ln|y|, so that the logarithm of the displacement itself is expanded.
    fn logarithm(&mut self, argument: &Expression) -> Result<NodeId, ExpandError> {
        if let Expression::Power(base, exponent) = argument
            && let Expression::Number(q) = &**exponent
            && Rational::from(q / 2u32).is_integer()
        {
            let base = self.node(base)?;
            let logarithm = self.push(Node::Logarithm(base));
            return Ok(self.push(Node::Sum(vec![(q.clone(), logarithm)])));
        }
        let argument = self.node(argument)?;
        Ok(self.push(Node::Logarithm(argument)))
    }

    /// F(z) and its derivatives up to the order of the expansion: F^(j) at order n needs
    /// F^(j+1) at order n - 1.
    fn formal(&mut self, name: &str, argument: &Expression) -> Result<NodeId, ExpandError> {
        let argument = self.node(argument)?;
        let value = |n| {
            let unknown = || ExpandError::UnknownName { name: format!("{name}_{n}") };
            self.binding.formal(name, n).ok_or_else(unknown)
        };
        let leading: Vec<_> = (0..=self.order + 2).map(value).collect::<Result<_, _>>()?;
        // The highest derivative is only ever asked for its constant.
        let mut derivative = None;
        for constant in leading.into_iter().rev() {
            derivative = Some(match derivative {
                None => self.push(Node::Constant(constant)),
                Some(derivative) => {
                    self.push(Node::Formal { derivative, argument, leading: constant })
                }
            });
        }
        derivative.ok_or_else(|| ExpandError::UnknownName { name: name.to_owned() })
    }
}

/// q and the rest of q * rest.
fn split_number(term: &Expression) -> (Rational, Expression) {
    if let Expression::Product(factors) = term
        && let [Expression::Number(q), rest @ ..] = &factors[..]
    {
        let rest = match rest {
            [single] => single.clone(),
            many => Expression::Product(many.to_vec()),
        };
        return (q.clone(), rest);
    }
    (Rational::from(1), term.clone())
}
