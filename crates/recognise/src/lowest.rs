//! Which term of an equation the threshold is about: its lowest harmonic force, with the coefficient
//! as it is written.

use crate::bound::{bind, rest};
use crate::forces::{Kind, Place, frequency, harmonic_atom, kind};
use crate::in_pi::InPi;
use lindstedt_equation::monomials::{Monomial, Monomials, expand};
use lindstedt_equation::{Expression, Problem};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::{BTreeMap, BTreeSet};

/// The lowest harmonic force of x'' = f(x) + eps (gamma cos(omega t + phase) + ...): what gamma and
/// its threshold are in the symbols of the problem.
///
/// ```
/// use lindstedt_number::Exact;
/// use lindstedt_problem_file::ProblemFile;
/// use lindstedt_recognise::LowestHarmonic;
///
/// let file = ProblemFile::parse(
///     r#"
///     name = "pendulum"
///     equation = "m x'' + m sin x = eps (gamma cos(omega t) - delta x')"
///     condition = []
///     [parameters]
///     m = {}
///     gamma = {}
///     omega = {}
///     delta = {}
///     "#,
/// )?;
/// let values = [("m", 2), ("gamma", 1), ("omega", 1), ("delta", 1)];
/// let values = values.map(|(name, value)| (name.to_owned(), Exact::from(value)));
/// let found = LowestHarmonic::find(&file.problem, &values.into()).expect("there is a force");
/// let (name, factor) = found.parameter.expect("it is gamma/m");
/// assert_eq!((name.as_str(), factor.to_f64()), ("gamma", 0.5));
/// # Ok::<(), lindstedt_problem_file::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LowestHarmonic {
    /// g(x) cos(omega t + phase).
    pub term: Expression,
    /// Its whole coefficient on the right of x'' = ..., without the small parameter.
    pub coefficient: Expression,
    /// Where the coefficients of all forces are multiples of just one parameter, which occurs
    /// nowhere else: its name, and the factor of it in `coefficient`.
    pub parameter: Option<(String, Exact)>,
    /// Forces whose coefficient is zero at the values, with that coefficient.
    pub silent: Vec<Expression>,
}

/// The terms with one harmonic function.
#[derive(Debug)]
pub(crate) struct Force {
    /// g(x) cos(omega t + phase).
    term: Expression,
    /// |omega|, and what orders forces of one frequency.
    frequency: f64,
    place: Place,
    terms: Vec<(Monomial, Rational)>,
}

/// The harmonic forces of an equation without values, by frequency; nothing if one has none.
pub(crate) fn forces(all: &Monomials, values: &BTreeMap<String, Exact>) -> Option<Vec<Force>> {
    let mut list: Vec<Force> = Vec::new();
    for (m, q) in &all.terms {
        if !matches!(kind(all, m), Ok(Kind::Harmonic)) {
            continue;
        }
        let (name, atom) = harmonic_atom(all, m)?;
        let key_of =
            |atom: &Expression| Some(expand(&bind(atom, values))?.atoms.keys().next()?.clone());
        let mut others = Vec::new();
        for (other, n) in m.atoms.iter().filter(|(other, _)| *other != name) {
            others.push((key_of(all.atoms.get(other)?)?, *n));
        }
        let place = (m.x, others, key_of(atom)?);
        let known = list.iter().position(|force| force.place == place);
        let index = match known {
            Some(index) => index,
            None => {
                let frequency = frequency(&bind(atom, values))?.to_f64().abs();
                let bare = Monomial { order: 0, parameters: BTreeMap::new(), ..m.clone() };
                let term = all.tree(&bare, &Rational::from(1)).canonical();
                list.push(Force { term, frequency, place, terms: Vec::new() });
                list.len() - 1
            }
        };
        list.get_mut(index)?.terms.push((m.clone(), Rational::from(-q)));
    }
    // The order of the bound equation.
    list.sort_by(|a, b| a.frequency.total_cmp(&b.frequency).then_with(|| a.place.cmp(&b.place)));
    Some(list)
}

impl Force {
    fn coefficient(&self, all: &Monomials) -> Expression {
        let constant = |(m, q): &(Monomial, Rational)| {
            let bare = Monomial { parameters: m.parameters.clone(), ..Monomial::default() };
            all.tree(&bare, q)
        };
        Expression::Sum(self.terms.iter().map(constant).collect()).canonical()
    }

    /// Whether it does not depend on x.
    pub fn is_plain(&self) -> bool {
        self.place.0 == 0 && self.place.1.is_empty()
    }

    fn is_silent(&self, all: &Monomials, values: &BTreeMap<String, Exact>) -> bool {
        InPi::of(&bind(&self.coefficient(all), values)).is_some_and(|c| c.is_zero())
    }

    /// Whether every term is a multiple of the parameter, and depends on it in no other way.
    fn is_multiple(&self, all: &Monomials, name: &str) -> bool {
        let symbol = Expression::parameter(name);
        self.terms.iter().all(|(m, _)| {
            let inside = |key: &String| all.atoms.get(key).is_some_and(|e| e.contains(&symbol));
            m.parameters.get(name) == Some(&1)
                && !m.parameters.keys().any(inside)
                && !m.atoms.keys().any(inside)
        })
    }
}

/// The parameters of which all forces are multiples.
pub(crate) fn common(all: &Monomials, forces: &[Force]) -> Vec<String> {
    let names: BTreeSet<&String> = forces
        .iter()
        .flat_map(|force| force.terms.iter().flat_map(|(m, _)| m.parameters.keys()))
        .collect();
    let multiple = |name: &&String| forces.iter().all(|force| force.is_multiple(all, name));
    names.into_iter().filter(multiple).cloned().collect()
}

impl LowestHarmonic {
    /// Reads the equation of a problem; nothing where it has no such force.
    #[must_use]
    pub fn find(problem: &Problem, values: &BTreeMap<String, Exact>) -> Option<Self> {
        let all = expand(&rest(problem).ok()?)?;
        let (silent, sounding): (Vec<Force>, Vec<Force>) =
            forces(&all, values)?.into_iter().partition(|force| force.is_silent(&all, values));
        let whole = |force: &Force| (force.coefficient(&all) * force.term.clone()).canonical();
        let mut unheard: Vec<Expression> = silent.iter().map(whole).collect();
        let heard = if sounding.is_empty() {
            unheard.clear();
            silent
        } else {
            sounding
        };
        let lowest = heard.first()?;
        let coefficient = lowest.coefficient(&all);
        let symbols = common(&all, &heard);
        let others = |name: &String| {
            let symbol = Expression::parameter(name);
            let is_force = |m: &Monomial| matches!(kind(&all, m), Ok(Kind::Harmonic));
            !all.terms.iter().any(|(m, q)| !is_force(m) && all.tree(m, q).contains(&symbol))
        };
        let parameter = match symbols.as_slice() {
            [name] if others(name) => {
                let mut unit = values.clone();
                unit.insert(name.clone(), Exact::Rational(Rational::from(1)));
                let factor = InPi::of(&bind(&coefficient, &unit)).and_then(|c| c.value());
                let factor = factor.filter(|factor| factor.sign().is_ne());
                factor.map(|factor| (name.clone(), factor))
            }
            _ => None,
        };
        Some(Self { term: lowest.term.clone(), coefficient, parameter, silent: unheard })
    }
}
