//! The layout manager: reads, checks and builds changed layouts outside the session loop.

mod active_layout;
mod file_watcher;
#[cfg(test)]
mod test_loop;
mod watched_file;
mod worker;

use std::fmt;
use std::io;
use std::thread;
use std::time::Instant;

use self::active_layout::ActiveLayout;
use self::watched_file::WatchedFile;
use self::worker::{ChangeDetection, ManagedLayout, Worker};
use super::layout_link::LayoutLink;
use crate::setup::LearnedFile;
use ademan_core::document::DocumentError;
use ademan_core::layout::Layout;
use ademan_core::message::escape;
use ademan_core::pipeline::LayoutInstance;

/// Outcome of a change to a layout.
#[derive(Debug)]
pub enum LayoutReport {
    /// The layout of a file is active.
    Activated(Box<Layout>),
    /// The file is invalid or missing; the active layout stays.
    Invalid(DocumentError),
    /// The layout is valid, but this session cannot use it, for this reason; the active layout stays.
    Rejected(String),
    /// The file was invalid or rejected, and is again the active layout: this file.
    ValidAgain(String),
    /// Outcome of a command that the layout itself issued.
    Command(Result<String, String>),
}

impl fmt::Display for LayoutReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Activated(layout) => write!(f, "{}: active from now on", escape(&layout.file)),
            Self::Invalid(error) => write!(f, "{error}\nthe active layout stays"),
            Self::Rejected(reason) => f.write_str(reason),
            Self::ValidAgain(file) => {
                write!(f, "{}: valid again, as the active layout is", escape(file))
            }
            Self::Command(Ok(text) | Err(text)) => f.write_str(text),
        }
    }
}

/// A layout of the setup and the file that it comes from.
pub struct LayoutSource {
    /// The layout.
    pub layout: Layout,
    /// Path of its file; `None` for a layout that comes with the program or a recording.
    pub path: Option<String>,
}

/// Use of the layout files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilePolicy {
    /// `true` if files are watched and activated when they are saved.
    pub watch: bool,
    /// `true` if the session is recorded. A recording holds one version of each layout, so that changed files are rejected.
    pub is_recorded: bool,
}

/// Starts the layout manager: a thread that activates layout files when they are saved, and scales, saves and reloads
/// layouts on request, until the session loop at the other end of `link` ends.
///
/// `layouts` has one layout for each profile of the setup, in order; `learned` is the file of what the text decoder has learned.
/// `build` makes a layout ready for the loop, in place of the layout of a profile by index, or refuses it. `report` receives the
/// outcome of every change, in order. A file that was saved is active at most 0.2 s later, or 0.7 s if simulated hands have to lift
/// first. Saves in quick succession count as one; while they continue for longer than 2 s, the saves of each 2 s count as one. Two
/// saves in one tick of the file system's clock, 2 s on FAT, look like one if their lengths are equal.
pub fn start(
    layouts: impl IntoIterator<Item = LayoutSource>,
    learned: Option<LearnedFile>,
    link: LayoutLink,
    policy: FilePolicy,
    build: impl Fn(usize, &Layout) -> Result<LayoutInstance, String> + Send + 'static,
    report: impl FnMut(LayoutReport) + Send + 'static,
) -> io::Result<()> {
    let managed = layouts.into_iter().enumerate().map(|(profile, source)| {
        let LayoutSource { layout, path } = source;
        // From here on no change of the file is missed.
        let watched_path = path.as_deref().filter(|_| policy.watch);
        let detection = ChangeDetection::new(watched_path);
        let file =
            path.map(|path| WatchedFile::new(&path, &layout.text, layout.fit, Instant::now()));
        ManagedLayout {
            layout: ActiveLayout::new(file, layout, profile),
            detection,
        }
    });
    let worker = Worker {
        layouts: managed.collect(),
        link,
        learned,
        is_recorded: policy.is_recorded,
        build,
        report,
        reported: None,
    };
    // The session does not wait for this thread: a file system that hangs must not delay its end.
    thread::Builder::new()
        .name("layout".into())
        .spawn(move || worker.run())
        .map(drop)
}

#[cfg(test)]
mod tests {
    use super::test_loop::{TIMEOUT, TestLoop};
    use super::watched_file::tests::text;
    use super::*;
    use crate::files::Load;
    use crate::output::tests::wait_until;
    use crate::session::layout_link::LayoutOperation;
    use crossbeam_channel::{Receiver, RecvTimeoutError};
    use std::fs;
    use std::path::Path;
    use std::time::Duration;

    fn session(
        path: &Path,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
    ) -> TestLoop {
        let layout = Layout::load(path.to_str().unwrap()).unwrap();
        TestLoop::start(layout, Some(path), accept)
    }

    /// Creates a directory with a layout file of one key.
    fn layout_file() -> (tempfile::TempDir, std::path::PathBuf) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        (directory, path)
    }

    fn assert_ended(reports: &Receiver<LayoutReport>) {
        let report = reports.recv_timeout(TIMEOUT);
        assert!(matches!(report, Err(RecvTimeoutError::Disconnected)));
    }

    #[test]
    fn of_many_fast_saves_the_last_is_activated_and_few_others() {
        let (_directory, path) = layout_file();
        let session = session(&path, |_| Ok(()));
        let (mut last_save, mut pauses) = (Instant::now(), 0);
        for save in 0..100 {
            fs::write(&path, text("B").replace("\"B\",", &format!("\"{save}\","))).unwrap();
            // The machine has suspended this test for long enough that the file may have settled.
            pauses += usize::from(last_save.elapsed() > Duration::from_millis(40));
            last_save = Instant::now();
            thread::sleep(Duration::from_millis(8));
        }
        let mut activated = 0;
        loop {
            let report = session.reports.recv_timeout(TIMEOUT);
            let layout = match report.expect("the last save is activated") {
                LayoutReport::Activated(layout) => layout,
                // A file that is half written, where the machine suspends this test during a save.
                LayoutReport::Invalid(_) | LayoutReport::ValidAgain(_) => continue,
                report => panic!("{report}"),
            };
            activated += 1;
            if layout.name == "99" {
                break;
            }
        }
        assert!(activated <= 10 + pauses, "{activated}, {pauses} pauses");
    }

    #[cfg(unix)]
    #[test]
    fn a_layout_is_activated_for_every_way_of_saving() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        for (version, key) in [("one", "A"), ("two", "B")] {
            fs::create_dir(at(version)).unwrap();
            fs::write(at(version).join("a.ron"), text(key)).unwrap();
        }
        let link = |to: &str| {
            std::os::unix::fs::symlink(to, at("new")).unwrap();
            fs::rename(at("new"), at("..data")).unwrap();
        };
        link("one");
        std::os::unix::fs::symlink("..data/a.ron", at("a.ron")).unwrap();
        let session = session(&at("a.ron"), |_| Ok(()));
        let expect = |key: &str, save: &dyn Fn()| {
            // By then every earlier change has settled.
            thread::sleep(Duration::from_millis(300));
            save();
            let report = session.reports.recv_timeout(TIMEOUT);
            assert!(
                matches!(report, Ok(LayoutReport::Activated(layout)) if layout.name == key),
                "{key}"
            );
        };
        expect("B", &|| link("two"));
        expect("C", &|| fs::write(at("two/a.ron"), text("C")).unwrap());
        expect("D", &|| {
            fs::write(at("save"), text("D")).unwrap();
            fs::rename(at("save"), at("two/a.ron")).unwrap();
        });
        expect("E", &|| {
            fs::remove_file(at("two/a.ron")).unwrap();
            fs::write(at("two/a.ron"), text("E")).unwrap();
        });
        expect("F", &|| {
            fs::remove_file(at("a.ron")).unwrap();
            fs::write(at("a.ron"), text("F")).unwrap();
        });
    }

    #[test]
    fn a_layout_that_the_session_cannot_use_is_reported_and_not_activated() {
        let (_directory, path) = layout_file();
        let session = session(&path, |layout| match layout.name.as_str() {
            "C" => Ok(()),
            name => Err(format!("no {name}")),
        });
        fs::write(&path, text("B")).unwrap();
        let report = session.reports.recv_timeout(TIMEOUT);
        assert!(matches!(report, Ok(LayoutReport::Rejected(reason)) if reason == "no B"));
        fs::write(&path, text("C")).unwrap();
        let next_report = session.reports.recv_timeout(TIMEOUT);
        assert!(matches!(next_report, Ok(LayoutReport::Activated(layout)) if layout.name == "C"));
    }

    #[test]
    fn reload_reads_the_file_even_if_it_was_not_saved_and_replies_with_the_outcome() {
        let (_directory, path) = layout_file();
        let session = session(&path, |layout| match layout.name.as_str() {
            "C" => Err("no C".into()),
            _ => Ok(()),
        });
        let reload = || {
            let reply = session.request(LayoutOperation::Reload);
            session.reports.recv_timeout(TIMEOUT).unwrap();
            reply.map_err(|text| text.replace(&path.display().to_string(), "a.ron"))
        };
        let active = format!("{}: active from now on", path.display());
        assert_eq!(reload(), Ok(active.clone()));
        assert_eq!(reload(), Ok(active));
        fs::write(&path, text("C")).unwrap();
        assert_eq!(reload(), Err("no C".into()));
        fs::write(&path, text("Entre")).unwrap();
        let error = reload().unwrap_err();
        assert!(
            error.starts_with("a.ron:3:35: unknown key `Entre`"),
            "{error}"
        );
        assert!(error.ends_with("\nthe active layout stays"), "{error}");
    }

    #[test]
    fn the_manager_ends_with_the_session() {
        let (_directory, path) = layout_file();
        let session = session(&path, |_| Ok(()));
        let reports = session.reports.clone();
        drop(session);
        assert_ended(&reports);
    }

    #[test]
    fn the_manager_ends_with_a_session_that_does_not_activate_a_layout() {
        let (_directory, path) = layout_file();
        let layout = Layout::load(path.to_str().unwrap()).unwrap();
        let session = TestLoop::paused(layout, Some(&path), |_| Ok(()));
        fs::write(&path, text("B")).unwrap();
        wait_until("a swap", || session.has_swap());
        let reports = session.reports.clone();
        drop(session);
        assert_ended(&reports);
    }
}
