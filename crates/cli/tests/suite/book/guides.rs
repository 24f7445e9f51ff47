//! The Rust code of the guides.

use super::Outcome;

#[rustfmt::skip]
mod quintic {
    use lindstedt::unstable::equation as lindstedt_equation;

    use lindstedt_equation::{AmplitudeRole, Condition, Expression, Problem};

    pub(crate) fn problem() -> Problem {
        let x = Expression::DISPLACEMENT;
        let conditions = [Condition::InitialAmplitude, Condition::FundamentalAmplitude];
        Problem::new("quintic", Expression::ACCELERATION + x.clone() + Expression::Small * x.pow(5))
            .with_title("quintic oscillator x'' + x + eps x^5 = 0, in rho = eps A^4")
            .with_small("rho")
            .under(conditions, AmplitudeRole::InSmallParameter)
            .with_parameter("eps", "coefficient of the quintic force", "1")
            .with_parameter("amplitude", "A: x(0), or the first harmonic", "1")
            .with_notes("m x'' + k x + k_5 x^5 = 0 with time in sqrt(m/k) and eps = k_5/k")
            .with_source("energy integral, docs/src/guide/add-a-problem.md")
    }
}

#[rustfmt::skip]
#[test]
fn quintic_by_the_energy_integral() -> Outcome {
    use lindstedt::{Quantity, unstable::derivation::Settings, unstable::derivation::derive};

    let settings = Settings { order: 2, ..Settings::default() };
    let result = derive(&quintic::problem(), &settings, &mut |_| true)?;
    assert_eq!(result.exact(Quantity::Period, 1).as_deref(), Some("-5/16"));
    assert_eq!(result.exact(Quantity::Period, 2).as_deref(), Some("515/3072"));
    Ok(())
}

#[rustfmt::skip]
mod quadratic_field {
    use super::Outcome;

    use lindstedt::unstable::algebra::{RationalAlgebra, Ring};
    use rug::Rational;

    /// Q(sqrt d), d not a square; (p, q) is p + q sqrt d.
    struct QuadraticField {
        d: u32,
    }

    impl Ring for QuadraticField {
        type Element = (Rational, Rational);

        fn zero(&self) -> Self::Element {
            (Rational::new(), Rational::new())
        }
        fn one(&self) -> Self::Element {
            (Rational::from(1), Rational::new())
        }
        fn is_zero(&self, a: &Self::Element) -> bool {
            a.0.is_zero() && a.1.is_zero()
        }
        fn add_assign(&self, a: &mut Self::Element, b: &Self::Element) {
            a.0 += &b.0;
            a.1 += &b.1;
        }
        fn neg(&self, a: &Self::Element) -> Self::Element {
            (Rational::from(-&a.0), Rational::from(-&a.1))
        }
        fn mul(&self, a: &Self::Element, b: &Self::Element) -> Self::Element {
            let square = Rational::from(&a.1 * &b.1) * self.d;
            let mixed = Rational::from(&a.0 * &b.1) + Rational::from(&a.1 * &b.0);
            (Rational::from(&a.0 * &b.0) + square, mixed)
        }
    }

    impl RationalAlgebra for QuadraticField {
        fn rational(&self, q: &Rational) -> Self::Element {
            (q.clone(), Rational::new())
        }
        fn scale(&self, a: &Self::Element, q: &Rational) -> Self::Element {
            (Rational::from(&a.0 * q), Rational::from(&a.1 * q))
        }
        fn reciprocal(&self, a: &Self::Element) -> Option<Self::Element> {
            let norm = Rational::from(a.0.square_ref()) - Rational::from(a.1.square_ref()) * self.d;
            let inverse = || (Rational::from(&a.0 / &norm), -Rational::from(&a.1 / &norm));
            (!norm.is_zero()).then(inverse)
        }
        fn as_rational(&self, a: &Self::Element) -> Option<Rational> {
            a.1.is_zero().then(|| a.0.clone())
        }
    }

    #[test]
    fn its_laws() {
        use lindstedt::unstable::algebra::{PhaseAlgebra, laws};
        use lindstedt::unstable::phase::Trigonometric;

        let field = QuadraticField { d: 2 };
        let root = (Rational::new(), Rational::from(1));
        let third = field.rational(&Rational::from((1, 3)));
        let samples = [field.zero(), field.one(), root.clone(), field.add(&root, &third)];
        assert_eq!(laws::rational_algebra(&field, &samples), Ok(()));

        let algebra = Trigonometric::new(field);
        let f = algebra.add(&algebra.cos(3, root), &algebra.sine());
        let samples = [algebra.zero(), algebra.one(), algebra.cosine(), f];
        assert_eq!(laws::phase_algebra(&algebra, &samples), Ok(()));
    }

    #[test]
    fn an_expansion_over_it() -> Outcome {
        use lindstedt::Oscillator;
        use lindstedt::unstable::equation::Condition;
        use lindstedt::unstable::expand::{Binding, Request, check, compile, expand};
        use lindstedt::unstable::phase::Trigonometric;

        /// k = sqrt 2.
        struct Values;

        impl Binding<QuadraticField> for Values {
            fn parameter(&self, name: &str) -> Option<(Rational, Rational)> {
                (name == "k").then(|| (Rational::new(), Rational::from(1)))
            }
        }

        let algebra = Trigonometric::new(QuadraticField { d: 2 });
        let tree = Oscillator::parse("x'' + x + eps*k*x^3 = 0")?.problem().equation.clone();
        let equation = compile(&algebra, &tree, &Values, 4)?;
        let condition = Condition::InitialAmplitude;
        let request = Request { condition, order: 4, leading_amplitude: Rational::from(1) };
        let expansion = expand(&algebra, &equation, &request, &mut |_| true)?;
        assert_eq!(check(&algebra, &equation, &expansion)?, 4);
        // Duffing's 3/4 and -3/128, times sqrt 2 and 2.
        assert_eq!(expansion.frequency_squared[1], (Rational::new(), Rational::from((3, 4))));
        assert_eq!(expansion.frequency_squared[2], (Rational::from((-3, 64)), Rational::new()));
        Ok(())
    }
}
