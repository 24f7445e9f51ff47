//! The linear case against the general scheme.

use super::{Affine, AveragedExpansion, Averaging, average, check_averaged, general};
use crate::{Binding, ExpandError, compile, compile_system};
use lindstedt_algebra::{ForcedAlgebra, FunctionAlgebra, Ring};
use lindstedt_coeff::PolynomialRing;
use lindstedt_coeff::amplitude::AmplitudePolynomials;
use lindstedt_coeff::parameters::ParameterField;
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use lindstedt_phase::{Delay, Torus};

type Field = AmplitudePolynomials<ParameterField>;

const NAMES: [&str; 9] = ["alpha", "omega", "T", "A", "B", "c", "P", "cos", "sin"];

struct Named(Field);

impl Binding<Field> for Named {
    fn parameter(&self, name: &str) -> Option<<Field as Ring>::Element> {
        let field = &self.0.coefficients;
        Some(self.0.embed(field.parameter(field.position(name)?)))
    }
    fn formal(&self, _: &str, _: usize) -> Option<<Field as Ring>::Element> {
        None
    }
}

/// x'' + alpha^2 x - P cos(omega t) = eps (A (x - x(t - T)) + B (x' - x'(t - T)) - c x'), and one more term.
fn delay_loop(more: Expression) -> Expression {
    let (x, v, symbol) = (Expression::DISPLACEMENT, Expression::VELOCITY, Expression::parameter);
    let late = |e: Expression| e.delayed(symbol("T"));
    let force = symbol("A") * (x.clone() - late(x.clone()))
        + symbol("B") * (v.clone() - late(v.clone()))
        - symbol("c") * v;
    let drive = (Expression::parameter("omega") * Expression::Time).apply(Function::Cos);
    Expression::ACCELERATION + symbol("alpha").pow(2) * x
        - symbol("P") * drive
        - Expression::Small * (force + more)
}

fn torus() -> Torus<ParameterField> {
    let parameters = NAMES.map(str::to_owned).to_vec();
    let field =
        ParameterField { ring: PolynomialRing { parameters }, pairs: vec![(7, 8)], affine: false };
    let [alpha, omega, time, cos, sin] = [0, 1, 2, 7, 8].map(|index| field.parameter(index));
    let forced = [field.one(), field.zero()];
    let delays = vec![Delay { time, free: [cos, sin], forced }];
    Torus::new(field, alpha, Some(omega), delays)
}

fn both(
    equation: &Expression,
    order: usize,
) -> Result<[AveragedExpansion<Torus<ParameterField>>; 2], ExpandError> {
    let algebra = torus();
    let named = Named(algebra.constants().clone());
    let graph = compile_system(&algebra, std::slice::from_ref(equation), &named, order)?;
    let linear = average(&algebra, &graph, order, &mut |_| true)?;
    let judge = general(Averaging::start(&algebra, &graph)?, order, &mut |_| true)?;
    assert_eq!(check_averaged(&algebra, &graph, &linear), Ok(order));
    // Every number of the answer is judged.
    let one = algebra.constants().one();
    for n in 0..=order {
        let mut wrong = [(); 3].map(|()| AveragedExpansion {
            linear: linear.linear.clone(),
            amplitude_rate: linear.amplitude_rate.clone(),
            phase_rate: linear.phase_rate.clone(),
            solution: linear.solution.clone(),
            work: Vec::new(),
        });
        let [a, b, u] = &mut wrong;
        algebra.constants().add_assign(
            &mut a.amplitude_rate[n],
            &algebra.constants().power(1, algebra.coefficients().one()),
        );
        algebra.constants().add_assign(&mut b.phase_rate[n], &one);
        let harmonic = algebra.forcing(2).map(|(cos, _)| cos).unwrap_or_else(|| algebra.one());
        algebra.add_assign(&mut u.solution[n], &harmonic);
        for expansion in &wrong {
            assert_eq!(
                check_averaged(&algebra, &graph, expansion),
                Err(ExpandError::Residual { order: n })
            );
        }
    }
    Ok([linear, judge])
}

#[test]
fn the_root_is_what_the_general_scheme_derives() {
    let order = 3;
    let [linear, judge] = both(&delay_loop(Expression::integer(0)), order).unwrap();
    assert_eq!(linear.amplitude_rate, judge.amplitude_rate);
    assert_eq!(linear.phase_rate, judge.phase_rate);
    assert_eq!(linear.solution, judge.solution);
    assert_eq!(linear.linear, judge.linear);
    // A convolution of 3 pairs and its two late values an order; no derivation.
    let products: Vec<u64> = linear.work.iter().map(|work| work.products).collect();
    assert_eq!(products.len(), order);
    assert!(products.iter().zip(1u64..).all(|(p, n)| *p <= 6 * n + 6), "{products:?}");
}

/// Orders at which every weight of the recurrence of G has a part, in two symbols less.
#[test]
fn the_same_to_order_six() {
    let (x, symbol) = (Expression::DISPLACEMENT, Expression::parameter);
    let force = symbol("A") * x.clone().delayed(symbol("T")) - symbol("c") * Expression::VELOCITY;
    let equation =
        Expression::ACCELERATION + symbol("alpha").pow(2) * x - Expression::Small * force;
    let [linear, judge] = both(&equation, 6).unwrap();
    assert_eq!(linear.amplitude_rate, judge.amplitude_rate);
    assert_eq!(linear.phase_rate, judge.phase_rate);
}

#[test]
fn the_equation_decides() {
    let algebra = torus();
    let route = |more| {
        let named = Named(algebra.constants().clone());
        let graph = compile_system(&algebra, &[delay_loop(more)], &named, 2).unwrap();
        Affine::of(&algebra, &graph, 2).is_some()
    };
    let x = || Expression::DISPLACEMENT;
    assert!(route(Expression::Small * x()));
    assert!(!route(x() * x()));
    assert!(!route(x() * (Expression::parameter("omega") * Expression::Time).apply(Function::Cos)));
    assert!(!route(x() * x().delayed(Expression::parameter("T"))));
}

/// The compiler without time names the delayed term and the force, over an algebra that knows both.
#[test]
fn time_is_for_algebras_that_are_asked_for_it() {
    let algebra = torus();
    let named = Named(algebra.constants().clone());
    let x = Expression::DISPLACEMENT;
    let late = x.clone().delayed(Expression::parameter("T"));
    let force = (Expression::parameter("omega") * Expression::Time).apply(Function::Cos);
    for term in [late, force] {
        let equation = Expression::ACCELERATION + x.clone() + Expression::Small * term.clone();
        let refused = compile(&algebra, &equation, &named, 2).map(|_| ());
        let term = term.print("eps", Style::Text);
        assert_eq!(refused, Err(ExpandError::UnsupportedTerm { term }));
        assert!(compile_system(&algebra, &[equation], &named, 2).is_ok());
    }
}
