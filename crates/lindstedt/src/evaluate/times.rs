//! Times at which a motion is asked for.

use crate::refusal::Refused;
use crate::{Error, Exact};
use lindstedt_number::ball::Balls;
use rug::Rational;
use std::str::FromStr;

/// The most times of one table.
const MOST_TIMES: u32 = 100_000;
/// Points of a figure for which no times are given.
const POINTS: u32 = 129;

/// Times in equal steps, or one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Times {
    /// The first and the last; nothing where they follow from the motion: one period, ten turns of an
    /// averaged motion.
    pub range: Option<(Rational, Rational)>,
    /// How many.
    pub count: u32,
    /// Times that are none in equal steps, in increasing order.
    pub given: Vec<Rational>,
}

impl Default for Times {
    /// As many as a figure needs, over what the motion shows.
    fn default() -> Self {
        Self { range: None, count: POINTS, given: Vec::new() }
    }
}

fn usage(text: &str) -> Error {
    let shown: String = text.chars().take(60).collect();
    let hint = "--times LO..HI:COUNT, for example 0..10:101";
    Refused::usage("range", format!("cannot read the times {shown:?}"), hint).into()
}

/// The number, or the double next to a multiple of pi.
fn rational(text: &str) -> Result<Rational, Error> {
    let value = Exact::parse(text)?;
    let nearest = || value.ball(Balls::new(200)).midpoint().to_rational();
    value.as_rational().cloned().or_else(nearest).ok_or_else(|| usage(text))
}

impl FromStr for Times {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse(text)
    }
}

impl Times {
    /// Reads `LO..HI:COUNT`, both ends included, or `T1,T2,...`, increasing, or one time.
    ///
    /// # Errors
    /// [`Refused`] with the form that is expected, [`DerivationError::BadValue`](crate::DerivationError::BadValue).
    ///
    /// ```
    /// let times = lindstedt::evaluate::Times::parse("0..3:4")?;
    /// assert_eq!(times.list(0.0)[1].to_string(), "1");
    /// assert_eq!(lindstedt::evaluate::Times::parse("0,1/3,2")?.list(0.0)[1].to_string(), "1/3");
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, Error> {
        if text.contains(',') || Exact::parse(text).is_ok() {
            return Self::one_by_one(text);
        }
        let (low, rest) = text.split_once("..").ok_or_else(|| usage(text))?;
        let (high, count) = rest.rsplit_once(':').ok_or_else(|| usage(text))?;
        let count: u32 = count.trim().parse().map_err(|_| usage(text))?;
        if count == 0 || count > MOST_TIMES {
            let message = format!("1 to {MOST_TIMES} times, not {count}");
            return Err(Refused::usage("range", message, "").into());
        }
        Ok(Self { range: Some((rational(low)?, rational(high)?)), count, given: Vec::new() })
    }

    /// Reads `T1,T2,...`.
    fn one_by_one(text: &str) -> Result<Self, Error> {
        let parts = text.split(',').map(str::trim).filter(|part| !part.is_empty());
        let given: Vec<Rational> = parts.map(rational).collect::<Result<_, _>>()?;
        let (Some(first), Some(last)) = (given.first().cloned(), given.last().cloned()) else {
            return Err(usage(text));
        };
        if given.len() > MOST_TIMES as usize || !given.is_sorted_by(|a, b| a < b) {
            let message = format!("up to {MOST_TIMES} times in increasing order");
            return Err(Refused::usage("range", message, "--times 0,1/2,3").into());
        }
        let count = u32::try_from(given.len()).unwrap_or(MOST_TIMES);
        Ok(Self { range: Some((first, last)), count, given })
    }

    /// The times, from 0 to `last` where none were given.
    #[must_use]
    pub fn list(&self, last: f64) -> Vec<Exact> {
        if !self.given.is_empty() {
            return self.given.iter().cloned().map(Exact::Rational).collect();
        }
        let (low, high) = self
            .range
            .clone()
            .unwrap_or_else(|| (Rational::new(), Rational::from_f64(last).unwrap_or_default()));
        let width = (high - &low) / Rational::from(self.count.saturating_sub(1).max(1));
        (0..self.count).map(|i| Exact::Rational(Rational::from(&width * i) + &low)).collect()
    }
}
