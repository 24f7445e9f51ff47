//! Errors of the crate.

use thiserror::Error;

/// Why there is no trajectory.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The equation is not linear in x'', or has none.
    #[error("the equation cannot be solved for x''")]
    NotSecondOrder,
    /// A first-order system needs one right side and one start value per state.
    #[error("{states} states, but {given} right sides or start values")]
    WrongDimension {
        /// Number of states.
        states: usize,
        /// Number given.
        given: usize,
    },
    /// A parameter of the equation has no value.
    #[error("parameter {name} has no value")]
    MissingParameter {
        /// Its name.
        name: String,
    },
    /// A formal function has no values in time; use the problem's equation in the time domain.
    #[error("the formal function {name} cannot be integrated")]
    FormalFunction {
        /// Its name.
        name: String,
    },
    /// x'' or a state of another system stands where only x, x' and t may.
    #[error("an expression that must not depend on the state does")]
    UnexpectedState,
    /// A delay must be a positive constant.
    #[error("the delay {delay} is not positive")]
    BadDelay {
        /// Its value.
        delay: f64,
    },
    /// The restitution coefficient must lie between 0 and 1.
    #[error("the restitution coefficient {restitution} is not in [0, 1]")]
    BadRestitution {
        /// Its value.
        restitution: f64,
    },
    /// Delayed terms need the history before the start.
    #[error("a delayed equation needs a history")]
    MissingHistory,
    /// The linearisation of a delayed system is infinite-dimensional.
    #[error("no monodromy matrix: the equation has a delay")]
    LinearisationWithDelay,
    /// The start lies behind a wall.
    #[error("the start lies behind the wall at x = {position}")]
    BehindWall {
        /// Its number.
        wall: usize,
        /// Its position, rounded.
        position: f64,
    },
    /// A value is infinite or not a number: a pole, a logarithm or power of what is not positive.
    #[error("the right side is not finite at t = {time}")]
    NotFinite {
        /// Where.
        time: f64,
    },
    /// Numbers of doubles beyond 2^1024.
    #[error("the motion exceeds the largest double at t = {time}")]
    Overflow {
        /// Where.
        time: f64,
    },
    /// |w|^p with p no integer and w = 0: the solution has a branch point, no Taylor series.
    #[error("branch point of switch {switch} at t = {time}: |w|^p with p no integer, w = 0")]
    BranchPoint {
        /// The switch.
        switch: usize,
        /// Where.
        time: f64,
    },
    /// |w|^p with p near an integer: the powers of its series are too close together.
    #[error(
        "branch point of switch {switch} at t = {time}: its series needs more than {terms} terms \
         (p is too near an integer)"
    )]
    DenseBranchPoint {
        /// The switch.
        switch: usize,
        /// Where.
        time: f64,
        /// How many terms are too many for these digits.
        terms: usize,
    },
    /// x and x' grow beyond all bounds in a finite time, with steps that become too short.
    #[error(
        "the motion escapes to infinity near t = {time:.6} (x = {displacement:.1e} at the last step)"
    )]
    Escape {
        /// Where.
        time: f64,
        /// x at the last step.
        displacement: f64,
    },
    /// x' grows beyond all bounds in a finite time and x does not (a collision), or hardly (like a
    /// logarithm), with steps that become too short.
    #[error(
        "x' grows beyond all bounds near t = {time:.6} (x = {displacement:.6} at the last step)"
    )]
    UnboundedVelocity {
        /// Where.
        time: f64,
        /// x at the last step.
        displacement: f64,
    },
    /// Steps became too short to move the time: a singularity of the solution.
    #[error("no step is short enough at t = {time}")]
    StepTooSmall {
        /// Where.
        time: f64,
    },
    /// A double root of a wall or switch to working precision: whether it is crossed is open.
    #[error("grazing of {surface} at t = {time}: crossed or touched cannot be decided")]
    Grazing {
        /// The surface.
        surface: Surface,
        /// Where.
        time: f64,
    },
    /// Two discontinuous switches vanish together; the order of the switchings decides.
    #[error("switches {first} and {second} switch together at t = {time}")]
    SimultaneousSwitches {
        /// The first.
        first: usize,
        /// The second.
        second: usize,
        /// Where.
        time: f64,
    },
    /// Both sides of a discontinuity lead away from it: the continuation is not unique.
    #[error("switch {switch} at t = {time}: the fields leave on both sides, no unique future")]
    NotUnique {
        /// The switch.
        switch: usize,
        /// Where.
        time: f64,
    },
    /// Sliding needs a right side that is affine in the sign.
    #[error("switch {switch}: the right side is not affine in the sign, sliding is undefined")]
    NotAffine {
        /// The switch.
        switch: usize,
    },
    /// The motion rests on a discontinuity whose sign enters no rate of its argument, as sign(x) in x'': it stays there,
    /// or its future is not unique.
    #[error(
        "switch {switch} at t = {time}: at rest on the discontinuity, where the sign enters the second derivative of its \
         argument: that kind of sliding is not followed"
    )]
    HigherSliding {
        /// The switch.
        switch: usize,
        /// Where.
        time: f64,
    },
    /// More impacts than allowed.
    #[error("{impacts} impacts up to t = {time}, more than allowed")]
    TooManyImpacts {
        /// How many.
        impacts: u64,
        /// Where.
        time: f64,
    },
    /// Newton's method found no periodic orbit of saddle type.
    #[error("no saddle orbit near the guess")]
    NoSaddle,
    /// Newton's method found no homoclinic tangency.
    #[error("no homoclinic tangency was found near {value}")]
    NoTangency {
        /// The value of the free parameter that was tried.
        value: f64,
    },
    /// The observer broke off a computation that has no partial answer.
    #[error("stopped by the observer")]
    Stopped,
    /// A closed-form answer was asked where the eigenvalues did not converge.
    #[error("the eigenvalues of the monodromy matrix did not converge")]
    NoMultipliers,
}

/// A surface of the state space where something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Surface {
    /// A rigid wall.
    Wall(usize),
    /// The zero of the argument of a sign or absolute value.
    Switch(usize),
    /// The limit of the sliding control of a switch.
    Limit(usize),
    /// The force that holds the body at a wall.
    Contact(usize),
    /// A section of the user.
    Section(usize),
}

impl std::fmt::Display for Surface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Wall(n) => write!(f, "wall {n}"),
            Self::Switch(n) => write!(f, "switch {n}"),
            Self::Limit(n) => write!(f, "the sliding limit of switch {n}"),
            Self::Contact(n) => write!(f, "the contact force of wall {n}"),
            Self::Section(n) => write!(f, "section {n}"),
        }
    }
}
