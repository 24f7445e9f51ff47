//! The threshold of stick-slip chaos over the speed of the belt, and where it vanishes.

use lindstedt::Exact;
use lindstedt::unstable::melnikov::{Axis, FastPoint, MelnikovError, StickSlip};
use lindstedt::unstable::number::ball::Balls;
use lindstedt::unstable::number::digits::decimal;

fn main() -> Result<(), MelnikovError> {
    // Doubles for the curve.
    let point =
        FastPoint { a: 1.0, b: 1.0, dry: 0.3, alpha: 0.3, beta: 0.3, omega: 2.0, belt_speed: 0.0 };
    for tenth in 0..=10 {
        let speed = f64::from(tenth) / 10.0;
        let threshold = point.with(Axis::BeltSpeed, speed).threshold()?;
        println!("vstar = {speed:.1}: gamma_c = {:.12}", threshold.signed.abs());
    }

    // Balls for what is to be quoted: every digit printed is proved.
    let balls = Balls::new(160);
    let undecided = MelnikovError::Undecided { bits: 160 };
    let point = StickSlip {
        a: Exact::from(1),
        b: Exact::from(1),
        dry: Exact::from((3, 10)),
        alpha: Exact::from((3, 10)),
        beta: Exact::from((3, 10)),
        omega: Exact::from(2),
        belt_speed: Exact::from((2, 5)),
    };
    let proved = point.signed_threshold(balls).and_then(|g| decimal(&g, 30));
    println!("vstar = 2/5 with 30 digits: {}", proved.ok_or(undecided.clone())?);
    let soft = StickSlip { b: Exact::from(5), ..point };
    let found = soft.zeros_in(balls, Axis::BeltSpeed, &Exact::from(0), &Exact::from(1))?;
    for zero in &found.zeros {
        println!("b = 5: zero at vstar = {}", decimal(zero, 30).ok_or(undecided.clone())?);
    }
    println!("no other zero between 0 and 1: {}", found.complete);
    Ok(())
}
