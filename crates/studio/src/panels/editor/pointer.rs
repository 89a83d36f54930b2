//! The presses and releases of the primary button on a canvas. On a slow machine, several of them and movements come with one frame.

use eframe::egui::{self, Event, Modifiers, PointerButton, Pos2, Rect, Response, TouchPhase};
use parry3d::math::Vec2;

/// Longest way of a click, in points, as in egui.
const CLICK_REACH: f32 = 6.0;

/// A press or a release.
pub(super) struct ButtonChange {
    /// The point of it: the mouse may have moved on by the end of the frame.
    pub at: Pos2,
    pub is_pressed: bool,
    pub modifiers: Modifiers,
}

/// Returns the presses and releases since the last frame, without what precedes the cancellation of a touch.
pub(super) fn changes(ui: &egui::Ui) -> Vec<ButtonChange> {
    let change = |event: &Event| match *event {
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        } => Some(ButtonChange {
            at: pos,
            is_pressed: pressed,
            modifiers,
        }),
        _ => None,
    };
    ui.input(|input| {
        let cancelled = input.events.iter().rposition(is_cancel);
        let events = input
            .events
            .iter()
            .skip(cancelled.map_or(0, |index| index + 1));
        events.filter_map(change).collect()
    })
}

/// Returns `true` while a button is down, and in the frame of its release.
pub(super) fn is_held(ui: &egui::Ui) -> bool {
    ui.input(|input| input.pointer.any_down() || input.pointer.any_released())
}

/// Returns the area that a canvas shows. While a button is held, it has the last size: a panel beside the canvas that becomes wider does
/// not move what is dragged.
pub(super) fn steady_area(area: Rect, last: Option<Vec2>, is_held: bool) -> Rect {
    match last {
        Some(size) if is_held => Rect::from_min_size(area.min, egui::vec2(size.x, size.y)),
        _ => area,
    }
}

/// Returns the position of the mouse on a canvas or, during a drag, anywhere.
pub(super) fn position(ui: &egui::Ui, response: &Response, is_dragging: bool) -> Option<Pos2> {
    let anywhere = || ui.input(|input| input.pointer.latest_pos());
    let on_canvas = response.interact_pointer_pos().or(response.hover_pos());
    on_canvas.or_else(|| is_dragging.then(anywhere).flatten())
}

/// Returns `true` if a press is on a canvas and not on something over it.
pub(super) fn is_on(response: &Response, press: &ButtonChange) -> bool {
    response.contains_pointer() && response.rect.contains(press.at)
}

/// Returns `true` if the way from a press to a point, at a scale in points per millimetre, is longer than of a click.
pub(super) fn is_drag(from: Vec2, (point, scale): (Vec2, f32)) -> bool {
    (point - from).length() * scale > CLICK_REACH
}

/// Returns `true` if the system has taken a touch away, which releases no button.
pub(super) fn is_touch_cancelled(ui: &egui::Ui) -> bool {
    ui.input(|input| input.events.iter().any(is_cancel))
}

const fn is_cancel(event: &Event) -> bool {
    matches!(
        event,
        Event::Touch {
            phase: TouchPhase::Cancel,
            ..
        }
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::{TWO_KEYS, Window};
    use super::*;

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    /// Draws frames, each with several events.
    fn draw(window: &mut Window, frames: &[&[Event]]) {
        for events in frames {
            let input = window.harness.input_mut();
            input.events.extend_from_slice(events);
            window.harness.run_steps(1);
        }
    }

    #[test]
    fn a_drag_goes_from_its_press_to_its_release_however_few_frames_are_drawn() {
        let points = Window::open();
        let [from, to, beyond] = [0.0, 30.0, 45.0].map(|y| points.at(0.0, y));
        let moved = Event::PointerMoved;
        let begins = [moved(from), button(from, true), moved(from.lerp(to, 0.5))];
        let ends = [moved(to), button(to, false), moved(beyond)];
        let both = [begins.clone(), ends.clone()].concat();
        let drags: [&[&[Event]]; 2] = [&[&begins[..], &ends[..]], &[&both[..]]];
        for frames in drags {
            let mut window = Window::open();
            draw(&mut window, frames);
            assert_eq!(window.text(), TWO_KEYS.replace("(0, 0)", "(0, 30)"));
            window.panel().undo();
            assert_eq!(window.text(), TWO_KEYS);
        }
    }

    #[test]
    fn a_touch_that_begins_and_is_cancelled_in_one_frame_moves_nothing() {
        let mut window = Window::open();
        let [from, to] = [0.0, 30.0].map(|y| window.at(0.0, y));
        let cancelled = Event::Touch {
            device_id: egui::TouchDeviceId(0),
            id: egui::TouchId(0),
            phase: TouchPhase::Cancel,
            pos: from,
            force: None,
        };
        let moved = Event::PointerMoved;
        draw(&mut window, &[&[moved(from)]]);
        draw(&mut window, &[&[button(from, true), cancelled]]);
        assert!(!window.panel().is_dragging_on_canvas());
        draw(&mut window, &[&[moved(to)], &[button(to, false)]]);
        assert_eq!(window.text(), TWO_KEYS);
    }

    #[test]
    fn a_click_selects_what_was_pressed_though_the_mouse_has_moved_on() {
        let mut window = Window::open();
        let [pressed, other] = [0.0, 40.0].map(|x| window.at(x, 0.0));
        let moved = Event::PointerMoved;
        let events = [
            moved(pressed),
            button(pressed, true),
            button(pressed, false),
            moved(other),
        ];
        draw(&mut window, &[&events[..]]);
        assert_eq!(window.panel().selected.single(), Some(0));
        assert_eq!(window.text(), TWO_KEYS);
    }
}
