//! The commands. Names are part of the public interface: add, do not rename.

use crate::arguments::Common;
use crate::derive::DeriveOptions;
use crate::evaluate::EvaluateOptions;
use crate::manual::{CompletionsOptions, ManOptions};
use crate::paper::PaperOptions;
use crate::problems::ProblemsOptions;
use crate::respond::RespondOptions;
use crate::simulate::SimulateOptions;
use crate::stability::StabilityOptions;
use crate::threshold::ThresholdOptions;
use crate::trade::TradeOptions;
use crate::verify::VerifyOptions;
use clap::{Parser, Subcommand};

/// Perturbation expansions of strongly nonlinear and non-smooth oscillators, to any order.
#[derive(Debug, Parser)]
#[command(name = "lindstedt", version, max_term_width = 100)]
#[command(about = "Perturbation expansions of strongly nonlinear and non-smooth oscillators")]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub common: Common,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// What is built in, with equation, parameters and defaults.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt problems --show duffing")]
    Problems(ProblemsOptions),
    /// Derive the expansion of a problem, order by order, and check it.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt derive duffing --order 3\n\
        \x20 lindstedt derive \"x'' + x = eps*(1 - x^4)*x'\" --normalisation free --order 3")]
    Derive(DeriveOptions),
    /// The period and the solution at given parameters, by resummation of the expansion.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt evaluate duffing --set eps=1/2 --order 12 --digits 12\n\
        \x20 lindstedt evaluate duffing --order 4 --sweep eps=0..1:3 --digits 8")]
    Evaluate(EvaluateOptions),
    /// The Melnikov threshold of homoclinic chaos: value, zeros, cusps, curves, surfaces.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt threshold stick-slip --digits 10\n\
        \x20 lindstedt threshold stick-slip --sweep vstar=0..1:5 --digits 8")]
    Threshold(ThresholdOptions),
    /// Steady states at resonance: response curves, folds, stability; all states, their number proved.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt respond \"x'' + x + eps*(x'/5 + x^3) = eps*F*cos((1 + eps*sigma)*t)\" --set eps=1/10 --set F=1/2 --sweep sigma=-1..3")]
    Respond(RespondOptions),
    /// Stability of the vibro-impact orbit: the averaged prediction beside the exact truth, charts.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt stability vibro-impact --f64\n\
        \x20 lindstedt stability vibro-impact --sweep A=-0.3..0.3:5 --sweep B=-0.3..0.3:5 --f64")]
    Stability(StabilityOptions),
    /// Speed against accuracy: every tier at every order and precision, timed, beside the truth.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt trade power-law --set n=3/2 --orders 4,16 --digits 30 --harmonics 16 --repeats 1")]
    Trade(TradeOptions),
    /// The motion in the time domain, with impacts, sticking and delay: events, sections, figures.
    #[command(after_help = "\
        Examples:\n\
        \x20 lindstedt simulate duffing --periods 1 --digits 20\n\
        \x20 lindstedt simulate vibro-impact --impacts 3 --digits 12")]
    Simulate(SimulateOptions),
    /// The expansion against the time domain: observed order of accuracy, verdict.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt verify duffing --order 3")]
    Verify(VerifyOptions),
    /// Read the paper: derive it, compare it with the print, tabulate what is true.
    #[command(after_help = "\
        Example:\n\
        \x20 lindstedt paper --quick")]
    Paper(PaperOptions),
    /// A script with which a shell completes commands and options.
    Completions(CompletionsOptions),
    /// The manual page of the program, or of one of its commands.
    Man(ManOptions),
}
