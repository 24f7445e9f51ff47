//! The oscillator that is asked about, as Melnikov's method sees it, at other values of parameters.

use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator, Work};
use lindstedt_equation::Expression;
use lindstedt_melnikov::{self as melnikov, StickSlip};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_recognise::{LowestHarmonic, MelnikovProblem, Refusal, SplittingProblem};
use std::collections::BTreeMap;

/// The oscillator with what was found in its equation.
pub(super) struct Subject<'a> {
    pub oscillator: &'a Oscillator,
    pub work: &'a Work,
    values: BTreeMap<String, Exact>,
    pub found: MelnikovProblem,
    /// The oscillator of section 3, where the equation is one.
    pub point: Option<StickSlip>,
    /// What gamma and gamma_c are in the symbols of the problem.
    pub lowest: Option<LowestHarmonic>,
}

/// A range of a parameter.
pub(super) struct Range {
    pub axis: Axis,
    /// The parameter of section 3 that it is; nothing for others.
    pub known: Option<melnikov::Axis>,
}

/// Parameters at other values.
pub(super) type Changes<'a> = [(&'a Range, &'a Exact)];

impl<'a> Subject<'a> {
    pub fn new(oscillator: &'a Oscillator, work: &'a Work) -> Result<Self, Error> {
        oscillator.single()?;
        let values = oscillator.form_values(&[])?;
        let problem = oscillator.problem();
        let found = MelnikovProblem::new(problem, &values);
        let found = found.map_err(|why| unfit(oscillator, &values, why))?.watched(&work.stop);
        let (point, lowest) = (found.stick_slip(), LowestHarmonic::find(problem, &values));
        Ok(Self { oscillator, work, values, found, point, lowest })
    }

    /// The small parameter; 1 where it has no value.
    pub fn eps(&self) -> Exact {
        self.values.get(&*self.oscillator.problem().small).cloned().unwrap_or(Exact::from(1))
    }

    /// The equation in the form of the second order.
    pub fn splitting(&self) -> Result<SplittingProblem, Error> {
        let found = SplittingProblem::new(self.oscillator.problem(), &self.values, &self.found);
        found.map_err(|refusal| self.oscillator.unfit(refusal))
    }

    /// A range, if its parameter can be varied: the amplitude of the force cannot, gamma_c is a
    /// value of it.
    pub fn range(&self, axis: &Axis) -> Result<Range, Error> {
        let name = &axis.name;
        self.oscillator.check_varied(name)?;
        let problem = self.oscillator.problem();
        let amplitude = self.lowest.as_ref().and_then(|lowest| lowest.parameter.as_ref());
        let is_force = |name: &String| amplitude.is_some_and(|(force, _)| force == name);
        let varies = |name: &String| **name != *problem.small && !is_force(name);
        if !self.values.contains_key(name) || !varies(name) {
            let known: Vec<String> =
                self.oscillator.all_values().into_iter().map(|v| v.0).collect();
            let known: Vec<&str> = known.iter().filter(|name| varies(name)).map(|n| &**n).collect();
            let message = if is_force(name) {
                format!("{name:?} cannot be varied: the threshold is a value of it")
            } else {
                format!("{name:?} cannot be varied")
            };
            return Err(Refused::usage("unknown-parameter", message, known.join(", ")).into());
        }
        let known = self.found.axis(problem, &self.values, name);
        Ok(Range { axis: axis.clone(), known })
    }

    /// The swept ranges.
    pub fn swept(&self, list: &[Axis]) -> Result<Vec<Range>, Error> {
        if list.len() > 2 {
            return Err(Refused::usage("range", "at most two sweeps", "").into());
        }
        if let [first, second] = list
            && first.name == second.name
        {
            let message = format!("{} is swept twice", first.name);
            return Err(Refused::usage("range", message, "").into());
        }
        list.iter().map(|axis| self.range(axis)).collect()
    }

    /// The oscillator of section 3 with other values, where all of them are its own.
    pub fn changed(&self, changes: &Changes<'_>) -> Option<StickSlip> {
        let change = |point: StickSlip, (range, value): &(&Range, &Exact)| {
            Some(point.with(range.known?, (*value).clone()))
        };
        changes.iter().try_fold(self.point.clone()?, change)
    }

    /// The signed threshold with other values, or why there is none; of several orbits that of the
    /// least threshold.
    pub fn signed(&self, balls: Balls, changes: &Changes<'_>) -> Result<Ball, String> {
        let undecided = || format!("not decided with {} bits", balls.bits());
        // Outside its domain the equation may be another one that is taken.
        if let Some(point) = self.changed(changes).filter(|point| point.check().is_ok()) {
            return point.signed_threshold(balls).ok_or_else(undecided);
        }
        let mut values = self.values.clone();
        for (range, value) in changes {
            values.insert(range.axis.name.clone(), (*value).clone());
        }
        let found = MelnikovProblem::new(self.oscillator.problem(), &values);
        let found = found.map_err(|refusal| self.oscillator.reason(&refusal))?;
        let orbits = found.watched(&self.work.stop).thresholds(balls);
        let orbits = orbits.map_err(|error| error.to_string())?;
        let least = |a: &Ball, b: &Ball| a.midpoint().total_cmp(b.midpoint());
        let least = orbits.iter().min_by(|a, b| least(&a.value.gamma, &b.value.gamma));
        least.map(|orbit| orbit.value.signed.clone()).ok_or_else(undecided)
    }
}

/// A refusal; of an equation without a value, that the value may be what is sought.
fn unfit(oscillator: &Oscillator, values: &BTreeMap<String, Exact>, why: Refusal) -> Error {
    let names = match &why {
        Refusal::MissingValues { names } => names.clone(),
        _ => Vec::new(),
    };
    let forced = oscillator.problem().equation.contains(&Expression::Time);
    // With 1 for what has no value the equation shows which of them gamma_c is a value of.
    let mut known = values.clone();
    known.extend(names.iter().map(|name| (name.clone(), Exact::from(1))));
    let lowest = LowestHarmonic::find(oscillator.problem(), &known);
    let amplitude = lowest.and_then(|lowest| lowest.parameter).map(|(name, _)| name);
    let sought = match (names.first(), amplitude.filter(|name| names.contains(name))) {
        (Some(name), _) if !forced => {
            format!("--unknown {name} finds the value for which the orbit persists")
        }
        (_, Some(name)) => format!(
            "gamma_c is the critical value of {name} and does not depend on it: --set {name}=1"
        ),
        _ => return oscillator.unfit(why),
    };
    match oscillator.unfit(why) {
        Error::Refused(refused) => {
            let hint = format!("{}; {sought}", refused.hint);
            Refused { hint, ..refused }.into()
        }
        error => error,
    }
}
