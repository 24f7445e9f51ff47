//! An expansion in estimated numbers, as data.

use lindstedt_equation::{Condition, Quantity};
use lindstedt_number::{Number, Object};
use rug::ops::Pow;
use rug::{Float, Rational};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// How the numbers are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Tier {
    /// Values at double-exponential nodes, at the precision that `digits` correct digits need;
    /// grids are refined until two agree to that.
    Collocation {
        /// Correct digits of every coefficient.
        digits: u32,
    },
    /// The same in double precision.
    Doubles,
    /// A truncated Fourier series in double precision: the cheap tier. With singularities at
    /// x = 0 (logarithms, signs) it converges like a power of 1/harmonics only.
    Fourier {
        /// The number of harmonics of each symmetry class.
        harmonics: usize,
    },
}

/// A series of estimated numbers.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EstimatedSeries {
    /// As in [`crate::NamedSeries::quantity`].
    pub quantity: Quantity,
    /// From order 0: the coefficient and the estimate of its absolute error.
    pub coefficients: Vec<(Float, Float)>,
}

/// An expansion in estimated numbers.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Estimate {
    /// The tier.
    pub tier: Tier,
    /// The normalisation used.
    pub condition: Condition,
    /// The highest order derived.
    pub order: usize,
    /// The nodes of the finer grid.
    pub nodes: usize,
    /// The bits computed with.
    pub bits: u32,
    /// Products of phase functions on the finer grid.
    pub products: u64,
    /// The series of the result.
    pub series: Vec<EstimatedSeries>,
    /// The name of the small parameter.
    pub parameter: String,
    /// The coefficients as numbers, series by series, as far as they have one digit; empty where nobody
    /// asked for decimals.
    pub numbers: Vec<Vec<Option<Number>>>,
}

impl Tier {
    /// The name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        if matches!(self, Self::Fourier { .. }) { "fourier" } else { "collocation" }
    }
}

impl Serialize for Estimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Method {
            name: &'static str,
            nodes: usize,
            bits: u32,
            products: u64,
        }
        let named = self.series.iter().map(|series| series.quantity.name()).zip(&self.numbers);
        let series = Object(named.collect());
        let method = Method {
            name: "the same recursion on two grids",
            nodes: self.nodes,
            bits: self.bits,
            products: self.products,
        };
        let unchecked = Object(vec![("checked_orders", None::<bool>), ("zero", None)]);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("parameter", &self.parameter)?;
        map.serialize_entry("normalisation", &self.condition)?;
        map.serialize_entry("series", &series)?;
        map.serialize_entry::<_, [&str; 0]>("solution", &[])?;
        map.serialize_entry("residual", &unchecked)?;
        map.serialize_entry("method", &method)?;
        map.end()
    }
}

impl Estimate {
    /// With the coefficients as numbers of at most so many digits.
    #[must_use]
    pub fn with_numbers(mut self, digits: usize, parameter: &str) -> Self {
        let row = |series: &EstimatedSeries| {
            (0..series.coefficients.len()).map(|n| series.number(n, digits)).collect()
        };
        self.numbers = self.series.iter().map(row).collect();
        parameter.clone_into(&mut self.parameter);
        self
    }

    /// The series of that quantity.
    #[must_use]
    pub fn named(&self, quantity: Quantity) -> Option<&EstimatedSeries> {
        self.series.iter().find(|series| series.quantity == quantity)
    }
}

impl EstimatedSeries {
    /// Coefficient n with at most `digits` digits, as many as the estimate supports and two more;
    /// nothing where its error is infinite.
    #[must_use]
    pub fn number(&self, n: usize, digits: usize) -> Option<Number> {
        let (value, error) = self.coefficients.get(n)?;
        Number::with_error(value, error, digits)
    }
}

impl Estimate {
    /// Powers of the frequency in the time of the problem: omega = w Omega.
    pub(super) fn undo_time_scale(&mut self, w: &Rational) {
        if *w == 1 {
            return;
        }
        for named in &mut self.series {
            let factor = w.clone().pow(named.quantity.power());
            for (value, error) in &mut named.coefficients {
                *value *= &factor;
                *error *= &factor;
            }
        }
    }
}

/// 64 roundings at so many bits.
pub(super) fn rounding(value: &Float, bits: u32) -> Float {
    Float::with_val(53, value.abs_ref()) >> bits.saturating_sub(6)
}
