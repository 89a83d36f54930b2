//! Studio in a window without a display, and a person who operates it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::Source;
use ademan::document::Document;
use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::studio::model::StudioModel;
use ademan::studio::playback::{Player, Recording};
use ademan::studio::texts::text;
use ademan::studio::{PictureFormats, StudioApp};
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};

use crate::played_hand::PlayedHand;

/// Time after which a session that does not do what a test waits for has failed. Beside other windows, which a processor draws,
/// a busy machine needs many times what it needs for one.
pub const TIMEOUT: Duration = Duration::from_secs(120);

/// Time between two frames while a test waits.
const PICTURE_PERIOD: Duration = Duration::from_millis(10);

/// Height of the status line, in points.
const STATUS_HEIGHT: f32 = 34.0;

/// The content of a window when it opens.
pub struct Opening {
    /// The setup of the session. Its source is the simulated hand.
    pub setup: Setup,
    /// Number of readings after which the hand keeps still.
    pub readings: usize,
    /// Speed of the hand relative to its clock; without one it moves as fast as the session allows.
    pub speed: Option<f64>,
    /// Colors.
    pub theme: egui::Theme,
    /// Size, in points.
    pub size: [f32; 2],
    /// Pixels per point: 2 at 200 %.
    pub pixels_per_point: f32,
    /// The file of the settings. Without one nothing is remembered.
    pub settings: Option<PathBuf>,
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
            pixels_per_point: 1.0,
            settings: None,
        }
    }
}

impl Opening {
    /// Returns the default window on a layout that comes with the program, with both hands if it is for both.
    pub fn on_layout(layout: &str) -> Self {
        let mut opening = Self::default();
        opening.setup.layout = layout.to_owned();
        let uses_both = layout.contains("-two-") || layout == "wrist-remote";
        opening.setup.other_hand = uses_both.then(OtherHand::default);
        opening
    }

    /// Starts the session and opens the window. Waits until the hand keeps still.
    pub fn open(self) -> StudioWindow {
        let setup = self.loaded_setup();
        let limit = Arc::new(AtomicUsize::new(self.readings));
        let hand = PlayedHand::new(&setup, Arc::clone(&limit)).expect("a hand for the layout");
        let readings = self.readings;
        let mut window = self.open_with(Box::new(hand), |app| app);
        window.limit = limit;
        window.wait_for_readings(readings);
        // The camera was placed when the first pose arrived, which is another one in each run.
        window.press_key(egui::Key::Num1);
        window
    }

    /// Opens the window on a recording, and waits until that is loaded. It does not play.
    pub fn open_recording(self, path: &Path) -> StudioWindow {
        let setup = self.loaded_setup();
        let hand = PlayedHand::new(&setup, Arc::default()).expect("a hand for the layout");
        let recording = Recording::open(path, None).expect("a recording");
        let player = Player::open(recording).expect("a thread");
        let mut window = self.open_with(Box::new(hand), |app| app.with_player(player));
        window.click(text("recording-first"));
        let is_loaded = |window: &StudioWindow| window.is_enabled(text("recording-export"));
        window.draw_until("a loaded recording", is_loaded);
        window.press_key(egui::Key::Num1);
        window
    }

    fn loaded_setup(&self) -> LoadedSetup {
        let setup = self.setup.clone();
        setup.load_files().expect("the files of the setup")
    }

    /// Starts the session with a source, and opens the window.
    pub fn open_with(
        self,
        source: Box<dyn Source>,
        prepare: impl FnOnce(StudioApp) -> StudioApp,
    ) -> StudioWindow {
        let setup = self.loaded_setup();
        let options = SessionOptions {
            source: Some(source),
            lossless_snapshots: true,
            speed: self.speed,
            ..SessionOptions::default()
        };
        let session = Session::start(setup, options).expect("the session starts");
        session.wait_until_started();
        let app = StudioApp::new(&session).expect("the session runs");
        let mut app = prepare(app.with_pictures(PICTURES));
        if let Some(path) = self.settings {
            app = app.with_settings(path);
        }
        let builder = Harness::builder()
            .with_size(self.size)
            .with_pixels_per_point(self.pixels_per_point)
            .with_theme(self.theme)
            .with_render_cursor(false)
            .with_context_setup(StudioApp::prepare)
            .wgpu();
        StudioWindow {
            harness: builder.build_ui_state(show, app),
            limit: Arc::default(),
            session,
        }
    }
}

/// Makes pictures by name only: the program draws them with libraries of its own.
pub const PICTURES: PictureFormats = PictureFormats {
    png: |svg| Ok(format!("pixels of {svg}").into_bytes()),
    pdf: |svg| Ok(format!("page of {svg}").into_bytes()),
};

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
    /// Number of readings after which the hand keeps still.
    limit: Arc<AtomicUsize>,
    session: SessionHandle,
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

    /// Replaces the layout of the session, as an edit that is tried does.
    pub fn change_layout(&self, text: &str) {
        let trial = self
            .session
            .layout_trial()
            .expect("the session has layouts");
        let file = &self.model().view.layout.file;
        let edited = Document::new(file.as_str(), text);
        assert!(trial.start(file, edited).is_some());
    }

    /// Draws `count` frames.
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

    /// Sets the number in the field or slider with this name, and draws what follows.
    pub fn set_number(&mut self, role: Role, name: &str, number: f64) {
        let field = self.harness.get_by_role_and_label(role, name);
        field.set_value_accesskit(number);
        self.draw(3);
    }

    /// Returns the number in the slider with this name.
    pub fn number(&self, name: &str) -> f64 {
        let slider = self.harness.get_by_role_and_label(Role::Slider, name);
        let number = slider.accesskit_node().numeric_value();
        number.expect("a slider has a number")
    }

    /// Replaces the words in the field with this name, and draws what follows.
    pub fn enter(&mut self, name: &str, words: &str) {
        let field = self.harness.get_by_role_and_label(Role::TextInput, name);
        field.set_text_value_accesskit(words);
        self.draw(3);
    }

    /// Returns `true` if the window has a widget with this name.
    pub fn has(&self, name: &str) -> bool {
        self.harness.query_all_by_label(name).next().is_some()
    }

    /// Returns `true` if the window has words that contain these.
    pub fn has_words(&self, words: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(words);
        found.next().is_some()
    }

    /// Returns `true` if the button with this name can be clicked.
    pub fn is_enabled(&self, name: &str) -> bool {
        let button = self.harness.get_by_role_and_label(Role::Button, name);
        !button.accesskit_node().is_disabled()
    }

    /// Returns the area of the widget with this name.
    pub fn rect_of(&self, name: &str) -> egui::Rect {
        let mut found = self.harness.get_all_by_label(name);
        found.next().expect("a widget").rect()
    }

    /// Clicks in an area, at a fraction of its width.
    pub fn click_at(&mut self, area: egui::Rect, fraction: f32) {
        let at = egui::pos2(area.min.x + area.width() * fraction, area.center().y);
        self.harness.hover_at(at);
        self.draw(2);
        for pressed in [true, false] {
            self.harness.event(egui::Event::PointerButton {
                pos: at,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            });
            self.draw(2);
        }
    }

    /// Returns the area of the panel with this name, with the space around its content.
    pub fn panel(&self, name: &str) -> egui::Rect {
        let name = format!("{}: {name}", text("panel-word"));
        let area = self.harness.get_by_label(&name).rect().expand(6.0);
        area.intersect(self.harness.ctx.content_rect())
    }

    /// Returns the area between the toolbar and the status line.
    pub fn workspace(&self) -> egui::Rect {
        let toolbar = self.rect_of(text("menu-view"));
        let window = self.harness.ctx.content_rect();
        egui::Rect::from_x_y_ranges(
            window.x_range(),
            toolbar.max.y + 7.0..=window.max.y - STATUS_HEIGHT,
        )
    }

    /// Returns the words at the right of the button with this name.
    pub fn words_beside(&self, button: &str) -> Vec<String> {
        let area = self
            .harness
            .get_by_role_and_label(Role::Button, button)
            .rect();
        let is_beside = |node: &Node| {
            let own = node.rect();
            area.y_range().contains(own.center().y) && own.min.x >= area.max.x
        };
        let nodes = self.harness.query_all_by_role(Role::Label);
        let nodes = nodes.filter(is_beside);
        nodes.filter_map(|node| node.value()).collect()
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

    /// Draws frames until the state that the window shows is as `condition` says.
    pub fn wait_for(&mut self, what: &str, condition: impl Fn(&StudioModel) -> bool) {
        self.draw_until(what, |window| condition(window.model()));
    }

    /// Draws frames until the window is as `condition` says.
    pub fn draw_until(&mut self, what: &str, condition: impl Fn(&Self) -> bool) {
        let deadline = Instant::now() + TIMEOUT;
        while !condition(self) {
            assert!(Instant::now() < deadline, "timed out: {what}");
            thread::sleep(PICTURE_PERIOD);
            self.draw(1);
        }
    }

    /// Lets the hand move on by a number of readings, and waits until the window shows them.
    pub fn play(&mut self, readings: usize) {
        let before = self.limit.fetch_add(readings, Ordering::Relaxed);
        self.wait_for_readings(before + readings);
    }

    /// Waits until the window shows a number of readings.
    pub fn wait_for_readings(&mut self, readings: usize) {
        let readings = readings as u64;
        self.wait_for("the readings of the hand", |model| {
            let received = model.stats.accepted + model.stats.rejected.iter().sum::<u64>();
            received >= readings
        });
        self.draw(2);
    }
}
