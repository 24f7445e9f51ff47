//! The oscillator (20) at the values of section 3.

use lindstedt_melnikov::StickSlip;
use lindstedt_number::Exact;

/// The oscillator (20) at the point of section 3: a = b = 1, alpha = beta = T0 = 0.3, omega = 2, v* = 0.4.
#[must_use]
pub fn section_three() -> StickSlip {
    let three_tenths = || Exact::from((3, 10));
    StickSlip {
        a: Exact::from(1),
        b: Exact::from(1),
        dry: three_tenths(),
        alpha: three_tenths(),
        beta: three_tenths(),
        omega: Exact::from(2),
        belt_speed: Exact::from((2, 5)),
    }
}

/// The paper's oscillator with another b and v*.
pub(crate) fn oscillator(b: i32, belt_speed: Exact) -> StickSlip {
    StickSlip { b: Exact::from(b), belt_speed, ..section_three() }
}
