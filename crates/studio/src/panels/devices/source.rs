//! The source: the simulated hand, a serial port of this machine, a recording, or any source as it is written after `--source`.

use eframe::egui;

use std::path::{Path, PathBuf, absolute};

use super::super::first_start::{name_of, words_of, words_of_camera};
use super::super::headset::show_consent;
use super::{DevicesWindow, file_field};
use crate::first_start::{Port, Search};
use crate::setup_change::SetupChange;
use crate::texts::text;
use ademan_core::command::Command;
use ademan_core::message::escape_path;
use ademan_runtime::capture::cameras::cameras;
use ademan_runtime::capture::recognition::{Recognition, port_names};
use ademan_runtime::capture::uri::schemes;
use ademan_runtime::capture::{CaptureError, SourceUri};
use ademan_runtime::setup::LoadedSetup;

/// Key of the text about a port that sends nothing.
const SILENT: &str = "devices-silent";

/// Shows the sources of this machine, and lets sources on the network press keys. Returns the choice.
pub(super) fn show(
    ui: &mut egui::Ui,
    window: &mut DevicesWindow,
    loaded: &LoadedSetup,
    sent: &mut Vec<Command>,
) -> Option<SetupChange> {
    let present = loaded.setup.source.as_ref();
    let mut chosen = None;
    ui.horizontal(|ui| {
        ui.strong(text("devices-source"));
        if ui.button(text("devices-search")).clicked() {
            (window.search, window.recordings, window.own) = (None, None, None);
        }
    });
    if ui
        .radio(present.is_none(), text("first-simulated"))
        .clicked()
    {
        chosen = Some(None);
    }
    let search = window.search.get_or_insert_with(|| search_beside(loaded));
    search.update();
    if search.is_listening() {
        ui.ctx().request_repaint();
    }
    for source in ports_in_use(loaded) {
        let is_present = present == Some(source);
        if ui.radio(is_present, name_of(source)).clicked() && !is_present {
            chosen = Some(Some(source.clone()));
        }
    }
    for port in search.ports() {
        chosen = show_port(ui, port).map(Some).or(chosen);
    }
    for camera in search.cameras() {
        ui.label(words_of_camera(camera));
    }
    let recordings = window.recordings.as_ref();
    let recordings = recordings.map_or(&[][..], |it| it.found().as_slice());
    chosen = show_recordings(ui, recordings, present).or(chosen);
    let is_listed = |uri: &SourceUri| {
        let listed = recording_of(uri).is_some_and(|path| recordings.contains(&path));
        listed || uri.serial_port().is_some()
    };
    if let Some(other) = present.filter(|uri| !is_listed(uri)) {
        // A click on the present source changes nothing.
        let _ = ui.radio(true, name_of(other));
    }
    if loaded.setup.source_uris().any(SourceUri::is_remote) {
        show_consent(ui, "devices-keys", sent);
    }
    chosen.map(SetupChange::Source)
}

/// Shows what was heard on a port, and what it may be. Returns the source that is chosen.
fn show_port(ui: &mut egui::Ui, port: &Port) -> Option<SourceUri> {
    ui.label(words_of(port, SILENT));
    if port.heard.is_none() {
        // The room for its source, whose row would move what is below it from under the mouse.
        let row = ui.spacing().interact_size.y;
        ui.allocate_space(egui::vec2(0.0, row));
    }
    let mut chosen = None;
    for source in sources_of(port) {
        if ui.radio(false, name_of(&source)).clicked() {
            chosen = Some(source);
        }
    }
    chosen
}

/// Shows the recordings of this machine. A click on the present one plays it again.
fn show_recordings(
    ui: &mut egui::Ui,
    recordings: &[PathBuf],
    present: Option<&SourceUri>,
) -> Option<Option<SourceUri>> {
    if recordings.is_empty() {
        return None;
    }
    ui.label(text("devices-recordings"));
    let present = present.and_then(recording_of);
    let mut chosen = None;
    for path in recordings {
        let name = path.file_name().unwrap_or_default();
        let radio = ui.radio(present.as_ref() == Some(path), escape_path(Path::new(name)));
        if radio.on_hover_text(escape_path(path)).clicked() {
            chosen = Some(Some(SourceUri::Recording { path: path.clone() }));
        }
    }
    chosen
}

/// Returns the whole path of a recording that is a source.
fn recording_of(uri: &SourceUri) -> Option<PathBuf> {
    match uri {
        SourceUri::Recording { path } => absolute(path).ok(),
        _ => None,
    }
}

/// Shows rows of a grid for a recording and for any source. A URI with a fault is reported in the window.
pub(super) fn show_fields(ui: &mut egui::Ui, window: &mut DevicesWindow) -> Option<SetupChange> {
    let id = file_field::id("devices-uri-hint");
    if window.is_focus_due && !ui.is_sizing_pass() {
        // A frame that only measures the window drops the focus again.
        window.is_focus_due = !ui.memory(|memory| memory.has_focus(id));
        ui.memory_mut(|memory| memory.request_focus(id));
    }
    let kinds: Vec<&str> = schemes().map(|scheme| scheme.syntax).collect();
    let label = ui
        .strong(text("devices-uri"))
        .on_hover_text(kinds.join("\n"));
    let words = ("devices-uri-hint", "devices-use");
    let field = ui.horizontal(|ui| file_field::show_beside(ui, &label, words, &mut window.source));
    ui.end_row();
    let recording_label = ui.strong(text("devices-recording"));
    let recording_words = ("devices-recording-hint", "devices-use");
    let recording = ui.horizontal(|ui| {
        file_field::show_beside(ui, &recording_label, recording_words, &mut window.recording)
    });
    ui.end_row();
    let recording = recording
        .inner
        .map(|path| SourceUri::Recording { path: path.into() });
    let source = match field.inner.map(|written| written.parse()).transpose() {
        Ok(source) => recording.or(source),
        Err(error) => {
            let error: CaptureError = error;
            window.error = Some(error.to_string());
            None
        }
    };
    source.map(|source| SetupChange::Source(Some(source)))
}

/// Returns the sources of a setup that are serial ports.
fn ports_in_use(loaded: &LoadedSetup) -> impl Iterator<Item = &SourceUri> {
    let uris = loaded.setup.source_uris();
    uris.filter(|uri| uri.serial_port().is_some())
}

/// Starts to listen to the serial ports that the session does not read.
fn search_beside(loaded: &LoadedSetup) -> Search {
    let is_free = |port: &String| {
        let mut used = ports_in_use(loaded).filter_map(SourceUri::serial_port);
        !used.any(|used| used == port)
    };
    let ports = port_names().into_iter().filter(is_free).collect();
    Search::new(ports, cameras())
}

/// Returns what a port may be: its recognized sources, or else the default of a serial port.
fn sources_of(port: &Port) -> Vec<SourceUri> {
    match &port.heard {
        Some(Ok(Recognition::Sources(sources))) => sources.clone(),
        Some(Ok(Recognition::Unknown(_) | Recognition::Silent)) => {
            let source = format!("serial:{}", port.name).parse();
            source.into_iter().collect()
        }
        Some(Err(_)) | None => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::{Language, set_language};

    #[test]
    fn the_end_of_the_search_moves_nothing_below_a_port() {
        let height = |heard: Option<Recognition>| {
            let port = Port {
                name: "/dev/ttyS0".to_owned(),
                heard: heard.map(Ok),
            };
            let context = egui::Context::default();
            let mut drawn = 0.0;
            let output = context.run_ui(egui::RawInput::default(), |ui| {
                let rows = ui.vertical(|inner| show_port(inner, &port));
                drawn = rows.response.rect.height();
            });
            output.drop_without_applying_deltas();
            drawn
        };
        let before: f32 = height(None);
        let source = "serial:/dev/ttyS0".parse().expect("a source");
        for heard in [Recognition::Silent, Recognition::Sources(vec![source])] {
            let moved = height(Some(heard)) - before;
            assert!(moved.abs() < 1.0, "{moved}");
        }
    }

    #[test]
    fn a_port_that_is_silent_is_searched_again_in_this_window() {
        let port = Port {
            name: "/dev/ttyS0".to_owned(),
            heard: Some(Ok(Recognition::Silent)),
        };
        for (language, again) in [
            (Language::English, "search again"),
            (Language::Spanish, "busque otra vez"),
        ] {
            set_language(language);
            let words = words_of(&port, SILENT);
            assert!(words.contains(again), "{words}");
        }
    }
}
