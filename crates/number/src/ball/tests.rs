//! Containment: every operation against MPFR at four times the precision, at points inside and
//! on the rim of the operand balls.

use super::*;

/// Knuth's 64-bit linear congruential generator: tests need no better one.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn below(&mut self, n: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }
    /// An odd numerator over a power of two or of ten, of either sign and many sizes.
    fn rational(&mut self) -> Rational {
        let numerator = Integer::from(self.below(1 << 30)) - (1 << 29);
        let denominator =
            Integer::from(Integer::u_pow_u([2, 10][self.below(2) as usize], self.below(28) as u32));
        Rational::from((numerator * 2 + 1, denominator))
    }
    /// A ball and a point that certainly lies in it: centre, rim or between, radius 0 or not.
    fn ball(&mut self, balls: Balls, centre: &Rational) -> (Ball, Rational) {
        let ball = balls.from_rational(centre);
        let shift = -(self.below(2 * u64::from(balls.bits())) as i32);
        let error = Float::with_val(53, Float::i_exp([0, 1, 3][self.below(3) as usize], shift));
        let ball = balls.add_error(&ball, &error);
        let (centre, radius) =
            (ball.midpoint().to_rational().unwrap(), ball.radius().to_rational().unwrap());
        let theta = Rational::from((self.below(5) as i64 - 2, 2));
        (ball, centre + theta * radius)
    }
}

/// Whether `truth`, known to far more bits than the ball has, lies in the ball.
fn encloses(ball: &Ball, truth: &Float) -> bool {
    let distance = Float::with_val(truth.prec(), ball.midpoint() - truth).abs();
    let slack = Float::with_val(53, truth.abs_ref()) >> (3 * ball.midpoint().prec());
    let reach = Float::with_val(2 * truth.prec(), ball.radius()) + slack;
    distance <= reach
}

type Unary = (&'static str, fn(Balls, &Ball) -> Option<Ball>, fn(Float) -> Float);

const UNARY: &[Unary] = &[
    ("exp", |b, a| Some(b.exp(a)), Float::exp),
    ("sin", |b, a| Some(b.sin(a)), Float::sin),
    ("cos", |b, a| Some(b.cos(a)), Float::cos),
    ("tan", |b, a| b.tan(a), Float::tan),
    ("atan", |b, a| Some(b.atan(a)), Float::atan),
    ("sinh", |b, a| Some(b.sinh(a)), Float::sinh),
    ("cosh", |b, a| Some(b.cosh(a)), Float::cosh),
    ("ln", |b, a| b.ln(a), Float::ln),
    ("ln(1 + x)", |b, a| b.ln_1p(a), Float::ln_1p),
    ("times -13", |b, a| Some(b.mul_i64(a, -13)), |x| x * -13),
    ("over -13", |b, a| b.div_i64(a, -13), |x| x / -13),
    ("sqrt", |b, a| b.sqrt(a), Float::sqrt),
    ("square", |b, a| Some(b.square(a)), Float::square),
    ("abs", |b, a| Some(b.abs(a)), Float::abs),
    ("neg", |b, a| Some(b.neg(a)), |x| -x),
    ("cube", |b, a| b.powi(a, 3), |x| x.pow(3)),
    ("power 17", |b, a| b.powi(a, 17), |x| x.pow(17)),
    ("power -5", |b, a| b.powi(a, -5), |x| x.pow(-5)),
    ("times 8", |b, a| Some(b.mul_power_of_two(a, 3)), |x| x * 8),
    (
        "times 22/7",
        |b, a| Some(b.mul_rational(a, &Rational::from((22, 7)))),
        |x| x * Rational::from((22, 7)),
    ),
];

type Binary = (&'static str, fn(Balls, &Ball, &Ball) -> Option<Ball>, fn(Float, Float) -> Float);

const BINARY: &[Binary] = &[
    ("add", |c, a, b| Some(c.add(a, b)), |x, y| x + y),
    ("sub", |c, a, b| Some(c.sub(a, b)), |x, y| x - y),
    ("mul", |c, a, b| Some(c.mul(a, b)), |x, y| x * y),
    (
        "sum of products",
        |c, a, b| Some(c.sum_of_products(&[(a, b), (b, b), (a, a)])),
        |x, y| x.clone() * &y + y.square() + x.square(),
    ),
    ("div", |c, a, b| c.div(a, b), |x, y| x / y),
    ("hull left", |c, a, b| Some(c.hull(a, b)), |x, _| x),
    ("hull right", |c, a, b| Some(c.hull(a, b)), |_, y| y),
];

/// Points where cancellation or a pole is near: 0, +-1, pi/2 to 60 digits, tiny and large.
fn hard_points() -> Vec<Rational> {
    let texts = ["0/1", "1/1", "-1/1", "1000000007/1000000006", "-710/113", "355/226", "12345/1"];
    let mut points: Vec<Rational> = texts.iter().map(|t| t.parse().unwrap()).collect();
    points.push(Float::with_val(200, Constant::Pi).to_rational().unwrap() / 2);
    points.push(Rational::from((1, Integer::from(Integer::u_pow_u(10, 300)))));
    points.push(Rational::from(Integer::u_pow_u(10, 100)));
    points
}

#[test]
fn unary_operations_contain_the_truth() {
    let mut random = Random(1);
    for bits in [2, 20, 64, 200] {
        let balls = Balls::new(bits);
        let mut inputs = hard_points();
        inputs.extend((0..200).map(|_| random.rational()));
        for centre in &inputs {
            for (name, operation, reference) in UNARY {
                let (ball, point) = random.ball(balls, centre);
                let Some(result) = operation(balls, &ball) else {
                    continue;
                };
                // The operand has up to 1000 bits of exponent: keep 4 p bits after reduction.
                let truth = reference(Float::with_val(4 * bits + 1200, &point));
                if truth.is_finite() {
                    assert!(
                        encloses(&result, &truth),
                        "{name} at {point}: {result:?} misses {truth}"
                    );
                }
            }
        }
    }
}

#[test]
fn binary_operations_contain_the_truth() {
    let mut random = Random(2);
    for bits in [2, 20, 64, 200] {
        let balls = Balls::new(bits);
        for _ in 0..500 {
            let (x, y) = (random.rational(), random.rational());
            for (name, operation, reference) in BINARY {
                let ((a, x), (b, y)) = (random.ball(balls, &x), random.ball(balls, &y));
                let Some(result) = operation(balls, &a, &b) else {
                    continue;
                };
                let wide = |q: &Rational| Float::with_val(4 * bits + 1200, q);
                let truth = reference(wide(&x), wide(&y));
                assert!(encloses(&result, &truth), "{name} at {x}, {y}: {result:?} misses {truth}");
            }
        }
    }
}

/// A correct ball may still be useless: at full precision all but a few bits are right.
#[test]
fn radii_are_small() {
    let balls = Balls::new(100);
    let x = balls.from_rational(&Rational::from((5, 7)));
    for (name, operation, _) in UNARY {
        let accuracy = operation(balls, &x).map_or(0, |y| y.relative_accuracy_bits());
        assert!(accuracy >= 94, "{name} keeps {accuracy} bits");
    }
}

/// Bounds that are larger than they must be lose digits, not truths: no containment shows them.
#[test]
fn radii_are_no_larger_than_they_must_be() {
    let balls = Balls::new(64);
    let of = |p: i64, q: i64| balls.from_rational(&Rational::from((p, q)));
    // 1/4 <= 1/3 < 1/2: half a unit in the last place is 2^-66.
    assert_eq!(*of(1, 3).radius(), Float::with_val(53, Float::i_exp(1, -66)));
    let hull = balls.hull(&of(1, 1), &of(3, 1));
    assert!(*hull.midpoint() == 2 && *hull.radius() == 1);
    let around_zero = balls.add_error(&balls.zero(), of(1, 1).midpoint());
    assert_eq!(*balls.atan(&around_zero).radius(), 1);
    for accurate in [balls.sin(&of(701, 7)), balls.ln_1p(&of(-5, 7)).unwrap()] {
        assert!(accurate.relative_accuracy_bits() >= 55, "{accurate:?}");
    }
}

#[test]
fn wide_balls_know_what_they_can() {
    let balls = Balls::new(60);
    let wide = |middle: i64, radius| {
        balls.add_error(&balls.from_i64(middle), &Float::with_val(53, radius))
    };
    // Far out the arctangent is flat: 1/(1 + 999^2) at most.
    assert!(*balls.atan(&wide(1000, 1.0)).radius() < 1.01e-6);
    // More than a period: [-1, 1], not more.
    assert!(*balls.sin(&wide(1, 3.0)).radius() <= 1 && *balls.cos(&wide(1, 7.0)).radius() <= 1);
}

#[test]
fn partial_operations_refuse() {
    let balls = Balls::new(60);
    let around_zero = balls.add_error(&balls.zero(), &Float::with_val(53, 1e-30));
    let minus = balls.from_i64(-1);
    assert!(
        balls.div(&minus, &around_zero).is_none() && balls.div(&minus, &balls.zero()).is_none()
    );
    assert!(
        balls.ln(&around_zero).is_none()
            && balls.ln(&balls.zero()).is_none()
            && balls.ln(&minus).is_none()
    );
    assert!(balls.ln_1p(&minus).is_none());
    assert!(balls.sqrt(&around_zero).is_none() && balls.sqrt(&minus).is_none());
    assert!(balls.sqrt(&balls.zero()).is_some_and(|root| root.is_exact()));
    assert!(balls.powi(&around_zero, -1).is_none() && balls.zeta(1).is_none());
    let half_pi = balls.mul_power_of_two(&balls.pi(), -1);
    assert!(balls.tan(&half_pi).is_none());
    assert!(balls.from_f64(f64::NAN).is_none() && balls.from_f64(f64::INFINITY).is_none());
    let half = balls.from_f64(-1.5).unwrap();
    assert!(half.is_exact() && half.contains(&Rational::from((-3, 2))));
    // A pole of the tangent lies in [1.3, 1.7].
    let middle = balls.from_rational(&Rational::from((3, 2)));
    assert!(balls.tan(&balls.add_error(&middle, &Float::with_val(53, 0.2))).is_none());
}

#[test]
fn overflow_and_underflow_are_never_wrong() {
    let balls = Balls::new(60);
    let huge = balls.from_rational(&Rational::from(Integer::u_pow_u(10, 100)));
    assert!(!balls.exp(&huge).is_finite() && !balls.cosh(&huge).is_finite());
    let tiny = balls.exp(&balls.neg(&huge));
    assert!(tiny.is_finite() && !tiny.is_exact() && tiny.contains_zero());
    let more = balls.powi(&huge, i64::MAX);
    assert!(more.is_some_and(|ball| !ball.is_finite()));
    let small = balls.powi(&balls.from_i64(10), -100_000);
    assert!(small.is_some_and(|ball| !ball.contains_zero() && ball.relative_accuracy_bits() > 58));
    let nothing = balls.exp(&huge);
    for (name, operation, _) in UNARY {
        assert!(operation(balls, &nothing).is_none_or(|ball| !ball.is_finite()), "{name}");
    }
    // Powers of two that are no numbers of the machine, and an exact product beyond the largest exponent.
    let shifted = |k| balls.mul_power_of_two(&balls.one(), k);
    assert!(!shifted(i32::MIN).is_finite() && !shifted(i32::MAX).is_finite());
    let largest = shifted(rug::float::exp_max() - 1);
    assert!(largest.is_exact() && !balls.add(&largest, &largest).is_finite());
    // The phase of 2^(10^8) is not reduced: that would take 10^8 bits of pi.
    let far = balls.mul_power_of_two(&balls.one(), 100_000_000);
    assert!(
        balls.sin(&far).contains(&Rational::from(-1))
            && balls.cos(&far).contains(&Rational::from(1))
    );
}

#[test]
fn membership_is_exact() {
    let balls = Balls::new(60);
    let ball = balls.from_parts(&Float::with_val(60, 3), &Float::with_val(53, 0.25));
    let inside = Rational::from((13, 4));
    let outside = &inside + Rational::from((1, Integer::from(Integer::u_pow_u(10, 90))));
    assert!(ball.contains(&inside) && !ball.contains(&outside));
    let mirrored = (Rational::from(6) - &inside, Rational::from(6) - &outside);
    assert!(ball.contains(&mirrored.0) && !ball.contains(&mirrored.1));
    let other = balls.from_parts(&Float::with_val(60, 3.5), &Float::with_val(53, 0.25));
    assert!(ball.overlaps(&other) && !ball.overlaps(&balls.from_i64(4)));
    assert!(ball.abs_lower() == 2.75 && ball.abs_upper() == 3.25);
    assert!(ball.lower() == 2.75 && ball.upper() == 3.25);
    assert!(ball.is_positive() && !ball.is_negative() && balls.neg(&ball).is_negative());
}

/// Abramowitz & Stegun, tables 1.1 and 23.3.
#[test]
fn constants() {
    let balls = Balls::new(80);
    let table = [
        (balls.pi(), "3.14159265358979323846"),
        (balls.ln_2(), "0.69314718055994530942"),
        (balls.zeta(3).unwrap(), "1.20205690315959428540"),
    ];
    for (ball, text) in table {
        let digits = Float::with_val(80, Float::parse(text).unwrap());
        let difference = Float::with_val(80, ball.midpoint() - &digits).abs();
        assert!(!ball.is_exact() && difference < 6e-21, "{text}");
    }
}
