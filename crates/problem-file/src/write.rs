//! A problem as the text of a problem file.

use crate::file::{AMPLITUDES, ProblemFile};
use crate::names::PI;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Crossing, Expression, Problem};
use std::collections::BTreeSet;
use std::fmt::Write;

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
    let mut text = String::new();
    let mut line = |key: &str, value: &str| {
        let _ = writeln!(text, "{key} = {}", quoted(value));
    };
    let side = |e: &Expression| format!("{} = 0", e.print(&problem.small, Style::Text));
    line("name", &problem.name);
    line("title", &problem.title);
    line("equation", &side(&problem.equation));
    if let Some(equation) = &problem.time_domain {
        line("time_domain", &side(equation));
    }
    line("small", &problem.small);
    let conditions: Vec<String> = problem.conditions.iter().map(|c| quoted(c.name())).collect();
    let conditions = match &conditions[..] {
        [one] => one.clone(),
        list => format!("[{}]", list.join(", ")),
    };
    let _ = writeln!(text, "condition = {conditions}");
    let role = AMPLITUDES.iter().find(|(_, known)| *known == problem.amplitude);
    if let Some((name, _)) = role {
        let _ = writeln!(text, "amplitude = {}", quoted(name));
    }
    let formal = formal_names(problem);
    if !formal.is_empty() {
        let list: Vec<String> = formal.iter().map(|name| quoted(name)).collect();
        let _ = writeln!(text, "formal = [{}]", list.join(", "));
    }
    let _ = writeln!(text, "notes = {}", quoted(&problem.notes));
    let _ = writeln!(text, "source = {}", quoted(&problem.source));
    for (key, list) in file
        .into_iter()
        .flat_map(|f| [("fixed", &f.fixed), ("swept", &f.swept), ("asked", &f.asked)])
    {
        if !list.is_empty() {
            let range = |name: &String| match file.and_then(|f| f.ranges.get(name)) {
                Some(range) if key == "swept" => quoted(&format!("{name}={range}")),
                _ => quoted(name),
            };
            let list: Vec<String> = list.iter().map(range).collect();
            let _ = writeln!(text, "{key} = [{}]", list.join(", "));
        }
    }
    let undeclared = undeclared(problem);
    if !problem.parameters.is_empty() || !undeclared.is_empty() {
        text.push_str("\n[parameters]\n");
    }
    for card in problem.parameters.iter().filter(|card| card.name != PI) {
        let (value, meaning) = (quoted(&card.default), quoted(&card.meaning));
        let value =
            if card.default.is_empty() { String::new() } else { format!("value = {value}, ") };
        let unit = file.and_then(|f| f.units.get(&*card.name));
        let unit = unit.map_or(String::new(), |unit| format!("unit = {}, ", quoted(unit)));
        let _ = writeln!(text, "{} = {{ {value}{unit}meaning = {meaning} }}", card.name);
    }
    for name in undeclared {
        // The delay of whole periods follows from its tie, also without a file.
        let tie = problem.synchronous.as_ref().filter(|tie| tie.delay == *name);
        let tied = tie.map(|tie| format!("2*pi*{}/{}", tie.periods, tie.frequency));
        let value = || file.and_then(|f| f.determined().get(&name));
        let printed = || value().map(|value| value.print(&problem.small, Style::Text));
        let how = tied.or_else(printed);
        let how = how.map_or_else(String::new, |how| format!("follows = {} ", quoted(&how)));
        let _ = writeln!(text, "{name} = {{ {how}}}");
    }
    let (initial, history) =
        file.map_or((None, None), |f| (f.initial.as_ref(), f.history.as_ref()));
    if initial.is_some() || history.is_some() {
        text.push_str("\n[initial]\n");
    }
    if let Some([x, velocity]) = initial {
        let _ = write!(text, "x = {}\nvelocity = {}\n", quoted(x), quoted(velocity));
    }
    if let Some((_, history)) = history {
        let _ = writeln!(text, "history = {}", quoted(history));
    }
    if let Some(impact) = &problem.impact {
        let print = |e: &Expression| quoted(&e.print(&problem.small, Style::Text));
        let crossing = match impact.crossing {
            Crossing::Rising => "rising",
            Crossing::Falling => "falling",
        };
        let _ = write!(
            text,
            "\n[impact]\nposition = {}\ncrossing = \"{crossing}\"\nrestitution = {}\n",
            print(&impact.position),
            print(&impact.restitution)
        );
    }
    if let Some(tie) = &problem.synchronous {
        let [delay, periods, frequency] =
            [&tie.delay, &tie.periods, &tie.frequency].map(|name| quoted(name));
        let _ = write!(
            text,
            "\n[synchronous]\ndelay = {delay}\nperiods = {periods}\nfrequency = {frequency}\n"
        );
    }
    text
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn expressions(problem: &Problem) -> Vec<&Expression> {
    let impact = problem.impact.iter().flat_map(|i| [&i.position, &i.restitution]);
    [&problem.equation].into_iter().chain(&problem.time_domain).chain(impact).collect()
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
