//! A session loop for tests of the layout manager: it activates every layout at once.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, bounded, unbounded};

use super::{FilePolicy, LayoutReport, LayoutSource, start};
use crate::session::command_channel::CommandReceiver;
use crate::session::layout_link::{LayoutOperation, LayoutRequest};
use crate::session::reply::Reply;
use ademan_core::document::Document;
use ademan_core::layout::Layout;
use ademan_core::pipeline::LayoutInstance;

/// Longest wait for something that a busy machine does late.
pub const TIMEOUT: Duration = Duration::from_secs(60);

/// A session with one layout. Dropping it ends the layout manager.
pub struct TestLoop {
    commands: CommandReceiver,
    /// Name of the layout.
    file: String,
    /// For each activated layout, whether its boards keep their poses.
    pub activated: Receiver<bool>,
    pub reports: Receiver<LayoutReport>,
}

impl TestLoop {
    /// Starts a layout manager for a layout and its file. `accept` refuses layouts.
    pub fn start(
        layout: Layout,
        path: Option<&Path>,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
    ) -> Self {
        let session = Self::paused(layout, path, accept);
        let swaps = session.commands.layouts().unwrap().swaps().clone();
        let (sender, activated) = unbounded();
        thread::spawn(move || {
            for swap in swaps {
                let _ = sender.send(swap.keep_board_poses);
                let _ = swap.retired.send(swap.layout);
            }
        });
        Self {
            activated,
            ..session
        }
    }

    /// Like [`start`](Self::start), but activates no layout.
    pub fn paused(
        layout: Layout,
        path: Option<&Path>,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
    ) -> Self {
        let mut commands = CommandReceiver::disconnected();
        let (sender, reports) = unbounded();
        let file = layout.file.clone();
        let source = LayoutSource {
            layout,
            path: path.map(|path| path.to_str().unwrap().to_owned()),
        };
        let policy = FilePolicy {
            watch: true,
            is_recorded: false,
        };
        let build = move |_: usize, built: &Layout| {
            accept(built).map(|()| LayoutInstance::from_layout(built))
        };
        let report = move |report| sender.send(report).unwrap();
        start(
            [source],
            None,
            commands.link_layouts(),
            policy,
            build,
            report,
        )
        .unwrap();
        Self {
            commands,
            file,
            activated: unbounded().1,
            reports,
        }
    }

    /// Returns `true` if a layout waits for its activation.
    pub fn has_swap(&self) -> bool {
        !self.commands.layouts().unwrap().swaps().is_empty()
    }

    /// Counts a layout that was replaced, as the session loop does.
    pub fn count_replaced(&self) {
        self.commands.layouts().unwrap().count_replaced();
    }

    /// Tries a text and waits for the outcome.
    pub fn try_text(&self, text: &str) -> Result<(), String> {
        let trial = self.commands.layouts().unwrap().trial();
        let edited = Document::new(self.file.as_str(), text);
        let outcome = trial.start(&self.file, edited).unwrap();
        let start = Instant::now();
        while start.elapsed() < TIMEOUT {
            if let Some(outcome) = outcome.poll() {
                return outcome;
            }
            thread::sleep(Duration::from_millis(1));
        }
        panic!("no outcome");
    }

    /// Sends an operation as a layout does, and waits until it is handled.
    pub fn run_of_layout(&self, operation: LayoutOperation) {
        let (done, handled) = bounded(0);
        let link = self.commands.layouts().unwrap();
        let request = LayoutRequest {
            operation,
            profile: 0,
            replaced: link.replaced(),
            reply: None,
            done: Some(done),
        };
        link.forward(request).unwrap();
        let ended = handled.recv_timeout(TIMEOUT);
        assert_eq!(ended, Err(RecvTimeoutError::Disconnected));
    }

    /// Sends a request and waits for the outcome.
    pub fn request(&self, operation: LayoutOperation) -> Result<String, String> {
        let replaced = self.commands.layouts().unwrap().replaced();
        self.request_after(replaced, operation)
    }

    /// Sends a request that was made when this number of layouts had been replaced, and waits for the outcome.
    pub fn request_after(
        &self,
        replaced: usize,
        operation: LayoutOperation,
    ) -> Result<String, String> {
        let (reply, replies) = bounded(1);
        let request = LayoutRequest {
            operation,
            profile: 0,
            replaced,
            reply: Some(reply),
            done: None,
        };
        self.commands.layouts().unwrap().forward(request).unwrap();
        match replies.recv_timeout(TIMEOUT).unwrap() {
            Ok(Reply::Text(text)) => Ok(text),
            Ok(other) => panic!("{other:?}"),
            Err(error) => Err(error.to_string()),
        }
    }
}
