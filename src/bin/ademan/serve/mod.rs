//! `ademan serve`: the page in which layouts are tried in a browser, and its server for a headset.

#[cfg(feature = "tls")]
mod lan;

use std::env;
use std::net::{Ipv4Addr, SocketAddr};
#[cfg(not(feature = "tls"))]
use std::path::Path;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use ademan::message::escape;
use ademan::share::{PageFolder, PageServer};
use crossbeam_channel::bounded;

use crate::failure::Failure;
use crate::{pause_signals, signals};

/// The program that opens a page.
const OPENER: &str = if cfg!(target_os = "macos") {
    "open"
} else if cfg!(windows) {
    "explorer"
} else {
    "xdg-open"
};

/// The port without `--lan`.
const PORT: u16 = 8081;

/// Try and edit layouts in a browser, with a simulated hand, a mouse or a finger; with --lan, type with a headset
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan serve\n  ademan serve --port 8090 --open\n  ademan serve --dir target/web\n  ademan serve --lan --layout qwerty-flat --output desktop\n\nThe page is built by `web/build` in the sources (docs/web.md). Without --lan only this machine can open it, and it types nothing outside of the browser."
)]
pub struct Args {
    /// Port; 0 for any free one. The default is 8081, and 8443 with --lan
    #[arg(long)]
    port: Option<u16>,
    /// Folder of the page. The default is `web` beside the program or its folder, or `share/ademan/web` beside its folder
    #[arg(long, value_name = "FOLDER")]
    dir: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long, conflicts_with = "lan")]
    open: bool,
    /// Serve the page to a headset on the network over TLS, and run a session with its hands, which only points until you allow
    /// keys. The address of this machine is found, unless there are several networks. The other settings of the session come from
    /// setup.ron in the configuration folder, if it exists
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "")]
    lan: Option<String>,
    #[command(flatten)]
    session: SessionArgs,
}

/// The flags of the session with a headset; `ademan run` explains them.
#[derive(clap::Args)]
#[cfg_attr(not(feature = "tls"), allow(dead_code, reason = "there is no session"))]
struct SessionArgs {
    /// Layout of the session, which the page shows, too: a name or a file, or a link with --trust
    #[arg(long, requires = "lan", default_value = "qwerty-flat")]
    layout: String,
    /// Use the layout of a link, which somebody else made
    #[arg(long, requires = "lan")]
    trust: bool,
    /// Outputs, separated by commas, as of `ademan run`
    #[arg(
        long,
        requires = "lan",
        value_name = "OUTPUTS",
        default_value = "transcript"
    )]
    output: String,
    /// Display, as of `ademan run`: the link stays visible with `log`
    #[arg(long, requires = "lan", value_name = "KIND", default_value = "log")]
    view: String,
    /// Control socket, as of `ademan run`
    #[arg(long, requires = "lan", value_name = "PATH|off")]
    control: Option<PathBuf>,
    /// Run as root with an output that types
    #[arg(long, requires = "lan")]
    allow_root: bool,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let folder = args.dir.unwrap_or_else(default_folder);
    if let Some(address) = &args.lan {
        return run_lan(address, args.port, &folder, &args.session);
    }
    let folder = PageFolder::read(&folder).map_err(|error| Failure::job(error.to_string()))?;
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, args.port.unwrap_or(PORT)));
    let server = PageServer::start(address, folder);
    let server = server.map_err(|error| Failure::job(error.to_string()))?;
    let url = format!("http://{}/", server.address());
    let (stop, stopped) = bounded(1);
    signals::install()?;
    signals::on_stop(move || _ = stop.try_send(()));
    // SIGUSR1 to all programs of this name stops their typing, and no page.
    pause_signals::install_without_session()?;
    say!("the page is at {url}; Ctrl-C ends");
    if args.open {
        open(&url);
    }
    // The sender lives as long as the program.
    let _ = stopped.recv();
    Ok(())
}

#[cfg(feature = "tls")]
use lan::run as run_lan;

/// Returns the reason why there is no server for a headset.
#[cfg(not(feature = "tls"))]
fn run_lan(_: &str, _: Option<u16>, _: &Path, _: &SessionArgs) -> Result<(), Failure> {
    Err(Failure::wrong_use(
        "this program was built without TLS, which `--lan` needs: build it with `cargo build --release --features tls`",
    ))
}

/// Returns the folder beside the program that has a page, or the first one that is looked for.
fn default_folder() -> PathBuf {
    let program = env::current_exe().unwrap_or_default();
    let beside = program.parent().map(PathBuf::from).unwrap_or_default();
    // `target/debug/ademan` is beside `target/web`.
    let folders = ["web", "../web", "../share/ademan/web"].map(|folder| beside.join(folder));
    let built = folders.iter().find(|it| it.join("index.html").is_file());
    built.unwrap_or(&folders[0]).clone()
}

fn open(url: &str) {
    let mut command = Command::new(OPENER);
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null());
    if let Err(error) = command.stderr(Stdio::null()).spawn() {
        complain!(
            "warning: cannot start {OPENER}: {}; open {url} yourself",
            escape(&error.to_string())
        );
    }
}
