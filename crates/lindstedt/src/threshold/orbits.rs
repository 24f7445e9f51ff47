//! The numbers at one point: gamma_c, D, F, V, of every orbit, and what they are worth.

use super::subject::Subject;
use super::{Crossing, Cusp, Harmonic, HomoclinicThreshold, Orbit, Validity};
use crate::{Error, Exact, Number, Status};
use lindstedt_equation::Expression;
use lindstedt_equation::print::Style;
use lindstedt_melnikov::{Class, MelnikovError, Potential, Threshold, Verdict};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::certified;
use lindstedt_recognise::Unperturbed;
use lindstedt_recognise::{MelnikovProblem, OrbitCheck, OrbitValue};

/// Bits that order the thresholds of several orbits.
pub(super) const ORDERING_BITS: u32 = 200;
/// What is undecided with so many bits is said to be: a threshold beyond all exponents.
const FEW_OR_NEVER: u32 = 8000;
/// Bits that decide whether gamma exceeds its threshold.
const COMPARING_BITS: u32 = 400;

/// The thresholds of all orbits at the working precision.
struct Measured<'a> {
    subject: &'a Subject<'a>,
    digits: usize,
    balls: Balls,
    estimated: bool,
    orbits: Vec<OrbitValue<Threshold>>,
    /// The orbit of the least threshold.
    first: usize,
}

/// A part of the threshold of an orbit.
type Part = fn(&OrbitValue<Threshold>) -> &Ball;

impl<'a> Measured<'a> {
    fn new(subject: &'a Subject<'a>) -> Result<Self, Error> {
        let digits = subject.work.printed_digits();
        let estimated = subject.found.class() == Class::Estimated;
        let bits = if estimated { estimating_bits(digits) } else { ORDERING_BITS };
        let balls = Balls::new(bits);
        let orbits = match subject.found.thresholds(balls) {
            Err(MelnikovError::Undecided { .. }) if !estimated => {
                subject.found.thresholds(Balls::new(FEW_OR_NEVER))?
            }
            other => other?,
        };
        let size = |orbit: &OrbitValue<Threshold>| orbit.value.gamma.midpoint().clone();
        let least = orbits.iter().enumerate().min_by(|a, b| size(a.1).total_cmp(&size(b.1)));
        let first = least.ok_or(MelnikovError::NoClosedForm)?.0;
        Ok(Self { subject, digits, balls, estimated, orbits, first })
    }

    /// Part of the n-th orbit; what was followed numerically is not followed again.
    fn orbit(&self, balls: Balls, n: usize, part: Part) -> Option<Ball> {
        if balls.bits() == self.balls.bits() {
            return self.orbits.get(n).map(|orbit| part(orbit).clone());
        }
        self.subject.found.thresholds(balls).ok()?.get(n).map(|orbit| part(orbit).clone())
    }

    fn signed(&self, balls: Balls) -> Option<Ball> {
        match &self.subject.point {
            Some(point) => point.signed_threshold(balls),
            None => self.orbit(balls, self.first, |o| &o.value.signed),
        }
    }

    fn gamma(&self, balls: Balls) -> Option<Ball> {
        match &self.subject.point {
            Some(_) => Some(balls.abs(&self.signed(balls)?)),
            None => self.orbit(balls, self.first, |o| &o.value.gamma),
        }
    }

    /// The number that `at` encloses; with its estimate, where it is one.
    fn number(
        &self,
        exact: Option<String>,
        digits: usize,
        at: impl Fn(Balls) -> Option<Ball>,
    ) -> Result<Number, Error> {
        if self.estimated {
            let number = at(self.balls).and_then(|ball| Number::of_ball(&ball, digits));
            let number = number.ok_or(MelnikovError::Undecided { bits: self.balls.bits() })?;
            return Ok(number.weaken(Status::Estimated));
        }
        Ok(certified(exact, digits, at)?)
    }

    fn part(&self, n: usize, part: Part) -> Result<Number, Error> {
        self.number(None, self.digits, |balls| self.orbit(balls, n, part))
    }

    /// What gamma is in the symbols of the problem, and gamma_c as a value of its parameter.
    fn harmonic(&self, gamma: &Number) -> Result<Option<Harmonic>, Error> {
        let Some(lowest) = &self.subject.lowest else { return Ok(None) };
        let small = &self.subject.oscillator.problem().small;
        let shown = |e: &Expression, style| e.print(small, style);
        let over = |factor: &Exact| {
            let quotient = |balls: Balls| balls.div(&self.gamma(balls)?, &factor.abs().ball(balls));
            match factor.abs().as_rational() {
                Some(q) if *q == 1 => Ok(gamma.clone()),
                _ => self.number(None, self.digits, quotient),
            }
        };
        let parameter = lowest.parameter.as_ref();
        Ok(Some(Harmonic {
            term: shown(&lowest.term, Style::Text),
            coefficient: shown(&lowest.coefficient, Style::Text),
            latex: [&lowest.coefficient, &lowest.term].map(|e| shown(e, Style::Latex)),
            parameter: parameter.map(|(name, _)| name.clone()),
            threshold: parameter.map(|(_, factor)| over(factor)).transpose()?,
        }))
    }

    /// All orbits, where they are not one closed form.
    fn all(&self) -> Result<Vec<Orbit>, Error> {
        if self.subject.point.is_some() {
            return Ok(Vec::new());
        }
        let checks = checks(&self.subject.found.unperturbed, self.digits);
        let several = several(&self.orbits);
        let one = |(n, name): (usize, String)| {
            Ok(Orbit {
                name,
                gamma_c: self.part(n, |o| &o.value.gamma)?,
                signed: self.part(n, |o| &o.value.signed)?,
                check: check(&self.subject.found.unperturbed, checks.get(n)),
                least: several.then_some(n == self.first),
            })
        };
        names(&self.orbits).into_iter().enumerate().map(one).collect()
    }

    fn cusp(&self, speed: &Number) -> Result<Option<Cusp>, Error> {
        let point = self.subject.point.as_ref().filter(|point| point.dry.sign().is_ne());
        let Some(point) = point else { return Ok(None) };
        // The dry term is gone there, v*^2 = V^2.
        let signed = self.number(None, self.digits, |balls| point.threshold_at_cusp(balls))?;
        let touches_zero_at_b = point.touching_b().map(Exact::Rational);
        Ok(Some(Cusp { vstar: speed.clone(), signed, touches_zero_at_b }))
    }

    fn crossing(&self) -> Crossing {
        // Coinciding manifolds do not cross.
        if self.subject.eps().sign().is_eq() {
            return Crossing::None;
        }
        let balls = if self.estimated { self.balls } else { Balls::new(COMPARING_BITS) };
        let amplitude = self.subject.found.amplitude.abs().ball(balls);
        match self.gamma(balls).map(|gamma| balls.sub(&amplitude, &gamma)) {
            Some(excess) if excess.is_positive() => Crossing::Crossing,
            Some(excess) if excess.is_negative() => Crossing::None,
            _ => Crossing::Undecided,
        }
    }

    fn validity(&self) -> Result<Validity, Error> {
        let found = &self.subject.found;
        let few = self.digits.min(17);
        let distance = |pick: fn((Ball, Ball, bool)) -> Ball| {
            self.number(None, few, |balls| found.distances(balls).map(pick))
        };
        Ok(Validity {
            verdict: verdict(&self.subject.found, &self.subject.eps()),
            distance_to_saddle: distance(|(belt, _, _)| belt)?,
            distance_to_tangency: distance(|(_, tangency, _)| tangency)?,
        })
    }
}

/// The numbers at the point that is asked about, without zeros, resonances and sweeps.
pub(super) fn measure(subject: &Subject<'_>) -> Result<HomoclinicThreshold, Error> {
    let measured = Measured::new(subject)?;
    let (first, digits) = (measured.first, measured.digits);
    let exact = subject.point.as_ref().and_then(|point| point.exact_threshold());
    let gamma_c = measured.number(exact, digits, |balls| measured.gamma(balls))?;
    let largest_speed =
        measured.number(None, digits, |balls| subject.found.largest_speed(balls))?;
    Ok(HomoclinicThreshold {
        signed: measured.number(None, digits, |balls| measured.signed(balls))?,
        dissipation: measured.part(first, |o| &o.value.dissipation)?,
        forcing: measured.part(first, |o| &o.value.forcing)?,
        amplitude: subject.found.amplitude.clone(),
        harmonic: measured.harmonic(&gamma_c)?,
        remarks: Vec::new(),
        zeros: Vec::new(),
        zeros_of: None,
        cusp: measured.cusp(&largest_speed)?,
        orbits: measured.all()?,
        subharmonics: None,
        second_order: Vec::new(),
        homoclinic_points: measured.crossing(),
        validity: measured.validity()?,
        sweep: None,
        gamma_c,
        largest_speed,
    })
}

/// x with six digits, without zeros behind.
fn few_digits(x: f64) -> String {
    let text = format!("{x:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Bits of a number that is estimated.
pub(super) fn estimating_bits(digits: usize) -> u32 {
    (digits as f64 * 3.33) as u32 + 48
}

/// The checks of numeric orbits.
pub(super) fn checks(unperturbed: &Unperturbed, digits: usize) -> Vec<OrbitCheck> {
    match unperturbed {
        Unperturbed::Numeric(orbit) => orbit.check((digits as f64 * 3.33) as u32 + 20),
        Unperturbed::Closed { .. } => Vec::new(),
    }
}

/// Whether the orbits have several saddles.
fn several<T>(orbits: &[OrbitValue<T>]) -> bool {
    let saddle = orbits.first().and_then(|orbit| orbit.saddle);
    orbits.iter().any(|orbit| orbit.saddle != saddle)
}

/// Which orbits; with their saddles where there are several.
pub(super) fn names<T>(orbits: &[OrbitValue<T>]) -> Vec<String> {
    let several = several(orbits);
    let name = |orbit: &OrbitValue<T>| match orbit.saddle {
        Some(x) if several => format!("{} at x = {}", orbit.name, few_digits(x)),
        _ => orbit.name.to_owned(),
    };
    orbits.iter().map(name).collect()
}

/// How the orbit was checked.
pub(super) fn check(unperturbed: &Unperturbed, check: Option<&OrbitCheck>) -> Option<String> {
    let Unperturbed::Closed { potential, .. } = unperturbed else {
        return check.map(|c| {
            let (kind, end) = if c.homoclinic {
                ("homoclinic", "turning point")
            } else {
                ("heteroclinic", "other saddle")
            };
            format!(
                "{kind}, numeric: saddle {:.9}, {end} {:.9}, energy residual {:.1e}, distance to \
                 the saddle at the end {:.1e}",
                c.saddle, c.end, c.energy_residual, c.decay
            )
        });
    };
    let kind = if potential.is_homoclinic() { "homoclinic" } else { "heteroclinic" };
    let family = match potential {
        Potential::DoubleWell { .. } => "x'' = a*x - b*x^3",
        Potential::SoftDuffing { .. } => "x'' = -a*x + b*x^3",
        Potential::Helmholtz { .. } => "x'' = a*x - b*x^2",
        Potential::Pendulum { .. } => "x'' = -a*sin(x)",
        _ => "x'' = a*x*(1 - x^2)*(1 - 3*x^2)",
    };
    let parameters: Vec<String> =
        potential.parameters().iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let parameters = parameters.join(", ");
    Some(format!(
        "{kind}, {family} with {parameters}: the residual of the equation is 0 identically"
    ))
}

/// What first order in eps is worth: without a jump there is nothing to be far from, and where the
/// slope of friction is bounded, what it does on the perturbed orbit differs by O(eps) from what it
/// does on the unperturbed one.
pub(super) fn verdict(found: &MelnikovProblem, eps: &Exact) -> &'static str {
    if eps.sign().is_eq() {
        return "no statement: at eps = 0 nothing is perturbed, the stable and unstable manifolds \
                coincide";
    }
    if found.bends() {
        return "holds to first order in eps: the slope of friction jumps, friction does not; no \
                bound on eps is known here";
    }
    if !found.jumps() {
        return "holds to first order in eps: the perturbation is smooth; no bound on eps is known \
                here";
    }
    match found.verdict(Balls::new(ORDERING_BITS), eps.to_f64()) {
        Some(Verdict::Holds) => "holds: |v*| and ||v*| - V| exceed 10 eps",
        Some(Verdict::Doubtful) => {
            "doubtful: |v*| or ||v*| - V| is below 10 eps, corrections of order eps count"
        }
        _ => "fails: v* = 0 or |v*| = V, for every eps",
    }
}
