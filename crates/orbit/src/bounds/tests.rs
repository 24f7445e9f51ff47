//! Every bound against what it bounds, computed another way: left out, the truth exceeds it.

use super::*;
use crate::linear::Step;
use crate::newton::{balance, invert, linearised};
use crate::product::Products;
use crate::proof::{divergence, frequency_error};
use crate::radii::decide;
use crate::task::{Kind, Rows};
use crate::{Condition, Parity, Start};
use lindstedt_equation::{Expression, Function};
use nalgebra::Complex;
use rug::{Integer, Rational};

type C = Complex<f64>;

fn x() -> Expression {
    Expression::DISPLACEMENT
}

fn v() -> Expression {
    Expression::VELOCITY
}

fn field(rest: Expression) -> Field {
    Field::new(&(Expression::ACCELERATION + rest), "eps", &Default::default()).unwrap()
}

/// x'' + x + (x^2 - 1) x' = 0.
fn van_der_pol() -> Field {
    field(x() + (x().pow(2) - 1) * v())
}

/// Two unknowns, x_i'' + rest_i = 0.
fn pair(rests: [Expression; 2]) -> Field {
    let [a, b] = [0, 1].map(|i| Expression::unknown(i, 2) + rests[i].clone());
    Field::of_equations(&[&a, &b], "eps", &Default::default()).unwrap()
}

/// A task, a centre and an inverse that need not belong together.
struct Case {
    task: Task,
    centre: Centre,
    inverse: Inverse,
}

impl Case {
    /// Cosines by unknowns at the rate omega, and the inverse there.
    fn at(
        field: Field,
        condition: Option<Condition>,
        omega: f64,
        cosines: &[&[f64]],
        modes: usize,
    ) -> Self {
        let parity = Parity::default();
        let rows = Rows { parity, condition };
        let half = |(k, a): (usize, &f64)| C::new(if k == 0 { *a } else { a / 2.0 }, 0.0);
        let unknowns: Vec<Vec<C>> =
            cosines.iter().map(|list| list.iter().enumerate().map(half).collect()).collect();
        let task = Task { field, rows, value: Rational::new(), error: Rational::new() };
        let centre = Centre::from_doubles(72, omega, &unknowns);
        let inverse = invert(&linearised(&task, &centre).unwrap().1, modes).unwrap();
        Self { task, centre, inverse }
    }

    /// Van der Pol's cycle balanced on 40 modes.
    fn cycle(modes: usize) -> Self {
        let start = Start { frequency: 0.94, cosines: vec![0.0, 2.0], sines: vec![] };
        let (task, guess) = Task::new(&van_der_pol(), &Kind::LimitCycle, &[start]).unwrap();
        let centre = balance(&task, guess, 40, &Default::default()).unwrap();
        let inverse = invert(&linearised(&task, &centre).unwrap().1, modes).unwrap();
        Self { task, centre, inverse }
    }

    fn with<T>(&self, nu: f64, then: impl FnOnce(&mut Frame<'_>, &Weights) -> T) -> T {
        let (values, linear) = linearised(&self.task, &self.centre).unwrap();
        let mut frame = Frame::new(&self.task, &self.centre, &values, &linear, &self.inverse);
        let weights = frame.weights(nu).unwrap();
        then(&mut frame, &weights)
    }

    fn linear(&self) -> Linear {
        linearised(&self.task, &self.centre).unwrap().1
    }

    /// The frequency and the waves up to a mode.
    fn directions(&self, modes: usize) -> Vec<Option<Wave>> {
        let free = self.task.is_free().then_some(None);
        free.into_iter().chain(self.linear().basis(modes).into_iter().map(Some)).collect()
    }
}

/// A direction of size 1 but for its weight, on so many modes.
fn step(unknowns: usize, direction: Option<Wave>, modes: usize) -> Step {
    let mut step = Step { frequency: 0.0, unknowns: vec![vec![C::default(); modes + 1]; unknowns] };
    match direction {
        None => step.frequency = 1.0,
        Some(w) => step.unknowns[w.unknown][w.k] = w.complex(1.0),
    }
    step
}

fn sizes(list: &[Vec<C>], nu: f64, power: i32) -> f64 {
    let one = |(k, c): (usize, &C)| {
        let size = if k == 0 { c.re.abs() } else { 2.0 * (c.re.abs() + c.im.abs()) };
        size * (k.max(1) as f64).powi(power) * nu.powi(k as i32)
    };
    list.iter().flat_map(|f| f.iter().enumerate().map(one)).sum()
}

fn norm(step: &Step, scale: f64, nu: f64) -> f64 {
    scale * step.frequency.abs() + sizes(&step.unknowns, nu, 1)
}

/// |(1 - A DF) h|/|h|.
fn defect(linear: &Linear, inverse: &Inverse, h: Option<Wave>, scale: f64, nu: f64) -> f64 {
    let modes = inverse.modes.max(h.map_or(0, |w| w.k)).max(linear.by_frequency[0].len())
        + linear.band()
        + 1;
    let h = step(linear.unknowns, h, modes);
    let (condition, rows) = Products::new(linear, modes).apply(&h);
    let mut image = linear.precondition(inverse, condition, &rows);
    image.frequency -= h.frequency;
    for (a, b) in image.unknowns.iter_mut().flatten().zip(h.unknowns.iter().flatten()) {
        *a -= b;
    }
    norm(&image, scale, nu) / norm(&h, scale, nu)
}

/// The largest defect of the DF of `truth` over all directions that differ.
fn worst(case: &Case, truth: &Linear, scale: f64, nu: f64) -> f64 {
    let last = case.inverse.modes + 2 * truth.band() + 2;
    let of = |h: &Option<Wave>| defect(truth, &case.inverse, *h, scale, nu);
    case.directions(last).iter().map(of).fold(0.0, f64::max)
}

/// Z0 + Z1 is at least the largest defect, and not much more. The cases are such that each part of Z1 is the
/// largest in one of them.
#[test]
fn z1_covers_every_direction() {
    let stiff = |k: i64| field(k * x());
    let free = Some(Condition::AtZero);
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 0));
    let weak = Expression::Number((1, 1000).into());
    let cases = [
        // Few modes: finite and tail rows.
        (Case::cycle(5), 4.0),
        (Case::cycle(9), 4.0),
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

fn exactly(x: f64) -> Rational {
    Rational::from_f64(x).unwrap()
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

/// |A (DF(c) - DF(d)) h|/(|c - d| |h|) for single directions is at most Z2, and Z2 not much more.
#[test]
fn z2_covers_every_pair_of_directions() {
    let cycle = Some(Condition::Cosine);
    let [a, b] = [0, 1].map(|k| Expression::unknown(k, 0));
    let half = Expression::Number((1, 2).into());
    let cases = [
        // Two functions; the frequency with a function by inertia, by damping, by x'^2; the frequency twice.
        (Case::at(field(3 * x() + x().pow(3)), None, 1.0, &[&[0.0, 0.5]], 3), 1e-3, 5.0),
        (Case::at(field(3 * x()), cycle, 1.0, &[&[0.0, 0.75]], 3), 1e-3, 2.0),
        (Case::at(field(3 * x()), cycle, 1.0, &[&[0.0, 1.4]], 3), 1e-3, 2.0),
        (Case::at(field(3 * x() + 6 * v()), cycle, 1.0, &[&[0.0, 0.75]], 3), 1e-3, 2.0),
        (Case::at(field(3 * x() + 30 * v().pow(2)), cycle, 1.0, &[&[0.0, 1.4]], 3), 1e-3, 5.0),
        (Case::at(field(3 * x() + 30 * v().pow(2)), cycle, 1.0, &[&[0.0, 0.75]], 3), 1e-3, 5.0),
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
        let (bound, scale) = case.with(1.0, |frame, weights| {
            let found = frame.contraction(Measure::Norm, weights);
            (frame.z2(&found, weights, &Float::with_val(53, *radius)).0, frame.scale())
        });
        let mut truth = 0.0f64;
        for (e, sign) in case.directions(2).iter().flat_map(|e| [(e, 1.0), (e, -1.0)]) {
            // From nearly the edge of the ball to the edge.
            let size = norm(&step(case.task.field.unknowns(), *e, 2), scale, 1.0);
            let at = |part: f64| {
                let by = step(case.task.field.unknowns(), *e, 2);
                let times = sign * part * radius / size;
                let unknowns: Vec<Vec<C>> =
                    by.unknowns.iter().map(|f| f.iter().map(|c| c * times).collect()).collect();
                let mut centre = case.centre.clone();
                centre.add(by.frequency * times, &unknowns, 0);
                linearised(&case.task, &centre).unwrap().1
            };
            let (near, far) = (at(0.99), at(1.0));
            for h in case.directions(case.inverse.modes + 1) {
                let h = step(case.task.field.unknowns(), h, 16 + near.band());
                let modes = h.unknowns[0].len() - 1;
                let of = |linear: &Linear| {
                    let mut rows = Products::new(linear, modes).apply(&h).1;
                    // The inertia of the frequency is in `linear` itself.
                    rows.iter_mut().for_each(|row| row.truncate(modes + 1));
                    rows
                };
                let (mut rows, other) = (of(&far), of(&near));
                for (a, b) in rows.iter_mut().flatten().zip(other.iter().flatten()) {
                    *a -= b;
                }
                let image = case.linear().precondition(&case.inverse, 0.0, &rows);
                truth =
                    truth.max(norm(&image, scale, 1.0) / norm(&h, scale, 1.0) / (0.01 * radius));
            }
        }
        assert!(truth <= bound * (1.0 + 1e-6) && bound <= sharp * truth, "{i}: {truth} {bound}");
    }
}

/// What errors of the functions change in F, DF and dF/domega, and in the divergence.
#[test]
fn errors_of_functions_are_covered() {
    let field = field(x().apply(Function::Exp) + 2 * v().apply(Function::Sin));
    let case = Case::at(field, Some(Condition::Cosine), 1.3, &[&[0.1, 0.9]], 3);
    let right = case.centre.values(&case.task.field).unwrap();
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
    // The contraction has them.
    let found = frame.contraction(Measure::Norm, &weights);
    let none = case.with(1.0, |frame, weights| frame.contraction(Measure::Norm, weights));
    assert!(found.z1.0 >= none.z1.0 + 0.9 * found.inverse.0 * column);
    assert!(found.y0.to_f64() >= none.y0.to_f64() + 0.9 * found.inverse.0 * apart[0]);
}

/// A coefficient at the end of its ball: F and DF there, and the condition at the end of its interval.
#[test]
fn uncertain_coefficients_are_covered_in_y0_and_z1() {
    let equation =
        |k: Expression| Expression::ACCELERATION + x() + k.clone() * x().pow(3) + k * v();
    let balls = lindstedt_number::ball::Balls::new(128);
    let ball =
        balls.add_error(&balls.from_rational(&Rational::from((1, 2))), &Float::with_val(53, 0.125));
    let values = [("k".to_owned(), ball)].into();
    let within = Field::within(&equation(Expression::parameter("k")), "eps", &values, 128).unwrap();
    let end = Field::new(&equation(Expression::Number((5, 8).into())), "eps", &Default::default())
        .unwrap();
    let mut case = Case::at(within, Some(Condition::Cosine), 1.2, &[&[0.0, 0.9]], 4);
    case.task.error = Rational::from((1, 4));
    let apart = |f: fn(&Values) -> &Exact| {
        let [one, other] = [&case.task.field, &end].map(|field| case.centre.values(field).unwrap());
        f(&one).minus(f(&other)).norm(Up::ONE, 0).0
    };
    let column = apart(|values| &values.by_x[0]) + apart(|values| &values.by_slope[0]);
    let by_frequency = apart(|values| &values.by_frequency[0]);
    case.with(1.0, |frame, weights| {
        let alpha = frame.columns(&frame.numerators(Measure::Norm, weights));
        let value = frame.uncertain_value(Up::ONE, &alpha, weights).to_f64();
        let least = apart(|values| &values.residual[0]) + alpha[0] / 4.0;
        assert!(least <= value * (1.0 + 1e-9) && value < 1.01 * least, "{least} {value}");
        let slope = frame.uncertain_slope(weights).0;
        let least = column.max(by_frequency / frame.scale());
        assert!(least <= slope * (1.0 + 1e-9) && slope < 1.5 * least, "{least} {slope}");
        let found = frame.contraction(Measure::Norm, weights);
        assert!(
            found.y0.to_f64() >= found.inverse.0 * value / 2.0
                && found.z1.0 >= found.inverse.0 * slope
        );
    });
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
        let balls = lindstedt_number::ball::Balls::new(100);
        let exponent = divergence(&case.task, frame, weights, &radii.radius, balls);
        // The mean of 1 - x^2 on the cycle.
        let exact = Rational::from_f64(-1.059_376_999_7).unwrap();
        assert!(exponent.contains(&exact) && exponent.radius() < &0.1, "{exponent:?}");
        let middle = exponent.midpoint().to_f64();
        assert!((middle - exact.to_f64()).abs() > 1e-4, "{middle}");
    });
    assert!((omega.to_f64() - 0.942_955_847_441).abs() < 1e-9);
}

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
        let there = end.centre.values(&end.task.field).unwrap();
        let difference = there.residual[0].minus(&values.residual[0]).doubles(0);
        let slope = power_of_two(drift.slope.exponent);
        let length = difference.len().max(drift.slope.rows[0].len()).max(6);
        let one = |k: usize| at_mode(&difference, k) - at_mode(&drift.slope.rows[0], k) * slope;
        let rows: Vec<C> = (0..length).map(one).collect();
        let image = case.linear().precondition(&case.inverse, 0.0, &[rows]);
        let truth = norm(&image, frame.scale(), 1.0);
        assert!(
            truth <= bound.0 * (1.0 + 1e-9) && bound.0 < 12.0 * truth,
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

fn at_mode(list: &[C], k: usize) -> C {
    list.get(k).copied().unwrap_or_default()
}
