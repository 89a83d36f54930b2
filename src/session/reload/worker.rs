//! What the thread does that looks after a layout: it waits for orders, and for the file to be saved.

use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, never, select};

use super::active_layout::{ActiveLayout, SessionEnded};
use super::notice::FileWatcher;
use super::{FileCall, ReloadReport};
use crate::layout::Layout;
use crate::pipeline::LayoutInstance;
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
    pub fn to(path: Option<&str>) -> Self {
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
    fn ask(&mut self) -> bool {
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

    fn noticed(&self) -> Receiver<()> {
        match self {
            Self::Events { notices, .. } => notices.noticed().clone(),
            _ => never(),
        }
    }

    /// Takes a notice, or that there will be no more.
    fn take(&mut self, is_notice: bool) {
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

/// Does what `keeper` has to do until the run is over.
pub(super) fn watch<A: Fn(&Layout) -> Result<LayoutInstance, String>>(
    mut keeper: ActiveLayout<A>,
    mut attention: ChangeDetection,
    called: &Receiver<FileCall>,
    mut report: impl FnMut(ReloadReport),
) {
    let ended = keeper.ended.clone();
    loop {
        let is_at_rest = keeper.is_settled();
        let outcome = if is_at_rest && attention.ask() {
            keeper.poll(Instant::now())
        } else {
            select! {
                recv(ended) -> _ => return,
                recv(called) -> call => match call {
                    Ok(call) => keeper.handle(call),
                    Err(_) => return,
                },
                recv(attention.noticed()) -> notice => {
                    attention.take(notice.is_ok());
                    keeper.mark_changed(Instant::now());
                    keeper.poll(Instant::now())
                },
                default(attention.period(is_at_rest)) => keeper.poll(Instant::now()),
            }
        };
        match outcome {
            Ok(Some(outcome)) => report(outcome),
            Ok(None) => {}
            Err(SessionEnded) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::session::reload::watched_file::WatchedFile;
    use crate::session::reload::watched_file::tests::text;
    use crate::setup;
    use crossbeam_channel::{bounded, unbounded};
    use std::{fs, thread};

    #[test]
    fn a_save_is_found_also_where_it_is_not_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let path = path.to_str().unwrap();
        let (replacements, replaced) = bounded(1);
        let (end, ended) = bounded(0);
        let keeper = ActiveLayout {
            file: Some(WatchedFile::new(path, &text("A"), Instant::now())),
            layout: Layout::from_document(Document::from_path(path).unwrap()).unwrap(),
            profile: 0,
            replacements,
            ended,
            build: |layout: &Layout| Ok(setup::controls(layout)),
        };
        let (calls, called) = bounded(1);
        let (sender, reports) = unbounded();
        let looking = thread::spawn(move || {
            let report = |report| sender.send(report).unwrap();
            watch(keeper, ChangeDetection::Polling, &called, report);
        });
        thread::sleep(POLL_PERIOD * 4);
        fs::write(path, text("B")).unwrap();
        let replacement = replaced.recv_timeout(Duration::from_secs(20)).unwrap();
        let _ = replacement.retired.send(replacement.controls);
        let report = reports.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(matches!(report, ReloadReport::Replaced(layout) if layout.name == "B"));
        drop((end, calls));
        looking.join().unwrap();
    }
}
