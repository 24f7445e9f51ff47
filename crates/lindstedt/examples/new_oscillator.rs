//! An oscillator of your own: Rayleigh's equation, its limit cycle to order 6, judged twice.

use lindstedt::{Error, Evaluate, Oscillator, Quantity, Verify, Work};

fn main() -> Result<(), Error> {
    let oscillator = Oscillator::parse("x'' + x = eps*(x' - x'^3/3)")?;
    let rayleigh = oscillator.derive(6, &Work::default())?.value;
    for n in 0..=rayleigh.order {
        let coefficient = rayleigh.exact(Quantity::Frequency, n).ok_or(Error::NoValue)?;
        println!("frequency, coefficient of eps^{n}: {coefficient}");
    }
    let checked = rayleigh.checked_orders.ok_or(Error::NoValue)?;
    println!("substituted into the equation: vanishes identically at orders 0 to {checked}");

    // At a value: the series of the period, summed, with its estimated error.
    let value = oscillator.clone().set("eps", "1/2")?;
    let period = value.evaluate(&Evaluate::default(), &Work::default())?.value.period;
    let period = period.ok_or(Error::NoValue)?;
    let error = period.error.unwrap_or_default();
    println!("period at eps = 1/2: {} +- {error}", period.decimal);

    let judge =
        oscillator.verify_derivation(&rayleigh, &Verify::default(), &Work::default())?.value;
    let observed = judge.observed_order.ok_or(Error::NoValue)?;
    println!("against the motion in time: {:?}, observed order {observed:.2}", judge.verdict);
    Ok(())
}
