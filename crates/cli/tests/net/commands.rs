//! The command lines of the net.

/// A command line and the formats it runs in.
pub struct Line {
    pub command: String,
    pub formats: &'static [&'static str],
}

const ALL: &[&str] = &["text", "json", "latex", "markdown"];

impl Line {
    fn read(line: &str) -> Self {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        let (formats, command): (&[_], _) = match word {
            "text" => (&["text"], rest),
            "refusal" => (&["text", "json"], rest),
            "elsewhere" => (&[], rest),
            _ => (ALL, line),
        };
        Self { command: command.to_owned(), formats }
    }

    /// The first word.
    pub fn verb(&self) -> &str {
        self.command.split(' ').next().unwrap_or("")
    }

    /// The name of the snapshot: the command with one `-` for what a file name had better not have.
    pub fn name(&self) -> String {
        let command = self.command.replace("docs/examples/", "").replace("docs/src/guide/", "");
        let command = command.replace(" --", " ").replace(" -", " minus");
        let mut name = String::new();
        for c in command.replace(".toml", " file").replace("=-", "=minus").chars() {
            let kept = c.is_ascii_alphanumeric() || matches!(c, '.' | '=' | ',' | '_');
            if kept {
                name.push(c);
            } else if !name.ends_with('-') && !name.is_empty() {
                name.push('-');
            }
        }
        name.trim_end_matches('-').to_owned()
    }
}

/// All lines of `commands.txt`.
pub fn lines() -> Vec<Line> {
    let text = include_str!("commands.txt").lines();
    text.filter(|line| !line.is_empty() && !line.starts_with('#')).map(Line::read).collect()
}
