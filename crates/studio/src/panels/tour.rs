//! The tour of the first start: a box beside what each step explains, an outline around it, and an arrow from the box to it.

use eframe::egui::{self, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2};

use super::{PanelState, Workspace, help, look};
use crate::texts::{text, text_with};
use crate::tour::{STEPS, Tour};

/// Width of the words, in points.
const WIDTH: f32 = 460.0;

/// Size of the box before it has been drawn, in points.
const FIRST_SIZE: Vec2 = egui::vec2(490.0, 180.0);

/// Distance of the box from what it explains, in points.
const GAP: f32 = 18.0;

/// Distance of the box from the edges of the window, in points.
const MARGIN: f32 = 10.0;

/// Height of the status line, in points, which the box leaves free.
const STATUS_HEIGHT: f32 = 34.0;

/// Half the width of the arrow at the box, in points.
const ARROW_HALF_WIDTH: f32 = 9.0;

/// The step that is shown, and the tab to which the window returns after the tour.
pub(super) struct Shown {
    step: usize,
    tab_before: Workspace,
}

/// Shows the step of the tour, if it is open, and the tab that it explains.
pub(super) fn show(ui: &egui::Ui, state: &mut PanelState) {
    let area = state.tour.take_area();
    if state.tour.index().is_some() && help::is_escape_pressed(ui) {
        state.tour.close();
    }
    let Some(index) = state.tour.index() else {
        end(state);
        return;
    };
    choose_tab(state, index);
    let step = STEPS[index];
    let id = egui::Id::unique("tour");
    let drawn = ui.memory(|memory| memory.area_rect(id));
    let size = drawn.map_or(FIRST_SIZE, |drawn| drawn.size());
    let at = place(size, area, ui.ctx().content_rect());
    let window = egui::Window::new(text(step.heading))
        .id(id)
        .fixed_pos(at)
        .collapsible(false)
        .resizable(false);
    window.show(ui.ctx(), |content| {
        content.set_width(WIDTH);
        content.label(egui::RichText::new(text(step.words)).size(15.0));
        content.add_space(10.0);
        content.horizontal(|row| show_buttons(row, &mut state.tour, index));
    });
    if let Some(area) = area {
        point(ui, Rect::from_min_size(at, size), area);
    }
}

/// Shows the tab of the hand once for each step: the person may choose another one.
fn choose_tab(state: &mut PanelState, step: usize) {
    if state.shown_step.as_ref().is_some_and(|it| it.step == step) {
        return;
    }
    let tab_before = match &state.shown_step {
        Some(shown) => shown.tab_before,
        None => state.workspace,
    };
    state.shown_step = Some(Shown { step, tab_before });
    state.workspace = Workspace::Hand;
}

/// Returns to the tab from before the tour, unless the person has chosen one.
fn end(state: &mut PanelState) {
    if let Some(shown) = state.shown_step.take()
        && state.workspace == Workspace::Hand
    {
        state.workspace = shown.tab_before;
    }
}

/// Returns the upper left corner of a box beside an area: below, above, at the left or at the right of it, else at the lower left of
/// the window.
fn place(size: Vec2, area: Option<Rect>, screen: Rect) -> Pos2 {
    let free = Rect::from_min_max(
        screen.min + Vec2::splat(MARGIN),
        screen.max - Vec2::new(MARGIN, MARGIN + STATUS_HEIGHT),
    );
    let beside = |explained: Rect| {
        let along_x = explained.min.x.min(free.max.x - size.x).max(free.min.x);
        let along_y = (explained.min.y + GAP)
            .min(free.max.y - size.y)
            .max(free.min.y);
        let places = [
            egui::pos2(along_x, explained.max.y + GAP),
            egui::pos2(along_x, explained.min.y - GAP - size.y),
            egui::pos2(explained.min.x - GAP - size.x, along_y),
            egui::pos2(explained.max.x + GAP, along_y),
        ];
        let mut places = places.into_iter();
        places.find(|&at| free.contains_rect(Rect::from_min_size(at, size)))
    };
    let corner = egui::pos2(free.min.x, free.max.y - size.y);
    area.and_then(beside).unwrap_or(corner)
}

/// Draws an outline around an area and, from a box beside it, an arrow to it.
fn point(ui: &egui::Ui, from: Rect, area: Rect) {
    let layer = egui::LayerId::new(
        egui::Order::Foreground,
        egui::Id::unique("arrow of the tour"),
    );
    let painter = ui.ctx().layer_painter(layer);
    let color = look::focus_color(ui.visuals().dark_mode);
    let line = Stroke::new(look::FOCUS_WIDTH, color);
    painter.rect_stroke(area.shrink(1.0), 3.0, line, StrokeKind::Outside);
    if let Some(corners) = arrow(from, area) {
        painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
    }
}

/// Returns the corners of an arrow from a box to an area, the tip first, if there is room between them.
fn arrow(from: Rect, area: Rect) -> Option<[Pos2; 3]> {
    let nearest = |[low, high]: [f32; 2], [from_low, from_high]: [f32; 2]| {
        let middle = f32::midpoint(low, high);
        // A box may be smaller than the arrow.
        let last = from_high - 2.0 * ARROW_HALF_WIDTH;
        middle.min(last).max(from_low + 2.0 * ARROW_HALF_WIDTH)
    };
    let x = nearest([area.min.x, area.max.x], [from.min.x, from.max.x]);
    let y = nearest([area.min.y, area.max.y], [from.min.y, from.max.y]);
    let (tip, base, along) = if area.max.y <= from.min.y {
        (
            egui::pos2(x, area.max.y),
            egui::pos2(x, from.min.y),
            Vec2::X,
        )
    } else if area.min.y >= from.max.y {
        (
            egui::pos2(x, area.min.y),
            egui::pos2(x, from.max.y),
            Vec2::X,
        )
    } else if area.max.x <= from.min.x {
        (
            egui::pos2(area.max.x, y),
            egui::pos2(from.min.x, y),
            Vec2::Y,
        )
    } else if area.min.x >= from.max.x {
        (
            egui::pos2(area.min.x, y),
            egui::pos2(from.max.x, y),
            Vec2::Y,
        )
    } else {
        return None;
    };
    let side = along * ARROW_HALF_WIDTH;
    Some([tip, base + side, base - side])
}

fn show_buttons(ui: &mut egui::Ui, tour: &mut Tour, index: usize) {
    ui.spacing_mut().button_padding = egui::vec2(10.0, 5.0);
    let values = [("step", (index + 1).into()), ("count", STEPS.len().into())];
    ui.label(text_with("tour-step", &values));
    let is_last = index + 1 == STEPS.len();
    let next = ui.button(if is_last {
        text("tour-done")
    } else {
        text("tour-next")
    });
    if ui.memory(|memory| memory.focused().is_none()) {
        next.request_focus();
    }
    let back = ui.add_enabled(index > 0, egui::Button::new(text("tour-back")));
    let is_skipped = !is_last && ui.button(text("tour-skip")).clicked();
    if next.clicked() {
        tour.advance();
    } else if back.clicked() {
        tour.go_back();
    } else if is_skipped {
        tour.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Rect = Rect {
        min: Pos2::ZERO,
        max: egui::pos2(1280.0, 800.0),
    };

    fn area(min: [f32; 2], max: [f32; 2]) -> Rect {
        Rect::from_min_max(min.into(), max.into())
    }

    #[test]
    fn the_box_is_beside_what_it_explains_and_the_arrow_ends_there() {
        for explained in [
            area([300.0, 5.0], [390.0, 30.0]),
            area([0.0, 770.0], [1280.0, 800.0]),
            area([900.0, 40.0], [1280.0, 760.0]),
            area([0.0, 40.0], [500.0, 760.0]),
            area([1200.0, 5.0], [1270.0, 30.0]),
        ] {
            let at = place(FIRST_SIZE, Some(explained), SCREEN);
            let shown = Rect::from_min_size(at, FIRST_SIZE);
            assert!(SCREEN.contains_rect(shown), "{explained}: {shown}");
            assert!(!shown.intersects(explained), "{explained}: {shown}");
            let [tip, base, other] = arrow(shown, explained).expect("room for an arrow");
            assert!(explained.distance_to_pos(tip) < 1e-3, "{explained}: {tip}");
            assert!(shown.distance_to_pos(base) < 1e-3, "{shown}: {base}");
            assert!(shown.distance_to_pos(other) < 1e-3, "{shown}: {other}");
        }
    }

    #[test]
    fn without_room_beside_it_the_box_is_at_the_lower_left() {
        let at = place(FIRST_SIZE, Some(SCREEN), SCREEN);
        assert_eq!(at, place(FIRST_SIZE, None, SCREEN));
        assert_eq!(at, egui::pos2(10.0, 800.0 - 10.0 - 34.0 - FIRST_SIZE.y));
        assert_eq!(arrow(Rect::from_min_size(at, FIRST_SIZE), SCREEN), None);
    }
}
