//! An amplitude that scales the frequency.

use super::estimate::{Estimate, rounding};
use crate::settings::Settings;
use lindstedt_equation::{AmplitudeRole, Problem};
use lindstedt_number::ball::Balls;
use rug::Float;

/// The factor a^(power exponent eps/2), where the amplitude scales the frequency; its
/// coefficients (ln a)^n/n! may be huge, so the errors go through the product too.
pub(super) fn scaled_to_amplitude(
    problem: &Problem,
    settings: &Settings,
    mut estimate: Estimate,
) -> Estimate {
    let amplitude = settings.parameters.get("amplitude");
    let (AmplitudeRole::ScalesFrequency { exponent }, Some(a)) = (problem.amplitude, amplitude)
    else {
        return estimate;
    };
    let work = estimate.bits.saturating_add(64);
    let Some(log) = Balls::new(work).ln(&a.ball(Balls::new(work.saturating_add(64)))) else {
        return estimate;
    };
    for series in &mut estimate.series {
        let power = series.quantity.power();
        if power == 0 {
            continue;
        }
        let rate = Float::with_val(work, log.midpoint() * (exponent * power)) / 2u32;
        let mut factor = vec![Float::with_val(work, 1)];
        for n in 1..series.coefficients.len() {
            let term = factor.last().map(|last| Float::with_val(work, last * &rate) / n as u64);
            factor.extend(term);
        }
        let coefficient = |n: usize| {
            let terms = series.coefficients.iter().take(n + 1).zip(factor[..=n].iter().rev());
            let (mut sum, mut error) = (Float::new(work), Float::new(53));
            for ((value, uncertainty), f) in terms {
                sum += value * f;
                if !f.is_zero() {
                    error += Float::with_val(53, uncertainty * f).abs();
                }
            }
            let value = Float::with_val(estimate.bits, &sum);
            let error = error + rounding(&value, estimate.bits);
            (value, error)
        };
        series.coefficients = (0..series.coefficients.len()).map(coefficient).collect();
    }
    estimate
}
