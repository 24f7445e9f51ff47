//! The series of the frequency alone: nothing else is lifted.
//!
//! Before any number is known, denominators and norms are followed through the recurrence
//! ([`FrequencyBound`]): D W_n is an integer below B. Modulo each of some primes whose product exceeds 2 D B the
//! equation has one solution, which is the image; so W_n is the representative of least absolute value, over D. Which
//! harmonics x_n can have, whose divisors make the denominators of later orders, follows from degrees and parity
//! ([`Degrees`]).
//!
//! An image has half as many points as its functions have harmonics: the first harmonic, and so the frequency, is not
//! reached by what they mix up (`Job::check_trace`). All that was formed modulo a prime is held against its operands at
//! three numbers in the place of eps, where an image that is wrong passes with a chance below (N/2^28)^3. One image more, of all harmonics, is substituted into the equation in full and takes no part.

use crate::image::{Image, Job};
use crate::images::Images;
use crate::lift::Remaindering;
use crate::{Error, Names, Setting};
use lindstedt_algebra::{RationalAlgebra, Stop};
use lindstedt_equation::{Condition, Expression};
use lindstedt_expand::{Degrees, ExpandError, Expected, FrequencyBound};
use lindstedt_phase::Modular;
use lindstedt_phase::modular::{LANES, PrimeFields};
use rug::Rational;

/// So many images are made on every core between two reports.
const BATCH: usize = 4 * (LANES / 2);

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
    /// What it was lifted from.
    pub images: CheckedImages,
}

/// Images of a frequency, modulo primes whose product is more than its numbers can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckedImages {
    /// The number M of primes.
    pub primes: usize,
    /// That one of the images is wrong and passes its check has a chance below this, M (N/2^28)^3: errors that know nothing of
    /// the three numbers agree at one of them with a chance of N/p, and every p is above 2^28.
    pub chance: f64,
}

impl CheckedImages {
    fn new(primes: usize, order: usize) -> Self {
        let once = order as f64 / 2f64.powi(28);
        Self { primes, chance: primes as f64 * once.powi(3) }
    }
}

/// Derives the series of the frequency of a polynomial equation over Q, for n = 0, ..., `order`: exact, but for a wrong
/// image that passes, with a chance that [`CheckedImages`] states.
///
/// The same numbers as [`crate::derive`], without the solution: no memory for it, no residual modulo every prime.
///
/// Cost: O(N^3) products modulo every prime, a quarter of those of [`crate::derive`], and B/30 primes where a bound of the
/// numbers has B bits (for van der Pol's equation 0.7 N^2). Memory: the functions of one prime per core, and N numbers
/// per prime.
///
/// # Errors
/// Those of [`crate::derive`].
///
/// ```
/// use lindstedt_algebra::{RationalAlgebra, Stop};
/// use lindstedt_multimodular::frequency;
/// use rug::Rational;
///
/// let cycle = lindstedt_problems::find("van-der-pol").ok_or("no such problem")?;
/// let (equation, condition) = (&cycle.equation, cycle.conditions[0]);
/// let found = frequency(equation, &|_| None, condition, 4, &Stop::default(), &mut |_| true)?;
/// assert_eq!(found.frequency[2], Rational::from((-1, 16)));
/// assert_eq!(found.frequency[4], Rational::from((17, 3072)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn frequency(
    equation: &Expression,
    binding: &Names<'_>,
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
    let mut judges = Images::new(&setting.job, setting.primes(setting.roots));
    judges.more(1, &|field| setting.job.image(field, &[]), observer)?;
    let judge = judges.list.swap_remove(0);
    for (order, degrees) in setting.degrees.iter().enumerate() {
        let allowed = |k: &usize| degrees[k % 2].is_some_and(|last| *k <= last);
        if !judge.harmonics(order).iter().all(allowed) {
            return Err(ExpandError::Residual { order }.into());
        }
    }
    // The initial amplitude is the sum of all harmonics.
    let (points, roots) = match condition {
        Condition::InitialAmplitude => (setting.job.points, setting.roots),
        _ => Modular::points_for_first_harmonic(setting.degree),
    };
    let job = Job { points, ..setting.job.clone() };
    let own = judge.ring.primes();
    let apart = |fields: &PrimeFields| !fields.primes().iter().any(|prime| own.contains(prime));
    let mut images = Images::new(&job, setting.primes(roots).filter(apart));
    images.list.push(judge.brief());
    Lifting { images, bound, degrees: &setting.degrees }.climb(observer)
}

/// The harmonics that x_n can have.
fn harmonics(degrees: &Degrees) -> Vec<usize> {
    let of = |odd: usize| degrees[odd].into_iter().flat_map(move |last| (odd..=last).step_by(2));
    (0..2).flat_map(of).collect()
}

struct Lifting<'a, P> {
    images: Images<'a, P>,
    bound: FrequencyBound,
    degrees: &'a [Degrees],
}

impl<P: Iterator<Item = PrimeFields>> Lifting<'_, P> {
    fn climb(mut self, observer: &mut dyn FnMut(usize) -> bool) -> Result<BoundedFrequency, Error> {
        let mut series = [const { Vec::new() }; 3];
        series.iter_mut().for_each(|list| list.push(Rational::from(1)));
        let needed = self.foresee();
        self.more(needed, observer)?;
        let mut remaindering = Remaindering::new(&[]);
        let mut primes = 0;
        let job = self.images.job;
        for n in 1..=job.request.order {
            job.go_on()?;
            let expected = self.bound.next_order();
            self.prepare(&mut remaindering, expected.bits, observer)?;
            primes = primes.max(remaindering.primes());
            let numbers = self.numbers(&remaindering, n, &expected)?;
            self.bound.take(expected, numbers.each_ref(), &harmonics(&self.degrees[n]));
            for (list, number) in series.iter_mut().zip(numbers) {
                list.push(number);
            }
        }
        let [squared, frequency, period] = series;
        let stiffness = job.stiffness.clone();
        let images = CheckedImages::new(primes, job.request.order);
        Ok(BoundedFrequency { stiffness, squared, frequency, period, images })
    }

    /// The bits that the orders will need if the numbers that vanish in the image that judges do.
    fn foresee(&self) -> u64 {
        let (mut bound, mut most) = (self.bound.clone(), 0);
        for (n, degrees) in self.degrees.iter().enumerate().skip(1) {
            let expected = bound.next_order();
            most = most.max(expected.bits);
            let value = |index: usize| self.images.list[0].values(n)[index] == 0;
            bound.suppose(expected, [0, 1, 2].map(value), &harmonics(degrees));
        }
        most
    }

    /// How many images have so many bits together, besides the one that judges.
    fn images_for(&self, bits: u64) -> Option<usize> {
        let mut have = 0.0;
        let enough = |image: &Image| {
            have += image.bits();
            // Not by the rounding of the logarithms.
            have > bits as f64 + 0.5
        };
        Some(self.images.list[1..].iter().position(enough)? + 1)
    }

    /// Images of so many bits together.
    fn more(&mut self, bits: u64, observer: &mut dyn FnMut(usize) -> bool) -> Result<(), Error> {
        let (job, degrees) = (self.images.job, self.degrees);
        let most = BATCH * rayon::current_num_threads();
        while self.images_for(bits).is_none() {
            let have: f64 = self.images.list[1..].iter().map(Image::bits).sum();
            let each = self.images.list.last().map_or(1.0, Image::bits);
            let missing = ((bits as f64 - have) / each) as usize + 1;
            self.images.more(
                missing.min(most),
                &|field| job.brief_image(field, degrees),
                observer,
            )?;
        }
        Ok(())
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
        self.more(bits, observer)?;
        let own = self.images_for(bits).unwrap_or(0);
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
        let denominators = self.bound.denominators(expected);
        let number = |index: usize| {
            let denominator = &denominators[index];
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
    use super::*;
    use crate::derive;
    use crate::place::Place;
    use crate::tests::{equations, van_der_pol, with_images};
    use lindstedt_algebra::Ring;
    use lindstedt_expand::{Equation, Request, Trace, trace};
    use lindstedt_phase::modular::{ModularElement, Residues};
    use lindstedt_series::Series;

    /// Another bound and another proof give the numbers of the whole expansion, for every form of equation.
    #[test]
    fn agrees_with_the_whole_expansion() {
        let stop = Stop::default();
        for (index, (equation, conditions)) in equations().into_iter().enumerate() {
            let equation = equation.canonical();
            for condition in conditions {
                for order in [0, 1, 2, 9] {
                    let all = &mut |_: usize| true;
                    let whole = derive(&equation, &|_| None, condition, order, &stop, all);
                    let alone = frequency(&equation, &|_| None, condition, order, &stop, all);
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
        let setting = Setting::new(&equation, &|_| None, cycle, order, &stop).unwrap();
        let whole = derive(&equation, &|_| None, cycle, order, &stop, &mut |_| true).unwrap();
        let reaction = setting.reaction.as_ref();
        let amplitude = Rational::from(2);
        let mut bound = FrequencyBound::new(setting.bound.clone(), &amplitude, reaction).unwrap();
        let mut longest = 0;
        for n in 1..=order {
            let expected = bound.next_order();
            let numbers = [&whole.squared, &whole.frequency, &whole.period].map(|s| &s[n]);
            for (number, denominator) in numbers.iter().zip(&bound.denominators(&expected)) {
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
        let alone = frequency(&equation, &|_| None, cycle, order, &stop, &mut |_| true).unwrap();
        let least = (longest / 30) as usize;
        let primes = alone.images.primes;
        assert!((least..=2 * least).contains(&primes), "{primes} {least}");
        // The norms cost some ten bits per order.
        assert!(primes * 3 <= whole.primes * 5, "{primes} {}", whole.primes);
    }

    /// Everything that is formed, changed in one harmonic, modulo one prime: some numbers in the place of eps are enough to
    /// refuse it.
    #[test]
    fn a_broken_trace_is_refused() {
        with_traces(0, |job, degrees, (algebra, equation), trace| {
            let check = |trace: &Trace<Modular>| job.check_trace(algebra, equation, trace, degrees);
            assert_eq!(check(trace), Ok(()));
            let field = algebra.field();
            let one_lane = |lane: usize| std::array::from_fn(|l| u32::from(l == lane % LANES));
            let mut refused = 0;
            let mut refuses = |broken: &Trace<Modular>, what: &str| {
                assert!(check(broken).is_err(), "{what}");
                refused += 1;
            };
            let shifted = |f: &ModularElement, k: usize, odd: usize| {
                let mut change = [Vec::new(), Vec::new()];
                change[odd] = vec![field.zero(); k];
                change[odd].push(one_lane(k + odd));
                algebra.add(f, &algebra.from_harmonics(change))
            };
            for n in 0..=job.request.order {
                let mut broken = trace.clone();
                field.add_assign(&mut broken.squared[n], &one_lane(n));
                refuses(&broken, &format!("W_{n}"));
                // A residual is left even where omega and W belong together.
                if n > 0 {
                    broken.frequency = square_root(field, &broken.squared);
                    refuses(&broken, &format!("omega^2 = W_{n}"));
                }
                let mut broken = trace.clone();
                field.add_assign(&mut broken.frequency[n], &one_lane(n));
                refuses(&broken, &format!("omega_{n}"));
                for (k, odd) in [(1, 0), (1, 1), (2, 0), (3, 1), (5, 0)] {
                    let mut broken = trace.clone();
                    broken.solution[n] = shifted(&broken.solution[n], k, odd);
                    refuses(&broken, &format!("x_{n} {k} {odd}"));
                    for node in 0..trace.nodes.len() {
                        let mut broken = trace.clone();
                        let Some(f) = broken.nodes[node].get_mut(n) else { continue };
                        *f = shifted(f, k, odd);
                        refuses(&broken, &format!("node {node} of order {n}, {k} {odd}"));
                    }
                }
            }
            assert!(refused > 200, "{refused}");
        });
    }

    /// What is consistent, but belongs to another equation or to another W, leaves a residual.
    #[test]
    fn another_solution_is_refused() {
        with_traces(0, |job, degrees, (algebra, equation), trace| {
            let twice = (Expression::ACCELERATION
                + Expression::DISPLACEMENT
                + Expression::Small
                    * (Expression::DISPLACEMENT.pow(2) - 1)
                    * Expression::VELOCITY
                    * 2)
            .canonical();
            let other = Job { equation: &twice, ..job.clone() };
            let (_, same_nodes) = other.over(*algebra.field()).unwrap();
            let found = trace_of(algebra, &same_nodes, &job.request);
            assert_eq!(other.check_trace(algebra, &same_nodes, &found, degrees), Ok(()));
            assert!(job.check_trace(algebra, equation, &found, degrees).is_err());
            assert!(job.check_trace(algebra, &same_nodes, trace, degrees).is_err());
        });
    }

    /// The points are just enough: with one less the last order of the first harmonic is not told apart, and nothing is
    /// said.
    #[test]
    fn fewer_points_are_refused() {
        with_traces(0, |job, _, (algebra, _), _| {
            // Of x^2 x' at order 5: 2 5 + 3.
            assert_eq!(4 * job.points, 16);
            assert!(algebra.field().root_of_unity(8 * job.points as u64).is_some());
        });
        for less in [1, 2] {
            with_traces(less, |job, degrees, (algebra, equation), trace| {
                assert!(job.check_trace(algebra, equation, trace, degrees).is_err());
            });
        }
    }

    fn square_root(field: &PrimeFields, squared: &[Residues]) -> Vec<Residues> {
        Series::truncated(squared.to_vec()).square_root(field).unwrap().coefficients
    }

    fn trace_of(
        algebra: &Modular,
        equation: &Equation<Modular>,
        request: &Request,
    ) -> Trace<Modular> {
        trace(algebra, equation, request, &mut |_| true).unwrap()
    }

    type Over<'a> = (&'a Modular, &'a Equation<Modular>);

    /// The trace of van der Pol's equation with as many points as the first harmonic needs, or `less`.
    fn with_traces(less: usize, test: impl Fn(&Job<'_>, &[Degrees], Over<'_>, &Trace<Modular>)) {
        let (equation, stop) = (van_der_pol(), Stop::default());
        let cycle = Condition::LimitCycle;
        let setting = Setting::new(&equation, &|_| None, cycle, 6, &stop).unwrap();
        let points = Modular::points_for_first_harmonic(2 * 6 + 1).0 - less;
        let job = Job { points, ..setting.job.clone() };
        let field = setting.primes(8 * points as u64).next().unwrap();
        let (algebra, equation) = job.over(field).unwrap();
        let trace = trace_of(&algebra, &equation, &job.request);
        test(&job, &setting.degrees, (&algebra, &equation), &trace);
    }

    /// What the judge does not have is no frequency.
    #[test]
    fn the_judge_refuses() {
        with_images(6, |job, mut images| {
            let ring = images[0].ring;
            images[0].change(4, Place::Squared, |value| ring.add(&value, &ring.one()));
            let stop = Stop::default();
            let setting =
                Setting::new(job.equation, &|_| None, Condition::LimitCycle, 6, &stop).unwrap();
            let reaction = setting.reaction.as_ref();
            let bound =
                FrequencyBound::new(setting.bound.clone(), &Rational::from(2), reaction).unwrap();
            let mut list = Images::new(&setting.job, setting.primes(setting.roots));
            list.list = images;
            let lifting = Lifting { images: list, bound, degrees: &setting.degrees };
            let found = lifting.climb(&mut |_| true);
            assert_eq!(found.unwrap_err(), ExpandError::Residual { order: 4 }.into());
        });
    }
}
