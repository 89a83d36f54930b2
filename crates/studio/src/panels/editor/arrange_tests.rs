//! The editor in a window without a display: several controls are scaled by a frame, and repeated along an arc.

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, Pos2, Vec2, vec2};

use super::tests::{TWO_KEYS, Window};
use super::*;
use crate::canvas::group;

const ARC: &str = "Layout(name: \"Arc\", boards: [(
        pose: (anchor: elbow, forward_mm: 320), shape: Arc(radius_mm: 320),
        rows: [(at_mm: (0, 0), keys: \"A B C\")],
    )])";

/// Opens the board with an arc, of which the canvas shows the right part.
fn on_arc() -> Window {
    let mut window = Window::on_text(ARC, 700.0);
    window.panel().viewport = AreaViewport::fixed(Viewport {
        center: parry3d::math::Vec2::new(20.0, 0.0),
        scale: 5.0,
    });
    window.harness.run_steps(2);
    window
}

/// Returns the right far corner of the frame around both keys, on the screen.
fn far_corner(window: &mut Window) -> Pos2 {
    let panel = window.panel();
    let frame = group::frame(&panel.items.items, &panel.selected).unwrap();
    let [_, _, at, _] = group::handles(frame, 5.0);
    window.at(at.x, at.y)
}

/// Presses at a point and moves the mouse, in points.
fn start_drag(window: &mut Window, from: Pos2, by: Vec2) -> Pos2 {
    window.event(Event::PointerMoved(from));
    window.button(from, true);
    for part in [0.3, 0.6, 1.0] {
        window.event(Event::PointerMoved(from + by * part));
    }
    from + by
}

/// Opens the menu of the repetitions, which has its size after some frames.
fn open_repetitions(window: &mut Window) {
    window.click_button(text("editor-repeat"));
    window.harness.run_steps(3);
}

#[test]
fn a_corner_of_the_frame_scales_all_selected_keys_in_one_step_of_undo() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    let from = far_corner(&mut window);
    // The frame is 57 mm wide and 17 mm deep: twice as wide, and half as deep again to the grid of 1 mm.
    let end = start_drag(&mut window, from, vec2(57.0, -8.4) * 5.0);
    assert_eq!(window.text(), TWO_KEYS, "a preview");
    window.button(end, false);
    let scaled = TWO_KEYS
        .replace("(0, 0)", "(8.5, 4), size_mm: Box(34, 25)")
        .replace("(40, 0)", "(88.5, 4), size_mm: Box(34, 25)");
    assert_eq!(window.text(), scaled);
    assert_eq!(window.panel().selected.len(), 2, "still selected");
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), TWO_KEYS, "one step of undo");
}

#[test]
fn escape_cancels_a_drag_of_the_frame_and_of_a_key() {
    let mut window = Window::open();
    window.press(Modifiers::COMMAND, Key::A);
    for is_frame in [true, false] {
        let from = if is_frame {
            far_corner(&mut window)
        } else {
            window.at(0.0, 0.0)
        };
        let end = start_drag(&mut window, from, vec2(100.0, -60.0));
        assert!(!window.panel().preview.shapes.is_empty());
        window.press(Modifiers::NONE, Key::Escape);
        assert_eq!(window.panel().preview, Preview::default());
        window.event(Event::PointerMoved(end + vec2(20.0, 0.0)));
        window.button(end, false);
        assert_eq!(window.text(), TWO_KEYS);
        assert_eq!(window.panel().selected.len(), 2, "still selected");
    }
    window.press(Modifiers::NONE, Key::Escape);
    assert!(window.panel().selected.is_empty());
}

#[test]
fn keys_of_an_arc_are_scaled_along_it() {
    let mut window = on_arc();
    window.press(Modifiers::COMMAND, Key::A);
    let from = far_corner(&mut window);
    let end = start_drag(&mut window, from, vec2(55.0, 0.0) * 5.0);
    window.button(end, false);
    let row = "at_mm: (8.5, 0), keys: \"A B C\", size_mm: Box(34, 17), pitch_mm: 38";
    let expected = ARC.replace("at_mm: (0, 0), keys: \"A B C\"", row);
    assert_eq!(window.text(), expected);
}

#[test]
fn a_click_on_the_handle_of_a_bend_changes_nothing_and_a_drag_bends() {
    let mut window = on_arc();
    let handle = canvas::bend_handle(window.panel()).unwrap();
    let beside = window.at(handle.x, handle.y) + vec2(3.0, 3.0);
    window.click(beside);
    assert_eq!(window.text(), ARC);
    start_drag(&mut window, beside, vec2(0.0, 40.0));
    window.event(Event::PointerMoved(beside));
    window.button(beside, false);
    assert_eq!(window.text(), ARC, "a drag that returns");
    let end = start_drag(&mut window, beside, vec2(0.0, 40.0));
    window.button(end, false);
    let bent = window.text();
    assert_ne!(bent, ARC);
    assert!(!bent.contains("radius_mm: 320"), "{bent}");
}

#[test]
fn a_bend_ends_at_its_release_near_the_handle_too_when_few_frames_are_drawn() {
    let [slow, smooth] = [false, true].map(|is_smooth| {
        let mut window = on_arc();
        let handle = canvas::bend_handle(window.panel()).unwrap();
        let from = window.at(handle.x, handle.y);
        start_drag(&mut window, from, vec2(0.0, 40.0));
        let end = from + vec2(0.0, 8.0);
        if is_smooth {
            window.event(Event::PointerMoved(end));
        }
        window.button(end, false);
        window.text()
    });
    assert_ne!(smooth, ARC);
    assert_eq!(slow, smooth);
}

#[test]
fn a_key_is_repeated_along_an_arc_from_the_menu_in_one_step_of_undo() {
    let mut window = Window::open();
    window.click_board(0.0);
    open_repetitions(&mut window);
    for (name, number) in [
        ("editor-arc-count", "3"),
        ("editor-arc-radius", "100"),
        ("editor-arc-step", "90"),
    ] {
        window.click_field(Role::SpinButton, text(name));
        window.write(number);
        window.press(Modifiers::NONE, Key::Enter);
    }
    window.click_button(text("editor-repeat-arc"));
    let written = window.text();
    for copy in [
        "name: \"A 2\", at_mm: (100, -100), rotation_deg: (0, 0, -90)",
        "name: \"A 3\", at_mm: (0, -200), rotation_deg: (0, 0, -180)",
    ] {
        assert!(written.contains(copy), "{written}");
    }
    assert_eq!(window.panel().selected.len(), 3);
    window.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(window.text(), TWO_KEYS, "one step of undo");
}

#[test]
fn copies_beyond_the_picture_are_shown() {
    let mut window = Window::open();
    window.click_board(0.0);
    open_repetitions(&mut window);
    window.click_field(Role::SpinButton, text("editor-columns"));
    window.write("40");
    window.press(Modifiers::NONE, Key::Enter);
    window.click_button(text("editor-repeat-now"));
    window.harness.run_steps(2);
    let panel = window.panel();
    assert_eq!(panel.selected.len(), 40);
    let copies = panel.selected_bounds().unwrap();
    let seen = panel.viewport.visible(panel.canvas_size).unwrap();
    let is_seen = seen.min.cmple(copies.min).all() && seen.max.cmpge(copies.max).all();
    assert!(is_seen, "{copies:?} in {seen:?}");
}

#[test]
fn the_proposed_angle_keeps_the_gap_of_a_row_at_the_near_corners() {
    let one_key = TWO_KEYS.replace("                (code: \"B\", at_mm: (40, 0)),\n", "");
    let mut window = Window::on_text(&one_key, 700.0);
    window.click_board(20.0);
    open_repetitions(&mut window);
    // 19 mm on a circle of 80 mm without half a key of 17 mm.
    assert_eq!(window.panel().repeat.arc_step_deg, 15.0);
    window.click_button(text("editor-repeat-arc"));
    let layout = window.panel().editor.layout().cloned().unwrap();
    assert_eq!(layout.keys.len(), 3);
    assert!(window.panel().editor.is_valid(), "no copies overlap");
}
