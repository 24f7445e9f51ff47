use super::scalars::{Integers, Over};
use super::*;
use lindstedt_algebra::{
    AmplitudeAlgebra, ForcedAlgebra, FunctionAlgebra, LinearPart, PhaseError, RationalAlgebra,
    Rationals, Ring, laws,
};
use lindstedt_number::Whole;

type Element = AmplitudeElement<Whole>;

type Derivation = fn(&Amplitudes<Integers>, &Element) -> Element;

fn q(n: i32, d: u32) -> Rational {
    Rational::from((n, d))
}

/// A delay in which psi turns by the angle of 3 + 4 i and eta by that of 5 + 12 i.
fn late() -> [Delay<Rational>; 1] {
    [Delay { time: q(2, 1), turns: vec![[q(3, 5), q(4, 5)], [q(5, 13), q(12, 13)]] }]
}

fn algebra<S: Scalars<Number = Rational>>(scalars: S) -> Amplitudes<S> {
    let Some(algebra) = Amplitudes::off_resonance(scalars, &q(1, 1), Some(&q(3, 7))) else {
        panic!("two rates")
    };
    algebra.with_delays(&late())
}

/// Real and complex ones.
fn samples<S: Scalars>(t: &Amplitudes<S>) -> Vec<AmplitudeElement<S::Element>> {
    let (z, Some((cos, sin))) = (t.amplitude(0), t.forcing(1)) else { panic!("a force") };
    let x = t.twice_real(&z);
    let mixed = t.add(&t.mul(&t.mul(&x, &x), &sin), &t.scale(&cos, &q(-2, 3)));
    let complex = t.add(&t.mul(&z, &sin), &t.scale(&z, &q(1, 9)));
    vec![t.zero(), t.one(), x, mixed, complex]
}

#[test]
fn laws_hold() {
    let t = algebra(Integers);
    assert_eq!(laws::rational_algebra(&t, &samples(&t)), Ok(()));
    // Gathered sums of products, which have no common denominators.
    let gathered = algebra(Over::exact(Rationals));
    assert_eq!(laws::rational_algebra(&gathered, &samples(&gathered)), Ok(()));
    for f in samples(&gathered) {
        for g in samples(&gathered).iter().map(|g| gathered.twice_real(g)) {
            let slope = gathered.twice_real(&gathered.mul(&f, &gathered.by_amplitude(&g, 0)));
            assert_eq!(gathered.along(0, &[(&f, &g)]), slope);
        }
    }
    for f in samples(&t) {
        for g in samples(&t) {
            let product = t.mul(&f, &g);
            let derivations: [Derivation; 3] =
                [|t, f| t.by_amplitude(f, 0), |t, f| t.by_force(f, 0), |t, f| t.by_time(f)];
            for d in derivations {
                let leibniz = t.sum_of_products(&[(&d(&t, &f), &g), (&f, &d(&t, &g))]);
                assert_eq!(d(&t, &product), leibniz, "Leibniz");
            }
            let shift = |f| t.shift(f, 0).unwrap_or_else(|| t.zero());
            assert_eq!(shift(&product), t.mul(&shift(&f), &shift(&g)), "shifts multiply");
            assert_eq!(t.conjugate(&shift(&f)), shift(&t.conjugate(&f)), "shifts are real");
        }
    }
}

/// nu = alpha, a force of the symbolic rate omega, and a delay that turns the phases by constant ones: with
/// 1/(alpha^2 - omega^2) as a symbol.
fn of_formulas() -> Option<Amplitudes<Integers>> {
    let t = Amplitudes::of_formulas(Integers, &["alpha", "omega", "T", "D"], 2)?;
    let [alpha, omega, time] = ["alpha", "omega", "T"].map(|name| t.symbol(name));
    let (alpha, omega) = alpha.zip(omega)?;
    let turns = vec![t.constant_phase(0, -1)?, t.constant_phase(1, -1)?];
    let late = Late { time: time?, turns };
    t.with_rates(&alpha, Some(&omega)).with_late(vec![late]).with_divisor("omega", "D")
}

#[test]
fn laws_hold_over_formulas() {
    let Some(t) = of_formulas() else { panic!("room for four symbols") };
    let symbol = |name| t.symbol(name).unwrap_or_else(|| t.zero());
    let [alpha, omega, divided] = ["alpha", "omega", "D"].map(symbol);
    let Some(turn) = t.constant_phase(0, 3) else { panic!("a phase") };
    let square = |f: &Element| t.mul(f, f);
    // D (alpha^2 - omega^2) = 1 and, of powers of omega, the first alone.
    let difference = t.sub(&square(&alpha), &square(&omega));
    assert_eq!(t.mul(&difference, &divided), t.one());
    assert_eq!(t.reciprocal(&difference), Some(divided.clone()));
    assert_eq!(t.reciprocal(&omega), None);
    assert_eq!(t.mul(&turn, &t.conjugate(&turn)), t.one());
    assert_eq!(t.as_constant(&turn), Some(turn.clone()));
    let mixed = t.add(&t.mul(&square(&omega), &t.mul(&omega, &turn)), &t.scale(&divided, &q(2, 3)));
    let mut all = samples(&t);
    all.extend([alpha, t.mul(&turn, &t.amplitude(0)), mixed]);
    assert_eq!(laws::rational_algebra(&t, &all), Ok(()));
    let shift = |f: &Element| t.shift(f, 0).unwrap_or_else(|| t.zero());
    for f in &all {
        for g in &all {
            let product = t.mul(f, g);
            let leibniz = t.sum_of_products(&[(&t.by_time(f), g), (f, &t.by_time(g))]);
            assert_eq!(t.by_time(&product), leibniz, "Leibniz");
            assert_eq!(shift(&product), t.mul(&shift(f), &shift(g)), "shifts multiply");
        }
        assert_eq!(t.conjugate(&shift(f)), shift(&t.conjugate(f)), "shifts are real");
        assert_eq!(t.by_time(&shift(f)), shift(&t.by_time(f)), "shifts do not change");
    }
    // (D_0^2 + alpha^2) u + 2 i alpha f + conj = g.
    let linear =
        LinearPart { stiffness: square(&symbol("alpha")), damping: t.zero(), delayed: Vec::new() };
    let Some((cos, _)) = t.forcing(1) else { panic!("a force") };
    let g = t.twice_real(&t.add(&t.mul(&turn, &t.amplitude(0)), &cos));
    let Ok(split) = t.split(0, &linear, &g) else { panic!("off resonance") };
    assert_eq!(split.response, t.scale(&t.mul(&cos, &divided), &q(2, 1)));
    let drift = t.twice_real(&split.flow);
    let u = &split.response;
    let twice = t.by_time(&t.by_time(u));
    let applied = t.add(&twice, &t.mul(&linear.stiffness, u));
    assert_eq!(t.add(&applied, &t.scale(&t.by_time(&drift), &q(2, 1))), g);
    // Beyond the exponents of words nothing is formed, and it is said.
    let power = |n| lindstedt_coeff::polynomial::power(&t, &turn, n);
    assert!(!t.is_zero(&power(42)) && !t.overflowed());
    assert!(t.is_zero(&power(43)) && t.overflowed());
}

/// The resolved parts put back into the equation give f again.
#[test]
fn a_split_rebuilds() {
    let t = algebra(Integers);
    let number = |c| t.rational(&c);
    // Without damping and delay L(i) = 0; then with a damping and a delay, where it is not:
    // L(D_0) acts on the response, L'(i) on the first harmonic, and both are checked.
    let free =
        LinearPart { stiffness: t.one(), damping: t.zero(), delayed: vec![(t.zero(), t.zero())] };
    let general = LinearPart {
        stiffness: number(q(2, 3)),
        damping: number(q(1, 5)),
        delayed: vec![(number(q(1, 7)), number(q(-1, 2)))],
    };
    for linear in [free, general] {
        for f in samples(&t) {
            let f = t.twice_real(&f);
            let Ok(split) = t.split(0, &linear, &f) else { panic!("no resonance") };
            assert!(t.is_off_resonance(0, &split.response));
            let (b, c) = &linear.delayed[0];
            let late = |u: &Element| t.shift(u, 0).unwrap_or_else(|| t.zero());
            let sum =
                |terms: &[Element]| terms.iter().fold(t.zero(), |sum, term| t.add(&sum, term));
            let gain = |u: &Element| t.add(&t.mul(u, b), &t.mul(&t.by_time(u), c));
            let u = &split.response;
            let du = t.by_time(u);
            let applied = sum(&[
                t.by_time(&du),
                t.mul(&du, &linear.damping),
                t.mul(u, &linear.stiffness),
                gain(&late(u)),
            ]);
            let drift = t.twice_real(&split.flow);
            let slope = sum(&[
                t.scale(&t.by_time(&drift), &q(2, 1)),
                t.mul(&drift, &linear.damping),
                t.mul(&late(&drift), c),
                t.scale(&gain(&late(&drift)), &q(-2, 1)),
            ]);
            assert_eq!(t.add(&applied, &slope), f);
        }
    }
}

/// omega = 1/3: three harmonics of the force meet the free frequency. A force a millionth beside it, as it stands and as
/// a harmonic, is named too; one a twentieth beside it is no miss.
#[test]
fn resonances_and_near_misses_are_named() {
    let refused = |omega: Rational, forced: u32| {
        let Some(t) = Amplitudes::off_resonance(Integers, &q(1, 1), Some(&omega)) else {
            panic!("two rates")
        };
        let linear = LinearPart { stiffness: t.one(), damping: t.zero(), delayed: Vec::new() };
        let Some((cos, _)) = t.forcing(forced) else { panic!("a force") };
        t.split(0, &linear, &cos).err()
    };
    assert_eq!(refused(q(1, 3), 3), Some(PhaseError::Resonance { free: 0, forced: 3 }));
    let size = q(1, 1) - q(1_000_001, 1_000_000).square();
    for (omega, forced) in [(q(1_000_001, 1_000_000), 1), (q(1_000_001, 3_000_000), 3)] {
        let size = size.clone();
        let near = PhaseError::NearMiss { free: 0, forced: forced as i32, size };
        assert_eq!(refused(omega, forced), Some(near));
    }
    assert_eq!(refused(q(21, 20), 1), None);
}

/// Words that differ in exponents anywhere are spread over the slots as if at random, of which 1 - e^(-1/2) were hit.
#[test]
fn words_that_differ_high_in_a_half_have_homes_of_their_own() {
    for places in [[0, 8], [48, 56], [0, 64], [48, 112], [56, 120], [96, 112], [112, 120]] {
        let word = |k: u32| {
            places.iter().zip([k / 32, k % 32]).fold(0, |w, (p, e)| w + (i128::from(e) << p))
        };
        let mut homes: Vec<usize> = (0..1024).map(|k| sums::home(word(k), 11)).collect();
        homes.sort_unstable();
        homes.dedup();
        assert!(homes.len() > 500, "{places:?} {}", homes.len());
    }
}

/// (x^d + y z^(d-1) + ...) of all monomials of a degree: numbered by two exponents, as of the third power nothing is
/// free. Numbered sums are hashed ones; words that relations of others do not tell apart are noticed.
#[test]
fn numbered_sums_are_hashed_sums() {
    let Some(t) = Amplitudes::of_formulas(Integers, &["x", "y", "z"], 0) else { panic!("symbols") };
    let symbols = ["x", "y", "z"].map(|name| t.symbol(name).unwrap_or_else(|| t.zero()));
    let monomial = |exponents: [u32; 3]| {
        let powers = symbols.iter().zip(exponents);
        powers.fold(t.one(), |product, (symbol, e)| (0..e).fold(product, |p, _| t.mul(&p, symbol)))
    };
    let homogeneous = |degree: u32| {
        let mut sum = t.zero();
        for (i, j) in (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))) {
            let n = Rational::from(7 * i + 3 * j + 1);
            let term = t.scale(&monomial([i, j, degree - i - j]), &n);
            t.add_assign(&mut sum, &if (i + j) % 2 == 0 { term } else { t.turned(&term) });
        }
        sum
    };
    let (f, g) = (homogeneous(9), homogeneous(10));
    let lists = [[&f.terms[..], &g.terms[..]]];
    let free = sums::independent(t.layout, t.exponents(), &lists);
    assert_eq!(free.count_ones(), 2);
    let of = |sum: sums::Sum<Whole>, lists: [&[Term<Whole>]; 2]| {
        let mut sum = sum;
        t.accumulate(&mut sum, lists, &Whole::from(3i64))?;
        Some(sum.sorted(|| Whole::ZERO))
    };
    let numbered = |lists: [&[Term<Whole>]; 2]| {
        let exponents = (0..DIGITS).filter(|i| free >> i & 1 == 1);
        let numbering = sums::Numbering::of(t.layout, &[lists], exponents, 1 << 20);
        numbering.and_then(|numbering| of(sums::Sum::numbered(numbering), lists))
    };
    assert!(numbered(lists[0]).is_some_and(|sum| sum.len() > 200));
    assert_eq!(numbered(lists[0]), of(sums::Sum::hashed(), lists[0]));
    // Of two degrees the same two exponents say too little.
    let both = t.add(&f, &g);
    assert_eq!(numbered([&both.terms, &g.terms]), None);
    // The product itself: by evaluation of what is known, f g = g f with the factors the other way round, and twice.
    assert_eq!(t.mul(&f, &g), t.mul(&g, &f));
    assert_eq!(t.mul(&both, &g), t.add(&t.mul(&f, &g), &t.mul(&g, &g)));
    assert_eq!(t.independent.load(Ordering::Relaxed).count_ones(), 3);
}

/// Frequencies are counted in their common measure: 10^100 and its triple are 1 and 3, 1 and 10^26 are compared exactly, and
/// what exceeds the words is not taken.
#[test]
fn long_rates_are_compared_exactly() {
    let power = |n: u32| Rational::from(Integer::from(Integer::u_pow_u(10, n)));
    let of = |nu: Rational, force: Rational| Amplitudes::new(Integers, &[nu], &force, &[]);
    let split = |t: &Amplitudes<Integers>, nu: &Rational, m: u32| {
        let stiffness = t.rational(&nu.clone().square());
        let linear = LinearPart { stiffness, damping: t.zero(), delayed: Vec::new() };
        let (cos, _) = t.forcing(m)?;
        let split = t.split(0, &linear, &cos).ok()?;
        Some((t.is_zero(&split.response), t.is_zero(&split.flow)))
    };
    let huge = power(100);
    let Some(t) = of(huge.clone(), Rational::from(&huge / 3u32)) else { panic!("a ratio of 3") };
    let z = t.amplitude(0);
    let square = t.rational(&-huge.clone().square());
    assert_eq!(t.by_time(&t.by_time(&z)), t.mul(&square, &z));
    assert_eq!(split(&t, &huge, 3), Some((true, false)), "resonance");
    assert_eq!(split(&t, &huge, 2), Some((false, true)), "none");
    let long = power(26);
    let beside = Rational::from(&long + 1u32);
    for (force, resonant) in [(long.clone(), true), (beside, false)] {
        let Some(t) = of(long.clone(), force) else { panic!("26 digits") };
        assert_eq!(split(&t, &long, 1), Some((resonant, !resonant)));
    }
    assert!(of(power(0), power(28)).is_none());
}
