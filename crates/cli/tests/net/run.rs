//! Runs the command lines, each format once, on all cores.

use crate::commands::Line;
use crate::mask;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What one command printed in one format, without what depends on the clock.
#[derive(Clone)]
pub struct Output {
    pub format: &'static str,
    pub code: i32,
    pub shown: String,
    pub warnings: String,
    /// The files it wrote, tables as they are, figures as a digest.
    pub files: Vec<(String, String)>,
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The outputs of each line, in the order of its formats.
pub fn run_all(lines: &[Line]) -> Vec<Vec<Output>> {
    let jobs: Vec<(usize, &'static str)> = lines
        .iter()
        .enumerate()
        .flat_map(|(n, line)| line.formats.iter().map(move |format| (n, *format)))
        .collect();
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<Output>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let work = || {
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed);
            let Some(((n, format), slot)) = jobs.get(job).zip(done.get(job)) else { break };
            *slot.lock().unwrap() = Some(run(&lines[*n].command, format));
        }
    };
    let threads = std::thread::available_parallelism().map_or(2, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(work);
        }
    });
    let mut found: Vec<Vec<Output>> = lines.iter().map(|_| Vec::new()).collect();
    for ((n, _), slot) in jobs.iter().zip(done) {
        found[*n].extend(slot.into_inner().unwrap());
    }
    found
}

/// The arguments of a command; what stands in quotation marks is one.
fn words(command: &str) -> impl Iterator<Item = &str> {
    command.split('"').enumerate().flat_map(|(n, part)| match n % 2 {
        0 => part.split_whitespace().collect(),
        _ => vec![part],
    })
}

/// Runs one command. Files that it shall write are named `x.*`: they go into a folder of their own.
fn run(command: &str, format: &'static str) -> Output {
    let name: String = command.chars().filter(char::is_ascii_alphanumeric).collect();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("net-{name}-{format}"));
    let mut files = Vec::new();
    let arguments = words(command).map(|argument| {
        if !argument.starts_with("x.") {
            return argument.to_owned();
        }
        files.push(argument.to_owned());
        folder.join(argument).to_str().unwrap().to_owned()
    });
    let arguments: Vec<String> = arguments.collect();
    if !files.is_empty() {
        // What a run before left would be continued (--resume).
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_lindstedt"))
        .args(arguments)
        .args(["--quiet", "--format", format])
        .env("RAYON_NUM_THREADS", "1")
        .current_dir(root())
        .output()
        .unwrap();
    let here = format!("{}{}", folder.display(), std::path::MAIN_SEPARATOR);
    let own = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().replace(&here, "");
    let (shown, warnings) = (own(output.stdout), own(output.stderr));
    let timed = command.starts_with("trade");
    let written = files.iter().filter_map(|name| {
        let text = std::fs::read_to_string(folder.join(name)).ok()?;
        Some((name.clone(), mask::file(name, &own(text.into_bytes()), timed)))
    });
    Output {
        format,
        code: output.status.code().unwrap_or(-1),
        shown: mask::output(&shown, format, timed),
        warnings: mask::output(&warnings, "text", timed),
        files: written.collect(),
    }
}
