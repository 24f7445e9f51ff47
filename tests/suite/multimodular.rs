//! The route over many primes against what the program found before its kernels were rewritten: digests of
//! omega^2 and of every x_n, by another reconstruction, other transforms and a proof modulo fresh primes.

use lindstedt::unstable::coeff::print::Style;
use lindstedt::unstable::equation::{Condition, Problem};
use lindstedt::{
    Derivation, Exact, ProblemFile, Quantity, Solution, unstable::derivation::Settings,
    unstable::derivation::derive, unstable::problems,
};

/// FNV-1a over the coefficients of omega^2, then x_0, x_1, ..., a line each.
fn digest(result: &Derivation) -> u64 {
    let exact = |n| result.exact(Quantity::FrequencySquared, n).unwrap() + "\n";
    let mut text: String = (0..=result.order).map(exact).collect();
    let x: Vec<String> =
        (0..=result.order).map(|n| result.print_solution(n, Style::Text)).collect();
    text += &x.join("\n");
    let step = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

fn file(text: &str) -> Problem {
    ProblemFile::parse(text).unwrap().problem
}

fn settled(order: usize, values: &[(&str, &str)], condition: Option<Condition>) -> Settings {
    let value = |(name, text): &(&str, &str)| ((*name).to_owned(), Exact::parse(text).unwrap());
    let parameters = values.iter().map(value).collect();
    Settings { order, condition, parameters, ..Settings::default() }
}

/// The problem, its settings, the digest, and how many primes that took.
type Case = (Problem, Settings, u64, usize);

fn cases() -> Vec<Case> {
    let fundamental = Some(Condition::FundamentalAmplitude);
    let helmholtz = file(include_str!("../../docs/examples/helmholtz-duffing.toml"));
    let rayleigh = file(include_str!("../../docs/examples/rayleigh.toml"));
    let both = file(include_str!("../../docs/examples/duffing-van-der-pol.toml"));
    let quintic = file(include_str!("../../docs/src/guide/quintic.toml"));
    let [duffing, cycle] = ["duffing", "van-der-pol"].map(|name| problems::find(name).unwrap());
    let even = [("alpha_3", "0"), ("omega_0", "5/3")];
    vec![
        (cycle.clone(), settled(40, &[], None), 0xb083_4b82_ca2d_65ae, 46),
        (cycle, settled(80, &[], None), 0xad70_4b44_16e2_4cfa, 166),
        (duffing.clone(), settled(80, &[], None), 0x7e48_66a8_8f2b_4c4c, 22),
        (duffing, settled(80, &[], fundamental), 0x1ef8_7e6d_7297_c1f6, 22),
        (helmholtz.clone(), settled(40, &[], None), 0x05ab_269f_a021_aa5e, 14),
        (helmholtz, settled(24, &even, None), 0x339c_8b21_74b3_a7da, 14),
        (rayleigh, settled(40, &[], None), 0xc117_202f_3657_e6cd, 46),
        (both, settled(40, &[], None), 0x8a61_97ab_92a1_8e03, 46),
        (quintic, settled(40, &[], None), 0x428c_a48d_e14a_7e0e, 22),
    ]
}

#[test]
fn every_order_is_what_it_was_and_takes_no_more_primes_than_its_numbers_need() {
    let mut taken = Vec::new();
    for (problem, settings, expected, primes) in cases() {
        let result = derive(&problem, &settings, &mut |_| true).unwrap();
        assert_eq!(result.checked_orders, Some(settings.order));
        assert_eq!(digest(&result), expected, "{} {}", problem.name, settings.order);
        let Solution::Rational(proved) = &result.solution else { unreachable!("over Q") };
        assert_eq!(proved.proof_primes, proved.primes + 2);
        taken.push((problem.name.to_string(), settings.order, proved.primes, primes));
    }
    // The work counter: so many primes, no more.
    let more: Vec<_> = taken.iter().filter(|(_, _, primes, expected)| primes > expected).collect();
    assert!(more.is_empty(), "{taken:?}");
}
