//! A part of a recording between two marks, and its export.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui;

use crate::playback::{ExportError, Job, Player, default_name, export};
use crate::texts::{text, text_with};
use ademan_core::time::Timestamp;

/// The marks and the export of a part.
#[derive(Default)]
pub struct PartState {
    /// Index and time of the first and the last step.
    from: Option<(usize, Timestamp)>,
    to: Option<(usize, Timestamp)>,
    /// Path of the file; `None` before the first frame.
    file: Option<String>,
    job: Option<Job<Result<u64, ExportError>>>,
    /// The file exists, and the person is asked.
    is_asking: bool,
    /// Result of the last export.
    message: Option<String>,
}

impl PartState {
    /// Returns the marks as fractions of the steps, if there are any.
    pub fn marks(&self, player: &Player) -> Option<(f64, f64)> {
        if self.from.is_none() && self.to.is_none() {
            return None;
        }
        let last = player.len().saturating_sub(1).max(1) as f64;
        let from = self.from.map_or(0.0, |(index, _)| index as f64 / last);
        let to = self.to.map_or(1.0, |(index, _)| index as f64 / last);
        Some((from.min(to), to.max(from)))
    }

    /// Returns the times of the part: the whole recording without marks.
    fn range(&self, player: &Player) -> Option<RangeInclusive<Timestamp>> {
        let (start, end) = player.range()?;
        let from = self.from.map_or(start, |(_, time)| time);
        let to = self.to.map_or(end, |(_, time)| time);
        Some(from.min(to)..=to.max(from))
    }

    fn start(&mut self, player: &Player, may_replace: bool) {
        let Some(range) = self.range(player) else {
            return;
        };
        let recording = Arc::clone(player.recording());
        let path = PathBuf::from(self.file.clone().unwrap_or_default());
        (self.is_asking, self.message) = (false, None);
        let work = move || export(&recording, range, &path, may_replace);
        self.job = Some(Job::start(work));
    }

    /// Receives the result of an export.
    fn receive(&mut self) {
        let Some(result) = self.job.as_ref().and_then(Job::poll) else {
            return;
        };
        self.job = None;
        let file = self.file.clone().unwrap_or_default();
        self.message = match result {
            Ok(Ok(readings)) => {
                let values = [("count", readings.into()), ("file", file.into())];
                Some(text_with("recording-exported", &values))
            }
            Ok(Err(ExportError::Exists(_))) => {
                self.is_asking = true;
                None
            }
            Ok(Err(error)) => Some(error.to_string()),
            Err(lost) => Some(lost.to_string()),
        };
    }
}

pub(super) fn show(ui: &mut egui::Ui, state: &mut PartState, player: &Player) {
    state.receive();
    let here = || Some((player.position(), player.time()));
    ui.label(text("recording-part"));
    if ui.button(text("recording-from")).clicked() {
        state.from = here();
    }
    if ui.button(text("recording-to")).clicked() {
        state.to = here();
    }
    if let Some(range) = state.range(player) {
        let length = range.end().since(*range.start()).as_secs_f64();
        ui.monospace(format!("{length:.3} s"));
    }
    let default = || {
        default_name(&player.recording().path)
            .to_string_lossy()
            .into_owned()
    };
    let file = state.file.get_or_insert_with(default);
    let label = ui.label(text("recording-file"));
    let field = egui::TextEdit::singleline(file).desired_width(210.0);
    if ui.add(field).labelled_by(label.id).changed() {
        state.is_asking = false;
    }
    let can_export = state.job.is_none() && player.is_complete() && !player.is_empty();
    let button = egui::Button::new(text("recording-export"));
    if ui.add_enabled(can_export, button).clicked() {
        state.start(player, false);
    }
    if state.job.is_some() {
        ui.label(text("recording-exporting"));
    }
    if state.is_asking {
        let asked_file = state.file.clone().unwrap_or_default();
        let question = text_with("recording-replace", &[("file", asked_file.into())]);
        ui.colored_label(ui.visuals().warn_fg_color, question);
        if ui.button(text("recording-replace-yes")).clicked() {
            state.start(player, true);
        }
        if ui.button(text("recording-replace-no")).clicked() {
            state.is_asking = false;
        }
    }
    if let Some(message) = &state.message {
        ui.label(message);
    }
}
