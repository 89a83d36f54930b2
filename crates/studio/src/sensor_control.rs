//! Changes of the sensors from the window: the glove, its file, the filter, and the guided calibration.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::filter_trace::{FilterSample, FilterTrace};
use super::glove_editor::GloveEditor;
use super::glove_file::{GloveFile, SaveError};
use super::guide::Guide;
use super::sensors::{SensorTable, is_of_first_hand, other_side};
use super::texts::text_with;
use ademan_core::command::CommandOrigin;
use ademan_core::estimate::Smoothing;
use ademan_core::hand::JointAngles;
use ademan_core::message::escape_path;
use ademan_core::snapshot::Snapshot;
use ademan_runtime::capture::{Channels, Sample, SourceUri};
use ademan_runtime::files;
use ademan_runtime::session::{RequestError, SensorLink};
use ademan_runtime::setup::LoadedSetup;

/// Time between two measurements of the lag, in frames.
const LAG_FRAMES: u32 = 30;

/// Returns `true` if a source is a simulated hand.
fn is_simulated(source: &SourceUri) -> bool {
    matches!(source, SourceUri::Typist { .. } | SourceUri::Script { .. })
}

/// The changes of the sensors of a session.
pub struct SensorControl {
    link: Arc<SensorLink>,
    /// The glove; `None` if the source needs none.
    pub editor: Option<GloveEditor>,
    file: Result<GloveFile, SaveError>,
    smoothing: Smoothing,
    /// The calibration or the filter has changed and is not in the session yet.
    is_change_due: bool,
    /// The channel whose values are shown.
    pub selected: Option<usize>,
    /// The row of the map whose angle is plotted.
    traced: usize,
    trace: FilterTrace,
    lag: Option<Duration>,
    frames: u32,
    /// The guided calibration.
    pub guide: Option<Guide>,
    /// The session was not paused before the guided calibration, which ends the pause.
    ends_pause: bool,
    /// The file that is replaced after a question.
    question: Option<PathBuf>,
    /// Confirmation of the last save.
    pub notice: Option<String>,
    /// Reason why the last change was not made.
    pub message: Option<String>,
}

impl SensorControl {
    /// Returns the setup of the session.
    pub fn setup(&self) -> &LoadedSetup {
        self.link.setup()
    }

    /// Creates the control of a session.
    pub fn new(link: &Arc<SensorLink>) -> Self {
        let document = link.glove_document();
        let name = document.map_or("", |document| document.file.as_str());
        let folder = files::config_folder();
        Self {
            editor: document.and_then(|document| GloveEditor::new(document).ok()),
            file: GloveFile::new(link.setup().glove_path(), name, folder.as_deref()),
            smoothing: link.smoothing(),
            link: Arc::clone(link),
            is_change_due: false,
            selected: None,
            traced: 0,
            trace: FilterTrace::default(),
            lag: None,
            frames: 0,
            guide: None,
            ends_pause: false,
            question: None,
            notice: None,
            message: None,
        }
    }

    /// Returns the channels of the glove with their present calibration.
    pub fn table(&self) -> SensorTable {
        let map = self.editor.as_ref().map(GloveEditor::map);
        let table = map.map(SensorTable::new).unwrap_or_default();
        let source = self.setup().setup.source.as_ref();
        table
            .with_simulated(source.is_none_or(is_simulated))
            .with_other_hand(other_side(self.setup()))
    }

    /// Keeps the glove of the previous session, if this session was started with the same file, or with what that session has saved
    /// to it: what is not saved stays.
    pub fn keep_glove(&mut self, before: &mut Self) {
        let (Some(own), Some(edited)) = (&self.editor, &before.editor) else {
            return;
        };
        let is_saved = match (&self.file, &before.file) {
            (Ok(file), Ok(saved)) => {
                file.path() == saved.path() && saved.has_written(&own.document().text)
            }
            _ => false,
        };
        if is_saved || own.document() == edited.document() {
            self.is_change_due |= own.calibration() != edited.calibration();
            self.editor = before.editor.take();
            std::mem::swap(&mut self.file, &mut before.file);
        }
    }

    /// Keeps the filter of the previous session, unless the setup of this session has another filter.
    pub fn keep_smoothing(&mut self, before: &Self) {
        if self.link.smoothing() == before.link.smoothing() {
            self.set_smoothing(before.smoothing);
        }
    }

    /// Removes what changes the session: a recording is shown in its place.
    pub fn lock(&mut self) {
        self.editor = None;
    }

    /// Processes the results of a step.
    pub fn update(&mut self, snapshot: &Snapshot) {
        let Some(reading) = &snapshot.reading else {
            return;
        };
        if !is_of_first_hand(reading, other_side(self.setup())) {
            return;
        }
        let Sample::Channels(channels) = &reading.sample else {
            return;
        };
        if let Some(guide) = &mut self.guide {
            guide.push(reading.time, channels);
        }
        let filtered = snapshot.angles.as_ref();
        if let Some((raw, filtered)) =
            filtered.and_then(|angles| self.traced_angles(channels, angles))
        {
            self.trace.push(FilterSample {
                time: reading.time,
                raw,
                filtered,
            });
        }
    }

    /// Returns the plotted angle before and after the filter, in degrees.
    fn traced_angles(&self, channels: &Channels, filtered: &JointAngles) -> Option<(f64, f64)> {
        let map = self.editor.as_ref()?.map();
        let row = map.rows().get(self.traced)?;
        let count = *channels.counts.get(row.channel)?;
        let raw = map.radians(row, f64::from(count)).to_degrees();
        let is_known = filtered.is_known(row.dof) && count != Channels::UNKNOWN;
        is_known.then(|| (raw, filtered.get(row.dof).to_degrees()))
    }

    /// Moves a demonstration on, and sends a change to the session. `elapsed` is the time since the last frame.
    pub fn advance(&mut self, elapsed: Duration, table: &mut SensorTable) {
        if let Some(guide) = &mut self.guide {
            guide.advance(elapsed);
        }
        if self.frames.is_multiple_of(LAG_FRAMES) {
            self.lag = self.trace.lag();
        }
        self.frames = self.frames.wrapping_add(1);
        if std::mem::take(&mut self.is_change_due) {
            self.send(table);
        }
    }

    fn send(&mut self, table: &mut SensorTable) {
        let calibration = self.editor.as_ref().map(GloveEditor::calibration);
        let map = calibration.map(|calibration| &calibration.map);
        let rest = calibration.map(|calibration| calibration.rest);
        if let Some(map) = map {
            table.set_calibration(map);
        }
        match self
            .link
            .replace(map, &rest.unwrap_or_default(), self.smoothing)
        {
            Ok(()) => self.trace.clear(),
            // The session has not made the last change yet.
            Err(RequestError::QueueFull) => self.is_change_due = true,
            Err(error) => self.message = Some(error.to_string()),
        }
    }

    /// Returns `true` if the glove has changes that are not saved.
    pub fn is_unsaved(&self) -> bool {
        self.editor.as_ref().is_some_and(GloveEditor::is_changed)
    }

    /// Changes the glove, and the session with the next frame if that has an effect.
    pub fn edit(&mut self, change: impl FnOnce(&mut GloveEditor)) {
        let Some(editor) = &mut self.editor else {
            return;
        };
        let before = editor.calibration().clone();
        change(editor);
        self.is_change_due |= *editor.calibration() != before;
    }

    /// Returns the filter of the joint angles.
    pub fn smoothing(&self) -> Smoothing {
        self.smoothing
    }

    /// Changes the filter of the joint angles.
    pub fn set_smoothing(&mut self, smoothing: Smoothing) {
        self.is_change_due |= self.smoothing != smoothing;
        self.smoothing = smoothing;
    }

    /// Returns the row of the map whose angle is plotted.
    pub fn traced(&self) -> usize {
        self.traced
    }

    /// Plots the angle of another row of the map.
    pub fn set_traced(&mut self, row: usize) {
        if self.traced != row {
            self.traced = row;
            self.trace.clear();
            self.lag = None;
        }
    }

    /// Returns the plotted angle.
    pub fn trace(&self) -> &FilterTrace {
        &self.trace
    }

    /// Returns the measured lag of the filter.
    pub fn lag(&self) -> Option<Duration> {
        self.lag
    }

    /// Saves the glove. A file that this window has not written is replaced only with `may_replace`; otherwise a question is
    /// shown. Returns `true` if it was saved.
    pub fn save(&mut self, may_replace: bool) -> bool {
        (self.question, self.notice, self.message) = (None, None, None);
        let (Some(editor), Ok(file)) = (&mut self.editor, &mut self.file) else {
            self.message = self.file.as_ref().err().map(ToString::to_string);
            return false;
        };
        let text = match editor.text() {
            Ok(text) => text,
            Err(error) => {
                self.message = Some(error.to_string());
                return false;
            }
        };
        match file.save(&text, may_replace) {
            Ok(()) => editor.set_saved(),
            Err(SaveError::Exists(path)) => {
                self.question = Some(path);
                return false;
            }
            Err(error) => {
                self.message = Some(error.to_string());
                return false;
            }
        }
        let file = escape_path(file.path());
        self.notice = Some(text_with("glove-saved", &[("file", file.into())]));
        true
    }

    /// Returns the file that the glove is saved to.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_ref().ok().map(GloveFile::path)
    }

    /// Returns the copy of a replaced file.
    pub fn backup(&self) -> Option<PathBuf> {
        self.file.as_ref().ok().map(GloveFile::backup)
    }

    /// Returns the file whose replacement waits for an answer.
    pub fn question(&self) -> Option<&Path> {
        self.question.as_deref()
    }

    /// Answers the question with a no.
    pub fn keep_file(&mut self) {
        self.question = None;
    }

    /// Starts a guided calibration of the present glove.
    pub fn start_calibration(&mut self, start: impl FnOnce(&GloveEditor) -> Guide) {
        (self.notice, self.message) = (None, None);
        self.guide = self.editor.as_ref().map(start);
    }

    /// Notes who has paused the session before the guided calibration pauses it.
    pub fn note_pause(&mut self, paused_by: Option<CommandOrigin>) {
        self.ends_pause = paused_by.is_none();
    }

    /// Returns `true`, once, if the end of the guided calibration ends the pause: the session was not paused before, and no other side
    /// has paused it since.
    pub fn take_pause(&mut self, paused_by: Option<CommandOrigin>) -> bool {
        // A view may not have the pause yet.
        let is_own = paused_by.is_none_or(|origin| origin == CommandOrigin::Client);
        std::mem::take(&mut self.ends_pause) && is_own
    }

    /// Adopts the result of the guided calibration, as an edit that can be undone, and ends the calibration.
    pub fn adopt_result(&mut self) {
        let result = self.guide.as_ref().and_then(Guide::result);
        let Some(Ok(result)) = result else {
            return;
        };
        let calibration = result.calibration.clone();
        self.guide = None;
        self.edit(|editor| editor.set_all(calibration));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use ademan_core::document::Document;
    use ademan_runtime::session::{Session, SessionHandle, SessionOptions};
    use ademan_runtime::setup::{Setup, SmoothingSetup};

    /// Starts a session of a simulated hand that wears a glove, without an output.
    pub fn session() -> SessionHandle {
        session_with(None)
    }

    /// Starts such a session with a glove file.
    fn session_with(glove: Option<&str>) -> SessionHandle {
        session_of(Setup {
            glove: glove.map(str::to_owned),
            ..Setup::default()
        })
    }

    /// Starts such a session with the rest of a setup.
    fn session_of(setup: Setup) -> SessionHandle {
        let setup = Setup {
            source: Some("typist:hello".parse().expect("a source")),
            output: "none".into(),
            ..setup
        };
        let setup = setup.load_files().expect("the shipped files");
        Session::start(setup, SessionOptions::default()).expect("a session")
    }

    #[test]
    fn what_is_not_saved_stays_in_the_next_session_also_after_a_save() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mine.ron");
        let shipped = Document::shipped("unam-hc11").expect("a shipped glove");
        std::fs::write(&path, &shipped.text).expect("a file");
        let first = session_with(path.to_str());
        let mut sensors = SensorControl::new(first.sensors());
        sensors.edit(|editor| editor.set_zero_count(4, 40.0));
        assert!(sensors.save(true));
        sensors.edit(|editor| editor.set_zero_count(4, 50.0));
        let second = session_with(path.to_str());
        let mut next = SensorControl::new(second.sensors());
        assert!(!next.is_unsaved());
        next.keep_glove(&mut sensors);
        assert!(next.is_unsaved());
        assert!(next.save(false), "Studio has written the file");
    }

    #[test]
    fn a_filter_that_was_chosen_stays_in_the_next_session() {
        let first = session();
        let mut sensors = SensorControl::new(first.sensors());
        sensors.set_smoothing(Smoothing::Off);
        let second = session();
        let mut next = SensorControl::new(second.sensors());
        next.keep_smoothing(&sensors);
        assert_eq!(next.smoothing(), Smoothing::Off);
        assert!(next.is_change_due, "the session gets it");
        let other = session_of(Setup {
            smoothing: SmoothingSetup::RecursiveAverage,
            ..Setup::default()
        });
        let mut of_other = SensorControl::new(other.sensors());
        of_other.keep_smoothing(&next);
        assert_eq!(of_other.smoothing(), Smoothing::RecursiveAverage);
    }

    #[test]
    fn a_calibration_ends_no_pause_but_its_own() {
        use CommandOrigin::{Client, Layout, Signal};
        let session = session();
        let mut sensors = SensorControl::new(session.sensors());
        for (before, at_end, is_ended) in [
            (None, Some(Client), true),
            (None, None, true),
            (None, Some(Signal), false),
            (Some(Client), Some(Client), false),
            (Some(Layout), Some(Client), false),
        ] {
            sensors.note_pause(before);
            let ended = sensors.take_pause(at_end);
            assert_eq!(ended, is_ended, "{before:?}, {at_end:?}");
            assert!(!sensors.take_pause(at_end), "once");
        }
    }
}
