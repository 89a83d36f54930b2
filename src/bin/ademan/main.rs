//! The `ademan` command.

/// Prints a message on standard error, see [`messages`].
macro_rules! say {
    ($($message:tt)*) => {
        crate::messages::print(&format!($($message)*))
    };
}

/// Prints an error or a warning on standard error, also with `--quiet`.
macro_rules! complain {
    ($($message:tt)*) => {
        crate::messages::print_error(&format!($($message)*))
    };
}

/// Declares the subcommands, each with the module that holds its `Args` and its `run`.
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

mod arm;
mod body;
mod bridge;
mod calibrate;
mod cameras;
mod complete;
mod completions;
mod ctl;
mod delay;
mod demo;
mod doctor;
mod export;
mod failure;
mod field_list;
mod glove;
mod gloves;
#[cfg(feature = "tls")]
mod headset_link;
mod key_list;
mod lab;
mod layout;
mod layout_check;
mod layouts;
mod link;
mod list;
mod man;
mod messages;
mod new_file;
mod output_list;
mod outputs;
#[cfg(test)]
mod own_process;
mod panics;
mod pause_signals;
mod person;
mod picture;
mod practice;
mod record;
mod recording_size;
mod release_keys;
mod replay;
mod result_files;
mod root_args;
mod run;
mod schema;
mod script;
mod sensor_tables;
mod serve;
mod session;
mod setup;
mod setup_args;
mod share;
mod signal_mask;
mod signals;
mod sound;
mod source_value;
mod sources;
mod start;
mod stats;
mod studio;
mod system_files;
mod text;
mod token;
mod trace;
mod traced_setup;
mod usage;
mod view;
mod watch;
mod watchdog;
mod webcam;

use std::process::ExitCode;

use failure::Failure;

/// Turns a captured hand into any input device: sensor readings in, key and pointer events out.
#[derive(clap::Parser)]
#[command(
    // Not the name under which the program is started, which a link may choose.
    bin_name = "ademan",
    version,
    propagate_version = true,
    after_help = "Start with `ademan demo`: it needs no glove. `ademan start` sets up your device.\n\nExamples:\n  ademan start\n  ademan demo\n  ademan run --source typist:hello\n  ademan run --source 'serial:/dev/ttyUSB0?baud=9600' --output desktop"
)]
struct Cli {
    #[command(subcommand)]
    command: Subcommand,
    #[command(flatten)]
    messages: messages::LogArgs,
}

subcommands! {
    Demo(demo),
    Start(start),
    Practice(practice),
    Run(run),
    Webcam(webcam),
    Share(share),
    Serve(serve),
    Studio(studio),
    Watch(watch),
    Ctl(ctl),
    Calibrate(calibrate),
    #[command(subcommand)]
    Cameras(cameras),
    #[command(subcommand)]
    Arm(arm),
    #[command(subcommand)]
    Body(body),
    Record(record),
    Replay(replay),
    Export(export),
    Trace(trace),
    Delay(delay),
    #[command(subcommand)]
    Layout(layout),
    #[command(subcommand)]
    Lab(lab),
    #[command(subcommand)]
    Bridge(bridge),
    /// List the kinds of source, and the protocols of streams
    #[command(after_help = "Example: ademan sources --json")]
    Sources(sources),
    /// List the outputs
    #[command(after_help = "Example: ademan outputs --json")]
    Outputs(outputs),
    /// List the layouts that come with the program, and the ones in the configuration folder
    #[command(after_help = "Example: ademan layouts --json")]
    Layouts(layouts),
    /// List the gloves that come with the program, and the ones in the configuration folder
    #[command(after_help = "Example: ademan gloves")]
    Gloves(gloves),
    #[command(subcommand)]
    Glove(glove),
    #[command(subcommand)]
    Person(person),
    #[command(subcommand)]
    Setup(setup),
    Schema(schema),
    #[command(subcommand)]
    Script(script),
    #[command(subcommand)]
    Text(text),
    #[command(subcommand)]
    Token(token),
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
    completions::answer();
    let cli = usage::parse();
    let code = match panics::catch(|| {
        // Before any thread is started, as threads inherit the mask.
        cli.command.block_signals()?;
        messages::install(&cli.messages)?;
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
            // They may run or wait for long, and type nothing.
            Self::Arm(_)
            | Self::Body(_)
            | Self::Bridge(_)
            | Self::Calibrate(_)
            | Self::Cameras(_)
            | Self::Ctl(_)
            | Self::Delay(_)
            | Self::Export(_)
            | Self::Lab(_)
            | Self::Record(_)
            | Self::Share(_)
            | Self::Start(_)
            | Self::Text(_)
            | Self::Trace(_) => signal_mask::block_emergency_stop(),
            _ => signal_mask::block_unused(),
        }
    }
}
