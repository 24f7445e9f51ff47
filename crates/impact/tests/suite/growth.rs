//! The growth of the piecewise linear return map, and its error.

use crate::support::{Random, exact, orbit_number, random_orbit};
use lindstedt_algebra::Stop;
use lindstedt_impact::characteristic::{Characteristic, Kick};
use lindstedt_impact::kick::{piecewise_growth, piecewise_stable};
use lindstedt_impact::map::Verdict;
use lindstedt_impact::orbit::orbit;
use lindstedt_impact::parameters::ExactParameters;
use lindstedt_impact::report::{Request, stability};
use lindstedt_impact::zeros::multipliers;
use lindstedt_number::real::Real;

/// For B = 0 the return map is linear, and its growth the modulus of the largest multiplier, which zeros
/// of G enclose: the stated error covers the difference, and in the median is not 20 times as large.
#[test]
fn the_error_of_the_growth_covers_the_largest_multiplier() {
    let mut ratios = Vec::new();
    for (n, k) in [2, 3, 5].into_iter().flat_map(|n| (-10..11).map(move |k| (n, k))) {
        let gain = exact(&format!("{}", 0.013 * f64::from(k)));
        let p = ExactParameters { displacement_gain: gain, ..orbit_number(n) };
        let (nearest, balls) = (p.nearest(), p.certified(160));
        let g = Characteristic::new(&balls, &orbit(&balls).unwrap(), Kick::None);
        let truth = multipliers(&g, 0.2).unwrap().values[0].modulus().to_f64();
        let found =
            piecewise_growth(&nearest, &orbit(&nearest).unwrap(), 200, &Stop::default()).unwrap();
        let ratio = found.error / (found.rate - truth).abs();
        assert!(ratio > 1.0, "O{n} A {k}: {found:?} {truth}");
        ratios.push(ratio);
    }
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[ratios.len() / 2] < 20.0, "{ratios:?}");
}

/// For B other than 0 the map is linear in two half planes, and a run of sixteen times the length is the truth.
#[test]
fn the_error_of_the_growth_covers_a_long_run() {
    let mut random = Random(77);
    let (mut beyond, mut count) = (0, 0);
    while count < 100 {
        let mut p = random_orbit(&mut random);
        p.displacement_gain = random.between(-0.3, 0.3);
        p.velocity_gain = random.between(-0.3, 0.3);
        let Ok(found) = orbit(&p) else { continue };
        let runs =
            [400, 6400].map(|flights| piecewise_growth(&p, &found, flights, &Stop::default()));
        let [Ok(short), Ok(long)] = runs else { continue };
        let ratio = (short.rate - long.rate).abs() / (short.error + long.error);
        assert!(ratio < 4.0, "{p:?}: {short:?} {long:?}");
        beyond += usize::from(ratio > 1.0);
        count += 1;
    }
    // Estimated: the run of one in thirty is shorter than a transient.
    assert!(beyond <= 3, "{beyond} of {count}");
}

/// Away from 1 the rate decides as it does with finer flights; bisected to 1 it decides nothing.
#[test]
fn growth_near_one_is_undecided() {
    let mut random = Random(78);
    let (mut undecided, mut by_zeros, mut count) = (0, 0, 0);
    while count < 20 {
        let mut p = random_orbit(&mut random);
        p.velocity_gain = random.between(-0.2, 0.2);
        let mut at = |gain: f64| {
            p.displacement_gain = gain;
            let found = orbit(&p).ok()?;
            let growth = piecewise_growth(&p, &found, 400, &Stop::default()).ok()?;
            Some((growth, piecewise_stable(&p, &found, 400).ok()?))
        };
        let (mut low, mut high) = (-0.3, 0.3);
        let ends = [low, high].map(&mut at);
        let [Some((first, a)), Some((second, b))] = ends else { continue };
        for (growth, stable) in [(first, a), (second, b)] {
            let far = (growth.rate - 1.0).abs() > growth.error;
            assert_eq!(stable, far.then_some(growth.rate < 1.0), "{growth:?}");
        }
        count += 1;
        if (first.rate < 1.0) == (second.rate < 1.0) {
            continue;
        }
        for _ in 0..50 {
            let middle = f64::midpoint(low, high);
            let Some((growth, _)) = at(middle) else { break };
            let end = if (growth.rate < 1.0) == (first.rate < 1.0) { &mut low } else { &mut high };
            *end = middle;
        }
        let Some((growth, stable)) = at(low) else { continue };
        if (growth.rate - 1.0).abs() < 1e-12 {
            assert_eq!(stable, None, "{growth:?}");
            undecided += 1;
            // The zeros of G, which are not those of the map for B other than 0, decide nothing.
            let report =
                stability(&p, &Request::default(), &Stop::default()).unwrap().exact.unwrap();
            assert_eq!(report.verdict, Verdict::Neutral, "{report:?}");
            by_zeros += usize::from(report.zeros_in_unit_disc.is_some());
        }
    }
    assert!(undecided > 2 && by_zeros > 0, "{undecided} {by_zeros}");
}
