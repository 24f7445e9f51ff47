//! What an integration tells its observer.

use crate::integrator::real::Real;
use crate::local::ShapeRef;

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EventKind {
    /// Impact on a wall: x' -> -R x'.
    Impact {
        /// The wall.
        wall: usize,
    },
    /// The limit of infinitely many impacts of a geometrically shrinking sequence; the body
    /// rests at the wall.
    Accumulation {
        /// The wall.
        wall: usize,
    },
    /// The body rests at a wall from here on: an impact without rebound.
    Rest {
        /// The wall.
        wall: usize,
    },
    /// The force pulls the body away from the wall that it rested at.
    Departure {
        /// The wall.
        wall: usize,
    },
    /// The argument of a sign or absolute value changes sign, or begins or ceases to slide.
    Switching {
        /// The switch.
        switch: usize,
        /// The sign before; 0: sliding (sticking).
        from: i8,
        /// The sign after.
        to: i8,
    },
    /// A section of the user is crossed.
    Section {
        /// The section, in the order of [`crate::Model::with_section`].
        section: usize,
        /// From negative to positive.
        rising: bool,
    },
}

impl EventKind {
    /// Its name: `impact`, `accumulation`, `rest`, `departure`, `stick`, `slip`, `switch`, `section`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Impact { .. } => "impact",
            Self::Accumulation { .. } => "accumulation",
            Self::Rest { .. } => "rest",
            Self::Departure { .. } => "departure",
            Self::Switching { to: 0, .. } => "stick",
            Self::Switching { from: 0, .. } => "slip",
            Self::Switching { .. } => "switch",
            Self::Section { .. } => "section",
        }
    }
}

/// An event with the states (those of the linearisation behind them) on both sides.
#[derive(Debug)]
pub struct Event<'a, R: Real> {
    /// When.
    pub time: &'a R::Element,
    /// What.
    pub kind: EventKind,
    /// The states just before.
    pub before: &'a [R::Element],
    /// The states just after.
    pub after: &'a [R::Element],
    /// For [`EventKind::Accumulation`] log2 of the estimated error of its time, relative to the
    /// time; minus infinity otherwise.
    pub log2_error: f64,
}

/// A piece of the solution: a Taylor polynomial per state, valid to the tolerance; next to a branch
/// point (|w|^p with w = 0) a series in fractional powers of the distance from it.
#[derive(Debug)]
pub struct Segment<'a, R: Real> {
    pub(crate) real: &'a R,
    /// The time at the start.
    pub start: &'a R::Element,
    /// The length; the polynomials run in s = t - start from 0 to the length.
    pub length: &'a R::Element,
    /// The signs of the switches; 0: sliding.
    pub modes: &'a [i8],
    /// The wall that the body rests at.
    pub contact: Option<usize>,
    pub(crate) shape: ShapeRef<'a, R>,
}

impl<'a, R: Real> Segment<'a, R> {
    /// The Taylor coefficients of a state, from order 0; nothing if there is no such state, or
    /// next to a branch point, where there is no Taylor series.
    #[must_use]
    pub fn coefficients(&self, state: usize) -> Option<&'a [R::Element]> {
        self.shape.taylor(state)
    }

    /// The state at start + s, 0 <= s <= length; zero for a state that does not exist.
    #[must_use]
    pub fn value(&self, state: usize, s: &R::Element) -> R::Element {
        self.shape.value(self.real, state, s).unwrap_or_else(|| self.real.zero())
    }
}

/// What is reported: a segment first, then the events inside it and at its end, in order.
#[derive(Debug)]
pub enum Report<'a, R: Real> {
    /// A piece of the solution.
    Segment(Segment<'a, R>),
    /// An event.
    Event(Event<'a, R>),
    /// Nothing new: a step takes its time, and asks whether to go on.
    Busy,
}

/// The work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps taken.
    pub steps: u64,
    /// Steps tried again at half the length.
    pub rejected: u64,
    /// Impacts.
    pub impacts: u64,
}
