//! The numerical solution: dyadic Fourier coefficients and a rational frequency, with the value of
//! everything that is a polynomial in them, exactly; functions of them within their errors.

use crate::Failure;
use crate::exact::{Exact, Part, combine, unit};
use crate::field::{Field, Function};
use crate::laurent::Laurent;
use crate::polynomial::{Polynomial, Term};
use crate::transform::{doubles_to_modes, samples_to_modes};
use crate::upward::Up;
use lindstedt_algebra::Stop;
use nalgebra::Complex;
use rug::{Complete, Float, Integer, Rational};
use std::collections::BTreeMap;

/// x_i = sum_k c_k e^(i k tau), c_k = modes_k/2^bits, tau = omega t.
#[derive(Clone, Debug)]
pub(crate) struct Centre {
    pub(crate) bits: u32,
    pub(crate) frequency: Rational,
    pub(crate) unknowns: Vec<Laurent>,
}

/// Bits behind the point in the tier of doubles.
pub(crate) const FAST_BITS: u32 = 72;

/// One unknown of it.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub(crate) bits: u32,
    pub(crate) modes: Laurent,
}

/// The variables at a centre, over 2^bits: x_i, z_i = dx_i/dtau, the functions; with the products that were
/// formed.
pub(crate) struct Variables<'a> {
    centre: &'a Centre,
    list: Vec<Laurent>,
    known: BTreeMap<Vec<u32>, Laurent>,
    stop: Stop,
}

/// The values at a centre that Newton's method and the proof need; matrices by rows.
pub(crate) struct Values {
    /// F_i = omega^2 d^2x_i/dtau^2 - g_i(x, omega z, tau).
    pub(crate) residual: Vec<Exact>,
    /// dg_i/dx_k.
    pub(crate) by_x: Vec<Exact>,
    /// omega dg_i/dx_k': what dh_k/dtau is multiplied by.
    pub(crate) by_slope: Vec<Exact>,
    /// dF_i/domega = 2 omega d^2x_i/dtau^2 - sum_k z_k dg_i/dx_k'.
    pub(crate) by_frequency: Vec<Exact>,
    /// Approximations of the functions over 2^bits.
    pub(crate) functions: Vec<Laurent>,
}

impl Component {
    /// c_k in doubles.
    pub(crate) fn doubles(&self) -> Vec<Complex<f64>> {
        Exact::over_power(self.modes.clone(), self.bits).doubles(0)
    }

    /// The phase of the largest x on a grid, in doubles.
    pub(crate) fn top(&self) -> f64 {
        let modes = self.doubles();
        let points = 16 * modes.len().max(16);
        let value = |j: usize| -> f64 {
            let wave = Complex::from_polar(1.0, std::f64::consts::TAU * j as f64 / points as f64);
            let sum = modes.iter().rev().fold(Complex::<f64>::default(), |sum, c| sum * wave + c);
            2.0 * sum.re
        };
        let values = (0..points).map(|j| (j, value(j)));
        let best = values.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(j, _)| j);
        std::f64::consts::TAU * best as f64 / points as f64
    }
}

impl Centre {
    /// The coefficients c_k rounded to `bits` bits behind the point.
    pub(crate) fn from_doubles(bits: u32, frequency: f64, unknowns: &[Vec<Complex<f64>>]) -> Self {
        let round = |x: f64| {
            let scaled = Float::with_val(64, x) << bits;
            scaled.to_integer().unwrap_or_default()
        };
        let one = |modes: &Vec<Complex<f64>>| {
            let re = modes.iter().map(|c| round(c.re)).collect();
            let im = modes.iter().map(|c| round(c.im)).collect();
            Laurent { re, im }
        };
        let frequency = dyadic(&Float::with_val(64, frequency), bits);
        Self { bits, frequency, unknowns: unknowns.iter().map(one).collect() }
    }

    /// The same numbers with another precision, rounded where it is less.
    pub(crate) fn with_bits(mut self, bits: u32) -> Self {
        let old = self.bits;
        let change = |c: &mut Integer| {
            if bits >= old {
                *c <<= bits - old;
            } else {
                *c += Integer::from(1) << (old - bits - 1);
                *c >>= old - bits;
            }
        };
        self.unknowns.iter_mut().flat_map(|f| f.re.iter_mut().chain(&mut f.im)).for_each(change);
        self.bits = bits;
        self
    }

    pub(crate) fn component(&self, i: usize) -> Component {
        Component { bits: self.bits, modes: self.unknowns[i].clone() }
    }

    /// c_k in doubles, by unknowns.
    pub(crate) fn doubles(&self) -> Vec<Vec<Complex<f64>>> {
        (0..self.unknowns.len()).map(|i| self.component(i).doubles()).collect()
    }

    /// The modes |k| <= `modes` alone, zeros appended where there are fewer.
    pub(crate) fn resize(&mut self, modes: usize) {
        self.unknowns.iter_mut().for_each(|f| f.resize(modes));
    }

    /// The largest mode.
    pub(crate) fn modes(&self) -> usize {
        self.unknowns.iter().map(Laurent::modes).max().unwrap_or(0)
    }

    /// Adds a correction: doubles times 2^exponent.
    pub(crate) fn add(&mut self, frequency: f64, step: &[Vec<Complex<f64>>], exponent: i32) {
        let bits = self.bits;
        let round = |x: f64| {
            let scaled = Float::with_val(64, x) << (bits as i32 + exponent);
            scaled.to_integer().unwrap_or_default()
        };
        for (f, modes) in self.unknowns.iter_mut().zip(step) {
            if modes.len() > f.re.len() {
                f.resize(modes.len() - 1);
            }
            for (k, c) in modes.iter().enumerate() {
                f.re[k] += round(c.re);
                f.im[k] += round(c.im);
            }
        }
        if frequency != 0.0 {
            self.frequency += dyadic(&(Float::with_val(64, frequency) << exponent), bits);
        }
    }

    /// |x_i|_nu by unknowns, |dx_i/dtau|_nu, and the sum over the unknowns of the larger of |c_0| and
    /// |dx/dtau|_nu taken mode by mode.
    pub(crate) fn norms(&self, nu: Up) -> (Vec<Up>, Vec<Up>, Up) {
        let (mut sizes, mut slopes, mut both) = (Vec::new(), Vec::new(), Up::ZERO);
        for modes in &self.unknowns {
            let (mut x, mut slope, mut power) = (Up::ZERO, Up::ZERO, Up::ONE);
            for (k, (re, im)) in modes.re.iter().zip(&modes.im).enumerate() {
                let scale = if k == 0 { 1.0 } else { 2.0 };
                let size = Up(above(re, self.bits)) + Up(above(im, self.bits));
                let size = size * Up(scale) * power;
                x = x + size;
                slope = slope + size * Up(k as f64);
                both = both + size * Up(k.max(1) as f64);
                power = power * nu;
            }
            sizes.push(x);
            slopes.push(slope);
        }
        (sizes, slopes, both)
    }

    /// The distance from another numerical solution in the norm with the weight nu and the weight of the
    /// frequency, which does not count without.
    pub(crate) fn distance(&self, other: &Self, nu: Up, scale: Option<f64>) -> Up {
        let bits = self.bits.max(other.bits);
        let (mut apart, other) = (self.clone().with_bits(bits), other.clone().with_bits(bits));
        apart.resize(self.modes().max(other.modes()));
        for (mine, others) in apart.unknowns.iter_mut().zip(&other.unknowns) {
            mine.re.iter_mut().zip(&others.re).for_each(|(a, b)| *a -= b);
            mine.im.iter_mut().zip(&others.im).for_each(|(a, b)| *a -= b);
        }
        let (.., both) = apart.norms(nu);
        let detuned = Rational::from(&self.frequency - &other.frequency);
        both + scale.map_or(Up::ZERO, |scale| Up::of(&detuned) * Up(scale))
    }

    /// The largest amplitude of a harmonic, roughly.
    pub(crate) fn largest(&self) -> Float {
        let all = self.unknowns.iter().flat_map(|f| f.re.iter().chain(&f.im));
        let parts = all.map(|n| n.clone().abs());
        Float::with_val(53, parts.max().unwrap_or_default()) >> (self.bits - 1)
    }

    /// F at the centre; [`Failure::Stopped`].
    pub(crate) fn residual(&self, field: &Field, stop: &Stop) -> Result<Vec<Exact>, Failure> {
        let residual = self.residual_with(field, &mut Variables::new(self, field, stop)?);
        if stop.asked() { Err(Failure::Stopped) } else { Ok(residual) }
    }

    fn residual_with(&self, field: &Field, variables: &mut Variables<'_>) -> Vec<Exact> {
        let square = self.frequency.clone().square();
        let one = |(i, g): (usize, &Polynomial)| {
            self.with_inertia(i, square.clone(), variables.parts(g, 0, &Rational::from(-1)))
        };
        field.forces.iter().enumerate().map(one).collect()
    }

    /// factor d^2x_i/dtau^2 + the parts.
    fn with_inertia(&self, i: usize, factor: Rational, mut parts: Vec<Part>) -> Exact {
        let bend = self.unknowns[i].derivative().derivative();
        parts.push(Part { factor: factor >> self.bits, modes: bend, wave: unit() });
        combine(parts)
    }

    /// F and its derivatives at the centre; [`Failure::Stopped`].
    pub(crate) fn values(&self, field: &Field, stop: &Stop) -> Result<Values, Failure> {
        let mut variables = Variables::new(self, field, stop)?;
        let n = field.unknowns();
        let residual = self.residual_with(field, &mut variables);
        let (mut by_x, mut by_slope, mut by_frequency) = (Vec::new(), Vec::new(), Vec::new());
        let minus = Rational::from(-1);
        for (i, row) in field.first.iter().enumerate() {
            by_x.extend(row[..n].iter().map(|p| variables.exact(p, 0)));
            by_slope.extend(row[n..].iter().map(|p| variables.exact(p, -1)));
            let parts = variables.parts(&field.flow[i], 1, &minus);
            by_frequency.push(self.with_inertia(i, (&self.frequency * 2u32).complete(), parts));
        }
        let functions = variables.list.split_off(2 * n);
        // Products that were left out made all of it meaningless.
        if stop.asked() {
            return Err(Failure::Stopped);
        }
        Ok(Values { residual, by_x, by_slope, by_frequency, functions })
    }
}

impl<'a> Variables<'a> {
    /// With approximations of the functions of a field. Once it is stopped, products mean nothing: whoever takes them
    /// asks at the end.
    fn new(centre: &'a Centre, field: &Field, stop: &Stop) -> Result<Self, Failure> {
        let mut variables = Self { stop: stop.clone(), ..Self::known(centre, &[]) };
        let first = variables.list.len();
        while let Some(next) = field.functions.get(variables.list.len() - first) {
            let functions = variables.approximate(next)?;
            variables.list.extend(functions);
        }
        Ok(variables)
    }

    /// With functions that were computed.
    pub(crate) fn known(centre: &'a Centre, functions: &[Laurent]) -> Self {
        let mut list = centre.unknowns.clone();
        list.extend(centre.unknowns.iter().map(Laurent::derivative));
        list.extend_from_slice(functions);
        Self { centre, list, known: BTreeMap::new(), stop: Stop::default() }
    }

    /// Approximations over 2^bits of a function, and of the cosine with a sine.
    fn approximate(&mut self, function: &Function) -> Result<Vec<Laurent>, Failure> {
        let argument = self.exact(&function.argument, 0);
        let (kind, bits) = (function.kind, self.bits());
        let found = match bits <= FAST_BITS {
            true => doubles_to_modes(&argument, bits, kind.list()),
            false => samples_to_modes(&argument, bits, kind, &self.stop),
        };
        if self.stop.asked() {
            return Err(Failure::Stopped);
        }
        found.ok_or_else(|| Failure::NoFunction { argument: argument.norm(Up::ONE, 0).0 })
    }

    pub(crate) fn bits(&self) -> u32 {
        self.centre.bits
    }

    /// A product of powers; the last factor is the first variable in it.
    fn get(&mut self, powers: &[u32]) -> Laurent {
        let Some(first) = powers.iter().position(|n| *n > 0) else { return Laurent::one() };
        if let Some(product) = self.known.get(powers) {
            return product.clone();
        }
        if self.stop.asked() {
            return Laurent::one();
        }
        let mut less = powers.to_vec();
        less[first] -= 1;
        let product = self.get(&less).times(&self.list[first]);
        self.known.insert(powers.to_vec(), product.clone());
        product
    }

    /// The terms times `factor` and omega^-less, of a polynomial.
    pub(crate) fn parts(
        &mut self,
        polynomial: &Polynomial,
        less: i32,
        factor: &Rational,
    ) -> Vec<Part> {
        let (n, bits) = (self.centre.unknowns.len(), self.centre.bits);
        let part = |term: &Term| {
            let rate: u32 = term.powers.iter().skip(n).take(n).sum();
            let power = rug::ops::Pow::pow(self.centre.frequency.clone(), rate as i32 - less);
            let degree: u32 = term.powers.iter().sum();
            let factor = (factor * power) >> (bits * degree);
            Part { factor, modes: self.get(&term.powers), wave: term.factor.clone() }
        };
        polynomial.terms.iter().map(part).collect()
    }

    /// A polynomial times omega^-less, exactly (but for the errors of the functions).
    pub(crate) fn exact(&mut self, polynomial: &Polynomial, less: i32) -> Exact {
        combine(self.parts(polynomial, less, &Rational::from(1)))
    }

    /// The mean over a period of a polynomial (but for the errors of the functions).
    pub(crate) fn mean(&mut self, polynomial: &Polynomial) -> Rational {
        let sum = self.exact(polynomial, 0);
        sum.modes.re.first().map_or(Rational::new(), |c| sum.scale * c)
    }
}

/// |n|/2^bits rounded up.
fn above(n: &Integer, bits: u32) -> f64 {
    let float = Float::with_val_round(53, n, rug::float::Round::AwayZero).0 >> bits;
    float.to_f64_round(rug::float::Round::AwayZero).abs()
}

/// x rounded to a multiple of 2^-bits.
fn dyadic(x: &Float, bits: u32) -> Rational {
    let scaled = Float::with_val(x.prec(), x << bits);
    Rational::from((scaled.to_integer().unwrap_or_default(), Integer::from(1) << bits))
}
