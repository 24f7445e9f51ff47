//! The same question to a built-in name, to its own file, and to the library with either: one answer, what a
//! clock says apart.

use crate::program::{self, Folder, refuses};
use lindstedt::evaluate::averaged::{AveragedMotion, Start};
use lindstedt::evaluate::{Language, Times};
use lindstedt::grid::Axis;
use lindstedt::motion::{Bifurcation, Chaos, End};
use lindstedt::numeric::Tier;
use lindstedt::trade::Plan;
use lindstedt::unstable::equation::Condition;
use lindstedt::unstable::series::resummation::Method;
use lindstedt::{
    Answer, Derive, Error, Evaluate, Exact, Oscillator, Route, Simulate, Stability, Threshold,
    Verify, Work,
};
use serde::Serialize;
use serde_json::Value;

/// Keys that hold times, or follow from them.
const TIMED: [&str; 4] = ["seconds", "seconds_again", "pareto", "recommendation"];

/// The answer without what a clock says.
fn masked(answer: Value) -> Value {
    match answer {
        Value::Object(map) => {
            let kept = map.into_iter().filter(|(key, _)| !TIMED.contains(&key.as_str()));
            Value::Object(kept.map(|(key, value)| (key, masked(value))).collect())
        }
        Value::Array(list) => Value::Array(list.into_iter().map(masked).collect()),
        value => value,
    }
}

fn library<T: Serialize>(answer: Result<Answer<T>, Error>) -> Value {
    masked(serde_json::from_str(&serde_json::to_string(&answer.unwrap()).unwrap()).unwrap())
}

fn asked(verb: &str, problem: &str, options: &[&str]) -> Value {
    let arguments = [&[verb, problem, "--quiet"], options].concat();
    masked(program::json(&arguments))
}

/// A command, and the same question in Rust. `--set`, `--normalisation` and `--digits` are read from the
/// command.
type Question = (&'static str, fn(&Oscillator, &Work) -> Value);

fn orders(order: usize) -> Evaluate {
    Evaluate { order: Some(order), ..Evaluate::default() }
}

fn axis(text: &str) -> Axis {
    Axis::parse(text).unwrap()
}

fn plan(orders: &[usize]) -> Plan {
    let (orders, run_seconds) = (orders.to_vec(), 60.0);
    let (digits, harmonics) = (vec![16], vec![16]);
    Plan { orders, digits, harmonics, run_seconds, repeats: 1, ..Plan::default() }
}

const DERIVED: &[Question] = &[
    ("derive duffing --order 3", |o, w| library(o.derive(3, w))),
    ("derive van-der-pol --order 3", |o, w| library(o.derive(3, w))),
    ("derive power-law --order 3", |o, w| library(o.derive(3, w))),
    ("derive pendulum --order 3", |o, w| library(o.derive(3, w))),
    ("derive duffing --order 4 --set amplitude=1/3", |o, w| library(o.derive(4, w))),
    ("derive power-law --order 2 --set amplitude=2", |o, w| library(o.derive(2, w))),
    ("derive duffing --order 3 --normalisation fundamental", |o, w| library(o.derive(3, w))),
    ("derive duffing --order 6 --route energy", |o, w| {
        library(o.derive(Derive { order: 6, route: Route::EnergyIntegral }, w))
    }),
    ("derive vibro-impact --order 2 --normalisation free", |o, w| library(o.average(2, w))),
    ("derive van-der-pol --order 2 --normalisation free", |o, w| library(o.average(2, w))),
    ("derive duffing --order 2 --normalisation free", |o, w| library(o.average(2, w))),
    ("derive duffing --order 3 --tier collocation --digits 20", |o, w| {
        library(o.estimate(3, Tier::Collocation { digits: 20 }, w))
    }),
    ("derive power-law --order 2 --tier collocation --digits 12", |o, w| {
        library(o.estimate(2, Tier::Collocation { digits: 12 }, w))
    }),
    ("derive van-der-pol --order 3 --tier fourier --harmonics 16", |o, w| {
        library(o.estimate(3, Tier::Fourier { harmonics: 16 }, w))
    }),
];

const EVALUATED: &[Question] = &[
    ("evaluate duffing --order 6 --set eps=1/2", |o, w| library(o.evaluate(&orders(6), w))),
    ("evaluate van-der-pol --order 12 --set eps=1/2", |o, w| library(o.evaluate(&orders(12), w))),
    ("evaluate power-law --order 6", |o, w| library(o.evaluate(&orders(6), w))),
    ("evaluate pendulum --order 4 --digits 12", |o, w| library(o.evaluate(&orders(4), w))),
    ("evaluate duffing --order 6 --set eps=1/2 --resum pade", |o, w| {
        library(o.evaluate(&Evaluate { method: Some(Method::Pade), ..orders(6) }, w))
    }),
    ("evaluate duffing --order 6 --set eps=1/5 --times 0..1:3 --digits 10", |o, w| {
        let times = Some(Times::parse("0..1:3").unwrap());
        library(o.evaluate(&Evaluate { times, ..orders(6) }, w))
    }),
    ("evaluate duffing --set eps=1/2 --prove", |o, w| library(o.prove(&Evaluate::default(), w))),
    ("evaluate van-der-pol --set eps=1/2 --prove", |o, w| {
        library(o.prove(&Evaluate::default(), w))
    }),
    ("evaluate duffing --order 6 --sweep eps=0..1:3", |o, w| {
        library(o.evaluate_sweep(&orders(6), axis("eps=0..1:3"), None, w))
    }),
    ("evaluate van-der-pol --order 6 --sweep eps=1/4,1/2", |o, w| {
        library(o.evaluate_sweep(&orders(6), axis("eps=1/4,1/2"), None, w))
    }),
    ("evaluate van-der-pol --set eps=1/10 --order 2 --normalisation free --start 1,0", |o, w| {
        let start = Some(Start::parse_amplitude("1,0").unwrap());
        library(o.averaged_motion(&AveragedMotion { order: Some(2), start, times: None }, w))
    }),
    ("evaluate vibro-impact --order 1 --start 1,0", |o, w| {
        let start = Some(Start::parse_amplitude("1,0").unwrap());
        library(o.averaged_motion(&AveragedMotion { order: Some(1), start, times: None }, w))
    }),
    ("evaluate duffing --order 6 --set eps=1/10 --code python --harmonics 3", |o, w| {
        library(o.solution_code(&orders(6), Language::Python, 3, w))
    }),
    ("verify duffing --order 2", |o, w| {
        library(o.verify(&Verify { order: 2, ..Verify::default() }, w))
    }),
    ("verify van-der-pol --order 1", |o, w| {
        library(o.verify(&Verify { order: 1, ..Verify::default() }, w))
    }),
    ("verify power-law --order 1", |o, w| {
        library(o.verify(&Verify { order: 1, ..Verify::default() }, w))
    }),
    ("trade duffing --set eps=1/2 --orders 2 --harmonics 16 --repeats 1 --limit-run 60", |o, w| {
        library(o.trade(&plan(&[2]), w))
    }),
    ("trade van-der-pol --orders 2,4 --harmonics 16 --repeats 1 --limit-run 60", |o, w| {
        library(o.trade(&plan(&[2, 4]), w))
    }),
];

const MOVED: &[Question] = &[
    ("threshold stick-slip --digits 8", |o, w| library(o.threshold(&Threshold::default(), w))),
    ("threshold stick-slip --digits 8 --sweep vstar=0..1:3", |o, w| {
        let sweep = vec![axis("vstar=0..1:3")];
        library(o.threshold(&Threshold { sweep, ..Threshold::default() }, w))
    }),
    ("threshold stick-slip --digits 8 --zeros vstar=0..1", |o, w| {
        let zeros = Some(Axis::ends("vstar=0..1").unwrap());
        library(o.threshold(&Threshold { zeros, ..Threshold::default() }, w))
    }),
    ("threshold stick-slip --digits 8 --subharmonics 2", |o, w| {
        library(o.threshold(&Threshold { subharmonics: Some(2), ..Threshold::default() }, w))
    }),
    ("stability vibro-impact --digits 10", |o, w| library(o.stability(&Stability::default(), w))),
    ("stability vibro-impact --digits 10 --order 2", |o, w| {
        library(o.stability(&Stability { order: 2, ..Stability::default() }, w))
    }),
    ("simulate duffing --periods 1 --digits 12", |o, w| {
        library(o.motion(&Simulate { end: Some(End::Periods(1)), ..Simulate::default() }, w))
    }),
    ("simulate pendulum --times 0..2:3 --digits 12", |o, w| {
        let times = Some(Simulate::read_times("0..2:3").unwrap());
        library(o.motion(&Simulate { times, ..Simulate::default() }, w))
    }),
    ("simulate van-der-pol --until 3 --digits 12", |o, w| {
        let end = Some(End::Time(Exact::parse("3").unwrap()));
        library(o.motion(&Simulate { end, ..Simulate::default() }, w))
    }),
    ("simulate vibro-impact --impacts 2 --digits 12", |o, w| {
        library(o.motion(&Simulate { end: Some(End::Impacts(2)), ..Simulate::default() }, w))
    }),
    ("simulate stick-slip --until 4 --digits 12", |o, w| {
        let end = Some(End::Time(Exact::parse("4").unwrap()));
        library(o.motion(&Simulate { end, ..Simulate::default() }, w))
    }),
    ("simulate stick-slip --lyapunov --periods 100 --skip 5", |o, w| {
        let (lyapunov, kept, skipped) = (true, 100, 5);
        library(o.chaos(&Chaos { lyapunov, kept, skipped, ..Chaos::default() }, w))
    }),
    ("simulate stick-slip --sweep gamma=1/2,1 --skip 4 --periods 6", |o, w| {
        let (kept, skipped) = (6, 4);
        let over = Bifurcation::over("gamma=1/2,1");
        library(o.bifurcation(&Bifurcation { kept, skipped, ..over }, w))
    }),
];

/// The values and the condition of a command, and its means.
fn placed(oscillator: Oscillator, options: &[&str]) -> (Oscillator, Work) {
    let (mut oscillator, mut work) = (oscillator, Work::default());
    for pair in options.windows(2) {
        match *pair {
            ["--set", set] => {
                let (name, value) = set.split_once('=').unwrap();
                oscillator = oscillator.set(name, value).unwrap();
            }
            ["--normalisation", "free"] => {
                oscillator = oscillator.under(Condition::FreeAmplitude).unwrap();
            }
            ["--normalisation", "fundamental"] => {
                oscillator = oscillator.under(Condition::FundamentalAmplitude).unwrap();
            }
            ["--digits", digits] => work.digits = digits.parse().unwrap(),
            _ => {}
        }
    }
    (oscillator, work)
}

/// Two answers to every question: of the library by name, and of the program by the file that it prints, which is what a
/// name stands for.
fn alike(questions: &[Question]) {
    for (command, question) in questions {
        let words: Vec<&str> = command.split(' ').collect();
        let (verb, problem, options) = (words[0], words[1], &words[2..]);
        let text = program::text(&["problems", "--show", problem]);
        let folder = Folder::new("one-path");
        let path = folder.file("printed.toml", &text);
        let builtin = placed(Oscillator::builtin(problem).unwrap(), options);
        // Digits of the table of times are its own.
        let options: Vec<&str> = match verb {
            "trade" => options.iter().copied().chain(["--digits", "16"]).collect(),
            _ => options.to_vec(),
        };
        let expected = question(&builtin.0, &builtin.1);
        assert_eq!(asked(verb, &path, &options), expected, "{command}");
        assert!(expected.as_object().unwrap().len() > 5, "{command}: {expected}");
    }
}

#[test]
fn derivations_are_alike() {
    alike(DERIVED);
}

#[test]
fn numbers_are_alike() {
    alike(EVALUATED);
}

#[test]
fn motions_are_alike() {
    alike(MOVED);
    assert!(DERIVED.len() + EVALUATED.len() + MOVED.len() >= 40);
}

/// Name, table of parameters and condition of a file may be left out: what it says otherwise is the same.
#[test]
fn a_file_of_one_line() {
    let folder = Folder::new("one-line");
    let name = "Hard_Spring.toml";
    let path = &folder.file(name, "equation = \"x'' + x + eps*beta*x^3 = 0\"\n");
    let options = ["--order", "2", "--set", "beta=1/2"];
    let mut answer = asked("derive", path, &options);
    assert_eq!(answer["problem"], "hard-spring");
    answer["problem"] = Value::from("oscillator");
    assert_eq!(answer, asked("derive", "x'' + x + eps*beta*x^3 = 0", &options));
    folder.file(name, "equation = \"x'' + x + eps*y^3 = 0\"\n");
    refuses(&["derive", path], 2, "y is the name of an unknown");
}

/// Pi is a number in every equation: a symbol where formulas are exact, its value in time, and refused with
/// what takes it where only rational numbers are.
#[test]
fn pi_is_a_number() {
    let equation = "x'' + x + eps*pi*x^3 = 0";
    let averaged = asked("derive", equation, &["--order", "1", "--normalisation", "free"]);
    let rate = &averaged["series"]["phase_rate"][1][0]["coefficient"];
    assert_eq!(rate["exact"], "3/8*pi");
    let motion = |equation: &str, set: &[&str]| {
        let options = ["--set", "eps=1/10", "--periods", "1", "--digits", "20"];
        asked("simulate", equation, &[&options[..], set].concat())["final"]["t"].clone()
    };
    let beta = motion("x'' + x + eps*beta*x^3 = 0", &["--set", "beta=pi"]);
    assert_eq!(motion(equation, &[]), beta);
    for (arguments, exit, words) in [
        (&["derive", equation][..], 3, "pi is irrational"),
        (&["derive", equation], 3, "`derive --normalisation free` keeps pi as a symbol"),
        (&["derive", equation, "--set", "pi=3"], 2, "pi is a number"),
    ] {
        refuses(arguments, exit, words);
    }
}

/// An equation in quotes is a problem; every name but those of unknowns is a parameter.
#[test]
fn an_equation_is_a_problem() {
    let equation = "x'' + x + eps*x^3 = 0";
    let work = Work { digits: 20, ..Work::default() };
    let derived = Oscillator::parse(equation).unwrap().derive(3, &work);
    let options = ["--order", "3", "--digits", "20"];
    assert_eq!(asked("derive", equation, &options), library(derived));
    let verdict = &asked("verify", equation, &["--order", "2"])["verdict"];
    assert_eq!(verdict, "agrees");
    let set = asked("derive", "x'' + x + eps*beta*x^3 = 0", &["--set", "beta=1/2", "--order", "1"]);
    assert_eq!(set["series"]["frequency"][1]["exact"], "3/16");
    for name in ["y", "x_2", "w", "x1"] {
        let equation = format!("x'' + x + eps*{name}*x^2 = 0");
        refuses(&["derive", &equation], 2, &format!("{name} is the name of an unknown"));
    }
}
