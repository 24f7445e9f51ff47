//! What a file says about the start, and about ranges of parameters.

use crate::error::{ParseError, ParseErrorKind};
use crate::file_error::{FileError, FileErrorKind};
use crate::grammar::parse_expression;
use crate::names::{Names, canonical_name};
use crate::reader::Reader;
use crate::schema::Initial;
use lindstedt_equation::Expression;
use lindstedt_number::Exact;
use std::collections::BTreeMap;
use toml::Spanned;

/// The motion before t = 0, which an equation with a delay needs.
#[derive(Clone, Debug, PartialEq)]
pub enum History {
    /// x(t) = x(0), x'(t) = 0.
    Constant,
    /// The motion through the start without delay (T = 0).
    FreeFlight,
    /// x(t), an expression in t and parameters; x'(t) is its derivative.
    Expression(Expression),
}

impl History {
    /// Reads `constant`, `free-flight`, or an expression in t.
    ///
    /// # Errors
    /// [`ParseError`] with the position in the text.
    ///
    /// ```
    /// use lindstedt_problem_file::{History, Names};
    /// let names = Names::only("eps", ["a"]);
    /// assert_eq!(History::parse("free-flight", &names), Ok(History::FreeFlight));
    /// assert!(matches!(History::parse("a*cos(t)", &names), Ok(History::Expression(_))));
    /// assert!(History::parse("x", &names).is_err());
    /// ```
    pub fn parse(text: &str, names: &Names) -> Result<Self, ParseError> {
        match text.trim() {
            "constant" => return Ok(Self::Constant),
            "free-flight" => return Ok(Self::FreeFlight),
            _ => {}
        }
        let expression = parse_expression(text, names)?;
        let is_state = |e: &Expression| matches!(e, Expression::Unknown(_));
        match expression.find(&is_state) {
            None => Ok(Self::Expression(expression)),
            Some(_) => Err(ParseError::new(ParseErrorKind::StateInHistory, 0..text.len())),
        }
    }
}

/// x(0) and x'(0), and the history.
type Start = (Option<[String; 2]>, Option<(History, String)>);

/// The table `[initial]`: x and velocity together, a history alone or with them.
pub(crate) fn start(
    reader: &Reader<'_>,
    initial: Option<&Initial>,
    names: &Names,
) -> Result<Start, FileError> {
    let Some(initial) = initial else { return Ok((None, None)) };
    let state = match (&initial.x, &initial.velocity) {
        (Some(x), Some(velocity)) => Some([reader.value(x)?, reader.value(velocity)?]),
        (None, None) if initial.history.is_some() => None,
        (Some(one), None) | (None, Some(one)) => {
            return Err(reader.error(FileErrorKind::HalfAStart, one.span().start));
        }
        (None, None) => return Ok((None, None)),
    };
    let read = |text: &Spanned<String>| {
        let history = History::parse(text.get_ref(), names);
        let history = history.map_err(|error| reader.inside(text, error))?;
        Ok((history, text.get_ref().clone()))
    };
    Ok((state, initial.history.as_ref().map(read).transpose()?))
}

/// The list `swept`: names, and the ranges of those that have one (`NAME=LO..HI:COUNT`).
pub(crate) fn ranges(list: &[Spanned<String>]) -> BTreeMap<String, String> {
    let range = |word: &Spanned<String>| {
        let (name, range) = word.get_ref().split_once('=')?;
        Some((canonical_name(name.trim()), range.trim().to_owned()))
    };
    list.iter().filter_map(range).collect()
}

/// Whether a text has the form LO..HI:COUNT.
pub(crate) fn is_range(text: &str) -> bool {
    let parts = text.split_once("..").and_then(|(low, rest)| {
        let (high, count) = rest.rsplit_once(':')?;
        Some((low, high, count.trim()))
    });
    let is_number = |text: &str| Exact::parse(text).is_ok();
    parts.is_some_and(|(low, high, count)| {
        is_number(low) && is_number(high) && count.parse::<u32>().is_ok_and(|n| n > 0)
    })
}
