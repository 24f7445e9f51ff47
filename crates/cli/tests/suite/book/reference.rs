//! The reference is complete and current: every error code, every option, every formula; the
//! examples give the known numbers.

use super::{Outcome, blocks, first_missing, pages};
use crate::program::{self, root, words};
use lindstedt_tests::examples::example;
use lindstedt_tests::mathematics;
use std::collections::BTreeSet;
use std::error::Error;
use std::path::Path;
use std::process::Command;

/// The Rust files below a folder.
fn sources(folder: &Path, text: &mut Vec<String>) -> Outcome {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            sources(&path, text)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            text.push(std::fs::read_to_string(path)?);
        }
    }
    Ok(())
}

/// The codes in a source text: literals where a code stands.
fn codes(source: &str) -> BTreeSet<String> {
    let places = [
        "code: ", "usage(", "no_answer(", "undecided(", "USAGE,", "NO_ANSWER,", "UNDECIDED,",
        "FILE,", "INTERRUPTED,", "Usage,", "NoAnswer,", "Undecided,", "Stopped,",
    ];
    let mut found = BTreeSet::new();
    for place in places {
        for (position, _) in source.match_indices(place) {
            let rest = source[position + place.len()..].trim_start();
            let Some((code, _)) = rest.strip_prefix('"').and_then(|rest| rest.split_once('"'))
            else {
                continue;
            };
            if code.contains(|c: char| !c.is_ascii_lowercase() && c != '-') || code.is_empty() {
                continue;
            }
            found.insert(code.to_owned());
        }
    }
    found
}

#[test]
fn codes_are_found() {
    let source =
        "Failure::usage(\n    \"set\", m) (NO_ANSWER, \"no-orbit\") usage(\"a b\") code: \"x-y\",";
    assert_eq!(codes(source).into_iter().collect::<Vec<_>>(), ["no-orbit", "set", "x-y"]);
}

/// The page of errors lists the codes of the program, all of them and no other.
#[test]
fn every_error_code_is_documented() -> Outcome {
    let mut texts = Vec::new();
    sources(&root().join("crates/cli/src"), &mut texts)?;
    sources(&root().join("crates/lindstedt/src"), &mut texts)?;
    let mut emitted: BTreeSet<String> = texts.iter().flat_map(|text| codes(text)).collect();
    // The codes of the engine's errors are what their arms give.
    let refusals = std::fs::read_to_string(root().join("crates/lindstedt/src/refusal.rs"))?;
    emitted.extend(codes(&refusals.replace("=> {", "code: ").replace("=> ", "code: ")));
    assert!(emitted.len() > 30, "only {emitted:?}");
    let page = std::fs::read_to_string(root().join("docs/src/reference/errors.md"))?;
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let cells = rows.filter_map(|line| line.split('|').nth(1));
    let documented: BTreeSet<String> =
        cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).map(str::to_owned).collect();
    let missing: Vec<_> = emitted.difference(&documented).collect();
    let gone: Vec<_> = documented.difference(&emitted).collect();
    assert!(missing.is_empty() && gone.is_empty(), "missing {missing:?}, gone {gone:?}");
    Ok(())
}

/// The page of options, from what the program says of itself.
fn options_page() -> Result<String, Box<dyn Error>> {
    let help = |arguments: &[&str]| -> Result<String, Box<dyn Error>> {
        let text = program::text(&[arguments, &["--help"]].concat());
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        Ok(lines.join("\n"))
    };
    let overview = help(&[])?;
    let list = overview.split("Commands:\n").nth(1).ok_or("no commands")?;
    let names = list.lines().take_while(|line| !line.is_empty());
    let names = names.filter_map(|line| line.split_whitespace().next());
    let mut page = String::from(
        "# Options of every command\n\n<!-- Generated; how: contributing/testing.md -->\n\nThis page is what the program says of itself; a \
         test holds it against `--help`.\n",
    );
    for name in names.filter(|name| *name != "help") {
        let text = help(&[name])?;
        page.push_str(&format!("\n## {name}\n\n```text\n{}\n```\n", text.trim_end()));
    }
    Ok(page)
}

#[test]
fn the_page_of_options_is_current() -> Outcome {
    let path = root().join("docs/src/reference/options.md");
    let page = options_page()?;
    if std::env::var_os("UPDATE_REFERENCE").is_some() {
        std::fs::write(&path, &page)?;
    }
    let found = std::fs::read_to_string(&path)?;
    assert!(found == page, "UPDATE_REFERENCE=1 cargo test -p lindstedt-cli book::");
    Ok(())
}

/// Every command has a synopsis on the page of the command line.
#[test]
fn every_command_is_described() -> Outcome {
    let options = std::fs::read_to_string(root().join("docs/src/reference/options.md"))?;
    let page = std::fs::read_to_string(root().join("docs/src/reference/command-line.md"))?;
    for name in options.lines().filter_map(|line| line.strip_prefix("## ")) {
        assert!(page.contains(&format!("lindstedt {name}")), "{name}");
    }
    for option in options.split_whitespace().filter(|word| word.starts_with("--")) {
        let option = option.trim_end_matches([',', '.', ';', ':', ')', ']', '>']);
        let known = page.contains(option) || ["--help", "--version"].contains(&option);
        assert!(known, "{option} is not on the page of the command line");
    }
    Ok(())
}

/// The keys at the top of what every command writes stand on the page of JSON.
#[test]
fn every_json_key_is_documented() -> Outcome {
    let page = std::fs::read_to_string(root().join("docs/src/reference/json.md"))?;
    for command in [
        "derive duffing --order 1",
        "derive vibro-impact --order 1",
        "evaluate duffing --order 6 --times 0..1:2",
        "evaluate van-der-pol --set eps=1/2 --prove",
        "evaluate duffing --order 4 --sweep eps=0..1:2 --digits 8",
        "threshold stick-slip --digits 8 --zeros vstar=0..1 --sweep vstar=0..1:3",
        "stability vibro-impact --f64 --variant impact-aware",
        "simulate duffing --periods 1 --digits 8",
        "simulate vibro-impact --perturb 1e-6 --impacts 4 --digits 10",
        "simulate duffing --sweep eps=0..1:2 --section velocity --skip 2 --periods 4 --digits 8",
        "evaluate vibro-impact --order 1 --start 1,0 --times 0..1:2",
        "threshold docs/examples/forced-pendulum.toml --digits 8",
        "threshold stick-slip --digits 8 --subharmonics 2 --sweep b=1,2 --sweep vstar=0..1:3",
        "stability docs/examples/impact-spring.toml --f64",
        "simulate duffing --periods 2 --digits 8 --section velocity",
        "simulate docs/examples/holmes-duffing.toml --set eps=1 --lyapunov --zero-one --periods 100 --skip 10",
        "trade duffing --orders 2 --digits 16 --harmonics 16 --repeats 1 --for 1 --within 1",
        "verify duffing --order 1",
        "problems",
        "paper --quick",
    ] {
        let json = if command == "paper --quick" {
            std::fs::read(crate::browser::folder()?.join("report.json"))?
        } else {
            let arguments = [&words(command)[..], &["--format", "json", "--quiet"]].concat();
            program::command(&arguments).current_dir(root()).output()?.stdout
        };
        let value: serde_json::Value = serde_json::from_slice(&json)?;
        for key in value.as_object().ok_or("no object")?.keys() {
            assert!(page.contains(&format!("`{key}`")), "{command}: {key}");
        }
    }
    Ok(())
}

#[test]
fn every_formula_can_be_drawn() -> Outcome {
    let mut wrong = Vec::new();
    let mut formulas = 0;
    for (path, text) in pages()? {
        match mathematics::render(&text) {
            Ok(page) => formulas += page.matches("<math").count(),
            Err(error) => wrong.push(format!("{}: {error}", path.display())),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(formulas > 100, "only {formulas} formulas");
    Ok(())
}

/// The examples and lines that they print, in this order. The numbers: van der Pol's frequency,
/// which Rayleigh's equation shares (Andersen and Geer 1982); the closed form of the period; the
/// flip by simulation of the nonlinear delayed system; the zeros of the paper to its six digits
/// (0.310429, 0.557204). Blocks `text,NAME` of the book show the output of an example, too.
const EXAMPLES: [(&str, &[&str]); 4] = [
    (
        "new_oscillator",
        &["eps^2: -1/16", "eps^4: 17/3072", "eps^6: 35/884736", "orders 0 to 6", "Agrees"],
    ),
    (
        "delta_expansion",
        &[
            "delta^1: -1/2 + ln(2) = 0.193147180559945309417232121458",
            "delta^2: 3/8 - 3/2*ln(2) + 1/2*ln(2)^2 + 1/24*pi^2 = -0.0132607471687606",
            "= -0.000435408512562507800105640433444",
            "residual zero to order 8",
            "period of x'' + x^3 = 0: 7.416298709205",
            "closed form:             7.41629870920548767",
        ],
    ),
    ("stability_chart", &["of 441 points", "true flip at B = 0: A = -0.0292903246974"]),
    (
        "threshold_curve",
        &[
            "vstar = 0.4: gamma_c = 0.637071342848",
            "30 digits: 0.637071342848163582971708960441",
            "vstar = 0.310429",
            "vstar = 0.557203",
            "between 0 and 1: true",
        ],
    ),
];

#[test]
fn examples_give_the_known_numbers() -> Outcome {
    let folder = root().join("crates/lindstedt/examples");
    let there: BTreeSet<String> = std::fs::read_dir(folder)?
        .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned()))
        .collect();
    let listed: BTreeSet<String> = EXAMPLES.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(there, listed);
    for (name, expected) in EXAMPLES {
        let output = Command::new(example(name)?).output()?;
        let shown = String::from_utf8(output.stdout)?;
        assert_eq!(first_missing(expected, &shown), None, "{name} printed {shown}");
        let language = format!("text,{name}");
        for (path, page) in pages()? {
            for (_, block) in blocks(&page).iter().filter(|(found, _)| *found == language) {
                let lines: Vec<&str> = block.lines().collect();
                assert_eq!(first_missing(&lines, &shown), None, "{}: {name}", path.display());
            }
        }
    }
    Ok(())
}
