use super::*;
use lindstedt_number::Exact;
use lindstedt_number::interval::Interval;
use rug::Rational;

fn polynomial(terms: &[(&[u32], (i64, i64))]) -> Polynomial {
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

fn term(amplitudes: &[u32], parameters: &[u32], re: (i64, i64), im: (i64, i64)) -> ComplexTerm {
    let (re, im) = (Rational::from(re), Rational::from(im));
    let (amplitudes, parameters) = (amplitudes.to_vec(), parameters.to_vec());
    ComplexTerm { amplitudes, parameters, re, im, radius: 0.0 }
}

/// w' = -(i/4) F - mu w - i s w + (3/2) i al w^2 conj w; parameters s, mu, al, F. Nayfeh and Mook, section 4.1.
fn duffing() -> Flow {
    let equation = vec![
        term(&[0, 0], &[0, 0, 0, 1], (0, 1), (-1, 4)),
        term(&[1, 0], &[0, 1, 0, 0], (-1, 1), (0, 1)),
        term(&[1, 0], &[1, 0, 0, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0, 1, 0], (0, 1), (3, 2)),
    ];
    Flow::of_complex(&[equation], &["s", "mu", "al", "F"])
}

/// w' = -(i/4) F + w/2 - i s w - w^2 conj w/2; parameters s, F.
fn van_der_pol() -> Flow {
    let equation = vec![
        term(&[0, 0], &[0, 1], (0, 1), (-1, 4)),
        term(&[1, 0], &[0, 0], (1, 2), (0, 1)),
        term(&[1, 0], &[1, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0], (-1, 2), (0, 1)),
    ];
    Flow::of_complex(&[equation], &["s", "F"])
}

fn value(text: &str) -> Option<Value> {
    Exact::parse(text).ok().map(|value| Value::from(&value))
}

fn at(values: &[&str]) -> Vec<Option<Value>> {
    values.iter().map(|text| value(text)).collect()
}

fn amplitude(w: &[f64]) -> f64 {
    2.0 * w[0].hypot(w[1])
}

fn square(r: f64) -> Vec<Interval> {
    vec![Interval::new(-r, r); 2]
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

fn course(parameter: usize, range: [f64; 2], step: f64) -> Course {
    let stop = Default::default();
    Course {
        parameter,
        range,
        second: None,
        positive: None,
        unknowns: 2,
        reach: 2.0,
        step,
        most: 20_000,
        stop,
    }
}

/// The whole curve over s; both folds, where d(F^2)/d(a^2) = 0, proved.
#[test]
fn primary_resonance_branch() {
    let flow = duffing();
    let mut values = at(&["1", "1/10", "1", "1/2"]);
    values[0] = None;
    let system = flow.system(&values);
    let start = [1e-2, -0.06, -2.0];
    let branch = follow(&system, &start, &course(2, [-2.0, 4.0], 2e-3)).unwrap();
    assert!(branch.complete && !branch.closed);
    assert!(branch.points.len() > 500);
    let (first, last) = (&branch.points[0].at, branch.points.last().unwrap());
    assert!((first[2] + 2.0).abs() < 1e-12 && (last.at[2] - 4.0).abs() < 1e-12);
    for point in &branch.points {
        let (a, s) = (amplitude(&point.at), point.at[2]);
        let left = (0.01 + (s - 0.375 * a * a).powi(2)) * a * a;
        assert!((left - 0.0625).abs() < 1e-11);
        // Liouville: the trace is -2 mu.
        let trace: f64 = point.exponents.iter().map(|x| x.re).sum();
        assert!((trace + 0.2).abs() < 1e-12);
        // Unstable exactly between the folds: det = mu^2 + (s - 3c)(s - c) < 0, c = 3 a^2/8.
        let c = 0.375 * a * a;
        let determinant = 0.01 + (s - 3.0 * c) * (s - c);
        if determinant.abs() > 1e-6 {
            assert_eq!(point.is_stable(), Some(determinant > 0.0));
        }
    }
    let folds: Vec<_> = branch.points.iter().filter(|p| p.change.is_some()).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        assert_eq!(fold.change, Some(Change::Fold));
        let zero = flow.change_near(Change::Fold, &values, &fold.at).unwrap();
        let place = zero.middle();
        let (s, c) = (place[2], 0.375 * amplitude(&place).powi(2));
        assert!((0.01 + (s - 3.0 * c) * (s - c)).abs() < 1e-13);
        assert!(zero.enclosure[2].width() < 1e-12 && (s - fold.at[2]).abs() < 1e-9);
    }
}

/// Cusp: s = sqrt 3 mu, a^2 = 16 mu/(3 sqrt 3 al), F^2 = 256 mu^3/(9 sqrt 3 al).
#[test]
fn primary_resonance_cusp() {
    let flow = duffing();
    let mut values = at(&["1", "1/10", "1", "1/2"]);
    (values[0], values[3]) = (None, None);
    let root = 3f64.sqrt();
    let cusp = [0.1 * root, (256.0 * 1e-3 / (9.0 * root)).sqrt()];
    // From a fold at F = 1/2 along the curve of folds.
    let mut one = values.clone();
    one[3] = value("1/2");
    let branch = follow(&flow.system(&one), &[1e-2, -0.06, -2.0], &course(2, [-2.0, 4.0], 0.01));
    let branch = branch.unwrap();
    let fold = branch.points.iter().find(|p| p.change == Some(Change::Fold)).unwrap();
    let start = flow.change_near(Change::Fold, &one, &fold.at).unwrap().middle();
    let l = [start[3], start[4]];
    let curve = flow.conditions(Change::Fold, &values, &l).unwrap();
    let guess = [&start[..3], &[0.5], &start[3..]].concat();
    // However the points lie about it.
    for step in (0..9).map(|k| 0.02 + 0.007 * f64::from(k)) {
        let folds = follow(&curve, &guess, &course(3, [0.01, 0.6], step)).unwrap();
        assert!(folds.complete);
        let found = flow.on_folds(&values, &folds);
        assert_eq!(found.len(), 1, "{step}");
        let (change, zero) = &found[0];
        let place = zero.middle();
        assert_eq!(*change, Change::Cusp);
        assert!((place[2] - cusp[0]).abs() < 1e-12 && (place[3] - cusp[1]).abs() < 1e-12);
        assert!((amplitude(&place).powi(2) - 1.6 / (3.0 * root)).abs() < 1e-12);
    }
}

/// Guckenheimer and Holmes, section 2.1: in their units sigma = 2 s, gamma = F/2 the Bogdanov-Takens point (1/2, 1/2), the
/// cusp (1/sqrt 3, sqrt(8/27)).
#[test]
fn van_der_pol_lock_in() {
    let flow = van_der_pol();
    let free = [None, None];
    let double = flow.change_near(Change::BogdanovTakens, &free, &[-0.48, 0.52, 0.24, 0.98]);
    let double = double.unwrap().middle();
    assert!((double[2] - 0.25).abs() < 1e-13 && (double[3] - 1.0).abs() < 1e-13);
    let at = [None, value("6/5")];
    let branch =
        follow(&flow.system(&at), &[0.0, -1.2, 0.0], &course(2, [-1.0, 1.0], 5e-3)).unwrap();
    let hopf: Vec<_> = branch.points.iter().filter(|p| p.change == Some(Change::Hopf)).collect();
    assert_eq!(hopf.len(), 2);
    for point in hopf {
        let zero = flow.change_near(Change::Hopf, &at, &point.at).unwrap();
        let place = zero.middle();
        // Trace 1 - 2 |w|^2 = 0; then (1/16 + s^2)/2 = F^2/16.
        assert!((place[0].powi(2) + place[1].powi(2) - 0.5).abs() < 1e-13);
        assert!((0.5 * (0.0625 + place[2].powi(2)) - 0.09).abs() < 1e-13);
        assert!((place[2] - point.at[2]).abs() < 1e-9);
    }
    let low = [None, value("1/2")];
    let branch =
        follow(&flow.system(&low), &[0.0, -1.1, 0.0], &course(2, [-1.0, 1.0], 5e-3)).unwrap();
    // Below the cusp the locked states are a closed curve beside the one near zero.
    assert!(branch.closed);
    let folds: Vec<_> = branch.points.iter().filter(|p| p.change == Some(Change::Fold)).collect();
    assert_eq!(folds.len(), 2);
}

/// Principal parametric resonance without forcing: w = 0 loses its stability where a pair of states branches off.
#[test]
fn crossings_are_no_folds() {
    // w' = (i/4) h conj w - mu w - i s w + (3/2) i w^2 conj w; parameters s, mu, h.
    let equation = vec![
        term(&[0, 1], &[0, 0, 1], (0, 1), (1, 4)),
        term(&[1, 0], &[0, 1, 0], (-1, 1), (0, 1)),
        term(&[1, 0], &[1, 0, 0], (0, 1), (-1, 1)),
        term(&[2, 1], &[0, 0, 0], (0, 1), (3, 2)),
    ];
    let flow = Flow::of_complex(&[equation], &["s", "mu", "h"]);
    let values = [None, value("1/10"), value("1")];
    let branch =
        follow(&flow.system(&values), &[0.0, 0.0, -1.0], &course(2, [-1.0, 1.0], 0.01)).unwrap();
    let changes: Vec<_> = branch.points.iter().filter(|p| p.change.is_some()).collect();
    // mu^2 + s^2 = h^2/16.
    let edge = (0.0625f64 - 0.01).sqrt();
    assert_eq!(changes.len(), 2);
    for (point, s) in changes.iter().zip([-edge, edge]) {
        assert_eq!(point.change, Some(Change::Crossing));
        assert!((point.at[2] - s).abs() < 1e-6);
    }
    let exact = at(&["0", "1/10", "1"]);
    let found = all_zeros(&flow.system(&exact), &square(1.5), &Limits::default()).unwrap();
    assert!(found.is_proved());
    assert_eq!(found.zeros.len(), 3);
}

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
        let Some(at) = krawczyk::newton(&system, &[digit(0), digit(1), digit(2), digit(3)]) else {
            continue;
        };
        if at.iter().all(|x| x.abs() < 1.5) {
            let near =
                |zero: &Zero| zero.middle().iter().zip(&at).all(|(a, b)| (a - b).abs() < 1e-9);
            reached[found.zeros.iter().position(near).unwrap()] = true;
        }
    }
    assert_eq!(reached, [true; 5]);
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
        let balance = balance::Balance::of(&flow, &[]).unwrap();
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
        let balance = balance::Balance::of_folds(&of(&terms), &[None]).unwrap();
        let (places, _) = balance.places(vec![Interval::new(0.0, 1.5), range], &Limits::default());
        let search::Places::Boxes(boxes) = places else { continue };
        let has = |part: &Region| part.iter().zip(&at).all(|(x, at)| x.contains(*at));
        assert!(boxes.iter().any(has), "{at:?} {terms:?}");
        let volume = |part: &Region| part.iter().map(|x| x.width()).product::<f64>();
        share += boxes.iter().map(volume).sum::<f64>() / 18.0;
    }
    // Of 25 regions.
    assert!(share < 5.0, "{share}");
}

/// At s = 1 the start decides between the two stable states.
#[test]
fn starts_settle_on_different_branches() {
    let system = duffing().system(&at(&["1", "1/10", "1", "1/2"]));
    let fate = |start: [f64; 2]| settle(&system, &start, 1.0, 1000.0, &Default::default());
    let (Fate::Steady(low), Fate::Steady(high)) = (fate([0.0, 0.0]), fate([0.8, 0.0])) else {
        unreachable!()
    };
    assert!(amplitude(&low) < 0.5 && amplitude(&high) > 1.0);
}

/// Below the cusp: the branch near zero and the closed one, each once; two folds.
#[test]
fn a_closed_branch_is_found_once() {
    let flow = van_der_pol();
    let samples = ["-1/10", "0", "1/10"].map(|text| Exact::parse(text).unwrap());
    let values = vec![None, value("1/2")];
    let course = course(2, [-1.0, 1.0], 0.01);
    let limits = Limits::default();
    let survey = Survey { flow: &flow, values, samples: samples.to_vec(), course, limits };
    let response = survey.run().unwrap();
    let closed: Vec<bool> = response.branches.iter().map(|branch| branch.closed).collect();
    assert_eq!(closed.iter().filter(|closed| **closed).count(), 1);
    assert_eq!(closed.len(), 2);
    let counts: Vec<usize> = response.searches.iter().map(|(_, found)| found.zeros.len()).collect();
    assert_eq!(counts, [3, 3, 3]);
    let folds: Vec<_> = response.changes.iter().filter(|c| c.change == Change::Fold).collect();
    assert_eq!(folds.len(), 2);
    assert!(folds.iter().all(|fold| fold.proved.is_some()));
}

/// The closed branch, |s| < 0.126, lies between all values looked at: its folds are found themselves.
#[test]
fn a_closed_branch_between_the_values_is_found() {
    let flow = van_der_pol();
    let survey = |force: &str| {
        let samples = ["-1", "-3/7", "3/7", "1"].map(|text| Exact::parse(text).unwrap()).to_vec();
        let (values, course, limits) =
            (vec![None, value(force)], course(2, [-1.0, 1.0], 0.01), Limits::default());
        Survey { flow: &flow, values, samples, course, limits }.run().unwrap()
    };
    let response = survey("1/2");
    let closed = response.branches.iter().filter(|branch| branch.closed).count();
    assert_eq!((response.branches.len(), closed), (2, 1));
    // 15 000 where the moduli are not looked at first.
    assert!(response.no_closed_missing && response.boxes < 2_000, "{}", response.boxes);
    let folds: Vec<_> = response.changes.iter().filter(|c| c.change == Change::Fold).collect();
    assert_eq!(folds.len(), 2);
    for fold in folds {
        // At a fold both y (1/4 + s^2 - y/2 + y^2/4) = F^2/16 of y = |w|^2 and its derivative by y hold.
        let place = fold.proved.as_ref().unwrap().middle();
        let (y, s) = (place[0].powi(2) + place[1].powi(2), place[2]);
        let y_derivative = 0.25 + s * s - y + 0.75 * y * y;
        assert!(y_derivative.abs() < 1e-12 && (s.abs() - 0.126).abs() < 1e-3, "{s}");
    }
    // Above both closed branch and folds are gone but for those of the one branch.
    assert!(survey("3/2").branches.iter().all(|branch| !branch.closed));
}

/// The pitchfork of an oscillator at twice whose frequency another one is forced: the branch that leaves it turns back there,
/// which is no fold. By hand: |w_2|^2 is where (m + i s_1)... has modulus 2 |w_2|, two crossings, no more.
#[test]
fn a_pitchfork_is_listed_once() {
    // x'' + x + eps (2 m x' + x y) = 0, y'' + 4 y + eps (y + 2 m y' + x^2) = eps F cos((2 + eps s) t) of order one.
    let first = vec![
        term(&[1, 0, 0, 0], &[0], (-1, 10), (0, 1)),
        term(&[1, 0, 0, 0], &[1], (0, 1), (-1, 2)),
        term(&[0, 1, 1, 0], &[0], (0, 1), (1, 2)),
    ];
    let second = vec![
        term(&[0, 0, 1, 0], &[0], (-1, 10), (1, 4)),
        term(&[0, 0, 1, 0], &[1], (0, 1), (-1, 1)),
        term(&[2, 0, 0, 0], &[0], (0, 1), (1, 4)),
        term(&[0, 0, 0, 0], &[0], (0, 1), (-8, 8)),
    ];
    let flow = Flow::of_complex(&[first, second], &["s"]);
    let samples = ["-2", "0", "2"].map(|text| Exact::parse(text).unwrap()).to_vec();
    let course = Course { reach: 7.0, unknowns: 4, ..course(4, [-2.0, 2.0], 1.0 / 60.0) };
    let limits = Limits { modulus: Some(7.0), ..Limits::default() };
    let response =
        Survey { flow: &flow, values: vec![None], samples, course, limits }.run().unwrap();
    let kinds: Vec<Change> = response.changes.iter().map(|c| c.change).collect();
    assert_eq!(kinds, [Change::Crossing; 2], "{:?}", response.changes);
    for crossing in &response.changes {
        // On w_1 = 0: w_2 = i/(-1/10 + i (1/4 - s)), and |w_2|/2 = |1/10 + i s/2|.
        let s = crossing.at[4];
        let square = (0.01 + (0.25 - s).powi(2)).recip();
        assert!((0.25 * square - (0.01 + 0.25 * s * s)).abs() < 1e-12, "{s}");
        assert!(crossing.at[..2].iter().all(|x| x.abs() < 1e-9));
    }
    assert!(!response.no_closed_missing);
}

/// The lock-in of van der Pol's oscillator in the plane of detuning and force: one cusp and one Bogdanov-Takens point on each
/// side, curves of folds and of Hopf points.
#[test]
fn lock_in_diagram() {
    let flow = van_der_pol();
    let exact = |list: &[&str]| list.iter().map(|text| Exact::parse(text).unwrap()).collect();
    let samples: [Vec<Exact>; 2] = [exact(&["0", "1/5", "2/5"]), exact(&["1/2", "6/5"])];
    let plane = Plane {
        flow: &flow,
        values: vec![None, None],
        open: [0, 1],
        samples,
        course: course(2, [-1.0, 1.0], 5e-3),
        second: [0.1, 2.0],
        limits: Limits::default(),
    };
    let diagram = plane.run().unwrap();
    let count = |change| diagram.corners.iter().filter(|corner| corner.0 == change).count();
    assert_eq!((count(Change::Cusp), count(Change::BogdanovTakens)), (2, 2));
    for (change, zero) in &diagram.corners {
        let place = zero.middle();
        // Guckenheimer and Holmes: sigma = 2 s, gamma = F/2.
        let known = match change {
            Change::Cusp => (1.0 / 3f64.sqrt(), (8.0f64 / 27.0).sqrt()),
            _ => (0.5, 0.5),
        };
        assert!((2.0 * place[2].abs() - known.0).abs() < 1e-12, "{change:?} {place:?}");
        assert!((0.5 * place[3] - known.1).abs() < 1e-12);
    }
    let of = |change| diagram.curves.iter().filter(|curve| curve.change == change).count();
    assert!(of(Change::Fold) >= 1 && of(Change::Hopf) >= 2, "{}", of(Change::Hopf));
}

/// The folds of that lock-in are a closed curve, 1/4 + s^2 - y + 3 y^2/4 = 0 with y = |w|^2, passed twice, with
/// (w, F) and (-w, -F): four cusps wherever on it the points begin.
#[test]
fn cusps_of_a_closed_curve() {
    let (flow, free) = (van_der_pol(), [None, None]);
    // One of its points, with F^2/16 = y |1/2 - i s - y/2|^2 and the phase of w such that i F/4 = (1/2 - i s - y/2) w.
    let (y, s) = (0.9f64, 0.0425f64.sqrt());
    let size = (0.5 - 0.5 * y).hypot(s);
    let w = [-s / size, (0.5 - 0.5 * y) / size].map(|part| part * y.sqrt());
    let force = 4.0 * y.sqrt() * size;
    let values = [None, Some(Value::Rational(Rational::from_f64(force).unwrap()))];
    let fold = flow.change_near(Change::Fold, &values, &[w[0], w[1], s]).unwrap().middle();
    let curve = flow.conditions(Change::Fold, &free, &fold[3..5]).unwrap();
    let course = Course { second: Some((3, [-2.0, 2.0])), ..course(2, [-1.0, 1.0], 0.02) };
    let start = [&fold[..3], &[force], &fold[3..]].concat();
    let once = follow(&curve, &start, &course).unwrap();
    assert!(once.closed && once.points.len() > 100);
    for point in &once.points {
        let folds = follow(&curve, &point.at, &course).unwrap();
        let found = flow.on_folds(&free, &folds);
        let cusps = found.iter().filter(|(change, _)| *change == Change::Cusp).count();
        assert_eq!((folds.closed, cusps), (true, 4), "{:?}: {found:?}", point.at);
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
    let flow = |growth: (i64, i64), rate: (i64, i64)| {
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
        Flow::of_complex(&[forced, free], &[])
    };
    let limits = Limits { modulus: Some(1.5), boxes: 300_000, ..Limits::default() };
    let moves = flow((-1, 5), (1, 3));
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
    let circles = flow((1, 5), (0, 1));
    let without = circles.complex[1].iter().filter(|t| t.amplitudes[0] == 0).cloned().collect();
    let circles = Flow::of_complex(&[circles.complex[0].clone(), without], &[]);
    let few = Limits { boxes: 20_000, ..limits };
    assert!(!all_states(&circles, &[], 1.5, &few).unwrap().is_proved());
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
