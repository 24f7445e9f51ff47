//! A proved orbit followed in a parameter or in the amplitude, each point proved.

mod between;
mod branches;
mod cover;
mod part;

pub use branches::{Branch, branches, prove_each};
pub use cover::{Cover, cover};

use crate::start::distance;
use crate::{Failure, Field, Kind, Proof, Request, Start, prove_all};
use rug::Rational;

/// One point of a family.
#[derive(Clone, Debug)]
pub struct Member {
    /// The parameter.
    pub value: Rational,
    /// What is proved there.
    pub proof: Result<Proof, Failure>,
}

/// A point passed: the parameter, the orbit in doubles by unknowns.
type Passed = (Rational, Vec<Start>);

/// The proof at a value from guesses.
type At<'a> = dyn Fn(&Rational, &[Start], &Request) -> Result<Proof, Failure> + 'a;

/// Modes of an inverse beyond those of the numerical orbit before.
const MORE_MODES: usize = 60;
/// The part of the first step after which there is a direction.
const FIRST_STEP: (i32, i32) = (1, 8);
/// Halvings of a step over which Newton's method does not go.
const MOST_HALVINGS: u32 = 6;

/// The orbits of `problem(value)` at the values in this order, each proved by itself ([`prove_all`], from a
/// start for every unknown); the guess is extrapolated from the two points before. Where the step is too large for Newton's method, points
/// between are passed through (not returned). Ends after the first point that fails, which may be where
/// the family turns back.
///
/// Between the points nothing is proved; [`cover`] does that, where its bounds suffice. A step after which the
/// orbit is farther from its prediction than from the orbit before is too large, too: it may be
/// another branch.
///
/// # Errors
/// What `problem` returns for the first value; later failures stand in their [`Member`].
///
/// ```
/// use lindstedt_equation::Expression;
/// use lindstedt_orbit::{Field, Kind, Request, Start, family};
/// // The backbone of x'' + x + x^3 = 0: the frequency grows with the amplitude.
/// let x = Expression::DISPLACEMENT;
/// let field = Field::new(&(Expression::ACCELERATION + x.clone() + x.pow(3)), "eps", &Default::default())?;
/// let start = Start { frequency: 1.04, cosines: vec![0.0, 0.3], sines: vec![] };
/// let amplitudes = [(3, 10), (1, 1), (2, 1)].map(Into::into);
/// let problem = |a: &rug::Rational| Ok((field.clone(), Kind::InitialAmplitude(a.clone())));
/// let members = family(&amplitudes, problem, &[start], &Request::default())?;
/// let proofs: Vec<_> = members.iter().flat_map(|m| &m.proof).collect();
/// assert_eq!(proofs.len(), 3);
/// assert!(proofs.windows(2).all(|p| p[0].frequency.upper() < p[1].frequency.lower()));
/// # Ok::<(), lindstedt_orbit::Failure>(())
/// ```
pub fn family(
    values: &[Rational],
    problem: impl Fn(&Rational) -> Result<(Field, Kind), Failure>,
    starts: &[Start],
    request: &Request,
) -> Result<Vec<Member>, Failure> {
    let at = |value: &Rational, starts: &[Start], request: &Request| {
        let (field, kind) = problem(value)?;
        prove_all(&field, &kind, starts, request)
    };
    let mut members: Vec<Member> = Vec::new();
    let mut passed: Vec<Passed> = Vec::new();
    for value in values {
        let Some((from, _)) = passed.last().cloned() else {
            problem(value)?;
            let proof = at(value, starts, request);
            passed.extend(proof.iter().map(|p| (value.clone(), p.starts())));
            let failed = proof.is_err();
            members.push(Member { value: value.clone(), proof });
            if failed {
                break;
            }
            continue;
        };
        let proof = approach(&from, value, &mut passed, request, &at);
        let failed = proof.is_err();
        members.push(Member { value: value.clone(), proof });
        if failed {
            break;
        }
    }
    Ok(members)
}

/// A proof at `value`, by steps from the last point that are halved while they fail.
fn approach(
    from: &Rational,
    value: &Rational,
    passed: &mut Vec<Passed>,
    request: &Request,
    at: &At<'_>,
) -> Result<Proof, Failure> {
    // A failing step shall fail soon: few digits, and few more modes than before.
    let modes = |orbit: &[Start]| orbit.iter().map(|x| x.cosines.len()).max().unwrap_or(0);
    let most = passed.last().map_or(0, |(_, orbit)| modes(orbit)) + MORE_MODES;
    let request = &Request { modes_limit: request.modes_limit.min(most), ..request.clone() };
    let rough = Request { digits: 10, ..request.clone() };
    let whole = Rational::from(value - from);
    // With one orbit before nothing is predicted: a short step gives the direction.
    let first = if passed.len() > 1 { Rational::from(1) } else { FIRST_STEP.into() };
    let (mut done, mut part) = (Rational::new(), first);
    loop {
        let next = Rational::from(&done + &part);
        let target = Rational::from(&whole * &next) + from;
        let start = extrapolated(passed, &target);
        let last = next == 1;
        let found = at(&target, &start, if last { request } else { &rough });
        let found = found.and_then(|proof| match is_predicted(passed, &start, &proof.starts()) {
            true => Ok(proof),
            false => Err(Failure::Jump),
        });
        match found {
            Ok(proof) => {
                passed.push((target, proof.starts()));
                if last {
                    return Ok(proof);
                }
                done = next;
            }
            Err(Failure::Stopped) => return Err(Failure::Stopped),
            Err(failure) => {
                part /= 2;
                if part < Rational::from((1, 1 << MOST_HALVINGS)) {
                    return Err(failure);
                }
            }
        }
    }
}

/// Changes of this share of the orbit are not looked at.
const SMALL: f64 = 1e-2;

/// Whether an orbit is nearer to its prediction than to the orbit before.
fn is_predicted(passed: &[Passed], predicted: &[Start], found: &[Start]) -> bool {
    let Some((_, last)) = passed.last() else { return true };
    let (missed, moved) = (distance(found, predicted), distance(found, last));
    // With one orbit before there is no direction: the step itself must be small.
    let allowed = if passed.len() > 1 { 0.5 * moved } else { 0.5 };
    missed <= allowed.max(SMALL)
}

/// The straight line through the last two orbits.
fn extrapolated(passed: &[Passed], value: &Rational) -> Vec<Start> {
    let Some((last, new)) = passed.last() else { return Vec::new() };
    let Some((before, old)) = passed.len().checked_sub(2).and_then(|i| passed.get(i)) else {
        return new.clone();
    };
    let step = Rational::from(last - before);
    if step.is_zero() {
        return new.clone();
    }
    let t = (Rational::from(value - last) / step).to_f64();
    let line = |new: &[f64], old: &[f64]| -> Vec<f64> {
        let pairs = new.iter().enumerate();
        pairs.map(|(k, c)| c + t * (c - old.get(k).copied().unwrap_or(0.0))).collect()
    };
    let one = |(new, old): (&Start, &Start)| Start {
        frequency: new.frequency + t * (new.frequency - old.frequency),
        cosines: line(&new.cosines, &old.cosines),
        sines: line(&new.sines, &old.sines),
    };
    new.iter().zip(old).map(one).collect()
}
