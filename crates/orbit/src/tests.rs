//! What must fail fails: forged centres and inverses, and every bound left out in turn.

use crate::bounds::{Contraction, Frame, Measure};
use crate::centre::Centre;
use crate::field::Field;
use crate::linear::Inverse;
use crate::newton::{balance, invert, linearised};
use crate::radii::{Radii, decide};
use crate::space::Parity;
use crate::start::Start;
use crate::task::{Kind, Rows, Task};
use crate::upward::Up;
use crate::{Condition, Failure, Request, prove};
use lindstedt_algebra::Stop;
use lindstedt_equation::{Expression, Function};
use nalgebra::Complex;
use rug::{Float, Rational};

fn x() -> Expression {
    Expression::DISPLACEMENT
}

fn field(rest: Expression) -> Field {
    Field::new(&(Expression::ACCELERATION + rest), "eps", &Default::default()).unwrap()
}

fn van_der_pol() -> Field {
    field(x() + (x().pow(2) - 1) * Expression::VELOCITY)
}

fn wave() -> Start {
    Start { frequency: 0.94, cosines: vec![0.0, 2.0], sines: vec![] }
}

/// Which bounds are left out.
#[derive(Clone, Copy, PartialEq)]
enum Without {
    Nothing,
    Y0,
    Z0,
    Z1,
    Z2,
}

/// The test on any centre with any inverse.
fn judge(
    task: &Task,
    centre: &Centre,
    inverse: &Inverse,
    without: Without,
) -> Result<Radii, Failure> {
    let (values, linear) = linearised(task, centre)?;
    let frame = Frame::new(task, centre, &values, &linear, inverse);
    let weights = frame.weights(1.0)?;
    let mut bounds: Contraction = frame.contraction(Measure::Norm, &weights);
    match without {
        Without::Y0 => bounds.y0 = Float::new(53),
        Without::Z0 => bounds.z0 = Up::ZERO,
        Without::Z1 => bounds.z1 = Up::ZERO,
        Without::Z2 | Without::Nothing => {}
    }
    decide(&bounds, inverse.modes, |r| match without {
        Without::Z2 => Up::ZERO,
        _ => frame.z2(&bounds, &weights, r),
    })
}

fn inverse_at(task: &Task, centre: &Centre, modes: usize) -> Inverse {
    invert(&linearised(task, centre).unwrap().1, modes).unwrap()
}

/// A cycle balanced on 30 modes: the truth to 1e-9, and its inverse.
fn cycle() -> (Task, Centre, Inverse) {
    let (task, guess) =
        Task::new(&van_der_pol(), &Kind::LimitCycle, &[wave()], &Stop::default()).unwrap();
    let centre = balance(&task, guess, 40).unwrap();
    let inverse = inverse_at(&task, &centre, 30);
    (task, centre, inverse)
}

/// The cycle with its third cosine moved by `amount`.
fn moved(centre: &Centre, amount: f64) -> Centre {
    let mut forged = centre.clone();
    let mut step = vec![Complex::default(); 4];
    step[3].re = amount / 2.0;
    forged.add(0.0, &[step], 0);
    forged
}

#[test]
fn a_moved_centre_is_refused_or_its_ball_reaches_the_truth() {
    let (task, centre, inverse) = cycle();
    assert!(judge(&task, &centre, &inverse, Without::Nothing).unwrap().radius < 1e-8);
    for amount in [1e-6, 1e-3, 3e-3] {
        let radii = judge(&task, &moved(&centre, amount), &inverse, Without::Nothing).unwrap();
        // The coefficient of cos 3 tau has the weight 3.
        assert!(radii.radius > 3.0 * amount && radii.radius < 60.0 * amount, "{amount}");
    }
    let far = judge(&task, &moved(&centre, 0.1), &inverse, Without::Nothing);
    assert!(
        matches!(far, Err(Failure::Residual { .. } | Failure::NoContraction { .. })),
        "{far:?}"
    );
    let mut detuned = centre.clone();
    detuned.add(0.05, &[], 0);
    let far = judge(&task, &detuned, &inverse, Without::Nothing);
    assert!(matches!(far, Err(Failure::Residual { .. })), "{far:?}");
    // Without Y0 the test would say that the moved centre is exact.
    let blind = judge(&task, &moved(&centre, 1e-3), &inverse, Without::Y0).unwrap();
    assert!(blind.radius < 3e-3);
}

#[test]
fn a_forged_amplitude_is_refused() {
    let duffing = field(x() + x().pow(3));
    let start = Start { frequency: 1.3, cosines: vec![0.0, 1.0], sines: vec![] };
    let (mut task, guess) =
        Task::new(&duffing, &Kind::InitialAmplitude(1.into()), &[start], &Stop::default()).unwrap();
    let centre = balance(&task, guess, 20).unwrap();
    let inverse = inverse_at(&task, &centre, 20);
    assert!(judge(&task, &centre, &inverse, Without::Nothing).unwrap().radius < 1e-8);
    task.value = Rational::from((13, 10));
    let far = judge(&task, &centre, &inverse, Without::Nothing);
    assert!(matches!(far, Err(Failure::Residual { .. })), "{far:?}");
}

#[test]
fn too_few_modes_are_refused() {
    let (task, centre, _) = cycle();
    let inverse = inverse_at(&task, &centre, 3);
    let few = judge(&task, &centre, &inverse, Without::Nothing);
    assert!(matches!(few, Err(Failure::NoContraction { modes: 3, z1, .. }) if z1 > 1.0), "{few:?}");
    let request = Request { modes_limit: 3, ..Request::default() };
    let few = prove(&van_der_pol(), &Kind::LimitCycle, &wave(), &request);
    assert!(few.is_err());
}

#[test]
fn a_small_inverse_is_seen_by_z0_alone() {
    let (task, centre, mut inverse) = cycle();
    inverse.matrix *= 1e-3;
    let forged = moved(&centre, 1e-3);
    let seen = judge(&task, &forged, &inverse, Without::Nothing);
    assert!(matches!(seen, Err(Failure::NoContraction { z0, .. }) if z0 > 0.9), "{seen:?}");
    let blind = judge(&task, &forged, &inverse, Without::Z0).unwrap();
    assert!(blind.radius < 3e-3);
}

/// A task without unknown frequency, omega = 1.
fn at_rate_one(rest: Expression, modes: &[f64]) -> (Task, Centre) {
    let rows = Rows { parity: Parity { even: true, ..Parity::default() }, condition: None };
    let modes: Vec<_> = modes.iter().map(|re| Complex::new(*re, 0.0)).collect();
    let task = Task {
        field: field(rest),
        rows,
        value: Rational::new(),
        error: Rational::new(),
        stop: Default::default(),
    };
    (task, Centre::from_doubles(72, 1.0, &[modes]))
}

#[test]
fn a_resonance_in_the_tail_is_seen_by_z1_alone() {
    // x'' + 9.001 x = 0 has x = 0 alone; a centre with cos 3 tau leaves a small residual.
    let stiff = Expression::Number(Rational::from((9001, 1000)));
    let (task, centre) = at_rate_one(stiff * x(), &[0.0, 0.0, 0.0, 5e-4]);
    let inverse = inverse_at(&task, &centre, 2);
    let seen = judge(&task, &centre, &inverse, Without::Nothing);
    assert!(matches!(seen, Err(Failure::NoContraction { z1, .. }) if z1 > 0.99), "{seen:?}");
    // The distance to the truth is 3 * 1e-3.
    let blind = judge(&task, &centre, &inverse, Without::Z1).unwrap();
    assert!(blind.radius < 3e-3);
}

#[test]
fn a_problem_without_solution_is_seen_by_z2_alone() {
    // x'' = x^2 + 1/100: the mean of x'' over a period is 0, that of the right side is not.
    let rest = -(x().pow(2)) - Expression::Number(Rational::from((1, 100)));
    let (task, centre) = at_rate_one(rest, &[0.2]);
    let inverse = inverse_at(&task, &centre, 8);
    let seen = judge(&task, &centre, &inverse, Without::Nothing);
    assert!(matches!(seen, Err(Failure::Residual { .. })), "{seen:?}");
    assert!(judge(&task, &centre, &inverse, Without::Z2).is_ok());
}

#[test]
fn the_condition_counts_in_the_tail() {
    // x(0) meets all modes: 1/(N + 1) |A e_condition| at least.
    let (task, centre) = at_rate_one(x() + x().pow(3), &[0.0, 0.5]);
    let rows = Rows { condition: Some(Condition::AtZero), ..task.rows };
    let task = Task { rows, value: 1.into(), ..task };
    let centre = balance(&task, centre, 12).unwrap();
    let inverse = inverse_at(&task, &centre, 12);
    let column: f64 = inverse.matrix.column(0).iter().skip(1).map(|a| a.abs()).sum();
    let radii = judge(&task, &centre, &inverse, Without::Nothing).unwrap();
    assert!(radii.bounds.z1 > column / 13.0);
}

/// A centre of x'' + e^x - 1 = 0 or of two coupled oscillators with one coefficient moved: the ball reaches
/// the truth, or the test refuses; without Y0 it would not see it.
#[test]
fn moved_centres_of_functions_and_of_systems_are_seen() {
    let toda = field(x().apply(Function::Exp) - 1);
    let coupled = |i: usize| {
        let [x, other] = [i, 1 - i].map(|k| Expression::unknown(k, 0));
        Expression::unknown(i, 2) + (i as i64 + 2) * x.clone() - other + x.pow(3)
    };
    let equations = [coupled(0), coupled(1)];
    let list: Vec<_> = equations.iter().collect();
    let system = Field::of_equations(&list, "eps", &Default::default()).unwrap();
    let start = Start { frequency: 1.2, cosines: vec![0.0, 0.5], sines: vec![] };
    let kind = Kind::InitialAmplitude(Rational::from((1, 2)));
    for (field, unknown) in [(toda, 0), (system, 1)] {
        let starts = vec![start.clone(); field.unknowns()];
        let (task, guess) = Task::new(&field, &kind, &starts, &Stop::default()).unwrap();
        let centre = balance(&task, guess, 24).unwrap();
        let inverse = inverse_at(&task, &centre, 24);
        assert!(judge(&task, &centre, &inverse, Without::Nothing).unwrap().radius < 1e-8);
        let mut step = vec![vec![Complex::default(); 4]; field.unknowns()];
        step[unknown][3].re = 1e-5 / 2.0;
        let mut forged = centre.clone();
        forged.add(0.0, &step, 0);
        let seen = judge(&task, &forged, &inverse, Without::Nothing).unwrap();
        assert!(seen.radius > 3e-5 && seen.radius < 2e-3, "{}", seen.radius);
        assert!(judge(&task, &forged, &inverse, Without::Y0).unwrap().radius < 3e-5);
        step[unknown][3].re = 0.2;
        forged.add(0.0, &step, 0);
        assert!(judge(&task, &forged, &inverse, Without::Nothing).is_err());
    }
}
