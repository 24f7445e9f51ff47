//! Faults at random moments: kill -9, a limit of file size, a closed pipe. No half file under its name, no
//! finished work that is lost. A few here, two hundred of each by `--ignored`.
#![cfg(unix)]

use crate::program::Folder;
use lindstedt_tests::Random;
use std::io::Read;
use std::process::Stdio;
use std::time::Instant;

const FEW: u64 = 4;
const MANY: u64 = 200;

const SWEEP: [&str; 10] = [
    "simulate", "stick-slip", "--sweep", "gamma=0.5..0.7:60", "--skip", "40", "--periods", "20",
    "--plot", "a.csv",
];

/// What a folder may hold besides files without their final name.
fn seen(folder: &Folder) -> Vec<String> {
    folder.names().into_iter().filter(|name| !name.starts_with(".lindstedt-")).collect()
}

/// Killed at any moment a sweep goes on where it was; the table is there whole, or not at all.
fn killed(times: u64) {
    let folder = Folder::new("killed");
    let begin = Instant::now();
    assert_eq!(folder.run(&SWEEP).0, Some(0));
    let alone = begin.elapsed();
    let whole = folder.text("a.csv");
    std::fs::remove_file(folder.0.join("a.csv")).unwrap();
    let kept = [&SWEEP[..], &["--resume", "r"]].concat();
    let (mut lines, mut finished) = (0, 0);
    for round in 0..times {
        let mut child = folder.program(&kept).stdout(Stdio::null()).spawn().unwrap();
        // However busy the machine is, some begin and some end.
        std::thread::sleep(alone.mul_f64(Random(round).between(0.0, 1.2)));
        let _ = child.kill();
        child.wait().unwrap();
        assert!(seen(&folder).iter().all(|name| ["a.csv", "r"].contains(&name.as_str())));
        let table = folder.text("a.csv");
        assert!(table.is_empty() || table == whole, "round {round}: {table}");
        let now = folder.text("r").lines().count();
        // Half a last line may be cut.
        assert!(now + 1 >= lines, "round {round}: {now} lines of {lines}");
        lines = now;
        if !table.is_empty() {
            finished += 1;
            std::fs::remove_file(folder.0.join("a.csv")).unwrap();
            std::fs::remove_file(folder.0.join("r")).unwrap();
            lines = 0;
        }
    }
    println!("{finished} of {times} were finished");
    assert_eq!(folder.run(&kept).0, Some(0));
    assert_eq!(folder.text("a.csv"), whole);
}

/// A file that may not grow beyond some blocks: exit code 5, and what was there stays.
fn limited(times: u64) {
    let folder = Folder::new("limited");
    let command = ["derive", "duffing", "--order", "16", "--format", "json", "--out", "a.json"];
    let mut refused = 0;
    for round in 0..times {
        std::fs::write(folder.0.join("a.json"), "old").unwrap();
        let output = folder.under(&format!("-f {}", round * 80 / times), &command);
        let text = folder.text("a.json");
        if output.status.code() == Some(5) {
            refused += 1;
            assert_eq!(text, "old", "round {round}");
        } else {
            assert_eq!(output.status.code(), Some(0), "round {round}: {output:?}");
            assert!(text.ends_with("}\n"), "round {round}");
        }
        assert_eq!(folder.names(), ["a.json"], "round {round}");
    }
    assert!(refused > 0 && refused < times, "{refused} of {times}");
}

/// A reader that leaves is no failure.
fn closed(times: u64) {
    let folder = Folder::new("closed");
    for round in 0..times {
        let command = ["derive", "duffing", "--order", "16", "--format", "json"];
        let mut child = folder.program(&command).stdout(Stdio::piped()).spawn().unwrap();
        let mut pipe = child.stdout.take().unwrap();
        let mut bytes = vec![0; Random(round).below(20_000)];
        let _ = pipe.read_exact(&mut bytes);
        drop(pipe);
        assert_eq!(child.wait().unwrap().code(), Some(0), "round {round}");
    }
}

#[test]
fn a_few_faults() {
    killed(FEW);
    limited(FEW);
    closed(FEW);
}

#[test]
#[ignore = "two hundred of each"]
fn many_faults() {
    killed(MANY);
    limited(MANY);
    closed(MANY);
}
