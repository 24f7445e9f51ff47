//! The tokens of a formula.

/// What a token is, and what a piece is for those beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A letter or a word: as a piece a letter with its indices.
    Word,
    /// A decimal number, with its exponent.
    Number,
    /// A sign, or several that belong together.
    Sign,
    /// A function or another upright word.
    Upright,
    /// Something in brackets.
    Group,
    /// The space between two factors.
    Space,
    /// A fraction, a root.
    Tall,
}

/// A token with its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token<'a> {
    pub kind: Kind,
    pub text: &'a str,
    /// Whether a space stands before it.
    pub spaced: bool,
}

/// Signs of several characters, and signs that LaTeX writes otherwise.
pub(super) const SIGNS: [(&str, &str); 16] = [
    ("...", r"\ldots "),
    ("->", r"\to "),
    ("<=", r"\le "),
    (">=", r"\ge "),
    ("!=", r"\ne "),
    ("+-", r"\pm "),
    ("-+", r"\mp "),
    ("{", r"\{"),
    ("}", r"\}"),
    ("%", r"\%"),
    ("&", r"\&"),
    ("#", r"\#"),
    ("^", r"\hat{\ }"),
    ("_", r"\_"),
    ("\\", r"\backslash "),
    ("\u{2014}", r"\text{\u{2014}}"),
];

/// Cuts a formula into tokens.
pub(super) fn tokens(line: &str) -> Vec<Token<'_>> {
    let (mut list, mut rest) = (Vec::new(), line);
    loop {
        let trimmed = rest.trim_start();
        let Some(first) = trimmed.chars().next() else { return list };
        let spaced = trimmed.len() < rest.len();
        let (kind, length) = match first {
            'a'..='z' | 'A'..='Z' => {
                let end = trimmed.find(|c: char| !c.is_ascii_alphanumeric());
                (Kind::Word, end.unwrap_or(trimmed.len()))
            }
            '0'..='9' => (Kind::Number, number_length(trimmed)),
            first => {
                let known = SIGNS.iter().find(|(sign, _)| trimmed.starts_with(sign));
                (Kind::Sign, known.map_or(first.len_utf8(), |(sign, _)| sign.len()))
            }
        };
        let (text, tail) = trimmed.split_at(length);
        list.push(Token { kind, text, spaced });
        rest = tail;
    }
}

/// The length of the decimal number at the beginning.
fn number_length(rest: &str) -> usize {
    let digits = |from: usize| rest.bytes().skip(from).take_while(u8::is_ascii_digit).count();
    let mut end = digits(0);
    if rest[end..].starts_with('.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if rest[end..].starts_with('e') {
        let sign = usize::from(rest[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        end += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    end
}
