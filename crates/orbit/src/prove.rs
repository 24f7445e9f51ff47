//! From a guess to a theorem.

use crate::bounds::{Frame, Measure, Weights};
use crate::centre::{Centre, FAST_BITS};
use crate::linear::Inverse;
use crate::newton::{balance, invert, linearised, refine};
use crate::orbit::Orbit;
use crate::proof::conclude;
use crate::radii::{Radii, decide};
use crate::task::Task;
use crate::upward::Up;
use crate::{Condition, Failure, Field, Kind, Proof, Request, Start};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Float, Rational};

/// Modes of the first balance.
const FIRST_MODES: usize = 10;
/// Beyond this fraction of a guess its highest modes are not worth a balance.
const GUESSED: f64 = 1e-3;
/// How far x(0) may be, relatively, from what it shall be, after a balance with the frequency of the guess.
const NEAR: f64 = 0.1;
/// The highest quarter of the modes carries less than this fraction when there are enough.
const RESOLVED: f64 = 1e-4;
const FINELY: f64 = 1e-9;
/// Harmonics below this fraction of all that oscillate are none.
const REPEATED: f64 = 1e-9;
/// Bits beyond the digits: weights of the modes, sums.
const GUARD_BITS: u32 = 44;
/// Bits of the steps that estimate the error.
const FURTHER_BITS: u32 = 20;
/// The numerical solution has at most this many times the modes of the inverse.
const MOST_TIMES: usize = 40;
/// Weights that are tried: nu = 1 + c/N.
const WEIGHTS: [f64; 5] = [0.0, 0.5, 2.0, 6.0, 15.0];
/// Refinements until the radius confirms the digits.
const MOST_REFINEMENTS: u32 = 4;
/// A sum Z0 + Z1 with which no other weight is tried.
const GOOD: f64 = 0.5;

/// Proves that the field has a periodic orbit of this kind near the guess.
///
/// Newton's method from the guess, with as many modes as it takes; refinement until the radius is
/// below 10^-digits of the largest harmonic, every residual formed without rounding; the contraction test
/// with the modes of the inverse increased until it succeeds or the limit is reached.
///
/// # Errors
/// [`Failure`]: which bound failed, with its number. That says nothing against the orbit.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_number::digits::decimal;
/// use lindstedt_orbit::{Field, Kind, Request, Start, prove};
/// // x'' + x + x^3/2 = 0 with x(0) = 1; the guess is cos(1.17 t).
/// let x = Expression::DISPLACEMENT;
/// let cubic = Expression::Number((1, 2).into()) * x.clone().pow(3);
/// let field = Field::new(&(Expression::ACCELERATION + x + cubic), "eps", &Default::default())?;
/// let start = Start { frequency: 1.17, cosines: vec![0.0, 1.0], sines: vec![] };
/// let request = Request { digits: 20, ..Request::default() };
/// let proof = prove(&field, &Kind::InitialAmplitude(1.into()), &start, &request)?;
/// assert_eq!(decimal(&proof.period, 20).as_deref(), Some("5.3666593551917671037"));
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn prove(
    field: &Field,
    kind: &Kind,
    start: &Start,
    request: &Request,
) -> Result<Proof, Failure> {
    prove_all(field, kind, std::slice::from_ref(start), request)
}

/// The same for several unknowns, with a guess for each; the frequency is the first one's.
///
/// # Errors
/// As [`prove`].
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_orbit::{Field, Kind, Request, Start, prove_all};
/// // x_1'' + 2 x_1 - x_2 + x_1^3 = 0 and the same with 1 and 2 exchanged: in phase they are one
/// // Duffing oscillator, x'' + x + x^3 = 0.
/// let equation = |i: usize| {
///     let [x, other] = [i, 1 - i].map(|k| Expression::unknown(k, 0));
///     Expression::unknown(i, 2) + 2 * x.clone() - other + x.pow(3)
/// };
/// let field = Field::of_equations(&[&equation(0), &equation(1)], "eps", &Default::default())?;
/// let start = Start { frequency: 1.3, cosines: vec![0.0, 1.0], sines: vec![] };
/// let kind = Kind::InitialAmplitude(1.into());
/// let proof = prove_all(&field, &kind, &[start.clone(), start], &Request::default())?;
/// assert!((proof.period.midpoint().to_f64() - 4.768_022_029_102_461).abs() < 1e-13);
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn prove_all(
    field: &Field,
    kind: &Kind,
    starts: &[Start],
    request: &Request,
) -> Result<Proof, Failure> {
    let (task, guess) = Task::new(field, kind, starts, &request.stop)?;
    let (centre, mut modes) = resolved(&task, guess, request)?;
    let bits = (f64::from(request.digits) * std::f64::consts::LOG2_10) as u32 + GUARD_BITS;
    let mut centre = centre.with_bits(bits.max(FAST_BITS));
    loop {
        let attempt = attempt(&task, &mut centre, modes, request, MOST_REFINEMENTS);
        let more = match attempt {
            Ok(proof) => return Ok(proof),
            Err(Failure::NoContraction { z0, z1, .. }) => ((z0 + z1) / 0.7).clamp(1.25, 2.0),
            Err(Failure::NotConverged { .. } | Failure::Residual { .. }) => 1.5,
            Err(other) => return Err(other),
        };
        if modes >= request.modes_limit {
            return attempt;
        }
        modes = ((modes as f64 * more) as usize + 1).min(request.modes_limit);
    }
}

/// An orbit that Newton's method found; nothing proves it.
#[derive(Clone, Debug)]
pub struct Approximation {
    /// omega.
    pub frequency: Float,
    /// Its estimated error: what further steps changed, and the bound at which they ended.
    pub error: Float,
    /// The largest mode of the inverse.
    pub modes: usize,
    orbit: Orbit,
}

impl Approximation {
    /// (x, x') at a phase tau in radians; the radii are the estimated errors.
    #[must_use]
    pub fn at_phase(&self, phase: &Ball) -> (Ball, Ball) {
        self.orbit.at_phase(phase)
    }

    /// The phase of the largest x, where x' = 0.
    #[must_use]
    pub fn rest(&self) -> Ball {
        self.orbit.critical(self.orbit.centre.top())
    }

    /// The harmonics in doubles.
    #[must_use]
    pub fn start(&self) -> Start {
        let frequency = self.frequency.to_rational().unwrap_or_default();
        Start::of(&frequency, &self.orbit.centre)
    }
}

/// Newton's method without the proof: to as many digits as are asked for, every residual formed without
/// rounding. Ends where a step is below 10^-digits of the largest harmonic; six more digits are computed to
/// estimate the error.
///
/// # Errors
/// [`Failure`]: what Newton's method failed on.
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_orbit::{Field, Kind, Request, Start, approximate};
/// let (x, y) = (Expression::DISPLACEMENT, Expression::VELOCITY);
/// let field = Field::new(&(Expression::ACCELERATION + x.clone() + (x.pow(2) - 1) * y), "eps", &Default::default())?;
/// let start = Start { frequency: 0.94, cosines: vec![0.0, 2.0], sines: vec![] };
/// let found = approximate(&field, &Kind::LimitCycle, &start, &Request::default())?;
/// // 2 pi over the period by integration with 34 digits.
/// assert!((found.frequency.to_f64() - 0.942_955_847_441_610_0).abs() < 1e-15 && found.error < 1e-15);
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn approximate(
    field: &Field,
    kind: &Kind,
    start: &Start,
    request: &Request,
) -> Result<Approximation, Failure> {
    let (task, guess) = Task::new(field, kind, std::slice::from_ref(start), &request.stop)?;
    let (centre, mut modes) = resolved(&task, guess, request)?;
    let bits = (f64::from(request.digits) * std::f64::consts::LOG2_10) as u32 + GUARD_BITS;
    let centre = centre.with_bits(bits.max(FAST_BITS));
    let goal = centre.largest() / Float::with_val(53, Float::i_pow_u(10, request.digits)) / 16u32;
    loop {
        let inverse = invert(&linearised(&task, &centre)?.1, modes)?;
        let most = MOST_TIMES * modes;
        let to =
            |centre: &Centre, target: &Float| refine(&task, centre.clone(), &inverse, target, most);
        let found = to(&centre, &goal).and_then(|rough| {
            let fine = to(&rough, &Float::with_val(53, &goal >> FURTHER_BITS))?;
            Ok((rough, fine))
        });
        match found {
            Ok((rough, fine)) => {
                let change =
                    Float::with_val(53, Rational::from(&rough.frequency - &fine.frequency)).abs();
                let frequency = Float::with_val(bits, &fine.frequency);
                let error = change + &goal;
                let balls = Balls::new(bits);
                let apart = rough.distance(&fine, Up::ONE, None);
                let orbit = Orbit {
                    radius: goal + Float::with_val(53, apart.0),
                    frequency: balls.from_parts(&frequency, &error),
                    centre: fine.component(0),
                    balls,
                };
                return Ok(Approximation { frequency, error, modes, orbit });
            }
            Err(Failure::NotConverged { .. }) if modes < request.modes_limit => {
                modes = (modes * 3 / 2).min(request.modes_limit);
            }
            Err(failure) => return Err(failure),
        }
    }
}

/// Harmonic balance with as many modes as resolve the orbit, over its own period and no multiple of it.
fn resolved(task: &Task, guess: Centre, request: &Request) -> Result<(Centre, usize), Failure> {
    let (centre, modes) = near_guess(task, guess, request)?;
    let sizes = sizes(&centre);
    let seen = REPEATED * sizes.iter().skip(1).sum::<f64>();
    let harmonics: Vec<usize> = (1..sizes.len()).filter(|k| sizes[*k] > seen).collect();
    let divides = |m: &usize| harmonics.iter().all(|k| k % m == 0);
    match (2..=harmonics.first().map_or(0, |k| *k)).rev().find(divides) {
        Some(repeats) if task.is_free() => {
            let parts = centre.doubles().into_iter();
            let parts: Vec<_> = parts.map(|c| c.into_iter().step_by(repeats).collect()).collect();
            let frequency = centre.frequency.to_f64() * repeats as f64;
            let once = Centre::from_doubles(FAST_BITS, frequency, &parts);
            balanced(task, once, RESOLVED, request)
        }
        _ => Ok((centre, modes)),
    }
}

/// Where x(0) is given, first with the
/// frequency of the guess in its place: near a separatrix the period hangs on the last digits of
/// x(0), not the other way round.
fn near_guess(task: &Task, guess: Centre, request: &Request) -> Result<(Centre, usize), Failure> {
    if task.rows.condition == Some(Condition::AtZero) {
        let near = |c: &Centre| {
            let miss = task.condition(c).to_f64().abs();
            miss < NEAR * task.value.to_f64().abs()
        };
        let fixed = task.with_frequency_fixed();
        let mut start = guess.clone();
        for fraction in [RESOLVED, FINELY] {
            let Ok((centre, modes)) = balanced(&fixed, start, fraction, request) else { break };
            if !near(&centre) {
                break;
            }
            if let Ok(found) = balance(task, centre.clone(), modes) {
                return Ok((found, modes));
            }
            start = centre;
        }
    }
    balanced(task, guess, RESOLVED, request)
}

/// sum_i |c_k| by modes.
fn sizes(centre: &Centre) -> Vec<f64> {
    let mut sizes = vec![0.0; centre.modes() + 1];
    for (k, c) in centre.doubles().iter().flat_map(|list| list.iter().enumerate()) {
        sizes[k] += c.norm();
    }
    sizes
}

fn balanced(
    task: &Task,
    guess: Centre,
    fraction: f64,
    request: &Request,
) -> Result<(Centre, usize), Failure> {
    let guessed = sizes(&guess);
    let allowed = GUESSED * guessed.iter().sum::<f64>();
    let beyond = |k: &usize| guessed.iter().skip(*k).sum::<f64>() < allowed;
    let given = (0..guessed.len()).find(beyond).unwrap_or(guessed.len());
    let mut modes = given.max(FIRST_MODES).min(request.modes_limit);
    let mut centre = guess;
    loop {
        let found = balance(task, centre.clone(), modes);
        if let Ok(found) = &found {
            let sizes = sizes(found);
            let highest: f64 = sizes.iter().skip(modes * 3 / 4).sum();
            if highest < fraction * sizes.iter().sum::<f64>() || modes >= request.modes_limit {
                return Ok((found.clone(), modes));
            }
            // A solution on very few modes need not be near the orbit; the guess may be better.
            if modes >= 4 * FIRST_MODES {
                centre = found.clone();
            }
        } else if modes >= request.modes_limit || matches!(found, Err(Failure::Stopped)) {
            return found.map(|centre| (centre, modes));
        }
        modes = (modes * 3 / 2).min(request.modes_limit);
    }
}

/// Refinement and proof with an inverse on `modes` modes.
fn attempt(
    task: &Task,
    centre: &mut Centre,
    modes: usize,
    request: &Request,
    mut tries: u32,
) -> Result<Proof, Failure> {
    let inverse = invert(&linearised(task, centre)?.1, modes)?;
    let goal = centre.largest() / Float::with_val(53, Float::i_pow_u(10, request.digits)) / 4u32;
    let mut target = Float::with_val(53, &goal / 16u32);
    loop {
        let most = MOST_TIMES * modes;
        *centre = refine(task, centre.clone(), &inverse, &target, most)?;
        let (values, linear) = linearised(task, centre)?;
        let frame = Frame::new(task, centre, &values, &linear, &inverse);
        let (weights, radii) = weighed(&frame, &inverse, request)?;
        tries -= 1;
        if radii.radius <= goal || tries == 0 {
            return conclude(task, &frame, centre.clone(), &weights, radii);
        }
        // The radius is larger than the last step: by |A|, by the weights, by 1 - Z0 - Z1.
        let excess = Float::with_val(53, &radii.radius / &goal) * 8u32;
        let bits = excess.get_exp().unwrap_or(0).unsigned_abs();
        target /= excess;
        *centre = centre.clone().with_bits(centre.bits + bits);
    }
}

/// Z0 + Z1 of a failure; 1 where that was not what failed.
fn defect(failure: &Failure) -> f64 {
    match failure {
        Failure::NoContraction { z0, z1, .. } => z0 + z1,
        _ => 1.0,
    }
}

/// The weight with the least radius, else with the least defect.
fn weighed(
    frame: &Frame<'_>,
    inverse: &Inverse,
    request: &Request,
) -> Result<(Weights, Radii), Failure> {
    let modes = inverse.modes;
    let mut best: Result<(Weights, Radii), Failure> = Err(Failure::Stopped);
    for c in WEIGHTS {
        if request.stop.asked() {
            return Err(Failure::Stopped);
        }
        // With a large weight the functions may not be enclosed any more.
        let weights = match frame.weights(1.0 + c / modes as f64) {
            Ok(weights) => weights,
            Err(failure) if matches!(best, Err(Failure::Stopped)) => return Err(failure),
            Err(_) => break,
        };
        let contraction = frame.contraction(Measure::Norm, &weights);
        let curvature = |r: &Float| frame.z2(&contraction, &weights, r);
        let found = decide(&contraction, modes, curvature);
        let good = contraction.z0.0 + contraction.z1.0 < GOOD;
        let better = match (&best, &found) {
            (Ok((_, old)), Ok(new)) => new.radius < old.radius,
            (Err(_), Ok(_)) | (Err(Failure::Stopped), _) => true,
            (Err(old), Err(new)) => defect(new) < defect(old),
            (Ok(_), Err(_)) => false,
        };
        if better {
            best = found.map(|radii| (weights, radii));
        }
        if good {
            break;
        }
    }
    best
}
