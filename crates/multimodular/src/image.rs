//! Images of an expansion modulo primes, eight at once: derived, and substituted into the equation. Numbers are kept
//! modulo the product of two primes.

use crate::lifted::Lifted;
use crate::phase::Phase;
use crate::place::Place;
use crate::{Error, Over, RationalBinding};
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_equation::Expression;
use lindstedt_expand::{
    AtPhase, Equation, ExpandError, Expansion, Known, OrderNumbers, OrderWork, Request, check_from,
    check_normalisation, compile, extend, fails_at_phase,
};
use lindstedt_phase::Modular;
use lindstedt_phase::modular::{LANES, PrimeFields, PrimePair, Residues};
use lindstedt_series::Series;
use rug::Rational;
use std::sync::Arc;

/// Phases at which an image of the frequency is substituted: of three, each of 30 bits, a wrong one passes all with a
/// chance below 2^-50 up to degree 2^11.
const PHASES: u32 = 3;

/// What is derived.
pub(crate) struct Job<'a> {
    pub equation: &'a Expression,
    pub binding: &'a dyn RationalBinding,
    pub request: Request,
    /// kappa.
    pub stiffness: Rational,
    pub points: usize,
    pub stop: &'a Stop,
}

/// The numbers of every order modulo the product of two primes, in Montgomery form.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub ring: PrimePair,
    /// What the numbers are: the same for all primes.
    places: Arc<Vec<Vec<Place>>>,
    values: Vec<Vec<u64>>,
}

/// The images modulo eight primes.
pub(crate) type Group = [Image; LANES / 2];

/// Images modulo eight primes; inside, why there are none modulo these.
pub(crate) type Attempt = Result<Result<Group, ExpandError>, Error>;

impl Image {
    pub(crate) fn places(&self, n: usize) -> &[Place] {
        &self.places[n]
    }

    pub(crate) fn values(&self, n: usize) -> &[u64] {
        &self.values[n]
    }

    /// The harmonics of x_n.
    pub(crate) fn harmonics(&self, n: usize) -> Vec<usize> {
        self.places[n].iter().filter_map(|place| place.harmonic()).collect()
    }

    /// The image with the list of places of another one; nothing where not the same coefficients vanish.
    pub(crate) fn like(mut self, other: &Self) -> Option<Self> {
        if self.places != other.places {
            return None;
        }
        self.places = Arc::clone(&other.places);
        Some(self)
    }

    /// Order n is lifted.
    pub(crate) fn forget(&mut self, n: usize) {
        self.values[n] = Vec::new();
    }

    #[cfg(test)]
    pub(crate) fn change(&mut self, n: usize, place: Place, change: impl Fn(u64) -> u64) {
        let index = self.places[n].iter().position(|known| *known == place);
        let value = &mut self.values[n][index.expect("such a number")];
        *value = change(*value);
    }
}

impl Job<'_> {
    pub(crate) fn go_on(&self) -> Result<(), Error> {
        let interrupted = ExpandError::Interrupted { order: self.request.order };
        if self.stop.asked() { Err(interrupted.into()) } else { Ok(()) }
    }

    /// The algebra and the equation modulo eight primes.
    pub(crate) fn over(&self, field: PrimeFields) -> Result<(Modular, Equation<Modular>), Error> {
        let algebra = Modular::new(field, self.points).ok_or(Error::OutOfPrimes)?;
        let algebra = algebra.with_stop(self.stop.clone());
        let binding = Over(self.binding, &field);
        let equation = compile(&algebra, self.equation, &binding, self.request.order)?;
        Ok((algebra, equation))
    }

    /// The images of the expansion modulo eight primes, checked from the orders on that are not proved yet; nothing is kept of
    /// those. Inside: why there are none modulo these primes.
    pub(crate) fn image(&self, field: PrimeFields, proved: &[Lifted]) -> Attempt {
        let (algebra, equation) = self.over(field)?;
        let mut known = (Vec::new(), Vec::new());
        for (order, lifted) in proved.iter().enumerate() {
            let Some((squared, harmonics)) = lifted.modulo(&field) else {
                return Ok(Err(ExpandError::Residual { order }));
            };
            known.0.push(algebra.from_harmonics(harmonics));
            known.1.push(squared);
        }
        let known = Known { solution: &known.0, squared: &known.1 };
        let mut images = match self.derived(&algebra, &equation, known)? {
            Ok(images) => images,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        self.check(&algebra, &equation, &images, proved.len())?;
        for image in &mut images {
            (0..proved.len()).for_each(|n| image.forget(n));
        }
        Ok(Ok(images))
    }

    /// W_n, omega_n and T_n modulo eight primes, from images that are substituted at one phase alone.
    pub(crate) fn brief_image(&self, field: PrimeFields) -> Attempt {
        let (algebra, equation) = self.over(field)?;
        let known = Known { solution: &[], squared: &[] };
        let mut images = match self.derived(&algebra, &equation, known)? {
            Ok(images) => images,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        self.check_at_phase(&algebra, &equation, &images)?;
        for Image { places, values, .. } in &mut images {
            for (places, values) in places.iter().zip(values) {
                values.truncate(places.iter().filter(|place| place.harmonic().is_none()).count());
                values.shrink_to_fit();
            }
        }
        Ok(Ok(images))
    }

    /// What the driver gives modulo eight primes: every number that does not vanish modulo all of them.
    fn derived(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        known: Known<'_, Modular>,
    ) -> Attempt {
        let field = *algebra.field();
        let go_on = &mut |_: &OrderWork| !self.stop.asked();
        let found = extend(algebra, equation, &self.request, known, go_on);
        self.go_on()?;
        let expansion = match found {
            Ok(expansion) => expansion,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        let squared = Series::truncated(expansion.frequency_squared);
        let Some(frequency) = squared.square_root(&field) else { return Err(Error::OutOfPrimes) };
        let Some(period) = frequency.reciprocal(&field) else { return Err(Error::OutOfPrimes) };
        let mut places = Vec::new();
        let mut values = [const { Vec::new() }; LANES / 2];
        for (n, x) in expansion.solution.iter().enumerate() {
            let [cos, sin] = algebra.harmonics(x);
            let cosines = cos.into_iter().enumerate().map(|(k, c)| (Place::Cosine(k), c));
            let sines = sin.into_iter().enumerate().map(|(k, c)| (Place::Sine(k), c));
            let used = cosines.chain(sines).filter(|(_, value)| !field.is_zero(value));
            let numbers = [
                (Place::Squared, squared.coefficients[n]),
                (Place::Frequency, frequency.coefficients[n]),
                (Place::Period, period.coefficients[n]),
            ];
            let all = numbers.into_iter().chain(used);
            let (place, parts): (Vec<_>, Vec<_>) =
                all.map(|(place, value)| (place, field.parted(&value))).unzip();
            places.push(place);
            for (i, list) in values.iter_mut().enumerate() {
                list.push(parts.iter().map(|parts| parts[i]).collect());
            }
        }
        let places = Arc::new(places);
        Ok(Ok(std::array::from_fn(|i| Image {
            ring: field.pairs()[i],
            places: Arc::clone(&places),
            values: std::mem::take(&mut values[i]),
        })))
    }

    /// Substitutes images into the equation modulo their primes; the orders below `first` are proved. What is checked is
    /// what is lifted: its numbers alone enter here, with the amplitude and the stiffness over Q.
    pub(crate) fn check(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        images: &Group,
        first: usize,
    ) -> Result<(), Error> {
        let (expansion, _) = self.stated(algebra, images)?;
        let checked = check_from(algebra, equation, &expansion, first)?;
        let broken = Error::from(ExpandError::Residual { order: checked });
        if checked == self.request.order { Ok(()) } else { Err(broken) }
    }

    /// Substitutes images at some phases, which the primes decide: what does not vanish there, does not; what does,
    /// does not with a chance of twice its degree over p at each of them.
    pub(crate) fn check_at_phase(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        images: &Group,
    ) -> Result<(), Error> {
        let field = algebra.field();
        let (expansion, frequency) = self.stated(algebra, images)?;
        check_normalisation(algebra, &expansion)?;
        let solution: Vec<_> = expansion.solution.iter().map(|x| algebra.harmonics(x)).collect();
        for number in 0..PHASES {
            let phase = Phase::new(field, 2 * self.points, number).ok_or(Error::OutOfPrimes)?;
            let mut functions = [const { Vec::new() }; 3];
            for harmonics in &solution {
                let values = phase.values(field, harmonics);
                functions.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
            }
            let (squared, frequency) = (expansion.frequency_squared.clone(), frequency.clone());
            let at = AtPhase { functions, squared, frequency, stiffness: expansion.stiffness };
            if let Some(order) = fails_at_phase(field, equation, at) {
                return Err(ExpandError::Residual { order }.into());
            }
        }
        Ok(())
    }

    /// The expansion that the numbers of images state, and omega: its square is W, its product with T is 1.
    fn stated(
        &self,
        algebra: &Modular,
        images: &Group,
    ) -> Result<(Expansion<Modular>, Vec<Residues>), Error> {
        let field = algebra.field();
        let size = 2 * self.points + 1;
        let mut solution = Vec::new();
        let [mut squared, mut frequency, mut period] = [const { Vec::new() }; 3];
        for (n, places) in images[0].places.iter().enumerate() {
            let mut harmonics = [vec![field.zero(); size], vec![field.zero(); size]];
            let parts = images.each_ref().map(|image| image.values(n));
            for (i, place) in places.iter().enumerate() {
                let value = field.joined(&parts.map(|part| part[i]));
                match *place {
                    Place::Squared => squared.push(value),
                    Place::Frequency => frequency.push(value),
                    Place::Period => period.push(value),
                    Place::Cosine(k) => harmonics[0][k] = value,
                    Place::Sine(k) => harmonics[1][k] = value,
                }
            }
            solution.push(algebra.from_harmonics(harmonics));
        }
        let [frequency, period] = [frequency, period].map(Series::truncated);
        let mut one = vec![field.zero(); period.coefficients.len()];
        one[0] = field.one();
        let order = self.request.order;
        let square = frequency.mul(field, &frequency.clone(), order).coefficients;
        let product = frequency.mul(field, &period, order).coefficients;
        for (found, expected) in [(&square, &squared), (&product, &one)] {
            if let Some(order) = found.iter().zip(expected).position(|(a, b)| a != b) {
                return Err(ExpandError::Residual { order }.into());
            }
        }
        let amplitude = field.rational(&self.request.leading_amplitude);
        let expansion = Expansion {
            condition: self.request.condition,
            stiffness: field.rational(&self.stiffness),
            frequency_squared: squared,
            amplitude: vec![amplitude],
            solution,
            work: Vec::new(),
            certificates: Vec::new(),
        };
        Ok((expansion, frequency.coefficients))
    }

    /// Compares numbers over Q with an image that had no part in them.
    pub(crate) fn judge(
        &self,
        image: &Image,
        n: usize,
        numbers: &OrderNumbers,
    ) -> Result<(), Error> {
        let ring = &image.ring;
        let denominator = ring.integer(&numbers.denominator);
        let mut numerators = numbers.numerators.iter();
        let same = |(place, &value): (&Place, &u64)| match place {
            Place::Squared => ring.rational(&numbers.squared) == value,
            Place::Frequency => ring.rational(&numbers.frequency) == value,
            Place::Period => ring.rational(&numbers.period) == value,
            Place::Cosine(_) | Place::Sine(_) => numerators
                .next()
                .is_some_and(|(_, c)| ring.integer(c) == ring.mul(&denominator, &value)),
        };
        let agrees = image.places(n).iter().zip(image.values(n)).all(same);
        let all = agrees && numerators.next().is_none();
        if all { Ok(()) } else { Err(ExpandError::Residual { order: n }.into()) }
    }
}
