//! The series of a problem at a point: what is summed, in which variable, and what the period
//! is by a closed form.

use crate::setting::{Form, Setting};
use crate::{closed, coefficients};
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_derivation::{Derivation, DerivationError as Error, Progress, refuse_above};
use lindstedt_equation::Quantity;
use lindstedt_number::Exact;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_series::resummation::{Growth, Sample, UniformMap, growth};
use rayon::prelude::*;
use rug::{Float, Rational};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A formula for a value.
pub type Formula = Box<dyn Fn(Balls) -> Option<Ball> + Send + Sync>;
/// Coefficients to so many bits.
pub type Coefficients = Box<dyn Fn(u32) -> Option<Vec<Float>> + Send + Sync>;

/// The series of T/2pi = factor * sum t_n x^n at a point.
pub struct Source {
    /// The variable x of the series as it is printed.
    pub variable: String,
    /// The parameters, as they stand.
    pub at: Vec<(String, Exact)>,
    /// The number of coefficients t_n.
    pub known: usize,
    /// t_n to so many bits.
    pub coefficients: Coefficients,
    /// x.
    pub point: Formula,
    /// The factor in front.
    pub factor: Formula,
    /// The period in closed form, with its formula.
    pub closed: Option<(String, Formula)>,
    /// What is proved about the radius of convergence: its value, and why.
    pub radius: Option<(f64, &'static str)>,
    /// Orders 0, 1, ... of the Floquet exponent of a limit cycle; else empty.
    pub exponent: Vec<Rational>,
    /// The change of variable u = x/(scale + x).
    map: Option<ChangeOfVariable>,
    /// The coefficient of small^(n step) in T/2pi over the factor is t_n ratio^(n step).
    pub step: usize,
    /// See `step`.
    pub ratio: Rational,
}

/// The methods of summation ask for the same precisions: each sample is computed once.
pub(crate) fn remembered(
    compute: impl Fn(u32) -> Option<Sample>,
) -> impl Fn(u32) -> Option<Sample> {
    let known: RefCell<BTreeMap<u32, Sample>> = RefCell::default();
    move |bits| {
        if let Some(sample) = known.borrow().get(&bits) {
            return Some(sample.clone());
        }
        let sample = compute(bits)?;
        known.borrow_mut().insert(bits, sample.clone());
        Some(sample)
    }
}

/// u = x/(scale + x), and the power of x that f is compared with.
struct ChangeOfVariable {
    scale: Rational,
    prefactor: Rational,
    radius: Option<f64>,
}

impl Source {
    /// The series of a problem to an order in its small parameter.
    ///
    /// x'' + kappa x (x^2)^delta and x'' + x S(delta ln x^2) have their coefficients by the energy
    /// integral when asked for, in O(N^2) and O(N^4/6) products; everything else is derived here.
    ///
    /// # Errors
    /// [`Error::OutsideDomain`] beyond a separatrix, and those of [`lindstedt_derivation::derive()`].
    pub fn new(
        setting: &Setting,
        order: usize,
        (memory, stop): (u64, &Stop),
        observer: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Self, Error> {
        match &setting.form {
            Form::PowerLaw { stiffness } => power_law(setting, stiffness, order, stop),
            Form::Sums => Ok(sums(setting, order, stop)),
            Form::Cubic { stiffness, coefficient } => {
                let ratio = Rational::from(coefficient / stiffness);
                let closed = cubic(setting, stiffness, &ratio)?;
                let series = Series::new(setting.derive(order, (memory, stop), observer)?)?;
                Ok(closed.finish(setting, series))
            }
            _ => {
                let series = Series::new(setting.derive(order, (memory, stop), observer)?)?;
                Ok(derived(setting, series))
            }
        }
    }

    /// A source without coefficients of its own, about which nothing is known.
    pub fn plain(setting: &Setting) -> Self {
        let point = setting.clone();
        Self {
            variable: setting.small.name.clone(),
            at: setting.at.clone(),
            known: 0,
            coefficients: Box::new(|_| None),
            point: Box::new(move |balls| Some(point.small(balls))),
            factor: Box::new(|balls| Some(balls.one())),
            closed: None,
            radius: None,
            exponent: Vec::new(),
            map: None,
            step: 1,
            ratio: Rational::from(1),
        }
    }

    /// The sample at a precision.
    pub fn sample(&self, bits: u32) -> Option<Sample> {
        self.sample_of((self.coefficients)(bits)?, bits)
    }

    /// The sample with coefficients from elsewhere.
    pub fn sample_of(&self, coefficients: Vec<Float>, bits: u32) -> Option<Sample> {
        let point = (self.point)(Balls::new(bits).with_guard(64))?;
        let map = self.map.as_ref().map(|map| UniformMap {
            scale: Float::with_val(bits, &map.scale),
            prefactor: Float::with_val(bits, &map.prefactor),
            radius: map.radius,
        });
        Some(Sample {
            coefficients,
            point: Float::with_val(bits, point.midpoint()),
            map,
            radius: self.radius.map(|(radius, _)| radius),
            bits,
        })
    }
}

fn outside(name: &str, value: &Ball, domain: &'static str) -> Error {
    let value = value.midpoint().to_f64().to_string();
    Error::OutsideDomain { name: name.to_owned(), value, domain }
}

fn power_law(
    setting: &Setting,
    stiffness: &Rational,
    order: usize,
    stop: &Stop,
) -> Result<Source, Error> {
    let probe = Balls::new(200);
    let delta = setting.small(probe);
    if !probe.add(&probe.one(), &delta).is_positive() {
        return Err(outside(&setting.problem.small, &delta, "greater than -1"));
    }
    // MPFR's exponents end at 2^30: beyond, no precision gives a^delta.
    let power = probe.ln(&setting.amplitude.ball(probe)).map(|log| probe.mul(&log, &delta));
    if power.is_none_or(|power| power.abs_upper() > 7e8) {
        let amplitude = setting.amplitude.to_string();
        return Err(Error::OutsideDomain {
            name: format!("amplitude^{}", setting.problem.small),
            value: format!("({amplitude})^({:.3e})", delta.midpoint().to_f64()),
            domain: "between 10^(-3*10^8) and 10^(3*10^8)",
        });
    }
    let (factor, closed, point) = (setting.clone(), setting.clone(), setting.clone());
    let root = {
        let stiffness = stiffness.clone();
        move |balls: Balls| balls.sqrt(&balls.from_rational(&stiffness))
    };
    let (divisor, stop, asked) = (root.clone(), stop.clone(), stop.clone());
    let mut text = "4*sqrt(pi*(1+delta))*Gamma(1+y)/Gamma(1/2+y)*a^(-delta), y = 1/(2+2*delta)"
        .replace("delta", &setting.problem.small);
    if *stiffness != 1 {
        text = format!("({stiffness})^(-1/2)*{text}");
    }
    Ok(Source {
        variable: setting.small.name.clone(),
        at: setting.at.clone(),
        known: order + 1,
        coefficients: Box::new(move |bits| coefficients::power_law(order, bits, &stop)),
        point: Box::new(move |balls| Some(point.small(balls))),
        factor: Box::new(move |balls| {
            let log = balls.ln(&factor.amplitude.ball(balls))?;
            let power = balls.exp(&balls.neg(&balls.mul(&log, &factor.small(balls))));
            balls.div(&power, &root(balls)?)
        }),
        closed: Some((
            text,
            Box::new(move |balls| {
                let (delta, a) = (closed.small(balls), closed.amplitude.ball(balls));
                let rational = closed.small_rational();
                let period = closed::power_law(balls, &delta, rational, &a, &asked)?;
                balls.div(&period, &divisor(balls)?)
            }),
        )),
        radius: Some((1.0, "the period is singular at delta = -1")),
        // sqrt(1 - u) T/2pi = Gamma(2-u) 2^u/Gamma(1-u/2)^2 has its nearest pole at u = 3.
        exponent: Vec::new(),
        map: Some(ChangeOfVariable {
            scale: Rational::from(1),
            prefactor: Rational::from((1, 2)),
            radius: Some(3.0),
        }),
        step: 1,
        ratio: Rational::from(1),
    })
}

fn sums(setting: &Setting, order: usize, stop: &Stop) -> Source {
    let stop = stop.clone();
    let amplitude = setting.amplitude.clone();
    let point = setting.clone();
    // The whole sine at delta = 1.
    let probe = Balls::new(200);
    let whole = setting.small(probe).is_exact() && *setting.small(probe).midpoint() == 1;
    let closed = whole.then(|| {
        let amplitude = amplitude.clone();
        let formula = move |balls: Balls| closed::pendulum(balls, &amplitude.ball(balls));
        ("4*K(k), k = sin(a/2)".to_owned(), Box::new(formula) as Formula)
    });
    Source {
        variable: setting.small.name.clone(),
        at: setting.at.clone(),
        known: order + 1,
        coefficients: Box::new(move |bits| {
            coefficients::pendulum(&|balls| amplitude.ball(balls), order, bits, &stop)
        }),
        point: Box::new(move |balls| Some(point.small(balls))),
        factor: Box::new(|balls| Some(balls.one())),
        closed,
        // int x^(1 + 2 k delta) dx: a pole of the potential for every k.
        radius: Some((0.0, "the potential has poles at delta = -1/k for all k")),
        exponent: Vec::new(),
        map: None,
        step: 1,
        ratio: Rational::from(1),
    }
}

/// The derived coefficients of T/2pi in the small parameter.
struct Series {
    derivation: Derivation,
    /// As rational numbers, where they are.
    exact: Option<Vec<Rational>>,
    /// All exponents with a coefficient are multiples of this.
    step: usize,
    known: usize,
}

impl Series {
    fn new(derivation: Derivation) -> Result<Self, Error> {
        let series = derivation.named(Quantity::Period).ok_or(Error::NoValue)?;
        let ring = &derivation.ring;
        let rational = |c| ring.as_rational(c).filter(|_| series.half_power == 0);
        let exact = series.coefficients.iter().map(rational).collect();
        let occurs = series.coefficients.iter().enumerate().filter(|(_, c)| !ring.is_zero(c));
        let step = occurs.fold(0, |step, (n, _)| gcd(step, n)).max(1);
        let known = series.coefficients.len().div_ceil(step);
        Ok(Self { derivation, exact, step, known })
    }

    /// t_n ratio^-n for n = 0, step, 2 step, ...
    fn floats(self, ratio: Rational) -> Coefficients {
        let step = self.step;
        if let Some(exact) = self.exact {
            let mut list: Vec<Rational> = exact.into_iter().step_by(step).collect();
            let inverse = power(&ratio, step).recip();
            let mut factor = Rational::from(1);
            for c in &mut list {
                *c *= &factor;
                factor *= &inverse;
            }
            return Box::new(move |bits| {
                Some(list.iter().map(|q| Float::with_val(bits, q)).collect())
            });
        }
        let (derivation, known) = (self.derivation, self.known);
        Box::new(move |bits| {
            let one = |k: usize| {
                let scale = power(&ratio, k * step).recip();
                let mut work = bits;
                // Polynomials in constants cancel; a coefficient that is zero is so exactly.
                loop {
                    let balls = Balls::new(work).with_guard(64);
                    let ball = derivation.ball(Quantity::Period, k * step, balls)?;
                    let ball = balls.mul_rational(&ball, &scale);
                    let zero = ball.is_exact() && ball.midpoint().is_zero();
                    if zero || ball.relative_accuracy_bits() >= i64::from(bits) {
                        return Some(Float::with_val(bits, ball.midpoint()));
                    }
                    work = work.checked_mul(2).filter(|work| work / 32 <= bits)?;
                }
            };
            (0..known).into_par_iter().map(one).collect()
        })
    }
}

pub(crate) fn gcd(mut a: usize, mut b: usize) -> usize {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn power(q: &Rational, n: usize) -> Rational {
    rug::ops::Pow::pow(q.clone(), u32::try_from(n).unwrap_or(u32::MAX))
}

/// Everything but the coefficients of y'' + kappa y + c small y^3 in rho = (c/kappa) small.
struct Cubic {
    ratio: Rational,
    rho: Formula,
    closed: (String, Formula),
}

fn cubic(setting: &Setting, stiffness: &Rational, ratio: &Rational) -> Result<Cubic, Error> {
    let value = |setting: Setting, ratio: Rational| {
        move |balls: Balls| Some(balls.mul_rational(&setting.small(balls), &ratio))
    };
    let rho = value(setting.clone(), ratio.clone());
    let probe = Balls::new(200);
    if let Some(rho) = rho(probe).filter(|rho| !probe.add(&probe.one(), rho).is_positive()) {
        let name = variable(setting, ratio);
        let name = name.split(" = ").last().unwrap_or(&name);
        return Err(outside(
            name,
            &rho,
            "greater than -1 (at -1 the amplitude is that of the saddle)",
        ));
    }
    let (closed, kappa) = (value(setting.clone(), ratio.clone()), stiffness.clone());
    let text = match *stiffness == 1 {
        true => "4*K(k)/sqrt(1+rho), k^2 = rho/(2+2*rho)".to_owned(),
        false => format!("4*K(k)/sqrt({stiffness}*(1+rho)), k^2 = rho/(2+2*rho)"),
    };
    let formula = move |balls: Balls| {
        let period = closed::duffing(balls, &closed(balls)?)?;
        balls.div(&period, &balls.sqrt(&balls.from_rational(&kappa))?)
    };
    let closed = (text, Box::new(formula) as Formula);
    Ok(Cubic { ratio: ratio.clone(), rho: Box::new(rho), closed })
}

/// The variable of the series: `rho = eps*amplitude^2`, `eps`, `rho = 1/4*eps`.
fn variable(setting: &Setting, ratio: &Rational) -> String {
    let name = &setting.small.name;
    if *ratio == 1 { name.clone() } else { format!("rho = {ratio}*{name}") }
}

impl Cubic {
    fn finish(self, setting: &Setting, series: Series) -> Source {
        let (known, step, ratio) = (series.known, series.step, self.ratio.clone());
        Source {
            variable: variable(setting, &self.ratio),
            at: setting.at.clone(),
            known,
            coefficients: series.floats(self.ratio),
            point: self.rho,
            factor: Box::new(|balls| Some(balls.one())),
            closed: Some(self.closed),
            radius: Some((1.0, "the separatrix at rho = -1")),
            // sqrt(1 + rho) T/4 = K(k), 2 k^2 = u: analytic for |u| < 2; T ~ rho^(-1/2).
            exponent: Vec::new(),
            map: Some(ChangeOfVariable {
                scale: Rational::from(1),
                prefactor: Rational::from((-1, 2)),
                radius: Some(2.0),
            }),
            step,
            ratio,
        }
    }
}

/// The series of any other problem, in small^step; nothing more is known than its coefficients
/// and, by scaling, a power of the small parameter for large ones.
fn derived(setting: &Setting, series: Series) -> Source {
    let (step, known) = (series.step, series.known);
    let name = &setting.small.name;
    let variable = match name.split_once(" = ") {
        _ if step == 1 => name.clone(),
        Some((small, meaning)) => format!("{small}^{step}, {small} = {meaning}"),
        None => format!("{name}^{step}"),
    };
    let rational = |c| series.derivation.ring.as_rational(c);
    let exponent = series.derivation.named(Quantity::FloquetExponent);
    let exponent: Option<_> = exponent.map(|e| e.coefficients.iter().map(rational).collect());
    let exponent = exponent.flatten().unwrap_or_default();
    let coefficients = series.floats(Rational::from(1));
    let step_power = i64::try_from(step).unwrap_or(1);
    // T ~ small for relaxation oscillations; small f(x) alone makes the time scale small^(-1/2).
    let power = match setting.form {
        Form::Relaxation { .. } => Rational::from((1, step_power)),
        Form::Conservative => Rational::from((-1, 2 * step_power)),
        _ => Rational::new(),
    };
    let scale = match setting.form {
        // Damping and stiffness are equal at small = 1.
        Form::Relaxation { .. } => Rational::from(1),
        _ => coefficients(64).map_or_else(|| Rational::from(1), |c| scale(&c)),
    };
    let point = setting.clone();
    Source {
        variable,
        at: setting.at.clone(),
        known,
        coefficients,
        point: Box::new(move |balls| balls.powi(&point.small(balls), step_power)),
        factor: Box::new(|balls| Some(balls.one())),
        closed: None,
        radius: None,
        exponent,
        map: Some(ChangeOfVariable { scale, prefactor: power, radius: None }),
        step,
        ratio: Rational::from(1),
    }
}

/// The coefficients t_0, t_1, ... that a derivation has, for a source with that `step` and `ratio`.
pub fn coefficients_of(
    derivation: Derivation,
    step: usize,
    ratio: &Rational,
) -> Result<Coefficients, Error> {
    let mut series = Series::new(derivation)?;
    let length = series.derivation.named(Quantity::Period).map_or(0, |s| s.coefficients.len());
    // A series that has one term only, or whose steps are longer as far as it goes.
    if series.step % step != 0 && series.known > 1 {
        return Err(Error::NoValue);
    }
    (series.step, series.known) = (step, length.div_ceil(step));
    Ok(series.floats(ratio.clone()))
}

/// Refuses before allocating what is not derived but computed in numbers, at twice the bits of
/// [`lindstedt_series::resummation::resum`]: for the power law N coefficients, for the sums N grids
/// of n^2 of them each, and the matrix of an approximant of half the order.
pub(crate) fn limit_memory(
    form: &Form,
    order: usize,
    accuracy: u32,
    memory: u64,
) -> Result<(), Error> {
    let n = order as f64;
    let bits = 2.0 * (f64::from(accuracy) + 4.0 * n + 68.0) + 16.0 * n + 64.0;
    let numbers = match form {
        Form::PowerLaw { .. } => n * n / 4.0 + 2.0 * n,
        Form::Sums => n * n / 4.0 + n * n * n / 3.0,
        _ => return Ok(()),
    };
    refuse_above(memory, order, (numbers * (bits / 8.0 + 32.0)).log2())
}

/// The power of two next to the radius of convergence, 1 where there is none.
fn scale(coefficients: &[Float]) -> Rational {
    let exponent = match growth(coefficients) {
        Growth::Radius { radius, .. } => radius.log2().round().clamp(-2000.0, 2000.0) as i32,
        _ => 0,
    };
    let two = Rational::from(2);
    rug::ops::Pow::pow(two, exponent)
}
