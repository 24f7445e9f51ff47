//! The coefficients of T/2pi as floats, by the energy integral in numbers.
//!
//! The exact polynomials of [`lindstedt_derivation::energy`] have tens of thousands of terms at order 30; their
//! values satisfy the same recurrences and cost O(N^2) for the power law, O(N^4/6) products for
//! forces x F(delta ln x^2).

use lindstedt_algebra::Stop;
use lindstedt_derivation::constants::sine_sum;
use lindstedt_number::ball::{Ball, Balls};
use lindstedt_phase::lobachevsky_function::means_until;
use rug::{Float, Integer, Rational};

/// T/2pi of x'' + x (x^2)^delta = 0 at amplitude one: with x = cos^(1/(1+delta)) theta,
/// T/2pi = sum_j mu_j delta^j (1 + delta)^(-1/2 - j), so t_n = sum_j mu_j binomial(-1/2-j, n-j).
///
/// Nothing when stopped, or unless every coefficient is known to `bits` bits relative, with 16 N more in work.
pub fn power_law(order: usize, bits: u32, stop: &Stop) -> Option<Vec<Float>> {
    let guard = 16u32.checked_mul(u32::try_from(order).ok()?)?.checked_add(64)?;
    let balls = Balls::new(bits).with_guard(guard);
    let moments = means_until(order, balls, stop)?;
    let coefficient = |n: usize| -> Option<Float> {
        if stop.asked() {
            return None;
        }
        let mut sum = balls.zero();
        for (j, mu) in moments.iter().enumerate().take(n + 1) {
            let top = Rational::from((-1, 2)) - Rational::from(j);
            let mut binomial = Rational::from(1);
            for i in 0..n - j {
                binomial *= (&top - Rational::from(i)) / Rational::from(i + 1);
            }
            sum = balls.add(&sum, &balls.mul_rational(mu, &binomial));
        }
        known(&sum, bits)
    };
    (0..=order).map(coefficient).collect()
}

/// The midpoint, if it has so many bits.
fn known(ball: &Ball, bits: u32) -> Option<Float> {
    let enough = ball.relative_accuracy_bits() >= i64::from(bits);
    enough.then(|| Float::with_val(bits, ball.midpoint()))
}

/// T/2pi of x'' + x F(delta ln x^2) = 0, F(z) = sum_n S_n(a) z^n/n!, x(0) = 1, by the recurrence
/// y_n of the radicand's power -1/2 as polynomials in K = cot^2 theta and l = -ln cos theta, with
/// numbers for coefficients, and their means.
///
/// Rounded at `bits` + 16 N bits without proof; the caller computes with other bits and compares.
pub fn pendulum(
    amplitude: &dyn Fn(Balls) -> Ball,
    order: usize,
    bits: u32,
    stop: &Stop,
) -> Option<Vec<Float>> {
    let guard = 16u32.checked_mul(u32::try_from(order).ok()?)?.checked_add(64)?;
    let work = bits.checked_add(guard)?;
    let mut balls = Balls::new(work).with_guard(64);
    // The sums cancel near amplitude pi, where S_0 = sin(a)/a vanishes.
    let sums = loop {
        let at = amplitude(balls);
        let orders = 0..=u16::try_from(order).ok()?;
        let list: Vec<Ball> =
            orders.map(|n| sine_sum(n, &at, balls, stop)).collect::<Option<_>>()?;
        if list.iter().all(|s| s.relative_accuracy_bits() >= i64::from(work)) {
            break list;
        }
        if balls.bits() > work.saturating_mul(16) {
            return None;
        }
        balls = Balls::new(balls.bits().saturating_mul(2));
    };
    let root = balls.sqrt(sums.first()?)?;
    let ratios: Vec<Float> = sums
        .iter()
        .map(|s| Some(Float::with_val(work, balls.div(s, sums.first()?)?.midpoint())))
        .collect::<Option<_>>()?;
    let powers = inverse_root(&ratios, work, stop)?;
    let table = means_of_powers(order, work, stop)?;
    let scale = Float::with_val(work, root.midpoint());
    let coefficient = |y: &Grid| {
        let mut sum = Float::new(work);
        for (i, row) in y.iter().enumerate() {
            for (m, c) in row.iter().enumerate() {
                sum += c * &table[i][m];
            }
        }
        Float::with_val(bits, sum / &scale)
    };
    Some(powers.iter().map(coefficient).collect())
}

/// c[i][m] of K^i l^m.
type Grid = Vec<Vec<Float>>;

/// y = x^(-1/2) of the radicand, n y_n = sum_{k=1}^n (k/2 - n) x_k y_{n-k}.
///
/// x_k = (F_k/F_0) w_k/sin^2 with w_k/sin^2 = (2^(k+1)/k!) I_k/sin^2 and
/// I_k/sin^2 = -K (-l)^k/2 - (k/2) I_{k-1}/sin^2, I_0/sin^2 = 1/2, that is
///
///   x_k = (-1)^k (F_k/F_0) (1 - K sum_{j=1}^k (2 l)^j/j!).
///
/// The sums over k <= n of weights w_k = (k/2 - n)/n (-1)^k F_k/F_0 are exchanged,
///
///   y_n = z_1 - K sum_{j=1}^n (2 l)^j/j! z_j,   z_j = sum_{k=j}^n w_k y_{n-k},
///
/// and z_n, z_{n-1}, ... z_1 grow by one term each: N^4/6 products in all.
fn inverse_root(ratios: &[Float], bits: u32, stop: &Stop) -> Option<Vec<Grid>> {
    let order = ratios.len().checked_sub(1)?;
    let square = |n: usize| -> Grid { vec![vec![Float::new(bits); n]; n] };
    let mut exponential = vec![Float::with_val(bits, 1)];
    for j in 1..=order {
        let next = Float::with_val(bits, &exponential[j - 1] << 1u32) / j as u64;
        exponential.push(next);
    }
    let mut list: Vec<Grid> = vec![vec![vec![Float::with_val(bits, 1)]]];
    for n in 1..=order {
        let (mut y, mut z) = (square(n + 1), square(n));
        for (known, k) in list.iter().zip((1..=n).rev()) {
            if stop.asked() {
                return None;
            }
            let sign = if k % 2 == 0 { 1 } else { -1 };
            let weight = Float::with_val(bits, k as f64 / 2.0 - n as f64) / n as u64;
            let weight = weight * &ratios[k] * sign;
            for (i, row) in known.iter().enumerate() {
                for (m, c) in row.iter().enumerate() {
                    z[i][m] += c * &weight;
                    y[i + 1][m + k] -= &z[i][m] * &exponential[k];
                }
            }
        }
        for (row, sums) in y.iter_mut().zip(z) {
            for (c, sum) in row.iter_mut().zip(sums) {
                *c += sum;
            }
        }
        list.push(y);
    }
    Some(list)
}

/// <K^i l^m> = m! [z^m] prod_{r<i} -(1 + 2r - z)/(1 + 2r) sum_m mu_m z^m for i, m <= order.
fn means_of_powers(order: usize, bits: u32, stop: &Stop) -> Option<Grid> {
    let moments = means_until(order, Balls::new(bits), stop)?;
    let mut product = vec![Rational::new(); order + 1];
    product[0] += 1;
    let mut table = Vec::new();
    for i in 0..=order {
        if stop.asked() {
            return None;
        }
        let mean = |m: usize| {
            let mut sum = Float::new(bits);
            for (c, mu) in product.iter().take(m + 1).zip(moments[..=m].iter().rev()) {
                sum += Float::with_val(bits, mu.midpoint() * c);
            }
            let factorial = u32::try_from(m).unwrap_or(u32::MAX);
            sum * Integer::from(Integer::factorial(factorial))
        };
        table.push((0..=order).map(mean).collect());
        let odd = 2 * i as u64 + 1;
        for index in (0..product.len()).rev() {
            let mut value = Rational::from(&product[index] * odd);
            if index > 0 {
                value -= &product[index - 1];
            }
            product[index] = -value / odd;
        }
    }
    Some(table)
}
