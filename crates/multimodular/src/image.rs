//! The image of an expansion modulo one prime: derived, and substituted into the equation.

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
use lindstedt_phase::modular::PrimeField;
use lindstedt_series::Series;
use rug::Rational;
use std::sync::Arc;

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

/// The numbers of every order modulo p, in Montgomery form.
#[derive(Clone, Debug)]
pub(crate) struct Image {
    pub field: PrimeField,
    /// What the numbers are: the same for all primes.
    places: Arc<Vec<Vec<Place>>>,
    values: Vec<Vec<u64>>,
}

/// An image modulo a prime; inside, why there is none modulo this one.
pub(crate) type Attempt = Result<Result<Image, ExpandError>, Error>;

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

    /// The algebra and the equation modulo p.
    pub(crate) fn over(&self, field: PrimeField) -> Result<(Modular, Equation<Modular>), Error> {
        let algebra = Modular::new(field, self.points).ok_or(Error::OutOfPrimes)?;
        let algebra = algebra.with_stop(self.stop.clone());
        let binding = Over(self.binding, &field);
        let equation = compile(&algebra, self.equation, &binding, self.request.order)?;
        Ok((algebra, equation))
    }

    /// The image of the expansion modulo p, checked from the orders on that are not proved yet; nothing is kept of
    /// those. Inside: why there is none modulo this prime.
    pub(crate) fn image(&self, field: PrimeField, proved: &[Lifted]) -> Attempt {
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
        let mut image = match self.derived(&algebra, &equation, known)? {
            Ok(image) => image,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        self.check(&algebra, &equation, &image, proved.len())?;
        (0..proved.len()).for_each(|n| image.forget(n));
        Ok(Ok(image))
    }

    /// W_n, omega_n and T_n modulo p, from an image that is substituted at one phase alone.
    pub(crate) fn brief_image(&self, field: PrimeField) -> Attempt {
        let (algebra, equation) = self.over(field)?;
        let known = Known { solution: &[], squared: &[] };
        let mut image = match self.derived(&algebra, &equation, known)? {
            Ok(image) => image,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        self.check_at_phase(&algebra, &equation, &image)?;
        for (places, values) in image.places.iter().zip(&mut image.values) {
            values.truncate(places.iter().filter(|place| place.harmonic().is_none()).count());
            values.shrink_to_fit();
        }
        Ok(Ok(image))
    }

    /// What the driver gives modulo p.
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
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for (n, x) in expansion.solution.iter().enumerate() {
            let [cos, sin] = algebra.harmonics(x);
            let cosines = cos.into_iter().enumerate().map(|(k, c)| (Place::Cosine(k), c));
            let sines = sin.into_iter().enumerate().map(|(k, c)| (Place::Sine(k), c));
            let used = cosines.chain(sines).filter(|(_, value)| *value != 0);
            let numbers = [
                (Place::Squared, squared.coefficients[n]),
                (Place::Frequency, frequency.coefficients[n]),
                (Place::Period, period.coefficients[n]),
            ];
            let (place, value): (Vec<_>, Vec<_>) = numbers.into_iter().chain(used).unzip();
            places.push(place);
            values.push(value);
        }
        Ok(Ok(Image { field, places: Arc::new(places), values }))
    }

    /// Substitutes an image into the equation modulo its prime; the orders below `first` are proved. What is checked is
    /// what is lifted: its numbers alone enter here, with the amplitude and the stiffness over Q.
    pub(crate) fn check(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        image: &Image,
        first: usize,
    ) -> Result<(), Error> {
        let (expansion, _) = self.stated(algebra, image)?;
        let checked = check_from(algebra, equation, &expansion, first)?;
        let broken = Error::from(ExpandError::Residual { order: checked });
        if checked == self.request.order { Ok(()) } else { Err(broken) }
    }

    /// Substitutes an image at one phase, which the prime decides: what does not vanish there, does not; what does,
    /// does not with a chance of twice its degree over p.
    pub(crate) fn check_at_phase(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        image: &Image,
    ) -> Result<(), Error> {
        let field = algebra.field();
        let (expansion, frequency) = self.stated(algebra, image)?;
        check_normalisation(algebra, &expansion)?;
        let phase = Phase::new(field, 2 * self.points).ok_or(Error::OutOfPrimes)?;
        let mut functions = [const { Vec::new() }; 3];
        for x in &expansion.solution {
            let values = phase.values(field, algebra.harmonics(x));
            functions.iter_mut().zip(values).for_each(|(list, value)| list.push(value));
        }
        let (squared, stiffness) = (expansion.frequency_squared, expansion.stiffness);
        let at = AtPhase { functions, squared, frequency, stiffness };
        match fails_at_phase(field, equation, at) {
            Some(order) => Err(ExpandError::Residual { order }.into()),
            None => Ok(()),
        }
    }

    /// The expansion that the numbers of an image state, and omega: its square is W, its product with T is 1.
    fn stated(
        &self,
        algebra: &Modular,
        image: &Image,
    ) -> Result<(Expansion<Modular>, Vec<u64>), Error> {
        let field = algebra.field();
        let size = 2 * self.points + 1;
        let mut solution = Vec::new();
        let [mut squared, mut frequency, mut period] = [const { Vec::new() }; 3];
        for (places, values) in image.places.iter().zip(&image.values) {
            let mut harmonics = [vec![0; size], vec![0; size]];
            for (place, &value) in places.iter().zip(values) {
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
        let mut one = vec![0; period.coefficients.len()];
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
        let field = &image.field;
        let denominator = field.integer(&numbers.denominator);
        let mut numerators = numbers.numerators.iter();
        let same = |(place, &value): (&Place, &u64)| match place {
            Place::Squared => field.rational(&numbers.squared) == value,
            Place::Frequency => field.rational(&numbers.frequency) == value,
            Place::Period => field.rational(&numbers.period) == value,
            Place::Cosine(_) | Place::Sine(_) => numerators
                .next()
                .is_some_and(|(_, c)| field.integer(c) == field.mul(&denominator, &value)),
        };
        let agrees = image.places(n).iter().zip(image.values(n)).all(same);
        let all = agrees && numerators.next().is_none();
        if all { Ok(()) } else { Err(ExpandError::Residual { order: n }.into()) }
    }
}
