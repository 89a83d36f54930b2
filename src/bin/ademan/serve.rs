//! `ademan serve`: the page in which layouts are tried in a browser.

use std::env;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use ademan::message::escape;
use ademan::share::{PageFolder, PageServer};
use crossbeam_channel::bounded;

use crate::failure::Failure;
use crate::signals;

/// The program that opens a page.
const OPENER: &str = if cfg!(target_os = "macos") {
    "open"
} else if cfg!(windows) {
    "explorer"
} else {
    "xdg-open"
};

/// Try and edit layouts in a browser, with a simulated hand, a mouse or a finger
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan serve\n  ademan serve --port 8090 --open\n  ademan serve --dir target/web\n\nThe page is built by `web/build` in the sources (docs/web.md). Only this machine can open it, and it types nothing outside of the browser."
)]
pub struct Args {
    /// Port at 127.0.0.1; 0 for any free one
    #[arg(long, default_value_t = 8081)]
    port: u16,
    /// Folder of the page. The default is `web` beside the program, or `share/ademan/web` beside its folder
    #[arg(long, value_name = "FOLDER")]
    dir: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let folder = args.dir.unwrap_or_else(default_folder);
    let folder = PageFolder::read(&folder).map_err(|error| Failure::job(error.to_string()))?;
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, args.port));
    let server = PageServer::start(address, folder);
    let server = server.map_err(|error| Failure::job(error.to_string()))?;
    let url = format!("http://{}/", server.address());
    let (stop, stopped) = bounded(1);
    signals::install()?;
    signals::on_stop(move || _ = stop.try_send(()));
    say!("the page is at {url}; Ctrl-C ends");
    if args.open {
        open(&url);
    }
    // The sender lives as long as the program.
    let _ = stopped.recv();
    Ok(())
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
