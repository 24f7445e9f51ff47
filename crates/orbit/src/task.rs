//! What is asked: the kind of orbit, its symmetry and the equation that fixes its phase or its
//! amplitude.

use crate::Failure;
use crate::centre::{Centre, FAST_BITS};
use crate::exact::Exact;
use crate::field::Field;
use crate::space::{Parity, Wave};
use crate::start::{Start, in_phase};
use crate::upward::Up;
use lindstedt_algebra::Stop;
use nalgebra::Complex;
use rug::{Float, Integer, Rational};

/// Which periodic orbit of a field is meant; of several unknowns, x is the first.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Kind {
    /// An isolated orbit of an autonomous equation, its frequency unknown. The phase: no sine in
    /// the first harmonic.
    LimitCycle,
    /// A member of a family of an equation that is reversible (even in x'): even in time, x(0) = a. Further
    /// unknowns may be odd in time.
    InitialAmplitude(Rational),
    /// The same where x(0) is known within an error: what is proved holds for each such value.
    InitialWithin {
        /// The middle.
        value: Rational,
        /// The largest distance from it.
        error: Rational,
    },
    /// The same with the first harmonic a cos tau.
    FundamentalAmplitude(Rational),
    /// The same where a is known within an error.
    FundamentalWithin {
        /// The middle.
        value: Rational,
        /// The largest distance from it.
        error: Rational,
    },
    /// The response to the force, with this many periods of the force as its period (1 for a
    /// harmonic response, at most 100).
    Forced(u32),
}

/// How far to go.
#[derive(Clone, Debug)]
pub struct Request {
    /// Significant digits of frequency and displacement that the radius shall confirm.
    pub digits: u32,
    /// The largest mode of the numerical inverse; its cost grows with the third power (400: a
    /// second).
    pub modes_limit: usize,
    /// Asked between the parts of the work.
    pub stop: Stop,
}

impl Kind {
    /// The same question for all amplitudes between two numbers; nothing where no amplitude is asked for.
    #[must_use]
    pub fn between(&self, ends: &[Rational; 2]) -> Option<Self> {
        let value = Rational::from(&ends[0] + &ends[1]) / 2u32;
        let error = Rational::from(&ends[1] - &ends[0]).abs() / 2u32;
        match self {
            Self::InitialAmplitude(_) => Some(Self::InitialWithin { value, error }),
            Self::FundamentalAmplitude(_) => Some(Self::FundamentalWithin { value, error }),
            _ => None,
        }
    }
}

impl Default for Request {
    fn default() -> Self {
        Self { digits: 15, modes_limit: 800, stop: Stop::default() }
    }
}

/// The row of F that fixes phase or amplitude: a linear form of the coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Condition {
    /// The coefficient of sin tau.
    Sine,
    /// The coefficient of cos tau.
    Cosine,
    /// x at tau = 0.
    AtZero,
}

impl Condition {
    /// The form on a wave.
    pub(crate) fn of(self, wave: Wave) -> f64 {
        let holds = match self {
            Self::Sine => wave.k == 1 && wave.sine,
            Self::Cosine => wave.k == 1 && !wave.sine,
            Self::AtZero => !wave.sine,
        };
        f64::from(u8::from(holds && wave.unknown == 0))
    }
}

/// The rows of F.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    pub(crate) parity: Parity,
    pub(crate) condition: Option<Condition>,
}

/// A field, the rows, and the value that the condition has.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub(crate) field: Field,
    pub(crate) rows: Rows,
    pub(crate) value: Rational,
    /// How far the value can be from it.
    pub(crate) error: Rational,
    /// Asked between the steps of Newton's method and between the products of a residual.
    pub(crate) stop: Stop,
}

impl Task {
    /// The task with the guess for it, one function for each unknown; the frequency is the first one's.
    pub(crate) fn new(
        field: &Field,
        kind: &Kind,
        starts: &[Start],
        stop: &Stop,
    ) -> Result<(Self, Centre), Failure> {
        let mut modes = aligned(starts, field.unknowns())?;
        let autonomous = !matches!(kind, Kind::Forced(_));
        if autonomous != field.is_autonomous() {
            return Err(if autonomous { Failure::Forced } else { Failure::NotForced });
        }
        let (condition, value) = match kind {
            Kind::LimitCycle => (Some(Condition::Sine), Rational::new()),
            Kind::InitialAmplitude(a) => (Some(Condition::AtZero), a.clone()),
            Kind::InitialWithin { value, .. } => (Some(Condition::AtZero), value.clone()),
            Kind::FundamentalAmplitude(a) => (Some(Condition::Cosine), a.clone()),
            Kind::FundamentalWithin { value, .. } => (Some(Condition::Cosine), value.clone()),
            Kind::Forced(_) => (None, Rational::new()),
        };
        let family = autonomous && *kind != Kind::LimitCycle;
        let mut frequency = starts[0].frequency;
        let mut field = field.clone();
        let mut exact = None;
        if let (Kind::Forced(periods), Some(force)) = (kind, &field.force) {
            let periods = (*periods).clamp(1, MOST_PERIODS);
            let rate = Rational::from(force / periods);
            frequency = rate.to_f64();
            exact = Some(rate);
            field = field.over(periods);
        } else {
            modes = in_phase(modes);
            if condition == Some(Condition::AtZero) {
                begin_near(&mut modes, value.to_f64());
            }
        }
        if !(frequency.is_finite() && frequency > 0.0) {
            return Err(Failure::NoStart);
        }
        let parity = parity(&field, kind, family, &modes)?;
        for (i, unknown) in modes.iter_mut().enumerate() {
            for (k, c) in unknown.iter_mut().enumerate() {
                *c = parity.waves(i, k).map(|w| w.complex(w.of(*c))).sum();
            }
        }
        let mut centre = Centre::from_doubles(FAST_BITS, frequency, &modes);
        if let Some(rate) = exact {
            centre.frequency = rate;
        }
        let error = match kind {
            Kind::InitialWithin { error, .. } | Kind::FundamentalWithin { error, .. } => {
                error.clone()
            }
            _ => Rational::new(),
        };
        let stop = stop.clone();
        Ok((Self { field, rows: Rows { parity, condition }, value, error, stop }, centre))
    }

    /// Whether the frequency is an unknown.
    pub(crate) fn is_free(&self) -> bool {
        self.rows.condition.is_some()
    }

    /// The condition, its value and the error of that.
    pub(crate) fn asked(&self) -> Option<(Condition, Rational, Up)> {
        Some((self.rows.condition?, self.value.clone(), Up::of(&self.error)))
    }

    /// The same with the frequency as it is, and nothing else fixed.
    pub(crate) fn with_frequency_fixed(&self) -> Self {
        Self { rows: Rows { condition: None, ..self.rows }, ..self.clone() }
    }

    /// What the condition misses its value by, exactly rounded.
    pub(crate) fn condition(&self, centre: &Centre) -> Float {
        Float::with_val(64, self.form(centre) - &self.value)
    }

    /// The linear form of the condition.
    pub(crate) fn form(&self, centre: &Centre) -> Rational {
        let unit = Integer::from(1) << centre.bits;
        let mode = |list: &[Integer]| list.get(1).map_or(Integer::new(), |c| Integer::from(c * 2));
        let first = &centre.unknowns[0];
        match self.rows.condition {
            None => Rational::new(),
            Some(Condition::AtZero) => Exact::over_power(first.clone(), centre.bits).at_zero(),
            Some(Condition::Cosine) => Rational::from((mode(&first.re), unit)),
            Some(Condition::Sine) => Rational::from((-mode(&first.im), unit)),
        }
    }
}

/// Periods of the force in one of the response; more are taken as so many.
const MOST_PERIODS: u32 = 100;
/// Modes that a symmetry forbids are taken as noise below this fraction.
const NOISE: f64 = 2e-2;
/// Where no unknown frequency tells that a response keeps a symmetry, they must be this small.
const QUIET: f64 = 1e-6;

/// Where x(T/2) is nearer to the value than x(0), the orbit half a period later.
fn begin_near(modes: &mut [Vec<Complex<f64>>], value: f64) {
    let part = |odd: usize| modes[0].iter().skip(odd).step_by(2).map(|c| 2.0 * c.re).sum::<f64>();
    let (even, odd) = (part(0) - modes[0][0].re, part(1));
    if (even - odd - value).abs() < (even + odd - value).abs() {
        let turned = modes.iter_mut().flat_map(|unknown| unknown.iter_mut().skip(1).step_by(2));
        turned.for_each(|c| *c = -*c);
    }
}

/// The coefficients of all unknowns, as many of each.
fn aligned(starts: &[Start], unknowns: usize) -> Result<Vec<Vec<Complex<f64>>>, Failure> {
    let mut modes: Vec<Vec<Complex<f64>>> = starts.iter().map(Start::complex).collect();
    let most = modes.iter().map(Vec::len).max().unwrap_or(0);
    let finite = |c: &Complex<f64>| c.re.is_finite() && c.im.is_finite();
    if modes.len() != unknowns || most < 2 || !modes.iter().flatten().all(finite) {
        return Err(Failure::NoStart);
    }
    modes.iter_mut().for_each(|list| list.resize(most, Complex::default()));
    Ok(modes)
}

/// The symmetries that the field keeps and the guess has.
fn parity(
    field: &Field,
    kind: &Kind,
    family: bool,
    modes: &[Vec<Complex<f64>>],
) -> Result<Parity, Failure> {
    let total: f64 = modes.iter().flatten().map(|c| c.norm()).sum();
    let miss = |parity: Parity| -> f64 {
        let all =
            modes.iter().enumerate().flat_map(|(i, list)| (0..list.len()).map(move |k| (i, k)));
        let one = |(i, k): (usize, usize)| {
            let c = modes[i][k];
            let kept: Complex<f64> = parity.waves(i, k).map(|w| w.complex(w.of(c))).sum();
            (c - kept).norm()
        };
        all.map(one).sum()
    };
    let shifts = field.signs(true).into_iter().map(|minus| Parity {
        odd: true,
        keeping: !minus & ((1 << modes.len().min(63)) - 1),
        ..Parity::default()
    });
    let turns = field.signs(false).into_iter().filter(|turning| turning & 1 == 0);
    let turns = turns.map(|turning| Parity { even: true, turning, ..Parity::default() });
    let nearest = |list: Vec<Parity>| {
        let sized = list.into_iter().map(|parity| (miss(parity), parity));
        sized.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut parity = Parity::default();
    if let Some((off, shift)) = nearest(shifts.collect())
        && off <= NOISE * total
    {
        parity = shift;
    }
    // A limit cycle that time maps to itself is none.
    if *kind == Kind::LimitCycle {
        return Ok(parity);
    }
    let turned = nearest(turns.collect());
    if family && turned.is_none() {
        return Err(Failure::NotReversible);
    }
    if let Some((off, turned)) = turned
        && (family || off <= QUIET * total)
    {
        parity = Parity { even: true, turning: turned.turning, ..parity };
    }
    Ok(parity)
}
