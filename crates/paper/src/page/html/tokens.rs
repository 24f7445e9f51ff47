//! The words, numbers and signs of a line.

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Letters and digits, beginning with a letter.
    Word,
    /// A decimal number, with its exponent.
    Number,
    /// Everything else: one sign, or several that belong together ("->", "<=", "...").
    Sign,
}

/// A token with its place.
#[derive(Clone, Debug)]
pub struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    /// Whether a space stands before it.
    pub spaced: bool,
}

impl Token<'_> {
    pub fn is(&self, sign: &str) -> bool {
        self.kind == Kind::Sign && self.text == sign
    }
}

const LONG_SIGNS: [&str; 8] = ["...", "->", "<=", ">=", "!=", "+-", "-+", "\u{2014}"];

/// Cuts a line into tokens.
pub fn tokens(line: &str) -> Vec<Token<'_>> {
    let mut list = Vec::new();
    let mut rest = line;
    let mut spaced = false;
    while let Some(first) = rest.chars().next() {
        if first.is_whitespace() {
            rest = &rest[first.len_utf8()..];
            spaced = true;
            continue;
        }
        let (kind, length) = next(rest, first);
        let (text, tail) = rest.split_at(length);
        list.push(Token { kind, text, spaced });
        rest = tail;
        spaced = false;
    }
    list
}

/// The kind and the length in bytes of the token at the beginning.
fn next(rest: &str, first: char) -> (Kind, usize) {
    if first.is_ascii_alphabetic() {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric());
        return (Kind::Word, end.unwrap_or(rest.len()));
    }
    if first.is_ascii_digit() {
        return (Kind::Number, number(rest));
    }
    let long = LONG_SIGNS.iter().find(|sign| rest.starts_with(**sign));
    (Kind::Sign, long.map_or(first.len_utf8(), |sign| sign.len()))
}

fn number(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let digits = |from: usize| bytes.iter().skip(from).take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if bytes.get(end) == Some(&b'e') {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}
