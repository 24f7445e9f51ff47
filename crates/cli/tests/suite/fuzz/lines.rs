//! Random command lines, a process each: only so is an exit code one.

use super::{count, not_a_number, number, refusal};
use lindstedt_tests::Random;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

const VERBS: [&str; 9] = [
    "derive", "evaluate", "threshold", "stability", "simulate", "verify", "respond", "problems",
    "trade",
];
const PROBLEMS: [&str; 32] = [
    "duffing",
    "van-der-pol",
    "power-law",
    "pendulum",
    "stick-slip",
    "vibro-impact",
    "duffing",
    "van-der-pol",
    "docs/examples/rayleigh.toml",
    "docs/examples/holmes-duffing.toml",
    "docs/examples/wright.toml",
    "docs/examples/escape.toml",
    "docs/examples/impact-spring.toml",
    "docs/examples/delayed-duffing.toml",
    "docs/examples/forced-duffing.toml",
    "docs/examples/pendulum-spring.toml",
    "nothing.toml",
    "no such thing",
    "",
    "x'' + x + eps*x^3 = 0",
    "x'' + x = eps*(1 - x^2)*x'",
    "x'' + x + eps*x^2",
    "x'' - x + x^3 = eps*(cos(2*t) - x')",
    "x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)",
    "x'' + x + eps*x(t - 1) = 0",
    "x'' + k*x + eps*x^3",
    "x'' + x + x^3 = 0",
    "x'' + x + eps*x*y; y'' + 4*y + eps*x^2",
    "x'' + x/0 = 0",
    "x''",
    "x'' + sin(x) = 0",
    "x'' + (x^2)^eps*x = 0",
];
const NAMES: [&str; 20] = [
    "eps", "amplitude", "n", "delta", "k", "omega", "vstar", "gamma", "alpha", "beta", "T0", "a",
    "b", "A", "B", "R_r", "s", "sigma", "F", "nothing",
];
const VALUES: [&str; 28] = [
    "0", "1", "-1", "1/10", "1/2", "3", "0.4", "-0.3", "10", "1e-6", "1e6", "1e-300", "1e300",
    "pi", "pi/4", "1/0", "nan", "inf", "", "x", "1e999999999", "2.5e-3", "-5/3", "99/100",
    "1000001/1000000", "+", "-", "7/2",
];
const RANGES: [&str; 12] = [
    "0..1:3", "-1..1:5", "1..0:3", "0..1", "1/10,1/5", "0..0:2", "0..1:0", "0..1e9:3",
    "1..2:100000000", "..", "a..b:c", "1/2..2:2",
];
const COUNTS: [&str; 12] = ["0", "1", "2", "3", "4", "6", "9", "12", "-1", "1000000000", "x", "17"];

/// A random line.
fn line(g: &mut Random) -> Vec<String> {
    let verb = if g.once_in(60) { "frobnicate" } else { g.pick(&VERBS) };
    let mut list = vec![verb.to_owned()];
    if verb == "problems" {
        if !g.once_in(4) {
            list.extend(["--show".to_owned(), g.pick(&PROBLEMS).to_owned()]);
        }
        return list;
    }
    if !g.once_in(50) {
        list.push(g.pick(&PROBLEMS).to_owned());
    }
    for _ in 0..g.below(4) {
        list.extend(["--set".to_owned(), format!("{}={}", g.pick(&NAMES), g.pick(&VALUES))]);
    }
    for _ in 0..g.below(4) {
        list.extend(option(g, verb));
    }
    list
}

/// An option, most often one of the verb.
fn option(g: &mut Random, verb: &str) -> Vec<String> {
    let named = |name: &str, value: String| vec![name.to_owned(), value];
    let of = |name: &str, g: &mut Random, list: &[&str]| named(name, g.pick(list).to_owned());
    let swept = |name: &str, g: &mut Random| {
        let range = format!("{}={}", g.pick(&NAMES), g.pick(&RANGES));
        named(name, range)
    };
    match (g.below(8), verb) {
        (0, _) => of("--digits", g, &["1", "8", "12", "30", "60", "0", "10001", "-3", "x"]),
        (1, _) => vec!["--f64".to_owned()],
        (2, _) => of("--order", g, &COUNTS),
        (3, "derive" | "evaluate" | "verify" | "trade") => {
            of("--normalisation", g, &["initial", "fundamental", "free", "x"])
        }
        (4, "derive") => of("--tier", g, &["exact", "collocation", "fourier"]),
        (6, "derive") => of("--only", g, &["frequency", "frequenzy"]),
        (5, "derive") => of("--route", g, &["auto", "driver", "clock", "energy"]),
        (4, "evaluate") => of(
            "--resum",
            g,
            &["none", "pade", "uniform", "uniform-pade", "conformal", "borel-pade", "auto"],
        ),
        (5, "evaluate") => of("--times", g, &["0..1:3", "0..1e300:2", "1..0:2", "-1..1:2", "0..1"]),
        (6, "evaluate") => vec!["--prove".to_owned()],
        (7, "evaluate") => of("--code", g, &["rust", "python", "latex", "c"]),
        (4 | 5, "threshold") => {
            let range = format!(
                "{}={}",
                g.pick(&NAMES),
                g.pick(&["0..1", "-1..1", "1..0", "0..2", "1/2..1/2", "x..y"])
            );
            named("--zeros", range)
        }
        (6, "threshold") => of("--subharmonics", g, &COUNTS),
        (3, "stability") => of("--predictor", g, &["kbm", "exact", "both"]),
        (4, "stability") => of("--variant", g, &["E", "S", "P", "impact-aware"]),
        (5, "stability") => of("--kick", g, &["none", "mean", "before", "after"]),
        (3, "simulate") => of("--until", g, &["1", "0", "-1", "1e-300", "1e300", "3", "x"]),
        (4, "simulate") => of("--state", g, &["1,0", "0,0", "1e200,0", "-1/2,1/10", "1", "x,y"]),
        (5, "simulate") => of("--section", g, &["velocity", "impact", "stroboscopic", "x"]),
        (6, "simulate") => of("--periods", g, &COUNTS),
        (3, "respond") => of("--start", g, &["0,0", "1,1", "x"]),
        (4, "respond") => of("--box", g, &["1", "0", "-1", "1e300", "3", "x"]),
        (4, "verify") => {
            of("--small", g, &["1/10,1/20", "1/100,1/200,1/400", "0,1", "1e300,1", "1", "x"])
        }
        (4 | 5, "trade") => of("--orders", g, &["2", "2,4", "0", "x"]),
        (7, "simulate") => of("--times", g, &["0..1:3", "0..1:100000000", "5..1:3"]),
        _ => swept("--sweep", g),
    }
}

/// The codes of the contract; nobody interrupts.
const CONTRACT: [i32; 5] = [0, 2, 3, 4, 5];
/// What no line may take, on the busiest machine.
const HANG: Duration = Duration::from_secs(20);

/// What is wrong with the end of a command line, if anything.
fn defect(list: &[String], format: &str, limit: &str) -> Option<String> {
    let child = Command::new(env!("CARGO_BIN_EXE_lindstedt"))
        .args(list)
        .args(["--quiet", "--format", format, "--limit-seconds", limit, "--limit-memory", "512M"])
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let (shown, said) =
        (String::from_utf8_lossy(&child.stdout), String::from_utf8_lossy(&child.stderr));
    let Some(code) = child.status.code() else { return Some("a signal".to_owned()) };
    if said.contains("panicked") || !CONTRACT.contains(&code) {
        return Some(format!("exit {code}: {said}"));
    }
    let question = list.join(" ");
    if let Some(word) = not_a_number(&shown, &question) {
        return Some(format!("{word} as a result"));
    }
    if format == "json" {
        let refused = refusal(&shown);
        if let Some((code, _, hint)) = &refused
            && (code.is_empty() || hint.is_empty())
        {
            return Some(format!("no hint for {code}"));
        }
        if code == 0 && refused.is_some() || code == 2 && refused.is_none() {
            return Some(format!("exit {code} of {shown}"));
        }
    } else if code == 2 && !said.trim_end().ends_with(')') {
        return Some(format!("no hint: {said}"));
    }
    None
}

/// Runs so many lines on all cores.
fn attack(seed: u64, count: usize, limit: &'static str) {
    let mut g = Random(seed);
    let lines: Vec<(Vec<String>, &str)> = (0..count)
        .map(|_| (line(&mut g), g.pick(&["json", "json", "text", "latex", "markdown"])))
        .collect();
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some((list, format)) = lines.get(next.fetch_add(1, Ordering::Relaxed)) {
            let start = Instant::now();
            let defect = defect(list, format, limit);
            let slow = (start.elapsed() > HANG).then(|| format!("took {:?}", start.elapsed()));
            if let Some(what) = defect.or(slow) {
                found.lock().unwrap().push(format!("{list:?} --format {format}: {what}"));
            }
        }
    };
    let threads = std::thread::available_parallelism().map_or(2, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    let found = found.into_inner().unwrap();
    assert!(found.is_empty(), "{} of {count}:\n{}", found.len(), found.join("\n"));
}

#[test]
fn any_line_ends_in_an_answer_or_a_refusal() {
    attack(1, 500, "0.03");
}

#[test]
#[ignore = "15 000 lines, for the night"]
fn many_lines() {
    attack(number("LINDSTEDT_SEED").unwrap_or(1000), count(15_000), "0.2");
}
