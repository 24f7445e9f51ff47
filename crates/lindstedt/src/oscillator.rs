//! A problem with every value settled: what all questions are asked of.

mod checks;

use crate::answer::{Header, SCHEMA};
use crate::refusal::Refused;
use crate::{DerivationError, Error, Exact, Remark, classification};
use lindstedt_equation::classify::Classification;
use lindstedt_equation::print::Style;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, ParameterCard, Problem};
use lindstedt_problem_file::{Names, PI, ProblemFile, canonical_name, parse_equation};
use rug::Rational;
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use std::time::Instant;

/// An oscillator: an equation with what a problem file says about it, the values that are set, and
/// what its amplitude is. Built-in problems, files and equations come to be in one way, by a problem
/// file; no question knows a problem by its name.
///
/// ```
/// use lindstedt::{Oscillator, Verify, Work};
/// let duffing = Oscillator::builtin("duffing")?;
/// let same = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
/// for oscillator in [duffing, same] {
///     let answer = oscillator.verify(&Verify { order: 2, ..Verify::default() }, &Work::default())?;
///     assert!(answer.value.observed_order.is_some_and(|slope| (slope - 3.0).abs() < 0.01));
/// }
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Oscillator {
    /// The problem under the conditions that may be asked for.
    problem: Problem,
    file: ProblemFile,
    /// What the file is called in messages.
    origin: String,
    values: BTreeMap<String, Exact>,
    condition: Option<Condition>,
    /// Whether the file was made from an equation alone, which says nothing of the amplitude.
    bare: bool,
    remarks: Vec<Remark>,
}

impl Oscillator {
    /// The same with another equation.
    pub(crate) fn with_equation(mut self, equation: Expression) -> Self {
        self.problem.equation = equation;
        self
    }

    /// The built-in oscillator of that name.
    ///
    /// # Errors
    /// [`Refused`] with the names there are.
    ///
    /// ```
    /// use lindstedt::Oscillator;
    /// assert_eq!(Oscillator::builtin("duffing")?.to_string(), "x'' + x + rho*x^3 = 0");
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn builtin(name: &str) -> Result<Self, Error> {
        let stick_slip = lindstedt_problems::stick_slip::problem;
        let mut all = lindstedt_problems::all();
        all.push(stick_slip());
        if let Some(problem) = all.iter().find(|problem| problem.name == name) {
            return Self::from_problem(problem);
        }
        let names: Vec<&str> = all.iter().map(|problem| &*problem.name).collect();
        let shown: String = name.chars().take(60).collect();
        let message = format!("there is no problem {shown:?}");
        let hint = format!("known: {}", names.join(", "));
        Err(Refused::usage("unknown-problem", message, hint).into())
    }

    /// An oscillator from the text of a problem file.
    ///
    /// # Errors
    /// [`Error::File`] with line and column; [`Refused`] for the name of a second unknown where no table
    /// declares it as a parameter.
    ///
    /// ```
    /// use lindstedt::{Exact, Oscillator};
    /// let text = "equation = \"x'' + x + eps*b*x^3 = 0\"\n[parameters]\nb = { value = \"1/3\" }\n";
    /// assert_eq!(Oscillator::file(text)?.value("b"), Some(Exact::from((1, 3))));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn file(text: &str) -> Result<Self, Error> {
        let file = ProblemFile::parse(text)?;
        let second = file.problem.parameters.iter().find(|card| is_unknown(&card.name));
        if let Some(card) = second.filter(|_| !file.declares) {
            let name = &card.name;
            if is_frequency(&file.problem.equation, name) {
                let message =
                    format!("{name} stands for a frequency and is an undeclared parameter");
                let hint = "another name (omega) needs no declaration: this one is that of an unknown \
                            where no [parameters] of a problem file declare it";
                return Err(Refused::usage("undeclared-parameter", message, hint).into());
            }
            let message =
                format!("{name} is the name of an unknown, and it has no equation of its own");
            let hint = "its equation stands behind a `;`, or among the `equations` of a file; a problem file \
                        may declare a parameter of that name";
            return Err(Refused::usage("second-unknown", message, hint).into());
        }
        // The root of the impact velocity has no place in an equation.
        let root = |name: &str| name == "branch" && file.problem.impact.is_some();
        let unused = file.unused.iter().filter(|name| !root(name));
        let unused = unused.map(|name| format!("parameter {name} is declared and occurs nowhere"));
        let mut remarks: Vec<Remark> = unused.map(Remark).collect();
        if file.equation.to_lowercase().contains("taylor") {
            let polynomial = "taylor(...) is a polynomial: all results are those of the polynomial, not \
                              of the function";
            remarks.push(Remark(polynomial.to_owned()));
        }
        if let [only] = &file.problem.unknowns[..] {
            remarks.push(Remark(format!("where an answer names its own quantities, x is {only}")));
        }
        let (problem, origin) = (file.problem.clone(), file.problem.name.to_string());
        let (values, condition, bare) = (BTreeMap::new(), None, false);
        Ok(Self { problem, file, origin, values, condition, bare, remarks })
    }

    /// An oscillator from its equation in the small parameter `eps`, or from several with `;` between them,
    /// one for every unknown; other names are parameters
    /// without a value. What its amplitude is follows from the form of the equation: free to drift
    /// with t or a delay, given where none drifts, that of a limit cycle otherwise.
    ///
    /// # Errors
    /// [`Error::Parse`] with the position in the text; [`Refused`] for the name of a second unknown, which
    /// is never taken for a constant.
    ///
    /// ```
    /// use lindstedt::{Condition, Oscillator};
    /// let cycle: Oscillator = "x'' + x = eps*(1 - x^2)*x'".parse()?;
    /// assert_eq!(cycle.condition(), Some(Condition::LimitCycle));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn parse(equation: &str) -> Result<Self, Error> {
        let list: Vec<&str> = equation.split(';').filter(|e| !e.trim().is_empty()).collect();
        let names = match &list[..] {
            [_, _, ..] => Names::any("eps").of_system(list.iter().copied()),
            _ => Names::any("eps").of_one(equation),
        };
        // A place in the equation, not in a file.
        list.iter().try_for_each(|text| parse_equation(text, &names).map(drop))?;
        let text = match &list[..] {
            [_, _, ..] => format!("equations = {list:?}\n"),
            _ => format!("equation = {equation:?}\n"),
        };
        Ok(Self { bare: true, ..Self::file(&text)?.without_places() })
    }

    /// An oscillator from a problem made in Rust.
    ///
    /// # Errors
    /// [`Error::File`] where the problem contradicts itself.
    ///
    /// ```
    /// use lindstedt::unstable::equation::Expression;
    /// use lindstedt::{Oscillator, Problem, Quantity, Work};
    /// let x = Expression::DISPLACEMENT;
    /// let equation = Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(5);
    /// let quintic = Oscillator::from_problem(&Problem::new("quintic", equation))?;
    /// let found = quintic.derive(1, &Work::default())?.value;
    /// assert_eq!(found.exact(Quantity::Period, 1).as_deref(), Some("-5/16"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn from_problem(problem: &Problem) -> Result<Self, Error> {
        // A card that the equation does not mention is no slip of a writer.
        let written = Self::file(&lindstedt_problem_file::write(problem))?;
        Ok(Self { remarks: Vec::new(), ..written.without_places() })
    }

    /// Nobody has the file: refusals show the piece of the equation, not its place.
    fn without_places(mut self) -> Self {
        self.file.forget_places();
        self
    }

    /// The same oscillator with what its file is called in messages. A problem without a name of its own
    /// has that of the file, without folder and ending.
    #[must_use]
    pub fn called(mut self, origin: &str) -> Self {
        self.origin = origin.chars().take(60).collect();
        let stem = origin.rsplit(['/', '\\']).next().unwrap_or(origin);
        let stem = stem.strip_suffix(".toml").unwrap_or(stem).to_lowercase();
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let name: String = stem.chars().map(plain).take(40).collect();
        let name = name.trim_matches('-');
        if !self.file.named && !name.is_empty() {
            self.problem.name = name.to_owned().into();
            self.file.problem.name = self.problem.name.clone();
        }
        self
    }

    /// The same oscillator with a value for a parameter, written exactly: `1/3`, `0.1`, `2.5e-3`,
    /// `pi/4`. Greek letters may be spelled or written.
    ///
    /// # Errors
    /// [`DerivationError::BadValue`](crate::DerivationError::BadValue); [`Refused`] for the number pi, which
    /// is no parameter.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Quantity, Work};
    /// let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?.set("amplitude", "2")?;
    /// let found = duffing.derive(1, &Work::default())?.value;
    /// assert_eq!(found.exact(Quantity::Frequency, 1).as_deref(), Some("3/2"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn set(self, name: &str, value: &str) -> Result<Self, Error> {
        if canonical_name(name.trim()) == PI {
            let message = "pi is a number: it has no other value";
            return Err(Refused::usage("set", message, "").into());
        }
        let value = Exact::parse(value)?;
        let set = self.with(name, value);
        let Some(term) = set.division_by_zero() else { return Ok(set) };
        let term = term.print(&set.problem.small, Style::Text);
        let message = format!("{term} divides by zero at the values set");
        Err(Refused::no_answer("no-value", message, "another value of the parameter").into())
    }

    /// A power in the equations that divides by zero at the values that are set.
    fn division_by_zero(&self) -> Option<&Expression> {
        let value = |e: &Expression| match e {
            Expression::Parameter(name) => {
                Some(Expression::Number(self.values.get(name)?.as_rational()?.clone()))
            }
            _ => None,
        };
        let divides = |e: &&Expression| {
            let Expression::Power(base, exponent) = e else { return false };
            let number = |e: &Expression| e.substitute(&value).as_number();
            number(exponent).is_some_and(|n| n < 0) && number(base).is_some_and(|q| q.is_zero())
        };
        self.problem.equations().flat_map(Expression::nodes).find(divides)
    }

    /// The same oscillator with an exact value for a parameter; pi stays what it is.
    #[must_use]
    pub fn with(mut self, name: &str, value: Exact) -> Self {
        let name = canonical_name(name.trim());
        if name != PI {
            self.values.insert(name, value);
        }
        self
    }

    /// The same oscillator with a parameter as its card has it.
    pub(crate) fn without(mut self, name: &str) -> Self {
        self.values.remove(name);
        self
    }

    /// The same oscillator under another condition. Averaging needs nothing of an equation that was
    /// written for a constant amplitude, so a free one need not be listed; what the amplitude is under
    /// the others only the file can say.
    ///
    /// # Errors
    /// [`Refused`] where the problem does not offer it.
    ///
    /// ```
    /// use lindstedt::{Condition, Oscillator, Quantity, Work};
    /// let duffing = Oscillator::builtin("duffing")?.under(Condition::FundamentalAmplitude)?;
    /// let found = duffing.derive(2, &Work::default())?.value;
    /// assert_eq!(found.exact(Quantity::Frequency, 2).as_deref(), Some("-15/256"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn under(mut self, condition: Condition) -> Result<Self, Error> {
        if self.bare {
            self.problem.conditions = vec![condition];
            self.problem.amplitude = AmplitudeRole::usual(Some(&condition));
        } else if !self.problem.conditions.contains(&condition) {
            if condition != Condition::FreeAmplitude {
                let name = condition.name();
                let message = format!("{} does not offer this normalisation", self.origin);
                let hint = format!("condition = \"{name}\" in the file asks for it");
                return Err(Refused::usage("unknown-normalisation", message, hint).into());
            }
            self.problem.conditions.push(condition);
        }
        self.condition = Some(condition);
        Ok(self)
    }

    /// The problem.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// What its file says.
    #[must_use]
    pub fn problem_file(&self) -> &ProblemFile {
        &self.file
    }

    /// What its file is called in messages.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// The values that were set.
    #[must_use]
    pub fn given(&self) -> &BTreeMap<String, Exact> {
        &self.values
    }

    /// The condition that was asked for.
    #[must_use]
    pub fn asked_condition(&self) -> Option<Condition> {
        self.condition
    }

    /// The condition: the one asked for, else the first of the problem; nothing where an expansion
    /// is not asked for.
    #[must_use]
    pub fn condition(&self) -> Option<Condition> {
        self.condition.or(self.problem.conditions.first().copied())
    }

    /// What was noticed when the problem was read.
    #[must_use]
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    fn card(&self, name: &str) -> Option<&ParameterCard> {
        self.problem.parameters.iter().find(|card| card.name == name)
    }

    /// The value of a parameter: the one set, else that of its card.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<Exact> {
        let default = || Exact::parse(&self.card(name)?.default).ok();
        self.values.get(name).cloned().or_else(default)
    }

    /// The values of all parameters that have one, in the order of the problem, then those set
    /// besides its cards.
    #[must_use]
    pub fn all_values(&self) -> Vec<(String, Exact)> {
        let cards = self.problem.parameters.iter().map(|card| card.name.to_string());
        let besides = self.values.keys().filter(|name| self.card(name).is_none()).cloned();
        let value = |name: String| Some((name.clone(), self.value(&name)?));
        cards.chain(besides).filter_map(value).collect()
    }

    /// The rational values of the parameters.
    #[must_use]
    pub fn rational_values(&self) -> BTreeMap<String, Rational> {
        let rational = |(name, value): (String, Exact)| Some((name, value.as_rational()?.clone()));
        self.all_values().into_iter().filter_map(rational).collect()
    }

    /// What the equation is made of and which methods take it.
    ///
    /// # Errors
    /// [`Error::Classify`].
    ///
    /// ```
    /// use lindstedt::{Oscillator, unstable::equation::classify::Method};
    /// let parts = Oscillator::builtin("stick-slip")?.classify()?;
    /// assert!(parts.takes(Method::Melnikov) && !parts.takes(Method::LindstedtPoincare));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn classify(&self) -> Result<Classification, Error> {
        Ok(classification::of(&self.problem, &self.values)?)
    }

    /// That a parameter has no value.
    pub(crate) fn unset(&self, name: &str) -> Error {
        DerivationError::without_value(&self.problem, name).into()
    }

    /// The header of an answer: the values are those that enter.
    pub(crate) fn header(
        &self,
        at: impl IntoIterator<Item = (impl ToString, impl ToString)>,
        order: Option<usize>,
        tier: &'static str,
        start: Instant,
    ) -> Header {
        Header {
            schema: SCHEMA,
            problem: self.problem.name.to_string(),
            equation: self.to_string(),
            at: at.into_iter().map(|(name, value)| (name.to_string(), value.to_string())).collect(),
            units: self.problem_file().units.clone(),
            order,
            tier,
            seconds: start.elapsed().as_secs_f64(),
        }
    }
}

/// Its equation, `... = 0`, as a problem file has it.
impl fmt::Display for Oscillator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem.print(Style::Text))
    }
}

/// As [`Oscillator::parse`].
impl FromStr for Oscillator {
    type Err = Error;

    fn from_str(equation: &str) -> Result<Self, Error> {
        Self::parse(equation)
    }
}

/// Whether a name occurs as a factor of t and nowhere else.
fn is_frequency(equation: &Expression, name: &str) -> bool {
    let own = Expression::parameter(name);
    let times_t = |e: &Expression| {
        matches!(e, Expression::Product(factors)
            if factors.contains(&Expression::Time) && factors.iter().any(|f| f.contains(&own)))
    };
    let count = |e: &Expression| e.nodes().filter(|node| **node == own).count();
    let beside_t: usize = equation.nodes().filter(|e| times_t(e)).map(count).sum();
    beside_t > 0 && beside_t == count(equation)
}

/// Whether a name is that of an unknown by the custom of the field, so that taking it for a constant
/// would answer another question.
fn is_unknown(name: &str) -> bool {
    let letter = matches!(name, "y" | "z" | "u" | "v" | "w" | "q");
    let index = name.strip_prefix("x_").or_else(|| name.strip_prefix('x'));
    let numbered = |digits: &str| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    letter || index.is_some_and(numbered)
}
