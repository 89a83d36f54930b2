//! The mouse as a fingertip in the 3D view: a person presses keys and drags controls without a hand.

use ademan::contact::TargetId;
use ademan::hand::Side;
use ademan::studio::settings::CameraPlace;
use ademan::studio::texts::text;
use egui::{Event, Modifiers, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase};

use crate::picture;
use crate::window::{Opening, StudioWindow};

/// Opens the 3D view of a layout alone, and lets the mouse be a fingertip.
fn open(layout: &str) -> StudioWindow {
    let opening = Opening {
        readings: 20,
        size: [1000.0, 600.0],
        ..Opening::on_layout(layout)
    };
    let mut window = opening.open();
    window.show_space_only();
    window.toggle_in_menu(text("button-fingertip"));
    wait_for_boards(&mut window);
    window.press_key(egui::Key::Num1);
    window
}

/// Waits for the boards under the hand of the mouse.
fn wait_for_boards(window: &mut StudioWindow) {
    window.wait_for("the hand of the mouse", |model| {
        model.view.state.source == "mouse" && model.world_from_board(0).is_some()
    });
}

/// Returns the point of the window at which a point of a front is shown, which is to the right of its middle along it, in metres.
fn place(window: &mut StudioWindow, target: TargetId, right: f32) -> Pos2 {
    let area = window.rect_of(text("panel-space"));
    let name = window.model().view.layout.name.clone();
    let settings = window.harness.state_mut().settings();
    let camera = settings.camera_for(&name).expect("the camera is placed");
    let model = window.model();
    let surface = &model.view.layout.scene.surfaces()[0];
    let front = surface.target(target).expect("a target of the board");
    let board = model.world_from_board(0).expect("the board has a place");
    let on_board = front
        .surface_from_target
        .transform_point([right, 0.0, 0.0].into());
    let point = board.transform_point(on_board);
    let shown = camera.project(point, [area.width(), area.height()].into());
    let shown = shown.expect("it is before the eye").position;
    area.min + egui::vec2(shown.x, shown.y)
}

fn camera(window: &mut StudioWindow) -> CameraPlace {
    let settings = window.harness.state_mut().settings();
    settings.camera.clone().expect("the camera is placed")
}

/// Waits until the trail of the finger has faded.
fn rest(window: &mut StudioWindow) {
    let time = |window: &StudioWindow| {
        let pose = window.model().poses[Side::Right.index()];
        pose.expect("the hand of the mouse").time
    };
    let start = time(window);
    window.draw_until("a hand at rest", |window| {
        time(window).since(start).as_secs_f32() > 1.5
    });
}

fn key(window: &StudioWindow, name: &str) -> TargetId {
    let layout = &window.model().view.layout;
    layout.key(name).expect("a key").face.target
}

/// Returns the second fader of the mixer.
fn fader(window: &StudioWindow) -> TargetId {
    let controls = &window.model().view.layout.controls;
    let mut faces = controls.iter().flat_map(|control| &control.faces);
    let face = faces.find(|face| face.name == "Fader 2");
    face.expect("a fader").target
}

fn move_to(window: &mut StudioWindow, at: Pos2) {
    window.harness.event(Event::PointerMoved(at));
    window.draw(2);
}

fn button(window: &mut StudioWindow, pos: Pos2, pressed: bool) {
    button_with(window, pos, pressed, Modifiers::NONE);
}

fn button_with(window: &mut StudioWindow, pos: Pos2, pressed: bool, modifiers: Modifiers) {
    let event = Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers,
    };
    window.harness.event_modifiers(event, modifiers);
    window.draw(2);
}

fn press(window: &mut StudioWindow, at: Pos2) {
    move_to(window, at);
    button(window, at, true);
}

fn is_pressed(window: &StudioWindow, target: TargetId) -> bool {
    let contact = window.model().contact_with(target);
    contact.is_some_and(|contact| contact.is_pressed)
}

/// Presses a key and holds the button.
fn hold(window: &mut StudioWindow, name: &str) -> (TargetId, Pos2) {
    let target = key(window, name);
    let at = place(window, target, 0.0);
    press(window, at);
    window.draw_until("a press", |window| is_pressed(window, target));
    (target, at)
}

#[test]
fn a_click_types_the_key_under_the_mouse_and_the_session_does_not() {
    let mut window = open("qwerty-flat");
    for name in ["G", "O"] {
        let (target, at) = hold(&mut window, name);
        button(&mut window, at, false);
        window.draw_until("a release", |window| !is_pressed(window, target));
    }
    window.draw_until("the text", |window| window.has("go"));
    picture::draw(&mut window, "fingertip-keyboard");
    window.toggle_in_menu(text("button-fingertip"));
    let model = window.model();
    assert_ne!(model.view.state.source, "mouse");
    assert_eq!(model.view.state.typed, "", "the session has other hands");
}

#[test]
fn a_dragged_fader_has_the_value_under_the_mouse() {
    let mut window = open("mixer");
    let fader = fader(&window);
    let at = place(&mut window, fader, -0.02);
    press(&mut window, at);
    window.draw_until("a touch", |window| {
        window.model().contact_with(fader).is_some()
    });
    let before = camera(&mut window);
    for step in 1..=4_u8 {
        let at = place(&mut window, fader, -0.02 + 0.01 * f32::from(step));
        move_to(&mut window, at);
    }
    let value = |window: &StudioWindow| window.model().values.get(&fader).copied();
    window.draw_until("a higher value", |window| {
        value(window).is_some_and(|value| value > 0.5)
    });
    assert_eq!(camera(&mut window), before, "the camera stays");
    rest(&mut window);
    let view = window.panel(text("panel-space"));
    picture::compare(&mut window, "studio-fingertip", view);
    let at = place(&mut window, fader, 0.02);
    button(&mut window, at, false);
    window.draw_until("a release", |window| {
        window.model().contact_with(fader).is_none()
    });
    assert!(value(&window).is_some_and(|value| value > 0.5));
}

#[test]
fn the_other_hand_of_the_person_rests_beside_the_board_and_touches_nothing() {
    let mut window = open("mixer");
    let resting = |window: &StudioWindow| window.model().resting.expect("the other hand");
    let before = resting(&window);
    assert_eq!(before.side, Side::Left);
    let fader = fader(&window);
    let at = place(&mut window, fader, 0.0);
    press(&mut window, at);
    window.draw_until("a touch", |window| {
        window.model().contact_with(fader).is_some()
    });
    let after = resting(&window);
    assert!(before.known().eq(after.known()), "it keeps still");
    let model = window.model();
    assert!(model.poses[Side::Left.index()].is_none());
    assert!(
        model.contacts[Side::Left.index()]
            .iter()
            .all(Option::is_none)
    );
    button(&mut window, at, false);
    window.toggle_in_menu(text("button-fingertip"));
    assert!(window.model().resting.is_none(), "the session has one hand");
}

#[test]
fn a_setup_with_two_hands_shows_its_own() {
    let window = open("qwerty-two-flat");
    let model = window.model();
    assert!(model.resting.is_none());
    assert!(model.poses.iter().all(Option::is_some));
}

#[test]
fn a_finger_lifts_when_the_mouse_leaves_the_view() {
    let mut window = open("qwerty-flat");
    let (target, at) = hold(&mut window, "G");
    let toolbar = window.rect_of(text("menu-view")).center();
    move_to(&mut window, toolbar);
    window.draw_until("a release", |window| !is_pressed(window, target));
    // The button is still down.
    move_to(&mut window, at);
    rest(&mut window);
    assert!(!is_pressed(&window, target));
    button(&mut window, at, false);
    hold(&mut window, "G");
}

#[test]
fn a_finger_lifts_when_the_window_loses_the_focus_or_the_mouse() {
    let mut window = open("qwerty-flat");
    let (target, at) = hold(&mut window, "G");
    window.harness.event(Event::PointerGone);
    window.draw_until("a release", |window| !is_pressed(window, target));
    button(&mut window, at, false);
    let (target, _) = hold(&mut window, "H");
    window.harness.input_mut().focused = false;
    window.draw_until("a release", |window| !is_pressed(window, target));
}

#[test]
fn another_layout_has_a_finger_that_is_up() {
    let mut window = open("qwerty-flat");
    let (_, at) = hold(&mut window, "G");
    let changed = format!("{}// changed\n", window.model().view.layout.text);
    window.change_layout(&changed);
    window.wait_for("the changed layout", |model| {
        model.view.layout.text == changed && model.view.state.source == "mouse"
    });
    wait_for_boards(&mut window);
    rest(&mut window);
    let model = window.model();
    assert!(model.contacts.iter().flatten().all(Option::is_none));
    assert_eq!(model.view.state.typed, "");
    button(&mut window, at, false);
}

#[test]
fn a_drag_beside_the_board_or_with_shift_moves_the_camera() {
    let mut window = open("qwerty-flat");
    let before = camera(&mut window);
    let area = window.rect_of(text("panel-space"));
    let beside = area.min + egui::vec2(20.0, 20.0);
    press(&mut window, beside);
    move_to(&mut window, beside + egui::vec2(60.0, 10.0));
    button(&mut window, beside, false);
    let turned = camera(&mut window);
    assert_ne!(turned, before);
    let target = key(&window, "G");
    let at = place(&mut window, target, 0.0);
    move_to(&mut window, at);
    button_with(&mut window, at, true, Modifiers::SHIFT);
    move_to(&mut window, at + egui::vec2(60.0, 10.0));
    button(&mut window, at, false);
    assert_ne!(camera(&mut window), turned);
    assert!(
        window
            .model()
            .contacts
            .iter()
            .flatten()
            .all(Option::is_none)
    );
}

/// Returns the events of a finger on a touch screen.
fn touch(finger: u64, phase: TouchPhase, pos: Pos2) -> Event {
    Event::Touch {
        device_id: TouchDeviceId(7),
        id: TouchId(finger),
        phase,
        pos,
        force: None,
    }
}

/// Returns the events that egui-winit makes of the first finger on a touch screen, which is also the pointer.
fn first_finger(phase: TouchPhase, pos: Pos2) -> Vec<Event> {
    let button = |pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let as_pointer = match phase {
        TouchPhase::Start => vec![Event::PointerMoved(pos), button(true)],
        TouchPhase::Move => vec![Event::PointerMoved(pos)],
        TouchPhase::End => vec![button(false), Event::PointerGone],
        TouchPhase::Cancel => vec![Event::PointerGone],
    };
    [vec![touch(1, phase, pos)], as_pointer].concat()
}

/// Sends events for the same frame, and draws it.
fn send(window: &mut StudioWindow, events: impl IntoIterator<Item = Event>) {
    window.harness.input_mut().events.extend(events);
    window.draw(1);
}

/// Touches a key with the first finger and waits until it is pressed.
fn touch_key(window: &mut StudioWindow, name: &str) -> (TargetId, Pos2) {
    let target = key(window, name);
    let at = place(window, target, 0.0);
    send(window, first_finger(TouchPhase::Start, at));
    window.draw_until("a press", |window| is_pressed(window, target));
    (target, at)
}

#[test]
fn a_touch_presses_a_key_until_it_ends() {
    let mut window = open("qwerty-flat");
    let before = camera(&mut window);
    for name in ["G", "O"] {
        let (target, at) = touch_key(&mut window, name);
        send(&mut window, first_finger(TouchPhase::End, at));
        window.draw_until("a release", |window| !is_pressed(window, target));
    }
    window.draw_until("the text", |window| window.has("go"));
    assert_eq!(camera(&mut window), before, "the camera stays");
}

#[test]
fn a_tap_that_is_shorter_than_the_way_of_the_finger_types_its_key() {
    let mut window = open("qwerty-flat");
    for name in ["G", "O"] {
        let target = key(&window, name);
        let at = place(&mut window, target, 0.0);
        send(&mut window, first_finger(TouchPhase::Start, at));
        send(&mut window, first_finger(TouchPhase::End, at));
        rest(&mut window);
    }
    // The finger comes and goes between two frames.
    let target = key(&window, "D");
    let at = place(&mut window, target, 0.0);
    let tap = [TouchPhase::Start, TouchPhase::End].map(|phase| first_finger(phase, at));
    send(&mut window, tap.concat());
    rest(&mut window);
    let model = window.model();
    assert_eq!(model.view.state.typed, "god");
    assert!(model.contacts.iter().flatten().all(Option::is_none));
}

#[test]
fn a_cancelled_touch_releases_its_key_and_the_next_one_presses_again() {
    let mut window = open("qwerty-flat");
    let before = camera(&mut window);
    let (target, at) = touch_key(&mut window, "G");
    // A second finger makes it a gesture of the desktop.
    send(&mut window, [touch(2, TouchPhase::Start, at)]);
    send(&mut window, [touch(2, TouchPhase::Cancel, at)]);
    send(&mut window, first_finger(TouchPhase::Cancel, at));
    window.draw_until("a release", |window| !is_pressed(window, target));
    rest(&mut window);
    assert!(!is_pressed(&window, target));
    let (target, at) = touch_key(&mut window, "H");
    send(&mut window, first_finger(TouchPhase::End, at));
    window.draw_until("a release", |window| !is_pressed(window, target));
    assert_eq!(camera(&mut window), before, "the camera stays");
}

#[test]
fn a_touch_that_is_cancelled_before_the_next_picture_presses_nothing() {
    let mut window = open("qwerty-flat");
    let target = key(&window, "G");
    let at = place(&mut window, target, 0.0);
    let phases = [TouchPhase::Start, TouchPhase::Cancel].map(|phase| first_finger(phase, at));
    send(&mut window, phases.concat());
    rest(&mut window);
    let model = window.model();
    assert_eq!(model.view.state.typed, "");
    assert!(model.contacts.iter().flatten().all(Option::is_none));
}

#[test]
fn a_touch_drags_a_fader_and_leaves_its_value_when_it_ends() {
    let mut window = open("mixer");
    let fader = fader(&window);
    let before = camera(&mut window);
    let from = place(&mut window, fader, -0.02);
    send(&mut window, first_finger(TouchPhase::Start, from));
    window.draw_until("a touch", |window| {
        window.model().contact_with(fader).is_some()
    });
    for step in 1..=4_u8 {
        let at = place(&mut window, fader, -0.02 + 0.01 * f32::from(step));
        send(&mut window, first_finger(TouchPhase::Move, at));
    }
    let value = |window: &StudioWindow| window.model().values.get(&fader).copied();
    window.draw_until("a higher value", |window| {
        value(window).is_some_and(|value| value > 0.5)
    });
    rest(&mut window);
    let dragged = value(&window).expect("a value");
    let at = place(&mut window, fader, 0.02);
    send(&mut window, first_finger(TouchPhase::End, at));
    window.draw_until("a release", |window| {
        window.model().contact_with(fader).is_none()
    });
    // The fingertip tilts a little as it lifts.
    let left = value(&window).expect("a value");
    assert!((left - dragged).abs() < 0.01, "{dragged} became {left}");
    assert_eq!(camera(&mut window), before, "the camera stays");
}

#[test]
fn a_second_finger_presses_nothing_while_the_first_one_holds_a_key_and_after_it() {
    let mut window = open("qwerty-flat");
    let (target, at) = touch_key(&mut window, "G");
    let other = key(&window, "K");
    let beside = place(&mut window, other, 0.0);
    send(&mut window, [touch(2, TouchPhase::Start, beside)]);
    rest(&mut window);
    assert!(is_pressed(&window, target) && !is_pressed(&window, other));
    send(&mut window, first_finger(TouchPhase::End, at));
    window.draw_until("a release", |window| !is_pressed(window, target));
    // The pointer is with the finger that is left, which moves.
    let moved = [
        touch(2, TouchPhase::Move, beside),
        Event::PointerMoved(beside),
    ];
    send(&mut window, moved);
    rest(&mut window);
    assert!(!is_pressed(&window, other));
    let lifted = Event::PointerButton {
        pos: beside,
        button: PointerButton::Primary,
        pressed: false,
        modifiers: Modifiers::NONE,
    };
    let ended = [
        touch(2, TouchPhase::End, beside),
        lifted,
        Event::PointerGone,
    ];
    send(&mut window, ended);
    rest(&mut window);
    let model = window.model();
    assert!(model.contacts.iter().flatten().all(Option::is_none));
    assert_eq!(model.view.state.typed, "g");
}
