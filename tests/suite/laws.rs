//! Every law of the algebras can fail: an algebra with one defect is caught by the law named
//! after it.

use lindstedt::unstable::algebra::{
    FunctionAlgebra, PhaseAlgebra, PhaseError, RationalAlgebra, Rationals, Resolution, Ring, laws,
};
use lindstedt::unstable::phase::Trigonometric;
use lindstedt::unstable::phase::trigonometric::TrigonometricPolynomial;
use rug::Rational;

type Element = TrigonometricPolynomial<Rational>;

/// Trigonometric polynomials over Q with one operation broken.
struct Broken {
    sound: Trigonometric<Rationals>,
    defect: &'static str,
}

impl Broken {
    fn has(&self, defect: &str) -> bool {
        self.defect == defect
    }
    /// f, or f + cos 2 psi for the broken operation.
    fn spoil(&self, defect: &str, f: Element) -> Element {
        if self.has(defect) { self.sound.add(&f, &self.sound.cos(2, Rational::from(1))) } else { f }
    }
}

impl Ring for Broken {
    type Element = Element;
    fn zero(&self) -> Element {
        self.sound.zero()
    }
    fn one(&self) -> Element {
        match self.defect {
            "one is neutral" => self.sound.cos(0, Rational::from(2)),
            "one is not zero" => self.zero(),
            _ => self.sound.one(),
        }
    }
    fn is_zero(&self, a: &Element) -> bool {
        match self.defect {
            "zero is zero" => false,
            "zero is canonical" => self.sound.is_zero(a) || *a == self.sound.sine(),
            _ => self.sound.is_zero(a),
        }
    }
    fn add_assign(&self, a: &mut Element, b: &Element) {
        match self.defect {
            "zero is neutral" if self.sound.is_zero(b) => *a = self.sound.cosine(),
            // Not symmetric, but right for zero.
            "addition commutes" if !self.sound.is_zero(b) && a.cos.len() > b.cos.len() => {}
            // Symmetric, right for zero and for inverses, but not associative.
            "addition associates" if !self.sound.is_zero(a) && !self.sound.is_zero(b) => {
                let sum = self.sound.add(a, b);
                if !self.sound.is_zero(&sum) {
                    *a = self.sound.scale(&sum, &Rational::from((7, 13)));
                } else {
                    *a = sum;
                }
            }
            _ => self.sound.add_assign(a, b),
        }
    }
    fn neg(&self, a: &Element) -> Element {
        if self.has("negation") { a.clone() } else { self.sound.neg(a) }
    }
    fn sub(&self, a: &Element, b: &Element) -> Element {
        match self.defect {
            "subtraction" => self.sound.add(a, b),
            // The inverse of the broken addition below.
            "addition associates" if !self.sound.is_zero(a) && !self.sound.is_zero(b) => {
                self.sound.sub(&self.sound.scale(a, &Rational::from((13, 7))), b)
            }
            _ => self.sound.sub(a, b),
        }
    }
    fn mul(&self, a: &Element, b: &Element) -> Element {
        let product = self.sound.mul(a, b);
        let trivial = *a == self.sound.one() || *b == self.sound.one();
        match self.defect {
            "multiplication commutes" if !trivial && a.cos.len() > b.cos.len() => {
                self.sound.neg(&product)
            }
            // Bilinear and with the right unit: a b + (first harmonics of a and b) cos 2 psi.
            "multiplication associates" => {
                let first = |f: &Element| f.cos.get(1).cloned().unwrap_or_default();
                let extra = self.sound.cos(2, first(a) * first(b));
                self.sound.add(&product, &extra)
            }
            // Associative, since nothing but one gives a product.
            "distributivity" if !trivial => self.sound.zero(),
            _ => product,
        }
    }
    fn sum_of_products(&self, pairs: &[(&Element, &Element)]) -> Element {
        let mut sum = self.zero();
        for (a, b) in pairs {
            self.add_assign(&mut sum, &self.mul(a, b));
        }
        self.spoil("sum of products", sum)
    }
}

impl RationalAlgebra for Broken {
    fn rational(&self, q: &Rational) -> Element {
        match self.defect {
            "rational sums" => self.sound.rational(&Rational::from(q * q)),
            "rational products" => self.sound.rational(&Rational::from(q * 2u32)),
            _ => self.sound.rational(q),
        }
    }
    fn scale(&self, f: &Element, q: &Rational) -> Element {
        self.spoil("scaling", self.sound.scale(f, q))
    }
    fn reciprocal(&self, f: &Element) -> Option<Element> {
        if self.has("reciprocal") { Some(f.clone()) } else { self.sound.reciprocal(f) }
    }
    fn as_rational(&self, f: &Element) -> Option<Rational> {
        if self.has("rational numbers are recognised") { None } else { self.sound.as_rational(f) }
    }
}

impl FunctionAlgebra for Broken {
    type Constants = Rationals;
    fn constants(&self) -> &Rationals {
        self.sound.constants()
    }
    fn embed(&self, c: &Rational) -> Element {
        self.sound.embed(c)
    }
    fn scale_by(&self, f: &Element, c: &Rational) -> Element {
        self.sound.scale_by(f, c)
    }
    fn linear_combination(&self, terms: &[(&Element, &Rational)]) -> Element {
        self.spoil("linear combination", self.sound.linear_combination(terms))
    }
    fn as_constant(&self, f: &Element) -> Option<Rational> {
        self.sound.as_constant(f)
    }
    fn log_abs(&self, f: &Element) -> Option<Element> {
        self.sound.log_abs(f)
    }
    fn terms(&self, f: &Element) -> usize {
        self.sound.terms(f)
    }
}

impl PhaseAlgebra for Broken {
    fn cosine(&self) -> Element {
        if self.has("cos^2 + sin^2 = 1") {
            return self.sound.cos(1, Rational::from(2));
        }
        self.sound.cosine()
    }
    fn sine(&self) -> Element {
        match self.defect {
            "sin' = cos" => self.sound.neg(&self.sound.sine()),
            "cos^2 + sin^2 = 1" => self.sound.sin(1, Rational::from(2)),
            _ => self.sound.sine(),
        }
    }
    fn derivative(&self, f: &Element) -> Element {
        let slope = self.sound.derivative(f);
        match self.defect {
            "cos' = -sin" if *f == self.sound.cosine() => self.sound.sine(),
            "constants have derivative zero" if self.sound.as_constant(f).is_some() => {
                self.sound.one()
            }
            "Leibniz" if f.cos.len() > 2 => self.sound.zero(),
            _ => slope,
        }
    }
    fn at_zero(&self, f: &Element) -> Option<Rational> {
        self.sound.at_zero(f)
    }
    fn first_harmonic(&self, f: &Element) -> Result<(Rational, Rational), PhaseError> {
        let (c, s) = self.sound.first_harmonic(f)?;
        Ok(if self.has("the resonant part is the first harmonic") { (c + 1u32, s) } else { (c, s) })
    }
    fn resolve(&self, f: &Element) -> Result<Resolution<Self>, PhaseError> {
        let Resolution { cos_amplitude, sin_amplitude, mut response } = self.sound.resolve(f)?;
        response = self.spoil("the split rebuilds", response);
        if self.has("the response starts at rest") {
            response = self.sound.add(&response, &self.sound.cosine());
        }
        Ok(Resolution { cos_amplitude, sin_amplitude, response })
    }
}

#[test]
fn every_law_can_fail() {
    let sound = Trigonometric::new(Rationals);
    let two = sound.cos(0, Rational::from(2));
    let mixed = sound.add(&sound.cos(3, Rational::from((1, 3))), &sound.sin(2, Rational::from(4)));
    let samples = [sound.zero(), sound.one(), two, sound.cosine(), sound.sine(), mixed];
    assert_eq!(laws::phase_algebra(&sound, &samples), Ok(()));
    for defect in [
        "zero is zero",
        "one is not zero",
        "zero is canonical",
        "zero is neutral",
        "one is neutral",
        "negation",
        "addition commutes",
        "multiplication commutes",
        "subtraction",
        "addition associates",
        "multiplication associates",
        "distributivity",
        "sum of products",
        "rational sums",
        "rational products",
        "rational numbers are recognised",
        "scaling",
        "reciprocal",
        "sin' = cos",
        "cos' = -sin",
        "cos^2 + sin^2 = 1",
        "constants have derivative zero",
        "Leibniz",
        "linear combination",
        "the split rebuilds",
        "the response starts at rest",
        "the resonant part is the first harmonic",
    ] {
        let broken = Broken { sound, defect };
        assert_eq!(laws::phase_algebra(&broken, &samples), Err(defect), "defect: {defect}");
    }
}
