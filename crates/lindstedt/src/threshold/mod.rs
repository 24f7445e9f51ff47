//! The threshold of transversal homoclinic points by Melnikov's method.
//!
//! For x'' = f(x) + eps (gamma cos(omega t) - T(x' - v*)) with a homoclinic or heteroclinic orbit of
//! x'' = f(x) the Melnikov function M(t0) = gamma F(omega t0) - D has simple zeros if and only if
//! |gamma| exceeds gamma_c = D/max F (D > 0) or D/min F (D < 0). What f, T and the force are is read
//! off the equation ([`lindstedt_recognise::MelnikovProblem`]), whoever wrote it; an oscillator of the form
//!
//!   x'' = a x - b x^3 + eps (gamma cos(omega t) - T0 sgn w + alpha w - beta w^3),  w = x' - v*,
//!
//! has everything in closed form ([`lindstedt_melnikov::StickSlip`]).

mod homoclinic;
mod orbits;
mod persistence;
mod resonances;
mod splitting;
mod subject;
mod sweep;
mod zeros;

use crate::grid::{Axis, Part};
use crate::refusal::{Refusal, Refused};
use crate::{Answer, Error, Exact, Kind, Number, Oscillator, Remark, Standing, Work};
use lindstedt_equation::print::Style;
use lindstedt_melnikov::Class;
use serde::Serialize;
use std::time::Instant;
use subject::Subject;

pub use homoclinic::{HomoclinicResidual, HomoclinicSeries};
pub use persistence::{Persistence, PersistentOrbit, Persisting};
pub use splitting::{ManifoldPoint, Manifolds, SecondOrderThreshold};
pub use sweep::{Blank, Marks, Sweep};

/// What to say of the threshold besides its value.
///
/// ```
/// use lindstedt::{Oscillator, Threshold, Work};
/// let belt = Oscillator::builtin("stick-slip")?;
/// let question = Threshold { zeros: Some(lindstedt::grid::Axis::ends("vstar=0..1")?), ..Threshold::default() };
/// let answer = belt.set("b", "5")?.threshold(&question, &Work { digits: 12, ..Work::default() })?;
/// assert_eq!(answer.value.gamma_c.decimal, "0.105347876877");
/// assert_eq!(answer.value.zeros.len(), 2);
/// # Ok::<(), lindstedt::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Threshold {
    /// No, one or two swept parameters; the first runs along the columns.
    pub sweep: Vec<Axis>,
    /// The zeros of the signed threshold in a parameter between two values ([`Axis::ends`]).
    pub zeros: Option<Axis>,
    /// The thresholds of the resonances of period 2 pi m/omega, m = 1 ... M.
    pub subharmonics: Option<u32>,
    /// The threshold to second order in the small parameter, gamma_c + slope eps, on every orbit, loops held against
    /// their manifolds: some seconds.
    pub second_order: bool,
    /// Of the rows of a surface only these.
    pub part: Option<Part>,
}

/// The threshold of an oscillator. Closed forms are certified; orbits that are followed
/// numerically and quadratures are estimated.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct HomoclinicThreshold {
    /// gamma_c: of several orbits the least.
    pub gamma_c: Number,
    /// D/F, gamma_c with the sign of D.
    pub signed: Number,
    /// D, the work of friction on the orbit.
    #[serde(rename = "D")]
    pub dissipation: Number,
    /// F > 0, the work of the force of unit amplitude at the best phase.
    #[serde(rename = "F")]
    pub forcing: Number,
    /// V, the largest speed on the orbit.
    #[serde(rename = "V")]
    pub largest_speed: Number,
    /// gamma: the whole coefficient of the lowest harmonic of x''.
    pub amplitude: Exact,
    /// The force that gamma is the amplitude of.
    pub harmonic: Option<Harmonic>,
    /// What was set without an effect, or is zero.
    pub remarks: Vec<Remark>,
    /// The zeros of the signed threshold, if asked for.
    pub zeros: Vec<Number>,
    /// What they are zeros in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zeros_of: Option<ZerosOf>,
    /// Of the closed form with dry friction: the point |v*| = V.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cusp: Option<Cusp>,
    /// All orbits, right before left, upper before lower; empty for the closed form, whose two
    /// loops are mirror images.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub orbits: Vec<Orbit>,
    /// The resonances that exist, if asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub subharmonics: Option<Vec<Resonance>>,
    /// To second order in the small parameter, if asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub second_order: Vec<SecondOrderThreshold>,
    /// Whether there are transversal homoclinic points at gamma.
    pub homoclinic_points: Crossing,
    /// Whether the theory can be believed there.
    pub validity: Validity,
    /// The curve or the surface, if asked for.
    #[serde(flatten, serialize_with = "sweep::keys")]
    pub sweep: Option<Sweep>,
}

/// The lowest harmonic force in the symbols of the problem.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Harmonic {
    /// cos(omega t + phase), or with a factor x.
    pub term: String,
    /// Its whole coefficient on the right of x'' = ..., which gamma_c is a value of.
    pub coefficient: String,
    /// Coefficient and term in LaTeX.
    #[serde(skip)]
    pub latex: [String; 2],
    /// The parameter that the coefficient is a multiple of, where there is just one.
    pub parameter: Option<String>,
    /// gamma_c as a value of that parameter.
    pub threshold: Option<Number>,
}

/// The parameter of a list of zeros.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct ZerosOf {
    /// Its name.
    pub parameter: String,
    /// Whole intervals of zeros, beside the single ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub intervals: Vec<[Number; 2]>,
    /// Whether there are provably no others; else they are the changes of sign on a grid.
    pub complete: bool,
}

/// Where the belt is as fast as the mass on its loop.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Cusp {
    /// |v*| = V.
    pub vstar: Number,
    /// The signed threshold there.
    pub signed: Number,
    /// The b at which it vanishes.
    pub touches_zero_at_b: Option<Exact>,
}

/// The threshold on one orbit.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Orbit {
    /// Which; with its saddle where there are several.
    pub name: String,
    /// gamma_c.
    pub gamma_c: Number,
    /// D/F.
    pub signed: Number,
    /// How the orbit was checked.
    pub check: Option<String>,
    /// With several saddles: whether this is the least threshold.
    pub least: Option<bool>,
}

/// A resonance of period 2 pi m/omega.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Resonance {
    /// m.
    pub m: u32,
    /// `one well` or `both wells`.
    pub around: &'static str,
    /// Its threshold.
    pub gamma_c: Number,
    /// D.
    #[serde(rename = "D")]
    pub dissipation: Number,
    /// F.
    #[serde(rename = "F")]
    pub forcing: Number,
    /// k of the elliptic functions.
    pub modulus: Number,
}

/// Whether stable and unstable manifold cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Crossing {
    /// |gamma| > gamma_c.
    Crossing,
    /// |gamma| < gamma_c, or nothing is perturbed.
    None,
    /// |gamma| = gamma_c as far as is known.
    Undecided,
}

impl Crossing {
    /// As in JSON.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::None => "none",
            Self::Undecided => "undecided",
        }
    }
}

/// What first order is worth.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Validity {
    /// In words.
    pub verdict: &'static str,
    /// |v*|.
    pub distance_to_saddle: Number,
    /// ||v*| - V|.
    pub distance_to_tangency: Number,
}

impl Oscillator {
    /// The threshold of homoclinic chaos by Melnikov's method, its zeros, curves and surfaces.
    ///
    /// Digits are those of `work`; with `doubles` a sweep of a closed form is computed in doubles,
    /// as are more than 20 000 points of it. Cost: milliseconds for a closed form, seconds for an
    /// orbit that has to be followed.
    ///
    /// # Errors
    /// [`Refused`] with the term that does not fit, [`Error::Melnikov`], [`DerivationError::NotEnoughBits`](crate::DerivationError::NotEnoughBits).
    ///
    /// ```
    /// use lindstedt::{Oscillator, Threshold, Work};
    /// let pendulum = Oscillator::parse("x'' + sin(x) = eps*(cos(t) - x')")?;
    /// let answer = pendulum.threshold(&Threshold::default(), &Work::default())?;
    /// // 4 cosh(pi/2)/pi
    /// assert!(answer.value.gamma_c.decimal.starts_with("3.19478526382585"));
    /// # Ok::<(), lindstedt::Error>(())
    /// ```
    pub fn threshold(
        &self,
        question: &Threshold,
        work: &Work,
    ) -> Result<Answer<HomoclinicThreshold>, Error> {
        let start = Instant::now();
        let axes = question.sweep.iter().chain(&question.zeros);
        let (case, mut remarks) = self.at_beginnings(axes);
        let subject = Subject::new(&case, work)?;
        let swept = subject.swept(&question.sweep)?;
        let zeros = question.zeros.as_ref().map(|ends| subject.range(ends)).transpose()?;
        let mut value = orbits::measure(&subject).map_err(|error| stopped(error, work))?;
        if let Some(range) = zeros {
            let zeros::Zeros { list, intervals, complete } = zeros::list(&subject, &range)?;
            value.zeros = list;
            value.zeros_of = Some(ZerosOf { parameter: range.axis.name, intervals, complete });
        }
        if let Some(largest) = question.subharmonics {
            value.subharmonics = Some(resonances::list(&subject, largest)?);
        }
        if question.second_order {
            let mut first: Vec<&Number> = value.orbits.iter().map(|orbit| &orbit.gamma_c).collect();
            if first.is_empty() {
                first.push(&value.gamma_c);
            }
            let list = splitting::list(&subject, &first);
            value.second_order = list.map_err(|error| stopped(error, work))?;
        }
        value.sweep = sweep::compute(&subject, swept, question.part)?;
        value.remarks = subject.remarks(&value);
        remarks.extend_from_slice(self.remarks());
        let mut standing = Standing::Complete;
        if let Some(grid) = value.sweep.as_ref().map(|sweep| &sweep.grid)
            && work.stop.asked()
        {
            standing = Standing::Stopped { done: grid.done() };
            remarks.push(Remark("stopped; the rows not reached are missing".to_owned()));
        }
        let followed = value.second_order.iter().filter(|orbit| orbit.manifolds.is_some()).count();
        if standing == Standing::Complete
            && followed < value.second_order.len()
            && work.stop.asked()
        {
            standing = Standing::Stopped { done: followed };
            remarks.push(Remark("stopped; manifolds not followed are missing".to_owned()));
        }
        if !remarks.is_empty() {
            remarks.extend(value.remarks.iter().cloned());
        }
        let tier = match subject.found.class() {
            Class::Certified => "certified",
            Class::Estimated => "estimated",
        };
        let header = case.header(case.all_values(), None, tier, start);
        Ok(Answer { header, value, standing, remarks })
    }
}

/// An orbit that was not followed to its end looks undecided.
fn stopped(error: Error, work: &Work) -> Error {
    if error.kind() == Kind::Undecided && work.stop.asked() {
        let message = "stopped before the threshold was found";
        return Refused::stopped(message, "fewer --digits take less time").into();
    }
    error
}

impl Subject<'_> {
    /// That the small parameter was set, forces that are zero, whose numbers these are.
    fn remarks(&self, value: &HomoclinicThreshold) -> Vec<Remark> {
        let mut list = Vec::new();
        let small = &self.oscillator.problem().small;
        if self.oscillator.given().contains_key(&**small) {
            list.push(if self.found.jumps() {
                format!(
                    "{small} takes no part in gamma_c (of first order in it), only in the verdict \
                     on validity"
                )
            } else {
                format!("{small} has no effect: gamma_c is of first order in it")
            });
        }
        for force in self.lowest.iter().flat_map(|lowest| &lowest.silent) {
            let force = force.print(small, Style::Text);
            list.push(format!("{force} is zero at these values and left out"));
        }
        if let Some(least) = value.orbits.iter().find(|orbit| orbit.least == Some(true)) {
            list.push(format!(
                "orbits of several saddles: gamma_c is the least of them; V and the validity are \
                 those of the {}",
                value.orbits.first().map_or(&*least.name, |orbit| &orbit.name)
            ));
        }
        list.into_iter().map(Remark).collect()
    }
}
