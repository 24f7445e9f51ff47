//! Values from expansions: the table of powers from one expansion, the pendulum, van der Pol,
//! estimates never below the true error, refusals, problem files, averaged motions. Reference numbers: mpmath 1.3.0 (gamma
//! functions, elliptic integrals, Taylor integration of the limit cycle).

mod averaged;
mod closed_forms;
mod compiled;
mod files;
mod support;
