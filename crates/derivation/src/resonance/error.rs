//! Why equations have no slow flow.

use lindstedt_phase::amplitudes::MOST_EXPONENTS;
use rug::Rational;
use thiserror::Error;

/// Why averaging at resonance does not take equations.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ResonanceError {
    /// A function of t that is no force cos(omega t) or sin(omega t).
    #[error("{term} is no force cos(omega*t) or sin(omega*t)")]
    NotAForce {
        /// The function.
        term: String,
    },
    /// Forces that are no harmonics of one phase, where one is all that is taken.
    #[error("the forces have {phases} phases: here they must be harmonics of one")]
    SecondPhase {
        /// How many there are.
        phases: usize,
    },
    /// A divisor that cannot be told from zero.
    #[error("order {order}: whether the harmonic {harmonic} is resonant is not decided")]
    UndecidedDivisor {
        /// The order.
        order: usize,
        /// k_1 nu_1 + ... + k_M nu_M + m_1 Omega_1 + ...
        harmonic: String,
    },
    /// A term at order zero that is none of a linear oscillator.
    #[error(
        "without the small parameter no oscillators x'' + nu^2*x with a force are left: there is {term}"
    )]
    NotWeaklyNonlinear {
        /// The term.
        term: String,
    },
    /// x_k'' in another form than with a number as its factor.
    #[error("an acceleration must stand with a number as its factor, but there is {term}")]
    Acceleration {
        /// The term.
        term: String,
    },
    /// A delay, where a normal mode or a parameter is asked for, or one that is tied to the period of a force.
    #[error("{term} is a delay, which is not taken here")]
    Delay {
        /// The term.
        term: String,
    },
    /// An unknown without an equation.
    #[error("{unknowns} unknowns, but {equations} equations")]
    Equations {
        /// The unknowns that occur.
        unknowns: usize,
        /// The equations there are.
        equations: usize,
    },
    /// A parameter is sought in a system of several unknowns.
    #[error("{unknowns} unknowns: a parameter is sought for one")]
    SoughtOfSeveral {
        /// The unknowns.
        unknowns: usize,
    },
    /// A parameter is sought where frequencies are no rational numbers.
    #[error("a parameter is sought where frequencies are rational: their squares are {squares}")]
    SoughtOfRoots {
        /// The squares.
        squares: String,
        /// The root of which the frequencies are multiples, where it is one.
        unit: Option<String>,
    },
    /// A parameter that is sought, without the value it starts from.
    #[error("the series of {name} starts from its value at order zero, which is not given")]
    NoStart {
        /// The parameter.
        name: String,
    },
    /// A motion that a parameter keeps periodic starts with a mixture that is not rational.
    #[error(
        "order {order}: no rational mixture of cosine and sine starts a periodic motion{}",
        if roots.is_empty() { String::new() } else { format!(", irrational ones with {parameter} = {roots}") }
    )]
    Mixture {
        /// The order that fixes it.
        order: usize,
        /// The coefficient of the parameter,
        parameter: String,
        /// and its values, where they are numbers.
        roots: String,
    },
    /// A periodic motion turns from its start.
    #[error(
        "order {order}: the periodic motion turns from its start, which order {decided} fixes; it is followed from those that \
         order 1 fixes"
    )]
    Turns {
        /// The order.
        order: usize,
        /// The order that fixes the start.
        decided: usize,
    },
    /// No value of the parameter that is sought balances an order of a motion of this amplitude.
    #[error(
        "order {order}: at the amplitude {amplitude} no value of the parameter that is sought keeps the motion periodic"
    )]
    NotBalanced {
        /// The order.
        order: usize,
        /// The amplitude.
        amplitude: Rational,
    },
    /// The parameter that is sought is one of the frequency of a force.
    #[error(
        "the frequency of a force depends on {name}, which is sought: a motion is followed at one frequency"
    )]
    SoughtFrequency {
        /// The parameter.
        name: String,
    },
    /// A parameter that is sought and does not occur.
    #[error("{name} is sought, but does not occur in the equation")]
    NotSought {
        /// The parameter.
        name: String,
    },
    /// A parameter that the frequencies depend on has no value.
    #[error("the frequencies depend on {name}, which has no value")]
    Unset {
        /// The parameter.
        name: String,
    },
    /// Frequencies of which no ratio is known.
    #[error("the ratio of {first} to {second} is not known, and it decides what is resonant")]
    NoRatio {
        /// One of them.
        first: String,
        /// The other.
        second: String,
    },
    /// The frequency of a force is irrational, and others are no rational multiples of it.
    #[error(
        "{rate}, the frequency of a force, is an irrational number of which not all others are rational multiples"
    )]
    IrrationalRate {
        /// The frequency.
        rate: String,
    },
    /// A factor of the linear part that is no rational number.
    #[error("{factor}, a factor of {unknown} in the linear part, is no rational number")]
    IrrationalFactor {
        /// The factor.
        factor: String,
        /// What it is a factor of.
        unknown: String,
    },
    /// The modes of a coupled linear part have no rational form.
    #[error(
        "strongly coupled modes without rational form: a square of their frequencies is irrational"
    )]
    NoRationalForm,
    /// The frequency of a mode is a root, and the velocity occurs.
    #[error(
        "the frequency of the mode is the root of {square}, and a velocity occurs: exact orders need a rational one"
    )]
    IrrationalMode {
        /// Its square.
        square: String,
    },
    /// A normal mode of a number that there is not.
    #[error("mode {mode}: there are {modes}")]
    NoSuchMode {
        /// The number, from 1.
        mode: usize,
        /// The modes there are.
        modes: usize,
    },
    /// A normal mode of a forced oscillator.
    #[error("a normal mode is free: the equation has a force")]
    ForcedMode,
    /// A mode whose frequency is a whole multiple of that of the normal mode, and which that one drives.
    #[error(
        "order {order}: mode {mode} has {multiple} times the frequency and is driven: no mode moves alone"
    )]
    InternalResonance {
        /// The order.
        order: usize,
        /// The number of the mode, from 1.
        mode: usize,
        /// The ratio of the frequencies.
        multiple: i32,
    },
    /// nu^2 <= 0.
    #[error("the linear part does not oscillate: the square of a frequency is {square}")]
    NoOscillation {
        /// The square.
        square: String,
    },
    /// nu^2 is complex.
    #[error(
        "the linear part does not oscillate: squares of frequencies are not real, a motion grows without the small terms (flutter)"
    )]
    Flutter,
    /// The linear part has no complete set of modes.
    #[error("the linear part is not diagonalisable")]
    NotDiagonalisable,
    /// A divisor that is almost zero.
    #[error(
        "order {order}: the harmonic {harmonic} misses a resonance by {size:e} of the square of the frequency"
    )]
    NearMiss {
        /// The order.
        order: usize,
        /// k_1 nu_1 + ... + k_M nu_M + m Omega.
        harmonic: String,
        /// 1 - lambda^2/nu^2.
        size: f64,
    },
    /// The monomials have no place for so many symbols.
    #[error(
        "a monomial has {MOST_EXPONENTS} exponents: two for each of the unknowns ({unknowns}), one for each phase of the forces \
         ({forces}) and one for each parameter without a value and angle of a delay ({symbols}) are more"
    )]
    TooManySymbols {
        /// The unknowns.
        unknowns: usize,
        /// The phases of the forces; 1 where there are none.
        forces: usize,
        /// The parameters without a value, and what delays turn phases by.
        symbols: usize,
    },
    /// The rates are whole multiples of no number but a very small one.
    #[error(
        "the frequencies {rates} have a ratio of too many digits: each is a multiple of their common measure, below 2^90"
    )]
    RatesApart {
        /// The frequencies of unknowns and forces.
        rates: String,
    },
    /// An exponent beyond the largest that monomials hold.
    #[error("order {order} needs an exponent beyond {largest}")]
    TooHigh {
        /// The order.
        order: usize,
        /// The largest exponent.
        largest: i32,
    },
    /// Multiplied out, the linear part is too long.
    #[error("multiplied out, the linear part has more than {limit} terms")]
    TooManyTerms {
        /// The limit.
        limit: usize,
    },
}

impl ResonanceError {
    /// Why there is no algebra of amplitudes with these frequencies and rates of forces, and so many symbols.
    pub(super) fn no_room(unknowns: &[Rational], forces: &[Vec<Rational>], symbols: usize) -> Self {
        let (count, phases) = (unknowns.len(), forces.len().max(1));
        if 2 * count + phases + symbols > MOST_EXPONENTS {
            return Self::TooManySymbols { unknowns: count, forces: phases, symbols };
        }
        let rates: Vec<String> =
            unknowns.iter().chain(forces.iter().flatten()).map(ToString::to_string).collect();
        Self::RatesApart { rates: rates.join(", ") }
    }
}
