//! Slow flows whose frequencies are irrational: coefficients and their radii.

use crate::resonance::{by_hand, flow, named};
use lindstedt_coeff::print::Style;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Detuned, slow_flow};
use lindstedt_phase::amplitudes::AmplitudeTerm;
use lindstedt_problem_file::ProblemFile;

/// The coupled masses of Kerschen et al. (MSSP 23, 2009) with the frequencies 1 and sqrt(3): the flow restricted to the first
/// mode is its exact backbone (normal modes have rational coefficients), the rest is enclosed.
#[test]
fn irrational_modes() {
    let text = "x'' + 2*x - y + eps*x^3/2; y'' + 2*y - x";
    let found = flow(text, 3, &[]);
    let enclosed = found.enclosed.unwrap();
    assert!(0.0 < enclosed.radius && enclosed.radius < 1e-30, "{enclosed:?}");
    assert!(0.0 < enclosed.residual && enclosed.residual < 1e-25, "{enclosed:?}");
    assert_eq!(found.system.squares, [1, 3]);
    let residual = serde_json::json!({"checked_orders": 3, "zero": null, "encloses_zero": true});
    assert_eq!(serde_json::to_value(&found).unwrap()["residual"], residual);
    // Order 1 by hand: x = q_1 + q_2, q_j'' + nu_j^2 q_j + eps x^3/4, so that
    // f_2 = i/(8 sqrt 3) (3 z_2^2 zbar_2 + 6 z_1 zbar_1 z_2).
    let second = named(&found, &found.flow[1][1]);
    let root = 3f64.sqrt();
    let known = by_hand(&["3 i z2^2 zbar2", "6 i z1 zbar1 z2"]);
    assert_eq!(second.len(), 2);
    for (powers, [_, im]) in known {
        let [re, value] = &second[&powers];
        assert!(re.is_zero() && (value.to_f64() - im.to_f64() / (8.0 * root)).abs() < 1e-15);
    }
    // The backbone of the first mode, Omega^2 = 1 + 3/16 rho - 101/2048 rho^2 + ..., by exact orders.
    let mut omega = vec![1.0];
    for n in 1..=3 {
        let alone = |t: &&AmplitudeTerm| t.exponents[2] == 0 && t.exponents[3] == 0;
        let [term] = found.flow[0][n].iter().filter(alone).collect::<Vec<_>>()[..] else {
            panic!()
        };
        // i c z |z|^(2n), |z|^2 = rho/4.
        omega.push(term.im.to_f64() / 4f64.powi(n as i32));
    }
    let square = |n: usize| (0..=n).map(|k| omega[k] * omega[n - k]).sum::<f64>();
    let expected = [3.0 / 16.0, -101.0 / 2048.0, 9365.0 / 786_432.0];
    for (n, expected) in (1..).zip(expected) {
        assert!((square(n) - expected).abs() < 1e-15, "{n}: {}", square(n));
    }
}

/// Two masses of which the frequencies are the golden ratio phi and 1/phi. Order 1 by hand: x = q_1 + q_2 with the shapes (1, phi)
/// and (1, -1/phi), q_j'' + nu_j^2 q_j + eps x^3/(2 |shape|^2), so that
/// f_j = i/(4 nu_j |shape_j|^2) (3 z_j^2 zbar_j + 6 z_k zbar_k z_j).
#[test]
fn golden_modes() {
    let found = flow("x'' + 2*x - y + eps*x^3/2; y'' + y - x", 3, &[]);
    let enclosed = found.enclosed.unwrap();
    assert!(0.0 < enclosed.radius && enclosed.radius < 1e-30, "{enclosed:?}");
    assert!(0.0 < enclosed.residual && enclosed.residual < 1e-25, "{enclosed:?}");
    assert_eq!(found.checked_orders, Some(3));
    let phi = (1.0 + 5f64.sqrt()) / 2.0;
    let shapes = found.print_shapes(Style::Text);
    assert!(shapes[0] == "x = q_1 + q_2" && shapes[1].starts_with("y = 1.61803398874989484820"));
    let known = [["3 i z1^2 zbar1", "6 i z2 zbar2 z1"], ["3 i z2^2 zbar2", "6 i z1 zbar1 z2"]];
    for (j, (nu, tip)) in [(1.0 / phi, phi), (phi, -1.0 / phi)].into_iter().enumerate() {
        assert!((found.system.frequencies[j].to_f64() - nu).abs() < 1e-15);
        let first = named(&found, &found.flow[j][1]);
        assert_eq!(first.len(), 2);
        for (powers, [_, im]) in by_hand(&known[j]) {
            let [re, value] = &first[&powers];
            let expected = im.to_f64() / (4.0 * nu * (1.0 + tip * tip));
            assert!(re.is_zero() && (value.to_f64() - expected).abs() < 1e-15, "{powers:?}");
        }
    }
}

/// Digits that are printed are certain: those of a root to as many as asked for (by Python's decimal), and none of a coefficient
/// that the radius covers.
#[test]
fn digits_of_enclosures() {
    let text = "equations = [\"x'' + 2*x - y + eps*x^3/2\", \"y'' + 2*y - x\"]";
    let problem = ProblemFile::parse(text).unwrap().problem;
    let settings = AveragingSettings { order: 1, digits: 100, ..AveragingSettings::default() };
    let found = slow_flow(&problem, &settings, Detuned::Beside, &mut |_| true).unwrap();
    let root = "1.73205080756887729352744634150587236694280525381038\
                0628055806979451933016908800037081146186757248576";
    assert_eq!(found.number(&found.system.frequencies[1]), root);
    assert_eq!(found.system.frequencies[0], 1);
    let small = flow("x'' + 2*x + eps*(x^3/10^60 - x^5/10^40 + cos(t))", 1, &[]);
    let [first, rest] =
        [Style::Text, Style::Latex].map(|style| small.print(&small.flow[0][1], style));
    // -10/(2 sqrt 2) = -3.5355339059327376...
    assert!(
        first.starts_with("(0 +- ") && first.contains("e-55)*i*z^2*zbar - 3.53553390593"),
        "{first}"
    );
    assert!(rest.starts_with(r"(0 \pm ") && rest.contains(r"\cdot 10^{-55})\,i\,z^{2}"), "{rest}");
    let digits = first.split("- ").last().unwrap().split("e-40").next().unwrap();
    assert!(
        (13..18).contains(&digits.len())
            && "3.53553390593273762".contains(&digits[..digits.len() - 1]),
        "{first}"
    );
}
