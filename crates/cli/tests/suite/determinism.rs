//! The same words whatever the number of threads and the language of the machine.
#![cfg(unix)]

use crate::program::Folder;

#[test]
fn threads_and_language_change_nothing() {
    let folder = Folder::new("determinism");
    let chart = ["A=-1/3..1/3:21", "B=-1/3..1/3:15"];
    let lines: [&[&str]; 5] = [
        &["derive", "van-der-pol", "--order", "6"],
        &["evaluate", "duffing", "--set", "eps=1/10", "--order", "6", "--times", "0..3:4"],
        &[
            "stability", "vibro-impact", "--f64", "--sweep", chart[0], "--sweep", chart[1],
            "--plot", "a.csv",
        ],
        &["simulate", "stick-slip", "--sweep", "gamma=0.5..0.7:9", "--skip", "2", "--periods", "3"],
        &["threshold", "stick-slip", "--sweep", "vstar=0..2:9", "--plot", "a.csv"],
    ];
    for line in lines {
        let mut first = None;
        for (threads, language) in [("1", "C"), ("2", "de_DE.UTF-8"), ("7", "tr_TR.UTF-8")] {
            let mut command = folder.program(line);
            let output = command
                .args(["--threads", threads])
                .env("RAYON_NUM_THREADS", "3")
                .envs(["LC_ALL", "LANG", "LANGUAGE"].map(|name| (name, language)))
                .output()
                .unwrap();
            let found = (output.status.code(), output.stdout, output.stderr, folder.text("a.csv"));
            assert_eq!(found.0, Some(0), "{line:?}");
            let same = first.get_or_insert_with(|| found.clone());
            assert_eq!(*same, found, "{line:?} with {threads} threads, {language}");
        }
        let _ = std::fs::remove_file(folder.0.join("a.csv"));
    }
}
