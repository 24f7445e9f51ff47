//! The period of a conservative polynomial equation by its energy integral, without any x_n.
//!
//! For x'' + kappa x + sum eps^m F_m(x) = 0 from x(0) = 1 at rest energy gives
//!
//!   x'^2 = kappa (1 - x^2) (1 + h),   h = sum_m eps^m r_m(x)/(1 + x),
//!   r_m = sum_k 2 F_mk/(kappa (k + 1)) (1 + x + ... + x^k),
//!
//! and sqrt(kappa) T/2pi is the integral of (1 + h)^(-1/2) dx/(2 pi sqrt(1 - x^2)) around the cut from -1 to 1:
//! the contour does not feel that the other turning point moves with eps. With x = (z + 1/z)/2 that is the
//! constant term of (1 + h)^(-1/2) for |z| > 1, where 1/(1 + x) = 2/z (1 + 1/z)^(-2).
//!
//! S = (1 + h)^(-1/2) obeys 2n S_n = -sum_m (2n - m) h_m S_(n-m). Where s^m h_m has integer coefficients
//! divisible by 4, all s^n S_n have integer ones, because those of (1 + 4y)^(-1/2) are.

use crate::ExpandError;
use crate::compile::{Equation, Node};
use lindstedt_algebra::{PhaseAlgebra, Ring, Stop};
use rug::{Integer, Rational};
use std::collections::BTreeMap;

/// The frequency and the period of a conservative oscillation as power series in eps, exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// kappa, the linear stiffness.
    pub stiffness: Rational,
    /// W_n: omega^2 = kappa sum W_n eps^n.
    pub frequency_squared: Vec<Rational>,
    /// omega/sqrt(kappa).
    pub frequency: Vec<Rational>,
    /// sqrt(kappa) T/2pi.
    pub period_over_2pi: Vec<Rational>,
}

/// A polynomial in eps and x: coefficients by exponents.
type Polynomial = BTreeMap<(usize, usize), Rational>;

/// The period of x'' + F(x; eps) = 0, x(0) = 1, x'(0) = 0, for a polynomial F, up to eps^order.
///
/// Exact. Cost: d^2 N^2 products of a number of O(N) bits by a small one for a force of degree d, then N^2 products
/// of such numbers. The route shares nothing with the driver's.
///
/// # Errors
/// [`ExpandError::UnsupportedTerm`] where the force is no polynomial of x and eps,
/// [`ExpandError::NotWeaklyNonlinear`] where it is not kappa x at eps = 0,
/// [`ExpandError::NoStiffness`] where kappa = 0, [`ExpandError::Interrupted`] when stopped.
///
/// ```
/// use lindstedt_algebra::{Rationals, Stop};
/// use lindstedt_equation::Expression;
/// use lindstedt_expand::{Binding, compile, conservative_period};
/// use lindstedt_phase::Trigonometric;
/// use rug::Rational;
///
/// struct NoNames;
/// impl Binding<Rationals> for NoNames {
///     fn parameter(&self, _: &str) -> Option<Rational> { None }
/// }
/// let (algebra, x) = (Trigonometric::new(Rationals), Expression::DISPLACEMENT);
/// let duffing = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let equation = compile(&algebra, &duffing, &NoNames, 2)?;
/// let period = conservative_period(&equation, 2, &Stop::default())?;
/// assert_eq!(period.frequency[1..], [Rational::from((3, 8)), Rational::from((-21, 256))]);
/// # Ok::<(), lindstedt_expand::ExpandError>(())
/// ```
pub fn conservative_period<A>(
    equation: &Equation<A>,
    order: usize,
    stop: &Stop,
) -> Result<Period, ExpandError>
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let force = force(equation, order)?;
    let linear = |(&(m, k), c): (&(usize, usize), &Rational)| (m == 0 && k == 1).then(|| c.clone());
    let stiffness = force.iter().find_map(linear).unwrap_or_default();
    if force.keys().any(|&(m, k)| m == 0 && k != 1) {
        return Err(ExpandError::NotWeaklyNonlinear);
    }
    if stiffness.is_zero() {
        return Err(ExpandError::NoStiffness);
    }
    let factors = Factors::new(&force, &stiffness);
    let period = factors.constant_terms(order, stop)?;
    let interrupted = || ExpandError::Interrupted { order };
    let frequency = reciprocal(&period, stop).ok_or_else(interrupted)?;
    let squared = square(&frequency, stop).ok_or_else(interrupted)?;
    let rational = |list: Vec<Integer>| {
        let mut scale = Integer::from(1);
        let mut coefficients = Vec::with_capacity(list.len());
        for c in list {
            coefficients.push(Rational::from((c, scale.clone())));
            scale *= &factors.scale;
        }
        coefficients
    };
    Ok(Period {
        stiffness,
        frequency_squared: rational(squared),
        frequency: rational(frequency),
        period_over_2pi: rational(period),
    })
}

/// F as a polynomial, up to eps^order.
fn force<A>(equation: &Equation<A>, order: usize) -> Result<Polynomial, ExpandError>
where
    A: PhaseAlgebra,
    A::Constants: Ring<Element = Rational>,
{
    let unsupported = || ExpandError::UnsupportedTerm {
        term: "a force that is no polynomial of the displacement alone".into(),
    };
    let one = || Rational::from(1);
    let mut nodes: Vec<Polynomial> = Vec::new();
    for node in &equation.nodes {
        let mut value = Polynomial::new();
        match node {
            Node::Constant(c) => drop(value.insert((0, 0), c.clone())),
            Node::Small => drop(value.insert((1, 0), one())),
            Node::Displacement => drop(value.insert((0, 1), one())),
            Node::Sum(terms) => {
                for (q, term) in terms {
                    for (&exponents, c) in &nodes[*term] {
                        *value.entry(exponents).or_default() += Rational::from(q * c);
                    }
                }
            }
            &Node::Product(a, b) => {
                for (&(m, k), c) in &nodes[a] {
                    for (&(n, l), d) in nodes[b].iter().filter(|((n, _), _)| m + n <= order) {
                        *value.entry((m + n, k + l)).or_default() += Rational::from(c * d);
                    }
                }
            }
            _ => return Err(unsupported()),
        }
        value.retain(|_, c| !c.is_zero());
        nodes.push(value);
    }
    nodes.into_iter().nth(equation.root()).ok_or_else(unsupported)
}

/// The s^m h_m as Laurent polynomials in z^stride.
struct Factors {
    scale: Integer,
    /// m, and the coefficients of z^(stride i), i = -reach, ..., reach.
    factors: Vec<(usize, Vec<Integer>)>,
    reach: usize,
    /// Whether r_m/(1 + x) is no polynomial: then the factors are those of (1 + x) h_m/2.
    divides: bool,
}

impl Factors {
    fn new(force: &Polynomial, stiffness: &Rational) -> Self {
        // Odd powers alone: r_m is divisible by 1 + x, and what is left is even.
        let divides = force.keys().any(|(_, k)| k % 2 == 0);
        let (step, stride) = if divides { (1, 1) } else { (2, 2) };
        let mut by_order: BTreeMap<usize, Vec<Rational>> = BTreeMap::new();
        let degree = force.keys().map(|(_, k)| *k).max().unwrap_or(1);
        for (&(m, k), c) in force.iter().filter(|((m, _), _)| *m > 0) {
            let weight = Rational::from(c * 2u32) / (stiffness * Rational::from(k + 1));
            let list = by_order.entry(m).or_insert_with(|| vec![Rational::new(); degree + 1]);
            // (1 + x + ... + x^k)/(1 + x) = 1 + x^2 + ... + x^(k-1).
            let last = if divides { k } else { k - 1 };
            (0..=last).step_by(step).for_each(|power| list[power] += &weight);
        }
        let reach = if divides { degree } else { (degree - 1) / 2 };
        let in_z = |list: &Vec<Rational>| -> Vec<Rational> {
            let mut sums = vec![Rational::new(); 2 * reach + 1];
            for (power, c) in list.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
                // x^power = 2^-power sum_i binomial(power, i) z^(power - 2i).
                let unit: Rational = c.clone() >> power as u32;
                for i in 0..=power {
                    let exponent = power as i64 - 2 * i as i64;
                    let place = (exponent / stride + reach as i64) as usize;
                    let binomial = Integer::from(power).binomial(i as u32);
                    sums[place] += Rational::from(&unit * binomial);
                }
            }
            sums
        };
        let lists: Vec<(usize, Vec<Rational>)> =
            by_order.iter().map(|(&m, list)| (m, in_z(list))).collect();
        let mut common = Integer::from(1);
        for c in lists.iter().flat_map(|(_, list)| list) {
            common.lcm_mut(c.denom());
        }
        let scale = common * 4u32;
        let scaled = |(m, list): (usize, Vec<Rational>)| {
            let power = Integer::from(rug::ops::Pow::pow(&scale, m as u32));
            let integer = |c: Rational| (c * &power).numer().clone();
            (m, list.into_iter().map(integer).collect())
        };
        let factors = lists.into_iter().map(scaled).collect();
        Self { scale, factors, reach, divides }
    }

    /// s^n times the constant term of S_n, n = 0, ..., order.
    fn constant_terms(&self, order: usize, stop: &Stop) -> Result<Vec<Integer>, ExpandError> {
        let depth = self.factors.iter().map(|(m, _)| *m).max().unwrap_or(1);
        // The last orders, each from the lowest power that can still rise to z^0; order n rises to reach n.
        let mut orders = vec![self.row(0, order, |power| Integer::from(i32::from(power == 0)))];
        let mut constants = vec![Integer::from(1)];
        for n in 1..=order {
            if stop.asked() {
                return Err(ExpandError::Interrupted { order: n });
            }
            let mut sums = self.row(n, order, |_| Integer::new());
            for (m, factor) in self.factors.iter().filter(|(m, _)| *m <= n) {
                let weight = -(2 * n as i64 - *m as i64);
                let source = &orders[orders.len() - m];
                let shift = self.lowest(n, order) - self.lowest(n - m, order);
                self.add_product(&mut sums, source, factor, shift, weight);
            }
            if self.divides {
                divide(&mut sums);
            }
            sums.iter_mut().for_each(|sum| sum.div_exact_u_mut(2 * n as u32));
            let zero = -self.lowest(n, order);
            constants.push(sums.get(zero as usize).cloned().unwrap_or_default());
            orders.push(sums);
            if orders.len() > depth {
                orders.remove(0);
            }
        }
        Ok(constants)
    }

    /// The lowest power of S_n that is kept.
    fn lowest(&self, n: usize, order: usize) -> i64 {
        -((self.reach * (order - n)) as i64)
    }

    fn row(&self, n: usize, order: usize, value: impl Fn(i64) -> Integer) -> Vec<Integer> {
        let highest = (self.reach * n) as i64;
        // A symmetric one need not rise above what can still sink to z^0.
        let highest = if self.divides { highest } else { highest.min(-self.lowest(n, order)) };
        (self.lowest(n, order)..=highest).map(value).collect()
    }

    /// sums += weight factor source, where place i of the sums is the power of place i + shift of the source.
    fn add_product(
        &self,
        sums: &mut [Integer],
        source: &[Integer],
        factor: &[Integer],
        shift: i64,
        weight: i64,
    ) {
        let reach = self.reach as i64;
        for (tap, c) in factor.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
            let c = Integer::from(c * weight);
            let offset = shift - (tap as i64 - reach);
            for (place, sum) in sums.iter_mut().enumerate() {
                let Ok(from) = usize::try_from(place as i64 + offset) else { continue };
                let Some(value) = source.get(from) else { break };
                if !value.is_zero() {
                    *sum += &c * value;
                }
            }
        }
    }
}

/// Times 2/z (1 + 1/z)^(-2), from the highest power downwards: b_k = 2 a_(k+1) - 2 b_(k+1) - b_(k+2).
fn divide(list: &mut [Integer]) {
    let (mut above, mut second, mut third) = (Integer::new(), Integer::new(), Integer::new());
    for value in list.iter_mut().rev() {
        let next = Integer::from(&above << 1) - Integer::from(&second << 1) - third;
        above = std::mem::replace(value, next.clone());
        third = std::mem::replace(&mut second, next);
    }
}

/// The reciprocal of a series that begins with 1.
fn reciprocal(series: &[Integer], stop: &Stop) -> Option<Vec<Integer>> {
    let mut inverse = vec![Integer::from(1)];
    for n in 1..series.len() {
        let mut sum = Integer::new();
        for k in 1..=n {
            sum -= &series[k] * &inverse[n - k];
        }
        inverse.push(sum);
        (!stop.asked()).then_some(())?;
    }
    Some(inverse)
}

fn square(series: &[Integer], stop: &Stop) -> Option<Vec<Integer>> {
    let coefficient = |n: usize| {
        let mut sum = Integer::new();
        for k in 0..n.div_ceil(2) {
            sum += &series[k] * &series[n - k];
        }
        sum <<= 1;
        if n.is_multiple_of(2) {
            sum += Integer::from(series[n / 2].square_ref());
        }
        (!stop.asked()).then_some(sum)
    };
    (0..series.len()).map(coefficient).collect()
}
