//! The slope of the threshold against homoclinic tangencies found by following the manifolds.

use super::{Connection, Splitting};
use crate::{Branch, StickSlip};
use lindstedt_number::Exact;
use std::f64::consts::PI;

/// Tangencies by an independent event code, 7 decimals, at eps = 0.005, 0.01, 0.05: the slope by Neville's scheme.
#[test]
fn stick_slip_against_tangencies() {
    let [dry, alpha, beta] = [(); 3].map(|()| Exact::from((3, 10)));
    let (a, b, omega, belt_speed) = (1.into(), 1.into(), 2.into(), Exact::from((2, 5)));
    let point = StickSlip { a, b, dry, alpha, beta, omega, belt_speed };
    let gamma_0 = 0.637_071_342_848_163_6;
    let right = [(0.005, 0.638_071_4), (0.01, 0.639_078_5), (0.05, 0.647_386_2)];
    let left = [(0.005, 0.636_078_2), (0.01, 0.635_092_1), (0.05, 0.627_455_0)];
    for (branch, table) in [(Branch::Positive, right), (Branch::Negative, left)] {
        let found = point.second_order(branch).unwrap();
        let quotient = table.map(|(eps, gamma)| (eps, (gamma - gamma_0) / eps));
        let line = |a: (f64, f64), b: (f64, f64)| a.1 - a.0 * (b.1 - a.1) / (b.0 - a.0);
        let (near, far) = (line(quotient[0], quotient[1]), line(quotient[1], quotient[2]));
        assert!((found.signed - gamma_0).abs() < 1e-10, "{found:?}");
        assert!((found.slope - near).abs() < 2e-5, "{found:?} {near}");
        assert!((found.slope - far).abs() < 5e-6 && found.error < 1e-9, "{found:?} {far}");
    }
}

/// x -> x, t -> -t turns eps into -eps and shifts the force by half a period, where friction is odd in x': the
/// threshold is even in eps.
#[test]
fn odd_friction_leaves_no_slope() {
    let splitting = Splitting {
        force: &|x| Some([x - x * x, 1.0 - 2.0 * x]),
        drive: &|t, _, _| Some([(1.3 * t).cos(), 0.0, 0.0]),
        friction: &|_, v| Some([v + v.powi(3), 0.0, 1.0 + 3.0 * v * v]),
        period: 2.0 * PI / 1.3,
        harmonics: 1,
        kink: None,
        stop: &Default::default(),
    };
    let orbit = Connection { saddles: [0.0, 0.0], middle: 1.5 };
    let found = splitting.second_order(&orbit).unwrap();
    assert!(found.slope.abs() <= found.error && found.signed > 0.1, "{found:?}");
    let even = Splitting { friction: &|_, v| Some([v + v * v, 0.0, 1.0 + 2.0 * v]), ..splitting };
    assert!(even.second_order(&orbit).unwrap().slope.abs() > 0.01);
}

/// The force of the pendulum: with one harmonic the slope vanishes here, too (x -> -x, t -> -t).
fn force(t: f64) -> f64 {
    t.cos() + 0.5 * (2.0 * t).sin()
}

/// One step of the classical method for x'' = -sin x + eps (gamma force - v - q v^2), and of time.
fn runge_kutta([t, x, v]: [f64; 3], h: f64, [eps, gamma, q]: [f64; 3]) -> [f64; 3] {
    let rate = |[t, x, v]: [f64; 3]| [1.0, v, -x.sin() + eps * (gamma * force(t) - v - q * v * v)];
    let ahead = |h: f64, k: [f64; 3]| [t + h * k[0], x + h * k[1], v + h * k[2]];
    let a = rate([t, x, v]);
    let b = rate(ahead(h / 2.0, a));
    let c = rate(ahead(h / 2.0, b));
    let d = rate(ahead(h, c));
    let mean = [0, 1, 2].map(|k| (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0);
    ahead(h, mean)
}

/// (t, v) where a manifold of the pendulum's saddle passes x = 0: the unstable one from x = -pi (sense 1), the stable
/// one from pi backwards (-1). It begins on the periodic orbit to first order, plus an amount along its direction.
fn passage(sense: f64, begin: f64, parameters: [f64; 3]) -> [f64; 2] {
    let [eps, gamma, _] = parameters;
    let away = 1e-4;
    // x'' = x + eps (gamma force - x') near the saddle: x = c sin(w t + p) from force sin(w t + p), with damping
    // to first order in its phase.
    let orbit = [(1.0, 1.0, PI / 2.0), (0.5, 2.0, 0.0)].into_iter().fold([0.0; 2], |sum, wave| {
        let (size, w, phase): (f64, f64, f64) = wave;
        let angle = w * begin + phase + eps * w / (1.0 + w * w);
        let c = -eps * gamma * size / (1.0 + w * w);
        [sum[0] + c * angle.sin(), sum[1] + c * w * angle.cos()]
    });
    let rate = sense - eps / 2.0;
    let from = -sense * PI;
    let mut state = [begin, from + orbit[0] + sense * away, orbit[1] + sense * rate * away];
    for _ in 0..20_000 {
        let mut h = sense * 8e-3;
        let mut next = runge_kutta(state, h, parameters);
        if next[1] * sense > 0.0 {
            for _ in 0..5 {
                h -= next[1] / next[2];
                next = runge_kutta(state, h, parameters);
            }
            return [next[0], next[2]];
        }
        state = next;
    }
    panic!("it does not come to x = 0: {parameters:?}")
}

/// The least of v_u^2 - v_s^2 at equal times in x = 0, over a period.
fn least_distance(parameters: [f64; 3]) -> f64 {
    const COUNT: usize = 16;
    let curve = |sense: f64| {
        let begin = |k: usize| 2.0 * PI * k as f64 / COUNT as f64;
        (0..COUNT).map(|k| passage(sense, begin(k), parameters)).collect::<Vec<_>>()
    };
    let (unstable, stable) = (curve(1.0), curve(-1.0));
    let value = |curve: &[[f64; 2]], t: f64| interpolate(curve, t);
    let distance = |t: f64| value(&unstable, t) - value(&stable, t);
    let mut best = (0.0, f64::MIN);
    for k in 0..200 {
        let t = PI * f64::from(k) / 100.0;
        best = if distance(t) > best.1 { (t, distance(t)) } else { best };
    }
    let (mut t, h) = (best.0, 1e-3);
    for _ in 0..6 {
        let [less, here, more] = [t - h, t, t + h].map(distance);
        t -= h * (more - less) / (2.0 * (more + less - 2.0 * here));
    }
    distance(t)
}

/// v^2 at a time by Fourier interpolation through points that are nearly equidistant: Newton's method for the
/// parameter that has the time.
fn interpolate(curve: &[[f64; 2]], t: f64) -> f64 {
    let count = curve.len() as f64;
    let step = 2.0 * PI / count;
    // Dirichlet's kernel for an even number of points.
    let kernel = |z: f64| {
        if z.sin().abs() < 1e-9 && (z / 2.0).sin().abs() < 1e-9 {
            1.0
        } else {
            (count * z / 2.0).sin() / (count * (z / 2.0).tan())
        }
    };
    let sum = |s: f64, of: &dyn Fn(usize) -> f64| -> f64 {
        (0..curve.len()).map(|k| of(k) * kernel(s - step * k as f64)).sum()
    };
    let shift = |k: usize| curve[k][0] - step * k as f64;
    let mut s = t - shift(0);
    for _ in 0..40 {
        s = t - sum(s, &shift);
    }
    sum(s, &|k| curve[k][1].powi(2))
}

/// From saddle to saddle: the manifolds of the pendulum in the section x = 0 by Runge and Kutta, gamma where the
/// largest distance vanishes, and that at several eps.
#[test]
fn pendulum_against_its_manifolds() {
    let q = 0.7;
    let splitting = Splitting {
        force: &|x| Some([-x.sin(), -x.cos()]),
        drive: &|t, _, _| Some([force(t), 0.0, 0.0]),
        friction: &|_, v| Some([v + q * v * v, 0.0, 1.0 + 2.0 * q * v]),
        period: 2.0 * PI,
        harmonics: 2,
        kink: None,
        stop: &Default::default(),
    };
    let found = splitting.second_order(&Connection { saddles: [-PI, PI], middle: 0.0 }).unwrap();
    // D = 8 + 4 pi q; F = 2 pi (sech(pi/2) cos t + sech(pi) sin(2 t)/2) has its maximum where this is least.
    let work = |t: f64| t.cos() / (PI / 2.0).cosh() + (2.0 * t).sin() / (2.0 * PI.cosh());
    let largest = (0..20_000).map(|k| work(PI * f64::from(k) / 1e4)).fold(0.0, f64::max);
    let exact = (8.0 + 4.0 * PI * q) / (2.0 * PI * largest);
    assert!((found.signed - exact).abs() < 1e-6, "{found:?} {exact}");
    let exact = found.signed;
    let tangency = |eps: f64| {
        let distance = |gamma: f64| least_distance([eps, gamma, q]);
        let (mut old, mut new) = (exact, exact + eps);
        let mut before = distance(old);
        for _ in 0..3 {
            let here = distance(new);
            (old, new, before) = (new, new - here * (new - old) / (here - before), here);
        }
        new
    };
    let [a, b, c] = [0.00125, 0.0025, 0.005].map(|eps| (tangency(eps) - exact) / eps);
    let slope = (8.0 * a - 6.0 * b + c) / 3.0;
    assert!((found.slope - slope).abs() < 5e-5, "{found:?} {slope} from {a}, {b}, {c}");
}
