//! The search for saddles and the orbits that leave them, on a grid.

use crate::numeric::{COARSE, NumericOrbit, Path};
use rug::Float;

/// Points of the search for saddles and turning points.
const POINTS: i32 = 4000;
/// Rounding errors of W, as a share of its largest value.
const ROUNDING: f64 = 1e-13;
/// Points at which two orbits are compared.
const SAMPLES: u32 = 7;

impl NumericOrbit {
    pub(crate) fn search(&self, reach: f64) -> Option<Vec<Path>> {
        let step = 2.0 * reach / f64::from(POINTS);
        // Off the symmetric points, where zeros like to be.
        let at = |n: i32| Float::with_val(COARSE, step * (f64::from(n) + 0.137) - reach);
        let value = |n: i32| self.f(&at(n));
        let mut saddles = Vec::new();
        for n in 0..POINTS {
            if let (Some(a), Some(b)) = (value(n), value(n + 1))
                && a < 0
                && b > 0
            {
                saddles.push((n, self.zero(&at(n), &at(n + 1), COARSE)?));
            }
        }
        saddles.sort_by(|a, b| a.1.clone().abs().total_cmp(&b.1.clone().abs()));
        let mut paths: Vec<Path> = Vec::new();
        for (_, saddle) in saddles.iter().filter(|(_, saddle)| self.is_hyperbolic(saddle)) {
            let (mut near, mut away) = (Vec::new(), Vec::new());
            for direction in [1, -1] {
                let found = self.follow(saddle, direction, step, reach);
                // Orbits between two saddles: those towards x = 0 first.
                let outward = found.first().is_some_and(|path| path.other.is_some())
                    && *saddle != 0
                    && (saddle.to_f64() > 0.0) == (direction > 0);
                if outward { away.extend(found) } else { near.extend(found) }
            }
            for path in near.into_iter().chain(away) {
                if !paths.iter().any(|known| self.is_same(known, &path)) {
                    paths.push(path);
                }
            }
        }
        Some(paths)
    }

    /// Whether one orbit is the other, or a translation of it by a period of the force.
    fn is_same(&self, known: &Path, path: &Path) -> bool {
        let ends = |path: &Path| {
            let (a, b) = (&path.saddle, path.other.as_ref().unwrap_or(&path.start));
            let swap = path.other.is_some() && a > b;
            if swap { (b.clone(), a.clone()) } else { (a.clone(), b.clone()) }
        };
        let (first, second) = (ends(known), ends(path));
        let length = |(a, b): &(Float, Float)| Float::with_val(COARSE, b - a);
        let near = |a: &Float, b: &Float, size: &Float| {
            let tolerance = Float::with_val(COARSE, size.abs_ref()) >> (COARSE / 3);
            Float::with_val(COARSE, a - b).abs() <= tolerance
        };
        let width = length(&first);
        if known.name != path.name || !near(&width, &length(&second), &width) {
            return false;
        }
        let inside = |(a, _): &(Float, Float), n: u32| {
            let part = Float::with_val(COARSE, &width * n) / (SAMPLES + 1);
            self.f(&(part + a))
        };
        let values = |ends| (1..=SAMPLES).map(|n| inside(ends, n)).collect::<Option<Vec<_>>>();
        let (Some(a), Some(b)) = (values(&first), values(&second)) else { return false };
        let size = a.iter().fold(Float::new(COARSE), |size, f| size.max(&f.clone().abs()));
        a.iter().zip(&b).all(|(a, b)| near(a, b, &size))
    }

    /// Walks away from the saddle until W vanishes: the orbits in that direction.
    fn follow(&self, saddle: &Float, direction: i32, step: f64, reach: f64) -> Vec<Path> {
        self.try_follow(saddle, direction, step, reach).unwrap_or_default()
    }

    fn try_follow(
        &self,
        saddle: &Float,
        direction: i32,
        step: f64,
        reach: f64,
    ) -> Option<Vec<Path>> {
        let at = |n: i32| Float::with_val(COARSE, saddle + step * f64::from(n * direction));
        let mut w = Float::new(COARSE);
        let mut top = Float::new(COARSE);
        let mut centre = None;
        let mut n = 0;
        while (at(n).to_f64()).abs() <= 1.5 * reach {
            let (here, next) = (at(n), at(n + 1));
            let piece = self.cell(&here, &next)?;
            w += piece;
            if w > top {
                top = w.clone();
            }
            let (a, b) = (self.f(&here)? * direction, self.f(&next)? * direction);
            if n > 0 && a > 0 && b <= 0 && centre.is_none() {
                centre = self.zero(&here, &next, COARSE);
            }
            if n > 0 && a < 0 && b >= 0 {
                // A minimum of W: another saddle, on the same level or higher.
                let other = self.zero(&here, &next, COARSE)?;
                let level = self.work(saddle, &other, 80)?;
                let flat = Float::with_val(53, level.abs_ref()) < Float::with_val(53, &top * 1e-18);
                if flat {
                    let start = centre?;
                    let path = |name, sign| Path {
                        name,
                        saddle: saddle.clone(),
                        start: start.clone(),
                        other: Some(other.clone()),
                        sign,
                    };
                    return Some(vec![path("upper orbit", 1), path("lower orbit", -1)]);
                }
            }
            // On a step that ends at another saddle W is zero but for rounding errors.
            if n > 0 && w < Float::with_val(53, &top * -ROUNDING) {
                let name = if direction > 0 { "right loop" } else { "left loop" };
                let start = self.turning_point(saddle, &next, COARSE)?;
                return Some(vec![Path {
                    name,
                    saddle: saddle.clone(),
                    start,
                    other: None,
                    sign: 1,
                }]);
            }
            n += 1;
        }
        None
    }
}
