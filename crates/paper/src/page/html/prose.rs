//! Lines of the report: which of their words are formulas, which are text.

use super::mathml::{escape, formula};
use super::names::{name, operator};
use super::tokens::{Kind, Token, tokens};

/// A line as HTML, its formulas as MathML.
pub fn line(text: &str) -> String {
    let list = tokens(text);
    let mut html = String::new();
    let mut at = 0;
    while at < list.len() {
        let end = run(&list, at);
        let (from, to) = trim(&list, at, end);
        if to <= from || !is_formula(&list[from..to], from == 0) {
            let next = end.max(at + 1);
            html += &plain(&list[at..next]);
            at = next;
            continue;
        }
        html += &plain(&list[at..from]);
        // No line begins with the full stop after a formula or ends with the bracket before it.
        let before = html.ends_with(['(', '[']).then(|| html.pop()).flatten();
        if list.get(from).is_some_and(|t| t.spaced && from > 0) {
            html.push(' ');
        }
        at = to;
        let mut after = String::new();
        while let Some(token) = list.get(at).filter(|t| !t.spaced && is_mark(t)) {
            after += token.text;
            at += 1;
        }
        html += &glued(before, formula(&list[from..to]), &after);
    }
    html
}

fn is_mark(token: &Token<'_>) -> bool {
    [",", ".", ";", ":", ")", "]", "?"].iter().any(|sign| token.is(sign))
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

fn opens(token: &Token<'_>) -> bool {
    ["(", "[", "{"].iter().any(|sign| token.is(sign))
}

fn closes(token: &Token<'_>) -> bool {
    [")", "]", "}"].iter().any(|sign| token.is(sign))
}

/// Whether a word belongs to a formula that has begun (`inside` brackets) or begins one.
fn is_math(list: &[Token<'_>], at: usize, depth: i32, begun: bool) -> bool {
    let Some(token) = list.get(at) else { return false };
    let follows = |sign: &str| list.get(at + 1).is_some_and(|t| !t.spaced && t.is(sign));
    match token.kind {
        Kind::Quote => false,
        Kind::Number | Kind::Sign => true,
        Kind::Word => {
            // "I" and hyphenated words are text; so is what stands beside a quotation mark.
            let hyphen = follows("-")
                && list
                    .get(at + 2)
                    .is_some_and(|t| t.kind == Kind::Word && !t.spaced && name(t.text).is_none());
            // 0.65 a very slight: the article.
            let after_number =
                at.checked_sub(1).and_then(|n| list.get(n)).is_some_and(|t| t.kind == Kind::Number);
            let before_word = list.get(at + 1).is_some_and(|t| {
                t.kind == Kind::Word && t.spaced && t.text.len() > 2 && name(t.text).is_none()
            });
            let article = token.text == "a" && token.spaced && after_number && before_word;
            (name(token.text).is_some() && !hyphen && !article && token.text != "I")
                || (operator(token.text).is_some() && (begun || follows("_")))
                || (depth > 0 && begun && token.text.len() <= 2 && !ENGLISH.contains(&token.text))
                || (begun && follows("_"))
                || (begun
                    && list.get(at.wrapping_sub(1)).is_some_and(|t| t.is("_") || t.is("/"))
                    && !token.spaced)
                || (begun && is_differential(token.text))
                || (follows("/") && is_differential(token.text))
        }
    }
}

const ENGLISH: [&str; 14] =
    ["of", "at", "by", "in", "is", "to", "as", "or", "it", "no", "on", "an", "be", "if"];

fn is_differential(word: &str) -> bool {
    word.strip_prefix('d').is_some_and(|rest| name(rest).is_some())
}

/// The end of the longest stretch that can be a formula.
fn run(list: &[Token<'_>], start: usize) -> usize {
    let (mut at, mut depth) = (start, 0);
    while let Some(token) = list.get(at) {
        if !is_math(list, at, depth, at > start) {
            break;
        }
        if token.kind == Kind::Sign {
            let ends = depth == 0 && [",", ";", ":", ".", "%", "?"].iter().any(|s| token.is(s));
            if ends || token.is(";") || !is_known(token.text) {
                break;
            }
        }
        depth += i32::from(opens(token)) - i32::from(closes(token));
        if depth < 0 {
            break;
        }
        at += 1;
    }
    at
}

fn is_known(sign: &str) -> bool {
    const SIGNS: [&str; 27] = [
        "+", "-", "*", "/", "^", "_", "=", "<", ">", "<=", ">=", "!=", "+-", "-+", "->", "...",
        "(", ")", "[", "]", "{", "}", "|", "'", ",", "!", ":",
    ];
    SIGNS.contains(&sign)
}

/// A line of so many tokens, all of which can be a formula, is one.
const WHOLE: usize = 12;

/// Without signs at the ends that belong to the text, and with brackets in pairs.
fn trim(list: &[Token<'_>], start: usize, end: usize) -> (usize, usize) {
    let (mut from, mut to) = (start, end);
    // A whole line with a forgotten bracket: shown as printed.
    if start == 0 && end == list.len() && end > WHOLE {
        return (start, end);
    }
    loop {
        let part = &list[from..to];
        let Some((first, last)) = part.first().zip(part.last()) else { return (from, to) };
        let balance = |part: &[Token<'_>]| {
            part.iter().map(|t| i32::from(opens(t)) - i32::from(closes(t))).sum::<i32>()
        };
        let dangling = ["+", "-", "*", "/", "^", "_", "=", "<", ">", "->", ",", ":", "+-", "-+"];
        let star =
            last.is("*") && part.len() > 1 && part[part.len() - 2].text == "v" && !last.spaced;
        let index =
            part.len() > 1 && part[part.len() - 2].is("_") && (last.is("+") || last.is("-"));
        let kept = star || index;
        if dangling.iter().any(|sign| last.is(sign)) && !kept || opens(last) {
            to -= 1;
        } else if balance(part) > 0 {
            // An open bracket of the text: the formula begins after it, or ends before it.
            let last_open = part.iter().rposition(opens).unwrap_or(0);
            if last_open == 0 { from += 1 } else { to = from + last_open }
        } else if ["*", "/", "^", "_", "=", ",", ">", "'", "!", "->"].iter().any(|s| first.is(s)) {
            from += 1;
        } else {
            return (from, to);
        }
    }
}

/// Numbers alone, and the article, are text.
fn is_formula(part: &[Token<'_>], first: bool) -> bool {
    let named = |t: &Token<'_>| t.kind == Kind::Word;
    if let [only] = part {
        return named(only) && only.text != "a" && !(first && only.text == "A");
    }
    part.iter().any(named)
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

/// Tokens as text, with a space before each that had one.
fn plain(list: &[Token<'_>]) -> String {
    let mut html = String::new();
    for (n, token) in list.iter().enumerate() {
        if token.spaced {
            html.push(' ');
        }
        let number_follows =
            list.get(n + 1).is_some_and(|next| next.kind == Kind::Number && !next.spaced);
        let alone = n == 0 || token.spaced;
        if token.kind == Kind::Quote {
            html += &format!("<code>{}</code>", escape(token.text.trim_matches('"')));
        } else if token.kind == Kind::Number {
            html += &number(token.text);
        } else if token.is("-") && number_follows && alone {
            html.push('\u{2212}');
        } else if token.is("+-") {
            html.push('\u{b1}');
        } else if token.is("-+") {
            html.push('\u{2213}');
        } else {
            html += &escape(token.text);
        }
    }
    html
}
