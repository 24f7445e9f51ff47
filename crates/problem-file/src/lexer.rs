//! From text to tokens.

use crate::error::{Limit, ParseError, ParseErrorKind};
use crate::names::{canonical_name, is_greek, subscript};
use rug::Rational;
use std::ops::Range;
use winnow::ascii::{digit0, digit1, multispace0};
use winnow::combinator::{alt, opt, repeat};
use winnow::prelude::*;
use winnow::stream::LocatingSlice;
use winnow::token::{any, one_of, take_while};

/// Bytes of an equation.
pub(crate) const LONGEST_EQUATION: usize = 10_000;
/// Digits of a number before its exponent, and the exponent of ten.
const MOST_DIGITS: usize = 300;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    Number(Rational),
    /// A name in its one spelling.
    Name(String),
    /// Primes, so many.
    Primes(usize),
    /// + - * / ^ ( ) [ ] | , =
    Sign(char),
    /// A superscript whole number.
    Superscript(Rational),
    End,
}

#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub kind: Kind,
    pub at: Range<usize>,
    /// Whether white space stands before it.
    pub spaced: bool,
}

/// What winnow recognises; numbers become exact afterwards, where they can be refused.
enum Raw<'a> {
    Number(&'a str),
    Name(&'a str),
    Dotted(usize),
    Primes(&'a str),
    Sign(char),
    Superscript(&'a str),
    Other(char),
}

type Input<'a> = LocatingSlice<&'a str>;

fn number<'a>(input: &mut Input<'a>) -> winnow::Result<Raw<'a>> {
    let fraction = (digit1, opt(('.', digit0))).void();
    let mantissa = alt((fraction, ('.', digit1).void()));
    let exponent = opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1));
    (mantissa, exponent).take().map(Raw::Number).parse_next(input)
}

/// A Latin word, or one Greek letter; then an index. `εx` is a product, `alpha` is a name.
fn name<'a>(input: &mut Input<'a>) -> winnow::Result<Raw<'a>> {
    let word = |c: char| c.is_ascii_alphanumeric();
    let index = || {
        let digits = take_while(1.., |c: char| c.is_ascii_digit() || subscript(c).is_some());
        let part = take_while(1.., move |c: char| word(c) || is_greek(c) || subscript(c).is_some());
        alt((('_', part).void(), digits.void()))
    };
    let latin = (one_of(|c: char| c.is_ascii_alphabetic()), take_while(0.., word)).void();
    let stem = alt((latin, one_of(is_greek).void()));
    (stem, repeat::<_, _, (), _, _>(0.., index())).take().map(Raw::Name).parse_next(input)
}

fn is_superscript(c: char) -> bool {
    superscript(c).is_some()
}

/// The value of a superscript digit.
fn superscript(c: char) -> Option<char> {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let value = digits.iter().position(|d| *d == c)?;
    char::from_digit(u32::try_from(value).ok()?, 10)
}

fn raw<'a>(input: &mut Input<'a>) -> winnow::Result<Raw<'a>> {
    let dots = alt(('ẋ'.value(Raw::Dotted(1)), 'ẍ'.value(Raw::Dotted(2))));
    let primes = take_while(1.., ['\'', '′', '″', '’']).map(Raw::Primes);
    let superscripts = take_while(1.., is_superscript).map(Raw::Superscript);
    let sign = alt((
        "**".value('^'),
        one_of(['·', '×', '⋅', '∗']).value('*'),
        one_of(['−', '–']).value('-'),
        one_of(['+', '-', '*', '/', '^', '(', ')', '[', ']', '|', ',', '=']),
    ));
    let other = any.map(Raw::Other);
    alt((number, dots, name, primes, superscripts, sign.map(Raw::Sign), other)).parse_next(input)
}

impl Clone for Raw<'_> {
    fn clone(&self) -> Self {
        match self {
            Self::Number(s) => Self::Number(s),
            Self::Name(s) => Self::Name(s),
            Self::Dotted(n) => Self::Dotted(*n),
            Self::Primes(s) => Self::Primes(s),
            Self::Sign(c) => Self::Sign(*c),
            Self::Superscript(s) => Self::Superscript(s),
            Self::Other(c) => Self::Other(*c),
        }
    }
}

/// The tokens of an equation, the last of them the end.
pub(crate) fn tokens(text: &str) -> Result<Vec<Token>, ParseError> {
    if text.len() > LONGEST_EQUATION {
        let kind = ParseErrorKind::TooLarge { what: Limit::Length, limit: LONGEST_EQUATION as u64 };
        return Err(ParseError::new(kind, LONGEST_EQUATION..text.len()));
    }
    let mut input = LocatingSlice::new(text);
    let mut list: Vec<Token> = Vec::new();
    let token = |input: &mut Input<'_>| -> winnow::Result<(usize, usize)> {
        let space = multispace0.span().parse_next(input)?;
        Ok((space.start, space.end))
    };
    loop {
        let (start, end) = token(&mut input).unwrap_or((text.len(), text.len()));
        let spaced = end > start;
        let recognised: winnow::Result<(Raw<'_>, Range<usize>)> =
            raw.with_span().parse_next(&mut input);
        let Ok((raw, at)) = recognised else {
            list.push(Token { kind: Kind::End, at: text.len()..text.len(), spaced });
            return Ok(list);
        };
        let kind = match raw {
            Raw::Number(digits) => Kind::Number(exact(digits).ok_or_else(|| {
                let kind =
                    ParseErrorKind::TooLarge { what: Limit::Digits, limit: MOST_DIGITS as u64 };
                ParseError::new(kind, at.clone())
            })?),
            Raw::Name(name) => Kind::Name(canonical_name(name)),
            Raw::Dotted(n) => {
                list.push(Token { kind: Kind::Name("x".into()), at: at.clone(), spaced });
                list.push(Token { kind: Kind::Primes(n), at, spaced: false });
                continue;
            }
            Raw::Primes(primes) => {
                Kind::Primes(primes.chars().map(|c| if c == '″' { 2 } else { 1 }).sum())
            }
            Raw::Sign(c) => Kind::Sign(c),
            Raw::Superscript(digits) => {
                let digits: String = digits.chars().filter_map(superscript).collect();
                let too_large = || {
                    let kind =
                        ParseErrorKind::TooLarge { what: Limit::Digits, limit: MOST_DIGITS as u64 };
                    ParseError::new(kind, at.clone())
                };
                Kind::Superscript(exact(&digits).ok_or_else(too_large)?)
            }
            Raw::Other(character) => {
                return Err(ParseError::new(ParseErrorKind::Character { character }, at));
            }
        };
        list.push(Token { kind, at, spaced });
    }
}

/// A decimal number with optional exponent of ten, exactly; nothing if it is too long.
fn exact(text: &str) -> Option<Rational> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let places = exponent.parse::<i64>().ok()?.checked_sub(i64::try_from(decimals).ok()?)?;
    let fits = mantissa.len() <= MOST_DIGITS && places.unsigned_abs() <= MOST_DIGITS as u64;
    fits.then(|| lindstedt_number::decimal(text))?
}
