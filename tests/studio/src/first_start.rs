//! The pages of the first start, with a glove on a pseudo-terminal and without any device.

use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ademan::session::{Session, SessionHandle, SessionOptions};
use ademan::studio::first_start::{Answers, FirstStart, Search};
use ademan::studio::texts::{self, Language, text, text_with};
use ademan::studio::{SessionRequest, StudioApp, StudioStart};
use egui::accesskit::{Role, Toggled};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use serialport::{SerialPort, TTYPort};

use crate::picture;
use crate::played_hand::PlayedHand;
use crate::window::TIMEOUT;

/// A glove with five curls, whose firmware is not the program's, on a pseudo-terminal.
struct CurlGlove {
    port: String,
    is_on: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl CurlGlove {
    fn plug_in() -> Self {
        let (mut master, slave) = TTYPort::pair().expect("a pseudo-terminal");
        let port = slave.name().expect("a name");
        // An open end of its own would lock the terminal.
        drop(slave);
        let is_on = Arc::new(AtomicBool::new(true));
        let sends = Arc::clone(&is_on);
        let send = move || {
            let mut count = 0;
            while sends.load(Ordering::Relaxed) {
                count = (count + 7) % 900;
                let line = format!("A{}B{}C900D880E910\n", 700 + count, 1900 - count);
                // A reader that is not there leaves the terminal full.
                let _ = master.write_all(line.as_bytes());
                thread::sleep(Duration::from_millis(10));
            }
        };
        Self {
            port,
            is_on,
            thread: Some(thread::spawn(send)),
        }
    }
}

impl Drop for CurlGlove {
    fn drop(&mut self) {
        self.is_on.store(false, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// The window of a first start, the answers that it has given, and the session of these.
struct FirstWindow {
    harness: Harness<'static, StudioStart<'static>>,
    answers: Rc<RefCell<Option<Answers>>>,
    session: Rc<RefCell<Option<SessionHandle>>>,
}

impl FirstWindow {
    fn open(ports: &[&str]) -> Self {
        let ports = ports.iter().map(|&port| port.to_owned()).collect();
        let first = FirstStart::new(Search::new(ports, Vec::new()));
        let answers = Rc::new(RefCell::new(None));
        let session = Rc::new(RefCell::new(None));
        let (given, started) = (Rc::clone(&answers), Rc::clone(&session));
        let content = StudioStart::first(first, move |request| {
            let SessionRequest::First(answers) = request else {
                return Err("no other layout".to_owned());
            };
            let (app, handle) = begin(answers)?;
            *given.borrow_mut() = Some(answers.clone());
            *started.borrow_mut() = Some(handle);
            Ok(Some(app))
        });
        let builder = Harness::builder()
            .with_size([1000.0, 640.0])
            .with_theme(egui::Theme::Dark)
            .with_render_cursor(false)
            .with_context_setup(StudioApp::prepare)
            .wgpu();
        Self {
            harness: builder.build_ui_state(show, content),
            answers,
            session,
        }
    }

    fn draw(&mut self) {
        self.harness.run_steps(3);
    }

    fn has(&self, words: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(words);
        found.next().is_some()
    }

    /// Returns all words of the window.
    fn words(&self) -> Vec<String> {
        let root = self.harness.root();
        let words = root.children_recursive().filter_map(|node| {
            let own = node.accesskit_node();
            own.label().or(own.value())
        });
        words.collect()
    }

    fn click(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.draw();
    }

    fn wait_for(&mut self, what: &str, condition: impl Fn(&Self) -> bool) {
        let deadline = Instant::now() + TIMEOUT;
        while !condition(self) {
            assert!(
                Instant::now() < deadline,
                "timed out: {what}: {:?}",
                self.words()
            );
            thread::sleep(Duration::from_millis(10));
            self.draw();
        }
    }

    /// Returns `true` if the radio button whose name contains these words is chosen.
    fn is_chosen(&self, words: &str) -> bool {
        let buttons = self.harness.query_all_by_role(Role::RadioButton);
        let mut own = buttons.filter(|button| {
            let name = button.accesskit_node().label();
            name.is_some_and(|name| name.contains(words))
        });
        let button = own.next().expect("a radio button");
        button.accesskit_node().toggled() == Some(Toggled::True)
    }

    fn picture(&mut self, name: &str) {
        if !picture::has_driver() {
            println!("SKIPPED: there is no Vulkan driver; Debian's mesa-vulkan-drivers is one");
            return;
        }
        let drawn = self.harness.render().expect("the driver draws");
        let folder = picture::folder("../../target/studio");
        picture::save(&drawn, &folder.join(name).with_extension("png"));
        if name == "first-source" {
            picture::document_drawn(&drawn, "studio-first");
        }
    }
}

/// Draws the program on the whole window: the harness leaves a margin.
fn show(ui: &mut egui::Ui, content: &mut StudioStart<'static>) {
    let area = ui.ctx().content_rect();
    ui.scope_builder(egui::UiBuilder::new().max_rect(area), |ui| {
        ui.set_clip_rect(area);
        content.show(ui);
    });
}

fn begin(answers: &Answers) -> Result<(StudioApp, SessionHandle), String> {
    let setup = answers.load().map_err(|error| error.to_string())?;
    let mut options = SessionOptions::default();
    if setup.setup.source.is_none() {
        let limit = Arc::new(usize::MAX.into());
        let hand = PlayedHand::new(&setup, limit).map_err(|error| error.to_string())?;
        options.source = Some(Box::new(hand));
        options.speed = Some(1.0);
    }
    let session = Session::start(setup, options).map_err(|error| error.to_string())?;
    session.wait_until_started();
    let app = StudioApp::new(&session).map_err(|error| error.to_string())?;
    Ok((app, session))
}

#[test]
fn enter_that_is_held_goes_one_page_on() {
    let mut window = FirstWindow::open(&[]);
    window.draw();
    for _ in 0..3 {
        window.harness.key_down(egui::Key::Enter);
        window.draw();
    }
    let second = text_with("tour-step", &[("step", 2.into()), ("count", 4.into())]);
    assert!(window.has(&second), "{:?}", window.words());
}

#[test]
fn a_glove_is_found_and_each_page_has_a_proposal() {
    let glove = CurlGlove::plug_in();
    let mut window = FirstWindow::open(&[&glove.port]);
    window.wait_for("a recognized glove", |window| window.has("LucidGloves"));
    assert!(
        window.is_chosen("LucidGloves"),
        "the device is the proposal"
    );
    window.picture("first-source");
    window.click(text("tour-next"));
    assert!(window.is_chosen(text("first-right")));
    window.picture("first-hand");
    window.click(text("tour-next"));
    assert!(window.is_chosen("chords-bend"));
    window.picture("first-layout");
    window.click(text("tour-next"));
    window.picture("first-summary");
    window.click(text("first-keep"));
    window.click(text("first-begin"));
    let answers = window.answers.take().expect("answers");
    let source = answers.setup.source.expect("a source").to_string();
    assert!(
        source.starts_with(&format!("serial:{}", glove.port)),
        "{source}"
    );
    assert!(source.contains("protocol=lucidgloves"), "{source}");
    assert_eq!(answers.setup.layout, "chords-bend");
    assert!(!answers.is_kept && answers.is_calibrated);
    // The calibration is open, and the session reads the glove.
    assert!(window.has(text("calibration-start")));
    window.wait_for("readings of the glove", |window| {
        let session = window.session.borrow();
        session.as_ref().is_some_and(|session| {
            session
                .add_viewer()
                .views()
                .recv_timeout(TIMEOUT)
                .is_ok_and(|view| view.state.counts.received > 0)
        })
    });
    window.picture("first-calibration");
}

#[test]
fn every_page_is_skipped_to_the_simulated_hand() {
    let mut window = FirstWindow::open(&["/dev/no-such-port"]);
    window.wait_for("a port that is not there", |window| {
        window.has("/dev/no-such-port")
            && !window.has(&text_with(
                "first-listening",
                &[("port", "/dev/no-such-port".into())],
            ))
    });
    window.picture("first-nothing");
    for page in ["first-source", "first-hand", "first-layout"] {
        assert!(window.has(text(page)), "{page}");
        window.click(text("first-skip"));
    }
    assert!(window.has(text("first-begin")));
    window.click(text("first-begin"));
    let answers = window.answers.take().expect("answers");
    assert_eq!(answers, FirstStart::skipped());
    window.wait_for("typed text", |window| {
        window.words().iter().any(|words| words.starts_with("hola"))
    });
    window.picture("first-typing");
}

#[test]
fn escape_skips_all_and_another_hand_and_layout_are_chosen() {
    let mut window = FirstWindow::open(&[]);
    window.draw();
    assert!(window.has(text("first-no-port")));
    window.click(text("tour-next"));
    window.click(text("first-left"));
    window.click(text("tour-next"));
    assert!(
        window.is_chosen("chords-bend"),
        "the keyboard is on the right"
    );
    window.click("numpad");
    window.click(text("tour-back"));
    assert!(window.is_chosen(text("first-left")), "the answer stays");
    window.harness.key_press(egui::Key::Escape);
    window.draw();
    assert_eq!(window.answers.take(), Some(FirstStart::skipped()));
    assert!(window.has(text("button-pause")));
}

#[test]
fn the_pages_fit_in_both_languages() {
    for language in Language::ALL {
        texts::set_language(language);
        let mut window = FirstWindow::open(&[]);
        window.draw();
        for page in 0..4 {
            let screen = window.harness.ctx.content_rect();
            let root = window.harness.root();
            for node in root.children_recursive() {
                let own = node.accesskit_node();
                let is_button = matches!(own.role(), Role::Button | Role::CheckBox);
                if is_button {
                    let area = node.rect();
                    assert!(screen.contains_rect(area), "{:?}: {area}", own.label());
                }
            }
            window.picture(&format!("first-{}-{page}", language.name()));
            if page < 3 {
                window.click(text("tour-next"));
            }
        }
    }
    texts::set_language(Language::English);
}
