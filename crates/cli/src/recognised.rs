//! What `threshold` and `stability` share about problem files: values, refusals with their place.

use crate::failure::{Failure, NO_ANSWER, UNDECIDED, USAGE};
use crate::session::{Loaded, load, parameters};
use lindstedt::equation::print::Style;
use lindstedt::equation::{Expression, Problem};
use lindstedt::recognise::{Refusal, all_values};
use lindstedt::{Exact, ProblemFile};
use std::collections::BTreeMap;

/// A problem file with the values of its parameters.
pub struct Source {
    pub path: String,
    pub problem: Problem,
    file: ProblemFile,
    /// The small parameter among them.
    pub values: BTreeMap<String, Exact>,
}

impl Source {
    /// Reads the file; `extra` names may be set besides its parameters.
    pub fn read(path: &str, set: &[String], extra: &[&str]) -> Result<Self, Failure> {
        let Loaded { problem, file } = load(path)?;
        let file = file.ok_or_else(|| {
            Failure::usage("unknown-problem", format!("{path} is no problem file"), "")
        })?;
        let given = parameters(set)?;
        let small = problem.small.to_string();
        let card = |name: &str| problem.parameters.iter().any(|card| card.name == name);
        let known = |name: &str| card(name) || name == small || extra.contains(&name);
        if let Some(name) = given.keys().find(|name| !known(name)) {
            let names: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
            let message = format!("{} has no parameter {name:?}", problem.name);
            let hint = match file.follows.get(name) {
                Some(how) => format!("{name} follows: {how}"),
                None => format!("it has {}", names.join(", ")),
            };
            return Err(Failure::usage("unknown-parameter", message, &hint));
        }
        let mut values = all_values(&problem, &given);
        values.extend(given);
        Ok(Self { path: path.to_owned(), problem, file, values })
    }

    /// The parameters as they stand, in the order of the file.
    pub fn at(&self) -> Vec<(String, Exact)> {
        let cards = self.problem.parameters.iter();
        let value = |name: &str| Some((name.to_owned(), self.values.get(name)?.clone()));
        let mut at: Vec<_> = cards.filter_map(|card| value(&card.name)).collect();
        // Set, though the file does not list it.
        if at.iter().all(|(name, _)| *name != *self.problem.small) {
            at.extend(value(&self.problem.small));
        }
        at
    }

    /// `NAME=RANGE` as it is meant: NAME alone has the range that the file says (`swept`); what the
    /// file calls `fixed` is not varied.
    pub fn sweep(&self, text: &str) -> Result<String, Failure> {
        let name = text.split('=').next().unwrap_or_default().trim();
        if self.file.fixed.iter().any(|fixed| fixed == name) {
            let message = format!("{name:?} cannot be varied: it is fixed in {}", self.path);
            return Err(Failure::usage("unknown-parameter", message, "--set changes it"));
        }
        match self.file.ranges.get(text.trim()) {
            Some(range) => Ok(format!("{name}={range}")),
            None => Ok(text.to_owned()),
        }
    }

    /// A refusal in words.
    pub fn reason(&self, refusal: &Refusal) -> String {
        match refusal {
            Refusal::Term { term, why } => {
                let text = term.print(&self.problem.small, Style::Text);
                format!("{} {why}", text.chars().take(80).collect::<String>())
            }
            other => other.to_string(),
        }
    }

    /// A refusal with the place of its term.
    pub fn refuse(&self, refusal: Refusal) -> Failure {
        let text = self.reason(&refusal);
        // As it occurs multiplied out, without its factors eps and -1, or what it is a product of.
        let place = refusal.term().and_then(|term| {
            let factors = match term {
                Expression::Product(list) => list.clone(),
                single => vec![single.clone()],
            };
            let plain = |e: &Expression| matches!(e, Expression::Small | Expression::Number(_));
            let bare: Vec<Expression> = factors.into_iter().filter(|e| !plain(e)).collect();
            let constant = Expression::is_constant;
            let varying: Vec<Expression> = bare.iter().filter(|e| !constant(e)).cloned().collect();
            let product = |list: Vec<Expression>| Expression::Product(list).canonical();
            let tries = [term.clone(), product(bare), product(varying.clone())];
            tries.iter().chain(&varying).find_map(|part| self.file.locate(part))
        });
        let place = place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"));
        let shown: String = self.path.chars().take(60).collect();
        let message = format!("{shown}{place}: {text}");
        let (exit, code, hint) = match refusal {
            Refusal::MissingValues { .. } => {
                (USAGE, "missing-value", "give it under [parameters] or with --set NAME=VALUE")
            }
            Refusal::Periods { .. } => (USAGE, "parameter", "k = 1, 2, ..."),
            Refusal::TooManyTerms { .. } => (UNDECIDED, "too-large", ""),
            Refusal::Melnikov(error) => return Failure { message, ..error.into() },
            _ => (NO_ANSWER, "no-method", "`lindstedt problems --show FILE` lists the methods"),
        };
        // Without it every term is one of order zero.
        let unmarked = code == "no-method" && !self.problem.equation.contains(&Expression::Small);
        let small = &self.problem.small;
        let follows = match code {
            "missing-value" => self.file.follows.iter().find(|(name, _)| text.contains(&**name)),
            _ => None,
        };
        let hint = if let Some((name, how)) = follows {
            format!(
                "{name} follows: {how}; with pi only `simulate` computes it: in the file {name} = {{ value = \
                 \"5*pi\" }} in the place of follows; a delay of whole periods is tied to the force by \
                 [synchronous]"
            )
        } else if unmarked {
            format!("a factor {small}, or orders = {{ NAME = 1 }}, marks the small terms")
        } else {
            hint.to_owned()
        };
        Failure { exit, code, message, hint }
    }
}
