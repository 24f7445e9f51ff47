//! What a stranger finds: plain data, words for closed sets, errors down to their source, examples.

use lindstedt::grid::Axis;
use lindstedt::unstable::algebra::PhaseError;
use lindstedt::unstable::expand::ExpandError;
use lindstedt::unstable::problem_file::{FileErrorKind, ParseError};
use lindstedt::unstable::series::resummation::{Method, ResummationError};
use lindstedt::{
    Answer, Condition, DerivationError, Error, EvaluationError, Exact, Header, Kind, Number,
    Oscillator, Quantity, Refusal, Remark, Route, Standing, Status, Work,
};
use std::collections::BTreeSet;
use std::error::Error as Source;
use std::fmt::{Debug, Display};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use std::str::FromStr;

fn data<T: serde::Serialize + Clone + Debug + Send + Sync>() {}
fn shown<T: Display + Clone + Debug>() {}
fn words<T: Display + FromStr + Clone + Debug + PartialEq>() {}

/// The answer of a verb is plain data; nothing is asked here.
fn answer<Q, T>(_: impl Fn(&Oscillator, Q, &Work) -> Result<Answer<T>, Error>)
where
    T: serde::Serialize + Clone + Debug + Send + Sync,
{
    data::<Answer<T>>();
}

#[test]
fn answers_are_data_and_closed_sets_are_words() {
    use lindstedt::evaluate::{Language, averaged::AveragedMotion};
    use lindstedt::motion::{Bifurcation, Chaos};
    answer(|o, n: usize, w| o.derive(n, w));
    answer(|o, n: usize, w| o.average(n, w));
    answer(|o, tier, w| o.estimate(1, tier, w));
    answer(|o, q: &lindstedt::Evaluate, w| o.evaluate(q, w));
    answer(|o, q: &lindstedt::Evaluate, w| o.prove(q, w));
    answer(|o, (q, axis): (&lindstedt::Evaluate, Axis), w| o.evaluate_sweep(q, axis, None, w));
    answer(|o, q: &lindstedt::Evaluate, w| o.solution_code(q, Language::Rust, 3, w));
    answer(|o, q: &AveragedMotion, w| o.averaged_motion(q, w));
    answer(|o, q: &lindstedt::Verify, w| o.verify(q, w));
    answer(|o, q: &lindstedt::trade::Plan, w| o.trade(q, w));
    answer(|o, q: &lindstedt::Simulate, w| o.motion(q, w));
    answer(|o, q: &Chaos, w| o.chaos(q, w));
    answer(|o, q: &Bifurcation, w| o.bifurcation(q, w));
    answer(|o, q: &lindstedt::Threshold, w| o.threshold(q, w));
    answer(|o, n: usize, w| o.homoclinic("mu", n, w));
    answer(|o, name: &str, w| o.persistence(name, w));
    answer(|o, q: &lindstedt::Stability, w| o.stability(q, w));
    answer(|o, q: &lindstedt::Respond, w| o.respond(q, w));
    data::<lindstedt::catalogue::Catalogue>();
    data::<Header>();
    data::<Number>();
    shown::<Status>();
    shown::<Standing>();
    shown::<Kind>();
    shown::<Remark>();
    shown::<Oscillator>();
    words::<Exact>();
    words::<Condition>();
    words::<Quantity>();
    words::<Route>();
    words::<Method>();
    for quantity in Quantity::ALL {
        assert_eq!(quantity.to_string().parse(), Ok(quantity));
        assert_eq!(serde_json::to_value(quantity).ok(), Some(quantity.name().into()));
    }
    let same = |c: Condition| c.to_string().parse() == Ok(c);
    assert!(Condition::ALL.into_iter().all(same));
    assert!(Route::ALL.into_iter().all(|r| r.to_string().parse() == Ok(r)));
    assert!(Method::ALL.into_iter().all(|m| m.to_string().parse() == Ok(m)));
    assert_eq!("1/2,1".parse::<Axis>().err().map(|error| error.code()), Some("sweep"));
}

/// The lowest error below one, itself where there is none.
fn lowest(error: &Error) -> &(dyn Source + 'static) {
    let mut error: &(dyn Source + 'static) = error;
    while let Some(below) = error.source() {
        error = below;
    }
    error
}

#[test]
fn errors_lead_down_to_their_source() {
    let phase = PhaseError::Resonance { free: 1, forced: 0 };
    let expand = ExpandError::Phase { order: 2, source: phase.clone() };
    let evaluation = EvaluationError::Derivation(DerivationError::Expand(expand));
    let error = Error::from(evaluation);
    assert_eq!((error.code(), error.kind()), ("resonance", Kind::NoAnswer));
    assert_eq!(lowest(&error).downcast_ref(), Some(&phase));
    let reason = ResummationError::NoMap;
    let error = Error::from(EvaluationError::Resummation { problem: "x".to_owned(), reason });
    assert_eq!(lowest(&error).downcast_ref(), Some(&ResummationError::NoMap));
    let error = Oscillator::file("equation = \"x'' + * x = 0\"").unwrap_err();
    let kind = lowest(&error).downcast_ref::<FileErrorKind>();
    assert!(matches!(kind, Some(FileErrorKind::Equation(ParseError { .. }))), "{error:?}");
    let error = Error::from("spiral".parse::<Condition>().unwrap_err());
    assert!(error.code() == "usage" && error.hint().contains("limit-cycle"), "{error}");
}

/// A built-in problem has no file: its refusals show the piece of the equation, a file's its place, too.
#[test]
fn places_are_those_of_files_that_somebody_has() {
    let refused = |o: Oscillator| o.derive(1, &Work::default()).unwrap_err().to_string();
    let belt = Oscillator::builtin("stick-slip").unwrap();
    let text = belt.problem_file().to_text();
    assert_eq!(refused(belt), "stick-slip: sign(x' - vstar) is not smooth");
    let file = Oscillator::file(&text).unwrap();
    assert_eq!(refused(file), "stick-slip:3:41: sign(x' - vstar) is not smooth");
    let alone = Oscillator::parse("x'' + x + eps*sign(x') = 0").unwrap();
    assert_eq!(refused(alone), "oscillator: sign(x') is not smooth");
}

/// All Rust sources below a folder.
fn sources(folder: &Path) -> String {
    let mut text = String::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            text.push_str(&sources(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            text.push_str(&read_to_string(&path).unwrap());
        }
    }
    text
}

/// The doc comment of an item of a crate; nothing where there is no such item.
fn documentation(text: &str, name: &str) -> Option<String> {
    let named = |line: &str| {
        let rest =
            ["pub struct ", "pub enum ", "pub trait "].iter().find_map(|k| line.strip_prefix(k));
        let end = |c: char| !c.is_alphanumeric() && c != '_';
        rest.and_then(|rest| rest.split(end).next()) == Some(name)
    };
    let lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|line| named(line))?;
    let above = lines[..at].iter().rev().take_while(|line| !line.is_empty() && **line != "}");
    Some(above.filter(|line| line.starts_with("///")).copied().collect::<Vec<_>>().join("\n"))
}

/// Every type at the root of the facade has an example of its own, and every question is asked in one.
#[test]
fn every_main_item_has_an_example() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let facade = sources(&crates.join("lindstedt/src"));
    let root = read_to_string(crates.join("lindstedt/src/lib.rs")).unwrap();
    let (mut seen, mut missing) = (0, BTreeSet::new());
    for item in root.split("\npub use ").skip(1) {
        let item = item.split(';').next().unwrap_or_default();
        let (from, names) = item.split_once("::").unwrap();
        let folder = from.strip_prefix("lindstedt_").map(|name| name.replace('_', "-"));
        let folder: PathBuf = crates.join(folder.as_deref().unwrap_or("lindstedt")).join("src");
        let text = sources(&folder);
        let word = |c: char| !c.is_alphanumeric() && c != '_';
        let types = names.split(word).filter(|name| {
            name.chars().any(|c| c.is_ascii_lowercase())
                && name.starts_with(|c: char| c.is_uppercase())
        });
        for name in types {
            seen += 1;
            if !documentation(&text, name).unwrap().contains("```") {
                missing.insert(format!("{from}::{name}"));
            }
        }
    }
    let docs: Vec<&str> = facade.lines().map(str::trim).filter(|l| l.starts_with("//")).collect();
    let verbs = facade.split("    pub fn ").skip(1).filter_map(|item| {
        let (signature, _) = item.split_once(" {\n")?;
        let asked = signature.contains("Result<Answer<");
        asked.then(|| signature.split(['(', '<']).next().unwrap_or_default())
    });
    for verb in verbs {
        seen += 1;
        if !docs.iter().any(|line| line.contains(&format!(".{verb}("))) {
            missing.insert(verb.to_owned());
        }
    }
    assert!(seen >= 45, "{seen}");
    assert!(missing.is_empty(), "no example: {missing:?}");
}
