//! Reading reference numbers; comparison to a number of digits.

use lindstedt_algebra::Stop;
use lindstedt_impact::flight::{Clearance, clearance};
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use lindstedt_impact::prediction::uncontrolled_map;
use lindstedt_number::Exact;
use lindstedt_number::ball::Balls;
use lindstedt_number::complex::Complex;
use lindstedt_number::real::{Certified, Real};
use rug::ops::Pow;
use rug::{Float, Rational};
use serde_json::Value;

/// Digits that every field must have.
pub const DIGITS: i32 = 25;
/// Working precision of the certified path.
pub const BITS: u32 = 192;

/// A file of tests/data/vibro-impact.
pub fn data(name: &str) -> Value {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/vibro-impact/");
    let text = std::fs::read_to_string(format!("{folder}{name}.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// An exact decimal.
pub fn decimal(text: &str) -> Rational {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let exponent: i32 = exponent.parse().unwrap();
    let places = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let digits: rug::Integer = mantissa.replace('.', "").parse().unwrap();
    let power = exponent - i32::try_from(places).unwrap();
    Rational::from(digits) * Rational::from(10).pow(power)
}

/// The decimal in a JSON string.
pub fn number(value: &Value) -> Rational {
    decimal(value.as_str().unwrap_or_else(|| panic!("no number: {value}")))
}

pub fn exact(text: &str) -> Exact {
    Exact::from(decimal(text))
}

pub fn parameters(case: &Value) -> ExactParameters {
    let p = &case["params"];
    let of = |name: &str| Exact::from(number(&p[name]));
    ExactParameters {
        alpha: of("alpha"),
        omega: of("omega"),
        periods: u32::try_from(p["k"].as_u64().unwrap()).unwrap(),
        restitution: of("R_r"),
        wall: of("s"),
        damping: of("c"),
        force: of("P0"),
        displacement_gain: of("A"),
        velocity_gain: of("B"),
        branch: if p["branch"].as_i64() == Some(-1) { Branch::Minus } else { Branch::Plus },
    }
}

/// Asserts that a certified number has 25 correct digits of the reference: the radius and the
/// distance are below 10^-25 of it (of 1 for a reference 0).
#[track_caller]
pub fn agrees(what: &str, found: &Certified, reference: &Value) {
    let reference = number(reference);
    let size = if reference.is_zero() { Rational::from(1) } else { reference.clone().abs() };
    let allowed = size * Rational::from(10).pow(-DIGITS);
    assert!(found.is_finite(), "{what}: nothing known, expected {}", reference.to_f64());
    let radius = found.ball().radius().to_rational().unwrap();
    assert!(radius <= allowed, "{what}: radius {:e}", radius.to_f64());
    let middle = found.ball().midpoint().to_rational().unwrap();
    let distance = (middle - &reference).abs();
    assert!(
        distance <= allowed,
        "{what}: {} instead of {}, off by {:e}",
        found.to_f64(),
        reference.to_f64(),
        distance.to_f64()
    );
}

/// As [`agrees`] for a complex number {re, im} or a real one written as a string; each part relative
/// to the modulus.
#[track_caller]
pub fn agrees_complex(what: &str, found: &Complex<Certified>, reference: &Value) {
    let (re, im) = match reference {
        Value::String(_) => (number(reference), Rational::new()),
        _ => (number(&reference["re"]), number(&reference["im"])),
    };
    let size = re.to_f64().hypot(im.to_f64()).max(1e-30);
    for (part, expected) in [(&found.re, re), (&found.im, im)] {
        assert!(part.is_finite(), "{what}: nothing known");
        let radius = part.ball().radius().to_f64();
        let middle = part.ball().midpoint().to_rational().unwrap();
        let distance = (middle - &expected).abs().to_f64();
        let allowed = size * 10.0_f64.powi(-DIGITS);
        assert!(radius <= allowed, "{what}: radius {radius:e}");
        assert!(distance <= allowed, "{what}: off by {distance:e} at {}", expected.to_f64());
    }
}

/// Asserts closeness of doubles relative to the reference.
#[track_caller]
pub fn close(what: &str, found: f64, reference: &Value, tolerance: f64) {
    let expected = number(reference).to_f64();
    let error = (found - expected).abs() / expected.abs().max(f64::MIN_POSITIVE);
    assert!(error <= tolerance, "{what}: {found} instead of {expected}, error {error:e}");
}

/// A certified rational.
pub fn certified(text: &str) -> Certified {
    Certified::from_rational(Balls::new(BITS), &decimal(text))
}

/// A small deterministic generator (SplitMix64) for random cases.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        low + (high - low) * (z >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The value of a float, for messages.
#[allow(dead_code)]
pub fn show(x: &Float) -> f64 {
    x.to_f64()
}

/// Orbits 2, 3 and 5 of the reference numbers, without gains.
pub fn orbit_number(n: usize) -> ExactParameters {
    let (omega, periods, restitution, wall, damping) = match n {
        2 => ("2.6", 2, "0.4", "0.2", "0.05"),
        3 => ("3.3", 1, "0.6", "-0.2", "0.2"),
        _ => ("3.3", 2, "0.8", "0", "0.05"),
    };
    ExactParameters {
        alpha: exact("1"),
        omega: exact(omega),
        periods,
        restitution: exact(restitution),
        wall: exact(wall),
        damping: exact(damping),
        force: exact("1"),
        displacement_gain: exact("0"),
        velocity_gain: exact("0"),
        branch: Branch::Plus,
    }
}

/// An orbit that does not penetrate, its largest multiplier between 0.2 and 3, without gains.
pub fn random_orbit(random: &mut Random) -> Parameters<f64> {
    loop {
        let p = Parameters {
            alpha: 1.0,
            omega: random.between(0.7, 4.5),
            periods: random.between(1.0, 3.999) as u32,
            restitution: random.between(0.3, 0.95),
            wall: random.between(-0.3, 0.3),
            damping: random.between(0.02, 0.2),
            force: 1.0,
            displacement_gain: 0.0,
            velocity_gain: 0.0,
            branch: Branch::Plus,
        };
        let Ok(found) = orbit(&p) else { continue };
        let free = |margin: &Clearance<f64>| margin.margin < 0.0;
        let clear = clearance(&p, &found, &Stop::default()).unwrap().as_ref().is_none_or(free);
        let leading = uncontrolled_map(&p, &found).spectral_radius();
        if clear && (0.2..3.0).contains(&leading) {
            return p;
        }
    }
}
