//! The window on the session of another program.

use std::path::{Path, PathBuf};

use ademan::message::escape_path;
use ademan::session::control_socket::{self, ControlError, WatchClient};
use ademan::session::{Session, SessionOptions};
use ademan::setup::Setup;
use ademan::studio::attached::Attached;
use ademan::studio::{StudioApp, StudioError, open_window, texts};

use super::window::{NO_OUTPUT, PICTURES, end, language, with_settings};
use super::{Args, source};
use crate::failure::Failure;
use crate::{ctl, panics, pause_signals, session, signals};

/// The value of `--attach` for a session of its own.
const OFF: &str = "off";

/// A connection to a session, and the path of its control socket.
pub struct Found {
    client: WatchClient,
    path: PathBuf,
}

/// Connects to the session that `--attach` names or, without arguments, to the one at the default control socket. Returns `None` for a
/// session of its own.
pub fn find(args: &Args) -> Result<Option<Found>, Failure> {
    let path = match &args.attach {
        Some(Some(path)) if path == Path::new(OFF) => return Ok(None),
        Some(path) => ctl::socket_path(path.clone())?,
        None if args.is_plain() => match control_socket::default_path() {
            Some(path) => path,
            None => return Ok(None),
        },
        None => return Ok(None),
    };
    match WatchClient::connect(&path) {
        Ok(client) => Ok(Some(Found { client, path })),
        Err(error) if args.attach.is_some() => Err(error.into()),
        // No session runs.
        Err(ControlError::Connect { .. }) => Ok(None),
        Err(error) => {
            complain!("{error}\nthe window opens a session of its own");
            Ok(None)
        }
    }
}

/// Shows a session until the window is closed. The session continues.
pub fn open(found: Found) -> Result<(), Failure> {
    let Found { client, path } = found;
    session::prepare()?;
    texts::set_language(language());
    say!(
        "this window shows the session at {}, which continues when the window is closed; for a session of its own: ademan studio --attach {OFF}",
        escape_path(&path)
    );
    let attached = Attached::new(client, &path).map_err(Failure::no_thread)?;
    // It has no readings and no output: the panels have a setup.
    let setup = Setup {
        output: NO_OUTPUT.into(),
        ..Setup::default()
    };
    let options = SessionOptions {
        source: Some(Box::new(source::NoReadings)),
        ..SessionOptions::default()
    };
    let quiet = Session::start(setup.load_files()?, options)?;
    // SIGUSR1 to all programs of this name pauses the session that is shown, which is in another program, and does not end the window.
    pause_signals::install_without_session()?;
    let app = StudioApp::new(&quiet).and_then(|app| app.with_attached(attached));
    let app = app.map_err(|error: StudioError| Failure::job(error.to_string()))?;
    let app = with_settings(app.with_pictures(PICTURES));
    let shown = panics::contain(|| open_window(app.into(), signals::is_stop_requested));
    end(shown, None)
}
