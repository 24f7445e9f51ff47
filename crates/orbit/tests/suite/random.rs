//! Random orbits of random polynomial oscillators: what is proved holds, without exception.

use crate::common::{equation, integrate, proved, rough_guess, value, x, y};
use lindstedt_equation::Expression;
use lindstedt_orbit::{Kind, Proof};
use rug::{Float, Rational};

/// Digits of the judge.
const JUDGE: u32 = 34;
const BITS: u32 = 160;

/// A linear congruential generator (Knuth's constants): the same problems everywhere.
struct Dice(u64);

impl Dice {
    /// A rational number in [-1, 1] with a small denominator.
    fn rational(&mut self) -> Rational {
        Rational::from((self.below(41) as i64 - 20, 20))
    }

    fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
}

fn number(q: Rational) -> Expression {
    Expression::Number(q)
}

/// x'' + x + sum of three terms even in x'.
fn family(dice: &mut Dice) -> (Expression, Rational) {
    let mut rest = x();
    for _ in 0..3 {
        let (i, j) = (2 + dice.below(4) as i64, 2 * (dice.below(4) / 3) as i64);
        rest = rest + number(dice.rational() / 2) * x().pow(i) * y().pow(j);
    }
    (equation(rest), Rational::from((1 + dice.below(8), 8)))
}

/// x'' + x + c x^i + mu (x^2 - 1 + d x) x' (1 + e x'^2).
fn cycle(dice: &mut Dice) -> Expression {
    let mu = Rational::from((2 + dice.below(16), 10));
    let spring =
        number(dice.rational() / 8) * x().pow(2) + number(dice.rational() / 10) * x().pow(3);
    let damping = x().pow(2) - 1 + number(dice.rational() / 2) * x();
    let more = y().pow(2) * number(Rational::from((dice.below(5), 40))) + 1;
    equation(x() + spring + number(mu) * damping * y() * more)
}

/// The time at which x' changes sign near `time`, and x there: two Newton steps.
fn turn(equation: &Expression, state: &[Float; 2], time: &Float) -> (Float, Float) {
    let mut time = time.clone();
    let mut last = Float::new(BITS);
    for _ in 0..2 {
        let [at, rate] = integrate(equation, state, &time, JUDGE);
        // x'' in doubles: Newton's step gains sixteen digits.
        let bend = -value(equation, [at.to_f64(), rate.to_f64(), 0.0]);
        time -= Float::with_val(BITS, &rate / bend);
        last = at;
    }
    (time, last)
}

/// Whether a number that the judge knows to `slack` can lie in the ball.
fn holds(ball: &lindstedt_number::ball::Ball, value: &Float, slack: f64) -> bool {
    let distance = Float::with_val(BITS, ball.midpoint() - value).abs();
    distance <= Float::with_val(BITS, ball.radius() + slack)
}

fn check_family(equation: &Expression, a: &Rational, proof: &Proof) {
    let state = [Float::with_val(BITS, a), Float::new(BITS)];
    let (period, _) = turn(equation, &state, proof.period.midpoint());
    assert!(holds(&proof.period, &period, 1e-26), "{equation:?} {a}: {period}");
    // Half a period is the other extremum.
    let half = Float::with_val(BITS, &period / 2u32);
    let [other, _] = integrate(equation, &state, &half, JUDGE);
    let ends = [&proof.motion.minimum, &proof.motion.maximum];
    assert!(ends.iter().any(|end| holds(end, &other, 1e-26)), "{equation:?} {a}: {other}");
    let (x, v) = proof.at(&Rational::from((7, 3)));
    let end = integrate(equation, &state, &Float::with_val(BITS, Rational::from((7, 3))), JUDGE);
    assert!(holds(&x, &end[0], 1e-26) && holds(&v, &end[1], 1e-26), "{equation:?} {a}");
}

fn check_cycle(equation: &Expression, proof: &Proof) {
    // From the proved maximum the flow itself converges to the cycle.
    let mut state = [Float::with_val(BITS, proof.motion.maximum.midpoint()), Float::new(BITS)];
    let mut period = Float::with_val(BITS, proof.period.midpoint());
    for _ in 0..3 {
        let (time, top) = turn(equation, &state, &period);
        period = time;
        state = [top, Float::new(BITS)];
    }
    // What is left of 1e-16 after three returns.
    let multiplier = (proof.exponent.midpoint().to_f64() * period.to_f64()).exp();
    let slack = 1e-26 + 1e-16 * multiplier.powi(2);
    assert!(holds(&proof.period, &period, slack), "{equation:?}: {period}");
    assert!(holds(&proof.motion.maximum, &state[0], slack), "{equation:?}: {}", state[0]);
}

/// (proved, tried).
fn trial(count: usize, seed: u64) -> (usize, usize) {
    let (mut dice, mut done, mut tried) = (Dice(seed), 0, 0);
    for i in 0..count {
        if i % 2 == 0 {
            let (equation, a) = family(&mut dice);
            let Some(start) = rough_guess(&equation, [a.to_f64(), 0.0], 0.0) else { continue };
            tried += 1;
            if let Ok(proof) = proved(&equation, &Kind::InitialAmplitude(a.clone()), &start, 16) {
                check_family(&equation, &a, &proof);
                done += 1;
            }
        } else {
            let equation = cycle(&mut dice);
            let Some(start) = rough_guess(&equation, [1.0, 0.0], 40.0) else { continue };
            tried += 1;
            if let Ok(proof) = proved(&equation, &Kind::LimitCycle, &start, 16) {
                check_cycle(&equation, &proof);
                done += 1;
            }
        }
    }
    println!("{done} of {tried} proved");
    (done, tried)
}

#[test]
fn random_orbits_are_where_they_are_proved_to_be() {
    let (done, tried) = trial(24, 1);
    assert!(tried > 16 && done * 10 >= tried * 9, "{done} of {tried}");
}

#[test]
#[ignore = "minutes"]
fn a_thousand_random_orbits_are_where_they_are_proved_to_be() {
    let (done, tried) = trial(1000, 2);
    assert!(tried > 600 && done * 10 >= tried * 9, "{done} of {tried}");
}
