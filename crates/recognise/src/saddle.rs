//! x'' = f(x) + eps g(x, x'; mu) about its saddle: y'' = a y + b y^k + eps ..., x = c + y.

use crate::bound::{bind, missing, multiply_out, named, rest};
use crate::refusal::{Refusal, Why};
use lindstedt_equation::classify::rational_root;
use lindstedt_equation::monomials::{Monomial, Monomials};
use lindstedt_equation::{Expression, Problem};
use lindstedt_melnikov::{LARGEST_DEGREE, PerturbationTerm, Saddle};
use lindstedt_number::Exact;
use rug::Rational;
use std::collections::BTreeMap;

/// A problem in the form of [`Saddle`].
///
/// ```
/// use lindstedt_problem_file::ProblemFile;
/// use lindstedt_recognise::SaddleProblem;
///
/// let file = ProblemFile::parse("equation = \"x'' = x^2 - 4 + eps*x'*(x + tau)\"")?;
/// let found = SaddleProblem::new(&file.problem, &Default::default(), "tau")?;
/// assert_eq!((found.position.to_f64(), found.saddle.slope.to_f64()), (2.0, 4.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SaddleProblem {
    /// The equation of y.
    pub saddle: Saddle,
    /// c in x = c + y.
    pub position: Rational,
}

/// The coefficients of x^i x'^j: without the unknown parameter, and of it.
type Perturbation = BTreeMap<(u32, u32), [Rational; 2]>;

impl SaddleProblem {
    /// Reads the equation with the values of its parameters, but for the one that is sought.
    ///
    /// # Errors
    /// [`Refusal`], naming the term that does not fit.
    pub fn new(
        problem: &Problem,
        values: &BTreeMap<String, Exact>,
        unknown: &str,
    ) -> Result<Self, Refusal> {
        if problem.impact.is_some() {
            return Err(Refusal::Wall);
        }
        let rest = rest(problem)?;
        let mut values = values.clone();
        values.remove(unknown);
        let needed: Vec<_> = rest.parameters().into_iter().filter(|name| name != unknown).collect();
        missing(&needed, &values)?;
        let all = multiply_out(&bind(&rest, &values))?;
        let mut force = vec![Rational::new()];
        let mut perturbation = Perturbation::new();
        for (m, q) in &all.terms {
            let place = place(&all, m, unknown).map_err(|why| {
                // Without values the other parameters are numbers, too.
                let fits = |all: &Monomials, m: &Monomial| {
                    let mut m = m.clone();
                    m.parameters.retain(|name, _| name == unknown);
                    place(all, &m, unknown).err()
                };
                named(&rest, &values, (all.tree(m, q), why), &fits)
            })?;
            match place {
                None => {
                    let degree = m.x as usize;
                    force.resize(force.len().max(degree + 1), Rational::new());
                    force[degree] -= q;
                }
                Some(part) => perturbation.entry((m.x, m.velocity)).or_default()[part] -= q,
            }
        }
        let (position, force) = about_saddle(&force).ok_or(Refusal::NoSaddleForm)?;
        let perturbation = about(&perturbation, &position);
        if perturbation.iter().any(|term| term.position + term.velocity == 0) {
            return Err(Refusal::MovesSaddle { position: position.to_string() });
        }
        let power = force.len() - 1;
        let [slope, leading] = [1, power].map(|k| force[k].clone());
        let power = u32::try_from(power).map_err(|_| Refusal::NoSaddleForm)?;
        let returns = slope > 0 && leading != 0 && (power.is_multiple_of(2) || leading < 0);
        let saddle = Saddle { slope, power, leading, perturbation };
        if returns { Ok(Self { saddle, position }) } else { Err(Refusal::NoSaddleForm) }
    }
}

/// Where a term belongs: to the force f (nothing), to the perturbation, without (0) or with (1) the unknown.
fn place(all: &Monomials, m: &Monomial, unknown: &str) -> Result<Option<usize>, Why> {
    if !m.atoms.is_empty() || m.x.max(m.velocity) as usize > LARGEST_DEGREE {
        let mut atoms = m.atoms.keys().filter_map(|key| all.atoms.get(key));
        let late = atoms.any(|atom| atom.find(&Expression::is_delayed).is_some());
        return Err(if late { Why::Delay } else { Why::NotPolynomial });
    }
    let part = match m.parameters.iter().collect::<Vec<_>>()[..] {
        [] => 0,
        [(name, 1)] if name == unknown => 1,
        _ if m.parameters.contains_key(unknown) => return Err(Why::NotLinearUnknown),
        _ => return Err(Why::NotRational),
    };
    match (m.order, m.velocity, part) {
        (0, 0, 0) => Ok(None),
        (0, ..) => Err(Why::NotSmall),
        (1, ..) => Ok(Some(part)),
        _ => Err(Why::HigherOrder),
    }
}

/// c with f(c + y) = a y + b y^k, and that polynomial in y.
fn about_saddle(f: &[Rational]) -> Option<(Rational, Vec<Rational>)> {
    let degree = f.iter().rposition(|q| !q.is_zero()).filter(|k| *k >= 2)?;
    let leading = &f[degree];
    let centre = if degree == 2 {
        // Of the two zeros the one at which f rises.
        let square = Rational::from(f[1].square_ref()) - Rational::from(&f[0] * leading) * 4u32;
        (rational_root(&square)? - &f[1]) / leading / 2u32
    } else {
        -Rational::from(&f[degree - 1] / leading) / Rational::from(degree as u64)
    };
    let shifted: Vec<_> = (0..=degree).map(|m| derivative_over_factorial(f, m, &centre)).collect();
    let form = |(k, q): (usize, &Rational)| k == 1 || k == degree || q.is_zero();
    shifted.iter().enumerate().all(form).then_some((centre, shifted))
}

/// f^(m)(c)/m! = sum_k binomial(k, m) f_k c^(k - m).
fn derivative_over_factorial(f: &[Rational], m: usize, c: &Rational) -> Rational {
    f.iter().enumerate().skip(m).rev().fold(Rational::new(), |sum, (k, q)| {
        sum * c + q * Rational::from(rug::Integer::from(k).binomial(u32::try_from(m).unwrap_or(0)))
    })
}

/// The perturbation in powers of y = x - c.
fn about(terms: &Perturbation, centre: &Rational) -> Vec<PerturbationTerm> {
    let mut found = Vec::new();
    let mut velocities: Vec<u32> = terms.keys().map(|(_, velocity)| *velocity).collect();
    velocities.dedup();
    velocities.sort_unstable();
    velocities.dedup();
    for velocity in velocities {
        let degree = terms.keys().filter(|(_, v)| *v == velocity).map(|(x, _)| *x).max();
        let polynomial = |part: usize| -> Vec<Rational> {
            let of = |x| terms.get(&(x, velocity)).map(|parts| parts[part].clone());
            (0..=degree.unwrap_or(0)).map(|x| of(x).unwrap_or_default()).collect()
        };
        let (known, unknown) = (polynomial(0), polynomial(1));
        for position in 0..=degree.unwrap_or(0) {
            let of = |f: &[Rational]| derivative_over_factorial(f, position as usize, centre);
            let (known, unknown) = (of(&known), of(&unknown));
            if !known.is_zero() || !unknown.is_zero() {
                found.push(PerturbationTerm { position, velocity, known, unknown });
            }
        }
    }
    found
}
