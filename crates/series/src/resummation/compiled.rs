//! A sum of a series at a million points: approximants once, doubles at every point.
//!
//! What costs time in a sum does not depend on the point: the approximants, the series in another
//! variable, the nearest singularity. They are made once, to many bits. The error is judged at nodes,
//! 16 for every factor of two in |x|, exactly as at a single point ([`resum`](super::resum)); to
//! it the rounding of the formula in doubles is added as it is measured there. Between two nodes the
//! error relative to the value is the largest of all nodes up to the next outer one, and at least
//! the distance of the last two approximants at the point itself: a pole between two nodes shows there.

use super::estimate::distance;
use super::formula::Formula;
use super::pade::scale_exponent;
use super::prepared::Prepared;
use super::{Method, Outcome, ResummationError, Sample};
use lindstedt_algebra::Stop;
use rayon::prelude::*;
use rug::Float;

/// Nodes for every factor of two.
const DENSITY: i32 = 16;
/// Factors of two that are looked at within the radius of convergence, and beyond.
const OCTAVES: [i32; 2] = [24, 10];
/// Bits at a node: what is lost to more than these has no double.
const BITS: u32 = 160;
/// Bits beyond which a method need not be better than a simpler one.
const ACCURACY: u32 = 56;
/// What the rounding at a node is multiplied by.
const ROUNDING: f64 = 8.0;

/// A double with its estimated error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// The value.
    pub value: f64,
    /// The estimated bound of its distance from the true value; infinite where nothing can be said.
    pub error: f64,
}

/// A sum of a series as a function of its point.
///
/// ```
/// use lindstedt_series::resummation::{Compiled, Method, Sample};
/// use rug::{Float, Rational};
/// // ln(1 + x)/x = 1 - x/2 + x^2/3 - ...
/// let bits = Compiled::bits(25);
/// let c = |n: u32| Float::with_val(bits, Rational::from(((-1i32).pow(n), n + 1)));
/// let coefficients: Vec<Float> = (0..25).map(c).collect();
/// let point = Float::new(bits);
/// let sample = Sample { coefficients, point, map: None, radius: None, bits };
/// let sum = Compiled::new(&sample, &[Method::Pade], &Default::default())?;
/// for x in [-0.5f64, 1e-9, 0.3, 5.0] {
///     let found = sum.at(x);
///     assert!((found.value - x.ln_1p() / x).abs() <= found.error && found.error < 1e-6);
/// }
/// assert!(sum.at(-1.5).error.is_infinite());
/// # Ok::<(), lindstedt_series::resummation::ResummationError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Compiled {
    methods: Vec<Method>,
    formulas: Vec<Formula>,
    /// x > 0 and x < 0.
    sides: [Side; 2],
    /// f(0).
    first: f64,
}

/// The nodes +-2^(k/16), k = lowest, lowest + 1, ...
#[derive(Clone, Debug)]
struct Side {
    lowest: i32,
    nodes: Vec<Node>,
}

/// What holds from the node before to this one.
#[derive(Clone, Copy, Debug)]
struct Node {
    formula: usize,
    /// Terms of a partial sum.
    order: usize,
    /// Relative to the value.
    error: f64,
    /// The value at the node.
    value: f64,
    /// |x f'/f|, twice the mean from the node before.
    slope: f64,
    /// The variable of the formula that is implicit.
    variable: f64,
}

impl Compiled {
    /// The bits that the coefficients should have.
    #[must_use]
    pub fn bits(known: usize) -> u32 {
        u32::try_from(known).unwrap_or(u32::MAX).saturating_mul(8).saturating_add(192)
    }

    /// The sum of the coefficients of a sample, whatever its point, by the best of some methods at every node;
    /// with no method by the best of all but Borel's.
    ///
    /// Cost: that of a single sum, and some 1000 values of its approximants.
    ///
    /// # Errors
    /// [`ResummationError::NoFormula`] for Borel's method; what the method itself refuses
    /// at every point; [`ResummationError::Stopped`].
    pub fn new(sample: &Sample, methods: &[Method], stop: &Stop) -> Result<Self, ResummationError> {
        let known = sample.coefficients.len();
        if known < 3 {
            return Err(ResummationError::TooFewCoefficients { known, needed: 3 });
        }
        let all = || Method::ALL.into_iter().filter(|method| *method != Method::BorelPade);
        let asked = if methods.is_empty() { all().collect() } else { methods.to_vec() };
        let conformal = asked.contains(&Method::ConformalPade);
        let singularity = if conformal { sample.singularity(stop) } else { None };
        let mut failure = ResummationError::Undefined;
        let (mut methods, mut ways, mut formulas) = (Vec::new(), Vec::new(), Vec::new());
        for method in asked {
            match sample.prepared(method, singularity.as_ref(), stop) {
                Ok(way) => {
                    let Some(formula) = Formula::new(&way, sample) else { continue };
                    methods.push(method);
                    ways.push(way.rounded(BITS));
                    formulas.push(formula);
                }
                Err(error) => failure = error,
            }
        }
        if stop.asked() {
            return Err(ResummationError::Stopped);
        }
        if formulas.is_empty() {
            return Err(failure);
        }
        let coefficients = sample.coefficients.iter().map(|c| Float::with_val(BITS, c)).collect();
        let sample = &Sample { coefficients, bits: BITS, ..sample.clone() };
        let table = Table { sample, methods: &methods, ways: &ways, formulas: &formulas, stop };
        let sides = [table.side(false)?, table.side(true)?];
        let first = sample.coefficients.first().map_or(f64::NAN, Float::to_f64);
        Ok(Self { methods, formulas, sides, first })
    }

    /// The methods that give the values, in the order in which they are preferred.
    #[must_use]
    pub fn methods(&self) -> &[Method] {
        &self.methods
    }

    /// The value at x. Nothing is allocated.
    #[must_use]
    pub fn at(&self, x: f64) -> Estimated {
        self.at_within(x, 0.0)
    }

    /// The value at a point that is known within a relative error of so much, which adds |x f'/f| times that to
    /// the relative error of the value.
    #[must_use]
    pub fn at_within(&self, x: f64, relative: f64) -> Estimated {
        let nothing = |value| Estimated { value, error: f64::INFINITY };
        if x == 0.0 {
            return Estimated { value: self.first, error: self.first.abs() * 4.0 * f64::EPSILON };
        }
        let side = &self.sides[usize::from(x < 0.0)];
        let place = x.abs().log2() * f64::from(DENSITY) - f64::from(side.lowest);
        let last = side.nodes.len().saturating_sub(1);
        if !place.is_finite() || side.nodes.is_empty() {
            return nothing(f64::NAN);
        }
        let index = (place.max(0.0).ceil() as usize).min(last);
        let node = side.nodes[index];
        let formula = &self.formulas[node.formula];
        let guess = match index.checked_sub(1).and_then(|before| side.nodes.get(before)) {
            None => node.variable * ((place - index as f64) / f64::from(DENSITY)).exp2(),
            Some(before) => {
                let part = (place - (index - 1) as f64).min(1.0);
                before.variable + part * (node.variable - before.variable)
            }
        };
        let found = formula.values(x, node.order, guess);
        // The nodes are rounded.
        if place > last as f64 + 1e-9 {
            return nothing(found.value);
        }
        let error = node.error * found.value.abs();
        let error = error.max((found.value - found.before).abs());
        let error = error + relative * node.slope * found.value.abs();
        let resolved = error <= found.value.abs() / 2.0;
        Estimated { value: found.value, error: if resolved { error } else { f64::INFINITY } }
    }

    /// The values at many points.
    pub fn fill(&self, points: &[f64], values: &mut [Estimated]) {
        for (value, x) in values.iter_mut().zip(points) {
            *value = self.at(*x);
        }
    }
}

/// What the nodes are judged by.
struct Table<'a> {
    sample: &'a Sample,
    methods: &'a [Method],
    ways: &'a [Prepared],
    formulas: &'a [Formula],
    stop: &'a Stop,
}

impl Table<'_> {
    /// From the radius of convergence down to where nothing is left to judge, and up to where nothing holds.
    fn side(&self, negative: bool) -> Result<Side, ResummationError> {
        let centre = scale_exponent(&self.sample.coefficients);
        let mut nodes = Vec::new();
        let mut low = centre;
        for octave in (centre - OCTAVES[0]..=centre).rev() {
            low = octave;
            let mut inner = self.octave(octave, negative)?;
            inner.append(&mut nodes);
            nodes = inner;
            if nodes.first().is_some_and(|node| node.error <= 8.0 * f64::EPSILON) {
                break;
            }
        }
        for octave in centre + 1..=centre + OCTAVES[1] {
            let outer = self.octave(octave, negative)?;
            if outer.iter().all(|node| node.error.is_infinite()) {
                break;
            }
            nodes.extend(outer);
        }
        while nodes.last().is_some_and(|node| node.error.is_infinite()) {
            nodes.pop();
        }
        let step = std::f64::consts::LN_2 / f64::from(DENSITY);
        for index in 1..nodes.len() {
            let [before, node] = [nodes[index - 1].value, nodes[index].value];
            let slope = 2.0 * ((node - before) / (step * node)).abs();
            // Nothing is known next to a node without a value.
            nodes[index].slope = if slope.is_nan() { f64::INFINITY } else { slope };
        }
        if let [first, second, ..] = &mut nodes[..] {
            first.slope = second.slope;
        }
        let (mut largest, mut before) = (0.0f64, 0.0);
        for node in &mut nodes {
            let own = node.error;
            if own.is_finite() {
                largest = largest.max(own);
            }
            // On either side of a node without a value there is none.
            node.error = if f64::is_infinite(before) { before } else { largest.max(own) };
            before = own;
        }
        Ok(Side { lowest: low * DENSITY + 1, nodes })
    }

    /// The nodes in (2^octave, 2^(octave + 1)].
    fn octave(&self, octave: i32, negative: bool) -> Result<Vec<Node>, ResummationError> {
        if self.stop.asked() {
            return Err(ResummationError::Stopped);
        }
        let node = |k: i32| {
            let size = f64::from(octave * DENSITY + k) / f64::from(DENSITY);
            let x = size.exp2();
            self.node(if negative { -x } else { x })
        };
        let nodes = (1..=DENSITY).into_par_iter().map(node).collect();
        if self.stop.asked() { Err(ResummationError::Stopped) } else { Ok(nodes) }
    }

    fn node(&self, x: f64) -> Node {
        let point = Float::with_val(self.sample.bits, x);
        let variable = self.variable(&point);
        let sample = Sample { point, ..self.sample.clone() };
        let mut values: Vec<(Method, Outcome)> = Vec::new();
        let mut indices = Vec::new();
        for (index, (method, way)) in self.methods.iter().zip(self.ways).enumerate() {
            if let Ok(outcome) = way.outcome(&sample, self.stop) {
                values.push((*method, sample.resolved(outcome)));
                indices.push(index);
            }
        }
        let several = self.methods.len() > 1;
        let found = sample.selected(&values, ACCURACY, several);
        let Some((index, outcome)) = found else {
            let (error, value, slope) = (f64::INFINITY, f64::NAN, 0.0);
            return Node { formula: 0, order: 0, error, value, slope, variable };
        };
        let (formula, order) = (indices[index], outcome.order);
        let value = &outcome.estimate.value;
        let double = self.formulas[formula].values(x, order, variable).value;
        let rounding = distance(value, &Float::with_val(sample.bits, double)).to_f64();
        let (value, slope) = (value.to_f64(), 0.0);
        let size = value.abs();
        let error = (outcome.estimate.error.to_f64() + ROUNDING * rounding) / size;
        let error = if error.is_nan() { f64::INFINITY } else { error + 4.0 * f64::EPSILON };
        Node { formula, order, error, value, slope, variable }
    }

    /// The variable of the formula that is implicit.
    fn variable(&self, x: &Float) -> f64 {
        let implicit = self.formulas.iter().position(Formula::is_implicit);
        let map = implicit.and_then(|index| self.ways.get(index)?.map.as_ref());
        let w = map.and_then(|(map, _)| map.inverse(x, self.sample.bits, self.stop).ok());
        w.map_or(f64::NAN, |w| w.to_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resummation::{UniformMap, resum};
    use rug::Rational;

    type Function = fn(f64) -> f64;

    /// (1 + x)^(-1/2), ln(1 + x)/x and 1/(1 - x + x^2), with a change of variable for the first.
    fn series(order: u32, bits: u32) -> Vec<(Sample, Function)> {
        let mut binomial = vec![Rational::from(1)];
        for n in 0..order {
            let next = Rational::from((-1 - 2 * i64::from(n), 2 * i64::from(n) + 2));
            binomial.push(next * binomial.last().unwrap());
        }
        let log = (0..=order).map(|n| Rational::from(((-1i32).pow(n), n + 1))).collect();
        let period = [1, 1, 0, -1, -1, 0];
        let rational = (0..=order as usize).map(|n| Rational::from(period[n % 6])).collect();
        let float = |x: (i32, u32)| Float::with_val(bits, Rational::from(x));
        let known = UniformMap { scale: float((1, 1)), prefactor: float((-1, 2)), radius: None };
        let functions: [(Vec<Rational>, Option<UniformMap>, Function); 3] = [
            (binomial, Some(known), |x| (1.0 + x).powf(-0.5)),
            (log, None, |x| x.ln_1p() / x),
            (rational, None, |x| 1.0 / (1.0 - x + x * x)),
        ];
        let sample = |(c, map, f): (Vec<Rational>, _, _)| {
            let coefficients = c.iter().map(|q| Float::with_val(bits, q)).collect();
            (Sample { coefficients, point: Float::new(bits), map, radius: None, bits }, f)
        };
        functions.into_iter().map(sample).collect()
    }

    /// At points that are no nodes: within the stated error of the truth, and both errors of the sum at
    /// that point alone; where the compiled sum has a value, so has the other.
    #[test]
    fn many_points_are_as_good_as_one() {
        let bits = Compiled::bits(13);
        let mut resolved = 0;
        for (sample, truth) in series(12, bits) {
            for method in [None, Some(Method::PartialSum)] {
                let sum = Compiled::new(&sample, method.as_slice(), &Stop::default()).unwrap();
                for x in [-0.77, -0.1003, 1e-7, 0.0131, 0.333, 0.91, 2.7, 19.3] {
                    let found = sum.at(x);
                    let distance = (found.value - truth(x)).abs();
                    assert!(distance <= found.error, "{method:?} {x}: {distance:e} {found:?}");
                    // The truth a little further on, of a point known so far.
                    let near = sum.at_within(x, 1e-6);
                    let distance = (near.value - truth(x * (1.0 + 1e-6))).abs();
                    assert!(distance <= near.error, "{method:?} {x}: {distance:e} {near:?}");
                    let at = |bits| Sample { point: Float::with_val(bits, x), ..sample.clone() };
                    let single = resum(&|bits| Some(at(bits)), method, 53, &Stop::default())
                        .unwrap()
                        .outcome
                        .estimate;
                    let gap = (found.value - single.value.to_f64()).abs();
                    if found.error.is_finite() {
                        resolved += 1;
                        let error = single.error.to_f64();
                        assert!(gap <= found.error + error, "{method:?} {x}: {gap:e} {found:?}");
                        assert!(error <= found.error * 40.0, "{method:?} {x}: {error:e} {found:?}");
                    }
                }
            }
        }
        assert!(resolved > 25, "{resolved}");
    }

    /// Far below the innermost node, where the sum is as exact as doubles are, the variable of the wedge is, too:
    /// (1 + x)^(-1/2) + ln(1 + x)/x.
    #[test]
    fn points_far_below_the_nodes() {
        let bits = Compiled::bits(25);
        let two = series(24, bits);
        let sum = |(a, b): (&Float, &Float)| Float::with_val(bits, a + b);
        let coefficients = two[0].0.coefficients.iter().zip(&two[1].0.coefficients).map(sum);
        let map = UniformMap {
            scale: Float::with_val(bits, 1),
            prefactor: Float::with_val(bits, 0.5),
            radius: None,
        };
        let (coefficients, point) = (coefficients.collect(), Float::new(bits));
        let sample = Sample { coefficients, point, map: Some(map), radius: None, bits };
        let sum = Compiled::new(&sample, &[Method::ConformalPade], &Stop::default()).unwrap();
        for x in [1e-9f64, 1e-6, 1e-4, 1e-2, 0.1, 0.3, -1e-3, -0.1] {
            let found = sum.at(x);
            let distance = (found.value - two[0].1(x) - two[1].1(x)).abs();
            assert!(
                distance <= 5.0 * found.error && found.error < 1e-13,
                "{x}: {distance:e} {found:?}"
            );
        }
    }

    /// Borel's integral is another one at every point.
    #[test]
    fn what_has_no_formula_is_refused() {
        let (sample, _) = series(12, 300).remove(0);
        let refused = Compiled::new(&sample, &[Method::BorelPade], &Stop::default());
        assert_eq!(refused.err(), Some(ResummationError::NoFormula { method: "borel-pade" }));
        let none = Compiled::new(&sample, &[], &Stop::default()).unwrap().at(f64::NAN);
        assert!(none.value.is_nan() && none.error.is_infinite());
    }
}
