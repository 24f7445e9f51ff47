//! `lindstedt completions` and `lindstedt man`: what the arguments say of themselves, in the forms of shells and
//! of `man`.

use crate::failure::Failure;
use crate::session::Session;
use crate::{Outcome, output};
use clap::{Args, Command};

#[derive(Debug, Args)]
pub struct CompletionsOptions {
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManOptions {
    /// A command; without it the program.
    #[arg(value_name = "COMMAND")]
    pub of: Option<String>,
}

pub fn completions(
    options: &CompletionsOptions,
    mut command: Command,
    session: &Session<'_>,
) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut command, "lindstedt", &mut script);
    written(&script, session)
}

pub fn page(options: &ManOptions, mut command: Command, session: &Session<'_>) -> Outcome {
    // The options of every command go to each of them.
    command.build();
    if let Some(name) = &options.of {
        let found = command.find_subcommand(name).cloned();
        command = found.ok_or_else(|| {
            Failure::usage("usage", format!("there is no command {name:?}"), "lindstedt --help")
        })?;
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|error| output::trouble("the page", &error))?;
    written(&page, session)
}

fn written(text: &[u8], session: &Session<'_>) -> Outcome {
    output::write(session.out(), &String::from_utf8_lossy(text))?;
    Ok(0)
}
