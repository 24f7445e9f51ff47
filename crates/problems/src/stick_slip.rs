//! The stick-slip oscillator of section 3: a data card. Its equation has a sign and a forcing in
//! t, so it is no problem of the expansion driver; Melnikov's method and the simulation take it.

use lindstedt_equation::{AmplitudeRole, Expression, Function, Problem};

/// x'' - a x + b x^3 + eps (T0 sign w - alpha w + beta w^3 - gamma cos(omega t)), w = x' - vstar.
pub fn equation() -> Expression {
    let x = Expression::DISPLACEMENT;
    let symbol = Expression::parameter;
    let slip = Expression::VELOCITY - symbol("vstar");
    let friction = symbol("T0") * slip.clone().apply(Function::Sign)
        - symbol("alpha") * slip.clone()
        + symbol("beta") * slip.pow(3);
    let forcing = symbol("gamma") * (symbol("omega") * Expression::Time).apply(Function::Cos);
    Expression::ACCELERATION - symbol("a") * x.clone()
        + symbol("b") * x.pow(3)
        + Expression::Small * (friction - forcing)
}

/// Equation and card; no condition of the expansion driver belongs to it.
pub fn problem() -> Problem {
    Problem::new("stick-slip", equation())
        .with_title("mass on a moving belt in a double well")
        .under([], AmplitudeRole::Free)
        .with_parameter("a", "k_1/m > 0: the saddle's rate squared", "1")
        .with_parameter("b", "k_2/m > 0: stiffening, wells at +-sqrt(a/b)", "1")
        .with_parameter("T0", "theta_0/m: dry friction", "0.3")
        .with_parameter("alpha", "A/m: falling part of the friction", "0.3")
        .with_parameter("beta", "B/m: rising part of the friction", "0.3")
        .with_parameter("omega", "frequency of the forcing, > 0", "2")
        .with_parameter("vstar", "speed of the belt, any sign", "0.4")
        .with_parameter("gamma", "Gamma/m: amplitude of the forcing", "0.65")
        .with_parameter(
            "eps",
            "perturbation parameter; thresholds do not depend on it, validity does",
            "1",
        )
        .with_notes(
            "(18) divided by m. All parameters are dimensionless once time and length are \
             scaled; homoclinic orbit x0 = +-sqrt(2a/b) sech(sqrt(a) t), largest speed \
             V = a/sqrt(2b). Valid for |v*| and ||v*| - V| large against eps.",
        )
        .with_source("section 3 of the paper, (18)-(27), with its misprints corrected")
}
