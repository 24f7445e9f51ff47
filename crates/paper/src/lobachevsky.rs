//! The Lobachevsky function of the text below (41).

use super::{Findings, Reader, Row, periods, plain, show};
use lindstedt_algebra::RationalAlgebra;
use lindstedt_coeff::PolynomialRing;
use lindstedt_coeff::print::{Print, Style};
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::fourier::lambda_harmonics;
use lindstedt_phase::lobachevsky_function::{Point, lobachevsky};
use rug::{Float, Rational};

/// Harmonics of the printed series that are compared, exactly.
const HARMONICS: u32 = 200;

/// Where properties of L are tested, in units of pi.
const POINTS: [(i32, u32); 5] = [(1, 8), THIRD, (2, 7), (9, 20), (-3, 11)];

/// Where its value is shown.
const THIRD: (i32, u32) = (1, 3);

/// The rows from the definition of L to L(2 pi).
pub(super) fn rows(reader: &Reader<'_>) -> Vec<Row> {
    let points = POINTS.iter().map(|p| Rational::from(*p)).collect();
    let routes = Routes { balls: reader.balls, points };
    vec![
        routes.definition(),
        routes.odd(),
        routes.shifted("$L(x - pi)$", "$L(x - pi) = L(x) - pi ln 2$", -1),
        routes.shifted("$L(x + pi)$", "$L(x + pi) = L(x) + pi ln 2$", 1),
        series_row(reader),
        routes.twice_the_pseudoperiod(),
    ]
}

/// L by the series of the program and by quadrature of its definition; arguments in units of pi.
struct Routes {
    balls: Balls,
    points: Vec<Rational>,
}

impl Routes {
    fn series(&self, q: &Rational) -> Ball {
        lobachevsky(&Point::PiTimes(q.clone()), self.balls)
    }

    fn quadrature(q: &Rational) -> Float {
        let pi_times = |q: &Rational| Float::with_val(200, rug::float::Constant::Pi) * q;
        periods::integral_of_log_secant(&pi_times(&Rational::new()), &pi_times(q))
    }

    /// The quadrature in words.
    fn quadrature_text(q: &Rational) -> String {
        format!("quadrature: {} (estimated)", Self::quadrature(q).to_string_radix(10, Some(15)))
    }

    /// n pi ln 2.
    fn pseudoperiods(&self, n: i64) -> Ball {
        let balls = self.balls;
        balls.mul_i64(&balls.mul(&balls.pi(), &balls.ln_2()), n)
    }

    /// The definition, against the integral itself.
    fn definition(&self) -> Row {
        let third = Rational::from(THIRD);
        plain(
            "$L$",
            "$L(x) = -int_0^x ln|cos t| dt$",
            format!("$L(pi/3) = {}$", show(&self.series(&third), 15)),
            Self::quadrature_text(&third),
            self.points.iter().all(|q| near(&self.series(q), &Self::quadrature(q))),
            &format!(
                "the series of the program and the integral agree to 25 digits at {} points",
                self.points.len()
            ),
        )
    }

    fn odd(&self) -> Row {
        let is_odd = |q: &Rational| {
            let (mirrored, negative) = (Rational::from(-q), self.balls.neg(&self.series(q)));
            self.series(q).overlaps(&self.balls.neg(&self.series(&mirrored)))
                && near(&negative, &Self::quadrature(&mirrored))
        };
        plain(
            "$L$ odd",
            "$L(x) = -L(-x)$ for $-pi/2 <= x <= pi/2$",
            "$L$ is odd on the whole line",
            "quadrature from 0 to $-x$",
            self.points.iter().all(is_odd),
            "the integrand is even; compared at the test points",
        )
    }

    fn shifted(&self, label: &str, printed: &str, shift: i32) -> Row {
        let step = self.pseudoperiods(shift.into());
        let holds = self.points.iter().all(|q| {
            let moved = Rational::from(q + shift);
            let expected = self.balls.add(&self.series(q), &step);
            self.series(&moved).overlaps(&expected) && near(&expected, &Self::quadrature(&moved))
        });
        let moved = Rational::from(THIRD) + shift;
        plain(
            label,
            printed,
            format!("$L(pi/3 {shift:+} pi) = {}$", show(&self.series(&moved), 15)),
            Self::quadrature_text(&moved),
            holds,
            "the mean of $-ln|cos|$ is $mu_1 = ln 2$; compared at the test points",
        )
    }

    fn twice_the_pseudoperiod(&self) -> Row {
        let two = Rational::from(2);
        let (series, printed) = (self.series(&two), self.pseudoperiods(2));
        plain(
            "$L(2 pi)$",
            "$L(2 pi) = 2 pi ln 2$",
            format!("$L(2 pi) = {}$", show(&series, 15)),
            Self::quadrature_text(&two),
            series.overlaps(&printed) && near(&printed, &Self::quadrature(&two)),
            "twice the pseudoperiod, by the printed properties",
        )
    }
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
