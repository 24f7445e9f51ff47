//! The expansion itself as a function of the small parameter and the amplitude: cut off, not resummed.
//!
//!   x(t) = b sum_k [c_k(z) cos(k omega t) + s_k(z) sin(k omega t)],   c_k(z) = sum_n c_kn z^n,   s_k(z) likewise,
//!   1/omega = T/2pi = f sum_n t_n y^n,   y = (r z)^s,   z = small a^w,   n = 0, ..., N,
//!
//! as in [`crate::compiled`]: b = a where the amplitude varies, else its value; f contains a^-small where the amplitude scales
//! the frequency.

use crate::compiled::Varied;
use crate::error::EvaluationError as Error;
use crate::phases::{Phases, left_out};
use crate::source::Source;
use lindstedt_algebra::Stop;
use lindstedt_derivation::Work;
use lindstedt_equation::AmplitudeRole;
use lindstedt_number::ball::{Ball, Balls};

/// Harmonics of which a fourth of the phases is one more, at least.
const FEWEST: usize = 32;
/// Times that the number of phases is doubled.
const DOUBLINGS: usize = 2;
/// Bits of the coefficients before they are rounded to doubles.
const BITS: u32 = 192;
/// Coefficients below this share of the largest of their order are sums that cancel.
const ROUNDING: f64 = 1e-15;

/// How the amplitude enters z and f.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// Not: w = 0.
    Not,
    /// z = small a^w.
    BySmall(u32),
    /// f ~ a^-small, z = small.
    ByScale,
}

/// The polynomials of an expansion in doubles, ordered by their power.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// N.
    pub order: usize,
    /// The parameter that is small.
    pub small: String,
    /// Whether and how the amplitude varies.
    pub carried: Carried,
    /// f without what the amplitude does.
    pub factor: f64,
    /// t_n as a polynomial in z.
    pub period: Vec<f64>,
    /// b where the amplitude does not vary.
    pub amplitude: f64,
    /// k, c_k(z), s_k(z); those without a coefficient are left out.
    pub harmonics: Vec<(usize, Vec<f64>, Vec<f64>)>,
    /// Of every order the sum of the sizes of its coefficients, harmonics that are left out included.
    pub sizes: Vec<f64>,
    /// The same of what is left out, and of what harmonics beyond half of the phases add to those below; infinite where these
    /// fall so slowly that they do not tell.
    pub left_out: Vec<f64>,
}

impl Expansion {
    /// Derives the expansion to an order, with so many harmonics.
    ///
    /// The coefficients c_kn, s_kn are those of x_n at 4 (harmonics + 1) phases, 128 at least, by the trapezoidal rule, and at
    /// twice as many, up to four times, as long as the harmonics next to half of these are not lost in the rounding: those
    /// beyond fold onto the ones that are taken.
    ///
    /// # Errors
    /// Those of [`crate::compiled::FrequencyFunction::new`] and [`lindstedt_derivation::derive()`].
    pub fn new(
        varied: &Varied<'_>,
        order: usize,
        harmonics: usize,
        work: &Work,
    ) -> Result<Self, Error> {
        let setting = varied.setting;
        let mut observer = |progress| work.goes_on(progress);
        let source = Source::new(setting, order, (work.memory, &work.stop), &mut observer)?;
        let derivation = setting.derive(order, (work.memory, &work.stop), &mut observer)?;
        let balls = Balls::new(BITS).with_guard(64);
        let no_value = || Error::without_value(&setting.problem, &work.stop);
        let functions = derivation.phase_functions(false, balls).ok_or_else(no_value)?;
        let sampled = |count: usize| {
            let phases = Phases::new(count, balls, &work.stop, |point| functions.at(point))?;
            polynomials(&phases, balls, &work.stop)
        };
        let fewest = 4 * (harmonics + 1).max(FEWEST);
        let [mut cosines, mut sines] = sampled(fewest).ok_or_else(no_value)?;
        for count in (1..=DOUBLINGS).map(|k| fewest << k) {
            if folded(&cosines, &sines, order).iter().all(|error| *error == 0.0) {
                break;
            }
            [cosines, sines] = sampled(count).ok_or_else(no_value)?;
        }
        let folded = folded(&cosines, &sines, order);
        let size = |n: usize, from: usize| -> f64 {
            let all = cosines.iter().skip(from).chain(sines.iter().skip(from));
            all.filter_map(|c| c.get(n)).map(|c| c.abs()).sum()
        };
        let sizes: Vec<f64> = (0..=order).map(|n| size(n, 0)).collect();
        let left_out = (0..=order).map(|n| size(n, harmonics + 1) + folded[n]).collect();
        let cleared = |list: Vec<f64>| -> Vec<f64> {
            let clear = |(c, size): (f64, &f64)| if c.abs() < ROUNDING * size { 0.0 } else { c };
            trimmed(list.into_iter().zip(&sizes).map(clear).collect())
        };
        let pairs = cosines.into_iter().zip(sines).take(harmonics + 1).enumerate();
        let pairs = pairs.map(|(k, (c, s))| (k, cleared(c), cleared(s)));
        let harmonics = pairs.filter(|(_, c, s)| !c.is_empty() || !s.is_empty()).collect();
        let factor = (source.factor)(balls).ok_or_else(no_value)?.midpoint().to_f64();
        let carried = match (setting.problem.amplitude, varied.weight) {
            (AmplitudeRole::ScalesFrequency { .. }, _) => Carried::ByScale,
            (_, Some(weight)) => Carried::BySmall(weight),
            _ => Carried::Not,
        };
        let small = varied.small.clone();
        let period = period(&source).ok_or_else(no_value)?;
        let amplitude = setting.amplitude.ball(balls).midpoint().to_f64();
        Ok(Self { order, small, carried, factor, period, amplitude, harmonics, sizes, left_out })
    }

    /// |z| up to which the last term is below a share of the first; nothing where there is none.
    #[must_use]
    pub fn reach(&self, share: f64) -> Option<f64> {
        let (first, (n, last)) = (self.sizes.first()?, self.sizes.iter().enumerate().next_back()?);
        (n > 0 && *last > 0.0).then(|| (share * first / last).powf(1.0 / n as f64))
    }
}

/// t_n r^(s n) at the powers of z.
fn period(source: &Source) -> Option<Vec<f64>> {
    let (list, ratio) = ((source.coefficients)(BITS)?, source.ratio.to_f64());
    let mut period = vec![0.0; list.len().saturating_sub(1) * source.step + 1];
    for (n, t) in list.iter().enumerate() {
        let power = i32::try_from(n * source.step).ok()?;
        *period.get_mut(n * source.step)? = t.to_f64() * ratio.powi(power);
    }
    Some(trimmed(period))
}

/// c_kn and s_kn, k < M/2, as balls before they are rounded: 1/32 is 1/32. Nothing when stopped.
fn polynomials(phases: &Phases, balls: Balls, stop: &Stop) -> Option<[Vec<Vec<f64>>; 2]> {
    let orders = phases.distinct.first().map_or(0, |(_, list)| list.len());
    let [cosines, sines] = phases.exact_weights(balls, stop)?.map(|rows| {
        let at = |row: &Vec<Ball>, n: usize| {
            let products = row
                .iter()
                .zip(&phases.distinct)
                .filter_map(|(w, (_, x))| Some(balls.mul(w, x.get(n)?)));
            products
                .fold(balls.zero(), |sum, product| balls.add(&sum, &product))
                .midpoint()
                .to_f64()
        };
        let numbers = |row: Vec<Ball>| (0..orders).map(|n| at(&row, n)).collect();
        rows.map(|row| (!stop.asked()).then(|| numbers(row))).collect::<Option<_>>()
    });
    Some([cosines?, sines?])
}

/// Of every order a bound of what harmonics beyond those that the phases tell fold onto them; zero where the last ones are
/// lost in the rounding.
fn folded(cosines: &[Vec<f64>], sines: &[Vec<f64>], order: usize) -> Vec<f64> {
    let of = |n: usize| {
        let at = |list: &Vec<f64>| list.get(n).copied().unwrap_or(0.0);
        let pairs: Vec<(f64, f64)> =
            cosines.iter().zip(sines).map(|(c, s)| (at(c), at(s))).collect();
        let size: f64 = pairs.iter().map(|(c, s)| c.hypot(*s)).sum();
        left_out(&pairs, pairs.len(), ROUNDING * size)
    };
    (0..=order).map(of).collect()
}

/// Without zeros at the end.
fn trimmed(mut list: Vec<f64>) -> Vec<f64> {
    while list.last() == Some(&0.0) {
        list.pop();
    }
    list
}
