//! Numbers, once for every crate: exact values as a user writes them, real and complex balls that
//! enclose a number at any precision, the decimal digits that are known of it, and the number as it
//! leaves the program, with its class.
//!
//! ```
//! use lindstedt_number::{ball::Balls, digits::decimal};
//!
//! let balls = Balls::new(128);
//! assert_eq!(decimal(&balls.pi(), 20).as_deref(), Some("3.1415926535897932385"));
//! ```

pub mod ball;
pub mod digits;
