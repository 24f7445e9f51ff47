//! The verbs: options to questions of the facade.

use crate::failure::usage;
use crate::found::Shown;
use crate::options::Options;
use lindstedt::evaluate::averaged::{AveragedMotion, Start as AveragedStart};
use lindstedt::evaluate::{Language, Times};
use lindstedt::grid::Axis;
use lindstedt::motion::{Bifurcation, Chaos, End, Section, Start, View};
use lindstedt::numeric::Tier;
use lindstedt::trade::Plan;
use lindstedt::unstable::impact::parameters::Branch;
use lindstedt::unstable::impact::{characteristic::Kick, prediction::Variant};
use lindstedt::{
    Condition, Derive, Error, Evaluate, Exact, Oscillator, Respond, Route, Simulate, Stability,
    Threshold, Verify, Work,
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
    let mode: Option<usize> = options.parsed("mode")?;
    let unknown = options.text("unknown");
    let routes = [
        ("auto", Route::Automatic),
        ("clock", Route::Clock),
        ("driver", Route::Driver),
        ("energy", Route::EnergyIntegral),
    ];
    let route = options.choice("route", &routes)?.unwrap_or_default();
    let tier = options.text("tier");
    let harmonics = options.parsed("harmonics")?.unwrap_or(64);
    options.finish()?;
    if let Some(mode) = mode {
        return boxed(case.normal_mode(mode, order, work));
    }
    if let Some(name) = unknown.as_deref().or(case.unknown()) {
        return boxed(case.parameter_series(name, order, work));
    }
    if case.condition() == Some(Condition::FreeAmplitude) {
        return boxed(case.averaged(order, work));
    }
    let tier = match tier.as_deref() {
        None | Some("exact") => return boxed(case.derive(Derive { order, route }, work)),
        Some("fourier") => Tier::Fourier { harmonics },
        Some("collocation") if work.doubles => Tier::Doubles,
        Some("collocation") => Tier::Collocation { digits: work.digits },
        Some(other) => {
            let message = format!("there is no tier {other:?}");
            return Err(usage(message, "exact, collocation or fourier"));
        }
    };
    boxed(case.estimate(order, tier, work))
}

/// The order, the method, the times and the phase of `evaluate`.
pub fn evaluate(options: &Options) -> Result<Evaluate, Error> {
    let method = match options.text("resum").as_deref() {
        None | Some("auto") => None,
        Some(name) => Some(name.parse().map_err(|_| {
            let words = "none, pade, uniform, uniform-pade, conformal, borel-pade or auto";
            usage(format!("there is no method {name:?}"), words)
        })?),
    };
    Ok(Evaluate {
        order: options.parsed("order")?,
        method,
        times: options.read("times", Times::parse)?,
        phase: options.exact("phase")?.unwrap_or_else(|| Exact::Rational(0.into())),
    })
}

fn evaluated(case: &Oscillator, options: &Options, work: &Work) -> Asked {
    if case.condition() == Some(Condition::FreeAmplitude) {
        let start = options.read("start", |text| Ok(AveragedStart::parse_amplitude(text)?))?;
        let state = options.read("state", |text| Ok(AveragedStart::parse_state(text)?))?;
        let order = options.parsed("order")?;
        let times = options.read("times", Times::parse)?;
        options.finish()?;
        let question = AveragedMotion { order, start: start.or(state), times };
        return boxed(case.averaged_motion(&question, work));
    }
    let question = evaluate(options)?;
    let prove = options.flag("prove");
    let languages =
        [("rust", Language::Rust), ("python", Language::Python), ("latex", Language::Latex)];
    let code = options.choice("code", &languages)?;
    let harmonics = options.parsed("harmonics")?.unwrap_or(15);
    let mut axes = options.axes(case)?.into_iter();
    options.finish()?;
    match (axes.next(), axes.next(), code) {
        (None, _, Some(language)) => {
            boxed(case.solution_code(&question, language, harmonics, work))
        }
        (None, _, None) if prove => boxed(case.prove(&question, work)),
        (None, _, None) => boxed(case.evaluate(&question, work)),
        (Some(axis), None, _) if prove => boxed(case.prove_sweep(&question, axis, work)),
        (Some(_), Some(_), _) if prove => Err(usage("a proved family is over one parameter", "")),
        (Some(columns), rows, _) => boxed(case.evaluate_sweep(&question, columns, rows, work)),
    }
}

fn respond(case: &Oscillator, options: &Options) -> Result<Respond, Error> {
    let sweeps = options.text("sweep").unwrap_or_default();
    let sweeps = sweeps.split(';').filter(|text| !text.is_empty());
    let mut axes = sweeps.map(|text| Respond::read_sweep(case, text));
    let question = Respond {
        order: options.parsed("order")?,
        sweep: axes.next().transpose()?,
        second: axes.next().transpose()?,
        amplitude: options.exact("box")?,
        follow: options.flag("follow"),
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
    options.choice("branch", &[("+", Branch::Plus), ("-", Branch::Minus)])
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

fn section(options: &Options) -> Result<Option<Section>, Error> {
    let words = [
        ("stroboscopic", Section::Stroboscopic),
        ("impact", Section::Impact),
        ("velocity", Section::Velocity),
    ];
    options.choice("section", &words)
}

/// A bifurcation diagram over the parameter of `sweep`.
pub fn diagram(sweep: &str, options: &Options) -> Result<Bifurcation, Error> {
    let usual = Bifurcation::over(sweep);
    let question = Bifurcation {
        start: start(options)?,
        section: section(options)?,
        skipped: options.parsed("skip")?.unwrap_or(usual.skipped),
        kept: options.parsed("keep")?.unwrap_or(usual.kept),
        follow: options.flag("follow"),
        ..usual
    };
    options.finish()?;
    Ok(question)
}

fn simulate(case: &Oscillator, options: &Options, work: &Work) -> Asked {
    if let Some(sweep) = options.text("sweep") {
        return boxed(case.bifurcation(&diagram(&sweep, options)?, work));
    }
    let (lyapunov, zero_one) = (options.flag("lyapunov"), options.flag("zero_one"));
    let start = start(options)?;
    if lyapunov || zero_one {
        let usual = Chaos::default();
        let question = Chaos {
            start,
            lyapunov,
            zero_one,
            kept: options.parsed("periods")?.unwrap_or(usual.kept),
            skipped: options.parsed("skip")?.unwrap_or(usual.skipped),
        };
        options.finish()?;
        return boxed(case.chaos(&question, work));
    }
    let until = options.exact("until")?.map(End::Time);
    let periods = options.parsed("periods")?.map(End::Periods);
    let impacts = options.parsed("impacts")?.map(End::Impacts);
    let views = [("phase", View::Phase), ("time", View::Time), ("section", View::Section)];
    let question = Simulate {
        start,
        end: until.or(periods).or(impacts),
        times: options.read("times", Simulate::read_times)?,
        section: section(options)?,
        skip: options.parsed("skip")?,
        drawn: true,
        view: options.choice("figure", &views)?,
    };
    options.finish()?;
    boxed(case.motion(&question, work))
}

/// The question for a threshold.
pub fn threshold(case: &Oscillator, options: &Options) -> Result<Threshold, Error> {
    let question = Threshold {
        sweep: options.axes(case)?,
        zeros: options.read("zeros", Axis::ends)?,
        subharmonics: options.parsed("subharmonics")?,
    };
    options.finish()?;
    Ok(question)
}

/// The question for a stability.
pub fn stability(case: &Oscillator, options: &Options) -> Result<Stability, Error> {
    let variants = [
        ("E", (Variant::E, false)),
        ("S", (Variant::S, false)),
        ("P", (Variant::P, false)),
        ("impact-aware", (Variant::E, true)),
    ];
    let kicks = [
        ("none", Kick::None),
        ("mean", Kick::Mean),
        ("before", Kick::Before),
        ("after", Kick::After),
    ];
    let predictors = [("both", (true, true)), ("kbm", (true, false)), ("exact", (false, true))];
    let (variant, impact_aware) =
        options.choice("variant", &variants)?.unwrap_or((Variant::E, false));
    let (predict, exact) = options.choice("predictor", &predictors)?.unwrap_or((true, true));
    let question = Stability {
        order: options.parsed("order")?.unwrap_or(1),
        variant,
        impact_aware,
        kick: options.choice("kick", &kicks)?.unwrap_or(Kick::Mean),
        predict,
        exact,
        branch: branch(options)?,
        sweep: options.axes(case)?,
    };
    options.finish()?;
    Ok(question)
}
