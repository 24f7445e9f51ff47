//! A derivation: its series, its solution, printed and as numbers.

use crate::clock::ClockSolution;
use crate::constants::Constants;
use crate::error::DerivationError;
use crate::series::NamedSeries;
use crate::settings::Route;
use lindstedt_algebra::{FunctionAlgebra, RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::print::{Print, Style, Term, print_sum};
use lindstedt_coeff::{Polynomial, PolynomialRing};
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::description::Description;
use lindstedt_equation::{AmplitudeRole, Condition, Problem, Quantity};
use lindstedt_expand::Expansion;
use lindstedt_multimodular::{self as multimodular, Fraction};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::{Exact, Number, certified, to_ratio};
use lindstedt_phase::Lobachevsky;
use lindstedt_phase::print::{PrintPhase, times_harmonic};
use num_bigint::BigInt;
use num_rational::Ratio;
use rayon::prelude::*;
use rug::Rational;
use std::collections::BTreeMap;

/// Coefficients with no more terms are evaluated term by term, and so are all of a series that has not more than
/// [`FEW_OF_ALL`].
const FEW_TERMS: usize = 64;
const FEW_OF_ALL: usize = 1000;

/// The solution, in the algebra that the equation needed.
///
/// ```
/// use lindstedt_derivation::{Solution, Settings, derive};
/// let problem = lindstedt_problems::find("duffing").ok_or("no such problem")?;
/// let settings = Settings { order: 1, ..Settings::default() };
/// let duffing = derive(&problem, &settings, &mut |_| true)?;
/// let Solution::Rational(proved) = &duffing.solution else { panic!("over Q") };
/// assert_eq!(proved.order(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Solution {
    /// None: the frequency alone was derived.
    FrequencyOnly {
        /// What it was lifted from; nothing by the energy integral.
        images: Option<multimodular::CheckedImages>,
    },
    /// In the Lobachevsky ring, by the parts of its clock.
    Clock(Box<ClockSolution>),
    /// In the Lobachevsky ring.
    Lobachevsky(Box<Expansion<Lobachevsky<PolynomialRing>>>),
    /// Trigonometric polynomials over Q.
    Rational(Box<multimodular::Proved>),
}

/// A checked expansion: nothing leaves [`crate::derive()`] that was not substituted back
/// (`checked_orders`), but for [`crate::Route::EnergyIntegral`] and [`crate::Route::Frequency`], which have no
/// solution to substitute.
///
/// ```
/// use lindstedt_equation::Quantity;
/// use lindstedt_derivation::{Settings, derive};
/// let problem = lindstedt_problems::find("van-der-pol").ok_or("no such problem")?;
/// let settings = Settings { order: 2, ..Settings::default() };
/// let cycle = derive(&problem, &settings, &mut |_| true)?;
/// assert_eq!(cycle.exact(Quantity::Frequency, 2).as_deref(), Some("-1/16"));
/// assert_eq!((cycle.checked_orders, cycle.terms(0)), (Some(2), 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Derivation {
    /// The problem as it was expanded: values put in, x and t scaled.
    pub problem: Problem,
    /// The normalisation used.
    pub condition: Condition,
    /// The highest order derived (lower than asked for when interrupted).
    pub order: usize,
    /// Orders whose residual vanishes identically: 0..=this; nothing without a solution, and
    /// where [`crate::Settings::stop`] left no time to check.
    pub checked_orders: Option<usize>,
    /// The ring of the coefficients.
    pub ring: PolynomialRing,
    /// kappa, the factor of x at order zero.
    pub stiffness: Polynomial,
    /// The series of the result.
    pub series: Vec<NamedSeries>,
    /// The solution.
    pub solution: Solution,
    /// How it was derived; never [`Route::Automatic`].
    pub route: Route,
    /// The amplitude that was asked for or is the default; nothing where there is none.
    pub amplitude: Option<Exact>,
    /// Parameters of the equation with the values that were put in.
    pub bound: BTreeMap<String, Rational>,
    /// Time is in units of 1/this: the solution's equation has linear stiffness 1 where x' occurs.
    /// The series of the result are in the time of the problem.
    pub time_scale: Rational,
    /// The coefficients of the series as numbers; empty where nobody asked for decimals.
    pub numbers: Vec<Vec<Number>>,
    /// What the equation is made of.
    pub description: Option<Description>,
    /// The values of the constants of the ring.
    pub constants: Constants,
}

impl Derivation {
    /// With the coefficients as numbers of so many digits.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn with_numbers(mut self, digits: usize) -> Result<Self, DerivationError> {
        let numbers = self.series.iter().map(|series| self.numbers(series.quantity, digits));
        self.numbers = numbers.collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// The number of orders whose solution is known.
    #[must_use]
    pub fn solved(&self) -> usize {
        match self.solution {
            Solution::FrequencyOnly { .. } => 0,
            _ => self.order + 1,
        }
    }

    /// The series of that quantity.
    pub fn named(&self, quantity: Quantity) -> Option<&NamedSeries> {
        self.series.iter().find(|series| series.quantity == quantity)
    }

    /// Coefficient n of a series as an exact expression.
    pub fn exact(&self, quantity: Quantity, n: usize) -> Option<String> {
        let series = self.named(quantity)?;
        series.coefficients.get(n)?;
        Some(self.print_coefficient(series, n, Style::Text))
    }

    /// Coefficient n of a series as a fraction, where it is rational.
    ///
    /// ```
    /// use lindstedt_derivation::{Settings, derive};
    /// use lindstedt_equation::Quantity;
    /// let problem = lindstedt_problems::find("duffing").ok_or("no such problem")?;
    /// let duffing = derive(&problem, &Settings { order: 2, ..Settings::default() }, &mut |_| true)?;
    /// let first = duffing.ratio(Quantity::FrequencySquared, 1);
    /// assert_eq!(first.map(|q| q.to_string()).as_deref(), Some("3/4"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ratio(&self, quantity: Quantity, n: usize) -> Option<Ratio<BigInt>> {
        let series = self.named(quantity)?;
        let product = self.with_prefactor(series, series.coefficients.get(n)?)?;
        self.ring.as_rational(&product).map(|q| to_ratio(&q))
    }

    /// A coefficient times its power of the root of the stiffness, where that is in the ring: the
    /// root of a square is taken.
    fn with_prefactor(&self, series: &NamedSeries, coefficient: &Polynomial) -> Option<Polynomial> {
        let power = series.half_power;
        if power == 0 || self.ring.is_zero(coefficient) {
            return Some(coefficient.clone());
        }
        if power == 2 {
            return Some(self.ring.mul(coefficient, &self.stiffness));
        }
        let root = rational_root(&self.ring.as_rational(&self.stiffness)?)?;
        let root = if power < 0 { root.recip() } else { root };
        let factor = rug::ops::Pow::pow(root, power.unsigned_abs());
        Some(self.ring.scale(coefficient, &factor))
    }

    /// Coefficient n with its prefactor, printed.
    pub fn print_coefficient(&self, series: &NamedSeries, n: usize, style: Style) -> String {
        let Some(coefficient) = series.coefficients.get(n) else { return "0".to_owned() };
        if let Some(product) = self.with_prefactor(series, coefficient) {
            return self.ring.print(&product, style);
        }
        let power = series.half_power;
        let kappa = self.ring.print(&self.stiffness, style);
        let single = kappa.chars().all(|c| c.is_alphanumeric() || "_{}".contains(c));
        let factor = match style {
            Style::Text if single => format!("{kappa}^({power}/2)"),
            Style::Text => format!("({kappa})^({power}/2)"),
            Style::Latex if single => format!("{kappa}^{{{power}/2}}"),
            Style::Latex => format!(r"\left({kappa}\right)^{{{power}/2}}"),
        };
        if *coefficient == self.ring.one() {
            return factor;
        }
        let rest = self.ring.print(coefficient, style);
        match style {
            Style::Text => format!("{factor}*({rest})"),
            Style::Latex => format!(r"{factor}\left({rest}\right)"),
        }
    }

    /// kappa, the factor of x at order zero, printed.
    pub fn ring_print(&self, style: Style) -> String {
        self.ring.print(&self.stiffness, style)
    }

    /// W_n of omega^2 = kappa sum W_n eps^n for amplitude one, in the moments mu_m, printed; empty
    /// beyond the orders derived.
    pub fn frequency_correction(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly { .. } => String::new(),
            Solution::Clock(solution) => self.ring.print(&solution.frequency_squared()[n], style),
            Solution::Lobachevsky(expansion) => {
                self.ring.print(&expansion.frequency_squared[n], style)
            }
            Solution::Rational(proved) => Rationals.print(&proved.squared[n], style),
        }
    }

    /// x_n(0), printed.
    pub fn amplitude_correction(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly { .. } => String::new(),
            Solution::Clock(solution) => self.ring.print(&solution.amplitude()[n], style),
            Solution::Lobachevsky(expansion) => self.ring.print(&expansion.amplitude[n], style),
            Solution::Rational(proved) => Rationals.print(&proved.amplitude[n], style),
        }
    }

    /// Coefficient n of a series as a number with `digits` digits.
    ///
    /// # Errors
    /// [`DerivationError::NoValue`] for a coefficient that was not derived;
    /// [`DerivationError::NotEnoughBits`] when the digits cannot be reached.
    ///
    /// ```
    /// use lindstedt_derivation::{Settings, derive};
    /// use lindstedt_equation::Quantity;
    /// let problem = lindstedt_problems::find("power-law").ok_or("no such problem")?;
    /// let law = derive(&problem, &Settings { order: 1, ..Settings::default() }, &mut |_| true)?;
    /// let number = law.number(Quantity::FrequencySquared, 1, 10)?;
    /// assert_eq!(number.exact.as_deref(), Some("1 - 2*ln(2)"));
    /// assert_eq!(number.decimal, "-0.3862943611");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn number(
        &self,
        quantity: Quantity,
        n: usize,
        digits: usize,
    ) -> Result<Number, DerivationError> {
        let exact = self.exact(quantity, n).ok_or(DerivationError::NoValue)?;
        Ok(certified(Some(exact), digits, |balls| self.ball(quantity, n, balls))?)
    }

    /// All coefficients of a series as numbers.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn numbers(
        &self,
        quantity: Quantity,
        digits: usize,
    ) -> Result<Vec<Number>, DerivationError> {
        let length = self.named(quantity).map_or(0, |series| series.coefficients.len());
        (0..length).into_par_iter().map(|n| self.number(quantity, n, digits)).collect()
    }

    /// Coefficient n of a series as a ball.
    pub fn ball(&self, quantity: Quantity, n: usize, balls: Balls) -> Option<Ball> {
        let series = self.named(quantity)?;
        let coefficient = series.coefficients.get(n)?;
        let value = match self.by_clock(series, coefficient) {
            Some((solution, index)) => {
                solution.powers(&self.constants, balls)?[index].get(n)?.clone()
            }
            None => self.constants.evaluate(coefficient, balls)?,
        };
        if series.half_power == 0 {
            return Some(value);
        }
        let root = balls.sqrt(&self.constants.evaluate(&self.stiffness, balls)?)?;
        Some(balls.mul(&value, &balls.powi(&root, series.half_power.into())?))
    }

    /// The clock that knows a long coefficient of a power of its frequency, and the position of the power; nothing
    /// where the series has a factor besides.
    fn by_clock(&self, series: &NamedSeries, c: &Polynomial) -> Option<(&ClockSolution, usize)> {
        let Solution::Clock(solution) = &self.solution else { return None };
        let list = [Quantity::FrequencySquared, Quantity::Frequency, Quantity::Period];
        let index = list.iter().position(|power| *power == series.quantity)?;
        let all: usize = series.coefficients.iter().map(|c| c.terms().len()).sum();
        let scales = matches!(self.problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        let one = Exact::from(1);
        let alone = !scales || self.amplitude.as_ref().is_none_or(|a| *a == one);
        let long = c.terms().len() > FEW_TERMS && all > FEW_OF_ALL;
        let plain = alone && self.time_scale == 1 && long;
        plain.then_some((&**solution, index))
    }

    /// x_n printed, as a function of the phase `tau` = omega t; empty beyond the orders derived.
    pub fn print_solution(&self, n: usize, style: Style) -> String {
        if n > self.order {
            return String::new();
        }
        match &self.solution {
            Solution::FrequencyOnly { .. } => String::new(),
            Solution::Clock(solution) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                solution.function(n).map_or_else(String::new, |x| algebra.print(&x, "tau", style))
            }
            Solution::Lobachevsky(expansion) => {
                Lobachevsky::new(self.ring.clone()).print(&expansion.solution[n], "tau", style)
            }
            Solution::Rational(proved) => print_fractions(&proved.solution[n].fractions(), style),
        }
    }

    /// The right side f_n of x_n'' + x_n = f_n - W_n x_0'' in every style, printed where it has at most `most`
    /// terms, and their number; empty beyond the orders derived. Nothing where f_n is not formed, as it would
    /// cost more than all the rest: in the Lobachevsky ring where x_n has more than twice `most` terms.
    pub fn print_right_side<const N: usize>(
        &self,
        n: usize,
        styles: [Style; N],
        most: usize,
    ) -> Option<([String; N], usize)> {
        let nothing = || Some(([const { String::new() }; N], 0));
        if n > self.order {
            return nothing();
        }
        match &self.solution {
            Solution::Clock(solution) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let formed = solution.terms()[n] <= 2 * most;
                let f = formed.then(|| solution.right_side(&algebra, n)).flatten()?;
                Some(print_few(&algebra, &f, styles, most))
            }
            Solution::Lobachevsky(expansion) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let formed = expansion.solution[n].len() <= 2 * most;
                formed
                    .then(|| print_few(&algebra, &expansion.right_side(&algebra, n), styles, most))
            }
            Solution::FrequencyOnly { .. } => nothing(),
            Solution::Rational(proved) => {
                let terms = proved.right_side_terms(n);
                let f = if terms > most { Vec::new() } else { proved.right_side(n) };
                let print =
                    |style| if terms > most { String::new() } else { print_fractions(&f, style) };
                Some((styles.map(print), terms))
            }
        }
    }

    /// The number of terms of x_n; 0 beyond the orders derived.
    pub fn terms(&self, n: usize) -> usize {
        if n > self.order {
            return 0;
        }
        match &self.solution {
            Solution::FrequencyOnly { .. } => 0,
            Solution::Clock(solution) => solution.terms()[n],
            Solution::Lobachevsky(expansion) => expansion.solution[n].len(),
            Solution::Rational(proved) => proved.solution[n].terms(),
        }
    }
}

/// A function in every style, where it has at most so many terms, and their number.
fn print_few<A: PrintPhase + FunctionAlgebra, const N: usize>(
    algebra: &A,
    f: &A::Element,
    styles: [Style; N],
    most: usize,
) -> ([String; N], usize) {
    let terms = algebra.terms(f);
    let print = |style| if terms > most { String::new() } else { algebra.print(f, "tau", style) };
    (styles.map(print), terms)
}

/// A sum of cosines and sines; the empty one is 0.
fn print_fractions(list: &[Fraction], style: Style) -> String {
    let print = |f: &Fraction| {
        let term = Term::of_fraction(&f.numerator, &f.denominator, style);
        times_harmonic(term, if f.sine { "sin" } else { "cos" }, f.harmonic, "tau", style)
    };
    print_sum(&list.iter().map(print).collect::<Vec<_>>(), style)
}
