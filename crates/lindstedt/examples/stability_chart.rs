//! Where averaging predicts a stable impact orbit with a delay loop, and where it is stable.

use lindstedt::Exact;
use lindstedt::unstable::impact::ImpactError;
use lindstedt::unstable::impact::characteristic::Kick;
use lindstedt::unstable::impact::chart::{Axis, Plan, Point, Predictor, Swept, chart};
use lindstedt::unstable::impact::flip::flip_boundary;
use lindstedt::unstable::impact::map::Verdict::{Stable, Unstable};
use lindstedt::unstable::impact::parameters::{Branch, ExactParameters};
use lindstedt::unstable::impact::prediction::Variant;
use lindstedt::unstable::number::real::Real;

fn symbol(point: Option<&Point>) -> char {
    match point.and_then(|p| Some((p.predicted?, p.exact?))) {
        Some((Stable, Stable)) => '#',
        Some((Unstable, Unstable)) => '.',
        Some((Stable, Unstable)) => 'X',
        Some((Unstable, Stable)) => 'o',
        _ => ' ',
    }
}

fn main() -> Result<(), ImpactError> {
    let number = |n: i32, d: u32| Exact::from((n, d));
    let orbit = ExactParameters {
        alpha: number(1, 1),
        omega: number(33, 10),
        periods: 1,
        restitution: number(3, 5),
        wall: number(-1, 5),
        damping: number(1, 5),
        force: number(1, 1),
        displacement_gain: number(0, 1),
        velocity_gain: number(0, 1),
        branch: Branch::Plus,
    };
    let axis = |parameter| Axis { parameter, low: -0.3, high: 0.3, count: 21 };
    let plan = Plan {
        columns: axis(Swept::DisplacementGain),
        rows: axis(Swept::VelocityGain),
        predictor: Some((Predictor::Kbm(Variant::E), 1)),
        exact: Some(Kick::Mean),
        radius: false,
        part: None,
    };
    let chart = chart(&orbit.nearest(), &plan, &|_| true)?;

    println!("A from -0.3 to 0.3, B from 0.3 (top) to -0.3; # . right, X o wrong prediction");
    for row in (0..plan.rows.count).rev() {
        let line: String =
            (0..plan.columns.count).map(|column| symbol(chart.point(column, row))).collect();
        println!("  {line}");
    }
    let agreement = chart.agreement();
    println!("prediction right at {} of {} points", agreement.equal, agreement.compared);
    for gain in flip_boundary(&orbit, Kick::Mean, -0.3, 0.3, 96)? {
        println!("true flip at B = 0: A = {:.13}", gain.to_f64());
    }
    Ok(())
}
