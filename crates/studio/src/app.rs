//! The window: receives what the session shows, and lays out the panels.

use std::path::PathBuf;
use std::time::Duration;

use crossbeam_channel::{Receiver, TryRecvError};
use eframe::egui;

use super::error::StudioError;
use super::fingertip::Fingertip;
use super::first_start::{Answers, FirstStart};
use super::graphics;
use super::headset::HeadsetLink;
use super::lab::WatchedPerson;
use super::model::StudioModel;
use super::pace::Pace;
use super::panels::{self, PanelContext, PanelState, WatchChange};
use super::playback::Player;
use super::sensor_control::SensorControl;
use super::settings::{Settings, WindowPlace};
use super::settings_file::SettingsFile;
use super::sound::Sound;
use super::texts::text;
use ademan_core::command::Command;
use ademan_core::document::{Document, DocumentError};
use ademan_core::snapshot::Snapshot;
use ademan_runtime::priority;
use ademan_runtime::session::view::Viewer;
use ademan_runtime::session::{CommandSender, LayoutTrial, SessionHandle};

/// Size of the window at the first start, in points.
const WINDOW_SIZE: [f32; 2] = [1280.0, 800.0];

/// Time between two pictures of the first start, in which only what was found changes.
const FIRST_PERIOD: Duration = Duration::from_millis(100);

/// Smallest size of the window, in points.
const MIN_WINDOW_SIZE: [f32; 2] = [640.0, 400.0];

/// The program in the window.
pub struct StudioApp {
    model: StudioModel,
    snapshots: Receiver<Snapshot>,
    viewer: Viewer,
    commands: CommandSender,
    trial: Option<LayoutTrial>,
    /// The recording that is shown in place of the session.
    player: Option<Player>,
    /// The person of the lab who is shown while the session goes on.
    watching: Option<Watching>,
    /// The session whose hand follows the mouse.
    fingertip: Option<Fingertip>,
    sensors: SensorControl,
    panels: PanelState,
    settings_file: SettingsFile,
    /// Clicks on presses; without it Studio is silent.
    sound: Option<Sound>,
    /// The last picture shows something that the one before did not, even without input.
    has_changed: bool,
}

/// A person of the lab who is watched.
struct Watching {
    // First, so that the recording of the person is removed after it was closed.
    player: Player,
    model: StudioModel,
    person: WatchedPerson,
}

impl Watching {
    fn new((person, player): (WatchedPerson, Player)) -> Self {
        Self {
            model: player.recording().first_model(),
            player,
            person,
        }
    }
}

impl StudioApp {
    /// Creates the program for a session.
    pub fn new(session: &SessionHandle) -> Result<Self, StudioError> {
        let viewer = session.add_viewer();
        let view = viewer.views().recv().map_err(|_| StudioError::Ended)?;
        let sensors = SensorControl::new(session.sensors());
        Ok(Self {
            model: StudioModel::new(view, sensors.table()),
            snapshots: session.snapshots().clone(),
            viewer,
            commands: session.commands().clone(),
            trial: session.layout_trial().cloned(),
            player: None,
            watching: None,
            fingertip: None,
            sensors,
            panels: PanelState::default(),
            settings_file: SettingsFile::default(),
            sound: None,
            has_changed: true,
        })
    }

    /// Restores the settings of a file, and writes them there when they change. Without this, nothing is remembered.
    #[must_use]
    pub fn with_settings(mut self, path: PathBuf) -> Self {
        let (file, settings, error) = SettingsFile::open(path);
        self.panels.restore(settings);
        self.settings_file = file;
        self.panels.message = error.map(|error| error.to_string());
        self
    }

    /// Clicks on presses of the session, as the settings say. Without this, Studio is silent.
    #[must_use]
    pub fn with_sound(mut self, session: &SessionHandle) -> Self {
        match Sound::start(self.snapshots.clone(), session.add_viewer()) {
            Ok((sound, snapshots)) => {
                self.snapshots = snapshots;
                self.sound = Some(sound);
            }
            Err(error) => self.panels.message = Some(format!("no clicks are heard: {error}")),
        }
        self
    }

    /// Returns the settings, which are written when they change: by panels and by other windows of Studio.
    pub fn settings(&mut self) -> &mut Settings {
        self.panels.settings()
    }

    /// Prepares a window for the first picture.
    pub fn prepare(context: &egui::Context) {
        context.set_fonts(panels::fonts());
    }

    /// The state that the window shows.
    pub fn model(&self) -> &StudioModel {
        self.fingertip
            .as_ref()
            .map_or(&self.model, |fingertip| &fingertip.model)
    }

    /// Shows a recording in place of what the session sends.
    #[must_use]
    pub fn with_player(mut self, player: Player) -> Self {
        self.player = Some(player);
        self.trial = None;
        self.sensors.lock();
        self
    }

    /// Shows a link for a headset until one is connected, and the buttons that let it press keys.
    #[must_use]
    pub fn with_headset(mut self, link: Option<HeadsetLink>) -> Self {
        self.panels.show_headset_link(link);
        self
    }

    /// Draws the limbs of an arm file, if it has any, in place of skin.
    #[must_use]
    pub fn with_arm(mut self, document: Option<&Document>) -> Self {
        if let Some(document) = document {
            self.model.shapes.set_arm(document);
        }
        self
    }

    /// Opens a layout in the editor in place of that of the session. A layout that comes with the program is an unsaved copy.
    pub fn edit(&mut self, name: &str) -> Result<(), DocumentError> {
        self.panels.edit(name, self.model.view.layout.fit)
    }

    /// Draws one picture.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let elapsed = Duration::from_secs_f32(ui.input(|input| input.unstable_dt));
        self.advance(elapsed);
        let (mut sent, mut moves, mut watch) = (Vec::new(), Vec::new(), None);
        let watching = self.watching.as_ref();
        let (shown, aim) = match &mut self.fingertip {
            Some(fingertip) => (Some(&fingertip.model), Some(&mut fingertip.aim)),
            None => (watching.map(|it| &it.model), None),
        };
        let mut context = PanelContext {
            model: shown.unwrap_or(&self.model),
            session: &self.model,
            is_replay: self.player.is_some(),
            sensors: &mut self.sensors,
            trial: self.trial.as_ref(),
            sent: &mut sent,
            player: watching.map(|it| &it.player).or(self.player.as_ref()),
            watched: watching.map(|it| &it.person),
            fingertip: aim,
            watch: &mut watch,
            moves: &mut moves,
        };
        panels::show(ui, &mut self.panels, &mut context);
        self.sensors.advance(elapsed, &mut self.model.sensors);
        if let Some(fingertip) = &mut self.fingertip {
            fingertip.aim.end_picture();
        }
        for command in sent {
            match (&self.fingertip, &command) {
                (Some(fingertip), Command::Candidate { .. }) => fingertip.send(command),
                _ => self.send(command),
            }
        }
        let watched = self.watching.as_mut().map(|it| &mut it.player);
        if let Some(player) = watched.or(self.player.as_mut()) {
            moves.into_iter().for_each(|change| player.apply(change));
        }
        match watch {
            Some(WatchChange::Start(watched)) => self.watching = Some(Watching::new(*watched)),
            Some(WatchChange::End) => self.watching = None,
            None => {}
        }
        self.apply_sound();
    }

    /// Brings the state that is shown to the present.
    fn advance(&mut self, elapsed: Duration) {
        self.has_changed = match &mut self.player {
            Some(player) => {
                player.advance(elapsed, &mut self.model);
                player.is_playing() || !player.is_complete()
            }
            None => self.receive(),
        };
        if let Some(watching) = &mut self.watching {
            watching.player.advance(elapsed, &mut watching.model);
            self.has_changed |= watching.player.is_playing() || !watching.player.is_complete();
        }
        self.has_changed |= self.panels.is_busy();
        self.advance_fingertip();
    }

    /// Starts and ends the session whose hand follows the mouse. Another layout has another session, with a finger that is up.
    fn advance_fingertip(&mut self) {
        let layout = &self.model.view.layout;
        let is_wanted = self.panels.is_fingertip && self.player.is_none();
        self.panels.is_fingertip = is_wanted && self.watching.is_none() && !self.model.has_ended;
        if !self.panels.is_fingertip {
            self.fingertip = None;
            return;
        }
        if !self.fingertip.as_ref().is_some_and(|it| it.is_for(layout)) {
            self.fingertip = None;
            match Fingertip::start(self.sensors.setup(), layout) {
                Ok(fingertip) => self.fingertip = Some(fingertip),
                Err(error) => self.panels.message = Some(error.to_string()),
            }
        }
        if let Some(fingertip) = &mut self.fingertip {
            fingertip.receive();
            self.has_changed = true;
        }
        // A key of the layout may end the session.
        if let Some(ended) = self.fingertip.take_if(|it| it.model.has_ended) {
            self.panels.message = ended.end().err().map(|error| error.to_string());
        }
        self.panels.is_fingertip = self.fingertip.is_some();
    }

    fn apply_sound(&mut self) {
        let Some(sound) = &mut self.sound else {
            return;
        };
        let message = |sound: &Sound| sound.error().map(ToString::to_string);
        let before = message(sound);
        sound.apply(self.panels.settings().sound);
        let now = message(sound);
        // A later message of something else stays.
        if now != before && (now.is_some() || self.panels.message == before) {
            self.panels.message = now;
        }
    }

    /// Receives what the session has sent since the last picture. Does not wait. Returns `false` if that is nothing.
    fn receive(&mut self) -> bool {
        let mut has_received = false;
        for snapshot in self.snapshots.try_iter() {
            self.model.update(&snapshot);
            self.sensors.update(&snapshot);
            has_received = true;
        }
        match self.viewer.views().try_recv() {
            Ok(view) => {
                self.model.set_view(view);
                has_received = true;
            }
            Err(TryRecvError::Disconnected) => self.model.has_ended = true,
            Err(TryRecvError::Empty) => {}
        }
        has_received
    }

    /// Remembers the place of the window, and writes the settings every few seconds or, at the end, at once.
    fn save_settings(&mut self, context: &egui::Context, is_end: bool) {
        let settings = self.panels.settings();
        settings.window = place_of_window(context).or(settings.window);
        let saved = match is_end {
            true => self.settings_file.save(settings),
            false => {
                let now = context.input(|input| input.time);
                self.settings_file.save_at(now, settings)
            }
        };
        if let Err(error) = saved {
            self.panels.message = Some(error.to_string());
        }
    }

    fn send(&mut self, command: Command) {
        if let Err(error) = self.commands.send(command) {
            self.panels.message = Some(error.to_string());
        }
    }
}

/// Returns position and size of a window that is neither maximized nor minimized.
fn place_of_window(context: &egui::Context) -> Option<WindowPlace> {
    context.input(|input| {
        let window = input.viewport();
        let is_placed_by_desktop = [window.maximized, window.minimized, window.fullscreen];
        if is_placed_by_desktop.contains(&Some(true)) {
            return None;
        }
        let size = window.inner_rect?.size();
        let position = window.outer_rect.map(|area| [area.min.x, area.min.y]);
        Some(WindowPlace {
            position,
            size: [size.x, size.y],
        })
    })
}

/// Starts a session with the answers of the first start, and returns the program for it, or the reason why there is none.
type OpenSession<'a> = Box<dyn FnMut(&Answers) -> Result<StudioApp, String> + 'a>;

/// The program in a window, or the pages of the first start before it.
pub struct StudioStart<'a> {
    first: Option<(FirstStart, OpenSession<'a>)>,
    app: Option<StudioApp>,
}

impl<'a> StudioStart<'a> {
    /// Shows the pages of the first start, and then the program that `open` returns for the answers.
    pub fn first(
        first: FirstStart,
        open: impl FnMut(&Answers) -> Result<StudioApp, String> + 'a,
    ) -> Self {
        Self {
            first: Some((first, Box::new(open))),
            app: None,
        }
    }

    /// Returns the program once its session has started.
    pub fn app(&mut self) -> Option<&mut StudioApp> {
        self.app.as_mut()
    }

    /// Draws one picture.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        if let Some(app) = &mut self.app {
            app.show(ui);
            return;
        }
        let Some((first, open)) = &mut self.first else {
            return;
        };
        first.update();
        let Some(answers) = panels::show_first_start(ui, first) else {
            return;
        };
        match open(&answers) {
            Ok(mut app) => {
                if answers.is_calibrated {
                    app.panels.show_calibration();
                }
                self.app = Some(app);
                self.first = None;
            }
            Err(reason) => first.error = Some(reason),
        }
    }
}

impl From<StudioApp> for StudioStart<'_> {
    fn from(app: StudioApp) -> Self {
        Self {
            first: None,
            app: Some(app),
        }
    }
}

/// A [`StudioStart`] in a window of the desktop.
struct Window<'a> {
    content: StudioStart<'a>,
    pace: Pace,
    should_close: fn() -> bool,
}

impl eframe::App for Window<'_> {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let is_stopped = (self.should_close)();
        if is_stopped && let Some(app) = self.content.app() {
            app.panels.permit_close();
        }
        self.content.show(ui);
        let context = ui.ctx();
        if is_stopped {
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let Some(app) = self.content.app() else {
            context.request_repaint_after(FIRST_PERIOD);
            return;
        };
        let is_end = is_stopped || context.input(|input| input.viewport().close_requested());
        app.save_settings(context, is_end);
        let now = context.input(|input| input.time);
        let cost = Duration::from_secs_f32(frame.info().cpu_usage.unwrap_or(0.0));
        let pause = self.pace.pause(now, app.has_changed, cost);
        context.request_repaint_after(pause);
    }
}

/// Shows the program in a window until that is closed, or `should_close` returns `true`. On the main thread only, as desktops
/// require.
pub fn open_window(
    mut content: StudioStart,
    should_close: fn() -> bool,
) -> Result<(), StudioError> {
    let settings = content.app().map(|app| app.settings().clone());
    let settings = settings.unwrap_or_default();
    let (place, scale) = (settings.window, settings.scale);
    let mut viewport = egui::ViewportBuilder::default()
        .with_title(text("window-title"))
        .with_app_id("ademan-studio")
        .with_inner_size(place.map_or(WINDOW_SIZE, |place| place.size))
        .with_min_inner_size(MIN_WINDOW_SIZE);
    if let Some(position) = place.and_then(|place| place.position) {
        viewport = viewport.with_position(position);
    }
    let options = window_options(viewport);
    let window = Window {
        content,
        pace: Pace::new(graphics::has_card()),
        should_close,
    };
    let create: eframe::AppCreator = Box::new(|creation| {
        StudioApp::prepare(&creation.egui_ctx);
        creation.egui_ctx.set_zoom_factor(scale);
        Ok(Box::new(window))
    });
    run_window(text("window-title"), options, create)
}

/// Shows a window until it is closed.
pub(super) fn run_window(
    title: &str,
    options: eframe::NativeOptions,
    create: eframe::AppCreator<'_>,
) -> Result<(), StudioError> {
    // Mesa fills a picture for longer than a press may wait.
    priority::shorten_time_slice();
    eframe::run_native(title, options, create).map_err(window_error)
}

/// Returns the options of every window of Studio.
pub(super) fn window_options(viewport: egui::ViewportBuilder) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        // It takes time for each pixel where Mesa draws in software, and hides steps of gradients that no window has.
        dithering: false,
        ..eframe::NativeOptions::default()
    }
}

/// Returns the reason why a window was not opened.
fn window_error(error: eframe::Error) -> StudioError {
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => StudioError::NoDesktop,
        eframe::Error::Glutin(error) => StudioError::NoOpenGl(error.to_string()),
        eframe::Error::NoGlutinConfigs(_, error) => StudioError::NoOpenGl(error.to_string()),
        error => StudioError::NoOpenGl(error.to_string()),
    }
}
