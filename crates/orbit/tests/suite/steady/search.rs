//! All zeros in a box: their number, and where they lie.

use super::{amplitude, at, duffing, square, term};
use lindstedt_number::interval::Interval;
use lindstedt_orbit::steady::{
    ComplexTerm, Flow, Limits, Polynomial, System, Zero, all_states, all_zeros, bound,
};
use rug::Rational;

pub fn polynomial(terms: &[(&[u32], (i64, i64))]) -> Polynomial {
    let mut sum = Polynomial::default();
    for (exponents, q) in terms {
        sum.add_term(exponents, &Rational::from(*q));
    }
    sum
}

#[test]
fn roots_on_cuts_are_counted() {
    // (x^2 - 1/4)(x - 1) x: roots on cuts of [-2, 2].
    let p = polynomial(&[(&[4], (1, 1)), (&[3], (-1, 1)), (&[2], (-1, 4)), (&[1], (1, 4))]);
    let system = System::new(&[p], &[]);
    let found = all_zeros(&system, &[Interval::new(-2.0, 2.0)], &Limits::default()).unwrap();
    assert!(found.is_proved());
    let mut roots: Vec<f64> = found.zeros.iter().map(|zero| zero.middle()[0]).collect();
    roots.sort_by(f64::total_cmp);
    for (root, known) in roots.iter().zip([-0.5, 0.0, 0.5, 1.0]) {
        assert!((root - known).abs() < 1e-14);
    }
    assert_eq!(roots.len(), 4);
    let radius = bound(&system).unwrap();
    assert!((1.0..3.0).contains(&radius), "{radius}");
}

#[test]
fn a_double_root_is_undecided_not_none() {
    let p = polynomial(&[(&[2], (1, 1)), (&[1], (-2, 3)), (&[], (1, 9))]);
    let system = System::new(&[p], &[]);
    let found = all_zeros(&system, &[Interval::new(-2.0, 2.0)], &Limits::default()).unwrap();
    assert_eq!((found.zeros.len(), found.undecided.len()), (0, 1));
    assert!(found.undecided[0][0].contains(1.0 / 3.0));
}

/// (mu^2 + (s - 3 al a^2/8)^2) a^2 = F^2/4 at every state, their number that of the cubic's positive roots.
#[test]
fn primary_resonance_states() {
    for (s, mu, count) in
        [("1", "1/10", 3), ("-1", "1/10", 1), ("1/2", "1", 1), ("pi/4", "1/20", 3)]
    {
        let values = at(&[s, mu, "1", "1/2"]);
        let system = duffing().system(&values);
        let radius = bound(&system).unwrap();
        let found = all_zeros(&system, &square(radius), &Limits::default()).unwrap();
        assert!(found.is_proved() && found.boxes < 5000, "{} boxes", found.boxes);
        assert_eq!(found.zeros.len(), count, "s = {s}, mu = {mu}");
        let number = |k: usize| values[k].as_ref().unwrap().interval().middle();
        for zero in &found.zeros {
            let a = amplitude(&zero.middle());
            let left = (number(1).powi(2) + (number(0) - 0.375 * a * a).powi(2)) * a * a;
            assert!((left - 0.0625).abs() < 1e-13, "{left}");
            assert!(zero.enclosure.iter().all(|x| x.width() < 1e-13));
        }
    }
}

/// w' = conj(w)^2 - w: w = 0 and the three roots of one, on a circle that the search may or may not reach.
#[test]
fn zeros_beside_the_largest_modulus() {
    let equation = vec![term(&[0, 2], &[], (1, 1), (0, 1)), term(&[1, 0], &[], (-1, 1), (0, 1))];
    let system = Flow::of_complex(&[equation], &[]).system(&[]);
    for (modulus, inside, at_edge) in [(0.999, 1, 0), (1.0, 1, 3), (1.001, 4, 0)] {
        let limits = Limits { modulus: Some(modulus), ..Limits::default() };
        let found = all_zeros(&system, &square(modulus), &limits).unwrap();
        assert_eq!((found.zeros.len(), found.at_edge.len()), (inside, at_edge), "{modulus}");
        assert_eq!((found.is_proved(), found.undecided.len()), (at_edge == 0, 0));
    }
    // All zeros lie within the bound in modulus, not in both parts alone.
    assert!((1.0..3.0).contains(&bound(&system).unwrap()));
}

/// Coefficients within a radius: the enclosures contain the zeros of every flow within it.
#[test]
fn coefficients_within_a_radius() {
    let flow = |radius: f64, force: i64| {
        let with = |mut term: ComplexTerm| {
            term.radius = radius;
            term
        };
        let terms = vec![
            with(term(&[0, 0], &[], (0, 1), (-force, 4_000_000))),
            with(term(&[1, 0], &[], (-1, 10), (-1, 1))),
            with(term(&[2, 1], &[], (0, 1), (3, 2))),
        ];
        Flow::of_complex(&[terms], &[])
    };
    let limits = Limits { boxes: 20_000, ..Limits::default() };
    let found = |flow: &Flow| all_states(flow, &[], 1.5, &limits).unwrap();
    let wide = found(&flow(1e-6, 1_000_000));
    assert!(wide.is_proved() && wide.zeros.len() == 3);
    for force in [1_000_003, 999_997] {
        let other = found(&flow(0.0, force));
        for zero in other.zeros {
            let inside = |known: &Zero| {
                known.enclosure.iter().zip(zero.middle()).all(|(x, a)| x.contains(a))
            };
            assert!(wide.zeros.iter().any(inside), "{:?}", zero.enclosure);
        }
    }
    assert!(!found(&flow(1e-1, 1_000_000)).is_proved());
}
