//! Tables of measurements: read from what divan prints, written as lines `name<TAB>value`, two of
//! them compared.

/// Name and value of every measurement, in the order measured.
pub type Rows = Vec<(String, f64)>;

/// The fastest time of every bench, in seconds, from the trees that divan prints.
///
/// The name is the path, `charts/certified_point/30`.
#[must_use]
pub fn benches(output: &str) -> Rows {
    let mut rows = Rows::new();
    let mut path: Vec<&str> = Vec::new();
    for line in output.lines() {
        let Some(at) = line.find("├─ ").or_else(|| line.find("╰─ ")) else {
            // The heading of a tree.
            if let (Some(name), true) = (line.split_whitespace().next(), line.contains("│ slowest"))
            {
                path = vec![name];
            }
            continue;
        };
        let depth = line[..at].chars().count() / 3 + 1;
        let rest = line[at..].trim_start_matches(['├', '╰', '─', ' ']);
        let mut words = rest.split('│').next().unwrap_or("").split_whitespace();
        let Some(name) = words.next() else { continue };
        path.truncate(depth);
        path.push(name);
        let seconds = match (words.next().and_then(|w| w.parse::<f64>().ok()), words.next()) {
            (Some(value), Some(unit)) => scale(unit).map(|s| value * s),
            _ => None,
        };
        rows.extend(seconds.map(|seconds| (path.join("/"), seconds)));
    }
    rows
}

fn scale(unit: &str) -> Option<f64> {
    match unit {
        "ps" => Some(1e-12),
        "ns" => Some(1e-9),
        "µs" => Some(1e-6),
        "ms" => Some(1e-3),
        "s" => Some(1.0),
        _ => None,
    }
}

/// The instructions in the summary of cachegrind.
#[must_use]
pub fn instructions(summary: &str) -> Option<f64> {
    let line = summary.lines().find(|line| line.contains("I") && line.contains("refs:"))?;
    line.rsplit(':').next()?.trim().replace(',', "").parse().ok()
}

/// The table as it is stored.
#[must_use]
pub fn table(rows: &Rows) -> String {
    let shown = |v: f64| if v < 1e3 { format!("{v:.4e}") } else { format!("{v:.0}") };
    rows.iter().map(|(name, value)| format!("{name}\t{}\n", shown(*value))).collect()
}

/// A stored table; lines that are none are left out.
#[must_use]
pub fn stored(text: &str) -> Rows {
    let row = |line: &str| {
        let (name, value) = line.split_once('\t')?;
        Some((name.to_owned(), value.trim().parse().ok()?))
    };
    text.lines().filter_map(row).collect()
}

/// Both tables side by side with the ratio after/before; what is in one alone has a dash.
#[must_use]
pub fn comparison(before: &Rows, after: &Rows) -> String {
    let value = |rows: &Rows, name: &str| rows.iter().find(|r| r.0 == name).map(|r| r.1);
    let gone = before.iter().filter(|r| value(after, &r.0).is_none());
    let mut text = format!("{:>12} {:>12} {:>8}\n", "before", "after", "ratio");
    for (name, _) in after.iter().chain(gone) {
        let (old, new) = (value(before, name), value(after, name));
        let show = |v: Option<f64>| v.map_or("-".to_owned(), |v| format!("{v:.4e}"));
        let ratio = old.zip(new).map_or("-".to_owned(), |(old, new)| format!("{:.3}", new / old));
        text.push_str(&format!("{:>12} {:>12} {ratio:>8}  {name}\n", show(old), show(new)));
    }
    text
}

/// The exponent e of y ~ x^e through two points.
#[must_use]
pub fn exponent((x, y): (f64, f64), (u, v): (f64, f64)) -> f64 {
    (v / y).ln() / (u / x).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "Timer precision: 20 ns
charts                          fastest       │ slowest       │ median        │ mean
├─ certified_point                            │               │               │
│  ├─ 30                        60.3 ms       │ 72.59 ms      │ 61.25 ms      │ 63.27 ms
│  ╰─ 100                       118.4 ms      │ 138.8 ms      │ 122.8 ms      │ 125.2 ms
├─ exact                        1.459 s       │ 1.509 s       │ 1.47 s        │ 1.479 s
╰─ variant                                    │               │               │
   ╰─ S                         94.58 µs      │ 104 ms        │ 99.31 ms      │ 99.11 ms

balls         fastest       │ slowest       │ median        │ mean          │ samples │ iters
╰─ mul        130 ns        │ 528.2 ns      │ 1 ns          │ 1 ns          │ 5       │ 5
";

    #[test]
    fn the_fastest_times_are_read() {
        let names: Vec<String> = benches(OUTPUT).into_iter().map(|row| row.0).collect();
        let expected = [
            "charts/certified_point/30",
            "charts/certified_point/100",
            "charts/exact",
            "charts/variant/S",
            "balls/mul",
        ];
        assert_eq!(names, expected);
        let expected = [0.0603, 0.1184, 1.459, 94.58e-6, 130e-9];
        for ((name, found), expected) in benches(OUTPUT).iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{name}: {found}");
        }
    }

    #[test]
    fn tables_come_back_and_are_compared() {
        let rows: Rows = vec![("a b".into(), 1.5e9), ("c".into(), 2.0)];
        assert_eq!(stored(&table(&rows)), rows);
        let shown = comparison(&rows, &vec![("a b".into(), 3e9), ("new".into(), 1.0)]);
        let lines: Vec<&str> = shown.lines().collect();
        assert!(lines[1].contains(" 2.000 ") && lines[1].ends_with("a b"), "{shown}");
        assert!(lines[2].ends_with("-  new") && lines[3].ends_with("-  c"), "{shown}");
        assert_eq!(instructions("==1== \n==1== I   refs:      748,838,205\n"), Some(748_838_205.0));
        assert!((exponent((10.0, 2.0), (20.0, 16.0)) - 3.0).abs() < 1e-12);
    }
}
