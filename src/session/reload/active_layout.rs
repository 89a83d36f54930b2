//! A layout in force and the file that it is from.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::watched_file::WatchedFile;
use super::{FileCall, FileOrder, ReloadReport};
use crate::contact::board_pose::BoardPose;
use crate::document::{Document, DocumentError};
use crate::layout::{self, Layout};
use crate::pipeline::LayoutInstance;
use crate::session::Replacement;

const SHIPPED: &str = "the layout comes with the program: there is no file of yours, begin one with \
     `ademan layout new`";

/// The run has ended.
pub(super) struct SessionEnded;

/// Looks after one layout of a setup.
pub(super) struct ActiveLayout<A> {
    /// `None` where the layout comes with the program.
    pub file: Option<WatchedFile>,
    /// What is in force, apart from where its boards were moved to.
    pub layout: Layout,
    pub profile: usize,
    pub replacements: Sender<Replacement>,
    pub ended: Receiver<()>,
    /// Makes controls of a layout that this run can use.
    pub build: A,
}

impl<A: Fn(&Layout) -> Result<LayoutInstance, String>> ActiveLayout<A> {
    /// Looks whether the file was saved, and puts it in force if so.
    pub fn poll(&mut self, now: Instant) -> Result<Option<ReloadReport>, SessionEnded> {
        let found = self.file.as_mut().and_then(|file| file.poll(now));
        found.map(|found| self.apply(found)).transpose()
    }

    /// Whether all that was seen to happen to the file was dealt with.
    pub fn is_settled(&self) -> bool {
        self.file.as_ref().is_none_or(WatchedFile::is_settled)
    }

    /// Something has happened to the file.
    pub fn mark_changed(&mut self, now: Instant) {
        if let Some(file) = &mut self.file {
            file.mark_changed(now);
        }
    }

    /// Does what it is asked for and says what came of it.
    pub fn handle(&mut self, call: FileCall) -> Result<Option<ReloadReport>, SessionEnded> {
        let mut outcome = None;
        let answer = match call.order {
            FileOrder::Reload => match &self.file {
                None => Err(SHIPPED.into()),
                Some(file) => {
                    let report = self.apply(file.read_now())?;
                    let text = report.to_string();
                    let is_in_force = matches!(report, ReloadReport::Replaced(_));
                    outcome = Some(report);
                    if is_in_force { Ok(text) } else { Err(text) }
                }
            },
            FileOrder::Scale(factor) => self.scale(factor)?,
            FileOrder::Save(places) => self.save(&places),
        };
        // Whoever asked may have gone away.
        let _ = call.answer.try_send(answer);
        Ok(outcome)
    }

    fn apply(
        &mut self,
        found: Result<Layout, DocumentError>,
    ) -> Result<ReloadReport, SessionEnded> {
        let layout = match found {
            Err(error) => return Ok(ReloadReport::Invalid(error)),
            Ok(layout) => layout,
        };
        match (self.build)(&layout) {
            Err(reason) => return Ok(ReloadReport::Rejected(reason)),
            Ok(controls) => self.replace(controls, false)?,
        }
        if let Some(file) = &mut self.file {
            file.set_active_text(&layout.text);
        }
        self.layout = layout.clone();
        Ok(ReloadReport::Replaced(Box::new(layout)))
    }

    fn scale(&mut self, factor: f32) -> Result<Result<String, String>, SessionEnded> {
        let layout = layout::scale_boards(&self.document(), factor)
            .and_then(|text| Layout::parse(&text, &self.layout.file));
        let layout = match layout {
            Err(error) => {
                return Ok(Err(format!(
                    "{error}\nthe boards stay as large as they are"
                )));
            }
            Ok(layout) => layout,
        };
        match (self.build)(&layout) {
            Err(reason) => return Ok(Err(reason)),
            Ok(controls) => self.replace(controls, true)?,
        }
        self.layout = layout;
        Ok(Ok(format!("{factor} times as large")))
    }

    /// Writes where the boards are into the file, if nobody has changed it.
    fn save(&mut self, places: &[BoardPose]) -> Result<String, String> {
        let file = self.file.as_mut().ok_or(SHIPPED)?;
        let name = &self.layout.file;
        let on_disk = Document::from_path(file.path()).map_err(|error| error.to_string())?;
        if on_disk.text != file.text() {
            return Err(format!(
                "{name}: not saved, as the file is not the one in force; `reload` puts it in force"
            ));
        }
        let in_force = Document::new(name.as_str(), self.layout.text.as_str());
        let text = layout::move_boards(&in_force, places).map_err(|error| error.to_string())?;
        if text == on_disk.text {
            return Err(format!("{name}: not saved, as nothing was moved"));
        }
        let layout = Layout::parse(&text, name).map_err(|error| error.to_string())?;
        write(Path::new(file.path()), &text)
            .map_err(|error| format!("{name}: cannot write the file: {error}"))?;
        file.set_active_text(&text);
        self.layout = layout;
        Ok(format!("{}: saved", self.layout.file))
    }

    fn document(&self) -> Document {
        Document::new(self.layout.file.as_str(), self.layout.text.as_str())
    }

    /// Hands controls to the loop, waits until they are in force, and frees the old ones.
    fn replace(&self, controls: LayoutInstance, keeps_places: bool) -> Result<(), SessionEnded> {
        let (replaced, old) = bounded(1);
        let replacement = Replacement {
            controls: Box::new(controls),
            profile: self.profile,
            keep_board_poses: keeps_places,
            retired: replaced,
        };
        select! {
            send(self.replacements, replacement) -> sent => sent.map_err(|_| SessionEnded)?,
            recv(self.ended) -> _ => return Err(SessionEnded),
        }
        select! {
            recv(old) -> old => old.map(drop).map_err(|_| SessionEnded),
            recv(self.ended) -> _ => Err(SessionEnded),
        }
    }
}

/// Puts a text in the place of a file: whoever reads it sees the old one or the new one, also when the
/// machine stops halfway. Who may read and write it stays, and so does a link to it.
fn write(path: &Path, text: &str) -> io::Result<()> {
    let path = fs::canonicalize(path)?;
    let permissions = fs::metadata(&path)?.permissions();
    if permissions.readonly() {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "it may only be read",
        ));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".{name}.{}", std::process::id()));
    let written = fs::File::options()
        .write(true)
        .create_new(true)
        .open(&beside)
        .and_then(|mut file| {
            file.set_permissions(permissions)?;
            file.write_all(text.as_bytes())?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&beside, &path));
    if written.is_err() {
        let _ = fs::remove_file(&beside);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::reload::LayoutManager;
    use crate::setup;
    use std::thread;
    use std::time::Duration;

    const TEXT: &str = "Layout(name: \"a\", boards: [(place: (anchor: elbow), \
                        rows: [(at_mm: (0, 0), keys: \"A\")])])";

    /// Somebody who looks after a layout, and what a loop that puts in force what comes has of it.
    struct Bench {
        watcher: LayoutManager,
        in_force: Receiver<bool>,
    }

    impl Bench {
        fn new(path: Option<&str>) -> Self {
            let layout = match path {
                Some(path) => Layout::load(path).unwrap(),
                None => Layout::parse(TEXT, "a.ron").unwrap(),
            };
            let (replace, replacements) = bounded::<Replacement>(1);
            let (sender, in_force) = crossbeam_channel::unbounded();
            thread::spawn(move || {
                for replacement in replacements {
                    let _ = sender.send(replacement.keep_board_poses);
                    let _ = replacement.retired.send(replacement.controls);
                }
            });
            let accept = |layout: &Layout| Ok(setup::controls(layout));
            let watcher = LayoutManager::start(path, &layout, 0, replace, accept, |_| {}).unwrap();
            Self { watcher, in_force }
        }

        fn ask(&self, order: FileOrder) -> Result<String, String> {
            let (answer, answered) = bounded(1);
            let call = FileCall { order, answer };
            self.watcher.calls().calls.send(call).unwrap();
            answered.recv_timeout(Duration::from_secs(20)).unwrap()
        }
    }

    fn up(height: f32) -> FileOrder {
        FileOrder::Save(vec![BoardPose {
            height,
            ..BoardPose::default()
        }])
    }

    #[test]
    fn a_shipped_layout_is_scaled_and_not_saved_nor_read_again() {
        let bench = Bench::new(None);
        assert_eq!(bench.ask(up(0.1)), Err(SHIPPED.into()));
        assert_eq!(bench.ask(FileOrder::Reload), Err(SHIPPED.into()));
        assert!(bench.in_force.is_empty());
        assert_eq!(
            bench.ask(FileOrder::Scale(2.0)),
            Ok("2 times as large".into())
        );
        assert_eq!(
            bench.in_force.recv(),
            Ok(true),
            "its boards stay where they are"
        );
        assert!(bench.ask(FileOrder::Scale(2.0)).is_ok());
        let error = bench.ask(FileOrder::Scale(2.0)).unwrap_err();
        assert!(
            error.contains("8 is out of range: a scale is 0.25 to 4"),
            "{error}"
        );
        assert!(
            error.ends_with("\nthe boards stay as large as they are"),
            "{error}"
        );
        assert!(bench.watcher.calls().is_shipped);
    }

    #[test]
    fn a_save_is_not_taken_for_a_change() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, TEXT).unwrap();
        let bench = Bench::new(Some(path.to_str().unwrap()));
        assert!(bench.ask(up(0.1)).is_ok());
        let saved = fs::read_to_string(&path).unwrap();
        assert_eq!(saved, TEXT.replace("elbow", "elbow, height_mm: 100"));
        let again = bench.ask(up(0.1)).unwrap_err();
        assert!(
            again.ends_with("not saved, as nothing was moved"),
            "{again}"
        );
        thread::sleep(Duration::from_millis(400));
        assert!(bench.in_force.is_empty());
    }

    #[test]
    fn a_file_that_was_changed_or_may_only_be_read_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, TEXT).unwrap();
        let bench = Bench::new(Some(path.to_str().unwrap()));
        let writable = fs::metadata(&path).unwrap().permissions();
        let mut readonly = writable.clone();
        readonly.set_readonly(true);
        fs::set_permissions(&path, readonly).unwrap();
        let error = bench.ask(up(0.1)).unwrap_err();
        assert!(
            error.ends_with("cannot write the file: it may only be read"),
            "{error}"
        );
        fs::set_permissions(&path, writable).unwrap();
        fs::write(&path, "no layout").unwrap();
        let error = bench.ask(up(0.1)).unwrap_err();
        assert!(
            error.contains("not saved, as the file is not the one in force"),
            "{error}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "no layout");
        fs::remove_file(&path).unwrap();
        let error = bench.ask(up(0.1)).unwrap_err();
        assert!(error.ends_with("there is no such file"), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
