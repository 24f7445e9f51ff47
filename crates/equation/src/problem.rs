//! A problem: an equation with what is needed to expand it and to talk about it.

use crate::Expression;
use crate::print::Style;
use crate::symmetry::is_reversible;
use crate::unknown::UnknownName;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

/// Text of a data card: a literal of a built-in problem or a string read from a problem file.
pub type Text = Cow<'static, str>;

/// What fixes the amplitude (and the phase) of the solution, order by order.
///
/// ```
/// use lindstedt_equation::Condition;
/// assert_eq!("limit-cycle".parse(), Ok(Condition::LimitCycle));
/// assert_eq!(Condition::FreeAmplitude.to_string(), "free-amplitude");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Condition {
    /// x(0) = 1, x'(0) = 0: corrections start at rest at zero ("initial amplitude").
    InitialAmplitude,
    /// The first harmonic of x is cos psi: corrections have no first harmonic.
    FundamentalAmplitude,
    /// A limit cycle with x'(0) = 0; its amplitude x(0) is determined order by order.
    LimitCycle,
    /// A free amplitude a that drifts (Krylov, Bogoliubov, Mitropolsky): x = a cos psi + ...,
    /// corrections have no first harmonic, da/dt and dpsi/dt are functions of a.
    FreeAmplitude,
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Condition {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        UnknownName::find("condition", text, &Self::ALL, Self::name)
    }
}

impl Condition {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::InitialAmplitude, Self::FundamentalAmplitude, Self::LimitCycle, Self::FreeAmplitude];

    /// The usual one: the initial amplitude for equations that keep their form when time runs backwards,
    /// a limit cycle for those that do not, a free amplitude with forcing or delay; none where nothing is
    /// small: such an equation is for the time domain.
    ///
    /// ```
    /// use lindstedt_equation::{Condition, Expression};
    /// let free = Expression::ACCELERATION + Expression::DISPLACEMENT;
    /// assert_eq!(Condition::usual(&free), None);
    /// let damped = free + Expression::Small * Expression::VELOCITY;
    /// assert_eq!(Condition::usual(&damped), Some(Condition::LimitCycle));
    /// ```
    #[must_use]
    pub fn usual(equation: &Expression) -> Option<Self> {
        let outside = |e: &Expression| *e == Expression::Time || e.is_delayed();
        if equation.find(&outside).is_some() {
            Some(Self::FreeAmplitude)
        } else if !equation.contains(&Expression::Small) {
            None
        } else if is_reversible(equation) {
            Some(Self::InitialAmplitude)
        } else {
            Some(Self::LimitCycle)
        }
    }

    /// Its name in files and results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::InitialAmplitude => "initial-amplitude",
            Self::FundamentalAmplitude => "fundamental-amplitude",
            Self::LimitCycle => "limit-cycle",
            Self::FreeAmplitude => "free-amplitude",
        }
    }
}

/// How the amplitude of the user's solution enters an equation written for amplitude one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmplitudeRole {
    /// omega^2 is multiplied by a^(exponent * small parameter), a > 0.
    ScalesFrequency {
        /// The exponent in units of the small parameter.
        exponent: i32,
    },
    /// The coefficients S_n of the formal function depend on it, 0 < a < pi.
    InSums,
    /// x = a y is substituted into the equation and the equation divided by a; a > 0 rational.
    Scaled,
    /// It is part of the small parameter; a is not zero.
    InSmallParameter,
    /// The equation determines it.
    Determined,
    /// It is a variable of the result.
    Free,
}

impl AmplitudeRole {
    /// The usual one: free or determined where the condition says so, or x = a y.
    #[must_use]
    pub const fn usual(condition: Option<&Condition>) -> Self {
        match condition {
            Some(Condition::LimitCycle) => Self::Determined,
            Some(Condition::FreeAmplitude) | None => Self::Free,
            Some(_) => Self::Scaled,
        }
    }
}

/// One line of a data card.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterCard {
    /// The name on the command line.
    pub name: Text,
    /// What it is, with its domain; all parameters are dimensionless unless a unit is given.
    pub meaning: Text,
    /// The default value, as the user would write it.
    pub default: Text,
}

impl ParameterCard {
    /// Name, meaning and default value.
    #[must_use]
    pub fn new(name: impl Into<Text>, meaning: impl Into<Text>, default: impl Into<Text>) -> Self {
        Self { name: name.into(), meaning: meaning.into(), default: default.into() }
    }
}

/// The direction in which x crosses a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// x' > 0: the wall is above.
    Rising,
    /// x' < 0: the wall is below.
    Falling,
}

/// A rigid wall: when x reaches `position` in the given direction, x' becomes -restitution x'.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// Where the wall stands; an expression in parameters.
    pub position: Expression,
    /// From which side the wall is reached.
    pub crossing: Crossing,
    /// The restitution coefficient, between 0 and 1; an expression in parameters.
    pub restitution: Expression,
}

/// A delay that is a whole number of periods of the force, T = 2 pi k/omega.
#[derive(Clone, Debug, PartialEq)]
pub struct Synchronous {
    /// The parameter T.
    pub delay: Text,
    /// The parameter k, a positive integer.
    pub periods: Text,
    /// The parameter omega.
    pub frequency: Text,
}

/// A built-in or user-defined oscillator, as data: the same tree is expanded, integrated, classified and
/// printed. Dimensionless; `notes` says how it follows from the physical one.
///
/// ```
/// use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};
/// let x = Expression::DISPLACEMENT;
/// let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(3);
/// let duffing = Problem::new("duffing", equation)
///     .with_parameter("amplitude", "x(0), where x'(0) = 0", "1")
///     .with_source("classical");
/// assert_eq!(duffing.conditions, [Condition::InitialAmplitude]);
/// assert_eq!((&*duffing.small, duffing.amplitude), ("eps", AmplitudeRole::Scaled));
/// assert_eq!(duffing.parameters.len(), 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Problem {
    /// The name on the command line.
    pub name: Text,
    /// One line.
    pub title: Text,
    /// The left side of equation = 0, as it is expanded.
    pub equation: Expression,
    /// The left sides of the equations of further unknowns; empty where x is the only one.
    pub others: Vec<Expression>,
    /// The names of the unknowns where there are several; in expressions they are numbers.
    pub unknowns: Vec<Text>,
    /// The same equation with its formal functions written out, for integration in time; nothing
    /// when `equation` has none.
    pub time_domain: Option<Expression>,
    /// A wall with an impact law.
    pub impact: Option<Impact>,
    /// A delay tied to the force.
    pub synchronous: Option<Synchronous>,
    /// The name of the small parameter.
    pub small: Text,
    /// The conditions that make sense, the default first.
    pub conditions: Vec<Condition>,
    /// How an amplitude other than one enters.
    pub amplitude: AmplitudeRole,
    /// The parameters.
    pub parameters: Vec<ParameterCard>,
    /// How the dimensionless equation follows from the physical one, and what is known.
    pub notes: Text,
    /// Where it comes from.
    pub source: Text,
}

impl Problem {
    /// A problem in powers of `eps`, under its usual condition, with the usual role of the amplitude.
    #[must_use]
    pub fn new(name: impl Into<Text>, equation: Expression) -> Self {
        let conditions = Vec::from_iter(Condition::usual(&equation));
        Self {
            name: name.into(),
            title: "".into(),
            others: Vec::new(),
            unknowns: Vec::new(),
            time_domain: None,
            impact: None,
            synchronous: None,
            small: "eps".into(),
            amplitude: AmplitudeRole::usual(conditions.first()),
            conditions,
            parameters: Vec::new(),
            notes: "".into(),
            source: "".into(),
            equation,
        }
    }

    /// The equations of further unknowns, and the names of all of them.
    #[must_use]
    pub fn with_others(self, others: Vec<Expression>, unknowns: Vec<Text>) -> Self {
        Self { others, unknowns, ..self }
    }

    /// Its title, one line.
    #[must_use]
    pub fn with_title(self, title: impl Into<Text>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// The name of the small parameter.
    #[must_use]
    pub fn with_small(self, name: impl Into<Text>) -> Self {
        Self { small: name.into(), ..self }
    }

    /// The conditions that make sense, the default first, and how an amplitude enters.
    #[must_use]
    pub fn under(self, conditions: impl Into<Vec<Condition>>, amplitude: AmplitudeRole) -> Self {
        Self { conditions: conditions.into(), amplitude, ..self }
    }

    /// One more parameter: its name, what it is, its default.
    #[must_use]
    pub fn with_parameter(
        mut self,
        name: impl Into<Text>,
        meaning: impl Into<Text>,
        default: impl Into<Text>,
    ) -> Self {
        self.parameters.push(ParameterCard::new(name, meaning, default));
        self
    }

    /// The equation to integrate, where the one to expand has formal functions.
    #[must_use]
    pub fn with_time_domain(self, equation: Expression) -> Self {
        Self { time_domain: Some(equation), ..self }
    }

    /// A wall with an impact law.
    #[must_use]
    pub fn with_wall(self, wall: Impact) -> Self {
        Self { impact: Some(wall), ..self }
    }

    /// The parameter `delay` is `periods` periods of the force of that frequency.
    #[must_use]
    pub fn with_synchronous(
        self,
        delay: impl Into<Text>,
        periods: impl Into<Text>,
        frequency: impl Into<Text>,
    ) -> Self {
        let (delay, periods, frequency) = (delay.into(), periods.into(), frequency.into());
        Self { synchronous: Some(Synchronous { delay, periods, frequency }), ..self }
    }

    /// How the dimensionless equation follows from the physical one, and what is known.
    #[must_use]
    pub fn with_notes(self, notes: impl Into<Text>) -> Self {
        Self { notes: notes.into(), ..self }
    }

    /// Where it comes from.
    #[must_use]
    pub fn with_source(self, source: impl Into<Text>) -> Self {
        Self { source: source.into(), ..self }
    }
}

impl Problem {
    /// The left sides of all equations, unknown k in equation k.
    pub fn equations(&self) -> impl Iterator<Item = &Expression> {
        [&self.equation].into_iter().chain(&self.others)
    }

    /// The name of unknown k, from 0.
    #[must_use]
    pub fn unknown(&self, k: usize) -> String {
        let usual = || if k == 0 { "x".to_owned() } else { format!("x_{}", k + 1) };
        self.unknowns.get(k).map_or_else(usual, ToString::to_string)
    }

    /// The equations as one line, `... = 0; ... = 0`.
    #[must_use]
    pub fn print(&self, style: Style) -> String {
        let side =
            |e: &Expression| format!("{} = 0", e.print_named(&self.small, &self.unknowns, style));
        let separator = if style == Style::Text { "; " } else { r",\quad " };
        self.equations().map(side).collect::<Vec<_>>().join(separator)
    }
}
