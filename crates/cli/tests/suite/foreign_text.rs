//! Text of a problem file is data in every format: no command of TeX, no element of HTML, no markup of
//! Markdown, nothing that steers a terminal.

use crate::program::lindstedt;
use lindstedt::{Oscillator, Refusal, Work};
use lindstedt_report::{Format, Present, json};
use lindstedt_tests::Random;

/// What somebody might write to get in.
const PAYLOADS: [&str; 16] = [
    r"\input{/etc/passwd}",
    r"\write18{ls}",
    r"\end{verbatim}\input{x}",
    "$\\input{x}$",
    "}",
    "%",
    "<script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    "]](javascript:alert(1))",
    "```",
    "\u{1b}[31m",
    "\u{0}",
    "\u{9b}2J",
    "\u{202e}",
    "\r",
    "&lt;",
];

/// The commands that our own LaTeX uses.
fn is_ours(command: &str) -> bool {
    !matches!(
        command,
        "input" | "write" | "include" | "openout" | "immediate" | "catcode" | "csname" | "def"
    )
}

/// What got through.
fn breach(format: &str, shown: &str) -> Option<String> {
    let steers = |c: char| {
        (c.is_control() && c != '\n')
            || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    if let Some(c) = shown.chars().find(|c| steers(*c)) {
        return Some(format!("{c:?}"));
    }
    // Within the fences of a file as it is printed nothing is read.
    let mut verbatim = false;
    for line in shown.lines() {
        let fence =
            line.starts_with("```") || line == r"\begin{verbatim}" || line == r"\end{verbatim}";
        verbatim ^= fence;
        if verbatim || fence {
            continue;
        }
        match format {
            "latex" => {
                let commands = line.split('\\').skip(1).map(|rest| {
                    rest.split(|c: char| !c.is_ascii_alphabetic()).next().unwrap_or_default()
                });
                if let Some(command) = commands.into_iter().find(|command| !is_ours(command)) {
                    return Some(format!("\\{command} in {line}"));
                }
            }
            "html" | "markdown" if line.contains("<script") || line.contains("<img") => {
                return Some(line.to_owned());
            }
            "markdown" if line.replace("\\]", "").contains("](javascript") => {
                return Some(line.to_owned());
            }
            _ => {}
        }
    }
    None
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

fn file(text: &str) -> String {
    let text = quoted(text);
    format!(
        "name = \"x\"\ntitle = {text}\nequation = \"x'' + x + eps*k*x^3 = 0\"\nnotes = {text}\nsource = {text}\n\
         [parameters]\nk = {{ value = \"1/2\", meaning = {text} }}\namplitude = {{ value = \"1\", meaning = {text} }}\n"
    )
}

/// The page of an answer and its data, in all formats.
fn shown<T: serde::Serialize>(answer: &lindstedt::Answer<T>) -> Vec<(&'static str, String)>
where
    lindstedt::Answer<T>: Present,
{
    written(&answer.document()).into_iter().chain([("json", json(answer).unwrap())]).collect()
}

fn written(page: &lindstedt_report::Document) -> Vec<(&'static str, String)> {
    [
        ("text", Format::Text),
        ("latex", Format::Latex),
        ("markdown", Format::Markdown),
        ("html", Format::Html),
    ]
    .map(|(name, format)| (name, format.write(page)))
    .into()
}

fn is_data(text: &str) -> Result<(), String> {
    let oscillator = match Oscillator::file(&file(text)) {
        // As a whole it may be refused, in words that are data.
        Err(error) => {
            let said = lindstedt_report::harmless(&format!("{error} ({})", error.hint()));
            return breach("text", &said).map_or(Ok(()), Err);
        }
        Ok(oscillator) => oscillator,
    };
    let derived = oscillator.derive(1, &Work::default()).map_err(|error| error.to_string())?;
    let card = oscillator.entry();
    let pages = shown(&derived).into_iter().chain(written(&card.document()));
    for (format, shown) in pages.chain([("json", json(&card).map_err(|error| error.to_string())?)])
    {
        if let Some(breach) = breach(format, &shown) {
            return Err(format!("{format}: {breach}"));
        }
    }
    Ok(())
}

#[test]
fn payloads_are_data() {
    for payload in PAYLOADS {
        assert_eq!(is_data(payload), Ok(()), "{payload:?}");
        assert_eq!(is_data(&format!("a\n\n{payload}\n")), Ok(()), "{payload:?}");
    }
}

#[test]
fn any_text_is_data() {
    let mut g = Random(7);
    for _ in 0..60 {
        let mut text = String::new();
        for _ in 0..=g.below(5) {
            match g.below(2) {
                0 => text += g.pick(&PAYLOADS),
                _ => text
                    .extend((0..g.below(8)).filter_map(|_| char::from_u32(g.below(0x3000) as u32))),
            }
        }
        assert_eq!(is_data(&text), Ok(()), "{text:?}");
    }
}

/// What stands in the arguments and comes back in a message does not steer the terminal.
#[test]
fn messages_are_harmless() {
    for argument in ["\u{1b}[2J", "\u{1b}]0;x\u{7}.toml", "x'' + \u{9b}31m = 0", "a\u{202e}b"] {
        for format in ["text", "json"] {
            let output = lindstedt(&["derive", argument, "--format", format]);
            let said = [output.stdout, output.stderr].concat();
            let said = String::from_utf8(said).unwrap();
            assert_eq!(breach("text", &said), None, "{argument:?} {said:?}");
        }
    }
}
