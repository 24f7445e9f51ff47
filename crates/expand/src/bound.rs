//! Bounds known before the work: degrees of the functions, and the size of the numbers that a
//! residual can contain. They turn computations modulo primes into proofs.
//!
//! A trigonometric polynomial f = sum_k f_k z^k, z = e^(i psi), is measured by a common
//! denominator of the f_k and by the norm sum |f_k|; sums and products respect both: the
//! denominator of a product divides the product, of a sum the least common multiple, and the
//! norm is submultiplicative. So if a residual vanishes modulo primes whose product exceeds
//! denominator times norm, and none of which divides the denominator, it vanishes.

use crate::compile::{Equation, Node};
use crate::driver::Expansion;
use lindstedt_algebra::{PhaseAlgebra, Ring};
use rug::float::Round;
use rug::ops::{AddAssignRound, MulAssignRound};
use rug::{Float, Integer, Rational};

/// The degree of x_n for n = 0..=order, and of everything formed on the way to order + 1;
/// nothing when the equation is not polynomial.
pub fn degrees<A: PhaseAlgebra>(
    equation: &Equation<A>,
    order: usize,
) -> Option<(Vec<usize>, usize)> {
    let mut of_nodes: Vec<Vec<Option<usize>>> = vec![Vec::new(); equation.nodes.len()];
    let mut of_x: Vec<usize> = Vec::new();
    let mut largest = 1;
    for n in 0..=order + 1 {
        // Twice: the first pass with x_n = 0 gives f_n, and so the degree of x_n.
        for pass in 0..2 {
            for (id, node) in equation.nodes.iter().enumerate() {
                let degree = match node {
                    Node::Constant(_) => (n == 0).then_some(0),
                    Node::Small => (n == 1).then_some(0),
                    // x' = sum omega_k dx_{n-k}/dpsi has the degree of the highest x_k.
                    Node::Displacement | Node::Velocity => of_x.get(n).copied(),
                    Node::Sum(terms) => terms.iter().filter_map(|(_, t)| of_nodes[*t][n]).max(),
                    &Node::Product(a, b) => {
                        (0..=n).filter_map(|k| Some(of_nodes[a][k]? + of_nodes[b][n - k]?)).max()
                    }
                    _ => return None,
                };
                of_nodes[id].truncate(n);
                of_nodes[id].push(degree);
                largest = largest.max(degree.unwrap_or(0));
            }
            if pass == 0 {
                let force = of_nodes[equation.root()][n].unwrap_or(0);
                of_x.push(force.max(of_x.last().copied().unwrap_or(1)));
            }
        }
    }
    of_x.pop();
    Some((of_x, largest))
}

/// The rational numbers that occur in an equation.
fn equation_numbers<A>(equation: &Equation<A>) -> Vec<Rational>
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let of_node = |node: &Node<Rational>| -> Vec<Rational> {
        match node {
            Node::Constant(c) => vec![c.clone()],
            Node::Sum(terms) => terms.iter().map(|(q, _)| q.clone()).collect(),
            _ => Vec::new(),
        }
    };
    equation.nodes.iter().flat_map(of_node).collect()
}

/// A common denominator of the rational numbers that occur in an equation: 1 for x'' + x + eps x^3, 2 for
/// x'' + x/2. A prime that divides it cannot be used.
pub fn equation_denominator<A>(equation: &Equation<A>) -> Integer
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let mut denominator = Integer::from(1);
    for number in equation_numbers(equation) {
        denominator.lcm_mut(number.denom());
    }
    denominator
}

/// A bound on a list of rational Fourier coefficients: a denominator as a product of powers of
/// generators (primes, or whatever is left after the small ones), and a norm.
#[derive(Clone)]
struct Size {
    exponents: Vec<u32>,
    norm: Float,
}

struct Sizes {
    generators: Vec<Integer>,
    order: usize,
}

type List = Vec<Option<Size>>;

/// The number of bits that any numerator in the residual of an expansion can have, over the
/// common denominator; the denominator has no prime factors other than those of the numbers in
/// the equation and in the expansion. Nothing when the equation is not polynomial.
///
/// `coefficients` lists the Fourier coefficients of an element with their harmonics.
pub fn residual_bits<A>(
    equation: &Equation<A>,
    expansion: &Expansion<A>,
    coefficients: impl Fn(&A::Element) -> Vec<(usize, Rational)>,
) -> Option<u64>
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let lists: Vec<Vec<(usize, Rational)>> = expansion.solution.iter().map(coefficients).collect();
    // One order more, for the last condition of a limit cycle.
    let mut squared = expansion.frequency_squared.clone();
    squared.push(Rational::new());
    let mut frequency = vec![Rational::from(1)];
    for n in 1..squared.len() {
        let mut rest = squared[n].clone();
        for k in 1..n {
            rest -= Rational::from(&frequency[k] * &frequency[n - k]);
        }
        frequency.push(rest / 2u32);
    }
    let numbers: Vec<Rational> = lists
        .iter()
        .flatten()
        .map(|(_, c)| c.clone())
        .chain(frequency.iter().cloned())
        .chain(expansion.frequency_squared.iter().cloned())
        .chain([expansion.stiffness.clone()])
        .chain(equation_numbers(equation))
        .collect();
    let sizes = Sizes::new(&numbers, expansion.order() + 1);
    let harmonics = |derivatives: u32| -> List {
        let norm_of = |list: &Vec<(usize, Rational)>| {
            let weigh = |(k, c): &(usize, Rational)| {
                Rational::from(c * Integer::from(Integer::u_pow_u(*k as u32, derivatives)))
            };
            // cos k psi = (z^k + z^-k)/2 adds a factor 2 to the denominator.
            sizes.of_list(list.iter().map(weigh), 1)
        };
        lists.iter().map(norm_of).collect()
    };
    let series = |values: &[Rational]| -> List {
        values.iter().map(|c| sizes.of_list([c.clone()].into_iter(), 0)).collect()
    };
    let (x, slope, curvature) = (harmonics(0), harmonics(1), harmonics(2));
    let velocity = sizes.product(&series(&frequency), &slope);
    let mut of_nodes: Vec<List> = Vec::new();
    for node in &equation.nodes {
        let list = match node {
            Node::Constant(c) => series(std::slice::from_ref(c)),
            Node::Small => vec![None, sizes.of_list([Rational::from(1)].into_iter(), 0)],
            Node::Displacement => x.clone(),
            Node::Velocity => velocity.clone(),
            Node::Sum(terms) => {
                let mut sum = Vec::new();
                for (q, term) in terms {
                    let factor = series(std::slice::from_ref(q));
                    sum = sizes.sum(&sum, &sizes.product(&factor, &of_nodes[*term]));
                }
                sum
            }
            &Node::Product(a, b) => sizes.product(&of_nodes[a], &of_nodes[b]),
            _ => return None,
        };
        of_nodes.push(list);
    }
    let squared: Vec<Rational> = expansion
        .frequency_squared
        .iter()
        .map(|w| Rational::from(w * &expansion.stiffness))
        .collect();
    let inertia = sizes.product(&series(&squared), &curvature);
    let residual = sizes.sum(&inertia, &of_nodes[equation.root()]);
    let bits = residual.iter().flatten().map(|size| sizes.bits(size)).max();
    Some(bits.unwrap_or(0))
}

impl Sizes {
    /// Generators of all denominators: primes up to 2^10, and a pairwise coprime basis of what is
    /// left of the denominators without them.
    fn new(numbers: &[Rational], order: usize) -> Self {
        let primes = (2u32..1024).filter(|n| (2..*n).all(|d| n % d != 0));
        let mut generators: Vec<Integer> = primes.map(Integer::from).collect();
        let mut rests: Vec<Integer> = Vec::new();
        for number in numbers {
            let mut rest = number.denom().clone();
            for prime in &generators {
                rest.remove_factor_mut(prime);
            }
            if rest != 1 {
                refine(&mut rests, rest);
            }
        }
        generators.extend(rests);
        Self { generators, order }
    }

    /// The size of a list of coefficients with one more factor 2^extra in the denominator.
    fn of_list(&self, list: impl Iterator<Item = Rational>, extra: u32) -> Option<Size> {
        let mut norm = Float::new(64);
        let mut denominator = Integer::from(1);
        for c in list {
            denominator.lcm_mut(c.denom());
            norm.add_assign_round(Float::with_val_round(64, c.abs(), Round::Up).0, Round::Up);
        }
        let mut exponents = Vec::new();
        for generator in &self.generators {
            exponents.push(denominator.remove_factor_mut(generator));
        }
        exponents[0] += extra;
        if denominator != 1 {
            // Not a product of generators: no bound, and none is pretended.
            norm = Float::with_val(64, rug::float::Special::Infinity);
        }
        (!norm.is_zero()).then_some(Size { exponents, norm })
    }

    fn sum(&self, a: &List, b: &List) -> List {
        let get = |list: &List, n: usize| list.get(n).cloned().flatten();
        let add = |n| match (get(a, n), get(b, n)) {
            (Some(mut x), Some(y)) => {
                x.absorb(&y);
                Some(x)
            }
            (x, y) => x.or(y),
        };
        (0..a.len().max(b.len())).map(add).collect()
    }

    fn product(&self, a: &List, b: &List) -> List {
        let coefficient = |n: usize| {
            let mut sum: Option<Size> = None;
            for k in 0..=n {
                let (Some(Some(x)), Some(Some(y))) = (a.get(k), b.get(n - k)) else { continue };
                let mut product = x.clone();
                for (e, f) in product.exponents.iter_mut().zip(&y.exponents) {
                    *e += f;
                }
                product.norm.mul_assign_round(&y.norm, Round::Up);
                match &mut sum {
                    None => sum = Some(product),
                    Some(sum) => sum.absorb(&product),
                }
            }
            sum
        };
        let length = (a.len() + b.len()).saturating_sub(1).min(self.order + 1);
        (0..length).map(coefficient).collect()
    }

    /// The bits of denominator times norm, rounded up generously.
    fn bits(&self, size: &Size) -> u64 {
        if !size.norm.is_finite() {
            return u64::MAX;
        }
        let denominator: u64 = self
            .generators
            .iter()
            .zip(&size.exponents)
            .map(|(g, &e)| {
                let bits = Float::with_val(53, g).log2().to_f64() * f64::from(e);
                bits.ceil() as u64 + 1
            })
            .sum();
        let norm = i64::from(size.norm.get_exp().unwrap_or(0)) + 2;
        denominator.saturating_add_signed(norm)
    }
}

/// Adds a number to a basis of pairwise coprime numbers, splitting at common factors, so that it
/// becomes a product of powers of members.
fn refine(basis: &mut Vec<Integer>, number: Integer) {
    let mut pending = vec![number];
    while let Some(n) = pending.pop() {
        if n == 1 || basis.contains(&n) {
            continue;
        }
        let shares = |b: &Integer| Integer::from(b.gcd_ref(&n)) != 1;
        match basis.iter().position(shares) {
            None => basis.push(n),
            Some(index) => {
                let member = basis.swap_remove(index);
                let common = Integer::from(member.gcd_ref(&n));
                pending.push(Integer::from(member.div_exact_ref(&common)));
                pending.push(Integer::from(n.div_exact_ref(&common)));
                pending.push(common);
            }
        }
    }
}

impl Size {
    fn absorb(&mut self, other: &Self) {
        for (e, f) in self.exponents.iter_mut().zip(&other.exponents) {
            *e = (*e).max(*f);
        }
        self.norm.add_assign_round(&other.norm, Round::Up);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn denominators_that_share_large_factors_are_not_lost() {
        // lcm(pq, qr) = pqr is a product of powers of the generators only if pq and qr are split.
        let [p, q, r] = [1_000_003, 1_000_033, 1_000_037].map(Integer::from);
        let numbers = [
            Rational::from((Integer::from(1), Integer::from(&p * &q))),
            Rational::from((Integer::from(1), Integer::from(&q * &r))),
        ];
        let sizes = Sizes::new(&numbers, 1);
        let size = sizes.of_list(numbers.iter().cloned(), 0).unwrap();
        let mut product = Integer::from(1);
        for (g, &e) in sizes.generators.iter().zip(&size.exponents) {
            for _ in 0..e {
                product *= g;
            }
        }
        assert_eq!(product, p * q * r);
        assert!(size.norm.is_finite());
        // A denominator unknown to the generators gives no bound.
        let stranger = sizes.of_list([Rational::from((1, 2_000_003))].into_iter(), 0).unwrap();
        assert_eq!(sizes.bits(&stranger), u64::MAX);
    }

    #[test]
    fn a_cosine_has_denominator_two_in_powers_of_z() {
        // cos^2 psi = (z^2 + 2 + z^-2)/4: denominator 4, norm 1.
        let sizes = Sizes::new(&[], 0);
        let cosine = vec![sizes.of_list([Rational::from(1)].into_iter(), 1)];
        let square = sizes.product(&cosine, &cosine).remove(0).unwrap();
        assert_eq!(square.exponents[0], 2);
        assert_eq!(square.norm, 1);
    }
}
