//! What is refused for its size, and what is printed of what is large.

use lindstedt_coeff::print::Style;
use lindstedt_derivation::{DerivationError, Settings, Solution, derive};

/// Peaks of `lindstedt derive PROBLEM --order N --format json` (MB, `/usr/bin/time -v`, x86-64 Linux): predictions are
/// within a factor of two of them both ways.
#[test]
fn memory_is_predicted_within_a_factor_of_two() {
    let peaks: [(&str, &[(usize, f64)]); 8] = [
        ("duffing", &[(100, 23.8), (200, 55.5), (400, 225.2)]),
        ("van-der-pol", &[(40, 20.3), (80, 30.7), (120, 65.1), (164, 161.6)]),
        ("power-law", &[(8, 15.5), (12, 16.5), (16, 20.4), (20, 32.7), (30, 317.0)]),
        ("pendulum", &[(8, 18.9), (10, 26.8), (12, 58.3), (16, 486.3)]),
        // As text, which counts long functions.
        ("duffing", &[(200, 47.4), (400, 142.4)]),
        ("van-der-pol", &[(120, 46.8), (164, 78.1)]),
        ("power-law", &[(8, 15.6), (12, 16.8), (16, 19.0), (20, 25.8), (30, 114.0)]),
        ("pendulum", &[(8, 20.0), (10, 27.8), (12, 59.3), (16, 460.1)]),
    ];
    for (name, list) in peaks {
        let problem = lindstedt_problems::find(name).expect("a built-in problem");
        for &(order, measured) in list {
            let refused = |factor: f64| {
                let memory = (measured * factor * 1e6) as u64;
                let settings = Settings { order, memory, ..Settings::default() };
                // What is not refused ends after the first order.
                let outcome = derive(&problem, &settings, &mut |_| false);
                matches!(outcome, Err(DerivationError::TooLarge { .. }))
            };
            // Refused is only what needs more than twice the limit, and all that needs eight times as much.
            assert!(refused(0.125) && !refused(0.5), "{name} {order}: {measured} MB");
        }
    }
}

#[test]
fn long_right_sides_are_not_formed() -> Result<(), DerivationError> {
    let Some(problem) = lindstedt_problems::find("power-law") else { return Ok(()) };
    let settings = Settings { order: 5, ..Settings::default() };
    let derivation = derive(&problem, &settings, &mut |_| true)?;
    assert!(matches!(derivation.solution, Solution::Clock(_)));
    let styles = [Style::Text, Style::Latex];
    for n in 0..=5 {
        let [short, long] = [5, 100].map(|most| derivation.print_right_side(n, styles, most));
        // Formed where x_n is not much longer than what is printed, and then it is that of the expansion.
        assert_eq!(short.is_some(), derivation.terms(n) <= 10, "order {n}");
        assert!(long.is_some(), "order {n}");
        let Some(([text, latex], terms)) = long else { continue };
        assert!(n == 0 || terms > 0 && !text.is_empty() && !latex.is_empty(), "order {n}");
        assert!(short.is_none_or(|(_, same)| same == terms));
    }
    assert!(derivation.terms(5) > 10);
    Ok(())
}
