//! The files of the report: the page, everything as JSON, rows and tables as CSV, the figures.

use super::{PageError, WIDTH, document, figures, json, standalone, table_of, write};
use crate::{Paper, Row, Section, Table, Trust};
use lindstedt_report::{Format, Table as Sheet, Text};

/// The file in which one begins to read.
pub const PAGE: &str = "report.html";

/// All files of the report with their names. `seconds` is what the work took.
///
/// # Errors
/// A figure that cannot be drawn; as [`json`].
pub fn files(paper: &Paper, seconds: f64) -> Result<Vec<(String, String)>, PageError> {
    let drawn = figures::draw(&paper.trust)?;
    let page = document(paper, Some(&drawn), true);
    let mut files = vec![
        (PAGE.to_owned(), standalone(&page, include_str!("style.css"))),
        ("report.txt".to_owned(), write(paper, Format::Text)),
        ("report.md".to_owned(), Format::Markdown.write_within(&page, WIDTH)),
        ("report.json".to_owned(), json(paper, seconds)?),
    ];
    for section in &paper.sections {
        files.push((rows_name(section), rows(section).csv()));
        let table = |table: &Table| (table_name(section, table), numeric(table_of(table)).csv());
        files.extend(section.tables.iter().map(table));
    }
    let sheets = [("region.csv", region(&paper.trust)), ("orders.csv", orders(&paper.trust))];
    let some = sheets.into_iter().filter(|(_, sheet)| !sheet.rows.is_empty());
    files.extend(some.map(|(name, sheet)| (name.to_owned(), sheet.csv())));
    files.extend(drawn.into_iter().map(|figure| (format!("{}.svg", figure.name), figure.svg)));
    Ok(files)
}

/// Cells that say in words that there is no number are empty: programs then read the column as numbers.
pub fn numeric(mut sheet: Sheet) -> Sheet {
    let nothing = ["none", "-"].map(Text::from);
    let cells = sheet.rows.iter_mut().flatten();
    cells.filter(|cell| nothing.contains(cell)).for_each(|cell| *cell = Text::default());
    sheet
}

/// The name of the file with the rows of a section.
pub(super) fn rows_name(section: &Section) -> String {
    format!("section{}.csv", section.number)
}

/// The name of the file with a table.
pub(super) fn table_name(section: &Section, table: &Table) -> String {
    format!("section{}-{}.csv", section.number, table.name)
}

fn rows(section: &Section) -> Sheet {
    let columns = ["label", "printed", "derived", "independent", "verdict", "evidence"];
    let cells = |row: &Row| {
        let (label, verdict) = (row.label.line(), row.verdict.name().into());
        let [printed, derived, independent, evidence] =
            [&row.printed, &row.derived, &row.independent, &row.evidence].map(|text| text.line());
        [label, printed, derived, independent, verdict, evidence]
    };
    section.rows.iter().fold(Sheet::new(columns), |sheet, row| sheet.row(cells(row)))
}

/// The planes of the gains, point by point.
fn region(trust: &Trust) -> Sheet {
    let word = |v: Option<lindstedt_impact::map::Verdict>| {
        v.map_or(String::new(), |v| format!("{v:?}").to_lowercase())
    };
    let mut sheet = Sheet::new(["rule", "A", "B", "predicted", "true"]);
    for found in trust.region.iter().flat_map(|region| &region.charts) {
        let plan = &found.chart.plan;
        for (n, point) in found.chart.points.iter().enumerate() {
            let a = plan.columns.value(n % plan.columns.count);
            let b = plan.rows.value(n / plan.columns.count);
            let (says, is) = (word(point.predicted), word(point.exact));
            let (a, b) = (format!("{a:.6}"), format!("{b:.6}"));
            sheet.rows.push([found.rule.to_owned(), a, b, says, is].map(Into::into).into());
        }
    }
    sheet
}

/// The errors by order.
fn orders(trust: &Trust) -> Sheet {
    let mut sheet = Sheet::new(["case", "delta", "order", "error", "error_in_u"]);
    for found in &trust.truncations {
        for (n, error) in found.errors.iter().enumerate() {
            let other = found.resummed.get(n).map_or(String::new(), |e| format!("{e:.3e}"));
            let (name, delta) = (found.name.clone(), found.delta.to_string());
            let cells = [name, delta, n.to_string(), format!("{error:.3e}"), other];
            sheet.rows.push(cells.map(Into::into).into());
        }
    }
    sheet
}
