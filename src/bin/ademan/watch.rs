//! `ademan watch`: the live view of a run that is already on.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use ademan::session::control_socket::WatchClient;

use crate::failure::Failure;
use crate::view::{self, LiveView, Views};
use crate::{ctl, messages, pause_signals, signals};

/// Show a running session in the terminal: boards, fingertips, values and messages
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan watch\n  ademan watch --socket /run/user/1000/sofa.sock\n\nIt shows everything that is typed, and changes nothing. Ctrl-C ends it, and the session continues."
)]
pub struct Args {
    /// Control socket of the session. The default is the socket of `ademan run` without --control
    #[arg(long, value_name = "PATH")]
    socket: Option<PathBuf>,
}

pub fn run(args: Args) -> Result<(), Failure> {
    if !view::is_possible() {
        return Err(Failure::wrong_use(
            "standard output is not a terminal in the foreground that can show a picture; `ademan ctl subscribe` prints lines instead",
        ));
    }
    let path = ctl::socket_path(args.socket)?;
    let client = WatchClient::connect(&path)?;
    messages::start()?;
    signals::install()?;
    let is_stopped = Arc::new(AtomicBool::new(false));
    let viewer = client.into_viewer(&path).map_err(Failure::no_thread)?;
    let stopped = Arc::clone(&is_stopped);
    signals::on_stop(move || {
        stopped.store(true, Ordering::Relaxed);
        view::end();
    });
    pause_signals::install_without_session()?;
    let view = LiveView::open(Views::Remote(viewer));
    view.wait();
    if !is_stopped.load(Ordering::Relaxed) {
        say!("the session has ended");
    }
    Ok(())
}
