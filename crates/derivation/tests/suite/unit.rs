//! Frequencies that are rational multiples of one symbol or of one square root.

use crate::resonance::{Named, by_hand, flow, named, refused};
use lindstedt_coeff::print::Style;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{PolarTerm, ResonanceError, SlowFlow, normal_mode};
use lindstedt_expand::resonance::Nearest;
use lindstedt_problem_file::ProblemFile;
use rug::Rational;
use rug::ops::Pow;
use std::collections::BTreeMap;

/// c F^.. omega0^.. ... a^p cos(g gamma), sines as `sin`, in the order they are printed.
fn polar(found: &SlowFlow, terms: &[PolarTerm]) -> Vec<String> {
    let term = |t: &PolarTerm| {
        let symbols = found.system.symbols.iter().zip(&t.symbols).filter(|(_, n)| **n != 0);
        let symbols: String = symbols.map(|(name, n)| format!(" {name}^{n}")).collect();
        let wave = match (t.harmonic, t.sine) {
            (0, _) => "",
            (_, false) => " cos",
            (_, true) => " sin",
        };
        format!("{}{symbols} a^{}{wave}", t.coefficient, t.power)
    };
    let mut list: Vec<_> = terms.iter().map(term).collect();
    list.sort();
    list
}

/// Nayfeh and Mook, Nonlinear Oscillations (1979), with omega_0 as they print it: u'' + omega_0^2 u = -2 eps mu u' - eps
/// alpha u^3 + E(t), sections 4.1.1 (primary, E = eps k cos), 4.1.3 (superharmonic) and 4.1.4 (subharmonic resonance, E = K cos),
/// Lambda = K/(2 (omega_0^2 - Omega^2)).
#[test]
fn equations_of_nayfeh_and_mook() {
    let weak = "x'' + omega0^2*x + eps*(2*mu*x' + alpha*x^3)";
    // a' = -mu a + k/(2 omega_0) sin, a gamma' = sigma a - 3 alpha/(8 omega_0) a^3 + k/(2 omega_0) cos.
    let primary = [
        vec!["-1 mu^1 a^1", "1/2 k^1 omega0^-1 a^0 sin"],
        vec!["-3/8 alpha^1 omega0^-1 a^3", "1 sigma^1 a^1", "1/2 k^1 omega0^-1 a^0 cos"],
    ];
    // a' = -mu a - 3 alpha Lambda/(4 omega_0) a^2 sin, a gamma' = (sigma - 9 alpha Lambda^2/omega_0) a - 9 alpha/(8 omega_0) a^3
    // - 9 alpha Lambda/(4 omega_0) a^2 cos, Lambda = -K/(16 omega_0^2).
    let sub = [
        vec!["-1 mu^1 a^1", "3/64 K^1 alpha^1 omega0^-3 a^2 sin"],
        vec![
            "-9/256 K^2 alpha^1 omega0^-5 a^1",
            "-9/8 alpha^1 omega0^-1 a^3",
            "1 sigma^1 a^1",
            "9/64 K^1 alpha^1 omega0^-3 a^2 cos",
        ],
    ];
    // a' = -mu a - alpha Lambda^3/omega_0 sin, a gamma' = (sigma - 3 alpha Lambda^2/omega_0) a - 3 alpha/(8 omega_0) a^3
    // - alpha Lambda^3/omega_0 cos, Lambda = 9 K/(16 omega_0^2), 3 Omega = omega_0 + eps sigma.
    let sup = [
        vec!["-1 mu^1 a^1", "-729/4096 K^3 alpha^1 omega0^-7 a^0 sin"],
        vec![
            "-243/256 K^2 alpha^1 omega0^-5 a^1",
            "-3/8 alpha^1 omega0^-1 a^3",
            "-729/4096 K^3 alpha^1 omega0^-7 a^0 cos",
            "1 sigma^1 a^1",
        ],
    ];
    for (force, expected) in [
        ("eps*k*cos((omega0 + eps*sigma)*t)", primary),
        ("K*cos((3*omega0 + eps*sigma)*t)", sub),
        ("K*cos((omega0 + eps*sigma)*t/3)", sup),
    ] {
        let found = flow(&format!("{weak} = {force}"), 1, &[]);
        let rates = found.polar().unwrap();
        for (terms, expected) in [&rates.amplitude[0], &rates.phase[0]].into_iter().zip(expected) {
            assert_eq!(polar(&found, terms), expected, "{force}");
        }
    }
    // Principal parametric and internal resonance 1:2 (with the squares written in other ways), by hand: f = i c/(2 nu).
    let tongue = flow(&format!("{weak} + eps*h*x*cos((2*omega0 + eps*sigma)*t)"), 1, &[]);
    let expected = ["-1 mu z1", "3/2 i alpha z1^2 zbar1 omega0^-1", "1/4 i h zbar1 E omega0^-1"];
    assert_eq!(named(&tongue, &tongue.flow[0][1]), by_hand(&expected));
    let exchange = flow("x'' + omega0*omega0*x/4 + eps*x*y; y'' + omega0^2*y + eps*x^2", 1, &[]);
    let first = by_hand(&["1 i zbar1 z2 omega0^-1"]);
    assert_eq!(named(&exchange, &exchange.flow[0][1]), first);
    assert_eq!(named(&exchange, &exchange.flow[1][1]), by_hand(&["1/2 i z1^2 omega0^-1"]));
}

/// The terms with a number for a symbol.
fn at(terms: &Named, name: &str, value: &Rational) -> Named {
    let mut sum = Named::new();
    for (powers, parts) in terms {
        let mut powers = powers.clone();
        let factor = Rational::from(value.pow(powers.remove(name).unwrap_or(0)));
        let entry = sum.entry(powers).or_default();
        entry.iter_mut().zip(parts).for_each(|(sum, part)| *sum += Rational::from(part * &factor));
    }
    sum.retain(|_, parts| parts.iter().any(|part| !part.is_zero()));
    sum
}

/// At omega_0 = 3/2 the flow is the one that has the number from the beginning: all resonances, velocities to odd and even powers,
/// several unknowns and their modes, two phases, denominators.
#[test]
fn a_number_for_the_symbol_commutes_with_the_derivation() {
    let value = Rational::from((3, 2));
    for (equation, order) in [
        ("x'' + omega0^2*x + eps*(m*x' + al*x^3) = eps*F*cos((omega0 + eps*s)*t)", 4),
        (
            "x'' + omega0^2*x + eps*(x'^3 - omega0^3*x' + x^2/omega0) = F*cos((3*omega0 + eps*s)*t)",
            3,
        ),
        (
            "x'' + omega0^2*x + eps*x^3 = F*cos((omega0/3 + eps*omega0*s)*t) + eps*cos(2*omega0*t)",
            3,
        ),
        ("x'' + omega0^2*x + eps*x*y; y'' + (2*omega0)^2*y + eps*(s*omega0*y + x^2 - y')", 4),
        ("2*x'' + 5*omega0^2*x - 3*omega0^2*y + eps*x^3; 2*y'' + 5*omega0^2*y - 3*omega0^2*x", 2),
    ] {
        let (symbol, number) =
            (flow(equation, order, &[]), flow(equation, order, &[("omega0", "3/2")]));
        assert_eq!(number.system.unit, None);
        let sizes = |found: &SlowFlow| {
            let size = |near: &Nearest| (near.order, near.unknown, near.size.clone());
            found.nearest.iter().map(size).collect::<Vec<_>>()
        };
        assert_eq!(sizes(&symbol), sizes(&number), "{equation}");
        let lists = |found: &SlowFlow| {
            let all = found.flow.iter().chain(&found.solution).chain(&found.detuning).flatten();
            all.chain(&found.energy).map(|terms| named(found, terms)).collect::<Vec<_>>()
        };
        let put_in: Vec<_> = lists(&symbol).iter().map(|list| at(list, "omega0", &value)).collect();
        assert_eq!(put_in, lists(&number), "{equation}");
    }
    // The same of a backbone with its growth, in units of the frequency.
    let equation = "x'' + omega0^2*x + eps*(x^2*x' - x' + al*x^3)";
    let mode = |values: &str| {
        let text = format!("equation = \"{equation}\"\n{values}");
        let problem = ProblemFile::parse(&text).unwrap().problem;
        let settings = AveragingSettings { order: 3, ..AveragingSettings::default() };
        normal_mode(&problem, 1, &settings, &mut |_| true).unwrap()
    };
    let (symbol, number) = (mode(""), mode("[parameters]\nomega0 = { value = \"3/2\" }\nal = {}"));
    assert_eq!(
        (symbol.checked_orders, &*symbol.symbols),
        (Some(3), &["al", "omega0"].map(String::from)[..])
    );
    let orders = symbol.frequency_squared.iter().chain(&symbol.growth);
    for (left, right) in orders.zip(number.frequency_squared.iter().chain(&number.growth)) {
        let mut sum = BTreeMap::<_, Rational>::new();
        for term in left {
            let [rho, al, omega] = term.exponents[..] else { panic!() };
            let factor = Rational::from((&value).pow(omega));
            *sum.entry(vec![rho, al]).or_default() += factor * &term.re;
        }
        sum.retain(|_, c| !c.is_zero());
        let right = right.iter().map(|term| (term.exponents.clone(), term.re.clone()));
        assert_eq!(sum, right.collect());
    }
}

/// sqrt(2) : sqrt(2) and sqrt(2) : sqrt(8), of unknowns and of modes, against the enclosed flow that an uncoupled unknown of
/// another frequency makes of it.
#[test]
fn roots_agree_with_their_enclosures() {
    for (equations, order) in [
        ("x'' + 2*x + eps*x*y^2; y'' + 2*y + eps*(x^2*y - y')", 3),
        ("x'' + 2*x + eps*x*y; y'' + 8*y + eps*(x^2 + y'^2)", 3),
        ("x'' + 5*x + 3*y + eps*x^2; y'' + 5*y + 3*x + eps*y'", 2),
    ] {
        let exact = flow(equations, order, &[]);
        assert!(exact.enclosed.is_none() && exact.system.is_exact());
        let enclosed = flow(&format!("{equations}; w'' + 9*w"), order, &[]);
        assert!(enclosed.enclosed.unwrap().radius < 1e-40);
        let all = exact
            .flow
            .iter()
            .chain(&exact.solution)
            .zip(enclosed.flow[..2].iter().chain(&enclosed.solution[..2]));
        for (terms, balls) in all.flat_map(|(a, b)| a.iter().zip(b)) {
            let (terms, balls) = (named(&exact, terms), named(&enclosed, balls));
            let mut sum = BTreeMap::<_, [f64; 2]>::new();
            for (mut powers, parts) in terms {
                let odd = powers.remove("sqrt(2)").unwrap_or(0);
                assert!((0..=1).contains(&odd));
                let entry = sum.entry(powers).or_default();
                let factor = 2f64.sqrt().powi(odd);
                entry.iter_mut().zip(&parts).for_each(|(sum, part)| *sum += part.to_f64() * factor);
            }
            assert!(sum.keys().eq(balls.keys()), "{equations}");
            for (ours, balls) in sum.values().flatten().zip(balls.values().flatten()) {
                assert!((ours - balls.to_f64()).abs() < 1e-14, "{equations}: {ours} {balls}");
            }
        }
    }
}

/// A frequency that is independent of omega_0: Nayfeh and Mook, section 4.1.2, f = i 3 alpha Lambda^2/omega_0 z + ...
#[test]
fn a_symbol_beside_an_independent_frequency() {
    let text = "x'' + omega0^2*x + eps*al*x^3 = eps*F*cos((omega0 + eps*s)*t) + G*cos(w*t)";
    let found = flow(text, 1, &[]);
    let shown = found.print(&found.flow[0][1], Style::Text);
    let detuned = "3/4*i*G^2*al*omega0^(-1)*(omega0 - w)^(-2)*(omega0 + w)^(-2)*z";
    assert_eq!(
        shown,
        format!("-1/4*i*F*omega0^(-1)*E_1 + {detuned} + 3/2*i*al*omega0^(-1)*z^2*zbar")
    );
}

#[test]
fn ratios_that_are_not_known_are_refused() {
    let two = refused("x'' + omega1^2*x + eps*x*y; y'' + omega2^2*y + eps*x^2");
    assert!(matches!(two, ResonanceError::NoRatio { .. }), "{two:?}");
    let number = refused("x'' + omega0^2*x + eps*x*y; y'' + 4*y + eps*x^2");
    assert!(number.to_string().contains("4 to omega0^2"), "{number}");
    let force = refused("x'' + omega0^2*x + eps*x^3 = eps*F*cos((1 + eps*s)*t)");
    assert!(force.to_string().contains("1 to omega0"), "{force}");
    for equation in
        ["x'' + k*x + eps*x^3", "m*x'' + omega0^2*x + eps*x^3", "x'' + 2*omega0^2*x + eps*x^3"]
    {
        let error = refused(&format!("{equation} = eps*F*cos((omega0 + eps*s)*t)"));
        assert!(matches!(error, ResonanceError::Unset { .. }), "{equation}: {error:?}");
    }
    let mixed = refused("x'' + 2*x + eps*x*y = eps*cos(sqrt(2)*t); y'' + 3*y + eps*x^2");
    assert!(matches!(mixed, ResonanceError::IrrationalRate { .. }), "{mixed:?}");
}
