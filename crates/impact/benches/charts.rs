//! Cost of charts: 1000 x 1000 predictions, 201 x 201 exact verdicts.

use lindstedt_algebra::Stop;
use lindstedt_impact::characteristic::Kick;
use lindstedt_impact::chart::{Axis, Chart, Plan, Predictor, Swept, chart};
use lindstedt_impact::flow::{Rates, rates};
use lindstedt_impact::parameters::{Branch, ExactParameters, Parameters};
use lindstedt_impact::prediction::Variant;
use lindstedt_impact::report::{Request, StabilityReport, certified_stability};
use lindstedt_number::Exact;
use lindstedt_number::real::Certified;

fn main() {
    divan::main();
}

fn sweep(count: usize, predictor: Option<(Predictor, usize)>, exact: Option<Kick>) -> Chart {
    let base = Parameters {
        alpha: 1.0,
        omega: 3.3,
        periods: 2,
        restitution: 0.8,
        wall: 0.0,
        damping: 0.05,
        force: 1.0,
        displacement_gain: 0.0,
        velocity_gain: 0.0,
        branch: Branch::Plus,
    };
    let axis = |parameter| Axis { parameter, low: -0.3, high: 0.3, count };
    let plan = Plan {
        columns: axis(Swept::DisplacementGain),
        rows: axis(Swept::VelocityGain),
        predictor,
        exact,
        radius: true,
        part: None,
    };
    #[allow(clippy::unwrap_used)]
    chart(&base, &plan, &|_| true).unwrap()
}

#[divan::bench(args = [1, 2, 6], sample_count = 5, sample_size = 1)]
fn predicted_million(order: usize) -> Chart {
    sweep(1000, Some((Predictor::Kbm(Variant::E), order)), None)
}

#[divan::bench(args = [Variant::P, Variant::S], sample_count = 5, sample_size = 1)]
fn predicted_million_variant(variant: Variant) -> Chart {
    sweep(1000, Some((Predictor::Kbm(variant), 1)), None)
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn exact_forty_thousand() -> Chart {
    sweep(201, None, Some(Kick::Mean))
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn impact_aware_forty_thousand() -> Chart {
    sweep(201, Some((Predictor::ImpactAware(Kick::Mean), 1)), None)
}

fn exact_point() -> ExactParameters {
    let number = |n, d| Exact::from((n, d));
    ExactParameters {
        alpha: number(1, 1),
        omega: number(33, 10),
        periods: 2,
        restitution: number(4, 5),
        wall: number(0, 1),
        damping: number(1, 20),
        force: number(1, 1),
        displacement_gain: number(1, 5),
        velocity_gain: number(1, 10),
        branch: Branch::Plus,
    }
}

#[divan::bench(sample_count = 5)]
fn order_fifty_at_fifty_digits() -> Rates<Certified> {
    rates(&exact_point().certified(240), 50)
}

#[divan::bench(args = [30, 100], sample_count = 5, sample_size = 1)]
fn certified_point(digits: u32) -> StabilityReport<Certified> {
    #[allow(clippy::unwrap_used)]
    certified_stability(&exact_point(), &Request::default(), digits, &Stop::default()).unwrap()
}
