//! Values of parameters, exact where they can be.

use lindstedt_equation::Problem;
use lindstedt_number::Exact;
use rug::{Float, Rational};
use std::collections::BTreeMap;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Quantity {
    /// An exact number.
    Exact(Exact),
    /// A float; the caller is responsible for its having enough digits.
    Float(Float),
}

impl Quantity {
    /// Reads an exact number, as [`Exact::parse`] does; nothing for other text.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        Exact::parse(text).ok().map(Self::Exact)
    }

    /// The rational, if it is one.
    #[must_use]
    pub fn rational(&self) -> Option<Rational> {
        match self {
            Self::Exact(x) => x.as_rational().cloned(),
            Self::Float(_) => None,
        }
    }

    /// The value as a float of `bits` bits, within one unit in the last place.
    #[must_use]
    pub fn float(&self, bits: u32) -> Float {
        match self {
            Self::Exact(x) => x.float(bits),
            Self::Float(x) => Float::with_val(bits, x),
        }
    }

    /// q times the value; a float is rounded at its precision.
    #[must_use]
    pub fn times(&self, q: &Rational) -> Self {
        match self {
            Self::Exact(x) => Self::Exact(x.times(q)),
            Self::Float(x) => Self::Float(Float::with_val(x.prec(), x * q)),
        }
    }
}

impl From<Exact> for Quantity {
    fn from(x: Exact) -> Self {
        Self::Exact(x)
    }
}

impl From<Rational> for Quantity {
    fn from(q: Rational) -> Self {
        Self::Exact(q.into())
    }
}

impl From<i64> for Quantity {
    fn from(n: i64) -> Self {
        Self::Exact(n.into())
    }
}

impl From<Float> for Quantity {
    fn from(x: Float) -> Self {
        Self::Float(x)
    }
}

/// The values of the parameters of an equation, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    values: BTreeMap<String, Quantity>,
}

impl Parameters {
    /// No values.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Those of a problem: given, or by default, with the delay that is a number of periods of the force.
    /// What has no value is left out.
    #[must_use]
    pub fn of_problem(problem: &Problem, given: &BTreeMap<String, Exact>) -> Self {
        let mut parameters = Self::new();
        let value = |name: &str| {
            let card = || problem.parameters.iter().find(|card| card.name == name);
            given.get(name).cloned().or_else(|| Exact::parse(&card()?.default).ok())
        };
        for card in &problem.parameters {
            if let Some(value) = value(&card.name) {
                parameters.set(&card.name, value);
            }
        }
        if let Some(tie) = &problem.synchronous
            && let (Some(Exact::Rational(k)), Some(omega)) =
                (value(&tie.periods), value(&tie.frequency))
        {
            let two_k = k * 2u32;
            let period = match &omega {
                Exact::Rational(w) if !w.is_zero() => Some(Exact::pi_times(two_k / w)),
                Exact::PiTimes(w) if !w.is_zero() => Some(Exact::from(two_k / w)),
                _ => None,
            };
            if let Some(period) = period {
                parameters.set(&tie.delay, period);
            }
        }
        parameters
    }

    /// With one more value (or another one).
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Quantity>) -> Self {
        self.set(name, value);
        self
    }

    /// Sets a value.
    pub fn set(&mut self, name: &str, value: impl Into<Quantity>) {
        self.values.insert(name.to_owned(), value.into());
    }

    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Quantity> {
        self.values.get(name)
    }
}
