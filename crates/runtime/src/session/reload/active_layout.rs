//! An active layout and its file.

use std::path::Path;
use std::time::Instant;

use super::LayoutReport;
use super::watched_file::WatchedFile;
use crate::files::{self, FileError, OpenDocument};
use crate::session::layout_link::{LayoutLink, SessionEnded};
use ademan_core::contact::board_pose::BoardPose;
use ademan_core::document::{Document, DocumentError};
use ademan_core::layout::{self, Layout};
use ademan_core::message::escape;
use ademan_core::pipeline::{CommandError, LayoutInstance};

const SHIPPED: &str = "the layout comes with the program or a recording and has no file; create one with `ademan layout new`";

/// A function that builds a layout for the session loop, in place of the layout of a profile by index, or returns the reason why the
/// session cannot use it.
pub(super) type Build<'a> = &'a dyn Fn(usize, &Layout) -> Result<LayoutInstance, String>;

/// One layout of the setup as the session loop uses it, and its file.
pub(super) struct ActiveLayout {
    /// `None` for a layout that comes with the program or a recording.
    file: Option<WatchedFile>,
    /// The layout with its present size, but with the board poses of the file.
    layout: Layout,
    /// Index of the profile.
    profile: usize,
    /// `true` if `layout` is an edited text that is not in the file.
    is_trial: bool,
}

impl ActiveLayout {
    /// Creates the entry of a layout that is active already.
    pub fn new(file: Option<WatchedFile>, layout: Layout, profile: usize) -> Self {
        Self {
            file,
            layout,
            profile,
            is_trial: false,
        }
    }

    /// Returns `true` if the layout has a file.
    pub fn has_file(&self) -> bool {
        self.file.is_some()
    }

    /// Returns the content of the file, once it has changed and settled.
    pub fn poll(&mut self, now: Instant) -> Option<Result<Layout, DocumentError>> {
        self.file.as_mut().and_then(|file| file.poll(now))
    }

    /// Returns `true` if every change of the file was handled.
    pub fn is_settled(&self) -> bool {
        self.file.as_ref().is_none_or(WatchedFile::is_settled)
    }

    /// Notes that the file may have changed.
    pub fn mark_changed(&mut self, now: Instant) {
        if let Some(file) = &mut self.file {
            file.mark_changed(now);
        }
    }

    /// Reads the file, settled or not.
    pub fn read(&self) -> Result<Layout, DocumentError> {
        match &self.file {
            Some(file) => file.read_now(),
            None => Ok(self.layout.clone()),
        }
    }

    /// Activates the content of the file.
    pub fn apply(
        &mut self,
        found: Result<Layout, DocumentError>,
        build: Build,
        link: &LayoutLink,
    ) -> Result<LayoutReport, SessionEnded> {
        let layout = match found {
            Err(error) => {
                self.set_refused();
                return Ok(LayoutReport::Invalid(error));
            }
            Ok(layout) => layout,
        };
        match build(self.profile, &layout) {
            Err(reason) => {
                self.set_refused();
                return Ok(LayoutReport::Rejected(reason));
            }
            Ok(instance) => link.activate(instance, self.profile, false)?,
        }
        if let Some(file) = &mut self.file {
            file.set_active_text(&layout.text);
        }
        self.is_trial = false;
        self.layout = layout.clone();
        Ok(LayoutReport::Activated(Box::new(layout)))
    }

    fn set_refused(&mut self) {
        if let Some(file) = &mut self.file {
            file.set_refused();
        }
    }

    /// Returns `true` if the file still has the content that is active, and notes that it can be used. While an edited text of it is
    /// tried, the content of the file is not active.
    pub fn accept_active(&mut self, found: &Layout) -> bool {
        let is_trial = self.is_trial;
        let active = self.file.as_mut();
        let active = active.filter(|file| !is_trial && file.text() == found.text);
        match active {
            Some(file) => {
                file.set_active_text(&found.text);
                true
            }
            None => false,
        }
    }

    /// Returns the file of the layout, as messages name it.
    pub fn file_name(&self) -> &str {
        &self.layout.file
    }

    /// Activates a text that is not saved, perhaps of another file. The active layout stays if it is invalid.
    pub fn try_text(
        &mut self,
        edited: Document,
        build: Build,
        link: &LayoutLink,
    ) -> Result<Result<(), String>, SessionEnded> {
        let name = edited.file.clone();
        let mut layout = match Layout::for_hands(edited, self.layout.fit) {
            Err(error) => return Ok(Err(format!("{error}\nthe active layout stays"))),
            Ok(layout) => layout,
        };
        // The layout keeps its name in the session, by which the next trial finds it.
        layout.file.clone_from(&self.layout.file);
        match build(self.profile, &layout) {
            Err(reason) => return Ok(Err(reason)),
            Ok(instance) => link.activate_text_of(&name, instance, self.profile)?,
        }
        let file = self.file.as_ref();
        self.is_trial = file.is_some_and(|file| file.text() != layout.text);
        self.layout = layout;
        Ok(Ok(()))
    }

    /// Multiplies the size of the boards by `factor`.
    pub fn scale(
        &mut self,
        factor: f32,
        build: Build,
        link: &LayoutLink,
    ) -> Result<Result<String, String>, SessionEnded> {
        if self.layout.boards.is_empty() {
            return Ok(Err(CommandError::NoBoards.to_string()));
        }
        let layout = layout::scale_boards(&self.document(), factor)
            .and_then(|text| self.layout.with_text(&text));
        let layout = match layout {
            Err(error) => return Ok(Err(format!("{error}\nthe size of the boards stays"))),
            Ok(layout) => layout,
        };
        match build(self.profile, &layout) {
            Err(reason) => return Ok(Err(reason)),
            Ok(instance) => link.activate(instance, self.profile, true)?,
        }
        self.layout = layout;
        Ok(Ok(format!("scaled by {factor}")))
    }

    /// Writes the size of the boards and their poses to the file, unless another program has changed it.
    pub fn save(&mut self, poses: &[BoardPose]) -> Result<String, String> {
        let active = self.document();
        let file = self.file.as_mut().ok_or(SHIPPED)?;
        let name = escape(&self.layout.file);
        if self.is_trial {
            return Err(format!(
                "{name}: not saved, as an edited text of it is tried; save that in its editor"
            ));
        }
        let differs = || {
            format!(
                "{name}: not saved, as the file differs from the active layout; `reload` activates the file"
            )
        };
        let on_disk = Document::from_path(file.path()).map_err(|error| error.to_string())?;
        if on_disk.text != file.text() {
            return Err(differs());
        }
        let text = layout::move_boards(&active, poses, &self.layout.fit)
            .map_err(|error| error.to_string())?;
        if text == on_disk.text {
            return Err(format!(
                "{name}: not saved, as no board was moved or scaled"
            ));
        }
        let layout = self.layout.with_text(&text);
        let layout = layout.map_err(|error| error.to_string())?;
        // An editor may have saved the file since the comparison.
        let is_unchanged =
            || Document::from_path(file.path()).is_ok_and(|document| document.text == file.text());
        let replaced = files::replace_text_if(Path::new(file.path()), &text, is_unchanged);
        replaced.map_err(|error| match error {
            FileError::Changed => differs(),
            other => format!("{name}: cannot write the file: {other}"),
        })?;
        file.set_active_text(&text);
        self.layout = layout;
        Ok(format!("{}: saved", escape(&self.layout.file)))
    }

    fn document(&self) -> Document {
        Document::new(self.layout.file.as_str(), self.layout.text.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Load;
    use crate::session::layout_link::LayoutOperation;
    use crate::session::reload::test_loop::{TIMEOUT, TestLoop};
    use std::path::PathBuf;
    use std::time::Duration;
    use std::{fs, thread};
    use tempfile::TempDir;

    const TEXT: &str = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), \
                        rows: [(at_mm: (0, 0), keys: \"A\")])])";

    /// Returns a session whose layout is from a file, and the path of the file in its folder.
    fn session_with_file() -> (TempDir, PathBuf, TestLoop) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        fs::write(&path, TEXT).unwrap();
        let layout = Layout::load(path.to_str().unwrap()).unwrap();
        let session = TestLoop::start(layout, Some(&path), |_| Ok(()));
        (folder, path, session)
    }

    fn save_at(height: f32) -> LayoutOperation {
        LayoutOperation::Save(vec![BoardPose {
            height,
            ..BoardPose::default()
        }])
    }

    #[test]
    fn a_shipped_layout_is_scaled_but_neither_saved_nor_reloaded() {
        let layout = Layout::parse(TEXT, "a.ron").unwrap();
        let session = TestLoop::start(layout, None, |_| Ok(()));
        assert_eq!(session.request(save_at(0.1)), Err(SHIPPED.into()));
        let error = session.request(LayoutOperation::Reload).unwrap_err();
        assert!(error.contains("no file"), "{error}");
        assert!(session.activated.is_empty());
        let double = || session.request(LayoutOperation::Scale(2.0));
        assert_eq!(double(), Ok("scaled by 2".into()));
        assert_eq!(
            session.activated.recv_timeout(TIMEOUT),
            Ok(true),
            "the boards keep their poses"
        );
        assert!(double().is_ok());
        let scale_error = double().unwrap_err();
        assert!(
            scale_error.contains("8 is out of range: a scale is 0.25 to 4"),
            "{scale_error}"
        );
        assert!(
            scale_error.ends_with("\nthe size of the boards stays"),
            "{scale_error}"
        );
    }

    #[test]
    fn saving_is_not_detected_as_a_change_of_the_file() {
        let (_folder, path, session) = session_with_file();
        assert!(session.request(save_at(0.1)).is_ok());
        let saved = fs::read_to_string(&path).unwrap();
        assert_eq!(saved, TEXT.replace("elbow", "elbow, height_mm: 100"));
        let again = session.request(save_at(0.1)).unwrap_err();
        assert!(
            again.ends_with("not saved, as no board was moved or scaled"),
            "{again}"
        );
        thread::sleep(Duration::from_millis(400));
        assert!(session.activated.is_empty());
    }

    #[test]
    fn the_outcome_of_an_operation_of_the_layout_is_reported_once() {
        let (_folder, _, session) = session_with_file();
        for operation in [LayoutOperation::Scale(2.0), LayoutOperation::Reload] {
            session.run_of_layout(operation);
        }
        let reports: Vec<_> = session.reports.try_iter().collect();
        assert!(
            matches!(
                reports.as_slice(),
                [LayoutReport::Command(Ok(text)), LayoutReport::Activated(_)] if text == "scaled by 2"
            ),
            "{reports:?}"
        );
    }

    #[test]
    fn poses_of_an_earlier_layout_are_not_saved() {
        let (_folder, path, session) = session_with_file();
        session.count_replaced();
        let error = session.request_after(0, save_at(0.1)).unwrap_err();
        assert!(
            error.starts_with("not saved, as a layout was replaced"),
            "{error}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), TEXT);
        assert!(session.request(save_at(0.1)).is_ok());
    }

    #[test]
    fn a_file_that_was_changed_or_is_read_only_is_not_overwritten() {
        let (folder, path, session) = session_with_file();
        let writable = fs::metadata(&path).unwrap().permissions();
        let mut readonly = writable.clone();
        readonly.set_readonly(true);
        fs::set_permissions(&path, readonly).unwrap();
        let error = session.request(save_at(0.1)).unwrap_err();
        assert!(
            error.ends_with("cannot write the file: it is read-only"),
            "{error}"
        );
        fs::set_permissions(&path, writable).unwrap();
        fs::write(&path, "no layout").unwrap();
        let text_error = session.request(save_at(0.1)).unwrap_err();
        assert!(
            text_error.contains("not saved, as the file differs from the active layout"),
            "{text_error}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "no layout");
        fs::remove_file(&path).unwrap();
        let missing_error = session.request(save_at(0.1)).unwrap_err();
        assert!(
            missing_error.ends_with("there is no such file"),
            "{missing_error}"
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_text_is_tried_without_its_file_and_an_invalid_one_is_not_activated() {
        let (_folder, path, session) = session_with_file();
        assert_eq!(session.try_text(&TEXT.replace("\"A\"", "\"B\"")), Ok(()));
        assert_eq!(session.activated.len(), 1);
        let error = session.try_text("no layout").unwrap_err();
        assert!(error.ends_with("the active layout stays"), "{error}");
        assert_eq!(session.activated.len(), 1);
        let save_error = session.request(save_at(0.1)).unwrap_err();
        assert!(save_error.contains("is tried"), "{save_error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), TEXT);
        session.request(LayoutOperation::Reload).unwrap();
        assert_eq!(session.activated.len(), 2);
        assert!(session.request(save_at(0.1)).is_ok());
    }

    #[test]
    fn a_file_that_is_valid_again_is_used_in_place_of_a_text_that_is_tried() {
        let (_folder, path, session) = session_with_file();
        let report = || session.reports.recv_timeout(TIMEOUT).unwrap();
        assert_eq!(session.try_text(&TEXT.replace("\"A\"", "\"B\"")), Ok(()));
        fs::write(&path, "no layout").unwrap();
        assert!(matches!(report(), LayoutReport::Invalid(_)));
        fs::write(&path, TEXT).unwrap();
        assert!(matches!(report(), LayoutReport::Activated(layout) if layout.text == TEXT));
        assert_eq!(session.activated.len(), 2);
    }
}
