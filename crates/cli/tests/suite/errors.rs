//! Every code of the table of errors, and more lines that are refused: the exit code, the code, one clear line with its hint,
//! and the line that the hint leads to, which has an answer.

use super::fuzz::refusal;
use crate::program::{command, root, words};
use std::collections::BTreeSet;
use std::process::Output;

fn run(line: &str, more: &[&str]) -> Output {
    let arguments = [&words(line)[..], &["--quiet"], more].concat();
    command(&arguments).current_dir(root()).output().unwrap()
}

/// The table of the lines: its head says what stands where.
const TABLE: &str = include_str!("errors.txt");

/// A line that is refused, and what is expected of the refusal.
struct Refused {
    exit: i32,
    code: &'static str,
    line: &'static str,
    /// Words of message and hint, words of the hint, the line it leads to.
    details: Vec<(&'static str, &'static str)>,
}

fn table() -> Vec<Refused> {
    let mut list: Vec<Refused> = Vec::new();
    for row in TABLE.lines().filter(|row| !row.starts_with(['#', '-'])) {
        let (head, rest) = row.split_once(": ").unwrap();
        match head.strip_prefix("    ") {
            Some(name) => list.last_mut().unwrap().details.push((name, rest)),
            None => {
                let (exit, code) = head.split_once(' ').unwrap();
                let exit = exit.parse().unwrap();
                list.push(Refused { exit, code, line: rest, details: Vec::new() });
            }
        }
    }
    list
}

impl Refused {
    /// What is wrong with the refusal.
    fn defects(&self) -> Vec<String> {
        let output = run(self.line, &["--format", "json"]);
        let Some((code, message, hint)) = refusal(&String::from_utf8_lossy(&output.stdout)) else {
            return vec![format!("no refusal, exit {:?}", output.status.code())];
        };
        let mut wrong = Vec::new();
        if (output.status.code(), &*code) != (Some(self.exit), self.code) || hint.is_empty() {
            wrong.push(format!("{code}, exit {:?}: {message} ({hint})", output.status.code()));
        }
        for (name, expected) in &self.details {
            let holds = match *name {
                "says" => format!("{message} ({hint})").contains(expected),
                "lacks" => !hint.contains(expected),
                "hint" => hint.contains(expected),
                "next" => run(expected, &[]).status.success(),
                _ => false,
            };
            wrong.extend((!holds).then(|| format!("{name} {expected}: {message} ({hint})")));
        }
        wrong
    }

    /// Where nothing but the refusal is expected: nothing is printed, and one line is said.
    fn is_one_line(&self) -> bool {
        let output = run(self.line, &[]);
        let said = String::from_utf8_lossy(&output.stderr);
        output.stdout.is_empty()
            && output.status.code() == Some(self.exit)
            && said.lines().count() == 1
            && said.len() < 300
            && !said.contains("panicked")
    }
}

#[test]
fn every_error_leads_on() {
    let mut wrong = Vec::new();
    for refused in table() {
        wrong.extend(refused.defects().iter().map(|what| format!("{}: {what}", refused.line)));
        let alone = refused.details.iter().all(|(name, _)| *name == "says");
        if alone && !refused.is_one_line() {
            wrong.push(format!("{}: more than one line, or none", refused.line));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A code of the book stands in the table above, or where it is tested is said.
#[test]
fn every_code_of_the_book_is_met() {
    let page = std::fs::read_to_string(root().join("docs/src/reference/errors.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let codes: BTreeSet<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    let elsewhere = TABLE.lines().filter_map(|row| row.strip_prefix("- ")?.split(": ").next());
    let met: BTreeSet<&str> = table().iter().map(|row| row.code).chain(elsewhere).collect();
    let missing: Vec<&&str> = codes.symmetric_difference(&met).collect();
    assert!(codes.len() > 50 && missing.is_empty(), "{missing:?}");
}
