//! The rulers of the canvas and of the plan.

use eframe::egui;
use parry3d::math::Vec2;

use super::super::{look, space};
use super::EditorPanel;
use crate::canvas::Bounds;
use crate::canvas::rulers::{self, Rulers};
use crate::canvas::viewport::Viewport;

impl EditorPanel {
    /// Returns the rectangle around what is selected on the board, as it is dragged.
    pub(super) fn selected_bounds(&self) -> Option<Bounds> {
        let dragged = &self.preview.shapes;
        let resting = if dragged.is_empty() {
            self.selected.shapes(&self.items.items)
        } else {
            Vec::new()
        };
        let shapes = dragged.iter().chain(&resting);
        Bounds::around(shapes.map(|(_, shape)| shape))
    }
}

/// Paints rulers along an area, with the pointer and the rectangle around what is selected.
pub(super) fn paint(
    ui: &egui::Ui,
    (area, viewport): (egui::Rect, &Viewport),
    selected: Option<Bounds>,
) {
    let size = Vec2::new(area.width(), area.height());
    let pointer = ui.input(|input| input.pointer.latest_pos());
    let pointer = pointer.filter(|at| area.contains(*at));
    let marked = Rulers {
        pointer: pointer.map(|at| Vec2::new(at.x - area.min.x, at.y - area.min.y)),
        selected,
    };
    let colors = look::scene_colors(ui.visuals());
    let picture = rulers::draw(&marked, viewport, size, &colors);
    space::paint_over(&ui.painter_at(area), area, &picture);
}
