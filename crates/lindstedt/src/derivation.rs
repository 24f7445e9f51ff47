//! From a problem to a checked expansion: the call behind `lindstedt derive`.

use crate::multimodular::{self, RationalBinding};
use crate::number::{Constants, Number, certified};
use crate::{Error, Value};
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra, Rationals, Ring};
use lindstedt_coeff::ball::{Ball, Balls};
use lindstedt_coeff::closed_forms::ClosedForms;
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Function, Problem};
use lindstedt_expand::{Binding, Expansion, Request, check, compile, expand, leading_amplitude};
use lindstedt_phase::print::PrintPhase;
use lindstedt_phase::{Lobachevsky, Trigonometric};
use lindstedt_series::Series;
use rayon::prelude::*;
use rug::Rational;
use std::collections::BTreeMap;

/// What to derive.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The highest order.
    pub order: usize,
    /// The normalisation; the problem's default if nothing.
    pub condition: Option<Condition>,
    /// Values of parameters by name.
    pub parameters: BTreeMap<String, Value>,
    /// The memory that may be used, in bytes.
    pub memory: u64,
}

impl Default for Settings {
    /// Order 4, the problem's own normalisation and parameters, 8 GiB.
    fn default() -> Self {
        Self { order: 4, condition: None, parameters: BTreeMap::new(), memory: 8 << 30 }
    }
}

/// Progress of a derivation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// An order is finished; with the number of terms of its solution.
    Order(usize, usize),
    /// So many primes are done (problems over Q; their number is not known beforehand).
    Primes(usize),
    /// The finished expansion is being substituted into the equation.
    Checking,
}

/// A power series that belongs to the result: prefactor * sum c_n eps^n.
#[derive(Clone, Debug)]
pub struct NamedSeries {
    /// `frequency_squared`, `frequency`, `period_over_2pi` or `amplitude`.
    pub name: &'static str,
    /// A factor kappa^(half_power/2) in front, kappa the linear stiffness; 0 when kappa = 1.
    pub half_power: i32,
    /// The coefficients in the small parameter, exact.
    pub coefficients: Vec<Polynomial>,
}

/// The solution, in the algebra that the equation needed.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Solution {
    /// In the Lobachevsky ring.
    Lobachevsky(Box<Expansion<Lobachevsky<PolynomialRing>>>),
    /// Trigonometric polynomials over Q.
    Rational(Box<multimodular::Proved>),
}

/// A checked expansion.
#[derive(Debug)]
pub struct Derivation {
    /// The problem.
    pub problem: Problem,
    /// The normalisation used.
    pub condition: Condition,
    /// The highest order derived (lower than asked for when interrupted).
    pub order: usize,
    /// Orders whose residual vanishes identically: 0..=this.
    pub checked_orders: usize,
    /// The ring of the coefficients.
    pub ring: PolynomialRing,
    /// kappa, the factor of x at order zero.
    pub stiffness: Polynomial,
    /// The series of the result.
    pub series: Vec<NamedSeries>,
    /// The solution.
    pub solution: Solution,
    constants: Constants,
}

/// The constants of a problem whose parameters stay formal, except the rational ones given.
struct Bound {
    ring: PolynomialRing,
}

impl Binding<PolynomialRing> for Bound {
    fn parameter(&self, _: &str) -> Option<Polynomial> {
        None
    }
    fn formal(&self, _: &str, n: usize) -> Option<Polynomial> {
        Some(self.ring.symbol(Symbol::Sum(u16::try_from(n).ok()?)))
    }
}

struct NoParameters;

impl RationalBinding for NoParameters {
    fn parameter(&self, _: &str) -> Option<Rational> {
        None
    }
}

/// Derives and checks the expansion of a problem.
///
/// `observer` is told the progress; when it returns `false` the derivation stops with the orders
/// finished so far (over Q, where all orders are finished together, with an error).
///
/// # Errors
/// [`Error`] with the reason; nothing is ever dropped or approximated silently.
///
/// # Example
/// ```
/// use lindstedt::{Settings, derive, problems};
/// let problem = problems::find("duffing").ok_or("no such problem")?;
/// let result = derive(&problem, &Settings { order: 3, ..Settings::default() }, &mut |_| true)?;
/// assert_eq!(result.exact("frequency", 2).as_deref(), Some("-21/256"));
/// assert_eq!(result.checked_orders, 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    problem: &Problem,
    settings: &Settings,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Derivation, Error> {
    check_parameters(problem, &settings.parameters)?;
    let condition = match settings.condition {
        None => problem.conditions.first().copied(),
        Some(asked) => problem.conditions.iter().copied().find(|c| *c == asked),
    };
    let condition =
        condition.ok_or_else(|| Error::UnknownCondition { problem: problem.name.to_owned() })?;
    let amplitude = settings.parameters.get("amplitude").cloned();
    let has_logarithms = has_logarithms(&problem.equation);
    limit_memory(problem, settings)?;
    let ring = PolynomialRing { parameters: vec!["ln(a)".to_owned()] };
    let (solution, squared, amplitudes, stiffness, checked_orders) = if has_logarithms {
        let algebra = Lobachevsky::new(ring.clone());
        let equation =
            compile(&algebra, &problem.equation, &Bound { ring: ring.clone() }, settings.order)?;
        let leading_amplitude = leading_amplitude(&algebra, &equation, condition)?;
        let request = Request { condition, order: settings.order, leading_amplitude };
        let mut on_order =
            |work: &lindstedt_expand::OrderWork| observer(Progress::Order(work.order, work.terms));
        let expansion = expand(&algebra, &equation, &request, &mut on_order)?;
        observer(Progress::Checking);
        let checked = check(&algebra, &equation, &expansion)?;
        let squared = expansion.frequency_squared.clone();
        let (amplitudes, stiffness) = (expansion.amplitude.clone(), expansion.stiffness.clone());
        (Solution::Lobachevsky(Box::new(expansion)), squared, amplitudes, stiffness, checked)
    } else {
        let mut on_primes = |primes| observer(Progress::Primes(primes));
        let proved = multimodular::derive(
            &problem.equation,
            &NoParameters,
            condition,
            settings.order,
            &mut on_primes,
        )?;
        let constants =
            |list: &[Rational]| list.iter().map(|q| ring.rational(q)).collect::<Vec<_>>();
        let squared = constants(&proved.expansion.frequency_squared);
        let amplitudes = constants(&proved.expansion.amplitude);
        let stiffness = ring.rational(&proved.expansion.stiffness);
        let order = proved.expansion.order();
        (Solution::Rational(Box::new(proved)), squared, amplitudes, stiffness, order)
    };
    let series =
        series(problem, &ring, condition, squared, amplitudes, amplitude.as_ref(), &stiffness)?;
    let default = problem.parameters.iter().find(|p| p.name == "amplitude");
    let amplitude = match amplitude {
        Some(value) => Some(value),
        None => default.map(|card| Value::parse(card.default)).transpose()?,
    };
    Ok(Derivation {
        problem: problem.clone(),
        condition,
        order: series.first().map_or(0, |s| s.coefficients.len() - 1),
        checked_orders,
        ring,
        stiffness,
        series,
        solution,
        constants: Constants::new(amplitude),
    })
}

/// The series of the result from omega^2/kappa.
fn series(
    problem: &Problem,
    ring: &PolynomialRing,
    condition: Condition,
    squared: Vec<Polynomial>,
    amplitudes: Vec<Polynomial>,
    amplitude: Option<&Value>,
    stiffness: &Polynomial,
) -> Result<Vec<NamedSeries>, Error> {
    // What is printed is the closed form where there is one; mu_m stay where S_n stand beside.
    let order = squared.len() - 1;
    let has_sums = matches!(problem.amplitude, AmplitudeRole::InSums);
    let squared: Vec<Polynomial> = if has_sums {
        squared
    } else {
        let forms = ClosedForms::new(u16::try_from(order).unwrap_or(u16::MAX));
        let close = |p: &Polynomial| forms.closed_form(ring, p).ok_or(Error::NoValue);
        squared.par_iter().map(close).collect::<Result<_, _>>()?
    };
    let squared = Series::truncated(squared);
    let power = |p: (i32, u32)| {
        let exponent = Rational::from(p);
        squared.power(ring, &exponent).ok_or(Error::NoValue)
    };
    // a^(exponent eps) = exp(exponent eps ln a) for an amplitude other than one.
    let scale = match (problem.amplitude, amplitude) {
        (AmplitudeRole::ScalesFrequency { exponent }, Some(a))
            if a.as_rational() != Some(&Rational::from(1)) =>
        {
            exponent
        }
        _ => 0,
    };
    let scaled = |series: Series<Polynomial>, power: (i32, u32)| {
        if scale == 0 {
            return series;
        }
        let rate = Rational::from(scale) * Rational::from(power);
        let log = ring.scale(&ring.symbol(Symbol::Parameter(0)), &rate);
        let mut term = ring.one();
        let mut factor = vec![term.clone()];
        for n in 1..=order {
            term = ring.scale(&ring.mul(&term, &log), &Rational::from((1, n)));
            factor.push(term.clone());
        }
        series.mul(ring, &Series::truncated(factor), order)
    };
    let is_one = *stiffness == ring.one();
    let half_power = |p: i32| if is_one { 0 } else { p };
    let mut list = vec![
        NamedSeries {
            name: "frequency_squared",
            half_power: half_power(2),
            coefficients: scaled(squared.clone(), (1, 1)).coefficients,
        },
        NamedSeries {
            name: "frequency",
            half_power: half_power(1),
            coefficients: scaled(power((1, 2))?, (1, 2)).coefficients,
        },
        NamedSeries {
            name: "period_over_2pi",
            half_power: half_power(-1),
            coefficients: scaled(power((-1, 2))?, (-1, 2)).coefficients,
        },
    ];
    if condition != Condition::InitialAmplitude {
        list.push(NamedSeries { name: "amplitude", half_power: 0, coefficients: amplitudes });
    }
    Ok(list)
}

fn check_parameters(problem: &Problem, given: &BTreeMap<String, Value>) -> Result<(), Error> {
    for (name, value) in given {
        if !problem.parameters.iter().any(|card| card.name == name) {
            let known: Vec<&str> = problem.parameters.iter().map(|card| card.name).collect();
            return Err(Error::UnknownParameter {
                problem: problem.name.to_owned(),
                name: name.clone(),
                known: known.join(", "),
            });
        }
        let outside =
            |domain| Error::OutsideDomain { name: name.clone(), value: value.to_string(), domain };
        let ball = value.ball(Balls::new(64));
        let balls = Balls::new(256);
        let exact = value.ball(balls);
        match name.as_str() {
            "amplitude" => match problem.amplitude {
                AmplitudeRole::ScalesFrequency { .. } if !ball.is_positive() => {
                    return Err(outside("amplitude > 0 (there is no oscillation at amplitude 0)"));
                }
                AmplitudeRole::InSums => {
                    // pi itself is the separatrix; a rational multiple of pi is compared exactly.
                    let below = match value {
                        Value::PiTimes(q) => *q < 1,
                        Value::Rational(_) => balls.sub(&balls.pi(), &exact).is_positive(),
                    };
                    if !ball.is_positive() || !below {
                        return Err(outside("0 < amplitude < pi (at pi the period is infinite)"));
                    }
                }
                AmplitudeRole::InSmallParameter if !exact.is_positive() => {
                    return Err(outside("amplitude > 0 (there is no oscillation at amplitude 0)"));
                }
                _ => {}
            },
            "n" | "delta"
                if problem.amplitude == (AmplitudeRole::ScalesFrequency { exponent: 2 }) =>
            {
                if !balls.add(&exact, &balls.one()).is_positive() {
                    return Err(outside("greater than -1"));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Whether the equation needs the Lobachevsky ring.
fn has_logarithms(expression: &Expression) -> bool {
    match expression {
        Expression::Sum(list) | Expression::Product(list) => list.iter().any(has_logarithms),
        Expression::Power(base, exponent) => {
            !matches!(**exponent, Expression::Number(_)) || has_logarithms(base)
        }
        Expression::Function(Function::Ln, _) | Expression::Formal(..) => true,
        Expression::Function(_, argument) => has_logarithms(argument),
        _ => false,
    }
}

/// Refuses before allocating. Measured: the Lobachevsky ring takes 0.7 GiB at order 20 and 1.5
/// times more per order; with formal sums 0.1 GiB at order 10 and twice as much per order; van
/// der Pol's series over Q 0.42 GiB at order 164, growing like the fourth power of the order.
fn limit_memory(problem: &Problem, settings: &Settings) -> Result<(), Error> {
    let order = settings.order as f64;
    let gibibytes = if matches!(problem.amplitude, AmplitudeRole::InSums) {
        0.1f64.log2() + (order - 10.0)
    } else if has_logarithms(&problem.equation) {
        0.7f64.log2() + (order - 20.0) * 1.5f64.log2()
    } else {
        0.42f64.log2() + 4.0 * (order / 164.0).log2()
    };
    let bits = gibibytes + 30.0;
    if bits > (settings.memory.max(1) as f64).log2() {
        return Err(Error::TooLarge {
            order: settings.order,
            exponent: (bits * 2f64.log10()).round() as u64,
            limit: settings.memory >> 20,
        });
    }
    Ok(())
}

impl Derivation {
    /// The series of that name.
    pub fn named(&self, name: &str) -> Option<&NamedSeries> {
        self.series.iter().find(|series| series.name == name)
    }

    /// Coefficient n of a series as an exact expression.
    pub fn exact(&self, name: &str, n: usize) -> Option<String> {
        let series = self.named(name)?;
        Some(self.print_coefficient(series, n, Style::Text))
    }

    /// Coefficient n with its prefactor, printed.
    pub fn print_coefficient(&self, series: &NamedSeries, n: usize, style: Style) -> String {
        let Some(coefficient) = series.coefficients.get(n) else { return "0".to_owned() };
        if self.ring.is_zero(coefficient) || series.half_power == 0 {
            return self.ring.print(coefficient, style);
        }
        if series.half_power == 2 {
            return self.ring.print(&self.ring.mul(coefficient, &self.stiffness), style);
        }
        let kappa = self.ring.print(&self.stiffness, style);
        let factor = match style {
            Style::Text => format!("{kappa}^({}/2)", series.half_power),
            Style::Latex => format!("{kappa}^{{{}/2}}", series.half_power),
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

    /// Coefficient n of a series without its prefactor, printed.
    pub fn ring_coefficient(&self, series: &NamedSeries, n: usize, style: Style) -> String {
        series.coefficients.get(n).map_or_else(|| "0".to_owned(), |c| self.ring.print(c, style))
    }

    /// Coefficient n of a series as a number with `digits` digits.
    ///
    /// # Errors
    /// [`Error::NotEnoughBits`] when the digits cannot be reached.
    pub fn number(&self, series: &NamedSeries, n: usize, digits: usize) -> Result<Number, Error> {
        let exact = self.print_coefficient(series, n, Style::Text);
        certified(Some(exact), digits, |balls| self.ball(series, n, balls))
    }

    /// Coefficient n of a series as a ball.
    pub fn ball(&self, series: &NamedSeries, n: usize, balls: Balls) -> Option<Ball> {
        let value = self.constants.evaluate(series.coefficients.get(n)?, balls)?;
        if series.half_power == 0 {
            return Some(value);
        }
        let root = balls.sqrt(&self.constants.evaluate(&self.stiffness, balls)?)?;
        Some(balls.mul(&value, &balls.powi(&root, series.half_power.into())?))
    }

    /// x_n printed, as a function of the phase `tau` = omega t.
    pub fn print_solution(&self, n: usize, style: Style) -> String {
        match &self.solution {
            Solution::Lobachevsky(expansion) => {
                Lobachevsky::new(self.ring.clone()).print(&expansion.solution[n], "tau", style)
            }
            Solution::Rational(proved) => {
                Trigonometric::new(Rationals).print(&proved.expansion.solution[n], "tau", style)
            }
        }
    }

    /// The right side f_n of x_n'' + x_n = f_n - W_n x_0'', printed, and its number of terms.
    pub fn print_right_side(&self, n: usize, style: Style) -> (String, usize) {
        match &self.solution {
            Solution::Lobachevsky(expansion) => {
                let algebra = Lobachevsky::new(self.ring.clone());
                let f = expansion.right_side(&algebra, n);
                (algebra.print(&f, "tau", style), algebra.terms(&f))
            }
            Solution::Rational(proved) => {
                let algebra = Trigonometric::new(Rationals);
                let f = proved.expansion.right_side(&algebra, n);
                (algebra.print(&f, "tau", style), algebra.terms(&f))
            }
        }
    }

    /// The number of terms of x_n.
    pub fn terms(&self, n: usize) -> usize {
        match &self.solution {
            Solution::Lobachevsky(expansion) => expansion.solution[n].len(),
            Solution::Rational(proved) => {
                Trigonometric::new(Rationals).terms(&proved.expansion.solution[n])
            }
        }
    }
}
