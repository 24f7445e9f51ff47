//! The verdicts, and the one rule by which every printed statement gets its own.

use serde::Serialize;

/// What the comparison of a printed statement with the truth came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It holds as printed.
    Agrees,
    /// A slip of the pen (or one at each of two places), on which nothing in the paper rests.
    Misprint,
    /// It does not hold, and no slip of the pen explains it, or later statements rest on the error.
    Wrong,
    /// A number that follows from no formula, printed or corrected.
    #[serde(rename = "not reproducible")]
    NotReproducible,
}

impl Verdict {
    /// All verdicts, in the order of the summary.
    pub const ALL: [Self; 4] = [Self::Agrees, Self::Misprint, Self::Wrong, Self::NotReproducible];

    /// The verdict in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Misprint => "misprint",
            Self::Wrong => "wrong",
            Self::NotReproducible => "not reproducible",
        }
    }

    /// The rule by which it is given: the words of [`Findings`] at the head of every report.
    pub fn rule(self) -> &'static str {
        match self {
            Self::Agrees => {
                "it holds as printed, or in a reading of the print that is named first; a printed number holds when \
                 it is the true one, rounded or cut off at its last printed digit"
            }
            Self::Misprint => {
                "a slip of the pen, or of the scan that was read here: one factor, sign, symbol, exponent, bracket \
                 or digit (the last one of a number, too) changed, two symbols interchanged, or one term added or \
                 struck makes it hold, and nothing in the paper rests on the error; where there are such slips at \
                 two places, both are named or have a row each"
            }
            Self::Wrong => {
                "it does not hold, and no slip of the pen explains it, or later statements rest on the error"
            }
            Self::NotReproducible => "a number that follows from no formula, printed or corrected",
        }
    }

    /// The verdict as a name in a style sheet.
    pub(crate) fn class(self) -> &'static str {
        match self {
            Self::NotReproducible => "not-reproducible",
            other => other.name(),
        }
    }

    /// How bad it is, for the worst of several: 0 to 3.
    pub(crate) fn severity(self) -> u8 {
        match self {
            Self::Agrees => 0,
            Self::Misprint => 1,
            Self::NotReproducible => 2,
            Self::Wrong => 3,
        }
    }
}

/// What the comparison of a printed statement found.
///
/// The rules, in this order:
///
/// 1. It holds as printed, or in a reading that the print allows and that is named first, and no other statement of the paper rests on what was cut off: it agrees.
///    A printed number holds when it is the true one, rounded or cut off at its last printed digit
///    ([`Decimal::shows`](crate::Decimal::shows)).
/// 2. A slip of the pen: one change of one place (a factor, sign, symbol, exponent, bracket or
///    digit, two symbols interchanged, a term left out) makes it hold, and no other statement of
///    the paper holds only with the error: a misprint. Where two places of a formula have such a
///    slip, both are named, or each has a row of its own. One term with two changes in it, or a
///    change beside a term left out, is no slip. A number that is printed again with the same
///    digits is no slip of a digit.
/// 3. It is a number that no formula of the paper gives, neither as printed nor as derived here
///    nor through another quantity at that order: not reproducible.
/// 4. Everything else is wrong.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// The statement holds as printed.
    pub holds: bool,
    /// The one change that makes it hold.
    pub correction: Option<String>,
    /// Another statement of the paper holds only if this one is taken as printed, not with the
    /// true value.
    pub propagates: bool,
    /// For a number: whether some formula gives it.
    pub reproduced: Option<bool>,
}

impl Findings {
    /// A statement that holds or does not.
    pub fn holds(holds: bool) -> Self {
        Self { holds, ..Self::default() }
    }

    /// The verdict, by the rules above.
    pub fn verdict(&self) -> Verdict {
        if self.holds && !self.propagates {
            Verdict::Agrees
        } else if self.correction.is_some() && !self.propagates {
            Verdict::Misprint
        } else if self.reproduced == Some(false) {
            Verdict::NotReproducible
        } else {
            Verdict::Wrong
        }
    }
}
