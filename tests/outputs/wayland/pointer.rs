//! What a mouse does, in a window.

use ademan::device::{EventKind, KeyCode};
use ademan::output::Sink;

use super::compositor::{Compositor, event};
use super::window::Window;

fn key(name: &str) -> KeyCode {
    name.parse().expect("the name of a key")
}

/// What a window over the whole screen of 1024 by 768 hears of these actions, until `last`.
fn heard(actions: &[EventKind], last: &str) -> Option<Vec<String>> {
    let compositor = Compositor::sway()?;
    let window = Window::open(&compositor)?;
    let mut sink = compositor.desktop();
    // It hears of motion once the pointer is there.
    sink.send(&[
        event(EventKind::MoveTo(0.5, 0.5)),
        event(EventKind::MoveBy(1, 0)),
    ])
    .expect("there is room");
    assert!(window.hears("move to 513,384"), "{:#?}", window.heard());
    for action in actions {
        sink.send(&[event(*action)]).expect("there is room");
    }
    let heard = window.heard_until(last);
    sink.close().expect("it takes everything");
    let first = heard.iter().position(|line| line == "move to 513,384");
    let first = first.expect("it has been heard");
    Some(heard[first + 1..].to_vec())
}

#[test]
fn motion_by_a_way_and_to_a_place_arrives() {
    let actions = [
        EventKind::MoveBy(-13, 16),
        EventKind::MoveTo(0.25, 0.125),
        EventKind::MoveTo(1.0, 1.0),
        EventKind::MoveTo(0.0, 0.0),
        EventKind::MoveBy(3, 4),
    ];
    let Some(heard) = heard(&actions, "move to 3,4") else {
        return;
    };
    let expected = [
        "move to 500,400",
        "move to 256,96",
        "move to 1023,767",
        "move to 0,0",
        "move to 3,4",
    ];
    let rounded: Vec<_> = heard
        .iter()
        .map(|line| line.replace(".99609375", ""))
        .collect();
    assert_eq!(rounded, expected);
}

#[test]
fn buttons_and_a_drag_arrive() {
    let actions = [
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
    let Some(heard) = heard(&actions, "button 275 up") else {
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
    assert_eq!(heard, expected);
}

#[test]
fn a_click_of_the_wheel_arrives_as_a_click_of_the_wheel() {
    let actions = [
        EventKind::Scroll(0, 120),
        EventKind::Scroll(0, -360),
        EventKind::Scroll(240, 0),
        EventKind::Scroll(60, 0),
        EventKind::KeyDown(key("MouseLeft")),
        EventKind::KeyUp(key("MouseLeft")),
    ];
    let Some(heard) = heard(&actions, "button 272 up") else {
        return;
    };
    let of_axis = |axis: &str| -> Vec<_> {
        let lines = heard.iter().filter(|line| line.contains(axis));
        lines.cloned().collect()
    };
    let upright = [
        "clicks 0 by -1",
        "axis 0 by -15",
        "clicks 0 by 3",
        "axis 0 by 45",
    ];
    assert_eq!(of_axis(" 0 by "), upright, "{heard:#?}");
    let across = ["clicks 1 by 2", "axis 1 by 30"];
    assert_eq!(of_axis(" 1 by "), across, "{heard:#?}");
}
