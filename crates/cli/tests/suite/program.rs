//! The program as the tests run it, and a folder for the files of one test.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The folder of the sources: commands of the book name files from here.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The path of an example of the book.
pub fn example(name: &str) -> String {
    root().join("docs/examples").join(name).with_extension("toml").to_str().unwrap().to_owned()
}

/// The words of a command; what stands in quotation marks is one.
pub fn words(command: &str) -> Vec<&str> {
    let parts = command.split('"').enumerate().flat_map(|(n, part)| match n % 2 {
        0 => part.split_whitespace().collect(),
        _ => vec![part],
    });
    parts.collect()
}

pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lindstedt"));
    command.args(arguments);
    command
}

pub fn lindstedt(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

/// What it prints of an answer.
pub fn text(arguments: &[&str]) -> String {
    let Output { status, stdout, stderr } = lindstedt(arguments);
    let (shown, said) = (String::from_utf8(stdout).unwrap(), String::from_utf8_lossy(&stderr));
    assert!(status.success(), "{arguments:?}: {said}{shown}");
    shown
}

pub fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&text(&[arguments, &["--format", "json"]].concat())).unwrap()
}

/// The exit code, and what stands on standard error.
pub fn refusal(arguments: &[&str]) -> (Option<i32>, String) {
    let output = lindstedt(arguments);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// That a line ends with an exit code and says some words.
#[track_caller]
pub fn refuses(arguments: &[&str], exit: i32, words: &str) {
    let (code, said) = refusal(arguments);
    assert!(code == Some(exit) && said.contains(words), "{arguments:?}: {code:?} {said}");
}

/// A number of the JSON.
pub fn float(number: &Value) -> f64 {
    number["decimal"].as_str().unwrap().parse().unwrap()
}

/// An object of the JSON but for some keys.
pub fn without(mut result: Value, keys: &[&str]) -> Value {
    for key in keys {
        result.as_object_mut().unwrap().remove(*key);
    }
    result
}

/// A folder of one test, removed with it.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(format!("lindstedt-{process}-{count}-{name}"));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// The path of a file, written.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// The file of an equation with parameters `name = value` and what else it says.
    pub fn problem(&self, equation: &str, parameters: &[(&str, &str)], rest: &str) -> String {
        let value = |(name, value)| format!("{name} = {{ value = \"{value}\" }}\n");
        let values: String = parameters.iter().copied().map(value).collect();
        let head = format!("name = \"problem\"\nequation = \"{equation}\"\n{rest}\n");
        self.file("problem.toml", format!("{head}[parameters]\n{values}"))
    }

    /// The content of a file, nothing where there is none.
    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap_or_default()
    }

    /// The names there are.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program, in this folder.
    pub fn program(&self, arguments: &[&str]) -> Command {
        let mut command = command(arguments);
        command.arg("--quiet").current_dir(&self.0);
        command
    }

    pub fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let Output { status, stderr, .. } = self.program(arguments).output().unwrap();
        (status.code(), String::from_utf8_lossy(&stderr).into_owned())
    }

    /// The program under a limit of the shell, in blocks or kibibytes.
    pub fn under(&self, limit: &str, arguments: &[&str]) -> Output {
        let program = env!("CARGO_BIN_EXE_lindstedt");
        let mut command = Command::new("sh");
        command.args(["-c", &format!("ulimit {limit} && exec \"$0\" \"$@\""), program]);
        command.args(arguments).arg("--quiet").current_dir(&self.0).output().unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
