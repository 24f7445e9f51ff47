//! Homoclinic orbits to any order, from the equation as it is written to the series.

use lindstedt::{Oscillator, Work};

fn series(equation: &str, name: &str, order: usize) -> Vec<String> {
    let found = Oscillator::parse(equation).unwrap().homoclinic(name, order, &Work::default());
    let found = found.unwrap().value;
    found.series[name].iter().map(|number| number.exact.clone().unwrap()).collect()
}

/// Al-Hdaibat, Govaerts, Kuznetsov, Meijer, SIAM J. Appl. Dyn. Syst. 15 (2016): 10/7 and 288/2401.
#[test]
fn equations_are_read_about_their_saddle() {
    let known = ["10/7", "0", "288/2401", "0", "-240192/45294865"];
    assert_eq!(series("x'' = x^2 - 4 + eps*x'*(x + tau)", "tau", 4), known);
    // Moved, turned over (the orbit to the left), and in another unit of length.
    for equation in [
        "x'' = (x - 1/3)^2 - 4 + eps*x'*(x - 1/3 + tau)",
        "x'' + (x - 5)^2 - 4 = eps*x'*(5 - x + tau)",
        "3*x'' = x^2 - 36 + eps*x'*(x + 3*tau)",
    ] {
        assert_eq!(series(equation, "tau", 4), known, "{equation}");
    }
    let carr = series("x'' - x + x^3 = eps*(mu - x^2)*x'", "mu", 4);
    assert_eq!(carr, ["4/5", "0", "184/13125", "0", "-21664/103359375"]);
    let moved = "x'' = (x + 2) - (x + 2)^3 + eps*(2*mu - (x + 2)^2)*x'";
    assert_eq!(series(moved, "mu", 2), ["2/5", "0", "92/13125"]);
}

/// y^3 = (5/2) sech^2(3 t/2), and with I_q the integral of sech^q tanh^2, I_(q+2)/I_q = q/(q + 3), Melnikov's
/// integral of (mu - y^3) y'^2 vanishes at mu = (5/2) (4/3)/(13/3).
#[test]
fn a_quartic_force() {
    let found = series("x'' = x - x^4 + eps*(mu - x^3)*x'", "mu", 1);
    assert_eq!(found, ["10/13", "0"]);
}

#[test]
fn what_is_refused() {
    let refused = |equation: &str, name: &str| {
        let found = Oscillator::parse(equation).unwrap().homoclinic(name, 1, &Work::default());
        found.unwrap_err().to_string()
    };
    for (equation, reason) in [
        ("x'' = x^2 - 4 + eps*(x'*(x + mu) + 1)", "moves it"),
        ("x'' = x - x^3 + eps*(mu - x^3)*x'", "leaves the ring"),
        ("x'' = x - x^3 + eps*(mu^2 - x^2)*x'", "not linear in the parameter"),
        ("x'' = x - x^3 + eps*mu*x' + eps^2*x'", "higher order"),
        ("x'' = x + x^3 + eps*(mu - x^2)*x'", "known in closed form"),
        ("x'' = x - x^3 - x^5 + eps*(mu - x^2)*x'", "known in closed form"),
        ("x'' = 2*x - x^3 + eps*(mu - x^2)*x'", "square"),
        ("x'' = x - x^3 + eps*(mu + pi*x^2)*x'", "not rational"),
        ("x'' = x - x^3 + eps*(mu*x - x^3)", "no work"),
        ("x'' = x - x^3 + eps*mu*x'*cos(x)", "no polynomial"),
        ("x'' = x - x^3 + eps*mu*x'(t - 1)", "delay"),
    ] {
        let said = refused(equation, "mu");
        assert!(said.contains(reason), "{equation}: {said}");
    }
}

/// With a force without such a series, to first order: the parameter is a factor of the perturbation, of its first order.
#[test]
fn a_parameter_elsewhere_is_refused_for_its_place() {
    for (factor, reason) in [
        ("eps^2*mu", "of higher order in the small parameter"),
        ("mu", "has no factor of the small parameter"),
        ("eps*mu^2", "not linear in the parameter"),
        ("eps*cos(mu)", "not linear in the parameter"),
    ] {
        let pendulum = Oscillator::parse(&format!("x'' + sin(x) = eps - {factor}*x'")).unwrap();
        let said = pendulum.persistence("mu", &Work::default()).unwrap_err().to_string();
        assert!(said.contains(reason), "{factor}: {said}");
    }
}
