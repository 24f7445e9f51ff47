//! Expansions over Q by computation modulo many primes, with proof.
//!
//! The driver runs unchanged over [`Modular`] for primes p of 61 bits, where a product of phase
//! functions costs one multiplication per point. Chinese remaindering and rational
//! reconstruction give the expansion over Q; nothing is assumed about how many primes suffice,
//! because the result is then *proved*: the finished expansion, reduced modulo fresh primes,
//! must satisfy the equation modulo each of them, and their product must exceed the largest
//! number that a residual of these denominators and this size can contain
//! ([`residual_bits`]). So the residual vanishes over Q.

use crate::Error;
use lindstedt_algebra::{PhaseAlgebra, RationalAlgebra, Rationals, Ring, Stop};
use lindstedt_equation::Expression;
use lindstedt_expand::{
    Binding, Equation, ExpandError, Expansion, Request, check, check_normalisation, compile,
    degrees, equation_denominator, expand, leading_amplitude, residual_bits,
};
use lindstedt_phase::modular::{ModularElement, PrimeField};
use lindstedt_phase::trigonometric::TrigonometricPolynomial;
use lindstedt_phase::{Modular, Trigonometric};
use rayon::prelude::*;
use rug::{Integer, Rational};

/// The plain algebra over Q, in which results are stated.
pub type RationalAlgebraOfPhase = Trigonometric<Rationals>;

/// Names bound to rational numbers.
pub trait RationalBinding: Sync {
    /// The value of a parameter.
    fn parameter(&self, name: &str) -> Option<Rational>;
}

struct Over<'a, C>(&'a dyn RationalBinding, &'a C);

impl<C: RationalAlgebra> Binding<C> for Over<'_, C> {
    fn parameter(&self, name: &str) -> Option<C::Element> {
        self.0.parameter(name).map(|q| self.1.rational(&q))
    }
    fn formal(&self, _: &str, _: usize) -> Option<C::Element> {
        None
    }
}

/// A proved expansion and what it took.
#[derive(Clone, Debug)]
pub struct Proved {
    /// The expansion over Q.
    pub expansion: Expansion<RationalAlgebraOfPhase>,
    /// The number of primes that determined it.
    pub primes: usize,
    /// The number of fresh primes that prove its residual to vanish.
    pub proof_primes: usize,
}

/// Derives and proves the expansion of a polynomial equation over Q.
///
/// `observer` is told the number of primes done so far; `false` stops. `stop` is asked after every
/// order modulo every prime, from all threads.
///
/// # Errors
/// [`Error::Expand`] as the driver over Q would, or interrupted.
pub fn derive(
    equation: &Expression,
    binding: &dyn RationalBinding,
    condition: lindstedt_equation::Condition,
    order: usize,
    stop: &Stop,
    observer: &mut dyn FnMut(usize) -> bool,
) -> Result<Proved, Error> {
    let plain = Trigonometric::new(Rationals);
    let compiled = compile(&plain, equation, &Over(binding, &Rationals), order)?;
    let amplitude = leading_amplitude(&plain, &compiled, condition)?;
    let request = Request { condition, order, leading_amplitude: amplitude };
    let (degrees, degree) = degrees(&compiled, order).ok_or_else(|| {
        ExpandError::UnsupportedTerm { term: "a term that is not polynomial".into() }
    })?;
    let (points, roots) = Modular::points_for_degree(degree);
    let job = Job { equation, binding, request, degrees, points, stop };

    let mut primes = PrimeField::with_roots_of_unity(roots, 1 << 61);
    let mut images: Vec<(PrimeField, Vec<u64>)> = Vec::new();
    let mut batch = 2 + order / 8;
    let values = loop {
        let fields: Vec<PrimeField> = primes.by_ref().take(batch).collect();
        if fields.is_empty() {
            return Err(Error::OutOfPrimes);
        }
        let new: Vec<_> = fields.into_par_iter().map(|field| job.image(field)).collect();
        // A prime can be unlucky (a denominator or a pivot vanishes modulo it): it is skipped. What
        // fails modulo all of them fails over Q.
        let mut failure = None;
        for image in new {
            match image {
                Ok(image) => images.push(image),
                Err(error) => failure = Some(error),
            }
        }
        if let (true, Some(error)) = (images.is_empty(), failure) {
            return Err(error);
        }
        if !observer(images.len()) {
            return Err(ExpandError::Interrupted { order }.into());
        }
        if let Some(values) = reconstruct(&images, job.probe(), stop) {
            break values;
        }
        job.go_on()?;
        batch = (images.len() / 6).max(2);
    };
    let expansion = job.assemble(&plain, &values)?;
    let last = images.last().map_or(1 << 61, |(field, _)| field.prime());
    let proof_primes = prove(&job, &plain, &compiled, &expansion, roots, last)?;
    Ok(Proved { expansion, primes: images.len(), proof_primes })
}

struct Job<'a> {
    equation: &'a Expression,
    binding: &'a dyn RationalBinding,
    request: Request,
    degrees: Vec<usize>,
    points: usize,
    stop: &'a Stop,
}

impl Job<'_> {
    fn go_on(&self) -> Result<(), Error> {
        let interrupted = ExpandError::Interrupted { order: self.request.order };
        if self.stop.asked() { Err(interrupted.into()) } else { Ok(()) }
    }

    fn over(&self, field: PrimeField) -> Result<(Modular, Equation<Modular>), Error> {
        let algebra = Modular::new(field, self.points).ok_or(Error::OutOfPrimes)?;
        let binding = Over(self.binding, &field);
        let equation = compile(&algebra, self.equation, &binding, self.request.order)?;
        Ok((algebra, equation))
    }

    /// The expansion modulo p as one list: for every order W_n, then cos_k and sin_k up to the
    /// degree of x_n.
    fn image(&self, field: PrimeField) -> Result<(PrimeField, Vec<u64>), Error> {
        let (algebra, equation) = self.over(field)?;
        let expansion = expand(&algebra, &equation, &self.request, &mut |_| !self.stop.asked())?;
        self.go_on()?;
        let mut list = Vec::new();
        for ((w, x), &degree) in
            expansion.frequency_squared.iter().zip(&expansion.solution).zip(&self.degrees)
        {
            let [cos, sin] = algebra.harmonics(x);
            list.push(*w);
            list.extend(&cos[..=degree]);
            list.extend(&sin[..=degree]);
        }
        let list = list.into_iter().map(|c| field.representative(c)).collect();
        Ok((field, list))
    }

    /// The part of the list that belongs to the highest order: the largest numbers.
    fn probe(&self) -> usize {
        self.degrees.last().map_or(1, |d| 2 * (d + 1) + 1)
    }

    fn assemble(
        &self,
        algebra: &RationalAlgebraOfPhase,
        values: &[Rational],
    ) -> Result<Expansion<RationalAlgebraOfPhase>, Error> {
        let mut rest = values;
        let (mut frequency_squared, mut solution) = (Vec::new(), Vec::new());
        for &degree in &self.degrees {
            let (own, next) = rest.split_at(2 * (degree + 1) + 1);
            rest = next;
            frequency_squared.push(own[0].clone());
            let trimmed = |list: &[Rational]| {
                let used = list.iter().rposition(|c| !c.is_zero()).map_or(0, |last| last + 1);
                list[..used].to_vec()
            };
            solution.push(TrigonometricPolynomial {
                cos: trimmed(&own[1..degree + 2]),
                sin: trimmed(&own[degree + 2..]),
            });
        }
        let amplitude = solution.iter().filter_map(|x| algebra.at_zero(x)).collect();
        Ok(Expansion {
            condition: self.request.condition,
            stiffness: self.stiffness(algebra)?,
            frequency_squared,
            amplitude,
            solution,
            work: Vec::new(),
            certificates: Vec::new(),
        })
    }

    /// The linear stiffness, from an expansion of order zero over Q.
    fn stiffness(&self, algebra: &RationalAlgebraOfPhase) -> Result<Rational, Error> {
        let equation = compile(algebra, self.equation, &Over(self.binding, &Rationals), 0)?;
        let request = Request {
            order: 0,
            condition: lindstedt_equation::Condition::InitialAmplitude,
            ..self.request.clone()
        };
        Ok(expand(algebra, &equation, &request, &mut |_| true)?.stiffness)
    }
}

/// The rational numbers with given images, the last `probe` of them first; nothing when the
/// primes do not suffice.
fn reconstruct(
    images: &[(PrimeField, Vec<u64>)],
    probe: usize,
    stop: &Stop,
) -> Option<Vec<Rational>> {
    let length = images.first()?.1.len();
    let remaindering = Remaindering::new(images);
    let lift = |range: std::ops::Range<usize>| -> Option<Vec<Integer>> {
        let lift = |index| (!stop.asked()).then(|| remaindering.lift(index));
        range.into_par_iter().map(lift).collect()
    };
    let mut denominator = Integer::from(1);
    let start = length.saturating_sub(probe);
    remaindering.rationals(&lift(start..length)?, &mut denominator, stop)?;
    let mut denominator = Integer::from(1);
    remaindering.rationals(&lift(0..length)?, &mut denominator, stop)
}

/// The Chinese remainder theorem for the primes of a list of images.
struct Remaindering<'a> {
    images: &'a [(PrimeField, Vec<u64>)],
    modulus: Integer,
    /// M/p_i and its inverse modulo p_i.
    cofactors: Vec<(Integer, u64)>,
}

impl<'a> Remaindering<'a> {
    fn new(images: &'a [(PrimeField, Vec<u64>)]) -> Self {
        let mut modulus = Integer::from(1);
        for (field, _) in images {
            modulus *= field.prime();
        }
        let cofactor = |(field, _): &(PrimeField, Vec<u64>)| {
            let cofactor = Integer::from(modulus.div_exact_ref(&Integer::from(field.prime())));
            let inverse = field.reciprocal(&field.integer(&cofactor)).unwrap_or(0);
            (cofactor, inverse)
        };
        let cofactors = images.par_iter().map(cofactor).collect();
        Self { images, modulus, cofactors }
    }

    /// The representative of the smallest absolute value of the entry at `index`.
    fn lift(&self, index: usize) -> Integer {
        let mut sum = Integer::new();
        for ((field, list), (cofactor, inverse)) in self.images.iter().zip(&self.cofactors) {
            if list[index] != 0 {
                // Montgomery form times plain representative: the factor 2^64 cancels.
                sum += cofactor * field.mul(inverse, &list[index]);
            }
        }
        self.centred(sum)
    }

    fn centred(&self, n: Integer) -> Integer {
        let residue = n.modulo(&self.modulus);
        if Integer::from(&residue << 1) > self.modulus { residue - &self.modulus } else { residue }
    }

    /// Rational numbers over a growing common denominator. A candidate is accepted when it is
    /// shorter than the modulus by 80 bits, which happens by chance once in 2^80.
    /// Nothing when stopped.
    fn rationals(
        &self,
        lifted: &[Integer],
        denominator: &mut Integer,
        stop: &Stop,
    ) -> Option<Vec<Rational>> {
        let limit = self.modulus.significant_bits().checked_sub(80)?;
        let mut values = Vec::with_capacity(lifted.len());
        for residue in lifted {
            if stop.asked() {
                return None;
            }
            let mut numerator = self.centred(Integer::from(residue * &*denominator));
            if numerator.significant_bits() > limit {
                let missing = self.missing_denominator(&numerator)?;
                *denominator *= &missing;
                numerator = self.centred(numerator * missing);
                if numerator.significant_bits() > limit {
                    return None;
                }
            }
            values.push(Rational::from((numerator, denominator.clone())));
        }
        Some(values)
    }

    /// q with q r = small modulo M, by Euclid's algorithm on (M, r): the convergent before a
    /// quotient of more than 80 bits (M. Monagan, ISSAC 2004).
    fn missing_denominator(&self, residue: &Integer) -> Option<Integer> {
        let (mut a, mut b) = (self.modulus.clone(), residue.clone());
        let (mut before, mut cofactor) = (Integer::new(), Integer::from(1));
        while !b.is_zero() {
            let (quotient, remainder) = a.div_rem_ref(&b).into();
            let _: &Integer = &quotient;
            if quotient.significant_bits() > 80 {
                return Some(cofactor.abs());
            }
            let next = before - Integer::from(&quotient * &cofactor);
            before = std::mem::replace(&mut cofactor, next);
            a = std::mem::replace(&mut b, remainder);
        }
        None
    }
}

/// Proves that the residual vanishes; returns the number of primes used.
fn prove(
    job: &Job<'_>,
    plain: &RationalAlgebraOfPhase,
    compiled: &Equation<RationalAlgebraOfPhase>,
    expansion: &Expansion<RationalAlgebraOfPhase>,
    roots: u64,
    below: u64,
) -> Result<usize, Error> {
    let coefficients = |x: &TrigonometricPolynomial<Rational>| {
        let lists = x.cos.iter().enumerate().chain(x.sin.iter().enumerate());
        lists.filter(|(_, c)| !c.is_zero()).map(|(k, c)| (k, c.clone())).collect()
    };
    check_normalisation(plain, expansion)?;
    let bits = residual_bits(compiled, expansion, coefficients).ok_or(Error::OutOfPrimes)?;
    // Every prime exceeds 2^60.
    let count = usize::try_from(bits / 60 + 1).unwrap_or(usize::MAX);
    let cleared: Vec<[Cleared; 2]> =
        expansion.solution.iter().map(|x| [Cleared::new(&x.cos), Cleared::new(&x.sin)]).collect();
    let squared = Cleared::new(&expansion.frequency_squared);
    let numbers = equation_denominator(compiled);
    // Reduction is a homomorphism only where no denominator vanishes.
    let is_good = |field: &PrimeField| {
        let denominators = cleared.iter().flatten().chain([&squared]).map(|c| &c.denominator);
        denominators.chain([&numbers]).all(|d| field.integer(d) != 0)
    };
    let primes = PrimeField::with_roots_of_unity(roots, below);
    let fields: Vec<PrimeField> = primes.filter(is_good).take(count).collect();
    if fields.len() < count {
        return Err(Error::OutOfPrimes);
    }
    fields.into_par_iter().try_for_each(|field| {
        job.go_on()?;
        let (algebra, equation) = job.over(field)?;
        let image = reduce(&algebra, expansion, &cleared);
        check(&algebra, &equation, &image).map(|_| ()).map_err(Error::from)
    })?;
    Ok(count)
}

/// Rational numbers over one common denominator: one inverse modulo p serves all of them.
struct Cleared {
    numerators: Vec<Integer>,
    denominator: Integer,
}

impl Cleared {
    fn new(values: &[Rational]) -> Self {
        let mut denominator = Integer::from(1);
        for value in values {
            denominator.lcm_mut(value.denom());
        }
        let over = |value: &Rational| {
            Integer::from(denominator.div_exact_ref(value.denom())) * value.numer()
        };
        Self { numerators: values.iter().map(over).collect(), denominator }
    }

    fn modulo(&self, field: &PrimeField) -> Vec<u64> {
        let inverse = field.rational(&Rational::from((Integer::from(1), self.denominator.clone())));
        self.numerators.iter().map(|n| field.mul(&field.integer(n), &inverse)).collect()
    }
}

fn reduce(
    algebra: &Modular,
    expansion: &Expansion<RationalAlgebraOfPhase>,
    solution: &[[Cleared; 2]],
) -> Expansion<Modular> {
    let field = *algebra.field();
    let numbers =
        |list: &[Rational]| -> Vec<u64> { list.iter().map(|q| field.rational(q)).collect() };
    let function = |[cos, sin]: &[Cleared; 2]| -> ModularElement {
        algebra.from_harmonics([cos.modulo(&field), sin.modulo(&field)])
    };
    Expansion {
        condition: expansion.condition,
        stiffness: field.rational(&expansion.stiffness),
        frequency_squared: numbers(&expansion.frequency_squared),
        amplitude: numbers(&expansion.amplitude),
        solution: solution.iter().map(function).collect(),
        work: Vec::new(),
        certificates: Vec::new(),
    }
}
