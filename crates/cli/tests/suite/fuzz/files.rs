//! Problem files with bytes, lines and words changed, in this process.

use super::{count, not_a_number, number};
use lindstedt::unstable::algebra::Stop;
use lindstedt::{Answer, Error, Evaluate, Oscillator, Refusal, Stability, Threshold, Work};
use lindstedt_report::{Format, Present, json};
use lindstedt_tests::Random;
use serde::Serialize;
use std::path::Path;
use std::time::{Duration, Instant};

/// Pieces that mean something in a problem file.
const PIECES: [&str; 40] = [
    "eps", "x''", "x'", "x", "(", ")", "^", "*", "+", "-", "/", "0", "1/3", "1e300", "-1",
    "cos(t)", "x(t - 1)", "y", "ln(x^2)", "= 0", "\"", "'''", "[", "]", "{", "}", "[parameters]",
    "[impact]", "[initial]", "value = \"0\"", "\n", "#", "\\u0000", "nan", "pi", "sin(x)", "|x|",
    "sign(x)", "taylor(sin(x), 3)", "k = {}",
];

/// The examples of the book.
fn seeds() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let files = paths.iter().filter(|path| path.extension().is_some_and(|end| end == "toml"));
    files.map(|path| std::fs::read_to_string(path).unwrap()).collect()
}

/// A file with one to four changes.
fn mutated(g: &mut Random, seeds: &[String]) -> String {
    let mut text: Vec<char> = seeds[g.below(seeds.len())].chars().collect();
    for _ in 0..=g.below(3) {
        let at = g.below(text.len().max(1));
        let to = (at + 1 + g.below(12)).min(text.len());
        match g.below(5) {
            0 => drop(text.splice(at..to, [])),
            1 => drop(text.splice(at..at, g.pick(&PIECES).chars())),
            2 => drop(text.splice(at..to, g.pick(&PIECES).chars())),
            3 => {
                let piece: Vec<char> = text[at..to].to_vec();
                drop(text.splice(at..at, piece));
            }
            _ => {
                let other: Vec<char> = seeds[g.below(seeds.len())].chars().collect();
                let from = g.below(other.len());
                let end = (from + 40).min(other.len());
                drop(text.splice(at..at, other[from..end].to_vec()));
            }
        }
    }
    text.into_iter().collect()
}

/// A refusal has a hint, an answer has numbers, in every format.
fn check<T: Serialize>(found: Result<Answer<T>, Error>, text: &str) -> Option<String>
where
    Answer<T>: Present,
{
    let answer = match found {
        Err(error) => return error.hint().is_empty().then(|| format!("no hint: {error}")),
        Ok(answer) => answer,
    };
    let page = answer.document();
    let formats = [Format::Text, Format::Latex, Format::Markdown, Format::Html];
    let mut shown: Vec<String> = formats.iter().map(|format| format.write(&page)).collect();
    shown.push(json(&answer).unwrap());
    shown
        .iter()
        .find_map(|shown| not_a_number(shown, text))
        .map(|word| format!("{word} as a result"))
}

/// Every question about a file, each for a moment.
fn defect(text: &str, limit: Duration) -> Option<String> {
    let oscillator = match Oscillator::file(text) {
        Err(error) => return error.hint().is_empty().then(|| format!("no hint: {error}")),
        Ok(oscillator) => oscillator,
    };
    let work = || {
        let start = Instant::now();
        let stop = Stop::new(move || start.elapsed() > limit);
        Work { digits: 10, memory: 256 << 20, stop, ..Work::default() }
    };
    let evaluate = Evaluate { order: Some(3), ..Evaluate::default() };
    check(oscillator.derive(2, &work()), text)
        .or_else(|| check(oscillator.evaluate(&evaluate, &work()), text))
        .or_else(|| check(oscillator.threshold(&Threshold::default(), &work()), text))
        .or_else(|| check(oscillator.stability(&Stability::default(), &work()), text))
}

fn attack(seed: u64, count: usize, limit: Duration) {
    let (mut g, seeds) = (Random(seed), seeds());
    let mut found = Vec::new();
    for _ in 0..count {
        let text = mutated(&mut g, &seeds);
        let start = Instant::now();
        let defect = defect(&text, limit);
        let slow = (start.elapsed() > Duration::from_secs(20)).then(|| "a hang".to_owned());
        found.extend(defect.or(slow).map(|what| format!("{what}\n{text}")));
    }
    assert!(found.is_empty(), "{} of {count}:\n{}", found.len(), found.join("\n----\n"));
}

#[test]
fn any_file_ends_in_answers_or_refusals() {
    attack(1, 100, Duration::from_millis(20));
}

#[test]
#[ignore = "3500 files, for the night"]
fn many_files() {
    attack(number("LINDSTEDT_SEED").unwrap_or(1000), count(3_500), Duration::from_millis(200));
}
