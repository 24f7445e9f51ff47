//! The short way from an equation to its expansion.

use crate::evaluate::{EvaluateSettings, Evaluation, evaluate};
use crate::{Derivation, Error, Exact, Progress, Settings, derive};
use lindstedt_equation::classify::{Classification, ClassifyError, classify};
use lindstedt_equation::{Condition, Expression, ParameterCard, Problem};
use lindstedt_problem_file::{
    Names, ParseError, ParseErrorKind, parse_equation, usual_amplitude, usual_condition,
};
use rug::Rational;
use std::collections::BTreeMap;

/// An oscillator with the settings of its derivation.
///
/// ```
/// use lindstedt::Oscillator;
/// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?.derive(3)?;
/// assert_eq!(duffing.exact("frequency", 2).as_deref(), Some("-21/256"));
/// let softer = Oscillator::parse("x'' + k x = eps x^3")?.set("k", "1/4")?.derive(1)?;
/// assert_eq!(softer.exact("frequency_squared", 1).as_deref(), Some("-3/4"));
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Oscillator {
    /// The problem.
    pub problem: Problem,
    /// The settings.
    pub settings: Settings,
}

impl Oscillator {
    /// An oscillator from its equation in the small parameter `eps`; other names are parameters.
    /// The condition is the usual one: a free amplitude with t or a delay, a given amplitude where
    /// the form of the equation shows that none drifts, a limit cycle otherwise.
    ///
    /// # Errors
    /// [`Error::Parse`] with the position in the text.
    pub fn parse(text: &str) -> Result<Self, Error> {
        Self::parse_in(text, &Names::any("eps"))
    }

    /// An oscillator from its equation with the names that it may mention.
    ///
    /// # Errors
    /// [`Error::Parse`] with the position in the text.
    pub fn parse_in(text: &str, names: &Names) -> Result<Self, Error> {
        let equation = parse_equation(text, names)?;
        let whole = |kind| ParseError { kind, at: 0..text.len() };
        Self::new(equation, &names.small)
            .ok_or_else(|| whole(ParseErrorKind::NoAcceleration).into())
    }

    /// An oscillator from a tree; nothing when x'' does not occur linearly with a constant factor.
    pub fn new(equation: Expression, small: &str) -> Option<Self> {
        let equation = equation.acceleration_alone().ok()?;
        let condition = usual_condition(&equation);
        let card = |name: String| ParameterCard {
            name: name.into(),
            meaning: "".into(),
            default: "".into(),
        };
        let mut parameters: Vec<ParameterCard> = equation
            .parameters()
            .into_iter()
            .filter(|name| name != "amplitude")
            .map(card)
            .collect();
        parameters.push(ParameterCard {
            name: "amplitude".into(),
            meaning: "".into(),
            default: "1".into(),
        });
        let problem = Problem {
            name: "oscillator".into(),
            title: "".into(),
            equation,
            time_domain: None,
            impact: None,
            synchronous: None,
            small: small.to_owned().into(),
            conditions: vec![condition],
            amplitude: usual_amplitude(Some(&condition)),
            parameters,
            notes: "".into(),
            source: "".into(),
        };
        Some(Self { problem, settings: Settings::default() })
    }

    /// The same oscillator under another condition.
    #[must_use]
    pub fn under(mut self, condition: Condition) -> Self {
        self.problem.conditions = vec![condition];
        self.problem.amplitude = usual_amplitude(Some(&condition));
        self
    }

    /// The same oscillator with a value for a parameter, written exactly: `1/3`, `0.1`, `2.5e-3`.
    ///
    /// # Errors
    /// [`Error::BadValue`].
    pub fn set(mut self, name: &str, value: &str) -> Result<Self, Error> {
        self.settings.parameters.insert(name.to_owned(), Exact::parse(value)?);
        Ok(self)
    }

    /// What the equation is made of and which methods take it.
    ///
    /// # Errors
    /// [`ClassifyError`].
    pub fn classify(&self) -> Result<Classification, ClassifyError> {
        classify(&self.problem, &known_values(&self.problem, &self.settings.parameters))
    }

    /// The period by resummation, with the values set; the order is a quick one if nothing.
    ///
    /// # Errors
    /// As [`evaluate`].
    ///
    /// ```
    /// use lindstedt::Oscillator;
    /// let quintic = Oscillator::parse("x'' + x + eps*x^5 = 0")?.set("eps", "1/2")?;
    /// let period = quintic.evaluate(None)?.period.map(|period| period.decimal);
    /// // 4 times the integral of dx/sqrt(1 - x^2 + (1 - x^6)/6) from 0 to 1.
    /// assert!(period.is_some_and(|period| period.starts_with("5.50107565725")));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn evaluate(&self, order: Option<usize>) -> Result<Evaluation, Error> {
        let settings = EvaluateSettings {
            order,
            condition: self.settings.condition,
            parameters: self.settings.parameters.clone(),
            ..EvaluateSettings::default()
        };
        evaluate(&self.problem, &settings, &mut |_: Progress| true)
    }

    /// The checked expansion up to an order.
    ///
    /// # Errors
    /// As [`derive()`].
    pub fn derive(&self, order: usize) -> Result<Derivation, Error> {
        let settings = Settings { order, ..self.settings.clone() };
        derive(&self.problem, &settings, &mut |_: Progress| true)
    }
}

/// The rational values of a problem's parameters: those given, else the defaults.
pub fn known_values(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
) -> BTreeMap<String, Rational> {
    let mut values = BTreeMap::new();
    for card in &problem.parameters {
        let default = || Exact::parse(&card.default).ok();
        let value = given.get(&*card.name).cloned().or_else(default);
        if let Some(q) = value.as_ref().and_then(Exact::as_rational) {
            values.insert(card.name.to_string(), q.clone());
        }
    }
    values
}
