//! (1)-(4): the equation of motion, by substitution in the engine's equation.

use super::FAILED;
use super::formula::Tree;
use super::judge::{Printed, Statement};
use super::setting::Setting;
use lindstedt::Error;
use lindstedt::unstable::coeff::quotient::{Quotient, Quotients};
use lindstedt_equation::{Expression, Function};
use lindstedt_problems::vibro_impact;
use std::sync::Arc;

/// Displacements x and z, delayed ones with T; the time t occurs in angles only.
const NAMES: &str = "alpha|omega|c|P0|A|B|T|eps|t|x|x'|x''|xT|xT'|z|z'|z''|zT|zT'|cos(omega*t)|sin(omega*t)|\
     cos(omega*(t - T))|sin(omega*(t - T))|m|c_1|k_1|k_2|a_1|b_1|y_0|p|R_r";

/// The words of (1)-(4).
fn setting() -> Setting {
    let pairs = [("cos(omega*t)", "sin(omega*t)"), ("cos(omega*(t - T))", "sin(omega*(t - T))")];
    let plain = Setting::new(Quotients::new(&NAMES.split('|').collect::<Vec<_>>(), &pairs));
    let value = |name: &str| plain.field.parameter(name);
    let [late_cos, late_sin] = [value(pairs[1].0), value(pairs[1].1)];
    let [cos, sin] = [value(pairs[0].0), value(pairs[0].1)];
    let mut setting = plain;
    for (angle, cos, sin) in [("omega*t", cos, sin), ("omega*(t - T)", late_cos, late_sin)] {
        if let Some(angle) = setting.read(angle) {
            setting.meaning.angles.push([angle, cos, sin]);
        }
    }
    setting
}

/// The engine's expression as a formula in the words above.
fn formula(expression: &Expression) -> Option<Tree> {
    let symbol = |name: &str| Some(Tree::Symbol(name.to_owned()));
    let all = |list: &[Expression]| list.iter().map(formula).collect::<Option<Vec<_>>>();
    match expression {
        Expression::Number(q) => Some(Tree::Number(q.clone())),
        Expression::Parameter(name) => symbol(name),
        Expression::Small => symbol("eps"),
        Expression::Time => symbol("t"),
        Expression::Unknown(unknown) => {
            let late = if unknown.delay.is_some() { "T" } else { "" };
            symbol(&format!("x{late}{}", "'".repeat(unknown.derivative as usize)))
        }
        Expression::Sum(list) => Some(Tree::Sum(all(list)?)),
        Expression::Product(list) => Some(Tree::Product(all(list)?)),
        Expression::Power(base, exponent) => {
            let Expression::Number(n) = &**exponent else { return None };
            let n = n.is_integer().then(|| n.numer().to_i32()).flatten()?;
            Some(Tree::Power(Box::new(formula(base)?), n))
        }
        Expression::Function(Function::Cos, inner) => {
            Some(Tree::Apply("cos".to_owned(), Box::new(formula(inner)?)))
        }
        _ => None,
    }
}

/// What (1)-(4) must be.
struct Derived {
    /// Left side less right side, with eps.
    equation: Quotient,
    /// The same with eps = 1.
    unscaled: Quotient,
    /// The same from the masses and springs, times 1/m.
    mechanical: Quotient,
    /// eps f: z'' + alpha^2 z on the motion.
    f: Quotient,
    /// P0/(alpha^2 - omega^2), by the response to the force at order zero.
    response: Quotient,
}

fn derive(setting: &Setting) -> Option<Derived> {
    let q = &setting.field;
    let equation = formula(&vibro_impact::problem().equation)?;
    let unscaled = setting.clone().means("eps", q.integer(1)).value(&equation)?;
    // The base moves as y_0 cos(omega t) and by the loop, the spring k_2 hangs on it.
    let newton = "(m*x'' + c_1*x' + k_1*x \
                  - k_2*(y_0*cos(omega*t) + a_1*(x - xT) + b_1*(x' - xT') - x))/m";
    let mechanical = setting.read(newton)?;
    // z = p cos(omega t) satisfies the equation for eps = 0, z = 0: linear in p.
    let (free, slope) = ("-omega^2*p*cos(omega*t)", "-p*omega*sin(omega*t)");
    let alone = setting
        .clone()
        .word("x", "p*cos(omega*t)")
        .word("x'", slope)
        .word("x''", free)
        .means("eps", q.integer(0))
        .value(&equation)?;
    let by_p = lindstedt::unstable::impact::linearised::coefficient(q, &alone, "p");
    let constant =
        lindstedt::unstable::impact::linearised::replace(q, &alone, &[("p", q.integer(0))])?;
    let response = q.neg(&q.div(&constant, &by_p)?);
    // z'' + alpha^2 z less the equation with x = z + p cos(omega t).
    let shifted = setting
        .clone()
        .means("p", response.clone())
        .word("x", "z + p*cos(omega*t)")
        .word("x'", "z' - p*omega*sin(omega*t)")
        .word("x''", "z'' - p*omega^2*cos(omega*t)")
        .word("xT", "zT + p*cos(omega*(t - T))")
        .word("xT'", "zT' - p*omega*sin(omega*(t - T))");
    let f = q.sub(&shifted.read("z'' + alpha^2*z")?, &shifted.value(&equation)?);
    Some(Derived { equation: setting.value(&equation)?, unscaled, mechanical, f, response })
}

/// Whether the averaged expansion has the response of (3) at order zero.
fn response_is_averaged() -> Result<bool, Error> {
    let found = super::averaged::averaged(1)?;
    let q = &found.setting.field;
    let printed = found.setting.read("P0/(alpha^2 - omega^2)").ok_or(FAILED)?;
    let first = found.response.first().ok_or(FAILED)?;
    Ok(q.equal(&first[0], &printed) && q.is_zero(&first[1]))
}

const BY_SUBSTITUTION: &str = "exact, as polynomials in $x$, $x'$, $x(t-T)$, $x'(t-T)$";

/// (1)-(4) as printed.
const PRINTED: [Printed; 5] = [
    Printed::new("(1)", "", "x'' + c*x' + alpha^2*x = P0*cos(omega*t) + A*[x - xT] + B*[x' - xT']")
        .with(
            "the engine's equation with $eps = 1$; $x' -> -R_r x'$ at $x = s$",
            BY_SUBSTITUTION,
            "$xT$, $xT'$ stand for $x$, $x'$ at $t - T$",
        ),
    Printed::new(
        "parameters of (1)",
        "$P0 = y_0 k_2/m$, $c = c_1/m$, $alpha^2 = (k_1 + k_2)/m$, $A = k_2 a_1/m$, \
         $B = k_2 b_1/m$: ",
        "x'' + c*x' + (k_1 + k_2)/m*x = P0*cos(omega*t) + A*[x - xT] + B*[x' - xT']",
    )
    .with(
        "$m x'' + c_1 x' + k_1 x = k_2 (y_0 cos(omega t) + a_1 (x - xT) + b_1 (x' - xT') - x)$, \
         over $m$",
        "Newton's law, the loop moving the base of the spring $k_2$",
        "",
    ),
    Printed::new(
        "(2)",
        "",
        "x'' + alpha^2*x = P0*cos(omega*t) + eps*A*[x - xT] + eps*B*[(1 - c/B)*x' - xT']",
    )
    .with(
        "the engine's equation",
        BY_SUBSTITUTION,
        "dividing by $B$ is cosmetic: $B x' - c x'$ holds for $B = 0$ too",
    ),
    Printed::new("(3)", "x = ", "z + P0/(alpha^2 - omega^2)*cos(omega*t)").with(
        "$z + P0/((alpha - omega)*(alpha + omega)) cos(omega t)$, the response at $eps = 0$",
        "order zero of the averaged expansion: the same",
        "the response without damping, which is of order $eps$; in (8), beside $F$, the same amplitude is wrong",
    ),
    Printed::new(
        "$f$, (4)",
        "eps f = ",
        "eps*A*[z + P0/(alpha^2 - omega^2)*cos(omega*t) - zT \
         - P0/(alpha^2 - omega^2)*cos(omega*(t - T))] \
         + eps*B*[(1 - c/B*(z' - P0*omega/(alpha^2 - omega^2)*sin(omega*t)) - zT' \
         + P0*omega/(alpha^2 - omega^2)*sin(omega*(t - T))]",
    )
    .with(
        "$eps A [x - xT] + eps [(B - c) x' - B xT']$ with $x$ of (3)",
        "(3) substituted in (2), exactly",
        "$z'' + alpha^2 z = eps f$ itself holds by construction",
    ),
];

/// (1)-(4) beside what is derived.
pub(super) fn statements() -> Result<Vec<Statement>, Error> {
    let setting = setting();
    let derived = derive(&setting).ok_or(FAILED)?;
    let q = &setting.field;
    let words = ["alpha", "omega", "c", "P0", "A", "B", "T", "eps", "t"];
    let with = |more: &[&str]| Arc::new(setting.clone().only(&[&words[..], more].concat()));
    let x = with(&["x", "x'", "x''", "xT", "xT'"]);
    let z = with(&["z", "z'", "z''", "zT", "zT'"]);
    let defined = setting
        .clone()
        .word("P0", "y_0*k_2/m")
        .word("c", "c_1/m")
        .word("omega_0^2", "(k_1 + k_2)/m")
        .word("A", "k_2*a_1/m")
        .word("B", "k_2*b_1/m");
    let amplitude = q.mul(&derived.response, &q.parameter("cos(omega*t)"));
    let truth = [
        (&x, derived.unscaled),
        (&Arc::new(defined), derived.mechanical),
        (&x, derived.equation),
        (&z, q.add(&q.parameter("z"), &amplitude)),
        (&z, derived.f),
    ];
    let pairs = PRINTED.iter().zip(truth);
    let mut list: Vec<_> = pairs.map(|(line, (words, value))| line.against(words, value)).collect();
    if !response_is_averaged()? {
        list[3].independent = "order zero of the averaged expansion: another".to_owned();
    }
    Ok(list)
}
