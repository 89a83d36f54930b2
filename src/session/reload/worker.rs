//! What the thread does that looks after a layout: it waits for orders, and for the file to be saved.

use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Select, never};

use super::LayoutReport;
use super::active_layout::ActiveLayout;
use super::notice::FileWatcher;
use crate::document::DocumentError;
use crate::layout::Layout;
use crate::pipeline::LayoutInstance;
use crate::session::command_channel::{Reply, RequestError};
use crate::session::layout_link::{LayoutLink, LayoutOperation, LayoutRequest, SessionEnded};
use crate::time::NO_DEADLINE;

/// How often the file is looked at while it is being saved, and always where a change of it is not told. One look
/// costs a few microseconds, works on every file system, and sees a file that an editor puts in the place of the old
/// one as well as one that is written to.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// Who says that the file has changed.
pub(super) enum ChangeDetection {
    /// There is no file.
    None,
    /// It is looked at all the time.
    Polling,
    /// The system does, once after each time that it was asked to.
    Events {
        notices: FileWatcher,
        is_asked: bool,
    },
}

impl ChangeDetection {
    /// To the file at `path`, if there is one, by notices where they can be had.
    pub fn new(path: Option<&str>) -> Self {
        let Some(path) = path else {
            return Self::None;
        };
        let asked = FileWatcher::start(path).and_then(|notices| notices.arm().map(|()| notices));
        match asked {
            Ok(notices) => Self::Events {
                notices,
                is_asked: true,
            },
            Err(error) => Self::looking(&error),
        }
    }

    fn looking(error: &std::io::Error) -> Self {
        let looks = Duration::from_secs(1).div_duration_f32(POLL_PERIOD);
        tracing::info!(
            "no notice when the layout is saved, it is looked at {looks} times a second: {error}"
        );
        Self::Polling
    }

    /// Sees to it that the next change is told. Whether the file has to be looked at once more: what came before
    /// may have been missed.
    fn arm(&mut self) -> bool {
        let Self::Events { notices, is_asked } = self else {
            return false;
        };
        if *is_asked {
            return false;
        }
        match notices.arm() {
            Ok(()) => *is_asked = true,
            Err(error) => *self = Self::looking(&error),
        }
        true
    }

    fn changes(&self) -> Receiver<()> {
        match self {
            Self::Events { notices, .. } => notices.noticed().clone(),
            _ => never(),
        }
    }

    /// Takes a notice, or that there will be no more.
    fn handle(&mut self, is_notice: bool) {
        match self {
            Self::Events { is_asked, .. } if is_notice => *is_asked = false,
            _ => *self = Self::looking(&std::io::Error::other("the system tells no more")),
        }
    }

    /// How long the file need not be looked at.
    fn period(&self, is_at_rest: bool) -> Duration {
        match self {
            Self::Events { .. } if !is_at_rest => POLL_PERIOD,
            Self::Polling => POLL_PERIOD,
            _ => NO_DEADLINE,
        }
    }
}

/// A layout and the detection of changes to its file.
pub(super) struct ManagedLayout {
    pub layout: ActiveLayout,
    pub detection: ChangeDetection,
}

/// The thread of the layout manager.
pub(super) struct Worker<B, R> {
    /// In the order of the profiles.
    pub layouts: Vec<ManagedLayout>,
    pub link: LayoutLink,
    pub is_recorded: bool,
    pub build: B,
    pub report: R,
}

/// An input of the worker.
enum Input {
    Request(LayoutRequest),
    /// The system reports a change of this layout's file (`true`), or can report no more.
    Change(usize, bool),
    Timeout,
}

impl<B, R> Worker<B, R>
where
    B: Fn(&Layout) -> Result<LayoutInstance, String>,
    R: FnMut(LayoutReport),
{
    /// Runs until the session ends.
    pub fn run(mut self) {
        while self.turn().is_ok() {}
    }

    fn turn(&mut self) -> Result<(), SessionEnded> {
        for index in 0..self.layouts.len() {
            let managed = &mut self.layouts[index];
            if managed.layout.is_settled() && managed.detection.arm() {
                self.poll(index)?;
            }
        }
        match self.next_input()? {
            Input::Request(request) => self.handle(request),
            Input::Change(index, is_change) => {
                self.layouts[index].detection.handle(is_change);
                self.layouts[index].layout.mark_changed(Instant::now());
                self.poll(index)
            }
            Input::Timeout => (0..self.layouts.len()).try_for_each(|index| self.poll(index)),
        }
    }

    fn next_input(&self) -> Result<Input, SessionEnded> {
        let period =
            |managed: &ManagedLayout| managed.detection.period(managed.layout.is_settled());
        let timeout = self.layouts.iter().map(period).min().unwrap_or(NO_DEADLINE);
        let changes: Vec<_> = self
            .layouts
            .iter()
            .map(|managed| managed.detection.changes())
            .collect();
        let requests = self.link.requests();
        let mut select = Select::new();
        select.recv(requests);
        for change in &changes {
            select.recv(change);
        }
        let Ok(operation) = select.select_timeout(timeout) else {
            return Ok(Input::Timeout);
        };
        match operation.index() {
            0 => operation
                .recv(requests)
                .map(Input::Request)
                .map_err(|_| SessionEnded),
            index => {
                let is_change = operation.recv(&changes[index - 1]).is_ok();
                Ok(Input::Change(index - 1, is_change))
            }
        }
    }

    /// Activates the file of a layout if it has changed.
    fn poll(&mut self, index: usize) -> Result<(), SessionEnded> {
        match self.layouts[index].layout.poll(Instant::now()) {
            Some(found) => self.apply(index, found).map(drop),
            None => Ok(()),
        }
    }

    /// Activates the content of a file and reports the outcome.
    fn apply(
        &mut self,
        index: usize,
        found: Result<Layout, DocumentError>,
    ) -> Result<Result<String, String>, SessionEnded> {
        let is_recorded = self.is_recorded;
        let build = |layout: &Layout| match is_recorded {
            true => Err(format!(
                "{}: not used, as a recording holds one version of a layout; start again to use it",
                layout.file
            )),
            false => (self.build)(layout),
        };
        let report = self.layouts[index]
            .layout
            .apply(found, &build, &self.link)?;
        let text = report.to_string();
        let outcome = match report {
            LayoutReport::Activated(_) => Ok(text),
            _ => Err(text),
        };
        (self.report)(report);
        Ok(outcome)
    }

    fn handle(&mut self, request: LayoutRequest) -> Result<(), SessionEnded> {
        let LayoutRequest {
            operation,
            profile,
            reply,
        } = request;
        let outcome = match operation {
            LayoutOperation::Reload => self.reload()?,
            LayoutOperation::Scale(factor) => {
                let layout = &mut self.layouts[profile].layout;
                layout.scale(factor, &self.build, &self.link)?
            }
            LayoutOperation::Save(poses) => self.layouts[profile].layout.save(&poses),
        };
        match reply {
            None => (self.report)(LayoutReport::Command(outcome)),
            Some(reply) => {
                // The client may have gone away.
                let _ = reply.try_send(outcome.map(Reply::Text).map_err(RequestError::Layout));
            }
        }
        Ok(())
    }

    /// Reads all files again, up to the first one that cannot be used.
    fn reload(&mut self) -> Result<Result<String, String>, SessionEnded> {
        let mut texts = Vec::new();
        for index in 0..self.layouts.len() {
            if !self.layouts[index].layout.has_file() {
                continue;
            }
            let found = self.layouts[index].layout.read();
            match self.apply(index, found)? {
                Ok(text) => texts.push(text),
                Err(text) => return Ok(Err(text)),
            }
        }
        Ok(match texts.is_empty() {
            true => Err("the layout comes with the program and has no file to read again".into()),
            false => Ok(texts.join("\n")),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::CommandReceiver;
    use crate::session::reload::watched_file::WatchedFile;
    use crate::session::reload::watched_file::tests::text;
    use crate::setup;
    use crossbeam_channel::unbounded;
    use std::{fs, thread};

    #[test]
    fn a_save_is_found_without_events_of_the_system() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let path = path.to_str().unwrap();
        let mut commands = CommandReceiver::disconnected();
        let file = WatchedFile::new(path, &text("A"), Instant::now());
        let (sender, reports) = unbounded();
        let worker = Worker {
            layouts: vec![ManagedLayout {
                layout: ActiveLayout::new(Some(file), Layout::load(path).unwrap(), 0),
                detection: ChangeDetection::Polling,
            }],
            link: commands.link_layouts(),
            is_recorded: false,
            build: |layout: &Layout| Ok(setup::controls(layout)),
            report: move |report| sender.send(report).unwrap(),
        };
        let polling = thread::spawn(move || worker.run());
        thread::sleep(POLL_PERIOD * 4);
        fs::write(path, text("B")).unwrap();
        let swaps = commands.layouts().unwrap().swaps();
        let swap = swaps.recv_timeout(Duration::from_secs(20)).unwrap();
        let _ = swap.retired.send(swap.layout);
        let report = reports.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(matches!(report, LayoutReport::Activated(layout) if layout.name == "B"));
        drop(commands);
        polling.join().unwrap();
    }
}
