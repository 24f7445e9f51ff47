//! The stick-slip oscillator with the parameters of section 3.

use lindstedt_simulate::{Model, Parameters, Quantity};

pub fn stick_slip() -> Model {
    let equation = lindstedt_problems::stick_slip::equation();
    Model::second_order(&equation).unwrap().with_small("eps")
}

/// The paper's values, replaced or completed by the given ones.
pub fn parameters(more: &[(&str, &str)]) -> Parameters {
    let mut parameters = Parameters::new();
    let paper = [
        ("a", "1"),
        ("b", "1"),
        ("T0", "0.3"),
        ("alpha", "0.3"),
        ("beta", "0.3"),
        ("omega", "2"),
        ("vstar", "0.4"),
        ("eps", "1"),
    ];
    for (name, value) in paper.iter().chain(more) {
        parameters.set(name, Quantity::parse(value).unwrap());
    }
    parameters
}
