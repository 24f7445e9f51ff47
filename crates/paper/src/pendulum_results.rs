//! The results of the pendulum, alpha_1 and (51), in the symbols that the paper prints.

use super::compare::{Term, compare_sums};
use super::orders::Case;
use super::pendulum_numbers::fifty_one;
use super::tables::{QUANTITIES, Truncations};
use super::{Row, periods, show};
use lindstedt::unstable::derivation::energy;
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_coeff::print::{Print, Style};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_number::ball::Balls;
use rug::Rational;

/// The printed symbols as formal parameters of the ring of results.
const OMEGA: Symbol = Symbol::Parameter(0);
pub(super) const OMEGA_1: Symbol = Symbol::Parameter(1);
pub(super) const OMEGA_2: Symbol = Symbol::Parameter(2);

/// Q[ln 2, pi] with the printed symbols.
pub(super) fn results() -> PolynomialRing {
    let names = ["omega", "omega_1", "omega_2"];
    PolynomialRing { parameters: names.map(str::to_owned).to_vec() }
}

/// A coefficient of the engine in the printed symbols: S_0 = omega^2, S_1 = -omega_1^2,
/// S_2 = -2 omega_2^2, mu_1 = ln 2.
pub(super) fn in_printed_symbols(p: &Polynomial) -> Option<Polynomial> {
    let ring = results();
    let known = |s: &Symbol| matches!(s, Symbol::Sum(0..=2) | Symbol::Moment(1));
    let symbols = p.terms().iter().flat_map(|(m, _)| m.factors());
    if !symbols.map(|(s, _)| s).all(known) {
        return None;
    }
    ring.substitute(&ring, p, |symbol| match symbol {
        Symbol::Sum(0) => ring.power(OMEGA, 2),
        Symbol::Sum(1) => ring.neg(&ring.power(OMEGA_1, 2)),
        Symbol::Sum(_) => ring.scale(&ring.power(OMEGA_2, 2), &Rational::from(-2)),
        _ => ring.symbol(Symbol::LogTwo),
    })
}

pub(super) fn rows(case: &Case, balls: Balls) -> Option<[Row; 2]> {
    // The second route: the period of the energy integral, t_1 = -alpha_1/2.
    let engine = &case.derivation.ring;
    let sums = [0, 1].map(|n| engine.symbol(Symbol::Sum(n)));
    let period = energy::period_over_2pi(engine, &sums, 1, &Stop::default())?;
    let first = in_printed_symbols(period.get(1)?)?;
    Some([correction_row(case, &first, balls)?, period_row(&first, balls)?])
}

fn product(ring: &PolynomialRing, list: &[(Symbol, i16)]) -> Polynomial {
    list.iter().fold(ring.one(), |p, (s, e)| ring.mul(&p, &ring.power(*s, *e)))
}

/// (omega_1/omega)^2 ln 2, and the same over pi.
const RATIO_LOG: [(Symbol, i16); 3] = [(OMEGA_1, 2), (OMEGA, -2), (Symbol::LogTwo, 1)];
const RATIO_LOG_OVER_PI: [(Symbol, i16); 4] =
    [RATIO_LOG[0], RATIO_LOG[1], RATIO_LOG[2], (Symbol::Pi, -1)];

/// The monomials that can stand in a result.
fn words(ring: &PolynomialRing) -> [Term<Polynomial>; 5] {
    let [ratio, frequency, log] = RATIO_LOG;
    let word = |name, list: &[_]| Term::new(1, name, product(ring, list));
    [
        word("(omega_1/omega)^2", &[ratio, frequency]),
        word("(omega_1/omega)^2 ln 2", &RATIO_LOG),
        word("(omega_1/omega)^2 pi ln 2", &[ratio, frequency, log, (Symbol::Pi, 1)]),
        word("(omega_1/omega)^2 (ln 2)/pi", &RATIO_LOG_OVER_PI),
        word("1/omega", &[(OMEGA, -1)]),
    ]
}

/// alpha_1; `first` is t_1 of the period.
fn correction_row(case: &Case, first: &Polynomial, balls: Balls) -> Option<Row> {
    let ring = results();
    let alpha = in_printed_symbols(case.expansion.frequency_squared.get(1)?)?;
    let printed = [Term::new(-2, "(omega_1/omega)^2 ln 2", product(&ring, &RATIO_LOG))];
    let findings = compare_sums(&ring, &printed, &alpha, &words(&ring));
    if ring.scale(first, &Rational::from(-2)) != alpha {
        return None;
    }
    let number = case.constants.evaluate(case.expansion.frequency_squared.get(1)?, balls)?;
    Some(Row::new(
        "$alpha_1$, pendulum",
        "$alpha_1 = -2 (omega_1/omega)^2 ln 2$",
        format!("$alpha_1 = {} = {}$", ring.print(&alpha, Style::Text), show(&number, 12)),
        "$-2 t_1$ of the energy integral, without $x(t)$, is the same polynomial",
        &findings,
        "the resonant part is the mean of $2 cos^2 ln(cos^2)$, $1 - 2 ln 2$, not $-2 ln 2$",
    ))
}

/// (51): T/(2 pi), with the factor 1/omega that the derived one has.
fn period_row(first: &Polynomial, balls: Balls) -> Option<Row> {
    let ring = results();
    let inverse = product(&ring, &[(OMEGA, -1)]);
    let derived = ring.mul(&inverse, &ring.add(&ring.one(), first));
    let over_pi = product(&ring, &RATIO_LOG_OVER_PI);
    let printed =
        [Term::new(1, "1", ring.one()), Term::new(-1, "(omega_1/omega)^2 (ln 2)/pi", over_pi)];
    let findings = compare_sums(&ring, &printed, &derived, &words(&ring));
    let one = Rational::from(1);
    let exact = periods::pendulum_period(&one, balls)?;
    let ours = Truncations::pendulum(1, balls)?.period(QUANTITIES[0], 1, &one)?;
    Some(Row::new(
        "(51)",
        "$T = 2 pi [1 - (omega_1/omega)^2 (ln 2)/pi]$",
        format!("$T = 2 pi [{}] = {}$", ring.print(&derived, Style::Text), show(&ours, 8)),
        format!("exact {} (AGM)", show(&exact, 12)),
        &findings,
        format!(
            "the factor $1/omega$ is missing and the bracket is another; as printed $T = {}$",
            show(&fifty_one(balls)?, 6)
        ),
    ))
}
