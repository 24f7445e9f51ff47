//! Values from expansions: the table of powers from one expansion, the pendulum, van der Pol,
//! estimates never below the true error, refusals, problem files, averaged motions. Reference numbers: mpmath 1.3.0 (gamma
//! functions, elliptic integrals, Taylor integration of the limit cycle).
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

#[path = "evaluate/averaged.rs"]
mod averaged;
#[path = "evaluate/closed_forms.rs"]
mod closed_forms;
#[path = "evaluate/files.rs"]
mod files;
#[path = "evaluate/support.rs"]
mod support;
