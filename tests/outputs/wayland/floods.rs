//! A compositor that does not read for a while.

use std::time::{Duration, Instant};

use ademan::device::{EventKind, KeyCode};
use ademan::output::{Desktop, Sink};

use super::compositor::{Compositor, event};
use super::window::Window;
use crate::support::x11::{wait_at_most, wait_for};

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

/// Far more than what fits between the two.
const FLOOD: usize = 20_000;

/// Presses and releases B many times; how often the press was taken.
fn flood(sink: &mut Desktop) -> usize {
    let before = sink.dropped_presses();
    for _ in 0..FLOOD {
        let stroke = [EventKind::KeyDown(key("B")), EventKind::KeyUp(key("B"))];
        sink.send(&stroke.map(event)).expect("it does not fail");
    }
    FLOOD - (sink.dropped_presses() - before) as usize
}

fn count(heard: &[String], line: &str) -> usize {
    heard.iter().filter(|heard| *heard == line).count()
}

#[test]
fn what_was_taken_arrives_once_and_no_release_is_lost() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    let mut sink = compositor.desktop();
    sink.send(&[event(EventKind::KeyDown(key("A")))])
        .expect("room");
    assert!(window.hears("down a"), "{:#?}", window.heard());
    compositor.stop();
    let mut taken = flood(&mut sink);
    // Until nothing more goes through, and nothing has been lost yet.
    let is_full = || {
        let more = flood(&mut sink);
        taken += more;
        more == 0
    };
    assert!(wait_for(is_full), "{taken} strokes were taken");
    sink.send(&[event(EventKind::KeyUp(key("A")))])
        .expect("room");
    compositor.go_on();
    let heard = window.heard_until("up a");
    sink.close().expect("it takes everything");
    let counts = ["down a", "up a", "down b", "up b"].map(|line| count(&heard, line));
    assert_eq!(
        counts,
        [1, 1, taken, taken],
        "refused: {}",
        sink.dropped_presses()
    );
    println!(
        "{taken} of {} strokes were taken",
        taken + sink.dropped_presses() as usize
    );
}

#[test]
fn a_compositor_that_does_not_come_back_is_an_error_and_what_is_down_comes_up_when_it_does() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    // Another keyboard, as that of the user.
    let mut other = compositor.desktop();
    let mut sink = compositor.desktop();
    sink.send(&[event(EventKind::KeyDown(key("A")))])
        .expect("room");
    assert!(window.hears("down a"), "{:#?}", window.heard());
    compositor.stop();
    let mut error = None;
    let fails = || {
        let strokes = [EventKind::KeyDown(key("B")), EventKind::KeyUp(key("B"))];
        error = sink.send(&strokes.map(event)).err();
        error.is_some()
    };
    assert!(wait_for(fails), "it goes on");
    let error = error.expect("it has come").to_string();
    assert!(error.contains("it does not read"), "{error}");
    let start = Instant::now();
    sink.close().expect_err("it cannot say that all is well");
    assert!(
        start.elapsed() < Duration::from_secs(60),
        "it waits forever"
    );
    compositor.go_on();
    let comes_up = || count(&window.heard(), "up a") > 0;
    assert!(wait_at_most(Duration::from_secs(30), comes_up));
    other.close().expect("it has nothing to do");
}
