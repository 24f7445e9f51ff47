//! Equations and problem files, read and refused.

mod equations;
mod follows;
