//! Thresholds of subharmonic resonances: periodic orbits of the double well inside and around the
//! homoclinic loops.

use super::request::Request;
use crate::derive::number_json;
use crate::failure::{Failure, INTERRUPTED, NO_ANSWER, UNDECIDED};
use crate::session::Session;
use lindstedt::number::ball::{Ball, Balls};
use lindstedt::number::certified;
use lindstedt_melnikov::{MelnikovError, PolynomialFriction, Region, Subharmonic, subharmonic};
use serde_json::{Value as Json, json};

/// Bits that decide whether a resonance exists.
const DECIDING_BITS: u32 = 400;

/// The resonances of orders 1 to `largest` that exist: periods 2 pi m/omega, with gamma_c for each.
pub fn list(
    request: &Request,
    largest: u32,
    digits: usize,
    session: &Session<'_>,
) -> Result<Vec<Json>, Failure> {
    let Some(point) = &request.point else {
        return Err(Failure {
            exit: NO_ANSWER,
            code: "no-answer",
            message: "subharmonic thresholds are known for x'' = a x - b x^3 with one harmonic \
                      force and friction T0 sgn(w) + t_1 w + t_3 w^3"
                .to_owned(),
            hint: String::new(),
        });
    };
    let law = PolynomialFriction::paper(point.dry.clone(), &point.alpha, point.beta.clone());
    let mut found = Vec::new();
    for m in 1..=largest {
        for (region, name) in [(Region::Inside, "one well"), (Region::Outside, "both wells")] {
            if !session.goes_on() {
                let interrupted = session.interrupted();
                return Err(Failure {
                    exit: if interrupted { INTERRUPTED } else { UNDECIDED },
                    code: if interrupted { "interrupted" } else { "limit-seconds" },
                    message: format!("stopped before the subharmonics of order {m}"),
                    hint: String::new(),
                });
            }
            let at = |balls: Balls| {
                let (a, b, omega) = (&point.a, &point.b, &point.omega);
                subharmonic(balls, a, b, omega, &law, &point.belt_speed, region, m)
            };
            match at(Balls::new(DECIDING_BITS)) {
                Err(MelnikovError::NoResonance { .. } | MelnikovError::NoForcing) => continue,
                other => other?,
            };
            let number = |part: &dyn Fn(Subharmonic) -> Ball| {
                certified(None, digits, |balls| at(balls).ok().map(part)).map(|n| number_json(&n))
            };
            found.push(json!({
                "m": m,
                "around": name,
                "gamma_c": number(&|s| s.threshold)?,
                "D": number(&|s| s.dissipation)?,
                "F": number(&|s| s.forcing)?,
                "modulus": number(&|s| s.modulus)?,
            }));
        }
    }
    Ok(found)
}
