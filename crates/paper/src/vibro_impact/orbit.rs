//! (8) and what follows it: the periodic orbit with one impact in T.

use super::FAILED;
use super::averaged::averaged;
use super::judge::{Printed, Statement};
use super::setting::Setting;
use crate::Row;
use lindstedt::Error;
use lindstedt::unstable::coeff::quotient::{Quotient, Quotients};
use lindstedt::unstable::impact::linearised::{ImpactMap, coefficient, replace};
use rug::Rational;
use std::sync::Arc;

/// The map's field with the words of this page behind.
pub(super) fn extended(map: &ImpactMap) -> Quotients {
    let mut field = map.field.clone();
    let more =
        "alpha c lambda beta P0 F pi k l T t tau phi C0 theta0 cos(theta0) sin(theta0) dT R_tau";
    field.field.ring.parameters.extend(more.split(' ').map(str::to_owned));
    let [cos, sin] = ["cos(theta0)", "sin(theta0)"].map(|name| field.field.position(name));
    if let (Some(cos), Some(sin)) = (cos, sin) {
        field.field.pairs.push((cos, sin));
    }
    field
}

/// Adds an angle whose cosine and sine are parameters.
pub(super) fn with_pair(mut setting: Setting, angle: &str, cos: &str, sin: &str) -> Setting {
    if let Some(angle) = setting.read(angle) {
        let [cos, sin] = [cos, sin].map(|name| setting.field.parameter(name));
        setting.meaning.angles.push([angle, cos, sin]);
    }
    setting
}

/// What is derived here.
struct Derived {
    q: Quotients,
    /// C, D, cos phi, sin phi for any R, alpha0.
    any: [Quotient; 4],
    /// The same for R = -c/2, alpha0 = lambda.
    uncontrolled: [Quotient; 4],
    /// Whether the orbit meets the end conditions.
    closes: bool,
    /// lambda^2.
    lambda_squared: Quotient,
    /// F^2 by the equation with damping.
    amplitude_squared: Quotient,
}

fn derive() -> Option<Derived> {
    let map = ImpactMap::derive()?;
    let q = extended(&map);
    let p = |name: &str| q.parameter(name);
    let found = map.periodic_orbit()?;
    let closes = map.is_periodic(&found);
    let [c, d, cos, sin] = found;
    let over = |f: &Quotient| q.div(f, &p("a"));
    let named = |f: &Quotient| replace(&q, f, &[("a", p("F"))]);
    let any = [named(&c)?, named(&d)?, named(&over(&cos)?)?, named(&over(&sin)?)?];
    // (R + i W)^2 + c (R + i W) + alpha^2 = 0: imaginary part 2 R + c, real part W^2.
    let minus_half = q.mul(&q.rational(&Rational::from((-1, 2))), &p("c"));
    let lambda_squared = q.sum(&[
        &q.mul(&p("alpha"), &p("alpha")),
        &q.mul(&minus_half, &minus_half),
        &q.mul(&p("c"), &minus_half),
    ]);
    let images = [("R", minus_half), ("alpha0", p("lambda"))];
    let special = |f: &Quotient| replace(&q, f, &images);
    let [c, d, cos, sin] = &any;
    let uncontrolled = [special(c)?, special(d)?, special(cos)?, special(sin)?];
    // x = X cos + Y sin in x'' + c x' + alpha^2 x = P0 cos: (d X + l Y, d Y - l X) = (P0, 0) with
    // d = alpha^2 - omega^2, l = c omega; X = P0 d/n, Y = P0 l/n, n = d^2 + l^2.
    let square = |name: &str| q.mul(&p(name), &p(name));
    let detuning = q.sub(&square("alpha"), &square("omega"));
    let loss = q.mul(&p("c"), &p("omega"));
    let norm = q.add(&q.mul(&detuning, &detuning), &q.mul(&loss, &loss));
    let [x, y] = [q.mul(&p("P0"), &detuning), q.mul(&p("P0"), &loss)];
    let sum = q.add(&q.mul(&x, &x), &q.mul(&y, &y));
    let amplitude_squared = q.div(&q.div(&sum, &norm)?, &norm)?;
    Some(Derived { q, closes, any, uncontrolled, lambda_squared, amplitude_squared })
}

/// The words of the formulas after (8) for a flight with these C, D, cos phi, sin phi.
fn words(q: &Quotients, orbit: &[Quotient; 4], angle: &str, exponent: &str) -> Setting {
    let words = ["c", "lambda", "omega", "s", "F", "v", "R_r", "beta", "phi", "R", "alpha0"];
    let mut setting = Setting::new(q.clone());
    setting = with_pair(setting, angle, "cos(theta)", "sin(theta)");
    let [c, _, cos, sin] = orbit.clone();
    setting = setting.means("C", c);
    if let Some(phi) = setting.read("phi") {
        setting.meaning.angles.push([phi, cos, sin]);
    }
    if let Some(base) = setting.read(exponent) {
        setting.meaning.exponentials.push([base, q.parameter("E")]);
    }
    setting.only(&[&words[..], &["C"]].concat())
}

const D_PRINTED: &str = "C/sin(2*beta*lambda)*(exp(beta*c) - cos(2*beta*lambda))";
const POLYNOMIALS: &str = "exact, as polynomials";
const RESIDUALS: &str = "the solution put into the four end conditions: exact";

/// The formulas around (8) as printed.
const PRINTED: [Printed; 12] = [
    Printed::new("(8)", "amplitude ", "P0/(alpha^2 - omega^2)").squared().with(
        "$F = P0/sqrt((alpha^2 - omega^2)^2 + c^2 omega^2)$",
        "squares compared; linear equations for the cosine and the sine",
        "",
    ),
    Printed::new("$C$, polar", "C = ", "C0*cos(theta0)").with("", POLYNOMIALS, ""),
    Printed::new("$D$, polar", "D = ", "-C0*sin(theta0)").with("", POLYNOMIALS, ""),
    Printed::new("$C_0$", "C_0 = ", "sqrt(C^2 + D^2)").squared().with("$C0$", POLYNOMIALS, ""),
    Printed::new("$C$", "C = ", "s - F*cos(phi)").with(
        "$-(1 + R_r) sin(theta) v/(lambda Delta)$",
        RESIDUALS,
        "$Delta = E + 1/E - 2 cos(theta)$, $E = e^(-beta c)$, $theta = 2 beta lambda$",
    ),
    Printed::new("$D$", "D = ", D_PRINTED).with(
        "$-(1 + R_r) (1/E - cos(theta)) v/(lambda Delta)$",
        RESIDUALS,
        "the printed form is 0/0 where $sin(2 beta lambda) = 0$, the derived one is not",
    ),
    Printed::new(
        "$cos phi$",
        "cos phi = ",
        "s/F - (R_r + 1)*v*sin(2*beta*lambda)\
         /(lambda*F*(2*cos(2*beta*lambda) - exp(-beta*c) - exp(beta*c)))",
    )
    .with(
        "$(s + (1 + R_r) sin(theta) v/(lambda Delta))/F$",
        RESIDUALS,
        "$v = x'_-$, before the impact",
    ),
    Printed::new(
        "$sin phi$",
        "sin phi = ",
        "(-1/2*(R_r + 1)*c*sin(2*beta*lambda) + lambda*[(R_r - 1)*cos(2*beta*lambda) \
         + exp(-beta*c) - R_r*exp(beta*c))\
         /(lambda*F*omega*(2*cos(2*beta*lambda) - exp(-beta*c) - exp(beta*c)))*v",
    )
    .with(
        "${lambda [R_r (E - cos theta) - (1/E - cos theta)] + (1 + R_r) (c/2) sin theta} \
         v/(omega lambda F Delta)$",
        RESIDUALS,
        "equal only for $c = 0$ as printed",
    ),
    Printed::new("$F$", "F = ", "P0/sqrt((alpha0^2 - omega^2)^2 + c^2*omega^2)").squared().with(
        "$P0/sqrt((alpha^2 - omega^2)^2 + c^2 omega^2)$",
        "squares compared; the response sees neither $A$ nor $B$",
        "",
    ),
    Printed::new("$lambda$", "lambda = ", "sqrt(alpha^2 - omega^2)").squared().with(
        "$sqrt(alpha^2 - c^2/4)$",
        "squares compared; both parts of $l^2 + c l + alpha^2 = 0$ at $l = -c/2 + i lambda$",
        "the symbol and a factor of one term are wrong, $c^2/4$ is no slip for $omega^2$; the \
         printed root is imaginary for $omega > alpha$",
    ),
    Printed::new("$beta$", "beta = ", "pi*k/omega").with("", POLYNOMIALS, ""),
    Printed::new("$C$, $D$ in (8)", "D = ", D_PRINTED).with(
        "$D$ with $alpha0$ and $-2 R$ in the places of $lambda$ and $c$",
        RESIDUALS,
        "the amplitudes printed with $(c, lambda)$ meet the end conditions of the flight with \
         $(-c/2, lambda)$, not of (8) with $(R, alpha0)$: for $A$, $B$ other than zero the orbit of \
         (8) is another",
    ),
];

/// The polar form, C_0 cos(alpha0 tau + theta_0) by the product of two rotations: the factors of
/// cos(alpha0 tau) and sin(alpha0 tau).
fn polar_factors(q: &Quotients) -> [Quotient; 2] {
    let p = |name: &str| q.parameter(name);
    let rotation = q.sub(
        &q.mul(&p("cos(theta0)"), &p("cos(alpha0*tau)")),
        &q.mul(&p("sin(theta0)"), &p("sin(alpha0*tau)")),
    );
    let free = q.mul(&p("C0"), &rotation);
    ["cos(alpha0*tau)", "sin(alpha0*tau)"].map(|name| coefficient(q, &free, name))
}

/// The words of the amplitudes of (8) with (R, alpha0). e^(beta c) and the functions of
/// 2 beta lambda are independent of those.
fn mixed_words(derived: &Derived) -> Setting {
    let q = &derived.q;
    let mut mixed = words(q, &derived.any, "2*beta*alpha0", "2*beta*R");
    mixed = with_pair(mixed, "2*beta*lambda", "cos(theta0)", "sin(theta0)");
    if let Some(base) = mixed.read("beta*c") {
        mixed.meaning.exponentials.push([base, q.parameter("C0")]);
    }
    mixed
}

/// The formulas around (8) beside what is derived.
pub(super) fn statements() -> Result<Vec<Statement>, Error> {
    let derived = derive().ok_or(FAILED)?;
    let q = &derived.q;
    let p = |name: &str| q.parameter(name);
    let all = || Setting::new(q.clone());
    let [of_cos, of_sin] = polar_factors(q);
    let polar = with_pair(all(), "theta0", "cos(theta0)", "sin(theta0)").only(&["C0", "theta0"]);
    let parts = all().means("C", of_cos.clone()).means("D", of_sin.clone()).only(&["C", "D", "R"]);
    let own = words(q, &derived.uncontrolled, "2*beta*lambda", "-beta*c");
    let literal = all().only(&["P0", "alpha", "alpha0", "omega", "c", "pi", "k", "R_r", "s"]);
    let [polar, parts, own, literal, mixed] =
        [polar, parts, own, literal, mixed_words(&derived)].map(Arc::new);
    let half_period = q.div(&q.mul(&p("pi"), &p("k")), &p("omega")).ok_or(FAILED)?;
    let [c, d, cos, sin] = derived.uncontrolled;
    let [_, any_d, _, _] = derived.any;
    let truth = [
        (&literal, derived.amplitude_squared.clone()),
        (&polar, of_cos),
        (&polar, of_sin),
        (&parts, q.mul(&p("C0"), &p("C0"))),
        (&own, c),
        (&own, d),
        (&own, cos),
        (&own, sin),
        (&literal, derived.amplitude_squared),
        (&literal, derived.lambda_squared),
        (&literal, half_period),
        (&mixed, any_d),
    ];
    let pairs = PRINTED.iter().zip(truth);
    let mut list: Vec<_> = pairs.map(|(line, (words, value))| line.against(words, value)).collect();
    for found in list.iter_mut().filter(|found| found.independent == RESIDUALS && !derived.closes) {
        found.independent = "the solution does not meet the end conditions".to_owned();
    }
    Ok(list)
}

/// (8) and the formulas after it.
pub(super) fn rows() -> Result<Vec<Row>, Error> {
    let mut rows: Vec<Row> = statements()?.iter().flat_map(Statement::rows).collect();
    if let Some(first) = rows.first_mut() {
        // The averaged response: its square is F^2 order by order in c.
        let orders = response_orders()?;
        first.evidence = format!(
            "{}; the averaged response has the same square in orders 0 to {orders} of the \
             damping; with this amplitude and $F$ in the phase the multipliers are wrong, see the \
             table of multipliers",
            first.evidence.marked()
        )
        .into();
    }
    Ok(rows)
}

/// The orders to which X^2 + Y^2 of the averaged response is the expansion of F^2: each order of
/// (X^2 + Y^2) ((alpha^2 - omega^2)^2 + c^2 omega^2) = P0^2.
fn response_orders() -> Result<usize, Error> {
    const ORDER: usize = 3;
    let found = averaged(ORDER)?;
    let q = &found.setting.field;
    let square_at = |n: usize| {
        let mut sum = q.integer(0);
        for (m, first) in found.response.iter().enumerate().take(n + 1) {
            if let Some(second) = found.response.get(n - m) {
                for (a, b) in first.iter().zip(second) {
                    sum = q.add(&sum, &q.mul(a, b));
                }
            }
        }
        sum
    };
    let read = |text: &str| found.setting.read(text).ok_or(FAILED);
    let [detuning, loss, force] =
        [read("(alpha^2 - omega^2)^2")?, read("c^2*omega^2")?, read("P0^2")?];
    let holds = |n: usize| {
        let mut sum = q.mul(&square_at(n), &detuning);
        if n >= 2 {
            sum = q.add(&sum, &q.mul(&square_at(n - 2), &loss));
        }
        if n == 0 { q.equal(&sum, &force) } else { q.is_zero(&sum) }
    };
    Ok((0..=ORDER).take_while(|n| holds(*n)).count().saturating_sub(1))
}
