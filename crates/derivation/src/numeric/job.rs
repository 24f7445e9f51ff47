//! One expansion on several grids, and what their differences say.

use super::amplitude::scaled_to_amplitude;
use super::binding::{ExactValues, Given, as_powers};
use super::estimate::{Estimate, EstimatedSeries, Tier, rounding};
use crate::error::DerivationError as Error;
use crate::exponent::estimated_exponent;
use crate::limits::refuse_above;
use crate::settings::Settings;
use lindstedt_algebra::{PhaseAlgebra, Rationals};
use lindstedt_coeff::floats::{Doubles, Floats, Reals};
use lindstedt_equation::{Condition, Problem, Quantity};
use lindstedt_expand::{ExpandError, OrderWork, Request, compile, expand, leading_amplitude};
use lindstedt_phase::Trigonometric;
use lindstedt_phase::collocation::{Collocation, Grid};
use lindstedt_series::Series;
use rug::float::Special;
use rug::{Float, Rational};

/// What may go wrong with a grid: refine at most so many times.
const REFINEMENTS: usize = 6;
/// More nodes than this are refused: a solution costs their square.
const MOST_NODES: usize = 1 << 14;

/// Refuses before allocating: a value takes its bits and 48 bytes, an order about 12 lists of them
/// (x, x', x'' and the coefficients of some nodes of the equation).
pub(super) fn limit_memory(settings: &Settings, nodes: usize, bits: u32) -> Result<(), Error> {
    let value = f64::from(bits) / 8.0 + 48.0;
    let bytes = (settings.order as f64 + 1.0) * nodes as f64 * value * 12.0;
    refuse_above(settings.memory, settings.order, bytes.log2())
}

/// One run on one grid.
struct Run {
    nodes: usize,
    products: u64,
    series: Vec<(Quantity, Vec<Float>)>,
}

pub(super) struct Job<'a> {
    pub problem: &'a Problem,
    pub settings: &'a Settings,
    pub condition: Condition,
    pub observer: &'a mut dyn FnMut(&OrderWork) -> bool,
}

impl Job<'_> {
    pub(super) fn estimate(&mut self, tier: Tier) -> Result<Estimate, Error> {
        match tier {
            Tier::Collocation { digits } => self.refine(tier, digits),
            Tier::Doubles => {
                let run = |job: &mut Job<'_>, (accuracy, end)| {
                    let (grid, stop) = (Grid::new(accuracy, end), job.settings.stop.clone());
                    let algebra = Collocation::new(Doubles, grid, stop);
                    job.run(&algebra, algebra.nodes())
                };
                // A solution is known to about 1e-16: where cos psi is smaller than that, x_n/x_0 is
                // noise, and its powers must not enter. So the grids end before.
                let coarse = run(self, (55.0, 30.0))?;
                let fine = run(self, (62.0, 32.0))?;
                let estimate = self.compare(tier, &[coarse], fine, 53);
                Ok(scaled_to_amplitude(self.problem, self.settings, estimate))
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
                Ok(scaled_to_amplitude(self.problem, self.settings, estimate))
            }
        }
    }

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
            let stop = self.settings.stop.clone();
            let algebra = Collocation::new(Floats::new(bits), grid, stop);
            let run = self.run(&algebra, grid.nodes)?;
            let Some(before) = coarse.replace(run) else {
                guard = 6;
                continue;
            };
            let Some(fine) = coarse.take() else { break };
            let plain = self.compare(tier, &[before], fine, bits);
            let estimate = scaled_to_amplitude(self.problem, self.settings, plain.clone());
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
                (s.quantity, s.coefficients.iter().map(|(v, _)| v.clone()).collect())
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
        let estimated = |(index, (quantity, values)): (usize, (Quantity, Vec<Float>))| {
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
            EstimatedSeries { quantity, coefficients }
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
        if algebra.interrupted() {
            return Err(ExpandError::Interrupted { order: 0 }.into());
        }
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
        for quantity in Quantity::POWERS {
            let power = quantity.power();
            let half = Rational::from((power, 2));
            let list = squared.power(reals, &half).ok_or(Error::NoValue)?;
            let factor = rug::ops::Pow::pow(root.clone(), power);
            let value = |c: &_| reals.to_float(c) * &factor;
            series.push((quantity, list.coefficients.iter().map(value).collect()));
        }
        if let Some(quantity) = Quantity::start(self.condition) {
            series
                .push((quantity, expansion.amplitude.iter().map(|c| reals.to_float(c)).collect()));
        }
        if self.condition == Condition::LimitCycle
            && let Some(omega) = squared.square_root(reals).filter(|_| root == 1)
            && let Some(exponent) =
                estimated_exponent(algebra, &self.problem.equation, expansion.solution, &omega)
        {
            let list = exponent.iter().map(|c| reals.to_float(c)).collect();
            series.push((Quantity::FloquetExponent, list));
        }
        let products = expansion.work.iter().map(|work| work.products).sum();
        Ok(Run { nodes, products, series })
    }
}
