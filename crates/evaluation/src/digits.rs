//! A number, or that not one digit of it is supported, as data; the bits that digits need.

use lindstedt_number::{Number, Status};
use serde::Serialize;

/// A number of which not one digit is known.
#[derive(Serialize)]
pub(crate) struct NoDigit {
    exact: Option<()>,
    decimal: Option<()>,
    error: Option<()>,
    status: Status,
}

/// A number, or that it has no digit.
#[derive(Serialize)]
#[serde(untagged)]
pub(crate) enum Digits<'a> {
    Some(&'a Number),
    None(NoDigit),
}

impl<'a> Digits<'a> {
    pub(crate) fn of(number: Option<&'a Number>) -> Self {
        let none = NoDigit { exact: None, decimal: None, error: None, status: Status::Estimated };
        number.map_or(Self::None(none), Self::Some)
    }
}

/// Bits for so many digits, with a margin.
pub(crate) fn bits_for(digits: usize) -> u32 {
    u32::try_from(digits).unwrap_or(u32::MAX / 8).saturating_mul(4).saturating_add(32)
}
