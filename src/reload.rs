//! A layout that is saved while a run is on: read, checked and built outside the loop.

mod watched_file;

use std::io;
use std::thread;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, bounded, select};

use self::watched_file::WatchedFile;
use crate::layout::{Layout, LayoutError};
use crate::runtime::Replacement;
use crate::settings;

/// How often the file is looked at. One look costs a few microseconds, works on every file system, and
/// sees a file that an editor puts in the place of the old one as well as one that is written to.
const PERIOD: Duration = Duration::from_millis(50);

/// What became of a file that was saved.
#[derive(Debug)]
pub enum Report {
    /// It is in force.
    Replaced(Layout),
    /// It is not as it should be, or not there; the layout in force stays.
    Wrong(LayoutError),
    /// It is right but cannot be used in this run, for this reason; the layout in force stays.
    Refused(String),
}

/// Watches a layout file on a thread of its own, until it is dropped.
pub struct Watcher {
    replacements: Receiver<Replacement>,
    _end: Sender<()>,
}

impl Watcher {
    /// Watches the file at `path`, from which `layout` was read.
    ///
    /// A file that is saved with another content comes out of [`replacements`](Self::replacements) at most
    /// 0.2 s later if it is right and `accept` takes it. Saves in quick succession count as the last of
    /// them; while they go on for longer than 2 s, each 2 s as one. `report` hears what became of each
    /// save, in order; of a replacement when it is in force. Two saves in one tick of the file system's
    /// clock, 2 s on FAT, look like one where their lengths are the same.
    pub fn start(
        path: &str,
        layout: &Layout,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
        mut report: impl FnMut(Report) + Send + 'static,
    ) -> io::Result<Self> {
        let mut file = WatchedFile::new(path, &layout.text, Instant::now());
        let (sender, replacements) = bounded(1);
        let (end, ended) = bounded(0);
        let watch = move || {
            while ended.recv_timeout(PERIOD) == Err(RecvTimeoutError::Timeout) {
                let outcome = match file.look(Instant::now()) {
                    None => continue,
                    Some(Err(error)) => Report::Wrong(error),
                    Some(Ok(layout)) => match accept(&layout) {
                        Err(reason) => Report::Refused(reason),
                        Ok(()) if !replace(&layout, &sender, &ended) => return,
                        Ok(()) => {
                            file.is_in_force(&layout.text);
                            Report::Replaced(layout)
                        }
                    },
                };
                report(outcome);
            }
        };
        // It is not waited for: a file system that hangs must not hold up the end of a run.
        thread::Builder::new().name("layout".into()).spawn(watch)?;
        Ok(Self {
            replacements,
            _end: end,
        })
    }

    /// Where the layouts come out that are to be put in force; closed when the watch is over.
    pub fn replacements(&self) -> Receiver<Replacement> {
        self.replacements.clone()
    }
}

/// Hands a layout to the loop and waits until it is in force; whether it is. Frees the old one.
fn replace(layout: &Layout, loop_end: &Sender<Replacement>, ended: &Receiver<()>) -> bool {
    let (replaced, old) = bounded(1);
    let replacement = Replacement {
        controls: Box::new(settings::controls(layout)),
        profile: 0,
        replaced,
    };
    // There is room: the one before is in force.
    if loop_end.try_send(replacement).is_err() {
        return false;
    }
    select! {
        recv(old) -> old => old.is_ok(),
        recv(ended) -> _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reload::watched_file::tests::text;
    use std::fs;

    /// What the watcher reports, with a loop that puts in force what comes.
    fn watch(
        path: &std::path::Path,
        accept: impl Fn(&Layout) -> Result<(), String> + Send + 'static,
    ) -> (Watcher, Receiver<Report>) {
        let path = path.to_str().unwrap();
        let layout = Layout::load(path).unwrap();
        let (sender, reports) = crossbeam_channel::unbounded();
        let report = move |report| sender.send(report).unwrap();
        let watcher = Watcher::start(path, &layout, accept, report).unwrap();
        let replacements = watcher.replacements();
        thread::spawn(move || {
            for replacement in replacements {
                let _ = replacement.replaced.send(replacement.controls);
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
            let Report::Replaced(layout) = report.expect("the last one is put in force") else {
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
        assert!(matches!(report, Ok(Report::Refused(reason)) if reason == "no B"));
        fs::write(&path, text("C")).unwrap();
        let report = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(report, Ok(Report::Replaced(layout)) if layout.name == "C"));
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
        let (sender, reports) = bounded::<Report>(1);
        let report = move |report| sender.send(report).unwrap();
        let watcher = Watcher::start(path.to_str().unwrap(), &layout, |_| Ok(()), report).unwrap();
        fs::write(&path, text("B")).unwrap();
        while watcher.replacements.is_empty() {
            thread::sleep(Duration::from_millis(5));
        }
        drop(watcher);
        let closed = reports.recv_timeout(PATIENCE_OF_TEST);
        assert!(matches!(closed, Err(RecvTimeoutError::Disconnected)));
    }
}
