//! Printed sums and printed decimals against the true ones.

use super::Findings;
use lindstedt::{Error, Exact};
use lindstedt_algebra::RationalAlgebra;
use lindstedt_number::ball::Ball;
use rug::ops::Pow;
use rug::{Integer, Rational};

/// A term of a printed sum: a rational factor times something with a name.
pub(super) struct Term<E> {
    pub factor: Rational,
    pub name: String,
    pub value: E,
}

impl<E> Term<E> {
    pub fn new(factor: impl Into<Rational>, name: &str, value: E) -> Self {
        Self { factor: factor.into(), name: name.to_owned(), value }
    }
}

/// A word of a vocabulary, times a factor.
pub(super) fn word<E: Clone>(words: &[Term<E>], factor: i32, name: &str) -> Result<Term<E>, Error> {
    let found = words.iter().find(|word| word.name == name).ok_or(Error::NoValue)?;
    Ok(Term::new(factor, name, found.value.clone()))
}

/// A ring in which "b is a rational multiple of a" can be read off.
pub(super) trait Ratio: RationalAlgebra {
    /// The rational factor of the first term of b relative to the same term of a.
    fn leading_ratio(&self, a: &Self::Element, b: &Self::Element) -> Option<Rational>;

    /// q with b = q a, if there is one.
    fn ratio(&self, a: &Self::Element, b: &Self::Element) -> Option<Rational> {
        let q = self.leading_ratio(a, b)?;
        (self.scale(a, &q) == *b).then_some(q)
    }
}

/// Compares a printed sum with the derived one, exactly, and looks for the one term that must
/// change, first its factor, then what stands beside it, then a term that is missing.
pub(super) fn compare_sums<R: Ratio>(
    ring: &R,
    printed: &[Term<R::Element>],
    derived: &R::Element,
    vocabulary: &[Term<R::Element>],
) -> Findings {
    let all_but = |skipped: Option<usize>| {
        let mut rest = derived.clone();
        for (_, term) in printed.iter().enumerate().filter(|(i, _)| Some(*i) != skipped) {
            let value = ring.scale(&term.value, &Rational::from(-&term.factor));
            ring.add_assign(&mut rest, &value);
        }
        rest
    };
    let missing = all_but(None);
    if ring.is_zero(&missing) {
        return Findings::holds(true);
    }
    let rests: Vec<_> = (0..printed.len()).map(|i| all_but(Some(i))).collect();
    let own = printed.iter().zip(&rests).find_map(|(term, rest)| {
        let q = ring.ratio(&term.value, rest)?;
        Some(format!("the factor of ${}$ is ${q}$, printed ${}$", term.name, term.factor))
    });
    let unneeded = || {
        let (term, _) = printed.iter().zip(&rests).find(|(_, rest)| ring.is_zero(rest))?;
        Some(format!("the term with ${}$ does not belong there", term.name))
    };
    let other = || {
        printed.iter().zip(&rests).find_map(|(term, rest)| {
            let (v, q) = vocabulary.iter().find_map(|v| Some((v, ring.ratio(&v.value, rest)?)))?;
            let printed = product(&term.factor, &term.name);
            Some(format!("${}$ in the place of ${printed}$", product(&q, &v.name)))
        })
    };
    let left_out = || {
        let (v, q) = vocabulary.iter().find_map(|v| Some((v, ring.ratio(&v.value, &missing)?)))?;
        Some(format!("the term ${}$ is missing", product(&q, &v.name)))
    };
    let correction = own.or_else(unneeded).or_else(left_out).or_else(other);
    Findings { correction, ..Findings::default() }
}

fn product(q: &Rational, name: &str) -> String {
    if *q == 1 {
        name.to_owned()
    } else if *q == -1 {
        format!("-{name}")
    } else {
        format!("{q} {name}")
    }
}

/// A positive number as printed: a decimal with a last place.
#[derive(Clone, Debug)]
pub struct Decimal {
    text: &'static str,
    value: Rational,
    places: u32,
}

impl Decimal {
    /// Reads a printed number; nothing if it is none.
    pub fn new(text: &'static str) -> Option<Self> {
        let value = Exact::parse(text).ok()?.as_rational()?.clone();
        let places = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
        Some(Self { text, value, places: u32::try_from(places).ok()? })
    }

    /// The printed number, exactly.
    pub fn value(&self) -> &Rational {
        &self.value
    }

    fn unit(&self) -> Rational {
        Rational::from((Integer::from(1), Integer::from(10).pow(self.places)))
    }

    /// Whether the printed decimals are the value, rounded or cut off.
    pub fn shows(&self, value: &Ball) -> bool {
        self.shows_as(value).is_some()
    }

    /// How the printed decimals are the value, if they are: "rounded" or "cut off".
    pub fn shows_as(&self, value: &Ball) -> Option<&'static str> {
        let (low, high) = (value.lower().to_rational()?, value.upper().to_rational()?);
        let half = self.unit() / 2u32;
        let below = Rational::from(&self.value - &half);
        let above = Rational::from(&self.value + &half);
        if low >= below && high <= above {
            return Some("rounded");
        }
        let next = Rational::from(&self.value + &self.unit());
        (low >= self.value && high < next).then_some("cut off")
    }

    /// The value rounded to as many decimals as are printed, when both ends of the ball round
    /// alike.
    pub fn correct(&self, value: &Ball) -> Option<String> {
        let round = |end: rug::Float| {
            let scaled = end.to_rational()? / self.unit();
            Some(Integer::from(scaled.round_ref()))
        };
        let rounded = round(value.lower()).filter(|r| Some(r) == round(value.upper()).as_ref())?;
        let places = usize::try_from(self.places).ok()?;
        let digits = format!("{:0>width$}", rounded.to_string(), width = places + 1);
        let (whole, fraction) = digits.split_at_checked(digits.len() - places)?;
        Some(if places == 0 { whole.to_owned() } else { format!("{whole}.{fraction}") })
    }

    /// Compares with the true value; the correction is a change of one digit.
    pub fn compare(&self, value: &Ball) -> Findings {
        let correct = self.correct(value).filter(|correct| {
            correct.len() == self.text.len()
                && correct.chars().zip(self.text.chars()).filter(|(a, b)| a != b).count() == 1
        });
        let correction = correct.map(|correct| {
            let last = correct.chars().last() != self.text.chars().last();
            let which = if last { ", wrong in its last digit" } else { "" };
            format!("{correct} is one digit away{which}")
        });
        Findings { holds: self.shows(value), correction, ..Findings::default() }
    }
}
