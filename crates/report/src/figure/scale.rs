//! Scales of axes: their ranges and the words at their ticks.

use super::Axis;
use std::ops::Range;

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equal lengths.
    Linear,
    /// Equal ratios are equal lengths; what is not positive is not drawn.
    Logarithmic,
}

impl Scale {
    /// The place of a value on the axis.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic if value > 0.0 => value.log10(),
            Self::Logarithmic => f64::NAN,
        }
    }

    /// The word at a tick.
    fn tick(self, place: f64, range: &Range<f64>) -> String {
        match self {
            Self::Logarithmic => match 10f64.powf(place) {
                value if (1e-3..1e4).contains(&value) => short(value),
                value => format!("{value:.0e}"),
            },
            Self::Linear => {
                // No "-0.0".
                let zero = place.abs() < 1e-9 * (range.end - range.start);
                let shown = if zero { 0.0 } else { place };
                format!("{shown:.*}", decimals(range))
            }
        }
    }
}

impl Axis {
    /// The word at a tick; none between two names.
    pub fn tick(&self, place: f64, range: &Range<f64>) -> String {
        if self.names.is_empty() {
            return self.scale.tick(place, range);
        }
        let of_place = |n: &usize| (place - (*n + 1) as f64).abs() < 1e-6;
        let named = (0..self.names.len()).find(of_place).and_then(|n| self.names.get(n));
        named.cloned().unwrap_or_default()
    }

    /// How many characters its widest word has.
    pub fn widest(&self, range: &Range<f64>) -> usize {
        let ends = [range.start, range.end].map(|place| self.tick(place, range));
        ends.iter().chain(&self.names).map(|word| word.chars().count()).max().unwrap_or(1)
    }
}

/// Two digits, without zeros at the end.
fn short(value: f64) -> String {
    let places = (1.0 - value.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.places$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Decimal places that tell about ten ticks apart.
fn decimals(range: &Range<f64>) -> usize {
    let tick = (range.end - range.start) / 10.0;
    (-tick.log10().floor()).clamp(0.0, 12.0) as usize
}

/// The range of finite places with a margin that keeps marks off the frame and a single value drawable.
pub(super) fn range(places: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = places
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let margin = 0.04 * (high - low).max(1e-6 * high.abs()).max(1e-9);
    (low <= high && (high - low).is_finite()).then_some(low - margin..high + margin)
}
