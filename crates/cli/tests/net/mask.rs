//! What is not the same twice stands as `*`; JSON is laid out so that a number has a line.

use serde_json::Value;
use std::collections::BTreeMap;

/// Widest line of JSON that is not broken.
const WIDTH: usize = 120;

/// Keys and columns that hold times, or follow from them.
const TIMED: [&str; 3] = ["seconds", "seconds_again", "pareto"];

/// A result, by its format. `timed`: a table of times, the output of `trade`.
pub fn output(text: &str, format: &str, timed: bool) -> String {
    let mut shown = match format {
        "json" => match serde_json::from_str(text) {
            Ok(value) => laid_out(&masked(value), 0),
            Err(error) => format!("NOT JSON: {error}\n{text}"),
        },
        _ if timed => text.lines().map(|line| without_times(line) + "\n").collect(),
        _ => text.to_owned(),
    };
    if !shown.is_empty() && !shown.ends_with('\n') {
        shown.push_str("\n(no newline at the end)\n");
    }
    shown
}

/// A file: tables as they are, figures as a digest.
pub fn file(name: &str, text: &str, timed: bool) -> String {
    match name.rsplit_once('.') {
        Some((_, "svg")) => digest(text, timed),
        Some((_, "csv")) if timed => table(text),
        _ => text.to_owned(),
    }
}

fn masked(value: Value) -> Value {
    match value {
        Value::Object(map) => {
            let pair = |(key, value): (String, Value)| {
                let hidden = TIMED.contains(&key.as_str()) && !value.is_null();
                (key, if hidden { Value::from("*") } else { masked(value) })
            };
            Value::Object(map.into_iter().map(pair).collect())
        }
        Value::Array(list) => list.into_iter().map(masked).collect(),
        value => value,
    }
}

/// JSON with every value on one line that fits there, in the order of its keys.
fn laid_out(value: &Value, indent: usize) -> String {
    let (inner, outer) = ("  ".repeat(indent + 1), "  ".repeat(indent));
    let flat = value.to_string();
    let (open, items, close): (_, Vec<String>, _) = match value {
        Value::Object(map) if outer.len() + flat.len() > WIDTH => {
            let item = |(key, value): (&String, &Value)| {
                format!("{inner}{}: {}", Value::from(key.as_str()), laid_out(value, indent + 1))
            };
            ("{", map.iter().map(item).collect(), "}")
        }
        Value::Array(list) if outer.len() + flat.len() > WIDTH => {
            let item = |value| format!("{inner}{}", laid_out(value, indent + 1));
            ("[", list.iter().map(item).collect(), "]")
        }
        _ => return if indent == 0 { flat + "\n" } else { flat },
    };
    let end = if indent == 0 { "\n" } else { "" };
    format!("{open}\n{}\n{outer}{close}{end}", items.join(",\n"))
}

/// Times (a number and its unit), the widths they cause and the marks of the Pareto front out of
/// one line.
fn without_times(line: &str) -> String {
    let mut words: Vec<String> = Vec::new();
    for word in line.split(' ').filter(|word| !word.is_empty()) {
        let unit = word.trim_end_matches([',', ':', '.', ';']);
        let is_number = |w: &String| w == "*" || w.parse::<f64>().is_ok();
        if matches!(unit, "us" | "ms" | "s" | "min") && words.last().is_some_and(is_number) {
            words.pop();
            words.push(format!("*{}", &word[unit.len()..]));
        } else {
            // In Markdown the mark is escaped.
            let marked = word.strip_suffix("\\*").or(word.strip_suffix('*'));
            let marked = marked.filter(|tier| tier.starts_with(char::is_alphabetic));
            words.push(marked.unwrap_or(word).to_owned());
        }
    }
    words.join(" ")
}

/// A table with `*` in the columns of times.
fn table(text: &str) -> String {
    let header: Vec<&str> = text.lines().next().unwrap_or("").split(',').collect();
    let row = |line: &str| {
        let cell = |(n, cell)| match header.get(n) {
            Some(name) if TIMED.contains(name) && cell != *name => "*",
            _ => cell,
        };
        line.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",") + "\n"
    };
    text.lines().map(row).collect()
}

/// How many elements of each kind a figure has, and its texts in their order. The axes of a figure
/// of times are left out.
fn digest(svg: &str, timed: bool) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut texts = String::new();
    for element in svg.split('<').skip(1) {
        let name = element.split([' ', '>', '\n']).next().unwrap_or("");
        let content = element.split_once('>').map_or("", |(_, content)| content.trim());
        let left_out = timed && matches!(name, "line" | "polyline" | "text");
        if !(left_out || name.starts_with('/')) {
            *counts.entry(name).or_default() += 1;
        }
        if !(content.is_empty() || timed && content.parse::<f64>().is_ok()) {
            texts += &format!("  {content}\n");
        }
    }
    let counts: Vec<String> = counts.iter().map(|(name, n)| format!("{n} {name}")).collect();
    format!("{}\n{texts}", counts.join(", "))
}

#[test]
fn times_are_masked_and_nothing_else() {
    let line = "simulation-f64*   12 digits   92 us   1.5 ms   1704 B   2.4e-16";
    assert_eq!(without_times(line), "simulation-f64 12 digits * * 1704 B 2.4e-16");
    assert_eq!(without_times("| fourier\\* | 2 |"), "| fourier | 2 |");
    assert_eq!(
        without_times("For 1e-6 in 3.2 s: exact at t = 3 s."),
        "For 1e-6 in *: exact at t = *."
    );
    assert_eq!(table("tier,seconds\nexact,0.1\n"), "tier,seconds\nexact,*\n");
    let json = output("{\"b\": 1, \"seconds\": 0.2}", "json", false);
    assert_eq!(json, "{\"b\":1,\"seconds\":\"*\"}\n");
    assert!(output("{\"b\": }", "json", false).starts_with("NOT JSON"));
    let figure = "<svg a=\"1\"><text x=\"1\">\ntime\n</text><line x=\"2\"/></svg>";
    assert_eq!(digest(figure, false), "1 line, 1 svg, 1 text\n  time\n");
}
