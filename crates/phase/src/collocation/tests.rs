//! Laws up to rounding, and solutions against closed forms.

use super::*;
use crate::lobachevsky_function::{Point, lobachevsky};
use lindstedt_algebra::{Elementary, FunctionAlgebra, PhaseAlgebra, RationalAlgebra, Ring};
use lindstedt_coeff::floats::{Doubles, Floats};
use lindstedt_number::ball::Balls;
use rug::{Float, Rational};

fn doubles() -> Collocation<Doubles> {
    Collocation::new(Doubles, Grid::for_digits(15, 0).0, Stop::default())
}

/// The largest difference of values, also of the derivatives where both are known.
fn distance(a: &Collocation<Doubles>, f: &Sampled<f64>, g: &Sampled<f64>) -> f64 {
    let difference = a.sub(f, g);
    let mut values = difference.values.iter().flatten().flat_map(|list| list.iter());
    values.by_ref().fold(0.0, |m: f64, v| if v.abs() > m || v.is_nan() { v.abs() } else { m })
}

/// cos k psi and sin k psi by the addition theorem.
fn harmonic(a: &Collocation<Doubles>, k: usize) -> [Sampled<f64>; 2] {
    let (mut c, mut s) = (a.one(), a.zero());
    for _ in 0..k {
        let next = a.sub(&a.mul(&c, &a.cosine()), &a.mul(&s, &a.sine()));
        s = a.sum_of_products(&[(&s, &a.cosine()), (&c, &a.sine())]);
        c = next;
    }
    [c, s]
}

/// The same with truncated Fourier series, where these solutions are exact.
#[test]
fn solutions_of_harmonics_by_fourier_series() {
    check_harmonics(&Collocation::fourier(Doubles, 6), &[0, 2, 3, 4, 5, 8]);
}

/// All four classes: u = cos(k psi)/(1 - k^2) and so on, minus its free oscillation at psi = 0.
fn check_harmonics(a: &Collocation<Doubles>, multiples: &[usize]) {
    for &k in multiples {
        let [c, s] = harmonic(a, k);
        let divisor = Rational::from((1, 1 - (k as i64).pow(2)));
        let expected_c = a.scale(&a.sub(&c, &a.cosine()), &divisor);
        let sine = a.scale(&a.sine(), &Rational::from(k));
        let expected_s = a.scale(&a.sub(&s, &sine), &divisor);
        for (f, expected) in [(c, expected_c), (s, expected_s)] {
            let split = a.resolve(&f).unwrap();
            assert!(split.cos_amplitude.abs() < 1e-14 && split.sin_amplitude.abs() < 1e-14);
            let error = distance(a, &split.response, &expected);
            assert!(error < 2e-13, "k = {k}: {error}");
            // The split rebuilds: u'' + u = f, and u(0) = u'(0) = 0.
            let slope = a.derivative(&split.response);
            let rebuilt = a.add(&a.derivative(&slope), &split.response);
            assert!(distance(a, &rebuilt, &f) < 2e-13, "k = {k}");
            for g in [&split.response, &slope] {
                assert!(a.at_zero(g).unwrap().abs() < 1e-14);
            }
        }
    }
    let split = a.resolve(&a.add(&a.scale(&a.cosine(), &Rational::from(3)), &a.sine())).unwrap();
    assert!((split.cos_amplitude - 3.0).abs() < 1e-14 && (split.sin_amplitude - 1.0).abs() < 1e-14);
    assert!(a.size_of(&split.response) < 1e-14);
}

impl Collocation<Doubles> {
    fn size_of(&self, f: &Sampled<f64>) -> f64 {
        distance(self, f, &self.zero())
    }
}

/// x_1 of the power law is cos l + sin Lambda_1 (small-delta method, order 1): alpha_1 = 1 - 2 ln 2,
/// and the value of the solution at a node against the certified Lobachevsky function.
#[test]
fn first_order_of_the_power_law() {
    let (grid, bits) = Grid::for_digits(60, 1);
    let a = Collocation::new(Floats::new(bits), grid, Stop::default());
    // f = -x ln x^2.
    let log = a.log_abs(&a.cosine()).unwrap();
    let f = a.scale(&a.mul(&a.cosine(), &log), &Rational::from(-2));
    let split = a.resolve(&f).unwrap();
    let two_ln_2 = Float::with_val(bits, rug::float::Constant::Log2) * 2u32;
    let error = Float::with_val(53, &split.cos_amplitude - (two_ln_2 - 1u32));
    assert!(error.clone().abs() < 1e-62, "{error}");
    let values = a.values(&split.response);
    for k in [1, a.nodes() / 4, a.nodes() / 2] {
        let (cos, sin) = (&a.cos[k], &a.sin[k]);
        let psi = Float::with_val(bits, sin.atan2_ref(cos));
        let balls = Balls::new(bits);
        let l = lobachevsky(&Point::Rational(psi.to_rational().unwrap()), balls);
        let lambda = Float::with_val(
            bits,
            l.midpoint() - psi * Float::with_val(bits, rug::float::Constant::Log2),
        );
        let expected =
            Float::with_val(bits, cos.ln_ref()) * -Float::with_val(bits, cos) + lambda * sin;
        let error = Float::with_val(53, &values[k] - expected).abs();
        assert!(error < 1e-60, "node {k}: {error}");
    }
}

/// Harmonic 8 has a pole of order 8 on the rim of the strip: a finer grid.
#[test]
fn solutions_of_harmonics() {
    check_harmonics(&doubles(), &[0, 2, 3, 4]);
    check_harmonics(&Collocation::new(Doubles, Grid::new(80.0, 40.0), Stop::default()), &[5, 8]);
}

#[test]
fn functions_and_their_domains() {
    let a = doubles();
    let x = a.cosine();
    let square = a.mul(&x, &x);
    let absolute = a.apply(&Elementary::Power(Rational::from((1, 2))), &square).unwrap();
    // <|cos|> = 2/pi, and |cos| = cos on the first quarter.
    assert!(absolute.values[COS_ODD].is_none());
    let sign = a.mul(&x, &a.reciprocal(&absolute).unwrap());
    assert!((a.first_harmonic(&sign).unwrap().0 - 4.0 / std::f64::consts::PI).abs() < 1e-14);
    let shifted = a.add(&x, &a.scale(&a.one(), &Rational::from((1, 2))));
    assert!(a.reciprocal(&shifted).is_none() && a.log_abs(&shifted).is_none());
    assert!(a.reciprocal(&a.add(&shifted, &a.one())).is_some());
    assert!(a.apply(&Elementary::Power(Rational::from((1, 3))), &x).is_none());
    // sin(cos psi) is odd under psi -> pi - psi, cos(cos psi) even: 2 J_1(1) and J_0(1).
    let sine = a.apply(&Elementary::Sin, &x).unwrap();
    assert!(sine.values[COS_EVEN].is_none() && sine.values[COS_ODD].is_some());
    assert!((a.first_harmonic(&sine).unwrap().0 - 0.880_101_171_489_867).abs() < 1e-14);
    // exp(sin psi) has sines and cosines: exp(s) exp(-s) = 1.
    let s = a.sine();
    let product = a.mul(
        &a.apply(&Elementary::Exp, &s).unwrap(),
        &a.apply(&Elementary::Exp, &a.neg(&s)).unwrap(),
    );
    assert!(distance(&a, &product, &a.one()) < 1e-14);
    assert!(
        a.derivative(&product).values.iter().flatten().all(|list| list.iter().all(|v| v.is_nan()))
    );
    assert_eq!(a.as_constant(&a.embed(&0.3)), Some(0.3));
    assert_eq!(a.as_constant(&x), None);
}
