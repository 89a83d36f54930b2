//! The log of key events that other tests rely on.

use std::thread;
use std::time::Duration;

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::{Desktop, Sink};
use ademan::time::Timestamp;
use x11rb::protocol::xproto::{ConnectionExt, GrabMode, GrabStatus};

use super::{arrives, repeat};
use crate::support::key_log::{Action, Input, KeyLog};
use crate::support::x11::{XServer, wait_for};

/// The number of presses that are shorter than any polling interval.
const SHORT_PRESSES: usize = 50;

fn event(kind: EventKind) -> OutputEvent {
    let time = Timestamp(0);
    OutputEvent { time, kind }
}

#[test]
fn the_log_has_every_short_press_and_marks_repeats_even_under_a_grab() {
    repeat(has_every_press);
}

/// Checks the log. Returns `false` if a busy machine has dropped a press.
fn has_every_press() -> bool {
    let Some(server) = XServer::start() else {
        return true;
    };
    let log = KeyLog::start(&server);
    let (grabbing_client, screen) =
        x11rb::connect(Some(server.display())).expect("the server answers");
    let root = x11rb::connection::Connection::setup(&grabbing_client).roots[screen].root;
    let mode = GrabMode::ASYNC;
    let grab = grabbing_client.grab_keyboard(true, root, x11rb::CURRENT_TIME, mode, mode);
    let grab = grab.expect("the server runs").reply();
    assert_eq!(grab.expect("a reply").status, GrabStatus::SUCCESS);

    let sink = Desktop::open(Some(server.display()), &Capabilities::default());
    let mut sink = sink.expect("the server runs");
    let key: KeyCode = "A".parse().expect("the name of a key");
    let [down, up] = [EventKind::KeyDown(key), EventKind::KeyUp(key)].map(event);
    let count = |action| {
        let events = log.events();
        events.iter().filter(|event| event.action == action).count()
    };
    let is_complete = (1..=SHORT_PRESSES)
        .all(|number| arrives(&mut sink, &[down, up], || count(Action::Release) == number));
    assert!(log.len() <= 2 * SHORT_PRESSES, "{:?}", log.events());
    assert_eq!(count(Action::Repeat), 0);
    if !is_complete {
        return false;
    }
    assert_eq!(count(Action::Press), SHORT_PRESSES);

    if !arrives(&mut sink, &[down], || count(Action::Repeat) >= 3) {
        return false;
    }
    assert_eq!(
        log.pressed().into_iter().collect::<Vec<_>>(),
        [Input::Key(38)]
    );
    let pressed_at = log.events()[2 * SHORT_PRESSES].time;
    thread::sleep(Duration::from_millis(50));
    sink.close().expect("everything is sent");
    assert!(wait_for(|| log.pressed().is_empty()));
    assert_eq!(count(Action::Press), SHORT_PRESSES + 1);
    let release = log.events().pop().expect("an event");
    assert!(release.time > pressed_at, "{release:?}");
    true
}
