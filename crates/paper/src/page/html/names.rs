//! What the words of formulas stand for.

/// Names of letters.
const GREEK: [(&str, &str); 25] = [
    ("alpha", "\u{3b1}"),
    ("beta", "\u{3b2}"),
    ("gamma", "\u{3b3}"),
    ("delta", "\u{3b4}"),
    ("eps", "\u{3b5}"),
    ("eta", "\u{3b7}"),
    ("theta", "\u{3b8}"),
    ("kappa", "\u{3ba}"),
    ("lambda", "\u{3bb}"),
    ("mu", "\u{3bc}"),
    ("xi", "\u{3be}"),
    ("pi", "\u{3c0}"),
    ("rho", "\u{3c1}"),
    ("sigma", "\u{3c3}"),
    ("tau", "\u{3c4}"),
    ("phi", "\u{3c6}"),
    ("psi", "\u{3c8}"),
    ("omega", "\u{3c9}"),
    ("zeta", "\u{3b6}"),
    ("Gamma", "\u{393}"),
    ("Delta", "\u{394}"),
    ("Lambda", "\u{39b}"),
    ("Sigma", "\u{3a3}"),
    ("Omega", "\u{3a9}"),
    ("nu", "\u{3bd}"),
];

const FUNCTIONS: [&str; 12] =
    ["cos", "sin", "tan", "cosh", "sinh", "tanh", "sech", "csch", "exp", "ln", "sgn", "sqrt"];

/// Perturbations and delayed quantities: a letter, then what it applies to or its index.
const PERTURBED: [&str; 6] = ["dC", "dD", "dT", "dphi", "dtau", "dx"];
const DELAYED: [&str; 2] = ["xT", "zT"];

/// A word of a formula.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Name<'a> {
    /// A letter with an index or none.
    Letter { letter: &'a str, index: &'a str },
    /// A small change of a letter.
    Change(&'a str),
    /// A function or an operator, upright.
    Function(&'a str),
}

fn greek(word: &str) -> Option<&'static str> {
    GREEK.iter().find(|(name, _)| *name == word).map(|(_, letter)| *letter)
}

/// The letter of a name without index.
fn letter(word: &str) -> Option<&str> {
    // O1, O2, ... are the names of orbits.
    let single = word.len() == 1 && word != "O";
    greek(word).or_else(|| single.then_some(word))
}

/// What a word means in a formula; nothing for words of the text.
pub fn name(word: &str) -> Option<Name<'_>> {
    if FUNCTIONS.contains(&word) {
        return Some(Name::Function(word));
    }
    if PERTURBED.contains(&word) {
        return letter(&word[1..]).map(Name::Change);
    }
    if DELAYED.contains(&word) {
        return Some(Name::Letter { letter: &word[..1], index: &word[1..] });
    }
    let base = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let index = &word[base.len()..];
    letter(base).map(|letter| Name::Letter { letter, index })
}

/// Words that are operators when something of a formula follows at once.
pub fn operator(word: &str) -> Option<&'static str> {
    match word {
        "sum" => Some("\u{2211}"),
        "int" => Some("\u{222b}"),
        _ => None,
    }
}
