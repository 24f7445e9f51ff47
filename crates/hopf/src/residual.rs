//! The judge of [`expand`](crate::series::expand): the complete series put into the equation.

use crate::complex::{ComplexNumbers, Pair};
use crate::equation::{DelayEquation, Factor, Field};
use crate::series::Cycle;
use rug::Rational;
use std::collections::BTreeMap;

/// Whether the series, put into the equation, leave nothing at all their orders, 1 to the length of the solution.
///
/// Another route: every function is a polynomial in eps and e^(+-is) multiplied out in full, no order is split off,
/// conjugates are not used, and e^(-i k theta) = e^(-i k theta_0) sum_p (-i k (theta - theta_0))^p/p!.
///
/// Nothing where `goes_on`, asked before every product of two harmonics, says no.
pub(crate) fn vanishes<F: Field>(
    field: &F,
    equation: &DelayEquation<F::Element>,
    cycle: &Cycle<F::Element>,
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<bool> {
    let judge = Judge { field, length: cycle.solution.len() };
    let mut total: Whole<F::Element> = BTreeMap::new();
    for term in &equation.terms {
        let c = judge.polynomial(&term.coefficient, &cycle.parameter);
        let mut product: Whole<F::Element> = BTreeMap::from([(0, c)]);
        for factor in &term.factors {
            let function = judge.factor(equation, cycle, *factor)?;
            product = judge.product(&product, &function, goes_on)?;
        }
        for (k, series) in product {
            let sum = total.entry(k).or_insert_with(|| judge.zeros());
            sum.iter_mut().zip(&series).for_each(|(a, b)| ComplexNumbers(field).add_assign(a, b));
        }
    }
    Some(total.values().flatten().all(|z| ComplexNumbers(field).may_vanish(z)))
}

/// By harmonic, from -k to k: the coefficients of 1, eps, ..., eps^N.
type Whole<E> = BTreeMap<i64, Vec<Pair<E>>>;

struct Judge<'a, F> {
    field: &'a F,
    /// N.
    length: usize,
}

impl<F: Field> Judge<'_, F> {
    fn zeros(&self) -> Vec<Pair<F::Element>> {
        vec![ComplexNumbers(self.field).zero(); self.length + 1]
    }

    /// The product of two series.
    fn times(&self, a: &[Pair<F::Element>], b: &[Pair<F::Element>]) -> Vec<Pair<F::Element>> {
        let plane = ComplexNumbers(self.field);
        let mut sum = self.zeros();
        for (i, z) in a.iter().enumerate().filter(|(_, z)| !plane.is_zero(z)) {
            for (w, total) in b.iter().zip(&mut sum[i..]) {
                plane.add_assign(total, &plane.mul(z, w));
            }
        }
        sum
    }

    fn product(
        &self,
        f: &Whole<F::Element>,
        g: &Whole<F::Element>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Whole<F::Element>> {
        let mut all: Whole<F::Element> = BTreeMap::new();
        for (k, a) in f {
            for (l, b) in g {
                if !goes_on() {
                    return None;
                }
                let sum = all.entry(k + l).or_insert_with(|| self.zeros());
                let own = self.times(a, b);
                sum.iter_mut()
                    .zip(&own)
                    .for_each(|(a, b)| ComplexNumbers(self.field).add_assign(a, b));
            }
        }
        Some(all)
    }

    /// A real series as a complex one.
    fn whole(&self, a: &[F::Element]) -> Vec<Pair<F::Element>> {
        let mut all = self.zeros();
        all.iter_mut().zip(a).for_each(|(z, a)| z[0] = a.clone());
        all
    }

    /// p(alpha) by powers of alpha.
    fn polynomial(&self, p: &[F::Element], alpha: &[F::Element]) -> Vec<Pair<F::Element>> {
        let (plane, alpha) = (ComplexNumbers(self.field), self.whole(alpha));
        let (mut power, mut sum) = (self.whole(&[self.field.one()]), self.zeros());
        for c in p {
            for (total, z) in sum.iter_mut().zip(&power) {
                plane.add_assign(total, &plane.times(z, c));
            }
            power = self.times(&power, &alpha);
        }
        sum
    }

    /// D^n x(t - T).
    fn factor(
        &self,
        equation: &DelayEquation<F::Element>,
        cycle: &Cycle<F::Element>,
        factor: Factor,
    ) -> Option<Whole<F::Element>> {
        let (field, plane) = (self.field, ComplexNumbers(self.field));
        let omega = self.whole(&cycle.frequency);
        let later = self.polynomial(&equation.delays[factor.delay], &cycle.parameter);
        let mut angle = self.times(&omega, &later);
        let start = std::mem::replace(&mut angle[0], plane.zero())[0].clone();
        let highest = self.length as i64;
        let mut found = BTreeMap::new();
        for k in -highest..=highest {
            let place = k.unsigned_abs() as usize;
            let mut series = self.zeros();
            for (z, x) in series[1..].iter_mut().zip(&cycle.solution) {
                *z = x.get(place).cloned().unwrap_or_else(|| plane.zero());
                if k < 0 {
                    z[1] = field.neg(&z[1]);
                }
            }
            if series.iter().all(|z| plane.is_zero(z)) {
                continue;
            }
            let turned = |z: &Pair<F::Element>, q: &Rational| {
                [field.scale(&z[1], &Rational::from(-q)), field.scale(&z[0], q)]
            };
            // sum_p (-i k (theta - theta_0))^p/p!, then e^(-i k theta_0).
            let (mut term, mut shift) = (self.whole(&[field.one()]), self.zeros());
            for p in 1..=self.length + 1 {
                shift.iter_mut().zip(&term).for_each(|(a, b)| plane.add_assign(a, b));
                let next = self.times(&term, &angle);
                term = next.iter().map(|z| turned(z, &Rational::from((-k, p)))).collect();
            }
            let first = field.turn(&field.scale(&start, &Rational::from(-k)))?;
            series = self.times(&series, &shift);
            series = series.iter().map(|z| plane.mul(z, &first)).collect();
            for _ in 0..factor.derivative {
                series = self.times(&series, &omega);
                series = series.iter().map(|z| turned(z, &Rational::from(k))).collect();
            }
            found.insert(k, series);
        }
        Some(found)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::series::expand;
    use crate::{PI, PiField, Term};
    use lindstedt_algebra::Ring;
    use lindstedt_coeff::print::{Print, Style};
    use lindstedt_equation::Expression;

    /// x' + alpha x(t - 1)(1 + x).
    pub(crate) fn wright() -> DelayEquation<Expression> {
        let integer = Expression::integer;
        let [now, late] = [0, 1].map(|delay| Factor { derivative: 0, delay });
        let speed = Factor { derivative: 1, delay: 0 };
        let alpha = || vec![integer(0), integer(1)];
        let term =
            |coefficient, factors: &[Factor]| Term { coefficient, factors: factors.to_vec() };
        DelayEquation {
            order: 1,
            delays: vec![vec![integer(0)], vec![integer(1)]],
            terms: vec![
                term(vec![integer(1)], &[speed]),
                term(alpha(), &[late]),
                term(alpha(), &[now, late]),
            ],
        }
    }

    #[test]
    fn wright_exactly() {
        let field = PiField;
        let equation = wright().over(&field).unwrap();
        let half = field.constant(&(Expression::parameter(PI) * Expression::Number((1, 2).into())));
        let half = half.unwrap();
        let cycle = expand(&field, &equation, (half.clone(), half), 4, &mut |_| true).unwrap();
        let print =
            |list: &[_]| list.iter().map(|e| field.print(e, Style::Text)).collect::<Vec<_>>();
        // The page of the mathematics: alpha_2 = (3 pi - 2)/10, alpha_4 = (71 pi - 84)/250.
        assert_eq!(
            print(&cycle.parameter),
            ["1/2*pi", "0", "3/10*pi - 1/5", "0", "71/250*pi - 42/125"]
        );
        assert_eq!(print(&cycle.frequency), ["1/2*pi", "0", "-1/5", "0", "-27/125"]);
        assert_eq!(cycle.solution.len(), 5);
        assert_eq!(vanishes(&field, &equation, &cycle, &mut || true), Some(true));
        // The judge sees a wrong coefficient.
        let mut wrong = cycle.clone();
        wrong.solution[3][2][0] =
            field.add(&wrong.solution[3][2][0], &field.power(&(1, 1000).into(), 0));
        assert_eq!(vanishes(&field, &equation, &wrong, &mut || true), Some(false));
        assert_eq!(vanishes(&field, &equation, &cycle, &mut || false), None);
    }
}
