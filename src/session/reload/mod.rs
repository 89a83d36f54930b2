//! A layout that is saved while a run is on: read, checked and built outside the loop.

mod active_layout;
#[cfg(target_os = "linux")]
mod notice;
#[cfg(not(target_os = "linux"))]
#[path = "no_notice.rs"]
mod notice;
mod watched_file;
mod worker;

use std::fmt;
use std::io;
use std::thread;
use std::time::Instant;

use crossbeam_channel::{Sender, bounded};

use self::active_layout::ActiveLayout;
use self::watched_file::WatchedFile;
use self::worker::{ChangeDetection, watch};
use crate::contact::board_pose::BoardPose;
use crate::document::DocumentError;
use crate::layout::Layout;
use crate::pipeline::LayoutInstance;
use crate::session::Replacement;

/// What became of a file that was saved.
#[derive(Debug)]
pub enum ReloadReport {
    /// It is in force.
    Replaced(Box<Layout>),
    /// It is not as it should be, or not there; the layout in force stays.
    Invalid(DocumentError),
    /// It is right but cannot be used in this run, for this reason; the layout in force stays.
    Rejected(String),
}

impl fmt::Display for ReloadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Replaced(layout) => write!(f, "{}: in force from now on", layout.file),
            Self::Invalid(error) => write!(f, "{error}\nthe layout in force stays"),
            Self::Rejected(reason) => f.write_str(reason),
        }
    }
}

/// Takes what came of an order: `Ok` when it is done. Closed when the run ends before that.
pub type ReplySender = Sender<Result<String, String>>;

/// What whoever looks after a layout is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum FileOrder {
    /// Read the file at once, also if it has not been saved.
    Reload,
    /// Make the boards so many times as large as they are, about their (0, 0); they stay where they are.
    Scale(f32),
    /// Write these places of the boards into the file, and how large they are.
    Save(Vec<BoardPose>),
}

/// An order, and where its answer goes.
#[derive(Clone, Debug)]
pub struct FileCall {
    /// What is to be done.
    pub order: FileOrder,
    /// Takes the answer. Should have room for it: it is not waited for.
    pub answer: ReplySender,
}

/// Where calls to whoever looks after a layout are put.
#[derive(Clone, Debug)]
pub struct FileCalls {
    /// The layout's place among those of the setup.
    pub profile: usize,
    /// Whether it comes with the program, so that there is no file to read or write.
    pub is_shipped: bool,
    /// The end to put them in.
    pub calls: Sender<FileCall>,
}

/// Calls that wait while a layout is put in force: one for each client of a control socket.
const WAITING_CALLS: usize = 16;

/// Looks after a layout on a thread of its own, until it is dropped.
pub struct LayoutManager {
    calls: FileCalls,
    _end: Sender<()>,
}

impl LayoutManager {
    /// Watches the file at `path`, from which `layout` was read, the layout number `profile` of the setup;
    /// without a path, as of a shipped layout, only what it is asked for changes it.
    ///
    /// A file that is saved with another content comes out of the other end of `replacements` at most
    /// 0.2 s later if it is right and `accept` makes controls of it. Saves in quick succession count as the last of
    /// them; while they go on for longer than 2 s, each 2 s as one. `report` hears what became of each
    /// save, in order; of a replacement when it is in force. Two saves in one tick of the file system's
    /// clock, 2 s on FAT, look like one where their lengths are the same.
    pub fn start(
        path: Option<&str>,
        layout: &Layout,
        profile: usize,
        replacements: Sender<Replacement>,
        accept: impl Fn(&Layout) -> Result<LayoutInstance, String> + Send + 'static,
        report: impl FnMut(ReloadReport) + Send + 'static,
    ) -> io::Result<Self> {
        let (end, ended) = bounded(0);
        let (calls, called) = bounded::<FileCall>(WAITING_CALLS);
        // From here on nothing that happens to the file is missed.
        let attention = ChangeDetection::to(path);
        let keeper = ActiveLayout {
            file: path.map(|path| WatchedFile::new(path, &layout.text, Instant::now())),
            layout: layout.clone(),
            profile,
            replacements,
            ended,
            build: accept,
        };
        // It is not waited for: a file system that hangs must not hold up the end of a run.
        thread::Builder::new()
            .name("layout".into())
            .spawn(move || watch(keeper, attention, &called, report))?;
        let calls = FileCalls {
            profile,
            is_shipped: path.is_none(),
            calls,
        };
        Ok(Self { calls, _end: end })
    }

    /// Where to ask for something.
    pub fn calls(&self) -> FileCalls {
        self.calls.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::reload::watched_file::tests::text;
    use crate::setup;
    use crossbeam_channel::{Receiver, RecvTimeoutError};
    use std::fs;
    use std::time::Duration;

    /// What the watcher reports, with a loop that puts in force what comes.
    fn watch(
        path: &std::path::Path,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
    ) -> (LayoutManager, Receiver<ReloadReport>) {
        let path = path.to_str().unwrap();
        let layout = Layout::load(path).unwrap();
        let (sender, reports) = crossbeam_channel::unbounded();
        let report = move |report| sender.send(report).unwrap();
        let (replace, replacements) = bounded::<Replacement>(1);
        let accept = move |layout: &Layout| accept(layout).map(|()| setup::controls(layout));
        let watcher =
            LayoutManager::start(Some(path), &layout, 0, replace, accept, report).unwrap();
        thread::spawn(move || {
            for replacement in replacements {
                let _ = replacement.retired.send(replacement.controls);
            }
        });
        (watcher, reports)
    }

    const PATIENCE_OF_TEST: Duration = Duration::from_secs(20);

    #[test]
    fn the_last_of_many_fast_saves_is_put_in_force_and_few_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let (_watcher, reports) = watch(&path, |_| Ok(()));
        let mut last_save = Instant::now();
        for save in 0..100 {
            fs::write(&path, text("B").replace("\"B\",", &format!("\"{save}\","))).unwrap();
            last_save = Instant::now();
            thread::sleep(Duration::from_millis(8));
        }
        let mut replaced = 0;
        loop {
            let report = reports.recv_timeout(PATIENCE_OF_TEST);
            let ReloadReport::Replaced(layout) = report.expect("the last one is put in force")
            else {
                panic!("a file that is right");
            };
            replaced += 1;
            if layout.name == "99" {
                break;
            }
        }
        println!(
            "{replaced} of 100, {:?} after the last",
            last_save.elapsed()
        );
        // One, but for a machine that holds this test up between two saves.
        assert!(replaced <= 10, "{replaced}");
    }

    #[cfg(unix)]
    #[test]
    fn a_layout_is_put_in_force_however_it_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
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
        let (_watcher, reports) = watch(&at("a.ron"), |_| Ok(()));
        let expect = |key: &str, save: &dyn Fn()| {
            // By then nothing is looked at any more.
            thread::sleep(Duration::from_millis(300));
            save();
            let saved = Instant::now();
            let report = reports.recv_timeout(PATIENCE_OF_TEST);
            println!("{key} after {:?}", saved.elapsed());
            assert!(
                matches!(report, Ok(ReloadReport::Replaced(layout)) if layout.name == key),
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
    fn a_layout_that_is_refused_is_told_and_not_put_in_force() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let (_watcher, reports) = watch(&path, |layout| match layout.name.as_str() {
            "C" => Ok(()),
            name => Err(format!("no {name}")),
        });
        fs::write(&path, text("B")).unwrap();
        let report = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(report, Ok(ReloadReport::Rejected(reason)) if reason == "no B"));
        fs::write(&path, text("C")).unwrap();
        let report = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(report, Ok(ReloadReport::Replaced(layout)) if layout.name == "C"));
    }

    #[test]
    fn whoever_asks_for_the_file_is_told_what_became_of_it_also_when_it_was_not_saved() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let (watcher, reports) = watch(&path, |layout| match layout.name.as_str() {
            "C" => Err("no C".into()),
            _ => Ok(()),
        });
        let ask = || {
            let (asker, told) = bounded(1);
            let call = FileCall {
                order: FileOrder::Reload,
                answer: asker,
            };
            watcher.calls().calls.send(call).unwrap();
            let told = told.recv_timeout(PATIENCE_OF_TEST).unwrap();
            reports.recv_timeout(PATIENCE_OF_TEST).unwrap();
            told.map_err(|text| text.replace(&path.display().to_string(), "a.ron"))
        };
        let in_force = format!("{}: in force from now on", path.display());
        assert_eq!(ask(), Ok(in_force.clone()));
        assert_eq!(ask(), Ok(in_force));
        fs::write(&path, text("C")).unwrap();
        assert_eq!(ask(), Err("no C".into()));
        fs::write(&path, text("Entre")).unwrap();
        let error = ask().unwrap_err();
        assert!(
            error.starts_with("a.ron:3:35: unknown key `Entre`"),
            "{error}"
        );
        assert!(error.ends_with("\nthe layout in force stays"), "{error}");
    }

    #[test]
    fn the_watch_is_over_when_the_watcher_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let (watcher, reports) = watch(&path, |_| Ok(()));
        drop(watcher);
        let closed = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(closed, Err(RecvTimeoutError::Disconnected)));
    }

    #[test]
    fn the_watch_is_over_when_a_run_ends_before_it_takes_a_replacement() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, text("A")).unwrap();
        let layout = Layout::load(path.to_str().unwrap()).unwrap();
        let (sender, reports) = bounded::<ReloadReport>(1);
        let report = move |report| sender.send(report).unwrap();
        let (replace, replacements) = bounded::<Replacement>(1);
        let accept = |layout: &Layout| Ok(setup::controls(layout));
        let path = path.to_str().unwrap();
        let watcher =
            LayoutManager::start(Some(path), &layout, 0, replace, accept, report).unwrap();
        fs::write(path, text("B")).unwrap();
        while replacements.is_empty() {
            thread::sleep(Duration::from_millis(5));
        }
        drop(watcher);
        let closed = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(closed, Err(RecvTimeoutError::Disconnected)));
    }
}
