//! Studio in a window without a display, in which each change of the setup leads to another session.

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;
use std::thread;
use std::time::{Duration, Instant};

use ademan::command::Command;
use ademan::output;
use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::Setup;
use ademan::sim::HandTask;
use ademan::studio::simulated::simulate;
use ademan::studio::texts::text;
use ademan::studio::{SessionRequest, StudioApp, StudioStart};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::picture;
use crate::window::TIMEOUT;

/// The setup and the session of the window; dropped last.
type Running = Rc<RefCell<(Setup, Option<SessionHandle>)>>;

/// Starts a session in place of the present one.
fn begin(
    setup: Setup,
    is_paused: bool,
    settings: &Path,
    running: &Running,
) -> Result<StudioApp, String> {
    let loaded = setup.clone().load_files().map_err(|it| it.to_string())?;
    let simulated = loaded.setup.source.is_none();
    let simulated =
        simulated.then(|| simulate(&loaded, HandTask::Fitting(HandTask::tour)).expect("a hand"));
    let (hand, control) = simulated.unzip();
    let required = loaded.required_capabilities();
    output::check(&loaded.setup.output, &required).map_err(|error| error.to_string())?;
    drop(running.borrow_mut().1.take());
    let options = SessionOptions {
        source: hand.map(|hand| Box::new(hand) as _),
        speed: Some(4.0),
        ..SessionOptions::default()
    };
    let session = Session::start(loaded, options).map_err(|error| error.to_string())?;
    if is_paused {
        session.commands().send(Command::Pause).expect("it runs");
    }
    assert!(session.wait_until_started());
    let app = StudioApp::new(&session).map_err(|error| error.to_string())?;
    *running.borrow_mut() = (setup, Some(session));
    let app = app.with_settings(settings.to_owned());
    Ok(match control {
        Some(control) => app.with_hand(control),
        None => app,
    })
}

/// A window whose layout and devices can be changed.
pub struct ChangingWindow {
    pub harness: Harness<'static, StudioStart<'static>>,
    /// The session after the next change does not start while this is set, as if an output waited for a permission.
    pub is_held: Rc<Cell<bool>>,
    running: Running,
}

impl ChangingWindow {
    /// Opens the window with the simulated hand on a layout.
    pub fn open(layout: &str, settings: &Path) -> Self {
        let setup = Setup {
            layout: layout.to_owned(),
            output: "none".into(),
            ..Setup::default()
        };
        Self::on_setup(setup, settings)
    }

    /// Opens the window on a setup.
    pub fn on_setup(setup: Setup, settings: &Path) -> Self {
        Self::with_look(setup, settings, egui::Theme::Dark, 1.0)
    }

    /// Opens the window on a setup, in colors and at a scale of the system.
    pub fn with_look(
        setup: Setup,
        settings: &Path,
        theme: egui::Theme,
        pixels_per_point: f32,
    ) -> Self {
        let running = Running::default();
        let app = begin(setup, false, settings, &running).expect("a session");
        let (path, sessions) = (settings.to_owned(), Rc::clone(&running));
        let is_held = Rc::new(Cell::new(false));
        let (holds, mut pending) = (Rc::clone(&is_held), None);
        let content = StudioStart::with_changes(app, move |request| {
            let before = sessions.borrow().0.clone();
            let (next, is_paused) = match request {
                SessionRequest::Change(change, is_paused) => {
                    let next = change.apply(before).map_err(|error| error.to_string())?;
                    let is_paused = is_paused || change.needs_resume(&next);
                    (next, is_paused)
                }
                SessionRequest::Wait => pending.take().expect("a session that is held"),
                SessionRequest::Cancel => {
                    pending = None;
                    return begin(before, false, &path, &sessions).map(Some);
                }
                SessionRequest::First(_) => {
                    return Err("this is not the first start".to_owned());
                }
            };
            if holds.get() {
                drop(sessions.borrow_mut().1.take());
                pending = Some((next, is_paused));
                return Ok(None);
            }
            begin(next, is_paused, &path, &sessions).map(Some)
        });
        let builder = Harness::builder()
            .with_size([1280.0, 720.0])
            .with_pixels_per_point(pixels_per_point)
            .with_theme(theme)
            .with_render_cursor(false)
            .with_context_setup(StudioApp::prepare)
            .wgpu();
        let mut window = Self {
            harness: builder.build_ui_state(|ui, content| content.show(ui), content),
            is_held,
            running,
        };
        window.draw();
        // The tour of the window.
        window.harness.key_press(egui::Key::Escape);
        window.draw();
        window
    }

    /// The setup of the present session.
    pub fn setup(&self) -> Setup {
        self.running.borrow().0.clone()
    }

    pub fn draw(&mut self) {
        self.harness.run_steps(3);
    }

    pub fn app(&mut self) -> &mut StudioApp {
        self.harness.state_mut().app().expect("a program")
    }

    pub fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.draw();
    }

    pub fn has(&self, words: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(words);
        found.next().is_some()
    }

    pub fn wait_for(&mut self, what: &str, condition: impl Fn(&mut StudioApp) -> bool) {
        let deadline = Instant::now() + TIMEOUT;
        while !condition(self.app()) {
            assert!(Instant::now() < deadline, "timed out: {what}");
            thread::sleep(Duration::from_millis(10));
            self.draw();
        }
    }

    /// Waits until the window shows these words.
    pub fn wait_for_words(&mut self, words: &str) {
        let deadline = Instant::now() + TIMEOUT;
        while !self.has(words) {
            assert!(Instant::now() < deadline, "timed out: {words}");
            self.draw();
        }
    }

    /// Writes words into the field with this label, and confirms them with Enter.
    pub fn enter(&mut self, label: &str, words: &str) {
        let field = self.harness.get_by_role_and_label(Role::TextInput, label);
        field.focus();
        field.set_text_value_accesskit(words);
        self.draw();
        self.harness.key_press(egui::Key::Enter);
        self.draw();
    }

    /// Sets the number in the field with this label.
    pub fn set_number(&mut self, label: &str, number: f64) {
        let field = self.harness.get_by_role_and_label(Role::SpinButton, label);
        field.set_value_accesskit(number);
        self.draw();
    }

    /// Writes a picture of the window, if there is a driver; for the guide if its name starts like the names there.
    pub fn picture(&mut self, name: &str) {
        if !picture::has_driver() {
            println!("SKIPPED: there is no Vulkan driver; Debian's mesa-vulkan-drivers is one");
            return;
        }
        let drawn = self.harness.render().expect("the driver draws");
        let target = picture::folder("../../target/studio");
        picture::save(&drawn, &target.join(name).with_extension("png"));
        if name.starts_with("studio-") {
            picture::document_drawn(&drawn, name);
        }
    }

    pub fn choose_layout(&mut self, name: &str) {
        self.click(text("menu-open"));
        self.click(name);
    }

    pub fn enter_layout(&mut self, name: &str) {
        self.click(text("menu-open"));
        let label = text("layouts-file");
        let field = self.harness.get_by_role_and_label(Role::TextInput, label);
        field.set_text_value_accesskit(name);
        self.draw();
        self.click(text("layouts-button"));
    }

    pub fn recent_layouts(&mut self) -> Vec<String> {
        let recent = &self.app().settings().recent_layouts;
        recent.iter().map(str::to_owned).collect()
    }
}
