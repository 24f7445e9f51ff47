//! The misprints of section 3 are found by comparison.

use lindstedt_paper::{Verdict, printed_forms};

/// Independent values, by quadrature to 26 digits.
#[test]
fn printed_forms_and_their_values() {
    let list = printed_forms().unwrap();
    let value = |printed: &str| {
        let line = list.iter().find(|c| c.printed.replace('$', "").contains(printed)).unwrap();
        (line.printed_value, line.derived_value, line.findings.verdict())
    };
    let close = |x: Option<f64>, y: f64| (x.unwrap() - y).abs() < 6e-6;
    let (printed, derived, verdict) = value("gamma sin t0");
    assert!((derived + 1.395_291_980_329_284_8).abs() < 1e-14);
    assert!(close(printed, -1.18385) && verdict == Verdict::Misprint);
    let (printed, _, verdict) = value("no term beta");
    assert!(close(printed, -1.25690) && verdict == Verdict::Misprint);
    for (form, expected) in
        [("a^4/sqrt", -1.57520), ("a^2/sqrt", -1.28743), ("sin(sech tanh", -1.08077)]
    {
        let (printed, _, verdict) = value(form);
        assert!(close(printed, expected), "{form}: {printed:?}");
        assert_eq!(verdict, Verdict::Misprint);
    }
    for form in ["second root", "first branch for all"] {
        let (printed, _, verdict) = value(form);
        assert!(printed.is_none() && verdict == Verdict::Misprint, "{form}");
    }
    let (printed, derived, verdict) = value("2 T0 a");
    assert!(
        close(printed, 0.750838)
            && (derived - 0.558270457).abs() < 1e-9
            && verdict == Verdict::Misprint
    );
    let verdicts = |form: &str| value(form).2;
    for form in ["M(t0) = int", "at t = -0.7"] {
        assert_eq!(verdicts(form), Verdict::Agrees, "{form}");
    }
    assert_eq!(verdicts("without a modulus"), Verdict::Wrong);
    for form in ["at t = 0.7", "sech(sqrt a) tanh"] {
        assert_eq!(verdicts(form), Verdict::Misprint, "{form}");
    }
}
