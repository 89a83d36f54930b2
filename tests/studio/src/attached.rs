//! The window on the session of another program, through its control socket.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use ademan::command::{Command, TextMode};
use ademan::session::control_socket::{Client, WatchClient};
use ademan::session::{ControlSocket, Session, SessionHandle, SessionOptions};
use ademan::setup::{ProfileSetup, Setup};
use ademan::studio::attached::Attached;
use ademan::studio::model::StudioModel;
use ademan::studio::texts::{text, text_with};
use ademan::text::TextSetup;
use ademan::time::Timestamp;
use egui::accesskit::{Role, Toggled};
use egui_kittest::kittest::{NodeT, Queryable};
use tempfile::TempDir;

use crate::picture;
use crate::played_hand::PlayedHand;
use crate::window::{Opening, StudioWindow, TIMEOUT};

/// A session whose hand holds the key H, and a window of another one that shows it.
struct Attachment {
    window: StudioWindow,
    other: SessionHandle,
    socket: PathBuf,
    _folder: TempDir,
}

impl Attachment {
    fn open() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let socket = folder.path().join("c.sock");
        let other = start_other(&socket);
        let client = WatchClient::connect(&socket).expect("the session listens");
        let attached = Attached::new(client, &socket).expect("threads");
        let hand = quiet_hand();
        let window = Opening::default().open_with(Box::new(hand), |app| {
            app.with_attached(attached).expect("the session runs")
        });
        Self {
            window,
            other,
            socket,
            _folder: folder,
        }
    }

    /// Waits until the window shows the pressed key.
    fn wait_for_key(&mut self) {
        self.window.wait_for("the pressed key", |model| {
            let keys = &model.view.state.keys;
            keys.iter().any(|key| key.name() == "H") && model.poses.iter().any(Option::is_some)
        });
        self.window.draw(2);
    }

    /// Returns the state of the other session, as `ademan ctl state` does.
    fn state(&self) -> String {
        let mut client = Client::connect(&self.socket).expect("the session listens");
        client.request(r#"{"command":"state"}"#).expect("a state")
    }
}

/// Starts a session of a hand that presses a key and holds it.
fn start_other(socket: &Path) -> SessionHandle {
    let arc = ProfileSetup {
        name: "arc".into(),
        layout: "qwerty-arc".into(),
        text: None,
    };
    let setup = Setup {
        source: "script:press H; wait 600000".parse().ok(),
        output: "none".into(),
        profiles: vec![arc],
        text: Some(TextSetup::default()),
        ..Setup::default()
    };
    let options = SessionOptions {
        speed: Some(1.0),
        control_socket: ControlSocket::Path(socket.to_owned()),
        report_status: true,
        ..SessionOptions::default()
    };
    let setup = setup.load_files().expect("the files of the setup");
    let other = Session::start(setup, options).expect("the session starts");
    assert!(other.wait_until_started());
    other
}

/// Returns the hand of the session behind the window, which does nothing.
fn quiet_hand() -> PlayedHand {
    let setup = Opening::default().setup.load_files().expect("a setup");
    PlayedHand::new(&setup, Arc::default()).expect("a hand for the layout")
}

#[test]
fn the_hand_and_the_keys_of_another_session_are_shown() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    let window = &mut attachment.window;
    assert!(window.has(&name_with("main")), "the toolbar names it");
    let model = window.model();
    let pressed = model.view.state.pressed.first().expect("a target");
    assert!(model.contact_with(*pressed).expect("a contact").is_pressed);
    assert!(model.world_from_board(0).is_some());
    assert!(model.stats.accepted > 0);
    assert!(model.history.events().any(|event| event.is_press));
    assert!(window.has(text("attached-sensors")));
    for own in ["workspace-calibration", "menu-devices", "menu-open"] {
        assert!(!window.has(text(own)), "{own} is for an own session");
    }
    window.press_key(egui::Key::Num1);
    picture::draw(window, "attached");
}

/// Returns the words of the menu of the session, whose first layout is `qwerty-flat`, in this profile.
fn name_with(profile: &str) -> String {
    let session = format!("qwerty-flat · {profile}");
    text_with("attached-name", &[("session", session.into())])
}

#[test]
fn the_menu_of_the_session_names_its_process_and_changes_profile_and_text_mode() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    let window = &mut attachment.window;
    window.click(&name_with("main"));
    let process = std::process::id().to_string();
    assert!(window.has(&text_with(
        "attached-process",
        &[("process", process.into())]
    )));
    picture::draw(window, "attached-menu");
    window.click(text("attached-next-profile"));
    window.wait_for("the other profile", |model| {
        model.view.state.profile == "arc" && model.view.state.keys.is_empty()
    });
    window.draw(2);
    for (mode, words) in [
        (TextMode::Suggest, "attached-suggest"),
        (TextMode::Auto, "attached-auto"),
        (TextMode::Literal, "attached-literal"),
    ] {
        window.click(&name_with("arc"));
        window.click(text(words));
        window.wait_for(words, |model| model.view.state.text_mode == Some(mode));
        window.draw(2);
        window.click(&name_with("arc"));
        let radio = window
            .harness
            .get_by_role_and_label(Role::RadioButton, text(words));
        let is_chosen = radio.accesskit_node().toggled() == Some(Toggled::True);
        assert!(is_chosen, "{words}");
        window.press_key(egui::Key::Escape);
    }
}

#[test]
fn pause_and_resume_go_to_the_other_session() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    assert!(attachment.state().contains(r#""paused":false"#));
    attachment.window.click(text("button-pause"));
    attachment.window.wait_for("a pause", |model| {
        model.view.state.paused_by.is_some() && model.view.state.keys.is_empty()
    });
    assert_last_state(attachment.window.model());
    let state = attachment.state();
    assert!(state.contains(r#""paused_by":"command""#), "{state}");
    attachment.window.draw(1);
    attachment.window.click(text("button-resume"));
    attachment
        .window
        .wait_for("no pause", |model| model.view.state.paused_by.is_none());
    assert!(attachment.state().contains(r#""paused":false"#));
}

/// Checks that the hand, the time and the presses of a session are there that sends no hand any more.
fn assert_last_state(model: &StudioModel) {
    assert!(model.poses.iter().any(Option::is_some));
    assert!(model.world_from_board(0).is_some());
    assert!(model.view.state.time_us > Timestamp(0));
    assert!(model.history.moments().count() > 1);
    assert!(model.history.events().any(|event| event.is_press));
}

#[test]
fn the_scope_has_no_rows_for_what_is_not_sent() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    let window = &mut attachment.window;
    assert!(!window.is_enabled(text("scope-angles")));
    window.click(text("scope-rows"));
    for (name, is_enabled) in [("scope-heights", true), ("scope-latency", false)] {
        let row = window
            .harness
            .get_by_role_and_label(Role::CheckBox, text(name));
        assert_eq!(!row.accesskit_node().is_disabled(), is_enabled, "{name}");
    }
}

#[test]
fn the_reason_of_a_refused_command_is_shown() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    attachment.window.click(text("button-zero"));
    let has_reason = |window: &StudioWindow| window.has_words("! a key is down");
    attachment.window.draw_until("the reason", has_reason);
}

#[test]
fn the_end_of_the_other_session_is_shown() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    let commands = attachment.other.commands();
    commands.send(Command::Stop).expect("it runs");
    let window = &mut attachment.window;
    window.wait_for("the end", |model| model.has_ended);
    window.draw(2);
    assert!(window.has(text("message-ended")));
    assert_last_state(window.model());
    assert!(!window.is_enabled(text("button-pause")));
}

#[test]
fn the_other_session_goes_on_when_the_window_is_closed() {
    let mut attachment = Attachment::open();
    attachment.wait_for_key();
    let Attachment {
        window,
        other,
        socket,
        _folder,
    } = attachment;
    drop(window);
    let mut client = Client::connect(&socket).expect("the session listens");
    let state = client.request(r#"{"command":"state"}"#).expect("a state");
    assert!(state.contains(r#""state":"running""#), "{state}");
    let viewer = other.add_viewer();
    let view = viewer.views().recv_timeout(TIMEOUT);
    let view = view.expect("the session runs");
    assert_eq!(view.state.keys.len(), 1, "the key is held");
}
