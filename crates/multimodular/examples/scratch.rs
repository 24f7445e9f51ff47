//! scratch
#![allow(missing_docs, clippy::all)]
use lindstedt_algebra::Stop;
use lindstedt_multimodular::{RationalBinding, derive, frequency};
use rug::Rational;
struct NoNames;
impl RationalBinding for NoNames {
    fn parameter(&self, _: &str) -> Option<Rational> {
        None
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let problem = lindstedt_problems::find(&a[1]).unwrap();
    let (equation, condition) = (&problem.equation, problem.conditions[0]);
    let n = a[2].parse().unwrap();
    if a.len() > 3 {
        let f =
            frequency(equation, &NoNames, condition, n, &Stop::default(), &mut |_| true).unwrap();
        println!("{} {}", f.primes, f.frequency.last().unwrap().numer().significant_bits());
        if a[3] == "check" {
            let d =
                derive(equation, &NoNames, condition, n, &Stop::default(), &mut |_| true).unwrap();
            assert!(
                d.frequency == f.frequency
                    && d.period == f.period
                    && d.expansion.frequency_squared == f.squared
            );
            println!("same");
        }
        return;
    }
    let proved = derive(equation, &NoNames, condition, n, &Stop::default(), &mut |_| true).unwrap();
    println!("{} {}", proved.primes, proved.frequency.last().unwrap().numer().significant_bits());
}
