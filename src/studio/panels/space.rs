//! The 3D view: boards and hands, drawn by the painter of egui.

use eframe::egui::{self, Align2, Color32, FontId, PointerButton, Pos2, Rect, Sense};
use parry3d::math::Vec2;

use super::{PanelContext, PanelState, look};
use crate::studio::picture::{Color, Picture, Triangles};
use crate::studio::scene::{self, SceneColors};
use crate::studio::texts::text;

/// Height of letters as a fraction of the size of their font.
const LETTER_HEIGHT: f32 = 0.72;

pub(super) fn show(ui: &mut egui::Ui, state: &mut PanelState, context: &mut PanelContext) {
    let size = ui.available_size();
    let (area, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    look::name_image(&response, text("panel-space"));
    let size = Vec2::new(area.width(), area.height());
    if size.min_element() < 1.0 {
        return;
    }
    place_camera(state, context, size);
    let drag = response.drag_delta();
    let drag = Vec2::new(drag.x, drag.y);
    if response.dragged_by(PointerButton::Primary) {
        state.camera.orbit(drag);
    } else if response.dragged() {
        state.camera.pan(drag, size.y);
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        state.camera.zoom((-scroll * 0.002).exp());
    }
    let has_high_contrast = state.settings.has_high_contrast;
    let colors = SceneColors::new(ui.visuals().dark_mode, has_high_contrast);
    let picture = scene::draw(context.model, &state.camera, size, &colors, state.scene);
    paint(&ui.painter_at(area), area, &picture, colors.background);
    let hint = area.center_bottom() - egui::vec2(0.0, 8.0);
    let font = FontId::proportional(12.0);
    let color = ui.visuals().weak_text_color();
    let painter = ui.painter_at(area);
    painter.text(
        hint,
        Align2::CENTER_BOTTOM,
        text("hint-camera"),
        font,
        color,
    );
}

/// Points the camera at the boards once their poses are known.
fn place_camera(state: &mut PanelState, context: &PanelContext, size: Vec2) {
    let layout = &context.model.view.layout.name;
    if !state.is_camera_placed
        && let Some(camera) = state.settings.camera_for(layout)
    {
        state.camera = camera;
        state.is_camera_placed = true;
    }
    if !state.is_camera_placed {
        let points = scene::points_of_interest(context.model);
        state.is_camera_placed = !points.is_empty();
        state.camera.frame(points.into_iter(), size.x / size.y);
    }
}

fn paint(painter: &egui::Painter, area: Rect, picture: &Picture, background: Color) {
    painter.rect_filled(area, 0.0, color32(background));
    painter.add(mesh(&picture.below, area));
    for label in &picture.labels {
        let font = FontId::proportional(label.size / LETTER_HEIGHT);
        let at = on_screen(label.position, area);
        painter.text(
            at,
            Align2::CENTER_CENTER,
            &label.text,
            font,
            color32(label.color),
        );
    }
    painter.add(mesh(&picture.above, area));
}

fn mesh(triangles: &Triangles, area: Rect) -> egui::Mesh {
    let mut mesh = egui::Mesh::default();
    for &(position, color) in &triangles.vertices {
        mesh.colored_vertex(on_screen(position, area), color32(color));
    }
    mesh.indices.clone_from(&triangles.indices);
    mesh
}

fn on_screen(position: Vec2, area: Rect) -> Pos2 {
    area.min + egui::vec2(position.x, position.y)
}

fn color32(Color([red, green, blue, opacity]): Color) -> Color32 {
    Color32::from_rgba_unmultiplied(red, green, blue, opacity)
}
