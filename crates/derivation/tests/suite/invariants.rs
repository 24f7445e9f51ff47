//! What Hamiltonian slow flows keep: energy and quadratic forms.

use crate::resonance::{Named, by_hand, flow, named};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use rug::Rational;

/// The energy along a flow is a slow quantity. Of masses 1 and 3 the second equation is divided by 3; its weight is found. By
/// hand, order 0: 2 mu_j nu_j^2 |z_j|^2 of each. Weights may differ in sign, and by parameters; gyroscopic terms do no work, others of
/// velocities do.
#[test]
fn energy_is_conserved() {
    let found = flow("x'' + x + 2*eps*x*y + eps*al*x^3; 3*y'' + 12*y + eps*x^2", 3, &[]);
    let order = |n: usize| named(&found, &found.energy[n]);
    assert_eq!(order(0), by_hand(&["2 z1 zbar1", "24 z2 zbar2"]));
    // No fast phase: the eigenvalue of every monomial is 0.
    let fast =
        |t: &AmplitudeTerm| t.exponents[0] - t.exponents[1] + 2 * (t.exponents[2] - t.exponents[3]);
    assert!(found.energy[1..].iter().all(|terms| !terms.is_empty()));
    assert!(found.energy.iter().flatten().all(|t| fast(t) == 0));
    let others = [
        ("x'' + x + eps*x*y; y'' + 4*y - eps*x^2", ["2 z1 zbar1", "-4 z2 zbar2"]),
        (
            "x'' + x + eps*(x^3 - 2*y*y'); y'' + y + eps*(2*y*x' + y^2)",
            ["2 z1 zbar1", "2 z2 zbar2"],
        ),
        ("x'' + x + eps*k*m*(x - y); y'' + y + eps*k*(y - x)", ["2 z1 zbar1", "2 z2 zbar2 m"]),
        ("x'' + x + eps*k/m*(x - y); y'' + y + eps*k*(y - x)", ["2 z1 zbar1 m", "2 z2 zbar2"]),
        // Factors that are sums; terms that tie nothing, or that tie by products of velocities.
        ("x'' + x + eps*k*(k + m)*y; y'' + y + eps*(k + m)*x", ["2 z1 zbar1", "2 z2 zbar2 k"]),
        (
            "x'' + x + eps*(x^2 + k*x'*y'*y); y'' + y + eps*(m*y^3 - x'^2*y)",
            ["2 z1 zbar1", "2 z2 zbar2 k"],
        ),
        // Products of velocities, of equal frequencies: 2 x'^2 + 2 x' y' + 2 y'^2 as its equations are, solved for x'', and along
        // (1, 0) and (1, -2), 2 and 6; x' y' along (1, 1) and (1, -1), 2 and -2.
        (
            "2*x'' + y'' + 2*x + y + eps*x^2; x'' + 2*y'' + x + 2*y + eps*y^2",
            ["2 z1 zbar1", "6 z2 zbar2"],
        ),
        ("x'' + x + eps*(2*x^2 - y^2); y'' + y + eps*(2*y^2 - x^2)", ["2 z1 zbar1", "6 z2 zbar2"]),
        ("x'' + x + eps*y^2; y'' + y + eps*x^2", ["2 z1 zbar1", "-2 z2 zbar2"]),
    ];
    for (equations, energy) in others {
        let found = flow(equations, 2, &[]);
        assert_eq!(named(&found, &found.energy[0]), by_hand(&energy), "{equations}");
    }
    // Weights that are sums of parameters, and products of velocities with parameters.
    let sums = flow("x'' + x + eps*(k + m)*y; y'' + y + eps*k*x", 2, &[]);
    let known = by_hand(&["2 z1 zbar1 k", "2 z2 zbar2 k", "2 z2 zbar2 m"]);
    assert_eq!(named(&sums, &sums.energy[0]), known);
    let equations = "x'' + x + eps*((1 + 2*al^2)*x^2 - al*y^2); y'' + y + eps*(y^2 - al*x^2)";
    let products = flow(equations, 2, &[]);
    let known = ["2 z1 zbar1", "2 z1 zbar2 al", "2 zbar1 z2 al", "2 z2 zbar2", "4 z2 zbar2 al^2"];
    assert_eq!(named(&products, &products.energy[0]), by_hand(&known));
    for equations in [
        "x'' + x + eps*x^2*x'",
        "2*x'' + y'' + 2*x + y + eps*(x^2 + y'); x'' + 2*y'' + x + 2*y + eps*(y^2 + x')",
        "x'' + x + eps*(x*y + y^2); y'' + 4*y - eps*x^2",
        "x'' + x + eps*(x^3 + y - 2*y'); y'' + y + eps*(x - 2*x')",
        "x'' + x + eps*x*x'^2; y'' + y",
    ] {
        assert!(flow(equations, 1, &[]).energy.is_empty(), "{equations}");
    }
    // Frequencies 1 and sqrt 2, V = eps x^2 y^2: <V> and the velocities, whose frequencies move by 2 |z_2|^2 and
    // |z_1|^2 sqrt 2, add 4 |z_1 z_2|^2 each.
    let enclosed = flow("x'' + x + 2*eps*x*y^2; y'' + 2*y + 2*eps*x^2*y", 1, &[]);
    for (n, expected) in
        [&["2 z1 zbar1", "4 z2 zbar2"][..], &["12 z1 zbar1 z2 zbar2"]].iter().enumerate()
    {
        let energy = named(&enclosed, &enclosed.energy[n]);
        let expected = by_hand(expected);
        assert_eq!(energy.len(), expected.len());
        for (powers, [re, _]) in expected {
            let gap = (energy[&powers][0].clone() - re).to_f64().abs();
            assert!(gap <= enclosed.enclosed.unwrap().radius, "{gap:e}");
        }
    }
    // Modes with irrational shapes: of V = eps x^2 y <V> = 0, and the squares of the golden ratio and its inverse as frequencies.
    let golden = flow("x'' + 2*x - y + 2*eps*x*y; y'' + y - x + eps*x^2", 2, &[]);
    assert_eq!((golden.energy.len(), golden.energy[0].len(), golden.energy[1].len()), (3, 2, 0));
    // Modes of coupled masses, and enclosed ones.
    assert_eq!(flow("2*x'' + 5*x - 3*y + eps*x^3; 2*y'' + 5*y - 3*x", 2, &[]).energy.len(), 3);
    assert_eq!(flow("x'' + 2*x - y + eps*x^3/2; y'' + 2*y - x", 2, &[]).energy.len(), 3);
}

/// 2 Re(zbar_j f_j) by hand: of 1:2 through V = eps x^2 y |z_1|^2 + 4 |z_2|^2, of 1:3 through V = eps x^3 y |z_1|^2 + 9 |z_2|^2,
/// the weights of the energy at order zero; of 1:2 with a third unknown without a resonance two. Damping keeps none.
#[test]
fn quadratic_invariants() {
    let forms = |equation: &str, order: usize| -> Vec<(Named, usize)> {
        let found = flow(equation, order, &[]);
        let list = found.quadratic_invariants();
        list.iter().map(|form| (named(&found, &form.terms), form.orders)).collect()
    };
    let pair = "x'' + x + 2*eps*x*y + eps*al*x^3; y'' + 4*y + eps*x^2";
    let known = by_hand(&["1 z1 zbar1", "4 z2 zbar2"]);
    assert_eq!(forms(pair, 1), [(known.clone(), 1)]);
    let third = format!("{pair}; w'' + 2*w");
    assert!(flow(&third, 1, &[]).quadratic_invariants().is_empty());
    let third = format!("{pair}; w'' + 25*w + eps*w^3");
    assert_eq!(forms(&third, 1), [(known, 1), (by_hand(&["1 z3 zbar3"]), 1)]);
    let known = by_hand(&["1 z1 zbar1", "9 z2 zbar2"]);
    assert_eq!(forms("x'' + x + 3*eps*x^2*y; y'' + 9*y + eps*x^3", 1), [(known, 1)]);
    assert!(forms("x'' + x + eps*(x' + 2*x*y); y'' + 4*y + eps*x^2", 1).is_empty());
    // f_1 vanishes and says nothing; one combination of what it keeps is kept by f_2 too.
    let both = by_hand(&["1 z1 zbar1", "1 z2 zbar2"]);
    assert_eq!(forms("x'' + x + 2*eps*x*y; y'' + y + eps*x^2", 1), []);
    assert_eq!(forms("x'' + x + 2*eps*x*y; y'' + y + eps*x^2", 2), [(both, 2)]);
    // Without a resonance every square is kept, to all orders.
    let apart = forms("x'' + x + 2*eps*x*y^2; y'' + 49/25*y + 2*eps*x^2*y", 2);
    assert_eq!(apart.iter().map(|(_, orders)| *orders).collect::<Vec<_>>(), [2, 2]);
    // The derivative along f_1, put together from the terms that are printed.
    let found = flow(pair, 1, &[]);
    let mut sum = Named::new();
    for (j, weight) in [(0, 1), (1, 4)] {
        for term in &found.flow[j][1] {
            let mut word = term.clone();
            word.exponents[2 * j + 1] += 1;
            let mut other = word.clone();
            (0..2).for_each(|k| other.exponents.swap(2 * k, 2 * k + 1));
            other.im *= -1;
            for (key, [re, im]) in named(&found, &[word]).into_iter().chain(named(&found, &[other]))
            {
                let entry = sum.entry(key).or_default();
                entry[0] += re * weight;
                entry[1] += im * weight;
            }
        }
    }
    assert!(!sum.is_empty() && sum.values().flatten().all(Rational::is_zero));
}
