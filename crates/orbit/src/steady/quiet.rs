//! Unknowns whose phase no term of a flow sees: w_j -> e^{i theta} w_j turns G_j along and leaves the other G_i as they are, so
//! that G_j = (A_j + i B_j) w_j with polynomials A_j, B_j in the other unknowns and |w_j|^2. A state with w_j != 0 asks for
//! A_j = B_j = 0, one equation more than it has unknowns, and as a rule there is none; but boxes on which G_j shows that
//! are small. So that there is none is shown on boxes of the other unknowns and the |w_k|^2, and what is left are the states
//! with w_j = 0, of fewer unknowns.

use super::balance::Balance;
use super::krawczyk::{Region, Zero, middle};
use super::search::{Found, Limits, Places, halved, modulus, zeros_at};
use super::{ComplexTerm, Flow, System, Value};
use lindstedt_number::interval::Interval;
use rug::Rational;

/// Equations with such unknowns.
struct Quiet<'a> {
    equations: &'a [Vec<ComplexTerm>],
    free: Vec<usize>,
    tied: Vec<usize>,
}

/// Boxes looked at to show that an unknown is zero.
const MOST_BOXES: usize = 100_000;

impl<'a> Quiet<'a> {
    /// Nothing where no phase is free, or all are.
    fn of(equations: &'a [Vec<ComplexTerm>]) -> Option<Self> {
        let is_free = |j: &usize| {
            equations.iter().enumerate().all(|(i, terms)| {
                let own = u32::from(i == *j);
                terms.iter().all(|t| t.amplitudes[2 * j] == t.amplitudes[2 * j + 1] + own)
            })
        };
        let (free, tied): (Vec<_>, Vec<_>) = (0..equations.len()).partition(is_free);
        let some = !free.is_empty() && !tied.is_empty();
        some.then_some(Self { equations, free, tied })
    }

    /// The term in the tied unknowns, the |w_k|^2 of the free ones being parameters before the others.
    fn in_squares(&self, term: &ComplexTerm) -> ComplexTerm {
        let amplitudes = self.tied.iter().flat_map(|i| &term.amplitudes[2 * i..2 * i + 2]);
        let squares = self.free.iter().map(|k| term.amplitudes[2 * k + 1]);
        ComplexTerm {
            amplitudes: amplitudes.copied().collect(),
            parameters: squares.chain(term.parameters.iter().copied()).collect(),
            ..term.clone()
        }
    }

    /// G of the tied unknowns where the free ones are zero.
    fn tied_flow(&self, parameters: &[String]) -> Flow {
        let still = |term: &&ComplexTerm| self.free.iter().all(|k| term.amplitudes[2 * k + 1] == 0);
        let reduced = |term: &ComplexTerm| {
            let mut term = self.in_squares(term);
            term.parameters.drain(..self.free.len());
            term
        };
        let equation =
            |i: &usize| self.equations[*i].iter().filter(still).map(reduced).collect::<Vec<_>>();
        let equations: Vec<_> = self.tied.iter().map(equation).collect();
        let names: Vec<&str> = parameters.iter().map(String::as_str).collect();
        Flow::of_complex(&equations, &names)
    }

    /// G of the tied unknowns, A_j and B_j, in the tied unknowns and the |w_k|^2.
    fn moving(&self, j: usize, values: &[Option<Value>]) -> System {
        let equation = |i: &usize| -> Vec<_> {
            self.equations[*i].iter().map(|term| self.in_squares(term)).collect()
        };
        let equations: Vec<_> = self.tied.iter().chain([&j]).map(equation).collect();
        let names = vec![""; self.free.len() + values.len()];
        let flow = Flow::of_complex(&equations, &names);
        // The unknown in which the last two are has no part in them.
        let zero = Some(Value::Rational(Rational::new()));
        let given: Vec<_> = std::iter::repeat_n(None, 2 * self.tied.len())
            .chain([zero.clone(), zero])
            .chain(self.free.iter().map(|_| None))
            .chain(values.iter().cloned())
            .collect();
        System::new(&flow.rows, &given)
    }

    /// All zeros with |w_i| up to the reach; nothing where it is not shown that the free unknowns are zero.
    fn all_zeros(
        &self,
        flow: &Flow,
        values: &[Option<Value>],
        reach: f64,
        limits: &Limits,
    ) -> Option<Found> {
        let side = Interval::new(-reach, reach);
        let square = Interval::new(0.0, side.powi(2).above());
        let mut region = vec![side; 2 * self.tied.len()];
        region.resize(region.len() + self.free.len(), square);
        let mut boxes = 0;
        for j in &self.free {
            boxes += excluded(&self.moving(*j, values), &region, 2 * self.tied.len(), limits)?;
        }
        let tied = self.tied_flow(&flow.parameters);
        let mut found = all_states(&tied, values, reach, limits)?;
        let whole = |part: &Region| -> Region {
            let mut whole = vec![Interval::ZERO; flow.unknowns()];
            for (pair, i) in part.chunks_exact(2).zip(&self.tied) {
                whole[2 * i..2 * i + 2].copy_from_slice(pair);
            }
            whole
        };
        let zero = |zero: &Zero| Zero {
            enclosure: whole(&zero.enclosure),
            unique_within: whole(&zero.unique_within),
        };
        found.zeros = found.zeros.iter().map(zero).collect();
        found.at_edge = found.at_edge.iter().map(zero).collect();
        found.undecided = found.undecided.iter().map(whole).collect();
        found.boxes += boxes;
        Some(found)
    }
}

/// The number of boxes on which polynomials are shown to have no common zero; nothing where they are not. The first so many
/// sides are pairs of which the modulus is limited.
fn excluded(system: &System, region: &[Interval], pairs: usize, limits: &Limits) -> Option<usize> {
    let n = region.len();
    if system.variables() != n {
        return None;
    }
    let smallest: Vec<f64> = region.iter().map(|x| limits.smallest * x.width()).collect();
    let excludes = |values: &[Interval]| values.iter().any(|value| !value.contains(0.0));
    let mut stack = vec![region.to_vec()];
    let mut boxes = 0;
    while let Some(part) = stack.pop() {
        boxes += 1;
        if boxes > MOST_BOXES.min(limits.boxes) || limits.stop.asked() {
            return None;
        }
        if limits.modulus.is_some_and(|most| modulus(&part[..pairs]).low() > most) {
            continue;
        }
        let (values, slopes) = system.derivatives(&part);
        if excludes(&values) {
            continue;
        }
        let points: Region = middle(&part).into_iter().map(Interval::point).collect();
        let mut mean = system.values(&points);
        for (row, value) in slopes.chunks_exact(n).zip(&mut mean) {
            for ((slope, x), m) in row.iter().zip(&part).zip(&points) {
                *value = *value + *slope * (*x - *m);
            }
        }
        if excludes(&mean) {
            continue;
        }
        let change = |j: &usize| {
            let steepest = slopes.iter().skip(*j).step_by(n).map(|x| x.above());
            part[*j].width() * steepest.fold(1e-300, f64::max)
        };
        let large = (0..n).filter(|j| part[*j].width() > smallest[*j]);
        let side = large.max_by(|a, b| change(a).total_cmp(&change(b)))?;
        stack.extend(halved(&part, side));
    }
    Some(boxes)
}

/// All zeros of a flow with |w_j| up to the reach, as [`all_zeros`](super::all_zeros) has them. Where the phase of an unknown is free, those in
/// which it is zero are looked for among fewer unknowns, once it is proved that there are no others.
#[must_use]
pub fn all_states(
    flow: &Flow,
    values: &[Option<Value>],
    reach: f64,
    limits: &Limits,
) -> Option<Found> {
    let fewer = Quiet::of(&flow.complex).and_then(|it| it.all_zeros(flow, values, reach, limits));
    fewer.or_else(|| {
        let region = vec![Interval::new(-reach, reach); flow.unknowns()];
        let most = limits.modulus.unwrap_or_else(|| modulus(&region).high());
        let moduli = vec![Interval::new(0.0, most); flow.complex.len()];
        let (places, cells) = Balance::of(flow, values)
            .map_or((Places::Anywhere, 0), |balance| balance.places(moduli, limits));
        let mut found = zeros_at(&flow.system(values), &region, &places, limits)?;
        found.boxes += cells;
        Some(found)
    })
}
