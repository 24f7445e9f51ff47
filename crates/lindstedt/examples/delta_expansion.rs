//! The small-delta expansion of x'' + x (x^2)^delta = 0 to order 8, and what it says about x^3.

use lindstedt::{Error, Evaluate, Oscillator, Quantity, Work};

fn main() -> Result<(), Error> {
    let power_law = Oscillator::builtin("power-law")?;
    let result = power_law.derive(8, &Work::default())?.value;

    for n in 0..=3 {
        let number = result.number(Quantity::Period, n, 30)?;
        println!("T/2pi, delta^{n}: {} = {}", number.exact.unwrap_or_default(), number.decimal);
    }
    println!("T/2pi, delta^8: {}", result.number(Quantity::Period, 8, 30)?.decimal);
    println!("residual zero to order {}", result.checked_orders.ok_or(Error::NoValue)?);

    // delta = 1 is the default: x'' + x^3 = 0, on the circle of convergence.
    let question = Evaluate { order: Some(20), ..Evaluate::default() };
    let value = power_law.evaluate(&question, &Work::default())?.value;
    let (sum, exact) = (value.period.ok_or(Error::NoValue)?, value.exact_period);
    println!("period of x'' + x^3 = 0: {} +- {}", sum.decimal, sum.error.unwrap_or_default());
    println!("closed form:             {}", exact.ok_or(Error::NoValue)?.decimal);
    Ok(())
}
