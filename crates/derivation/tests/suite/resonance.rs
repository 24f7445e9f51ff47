//! Slow flows from equations as text: reference numbers, the ways to write a detuning, refusals by name.

use lindstedt_coeff::print::Style;
use lindstedt_derivation::DerivationError;
use lindstedt_derivation::averaging::AveragingSettings;
use lindstedt_derivation::resonance::{Detuned, PolarTerm, ResonanceError, SlowFlow, slow_flow};
use lindstedt_number::Exact;
use lindstedt_phase::amplitudes::AmplitudeTerm;
use lindstedt_problem_file::ProblemFile;
use rug::Rational;
use std::cmp::Ordering;
use std::collections::BTreeMap;

pub type Powers = BTreeMap<String, i32>;
pub type Named = BTreeMap<Powers, [Rational; 2]>;

pub fn found(
    equation: &str,
    order: usize,
    set: &[(&str, &str)],
) -> Result<SlowFlow, DerivationError> {
    let list: Vec<String> = equation.split(';').map(|text| format!("{text:?}")).collect();
    let file = format!("equations = [{}]", list.join(", "));
    let problem = ProblemFile::parse(&file).unwrap().problem;
    let value = |(name, text): &(&str, &str)| ((*name).to_owned(), Exact::parse(text).unwrap());
    let parameters = set.iter().map(value).collect();
    let settings = AveragingSettings { order, parameters, ..AveragingSettings::default() };
    slow_flow(&problem, &settings, Detuned::Beside, &mut |_| true)
}

pub fn flow(equation: &str, order: usize, set: &[(&str, &str)]) -> SlowFlow {
    let found = found(equation, order, set).unwrap();
    assert_eq!(found.checked_orders, Some(order));
    found
}

pub fn refused(equation: &str) -> ResonanceError {
    match found(equation, 2, &[]) {
        Err(DerivationError::Resonance(error)) => error,
        other => panic!("{equation}: {:?}", other.map(|found| found.order)),
    }
}

/// Terms by the names of their factors.
pub fn named(found: &SlowFlow, terms: &[AmplitudeTerm]) -> Named {
    let phases = (1..=found.unknowns()).flat_map(|j| [format!("z{j}"), format!("zbar{j}")]);
    let forces = found.factors()[2 * found.unknowns()..].to_vec();
    let names: Vec<String> = phases.chain(forces).collect();
    let powers = |exponents: &[i32]| {
        let all = names.iter().cloned().zip(exponents.iter().copied());
        all.filter(|(_, n)| *n != 0).collect::<Powers>()
    };
    terms.iter().map(|t| (powers(&t.exponents), [t.re.clone(), t.im.clone()])).collect()
}

/// Orders 1 to 3 of the oscillators of `tests/data/resonance`, where it says where the numbers come from.
#[test]
fn reference_flows() {
    let text = include_str!("../../../../tests/data/resonance/slow-flows.json");
    let data: serde_json::Value = serde_json::from_str(text).unwrap();
    let weak = "x'' + x + eps*(s*x + 2*mu*x' + al*x^3)";
    let cases = [
        ("primary", format!("{weak} = eps*F*cos(t)")),
        ("superharmonic", format!("{weak} = F*cos(t/3)")),
        ("internal_1_2", "x1'' + x1 + eps*2*x1*x2; x2'' + 4*x2 + eps*(s*x2 + x1^2)".to_owned()),
        ("van_der_pol_forced", "x'' + x + eps*(s*x - (1 - x^2)*x') = eps*F*cos(t)".to_owned()),
    ];
    assert_eq!(data["cases"].as_object().unwrap().len(), cases.len());
    let number = |v: &serde_json::Value| v.as_str().unwrap().parse::<Rational>().unwrap();
    for (name, equation) in cases {
        let found = flow(&equation, 3, &[]);
        for (order, unknowns) in data["cases"][name]["orders"].as_object().unwrap() {
            for (j, list) in unknowns.as_array().unwrap().iter().enumerate() {
                let term = |t: &serde_json::Value| {
                    let powers = t["powers"].as_object().unwrap().iter();
                    let powers = powers.map(|(k, n)| (k.clone(), n.as_i64().unwrap() as i32));
                    (powers.collect::<Powers>(), [number(&t["re"]), number(&t["im"])])
                };
                let expected: Named = list.as_array().unwrap().iter().map(term).collect();
                let order: usize = order.parse().unwrap();
                assert_eq!(named(&found, &found.flow[j][order]), expected, "{name} {order}");
            }
        }
    }
}

/// eta' = 1 + eps sigma is the same, written in the force or as a frequency that is a number.
#[test]
fn detunings() {
    let written = flow("x'' + x + eps*x^3 = eps*F*cos((1 + eps*sigma)*t)", 3, &[]);
    let number = flow("x'' + x + eps*x^3 = eps*F*cos(omega*t)", 3, &[("omega", "1.02")]);
    assert_eq!(written.system.forces[0].detuning, number.system.forces[0].detuning);
    assert_eq!(number.system.beside.as_ref().unwrap().rate, Rational::from((51, 50)));
    assert_eq!(written.flow[0], number.flow[0]);
    // The second harmonic of the same phase is detuned twice as much.
    let both = "x'' + x = eps*x^2*cos((1 + eps*sigma)*t) + eps*cos(2*(1 + eps*sigma)*t)";
    assert_eq!(flow(both, 2, &[]).system.force(), 1);
    // A force that is detuned otherwise has a phase of its own.
    let two = flow("x'' + x = eps*cos(t) + eps*cos((1 + eps*sigma)*t)", 1, &[]);
    assert_eq!(named(&two, &two.flow[0][1]), by_hand(&["-1/4 i E_1", "-1/4 i E_2"]));
    // The resonance 2/3 is none of order zero: nothing is detuned.
    let off = flow("x'' + x + eps*x^3 = F*cos(omega*t)", 2, &[("omega", "2/3")]);
    assert_eq!((off.system.force(), off.system.beside), (Rational::from((2, 3)), None));
}

/// A force at the frequency of any unknown is at resonance, beside which it may be near another: in any order of the equations.
#[test]
fn a_force_at_the_resonance_of_the_last() {
    let mut equations = [
        "x'' + x + eps*x^3",
        "y'' + 9*y + eps*x*y",
        "u'' + 49*u + eps*y*u",
        "v'' + 441/400*v + eps*v^3 = eps*F*cos(21/20*t)",
    ];
    for place in [3, 0] {
        let found = flow(&equations.join(";"), 1, &[]);
        assert_eq!((found.system.force(), &found.system.beside), (Rational::from((21, 20)), &None));
        let force = found.flow[place][1].iter().find(|t| t.exponents[8] == 1).unwrap();
        // i F E/(-4 nu), nu = 21/20.
        assert_eq!((force.re.cmp0(), &force.im), (Ordering::Equal, &Rational::from((-5, 21))));
        equations.rotate_right(1);
    }
    // Far from whole: sums of five frequencies count, too.
    let sum = "x'' + x; y'' + 9*y; u'' + 49*u; v'' + 441/400*v; w'' + 121*w = eps*x*y*u*v*w*cos(461/20*t)";
    assert_eq!(flow(sum, 1, &[]).system.beside, None);
}

/// What has no slow flow says why, by name.
#[test]
fn refusals() {
    use ResonanceError::{NoOscillation, NoRatio, NotAForce, NotWeaklyNonlinear, Unset};
    let is = |equation: &str, kind: fn(&ResonanceError) -> bool| {
        let error = refused(equation);
        assert!(kind(&error), "{equation}: {error}");
    };
    is("x'' + 2*x = eps*F*cos(om*t)", |e| matches!(e, NoRatio { .. }));
    is("x'' - x = eps*F*cos(t)", |e| matches!(e, NoOscillation { .. }));
    is("x'' + x + x^3 = eps*cos(t)", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x + x' = eps*cos(t)", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x*(1 + cos(2*t)) = eps*x^2", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + w*x = eps*cos(w*t)", |e| matches!(e, Unset { .. }));
    is("x'' + x + x(t - 1) = eps*cos(t)", |e| matches!(e, NotWeaklyNonlinear { .. }));
    is("x'' + x = eps*cos(t) + eps*cos(t^2)", |e| matches!(e, NotAForce { .. }));
}

/// Terms by hand: `1/4 i h zbar1 E`, without the sign of multiplication.
pub fn by_hand(list: &[&str]) -> Named {
    let term = |text: &&str| {
        let mut words = text.split_whitespace().peekable();
        let number: Rational = words.next().unwrap().parse().unwrap();
        let imaginary = words.next_if_eq(&"i").is_some();
        let parts = [number, Rational::new()];
        let [a, b] = parts;
        let power = |word: &str| match word.split_once('^') {
            Some((name, n)) => (name.to_owned(), n.parse().unwrap()),
            None => (word.to_owned(), 1),
        };
        (words.map(power).collect(), if imaginary { [b, a] } else { [a, b] })
    };
    list.iter().map(term).collect()
}

/// Nayfeh and Mook, Nonlinear Oscillations (1979), chapters 4 to 6, from the equations as they are written.
#[test]
fn first_orders_by_hand() {
    let weak = "x'' + x + eps*(s*x + 2*mu*x' + al*x^3)";
    let common = ["1/2 i s z1", "-1 mu z1", "3/2 i al z1^2 zbar1"];
    let cases: [(String, &[&str]); 4] = [
        (format!("{weak} = eps*F*cos(t)"), &["-1/4 i F E"]),
        (format!("{weak} + eps*h*x*cos(2*t) = 0"), &["1/4 i h zbar1 E"]),
        (format!("{weak} = F*cos(3*t)"), &["-3/32 i al F zbar1^2 E", "3/256 i al F^2 z1"]),
        (format!("{weak} = F*cos(t/3)"), &["729/8192 i al F^3 E^3", "243/256 i al F^2 z1"]),
    ];
    for (equation, more) in cases {
        let found = flow(&equation, 1, &[]);
        let expected = by_hand(&[&common, more].concat());
        assert_eq!(named(&found, &found.flow[0][1]), expected, "{equation}");
    }
    // V = eps (al x^4/4 + be x^3 y) + eps s y^2/2, 1:3.
    let internal = "x'' + x + eps*(al*x^3 + 3*be*x^2*y); y'' + 9*y + eps*(s*y + be*x^3)";
    let found = flow(internal, 2, &[]);
    let first = by_hand(&["3/2 i al z1^2 zbar1", "3/2 i be zbar1^2 z2"]);
    assert_eq!(named(&found, &found.flow[0][1]), first);
    let second = by_hand(&["1/6 i s z2", "1/6 i be z1^3"]);
    assert_eq!(named(&found, &found.flow[1][1]), second);
}

/// Two forces off resonance and at combination resonances, Nayfeh and Mook, section 4.1 (4.1.3 and 4.1.4), with
/// Lambda_j = F_j/(2 (1 - Omega_j^2)) of independent frequencies; om1 with the detuning in the second.
#[test]
fn two_forces() {
    let weak = "x'' + x + eps*(2*mu*x' + al*x^3)";
    let both = |second: &str| format!("{weak} = F*cos(w*t) + G*cos({second})");
    let common = ["-1 mu z1", "3/2 i al z1^2 zbar1"];
    let first = "3/4 i al F^2 z1 (1-w)^-2 (1+w)^-2";
    let cases: [(&str, &[&str]); 3] = [
        // Off resonance: 3 i al (Lambda_1^2 + Lambda_2^2) z.
        ("v*t", &["3/4 i al G^2 z1 (1-v)^-2 (1+v)^-2"]),
        // w + (2 - w): 3 i al Lambda_1 Lambda_2 zbar E_1 E_2.
        (
            "(2 - w + eps*s)*t",
            &[
                "3/4 i al G^2 z1 (1-w)^-2 (3-w)^-2",
                "-3/4 i al F G zbar1 E_1 E_2 (1-w)^-2 (1+w)^-1 (3-w)^-1",
            ],
        ),
        // 2 w + (1 - 2 w): 3/2 i al Lambda_1^2 Lambda_2 E_1^2 E_2.
        (
            "(1 - 2*w + eps*s)*t",
            &["3/64 i al G^2 z1 (1-w)^-2 w^-2", "3/64 i al F^2 G E_1^2 E_2 (1-w)^-3 (1+w)^-2 w^-1"],
        ),
    ];
    for (second, more) in cases {
        let found = flow(&both(second), 1, &[]);
        let spaced = |(mut powers, c): (Powers, [Rational; 2])| {
            let list: Vec<String> = powers.keys().cloned().collect();
            for name in list.into_iter().filter(|name| name.contains('-') || name.contains('+')) {
                let n = powers.remove(&name).unwrap();
                let sign = if name.contains('-') { "-" } else { "+" };
                powers.insert(name.replace(sign, &format!(" {sign} ")), n);
            }
            (powers, c)
        };
        let list = [&common[..], &[first], more].concat();
        let expected: Named = by_hand(&list).into_iter().map(spaced).collect();
        assert_eq!(named(&found, &found.flow[0][1]), expected, "{second}");
    }
}

/// With a number for the independent frequency: what the quotients are at it, orders 1 and 2.
#[test]
fn an_independent_frequency_has_any_value() {
    let equation = "x'' + x + eps*(2*mu*x' + x^2) = F*cos(w*t) + G*cos((1 - w + eps*s)*t)";
    let found = flow(equation, 2, &[]);
    assert_eq!(found.system.independent, ["w"]);
    let number = flow(equation, 2, &[("w", "1/7")]);
    // a + b*w in parentheses.
    let at = |name: &str| -> Option<Rational> {
        let w = Rational::from((1, 7));
        if name == "w" {
            return Some(w);
        }
        let text = name.strip_prefix('(')?.strip_suffix(')')?;
        let (a, rest) = text.split_once(' ').unwrap();
        let (sign, b) = rest.split_once(' ').unwrap();
        let b: Rational = b.strip_suffix("*w").unwrap_or("1").parse().unwrap();
        let b = if sign == "-" { -b } else { b };
        Some(a.parse::<Rational>().unwrap() + b * w)
    };
    for n in 1..=2 {
        let mut sum = Named::new();
        for (mut powers, c) in named(&found, &found.flow[0][n]) {
            let mut factor = Rational::from(1);
            let names: Vec<String> = powers.keys().cloned().collect();
            for (name, q) in names.iter().filter_map(|name| Some((name, at(name)?))) {
                factor *= rug::ops::Pow::pow(q, powers.remove(name).unwrap());
            }
            let entry = sum.entry(powers).or_default();
            c.iter().zip(entry).for_each(|(c, sum)| *sum += Rational::from(c * &factor));
        }
        sum.retain(|_, c| c.iter().any(|part| !part.is_zero()));
        assert!(sum.len() >= 2);
        assert_eq!(sum, named(&number, &number.flow[0][n]), "{n}");
    }
}

/// Polar form of the primary resonance, as books have it: a' = F/2 sin gamma - mu a,
/// a gamma' = sigma a - 3/8 al a^3 + F/2 cos gamma.
#[test]
fn polar_form() {
    let equation = "x'' + x + eps*(2*mu*x' + al*x^3) = eps*F*cos((1 + eps*sigma)*t)";
    let found = flow(equation, 1, &[]);
    assert_eq!(found.system.symbols, ["F", "al", "mu", "sigma"]);
    let polar = found.polar().unwrap();
    let list = |terms: &[PolarTerm]| -> Vec<(u32, u32, bool, Vec<i32>, String)> {
        let one = |t: &PolarTerm| {
            (t.power, t.harmonic, t.sine, t.symbols.clone(), t.coefficient.to_string())
        };
        terms.iter().map(one).collect()
    };
    assert_eq!(polar.slow, Some([1, 1]));
    let half = |sine| (0, 1, sine, vec![1, 0, 0, 0], "1/2".to_owned());
    let amplitude = [half(true), (1, 0, false, vec![0, 0, 1, 0], "-1".to_owned())];
    assert_eq!(list(&polar.amplitude[0]), amplitude);
    let phase = [
        half(false),
        (1, 0, false, vec![0, 0, 0, 1], "1".to_owned()),
        (3, 0, false, vec![0, 1, 0, 0], "-3/8".to_owned()),
    ];
    assert_eq!(list(&polar.phase[0]), phase);
}

/// The edges of Mathieu's first tongues, DLMF 28.6.1 to 28.6.5: y'' + (a - 2 q cos 2t) y = 0 with a = m^2 + s
/// and q = eps. In the frame of the force z' = i (A z + B zbar), and a real or imaginary z stands still
/// where A + B = 0 (y even) or A - B = 0 (y odd).
#[test]
fn edges_of_the_first_tongues() {
    type Series = Vec<Rational>;
    let product = |a: &Series, b: &Series| -> Series {
        let at = |n: usize| (0..=n).map(|k| Rational::from(&a[k] * &b[n - k])).sum();
        (0..a.len()).map(at).collect()
    };
    let odd = |s: Series| s.into_iter().enumerate().map(|(n, c)| if n % 2 == 0 { c } else { -c });
    let read = |list: &[&str]| -> Series { list.iter().map(|q| q.parse().unwrap()).collect() };
    // (a - m^2)/q, order by order.
    let first =
        ["1", "-1/8", "-1/64", "-1/1536", "11/36864", "49/589824", "55/9437184", "-83/35389440"];
    let second = ["0", "5/12", "0", "-763/13824", "0", "1002401/79626240"];
    let below = ["0", "-1/12", "0", "5/13824", "0", "-289/79626240"];
    // b_1(q) = a_1(-q): (b_1 - 1)/q changes sign at even orders.
    let mirrored: Series = odd(read(&first)).map(|c| -c).collect();
    let cases =
        [(1, 1, read(&first)), (1, -1, mirrored), (4, 1, read(&second)), (4, -1, read(&below))];
    for (square, sign, edge) in cases {
        let order = edge.len();
        let found = flow(&format!("x'' + {square}*x + eps*(s*x - 2*x*cos(2*t)) = 0"), order, &[]);
        let mut sum = vec![Rational::new(); order];
        for n in 1..=order {
            for term in &found.flow[0][n] {
                let [z, zbar, _, s] = [0, 1, 2, 3].map(|i| term.exponents[i]);
                assert!(term.re.is_zero() && z + zbar == 1);
                let mut power = vec![Rational::new(); order];
                power[0] = Rational::from(1);
                power = (0..s).fold(power, |power, _| product(&power, &edge));
                for (k, c) in power.iter().enumerate().take(order + 1 - n) {
                    sum[n - 1 + k] += Rational::from(&term.im * c) * if z == 1 { 1 } else { sign };
                }
            }
        }
        assert!(sum.iter().all(Rational::is_zero), "{square} {sign}: {sum:?}");
    }
}

/// What was refused by name of several unknowns; a near miss is one beyond 1/1000.
#[test]
fn refusals_of_several_unknowns() {
    use ResonanceError::{
        Flutter, NearMiss, NoOscillation, NoRationalForm, NotDiagonalisable, UndecidedDivisor,
    };
    // 1 + i and 1 - i; (1 - sqrt 5)/2; of four the double ones above beside complex ones.
    assert_eq!(refused("x'' + x - y; y'' + y + x"), Flutter);
    let NoOscillation { square } = refused("x'' + x - y; y'' - x") else { panic!("no saddle") };
    assert_eq!(square, "-0.618034");
    let both = "x'' + 2*x - y; y'' + y - x; z'' + z - w; w'' + w + z";
    assert_eq!(refused(both), Flutter);
    // Twice the square (3 - sqrt 5)/2: shapes are any of a plane.
    let double = "x'' + 2*x - y + eps*x^3; y'' + y - x; z'' + 2*z - w; w'' + w - z";
    assert_eq!(refused(double), NoRationalForm);
    // nu_1 - nu_2 = 1 is met by the force: nothing decides whether the divisor is zero.
    let met = refused("x'' + 2*x - y + eps*x*cos(t); y'' + y - x");
    let UndecidedDivisor { order: 1, .. } = met else { panic!("{met}") };
    assert_eq!(refused("x'' + x + y; y'' + y + eps*x^3"), NotDiagonalisable);
    assert!(matches!(refused("x'' + y + eps*x^3; y'' + x"), NoOscillation { .. }));
    let near = refused("x'' + x + eps*x*y; y'' + 4.000004000001*y + eps*x^2");
    let NearMiss { order, harmonic, size } = near else { panic!("{near}") };
    assert_eq!((order, &*harmonic), (1, "-nu_1 + nu_2"));
    assert!((size + 2e-6).abs() < 1e-11, "{size}");
}

/// A phase of the only force moves the origin of the time; that of a second one stays, as its cosine and sine.
#[test]
fn phases_of_forces() {
    let [plain, ahead] = ["t", "t + phi"]
        .map(|angle| flow(&format!("x'' + x + eps*x^3 = eps*F*cos({angle})"), 2, &[]));
    assert_eq!(ahead.flow, plain.flow);
    assert_eq!(ahead.print_start(0, Style::Text).as_deref(), Some("phi"));
    let two = flow("x'' + x = eps*F*cos(t) + eps*G*cos(3*t + phi) + eps*H*sin(t + pi/2)", 1, &[]);
    assert_eq!(two.print(&two.flow[0][1], Style::Text), "(-1/4*i*F - 1/4*i*H)*E");
    let two = flow("x'' + x = eps*F*cos(t) + eps*G*cos(t + phi)", 1, &[]);
    let expected = "(-1/4*i*F - 1/4*i*G*cos(phi) + 1/4*G*sin(phi))*E";
    assert_eq!(two.print(&two.flow[0][1], Style::Text), expected);
}

/// Refusals speak of the names that were written, and of the memory that was allowed.
#[test]
fn names_and_memory_of_the_user() {
    let text = "equations = [\"u'' + u + mu*v\", \"v'' + v + u*v\"]\nsmall = \"mu\"";
    let problem = ProblemFile::parse(text).unwrap().problem;
    let refused = |settings: &AveragingSettings, problem| {
        slow_flow(problem, settings, Detuned::Beside, &mut |_| true).unwrap_err().to_string()
    };
    let error = refused(&AveragingSettings::default(), &problem);
    assert!(error.ends_with("there is u*v"), "{error}");
    let text = "equation = \"x'' + x + eps*(s*x + al*x^3) = eps*F*cos(t)\"";
    let forced = ProblemFile::parse(text).unwrap().problem;
    let settings = AveragingSettings { order: 9, memory: 1 << 20, ..AveragingSettings::default() };
    let error = refused(&settings, &forced);
    assert!(
        error.starts_with("order 8 is predicted to need 6.6 MiB, the limit is 1.0 MiB"),
        "{error}"
    );
}

/// Coupled springs 5/2 and 3/2 have the modes 1:2; the energy of the slow flow is kept: a detuning in the
/// second spring moves no amplitude at order one.
#[test]
fn modes_of_coupled_masses() {
    let found = flow("2*x'' + 5*x - 3*y + eps*x^3; 2*y'' + 5*y - 3*x + eps*s*y", 2, &[]);
    let one = |n: i32| Rational::from(n);
    assert_eq!(found.system.frequencies, [1, 2]);
    assert_eq!(found.system.shapes, Some(vec![vec![one(1), one(1)], vec![one(1), one(-1)]]));
    // x'' of the modes: q_1'' = (x'' + y'')/2, so that eps x^3/2 is halved, and s/2.
    let expected = by_hand(&["3/8 i z1^2 zbar1", "3/4 i z1 z2 zbar2", "1/8 i s z1"]);
    assert_eq!(named(&found, &found.flow[0][1]), expected);
}

/// f'(x) of R^4 by differences.
fn jacobian(f: &dyn Fn([f64; 4]) -> [f64; 4], x: [f64; 4]) -> [[f64; 4]; 4] {
    let h = 1e-4;
    let mut rows = [[0.0; 4]; 4];
    for k in 0..4 {
        let moved = |sign: f64| {
            let mut y = x;
            y[k] += sign * h;
            f(y)
        };
        let [above, below] = [moved(1.0), moved(-1.0)];
        for i in 0..4 {
            rows[i][k] = (above[i] - below[i]) / (2.0 * h);
        }
    }
    rows
}

/// Newton's method, the linear equations by elimination.
fn newton(f: &dyn Fn([f64; 4]) -> [f64; 4], mut x: [f64; 4]) -> [f64; 4] {
    for _ in 0..30 {
        let (mut a, mut b) = (jacobian(f, x), f(x));
        for k in 0..4 {
            let size = |i: &usize| a[*i][k].abs();
            let pivot = (k..4).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap();
            a.swap(k, pivot);
            b.swap(k, pivot);
            for i in (0..4).filter(|i| *i != k) {
                let factor = a[i][k] / a[k][k];
                let row = a[k];
                a[i].iter_mut().zip(row).for_each(|(x, y)| *x -= factor * y);
                b[i] -= factor * b[k];
            }
        }
        (0..4).for_each(|k| x[k] -= b[k] / a[k][k]);
    }
    x
}

/// Steady states of the forced van der Pol oscillator with a double eigenvalue zero. At first order the point
/// of Guckenheimer and Holmes, section 2.1: sigma = 1/4, F = 1; at eps = 0.1 the stroboscopic map of the equation
/// has it at (0.2484755, 1.0186359), integrated with 13 digits by a prototype, and the errors fall by order: by eps with
/// the slopes 1.00, 1.99, 3.03, 4.04, 5.09 against order 8.
#[test]
fn the_bogdanov_takens_point_of_locking() {
    let equation = "x'' + x - eps*(1 - x^2)*x' = eps*F*cos((1 + eps*sigma)*t)";
    let found = flow(equation, 8, &[]);
    let power = |z: [f64; 2], n: i32| {
        (0..n).fold([1.0, 0.0], |w: [f64; 2], _| {
            [w[0] * z[0] - w[1] * z[1], w[0] * z[1] + w[1] * z[0]]
        })
    };
    // (sum eps^(n-1) f_n - i sigma w) in the frame of the force.
    let field = |order: usize, eps: f64, [u, v, sigma, force]: [f64; 4]| {
        let mut sum = [sigma * v, -sigma * u];
        for n in 1..=order {
            for t in &found.flow[0][n] {
                let [a, b] = [power([u, v], t.exponents[0]), power([u, -v], t.exponents[1])];
                let w = [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
                let size = eps.powi(n as i32 - 1)
                    * force.powi(t.exponents[3])
                    * sigma.powi(t.exponents[4]);
                let [re, im] = [t.re.to_f64() * size, t.im.to_f64() * size];
                sum[0] += re * w[0] - im * w[1];
                sum[1] += re * w[1] + im * w[0];
            }
        }
        sum
    };
    let point = |order: usize, eps: f64| {
        let conditions = |x: [f64; 4]| {
            let whole = |y: [f64; 4]| {
                let [a, b] = field(order, eps, y);
                [a, b, 0.0, 0.0]
            };
            let [[a, b, ..], [c, d, ..], ..] = jacobian(&whole, x);
            let [re, im] = field(order, eps, x);
            [re, im, a + d, a * d - b * c]
        };
        let [_, _, sigma, force] = newton(&conditions, [0.5, -0.5, 0.25, 1.0]);
        // The same with -x and -F.
        [sigma, force.abs()]
    };
    assert_eq!(found.system.symbols, ["F", "sigma"]);
    let [sigma, force] = point(1, 0.0);
    assert!((sigma - 0.25).abs() < 1e-6 && (force - 1.0).abs() < 1e-6, "{sigma} {force}");
    let errors = [1.9e-2, 2.7e-4, 1.6e-5, 1.3e-6];
    for (order, expected) in (1..).zip(errors) {
        let [sigma, force] = point(order, 0.1);
        let error = (sigma - 0.248_475_5).hypot(force - 1.018_635_9);
        assert!((error / expected - 1.0).abs() < 0.1, "{order}: {error:e}");
    }
    let error = |order: usize, eps: f64| {
        let [[sigma, force], [s, f]] = [point(order, eps), point(8, eps)];
        (sigma - s).hypot(force - f)
    };
    let last = error(5, 0.1);
    assert!((last / 8.4e-8 - 1.0).abs() < 0.1, "{last:e}");
    for (order, expected) in (1..).zip([1.00, 1.99, 3.03, 4.04, 5.09]) {
        let slope = (error(order, 0.1) / error(order, 0.05)).log2();
        assert!((slope - expected).abs() < 0.04, "{order}: {slope}");
    }
}
