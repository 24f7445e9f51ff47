//! Guesses for several unknowns: normal modes continued in the amplitude, and motions that settle.

use crate::doubles::InDoubles;
use crate::eigenvalues::eigenvalues;
use crate::newton::balance;
use crate::task::Task;
use crate::{Failure, Field, Kind, Start, guesses};
use lindstedt_algebra::Stop;
use nalgebra::DMatrix;
use rug::Rational;
use std::f64::consts::TAU;

/// Harmonics of a guess.
const MODES: usize = 12;
/// Steps from a small amplitude to the one asked for.
const STEPS: u32 = 16;
/// A displacement for numerical derivatives.
const SMALL: f64 = 1e-5;
/// Steps in time, their number in a period of a force and in one unit of time, and the longest motion.
const IN_A_PERIOD: usize = 512;
const IN_A_UNIT: f64 = 50.0;
const LONGEST: usize = 200_000;
/// States nearer than this are the same.
const SAME: f64 = 1e-7;
/// Returns among which the same state is looked for.
const RETURNS: usize = 12;
/// Samples of a motion.
const SAMPLES: usize = 256;

/// Guesses for any number of unknowns, a function for each: of one unknown those of [`guesses`]; of several,
/// for a family the normal modes of the linear equations about 0, continued to the amplitude asked for; for
/// a limit cycle or a response the motion from two states near 0 and from rest once it repeats itself; for
/// a response, then, the balance of twelve harmonics from each shape of the linear equations with three
/// amplitudes and four phases, so that of limit cycles alone unstable ones are not found. Cost: up to 2 * 10^5 steps
/// in time.
///
/// # Errors
/// As [`guesses`].
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_orbit::{Field, Kind, Request, guesses_all, prove_all};
/// // x_1'' + 2 x_1 - x_2 + x_1^3 = 0, x_2'' + 2 x_2 - x_1 = 0: two nonlinear normal modes.
/// let equation = |i: usize| {
///     let [x, other] = [i, 1 - i].map(|k| Expression::unknown(k, 0));
///     let cubic = if i == 0 { x.clone().pow(3) } else { Expression::integer(0) };
///     Expression::unknown(i, 2) + 2 * x - other + cubic
/// };
/// let field = Field::of_equations(&[&equation(0), &equation(1)], "eps", &Default::default())?;
/// let kind = Kind::InitialAmplitude(1.into());
/// let guesses = guesses_all(&field, &kind, &Default::default())?;
/// assert_eq!(guesses.len(), 2);
/// for guess in &guesses {
///     prove_all(&field, &kind, guess, &Request::default())?;
/// }
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn guesses_all(field: &Field, kind: &Kind, stop: &Stop) -> Result<Vec<Vec<Start>>, Failure> {
    if field.unknowns() == 1 {
        return Ok(guesses(field, kind, stop)?.into_iter().map(|start| vec![start]).collect());
    }
    let amplitude = match kind {
        Kind::InitialAmplitude(a) | Kind::FundamentalAmplitude(a) => a.clone(),
        Kind::InitialWithin { value, .. } => value.clone(),
        Kind::Forced(_) => return responses(field, kind, settled(field, kind, stop), stop),
        _ => return Ok(settled(field, kind, stop)),
    };
    let fundamental = matches!(kind, Kind::FundamentalAmplitude(_));
    let of = |a: Rational| match fundamental {
        true => Kind::FundamentalAmplitude(a),
        false => Kind::InitialAmplitude(a),
    };
    let mut found = Vec::new();
    for (rate, shape) in linear_modes(field) {
        match continued(field, &amplitude, rate, &shape, &of, stop) {
            Ok(starts) => found.push(starts),
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(_) => {}
        }
    }
    Ok(found)
}

/// Frequencies and shapes (x_1 = 1) of the linear equations about 0, the slowest first.
fn linear_modes(field: &Field) -> Vec<(f64, Vec<f64>)> {
    let (n, doubles) = (field.unknowns(), InDoubles::new(field));
    let force = |k: usize, by: f64| {
        let mut state = vec![0.0; 2 * n];
        state[k] = by;
        doubles.accelerations(&state, None)
    };
    let mut stiffness = DMatrix::zeros(n, n);
    for k in 0..n {
        let (up, down) = (force(k, SMALL), force(k, -SMALL));
        for i in 0..n {
            stiffness[(i, k)] = (down[i] - up[i]) / (2.0 * SMALL);
        }
    }
    let mut modes = Vec::new();
    for value in eigenvalues(n, stiffness.transpose().as_slice()) {
        let square = value.re;
        if value.im.abs() > 1e-6 * square.abs() || square <= 0.0 {
            continue;
        }
        let shifted = &stiffness - DMatrix::identity(n, n) * square;
        let found = shifted.svd(false, true);
        let Some(rows) = found.v_t else { continue };
        // Of several vectors of one eigenvalue that with the least of the other unknowns: the projection of x_1.
        let least = found.singular_values[n - 1].max(1e-6 * stiffness.norm());
        let kernel = (0..n).filter(|i| found.singular_values[*i] <= least);
        let mut shape = vec![0.0; n];
        for row in kernel.map(|i| rows.row(i)) {
            shape.iter_mut().zip(row.iter()).for_each(|(sum, x)| *sum += row[0] * x);
        }
        let size = shape.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if size > 0.0 && shape[0].abs() > 1e-6 * size {
            modes.push((square.sqrt(), shape.iter().map(|x| x / shape[0]).collect()));
        }
    }
    modes.sort_by(|a: &(f64, Vec<f64>), b| a.0.total_cmp(&b.0));
    modes.dedup_by(|a, b| (a.0 - b.0).abs() <= 1e-6 * b.0);
    modes
}

/// A normal mode followed from a small amplitude.
fn continued(
    field: &Field,
    amplitude: &Rational,
    rate: f64,
    shape: &[f64],
    of: &dyn Fn(Rational) -> Kind,
    stop: &Stop,
) -> Result<Vec<Start>, Failure> {
    let mut starts: Vec<Start> = Vec::new();
    for step in 1..=STEPS {
        let part = Rational::from((step, STEPS));
        let a = Rational::from(amplitude * &part);
        if starts.is_empty() {
            let one = |x: &f64| Start {
                frequency: rate,
                cosines: vec![0.0, x * a.to_f64()],
                sines: Vec::new(),
            };
            starts = shape.iter().map(one).collect();
        } else {
            let factor = f64::from(step) / f64::from(step - 1);
            let waves = starts.iter_mut().flat_map(|s| s.cosines.iter_mut().chain(&mut s.sines));
            waves.for_each(|c| *c *= factor);
        }
        let (task, guess) = Task::new(field, &of(a), &starts, stop)?;
        let centre = balance(&task, guess, MODES)?;
        let component = |i: usize| Start::of(&centre.frequency, &centre.component(i));
        starts = (0..field.unknowns()).map(component).collect();
    }
    Ok(starts)
}

/// Motions that repeat themselves.
fn settled(field: &Field, kind: &Kind, stop: &Stop) -> Vec<Vec<Start>> {
    let n = field.unknowns();
    let pushed = |signs: [f64; 2]| -> Vec<f64> {
        let x = |k: usize| if k < n { signs[k % 2] * (1.0 + 0.1 * k as f64) } else { 0.0 };
        (0..2 * n).map(x).collect()
    };
    let states = [vec![0.0; 2 * n], pushed([1.0, 1.0]), pushed([1.0, -1.0])];
    let mut found: Vec<Vec<Start>> = Vec::new();
    for state in states {
        let motion = match (kind, &field.force) {
            (Kind::Forced(periods), Some(force)) => {
                forced(field, force.to_f64(), *periods as usize, state, stop)
            }
            _ if state.iter().all(|x| *x == 0.0) => None,
            _ => cycle(field, state, stop),
        };
        let Some((period, samples)) = motion else { continue };
        let of = |i: usize| {
            let list: Vec<f64> = samples.iter().map(|state| state[i]).collect();
            Start::from_samples(period, &list)
        };
        let starts: Vec<Start> = (0..n).map(of).collect();
        if !found.iter().any(|other| are_near(other, &starts)) {
            found.push(starts);
        }
    }
    found
}

/// Amplitudes and phases of the single harmonics from which responses are balanced.
const AMPLITUDES: [f64; 3] = [0.5, 1.0, 2.0];
const PHASES: u32 = 4;

/// The responses known and those that the balance of harmonics finds from the shapes of the linear equations,
/// unstable ones, too.
fn responses(
    field: &Field,
    kind: &Kind,
    mut found: Vec<Vec<Start>>,
    stop: &Stop,
) -> Result<Vec<Vec<Start>>, Failure> {
    let shapes = linear_modes(field).into_iter().map(|(_, shape)| {
        let size = shape.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        shape.into_iter().map(|x| x / size).collect::<Vec<f64>>()
    });
    let single = |shape: &[f64], amplitude: f64, phase: u32| -> Vec<Start> {
        let (sin, cos) = (TAU * f64::from(phase) / f64::from(PHASES)).sin_cos();
        let one = |x: &f64| Start {
            frequency: 1.0,
            cosines: vec![0.0, x * amplitude * cos],
            sines: vec![0.0, x * amplitude * sin],
        };
        shape.iter().map(one).collect()
    };
    for shape in shapes {
        for (amplitude, phase) in AMPLITUDES.iter().flat_map(|a| (0..PHASES).map(move |p| (a, p))) {
            let (task, guess) = Task::new(field, kind, &single(&shape, *amplitude, phase), stop)?;
            match balance(&task, guess, MODES) {
                Ok(centre) => {
                    let one = |i: usize| Start::of(&centre.frequency, &centre.component(i));
                    let starts: Vec<Start> = (0..field.unknowns()).map(one).collect();
                    if !found.iter().any(|other| are_near(other, &starts)) {
                        found.push(starts);
                    }
                }
                Err(Failure::Stopped) => return Err(Failure::Stopped),
                Err(_) => {}
            }
        }
    }
    Ok(found)
}

/// Whether two guesses are of one orbit.
fn are_near(one: &[Start], other: &[Start]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| a.is_near(b, 1e-3))
}

/// A period and the states over it.
type Motion = Option<(f64, Vec<Vec<f64>>)>;

fn near(a: &[f64], b: &[f64]) -> bool {
    let size = a.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).all(|(x, y)| (x - y).abs() <= SAME * size)
}

/// The motion under a force once it has its period.
fn forced(field: &Field, rate: f64, periods: usize, mut state: Vec<f64>, stop: &Stop) -> Motion {
    let doubles = InDoubles::new(field);
    let (whole, h) = (periods * IN_A_PERIOD, TAU / rate / IN_A_PERIOD as f64);
    let mut done = 0;
    while done < LONGEST {
        let mut samples = Vec::new();
        let start = state.clone();
        for j in 0..whole {
            if j % (periods * 2) == 0 {
                samples.push(state.clone());
            }
            state = doubles.step(&state, j as f64 * h, h, rate);
        }
        done += whole;
        if stop.asked() || !state.iter().all(|x| x.abs() < 1e6) {
            return None;
        }
        if near(&start, &state) {
            return Some((TAU / rate * periods as f64, samples));
        }
    }
    None
}

/// The motion without a force once a state at x_1' = 0, x_1 largest, returns.
fn cycle(field: &Field, mut state: Vec<f64>, stop: &Stop) -> Motion {
    let (n, doubles, h) = (field.unknowns(), InDoubles::new(field), 1.0 / IN_A_UNIT);
    let mut tops: Vec<(f64, Vec<f64>)> = Vec::new();
    for j in 0..LONGEST {
        let next = doubles.step(&state, 0.0, h, 0.0);
        if !next.iter().all(|x| x.abs() < 1e6) || (j % 1000 == 0 && stop.asked()) {
            return None;
        }
        if state[n] > 0.0 && next[n] <= 0.0 {
            // Newton's step to the time at which x_1' = 0.
            let mut part = h * state[n] / (state[n] - next[n]);
            let mut top = doubles.step(&state, 0.0, part, 0.0);
            for _ in 0..3 {
                part -= top[n] / doubles.accelerations(&top, None)[0];
                top = doubles.step(&state, 0.0, part, 0.0);
            }
            let time = j as f64 * h + part;
            let same = tops.iter().rev().take(RETURNS).find(|(_, before)| near(before, &top));
            if let Some((before, _)) = same {
                let period = time - before;
                let (steps, mut samples) = (8, Vec::new());
                let fine = period / (SAMPLES * steps) as f64;
                for _ in 0..SAMPLES {
                    samples.push(top.clone());
                    for _ in 0..steps {
                        top = doubles.step(&top, 0.0, fine, 0.0);
                    }
                }
                return Some((period, samples));
            }
            tops.push((time, top));
        }
        state = next;
    }
    None
}
