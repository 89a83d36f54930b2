//! The 3D view: boards and hands, drawn by the painter of egui.

use eframe::egui::text::LayoutJob;
use eframe::egui::{
    self, Align, Align2, Color32, FontId, Key, Modifiers, PointerButton, Pos2, Rect, Sense,
};
use parry3d::math::Vec2;

use super::{PanelContext, PanelState, look, zoom};
use crate::camera::{CameraStep, Viewpoint};
use crate::fingertip::Mouse;
use crate::fonts::CAPITAL_HEIGHT;
use crate::picture::{Color, Image, Label, Picture, Triangles};
use crate::scene;
use crate::texts::text;
use ademan_core::command::Command;

/// Width of a character of a candidate, and of the rest of its button, in points.
const CANDIDATE_WIDTH: f32 = 7.5;
const BUTTON_WIDTH: f32 = 36.0;

/// Width of a character of the text so far, in points, with some room.
const TYPED_WIDTH: f32 = 10.0;

/// Distance of the middle of the text so far from the lower edge, in points.
const TYPED_HEIGHT: f32 = 44.0;

/// Greatest height of a hint, as a fraction of the picture that it covers.
const MAX_HINT: f32 = 0.2;

/// Sizes of the font in which labels are drawn, in points.
const FONT_SIZES: [f32; 6] = [10.0, 14.0, 20.0, 28.0, 40.0, 64.0];

/// Keys of the view while it has the focus. Those with Shift stand first, as the others match them too.
const KEYS: [(Modifiers, Key, CameraStep); 11] = [
    (Modifiers::SHIFT, Key::ArrowLeft, CameraStep::Pan(-1.0, 0.0)),
    (Modifiers::SHIFT, Key::ArrowRight, CameraStep::Pan(1.0, 0.0)),
    (Modifiers::SHIFT, Key::ArrowDown, CameraStep::Pan(0.0, -1.0)),
    (Modifiers::SHIFT, Key::ArrowUp, CameraStep::Pan(0.0, 1.0)),
    (
        Modifiers::NONE,
        Key::ArrowLeft,
        CameraStep::Orbit(-1.0, 0.0),
    ),
    (
        Modifiers::NONE,
        Key::ArrowRight,
        CameraStep::Orbit(1.0, 0.0),
    ),
    (
        Modifiers::NONE,
        Key::ArrowDown,
        CameraStep::Orbit(0.0, -1.0),
    ),
    (Modifiers::NONE, Key::ArrowUp, CameraStep::Orbit(0.0, 1.0)),
    (Modifiers::NONE, Key::Plus, CameraStep::Zoom(1.0)),
    // Plus without Shift on keyboards that have both on one key.
    (Modifiers::NONE, Key::Equals, CameraStep::Zoom(1.0)),
    (Modifiers::NONE, Key::Minus, CameraStep::Zoom(-1.0)),
];

/// Draws the 3D view. `has_focus` tells whether its panel has the focus.
pub(super) fn show(
    ui: &mut egui::Ui,
    state: &mut PanelState,
    context: &mut PanelContext,
    has_focus: bool,
) {
    let size = ui.available_size();
    let (area, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    look::name_image(&response, text("panel-space"));
    let extent = Vec2::new(area.width(), area.height());
    if extent.min_element() < 1.0 {
        return;
    }
    place_camera(state, context, extent);
    let has_button = follow_mouse(ui, area, &response, state, context);
    let drag = response.drag_delta();
    let drag = Vec2::new(drag.x, drag.y);
    if response.dragged_by(PointerButton::Primary) && has_button {
        // The finger follows.
    } else if response.dragged_by(PointerButton::Primary) {
        state.camera.orbit(drag);
    } else if response.dragged() {
        state.camera.pan(drag, extent.y);
    }
    if response.hovered() && !has_button {
        state.camera.zoom(1.0 / zoom::magnification(ui));
    }
    if has_focus || response.has_focus() {
        look::keep_arrow_keys(ui);
        for step in pressed_keys(ui) {
            state.camera.step(step, extent.y);
        }
    }
    let colors = look::scene_colors(ui.visuals());
    let picture = scene::draw(context.model, &state.camera, extent, &colors, state.scene);
    paint(&ui.painter_at(area), area, &picture, colors.background);
    let background = hint_background(colors.background);
    let hint = match context.fingertip {
        Some(_) => text("hint-fingertip-camera"),
        None => text("hint-camera"),
    };
    show_hint(ui, area, hint, background);
    show_typed(ui, area, context, background);
    show_candidates(ui, area, context, background);
    show_errors(ui, area, context.model.shapes.errors(), background);
}

/// Moves the fingertip with the mouse, if the mouse is a fingertip. Returns `true` if the button that is down is for the fingertip, not
/// the camera.
fn follow_mouse(
    ui: &egui::Ui,
    area: Rect,
    response: &egui::Response,
    state: &PanelState,
    context: &mut PanelContext,
) -> bool {
    let Some(aim) = &mut context.fingertip else {
        return false;
    };
    let projection = state
        .camera
        .projection(Vec2::new(area.width(), area.height()));
    let is_free = response.contains_pointer() || aim.has_button();
    let mouse = ui.input(|input| {
        let pointer = &input.pointer;
        let is_down = pointer.primary_down();
        // A touch that ends takes the pointer away with it; one that is cancelled does not release it.
        let at = if is_down {
            pointer.latest_pos()
        } else {
            pointer.interact_pos()
        };
        let at = at.filter(|at| is_free && input.focused && area.contains(*at));
        Mouse {
            ray: at.map(|at| {
                let on_picture = at - area.min;
                projection.ray(Vec2::new(on_picture.x, on_picture.y))
            }),
            is_pressed: pointer.primary_pressed() && input.modifiers.is_none(),
            is_down,
        }
    });
    if aim.follow(context.model, mouse) {
        ui.set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    aim.has_button()
}

/// Shows the candidates of the text decoder above the text so far, as buttons that take them.
fn show_candidates(ui: &mut egui::Ui, area: Rect, context: &mut PanelContext, background: Color32) {
    let candidates = &context.model.view.state.candidates;
    if candidates.is_empty() {
        return;
    }
    let center = area.center_bottom() - egui::vec2(0.0, TYPED_HEIGHT + 30.0);
    let characters: usize = candidates.iter().map(|word| word.chars().count()).sum();
    let width = characters as f32 * CANDIDATE_WIDTH + candidates.len() as f32 * BUTTON_WIDTH;
    let strip = Rect::from_center_size(center, egui::vec2(width, 26.0));
    ui.painter_at(area).rect_filled(strip, 4.0, background);
    let builder = egui::UiBuilder::new()
        .max_rect(strip)
        .layout(egui::Layout::left_to_right(egui::Align::Center));
    ui.scope_builder(builder, |ui| {
        for (word, number) in candidates.iter().zip(1..) {
            let button = ui.button(format!("{number} {word}"));
            if button.on_hover_text(text("candidate-hint")).clicked() {
                context.sent.push(Command::Candidate { number });
            }
        }
    });
}

/// Shows the end of the text so far above the hint: what a text field would have, with Backspace applied.
fn show_typed(ui: &mut egui::Ui, area: Rect, context: &PanelContext, background: Color32) {
    let room = (area.width() / TYPED_WIDTH - 4.0).max(0.0);
    let typed = context.model.view.state.typed_end(room as usize);
    if typed.is_empty() {
        return;
    }
    let strip = Rect::from_center_size(
        area.center_bottom() - egui::vec2(0.0, TYPED_HEIGHT),
        egui::vec2((typed.chars().count() as f32 + 2.0) * TYPED_WIDTH, 26.0),
    );
    ui.painter_at(area).rect_filled(strip, 4.0, background);
    let words = egui::RichText::new(typed).monospace().size(16.0).strong();
    ui.put(strip, egui::Label::new(words).extend())
        .on_hover_text(text("typed-hint"));
}

/// Returns the color behind words over a picture with this background.
pub(super) fn hint_background(background: Color) -> Color32 {
    color32(background).gamma_multiply(0.7)
}

/// Shows the movements of the mouse at the lower edge, with a background of their own over what is drawn there, unless they would cover
/// much of it.
pub(super) fn show_hint(ui: &egui::Ui, area: Rect, hint: &str, background: Color32) {
    let painter = ui.painter_at(area);
    let color = ui.visuals().text_color();
    let font = FontId::proportional(12.0);
    let width = (area.width() - 24.0).max(24.0);
    let hint = painter.layout(hint.to_owned(), font, color, width);
    if hint.size().y > area.height() * MAX_HINT {
        return;
    }
    let at = area.center_bottom() - egui::vec2(0.0, 8.0);
    let place = Align2::CENTER_BOTTOM.anchor_size(at, hint.size());
    painter.rect_filled(place.expand2(egui::vec2(6.0, 2.0)), 4.0, background);
    painter.galley(place.min, hint, color);
}

/// Shows the meshes that cannot be drawn at the upper edge.
fn show_errors<'a>(
    ui: &egui::Ui,
    area: Rect,
    errors: impl Iterator<Item = &'a str>,
    background: Color32,
) {
    let painter = ui.painter_at(area);
    let font = FontId::proportional(12.0);
    let width = area.width() - 16.0;
    let mut at = area.min + egui::vec2(8.0, 8.0);
    for error in errors {
        let color = ui.visuals().warn_fg_color;
        let words = painter.layout(error.to_owned(), font.clone(), color, width);
        let place = Rect::from_min_size(at, words.size());
        painter.rect_filled(place.expand2(egui::vec2(6.0, 2.0)), 4.0, background);
        at.y = place.max.y + 6.0;
        painter.galley(place.min, words, color);
    }
}

/// Returns the movements of the keys that were pressed.
fn pressed_keys(ui: &egui::Ui) -> Vec<CameraStep> {
    let pressed = |(modifiers, key, step): &(Modifiers, Key, CameraStep)| {
        let count = ui.input_mut(|input| input.count_and_consume_key(*modifiers, *key));
        std::iter::repeat_n(*step, count)
    };
    KEYS.iter().flat_map(pressed).collect()
}

/// Points the camera at the boards once their poses are known, or where it was at the last start, and from a chosen viewpoint.
fn place_camera(state: &mut PanelState, context: &PanelContext, size: Vec2) {
    let layout = &context.model.view.layout.name;
    if !state.is_camera_placed
        && let Some(camera) = state.settings.camera_for(layout)
    {
        state.camera = camera;
        state.is_camera_placed = true;
    }
    let chosen = state.next_viewpoint.take();
    if !state.is_camera_placed || chosen.is_some() {
        let points = scene::points_of_interest(context.model);
        state.is_camera_placed = !points.is_empty();
        let bearing = scene::bearing(context.model);
        let viewpoint = chosen.unwrap_or(Viewpoint::Eye);
        let aspect = size.x / size.y;
        state.camera.frame(&points, bearing, viewpoint, aspect);
    }
}

/// Paints a picture on a background.
pub fn paint(painter: &egui::Painter, area: Rect, picture: &Picture, background: Color) {
    painter.rect_filled(area, 0.0, color32(background));
    paint_over(painter, area, picture);
}

/// Paints a picture over what is there.
pub fn paint_over(painter: &egui::Painter, area: Rect, picture: &Picture) {
    painter.add(mesh(&picture.below, area));
    painter.add(label_mesh(painter, area, &picture.labels));
    if let Some(image) = &picture.skin {
        paint_image(painter, area, image);
    }
    painter.add(mesh(&picture.above, area));
    painter.add(mesh(&picture.marks, area));
}

/// The textures of the images of one pass, which the next pass uses again in the same order.
#[derive(Clone, Default)]
struct Textures {
    pass: u64,
    used: usize,
    handles: Vec<egui::TextureHandle>,
}

fn paint_image(painter: &egui::Painter, area: Rect, image: &Image) {
    let pixels = image.pixels.iter().map(|&color| color32(color)).collect();
    let pixels = egui::ColorImage::new(image.size, pixels);
    let context = painter.ctx();
    let id = egui::Id::unique("textures of hands");
    let mut textures: Textures = context.data(|data| data.get_temp(id)).unwrap_or_default();
    let pass = context.cumulative_pass_nr();
    if textures.pass != pass {
        (textures.pass, textures.used) = (pass, 0);
    }
    let options = egui::TextureOptions::LINEAR;
    match textures.handles.get_mut(textures.used) {
        Some(handle) => handle.set(pixels, options),
        None => {
            let handle = context.load_texture("hand", pixels, options);
            textures.handles.push(handle);
        }
    }
    let texture = textures.handles[textures.used].id();
    textures.used += 1;
    context.data_mut(|data| data.insert_temp(id, textures));
    let [low, high] = image.corners.map(|corner| on_screen(corner, area));
    let whole = Rect::from_min_max(Pos2::ZERO, egui::pos2(1.0, 1.0));
    painter.image(
        texture,
        Rect::from_min_max(low, high),
        whole,
        Color32::WHITE,
    );
}

/// Returns the letters of all labels. Each lies on its key, which no text of egui can.
fn label_mesh(painter: &egui::Painter, area: Rect, labels: &[Label]) -> egui::Mesh {
    let galleys: Vec<_> = labels
        .iter()
        .map(|label| {
            let font = FontId::proportional(font_size(label));
            let text = label.text.clone();
            let mut job = LayoutJob::simple(text, font, color32(label.color), f32::INFINITY);
            if label.text.contains('\n') {
                job.halign = Align::Center;
            }
            painter.layout_job(job)
        })
        .collect();
    // Known only after all letters are in the texture.
    let [width, height] = painter.ctx().fonts(|fonts| fonts.font_image_size());
    let texture_size = egui::vec2(width as f32, height as f32);
    let pixel = 1.0 / painter.pixels_per_point();
    let mut mesh = egui::Mesh::default();
    for (label, galley) in labels.iter().zip(&galleys) {
        let letter_height = font_size(label) * CAPITAL_HEIGHT;
        let center = galley.mesh_bounds.center();
        for row in &galley.rows {
            let first = mesh.vertices.len() as u32;
            let letters = &row.visuals.mesh;
            let corners = with_edges(&letters.vertices, pixel);
            mesh.vertices.extend(corners.iter().map(|vertex| {
                let offset = (row.pos + vertex.pos.to_vec2() - center) / letter_height;
                let position = label.position + label.right * offset.x + label.down * offset.y;
                egui::epaint::Vertex {
                    pos: on_screen(position, area),
                    uv: (vertex.uv.to_vec2() / texture_size).to_pos2(),
                    color: vertex.color,
                }
            }));
            let indices = letters.indices.iter().map(|index| first + index);
            mesh.indices.extend(indices);
        }
    }
    mesh
}

/// Returns the corners of letters, each with half a pixel of the empty space around it in the texture. A stroke of one pixel, as of a
/// hyphen, would be lost between the pixels of the screen where its label is drawn a little smaller.
fn with_edges(letters: &[egui::epaint::Vertex], pixel: f32) -> Vec<egui::epaint::Vertex> {
    let mut corners = letters.to_vec();
    for letter in corners.chunks_exact_mut(4) {
        let middle = letter[0].pos.lerp(letter[3].pos, 0.5);
        for corner in letter {
            let out = corner.pos - middle;
            let way = egui::vec2(out.x.signum(), out.y.signum()) / 2.0;
            corner.pos += way * pixel;
            corner.uv += way;
        }
    }
    corners
}

/// Returns the size of the font for a label: one of a few, so that the texture of letters stays small.
fn font_size(label: &Label) -> f32 {
    let height = label.down.length().max(label.right.length()) / CAPITAL_HEIGHT;
    let fits = FONT_SIZES.iter().find(|size| **size >= height);
    *fits.unwrap_or(&FONT_SIZES[FONT_SIZES.len() - 1])
}

fn mesh(triangles: &Triangles, area: Rect) -> egui::Mesh {
    let vertex = |&(position, color): &(Vec2, Color)| egui::epaint::Vertex {
        pos: on_screen(position, area),
        uv: egui::epaint::WHITE_UV,
        color: color32(color),
    };
    egui::Mesh {
        indices: triangles.indices.clone(),
        vertices: triangles.vertices.iter().map(vertex).collect(),
        ..egui::Mesh::default()
    }
}

fn on_screen(position: Vec2, area: Rect) -> Pos2 {
    area.min + egui::vec2(position.x, position.y)
}

/// Converts a color for egui.
pub fn color32(Color([red, green, blue, opacity]): Color) -> Color32 {
    Color32::from_rgba_unmultiplied(red, green, blue, opacity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hint_does_not_cover_a_low_view() {
        for (height, is_shown) in [(300.0, true), (100.0, true), (60.0, false)] {
            let context = egui::Context::default();
            let area = Rect::from_min_size(Pos2::ZERO, egui::vec2(400.0, height));
            let output = context.run_ui(egui::RawInput::default(), |ui| {
                show_hint(ui, area, "drag: orbit", Color32::BLACK);
            });
            let mut shapes = output.shapes.iter();
            let has_words = shapes.any(|drawn| matches!(drawn.shape, egui::Shape::Text(_)));
            output.drop_without_applying_deltas();
            assert_eq!(has_words, is_shown, "{height}");
        }
    }

    #[test]
    fn a_thin_stroke_is_at_least_a_pixel_high_at_every_size_of_a_label() {
        let context = egui::Context::default();
        let output = context.run_ui(egui::RawInput::default(), |ui| {
            for size in 7..22_u8 {
                let size = f32::from(size);
                let label = Label {
                    position: Vec2::ZERO,
                    right: Vec2::X * size,
                    down: Vec2::Y * size,
                    color: Color::rgb(255, 255, 255),
                    text: "-".to_owned(),
                };
                let letters = label_mesh(ui.painter(), Rect::ZERO, &[label]);
                let height = letters.calc_bounds().height();
                assert!(height > 1.0, "{size}: {height}");
            }
        });
        output.drop_without_applying_deltas();
    }
}
