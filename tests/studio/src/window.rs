//! Studio in a window without a display, and a person who operates it.

use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::{OtherHand, Setup};
use ademan::studio::StudioApp;
use ademan::studio::model::StudioModel;
use ademan::studio::playback::{Player, Recording};
use ademan::studio::texts::text;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::played_hand::PlayedHand;

/// Time after which a session that does not do what a test waits for has failed.
const TIMEOUT: Duration = Duration::from_secs(30);

/// Time between two pictures while a test waits.
const PICTURE_PERIOD: Duration = Duration::from_millis(10);

/// The content of a window when it opens.
pub struct Opening {
    /// The setup of the session. Its source is the simulated hand.
    pub setup: Setup,
    /// Number of readings after which the hand keeps still.
    pub readings: usize,
    /// Speed of the hand relative to its clock; without one it moves as fast as the session allows.
    pub speed: Option<f64>,
    /// Colours.
    pub theme: egui::Theme,
    /// Size, in points.
    pub size: [f32; 2],
    /// The file of the settings. Without one nothing is remembered.
    pub settings: Option<PathBuf>,
    /// A recording that is shown in place of the hand.
    pub recording: Option<PathBuf>,
}

impl Default for Opening {
    fn default() -> Self {
        Self {
            setup: Setup {
                output: "none".into(),
                ..Setup::default()
            },
            readings: 180,
            speed: None,
            theme: egui::Theme::Dark,
            size: [1280.0, 800.0],
            settings: None,
            recording: None,
        }
    }
}

impl Opening {
    /// Returns the default window on a layout that comes with the program, with both hands if it is for both.
    pub fn on_layout(layout: &str) -> Self {
        let mut opening = Self::default();
        opening.setup.layout = layout.to_owned();
        opening.setup.other_hand = layout.contains("-two-").then(OtherHand::default);
        opening
    }

    /// Starts the session and opens the window. Waits until the hand keeps still.
    pub fn open(self) -> StudioWindow {
        let setup = self.setup.load_files().expect("the files of the setup");
        let hand = PlayedHand::new(&setup, self.readings).expect("a hand for the layout");
        let options = SessionOptions {
            source: Some(Box::new(hand)),
            lossless_snapshots: true,
            speed: self.speed,
            ..SessionOptions::default()
        };
        let session = Session::start(setup, options).expect("the session starts");
        session.wait_until_started();
        let mut app = StudioApp::new(&session).expect("the session runs");
        if let Some(path) = self.settings {
            app = app.with_settings(path);
        }
        if let Some(path) = self.recording {
            let recording = Recording::open(&path, None).expect("a recording");
            app = app.with_player(Player::open(recording).expect("a thread"));
        }
        let builder = Harness::builder()
            .with_size(self.size)
            .with_theme(self.theme)
            .with_render_cursor(false)
            .with_context_setup(StudioApp::prepare)
            .wgpu();
        let mut window = StudioWindow {
            harness: builder.build_ui_state(show, app),
            _session: session,
        };
        window.wait_for_still_hand(self.readings);
        // The camera was placed when the first pose arrived, which is another one in each run.
        window.press_key(egui::Key::Num1);
        window
    }
}

/// Draws Studio on the whole window: the harness leaves a margin.
fn show(ui: &mut egui::Ui, app: &mut StudioApp) {
    let area = ui.ctx().content_rect();
    ui.scope_builder(egui::UiBuilder::new().max_rect(area), |ui| {
        ui.set_clip_rect(area);
        app.show(ui);
    });
}

/// Studio in a window without a display, on a session of its own.
pub struct StudioWindow {
    /// The window. Declared first: the session ends after it.
    pub harness: Harness<'static, StudioApp>,
    _session: SessionHandle,
}

impl StudioWindow {
    /// The state that the window shows.
    pub fn model(&self) -> &StudioModel {
        self.harness.state().model()
    }

    /// Opens a layout in the editor.
    pub fn open_in_editor(&mut self, name: &str) {
        let app = self.harness.state_mut();
        app.edit(name).expect("the layout can be opened");
    }

    /// Draws `count` pictures.
    pub fn draw(&mut self, count: usize) {
        self.harness.run_steps(count);
    }

    /// Clicks on the widget with this name, and draws what follows.
    pub fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.draw(3);
    }

    /// Clicks on the check box with this name, and draws what follows.
    pub fn toggle(&mut self, name: &str) {
        let check_box = self.harness.get_by_role_and_label(Role::CheckBox, name);
        check_box.click();
        self.draw(3);
    }

    /// Presses and releases a key, and draws what follows.
    pub fn press_key(&mut self, key: egui::Key) {
        self.harness.key_press(key);
        self.draw(3);
    }

    /// Returns `true` if the window has a widget with this name.
    pub fn has(&self, name: &str) -> bool {
        self.harness.query_by_label(name).is_some()
    }

    /// Hides all panels beside the 3D view.
    pub fn show_space_only(&mut self) {
        for panel in ["panel-sensors", "panel-scope"] {
            self.toggle_in_menu(text(panel));
        }
        // The boards fill the larger view.
        self.press_key(egui::Key::Num1);
    }

    /// Clicks on an entry of the menu `View`.
    pub fn toggle_in_menu(&mut self, name: &str) {
        self.click(text("menu-view"));
        self.toggle(name);
        self.press_key(egui::Key::Escape);
    }

    /// Draws pictures until the state that the window shows is as `condition` says.
    pub fn wait_for(&mut self, what: &str, condition: impl Fn(&StudioModel) -> bool) {
        let deadline = Instant::now() + TIMEOUT;
        while !condition(self.model()) {
            assert!(Instant::now() < deadline, "timed out: {what}");
            thread::sleep(PICTURE_PERIOD);
            self.draw(1);
        }
    }

    /// Waits until the window shows the last reading of the hand.
    fn wait_for_still_hand(&mut self, readings: usize) {
        let readings = readings as u64;
        self.wait_for("the readings of the hand", |model| {
            let received = model.stats.accepted + model.stats.rejected.iter().sum::<u64>();
            received >= readings
        });
        self.draw(2);
    }
}
