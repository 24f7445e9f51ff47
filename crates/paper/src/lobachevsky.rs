//! The Lobachevsky function of the text below (41).

use super::{Findings, Reader, Row, periods};
use lindstedt::Error;
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::PolynomialRing;
use lindstedt_coeff::print::{Print, Style};
use lindstedt_number::ball::Ball;
use lindstedt_number::digits::decimal;
use lindstedt_phase::fourier::lambda_harmonics;
use lindstedt_phase::lobachevsky_function::{Point, lobachevsky};
use rug::{Float, Rational};

/// Harmonics of the printed series that are compared, exactly.
const HARMONICS: u32 = 200;

/// Where properties of L are tested, in units of pi.
const POINTS: [(i32, u32); 5] = [(1, 8), (1, 3), (2, 7), (9, 20), (-3, 11)];

/// The rows from the definition of L to L(2 pi).
pub(super) fn rows(reader: &Reader<'_>) -> Result<Vec<Row>, Error> {
    let balls = reader.balls;
    let l = |q: &Rational| lobachevsky(&Point::PiTimes(q.clone()), balls);
    let pi_times = |q: &Rational| Float::with_val(200, rug::float::Constant::Pi) * q;
    let quadrature = |from: &Rational, to: &Rational| {
        periods::integral_of_log_secant(&pi_times(from), &pi_times(to))
    };
    let points: Vec<Rational> = POINTS.iter().map(|p| Rational::from(*p)).collect();
    let zero = Rational::new();
    let mut rows = Vec::new();
    let mut push = |label: &str,
                    printed: &str,
                    derived: String,
                    independent: String,
                    holds,
                    evidence: String| {
        rows.push(Row::new(
            label,
            printed,
            derived,
            independent,
            &Findings::holds(holds),
            evidence,
        ));
    };
    let show = |ball: &Ball| decimal(ball, 15).unwrap_or_else(|| "?".to_owned());
    // The definition, against the integral itself.
    let third = Rational::from((1, 3));
    let direct = quadrature(&zero, &third);
    let holds = points.iter().all(|q| near(&l(q), &quadrature(&zero, q)));
    push(
        "$L$",
        "$L(x) = -int_0^x ln|cos t| dt$",
        format!("$L(pi/3) = {}$", show(&l(&third))),
        format!("quadrature: {} (estimated)", direct.to_string_radix(10, Some(15))),
        holds,
        format!(
            "the series of the program and the integral agree to 25 digits at {} points",
            points.len()
        ),
    );
    let odd = points.iter().all(|q| l(q).overlaps(&balls.neg(&l(&Rational::from(-q)))));
    let odd = odd
        && points.iter().all(|q| {
            let mirrored = Rational::from(-q);
            near(&balls.neg(&l(q)), &quadrature(&zero, &mirrored))
        });
    push(
        "$L$ odd",
        "$L(x) = -L(-x)$ for $-pi/2 <= x <= pi/2$",
        "$L$ is odd on the whole line".to_owned(),
        "quadrature from 0 to $-x$".to_owned(),
        odd,
        "the integrand is even; compared at the test points".to_owned(),
    );
    for (label, printed, shift) in [
        ("$L(x - pi)$", "$L(x - pi) = L(x) - pi ln 2$", -1),
        ("$L(x + pi)$", "$L(x + pi) = L(x) + pi ln 2$", 1),
    ] {
        let step = balls.mul_i64(&balls.mul(&balls.pi(), &balls.ln_2()), shift);
        let holds = points.iter().all(|q| {
            let moved = Rational::from(q + shift);
            let expected = balls.add(&l(q), &step);
            l(&moved).overlaps(&expected) && near(&expected, &quadrature(&zero, &moved))
        });
        let moved = Rational::from(&third + shift);
        push(
            label,
            printed,
            format!("$L(pi/3 {shift:+} pi) = {}$", show(&l(&moved))),
            format!(
                "quadrature: {} (estimated)",
                quadrature(&zero, &moved).to_string_radix(10, Some(15))
            ),
            holds,
            "the mean of $-ln|cos|$ is $mu_1 = ln 2$; compared at the test points".to_owned(),
        );
    }
    rows.push(series_row(reader));
    let double = l(&Rational::from(2));
    let printed = balls.mul_i64(&balls.mul(&balls.pi(), &balls.ln_2()), 2);
    let direct = quadrature(&zero, &Rational::from(2));
    rows.push(Row::new(
        "$L(2 pi)$",
        "$L(2 pi) = 2 pi ln 2$",
        format!("$L(2 pi) = {}$", show(&double)),
        format!("quadrature: {} (estimated)", direct.to_string_radix(10, Some(15))),
        &Findings::holds(double.overlaps(&printed) && near(&printed, &direct)),
        "twice the pseudoperiod, by the printed properties",
    ));
    Ok(rows)
}

/// L(x) - x ln 2 = Lambda_1(x): harmonic by harmonic, exactly.
fn series_row(reader: &Reader<'_>) -> Row {
    let ring = PolynomialRing::default();
    let exact = lambda_harmonics(&ring, 1, 2 * HARMONICS);
    let printed = |k: u32| {
        let sign = if k % 2 == 1 { -1 } else { 1 };
        Rational::from((sign, 2 * i64::from(k) * i64::from(k)))
    };
    let agrees = |k: u32| {
        let even = exact.get(2 * k as usize).and_then(|c| ring.as_rational(c));
        let odd = exact.get(2 * k as usize - 1).and_then(|c| ring.as_rational(c));
        even == Some(printed(k)) && odd == Some(Rational::new())
    };
    let holds = (1..=HARMONICS).all(agrees);
    // At pi/4 the printed series alternates: sum_{k odd} (-1)^((k-1)/2)/k^2, error below the
    // first term left out.
    let balls = reader.balls;
    let mut sum = Rational::new();
    for j in 0..HARMONICS {
        let k = 2 * i64::from(j) + 1;
        sum += Rational::from((if j % 2 == 0 { -1 } else { 1 }, 2 * k * k));
    }
    let quarter = Rational::from((1, 4));
    let linear = balls.mul_rational(&balls.mul(&balls.pi(), &balls.ln_2()), &quarter);
    let next = 2 * i64::from(HARMONICS) + 1;
    let bound =
        Float::with_val_round(53, Rational::from((1, 2 * next * next)), rug::float::Round::Up).0;
    let partial = balls.add_error(&balls.add(&linear, &balls.from_rational(&sum)), &bound);
    let value = lobachevsky(&Point::PiTimes(quarter), balls);
    let show = |ball: &Ball, digits| decimal(ball, digits).unwrap_or_else(|| "?".to_owned());
    let first = exact.get(2).map_or("?".to_owned(), |c| ring.print(c, Style::Text));
    Row::new(
        "$L$ series",
        "$L(x) = x ln 2 - 1/2 sum_{k>=1} (-1)^(k-1) sin(2kx)/k^2$",
        format!("$L(x) - x ln 2 = Lambda_1(x)$, first harmonic ${first}*sin(2x)$"),
        format!(
            "$L(pi/4) = {}$; {HARMONICS} terms of the series give {}",
            show(&value, 15),
            show(&partial, 4)
        ),
        &Findings::holds(holds && partial.overlaps(&value)),
        format!(
            "{HARMONICS} Fourier coefficients of $Lambda_1$ compared, exactly (the series converges \
             like $1/k^2$ and serves for no more than a few digits)"
        ),
    )
}

/// Whether an estimate agrees with a ball to 25 digits.
fn near(ball: &Ball, estimate: &Float) -> bool {
    let distance = Float::with_val(200, ball.midpoint() - estimate).abs();
    distance < 1e-25
}
