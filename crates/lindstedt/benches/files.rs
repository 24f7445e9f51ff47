//! Problem files: from the text to the tree, the classification, Melnikov's data and a threshold
//! along an orbit that has no closed form.

use divan::Bencher;
use lindstedt::unstable::equation::classify::classify;
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::recognise::MelnikovProblem;
use lindstedt::{Oscillator, ProblemFile, unstable::derivation::known_values};
use std::collections::BTreeMap;

fn main() {
    divan::main();
}

macro_rules! examples {
    ($($name:literal),*) => {
        [$(include_str!(concat!("../../../docs/examples/", $name, ".toml"))),*]
    };
}

const FILES: [&str; 6] = examples!(
    "delayed-duffing", "helmholtz-duffing", "pendulum", "rayleigh", "stick-slip", "vibro-impact"
);

/// Two wells with a force of degree 5: the orbit is integrated.
const NUMERIC: &str = r#"
name = "two-wells"
equation = "x'' - x + x^3 + x^5/4 = eps (gamma cos(omega t) - delta x')"
condition = []
[parameters]
gamma = { value = "3/10", meaning = "amplitude of the force" }
omega = { value = "1", meaning = "frequency of the force" }
delta = { value = "1/4", meaning = "damping" }
"#;

fn file(text: &str) -> ProblemFile {
    ProblemFile::parse(text).expect("a problem file")
}

#[divan::bench(sample_count = 20)]
fn parse_six_files(bencher: Bencher<'_, '_>) {
    bencher.bench(|| FILES.map(|text| file(text).problem.parameters.len()));
}

#[divan::bench(sample_count = 20)]
fn classify_six_files(bencher: Bencher<'_, '_>) {
    let files = FILES.map(file);
    let one =
        |f: &ProblemFile| classify(&f.problem, &known_values(&f.problem, &BTreeMap::new())).is_ok();
    bencher.bench(|| files.iter().filter(|f| one(f)).count());
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn recognise_a_threshold(bencher: Bencher<'_, '_>) {
    let oscillator = Oscillator::from_problem(&file(NUMERIC).problem).expect("a case");
    let (problem, values) = (oscillator.problem(), oscillator.all_values().into_iter().collect());
    bencher.bench(|| MelnikovProblem::new(problem, &values).is_ok());
}

/// The orbit by integration, the integrals by quadrature.
#[divan::bench(args = [16, 30], sample_count = 2, sample_size = 1)]
fn numeric_threshold(bencher: Bencher<'_, '_>, digits: u32) {
    let oscillator = Oscillator::from_problem(&file(NUMERIC).problem).expect("a case");
    let (problem, values) = (oscillator.problem(), oscillator.all_values().into_iter().collect());
    let found = MelnikovProblem::new(problem, &values).expect("a threshold");
    bencher.bench(|| found.thresholds(Balls::new(digits * 10 / 3 + 40)).map(|list| list.len()));
}
