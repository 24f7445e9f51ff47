//! The verbs: options to questions of the facade.

use crate::failure::usage;
use crate::found::Shown;
use crate::options::Options;
use lindstedt::choices::{
    BRANCHES, FIGURES, KICKS, LANGUAGES, Numbers, PREDICTORS, RESUMMATIONS, ROUTES, SECTIONS,
    TIERS, VARIANTS,
};
use lindstedt::evaluate::Times;
use lindstedt::evaluate::averaged::{AveragedMotion, Start as AveragedStart};
use lindstedt::grid::Axis;
use lindstedt::motion::{Bifurcation, Chaos, End, Start};
use lindstedt::threshold::Persisting;
use lindstedt::trade::Plan;
use lindstedt::unstable::impact::parameters::Branch;
use lindstedt::unstable::impact::{characteristic::Kick, prediction::Variant};
use lindstedt::{
    Condition, Derive, Error, Evaluate, Oscillator, Respond, Route, Simulate, Stability, Threshold,
    Verify, Work,
};

/// An answer that can be read in every form.
type Asked = Result<Box<dyn Shown>, Error>;

fn boxed<A: Shown + 'static>(answer: Result<A, Error>) -> Asked {
    Ok(Box::new(answer?))
}

/// Asks a question by its verb.
pub fn ask(case: &Oscillator, verb: &str, options: &Options, work: &Work) -> Asked {
    match verb {
        "derive" => derive(case, options, work),
        "evaluate" => evaluated(case, options, work),
        "respond" => {
            let question = respond(case, options)?;
            boxed(case.respond(&question, work))
        }
        "verify" => {
            let question = verify(options)?;
            boxed(case.verify(&question, work))
        }
        "trade" => {
            let question = trade(options)?;
            boxed(case.trade(&question, work))
        }
        "simulate" => simulate(case, options, work),
        "threshold" => {
            if let Some(name) = options.text("unknown").as_deref().or(case.unknown()) {
                let order: Option<usize> = options.parsed("order")?;
                options.finish()?;
                return Ok(match case.persisting(name, order, work)? {
                    Persisting::Series(answer) => answer,
                    Persisting::First(answer) => answer,
                });
            }
            let question = threshold(case, options)?;
            boxed(case.threshold(&question, work))
        }
        "stability" => {
            let question = stability(case, options)?;
            boxed(case.stability(&question, work))
        }
        other => Err(usage(format!("there is no question {other:?}"), "derive, evaluate, ...")),
    }
}

fn derive(case: &Oscillator, options: &Options, work: &Work) -> Asked {
    let order = options.parsed("order")?.unwrap_or(4);
    options.only_one(&["mode", "unknown"])?;
    // What is not read before `finish` is refused: route, only, tier and harmonics belong to the last.
    if let Some(mode) = options.parsed("mode")? {
        options.finish()?;
        return boxed(case.normal_mode(mode, order, work));
    }
    if let Some(name) = options.text("unknown").as_deref().or(case.unknown()) {
        options.finish()?;
        return boxed(case.sought(name, order, work));
    }
    if case.condition() == Some(Condition::FreeAmplitude) {
        options.finish()?;
        return boxed(case.averaged(order, work));
    }
    let numbers = options.choice("tier", TIERS)?.unwrap_or(Numbers::Exact);
    let harmonics = match numbers {
        Numbers::Fourier => options.parsed("harmonics")?.unwrap_or(64),
        _ => 0,
    };
    if let Some(tier) = numbers.tier(harmonics, work) {
        options.finish()?;
        return boxed(case.estimate(order, tier, work));
    }
    let route = options.choice("route", ROUTES)?.unwrap_or_default();
    let route = match (options.text("only").as_deref(), route) {
        (None, route) => route,
        (Some("frequency"), Route::Automatic) => Route::Frequency,
        (Some("frequency"), Route::EnergyIntegral) => route,
        (Some("frequency"), _) => {
            let message = "only=\"frequency\" has its own routes".to_owned();
            return Err(usage(message, "without route"));
        }
        (Some(other), _) => {
            return Err(usage(format!("only {other:?} is not known"), "only=\"frequency\""));
        }
    };
    options.finish()?;
    boxed(case.derive(Derive { order, route }, work))
}

/// The order and the method of `evaluate`.
pub fn resummed(options: &Options) -> Result<Evaluate, Error> {
    let method = options.choice("resum", RESUMMATIONS)?.flatten();
    Ok(Evaluate { order: options.parsed("order")?, method, ..Evaluate::default() })
}

/// The same with a phase.
pub fn phased(options: &Options) -> Result<Evaluate, Error> {
    let question = resummed(options)?;
    Ok(Evaluate { phase: options.exact("phase")?.unwrap_or(question.phase), ..question })
}

/// The order and the start of an averaged motion.
pub fn averaged(options: &Options) -> Result<AveragedMotion, Error> {
    options.only_one(&["start", "state"])?;
    let start = options.read("start", |text| Ok(AveragedStart::parse_amplitude(text)?))?;
    let state = options.read("state", |text| Ok(AveragedStart::parse_state(text)?))?;
    Ok(AveragedMotion { order: options.parsed("order")?, start: start.or(state), times: None })
}

fn evaluated(case: &Oscillator, options: &Options, work: &Work) -> Asked {
    if let Some(largest) = options.exact("cycles")? {
        options.finish()?;
        return boxed(case.first_order(&largest, work));
    }
    let prove = options.flag("prove")?;
    if !prove && case.condition() == Some(Condition::FreeAmplitude) {
        if let (Some(columns), rows) = options.axes(|axis| case.axis(axis))? {
            let question = averaged(options)?;
            options.finish()?;
            return boxed(case.averaged_sweep(&question, columns, rows, work));
        }
        let times = options.read("times", Times::parse)?;
        let question = AveragedMotion { times, ..averaged(options)? };
        options.finish()?;
        return boxed(case.averaged_motion(&question, work));
    }
    // What is not read before `finish` is refused: a sweep has no times, phase and code, a proof no code.
    if let (Some(columns), rows) = options.axes(|axis| case.axis(axis))? {
        let question = resummed(options)?;
        options.finish()?;
        return match (prove, rows) {
            (false, rows) => boxed(case.evaluate_sweep(&question, columns, rows, work)),
            (true, None) => boxed(case.prove_sweep(&question, columns, work)),
            (true, Some(_)) => Err(usage("a proved family is over one parameter", "one axis")),
        };
    }
    let question = Evaluate { times: options.read("times", Times::parse)?, ..phased(options)? };
    if prove {
        options.finish()?;
        return boxed(case.prove(&question, work));
    }
    let Some(language) = options.choice("code", LANGUAGES)? else {
        options.finish()?;
        return boxed(case.evaluate(&question, work));
    };
    let harmonics = options.parsed("harmonics")?.unwrap_or(15);
    if options.flag("functions")? {
        options.finish()?;
        return boxed(case.expansion_code(&question, language, harmonics, work));
    }
    options.finish()?;
    boxed(case.solution_code(&question, language, harmonics, work))
}

fn respond(case: &Oscillator, options: &Options) -> Result<Respond, Error> {
    let (sweep, second) =
        options.axes(|axis| Respond::read_sweep(case, axis, &lindstedt::Stop::default()))?;
    let question = Respond {
        order: options.parsed("order")?,
        sweep,
        second,
        amplitude: options.exact("box")?,
        follow: options.flag("follow")?,
        start: options.read("start", Respond::read_start)?,
    };
    options.finish()?;
    Ok(question)
}

fn verify(options: &Options) -> Result<Verify, Error> {
    let usual = Verify::default();
    let question = Verify {
        order: options.parsed("order")?.unwrap_or(usual.order),
        small: options.read("small", Verify::read_small)?.unwrap_or(usual.small),
        periods: options.parsed("periods")?.unwrap_or(usual.periods),
        samples: options.parsed("samples")?.unwrap_or(usual.samples),
        digits: options.parsed("digits")?,
    };
    options.finish()?;
    Ok(question)
}

fn trade(options: &Options) -> Result<Plan, Error> {
    let usual = Plan::default();
    let plan = Plan {
        orders: options.list("orders")?.unwrap_or(usual.orders),
        digits: options.list("digits")?.unwrap_or(usual.digits),
        harmonics: options.list("harmonics")?.unwrap_or(usual.harmonics),
        run_seconds: options.parsed("limit_run")?.unwrap_or(usual.run_seconds),
        repeats: options.parsed("repeats")?.unwrap_or(usual.repeats),
        error: options.parsed("error")?,
        seconds: options.parsed("within")?,
    };
    options.finish()?;
    Ok(plan)
}

fn branch(options: &Options) -> Result<Option<Branch>, Error> {
    options.choice("branch", BRANCHES)
}

/// The start of a motion.
fn start(options: &Options) -> Result<Start, Error> {
    Ok(Start {
        state: options.read("state", Start::read_state)?,
        history: options.text("history"),
        branch: branch(options)?,
        perturbation: options.read("perturb", Start::read_perturbation)?,
    })
}

/// A bifurcation diagram over the parameter of `sweep`.
pub fn diagram(sweep: &str, options: &Options) -> Result<Bifurcation, Error> {
    let usual = Bifurcation::over(sweep);
    let question = Bifurcation {
        start: start(options)?,
        section: options.choice("section", SECTIONS)?,
        skipped: options.parsed("skip")?.unwrap_or(usual.skipped),
        kept: options.parsed("keep")?.unwrap_or(usual.kept),
        follow: options.flag("follow")?,
        ..usual
    };
    options.finish()?;
    Ok(question)
}

fn simulate(case: &Oscillator, options: &Options, work: &Work) -> Asked {
    let (lyapunov, zero_one) = (options.flag("lyapunov")?, options.flag("zero_one")?);
    if lyapunov || zero_one {
        let usual = Chaos::default();
        let question = Chaos {
            start: start(options)?,
            lyapunov,
            zero_one,
            kept: options.parsed("periods")?.unwrap_or(usual.kept),
            skipped: options.parsed("skip")?.unwrap_or(usual.skipped),
        };
        options.finish()?;
        return boxed(case.chaos(&question, work));
    }
    if let Some(sweep) = options.text("sweep") {
        return boxed(case.bifurcation(&diagram(&sweep, options)?, work));
    }
    options.only_one(&["until", "periods", "impacts"])?;
    let until = options.exact("until")?.map(End::Time);
    let periods = options.parsed("periods")?.map(End::Periods);
    let impacts = options.parsed("impacts")?.map(End::Impacts);
    let question = Simulate {
        start: start(options)?,
        end: until.or(periods).or(impacts),
        times: options.read("times", Simulate::read_times)?,
        section: options.choice("section", SECTIONS)?,
        skip: options.parsed("skip")?,
        drawn: true,
        view: options.choice("figure", &FIGURES[..3])?.flatten(),
    };
    options.finish()?;
    boxed(case.motion(&question, work))
}

fn swept(case: &Oscillator, options: &Options) -> Result<Vec<Axis>, Error> {
    let (columns, rows) = options.axes(|axis| case.axis(axis))?;
    Ok(columns.into_iter().chain(rows).collect())
}

/// The question for a threshold.
pub fn threshold(case: &Oscillator, options: &Options) -> Result<Threshold, Error> {
    let question = Threshold {
        sweep: swept(case, options)?,
        zeros: options.read("zeros", Axis::ends)?,
        subharmonics: options.parsed("subharmonics")?,
        second_order: options.flag("second_order")?,
        part: None,
    };
    options.finish()?;
    Ok(question)
}

/// The question for a stability.
pub fn stability(case: &Oscillator, options: &Options) -> Result<Stability, Error> {
    let (variant, impact_aware) =
        options.choice("variant", VARIANTS)?.unwrap_or((Variant::E, false));
    let (predict, exact) = options.choice("predictor", PREDICTORS)?.unwrap_or((true, true));
    let question = Stability {
        order: options.parsed("order")?.unwrap_or(1),
        variant,
        impact_aware,
        kick: options.choice("kick", KICKS)?.unwrap_or(Kick::Mean),
        predict,
        exact,
        branch: branch(options)?,
        sweep: swept(case, options)?,
        ..Stability::default()
    };
    options.finish()?;
    Ok(question)
}
