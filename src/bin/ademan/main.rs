//! The `ademan` command.

/// Prints a message on standard error, see [`messages`].
macro_rules! say {
    ($($message:tt)*) => {
        crate::messages::print(&format!($($message)*))
    };
}

/// Declares the subcommands: one line each, with the module that holds its `Args` and its `run`.
macro_rules! subcommands {
    ($($(#[$meta:meta])* $name:ident($module:ident),)+) => {
        #[derive(clap::Subcommand)]
        enum Subcommand {
            $($(#[$meta])* $name($module::Args),)+
        }

        impl Subcommand {
            fn run(self) -> Result<(), Failure> {
                match self {
                    $(Self::$name(args) => $module::run(args),)+
                }
            }
        }
    };
}

mod completions;
mod ctl;
mod delay;
mod demo;
mod doctor;
mod export;
mod failure;
mod gloves;
mod layout;
mod list;
mod man;
mod messages;
mod output_list;
mod outputs;
mod panics;
mod pause_signals;
mod picture;
mod record;
mod release_keys;
mod replay;
mod run;
mod session;
mod setup_args;
mod signal_mask;
mod signals;
mod source_value;
mod sources;
mod stats;
mod system_files;
mod trace;
mod view;
mod watch;
mod watchdog;

use std::process::ExitCode;

use clap::Parser;

use failure::Failure;

/// Turns a captured hand into any input device: sensor readings in, key and pointer events out.
#[derive(Parser)]
#[command(
    version,
    propagate_version = true,
    after_help = "Start with `ademan demo`: it needs no glove."
)]
struct Cli {
    #[command(subcommand)]
    command: Subcommand,
}

subcommands! {
    Demo(demo),
    Run(run),
    Watch(watch),
    Ctl(ctl),
    Record(record),
    Replay(replay),
    Export(export),
    Trace(trace),
    Delay(delay),
    Layout(layout),
    Sources(sources),
    Outputs(outputs),
    Gloves(gloves),
    Doctor(doctor),
    #[command(name = watchdog::COMMAND, hide = true)]
    Watchdog(watchdog),
    #[command(name = release_keys::COMMAND, hide = true)]
    ReleaseKeys(release_keys),
    #[command(name = "system-files")]
    SystemFiles(system_files),
    Completions(completions),
    Man(man),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    messages::install_log();
    let code = match panics::catch(|| {
        // Before any thread is started, as threads inherit the mask.
        cli.command.block_signals()?;
        cli.command.run()
    }) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    };
    // An error at the start of a session comes before its view.
    view::abandon();
    messages::flush();
    code
}

impl Subcommand {
    /// Ignores the signals that the subcommand has no use for.
    fn block_signals(&self) -> Result<(), Failure> {
        match self {
            Self::Watchdog(_) => signal_mask::block_all(),
            _ => signal_mask::block_unused(),
        }
    }
}
