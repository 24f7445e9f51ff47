//! The period by resummation and in closed form.

use super::support::{Grid, rational, set};
use lindstedt::unstable::series::resummation::Method;
use lindstedt::{Evaluate, Oscillator, Work};
use rug::float::Constant;
use rug::{Float, Rational};

const AMPLITUDES: [&str; 7] = ["1e-300", "1e-10", "1/3", "1", "10", "1e10", "1e300"];
const EXPONENTS: [&str; 16] = [
    "-1", "-0.999999", "-0.9", "-1/2", "-0.49", "-1e-300", "0", "1e-300", "1/3", "1",
    "1.0000000001", "3", "10", "1001", "1e10", "1e300",
];

fn two_pi(bits: u32) -> Float {
    Float::with_val(bits, Constant::Pi) * 2u32
}

/// 4 sqrt(pi (1 + d)) Gamma(1 + y)/Gamma(1/2 + y) a^(-d), y = 1/(n + 1), d = (n - 1)/2; nothing
/// beyond MPFR's exponents.
fn power_law(n: &Rational, amplitude: &Rational, bits: u32) -> Option<Float> {
    if *n == -1 {
        return None;
    }
    // 1/2 + 10^-300 needs its bits.
    let tiny = n.denom().significant_bits().max(n.numer().significant_bits());
    let work = bits + 64 + tiny;
    let delta = Rational::from(n - 1u32) / 2u32;
    let growth = Float::with_val(work, Rational::from(&delta + 1u32));
    let y = Rational::from(n + 1u32).recip();
    let gamma = |x: Rational| Float::with_val(work, x).gamma();
    let ratio = gamma(y.clone() + 1u32) / gamma(y + Rational::from((1, 2)));
    let scale = Float::with_val(work + 1100, amplitude).ln() * Float::with_val(work + 1100, -delta);
    let root = (Float::with_val(work, Constant::Pi) * growth).sqrt();
    let period = root * ratio * scale.exp() * 4u32;
    (period.is_finite() && !period.is_zero()).then(|| Float::with_val(bits, period))
}

/// 2 pi/agm(1, cos(a/2)).
fn pendulum(amplitude: &Rational, bits: u32) -> Float {
    let half = (Float::with_val(bits + 2100, amplitude) / 2u32).cos();
    two_pi(bits) / Float::with_val(bits, 1).agm(&half)
}

/// 2 pi/agm(sqrt(1 + r), sqrt(1 + r/2)), r = eps a^2.
fn duffing(eps: &Rational, amplitude: &Rational, bits: u32) -> Option<Float> {
    let rho = Rational::from(amplitude * amplitude) * eps;
    let root = |q: Rational| Float::with_val(bits + 4100, q).sqrt();
    let mean = root(rho.clone() + 1u32).agm(&root(rho / 2u32 + 1u32));
    Some(two_pi(bits) / mean)
}

/// Weakly nonlinear: T/2pi = 1 + eps^2/16 - 5 eps^4/3072 to O(eps^6); relaxation: T = (3 - 2 ln 2)
/// eps + 3 alpha eps^(-1/3), alpha = 2.338107 (Haag, Dorodnicyn), to a relative 3e-6 at 10^3.
fn van_der_pol(eps: &str, bits: u32) -> Option<(Float, u32)> {
    let q = rational(eps);
    let e2 = Float::with_val(bits, &q).square();
    if q.clone().abs() < 1e-6 {
        let series =
            Float::with_val(bits, &e2 / 16u32) + 1u32 - e2.clone().square() * 5u32 / 3072u32;
        return Some((
            series * two_pi(bits),
            bits.min(if q.clone().abs() < 1e-100 { bits - 8 } else { 190 }),
        ));
    }
    if q > 1e6 {
        let e = Float::with_val(bits, &q);
        let lead = Float::with_val(bits, 3) - Float::with_val(bits, Constant::Log2) * 2u32;
        let root = Float::with_val(bits, e.cbrt_ref()).recip() * 7.014_322f64;
        return Some((lead * e + root, if q > 1e100 { 990 } else { 30 }));
    }
    let list = include_str!("../../data/van-der-pol/periods.txt").lines();
    let found = list
        .filter_map(|l| l.split_once(' '))
        .find(|(name, _)| name.parse::<Rational>().is_ok_and(|known| known == q))?;
    Some((Float::with_val(bits, Float::parse(found.1.trim()).unwrap()), 88))
}

/// The truth with its bits; nothing where there is none.
type Truth<'a> = &'a dyn Fn(u32) -> Option<(Float, u32)>;

struct Cell<'a> {
    problem: &'a str,
    set: &'a [(&'a str, &'a str)],
    order: usize,
    digits: usize,
    method: Option<Method>,
}

fn judge(grid: &mut Grid, cell: &Cell<'_>, truth: Option<&(Float, u32)>) {
    let Cell { problem, set: parameters, order, digits, method } = *cell;
    let label = format!("{problem} {parameters:?} order {order} digits {digits} {method:?}");
    let question = Evaluate { order: Some(order), method, ..Evaluate::default() };
    let work = Work { digits: u32::try_from(digits).unwrap(), ..Work::default() };
    let oscillator = Oscillator::builtin(problem).unwrap();
    let oscillator = set(parameters)
        .into_iter()
        .fold(oscillator, |oscillator, (name, value)| oscillator.with(&name, value));
    grid.cell(&label, |grid| {
        let found = match oscillator.evaluate(&question, &work) {
            Ok(found) => found.value,
            Err(error) => return grid.refused(&error),
        };
        let Some((truth, known)) = truth else {
            if found.period.is_some() || found.exact_period.is_some() {
                grid.defect(&label, format!("{:?} where there is no truth", found.period));
            }
            return grid.refused(&"NoTruth");
        };
        if let Some(exact) = &found.exact_period {
            grid.number(&label, exact, truth, *known);
        }
        match &found.period {
            // A partial sum of too few terms claims nothing about its error, and says so.
            Some(period) if period.error.is_none() && found.has_no_estimate() => {
                return grid.refused(&"NoEstimate");
            }
            Some(period) => grid.number(&label, period, truth, *known),
            None => grid.refused(&"Digitless"),
        }
        if let Some(frequency) = &found.frequency {
            let truth = Float::with_val(truth.prec(), two_pi(truth.prec()) / truth);
            grid.number(&format!("{label} frequency"), frequency, &truth, *known - 1);
        }
        // The estimate itself, before the closed form measures it.
        let estimate = &found.resummed.outcome.estimate;
        let scale = found.exact_period.as_ref().map(|_| ());
        if scale.is_some()
            && parameters
                .iter()
                .all(|(n, v)| *n != "amplitude" || *v == "1" || problem != "power-law")
        {
            let value = Float::with_val(truth.prec(), &estimate.value * two_pi(truth.prec()));
            let error = Float::with_val(64, &estimate.error * 7u32);
            grid.estimated(
                &format!("{label} sum {:?}", found.resummed.method),
                &value,
                &error,
                truth,
                known - 4,
            );
        }
    });
}

struct Axes<'a> {
    orders: &'a [usize],
    digits: &'a [usize],
    methods: &'a [Option<Method>],
}

fn sweep(grid: &mut Grid, axes: &Axes<'_>, problem: &str, set: &[(&str, &str)], truth: Truth<'_>) {
    let most = axes.digits.iter().copied().max().unwrap();
    let truth = truth((most as f64 * 3.33) as u32 + 400);
    for &order in axes.orders {
        for &digits in axes.digits {
            for &method in axes.methods {
                judge(grid, &Cell { problem, set, order, digits, method }, truth.as_ref());
            }
        }
    }
}

fn power_law_grid(axes: &Axes<'_>) -> Grid {
    let mut grid = Grid::default();
    let mut run = |n: &str, a: &str| {
        let truth = |bits| Some((power_law(&rational(n), &rational(a), bits)?, bits - 8));
        sweep(&mut grid, axes, "power-law", &[("n", n), ("amplitude", a)], &truth);
    };
    for n in EXPONENTS {
        run(n, "1");
    }
    for a in AMPLITUDES {
        for n in ["-0.9", "3", "1e300"] {
            run(n, a);
        }
    }
    grid
}

fn pendulum_grid(axes: &Axes<'_>) -> Grid {
    let mut grid = Grid::default();
    for a in [
        "1e-300",
        "1e-10",
        "1/3",
        "1",
        "3",
        "3.14159",
        "3.14159265358979323846",
        "pi",
        "10",
        "1e300",
    ] {
        // At pi and above there is nothing.
        let truth = |bits| (a != "pi").then(|| (pendulum(&rational(a), bits), bits - 8));
        sweep(&mut grid, axes, "pendulum", &[("amplitude", a)], &truth);
    }
    grid
}

fn duffing_grid(axes: &Axes<'_>) -> Grid {
    let mut grid = Grid::default();
    let mut run = |eps: &str, a: &str| {
        let truth = |bits| Some((duffing(&rational(eps), &rational(a), bits)?, bits - 8));
        sweep(&mut grid, axes, "duffing", &[("eps", eps), ("amplitude", a)], &truth);
    };
    for eps in
        ["-1", "-0.999999", "-1/3", "-1e-300", "1e-300", "1e-10", "1/3", "1", "10", "1e10", "1e300"]
    {
        run(eps, "1");
    }
    for a in AMPLITUDES {
        run("1/3", a);
    }
    run("1e300", "1e-300");
    grid
}

fn van_der_pol_grid(axes: &Axes<'_>) -> Grid {
    let mut grid = Grid::default();
    for eps in ["0", "1e-300", "-1e-10", "1e-10", "15/100", "115/100", "568/100", "1e10", "1e300"] {
        let truth = |bits| van_der_pol(eps, bits);
        sweep(&mut grid, axes, "van-der-pol", &[("eps", eps)], &truth);
    }
    grid
}

const AUTO: [Option<Method>; 1] = [None];

fn every_method() -> Vec<Option<Method>> {
    Method::ALL.iter().map(|m| Some(*m)).chain([None]).collect()
}

#[test]
fn power_law_periods() {
    let axes = Axes { orders: &[0, 1, 20], digits: &[30], methods: &AUTO };
    power_law_grid(&axes).finish("power-law periods", 18);
}

#[test]
fn pendulum_periods() {
    let axes = Axes { orders: &[0, 1, 2, 7, 12], digits: &[1, 30], methods: &AUTO };
    pendulum_grid(&axes).finish("pendulum periods", 36);
}

#[test]
fn duffing_periods() {
    let axes = Axes { orders: &[0, 2, 20], digits: &[1, 30], methods: &AUTO };
    duffing_grid(&axes).finish("Duffing periods", 15);
}

#[test]
fn van_der_pol_periods() {
    let axes = Axes { orders: &[0, 1, 2, 7, 20], digits: &[1, 30], methods: &AUTO };
    van_der_pol_grid(&axes).finish("van der Pol periods", 64);
}

/// High orders, where resummation is most tempted to believe itself.
fn high_orders(orders: &[usize], methods: &[Option<Method>]) -> Grid {
    let mut grid = Grid::default();
    let axes = Axes { orders, digits: &[30], methods };
    for n in ["-0.49", "1/3", "3", "1e10"] {
        let truth = |bits| Some((power_law(&rational(n), &rational("1"), bits)?, bits - 8));
        sweep(&mut grid, &axes, "power-law", &[("n", n)], &truth);
    }
    for eps in ["-1/3", "1", "1e10"] {
        let truth = |bits| Some((duffing(&rational(eps), &rational("1"), bits)?, bits - 8));
        sweep(&mut grid, &axes, "duffing", &[("eps", eps)], &truth);
    }
    for eps in ["15/100", "115/100", "568/100"] {
        sweep(&mut grid, &axes, "van-der-pol", &[("eps", eps)], &|bits| van_der_pol(eps, bits));
    }
    // Minutes each at order 100.
    let most: Vec<usize> = orders.iter().map(|order| *order.min(&50)).collect();
    let axes = Axes { orders: &most[..1], ..axes };
    for a in ["1/3", "1", "3"] {
        let truth = |bits| Some((pendulum(&rational(a), bits), bits - 8));
        sweep(&mut grid, &axes, "pendulum", &[("amplitude", a)], &truth);
    }
    grid
}

#[test]
fn periods_at_order_40() {
    high_orders(&[40], &AUTO).finish("periods at order 40", 3);
}

#[test]
#[ignore = "minutes"]
fn periods_at_high_orders() {
    high_orders(&[50, 100], &AUTO).finish("periods at orders 50 and 100", 70);
    let methods = [Some(Method::PartialSum), Some(Method::Pade)];
    high_orders(&[100], &methods).finish("periods at order 100, two methods", 70);
}

fn every_problem(axes: &Axes<'_>) {
    power_law_grid(axes).finish("power-law periods", 70);
    duffing_grid(axes).finish("Duffing periods", 70);
    van_der_pol_grid(axes).finish("van der Pol periods", 70);
    pendulum_grid(axes).finish("pendulum periods", 70);
}

#[test]
#[ignore = "minutes"]
fn periods_by_every_method() {
    every_problem(&Axes { orders: &[1, 5, 16], digits: &[16], methods: &every_method() });
}

#[test]
#[ignore = "minutes"]
fn periods_at_every_precision() {
    every_problem(&Axes { orders: &[0, 3, 12], digits: &[2, 16, 100], methods: &AUTO });
    every_problem(&Axes { orders: &[6], digits: &[1_000], methods: &AUTO });
}

/// 100 000 bits: the closed forms where the truth is an arithmetic-geometric mean or a root.
#[test]
#[ignore = "minutes"]
fn periods_at_100_000_bits() {
    let mut grid = Grid::default();
    let axes = Axes {
        orders: &[5],
        digits: &[3_000, 10_000, 30_103],
        methods: &[Some(Method::PartialSum)],
    };
    let lemniscate = |bits: u32| {
        // Gamma(1/4)^2 = (2 pi)^(3/2)/agm(sqrt 2, 1).
        let mean = Float::with_val(bits, 2).sqrt().agm(&Float::with_val(bits, 1));
        Some((two_pi(bits) / mean * Float::with_val(bits, 2).sqrt(), bits - 16))
    };
    let root = |bits: u32| Some((Float::with_val(bits, 32).sqrt(), bits - 16));
    sweep(&mut grid, &axes, "power-law", &[("n", "3")], &lemniscate);
    sweep(&mut grid, &axes, "power-law", &[("n", "0")], &root);
    sweep(&mut grid, &axes, "pendulum", &[("amplitude", "1/3")], &|bits| {
        Some((pendulum(&rational("1/3"), bits), bits - 16))
    });
    sweep(&mut grid, &axes, "duffing", &[("eps", "1/3")], &|bits| {
        Some((duffing(&rational("1/3"), &rational("1"), bits)?, bits - 16))
    });
    grid.finish("periods at 100 000 bits", 70);
}
