//! The Floquet exponent of a limit cycle, by Liouville's theorem.
//!
//! Of x'' + F(x, x'; eps) = 0 one exponent is 0, and the other is the mean of -dF/dx' over a period. With x(tau) and
//! x' = omega dx/dtau known to an order, that of every term x^i x'^j is omega^j <x^i (dx/dtau)^j>, and the last of its
//! products is formed only as a mean: of van der Pol's equation none is formed in full.

use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Rationals, Ring};
use lindstedt_equation::Expression;
use lindstedt_equation::monomials::expand;
use lindstedt_multimodular::{Function, Proved};
use lindstedt_phase::Trigonometric;
use lindstedt_phase::trigonometric::TrigonometricPolynomial;
use lindstedt_series::Series;
use rayon::prelude::*;
use rug::{Integer, Rational};
use std::borrow::Cow;
use std::iter::repeat_n;

type Constant<A> = <<A as FunctionAlgebra>::Constants as Ring>::Element;

type Mean<'a, P, C> = dyn Fn(&[(&P, &P)]) -> Option<C> + Sync + 'a;

/// The orders of x^i (dx/dtau)^j by i and j, and the mean of a sum of products.
struct Means<'a, P, C> {
    product: &'a dyn Fn([usize; 2]) -> Vec<P>,
    mean: &'a Mean<'a, P, C>,
}

impl<P: Sync, C: Clone + PartialEq + std::fmt::Debug + Send + Sync> Means<'_, P, C> {
    /// lambda_0, lambda_1, ... per unit of t, with omega; nothing where dF/dx' is no polynomial with rational coefficients.
    fn exponent<R: RationalAlgebra<Element = C>>(
        &self,
        constants: &R,
        equation: &Expression,
        omega: &Series<C>,
    ) -> Option<Vec<C>> {
        let order = omega.known().checked_sub(1)?;
        let all = expand(equation)?;
        if all.atoms.values().any(|e| e.contains(&Expression::VELOCITY)) {
            return None;
        }
        let mut sum = vec![constants.zero(); order + 1];
        for (m, q) in all.terms.iter().filter(|(m, _)| m.velocity > 0) {
            if !m.atoms.is_empty() || !m.parameters.is_empty() {
                return None;
            }
            let (i, j) = (m.x as usize, m.velocity as usize - 1);
            let half = [i / 2, (i % 2 + j) / 2];
            let [left, right] = [half, [i - half[0], j - half[1]]].map(self.product);
            let at = |n: usize| {
                let pair = |k: usize| Some((left.get(k)?, right.get(n - k)?));
                (self.mean)(&(0..=n).filter_map(pair).collect::<Vec<_>>())
            };
            let means: Option<Vec<_>> = (0..=order).into_par_iter().map(at).collect();
            let means =
                (0..j).fold(Series::truncated(means?), |mean, _| mean.mul(constants, omega, order));
            let factor = Rational::from(q * -i64::from(m.velocity));
            let places = sum.iter_mut().skip(m.order as usize);
            for (sum, mean) in places.zip(&means.coefficients) {
                constants.add_assign(sum, &constants.scale(mean, &factor));
            }
        }
        Some(sum)
    }
}

/// The orders of x^i (dx/dtau)^j.
fn product<A: PhaseAlgebra>(
    algebra: &A,
    x: &Series<A::Element>,
    [i, j]: [usize; 2],
) -> Vec<A::Element> {
    let slope = x.map(|x| algebra.derivative(x));
    let one = Series::polynomial(vec![algebra.one()]);
    let factors = repeat_n(x, i).chain(repeat_n(&slope, j));
    let last = x.known().saturating_sub(1);
    factors.fold(one, |product, f| product.mul(algebra, f, last)).coefficients
}

/// A number times a small factor.
type Scaled<'a> = (i64, Cow<'a, Integer>);

/// Numerators of the cosines and sines over one denominator, each times a small factor: those of a long expansion are not copied.
struct Whole<'a> {
    denominator: Cow<'a, Integer>,
    harmonics: [Vec<Scaled<'a>>; 2],
}

/// A common multiple: few are greater than those before, and a division costs less than a greatest common divisor.
fn enlarge(multiple: &mut Integer, by: &Integer) {
    if !multiple.is_divisible(by) {
        multiple.lcm_mut(by);
    }
}

impl<'a> Whole<'a> {
    fn new(f: &TrigonometricPolynomial<Rational>) -> Self {
        let mut denominator = Integer::from(1);
        f.cos.iter().chain(&f.sin).for_each(|c| enlarge(&mut denominator, c.denom()));
        let numerator = |c: &Rational| {
            let own = c.numer() * Integer::from(denominator.div_exact_ref(c.denom()));
            (1, Cow::Owned(own))
        };
        let harmonics = [&f.cos, &f.sin].map(|list| list.iter().map(numerator).collect());
        Self { denominator: Cow::Owned(denominator), harmonics }
    }

    /// A function or, with j = 1, its derivative.
    fn of(f: &'a Function, j: usize) -> Self {
        let (denominator, terms) = f.numerators();
        let mut harmonics = [const { Vec::new() }; 2];
        for (k, sine, c) in terms {
            // cos' = -sin, sin' = cos.
            let factor = if j == 0 { 1 } else { k as i64 * if sine { 1 } else { -1 } };
            let list: &mut Vec<_> = &mut harmonics[usize::from(sine) ^ j];
            list.resize_with(list.len().max(k + 1), || (0, Cow::Owned(Integer::new())));
            list[k] = (factor, Cow::Borrowed(c));
        }
        Self { denominator: Cow::Borrowed(denominator), harmonics }
    }

    /// 2 <f g> times both denominators: <1> = 2 <cos^2>.
    fn twice_mean(&self, other: &Self) -> Integer {
        let mut sum = Integer::new();
        let mut add = |((m, f), (n, g)): (&Scaled<'_>, &Scaled<'_>)| match (m, n) {
            (1, 1) => sum += &**f * &**g,
            _ => sum += Integer::from(&**f * &**g) * m * n,
        };
        for (f, g) in self.harmonics.iter().zip(&other.harmonics) {
            f.iter().zip(g).for_each(&mut add);
        }
        self.harmonics[0].iter().zip(&other.harmonics[0]).take(1).for_each(add);
        sum
    }

    fn mean(pairs: &[(&Self, &Self)]) -> Rational {
        let of = |(f, g): &(&Self, &Self)| {
            let sum = f.twice_mean(g);
            (!sum.is_zero()).then(|| (sum, Integer::from(&*f.denominator * &*g.denominator)))
        };
        let parts: Vec<_> = pairs.iter().filter_map(of).collect();
        let mut denominator = Integer::from(1);
        parts.iter().for_each(|(_, own)| enlarge(&mut denominator, own));
        let over =
            |(sum, own): (Integer, Integer)| sum * Integer::from(denominator.div_exact_ref(&own));
        let sum: Integer = parts.into_iter().map(over).sum();
        Rational::from((sum, denominator * 2u32))
    }
}

/// Of a cycle over Q, whose equation has linear stiffness 1.
pub(crate) fn proved_exponent(equation: &Expression, cycle: &Proved) -> Option<Vec<Rational>> {
    let algebra = Trigonometric::new(Rationals);
    let orders = |[i, j]: [usize; 2]| match i + j {
        0 => vec![Whole::new(&algebra.one())],
        1 => cycle.solution.iter().map(|f| Whole::of(f, j)).collect(),
        _ => {
            let x = Series::truncated(cycle.expansion().solution);
            product(&algebra, &x, [i, j]).iter().map(Whole::new).collect()
        }
    };
    let mean = |pairs: &[(&Whole<'_>, &Whole<'_>)]| Some(Whole::mean(pairs));
    let omega = Series::truncated(cycle.frequency.clone());
    let means = Means { product: &orders, mean: &mean };
    (cycle.stiffness == 1).then(|| means.exponent(&Rationals, equation, &omega))?
}

/// Of values: 2 <f> = <2 f cos^2> + <2 f sin^2>.
pub(crate) fn estimated_exponent<A: PhaseAlgebra>(
    algebra: &A,
    equation: &Expression,
    solution: Vec<A::Element>,
    omega: &Series<Constant<A>>,
) -> Option<Vec<Constant<A>>> {
    let mean = |pairs: &[(&A::Element, &A::Element)]| {
        let f = algebra.sum_of_products(pairs);
        let (cosine, _) = algebra.first_harmonic(&algebra.mul(&f, &algebra.cosine())).ok()?;
        let (_, sine) = algebra.first_harmonic(&algebra.mul(&f, &algebra.sine())).ok()?;
        let constants = algebra.constants();
        Some(constants.scale(&constants.add(&cosine, &sine), &Rational::from((1, 2))))
    };
    let x = Series::truncated(solution);
    let orders = |powers| product(algebra, &x, powers);
    let means = Means { product: &orders, mean: &mean };
    means.exponent(algebra.constants(), equation, omega)
}
