//! The answer for the equation of a file that is not the oscillator of section 3.

use super::report::{Answer, Harmonic, tangle, validity};
use super::request::{Request, Sweep};
use crate::derive::number_json;
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::session::Session;
use lindstedt::Exact;
use lindstedt::number::ball::{Ball, Balls};
use lindstedt::number::certified;
use lindstedt::recognise::melnikov::Unperturbed;
use lindstedt::recognise::{MelnikovProblem, OrbitCheck, OrbitThreshold};
use lindstedt::{Number, Status};
use lindstedt_melnikov::{Class, MelnikovError};
use rug::{Float, Rational};
use serde_json::{Value as Json, json};

/// Cells in which a change of sign is looked for.
const CELLS: i64 = 128;
/// Bits that order the thresholds of several orbits.
const ORDERING_BITS: u32 = 200;

pub fn answer(
    request: &Request,
    found: &MelnikovProblem,
    digits: usize,
    session: &Session<'_>,
) -> Result<Answer, Failure> {
    let estimated = found.class() == Class::Estimated;
    let bits = if estimated { (digits as f64 * 3.33) as u32 + 48 } else { ORDERING_BITS };
    session.say("following the orbit".to_owned());
    let orbits = found.thresholds(Balls::new(bits))?;
    let least = |a: &OrbitThreshold, b: &OrbitThreshold| {
        a.threshold.gamma.midpoint().total_cmp(b.threshold.gamma.midpoint())
    };
    let (first, _) = orbits
        .iter()
        .enumerate()
        .min_by(|a, b| least(a.1, b.1))
        .ok_or(Failure::from(MelnikovError::NoClosedForm))?;
    let number = |n: usize, part: &dyn Fn(&OrbitThreshold) -> Ball| -> Result<Number, Failure> {
        match orbits.get(n) {
            Some(orbit) if estimated => Ok(estimate(&part(orbit), digits)),
            _ => {
                Ok(certified(None, digits, |balls| found.thresholds(balls).ok()?.get(n).map(part))?)
            }
        }
    };
    let gamma = |o: &OrbitThreshold| o.threshold.gamma.clone();
    let speed = match found.largest_speed(Balls::new(bits)) {
        Some(ball) if estimated => estimate(&ball, digits),
        _ => certified(None, digits, |balls| found.largest_speed(balls))?,
    };
    let numbers = vec![
        ("gamma_c", number(first, &gamma)?),
        ("signed", number(first, &|o| o.threshold.signed.clone())?),
        ("D", number(first, &|o| o.threshold.dissipation.clone())?),
        ("F", number(first, &|o| o.threshold.forcing.clone())?),
        ("V", speed),
    ];
    let checks = match &found.unperturbed {
        Unperturbed::Numeric(orbit) => orbit.check((digits as f64 * 3.33) as u32 + 20),
        Unperturbed::Closed { .. } => Vec::new(),
    };
    let mut listed = Vec::new();
    let saddle = orbits.first().and_then(|orbit| orbit.saddle);
    let several = orbits.iter().any(|orbit| orbit.saddle != saddle);
    for (n, orbit) in orbits.iter().enumerate() {
        let name = match orbit.saddle {
            Some(x) if several => format!("{} at x = {}", orbit.name, few_digits(x)),
            _ => orbit.name.to_owned(),
        };
        listed.push(json!({
            "name": name,
            "gamma_c": number_json(&number(n, &gamma)?),
            "signed": number_json(&number(n, &|o| o.threshold.signed.clone())?),
            "check": check(found, checks.get(n)),
            "least": several.then_some(n == first),
        }));
    }
    let mut remarks = request.remarks.clone();
    if several {
        remarks.push(format!(
            "orbits of several saddles: gamma_c is the least of them; V and the validity are those of \
             the {}",
            listed.first().and_then(|orbit| orbit["name"].as_str()).unwrap_or_default()
        ));
    }
    let harmonic = Harmonic::new(request, numbers.first(), &|factor: &Exact| {
        number(first, &|o| {
            let balls = Balls::new(o.threshold.gamma.midpoint().prec().max(bits));
            let quotient = balls.div(&gamma(o), &balls.abs(&factor.ball(balls)));
            quotient.unwrap_or_else(|| gamma(o))
        })
    })?;
    let few = digits.min(17);
    let distance = |second: bool| {
        let pick = |(belt, tangency, _): (Ball, Ball, bool)| if second { tangency } else { belt };
        let at = |balls: Balls| found.distances(balls).map(pick);
        match at(Balls::new(bits)) {
            Some(ball) if estimated => Ok(estimate(&ball, few)),
            _ => certified(None, few, at),
        }
    };
    let verdict = found.verdict(Balls::new(ORDERING_BITS), request.eps.to_f64());
    let words = validity(request, found.jumps(), verdict);
    let (zeros, zeros_of) = match &request.zeros {
        None => (Vec::new(), None),
        Some((_, name, low, high)) => {
            (zeros(request, name, (low, high), digits, session)?, Some((name.clone(), false)))
        }
    };
    Ok(Answer {
        problem: request.problem.clone(),
        at: request.at.iter().map(|(name, value)| (name.clone(), value.to_string())).collect(),
        amplitude: request.gamma.to_string(),
        numbers,
        zeros,
        zeros_of,
        touching_b: None,
        validity: words.to_owned(),
        distances: [distance(false)?, distance(true)?],
        tangle: tangle(request, orbits.get(first).map(gamma)).to_owned(),
        orbits: listed,
        subharmonics: None,
        remarks,
        harmonic,
    })
}

/// x with six digits, without zeros behind.
fn few_digits(x: f64) -> String {
    let text = format!("{x:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A number with the estimate of its error.
fn estimate(ball: &Ball, digits: usize) -> Number {
    Number::of_ball(ball, digits).weaken(Status::Estimated)
}

/// How the orbit was checked.
fn check(found: &MelnikovProblem, check: Option<&OrbitCheck>) -> Json {
    match &found.unperturbed {
        Unperturbed::Closed { potential, .. } => {
            let kind = if potential.is_homoclinic() { "homoclinic" } else { "heteroclinic" };
            let parameters: Vec<String> =
                potential.parameters().iter().map(|(n, v)| format!("{n} = {v}")).collect();
            let family = match potential {
                lindstedt_melnikov::Potential::DoubleWell { .. } => "x'' = a*x - b*x^3",
                lindstedt_melnikov::Potential::SoftDuffing { .. } => "x'' = -a*x + b*x^3",
                lindstedt_melnikov::Potential::Helmholtz { .. } => "x'' = a*x - b*x^2",
                lindstedt_melnikov::Potential::Pendulum { .. } => "x'' = -a*sin(x)",
                _ => "x'' = a*x*(1 - x^2)*(1 - 3*x^2)",
            };
            let parameters = parameters.join(", ");
            Json::from(format!(
                "{kind}, {family} with {parameters}: the residual of the equation is 0 identically"
            ))
        }
        Unperturbed::Numeric(_) => check.map_or(Json::Null, |c| {
            let (kind, end) = if c.homoclinic {
                ("homoclinic", "turning point")
            } else {
                ("heteroclinic", "other saddle")
            };
            Json::from(format!(
                "{kind}, numeric: saddle {:.9}, {end} {:.9}, energy residual {:.1e}, \
                     distance to the saddle at the end {:.1e}",
                c.saddle, c.end, c.energy_residual, c.decay
            ))
        }),
    }
}

/// The zeros of the signed threshold in a parameter of a file: changes of sign on a grid, enclosed
/// by bisection.
pub fn zeros(
    request: &Request,
    name: &str,
    (low, high): (&Exact, &Exact),
    digits: usize,
    session: &Session<'_>,
) -> Result<Vec<Number>, Failure> {
    let numeric = request
        .file
        .as_ref()
        .is_some_and(|(_, found)| matches!(found.unperturbed, Unperturbed::Numeric(_)));
    let what = if numeric {
        "zeros are enclosed on orbits in closed form, and this one is numeric"
    } else {
        "zeros are enclosed between rational ends"
    };
    let (Some(low), Some(high), false) = (low.as_rational(), high.as_rational(), numeric) else {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-answer",
            message: what.to_owned(),
            hint: "--sweep shows where the sign changes".to_owned(),
        });
    };
    let sweep = Sweep { axis: None, name: name.to_owned(), values: Vec::new() };
    let bits = (digits as f64 * 3.33) as u32 + 64;
    let sign = |q: &Rational| -> Option<bool> {
        let value = Exact::Rational(q.clone());
        let ball = request.signed(Balls::new(bits), &[(&sweep, &value)]).ok()?;
        (!ball.contains_zero()).then(|| ball.is_positive())
    };
    let width = Rational::from(high - low);
    // No round fractions: zeros like to be there.
    let at = |n: i64| &width * Rational::from((1009 * n, 1009 * CELLS + 1)) + low;
    let stopped = || Failure {
        exit: if session.interrupted() { INTERRUPTED } else { UNDECIDED },
        code: if session.interrupted() { "interrupted" } else { "limit-seconds" },
        message: "stopped before all zeros were found".to_owned(),
        hint: String::new(),
    };
    let mut found = Vec::new();
    for n in 0..CELLS {
        if !session.goes_on() {
            return Err(stopped());
        }
        let (mut a, mut b) = (at(n), if n + 1 == CELLS { high.clone() } else { at(n + 1) });
        let (Some(left), Some(right)) = (sign(&a), sign(&b)) else { continue };
        if left == right {
            continue;
        }
        for _ in 0..bits {
            let middle = Rational::from(&a + &b) / 2u32;
            match sign(&middle) {
                Some(side) if side == left => a = middle,
                Some(_) => b = middle,
                None => break,
            }
        }
        let balls = Balls::new(bits + 32);
        let ends = balls.hull(&balls.from_rational(&a), &balls.from_rational(&b));
        let mut number = Number::of_ball(&ends, digits);
        if request.class() == Class::Estimated {
            number = number.weaken(Status::Estimated);
        }
        let zero = Float::with_val(53, ends.midpoint());
        if zero.is_finite() {
            found.push(number);
        }
    }
    Ok(found)
}
