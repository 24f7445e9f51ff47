//! Laws as callable tests: each function returns the name of the first law that fails.
//!
//! A ring of the workspace runs them with one call on elements of its choice; the tests of this
//! crate break each law once to see that the check can fail.

use crate::{PhaseAlgebra, RationalAlgebra, Ring};
use rug::Rational;

/// A failed law, by name.
pub type Broken = &'static str;

fn law(holds: bool, name: Broken) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(name) }
}

/// The axioms of a commutative ring with one, and that `sum_of_products` is what it says.
///
/// # Errors
/// The name of the first law that fails.
pub fn ring<R: Ring>(r: &R, samples: &[R::Element]) -> Result<(), Broken> {
    let (zero, one) = (r.zero(), r.one());
    law(r.is_zero(&zero), "zero is zero")?;
    law(!r.is_zero(&one), "one is not zero")?;
    for a in samples {
        law(r.is_zero(a) == (*a == zero), "zero is canonical")?;
        law(r.add(a, &zero) == *a, "zero is neutral")?;
        law(r.mul(a, &one) == *a, "one is neutral")?;
        law(r.is_zero(&r.add(a, &r.neg(a))), "negation")?;
        for b in samples {
            law(r.add(a, b) == r.add(b, a), "addition commutes")?;
            law(r.mul(a, b) == r.mul(b, a), "multiplication commutes")?;
            law(r.add(&r.sub(a, b), b) == *a, "subtraction")?;
        }
    }
    for a in samples {
        for b in samples {
            for c in samples {
                law(r.add(&r.add(a, b), c) == r.add(a, &r.add(b, c)), "addition associates")?;
                law(r.mul(&r.mul(a, b), c) == r.mul(a, &r.mul(b, c)), "multiplication associates")?;
                let sum = r.add(&r.mul(a, b), &r.mul(a, c));
                law(r.mul(a, &r.add(b, c)) == sum, "distributivity")?;
                law(r.sum_of_products(&[(a, b), (a, c)]) == sum, "sum of products")?;
                let square = r.add(&r.add(&sum, &sum), &r.mul(c, c));
                let pairs = [(a, b), (a, c)];
                law(r.coefficient_of_square(&pairs, Some(c)) == square, "coefficient of a square")?;
            }
        }
    }
    Ok(())
}

/// The laws of a ring, and that Q is embedded: sums, products and `scale` agree.
///
/// # Errors
/// The name of the first law that fails.
pub fn rational_algebra<R: RationalAlgebra>(r: &R, samples: &[R::Element]) -> Result<(), Broken> {
    ring(r, samples)?;
    let (p, q) = (Rational::from((-7, 3)), Rational::from((5, 11)));
    let (sum, product) = (Rational::from(&p + &q), Rational::from(&p * &q));
    law(r.add(&r.rational(&p), &r.rational(&q)) == r.rational(&sum), "rational sums")?;
    law(r.mul(&r.rational(&p), &r.rational(&q)) == r.rational(&product), "rational products")?;
    law(r.as_rational(&r.rational(&p)) == Some(p.clone()), "rational numbers are recognised")?;
    for a in samples {
        law(r.scale(a, &p) == r.mul(a, &r.rational(&p)), "scaling")?;
        if let Some(inverse) = r.reciprocal(a) {
            law(r.mul(a, &inverse) == r.one(), "reciprocal")?;
        }
    }
    Ok(())
}

/// The laws of a rational algebra, of the derivation, and of the solution of u'' + u = f.
///
/// # Errors
/// The name of the first law that fails.
pub fn phase_algebra<A: PhaseAlgebra>(a: &A, samples: &[A::Element]) -> Result<(), Broken> {
    rational_algebra(a, samples)?;
    derivation_and_solution(a, samples)
}

/// The laws of [`phase_algebra`] without those of the rational algebra (a finite field cannot
/// recognise rational numbers).
///
/// # Errors
/// The name of the first law that fails.
pub fn derivation_and_solution<A: PhaseAlgebra>(
    a: &A,
    samples: &[A::Element],
) -> Result<(), Broken> {
    let constants = a.constants();
    let (cos, sin) = (a.cosine(), a.sine());
    law(a.derivative(&sin) == cos, "sin' = cos")?;
    law(a.derivative(&cos) == a.neg(&sin), "cos' = -sin")?;
    let square_sum = a.add(&a.mul(&cos, &cos), &a.mul(&sin, &sin));
    law(square_sum == a.one(), "cos^2 + sin^2 = 1")?;
    law(a.is_zero(&a.derivative(&a.one())), "constants have derivative zero")?;
    for f in samples {
        for g in samples {
            let leibniz = a.sum_of_products(&[(&a.derivative(f), g), (f, &a.derivative(g))]);
            law(a.derivative(&a.mul(f, g)) == leibniz, "Leibniz")?;
        }
        let two = constants.rational(&Rational::from(2));
        let combination = a.linear_combination(&[(f, &two), (&cos, &two)]);
        law(combination == a.scale(&a.add(f, &cos), &Rational::from(2)), "linear combination")?;
        let Ok(split) = a.resolve(f) else { continue };
        let u = &split.response;
        let mut rebuilt = a.add(&a.derivative(&a.derivative(u)), u);
        law(a.force(u) == rebuilt, "the force of a response")?;
        a.add_assign(&mut rebuilt, &a.scale_by(&cos, &split.cos_amplitude));
        a.add_assign(&mut rebuilt, &a.scale_by(&sin, &split.sin_amplitude));
        law(rebuilt == *f, "the split rebuilds")?;
        for value in [u, &a.derivative(u)] {
            let at_zero = a.at_zero(value);
            law(at_zero.is_some_and(|c| constants.is_zero(&c)), "the response starts at rest")?;
        }
        let harmonic = a.first_harmonic(f);
        let amplitudes = Ok((split.cos_amplitude, split.sin_amplitude));
        law(harmonic == amplitudes, "the resonant part is the first harmonic")?;
    }
    Ok(())
}
