//! The numbers of the frequency before they are known.
//!
//! The step of the driver, followed in denominators and norms: f_n from the orders below; the amplitude a_(n-1) of a
//! limit cycle from 2<f_n sin>; W_n = -2<f_n cos>/a_0; x_n = sum f_(n,k)/(1 - k^2) and what brings it to rest.
//! With |f| = sum |f_k| this gives
//!
//!   |x_n| <= 2 |f_n|,   |x_n'| <= 2 |f_n|,   |x_n''| <= 3 |f_n|,   |a_(n-1)| <= |f_n|/|S|,   |W_n| <= |f_n|/a_0
//!
//! (for k != 1 the response has 1/|1 - k^2|, the cosine that makes u(0) = 0 as much, the sine for u'(0) = 0 k times
//! as much), and denominators follow the same steps: nothing of x_n need be known.

use super::ResidualBound;
use crate::size::{Size, convolution, sum};
use rug::float::Round;
use rug::{Float, Integer, Rational};

/// The numbers of the frequency: W_n, omega_n and T_n.
const SERIES: usize = 3;

/// What the numbers of the next order can be.
pub struct Expected {
    /// Twice each of W_n, omega_n and T_n times its denominator is below 2^this.
    pub bits: u64,
    sizes: [Option<Size>; SERIES],
    force: Option<Size>,
}

/// Denominators and sizes of W_n, omega_n and T_n in advance, order by order.
#[derive(Clone)]
pub struct FrequencyBound {
    bound: ResidualBound,
    inverse_amplitude: Size,
    /// 1/S for a limit cycle.
    reaction: Option<Size>,
}

impl FrequencyBound {
    /// For the leading amplitude a_0, and 1/S of a limit cycle ([`crate::amplitude_reaction`]); nothing where one
    /// of them is zero.
    pub fn new(
        mut bound: ResidualBound,
        amplitude: &Rational,
        reaction: Option<&Rational>,
    ) -> Option<Self> {
        let inverse = amplitude.clone().recip();
        let own = [amplitude, &inverse].into_iter().chain(reaction);
        bound.rebuild(&own.cloned().collect::<Vec<_>>());
        let number = |q: &Rational| bound.generators.number(q);
        let (mut leading, inverse_amplitude) = (number(amplitude)?, number(&inverse)?);
        let reaction = match reaction {
            Some(q) => Some(number(q)?),
            None => None,
        };
        leading.exponents[0] += 1;
        let unit = bound.sizes.unit.clone();
        bound.sizes.functions.iter_mut().for_each(|list| list.push(Some(leading.clone())));
        bound.sizes.series.iter_mut().for_each(|list| list.push(unit.clone()));
        bound.evaluate(0);
        Some(Self { bound, inverse_amplitude, reaction })
    }

    /// What the numbers of the next order can be.
    pub fn next_order(&mut self) -> Expected {
        let n = self.bound.sizes.series[0].len();
        let mut force = self.bound.right_side(n);
        if let (Some(reaction), Some(f)) = (self.reaction.as_ref().filter(|_| n > 1), &force) {
            // a_(n-1) cos psi.
            let mut shift = f.times(reaction);
            shift.exponents[0] += 1;
            for list in &mut self.bound.sizes.functions {
                match &mut list[n - 1] {
                    Some(size) => size.absorb(&shift),
                    none => *none = Some(shift.clone()),
                }
            }
            self.bound.evaluate(n - 1);
            force = self.bound.right_side(n);
        }
        let [_, frequency, period] = &self.bound.sizes.series;
        let squared = force.as_ref().map(|f| f.times(&self.inverse_amplitude));
        let range = || 1..=n.saturating_sub(1);
        let mut root = sum([squared.clone(), convolution(frequency, frequency, range(), n)]);
        // Half of it.
        root.iter_mut().for_each(|size| size.exponents[0] += 1);
        let inverse = sum([root.clone(), convolution(frequency, period, range(), n)]);
        let sizes = [squared, root, inverse];
        let generators = &self.bound.generators;
        let bits = sizes.iter().flatten().map(|size| generators.bits(size) + 2);
        Expected { bits: bits.max().unwrap_or(1), sizes, force }
    }

    /// A common denominator of each of W_n, omega_n and T_n: proved, not guessed.
    pub fn denominators(&self, expected: &Expected) -> [Integer; SERIES] {
        let generators = &self.bound.generators;
        expected.sizes.each_ref().map(|size| {
            size.as_ref().map_or(Integer::from(1), |size| generators.product(&size.exponents))
        })
    }

    /// Takes W_n, omega_n and T_n, and the harmonics of x_n, which are those of f_n but for the first.
    pub fn take(&mut self, expected: Expected, numbers: [&Rational; SERIES], harmonics: &[usize]) {
        let known = [0, 1, 2].map(|i| {
            let number = self.bound.generators.number(numbers[i]);
            number.or_else(|| expected.sizes[i].clone().filter(|_| !numbers[i].is_zero()))
        });
        self.push(expected.force, known, harmonics);
    }

    /// The same where it is only known which of the numbers vanish: how the sizes will go on.
    pub fn suppose(&mut self, expected: Expected, vanish: [bool; SERIES], harmonics: &[usize]) {
        let mut sizes = expected.sizes;
        sizes.iter_mut().zip(vanish).filter(|(_, zero)| *zero).for_each(|(size, _)| *size = None);
        self.push(expected.force, sizes, harmonics);
    }

    fn push(&mut self, f: Option<Size>, series: [Option<Size>; SERIES], harmonics: &[usize]) {
        let n = self.bound.sizes.series[0].len();
        let bound = &mut self.bound;
        for (list, size) in bound.sizes.series.iter_mut().zip(series) {
            list.push(size);
        }
        let response = f.map(|mut size| {
            for (index, exponent) in size.exponents.iter_mut().enumerate() {
                let divisors = harmonics.iter().map(|&k| (k * k).abs_diff(1) as u64);
                let of = |divisor: u64| bound.generators.valuation(index, divisor);
                *exponent += divisors.filter(|d| *d > 0).map(of).max().unwrap_or(0);
            }
            size.exponents[0] += 1;
            size
        });
        for (list, factor) in bound.sizes.functions.iter_mut().zip([2, 2, 3]) {
            let scaled = response.clone().map(|mut size| {
                size.norm = Float::with_val_round(64, &size.norm * factor, Round::Up).0;
                size
            });
            list.push(scaled);
        }
        bound.evaluate(n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Binding, Request, amplitude_reaction, compile, expand};
    use lindstedt_algebra::Rationals;
    use lindstedt_equation::{Condition, Expression};
    use lindstedt_phase::Trigonometric;

    struct NoNames;

    impl Binding<Rationals> for NoNames {
        fn parameter(&self, _: &str) -> Option<Rational> {
            None
        }
    }

    /// Two cycles: denominators and norms of x_n, x_n' and x_n'', with the amplitude that the order
    /// after gives, hold what the driver over Q finds; and they are no larger than some bits per order.
    #[test]
    fn sizes_hold_what_the_driver_finds() {
        let (x, v) = (|| Expression::DISPLACEMENT, || Expression::VELOCITY);
        let small = || Expression::Small;
        holds(small() * (x().pow(2) - 1) * v());
        // a_1 alone has the factor 1/5.
        let stronger = small() * 5 * (x().pow(2) - 1) * v();
        holds(stronger + small().pow(2) * v());
    }

    fn holds(damping: Expression) {
        const ORDER: usize = 9;
        let (algebra, x) = (Trigonometric::new(Rationals), || Expression::DISPLACEMENT);
        let equation = (Expression::ACCELERATION + x() + damping).canonical();
        let equation = compile(&algebra, &equation, &NoNames, ORDER).unwrap();
        let amplitude = Rational::from(2);
        let condition = Condition::LimitCycle;
        let request = Request { condition, order: ORDER, leading_amplitude: amplitude.clone() };
        let found = expand(&algebra, &equation, &request, &mut |_| true).unwrap();
        let reaction = amplitude_reaction(&algebra, &equation, &request).unwrap();
        let one = Rational::from(1);
        let bound = ResidualBound::new(&equation, &one, 2 * ORDER + 1, true).unwrap();
        let mut ahead = FrequencyBound::new(bound, &amplitude, reaction.as_ref()).unwrap();
        for n in 1..=ORDER {
            let expected = ahead.next_order();
            // Complete with the amplitude.
            let last = &found.solution[n - 1];
            let own = last.cos.iter().enumerate().chain(last.sin.iter().enumerate());
            let own: Vec<(usize, &Rational)> = own.filter(|(_, c)| !c.is_zero()).collect();
            for (power, list) in ahead.bound.sizes.functions.iter().enumerate() {
                let size = list[n - 1].as_ref().unwrap();
                let denominator = ahead.bound.generators.product(&size.exponents);
                let mut norm = Rational::new();
                for (k, c) in &own {
                    // Of z^k, k > 0, it is half of that of cos or sin.
                    let parts: u32 = if *k > 0 { 2 } else { 1 };
                    let half = Rational::from(*c * &denominator) / parts;
                    assert!(half.is_integer(), "{n} {power} {k}");
                    norm += Rational::from(c.abs_ref()) * k.pow(power as u32);
                }
                let (norm, most) = (norm.to_f64(), size.norm.to_f64());
                assert!(norm <= most, "{n} {power} {norm} {most}");
                assert!(most < 16384f64.powi(n as i32) * norm, "{n} {power} {norm} {most}");
            }
            let x = &found.solution[n];
            let all = x.cos.iter().enumerate().chain(x.sin.iter().enumerate());
            let harmonics: Vec<usize> = all.filter(|(_, c)| !c.is_zero()).map(|(k, _)| k).collect();
            let squared = &found.frequency_squared[n];
            assert!(Rational::from(squared * &ahead.denominators(&expected)[0]).is_integer());
            ahead.suppose(expected, [squared.is_zero(); 3], &harmonics);
        }
    }
}
