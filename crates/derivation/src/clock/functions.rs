//! The solution that a clock gives, kept unexpanded.

use crate::constants::Constants;
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::Condition;
use lindstedt_expand::{Expansion, OrderWork};
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::Lobachevsky;
use lindstedt_phase::lobachevsky::{LobachevskyElement, Unfolding};
use lindstedt_series::Series;
use rug::Rational;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Bits for what the products of the series of balls lose.
const GUARD_BITS: u32 = 32;

type Function = LobachevskyElement<Polynomial>;

/// Constants of a clock as polynomials in named constants.
pub(super) type Lift<E> = Arc<dyn Fn(&E) -> Polynomial + Send + Sync>;

/// omega^2/kappa, its root and the reciprocal of that, order by order.
type BallPowers = Arc<[Vec<Ball>; 3]>;

/// Functions x_0, x_1, ... that are formed one by one.
trait Functions: Send + Sync {
    /// x_n; nothing beyond the order, or when stopped.
    fn function(&self, n: usize, stop: &Stop) -> Option<Function>;
}

struct Lifted<C: RationalAlgebra> {
    parts: Unfolding<C::Element>,
    constants: C,
    lift: Lift<C::Element>,
}

impl<C: RationalAlgebra + Send + Sync> Functions for Lifted<C> {
    fn function(&self, n: usize, stop: &Stop) -> Option<Function> {
        self.parts.function(n, &self.constants, &*self.lift, stop)
    }
}

/// A solution x = sum x_n eps^n by the parts of its clock (`docs/src/concepts/clock.md`): x_n is formed when it is asked
/// for, and counted without being formed.
///
/// ```
/// use lindstedt_derivation::{Settings, Solution, derive};
/// let problem = lindstedt_problems::find("power-law").ok_or("no such problem")?;
/// let settings = Settings { order: 4, ..Settings::default() };
/// let law = derive(&problem, &settings, &mut |_| true)?;
/// let Solution::Clock(solution) = &law.solution else { panic!("by the clock") };
/// assert_eq!(solution.terms(), [1, 2, 5, 10, 19]);
/// assert_eq!(solution.function(4).map(|x| x.len()), Some(19));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct ClockSolution {
    functions: Arc<dyn Functions>,
    terms: Vec<usize>,
    /// nu_0 = 1, nu_1, ...
    pace: Vec<Polynomial>,
    /// c_mn by order n and then m - 1.
    numbers: Vec<Vec<Polynomial>>,
    known: Arc<Mutex<BTreeMap<u32, BallPowers>>>,
    /// What the order, the condition and the constants of the expansion are; without its functions.
    head: Expansion<Lobachevsky<PolynomialRing>>,
}

impl fmt::Debug for ClockSolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClockSolution")
            .field("terms", &self.terms)
            .field("head", &self.head)
            .finish()
    }
}

impl ClockSolution {
    /// The parts with their constants, nu and the c_mn; `head` has no functions. Nothing when stopped, which is asked
    /// while terms are counted: by `counted` or, where that gives nothing, by forming the functions.
    pub(super) fn new<C: RationalAlgebra + Send + Sync + 'static>(
        parts: Unfolding<C::Element>,
        constants: C,
        lift: Lift<C::Element>,
        (pace, numbers): (&[C::Element], &[Vec<C::Element>]),
        (head, counted): (Expansion<Lobachevsky<PolynomialRing>>, Option<Vec<usize>>),
        stop: &Stop,
    ) -> Option<Self> {
        let pace = pace.iter().map(|c| lift(c)).collect();
        let numbers = numbers.iter().map(|list| list.iter().map(|c| lift(c)).collect()).collect();
        let functions = Lifted { parts, constants, lift };
        let length = |n| functions.function(n, stop).map(|x| x.len());
        let terms = match counted {
            Some(terms) => terms,
            None => (0..head.frequency_squared.len()).map(length).collect::<Option<_>>()?,
        };
        let known = Arc::default();
        Some(Self { functions: Arc::new(functions), terms, pace, numbers, known, head })
    }

    /// The highest order derived.
    #[must_use]
    pub fn order(&self) -> usize {
        self.terms.len() - 1
    }

    /// The number of terms of x_0, x_1, ...
    #[must_use]
    pub fn terms(&self) -> &[usize] {
        &self.terms
    }

    /// x_n; nothing beyond the order. Cost: a product of numbers per term.
    #[must_use]
    pub fn function(&self, n: usize) -> Option<Function> {
        self.functions.function(n, &Stop::default())
    }

    /// The normalisation.
    #[must_use]
    pub fn condition(&self) -> Condition {
        self.head.condition
    }

    /// W_0 = 1, W_1, ... in the moments mu_m: omega^2 = kappa sum W_n eps^n.
    #[must_use]
    pub fn frequency_squared(&self) -> &[Polynomial] {
        &self.head.frequency_squared
    }

    /// x(0), order by order.
    #[must_use]
    pub fn amplitude(&self) -> &[Polynomial] {
        &self.head.amplitude
    }

    /// omega^2/kappa, its root and the reciprocal of that as balls, order by order: nu/M^2, nu^(1/2)/M and M/nu^(1/2) with
    /// M = 1 + sum_m mu_m c_m, as series of balls. O(N^2) products, and no cancellation among the terms of a
    /// coefficient written out. Nothing where a constant has no value.
    pub(crate) fn powers(&self, constants: &Constants, balls: Balls) -> Option<BallPowers> {
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&balls.bits()) {
            return Some(known.clone());
        }
        let (asked, balls) = (balls.bits(), Balls::new(balls.bits().saturating_add(GUARD_BITS)));
        let ring = BallRing { balls };
        let value = |p: &Polynomial| Some(Enclosure(constants.evaluate(p, balls)?));
        let largest = u16::try_from(self.order()).ok()?;
        let moment = |m: u16| value(&PolynomialRing::default().symbol(Symbol::Moment(m)));
        // The last first: it brings the others.
        let mut moments: Vec<_> = (1..=largest).rev().map(moment).collect::<Option<_>>()?;
        moments.reverse();
        let mean = |(n, numbers): (usize, &Vec<Polynomial>)| {
            let numbers: Vec<_> = numbers.iter().map(value).collect::<Option<_>>()?;
            let pairs: Vec<_> = moments.iter().zip(&numbers).collect();
            Some(if n == 0 { ring.one() } else { ring.sum_of_products(&pairs) })
        };
        let mean = self.numbers.iter().enumerate().map(mean).collect::<Option<_>>()?;
        let mean = Series::truncated(mean);
        let pace = Series::truncated(self.pace.iter().map(value).collect::<Option<_>>()?);
        let power = |q: (i32, i32)| pace.power(&ring, &Rational::from(q));
        let (inverse, order) = (mean.reciprocal(&ring)?, self.order());
        let first = power((1, 2))?.mul(&ring, &inverse, order);
        let period = power((-1, 2))?.mul(&ring, &mean, order);
        let squared = first.mul(&ring, &first.clone(), order);
        let of_balls =
            |series: Series<Enclosure>| series.coefficients.into_iter().map(|c| c.0).collect();
        let powers = Arc::new([squared, first, period].map(of_balls));
        lock().insert(asked, Arc::clone(&powers));
        Some(powers)
    }

    /// The right side f_n of x_n'' + x_n = f_n - W_n x_0''; nothing beyond the order.
    #[must_use]
    pub fn right_side(&self, algebra: &Lobachevsky<PolynomialRing>, n: usize) -> Option<Function> {
        let mut solution = vec![algebra.zero(); n];
        solution.push(self.function(n)?);
        solution[0] = self.function(0)?;
        let frequency_squared = self.head.frequency_squared.get(..=n)?.to_vec();
        let (amplitude, stiffness) = (self.head.amplitude.clone(), self.head.stiffness.clone());
        let expansion = Expansion {
            condition: self.head.condition,
            stiffness,
            frequency_squared,
            amplitude,
            solution,
            work: Vec::new(),
            certificates: Vec::new(),
        };
        Some(expansion.right_side(algebra, n))
    }

    /// The expansion with all functions formed.
    #[must_use]
    pub fn expansion(&self) -> Expansion<Lobachevsky<PolynomialRing>> {
        let solution: Vec<_> = (0..self.terms.len()).filter_map(|n| self.function(n)).collect();
        let terms = self.head.work.iter().zip(self.terms.iter().skip(1));
        let work = terms.map(|(work, terms)| OrderWork { terms: *terms, ..*work }).collect();
        Expansion { solution, work, ..self.head.clone() }
    }
}
