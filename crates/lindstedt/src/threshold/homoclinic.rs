//! The question `threshold --unknown`: homoclinic orbits to any order, by a nonlinear time.

use crate::refusal::Refused;
use crate::{Answer, Error, Exact, Number, Oscillator, Progress, Work};
use lindstedt_equation::Problem;
use lindstedt_melnikov::Saddle;
use lindstedt_number::rational;
use lindstedt_recognise::SaddleProblem;
use rug::Rational;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// The orbit x = c + sigma sech^p(xi), xi' = omega(tanh xi), p = 2/(k - 1), that leaves the saddle and returns to
/// it, and the parameter mu for which it does: exact coefficients of the powers of the small parameter.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct HomoclinicSeries {
    /// The problem.
    #[serde(skip)]
    pub problem: Problem,
    /// The small parameter.
    pub parameter: String,
    /// The parameter that is sought.
    pub unknown: String,
    /// Its coefficients mu_0, mu_1, ..., by its name.
    pub series: BTreeMap<String, Vec<Number>>,
    /// c, the saddle.
    pub saddle: Exact,
    /// k of y'' = a y + b y^k + ..., x = c + y.
    pub power: u32,
    /// sigma^(k - 1), order by order, to one order more.
    pub amplitude: Vec<Number>,
    /// omega, order by order, to one order more: the coefficient of tanh^m at m.
    pub frequency: Vec<Vec<Exact>>,
    /// What the substitution into the equation left.
    pub residual: HomoclinicResidual,
}

/// The judge of a homoclinic orbit.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct HomoclinicResidual {
    /// The equation of y was satisfied identically at orders 0 to this one.
    pub checked_orders: usize,
    /// True: other orbits are not answered.
    pub zero: bool,
}

impl Oscillator {
    /// The parameter `name` for which the saddle keeps its homoclinic orbit, as a series in the small parameter up
    /// to an order, with the orbit:
    ///
    ///   x'' = f(x) + eps g(x, x'; mu),   f(c + y) = a y + b y^k,   a > 0 the square of a rational number,
    ///
    /// g polynomial, linear in mu, zero at the saddle. Order zero is Melnikov's integral. Exact rational numbers,
    /// substituted back. Cost: O(N^2) products of polynomials of degree O(N) for every term and power of x'.
    ///
    /// # Errors
    /// [`Refused`](crate::Refused) with the term that does not fit; [`Error::Melnikov`] for what is not rational in sech and tanh
    /// on the orbit, and where mu does no work there.
    ///
    /// ```
    /// use lindstedt::{Oscillator, Work};
    /// let takens_bogdanov = Oscillator::parse("x'' = x^2 - 4 + eps*x'*(x + tau)")?;
    /// let found = takens_bogdanov.homoclinic("tau", 2, &Work::default())?.value;
    /// let exact = found.series["tau"].iter().map(|number| number.exact.as_deref());
    /// assert!(exact.eq([Some("10/7"), Some("0"), Some("288/2401")]));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn homoclinic(
        &self,
        name: &str,
        order: usize,
        work: &Work,
    ) -> Result<Answer<HomoclinicSeries>, Error> {
        let start = Instant::now();
        self.single()?;
        self.check_sought(name)?;
        let values = self.form_values(&[])?;
        let found = SaddleProblem::new(self.problem(), &values, name);
        let SaddleProblem { saddle, position } = found.map_err(|why| self.unfit(why))?;
        let orbit =
            saddle.homoclinic(order + 1, &mut |n| work.goes_on(Progress::Order(n - 1, n)))?;
        if !saddle.residual_vanishes(&orbit) {
            return Err(
                lindstedt_melnikov::MelnikovError::WrongOrbit { residual: name.into() }.into()
            );
        }
        let Saddle { power, .. } = saddle;
        let numbers = |list: &[Rational]| {
            list.iter().map(|q| rational(q, work.printed_digits())).collect::<Result<Vec<_>, _>>()
        };
        let done = orbit.unknown.len() - 1;
        let value = HomoclinicSeries {
            problem: self.problem().clone(),
            parameter: self.problem().small.to_string(),
            unknown: name.to_owned(),
            series: [(name.to_owned(), numbers(&orbit.unknown)?)].into(),
            saddle: Exact::Rational(position),
            power,
            amplitude: numbers(&orbit.amplitude)?,
            frequency: orbit.frequency.into_iter().map(exact).collect(),
            residual: HomoclinicResidual { checked_orders: done + 1, zero: true },
        };
        let at = values.into_iter().filter(|(other, _)| other != name);
        let (orders, remarks) = ((order, done, true), self.remarks().to_vec());
        Ok(self.finished(at, orders, "exact", remarks, start).map(|()| value))
    }

    /// That a parameter that is sought occurs, and has no value.
    pub(super) fn check_sought(&self, name: &str) -> Result<(), Error> {
        let refused =
            |message, hint| Err(Refused::usage("unknown-parameter", message, hint).into());
        if !self.problem().equation.parameters().iter().any(|known| known == name) {
            let names = self.problem().equation.parameters().join(", ");
            let message = format!("{name:?} is no parameter of the equation");
            return refused(message, format!("it has {names}"));
        }
        if self.given().contains_key(name) {
            let message = format!("{name} is sought, so it has no value");
            return refused(message, format!("drop --set {name}=..."));
        }
        Ok(())
    }
}

fn exact(list: Vec<Rational>) -> Vec<Exact> {
    list.into_iter().map(Exact::Rational).collect()
}
