//! What stands above the sections: where the methods can be trusted, and all verdicts at a glance.

use super::super::Figure;
use super::prose::line;
use super::rows::{anchor, class};
use crate::trust::Finding;
use crate::{Paper, Row, Section, Verdict};
use std::fmt::Write;

/// The findings with their figures.
pub fn trust(paper: &Paper, figures: &[Figure]) -> String {
    let mut text = String::from(
        "<section id=\"trust\">\n<h2>Where the paper\u{2019}s methods can be trusted, and where not</h2>\n",
    );
    for finding in &paper.trust.findings {
        let _ = write!(
            text,
            "<article class=\"finding\" id=\"trust-{}\">\n<h3><a href=\"#section-{}\">Section {}</a> {}</h3>\n",
            finding.section,
            finding.section,
            finding.section,
            line(&finding.method)
        );
        text += &sides(finding);
        for figure in figures.iter().filter(|figure| figure.section == finding.section) {
            text += &picture(figure);
        }
        let _ = writeln!(
            text,
            "<p class=\"class\">{}.</p>\n</article>",
            capital(&line(&finding.class))
        );
    }
    text + "</section>\n"
}

fn sides(finding: &Finding) -> String {
    let mut text = String::from("<div class=\"sides\">\n");
    for (class, head, list) in [
        ("trusted", "To be trusted", &finding.trusted),
        ("not-trusted", "Not to be trusted", &finding.not_trusted),
    ] {
        let _ = write!(text, "<div class=\"{class}\"><h4>{head}</h4><ul>");
        for item in list {
            let _ = write!(text, "<li>{}</li>", line(item));
        }
        text += "</ul></div>\n";
    }
    text + "</div>\n"
}

fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |c| c.to_uppercase().collect::<String>() + rest.as_str())
}

/// A figure in the page, scaled to it.
fn picture(figure: &Figure) -> String {
    // The size comes from the style sheet; the view box keeps the shape.
    let svg = match figure.svg.find("<svg").and_then(|at| figure.svg.get(at..)) {
        Some(svg) => svg,
        None => figure.svg.as_str(),
    };
    let svg = svg.replacen("<svg ", "<svg role=\"img\" aria-labelledby=\"cap\" ", 1);
    let svg = svg.replacen("\"cap\"", &format!("\"caption-{}\"", figure.name), 1);
    format!(
        "<figure class=\"picture\">\n<div class=\"scroll\" tabindex=\"0\">{svg}</div>\n\
         <figcaption id=\"caption-{}\">{} <a href=\"{}.svg\">SVG</a></figcaption>\n</figure>\n",
        figure.name,
        line(&figure.caption),
        figure.name
    )
}

/// The numbers of the formulas that a label names.
pub fn numbers(label: &str) -> Vec<u32> {
    label
        .split('(')
        .skip(1)
        .filter_map(|part| part.split_once(')')?.0.parse().ok())
        .filter(|n| *n <= FORMULAS)
        .collect()
}

/// The paper has formulas (1) to (51).
pub const FORMULAS: u32 = 51;

/// The worst verdict of a formula with the row that has it.
fn worst(paper: &Paper, number: u32) -> Option<(&Section, &Row)> {
    let rows = paper.sections.iter().flat_map(|s| s.rows.iter().map(move |row| (s, row)));
    // "below (17)" is about the text, not the formula.
    let of_this = rows
        .filter(|(_, row)| numbers(&row.label).contains(&number) && !row.label.contains("below"));
    of_this.max_by(|a, b| {
        a.1.verdict.severity().cmp(&b.1.verdict.severity()).then(std::cmp::Ordering::Greater)
    })
}

/// All formulas with their verdicts, and the numbers of the text.
pub fn glance(paper: &Paper) -> String {
    let mut text = String::from(
        "<section id=\"glance\">\n<h2>The paper at a glance</h2>\n<p>Every formula with the worst verdict of \
         its parts; a number leads to its row.</p>\n<ol class=\"chips\">\n",
    );
    for number in 1..=FORMULAS {
        let Some((section, row)) = worst(paper, number) else { continue };
        let verdict = row.verdict.name();
        let _ = writeln!(
            text,
            "<li><a class=\"{}\" href=\"#{}\" title=\"({number}): {verdict}\">{number}</a></li>",
            class(verdict),
            anchor(section, row)
        );
    }
    text += "</ol>\n<div class=\"scroll\"><table class=\"count\">\n<thead><tr><th scope=\"col\">statements</th>";
    let verdicts = Verdict::ALL;
    for verdict in verdicts {
        let name = verdict.name();
        let _ = write!(
            text,
            "<th scope=\"col\"><span class=\"verdict {}\">{name}</span></th>",
            class(name)
        );
    }
    text += "<th scope=\"col\">all</th></tr></thead>\n<tbody>\n";
    for section in &paper.sections {
        let _ = write!(text, "<tr><th scope=\"row\">Section {}</th>", section.number);
        for verdict in verdicts {
            let _ = write!(text, "<td>{}</td>", section.count(verdict));
        }
        let _ = writeln!(text, "<td>{}</td></tr>", section.rows.len());
    }
    text + "</tbody>\n</table></div>\n</section>\n"
}
