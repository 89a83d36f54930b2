//! What can be typed after `ademan`.

use std::path::PathBuf;

use ademan::capture::SourceUri;
use ademan::output::{self, Backend};
use ademan::pipeline::SourceRole;
use ademan::trace::Stage;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args as ClapArgs, Parser, Subcommand};
use clap_complete::Shell;

/// Turns a captured hand into any input device: glove bytes in, events out.
#[derive(Parser)]
#[command(
    version,
    propagate_version = true,
    after_help = "Begin with `ademan demo`: it needs no glove."
)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Watch a simulated hand type or play a script, through the whole way from glove bytes to text
    Demo(DemoArgs),
    /// Type with a glove
    Run(RunArgs),
    /// Ask a run for something: how it is, to pause, to read its layout again, to end
    Ctl(CtlArgs),
    /// Record a source, and what every stage makes of it, without typing
    Record(RecordArgs),
    /// Play a recording through the same way again
    Replay(ReplayArgs),
    /// Print what a stage makes of a source, one JSON object per line
    Trace(TraceArgs),
    /// Check, list and draw layouts
    #[command(subcommand)]
    Layout(LayoutCommand),
    /// Say what of this machine a setup needs, what is missing, and what mends it
    Doctor(DoctorArgs),
    /// What the program starts for itself, to let go of keys when it cannot
    #[command(name = crate::watchdog::COMMAND, hide = true)]
    Watchdog,
    /// Print the files that give a user access to devices, and those that start a run with the session
    Setup(FilesArgs),
    /// Print a completion script for a shell
    #[command(
        after_help = "Example: ademan completions bash > ~/.local/share/bash-completion/completions/ademan"
    )]
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Write the manual pages into a folder
    #[command(after_help = "Example: ademan man ~/.local/share/man/man1")]
    Man {
        /// Where to; it is made if need be
        #[arg(default_value = ".")]
        folder: PathBuf,
    },
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan demo\n  ademan demo --text 'ademan: a gesture of the hand' --layout qwerty-arc --baud 9600\n  ademan demo --layout arrows --script 'push ArrowUp 0.6; wait 500; lift; tap ArrowLeft'\n  sleep 3; ademan demo --output desktop     (types into the window that has the focus by then)"
)]
pub struct DemoArgs {
    /// What to type: characters of a US keyboard; a text that goes with the layout unless said
    #[arg(long)]
    pub text: Option<String>,
    /// Play this script instead: a file, or orders such as 'press Q; wait 300; lift' (docs/scripts.md)
    #[arg(long, value_name = "FILE_OR_TEXT", conflicts_with = "text")]
    pub script: Option<String>,
    /// The layout: a shipped name (see `ademan layout list`) or a file
    #[arg(long, default_value = "qwerty-flat")]
    pub layout: String,
    /// Bits per second on the simulated serial line
    #[arg(long, default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(1200..=4_000_000))]
    pub baud: u32,
    /// Where events go besides the screen: none, transcript, transcript:PATH, desktop or uinput, or
    /// several of them, as in desktop,uinput
    #[arg(long, default_value = "none")]
    pub output: String,
    /// Noise on every channel of the glove, as a standard deviation in counts
    #[arg(long, default_value_t = 0.0, value_parser = noise, allow_negative_numbers = true)]
    pub noise: f64,
    /// Where the noise starts
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// Flags that override a setup file.
#[derive(Clone, ClapArgs)]
pub struct SetupArgs {
    /// Where readings come from: serial:PORT, tcp:HOST:PORT, file:PATH, recording:PATH,
    /// typist:TEXT or script:FILE; lines take ?protocol=hc11&framing=double06&baud=115200
    #[arg(long)]
    pub source: Option<SourceUri>,
    /// What may come of the source: pointer, keys or both; both unless said, and pointer of one on the network
    #[arg(long, value_parser = role())]
    pub role: Option<SourceRole>,
    /// The glove: a shipped name or a file
    #[arg(long)]
    pub glove: Option<String>,
    /// The layout: a shipped name (see `ademan layout list`) or a file
    #[arg(long)]
    pub layout: Option<String>,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan run --source typist:hello\n  ademan run --source 'serial:/dev/ttyUSB0?baud=9600' --output desktop\n  ademan run my-setup.ron --record today.mcap\n  ademan run my-setup.ron --wait\n\nIt starts paused, and types once the hand was seen off all keys for 300 ms. A layout file that is saved meanwhile is used at once. Ctrl-C lets go of everything and ends."
)]
pub struct RunArgs {
    /// A setup file, such as examples/setup.ron; the flags below go before what it says
    pub setup: Option<String>,
    #[command(flatten)]
    pub parts: SetupArgs,
    /// Where events go: transcript, transcript:PATH, desktop, uinput or none, or several of them, as in
    /// desktop,uinput: each kind of event goes to the first that can carry it, and all to transcripts
    #[arg(long)]
    pub output: Option<String>,
    /// Also record everything to this file (it will hold what you type)
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Wait for a device that is not there yet, instead of giving up
    #[arg(long)]
    pub wait: bool,
    /// Type from the first reading on, without waiting for the hand to be off all keys
    #[arg(long)]
    pub armed: bool,
    /// Run even as root
    #[arg(long)]
    pub allow_root: bool,
    /// The socket for `ademan ctl`, or `off`; in $XDG_RUNTIME_DIR unless said
    #[arg(long, value_name = "PATH|off")]
    pub control: Option<PathBuf>,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan ctl state\n  ademan ctl pause\n  ademan ctl nudge 0 0 -5 && ademan ctl save\n  ademan ctl subscribe --json\n\nThe exit code is 0 if it is done, 1 if it is refused and 2 if no run can be reached."
)]
pub struct CtlArgs {
    #[command(subcommand)]
    pub request: CtlRequest,
    /// The socket of the run; that of `ademan run` without --control unless said
    #[arg(long, global = true, value_name = "PATH")]
    pub socket: Option<PathBuf>,
    /// Print the answer as it comes: JSON
    #[arg(long, global = true)]
    pub json: bool,
}

#[derive(Subcommand)]
pub enum CtlRequest {
    /// Say how the run is
    State,
    /// Let go of everything and type nothing
    Pause,
    /// Go on, once the hand was seen off all keys
    Resume,
    /// Read the layout file again
    Reload,
    /// Put another layout of the setup in force
    Profile {
        /// Its name
        name: String,
    },
    /// Put the layout after the one in force there
    NextProfile,
    /// Bring the boards below the index fingertip of the hand seen last
    Recentre,
    /// Move the boards, in mm: to the right, up, towards you
    #[command(allow_negative_numbers = true)]
    Nudge {
        /// To the right
        x_mm: f64,
        /// Up
        y_mm: f64,
        /// Towards you
        z_mm: f64,
    },
    /// Turn each board about its own rows: the far edge rises
    #[command(allow_negative_numbers = true)]
    Tilt {
        /// By so many degrees
        deg: f64,
    },
    /// Make the boards larger or smaller
    Scale {
        /// So many times as large: 0.5 to 2
        factor: f64,
    },
    /// Write where the boards are into the layout file
    Save,
    /// Print what happens, what is typed included, until the run ends
    Subscribe,
    /// Let go of everything and end the run
    Stop,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan doctor --source serial:/dev/ttyUSB0 --output uinput\n  ademan doctor my-setup.ron --json\n  ademan doctor --test desktop\n\nThe exit code is 0 if all that the setup needs is there, and 1 if not."
)]
pub struct DoctorArgs {
    /// A setup file; the flags below go before what it says
    pub setup: Option<String>,
    #[command(flatten)]
    pub parts: SetupArgs,
    /// Where events are to go, as of `ademan run`
    #[arg(long)]
    pub output: Option<String>,
    /// Use an output for a second without a visible effect
    #[arg(long, value_name = "OUTPUT", value_parser = testable_output())]
    pub test: Vec<&'static Backend>,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan setup --print udev | sudo tee /etc/udev/rules.d/60-ademan.rules\n  ademan setup --print unit > ~/.config/systemd/user/ademan.service"
)]
pub struct FilesArgs {
    /// Which file
    #[arg(long, value_name = "FILE", default_value = "all", value_parser = PossibleValuesParser::new(crate::files::names()))]
    pub print: String,
}

#[derive(ClapArgs)]
#[command(after_help = "Example: ademan record --source serial:/dev/ttyUSB0 session.mcap")]
pub struct RecordArgs {
    /// The recording to write; an existing file is not overwritten
    pub file: PathBuf,
    /// A setup file
    #[arg(long)]
    pub setup: Option<String>,
    #[command(flatten)]
    pub parts: SetupArgs,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan replay session.mcap\n  ademan replay session.mcap --layout my-board.ron --speed 1"
)]
pub struct ReplayArgs {
    /// The recording
    pub file: PathBuf,
    /// The glove, instead of the recorded one
    #[arg(long)]
    pub glove: Option<String>,
    /// The layout, instead of the recorded one
    #[arg(long)]
    pub layout: Option<String>,
    /// Where events go, as of `ademan run`; only by name do they reach the desktop
    #[arg(long, default_value = "transcript")]
    pub output: String,
    /// How many times as fast as it was; as fast as possible unless said
    #[arg(long, value_parser = speed, allow_negative_numbers = true)]
    pub speed: Option<f64>,
}

#[derive(ClapArgs)]
#[command(
    after_help = "Examples:\n  ademan trace angles --source serial:/dev/ttyUSB0 | head\n  ademan trace touches --source 'typist:hello' --layout qwerty-arc"
)]
pub struct TraceArgs {
    /// The stage after which to look
    #[arg(value_parser = stage())]
    pub stage: Stage,
    /// A setup file
    #[arg(long)]
    pub setup: Option<String>,
    #[command(flatten)]
    pub parts: SetupArgs,
}

#[derive(Subcommand)]
pub enum LayoutCommand {
    /// Begin a layout of your own as a copy of another
    #[command(after_help = "Example: ademan layout new my-board --from qwerty-arc")]
    New {
        /// The file to write (.ron is added); an existing one is not overwritten
        file: PathBuf,
        /// The layout to begin with: a shipped name or a file
        #[arg(long, default_value = "qwerty-flat")]
        from: String,
    },
    /// Say whether files are right, where they are wrong, and which keys the default hand cannot reach
    #[command(after_help = "Example: ademan layout check my-board.ron")]
    Check {
        /// Layout files, or names of shipped ones
        #[arg(required = true)]
        files: Vec<String>,
    },
    /// List the layouts that come with the program
    #[command(after_help = "Example: ademan layout list")]
    List,
    /// Draw a layout
    #[command(after_help = "Example: ademan layout show qwerty-arc --svg board.svg")]
    Show {
        /// A layout file, or the name of a shipped one
        file: String,
        /// Write a picture from above here
        #[arg(long, value_name = "OUT.svg")]
        svg: Option<PathBuf>,
    },
}

fn role() -> impl TypedValueParser<Value = SourceRole> {
    PossibleValuesParser::new(SourceRole::ALL.map(SourceRole::name)).map(|name| {
        let role = SourceRole::ALL.into_iter().find(|role| role.name() == name);
        role.expect("it is one of the names of roles")
    })
}

fn stage() -> impl TypedValueParser<Value = Stage> {
    PossibleValuesParser::new(Stage::ALL.iter().map(|stage| stage.name()))
        .map(|name| name.parse().expect("it is one of the names of stages"))
}

fn testable_output() -> impl TypedValueParser<Value = &'static Backend> {
    let testable = output::BACKENDS
        .iter()
        .filter(|backend| backend.check.is_some());
    PossibleValuesParser::new(testable.map(|backend| backend.name))
        .map(|name| output::find_backend(&name).expect("the parser accepts names of backends"))
}

fn noise(text: &str) -> Result<f64, String> {
    in_range(text, 0.0, 50.0, "counts")
}

fn speed(text: &str) -> Result<f64, String> {
    in_range(text, 0.01, 1000.0, "times")
}

fn in_range(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number: f64 = text
        .parse()
        .map_err(|_| format!("`{text}` is not a number"))?;
    if (low..=high).contains(&number) {
        return Ok(number);
    }
    Err(format!("it is {low} to {high} {unit}"))
}
