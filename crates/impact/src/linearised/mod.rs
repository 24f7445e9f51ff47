//! The linearised map of one flight and impact, derived from the flight itself.
//!
//! Between two impacts
//!
//! ```text
//! x(tau) = e^(R tau) (C cos(alpha0 tau) + D sin(alpha0 tau)) + a cos(omega tau + phi)
//! ```
//!
//! and at x = s the velocity jumps, x' -> -R_r x'. A motion near one with impacts at multiples of
//! T = 2 pi k/omega has C + dC, D + dD, phi + dphi and flights of T + dT. Its equations are the
//! derivatives of x and x' at both ends of the flight, by formal differentiation; nothing is
//! assumed about C, D, phi but that x(0) = x(T) = s.

mod orbit;

use lindstedt_algebra::Ring;
use lindstedt_coeff::Symbol;
use lindstedt_coeff::parameters::ParameterFraction;
use lindstedt_coeff::polynomial::PowerProduct;
use lindstedt_coeff::quotient::{Quotient, Quotients};
use lindstedt_coeff::sparse::{Monomial, Sparse};
use rug::Rational;

/// Parameters; E = e^(R T), theta = alpha0 T. `exp(R*tau)` and the cosines and sines with tau are
/// functions of the time tau since the impact. A prime marks the next flight. The wall s and the
/// impact velocity v do not occur in the map; they serve the conditions of a periodic orbit.
const NAMES: [&str; 27] = [
    "R",
    "alpha0",
    "omega",
    "R_r",
    "C",
    "D",
    "a",
    "E",
    "cos(theta)",
    "sin(theta)",
    "cos(phi)",
    "sin(phi)",
    "exp(R*tau)",
    "cos(alpha0*tau)",
    "sin(alpha0*tau)",
    "cos(omega*tau + phi)",
    "sin(omega*tau + phi)",
    "dC",
    "dD",
    "dphi",
    "dtau",
    "dC'",
    "dD'",
    "dphi'",
    "gamma",
    "s",
    "v",
];

/// The cosines and sines among them.
const PAIRS: [(&str, &str); 4] = [
    ("cos(theta)", "sin(theta)"),
    ("cos(phi)", "sin(phi)"),
    ("cos(alpha0*tau)", "sin(alpha0*tau)"),
    ("cos(omega*tau + phi)", "sin(omega*tau + phi)"),
];

/// The linearised equations and what follows from them. All elements belong to `field`.
#[derive(Clone, Debug)]
pub struct ImpactMap {
    /// The field of all parameters.
    pub field: Quotients,
    /// x(tau).
    pub displacement: Quotient,
    /// x'(tau).
    pub velocity: Quotient,
    /// dx = x_C dC + x_D dD + x_phi dphi + x' dtau.
    pub displacement_variation: Quotient,
    /// dx' = x'_C dC + x'_D dD + x'_phi dphi + x'' dtau.
    pub velocity_variation: Quotient,
    /// x(0).
    pub displacement_after: Quotient,
    /// x(T).
    pub displacement_before: Quotient,
    /// x'(0), after an impact.
    pub velocity_after: Quotient,
    /// x'(T), before the next one.
    pub velocity_before: Quotient,
    /// dx at tau = 0 for dtau = 0.
    pub start_displacement: Quotient,
    /// dx' at tau = 0 for dtau = 0.
    pub start_velocity: Quotient,
    /// dx at tau = T; dtau is the change of the length of the flight.
    pub end_displacement: Quotient,
    /// dx' at tau = T.
    pub end_velocity: Quotient,
    /// Three forms that vanish: dx at the start of this flight; dx at the end of this flight less
    /// dx at the start of the next; R_r dx' at the end plus dx' at the next start; with
    /// dtau = (dphi' - dphi)/omega.
    pub equations: [Quotient; 3],
    /// \[b_0, b_1, b_2\]: the determinant of the three forms with next = gamma * this is
    /// b_2 gamma^2 + b_1 gamma + b_0.
    pub characteristic: [Quotient; 3],
    /// Trace of the Jacobian of (phi, x'(0)) -> (phi', x'(0)'), by the implicit function theorem.
    pub trace: Quotient,
    /// Its determinant.
    pub determinant: Quotient,
}

impl ImpactMap {
    /// Derives everything; exact. Some milliseconds. Nothing only if a division by zero occurs,
    /// which the symbolic parameters exclude.
    ///
    /// ```
    /// use lindstedt_impact::linearised::ImpactMap;
    /// let map = ImpactMap::derive().ok_or("no map")?;
    /// let q = &map.field;
    /// // det = b_0/b_2, trace = -b_1/b_2.
    /// let [b0, b1, b2] = &map.characteristic;
    /// assert!(q.equal(&q.mul(&map.determinant, b2), b0));
    /// assert!(q.equal(&q.mul(&map.trace, b2), &q.neg(b1)));
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn derive() -> Option<Self> {
        let q = Quotients::new(&NAMES, &PAIRS);
        let p = |name: &str| q.parameter(name);
        let free =
            q.add(&q.mul(&p("C"), &p("cos(alpha0*tau)")), &q.mul(&p("D"), &p("sin(alpha0*tau)")));
        let forced = q.mul(&p("a"), &p("cos(omega*tau + phi)"));
        let x = q.add(&q.mul(&p("exp(R*tau)"), &free), &forced);
        let v = time_derivative(&q, &x);
        let [dx, dv] = [&x, &v].map(|f| variation(&q, f));
        let still = |f: &Quotient| at_start(&q, f, true);
        let start = [still(&dx)?, still(&dv)?];
        let end = [at_end(&q, &dx)?, at_end(&q, &dv)?];

        let step = q.div(&q.sub(&p("dphi'"), &p("dphi")), &p("omega"))?;
        let with_step = |f: &Quotient| replace(&q, f, &[("dtau", step.clone())]);
        let next = |f: &Quotient| {
            let primes = ["dC", "dD", "dphi"].map(|name| (name, p(&format!("{name}'"))));
            replace(&q, f, &primes)
        };
        let equations = [
            start[0].clone(),
            q.sub(&with_step(&end[0])?, &next(&start[0])?),
            q.add(&q.mul(&p("R_r"), &with_step(&end[1])?), &next(&start[1])?),
        ];
        let (trace, determinant) = jacobian(&q, &start, &end)?;
        Some(Self {
            displacement_after: at_start(&q, &x, false)?,
            displacement_before: at_end(&q, &x)?,
            velocity_after: at_start(&q, &v, false)?,
            velocity_before: at_end(&q, &v)?,
            characteristic: characteristic(&q, &equations)?,
            displacement: x,
            velocity: v,
            displacement_variation: dx,
            velocity_variation: dv,
            start_displacement: start[0].clone(),
            start_velocity: start[1].clone(),
            end_displacement: end[0].clone(),
            end_velocity: end[1].clone(),
            equations,
            trace,
            determinant,
            field: q,
        })
    }
}

/// The derivation of polynomials f that sends a parameter to `image` of its name (nothing: zero).
#[must_use]
pub fn derivation(
    q: &Quotients,
    f: &Quotient,
    image: &dyn Fn(&str) -> Option<Quotient>,
) -> Quotient {
    let k = &q.field;
    let mut sum = q.integer(0);
    for (monomial, coefficient) in f.numerator.numerator().terms() {
        for &(symbol, exponent) in monomial.factors() {
            let Symbol::Parameter(index) = symbol else { continue };
            let name = k.ring.parameters.get(usize::from(index));
            let Some(image) = name.and_then(|name| image(name)) else { continue };
            let lowered = monomial.times(&PowerProduct::power(symbol, -1));
            let factor = coefficient * Rational::from(exponent);
            let term = Sparse::term(&lindstedt_algebra::Rationals, lowered, factor);
            // The ring operations reduce sines, a bare polynomial is taken as it is.
            let rest = substitute(q, &term, &[]);
            if let Some(rest) = rest {
                sum = q.add(&sum, &q.mul(&q.whole(rest), &image));
            }
        }
    }
    sum
}

fn substitute(
    q: &Quotients,
    p: &lindstedt_coeff::Polynomial,
    images: &[(u16, ParameterFraction)],
) -> Option<ParameterFraction> {
    let k = &q.field;
    k.ring.substitute(k, p, |symbol| {
        let Symbol::Parameter(index) = symbol else { return k.zero() };
        let found = images.iter().find(|(known, _)| *known == index);
        found.map_or_else(|| k.parameter(index), |(_, image)| image.clone())
    })
}

/// f with other elements in the place of some parameters; nothing where a name is unknown, an
/// image has a denominator or one of f becomes zero.
#[must_use]
pub fn replace(q: &Quotients, f: &Quotient, images: &[(&str, Quotient)]) -> Option<Quotient> {
    let whole = |(name, image): &(&str, Quotient)| {
        let is_whole = image.denominator == q.field.one();
        Some((q.field.position(name)?, image.numerator.clone())).filter(|_| is_whole)
    };
    let images: Vec<_> = images.iter().map(whole).collect::<Option<_>>()?;
    let part = |f: &ParameterFraction| {
        f.denominator().is_empty().then(|| substitute(q, f.numerator(), &images)).flatten()
    };
    q.div(&q.whole(part(&f.numerator)?), &q.whole(part(&f.denominator)?))
}

/// d/dtau.
fn time_derivative(q: &Quotients, f: &Quotient) -> Quotient {
    let p = |name: &str| q.parameter(name);
    derivation(q, f, &|name| {
        Some(match name {
            "exp(R*tau)" => q.mul(&p("R"), &p(name)),
            "cos(alpha0*tau)" => q.neg(&q.mul(&p("alpha0"), &p("sin(alpha0*tau)"))),
            "sin(alpha0*tau)" => q.mul(&p("alpha0"), &p("cos(alpha0*tau)")),
            "cos(omega*tau + phi)" => q.neg(&q.mul(&p("omega"), &p("sin(omega*tau + phi)"))),
            "sin(omega*tau + phi)" => q.mul(&p("omega"), &p("cos(omega*tau + phi)")),
            _ => return None,
        })
    })
}

/// f_C dC + f_D dD + f_phi dphi + f' dtau.
fn variation(q: &Quotients, f: &Quotient) -> Quotient {
    let p = |name: &str| q.parameter(name);
    let by_amplitudes = derivation(q, f, &|name| match name {
        "C" => Some(p("dC")),
        "D" => Some(p("dD")),
        "cos(omega*tau + phi)" => Some(q.neg(&q.mul(&p("dphi"), &p("sin(omega*tau + phi)")))),
        "sin(omega*tau + phi)" => Some(q.mul(&p("dphi"), &p("cos(omega*tau + phi)"))),
        _ => None,
    });
    q.add(&by_amplitudes, &q.mul(&time_derivative(q, f), &p("dtau")))
}

/// f at tau = 0, where dtau may vanish.
fn at_start(q: &Quotients, f: &Quotient, still: bool) -> Option<Quotient> {
    let mut images = vec![
        ("exp(R*tau)", q.integer(1)),
        ("cos(alpha0*tau)", q.integer(1)),
        ("sin(alpha0*tau)", q.integer(0)),
        ("cos(omega*tau + phi)", q.parameter("cos(phi)")),
        ("sin(omega*tau + phi)", q.parameter("sin(phi)")),
    ];
    if still {
        images.push(("dtau", q.integer(0)));
    }
    replace(q, f, &images)
}

/// f at tau = T: omega T = 2 pi k.
fn at_end(q: &Quotients, f: &Quotient) -> Option<Quotient> {
    let images = [
        ("exp(R*tau)", "E"),
        ("cos(alpha0*tau)", "cos(theta)"),
        ("sin(alpha0*tau)", "sin(theta)"),
        ("cos(omega*tau + phi)", "cos(phi)"),
        ("sin(omega*tau + phi)", "sin(phi)"),
    ];
    replace(q, f, &images.map(|(from, to)| (from, q.parameter(to))))
}

/// The coefficient of a parameter in a form that is linear in it: the derivative.
#[must_use]
pub fn coefficient(q: &Quotients, form: &Quotient, name: &str) -> Quotient {
    derivation(q, form, &|known| (known == name).then(|| q.integer(1)))
}

/// The determinant of three linear forms in (dC, dD, dphi) with the next three gamma times as
/// large.
///
/// Returns its coefficients in increasing powers of gamma; nothing where it has a higher power
/// than the second.
pub fn characteristic(q: &Quotients, equations: &[Quotient; 3]) -> Option<[Quotient; 3]> {
    let gamma = q.parameter("gamma");
    let entry = |form: &Quotient, name: &str| {
        let next = coefficient(q, form, &format!("{name}'"));
        q.add(&coefficient(q, form, name), &q.mul(&gamma, &next))
    };
    let row = |form: &Quotient| ["dC", "dD", "dphi"].map(|name| entry(form, name));
    let [a, b, c] = [row(&equations[0]), row(&equations[1]), row(&equations[2])];
    let minor = |i: usize, j: usize| q.sub(&q.mul(&b[i], &c[j]), &q.mul(&b[j], &c[i]));
    let determinant = q.sum(&[
        &q.mul(&a[0], &minor(1, 2)),
        &q.neg(&q.mul(&a[1], &minor(0, 2))),
        &q.mul(&a[2], &minor(0, 1)),
    ]);
    // By derivatives at gamma = 0.
    let at_zero = |f: &Quotient| replace(q, f, &[("gamma", q.integer(0))]);
    let first = coefficient(q, &determinant, "gamma");
    let second = coefficient(q, &first, "gamma");
    if !q.is_zero(&coefficient(q, &second, "gamma")) {
        return None;
    }
    let half = q.rational(&Rational::from((1, 2)));
    Some([at_zero(&determinant)?, at_zero(&first)?, q.mul(&half, &at_zero(&second)?)])
}

/// Trace and determinant of the Jacobian of (dphi, dv) -> (dphi', dv') with dv = dx'(0): dC and
/// dD from the start, dtau from the end, the new velocity from the jump.
fn jacobian(
    q: &Quotients,
    start: &[Quotient; 2],
    end: &[Quotient; 2],
) -> Option<(Quotient, Quotient)> {
    let p = |name: &str| q.parameter(name);
    let column = |dphi: i64, dv: i64| {
        let dphi = q.integer(dphi);
        let part = |form: &Quotient, name: &str| coefficient(q, form, name);
        let d_c = q.div(&q.neg(&q.mul(&part(&start[0], "dphi"), &dphi)), &part(&start[0], "dC"))?;
        let rest = q.sub(
            &q.integer(dv),
            &q.add(&q.mul(&part(&start[1], "dC"), &d_c), &q.mul(&part(&start[1], "dphi"), &dphi)),
        );
        let d_d = q.div(&rest, &part(&start[1], "dD"))?;
        let held = |form: &Quotient| {
            q.sum(&[
                &q.mul(&part(form, "dC"), &d_c),
                &q.mul(&part(form, "dD"), &d_d),
                &q.mul(&part(form, "dphi"), &dphi),
            ])
        };
        let d_t = q.neg(&q.div(&held(&end[0]), &part(&end[0], "dtau"))?);
        let before = q.add(&held(&end[1]), &q.mul(&part(&end[1], "dtau"), &d_t));
        Some([q.add(&dphi, &q.mul(&p("omega"), &d_t)), q.neg(&q.mul(&p("R_r"), &before))])
    };
    let [a, c] = column(1, 0)?;
    let [b, d] = column(0, 1)?;
    Some((q.add(&a, &d), q.sub(&q.mul(&a, &d), &q.mul(&b, &c))))
}
