//! What the program costs, as tables that can be kept and compared between commits:
//! `cargo run --release -p lindstedt-tests --bin measure -- times` (or another word of `USAGE`).

use lindstedt_tests::budget;
use lindstedt_tests::measure::{Rows, benches, comparison, exponent, instructions, stored, table};
use std::error::Error;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

type Outcome<T> = Result<T, Box<dyn Error>>;

const USAGE: &str =
    "usage: measure times [FILTER] | instructions | costs | exponents | compare BEFORE AFTER
     | tests [FILTER] | budget PROGRAM [ARGUMENT..]
  times         all benches, seconds of the fastest sample
  instructions  whole commands under valgrind, instructions on one core
  costs         the tables of cost in the book: CPU seconds (least of three) and memory
  exponents     instructions of the collocation tier against order and digits
  compare       two stored tables
  tests         every test alone, CPU seconds, the dearest last; those whose name has FILTER in it
  budget        an executable of tests, held against the most that one may cost: a cargo runner";

/// Whole commands, a second or two each, one per hot path.
const COMMANDS: [&str; 13] = [
    "derive duffing --order 50",
    "derive van-der-pol --order 40",
    "derive power-law --order 8",
    "derive power-law --route energy --order 16",
    "derive power-law --tier collocation --order 20 --digits 30",
    "derive power-law --tier fourier --order 20",
    "derive pendulum --order 6",
    "derive vibro-impact --order 3",
    "evaluate duffing --set eps=1/2 --digits 12",
    "stability vibro-impact --sweep A=-0.3..0.3:41 --sweep B=-0.3..0.3:41 --f64",
    "simulate stick-slip --periods 10 --digits 16",
    "threshold stick-slip --set b=5 --zeros vstar=0..1 --digits 100",
    "problems --show docs/examples/helmholtz-duffing.toml",
];

/// The derivations whose cost the pages of the problems, of the tiers and the README state.
const COSTS: [(&str, &[u32]); 8] = [
    ("duffing", &[20, 50, 100, 200]),
    ("van-der-pol", &[24, 40, 80, 120, 164]),
    ("power-law", &[8, 10, 12, 14, 16, 20]),
    ("power-law --route energy", &[30]),
    ("pendulum", &[6, 8, 10]),
    ("power-law --tier collocation --digits 25", &[60]),
    ("power-law --tier collocation --digits 50", &[30, 60, 100]),
    ("power-law --tier collocation --digits 100", &[50, 100]),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["times"] => print!("{}", table(&times(None)?)),
        ["times", filter] => print!("{}", table(&times(Some(filter))?)),
        ["instructions"] => {
            let Some(valgrind) = Valgrind::new()? else { return Ok(()) };
            for command in COMMANDS {
                print!("{}", table(&vec![(command.to_owned(), valgrind.count(command)?)]));
            }
        }
        ["costs"] => costs()?,
        ["exponents"] => {
            let Some(valgrind) = Valgrind::new()? else { return Ok(()) };
            exponents(&valgrind)?;
        }
        ["compare", before, after] => {
            let read = |path: &str| std::fs::read_to_string(path).map(|text| stored(&text));
            print!("{}", comparison(&read(before)?, &read(after)?));
        }
        ["tests"] => tests("")?,
        ["tests", filter] => tests(filter)?,
        ["budget", ..] => {
            let arguments: Vec<_> = std::env::args_os().skip(2).collect();
            let (program, arguments) = arguments.split_first().ok_or(USAGE)?;
            std::process::exit(i32::from(!budget::within(program, arguments)?));
        }
        _ => {
            eprintln!("{USAGE}");
            std::process::exit(2);
        }
    }
    Ok(())
}

/// All benches; what divan prints goes to standard error as it comes.
fn times(filter: Option<&str>) -> Outcome<Rows> {
    let mut bench = Command::new(env!("CARGO"));
    bench.args(["bench", "--workspace"]).current_dir(root()).stdout(Stdio::piped());
    bench.args(filter.iter().flat_map(|filter| ["--", filter]));
    let mut child = bench.spawn()?;
    let mut text = String::new();
    for line in BufReader::new(child.stdout.take().ok_or("no output")?).lines() {
        let line = line?;
        eprintln!("{line}");
        text.push_str(&line);
        text.push('\n');
    }
    if !child.wait()?.success() {
        return Err("cargo bench failed".into());
    }
    Ok(benches(&text))
}

/// Every test alone, the cheapest first, and the sum. What tests share is counted for each.
fn tests(filter: &str) -> Outcome<()> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["test", "--workspace", "--no-run", "--message-format", "json"]);
    let output = build.current_dir(root()).stderr(Stdio::inherit()).output()?;
    let mut rows = Rows::new();
    for (program, folder) in budget::executables(&String::from_utf8(output.stdout)?) {
        let package = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let list = Command::new(&program).args(["--list", "--format", "terse"]).output()?;
        for test in budget::tests(&String::from_utf8(list.stdout)?) {
            let name = format!("{package} {test}");
            if name.contains(filter) {
                let mut run = Command::new(&program);
                run.args(["--exact", test]).current_dir(&folder).stdout(Stdio::null());
                let (_, cost) = budget::run(&mut run)?;
                rows.push((name, cost.ok_or("no CPU times without /proc")?));
            }
        }
    }
    rows.sort_by(|(_, one), (_, other)| one.total_cmp(other));
    rows.push(("all".to_owned(), rows.iter().map(|(_, cost)| cost).sum()));
    print!("{}", table(&rows));
    Ok(())
}

/// The program, built first, beside this one.
fn program() -> Outcome<PathBuf> {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--release", "--quiet", "--package", "lindstedt-cli"]);
    if !build.current_dir(root()).status()?.success() {
        return Err("the program does not build".into());
    }
    let own = std::env::current_exe()?;
    let folder = own.parent().ok_or("no folder")?;
    Ok(folder.join(format!("lindstedt{}", std::env::consts::EXE_SUFFIX)))
}

/// Cachegrind without its simulated caches: it counts instructions, nothing else.
struct Valgrind {
    program: PathBuf,
}

impl Valgrind {
    /// Nothing, with a message, where there is no valgrind.
    fn new() -> Outcome<Option<Self>> {
        if Command::new("valgrind").arg("--version").output().is_err() {
            eprintln!("SKIPPED: no valgrind");
            return Ok(None);
        }
        Ok(Some(Self { program: program()? }))
    }

    fn count(&self, command: &str) -> Outcome<f64> {
        let mut run = Command::new("valgrind");
        run.args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]);
        run.arg(&self.program).args(command.split_whitespace());
        run.args(["--quiet", "--out", "/dev/null"]).current_dir(root());
        // Waiting threads spin: with more than one the count is not reproducible.
        let output = run.env("RAYON_NUM_THREADS", "1").output()?;
        let summary = String::from_utf8_lossy(&output.stderr).into_owned();
        if !output.status.success() {
            return Err(format!("{command}: {summary}").into());
        }
        Ok(instructions(&summary).ok_or("valgrind printed no count")?)
    }
}

/// CPU seconds and memory of the derivations in the tables of the book, by GNU time.
fn costs() -> Outcome<()> {
    let program = program()?;
    for (problem, orders) in COSTS {
        let mut last: Option<(f64, f64)> = None;
        for &order in orders {
            let (mut least, mut memory) = (f64::INFINITY, 0.0);
            for _ in 0..3 {
                let mut run = Command::new("/usr/bin/time");
                run.args(["-f", "%U %S %M"]).arg(&program).arg("derive");
                run.args(problem.split_whitespace()).args(["--order", &order.to_string()]);
                run.args(["--format", "json", "--quiet", "--out", "/dev/null"]);
                let shown = String::from_utf8(run.current_dir(root()).output()?.stderr)?;
                let numbers: Vec<f64> =
                    shown.split_whitespace().filter_map(|word| word.parse().ok()).collect();
                let [user, system, kilobytes] = numbers[..] else { return Err(shown.into()) };
                least = least.min(user + system);
                memory = kilobytes / 1024.0;
            }
            let exponent = last.map_or(String::new(), |last| {
                format!("{:.1}", exponent(last, (f64::from(order), least)))
            });
            println!("{problem} --order {order}\t{least:.2} s\t{memory:.0} MB\t{exponent}");
            last = Some((f64::from(order), least));
        }
    }
    Ok(())
}

/// Instructions at orders and digits, with the exponent from one to the next.
fn exponents(valgrind: &Valgrind) -> Outcome<()> {
    let count = |order: u32, digits: u32| {
        let tier = format!("derive power-law --tier collocation --order {order} --digits {digits}");
        valgrind.count(&tier)
    };
    let mut last = None;
    for order in [10, 20, 40, 80] {
        let found = (f64::from(order), count(order, 30)?);
        show(&format!("order {order}, 30 digits"), found.1, last.replace(found), found);
    }
    let mut last = None;
    for digits in [15, 30, 60, 120] {
        let found = (f64::from(digits), count(20, digits)?);
        show(&format!("order 20, {digits} digits"), found.1, last.replace(found), found);
    }
    Ok(())
}

fn show(name: &str, instructions: f64, last: Option<(f64, f64)>, found: (f64, f64)) {
    let exponent = last.map_or(String::new(), |last| format!("{:.2}", exponent(last, found)));
    println!("{name}\t{instructions:.2e}\t{exponent}");
}
