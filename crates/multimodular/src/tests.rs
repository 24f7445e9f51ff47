//! The proof finds what is broken; the route agrees with rational arithmetic for any polynomial equation.

use crate::image::{Group, Image, Job};
use crate::lift::Remaindering;
use crate::lifted::Lifted;
use crate::place::Place;
use crate::{Error, RationalAlgebraOfPhase, derive};
use lindstedt_algebra::{Rationals, Ring, Stop};
use lindstedt_equation::{Condition, Expression};
use lindstedt_expand::{
    Binding, ExpandError, Expansion, Known, OrderNumbers, OrderWork, Request, ResidualBound, check,
    check_from, compile, conservative_period, expand, extend, leading_amplitude,
};
use lindstedt_phase::modular::{LANES, PrimeFields};
use lindstedt_phase::{Modular, Trigonometric};
use rug::{Integer, Rational};

struct NoNames;

impl Binding<Rationals> for NoNames {
    fn parameter(&self, _: &str) -> Option<Rational> {
        None
    }
}

fn q(n: i32, d: u32) -> Expression {
    Expression::Number(Rational::from((n, d)))
}

fn x(n: i64) -> Expression {
    Expression::DISPLACEMENT.pow(n)
}

fn v(n: i64) -> Expression {
    Expression::VELOCITY.pow(n)
}

fn small(n: i64) -> Expression {
    Expression::Small.pow(n)
}

fn directly(
    equation: &Expression,
    condition: Condition,
    order: usize,
) -> Result<Expansion<RationalAlgebraOfPhase>, ExpandError> {
    let algebra = Trigonometric::new(Rationals);
    let compiled = compile(&algebra, equation, &NoNames, order)?;
    let leading_amplitude = leading_amplitude(&algebra, &compiled, condition)?;
    let request = Request { condition, order, leading_amplitude };
    let expansion = expand(&algebra, &compiled, &request, &mut |_| true)?;
    check(&algebra, &compiled, &expansion)?;
    Ok(expansion)
}

/// Odd and even forces, forces of several orders in eps, damping that makes a limit cycle, stiffness and
/// coefficients with large primes, a leading amplitude that is a fraction.
pub(crate) fn equations() -> Vec<(Expression, Vec<Condition>)> {
    let conservative = vec![Condition::InitialAmplitude, Condition::FundamentalAmplitude];
    let cycle = vec![Condition::LimitCycle];
    let start = || Expression::ACCELERATION + x(1);
    vec![
        (start() + small(1) * x(3), conservative.clone()),
        (start() + small(1) * x(2), conservative.clone()),
        (
            start() + small(1) * (q(1, 3) * x(2) + x(5)) + small(2) * q(-7, 10) * x(4),
            conservative.clone(),
        ),
        (
            Expression::ACCELERATION + q(2, 1009) * x(1) + small(1) * q(5, 1_000_003) * x(3),
            conservative.clone(),
        ),
        (start() + small(1) * x(1) * v(2), conservative),
        (start() + small(1) * (x(2) + q(-1, 1)) * v(1), cycle.clone()),
        (
            start() + small(1) * (q(9, 4) * x(2) + q(-1, 1) + x(1)) * v(1) + small(2) * x(2),
            cycle.clone(),
        ),
        (start() + small(1) * (q(4, 3) * v(3) + q(-49, 1) * v(1)) + small(3) * x(3), cycle),
    ]
}

#[test]
fn agrees_with_rational_arithmetic() {
    for (index, (equation, conditions)) in equations().into_iter().enumerate() {
        let equation = equation.canonical();
        for condition in conditions {
            for order in [0, 1, 2, 3, 9] {
                let stop = Stop::default();
                let found = derive(&equation, &|_| None, condition, order, &stop, &mut |_| true);
                match (found, directly(&equation, condition, order)) {
                    (Ok(found), Ok(direct)) => {
                        let found = found.expansion();
                        assert_eq!(
                            found.solution, direct.solution,
                            "{index} {condition:?} {order}"
                        );
                        assert_eq!(found.frequency_squared, direct.frequency_squared);
                        assert_eq!(found.amplitude, direct.amplitude);
                        assert_eq!(found.stiffness, direct.stiffness);
                    }
                    (Err(Error::Expand(a)), Err(b)) => assert_eq!(a, b, "{index}"),
                    (a, b) => panic!("{index} {condition:?} {order}: {a:?} {b:?}"),
                }
            }
        }
    }
}

const ORDER: usize = 6;

pub(crate) fn van_der_pol() -> Expression {
    let damping = small(1) * (x(2) + q(-1, 1)) * v(1);
    (Expression::ACCELERATION + x(1) + damping).canonical()
}

/// Some images of van der Pol's equation.
pub(crate) fn with_images(count: usize, test: impl Fn(&Job<'_>, Vec<Image>)) {
    with_groups(count.div_ceil(LANES / 2), |job, groups| {
        test(job, groups.into_iter().flat_map(|(_, group)| group).take(count).collect());
    });
}

/// Some of the images of eight primes each.
pub(crate) fn with_groups(count: usize, test: impl Fn(&Job<'_>, Vec<(PrimeFields, Group)>)) {
    groups_of_order(ORDER, count, test);
}

fn groups_of_order(order: usize, count: usize, test: impl Fn(&Job<'_>, Vec<(PrimeFields, Group)>)) {
    let (equation, stop) = (van_der_pol(), Stop::default());
    let request =
        Request { condition: Condition::LimitCycle, order, leading_amplitude: Rational::from(2) };
    let (points, roots) = Modular::points_for_degree(2 * order + 3);
    let stiffness = Rational::from(1);
    let job =
        Job { equation: &equation, binding: &|_| None, request, stiffness, points, stop: &stop };
    let fields = PrimeFields::with_roots_of_unity(roots).take(count);
    test(&job, fields.map(|field| (field, job.image(field, &[]).unwrap().unwrap())).collect());
}

pub(crate) fn places(image: &Image) -> Vec<(usize, Place)> {
    (0..=ORDER).flat_map(|n| image.places(n).iter().map(move |place| (n, *place))).collect()
}

/// One number of one image, changed modulo one of its two primes or modulo both.
pub(crate) fn broken(images: &Group, n: usize, place: Place, variant: usize) -> Group {
    let mut broken = images.clone();
    let image = &mut broken[variant % (LANES / 2)];
    let (ring, [p, q]) = (image.ring, image.ring.primes());
    let factor = [Integer::from(1), Integer::from(p), Integer::from(q)][variant % 3].clone();
    image.change(n, place, |value| ring.add(&value, &ring.integer(&factor)));
    broken
}

/// From order 16 on sums are formed ahead, from 72 on of more orders than are completed at once: the images still solve
/// the equation, which their substitution multiplies out.
#[test]
fn what_is_summed_ahead_is_the_same() {
    groups_of_order(110, 1, |job, groups| {
        let (fields, images) = &groups[0];
        let (algebra, equation) = job.over(*fields).unwrap();
        assert_eq!(job.check(&algebra, &equation, images, 0), Ok(()));
        let known = Known { solution: &[], squared: &[] };
        let expansion = extend(&algebra, &equation, &job.request, known, &mut |_| true).unwrap();
        // Of x x and x^2 x' every product is counted once, at its order: in two orders more there are three more.
        let products: Vec<u64> = expansion.work.iter().map(|work| work.products).collect();
        assert!(products[1..].windows(3).all(|list| list[2] == list[0] + 3), "{products:?}");
    });
}

/// Every single number of an image, changed modulo a prime: substitution refuses it.
#[test]
fn a_broken_image_is_refused() {
    with_groups(1, |job, groups| {
        let (fields, images) = &groups[0];
        let (algebra, equation) = job.over(*fields).unwrap();
        assert_eq!(job.check(&algebra, &equation, images, 0), Ok(()));
        let mut refused = 0;
        for (n, place) in places(&images[0]) {
            let broken = broken(images, n, place, refused);
            // Whatever orders below are taken for granted.
            for first in 0..=n {
                let answer = job.check(&algebra, &equation, &broken, first);
                assert!(matches!(answer, Err(Error::Expand(_))), "{n} {place:?}: {answer:?}");
            }
            refused += 1;
        }
        assert_eq!(refused, 3 * (ORDER + 1) + (ORDER + 1) * (ORDER + 2) / 2);
    });
}

/// A prime that begins with the orders that are proved gives what it gives from the start, and with a wrong one below
/// something else.
#[test]
fn a_late_prime_gives_the_same_image() {
    with_groups(3, |job, mut groups| {
        let (fields, late) = groups.pop().unwrap();
        let images: Vec<Image> = groups.into_iter().flat_map(|(_, group)| group).collect();
        let numbers =
            (0..=ORDER).map(|n| Lifted::new(lifted(&images, n).unwrap(), images[0].places(n)));
        let mut proved: Vec<Lifted> = numbers.collect();
        for m in 1..=ORDER {
            let found = job.image(fields, &proved[..m]).unwrap().unwrap();
            for (found, late) in found.iter().zip(&late) {
                assert!((0..m).all(|n| found.values(n).is_empty()));
                assert!((m..=ORDER).all(|n| found.values(n) == late.values(n)), "{m}");
            }
        }
        proved[2].numbers.numerators[0].1 += 1;
        let found = job.image(fields, &proved[..4]);
        let same = |found: Group| found.iter().zip(&late).any(|(a, b)| a.values(4) == b.values(4));
        assert!(!found.is_ok_and(|image| image.is_ok_and(same)));
    });
}

/// Orders that are known cost no products but for what the others need of them.
#[test]
fn known_orders_are_not_derived_again() {
    let equation = (Expression::ACCELERATION + x(1) + small(1) * x(3)).canonical();
    let algebra = Trigonometric::new(Rationals);
    let compiled = compile(&algebra, &equation, &NoNames, 9).unwrap();
    let condition = Condition::InitialAmplitude;
    let request = Request { condition, order: 9, leading_amplitude: Rational::from(1) };
    let whole = expand(&algebra, &compiled, &request, &mut |_| true).unwrap();
    let known = Known { solution: &whole.solution[..8], squared: &whole.frequency_squared[..8] };
    let rest = extend(&algebra, &compiled, &request, known, &mut |_| true).unwrap();
    assert_eq!(rest.solution, whole.solution);
    assert_eq!(rest.frequency_squared, whole.frequency_squared);
    let products = |work: &[OrderWork]| work.iter().map(|work| work.products).sum::<u64>();
    assert_eq!((products(&whole.work), products(&rest.work)), (77, 43));
    assert_eq!(check_from(&algebra, &compiled, &rest, 8), Ok(9));
}

fn lifted(images: &[Image], n: usize) -> Option<OrderNumbers> {
    let remaindering = Remaindering::new(images);
    remaindering.lift(images, n, &Integer::from(1), &Stop::default())
}

/// The number that a tree of products gives for residues is the smallest one that has them, whatever the shape of the tree.
#[test]
fn numerators_have_the_residues_of_their_images() {
    with_images(70, |_, images| {
        for count in [1, 2, 16, 17, 32, 33, 49, 70] {
            let (images, remaindering) = (&images[..count], Remaindering::new(&images[..count]));
            let modulus: Integer =
                images.iter().map(|image| Integer::from(image.ring.modulus())).product();
            let denominator = Integer::from(48);
            let found = remaindering.numerator(images, 2, 1, &denominator);
            assert!(Integer::from(&found << 1).cmp_abs(&modulus).is_le());
            for image in images {
                let (ring, value) = (&image.ring, image.values(2)[1]);
                let numerator = ring.mul(&value, &ring.integer(&denominator));
                assert_eq!(ring.integer(&found), numerator, "{count}");
            }
        }
    });
}

/// An image that breaks after it was checked: what is lifted is no short number, or the prime that had no part
/// in it says so.
#[test]
fn a_broken_residue_is_not_lifted() {
    with_images(6, |job, images| {
        let (judge, lifting) = images.split_first().unwrap();
        for (n, place) in places(judge).into_iter().filter(|(n, _)| *n > 0) {
            let numbers = lifted(lifting, n).unwrap();
            assert_eq!(job.judge(judge, n, &numbers), Ok(()));
            // One residue: no number of that size has it.
            let mut broken = lifting.to_vec();
            let ring = broken[2].ring;
            broken[2].change(n, place, |value| ring.add(&value, &ring.one()));
            // In Euclid's algorithm the broken prime is a denominator, and what is left is right: it is not
            // taken for congruent to an image that it is not congruent to.
            assert!(lifted(&broken, n).is_none(), "{n} {place:?}");
            // The same mistake modulo every prime: short, and wrong.
            let mut broken = lifting.to_vec();
            for image in &mut broken {
                let ring = image.ring;
                image.change(n, place, |value| ring.add(&value, &ring.one()));
            }
            let numbers = lifted(&broken, n).unwrap();
            assert!(job.judge(judge, n, &numbers).is_err(), "{n} {place:?}");
        }
    });
}

/// One digit of a numerator, or of the denominator.
#[test]
fn a_broken_number_is_refused() {
    with_images(6, |job, images| {
        let (judge, lifting) = images.split_first().unwrap();
        for n in 1..=ORDER {
            let numbers = lifted(lifting, n).unwrap();
            for index in 0..numbers.numerators.len() {
                let mut broken = numbers.clone();
                broken.numerators[index].1 += 1;
                assert!(job.judge(judge, n, &broken).is_err());
            }
            let mut broken = numbers.clone();
            broken.numerators.pop();
            assert!(job.judge(judge, n, &broken).is_err());
            let mut broken = numbers.clone();
            broken.denominator *= 2;
            assert!(job.judge(judge, n, &broken).is_err());
            let mut broken = numbers.clone();
            broken.squared += 1;
            assert!(job.judge(judge, n, &broken).is_err());
            let mut broken = numbers.clone();
            broken.period += 1;
            assert!(job.judge(judge, n, &broken).is_err());
        }
    });
}

/// The bound is one: with any numbers in the last order, right or wrong, the residual of Duffing's equation
/// that they leave, computed over Q, has numerators of fewer bits; and not many fewer.
#[test]
fn no_residual_is_larger_than_its_bound() {
    let equation = (Expression::ACCELERATION + x(1) + small(1) * x(3)).canonical();
    let algebra = Trigonometric::new(Rationals);
    let compiled = compile(&algebra, &equation, &NoNames, 5).unwrap();
    let right = directly(&equation, Condition::InitialAmplitude, 5).unwrap();
    let wrong: [Rational; 4] =
        [(0, 1), (1, 1), (-123_456_789, 1), (1, 1_000_003)].map(Rational::from);
    for change in wrong {
        let mut bound = ResidualBound::new(&compiled, &Rational::from(1), 11, false).unwrap();
        for n in 0..=5 {
            let mut x = right.solution[n].clone();
            if n > 0 {
                // (A change of cos psi leaves no residual but at the next order.)
                x.cos[3] += &change;
            }
            let denominator = x.cos.iter().fold(Integer::from(1), |d, c| d.lcm(c.denom()));
            let numerator =
                |(k, c): (usize, &Rational)| (k, (c.clone() * &denominator).numer().clone());
            let numbers = OrderNumbers {
                numerators: x.cos.iter().enumerate().map(numerator).collect(),
                denominator,
                squared: right.frequency_squared[n].clone(),
                frequency: Rational::new(),
                period: Rational::new(),
            };
            let bits = bound.take(&numbers);
            // Cosines have half the coefficients of their exponentials.
            let residual = residual_of_duffing(&algebra, &right, &x, n);
            let common = residual.iter().fold(Integer::from(2), |d, c| d.lcm(c.denom()));
            for c in &residual {
                let numerator = (c.clone() * &common).numer().clone();
                assert!(u64::from(numerator.significant_bits()) <= bits, "{n} {change}");
            }
            assert!(
                residual.iter().all(|c| c.is_zero()) == (change.is_zero() || n == 0),
                "{n} {change}"
            );
            assert!(bits < 60 + 40 * n as u64, "{n} {bits}");
            bound.give_back();
            let numbers = order_numbers(&right, n);
            bound.take(&numbers);
        }
    }
}

fn order_numbers(right: &Expansion<RationalAlgebraOfPhase>, n: usize) -> OrderNumbers {
    let x = &right.solution[n];
    let denominator = x.cos.iter().fold(Integer::from(1), |d, c| d.lcm(c.denom()));
    let numerator = |(k, c): (usize, &Rational)| (k, (c.clone() * &denominator).numer().clone());
    OrderNumbers {
        numerators: x.cos.iter().enumerate().map(numerator).collect(),
        denominator,
        squared: right.frequency_squared[n].clone(),
        frequency: Rational::new(),
        period: Rational::new(),
    }
}

/// sum_k W_k x''_(n-k) + x_n + (x^3)_(n-1) with another x_n: its cosines.
fn residual_of_duffing(
    algebra: &RationalAlgebraOfPhase,
    right: &Expansion<RationalAlgebraOfPhase>,
    last: &<RationalAlgebraOfPhase as Ring>::Element,
    n: usize,
) -> Vec<Rational> {
    use lindstedt_algebra::{FunctionAlgebra, PhaseAlgebra};
    let order = |k: usize| if k == n { last } else { &right.solution[k] };
    let mut sum = last.clone();
    for k in 0..=n {
        let curvature = algebra.derivative(&algebra.derivative(order(n - k)));
        algebra.add_assign(&mut sum, &algebra.scale_by(&curvature, &right.frequency_squared[k]));
    }
    for i in 0..n {
        for j in 0..n - i {
            let square = algebra.mul(order(i), order(j));
            algebra.add_assign(&mut sum, &algebra.mul(&square, order(n - 1 - i - j)));
        }
    }
    sum.cos
}

/// Nothing short of enough primes is taken for a proof.
#[test]
fn stopping_is_no_result() {
    let equation = van_der_pol();
    let cycle = Condition::LimitCycle;
    let stopped = Err(Error::Expand(ExpandError::Interrupted { order: 12 }));
    let answer = derive(&equation, &|_| None, cycle, 12, &Stop::default(), &mut |_| false);
    assert_eq!(answer.map(|proved| proved.primes), stopped);
    let stop = Stop::new(|| true);
    let answer = derive(&equation, &|_| None, cycle, 12, &stop, &mut |_| true);
    assert_eq!(answer.map(|proved| proved.primes), stopped);
}

/// The energy integral gives the frequency that the driver gives, for odd and for other forces, of several
/// orders in eps; and no other equation has one.
#[test]
fn the_energy_integral_agrees() {
    let algebra = Trigonometric::new(Rationals);
    let mut compared = 0;
    for (equation, conditions) in equations() {
        let equation = equation.canonical();
        for order in [0, 1, 2, 3, 12] {
            let compiled = compile(&algebra, &equation, &NoNames, order).unwrap();
            let integral = conservative_period(&compiled, order, &Stop::default());
            if compiled.has_velocity() {
                assert!(matches!(integral, Err(ExpandError::UnsupportedTerm { .. })));
                continue;
            }
            let integral = integral.unwrap();
            let (initial, stop) = (Condition::InitialAmplitude, Stop::default());
            assert!(conditions.contains(&initial));
            let found = derive(&equation, &|_| None, initial, order, &stop, &mut |_| true).unwrap();
            assert_eq!(integral.stiffness, found.stiffness);
            assert_eq!(integral.frequency_squared, found.squared);
            assert_eq!(integral.frequency, found.frequency);
            assert_eq!(integral.period_over_2pi, found.period);
            compared += 1;
        }
    }
    assert_eq!(compared, 20);
    let stopped = Err(ExpandError::Interrupted { order: 1 });
    let compiled = compile(&algebra, &equations()[0].0, &NoNames, 3).unwrap();
    assert_eq!(conservative_period(&compiled, 3, &Stop::new(|| true)), stopped);
}
