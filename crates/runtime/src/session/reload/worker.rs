//! The thread of the layout manager: requests, and changes of layout files.

use std::io;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, Select, never};

use super::LayoutReport;
use super::active_layout::ActiveLayout;
use super::file_watcher::FileWatcher;
use crate::session::counted;
use crate::session::layout_link::{LayoutLink, LayoutOperation, LayoutRequest, SessionEnded};
use crate::session::layout_trial::TrialRequest;
use crate::session::reply::{Reply, RequestError};
use crate::setup::LearnedFile;
use ademan_core::document::DocumentError;
use ademan_core::layout::Layout;
use ademan_core::message::escape;
use ademan_core::pipeline::LayoutInstance;
use ademan_core::time::NO_DEADLINE;

/// Time between two checks of a file that is being saved, or that is on a file system without events. One check takes a
/// few microseconds, and also detects a file that was replaced.
const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The reason why nothing is saved without a file.
const NO_LEARNED_FILE: &str = "not saved, as the run has no file for it: start it with `--learned FILE`, or set `learned` of `text` in the setup";

/// The reason why board poses of an earlier layout are not written.
const OUTDATED_POSES: &str = "not saved, as a layout was replaced before the board poses were written; `save` again to write the present ones";

/// The way in which changes of a layout file are detected.
pub(super) enum ChangeDetection {
    /// The layout has no file, or the file is not watched.
    None,
    /// The file is checked every [`POLL_PERIOD`].
    Polling,
    /// The operating system reports changes.
    Events {
        path: String,
        /// `None` from a change until the file has settled.
        watcher: Option<FileWatcher>,
    },
}

impl ChangeDetection {
    /// Detects changes of the file at `path`, with events if possible.
    pub fn new(path: Option<&str>) -> Self {
        let Some(path) = path else {
            return Self::None;
        };
        match FileWatcher::new(path) {
            Ok(watcher) => Self::Events {
                path: path.into(),
                watcher: Some(watcher),
            },
            Err(error) => Self::polling(&error),
        }
    }

    fn polling(error: &io::Error) -> Self {
        let rate = Duration::from_secs(1).div_duration_f32(POLL_PERIOD);
        tracing::info!("polling the layout file {rate} times per second: no events: {error}");
        Self::Polling
    }

    /// Waits for events again. Returns `true` if the file has to be checked once, as changes before that had no event.
    fn arm(&mut self) -> bool {
        let Self::Events { path, watcher } = self else {
            return false;
        };
        if watcher.is_some() {
            return false;
        }
        match FileWatcher::new(path) {
            Ok(new) => *watcher = Some(new),
            Err(error) => *self = Self::polling(&error),
        }
        true
    }

    /// Returns the channel that receives changes.
    fn changes(&self) -> Receiver<()> {
        match self {
            Self::Events {
                watcher: Some(watcher),
                ..
            } => watcher.changes().clone(),
            _ => never(),
        }
    }

    /// Handles a change, or the end of the events.
    fn handle(&mut self, is_change: bool) {
        match self {
            Self::Events { watcher, .. } if is_change => *watcher = None,
            _ => *self = Self::polling(&io::Error::other("the file watcher ended")),
        }
    }

    /// Returns the time until the next check.
    fn period(&self, is_settled: bool) -> Duration {
        match self {
            Self::Events { .. } if !is_settled => POLL_PERIOD,
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
    /// Layouts in the order of the profiles.
    pub layouts: Vec<ManagedLayout>,
    pub link: LayoutLink,
    /// The file of what the text decoder has learned, if the setup names one.
    pub learned: Option<LearnedFile>,
    pub is_recorded: bool,
    pub build: B,
    pub report: R,
    /// The latest report about a file: the index of its layout, and the text.
    pub reported: Option<(usize, String)>,
}

/// An input of the worker.
enum Input {
    Request(LayoutRequest),
    Trial(TrialRequest),
    /// A change of the file of a layout, by index; `false` if its events ended.
    Change(usize, bool),
    Timeout,
}

impl<B, R> Worker<B, R>
where
    B: Fn(usize, &Layout) -> Result<LayoutInstance, String>,
    R: FnMut(LayoutReport),
{
    /// Runs until the session ends.
    pub fn run(mut self) {
        while self.handle_next().is_ok() {}
    }

    fn handle_next(&mut self) -> Result<(), SessionEnded> {
        for index in 0..self.layouts.len() {
            let managed = &mut self.layouts[index];
            if managed.layout.is_settled() && managed.detection.arm() {
                self.poll(index)?;
            }
        }
        match self.next_input()? {
            Input::Request(request) => self.handle(request),
            Input::Trial(trial) => self.try_layout(trial),
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
        let trials = self.link.trials();
        let mut select = Select::new();
        select.recv(requests);
        select.recv(trials);
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
            1 => operation
                .recv(trials)
                .map(Input::Trial)
                .map_err(|_| SessionEnded),
            index => {
                let is_change = operation.recv(&changes[index - 2]).is_ok();
                Ok(Input::Change(index - 2, is_change))
            }
        }
    }

    /// Activates the file of a layout if it has changed.
    fn poll(&mut self, index: usize) -> Result<(), SessionEnded> {
        let ManagedLayout { layout, detection } = &mut self.layouts[index];
        // A long wait without requests times out too, and a file that is not watched is read on request only.
        if matches!(detection, ChangeDetection::None) {
            return Ok(());
        }
        match layout.poll(Instant::now()) {
            // A second activation would release what is pressed.
            Some(Ok(found)) if layout.accept_active(&found) => {
                self.report_once(index, LayoutReport::ValidAgain(found.file));
                Ok(())
            }
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
        let build = |profile: usize, layout: &Layout| {
            if is_recorded {
                Err(format!(
                    "{}: not used, as a recording holds one version of a layout; start again to use it",
                    escape(&layout.file)
                ))
            } else {
                (self.build)(profile, layout)
            }
        };
        let report = self.layouts[index]
            .layout
            .apply(found, &build, &self.link)?;
        let text = report.to_string();
        let outcome = match report {
            LayoutReport::Activated(_) => Ok(text),
            _ => Err(text),
        };
        self.report_once(index, report);
        Ok(outcome)
    }

    /// Reports the outcome of a change of a layout file, unless another layout with the same file has just reported the same: two profiles
    /// may differ only in the text decoder.
    fn report_once(&mut self, index: usize, report: LayoutReport) {
        let text = report.to_string();
        let mut reported = self.reported.iter();
        if !reported.any(|(other, said)| *other != index && *said == text) {
            self.reported = Some((index, text));
            (self.report)(report);
        }
    }

    /// Activates a text that is not saved.
    fn try_layout(&mut self, trial: TrialRequest) -> Result<(), SessionEnded> {
        let mut layouts = self.layouts.iter_mut().map(|managed| &mut managed.layout);
        let outcome = match layouts.find(|layout| layout.file_name() == trial.file) {
            _ if self.is_recorded => Err(
                "not tried, as a recording holds one version of a layout; start again without it"
                    .into(),
            ),
            Some(layout) => layout.try_text(trial.edited, &self.build, &self.link)?,
            None => Err(format!(
                "not tried, as the session does not use {}; start it with that layout",
                escape(&trial.file)
            )),
        };
        // The editor may be closed.
        let _ = trial.reply.try_send(outcome);
        Ok(())
    }

    fn handle(&mut self, request: LayoutRequest) -> Result<(), SessionEnded> {
        let is_outdated = self.link.is_outdated(&request);
        let LayoutRequest {
            operation,
            profile,
            reply,
            done,
            ..
        } = request;
        // Each file that is read again has its own report.
        let is_reported = operation == LayoutOperation::Reload
            && self.layouts.iter().any(|managed| managed.layout.has_file());
        let outcome = match operation {
            LayoutOperation::Reload => self.reload()?,
            LayoutOperation::Scale(factor) => {
                let layout = &mut self.layouts[profile].layout;
                layout.scale(factor, &self.build, &self.link)?
            }
            LayoutOperation::Save(_) if is_outdated => Err(OUTDATED_POSES.to_owned()),
            LayoutOperation::Save(poses) => self.layouts[profile].layout.save(&poses),
            LayoutOperation::SaveLearned(learned) => match &mut self.learned {
                Some(file) => file.save(&learned),
                None => Err(NO_LEARNED_FILE.to_owned()),
            },
        };
        match reply {
            None if is_reported => {}
            None => (self.report)(LayoutReport::Command(outcome)),
            Some(reply) => {
                // The client may have gone away.
                let _ = reply.try_send(outcome.map(Reply::Text).map_err(RequestError::Layout));
            }
        }
        let missed = self.link.take_missed();
        if missed > 0 {
            let commands = counted(missed as u64, "command");
            let text = format!("{commands} not executed: too many were waiting; try again");
            (self.report)(LayoutReport::Command(Err(text)));
        }
        drop(done);
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
                Ok(text) if texts.contains(&text) => {}
                Ok(text) => texts.push(text),
                Err(text) => return Ok(Err(text)),
            }
        }
        Ok(if texts.is_empty() {
            Err(
                "the layout comes with the program or a recording and has no file to read again"
                    .into(),
            )
        } else {
            Ok(texts.join("\n"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::command_channel::CommandReceiver;
    use crate::session::reload::watched_file::WatchedFile;
    use crate::session::reload::watched_file::tests::text;
    use crossbeam_channel::{Sender, unbounded};
    use std::{fs, thread};

    /// Returns the worker of a session whose layout has the text `active`, and was read from the file at `path`.
    fn worker(
        (path, active): (&str, &str),
        detection: ChangeDetection,
        link: LayoutLink,
        sender: Sender<LayoutReport>,
    ) -> Worker<
        impl Fn(usize, &Layout) -> Result<LayoutInstance, String> + use<>,
        impl FnMut(LayoutReport) + use<>,
    > {
        let parsed = Layout::parse(active, path).unwrap();
        let file = WatchedFile::new(path, active, parsed.fit, Instant::now());
        Worker {
            layouts: vec![ManagedLayout {
                layout: ActiveLayout::new(Some(file), parsed, 0),
                detection,
            }],
            link,
            learned: None,
            is_recorded: false,
            build: |_: usize, layout: &Layout| Ok(LayoutInstance::from_layout(layout)),
            report: move |report| sender.send(report).unwrap(),
            reported: None,
        }
    }

    #[test]
    fn a_save_is_detected_by_polling() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let path = path.to_str().unwrap();
        let mut commands = CommandReceiver::disconnected();
        let (sender, reports) = unbounded();
        let link = commands.link_layouts();
        let worker = worker((path, &text("A")), ChangeDetection::Polling, link, sender);
        let polling = thread::spawn(move || worker.run());
        thread::sleep(POLL_PERIOD * 4);
        fs::write(path, text("B")).unwrap();
        let swaps = commands.layouts().unwrap().swaps();
        let swap = swaps.recv_timeout(Duration::from_secs(60)).unwrap();
        let _ = swap.retired.send(swap.layout);
        let report = reports.recv_timeout(Duration::from_secs(60)).unwrap();
        assert!(matches!(report, LayoutReport::Activated(layout) if layout.name == "B"));
        drop(commands);
        polling.join().unwrap();
    }

    #[test]
    fn a_file_that_is_not_watched_is_not_read_after_a_long_wait() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("B")).unwrap();
        let path = path.to_str().unwrap();
        let mut commands = CommandReceiver::disconnected();
        let (sender, reports) = unbounded();
        let link = commands.link_layouts();
        let mut worker = worker((path, &text("A")), ChangeDetection::None, link, sender);
        // An activation fails instead of waiting for the loop.
        drop(commands);
        thread::sleep(POLL_PERIOD * 4);
        assert!(worker.poll(0).is_ok());
        assert!(reports.is_empty());
    }

    #[test]
    fn each_save_of_a_file_that_two_profiles_use_is_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, "no layout").unwrap();
        let path = path.to_str().unwrap();
        let mut commands = CommandReceiver::disconnected();
        let (sender, reports) = unbounded();
        let link = commands.link_layouts();
        let mut worker = worker((path, &text("A")), ChangeDetection::None, link, sender);
        let parsed = Layout::parse(&text("A"), path).unwrap();
        let file = WatchedFile::new(path, &text("A"), parsed.fit, Instant::now());
        worker.layouts.push(ManagedLayout {
            layout: ActiveLayout::new(Some(file), parsed, 1),
            detection: ChangeDetection::None,
        });
        for order in [[0, 1], [0, 1], [1, 0]] {
            for index in order {
                let found = worker.layouts[index].layout.read();
                assert!(worker.apply(index, found).is_ok());
            }
            let all: Vec<_> = reports.try_iter().collect();
            assert!(
                matches!(all.as_slice(), [LayoutReport::Invalid(_)]),
                "{all:?}"
            );
        }
    }

    #[test]
    fn commands_without_a_client_that_found_no_room_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let path = path.to_str().unwrap();
        let mut commands = CommandReceiver::disconnected();
        let (sender, reports) = unbounded();
        let link = commands.link_layouts();
        let mut worker = worker((path, &text("A")), ChangeDetection::None, link, sender);
        let request = LayoutRequest {
            operation: LayoutOperation::SaveLearned(Box::default()),
            profile: 0,
            replaced: 0,
            reply: None,
            done: None,
        };
        let layouts = commands.layouts().unwrap();
        while layouts.forward(request.clone()).is_ok() {}
        assert!(layouts.forward(request).is_err());
        for _ in 0..2 {
            assert!(worker.handle_next().is_ok());
        }
        let texts: Vec<String> = reports.try_iter().map(|it| it.to_string()).collect();
        assert_eq!(texts.len(), 3, "{texts:?}");
        assert!(texts[1].starts_with("2 commands not executed"), "{texts:?}");
    }
}
