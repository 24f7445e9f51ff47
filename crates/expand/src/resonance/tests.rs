//! The linear case against the general scheme.

use super::{Affine, Resonant, SlowFlow, check_flow, linearise, resonant};
use crate::{Binding, ExpandError, compile, compile_system};
use lindstedt_algebra::{AmplitudeAlgebra, ForcedAlgebra, LinearPart, Ring};
use lindstedt_coeff::PolynomialRing;
use lindstedt_coeff::parameters::{ParameterField, ParameterFraction};
use lindstedt_equation::print::Style;
use lindstedt_equation::{Expression, Function};
use lindstedt_phase::amplitudes::{AmplitudeElement, Amplitudes, Delay, scalars::Over};

type Algebra = Amplitudes<Over<ParameterField>>;

type Element = AmplitudeElement<ParameterFraction>;

const NAMES: [&str; 9] = ["alpha", "omega", "T", "A", "B", "c", "P", "cos", "sin"];

pub(super) struct Named<'a>(pub(super) &'a Algebra);

impl Binding<Algebra> for Named<'_> {
    fn parameter(&self, name: &str) -> Option<Element> {
        let field = field();
        Some(self.0.number(&field.parameter(field.position(name)?)))
    }
}

fn field() -> ParameterField {
    let parameters = NAMES.map(str::to_owned).to_vec();
    ParameterField { ring: PolynomialRing { parameters }, pairs: vec![(7, 8)], affine: false }
}

/// x'' + alpha^2 x - P cos(omega t) = eps (A (x - x(t - T)) + B (x' - x'(t - T)) - c x'), and one more term.
pub(super) fn delay_loop(more: Expression) -> Expression {
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

pub(super) fn algebra() -> Algebra {
    let field = field();
    let [alpha, omega, time, cos, sin] = [0, 1, 2, 7, 8].map(|index| field.parameter(index));
    let still = [field.one(), field.zero()];
    let delays = [Delay { time, turns: vec![[cos, sin], still] }];
    let algebra = Amplitudes::off_resonance(Over::exact(field), &alpha, Some(&omega)).unwrap();
    algebra.with_delays(&delays)
}

/// From the root, and from the general scheme.
fn both(equation: &Expression, order: usize) -> Result<[SlowFlow<Element>; 2], ExpandError> {
    let algebra = algebra();
    let graph = compile_system(&algebra, std::slice::from_ref(equation), &Named(&algebra), order)?;
    let linear = resonant(&algebra, &graph, order, &[], &mut |_| true)?;
    let generating = vec![algebra.twice_real(&algebra.amplitude(0))];
    let general = Resonant::start(&algebra, &graph, &[], generating)?;
    let judge = general.finish(order, &mut |_| true)?;
    assert_eq!(check_flow(&algebra, &graph, &linear), Ok(order));
    // Every number of the answer is judged.
    let z = algebra.amplitude(0);
    for n in 0..=order {
        let mut wrong = [(); 3].map(|()| linear.clone());
        let [growth, turn, u] = &mut wrong;
        algebra.add_assign(&mut growth.flow[0][n], &z);
        algebra.add_assign(&mut turn.flow[0][n], &algebra.by_time(&z));
        let harmonic = algebra.forcing(2).map(|(cos, _)| cos).unwrap_or_else(|| algebra.one());
        algebra.add_assign(&mut u.solution[0][n], &harmonic);
        for flow in &wrong {
            assert_eq!(check_flow(&algebra, &graph, flow), Err(ExpandError::Residual { order: n }));
        }
    }
    Ok([linear, judge])
}

#[test]
fn the_root_is_what_the_general_scheme_derives() {
    let order = 3;
    let [linear, judge] = both(&delay_loop(Expression::integer(0)), order).unwrap();
    assert_eq!(linear.flow, judge.flow);
    assert_eq!(linear.solution, judge.solution);
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
    assert_eq!(linear.flow, judge.flow);
}

#[test]
fn the_equation_decides() {
    let algebra = algebra();
    let route = |more| {
        let graph = compile_system(&algebra, &[delay_loop(more)], &Named(&algebra), 2).unwrap();
        Affine::of(&algebra, &graph, 2).is_some()
    };
    let x = || Expression::DISPLACEMENT;
    assert!(route(Expression::Small * x()));
    assert!(!route(x() * x()));
    assert!(!route(x() * (Expression::parameter("omega") * Expression::Time).apply(Function::Cos)));
    assert!(!route(x() * x().delayed(Expression::parameter("T"))));
}

/// What is small need not be linear; the linear part read off the graph is that of the tangents.
#[test]
fn the_linear_part_is_read_where_it_is_linear() {
    let algebra = algebra();
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let late = x.clone().delayed(Expression::parameter("T"));
    let damped = Expression::parameter("c") * v.clone() + Expression::parameter("B") * late.clone();
    let small = Expression::Small * (x.clone() * x.clone() * late - v);
    for (more, reads) in [
        (Expression::integer(0), true),
        (damped.clone(), true),
        (small.clone(), true),
        (small + damped, true),
        (x.clone() * x, false),
    ] {
        let equation = delay_loop(Expression::integer(0)) + more;
        let graph = compile_system(&algebra, &[equation], &Named(&algebra), 2).unwrap();
        let read = Affine::read(&algebra, &graph, 0);
        assert_eq!(read.is_some(), reads);
        let Some(read) = read else { continue };
        let (parts, _) =
            linearise(&algebra, &graph, &[algebra.twice_real(&algebra.amplitude(0))]).unwrap();
        let of = |part: &LinearPart<Element>| {
            (part.stiffness.clone(), part.damping.clone(), part.delayed.clone())
        };
        assert_eq!(of(&read.linear_part(&algebra, algebra.delays())), of(&parts[0]));
    }
}

/// Another stiffness or damping at order zero is refused.
#[test]
fn order_zero_is_the_oscillator_of_the_algebra() {
    let algebra = algebra();
    let refused = |more: Expression| {
        let equation = delay_loop(Expression::integer(0)) + more;
        let graph = compile_system(&algebra, &[equation], &Named(&algebra), 2).unwrap();
        resonant(&algebra, &graph, 2, &[], &mut |_| true).map(|_| ())
    };
    let other = Err(ExpandError::NotTheFrequency { unknown: 0 });
    assert_eq!(refused(Expression::integer(0)), Ok(()));
    assert_eq!(refused(Expression::DISPLACEMENT), other);
    assert_eq!(refused(Expression::VELOCITY), other);
}

/// The compiler without time names the delayed term and the force, over an algebra that knows both.
#[test]
fn time_is_for_algebras_that_are_asked_for_it() {
    let algebra = algebra();
    let named = Named(&algebra);
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
