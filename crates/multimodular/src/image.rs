//! Images of an expansion modulo primes, eight at once: derived, and substituted into the equation. Numbers are kept
//! modulo the product of two primes.

use crate::lifted::Lifted;
use crate::place::Place;
use crate::{Error, Names, Over};
use lindstedt_algebra::{RationalAlgebra, Ring, Stop};
use lindstedt_equation::Expression;
use lindstedt_expand::{
    Degrees, Equation, ExpandError, Expansion, Known, OrderNumbers, OrderWork, Request, Trace,
    check_from, compile, extend, partial_sums, trace,
};
use lindstedt_phase::Modular;
use lindstedt_phase::modular::{LANES, PrimeFields, PrimePair, Residues};
use lindstedt_series::Series;
use rug::Rational;
use std::sync::Arc;

/// Numbers in the place of eps at which an image of the frequency is checked ([`crate::CheckedImages`]).
const PARAMETERS: u32 = 3;

/// The numbers of an order that every image has, in this sequence.
const SERIES: [Place; 3] = [Place::Squared, Place::Frequency, Place::Period];

/// What is derived.
#[derive(Clone)]
pub(crate) struct Job<'a> {
    pub equation: &'a Expression,
    pub binding: &'a Names<'a>,
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

    /// The binary logarithm of the product of its primes.
    pub(crate) fn bits(&self) -> f64 {
        (self.ring.modulus() as f64).log2()
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

    /// The same with W_n, omega_n and T_n alone.
    pub(crate) fn brief(mut self) -> Self {
        self.values.iter_mut().for_each(|list| {
            list.truncate(SERIES.len());
            list.shrink_to_fit();
        });
        self.places = Arc::new(vec![SERIES.to_vec(); self.values.len()]);
        self
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

    /// W_n, omega_n and T_n modulo eight primes, with all that was formed on the way to them held against its operands at
    /// some numbers in the place of eps.
    pub(crate) fn brief_image(&self, field: PrimeFields, degrees: &[Degrees]) -> Attempt {
        let (algebra, equation) = self.over(field)?;
        let go_on = &mut |_: &OrderWork| !self.stop.asked();
        let found = trace(&algebra, &equation, &self.request, go_on);
        self.go_on()?;
        let trace = match found {
            Ok(trace) => trace,
            Err(unlucky) => return Ok(Err(unlucky)),
        };
        let checked = self.check_trace(&algebra, &equation, &trace, degrees);
        // A product that was broken off leaves a residual.
        self.go_on()?;
        checked?;
        let series = self.series(&field, trace.squared)?;
        self.check_series(&field, series.each_ref())?;
        let lists = (0..=self.request.order).map(|n| series.each_ref().map(|list| list[n]));
        let places = vec![SERIES.to_vec(); self.request.order + 1];
        Ok(Ok(parted(&field, places, lists)))
    }

    /// Whether what the driver formed modulo eight primes solves the equation.
    ///
    /// The Q points tell harmonics below 4Q apart up to the sign: h and 4Q - h are one function there. So where x_n has
    /// degree D_n, what has not been told apart stands in the harmonics from 4Q - D_n on, a product of orders k and n - k
    /// brings it down to 4Q - D_k - D_(n-k) and no further, derivatives and u'' + u = f leave it where it is: of
    /// order n the harmonics below 4Q - D_n are right, and depend on no others. With 4Q >= D + 2 these are the first
    /// two of all orders, from which the frequency follows.
    ///
    /// Products of series are checked at all points, the equation in all harmonics that are right, at some numbers e in the
    /// place of eps that the primes decide: what does not hold holds at one of p numbers with a chance of N/p.
    pub(crate) fn check_trace(
        &self,
        algebra: &Modular,
        equation: &Equation<Modular>,
        trace: &Trace<Modular>,
        degrees: &[Degrees],
    ) -> Result<(), Error> {
        let (field, order) = (algebra.field(), self.request.order);
        let stiffness = field.rational(&self.stiffness);
        let broken = Error::from(ExpandError::Residual { order });
        if !trace.is_normalised(algebra, &self.request) {
            return Err(ExpandError::Normalisation { order }.into());
        }
        if !is_product(field, [&trace.frequency, &trace.frequency], &trace.squared) {
            return Err(broken);
        }
        let degree = |of: &Degrees| of.iter().flatten().max().copied().unwrap_or(0);
        let right = |harmonic: usize| {
            degrees.partition_point(|of| harmonic + degree(of) < 4 * self.points).checked_sub(1)
        };
        let right: Vec<Option<usize>> = (0..=2 * self.points).map(right).collect();
        if right.iter().take(2).any(|last| *last != Some(order)) {
            return Err(broken);
        }
        let powers = |number: u32| {
            let e = field.rational(&Rational::from(seed(field.primes()[0], number)));
            let powers =
                std::iter::successors(Some(field.one()), |power| Some(field.mul(power, &e)));
            powers.take(order + 1).collect()
        };
        let powers: Vec<Vec<Residues>> = (0..PARAMETERS).map(powers).collect();
        let mut lists = trace.nodes.iter().chain([&trace.solution]);
        if !lists.all(|list| algebra.forms_agree(list, &powers))
            || !trace.nodes_hold_at(algebra, equation, &powers)
        {
            return Err(broken);
        }
        for powers in &powers {
            // kappa sum_l W_(n-l) x_l'' + F_n, n up to the last order that is right in this harmonic.
            let sums = partial_sums(field, &trace.squared, powers);
            let curvature = |l: usize, k: usize| {
                let last = right[k]?.checked_sub(l)?;
                let square = field.mul(&stiffness, &field.rational(&Rational::from(k * k)));
                Some(field.neg(&field.mul(&square, &field.mul(&powers[l], &sums[last]))))
            };
            let force = |n: usize, k: usize| (n <= right[k]?).then(|| powers[n]);
            let mut residual = algebra.weighted_sum(&trace.solution, curvature);
            let forces = algebra.weighted_sum(trace.force(equation), force);
            residual.iter_mut().zip(&forces).for_each(|(a, b)| field.add_assign(a, b));
            if residual.iter().any(|c| !field.is_zero(c)) {
                return Err(broken);
            }
        }
        Ok(())
    }

    /// omega^2 = W and omega T = 1.
    fn check_series(
        &self,
        field: &PrimeFields,
        [squared, frequency, period]: [&Vec<Residues>; 3],
    ) -> Result<(), Error> {
        let mut one = vec![field.zero(); period.len()];
        one[0] = field.one();
        let holds = is_product(field, [frequency, frequency], squared)
            && is_product(field, [frequency, period], &one);
        let broken = ExpandError::Residual { order: self.request.order };
        if holds { Ok(()) } else { Err(broken.into()) }
    }

    /// W, omega with omega^2 = W, and T with omega T = 1.
    fn series(
        &self,
        field: &PrimeFields,
        squared: Vec<Residues>,
    ) -> Result<[Vec<Residues>; 3], Error> {
        let squared = Series::truncated(squared);
        let Some(frequency) = squared.square_root(field) else { return Err(Error::OutOfPrimes) };
        let Some(period) = frequency.reciprocal(field) else { return Err(Error::OutOfPrimes) };
        Ok([squared, frequency, period].map(|series| series.coefficients))
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
        let series = self.series(&field, expansion.frequency_squared)?;
        let (mut places, mut lists) = (Vec::new(), Vec::new());
        for (n, x) in expansion.solution.iter().enumerate() {
            let [cos, sin] = algebra.harmonics(x);
            let cosines = cos.into_iter().enumerate().map(|(k, c)| (Place::Cosine(k), c));
            let sines = sin.into_iter().enumerate().map(|(k, c)| (Place::Sine(k), c));
            let used = cosines.chain(sines).filter(|(_, value)| !field.is_zero(value));
            let numbers = SERIES.into_iter().zip(series.each_ref().map(|list| list[n]));
            let (of_order, list): (Vec<_>, Vec<_>) = numbers.chain(used).unzip();
            places.push(of_order);
            lists.push(list);
        }
        Ok(Ok(parted(&field, places, lists.into_iter())))
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
        let expansion = self.stated(algebra, images)?;
        let checked = check_from(algebra, equation, &expansion, first);
        // A product that was broken off leaves a residual.
        self.go_on()?;
        let checked = checked?;
        let broken = Error::from(ExpandError::Residual { order: checked });
        if checked == self.request.order { Ok(()) } else { Err(broken) }
    }

    /// The expansion that the numbers of images state; omega^2 = W and omega T = 1.
    fn stated(&self, algebra: &Modular, images: &Group) -> Result<Expansion<Modular>, Error> {
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
        self.check_series(field, [&squared, &frequency, &period])?;
        let amplitude = field.rational(&self.request.leading_amplitude);
        Ok(Expansion {
            condition: self.request.condition,
            stiffness: field.rational(&self.stiffness),
            frequency_squared: squared,
            amplitude: vec![amplitude],
            solution,
            work: Vec::new(),
            certificates: Vec::new(),
        })
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

/// Whether a series is the product of two, as far as it goes.
fn is_product(field: &PrimeFields, factors: [&Vec<Residues>; 2], product: &Vec<Residues>) -> bool {
    let [a, b] = factors.map(|factor| Series::truncated(factor.clone()));
    a.mul(field, &b, product.len().saturating_sub(1)).coefficients == *product
}

/// Images from numbers modulo eight primes, order by order.
fn parted<L: AsRef<[Residues]>>(
    field: &PrimeFields,
    places: Vec<Vec<Place>>,
    lists: impl Iterator<Item = L>,
) -> Group {
    let mut values = [const { Vec::new() }; LANES / 2];
    for list in lists {
        let parts: Vec<_> = list.as_ref().iter().map(|value| field.parted(value)).collect();
        for (i, of_pair) in values.iter_mut().enumerate() {
            of_pair.push(parts.iter().map(|parts| parts[i]).collect());
        }
    }
    let places = Arc::new(places);
    std::array::from_fn(|i| Image {
        ring: field.pairs()[i],
        places: Arc::clone(&places),
        values: std::mem::take(&mut values[i]),
    })
}

/// A step of the generator splitmix64; another residue modulo every prime. Nothing else follows from these numbers.
fn seed(prime: u32, number: u32) -> u64 {
    let mut seed = u64::from(prime) << 32 | u64::from(number);
    seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    seed = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    seed = (seed ^ (seed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (seed >> 4).max(2)
}
