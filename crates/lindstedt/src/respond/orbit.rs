//! Steady states beside the periodic orbits of the equation itself, by Newton's method on the flow over a period.

use super::answer::State;
use super::subject::{Subject, doubles};
use super::{Respond, not_determined};
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, Work};
use lindstedt_evaluation::rotating::{FAMILY, forced_part};
use lindstedt_simulate::{
    Doubles, Integrator, Model, Parameters, Report, Settings, System, Tick, monodromy,
};
use nalgebra::{Complex, DMatrix, DVector};
use rug::Rational;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Steps of Newton's method.
const MOST_STEPS: usize = 30;
/// Singular values below this part of the largest are zero: those along the phase and along a family.
const CUT: f64 = 1e-9;
/// Boxes looked at for the states: their number need not be proved.
const MOST_BOXES: usize = 20_000;
/// Samples of the fastest harmonic per period of it.
const SAMPLES: u32 = 48;
/// Times the frequency of the first harmonic at most.
const FASTEST: f64 = 64.0;

/// a_j e^(i phi_j), and eta' without a force.
pub(crate) struct Harmonic {
    pub pairs: Vec<Complex<f64>>,
    pub frequency: Option<f64>,
    /// Of an orbit: by how much an error of the flow over its period moves it, from the least singular value that is not zero.
    pub condition: f64,
}

/// A steady state, and the first harmonics of the orbit near it, if one was found.
pub(crate) type Beside = (Harmonic, Option<Harmonic>);

impl Oscillator {
    /// The steady states of a slow flow that do not rest, and the orbits near them. Of families the states are those of the
    /// amplitudes that the orbits have.
    ///
    /// # Errors
    /// Those of [`Oscillator::respond`]; [`Refused`] where states are no periodic orbits of one period.
    pub(crate) fn steady_orbits(&self, order: usize, work: &Work) -> Result<Vec<Beside>, Error> {
        if !self.problem().others.is_empty() && self.value(FAMILY).is_none() {
            let one = Exact::Rational(1.into());
            return self.clone().with(FAMILY, one).steady_orbits(order, work);
        }
        let question = Respond { order: Some(order), ..Respond::default() };
        let mut subject = Subject::new(self, &question, work)?;
        subject.boxes = MOST_BOXES;
        let refused = |message: &str| Refused::no_answer("no-orbit", message, "lindstedt simulate");
        let beside = subject.slow.system.beside.as_ref();
        if beside.is_some_and(|it| it.rate != subject.slow.system.force()) {
            let message =
                "the force has a fixed frequency beside a resonance: no detuning of order eps";
            return Err(refused(message).into());
        }
        if subject.has_phase() || subject.rotating.combination.is_some() {
            return Err(refused("the force has a phase at t = 0, or leaves one free").into());
        }
        let flow = Flow::of(&subject)?;
        let moves = |state: &&State| state.at.iter().any(|x| *x != 0.0);
        let tick = || match work.stop.asked() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let mut list = Vec::new();
        for state in subject.all(&question)?.iter().filter(moves) {
            let own = |state: &State| subject.harmonic(state);
            let frequency = state.frequency.map(|it| it.value);
            let found =
                flow.closes(state).then(|| flow.orbit(subject.position(state), frequency, &tick));
            let Some(found) = found.flatten() else {
                list.push((own(state), None));
                continue;
            };
            let w: Vec<f64> = found.pairs.iter().flat_map(|c| [0.5 * c.re, 0.5 * c.im]).collect();
            let family = subject.rotating.unforced().filter(|_| subject.is_family());
            let amplitude = family.and_then(|it| it.amplitude(&subject.values([None, None]), &w));
            let amplitude = amplitude.and_then(Rational::from_f64);
            let (mut nearest, mut turned) = (own(state), found);
            if let Some(amplitude) = amplitude {
                let case = self.clone().with(FAMILY, Exact::Rational(amplitude));
                let other = Subject::new(&case, &question, work)?;
                let all = other.all(&question)?.into_iter();
                let away = |it: &State| -> f64 {
                    it.at.iter().zip(&state.at).map(|(a, b)| (a - b).powi(2)).sum()
                };
                let near = all.min_by(|a, b| away(a).total_cmp(&away(b)));
                nearest = near.map_or(nearest, |it| own(&it));
            }
            if let Some(free) = subject.rotating.unforced() {
                let weights = free.weights.each_ref().map(Rational::to_f64);
                turned.turn(&nearest, weights);
            }
            list.push((nearest, Some(turned)));
        }
        Ok(list)
    }
}

impl Harmonic {
    fn away(&self, other: &Self) -> f64 {
        self.pairs.iter().zip(&other.pairs).map(|(a, b)| (a - b).norm_sqr()).sum()
    }

    /// Takes the phase that is free from another one.
    fn turn(&mut self, like: &Self, weights: [f64; 2]) {
        let c = usize::from(like.pairs[1].norm() > like.pairs[0].norm());
        let off = (like.pairs[c] / self.pairs[c]).arg();
        let turned = |k: u32| {
            let angle = (off + TAU * f64::from(k)) / weights[c];
            let pairs = self.pairs.iter().zip(weights);
            let pairs = pairs.map(|(z, d)| z * Complex::from_polar(1.0, d * angle)).collect();
            Self { pairs, ..*self }
        };
        let all = (0..16).map(turned);
        if let Some(found) = all.min_by(|a, b| a.away(like).total_cmp(&b.away(like))) {
            *self = found;
        }
    }
}

impl Subject<'_> {
    fn all(&self, question: &Respond) -> Result<Vec<State>, Error> {
        let mut found = match self.rotating.unforced() {
            Some(free) => self.unforced(free, question)?,
            None => self.states()?,
        };
        Ok(found.states.pop().ok_or_else(not_determined)?.list)
    }

    fn harmonic(&self, state: &State) -> Harmonic {
        let pairs = state.at.chunks_exact(2).map(|w| Complex::new(2.0 * w[0], 2.0 * w[1]));
        Harmonic {
            pairs: pairs.collect(),
            frequency: state.frequency.map(|it| it.value),
            condition: 0.0,
        }
    }

    /// x_j and x_j' at t = 0 to leading order.
    fn position(&self, state: &State) -> Vec<f64> {
        let values = doubles(&self.values([None, None]));
        let unit = self.unit().map_or(f64::NAN, |unit| unit.midpoint().to_f64());
        let own = state.at.chunks_exact(2).zip(&self.slow.system.frequencies).enumerate();
        let own = own.map(|(j, (w, nu))| {
            let [forced, rate] = forced_part(&self.slow, j, &values);
            [2.0 * w[0] + forced, unit * (rate - 2.0 * nu.to_f64() * w[1])]
        });
        let own: Vec<_> = own.collect();
        let Some(shapes) = &self.slow.system.shapes else { return own.concat() };
        let row = |row: &Vec<Rational>| {
            row.iter()
                .zip(&own)
                .fold([0.0; 2], |[x, v], (p, q)| [x + p.to_f64() * q[0], v + p.to_f64() * q[1]])
        };
        shapes.iter().flat_map(row).collect()
    }
}

/// The equations of the user over a period of a response.
struct Flow {
    system: System<Doubles>,
    /// That of the force, q periods of it; nothing without one.
    period: Option<f64>,
    /// p_j and q of the k_j = p_j/q; of one that has no period with the others no number.
    turns: (Vec<f64>, f64),
    modes: Option<Vec<Vec<f64>>>,
}

impl Flow {
    fn of(subject: &Subject<'_>) -> Result<Self, Error> {
        let (oscillator, harmonics) = subject.in_time()?;
        let problem = oscillator.problem();
        let equations: Vec<_> = problem.equations().collect();
        let model = Model::of_unknowns(&equations)?.with_small(&problem.small).linearised();
        let small = subject.small.clone().unwrap_or_default();
        let parameters = Parameters::of_problem(problem, oscillator.given());
        let parameters = parameters.with(&problem.small, small.clone());
        let system = model.compile(Doubles, &parameters)?;
        // One that has no period with the others is zero, or the motion is no orbit.
        let (turns, q) = harmonics.of_one_period();
        let values = oscillator.rational_values();
        let value = |name: &str| values.get(name).cloned();
        let period = match subject.rotating.unforced() {
            Some(_) => None,
            None => {
                let rate = subject.slow.force_rate(0, &small, &value).ok_or(Error::NoValue)?;
                Some(TAU * q.to_f64() / rate.to_f64())
            }
        };
        Ok(Self { system, period, turns: (turns, q.to_f64()), modes: harmonics.modes })
    }

    /// Whether all that moves has one period.
    fn closes(&self, state: &State) -> bool {
        let mut pairs = state.at.chunks_exact(2).zip(&self.turns.0);
        pairs.all(|(w, p)| p.is_finite() || w.iter().all(|x| *x == 0.0))
    }

    /// The orbit near a start, of a free period if the force has none.
    fn orbit(&self, start: Vec<f64>, frequency: Option<f64>, tick: &Tick<'_>) -> Option<Harmonic> {
        let n = start.len();
        let q = self.turns.1;
        let mut at = start;
        let mut period = self.period.or_else(|| Some(TAU * q / frequency?))?;
        let precision = Settings::for_digits(16);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let flow = monodromy(&self.system, (&0.0, &period), &at, precision, tick).ok()?;
            let columns = n + usize::from(self.period.is_none());
            let rates = self.rates(&at)?;
            let matrix = DMatrix::from_fn(n, columns, |k, i| match flow.matrix[k].get(i) {
                Some(entry) => entry - if i == k { 1.0 } else { 0.0 },
                None => rates[k],
            });
            let off = DVector::from_fn(n, |k, _| flow.end[k] - at[k]);
            let svd = matrix.svd(true, true);
            let cut = CUT * svd.singular_values.max();
            let least = svd.singular_values.iter().filter(|x| **x > cut);
            let condition = least.fold(0.0f64, |most, x| most.max(x.recip()));
            let step = svd.solve(&off, cut).ok()?;
            at.iter_mut().zip(step.iter()).for_each(|(x, d)| *x -= d);
            period -= step.get(n).copied().unwrap_or(0.0);
            let (change, size) = (step.amax(), at.iter().fold(0.0f64, |m, x| m.max(x.abs())));
            if !change.is_finite() || change > 10.0 * size {
                return None;
            }
            if change < 1e-14 * size || (change < 1e-10 * size && change > 0.3 * before) {
                return Some(Harmonic { condition, ..self.harmonics(&at, period)? });
            }
            before = change;
        }
        None
    }

    /// x' at a start.
    fn rates(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut rates = None;
        let mut flow = Integrator::new(&self.system, &0.0, at, Settings::for_digits(16)).ok()?;
        flow.advance(&1e-3, &mut |report| {
            let Report::Segment(segment) = report else { return ControlFlow::Continue(()) };
            let rate = |k| segment.coefficients(k)?.get(1).copied();
            rates = (0..at.len()).map(rate).collect();
            ControlFlow::Break(())
        })
        .ok()?;
        rates
    }

    /// The harmonics k_j over one period.
    fn harmonics(&self, at: &[f64], period: f64) -> Option<Harmonic> {
        let (turns, q) = &self.turns;
        let most = turns.iter().fold(1.0f64, |most, p| most.max(p.abs()));
        let count = SAMPLES * most.min(FASTEST) as u32;
        let mut flow = Integrator::new(&self.system, &0.0, at, Settings::for_digits(16)).ok()?;
        let mut sums = vec![Complex::new(0.0, 0.0); turns.len()];
        for m in 0..count {
            let part = f64::from(m) / f64::from(count);
            if m > 0 {
                let end = period * part;
                flow.advance(&end, &mut |_| ControlFlow::Continue(())).ok()?;
            }
            let x: Vec<f64> = flow.state().iter().step_by(2).take(turns.len()).copied().collect();
            let own = |j: usize| match &self.modes {
                None => x[j],
                Some(rows) => rows[j].iter().zip(&x).map(|(p, x)| p * x).sum(),
            };
            let periodic =
                sums.iter_mut().zip(turns).enumerate().filter(|(_, (_, p))| p.is_finite());
            for (j, (sum, p)) in periodic {
                *sum += Complex::from_polar(2.0 * own(j) / f64::from(count), -TAU * p * part);
            }
        }
        let frequency = self.period.is_none().then_some(TAU * q / period);
        Some(Harmonic { pairs: sums, frequency, condition: 0.0 })
    }
}
