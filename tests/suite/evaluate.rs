//! Values from expansions: the table of powers from one expansion, the pendulum, van der Pol,
//! estimates never below the true error, refusals, problem files, averaged motions. Reference numbers: mpmath 1.3.0 (gamma
//! functions, elliptic integrals, Taylor integration of the limit cycle).

use lindstedt::{Evaluate, Oscillator, Refusal, Work};

mod averaged;
mod closed_forms;
mod compiled;
mod files;
mod support;

/// A series in eps has eps^9 twice up to order 24, and eps^20 not at all up to order 12: with their values in the factors the
/// errors are those of the truth (periods from an integrator, DOP853, and from proofs of the orbits).
#[test]
fn terms_of_high_powers_are_in_the_errors() {
    let cases = [
        ("x'' + x + eps*x^3/10 + 50*eps^9*x^5 = 0", "1/2", None, 5.996_673_954_51),
        ("x'' + x + eps*x^3/10 + 50*eps^9*x^5 = 0", "1/2", Some(8), 5.996_673_954_51),
        ("x'' + x - eps*x^5 + 30*eps^8*x*x'^2 = 0", "-1/2", None, 5.413_345_753_19),
        ("x'' + x + eps*x^3/10 + 50*eps^20*x^5 = 0", "4/5", Some(12), 5.294_344_069_43),
        ("x'' + x + eps*x^5/10 + 10*eps^7*x^3 = 0", "1", Some(20), 2.184_249_150_05),
        // Duffing's equation with 81/256 in the place of eps.
        ("x'' + x + (3*eps/2)^4*x^3 = 0", "1/2", None, 5.652_947_756_47),
        ("x'' + x + eps*(x^2-1)*x' - 10*eps^3*x^3 = 0", "1/4", Some(16), 9.245_666_837_93),
        ("x'' + x + eps*x^3/10 + 50*(eps+eps^2)^9*x^5 = 0", "2/5", Some(8), 5.745_074_502_457),
        ("x'' + x + eps*x^3/10 + 50*(eps^2+eps^3)^10*x^5 = 0", "3/5", Some(12), 5.812_622_221_658),
        ("x'' + x + eps*x^3/10 + (2*eps*x + eps*x^3)^9 = 0", "2/5", None, 3.878_929_884_270),
    ];
    for (equation, eps, order, truth) in cases {
        let case = Oscillator::parse(equation).unwrap().set("eps", eps).unwrap();
        let question = Evaluate { order, ..Evaluate::default() };
        let work = Work { digits: 11, ..Work::default() };
        let answer = case.evaluate(&question, &work).unwrap();
        let period = answer.value.period.unwrap();
        let error: f64 = period.error.as_deref().unwrap_or("0").parse().unwrap();
        let off = (period.decimal.parse::<f64>().unwrap() - truth).abs();
        assert!(off <= error + 1e-11 && error < 1e-4, "{equation}: off by {off:e}, +- {error:e}");
        assert!(answer.remarks.iter().any(|remark| remark.0.contains("stands as eps times")));
        let irrational = case.clone().set("eps", "pi/6").unwrap().evaluate(&question, &work);
        assert_eq!(irrational.map(drop).unwrap_err().code(), "high-power");
        let function = case.frequency_function(&question, &work).map(drop).unwrap_err();
        assert_eq!(function.code(), "high-power");
    }
}
