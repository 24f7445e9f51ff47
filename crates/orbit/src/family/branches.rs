//! All branches of orbits over the values of a parameter that are found from guesses.

use super::family;
use crate::{Failure, Field, Kind, Proof, Request, Start, guesses_all, prove_all};
use rug::Rational;
use std::collections::BTreeSet;

/// Orbits that continue each other, one for each of the values from one to another.
#[derive(Clone, Debug)]
pub struct Branch {
    /// The index of the first value.
    pub first: usize,
    /// The orbits.
    pub proofs: Vec<Proof>,
    /// Where, by the index of the value, and why it was not followed further.
    pub ends: Vec<(usize, Failure)>,
}

/// The branches that are found: those through the orbits that `orbits(index)` has at the first value with
/// one; then, of a forced equation and of a limit cycle, those through orbits proved from
/// [`guesses_all`] at the last value and where a branch ends (a fold), of a family those at every value that no
/// branch reaches (beyond an equilibrium or a separatrix). There may be more.
///
/// # Errors
/// The first error of `orbits` where no value has an orbit; those of [`family`].
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_orbit::{Field, Kind, Request, branches, guesses_all, prove_each};
/// // The backbone of x'' + x + x^3 = 0.
/// let x = Expression::DISPLACEMENT;
/// let field = Field::new(&(Expression::ACCELERATION + x.clone() + x.pow(3)), "eps", &Default::default())?;
/// let amplitudes = [(1, 2), (1, 1)].map(Into::into);
/// let problem = |a: &rug::Rational| Ok((field.clone(), Kind::InitialAmplitude(a.clone())));
/// let orbits = |i: usize| {
///     let (field, kind) = problem(&amplitudes[i])?;
///     let guesses = guesses_all(&field, &kind, &Default::default())?;
///     prove_each(&field, &kind, Vec::new(), &guesses, &Request::default())
/// };
/// let found = branches(&amplitudes, problem, orbits, &Request::default())?;
/// assert_eq!((found.len(), found[0].proofs.len()), (1, 2));
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn branches<E: From<Failure>>(
    values: &[Rational],
    problem: impl Fn(&Rational) -> Result<(Field, Kind), Failure>,
    orbits: impl Fn(usize) -> Result<Vec<Proof>, E>,
    request: &Request,
) -> Result<Vec<Branch>, E> {
    let Some(last) = values.len().checked_sub(1) else { return Ok(Vec::new()) };
    let mut search = Search { values, problem: &problem, request, found: Vec::new() };
    let mut refused = None;
    for i in 0..=last {
        if !search.found.is_empty() && (search.reaches(i) || !search.is_of_families(i)) {
            continue;
        }
        match orbits(i) {
            Ok(proofs) => {
                for proof in proofs {
                    search.follow(i, &proof.starts())?;
                }
            }
            Err(error) => refused = refused.or(Some(error)),
        }
        if request.stop.asked() {
            break;
        }
    }
    if let (true, Some(error)) = (search.found.is_empty(), refused) {
        return Err(error);
    }
    let (mut seen, mut waiting) = (BTreeSet::new(), vec![last]);
    while let Some(i) = waiting.pop() {
        // Each end of a branch is a place where another one may end.
        waiting.extend(search.found.iter().flat_map(Branch::ends_at).filter(|i| !seen.contains(i)));
        if seen.insert(i) && !request.stop.asked() {
            search.others(i)?;
        }
    }
    Ok(search.found)
}

/// The largest mode of the inverse from a guess.
const MODES_OF_A_GUESS: usize = 120;

/// The field and the question at a value.
type Problem<'a> = dyn Fn(&Rational) -> Result<(Field, Kind), Failure> + 'a;

struct Search<'a> {
    values: &'a [Rational],
    problem: &'a Problem<'a>,
    request: &'a Request,
    found: Vec<Branch>,
}

impl Search<'_> {
    /// Whether a branch has an orbit at a value.
    fn reaches(&self, i: usize) -> bool {
        self.found.iter().any(|branch| branch.at(i).is_some())
    }

    /// Whether the orbits at a value are those of a family.
    fn is_of_families(&self, i: usize) -> bool {
        let kind = (self.problem)(&self.values[i]).map(|(_, kind)| kind);
        kind.is_ok_and(|kind| !matches!(kind, Kind::Forced(_) | Kind::LimitCycle))
    }

    /// Branches through orbits at a value that are on none.
    fn others(&mut self, i: usize) -> Result<(), Failure> {
        let Ok((field, kind)) = (self.problem)(&self.values[i]) else { return Ok(()) };
        if self.is_of_families(i) {
            return Ok(());
        }
        let few = Request { modes_limit: MODES_OF_A_GUESS, ..self.request.clone() };
        for starts in guesses_all(&field, &kind, &few.stop).unwrap_or_default() {
            let Ok(proof) = prove_all(&field, &kind, &starts, &few) else { continue };
            let mut known = self.found.iter().filter_map(|branch| branch.at(i));
            if known.all(|other| other.is_separate_from(&proof)) {
                self.follow(i, &proof.starts())?;
            }
        }
        Ok(())
    }

    /// The branch through an orbit at a value, to both sides.
    fn follow(&mut self, i: usize, starts: &[Start]) -> Result<(), Failure> {
        let mut ends = Vec::new();
        let mut side = |indices: Vec<usize>| -> Result<Vec<Proof>, Failure> {
            let values: Vec<Rational> = indices.iter().map(|i| self.values[*i].clone()).collect();
            let mut proofs = Vec::new();
            let members = family(&values, self.problem, starts, self.request)?;
            for (i, member) in indices.into_iter().zip(members) {
                match member.proof {
                    Ok(proof) => proofs.push(proof),
                    Err(failure) => ends.push((i, failure)),
                }
            }
            Ok(proofs)
        };
        let mut proofs = side((0..=i).rev().collect())?;
        let up = side((i..self.values.len()).collect())?;
        let Some(first) = (i + 1).checked_sub(proofs.len().max(1)) else { return Ok(()) };
        proofs.reverse();
        proofs.extend(up.into_iter().skip(usize::from(!proofs.is_empty())));
        if !proofs.is_empty() {
            self.found.push(Branch { first, proofs, ends });
        }
        Ok(())
    }
}

impl Branch {
    fn at(&self, i: usize) -> Option<&Proof> {
        self.proofs.get(i.checked_sub(self.first)?)
    }

    /// The values at which it ends within those asked for.
    fn ends_at(&self) -> Vec<usize> {
        let last = self.first + self.proofs.len() - 1;
        self.ends.iter().map(|(i, _)| if *i > last { last } else { self.first }).collect()
    }
}

/// The orbits that are proved from guesses, after those that are `known` already: each is proved to be another one
/// than those before.
///
/// # Errors
/// The last failure where there is no orbit; [`Failure::Stopped`].
pub fn prove_each(
    field: &Field,
    kind: &Kind,
    known: Vec<Proof>,
    guesses: &[Vec<Start>],
    request: &Request,
) -> Result<Vec<Proof>, Failure> {
    let (mut proofs, mut failure) = (known, Failure::NoStart);
    for starts in guesses {
        match prove_all(field, kind, starts, request) {
            Ok(proof) if proofs.iter().all(|other| other.is_separate_from(&proof)) => {
                proofs.push(proof);
            }
            Ok(_) => {}
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(other) => failure = other,
        }
    }
    if proofs.is_empty() { Err(failure) } else { Ok(proofs) }
}
