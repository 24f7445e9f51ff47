//! Orbits that move with a parameter.

use super::*;

/// G(1) - G(0) - G'(0) for forged steps: each summand of the rest alone; Z1 at the end of the step.
#[test]
fn the_rest_of_a_moving_orbit_is_covered() {
    let within = |equation: Expression| {
        let balls = lindstedt_number::ball::Balls::new(128);
        let ball = balls.add_error(&balls.one(), &Float::with_val(53, 0.25));
        Field::varying(&[Expression::ACCELERATION + equation], "eps", ("k", &ball), balls).unwrap()
    };
    let (k, at) = (Expression::parameter("k"), |e: Expression| {
        let end = Expression::Number((5, 4).into());
        field(e.substitute(&|part| (*part == Expression::parameter("k")).then(|| end.clone())))
    });
    let wave = [0.0, 0.05, 0.1];
    // Cases in which Z1 would be too small if the centre stood still.
    let mut seen = 0;
    for (i, (rest, turn, wave)) in [
        (3 * x() + x().pow(3), 0.0, &wave[..]),
        (3 * x(), 0.2, &wave[..1]),
        (3 * x(), 0.2, &wave[..]),
        (3 * x() + 6 * v(), 0.2, &wave[..]),
        (3 * x() + 10 * v().pow(2), 0.2, &wave[..]),
        (3 * k.clone() * x(), 0.0, &wave[..]),
        (3 * x() + 5 * k.clone() * v(), 0.2, &wave[..1]),
        (3 * k.clone().pow(2) * x(), 0.0, &wave[..1]),
        ((k.clone() * x()).apply(Function::Sin), 0.0, &wave[..1]),
        ((2 * x()).apply(Function::Exp), 0.0, &wave[..]),
    ]
    .into_iter()
    .enumerate()
    {
        let varies = rest.contains(&k);
        let own = if varies { within(rest.clone()) } else { field(rest.clone()) };
        let case = Case::at(own, Some(Condition::Cosine), 1.0, &[&[0.1, 0.7]], 4);
        let half = |(k, a): (usize, &f64)| C::new(if k == 0 { *a } else { a / 2.0 }, 0.0);
        let list: Vec<C> = wave.iter().enumerate().map(half).collect();
        let step = Centre::from_doubles(72, turn, &[list]);
        let (values, linear) = linearised(&case.task, &case.centre).unwrap();
        let drift = Drift::along(&case.task, (&case.centre, &values), step);
        let end = Case {
            task: case.task.clone(),
            centre: drift.moved(&case.centre, 1.0),
            inverse: case.inverse.clone(),
        };
        let end = Case { task: Task { field: at(rest), ..end.task }, ..end };
        let mut frame = Frame::new(&case.task, &case.centre, &values, &linear, &case.inverse);
        frame.drift = Some(&drift);
        let weights = frame.weights(1.0).unwrap();
        let found = frame.contraction(Measure::Norm, &weights);
        let (bound, _) = frame.rest(&found, &drift, &weights);
        // A (G(1) - G(0) - G'(0)).
        let there = end.centre.values(&end.task.field, &Default::default()).unwrap();
        let difference = there.residual[0].minus(&values.residual[0]).doubles(0);
        let slope = power_of_two(drift.slope.exponent);
        let length = difference.len().max(drift.slope.rows[0].len()).max(6);
        let one = |k: usize| at_mode(&difference, k) - at_mode(&drift.slope.rows[0], k) * slope;
        let rows: Vec<C> = (0..length).map(one).collect();
        let image = case.linear().precondition(&case.inverse, 0.0, &[rows]);
        let truth = norm(&image, frame.scale(), 1.0);
        assert!(
            truth <= bound.0 * (1.0 + 1e-9) && bound.0 < if i < 8 { 12.0 } else { 60.0 } * truth,
            "{i}: {truth} {}",
            bound.0
        );
        // The whole way, and DF at its end.
        let y0 = found.y0.to_f64();
        let residual = there.residual[0].doubles(0);
        let rows: Vec<C> = (0..length).map(|k| at_mode(&residual, k)).collect();
        let condition = end.task.condition(&end.centre).to_f64();
        let image = case.linear().precondition(&case.inverse, condition, &[rows]);
        let whole = norm(&image, frame.scale(), 1.0);
        assert!(whole <= y0, "{i}: {whole} {y0}");
        let truth = worst(&case, &end.linear(), frame.scale(), 1.0);
        assert!(truth <= found.z0.0 + found.z1.0 + 1e-12, "{i}: {truth} {found:?}");
        seen += usize::from(truth > found.z0.0 + found.z1.0 - found.change.0);
    }
    assert!(seen > 1, "{seen}");
}
