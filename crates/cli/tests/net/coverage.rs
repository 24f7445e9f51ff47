//! The net has every command of the book and the README, and every option of every command.

use crate::commands::{Line, lines};
use crate::run::root;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn pages_below(folder: &Path, list: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages_below(&path, list);
        } else if path.extension().is_some_and(|e| e == "md") {
            list.push(path);
        }
    }
}

/// A documented command without its format: the net runs it in all of them.
fn without_format(command: &str) -> String {
    let mut words: Vec<&str> = command.split_whitespace().collect();
    while let Some(at) = words.iter().position(|word| *word == "--format") {
        words.drain(at..words.len().min(at + 2));
    }
    words.join(" ")
}

#[test]
fn every_documented_command_is_in_the_net() {
    let known: BTreeSet<String> = lines().into_iter().map(|line| line.command).collect();
    let mut pages = vec![root().join("README.md")];
    pages_below(&root().join("docs/src"), &mut pages);
    let examples = std::fs::read_dir(root().join("docs/examples")).unwrap();
    pages.extend(examples.map(|entry| entry.unwrap().path()));
    let texts = pages.iter().map(|page| std::fs::read_to_string(page).unwrap());
    let documented: BTreeSet<String> = texts
        .flat_map(|text| {
            // In the comment of an example it follows a colon.
            let command = |line: &str| {
                let line = line
                    .strip_prefix("$ ")
                    .or_else(|| line.strip_prefix("# ")?.split(": ").nth(1))?;
                line.strip_prefix("lindstedt ").map(without_format)
            };
            text.lines().filter_map(command).collect::<Vec<_>>()
        })
        .collect();
    let missing: Vec<&String> = documented.difference(&known).collect();
    assert!(missing.is_empty(), "not in net/commands.txt: {missing:#?}");
    assert!(documented.len() > 60, "only {} documented commands were found", documented.len());
}

/// Options that every command has: the format is the net's own, the others are run once.
const COMMON: [&str; 6] = ["format", "out", "quiet", "limit-seconds", "limit-memory", "threads"];

#[test]
fn every_option_of_every_command_is_in_the_net() {
    let page = std::fs::read_to_string(root().join("docs/src/reference/options.md")).unwrap();
    let lines = lines();
    let used = |verb: &str, option: &str| {
        let has = |line: &Line| line.command.split(' ').any(|word| word == option);
        lines.iter().any(|line| line.verb() == verb && has(line))
    };
    let (mut missing, mut verb, mut count) = (Vec::new(), "", 0);
    for line in page.lines() {
        verb = line.strip_prefix("## ").unwrap_or(verb);
        let name = line.trim_start().strip_prefix("--").and_then(|rest| rest.split(' ').next());
        let Some(name) = name.filter(|name| !COMMON.contains(name)) else { continue };
        count += 1;
        if !used(verb, &format!("--{name}")) {
            missing.push(format!("{verb} --{name}"));
        }
    }
    assert!(missing.is_empty(), "not in net/commands.txt: {missing:#?}");
    assert!(count > 50, "only {count} options were found");
}

/// The examples of `--help` are commands of the net, which runs them; every command with a problem has one.
#[test]
fn every_example_of_the_help_is_in_the_net() {
    let page = std::fs::read_to_string(root().join("docs/src/reference/options.md")).unwrap();
    let known: BTreeSet<String> = lines().into_iter().map(|line| line.command).collect();
    let (mut verbs, mut verb) = (BTreeSet::new(), "");
    for line in page.lines() {
        verb = line.strip_prefix("## ").unwrap_or(verb);
        let Some(example) = line.strip_prefix("  lindstedt ") else { continue };
        assert!(known.contains(example), "not in net/commands.txt: {example}");
        assert!(example.starts_with(verb), "{example} below {verb}");
        verbs.insert(verb);
    }
    let without = page.lines().filter_map(|line| line.strip_prefix("## "));
    let without: Vec<&str> = without.filter(|verb| !verbs.contains(verb)).collect();
    assert_eq!(without, ["completions", "man"]);
}

#[test]
fn every_command_stands_once_and_has_a_name_of_its_own() {
    let lines = lines();
    let names: BTreeSet<String> = lines.iter().map(Line::name).collect();
    let commands: BTreeSet<&str> = lines.iter().map(|line| line.command.as_str()).collect();
    assert_eq!((names.len(), commands.len()), (lines.len(), lines.len()));
    assert!(names.iter().all(|name| name.len() < 140), "{names:#?}");
}
