//! The numeric tiers of the driver: the same recursion over functions known by their values.
//!
//! Forces that no exact ring takes (|x|^p, sin x, x + sign x, quotients) are expanded here, and
//! the power law to orders where its exact solution has millions of terms. The numbers are
//! *estimated*: every expansion is computed on two grids of different accuracy, and four times the
//! largest difference of the two results up to that order stands beside each number.

use crate::answer::Object;
use crate::derivation::Settings;
use crate::derivation::prepare::prepare;
use crate::oscillator::condition_name;
use crate::{Error, Exact, Number, constants::sine_sum};
use lindstedt_algebra::{PhaseAlgebra, Rationals};
use lindstedt_coeff::floats::{Doubles, Floats, Reals};
use lindstedt_equation::print::Style;
use lindstedt_equation::symmetry::moving_singularity;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Function, Problem};
use lindstedt_expand::{
    Binding, ExpandError, OrderWork, Request, compile, expand, leading_amplitude,
};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::Trigonometric;
use lindstedt_phase::collocation::{Collocation, Grid};
use lindstedt_series::Series;
use rug::float::Special;
use rug::{Float, Rational};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// How the numbers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Tier {
    /// Values at double-exponential nodes, at the precision that `digits` correct digits need;
    /// grids are refined until two agree to that.
    Collocation {
        /// Correct digits of every coefficient.
        digits: u32,
    },
    /// The same in double precision.
    Doubles,
    /// A truncated Fourier series in double precision: the cheap tier. With singularities at
    /// x = 0 (logarithms, signs) it converges like a power of 1/harmonics only.
    Fourier {
        /// The number of harmonics of each symmetry class.
        harmonics: usize,
    },
}

/// A series of estimated numbers.
#[derive(Clone, Debug)]
pub struct EstimatedSeries {
    /// As in [`crate::NamedSeries::name`].
    pub name: &'static str,
    /// From order 0: the coefficient and the estimate of its absolute error.
    pub coefficients: Vec<(Float, Float)>,
}

/// An expansion in estimated numbers.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The tier.
    pub tier: Tier,
    /// The normalisation used.
    pub condition: Condition,
    /// The highest order derived.
    pub order: usize,
    /// The nodes of the finer grid.
    pub nodes: usize,
    /// The bits computed with.
    pub bits: u32,
    /// Products of phase functions on the finer grid.
    pub products: u64,
    /// The series of the result.
    pub series: Vec<EstimatedSeries>,
    /// The name of the small parameter.
    pub parameter: String,
    /// The coefficients as numbers, series by series, as far as they have one digit; empty where nobody
    /// asked for decimals.
    pub numbers: Vec<Vec<Option<Number>>>,
}

impl Tier {
    /// The name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        if matches!(self, Self::Fourier { .. }) { "fourier" } else { "collocation" }
    }
}

impl Serialize for Estimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Method {
            name: &'static str,
            nodes: usize,
            bits: u32,
            products: u64,
        }
        let named = self.series.iter().map(|series| series.name).zip(&self.numbers);
        let series = Object(named.collect());
        let method = Method {
            name: "the same recursion on two grids",
            nodes: self.nodes,
            bits: self.bits,
            products: self.products,
        };
        let unchecked = Object(vec![("checked_orders", None::<bool>), ("zero", None)]);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &self.parameter)?;
        map.serialize_entry("normalisation", condition_name(self.condition))?;
        map.serialize_entry("series", &series)?;
        map.serialize_entry::<_, [&str; 0]>("solution", &[])?;
        map.serialize_entry("residual", &unchecked)?;
        map.serialize_entry("method", &method)?;
        map.end()
    }
}

impl Estimate {
    /// With the coefficients as numbers of at most so many digits.
    pub(crate) fn with_numbers(mut self, digits: usize, parameter: &str) -> Self {
        let row = |series: &EstimatedSeries| {
            (0..series.coefficients.len()).map(|n| series.number(n, digits)).collect()
        };
        self.numbers = self.series.iter().map(row).collect();
        parameter.clone_into(&mut self.parameter);
        self
    }

    /// The series of that name.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&EstimatedSeries> {
        self.series.iter().find(|series| series.name == name)
    }
}

impl EstimatedSeries {
    /// Coefficient n with at most `digits` digits, as many as the estimate supports and two more;
    /// nothing where its error is infinite.
    #[must_use]
    pub fn number(&self, n: usize, digits: usize) -> Option<Number> {
        let (value, error) = self.coefficients.get(n)?;
        Number::with_error(value, error, digits)
    }
}

/// What may go wrong with a grid: refine at most so many times.
const REFINEMENTS: usize = 6;
/// More nodes than this are refused: a solution costs their square.
const MOST_NODES: usize = 1 << 14;

/// Derives an expansion in a numeric tier. `settings.route` does not apply.
///
/// `observer` is told every finished order of every grid; when it returns `false`, the derivation
/// ends with an error (one grid alone has no error estimate).
///
/// # Errors
/// [`Error`] with the reason; [`Error::MovingSingularity`] for forces like |x| that are not part of an
/// odd equation which can be run backwards; [`Error::NotEnoughBits`] when refining the grid does not reach the
/// digits (a force that is singular inside the quarter period, for example).
///
/// # Example
/// ```
/// use lindstedt::numeric::{Tier, derive};
/// use lindstedt::{Settings, problems};
/// let problem = problems::find("power-law").ok_or("no such problem")?;
/// let settings = Settings { order: 3, ..Settings::default() };
/// let result = derive(&problem, &settings, Tier::Collocation { digits: 30 }, &mut |_| true)?;
/// let alpha = result.named("frequency_squared").and_then(|s| s.number(1, 30)).ok_or("none")?;
/// assert_eq!(alpha.decimal, "-0.386294361119890618834464242916");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    problem: &Problem,
    settings: &Settings,
    tier: Tier,
    observer: &mut dyn FnMut(&OrderWork) -> bool,
) -> Result<Estimate, Error> {
    crate::derivation::check_parameters(problem, &settings.parameters)?;
    let condition = crate::derivation::condition(problem, settings.condition)?;
    if let Some(term) = moving_singularity(&problem.equation) {
        let term = term.print(&problem.small, Style::Text);
        return Err(Error::MovingSingularity { term });
    }
    limit_memory(settings, 32, 64)?;
    // The amplitude that is scaled out is part of the equation; a limit cycle's is found exactly.
    let changed = problem.amplitude == AmplitudeRole::Scaled || condition == Condition::LimitCycle;
    let asked = Settings { condition: Some(condition), ..settings.clone() };
    let prepared = if changed { Some(prepare(problem, &asked)?) } else { None };
    let problem = prepared.as_ref().map_or(problem, |prepared| &prepared.problem);
    let mut job = Job { problem, settings, condition, observer };
    let mut estimate = job.estimate(tier)?;
    if let Some(prepared) = &prepared {
        estimate.undo_time_scale(&prepared.time_scale);
    }
    Ok(estimate)
}

impl Estimate {
    /// Powers of the frequency in the time of the problem: omega = w Omega.
    fn undo_time_scale(&mut self, w: &Rational) {
        if *w == 1 {
            return;
        }
        for named in &mut self.series {
            let factor = match named.name {
                "frequency_squared" => Rational::from(w * w),
                "frequency" => w.clone(),
                "period_over_2pi" => Rational::from(w.recip_ref()),
                _ => continue,
            };
            for (value, error) in &mut named.coefficients {
                *value *= &factor;
                *error *= &factor;
            }
        }
    }
}

impl Job<'_> {
    fn estimate(&mut self, tier: Tier) -> Result<Estimate, Error> {
        match tier {
            Tier::Collocation { digits } => self.refine(tier, digits),
            Tier::Doubles => {
                let run = |job: &mut Job<'_>, (accuracy, end)| {
                    let algebra = Collocation::new(Doubles, Grid::new(accuracy, end));
                    let algebra = algebra.with_stop(job.settings.stop.clone());
                    job.run(&algebra, algebra.nodes())
                };
                // A solution is known to about 1e-16: where cos psi is smaller than that, x_n/x_0 is
                // noise, and its powers must not enter. So the grids end before.
                let coarse = run(self, (55.0, 30.0))?;
                let fine = run(self, (62.0, 32.0))?;
                let estimate = self.compare(tier, &[coarse], fine, 53);
                Ok(self.scaled_to_amplitude(estimate))
            }
            Tier::Fourier { harmonics } => {
                let run = |job: &mut Job<'_>, harmonics| {
                    let algebra = Collocation::fourier(Doubles, harmonics);
                    job.run(&algebra.with_stop(job.settings.stop.clone()), harmonics)
                };
                let harmonics = harmonics.clamp(4, MOST_NODES);
                limit_memory(self.settings, harmonics, 64)?;
                // Algebraic convergence is uneven at high orders: three numbers of harmonics.
                let coarse = [run(self, harmonics.div_ceil(4))?, run(self, harmonics.div_ceil(2))?];
                let fine = run(self, harmonics)?;
                let estimate = self.compare(tier, &coarse, fine, 53);
                Ok(self.scaled_to_amplitude(estimate))
            }
        }
    }
}

/// Refuses before allocating: a value takes its bits and 48 bytes, an order about 12 lists of them
/// (x, x', x'' and the coefficients of some nodes of the equation).
fn limit_memory(settings: &Settings, nodes: usize, bits: u32) -> Result<(), Error> {
    let value = f64::from(bits) / 8.0 + 48.0;
    let bytes = (settings.order as f64 + 1.0) * nodes as f64 * value * 12.0;
    if bytes > settings.memory as f64 {
        return Err(Error::TooLarge {
            order: settings.order,
            exponent: bytes.log10().round() as u64,
            limit: settings.memory >> 20,
        });
    }
    Ok(())
}

/// One run on one grid.
struct Run {
    nodes: usize,
    products: u64,
    series: Vec<(&'static str, Vec<Float>)>,
}

struct Job<'a> {
    problem: &'a Problem,
    settings: &'a Settings,
    condition: Condition,
    observer: &'a mut dyn FnMut(&OrderWork) -> bool,
}

impl Job<'_> {
    /// Two grids, the finer one with six more digits; finer ones until they agree.
    fn refine(&mut self, tier: Tier, digits: u32) -> Result<Estimate, Error> {
        let mut guard = 0;
        let mut coarse: Option<Run> = None;
        let mut bits = 0;
        for _ in 0..REFINEMENTS {
            let wanted = digits.saturating_add(guard);
            let (grid, needed) = Grid::for_digits(wanted, self.settings.order);
            if grid.nodes > MOST_NODES {
                break;
            }
            bits = needed;
            limit_memory(self.settings, grid.nodes, bits)?;
            let algebra = Collocation::new(Floats::new(bits), grid);
            let algebra = algebra.with_stop(self.settings.stop.clone());
            let run = self.run(&algebra, grid.nodes)?;
            let Some(before) = coarse.replace(run) else {
                guard = 6;
                continue;
            };
            let Some(fine) = coarse.take() else { break };
            let plain = self.compare(tier, &[before], fine, bits);
            let estimate = self.scaled_to_amplitude(plain.clone());
            let tolerance = Float::with_val(53, Float::i_pow_u(10, digits)).recip();
            let missing = |(value, error): &(Float, Float)| {
                let size = Float::with_val(53, value.abs_ref());
                let allowed = if size > 1 { size * &tolerance } else { tolerance.clone() };
                let ratio = Float::with_val(53, error / &allowed);
                if ratio.is_finite() { ratio.log10().to_f64().ceil() } else { f64::INFINITY }
            };
            let coefficients = estimate.series.iter().flat_map(|s| &s.coefficients);
            let missing = coefficients.map(missing).fold(f64::NEG_INFINITY, f64::max);
            if missing <= 0.0 {
                return Ok(estimate);
            }
            let values = |s: &EstimatedSeries| {
                (s.name, s.coefficients.iter().map(|(v, _)| v.clone()).collect())
            };
            let series = plain.series.iter().map(values).collect();
            coarse = Some(Run { nodes: plain.nodes, products: plain.products, series });
            guard += (missing as u32).clamp(6, digits + 20);
        }
        Err(Error::NotEnoughBits { bits, best: None })
    }

    /// Four times the largest difference between the finest grid and the others at this and at
    /// lower orders (an accidental agreement at one order says nothing), and rounding errors
    /// relative to the largest coefficient so far.
    /// Sixteen times for the truncated Fourier series, which converges algebraically: far from
    /// resolution two truncations are wrong together.
    ///
    /// Two grids may round a coefficient to the same double, and the recurrence then amplifies the
    /// same error in both: where the error has reached the largest coefficient, nothing is said of
    /// this one and of those that follow from it (an infinite error).
    fn compare(&self, tier: Tier, coarse: &[Run], fine: Run, bits: u32) -> Estimate {
        let estimated = |(index, (name, values)): (usize, (&'static str, Vec<Float>))| {
            let mut error = rounding(&Float::with_val(53, 1), bits);
            let safety = if matches!(tier, Tier::Fourier { .. }) { 16u32 } else { 4 };
            let mut coefficients = Vec::new();
            let mut largest = Float::with_val(53, 1);
            for (n, value) in values.into_iter().enumerate() {
                let others = coarse.iter().filter_map(|run| run.series.get(index)?.1.get(n));
                for other in others {
                    let difference = Float::with_val(53, &value - other).abs() * safety;
                    if difference > error || difference.is_nan() {
                        error = difference;
                    }
                }
                error = error.max(&rounding(&value, bits));
                largest = largest.max(&Float::with_val(53, value.abs_ref()));
                if error >= largest || error.is_nan() {
                    error = Float::with_val(53, Special::Infinity);
                }
                coefficients.push((value, error.clone()));
            }
            EstimatedSeries { name, coefficients }
        };
        let series: Vec<_> = fine.series.into_iter().enumerate().map(estimated).collect();
        Estimate {
            tier,
            condition: self.condition,
            order: series.first().map_or(0, |s| s.coefficients.len().saturating_sub(1)),
            nodes: fine.nodes,
            bits,
            products: fine.products,
            series,
            parameter: String::new(),
            numbers: Vec::new(),
        }
    }

    fn run<A: PhaseAlgebra>(&mut self, algebra: &A, nodes: usize) -> Result<Run, Error>
    where
        A::Constants: Reals,
    {
        let reals = algebra.constants();
        let given = Given { settings: self.settings, problem: self.problem, reals };
        let order = self.settings.order;
        let equation = compile(algebra, &as_powers(&self.problem.equation), &given, order)?;
        let leading_amplitude = match self.condition {
            // Found exactly: a root of an averaged polynomial.
            Condition::LimitCycle => {
                let plain = Trigonometric::new(Rationals);
                let exact =
                    compile(&plain, &self.problem.equation, &ExactValues(self.settings), order)?;
                leading_amplitude(&plain, &exact, self.condition)?
            }
            _ => leading_amplitude(algebra, &equation, self.condition)?,
        };
        let request = Request { condition: self.condition, order, leading_amplitude };
        let expansion = expand(algebra, &equation, &request, self.observer)?;
        if expansion.order() < order {
            return Err(ExpandError::Interrupted { order: expansion.order() + 1 }.into());
        }
        let kappa = reals.to_float(&expansion.stiffness);
        if kappa <= 0 || !kappa.is_finite() {
            return Err(ExpandError::NegativeStiffness.into());
        }
        let squared = Series::truncated(expansion.frequency_squared);
        let root = kappa.sqrt();
        let mut series = Vec::new();
        for (name, power) in POWERS {
            let half = Rational::from((power, 2));
            let list = squared.power(reals, &half).ok_or(Error::NoValue)?;
            let factor = rug::ops::Pow::pow(root.clone(), power);
            let value = |c: &_| reals.to_float(c) * &factor;
            series.push((name, list.coefficients.iter().map(value).collect()));
        }
        let name = match self.condition {
            Condition::InitialAmplitude => None,
            Condition::FundamentalAmplitude | Condition::FreeAmplitude => {
                Some("initial_displacement")
            }
            Condition::LimitCycle => Some("amplitude"),
        };
        if let Some(name) = name {
            series.push((name, expansion.amplitude.iter().map(|c| reals.to_float(c)).collect()));
        }
        let products = expansion.work.iter().map(|work| work.products).sum();
        Ok(Run { nodes, products, series })
    }

    /// The factor a^(power exponent eps/2), where the amplitude scales the frequency; its
    /// coefficients (ln a)^n/n! may be huge, so the errors go through the product too.
    fn scaled_to_amplitude(&self, mut estimate: Estimate) -> Estimate {
        let amplitude = self.settings.parameters.get("amplitude");
        let (AmplitudeRole::ScalesFrequency { exponent }, Some(a)) =
            (self.problem.amplitude, amplitude)
        else {
            return estimate;
        };
        let work = estimate.bits.saturating_add(64);
        let Some(log) = Balls::new(work).ln(&a.ball(Balls::new(work.saturating_add(64)))) else {
            return estimate;
        };
        for series in &mut estimate.series {
            let Some((_, power)) = POWERS.iter().find(|(name, _)| *name == series.name) else {
                continue;
            };
            let rate = Float::with_val(work, log.midpoint() * (exponent * power)) / 2u32;
            let mut factor = vec![Float::with_val(work, 1)];
            for n in 1..series.coefficients.len() {
                let term = factor.last().map(|last| Float::with_val(work, last * &rate) / n as u64);
                factor.extend(term);
            }
            let coefficient = |n: usize| {
                let terms = series.coefficients.iter().take(n + 1).zip(factor[..=n].iter().rev());
                let (mut sum, mut error) = (Float::new(work), Float::new(53));
                for ((value, uncertainty), f) in terms {
                    sum += value * f;
                    if !f.is_zero() {
                        error += Float::with_val(53, uncertainty * f).abs();
                    }
                }
                let value = Float::with_val(estimate.bits, &sum);
                let error = error + rounding(&value, estimate.bits);
                (value, error)
            };
            series.coefficients = (0..series.coefficients.len()).map(coefficient).collect();
        }
        estimate
    }
}

/// The series of powers of the frequency.
const POWERS: [(&str, i32); 3] =
    [("frequency_squared", 2), ("frequency", 1), ("period_over_2pi", -1)];

/// |z| = (z^2)^(1/2) and sgn z = z (z^2)^(-1/2), which are powers of values like others.
fn as_powers(equation: &Expression) -> Expression {
    let power = |z: &Expression, twice: i32| {
        z.clone().pow(2).pow(Expression::Number(Rational::from((twice, 2))))
    };
    equation.map(&|e| match e {
        Expression::Function(Function::Abs, z) => Some(power(&as_powers(z), 1)),
        Expression::Function(Function::Sign, z) => {
            let z = as_powers(z);
            Some(power(&z, -1) * z)
        }
        _ => None,
    })
}

/// 64 roundings at so many bits.
fn rounding(value: &Float, bits: u32) -> Float {
    Float::with_val(53, value.abs_ref()) >> bits.saturating_sub(6)
}

/// The middle of a ball in a context of floats.
fn real<R: Reals>(reals: &R, ball: &Ball) -> R::Element {
    reals.nearest(ball.midpoint())
}

/// Values of parameters and of the formal sums S_n.
struct Given<'a, R> {
    settings: &'a Settings,
    problem: &'a Problem,
    reals: &'a R,
}

impl<R: Reals> Given<'_, R> {
    fn value(&self, name: &str) -> Option<Exact> {
        let card = || self.problem.parameters.iter().find(|card| card.name == name);
        let given = self.settings.parameters.get(name).cloned();
        given.or_else(|| Exact::parse(&card()?.default).ok())
    }
}

impl<R: Reals> Binding<R> for Given<'_, R> {
    fn parameter(&self, name: &str) -> Option<R::Element> {
        let balls = Balls::new(self.reals.bits() + 16);
        Some(real(self.reals, &self.value(name)?.ball(balls)))
    }
    fn formal(&self, name: &str, n: usize) -> Option<R::Element> {
        if name != crate::derivation::FORMAL {
            return None;
        }
        // S_n with small n cancels: the Taylor series of sin at the amplitude.
        let balls = Balls::new(self.reals.bits() + 64);
        let amplitude = self.value("amplitude")?.ball(balls);
        Some(real(self.reals, &sine_sum(u16::try_from(n).ok()?, &amplitude, balls)))
    }
}

/// Exact values of parameters.
struct ExactValues<'a>(&'a Settings);

impl Binding<Rationals> for ExactValues<'_> {
    fn parameter(&self, name: &str) -> Option<Rational> {
        self.0.parameters.get(name)?.as_rational().cloned()
    }
    fn formal(&self, _: &str, _: usize) -> Option<Rational> {
        None
    }
}
