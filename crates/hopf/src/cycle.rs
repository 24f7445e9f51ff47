//! From the equation to the cycle with its numbers: the Hopf point, the series, their judge, what they say.
//!
//! With alpha_m the first coefficient after alpha_0 that is not zero, to leading order
//!
//!   eps^m = (alpha - alpha_0)/alpha_m,    amplitude 2 eps of the first harmonic,
//!   omega = omega_0 + (omega_m/alpha_m)(alpha - alpha_0),
//!   Floquet exponent beta = -m alpha_m Re(dlambda/dalpha) eps^m,
//!
//! the last from r' = r Re(dlambda/dalpha)(alpha - alpha_0 - alpha_m r^m) on the centre manifold: the cycle attracts there
//! where alpha_m Re(dlambda/dalpha) > 0, on the side where the equilibrium repels (supercritical). It is stable where,
//! moreover, no other root has a positive real part. All of this is the same for every choice of the eigenvector.

use crate::HopfError;
use crate::equation::{DelayEquation, Field};
use crate::exact::{BITS, exact};
use crate::pi::PiField;
use crate::residual::vanishes;
use crate::search::{HopfPoint, HopfPoints, points, refined};
use crate::series::{Cycle, expand};
use crate::winding::unstable;
use lindstedt_coeff::print::{Style, Term, print_sum};
use lindstedt_equation::Expression;
use lindstedt_number::Number;
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use rug::Rational;
use std::cmp::Ordering;

/// Bits beyond those of the digits, and the most that are tried.
const GUARD: u32 = 96;
const MOST_BITS: u32 = 1 << 15;

/// A coefficient: the number, and as text and LaTeX.
#[derive(Clone, Debug)]
pub struct Coefficient {
    /// The number; exact in Q(pi), else certified.
    pub number: Number,
    /// In text and in LaTeX.
    pub printed: [String; 2],
}

/// A harmonic of x_n: cos(k s) and sin(k s) with their factors.
#[derive(Clone, Debug)]
pub struct HarmonicNumber {
    /// k.
    pub harmonic: usize,
    /// The factor of the cosine; of k = 0 the constant.
    pub cos: Number,
    /// The factor of the sine.
    pub sin: Number,
}

/// What holds near the Hopf point, in leading order.
#[derive(Clone, Debug)]
pub struct Law {
    /// m: alpha - alpha_0 = alpha_m eps^m + ...
    pub order: usize,
    /// 1/alpha_m: eps^m over alpha - alpha_0.
    pub amplitude: Coefficient,
    /// omega_m/alpha_m.
    pub frequency_slope: Coefficient,
    /// beta/eps^m.
    pub floquet_exponent: Coefficient,
    /// Whether the cycle lives at alpha > alpha_0.
    pub above: bool,
    /// Whether it attracts on the centre manifold.
    pub supercritical: bool,
}

/// The cycle that is born at a Hopf point.
#[derive(Clone, Debug)]
pub struct HopfCycle {
    /// Whether every number is exact; else all are certified.
    pub exact: bool,
    /// All Hopf points of the interval that was searched; this is the first.
    pub points: HopfPoints,
    /// alpha_0, alpha_1, ...
    pub parameter: Vec<Coefficient>,
    /// omega_0, omega_1, ...
    pub frequency: Vec<Coefficient>,
    /// x_1, x_2, ... in text and in LaTeX.
    pub solution: Vec<[String; 2]>,
    /// The same in numbers, harmonics that are zero left out.
    pub harmonics: Vec<Vec<HarmonicNumber>>,
    /// dlambda/dalpha of the root i omega_0: real and imaginary part.
    pub crossing: [Coefficient; 2],
    /// What holds near the point; nothing where no alpha_n up to the order differs from zero, or the first that may is
    /// enclosed with zero.
    pub law: Option<Law>,
    /// Other roots with a positive real part at alpha_0; nothing where it is not decided.
    pub unstable_roots: Option<usize>,
    /// The orders of the equation, from 1, at which the series leaves nothing; nothing where there was no time to look.
    pub checked_orders: Option<usize>,
}

impl HopfCycle {
    /// Whether the cycle is asymptotically stable for small eps; nothing where it is not decided.
    #[must_use]
    pub fn is_stable(&self) -> Option<bool> {
        match (&self.law, self.unstable_roots) {
            (Some(law), _) if !law.supercritical => Some(false),
            (_, Some(1..)) => Some(false),
            (Some(_), Some(0)) => Some(true),
            _ => None,
        }
    }
}

/// What is asked.
#[derive(Clone, Debug)]
pub struct HopfSettings {
    /// The name of the parameter, for messages.
    pub unknown: String,
    /// The Hopf point nearest to this value of the parameter is taken.
    pub near: f64,
    /// The highest order in alpha and omega.
    pub order: usize,
    /// Digits of the numbers.
    pub digits: usize,
}

/// What is going on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The search for Hopf points.
    Searching,
    /// This order is derived.
    Order(usize),
    /// The series are put into the equation.
    Checking,
}

/// The cycle born at the Hopf point nearest to a value of the parameter, to an order in its amplitude: exact where the point
/// is one of Q(pi), else enclosed to the digits asked for. Put into the equation by another route.
///
/// Cost: the search takes milliseconds to seconds, O(length of the interval times largest frequency times delay); order N
/// takes O(N^4) products, polynomials in pi growing with the order.
///
/// # Errors
/// [`HopfError`]: no such point, resonance with a multiple of the frequency, a search that is not decided.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_hopf::{DelayEquation, Factor, HopfSettings, Term, cycle};
/// // x' + alpha x(t - 1) + x^3.
/// let [zero, one] = [0, 1].map(Expression::integer);
/// let factor = |derivative, delay| Factor { derivative, delay };
/// let equation = DelayEquation {
///     order: 1,
///     delays: vec![vec![zero.clone()], vec![one.clone()]],
///     terms: vec![
///         Term { coefficient: vec![one.clone()], factors: vec![factor(1, 0)] },
///         Term { coefficient: vec![zero, one.clone()], factors: vec![factor(0, 1)] },
///         Term { coefficient: vec![one], factors: vec![factor(0, 0); 3] },
///     ],
/// };
/// let settings = HopfSettings { unknown: "alpha".into(), near: 1.0, order: 2, digits: 20 };
/// let found = cycle(&equation, &settings, &mut |_| true)?;
/// // Harmonic 1: i omega_2 - i alpha_2 - (pi/2) omega_2 + 3 = 0.
/// let exact = |list: &[lindstedt_hopf::Coefficient]| list[2].number.exact.clone();
/// assert_eq!(exact(&found.parameter).as_deref(), Some("6*pi^(-1)"));
/// assert_eq!((exact(&found.frequency).as_deref(), found.is_stable()), (Some("6*pi^(-1)"), Some(true)));
/// # Ok::<(), lindstedt_hopf::HopfError>(())
/// ```
pub fn cycle(
    equation: &DelayEquation<Expression>,
    settings: &HopfSettings,
    observer: &mut dyn FnMut(Step) -> bool,
) -> Result<HopfCycle, HopfError> {
    let mut searching = || observer(Step::Searching);
    let points = points(equation, &settings.unknown, settings.near, &mut searching)?;
    let point = points.points[0].clone();
    let unstable_roots = unstable(equation, &point);
    let shape = Shape { settings, points, unstable_roots };
    let sharp = refined(equation, &point, BITS)?;
    if let Some(over) = equation.over(&PiField)
        && let Some(start) = exact(&over, &sharp)
    {
        match shape.run(&PiField, &over, start, observer) {
            // A delay turns a harmonic by an angle whose cosine is not in Q(pi): enclosed like any other number.
            Err(HopfError::Field) => {}
            found => {
                let found = found?.ok_or(HopfError::NotEnoughBits { bits: MOST_BITS })?;
                return Ok(HopfCycle { exact: true, ..found });
            }
        }
    }
    let digits = u32::try_from(settings.digits).unwrap_or(MOST_BITS);
    let mut bits = digits.saturating_mul(10) / 3 + GUARD;
    while bits <= MOST_BITS {
        let HopfPoint { parameter, frequency } = refined(equation, &point, bits)?;
        let ring = BallRing { balls: Balls::new(bits) };
        let over = equation.over(&ring).ok_or(HopfError::Field)?;
        let start = (Enclosure(parameter), Enclosure(frequency));
        if let Some(cycle) = shape.run(&ring, &over, start, observer)? {
            return Ok(cycle);
        }
        bits = bits.saturating_mul(2);
    }
    Err(HopfError::NotEnoughBits { bits: bits / 2 })
}

struct Shape<'a> {
    settings: &'a HopfSettings,
    points: HopfPoints,
    unstable_roots: Option<usize>,
}

impl Shape<'_> {
    /// The series over a field, checked; nothing where the digits are not known.
    fn run<F: Field>(
        &self,
        field: &F,
        equation: &DelayEquation<F::Element>,
        start: (F::Element, F::Element),
        observer: &mut dyn FnMut(Step) -> bool,
    ) -> Result<Option<HopfCycle>, HopfError> {
        let mut watch = |n| observer(Step::Order(n));
        let found = expand(field, equation, start, self.settings.order, &mut watch)?;
        let checked = vanishes(field, equation, &found, &mut || observer(Step::Checking));
        if checked == Some(false) {
            return Err(HopfError::Residual);
        }
        Ok(self.finish(field, &found, checked.map(|_| found.solution.len())))
    }

    /// The numbers; nothing where the digits are not known.
    fn finish<F: Field>(
        &self,
        field: &F,
        cycle: &Cycle<F::Element>,
        checked_orders: Option<usize>,
    ) -> Option<HopfCycle> {
        let list = |list: &[F::Element]| {
            list.iter().map(|e| self.coefficient(field, e)).collect::<Option<Vec<_>>>()
        };
        let crossing = list(&cycle.crossing)?.try_into().ok()?;
        let styles = [Style::Text, Style::Latex];
        let digits = self.settings.digits;
        let print = |x: &Vec<[F::Element; 2]>| styles.map(|style| printed(field, x, digits, style));
        let harmonics = cycle.solution.iter().map(|x| self.harmonics(field, x));
        Some(HopfCycle {
            exact: false,
            points: self.points.clone(),
            parameter: list(&cycle.parameter)?,
            frequency: list(&cycle.frequency)?,
            solution: cycle.solution.iter().map(print).collect(),
            harmonics: harmonics.collect::<Option<_>>()?,
            crossing,
            law: self.law(field, cycle)?,
            unstable_roots: self.unstable_roots,
            checked_orders,
        })
    }

    fn coefficient<F: Field>(&self, field: &F, e: &F::Element) -> Option<Coefficient> {
        let number = field.number(e, self.settings.digits)?;
        let print = |style| match &number.exact {
            Some(_) => field.print(e, style),
            None => number.decimal.clone(),
        };
        Some(Coefficient { printed: [Style::Text, Style::Latex].map(print), number })
    }

    fn harmonics<F: Field>(&self, field: &F, x: &[[F::Element; 2]]) -> Option<Vec<HarmonicNumber>> {
        let number = |e: &F::Element| field.number(e, self.settings.digits);
        let there = waves(field, x);
        let all = there.into_iter().map(|(harmonic, [cos, sin])| {
            Some(HarmonicNumber { harmonic, cos: number(&cos)?, sin: number(&sin)? })
        });
        all.collect()
    }

    /// Nothing inside where no alpha_n is known to differ from zero; nothing at all for too few bits.
    fn law<F: Field>(&self, field: &F, cycle: &Cycle<F::Element>) -> Option<Option<Law>> {
        let later = cycle.parameter.iter().enumerate().skip(1);
        let Some((m, alpha)) = later.into_iter().find(|(_, a)| !field.is_zero(a)) else {
            return Some(None);
        };
        let speed = &cycle.crossing[0];
        // An enclosed coefficient that may be zero leaves the leading order open.
        let Some(sign) = field.sign(alpha) else { return Some(None) };
        let signs = [sign, field.sign(speed)?];
        let inverse = field.reciprocal(alpha)?;
        let exponent = field.scale(&field.mul(alpha, speed), &-Rational::from(m));
        Some(Some(Law {
            order: m,
            amplitude: self.coefficient(field, &inverse)?,
            frequency_slope: self.coefficient(field, &field.mul(&cycle.frequency[m], &inverse))?,
            floquet_exponent: self.coefficient(field, &exponent)?,
            above: signs[0] == Ordering::Greater,
            supercritical: signs[0] == signs[1],
        }))
    }
}

/// The factors of cos(k s) and sin(k s) that are not both zero: c e^(iks) + conj = 2 Re c cos - 2 Im c sin.
fn waves<F: Field>(field: &F, x: &[[F::Element; 2]]) -> Vec<(usize, [F::Element; 2])> {
    let there =
        x.iter().enumerate().filter(|(_, [re, im])| !field.is_zero(re) || !field.is_zero(im));
    let wave = |(k, [re, im]): (usize, &[F::Element; 2])| {
        let twice = Rational::from(if k == 0 { 1 } else { 2 });
        (k, [field.scale(re, &twice), field.scale(im, &-twice)])
    };
    there.map(wave).collect()
}

/// The digits that an enclosure holds; with its radius where it holds zero.
fn enclosed(number: &Number, style: Style) -> Term {
    let (sign, size) = match number.decimal.strip_prefix('-') {
        Some(size) => (-1, size),
        None => (1, &*number.decimal),
    };
    let zero = size.parse::<f64>().is_ok_and(|size| size == 0.0);
    let factor = match (&number.error, style) {
        (Some(error), Style::Text) if zero => format!("(0 +- {error})"),
        (Some(error), Style::Latex) if zero => format!(r"(0 \pm {error})"),
        _ => size.to_owned(),
    };
    Term { coefficient: Rational::from(sign), factors: vec![factor] }
}

/// x_n as a sum of cosines and sines.
fn printed<F: Field>(field: &F, x: &[[F::Element; 2]], digits: usize, style: Style) -> String {
    let mut sum: Vec<Term> = Vec::new();
    for (k, parts) in waves(field, x) {
        // sin 0 = 0, whatever encloses its factor.
        let functions = ["cos", "sin"].iter().take(if k == 0 { 1 } else { 2 });
        for (function, e) in functions.zip(&parts).filter(|(_, e)| !field.is_zero(e)) {
            let angle = match (k, style) {
                (1, _) => "s".to_owned(),
                (k, Style::Text) => format!("{k}*s"),
                (k, Style::Latex) => format!("{k}s"),
            };
            let wave = match style {
                Style::Text => format!("{function}({angle})"),
                Style::Latex => format!(r"\{function} {angle}"),
            };
            // The 2 of x_1 in enclosures.
            let whole = field.as_rational(e).filter(Rational::is_integer);
            let own = match (whole, field.number(e, digits)) {
                (Some(coefficient), _) => Term { coefficient, factors: Vec::new() },
                (None, Some(number)) if number.exact.is_none() => enclosed(&number, style),
                _ => field.factor(e, style),
            };
            sum.push(own.times((k > 0).then_some(wave)));
        }
    }
    print_sum(&sum, style)
}
