//! Trigonometric polynomials modulo a prime, by coefficients and by values.
//!
//! In Z/p with p = 1 mod 8Q there is a root of unity z of order 8Q, so that phases
//! psi_j = (2j + 1) pi/(4Q), j = 0..Q, make sense: cos k psi_j = (z^(k(2j+1)) + z^(-k(2j+1)))/2.
//! A function splits into four parts by its symmetries under psi -> -psi and psi -> pi - psi:
//! cosines and sines of even and of odd multiples. Each part is determined by its values on the
//! quarter period, and a part that vanishes costs nothing (for Duffing's equation three of four do,
//! for van der Pol's all but one at every order).
//!
//! Sums, derivatives and the solution of u'' + u = f are taken of Fourier coefficients, products point by
//! point at Q multiplications, against Q^2 for coefficient lists. Each form of a part is made from the other
//! when it is first needed, and kept (`transform`).

mod fields;
mod pair;
mod part;
mod primes;
mod symmetry;
mod transform;
mod words;

pub use fields::{LANES, PrimeFields, Residues};
pub use pair::PrimePair;

use lindstedt_algebra::{
    FunctionAlgebra, PhaseAlgebra, PhaseError, Products, RationalAlgebra, Resolution, Ring, Stop,
};
use part::{Forms, Part, is_zero, lacking};
use rug::{Integer, Rational};
use std::sync::Arc;
use symmetry::{SYMMETRIES, Symmetry};
use transform::Transform;

/// A function: its part of every symmetry, nothing where that vanishes.
#[derive(Clone, Debug, PartialEq)]
pub struct ModularElement {
    parts: [Option<Part>; 4],
}

/// Trigonometric polynomials of bounded degree over Z/p.
///
/// Degrees are not tracked: the caller chooses the bound so that no product exceeds it
/// (products beyond it would alias).
#[derive(Clone, Debug)]
pub struct Modular {
    field: PrimeFields,
    points: usize,
    transform: Arc<Transform>,
    /// By symmetry: k for sines and -k for cosines, and 1/(1 - k^2) for every harmonic k (zero for k = 1).
    slopes: [Vec<Residues>; 4],
    inverse_divisors: [Vec<Residues>; 4],
    stop: Stop,
}

impl Modular {
    /// The number of points per quarter period that represent harmonics up to `degree`, and the
    /// order of the root of unity that the prime must provide.
    pub fn points_for_degree(degree: usize) -> (usize, u64) {
        let (rows, columns) = transform::size(degree / 2 + 2);
        (rows * columns, 8 * (rows * columns) as u64)
    }

    /// The same where products up to `degree` need only be right in the first harmonics: harmonics h and 4Q - h are one
    /// function at the points, so that those below 4Q - `degree` stay apart from all others.
    pub fn points_for_first_harmonic(degree: usize) -> (usize, u64) {
        let (rows, columns) = transform::size((degree + 2).div_ceil(4));
        (rows * columns, 8 * (rows * columns) as u64)
    }

    /// The algebra with the given number of points per quarter period; nothing when the field
    /// has no root of unity of order 8 `points`.
    pub fn new(field: PrimeFields, points: usize) -> Option<Self> {
        let root = field.root_of_unity(8 * points as u64)?;
        let harmonics = 0..=2 * points as i64;
        let integer = |n: i64| field.integer(&Integer::from(n));
        let divisor = |k: i64| if k == 1 { field.one() } else { integer(1 - k * k) };
        let divisors: Vec<Residues> = harmonics.map(divisor).collect();
        let mut inverse_divisors = field.reciprocals(&divisors)?;
        inverse_divisors[1] = field.zero();
        let by_symmetry = |value: &dyn Fn(Symmetry, usize) -> Residues| {
            let of = |symmetry: Symmetry| {
                (0..points).map(|k| value(symmetry, symmetry.harmonic(k))).collect()
            };
            SYMMETRIES.map(of)
        };
        let slope = |symmetry: Symmetry, k: usize| {
            integer(if symmetry.sine { k as i64 } else { -(k as i64) })
        };
        Some(Self {
            field,
            points,
            transform: Arc::new(Transform::new(field, points, root)?),
            slopes: by_symmetry(&slope),
            inverse_divisors: by_symmetry(&|_, k| inverse_divisors[k]),
            stop: Stop::default(),
        })
    }

    /// The algebra whose products are zero once `stop` says so.
    #[must_use]
    pub fn with_stop(self, stop: Stop) -> Self {
        Self { stop, ..self }
    }

    /// The field.
    pub fn field(&self) -> &PrimeFields {
        &self.field
    }

    /// Nothing if it vanishes.
    fn part(&self, symmetry: Symmetry, coefficients: Vec<Residues>) -> Option<Part> {
        self.part_of(symmetry, Some(coefficients), None)
    }

    fn part_of(
        &self,
        symmetry: Symmetry,
        coefficients: Option<Vec<Residues>>,
        values: Option<Vec<Residues>>,
    ) -> Option<Part> {
        let transform = Arc::clone(&self.transform);
        Part { symmetry, forms: Arc::default(), transform }.with_forms(coefficients, values)
    }

    /// The Fourier coefficients (cos_k, sin_k) of an element, up to the highest harmonic.
    pub fn harmonics(&self, f: &ModularElement) -> [Vec<Residues>; 2] {
        let zeros = || vec![self.field.zero(); 2 * self.points + 1];
        let mut lists = [zeros(), zeros()];
        for symmetry in SYMMETRIES {
            let Some(part) = &f.parts[symmetry.index()] else { continue };
            let list = &mut lists[usize::from(symmetry.sine)];
            for (k, &c) in part.coefficients().iter().enumerate() {
                list[symmetry.harmonic(k)] = c;
            }
        }
        lists
    }

    /// The element with given Fourier coefficients.
    pub fn from_harmonics(&self, harmonics: [Vec<Residues>; 2]) -> ModularElement {
        let parts = SYMMETRIES.map(|symmetry| {
            let list = harmonics[usize::from(symmetry.sine)].iter();
            let own = list.skip(symmetry.harmonic(0)).step_by(2).take(self.points);
            let length = own.clone().rposition(|c| !is_zero(c))? + 1;
            self.part(symmetry, own.take(length).copied().collect())
        });
        ModularElement { parts }
    }

    /// Whether the coefficients and the values of functions belong together where both are known: those of
    /// sum_n c_n f_n, for some random c.
    pub fn forms_agree(&self, f: &[ModularElement], c: &[Vec<Residues>]) -> bool {
        SYMMETRIES.into_iter().all(|symmetry| {
            let forms: Vec<_> = f
                .iter()
                .enumerate()
                .filter_map(|(n, f)| {
                    let Forms { coefficients, values } =
                        &*f.parts[symmetry.index()].as_ref()?.forms;
                    Some((n, [coefficients.get()?.as_slice(), values.get()?.as_slice()]))
                })
                .collect();
            let [coefficients, values] = [0, 1].map(|form| {
                let terms =
                    |c: &Vec<Residues>| forms.iter().map(|(n, f)| (f[form], c[*n])).collect();
                self.field.sums(&c.iter().map(terms).collect::<Vec<_>>())
            });
            let agree = |(coefficients, values): (Vec<_>, Vec<_>)| {
                self.transform.values(symmetry, &coefficients) == values
            };
            forms.is_empty() || coefficients.into_iter().zip(values).all(agree)
        })
    }

    /// sum_n c_(n,k) f_(n,k) for every harmonic k of every symmetry, where there is a factor.
    pub fn weighted_sum(
        &self,
        f: &[ModularElement],
        factor: impl Fn(usize, usize) -> Option<Residues>,
    ) -> Vec<Residues> {
        let mut sums = vec![self.field.zero(); SYMMETRIES.len() * self.points];
        for (n, f) in f.iter().enumerate() {
            for part in f.parts.iter().flatten() {
                let sums = &mut sums[part.symmetry.index() * self.points..][..self.points];
                for (k, (sum, c)) in sums.iter_mut().zip(part.coefficients()).enumerate() {
                    if let Some(factor) = factor(n, part.symmetry.harmonic(k)) {
                        *sum = self.field.sum(sum, &self.field.product(c, &factor));
                    }
                }
            }
        }
        sums
    }

    /// One coefficient, of harmonic k of the symmetry.
    fn single(&self, symmetry: Symmetry, k: usize, c: Residues) -> ModularElement {
        let mut f = self.zero();
        let mut coefficients = vec![self.field.zero(); k];
        coefficients.push(c);
        f.parts[symmetry.index()] = self.part(symmetry, coefficients);
        f
    }

    fn coefficient(&self, f: &ModularElement, symmetry: Symmetry, k: usize) -> Residues {
        let part = f.parts[symmetry.index()].as_ref();
        part.and_then(|part| part.coefficients().get(k).copied()).unwrap_or_default()
    }

    /// Sums of products, those of the second half of a list twice, point by point.
    fn products(&self, lists: &[Products<'_, ModularElement>]) -> Vec<ModularElement> {
        if self.stop.asked() {
            return lists.iter().map(|_| self.zero()).collect();
        }
        // Once and twice, by symmetry; no pairs where no product has it.
        let factors: Vec<[Factors<'_>; 4]> =
            lists.iter().flatten().map(|pairs| factors(pairs)).collect();
        let is_there = |pairs: &&Factors<'_>| !pairs.is_empty();
        let there: Vec<_> = factors.iter().flatten().filter(is_there).cloned().collect();
        let mut values = self.field.sums(&there).into_iter();
        let mut rows = factors.iter().map(|by_symmetry| {
            by_symmetry.each_ref().map(|pairs| is_there(&pairs).then(|| values.next()).flatten())
        });
        let mut sum = || {
            let [once, twice] = [rows.next(), rows.next()].map(Option::unwrap_or_default);
            let mut sum = self.zero();
            for (symmetry, (once, twice)) in SYMMETRIES.into_iter().zip(once.into_iter().zip(twice))
            {
                let twice = twice.map(|mut list| {
                    list.iter_mut().for_each(|a| *a = self.field.add(a, a));
                    list
                });
                let values = match (once, twice) {
                    (Some(mut a), Some(b)) => {
                        add_lists(&self.field, &mut a, &b);
                        Some(a)
                    }
                    (a, b) => a.or(b),
                };
                sum.parts[symmetry.index()] = self.part_of(symmetry, None, values);
            }
            sum
        };
        lists.iter().map(|_| sum()).collect()
    }
}

/// Pairs of values at the points.
type Factors<'a> = Vec<(&'a [Residues], &'a [Residues])>;

/// The products of parts that a sum of products is, by symmetry.
fn factors<'a>(pairs: &[(&'a ModularElement, &'a ModularElement)]) -> [Factors<'a>; 4] {
    let mut factors: [Factors<'a>; 4] = [const { Vec::new() }; 4];
    for (f, g) in pairs {
        for p in SYMMETRIES {
            for q in SYMMETRIES {
                if let (Some(a), Some(b)) = (&f.parts[p.index()], &g.parts[q.index()]) {
                    let list = &mut factors[p.times(q).index()];
                    if list.is_empty() {
                        list.reserve(pairs.len());
                    }
                    list.push((a.values(), b.values()));
                }
            }
        }
    }
    factors
}

/// The parts of one symmetry of linear combinations.
fn of_symmetry<'a>(
    terms: &[(&'a ModularElement, &Residues)],
    symmetry: Symmetry,
) -> Vec<(&'a Part, Residues)> {
    let part =
        |(f, c): &(&'a ModularElement, &Residues)| Some((f.parts[symmetry.index()].as_ref()?, **c));
    terms.iter().filter_map(part).collect()
}

fn add_lists(field: &PrimeFields, a: &mut [Residues], b: &[Residues]) {
    for (x, y) in a.iter_mut().zip(b) {
        field.add_assign(x, y);
    }
}

impl Ring for Modular {
    type Element = ModularElement;

    fn zero(&self) -> ModularElement {
        ModularElement { parts: [const { None }; 4] }
    }
    fn one(&self) -> ModularElement {
        self.embed(&self.field.one())
    }
    fn is_zero(&self, f: &ModularElement) -> bool {
        f.parts.iter().all(Option::is_none)
    }
    fn add_assign(&self, f: &mut ModularElement, g: &ModularElement) {
        for (a, b) in f.parts.iter_mut().zip(&g.parts) {
            if let Some(b) = b {
                let one = self.field.one();
                *a = match a.take() {
                    Some(a) => Part::combination(&self.field, &[(&a, one), (b, one)]),
                    None => Some(b.clone()),
                };
            }
        }
    }
    fn neg(&self, f: &ModularElement) -> ModularElement {
        self.scale_by(f, &self.field.neg(&self.field.one()))
    }
    fn mul(&self, f: &ModularElement, g: &ModularElement) -> ModularElement {
        self.sum_of_products(&[(f, g)])
    }
    /// What has a constant factor is a linear combination, which needs no transform.
    fn sum_of_products(&self, pairs: &[(&ModularElement, &ModularElement)]) -> ModularElement {
        let (mut terms, mut rest) = (Vec::new(), Vec::new());
        let mut constants = Vec::new();
        for &(f, g) in pairs {
            match (self.as_constant(f), self.as_constant(g)) {
                (Some(c), _) => {
                    terms.push(g);
                    constants.push(c);
                }
                (_, Some(c)) => {
                    terms.push(f);
                    constants.push(c);
                }
                _ => rest.push((f, g)),
            }
        }
        let terms: Vec<_> = terms.into_iter().zip(&constants).collect();
        let linear = self.linear_combination(&terms);
        if rest.is_empty() {
            return linear;
        }
        let mut sums = self.products(&[[rest, Vec::new()]]);
        let mut sum = sums.pop().unwrap_or_else(|| self.zero());
        self.add_assign(&mut sum, &linear);
        sum
    }
    fn coefficient_of_square(
        &self,
        pairs: &[(&ModularElement, &ModularElement)],
        middle: Option<&ModularElement>,
    ) -> ModularElement {
        let middle: Vec<_> = middle.map(|m| (m, m)).into_iter().collect();
        let mut sums = self.products(&[[middle, pairs.to_vec()]]);
        sums.pop().unwrap_or_else(|| self.zero())
    }
    const SUMS_AT_ONCE: bool = true;
    fn sums_of_products(&self, lists: &[Products<'_, ModularElement>]) -> Vec<ModularElement> {
        self.products(lists)
    }
}

impl RationalAlgebra for Modular {
    fn rational(&self, q: &Rational) -> ModularElement {
        self.embed(&self.field.rational(q))
    }
    fn scale(&self, f: &ModularElement, q: &Rational) -> ModularElement {
        if *q == 1 { f.clone() } else { self.scale_by(f, &self.field.rational(q)) }
    }
    /// Only constants are units.
    fn reciprocal(&self, f: &ModularElement) -> Option<ModularElement> {
        Some(self.embed(&self.field.reciprocal(&self.as_constant(f)?)?))
    }
    fn as_rational(&self, _: &ModularElement) -> Option<Rational> {
        None
    }
}

impl FunctionAlgebra for Modular {
    type Constants = PrimeFields;
    fn constants(&self) -> &PrimeFields {
        &self.field
    }
    fn interrupted(&self) -> bool {
        self.stop.asked()
    }
    fn embed(&self, c: &Residues) -> ModularElement {
        self.single(Symmetry { sine: false, odd: false }, 0, *c)
    }
    fn scale_by(&self, f: &ModularElement, c: &Residues) -> ModularElement {
        let parts = f.parts.each_ref();
        ModularElement { parts: parts.map(|part| part.as_ref()?.times(&self.field, c)) }
    }
    fn linear_combination(&self, terms: &[(&ModularElement, &Residues)]) -> ModularElement {
        let parts = SYMMETRIES
            .map(|symmetry| Part::combination(&self.field, &of_symmetry(terms, symmetry)));
        ModularElement { parts }
    }
    fn linear_combinations(
        &self,
        lists: &[Vec<(&ModularElement, &Residues)>],
    ) -> Vec<ModularElement> {
        let mut elements = vec![self.zero(); lists.len()];
        for symmetry in SYMMETRIES {
            let parts: Vec<_> = lists.iter().map(|terms| of_symmetry(terms, symmetry)).collect();
            let [no_coefficients, no_values] =
                lacking(parts.iter().flatten().map(|(part, _)| *part));
            let by_values = no_coefficients > no_values;
            let form = if by_values { Part::values } else { Part::coefficients };
            let rows: Vec<Vec<_>> = parts
                .iter()
                .map(|terms| terms.iter().map(|&(part, c)| (form(part), c)).collect())
                .collect();
            let sums = self.field.sums(&rows);
            for (element, sum) in elements.iter_mut().zip(sums) {
                let forms = if by_values { [None, Some(sum)] } else { [Some(sum), None] };
                let [coefficients, values] = forms;
                element.parts[symmetry.index()] = self.part_of(symmetry, coefficients, values);
            }
        }
        elements
    }
    fn as_constant(&self, f: &ModularElement) -> Option<Residues> {
        match &f.parts {
            [None, None, None, None] => Some(self.field.zero()),
            [Some(part), None, None, None] => {
                match part.forms.coefficients.get().map(Vec::as_slice) {
                    Some([constant]) => Some(*constant),
                    Some(_) => None,
                    None => {
                        let (first, rest) = part.values().split_first()?;
                        rest.iter().all(|value| value == first).then_some(*first)
                    }
                }
            }
            _ => None,
        }
    }
    /// ln 1 = 0; no other logarithm is a trigonometric polynomial.
    fn log_abs(&self, f: &ModularElement) -> Option<ModularElement> {
        (*f == self.one()).then(|| self.zero())
    }
    fn terms(&self, f: &ModularElement) -> usize {
        let lists = f.parts.iter().flatten().map(Part::coefficients);
        lists.flatten().filter(|c| !is_zero(c)).count()
    }
}

impl PhaseAlgebra for Modular {
    fn cosine(&self) -> ModularElement {
        self.single(Symmetry { sine: false, odd: true }, 0, self.field.one())
    }
    fn sine(&self) -> ModularElement {
        self.single(Symmetry { sine: true, odd: true }, 0, self.field.one())
    }
    fn derivative(&self, f: &ModularElement) -> ModularElement {
        let mut derivative = self.zero();
        for symmetry in SYMMETRIES {
            let Some(part) = &f.parts[symmetry.index()] else { continue };
            let image = Symmetry { sine: !symmetry.sine, odd: symmetry.odd };
            let coefficients = part.coefficients();
            let factors = &*self.slopes[symmetry.index()];
            let mut list = self.field.pointwise(&[(coefficients, factors)], coefficients.len());
            // cos 2m psi is number m, sin 2m psi number m - 1.
            match (symmetry.sine, symmetry.odd) {
                (false, false) => drop(list.remove(0)),
                (true, false) => list.insert(0, self.field.zero()),
                _ => {}
            }
            derivative.parts[image.index()] = self.part(image, list);
        }
        derivative
    }
    fn at_zero(&self, f: &ModularElement) -> Option<Residues> {
        let cosines = f.parts[..2].iter().flatten().flat_map(Part::coefficients);
        Some(cosines.fold(self.field.zero(), |sum, c| self.field.add(&sum, c)))
    }
    fn first_harmonic(&self, f: &ModularElement) -> Result<(Residues, Residues), PhaseError> {
        let [cosine, sine] =
            [false, true].map(|sine| self.coefficient(f, Symmetry { sine, odd: true }, 0));
        Ok((cosine, sine))
    }
    fn resolve(&self, f: &ModularElement) -> Result<Resolution<Self>, PhaseError> {
        let (cos_amplitude, sin_amplitude) = self.first_harmonic(f)?;
        let parts = SYMMETRIES.map(|symmetry| {
            let coefficients = f.parts[symmetry.index()].as_ref()?.coefficients();
            let factors = &*self.inverse_divisors[symmetry.index()];
            let list = self.field.pointwise(&[(coefficients, factors)], coefficients.len());
            self.part(symmetry, list)
        });
        let mut response = ModularElement { parts };
        let value = self.at_zero(&response).unwrap_or_default();
        let slope = self.at_zero(&self.derivative(&response)).unwrap_or_default();
        for (sine, c) in [(false, value), (true, slope)] {
            let homogeneous = self.single(Symmetry { sine, odd: true }, 0, self.field.neg(&c));
            self.add_assign(&mut response, &homogeneous);
        }
        Ok(Resolution { cos_amplitude, sin_amplitude, response })
    }
}

#[cfg(test)]
mod tests;
