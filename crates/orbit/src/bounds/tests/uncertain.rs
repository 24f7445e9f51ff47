//! Errors of functions and uncertain coefficients.

use super::*;

/// What errors of the functions change in F, DF and dF/domega, and in the divergence.
#[test]
fn errors_of_functions_are_covered() {
    let field = field(x().apply(Function::Exp) + 2 * v().apply(Function::Sin));
    let case = Case::at(field, Some(Condition::Cosine), 1.3, &[&[0.1, 0.9]], 3);
    let right = case.centre.values(&case.task.field, &Default::default()).unwrap();
    // Every function moved by 2^-20.
    let mut list = right.functions.clone();
    list.iter_mut().for_each(|f| f.re[0] += Integer::from(1) << 52u32);
    let n = case.task.field.unknowns();
    let mut variables = Variables::known(&case.centre, &list);
    let forces = |variables: &mut Variables<'_>| variables.exact(&case.task.field.forces[0], 0);
    let moved = [
        forces(&mut variables),
        variables.exact(&case.task.field.first[0][0], 0),
        variables.exact(&case.task.field.first[0][n], -1),
        variables.exact(&case.task.field.flow[0], 1),
        variables.exact(&case.task.field.divergence(), 0),
    ];
    let mut variables = Variables::known(&case.centre, &right.functions);
    let still = [
        forces(&mut variables),
        variables.exact(&case.task.field.first[0][0], 0),
        variables.exact(&case.task.field.first[0][n], -1),
        variables.exact(&case.task.field.flow[0], 1),
        variables.exact(&case.task.field.divergence(), 0),
    ];
    let apart: Vec<f64> =
        moved.iter().zip(&still).map(|(a, b)| a.minus(b).norm(Up::ONE, 0).0).collect();
    let linear = Linear::new(1.3, &right, case.task.rows);
    let mut frame = Frame::new(&case.task, &case.centre, &right, &linear, &case.inverse);
    frame.functions = &list;
    frame.ties = ties(&case.task, &case.centre, &list);
    let weights = frame.weights(1.0).unwrap();
    let value = frame.uncertain_value(Up::ONE, &[0.0; 20], &weights).to_f64();
    let slope = frame.uncertain_slope(&weights).0;
    let of_mean = frame.error_of(&case.task.field.divergence(), &weights).to_f64();
    let column = apart[1] + apart[2];
    assert!(apart[0] <= value && value < 100.0 * apart[0], "{value} {apart:?}");
    assert!(column.max(apart[3] / frame.scale()) <= slope, "{slope} {apart:?}");
    assert!(apart[4] <= of_mean && of_mean < 300.0 * apart[4], "{of_mean} {apart:?}");
    let units = frame.of_functions(&weights, &weights.errors);
    assert!(column <= units[1].0 && apart[3] <= units[2].0, "{units:?} {apart:?}");
    let balls = lindstedt_number::ball::Balls::new(100);
    let exponent = divergence(&case.task, &frame, &weights, &Float::new(53), balls);
    assert!(exponent.radius() >= &apart[4], "{exponent:?}");
    // The contraction has them.
    let found = frame.contraction(Measure::Norm, &weights);
    let none = case.with(1.0, |frame, weights| frame.contraction(Measure::Norm, weights));
    assert!(found.z1.0 >= none.z1.0 + 0.9 * found.inverse.0 * column);
    assert!(found.y0.to_f64() >= none.y0.to_f64() + 0.9 * found.inverse.0 * apart[0]);
}

/// What the errors of the functions add to the bounds of an orbit that moves: in F, with a step in DF, with a
/// coefficient that varies in dF/ds.
#[test]
fn errors_of_functions_are_covered_where_the_orbit_moves() {
    let rest = |k: Expression| k * x().apply(Function::Exp) + x();
    let balls = lindstedt_number::ball::Balls::new(128);
    let ball = balls.add_error(&balls.one(), &Float::with_val(53, 0.25));
    let varying = Expression::ACCELERATION + rest(Expression::parameter("k"));
    let varying = Field::varying(&[varying], "eps", ("k", &ball), balls).unwrap();
    let errors = |field: &Field, wave: f64| {
        let case = Case::at(field.clone(), None, 1.3, &[&[0.1, 0.9]], 3);
        let (values, linear) = linearised(&case.task, &case.centre).unwrap();
        let mut list = values.functions.clone();
        list[0].re[0] += Integer::from(1) << 52u32;
        let step = Centre::from_doubles(72, 0.0, &[vec![C::new(wave, 0.0)]]);
        let drift = Drift::along(&case.task, (&case.centre, &values), step);
        let mut frame = Frame::new(&case.task, &case.centre, &values, &linear, &case.inverse);
        frame.functions = &list;
        frame.ties = ties(&case.task, &case.centre, &list);
        frame.drift = Some(&drift);
        let weights = frame.weights(1.0).unwrap();
        let found = frame.contraction(Measure::Norm, &weights);
        let length = frame.around(&weights, &Float::with_val(53, 1e-9));
        assert!(length >= wave);
        frame.rest(&found, &drift, &weights).1.to_f64() / found.inverse.0
    };
    let moved = 2f64.powi(-20);
    let fixed = field(rest(Expression::integer(1)));
    let (still, along) = (errors(&fixed, 0.0), errors(&fixed, 0.1));
    assert!(still >= moved && along >= still + 0.1 * moved);
    let mut alone = varying.clone();
    alone.varying.iter_mut().for_each(|varying| varying.forces = vec![Polynomial::default()]);
    assert!(errors(&varying, 0.0) >= errors(&alone, 0.0) + 0.25 * moved);
}

/// Functions of functions, and of an uncertain argument.
#[test]
fn errors_of_arguments_reach_the_functions() {
    let balls = lindstedt_number::ball::Balls::new(128);
    let ball = balls.add_error(&balls.one(), &Float::with_val(53, 0.25));
    let [sine, exp] = [Function::Sin, Function::Exp];
    let of = |k: Expression| (k * x()).apply(exp);
    let equation = Expression::ACCELERATION + of(Expression::parameter("k"));
    let within = Field::within(&equation, "eps", &[("k".to_owned(), ball)].into(), 128).unwrap();
    let case = Case::at(within, None, 1.0, &[&[0.1, 0.7]], 3);
    let end = field(of(Expression::Number((5, 4).into())));
    let [one, other] = [&case.task.field, &end]
        .map(|field| case.centre.values(field, &Default::default()).unwrap().functions);
    let apart = |a: &Laurent, b: &Laurent| {
        let [a, b] = [a, b].map(|f| Exact::over_power(f.clone(), 72));
        a.minus(&b).norm(Up::ONE, 0).0
    };
    let error = case.with(1.0, |_, weights| from_units(weights.errors[2], 72).0);
    assert!(apart(&one[0], &other[0]) <= error);
    // e^(sin x) of a sine that is 2^-20 too large.
    let case = Case::at(field(x().apply(sine).apply(exp)), None, 1.0, &[&[0.1, 0.7]], 3);
    let (values, linear) = linearised(&case.task, &case.centre).unwrap();
    let mut list = values.functions.clone();
    list[0].re[0] += Integer::from(1) << 52u32;
    let argument = Exact::over_power(list[0].clone(), 72);
    list[2] = samples_to_modes(&argument, 72, Operation::Exponential, &Default::default())
        .unwrap()
        .remove(0);
    let mut frame = Frame::new(&case.task, &case.centre, &values, &linear, &case.inverse);
    frame.functions = &list;
    frame.ties = ties(&case.task, &case.centre, &list);
    let weights = frame.weights(1.0).unwrap();
    let truth = apart(&list[2], &values.functions[2]);
    assert!(truth > 1e-6 && truth <= from_units(weights.errors[4], 72).0);
}

/// A coefficient at the end of its ball: F and DF there, and the condition at the end of its interval.
#[test]
fn uncertain_coefficients_are_covered_in_every_bound() {
    let cubic: fn(Expression) -> Expression = |k| x() + k.clone() * x().pow(3) + k * v();
    let damping: fn(Expression) -> Expression = |k| x() + k * v();
    for (rest, amplitude) in [(cubic, 0.9), (damping, 1.68)] {
        let balls = lindstedt_number::ball::Balls::new(128);
        let middle = balls.from_rational(&Rational::from((1, 2)));
        let ball = balls.add_error(&middle, &Float::with_val(53, 0.125));
        let values = [("k".to_owned(), ball)].into();
        let within = Expression::ACCELERATION + rest(Expression::parameter("k"));
        let within = Field::within(&within, "eps", &values, 128).unwrap();
        let end = field(rest(Expression::Number((5, 8).into())));
        let mut case = Case::at(within, Some(Condition::Cosine), 1.2, &[&[0.0, amplitude]], 4);
        case.task.error = Rational::from((1, 4));
        let apart = |f: fn(&Values) -> &Exact| {
            let [one, other] = [&case.task.field, &end]
                .map(|field| case.centre.values(field, &Default::default()).unwrap());
            f(&one).minus(f(&other)).norm(Up::ONE, 0).0
        };
        let column = apart(|values| &values.by_x[0]) + apart(|values| &values.by_slope[0]);
        let by_frequency = apart(|values| &values.by_frequency[0]);
        let curved = case.with(1.0, |frame, weights| {
            let alpha = frame.columns(&frame.numerators(Measure::Norm, weights));
            let value = frame.uncertain_value(Up::ONE, &alpha, weights).to_f64();
            let least = apart(|values| &values.residual[0]) + alpha[0] / 4.0;
            assert!(least <= value * (1.0 + 1e-9) && value < 1.01 * least, "{least} {value}");
            let slope = frame.uncertain_slope(weights).0;
            let least = column.max(by_frequency / frame.scale());
            assert!(least <= slope * (1.0 + 1e-9) && slope < 1.5 * least, "{least} {slope}");
            let found = frame.contraction(Measure::Norm, weights);
            let y0 = found.y0.to_f64();
            assert!(y0 >= found.inverse.0 * value / 2.0 && found.z1.0 >= found.inverse.0 * slope);
            let bounds = frame.curvatures(&found, weights, &Float::new(53));
            (bounds, found)
        });
        let (bounds, found) = curved;
        let case = Case { task: Task { field: end, ..case.task }, ..case };
        let at_end = case.with(1.0, |f, weights| f.curvatures(&found, weights, &Float::new(53)));
        let pairs = bounds.iter().zip(at_end);
        assert!(pairs.clone().all(|(a, b)| b.0 <= a.0 * (1.0 + 1e-9)), "{bounds:?} {at_end:?}");
    }
}
