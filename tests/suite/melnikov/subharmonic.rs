//! Subharmonic Melnikov functions: the oracle, quadrature in time, the homoclinic limit.

use super::support::{assert_agrees, oracle, real, stick_slip};
use lindstedt::Exact;
use lindstedt::unstable::number::ball::Balls;
use lindstedt_melnikov::{
    Elliptic, MelnikovError, PolynomialFriction, Region, StickSlip, Subharmonic, subharmonic,
};
use lindstedt_paper::section_three;

fn solve(
    bits: u32,
    point: &StickSlip,
    region: Region,
    m: u32,
) -> Result<Subharmonic, MelnikovError> {
    let friction = PolynomialFriction::cubic(point.dry.clone(), &point.alpha, point.beta.clone());
    subharmonic(
        Balls::new(bits),
        &point.a,
        &point.b,
        &point.omega,
        &friction,
        &point.belt_speed,
        region,
        m,
    )
}

#[test]
fn table() {
    for row in oracle("general.json")["subharmonic"].as_array().unwrap() {
        let mut point = stick_slip(row);
        point.belt_speed = real(row, "vstar");
        let region = if row["region"] == "in" { Region::Inside } else { Region::Outside };
        let m = row["m"].as_u64().unwrap() as u32;
        let result = solve(260, &point, region, m).unwrap();
        assert_agrees(&result.complement, &row["kprime"], 29, "k'");
        assert_agrees(&result.modulus, &row["k"], 29, "k");
        assert_agrees(&result.dissipation, &row["D"], 28, "D");
        assert_agrees(&result.forcing, &row["F"], 29, "F");
        assert_agrees(&result.threshold, &row["R_m"], 28, "R_m");
    }
}

#[test]
fn converges_to_the_homoclinic_threshold() {
    let balls = Balls::new(300);
    let point = section_three();
    let limit = point.signed_threshold(balls).unwrap();
    let mut last = f64::INFINITY;
    for m in [2, 4, 8, 16, 24] {
        let r = solve(300, &point, Region::Inside, m).unwrap().threshold;
        let distance = balls.sub(&r, &limit).abs_upper().to_f64();
        // k' falls like e^{-pi m sqrt(a)/omega}, the distance like k'^2 (times logarithms).
        assert!(distance < last * 1e-1, "m = {m}: {distance:e}");
        last = distance;
    }
    assert!(last < 1e-29, "{last:e}");
    let outside = solve(300, &point, Region::Outside, 41).unwrap().threshold;
    assert!(balls.sub(&outside, &limit).abs_upper().to_f64() < 1e-20);
}

#[test]
fn refusals() {
    let fast = StickSlip { omega: Exact::from(3), ..section_three() };
    assert!(matches!(
        solve(100, &fast, Region::Inside, 1),
        Err(MelnikovError::NoResonance { m: 1 })
    ));
    assert!(matches!(
        solve(100, &fast, Region::Inside, 0),
        Err(MelnikovError::NoResonance { m: 0 })
    ));
    assert!(matches!(solve(100, &fast, Region::Outside, 2), Err(MelnikovError::NoForcing)));
    assert!(solve(100, &StickSlip { b: Exact::from(0), ..fast }, Region::Inside, 3).is_err());
}

/// The integrals of (sn cn)^{2n}, (sn dn)^{2n} against the trapezoidal rule in phi = am u, which
/// converges geometrically for a smooth periodic integrand.
#[test]
fn elliptic_powers_by_quadrature() {
    let balls = Balls::new(400);
    for complement in [0.9, 0.5, 0.2, 0.05] {
        let elliptic = Elliptic::new(balls, &balls.from_f64(complement).unwrap()).unwrap();
        let square = 1.0 - complement * complement;
        for n in 1..5usize {
            let nodes = 4000;
            let (mut cn, mut dn) = (0.0, 0.0);
            for i in 0..nodes {
                let phi = std::f64::consts::PI * f64::from(i) / f64::from(nodes);
                let (s, c) = phi.sin_cos();
                let d = (1.0 - square * s * s).sqrt();
                cn += (s * c).powi(2 * n as i32) / d;
                dn += (s * d).powi(2 * n as i32) / d;
            }
            let step = std::f64::consts::PI / f64::from(nodes) / 2.0;
            let check = |exact: Option<lindstedt::unstable::number::ball::Ball>, sum: f64| {
                let exact = exact.unwrap().midpoint().to_f64();
                assert!(
                    (exact / (sum * step) - 1.0).abs() < 1e-12,
                    "k' = {complement}, n = {n}: {exact} {}",
                    sum * step
                );
            };
            check(elliptic.product_power(balls, n, &balls.one()), cn);
            check(elliptic.product_power(balls, n, &elliptic.square), dn);
        }
    }
}
