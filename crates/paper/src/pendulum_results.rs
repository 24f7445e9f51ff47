//! The results of the pendulum, alpha_1 and (51), in the symbols that the paper prints.

use super::compare::{Term, compare_sums};
use super::orders::Case;
use super::pendulum_numbers::fifty_one;
use super::tables::{QUANTITIES, Truncations};
use super::{Row, periods, show};
use lindstedt::unstable::derivation::energy;
use lindstedt_algebra::{RationalAlgebra, Ring};
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

pub(super) fn rows(case: &Case, balls: Balls) -> Option<Vec<Row>> {
    let ring = results();
    let product = |list: &[(Symbol, i16)]| {
        list.iter().fold(ring.one(), |p, (s, e)| ring.mul(&p, &ring.power(*s, *e)))
    };
    let ratio = [(OMEGA_1, 2), (OMEGA, -2)];
    let ratio_log = product(&[ratio[0], ratio[1], (Symbol::LogTwo, 1)]);
    let words = [
        Term::new(1, "(omega_1/omega)^2", product(&ratio)),
        Term::new(1, "(omega_1/omega)^2 ln 2", ratio_log.clone()),
        Term::new(1, "(omega_1/omega)^2 pi ln 2", ring.mul(&ratio_log, &ring.symbol(Symbol::Pi))),
        Term::new(
            1,
            "(omega_1/omega)^2 (ln 2)/pi",
            ring.mul(&ratio_log, &ring.power(Symbol::Pi, -1)),
        ),
        Term::new(1, "1/omega", product(&[(OMEGA, -1)])),
    ];
    let alpha = in_printed_symbols(case.expansion.frequency_squared.get(1)?)?;
    let printed = [Term::new(-2, "(omega_1/omega)^2 ln 2", ratio_log.clone())];
    let findings = compare_sums(&ring, &printed, &alpha, &words);
    // The second route: the period of the energy integral, t_1 = -alpha_1/2.
    let engine = &case.derivation.ring;
    let sums = [0, 1].map(|n| engine.symbol(Symbol::Sum(n)));
    let period = energy::period_over_2pi(engine, &sums, 1)?;
    let first = in_printed_symbols(period.get(1)?)?;
    let consistent = ring.scale(&first, &Rational::from(-2)) == alpha;
    if !consistent {
        return None;
    }
    let number = case.constants.evaluate(case.expansion.frequency_squared.get(1)?, balls)?;
    let mut rows = vec![Row::new(
        "$alpha_1$, pendulum",
        "$alpha_1 = -2 (omega_1/omega)^2 ln 2$",
        format!("$alpha_1 = {} = {}$", ring.print(&alpha, Style::Text), show(&number, 12)),
        "$-2 t_1$ of the energy integral, without $x(t)$, is the same polynomial",
        &findings,
        "the resonant part is the mean of $2 cos^2 ln(cos^2)$, $1 - 2 ln 2$, not $-2 ln 2$",
    )];
    // (51): T/(2 pi), with the factor 1/omega that the derived one has.
    let inverse = product(&[(OMEGA, -1)]);
    let derived = ring.mul(&inverse, &ring.add(&ring.one(), &first));
    let printed = [
        Term::new(1, "1", ring.one()),
        Term::new(
            -1,
            "(omega_1/omega)^2 (ln 2)/pi",
            ring.mul(&ratio_log, &ring.power(Symbol::Pi, -1)),
        ),
    ];
    let findings = compare_sums(&ring, &printed, &derived, &words);
    let exact = periods::pendulum_period(&Rational::from(1), balls)?;
    let ours = Truncations::pendulum(1, balls)?.period(QUANTITIES[0], 1, &Rational::from(1))?;
    let as_printed = fifty_one(balls)?;
    rows.push(Row::new(
        "(51)",
        "$T = 2 pi [1 - (omega_1/omega)^2 (ln 2)/pi]$",
        format!("$T = 2 pi [{}] = {}$", ring.print(&derived, Style::Text), show(&ours, 8)),
        format!("exact {} (AGM)", show(&exact, 12)),
        &findings,
        format!(
            "the factor $1/omega$ is missing and the bracket is another; as printed $T = {}$",
            show(&as_printed, 6)
        ),
    ));
    Some(rows)
}
