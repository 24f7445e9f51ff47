//! Numbers, once for every crate: exact values as a user writes them ([`Exact`]), real and complex
//! balls that enclose a number at any precision ([`ball`]), the decimal digits that are known of it
//! ([`digits`]), and the number as it leaves the program, with its class ([`Number`]).
//!
//! ```
//! use lindstedt_number::{Exact, ball::Balls, certified};
//!
//! let angle: Exact = "pi/4".parse()?;
//! let sine = certified(None, 20, |balls| Some(balls.sin(&angle.ball(balls))))?;
//! assert_eq!(sine.decimal, "0.70710678118654752440");
//! # Ok::<(), lindstedt_number::NumberError>(())
//! ```

pub mod ball;
pub mod complex;
pub mod digits;
mod error;
mod exact;
pub mod interval;
mod named;
mod number;
mod ratio;
pub mod real;
mod whole;

pub use error::NumberError;
pub use exact::{Exact, decimal};
pub use named::{Object, as_map};
pub use number::{Number, Status, certified, rational};
pub use ratio::{from_ratio, to_ratio};
pub use whole::Whole;
