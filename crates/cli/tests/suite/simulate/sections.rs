//! Sections, sweeps and bifurcation diagrams of `simulate`.

use super::{command, json, run};
use crate::program::{Folder, float};
use serde_json::Value;
use std::process::Stdio;
use std::time::Duration;

/// Killed in the middle and begun again, the file, the table and the figure are the same bytes.
#[test]
fn a_killed_diagram_goes_on() {
    let sweep =
        ["stick-slip", "--sweep", "gamma=0.58..0.66:60", "--skip", "150", "--periods", "60"];
    let go = |kill: bool| -> [Vec<u8>; 3] {
        let folder = Folder::new("diagram");
        let paths = ["x.dat", "x.csv", "x.svg"].map(|name| folder.path(name));
        let [resume, csv, svg] = paths.each_ref().map(String::as_str);
        let all = [&sweep[..], &["--resume", resume, "--plot", csv, "--plot", svg]].concat();
        if kill {
            let mut child =
                command(&all).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            // As soon as some values are there.
            let lines = || folder.text("x.dat").lines().count();
            while lines() < 5 && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(2));
            }
            child.kill().unwrap();
            child.wait().unwrap();
            assert!(folder.text("x.svg").is_empty() && lines() < 62, "killed too late");
            // A line that was cut in the middle.
            let mut torn = std::fs::read(&paths[0]).unwrap();
            torn.truncate(torn.len() - 7);
            std::fs::write(&paths[0], torn).unwrap();
        }
        assert!(command(&all).output().unwrap().status.success());
        paths.map(|path| std::fs::read(path).unwrap())
    };
    let (whole, resumed) = (go(false), go(true));
    assert!(whole[1..] == resumed[1..]);
    // But for the command, which names the files.
    let lines = |files: &[Vec<u8>; 3]| -> Vec<String> {
        let text = String::from_utf8_lossy(&files[0]).into_owned();
        text.lines()
            .filter(|line| !line.starts_with("# lindstedt simulate"))
            .map(str::to_owned)
            .collect()
    };
    assert_eq!(lines(&whole), lines(&resumed));
    // The head, a line per value, the end.
    assert_eq!(lines(&whole).len(), 62);
}

#[test]
fn a_diagram_doubles_its_period() {
    let sweep = ["--sweep", "gamma=0.6..0.65:2", "--skip", "600", "--periods", "40"];
    let found = json(&[&["stick-slip"], &sweep[..]].concat());
    let distinct = |n: usize| {
        let points = found["sweep"]["columns"][n]["points"].as_array().unwrap();
        let mut list: Vec<i64> =
            points.iter().map(|p| (p[0].as_f64().unwrap() * 1e3).round() as i64).collect();
        list.sort_unstable();
        list.dedup();
        list.len()
    };
    // Period 2 at 0.6, chaos at 0.65.
    assert!(distinct(0) <= 2 && distinct(1) > 20, "{} {}", distinct(0), distinct(1));
    let gains =
        json(&["vibro-impact", "--sweep", "A=-0.04..-0.02:3", "--skip", "50", "--impacts", "10"]);
    assert_eq!(gains["sweep"]["section"], "impact");
    assert_eq!(gains["sweep"]["columns"][0]["points"].as_array().unwrap().len(), 10);
}

#[test]
fn values_of_a_sweep_are_exact() {
    let folder = Folder::new("exact");
    let sweep = ["stick-slip", "--sweep", "gamma=0.5..0.8:10", "--skip", "0", "--periods", "1"];
    let found = json(&[&sweep[..], &["--plot", &folder.path("x.csv")]].concat());
    let columns = found["sweep"]["columns"].as_array().unwrap();
    let exact: Vec<&str> = columns.iter().map(|c| c["exact"].as_str().unwrap()).collect();
    assert_eq!(exact[..4], ["0.5", "8/15", "17/30", "0.6"]);
    let table = folder.text("x.csv");
    assert!(table.contains("\n0.6,") && table.contains("\n0.5666666666666667,"));
}

/// The end is the last time asked for where no other is given; `--skip` leaves out the first points.
#[test]
fn times_and_points_asked_for() {
    let found = json(&["duffing", "--times", "0..50:3", "--digits", "10"]);
    let samples = found["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 3);
    assert!((float(&samples[2]["t"]) - 50.0).abs() < 1e-9, "{samples:?}");
    let late = run(&["duffing", "--times", "0..50:3", "--until", "5"]);
    assert_eq!(late.status.code(), Some(2));
    let strobe = ["stick-slip", "--periods", "5", "--section", "stroboscopic", "--f64"];
    let points = |more: &[&str]| {
        let found = json(&[&strobe[..], more].concat());
        found["section"]["points"].as_array().unwrap().clone()
    };
    assert_eq!(points(&["--skip", "3"])[..], points(&[])[3..]);
}

/// A column of a sweep is the section of one motion: at impacts the state just before, stroboscopically
/// with the period that belongs to the value, also of the frequency of the force itself.
#[test]
fn a_column_is_the_section_of_one_motion() {
    let pairs = |list: &Value| -> Vec<[f64; 2]> {
        let pair = |p: &Value| {
            let all: Vec<f64> = p.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            [all[all.len() - 2], all[all.len() - 1]]
        };
        list.as_array().unwrap().iter().map(pair).collect()
    };
    let walled = ["vibro-impact", "--state", "-0.5,0.1", "--section", "impact", "--impacts", "4"];
    let forced = ["stick-slip", "--section", "stroboscopic", "--periods", "4"];
    for (common, name, values) in
        [(&walled[..], "A", ["0", "1/10"]), (&forced[..], "omega", ["1", "3"])]
    {
        let sweep = format!("{name}={}..{}:2", values[0], values[1]);
        let swept = json(&[common, &["--skip", "0", "--sweep", &sweep]].concat());
        for (value, column) in values.iter().zip(swept["sweep"]["columns"].as_array().unwrap()) {
            let one = json(&[common, &["--set", &format!("{name}={value}")]].concat());
            let (one, column) = (pairs(&one["section"]["points"]), pairs(&column["points"]));
            assert_eq!((one.len(), column.len()), (4, 4));
            for ([x, v], [y, w]) in one.into_iter().zip(column) {
                assert!((x - y).abs() < 1e-9 && (v - w).abs() < 1e-9, "{name}={value}: {v} {w}");
            }
        }
    }
}

/// x'' = -1 above a wall at 0 with R = 9/10 from rest at 1: at t = 3 the body flies, 0.761 high, though
/// the impacts add up at 19 sqrt 2.
#[test]
fn a_ball_is_seen_between_its_impacts() {
    let folder = Folder::new("ball");
    let wall = "[impact]\nposition = \"0\"\ncrossing = \"falling\"\nrestitution = \"9/10\"\n";
    let path = folder.problem("x'' = -1", &[], &format!("condition = []\n{wall}"));
    let ball = [&path, "--state", "1,0", "--digits", "10"];
    let found = json(&[&ball[..], &["--until", "30", "--times", "3..3:1"]].concat());
    // The first flight after the impact at sqrt 2 with velocity 9/10 sqrt 2.
    let t = 3.0 - 2f64.sqrt();
    let truth = 0.9 * 2f64.sqrt() * t - t * t / 2.0;
    assert!((float(&found["samples"][0]["x"]) - truth).abs() < 1e-9, "{}", found["samples"]);
}
