//! Names: Greek letters and their spellings, reserved words, what an equation may mention.

use lindstedt_equation::Function;
use std::collections::BTreeSet;

/// Greek letters with the one spelling they stand for.
const GREEK: [(&str, &str); 59] = [
    ("α", "alpha"),
    ("β", "beta"),
    ("γ", "gamma"),
    ("δ", "delta"),
    ("ε", "eps"),
    ("ϵ", "eps"),
    ("ζ", "zeta"),
    ("η", "eta"),
    ("θ", "theta"),
    ("ϑ", "theta"),
    ("ι", "iota"),
    ("κ", "kappa"),
    ("λ", "lambda"),
    ("μ", "mu"),
    ("µ", "mu"),
    ("ν", "nu"),
    ("ξ", "xi"),
    ("π", "pi"),
    ("ρ", "rho"),
    ("σ", "sigma"),
    ("ς", "sigma"),
    ("τ", "tau"),
    ("υ", "upsilon"),
    ("φ", "phi"),
    ("ϕ", "phi"),
    ("χ", "chi"),
    ("ψ", "psi"),
    ("ω", "omega"),
    ("ο", "omicron"),
    ("Α", "Alpha"),
    ("Β", "Beta"),
    ("Γ", "Gamma"),
    ("Δ", "Delta"),
    ("Ε", "Epsilon"),
    ("Ζ", "Zeta"),
    ("Η", "Eta"),
    ("Θ", "Theta"),
    ("Ι", "Iota"),
    ("Κ", "Kappa"),
    ("Λ", "Lambda"),
    ("Μ", "Mu"),
    ("Ν", "Nu"),
    ("Ξ", "Xi"),
    ("Ο", "Omicron"),
    ("Π", "Pi"),
    ("Ρ", "Rho"),
    ("Σ", "Sigma"),
    ("Τ", "Tau"),
    ("Υ", "Upsilon"),
    ("Φ", "Phi"),
    ("Χ", "Chi"),
    ("Ψ", "Psi"),
    ("Ω", "Omega"),
    ("Ω", "Omega"),
    ("∆", "Delta"),
    // Other spellings in ASCII.
    ("epsilon", "eps"),
    ("varepsilon", "eps"),
    ("vartheta", "theta"),
    ("varphi", "phi"),
];

/// Whether a character is a Greek letter of the list.
pub(crate) fn is_greek(c: char) -> bool {
    !c.is_ascii() && GREEK.iter().any(|(letter, _)| letter.starts_with(c))
}

/// The value of a subscript digit.
pub(crate) fn subscript(c: char) -> Option<char> {
    let digit = (c as u32).checked_sub('₀' as u32).filter(|d| *d < 10)?;
    char::from_digit(digit, 10)
}

/// The one spelling of a name: Greek letters in ASCII, `epsilon` and `varepsilon` as `eps`, `₀`
/// as `0`, also before an index: `ω_0` is `omega_0`, `epsilon1` is `eps1`.
///
/// ```
/// use lindstedt_problem_file::canonical_name;
/// assert_eq!(canonical_name("ε"), "eps");
/// assert_eq!(canonical_name("ω₀"), "omega0");
/// assert_eq!(canonical_name("epsilon_1"), "eps_1");
/// assert_eq!(canonical_name("R_r"), "R_r");
/// ```
pub fn canonical_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| subscript(c).unwrap_or(c)).collect();
    let part = |part: &str| {
        let stem = part.trim_end_matches(|c: char| c.is_ascii_digit());
        let known = GREEK.iter().find(|(spelling, _)| *spelling == stem);
        format!("{}{}", known.map_or(stem, |(_, one)| one), &part[stem.len()..])
    };
    plain.split('_').map(part).collect::<Vec<_>>().join("_")
}

/// The number pi: a name that every expression may mention, with that value and no other.
pub const PI: &str = "pi";

/// What a name in an equation may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Names {
    /// The small parameter.
    pub small: String,
    /// The parameters; any name that is not reserved if nothing.
    pub parameters: Option<BTreeSet<String>>,
    /// Formal functions F(z) = sum_n F_n z^n/n!.
    pub formal: BTreeSet<String>,
    /// The unknowns, by their numbers.
    pub unknowns: Vec<String>,
}

impl Names {
    /// Any name that is not reserved is a parameter; x is the unknown.
    pub fn any(small: &str) -> Self {
        let (formal, unknowns) = (BTreeSet::new(), vec!["x".to_owned()]);
        Self { small: canonical_name(small), parameters: None, formal, unknowns }
    }

    /// These parameters and no others.
    pub fn only<'a>(small: &str, parameters: impl IntoIterator<Item = &'a str>) -> Self {
        let parameters = Some(parameters.into_iter().map(canonical_name).collect());
        Self { parameters, ..Self::any(small) }
    }

    /// The declared name that is spelled most like this one, if one is near: of a name with one
    /// letter every other letter is as near.
    pub(crate) fn nearest(&self, name: &str) -> Option<String> {
        let known = self.parameters.iter().flatten().chain([&self.small]);
        let reserved = ["x", "t", "sin", "cos", "exp", "ln", "abs", "sign", "sqrt"];
        let all = known.map(String::as_str).chain(reserved);
        let length = |word: &str| word.chars().count();
        let limit = if length(name) > 5 { 2 } else { 1 };
        let long = all.filter(|k| length(k).min(length(name)) > 1);
        let close = |k: &str| (distance(k, name), k.to_owned());
        long.map(close).filter(|(d, _)| *d <= limit).min().map(|(_, k)| k)
    }
}

/// The number of insertions, deletions and replacements between two words.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().take(40).collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().take(40).enumerate() {
        let mut left = i + 1;
        let mut next = vec![left];
        for ((above_left, above), cb) in row.iter().zip(&row[1..]).zip(&b) {
            left = (above_left + usize::from(ca != *cb)).min(above + 1).min(left + 1);
            next.push(left);
        }
        row = next;
    }
    row.last().copied().unwrap_or(0)
}

/// Whether a parameter may have this name: a letter, then letters, digits and `_`, not reserved.
pub fn is_parameter_name(name: &str) -> bool {
    let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let reserved = ["x", "t", "pi", "taylor", "sqrt", "to"];
    letters
        && name.len() <= 40
        && name.starts_with(|c: char| c.is_ascii_alphabetic())
        && function(name).is_none()
        && !reserved.contains(&name)
        && foreign(name).is_none()
}

/// The elementary function of that name.
pub(crate) fn function(name: &str) -> Option<Function> {
    Some(match name {
        "ln" | "log" => Function::Ln,
        "exp" => Function::Exp,
        "sin" => Function::Sin,
        "cos" => Function::Cos,
        "abs" => Function::Abs,
        "sign" | "sgn" => Function::Sign,
        _ => return None,
    })
}

/// Functions that are not taken, with what to write instead.
pub(crate) fn foreign(name: &str) -> Option<&'static str> {
    Some(match name {
        "tan" => "sin(x)/cos(x), or taylor(tan(x), 9) for its Taylor polynomial",
        "tanh" => "taylor(tanh(x), 9) for its Taylor polynomial",
        "sinh" => "(exp(x) - exp(-x))/2, or taylor(sinh(x), 9) for its Taylor polynomial",
        "cosh" => "(exp(x) + exp(-x))/2, or taylor(cosh(x), 9) for its Taylor polynomial",
        "atan" | "arctan" => "taylor(atan(x), 9) for its Taylor polynomial",
        "cot" => "cos(x)/sin(x)",
        "sec" => "1/cos(x)",
        "csc" => "1/sin(x)",
        "log10" => "ln(x)/ln(10)",
        "log2" => "ln(x)/ln(2)",
        "cbrt" => "sign(x)*abs(x)^(1/3)",
        "asin" | "acos" | "arcsin" | "arccos" | "asinh" | "acosh" | "atanh" | "erf" | "gamma_"
        | "floor" | "ceil" | "heaviside" | "max" | "min" | "mod" | "diff" | "integrate" => {
            "+ - * / ^, sin, cos, exp, ln, abs, sign, sqrt"
        }
        _ => return None,
    })
}
