//! Sums of series against their functions.

mod estimates;
