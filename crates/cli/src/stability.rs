//! `lindstedt stability`: what averaging predicts for the impact orbit, and the truth.

use crate::Outcome;
use crate::arguments::{KickChoice, PredictorChoice, StabilityOptions, VariantChoice};
use crate::session::Session;
use lindstedt::Stability;
use lindstedt::unstable::impact::{characteristic::Kick, prediction::Variant};

pub fn run(options: &StabilityOptions, session: &Session<'_>) -> Outcome {
    let work = session.precise_work(&options.precision)?;
    let (branch, set) = Stability::read_branch(&options.set)?;
    let oscillator = session.oscillator(&options.problem, &set, None)?;
    let question = Stability {
        order: options.order as usize,
        variant: match options.variant {
            VariantChoice::E | VariantChoice::ImpactAware => Variant::E,
            VariantChoice::S => Variant::S,
            VariantChoice::P => Variant::P,
        },
        impact_aware: matches!(options.variant, VariantChoice::ImpactAware),
        kick: match options.kick {
            KickChoice::None => Kick::None,
            KickChoice::Mean => Kick::Mean,
            KickChoice::Before => Kick::Before,
            KickChoice::After => Kick::After,
        },
        predict: options.predictor != PredictorChoice::Exact,
        exact: options.predictor != PredictorChoice::Kbm,
        branch,
        sweep: options.sweep.iter().map(|text| oscillator.axis(text)).collect::<Result<_, _>>()?,
        radius: false,
        part: None,
    };
    session.check_sweep(&options.plot, question.sweep.len(), 2)?;
    session.check_writable(&options.problem, &options.plot, None)?;
    session.show(oscillator.stability(&question, &work), &options.plot)
}
