//! Formulas of the library `lindstedt`, one by one. They stand here, not beside the code: for unit
//! tests the largest library would be compiled twice.

mod closed;
mod coefficients;
mod constants;
mod energy;
mod face;
mod few;
mod front;
mod growth;
mod predictions;
mod quotient;
