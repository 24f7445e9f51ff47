//! The report as one HTML page that needs nothing else: formulas as MathML, figures as inline SVG,
//! no fonts, scripts or pictures from elsewhere.

mod formula;
mod fraction;
mod mathml;
mod names;
mod node;
mod prose;
mod rows;
mod summary;
mod tokens;

use super::Figure;
use crate::{Paper, Section, Verdict};
use mathml::escape;
use std::fmt::Write;

const STYLE: &str = include_str!("style.css");

/// Evidence that is folded away is opened for printing.
const SCRIPT: &str = "addEventListener('beforeprint',()=>{\
    for(const d of document.querySelectorAll('details'))d.open=true})";

/// The page.
pub fn report(paper: &Paper, figures: &[Figure]) -> String {
    let mut body = String::new();
    body += &header(paper);
    body += &summary::trust(paper, figures);
    body += &summary::glance(paper);
    for section in &paper.sections {
        body += &section_text(section);
    }
    body += &footer();
    let title = "Asymptotic approaches, re-read by machine";
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <script>{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

fn header(paper: &Paper) -> String {
    let rows: usize = paper.sections.iter().map(|s| s.rows.len()).sum();
    let unfinished = if paper.complete {
        ""
    } else {
        "<p class=\"unfinished\">Unfinished: the work was stopped before its end.</p>\n"
    };
    format!(
        "<header>\n<p class=\"kind\">lindstedt {}</p>\n\
         <h1>Asymptotic approaches to strongly nonlinear and <span class=\"g\">non-smooth</span> systems, <span class=\"g\">re-read</span> by machine</h1>\n\
         <p class=\"lead\">{rows} statements of the paper by J. Awrejcewicz and I. V. Andrianov, <cite>Asymptotic approaches \
         to analysis of strongly non-linear and non-smooth systems</cite>: all of its formulas (1) to (51) and every number in its text. For each: what is printed, what is derived \
         from the equations, what another route says where there is one, and the verdict that \
         follows.</p>\n{unfinished}{}{}</header>\n",
        env!("CARGO_PKG_VERSION"),
        rules(),
        contents(paper)
    )
}

/// The one rule of the verdicts.
fn rules() -> String {
    let rule = |verdict: Verdict| {
        let (name, rule) = (verdict.name(), verdict.rule());
        let class = rows::class(name);
        format!("<dt><span class=\"verdict {class}\">{name}</span></dt><dd>{rule}</dd>\n")
    };
    format!("<dl class=\"rules\">\n{}</dl>\n", Verdict::ALL.map(rule).concat())
}

fn contents(paper: &Paper) -> String {
    let mut text = String::from(
        "<nav><a href=\"#trust\">Where to trust</a> <a href=\"#glance\">At a glance</a>",
    );
    for section in &paper.sections {
        let _ =
            write!(text, " <a href=\"#section-{}\">Section {}</a>", section.number, section.number);
    }
    text + " <a href=\"#notes\">Notes</a></nav>\n"
}

fn section_text(section: &Section) -> String {
    let mut text = format!(
        "<section id=\"section-{}\">\n<h2><span class=\"number\">Section {}</span> {}</h2>\n<p class=\"counts\">{}. \
         Data: <a href=\"section{}.csv\">CSV</a>, <a href=\"report.json\">JSON</a>.</p>\n",
        section.number,
        section.number,
        escape(section.title),
        super::summary(section),
        section.number
    );
    for row in &section.rows {
        text += &rows::row(section, row);
    }
    for table in &section.tables {
        text += &rows::table(section, table);
    }
    text + "</section>\n"
}

fn footer() -> String {
    let mut text = String::from("<section id=\"notes\">\n<h2>Notes</h2>\n");
    let _ = writeln!(
        text,
        "<p>The independent route shares nothing with the derivation; where it is a residual, it shares \
         the algebra of functions. {} Certified numbers carry an enclosure: what is shown is right to one unit of its last digit; \
         estimated ones come from floating point or from differences, and their error is measured, \
         not proved.</p>",
        super::CLASSES
    );
    text += "<dl class=\"rules\">\n";
    for (letters, meaning) in super::SYMBOLS {
        let (letters, meaning) = (prose::line(&letters.into()), prose::line(&meaning.into()));
        let _ = writeln!(text, "<dt>{letters}</dt><dd>{meaning}</dd>");
    }
    text += "</dl>\n";
    text += "<p>A formula is written as in the report's data: primes are derivatives, \
             <math><msub><mi>x</mi><mi>T</mi></msub></math> is <math><mi>x</mi></math> at \
             <math><mi>t</mi><mo>\u{2212}</mo><mi>T</mi></math>, <math><mi>\u{3b4}C</mi></math> a small \
             change of <math><mi>C</mi></math>. Beside this page lie the rows and tables as CSV, all of \
             it as JSON, the figures as SVG.</p>\n</section>\n";
    text
}

#[cfg(test)]
mod tests;
