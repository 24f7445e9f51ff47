//! Expansions over Q by computation modulo many primes, with proof.
//!
//! The driver runs unchanged over [`Modular`] for primes p of 30 bits, eight at once, where a product of phase
//! functions costs one multiplication per point. Every image is substituted into the equation modulo its own prime
//! (`image`). Chinese remaindering gives the numerators of an order over a denominator that the
//! recurrence predicts from the orders below (`lift`), with as many primes as that order needs.
//!
//! Nothing is assumed about how many primes suffice, or about the denominator: order n is accepted when the
//! product of the primes that gave it exceeds every numerator that its residual can have ([`ResidualBound`]).
//! Then it is *proved*, by induction: modulo each of these primes the equations of the orders up to n have one
//! solution, which is the image and, the orders below being right, what they are modulo p; so the residual of
//! order n is divisible by all the primes and smaller than their product: zero.
//! A prime that is first needed at order m begins there, from the orders below as they are modulo p.

mod denominator;
mod frequency;
mod function;
mod image;
mod images;
mod lift;
mod lifted;
mod place;
#[cfg(test)]
mod tests;

pub use frequency::{BoundedFrequency, CheckedImages, frequency};
pub use function::{Fraction, Function};
use image::Job;
use images::Images;
use lift::Remaindering;
use lifted::Lifted;
use lindstedt_algebra::{RationalAlgebra, Rationals, Stop};
use lindstedt_equation::{Condition, Expression};
use lindstedt_expand::{
    Binding, Degrees, ExpandError, Expansion, Request, ResidualBound, amplitude_reaction, compile,
    degrees, equation_denominator, expand, leading_amplitude,
};
use lindstedt_phase::modular::PrimeFields;
use lindstedt_phase::{Modular, Trigonometric};
use rayon::prelude::*;
use rug::{Integer, Rational};

/// The plain algebra over Q, in which results are stated.
pub type RationalAlgebraOfPhase = Trigonometric<Rationals>;

/// Why there is no expansion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// As the driver over Q would refuse; interrupted; or a residual that does not vanish.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// No more primes of 30 bits with the roots of unity that the order needs.
    #[error("no more 30-bit primes for this order")]
    OutOfPrimes,
}

/// The rational numbers that names of parameters stand for.
pub type Names<'a> = dyn Fn(&str) -> Option<Rational> + Sync + 'a;

/// The same names over another ring of constants.
struct Over<'a, C>(&'a Names<'a>, &'a C);

impl<C: RationalAlgebra> Binding<C> for Over<'_, C> {
    fn parameter(&self, name: &str) -> Option<C::Element> {
        (self.0)(name).map(|q| self.1.rational(&q))
    }
}

/// A proved expansion and what it took.
#[derive(Clone, Debug)]
pub struct Proved {
    /// What fixes the amplitude.
    pub condition: Condition,
    /// kappa, the factor of x at order zero.
    pub stiffness: Rational,
    /// W_n.
    pub squared: Vec<Rational>,
    /// x_n.
    pub solution: Vec<Function>,
    /// x_n(0).
    pub amplitude: Vec<Rational>,
    /// omega_n of omega/sqrt(kappa) = sum omega_n eps^n, whose square is W.
    pub frequency: Vec<Rational>,
    /// T_n of sqrt(kappa) T/2pi, the reciprocal of that.
    pub period: Vec<Rational>,
    /// The number of primes that determined it.
    pub primes: usize,
    /// The number of primes modulo which it was substituted into the equation: those that determined and
    /// prove it, and two apart that judge the lifting.
    pub proof_primes: usize,
}

impl Proved {
    /// The highest order.
    #[must_use]
    pub fn order(&self) -> usize {
        self.solution.len() - 1
    }

    /// f_n of x_n'' + x_n = f_n - W_n x_0'', by harmonics; nothing beyond the orders derived and at order zero.
    #[must_use]
    pub fn right_side(&self, n: usize) -> Vec<Fraction> {
        let (Some(x), Some(w)) = (self.solution.get(n), self.squared.get(n)) else {
            return Vec::new();
        };
        let mut list = x.force();
        if n > 0 && !w.is_zero() {
            // x_0'' = -a_0 cos psi, and x'' + x has no first harmonic.
            let (numerator, denominator) =
                (-Rational::from(w * &self.amplitude[0])).into_numer_denom();
            let place = list.partition_point(|f| f.harmonic == 0);
            list.insert(place, Fraction { harmonic: 1, sine: false, numerator, denominator });
        }
        list
    }

    /// The number of its terms.
    #[must_use]
    pub fn right_side_terms(&self, n: usize) -> usize {
        let resonant = |n: usize| n > 0 && self.squared.get(n).is_some_and(|w| !w.is_zero());
        self.solution.get(n).map_or(0, Function::force_terms) + usize::from(resonant(n))
    }

    /// The expansion over Q, of numbers that are ready for arithmetic.
    #[must_use]
    pub fn expansion(&self) -> Expansion<RationalAlgebraOfPhase> {
        Expansion {
            condition: self.condition,
            stiffness: self.stiffness.clone(),
            frequency_squared: self.squared.clone(),
            amplitude: self.amplitude.clone(),
            solution: self.solution.par_iter().map(Function::polynomial).collect(),
            work: Vec::new(),
            certificates: Vec::new(),
        }
    }
}

/// Derives and proves the expansion of a polynomial equation over Q: x_n and W_n of
/// omega^2 = kappa sum W_n eps^n for n = 0, ..., `order`, in lowest terms.
///
/// `observer` is told the number of primes done so far; `false` stops. `stop` is asked after every
/// order modulo every prime, from all threads.
///
/// Cost: O(N^3) products modulo every prime, and B/30 primes where the numbers of order N have B bits (for van
/// der Pol's equation B grows like 0.7 N^2, for Duffing's like 5 N).
///
/// # Errors
/// [`Error::Expand`] as the driver over Q would, or interrupted.
///
/// ```
/// use lindstedt_algebra::Stop;
/// use lindstedt_multimodular::derive;
/// use rug::Rational;
///
/// let duffing = lindstedt_problems::find("duffing").ok_or("no such problem")?;
/// let (equation, condition) = (&duffing.equation, duffing.conditions[0]);
/// let proved = derive(equation, &|_| None, condition, 3, &Stop::default(), &mut |_| true)?;
/// assert_eq!(proved.frequency[3], Rational::from((81, 2048)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derive(
    equation: &Expression,
    binding: &Names<'_>,
    condition: Condition,
    order: usize,
    stop: &Stop,
    observer: &mut dyn FnMut(usize) -> bool,
) -> Result<Proved, Error> {
    let setting = Setting::new(equation, binding, condition, order, stop)?;
    let primes = setting
        .primes(setting.roots)
        .take_while(|fields| fields.primes().iter().all(|prime| *prime >= SMALLEST));
    let images = Images::new(&setting.job, primes);
    let (bound, largest) = (setting.bound.clone(), setting.largest);
    let (found, needs) = (Vec::new(), Vec::new());
    Ladder { job: &setting.job, images, bound, found, needs, largest }.climb(observer)
}

/// What belongs to the equation and is known before any order is.
struct Setting<'a> {
    job: Job<'a>,
    bound: ResidualBound,
    /// The highest harmonic.
    largest: usize,
    /// The highest harmonics of x_n, and of all that is formed.
    degrees: Vec<Degrees>,
    degree: usize,
    /// 1/S of a limit cycle.
    reaction: Option<Rational>,
    /// The order of the root of unity that a prime must have, and what it must not divide.
    roots: u64,
    numbers: Integer,
}

impl<'a> Setting<'a> {
    fn new(
        equation: &'a Expression,
        binding: &'a Names<'a>,
        condition: Condition,
        order: usize,
        stop: &'a Stop,
    ) -> Result<Self, Error> {
        let plain = Trigonometric::new(Rationals);
        let over_q = Over(binding, &Rationals);
        let compiled = compile(&plain, equation, &over_q, order)?;
        let leading_amplitude = leading_amplitude(&plain, &compiled, condition)?;
        let request = Request { condition, order, leading_amplitude };
        let (degrees, degree) = degrees(&compiled, order).ok_or_else(|| {
            ExpandError::UnsupportedTerm { term: "a term that is not polynomial".into() }
        })?;
        let (points, roots) = Modular::points_for_degree(degree);
        let initial = Condition::InitialAmplitude;
        let zero = Request { order: 0, condition: initial, ..request.clone() };
        let stiffness = expand(&plain, &compiled, &zero, &mut |_| true)?.stiffness;
        let largest = degrees.iter().flatten().flatten().max().copied().unwrap_or(1);
        let is_cycle = condition == Condition::LimitCycle;
        let bound = ResidualBound::new(&compiled, &stiffness, largest, is_cycle)?;
        let reaction = amplitude_reaction(&plain, &compiled, &request)?;
        // Reduction is a homomorphism only where no denominator vanishes, and what is divided by must not.
        let mut numbers = equation_denominator(&compiled) * stiffness.numer() * stiffness.denom();
        numbers *= request.leading_amplitude.numer();
        numbers *= request.leading_amplitude.denom();
        let job = Job { equation, binding, request, stiffness, points, stop };
        Ok(Self { job, bound, largest, degrees, degree, reaction, roots, numbers })
    }

    /// Primes with roots of unity of an order.
    fn primes(&self, roots: u64) -> impl Iterator<Item = PrimeFields> {
        let primes = PrimeFields::with_roots_of_unity(roots);
        primes.filter(|fields| fields.integer(&self.numbers).iter().all(|&residue| residue != 0))
    }
}

/// The primes of a whole expansion are above this.
const SMALLEST: u32 = (1 << 30) - (1 << 28);

/// Images modulo two primes each, which have more than 59.1 bits together, for so many bits.
fn images_for(bits: u64) -> usize {
    (bits * 10).div_ceil(591) as usize + 1
}

/// The loop over the orders.
struct Ladder<'a, P> {
    job: &'a Job<'a>,
    images: Images<'a, P>,
    bound: ResidualBound,
    /// The orders that are proved.
    found: Vec<Lifted>,
    /// The images that every order needed.
    needs: Vec<usize>,
    /// The highest harmonic.
    largest: usize,
}

impl<P: Iterator<Item = PrimeFields>> Ladder<'_, P> {
    fn climb(mut self, observer: &mut dyn FnMut(usize) -> bool) -> Result<Proved, Error> {
        self.more(3, observer)?;
        let mut remaindering = Remaindering::new(&self.images.list[1..]);
        // Bits of a residual, and of the numerators, above those of the denominator.
        let mut excess = 0;
        for n in 0..=self.job.request.order {
            let harmonics = self.images.list[0].harmonics(n);
            let guess = self.bound.expected(&harmonics);
            let mut needed = (i64::from(guess.significant_bits()) + excess).unsigned_abs();
            let (numbers, bits) = loop {
                self.prepare(&mut remaindering, n, needed, observer)?;
                self.job.go_on()?;
                let lifted = remaindering.lift(&self.images.list[1..], n, &guess, self.job.stop);
                needed = remaindering.bits() + 1;
                let Some(numbers) = lifted else { continue };
                let bits = self.bound.take(&numbers);
                if bits <= remaindering.bits() {
                    break (numbers, bits);
                }
                self.bound.give_back();
                needed = bits.max(needed);
            };
            self.job.judge(&self.images.list[0], n, &numbers)?;
            let lifting = u64::from(lift::MARGIN + lift::longest(&numbers) + 4);
            excess = bits.max(lifting) as i64 - i64::from(numbers.denominator.significant_bits());
            self.needs.push(remaindering.primes() / 2);
            self.found.push(Lifted::new(numbers, self.images.list[0].places(n)));
            self.images.list.iter_mut().for_each(|image| image.forget(n));
        }
        Ok(self.assemble())
    }

    fn assemble(self) -> Proved {
        let primes = 2 * (self.images.list.len() - 1);
        let mut proved = Proved {
            condition: self.job.request.condition,
            stiffness: self.job.stiffness.clone(),
            squared: Vec::new(),
            solution: Vec::new(),
            amplitude: Vec::new(),
            frequency: Vec::new(),
            period: Vec::new(),
            primes,
            proof_primes: primes + 2,
        };
        let largest = u32::try_from(self.largest + 1).unwrap_or(u32::MAX);
        for order in self.found {
            let ([squared, frequency, period], x) = order.order(largest);
            proved.squared.push(squared);
            proved.frequency.push(frequency);
            proved.period.push(period);
            proved.amplitude.push(x.at_zero());
            proved.solution.push(x);
        }
        proved
    }

    /// Enough primes for so many bits, and not many more than enough.
    fn prepare(
        &mut self,
        remaindering: &mut Remaindering,
        n: usize,
        needed: u64,
        observer: &mut dyn FnMut(usize) -> bool,
    ) -> Result<(), Error> {
        if (needed..=needed + needed / 8 + 256).contains(&remaindering.bits()) {
            return Ok(());
        }
        let own = images_for(needed);
        let have = self.images.list.len() - 1;
        if have < own {
            self.more(self.batch(n, own), observer)?;
        }
        // Some more serve the next orders, too.
        let last = (1 + own + own / 16).min(self.images.list.len());
        *remaindering = Remaindering::new(&self.images.list[1..last]);
        Ok(())
    }

    /// How many more images to make at once: those that are needed, and where the growth so far continues,
    /// nearly those of the last order; few, because the later one comes the fewer orders are left to it.
    fn batch(&self, n: usize, own: usize) -> usize {
        let have = self.images.list.len() - 1;
        let half = self.needs.get(n / 2).copied().unwrap_or(own);
        let slope = (own.saturating_sub(half), n - n / 2);
        let rest = self.job.request.order - n;
        let last = own + slope.0 * rest / slope.1.max(1);
        let (least, most) = (own.saturating_sub(have).max(1), (have / 8).max(have.clamp(2, 8)));
        (last * 9 / 10).saturating_sub(have).min(most).max(least)
    }

    /// Images modulo more primes, each of them checked.
    fn more(&mut self, count: usize, observer: &mut dyn FnMut(usize) -> bool) -> Result<(), Error> {
        let (job, proved) = (self.job, &self.found);
        self.images.more(count, &|field| job.image(field, proved), observer)
    }
}
