//! The file of a sweep: what was changed in it is found, named and computed again.
#![cfg(unix)]

use crate::program::Folder;
use std::fs;

const SWEEP: [&str; 10] = [
    "simulate", "stick-slip", "--sweep", "gamma=0.5..0.7:6", "--skip", "2", "--periods", "3",
    "--resume", "r",
];

fn begun(name: &str) -> (Folder, String) {
    let folder = Folder::new(name);
    let (code, error) = folder.run(&SWEEP);
    assert_eq!(code, Some(0), "{error}");
    let whole = folder.text("r");
    (folder, whole)
}

#[test]
fn a_journal_says_what_it_belongs_to_and_that_it_is_whole() {
    let (folder, whole) = begun("journal-whole");
    let lines: Vec<&str> = whole.lines().collect();
    assert_eq!(lines.len(), 9, "{whole}");
    assert!(lines[0].starts_with("# lindstedt bifurcation 5: stick-slip "), "{whole}");
    assert!(lines[1].starts_with("# lindstedt simulate stick-slip --sweep gamma=0.5"), "{whole}");
    assert!(lines[8].starts_with("# whole: 6 values, "), "{whole}");
    // Read again it stays as it is, and says nothing.
    assert_eq!(folder.run(&SWEEP), (Some(0), String::new()));
    assert_eq!(folder.text("r"), whole);
    // Another sweep does not take it.
    let other: Vec<&str> = SWEEP.iter().map(|&a| if a == "3" { "4" } else { a }).collect();
    let (code, error) = folder.run(&other);
    assert!(code == Some(5) && error.contains("belongs to another sweep"), "{error}");
    assert_eq!(folder.text("r"), whole);
}

/// A digit of a point, a point, a number that is none, a line, the last line, half a line.
#[test]
fn what_was_changed_is_found_and_computed_again() {
    let (folder, whole) = begun("journal-damage");
    let lines: Vec<&str> = whole.lines().collect();
    let (from, to) = (lines[4].find("[[").unwrap() + 2, lines[4].find("],[").unwrap());
    let digit = lines[4][from..].find(|c: char| ('1'..'9').contains(&c)).unwrap() + from;
    let mut changed = lines[4].to_owned();
    let other = if &changed[digit..=digit] == "7" { "6" } else { "7" };
    changed.replace_range(digit..=digit, other);
    let lost = format!("{}{}", &lines[4][..from], &lines[4][to + 3..]);
    let nan = format!("{}nan{}", &lines[4][..from], &lines[4][lines[4].find(',').unwrap()..]);
    let replaced = |line: &str| {
        let mut all = lines.clone();
        all[4] = line;
        all.join("\n") + "\n"
    };
    let without = |place: usize| {
        let mut all = lines.clone();
        all.remove(place);
        all.join("\n") + "\n"
    };
    for (damaged, named) in [
        (replaced(&changed), "line 5"),
        (replaced(&lost), "line 5"),
        (replaced(&nan), "line 5"),
        (without(4), "gamma = 0.58: lost in the journal"),
        (without(8), ""),
        (whole[..whole.len() - 60].to_owned(), ""),
    ] {
        fs::write(folder.0.join("r"), &damaged).unwrap();
        let (code, error) = folder.run(&SWEEP);
        assert_eq!(code, Some(0), "{error}");
        assert!(error.contains(named), "{named}: {error}");
        assert_eq!(error.is_empty(), named.is_empty(), "{error}");
        // The same lines, those that were computed again behind the others.
        let sorted = |text: &str| {
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            let last = lines.pop().unwrap();
            lines.sort();
            (lines, last[..18].to_owned())
        };
        assert_eq!(sorted(&folder.text("r")), sorted(&whole), "{named}");
        assert_eq!(folder.names(), ["r"]);
        assert_eq!(folder.run(&SWEEP), (Some(0), String::new()));
    }
}

/// Values that follow each other go on from the state that was kept, on both ways and behind a lost line.
#[test]
fn what_follows_goes_on_from_the_kept_state() {
    let (folder, alone) = begun("journal-follow");
    let follow = [&SWEEP[..], &["--follow"]].concat();
    let (code, error) = folder.run(&follow);
    assert!(code == Some(5) && error.contains("belongs to another sweep"), "{error}");
    fs::remove_file(folder.0.join("r")).unwrap();
    assert_eq!(folder.run(&follow), (Some(0), String::new()));
    let whole = folder.text("r");
    let lines: Vec<&str> = whole.lines().collect();
    assert_eq!(lines.len(), 15, "{whole}");
    // The first has the start of all, the others have their own, and down it is another than up.
    let points = |line: &str| line[line.find("[[").unwrap()..=line.find("]]").unwrap()].to_owned();
    let other: Vec<&str> = alone.lines().collect();
    assert_eq!(points(lines[2]), points(other[2]));
    assert_ne!(points(lines[3]), points(other[3]));
    assert_ne!(points(lines[3]), points(lines[12]));
    let sorted = |text: &str| {
        let mut lines: Vec<String> = text.lines().take(14).map(str::to_owned).collect();
        lines.sort();
        lines
    };
    for (end, lost) in [(5, &[][..]), (11, &[]), (15, &[4, 9])] {
        let places = (0..end).filter(|place| !lost.contains(place));
        let kept: Vec<&str> = places.map(|place| lines[place]).collect();
        fs::write(folder.0.join("r"), kept.join("\n") + "\n").unwrap();
        assert_eq!(folder.run(&follow).0, Some(0));
        assert_eq!(sorted(&folder.text("r")), sorted(&whole), "{}", kept.len());
    }
}
