//! Options for the messages of the program, which all subcommands have.

use ademan::message::escape;
use std::env;
use std::path::PathBuf;

use clap::ArgAction;
use tracing_subscriber::filter::{LevelFilter, Targets};

/// The environment variable with the levels of log messages.
const VARIABLE: &str = "RUST_LOG";

/// Libraries that report peculiarities of a desktop which a person cannot change. `--verbose` prints them too.
const TOOLKITS: [&str; 6] = ["calloop", "eframe", "egui", "glutin", "sctk", "winit"];

/// Options for messages.
#[derive(clap::Args)]
#[command(next_help_heading = "Messages")]
pub struct LogArgs {
    /// Print more messages; twice for all. RUST_LOG=ademan::capture=debug chooses by module
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
    /// Print errors and warnings only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Append all messages with their time to this file, which only you can read
    #[arg(long, global = true, value_name = "FILE")]
    pub log: Option<PathBuf>,
}

/// The messages that are printed.
pub struct Verbosity {
    /// Levels of log messages.
    pub levels: Targets,
    /// Only errors and warnings are printed.
    pub is_quiet: bool,
}

impl LogArgs {
    /// Returns the messages to print. Flags take precedence over `RUST_LOG`; an error states why the variable has no effect.
    pub fn verbosity(&self) -> (Verbosity, Option<String>) {
        let level = match (self.quiet, self.verbose) {
            (true, _) => Some(LevelFilter::WARN),
            (false, 0) => None,
            (false, 1) => Some(LevelFilter::DEBUG),
            (false, _) => Some(LevelFilter::TRACE),
        };
        let from = |limit| Targets::new().with_default(limit);
        let variable = env::var(VARIABLE).ok().filter(|levels| !levels.is_empty());
        let (levels, error) = match (level, variable.as_deref().map(str::parse::<Targets>)) {
            (Some(level), _) => (from(level), None),
            (None, None) => (default_levels(), None),
            (None, Some(Ok(levels))) => (levels, None),
            (None, Some(Err(error))) => {
                let message = format!(
                    "{VARIABLE} has no effect: {}; write a level such as `debug`, or `ademan::capture=debug`",
                    escape(&error.to_string())
                );
                (default_levels(), Some(message))
            }
        };
        let is_quiet = self.quiet;
        (Verbosity { levels, is_quiet }, error)
    }
}

fn default_levels() -> Targets {
    let toolkits = TOOLKITS.map(|name| (name, LevelFilter::ERROR));
    let levels = Targets::new().with_default(LevelFilter::INFO);
    levels.with_targets(toolkits)
}
