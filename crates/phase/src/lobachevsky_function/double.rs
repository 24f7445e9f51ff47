//! L(x) in double precision.
//!
//! After x = n pi + t, L(x) = n pi ln 2 + L(t), and L(|t|) is evaluated by
//!
//! * 0 <= t <= 0.6: sum_k a_k t^(2k+1), all a_k > 0;
//! * 0.6 < t <= 1.32: a Taylor polynomial around one of six centres;
//! * t > 1.32: (pi/2) ln 2 - y (1 - ln y + sum_k b_k y^(2k)), y = pi/2 - t.
//!
//! The first two avoid the cancellation that the third has for larger y, where L is small.
//! The truncation errors are below 2^-58 relative to L. The rounding errors are measured by a
//! test against the certified function: at most 2.8 ulp, see `worst_error_in_ulps`.

use super::{Point, lobachevsky};
use lindstedt_number::ball::Balls;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2};

/// Below this |x| the three-part reduction modulo pi is exact to about 2^-100.
const FAST_LIMIT: f64 = 3.0e6;
/// Precision of the certified fall-back: 53 bits, rounded once more.
const FALL_BACK_BITS: u32 = 80;

/// 1.5 2^52.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// pi in three parts; the first two have 33 bits, so their products with n < 2^20 are exact.
const PI_PARTS: [f64; 3] = [3.1415926534682512, 1.2154201012607932e-10, 4.044532497591901e-21];
/// pi ln 2 in two parts, the first of 32 bits.
const PERIOD_PARTS: [f64; 2] = [2.1775860898196697, 4.839324069899467e-10];
/// (pi/2) ln 2 in two parts.
const HALF_PERIOD_PARTS: [f64; 2] = [1.088793045151801, -2.1339326836645974e-17];
/// pi/2 - FRAC_PI_2.
const FRAC_PI_2_LOW: f64 = 6.123233995736766e-17;

/// The Lobachevsky function L(x) = -int_0^x ln|cos t| dt in double precision.
///
/// Domain: every f64; NaN for NaN and infinities. Error: at most 4 ulp (2.8 measured) for
/// |L(x)| >= 2^-1022; results below that underflow gradually. Cost: some 12 ns; beyond
/// |x| = 3e6 the certified function is used, which takes some 100 us.
///
/// ```
/// use lindstedt_phase::lobachevsky_function::lobachevsky_f64;
///
/// assert!((lobachevsky_f64(1.0) - 0.18753816902083824).abs() < 1e-16);
/// ```
#[must_use]
pub fn lobachevsky_f64(x: f64) -> f64 {
    if !x.is_finite() {
        return f64::NAN;
    }
    let size = x.abs();
    if size > FAST_LIMIT {
        return fall_back(x);
    }
    let value = if size <= FRAC_PI_2 { on_quarter(size, 0.0) } else { beyond_quarter(size) };
    value.copysign(x)
}

/// The certified function, rounded; beyond the fast reduction nothing is silently wrong.
fn fall_back(x: f64) -> f64 {
    let balls = Balls::new(FALL_BACK_BITS);
    Point::from_f64(x).map_or(f64::NAN, |x| lobachevsky(&x, balls).midpoint().to_f64())
}

/// L(x) for pi/2 < x <= FAST_LIMIT.
fn beyond_quarter(x: f64) -> f64 {
    let [pi_1, pi_2, pi_3] = PI_PARTS;
    // To the nearest integer without a call: added to 1.5 2^52, a double has no room for more.
    let turns = (x * FRAC_1_PI + ROUNDING) - ROUNDING;
    // x - n pi_1 is exact (Sterbenz), the error of the next difference is recovered (Knuth's
    // two-sum): near pi/2 + n pi the slope of L is as large as 37.
    let first = x - turns * pi_1;
    let subtrahend = turns * pi_2;
    let offset = first - subtrahend;
    let restored = first - offset;
    let mut low = (restored - subtrahend) + (first - (offset + restored));
    low -= turns * pi_3;
    let quarter = on_quarter(offset.abs(), low * offset.signum());
    let [period_1, period_2] = PERIOD_PARTS;
    turns * period_1 + (turns * period_2 + quarter.copysign(offset))
}

/// L(t + low) for 0 <= t <= pi/2 up to rounding, low a correction below an ulp of t.
fn on_quarter(t: f64, low: f64) -> f64 {
    if t <= 0.6 {
        // t^2 first and t last: the product underflows only where L does.
        let square = t * t;
        return t * (square * polynomial(&FROM_ZERO, square));
    }
    // Counted, not searched: no branch to be guessed.
    let index: usize = PANELS.iter().map(|panel| usize::from(t > panel.end)).sum();
    if let Some(panel) = PANELS.get(index) {
        let distance = (t - panel.centre) + low;
        return panel.high + (panel.low + distance * polynomial(&panel.taylor, distance));
    }
    let [half_1, half_2] = HALF_PERIOD_PARTS;
    let complement = (FRAC_PI_2 - t) + (FRAC_PI_2_LOW - low);
    if complement == 0.0 {
        return half_1;
    }
    // The rounded quotient x / pi may put t a little beyond pi/2; the subtrahend is odd in y.
    let square = complement * complement;
    let bracket = 1.0 - complement.abs().ln() + square * polynomial(&FROM_POLE, square);
    (half_1 - complement * bracket) + half_2
}

/// c_0 + c_1 z + c_2 z^2 + ..., a multiple of four coefficients: every fourth power by itself, four short chains that
/// the processor works at together, two in one instruction.
#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], z: f64) -> f64 {
    let square = z * z;
    let fourth = square * square;
    let (rows, _) = coefficients.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for row in rows.iter().rev() {
        sums = std::array::from_fn(|k| sums[k] * fourth + row[k]);
    }
    (sums[0] + z * sums[1]) + square * (sums[2] + z * sums[3])
}

/// L(centre + d) = high + low + sum_k taylor[k] d^(k+1), for arguments up to `end`.
struct Panel {
    end: f64,
    centre: f64,
    high: f64,
    low: f64,
    taylor: [f64; 16],
}

// The tables below were computed with mpmath 1.3.0 at 80 digits and rounded to f64; the test
// `tables_are_correctly_rounded` recomputes every entry with balls.

/// a_k = (1 - 4^-k) zeta(2k) / (k (2k+1)) (2/pi)^(2k), k = 1, 2, ...
#[rustfmt::skip]
const FROM_ZERO: [f64; 20] = [
    0.16666666666666666, 0.016666666666666666, 0.0031746031746031746, 0.0007495590828924162,
    0.00019881353214686547, 5.6815612371167925e-05, 1.71053716027261e-05, 5.352332305335729e-06,
    1.7252264355134092e-06, 5.693550339132201e-07, 1.9153237069030535e-07, 6.546387313886139e-08,
    2.2676502947762058e-08, 7.94543006854117e-09, 2.8115818831083384e-09, 1.0035291969796074e-09,
    3.6091689733393327e-10, 1.306803225493367e-10, 4.760213863968265e-11, 1.7433760136007645e-11,
];
/// b_k = zeta(2k) / (k (2k+1) pi^(2k)), k = 1, 2, ...
#[rustfmt::skip]
const FROM_POLE: [f64; 8] = [
    0.05555555555555555, 0.0011111111111111111, 5.039052658100277e-05, 2.9394473838918285e-06,
    1.9434362868706303e-07, 1.3874386415425623e-08, 1.0440927548511323e-09,
    8.167135584551352e-11,
];
/// L^(k+1)(centre) / (k+1)!.
#[rustfmt::skip]
const PANELS: [Panel; 6] = [
    Panel {
        end: 0.78,
        centre: 0.6875,
        high: 0.05697827890079422,
        low: -3.1188204109332696e-18,
        taylor: [
            0.25768977692963657, 0.41057090079494707, 0.2790456430530495, 0.1145680210311958,
            0.08435051902179194, 0.06145156090722402, 0.050318005767502165, 0.04250771845531066,
            0.03750218124755779, 0.03393962896590817, 0.03144702622451433, 0.02966478386678068,
            0.02841867870750758, 0.027576739583366403, 0.027057745992575787, 0.026803534006748075,
        ],
    },
    Panel {
        end: 0.935,
        centre: 0.859375,
        high: 0.11492868383583407,
        low: 2.6209765440484573e-18,
        taylor: [
            0.4263144648065458, 0.5800443325461005, 0.39096761847923417, 0.22677855130792585,
            0.19694669796293637, 0.18255422813048328, 0.18377332682813552, 0.19357388222208932,
            0.2116783838952184, 0.2380174595841394, 0.27374143587600425, 0.32064893546859935,
            0.38137569484368045, 0.4594932321657305, 0.5597632689526424, 0.6884708405091894,
        ],
    },
    Panel {
        end: 1.065,
        centre: 1.0,
        high: 0.18753816902083825,
        low: -1.185224690033397e-17,
        taylor: [
            0.6156264703860143, 0.7787038623274511, 0.5709198034691266, 0.44457745604063825,
            0.4725249988939818, 0.5498863830521094, 0.6885287695045893, 0.9045510506837329,
            1.232596279236402, 1.727533248043792, 2.476257180436686, 3.615207046914176,
            5.359217364486903, 8.047730139366791, 12.219243806783865, 18.73144205690544,
        ],
    },
    Panel {
        end: 1.17,
        centre: 1.1171875,
        high: 0.2713905206696359,
        low: 1.0557628616920733e-17,
        taylor: [
            0.8250518917463711, 1.0256120433399936, 0.8679200422960244, 0.8901492480349591,
            1.1823293512152342, 1.7355015288056013, 2.7332141547084308, 4.5189758243741975,
            7.748467976902586, 13.66545113452348, 24.648605510494228, 45.28241716323148,
            84.46901673804454, 159.61332766009326, 304.9578017043324, 588.2559172666766,
        ],
    },
    Panel {
        end: 1.255,
        centre: 1.2109375,
        high: 0.3585471566699246,
        low: -7.755886285145304e-19,
        taylor: [
            1.0437204740269272, 1.3289330209686379, 1.3440419828138868, 1.7861417725295365,
            2.982799536256534, 5.523406634552269, 10.96378056507249, 22.850023091693483,
            49.38672927827335, 109.79133073462118, 249.62364360548324, 578.0591920564522,
            1359.2191502081073, 3237.5056525328087, 7797.052686449592, 18958.604298815615,
        ],
    },
    Panel {
        end: 1.32,
        centre: 1.2890625,
        high: 0.44891658020651737,
        low: -1.5298410255128997e-17,
        taylor: [
            1.2800567006096832, 1.7275187651788007, 2.1562140560299254, 3.7249002435339897,
            7.937423488551855, 18.779384063996943, 47.61209414145436, 126.74737817843982,
            349.9093549608543, 993.5884656609101, 2885.475369638525, 8534.87433556782,
            25633.474076215538, 77986.90508029769, 239902.50598768803, 745081.6081522357,
        ],
    },
];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

    use super::super::log_cosine;
    use super::*;
    use lindstedt_number::ball::Ball;
    use rug::Float;

    fn point(x: f64) -> Point {
        Point::from_f64(x).unwrap()
    }

    /// The distance of `value` from L(x) in units of the last place of L(x).
    fn error_in_ulps(x: f64, value: f64) -> f64 {
        let truth = lobachevsky(&point(x), Balls::new(130));
        let ulp = Float::with_val(53, Float::i_exp(1, truth.midpoint().get_exp().unwrap() - 53));
        let difference = Float::with_val(53, truth.midpoint() - Float::with_val(53, value));
        (difference / ulp).to_f64().abs()
    }

    #[test]
    fn tables_are_correctly_rounded() {
        let balls = Balls::new(200);
        let nearest = |ball: &Ball| ball.midpoint().to_f64();
        let even_zeta = |k: u32, scale: &Ball| {
            let zeta = balls.zeta(2 * k).unwrap();
            let power = balls.powi(scale, 2 * i64::from(k)).unwrap();
            balls.div_i64(&balls.mul(&zeta, &power), i64::from(k * (2 * k + 1))).unwrap()
        };
        let inverse_pi = balls.div(&balls.one(), &balls.pi()).unwrap();
        for (k, entry) in (1..).zip(FROM_POLE) {
            assert_eq!(nearest(&even_zeta(k, &inverse_pi)), entry);
        }
        for (k, entry) in (1..).zip(FROM_ZERO) {
            let full = even_zeta(k, &balls.mul_i64(&inverse_pi, 2));
            let even = balls.mul_power_of_two(&full, -2 * k as i32);
            assert_eq!(nearest(&balls.sub(&full, &even)), entry);
        }
        for panel in &PANELS {
            let centre = point(panel.centre);
            let value = lobachevsky(&centre, balls);
            assert_eq!(nearest(&value), panel.high);
            let low = balls.sub(&value, &balls.from_f64(panel.high).unwrap());
            assert_eq!(nearest(&low), panel.low);
            // tan' = 1 + tan^2: (k+1) tau_(k+1) = [k = 0] + sum_i tau_i tau_(k-i); l' = tan, L' = l.
            let mut tangent = vec![balls.tan(&balls.from_f64(panel.centre).unwrap()).unwrap()];
            let mut log = vec![balls.neg(&log_cosine(&centre, balls).unwrap())];
            for k in 0..panel.taylor.len() {
                let start = if k == 0 { balls.one() } else { balls.zero() };
                let square = (0..=k).fold(start, |sum, i| {
                    balls.add(&sum, &balls.mul(&tangent[i], &tangent[k - i]))
                });
                let order = k as i64 + 1;
                log.push(balls.div_i64(&tangent[k], order).unwrap());
                tangent.push(balls.div_i64(&square, order).unwrap());
                assert_eq!(nearest(&balls.div_i64(&log[k], order).unwrap()), panel.taylor[k]);
            }
        }
    }

    #[test]
    fn parts_of_constants() {
        let balls = Balls::new(200);
        let remainder = |start: Ball, parts: &[f64]| {
            let subtract =
                |rest: Ball, part: &f64| balls.sub(&rest, &balls.from_f64(*part).unwrap());
            parts.iter().fold(start, subtract).midpoint().to_f64().abs()
        };
        let period = balls.mul(&balls.pi(), &balls.ln_2());
        let half = |ball: &Ball| balls.mul_power_of_two(ball, -1);
        assert!(remainder(balls.pi(), &PI_PARTS) < 1e-36);
        assert!(remainder(period.clone(), &PERIOD_PARTS) < 1e-25);
        assert!(remainder(half(&period), &HALF_PERIOD_PARTS) < 1e-32);
        assert!(remainder(half(&balls.pi()), &[FRAC_PI_2, FRAC_PI_2_LOW]) < 1e-32);
        let trailing = |x: f64| x.to_bits().trailing_zeros();
        assert!(trailing(PI_PARTS[0]) >= 20 && trailing(PI_PARTS[1]) >= 20);
        assert!(trailing(PERIOD_PARTS[0]) >= 21);
    }

    #[test]
    fn worst_error_in_ulps() {
        let mut state = 3_u64;
        let mut random = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut arguments = vec![
            0.6, 0.78, 0.935, 1.065, 1.17, 1.255, 1.32, 0.6875, 1.0, 1.2109375, 3.0e6, 2999999.5,
        ];
        for n in 1..2000 {
            // The multiples of pi/2, their neighbours, and distances 10^-16 ... 1 from them.
            let near = f64::from(n) * FRAC_PI_2;
            arguments.extend([near, near.next_up(), near.next_down()]);
            arguments.push(near - 10f64.powf(-17.0 * random()));
        }
        for _ in 0..6000 {
            arguments.push(FRAC_PI_2 * random());
            arguments.push(10.0 * random());
            arguments.push(1e6 * random());
            arguments.push(10f64.powf(-102.0 * random()));
        }
        for _ in 0..50 {
            arguments.push(10f64.powf(6.0 + 300.0 * random()));
        }
        let mut worst = (0.0, 0.0);
        for x in arguments {
            let error = error_in_ulps(x, lobachevsky_f64(x));
            if error > worst.1 {
                worst = (x, error);
            }
            assert_eq!(lobachevsky_f64(-x), -lobachevsky_f64(x));
        }
        println!("worst error {} ulp at {:?}", worst.1, worst.0);
        assert!(worst.1 < 4.0, "{} ulp at {:?}", worst.1, worst.0);
    }

    #[test]
    fn special_arguments() {
        assert!(lobachevsky_f64(f64::NAN).is_nan());
        assert!(
            lobachevsky_f64(f64::INFINITY).is_nan() && lobachevsky_f64(f64::NEG_INFINITY).is_nan()
        );
        assert_eq!(lobachevsky_f64(0.0).to_bits(), 0.0_f64.to_bits());
        assert_eq!(lobachevsky_f64(-0.0).to_bits(), (-0.0_f64).to_bits());
        assert_eq!(lobachevsky_f64(1e-300), 0.0);
        assert!(error_in_ulps(f64::MAX, lobachevsky_f64(f64::MAX)) <= 0.5);
        assert!(error_in_ulps(1e22, lobachevsky_f64(1e22)) <= 0.5);
    }
}
