//! One clock against the driver, and its judges against wrong expansions.

use lindstedt_algebra::{ClockAlgebra, PhaseAlgebra, RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_coeff::{Polynomial, PolynomialRing, Symbol};
use lindstedt_equation::{Condition, Expression};
use lindstedt_expand::{
    Binding, ClockExpansion, ClockMean, Equation, ExpandError, Request, check_clock,
    clock_variable, compile, expand, expand_clock,
};
use lindstedt_phase::Lobachevsky;
use lindstedt_phase::lobachevsky::{Unfolding, Word};
use rug::Rational;

type Still = Lobachevsky<PolynomialRing>;

/// Formal functions have the Taylor coefficients S_n.
struct Sums;

fn sum(n: usize) -> Polynomial {
    PolynomialRing::default().symbol(Symbol::Sum(n as u16))
}

impl Binding<PolynomialRing> for Sums {
    fn parameter(&self, _: &str) -> Option<Polynomial> {
        None
    }
    fn formal(&self, _: &str, n: usize) -> Option<Polynomial> {
        Some(sum(n))
    }
}

fn x() -> Expression {
    Expression::DISPLACEMENT
}

fn power_law() -> Expression {
    Expression::ACCELERATION + x() * x().pow(2).pow(Expression::Small)
}

fn formal() -> Expression {
    Expression::ACCELERATION + x() * (Expression::Small * x().pow(2).ln()).formal("S")
}

fn request(order: usize) -> Request {
    let condition = Condition::InitialAmplitude;
    Request { condition, order, leading_amplitude: Rational::from(1) }
}

struct Case {
    algebra: Still,
    equation: Equation<Still>,
    clock: ClockExpansion<Still>,
}

fn still(equation: &Expression, order: usize) -> Result<Case, ExpandError> {
    let algebra = Lobachevsky::formal(PolynomialRing::default());
    let equation = compile(&algebra, equation, &Sums, order)?;
    let clock = expand_clock(&algebra, &equation, &request(order), &mut |_| true)?;
    Ok(Case { algebra, equation, clock })
}

#[test]
fn every_order_is_that_of_the_driver() {
    let exponential = Expression::ACCELERATION
        + x()
        + Expression::Small * (x() * x().pow(2).ln() + x().pow(3) * x().pow(2).ln());
    for (equation, order) in [(power_law(), 8), (formal(), 6), (exponential, 5)] {
        let (ring, stop) = (PolynomialRing::default(), Stop::default());
        let algebra = Lobachevsky::new(ring.clone());
        let compiled = compile(&algebra, &equation, &Sums, order).unwrap();
        let driver = expand(&algebra, &compiled, &request(order), &mut |_| true).unwrap();
        let Case { algebra, equation, clock } = still(&equation, order).unwrap();
        assert_eq!(check_clock(&algebra, &equation, &clock), Ok(order));
        let (numbers, p) = (&clock.numbers, &clock.still.solution);
        let parts = Unfolding::new(&ring, numbers, None, p, &stop).unwrap();
        for (n, expected) in driver.solution.iter().enumerate() {
            let function = parts.function(n, &ring, &Clone::clone, &stop).unwrap();
            assert_eq!(function, *expected, "order {n}");
        }
    }
}

#[test]
fn the_power_law_is_cos_to_the_power_one_minus_u() {
    // p = cos e^(u l), c_m = u^m and nu = 1 + delta with u = delta/(1 + delta): u^m = sum_n (-1)^(n-m)
    // binomial(n - 1, m - 1) delta^n.
    let order = 12;
    let Case { algebra, clock, .. } = still(&power_law(), order).unwrap();
    let ring = PolynomialRing::default();
    for n in 1..=order {
        let numbers: Vec<Polynomial> = (1..=n)
            .map(|m| {
                let sign = if (n - m) % 2 == 0 { 1 } else { -1 };
                let ways = rug::Integer::binomial_u(n as u32 - 1, m as u32 - 1);
                ring.rational(&(Rational::from(rug::Integer::from(ways)) * sign))
            })
            .collect();
        assert_eq!(clock.numbers[n], numbers);
        let p = algebra.mul(&algebra.cosine(), &algebra.pace(&numbers));
        assert_eq!(clock.still.solution[n], p);
        let pace = if n == 1 { ring.one() } else { ring.zero() };
        assert_eq!(clock.still.frequency_squared[n], pace);
    }
}

#[test]
fn the_work_is_that_of_still_functions() {
    for (equation, factor) in [(power_law(), 4), (formal(), 8)] {
        let work = still(&equation, 10).unwrap().clock.still.work;
        for of_order in work {
            // n terms, and O(n) products per node of the equation (a formal function has n + 2 nodes).
            let n = of_order.order;
            assert_eq!(of_order.terms, n);
            let nodes = if factor == 4 { 1 } else { n };
            let most = factor * (n * nodes) as u64;
            assert!(of_order.products <= most, "order {n}: {} products", of_order.products);
        }
    }
}

#[test]
fn other_equations_are_refused() {
    let damped = power_law() + Expression::Small * Expression::VELOCITY;
    assert_eq!(still(&damped, 2).err(), Some(ExpandError::NotOneClock { order: 0 }));
    let algebra = Lobachevsky::formal(PolynomialRing::default());
    let compiled = compile(&algebra, &power_law(), &Sums, 2).unwrap();
    let harmonic = Request { condition: Condition::FundamentalAmplitude, ..request(2) };
    let refused = expand_clock(&algebra, &compiled, &harmonic, &mut |_| true);
    assert_eq!(refused.err(), Some(ExpandError::NotOneClock { order: 0 }));
    // sec and l/cos have no integral in the ring.
    let singular = Expression::ACCELERATION + x() + Expression::Small * x().pow(2).ln();
    assert!(matches!(still(&singular, 2), Err(ExpandError::Phase { .. })));
}

#[test]
fn a_wrong_still_part_is_found() {
    let Case { algebra, equation, clock } = still(&formal(), 5).unwrap();
    let order = |wrong: &ClockExpansion<Still>| match check_clock(&algebra, &equation, wrong) {
        Ok(_) => None,
        Err(ExpandError::Residual { order } | ExpandError::Normalisation { order }) => Some(order),
        Err(ExpandError::NotOneClock { .. }) => Some(usize::MAX),
        Err(other) => panic!("{other}"),
    };
    let one = PolynomialRing::default().one();
    for n in 1..=5 {
        let mut wrong = clock.clone();
        let log = algebra.term(1, false, Word::log(1), one.clone());
        algebra.add_assign(&mut wrong.still.solution[n], &log);
        assert_eq!(order(&wrong), Some(n));
        let mut wrong = clock.clone();
        wrong.numbers[n][n - 1] = one.clone();
        assert_eq!(order(&wrong), Some(n));
        let mut wrong = clock.clone();
        wrong.still.frequency_squared[n] = one.clone();
        assert_eq!(order(&wrong), Some(n));
        let mut wrong = clock.clone();
        wrong.still.solution[n] = algebra.add(&algebra.sine(), &wrong.still.solution[n]);
        assert_eq!(order(&wrong), Some(n));
        let mut wrong = clock.clone();
        algebra.add_assign(&mut wrong.still.solution[n], &algebra.lambda(1));
        assert_eq!(order(&wrong), Some(usize::MAX));
        let mut wrong = clock.clone();
        let certificate = wrong.still.certificates.iter_mut().find(|list| list.len() > n).unwrap();
        algebra.add_assign(&mut certificate[n], &algebra.one());
        assert!(order(&wrong).is_some_and(|found| found <= n));
    }
    let mut wrong = clock.clone();
    wrong.numbers[0] = vec![one];
    assert_eq!(order(&wrong), Some(usize::MAX));
}

#[test]
fn the_frequency_of_a_mean() {
    let q = |n: i32, d: i32| Rational::from((n, d));
    let series = |c: i32| vec![q(1, 1), q(c, 3), q(c, 1), q(-c, 7)];
    let mean = ClockMean::new(&Rationals, series(5)).unwrap();
    let frequency = mean.frequency(&Rationals, &series(2)).unwrap();
    assert_eq!(frequency.squared[1], q(2 - 10, 3));
    assert_eq!(frequency.first[1], q(1 - 5, 3));
    assert_eq!(frequency.period[1], q(5 - 1, 3));
    let zero = vec![Rational::new(); 3];
    assert!(ClockMean::new(&Rationals, zero.clone()).is_err());
    assert!(mean.frequency(&Rationals, &zero).is_err());
}

/// The parts, in powers of eps or of the one number that all c_m are powers of.
#[test]
fn wrong_parts_are_found() {
    for (equation, order) in [(power_law(), 6), (formal(), 5)] {
        let Case { algebra, clock, .. } = still(&equation, order).unwrap();
        let (ring, stop) = (PolynomialRing::default(), Stop::default());
        let (numbers, p) = (&clock.numbers, &clock.still.solution);
        let rational = |list: &Vec<Polynomial>| list.iter().map(|c| ring.as_rational(c)).collect();
        let rational: Option<Vec<Vec<Rational>>> = numbers.iter().map(rational).collect();
        let variable = rational.and_then(|numbers| clock_variable(&numbers));
        assert_eq!(variable.is_some(), equation == power_law());
        let of = |variable: Option<&[Rational]>, numbers: &[_], p: &[_]| {
            Unfolding::new(&ring, numbers, variable, p, &stop).unwrap()
        };
        let direct = of(None, numbers, p);
        for variable in [None, variable.as_deref()] {
            let parts = of(variable, numbers, p);
            assert_eq!(parts.judge(&algebra, numbers, p), Some(Ok(())));
            for n in 0..=order {
                let function =
                    |parts: &Unfolding<_>| parts.function(n, &ring, &Clone::clone, &stop);
                assert_eq!(function(&parts), function(&direct));
            }
            let parts_of = |n: usize| {
                let mut other = p.clone();
                let log = algebra.term(1, false, Word::log(1), ring.one());
                algebra.add_assign(&mut other[n], &log);
                let mut faster = numbers.clone();
                faster[n][0] = ring.add(&faster[n][0], &ring.one());
                (other, faster)
            };
            for n in 1..=order {
                let (other, faster) = parts_of(n);
                // Of another still part, and of another clock.
                assert_eq!(of(variable, numbers, &other).judge(&algebra, numbers, p), Some(Err(n)));
                assert_eq!(parts.judge(&algebra, &faster, p), Some(Err(n)));
            }
            assert_eq!(parts.judge(&algebra, numbers, &p[1..]), Some(Err(0)));
        }
    }
}

#[test]
fn a_clock_with_one_number_is_recognised() {
    let q = |n: i32| Rational::from(n);
    // c = eps - eps^2 + eps^3, c^2 = eps^2 - 2 eps^3, c^3 = eps^3.
    let numbers = vec![vec![], vec![q(1)], vec![q(-1), q(1)], vec![q(1), q(-2), q(1)]];
    assert_eq!(clock_variable(&numbers), Some(vec![q(0), q(1), q(-1), q(1)]));
    for (n, m) in [(2, 1), (3, 1), (3, 2)] {
        let mut other = numbers.clone();
        other[n][m] += 1;
        assert_eq!(clock_variable(&other), None);
    }
    assert_eq!(clock_variable(&[]), None);
}
