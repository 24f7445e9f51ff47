//! Clock.
#![allow(warnings, missing_docs)]
use lindstedt_algebra::Stop;
use lindstedt_equation::Condition;
use lindstedt_multimodular::{RationalBinding, derive, frequency};
struct NoNames;
impl RationalBinding for NoNames {
    fn parameter(&self, _: &str) -> Option<rug::Rational> {
        None
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let problem = lindstedt_problems::find(&a[1]).unwrap();
    let n: usize = a[2].parse().unwrap();
    let condition =
        if a[1] == "van-der-pol" { Condition::LimitCycle } else { problem.conditions[0] };
    let eq = problem.equation.canonical();
    if a.len() > 3 {
        let f = frequency(&eq, &NoNames, condition, n, &Stop::default(), &mut |_| true).unwrap();
        println!("{} {}", f.primes, f.squared[n].numer().significant_bits());
    } else {
        let f = derive(&eq, &NoNames, condition, n, &Stop::default(), &mut |_| true).unwrap();
        println!("{} {}", f.primes, f.frequency[n].numer().significant_bits());
    }
}
