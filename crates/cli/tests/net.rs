//! The net: what every documented command prints, in every format.
//!
//! One snapshot per command line of `net/commands.txt`, its formats one below the other, so that a
//! change shows as the lines it changes. A change of wording is allowed, a lost fact is not. What
//! depends on the clock stands as `*`. A snapshot shows presentation; the numbers have witnesses
//! of their own.
//!
//! The LaTeX of all commands is also read token by token (`net/latex.rs`): what is known to be
//! broken is listed in `KNOWN_DEFECTS`, and the list can only shrink.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that panics has failed")]

#[path = "net/commands.rs"]
mod commands;
#[path = "net/coverage.rs"]
mod coverage;
#[path = "net/defects.rs"]
mod defects;
#[path = "net/latex.rs"]
mod latex;
#[path = "net/limits.rs"]
mod limits;
#[path = "net/mask.rs"]
mod mask;
#[path = "net/run.rs"]
mod run;

use commands::{Line, lines};
use run::{Output, run_all};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

fn snapshots() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/net/snapshots")
}

/// The snapshot of one command: every format under its own heading.
fn snapshot(outputs: &[Output]) -> String {
    let mut text = String::new();
    for output in outputs {
        text += &format!("==== {} (exit {})\n{}", output.format, output.code, output.shown);
        if !output.warnings.is_empty() {
            text += &format!("---- standard error\n{}", output.warnings);
        }
        for (name, content) in &output.files {
            text += &format!("---- {name}\n{content}");
        }
    }
    text
}

/// Compares with the stored snapshot; insta prints the difference.
fn agrees(line: &Line, outputs: &[Output]) -> bool {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(snapshots());
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(format!("lindstedt {}", line.command));
    let compare = || insta::assert_snapshot!(line.name(), snapshot(outputs));
    settings.bind(|| catch_unwind(AssertUnwindSafe(compare)).is_ok())
}

/// Names of snapshots without a command.
fn orphans(lines: &[Line], elsewhere: &[Line]) -> Vec<String> {
    let lines = lines.iter().chain(elsewhere);
    let names: BTreeSet<String> = lines.map(|l| format!("{}.snap", l.name())).collect();
    let there = std::fs::read_dir(snapshots()).unwrap();
    let there = there.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    there.filter(|name| name.ends_with(".snap") && !names.contains(name)).collect()
}

#[test]
fn every_command_prints_what_it_printed() {
    let (lines, elsewhere): (Vec<Line>, Vec<Line>) =
        lines().into_iter().partition(|line| !line.formats.is_empty());
    let outputs = run_all(&lines);
    let changed = lines.iter().zip(&outputs).filter(|(line, outputs)| !agrees(line, outputs));
    let changed: Vec<&str> = changed.map(|(line, _)| line.command.as_str()).collect();
    let (orphans, defects) = (orphans(&lines, &elsewhere), defects::changes(&lines, &outputs));
    let ends = limits::wrong_ends(&lines, &outputs);
    assert!(changed.is_empty(), "{} commands changed:\n{}", changed.len(), changed.join("\n"));
    assert!(orphans.is_empty(), "snapshots of no command: {orphans:#?}");
    assert!(defects.is_empty(), "LaTeX, against KNOWN_DEFECTS:\n{}", defects.join("\n"));
    assert!(ends.is_empty(), "under a limit:\n{}", ends.join("\n"));
}
