//! Doubles against the reference numbers.

use crate::support::{close, data, number, parameters};
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::chart::{Axis, Plan, Predictor, Swept, chart};
use lindstedt_impact::equivalent::Drive;
use lindstedt_impact::flow::{Flow, rates};
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::Parameters;
use lindstedt_impact::prediction::{Variant, predict, predicted_flow};
use lindstedt_impact::zeros::multipliers;

#[test]
fn doubles_have_twelve_digits_where_the_orbit_is_well_conditioned() {
    for name in ["O1_A", "O2_k2_stabilised", "O5_false_stable", "O8_saddle", "k5", "plastic"] {
        let case = data(name);
        let p = parameters(&case).nearest();
        let found = orbit(&p).unwrap();
        let reference = &case["orbit_uncontrolled"];
        close(name, found.velocity, &reference["v"], 1e-12);
        close(name, found.saltation, &reference["sigma"], 1e-12);
        let free = Flow::uncontrolled(&p).unwrap();
        let form = predict(Variant::P, &p, &free, None).unwrap().orbit.unwrap();
        for (value, field) in [
            (form.velocity, "v"),
            (form.phase_angle(), "phi"),
            (form.cosine, "C"),
            (form.sine, "D"),
            (form.saltation, "sigma"),
        ] {
            close(&format!("{name} {field}"), value, &reference[field], 1e-12);
        }
        let rates = rates(&p, 4);
        for order in 1..=4 {
            let flow = predicted_flow(&p, &rates, order).unwrap();
            let reference = &case["kbm"]["cumulative"][order.to_string()];
            close(name, flow.growth_rate, &reference["R"], 1e-12);
            close(name, flow.frequency, &reference["alpha0"], 1e-12);
            let reference = &case["E"][order.to_string()]["stability"];
            if let Ok(found) = predict(Variant::E, &p, &flow, None) {
                let b = found.polynomial.unwrap();
                close(name, b.quadratic, &reference["b2"], 1e-12);
                close(name, b.linear, &reference["b1"], 1e-12);
                close(name, found.map.spectral_radius(), &reference["max_abs"], 1e-12);
            }
            let found = predict(Variant::S, &p, &flow, Some(&found)).unwrap();
            let reference = &case["S"][order.to_string()];
            close(name, found.map.spectral_radius(), &reference["max_abs"], 1e-12);
        }
        for (label, kick) in
            [("classical", Kick::None), ("chi_0_no_kick", Kick::None), ("chi_mean", Kick::Mean)]
        {
            let reference = &case["true_floquet"][label];
            if reference.is_null() {
                continue;
            }
            let g = Characteristic::new(&p, &found, kick);
            let list = multipliers(&g, 0.5 * number(&reference["max_abs"]).to_f64()).unwrap();
            let leading = list.values[0].norm_squared().sqrt();
            close(&format!("{name} {label}"), leading, &reference["max_abs"], 1e-12);
        }
    }
}

/// Near grazing v = 0.00166 is the small root of a quadratic with coefficients of order one; the
/// condition number of the wall position is s/(F - s) = 300, so that two to three digits are lost.
#[test]
fn doubles_lose_three_digits_near_grazing() {
    let case = data("near_grazing");
    let p = parameters(&case).nearest();
    let reference = &case["orbit_uncontrolled"];
    close("v", orbit(&p).unwrap().velocity, &reference["v"], 1e-12 * 300.0);
    let drive = Drive::new(&p).unwrap();
    let condition = p.wall / (drive.forced_amplitude - p.wall);
    assert!((condition - 305.0).abs() < 1.0, "{condition}");
}

/// The columns of a chart are computed side by side, and what the gains do not change once for a row or a column; a point
/// alone goes through one double after the other. Same bits, also where some of those side by side have no orbit,
/// another branch of a formula, or too few neighbours.
#[test]
fn columns_side_by_side_are_points_alone() {
    let (mut found, mut refused) = (0, 0);
    for (name, reach) in [("O1_A", 0.4), ("O2_k2_stabilised", 0.9), ("plastic", 0.5)] {
        let mut base = parameters(&data(name)).nearest();
        for wall in [base.wall, -0.1] {
            base.wall = wall;
            for variant in [Variant::E, Variant::P, Variant::S] {
                for (order, count) in [(1, 43), (2, 8), (6, 67)] {
                    let around = |gain: f64, reach| (gain - reach, gain + reach);
                    let gains = [
                        (Swept::DisplacementGain, around(0.0, reach), count),
                        (Swept::VelocityGain, around(0.0, reach), 11),
                    ];
                    let frequency = (Swept::Omega, around(base.omega, 0.5 * reach), count);
                    for axes in [gains, [frequency, gains[1]], [gains[0], frequency]] {
                        let counts = same_bits(&base, variant, order, axes);
                        (found, refused) = (found + counts[0], refused + counts[1]);
                    }
                }
            }
        }
    }
    assert!(found > 10_000 && refused > 1000, "{found} {refused}");
}

/// Compares a chart with its points; how many of them have a predicted map, and how many have none.
fn same_bits(
    base: &Parameters<f64>,
    variant: Variant,
    order: usize,
    axes: [(Swept, (f64, f64), usize); 2],
) -> [usize; 2] {
    let [columns, rows] =
        axes.map(|(parameter, (low, high), count)| Axis { parameter, low, high, count });
    let plan = Plan {
        columns,
        rows,
        predictor: Some((Predictor::Kbm(variant), order)),
        exact: None,
        radius: true,
        part: None,
    };
    let mut counts = [0; 2];
    for (n, point) in chart(base, &plan, &|_| true).unwrap().points.iter().enumerate() {
        let mut p = base.clone();
        *p.slot(columns.parameter) = columns.value(n % columns.count);
        *p.slot(rows.parameter) = rows.value(n / columns.count);
        let flow = predicted_flow(&p, &rates(&p, order), order);
        let map = flow.and_then(|flow| predict(variant, &p, &flow, None)).map(|found| found.map);
        // Which NaN it is, nobody promises.
        let bits = |radius: f64| if radius.is_nan() { u64::MAX } else { radius.to_bits() };
        let alone = map.as_ref().ok().map(|map| (map.verdict(), bits(map.spectral_radius())));
        let radius = bits(point.predicted_radius);
        assert_eq!(point.predicted.map(|verdict| (verdict, radius)), alone, "{p:?} {order}");
        counts[usize::from(alone.is_none())] += 1;
    }
    counts
}
