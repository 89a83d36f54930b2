//! The window of the devices: source, glove, person, arm, outputs and profile of the session, each with a new choice.

mod choice;
mod source;

use std::env;
use std::path::PathBuf;

use eframe::egui::{self, Align2, Vec2};

use self::choice::Choice;
use super::{PanelContext, PanelState, file_field, help};
use crate::disk_search::DiskSearch;
use crate::first_start::Search;
use crate::recent::RecentFiles;
use crate::recordings;
use crate::setup_change::SetupChange;
use crate::texts::text;
use ademan_core::command::{Command, ProfileName};
use ademan_core::document::{FileKind, shipped_gloves, shipped_persons};
use ademan_core::message::escape;
use ademan_core::pipeline::MAIN_PROFILE;
use ademan_runtime::capture::SourceUri;
use ademan_runtime::files::own_names;
use ademan_runtime::output::{self, BACKENDS};
use ademan_runtime::setup::{ArmSetup, LoadedSetup};

/// Width of the content in a window that has room for it, in points.
const WIDTH: f32 = 660.0;

/// Width of the frame at both sides of the content, in points.
const SIDES: f32 = 20.0;

/// Height of the main window above and below the content, in points.
const MARGIN: f32 = 210.0;

/// Place of the window when it opens, from the upper left corner in points: below a toolbar of two rows.
const OFFSET: Vec2 = Vec2::new(12.0, 80.0);

/// The names of files in the configuration folder.
#[derive(Default)]
struct OwnNames {
    gloves: Vec<String>,
    persons: Vec<String>,
}

impl OwnNames {
    /// Reads the configuration folder, which may take long.
    fn read() -> Self {
        Self {
            gloves: own_names(FileKind::Glove),
            persons: own_names(FileKind::Person),
        }
    }
}

/// The window, and the words in its fields.
#[derive(Default)]
pub(super) struct DevicesWindow {
    is_open: bool,
    /// The field for the source gets the focus with the next frame.
    is_focus_due: bool,
    /// The serial ports, once the window was open. Sources of the session are not listened to.
    search: Option<Search>,
    /// The recordings that are offered, once the window was open.
    recordings: Option<DiskSearch<Vec<PathBuf>>>,
    /// The gloves and persons in the configuration folder, once the window was open.
    own: Option<DiskSearch<OwnNames>>,
    source: String,
    recording: String,
    glove: String,
    person: String,
    arm: String,
    output: String,
    setup: String,
    /// Reason why the last choice does not apply.
    pub error: Option<String>,
}

impl DevicesWindow {
    /// Opens the window, or closes it.
    pub fn toggle(&mut self) {
        self.is_open = !self.is_open;
        self.is_focus_due = self.is_open;
    }

    /// Prepares the window for the session after a change of the setup, and keeps the error of the change, if any. Other ports may be free.
    pub fn after_change(self, error: Option<String>) -> Self {
        Self {
            search: None,
            recordings: None,
            own: None,
            error,
            ..self
        }
    }

    /// Returns `true` if it is open.
    pub fn is_open(&self) -> bool {
        self.is_open
    }
}

/// Draws the window while it is open. A choice becomes [`PanelState::next_setup`].
pub(super) fn show(ui: &egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    let window = &mut state.devices;
    if !window.is_open {
        (window.search, window.recordings, window.own) = (None, None, None);
        return;
    }
    if help::is_escape_pressed(ui) {
        window.is_open = false;
    }
    let recordings = window.recordings.get_or_insert_with(|| {
        let used = &mut state.settings.recent_recordings;
        let source = context.sensors.setup().setup.source.as_ref();
        search_recordings(source, used, ui.ctx().clone())
    });
    recordings.update();
    let own = window.own.get_or_insert_with(|| {
        let own_context = ui.ctx().clone();
        let notify = move || own_context.request_repaint();
        DiskSearch::start("names", OwnNames::read, notify)
    });
    own.update();
    let mut is_open = window.is_open;
    let mut chosen = None;
    egui::Window::new(text("menu-devices"))
        .id(egui::Id::unique("devices"))
        .open(&mut is_open)
        .pivot(Align2::LEFT_TOP)
        .default_pos((ui.ctx().content_rect().min + OFFSET).round())
        .default_height(ui.ctx().content_rect().height() - OFFSET.y)
        .collapsible(false)
        .resizable(false)
        .show(ui.ctx(), |ui| {
            ui.set_width(width_in(ui.ctx().content_rect().width()));
            ui.label(text("devices-words"));
            if let Some(error) = &window.error {
                ui.add(egui::Label::new(format!("× {}", escape(error))).wrap());
            }
            let height = ui.ctx().content_rect().height() - MARGIN;
            let area = egui::ScrollArea::vertical().max_height(height);
            chosen = area
                .auto_shrink([false, true])
                .show(ui, |ui| show_content(ui, window, context))
                .inner;
        });
    window.is_open &= is_open;
    if chosen.is_some() {
        window.error = None;
        state.next_setup = chosen;
    }
}

/// Returns the width of the content in a main window of this width, in points.
fn width_in(main_window: f32) -> f32 {
    WIDTH.min(main_window - SIDES)
}

/// Starts to search for the recordings that are offered beside a source, which is remembered if it is one.
fn search_recordings(
    source: Option<&SourceUri>,
    used: &mut RecentFiles,
    context: egui::Context,
) -> DiskSearch<Vec<PathBuf>> {
    if let Some(SourceUri::Recording { path }) = source {
        used.push(path);
    }
    let folder = env::current_dir().unwrap_or_default();
    recordings::search(folder, used.clone(), move || context.request_repaint())
}

fn show_content(
    ui: &mut egui::Ui,
    window: &mut DevicesWindow,
    context: &mut PanelContext,
) -> Option<SetupChange> {
    let sent = &mut *context.sent;
    let loaded = context.sensors.setup();
    let chosen = source::show(ui, window, loaded, sent);
    ui.separator();
    show_profiles(ui, loaded, &context.session.view.state.profile, sent);
    let grid = egui::Grid::new("devices")
        .num_columns(2)
        .spacing([12.0, 8.0]);
    grid.show(ui, |ui| show_rows(ui, window, loaded))
        .inner
        .or(chosen)
}

/// Shows a row for each part of the setup.
fn show_rows(
    ui: &mut egui::Ui,
    window: &mut DevicesWindow,
    loaded: &LoadedSetup,
) -> Option<SetupChange> {
    let mut chosen = source::show_fields(ui, window);
    let own = window.own.as_ref().map(DiskSearch::found);
    let gloves = own.map_or(&[][..], |it| it.gloves.as_slice());
    let persons = own.map_or(&[][..], |it| it.persons.as_slice());
    let glove = Choice {
        name: "devices-glove",
        present: loaded.setup.glove.as_deref(),
        default: "devices-glove-own",
        names: with_own(shipped_gloves(), gloves),
        file: "devices-glove-file",
    };
    chosen = glove
        .show(ui, &mut window.glove)
        .map(SetupChange::Glove)
        .or(chosen);
    let person = Choice {
        name: "devices-person",
        present: loaded.setup.person.as_deref(),
        default: "devices-person-none",
        names: with_own(shipped_persons(), persons),
        file: "devices-person-file",
    };
    chosen = person
        .show(ui, &mut window.person)
        .map(SetupChange::Person)
        .or(chosen);
    let arm = Choice {
        name: "devices-arm",
        present: match &loaded.setup.arm {
            ArmSetup::Model(name) => Some(name),
            ArmSetup::Person | ArmSetup::Measured { .. } => None,
        },
        default: match loaded.setup.arm {
            ArmSetup::Measured { .. } => "devices-arm-measured",
            _ => "devices-arm-person",
        },
        names: Vec::new(),
        file: "devices-arm-file",
    };
    chosen = arm
        .show(ui, &mut window.arm)
        .map(SetupChange::Arm)
        .or(chosen);
    chosen = show_outputs(ui, window, &loaded.setup.output).or(chosen);
    let label = ui.strong(text("devices-setup"));
    let words = ("devices-setup-hint", "devices-use");
    let file = ui.horizontal(|ui| file_field::show_beside(ui, &label, words, &mut window.setup));
    ui.end_row();
    file.inner.map(SetupChange::File).or(chosen)
}

/// Returns the names of shipped files, and of files in the configuration folder, each once: a copy of a shipped file is used by the
/// same name.
fn with_own(shipped: impl Iterator<Item = &'static str>, own: &[String]) -> Vec<&str> {
    let mut names: Vec<&str> = shipped.collect();
    for name in own {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// Shows the outputs of this build. An output with an argument is written into the field.
fn show_outputs(
    ui: &mut egui::Ui,
    window: &mut DevicesWindow,
    present: &str,
) -> Option<SetupChange> {
    let mut chosen = None;
    let label = ui.strong(text("devices-output"));
    ui.horizontal(|ui| {
        for backend in BACKENDS.iter().filter(|it| !it.is_argument_required) {
            let radio = ui.radio(present == backend.name, backend.name);
            if radio.on_hover_text(backend.summary).clicked() {
                chosen = Some(backend.name.to_owned());
            }
        }
    });
    ui.end_row();
    let is_listed = BACKENDS.iter().any(|backend| backend.name == present);
    ui.add(egui::Label::new(if is_listed { "" } else { present }).truncate());
    let words = ("devices-output-hint", "devices-use");
    let field = ui.horizontal(|ui| file_field::show_beside(ui, &label, words, &mut window.output));
    ui.end_row();
    if output::has_effect(present) {
        ui.label("");
        ui.label(text("devices-output-paused"));
        ui.end_row();
    }
    chosen.or(field.inner).map(SetupChange::Output)
}

/// Shows the layouts of the setup by their names, if there are several.
fn show_profiles(ui: &mut egui::Ui, setup: &LoadedSetup, active: &str, sent: &mut Vec<Command>) {
    let profiles = &setup.setup.profiles;
    if profiles.is_empty() {
        return;
    }
    ui.strong(text("devices-profile"));
    let names = profiles.iter().map(|profile| profile.name.as_str());
    ui.horizontal_wrapped(|ui| {
        for name in std::iter::once(MAIN_PROFILE).chain(names) {
            if ui.radio(name == active, escape(name)).clicked()
                && let Ok(name) = ProfileName::from(name)
            {
                sent.push(Command::Profile { name });
            }
        }
    });
    ui.separator();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_fits_into_a_narrow_main_window() {
        let id = egui::Id::unique("devices in a narrow window");
        for main_window in [640.0, 1280.0] {
            let context = egui::Context::default();
            let size = egui::vec2(main_window, 400.0);
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
            let input = || egui::RawInput {
                screen_rect: Some(screen),
                ..egui::RawInput::default()
            };
            for _ in 0..3 {
                let output = context.run_ui(input(), |ui| {
                    egui::Window::new("devices")
                        .id(id)
                        .show(ui.ctx(), |content| {
                            content.set_width(width_in(main_window));
                        });
                });
                output.drop_without_applying_deltas();
            }
            let drawn = context.memory(|memory| memory.area_rect(id));
            let drawn = drawn.expect("the window");
            assert!(screen.x_range().contains(drawn.min.x), "{drawn}");
            assert!(screen.x_range().contains(drawn.max.x), "{drawn}");
        }
    }

    #[test]
    fn a_copy_of_a_shipped_glove_is_listed_once() {
        let own = ["mine", "unam-hc11"].map(str::to_owned);
        let shipped: Vec<&str> = shipped_gloves().collect();
        assert!(shipped.contains(&"unam-hc11"), "{shipped:?}");
        let names = with_own(shipped_gloves(), &own);
        let expected = shipped.into_iter().chain(["mine"]);
        assert_eq!(names, expected.collect::<Vec<_>>());
    }
}
