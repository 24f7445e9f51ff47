//! What is known to be broken in the LaTeX that the commands print.

use crate::commands::Line;
use crate::latex;
use crate::run::Output;
use std::collections::BTreeMap;

/// Verb, defect, and the number of commands that have it. The list can only shrink: what is
/// mended is struck out or counted anew, nothing is added.
const KNOWN_DEFECTS: &[(&str, &str, usize)] = &[];

type Counts = BTreeMap<(String, String), usize>;

/// The verbs and defects of all LaTeX of the net, with the number of commands.
fn counted(lines: &[Line], outputs: &[Vec<Output>]) -> Counts {
    let mut counts = Counts::new();
    for (line, outputs) in lines.iter().zip(outputs) {
        let is_code = line.command.contains("--code latex");
        let written = outputs.iter().filter(|output| is_code || output.format == "latex");
        for defect in written.flat_map(|output| latex::defects(&output.shown)) {
            *counts.entry((line.verb().to_owned(), defect)).or_default() += 1;
        }
    }
    counts
}

fn count(counts: &Counts, key: &(String, String)) -> usize {
    counts.get(key).copied().unwrap_or(0)
}

/// Where the defects differ from those that are known: both new ones and mended ones.
pub fn changes(lines: &[Line], outputs: &[Vec<Output>]) -> Vec<String> {
    let found = counted(lines, outputs);
    let known =
        KNOWN_DEFECTS.iter().map(|(verb, what, n)| ((verb.to_string(), what.to_string()), *n));
    let known: Counts = known.collect();
    let mut keys: Vec<_> = found.keys().chain(known.keys()).collect();
    keys.sort();
    keys.dedup();
    let changed = keys.into_iter().filter(|key| count(&found, key) != count(&known, key));
    let show = |key: &(String, String)| {
        let (verb, what) = key;
        format!(
            "    ({verb:?}, {what:?}, {}), // listed: {}",
            count(&found, key),
            count(&known, key)
        )
    };
    changed.map(show).collect()
}
