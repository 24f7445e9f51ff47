//! A function of a trigonometric polynomial, approximated: sampled on a grid, transformed, rounded. Radix 2 with
//! as many bits as are asked for. Nothing here is an enclosure.

use crate::exact::Exact;
use crate::laurent::Laurent;
use crate::operation::Operation;
use lindstedt_algebra::Stop;
use rug::Float;
use rug::float::Constant;

/// Bits beyond those of the result.
const GUARD_BITS: u32 = 24;
/// Points of the least and of the largest grid.
const LEAST: usize = 32;
const MOST: usize = 1 << 15;

type Complex = [Float; 2];

/// The coefficients, over 2^bits, of functions of a trigonometric polynomial, on as many points as resolve
/// them; nothing where a value has none, or once it is stopped.
pub(crate) fn samples_to_modes(
    argument: &Exact,
    bits: u32,
    kind: Operation,
    stop: &Stop,
) -> Option<Vec<Laurent>> {
    let mut points: usize = (4 * (argument.modes.modes() + 1)).next_power_of_two().max(LEAST);
    loop {
        let samples = sampled(argument, bits + GUARD_BITS, points, stop);
        if !kind.takes(samples.iter().map(|p| *p <= 0)) {
            return None;
        }
        let values = samples.iter().map(|p| if stop.asked() { None } else { kind.value(p) });
        let values: Vec<Vec<Float>> = values.collect::<Option<_>>()?;
        let count = values.first().map_or(0, Vec::len);
        let one = |i: usize| modes(values.iter().map(|v| v[i].clone()).collect(), bits, stop);
        let lists: Vec<Laurent> = (0..count).map(one).collect();
        if stop.asked() {
            return None;
        }
        // What was rounded to 0 in the last quarter says that nothing is beyond.
        let resolved = |f: &Laurent| f.modes() < 3 * points / 8;
        if lists.iter().all(resolved) || points >= MOST {
            return Some(lists);
        }
        points *= 2;
    }
}

/// The same in doubles, where no more is worth while, by sums.
pub(crate) fn doubles_to_modes(
    argument: &Exact,
    bits: u32,
    functions: &[Operation],
) -> Option<Vec<Laurent>> {
    let half = argument.doubles(0);
    let points = (4 * half.len()).next_power_of_two().max(LEAST);
    let turn = std::f64::consts::TAU / points as f64;
    let waves: Vec<(f64, f64)> = (0..points).map(|j| (turn * j as f64).sin_cos()).collect();
    let at = |j: usize| -> f64 {
        let term = |(k, c): (usize, &nalgebra::Complex<f64>)| {
            let (sin, cos) = waves[j * k % points];
            if k == 0 { c.re } else { 2.0 * (c.re * cos - c.im * sin) }
        };
        half.iter().enumerate().map(term).sum()
    };
    let samples: Vec<f64> = (0..points).map(at).collect();
    if !functions.iter().all(|f| f.takes(samples.iter().map(|p| *p <= 0.0))) {
        return None;
    }
    let one = |function: &Operation| {
        let values: Vec<f64> = samples.iter().map(|p| function.in_doubles(*p)).collect();
        values.iter().all(|x| x.is_finite()).then(|| {
            let mut f = Laurent::zero(points / 2 - 1);
            for k in 0..points / 2 {
                let (mut re, mut im) = (0.0, 0.0);
                for (j, x) in values.iter().enumerate() {
                    let (sin, cos) = waves[j * k % points];
                    re += x * cos;
                    im -= x * sin;
                }
                let whole = |x: f64| {
                    let scaled = Float::with_val(64, x / points as f64) << bits;
                    scaled.to_integer().unwrap_or_default()
                };
                f.re[k] = whole(re);
                f.im[k] = if k == 0 { rug::Integer::new() } else { whole(im) };
            }
            f
        })
    };
    functions.iter().map(one).collect()
}

fn sampled(argument: &Exact, bits: u32, points: usize, stop: &Stop) -> Vec<Float> {
    let mut list: Vec<Complex> = vec![[Float::new(bits), Float::new(bits)]; points];
    let of = |n: &rug::Integer| Float::with_val(bits, n) * &argument.scale;
    let modes = &argument.modes;
    for (k, (re, im)) in modes.re.iter().zip(&modes.im).enumerate() {
        let (re, im) = (of(re), of(im));
        if k > 0 {
            list[points - k] = [re.clone(), Float::with_val(bits, -&im)];
        }
        list[k] = [re, im];
    }
    transform(&mut list, 1, bits, stop);
    list.into_iter().map(|[re, _]| re).collect()
}

/// c_k, rounded to integers over 2^bits.
fn modes(values: Vec<Float>, bits: u32, stop: &Stop) -> Laurent {
    let (points, precision) = (values.len(), bits + GUARD_BITS);
    let mut list: Vec<Complex> = values
        .into_iter()
        .map(|x| [Float::with_val(precision, x), Float::new(precision)])
        .collect();
    transform(&mut list, -1, precision, stop);
    let mut f = Laurent::zero(points / 2 - 1);
    for (k, [re, im]) in list.into_iter().take(points / 2).enumerate() {
        let whole = |x: Float| ((x / points as u32) << bits).to_integer().unwrap_or_default();
        f.re[k] = whole(re);
        f.im[k] = if k == 0 { rug::Integer::new() } else { whole(im) };
    }
    f.trim();
    f
}

/// sum_j f_j e^(sign 2 pi i j k/n) in place (Cooley, Tukey); broken off when it is stopped.
fn transform(list: &mut [Complex], sign: i32, bits: u32, stop: &Stop) {
    let n = list.len();
    let log = n.trailing_zeros();
    for j in 0..n {
        let mirrored = j.reverse_bits() >> (usize::BITS - log);
        if j < mirrored {
            list.swap(j, mirrored);
        }
    }
    let turn = Float::with_val(bits, Constant::Pi) * 2u32 / n as u32;
    let roots: Vec<Complex> = (0..n / 2)
        .map(|j| {
            let angle = Float::with_val(bits, &turn * j as u32);
            let (sin, cos) = angle.sin_cos(Float::new(bits));
            [cos, sin * sign]
        })
        .collect();
    let mut half = 1;
    while half < n && !stop.asked() {
        let stride = n / (2 * half);
        for block in list.chunks_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (j, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let [c, s] = &roots[j * stride];
                let re = Float::with_val(bits, &b[0] * c - &b[1] * s);
                let im = Float::with_val(bits, &b[0] * s + &b[1] * c);
                *b = [Float::with_val(bits, &a[0] - &re), Float::with_val(bits, &a[1] - &im)];
                a[0] += re;
                a[1] += im;
            }
        }
        half *= 2;
    }
}
