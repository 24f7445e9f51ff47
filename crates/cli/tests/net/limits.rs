//! A time limit, wherever it falls.

use crate::commands::Line;
use crate::run::{Output, run_all};

/// Seconds, in turn: before anything, and while most commands work.
const LIMITS: [&str; 6] = ["0.000001", "0.002", "0.005", "0.01", "0.02", "0.05"];
/// The exit code of a limit.
const LIMIT: i32 = 4;

/// The commands that a limit ends in another way than by its exit code or, where they end before, by their
/// own: what was not reached must not look like a property of the problem.
pub fn wrong_ends(lines: &[Line], outputs: &[Vec<Output>]) -> Vec<String> {
    let takes =
        |line: &&Line| line.verb() != "problems" && !line.command.contains("--limit-seconds");
    let limited = |(line, limit): (&Line, &&str)| Line {
        command: format!("{} --limit-seconds {limit}", line.command),
        formats: &["json"],
    };
    let cut: Vec<Line> =
        lines.iter().filter(takes).zip(LIMITS.iter().cycle()).map(limited).collect();
    let own = lines.iter().zip(outputs).filter(|(line, _)| takes(line));
    let own = own.map(|(_, outputs)| outputs.first().map_or(0, |output| output.code));
    let ends = cut.iter().zip(run_all(&cut)).zip(own);
    let wrong = ends.filter_map(|((line, found), own)| {
        let code = found.first()?.code;
        (code != own && code != LIMIT).then(|| format!("{}: {code}, not {own}", line.command))
    });
    wrong.collect()
}
