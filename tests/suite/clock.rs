//! The route by one clock: chosen by the equation, equal to the driver's, an order at a time.

use lindstedt::{Derivation, Derive, Error, Oscillator, Refusal, Route, Solution, Work};

fn derived(equation: &str, order: usize, route: Route) -> Result<Derivation, Error> {
    let oscillator = match equation.contains('=') {
        true => Oscillator::parse(equation),
        false => Oscillator::builtin(equation),
    };
    Ok(oscillator?.derive(Derive { order, route }, &Work::default())?.value)
}

/// Every function and every coefficient of every series.
fn assert_same(clock: &Derivation, driver: &Derivation) {
    assert_eq!([clock.route, driver.route], [Route::Clock, Route::Driver]);
    assert_eq!([clock.checked_orders, driver.checked_orders], [Some(clock.order); 2]);
    let (Solution::Clock(a), Solution::Lobachevsky(b)) = (&clock.solution, &driver.solution) else {
        panic!("both in the Lobachevsky ring")
    };
    let counted = a.terms().to_vec();
    let a = a.expansion();
    assert_eq!(counted, a.solution.iter().map(|x| x.len()).collect::<Vec<_>>());
    for n in 0..=clock.order {
        assert_eq!(a.solution[n], b.solution[n], "order {n}");
        assert_eq!(a.frequency_squared[n], b.frequency_squared[n], "order {n}");
        assert_eq!(a.work.get(n).map(|work| work.terms), b.work.get(n).map(|work| work.terms));
    }
    assert_eq!(
        [&a.amplitude, &[a.stiffness.clone()].to_vec()],
        [&b.amplitude, &vec![b.stiffness.clone()]]
    );
    assert_eq!(clock.series.len(), driver.series.len());
    for (a, b) in clock.series.iter().zip(&driver.series) {
        assert_eq!(
            (a.quantity, a.half_power, &a.coefficients),
            (b.quantity, b.half_power, &b.coefficients)
        );
    }
}

#[test]
fn the_driver_finds_the_same() {
    let other = "x'' + 3*x + eps*x^3*ln(x^2) + eps^2*x^5 = 0";
    for (equation, order) in [("power-law", 10), ("pendulum", 8), (other, 5)] {
        let clock = derived(equation, order, Route::Automatic).unwrap();
        assert_same(&clock, &derived(equation, order, Route::Driver).unwrap());
    }
}

#[test]
fn the_equation_decides_and_not_its_name() {
    let written = derived("x'' + x*(x^2)^eps = 0", 6, Route::Automatic).unwrap();
    let built_in = derived("power-law", 6, Route::Clock).unwrap();
    assert_eq!([written.route, built_in.route], [Route::Clock; 2]);
    for n in 0..=6 {
        let style = lindstedt::unstable::coeff::print::Style::Text;
        assert_eq!(written.print_solution(n, style), built_in.print_solution(n, style));
    }
    let duffing = "x'' + x + eps*x^3 = 0";
    assert_eq!(derived(duffing, 3, Route::Automatic).unwrap().route, Route::Driver);
    let refused = derived(duffing, 3, Route::Clock).err();
    assert_eq!(refused.map(|error| error.code()), Some("no-such-route"));
}
