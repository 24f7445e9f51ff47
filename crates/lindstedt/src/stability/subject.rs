//! The oscillator that is asked about in its canonical form, at other values of parameters.

use super::Stability;
use crate::grid::Axis;
use crate::refusal::Refused;
use crate::{Error, Exact, Oscillator};
use lindstedt_equation::Expression;
use lindstedt_impact::ImpactError;
use lindstedt_impact::parameters::{Branch, Parameters, Swept};
use lindstedt_impact::report::Request;
use lindstedt_recognise::ImpactProblem;
use rug::Rational;
use std::collections::BTreeMap;

/// The name for k where a file has another k.
const PERIODS: &str = "periods";
/// Every k has an orbit of its own.
const WHOLE: &str =
    ": it is a whole number, and every k has another orbit (--set k=1, --set k=2, ...)";

/// The oscillator with what was found in its equation.
pub(super) struct Subject<'a> {
    pub oscillator: &'a Oscillator,
    pub question: &'a Stability,
    values: BTreeMap<String, Exact>,
    branch: Branch,
    /// The name for k, and k where it was given.
    count: &'static str,
    periods: Option<u32>,
    pub found: ImpactProblem,
    /// All parameters as they stand.
    pub at: Vec<(String, String)>,
}

/// A swept parameter, and which canonical one it is.
pub(super) struct Range {
    pub axis: Axis,
    pub known: Option<Swept>,
    /// The value at the point.
    pub base: f64,
}

/// k as a number of periods.
fn whole_periods(name: &str, k: &Exact) -> Result<u32, Error> {
    let hint = format!("--set {name}=1");
    let whole = k.as_rational().filter(|q| q.is_integer() && **q > 0).ok_or_else(|| {
        Refused::usage("parameter", format!("{name} must be a positive integer"), &*hint)
    })?;
    let message = || format!("{name} is too large: at most {}", u32::MAX);
    let count = whole.numer().to_u32();
    Ok(count.ok_or_else(|| Refused::usage("parameter", message(), &*hint))?)
}

fn sign(branch: Branch) -> &'static str {
    if branch == Branch::Plus { "+" } else { "-" }
}

impl<'a> Subject<'a> {
    pub fn new(oscillator: &'a Oscillator, question: &'a Stability) -> Result<Self, Error> {
        oscillator.single()?;
        let values = oscillator.form_values(&["k", PERIODS])?;
        let problem = oscillator.problem();
        let card = |name: &str| problem.parameters.iter().find(|card| card.name == name);
        let default = card("branch").filter(|card| card.default == "-").map(|_| Branch::Minus);
        let branch = question.branch.or(default).unwrap_or(Branch::Plus);
        let unknown = |name: &str, hint: &str| {
            let message = format!("{} has no parameter {name:?}", problem.name);
            Err(Refused::usage("unknown-parameter", message, hint).into())
        };
        // The file may use the name k for something else, a stiffness.
        let count = if card("k").is_some() { PERIODS } else { "k" };
        if count != PERIODS && card(PERIODS).is_none() && values.contains_key(PERIODS) {
            return unknown(PERIODS, "--set k=N");
        }
        let k = values.get(count).filter(|_| card(count).is_none());
        let tied = problem.synchronous.as_ref().map(|tie| &*tie.periods);
        let delays = || problem.equation.nodes().any(Expression::is_delayed);
        if k.is_some() && (tied.is_some() || delays()) {
            let hint = "the periods between impacts follow from its delay or its [synchronous]";
            return unknown(count, hint);
        }
        if let Some((name, k)) = tied.and_then(|name| Some((name, values.get(name)?))) {
            whole_periods(name, k)?;
        }
        let frequency = problem.synchronous.as_ref().and_then(|tie| values.get(&*tie.frequency));
        if frequency.is_some_and(|omega| omega.sign().is_eq()) {
            return Err(ImpactError::NotPositive { name: "omega", value: 0.0 }.into());
        }
        let periods = k.map(|k| whole_periods(count, k)).transpose()?;
        let found = ImpactProblem::new(problem, &values, periods, branch);
        let found = found.map_err(|refusal| oscillator.unfit(refusal))?;
        found.parameters.nearest().validate()?;
        let mut subject =
            Self { oscillator, question, values, branch, count, periods, found, at: Vec::new() };
        subject.at = subject.listed();
        Ok(subject)
    }

    /// The parameters with their values, in the order of the problem.
    fn listed(&self) -> Vec<(String, String)> {
        let problem = self.oscillator.problem();
        let branch = || ("branch".to_owned(), sign(self.branch).to_owned());
        let shown = |name: &str| Some((name.to_owned(), self.values.get(name)?.to_string()));
        let cards = problem.parameters.iter();
        let mut at: Vec<_> = cards
            .filter_map(
                |card| if card.name == "branch" { Some(branch()) } else { shown(&card.name) },
            )
            .collect();
        for name in [&*problem.small, self.count] {
            if at.iter().all(|(known, _)| known != name) {
                at.extend(shown(name));
            }
        }
        if at.iter().all(|(known, _)| known != "branch") {
            at.push(branch());
        }
        at
    }

    /// The canonical parameters, where they are not those of the problem.
    pub fn canonical(&self) -> Vec<(String, String)> {
        let mut own = self.found.parameters.clone();
        let mut list: Vec<(String, String)> = Swept::ALL
            .into_iter()
            .map(|(name, swept)| (name.to_owned(), own.slot(swept).to_string()))
            .collect();
        list.push(("k".to_owned(), self.found.parameters.periods.to_string()));
        list.push(("branch".to_owned(), sign(self.branch).to_owned()));
        if list.iter().all(|entry| self.at.contains(entry)) { Vec::new() } else { list }
    }

    /// The question about one point; the impact-aware prediction stands beside the plain one.
    pub fn request(&self) -> Request {
        let Stability { variant, order, kick, .. } = *self.question;
        Request { variant, order, kick, ..Request::default() }
    }

    /// The canonical parameters with other values; nothing where there is no such oscillator.
    pub fn changed(&self, changes: &[(&str, &Exact)]) -> Option<Parameters<f64>> {
        let mut values = self.values.clone();
        values.extend(changes.iter().map(|(name, value)| ((*name).to_owned(), (*value).clone())));
        let problem = self.oscillator.problem();
        let found = ImpactProblem::new(problem, &values, self.periods, self.branch).ok()?;
        let parameters = found.parameters.nearest();
        parameters.validate().ok().map(|()| parameters)
    }

    /// The canonical parameter that a name stands for, if it is one, and its value; nothing for
    /// what cannot be swept.
    fn named(&self, name: &str) -> Option<(Option<Swept>, f64)> {
        let value = self.values.get(name).filter(|_| !self.counts(name) && name != "branch")?;
        let problem = self.oscillator.problem();
        let known = self.found.names(problem, &self.values, name, self.periods);
        // Another delay than a period of the force has no such orbit.
        let moves = || {
            let beside = Rational::from((1010, 1009));
            let beside = match value.sign() {
                std::cmp::Ordering::Equal => Exact::from(beside - 1u32),
                _ => value.times(&beside),
            };
            self.changed(&[(name, &beside)]).is_some()
        };
        (known.is_some() || moves()).then(|| (known, value.to_f64()))
    }

    /// Whether the parameter counts periods.
    fn counts(&self, name: &str) -> bool {
        let tie = self.oscillator.problem().synchronous.as_ref();
        name == self.count && self.periods.is_some() || tie.is_some_and(|tie| tie.periods == name)
    }

    fn range(&self, axis: &Axis) -> Result<Range, Error> {
        let name = &*axis.name;
        self.oscillator.check_varied(name)?;
        if let Some((known, base)) = self.named(name) {
            return Ok(Range { axis: axis.clone(), known, base });
        }
        let known: Vec<&str> = self.at.iter().map(|(name, _)| &**name).collect();
        let known: Vec<&str> = known.into_iter().filter(|n| self.named(n).is_some()).collect();
        let why = match self.values.contains_key(name) {
            _ if self.counts(name) || name == self.count => WHOLE,
            true => ": with another value it is not this oscillator",
            false => "",
        };
        let message = format!("{name:?} cannot be swept{why}");
        let hint = match &known[..] {
            [] => "the equation and the wall have no parameter that can".to_owned(),
            names => format!("known: {}", names.join(", ")),
        };
        Err(Refused::usage("unknown-parameter", message, hint).into())
    }

    /// The swept ranges.
    pub fn swept(&self, list: &[Axis]) -> Result<Vec<Range>, Error> {
        if list.len() > 2 {
            return Err(Refused::usage("range", "at most two sweeps", "").into());
        }
        let ranges: Vec<Range> =
            list.iter().map(|axis| self.range(axis)).collect::<Result<_, _>>()?;
        if let [first, second] = ranges.as_slice()
            && (first.axis.name == second.axis.name
                || first.known.is_some() && first.known == second.known)
        {
            let message = format!("{} is swept twice", first.axis.name);
            return Err(Refused::usage("range", message, "").into());
        }
        Ok(ranges)
    }
}
