//! The averaged expansion with a value for every parameter, as floats.

use super::AveragingSettings;
use super::cycles::{Cycles, cycles};
use super::task::{Over, Task};
use crate::error::DerivationError as Error;
use crate::work::Progress;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePower};
use lindstedt_coeff::constant;
use lindstedt_equation::{Expression, Problem};
use lindstedt_number::ball::Balls;
use lindstedt_number::ball::ring::{BallRing, Enclosure};
use rug::Float;

/// sum of c a^exponent.
pub type Terms = Vec<(i32, Float)>;

/// One harmonic: amplitudes of cos(k psi + m eta) and sin(k psi + m eta).
#[derive(Clone, Debug)]
pub struct Harmonic {
    /// k.
    pub free: i32,
    /// m.
    pub forced: i32,
    /// Of the cosine and of the sine.
    pub amplitudes: [Terms; 2],
}

/// x = sum eps^n u_n(a, psi, eta), a' = sum eps^n A_n(a), psi' = omega_0 + sum eps^n B_n(a),
/// eta = omega t.
#[derive(Clone, Debug)]
pub struct Numbers {
    /// omega_0.
    pub frequency: Float,
    /// omega; 0 without a force.
    pub forcing: Float,
    /// A_0 = 0, A_1, ...
    pub amplitude_rate: Vec<Terms>,
    /// B_0 = 0, B_1, ...
    pub phase_rate: Vec<Terms>,
    /// u_0, u_1, ...
    pub solution: Vec<Vec<Harmonic>>,
    /// The delays.
    pub delays: Vec<Float>,
    /// The limit cycles, exact; nothing where the coefficients are irrational or no rate depends on a.
    pub cycles: Option<Cycles>,
}

/// Coefficients with `bits` bits relative, or as far as their enclosures allow; those that may
/// vanish are zero.
///
/// # Errors
/// [`Error::Unset`] for a parameter of the equation without a value; [`Error::NotEnoughBits`];
/// those of [`super::average`].
pub fn numbers(
    problem: &Problem,
    settings: &AveragingSettings,
    bits: u32,
    observer: &mut dyn FnMut(Progress) -> bool,
) -> Result<Numbers, Error> {
    let task = Task::new(problem, settings)?;
    if let Some(name) = task.names.iter().find(|name| task.value(name).is_none()) {
        return Err(Error::without_value(problem, name));
    }
    if let Some(over) = task.over_rationals(observer)? {
        let found = collect(&task, &over, bits, &|q| Some(Float::with_val(bits, q)))?;
        let cycles = cycles(&over.frequency, &over.expansion, settings.digits)?;
        return Ok(Numbers { cycles, ..found });
    }
    let order = u32::try_from(settings.order).unwrap_or(u32::MAX / 32);
    let balls = Balls::new(bits.saturating_add(64).saturating_add(order.saturating_mul(8)));
    let over = task.over_balls(balls, observer)?;
    let value = |c: &Enclosure| {
        let zero = c.0.contains_zero() && c.0.abs_upper() < 0.5f64.powi(bits.min(1000) as i32);
        let known = zero || c.0.relative_accuracy_bits() >= i64::from(bits / 2);
        known.then(|| if zero { Float::new(bits) } else { Float::with_val(bits, c.0.midpoint()) })
    };
    collect::<BallRing>(&task, &over, bits, &value)
}

fn collect<K: RationalAlgebra>(
    task: &Task<'_>,
    over: &Over<K>,
    bits: u32,
    value: &dyn Fn(&K::Element) -> Option<Float>,
) -> Result<Numbers, Error> {
    let failed = || Error::NotEnoughBits { bits, best: None };
    let terms = |f: &AmplitudePolynomial<K::Element>| -> Option<Terms> {
        let one = |(AmplitudePower(n), c): &(AmplitudePower, K::Element)| Some((*n, value(c)?));
        let all: Terms = f.terms().iter().map(one).collect::<Option<_>>()?;
        Some(all.into_iter().filter(|(_, c)| !c.is_zero()).collect())
    };
    let list = |rates: &[AmplitudePolynomial<K::Element>]| -> Option<Vec<Terms>> {
        rates.iter().map(terms).collect()
    };
    let solution = over.expansion.solution.iter().map(|u| {
        let harmonics = u.harmonics().iter();
        let one =
            |((free, forced), [c, s]): (&(i32, i32), &[AmplitudePolynomial<K::Element>; 2])| {
                let amplitudes = [terms(c)?, terms(s)?];
                Some(Harmonic { free: *free, forced: *forced, amplitudes })
            };
        harmonics.map(one).collect::<Option<Vec<_>>>()
    });
    // The frequency of the force and the delays are expressions in the parameters alone.
    let ring = BallRing { balls: Balls::new(bits) };
    let values = |name: &str| Some(Enclosure(task.value(name)?.ball(ring.balls)?));
    let number = |e: &Expression| {
        let value = constant(&ring, e, &values).ok_or_else(failed)?;
        Ok::<_, Error>(Float::with_val(bits, value.0.midpoint()))
    };
    let forcing = task.excitation.frequency.as_ref().map_or(Ok(Float::new(bits)), number)?;
    let delays = task.excitation.delays.iter().map(number).collect::<Result<_, _>>()?;
    Ok(Numbers {
        frequency: value(&over.frequency).ok_or_else(failed)?,
        forcing,
        amplitude_rate: list(&over.expansion.amplitude_rate).ok_or_else(failed)?,
        phase_rate: list(&over.expansion.phase_rate).ok_or_else(failed)?,
        solution: solution.collect::<Option<_>>().ok_or_else(failed)?,
        delays,
        cycles: None,
    })
}
