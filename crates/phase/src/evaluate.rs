//! Functions of the phase at a point, as balls.

use crate::lobachevsky::{Factor, LobachevskyElement, Word};
use crate::lobachevsky_function::{LambdaTable, Point, cosine, log_cosine, sine};
use crate::trigonometric::TrigonometricPolynomial;
use lindstedt_number::ball::{Ball, Balls};
use rug::Rational;
use std::fmt::Debug;

/// Functions of the phase with balls as coefficients, to be evaluated at many phases: what does not
/// depend on the phase is computed once, what the functions share once a phase.
///
/// ```
/// use lindstedt_algebra::{PhaseAlgebra, Rationals};
/// use lindstedt_number::ball::Balls;
/// use lindstedt_phase::{Trigonometric, evaluate::{PhaseFunctions, of_rational}, lobachevsky_function::Point};
/// let (balls, trigonometric) = (Balls::new(100), Trigonometric::new(Rationals));
/// let cosines = [1, 2].map(|k| trigonometric.cos(k, 3.into()));
/// let functions = PhaseFunctions::trigonometric(&cosines, balls, of_rational(balls));
/// // 3 cos(pi/3) and 3 cos(2 pi/3).
/// let values = functions.and_then(|f| f.at(&Point::PiTimes((1, 3).into()))).unwrap_or_default();
/// let expected = [(3, 2), (-3, 2)].map(|q| balls.from_rational(&q.into()));
/// assert!(values.len() == 2 && values.iter().zip(&expected).all(|(v, e)| v.overlaps(e)));
/// ```
pub struct PhaseFunctions {
    balls: Balls,
    ring: Ring,
}

enum Ring {
    Trigonometric(Vec<TrigonometricPolynomial<Ball>>),
    Lobachevsky {
        table: LambdaTable,
        /// The highest exponents of l, Lambda_1, ...
        exponents: Vec<u16>,
        functions: Vec<Vec<(Factor, Block)>>,
    },
}

/// A polynomial in l and the Lambda_m.
type Block = Vec<(Word, Ball)>;

impl PhaseFunctions {
    /// c_0 + sum_k (c_k cos k x + s_k sin k x) for each, from given values of the coefficients. Nothing
    /// when a coefficient has no value.
    pub fn trigonometric<E>(
        functions: &[TrigonometricPolynomial<E>],
        balls: Balls,
        coefficient: impl Fn(&E) -> Option<Ball>,
    ) -> Option<Self> {
        let list = |list: &[E]| list.iter().map(&coefficient).collect::<Option<Vec<_>>>();
        let function = |f: &TrigonometricPolynomial<E>| {
            Some(TrigonometricPolynomial { cos: list(&f.cos)?, sin: list(&f.sin)? })
        };
        let functions = functions.iter().map(function).collect::<Option<_>>()?;
        Some(Self { balls, ring: Ring::Trigonometric(functions) })
    }

    /// Elements of the Lobachevsky ring, at the precision of the table, which must reach the largest
    /// Lambda_m that occurs. Nothing when a coefficient has no value.
    pub fn lobachevsky<E: Clone + PartialEq + Debug + Send + Sync>(
        functions: &[LobachevskyElement<E>],
        table: LambdaTable,
        coefficient: impl Fn(&E) -> Option<Ball>,
    ) -> Option<Self> {
        let mut exponents: Vec<u16> = Vec::new();
        let mut term = |(word, c): (&Word, &E)| {
            exponents.resize(exponents.len().max(word.exponents().len()), 0);
            exponents
                .iter_mut()
                .zip(word.exponents())
                .for_each(|(most, e)| *most = (*most).max(*e));
            Some((word.clone(), coefficient(c)?))
        };
        let mut functions_of_balls = Vec::new();
        for f in functions {
            let blocks = f.blocks().iter().map(|(factor, polynomial)| {
                let block = polynomial.terms().iter().map(|(word, c)| term((word, c)));
                Some((*factor, block.collect::<Option<Block>>()?))
            });
            functions_of_balls.push(blocks.collect::<Option<Vec<_>>>()?);
        }
        let (balls, functions) = (table.balls(), functions_of_balls);
        Some(Self { balls, ring: Ring::Lobachevsky { table, exponents, functions } })
    }

    /// The values at a phase. Nothing at the zeros of cos x when l or a negative power of cos x occurs: the
    /// limit may exist there, but it is not computed. Harmonics by the angle addition formulas: one
    /// product per coefficient; the radius grows linearly with the harmonic.
    #[must_use]
    pub fn at(&self, x: &Point) -> Option<Vec<Ball>> {
        let balls = self.balls;
        let (cos, sin) = (cosine(x, balls), sine(x, balls));
        match &self.ring {
            Ring::Trigonometric(functions) => {
                let harmonics = functions.iter().map(|f| f.cos.len().max(f.sin.len())).max();
                let mut table = vec![(balls.one(), balls.zero())];
                while table.len() < harmonics.unwrap_or(0) {
                    let (c, s) = table.last()?;
                    let next = balls.sub(&balls.mul(c, &cos), &balls.mul(s, &sin));
                    table.push((next, balls.add(&balls.mul(s, &cos), &balls.mul(c, &sin))));
                }
                let value = |f: &TrigonometricPolynomial<Ball>| {
                    let cosines = f.cos.iter().zip(&table).map(|(c, (value, _))| (c, value));
                    let sines = f.sin.iter().zip(&table).map(|(s, (_, value))| (s, value));
                    let add = |sum, (c, value)| balls.add(&sum, &balls.mul(c, value));
                    cosines.chain(sines).fold(balls.zero(), add)
                };
                Some(functions.iter().map(value).collect())
            }
            Ring::Lobachevsky { table, exponents, functions } => {
                let log = log_cosine(x, balls).map(|value| balls.neg(&value));
                let mut bases = table.values(x).into_iter().map(Some).collect::<Vec<_>>();
                // Lambda_0 = 0 is in no word; its place is that of l.
                *bases.first_mut()? = log;
                let powers: Vec<_> = (bases.into_iter().zip(exponents))
                    .map(|(base, most)| Some(powers(base?, *most, balls)))
                    .collect();
                let value = |blocks: &Vec<(Factor, Block)>| {
                    let terms = blocks.iter().map(|(factor, block)| {
                        let mut value = balls.powi(&cos, i64::from(factor.power))?;
                        if factor.sine {
                            value = balls.mul(&value, &sin);
                        }
                        Some(balls.mul(&polynomial(block, &powers, balls)?, &value))
                    });
                    terms
                        .into_iter()
                        .try_fold(balls.zero(), |sum, term| Some(balls.add(&sum, &term?)))
                };
                functions.iter().map(value).collect()
            }
        }
    }
}

/// 1, x, x^2, ..., x^most.
fn powers(x: Ball, most: u16, balls: Balls) -> Vec<Ball> {
    let mut list = vec![balls.one()];
    for k in 0..usize::from(most) {
        list.push(balls.mul(&list[k], &x));
    }
    list
}

/// The value of a polynomial from the powers of l and the Lambda_m; nothing where one has no value.
fn polynomial(block: &Block, powers: &[Option<Vec<Ball>>], balls: Balls) -> Option<Ball> {
    let mut sum = balls.zero();
    for (word, c) in block {
        let mut term = c.clone();
        for (index, &exponent) in word.exponents().iter().enumerate().filter(|(_, e)| **e > 0) {
            let power = powers.get(index)?.as_ref()?.get(usize::from(exponent))?;
            term = balls.mul(&term, power);
        }
        sum = balls.add(&sum, &term);
    }
    Some(sum)
}

/// The value of a rational coefficient.
pub fn of_rational(balls: Balls) -> impl Fn(&Rational) -> Option<Ball> {
    move |q| Some(balls.from_rational(q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lobachevsky, Trigonometric};
    use lindstedt_algebra::{PhaseAlgebra, Rationals, Ring};
    use lindstedt_coeff::PolynomialRing;

    #[test]
    fn elements_of_both_algebras_at_a_point() {
        let balls = Balls::new(200);
        let x = Point::Rational(Rational::from((9, 7)));
        let (cos, sin) = (cosine(&x, balls), sine(&x, balls));
        // cos 3x = 4 cos^3 - 3 cos, sin 2x = 2 sin cos.
        let a = Trigonometric::new(Rationals);
        let f = a.add(&a.cos(3, Rational::from((1, 3))), &a.sin(2, Rational::from(5)));
        let functions = PhaseFunctions::trigonometric(&[f], balls, of_rational(balls));
        let value = functions.and_then(|f| f.at(&x)?.pop());
        let cube = balls.mul_i64(&balls.mul(&cos, &balls.square(&cos)), 4);
        let third =
            balls.mul_rational(&balls.sub(&cube, &balls.mul_i64(&cos, 3)), &Rational::from((1, 3)));
        let expected = balls.add(&third, &balls.mul_i64(&balls.mul(&sin, &cos), 10));
        assert!(value.is_some_and(|v| v.overlaps(&expected) && v.relative_accuracy_bits() > 180));

        // x_1(pi/4) and x_1(pi/3) of the power law, x_1 = cos l + sin Lambda_1 (mpmath 1.3.0).
        let ring = Lobachevsky::new(PolynomialRing::default());
        let x1 = ring.sum_of_products(&[
            (&ring.cosine(), &ring.log_secant()),
            (&ring.sine(), &ring.lambda(1)),
        ]);
        let functions =
            PhaseFunctions::lobachevsky(&[x1], LambdaTable::new(1, balls), |_| Some(balls.one()));
        let at = |x: &Point| functions.as_ref()?.at(x)?.pop();
        for (part, expected) in
            [(4, "-0.0787782056210015997202045188148"), (3, "-0.0929090169743008872791768684345")]
        {
            let value = at(&Point::PiTimes(Rational::from((1, part))));
            let decimal = value.and_then(|v| lindstedt_number::digits::decimal(&v, 30));
            assert_eq!(decimal.as_deref(), Some(expected));
        }
        let pole = Point::PiTimes(Rational::from((1, 2)));
        assert!(at(&pole).is_none());
    }
}
