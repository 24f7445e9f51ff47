//! A problem at given parameters: every value, the small parameter, the amplitude, and the form of
//! the equation that is expanded.

use crate::error::EvaluationError;
use lindstedt_algebra::Stop;
use lindstedt_derivation::prepare::prepare;
use lindstedt_derivation::{
    Derivation, DerivationError as Error, FORMAL, Progress, Settings, check_parameters, derive,
    has_logarithms, value,
};
use lindstedt_equation::classify::polynomial;
use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::resummation::Shared;
use rug::Rational;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The forms of equations about whose period more is known than its series.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// x'' + kappa x (x^2)^small, x(0) = a at rest.
    PowerLaw {
        /// kappa > 0.
        stiffness: Rational,
    },
    /// x'' + x S(small ln x^2), S with the sums S_n of the sine, at amplitude one.
    Sums,
    /// y'' + kappa y + c small y^3, y(0) = 1 at rest.
    Cubic {
        /// kappa > 0.
        stiffness: Rational,
        /// c.
        coefficient: Rational,
    },
    /// x'' + kappa x + small f(x), f free of x'.
    Conservative,
    /// A limit cycle of an equation that t -> -t, small -> -small leaves as it is.
    Relaxation {
        /// Of its terms, the highest.
        degree: usize,
    },
    /// Another equation over Q.
    Polynomial {
        /// Of its terms, the highest; that of a cubic where they are no polynomial.
        degree: usize,
    },
    /// Another equation with logarithms.
    Logarithmic,
}

/// The value of the small parameter, coefficient * amplitude^power.
#[derive(Clone, Debug)]
pub struct Small {
    coefficient: Exact,
    power: u32,
    /// The parameter whose value the coefficient is, where the amplitude stands beside it.
    factor: Option<String>,
    /// As it is printed: `eps`, `rho = eps*amplitude^2`.
    pub name: String,
}

/// What an expansion depends on: the equation that is expanded and the unit of its time, the condition, the order, the
/// amplitude in the coefficients.
type Key = (Expression, Rational, Condition, usize, Option<Exact>);

/// At most so many expansions are kept.
const KEPT: usize = 8;

/// Expansions that were derived and what their sums have in common: settings that share it derive and prepare only once
/// what differs in the value of the small parameter alone.
#[derive(Clone, Debug, Default)]
pub struct Known {
    derived: Arc<Mutex<Vec<(Key, Derivation)>>>,
    /// What sums of one series share.
    sums: Shared,
}

/// A problem with a value for everything.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The problem as it was given.
    pub problem: Problem,
    /// The condition in force.
    pub condition: Condition,
    /// The form of the equation that is expanded: values put in, x scaled by the amplitude.
    pub form: Form,
    /// The parameters with their values, the small one included.
    pub at: Vec<(String, Exact)>,
    /// The small parameter.
    pub small: Small,
    /// a in x = a y, y the solution of the expanded equation.
    pub amplitude: Exact,
    /// What [`derive()`] is told.
    parameters: BTreeMap<String, Exact>,
    /// What was derived before, where it is shared.
    known: Option<Known>,
}

/// Refuses a name that is neither on the card nor the small parameter.
pub fn check_names(problem: &Problem, given: &BTreeMap<String, Exact>) -> Result<(), Error> {
    let mut known: Vec<&str> = problem.parameters.iter().map(|card| &*card.name).collect();
    if !known.contains(&&*problem.small) && problem.amplitude != AmplitudeRole::InSmallParameter {
        known.push(&problem.small);
    }
    let unknown = |name: &&String| !known.contains(&name.as_str()) && ***name != *problem.small;
    match given.keys().find(unknown) {
        None => Ok(()),
        Some(name) => Err(Error::UnknownParameter {
            problem: problem.name.to_string(),
            name: name.clone(),
            known: known.join(", "),
        }),
    }
}

/// The value of the small parameter of an averaged problem, its amplitude being free, and all
/// values in the order of the card.
pub fn small_value(
    problem: &Problem,
    given: &BTreeMap<String, Exact>,
) -> Result<(Exact, Vec<(String, Exact)>), Error> {
    let values = Values { problem, given };
    let small = match problem.amplitude {
        // eps A^power at A = 1: the displacement is not scaled.
        AmplitudeRole::InSmallParameter => {
            values.get(&problem.small).or_else(|| values.coefficient().map(|(_, value)| value))
        }
        _ => values.get(&problem.small),
    };
    let coefficient = small.ok_or_else(|| unset(problem, &problem.small))?;
    let small = Small { coefficient, power: 0, factor: None, name: problem.small.to_string() };
    let listed = matches!(problem.amplitude, AmplitudeRole::InSmallParameter)
        && values.get(&problem.small).is_none();
    let mut all = values.all(&small);
    if listed {
        // It stands there under the name of its coefficient.
        all.retain(|(name, _)| **name != *problem.small);
    }
    Ok((small.coefficient, all))
}

fn one() -> Exact {
    Exact::Rational(Rational::from(1))
}

fn unset(problem: &Problem, name: &str) -> Error {
    Error::without_value(problem, name)
}

impl Setting {
    /// Values given, else the defaults of the data card; the small parameter may be given even
    /// where the card does not list it.
    ///
    /// # Errors
    /// [`EvaluationError::NotEvaluated`] without a condition that fixes the amplitude, or with a wall;
    /// [`Error::Unset`] where a value is missing; [`Error::UnknownParameter`],
    /// [`Error::OutsideDomain`], [`Error::Irrational`] for parameters.
    pub fn new(
        problem: &Problem,
        condition: Option<Condition>,
        given: &BTreeMap<String, Exact>,
    ) -> Result<Self, EvaluationError> {
        check_names(problem, given)?;
        let listed = |name: &str| problem.parameters.iter().any(|card| card.name == name);
        let mut parameters = given.clone();
        if !listed(&problem.small) {
            parameters.remove(&*problem.small);
        }
        check_parameters(problem, &parameters)?;
        if problem.conditions.is_empty() || problem.impact.is_some() {
            return Err(EvaluationError::NotEvaluated { problem: problem.name.to_string() });
        }
        let condition = lindstedt_derivation::condition(problem, condition)?;
        if condition == Condition::FreeAmplitude {
            return Err(EvaluationError::NotEvaluated { problem: problem.name.to_string() });
        }
        let values = Values { problem, given };
        let amplitude = match problem.amplitude {
            AmplitudeRole::Determined | AmplitudeRole::Free => one(),
            _ => values.get("amplitude").unwrap_or_else(one),
        };
        match problem.amplitude {
            // Their expansions are those at amplitude one.
            AmplitudeRole::ScalesFrequency { .. } | AmplitudeRole::InSmallParameter => {
                parameters.remove("amplitude");
            }
            AmplitudeRole::Scaled | AmplitudeRole::InSums if listed("amplitude") => {
                parameters.insert("amplitude".to_owned(), amplitude.clone());
            }
            _ => {}
        }
        let settings = Settings {
            condition: Some(condition),
            parameters: parameters.clone(),
            ..Settings::default()
        };
        let equation = prepare(problem, &settings)?.problem.equation;
        if let Some(name) = equation.parameters().first() {
            return Err(unset(problem, name).into());
        }
        let small = values.small(&equation)?;
        let form = form(problem, condition, &equation);
        let scales = matches!(problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        if scales && !matches!(form, Form::PowerLaw { .. }) && amplitude != one() {
            return Err(Error::OutsideDomain {
                name: "amplitude".to_owned(),
                value: amplitude.to_string(),
                domain: "1 (it scales the frequency of x'' + k*x*(x^2)^delta alone)",
            }
            .into());
        }
        let at = values.all(&small);
        let (problem, known) = (problem.clone(), None);
        Ok(Self { problem, condition, form, at, small, amplitude, parameters, known })
    }

    /// The same, which derives nothing that is known.
    #[must_use]
    pub fn sharing(self, known: &Known) -> Self {
        Self { known: Some(known.clone()), ..self }
    }

    /// What sums share.
    pub(crate) fn sums(&self) -> Shared {
        self.known.as_ref().map_or_else(Shared::default, |known| known.sums.clone())
    }

    /// The value of the small parameter.
    pub fn small(&self, balls: Balls) -> Ball {
        let power = balls.powi(&self.amplitude.ball(balls), i64::from(self.small.power));
        let coefficient = self.small.coefficient.ball(balls);
        power.map_or_else(|| balls.indeterminate(), |power| balls.mul(&coefficient, &power))
    }

    /// The small parameter where it is a number of its own.
    pub fn small_alone(&self) -> Option<&Exact> {
        (self.small.power == 0).then_some(&self.small.coefficient)
    }

    /// The same where it is rational.
    pub fn small_rational(&self) -> Option<&Rational> {
        self.small_alone()?.as_rational()
    }

    /// The expansion.
    ///
    /// # Errors
    /// As [`derive()`].
    pub fn derive(
        &self,
        order: usize,
        (memory, stop): (u64, &Stop),
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Derivation, Error> {
        let settings = Settings {
            order,
            condition: Some(self.condition),
            parameters: self.parameters.clone(),
            memory,
            stop: stop.clone(),
            ..Settings::default()
        };
        let Some(Known { derived: known, .. }) = &self.known else {
            return derive(&self.problem, &settings, observer);
        };
        let amplitude = self.parameters.get("amplitude").cloned();
        let prepared = prepare(&self.problem, &settings)?;
        let (equation, unit) = (prepared.problem.equation, prepared.time_scale);
        let key: Key = (equation, unit, self.condition, order, amplitude);
        // Nothing is derived under the lock: what is derived runs on the threads that wait for it.
        let list = || known.lock().unwrap_or_else(PoisonError::into_inner);
        let before = list().iter().find(|(of, _)| *of == key).map(|(_, found)| found.clone());
        if let Some(found) = before {
            return Ok(found);
        }
        let found = derive(&self.problem, &settings, observer)?;
        let mut list = list();
        if found.order == order && !stop.asked() && list.len() < KEPT {
            list.push((key, found.clone()));
        }
        Ok(found)
    }
}

/// The parameters given, and the defaults of the others.
struct Values<'a> {
    problem: &'a Problem,
    given: &'a BTreeMap<String, Exact>,
}

impl Values<'_> {
    fn get(&self, name: &str) -> Option<Exact> {
        value(self.problem, self.given, name)
    }

    /// n = 1 + 2 delta of the power law, where the card has both: whichever is given determines
    /// the other.
    fn exponent(&self) -> Option<Result<Rational, Error>> {
        let scales = matches!(self.problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        let listed = self.problem.parameters.iter().any(|card| card.name == "n");
        let value = self.given.get("n").filter(|_| scales && listed)?;
        Some(
            value.as_rational().cloned().ok_or_else(|| Error::Irrational {
                name: "n".to_owned(),
                value: value.to_string(),
            }),
        )
    }

    fn small(&self, equation: &Expression) -> Result<Small, Error> {
        let name = &*self.problem.small;
        let plain =
            |coefficient| Small { coefficient, power: 0, factor: None, name: name.to_owned() };
        if let Some(n) = self.exponent() {
            return Ok(plain(Exact::Rational((n? - 1u32) / 2u32)));
        }
        if let Some(value) = self.get(name) {
            return Ok(plain(value));
        }
        if self.problem.amplitude == AmplitudeRole::InSmallParameter
            && let Some(power) = weight(equation)
            && let Some((of, coefficient)) = self.coefficient()
        {
            let exponent = if power == 1 { String::new() } else { format!("^{power}") };
            let name = format!("{name} = {of}*amplitude{exponent}");
            return Ok(Small { coefficient, power, factor: Some(of), name });
        }
        Err(unset(self.problem, name))
    }

    /// The parameter that is part of the small one together with the amplitude: the only other
    /// one that the equation does not mention.
    fn coefficient(&self) -> Option<(String, Exact)> {
        let mentioned = self.problem.equation.parameters();
        let mut others =
            self.problem.parameters.iter().filter(|card| {
                card.name != "amplitude" && !mentioned.contains(&card.name.to_string())
            });
        let card = others.next()?;
        others.next().is_none().then_some(())?;
        Some((card.name.to_string(), self.get(&card.name)?))
    }

    /// All values in the order of the card.
    fn all(&self, small: &Small) -> Vec<(String, Exact)> {
        let name = &*self.problem.small;
        let mut list = Vec::new();
        let scales = matches!(self.problem.amplitude, AmplitudeRole::ScalesFrequency { .. });
        for card in &self.problem.parameters {
            let value = match (&*card.name, small.coefficient.as_rational()) {
                (of, _) if of == name => Some(small.coefficient.clone()),
                ("n", Some(delta)) if scales => {
                    Some(Exact::Rational(Rational::from(delta * 2u32) + 1u32))
                }
                (of, _) => self.get(of),
            };
            list.extend(value.map(|value| (card.name.to_string(), value)));
        }
        let listed = list.iter().any(|(of, _)| of == name);
        if !listed && small.power == 0 {
            list.push((name.to_owned(), small.coefficient.clone()));
        }
        list
    }
}

/// w, where x -> a x, small -> a^-w small leaves the equation as it is but for a factor.
fn weight(equation: &Expression) -> Option<u32> {
    let mut found = None;
    for [order, x, velocity] in polynomial(equation)?.into_keys() {
        let degree = (x + velocity).checked_sub(1)?;
        match (order, degree) {
            (0, 0) => {}
            (0, _) => return None,
            _ if degree % order != 0 || found.is_some_and(|w| w != degree / order) => return None,
            _ => found = Some(degree / order),
        }
    }
    found.filter(|w| *w > 0)
}

fn form(problem: &Problem, condition: Condition, equation: &Expression) -> Form {
    let initial = condition == Condition::InitialAmplitude;
    if let Some(stiffness) = power_law(equation).filter(|_| initial) {
        return Form::PowerLaw { stiffness };
    }
    let x = || Expression::DISPLACEMENT;
    let sums = (Expression::Small * x().pow(2).ln()).formal(FORMAL);
    if initial
        && problem.amplitude == AmplitudeRole::InSums
        && *equation == (Expression::ACCELERATION + x() * sums).canonical()
    {
        return Form::Sums;
    }
    let Some(terms) = polynomial(equation) else {
        let other = Form::Polynomial { degree: 3 };
        return if has_logarithms(equation) { Form::Logarithmic } else { other };
    };
    let get = |key: [u32; 3]| terms.get(&key).cloned();
    if let (Some(stiffness), Some(coefficient)) = (get([0, 1, 0]), get([1, 3, 0]))
        && terms.len() == 2
        && stiffness > 0
        && initial
    {
        return Form::Cubic { stiffness, coefficient };
    }
    let keys = || terms.keys();
    let degree = keys().map(|[_, x, velocity]| (x + velocity) as usize).max().unwrap_or(1);
    if condition != Condition::LimitCycle && keys().all(|[order, _, v]| *order <= 1 && *v == 0) {
        Form::Conservative
    } else if condition == Condition::LimitCycle
        && keys().all(|[order, _, velocity]| (order + velocity) % 2 == 0)
    {
        Form::Relaxation { degree }
    } else {
        Form::Polynomial { degree }
    }
}

/// kappa > 0 of x'' + kappa x (x^2)^small.
fn power_law(equation: &Expression) -> Option<Rational> {
    let x = Expression::DISPLACEMENT;
    let power = x.clone().pow(2).pow(Expression::Small);
    let others = equation.terms().iter().filter(|term| **term != Expression::ACCELERATION);
    let [Expression::Product(factors)] = &others.collect::<Vec<_>>()[..] else { return None };
    let rest = factors.iter().filter(|f| **f != x && **f != power);
    let stiffness = match &rest.collect::<Vec<_>>()[..] {
        [] => Rational::from(1),
        [Expression::Number(kappa)] if *kappa > 0 => kappa.clone(),
        _ => return None,
    };
    let count = |wanted: &Expression| factors.iter().filter(|f| *f == wanted).count();
    (equation.terms().len() == 2 && count(&x) == 1 && count(&power) == 1).then_some(stiffness)
}

impl Setting {
    /// What [`derive()`] is told.
    pub fn parameters(&self) -> &BTreeMap<String, Exact> {
        &self.parameters
    }

    /// w, where x -> a x, small -> a^-w small leaves the equation that is expanded as it is: the
    /// amplitude then varies with the small parameter alone.
    ///
    /// # Errors
    /// As [`Setting::new`].
    pub fn weight(&self) -> Result<Option<u32>, Error> {
        let settings = Settings {
            condition: Some(self.condition),
            parameters: self.parameters.clone(),
            ..Settings::default()
        };
        Ok(weight(&prepare(&self.problem, &settings)?.problem.equation))
    }

    /// The power of the amplitude in the small parameter, and the parameter beside it, where it has both.
    pub fn factors(&self) -> Option<(&str, u32)> {
        Some((self.small.factor.as_deref()?, self.small.power))
    }

    /// The value of the small parameter, where it is rational.
    pub fn rational_small(&self) -> Option<Rational> {
        let (coefficient, amplitude) =
            (self.small.coefficient.as_rational()?, self.amplitude.as_rational()?);
        let power = rug::ops::Pow::pow(amplitude.clone(), self.small.power);
        Some(coefficient * power)
    }
}
