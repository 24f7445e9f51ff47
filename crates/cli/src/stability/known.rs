//! The oscillator asked about, built in or of a file: its parameters, and what can be swept.

use crate::failure::Failure;
use crate::recognised::Source;
use crate::session::parameters;
use lindstedt::Exact;
use lindstedt::equation::Expression;
use lindstedt::problems::vibro_impact;
use lindstedt::recognise::ImpactProblem;
use lindstedt_impact::chart::Swept;
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use rug::Rational;
use std::cmp::Ordering;
use std::sync::Arc;

/// The branch set, and the other settings.
fn branch_of(set: &[String]) -> Result<(Option<Branch>, Vec<String>), Failure> {
    let (branches, numbers): (Vec<String>, Vec<String>) =
        set.iter().cloned().partition(|item| item.trim().starts_with("branch="));
    let branch = match branches.as_slice() {
        [] => None,
        [only] => match only.trim().trim_start_matches("branch=").trim() {
            "+" | "plus" => Some(Branch::Plus),
            "-" | "minus" => Some(Branch::Minus),
            other => {
                let message = format!("branch is + or -, not {other:?}");
                return Err(Failure::usage("set", message, "--set branch=-"));
            }
        },
        _ => return Err(Failure::usage("set", "branch is set twice".to_owned(), "")),
    };
    Ok((branch, numbers))
}

/// k as a number of periods.
fn whole_periods(k: &Exact) -> Result<u32, Failure> {
    let whole = k.as_rational().filter(|q| q.is_integer() && **q > 0).ok_or_else(|| {
        Failure::usage("parameter", "k must be a positive integer".to_owned(), "--set k=2")
    })?;
    whole.numer().to_u32().ok_or_else(|| {
        let message = format!("k is too large: at most {}", u32::MAX);
        Failure::usage("parameter", message, "--set k=2")
    })
}

/// The parameters given and the defaults of the others, and all of them as text in the order of
/// the card.
pub fn exact_parameters(
    set: &[String],
) -> Result<(ExactParameters, Vec<(String, String)>), Failure> {
    let (branch, numbers) = branch_of(set)?;
    let branch = branch.unwrap_or(Branch::Plus);
    let mut given = parameters(&numbers)?;
    let mut at = Vec::new();
    let mut values = std::collections::BTreeMap::new();
    for card in vibro_impact::problem().parameters {
        if card.name == "branch" {
            let sign = if branch == Branch::Plus { "+" } else { "-" };
            at.push(("branch".to_owned(), sign.to_owned()));
            continue;
        }
        let value = match given.remove(&*card.name) {
            Some(value) => value,
            None => Exact::parse(&card.default)?,
        };
        at.push((card.name.to_string(), value.to_string()));
        values.insert(card.name.to_string(), value);
    }
    if let Some(name) = given.keys().next() {
        let known: Vec<&str> = at.iter().map(|(name, _)| name.as_str()).collect();
        let message = format!("vibro-impact has no parameter {name:?}");
        let hint = format!("it has {}; T = 2 pi k/omega follows", known.join(", "));
        return Err(Failure::usage("unknown-parameter", message, &hint));
    }
    let get = |name: &str| values.get(name).cloned().unwrap_or_else(|| Exact::from(0));
    let periods = whole_periods(values.get("k").unwrap_or(&Exact::from(0)))?;
    let parameters = ExactParameters {
        alpha: get("alpha"),
        omega: get("omega"),
        periods,
        restitution: get("R_r"),
        wall: get("s"),
        damping: get("c"),
        force: get("P0"),
        displacement_gain: get("A"),
        velocity_gain: get("B"),
        branch,
    };
    parameters.nearest().validate()?;
    Ok((parameters, at))
}

/// The parameter of section 2 that a name stands for, if it is one, and its value.
pub type Names = dyn Fn(&str) -> Result<(Option<Swept>, f64), Failure>;

/// A sweep as it is meant.
pub type Meaning = dyn Fn(&str) -> Result<String, Failure>;

/// Parameters of section 2 from values of a file's; nothing where there is no such oscillator.
pub type Computed = dyn Fn(&[(&str, Exact)]) -> Option<Parameters<f64>> + Sync;

/// What the problem says.
pub struct Known {
    pub problem: String,
    pub parameters: ExactParameters,
    pub canonical: Option<Vec<(String, String)>>,
    pub remark: Option<String>,
    pub at: Vec<(String, String)>,
    /// The swept parameter of a name, or why it cannot be swept.
    pub names: Box<Names>,
    /// A sweep as it is meant: without a range the one of the file.
    pub text: Box<Meaning>,
    pub computed: Option<Box<Computed>>,
}

fn not_swept(name: &str, why: &str, known: &[String]) -> Failure {
    let message = format!("{name:?} cannot be swept{why}");
    Failure::usage("unknown-parameter", message, &format!("known: {}", known.join(", ")))
}

/// Every k has an orbit of its own.
const WHOLE: &str =
    ": it is a whole number, and every k has another orbit (--set k=1, --set k=2, ...)";

pub fn built_in(set: &[String]) -> Result<Known, Failure> {
    let (parameters, at) = exact_parameters(set)?;
    let names = |name: &str| {
        let found = Swept::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, swept)| (Some(*swept), f64::NAN)).ok_or_else(|| {
            let known: Vec<String> =
                Swept::ALL.iter().map(|(name, _)| (*name).to_owned()).collect();
            not_swept(name, if name == "k" { WHOLE } else { "" }, &known)
        })
    };
    Ok(Known {
        problem: "vibro-impact".to_owned(),
        parameters,
        canonical: None,
        remark: None,
        at,
        names: Box::new(names),
        text: Box::new(|text| Ok(text.to_owned())),
        computed: None,
    })
}

/// The name for k where a file has another k.
const PERIODS: &str = "periods";

/// A problem file with one impact in k periods of its force.
pub fn of_file(path: &str, set: &[String]) -> Result<Known, Failure> {
    let (branch, numbers) = branch_of(set)?;
    let source = Source::read(path, &numbers, &["k", PERIODS])?;
    let card = |name: &str| source.problem.parameters.iter().find(|card| card.name == name);
    let default = card("branch").filter(|card| card.default == "-").map(|_| Branch::Minus);
    let branch = branch.or(default).unwrap_or(Branch::Plus);
    let tied = source.problem.synchronous.as_ref().map(|tie| tie.periods.to_string());
    // The file may use the name k for something else, a stiffness.
    let count = if card("k").is_some() { PERIODS } else { "k" };
    if count != PERIODS && card(PERIODS).is_none() && source.values.contains_key(PERIODS) {
        let message = format!("{} has no parameter {PERIODS:?}", source.problem.name);
        return Err(Failure::usage("unknown-parameter", message, "--set k=N"));
    }
    let k = source.values.get(count).filter(|_| card(count).is_none());
    if k.is_some()
        && (tied.is_some() || source.problem.equation.nodes().any(Expression::is_delayed))
    {
        let message = format!("{} has no parameter {count:?}", source.problem.name);
        let hint = "the periods between impacts follow from its delay or its [synchronous]";
        return Err(Failure::usage("unknown-parameter", message, hint));
    }
    let periods = k.map(whole_periods).transpose()?;
    let found = ImpactProblem::new(&source.problem, &source.values, periods, branch)
        .map_err(|refusal| source.refuse(refusal))?;
    found.parameters.nearest().validate()?;
    let sign = if branch == Branch::Plus { "+" } else { "-" };
    let mut at = Vec::new();
    for card in &source.problem.parameters {
        match source.values.get(&*card.name) {
            _ if card.name == "branch" => at.push(("branch".to_owned(), sign.to_owned())),
            Some(value) => at.push((card.name.to_string(), value.to_string())),
            None => {}
        }
    }
    let small = &*source.problem.small;
    let unlisted = |name: &str| source.values.get(name).filter(|_| card(name).is_none());
    for name in [small, count] {
        at.extend(unlisted(name).map(|value| (name.to_owned(), value.to_string())));
    }
    if card("branch").is_none() {
        at.push(("branch".to_owned(), sign.to_owned()));
    }
    let mut canonical: Vec<(String, String)> = Vec::new();
    let mut own = found.parameters.clone();
    for (name, swept) in Swept::ALL {
        canonical.push((name.to_owned(), own.slot(swept).to_string()));
    }
    canonical.push(("k".to_owned(), found.parameters.periods.to_string()));
    canonical.push(("branch".to_owned(), sign.to_owned()));
    let same = canonical.iter().all(|entry| at.contains(entry));
    let remark = found.other_orders.then(|| {
        "the averaged prediction counts damping and delay loop as of order 1 in the small \
         parameter, whatever their order in the file"
            .to_owned()
    });
    let (problem, parameters) = (source.problem.name.to_string(), found.parameters.clone());
    let shared = Arc::new((source, found));
    let whole = move |name: &str| name == count || tied.as_deref() == Some(name);
    let of_names = shared.clone();
    let names = move |name: &str| {
        let (source, found) = &*of_names;
        let is_free = |name: &str| !whole(name) && name != "branch";
        // Another delay than a period of the force has no such orbit.
        let moves = |name: &str, value: &Exact| {
            let beside = Rational::from((1010, 1009));
            let beside = match value.sign() {
                Ordering::Equal => Exact::from(beside - 1u32),
                _ => value.times(&beside),
            };
            computed_parameters(source, periods, branch, &[(name, beside)]).is_some()
        };
        let swept = |name: &str| {
            let value = source.values.get(name).filter(|_| is_free(name))?;
            let swept = found.names(&source.problem, &source.values, name, periods);
            let is_known = swept.is_some() || moves(name, value);
            is_known.then(|| (swept, value.to_f64()))
        };
        swept(name).ok_or_else(|| {
            let known = source.at().into_iter().map(|(name, _)| name);
            let known: Vec<String> = known.filter(|name| swept(name).is_some()).collect();
            let why = match source.values.contains_key(name) {
                _ if whole(name) => WHOLE,
                true => ": with another value it is not this oscillator",
                false => "",
            };
            not_swept(name, why, &known)
        })
    };
    let of_text = shared.clone();
    let computed =
        move |changes: &[(&str, Exact)]| computed_parameters(&shared.0, periods, branch, changes);
    Ok(Known {
        problem,
        parameters,
        canonical: (!same).then_some(canonical),
        remark,
        at,
        names: Box::new(names),
        text: Box::new(move |text| of_text.0.sweep(text)),
        computed: Some(Box::new(computed)),
    })
}

/// The parameters of section 2 with other values of those of a file.
fn computed_parameters(
    source: &Source,
    periods: Option<u32>,
    branch: Branch,
    changes: &[(&str, Exact)],
) -> Option<Parameters<f64>> {
    let mut values = source.values.clone();
    values.extend(changes.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
    let found = ImpactProblem::new(&source.problem, &values, periods, branch).ok()?;
    let parameters = found.parameters.nearest();
    parameters.validate().ok().map(|()| parameters)
}
