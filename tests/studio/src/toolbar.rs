//! The toolbar: commands to the session, and panels that are hidden and shown.

use ademan::studio::texts::text;

use crate::picture;
use crate::window::Opening;

#[test]
fn a_click_on_pause_pauses_the_session_and_another_resumes_it() {
    let mut window = Opening::default().open();
    window.click(text("button-pause"));
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
    window.draw(1);
    window.click(text("button-resume"));
    window.wait_for("a running session", |model| {
        model.view.state.paused_by.is_none()
    });
}

#[test]
fn the_p_key_pauses_the_session() {
    let mut window = Opening::default().open();
    window.press_key(egui::Key::P);
    window.wait_for("a paused session", |model| {
        model.view.state.paused_by.is_some()
    });
}

#[test]
fn each_panel_is_hidden_and_shown() {
    let mut window = Opening::default().open();
    for (panel, content) in [
        (text("panel-sensors"), text("stats-accepted")),
        (text("panel-scope"), text("scope-hold")),
    ] {
        assert!(window.has(content), "{panel} is shown");
        for is_shown in [false, true] {
            window.toggle_in_menu(panel);
            assert_eq!(window.has(content), is_shown, "{panel}");
        }
    }
}

#[test]
fn the_whole_window_is_drawn() {
    let opening = Opening {
        readings: 900,
        // The latency that the picture shows is that of a hand in its own time.
        speed: Some(1.0),
        ..Opening::default()
    };
    picture::document(&mut opening.open(), "studio");
}
