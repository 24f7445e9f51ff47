//! The series of the frequency alone: nothing else is lifted.
//!
//! Before any number is known, denominators and norms are followed through the recurrence
//! ([`FrequencyBound`]): D W_n is an integer below B. Modulo each of some primes whose product exceeds 2 D B the
//! equation has one solution, which is the image; so W_n is the representative of least absolute value, over D. That
//! a harmonic of x_n vanishes, which shortens the denominators of later orders, follows in the same way. One image is
//! substituted into the equation in full and takes no part; the others are substituted at three random phases each,
//! where an image that is wrong passes with a chance below 2^-50: one of M images with a chance below M 2^-50.

use crate::image::Job;
use crate::images::Images;
use crate::lift::Remaindering;
use crate::{Error, RationalBinding, Setting, images_for};
use lindstedt_algebra::{RationalAlgebra, Stop};
use lindstedt_equation::{Condition, Expression};
use lindstedt_expand::{ExpandError, Expected, FrequencyBound};
use lindstedt_phase::modular::{LANES, PrimeFields};
use rug::Rational;

/// So many images are made on every core between two reports.
const BATCH: usize = LANES / 2;

/// The frequency to some order, from images that were checked and bounds that are proved, and what it took.
#[derive(Clone, Debug)]
pub struct BoundedFrequency {
    /// kappa.
    pub stiffness: Rational,
    /// W_n of omega^2 = kappa sum W_n eps^n.
    pub squared: Vec<Rational>,
    /// omega_n of omega/sqrt(kappa).
    pub frequency: Vec<Rational>,
    /// T_n of sqrt(kappa) T/2pi.
    pub period: Vec<Rational>,
    /// The number of primes that determine it.
    pub primes: usize,
}

/// Derives the series of the frequency of a polynomial equation over Q, for n = 0, ..., `order`: exact, but for a wrong
/// image that passes with a chance below 2^-50, of M primes with a chance below M 2^-50.
///
/// The same numbers as [`crate::derive`], without the solution: no memory for it, no residual modulo every prime.
///
/// Cost: O(N^3) products modulo every prime, half of those of [`crate::derive`], and B/30 primes where a bound of the
/// numbers has B bits (for van der Pol's equation 0.7 N^2). Memory: the functions of one prime per core, and N numbers
/// per prime.
///
/// # Errors
/// Those of [`crate::derive`].
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Stop};
/// use lindstedt_multimodular::{RationalBinding, frequency};
/// use rug::Rational;
///
/// struct NoNames;
/// impl RationalBinding for NoNames {
///     fn parameter(&self, _: &str) -> Option<Rational> { None }
/// }
/// let cycle = lindstedt_problems::find("van-der-pol").ok_or("no such problem")?;
/// let (equation, condition) = (&cycle.equation, cycle.conditions[0]);
/// let found = frequency(equation, &NoNames, condition, 4, &Stop::default(), &mut |_| true)?;
/// assert_eq!(found.frequency[2], Rational::from((-1, 16)));
/// assert_eq!(found.frequency[4], Rational::from((17, 3072)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn frequency(
    equation: &Expression,
    binding: &dyn RationalBinding,
    condition: Condition,
    order: usize,
    stop: &Stop,
    observer: &mut dyn FnMut(usize) -> bool,
) -> Result<BoundedFrequency, Error> {
    let setting = Setting::new(equation, binding, condition, order, stop)?;
    let (bound, reaction) = (setting.bound.clone(), setting.reaction.as_ref());
    let amplitude = &setting.job.request.leading_amplitude;
    let bound = FrequencyBound::new(bound, amplitude, reaction);
    let bound = bound.ok_or(ExpandError::DegenerateLimitCycle)?;
    let mut images = Images::new(&setting.job, setting.primes());
    let job = &setting.job;
    images.more(1, &|field| job.image(field, &[]), observer)?;
    let needed = foresee(bound.clone(), &images);
    let missing = images_for(needed);
    let batch = BATCH * rayon::current_num_threads();
    for done in (0..missing).step_by(batch) {
        images.more(batch.min(missing - done), &|field| job.brief_image(field), observer)?;
    }
    Lifting { images, bound, job }.climb(observer)
}

/// The bits that the orders will need if the numbers that vanish in the first image do.
fn foresee<P: Iterator<Item = PrimeFields>>(
    mut bound: FrequencyBound,
    images: &Images<'_, P>,
) -> u64 {
    let Some(judge) = images.list.first() else { return 0 };
    let mut most = 0;
    for n in 1..=images.job.request.order {
        let expected = bound.next_order();
        most = most.max(expected.bits);
        let value = |index: usize| judge.values(n).get(index).is_none_or(|c| *c == 0);
        bound.suppose(expected, [0, 1, 2].map(value), &judge.harmonics(n));
    }
    most
}

struct Lifting<'a, P> {
    images: Images<'a, P>,
    bound: FrequencyBound,
    job: &'a Job<'a>,
}

impl<P: Iterator<Item = PrimeFields>> Lifting<'_, P> {
    fn climb(mut self, observer: &mut dyn FnMut(usize) -> bool) -> Result<BoundedFrequency, Error> {
        let mut series = [const { Vec::new() }; 3];
        series.iter_mut().for_each(|list| list.push(Rational::from(1)));
        let mut remaindering = Remaindering::new(&[]);
        let mut primes = 0;
        for n in 1..=self.job.request.order {
            self.job.go_on()?;
            let expected = self.bound.next_order();
            self.prepare(&mut remaindering, expected.bits, observer)?;
            primes = primes.max(remaindering.primes());
            let numbers = self.numbers(&remaindering, n, &expected)?;
            let harmonics = self.images.list[0].harmonics(n);
            self.bound.take(expected, numbers.each_ref(), &harmonics);
            for (list, number) in series.iter_mut().zip(numbers) {
                list.push(number);
            }
        }
        let [squared, frequency, period] = series;
        let stiffness = self.job.stiffness.clone();
        Ok(BoundedFrequency { stiffness, squared, frequency, period, primes })
    }

    /// Primes for so many bits, and not many more.
    fn prepare(
        &mut self,
        remaindering: &mut Remaindering,
        bits: u64,
        observer: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), Error> {
        if (bits..=bits + bits / 16 + 256).contains(&remaindering.bits()) {
            return Ok(());
        }
        let (own, job) = (images_for(bits), self.job);
        let missing = (own + 1).saturating_sub(self.images.list.len());
        self.images.more(missing, &|field| job.brief_image(field), observer)?;
        let last = (1 + own + own / 32).min(self.images.list.len());
        *remaindering = Remaindering::new(&self.images.list[1..last]);
        Ok(())
    }

    /// W_n, omega_n and T_n, held against the image that has no part in them.
    fn numbers(
        &self,
        remaindering: &Remaindering,
        n: usize,
        expected: &Expected,
    ) -> Result<[Rational; 3], Error> {
        let judge = &self.images.list[0];
        let number = |index: usize| {
            let denominator = &expected.denominators[index];
            let numerator = remaindering.numerator(&self.images.list[1..], n, index, denominator);
            let number = Rational::from((numerator, denominator.clone()));
            let agrees = judge.ring.rational(&number) == judge.values(n)[index];
            agrees.then_some(number).ok_or(ExpandError::Residual { order: n })
        };
        Ok([number(0)?, number(1)?, number(2)?])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

    use super::*;
    use crate::derive;
    use crate::place::Place;
    use crate::tests::{NoNames, broken, equations, places, van_der_pol, with_groups, with_images};
    use lindstedt_algebra::Ring;

    /// Another bound and another proof give the numbers of the whole expansion, for every form of equation.
    #[test]
    fn agrees_with_the_whole_expansion() {
        let stop = Stop::default();
        for (index, (equation, conditions)) in equations().into_iter().enumerate() {
            let equation = equation.canonical();
            for condition in conditions {
                for order in [0, 1, 2, 9] {
                    let all = &mut |_: usize| true;
                    let whole = derive(&equation, &NoNames, condition, order, &stop, all);
                    let alone = frequency(&equation, &NoNames, condition, order, &stop, all);
                    match (alone, whole) {
                        (Ok(alone), Ok(whole)) => {
                            let place = format!("{index} {condition:?} {order}");
                            assert_eq!(alone.stiffness, whole.stiffness, "{place}");
                            let squared = whole.squared;
                            assert_eq!(alone.squared, squared, "{place}");
                            assert_eq!(alone.frequency, whole.frequency, "{place}");
                            assert_eq!(alone.period, whole.period, "{place}");
                        }
                        (Err(a), Err(b)) => assert_eq!(a, b, "{index}"),
                        (a, b) => panic!("{index} {condition:?} {order}: {a:?} {b:?}"),
                    }
                }
            }
        }
    }

    /// Every number is a numerator over the denominator that was known in advance, and below the bound; the bound
    /// costs few primes more than the proof of the whole expansion.
    #[test]
    fn bounds_hold_and_are_sharp() {
        let (equation, stop, order) = (van_der_pol(), Stop::default(), 24);
        let cycle = Condition::LimitCycle;
        let setting = Setting::new(&equation, &NoNames, cycle, order, &stop).unwrap();
        let whole = derive(&equation, &NoNames, cycle, order, &stop, &mut |_| true).unwrap();
        let reaction = setting.reaction.as_ref();
        let amplitude = Rational::from(2);
        let mut bound = FrequencyBound::new(setting.bound.clone(), &amplitude, reaction).unwrap();
        let mut longest = 0;
        for n in 1..=order {
            let expected = bound.next_order();
            let numbers = [&whole.squared, &whole.frequency, &whole.period].map(|s| &s[n]);
            for (number, denominator) in numbers.iter().zip(&expected.denominators) {
                let numerator = Rational::from(*number * denominator);
                assert!(numerator.is_integer(), "{n}");
                let bits = u64::from(numerator.numer().significant_bits());
                assert!(bits < expected.bits, "{n}: {bits} {}", expected.bits);
                longest = longest.max(bits);
            }
            let x = whole.solution[n].polynomial();
            let harmonics = |list: &[Rational]| {
                list.iter().enumerate().filter(|(_, c)| !c.is_zero()).map(|(k, _)| k).collect()
            };
            let (mut all, sines): (Vec<usize>, Vec<usize>) = (harmonics(&x.cos), harmonics(&x.sin));
            all.extend(sines);
            bound.take(expected, numbers, &all);
        }
        let alone = frequency(&equation, &NoNames, cycle, order, &stop, &mut |_| true).unwrap();
        let least = (longest / 30) as usize;
        assert!((least..=2 * least).contains(&alone.primes), "{} {least}", alone.primes);
        // The norms cost some ten bits per order.
        assert!(alone.primes * 3 <= whole.primes * 5, "{} {}", alone.primes, whole.primes);
    }

    /// Every single number of an image, changed modulo a prime: some phases are enough to refuse it.
    #[test]
    fn a_broken_image_is_refused_at_some_phases() {
        with_groups(1, |job, groups| {
            let (fields, images) = &groups[0];
            let (algebra, equation) = job.over(*fields).unwrap();
            assert_eq!(job.check_at_phase(&algebra, &equation, images), Ok(()));
            for (variant, (n, place)) in places(&images[0]).into_iter().enumerate() {
                let broken = broken(images, n, place, variant);
                let answer = job.check_at_phase(&algebra, &equation, &broken);
                // The amplitude of the last order shows in the order after it.
                let last = n == job.request.order && place == Place::Cosine(1);
                assert_eq!(answer.is_err(), !last, "{n} {place:?}: {answer:?}");
            }
        });
    }

    /// What the judge does not have is no frequency.
    #[test]
    fn the_judge_refuses() {
        with_images(6, |job, mut images| {
            let ring = images[0].ring;
            images[0].change(4, Place::Squared, |value| ring.add(&value, &ring.one()));
            let stop = Stop::default();
            let setting =
                Setting::new(job.equation, &NoNames, Condition::LimitCycle, 6, &stop).unwrap();
            let reaction = setting.reaction.as_ref();
            let bound =
                FrequencyBound::new(setting.bound.clone(), &Rational::from(2), reaction).unwrap();
            let mut list = Images::new(&setting.job, setting.primes());
            list.list = images;
            let found = Lifting { images: list, bound, job: &setting.job }.climb(&mut |_| true);
            assert_eq!(found.unwrap_err(), ExpandError::Residual { order: 4 }.into());
        });
    }
}
