//! The laws of rings and phase algebras for sampled functions.

use super::{
    COS_EVEN, COS_ODD, Collocation, Domain, PARTS, Particular, Rule, SIN_EVEN, SIN_ODD, Sampled,
};
use lindstedt_algebra::{
    Elementary, FunctionAlgebra, PhaseAlgebra, PhaseError, RationalAlgebra, Resolution, Ring,
};
use lindstedt_coeff::floats::Reals;
use rug::Rational;
use std::sync::Arc;

/// Pairs of lists to be multiplied point by point.
type Factors<'a, E> = Vec<(&'a [E], &'a [E])>;

/// Bits by which two ways to the same function may differ.
const ROUNDING_BITS: i32 = 12;

impl<R: Reals> Collocation<R> {
    /// A linear map of the values, which is that of the derivatives too.
    fn linear(
        &self,
        f: &Sampled<R::Element>,
        g: &impl Fn(&R::Element) -> R::Element,
    ) -> Sampled<R::Element> {
        let list = |list: &Arc<Vec<R::Element>>| list.iter().map(g).collect::<Vec<_>>();
        let values = f.values.each_ref().map(|part| part.as_ref().map(list));
        let mut image = self.with_parts(values);
        image.derivative = f.derivative.as_ref().map(|d| Arc::new(self.linear(d, g)));
        image
    }

    /// The largest |value|.
    fn size(&self, f: &Sampled<R::Element>) -> rug::Float {
        let values = f.values.iter().flatten().flat_map(|list| list.iter());
        values.fold(rug::Float::new(53), |size, v| {
            let v = self.reals.to_float(&self.reals.abs(v));
            if v > size || v.is_nan() { rug::Float::with_val(53, v) } else { size }
        })
    }

    /// Whether f vanishes against `scale`, within rounding errors.
    fn is_negligible(&self, f: &Sampled<R::Element>, scale: &rug::Float) -> bool {
        let mut tolerance =
            rug::Float::with_val(53, 1) >> (self.reals.bits() as i32 - ROUNDING_BITS);
        // What lies beyond the last node is missing from an integral.
        if let (Rule::Sinc(_), Some(last)) = (&self.rule, self.cos.last()) {
            let missing = rug::Float::with_val(53, self.reals.to_float(last) * 64u32);
            if missing > tolerance {
                tolerance = missing;
            }
        }
        tolerance *= scale;
        self.size(f) <= tolerance
    }

    /// cos psi with `depth` derivatives, turned by a quarter period `turns` times: cos, -sin, -cos, sin.
    fn circular(&self, turns: usize, depth: usize) -> Sampled<R::Element> {
        let negative =
            |list: &[R::Element]| Arc::new(list.iter().map(|x| self.reals.neg(x)).collect());
        let mut f = match turns % 4 {
            0 => self.of_part(COS_ODD, self.cos.clone()),
            1 => self.of_part(SIN_ODD, negative(&self.sin)),
            2 => self.of_part(COS_ODD, negative(&self.cos)),
            _ => self.of_part(SIN_ODD, self.sin.clone()),
        };
        if depth > 0 {
            f.derivative = Some(Arc::new(self.circular(turns + 1, depth - 1)));
        }
        f
    }

    /// 2<f cos> for odd cosines, 2<f sin> for odd sines.
    fn amplitude(&self, part: usize, f: Option<&Arc<Vec<R::Element>>>) -> R::Element {
        let Some(f) = f else { return self.reals.zero() };
        match &self.rule {
            // (4/pi) times the integral over the quarter period.
            Rule::Sinc(sinc) => {
                let sum = sinc.quarter(&self.reals, f, part == COS_ODD);
                let bits = self.reals.bits() + 8;
                let pi = rug::Float::with_val(bits, rug::float::Constant::Pi);
                let sum = rug::Float::with_val(bits, self.reals.to_float(&sum) * 4u32);
                self.reals.nearest(&(sum / pi))
            }
            Rule::Fourier(fourier) => {
                let list = fourier.coefficients(&self.reals, part, f);
                list.first().map_or_else(|| self.reals.zero(), |(_, c)| c.clone())
            }
        }
    }

    fn particular(&self, part: usize, f: &[R::Element]) -> Particular<R::Element> {
        match &self.rule {
            Rule::Sinc(sinc) => sinc.particular(&self.reals, part, f),
            Rule::Fourier(fourier) => fourier.particular(&self.reals, part, f),
        }
    }

    /// The value at psi = 0 of a part.
    fn initial(&self, part: usize, f: Option<&Arc<Vec<R::Element>>>) -> R::Element {
        let mut sum = self.reals.zero();
        let Some(f) = f else { return sum };
        match &self.rule {
            Rule::Sinc(_) => f.first().cloned().unwrap_or(sum),
            Rule::Fourier(fourier) => {
                for (_, c) in fourier.coefficients(&self.reals, part, f) {
                    self.reals.add_assign(&mut sum, &c);
                }
                sum
            }
        }
    }
}

impl<R: Reals> Ring for Collocation<R> {
    type Element = Sampled<R::Element>;

    fn zero(&self) -> Self::Element {
        Sampled { values: [const { None }; PARTS], derivative: None }
    }
    fn one(&self) -> Self::Element {
        self.embed(&self.reals.one())
    }
    fn is_zero(&self, f: &Self::Element) -> bool {
        f.values.iter().all(Option::is_none)
    }
    fn add_assign(&self, f: &mut Self::Element, g: &Self::Element) {
        if self.is_zero(g) {
            return;
        }
        if self.is_zero(f) {
            f.clone_from(g);
            return;
        }
        let derivative = f.derivative.take().zip(g.derivative.as_ref());
        for (x, y) in f.values.iter_mut().zip(&g.values) {
            let Some(y) = y else { continue };
            let Some(own) = x else {
                *x = Some(y.clone());
                continue;
            };
            let list = Arc::make_mut(own);
            for (a, b) in list.iter_mut().zip(y.iter()) {
                self.reals.add_assign(a, b);
            }
            if list.iter().all(|v| self.reals.is_zero(v)) {
                *x = None;
            }
        }
        f.derivative = derivative.map(|(own, other)| {
            let mut own = Arc::unwrap_or_clone(own);
            self.add_assign(&mut own, other);
            Arc::new(own)
        });
    }
    fn neg(&self, f: &Self::Element) -> Self::Element {
        self.linear(f, &|x| self.reals.neg(x))
    }
    fn mul(&self, f: &Self::Element, g: &Self::Element) -> Self::Element {
        self.sum_of_products(&[(f, g)])
    }
    fn sum_of_products(&self, pairs: &[(&Self::Element, &Self::Element)]) -> Self::Element {
        let mut factors: [Factors<'_, R::Element>; PARTS] = [const { Vec::new() }; PARTS];
        for (f, g) in pairs {
            for (p, a) in f.values.iter().enumerate() {
                for (q, b) in g.values.iter().enumerate() {
                    // sin^2 of even or odd sines is a cosine again: parts add bit by bit.
                    if let (Some(a), Some(b), Some(list)) = (a, b, factors.get_mut(p ^ q)) {
                        list.push((a, b));
                    }
                }
            }
        }
        let values = factors.map(|pairs| {
            (!pairs.is_empty()).then(|| {
                self.map_nodes(|k| {
                    let mut sum = self.reals.zero();
                    for (a, b) in &pairs {
                        if let (Some(x), Some(y)) = (a.get(k), b.get(k)) {
                            self.reals.accumulate(&mut sum, x, y);
                        }
                    }
                    sum
                })
            })
        });
        self.with_parts(values)
    }
}

impl<R: Reals> RationalAlgebra for Collocation<R> {
    fn rational(&self, q: &Rational) -> Self::Element {
        self.embed(&self.reals.rational(q))
    }
    fn scale(&self, f: &Self::Element, q: &Rational) -> Self::Element {
        if *q == 1 {
            return f.clone();
        }
        self.linear(f, &|x| self.reals.scale(x, q))
    }
    /// Nothing where f has a zero.
    fn reciprocal(&self, f: &Self::Element) -> Option<Self::Element> {
        let nan = || self.reals.nearest(&rug::Float::with_val(2, rug::float::Special::Nan));
        self.pointwise(f, Domain::NoZeros, |v| self.reals.reciprocal(v).unwrap_or_else(nan))
    }
    fn as_rational(&self, f: &Self::Element) -> Option<Rational> {
        self.reals.as_rational(&self.as_constant(f)?)
    }
}

impl<R: Reals> FunctionAlgebra for Collocation<R> {
    type Constants = R;
    fn constants(&self) -> &R {
        &self.reals
    }
    fn embed(&self, c: &R::Element) -> Self::Element {
        let mut f = self.with_parts([Some(vec![c.clone(); self.nodes]), None, None, None]);
        f.derivative = Some(Arc::new(self.zero()));
        f
    }
    fn scale_by(&self, f: &Self::Element, c: &R::Element) -> Self::Element {
        self.linear(f, &|x| self.reals.mul(x, c))
    }
    /// The first value, if all others agree with it up to rounding.
    fn as_constant(&self, f: &Self::Element) -> Option<R::Element> {
        let Some(first) = f.values[COS_EVEN].as_ref().and_then(|list| list.first()) else {
            return self.is_zero(f).then(|| self.reals.zero());
        };
        self.agrees(f, &self.embed(first)).then(|| first.clone())
    }
    /// Nothing where f has a zero inside the quarter period.
    fn log_abs(&self, f: &Self::Element) -> Option<Self::Element> {
        self.pointwise(f, Domain::NoZeros, |v| self.reals.log_abs(v))
    }
    fn apply(&self, function: &Elementary, f: &Self::Element) -> Option<Self::Element> {
        let domain = match function {
            Elementary::Power(q) if !q.is_integer() => Domain::Positive,
            Elementary::Power(q) if *q < 0 => Domain::NoZeros,
            Elementary::Power(_) | Elementary::Exp | Elementary::Sin | Elementary::Cos => {
                Domain::Everywhere
            }
            _ => return None,
        };
        self.pointwise(f, domain, |v| self.reals.elementary(function, v))
    }
    /// Up to rounding (`ROUNDING_BITS` bits of the larger one) and the rest beyond the last node.
    fn agrees(&self, f: &Self::Element, g: &Self::Element) -> bool {
        let (a, b) = (self.size(f), self.size(g));
        self.is_negligible(&self.sub(f, g), if a > b { &a } else { &b })
    }
    /// The number of values.
    fn terms(&self, f: &Self::Element) -> usize {
        f.values.iter().flatten().count() * self.nodes
    }
    fn interrupted(&self) -> bool {
        self.stop.asked()
    }
}

impl<R: Reals> PhaseAlgebra for Collocation<R> {
    fn cosine(&self) -> Self::Element {
        self.circular(0, 4)
    }
    fn sine(&self) -> Self::Element {
        self.circular(3, 4)
    }
    /// NaN where it is not known; see the module.
    fn derivative(&self, f: &Self::Element) -> Self::Element {
        match &f.derivative {
            _ if self.is_zero(f) => self.zero(),
            Some(derivative) => (**derivative).clone(),
            None => self.unknown(),
        }
    }
    fn at_zero(&self, f: &Self::Element) -> Option<R::Element> {
        let even = self.initial(COS_EVEN, f.values[COS_EVEN].as_ref());
        Some(self.reals.add(&even, &self.initial(COS_ODD, f.values[COS_ODD].as_ref())))
    }
    fn first_harmonic(&self, f: &Self::Element) -> Result<(R::Element, R::Element), PhaseError> {
        let cos = self.amplitude(COS_ODD, f.values[COS_ODD].as_ref());
        let sin = self.amplitude(SIN_ODD, f.values[SIN_ODD].as_ref());
        Ok((cos, sin))
    }
    fn resolve(&self, f: &Self::Element) -> Result<Resolution<Self>, PhaseError> {
        let (cos_amplitude, sin_amplitude) = self.first_harmonic(f)?;
        let mut rest = self.sub(f, &self.scale_by(&self.cosine(), &cos_amplitude));
        rest = self.sub(&rest, &self.scale_by(&self.sine(), &sin_amplitude));
        let mut parts: [[Option<Vec<R::Element>>; PARTS]; 2] = Default::default();
        let mut free = self.zero();
        for (part, values) in rest.values.iter().enumerate() {
            let Some(values) = values else { continue };
            let found = self.particular(part, values);
            // A derivative exchanges cosines and sines.
            parts[0][part] = Some(found.u);
            parts[1][part ^ SIN_EVEN] = Some(found.slope);
            // u(0) = A0 for even cosines: take A0 cos psi off; u'(0) = -A0 for even sines.
            let term = match part {
                COS_EVEN => self.scale_by(&self.cosine(), &self.reals.neg(&found.free)),
                SIN_EVEN => self.scale_by(&self.sine(), &found.free),
                _ => continue,
            };
            self.add_assign(&mut free, &term);
        }
        let [u, slope] = parts.map(|values| self.with_parts(values));
        let (mut u, mut slope) = (u, slope);
        slope.derivative = Some(Arc::new(self.sub(&rest, &u)));
        u.derivative = Some(Arc::new(slope));
        self.add_assign(&mut u, &free);
        Ok(Resolution { cos_amplitude, sin_amplitude, response: u })
    }
}
