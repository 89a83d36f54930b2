//! The panels of the window, one file each, and the part of the window that each fills.

mod actions;
mod attached;
mod calibration;
mod close;
mod devices;
mod editor;
mod file_field;
mod first_start;
mod hand;
mod headset;
mod help;
mod lab;
mod layouts;
mod look;
mod recording;
mod scope;
mod sensors;
mod space;
mod status;
mod table;
mod toolbar;
mod tour;
mod zoom;

use std::mem;
use std::path::PathBuf;

use eframe::egui;

use self::close::CloseQuestion;
use self::devices::DevicesWindow;
use self::editor::EditorPanel;
use self::lab::LabState;
use self::recording::RecordingState;
use self::scope::ScopeState;
use super::attached::Attached;
use super::camera::{Camera, Viewpoint};
use super::fingertip::Aim;
use super::headset::{HeadsetLink, HeadsetWindow};
use super::lab::WatchedPerson;
use super::model::StudioModel;
use super::playback::{Move, Player};
use super::scene::SceneOptions;
use super::sensor_control::SensorControl;
use super::settings::{CameraPlace, Settings, Theme};
use super::setup_change::SetupChange;
use super::texts::text;
use super::tour::Tour;
use ademan_core::command::Command;
use ademan_core::document::DocumentError;
use ademan_core::layout::Fit;
use ademan_runtime::files;
use ademan_runtime::session::LayoutTrial;

pub use self::first_start::show as show_first_start;
pub use self::lab::WatchChange;
pub use self::space::{color32, paint};

/// Time between two attempts to open a layout that the editor could not open, in seconds.
const REOPEN_PERIOD_S: f64 = 0.5;

/// Converts an SVG document into a file of another format, or returns the reason why it cannot.
pub type ConvertSvg = fn(&str) -> Result<Vec<u8>, String>;

/// The formats into which the program converts SVG drawings.
#[derive(Clone, Copy)]
pub struct PictureFormats {
    /// Converts to a bitmap.
    pub png: ConvertSvg,
    /// Converts to a page for printing.
    pub pdf: ConvertSvg,
}

/// The data that a panel shows, and the requests that it makes.
pub struct PanelContext<'a> {
    /// The state to show: the session, a recording, a person of the lab, or the mouse as a fingertip.
    pub model: &'a StudioModel,
    /// The state of the session, or of the recording that replaces it.
    pub session: &'a StudioModel,
    /// `true` if a recording replaces the session, so that commands have no effect.
    pub is_replay: bool,
    /// The session of another program, if the window shows one.
    pub attached: Option<&'a Attached>,
    /// `true` if the source is a simulated hand, whose person and speed can be changed.
    pub has_hand: bool,
    /// `true` if another setup can be opened in a new session.
    pub can_open: bool,
    /// Converters from SVG to other formats, if the program has them.
    pub pictures: Option<PictureFormats>,
    /// The changes of sensors.
    pub sensors: &'a mut SensorControl,
    /// Tries edited layouts; `None` while a recording or the session of another program is shown.
    pub trial: Option<&'a LayoutTrial>,
    /// Commands to send after the frame.
    pub sent: &'a mut Vec<Command>,
    /// The recording that is shown, if any.
    pub player: Option<&'a Player>,
    /// The person of the lab whose recording is shown, if any.
    pub watched: Option<&'a WatchedPerson>,
    /// The fingertip that follows the mouse, if any.
    pub fingertip: Option<&'a mut Aim>,
    /// The change of the watched person of the lab, to be made after the frame.
    pub watch: &'a mut Option<WatchChange>,
    /// Moves within the recording to make after the frame.
    pub moves: &'a mut Vec<Move>,
}

/// The content of the middle of the window, chosen by tabs in the toolbar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Workspace {
    /// The 3D view, with the panels beside it.
    #[default]
    Hand,
    /// The layout editor.
    Layout,
    /// Simulated people use the layout of the editor.
    Lab,
    /// The guided calibration.
    Calibration,
}

impl Workspace {
    const ALL: [Self; 4] = [Self::Hand, Self::Layout, Self::Lab, Self::Calibration];

    fn name(self) -> &'static str {
        match self {
            Self::Hand => text("workspace-hand"),
            Self::Calibration => text("workspace-calibration"),
            Self::Layout => text("workspace-layout"),
            Self::Lab => text("workspace-lab"),
        }
    }
}

/// The state of the panels between two frames.
#[derive(Default)]
pub struct PanelState {
    workspace: Workspace,
    /// The layout editor, once its tab was opened, or the reason why it has no layout.
    editor: Option<Result<EditorPanel, String>>,
    /// Time of the next look at a layout that the editor could not open, in seconds.
    next_open: f64,
    close_question: CloseQuestion,
    /// Folder for unsaved work of the editor; `None` if such work is not kept.
    unsaved_work: Option<PathBuf>,
    camera: Camera,
    /// A chosen viewpoint that the 3D view has not applied yet.
    next_viewpoint: Option<Viewpoint>,
    /// `true` once the camera has been pointed at the boards.
    is_camera_placed: bool,
    scene: SceneOptions,
    /// `true` if the mouse is a fingertip.
    pub is_fingertip: bool,
    scope: ScopeState,
    recording: RecordingState,
    lab: LabState,
    /// The settings to keep for the next start.
    settings: Settings,
    /// The words in the field for the file of a simulated person.
    person_file: String,
    /// The person of the settings, while the session uses another person instead, until the user chooses one.
    pub replaced_person: Option<String>,
    /// The words in the field for the file of a layout.
    layout_file: String,
    /// The window of the devices.
    devices: DevicesWindow,
    /// The chosen change of the setup, which starts another session.
    pub next_setup: Option<SetupChange>,
    /// The theme and the contrast that were last applied to the window.
    applied_look: Option<(Theme, bool)>,
    tour: Tour,
    /// The step of the tour that is shown; `None` while the tour is closed.
    shown_step: Option<tour::Shown>,
    /// `true` while the list of keys is shown.
    shows_keys: bool,
    /// The window with the link for a headset.
    headset: Option<HeadsetWindow>,
    /// Title of the window in the last frame.
    title: String,
    /// The panels in the order in which F6 visits them, and the index of the last panel visited.
    panel_ids: Vec<egui::Id>,
    focused_panel: Option<usize>,
    /// Reason why the last action failed, such as a command that was not sent or settings that were not kept.
    pub message: Option<String>,
    /// The message as the status line shows it.
    shown_message: Option<status::ShownMessage>,
}

impl PanelState {
    /// Restores the panels from the settings of the last start; at the first start, opens the tour. Unsaved work is kept from now on.
    pub fn restore(&mut self, settings: Settings) {
        self.unsaved_work = files::state_folder().map(|folder| folder.join("editor"));
        self.settings = settings;
        if !self.settings.has_seen_tour {
            self.settings.has_seen_tour = true;
            self.tour.open();
        }
    }

    /// Returns the settings to keep for the next start.
    pub fn settings(&mut self) -> &mut Settings {
        &mut self.settings
    }

    fn remember(&mut self, ui: &egui::Ui, layout: &str) {
        self.settings.scale = ui.ctx().zoom_factor();
        if self.is_camera_placed {
            self.settings.camera = Some(CameraPlace::new(&self.camera, layout));
        }
    }

    /// Returns `true` if a panel that can be hidden is shown beside the 3D view.
    fn shows(&self, panel: &str) -> bool {
        !self.settings.hidden_panels.iter().any(|it| it == panel)
    }

    /// Shows or hides a panel.
    fn toggle(&mut self, panel: &str) {
        let hidden = &mut self.settings.hidden_panels;
        match hidden.iter().position(|it| it == panel) {
            Some(index) => _ = hidden.remove(index),
            None => hidden.push(panel.to_owned()),
        }
    }

    /// Returns `true` if the editor or the lab is shown, which both use the layout of the editor.
    fn shows_layout(&self) -> bool {
        matches!(self.workspace, Workspace::Layout | Workspace::Lab)
    }

    /// Returns `true` if a window that Escape closes is open over the panels.
    fn has_window(&self) -> bool {
        let has_headset = self.headset.as_ref().is_some_and(|window| window.is_open);
        self.shows_keys || self.devices.is_open() || self.tour.index().is_some() || has_headset
    }

    /// Returns `true` if the editor has a layout.
    fn has_layout(&self) -> bool {
        matches!(self.editor, Some(Ok(_)))
    }

    /// Opens a layout in the editor, fitted to the hands of a setup, and shows the editor.
    pub fn edit(&mut self, name: &str, fit: Fit) -> Result<(), DocumentError> {
        let opened = EditorPanel::open(name, fit, self.unsaved_work.as_deref())?;
        self.editor = Some(Ok(match &self.editor {
            Some(Ok(before)) => opened.with_choices_of(before),
            _ => opened,
        }));
        self.workspace = Workspace::Layout;
        Ok(())
    }

    /// Returns `true` if threads of the lab are running, so that their progress has to be drawn.
    pub fn is_busy(&self) -> bool {
        self.lab.is_busy()
    }

    /// Shows a link for a headset.
    pub fn show_headset_link(&mut self, link: Option<HeadsetLink>) {
        self.headset = link.map(HeadsetWindow::new);
    }

    /// Shows the guided calibration.
    pub fn show_calibration(&mut self) {
        self.workspace = Workspace::Calibration;
    }

    /// Takes the chosen change of the setup, if any.
    ///
    /// Refuses every change while the editor has changes that are neither saved nor kept, and a change that may replace the glove while
    /// the glove has unsaved changes: they would be lost with the session.
    pub fn take_setup(&mut self, sensors: &SensorControl) -> Option<SetupChange> {
        let change = self.next_setup.take()?;
        if let Some(Ok(editor)) = &self.editor
            && editor.would_lose_work()
        {
            self.refuse(text("editor-open-unkept").to_owned());
            return None;
        }
        if sensors.is_unsaved() && change.may_change_glove(sensors.setup()) {
            self.refuse(text("devices-unsaved").to_owned());
            return None;
        }
        Some(change)
    }

    /// Shows the reason why a change of the setup is refused.
    pub fn refuse(&mut self, reason: String) {
        self.devices.error = Some(reason.clone());
        self.message = Some(reason);
    }

    /// Copies from the previous session the window of the devices with its content, and the options of the 3D view and the scope.
    pub fn keep_choices(&mut self, before: &mut Self) {
        let error = self.devices.error.take();
        self.devices = mem::take(&mut before.devices).after_change(error);
        self.scene = before.scene;
        self.scope = mem::take(&mut before.scope).without_held();
    }

    /// Allows the window to close without a question, as after a signal. Unsaved work stays in the recovery file.
    pub fn permit_close(&mut self) {
        self.close_question.permit_close();
        if let Some(Ok(editor)) = &mut self.editor {
            editor.permit_close();
        }
    }
}

/// Returns `true` if the person has changed a number field. A field that loses the focus unchanged rounds its number to the decimals that
/// it shows; the rounded number must not reach a file.
fn is_other_number(old: f64, new: f64, decimals: usize) -> bool {
    let shown = |number: f64| format!("{number:.decimals$}");
    old != new && shown(old) != shown(new)
}

/// Parses a number that is typed into a field, with a decimal point or a decimal comma. Returns `None` for a number that is not finite, and
/// for a comma before three digits, which may separate thousands.
fn typed_number(words: &str) -> Option<f64> {
    let visible = words.chars().filter(|letter| !letter.is_whitespace());
    let plain: String = visible.collect::<String>().replace('−', "-");
    let written = match plain.split_once(',') {
        Some((whole, decimals)) if decimals.len() != 3 => format!("{whole}.{decimals}"),
        _ => plain,
    };
    written.parse().ok().filter(|it: &f64| it.is_finite())
}

/// Draws all panels.
pub fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    if let Some(Ok(editor)) = &mut state.editor {
        let is_shown = state.workspace == Workspace::Layout;
        editor::capture_key(ui, editor, is_shown);
        if editor::guard_close(ui, editor) {
            state.workspace = Workspace::Layout;
        }
        editor::keep_unfinished(ui, editor);
        editor::advance_trial(ui, editor, context);
    }
    close::guard(ui, state, context);
    look::apply(ui.ctx(), state);
    lab::advance(state, context);
    actions::handle_keys(ui, state, context);
    let dropped = editor::dropped_file(ui);
    if dropped.is_some() {
        state.workspace = Workspace::Layout;
    }
    if state.shows_layout() {
        open_layout(ui, state, context, dropped);
    }
    table::show(ui, state, context);
    help::show_keys(ui, state);
    tour::show(ui, state);
    headset::show(ui, state, context);
    if context.can_open {
        devices::show(ui, state, context);
    }
    if let Some(Ok(panel)) = &state.editor
        && let Some(path) = panel.editor.path()
    {
        state.settings.recent_layouts.push(path);
    }
    show_title(ui, state);
    state.remember(ui, &context.session.view.layout.name);
}

/// Shows the name of the edited layout in the title of the window.
fn show_title(ui: &egui::Ui, state: &mut PanelState) {
    let title = match &state.editor {
        Some(Ok(editor)) => editor.title(),
        Some(Err(_)) | None => text("window-title").to_owned(),
    };
    if title != state.title {
        let command = egui::ViewportCommand::Title(title.clone());
        ui.ctx().send_viewport_cmd(command);
        state.title = title;
    }
}

/// Opens the layout of the session in the editor, or a file that was dropped on the window while there is none. Tries again while the
/// file cannot be read. Prepares the editor for the frame if it is shown.
fn open_layout(
    ui: &mut egui::Ui,
    state: &mut PanelState,
    context: &mut PanelContext,
    dropped: Option<String>,
) {
    let used = &context.session.view.layout;
    let now = ui.input(|input| input.time);
    if !state.has_layout() && (now >= state.next_open || dropped.is_some()) {
        state.next_open = now + REOPEN_PERIOD_S;
        let work = state.unsaved_work.as_deref();
        let open = |file: &str| EditorPanel::open(file, used.fit, work);
        let opened = if context.sensors.setup().has_recorded_layouts() {
            Ok(EditorPanel::of_recording(used, work))
        } else {
            open(&used.file)
        };
        let opened = opened.or_else(|error| match &dropped {
            Some(file) => open(file),
            None => Err(error),
        });
        let opened = opened.map_err(|it| it.to_string());
        if let (Some(_), Err(reason)) = (&dropped, &opened) {
            // The next attempt to open the layout of the session replaces the error in the editor.
            state.message = Some(reason.clone());
        }
        state.editor = Some(opened);
    }
    let is_covered = state.has_window();
    if let Some(Ok(editor)) = &mut state.editor
        && state.workspace == Workspace::Layout
    {
        editor.is_covered = is_covered;
        editor::prepare(ui, editor, &mut state.settings.recent_layouts, context);
        if let Some(action) = editor.take_action() {
            action.perform(ui.ctx(), state, context);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::{Edit, NewPart};
    use crate::sensor_control::tests::session;

    #[test]
    fn another_glove_waits_until_this_one_is_saved() {
        let session = session();
        let mut sensors = SensorControl::new(session.sensors());
        let mut panels = PanelState::default();
        let change = SetupChange::Glove(None);
        panels.next_setup = Some(change.clone());
        sensors.edit(|editor| editor.set_zero_count(4, 50.0));
        assert_eq!(panels.take_setup(&sensors), None);
        let message = panels.message.take().expect("a reason");
        assert!(message.contains("not saved"), "{message}");
        assert_eq!(panels.next_setup, None, "it is chosen again");
        sensors.edit(|editor| editor.undo());
        panels.next_setup = Some(change.clone());
        assert_eq!(panels.take_setup(&sensors), Some(change));
    }

    #[test]
    fn a_layout_whose_changes_are_not_kept_stays_with_its_session() {
        let session = session();
        let sensors = SensorControl::new(session.sensors());
        let mut panels = PanelState::default();
        panels.edit("numpad", Fit::default()).expect("a layout");
        let Some(Ok(opened)) = &mut panels.editor else {
            panic!("no editor");
        };
        let add = Edit::Add(NewPart::Layer);
        opened.editor.apply(&add).expect("a layer");
        let change = SetupChange::Output("none".to_owned());
        panels.next_setup = Some(change.clone());
        assert_eq!(panels.take_setup(&sensors), None);
        assert!(panels.message.take().is_some(), "a reason");
        let Some(Ok(edited)) = &mut panels.editor else {
            panic!("no editor");
        };
        assert!(edited.editor.undo());
        panels.next_setup = Some(change.clone());
        assert_eq!(panels.take_setup(&sensors), Some(change));
    }

    #[test]
    fn a_number_that_is_rounded_to_what_is_shown_has_not_changed() {
        let degrees = 3.0_f64.to_degrees();
        assert!(!is_other_number(degrees, 171.9, 1));
        assert!(!is_other_number(degrees, degrees, 1));
        assert!(is_other_number(degrees, 172.0, 1));
        assert!(is_other_number(4.0, 4.001, 3));
    }

    #[test]
    fn a_number_is_typed_with_a_point_or_a_comma_and_is_finite() {
        for (words, expected) in [
            ("1.5", Some(1.5)),
            ("1,5", Some(1.5)),
            (" −0,25 ", Some(-0.25)),
            ("1 000", Some(1000.0)),
            ("1,000", None),
            ("1.000,5", None),
            ("", None),
            ("nan", None),
            ("inf", None),
            ("1e999", None),
        ] {
            assert_eq!(typed_number(words), expected, "{words}");
        }
    }
}
