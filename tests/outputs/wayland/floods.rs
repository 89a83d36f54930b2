//! A compositor that does not read.

use std::time::{Duration, Instant};

use ademan::device::{EventKind, KeyCode};
use ademan::output::{Desktop, Sink};

use super::compositor::{Compositor, event};
use super::window::Window;
use crate::support::x11::{wait_at_most, wait_for};

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

/// More key presses than the buffers hold.
const FLOOD: usize = 20_000;

/// Presses and releases B. Returns the number of presses that were dropped: with new ones, or old ones that still waited.
fn flood(sink: &mut Desktop) -> usize {
    let before = sink.dropped_presses();
    for _ in 0..FLOOD {
        let press = [EventKind::KeyDown(key("B")), EventKind::KeyUp(key("B"))];
        sink.send(&press.map(event)).expect("no failure");
    }
    (sink.dropped_presses() - before) as usize
}

fn count(received: &[String], line: &str) -> usize {
    received.iter().filter(|received| *received == line).count()
}

#[test]
fn accepted_presses_arrive_once_and_no_release_is_lost() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    let mut sink = compositor.desktop();
    sink.send(&[event(EventKind::KeyDown(key("A")))])
        .expect("the queue has room");
    assert!(window.receives("down a"), "{:#?}", window.events());
    compositor.stop();
    let mut sent = 0;
    // Until the queue is full.
    let is_full = || {
        sent += FLOOD;
        flood(&mut sink) >= FLOOD
    };
    assert!(wait_for(is_full), "sent {sent} presses");
    let accepted = sent - sink.dropped_presses() as usize;
    sink.send(&[event(EventKind::KeyUp(key("A")))])
        .expect("the queue has room");
    compositor.resume();
    let received = window.events_until("up a");
    sink.close().expect("everything is sent");
    let counts = ["down a", "up a", "down b", "up b"].map(|line| count(&received, line));
    let [down_a, up_a, down_b, up_b] = counts;
    assert_eq!([down_a, up_a], [1, 1]);
    // A full queue makes the presses void that wait in it.
    assert!(down_b == up_b && down_b <= accepted, "{counts:?}");
    println!("accepted {accepted} of {sent} presses");
}

#[test]
fn keys_are_released_when_a_stopped_compositor_continues_and_presses_of_before_are_void() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(window) = Window::open(&compositor) else {
        return;
    };
    // A second keyboard, like the keyboard of the user.
    let mut other = compositor.desktop();
    let mut sink = compositor.desktop();
    sink.send(&[event(EventKind::KeyDown(key("A")))])
        .expect("the queue has room");
    assert!(window.receives("down a"), "{:#?}", window.events());
    compositor.stop();
    let drops = || {
        let press = [EventKind::KeyDown(key("B")), EventKind::KeyUp(key("B"))];
        sink.send(&press.map(event)).expect("it waits");
        sink.dropped_presses() > 0
    };
    assert!(wait_for(drops), "no press is dropped");
    // Longer than a press stays valid.
    std::thread::sleep(Duration::from_millis(500));
    let start = Instant::now();
    sink.close().expect_err("closing fails");
    assert!(
        start.elapsed() < Duration::from_secs(60),
        "it waits forever"
    );
    compositor.resume();
    let comes_up = || count(&window.events(), "up a") > 0;
    assert!(wait_at_most(Duration::from_secs(30), comes_up));
    assert_eq!(count(&window.events(), "down b"), 0);
    other.close().expect("nothing to send");
}
