//! Why a vibro-impact question has no answer.

/// Refusals, each with the numbers that decide.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImpactError {
    /// A parameter is NaN or infinite.
    #[error("parameter {name} is not a finite number")]
    NotFinite {
        /// The parameter.
        name: &'static str,
    },
    /// A parameter must be positive.
    #[error("parameter {name} must be positive, not {value}")]
    NotPositive {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter must not be negative.
    #[error("parameter {name} must be at least 0, not {value}")]
    Negative {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter lies outside its interval.
    #[error("parameter {name} must lie between {low} and {high}, not {value}")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Least value.
        low: f64,
        /// Largest value.
        high: f64,
    },
    /// Delta = E + 1/E - 2 cos theta = 0: the free flow has period T and no impact orbit exists
    /// (the impact velocity would be 0).
    #[error("the free flow is T-periodic (Delta = {delta:e}): no impact orbit")]
    PeriodicFreeFlow {
        /// Delta, or E Delta omega^2 (F/(P0 T))^2 from the regular form.
        delta: f64,
    },
    /// kappa = q = 0 (theta an odd multiple of pi and R_r E = 1): the impact velocity is infinite.
    #[error("impact resonance (kappa^2 + q^2 = {size:e}): the impact velocity is infinite")]
    ImpactResonance {
        /// kappa^2 + q^2, times omega^2.
        size: f64,
    },
    /// Beyond the fold: the quadratic for the impact velocity has no real root.
    #[error(
        "beyond the fold: the impact velocity is no real number (discriminant {discriminant:e})"
    )]
    BeyondFold {
        /// The discriminant, or an upper bound where only its sign is known.
        discriminant: f64,
    },
    /// The root of the chosen branch is not positive.
    #[error("the impact velocity of this branch would be {velocity:e}: no such orbit")]
    NoPositiveVelocity {
        /// The root.
        velocity: f64,
    },
    /// The impact velocity is too small for a linear impact map (square-root singularity).
    #[error("grazing: impact velocity {velocity:e} below {threshold:e}")]
    Grazing {
        /// The impact velocity.
        velocity: f64,
        /// 10^-8 of the velocity scale min(omega F, P0 T).
        threshold: f64,
    },
    /// R_r = 0 and the mass is pressed to the wall after the impact.
    #[error(
        "the mass sticks to the wall after the impact (acceleration {acceleration}): no such orbit"
    )]
    Sticking {
        /// The acceleration after the impact, which must be negative.
        acceleration: f64,
    },
    /// alpha = omega and c = 0: F is infinite, the equivalent orbit of the prediction has no form.
    #[error("alpha = omega without damping: the forced amplitude F is infinite")]
    Resonance,
    /// c >= 2 alpha: the damping is not small, the free flow does not oscillate.
    #[error(
        "c = {damping} is not below 2 alpha = {limit}: the prediction needs an oscillating flow"
    )]
    Overdamped {
        /// c.
        damping: f64,
        /// 2 alpha.
        limit: f64,
    },
    /// The predicted frequency is not a positive finite number.
    #[error("KBM is not applicable: predicted frequency {frequency}")]
    NotApplicable {
        /// alpha0.
        frequency: f64,
    },
    /// The order is below 1.
    #[error("the order of the prediction must be at least 1")]
    OrderZero,
    /// An iteration did not reach its goal.
    #[error("{what} did not converge")]
    NoConvergence {
        /// What was sought.
        what: &'static str,
    },
    /// Not decided at the highest precision allowed.
    #[error("{what} is not decided at {bits} bits")]
    Undecided {
        /// The question.
        what: &'static str,
        /// The precision.
        bits: u32,
    },
    /// A parameter cannot be swept.
    #[error("a chart needs two different axes with at least one point each")]
    BadAxes,
    /// The observer said stop.
    #[error("stopped by the caller")]
    Cancelled,
}
