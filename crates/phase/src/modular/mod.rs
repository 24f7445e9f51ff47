//! Trigonometric polynomials modulo a prime, by their values.
//!
//! In Z/p with p = 1 mod 8Q there is a root of unity z of order 8Q, so that phases
//! psi_j = (2j + 1) pi/(4Q), j = 0..Q, make sense: cos k psi_j = (z^(k(2j+1)) + z^(-k(2j+1)))/2.
//! A function splits into four parts by its symmetries under psi -> -psi and psi -> pi - psi:
//! cosines and sines of even and of odd multiples. Each part is determined by its values on the
//! quarter period, parts multiply point by point, and a part that vanishes costs nothing (for
//! Duffing's equation three of four do, for van der Pol's all but one at every order).
//!
//! A product costs Q multiplications, against Q^2 for coefficient lists; the transforms that
//! derivation and the solution of u'' + u = f need cost Q^2 and happen once per order.

mod field;

pub use field::PrimeField;

use lindstedt_algebra::{
    FunctionAlgebra, PhaseAlgebra, PhaseError, RationalAlgebra, Resolution, Ring,
};
use rug::{Integer, Rational};
use std::sync::OnceLock;

/// The four symmetry parts, in this order.
const PARTS: [Part; 4] = [
    Part { sine: false, odd: false },
    Part { sine: false, odd: true },
    Part { sine: true, odd: false },
    Part { sine: true, odd: true },
];

/// Cosines or sines, of even or of odd multiples of the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    sine: bool,
    odd: bool,
}

impl Part {
    fn index(self) -> usize {
        2 * usize::from(self.sine) + usize::from(self.odd)
    }
    /// The k-th multiple of the part: 0, 2, 4 (cosines), 2, 4, 6 (sines) or 1, 3, 5.
    fn harmonic(self, k: usize) -> usize {
        match (self.sine, self.odd) {
            (false, false) => 2 * k,
            (true, false) => 2 * k + 2,
            (_, true) => 2 * k + 1,
        }
    }
}

/// A function: per part, nothing if it vanishes, or its values at the points.
#[derive(Clone, Debug)]
pub struct ModularElement {
    values: [Option<Vec<u64>>; 4],
    /// Fourier coefficients (cos_k, sin_k), where the element was made from them.
    harmonics: Option<[Vec<u64>; 2]>,
}

impl PartialEq for ModularElement {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

/// Trigonometric polynomials of bounded degree over Z/p.
///
/// Degrees are not tracked: the caller chooses the bound so that no product exceeds it
/// (products beyond it would alias).
#[derive(Clone, Debug)]
pub struct Modular {
    field: PrimeField,
    points: usize,
    /// cos(m pi/(4Q)) for m = 0..8Q, and the same for the sine.
    cos: Vec<u64>,
    sin: Vec<u64>,
    /// 2/Q, the normalisation of the forward transform.
    two_over_points: u64,
    half: u64,
    /// k and 1/(1 - k^2) for every harmonic k (zero for k = 1).
    multiples: Vec<u64>,
    inverse_divisors: Vec<u64>,
    tables: [OnceLock<BasisTable>; 4],
}

/// Q x Q values of basis functions, in the two orders in which transforms run through them.
#[derive(Clone, Debug)]
struct BasisTable {
    by_harmonic: Vec<u64>,
    by_point: Vec<u64>,
}

/// Tables of the basis at more points are not kept: their squares cost more than the few
/// transforms of a low order in a high degree.
const TABLED_POINTS: usize = 512;

impl Modular {
    /// The number of points per quarter period that represent harmonics up to `degree`, and the
    /// order of the root of unity that the prime must provide.
    pub fn points_for_degree(degree: usize) -> (usize, u64) {
        let points = degree / 2 + 2;
        (points, 8 * points as u64)
    }

    /// The algebra with the given number of points per quarter period; nothing when the field
    /// has no root of unity of order 8 `points`.
    pub fn new(field: PrimeField, points: usize) -> Option<Self> {
        let order = 8 * points as u64;
        let root = field.root_of_unity(order)?;
        let mut powers = vec![field.one()];
        for k in 1..8 * points {
            powers.push(field.mul(&powers[k - 1], &root));
        }
        let half = field.rational(&Rational::from((1, 2)));
        // i = z^(2Q), and 1/i = -i.
        let half_over_i = field.neg(&field.mul(&half, &powers[2 * points]));
        let combine = |m: usize, sign: bool, factor: u64| {
            let conjugate = powers[(8 * points - m) % (8 * points)];
            let conjugate = if sign { conjugate } else { field.neg(&conjugate) };
            field.mul(&field.add(&powers[m], &conjugate), &factor)
        };
        let cos = (0..8 * points).map(|m| combine(m, true, half)).collect();
        let sin = (0..8 * points).map(|m| combine(m, false, half_over_i)).collect();
        let two_over_points = field.rational(&Rational::from((2, points)));
        let integer = |n: i64| field.integer(&Integer::from(n));
        let harmonics = 0..=2 * points as i64;
        let inverse = |k: i64| field.reciprocal(&integer(1 - k * k)).unwrap_or(0);
        Some(Self {
            field,
            points,
            cos,
            sin,
            two_over_points,
            half,
            multiples: harmonics.clone().map(integer).collect(),
            inverse_divisors: harmonics.map(inverse).collect(),
            tables: [const { OnceLock::new() }; 4],
        })
    }

    /// The values of the basis functions of a part at the points, made when first needed.
    fn table(&self, part: Part) -> &BasisTable {
        self.tables[part.index()].get_or_init(|| {
            let basis = if part.sine { &self.sin } else { &self.cos };
            let value = |k: usize, j: usize| basis[part.harmonic(k) * (2 * j + 1) % basis.len()];
            let table = |entry: &dyn Fn(usize, usize) -> u64| {
                let row = |i| (0..self.points).map(move |j| (i, j));
                (0..self.points).flat_map(row).map(|(i, j)| entry(i, j)).collect()
            };
            BasisTable { by_harmonic: table(&value), by_point: table(&|j, k| value(k, j)) }
        })
    }

    /// The field.
    pub fn field(&self) -> &PrimeField {
        &self.field
    }

    /// Fourier coefficients of a part from its values: by discrete orthogonality at the points
    /// (2j+1) pi/(4Q), sum_j cos k psi_j cos m psi_j = Q/2 delta_km for 0 < k < 2Q.
    fn forward(&self, part: Part, values: &[u64]) -> Vec<u64> {
        let coefficient = |(k, row): (usize, &[u64])| {
            let harmonic = part.harmonic(k);
            let sum = self.field.mul(&self.field.dot(row, values), &self.two_over_points);
            // The constant and sin 2Q psi have twice the norm.
            if harmonic == 0 || harmonic == 2 * self.points {
                self.field.mul(&sum, &self.half)
            } else {
                sum
            }
        };
        if self.points <= TABLED_POINTS {
            let rows = self.table(part).by_harmonic.chunks(self.points);
            return rows.enumerate().map(coefficient).collect();
        }
        let mut row = Vec::with_capacity(self.points);
        let each = (0..self.points).map(|k| {
            let harmonic = part.harmonic(k);
            self.row(part, harmonic, 2 * harmonic, self.points, &mut row);
            coefficient((k, &row))
        });
        each.collect()
    }

    /// The basis at a start and further arguments of equal distance, in units of the step of the
    /// table of the sine: a row of the table of the part that is not kept.
    fn row(&self, part: Part, start: usize, step: usize, count: usize, row: &mut Vec<u64>) {
        let basis = if part.sine { &self.sin } else { &self.cos };
        let (mut index, step) = (start % basis.len(), step % basis.len());
        row.clear();
        for _ in 0..count {
            row.push(basis[index]);
            index += step;
            if index >= basis.len() {
                index -= basis.len();
            }
        }
    }

    /// Values of a part from its coefficients.
    fn backward(&self, part: Part, coefficients: &[u64]) -> Option<Vec<u64>> {
        let used = coefficients.iter().rposition(|&c| c != 0)? + 1;
        if self.points > TABLED_POINTS {
            let mut row = Vec::with_capacity(used);
            let each = (0..self.points).map(|j| {
                let (first, second) = (part.harmonic(0), part.harmonic(1));
                let odd = 2 * j + 1;
                self.row(part, first * odd, (second - first) * odd, used, &mut row);
                self.field.dot(&row, &coefficients[..used])
            });
            return Some(each.collect());
        }
        let rows = self.table(part).by_point.chunks(self.points);
        Some(rows.map(|row| self.field.dot(row, &coefficients[..used])).collect())
    }

    /// The Fourier coefficients (cos_k, sin_k) of an element, up to the highest harmonic.
    pub fn harmonics(&self, f: &ModularElement) -> [Vec<u64>; 2] {
        if let Some(known) = &f.harmonics {
            return known.clone();
        }
        let mut lists = [vec![0; 2 * self.points + 1], vec![0; 2 * self.points + 1]];
        for part in PARTS {
            let Some(values) = &f.values[part.index()] else { continue };
            let list = &mut lists[usize::from(part.sine)];
            for (k, c) in self.forward(part, values).into_iter().enumerate() {
                list[part.harmonic(k)] = c;
            }
        }
        lists
    }

    /// The element with given Fourier coefficients.
    pub fn from_harmonics(&self, mut harmonics: [Vec<u64>; 2]) -> ModularElement {
        for list in &mut harmonics {
            list.resize(2 * self.points + 1, 0);
        }
        let values = PARTS.map(|part| {
            let list = &harmonics[usize::from(part.sine)];
            let coefficients: Vec<u64> = (0..self.points).map(|k| list[part.harmonic(k)]).collect();
            self.backward(part, &coefficients)
        });
        ModularElement { values, harmonics: Some(harmonics) }
    }

    fn map(&self, f: &ModularElement, g: impl Fn(u64) -> u64) -> ModularElement {
        let image = |list: &Vec<u64>| -> Vec<u64> { list.iter().map(|&x| g(x)).collect() };
        self.canonical(ModularElement {
            values: f.values.each_ref().map(|values| values.as_ref().map(image)),
            harmonics: f.harmonics.as_ref().map(|lists| lists.each_ref().map(image)),
        })
    }

    /// A part whose values all vanish is absent.
    fn canonical(&self, mut f: ModularElement) -> ModularElement {
        for part in &mut f.values {
            if part.as_ref().is_some_and(|values| values.iter().all(|&v| v == 0)) {
                *part = None;
            }
        }
        f
    }

    fn add_lists(&self, a: &mut [u64], b: &[u64]) {
        for (x, y) in a.iter_mut().zip(b) {
            self.field.add_assign(x, y);
        }
    }
}

impl Ring for Modular {
    type Element = ModularElement;

    fn zero(&self) -> ModularElement {
        ModularElement { values: [const { None }; 4], harmonics: None }
    }
    fn one(&self) -> ModularElement {
        self.embed(&self.field.one())
    }
    fn is_zero(&self, f: &ModularElement) -> bool {
        f.values.iter().all(Option::is_none)
    }
    fn add_assign(&self, f: &mut ModularElement, g: &ModularElement) {
        if self.is_zero(f) {
            f.clone_from(g);
            return;
        }
        if self.is_zero(g) {
            return;
        }
        for (x, y) in f.values.iter_mut().zip(&g.values) {
            match (x.as_mut(), y) {
                (_, None) => {}
                (None, Some(y)) => *x = Some(y.clone()),
                (Some(x), Some(y)) => self.add_lists(x, y),
            }
        }
        match (f.harmonics.as_mut(), &g.harmonics) {
            (Some(own), Some(other)) => {
                for (x, y) in own.iter_mut().zip(other) {
                    self.add_lists(x, y);
                }
            }
            _ => f.harmonics = None,
        }
        *f = self.canonical(std::mem::replace(f, self.zero()));
    }
    fn neg(&self, f: &ModularElement) -> ModularElement {
        self.map(f, |x| self.field.neg(&x))
    }
    fn mul(&self, f: &ModularElement, g: &ModularElement) -> ModularElement {
        self.sum_of_products(&[(f, g)])
    }
    fn sum_of_products(&self, pairs: &[(&ModularElement, &ModularElement)]) -> ModularElement {
        let mut factors: [Vec<(&[u64], &[u64])>; 4] = [const { Vec::new() }; 4];
        for (f, g) in pairs {
            for p in PARTS {
                for q in PARTS {
                    if let (Some(a), Some(b)) = (&f.values[p.index()], &g.values[q.index()]) {
                        let part = Part { sine: p.sine ^ q.sine, odd: p.odd ^ q.odd };
                        factors[part.index()].push((a, b));
                    }
                }
            }
        }
        let values = factors.map(|pairs| (!pairs.is_empty()).then(|| self.field.pointwise(&pairs)));
        self.canonical(ModularElement { values, harmonics: None })
    }
}

impl RationalAlgebra for Modular {
    fn rational(&self, q: &Rational) -> ModularElement {
        self.embed(&self.field.rational(q))
    }
    fn scale(&self, f: &ModularElement, q: &Rational) -> ModularElement {
        self.scale_by(f, &self.field.rational(q))
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
    type Constants = PrimeField;
    fn constants(&self) -> &PrimeField {
        &self.field
    }
    fn embed(&self, c: &u64) -> ModularElement {
        let mut f = self.zero();
        f.values[0] = (*c != 0).then(|| vec![*c; self.points]);
        f
    }
    fn scale_by(&self, f: &ModularElement, c: &u64) -> ModularElement {
        self.map(f, |x| self.field.mul(&x, c))
    }
    fn linear_combination(&self, terms: &[(&ModularElement, &u64)]) -> ModularElement {
        let constants: Vec<ModularElement> = terms.iter().map(|(_, c)| self.embed(c)).collect();
        let pairs: Vec<_> = terms.iter().zip(&constants).map(|((f, _), c)| (*f, c)).collect();
        self.sum_of_products(&pairs)
    }
    fn as_constant(&self, f: &ModularElement) -> Option<u64> {
        match &f.values {
            [None, None, None, None] => Some(0),
            [Some(values), None, None, None] => {
                let first = *values.first()?;
                values.iter().all(|&v| v == first).then_some(first)
            }
            _ => None,
        }
    }
    /// ln 1 = 0; no other logarithm is a trigonometric polynomial.
    fn log_abs(&self, f: &ModularElement) -> Option<ModularElement> {
        (*f == self.one()).then(|| self.zero())
    }
    fn terms(&self, f: &ModularElement) -> usize {
        let [cos, sin] = self.harmonics(f);
        cos.iter().chain(&sin).filter(|&&c| c != 0).count()
    }
}

impl PhaseAlgebra for Modular {
    fn cosine(&self) -> ModularElement {
        self.from_harmonics([vec![0, self.field.one()], Vec::new()])
    }
    fn sine(&self) -> ModularElement {
        self.from_harmonics([Vec::new(), vec![0, self.field.one()]])
    }
    fn derivative(&self, f: &ModularElement) -> ModularElement {
        let [cos, sin] = self.harmonics(f);
        let times = |list: Vec<u64>| -> Vec<u64> {
            list.iter().zip(&self.multiples).map(|(c, k)| self.field.mul(c, k)).collect()
        };
        let cos: Vec<u64> = times(cos).iter().map(|c| self.field.neg(c)).collect();
        self.from_harmonics([times(sin), cos])
    }
    fn at_zero(&self, f: &ModularElement) -> Option<u64> {
        let [cos, _] = self.harmonics(f);
        Some(cos.iter().fold(0, |sum, c| self.field.add(&sum, c)))
    }
    fn first_harmonic(&self, f: &ModularElement) -> Result<(u64, u64), PhaseError> {
        let [cos, sin] = self.harmonics(f);
        Ok((cos[1], sin[1]))
    }
    fn resolve(&self, f: &ModularElement) -> Result<Resolution<Self>, PhaseError> {
        let [mut cos, mut sin] = self.harmonics(f);
        let (cos_amplitude, sin_amplitude) = (cos[1], sin[1]);
        let (mut value, mut slope) = (0, 0);
        for k in 0..cos.len() {
            cos[k] = self.field.mul(&cos[k], &self.inverse_divisors[k]);
            sin[k] = self.field.mul(&sin[k], &self.inverse_divisors[k]);
            self.field.add_assign(&mut value, &cos[k]);
            self.field.add_assign(&mut slope, &self.field.mul(&sin[k], &self.multiples[k]));
        }
        cos[1] = self.field.neg(&value);
        sin[1] = self.field.neg(&slope);
        let response = self.from_harmonics([cos, sin]);
        Ok(Resolution { cos_amplitude, sin_amplitude, response })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lindstedt_algebra::laws;

    #[test]
    fn laws_hold() {
        let (points, modulus) = Modular::points_for_degree(24);
        let field = PrimeField::with_roots_of_unity(modulus, 1 << 61).next();
        let a = field.and_then(|field| Modular::new(field, points)).expect("an algebra");
        let n = |k: i64| a.field.integer(&Integer::from(k));
        let mixed =
            a.from_harmonics([vec![n(3), n(-1), n(4), 0, n(7)], vec![0, n(5), n(9), n(-2)]]);
        let odd = a.from_harmonics([vec![0, n(2), 0, n(-6)], Vec::new()]);
        let samples = [a.zero(), a.one(), a.cosine(), a.sine(), mixed, odd];
        // `as_rational` does not apply to a finite field; the other laws do.
        assert_eq!(laws::ring(&a, &samples), Ok(()));
        assert_eq!(laws::derivation_and_solution(&a, &samples), Ok(()));
    }
}
