//! Y0, Z0, Z1, the norms of the inverse, and what follows from them.

use super::*;

/// Z0 + Z1 is at least the largest defect, and not much more. The cases are such that each part of Z1 is the
/// largest in one of them.
#[test]
fn z1_covers_every_direction() {
    let stiff = |k: i64| field(k * x());
    let free = Some(Condition::AtZero);
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 0));
    let weak = Expression::Number((1, 1000).into());
    let mathieu = field(-3 * x() + 4 * x() * Expression::Time.apply(Function::Cos)).over(2);
    let cases = [
        // Few modes: finite and tail rows.
        (Case::cycle(5), 4.0),
        (Case::cycle(9), 4.0),
        // Tail rows of a column of the inverse.
        (Case::at(mathieu, None, 1.0, &[&[0.0, 0.1]], 1), 1.5),
        // No band: what is beyond, and the column of the frequency with a mode beyond N.
        (Case::at(stiff(9), None, 1.0, &[&[0.0, 0.1]], 2), 1.01),
        (Case::at(stiff(1), free, 1.1, &[&[0.0, 1.0, 0.0, 0.0, 0.0, 0.5]], 3), 1.3),
        // The condition on waves beyond N.
        (Case::at(stiff(2), free, 1.0, &[&[0.0, 0.1]], 2), 1.3),
        (Case::at(field(2 * x() + weak * x().pow(7)), free, 1.0, &[&[0.0, 0.1]], 2), 1.3),
        // The same between two unknowns.
        (
            Case::at(
                pair([2 * a.clone() - 7 * b.clone(), 3 * b.clone()]),
                None,
                1.0,
                &[&[0.1], &[0.1]],
                1,
            ),
            1.3,
        ),
        (
            Case::at(
                pair([2 * a.clone() + 9 * b.clone().pow(3), 3 * b.clone()]),
                None,
                1.0,
                &[&[0.1], &[0.0, 1.0]],
                4,
            ),
            4.0,
        ),
    ];
    for (i, (case, sharp)) in cases.iter().enumerate() {
        for nu in [1.0, 1.05] {
            let (total, scale) = case.with(nu, |frame, weights| {
                let found = frame.contraction(Measure::Norm, weights);
                (found.z0.0 + found.z1.0, frame.scale())
            });
            let truth = worst(case, &case.linear(), scale, nu);
            assert!(truth <= total + 1e-12 && total <= sharp * truth, "{i} {nu}: {truth} {total}");
        }
    }
}

/// What was cut from g_x counts with its norm; here nearly all of it is cut.
#[test]
fn what_is_cut_from_the_band_is_covered() {
    let case = Case::at(field(3 * x() + x().pow(3)), None, 1.0, &[&[0.0, 1.0]], 6);
    let (total, scale) = case.with(1.0, |frame, weights| {
        let whole = frame.linear.clone();
        frame.linear.by_x[0].truncate(1);
        frame.matrix = frame.linear.matrix(6);
        assert!(whole.band() == 2 && frame.linear.band() == 0);
        let found = frame.contraction(Measure::Norm, weights);
        (found.z0.0 + found.z1.0, frame.scale())
    });
    let without = Linear { by_x: vec![vec![case.linear().by_x[0][0]]], ..case.linear() };
    let inverse = invert(&without, 6).unwrap();
    let case = Case { inverse, ..case };
    let truth = worst(&case, &case.linear(), scale, 1.0);
    assert!(truth > 0.1 && truth <= total, "{truth} {total}");
}

/// |A| and |A d^2/dtau^2|: the largest column is one of the inverse, or the first beyond.
#[test]
fn norms_of_the_inverse_cover_every_wave() {
    let overdamped = Case::at(field(50 * v() + x()), None, 1.0, &[&[0.0, 0.1]], 3);
    for case in [Case::cycle(12), overdamped] {
        let linear = case.linear();
        case.with(1.0, |frame, weights| {
            let found = frame.contraction(Measure::Norm, weights);
            let mut truth = [0.0f64; 2];
            for wave in case.directions(case.inverse.modes + 3).into_iter().flatten() {
                let right = step(1, Some(wave), wave.k.max(case.inverse.modes) + 1).unknowns;
                let image = linear.precondition(&case.inverse, 0.0, &right);
                let size = norm(&image, frame.scale(), 1.0);
                truth = [truth[0].max(size), truth[1].max(size * wave.k as f64)];
            }
            for (truth, bound) in truth.into_iter().zip([found.inverse.0, found.bend.0]) {
                assert!(truth <= bound * (1.0 + 1e-9) && bound < 1.1 * truth, "{truth} {bound}");
            }
        });
    }
}

/// |A F| and |1 - A D| in rational numbers.
#[test]
fn y0_and_z0_cover_their_rounding_errors() {
    // A row (1, -1) against (1 + 2^-60, 1): doubles see 0.
    let parity = Parity { even: true, ..Parity::default() };
    let mut case = Case::at(field(3 * x()), None, 1.0, &[&[0.0, 0.1]], 1);
    case.task.rows.parity = parity;
    case.inverse = invert(&case.linear(), 1).unwrap();
    case.inverse.matrix = DMatrix::from_row_slice(2, 2, &[1.0, -1.0, 0.0, 0.0]);
    let one = Integer::from(1) << 60u32;
    let re = vec![Integer::from(&one + 1), one.clone() >> 1];
    let modes = Laurent { re, im: vec![Integer::new(), Integer::new()] };
    let right = Right::new(&[Exact::over_power(modes, 60)], Float::new(53), 60);
    let y0 = case.with(1.0, |frame, weights| {
        let numerators = frame.numerators(Measure::Norm, weights);
        let alpha = frame.columns(&numerators);
        frame.y0(&right, Measure::Norm, &numerators, &alpha, weights)
    });
    assert!(y0 >= 2f64.powi(-60) && y0 < 1e-13, "{y0}");
    // The defect as it is computed forgotten: the bound of its rounding errors covers the truth.
    let case = Case::cycle(9);
    let z0 = case.with(1.0, |frame, weights| {
        frame.defect.fill(0.0);
        let numerators = frame.numerators(Measure::Norm, weights);
        let alpha = frame.columns(&numerators);
        frame.z0(&numerators, &alpha, weights).0
    });
    let truth = case.with(1.0, |frame, weights| {
        let n = frame.matrix.nrows();
        let entry = |i: usize, j: usize| {
            let products = (0..n)
                .map(|k| exactly(case.inverse.matrix[(i, k)]) * exactly(frame.matrix[(k, j)]));
            (Rational::from(i32::from(i == j)) - products.sum::<Rational>()).to_f64().abs()
        };
        let column = |j: usize| -> f64 {
            let sum: f64 = (0..n).map(|i| entry(i, j) * frame.weight(i, weights).0).sum();
            sum / frame.weight(j, weights).1
        };
        (0..n).map(column).fold(0.0, f64::max)
    });
    assert!(truth > 0.0 && truth <= z0 && z0 < 1e-9, "{truth} {z0}");
}

/// Y0 in its finite part and beyond: a moved coefficient leaves A F = the step back, to first order.
#[test]
fn y0_sees_moved_coefficients_of_every_mode() {
    let case = Case::at(field(3 * x()), None, 1.0, &[&[0.0]], 4);
    for k in [1, 4, 5, 9] {
        let mut moved = Case {
            task: case.task.clone(),
            centre: case.centre.clone(),
            inverse: case.inverse.clone(),
        };
        let mut by = vec![C::default(); k + 1];
        by[k] = C::new(0.5e-3, 0.0);
        moved.centre.add(0.0, &[by], 0);
        let y0 =
            moved.with(1.0, |frame, weights| frame.contraction(Measure::Norm, weights).y0.to_f64());
        let own = if k <= 4 { 1.0 } else { 1.0 - 3.0 / (k * k) as f64 };
        let truth = own * k as f64 * 1e-3;
        assert!((y0 - truth).abs() < 1e-9, "{k}: {y0} {truth}");
    }
}

/// The frequency of a forged centre is within its error, with an inverse of the wrong size, too; and the exponent.
#[test]
fn frequencies_and_exponents_of_forged_centres_reach_the_truth() {
    let truth = Case::cycle(30);
    let omega = truth.centre.frequency.clone();
    for (by, times) in [(1e-4, 1.0), (1e-4, 0.6), (2e-3, 1.0), (-2e-3, 1.0)] {
        let mut case = Case::cycle(30);
        case.centre.add(by, &[], 0);
        case.inverse = invert(&case.linear(), 30).unwrap();
        case.inverse.matrix.row_mut(0).scale_mut(times);
        case.with(1.0, |frame, weights| {
            let found = frame.contraction(Measure::Norm, weights);
            let radii = decide(&found, 30, |r| frame.z2(&found, weights, r)).unwrap();
            let error = frequency_error(frame, weights, &radii.radius);
            assert!(
                error > by.abs() * (1.0 - 1e-7) && error < 20.0 * by.abs(),
                "{by} {times}: {error}"
            );
        });
    }
    let mut case = Case::cycle(30);
    case.centre.add(0.0, &[vec![C::default(), C::new(5e-4, 0.0)]], 0);
    case.with(1.0, |frame, weights| {
        let found = frame.contraction(Measure::Norm, weights);
        let radii = decide(&found, 30, |r| frame.z2(&found, weights, r)).unwrap();
        let proof = conclude(&case.task, frame, case.centre.clone(), weights, radii).unwrap();
        // By Taylor integration with 34 digits: the mean of 1 - x^2, and the largest x.
        for (ball, exact) in
            [(&proof.exponent, -1.059_376_999_7), (&proof.motion.maximum, 2.008_619_860_875)]
        {
            let middle = ball.midpoint().to_f64();
            assert!(ball.contains(&exactly(exact)) && ball.radius() < &0.1, "{ball:?}");
            assert!((middle - exact).abs() > 1e-4, "{middle}");
        }
    });
    assert!((omega.to_f64() - 0.942_955_847_441).abs() < 1e-9);
}
