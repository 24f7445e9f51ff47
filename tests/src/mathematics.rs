//! The mathematics of the book as MathML, which browsers draw without scripts, fonts or network.
//!
//! TeX stands between `$` or `$$`; code is left alone. A formula that is not understood is an
//! error, so the ordinary tests find it, whether or not the book is built.

use pulldown_latex::config::DisplayMode;
use pulldown_latex::{Parser, RenderConfig, Storage, push_mathml};
use serde_json::Value;
use std::error::Error;
use std::io::{Read, Write};

/// What mdBook asks of a preprocessor: reads `[context, book]`, writes the book with the formulas
/// of every `content` drawn.
///
/// # Errors
/// No such JSON, or as for [`render`].
pub fn preprocess(input: impl Read, output: impl Write) -> Result<(), Box<dyn Error>> {
    let (_, mut book): (Value, Value) = serde_json::from_reader(input)?;
    draw(&mut book)?;
    Ok(serde_json::to_writer(output, &book)?)
}

/// Every `content`, at any depth.
fn draw(value: &mut Value) -> Result<(), String> {
    match value {
        Value::Object(map) => {
            if let Some(Value::String(content)) = map.get_mut("content") {
                *content = render(content)?;
            }
            map.values_mut().try_for_each(draw)
        }
        Value::Array(list) => list.iter_mut().try_for_each(draw),
        _ => Ok(()),
    }
}

/// A page with its formulas as MathML.
///
/// # Errors
/// The formula that cannot be drawn, or the beginning of one that is not closed.
pub fn render(page: &str) -> Result<String, String> {
    let mut text = String::with_capacity(2 * page.len());
    let mut fenced = false;
    let mut paragraph = String::new();
    for line in page.split_inclusive('\n') {
        let fence = line.trim_start_matches(['>', ' ']).starts_with("```");
        if fence || fenced || line.trim().is_empty() {
            text.push_str(&render_paragraph(&paragraph)?);
            paragraph.clear();
            text.push_str(line);
            fenced ^= fence;
        } else {
            paragraph.push_str(line);
        }
    }
    text.push_str(&render_paragraph(&paragraph)?);
    Ok(text)
}

/// A paragraph: formulas do not reach beyond it.
fn render_paragraph(paragraph: &str) -> Result<String, String> {
    let mut text = String::new();
    let mut rest = paragraph;
    while let Some(start) = rest.find(['$', '`', '\\']) {
        let (before, here) = rest.split_at(start);
        text.push_str(before);
        let open = match here.as_bytes() {
            [b'$', b'$', ..] => "$$",
            [b'$', ..] => "$",
            [b'\\', ..] => {
                let end = here.char_indices().nth(2).map_or(here.len(), |(at, _)| at);
                text.push_str(&here[..end]);
                rest = &here[end..];
                continue;
            }
            _ => &here[..here.len() - here.trim_start_matches('`').len()],
        };
        let inner = &here[open.len()..];
        let end = inner.find(open).ok_or_else(|| format!("not closed: {here}"))?;
        if open.starts_with('`') {
            text.push_str(&here[..end + 2 * open.len()]);
        } else {
            text.push_str(&mathml(&inner[..end], open == "$$")?);
        }
        rest = &inner[end + open.len()..];
    }
    text.push_str(rest);
    Ok(text)
}

/// One formula. Characters that Markdown would read are written as entities.
fn mathml(tex: &str, display: bool) -> Result<String, String> {
    // In a quotation every line begins with its mark.
    let tex = tex.replace("\n> ", "\n");
    let storage = Storage::new();
    let events: Result<Vec<_>, _> = Parser::new(&tex, &storage).collect();
    let events = events.map_err(|error| format!("{tex}: {error}"))?;
    let display_mode = if display { DisplayMode::Block } else { DisplayMode::Inline };
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut text = String::new();
    let drawn = push_mathml(&mut text, events.into_iter().map(Ok::<_, std::fmt::Error>), config);
    drawn.map_err(|error| format!("{tex}: {error}"))?;
    text = mended(&text);
    balanced(&text).map_err(|element| format!("{tex}: {element} is malformed: {text}"))?;
    if display {
        // Wide formulas scroll on a narrow screen (docs/mathematics.css).
        text = format!("<span class=\"formula\">{text}</span>");
    }
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '*' | '_' | '[' | ']' | '\\' | '`' | '|' | '~' => {
                safe.push_str(&format!("&#{};", u32::from(c)));
            }
            '\n' => safe.push(' '),
            _ => safe.push(c),
        }
    }
    Ok(safe)
}

/// What the writer gets wrong: a missing blank between attributes, "less" not written as an entity, the
/// space before a function as the base of its exponent, a blank as a named entity. Primes become the
/// sign that every font has at the right height, with a mathematical table or without.
fn mended(text: &str) -> String {
    const SPACE: &str = "<mspace width=\"0.1667em\" />";
    const PRIME: &str = "<mi mathvariant=\"normal\">'</mi>";
    let text = text.replace("\"minsize", "\" minsize").replace("><</", ">&lt;</");
    let text = text.replace("&amp;nbsp;", "\u{a0}").replace("<mi>\u{2032}</mi>", PRIME);
    let mut mended = String::with_capacity(text.len());
    for (index, part) in text.split(SPACE).enumerate() {
        let open = mended
            .rfind('<')
            .filter(|&at| mended[at..].starts_with("<msu") && mended.ends_with('>'));
        match open {
            Some(at) if index > 0 => mended.insert_str(at, SPACE),
            _ if index > 0 => mended.push_str(SPACE),
            _ => {}
        }
        mended.push_str(part);
    }
    mended
}

/// Whether tags are closed in order and scripts and fractions have as many parts as they need; else the
/// element that does not.
fn balanced(text: &str) -> Result<(), String> {
    let mut open: Vec<(&str, usize)> = Vec::new();
    for tag in text.split('<').skip(1) {
        let inner = tag.split('>').next().unwrap_or_default();
        if let Some(name) = inner.strip_prefix('/') {
            let (opened, parts) = open.pop().unwrap_or_default();
            let needed = match name {
                "msup" | "msub" | "mfrac" | "munder" | "mover" | "mroot" => 2,
                "msubsup" | "munderover" => 3,
                _ => parts,
            };
            if opened != name || parts != needed {
                return Err(name.to_owned());
            }
        } else {
            if let Some((_, parts)) = open.last_mut() {
                *parts += 1;
            }
            if !inner.ends_with('/') {
                open.push((inner.split(' ').next().unwrap_or_default(), 0));
            }
        }
    }
    open.pop().map_or(Ok(()), |(name, _)| Err(name.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::{balanced, render};

    #[test]
    fn formulas_are_drawn_and_code_is_left() -> Result<(), String> {
        let page = render("a $x_1*y$ `$b` $$\\frac{1}{2}$$\n```sh\n$ c\n```\n")?;
        assert!(page.contains("<math") && page.contains("<mfrac>"), "{page}");
        assert!(page.contains("`$b`") && page.contains("\n```sh\n$ c\n```\n"), "{page}");
        assert!(!page.contains("x_1") && !page.contains('*'), "{page}");
        assert!(render("$a < b$")?.contains("&lt;</mo>"));
        Ok(())
    }

    #[test]
    fn malformed_elements_are_found() {
        assert!(balanced("<math><msup><mi>x</mi><mn>2</mn></msup></math>").is_ok());
        assert!(balanced("<math><msup><mi>x</mi></msup></math>").is_err());
        assert!(balanced("<math><mi>x</math>").is_err());
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(render("$\\nosuchcommand{x}$").is_err());
        assert!(render("$\\frac{1}{2$").is_err());
        assert!(render("costs 5$\n\nmore").is_err());
    }
}
