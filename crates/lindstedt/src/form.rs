//! What the questions that take an equation by its form share: values, ranges, refusals with their
//! place.

use crate::grid::Axis;
use crate::refusal::{Refusal as _, Refused};
use crate::{Error, Exact, Oscillator, Remark};
use lindstedt_algebra::Stop;
use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;
use lindstedt_problem_file::canonical_name;
use lindstedt_recognise::Refusal;
use std::collections::BTreeMap;

/// What makes room for symbols of files whose numbers follow from pi.
const FOLLOWS: &str = "with pi only `simulate` computes it: in the file NAME = { value = \"5*pi\" } \
                       in the place of follows; a delay of whole periods is tied to the force by \
                       [synchronous]";

impl Oscillator {
    /// The values of all parameters, the small one among them; `extra` names may be set besides.
    pub(crate) fn form_values(&self, extra: &[&str]) -> Result<BTreeMap<String, Exact>, Error> {
        let problem = self.problem();
        let card = |name: &str| problem.parameters.iter().any(|card| card.name == name);
        let known = |name: &str| card(name) || name == problem.small || extra.contains(&name);
        if let Some(name) = self.given().keys().find(|name| !known(name)) {
            let names: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
            let hint = match self.problem_file().follows.get(name) {
                Some(how) => format!("{name} follows: {how}"),
                None => format!("it has {}", names.join(", ")),
            };
            let message = format!("{} has no parameter {name:?}", problem.name);
            return Err(Refused::usage("unknown-parameter", message, hint).into());
        }
        Ok(self.all_values().into_iter().collect())
    }

    /// A range of values, `NAME=LO..HI:COUNT` or `NAME=V1,V2,...`; `NAME` alone has the range that
    /// the file says (`swept`).
    ///
    /// # Errors
    /// As [`Axis::parse`]; [`Refused`] for what the file calls `fixed`.
    ///
    /// ```
    /// use lindstedt::Oscillator;
    /// let axis = Oscillator::builtin("stick-slip")?.axis("vstar=0..1:3")?;
    /// assert_eq!(axis.doubles(), [0.0, 0.5, 1.0]);
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn axis(&self, text: &str) -> Result<Axis, Error> {
        self.axis_until(text, &Stop::default())
    }

    /// As [`Oscillator::axis`], broken off by `stop`.
    ///
    /// # Errors
    /// Those of [`Oscillator::axis`] and [`Axis::parse_until`].
    pub fn axis_until(&self, text: &str, stop: &Stop) -> Result<Axis, Error> {
        let (file, text) = (self.problem_file(), text.trim());
        self.check_varied(text.split('=').next().unwrap_or_default())?;
        match file.ranges.get(text) {
            Some(range) => Axis::parse_until(&format!("{text}={range}"), stop),
            None => Axis::parse_until(text, stop),
        }
    }

    /// The same with the first values of ranges where the parameters have no value, and that it is so: those other than 0, at
    /// which a force or a friction would be none.
    pub(crate) fn at_beginnings<'a>(
        &self,
        axes: impl Iterator<Item = &'a Axis>,
    ) -> (Self, Vec<Remark>) {
        let (mut case, mut remarks) = (self.clone(), Vec::new());
        for axis in axes {
            let name = &axis.name;
            let occurs = self.problem().parameters.iter().any(|card| card.name == *name);
            let acts = axis.values.iter().find(|value| value.sign().is_ne());
            if let Some(value) = acts.or(axis.values.first())
                && occurs
                && self.value(name).is_none()
            {
                case = case.with(name, value.clone());
                let begins =
                    if axis.values.first() == Some(value) { ", where that begins" } else { "" };
                remarks.push(Remark(format!(
                    "{name} has no value: beside its range {name} = {value}{begins}"
                )));
            }
        }
        (case, remarks)
    }

    /// Refuses what the file calls `fixed`.
    pub(crate) fn check_varied(&self, name: &str) -> Result<(), Error> {
        let name = canonical_name(name.trim());
        if !self.problem_file().fixed.contains(&name) {
            return Ok(());
        }
        let message = format!("{name:?} cannot be varied: it is fixed in {}", self.origin());
        Err(Refused::usage("unknown-parameter", message, "--set changes it").into())
    }

    /// A refusal in words.
    pub(crate) fn reason(&self, refusal: &Refusal) -> String {
        match refusal {
            Refusal::Term { term, why } => {
                let text = term.print(&self.problem().small, Style::Text);
                format!("{} {why}", text.chars().take(80).collect::<String>())
            }
            other => other.to_string(),
        }
    }

    /// The place of a term as it occurs multiplied out, without its factors eps and -1, or of what
    /// it is a product of: `:line:column`, or nothing.
    fn place(&self, term: &Expression) -> String {
        let plain = |e: &Expression| matches!(e, Expression::Small | Expression::Number(_));
        let bare: Vec<Expression> = term.factors().iter().filter(|e| !plain(e)).cloned().collect();
        let varying: Vec<Expression> = bare.iter().filter(|e| !e.is_constant()).cloned().collect();
        let product = |list: Vec<Expression>| Expression::Product(list).canonical();
        let tries = [term.clone(), product(bare), product(varying.clone())];
        let file = self.problem_file();
        let place = tries.iter().chain(&varying).find_map(|part| file.locate(part));
        place.map_or(String::new(), |(line, column)| format!(":{line}:{column}"))
    }

    /// A refusal of the form with the place of its term.
    pub(crate) fn unfit(&self, refusal: Refusal) -> Error {
        let text = self.reason(&refusal);
        let place = refusal.term().map_or(String::new(), |term| self.place(term));
        let message = format!("{}{place}: {text}", self.origin());
        let small = &self.problem().small;
        let (kind, code, mut hint) = refusal.parts();
        if let Refusal::MissingValues { names } = &refusal {
            let follows = &self.problem_file().follows;
            if let Some((name, how)) = names.iter().find_map(|name| follows.get_key_value(name)) {
                hint = format!("{name} follows: {how}; {}", FOLLOWS.replace("NAME", name));
            }
        } else if code == "no-method"
            && !matches!(refusal, Refusal::NoStiffness { .. })
            && !self.problem().equation.contains(&Expression::Small)
        {
            // Without it every term is one of order zero.
            hint = format!("a factor {small}, or orders = {{ NAME = 1 }}, marks the small terms");
        }
        Refused { code, kind, message, hint }.into()
    }
}
