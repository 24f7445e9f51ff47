//! The frequency of a clock: omega^2 = kappa nu/M^2 with M = 1 + sum_m mu_m c_m, its root, and the reciprocal of that.
//!
//! As M - 1 is linear in the mu_m, the multinomial theorem spells its powers out without a product of two of them:
//!
//!   M^r = sum_k binomial(r, j) j!/prod k_m! prod mu_m^k_m prod c_m^k_m,   j = sum k_m,
//!
//! over the monomials of the functions, with the products of the c_m that these have. In closed form M = sum mu_m v^m =
//! exp(sum_k eta(k) v^k/k), and M^r is the exponential of r times that: a product with a monomial per term.
//!
//! What is found is judged modulo two primes, at one point: there M is inverted and its powers, the roots of nu and
//! their products are multiplied out ([`ClockMean`]), from c_m and nu alone.

use super::functions::Lift;
use super::point::Point;
use crate::error::DerivationError as Error;
use crate::series::Powers;
use lindstedt_algebra::{RationalAlgebra, Ring, Stop, Stopping};
use lindstedt_coeff::closed_forms::ClosedForms;
use lindstedt_coeff::sparse::{Monomial, Sparse};
use lindstedt_coeff::{Polynomial, PolynomialRing, PowerProduct, Symbol};
use lindstedt_expand::{ClockMean, ExpandError};
use lindstedt_phase::lobachevsky::{LambdaMonomial, Unfolding};
use lindstedt_series::Series;
use rug::{Integer, Rational};

/// What a frequency is found from.
pub(super) struct Clockwork<'a, C: RationalAlgebra> {
    pub constants: &'a C,
    pub ring: &'a PolynomialRing,
    pub lift: &'a Lift<C::Element>,
    /// c_mn by order n and then m - 1.
    pub numbers: &'a [Vec<C::Element>],
    /// nu_0 = 1, nu_1, ...
    pub pace: &'a [C::Element],
    /// v where c_m = v^m.
    pub variable: Option<&'a [Rational]>,
    pub parts: &'a Unfolding<C::Element>,
    pub stop: &'a Stop,
}

/// A power M^r with what stands before it.
struct Factored<E> {
    exponent: i32,
    /// nu, nu^(1/2) or nu^(-1/2).
    before: Series<E>,
}

impl<C: RationalAlgebra> Clockwork<'_, C> {
    fn order(&self) -> usize {
        self.pace.len() - 1
    }

    fn interrupted(&self) -> Error {
        ExpandError::Interrupted { order: self.order() }.into()
    }

    /// W in the moments, and the powers of the frequency, in closed form if `closes`.
    ///
    /// # Errors
    /// [`ExpandError::Residual`] where the judge finds an order wrong, [`ExpandError::Interrupted`] when stopped.
    pub fn frequency(&self, closes: bool) -> Result<(Vec<Polynomial>, Powers), Error> {
        let [squared, first, period] = self.factored()?;
        let order = u16::try_from(self.order()).map_err(|_| Error::NoValue)?;
        let forms = closes.then(|| ClosedForms::new(order));
        let in_moments = |power: &Factored<C::Element>| self.in_moments(power);
        let w = in_moments(&squared)?;
        let powers = match &forms {
            Some(forms) => self.in_closed_form(forms, [squared, first, period])?,
            None => [w.clone(), in_moments(&first)?, in_moments(&period)?],
        };
        if self.stop.asked() {
            return Err(self.interrupted());
        }
        self.judge(forms.as_ref(), &w, &powers)?;
        let [squared, first, period] = powers;
        Ok((w, Powers::new(squared, first, period, closes)))
    }

    fn factored(&self) -> Result<[Factored<C::Element>; 3], Error> {
        let constants = Stopping(self.constants, self.stop);
        let nu = Series::truncated(self.pace.to_vec());
        let power = |q: (i32, i32)| nu.power(&constants, &Rational::from(q)).ok_or(Error::NoValue);
        let (root, inverse) = (power((1, 2))?, power((-1, 2))?);
        Ok([(-2, nu.clone()), (-1, root), (1, inverse)]
            .map(|(exponent, before)| Factored { exponent, before }))
    }

    /// A power of the frequency in the mu_m.
    fn in_moments(&self, power: &Factored<C::Element>) -> Result<Vec<Polynomial>, Error> {
        let constants = Stopping(self.constants, self.stop);
        let order = self.order();
        let by_degree = |monomial: &&LambdaMonomial| {
            power.exponent < 0 || monomial.degree <= power.exponent.unsigned_abs() as usize
        };
        let mut monomials: Vec<_> = self.parts.monomials().iter().filter(by_degree).collect();
        let symbols = |monomial: &LambdaMonomial| {
            let exponents = monomial.word.exponents().iter().enumerate().skip(1);
            let powers = exponents.filter(|(_, k)| **k > 0);
            powers.fold(PowerProduct::unit(), |product, (m, k)| {
                product.times(&PowerProduct::power(Symbol::Moment(m as u16), *k as i16))
            })
        };
        let mut named: Vec<_> = monomials.drain(..).map(|m| (symbols(m), m)).collect();
        named.sort_unstable_by(|(a, _), (b, _)| a.cmp(b));
        let products = self.parts.products(self.constants);
        let mut lifted: Vec<Option<Vec<Polynomial>>> = vec![None; products.len()];
        let mut sums: Vec<Vec<(i64, PowerProduct, Rational)>> = vec![Vec::new(); order + 1];
        for (symbols, monomial) in named {
            if self.stop.asked() {
                return Err(self.interrupted());
            }
            let series = lifted[monomial.product].get_or_insert_with(|| {
                let product = Series::truncated(products[monomial.product].clone());
                let whole = product.mul(&constants, &power.before, order);
                whole.coefficients.iter().map(|c| (self.lift)(c)).collect()
            });
            let ways = ways(power.exponent, monomial);
            for (sum, coefficient) in sums.iter_mut().zip(series.iter()) {
                for (others, c) in coefficient.terms() {
                    let product = others.times(&symbols);
                    sum.push((product.weight(), product, Rational::from(c * &ways)));
                }
            }
        }
        let increasing = |mut terms: Vec<(i64, PowerProduct, Rational)>| {
            terms.sort_unstable_by(|(v, m, _), (w, n, _)| {
                v.cmp(w).then_with(|| m.factors().cmp(n.factors()))
            });
            let terms = terms.into_iter().map(|(_, monomial, c)| (monomial, c)).collect();
            Sparse::from_increasing(terms).ok_or(Error::NoValue)
        };
        sums.into_iter().map(increasing).collect()
    }

    /// The powers of the frequency with the mu_m in closed form.
    fn in_closed_form(
        &self,
        forms: &ClosedForms,
        powers: [Factored<C::Element>; 3],
    ) -> Result<[Vec<Polynomial>; 3], Error> {
        let ring = &Stopping(self.ring, self.stop);
        let order = self.order();
        let closed = powers.map(|power| -> Option<Vec<Polynomial>> {
            let Some(v) = self.variable else {
                let mean = Series::truncated(self.mean(ring, |m| forms.moment(m).cloned())?);
                let of_mean = mean.power(ring, &Rational::from(power.exponent))?;
                let before = power.before.coefficients.iter().map(|c| (self.lift)(c));
                let before = Series::truncated(before.collect());
                return Some(of_mean.mul(ring, &before, order).coefficients);
            };
            // sum_w y_w v^w before, where v^w begins at order w.
            let of_mean = forms.power(power.exponent);
            let mut weights = power.before;
            let v = v.iter().map(|q| self.constants.rational(q)).collect();
            let v = Series::truncated(v);
            let mut sums = vec![Vec::new(); order + 1];
            for y in &of_mean {
                for (sum, weight) in sums.iter_mut().zip(&weights.coefficients) {
                    let q = self.constants.as_rational(weight)?;
                    if q.is_zero() {
                        continue;
                    }
                    let scaled = y.terms().iter().map(|(m, c)| (m.clone(), Rational::from(c * &q)));
                    sum.extend(scaled);
                }
                weights = weights.mul(self.constants, &v, order);
            }
            // y_w has weight w: what is put together increases.
            sums.into_iter().map(Sparse::from_increasing).collect()
        });
        let [Some(squared), Some(first), Some(period)] = closed else {
            return Err(if self.stop.asked() { self.interrupted() } else { Error::NoValue });
        };
        Ok([squared, first, period])
    }

    /// M = 1 + sum_m mu_m c_m in a ring, order by order.
    fn mean<R: Ring<Element = Polynomial>>(
        &self,
        ring: &R,
        moment: impl Fn(u16) -> Option<Polynomial>,
    ) -> Option<Vec<Polynomial>> {
        let coefficient = |(n, numbers): (usize, &Vec<C::Element>)| {
            let mut sum = if n == 0 { ring.one() } else { ring.zero() };
            for (m, c) in (1u16..).zip(numbers) {
                ring.add_assign(&mut sum, &ring.mul(&moment(m)?, &(self.lift)(c)));
            }
            Some(sum)
        };
        self.numbers.iter().enumerate().map(coefficient).collect()
    }

    /// Multiplies M, its powers and the roots of nu out at a point modulo two primes, where every series must have the
    /// value that it has there.
    fn judge(
        &self,
        forms: Option<&ClosedForms>,
        w: &[Polynomial],
        [squared, first, period]: &[Vec<Polynomial>; 3],
    ) -> Result<(), Error> {
        let at = |order| Error::from(ExpandError::Residual { order });
        let moments = (0u16..).map_while(|m| forms?.moment(m));
        let point = Point::new().with_moments(moments).ok_or(Error::NoValue)?;
        let image = |p: &Polynomial| point.image(p).ok_or(Error::NoValue);
        let mean = self.mean(self.ring, |m| Some(self.ring.symbol(Symbol::Moment(m))));
        let mean = mean.unwrap_or_default().iter().map(image).collect::<Result<Vec<_>, _>>()?;
        let pace: Vec<_> =
            self.pace.iter().map(|c| image(&(self.lift)(c))).collect::<Result<_, _>>()?;
        let expected = ClockMean::new(point.ring(), mean)?.frequency(point.ring(), &pace)?;
        let lists = [
            (w, &expected.squared),
            (squared, &expected.squared),
            (first, &expected.first),
            (period, &expected.period),
        ];
        for (found, expected) in lists {
            if found.len() != expected.len() {
                return Err(at(0));
            }
            for (n, (found, expected)) in found.iter().zip(expected).enumerate() {
                if image(found)? != *expected {
                    return Err(at(n));
                }
            }
        }
        Ok(())
    }
}

/// binomial(r, j) j!/prod k_m! = r (r - 1) ... (r - j + 1)/prod k_m!.
fn ways(r: i32, monomial: &LambdaMonomial) -> Rational {
    let falling =
        (0..monomial.degree as i32).fold(Integer::from(1), |product, i| product * (r - i));
    Rational::from((falling, monomial.factorials.clone()))
}
