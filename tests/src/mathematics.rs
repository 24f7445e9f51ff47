//! The mathematics of the book as MathML, which browsers draw without scripts, fonts or network.
//!
//! TeX stands between `$` or `$$`; code is left alone. A formula that is not understood is an
//! error, so the ordinary tests find it, whether or not the book is built.

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
    let mut text = lindstedt_report::mathml(&tex, display).map_err(|error| error.to_string())?;
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

#[cfg(test)]
mod tests {
    use super::render;

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
    fn what_cannot_be_drawn_is_an_error() {
        assert!(render("$\\nosuchcommand{x}$").is_err());
        assert!(render("$\\frac{1}{2$").is_err());
        assert!(render("costs 5$\n\nmore").is_err());
    }
}
