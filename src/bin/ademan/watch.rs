//! `ademan watch`: the live view of a run that is already on.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use ademan::session::control_socket::WatchClient;
use ademan::session::view::View;
use crossbeam_channel::{Sender, bounded};

use crate::failure::Failure;
use crate::view::{self, LiveView, Views};
use crate::{ctl, messages, signals};

/// Show a running session in the terminal: boards, fingertips, values and messages
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan watch\n  ademan watch --socket /run/user/1000/sofa.sock\n\nIt shows everything that is typed, and changes nothing. Ctrl-C ends it, and the session goes on."
)]
pub struct Args {
    /// Control socket of the session. The default is the socket of `ademan run` without --control
    #[arg(long, value_name = "PATH")]
    socket: Option<PathBuf>,
}

pub fn run(args: Args) -> Result<(), Failure> {
    if !view::is_possible() {
        return Err(Failure::wrong_use(
            "standard output is no terminal in the foreground that can show a picture; `ademan ctl subscribe` prints lines instead",
        ));
    }
    let path = ctl::socket_path(args.socket)?;
    let client = WatchClient::connect(&path)?;
    messages::start()?;
    signals::install()?;
    let is_stopped = Arc::new(AtomicBool::new(false));
    let (sender, views) = bounded(1);
    let oldest = views.clone();
    let stopped = Arc::clone(&is_stopped);
    signals::on_stop(move || {
        stopped.store(true, Ordering::Relaxed);
        view::end();
    });
    let view = LiveView::open(Views::Remote(views));
    let receive = move || {
        let mut client = client;
        // A watcher that was stopped for some seconds is disconnected, and connects again.
        loop {
            forward(client, &sender, || _ = oldest.try_recv());
            match WatchClient::connect(&path) {
                Ok(next) => client = next,
                Err(_) => return,
            }
        }
    };
    let thread = thread::Builder::new().name("watch".into());
    thread.spawn(receive).map_err(Failure::no_thread)?;
    view.wait();
    if !is_stopped.load(Ordering::Relaxed) {
        say!("the session has ended");
    }
    Ok(())
}

/// Forwards views until the connection ends; each replaces one that was not drawn yet.
fn forward(mut client: WatchClient, views: &Sender<View>, drop_oldest: impl Fn()) {
    loop {
        match client.next_view() {
            Ok(Some(view)) => {
                drop_oldest();
                let _ = views.try_send(view);
            }
            Ok(None) => return,
            Err(error) => {
                tracing::warn!("{error}");
                return;
            }
        }
    }
}
