//! Files appear whole under their names or not at all; nothing is written over what is read, and nothing is
//! deleted that was not made.
#![cfg(unix)]

use crate::program::{Folder, lindstedt};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::time::{Duration, SystemTime};

const FILE: &str = "equation = \"x'' + x + eps*x^3 = 0\"\n";

#[test]
fn a_link_leads_to_the_file_and_stays() {
    let folder = Folder::new("link");
    fs::create_dir(folder.0.join("far")).unwrap();
    symlink("far/result.txt", folder.0.join("link.txt")).unwrap();
    // Refused before anything is computed, and after it was found that the file can be written.
    for refused in [&["--order", "x"][..], &["--limit-memory", "1", "--order", "400"]] {
        let command = [&["derive", "duffing", "--out", "link.txt"], refused].concat();
        assert!(matches!(folder.run(&command).0, Some(2 | 4)), "{refused:?}");
        assert_eq!(fs::read_link(folder.0.join("link.txt")).unwrap(), Path::new("far/result.txt"));
        assert_eq!(folder.names(), ["far", "link.txt"]);
        assert!(!folder.0.join("far/result.txt").exists());
    }
    let (code, error) = folder.run(&["derive", "duffing", "--order", "1", "--out", "link.txt"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(fs::symlink_metadata(folder.0.join("link.txt")).unwrap().is_symlink());
    assert!(folder.text("far/result.txt").contains("3/8"));
    assert_eq!(fs::read_dir(folder.0.join("far")).unwrap().count(), 1);
}

#[test]
fn no_two_names_of_one_file() {
    let folder = Folder::new("names");
    fs::write(folder.0.join("me.toml"), FILE).unwrap();
    fs::create_dir(folder.0.join("far")).unwrap();
    symlink("../me.toml", folder.0.join("far/link.toml")).unwrap();
    fs::hard_link(folder.0.join("me.toml"), folder.0.join("hard.toml")).unwrap();
    let sweep = ["simulate", "duffing", "--sweep", "eps=1..2:2"];
    let evaluate = ["evaluate", "me.toml", "--set", "eps=1/10"];
    for command in [
        &["derive", "me.toml", "--out", "me.toml"][..],
        &["derive", "me.toml", "--out", "far/../me.toml"],
        &["derive", "far/link.toml", "--out", "me.toml"],
        &["derive", "me.toml", "--out", "hard.toml"],
        &[&evaluate[..], &["--plot", "a.csv", "--plot", "far/../a.csv"]].concat(),
        &[&evaluate[..], &["--plot", "a.svg", "--out", "./a.svg"]].concat(),
        &[&sweep[..], &["--resume", "r.csv", "--plot", "r.csv"]].concat(),
        &[&sweep[..], &["--resume", "r", "--out", "far/../r"]].concat(),
    ] {
        let (code, error) = folder.run(command);
        assert!(code == Some(2) && error.contains("are one file"), "{command:?}: {error}");
        assert_eq!(folder.names(), ["far", "hard.toml", "me.toml"], "{command:?}");
        assert_eq!(folder.text("me.toml"), FILE);
    }
}

#[test]
fn what_was_there_stays_when_the_disk_is_full() {
    let folder = Folder::new("full");
    fs::write(folder.0.join("old.txt"), "old").unwrap();
    fs::write(folder.0.join("old.svg"), "old").unwrap();
    let plotted = ["--set", "eps=1", "--order", "2", "--plot", "old.svg"];
    for command in [
        &["derive", "duffing", "--order", "12", "--format", "json", "--out", "old.txt"][..],
        &[&["evaluate", "duffing"], &plotted[..]].concat(),
    ] {
        let output = folder.under("-f 1", command);
        let error = [output.stdout, output.stderr].concat();
        let error = String::from_utf8_lossy(&error);
        assert_eq!(output.status.code(), Some(5), "{command:?}: {error}");
        assert!(error.contains("cannot write old."), "{error}");
        assert_eq!(folder.names(), ["old.svg", "old.txt"]);
        assert_eq!((folder.text("old.txt"), folder.text("old.svg")), ("old".into(), "old".into()));
    }
    // Of the second command the answer was printed all the same.
    assert!(
        !folder.under("-f 1", &[&["evaluate", "duffing"], &plotted[..]].concat()).stdout.is_empty()
    );
    assert_eq!(folder.run(&["derive", "duffing", "--out", "no/such/folder"]).0, Some(5));
    assert_eq!(folder.run(&["derive", "duffing", "--out", "."]).0, Some(5));
    // A device has no other file beside it.
    assert_eq!(folder.run(&["derive", "duffing", "--order", "1", "--out", "/dev/null"]).0, Some(0));
    assert_eq!(folder.run(&["derive", "duffing", "--order", "1", "--out", "/dev/full"]).0, Some(5));
}

/// What a killed run left beside a file goes with the next one that writes it; what is young, held or another's stays.
#[test]
fn what_was_left_of_a_file_is_removed() {
    let folder = Folder::new("left");
    let left = |name: &str, mark: &str, age: u64| {
        let path =
            folder.0.join(format!(".lindstedt-{:08x}-{mark}", crc32fast::hash(name.as_bytes())));
        let file = fs::File::create(&path).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
        (file, path)
    };
    let (_, old) = left("a.txt", "old", 3600);
    let (held, locked) = left("a.txt", "held", 3600);
    held.lock().unwrap();
    let (_, young) = left("a.txt", "young", 0);
    let (_, other) = left("b.txt", "old", 3600);
    assert_eq!(folder.run(&["derive", "duffing", "--order", "1", "--out", "a.txt"]).0, Some(0));
    assert_eq!([&old, &locked, &young, &other].map(|p| p.exists()), [false, true, true, true]);
    assert_eq!(folder.names().len(), 4);
}

#[test]
fn permissions_stay() {
    let folder = Folder::new("permissions");
    let path = folder.0.join("old.txt");
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o604)).unwrap();
    for name in ["old.txt", "new.txt"] {
        let command = ["derive", "duffing", "--order", "1", "--out", name];
        assert_eq!(folder.run(&command).0, Some(0));
    }
    let mode = |name: &str| fs::metadata(folder.0.join(name)).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode("old.txt"), 0o604);
    // As a file that is opened in the usual way.
    fs::write(folder.0.join("usual.txt"), "").unwrap();
    assert_eq!(mode("new.txt"), mode("usual.txt"));
}

#[test]
fn what_would_be_ignored_is_refused() {
    let folder = Folder::new("ignored");
    let code = ["evaluate", "duffing", "--set", "eps=1", "--code", "rust", "--plot", "a.svg"];
    assert_eq!(folder.run(&code).0, Some(2));
    assert_eq!(folder.run(&["paper", "--quick", "--out", "p", "--format", "json"]).0, Some(2));
    assert!(folder.names().is_empty());
}

#[test]
fn arguments_that_are_no_text() {
    let folder = Folder::new("bytes");
    let word = std::ffi::OsStr::from_bytes(b"duff\xffing");
    for format in ["text", "json"] {
        let mut command = folder.program(&["--format", format, "derive"]);
        let output = command.arg(word).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
    }
    let mut command = folder.program(&["derive", "duffing", "--order", "1"]);
    assert_eq!(command.arg("--out").arg(word).status().unwrap().code(), Some(0));
    assert_eq!(fs::read_dir(&folder.0).unwrap().count(), 1);
}

/// The script for a shell names every command and an option with its values; a manual page has its options.
#[test]
fn a_shell_completes_and_man_explains() {
    let printed = |arguments: &[&str]| {
        let output = lindstedt(arguments);
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, script) = printed(&["completions", "bash"]);
    assert_eq!(code, Some(0));
    for word in ["subcmd__evaluate", "--normalisation", "rust python c latex"] {
        assert!(script.contains(word), "{word}");
    }
    let (code, page) = printed(&["man", "evaluate"]);
    assert_eq!(code, Some(0));
    for word in [".TH lindstedt-evaluate 1", "harmonics", "limit\\-seconds"] {
        assert!(page.contains(word), "{word}: {page}");
    }
    let (_, program) = printed(&["man"]);
    assert!(
        program.contains(".TH lindstedt 1") && program.contains("lindstedt\\-evaluate(1)"),
        "{program}"
    );
    assert_eq!(printed(&["man", "frobnicate"]).0, Some(2));
}
