//! The Melnikov threshold of the stick-slip oscillator.

use super::support::{Grid, rational};
use lindstedt::Exact;
use lindstedt::unstable::number::ball::Balls;
use lindstedt_melnikov::StickSlip;
use lindstedt_paper::section_three;
use rug::Float;
use rug::float::Constant;

/// gamma_c from the integrals over x = sqrt(2a/b) sech(sqrt(a) t): with v = x' the smooth work
/// int (alpha w - beta w^3) v dt (w = v - v* or so; only even powers of v survive) in the variable
/// s = tanh, where it is a polynomial, the dry work by the turning points of v = v*, the force by
/// the residue int v sin(omega t) dt = sqrt(2/b) pi omega sech(pi omega/(2 sqrt a)).
fn truth(p: &StickSlip, bits: u32) -> Option<Float> {
    let f = |x: &Exact| Float::with_val(bits, x.ball(Balls::new(bits)).midpoint());
    let (a, b, dry, alpha, beta, omega, v) =
        (f(&p.a), f(&p.b), f(&p.dry), f(&p.alpha), f(&p.beta), f(&p.omega), f(&p.belt_speed));
    let root_a = a.clone().sqrt();
    // <v^2> = int v^2 dt = (4/3) a^(3/2)/b, <v^4> = (16/35) a^(7/2)/b^2.
    let v2 = Float::with_val(bits, &a * &root_a) * 4u32 / 3u32 / &b;
    let v4 = a.clone().square() * &a * &root_a * 16u32 / 35u32 / b.clone().square();
    let smooth = Float::with_val(bits, &beta * v4)
        + v2 * (Float::with_val(bits, v.square_ref()) * &beta * 3u32 - &alpha);
    // v = v*: |v| = a sqrt(2/b) sech tanh <= a/sqrt(2b); sech^2 (1 - sech^2) = b v*^2/(2 a^2).
    let level = Float::with_val(bits, v.square_ref()) * &b / a.clone().square() / 2u32;
    let discriminant = Float::with_val(bits, 1) - Float::with_val(bits, &level * 4u32);
    let work = if discriminant > 0 {
        // x(t1), x(t2) at sech^2 = (1 +- sqrt(D))/2.
        let high = (discriminant.clone().sqrt() + 1u32) / 2u32;
        let low = Float::with_val(bits, &level / &high);
        let scale = (Float::with_val(bits, &a * 2u32) / &b).sqrt();
        (high.sqrt() - low.sqrt()) * scale * 2u32 * dry
    } else {
        Float::new(bits)
    };
    let z = Float::with_val(bits, Constant::Pi) * &omega / root_a / 2u32;
    let force = (Float::with_val(bits, 2) / b).sqrt() * Float::with_val(bits, Constant::Pi) * omega;
    let value = (work + smooth) * z.cosh() / force;
    value.is_finite().then_some(value)
}

fn grid_of(precisions: &[u32]) -> Grid {
    let mut grid = Grid::default();
    let values = ["1e-300", "1e-10", "1/3", "1", "10", "1e10", "1e300"];
    let paper = section_three();
    let mut points = vec![paper.clone()];
    for value in values {
        let value = || Exact::Rational(rational(value));
        points.push(StickSlip { a: value(), ..paper.clone() });
        points.push(StickSlip { b: value(), ..paper.clone() });
        points.push(StickSlip { dry: value(), ..paper.clone() });
        points.push(StickSlip { alpha: value(), ..paper.clone() });
        points.push(StickSlip { beta: value(), ..paper.clone() });
        points.push(StickSlip { omega: value(), ..paper.clone() });
        points.push(StickSlip { belt_speed: value(), ..paper.clone() });
        points.push(StickSlip {
            a: value(),
            b: value(),
            belt_speed: Exact::from(0),
            ..paper.clone()
        });
    }
    for p in points {
        for &bits in precisions {
            let label = format!("{p:?} at {bits} bits");
            grid.cell(&label, |grid| {
                let Some(found) = p.signed_threshold(Balls::new(bits)) else {
                    return grid.refused(&"Undefined");
                };
                match truth(&p, 3 * bits + 8000) {
                    Some(truth) => grid.certified(&label, &found, &truth, 2 * bits),
                    None if found.is_finite() => grid.defect(&label, format!("{found:?}")),
                    None => grid.refused(&"Overflow"),
                }
            });
        }
    }
    grid
}

#[test]
fn thresholds() {
    grid_of(&[2, 3, 10, 53, 64, 100, 1_000]).finish("thresholds", 8);
}

#[test]
#[ignore = "minutes"]
fn thresholds_at_many_bits() {
    grid_of(&[10_000, 100_000]).finish("thresholds", 70);
}
