//! The menu of the session of `ademan run`, which is clicked in the window of Studio.

use ademan::command::TextMode;

use super::attached::Other;
use super::screen_reader::ScreenReader;
use crate::support::program::Program;
use crate::support::x11::{XServer, wait_for};

/// A hand that holds a key of the first of two profiles.
const SETUP: &str = r#"Setup(
    layout: "qwerty-flat",
    profiles: [(name: "arc", layout: "qwerty-arc")],
    text: (mode: Literal),
    source: "script:press H; wait 600000",
    output: "none",
)"#;

/// The screen, which has room for the whole window.
const SCREEN: &str = "1280x800x24";

/// A run with the [`SETUP`], a window that shows it, and a person who clicks there.
struct Menu {
    window: Program,
    other: Other,
    reader: ScreenReader,
    server: XServer,
}

impl Menu {
    fn start() -> Option<Self> {
        let server = XServer::with_screen(SCREEN)?;
        let reader = ScreenReader::start()?;
        let other = Other::start_setup(SETUP);
        let window = other.open_with(&server, &[], |command| {
            command
                .env("DBUS_SESSION_BUS_ADDRESS", reader.bus_address())
                .env("LC_ALL", "C.UTF-8");
        });
        Some(Self {
            window,
            other,
            reader,
            server,
        })
    }

    fn click(&mut self, name: &str) {
        self.reader.click(&self.server, name);
    }

    /// Waits until the run says that this is so.
    fn wait_for_run(&self, what: &str, condition: impl Fn(&Other) -> bool) {
        let is_so = wait_for(|| condition(&self.other));
        let state = self.other.ctl("state");
        let messages = self.window.stderr_lines();
        assert!(is_so, "{what}: {state}\n{messages:#?}");
    }
}

/// The button of the menu while a profile is active.
fn button(profile: &str) -> String {
    format!("Another session: setup.ron · {profile}")
}

#[test]
fn clicks_in_the_menu_of_the_session_change_the_text_mode_and_the_profile_of_the_run() {
    let Some(mut menu) = Menu::start() else {
        return;
    };
    menu.wait_for_run("a decoder", |other| {
        other.text_mode() == Some(TextMode::Literal)
    });
    menu.reader.wait_for("Ademán Studio");
    menu.click(&button("main"));
    let process = format!("Process {}", menu.other.run.id());
    menu.reader.wait_for(&process);
    for (mode, words) in [
        (TextMode::Suggest, "Offers candidates"),
        (TextMode::Auto, "Corrects words"),
        (TextMode::Literal, "Changes nothing"),
    ] {
        assert!(!menu.reader.wait_for(words).is_checked, "{words}");
        menu.click(words);
        menu.wait_for_run(words, |other| other.text_mode() == Some(mode));
        // The click has closed the menu.
        menu.click(&button("main"));
        menu.reader.wait_until(words, |button| button.is_checked);
    }
    assert!(menu.other.ctl("state").contains("profile    main"));
    menu.click("Next profile");
    menu.wait_for_run("the profile", |other| {
        other.ctl("state").contains("profile    arc")
    });
    menu.click(&button("arc"));
    menu.click("Next profile");
    menu.reader.wait_for(&button("main"));
    assert!(menu.other.ctl("state").contains("profile    main"));
}
