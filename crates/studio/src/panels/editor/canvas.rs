//! The canvas of the layout editor: mouse, keyboard and painting.

use std::sync::Arc;

use eframe::egui::{self, EventFilter, PointerButton, Sense};
use parry3d::math::Vec2;

use super::super::{PanelContext, look, space, zoom};
use super::{EditorPanel, palette, pointer, rounded, rulers};
use crate::canvas::board::Fingertip;
use crate::canvas::draw::{self, CanvasScene};
use crate::canvas::gesture::{self, Gesture, Preview};
use crate::canvas::handles::{self, Handle};
use crate::canvas::snap::SnapSettings;
use crate::canvas::viewport::Viewport;
use crate::canvas::{Bounds, CORNERS, bend, group, item_at};
use crate::editor::{Edit, Part};
use crate::model::StudioModel;
use crate::texts::text;
use ademan_core::hand::Finger;
use ademan_core::layout::Layout;

/// Distance at which edges attract, in points.
const SNAP_REACH: f32 = 6.0;

/// Distance at which the handle of a bend is hit, in points.
const BEND_REACH: f32 = 9.0;

pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, context: &PanelContext) {
    let Some((area, viewport)) = operate(ui, panel) else {
        return;
    };
    let over = Over {
        heats: &[],
        hint: hint(panel),
    };
    paint(ui, panel, context, (area, &viewport), &over);
    if panel.has_rulers {
        rulers::paint(ui, (area, &viewport), panel.selected_bounds());
    }
}

/// Returns the words about the mouse, or about the first control.
fn hint(panel: &EditorPanel) -> &'static str {
    if panel.items.items.is_empty() {
        text("editor-hint-empty")
    } else {
        text("editor-hint")
    }
}

/// Does what mouse and keyboard ask for. Returns the area of the canvas and the part of the board in it; `None` without room.
pub(super) fn operate(
    ui: &mut egui::Ui,
    panel: &mut EditorPanel,
) -> Option<(egui::Rect, Viewport)> {
    let (room, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let is_held = pointer::is_held(ui);
    let area = pointer::steady_area(room, panel.canvas_size, is_held);
    let size = Vec2::new(area.width(), area.height());
    if size.min_element() < 1.0 {
        return None;
    }
    panel.canvas_size = Some(size);
    drop_stale_drag(ui, panel);
    name_for_readers(panel, &response);
    keep_arrow_keys(ui, &response);
    let bounds = Bounds::around(panel.items.items.iter().map(|item| &item.shape));
    let revision = panel.editor.revision();
    let mut viewport = panel.viewport.update(bounds, size, revision, is_held);
    let to_local = |at: egui::Pos2| Vec2::new(at.x - area.min.x, at.y - area.min.y);
    let pans = pans(&response);
    move_view(ui, &response, &mut viewport, pans, to_local, size);
    panel.viewport.move_to(viewport);
    if let Some(at) = pointer::position(ui, &response, panel.is_dragging_on_canvas()) {
        let to_board = |point| viewport.to_board(to_local(point), size);
        handle_mouse(ui, panel, &response, (at, &to_board), viewport.scale);
        set_cursor(ui, panel, to_board(at), viewport.scale);
    }
    panel.check_drag(ui.ctx());
    palette::show_menu(&response, panel);
    Some((area, viewport))
}

/// Drops a drag whose touch was cancelled, or whose button went up while the canvas was not shown. The mouse would end it wherever it
/// comes back.
fn drop_stale_drag(ui: &egui::Ui, panel: &mut EditorPanel) {
    let is_over = ui.input(|input| {
        let pointer = &input.pointer;
        !pointer.primary_down() && !pointer.primary_released()
    });
    if (is_over || pointer::is_touch_cancelled(ui)) && panel.is_dragging_on_canvas() {
        panel.cancel_drag();
    }
}

/// The drawings over the items, and below the board.
pub(super) struct Over<'a> {
    /// The strengths of a color, by item.
    pub heats: &'a [f32],
    /// The words at the lower edge.
    pub hint: &'a str,
}

/// Tells screen readers what is on the canvas.
fn name_for_readers(panel: &EditorPanel, response: &egui::Response) {
    let name = text("editor-canvas");
    let selected = panel.selected.single();
    let label = selected.and_then(|index| panel.items.items.get(index));
    let name = label.map_or_else(|| name.to_owned(), |item| format!("{name}: {}", item.label));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, &name));
}

/// Keeps the arrow keys from moving the focus away from the canvas.
pub(super) fn keep_arrow_keys(ui: &egui::Ui, response: &egui::Response) {
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        escape: true,
        ..EventFilter::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
}

/// Returns `true` while the view is panned: by a drag of the middle or the secondary button.
pub(super) fn pans(response: &egui::Response) -> bool {
    response.dragged_by(PointerButton::Middle) || response.dragged_by(PointerButton::Secondary)
}

/// Pans the view by the drag of the mouse if `pans` is `true`, and zooms by its wheel.
pub(super) fn move_view(
    ui: &egui::Ui,
    response: &egui::Response,
    viewport: &mut Viewport,
    pans: bool,
    to_local: impl Fn(egui::Pos2) -> Vec2,
    size: Vec2,
) {
    if pans {
        let drag = response.drag_delta();
        viewport.pan(Vec2::new(drag.x, drag.y));
    }
    if let Some(at) = response.hover_pos() {
        viewport.zoom_at(to_local(at), size, zoom::magnification(ui));
    }
}

fn handle_mouse(
    ui: &egui::Ui,
    panel: &mut EditorPanel,
    response: &egui::Response,
    (at, to_board): (egui::Pos2, &dyn Fn(egui::Pos2) -> Vec2),
    scale: f32,
) {
    if response.secondary_clicked() {
        select_for_menu(panel, to_board(at));
    }
    for change in pointer::changes(ui) {
        let place = (to_board(change.at), scale);
        if !change.is_pressed {
            end_drag(panel, response, place, change.modifiers);
        } else if pointer::is_on(response, &change) {
            begin_drag(panel, response, place, change.modifiers.shift);
        }
    }
    if response.dragged_by(PointerButton::Primary) {
        let modifiers = ui.input(|input| input.modifiers);
        let place = (to_board(at), scale);
        if panel.dragged_radius.is_none() {
            drag_to(panel, place, modifiers);
        } else if ui.input(|input| input.pointer.press_origin() == input.pointer.interact_pos()) {
            // A press beside the middle of the handle bends nothing, nor does a drag that returns there.
            panel.dragged_radius = panel.items.radius;
        } else {
            drag_bend(panel, place.0);
        }
    }
}

/// Begins the drag of a press at a point, at a scale in points per millimetre. `adds` keeps what is selected.
fn begin_drag(
    panel: &mut EditorPanel,
    response: &egui::Response,
    (point, scale): (Vec2, f32),
    adds: bool,
) {
    leave_fields(panel, response);
    panel.update_items();
    if is_at_bend_handle(panel, (point, scale)) {
        panel.dragged_radius = panel.items.radius;
        return;
    }
    let items = &panel.items.items;
    let begun = gesture::begin(items, &mut panel.selected, point, scale, adds);
    panel.gesture = Some(begun);
    panel.preview = Preview::default();
    panel.select_items_in_editor();
}

/// Shows what a drag to a point leads to.
fn drag_to(panel: &mut EditorPanel, (point, scale): (Vec2, f32), modifiers: egui::Modifiers) {
    if let Some(gesture) = panel.gesture.clone() {
        let snap = snap_settings(panel, modifiers, scale);
        let items = &panel.items.items;
        panel.preview = gesture.preview(items, &mut panel.selected, point, snap);
    }
}

/// Ends a drag, or a click, by a release at a point.
fn end_drag(
    panel: &mut EditorPanel,
    response: &egui::Response,
    (point, scale): (Vec2, f32),
    modifiers: egui::Modifiers,
) {
    if panel.dragged_radius.is_some() {
        if panel.dragged_radius != panel.items.radius || !is_at_bend_handle(panel, (point, scale)) {
            drag_bend(panel, point);
        }
        end_bend(panel);
        return;
    }
    let Some(gesture) = panel.gesture.clone() else {
        return;
    };
    // The mouse has moved on since the last frame, which may have been before the drag.
    if response.drag_stopped() || pointer::is_drag(gesture.start(), (point, scale)) {
        drag_to(panel, (point, scale), modifiers);
    }
    let preview = std::mem::take(&mut panel.preview);
    panel.gesture = None;
    if preview.shapes.is_empty() && !modifiers.shift {
        finish_click(panel, &gesture);
    }
    finish(panel, &gesture, &preview);
}

/// Returns what a drag snaps to at a scale in points per millimetre: nothing while Alt is held.
pub(super) fn snap_settings(
    panel: &EditorPanel,
    modifiers: egui::Modifiers,
    scale: f32,
) -> SnapSettings {
    if !panel.snaps || modifiers.alt {
        return SnapSettings::OFF;
    }
    SnapSettings {
        grid_mm: panel.grid_mm,
        reach_mm: SNAP_REACH / scale,
    }
}

/// Ends the typing into fields, and forgets the last message unless a field has given it.
pub(super) fn leave_fields(panel: &mut EditorPanel, response: &egui::Response) {
    if panel.commit_drafts() {
        panel.message = None;
    }
    response.request_focus();
}

/// Selects the item at a point, unless it is one of the selected ones.
fn select_for_menu(panel: &mut EditorPanel, point: Vec2) {
    if let Some(index) = item_at(&panel.items.items, point)
        && !panel.selected.contains(index)
    {
        panel.selected.set([index]);
        panel.select_items_in_editor();
    }
}

/// Selects the clicked one of several selected items.
fn finish_click(panel: &mut EditorPanel, gesture: &Gesture) {
    if let Gesture::Move { from } = gesture {
        panel.selected.set(item_at(&panel.items.items, *from));
        panel.select_items_in_editor();
    }
}

/// Makes the edit of a finished gesture: one step of undo.
fn finish(panel: &mut EditorPanel, gesture: &Gesture, preview: &Preview) {
    if let Gesture::Band { .. } = gesture {
        panel.select_items_in_editor();
    }
    let Some(&(index, _)) = preview.shapes.first() else {
        return;
    };
    if !matches!(panel.parts.get(index), Some(Some(_))) {
        panel.message = Some(Err(text("editor-unbalanced").to_owned()));
    } else if let Some(edit) = edit_of(panel, gesture, preview) {
        panel.apply(&edit);
    }
}

/// Returns the edit of a gesture that would end now.
fn edit_of(panel: &EditorPanel, gesture: &Gesture, preview: &Preview) -> Option<Edit> {
    let &(index, new) = preview.shapes.first()?;
    let old = panel.items.items.get(index)?.shape;
    let part = (*panel.parts.get(index)?)?;
    let parts = vec![part];
    match gesture {
        Gesture::Band { .. } => None,
        Gesture::Move { .. } => panel.movement(panel.selected_parts(), new.center - old.center),
        Gesture::Scale { corner, .. } => {
            let (factors, fixed) = (preview.scaling?.factors, -CORNERS[*corner]);
            let numbers = |it: Vec2| it.to_array().map(f64::from);
            Some(Edit::Scale {
                parts: panel.selected_parts(),
                factors: numbers(factors),
                fixed: numbers(fixed),
            })
        }
        Gesture::Handle { handle, .. } => Some(match handle {
            Handle::Turn => Edit::Turn {
                parts,
                degrees: rounded(new.rotation_deg - old.rotation_deg),
            },
            Handle::Corner(corner) => {
                let by = (new.half - old.half) * 2.0;
                let fixed = if old.is_disc {
                    Vec2::ZERO
                } else {
                    -CORNERS[*corner]
                };
                Edit::Resize {
                    parts,
                    by_mm: [rounded(by.x), rounded(by.y)],
                    fixed: [f64::from(fixed.x), f64::from(fixed.y)],
                }
            }
        }),
    }
}

impl EditorPanel {
    /// Returns the edit of a drag on the canvas that would end now.
    pub(super) fn edit_of_drag(&self) -> Option<Edit> {
        match self.dragged_radius {
            Some(radius) => Some(self.bend_to(radius)),
            None => edit_of(self, self.gesture.as_ref()?, &self.preview),
        }
    }

    /// Returns `true` while something is dragged on the canvas.
    pub(super) fn is_dragging_on_canvas(&self) -> bool {
        self.gesture.is_some() || self.dragged_radius.is_some()
    }

    /// Ends a drag on the canvas without an edit.
    pub(super) fn cancel_drag(&mut self) {
        if let Some(Gesture::Band { before, .. }) = self.gesture.take() {
            self.selected = before;
            self.select_items_in_editor();
        }
        self.preview = Preview::default();
        self.dragged_radius = None;
    }

    /// Returns the edit that gives the board a radius, in millimetres.
    fn bend_to(&self, radius: f32) -> Edit {
        Edit::SetField {
            parts: vec![Part::Board(self.board)],
            field: "shape.radius_mm".to_owned(),
            value: Some(radius.to_string()),
        }
    }
}

/// Returns the position of the handle that sets the radius of the board.
pub(super) fn bend_handle(panel: &EditorPanel) -> Option<Vec2> {
    let radius = panel.items.radius?;
    let half_width = draw::bend_half_width(&panel.items.items);
    bend::curve(radius, half_width).last().copied()
}

fn is_at_bend_handle(panel: &EditorPanel, (point, scale): (Vec2, f32)) -> bool {
    bend_handle(panel).is_some_and(|at| (at - point).length() * scale <= BEND_REACH)
}

fn drag_bend(panel: &mut EditorPanel, point: Vec2) {
    let half_width = draw::bend_half_width(&panel.items.items);
    let radius = bend::radius_for_drop(half_width, -point.y).round();
    panel.dragged_radius = Some(radius);
}

/// Gives the board the radius of the drag: one step of undo.
fn end_bend(panel: &mut EditorPanel) {
    let radius = panel.dragged_radius.take();
    if let Some(radius) = radius.filter(|_| radius != panel.items.radius) {
        panel.apply(&panel.bend_to(radius));
    }
}

fn set_cursor(ui: &egui::Ui, panel: &EditorPanel, point: Vec2, scale: f32) {
    let items = &panel.items.items;
    let item = panel.selected.single().and_then(|index| items.get(index));
    let handle = item.and_then(|item| handles::handle_at(item, point, scale));
    let corner = match panel.gesture {
        Some(Gesture::Scale { corner, .. }) => Some(corner),
        _ => group::frame(items, &panel.selected)
            .and_then(|frame| group::handle_at(frame, point, scale)),
    };
    let icon = match (&panel.gesture, handle, corner) {
        (Some(Gesture::Move { .. }), ..) if !panel.preview.shapes.is_empty() => {
            egui::CursorIcon::Grabbing
        }
        (_, Some(Handle::Turn), _) => egui::CursorIcon::Crosshair,
        (_, Some(Handle::Corner(_)), _) | (_, _, Some(1 | 3)) => egui::CursorIcon::ResizeNwSe,
        (_, _, Some(_)) => egui::CursorIcon::ResizeNeSw,
        _ => return,
    };
    ui.ctx().set_cursor_icon(icon);
}

pub(super) fn paint(
    ui: &egui::Ui,
    panel: &EditorPanel,
    context: &PanelContext,
    (area, viewport): (egui::Rect, &Viewport),
    over: &Over,
) {
    let colors = look::scene_colors(ui.visuals());
    let (pressed, fingertips) = live(panel, context.session);
    // Keys have no values: most layouts need no other items.
    let live_controls = live_layout(panel, context.session).filter(|it| !it.controls.is_empty());
    let valued = live_controls.map(|layout| {
        let values = &context.session.values;
        let drawn = panel.design.as_ref().unwrap_or(layout);
        panel.items.with_values(drawn, values, viewport.scale)
    });
    let scene = CanvasScene {
        items: valued.as_ref().unwrap_or(&panel.items.items),
        selected: &panel.selected,
        pressed: &pressed,
        fingertips: &fingertips,
        preview: &panel.preview,
        faulty: &panel.faulty_outlines(),
        heats: over.heats,
        radius: panel.dragged_radius.or(panel.items.radius),
        has_grid: true,
    };
    let size = Vec2::new(area.width(), area.height());
    let picture = draw::draw(&scene, viewport, size, &colors);
    let painter = ui.painter_at(area);
    space::paint(&painter, area, &picture, colors.background);
    let background = space::hint_background(colors.background);
    space::show_hint(ui, area, over.hint, background);
}

/// Returns the layout of the editor, if the session uses the present text.
pub(super) fn live_layout<'a>(panel: &'a EditorPanel, model: &StudioModel) -> Option<&'a Layout> {
    let used = &model.view.layout;
    let layout = panel.editor.layout().map(Arc::as_ref);
    layout.filter(|it| used.text == it.text && used.boards.len() == it.boards.len())
}

/// Returns the pressed items and the fingertips over the board, if the session uses the present text.
fn live(panel: &EditorPanel, model: &StudioModel) -> (Vec<usize>, Vec<Fingertip>) {
    if live_layout(panel, model).is_none() {
        return (Vec::new(), Vec::new());
    }
    let is_pressed = |target| model.contact_with(target).is_some_and(|it| it.is_pressed);
    let targets = panel.items.targets.iter().enumerate();
    let pressed = targets.filter(|(_, target)| is_pressed(**target));
    let pressed = pressed.map(|(index, _)| index).collect();
    let Some(world_from_board) = model.world_from_board(panel.board) else {
        return (pressed, Vec::new());
    };
    let board_from_world = world_from_board.inverse();
    let poses = model.poses.iter().flatten();
    let tips = poses.flat_map(|pose| {
        let tips = Finger::ALL
            .iter()
            .filter_map(|&finger| pose.fingertip(finger));
        tips.map(|tip| (board_from_world * tip, pose.tip_radius))
    });
    let tips = tips.filter_map(|(tip, radius)| {
        let pad = tip - parry3d::math::Vec3::Z * radius;
        panel.items.fingertip(pad)
    });
    (pressed, tips.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::{ControlKind, LayoutEditor};
    use ademan_core::layout::Fit;

    #[test]
    fn a_board_without_controls_says_how_to_add_one() {
        let mut panel = EditorPanel::new(LayoutEditor::empty(Fit::default()));
        panel.update_items();
        assert_eq!(hint(&panel), text("editor-hint-empty"));
        panel.add_control(ControlKind::Key);
        assert_eq!(hint(&panel), text("editor-hint"));
    }
}
