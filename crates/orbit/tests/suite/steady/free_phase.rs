//! States but for a phase that the flow leaves free.

use super::term;
use lindstedt_number::interval::Interval;
use lindstedt_orbit::steady::{ComplexTerm, Flow, FreePhase, Limits, Zero, all_states, all_zeros};
use rug::Rational;

/// w_1' = -(mu + i s) w_1 + i h conj w_2 + i w_1^2 conj w_1, w_2' = -mu w_2 + i h conj w_1 is the same for w_1 e^{i theta},
/// w_2 e^{-i theta}. By hand, with w_1 = a and w_2 = a y: Im y = mu/h, |y| = 1, a^2 = s - 2 h Re y.
#[test]
fn steady_but_for_a_phase() {
    let [mu, s, h] = [(1, 10), (1, 1), (1, 4)].map(Rational::from);
    let zero = Rational::new;
    let term = |amplitudes: [u32; 4], re: Rational, im: Rational| ComplexTerm {
        amplitudes: amplitudes.to_vec(),
        parameters: vec![],
        re,
        im,
        radius: 0.0,
    };
    let first = vec![
        term([1, 0, 0, 0], -mu.clone(), -s.clone()),
        term([0, 0, 0, 1], zero(), h.clone()),
        term([2, 1, 0, 0], zero(), 1.into()),
    ];
    let second =
        vec![term([0, 0, 1, 0], -mu.clone(), zero()), term([0, 1, 0, 0], zero(), h.clone())];
    let equations = [first, second];
    let flow = Flow::of_complex(&equations, &[]).system(&[]);
    let weights = [1, -1].map(Rational::from);
    let free = FreePhase { equations, weights, parameters: vec![], energy: None, definite: false };
    let region = [Interval::new(-1.0, 1.0), Interval::new(-1.0, 1.0), Interval::new(0.0, 1.0)];
    let limits = Limits { modulus: Some(1.0), ..Limits::default() };
    let divide = Rational::from((137, 100));
    let search = |c: usize, most: Rational| {
        let reduced = free.reduced(c, &[2.into(), most]).unwrap();
        let found = all_zeros(&reduced.system(&[]), &region, &limits).unwrap();
        assert!(found.is_proved(), "{c}: {:?} {:?}", found.undecided, found.at_edge);
        found.zeros
    };
    let zeros = search(0, divide.clone());
    assert_eq!((zeros.len(), search(1, divide.recip()).len()), (2, 0));
    for zero in zeros {
        let y = zero.middle();
        let [re, im, a] = [1.37 * y[0], 1.37 * y[1], 2.0 * y[2]];
        assert!((im - 0.4).abs() < 1e-9 && (re.hypot(im) - 1.0).abs() < 1e-9);
        assert!((a * a - (1.0 - 0.5 * re)).abs() < 1e-9);
        // w_2' = -i delta w_2.
        let (delta, exponents) = free.drift(&flow, &[a, 0.0, a * re, a * im]);
        assert!((delta + 0.25 * re).abs() < 1e-9, "{delta}");
        // Liouville: the sum is the trace, and there are three.
        let sum: f64 = exponents.iter().map(|x| x.re).sum();
        assert!((sum + 0.4).abs() < 1e-9 && exponents.len() == 3);
        // The larger amplitude (Re y < 0) is the stable one.
        assert_eq!(exponents.iter().all(|x| x.re < 0.0), re < 0.0);
    }
}

/// A forced unknown that damps or drives another one whose phase is free: its states are those without the other, as the search
/// in all four unknowns has them; where the other one moves by itself its states are circles, and nothing is decided.
#[test]
fn an_unknown_with_a_free_phase() {
    let equations = |growth: (i64, i64), rate: (i64, i64)| {
        let forced = vec![
            term(&[0, 0, 0, 0], &[], (0, 1), (-1, 4)),
            term(&[1, 0, 0, 0], &[], (-1, 10), (-1, 1)),
            term(&[2, 1, 0, 0], &[], (0, 1), (3, 2)),
            term(&[1, 0, 1, 1], &[], (0, 1), (1, 3)),
        ];
        let free = vec![
            term(&[0, 0, 1, 0], &[], growth, rate),
            term(&[1, 1, 1, 0], &[], (1, 7), (1, 5)),
            term(&[0, 0, 2, 1], &[], (-1, 1), (0, 1)),
        ];
        [forced, free]
    };
    let limits = Limits { modulus: Some(1.5), boxes: 300_000, ..Limits::default() };
    let moves = Flow::of_complex(&equations((-1, 5), (1, 3)), &[]);
    let found = all_states(&moves, &[], 1.5, &limits).unwrap();
    let region = [Interval::new(-1.5, 1.5); 4];
    let known = all_zeros(&moves.system(&[]), &region, &limits).unwrap();
    assert!(found.is_proved() && known.is_proved());
    assert_eq!((found.zeros.len(), known.zeros.len()), (3, 3));
    assert!(10 * found.boxes < known.boxes, "{} {}", found.boxes, known.boxes);
    for zero in &found.zeros {
        let near = |other: &Zero| {
            other.middle().iter().zip(zero.middle()).all(|(a, b)| (a - b).abs() < 1e-12)
        };
        assert!(known.zeros.iter().any(near));
    }
    // Re A = 1/5 - |w|^2 + ... and Im B = 0 have a common zero: circles of states.
    let mut circles = equations((1, 5), (0, 1));
    circles[1].retain(|t| t.amplitudes[0] == 0);
    let circles = Flow::of_complex(&circles, &[]);
    let few = Limits { boxes: 20_000, ..limits };
    assert!(!all_states(&circles, &[], 1.5, &few).unwrap().is_proved());
}
