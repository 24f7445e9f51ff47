//! A hundred problem files that are wrong, or that a method does not take: one clear line each, and the exit
//! code.

use crate::program::{Folder, lindstedt, text};
use serde_json::Value;

/// Equations that are wrong: exit code, equation, a piece of the message.
const EQUATIONS: [(i32, &str, &str); 62] = [
    (2, "", "expected a number, a name or a parenthesis, found the end"),
    (2, "   ", "found the end"),
    (2, "= 0", "found `=`"),
    (2, "x'' + x =", "found the end"),
    (2, "x'' + x = 0 = 0", "a second `=`"),
    (2, "x'' + x = 0; y'' + y = 0", "';' has no meaning"),
    (2, "x'' + x + eps*x^3 = 0, x' = 1", "found `,`"),
    (2, "x'' + x + tan(x)*eps = 0", "the function tan is not taken"),
    (2, "x'' + tan x = 0", "sin(x)/cos(x)"),
    (2, "x'' + sinh(x) = 0", "taylor(sinh(x), 9)"),
    (2, "x'' + asin(x) = 0", "the function asin is not taken"),
    (2, "x'' + bessel(x) = 0", "the function bessel is not taken"),
    (2, "x'' + omga*x = 0", "did you mean omega"),
    (2, "x'' + q*x = 0", "the name q is not declared"),
    (2, "x'' + epsx^3 = 0", "not declared"),
    (2, "x'' + x + eps*nan = 0", "the name nan is not declared"),
    (2, "x'' + x + eps*inf = 0", "the name inf is not declared"),
    (2, "x'' + i*x = 0", "not declared"),
    (2, "x''' + x = 0", "a derivative of order 3"),
    (2, "x'''' + x = 0", "a derivative of order 4"),
    (2, "y'' + y = 0", "the small parameter eps does not occur"),
    (2, "y'' + x = 0", "y is no function of time"),
    (2, "k'*x + x'' = 0", "k is no function of time"),
    (2, "x + eps*x^3 = 0", "neither x'' nor x' occurs"),
    (2, "x' + x = 0", "the small parameter eps does not occur"),
    (2, "x'' - x'' + x = 0", "neither x'' nor x' occurs"),
    (2, "x''*x + x = 0", "x'' inside x''*x"),
    (2, "(1 + x^2)*x'' + x = 0", "x'' inside"),
    (2, "(x'')^2 + x = 0", "x'' inside x''^2"),
    (2, "sin(x'') + x = 0", "x'' inside sin(x'')"),
    (2, "eps*x'' + x = 0", "x'' inside eps*x''"),
    (2, "x'' + (x = 0", "expected `)`"),
    (2, "x'' + x) = 0", "found `)`"),
    (2, "x'' + [x = 0", "expected `]`"),
    (2, "x'' + |x = 0", "expected `|`"),
    (2, "x'' + x + * x = 0", "found `*`"),
    (2, "x'' + x^ = 0", "found `=`"),
    (2, "x'' + x 2 = 0", "found `2`"),
    (2, "x'' + 1..2*x = 0", "found `.2`"),
    (2, "x'' + 0x10*x = 0", "not declared"),
    (2, "x'' + x/0 = 0", "a division by zero"),
    (2, "x'' + x/(1 - 1) = 0", "a division by zero"),
    (2, "x'' + 0^(-1) = 0", "a division by zero"),
    (2, "x'' + 1/2x = 0", "two readings"),
    (2, "x'' + x/omega x = 0", "two readings"),
    (2, "x'' + sin x^2 = 0", "expected `(`"),
    (2, "x'' + sin 2x = 0", "expected `(`"),
    (2, "x'' + x(2 t) = 0", "is not x at an earlier time"),
    (2, "x'' + x(t + T) = 0", "is not x at an earlier time"),
    (2, "x''(t - T) + x'' = 0", "is not x at an earlier time"),
    (2, "x'' + x(t - x) = 0", "is not x at an earlier time"),
    (2, "x'' + (x + 1)(t - T) = 0", "two readings"),
    (2, "x'' + taylor(x, 3) = 0", "no Taylor polynomial of x is known"),
    (2, "x'' + taylor(sin(1 + x), 3) = 0", "does not vanish"),
    (2, "x'' + taylor(sin(x), 1000) = 0", "a whole number from 1 to 99"),
    (2, "x'' + taylor(sin(x)) = 0", "expected a comma"),
    (2, "x'' + x + 3 & x = 0", "'&' has no meaning"),
    (2, "x'' + x + eps*x^3 \u{1f600} = 0", "has no meaning"),
    (4, "x'' + x + eps*x^(10^9) = 0", "more than 1000 as an exponent"),
    (4, "x'' + 9^(9^9)*x = 0", "more than 1000 as an exponent"),
    (4, "x'' + 1e999999999*x = 0", "more than 300 digits"),
    (4, "x'' + ((x^100)^100)^100 = 0", "more than 1000 as an exponent"),
];

/// Equations without an expansion: the reason and the term are said.
const REFUSED: [(&str, &str); 16] = [
    ("x'' + x = F cos(omega t) + eps*x^3", "2:23: -F*cos(omega*t) depends on t"),
    ("x'' + x + eps*sign(x') = 0", "2:27: sign(x') is not smooth"),
    ("x'' + x + eps*|x| = 0", "2:27: abs(x) is not smooth"),
    ("x'' + x + eps*sin(x) = 0", "2:27: sin(x) is no polynomial"),
    ("x'' + sin(x) + eps*x' = 0", "2:19: sin(x) is no polynomial"),
    ("x'' + x + eps*x^(1/3) = 0", "2:27: x^(1/3) is not real everywhere"),
    ("x'' + x^(1 + 2 eps) = 0", "2:19: x^(1 + 2*eps) is not real everywhere"),
    ("x'' + x + eps*ln(x) = 0", "2:27: ln(x) is not real everywhere"),
    ("x'' + x + x^3 = eps*x^5", "2:23: x^3 has no factor eps"),
    ("x'' + x + x' = eps*x^3", "2:23: x' has no factor eps"),
    ("x'' + eps*x^3 = 0", "no term k*x stands in the equation without eps"),
    ("x'' - x + eps*x^3 = 0", "the linear stiffness is negative"),
    ("x'' + x + eps*x' = 0", "2:23: eps*x' works on x', so the amplitude drifts"),
    ("x'' + x + eps*x(t - T) = 0", "2:27: x(t - T) is a delay"),
    ("x'' + x/(1 + x^2) + eps*x^3 = 0", "(1 + x^2)^(-1) is no polynomial"),
    ("x'' + 2 x + eps*(x^2 - 1)*x'^2 + eps*x*x' = 0", "omega_0 is irrational"),
];

/// Whole files that are wrong: after three signs of equality the exit code and a piece of the message.
const FILES: &str = include_str!("bad.txt");

fn with_parameters(equation: &str) -> String {
    format!(
        "name = \"bad\"\nequation = \"{equation}\"\ncondition = \"initial-amplitude\"\n[parameters]\n\
         omega = {{ value = \"2\" }}\nk = {{ value = \"1\" }}\nF = {{ value = \"1\" }}\nT = {{ value = \"1\" }}\n"
    )
}

/// Address space in KiB for a refusal, code, libraries and stacks included. The C library reserves 64 MiB of it, and for a
/// moment 128 MiB, for the heap of the thread that watches the limits.
const LEAST_MEMORY: &str = "-v 200000";

/// What is wrong with the refusal of a file; nothing when it is right.
fn refused(folder: &Folder, path: &str, exit: i32, message: &str, code: &str) -> Option<String> {
    let output = folder.under(LEAST_MEMORY, &["derive", path, "--order", "2"]);
    let error = String::from_utf8(output.stderr).unwrap();
    let status = output.status.code();
    let one_line = error.lines().count() == 1 && error.len() < 500 && !error.contains("panicked");
    if status != Some(exit) || !output.stdout.is_empty() || !one_line || !error.contains(message) {
        return Some(format!("exit {status:?}: {error}"));
    }
    let output = lindstedt(&["derive", path, "--order", "2", "--format", "json"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let right = output.status.code() == Some(exit) && value["error"]["code"] == code;
    (!right).then(|| format!("in JSON: {value}"))
}

#[test]
fn a_hundred_bad_files_get_one_clear_line_each() {
    let folder = Folder::new("bad");
    let (mut count, mut wrong) = (0, Vec::new());
    let mut check = |content: &[u8], exit, message: &str, code| {
        let path = folder.file("bad.toml", content);
        if let Some(error) = refused(&folder, &path, exit, message, code) {
            let content = String::from_utf8_lossy(&content[..content.len().min(120)]);
            wrong.push(format!("{content} | wanted {exit} {message} | {error}"));
        }
        count += 1;
    };
    for (exit, equation, message) in EQUATIONS {
        check(with_parameters(equation).as_bytes(), exit, message, "problem-file");
    }
    for (equation, message) in REFUSED {
        check(with_parameters(equation).as_bytes(), 3, message, "no-method");
    }
    for block in FILES.split("=== ").skip(1) {
        let (head, content) = block.split_once('\n').unwrap();
        let (exit, message) = head.split_once(' ').unwrap();
        check(content.as_bytes(), exit.parse().unwrap(), message, "problem-file");
    }
    let deep = |open: &str, close: &str| {
        let equation = format!("x'' + {}x{} = 0", open.repeat(100_000), close.repeat(100_000));
        with_parameters(&equation)
    };
    check(deep("(", ")").as_bytes(), 4, "more than 10000 bytes in an equation", "problem-file");
    let deep = format!("x'' + {}x{} = 0", "(".repeat(4000), ")".repeat(4000));
    check(
        with_parameters(&deep).as_bytes(),
        4,
        "more than 64 parentheses or powers",
        "problem-file",
    );
    let nested = format!("name = 'a'\nequation = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    check(nested.as_bytes(), 2, "max recursion depth", "problem-file");
    let keys: String = (0..10_000).map(|n| format!("a{n} = 1\n")).collect();
    check(keys.as_bytes(), 2, "unknown field", "problem-file");
    check(&vec![b'#'; 100 << 20], 5, "it has more than 262144 bytes", "file");
    check(&[0xff, 0xfe, 0x00], 5, "it is not UTF-8 text", "file");
    check(&[0; 100], 2, "", "problem-file");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= 110, "{count}");
    for path in ["/nonexistent.toml", "../../x.toml", "/dev/null/x.toml"] {
        assert_eq!(refused(&folder, path, 5, "cannot read", "file"), None, "{path}");
    }
    std::fs::create_dir(folder.0.join("folder.toml")).unwrap();
    let path = folder.0.join("folder.toml");
    assert_eq!(refused(&folder, path.to_str().unwrap(), 5, "it is not a file", "file"), None);
}

/// Equations without a constant amplitude, or without one that is known exactly, and their condition: the
/// place and the reason.
const AVERAGED: [(&str, &str, &str); 7] = [
    (
        "x'' + x = eps*(1 - x^2/2 - x'^2/3)*x'",
        "limit-cycle",
        "2:13: the leading amplitude of the limit cycle is irrational",
    ),
    ("x'' + 2*x + eps*(x^2-1)*x' = 0", "limit-cycle", "2:13: x' occurs and omega_0 is irrational"),
    ("x'' + x + eps*(1 + x^2)*x' = 0", "limit-cycle", "2:13: no limit cycle"),
    ("x'' + x + eps*x' = 0", "limit-cycle", "2:23: eps*x' works on x'"),
    ("x'' + x + eps*x' = 0", "initial-amplitude", "2:23: eps*x' works on x'"),
    ("x'' + x = eps*(1 - x^2)*x'", "initial-amplitude", "2:13: order 1: the secular term"),
    (
        "x'' + x = eps*(x^2 - 1)*(x^2 - 9)*x'",
        "limit-cycle",
        "2:13: 2 limit cycles exist at order 1",
    ),
];

/// What a hint says to do is done, in both ways.
#[test]
fn averaging_takes_what_its_hint_is_given_for() {
    let folder = Folder::new("averaged");
    let file = |equation: &str, condition: &str| {
        let content = with_parameters(equation).replace("initial-amplitude", condition);
        folder.file("averaged.toml", content)
    };
    let hint =
        "(averaging takes it: condition = \"free-amplitude\" in the file, or --normalisation free)";
    let refused = |path: &str, verb: &str| {
        let output = lindstedt(&[verb, path, "--order", "1"]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{verb}: {error}");
        error
    };
    let works = |path: &str, more: &[&str]| {
        for verb in ["derive", "verify", "evaluate"] {
            let all = [&[verb, path, "--order", "1", "--quiet"], more].concat();
            let small: &[&str] = if verb == "evaluate" { &["--set", "eps=1/10"] } else { &[] };
            assert!(!text(&[&all, small].concat()).is_empty());
        }
    };
    for (equation, condition, message) in AVERAGED {
        let path = file(equation, condition);
        for verb in ["derive", "verify"] {
            let error = refused(&path, verb);
            assert!(error.contains(&format!("averaged.toml:{message}")), "{verb}: {error}");
            assert!(error.trim_end().ends_with(hint), "{verb}: {error}");
        }
        works(&path, &["--normalisation", "free"]);
        works(&file(equation, "free-amplitude"), &[]);
    }
    let mut hints = 0;
    for (equation, _) in REFUSED {
        let path = file(equation, "initial-amplitude");
        if refused(&path, "derive").contains("free-amplitude") {
            hints += 1;
            text(&["derive", &path, "--order", "1", "--normalisation", "free", "--quiet"]);
            text(&["derive", &file(equation, "free-amplitude"), "--order", "1", "--quiet"]);
        }
    }
    assert_eq!(hints, 4, "friction that jumps, a drift, a delay, an irrational omega_0");
    // A force in resonance is no case for averaging.
    let path = file("x'' + x + eps*x^3 = eps*F*cos(t)", "initial-amplitude");
    assert!(!refused(&path, "derive").contains("free-amplitude"));
    // omega_0 without a value.
    let equation = "x'' + q*x + eps*(x^2 - 1)*x' = 0";
    let open = |condition: &str| {
        let content =
            with_parameters(equation).replace("initial-amplitude", condition) + "q = {}\n";
        folder.file("open.toml", content)
    };
    let error = refused(&open("limit-cycle"), "derive");
    assert!(error.contains("2:13: x' occurs and omega_0 has no value (--set"), "{error}");
    text(&["derive", &open("limit-cycle"), "--set", "q=4", "--quiet"]);
    let error = refused(&open("free-amplitude"), "derive");
    assert!(error.contains("2:13: the linear stiffness") && error.contains("--set"), "{error}");
    text(&["derive", &open("free-amplitude"), "--set", "q=2", "--order", "1", "--quiet"]);
    // What another amplitude is only the file can say.
    let output =
        lindstedt(&["derive", &file(equation, "limit-cycle"), "--normalisation", "initial"]);
    assert_eq!(output.status.code(), Some(2));
    let path = file("x'' + x + eps*x^3 = 0", "fundamental-amplitude");
    let output = lindstedt(&["derive", &path, "--normalisation", "initial"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("(condition = \"initial-amplitude\" in the file asks for it)"),
        "{error}"
    );
}
