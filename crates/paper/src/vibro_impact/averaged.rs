//! (5)-(7): averaging, with every parameter a symbol.

use super::FAILED;
use super::judge::Statement;
use super::setting::Setting;
use crate::{Row, plain};
use lindstedt::Error;
use lindstedt::unstable::coeff::quotient::{Quotient, Quotients};
use lindstedt::unstable::derivation::averaging::formulas;
use lindstedt::unstable::impact::linearised::{coefficient, replace};
use lindstedt_coeff::amplitude::{AmplitudePolynomial, AmplitudePower};
use lindstedt_coeff::parameters::ParameterFraction;
use lindstedt_problems::vibro_impact;
use rug::Rational;
use std::sync::Arc;

/// The averaged expansion: rates and response, order by order.
pub(super) struct Averaged {
    pub setting: Setting,
    /// R_n with A_n = R_n a.
    pub growth: Vec<Quotient>,
    /// B_n: the rate of psi.
    pub frequency: Vec<Quotient>,
    /// Amplitudes of cos(omega t) and sin(omega t) in x.
    pub response: Vec<[Quotient; 2]>,
    /// Whether x has no free harmonic but a cos psi.
    pub single_harmonic: bool,
}

/// Averages up to an order.
pub(super) fn averaged(order: usize) -> Result<Averaged, Error> {
    let (field, expansion) = formulas(&vibro_impact::problem(), order)?;
    // Parameters added behind leave the positions of the others.
    let mut names = field.ring.parameters.clone();
    names.extend(["a", "t", "C0", "theta0"].map(str::to_owned));
    let mut quotients = Quotients { field };
    quotients.field.ring.parameters = names;
    let q = &quotients;
    let single = |f: &AmplitudePolynomial<ParameterFraction>, exponent: i32| match f.terms() {
        [] => Some(q.integer(0)),
        [(AmplitudePower(e), c)] if *e == exponent => Some(q.whole(c.clone())),
        _ => None,
    };
    let all = |list: &[AmplitudePolynomial<ParameterFraction>], exponent| {
        list.iter().map(|f| single(f, exponent)).collect::<Option<Vec<_>>>().ok_or(FAILED)
    };
    let growth = all(&expansion.amplitude_rate, 1)?;
    let mut frequency = all(&expansion.phase_rate, 0)?;
    if let Some(first) = frequency.first_mut() {
        *first = q.parameter("alpha");
    }
    let mut response = Vec::new();
    let mut single_harmonic = true;
    for (n, x) in expansion.solution.iter().enumerate() {
        let mut of_order = [q.integer(0), q.integer(0)];
        for (harmonic, amplitudes) in x.harmonics() {
            if *harmonic == (0, 1) {
                for (known, amplitude) in of_order.iter_mut().zip(amplitudes) {
                    *known = single(amplitude, 0).ok_or(FAILED)?;
                }
            } else {
                single_harmonic &= n == 0 && *harmonic == (1, 0);
            }
        }
        response.push(of_order);
    }
    let mut setting = Setting::new(quotients.clone());
    if let Some(angle) = setting.read("alpha*T") {
        let [cos, sin] = ["cos(alpha*T)", "sin(alpha*T)"].map(|name| quotients.parameter(name));
        setting.meaning.angles.push([angle, cos, sin]);
    }
    Ok(Averaged { setting, growth, frequency, response, single_harmonic })
}

/// (6) and (7).
pub(super) fn statements() -> Result<Vec<Statement>, Error> {
    let found = averaged(1)?;
    let q = &found.setting.field;
    let words = ["alpha", "A", "B", "c", "T", "a"];
    let setting = Arc::new(found.setting.clone().only(&words));
    let growth = found.growth.get(1).ok_or(FAILED)?;
    let total = found.frequency.iter().fold(q.integer(0), |sum, term| q.add(&sum, term));
    let residual = "residual of the expansion substituted in the equation: zero";
    let statement = |label: &str, left: &str, printed: &str, derived: Quotient| {
        Statement::new((label, left), printed, &setting, derived).with("", residual, "")
    };
    Ok(vec![
        statement(
            "$da/dt$, (6)",
            "da/dt = ",
            "A*a/(2*alpha)*sin(alpha*T) + 1/2*(B - c)*a - B*a/2*cos(alpha*T)",
            q.mul(growth, &q.parameter("a")),
        ),
        statement(
            "$dpsi/dt$, (6)",
            "dpsi/dt = ",
            "alpha - A/(2*alpha) + A/(2*alpha)*cos(alpha*T) + 1/2*B*sin(alpha*T)",
            total.clone(),
        ),
        statement(
            "$R$, (7)",
            "R = ",
            "1/(2*alpha)*[A*sin(alpha*T) - alpha*[c - B*(1 - cos(alpha*T))]]",
            growth.clone(),
        ),
        statement(
            "$alpha_0$, (7)",
            "alpha_0 = ",
            "alpha - A/(2*alpha)*(1 - cos(alpha*T)) + B/2*sin(alpha*T)",
            total,
        ),
    ])
}

/// (5)-(7) with what stands between them.
pub(super) fn rows(order: usize) -> Result<Vec<Row>, Error> {
    let order = order.max(2);
    let found = averaged(order)?;
    let q = &found.setting.field;
    let mut statements = statements()?.into_iter();
    let mut rows = vec![plain(
        "(5)",
        "$z = a(t) cos psi(t)$",
        format!("no other free harmonic in $x$ up to order {order}"),
        "residual zero at every order".to_owned(),
        found.single_harmonic,
        "the equation is linear: the rates are $R_n a$ and constants, at every order derived",
    )];
    rows.extend(statements.by_ref().take(2).flat_map(|s| s.rows()));
    rows.push(uncontrolled(&found, order)?);
    // a = C_0 e^(R t): da/dt = R a, linear in a; psi' constant.
    let linear = found.growth.iter().skip(1).all(|r| q.is_zero(&coefficient(q, r, "a")));
    rows.push(plain(
        "$a(t)$, $psi(t)$, (7)",
        "$a = C_0 e^(R t)$, $psi = alpha_0 t + theta_0$",
        "$da/dt = R a$ and $dpsi/dt = alpha_0$ with constant $R$, $alpha_0$".to_owned(),
        String::new(),
        linear,
        "averaging at higher orders keeps this form: its $R$ and $alpha_0$ are the Taylor sums of the \
         characteristic root of the loop without impacts",
    ));
    rows.extend(statements.flat_map(|s| s.rows()));
    Ok(rows)
}

/// The forced response does not see the loop.
pub(super) fn loop_switched_off(order: usize) -> Result<Row, Error> {
    let found = averaged(order)?;
    let q = &found.setting.field;
    let free = |f: &Quotient| {
        let parts = [&f.numerator, &f.denominator].map(|part| q.whole(part.clone()));
        let names = ["A", "B", "T", "cos(alpha*T)", "sin(alpha*T)"];
        names.iter().all(|name| parts.iter().all(|part| q.is_zero(&coefficient(q, part, name))))
    };
    Ok(plain(
        "loop switched off",
        "the delay loop is switched off where no perturbations are present",
        "the forced response contains neither $A$ nor $B$ nor $T$".to_owned(),
        "delayed terms vanish on every T-periodic motion".to_owned(),
        found.response.iter().flatten().all(free),
        &format!("every order up to {order}"),
    ))
}

/// "For A = B = 0 we get the uncontrolled solution": the rates then, against the roots of
/// l^2 + c l + alpha^2, order by order.
fn uncontrolled(found: &Averaged, order: usize) -> Result<Row, Error> {
    let q = &found.setting.field;
    let off = |f: &Quotient| replace(q, f, &[("A", q.integer(0)), ("B", q.integer(0))]);
    let of = |list: &[Quotient]| list.iter().map(off).collect::<Option<Vec<_>>>().ok_or(FAILED);
    let (growth, frequency) = (of(&found.growth)?, of(&found.frequency)?);
    // (R + i W)^2 + c (R + i W) + alpha^2, c of order eps.
    let product = |x: &[Quotient], y: &[Quotient], n: usize| {
        let pairs = x.iter().take(n + 1).zip(y.iter().take(n + 1).rev());
        pairs.fold(q.integer(0), |sum, (a, b)| q.add(&sum, &q.mul(a, b)))
    };
    let c = q.parameter("c");
    let mut is_root = true;
    for n in 1..=order {
        let earlier = n - 1;
        let real = q.sum(&[
            &product(&growth, &growth, n),
            &q.neg(&product(&frequency, &frequency, n)),
            &q.mul(&c, growth.get(earlier).ok_or(FAILED)?),
        ]);
        let imaginary = q.add(
            &q.mul(&q.integer(2), &product(&growth, &frequency, n)),
            &q.mul(&c, frequency.get(earlier).ok_or(FAILED)?),
        );
        is_root &= q.is_zero(&real) && q.is_zero(&imaginary);
    }
    let second = frequency.get(2).ok_or(FAILED)?;
    let half = q.mul(&q.rational(&Rational::from((-1, 2))), &c);
    let first = growth.get(1).is_some_and(|r| q.equal(r, &half))
        && frequency.get(1).is_some_and(|w| q.is_zero(w));
    let rates = if first { "$R = -c/2$, $alpha_0 = alpha$" } else { "other rates" };
    let roots = if is_root { "are" } else { "are not" };
    Ok(plain(
        "$A = B = 0$",
        "for $A = B = 0$ we get the uncontrolled solution",
        format!("{rates} to $O(eps)$; at order 2 the frequency changes by ${}$", q.print(second)),
        format!(
            "the orders up to {order} {roots} the expansion of the roots of $l^2 + c l + alpha^2$"
        ),
        first && is_root,
        "to $O(eps)$, the order in which the paper works: the frequency is $alpha$ in the place of \
         $sqrt(alpha^2 - c^2/4)$",
    ))
}
