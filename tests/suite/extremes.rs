//! The extremes as a grid: orders 0 to 200, precisions 2 to 100 000 bits, parameters from 1e-300 to
//! 1e300, exponents down to -1. Every cell is certified (the enclosure contains the truth),
//! estimated (the truth lies within the error stated) or refused with a named error; nothing else.
//!
//! The truth has its own route: Gamma functions and arithmetic-geometric means of MPFR at a higher
//! precision, recursions, quadrature. The small grids run in CI; the full ones are ignored.

mod coefficients;
mod functions;
mod period;
mod rates;
mod support;
mod threshold;
mod vibro_impact;
