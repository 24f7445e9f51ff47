//! Bifurcation diagrams of the stick-slip oscillator: order, resumption, cancellation, speed.

use crate::common::{parameters, stick_slip};
use lindstedt_equation::{Crossing, Expression, Function, Impact};
use lindstedt_simulate::{
    Column, DiagramSettings, Doubles, Model, Parameters, Quantity, Section, Settings, Sweep,
    diagram, go_on,
};
use rug::Rational;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

fn settings(transient: u32, kept: u32, follow: bool) -> DiagramSettings<f64> {
    DiagramSettings {
        time: 0.0,
        start: vec![0.11, 0.05],
        section: Section::Period(std::f64::consts::PI),
        periods: Vec::new(),
        transient,
        kept,
        follow,
        integration: Settings::for_digits(16),
    }
}

fn gammas(count: i32) -> Vec<Quantity> {
    (0..count)
        .map(|k| Rational::from((600 * (count - 1) + 700 * k, 1000 * (count - 1))).into())
        .collect()
}

/// The lines of the columns from `first` on, until `most` columns have come.
fn lines(
    values: &[Quantity],
    settings: &DiagramSettings<f64>,
    first: usize,
    most: usize,
) -> (String, usize) {
    let (model, parameters) = (stick_slip(), parameters(&[]));
    let sweep = Sweep { model: &model, parameters: &parameters, name: "gamma", values };
    let mut text = String::new();
    let range = first..values.len();
    let mut left = most;
    let next =
        diagram(&sweep, &Doubles, settings, range, &|| ControlFlow::Continue(()), &mut |column| {
            for point in column.points.unwrap() {
                let (x, v, stuck) = (point.state[0], point.state[1], point.stuck());
                writeln!(text, "{} {x} {v} {stuck}", column.index).unwrap();
            }
            left -= 1;
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    (text, next)
}

#[test]
fn broken_off_and_resumed_it_is_the_same_text() {
    let values = gammas(11);
    let settings = settings(5, 7, false);
    let (whole, next) = lines(&values, &settings, 0, usize::MAX);
    assert_eq!((whole.lines().count(), next), (77, 11));
    let (start, next) = lines(&values, &settings, 0, 4);
    assert_eq!(next, 4);
    let (rest, next) = lines(&values, &settings, 4, usize::MAX);
    assert_eq!(next, 11);
    assert!(whole == start + &rest);
}

/// 0.3 is T0, 0.4 is v*: their recurrences share a constant, those of the others do not.
#[test]
fn a_value_that_equals_a_constant_is_a_column_as_others() {
    let values: Vec<Quantity> = (29..42).map(|n| Rational::from((n, 100)).into()).collect();
    let settings = settings(2, 2, false);
    let (whole, _) = lines(&values, &settings, 0, usize::MAX);
    let alone = |k: usize| {
        let (text, _) = lines(&values[k..=k], &settings, 0, 1);
        text.lines().map(|line| format!("{k} {}\n", &line[2..])).collect::<String>()
    };
    assert_eq!(whole, (0..values.len()).map(alone).collect::<String>());
}

#[test]
fn following_columns_resume_from_the_last_point() {
    let values = gammas(6);
    let mut settings = settings(3, 2, true);
    let (whole, _) = lines(&values, &settings, 0, usize::MAX);
    let (start, _) = lines(&values, &settings, 0, 3);
    let last: Vec<f64> = start
        .lines()
        .last()
        .unwrap()
        .split(' ')
        .skip(1)
        .take(2)
        .map(|x| x.parse().unwrap())
        .collect();
    settings.start = last;
    let (rest, _) = lines(&values, &settings, 3, usize::MAX);
    assert!(whole == start + &rest);
}

#[test]
fn a_tick_cancels_inside_of_a_column() {
    let (model, parameters, values) = (stick_slip(), parameters(&[]), gammas(5));
    let sweep = Sweep { model: &model, parameters: &parameters, name: "gamma", values: &values };
    let count = AtomicU32::new(0);
    let tick = || match count.fetch_add(1, Ordering::Relaxed) {
        0..100 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let settings = settings(1_000_000_000, 1, false);
    let next = diagram(&sweep, &Doubles, &settings, 0..5, &tick, &mut |_| panic!());
    assert_eq!(next, 0);
}

#[test]
fn a_column_fails_alone() {
    let (model, parameters) = (stick_slip(), parameters(&[("T0", "-3")]));
    let values: Vec<Quantity> = vec![1.into(), 0.into()];
    let sweep = Sweep { model: &model, parameters: &parameters, name: "vstar", values: &values };
    let mut settings = settings(0, 2, false);
    settings.start = vec![0.0, 0.0];
    let mut outcomes = Vec::new();
    diagram(&sweep, &Doubles, &settings, 0..9, &|| ControlFlow::Continue(()), &mut |column| {
        outcomes.push(column.points.is_ok());
        ControlFlow::Continue(())
    });
    // Negative friction on the switch: both sides lead away from it.
    assert_eq!(outcomes.len(), 2);
    assert!(!outcomes[1]);
}

/// The columns of a diagram that is computed `side` columns at a time.
fn columns(
    (model, parameters, name): (&Model, &Parameters, &str),
    values: &[Quantity],
    settings: &DiagramSettings<f64>,
    side: usize,
) -> Vec<Column<f64>> {
    let sweep = Sweep { model, parameters, name, values };
    let mut all = Vec::new();
    for first in (0..values.len()).step_by(side) {
        let range = first..values.len().min(first + side);
        let next = diagram(&sweep, &Doubles, settings, range.clone(), &go_on, &mut |column| {
            all.push(column);
            ControlFlow::Continue(())
        });
        assert_eq!(next, range.end);
    }
    all
}

/// One, four, eight and nineteen columns side by side: sliding, impacts, poles in some columns, constants that are
/// zero in one, periods of their own. The same bits.
#[test]
fn columns_side_by_side_are_columns_alone() {
    let number = |n: i64, d: i64| Expression::Number((n, d).into());
    let (x, v, f) =
        (Expression::DISPLACEMENT, Expression::VELOCITY, Expression::parameter("gamma"));
    let wave = (number(2, 1) * Expression::Time).apply(Function::Cos);
    let linear = Expression::ACCELERATION + number(1, 10) * v.clone() + x.clone();
    let wall =
        Impact { position: number(1, 4), crossing: Crossing::Rising, restitution: number(4, 5) };
    let hit = Model::second_order(&(linear.clone() - f.clone() * wave.clone())).unwrap();
    let slip = (v.clone() - number(1, 3)).apply(Function::Sign);
    let root = (number(2, 1) + x.clone() * x.clone()).apply(Function::Ln);
    let mixed = linear.clone() + number(1, 5) * slip + f.clone() * x.clone().apply(Function::Exp)
        - root * wave;
    let blown = Expression::ACCELERATION + v - f * x.clone() * x.clone() * x;
    let models = [
        stick_slip(),
        hit.with_wall(wall),
        Model::second_order(&mixed).unwrap(),
        Model::second_order(&blown).unwrap(),
    ];
    let own = parameters(&[]);
    let (mut failed, mut stuck) = (0, 0);
    for (model, parameters) in
        models.iter().zip([own, Parameters::new(), Parameters::new(), Parameters::new()])
    {
        for values in
            [gammas(19), (-2..17).map(|k| Quantity::from(Rational::from((k, 4)))).collect()]
        {
            let mut settings = settings(3, 9, false);
            for strobe in [false, true] {
                if strobe {
                    settings.section = Section::Strobe { first: 0.3, period: 1.7 };
                    settings.periods = vec![1.5; 4];
                }
                let setting = (model, &parameters, "gamma");
                let alone = columns(setting, &values, &settings, 1);
                for side in [4, 8, 19] {
                    assert_eq!(columns(setting, &values, &settings, side), alone, "{side}");
                }
                let points = alone.iter().flat_map(|column| column.points.iter().flatten());
                stuck += points.filter(|point| point.stuck()).count();
                failed += alone.iter().filter(|column| column.points.is_err()).count();
            }
        }
    }
    assert!(stuck > 10 && failed > 10, "{stuck} {failed}");
}

/// 400 values of gamma, 600 periods each: prints the seconds it took.
#[test]
#[ignore = "half a minute"]
fn four_hundred_values_of_six_hundred_periods() {
    let clock = std::time::Instant::now();
    let (text, _) = lines(&gammas(400), &settings(500, 100, false), 0, usize::MAX);
    println!("{} s", clock.elapsed().as_secs_f64());
    assert_eq!(text.lines().count(), 40_000);
}
