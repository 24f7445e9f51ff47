//! Steady states of slow flows against what is known by hand.

mod branches;
mod free_phase;
mod search;
mod several;
mod survey;

use lindstedt_number::Exact;
use lindstedt_number::interval::Interval;
use lindstedt_orbit::steady::{ComplexTerm, Course, Flow, Value};
use rug::Rational;

pub fn term(amplitudes: &[u32], parameters: &[u32], re: (i64, i64), im: (i64, i64)) -> ComplexTerm {
    let (re, im) = (Rational::from(re), Rational::from(im));
    let (amplitudes, parameters) = (amplitudes.to_vec(), parameters.to_vec());
    ComplexTerm { amplitudes, parameters, re, im, radius: 0.0 }
}

/// w' = -(i/4) F - mu w - i s w + (3/2) i al w^2 conj w; parameters s, mu, al, F. Nayfeh and Mook, section 4.1.
pub fn duffing() -> Flow {
    let equation = vec![
        term(&[0, 0], &[0, 0, 0, 1], (0, 1), (-1, 4)),
        term(&[1, 0], &[0, 1, 0, 0], (-1, 1), (0, 1)),
        term(&[1, 0], &[1, 0, 0, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0, 1, 0], (0, 1), (3, 2)),
    ];
    Flow::of_complex(&[equation], &["s", "mu", "al", "F"])
}

/// w' = -(i/4) F + w/2 - i s w - w^2 conj w/2; parameters s, F.
pub fn van_der_pol() -> Flow {
    let equation = vec![
        term(&[0, 0], &[0, 1], (0, 1), (-1, 4)),
        term(&[1, 0], &[0, 0], (1, 2), (0, 1)),
        term(&[1, 0], &[1, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0], (-1, 2), (0, 1)),
    ];
    Flow::of_complex(&[equation], &["s", "F"])
}

pub fn value(text: &str) -> Option<Value> {
    Exact::parse(text).ok().map(|value| Value::from(&value))
}

pub fn at(values: &[&str]) -> Vec<Option<Value>> {
    values.iter().map(|text| value(text)).collect()
}

pub fn amplitude(w: &[f64]) -> f64 {
    2.0 * w[0].hypot(w[1])
}

pub fn square(r: f64) -> Vec<Interval> {
    vec![Interval::new(-r, r); 2]
}

pub fn course(parameter: usize, range: [f64; 2], step: f64) -> Course {
    let stop = Default::default();
    Course {
        parameter,
        range,
        second: None,
        positive: None,
        unknowns: 2,
        reach: 2.0,
        step,
        most: 20_000,
        stop,
    }
}
