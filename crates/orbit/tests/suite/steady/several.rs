//! All states of two unknowns of order one, four real ones.

use super::term;
use lindstedt_orbit::steady::{Flow, Limits, Zero, all_states, zero_near};

/// Two coupled modes, both forced: 4 unknowns, terms to degree 5. All states, each a zero, and their number does not
/// depend on the box.
#[test]
fn two_modes() {
    let cubic = |own: [u32; 4], other: [u32; 4]| {
        vec![
            term(&own, &[], (0, 1), (3, 2)),
            term(&other, &[], (0, 1), (1, 2)),
            term(&[0, 0, 0, 0], &[], (0, 1), (-1, 8)),
        ]
    };
    let mut first = cubic([2, 1, 0, 0], [1, 0, 1, 1]);
    first.push(term(&[1, 0, 0, 0], &[], (-1, 10), (-1, 1)));
    first.push(term(&[3, 2, 0, 0], &[], (0, 1), (-15, 160)));
    let mut second = cubic([0, 0, 2, 1], [1, 1, 1, 0]);
    second.push(term(&[0, 0, 1, 0], &[], (-1, 10), (-4, 5)));
    second.push(term(&[0, 0, 3, 2], &[], (0, 1), (-15, 160)));
    let flow = Flow::of_complex(&[first, second], &[]);
    let system = flow.system(&[]);
    let found = all_states(&flow, &[], 1.5, &Limits::default()).unwrap();
    // 27549 where the moduli are not looked at first.
    assert!(found.is_proved() && found.boxes < 12_000, "{}", found.boxes);
    assert_eq!(found.zeros.len(), 5);
    // Newton's method from a grid finds no other, and all of them.
    let mut reached = vec![false; 5];
    for index in 0..7usize.pow(4) {
        let digit = |k: u32| (index / 7usize.pow(k) % 7) as f64 * 0.45 - 1.35;
        let start = [digit(0), digit(1), digit(2), digit(3)];
        let Some(zero) = zero_near(&system, &start, &[1e-6; 4]) else { continue };
        let at = zero.middle();
        if at.iter().all(|x| x.abs() < 1.5) {
            let near =
                |zero: &Zero| zero.middle().iter().zip(&at).all(|(a, b)| (a - b).abs() < 1e-9);
            reached[found.zeros.iter().position(near).unwrap()] = true;
        }
    }
    assert_eq!(reached, [true; 5]);
}

/// x'' + x + eps (x'/5 + x^3/2 - x y^2/2) = 0, y'' + y + eps (y^3/3 - x^2 y) = 2 eps cos (1 + eps) t: the states lie on the
/// axes, where boxes are cut, and one of them is found twice.
#[test]
fn states_on_cuts_that_are_found_twice_are_one() {
    let x = vec![
        term(&[1, 0, 0, 0], &[], (-1, 10), (-1, 1)),
        term(&[2, 1, 0, 0], &[], (0, 1), (3, 4)),
        term(&[1, 0, 1, 1], &[], (0, 1), (-1, 2)),
        term(&[0, 1, 2, 0], &[], (0, 1), (-1, 4)),
    ];
    let y = vec![
        term(&[0, 0, 1, 0], &[], (0, 1), (-1, 1)),
        term(&[0, 0, 2, 1], &[], (0, 1), (1, 2)),
        term(&[1, 1, 1, 0], &[], (0, 1), (-1, 1)),
        term(&[2, 0, 0, 1], &[], (0, 1), (-1, 2)),
        term(&[0, 0, 0, 0], &[], (0, 1), (-1, 2)),
    ];
    let flow = Flow::of_complex(&[x, y], &[]);
    for reach in [1.25, 1.45, 1.5, 1.55] {
        let limits = Limits { modulus: Some(reach), ..Limits::default() };
        let found = all_states(&flow, &[], reach, &limits).unwrap();
        let states: Vec<_> = found.zeros.iter().map(Zero::middle).collect();
        println!("{} {states:?} {:?}", found.boxes, found.undecided);
        assert!(found.is_proved(), "{reach}");
        assert_eq!(found.zeros.len(), 2);
        let free = |w: f64| w * w * w / 2.0 - w - 0.5;
        assert!(states.iter().all(|w| w[0].hypot(w[1]) < 1e-14 && free(w[2]).abs() < 1e-13));
    }
}

/// x'' + x + eps (x'/10 + x^3/3 + x^2 y) = 0, y'' + 9 y + eps (y'/10 + y^3 + x^3) = 2 eps cos (3 + eps/2) t.
#[test]
fn states_of_two_modes_one_to_three_are_all_found() {
    let x = vec![
        term(&[1, 0, 0, 0], &[], (-1, 20), (-1, 6)),
        term(&[2, 1, 0, 0], &[], (0, 1), (1, 2)),
        term(&[0, 2, 1, 0], &[], (0, 1), (1, 2)),
    ];
    let y = vec![
        term(&[0, 0, 1, 0], &[], (-1, 20), (-1, 2)),
        term(&[0, 0, 2, 1], &[], (0, 1), (1, 2)),
        term(&[3, 0, 0, 0], &[], (0, 1), (1, 6)),
        term(&[0, 0, 0, 0], &[], (0, 1), (-1, 6)),
    ];
    let flow = Flow::of_complex(&[x, y], &[]);
    let limits = Limits { modulus: Some(16.0), ..Limits::default() };
    let found = all_states(&flow, &[], 16.0, &limits).unwrap();
    println!("{} {} {:?}", found.boxes, found.zeros.len(), found.undecided);
    assert!(found.is_proved());
    assert_eq!(found.zeros.len(), 21);
}
