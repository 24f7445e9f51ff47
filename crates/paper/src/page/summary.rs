//! What stands above the sections: where the methods can be trusted, and all verdicts at a glance.

use super::{figures::Drawing, stamp};
use crate::{Paper, Row, Section, Text, Verdict};
use lindstedt_report::{Block, Document, Table, Text as Line};

/// The findings with their figures.
pub(super) fn trust(paper: &Paper, figures: &[Drawing]) -> Document {
    let mut page = Document::default();
    for finding in &paper.trust.findings {
        let mut inner = Document::default();
        for (class, head, list) in [
            ("trusted", "To be trusted", &finding.trusted),
            ("not-trusted", "Not to be trusted", &finding.not_trusted),
        ] {
            let items = Document::default().list(list.iter().map(Text::line));
            inner = inner.part(("", class), head, items);
        }
        for figure in figures.iter().filter(|figure| figure.section == finding.section) {
            inner = inner.with(Block::Picture {
                name: figure.name.to_owned(),
                caption: figure.caption.line(),
                svg: figure.svg.clone(),
            });
        }
        let class = Line::words("Class: ").then(finding.class.line()).and(".");
        let title =
            Line::words(format!("Section {}: ", finding.section)).then(finding.method.line());
        let name = format!("trust-{}", finding.section);
        page = page.part((name, "finding"), title, inner.words(class));
    }
    page
}

/// Where a row stands on the page.
pub(super) fn anchor(section: &Section, row: &Row) -> String {
    let mut name = String::new();
    for c in row.label.chars() {
        match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' => name.push(c),
            '\'' => name.push_str("prime"),
            '+' => name.push_str("plus"),
            _ if name.ends_with('-') => {}
            _ => name.push('-'),
        }
    }
    format!("s{}-{}", section.number, name.trim_matches('-'))
}

/// The paper has formulas (1) to (51).
const FORMULAS: u32 = 51;

/// The numbers of the formulas that a label names.
pub fn numbers(label: &str) -> Vec<u32> {
    let number = |part: &str| part.split_once(')')?.0.parse().ok();
    label.split('(').skip(1).filter_map(number).filter(|n| *n <= FORMULAS).collect()
}

/// The worst verdict of a formula with the first row that has it.
fn worst(paper: &Paper, number: u32) -> Option<(&Section, &Row)> {
    let rows = paper.sections.iter().flat_map(|s| s.rows.iter().map(move |row| (s, row)));
    // "below (17)" is about the text, not the formula.
    let of_this = rows
        .filter(|(_, row)| numbers(&row.label).contains(&number) && !row.label.contains("below"));
    of_this.reduce(|a, b| if b.1.verdict.severity() > a.1.verdict.severity() { b } else { a })
}

/// All formulas with their verdicts, and how often each is given.
pub(super) fn glance(paper: &Paper, linked: bool) -> Document {
    let formulas = |verdict: Verdict| {
        let found = (1..=FORMULAS).filter_map(|number| Some((number, worst(paper, number)?)));
        let of_this = found.filter(|(_, (_, row))| row.verdict == verdict);
        of_this.fold(Line::default(), |line, (number, (section, row))| {
            let blank = if line.0.is_empty() { "" } else { " " };
            line.and(blank).link(format!("({number})"), format!("#{}", anchor(section, row)))
        })
    };
    let lines = Verdict::ALL.map(|verdict| (stamp(verdict), formulas(verdict)));
    let counts = |name: String, count: &dyn Fn(Verdict) -> usize| {
        let counts = Verdict::ALL.map(count);
        let all = counts.iter().sum();
        let cells = counts.into_iter().chain([all]).map(|count: usize| count.to_string());
        [name].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let columns = Verdict::ALL.map(stamp);
    let columns =
        [Line::words("statements")].into_iter().chain(columns).chain([Line::words("all")]);
    let table = paper.sections.iter().fold(Table::new(columns), |table, section| {
        table.row(counts(format!("Section {}", section.number), &|verdict| section.count(verdict)))
    });
    let leads = if linked { "; a number leads to its row" } else { "" };
    Document::default()
        .words(format!("Every formula under the worst verdict of its parts{leads}."))
        .lines(lines)
        .table(table)
}
