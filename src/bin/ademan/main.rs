//! The `ademan` command.

/// Says a line on standard error. Where nobody listens any more it goes on: typing does not end
/// because a log is full.
macro_rules! say {
    ($($line:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($line)*);
    }};
}

mod args;
mod control;
mod ctl;
mod demo;
mod docs;
mod doctor;
mod failure;
mod files;
mod watchdog;
mod layouts;
mod panics;
mod record;
mod recording;
mod reload;
mod replay;
mod run;
mod setup;
mod signals;
#[cfg(unix)]
mod suspension;
#[cfg(not(unix))]
#[path = "no_suspension.rs"]
mod suspension;
mod status;
mod trace;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use failure::Failure;

fn main() -> ExitCode {
    let args = Args::parse();
    start_log();
    match panics::caught(|| run(args.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Demo(args) => demo::run(&args),
        Command::Run(args) => run::run(args),
        Command::Ctl(args) => ctl::run(&args),
        Command::Record(args) => record::run(args),
        Command::Replay(args) => replay::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Layout(command) => layouts::run(&command),
        Command::Doctor(args) => doctor::run(args),
        Command::Watchdog => watchdog::run(),
        Command::Setup(args) => files::print(&args.print),
        Command::Completions { shell } => docs::completions(shell),
        Command::Man { folder } => docs::man(&folder),
    }
}

/// What the program has to say goes to standard error, one line each, without the time: it is
/// read by a person who is looking on.
fn start_log() {
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_max_level(tracing::Level::INFO)
        .without_time()
        .with_target(false)
        .with_ansi(false)
        .log_internal_errors(false)
        .init();
}
