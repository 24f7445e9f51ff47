use super::*;
use lindstedt_algebra::{Rationals, laws};

type Derivation = fn(&Torus<Rationals>, &TorusElement<Rational>) -> TorusElement<Rational>;

fn q(n: i32, d: u32) -> Rational {
    Rational::from((n, d))
}

fn algebra() -> Torus<Rationals> {
    // A delay in which psi turns by the angle of 3 + 4 i and eta by that of 5 + 12 i.
    let delay = Delay { time: q(2, 1), free: [q(3, 5), q(4, 5)], forced: [q(5, 13), q(12, 13)] };
    Torus::new(Rationals, q(1, 1), Some(q(3, 7)), vec![delay])
}

fn samples(t: &Torus<Rationals>) -> Vec<TorusElement<Rational>> {
    let ring = t.constants();
    let a = |n, c| ring.power(n, c);
    let first = t.harmonic((1, -2), [a(1, q(1, 2)), a(3, q(-2, 3))]);
    let second = t.harmonic((0, 1), [a(0, q(5, 1)), ring.zero()]);
    let sum = t.add(&first, &t.add(&second, &t.harmonic((2, 1), [ring.zero(), a(2, q(1, 9))])));
    vec![t.zero(), t.one(), t.generating_solution(), first, sum]
}

#[test]
fn laws_hold() {
    let t = algebra();
    assert_eq!(laws::rational_algebra(&t, &samples(&t)), Ok(()));
    for f in samples(&t) {
        for g in samples(&t) {
            let product = t.mul(&f, &g);
            let derivations: [Derivation; 3] =
                [|t, f| t.by_amplitude(f), |t, f| t.by_phase(f), |t, f| t.by_time(f)];
            for d in derivations {
                let leibniz = t.sum_of_products(&[(&d(&t, &f), &g), (&f, &d(&t, &g))]);
                assert_eq!(d(&t, &product), leibniz, "Leibniz");
            }
            let shift = |f| t.shift(f, 0).unwrap_or_else(|| t.zero());
            assert_eq!(shift(&product), t.mul(&shift(&f), &shift(&g)), "shifts multiply");
        }
    }
}

/// The resolved parts put back into the equation give f again.
#[test]
fn averaging_rebuilds() {
    let t = algebra();
    let ring = t.constants();
    let number = |c| ring.embed(c);
    // Without damping and delay L(i) = 0; then with a damping and a delay, where it is not:
    // L(D_0) acts on the response, L'(i) on the first harmonic, and both are checked.
    let undamped = LinearPart {
        stiffness: ring.one(),
        damping: ring.zero(),
        delayed: vec![(ring.zero(), ring.zero())],
    };
    let general = LinearPart {
        stiffness: number(q(2, 3)),
        damping: number(q(1, 5)),
        delayed: vec![(number(q(1, 7)), number(q(-1, 2)))],
    };
    for linear in [undamped, general] {
        for f in samples(&t) {
            let Ok(split) = t.average(&linear, &f) else { panic!("no resonance") };
            let apply = |u: &TorusElement<Rational>| {
                let (du, late) = (t.by_time(u), t.shift(u, 0).unwrap_or_else(|| t.zero()));
                let (b, c) = &linear.delayed[0];
                let terms = [
                    t.by_time(&du),
                    t.scale_by(&du, &linear.damping),
                    t.scale_by(u, &linear.stiffness),
                    t.scale_by(&late, b),
                    t.scale_by(&t.by_time(&late), c),
                ];
                terms.iter().fold(t.zero(), |sum, term| t.add(&sum, term))
            };
            let slope = |u: &TorusElement<Rational>| {
                let late = t.shift(u, 0).unwrap_or_else(|| t.zero());
                let (b, c) = &linear.delayed[0];
                let minus_delay = Rational::from(-2);
                let inner = t.add(&t.scale_by(&late, b), &t.scale_by(&t.by_time(&late), c));
                let terms = [
                    t.scale(&t.by_time(u), &q(2, 1)),
                    t.scale_by(u, &linear.damping),
                    t.scale_by(&late, c),
                    t.scale(&inner, &minus_delay),
                ];
                terms.iter().fold(t.zero(), |sum, term| t.add(&sum, term))
            };
            let x = t.generating_solution();
            let drift = t.add(
                &t.scale_by(&t.by_amplitude(&x), &split.amplitude_rate),
                &t.scale_by(&t.by_phase(&x), &split.phase_rate),
            );
            assert_eq!(t.add(&apply(&split.response), &slope(&drift)), f);
        }
    }
}

#[test]
fn resonances_are_named() {
    // omega = 1/3: three harmonics of the force meet the free frequency.
    let t = Torus::new(Rationals, q(1, 1), Some(q(1, 3)), Vec::new());
    let ring = t.constants();
    let linear = LinearPart { stiffness: ring.one(), damping: ring.zero(), delayed: Vec::new() };
    let f = t.harmonic((0, 3), [ring.one(), ring.zero()]);
    let resonance = PhaseError::Resonance { free: 0, forced: 3 };
    assert_eq!(t.average(&linear, &f).err(), Some(resonance));
}

/// A force a millionth beside the free frequency, as it stands and as a harmonic; one a twentieth beside it is no miss.
#[test]
fn near_misses_are_named() {
    for (omega, harmonic) in [(q(1_000_001, 1_000_000), (0, 1)), (q(1_000_001, 3_000_000), (0, 3))]
    {
        let t = Torus::new(Rationals, q(1, 1), Some(omega), Vec::new());
        let ring = t.constants();
        let linear =
            LinearPart { stiffness: ring.one(), damping: ring.zero(), delayed: Vec::new() };
        let size = q(1, 1) - q(1_000_001, 1_000_000).square();
        let near = PhaseError::NearMiss { free: 0, forced: harmonic.1, size };
        let f = t.harmonic(harmonic, [ring.one(), ring.zero()]);
        assert_eq!(t.average(&linear, &f).err(), Some(near));
    }
    let t = Torus::new(Rationals, q(1, 1), Some(q(21, 20)), Vec::new());
    let ring = t.constants();
    let linear = LinearPart { stiffness: ring.one(), damping: ring.zero(), delayed: Vec::new() };
    assert!(t.average(&linear, &t.harmonic((0, 1), [ring.one(), ring.zero()])).is_ok());
}
