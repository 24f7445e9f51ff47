//! The body of an HTML page, and a page that needs nothing else.

use super::{Format, Writer, steers};
use crate::{Block, Document, Formula, Part, mathml};

/// HTML.
pub(super) struct Html;

/// Words as data.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '"' => text.push_str("&quot;"),
            c if steers(c) && c != '\n' => text.push('\u{fffd}'),
            c => text.push(c),
        }
    }
    text
}

/// A formula as MathML; one that is not understood stands as it was printed, never half drawn.
fn drawn(formula: &Formula, display: bool) -> String {
    // Few fonts have a glyph for the invisible application of a function.
    mathml(&formula.latex, display)
        .map(|math| math.replace("<mo>\u{2061}</mo>", ""))
        .unwrap_or_else(|_| format!("<code>{}</code>", escaped(&formula.text)))
}

/// A number with the signs of print: 6e-13 as a product with a power of ten.
fn number(digits: &str) -> String {
    let minus = |text: &str| text.replacen('-', "\u{2212}", 1);
    match digits.split_once('e') {
        Some((digits, power)) => {
            let power = minus(power.trim_start_matches('+'));
            format!("{}\u{b7}10<sup>{power}</sup>", minus(digits))
        }
        None => minus(digits),
    }
}

/// A word, as a number where it is one between brackets and marks.
fn word(word: &str) -> String {
    let core = word.trim_start_matches('(').trim_end_matches([',', '.', ';', ':', ')']);
    let unsigned = core.trim_start_matches(['+', '-']);
    let is_number =
        unsigned.starts_with(|c: char| c.is_ascii_digit()) && core.parse::<f64>().is_ok();
    match word.split_once(core) {
        Some((before, after)) if is_number => format!("{before}{}{after}", number(core)),
        _ => escaped(word),
    }
}

/// The signs before which a line may be broken.
const BREAKS: [&str; 11] = [
    "=", "+", "\u{2212}", "&lt;", "&gt;", "\u{2264}", "\u{2265}", "\u{2260}", "\u{2192}", "\u{b1}",
    "\u{2213}",
];
/// A formula of so few characters (n = 3) stays on one line.
const SHORT: usize = 12;
/// A piece of more elements ends at the next space between factors.
const PIECE: usize = 24;

/// An inline formula in pieces, between which a line can be broken: before its relations and the signs
/// between its terms.
fn pieces(math: &str) -> String {
    let Some(body) = math.split_once('>').and_then(|(_, body)| body.strip_suffix("</math>")) else {
        return math.to_owned();
    };
    let visible: usize =
        body.split('<').filter_map(|part| Some(part.split_once('>')?.1.chars().count())).sum();
    let (mut text, mut depth, mut elements) = (String::from("<math>"), 0, 0);
    let mut rest = body;
    while let Some((content, tag)) = rest.find('>').map(|end| rest.split_at(end + 1)) {
        rest = tag;
        let sign = rest.split_once("</mo>").map_or("", |(sign, _)| sign);
        let at_sign = content == "<mo>" && BREAKS.contains(&sign);
        let at_space = content.starts_with("<mspace") && elements > PIECE;
        if depth == 0 && elements > 0 && visible > SHORT && (at_sign || at_space) {
            // The space between two pieces stands before the sign.
            text += "</math> <math>";
            text += if at_sign { "<mo form=\"infix\" lspace=\"0\">" } else { "" };
            elements = 0;
        } else {
            // Names of several letters are upright.
            let name = rest.split_once("</mi>").map_or("", |(name, _)| name);
            let upright = content == "<mi>" && name.chars().nth(1).is_some();
            text += if upright { "<mi class=\"f\">" } else { content };
        }
        match content.contains("</") {
            true => depth -= 1,
            false if content.ends_with("/>") => elements += 1,
            false => (depth, elements) = (depth + 1, elements + 1),
        }
    }
    text + "</math>"
}

/// The spans of a line; no line of the page begins with the full stop after a formula or ends with the
/// bracket before it.
pub(super) fn glued(spans: Vec<String>) -> String {
    const TOGETHER: &str = "<span class=\"g\">";
    let mut line = String::new();
    for span in spans {
        let rest = span.trim_start_matches([',', '.', ';', ':', ')', ']', '?']);
        let (mark, rest) = span.split_at(span.len() - rest.len());
        let formula = line.rfind("<math>").filter(|_| line.ends_with("</math>"));
        match formula.filter(|_| !mark.is_empty()) {
            Some(at) => {
                line.insert_str(at, TOGETHER);
                line += &format!("{mark}</span>");
            }
            None => line += mark,
        }
        match (rest.split_once("</math>"), line.ends_with(['(', '['])) {
            (Some((first, others)), true) if first.starts_with("<math>") => {
                line.insert_str(line.len() - 1, TOGETHER);
                line += &format!("{first}</math></span>{others}");
            }
            _ => line += rest,
        }
    }
    line
}

/// A part in its frame; its heading leads to itself, so that its address can be copied.
pub(super) fn part(part: &Part, title: &str, level: usize, inner: &str) -> String {
    let attribute = |name: &str, value: &str| match value {
        "" => String::new(),
        value => format!(" {name}=\"{}\"", escaped(value)),
    };
    let line = match &*part.name {
        "" => title.to_owned(),
        name => format!("<a href=\"#{}\">{title}</a>", escaped(name)),
    };
    let heading = if title.is_empty() { String::new() } else { Html.heading(&line, level) };
    let (name, class) = (attribute("id", &part.name), attribute("class", &part.class));
    format!("<section{name}{class}>\n{heading}{inner}</section>\n")
}

/// What is folded away under a word.
pub(super) fn folded(word: &str, open: bool, inner: &str) -> String {
    let open = if open { " open" } else { "" };
    format!("<details{open}>\n<summary>{}</summary>\n{inner}</details>\n", escaped(word))
}

/// The page as one HTML file that needs nothing else: no fonts, scripts or pictures from elsewhere. What
/// is folded away is opened for printing.
///
/// The style sheet finds each [`Part`] by its class; `g` is what stays on one line, `f` a name of several
/// letters in a formula, `scroll` the frame of a wide table or picture, `formula` one on its own line.
///
/// ```
/// use lindstedt_report::{Document, standalone};
/// let file = standalone(&Document::titled("Orbits"), "h1 { color: blue; }");
/// assert!(file.starts_with("<!DOCTYPE html>") && file.contains("<title>Orbits</title>"));
/// ```
#[must_use]
pub fn standalone(page: &Document, style: &str) -> String {
    let title = page.blocks.iter().find_map(|block| match block {
        Block::Heading(line) => Some(escaped(&Format::Text.line(line))),
        _ => None,
    });
    let (title, body) = (title.unwrap_or_default(), Format::Html.write(page));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{style}</style>\n</head>\n<body>\n{body}\
         <script>addEventListener('beforeprint',()=>{{\
         for(const d of document.querySelectorAll('details'))d.open=true}})</script>\n</body>\n</html>\n"
    )
}

fn cells(row: &[String], open: &str, close: &str) -> String {
    row.iter().map(|cell| format!("{open}{cell}{close}")).collect()
}

impl Writer for Html {
    fn words(&self, words: &str) -> String {
        words.split(' ').map(word).collect::<Vec<_>>().join(" ")
    }
    fn inline(&self, formula: &Formula) -> String {
        pieces(&drawn(formula, false))
    }
    fn verbatim(&self, code: &str) -> String {
        format!("<code>{}</code>", escaped(code))
    }
    fn strong(&self, words: &str, class: &str) -> String {
        format!("<strong class=\"{}\">{}</strong>", escaped(class), escaped(words))
    }
    fn link(&self, words: &str, to: &str) -> String {
        format!("<a href=\"{}\">{}</a>", escaped(to), escaped(words))
    }
    fn heading(&self, line: &str, level: usize) -> String {
        format!("<h{level}>{line}</h{level}>\n")
    }
    fn formula(&self, formula: &Formula) -> String {
        format!("<div class=\"formula\">{}</div>\n", drawn(formula, true))
    }
    fn lines(&self, list: &[(String, String)]) -> String {
        let item = |(name, value): &(String, String)| format!("<dt>{name}</dt><dd>{value}</dd>\n");
        format!("<dl>\n{}</dl>\n", list.iter().map(item).collect::<String>())
    }
    fn table(&self, columns: &[String], rows: &[Vec<String>]) -> String {
        let row = |row: &Vec<String>| format!("<tr>{}</tr>\n", cells(row, "<td>", "</td>"));
        let body: String = rows.iter().map(row).collect();
        let head = cells(columns, "<th scope=\"col\">", "</th>");
        format!(
            "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\
             </tbody>\n</table></div>\n"
        )
    }
    fn paragraph(&self, line: &str) -> String {
        format!("<p>{line}</p>\n")
    }
    fn code(&self, code: &str) -> String {
        format!("<pre>{}</pre>\n", escaped(code))
    }
    fn list(&self, items: &[String]) -> String {
        format!("<ul>\n{}</ul>\n", cells(items, "<li>", "</li>\n"))
    }
    fn picture(&self, name: &str, caption: &str, svg: &str) -> String {
        // The size comes from the style sheet; the view box keeps the shape.
        let svg =
            svg.find("<svg ").and_then(|at| svg.get(at + "<svg ".len()..)).unwrap_or_default();
        let name = escaped(name);
        format!(
            "<figure>\n<div class=\"scroll\" tabindex=\"0\"><svg role=\"img\" aria-labelledby=\"caption-{name}\" \
             {svg}</div>\n<figcaption id=\"caption-{name}\">{caption} <a href=\"{name}.svg\">SVG</a></figcaption>\n\
             </figure>\n"
        )
    }
}
