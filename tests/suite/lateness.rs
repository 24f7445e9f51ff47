//! How much work engines do after they are asked to stop: processor time of the one thread that works and asks, so
//! that what else the machine does has no part in it.
#![cfg(target_os = "linux")]
use lindstedt::evaluate::Language;
use lindstedt::grid::Axis;
use lindstedt::motion::End;
use lindstedt::numeric::Tier;
use lindstedt::unstable::algebra::Stop;
use lindstedt::{
    Derive, Error, Evaluate, Exact, Kind, Oscillator, Refusal, Route, Simulate, Stability,
    Standing, Work,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// When the question is answered with yes.
const LIMIT: f64 = 0.06;
/// What is allowed after it. Measured: 0.00 to 0.02, but 0.1 to 0.24 for the exact leading order of a long power.
const LATE: f64 = 0.3;

/// Processor seconds of this thread.
fn taken() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split_whitespace().next().unwrap().parse::<f64>().unwrap() * 1e-9
}

/// How long a question goes on after the limit, and how it ended; in one thread.
fn late(
    ask: impl FnOnce(&Work) -> Result<Standing, Error> + Send,
) -> (f64, bool, Result<Standing, Error>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let (begin, told) = (taken(), Arc::new(AtomicBool::new(false)));
        let teller = told.clone();
        let stop = Stop::new(move || {
            let over = taken() - begin > LIMIT;
            teller.fetch_or(over, Ordering::Relaxed);
            over
        });
        let found = ask(&Work { stop, ..Work::default() });
        (taken() - begin - LIMIT, told.load(Ordering::Relaxed), found)
    })
}

fn case(text: &str) -> Oscillator {
    match text.contains('\'') {
        true => Oscillator::parse(text).unwrap(),
        false => Oscillator::builtin(text).unwrap(),
    }
}

fn with(text: &str, values: &[(&str, &str)]) -> Oscillator {
    let values = values.iter().map(|(name, value)| (*name, Exact::parse(value).unwrap()));
    values.fold(case(text), |case, (name, value)| case.with(name, value))
}

type Question = Box<dyn FnOnce(&Work) -> Result<Standing, Error> + Send>;

fn questions() -> Vec<(&'static str, Question)> {
    let digits = |work: &Work, digits| Work { digits, ..work.clone() };
    let motion = move |work: &Work| {
        let question = Simulate { end: Some(End::Periods(6)), ..Simulate::default() };
        Ok(case("duffing").motion(&question, &digits(work, 2000))?.standing)
    };
    let averaged =
        |work: &Work| Ok(case("x'' + x = eps*(1 + x + x' + cos(t))^50").average(4, work)?.standing);
    let sums = move |work: &Work| {
        let pendulum = with("pendulum", &[("amplitude", "3.14159")]);
        Ok(pendulum.evaluate(&Evaluate::default(), &digits(work, 10_000))?.standing)
    };
    let tables = |work: &Work| {
        Ok(case("power-law").estimate(4, Tier::Collocation { digits: 1000 }, work)?.standing)
    };
    let flight = |work: &Work| {
        let orbit = with("vibro-impact", &[("omega", "1/10")]);
        Ok(orbit.stability(&Stability::default(), work)?.standing)
    };
    let power = |work: &Work| {
        let question = Derive { order: 6, route: Route::Automatic };
        Ok(case("x'' + x + eps*x^800").derive(question, work)?.standing)
    };
    let code = |work: &Work| {
        let power = case("power-law");
        Ok(power.solution_code(&Evaluate::default(), Language::Rust, 12, work)?.standing)
    };
    let cells = |work: &Work| {
        let axes = ["A=-1/3..1/3:1001", "B=-1/3..1/3:1001"];
        let question =
            Stability { sweep: axes.map(|a| Axis::parse(a).unwrap()).into(), ..<_>::default() };
        Ok(case("vibro-impact").stability(&question, work)?.standing)
    };
    let points = |work: &Work| {
        let [eps, a] = ["eps=0..1:3000", "amplitude=1..2:3000"].map(|a| Axis::parse(a).unwrap());
        Ok(case("duffing").evaluate_sweep(&Evaluate::default(), eps, Some(a), work)?.standing)
    };
    let proof = move |work: &Work| {
        let orbit = with("duffing", &[("eps", "10")]);
        Ok(orbit.prove(&Evaluate::default(), &digits(work, 1000))?.standing)
    };
    vec![
        ("products of a thousand digits", Box::new(proof)),
        ("Taylor levels", Box::new(motion)),
        ("averaged powers", Box::new(averaged)),
        ("sums of sines", Box::new(sums)),
        ("tables of a grid", Box::new(tables)),
        ("the flight of an orbit", Box::new(flight)),
        ("a long power", Box::new(power)),
        ("the phases of a function", Box::new(code)),
        ("a chart", Box::new(cells)),
        ("a sweep", Box::new(points)),
    ]
}

#[test]
fn engines_end_soon_after_they_are_asked_to() {
    let mut wrong = Vec::new();
    for (name, question) in questions() {
        let (late, told, found) = late(question);
        println!("{name}: {late:.3} s late, {found:?}");
        let stopped = match &found {
            Ok(standing) => matches!(standing, Standing::Stopped { .. }),
            Err(error) => error.kind() == Kind::Stopped,
        };
        if !told || !stopped || late > LATE {
            wrong.push(format!("{name}: {late:.3} s late, {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
