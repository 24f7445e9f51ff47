//! Reference values, functional equations, hard points.

use super::*;
use lindstedt_number::{NumberError, digits::certify};
use rug::ops::Pow;
use rug::{Float, Integer, Rational};

fn at(text: &str) -> Point {
    Point::Rational(text.parse().unwrap())
}

fn times_pi(text: &str) -> Point {
    Point::PiTimes(text.parse().unwrap())
}

fn ten_to(exponent: i32) -> Rational {
    Rational::from(10).pow(exponent)
}

/// Whether all of the ball lies within 10^(1-digits) of `text`, relatively.
fn agrees(value: &Ball, text: &str, digits: i32) -> bool {
    let expected = Float::with_val(600, Float::parse(text).unwrap());
    let wide = Balls::new(600);
    let difference = wide.sub(value, &wide.from_parts(&expected, &Float::new(53)));
    let tolerance = Float::with_val(53, 10).pow(1 - digits) * expected.abs();
    difference.abs_upper() <= tolerance
}

/// Asserts that two enclosures of one number overlap and that both are sharp.
fn assert_same(a: &Ball, b: &Ball, bits: i64, what: &str) {
    assert!(a.overlaps(b), "{what}: {a:?} and {b:?}");
    assert!(a.relative_accuracy_bits() >= bits, "{what}: {a:?}");
    assert!(b.relative_accuracy_bits() >= bits, "{what}: {b:?}");
}

/// mpmath 1.3.0, x ln 2 - clsin(2, pi - 2x)/2; the first group also in the project's notes
/// (section 5), where the printed L(pi/6) has wrong digits from the 25th on.
#[test]
fn lobachevsky_values() {
    let table = [
        (times_pi("1/8"), "0.0102535843071533417172747194826999375454648"),
        (times_pi("1/6"), "0.02461714624738248007638063161476222924253418"),
        (times_pi("1/4"), "0.0864137254872910250978704670932114314475712"),
        (times_pi("1/3"), "0.21839122689637389765629502227527783947535"),
        (at("1"), "0.187538169020838240502119304265529338852434"),
        (at("1/3"), "0.006242917431478146793654014687176903219779"),
        (at("5/4"), "0.4014298409454260674118598567387770823677"),
        (at("1000000"), "693147.420685456163940190133573109087638"),
        (Point::Rational(ten_to(100)), "6.931471805599453094172321214581765680755e99"),
        // (pi/2) ln 2 - y (1 - ln y) - y^3/18, y = pi 10^-50.
        (
            Point::PiTimes(Rational::from((1, 2)) - ten_to(-50)),
            "1.088793045151801065250344449118806973669",
        ),
        // x^3/6 + x^5/60.
        (Point::Rational(ten_to(-300)), "1.666666666666666666666666666666666666667e-901"),
    ];
    for (x, expected) in table {
        let value = lobachevsky(&x, Balls::new(150));
        assert!(agrees(&value, expected, 39), "L({x:?}) = {value:?}");
        assert!(value.relative_accuracy_bits() >= 146, "L({x:?}) = {value:?}");
    }
}

/// mpmath 1.3.0: quad of l^m/m! minus mu_m x, with mu_m from taylor of the Gamma quotient; the
/// values for m = 1 at large x from -clsin(2, pi - 2x)/2.
#[test]
fn lambda_values() {
    let table = [
        (1, at("1/2"), "-0.3251930534645644402898276057908677997505"),
        (1, at("3/2"), "-0.2092087711210815129784990908830027705362"),
        (1, at("7/2"), "-0.2406547348526413079159942880137346799029"),
        (1, at("355/226"), "0.000002152373622053254841899294625999123591024"),
        (1, Point::Rational(ten_to(100)), "-0.255085071208775464183182818549449360217"),
        (2, at("1/2"), "-0.3248988427256212540490856514115001718849"),
        (2, at("1"), "-0.6181959348776646482714429886696840771745"),
        (2, at("3/2"), "-0.4603979403607211884736606117110310935273"),
        (3, at("1/10"), "-0.06410636841276276110384312341028305211322"),
        (3, at("1"), "-0.6362981832095105722373247881448730941707"),
        (5, at("1/2"), "-0.3185369109349588325956546091005290801528"),
        (5, at("3/2"), "-0.9023267062035118244589969942704532598882"),
        (20, at("1"), "-0.6366197723980119720237375802880639363043"),
        (20, at("3/2"), "-0.9549296585958097714625896644396355077581"),
    ];
    for (m, x, expected) in table {
        let value = lambda(m, &x, Balls::new(150));
        assert!(agrees(&value, expected, 38), "Lambda_{m}({x:?}) = {value:?}");
        assert!(value.relative_accuracy_bits() >= 145, "Lambda_{m}({x:?}) = {value:?}");
    }
}

/// mu_2 = (ln^2 2 + pi^2/12)/2 in closed form; the others: mpmath 1.3.0, taylor of the quotient.
#[test]
fn mean_values() {
    let balls = Balls::new(150);
    let means = means(5, balls);
    let (ln_2, pi) = (balls.ln_2(), balls.pi());
    assert_same(&means[1], &ln_2, 148, "mu_1");
    let twelfth = balls.div_i64(&balls.square(&pi), 12).unwrap();
    let twice = balls.add(&balls.square(&ln_2), &twelfth);
    assert_same(&means[2], &balls.mul_power_of_two(&twice, -1), 145, "mu_2");
    let table = [
        (3, "0.6410636871154333406717217688945715913548"),
        (4, "0.6380226187042899522263479683597886256153"),
        (5, "0.6370738496633118437378314321262673278564"),
    ];
    for (m, expected) in table {
        assert!(agrees(&means[m], expected, 38), "mu_{m} = {:?}", means[m]);
    }
}

/// The two series and the means know nothing of each other:
/// int_0^(pi/4) l^m/m! + int_0^(pi/4) (-ln sin)^m/m! = mu_m pi/2.
#[test]
fn both_series_make_the_mean() {
    let balls = Balls::new(700);
    let sine = balls.sqrt(&balls.from_rational(&Rational::from((1, 2)))).unwrap();
    let (left, right) =
        (integrals::from_zero(&sine, 25, balls), integrals::from_pole(&sine, 25, balls));
    let half_pi = balls.mul_power_of_two(&balls.pi(), -1);
    for (m, mean) in means(25, balls).iter().enumerate() {
        let sum = balls.add(&left[m], &right[m]);
        assert_same(&sum, &balls.mul(mean, &half_pi), 680, &format!("m = {m}"));
    }
}

/// A truncation or rounding error larger than the radius shows at the higher precision.
#[test]
fn balls_overlap_those_of_four_times_the_precision() {
    let mut points = vec![
        Point::Rational(ten_to(-300)),
        Point::Rational(-ten_to(100)),
        Point::Rational(ten_to(6)),
        Point::PiTimes(Rational::from((1, 2)) - ten_to(-1000)),
        Point::PiTimes(Rational::from((3, 2)) + ten_to(-20)),
        Point::PiTimes(Rational::from((1, 4))),
        Point::PiTimes(ten_to(-400) - Rational::from(5)),
        // pi/2 and pi to 50 digits: the reduction must find more bits than it was asked for.
        at(
            "15707963267948966192313216916397514420985846996876/10000000000000000000000000000000000000000000000000",
        ),
        at(
            "31415926535897932384626433832795028841971693993751/10000000000000000000000000000000000000000000000000",
        ),
    ];
    points.extend((1..40).map(|k| Point::Rational(Rational::from((k * k - 300, 97)))));
    for x in &points {
        for bits in [2, 24, 64, 300] {
            let (coarse, fine) = (Balls::new(bits), Balls::new(4 * bits));
            let least = i64::from(bits) - 6;
            assert_same(
                &lobachevsky(x, coarse),
                &lobachevsky(x, fine),
                least,
                &format!("L({x:?})"),
            );
            let (low, high) = (log_cosine(x, coarse).unwrap(), log_cosine(x, fine).unwrap());
            assert_same(&low, &high, least, &format!("ln|cos {x:?}|"));
            assert_same(&cosine(x, coarse), &cosine(x, fine), least, &format!("cos {x:?}"));
            assert_same(&sine(x, coarse), &sine(x, fine), least, &format!("sin {x:?}"));
            let few = LambdaTable::new(4, coarse).values(x);
            let many = LambdaTable::new(4, fine).values(x);
            for (m, (low, high)) in few.iter().zip(&many).enumerate().skip(1) {
                assert_same(low, high, least, &format!("Lambda_{m}({x:?})"));
            }
        }
    }
}

#[test]
fn symmetries_and_duplication() {
    let balls = Balls::new(400);
    let half_pi = balls.mul_power_of_two(&balls.pi(), -1);
    let period = balls.mul(&balls.pi(), &balls.ln_2());
    for k in 1..30 {
        let q = Rational::from((k, 59));
        let x = Point::PiTimes(q.clone());
        let value = lobachevsky(&x, balls);
        let moved = lobachevsky(&Point::PiTimes(q.clone() + 1), balls);
        assert_same(&moved, &balls.add(&value, &period), 390, "L(x + pi) = L(x) + pi ln 2");
        let mirrored = lobachevsky(&Point::PiTimes(Rational::from(-&q)), balls);
        assert_same(&mirrored, &balls.neg(&value), 390, "L(-x) = -L(x)");
        // sin 2t = 2 sin t cos t, integrated from 0: with P(x) = -int_0^x ln|sin t| dt =
        // (pi/2) ln 2 - L(pi/2 - x), P(2x)/2 = -x ln 2 + P(x) + L(x).
        let from_pole = |q: Rational| {
            let complement = lobachevsky(&Point::PiTimes(Rational::from((1, 2)) - q), balls);
            balls.sub(&balls.mul(&half_pi, &balls.ln_2()), &complement)
        };
        let left = balls.mul_power_of_two(&from_pole(Rational::from(&q * 2)), -1);
        let linear = balls.mul_rational(&period, &q);
        let right = balls.sub(&balls.add(&from_pole(q), &value), &linear);
        assert_same(&left, &right, 380, "duplication");
    }
}

/// Lambda_m' = l^m/m! - mu_m by a central difference with step 10^-40: error about 10^-80.
#[test]
fn derivatives() {
    let balls = Balls::new(600);
    let table = LambdaTable::new(6, balls);
    let step = ten_to(-40);
    for x in ["1/5", "7/9", "11/10", "-3/2", "22/7", "40"] {
        let q: Rational = x.parse().unwrap();
        let right = table.values(&Point::Rational(q.clone() + &step));
        let left = table.values(&Point::Rational(q.clone() - &step));
        let log = balls.neg(&log_cosine(&Point::Rational(q), balls).unwrap());
        let mut factorial = Integer::from(1);
        for m in 1..=6_i64 {
            factorial *= m;
            let index = m as usize;
            let difference = balls.sub(&right[index], &left[index]);
            let slope = balls.div(&difference, &balls.from_rational(&Rational::from(&step * 2)));
            let power = balls.powi(&log, m).unwrap();
            let power = balls.div(&power, &balls.from_integer(&factorial)).unwrap();
            let expected = balls.sub(&power, &table.means()[index]);
            let error = balls.sub(&slope.unwrap(), &expected).abs_upper();
            assert!(error < 1e-75, "Lambda_{m}'({x}): {error}");
        }
    }
}

/// Against MPFR's own reduction, in all four quadrants and on both sides of pi/4.
#[test]
fn sines_and_cosines() {
    let (balls, wide) = (Balls::new(100), Balls::new(300));
    for k in -60..60 {
        let q = Rational::from((2 * k + 1, 9));
        let (x, ball) = (Point::Rational(q.clone()), wide.from_rational(&q));
        assert_same(&cosine(&x, balls), &wide.cos(&ball), 97, "cos");
        assert_same(&sine(&x, balls), &wide.sin(&ball), 97, "sin");
        let log = wide.ln(&wide.abs(&wide.cos(&ball))).unwrap();
        assert_same(&log_cosine(&x, balls).unwrap(), &log, 97, "ln|cos|");
    }
}

#[test]
fn exact_values() {
    let balls = Balls::new(60);
    let is = |ball: &Ball, n: i32| ball.is_exact() && *ball.midpoint() == n;
    for zero in [at("0"), times_pi("0"), times_pi("3"), times_pi("-2")] {
        assert!(lambda(3, &zero, balls).is_exact() && is(&sine(&zero, balls), 0));
        assert!(is(&log_cosine(&zero, balls).unwrap(), 0));
    }
    assert!(is(&lobachevsky(&at("0"), balls), 0) && is(&lobachevsky(&times_pi("0"), balls), 0));
    assert!(is(&cosine(&times_pi("3"), balls), -1) && is(&cosine(&times_pi("-2"), balls), 1));
    for (pole, sign) in [("1/2", 1), ("-1/2", -1), ("3/2", -1), ("-3/2", 1), ("101/2", 1)] {
        let pole = times_pi(pole);
        assert!(is(&lambda(2, &pole, balls), 0) && log_cosine(&pole, balls).is_none());
        assert!(is(&cosine(&pole, balls), 0) && is(&sine(&pole, balls), sign), "{pole:?}");
    }
    let period = balls.mul(&balls.pi(), &balls.ln_2());
    let three = balls.mul_rational(&period, &Rational::from((3, 2)));
    assert_same(&lobachevsky(&times_pi("3/2"), balls), &three, 55, "L(3 pi/2)");
    assert!(is(&lambda(0, &at("1"), balls), 0));
    assert!(Point::from_f64(f64::NAN).is_none() && Point::from_f64(0.5) == Some(at("1/2")));
}

/// The same table as above through the printing path, and what happens at a pole.
#[test]
fn certified_digits() {
    let of = |digits, f: &dyn Fn(Balls) -> Option<Ball>| certify(digits, 10_000, f);
    let value = |x: &Point, digits| of(digits, &|balls| Some(lobachevsky(x, balls))).unwrap().0;
    assert_eq!(value(&times_pi("1/6"), 40), "0.02461714624738248007638063161476222924253");
    assert_eq!(value(&at("1000001/1000000"), 1000).len(), 1002);
    let second = |x: &Point| of(30, &|balls| Some(lambda(2, x, balls))).unwrap();
    assert_eq!(second(&at("1")).0, "-0.618195934877664648271442988670");
    assert_eq!(second(&times_pi("1/2")), ("0".to_owned(), "0".to_owned()));
    let log = |x: &Point, digits| of(digits, &|balls| log_cosine(x, balls));
    assert_eq!(log(&times_pi("1/2"), 30), Err(NumberError::Undefined));
    assert_eq!(log(&Point::Rational(ten_to(-20)), 5).unwrap().0, "-5.0000e-41");
}
