//! Other layouts, opened from the toolbar: each in a session of its own.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::thread;
use std::time::{Duration, Instant};

use ademan::command::Command;
use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::setup::Setup;
use ademan::sim::HandTask;
use ademan::studio::simulated::simulate;
use ademan::studio::texts::{text, text_with};
use ademan::studio::{SessionRequest, StudioApp, StudioStart};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::picture;

const TIMEOUT: Duration = Duration::from_secs(30);

/// The session of the window; dropped last.
type Running = Rc<RefCell<Option<SessionHandle>>>;

/// Starts a session on a layout in place of the present one.
fn begin(
    layout: &str,
    is_paused: bool,
    settings: &Path,
    running: &Running,
) -> Result<StudioApp, String> {
    let setup = Setup {
        layout: layout.to_owned(),
        output: "none".into(),
        ..Setup::default()
    };
    let setup = setup.load_files().map_err(|error| error.to_string())?;
    let (hand, control) = simulate(&setup, HandTask::Fitting(HandTask::tour)).expect("a hand");
    drop(running.take());
    let options = SessionOptions {
        source: Some(Box::new(hand)),
        speed: Some(4.0),
        ..SessionOptions::default()
    };
    let session = Session::start(setup, options).map_err(|error| error.to_string())?;
    if is_paused {
        session.commands().send(Command::Pause).expect("it runs");
    }
    session.wait_until_started();
    let app = StudioApp::new(&session).map_err(|error| error.to_string())?;
    *running.borrow_mut() = Some(session);
    Ok(app.with_settings(settings.to_owned()).with_hand(control))
}

struct LayoutWindow {
    harness: Harness<'static, StudioStart<'static>>,
    _running: Running,
}

impl LayoutWindow {
    fn open(layout: &str, settings: &Path) -> Self {
        let running = Running::default();
        let app = begin(layout, false, settings, &running).expect("a session");
        let (path, sessions) = (settings.to_owned(), Rc::clone(&running));
        let content = StudioStart::with_layouts(app, move |request| match request {
            SessionRequest::Layout(layout, is_paused) => begin(layout, is_paused, &path, &sessions),
            SessionRequest::First(_) => Err("this is not the first start".to_owned()),
        });
        let builder = Harness::builder()
            .with_size([1280.0, 800.0])
            .with_theme(egui::Theme::Dark)
            .with_render_cursor(false)
            .with_context_setup(StudioApp::prepare)
            .wgpu();
        let mut window = Self {
            harness: builder.build_ui_state(|ui, content| content.show(ui), content),
            _running: running,
        };
        window.draw();
        // The tour of the window.
        window.harness.key_press(egui::Key::Escape);
        window.draw();
        window
    }

    fn draw(&mut self) {
        self.harness.run_steps(3);
    }

    fn app(&mut self) -> &mut StudioApp {
        self.harness.state_mut().app().expect("a program")
    }

    fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.draw();
    }

    fn has(&self, words: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(words);
        found.next().is_some()
    }

    fn wait_for(&mut self, what: &str, condition: impl Fn(&mut StudioApp) -> bool) {
        let deadline = Instant::now() + TIMEOUT;
        while !condition(self.app()) {
            assert!(Instant::now() < deadline, "timed out: {what}");
            thread::sleep(Duration::from_millis(10));
            self.draw();
        }
    }

    fn choose(&mut self, name: &str) {
        self.click(text("menu-open"));
        self.click(name);
    }

    fn enter_file(&mut self, name: &str) {
        self.click(text("menu-open"));
        let label = text("layouts-file");
        let field = self.harness.get_by_role_and_label(Role::TextInput, label);
        field.set_text_value_accesskit(name);
        self.draw();
        self.click(text("layouts-button"));
    }

    fn recent(&mut self) -> Vec<String> {
        let recent = &self.app().settings().recent_layouts;
        recent.iter().map(str::to_owned).collect()
    }
}

#[test]
fn another_layout_is_opened_and_the_hand_uses_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = LayoutWindow::open("arrows", &folder.path().join("studio.ron"));
    window.click(text("menu-open"));
    if picture::has_driver() {
        let drawn = window.harness.render().expect("the driver draws");
        let target = picture::folder("../../target/studio");
        picture::save(&drawn, &target.join("menu-open.png"));
    }
    window.click("numpad");
    let name = "layouts/keyboards/numpad.ron";
    assert_eq!(window.app().model().view.layout.file, name);
    window.wait_for("a press", |app| {
        app.model().history.events().any(|event| event.is_press)
    });
    assert!(window.recent().is_empty(), "it is no file");
}

#[test]
fn a_pause_stays_with_the_next_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = LayoutWindow::open("arrows", &folder.path().join("studio.ron"));
    window.click(text("button-pause"));
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
    window.choose("numpad");
    window.wait_for("a pause", |app| app.model().view.state.paused_by.is_some());
    window.wait_for("readings", |app| app.model().stats.accepted > 3000);
    assert!(window.app().model().view.state.paused_by.is_some());
    assert_eq!(window.app().model().history.events().count(), 0);
}

#[test]
fn files_are_remembered_and_one_that_is_gone_is_dropped_with_a_notice() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = r#"Layout(name: "NAME", boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
        rows: [(at_mm: (-19, 0), keys: "Y N")],
    )])"#;
    let paths = ["one.ron", "two.ron"].map(|name| folder.path().join(name));
    for path in &paths {
        std::fs::write(path, layout).expect("a write");
    }
    let [one, two] = paths.each_ref().map(|path| path.to_str().expect("UTF-8"));
    let mut window = LayoutWindow::open(one, &folder.path().join("studio.ron"));
    window.enter_file(two);
    assert_eq!(window.app().model().view.layout.file, two);
    assert_eq!(window.recent(), [two, one]);
    window.choose("one.ron");
    assert_eq!(window.app().model().view.layout.file, one);
    assert_eq!(window.recent(), [one, two]);
    std::fs::remove_file(two).expect("a file");
    window.choose("two.ron");
    assert_eq!(window.app().model().view.layout.file, one);
    assert_eq!(window.recent(), [one]);
    let notice = text_with("layouts-missing", &[("file", two.into())]);
    window.draw();
    assert!(window.has(&notice), "{notice}");
}

#[test]
fn a_layout_with_faults_leaves_the_session_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("faults.ron");
    std::fs::write(&path, "Layout(").expect("a write");
    let mut window = LayoutWindow::open("arrows", &folder.path().join("studio.ron"));
    window.enter_file(path.to_str().expect("UTF-8"));
    assert_eq!(
        window.app().model().view.layout.file,
        "layouts/keyboards/arrows.ron"
    );
    assert!(window.has("faults.ron"));
    window.wait_for("a press", |app| {
        app.model().history.events().any(|event| event.is_press)
    });
}
