//! The question `threshold --unknown` to first order: the zero of Melnikov's integral in a parameter.

use super::HomoclinicSeries;
use super::orbits::{self, ORDERING_BITS};
use crate::{Answer, Error, Exact, Kind, Number, Oscillator, Refusal, Status, Work};
use lindstedt_equation::Problem;
use lindstedt_melnikov::{Class, MelnikovError};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::certified;
use lindstedt_recognise::{PersistenceProblem, Persistent};
use serde::Serialize;
use std::time::Instant;

/// The order of a series that is not asked for.
const ORDER: usize = 2;

/// The value of a parameter mu for which an orbit between saddles persists, to first order in the small parameter:
/// the work of the perturbation along the unperturbed orbit, D_0 + mu D_1, vanishes at mu = -D_0/D_1.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Persistence {
    /// The problem.
    #[serde(skip)]
    pub problem: Problem,
    /// The small parameter.
    pub parameter: String,
    /// The parameter that is sought.
    pub unknown: String,
    /// Right loop before left, upper orbit before lower.
    pub orbits: Vec<PersistentOrbit>,
    /// What first order is worth, as of a threshold.
    pub validity: &'static str,
}

/// One orbit.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct PersistentOrbit {
    /// Which; with its saddle where there are several.
    pub name: String,
    /// mu.
    pub value: Number,
    /// D_0, the work of the perturbation without mu.
    #[serde(rename = "D_0")]
    pub known: Number,
    /// D_1, the work of the factor of mu.
    #[serde(rename = "D_1")]
    pub factor: Number,
    /// How the orbit was checked.
    pub check: Option<String>,
}

impl Oscillator {
    /// The value of the parameter `name` for which homoclinic and heteroclinic orbits persist, to first order in the
    /// small parameter: the zero of Melnikov's integral, for
    ///
    ///   x'' = f(x) + eps (g_0(x, x') + mu g_1(x, x'))
    ///
    /// with any force f that [`Oscillator::threshold`] takes; [`Oscillator::homoclinic`] gives every order where the orbit
    /// allows it. Certified on orbits in closed form, estimated on others. Cost: as of a threshold.
    ///
    /// # Errors
    /// [`Refused`](crate::Refused) with the term that does not fit; [`Error::Melnikov`] where mu does no work on an orbit.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// // A pendulum under a torque: 4 delta/pi.
    /// let pendulum = Oscillator::parse("x'' + sin(x) = eps*(torque - x'/5)")?;
    /// let found = pendulum.persistence("torque", &Work::default())?.value;
    /// assert!(found.orbits[0].value.decimal.starts_with("0.2546479089470"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn persistence(&self, name: &str, work: &Work) -> Result<Answer<Persistence>, Error> {
        let start = Instant::now();
        self.single()?;
        self.check_sought(name)?;
        let values = self.form_values(&[])?;
        let found = PersistenceProblem::new(self.problem(), &values, name);
        let found = found.map_err(|why| self.unfit(why))?.watched(&work.stop);
        let eps = values.get(&*self.problem().small).cloned().unwrap_or(Exact::from(1));
        let roughest = found.roughest(Balls::new(ORDERING_BITS), eps.to_f64());
        let validity = orbits::verdict(roughest, &eps);
        let value = Persistence {
            problem: self.problem().clone(),
            parameter: self.problem().small.to_string(),
            unknown: name.to_owned(),
            orbits: numbers(&found, work.printed_digits()).map_err(|e| super::stopped(e, work))?,
            validity,
        };
        let at = values.into_iter().filter(|(other, _)| other != name);
        let tier = match found.class() {
            Class::Certified => "certified",
            Class::Estimated => "estimated",
        };
        let header = self.header(at, None, tier, start);
        let remarks = self.remarks().to_vec();
        Ok(Answer { header, value, standing: crate::Standing::Complete, remarks })
    }
}

/// The answer to `threshold --unknown`.
#[derive(Clone, Debug)]
pub enum Persisting {
    /// Every order.
    Series(Box<Answer<HomoclinicSeries>>),
    /// First order.
    First(Box<Answer<Persistence>>),
}

impl Oscillator {
    /// [`Oscillator::homoclinic`] to an order, or to second order where none is asked for; where there is no such series,
    /// and none or order zero was asked for, [`Oscillator::persistence`].
    ///
    /// # Errors
    /// Those of the one or the other.
    ///
    /// ```
    /// use lindstedt::threshold::Persisting;
    /// use lindstedt::{Oscillator, Work};
    /// // sin x is no polynomial: first order.
    /// let pendulum = Oscillator::parse("x'' + sin(x) = eps*(torque - x'/5)")?;
    /// let found = pendulum.persisting("torque", None, &Work::default())?;
    /// assert!(matches!(found, Persisting::First(_)));
    /// assert!(pendulum.persisting("torque", Some(2), &Work::default()).is_err());
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn persisting(
        &self,
        name: &str,
        order: Option<usize>,
        work: &Work,
    ) -> Result<Persisting, Error> {
        let boxed = |answer| Persisting::First(Box::new(answer));
        match self.homoclinic(name, order.unwrap_or(ORDER), work) {
            Err(error) if order.unwrap_or(0) == 0 && error.kind() == Kind::NoAnswer => {
                self.persistence(name, work).map(boxed)
            }
            series => series.map(|answer| Persisting::Series(Box::new(answer))),
        }
    }
}

fn numbers(found: &PersistenceProblem, digits: usize) -> Result<Vec<PersistentOrbit>, Error> {
    let estimated = found.class() == Class::Estimated;
    let bits = if estimated { orbits::estimating_bits(digits) } else { ORDERING_BITS };
    let list = found.orbits(Balls::new(bits))?;
    let checks = orbits::checks(found.unperturbed(), digits);
    let names = orbits::names(&list);
    let number = |n: usize, part: fn(&Persistent) -> &Ball| -> Result<Number, Error> {
        if estimated {
            let number = Number::of_ball(part(&list[n].value), digits);
            let number = number.ok_or(MelnikovError::Undecided { bits })?;
            return Ok(number.weaken(Status::Estimated));
        }
        let at = |balls: Balls| found.orbits(balls).ok()?.get(n).map(|o| part(&o.value).clone());
        Ok(certified(None, digits, at)?)
    };
    let one = |(n, name): (usize, String)| {
        Ok(PersistentOrbit {
            name,
            value: number(n, |orbit| &orbit.parameter)?,
            known: number(n, |orbit| &orbit.work[0])?,
            factor: number(n, |orbit| &orbit.work[1])?,
            check: orbits::check(found.unperturbed(), checks.get(n)),
        })
    };
    names.into_iter().enumerate().map(one).collect()
}
