//! The pieces of a formula as they are set: letters, numbers, signs, fractions.

use super::tokens::{Kind, SIGNS};
use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;

/// A part of a formula as it is set.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub latex: String,
    pub kind: Kind,
    /// How many marks wide it is, about.
    pub width: usize,
    /// Whether brackets around it must grow.
    pub tall: bool,
    /// What stands between round brackets, if it is such a pair.
    pub inside: Option<String>,
}

const FUNCTIONS: [&str; 8] = ["cos", "sin", "tan", "cosh", "sinh", "tanh", "exp", "ln"];

/// Small changes of a letter, and delayed quantities: a letter with its index.
const PERTURBED: [&str; 6] = ["dC", "dD", "dT", "dphi", "dtau", "dx"];
const DELAYED: [&str; 2] = ["xT", "zT"];

/// Fractions with longer parts are written with a slash.
pub(super) const LONG: usize = 26;

pub(super) fn joined(pieces: &[Piece]) -> String {
    pieces.iter().map(|piece| piece.latex.as_str()).collect()
}

pub(super) fn width(pieces: &[Piece]) -> usize {
    pieces.iter().map(|piece| piece.width).sum()
}

impl Piece {
    pub fn new(latex: impl Into<String>, kind: Kind, width: usize) -> Self {
        Self { latex: latex.into(), kind, width, tall: false, inside: None }
    }

    /// Whether it can be divided: neither sign nor space.
    pub fn is_factor(&self) -> bool {
        !matches!(self.kind, Kind::Sign | Kind::Space)
    }
}

pub(super) fn sign(text: &str) -> Piece {
    let known = SIGNS.iter().find(|(sign, _)| *sign == text);
    Piece::new(known.map_or(text, |(_, latex)| latex), Kind::Sign, 1)
}

pub(super) fn number(text: &str) -> Piece {
    let latex = match text.split_once('e') {
        Some((digits, power)) => format!(r"{digits}\cdot 10^{{{}}}", power.trim_start_matches('+')),
        None => text.to_owned(),
    };
    Piece::new(latex, Kind::Number, text.len())
}

/// The letter of a name without index, as the equations print it.
fn letter(word: &str) -> Option<String> {
    // O1, O2, ... are the names of orbits.
    if word == "O" {
        return None;
    }
    let printed = Expression::parameter(word).print("", Style::Latex);
    match printed.strip_prefix('\\') {
        Some(name) => (!name.starts_with("mathrm")).then(|| format!("{printed} ")),
        None => (word.len() == 1).then_some(printed),
    }
}

/// A word with its own index; `divides` tells that a slash stands beside it: then dx is a differential.
pub(super) fn word(text: &str, divides: bool) -> (Piece, String) {
    let upright = |latex: String| (Piece::new(latex, Kind::Upright, text.len()), String::new());
    let italic = |latex: String, index: &str| {
        (Piece::new(latex, Kind::Word, 1 + index.len()), index.to_owned())
    };
    if FUNCTIONS.contains(&text) {
        return upright(format!("\\{text} "));
    }
    let base = text.trim_end_matches(|c: char| c.is_ascii_digit());
    if let Some(base_letter) = letter(base) {
        return italic(base_letter, &text[base.len()..]);
    }
    if DELAYED.contains(&text) {
        return italic(text[..1].to_owned(), &text[1..]);
    }
    match text.strip_prefix('d').and_then(letter) {
        Some(of) if PERTURBED.contains(&text) && !divides => italic(format!(r"\delta {of}"), ""),
        Some(of) => italic(format!("d{of}"), ""),
        // A short word in a formula is a product (2kx).
        None if text.len() == 2 && base.len() == 2 => italic(text.to_owned(), ""),
        None if ["sech", "csch", "sgn"].contains(&text) => {
            upright(format!(r"\operatorname{{{text}}}"))
        }
        None => upright(format!(r"\text{{{text}}}")),
    }
}

/// A fraction of the last factor, or a quotient with a slash where a part is long.
pub(super) fn divide(pieces: &mut Vec<Piece>, below: &[Piece]) {
    let mut from = pieces.len().saturating_sub(1);
    let is_group = |n: usize| pieces.get(n).is_some_and(|piece| piece.inside.is_some());
    if is_group(from) && from > 0 && pieces[from - 1].is_factor() {
        // What stands directly before a bracket is applied to it: z(t)/gamma.
        from -= 1;
    } else {
        from = numerator(pieces, from);
    }
    let above = pieces.split_off(from);
    if width(&above) > LONG || width(below) > LONG || below.is_empty() {
        pieces.extend(above);
        pieces.push(sign("/"));
        pieces.extend_from_slice(below);
        return;
    }
    let bare = |part: &[Piece]| match part {
        [Piece { inside: Some(inside), .. }] => inside.clone(),
        part => joined(part),
    };
    let latex = format!(r"\frac{{{}}}{{{}}}", bare(&above), bare(below));
    let fraction = Piece::new(latex, Kind::Tall, width(&above).max(width(below)));
    pieces.push(Piece { tall: true, ..fraction });
}

/// Where a numerator begins that takes in the letters and numbers before its last factor: 2 pi k/omega.
fn numerator(pieces: &[Piece], last: usize) -> usize {
    let is_plain = |n: usize| matches!(pieces[n].kind, Kind::Word | Kind::Number);
    let mut from = last;
    // 2a/b.
    if from > 0 && pieces[from - 1].kind == Kind::Number {
        from -= 1;
    }
    while from >= 2 && pieces[from - 1].kind == Kind::Space && is_plain(from - 2) {
        from -= 2;
    }
    // The argument of a function without brackets (cos 2 beta t/2) stays with it.
    let is_argument =
        from >= 2 && pieces[from - 1].kind == Kind::Space && pieces[from - 2].kind == Kind::Upright;
    if is_argument { last } else { from }
}
