//! The orbit as a theorem: exactly one periodic orbit within a radius of the numbers, whether or not
//! the series converges, which gives no more than the guess ([`lindstedt_orbit`]).

mod expansion;
mod family;
mod orbit;

use super::turn::TimeDomain;
use super::wanted::Wanted;
use super::{Evaluate, Evaluation, Question, Trajectory};
use crate::refusal::Refused;
use crate::{Answer, Error, Oscillator, Remark, Standing, Work};
pub use family::{Between, EndOfBranch, ProvedBranch, ProvedFamily, ProvedMember};
use lindstedt_algebra::Stop;
use lindstedt_orbit::{
    Failure, Kind, Proof, Request, Start, guesses, guesses_all, prove, prove_each,
};
pub use orbit::{Bounds, Expansion, ProvedOrbit, ProvedState, UnknownOrbit, UnknownState, Verdict};
use std::time::Instant;

/// Harmonics of the guess from the expansion; Newton's method finds the others.
const GUESSED: usize = 11;

/// The largest mode of the inverse from a guess of the second rank.
const MODES_OF_A_GUESS: usize = 120;

/// The orbits, the first one asked for, or why there is none.
type Outcome = Result<Vec<Proof>, Failure>;

/// Digits of the expansion's sum for it.
const DIGITS_OF_A_GUESS: u32 = 16;

impl Oscillator {
    /// Proves the periodic orbit at the values set: a limit cycle, the member of a family with the
    /// amplitude given, or the responses to a force with its period. Period, frequency, x at phase 0, extrema and the Floquet exponent are enclosed
    /// to `work.digits` digits ([`Status::Proved`](crate::Status::Proved)); the guess is the motion in the time domain, else
    /// the sum of the expansion, else harmonic balance (of responses the only one). For one equation or
    /// several, made of polynomials, rational powers, sines, cosines and exponentials of the unknowns and
    /// their velocities with rational coefficients; a small parameter is not needed. Of several
    /// unknowns the guesses are the normal modes continued in the amplitude of the first, or the motion
    /// once it repeats itself.
    ///
    /// Where the proof fails the estimated period stands as before, and what failed is said
    /// ([`Standing::Undecided`]). Cost: third power of the modes (400: a second).
    ///
    /// # Errors
    /// Those of [`Oscillator::evaluate`] but for a series without a digit; [`Refused`] where the
    /// equation is not of the form.
    ///
    /// ```
    /// use lindstedt::{Evaluate, Oscillator, Status, Work};
    /// let cycle = Oscillator::builtin("van-der-pol")?.set("eps", "1")?;
    /// let proved = cycle.prove(&Evaluate::default(), &Work::default())?.value;
    /// let period = proved.period.ok_or(lindstedt::Error::NoValue)?;
    /// // Integration with 34 digits; the proof does not know it.
    /// assert!(period.decimal.starts_with("6.663286859323130189699682"));
    /// assert_eq!(period.status, Status::Proved);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn prove(&self, question: &Evaluate, work: &Work) -> Result<Answer<ProvedOrbit>, Error> {
        let start = Instant::now();
        self.values_without_pi()?;
        let (case, mut remarks) = self.placed()?;
        let wanted = case.wanted(work.digits)?;
        let (mut found, outcome) = case.all_or_first(&wanted, question, work)?;
        if outcome.is_err() && case.has_expansion() {
            found = case.period(question, work).ok().or(found);
        }
        if wanted.is_substituted() {
            let what = "proved for u = sin(q x/2), q the factor of x in the sine: u is polynomial";
            remarks.push(Remark(what.to_owned()));
        }
        let order = found.as_ref().map(|found| found.order);
        let (value, standing) = match outcome {
            Ok(all) => {
                let of_sum = case.of_the_sum(&all, &wanted, question, work);
                let digits = work.printed_digits();
                let names = |k: usize| self.problem().unknown(k);
                let orbit = |(i, proof): (usize, &Proof)| ProvedOrbit {
                    expansion: of_sum.clone().filter(|(found, _)| *found == i).map(|(_, how)| how),
                    solution: ProvedOrbit::states(proof, &wanted, question, digits, &names),
                    ..ProvedOrbit::new(proof, &wanted, digits, &names)
                };
                let mut orbits: Vec<ProvedOrbit> = all.iter().enumerate().map(orbit).collect();
                // That of the expansion, where it is known, is the one that was asked for.
                if let Some((i, _)) = of_sum {
                    orbits.swap(0, i);
                }
                let first = orbits.remove(0);
                (ProvedOrbit { further: orbits, ..first }, Standing::Complete)
            }
            Err(failure) => {
                remarks.push(Remark(format!("not proved: {failure}")));
                (ProvedOrbit::estimated(found, &failure), Standing::Undecided)
            }
        };
        let header = self.header(case.values_of_proof()?, order, "contraction proof", start);
        Ok(Answer { header, value, standing, remarks })
    }

    /// Of several unknowns all orbits, of one that of the first guess and its companions.
    fn all_or_first(
        &self,
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Result<(Option<Evaluation>, Outcome), Error> {
        match self.problem().others.is_empty() {
            true => self.attempt(wanted, question, work),
            false => {
                let request = self.request(work);
                let (field, kind) = (&wanted.field, &wanted.kind);
                let guesses = guesses_all(field, kind, &request.stop)?;
                Ok((None, prove_each(field, kind, Vec::new(), &guesses, &request)))
            }
        }
    }

    /// The proof from the first guess that leads to one: the motion in the time domain, then those of the
    /// expansion, which is made only then, then harmonic balance.
    fn attempt(
        &self,
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Result<(Option<Evaluation>, Outcome), Error> {
        let request = self.request(work);
        // Some guesses belong to no orbit.
        let guessed = Request { modes_limit: MODES_OF_A_GUESS, ..request.clone() };
        let mut outcome = Err(Failure::NoStart);
        let mut found = None;
        if !wanted.is_forced() {
            if let Some(start) = self.by_motion(wanted, &work.stop) {
                outcome = prove(&wanted.field, &wanted.kind, &start, &request);
            }
            // With too few modes no other guess is better.
            let ends = |found: &Result<_, _>| matches!(found, Ok(_) | Err(Failure::Stopped));
            if !ends(&outcome) && !matches!(outcome, Err(Failure::NoContraction { .. })) {
                let rough = Work { digits: DIGITS_OF_A_GUESS.min(work.digits), ..work.clone() };
                found = self.period(question, &rough).ok();
                for start in self.starts(found.as_ref(), wanted, question, &rough) {
                    outcome = prove(&wanted.field, &wanted.kind, &start, &guessed);
                    if ends(&outcome) {
                        break;
                    }
                }
            }
        }
        if work.stop.asked() && outcome.is_err() {
            let hint = "raise --limit-seconds, or ask for fewer --digits";
            return Err(Refused::stopped("stopped before the proof was finished", hint).into());
        }
        Ok((found, with_others(wanted, outcome, &guessed)))
    }

    fn request(&self, work: &Work) -> Request {
        Request { digits: work.digits, stop: work.stop.clone(), ..Request::default() }
    }

    /// A guess from the closed form or from the motion in the time domain.
    pub(super) fn by_motion(&self, wanted: &Wanted, stop: &Stop) -> Option<Start> {
        let moving = || {
            if self.has_expansion() {
                return TimeDomain::new(&self.setting().ok()?, stop).start(stop).ok();
            }
            let values = self.coefficients_of_proof().ok()?;
            let start = match &wanted.kind {
                Kind::InitialAmplitude(a) => Some(a),
                Kind::LimitCycle => None,
                _ => return None,
            };
            let motion = TimeDomain::of_equation(self.problem(), &values, start, stop);
            motion.start(stop).ok()
        };
        wanted.closed.clone().or_else(moving)
    }

    /// A guess from the expansion's sum, where it has a digit.
    pub(super) fn by_sum(
        &self,
        found: Option<&Evaluation>,
        question: &Evaluate,
        work: &Work,
    ) -> Option<Start> {
        let found = found.filter(|f| f.period.is_some() || f.exact_period.is_some())?;
        let (order, phase) = (question.order, &question.phase);
        let setting = self.setting().ok()?;
        let asked = Question { setting, order, phase, evaluation: found, in_doubles: true };
        let path = Trajectory::without_error(asked, work).ok()?;
        let (cosines, sines) = path.guess(GUESSED)?;
        Some(Start { frequency: path.frequency(), cosines, sines })
    }

    /// Guesses: the expansion's sum, then one harmonic, then harmonic balance.
    fn starts(
        &self,
        found: Option<&Evaluation>,
        wanted: &Wanted,
        question: &Evaluate,
        work: &Work,
    ) -> Vec<Start> {
        let balanced = guesses(&wanted.field, &wanted.kind, &work.stop).unwrap_or_default();
        if wanted.is_substituted() {
            return balanced;
        }
        let mut starts: Vec<Start> = self.by_sum(found, question, work).into_iter().collect();
        let amplitude = match &wanted.kind {
            Kind::InitialAmplitude(a) | Kind::FundamentalAmplitude(a) => a.to_f64(),
            // That of van der Pol's equation: one harmonic is a guess for weak cycles only.
            _ => 2.0,
        };
        let period = found.map(|found| found.best_period.midpoint().to_f64());
        let guessed = period.map(|period| std::f64::consts::TAU / period);
        let guessed = guessed.filter(|omega| omega.is_finite() && *omega > 0.0);
        starts.extend(balanced);
        for frequency in guessed.into_iter().chain([1.0]) {
            starts.push(Start { frequency, cosines: vec![0.0, amplitude], sines: Vec::new() });
        }
        starts
    }
}

/// A response, or a limit cycle where more than one is likely, with the others that are proved from the guesses
/// of harmonic balance, the smallest first; there may be more.
fn with_others(wanted: &Wanted, first: Result<Proof, Failure>, request: &Request) -> Outcome {
    let (field, kind) = (&wanted.field, &wanted.kind);
    let known = match first {
        Ok(proof) => vec![proof],
        Err(_) if wanted.is_forced() => Vec::new(),
        Err(failure) => return Err(failure),
    };
    if !(wanted.is_forced() || wanted.kind == Kind::LimitCycle) {
        return Ok(known);
    }
    let starts = guesses_all(field, kind, &request.stop)?;
    match known.len() == 1 && starts.len() < 2 {
        true => Ok(known),
        false => prove_each(field, kind, known, &starts, request),
    }
}
