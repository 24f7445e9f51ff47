//! Containment: every operation against exact rational arithmetic (products, quotients) or
//! against other formulas at four times the precision (polar form for the root, exponentials
//! for the circular and hyperbolic functions), at centres, on rims and at corners.

use super::*;
use crate::ball::tests::Random;
use rug::Integer;
use rug::float::Constant;

/// A point z = (x, y) at many bits.
type Point = (Float, Float);

impl Random {
    fn dyadic(&mut self) -> Rational {
        let numerator = Integer::from(self.below(1 << 20)) - (1 << 19);
        let denominator = Integer::from(Integer::u_pow_u(2, self.below(30) as u32));
        Rational::from((numerator * 2 + 1, denominator))
    }
    /// A ball around `centre` and a point of it: centre, rim or between, radius 0 or not.
    fn part(&mut self, balls: Balls, centre: &Rational) -> (Ball, Rational) {
        let shift = -(self.below(2 * u64::from(balls.bits())) as i32);
        let error = Float::with_val(53, Float::i_exp([0, 1, 3][self.below(3) as usize], shift));
        let ball = balls.add_error(&balls.from_rational(centre), &error);
        let (m, r) = (ball.midpoint().to_rational().unwrap(), ball.radius().to_rational().unwrap());
        (ball, m + r * Rational::from((self.below(5) as i64 - 2, 2)))
    }
    fn rectangle(&mut self, c: ComplexBalls, z: &[Rational; 2]) -> (Complex, [Rational; 2]) {
        let ((re, x), (im, y)) = (self.part(c.real(), &z[0]), self.part(c.real(), &z[1]));
        (Complex { re, im }, [x, y])
    }
}

fn near(ball: &Ball, truth: &Float, scale: &Float) -> bool {
    let distance = Float::with_val(truth.prec(), ball.midpoint() - truth).abs();
    let slack = Float::with_val(53, scale.abs_ref()) >> (3 * ball.midpoint().prec());
    distance <= Float::with_val(2 * truth.prec(), ball.radius()) + slack
}

/// `scale` bounds the reference's own cancellation (its error is 2^(-3p) of it).
fn encloses(z: &Complex, truth: &Point, scale: &Float) -> bool {
    near(&z.re, &truth.0, scale) && near(&z.im, &truth.1, scale)
}

fn exponential((x, y): &Point) -> Point {
    let size = x.clone().exp();
    (size.clone() * y.clone().cos(), size * y.clone().sin())
}

/// (e^z + s e^-z)/2.
fn hyperbolic(z: &Point, s: i32) -> Point {
    let (plus, minus) = (exponential(z), exponential(&(-z.0.clone(), -z.1.clone())));
    ((plus.0 + minus.0 * s) / 2, (plus.1 + minus.1 * s) / 2)
}

fn polar_root((x, y): &Point) -> Point {
    let size = x.clone().hypot(y).sqrt();
    let half: Float = y.clone().atan2(x) / 2;
    (size.clone() * half.clone().cos(), size * half.sin())
}

type Unary = (&'static str, fn(ComplexBalls, &Complex) -> Option<Complex>, fn(&Point) -> Point);

const UNARY: &[Unary] = &[
    ("exp", |c, z| Some(c.exp(z)), exponential),
    ("sinh", |c, z| Some(c.sinh(z)), |z| hyperbolic(z, -1)),
    ("cosh", |c, z| Some(c.cosh(z)), |z| hyperbolic(z, 1)),
    ("cos", |c, z| Some(c.cos(z)), |(x, y)| hyperbolic(&(-y.clone(), x.clone()), 1)),
    (
        "sin",
        |c, z| Some(c.sin(z)),
        |(x, y)| {
            let (re, im) = hyperbolic(&(-y.clone(), x.clone()), -1);
            (im, -re)
        },
    ),
    ("sqrt", |c, z| c.sqrt(z), polar_root),
    ("conj", |c, z| Some(c.conj(z)), |(x, y)| (x.clone(), -y.clone())),
    (
        "abs",
        |c, z| Some(c.from_real(c.abs(z))),
        |(x, y)| (x.clone().hypot(y), Float::new(x.prec())),
    ),
    (
        "square",
        |c, z| Some(c.square(z)),
        |(x, y)| (x.clone().square() - y.clone().square(), x.clone() * y * 2),
    ),
];

/// The cut, the origin, the axes, multiples of pi, cancellation in the square, tiny and large.
fn hard_points() -> Vec<[Rational; 2]> {
    let texts = ["0", "1", "-1", "355/113", "1/1000000000000000000000000000000", "-40", "100"];
    let mut values: Vec<Rational> = texts.iter().map(|t| t.parse().unwrap()).collect();
    values.push(Float::with_val(200, Constant::Pi).to_rational().unwrap() / 2);
    let pairs = values.iter().flat_map(|x| values.iter().map(|y| [x.clone(), y.clone()]));
    pairs.collect()
}

#[test]
fn unary_operations_contain_the_truth() {
    let mut random = Random(3);
    for bits in [2, 20, 64, 200] {
        let complex = ComplexBalls::new(Balls::new(bits));
        let mut inputs = hard_points();
        inputs.extend((0..200).map(|_| [random.dyadic(), random.dyadic()]));
        for centre in &inputs {
            for (name, operation, reference) in UNARY {
                let (ball, [x, y]) = random.rectangle(complex, centre);
                let Some(result) = operation(complex, &ball) else { continue };
                let wide = |q: &Rational| Float::with_val(4 * bits + 1200, q);
                // e^|x| and e^|y| bound what cancels in the reference; 2^30 bits are out of reach.
                if ball.abs_upper() > 2000 {
                    continue;
                }
                let truth = reference(&(wide(&x), wide(&y)));
                let scale = wide(&x).abs().max(&wide(&y).abs()).exp();
                assert!(encloses(&result, &truth, &scale), "{name} at {x} + i {y}: {result:?}");
            }
        }
    }
}

/// Products and quotients of rational points are rational: exact membership.
#[test]
fn binary_operations_contain_the_truth() {
    let mut random = Random(4);
    let mut divided = 0;
    for bits in [2, 20, 64, 200] {
        let complex = ComplexBalls::new(Balls::new(bits));
        let mut inputs = hard_points();
        inputs.extend((0..300).map(|_| [random.dyadic(), random.dyadic()]));
        for centre in &inputs {
            let other = &inputs[random.below(inputs.len() as u64) as usize];
            let (z, [a, b]) = random.rectangle(complex, centre);
            let (w, [c, d]) = random.rectangle(complex, other);
            let product = (
                Rational::from(&a * &c) - Rational::from(&b * &d),
                a.clone() * &d + b.clone() * &c,
            );
            assert!(complex.mul(&z, &w).contains(&product.0, &product.1), "{z:?} {w:?}");
            assert!(complex.add(&z, &w).contains(&(a.clone() + &c), &(b.clone() + &d)));
            assert!(complex.sub(&z, &w).contains(&(a.clone() - &c), &(b.clone() - &d)));
            if let Some(quotient) = complex.div(&z, &w) {
                let norm = Rational::from(c.square_ref()) + Rational::from(d.square_ref());
                let re = (Rational::from(&a * &c) + Rational::from(&b * &d)) / &norm;
                let im = (b * c - a * d) / norm;
                assert!(quotient.contains(&re, &im), "{z:?} / {w:?} = {quotient:?}");
                divided += 1;
            } else {
                assert!(w.abs_lower().is_zero());
            }
        }
    }
    assert!(divided > 600, "{divided} quotients tested");
}

#[test]
fn bounds_of_the_modulus() {
    let complex = ComplexBalls::new(Balls::new(60));
    let error = Float::with_val(53, 0.25);
    let z = complex.from_rationals(&Rational::from(3), &Rational::from(-4));
    assert!(complex.abs(&z).contains(&Rational::from(5)) && complex.abs(&z).is_exact());
    let z = complex.add_error(&z, &error);
    // Corners (2.75, 3.75) and (3.25, 4.25).
    assert!(z.abs_lower() <= 4.6503 && z.abs_lower() > 4.65);
    assert!(z.abs_upper() >= 5.3502 && z.abs_upper() < 5.3503);
    assert!(z.half_diagonal() > 0.3535 && z.half_diagonal() < 0.3536);
    assert!(complex.add_error(&complex.zero(), &error).abs_lower().is_zero());
}

/// A correct rectangle may still be useless: at full precision all but a few bits are right.
#[test]
fn radii_are_small() {
    let complex = ComplexBalls::new(Balls::new(100));
    let z = complex.from_rationals(&Rational::from((5, 7)), &Rational::from((-3, 11)));
    let w = complex.from_rationals(&Rational::from((-2, 9)), &Rational::from((8, 13)));
    let mut results: Vec<(&str, Complex)> =
        UNARY.iter().map(|(name, f, _)| (*name, f(complex, &z).unwrap())).collect();
    results.push(("mul", complex.mul(&z, &w)));
    results.push(("div", complex.div(&z, &w).unwrap()));
    for (name, result) in results {
        let accuracy = result.re.relative_accuracy_bits().min(result.im.relative_accuracy_bits());
        assert!(accuracy >= 92 || name == "abs", "{name} keeps {accuracy} bits");
    }
}

#[test]
fn partial_operations_refuse() {
    let complex = ComplexBalls::new(Balls::new(60));
    let error = Float::with_val(53, 1e-10);
    let minus_one = complex.neg(&complex.one());
    assert!(complex.div(&complex.one(), &complex.zero()).is_none());
    assert!(complex.div(&complex.one(), &complex.add_error(&complex.zero(), &error)).is_none());
    // On the cut: an exactly real number has a root, a rectangle across it has two.
    let root = complex.sqrt(&minus_one).unwrap();
    assert!(root.contains(&Rational::new(), &Rational::from(1)));
    assert!(complex.sqrt(&complex.add_error(&minus_one, &error)).is_none());
    assert!(complex.sqrt(&complex.add_error(&complex.one(), &error)).is_some());
    assert!(complex.sqrt(&complex.zero()).is_some_and(|root| root.is_exact()));
    let nothing = complex.indeterminate();
    assert!(!complex.one().contains_zero() && complex.zero().contains_zero());
    let half_known = Complex { re: nothing.re.clone(), ..complex.one() };
    assert!(!half_known.is_finite() && complex.one().is_finite());
    let half = complex.div_i64(&complex.one(), 2).unwrap();
    assert!(half.contains(&Rational::from((1, 2)), &Rational::new()));
    assert!(complex.div_i64(&half, 0).is_none());
    for (name, operation, _) in UNARY {
        let result = operation(complex, &nothing);
        let known = result.is_some_and(|z| z.re.is_finite());
        assert!(!known, "{name}");
    }
    assert!(complex.div(&complex.one(), &nothing).is_none());
}

#[test]
fn membership_needs_both_parts() {
    let c = ComplexBalls::new(Balls::new(60));
    let z = Complex { re: c.real().from_i64(2), im: c.real().from_i64(3) };
    let q = |n: i64| Rational::from(n);
    assert!(z.contains(&q(2), &q(3)));
    assert!(!z.contains(&q(2), &q(2)) && !z.contains(&q(3), &q(3)) && !z.contains(&q(3), &q(2)));
}
