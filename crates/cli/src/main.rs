//! The command line `lindstedt`: reads arguments, calls the library, prints. The only place
//! with files and a terminal.
#![warn(clippy::too_many_lines)]

mod arguments;
mod command;
mod derive;
mod evaluate;
mod failure;
mod manual;
mod output;
mod paper;
mod problems;
mod respond;
mod session;
mod simulate;
mod stability;
mod terminal;
mod threshold;
mod trade;
mod verify;
mod watch;

use clap::{CommandFactory, Parser};
use command::{Arguments, Command};
use failure::Failure;
use session::Session;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return failure::usage(&error),
    };
    let session = Session::start(&arguments.common);
    let outcome = match &arguments.command {
        Command::Problems(options) => problems::run(options, &session),
        Command::Derive(options) => derive::run(options, &session),
        Command::Evaluate(options) => evaluate::run(options, &session),
        Command::Threshold(options) => threshold::run(options, &session),
        Command::Simulate(options) => simulate::run(options, &session),
        Command::Verify(options) => verify::run(options, &session),
        Command::Respond(options) => respond::run(options, &session),
        Command::Stability(options) => stability::run(options, &session),
        Command::Trade(options) => trade::run(options, &session),
        Command::Paper(options) => paper::run(options, &session),
        Command::Completions(options) => {
            manual::completions(options, Arguments::command(), &session)
        }
        Command::Man(options) => manual::page(options, Arguments::command(), &session),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(failure) => session.failed(failure).report(session.format()),
    }
}

/// The exit code of a command, or why it failed.
type Outcome = Result<u8, Failure>;
