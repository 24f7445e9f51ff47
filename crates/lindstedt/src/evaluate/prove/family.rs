//! Proved orbits over a parameter or the amplitude: backbones, response curves.
//!
//! Every point is proved by itself, from a guess extrapolated from its neighbours. All values between two
//! neighbours are proved where a test with the whole interval for a coefficient succeeds ([`cover`]).

use super::orbit::ProvedOrbit;
use crate::evaluate::Evaluate;
use crate::evaluate::wanted::{Between as Uniform, Wanted};
use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Number, Oscillator, Progress, Remark, Standing, Status, Work};
use lindstedt_orbit::{Branch, Cover, Failure, Proof, Request, branches, cover};
use rayon::prelude::*;
use rug::Rational;
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::Instant;

/// Proved orbits over a parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ProvedFamily {
    /// The parameter that varies.
    pub parameter: String,
    /// Its values.
    pub values: Vec<Exact>,
    /// The orbits that were followed from one value to the next; there may be more.
    pub branches: Vec<ProvedBranch>,
}

/// Orbits that continue each other.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ProvedBranch {
    /// One orbit for each of the values from the first to the last.
    pub points: Vec<ProvedMember>,
    /// Where and why it was not followed further, within the values asked for.
    pub ends: Vec<EndOfBranch>,
}

/// An orbit of a branch.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ProvedMember {
    /// The value of the parameter.
    pub value: Exact,
    /// The orbit.
    #[serde(flatten)]
    pub orbit: ProvedOrbit,
    /// What is proved of the values up to the next one; nothing at the last.
    pub between: Option<Between>,
}

/// What is proved of all values between two neighbours.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Between {
    /// Whether for every value between there is exactly one orbit near the numerical ones, a branch that
    /// connects the neighbours.
    pub proved: bool,
    /// The parts of the interval that have a contraction test each.
    pub parts: u32,
    /// The frequencies of all these orbits, within the error; nothing where no part succeeded.
    pub frequency: Option<Number>,
    /// Why not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// Where a branch could not be followed further.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct EndOfBranch {
    /// The first value without a proved orbit of it.
    pub value: Exact,
    /// What failed.
    pub why: String,
}

/// The cases at all values.
struct Family<'a> {
    oscillator: &'a Oscillator,
    axis: &'a Axis,
    values: Vec<Rational>,
    request: Request,
}

impl Oscillator {
    /// The periodic orbits at all values of a parameter or of the amplitude, each proved as by
    /// [`Oscillator::prove`], followed from one value to the next; and, where a uniform bound covers it, for all
    /// values between. Of a forced equation and of a limit cycle further branches are looked for at the
    /// first and last value and where a branch ends (a fold).
    ///
    /// # Errors
    /// Those of [`Oscillator::prove`]; [`Refused`] for values that are multiples of pi. Values without a proved orbit are
    /// no error: the answer stands as [`Standing::Undecided`].
    ///
    /// ```
    /// use lindstedt::grid::Axis;
    /// use lindstedt::{Evaluate, Oscillator, Work};
    /// let duffing = Oscillator::builtin("duffing")?.set("eps", "1")?;
    /// let axis = Axis::parse("amplitude=1..6/5:3")?;
    /// let family = duffing.prove_sweep(&Evaluate::default(), axis, &Work::default())?.value;
    /// let points = &family.branches[0].points;
    /// assert_eq!(points.len(), 3);
    /// assert!(points[0].between.as_ref().is_some_and(|between| between.proved));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn prove_sweep(
        &self,
        question: &Evaluate,
        axis: Axis,
        work: &Work,
    ) -> Result<Answer<ProvedFamily>, Error> {
        let start = Instant::now();
        self.values_without_pi()?;
        let value = |value: &Exact| value.as_rational().cloned();
        let values: Option<Vec<Rational>> = axis.values.iter().map(value).collect();
        let values = values.filter(|values| !values.is_empty()).ok_or_else(|| {
            let hint = "NAME=LO..HI:COUNT with rational ends";
            Refused::usage("sweep", "a proof takes rational values".to_owned(), hint)
        })?;
        let request =
            Request { digits: work.digits, stop: work.stop.clone(), ..Request::default() };
        let family = Family { oscillator: self, axis: &axis, values, request };
        let mut remarks = self.remarks().to_vec();
        let found = family.search(question, work)?;
        let branches = found.iter().map(|branch| family.branch(branch, work));
        let branches: Vec<ProvedBranch> = branches.collect::<Result<_, _>>()?;
        let proved: BTreeSet<usize> =
            found.iter().flat_map(|f| f.first..f.first + f.proofs.len()).collect();
        let without = family.values.len() - proved.len();
        let standing = match () {
            () if work.stop.asked() => Standing::Stopped { done: proved.len() },
            () if without > 0 => {
                let all = family.values.len();
                remarks.push(Remark(format!("{without} of {all} values have no proved orbit")));
                Standing::Undecided
            }
            () => Standing::Complete,
        };
        let at = self.clone().with(&axis.name, axis.values[0].clone()).placed()?.0;
        let at = at.values_of_proof()?.into_iter().filter(|(name, _)| *name != axis.name);
        let header = self.header(at, None, "contraction proof", start);
        let (parameter, values) = (axis.name, axis.values);
        let value = ProvedFamily { parameter, values, branches };
        Ok(Answer { header, value, standing, remarks })
    }
}

impl Family<'_> {
    fn case(&self, value: &Rational) -> Result<Oscillator, Error> {
        let exact = Exact::Rational(value.clone());
        Ok(self.oscillator.clone().with(&self.axis.name, exact).placed()?.0)
    }

    fn wanted(&self, i: usize) -> Result<Wanted, Error> {
        self.case(&self.values[i])?.wanted(self.request.digits)
    }

    fn search(&self, question: &Evaluate, work: &Work) -> Result<Vec<Branch>, Error> {
        let orbits = |i: usize| -> Result<Vec<Proof>, Error> {
            let case = self.case(&self.values[i])?;
            let wanted = case.wanted(self.request.digits)?;
            Ok(case.all_or_first(&wanted, question, work)?.1?)
        };
        let problem = |value: &Rational| {
            let wanted = self.case(value).and_then(|case| case.wanted(self.request.digits));
            let wanted = wanted.map_err(|error| match error {
                Error::Orbit(failure) => failure,
                _ => Failure::NoStart,
            })?;
            Ok((wanted.field, wanted.kind))
        };
        branches(&self.values, problem, orbits, &self.request)
    }

    /// A branch as data.
    fn branch(&self, found: &Branch, work: &Work) -> Result<ProvedBranch, Error> {
        let last = found.proofs.len() - 1;
        let names = |k: usize| self.oscillator.problem().unknown(k);
        let point = |k: usize| {
            let (i, proof) = (found.first + k, &found.proofs[k]);
            let next = (k < last).then(|| self.between(i, [proof, &found.proofs[k + 1]], work));
            let orbit = ProvedOrbit::new(proof, &self.wanted(i)?, work.printed_digits(), &names);
            Ok(ProvedMember { value: self.axis.values[i].clone(), orbit, between: next })
        };
        let done = |(k, point)| {
            work.tell(Progress::Parts(k, last + 1));
            point
        };
        let points: Vec<Result<_, Error>> =
            (0..=last).into_par_iter().map(|k| (k, point(k))).map(done).collect();
        let end = |(i, failure): &(usize, Failure)| {
            let value = self.axis.values[*i].clone();
            EndOfBranch { value, why: failure.to_string() }
        };
        let ends = found.ends.iter().map(end).collect();
        Ok(ProvedBranch { points: points.into_iter().collect::<Result<_, _>>()?, ends })
    }

    /// What is proved between a value and the next.
    fn between(&self, i: usize, proofs: [&Proof; 2], work: &Work) -> Between {
        let ends = [self.values[i].clone(), self.values[i + 1].clone()];
        let problem = |part: &[Rational; 2]| {
            let cases = [self.case(&part[0]), self.case(&part[1])];
            let [Ok(low), Ok(high)] = cases else { return Err(Failure::NotOneNumber) };
            Uniform { name: &self.axis.name, ends: part, low: &low, high: &high }.question()
        };
        let Cover { parts, frequency, failure, .. } = cover(&ends, proofs, problem, &self.request);
        let digits = work.printed_digits();
        let number = |ball| Some(Number::of_ball(&ball, digits)?.weaken(Status::Proved));
        Between {
            proved: failure.is_none(),
            parts,
            frequency: frequency.and_then(number),
            why: failure.map(|failure| failure.to_string()),
        }
    }
}
