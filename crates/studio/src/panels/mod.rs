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

/// Time between two looks at a layout that the editor could not open, in seconds.
const REOPEN_PERIOD_S: f64 = 0.5;

/// Makes a file of another format of an SVG document, or returns the reason why it cannot.
pub type ConvertSvg = fn(&str) -> Result<Vec<u8>, String>;

/// The formats into which the program converts SVG drawings.
#[derive(Clone, Copy)]
pub struct PictureFormats {
    /// Makes a picture of pixels.
    pub png: ConvertSvg,
    /// Makes a page to print.
    pub pdf: ConvertSvg,
}

/// The state of the session, and commands to it, for a panel.
pub struct PanelContext<'a> {
    /// The state to show: of the session, of a recording, of a person of the lab, or of the mouse as a fingertip.
    pub model: &'a StudioModel,
    /// The state of the session, or of the recording in place of it.
    pub session: &'a StudioModel,
    /// A recording is shown in place of a session, which takes commands.
    pub is_replay: bool,
    /// The session in another program that is shown, if any.
    pub attached: Option<&'a Attached>,
    /// The source is a simulated hand that can be changed.
    pub has_hand: bool,
    /// Another setup can be opened in a session of its own.
    pub can_open: bool,
    /// Makes pictures of other formats than SVG, if the program can.
    pub pictures: Option<PictureFormats>,
    /// The changes of sensors.
    pub sensors: &'a mut SensorControl,
    /// Tries edited layouts; `None` while a recording or the session of another program is shown.
    pub trial: Option<&'a LayoutTrial>,
    /// Commands that are sent after the frame.
    pub sent: &'a mut Vec<Command>,
    /// The recording that is shown, if any.
    pub player: Option<&'a Player>,
    /// The person of the lab whose recording is shown, if any.
    pub watched: Option<&'a WatchedPerson>,
    /// The fingertip that follows the mouse, if any.
    pub fingertip: Option<&'a mut Aim>,
    /// The change of who is watched, which follows the frame.
    pub watch: &'a mut Option<WatchChange>,
    /// Moves within the recording, which follow the frame.
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
    /// Folder with unsaved work of the editor. `None`: it is not kept.
    unsaved_work: Option<PathBuf>,
    camera: Camera,
    /// The viewpoint that was chosen since the last frame.
    next_viewpoint: Option<Viewpoint>,
    /// The camera has been pointed at the boards.
    is_camera_placed: bool,
    scene: SceneOptions,
    /// The mouse is a fingertip.
    pub is_fingertip: bool,
    scope: ScopeState,
    recording: RecordingState,
    lab: LabState,
    /// The settings that are remembered until the next start.
    settings: Settings,
    /// The words in the field for the file of a simulated person.
    person_file: String,
    /// The person of the settings, in whose place the session has another one, until someone else is chosen.
    pub replaced_person: Option<String>,
    /// The words in the field for the file of a layout.
    layout_file: String,
    /// The window of the devices.
    devices: DevicesWindow,
    /// The change of the setup that was chosen, which the next session has.
    pub next_setup: Option<SetupChange>,
    /// Theme and contrast that the window has.
    applied_look: Option<(Theme, bool)>,
    tour: Tour,
    /// The step of the tour that is shown; `None` while the tour is closed.
    shown_step: Option<tour::Shown>,
    /// The list of keys is shown.
    shows_keys: bool,
    /// The window with the link for a headset.
    headset: Option<HeadsetWindow>,
    /// Title of the window in the last frame.
    title: String,
    /// The panels in the order of F6, and the index of the last one that it reached.
    panel_ids: Vec<egui::Id>,
    focused_panel: Option<usize>,
    /// Reason why something was not done: a command was not sent, or the settings were not kept.
    pub message: Option<String>,
    /// The message as the status line shows it.
    shown_message: Option<status::ShownMessage>,
}

impl PanelState {
    /// Takes the panels to where they were at the last start, and opens the tour at the first. From now on unsaved work is kept.
    pub fn restore(&mut self, settings: Settings) {
        self.unsaved_work = files::state_folder().map(|folder| folder.join("editor"));
        self.settings = settings;
        if !self.settings.has_seen_tour {
            self.settings.has_seen_tour = true;
            self.tour.open();
        }
    }

    /// Returns what is to be remembered until the next start.
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

    /// Returns `true` if the layout of the editor is shown: there, or in the lab.
    fn shows_layout(&self) -> bool {
        matches!(self.workspace, Workspace::Layout | Workspace::Lab)
    }

    /// Returns `true` if a window over the panels is open, which Escape closes.
    fn has_window(&self) -> bool {
        let has_headset = self.headset.as_ref().is_some_and(|window| window.is_open);
        self.shows_keys || self.devices.is_open() || self.tour.index().is_some() || has_headset
    }

    /// Returns `true` if the editor has a layout.
    fn has_layout(&self) -> bool {
        matches!(self.editor, Some(Ok(_)))
    }

    /// Opens a layout in the editor, for the hands of a setup, and shows the editor.
    pub fn edit(&mut self, name: &str, fit: Fit) -> Result<(), DocumentError> {
        let opened = EditorPanel::open(name, fit, self.unsaved_work.as_deref())?;
        self.editor = Some(Ok(match &self.editor {
            Some(Ok(before)) => opened.with_choices_of(before),
            _ => opened,
        }));
        self.workspace = Workspace::Layout;
        Ok(())
    }

    /// Returns `true` if threads of the lab are at work, whose progress is shown.
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

    /// Returns the change of the setup that was chosen, if any. One that may bring another glove is refused while the session has
    /// changes of the glove that are not saved, and any one while the editor has changes that are neither saved nor kept: they would end
    /// with the session.
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

    /// Says why a change of the setup does not apply.
    pub fn refuse(&mut self, reason: String) {
        self.devices.error = Some(reason.clone());
        self.message = Some(reason);
    }

    /// Keeps the window of the devices of the session before, what it shows, and the options of the 3D view and the scope.
    pub fn keep_choices(&mut self, before: &mut Self) {
        let error = self.devices.error.take();
        self.devices = mem::take(&mut before.devices).after_change(error);
        self.scene = before.scene;
        self.scope = mem::take(&mut before.scope).without_held();
    }

    /// Lets the window close without a question, as after a signal. Unsaved work stays in the recovery file.
    pub fn permit_close(&mut self) {
        self.close_question.permit_close();
        if let Some(Ok(editor)) = &mut self.editor {
            editor.permit_close();
        }
    }
}

/// Returns `true` if a number field was changed. A field that is left without a change rounds its number to what it shows, which must
/// not reach a file.
fn is_other_number(old: f64, new: f64, decimals: usize) -> bool {
    let shown = |number: f64| format!("{number:.decimals$}");
    old != new && shown(old) != shown(new)
}

/// Parses a number that is typed into a field, with a point or a comma before the decimals. `None` unless it is finite, and for a
/// comma before three digits, which may separate thousands.
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

/// Opens a layout in the editor once, or tries again while its file cannot be read, and prepares the editor while it is shown.
/// The layout is the layout of the session, or a file that is dropped while there is none.
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
            // In the editor, the next look at the layout of the session replaces it.
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
