//! Z2.

use super::*;

/// |A (DF(c) - DF(d)) h|/(|c - d| |h|) for single directions is at most Z2, and Z2 not much more.
#[test]
fn z2_covers_every_pair_of_directions() {
    let cycle = Some(Condition::Cosine);
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 0));
    let half = Expression::Number((1, 2).into());
    let cases = [
        // Two functions; the frequency with a function and twice by inertia, by damping, by x'^2.
        (Case::at(field(3 * x() + x().pow(3)), None, 1.0, &[&[0.0, 0.5]], 3), 1e-3, 5.0),
        (Case::at(field(3 * x()), cycle, 1.0, &[&[0.0, 0.75]], 3), 1e-3, 2.1),
        (Case::at(field(3 * x() + 6 * v()), cycle, 1.0, &[&[0.0, 0.75]], 3), 1e-3, 3.0),
        (Case::at(field(-x() + 30 * v().pow(2)), cycle, 1.0, &[&[0.0, 1.4]], 3), 1e-3, 6.0),
        // Two unknowns with each other.
        (
            Case::at(
                pair([3 * a.clone() + 20 * a * b.clone(), 2 * b]),
                None,
                1.0,
                &[&[0.1], &[0.1]],
                2,
            ),
            1e-3,
            3.0,
        ),
        // Functions far from the centre: what a small ball would not need.
        (Case::at(field(x().apply(Function::Exp)), None, 1.0, &[&[0.0]], 2), 3.0, 3.0),
        (Case::at(field(x().apply(Function::Sin)), None, 0.3, &[&[0.0]], 2), 1.0, 6.0),
        (Case::at(field(half * (x() + 1).pow(-1)), None, 1.0, &[&[0.0]], 2), 0.7, 4.0),
    ];
    for (i, (case, radius, sharp)) in cases.iter().enumerate() {
        let (bounds, scale) = case.with(1.0, |frame, weights| {
            let found = frame.contraction(Measure::Norm, weights);
            let bounds = frame.curvatures(&found, weights, &Float::with_val(53, *radius));
            (bounds, frame.scale())
        });
        let truths = curvatures(case, *radius, scale);
        for (truth, bound) in truths.iter().zip(bounds) {
            assert!(*truth <= bound.0 * (1.0 + 1e-6), "{i}: {truths:?} {bounds:?}");
        }
        let most = |list: [f64; 3]| list.into_iter().fold(0.0, f64::max);
        assert!(most(bounds.map(|b| b.0)) <= sharp * most(truths), "{i}: {truths:?} {bounds:?}");
    }
}

/// The parts of Z2 and of the rest of a moving orbit that come from forces in x', without the inverse: here they
/// are thousands of times those of the inertia.
#[test]
fn forces_in_the_velocity_are_covered() {
    let strong = field(x() + 5000 * v().pow(2) + 5000 * v());
    let case = Case::at(strong, Some(Condition::Cosine), 1.0, &[&[0.0, 1.4]], 3);
    case.with(1.0, |frame, weights| {
        let found = frame.contraction(Measure::Norm, weights);
        let found = Contraction { inverse: Up::ONE, bend: Up::ZERO, ..found };
        let bounds = frame.curvatures(&found, weights, &Float::new(53));
        let alone = |part: usize| {
            let size = |e: &Option<Wave>| usize::from(e.is_none());
            let (mut most, at) = (0.0f64, |e: Option<Wave>, times: f64| {
                let by = step(1, e, 2);
                let mut centre = case.centre.clone();
                let list = by.unknowns[0].iter().map(|c| c * times).collect();
                centre.add(by.frequency * times, &[list], 0);
                linearised(&case.task, &centre).unwrap().1
            });
            for (e, h) in case
                .directions(2)
                .iter()
                .flat_map(|e| case.directions(2).into_iter().map(move |h| (*e, h)))
            {
                if size(&e) + size(&h) != part {
                    continue;
                }
                let weight = |e| norm(&step(1, e, 2), frame.scale(), 1.0);
                let h_step = step(1, h, 20);
                let [up, down] = [1e-4, -1e-4]
                    .map(|times| Products::new(&at(e, times), 20).apply(&h_step).1.remove(0));
                let rows: Vec<C> = up.iter().zip(&down).map(|(a, b)| (a - b) / 2e-4).collect();
                most = most.max(sizes(&[rows], 1.0, 0) / weight(e) / weight(h));
            }
            most
        };
        for (part, bound) in bounds.iter().enumerate() {
            let truth = alone(part);
            assert!(truth <= 1.01 * bound.0 && bound.0 < 1.5 * truth, "{part}: {truth} {bound:?}");
        }
    });
    for rest in [5000 * v().pow(2), 5000 * v()] {
        let case = Case::at(field(x() + rest), Some(Condition::Cosine), 1.0, &[&[0.0, 1.4]], 3);
        case.with(1.0, |frame, weights| {
            let found = frame.contraction(Measure::Norm, weights);
            let found = Contraction { inverse: Up::ONE, bend: Up::ZERO, ..found };
            let step = Centre::from_doubles(72, 0.01, &[vec![C::new(0.1, 0.0), C::new(0.1, 0.0)]]);
            let values = case.centre.values(&case.task.field, &Default::default()).unwrap();
            let drift = Drift::along(&case.task, (&case.centre, &values), step);
            let end = drift
                .moved(&case.centre, 1.0)
                .values(&case.task.field, &Default::default())
                .unwrap();
            let apart = end.residual[0].minus(&values.residual[0]).doubles(0);
            let slope = power_of_two(drift.slope.exponent);
            let rest = |k: usize| at_mode(&apart, k) - at_mode(&drift.slope.rows[0], k) * slope;
            let truth = sizes(&[(0..8).map(rest).collect()], 1.0, 0);
            let (bound, _) = frame.rest(&found, &drift, weights);
            assert!(truth <= 1.01 * bound.0 && bound.0 < 2.0 * truth, "{truth} {bound:?}");
        });
    }
}

/// The largest |A (DF(c) - DF(d)) h|/(|c - d| |h|) at the edge of the ball, by how many of the directions are the
/// frequency.
fn curvatures(case: &Case, radius: f64, scale: f64) -> [f64; 3] {
    let n = case.task.field.unknowns();
    let mut truths = [0.0f64; 3];
    for (e, sign) in case.directions(2).into_iter().flat_map(|e| [(e, 1.0), (e, -1.0)]) {
        let by = step(n, e, 2);
        let at = |part: f64| {
            let times = sign * part * radius / norm(&by, scale, 1.0);
            let moved = |f: &Vec<C>| f.iter().map(|c| c * times).collect();
            let mut centre = case.centre.clone();
            centre.add(by.frequency * times, &by.unknowns.iter().map(moved).collect::<Vec<_>>(), 0);
            linearised(&case.task, &centre).unwrap().1
        };
        let (near, far) = (at(0.99), at(1.0));
        for h in case.directions(case.inverse.modes + 1) {
            let kinds = usize::from(e.is_none()) + usize::from(h.is_none());
            let h = step(n, h, 16 + near.band());
            let of = |linear: &Linear| Products::new(linear, h.unknowns[0].len() - 1).apply(&h).1;
            let (mut rows, other) = (of(&far), of(&near));
            rows.iter_mut().flatten().zip(other.iter().flatten()).for_each(|(a, b)| *a -= b);
            let image = case.linear().precondition(&case.inverse, 0.0, &rows);
            let truth = norm(&image, scale, 1.0) / norm(&h, scale, 1.0) / (0.01 * radius);
            truths[kinds] = truths[kinds].max(truth);
        }
    }
    truths
}
