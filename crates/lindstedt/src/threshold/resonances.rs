//! Thresholds of subharmonic resonances: periodic orbits of the double well inside and around the
//! homoclinic loops.

use super::Resonance;
use super::subject::Subject;
use crate::refusal::Refused;
use crate::{Error, Number};
use lindstedt_melnikov::{MelnikovError, PolynomialFriction, Region, Subharmonic, subharmonic};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_number::certified;

/// Bits that decide whether a resonance exists.
const DECIDING_BITS: u32 = 400;

/// The resonances of orders 1 to `largest` that exist: periods 2 pi m/omega, with gamma_c for each.
pub(super) fn list(subject: &Subject<'_>, largest: u32) -> Result<Vec<Resonance>, Error> {
    let Some(point) = &subject.point else {
        let message = "subharmonic thresholds are known for x'' = a x - b x^3 alone, with one harmonic force \
                       and friction T0 sgn(w) + t_1 w + t_3 w^3";
        let hint = "without --subharmonics `lindstedt threshold` has that of the homoclinic or heteroclinic orbit; \
                    `lindstedt simulate --section stroboscopic` shows periodic motions";
        return Err(Refused::no_answer("no-answer", message, hint).into());
    };
    let law = PolynomialFriction::cubic(point.dry.clone(), &point.alpha, point.beta.clone());
    let digits = subject.work.printed_digits();
    let mut found = Vec::new();
    for m in 1..=largest {
        for (region, around) in [(Region::Inside, "one well"), (Region::Outside, "both wells")] {
            if subject.work.stop.asked() {
                let message = format!("stopped before the subharmonics of order {m}");
                return Err(Refused::stopped(message, "").into());
            }
            let at = |balls: Balls| {
                let (a, b, omega) = (&point.a, &point.b, &point.omega);
                subharmonic(balls, a, b, omega, &law, &point.belt_speed, region, m)
            };
            match at(Balls::new(DECIDING_BITS)) {
                Err(MelnikovError::NoResonance { .. } | MelnikovError::NoForcing) => continue,
                other => other?,
            };
            let number = |part: fn(Subharmonic) -> Ball| -> Result<Number, Error> {
                Ok(certified(None, digits, |balls| at(balls).ok().map(part))?)
            };
            found.push(Resonance {
                m,
                around,
                gamma_c: number(|s| s.threshold)?,
                dissipation: number(|s| s.dissipation)?,
                forcing: number(|s| s.forcing)?,
                modulus: number(|s| s.modulus)?,
            });
        }
    }
    Ok(found)
}
