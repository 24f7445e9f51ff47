//! Marked text: where the formulas of a line are is said by who writes it, not guessed by who reads it.

use crate::page::latex;
use lindstedt_report::{Formula, Text as Line};
use serde::{Serialize, Serializer};
use std::borrow::Borrow;
use std::fmt;
use std::ops::Deref;

/// A line of the report with its formulas between dollar signs and literal print between backticks:
/// `"the period $T = 2 pi/omega$; the bracket closes after `*B`"`.
///
/// Everywhere but in [`Text::parts`] it is the plain line without the marks: that is what it
/// dereferences to, is compared by and is serialised as.
///
/// ```
/// use lindstedt_paper::{Part, Text};
/// let text = Text::from("exact period $T = 7.4164$");
/// assert_eq!(&*text, "exact period T = 7.4164");
/// assert!(text.parts().eq([Part::Words("exact period "), Part::Formula("T = 7.4164")]));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Text {
    marked: String,
    plain: String,
}

/// A part of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part<'a> {
    /// Plain words.
    Words(&'a str),
    /// A formula in the notation of the paper's linear print: `x'' + x^3/6 = eps sin t`.
    Formula(&'a str),
    /// Literal print, shown in quotation marks or in a fixed width.
    Code(&'a str),
}

/// The marks of formulas and of literal print.
const MARKS: [char; 2] = ['$', '`'];

impl Text {
    /// The parts in their order, none of them empty.
    pub fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        let mut rest = self.marked.as_str();
        std::iter::from_fn(move || {
            loop {
                let first = rest.chars().next()?;
                let inside = rest.strip_prefix(MARKS);
                let body = inside.unwrap_or(rest);
                let stop = |c: char| if inside.is_some() { c == first } else { MARKS.contains(&c) };
                let (part, tail) = body.split_at(body.find(stop).unwrap_or(body.len()));
                rest =
                    if inside.is_some() { tail.strip_prefix(first).unwrap_or(tail) } else { tail };
                if !part.is_empty() {
                    return Some(match (inside, first) {
                        (None, _) => Part::Words(part),
                        (_, '$') => Part::Formula(part),
                        _ => Part::Code(part),
                    });
                }
            }
        })
    }

    /// As a line of the page: literal print in quotation marks, formulas in both notations.
    pub fn line(&self) -> Line {
        self.parts().fold(Line::default(), |line, part| match part {
            Part::Words(words) => line.and(words),
            Part::Formula(text) => line.formula(Formula::new(text, latex(text))),
            Part::Code(code) => line.and("\"").code(code).and("\""),
        })
    }

    /// The line with its marks: what it is made from, to be part of another line.
    pub fn marked(&self) -> &str {
        &self.marked
    }
}

impl From<String> for Text {
    fn from(marked: String) -> Self {
        let mut text = Self { marked, plain: String::new() };
        let plain = |part: Part<'_>| match part {
            Part::Words(part) | Part::Formula(part) => part.to_owned(),
            Part::Code(part) => format!("\"{part}\""),
        };
        text.plain = text.parts().map(plain).collect();
        text
    }
}

impl From<&str> for Text {
    fn from(marked: &str) -> Self {
        marked.to_owned().into()
    }
}

impl Deref for Text {
    type Target = str;

    fn deref(&self) -> &str {
        &self.plain
    }
}

impl Borrow<str> for Text {
    fn borrow(&self) -> &str {
        self
    }
}

impl PartialEq for Text {
    fn eq(&self, other: &Self) -> bool {
        self.plain == other.plain
    }
}

impl Eq for Text {}

impl PartialEq<str> for Text {
    fn eq(&self, other: &str) -> bool {
        self.plain == other
    }
}

impl PartialEq<&str> for Text {
    fn eq(&self, other: &&str) -> bool {
        self.plain == *other
    }
}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self)
    }
}

impl Serialize for Text {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self)
    }
}

/// Marked lines from anything that is one.
pub(super) fn texts<T: Into<Text>>(list: impl IntoIterator<Item = T>) -> Vec<Text> {
    list.into_iter().map(Into::into).collect()
}
