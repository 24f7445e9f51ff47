//! What is left out has no state, and no fold.

use super::*;

fn term(amplitudes: &[u32], parameters: &[u32], re: (i64, i64), im: (i64, i64)) -> ComplexTerm {
    let (re, im) = (Rational::from(re), Rational::from(im));
    let (amplitudes, parameters) = (amplitudes.to_vec(), parameters.to_vec());
    ComplexTerm { amplitudes, parameters, re, im, radius: 0.0 }
}

/// Integers below n.
fn numbers() -> impl FnMut(i64) -> i64 {
    let mut seed = 1u64;
    move |n| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as i64 % n
    }
}

/// Flows of two unknowns with random terms and constants that make a given point a state: no box with its moduli is excluded,
/// though many beside it are.
#[test]
fn no_moduli_of_states_are_excluded() {
    let mut random = numbers();
    let mut excluded = 0;
    for _ in 0..500 {
        let w: Vec<f64> = (0..4).map(|_| (random(33) - 16) as f64 / 16.0).collect();
        let mut equations: Vec<Vec<ComplexTerm>> = Vec::new();
        for j in 0..2 {
            let mut own = [0; 4];
            own[2 * j] = 1;
            let mut terms = vec![term(&own, &[], (-random(8), 8), (random(65) - 32, 8))];
            for _ in 0..3 {
                let powers: Vec<u32> = (0..4).map(|_| random(3) as u32 / 2).collect();
                let part = |n: i64| (n - 8, 8);
                terms.push(term(&powers, &[], part(random(17)), part(random(17))));
            }
            equations.push(terms);
        }
        let values = Flow::of_complex(&equations, &[]).system(&[]).values(&w);
        for (j, terms) in equations.iter_mut().enumerate() {
            let part = |k: usize| -Rational::from_f64(values[2 * j + k]).unwrap();
            terms.push(ComplexTerm {
                re: part(0),
                im: part(1),
                ..term(&[0; 4], &[], (0, 1), (0, 1))
            });
        }
        let flow = Flow::of_complex(&equations, &[]);
        let balance = Balance::of(&flow, &[]).unwrap();
        for width in [0.3, 0.1, 0.03, 0.01, 0.003] {
            let side = |pair: &[f64]| {
                let r = pair[0].hypot(pair[1]);
                Interval::new((r - 0.3 * width).max(0.0), r + 0.7 * width)
            };
            let cell: Region = w.chunks(2).map(side).collect();
            assert!(!balance.excludes(&cell), "{cell:?} {equations:?}");
            let beside: Region = cell.iter().map(|x| *x + Interval::point(2.0 * width)).collect();
            excluded += usize::from(balance.excludes(&beside));
        }
    }
    assert!(excluded > 200, "{excluded}");
}

/// Random flows of one unknown where the coefficient of conj w makes |G_w| = |G_conj w| at a point, which is a state by the
/// constant: a fold there, which lies in one of the places where folds can be.
#[test]
fn no_folds_are_excluded() {
    let mut random = numbers();
    let mut share = 0.0;
    for _ in 0..25 {
        let at: Vec<f64> = (0..3).map(|_| (random(33) - 16) as f64 / 16.0).collect();
        let mut terms = vec![
            term(&[1, 0], &[0], (-random(8), 8), (random(65) - 32, 8)),
            term(&[1, 0], &[1], (0, 1), (1, 1)),
        ];
        for _ in 0..3 {
            let powers = [random(5) as u32 / 2, random(4) as u32 / 2];
            let part = |n: i64| (n - 8, 8);
            terms.push(term(&powers, &[0], part(random(17)), part(random(17))));
        }
        let put = |terms: &mut Vec<ComplexTerm>, powers: [u32; 2], parts: [f64; 2]| {
            let [re, im] = parts.map(|x| Rational::from_f64(x).unwrap());
            terms.push(ComplexTerm { re, im, ..term(&powers, &[0], (0, 1), (0, 1)) });
        };
        let of = |terms: &Vec<ComplexTerm>| Flow::of_complex(std::slice::from_ref(terms), &["s"]);
        // All numbers are dyadic, and doubles have them exactly. G_conj w = i G_w.
        let (_, j) = of(&terms).system(&[None]).derivatives(&at);
        let [a, b, c, d] = [j[0] + j[4], j[3] - j[1], j[0] - j[4], j[3] + j[1]].map(|x| 0.5 * x);
        put(&mut terms, [0, 1], [-b - c, a - d]);
        let values = of(&terms).system(&[None]).values(&at);
        put(&mut terms, [0, 0], [-values[0], -values[1]]);
        let range = Interval::new(-1.0, 1.0);
        let balance = Balance::of_folds(&of(&terms), &[None]).unwrap();
        let (places, _) = balance.places(vec![Interval::new(0.0, 1.5), range], &Limits::default());
        let Places::Boxes(boxes) = places else { continue };
        let has = |part: &Region| part.iter().zip(&at).all(|(x, at)| x.contains(*at));
        assert!(boxes.iter().any(has), "{at:?} {terms:?}");
        let volume = |part: &Region| part.iter().map(|x| x.width()).product::<f64>();
        share += boxes.iter().map(volume).sum::<f64>() / 18.0;
    }
    // Of 25 regions.
    assert!(share < 5.0, "{share}");
}
