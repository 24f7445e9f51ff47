//! try
use lindstedt::{algebra::*, coeff::*, equation::*, expand::*, phase::*, *};
use rug::Rational;
use std::time::Instant;
struct B;
impl Binding<Rationals> for B {
    fn parameter(&self, _: &str) -> Option<Rational> { None }
    fn formal(&self, _: &str, _: usize) -> Option<Rational> { None }
}
impl Binding<PolynomialRing> for B {
    fn parameter(&self, _: &str) -> Option<Polynomial> { None }
    fn formal(&self, _: &str, n: usize) -> Option<Polynomial> { Some(PolynomialRing::default().symbol(Symbol::Sum(n as u16))) }
}
fn run<A: PhaseAlgebra>(a: &A, name: &str, c: Condition, order: usize) where B: Binding<A::Constants> {
    let p = problems::find(name).unwrap();
    let t = Instant::now();
    let e = compile(a, &p.equation, &B, order).unwrap();
    let x = match expand::expand(a, &e, &Request{condition: c, order, record: false, leading_amplitude: leading_amplitude(a,&e,c).unwrap()}, &mut |w| { if w.order % 20 == 0 || name == "power-law" || name == "pendulum" { println!("{w:?} {:?}", t.elapsed()); } true }) { Ok(x) => x, Err(e) => { println!("{name}: {e}"); return } };
    let t1 = t.elapsed();
    if order <= 8 { println!("W {:?}\n amp {:?}", x.frequency_squared, x.amplitude); }
    let r = check(a, &e, &x);
    println!("{name} {order}: expand {t1:?} total {:?} residual {r:?} {:?}", t.elapsed(), x.work.last());
}
struct R; impl multimodular::RationalBinding for R { fn parameter(&self, _: &str) -> Option<Rational> { None } }
fn modular(name: &str, c: Condition, n: usize) {
    let t = Instant::now();
    let p = problems::find(name).unwrap();
    let r = multimodular::derive(&p.equation, &R, c, n, &mut |k| { println!("{k} primes {:?}", t.elapsed()); true }).unwrap();
    println!("{name} {n} {:?} primes {} proof {} W {:?}", t.elapsed(), r.primes, r.proof_primes, &r.expansion.frequency_squared[..7.min(n)]);
    if n <= 40 { 
      let a = Trigonometric::new(Rationals);
      let e = compile(&a, &p.equation, &B, n).unwrap();
      let x = expand::expand(&a, &e, &Request{condition: c, order: n, record: false, leading_amplitude: leading_amplitude(&a,&e,c).unwrap()}, &mut |_| true).unwrap();
      println!("plain {:?} same {} {}", t.elapsed(), x.solution == r.expansion.solution, x.frequency_squared == r.expansion.frequency_squared && x.amplitude == r.expansion.amplitude);
    }
}
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let n: usize = args[2].parse().unwrap();
    let q = Trigonometric::new(Rationals);
    let l = Lobachevsky::new(PolynomialRing::default());
    match &args[1][..] {
        "md" => modular("duffing", Condition::InitialAmplitude, n),
        "mf" => modular("duffing", Condition::FundamentalAmplitude, n),
        "mv" => modular("van-der-pol", Condition::LimitCycle, n),
        "duffing" => run(&q, "duffing", Condition::InitialAmplitude, n),
        "duffing-f" => run(&q, "duffing", Condition::FundamentalAmplitude, n),
        "van-der-pol" => run(&q, "van-der-pol", Condition::LimitCycle, n),
        p => run(&l, p, Condition::InitialAmplitude, n),
    }
}
