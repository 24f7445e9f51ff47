//! L(x) in double precision.
//!
//! After x = n pi + t, L(x) = n pi ln 2 + L(t), and L(|t|) is evaluated by
//!
//! * 0 <= t < 19/32: sum_k a_k t^(2k+1), all a_k > 0;
//! * 19/32 <= t < 42/32: a Taylor polynomial around the centre of one of 23 panels, found without a search;
//! * t >= 42/32: (pi/2) ln 2 - y (1 - ln y + sum_k b_k y^(2k)), y = pi/2 - t.
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
/// |L(x)| >= 2^-1022; results below that underflow gradually. Cost: 7 ns below 0.6, 10 to 12 ns up to
/// pi/2, 12 to 17 ns from there on; beyond |x| = 3e6 the certified function is used, which takes some 100 us.
///
/// ```
/// use lindstedt_phase::lobachevsky_function::lobachevsky_f64;
///
/// assert!((lobachevsky_f64(1.0) - 0.18753816902083824).abs() < 1e-16);
/// ```
#[must_use]
pub fn lobachevsky_f64(x: f64) -> f64 {
    let size = x.abs();
    if size <= FAST_LIMIT { fast(size).copysign(x) } else { fall_back(x) }
}

/// L(x) for 0 <= x <= FAST_LIMIT.
#[inline(always)]
fn fast(size: f64) -> f64 {
    // One call for both, so that what follows is compiled once and in place.
    let (turns, offset, low) = if size <= FRAC_PI_2 { (0.0, size, 0.0) } else { reduce(size) };
    let quarter = on_quarter(offset.abs(), with_sign_of(offset, low));
    let [period_1, period_2] = PERIOD_PARTS;
    turns * period_1 + (turns * period_2 + quarter.copysign(offset))
}

/// The certified function, rounded; beyond the fast reduction nothing is silently wrong.
#[cold]
#[inline(never)]
fn fall_back(x: f64) -> f64 {
    let balls = Balls::new(FALL_BACK_BITS);
    Point::from_f64(x).map_or(f64::NAN, |x| lobachevsky(&x, balls).midpoint().to_f64())
}

/// x = n pi + t + low for pi/2 < x <= FAST_LIMIT: n, t, low.
#[inline(always)]
fn reduce(x: f64) -> (f64, f64, f64) {
    let [pi_1, pi_2, pi_3] = PI_PARTS;
    // To the nearest integer without a call: added to 1.5 2^52, a double has no room for more.
    let turns = (x * FRAC_1_PI + ROUNDING) - ROUNDING;
    // x - n pi_1 is exact (Sterbenz), the error of the next difference is recovered (Dekker's two-sum): near
    // pi/2 + n pi the slope of L is as large as 37. It is not where t is below n pi_2 < 10^-4, and there L(t) is
    // below 10^-12 beside n pi ln 2.
    let first = x - turns * pi_1;
    let subtrahend = turns * pi_2;
    let offset = first - subtrahend;
    (turns, offset, ((first - offset) - subtrahend) - turns * pi_3)
}

/// x times the sign of `sign`.
#[inline(always)]
fn with_sign_of(sign: f64, x: f64) -> f64 {
    f64::from_bits(x.to_bits() ^ (sign.to_bits() & (-0.0_f64).to_bits()))
}

/// L(t + low) for 0 <= t <= pi/2 up to rounding, low a correction below an ulp of t.
#[inline(always)]
fn on_quarter(t: f64, low: f64) -> f64 {
    if t < FIRST as f64 / PER_UNIT {
        // t^2 first and t last: the product underflows only where L does.
        let square = t * t;
        return t * (square * polynomial(&FROM_ZERO, square));
    }
    // The number of the panel as a double and, by its last bits, as an index; the centre is exact.
    let shifted = (t * PER_UNIT - HALF) + ROUNDING;
    let index = (shifted.to_bits() & LAST_BITS) as usize;
    if let Some(panel) = index.checked_sub(FIRST).and_then(|index| PANELS.get(index)) {
        let distance = (t - centre(shifted - ROUNDING)) + low;
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
    let Some((last, rows)) = rows.split_last() else { return 0.0 };
    let mut sums = *last;
    for row in rows.iter().rev() {
        sums = std::array::from_fn(|k| sums[k] * fourth + row[k]);
    }
    (sums[0] + square * sums[2]) + z * (sums[1] + square * sums[3])
}

/// The panels: each from n/32 to (n + 1)/32, n = 19, 20, ...
const PER_UNIT: f64 = 32.0;
const FIRST: usize = 19;
/// A little below a half: the beginning of a panel is not rounded to the even one before it.
const HALF: f64 = 0.498_046_875;
/// Of the index of a panel; t is below 64/32.
const LAST_BITS: u64 = 63;

#[inline(always)]
fn centre(number: f64) -> f64 {
    (number + 0.5) / PER_UNIT
}

/// L(centre + d) = high + low + sum_k taylor[k] d^(k+1).
#[repr(align(16))]
struct Panel {
    high: f64,
    low: f64,
    taylor: [f64; 12],
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
const PANELS: [Panel; 23] = [
    Panel {
        high: 0.03922316728778176,
        low: 2.8314752146288834e-18,
        taylor: [
            0.1984437437530953, 0.34899448181179965, 0.24786476555672435, 0.08650343541487222,
            0.061013542496737, 0.03992497758485089, 0.0303766999333375, 0.023443332382613764,
            0.019053845909370298, 0.015821970833135822, 0.013476924666678733, 0.011676739205418864,
        ],
    },
    Panel {
        high: 0.045772997788596524,
        low: 2.2145117061329982e-18,
        taylor: [
            0.2209929229511051, 0.372757870279696, 0.2592989532369698, 0.09665572557436734,
            0.06916491422222487, 0.04726311824132151, 0.036969870948043874, 0.029571323441633126,
            0.024808062744230724, 0.021306524699969243, 0.018752246011956804, 0.016795850916188234,
        ],
    },
    Panel {
        high: 0.0530510554490556,
        low: -3.2750345171791996e-18,
        taylor: [
            0.24506209204369941, 0.3976552967843371, 0.2720864900404261, 0.10819663394803423,
            0.07883860650444882, 0.05622700381652478, 0.0453192110023564, 0.03758789491398825,
            0.03259764247339059, 0.028983236144150607, 0.026389860607986874, 0.024460703124269376,
        ],
    },
    Panel {
        high: 0.061105990084547784,
        low: 2.2038109760000357e-18,
        taylor: [
            0.27072627036884545, 0.4238222632232763, 0.2864168738691334, 0.1213898477085518,
            0.09037895137271407, 0.06725812865251372, 0.05597725707954486, 0.048175038687096355,
            0.043253670853671405, 0.03985531274524616, 0.03759095637567471, 0.03610002815450318,
        ],
    },
    Panel {
        high: 0.06998893423602373,
        low: 1.039372236888358e-18,
        taylor: [
            0.2980695352157343, 0.4514136937263368, 0.30251621525577, 0.13655996214071872,
            0.10422566583566165, 0.08093985201337968, 0.06970035051491781, 0.062299369556331786,
            0.05799612800376173, 0.05544783480361079, 0.05424673357954165, 0.05404353824787955,
        ],
    },
    Panel {
        high: 0.07975380637639166,
        low: -6.1755080757297856e-18,
        taylor: [
            0.3271863508945333, 0.4806077552471852, 0.32065587626915887, 0.1541097009005396,
            0.12094516852086404, 0.09805087472114526, 0.08753561638793979, 0.08134838463478677,
            0.07864097619350488, 0.0781147889379721, 0.07938430088096403, 0.08215826059212934,
        ],
    },
    Panel {
        high: 0.09045765966243616,
        low: -1.6117179328218465e-18,
        taylor: [
            0.3581831641639795, 0.5116105993325422, 0.3411636035662686, 0.17454291569098848,
            0.14127396720372606, 0.11964206746704405, 0.11095056950076841, 0.10734104268407745,
            0.10793211026860969, 0.11154955723592722, 0.11793569122996982, 0.12698696374754534,
        ],
    },
    Panel {
        high: 0.1021610855375398,
        low: -1.0195860531862312e-18,
        taylor: [
            0.3911803316650128, 0.5446622968055773, 0.36443801170768453, 0.19849564449996535,
            0.16617951353787383, 0.1471483733007579, 0.1420291765921881, 0.14325861889119912,
            0.15008307610022106, 0.16165024826827587, 0.1780919492119427, 0.1998304934265764,
        ],
    },
    Panel {
        high: 0.11492868383583407,
        low: 2.6209765440484573e-18,
        taylor: [
            0.4263144648065458, 0.5800443325461005, 0.39096761847923417, 0.22677855130792585,
            0.19694669796293637, 0.18255422813048328, 0.18377332682813552, 0.19357388222208932,
            0.2116783838952184, 0.2380174595841394, 0.27374143587600425, 0.32064893546859935,
        ],
    },
    Panel {
        high: 0.12882961410727853,
        low: -9.853832046079939e-18,
        taylor: [
            0.4637413044672832, 0.6180891624683101, 0.4213561418405181, 0.2604356648110843,
            0.23530256851200462, 0.22864204530578072, 0.24057463872089493, 0.26511397193135167,
            0.3032048691252678, 0.3566059676937509, 0.4289683567593006, 0.5255623434662362,
        ],
    },
    Panel {
        high: 0.14393824694213997,
        low: -5.162063841744543e-18,
        taylor: [
            0.5036392749334876, 0.6591925281949352, 0.45635652615202027, 0.3008268122324083,
            0.28359899690036716, 0.2893720279780553, 0.3189671485443104, 0.368497226644411,
            0.44171344930248846, 0.5445361689324157, 0.6865741858774173, 0.8816848664413642,
        ],
    },
    Panel {
        high: 0.16033493950490985,
        low: -1.3295318214895987e-17,
        taylor: [
            0.5462139181970119, 0.7038295063908422, 0.496917316044251, 0.3497450692684873,
            0.3450848109634695, 0.3704738387869927, 0.4288534808002984, 0.5205810959098395,
            0.6555620475800734, 0.8490615793705861, 1.1246910615996242, 1.51737922775662,
        ],
    },
    Panel {
        high: 0.17810696684913876,
        low: -6.789112889886268e-18,
        taylor: [
            0.5917034829468122, 0.7525756861788855, 0.5442467756184136, 0.4095868906116735,
            0.42431883986418895, 0.48038764150745067, 0.585548619973094, 0.7487384028778884,
            0.9930999644450463, 1.3547805175146792, 1.8902094622826502, 2.6860785619422365,
        ],
    },
    Panel {
        high: 0.19734965070158772,
        low: -5.974586354425889e-18,
        taylor: [
            0.640386047918277, 0.8061354955029146, 0.5999029580731531, 0.4836030683599655,
            0.5278098147742242, 0.6317953778670897, 0.8132733323612262, 1.0985362260881324,
            1.539052217252622, 2.217756377648035, 3.268414507399912, 4.9060135566554175,
        ],
    },
    Panel {
        high: 0.21816774152215482,
        low: 1.234692102680072e-17,
        taylor: [
            0.6925887135004819, 0.8653806615702792, 0.6659224596132094, 0.5762764186545867,
            0.6650304080685098, 0.8441761284855178, 1.1512939882883308, 1.647951240521983,
            2.446471057742443, 3.735619056460776, 5.833733543404187, 9.278958030384839,
        ],
    },
    Panel {
        high: 0.24067712968279548,
        low: -7.212284102799705e-18,
        taylor: [
            0.7486996257700114, 0.9314033052457438, 0.7450080780151308, 0.6939029862980718,
            0.8500650497510125, 1.1481915941890504, 1.6650524165490266, 2.534591499454562,
            4.0013807464576985, 6.497432789500958, 10.790323473673602, 18.251388287222966,
        ],
    },
    Panel {
        high: 0.2650069905822019,
        low: -1.8020600024734157e-18,
        taylor: [
            0.8091839483742435, 1.0055906072901402, 0.8408083129801018, 0.8455089420642589,
            1.1043638519215806, 1.5934517476393686, 2.467050954531278, 4.009836089367292,
            6.759064049944376, 11.718673761606158, 20.779289263316986, 37.52768434859828,
        ],
    },
    Panel {
        high: 0.29130251129214646,
        low: -1.0053488362389886e-17,
        taylor: [
            0.8746054464995017, 1.0897320163624318, 0.9583439116568877, 1.0443380432185205,
            1.4614927130863065, 2.262758940603192, 3.7575979932206627, 6.551199391584995,
            11.845026202749308, 22.028470017581967, 41.89794571210372, 81.16522919273463,
        ],
    },
    Panel {
        high: 0.31972841098996063,
        low: -2.5778517553569592e-17,
        taylor: [
            0.9456562280510032, 1.1861768434156366, 1.1046770025703223, 1.3103422799027118,
            1.9756249034998887, 3.299299653062788, 5.907887948432094, 11.107100194361728,
            21.65556721967643, 43.428235660523626, 89.07068015897222, 186.0656761905355,
        ],
    },
    Panel {
        high: 0.3504735677803327,
        low: 3.5554957234591e-18,
        taylor: [
            1.0231986448280959, 1.2980722206388515, 1.2899943266628529, 1.6745058002227693,
            2.7373547877476536, 4.960979717373688, 9.638181634723967, 19.660446828649324,
            41.5900509963813, 90.49396659215962, 201.37691923117637, 456.4242212738603,
        ],
    },
    Panel {
        high: 0.3837572250194572,
        low: -1.5501366156530567e-18,
        taylor: [
            1.1083258539149496, 1.4297336803100937, 1.5294255977420301, 2.1866712886201776,
            3.9045716667030135, 7.734886330575778, 16.422953600064595, 36.612317260583914,
            84.64462228123533, 201.28240603876816, 489.52189609022776, 1212.5715007045574,
        ],
    },
    Panel {
        high: 0.4198375160717357,
        low: 1.050510848363477e-17,
        taylor: [
            1.2024519935370117, 1.5872434171182856, 1.8462277767902213, 2.930412885211206,
            5.766157051467129, 12.593781480710005, 29.4774051387224, 72.444569787448,
            184.6365625096403, 484.02072403929867, 1297.6873054183638, 3543.6031914529626,
        ],
    },
    Panel {
        high: 0.45902350483247145,
        low: -1.9793739380485097e-17,
        taylor: [
            1.3074512517874153, 1.7794580592212645, 2.2776473230183396, 4.052977885008723,
            8.882289725891027, 21.614613100767862, 56.36325714037293, 154.323130477709,
            438.1882568209541, 1279.749212427893, 3822.511924574471, 11628.983550974453,
        ],
    },
];

#[cfg(test)]
mod tests {
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
        for (index, panel) in (FIRST..).zip(&PANELS) {
            let middle = centre(index as f64);
            let centre = point(middle);
            let value = lobachevsky(&centre, balls);
            assert_eq!(nearest(&value), panel.high);
            let low = balls.sub(&value, &balls.from_f64(panel.high).unwrap());
            assert_eq!(nearest(&low), panel.low);
            // tan' = 1 + tan^2: (k+1) tau_(k+1) = [k = 0] + sum_i tau_i tau_(k-i); l' = tan, L' = l.
            let mut tangent = vec![balls.tan(&balls.from_f64(middle).unwrap()).unwrap()];
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
        let mut arguments = vec![1.0, 3.0e6, 2999999.5];
        // The ends of the panels, where their polynomials are worst, and the centres.
        for n in 38..=84 {
            let place = f64::from(n) / (2.0 * PER_UNIT);
            arguments.extend([place, place.next_down()]);
        }
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
