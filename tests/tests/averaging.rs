//! Averaging (Krylov, Bogoliubov, Mitropolsky) against published coefficients, the expansion at
//! fixed amplitude, characteristic roots and Hopf's bifurcation.

use lindstedt::algebra::{Rationals, Ring};
use lindstedt::coeff::amplitude::{AmplitudePolynomial, AmplitudePolynomials};
use lindstedt::coeff::print::{Print, Style};
use lindstedt::equation::{Expression, Function};
use lindstedt::expand::{AveragedExpansion, Binding, average, check_averaged, compile};
use lindstedt::phase::Torus;
use rug::Rational;

struct Nothing;

impl Binding<AmplitudePolynomials<Rationals>> for Nothing {
    fn parameter(&self, _: &str) -> Option<AmplitudePolynomial<Rational>> {
        None
    }
    fn formal(&self, _: &str, _: usize) -> Option<AmplitudePolynomial<Rational>> {
        None
    }
}

fn derive(
    algebra: &Torus<Rationals>,
    equation: &Expression,
    order: usize,
) -> AveragedExpansion<Torus<Rationals>> {
    let graph = compile(algebra, equation, &Nothing, order).unwrap();
    let expansion = average(algebra, &graph, order, &mut |_| true).unwrap();
    assert_eq!(check_averaged(algebra, &graph, &expansion), Ok(order));
    expansion
}

fn plain() -> Torus<Rationals> {
    Torus::new(Rationals, Rational::from(1), None, Vec::new())
}

fn shown(list: &[AmplitudePolynomial<Rational>]) -> Vec<String> {
    let ring = AmplitudePolynomials::new(Rationals);
    list.iter().map(|c| ring.print(c, Style::Text)).collect()
}

fn van_der_pol() -> Expression {
    let x = Expression::Displacement;
    let gain = 1 - x.clone().pow(2);
    Expression::Acceleration + x - Expression::Small * gain * Expression::Velocity
}

/// classics: A_1, B_2, A_3, B_4 (checked independently there); the others vanish by symmetry.
#[test]
fn van_der_pol_rates() {
    let result = derive(&plain(), &van_der_pol(), 8);
    let (a, b) = (shown(&result.amplitude_rate), shown(&result.phase_rate));
    assert_eq!(a[1], "1/2*a - 1/8*a^3");
    assert_eq!(b[2], "-1/8 + 1/8*a^2 - 7/256*a^4");
    assert_eq!(a[3], "-1/16*a^3 + 35/1024*a^5 - 37/8192*a^7");
    assert_eq!(b[4], "-1/128 - 1/64*a^2 + 85/4096*a^4 - 211/32768*a^6 + 497/786432*a^8");
    for n in [2, 4, 6, 8] {
        assert_eq!((a[n].as_str(), b[n - 1].as_str()), ("0", "0"), "order {n}");
    }
}

#[test]
fn forced_duffing_first_order() {
    let x = Expression::Displacement;
    let t = Expression::Time;
    let ratio = Expression::Number(Rational::from((2, 7)));
    let force = (t * ratio).apply(Function::Cos);
    let equation = Expression::Acceleration + x.clone() + Expression::Small * x.pow(3)
        - Expression::integer(2) * force;
    let algebra =
        Torus::new(Rationals, Rational::from(1), Some(Rational::from((2, 7))), Vec::new());
    let result = derive(&algebra, &equation, 3);
    // p = 2/(1 - 4/49) = 98/45: B_1 = 3/8 a^2 + 3/4 p^2.
    let expected = Rational::from((3, 4)) * Rational::from((9604, 2025));
    assert_eq!(shown(&result.phase_rate)[1], format!("{expected} + 3/8*a^2"));
    assert!(algebra.is_zero(&algebra.zero()));
}
