//! Another session that the window shows, in a program of its own: its views, and commands to it, through its control socket.
//!
//! ```text
//!  control socket ─ thread `watch` ─ newest view ──▶ StudioModel ──▶ panels
//!                ◀─ thread `attached` ◀───────── Command ◀─────────────┘
//! ```
//!
//! Neither end waits for the other one: the window receives the newest view, and commands wait in a queue.

use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, TryRecvError, TrySendError, bounded};

use super::error::StudioError;
use super::model::StudioModel;
use super::sensors::SensorTable;
use ademan_core::command::Command;
use ademan_runtime::session::RequestError;
use ademan_runtime::session::control_socket::{Client, WatchClient};
use ademan_runtime::session::view::Viewer;

/// Commands that wait for the session.
const QUEUED_COMMANDS: usize = 8;

/// Refused commands whose reasons wait for the window.
const QUEUED_REASONS: usize = 8;

/// Time in which the first view arrives. The session sends it at once.
const FIRST_VIEW_TIMEOUT: Duration = Duration::from_secs(5);

/// A session of another program. It continues when this is dropped.
pub struct Attached {
    path: PathBuf,
    viewer: Viewer,
    commands: Sender<Command>,
    reasons: Receiver<String>,
}

impl Attached {
    /// Starts the threads of a connection to the session whose socket is at `path`.
    pub fn new(client: WatchClient, path: &Path) -> io::Result<Self> {
        let viewer = client.into_viewer(path)?;
        let (commands, queue) = bounded(QUEUED_COMMANDS);
        let (sender, reasons) = bounded(QUEUED_REASONS);
        let path = path.to_owned();
        let socket = path.clone();
        let thread = thread::Builder::new().name("attached".into());
        thread.spawn(move || send_all(&socket, &queue, &sender))?;
        Ok(Self {
            path,
            viewer,
            commands,
            reasons,
        })
    }

    /// Returns the path of its control socket.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Waits up to 5 s for the first view, and returns the model of it.
    ///
    /// # Errors
    /// If the session has ended.
    pub fn first_model(&self) -> Result<StudioModel, StudioError> {
        let view = self.viewer.views().recv_timeout(FIRST_VIEW_TIMEOUT);
        let view = view.map_err(|_| StudioError::Ended)?;
        let mut model = StudioModel::new(view.clone(), SensorTable::default());
        model.update_from_view(view);
        Ok(model)
    }

    /// Updates the model to the newest view. Does not wait. Returns `false` if there is none.
    pub fn update(&self, model: &mut StudioModel) -> bool {
        match self.viewer.views().try_recv() {
            Ok(view) => {
                model.update_from_view(view);
                return true;
            }
            Err(TryRecvError::Disconnected) => model.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
        false
    }

    /// Sends a command. Does not wait.
    ///
    /// # Errors
    /// If too many commands wait.
    pub fn send(&self, command: Command) -> Result<(), RequestError> {
        self.commands
            .try_send(command)
            .map_err(|error| match error {
                TrySendError::Full(_) => RequestError::QueueFull,
                TrySendError::Disconnected(_) => RequestError::Ended,
            })
    }

    /// Returns the reason why a command was not executed, once. Does not wait.
    pub fn next_reason(&self) -> Option<String> {
        self.reasons.try_recv().ok()
    }
}

/// Sends commands, each through a connection of its own, which the session does not have to keep.
fn send_all(path: &Path, commands: &Receiver<Command>, reasons: &Sender<String>) {
    for command in commands {
        let executed = Client::connect(path).and_then(|mut client| client.execute(&command));
        if let Err(error) = executed {
            // A window that shows eight reasons misses no more by the next one.
            let _ = reasons.try_send(error.to_string());
        }
    }
}
