//! x'' + alpha^2 x = P0 cos(omega t) + eps (A [x - x(t-T)] + B [x' - x'(t-T)] - c x'), x <= s.

use lindstedt_equation::{Crossing, Expression, Function, Impact, Problem};

/// The controlled vibro-impact oscillator; eps = 1 in the end.
pub fn problem() -> Problem {
    let (x, v) = (Expression::DISPLACEMENT, Expression::VELOCITY);
    let symbol = Expression::parameter;
    let period = || symbol("T");
    let loop_force = symbol("A") * (x.clone() - x.clone().delayed(period()))
        + symbol("B") * (v.clone() - v.clone().delayed(period()))
        - symbol("c") * v;
    let force = symbol("P0") * (symbol("omega") * Expression::Time).apply(Function::Cos);
    let flight = Expression::ACCELERATION + symbol("alpha").pow(2) * x
        - force
        - Expression::Small * loop_force;
    Problem::new("vibro-impact", flight)
        .with_title("vibro-impact oscillator with a delay loop, one impact in k periods")
        .with_wall(Impact {
            position: symbol("s"),
            crossing: Crossing::Rising,
            restitution: symbol("R_r"),
        })
        .with_synchronous("T", "k", "omega")
        .with_parameter("alpha", "frequency of free flight, > 0", "1")
        .with_parameter("omega", "frequency of the force, > 0", "3.3")
        .with_parameter("k", "periods of the force between impacts; T = 2 pi k/omega", "1")
        .with_parameter("R_r", "restitution coefficient, 0 to 1", "0.6")
        .with_parameter("s", "position of the wall", "-0.2")
        .with_parameter("c", "damping, of order eps", "0.2")
        .with_parameter("P0", "amplitude of the force", "1")
        .with_parameter("A", "gain of the displacement loop, of order eps", "0")
        .with_parameter("B", "gain of the velocity loop, of order eps", "0")
        .with_parameter("branch", "+ or -, the sign of the root in the impact velocity", "+")
        .with_notes(
            "(1) with c, A, B of order eps and eps = 1 in the end; c = c_1/m, \
             alpha^2 = (k_1 + k_2)/m, P0 = y_0 k_2/m, A = k_2 a_1/m, B = k_2 b_1/m. Impact at \
             x = s: x' -> -R_r x'. Dimensionless once time and length are scaled. No published \
             parameter set exists; the defaults are orbit O3 of the tests.",
        )
        .with_source("Awrejcewicz and Andrianov, section 2, equations (1)-(17)")
}
