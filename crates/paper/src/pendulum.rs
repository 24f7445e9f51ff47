//! (43)-(51): the pendulum.

use super::compare::{Term, compare_sums, word};
use super::orders::{Case, Element};
use super::pendulum_numbers;
use super::pendulum_results::{self, OMEGA_1, in_printed_symbols, results};
use super::power_law::vocabulary;
use super::{Findings, Reader, Row, Section, periods, plain, show};
use lindstedt::Error;
use lindstedt::unstable::derivation::constants::sine_sum;
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_number::ball::{Ball, Balls};
use rug::{Integer, Rational};

/// Terms of the sine series: 1/121! is below 10^-200.
const TERMS: u32 = 60;

/// Reads (43) to (51) and the numbers below.
pub(super) fn read(reader: &mut Reader<'_>, section: &mut Section) -> Result<bool, Error> {
    let Some(case) = Case::derive("pendulum", reader)? else { return Ok(false) };
    let balls = reader.balls;
    section.rows.extend(equation_rows(&case, balls).ok_or(Error::NoValue)?);
    section.rows.extend(order_rows(&case)?);
    section.rows.extend(pendulum_results::rows(&case, balls).ok_or(Error::NoValue)?);
    section.rows.extend(pendulum_numbers::rows(balls).ok_or(Error::NoValue)?);
    Ok(true)
}

/// (-1)^k/(2k + 1)!.
fn sine_coefficient(k: u32) -> Rational {
    let sign = if k.is_multiple_of(2) { 1 } else { -1 };
    Rational::from((Integer::from(sign), Integer::from(Integer::factorial(2 * k + 1))))
}

/// sum_k (-1)^k x^(1 + 2 k delta)/(2k + 1)!, for x > 0.
fn force(x: &Ball, delta: &Ball, balls: Balls) -> Option<Ball> {
    let log = balls.ln(x)?;
    let mut sum = balls.zero();
    for k in 0..=TERMS {
        let exponent = balls.mul(&balls.mul_i64(delta, 2 * i64::from(k)), &log);
        let power = balls.mul(x, &balls.exp(&exponent));
        sum = balls.add(&sum, &balls.mul_rational(&power, &sine_coefficient(k)));
    }
    Some(sum)
}

fn equation_rows(case: &Case, balls: Balls) -> Option<Vec<Row>> {
    let mut rows = vec![period_row(balls)?, power_series_row(balls)?];
    rows.extend(stiffness_rows(case, balls)?);
    rows.push(omega_row(balls)?);
    for sum in PRINTED_SUMS {
        rows.push(sum.row(balls)?);
    }
    Some(rows)
}

fn period_row(balls: Balls) -> Option<Row> {
    let one = Rational::from(1);
    let mean = periods::pendulum_period(&one, balls)?;
    let series = periods::pendulum_period_by_series(&one, balls)?;
    Some(plain(
        "(43)",
        "$x'' + sin x = 0$",
        format!("period at amplitude 1: {} by the AGM", show(&mean, 16)),
        format!("{} by the hypergeometric series", show(&series, 16)),
        mean.overlaps(&series),
        "two closed forms of the period enclose the same number",
    ))
}

/// Where the sum of (44) is compared with the force: x = 7/5.
const AT: (i32, i32) = (7, 5);

fn power_series_row(balls: Balls) -> Option<Row> {
    // The coefficients printed, and the recurrence c_{k+1} = -c_k/((2k+2)(2k+3)) of sin'' = -sin.
    let printed = [Rational::from(1), Rational::from((-1, 6)), Rational::from((1, 120))];
    let mut derived = vec![Rational::from(1)];
    for k in 0..2i64 {
        let last = derived.last()?;
        derived.push(last * Rational::from((-1, (2 * k + 2) * (2 * k + 3))));
    }
    let x = balls.from_rational(&Rational::from(AT));
    let (at_one, sine) = (force(&x, &balls.one(), balls)?, balls.sin(&x));
    Some(plain(
        "(44)",
        "$x'' + x - x^(1+2 delta)/3! + x^(1+4 delta)/5! + ... = 0$",
        "$x'' + x S(delta ln x^2) = 0$, $S(z) = sum_k (-1)^k e^(k z)/(2k+1)!$",
        format!(
            "at $delta = 1$, $x = 7/5$: {}, $sin(7/5) = {}$",
            show(&at_one, 15),
            show(&sine, 15)
        ),
        printed.as_slice() == derived.as_slice() && near(&at_one, &sine, balls),
        "the factors of the powers, exactly, and the sum at $delta = 1$ (the signs printed alternate)",
    ))
}

/// Whether two numbers agree to 60 digits.
fn near(a: &Ball, b: &Ball, balls: Balls) -> bool {
    balls.sub(a, b).abs_upper() < 1e-60
}

/// Omega(x, 0) and omega^2.
fn stiffness_rows(case: &Case, balls: Balls) -> Option<[Row; 2]> {
    let sine = balls.sin(&balls.one());
    let stiffness = case.constants.evaluate(&case.expansion.stiffness, balls)?;
    let x = balls.from_rational(&Rational::from(AT));
    let zero = force(&x, &balls.zero(), balls)?;
    let same = stiffness.overlaps(&sine);
    let [shown, shown_sine] = [&stiffness, &sine].map(|ball| show(ball, 15));
    Some([
        plain(
            "$Omega(x,0)$",
            "$Omega(x, 0) = x (1 - 1/3! + 1/5! - ...) = x sin 1$",
            format!("$kappa = S_0 = {shown}$"),
            format!("$sin 1 = {shown_sine}$"),
            same && near(&zero, &balls.mul(&x, &sine), balls),
            "the stiffness that the engine finds at order zero, and the sum at $delta = 0$",
        ),
        plain(
            "$omega^2$",
            "$omega^2 = sin 1$",
            format!("$omega^2 = S_0 = {shown}$ at order zero"),
            format!("$sin 1 = {shown_sine}$"),
            same,
            "the series of the program for $S_0$ and MPFR's sine",
        ),
    ])
}

/// A sum that is printed term by term, with its closed form.
struct PrintedSum {
    order: u16,
    label: &'static str,
    printed: &'static str,
    symbol: &'static str,
    form: &'static str,
    closed: fn(Balls) -> Ball,
}

/// omega_1^2 = sum (-1)^(k+1) k/(2k+1)!, omega_2^2 half of that with k^2, as printed.
const PRINTED_SUMS: [PrintedSum; 2] = [
    PrintedSum {
        order: 1,
        label: "$omega_1^2$",
        printed: "$omega_1^2 = 1/3! - 2/5! + 3/7! - 4/9! + ...$",
        symbol: "-S_1",
        form: "(sin 1 - cos 1)/2",
        closed: |balls| {
            let one = balls.one();
            balls.mul_power_of_two(&balls.sub(&balls.sin(&one), &balls.cos(&one)), -1)
        },
    },
    PrintedSum {
        order: 2,
        label: "$omega_2^2$",
        printed: "$omega_2^2 = 0.5 (1/3! - 2^2/5! + 3^2/7! - ...)$",
        symbol: "-S_2/2",
        form: "(cos 1)/8",
        closed: |balls| balls.mul_power_of_two(&balls.cos(&balls.one()), -3),
    },
];

impl PrintedSum {
    fn row(&self, balls: Balls) -> Option<Row> {
        let Self { order, symbol, form, .. } = self;
        let closed = (self.closed)(balls);
        let mut sum = Rational::new();
        for k in 1..=TERMS {
            sum -= sine_coefficient(k) * Rational::from(k.pow((*order).into()));
        }
        sum /= *order;
        let sum = balls.from_rational(&sum);
        let series = sine_sum(*order, &balls.one(), balls, &Stop::default())?;
        let ours = balls.neg(&balls.div_i64(&series, (*order).into())?);
        Some(plain(
            self.label,
            self.printed,
            format!("${symbol} = {}$", show(&ours, 15)),
            format!("${form} = {}$", show(&closed, 15)),
            near(&ours, &sum, balls) && near(&closed, &sum, balls),
            &format!("the printed sum with {TERMS} terms"),
        ))
    }
}

/// The printed sign of omega_1^2 in Omega and in (47).
const SIGN_IN_OMEGA: i32 = 1;
const SIGN_IN_47: i32 = 1;

/// Omega/x in powers of delta ln(x^2): order by order against S_n/n!.
fn omega_row(balls: Balls) -> Option<Row> {
    let ring = results();
    let square = |symbol| ring.power(symbol, 2);
    // S_1 = -omega_1^2, S_2/2 = -omega_2^2 by the printed sums; the factor of order 2 is printed 1.
    let words = [Term::new(1, "omega_1^2", square(OMEGA_1)), Term::new(1, "1", ring.one())];
    let mut corrections = Vec::new();
    let mut holds = true;
    let mut derived = Vec::new();
    let engine = PolynomialRing::default();
    for (n, word) in (1u16..).zip(&words) {
        let coefficient = in_printed_symbols(&engine.symbol(Symbol::Sum(n)))?;
        let coefficient = ring.scale(&coefficient, &Rational::from((1, n)));
        let printed = [Term::new(SIGN_IN_OMEGA, &word.name, word.value.clone())];
        let shown = ring.print(&coefficient, Style::Text);
        if !compare_sums(&ring, &printed, &coefficient, &words).holds {
            holds = false;
            corrections.push(format!("${shown}$ in the place of ${}$ at order {n}", word.name));
        }
        derived.push(shown);
    }
    // x'' = -Omega: with the printed sign (47) would carry minus omega_1^2.
    let propagates = SIGN_IN_47 == -SIGN_IN_OMEGA;
    let x = balls.from_rational(&Rational::from((1, 2)));
    let log = balls.mul_i64(&balls.ln(&x)?, 2);
    let slope = periods::difference(1, balls, |d| force(&x, d, balls))?;
    let measured = balls.div(&slope, &balls.mul(&x, &log))?;
    let printed = balls.neg(&sine_sum(1, &balls.one(), balls, &Stop::default())?);
    let near = balls.add(&measured, &printed).abs_upper() < 1e-25;
    let correction = (!holds && near).then(|| corrections.join(", "));
    let findings = Findings { holds, correction, propagates, reproduced: None };
    Some(Row::new(
        "$Omega$",
        "$Omega = x [omega^2 + delta ln(x^2) omega_1^2 + delta^2 [ln(x^2)]^2 + ...]$",
        format!(
            "the factor of $delta ln(x^2)$ is ${}$, that of $delta^2 [ln(x^2)]^2$ is ${}$",
            derived.first()?,
            derived.get(1)?
        ),
        format!(
            "$dOmega/d(delta)/(x ln x^2)$ at $x = 1/2$, $delta = 0$, numerically: {} (estimated); $omega_1^2 = {}$",
            show(&measured, 12),
            show(&printed, 12)
        ),
        &findings,
        format!("{}; (47) and (49) carry the right signs", corrections.join(", ")),
    ))
}

/// The terms that can stand in an order equation, divided by omega^2 = S_0: omega_1^2/omega^2 =
/// -S_1/S_0 and so on.
fn divided_vocabulary(case: &Case) -> Vec<Term<Element>> {
    let ring = &case.derivation.ring;
    let inverse = ring.power(Symbol::Sum(0), -1);
    let over = |n: u16| ring.mul(&ring.symbol(Symbol::Sum(n)), &inverse);
    let factors = [
        ("omega_1^2", ring.neg(&over(1))),
        ("omega_2^2", ring.scale(&over(2), &Rational::from((-1, 2)))),
        ("omega^2", ring.one()),
    ];
    let words = vocabulary(case);
    let divided = |(name, factor): &(&str, Polynomial)| -> Vec<Term<Element>> {
        let term = |word: &Term<Element>| {
            Term::new(1, &format!("{name} {}", word.name), case.scaled(&word.value, factor))
        };
        words.iter().map(term).collect()
    };
    factors.iter().flat_map(divided).collect()
}

fn order_rows(case: &Case) -> Result<Vec<Row>, Error> {
    let words = divided_vocabulary(case);
    let first = [word(&words, SIGN_IN_47, "omega_1^2 x_0 (ln x_0)^2")?, case.inertia(1, 0)];
    let second = [
        word(&words, 1, "omega_1^2 x_1 ln(x_0^2)")?,
        word(&words, 1, "omega_2^2 x_0 [ln(x_0^2)]^2")?,
        case.inertia(2, 0),
        case.inertia(1, 1),
    ];
    let order_zero = case.algebra.add(&case.acceleration(0), case.x(0));
    let x_0 = case.derivation.print_solution(0, Style::Text);
    Ok(vec![
        plain(
            "(45)",
            "$x_0'' + omega^2 x_0 = 0$",
            format!("$x_0 = {x_0}$, $tau = omega t$"),
            case.residual_text(),
            case.algebra.is_zero(&order_zero),
            "$x_0'' + x_0$ vanishes identically in $tau$",
        ),
        case.initial_row("(46)", 0, "$x_0(0) = 1$, $x_0'(0) = 0$"),
        case.order_row(
            "(47)",
            (1, "$x_1'' + omega^2 x_1 = omega_1^2 x_0 ln(x_0)^2 - alpha_1 x_0''$"),
            &first,
            &words,
            &force,
        )?,
        case.initial_row("(48)", 1, "$x_1(0) = x_1'(0) = 0$"),
        case.order_row(
            "(49)",
            (2, "$x_2'' + omega^2 x_2 = omega_1^2 x_1 ln(x_0^2) + omega_2^2 x_0 [ln(x_0^2)]^2 - alpha_2 x_0'' - alpha_1 x_1''$"),
            &second,
            &words,
            &force,
        )?,
        case.initial_row("(50)", 2, "$x_2(0) = x_2'(0) = 0$"),
        plain(
            "$x_0$, pendulum",
            "$x_0 = cos omega t$",
            format!("$x_0 = {x_0}$, $tau = omega t$"),
            case.residual_text(),
            *case.x(0) == lindstedt_algebra::PhaseAlgebra::cosine(&case.algebra),
            "the solution of (45), (46)",
        ),
    ])
}
