//! The errors of the engines as refusals.

use super::Kind::{self, NoAnswer, Stopped, Undecided, Usage};
use super::Refusal;
use lindstedt_algebra::PhaseError;
use lindstedt_derivation::DerivationError;
use lindstedt_derivation::resonance::ResonanceError;
use lindstedt_equation::classify::Reason;
use lindstedt_evaluation::EvaluationError;
use lindstedt_expand::ExpandError;
use lindstedt_impact::ImpactError;
use lindstedt_melnikov::MelnikovError;
use lindstedt_series::resummation::ResummationError;
use lindstedt_simulate::SimulateError;

/// What to do where a divisor is almost zero.
const AT_RESONANCE: &str =
    "write the frequency at the resonance and the difference as a detuning: eps*sigma*x";

/// Where a force is in resonance,
const RESONANCE: &str = "averaging over one phase needs a force off resonance; at one `lindstedt respond` has the steady states, \
     `lindstedt derive` the slow flow";

/// What takes a delay where none is taken, or one without a small factor.
const DELAY: &str = "`lindstedt derive` without --mode and --unknown averages a delay of order eps; of one unknown \
     `lindstedt simulate` takes it as it is";
const STRONG_DELAY: &str = "with a factor eps, eps*x(t - T), a delay is averaged; of one unknown `lindstedt derive --unknown \
     NAME` finds the Hopf points of a parameter, and `lindstedt simulate` takes it as it is";

/// What has the motions of which a sought parameter has no series.
const ALL: &str = "`lindstedt derive` without --unknown has the slow flow of all motions";

/// What to do with the irrational frequency of a force.
const FRACTION: &str =
    "a fraction near it, with the difference as eps*sigma; `lindstedt simulate` takes it as it is";

/// What to do where a frequency has no value,
const FREQUENCY: &str = "--set NAME=VALUE, for example 1/10; it stays a symbol where the factors of the linear part are squares of its \
     rational multiples, omega0^2*x and 4*omega0^2*y; in the place of 2*omega0^2 write a symbol of its own, omega1^2";
/// or the ratio of two is not known.
const UNKNOWN_RATIO: &str = "write both as multiples of one, as (2*omega0)^2*y and cos((omega0 + eps*sigma)*t), the difference as a \
     detuning eps*sigma, or --set both";

/// What to do where a divisor may be zero. The frequencies are then roots of a polynomial, and taken to be independent.
const EXACT_RELATION: &str = "no --digits decide it where it is zero, more of them where it is only small: give the \
     frequencies a rational ratio (linear terms with fractions, the difference as eps*sigma*x); `lindstedt simulate` takes it \
     as it is";

impl Refusal for ExpandError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::Interrupted { .. } => (Stopped, "interrupted", ""),
            Self::Phase { source: PhaseError::Resonance { .. }, .. } => {
                (NoAnswer, "resonance", RESONANCE)
            }
            Self::Phase { source: PhaseError::NearMiss { .. }, .. } => {
                (NoAnswer, "near-miss", AT_RESONANCE)
            }
            Self::ForcedAtResonance { .. } => (
                NoAnswer,
                "resonance",
                "a force at a resonance needs the factor of the small terms: eps*F*cos(omega*t), which `lindstedt respond` answers",
            ),
            Self::NotOneClock { .. } => (NoAnswer, "no-such-route", "use --route driver"),
            Self::Phase { .. } => {
                (Undecided, "could-not-decide", "the orders below this one can be derived")
            }
            error if averages(error) => {
                (NoAnswer, "no-expansion", "averaging takes it: --normalisation free")
            }
            Self::UnknownName { .. } => (
                Usage,
                "no-value-set",
                "--set NAME=VALUE; --normalisation free keeps parameters as symbols, and so does --mode 1 (omega0^2*x for the linear part)",
            ),
            Self::IrrationalNumber { .. } => (
                NoAnswer,
                "irrational",
                "a name in its place (c*x^3) stays a symbol in `lindstedt derive` and has a rational value with --set; `lindstedt simulate` takes it as it is",
            ),
            Self::UnsupportedTerm { term } if is_force(term) => (
                NoAnswer,
                "no-expansion",
                "forces are averaged: `lindstedt derive`, near a resonance also `lindstedt respond`; \
                 `lindstedt simulate` takes it as it is",
            ),
            Self::NotWeaklyNonlinear => (
                NoAnswer,
                "no-expansion",
                "damping, delays and nonlinear terms need a factor of the small parameter: eps*x', \
                 eps*x(t - T); `lindstedt simulate` takes the equation as it is",
            ),
            Self::StiffnessNotSquare => (
                NoAnswer,
                "no-expansion",
                "write the frequency as one symbol, omega0^2*x in the place of k*x or 2*omega0^2*x, or --set gives it a value; \
                 `lindstedt simulate` takes it as it is",
            ),
            Self::TurnsBySymbols { .. } => (NoAnswer, "no-expansion", "--set them"),
            Self::NegativeStiffness => (
                NoAnswer,
                "no-expansion",
                "x = 0 is a saddle: put x = c + y with a centre c, or `lindstedt simulate`",
            ),
            _ => (NoAnswer, "no-expansion", ""),
        };
        (kind, code, hint.to_owned())
    }
}

/// Whether a term is a force, cos(omega*t), or the time: a function of one, or its inverse, is averaged no more than here.
fn is_force(term: &str) -> bool {
    let wave = term.starts_with("cos(") || term.starts_with("sin(");
    term == "t" || wave && term.ends_with("t)")
}

/// Of what is too long.
fn of_size(error: &ResonanceError) -> Option<(Kind, &'static str, &'static str)> {
    Some(match error {
        ResonanceError::TooManySymbols { symbols: 0, .. } => (
            NoAnswer,
            "too-many-symbols",
            "`lindstedt simulate` takes one unknown, `derive --mode` one mode of several",
        ),
        ResonanceError::TooManySymbols { .. } => {
            (NoAnswer, "too-many-symbols", "--set some of them")
        }
        ResonanceError::RatesApart { .. } => (Undecided, "too-large", FRACTION),
        ResonanceError::TooHigh { .. } | ResonanceError::TooManyTerms { .. } => {
            (Undecided, "too-large", "lower --order")
        }
        _ => return None,
    })
}

/// Of a parameter that is sought.
fn of_sought(error: &ResonanceError) -> Option<(Kind, &'static str, &'static str)> {
    Some(match error {
        ResonanceError::NotSought { .. } => {
            (Usage, "unknown-parameter", "see `lindstedt problems --show NAME`")
        }
        ResonanceError::NoStart { .. } => (Usage, "no-value-set", "--set NAME=VALUE"),
        ResonanceError::Mixture { .. } | ResonanceError::Turns { .. } => {
            (NoAnswer, "no-expansion", ALL)
        }
        ResonanceError::NotBalanced { .. } => (
            NoAnswer,
            "no-expansion",
            "of an equation that is not linear --set amplitude=VALUE for another; `lindstedt respond` has the steady amplitudes",
        ),
        ResonanceError::SoughtFrequency { .. } => (
            NoAnswer,
            "no-method",
            "--set its value, and --unknown of a factor in the equation, as of x: in the time tau = omega*t that is a/omega^2",
        ),
        ResonanceError::SoughtOfSeveral { .. } => (NoAnswer, "no-method", ""),
        _ => return None,
    })
}

/// Of one normal mode.
fn of_mode(error: &ResonanceError) -> Option<(Kind, &'static str, &'static str)> {
    Some(match error {
        ResonanceError::ForcedMode => (NoAnswer, "no-method", ""),
        ResonanceError::NoSuchMode { .. } => (Usage, "no-such-mode", "modes are counted from 1"),
        ResonanceError::InternalResonance { .. } => {
            (NoAnswer, "internal-resonance", "the slow flow has all modes (`derive`)")
        }
        _ => return None,
    })
}

impl Refusal for ResonanceError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::SecondPhase { .. } => (
                NoAnswer,
                "second-phase",
                "forces are cos(m*omega*t) of one omega, detuned together: cos(m*(1 + eps*sigma)*t)",
            ),
            Self::UndecidedDivisor { .. } => (Undecided, "undecided", EXACT_RELATION),
            Self::NotAForce { .. } | Self::Acceleration { .. } => {
                (NoAnswer, "no-method", "`lindstedt simulate` takes it")
            }
            Self::Delay { .. } => (NoAnswer, "no-method", DELAY),
            Self::NotWeaklyNonlinear { term } if term.contains("(t - ") => {
                (NoAnswer, "no-method", STRONG_DELAY)
            }
            Self::NotWeaklyNonlinear { .. } => {
                (NoAnswer, "no-method", "a factor eps marks the small terms")
            }
            Self::Equations { .. } => {
                (Usage, "second-unknown", "one equation for every unknown, separated by `;`")
            }
            Self::Unset { .. } => (Usage, "no-value-set", FREQUENCY),
            Self::IrrationalRate { .. } => (NoAnswer, "ratio-not-rational", FRACTION),
            Self::NoRatio { .. } => (Usage, "ratio-not-known", UNKNOWN_RATIO),
            Self::NoRationalForm => (
                NoAnswer,
                "no-rational-modes",
                "the slow flow (`derive` without --mode) encloses simple ones; a small difference is a detuning eps*sigma*x",
            ),
            Self::SoughtOfRoots { unit: Some(unit), .. } => {
                let hint = format!(
                    "count the time in units of 1/{unit}: with s = {unit}*t the equation is divided by {unit}^2, and its forces \
                     are cos(m*s)"
                );
                return (NoAnswer, "no-rational-modes", hint);
            }
            Self::IrrationalMode { .. } | Self::SoughtOfRoots { .. } => (
                NoAnswer,
                "no-rational-modes",
                "needs rational frequencies; a small difference is a detuning eps*sigma*x",
            ),
            Self::IrrationalFactor { .. } => (
                NoAnswer,
                "irrational",
                "a fraction near it, with the difference as eps*sigma*x; `lindstedt simulate` takes it as it is",
            ),
            Self::NoOscillation { .. } | Self::Flutter => (NoAnswer, "no-expansion", ""),
            Self::NotDiagonalisable => (NoAnswer, "not-diagonalisable", ""),
            Self::NearMiss { .. } => (NoAnswer, "near-miss", AT_RESONANCE),
            error => {
                let found = of_sought(error).or_else(|| of_mode(error)).or_else(|| of_size(error));
                found.unwrap_or((Undecided, "undecided", ""))
            }
        };
        (kind, code, hint.to_owned())
    }
}

impl Refusal for DerivationError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::Expand(error) => return error.parts(),
            Self::Resonance(error) => return error.parts(),
            Self::SymbolTaken { .. } => {
                (Usage, "symbol-taken", "another name, or a value: --set NAME=VALUE")
            }
            Self::BadValue { .. } => {
                (Usage, "bad-value", "values are exact: 3, -1/3, 0.1, 2.5e-3, pi/4, 2*pi/3")
            }
            Self::Irrational { name, .. } if name == "pi" => (
                NoAnswer,
                "irrational",
                "`derive --normalisation free` keeps pi as a symbol, `simulate` computes with it",
            ),
            Self::Irrational { .. } => (NoAnswer, "irrational", "set a rational value"),
            Self::UnknownParameter { .. } => {
                (Usage, "unknown-parameter", "see `lindstedt problems --show NAME`")
            }
            Self::UnknownCondition { .. } => {
                (Usage, "unknown-normalisation", "see `lindstedt problems --show NAME`")
            }
            Self::Unset { .. } => (Usage, "no-value-set", "--set NAME=VALUE, for example 1/10"),
            Self::NotAmongSymbols { .. } => {
                (Usage, "not-among-symbols", "set all parameters, or leave this one open")
            }
            Self::NoSuchRoute { .. } => (NoAnswer, "no-such-route", "use --route driver"),
            Self::OutsideDomain { .. } => (NoAnswer, "outside-domain", ""),
            Self::TooLarge { .. } => {
                (Undecided, "too-large", "lower --order or raise --limit-memory")
            }
            Self::NotEnoughBits { .. } => (Undecided, "not-enough-digits", "ask for fewer digits"),
            Self::MovingSingularity { .. } => (
                NoAnswer,
                "no-method",
                "`lindstedt simulate` takes it; here the equation would have to be odd in x, and \
                 the same backwards in time",
            ),
            Self::BetweenTurningPoints { reason, late_or_forced, .. } => {
                let hint = match **reason {
                    Reason::NonSmooth(_) | Reason::NotPolynomial(_) | Reason::NotOdd(_)
                        if !late_or_forced =>
                    {
                        "`lindstedt evaluate --cycles AMPLITUDE` averages any law to first order, \
                         `lindstedt simulate` takes it"
                    }
                    _ => "`lindstedt simulate` takes it",
                };
                (NoAnswer, "no-expansion", hint)
            }
            Self::NoValue => (NoAnswer, "no-value", ""),
            Self::OutOfPrimes => (Undecided, "out-of-primes", "lower --order"),
            _ => (Undecided, "undecided", ""),
        };
        (kind, code, hint.to_owned())
    }
}

impl Refusal for EvaluationError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::Derivation(error) => return error.parts(),
            Self::NotEvaluated { .. } => (NoAnswer, "not-evaluated", ""),
            Self::Resummation { reason: ResummationError::Stopped, .. } => {
                (Stopped, "interrupted", "")
            }
            Self::Resummation { .. } => {
                (NoAnswer, "no-such-resummation", "try --resum auto, or another order")
            }
            Self::TooManyPhases { .. } => {
                (Undecided, "too-large", "fewer harmonics, or raise --limit-memory")
            }
            Self::NoSuchStart { .. } => (NoAnswer, "no-start", "give amplitude and phase: --start"),
            Self::NotTwoValues { option, .. } => (Usage, *option, "for example 1,0"),
            Self::NotPositive { .. } => (Usage, "start", "--start A,PSI with A > 0"),
            _ => (Undecided, "undecided", ""),
        };
        (kind, code, hint.to_owned())
    }
}

/// Whether averaging takes what no constant amplitude, or none that is known exactly, satisfies.
pub(crate) fn averages(error: &ExpandError) -> bool {
    matches!(
        error,
        ExpandError::AmplitudeDrifts { .. }
            | ExpandError::NoLimitCycle
            | ExpandError::AmplitudeOfHigherOrder
            | ExpandError::IrrationalAmplitude
            | ExpandError::SeveralLimitCycles { .. }
            | ExpandError::DegenerateLimitCycle
    )
}

impl Refusal for SimulateError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::BranchPoint { .. } => (
                Undecided,
                "could-not-decide",
                "more --digits; not at all where w reaches zero without speed, or for p near -1",
            ),
            Self::DenseBranchPoint { .. } => {
                (Undecided, "too-large", "fewer --digits, or a power farther from -1")
            }
            Self::Grazing { .. } | Self::StepTooSmall { .. } => (
                Undecided,
                "could-not-decide",
                "more --digits, or a start beside the degenerate one",
            ),
            Self::MissingParameter { .. } => {
                (Usage, "no-value-set", "--set NAME=VALUE, for example 1/10")
            }
            Self::Overflow { .. } => (
                NoAnswer,
                "no-trajectory",
                "--digits in the place of --f64 has larger numbers; or a shorter time",
            ),
            Self::BadRestitution { .. } => (NoAnswer, "outside-domain", "see `lindstedt problems`"),
            _ => (NoAnswer, "no-trajectory", "another start, or a shorter time"),
        };
        (kind, code, hint.to_owned())
    }
}

impl Refusal for ImpactError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code) = match self {
            Self::NotFinite { .. }
            | Self::NotPositive { .. }
            | Self::OutOfRange { .. }
            | Self::Negative { .. }
            | Self::OrderZero
            | Self::BadAxes => (Usage, "parameter"),
            Self::NoConvergence { .. } | Self::Undecided { .. } => (Undecided, "undecided"),
            Self::Cancelled => (Stopped, "interrupted"),
            _ => (NoAnswer, "no-orbit"),
        };
        (kind, code, String::new())
    }
}

impl Refusal for lindstedt_orbit::Failure {
    fn parts(&self) -> (Kind, &'static str, String) {
        use lindstedt_orbit::Failure;
        let estimates = "`evaluate` without --prove estimates it";
        let closed = "`evaluate` without --prove estimates it; a closed form is certified there";
        let swings =
            "0 < amplitude < pi over the factor of x in the sine; `simulate` takes any state";
        let (kind, code, hint) = match self {
            Failure::Stopped => (Stopped, "interrupted", ""),
            Failure::NoValue(_) => (Usage, "no-value-set", "--set NAME=VALUE, for example 1/10"),
            Failure::Singular { .. }
            | Failure::NotConverged { .. }
            | Failure::NoContraction { .. }
            | Failure::NoFunction { .. }
            | Failure::Residual { .. }
            | Failure::NoPeriod { .. }
            | Failure::Jump
            | Failure::Apart { .. }
            | Failure::NotOneNumber => (Undecided, "could-not-decide", ""),
            Failure::NotSmooth(_) => (NoAnswer, "no-proof", closed),
            Failure::NotSwinging => (NoAnswer, "no-proof", swings),
            _ => (NoAnswer, "no-proof", estimates),
        };
        (kind, code, hint.to_owned())
    }
}

/// What is left of a series of homoclinic orbits that is refused.
const FIRST_ORDER: &str = "without --order the first order is found by Melnikov's integral; `lindstedt simulate` follows it in time";

impl Refusal for lindstedt_recognise::Refusal {
    fn parts(&self) -> (Kind, &'static str, String) {
        use lindstedt_recognise::{Refusal, Why};
        let (kind, code, hint) = match self {
            Refusal::MissingValues { .. } => {
                (Usage, "no-value-set", "give it under [parameters] or with --set NAME=VALUE")
            }
            Refusal::Periods { .. } => (Usage, "parameter", "k = 1, 2, ..."),
            Refusal::TooManyTerms { .. } => (Undecided, "too-large", super::SHORTER),
            Refusal::NoSaddleForm | Refusal::MovesSaddle { .. } => {
                (NoAnswer, "no-method", FIRST_ORDER)
            }
            Refusal::NoStiffness { .. } => (
                NoAnswer,
                "no-method",
                "a rational number near it is taken; `lindstedt simulate` takes it as it is",
            ),
            Refusal::NoPeriod | Refusal::Tangent | Refusal::NoSpring => {
                (NoAnswer, "no-method", "`lindstedt simulate` follows it in time")
            }
            Refusal::NoForce => (
                NoAnswer,
                "no-method",
                "--unknown NAME finds the value of a parameter for which the orbit persists",
            ),
            Refusal::Term {
                why: Why::DependsOnPosition | Why::NotHarmonic | Why::PositionFactor,
                ..
            } => (
                NoAnswer,
                "no-method",
                "`lindstedt simulate --section stroboscopic` shows where chaos begins",
            ),
            Refusal::Term { why: Why::RestUndecided, .. } => (Undecided, "could-not-decide", ""),
            Refusal::NoOrbit => (NoAnswer, "no-method", "`lindstedt simulate` takes it"),
            Refusal::Melnikov(error) => return error.parts(),
            _ => (NoAnswer, "no-method", "`lindstedt problems --show FILE` lists the methods"),
        };
        (kind, code, hint.to_owned())
    }
}

impl Refusal for MelnikovError {
    fn parts(&self) -> (Kind, &'static str, String) {
        let (kind, code, hint) = match self {
            Self::NotFinite { .. } | Self::NotPositive { .. } => {
                (NoAnswer, "outside-domain", "see `lindstedt threshold --help`")
            }
            Self::Undecided { .. } | Self::Digits(_) => {
                (Undecided, "could-not-decide", "move off the degenerate point")
            }
            Self::NotSquare { .. } => {
                (NoAnswer, "irrational", "another unit of time, t = s*c, makes it a square")
            }
            Self::LeavesRing { .. } => (NoAnswer, "no-method", FIRST_ORDER),
            _ => (NoAnswer, "no-answer", ""),
        };
        (kind, code, hint.to_owned())
    }
}
