//! The hyperbolic algebra: laws, exact integrals, J_{p,q} in balls.

use super::support::{assert_agrees, decimals, number, oracle};
use lindstedt::unstable::algebra::{Ring, laws};
use lindstedt::unstable::number::ball::{Ball, Balls};
use lindstedt_melnikov::hyperbolic::{
    Hyperbolic, HyperbolicRing, beta, line_fourier, line_integral,
};
use lindstedt_melnikov::quadrature::{Strip, trapezoid};
use lindstedt_tests::Random;
use rug::Rational;

const BALLS: u32 = 200;

#[test]
fn laws_of_the_ring() {
    let term = |n: i32, d: u32, p, tanh| Hyperbolic::term(Rational::from((n, d)), p, tanh);
    let ring = HyperbolicRing;
    let mut samples =
        vec![Hyperbolic::sech(1), Hyperbolic::tanh(), ring.zero(), term(3, 2, 0, false)];
    samples.push(ring.add(&term(-5, 7, 3, true), &term(1, 3, 2, false)));
    assert_eq!(laws::rational_algebra(&ring, &samples), Ok(()));
    for f in &samples {
        for g in &samples {
            let left = ring.derivative(&ring.mul(f, g));
            let right =
                ring.add(&ring.mul(&ring.derivative(f), g), &ring.mul(f, &ring.derivative(g)));
            assert_eq!(left, right, "Leibniz for {f} and {g}");
        }
    }
    // The integral of a derivative of something that decays on both sides is 0.
    let integral = ring.derivative(&samples[4]).integrate().unwrap();
    assert!(integral.rational.is_zero() && integral.pi.is_zero());
}

#[test]
fn table_of_integrals() {
    let balls = Balls::new(BALLS);
    for row in oracle("I_pq.json")["table"].as_array().unwrap() {
        let (p, q) = (number(row, "p"), row["q"].as_u64().unwrap() as u32);
        if q.is_multiple_of(2) {
            let value = beta(balls, &Rational::from((q + 1, 2)), &Rational::from(&p / 2)).unwrap();
            assert_agrees(&value, &row["I"], 29, &format!("I_({p}, {q})"));
        }
        if p.is_integer() {
            let p = p.numer().to_u32().unwrap();
            let exact = line_integral(p, q).unwrap();
            assert_agrees(&exact.ball(balls), &row["I"], 29, &format!("exact I_({p}, {q})"));
        }
    }
    assert!(line_integral(0, 2).is_none() && line_fourier(0, 2).is_none());
}

#[test]
fn table_of_fourier_integrals() {
    let balls = Balls::new(BALLS);
    for row in oracle("J_pq.json")["table"].as_array().unwrap() {
        let (p, q) = (number(row, "p"), row["q"].as_u64().unwrap() as u32);
        if p.is_integer() {
            let w = balls.from_rational(&number(row, "omega"));
            let p = p.numer().to_u32().unwrap();
            let exact = line_fourier(p, q).unwrap().ball(balls, &w).unwrap();
            assert_agrees(&exact, &row["J"], 28, &format!("J_({p}, {q})"));
        }
    }
}

/// The oracle's J table has omega = 0 only; other frequencies are checked by the certified
/// trapezoidal rule on the integrand itself, powers of tanh included.
fn by_quadrature(balls: Balls, p: u32, q: u32, w: &Rational) -> Ball {
    let half_width = Rational::from((1, 2));
    // |tanh(x + iy)| <= 1 for |y| <= pi/4.
    let edge = balls.powi(&balls.cos(&balls.from_rational(&half_width)), i64::from(p)).unwrap();
    let frequency = balls.from_rational(w);
    let growth = balls.cosh(&balls.mul_rational(&frequency, &half_width));
    let integral = line_integral(p, 0).unwrap().ball(balls);
    let strip = Strip {
        edge_integral: balls.div(&balls.mul(&growth, &integral), &edge).unwrap(),
        half_width,
        decay: Rational::from(p),
        amplitude: balls.powi(&balls.from_i64(2), i64::from(p)).unwrap(),
    };
    trapezoid(balls, &strip, |balls, z| {
        let cosh = balls.cosh(z);
        let tanh = balls.div(&balls.sinh(z), &cosh)?;
        let shape =
            balls.mul(&balls.powi(&cosh, -i64::from(p))?, &balls.powi(&tanh, i64::from(q))?);
        let angle = balls.mul(&frequency, z);
        let trig = if q.is_multiple_of(2) { balls.cos(&angle) } else { balls.sin(&angle) };
        Some(balls.mul(&shape, &trig))
    })
    .unwrap()
}

#[test]
fn fourier_integrals_by_quadrature() {
    let balls = Balls::new(140);
    let mut random = Random(1);
    for round in 0..40 {
        let p = 1 + (random.between(0.0, 1.0) * 8.0) as u32;
        let q = (random.between(0.0, 1.0) * 24.0) as u32;
        let w = decimals(&mut random, -3.0, 3.0);
        let ball = balls.from_rational(&w);
        let reference = by_quadrature(balls, p, q, &w);
        let what = format!("round {round}: J_({p}, {q})({w})");
        let value = line_fourier(p, q).unwrap().ball(balls, &ball).unwrap();
        assert!(value.overlaps(&reference), "{what}: {value:?} {reference:?}");
        assert!(
            value.relative_accuracy_bits() > 90 && reference.radius().to_f64() < 1e-38,
            "{what}"
        );
    }
}
