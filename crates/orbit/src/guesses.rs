//! Guesses without a simulation: harmonic balance in doubles from a grid of single harmonics.

use crate::doubles::InDoubles;
use crate::newton::balance;
use crate::task::Task;
use crate::{Failure, Field, Kind, Start};
use lindstedt_algebra::Stop;
use std::f64::consts::TAU;

/// Harmonics of a guess.
const MODES: usize = 12;
/// Amplitudes of the grid: 2^-3 to 2^3.
const AMPLITUDES: std::ops::RangeInclusive<i32> = -3..=3;
/// Phases of the grid, where the equation tells them apart.
const PHASES: u32 = 6;
/// Two guesses nearer than this, relatively, are one.
const SAME: f64 = 1e-6;
/// An oscillation has this share of its sum of harmonics in those that oscillate.
const OSCILLATES: f64 = 1e-6;
/// The grid on which equilibria are looked for: up to |x| = 16.
const STEP: f64 = 1.0 / 16.0;
const CELLS: i32 = 256;
/// Points of a mean over a period.
const POINTS: u32 = 32;

/// The solutions of the balance of twelve harmonics that Newton's method finds from single harmonics about
/// every equilibrium of the equation without its force, |x| <= 16; the smallest first. Their amplitudes: of
/// a response 1/8, 1/4, ..., 8 with six phases each, of a family the one asked for, of a limit cycle those
/// up to 16 at which the work over a period changes its sign. A guess is no orbit before it is
/// proved, and an orbit may have no guess here. The cost is at most some hundred Newton iterations on 25
/// unknowns.
///
/// # Errors
/// Where the question does not fit the equation, as [`prove`](crate::prove); [`Failure::Stopped`].
///
/// ```
/// use lindstedt_equation::{Expression, Function};
/// use lindstedt_orbit::{Field, Kind, guesses};
/// // x'' + x'/10 + x + x^3/2 = 3/10 cos(13 t/10) has three responses.
/// let (x, number) = (Expression::DISPLACEMENT, |n: i64, d: i64| Expression::Number((n, d).into()));
/// let force = number(3, 10) * (number(13, 10) * Expression::Time).apply(Function::Cos);
/// let spring = x.clone() + number(1, 2) * x.pow(3);
/// let equation = Expression::ACCELERATION + number(1, 10) * Expression::VELOCITY + spring - force;
/// let field = Field::new(&equation, "eps", &Default::default())?;
/// assert_eq!(guesses(&field, &Kind::Forced(1), &Default::default())?.len(), 3);
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn guesses(field: &Field, kind: &Kind, stop: &Stop) -> Result<Vec<Start>, Failure> {
    let forced = matches!(kind, Kind::Forced(_));
    let phases = if forced { PHASES } else { 1 };
    let mut found: Vec<Start> = Vec::new();
    let plane = PhasePlane { field, doubles: InDoubles::new(field) };
    let middles = plane.equilibria();
    let singles = middles.iter().flat_map(|middle| {
        let radii = plane.radii(kind, *middle).into_iter();
        radii.flat_map(move |radius| (0..phases).map(move |p| (radius, *middle, p)))
    });
    for (radius, middle, phase) in singles {
        let angle = TAU * f64::from(phase) / f64::from(phases);
        let single = Start {
            frequency: plane.frequency(middle, radius),
            cosines: vec![middle, radius * angle.cos()],
            sines: vec![0.0, radius * angle.sin()],
        };
        let (task, guess) = Task::new(field, kind, std::slice::from_ref(&single), stop)?;
        match balance(&task, guess, MODES) {
            Ok(centre) => {
                let start = Start::of(&centre.frequency, &centre.component(0));
                let new = found.iter().all(|other| !other.is_near(&start, SAME));
                if new && (forced || start.oscillates(OSCILLATES)) {
                    found.push(start);
                }
            }
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(_) => {}
        }
    }
    found.sort_by(|a, b| a.size().total_cmp(&b.size()));
    Ok(found)
}

/// A field of one unknown with its numbers in doubles.
struct PhasePlane<'a> {
    field: &'a Field,
    doubles: InDoubles,
}

impl PhasePlane<'_> {
    /// The amplitudes of the single harmonics about a middle.
    fn radii(&self, kind: &Kind, middle: f64) -> Vec<f64> {
        let list = match kind {
            // x(0) of a family is what was asked for.
            Kind::InitialAmplitude(a) => vec![a.to_f64() - middle],
            Kind::InitialWithin { value, .. } => vec![value.to_f64() - middle],
            Kind::FundamentalAmplitude(a) => vec![a.to_f64()],
            Kind::FundamentalWithin { value, .. } => vec![value.to_f64()],
            Kind::Forced(_) => AMPLITUDES.map(|j| 2f64.powi(j)).collect(),
            Kind::LimitCycle => {
                let work = |j: i32| self.work(middle, f64::from(j) * STEP);
                let balanced = (1..CELLS).filter(|j| work(*j) * work(j + 1) <= 0.0);
                balanced.map(|j| (f64::from(j) + 0.5) * STEP).collect()
            }
        };
        list.into_iter().filter(|a| *a != 0.0).collect()
    }

    /// The work of g over a period of m + a cos(omega t), but for its size.
    fn work(&self, middle: f64, a: f64) -> f64 {
        self.mean(middle, a, self.frequency(middle, a), f64::sin)
    }

    /// The mean of g times a wave over a period of m + a cos(omega t).
    fn mean(&self, middle: f64, a: f64, omega: f64, wave: fn(f64) -> f64) -> f64 {
        let at = |j: u32| {
            let tau = TAU * f64::from(j) / f64::from(POINTS);
            self.value(middle + a * tau.cos(), -omega * a * tau.sin()) * wave(tau)
        };
        (0..POINTS).map(at).sum::<f64>() / f64::from(POINTS)
    }

    /// omega of m + a cos(omega t) by the balance of its first harmonic: omega^2 a = -2 <g cos>.
    fn frequency(&self, middle: f64, a: f64) -> f64 {
        let next = |omega: f64| (-2.0 * self.mean(middle, a, omega, f64::cos) / a).max(1e-2).sqrt();
        next(next(1.0))
    }

    /// The zeros of g(x, 0) without its force, to the step of a grid; 0 where there are none.
    fn equilibria(&self) -> Vec<f64> {
        let at = |j: i32| f64::from(2 * j + 1) * STEP / 2.0;
        let force = |j: i32| self.value(at(j), 0.0);
        let change = |a: f64, b: f64| a * b < 0.0 || (a == 0.0 && b != 0.0);
        let changes = (-CELLS..CELLS).filter(|j| change(force(*j), force(j + 1)));
        // Where x is an angle, those of one turn.
        let most = self.field.angle().map_or(f64::INFINITY, |rate| std::f64::consts::PI / rate);
        let places = changes
            .map(|j| (at(j) + at(j + 1)) / 2.0)
            .filter(|x| *x > STEP - most && *x <= most + STEP);
        let places: Vec<f64> = places.collect();
        if places.is_empty() { vec![0.0] } else { places }
    }

    /// g without its force.
    fn value(&self, x: f64, velocity: f64) -> f64 {
        self.doubles.accelerations(&[x, velocity], None)[0]
    }
}
