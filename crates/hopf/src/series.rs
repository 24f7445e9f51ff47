//! The cycle that is born at a Hopf point, order by order.
//!
//! s = omega t, x = eps (e^(is) + e^(-is)) + eps^2 x_2(s) + ..., x_n without the harmonics +-1,
//! alpha = alpha_0 + eps alpha_1 + ..., omega = omega_0 + eps omega_1 + ...
//!
//! D^n x(t - T) has the harmonic (i k omega)^n e^(-i k omega T) x_k, a series in eps as well: E = e^(-i k theta), theta =
//! omega T(alpha), obeys E' = -i k theta' E, so m E_m = -i k sum_j j theta_j E_(m-j). With
//! Lambda_k = sum c(alpha) (i k omega)^n e^(-i k omega T) over the linear terms, Lambda_k = L(i k omega_0; alpha_0) at
//! order zero, the coefficient of eps^m of the equation is
//!
//!   k != 1: L(i k omega_0) x_(m,k) = -(what lower orders give),
//!   k = 1:  L_omega omega_(m-1) + L_alpha alpha_(m-1) = -(what lower orders give),
//!
//! the second a complex equation for two real numbers. Its determinant is |L_alpha|^2 Re(L_lambda/L_alpha), not zero where
//! the root crosses the imaginary axis with a speed. Nothing else is divided by: the series is complete.

use crate::HopfError;
use crate::complex::{ComplexNumbers, Pair};
use crate::equation::{DelayEquation, Factor, Field, derivative, value};
use rug::Rational;

/// A real function of s: the coefficients of e^(iks) for k = 0, 1, ...; those of -k are conjugate.
pub(crate) type Harmonics<E> = Vec<Pair<E>>;

/// The series of a cycle.
#[derive(Clone, Debug)]
pub struct Cycle<E> {
    /// alpha_0, alpha_1, ...
    pub parameter: Vec<E>,
    /// omega_0, omega_1, ...
    pub frequency: Vec<E>,
    /// x_1, x_2, ..., one more than the others: the coefficients of e^(iks), k = 0, 1, ...; those of -k are conjugate.
    pub solution: Vec<Vec<Pair<E>>>,
    /// dlambda/dalpha of the root i omega_0 at alpha_0.
    pub crossing: Pair<E>,
}

/// What depends on alpha and omega alone, as series in eps.
#[derive(Clone)]
struct Scalars<E> {
    alpha: Vec<E>,
    omega: Vec<E>,
    /// omega^n.
    powers: Vec<Vec<E>>,
    /// theta = omega T.
    angles: Vec<Vec<E>>,
    /// c(alpha), by term.
    coefficients: Vec<Vec<E>>,
}

/// What multiplies the harmonic k, as series in eps.
#[derive(Clone)]
struct Harmonic<E> {
    k: usize,
    /// e^(-i k omega T), by delay.
    shifts: Vec<Vec<Pair<E>>>,
    /// (i k omega)^n e^(-i k omega T), by factor.
    multipliers: Vec<Vec<Pair<E>>>,
    /// Lambda_k.
    linear: Vec<Pair<E>>,
}

/// A product of factors, as the product before it times one factor.
struct Product<E> {
    before: Option<usize>,
    /// Its place in the list of factors.
    factor: usize,
    series: Vec<Harmonics<E>>,
}

struct Recursion<'a, F: Field> {
    field: &'a F,
    equation: &'a DelayEquation<F::Element>,
    /// The different factors, and D^n x(t - T) of each.
    factors: Vec<Factor>,
    functions: Vec<Vec<Harmonics<F::Element>>>,
    scalars: Scalars<F::Element>,
    harmonics: Vec<Harmonic<F::Element>>,
    /// x_0 = 0, x_1, ...
    solution: Vec<Harmonics<F::Element>>,
    products: Vec<Product<F::Element>>,
    /// The product of each term with several factors, with the place of the term.
    nonlinear: Vec<(usize, usize)>,
}

/// The two columns of the real equations for omega_n and alpha_n, and the inverse of their determinant.
struct Solvability<E> {
    by_omega: Pair<E>,
    by_alpha: Pair<E>,
    inverse: E,
}

/// The series up to an order in alpha and omega; fewer orders where the observer, told every order, says no.
///
/// # Errors
/// [`HopfError::NoRoot`] where L(i omega_0; alpha_0) does not vanish, [`HopfError::NoSpeed`] where the root does not cross,
/// [`HopfError::Resonant`] where L(i k omega_0) vanishes or cannot be told from zero, [`HopfError::Field`] for a turn that
/// is not in the field.
pub(crate) fn expand<F: Field>(
    field: &F,
    equation: &DelayEquation<F::Element>,
    (alpha, omega): (F::Element, F::Element),
    order: usize,
    observer: &mut dyn FnMut(usize) -> bool,
) -> Result<Cycle<F::Element>, HopfError> {
    let mut run = Recursion::new(field, equation, (alpha, omega))?;
    let solvability = run.solvability()?;
    for n in 1..=order {
        if !observer(n) {
            break;
        }
        run.order(n, &solvability)?;
    }
    // L_omega = i L_lambda, dlambda/dalpha = -L_alpha/L_lambda = -i L_alpha/L_omega.
    let plane = ComplexNumbers(field);
    let slope = plane.reciprocal(&solvability.by_omega).ok_or(HopfError::NoSpeed)?;
    let ratio = plane.mul(&solvability.by_alpha, &slope);
    Ok(Cycle {
        crossing: plane.neg(&plane.differentiated(&ratio, 1, 1)),
        parameter: run.scalars.alpha,
        frequency: run.scalars.omega,
        solution: run.solution.split_off(1),
    })
}

impl<'a, F: Field> Recursion<'a, F> {
    fn new(
        field: &'a F,
        equation: &'a DelayEquation<F::Element>,
        (alpha, omega): (F::Element, F::Element),
    ) -> Result<Self, HopfError> {
        let plane = ComplexNumbers(field);
        let mut factors: Vec<Factor> =
            equation.terms.iter().flat_map(|term| term.factors.clone()).collect();
        factors.sort_unstable();
        factors.dedup();
        let mut products: Vec<Product<F::Element>> = Vec::new();
        let mut nonlinear = Vec::new();
        for (place, term) in equation.terms.iter().enumerate() {
            let mut before = None;
            for factor in &term.factors {
                let factor = factors.iter().position(|known| known == factor).unwrap_or(0);
                let known = products.iter().position(|p| p.before == before && p.factor == factor);
                before = Some(known.unwrap_or_else(|| {
                    products.push(Product { before, factor, series: vec![Vec::new(); 2] });
                    products.len() - 1
                }));
            }
            nonlinear.extend(before.filter(|_| term.factors.len() > 1).map(|p| (place, p)));
        }
        let mut run = Self {
            field,
            equation,
            functions: vec![vec![Vec::new()]; factors.len()],
            factors,
            scalars: Scalars::new(equation),
            harmonics: Vec::new(),
            // x begins with eps.
            solution: vec![Vec::new(), vec![plane.zero(), plane.one()]],
            products,
            nonlinear,
        };
        run.scalars.grow(field, equation, alpha, omega);
        run.prepare(1)?;
        if !plane.may_vanish(&run.harmonics[1].linear[0]) {
            return Err(HopfError::NoRoot);
        }
        run.extend(1);
        Ok(run)
    }

    /// What multiplies the harmonics up to k.
    fn prepare(&mut self, k: usize) -> Result<(), HopfError> {
        let (field, plane) = (self.field, ComplexNumbers(self.field));
        for k in self.harmonics.len()..=k {
            let first = |angle: &Vec<F::Element>| {
                let turn = field.turn(&field.scale(&angle[0], &Rational::from(k)));
                turn.map(|turn| vec![plane.conj(&turn)])
            };
            let shifts: Option<Vec<_>> = self.scalars.angles.iter().map(first).collect();
            let multipliers = vec![Vec::new(); self.factors.len()];
            let shifts = shifts.ok_or(HopfError::Field)?;
            let mut harmonic = Harmonic { k, shifts, multipliers, linear: Vec::new() };
            for _ in &self.scalars.omega {
                harmonic.grow(field, self.equation, &self.factors, &self.scalars);
            }
            self.harmonics.push(harmonic);
        }
        Ok(())
    }

    /// L_omega and L_alpha at the harmonic 1.
    fn solvability(&self) -> Result<Solvability<F::Element>, HopfError> {
        let (field, plane, scalars) = (self.field, ComplexNumbers(self.field), &self.scalars);
        let [alpha, omega] = [&scalars.alpha[0], &scalars.omega[0]];
        let (mut by_omega, mut by_alpha) = (plane.zero(), plane.zero());
        for (term, factor) in self.equation.linear() {
            let (n, shift) = (factor.derivative, &self.harmonics[1].shifts[factor.delay][0]);
            let delay = &self.equation.delays[factor.delay];
            let c = value(field, &term.coefficient, alpha);
            let own = |power: u32| {
                let power = &scalars.powers[power as usize][0];
                plane.differentiated(&plane.times(shift, power), 1, n)
            };
            let turned = plane.neg(&plane.differentiated(&own(n), 1, 1));
            // d/domega of (i omega)^n e^(-i omega T).
            let mut slope = plane.times(&turned, &value(field, delay, alpha));
            if let Some(lower) = n.checked_sub(1) {
                let lower = own(lower).map(|part| field.scale(&part, &Rational::from(n)));
                slope = plane.add(&slope, &lower);
            }
            plane.add_assign(&mut by_omega, &plane.times(&slope, &c));
            let direct = value(field, &derivative(field, &term.coefficient), alpha);
            let through = value(field, &derivative(field, delay), alpha);
            let through = field.mul(&field.mul(&through, omega), &c);
            plane.add_assign(&mut by_alpha, &plane.times(&own(n), &direct));
            plane.add_assign(&mut by_alpha, &plane.times(&turned, &through));
        }
        let determinant = plane.crossed(&by_omega, &by_alpha);
        let inverse = field.reciprocal(&determinant).ok_or(HopfError::NoSpeed)?;
        Ok(Solvability { by_omega, by_alpha, inverse })
    }

    /// x_(n+1), alpha_n and omega_n.
    fn order(&mut self, n: usize, two: &Solvability<F::Element>) -> Result<(), HopfError> {
        let (field, plane, m) = (self.field, ComplexNumbers(self.field), n + 1);
        self.prepare(m)?;
        for place in 0..self.products.len() {
            let next = self.product(place, m);
            self.products[place].series.push(next);
        }
        let mut rest = self.nonlinear(m);
        // Lambda_(1, n) with alpha_n = omega_n = 0 for now.
        let mut trial = self.scalars.clone();
        trial.grow(field, self.equation, field.zero(), field.zero());
        let mut first = self.harmonics[1].clone();
        first.grow(field, self.equation, &self.factors, &trial);
        for (k, sum) in rest.iter_mut().enumerate() {
            let own = if k == 1 { &first.linear } else { &self.harmonics[k].linear };
            for (i, x) in self.known(k, m).filter(|(i, _)| *i > 0) {
                plane.add_assign(sum, &plane.mul(&own[i], x));
            }
        }
        // L_omega omega_n + L_alpha alpha_n = r by Cramer's rule.
        let r = plane.neg(&rest[1]);
        let omega = field.mul(&plane.crossed(&r, &two.by_alpha), &two.inverse);
        let alpha = field.mul(&plane.crossed(&two.by_omega, &r), &two.inverse);
        let mut x = vec![plane.zero(); m + 1];
        // Where L(i k omega_0) = 0 and r = 0 any x_k would do: no solution is the one.
        for (k, r) in rest.iter().enumerate().filter(|(k, _)| *k != 1) {
            let inverse = plane.reciprocal(&self.harmonics[k].linear[0]);
            let inverse = inverse.ok_or(HopfError::Resonant { harmonic: k })?;
            x[k] = plane.neg(&plane.mul(r, &inverse));
        }
        self.solution.push(x);
        self.scalars.grow(field, self.equation, alpha, omega);
        for harmonic in &mut self.harmonics {
            harmonic.grow(field, self.equation, &self.factors, &self.scalars);
        }
        self.extend(m);
        Ok(())
    }

    /// The harmonic k of x_(m - i), with i: those that are there.
    fn known(&self, k: usize, m: usize) -> impl Iterator<Item = (usize, &Pair<F::Element>)> {
        self.solution.iter().enumerate().filter_map(move |(j, x)| {
            let x = x.get(k).filter(|x| !ComplexNumbers(self.field).is_zero(x))?;
            Some((m.checked_sub(j)?, x))
        })
    }

    /// D^n x(t - T) at eps^m, for every factor.
    fn extend(&mut self, m: usize) {
        let plane = ComplexNumbers(self.field);
        for place in 0..self.factors.len() {
            let mut all = vec![plane.zero(); m + 1];
            for (k, sum) in all.iter_mut().enumerate() {
                for (i, x) in self.known(k, m) {
                    let own = &self.harmonics[k].multipliers[place][i];
                    plane.add_assign(sum, &plane.mul(own, x));
                }
            }
            self.functions[place].push(all);
        }
        // A product of one factor is that factor.
        for product in self.products.iter_mut().filter(|p| p.before.is_none()) {
            product.series.clone_from(&self.functions[product.factor]);
        }
    }

    /// The coefficient of eps^m of a product of two factors or more: what is known of them begins with eps.
    fn product(&self, place: usize, m: usize) -> Harmonics<F::Element> {
        let plane = ComplexNumbers(self.field);
        let product = &self.products[place];
        let Some(before) = product.before.map(|place| &self.products[place].series) else {
            return Vec::new();
        };
        let last = &self.functions[product.factor];
        let mut sum = vec![plane.zero(); m + 1];
        for i in 1..m {
            add_product(&plane, &mut sum, &before[i], &last[m - i]);
        }
        sum
    }

    /// What the terms with several factors give at eps^m.
    fn nonlinear(&self, m: usize) -> Harmonics<F::Element> {
        let plane = ComplexNumbers(self.field);
        let mut sum = vec![plane.zero(); m + 1];
        for &(term, place) in &self.nonlinear {
            for (i, c) in self.scalars.coefficients[term].iter().enumerate().take(m - 1) {
                for (total, f) in sum.iter_mut().zip(&self.products[place].series[m - i]) {
                    plane.add_assign(total, &plane.times(f, c));
                }
            }
        }
        sum
    }
}

/// sum += f g.
fn add_product<R: Field>(
    plane: &ComplexNumbers<'_, R>,
    sum: &mut Harmonics<R::Element>,
    f: &Harmonics<R::Element>,
    g: &Harmonics<R::Element>,
) {
    let of = |f: &Harmonics<R::Element>, k: i64| {
        let z = f.get(k.unsigned_abs() as usize).filter(|z| !plane.is_zero(z))?;
        Some(if k < 0 { plane.conj(z) } else { z.clone() })
    };
    let highest = f.len() as i64 - 1;
    for p in -highest..=highest {
        let Some(a) = of(f, p) else { continue };
        for (k, total) in sum.iter_mut().enumerate() {
            if let Some(b) = of(g, k as i64 - p) {
                plane.add_assign(total, &plane.mul(&a, &b));
            }
        }
    }
}

impl<E: Clone + PartialEq> Harmonic<E> {
    /// One coefficient more of everything, of which the scalars have it.
    fn grow<F: Field<Element = E>>(
        &mut self,
        field: &F,
        equation: &DelayEquation<E>,
        factors: &[Factor],
        scalars: &Scalars<E>,
    ) {
        let (plane, m) = (ComplexNumbers(field), self.linear.len());
        for (angle, shift) in scalars.angles.iter().zip(&mut self.shifts) {
            // m E_m = -i k sum_j j theta_j E_(m-j); the first is there.
            if m > 0 {
                let mut sum = plane.zero();
                for j in 1..=m {
                    let weight = field.scale(&angle[j], &Rational::from((j, m)));
                    plane.add_assign(&mut sum, &plane.times(&shift[m - j], &weight));
                }
                shift.push(plane.neg(&plane.differentiated(&sum, self.k as i64, 1)));
            }
        }
        for (factor, multiplier) in factors.iter().zip(&mut self.multipliers) {
            let power = &scalars.powers[factor.derivative as usize];
            let mut sum = plane.zero();
            for (i, w) in power.iter().enumerate().take(m + 1) {
                plane.add_assign(&mut sum, &plane.times(&self.shifts[factor.delay][m - i], w));
            }
            multiplier.push(plane.differentiated(&sum, self.k as i64, factor.derivative));
        }
        let mut sum = plane.zero();
        for (term, c) in equation.terms.iter().zip(&scalars.coefficients) {
            let [factor] = &term.factors[..] else { continue };
            let Some(place) = factors.iter().position(|known| known == factor) else { continue };
            for (i, c) in c.iter().enumerate().take(m + 1) {
                plane.add_assign(&mut sum, &plane.times(&self.multipliers[place][m - i], c));
            }
        }
        self.linear.push(sum);
    }
}

impl<E: Clone + PartialEq> Scalars<E> {
    fn new<C>(equation: &DelayEquation<C>) -> Self {
        Self {
            alpha: Vec::new(),
            omega: Vec::new(),
            powers: vec![Vec::new(); equation.order as usize + 1],
            angles: vec![Vec::new(); equation.delays.len()],
            coefficients: vec![Vec::new(); equation.terms.len()],
        }
    }

    /// One coefficient more of everything.
    fn grow<F: Field<Element = E>>(
        &mut self,
        field: &F,
        equation: &DelayEquation<E>,
        alpha: E,
        omega: E,
    ) {
        self.alpha.push(alpha);
        self.omega.push(omega);
        let m = self.alpha.len() - 1;
        let convolved = |a: &[E], b: &[E]| {
            let pairs: Vec<_> = (0..=m).map(|i| (&a[i], &b[m - i])).collect();
            field.sum_of_products(&pairs)
        };
        for n in 0..self.powers.len() {
            let next = match n.checked_sub(1) {
                None => field.rational(&Rational::from(u8::from(m == 0))),
                Some(lower) => convolved(&self.powers[lower], &self.omega),
            };
            self.powers[n].push(next);
        }
        for (angle, delay) in self.angles.iter_mut().zip(&equation.delays) {
            let later = composed(field, delay, &self.alpha);
            angle.push(convolved(&later, &self.omega));
        }
        for (c, term) in self.coefficients.iter_mut().zip(&equation.terms) {
            c.extend(composed(field, &term.coefficient, &self.alpha).pop());
        }
    }
}

/// p(alpha(eps)) to the length of alpha, by Horner's rule.
fn composed<F: Field>(field: &F, p: &[F::Element], alpha: &[F::Element]) -> Vec<F::Element> {
    let mut all = vec![field.zero(); alpha.len()];
    for c in p.iter().rev() {
        let coefficient = |m: usize| {
            let pairs: Vec<_> = (0..=m).map(|i| (&all[i], &alpha[m - i])).collect();
            field.sum_of_products(&pairs)
        };
        let mut next: Vec<_> = (0..alpha.len()).map(coefficient).collect();
        field.add_assign(&mut next[0], c);
        all = next;
    }
    all
}
