//! Signals and limits: from inside an order, a step, a chart; the exit code says which it was.
#![cfg(unix)]

use crate::program::Folder;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// So many seconds of the processor between two looks at the flag, on both cores, are too many: measured
/// 0.0 to 0.4.
const LATE: f64 = 1.2;

/// The processor's seconds that a program took.
fn taken(child: &Child) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    let words: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |word: usize| words.get(word)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

/// The signals that this process and what it starts ignore, a bit each.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap();
    u64::from_str_radix(mask.trim(), 16).unwrap()
}

fn interrupted(arguments: &[&str], signal: &str) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lindstedt"));
    command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    while taken(&child).unwrap() < 0.4 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(child.try_wait().unwrap().is_none(), "{arguments:?} was done too soon");
    let kill = format!("kill -{signal} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
    let before = taken(&child).unwrap();
    while child.try_wait().unwrap().is_none() {
        if taken(&child).unwrap() - before > LATE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments:?} does not stop");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn an_interruption_ends_the_work() {
    let cases: [&[&str]; 6] = [
        &["derive", "pendulum", "--order", "16"],
        &["simulate", "pendulum", "--set", "amplitude=3", "--digits", "600", "--periods", "4000"],
        &["simulate", "power-law", "--set", "n=-0.99", "--digits", "40"],
        &[
            "stability", "vibro-impact", "--sweep", "A=-1/3..1/3:3001", "--sweep",
            "B=-1/3..1/3:3001",
        ],
        &["evaluate", "power-law", "--order", "400", "--digits", "800"],
        &["paper", "--quick"],
    ];
    // What a shell has its background ignore (INT of `&`, HUP of `nohup`) stays ignored.
    let ignored = ignored();
    let mut signals = vec![("INT", 130), ("TERM", 143), ("HUP", 129)];
    signals.retain(|(_, code)| ignored >> (code - 128 - 1) & 1 == 0);
    for (arguments, (signal, expected)) in cases.into_iter().zip(signals.into_iter().cycle()) {
        let (code, message) = interrupted(arguments, signal);
        assert_eq!(code, Some(expected), "{arguments:?}: {message}");
        assert!(!message.is_empty(), "{arguments:?}");
    }
}

/// What the time limit stops says so, in every format, and nothing else; a figure of nothing is no error.
#[test]
fn a_limit_is_no_interruption() {
    let folder = Folder::new("limit");
    let chart = ["stability", "vibro-impact", "--sweep", "A=-1/3..1/3:501", "--sweep"];
    let chart = [&chart[..], &["B=-1/3..1/3:501", "--plot", "a.svg", "--plot", "a.csv"]].concat();
    let sweep = ["evaluate", "pendulum", "--sweep", "amplitude=1..2:400", "--plot", "a.csv"];
    for command in [&chart[..], &sweep, &["derive", "pendulum", "--order", "20"]] {
        for format in ["text", "json"] {
            let asked = ["--limit-seconds", "0.2", "--format", format];
            let output = folder.program(&[command, &asked].concat()).output().unwrap();
            let said = [output.stdout, output.stderr].concat();
            let said = String::from_utf8(said).unwrap();
            assert_eq!(output.status.code(), Some(4), "{said}");
            assert!(!said.contains("interrupted") && !said.contains("\"figure\""), "{said}");
            assert!(said.contains("time limit") || said.contains("limit-seconds"), "{said}");
            assert!(!said.contains("cannot be broken off"), "{command:?}: {said}");
        }
    }
}

/// Of what was not looked for to the end nothing is said to be absent.
#[test]
fn stopped_responses_lack_nothing() {
    let folder = Folder::new("stopped-response");
    let equation = "x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)";
    let sweep = ["--set", "eps=1/10", "--set", "F=1/2", "--sweep", "sigma=-1..3:200000"];
    // Beside other work it may be stopped before it begins to look.
    let page = ["0.3", "1", "3", "9"].into_iter().find_map(|limit| {
        let asked = [&["respond", equation], &sweep[..], &["--limit-seconds", limit]].concat();
        let output = folder.program(&asked).output().unwrap();
        let page = String::from_utf8(output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(4), "{page}");
        (!page.is_empty()).then_some(page)
    });
    let page = page.unwrap();
    assert!(page.contains("there may be more") && !page.contains("no folds"), "{page}");
}

/// A chart and a sweep of nine million points, stopped: the rows that are finished are there, whole, and nothing is
/// written for those that are not.
#[test]
fn what_is_finished_of_many_points_is_kept() {
    let folder = Folder::new("many-points");
    let chart = ["stability", "vibro-impact", "--sweep", "A=-1/3..1/3:3001", "--sweep"];
    let chart = [&chart[..], &["B=-1/3..1/3:3001", "--plot", "a.svg", "--plot", "a.csv"]].concat();
    let sweep = ["evaluate", "duffing", "--order", "2", "--sweep", "eps=0..1:3000", "--sweep"];
    let sweep = [&sweep[..], &["amplitude=1..2:3000", "--plot", "a.csv"]].concat();
    for (command, names) in [(&chart, &["a.csv", "a.svg"][..]), (&sweep, &["a.csv"])] {
        let limited = [&command[..], &["--limit-seconds", "0.2"]].concat();
        let (code, error) = folder.run(&limited);
        assert!(code == Some(4) && error.contains("time limit"), "{code:?}: {error}");
        assert_eq!(folder.names(), names);
        let table = folder.text("a.csv");
        let lines: Vec<&str> = table.lines().collect();
        assert!(table.ends_with('\n') && (2..8_000_000).contains(&lines.len()), "{}", lines.len());
        let fields = |line: &&str| line.split(',').count();
        assert!(lines.iter().all(|line| fields(line) == fields(&lines[0])));
        assert!(names.len() < 2 || folder.text("a.svg").ends_with("</svg>\n"));
        names.iter().for_each(|name| std::fs::remove_file(folder.0.join(name)).unwrap());
    }
}

/// A motion that is broken off is shown up to there, with the errors that two integrations tell where both came.
#[test]
fn what_is_finished_of_a_motion_is_kept() {
    let folder = Folder::new("motion-kept");
    let line = ["simulate", "duffing", "--set", "eps=1", "--digits", "60", "--until", "100000"];
    let times = ["--times", "1,2,100000", "--limit-seconds", "0.3", "--format", "json"];
    let output = folder.program(&[&line[..], &times].concat()).output().unwrap();
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(4), "{found}");
    assert_eq!((&found["complete"], &found["error"]), (&false.into(), &serde_json::Value::Null));
    // Nothing is known of the errors where the second integration never began.
    assert_eq!(found["samples"].as_array().unwrap().len(), 2, "{found}");
    assert_eq!(found["samples"][0]["x"]["status"], "no-estimate", "{found}");
    assert!(found["samples"][0]["x"]["error"].is_null());
}

/// Predictions refuse only what needs more than twice the limit, in the units of the limit (713 MB were measured).
#[test]
fn predictions_of_memory_refuse_what_is_far_beyond() {
    let folder = Folder::new("predicted");
    let asked = |limit| {
        let line = ["derive", "power-law", "--order", "30", "--limit-seconds", "0.02"];
        let (code, error) = folder.run(&[&line[..], &["--limit-memory", limit]].concat());
        assert_eq!(code, Some(4), "{error}");
        error
    };
    assert!(asked("350M").contains("time limit"));
    let refused = asked("40M");
    assert!(refused.contains("is predicted to need") && refused.contains("40 MiB"), "{refused}");
    let (code, error) = folder.run(&["derive", "pendulum", "--order", "100000"]);
    assert_eq!(code, Some(4));
    assert!(error.contains("need 10^583 MiB, the limit is 8192 MiB"), "{error}");
    for (size, shown) in [("5GB", "5120"), ("20480kb", "20"), ("512M", "512"), ("70", "0.0")] {
        let line = ["derive", "pendulum", "--order", "100000", "--limit-memory", size];
        let (_, error) = folder.run(&line);
        assert!(error.contains(&format!("the limit is {shown} MiB")), "{size}: {error}");
    }
    for size in ["", "G", "many", "99999999999999G"] {
        assert_eq!(folder.run(&["problems", "--limit-memory", size]).0, Some(2), "{size}");
    }
}

/// The most memory of its own (without pages of files) that a program had while it ran, in MiB, and how it ended.
fn peak(command: &mut Command) -> (u64, Option<i32>) {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let mut most = 0;
    loop {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
        let status = status.unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:"));
        let size = line.and_then(|text| text.trim_end_matches("kB").trim().parse().ok());
        most = size.unwrap_or(0u64).max(most);
        if let Some(status) = child.try_wait().unwrap() {
            return (most >> 10, status.code());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The limit of memory is kept within a fifth, and the work under it ends as one that is stopped; on a busy
/// machine the watch looks later (four tenths).
#[test]
fn memory_is_counted() {
    let folder = Folder::new("memory");
    for command in [
        &["simulate", "van-der-pol", "--digits", "10000", "--until", "1"][..],
        &["evaluate", "x'' + x + eps*x^1000 = 0", "--set", "eps=1/10"],
    ] {
        let (most, code) =
            peak(&mut folder.program(&[command, &["--limit-memory", "40M"]].concat()));
        assert!(most > 30, "{command:?} is no test of it: {most} MiB");
        assert!(most <= 56, "{command:?}: {most} MiB");
        assert_eq!(code, Some(4), "{command:?}");
    }
}

/// Under a limit of the shell the program ends before GMP does.
#[test]
fn the_limit_of_the_process_counts() {
    let folder = Folder::new("space");
    for command in [
        &["simulate", "van-der-pol", "--digits", "10000", "--until", "1"][..],
        &["evaluate", "x'' + x + eps*x^1000 = 0", "--set", "eps=1/10", "--limit-seconds", "2"],
    ] {
        let output = folder.under("-v 400000", command);
        assert_eq!(output.status.code(), Some(4), "{output:?}");
    }
    assert_eq!(folder.under("-v 400000", &["derive", "duffing"]).status.code(), Some(0));
}
