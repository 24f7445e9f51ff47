//! What the routes hand to the result.

use crate::derivation::Solution;
use crate::series::Powers;
use lindstedt_coeff::Polynomial;

/// What a route finds.
pub(crate) struct Found {
    pub solution: Solution,
    pub powers: Powers,
    pub amplitudes: Vec<Polynomial>,
    pub stiffness: Polynomial,
    pub checked_orders: Option<usize>,
}
