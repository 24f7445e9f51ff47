//! Formulas as MathML, which browsers draw without scripts, fonts or network.

use pulldown_latex::config::DisplayMode;
use pulldown_latex::{Parser, RenderConfig, Storage, push_mathml};

/// Why a formula is not drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MathError {
    /// The formula is no LaTeX that is known here.
    #[error("{formula}: {reason}")]
    NotUnderstood {
        /// The formula.
        formula: String,
        /// What the parser says.
        reason: String,
    },
    /// The element that came out malformed.
    #[error("{formula}: {element} is malformed")]
    Malformed {
        /// The formula.
        formula: String,
        /// The element.
        element: String,
    },
}

/// One formula of LaTeX as a MathML element, on a line of its own if `display`.
///
/// # Errors
/// [`MathError`] where the formula is not understood or would come out malformed.
///
/// ```
/// let drawn = lindstedt_report::mathml(r"\frac{3}{8}", false);
/// assert!(drawn.is_ok_and(|math| math.contains("<mfrac>")));
/// assert!(lindstedt_report::mathml(r"\nosuchcommand{x}", false).is_err());
/// ```
pub fn mathml(latex: &str, display: bool) -> Result<String, MathError> {
    let not_understood =
        |reason: String| MathError::NotUnderstood { formula: latex.to_owned(), reason };
    let storage = Storage::new();
    let events: Result<Vec<_>, _> = Parser::new(latex, &storage).collect();
    let events = events.map_err(|error| not_understood(error.to_string()))?;
    let display_mode = if display { DisplayMode::Block } else { DisplayMode::Inline };
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut text = String::new();
    push_mathml(&mut text, events.into_iter().map(Ok::<_, std::fmt::Error>), config)
        .map_err(|error| not_understood(error.to_string()))?;
    let text = mended(&text);
    balanced(&text)
        .map_err(|element| MathError::Malformed { formula: latex.to_owned(), element })?;
    Ok(text)
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
pub fn balanced(text: &str) -> Result<(), String> {
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
