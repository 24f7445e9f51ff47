//! What to do about a term that no ring contains: the verbs that take the equation as it is, and the form that the
//! expansion takes, which is tried before it is named.

use lindstedt_derivation::known_values;
use lindstedt_equation::classify::{Classification, Method, Reason, classify, evaluate};
use lindstedt_equation::monomials::{Monomials, expand};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function, Problem};
use lindstedt_problem_file::{ProblemFile, parse_expression};
use rug::Rational;
use std::collections::BTreeMap;

/// Of a term that is not smooth or no polynomial.
pub(crate) fn in_numbers(parts: &Classification, file: &ProblemFile, reason: &Reason) -> String {
    let problem = &file.problem;
    if let Some(law) = power_law(problem) {
        return law;
    }
    let mut routes = Vec::new();
    if let Reason::NotPolynomial(e) = reason {
        routes.extend(polynomial(file, e));
        let sine = Expression::DISPLACEMENT.apply(Function::Sin);
        if problem.equation.canonical() == (Expression::ACCELERATION + sine).canonical() {
            routes.push("the built-in `pendulum` is this equation".to_owned());
        }
        routes.push("`evaluate --prove` where it is smooth".to_owned());
    }
    let velocity = problem.equation.contains(&Expression::VELOCITY);
    let autonomous = parts.forcing.is_empty() && parts.delays.is_empty() && !parts.impact;
    let weak = parts.strong.is_empty() && parts.stiffness != Expression::integer(0);
    if weak && autonomous && velocity {
        routes.push("`evaluate --cycles AMPLITUDE` averages it to first order".to_owned());
    } else if weak && autonomous {
        routes.push("`derive --tier collocation` in numbers".to_owned());
    }
    routes.push("`lindstedt simulate` takes it as it is".to_owned());
    routes.join("; ")
}

/// The built-in problem of x'' + c |x|^p sign(x) = 0, where that is the equation.
pub(super) fn power_law(problem: &Problem) -> Option<String> {
    let terms = problem.equation.canonical();
    let mut terms = terms.terms().iter().filter(|term| **term != Expression::ACCELERATION);
    let (Some(term), None) = (terms.next(), terms.next()) else { return None };
    let factors = term.factors().iter().filter(|factor| !factor.is_constant());
    let (mut exponent, mut odd) = (Some(Rational::new()), false);
    for factor in factors {
        let (p, is_odd) = power(factor)?;
        exponent = exponent.zip(p).map(|(sum, p)| sum + p);
        odd ^= is_odd;
    }
    let constant = term.factors().iter().filter(|factor| factor.is_constant()).cloned();
    let values = known_values(problem, &BTreeMap::new());
    let constant = evaluate(&Expression::Product(constant.collect()), &values);
    let outside = exponent.as_ref().is_some_and(|p| *p <= -1 || *p == 1);
    if !odd || outside || constant.is_some_and(|c| c <= 0) {
        return None;
    }
    let delta = exponent.map(|p| (p - Rational::from(1)) / Rational::from(2));
    let delta = delta.map_or("VALUE".to_owned(), |delta| delta.to_string());
    Some(format!(
        "`evaluate power-law --set delta={delta}` has the periods, with 1 for a factor: sign(x)*abs(x)^p is x*(x^2)^delta with \
         delta = (p - 1)/2; `lindstedt simulate` follows motions"
    ))
}

/// q, where it has a value, of |x|^q or sign(x) |x|^q, and whether it is the latter: a root of x stands for that of an odd
/// force.
fn power(e: &Expression) -> Option<(Option<Rational>, bool)> {
    let one = || Some((Some(Rational::from(1)), true));
    match e {
        e if *e == Expression::DISPLACEMENT => one(),
        Expression::Function(Function::Sign, z) if **z == Expression::DISPLACEMENT => {
            Some((Some(Rational::new()), true))
        }
        Expression::Function(Function::Abs, z) => Some((power(z)?.0, false)),
        Expression::Power(base, exponent) => {
            let (q, is_odd) = power(base)?;
            let n = exponent.as_number();
            let even = n.as_ref().is_some_and(|n| n.is_integer() && n.numer().is_even());
            Some((q.zip(n).map(|(q, n)| q * n), is_odd && !even))
        }
        _ => None,
    }
}

/// The Taylor polynomial that the expansion takes in the place of a function: as it stands, or with a factor of the small
/// parameter on all but the linear part of it.
pub(super) fn polynomial(file: &ProblemFile, e: &Expression) -> Option<String> {
    let small = &file.problem.small;
    let shown = e.print(small, Style::Text);
    let text = format!("taylor({shown}, 9)");
    let polynomial = parse_expression(&text, &file.names).ok()?;
    if expands(&file.problem, e, &polynomial) {
        return Some(format!("{text} in the place of {shown}, its Taylor polynomial"));
    }
    let mut all: Monomials = expand(&polynomial)?;
    all.terms.retain(|m, _| m.order == 0 && (m.is_power(1, 0) || m.is_power(0, 0)));
    let linear: Vec<_> = all.terms.iter().map(|(m, q)| all.tree(m, q)).collect();
    let linear = Expression::Sum(linear).canonical();
    let rest = Expression::Small * (polynomial - linear.clone());
    expands(&file.problem, e, &(linear.clone() + rest)).then(|| {
        let part = linear.print(small, Style::Text);
        let taken = match linear.terms() {
            [_] => part.clone(),
            _ => format!("({part})"),
        };
        format!(
            "({part} + {small}*({text} - {taken})) in the place of {shown}, with {small} = 1, is taken"
        )
    })
}

/// The same of what is divided by the small parameter, a function of a multiple of it.
pub(super) fn divided(file: &ProblemFile) -> Option<String> {
    let functions = file.problem.equation.nodes();
    let mut functions = functions.filter(|e| matches!(e, Expression::Function(..)));
    functions.find_map(|e| polynomial(file, e))
}

/// Whether nothing is against the weakly nonlinear form of the equation with one expression in the place of another, other
/// functions apart.
fn expands(problem: &Problem, e: &Expression, instead: &Expression) -> bool {
    let mut changed = problem.clone();
    let equation = problem.equation.smooth_powers().canonical();
    let equation = equation.map(&|part| (part == e).then(|| instead.clone()));
    changed.equation = equation.without_small_divisors();
    let Ok(parts) = classify(&changed, &known_values(problem, &BTreeMap::new())) else {
        return false;
    };
    let allowed = |reason: &Reason| {
        use Reason::{Condition, Drift, Forced, NotPolynomial};
        matches!(reason, Condition | Drift(_) | Forced(_) | NotPolynomial(_))
    };
    let mut methods = parts.methods.iter();
    methods.any(|(m, against)| *m == Method::LindstedtPoincare && against.iter().all(allowed))
}
