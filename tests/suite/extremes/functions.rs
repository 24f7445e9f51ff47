//! The Lobachevsky function and the elementary functions of balls.

use super::support::{Grid, rational};
use lindstedt::unstable::number::ball::{Ball, Balls};
use lindstedt::unstable::phase::lobachevsky_function::{Point, lobachevsky, lobachevsky_f64};
use rug::float::Constant;
use rug::{Float, Rational};

const POINTS: [&str; 12] = [
    "0", "1e-300", "-1e-10", "1/3", "1", "1.5707963267948966", "-2", "3.14159", "10", "1e10",
    "-1e22", "1e300",
];

/// int_0^x -ln|cos t| dt for |x| <= 1 as sum_n c_n x^(2n+1)/(2n+1), where tan t = sum T_n t^(2n-1)
/// by the recursion of tan' = 1 + tan^2.
fn small_argument(x: &Rational, bits: u32) -> Float {
    let work = bits + 64;
    let x = Float::with_val(work + 2000, x);
    let square = Float::with_val(work, x.square_ref());
    let mut tangent: Vec<Float> = vec![Float::with_val(work, 1)];
    let mut power = Float::with_val(work, &square * &x);
    let mut sum = Float::with_val(work, &power / 6u32);
    for n in 1..4000u32 {
        let products = (0..n as usize)
            .map(|i| Float::with_val(work, &tangent[i] * &tangent[n as usize - 1 - i]));
        let c = products.fold(Float::new(work), |s, p| s + p) / (2 * n + 1);
        power *= &square;
        // -ln cos = int tan: t^(2n+2)/(2n+2), integrated again.
        let term = Float::with_val(work, &c * &power) / ((2 * n + 2) * (2 * n + 3));
        tangent.push(c);
        sum += &term;
        if Float::with_val(53, term.abs_ref()) <= Float::with_val(53, sum.abs_ref()) >> work {
            break;
        }
    }
    sum
}

/// Every point of the real line: the period, the sign, and [`quarter`].
fn truth(x: &Rational, bits: u32) -> Float {
    let work = bits + 1200;
    let pi = |bits: u32| Float::with_val(bits, Constant::Pi);
    let full = Float::with_val(work + 1100, x);
    let turns = Float::with_val(work + 1100, &full / pi(work + 1100)).round();
    let offset = full - Float::with_val(work + 1100, &turns * pi(work + 1100));
    let offset = Float::with_val(work, offset);
    let at = quarter(&Float::with_val(work, offset.abs_ref()), bits);
    let at = if offset.is_sign_negative() { -at } else { at };
    at + turns * pi(work) * Float::with_val(work, Constant::Log2)
}

/// For 0 <= t <= pi/2. Beyond 0.8, with y = pi/2 - t and S(y) = int_0^y -ln sin, the duplication
/// ln sin 2s = ln 2 + ln sin s + ln cos s integrates to S(2y)/2 = S(y) + L(y) - y ln 2, and
/// S(y) = pi ln 2/2 - L(pi/2 - y).
fn quarter(t: &Float, bits: u32) -> Float {
    if *t <= 0.8 {
        return small_argument(&t.to_rational().unwrap(), bits);
    }
    let real = |x: Constant| Float::with_val(t.prec(), x);
    let y = real(Constant::Pi) / 2u32 - t;
    let rest =
        Float::with_val(t.prec(), real(Constant::Pi) / 2u32 - Float::with_val(t.prec(), &y * 2u32));
    let single = small_argument(&y.to_rational().unwrap(), bits);
    let doubled = quarter(&rest, bits) / 2u32;
    single + doubled + (real(Constant::Pi) / 4u32 - y) * real(Constant::Log2)
}

fn lobachevsky_grid(precisions: &[u32]) -> Grid {
    let mut grid = Grid::default();
    for text in POINTS {
        let x = rational(text);
        let widest = precisions.iter().copied().max().unwrap();
        let exact = truth(&x, widest + 64);
        for &bits in precisions {
            let label = format!("L({text}) at {bits} bits");
            grid.cell(&label, |grid| {
                let found = lobachevsky(&Point::Rational(x.clone()), Balls::new(bits));
                grid.certified(&label, &found, &exact, widest + 20);
                if found.relative_accuracy_bits() < i64::from(bits) - 3 && !x.is_zero() {
                    grid.defect(&label, format!("{found:?} is wide"));
                }
            });
        }
        let double = Float::with_val(53, lobachevsky_f64(x.to_f64()));
        // The double nearest to x is not x.
        let nearest = truth(&Rational::from_f64(x.to_f64()).unwrap(), 200);
        // 4 ulp, and below the least double half of it.
        let error: Float = Float::with_val(53, nearest.abs_ref()) >> 50;
        let error = error.max(&Float::with_val(53, f64::from_bits(1)));
        grid.estimated(&format!("L({text}) in doubles"), &double, &error, &nearest, 200);
    }
    grid
}

#[test]
fn lobachevsky_function() {
    lobachevsky_grid(&[2, 3, 10, 53, 64, 100, 500]).finish("Lobachevsky function", 1);
}

#[test]
#[ignore = "minutes"]
fn lobachevsky_function_at_many_bits() {
    lobachevsky_grid(&[1000, 2000]).finish("Lobachevsky function", 70);
    // L(pi/2 - 2y)/2 = L(pi/2 - y) - L(y) + y ln 2 - pi ln 2/4 (see `quarter`), y = q pi.
    let mut grid = Grid::default();
    for bits in [10_000, 100_000] {
        let balls = Balls::new(bits);
        for q in ["1/7", "1e-10", "2/5"] {
            let label = format!("duplication at {q} pi and {bits} bits");
            grid.cell(&label, |grid| {
                let q = rational(q);
                let at = |q: Rational| lobachevsky(&Point::PiTimes(q), balls);
                let half = || Rational::from((1, 2));
                let doubled = balls.mul_power_of_two(&at(half() - q.clone() * 2u32), -1);
                let period = balls.mul(&balls.pi(), &balls.ln_2());
                let linear = balls.mul_rational(&period, &(Rational::from((1, 4)) - &q));
                let single = balls.sub(&at(q.clone()), &at(half() - &q));
                let sum = balls.add(&balls.add(&doubled, &single), &linear);
                grid.certified(&label, &sum, &Float::new(64), 0);
                if *sum.radius() > Float::with_val(53, 1) >> (bits - 20) {
                    grid.defect(&label, "wide");
                }
            });
        }
    }
    grid.finish("Lobachevsky function at many bits", 70);
}

type Elementary = (&'static str, fn(Balls, &Ball) -> Option<Ball>, fn(Float) -> Float);

/// Exact and wide arguments; the truth by MPFR with 400 more bits (and those of the argument).
fn elementary_grid(precisions: &[u32], widths: &[Option<i32>]) -> Grid {
    let functions: [Elementary; 12] = [
        ("sqrt", |b, x| b.sqrt(x), Float::sqrt),
        ("ln", |b, x| b.ln(x), Float::ln),
        ("ln_1p", |b, x| b.ln_1p(x), Float::ln_1p),
        ("exp", |b, x| Some(b.exp(x)), Float::exp),
        ("sinh", |b, x| Some(b.sinh(x)), Float::sinh),
        ("cosh", |b, x| Some(b.cosh(x)), Float::cosh),
        ("sin", |b, x| Some(b.sin(x)), Float::sin),
        ("cos", |b, x| Some(b.cos(x)), Float::cos),
        ("tan", |b, x| b.tan(x), Float::tan),
        ("atan", |b, x| Some(b.atan(x)), Float::atan),
        ("square", |b, x| Some(b.square(x)), Float::square),
        ("cube", |b, x| b.powi(x, 3), |x| x.clone().square() * x),
    ];
    let points = [
        "-1e300", "-10", "-1", "-0.9999999999", "-1e-300", "0", "1e-300", "1e-10", "1/3", "1",
        "10", "1e10", "1e300",
    ];
    let mut grid = Grid::default();
    for (name, enclosed, plain) in functions {
        for text in points {
            for &bits in precisions {
                for &width in widths {
                    let label = format!("{name}({text}) +- 2^{width:?} at {bits} bits");
                    let balls = Balls::new(bits);
                    let x = rational(text);
                    let ball = balls.from_rational(&x);
                    let ball = match width {
                        Some(e) => balls.add_error(&ball, &Float::with_val(53, Float::i_exp(1, e))),
                        None => ball,
                    };
                    grid.cell(&label, |grid| {
                        let Some(found) = enclosed(balls, &ball) else {
                            return grid.refused(&"Undefined");
                        };
                        let work = bits + 4000;
                        let high = |q: &Rational| plain(Float::with_val(work, q));
                        let middle = ball.midpoint().to_rational().unwrap();
                        let radius = ball.radius().to_rational().unwrap();
                        for point in [x.clone(), middle.clone() + &radius, middle - radius] {
                            let exact = high(&point);
                            if exact.is_nan() || exact.is_infinite() {
                                if found.is_finite() {
                                    grid.defect(&label, format!("{found:?} instead of {exact}"));
                                }
                                continue;
                            }
                            grid.certified(&label, &found, &exact, work - 1100);
                        }
                    });
                }
            }
        }
    }
    grid
}

#[test]
fn elementary_functions() {
    let widths = [None, Some(-1100), Some(-40), Some(-3)];
    elementary_grid(&[2, 3, 10, 53, 64, 100, 1000], &widths).finish("elementary functions", 5);
}

#[test]
#[ignore = "minutes"]
fn elementary_functions_at_many_bits() {
    elementary_grid(&[10_000, 100_000], &[None]).finish("elementary functions", 70);
}
