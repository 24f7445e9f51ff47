//! The free flow y'' + d y' + (d^2/4 - z) y = 0 over a time T, for real or complex d, z.
//!
//! With m^2 = z: h(T) = e^(-dT/2) sinh(mT)/m is the solution with h(0) = 0, h'(0) = 1. Even in m,
//! hence regular at m = 0 (critical damping) and through it.

use lindstedt_number::complex::Complex;
use lindstedt_number::real::Real;

/// Below this |m T|^2 the series in (mT)^2 is used.
const SERIES_BELOW: f64 = 0.25;

/// Values of the flow over T.
#[derive(Clone, Debug)]
pub struct Propagator<S> {
    /// e^(-dT/2) cosh(mT).
    pub cosh: Complex<S>,
    /// e^(-dT/2) sinh(mT)/m.
    pub sinh: Complex<S>,
    /// Derivative of [`Propagator::sinh`] with respect to z = m^2.
    pub sinh_slope: Complex<S>,
    /// e^(-dT).
    pub contraction: Complex<S>,
}

/// The flow with complex damping d and z = m^2.
///
/// The derivative of `cosh` by z is T `sinh`/2, of `sinh` (T `cosh` - `sinh`)/(2z).
pub fn propagator<S: Real>(d: &Complex<S>, z: &Complex<S>, time: &S) -> Propagator<S> {
    let decay = -(d.scaled(time).scaled(&time.integer(1).halved()));
    let u_squared = z.scaled(&time.square());
    if u_squared.magnitude_above() < SERIES_BELOW {
        return by_series(&decay, &u_squared, time);
    }
    // Growth and decay in one exponent each: no overflow in between.
    let u = u_squared.sqrt();
    let forward = (decay.clone() + &u).exp();
    let backward = (decay - &u).exp();
    let half = time.integer(1).halved();
    let cosh = (forward.clone() + &backward).scaled(&half);
    let sinh_over_u = (forward.clone() - &backward).over(&u).scaled(&half);
    let slope = (cosh.clone() - &sinh_over_u).over(&u_squared).scaled(&half);
    Propagator {
        cosh,
        sinh: sinh_over_u.scaled(time),
        sinh_slope: slope.scaled(&(time.square() * time)),
        contraction: forward * &backward,
    }
}

/// The power series in q = u^2: cosh u = sum q^n/(2n)!, sinh u/u = sum q^n/(2n+1)! and its
/// derivative sum n q^(n-1)/(2n+1)!; for |q| < 1/2 the tail is below twice the first term left out.
fn by_series<S: Real>(decay: &Complex<S>, q: &Complex<S>, time: &S) -> Propagator<S> {
    let bits = f64::from(time.precision());
    let mut term = Complex::real(time.integer(1)); // q^n/(2n)!
    let mut before = Complex::real(time.integer(0)); // q^(n-1)/(2n)!
    let mut cosh = term.clone();
    let mut sinh = term.clone();
    let mut slope = before.clone();
    let mut bound = 1.0_f64; // log2 of a bound of |q^(n-1)/(2n)!|
    let mut n = 0_i64;
    while bound > -bits - 8.0 {
        n += 1;
        let factor = time.integer(1) / time.integer((2 * n - 1) * (2 * n));
        before = term.scaled(&factor);
        term = before.clone() * q;
        let odd = time.integer(1) / time.integer(2 * n + 1);
        cosh = cosh + &term;
        sinh = sinh + term.scaled(&odd);
        slope = slope + before.scaled(&(time.integer(n) * odd));
        bound = bound.min(0.0) - (((2 * n - 1) * (2 * n)) as f64).log2() - 1.0;
    }
    // |q| < 1/4: every later term of the three sums is below half its predecessor, the first below
    // |q^(n-1)|/(2n)!/32.
    let error = before.modulus() / time.integer(16);
    let widen =
        |value: &Complex<S>| Complex::new(value.re.widened(&error), value.im.widened(&error));
    let size = decay.exp();
    Propagator {
        cosh: widen(&cosh) * &size,
        sinh: widen(&sinh).scaled(time) * &size,
        sinh_slope: widen(&slope).scaled(&(time.square() * time)) * &size,
        contraction: size.clone() * &size,
    }
}

/// phi1(x) = (e^x - 1)/x, entire.
pub(crate) fn phi1<S: Real>(x: &Complex<S>) -> Complex<S> {
    let one = Complex::real(x.re.integer(1));
    if x.magnitude_above().is_nan() || x.magnitude_above() > 0.5 {
        return (x.exp() - &one).over(x);
    }
    // sum x^n/(n+1)!; |x| < 1 and the terms fall at least by halves.
    let bits = f64::from(x.re.precision());
    let (mut term, mut sum) = (one.clone(), one);
    let (mut bound, mut n) = (0.0, 1_i64);
    while bound > -bits - 8.0 {
        n += 1;
        term = (term * x).scaled(&(x.re.integer(1) / x.re.integer(n)));
        sum = sum + &term;
        bound -= (n as f64).log2() + 1.0;
    }
    let error = term.modulus();
    Complex::new(sum.re.widened(&error), sum.im.widened(&error))
}
