//! Every field of the reference files.

use crate::support::{BITS, agrees, agrees_complex, certified, data, number, parameters};
use lindstedt_algebra::Stop;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::equivalent::{Drive, EquivalentOrbit, equivalent_orbit};
use lindstedt_impact::flight::{Clearance, clearance};
use lindstedt_impact::flow::{Flow, characteristic_root, rates};
use lindstedt_impact::map::{ImpactMap, Polynomial, Verdict};
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::{Branch, Parameters};
use lindstedt_impact::prediction::{Variant, predict, predicted_flow, uncontrolled_map};
use lindstedt_impact::zeros::{exact_verdict, multipliers};
use lindstedt_number::real::{Certified, Real};
use serde_json::Value;

const CASES: [&str; 8] = [
    "O1_A", "O2_k2_stabilised", "O5_false_stable", "O8_saddle", "k5", "near_grazing", "plastic",
    "uncontrolled",
];

fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Stable => "stable",
        Verdict::Unstable => "unstable",
        Verdict::Neutral => "neutral",
    }
}

fn check_rates(case: &Value, p: &Parameters<Certified>, name: &str) {
    let kbm = &case["kbm"];
    let listed = kbm["lambda_n"].as_array().unwrap();
    let rates = rates(p, listed.len() - 1);
    for (n, reference) in listed.iter().enumerate() {
        agrees_complex(&format!("{name} lambda_{n}"), &rates.terms[n], reference);
    }
    for (order, sums) in kbm["cumulative"].as_object().unwrap() {
        let flow = rates.flow(order.parse().unwrap()).unwrap();
        agrees(&format!("{name} R order {order}"), &flow.growth_rate, &sums["R"]);
        agrees(&format!("{name} alpha0 order {order}"), &flow.frequency, &sums["alpha0"]);
    }
    let root = characteristic_root(p).unwrap();
    agrees(&format!("{name} root R"), &root.growth_rate, &kbm["characteristic_root"]["re"]);
    agrees(&format!("{name} root Omega"), &root.frequency, &kbm["characteristic_root"]["im"]);
    assert!(root.residual(p).to_f64() < 1e-40);
}

fn check_orbit(name: &str, o: &EquivalentOrbit<Certified>, reference: &Value) {
    let fields = [
        ("T", o.period.clone()),
        ("theta", o.theta.clone()),
        ("E", o.growth.clone()),
        ("Delta", o.delta.clone()),
        ("kappa", o.kappa.clone()),
        ("q", o.q.clone()),
        ("disc", o.discriminant.clone()),
        ("F", o.forced_amplitude.clone()),
        ("v", o.velocity.clone()),
        ("C", o.cosine.clone()),
        ("D", o.sine.clone()),
        ("cosphi", o.phase.0.clone()),
        ("sinphi", o.phase.1.clone()),
        ("phi", o.phase_angle()),
        ("aminus", o.acceleration_before.clone()),
        ("aplus", o.acceleration_after.clone()),
        ("sigma", o.saltation.clone()),
    ];
    for (field, value) in fields {
        agrees(&format!("{name} {field}"), &value, &reference[field]);
    }
}

fn check_clearance(name: &str, found: Option<&Clearance<Certified>>, reference: &Value) {
    let expected = &reference["interior_max_x_minus_s"];
    match found {
        None => assert!(expected.is_null(), "{name}: no interior maximum found"),
        Some(clearance) => {
            assert!(!expected.is_null(), "{name}: spurious maximum {}", clearance.margin.to_f64());
            agrees(&format!("{name} margin"), &clearance.margin, expected);
            agrees(&format!("{name} time"), &clearance.time, &reference["interior_max_at"]);
        }
    }
    let free = found.is_none_or(|clearance| clearance.margin.is_negative());
    assert_eq!(free, reference["non_penetrating"].as_bool().unwrap(), "{name}");
}

fn check_map(name: &str, map: &ImpactMap<Certified>, reference: &Value) {
    let [first, second] = map.multipliers();
    agrees_complex(&format!("{name} gamma1"), &first, &reference["gamma1"]);
    agrees_complex(&format!("{name} gamma2"), &second, &reference["gamma2"]);
    agrees(&format!("{name} max"), &map.spectral_radius(), &reference["max_abs"]);
    let verdict = if reference["jury17"].is_null() { "verdict" } else { "jury17" };
    assert_eq!(verdict_name(map.verdict()), reference[verdict].as_str().unwrap(), "{name}");
}

fn check_polynomial(name: &str, b: &Polynomial<Certified>, reference: &Value) {
    agrees(&format!("{name} b2"), &b.quadratic, &reference["b2"]);
    agrees(&format!("{name} b1"), &b.linear, &reference["b1"]);
    agrees(&format!("{name} b0"), &b.constant, &reference["b0"]);
    let (first, second) = b.conditions();
    agrees(&format!("{name} |b0/b2|"), &first, &reference["abs_b0_over_b2"]);
    agrees(&format!("{name} |b1/(b0+b2)|"), &second, &reference["abs_b1_over_b0_plus_b2"]);
}

fn kick(label: &str) -> Kick {
    match label {
        "classical" | "chi_0_no_kick" => Kick::None,
        "chi_mean" => Kick::Mean,
        "chi_pre" => Kick::Before,
        "chi_post" => Kick::After,
        other => panic!("{other}"),
    }
}

#[test]
fn every_field_of_the_orbit_files_has_25_digits() {
    for name in CASES {
        let case = data(name);
        let p = parameters(&case).certified(BITS);
        check_rates(&case, &p, name);
        agrees(&format!("{name} F"), &p.forced_amplitude(), &case["forced"]["F"]);
        agrees(&format!("{name} theta0"), &p.phase_lag(), &case["forced"]["phase_lag"]);
        let free = Flow::uncontrolled(&p).unwrap();
        agrees(&format!("{name} lambda"), &free.frequency, &case["lambda"]);

        let drive = Drive::new(&p).unwrap();
        let reference = &case["orbit_uncontrolled"];
        let form = equivalent_orbit(&free, &drive).unwrap();
        check_orbit(name, &form, reference);
        let regular = orbit(&p).unwrap();
        agrees(&format!("{name} v"), &regular.velocity, &reference["v"]);
        agrees(&format!("{name} a-"), &regular.acceleration_before, &reference["aminus"]);
        agrees(&format!("{name} a+"), &regular.acceleration_after, &reference["aplus"]);
        agrees(&format!("{name} sigma"), &regular.saltation, &reference["sigma"]);
        // psi = phi + theta0 up to a turn
        let turn = regular.force_angle() - form.phase_angle() - p.phase_lag();
        assert!(turn.sin_cos().0.to_f64().abs() < 1e-40 && turn.sin_cos().1.to_f64() > 0.0);
        check_clearance(
            name,
            clearance(&p, &regular, &Stop::default()).unwrap().as_ref(),
            reference,
        );

        let reference = &case["stability_uncontrolled"];
        check_map(name, &uncontrolled_map(&p, &regular), reference);
        let literal = predict(Variant::P, &p, &free, Some(&regular)).unwrap();
        check_polynomial(name, literal.polynomial.as_ref().unwrap(), reference);
        check_map(&format!("{name} (16)"), &literal.map, reference);
        check_variants(&case, &p, name);
        check_exact(&case, &p, name);
    }
}

fn check_variants(case: &Value, p: &Parameters<Certified>, name: &str) {
    let rates = rates(p, 4);
    let regular = orbit(p).unwrap();
    for order in 1..=4 {
        let flow = predicted_flow(p, &rates, order).unwrap();
        let key = order.to_string();
        let reference = &case["E"][&key];
        let label = format!("{name} E{order}");
        match predict(Variant::E, p, &flow, Some(&regular)) {
            Err(error) => assert!(reference["orbit"].is_null(), "{label}: {error}"),
            Ok(found) => {
                let orbit = found.orbit.as_ref().unwrap();
                check_orbit(&label, orbit, &reference["orbit"]);
                let stability = &reference["stability"];
                check_polynomial(&label, found.polynomial.as_ref().unwrap(), stability);
                check_map(&label, &found.map, stability);
                check_map(&label, &found.polynomial.unwrap().map(), stability);
            }
        }
        let label = format!("{name} P{order}");
        let found = predict(Variant::P, p, &flow, Some(&regular)).unwrap();
        check_polynomial(&label, found.polynomial.as_ref().unwrap(), &case["P"][&key]);
        check_map(&label, &found.map, &case["P"][&key]);
        let label = format!("{name} S{order}");
        let found = predict(Variant::S, p, &flow, Some(&regular)).unwrap();
        agrees(&label, &found.map.trace, &case["S"][&key]["trace"]);
        agrees(&label, &found.map.determinant, &case["S"][&key]["det"]);
        check_map(&label, &found.map, &case["S"][&key]);
    }
}

fn check_exact(case: &Value, p: &Parameters<Certified>, name: &str) {
    let orbit = orbit(p).unwrap();
    for (label, reference) in case["true_floquet"].as_object().unwrap() {
        let what = format!("{name} {label}");
        let g = Characteristic::new(p, &orbit, kick(label));
        let (verdict, zeros) = exact_verdict(&g);
        assert_eq!(verdict_name(verdict), reference["verdict"].as_str().unwrap(), "{what}");
        assert_eq!(u64::from(zeros.unwrap()), reference["zeros_of_G_in_unit_disc"], "{what}");
        agrees(&what, &g.at(&certified("1")), &reference["G_at_1"]["re"]);
        agrees(&what, &g.at(&certified("-1")), &reference["G_at_minus1"]["re"]);
        let listed = reference["multipliers"].as_array().unwrap();
        let modulus = |value: &Value| match value {
            Value::String(_) => number(value).to_f64().abs(),
            _ => number(&value["re"]).to_f64().hypot(number(&value["im"]).to_f64()),
        };
        let least = listed.iter().map(modulus).fold(f64::INFINITY, f64::min) * (1.0 - 1e-6);
        let found = multipliers(&g, least).unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(found.values.len(), listed.len(), "{what}");
        for (value, reference) in found.values.iter().zip(listed) {
            agrees_complex(&what, value, reference);
        }
        agrees(&what, &found.values[0].modulus(), &reference["max_abs"]);
    }
}

#[test]
fn kbm_series_to_order_ten() {
    for case in data("kbm_series").as_array().unwrap() {
        let p = &case["params"];
        let of = |name: &str| certified(p[name].as_str().unwrap());
        let one = certified("1");
        // T is given: omega = 2 pi/T.
        let parameters = Parameters {
            alpha: of("alpha"),
            omega: one.pi().doubled() / of("T"),
            periods: 1,
            restitution: one.clone(),
            wall: one.clone(),
            damping: of("c"),
            force: one,
            displacement_gain: of("A"),
            velocity_gain: of("B"),
            branch: Branch::Plus,
        };
        let series = rates(&parameters, 10);
        for (n, reference) in case["lambda_n"].as_array().unwrap().iter().enumerate() {
            agrees_complex(&format!("lambda_{n}"), &series.terms[n], reference);
        }
        for (n, reference) in case["partial_sums"].as_array().unwrap().iter().enumerate() {
            let flow = series.flow(n).unwrap();
            agrees("R", &flow.growth_rate, &reference["re"]);
            agrees("Omega", &flow.frequency, &reference["im"]);
        }
        let root = characteristic_root(&parameters).unwrap();
        agrees("root", &root.growth_rate, &case["characteristic_root"]["re"]);
        agrees("root", &root.frequency, &case["characteristic_root"]["im"]);
        let ratio = series.terms[10].modulus() / series.terms[9].modulus();
        agrees("ratio", &ratio, &case["ratio_lambda10_lambda9"]);
    }
}

#[test]
fn map_of_random_flows() {
    for case in data("map_jacobian").as_array().unwrap() {
        let p = &case["params"];
        let of = |name: &str| certified(p[name].as_str().unwrap());
        let flow = Flow { growth_rate: of("R"), frequency: of("Omega") };
        let k = p["k"].as_i64().unwrap();
        let omega = of("omega");
        let drive = Drive {
            period: omega.pi() * omega.integer(2 * k) / &omega,
            omega,
            restitution: of("R_r"),
            wall: of("s"),
            forced_amplitude: of("F"),
            branch: if p["branch"] == -1 { Branch::Minus } else { Branch::Plus },
        };
        let orbit = equivalent_orbit(&flow, &drive).unwrap();
        agrees("v", &orbit.velocity, &case["v"]);
        agrees("C", &orbit.cosine, &case["C"]);
        agrees("D", &orbit.sine, &case["D"]);
        agrees("cos phi", &orbit.phase.0, &case["cosphi"]);
        agrees("sin phi", &orbit.phase.1, &case["sinphi"]);
        agrees("sigma", &orbit.saltation, &case["sigma"]);
        let b = orbit.polynomial(&flow, &drive);
        agrees("b2", &b.quadratic, &case["b2"]);
        agrees("b1", &b.linear, &case["b1"]);
        agrees("b0", &b.constant, &case["b0"]);
        let map = ImpactMap::from_saltation(&flow, &drive, &orbit.saltation);
        agrees("trace", &map.trace, &case["trace"]);
        agrees("det", &map.determinant, &case["det"]);
        let [first, second] = map.multipliers();
        agrees_complex("gamma1", &first, &case["gamma1"]);
        agrees_complex("gamma2", &second, &case["gamma2"]);
    }
}
