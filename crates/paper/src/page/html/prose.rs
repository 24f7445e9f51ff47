//! Marked lines as HTML: words as they are, formulas as MathML, print in a fixed width.

use super::mathml::{escape, formula};
use super::tokens::{Kind, Token, tokens};
use crate::{Part, Text};

/// A line as HTML. No line of the page begins with the full stop after a formula or ends with the
/// bracket before it.
pub fn line(text: &Text) -> String {
    let mut html = String::new();
    let mut parts = text.parts().peekable();
    while let Some(part) = parts.next() {
        match part {
            Part::Words(text) => html += &words(text),
            Part::Code(text) => html += &format!("<code>{}</code>", escape(text)),
            Part::Formula(text) => {
                let before = html.ends_with(['(', '[']).then(|| html.pop()).flatten();
                let mut after = "";
                if let Some(Part::Words(next)) = parts.peek_mut() {
                    let rest = next.trim_start_matches([',', '.', ';', ':', ')', ']', '?']);
                    (after, *next) = next.split_at(next.len() - rest.len());
                }
                html += &glued(before, formula(&tokens(text)), after);
            }
        }
    }
    html
}

/// The pieces of a formula, the outer ones held together with what stands beside them.
fn glued(before: Option<char>, mut pieces: Vec<String>, after: &str) -> String {
    if let (Some(before), Some(first)) = (before, pieces.first_mut()) {
        *first = format!("<span class=\"g\">{before}{first}</span>");
    }
    if let (false, Some(last)) = (after.is_empty(), pieces.last_mut()) {
        *last = format!("<span class=\"g\">{last}{after}</span>");
    }
    let html = pieces.join(" ");
    if visible(&html) <= SHORT { format!("<span class=\"g\">{html}</span>") } else { html }
}

/// A formula of so few marks (n = 3) stays on one line.
const SHORT: usize = 12;

/// The marks of a piece of HTML that are not part of its tags.
fn visible(html: &str) -> usize {
    html.split('<').filter_map(|part| Some(part.split_once('>')?.1.trim().chars().count())).sum()
}

/// A number of the text, 6e-13 as a product with a power of ten.
pub fn number(text: &str) -> String {
    let minus = |text: &str| text.replacen('-', "\u{2212}", 1);
    match text.split_once('e') {
        Some((digits, power)) => {
            format!("{}\u{b7}10<sup>{}</sup>", minus(digits), minus(power.trim_start_matches('+')))
        }
        None => minus(text),
    }
}

/// Words with the numbers among them.
fn words(text: &str) -> String {
    let list = tokens(text);
    let mut html = String::new();
    for (n, token) in list.iter().enumerate() {
        if token.spaced {
            html.push(' ');
        }
        let number_follows =
            list.get(n + 1).is_some_and(|next| next.kind == Kind::Number && !next.spaced);
        html += &word(token, number_follows && (n == 0 || token.spaced));
    }
    if text.ends_with(char::is_whitespace) {
        html.push(' ');
    }
    html
}

/// A word, number or sign of the text; a minus where it is a sign of a number.
fn word(token: &Token<'_>, is_sign: bool) -> String {
    match (token.kind, token.text) {
        (Kind::Number, text) => number(text),
        (_, "-") if is_sign => "\u{2212}".to_owned(),
        (_, "+-") => "\u{b1}".to_owned(),
        (_, "-+") => "\u{2213}".to_owned(),
        (_, text) => escape(text),
    }
}
