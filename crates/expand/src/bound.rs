//! Bounds known before the work: degrees of the functions, denominators of the equation.

use crate::compile::{Equation, Node};
use lindstedt_algebra::{PhaseAlgebra, Ring};
use rug::{Integer, Rational};

/// The highest even and the highest odd harmonic, where there are such.
pub type Degrees = [Option<usize>; 2];

/// The degrees of a product.
fn product(a: &Degrees, b: &Degrees) -> Degrees {
    let of = |odd: usize| {
        let pair = |i: usize| Some(a[i]? + b[(odd + i) % 2]?);
        pair(0).max(pair(1))
    };
    [of(0), of(1)]
}

/// The larger ones.
fn larger(a: Degrees, b: Degrees) -> Degrees {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// The degrees of x_n for n = 0..=order, none below those of the order before, and the largest of everything formed on
/// the way to order + 1; nothing when the equation is not polynomial.
pub fn degrees<A: PhaseAlgebra>(
    equation: &Equation<A>,
    order: usize,
) -> Option<(Vec<Degrees>, usize)> {
    let mut of_nodes: Vec<Vec<Degrees>> = vec![Vec::new(); equation.nodes.len()];
    let mut of_x: Vec<Degrees> = Vec::new();
    let mut largest = 1;
    for n in 0..=order + 1 {
        // Twice: the first pass with x_n = 0 gives f_n, and so the degree of x_n.
        for pass in 0..2 {
            for (id, node) in equation.nodes.iter().enumerate() {
                let degrees = match node {
                    Node::Constant(_) => [(n == 0).then_some(0), None],
                    Node::Small => [(n == 1).then_some(0), None],
                    // x' = sum omega_k dx_{n-k}/dpsi has the degree of the highest x_k.
                    Node::Displacement | Node::Velocity => of_x.get(n).copied().unwrap_or_default(),
                    Node::Sum(terms) => {
                        terms.iter().map(|(_, t)| of_nodes[*t][n]).fold([None; 2], larger)
                    }
                    &Node::Product(a, b) => (0..=n)
                        .map(|k| product(&of_nodes[a][k], &of_nodes[b][n - k]))
                        .fold([None; 2], larger),
                    _ => return None,
                };
                of_nodes[id].truncate(n);
                of_nodes[id].push(degrees);
                largest = degrees.into_iter().flatten().fold(largest, usize::max);
            }
            if pass == 0 {
                let force = of_nodes[equation.root()][n];
                of_x.push(larger(force, of_x.last().copied().unwrap_or([None, Some(1)])));
            }
        }
    }
    of_x.pop();
    Some((of_x, largest))
}

/// The rational numbers that occur in an equation.
pub(crate) fn equation_numbers(nodes: &[Node<Rational>]) -> Vec<Rational> {
    let of_node = |node: &Node<Rational>| -> Vec<Rational> {
        match node {
            Node::Constant(c) => vec![c.clone()],
            Node::Sum(terms) => terms.iter().map(|(q, _)| q.clone()).collect(),
            _ => Vec::new(),
        }
    };
    nodes.iter().flat_map(of_node).collect()
}

/// A common denominator of the rational numbers that occur in an equation: 1 for x'' + x + eps x^3, 2 for
/// x'' + x/2. A prime that divides it cannot be used.
pub fn equation_denominator<A>(equation: &Equation<A>) -> Integer
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let mut denominator = Integer::from(1);
    for number in equation_numbers(&equation.nodes) {
        denominator.lcm_mut(number.denom());
    }
    denominator
}
