//! x
pub use lindstedt_algebra as algebra;
pub use lindstedt_coeff as coeff;
pub use lindstedt_equation as equation;
pub use lindstedt_expand as expand;
pub use lindstedt_phase as phase;
pub use lindstedt_problems as problems;
pub use lindstedt_series as series;
pub mod multimodular;
mod error;
pub use error::Error;
