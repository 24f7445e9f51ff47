//! (9)-(16): the perturbed flight, the map of one flight and impact, its characteristic equation.

mod printed;

use super::FAILED;
use super::judge::Statement;
use super::orbit::{extended, with_pair};
use super::setting::Setting;
use crate::{Findings, Row, plain};
use lindstedt::Error;
use lindstedt::unstable::coeff::quotient::{Quotient, Quotients};
use lindstedt::unstable::impact::linearised::{ImpactMap, characteristic, coefficient, replace};
use printed::{B, DISPLACEMENT, ELEVEN, THIRD, TWELVE, VELOCITY};
use std::sync::Arc;

/// Symbols of the perturbation in formulas.
const WORDS: [&str; 16] = [
    "R", "alpha0", "omega", "C", "D", "a", "dC", "dD", "dphi", "dtau", "tau", "phi", "dC'", "dD'",
    "dphi'", "R_r",
];

/// In the interior of a flight: functions of tau.
fn in_flight(q: &Quotients) -> Setting {
    let mut setting = Setting::new(q.clone());
    setting = with_pair(setting, "alpha0*tau", "cos(alpha0*tau)", "sin(alpha0*tau)");
    setting = with_pair(setting, "omega*tau + phi", "cos(omega*tau + phi)", "sin(omega*tau + phi)");
    setting = with_exponential(setting, "R*tau", "exp(R*tau)");
    setting.word("R*tau", "R*tau")
}

fn with_exponential(mut setting: Setting, exponent: &str, parameter: &str) -> Setting {
    if let Some(base) = setting.read(exponent) {
        let value = setting.field.parameter(parameter);
        setting.meaning.exponentials.push([base, value]);
    }
    setting
}

/// At the ends of a flight; what is multiplied by a perturbation is taken at dT = 0.
fn at_ends(q: &Quotients) -> Setting {
    let mut setting = Setting::new(q.clone());
    for time in ["2*beta", "(2*pi*k/omega + dT)"] {
        let angle = format!("{time}*alpha0");
        setting = with_pair(setting, &angle, "cos(theta)", "sin(theta)");
        setting = with_exponential(setting, &format!("{time}*R"), "E");
    }
    for angle in ["phi", "(2*pi*k/omega + dT)*omega + phi"] {
        setting = with_pair(setting, angle, "cos(phi)", "sin(phi)");
    }
    setting
}

/// A form with dT for dtau.
fn with_length(q: &Quotients, f: &Quotient) -> Option<Quotient> {
    replace(q, f, &[("dtau", q.parameter("dT"))])
}

/// The same form of the next flight.
fn of_next(q: &Quotients, f: &Quotient) -> Option<Quotient> {
    let names = ["dC", "dD", "dphi"];
    let images = names.map(|name| (name, q.parameter(&format!("{name}'"))));
    replace(q, f, &images)
}

/// (9), (11), (12), (16) and what stands between them.
pub(super) fn statements(map: &ImpactMap) -> Result<Vec<Statement>, Error> {
    let q = extended(map);
    let ends = Arc::new(at_ends(&q).only(&[&WORDS[..], &["beta", "pi", "k", "dT"]].concat()));
    let mut list = vec![perturbed_flight(&q, map)?];
    list.extend(times(&q)?);
    list.extend(variations(&q, map));
    list.extend(end_conditions(&q, map, &ends)?);
    list.extend(eliminated(map, &ends)?);
    list.extend(characteristic_equation(map, &ends)?);
    Ok(list)
}

/// The times below (9).
fn times(q: &Quotients) -> Result<[Statement; 2], Error> {
    let times = Arc::new(Setting::new(q.clone()).only(&["pi", "k", "l", "omega", "dT"]));
    let period = times.read("2*pi*k/omega").ok_or(FAILED)?;
    let length = q.add(&period, &q.parameter("dT"));
    let label = ("$tau$, below (9)", "tau_(l+1) = ");
    Ok([
        Statement::new(label, "2*pi*l/omega + dT", &times, length),
        Statement::new(("$T$, below (9)", "T = "), "2*pi/omega", &times, period),
    ])
}

const BY_DIFFERENTIATION: &str = "formal derivatives of (8) by $C$, $D$, $phi$ and $tau$";

/// The small changes of displacement and velocity in flight.
fn variations(q: &Quotients, map: &ImpactMap) -> [Statement; 2] {
    let flight = Arc::new(in_flight(q).only(&[&WORDS[..], &["R*tau"]].concat()));
    let [dx, dv] = [&map.displacement_variation, &map.velocity_variation].map(Clone::clone);
    let remark = "(11) has both terms right";
    [
        Statement::new(("$dx$", "delta x = "), DISPLACEMENT, &flight, dx)
            .with("", BY_DIFFERENTIATION, ""),
        Statement::new(("$dx'$", "delta x' = "), VELOCITY, &flight, dv)
            .with("", BY_DIFFERENTIATION, remark),
    ]
}

/// (11).
fn end_conditions(
    q: &Quotients,
    map: &ImpactMap,
    ends: &Arc<Setting>,
) -> Result<Vec<Statement>, Error> {
    let start = [&map.start_displacement, &map.start_velocity];
    let end = [&map.end_displacement, &map.end_velocity];
    let [this, next] = [start.map(|f| Some(f.clone())), start.map(|f| of_next(q, f))];
    let derived = [this, next, end.map(|f| with_length(q, f))];
    let lines = ELEVEN.iter().zip(derived.into_iter().flatten());
    let statement = |([label, left, printed, remark], derived): (&[&str; 4], Option<Quotient>)| {
        let found = Statement::new((label, left), printed, ends, derived.ok_or(FAILED)?);
        Ok(found.with("", BY_DIFFERENTIATION, remark))
    };
    lines.map(statement).collect()
}

/// (12).
fn eliminated(map: &ImpactMap, ends: &Arc<Setting>) -> Result<Vec<Statement>, Error> {
    let propagation = propagation(map, ends).ok_or(FAILED)?;
    let statement = |(n, (printed, derived)): (usize, (&str, &Quotient))| {
        let label = format!("(12), {n}");
        let remark = if n == TWELVE.len() { &*propagation } else { "" };
        let independent = "(11) with $omega dT = dphi' - dphi$, $dx'_+ = -R_r dx'_-$";
        Statement::new((&label, "0 = "), printed, ends, derived.clone())
            .with("", independent, remark)
    };
    Ok((1..).zip(TWELVE.into_iter().zip(&map.equations)).map(statement).collect())
}

/// (16).
fn characteristic_equation(map: &ImpactMap, ends: &Arc<Setting>) -> Result<Vec<Statement>, Error> {
    let jacobian = if same_characteristic(map) { "has" } else { "does not have" };
    let independent = format!(
        "the Jacobian of $(phi, x'_+)$ by the implicit function theorem {jacobian} trace \
         $-b_1/b_2$ and determinant $b_0/b_2$"
    );
    let remarks = orbit_values(map).ok_or(FAILED)?;
    let lines = B.iter().zip(map.characteristic.iter().rev()).zip(remarks);
    let statement = |(n, ((printed, derived), remark)): (usize, ((&&str, &Quotient), String))| {
        let (label, left) = (format!("$b_{n}$, (16)"), format!("b_{n} = "));
        Statement::new((&label, &left), printed, ends, derived.clone())
            .with("", &independent, &remark)
    };
    Ok((0..B.len()).rev().zip(lines).map(statement).collect())
}

/// (9), with the amplitude that the paper calls a.
fn perturbed_flight(q: &Quotients, map: &ImpactMap) -> Result<Statement, Error> {
    let p = |name: &str| q.parameter(name);
    let setting = in_flight(q);
    let mut setting = with_pair(setting, "omega*tau + phi + dphi", "cos(theta0)", "sin(theta0)");
    let amplitude = setting.read("P0/(alpha^2 - omega^2)").ok_or(FAILED)?;
    let images = [
        ("C", q.add(&p("C"), &p("dC"))),
        ("D", q.add(&p("D"), &p("dD"))),
        ("cos(omega*tau + phi)", p("cos(theta0)")),
    ];
    // a stands for the amplitude, which is no polynomial.
    let shifted = replace(q, &map.displacement, &images).ok_or(FAILED)?;
    let by_a = coefficient(q, &shifted, "a");
    let rest = replace(q, &shifted, &[("a", q.integer(0))]).ok_or(FAILED)?;
    let derived = q.add(&rest, &q.mul(&by_a, &amplitude));
    setting = setting.only(&[
        "R", "alpha0", "alpha", "omega", "C", "D", "dC", "dD", "dphi", "tau", "phi", "R_tau",
        "R*tau", "P0",
    ]);
    let found = Statement::new(
        ("(9)", "x + delta x = "),
        "exp(R_tau)*[(C + dC)*cos(alpha0*tau) + (D + dD)*sin(alpha0*tau)] \
         + P0/(alpha^2 - omega^2)*cos(omega*tau + phi + dphi)",
        &Arc::new(setting),
        derived,
    );
    Ok(found.with(
        "(8) with $C + dC$, $D + dD$, $phi + dphi$",
        "",
        "the exponent is printed as one symbol with an index; the amplitude is that of (8), which has a \
         row of its own",
    ))
}

/// What the third line of (12) does to the determinant as it is printed.
fn propagation(map: &ImpactMap, ends: &Setting) -> Option<String> {
    let q = &map.field;
    let [first, second, _] = map.equations.clone();
    let printed = ends.read(THIRD)?;
    let found = characteristic(&ends.field, &[first, second, printed])?;
    let names = ["$b_0$", "$b_1$", "$b_2$"];
    let differ: Vec<&str> = names
        .into_iter()
        .zip(found.iter().zip(&map.characteristic))
        .filter(|(_, (a, b))| !q.equal(a, b))
        .map(|(name, _)| name)
        .collect();
    Some(format!(
        "the determinant of (12) as printed would change {}; (16) is the determinant of the \
         corrected lines, the slip did not go further",
        differ.join(" and ")
    ))
}

/// What the coefficients are in terms of the velocities; remarks for b_2, b_1, b_0.
fn orbit_values(map: &ImpactMap) -> Option<[String; 3]> {
    let q = &map.field;
    let p = |name: &str| q.parameter(name);
    let [b0, _, b2] = &map.characteristic;
    let ratio = q.div(&p("alpha0"), &p("omega"))?;
    let of_before = q.equal(b2, &q.neg(&q.mul(&ratio, &map.velocity_before)));
    let factor = q.product(&[&p("R_r"), &p("E"), &p("E"), &ratio]);
    let of_after = q.equal(b0, &q.mul(&factor, &map.velocity_after));
    let say = |holds: bool, text: &str| if holds { text.to_owned() } else { String::new() };
    Some([
        say(
            of_before,
            "with $a$ the amplitude of the flight, $a = F$; $b_2 = -(alpha0/omega) x'_-$",
        ),
        "with $a = F$".to_owned(),
        say(
            of_before && of_after,
            "with $a = F$; $b_0 = R_r (alpha0/omega) e^(4 beta R) x'_+$, so that $b_0/b_2 = \
             R_r^2 e^(4 beta R)$ on the periodic orbit",
        ),
    ])
}

/// Whether the determinant of the equations and the Jacobian have the same roots.
fn same_characteristic(map: &ImpactMap) -> bool {
    let q = &map.field;
    let [b0, b1, b2] = &map.characteristic;
    q.equal(&q.mul(&map.trace, b2), &q.neg(b1)) && q.equal(&q.mul(&map.determinant, b2), b0)
}

/// Whether the equations are linear forms in the perturbations (Euler's relation of degree one)
/// whose coefficients are free of them.
fn is_linear(map: &ImpactMap) -> bool {
    let q = &map.field;
    let names = ["dC", "dD", "dphi", "dC'", "dD'", "dphi'"];
    map.equations.iter().all(|form| {
        let mut sum = q.integer(0);
        for name in names {
            sum = q.add(&sum, &q.mul(&coefficient(q, form, name), &q.parameter(name)));
        }
        q.equal(&sum, form)
    })
}

/// (9)-(16) in the order of the paper.
pub(super) fn rows() -> Result<Vec<Row>, Error> {
    let map = ImpactMap::derive().ok_or(FAILED)?;
    let mut rows = Vec::new();
    for statement in statements(&map)? {
        match statement.label.as_str() {
            "(11), 1" => {
                rows.extend(amplitude_again()?);
                rows.extend(before_eleven(same_characteristic(&map)));
            }
            "$b_2$, (16)" => rows.extend(before_sixteen(&map)),
            _ => {}
        }
        rows.extend(statement.rows());
    }
    Ok(rows)
}

/// The amplitude of (8), which (9) calls a.
fn amplitude_again() -> Result<Vec<Row>, Error> {
    let amplitude = super::orbit::statements()?.into_iter().find(|s| s.label == "(8)");
    let again = |found: Statement| Statement {
        label: "$a$".to_owned(),
        left: "a = ".to_owned(),
        remark: "the amplitude of (8) again: $a$ must be the $F$ of $cos phi$ and $sin phi$"
            .to_owned(),
        ..found
    };
    Ok(amplitude.map_or_else(Vec::new, |found| again(found).rows()))
}

/// The velocity before the impact, and (10); `same`: both characteristic polynomials agree.
fn before_eleven(same: bool) -> [Row; 2] {
    let correction = same.then(|| "$x'_(1-)$".to_owned());
    [
        Row::new(
            "$x_(1-)$",
            "before the impact number 1, the mass possesses the velocity $x_(1-)$",
            "$x_(1-) = s$, the place of the wall; the velocity is $x'_(1-)$",
            "the end conditions of (8) and (10)",
            &Findings { correction, ..Findings::default() },
            "a dot is missing: with $x_- = s$ and $x'_-$ the velocity the map of the impacts \
             follows",
        ),
        plain(
            "(10)",
            "$l$: $tau = 0$, $dtau = 0$, $dx = 0$, $dx'_+ = -R_r dx'_-$; $l+1$: $tau = 2 pi k/omega + \
             dtau$, $dtau = dT$, $dx = 0$, $dx' = dx'_-$",
            "the end conditions of the impact map",
            "the implicit function theorem on $(phi, x'_+) -> (phi', x'_+')$",
            same,
            "both have the same characteristic polynomial, exactly",
        ),
    ]
}

/// (13), (14) and (15).
fn before_sixteen(map: &ImpactMap) -> [Row; 3] {
    [
        phase_sum(),
        plain(
            "(14)",
            "$dC_l = a_1 gamma^l$, $dD_l = a_2 gamma^l$, $dphi_l = a_3 gamma^l$",
            "(12) is linear with constant coefficients",
            "Euler's relation of degree one for each line",
            is_linear(map),
            "turns (12) into a linear system whose determinant must vanish",
        ),
        plain(
            "(15)",
            "$b_2 gamma^2 + b_1 gamma + b_0 = 0$",
            "the determinant of the three lines has degree 2 in $gamma$",
            "the state $(phi, x'_+)$ has two components",
            same_characteristic(map),
            "$b_2$, $b_1$, $b_0$ derived; see (16)",
        ),
    ]
}

/// (13), dphi_l = dphi_0 + sum_(i=1)^l omega dT_i, against dphi_(l+1) = dphi_l + omega dT_l: both
/// written out for the first l; the index of the summand is shifted until they agree.
fn phase_sum() -> Row {
    const LAST: i32 = 6;
    // The indices of dT in dphi_l, by the recursion and by the sum with a shifted index.
    let recursion = |l: i32| -> Vec<i32> { (0..l).collect() };
    let sum = |l: i32, shift: i32| -> Vec<i32> { (1..=l).map(|i| i + shift).collect() };
    let agrees = |shift: i32| (1..=LAST).all(|l| sum(l, shift) == recursion(l));
    let correction = [-1, 1]
        .into_iter()
        .find(|shift| agrees(*shift))
        .map(|shift| format!("the summand is $dT_(i{shift:+})$: the sum runs from 0 to $l - 1$"));
    let findings = Findings { holds: agrees(0), correction, ..Findings::default() };
    Row::new(
        "(13)",
        "$dphi_l = dphi_0 + sum_(i=1)^l omega dT_i$",
        "$dphi_(l+1) = dphi_l + omega dT_l$: the phase at the end of a flight",
        "(12) uses $omega dT_l = dphi_(l+1) - dphi_l$",
        &findings,
        findings.correction.clone().unwrap_or_default(),
    )
}
