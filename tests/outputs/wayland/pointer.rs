//! Pointer events in a window.

use ademan::device::{EventKind, KeyCode};
use ademan::output::Sink;

use super::compositor::{Compositor, event};
use super::window::Window;

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

/// Sends events and returns those that a full-screen window of 1024 × 768 pixels receives, up to `last`.
fn received(events: &[EventKind], last: &str) -> Option<Vec<String>> {
    let compositor = Compositor::sway()?;
    let window = Window::open(&compositor)?;
    let mut sink = compositor.desktop();
    // The window receives motion only while it has the pointer.
    sink.send(&[
        event(EventKind::MoveTo(0.5, 0.5)),
        event(EventKind::MoveBy(1, 0)),
    ])
    .expect("the queue has room");
    assert!(window.receives("move to 513,384"), "{:#?}", window.events());
    for kind in events {
        sink.send(&[event(*kind)]).expect("the queue has room");
    }
    let received = window.events_until(last);
    sink.close().expect("everything is sent");
    let first = received.iter().position(|line| line == "move to 513,384");
    let first = first.expect("the first motion");
    Some(received[first + 1..].to_vec())
}

#[test]
fn relative_and_absolute_motion_arrive() {
    let events = [
        EventKind::MoveBy(-13, 16),
        EventKind::MoveTo(0.25, 0.125),
        EventKind::MoveTo(1.0, 1.0),
        EventKind::MoveTo(0.0, 0.0),
        EventKind::MoveBy(3, 4),
    ];
    let Some(received) = received(&events, "move to 3,4") else {
        return;
    };
    let expected = [
        "move to 500,400",
        "move to 256,96",
        "move to 1023,767",
        "move to 0,0",
        "move to 3,4",
    ];
    let rounded: Vec<_> = received
        .iter()
        .map(|line| line.replace(".99609375", ""))
        .collect();
    assert_eq!(rounded, expected);
}

#[test]
fn buttons_and_a_drag_arrive() {
    let events = [
        EventKind::KeyDown(key("MouseLeft")),
        EventKind::MoveBy(20, 0),
        EventKind::MoveBy(0, 10),
        EventKind::KeyUp(key("MouseLeft")),
        EventKind::KeyDown(key("MouseRight")),
        EventKind::KeyUp(key("MouseRight")),
        EventKind::KeyDown(key("MouseMiddle")),
        EventKind::KeyUp(key("MouseMiddle")),
        EventKind::KeyDown(key("MouseBack")),
        EventKind::KeyUp(key("MouseBack")),
    ];
    let Some(received) = received(&events, "button 275 up") else {
        return;
    };
    let expected = [
        "button 272 down",
        "move to 533,384",
        "move to 533,394",
        "button 272 up",
        "button 273 down",
        "button 273 up",
        "button 274 down",
        "button 274 up",
        "button 275 down",
        "button 275 up",
    ];
    assert_eq!(received, expected);
}

#[test]
fn a_wheel_detent_arrives_as_a_detent() {
    let events = [
        EventKind::Scroll(0, 120),
        EventKind::Scroll(0, -360),
        EventKind::Scroll(240, 0),
        EventKind::Scroll(60, 0),
        EventKind::KeyDown(key("MouseLeft")),
        EventKind::KeyUp(key("MouseLeft")),
    ];
    let Some(received) = received(&events, "button 272 up") else {
        return;
    };
    let of_axis = |axis: &str| -> Vec<_> {
        let lines = received.iter().filter(|line| line.contains(axis));
        lines.cloned().collect()
    };
    let upright = [
        "clicks 0 by -1",
        "axis 0 by -15",
        "clicks 0 by 3",
        "axis 0 by 45",
    ];
    assert_eq!(of_axis(" 0 by "), upright, "{received:#?}");
    let across = ["clicks 1 by 2", "axis 1 by 30"];
    assert_eq!(of_axis(" 1 by "), across, "{received:#?}");
}
