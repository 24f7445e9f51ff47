//! The built-in oscillators: each a page with its equation, its small parameter, its condition
//! and its data card. Nothing here knows a coefficient of any expansion.

mod duffing;
mod pendulum;
mod power_law;
pub mod stick_slip;
mod van_der_pol;
pub mod vibro_impact;

use lindstedt_equation::Problem;

/// All built-in problems, in the order of the command line's list.
pub fn all() -> Vec<Problem> {
    vec![
        power_law::problem(),
        pendulum::problem(),
        vibro_impact::problem(),
        duffing::problem(),
        van_der_pol::problem(),
    ]
}

/// The built-in problem of that name, or nothing: stick-slip has no expansion and is found in
/// [`stick_slip`].
///
/// ```
/// let problem = lindstedt_problems::find("duffing").ok_or("no such problem")?;
/// assert_eq!(&*problem.small, "rho");
/// assert!(lindstedt_problems::find("stick-slip").is_none());
/// # Ok::<(), &str>(())
/// ```
pub fn find(name: &str) -> Option<Problem> {
    all().into_iter().find(|problem| problem.name == name)
}
