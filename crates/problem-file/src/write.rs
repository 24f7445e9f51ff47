//! A problem as the text of a problem file.

use crate::file::{AMPLITUDES, ProblemFile};
use crate::names::PI;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Crossing, Expression, ParameterCard, Problem};
use std::collections::BTreeSet;

/// The file of a problem, which [`ProblemFile::parse`] reads back as an equal problem.
///
/// ```
/// use lindstedt_problem_file::{ProblemFile, write};
/// let file = ProblemFile::parse("name = 'a'\nequation = \"x'' + x + eps*x^3 = 0\"")?;
/// assert_eq!(ProblemFile::parse(&write(&file.problem))?.problem, file.problem);
/// # Ok::<(), lindstedt_problem_file::FileError>(())
/// ```
pub fn write(problem: &Problem) -> String {
    render(problem, None)
}

impl ProblemFile {
    /// The file with everything that it says; parameters with an order have the small parameter
    /// in the equation.
    pub fn to_text(&self) -> String {
        render(&self.problem, Some(self))
    }
}

fn render(problem: &Problem, file: Option<&ProblemFile>) -> String {
    let mut text = head(problem);
    if let Some(file) = file {
        text += &questions(file);
    }
    let declared = problem.parameters.iter().filter(|card| card.name != PI);
    let cards = declared.map(|card| declaration(card, file));
    let follow = undeclared(problem).into_iter().map(|name| determined(problem, file, &name));
    let table: String = cards.chain(follow).collect();
    if !problem.parameters.is_empty() || !table.is_empty() {
        text += "\n[parameters]\n";
    }
    text + &table + &file.map_or_else(String::new, initial) + &wall(problem)
}

/// `key = value`; for a list `key = [value, ...]`.
fn line(key: &str, value: &str) -> String {
    format!("{key} = {value}\n")
}

fn list<'a>(names: impl IntoIterator<Item = &'a String>) -> String {
    let quoted: Vec<String> = names.into_iter().map(|name| quoted(name)).collect();
    format!("[{}]", quoted.join(", "))
}

fn printed(problem: &Problem, e: &Expression) -> String {
    e.print_named(&problem.small, &problem.unknowns, Style::Text)
}

/// The equations and what is to be said about them.
fn head(problem: &Problem) -> String {
    let side = |e: &Expression| quoted(&format!("{} = 0", printed(problem, e)));
    let mut text = line("name", &quoted(&problem.name)) + &line("title", &quoted(&problem.title));
    let equations: Vec<String> = problem.equations().map(side).collect();
    text += &match &equations[..] {
        [single] => line("equation", single),
        several => line("equations", &format!("[{}]", several.join(", "))),
    };
    if let Some(equation) = &problem.time_domain {
        text += &line("time_domain", &side(equation));
    }
    text += &line("small", &quoted(&problem.small));
    let conditions: Vec<String> = problem.conditions.iter().map(|c| c.name().to_owned()).collect();
    let conditions = match &conditions[..] {
        [one] => quoted(one),
        several => list(several),
    };
    text += &line("condition", &conditions);
    if let Some((name, _)) = AMPLITUDES.iter().find(|(_, known)| *known == problem.amplitude) {
        text += &line("amplitude", &quoted(name));
    }
    let formal = formal_names(problem);
    if !formal.is_empty() {
        text += &line("formal", &list(&formal));
    }
    text + &line("notes", &quoted(&problem.notes)) + &line("source", &quoted(&problem.source))
}

/// What a file asks for.
fn questions(file: &ProblemFile) -> String {
    let range = |name: &String| match file.ranges.get(name) {
        Some(range) => format!("{name}={range}"),
        None => name.clone(),
    };
    let swept = file.swept.iter().map(range).collect();
    let asked = file.asked.iter().map(ToString::to_string).collect();
    let all = [("fixed", &file.fixed), ("swept", &swept), ("asked", &asked)];
    let some = all.into_iter().filter(|(_, names)| !names.is_empty());
    let unknown = file.unknown.iter().map(|name| line("unknown", &quoted(name)));
    unknown.chain(some.map(|(key, names)| line(key, &list(names)))).collect()
}

/// A parameter with its card.
fn declaration(card: &ParameterCard, file: Option<&ProblemFile>) -> String {
    let (value, meaning) = (quoted(&card.default), quoted(&card.meaning));
    let value = if card.default.is_empty() { String::new() } else { format!("value = {value}, ") };
    let unit = file.and_then(|f| f.units.get(&*card.name));
    let unit = unit.map_or(String::new(), |unit| format!("unit = {}, ", quoted(unit)));
    line(&card.name, &format!("{{ {value}{unit}meaning = {meaning} }}"))
}

/// A parameter that others determine.
fn determined(problem: &Problem, file: Option<&ProblemFile>, name: &str) -> String {
    // The delay of whole periods follows from its tie, also without a file.
    let tie = problem.synchronous.as_ref().filter(|tie| *tie.delay == *name);
    let tied = tie.map(|tie| format!("2*pi*{}/{}", tie.periods, tie.frequency));
    let value = || file.and_then(|f| f.determined().get(name));
    let how = tied.or_else(|| value().map(|value| printed(problem, value)));
    let how = how.map_or_else(String::new, |how| format!("follows = {} ", quoted(&how)));
    line(name, &format!("{{ {how}}}"))
}

fn initial(file: &ProblemFile) -> String {
    let mut text = String::new();
    if let Some([x, velocity]) = &file.initial {
        text += &(line("x", &quoted(x)) + &line("velocity", &quoted(velocity)));
    }
    if let Some((_, history)) = &file.history {
        text += &line("history", &quoted(history));
    }
    if text.is_empty() { text } else { format!("\n[initial]\n{text}") }
}

/// The wall, and the tie of a delay to the force.
fn wall(problem: &Problem) -> String {
    let mut text = String::new();
    if let Some(impact) = &problem.impact {
        let [position, restitution] =
            [&impact.position, &impact.restitution].map(|e| quoted(&printed(problem, e)));
        let crossing = match impact.crossing {
            Crossing::Rising => "rising",
            Crossing::Falling => "falling",
        };
        text += "\n[impact]\n";
        text += &(line("position", &position) + &line("crossing", &quoted(crossing)));
        text += &line("restitution", &restitution);
    }
    if let Some(tie) = &problem.synchronous {
        text += "\n[synchronous]\n";
        let names = [&tie.delay, &tie.periods, &tie.frequency].map(|name| quoted(name));
        let keys = ["delay", "periods", "frequency"];
        text.extend(keys.iter().zip(&names).map(|(key, name)| line(key, name)));
    }
    text
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn expressions(problem: &Problem) -> Vec<&Expression> {
    let impact = problem.impact.iter().flat_map(|i| [&i.position, &i.restitution]);
    problem.equations().chain(&problem.time_domain).chain(impact).collect()
}

fn formal_names(problem: &Problem) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for e in expressions(problem) {
        loop {
            let is_new =
                |e: &Expression| matches!(e, Expression::Formal(name, _) if !names.contains(name));
            let Some(Expression::Formal(name, _)) = e.find(&is_new).cloned() else { break };
            names.insert(name);
        }
    }
    names
}

/// Parameters of the equations that have no card: others determine them.
fn undeclared(problem: &Problem) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    for e in expressions(problem) {
        for name in e.parameters() {
            let known = problem.parameters.iter().any(|card| card.name == name);
            if !known && !list.contains(&name) {
                list.push(name);
            }
        }
    }
    list
}
