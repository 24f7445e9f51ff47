//! Every code of the table of errors: the line that meets it, its exit code, its hint, and the line that
//! the hint leads to, which has an answer.

use super::fuzz::refusal;
use crate::program::{command, root, words};
use std::collections::BTreeSet;
use std::process::Output;

fn run(line: &str) -> Output {
    let arguments = [&words(line)[..], &["--quiet", "--format", "json"]].concat();
    command(&arguments).current_dir(root()).output().unwrap()
}

/// Exit code, code, line; what the hint says of the way on; the line it leads to.
const TABLE: &[(i32, &str, &str, &str, &str)] = &[
    (2, "usage", "derive duffing --order x", "--help", "--help"),
    (2, "set", "derive duffing --set a", "--set", "derive duffing --order 1 --set amplitude=1/2"),
    (
        2,
        "set",
        "derive duffing --set eps=1 --set eps=2",
        "once",
        "derive duffing --order 1 --set eps=2",
    ),
    (
        2,
        "bad-value",
        "derive duffing --set amplitude=nan",
        "exact",
        "derive duffing --order 1 --set amplitude=2.5e-3",
    ),
    (
        2,
        "parameter",
        "stability vibro-impact --set k=1/2",
        "k=1",
        "stability vibro-impact --set k=1 --f64 --predictor kbm",
    ),
    (2, "parameter", "stability vibro-impact --set P0=0", "problems", "problems"),
    (
        3,
        "no-proof",
        "evaluate docs/examples/sign-power.toml --set delta=1/10 --prove",
        "without --prove",
        "evaluate docs/examples/sign-power.toml --set delta=1/10 --order 8",
    ),
    (
        3,
        "first-order",
        "simulate \"x' + alpha*x(t-1)*(1+x) = 0\"",
        "--unknown",
        "derive \"x' + alpha*x(t-1)*(1+x) = 0\" --unknown alpha",
    ),
    (3, "no-hopf-point", "derive \"x' + a*x^2 + x = 0\" --unknown a", "--set NAME=VALUE", ""),
    (
        2,
        "second-unknown",
        "derive \"x'' + x + eps*x*y\" --order 1",
        "`;`",
        "derive \"x'' + x + eps*x*y; y'' + 4*y\" --order 1",
    ),
    (2, "unknown-problem", "derive frobnicate", "duffing", "derive duffing --order 1"),
    (
        2,
        "unknown-parameter",
        "derive duffing --set nothing=1",
        "problems --show",
        "problems --show duffing",
    ),
    (2, "unknown-parameter", "derive \"x'' + x + eps*x^3\" --set k=1/10", "problems", "problems"),
    (2, "unknown-normalisation", "derive van-der-pol --normalisation initial", "condition", ""),
    (
        2,
        "no-value-set",
        "evaluate \"x'' + x + eps*x^3\"",
        "1/10",
        "evaluate \"x'' + x + eps*x^3\" --set eps=1/10",
    ),
    (
        2,
        "no-value-set",
        "derive \"x'' + x + eps*k*x^3\" --order 1",
        "--normalisation free",
        "derive \"x'' + x + eps*k*x^3\" --order 1 --normalisation free",
    ),
    (
        2,
        "not-among-symbols",
        "derive vibro-impact --order 1 --set A=pi --normalisation free",
        "leave this one open",
        "derive vibro-impact --order 1",
    ),
    (
        2,
        "order",
        "threshold stick-slip --order 3",
        "--unknown mu",
        "threshold \"x'' - x + x^3 = eps*(mu - x^2)*x'\" --unknown mu --order 4",
    ),
    (
        2,
        "digits",
        "derive duffing --digits 0",
        "--digits 30",
        "derive duffing --order 1 --digits 30",
    ),
    (4, "digits", "derive duffing --digits 20000", "fewer", "derive duffing --order 1 --digits 20"),
    (
        2,
        "range",
        "threshold stick-slip --zeros nothing",
        "NAME=LO..HI",
        "threshold stick-slip --zeros vstar=0..1 --digits 8",
    ),
    (
        2,
        "range",
        "threshold stick-slip --sweep vstar=0..1:3 --sweep vstar=0..1:3",
        "different parameters",
        "threshold stick-slip --sweep vstar=0..1:3 --sweep b=1,2 --digits 8",
    ),
    (
        2,
        "sweep",
        "threshold stick-slip --sweep vstar=0..1",
        "COUNT",
        "threshold stick-slip --sweep vstar=0..1:3 --digits 8",
    ),
    (
        3,
        "resonance",
        "respond \"x'' + x + eps*(x'/5 + x^3) = F*cos(omega*t)\" --set F=1 --set eps=1/10 --sweep omega=0.95..1.1",
        "eps*F",
        "respond \"x'' + x + eps*(x'/5 + x^3) = eps*F*cos(omega*t)\" --set F=1 --set eps=1/10 --set omega=1 --order 1",
    ),
    (3, "resonance", "derive \"x'' + x + eps*x^3 = F*cos(t)\"", "eps*F", ""),
    (
        3,
        "no-expansion",
        "derive \"x'' + x + eps*(s*x + x^3 + 3/10*x') = eps*cos(t)/50\" --unknown s",
        "amplitude=VALUE",
        "derive \"x'' + x + eps*(s*x + x^3 + 3/10*x') = eps*cos(t)/50\" --unknown s --set amplitude=1/15 --order 1",
    ),
    (
        3,
        "no-method",
        "derive \"x'' + (a + eps*cos(2*omega*t))*x\" --set a=1 --set omega=1 --unknown omega",
        "--unknown of a factor",
        "derive \"x'' + (a + eps*cos(2*omega*t))*x\" --set a=1 --set omega=1 --unknown a --order 1",
    ),
    (
        3,
        "no-rational-modes",
        "respond \"x'' + 2*x + eps*(x'/5 + x^3) = eps*F*cos(omega*t)\" --set F=1 --set eps=1/10 --sweep omega=1.4..1.6",
        "cos((sqrt(2) + eps*sigma)*t)",
        "respond \"x'' + 2*x + eps*(x'/5 + x^3) = eps*F*cos((sqrt(2) + eps*sigma)*t)\" --set F=1 --set eps=1/10 --sweep sigma=0,1 --order 1",
    ),
    (
        3,
        "no-response",
        "respond \"x'' + 2*x + eps*(x'/5 + x^3) = eps*F*cos(omega*t)\" --set F=1 --set eps=1/10 --set omega=3/2",
        "cos((sqrt(2) + eps*sigma)*t)",
        "",
    ),
    (2, "until", "simulate duffing --until -1", "", ""),
    (2, "impacts", "simulate duffing --impacts 3", "", ""),
    (
        2,
        "section",
        "simulate duffing --section impact",
        "--section velocity",
        "simulate duffing --section velocity --until 3 --f64",
    ),
    (2, "skip", "simulate duffing --skip 3", "", ""),
    (
        2,
        "state",
        "simulate duffing --state 1",
        "--state 1,-1/2",
        "simulate duffing --state 1,-1/2 --until 1 --f64",
    ),
    (
        2,
        "perturb",
        "simulate duffing --perturb 1e-6",
        "--state",
        "simulate duffing --state 1,0 --until 1 --f64",
    ),
    (
        2,
        "chaos",
        "simulate van-der-pol --set eps=1 --lyapunov --periods 50 --skip 10",
        "--periods",
        "",
    ),
    (2, "start", "evaluate pendulum --start 1,0", "--normalisation free", ""),
    (
        2,
        "averaged",
        "evaluate van-der-pol --normalisation free --set eps=1/10 --start 1,0 --times 0..1:2 --resum pade",
        "--order",
        "evaluate van-der-pol --normalisation free --set eps=1/10 --start 1,0 --times 0..1:2 --order 2",
    ),
    (
        2,
        "small",
        "verify duffing --small 0,1",
        "1/100,1/200",
        "verify duffing --order 1 --small 1/100,1/200,1/400",
    ),
    (
        2,
        "route-and-tier",
        "derive duffing --route energy --tier collocation",
        "drop",
        "derive duffing --order 1 --route energy",
    ),
    (
        2,
        "route-and-tier",
        "derive \"x'' + x = eps*(1 - x^2)*x'\" --normalisation free --tier collocation",
        "drop",
        "derive \"x'' + x = eps*(1 - x^2)*x'\" --order 1 --normalisation free",
    ),
    (2, "plot", "evaluate duffing --plot x.png", ".svg", ""),
    (
        2,
        "problem-file",
        "derive \"x'' + x +\"",
        "problems --show duffing",
        "problems --show duffing",
    ),
    (3, "outside-domain", "derive pendulum --set amplitude=4", "problems", "problems"),
    (
        3,
        "no-expansion",
        "derive \"x'' + x + x^3 = eps*cos(t)\"",
        "lindstedt simulate",
        "simulate \"x'' + x + x^3 = eps*cos(t)\" --set eps=1 --state 1,0 --until 1 --f64",
    ),
    (
        3,
        "no-method",
        "derive \"x'' + x + x(t - 1) + eps*x^3\"",
        "eps*x(t - T)",
        "derive \"x'' + x + eps*x(t - 1) + eps*x^3\" --order 1",
    ),
    (
        3,
        "no-expansion",
        "evaluate \"x'' + x + eps*x^3 = eps*cos((1 + eps*sigma)*t)\" --set eps=1/10 --set sigma=1",
        "lindstedt derive",
        "derive \"x'' + x + eps*x^3 = eps*cos((1 + eps*sigma)*t)\" --order 1",
    ),
    (
        3,
        "no-method",
        "derive \"x'' + x + x'/5 + eps*x^3\"",
        "lindstedt simulate",
        "simulate \"x'' + x + x'/5 + eps*x^3\" --set eps=1 --state 1,0 --until 1 --f64",
    ),
    (
        3,
        "no-method",
        "derive \"x'' - x + eps*x^3\"",
        "saddle",
        "simulate \"x'' - x + eps*x^3\" --set eps=1 --state 1,0 --until 1 --f64",
    ),
    (
        3,
        "no-method",
        "derive \"x'' + x*(1 - eps*x'^2)^(3/2)\"",
        "",
        "derive \"x'' + x*taylor((1 - eps*x'^2)^(3/2), 9)\" --order 1",
    ),
    (
        3,
        "no-method",
        "derive \"x'' + x = eps*x'\"",
        "--normalisation free",
        "derive \"x'' + x = eps*x'\" --order 1 --normalisation free",
    ),
    (3, "no-method", "threshold duffing", "lindstedt simulate", "simulate duffing --until 1"),
    (
        3,
        "no-such-route",
        "derive van-der-pol --route energy",
        "--route driver",
        "derive van-der-pol --order 1 --route driver",
    ),
    (3, "resonance", "evaluate \"x'' + x = eps*x*cos(2*t)\" --set eps=1/10", "off resonance", ""),
    (
        2,
        "symbol-taken",
        "derive \"x'' + x + eps*(x'/5 + E*x^3) = eps*E*cos(t)\" --order 1",
        "--set",
        "derive \"x'' + x + eps*(x'/5 + F*x^3) = eps*F*cos(t)\" --order 1",
    ),
    (
        2,
        "symbol-taken",
        "derive \"x'' + x + eps*a*x^2*x' - eps*b*x'\" --order 1 --normalisation free",
        "another name",
        "derive \"x'' + x + eps*c*x^2*x' - eps*b*x'\" --order 1 --normalisation free",
    ),
    (
        2,
        "symbol-taken",
        "derive \"x'' + 2*x - y + eps*rho*x^3; y'' + 2*y - x\" --mode 1 --order 1",
        "another name",
        "derive \"x'' + 2*x - y + eps*c*x^3; y'' + 2*y - x\" --mode 1 --order 1",
    ),
    (
        2,
        "symbol-taken",
        "derive \"x'' + 5*x - 4*y + eps*q_1*x^2; y'' + 5*y - 4*x\" --order 1",
        "another name",
        "derive \"x'' + 5*x - 4*y + eps*c*x^2; y'' + 5*y - 4*x\" --order 1",
    ),
    (
        2,
        "ratio-not-known",
        "derive \"x'' + omega1^2*x + eps*x*y; y'' + omega2^2*y + eps*x^2\" --order 1",
        "(2*omega0)^2*y",
        "derive \"x'' + omega1^2*x + eps*x*y; y'' + (2*omega1)^2*y + eps*x^2\" --order 1",
    ),
    (
        3,
        "ratio-not-rational",
        "derive \"x'' + x + eps*x^3 = eps*cos(sqrt(2)*t)\" --order 1",
        "cos(omega*t)",
        "derive \"x'' + x + eps*x^3 = eps*cos(omega*t)\" --order 1",
    ),
    (
        3,
        "detuning-not-small",
        "derive \"x'' + x + eps*x^3 = eps*cos((1 + sigma)*t)\" --order 1",
        "cos((1 + eps*sigma)*t)",
        "derive \"x'' + x + eps*x^3 = eps*cos((1 + eps*sigma)*t)\" --order 1",
    ),
    (
        2,
        "undeclared-parameter",
        "derive \"x'' + x + eps*x^3 = eps*cos(w*t)\" --order 1",
        "omega",
        "derive \"x'' + x + eps*x^3 = eps*cos(omega*t)\" --order 1",
    ),
    (
        3,
        "near-miss",
        "derive \"x'' + x + eps*x^3 = F*cos(1000001/1000000*t)\" --order 1",
        "eps*sigma*x",
        "derive \"x'' + x + eps*(sigma*x + x^3) = eps*F*cos(t)\" --order 1",
    ),
    (
        3,
        "near-miss",
        "derive \"x'' + x + eps*x*y; y'' + 4.000004000001*y + eps*x^2\" --order 1",
        "eps*sigma*x",
        "derive \"x'' + x + eps*x*y; y'' + 4*y + eps*sigma*y + eps*x^2\" --order 1",
    ),
    (
        3,
        "no-rational-modes",
        "derive \"x'' + 2*x - y + eps*x^3/2; y'' + y - x; z'' + 2*z - w; w'' + w - z\" --mode 1 --order 1",
        "without --mode",
        "derive \"x'' + 2*x - y + eps*x^3/2; y'' + y - x\" --order 1",
    ),
    (
        3,
        "no-rational-modes",
        "derive \"x'' + (2 + eps*a + eps*cos(2*sqrt(2)*t))*x\" --unknown a",
        "with s = sqrt(2)*t the equation is divided by sqrt(2)^2",
        "derive \"x'' + (1 + eps*a/2 + eps*cos(2*t)/2)*x\" --unknown a --order 1",
    ),
    (
        3,
        "no-expansion",
        "derive \"x'' + 2*omega0^2*x + eps*x^3\" --normalisation free --order 1",
        "omega0^2*x in the place of",
        "derive \"x'' + omega0^2*x + eps*x^3\" --normalisation free --order 1",
    ),
    (
        3,
        "not-diagonalisable",
        "derive \"x'' + x + y; y'' + y + eps*x^3\" --order 1",
        "differ a little",
        "derive \"x'' + x + y; y'' + 4*y + eps*x^3\" --order 1",
    ),
    (
        3,
        "second-phase",
        "derive \"x'' + a*x = eps*x*cos(t) + eps*x*cos((1 + eps*s)*t)\" --unknown a --set a=1/4",
        "one omega",
        "",
    ),
    (
        3,
        "several-unknowns",
        "evaluate \"x'' + x + eps*x*y; y'' + 4*y + eps*x^2\" --set eps=1/10",
        "lindstedt derive",
        "derive \"x'' + x + eps*x*y; y'' + 4*y + eps*x^2\" --order 1",
    ),
    (
        3,
        "no-start",
        "evaluate van-der-pol --normalisation free --state 1e300,0 --times 0..1:2 --set eps=1/10",
        "--start",
        "evaluate van-der-pol --normalisation free --start 1,0 --times 0..1:2 --set eps=1/10 --order 2",
    ),
    (
        3,
        "no-such-resummation",
        "evaluate duffing --set eps=1/10 --order 8 --resum conformal",
        "--resum auto",
        "evaluate duffing --set eps=1/10 --order 8 --resum auto",
    ),
    (
        3,
        "no-orbit",
        "stability vibro-impact --set s=10",
        "lindstedt simulate",
        "simulate vibro-impact --set s=10 --state 0,0 --until 1 --f64",
    ),
    (
        3,
        "no-history",
        "simulate vibro-impact --set A=1/10 --history free-flight --set c=100",
        "--history",
        "simulate vibro-impact --set A=1/10 --history constant --set c=100 --until 1 --state -1,0 --f64",
    ),
    (
        3,
        "no-trajectory",
        "simulate \"x'' + ln(x)\" --state -1,0 --until 1",
        "another start",
        "simulate \"x'' + ln(x)\" --state 1,0 --until 1 --f64",
    ),
    (
        3,
        "no-truncated-frequency",
        "verify duffing --order 1 --small -100,-50",
        "smaller --small",
        "verify duffing --order 1 --small 1/100,1/200,1/400",
    ),
    (
        3,
        "no-response",
        "respond van-der-pol",
        "evaluate",
        "evaluate van-der-pol --set eps=1/10 --digits 8",
    ),
    (
        2,
        "box",
        "respond \"x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)\" --set eps=1/10 --set F=1/2 --set sigma=1 --box 0",
        "--box 2",
        "respond \"x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)\" --set eps=1/10 --set F=1/2 --set sigma=1 --box 2 --order 1",
    ),
    (
        4,
        "too-large",
        "derive duffing --order 40 --limit-memory 1M",
        "--limit-memory",
        "derive duffing --order 4 --limit-memory 100M",
    ),
    (
        4,
        "limit-seconds",
        "derive duffing --order 300 --limit-seconds 0.001",
        "--order",
        "derive duffing --order 3",
    ),
    (5, "file", "derive nothing.toml", "path", ""),
    (5, "file", "evaluate duffing --order 4 --out no-such-folder/x", "path", ""),
];

/// Codes of the table that no single quick line meets, and why.
const ELSEWHERE: [(&str, &str); 24] = [
    ("could-not-decide", "a degenerate point: the tests of thresholds and impacts"),
    ("figure", "a warning beside the answer: the tests of outputs"),
    ("follow", "the tests of `respond`"),
    ("format", "the tests of outputs"),
    ("hung-up", "a signal: the tests of interruption"),
    ("initial-data", "a file: the tests of problem files"),
    ("internal-resonance", "the tests of normal modes"),
    ("interrupted", "Ctrl-C: the tests of interruption"),
    ("irrational", "a file with pi among its values"),
    ("limit-memory", "the tests of interruption"),
    ("no-answer", "files of Melnikov's method"),
    ("no-periodic-orbit", "the tests of `verify`"),
    ("no-reference", "the tests of `trade`"),
    ("no-series", "a motion whose maxima cease"),
    ("no-such-mode", "the tests of normal modes"),
    ("no-value", "the tests of `evaluate`"),
    ("not-enough-digits", "the extremes"),
    ("not-evaluated", "the tests of files with a wall"),
    ("out-of-primes", "more than a minute"),
    ("same-file", "the tests of outputs"),
    ("terminated", "a signal: the tests of interruption"),
    ("times", "the tests of `simulate`"),
    ("too-many-symbols", "the tests of slow flows"),
    ("undecided", "the tests of stability"),
];

#[test]
fn every_error_leads_on() {
    let mut wrong = Vec::new();
    for &(exit, code, line, way, next) in TABLE {
        let output = run(line);
        let shown = String::from_utf8_lossy(&output.stdout).into_owned();
        let found = refusal(&shown);
        let Some((met, message, hint)) = found else {
            wrong.push(format!("{line}: no refusal, exit {:?}", output.status.code()));
            continue;
        };
        if (output.status.code(), &*met) != (Some(exit), code) {
            wrong.push(format!("{line}: {met}, exit {:?}: {message}", output.status.code()));
        }
        if hint.is_empty() || !hint.contains(way) {
            wrong.push(format!("{line}: {message}\n   hint {hint:?} without {way:?}"));
        }
        if !next.is_empty() && !run(next).status.success() {
            wrong.push(format!("{line}: the hint leads to {next}, which has no answer"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A code of the book stands in the table above, or where it is tested is said.
#[test]
fn every_code_of_the_book_is_met() {
    let page = std::fs::read_to_string(root().join("docs/src/reference/errors.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let codes: BTreeSet<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    let met: BTreeSet<&str> =
        TABLE.iter().map(|row| row.1).chain(ELSEWHERE.iter().map(|row| row.0)).collect();
    let missing: Vec<&&str> = codes.symmetric_difference(&met).collect();
    assert!(codes.len() > 50 && missing.is_empty(), "{missing:?}");
}
