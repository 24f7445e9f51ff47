//! Counting the cells of a grid and judging them.

use lindstedt::unstable::number::ball::Ball;
use lindstedt::{Exact, Number, Status};
use rug::{Float, Rational};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// The cells of one grid.
#[derive(Default)]
pub struct Grid {
    certified: usize,
    estimated: usize,
    refused: BTreeMap<String, usize>,
    defects: Vec<String>,
    slowest: (Duration, String),
}

impl Grid {
    /// One cell; a panic is a defect of it and not the end of the grid.
    pub fn cell(&mut self, label: &str, work: impl FnOnce(&mut Self)) {
        let start = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| work(self))).is_err() {
            self.defect(label, "panic");
        }
        if start.elapsed() > self.slowest.0 {
            self.slowest = (start.elapsed(), label.to_owned());
        }
        if start.elapsed() > Duration::from_secs(20) {
            eprintln!("{:.1?} {label}", start.elapsed());
        }
    }

    pub fn defect(&mut self, label: &str, what: impl Into<String>) {
        self.defects.push(format!("{label}: {}", what.into()));
    }

    /// A refusal, counted by the name of the error.
    pub fn refused(&mut self, error: &impl Debug) {
        let text = format!("{error:?}");
        let name: Vec<&str> =
            text.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
        let inner = name.iter().rev().find(|w| w.starts_with(char::is_uppercase));
        let first = name.first().copied().unwrap_or("");
        *self.refused.entry(format!("{first}/{}", inner.unwrap_or(&""))).or_default() += 1;
    }

    /// An enclosure: the truth, known to 2^-`bits` relative, lies in it.
    pub fn certified(&mut self, label: &str, found: &Ball, truth: &Float, bits: u32) {
        if !found.is_finite() {
            return self.refused(&"Indeterminate");
        }
        let blur = blur(truth, bits);
        let distance = Float::with_val(64, found.midpoint() - truth).abs();
        if distance.is_nan() || distance > Float::with_val(64, found.radius() + blur) {
            return self.defect(
                label,
                format!("{} +- {} misses {truth:.20}", found.midpoint(), found.radius()),
            );
        }
        self.certified += 1;
    }

    /// A printed number of any class with its error.
    pub fn number(&mut self, label: &str, found: &Number, truth: &Float, bits: u32) {
        let parse = |text: &str| Float::with_val(truth.prec() + 64, Float::parse(text).unwrap());
        let value = parse(&found.decimal);
        if found.error.is_none() && found.status == Status::Estimated {
            return self.defect(label, format!("{} without an error", found.decimal));
        }
        let error = found.error.as_deref().map_or_else(|| Float::new(64), parse);
        let distance = Float::with_val(64, &value - truth).abs();
        let allowed = Float::with_val(64, &error + blur(truth, bits));
        if !value.is_finite() || distance.is_nan() || distance > allowed {
            let text = format!("{} +- {error} misses {truth:.20}", found.decimal);
            return self.defect(label, text);
        }
        match found.status {
            Status::Estimated => self.estimated += 1,
            _ => self.certified += 1,
        }
    }

    /// A number with an estimated error; an infinite error says that nothing is known.
    pub fn estimated(
        &mut self,
        label: &str,
        value: &Float,
        error: &Float,
        truth: &Float,
        bits: u32,
    ) {
        if error.is_infinite() && error.is_sign_positive() {
            return self.refused(&"Infinite");
        }
        let distance = Float::with_val(64, value - truth).abs();
        let allowed = Float::with_val(64, error + blur(truth, bits));
        if distance.is_nan() || allowed.is_nan() || distance > allowed {
            return self.defect(label, format!("{value:.20} +- {error:.3} misses {truth:.20}"));
        }
        self.estimated += 1;
    }

    /// Prints the counts; every defect fails the test, and more than so many refusals in a hundred cells.
    pub fn finish(self, name: &str, most_refused: usize) {
        let refused: usize = self.refused.values().sum();
        println!(
            "{name}: {} cells: {} certified, {} estimated, {refused} refused {:?}, {} defects; slowest {:.2?} {}",
            self.certified + self.estimated + refused + self.defects.len(),
            self.certified,
            self.estimated,
            self.refused,
            self.defects.len(),
            self.slowest.0,
            self.slowest.1
        );
        for line in self.defects.iter().take(60) {
            println!("  {line}");
        }
        assert!(self.defects.is_empty(), "{name}: {} defects", self.defects.len());
        let cells = self.certified + self.estimated + refused;
        assert!(
            100 * refused <= most_refused * cells && refused < cells,
            "{name}: {refused} of {cells} refused"
        );
    }
}

/// 2^-bits |truth|.
fn blur(truth: &Float, bits: u32) -> Float {
    Float::with_val(64, truth.abs_ref()) >> bits
}

pub fn set(list: &[(&str, &str)]) -> BTreeMap<String, Exact> {
    list.iter().map(|(n, v)| ((*n).to_owned(), Exact::parse(v).unwrap())).collect()
}

pub fn rational(text: &str) -> Rational {
    Exact::parse(text).unwrap().as_rational().unwrap().clone()
}
