//! The book and the README say what is true: links resolve, every page is in the summary, every
//! console block is run and compared, every Rust block is compiled and run here.

use crate::program::{self, root, words};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::{Path, PathBuf};

mod guides;
mod html;
mod reference;

type Outcome = Result<(), Box<dyn Error>>;

/// The pages of the book below a folder.
fn pages_below(folder: &Path, list: &mut Vec<PathBuf>) -> Outcome {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            pages_below(&path, list)?;
        } else if path.extension().is_some_and(|e| e == "md") {
            list.push(path);
        }
    }
    list.sort();
    Ok(())
}

/// README and all pages, with their text.
fn pages() -> Result<Vec<(PathBuf, String)>, Box<dyn Error>> {
    let mut list = vec![root().join("README.md")];
    pages_below(&root().join("docs/src"), &mut list)?;
    let read = |path: PathBuf| Ok((path.clone(), std::fs::read_to_string(path)?));
    list.into_iter().map(read).collect()
}

/// The fenced blocks of a page: (language, text).
fn blocks(page: &str) -> Vec<(String, String)> {
    let mut list = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in page.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(language), None) => open = Some((language.to_owned(), String::new())),
            (Some(_), Some(_)) => list.extend(open.take()),
            (None, Some((_, text))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    list
}

/// The text outside fenced blocks.
fn prose(page: &str) -> String {
    let mut fenced = false;
    let mut text = String::new();
    for line in page.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            text.push_str(line);
            text.push('\n');
        }
    }
    text
}

/// The targets of the links [..](target) of a page; those of the web are left out.
fn links(page: &str) -> Vec<String> {
    let text = prose(page);
    let mut list = Vec::new();
    for (position, _) in text.match_indices("](") {
        let rest = &text[position + 2..];
        let Some(end) = rest.find(')') else { continue };
        // Mathematics such as [x](y) does not occur; web links have a scheme.
        if !rest[..end].contains("://") {
            list.push(rest[..end].to_owned());
        }
    }
    list
}

/// The anchors of a page's headings, as mdBook and code hosts form them.
fn anchors(page: &str) -> BTreeSet<String> {
    let text = prose(page);
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let slug = |line: &str| {
        let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
        let title: String = line.trim_start_matches('#').trim().chars().filter(kept).collect();
        title.to_lowercase().replace(' ', "-")
    };
    headings.map(slug).collect()
}

#[test]
fn links_resolve() -> Outcome {
    let mut broken = Vec::new();
    for (path, text) in pages()? {
        for link in links(&text) {
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let folder = path.parent().unwrap_or(Path::new("."));
            let target = if file.is_empty() { path.clone() } else { folder.join(file) };
            let found = target.exists()
                && (anchor.is_empty()
                    || anchors(&std::fs::read_to_string(&target)?).contains(anchor));
            if !found {
                broken.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
    Ok(())
}

#[test]
fn every_page_is_in_the_summary() -> Outcome {
    let folder = root().join("docs/src");
    let summary = std::fs::read_to_string(folder.join("SUMMARY.md"))?;
    let listed: BTreeSet<PathBuf> = links(&summary).iter().map(|l| folder.join(l)).collect();
    let mut there = Vec::new();
    pages_below(&folder, &mut there)?;
    let there: BTreeSet<PathBuf> =
        there.into_iter().filter(|p| p.file_name().is_none_or(|n| n != "SUMMARY.md")).collect();
    assert_eq!(listed, there);
    Ok(())
}

/// Whether the lines occur in the text, in this order, each within a line of its own.
fn first_missing<'a>(expected: &[&'a str], text: &str) -> Option<&'a str> {
    let mut lines = text.lines();
    expected.iter().copied().find(|line| !lines.any(|shown| shown.contains(line.trim_end())))
}

/// What the commands of the net print as text, which the net holds against the program.
fn held_by_the_net() -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/net/snapshots");
    let mut held = BTreeMap::new();
    for entry in std::fs::read_dir(folder)? {
        let snapshot = std::fs::read_to_string(entry?.path())?;
        let command =
            snapshot.lines().find_map(|line| line.strip_prefix("description: lindstedt "));
        let text = snapshot.split("==== ").find(|part| part.starts_with("text "));
        held.extend(command.zip(text).map(|(a, b)| (a.to_owned(), b.to_owned())));
    }
    Ok(held)
}

#[test]
fn console_blocks_show_what_the_program_prints() -> Outcome {
    let mut wrong = Vec::new();
    let mut commands = 0;
    let held = held_by_the_net()?;
    assert!(held.len() > 100, "only {} outputs of the net", held.len());
    // Several pages show parts of one long output.
    let mut outputs: BTreeMap<String, String> = BTreeMap::new();
    for (path, text) in pages()? {
        for (_, block) in blocks(&text).iter().filter(|(language, _)| language == "console") {
            let mut lines = block.lines();
            let command = lines.next().and_then(|line| line.strip_prefix("$ lindstedt "));
            let command = command.ok_or("a console block starts with $ lindstedt")?;
            commands += 1;
            let expected: Vec<&str> = lines.filter(|l| !l.trim().is_empty()).collect();
            if held.get(command).is_some_and(|shown| first_missing(&expected, shown).is_none()) {
                continue;
            }
            if !outputs.contains_key(command) {
                let output = program::command(&words(command)).current_dir(root()).output()?;
                let mut shown = String::from_utf8_lossy(&output.stdout).into_owned();
                shown.push_str(&String::from_utf8_lossy(&output.stderr));
                outputs.insert(command.to_owned(), shown);
            }
            let shown = outputs.get(command).map_or("", String::as_str);
            if let Some(line) = first_missing(&expected, shown) {
                wrong.push(format!("{}: {command}: {line}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(commands > 10, "only {commands} commands were found");
    Ok(())
}

#[test]
fn the_comparison_can_fail() {
    let text = "a\n  b = 1\nc";
    assert_eq!(first_missing(&["  b = 1", "c"], text), None);
    assert_eq!(first_missing(&["c", "  b = 1"], text), Some("  b = 1"));
    assert_eq!(first_missing(&["  b = 2"], text), Some("  b = 2"));
    assert_eq!(links("[a](b.md) `x` [c](https://d) [e](f.md#g)"), ["b.md", "f.md#g"]);
    assert!(anchors("# A b, c\n").contains("a-b-c"));
    assert_eq!(blocks("```rust\nx\n```\n").first().map(|b| b.1.as_str()), Some("x\n"));
}

/// The one file that a block includes, below the folder of its page.
fn included(page: &Path, block: &str) -> Option<PathBuf> {
    let inner = block.trim().strip_prefix("{{#include ")?.strip_suffix("}}")?;
    Some(page.parent()?.join(inner))
}

/// The Rust blocks of the book and the README are code of this test, or include an example (each
/// is run, see `reference.rs`).
#[test]
fn rust_blocks_are_compiled_and_run() -> Outcome {
    let squeeze = |text: &str| text.lines().map(str::trim).collect::<Vec<_>>().join("\n");
    let own = squeeze(concat!(include_str!("book.rs"), include_str!("book/guides.rs")));
    let examples = root().join("crates/lindstedt/examples").canonicalize()?;
    let mut unknown = Vec::new();
    for (path, text) in pages()? {
        for (_, block) in blocks(&text).iter().filter(|(language, _)| language == "rust") {
            let example = included(&path, block).map(|file| file.canonicalize()).transpose()?;
            let run = match &example {
                Some(file) => file.parent() == Some(&examples),
                None => own.contains(squeeze(block).trim()),
            };
            if !run {
                unknown.push(format!("{}:\n{block}", path.display()));
            }
        }
    }
    assert!(unknown.is_empty(), "not in book.rs: {}", unknown.join("\n"));
    Ok(())
}

/// The TOML blocks are problem files: each is read, and prints as it was read.
#[test]
fn toml_blocks_are_problem_files() -> Outcome {
    let mut count = 0;
    for (path, text) in pages()? {
        for (_, block) in blocks(&text).iter().filter(|(language, _)| language == "toml") {
            let text = match included(&path, block) {
                Some(file) => std::fs::read_to_string(file)?,
                None => block.clone(),
            };
            let file = lindstedt::ProblemFile::parse(&text);
            assert!(file.is_ok(), "{}: {file:?}", path.display());
            count += 1;
        }
    }
    assert!(count > 2, "only {count} problem files were found");
    Ok(())
}

#[rustfmt::skip]
mod readme {
    //! The library example of the README.

    use lindstedt::{Oscillator, Quantity, Work};

    fn main() -> Result<(), Box<dyn std::error::Error>> {
        let oscillator = Oscillator::parse("x'' + x + eps*(x^2 - 1)*x' = 0")?;
        let result = oscillator.derive(6, &Work::default())?.value;
        assert_eq!(result.exact(Quantity::Frequency, 6).as_deref(), Some("35/884736"));
        assert_eq!(result.checked_orders, Some(6));
        Ok(())
    }

    #[test]
    fn runs() -> Result<(), Box<dyn std::error::Error>> {
        main()
    }
}

#[rustfmt::skip]
#[test]
fn tour_of_an_own_oscillator() -> Outcome {
    use lindstedt::{Oscillator, Quantity, Work};

    let quintic = Oscillator::parse("x'' + x + eps*x^5 = 0")?;
    let result = quintic.derive(3, &Work::default())?.value;
    assert_eq!(result.exact(Quantity::FrequencySquared, 1).as_deref(), Some("5/8"));
    assert_eq!(result.checked_orders, Some(3));
    Ok(())
}

#[rustfmt::skip]
#[test]
fn problem_files_from_rust() -> Outcome {
    use lindstedt::{Oscillator, Quantity, Work};

    let duffing = Oscillator::parse("x'' + x + eps*x^3 = 0")?;
    let result = duffing.set("amplitude", "1/2")?.derive(4, &Work::default())?.value;
    assert_eq!(result.exact(Quantity::Frequency, 1).as_deref(), Some("3/32"));
    Ok(())
}
