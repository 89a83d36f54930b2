//! The plan of the layout editor: all boards and targets in space where they are, with mouse, keyboard and painting.

use std::collections::BTreeMap;
use std::mem;

use eframe::egui::{self, PointerButton, Sense};
use parry3d::math::Vec2;

use super::super::{PanelContext, look, space};
use super::plan_drag::{self, PlanDrag};
use super::{EditorPanel, canvas, free_view, palette, pointer, rulers};
use crate::canvas::Bounds;
use crate::canvas::draw::{self, CanvasScene};
use crate::canvas::gesture::Preview;
use crate::canvas::plan::gesture::{self, PlanGesture};
use crate::canvas::plan::{Plan, PlanView, at_start, handles};
use crate::canvas::selection::Selection;
use crate::canvas::viewport::{AreaViewport, Viewport};
use crate::editor::{Edit, Part};
use crate::scene::{PlanScene, draw_plan};
use crate::texts::text;
use ademan_core::contact::TargetId;
use ademan_core::kinematics::HandPose;

/// Distance beside an item at which it is hit, in points.
const HIT_REACH: f32 = 5.0;

/// The plan between two frames.
#[derive(Default)]
pub(super) struct PlanPanel {
    /// It is shown in place of one board.
    pub is_open: bool,
    /// The board that is shown was opened from the plan: Escape leads back.
    is_left: bool,
    pub view: PlanView,
    /// The free view as it was turned last.
    pub free: Option<PlanView>,
    /// The part of the plan that each view shows.
    viewports: [AreaViewport; PlanView::ALL.len()],
    pub plan: Plan,
    /// The hands at rest for the plan.
    hands: Vec<HandPose>,
    /// Revision of the text of the plan.
    shown: Option<u64>,
    pub drag: Option<PlanDrag>,
    /// Size of the canvas in the last frame, in points.
    size: Option<Vec2>,
    /// Something was added since the last frame.
    pub has_added: bool,
    /// Guides and rubber band of the drag.
    pub preview: Preview,
}

impl PlanPanel {
    /// Creates the panel, open for a layout that has nothing else to show.
    pub fn new(boards: usize, spaces: usize) -> Self {
        Self {
            is_open: boards == 0 && spaces > 0,
            ..Self::default()
        }
    }

    /// Returns `true` while something is dragged.
    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Returns the part of the plan that the view shows.
    pub fn viewport(&mut self) -> &mut AreaViewport {
        &mut self.viewports[self.view.index()]
    }
}

impl EditorPanel {
    /// Shows all boards, and selects those on which something was selected.
    pub(super) fn open_plan(&mut self) {
        self.cancel_drag();
        self.plan.is_open = true;
        self.plan.is_left = false;
        self.select_boards();
        self.selected.clear();
    }

    /// Selects the boards on which something is selected.
    pub(super) fn select_boards(&mut self) {
        let selection = self.editor.selection().iter();
        let boards = selection.map(|part| part.board().map_or(*part, Part::Board));
        self.editor.select(boards.collect::<Vec<_>>());
    }

    /// Shows all boards from a direction.
    pub(super) fn view_plan(&mut self, view: PlanView) {
        if !self.plan.is_open {
            self.open_plan();
        }
        self.end_drag();
        self.plan.view = match self.plan.free {
            Some(free) if view.is_free() => free,
            _ => view,
        };
    }

    /// Shows one board in place of the plan.
    pub(super) fn leave_plan(&mut self, board: usize) {
        if self.plan.is_open {
            self.end_drag();
            self.plan.is_open = false;
            self.plan.is_left = true;
            // Parts are selected there on the board, not the board itself.
            self.editor.select([]);
        }
        self.show_board(board);
    }

    /// Shows the board to which a new control is added: the selected one, or the one that comes with the control.
    pub(super) fn leave_plan_for_control(&mut self) {
        if self.plan.is_open && self.editor.is_editable() {
            let board = match *self.editor.selection() {
                [Part::Board(board)] => board,
                _ => self.board,
            };
            self.leave_plan(board);
        }
    }

    /// Returns `true` if Escape has an effect.
    pub(super) fn can_escape(&self) -> bool {
        let plan = &self.plan;
        if plan.is_open {
            plan.drag.is_some() || !self.editor.selection().is_empty()
        } else {
            plan.is_left || self.is_dragging_on_canvas() || !self.selected.is_empty()
        }
    }

    /// Ends a drag and takes it back, or deselects everything, or shows the plan from which a board was opened.
    pub(super) fn escape(&mut self) {
        if self
            .plan
            .drag
            .as_ref()
            .is_some_and(|drag| self.is_current(drag) && drag.edit.is_some())
        {
            self.editor.take_back();
            self.message = None;
        }
        if self.plan.is_dragging() {
            self.end_drag();
        } else if self.plan.is_open {
            self.editor.select([]);
        } else if self.is_dragging_on_canvas() {
            self.cancel_drag();
        } else if self.selected.is_empty() {
            self.open_plan();
        } else {
            self.selected.clear();
            self.select_items_in_editor();
        }
    }

    pub(super) fn end_drag(&mut self) {
        self.plan.drag = None;
        self.plan.preview = Preview::default();
    }

    /// Returns `true` if nothing but a drag has changed the text since it began.
    pub(super) fn is_current(&self, drag: &PlanDrag) -> bool {
        drag.revision == self.editor.revision()
    }

    /// Selects all boards and targets in space.
    pub(super) fn select_all_in_plan(&mut self) {
        let items = self.plan.plan.items.iter();
        let parts: Vec<Part> = items.map(|item| item.part).collect();
        self.editor.select(parts);
    }

    /// Shows everything in the next frame of a view.
    pub(super) fn show_all_in_plan(&mut self) {
        *self.plan.viewport() = AreaViewport::default();
    }

    /// Returns the extent of the selected items in the picture.
    fn selected_extent(&self) -> Option<Bounds> {
        let (plan, selection) = (&self.plan.plan, self.editor.selection());
        plan.extent(self.plan.view, |part| selection.contains(&part))
    }

    /// Shows everything if something was added that is not in the picture. It is selected.
    fn show_added_in_plan(&mut self) {
        if !mem::take(&mut self.plan.has_added) {
            return;
        }
        let (added, size) = (self.selected_extent(), self.plan.size);
        let seen = self.plan.viewport().visible(size);
        if let (Some(added), Some(seen)) = (added, seen)
            && !seen.encloses(added)
        {
            self.show_all_in_plan();
        }
    }

    /// Shows the selected items as large as they fit, or everything without any.
    pub(super) fn zoom_to_selection_in_plan(&mut self) {
        let chosen = self
            .selected_extent()
            .zip(self.plan.size)
            .map(|(bounds, size)| AreaViewport::fixed(Viewport::fit(bounds, size)));
        *self.plan.viewport() = chosen.unwrap_or_default();
    }

    /// Returns the edit that moves items by a distance on the picture, in millimetres.
    pub(super) fn movement_in_plan(&self, parts: &[Part], by: Vec2) -> Option<Edit> {
        gesture::moved(self.plan.view, parts, by)
    }

    /// Returns the selected boards and targets in space.
    pub(super) fn selected_in_plan(&self) -> Vec<Part> {
        let selection = self.editor.selection().iter().copied();
        let is_item = |part: &Part| self.plan.plan.item(*part).is_some();
        selection.filter(is_item).collect()
    }

    /// Places everything again after a change of the text. The last layout that could be read stays.
    fn update_plan(&mut self, context: &PanelContext) {
        let revision = self.editor.revision();
        if self.plan.shown == Some(revision) || !self.editor.is_read() {
            return;
        }
        let Some(layout) = self.editor.layout() else {
            return;
        };
        self.plan.shown = Some(revision);
        self.plan.hands = at_start(context.sensors.setup().hands_at_rest(layout));
        self.plan.plan = Plan::new(&self.editor, layout, &self.plan.hands);
    }
}

/// The directions from which the plan is seen, with their words.
pub(super) const VIEWS: [(&str, PlanView); PlanView::ALL.len()] = [
    ("view-above", PlanView::Above),
    ("editor-view-front", PlanView::Front),
    ("view-side", PlanView::Side),
    ("editor-view-free", PlanView::FREE),
];

/// Shows the directions from which the plan is seen.
pub(super) fn show_views(ui: &mut egui::Ui, panel: &mut EditorPanel) {
    for (name, view) in VIEWS {
        let is_shown = panel.plan.view.index() == view.index();
        if ui.selectable_label(is_shown, text(name)).clicked() {
            panel.view_plan(view);
        }
    }
}

/// Shows the plan.
pub(super) fn show(ui: &mut egui::Ui, panel: &mut EditorPanel, context: &PanelContext) {
    let (room, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let is_held = pointer::is_held(ui);
    let area = pointer::steady_area(room, panel.plan.size, is_held);
    let size = Vec2::new(area.width(), area.height());
    if size.min_element() < 1.0 {
        return;
    }
    panel.plan.size = Some(size);
    panel.update_plan(context);
    panel.show_added_in_plan();
    let name = text("editor-plan-canvas");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, name));
    canvas::keep_arrow_keys(ui, &response);
    free_view::turn_by_mouse(ui, &response, panel);
    let view = panel.plan.view;
    let bounds = panel.plan.plan.extent(view, |_| true);
    let revision = panel.editor.revision();
    let mut viewport = panel
        .plan
        .viewport()
        .update(bounds, size, revision, is_held);
    let to_local = |at: egui::Pos2| Vec2::new(at.x - area.min.x, at.y - area.min.y);
    let pans = if view.is_free() {
        free_view::pans(ui, &response)
    } else {
        canvas::pans(&response)
    };
    canvas::move_view(ui, &response, &mut viewport, pans, to_local, size);
    panel.plan.viewport().move_to(viewport);
    if panel.plan.is_dragging() && pointer::is_touch_cancelled(ui) {
        panel.escape();
    }
    if let Some(at) = pointer::position(ui, &response, panel.plan.is_dragging()) {
        let to_picture = |point| viewport.to_board(to_local(point), size);
        for change in pointer::changes(ui) {
            let place = (to_picture(change.at), viewport.scale);
            if !change.is_pressed {
                plan_drag::end(panel, &response, place, change.modifiers);
            } else if pointer::is_on(&response, &change) {
                canvas::leave_fields(panel, &response);
                panel.update_plan(context);
                plan_drag::begin(panel, place, change.modifiers.shift);
            }
        }
        let place = (to_picture(at), viewport.scale);
        handle_mouse(ui, panel, &response, place);
        set_cursor(ui, panel, place);
        // The same picture shows the changes of a drag.
        panel.update_plan(context);
    }
    if !ui.input(|input| input.pointer.button_down(PointerButton::Primary)) {
        panel.end_drag();
    }
    palette::show_menu(&response, panel);
    let model = context.session;
    let values = canvas::live_layout(panel, model).map(|_| &model.values);
    paint(ui, panel, values, (area, &viewport));
    show_names(ui, panel, (area, &viewport));
    if panel.has_rulers {
        let selection = panel.editor.selection();
        let plan = &panel.plan.plan;
        let selected = plan.bounds(view, |part| selection.contains(&part));
        rulers::paint(ui, (area, &viewport), selected);
    }
}

fn handle_mouse(
    ui: &egui::Ui,
    panel: &mut EditorPanel,
    response: &egui::Response,
    (point, scale): (Vec2, f32),
) {
    let view = panel.plan.view;
    let hit = (point, HIT_REACH / scale);
    if response.double_clicked() {
        let plan = &panel.plan.plan;
        let item = plan.item_at(view, hit, panel.editor.selection());
        if let Some(board) = item.and_then(|item| item.part.board()) {
            panel.leave_plan(board);
            return;
        }
    }
    if response.secondary_clicked()
        && let Some(item) = panel.plan.plan.item_at(view, hit, panel.editor.selection())
        && !panel.editor.selection().contains(&item.part)
    {
        panel.editor.select([item.part]);
    }
    if response.dragged_by(PointerButton::Primary) {
        let modifiers = ui.input(|input| input.modifiers);
        plan_drag::follow(panel, (point, scale), modifiers);
    }
}

fn set_cursor(ui: &egui::Ui, panel: &EditorPanel, (point, scale): (Vec2, f32)) {
    let plan = &panel.plan;
    let handle = match *panel.editor.selection() {
        [part] => plan
            .plan
            .item(part)
            .and_then(|item| handles::handle_at(item, plan.view, point, scale)),
        _ => None,
    };
    let icon = match plan.drag.as_ref().map(|drag| &drag.gesture) {
        Some(PlanGesture::Move { .. }) => egui::CursorIcon::Grabbing,
        Some(PlanGesture::Handle { .. }) => egui::CursorIcon::Crosshair,
        None if handle.is_some() => egui::CursorIcon::Crosshair,
        _ => return,
    };
    ui.ctx().set_cursor_icon(icon);
}

fn paint(
    ui: &egui::Ui,
    panel: &EditorPanel,
    values: Option<&BTreeMap<TargetId, f32>>,
    (area, viewport): (egui::Rect, &Viewport),
) {
    let colors = look::scene_colors(ui.visuals());
    let size = Vec2::new(area.width(), area.height());
    let painter = ui.painter_at(area);
    let (nothing, still) = (Selection::default(), Preview::default());
    let empty = |preview, has_grid| CanvasScene {
        has_grid,
        ..CanvasScene::new(&[], &nothing, preview)
    };
    let grid = draw::draw(&empty(&still, true), viewport, size, &colors);
    space::paint(&painter, area, &grid, colors.background);
    let plan = &panel.plan;
    if let Some(layout) = panel.editor.layout() {
        let scene = PlanScene {
            layout,
            plan: &plan.plan,
            hands: &plan.hands,
            view: plan.view,
            viewport,
            selected: panel.editor.selection(),
            values,
            faulty: &|part| panel.editor.is_faulty(part),
        };
        for picture in draw_plan(&scene, size, &colors) {
            space::paint_over(&painter, area, &picture);
        }
    }
    let marks = draw::draw(&empty(&plan.preview, false), viewport, size, &colors);
    space::paint_over(&painter, area, &marks);
    let hint = text(if plan.view.is_free() {
        "editor-plan-free-hint"
    } else {
        "editor-plan-hint"
    });
    let background = space::hint_background(colors.background);
    space::show_hint(ui, area, hint, background);
}

/// Shows the names of the boards, and tells screen readers where everything is.
fn show_names(ui: &egui::Ui, panel: &EditorPanel, (area, viewport): (egui::Rect, &Viewport)) {
    let size = Vec2::new(area.width(), area.height());
    let painter = ui.painter_at(area);
    let (view, selection) = (panel.plan.view, panel.editor.selection());
    for item in &panel.plan.plan.items {
        let bounds = item.bounds(view);
        let [min, max] = [bounds.min, bounds.max].map(|at| viewport.to_screen(at, size));
        let corners = [min, max].map(|at| area.min + egui::vec2(at.x, at.y));
        let place = egui::Rect::from_two_pos(corners[0], corners[1]);
        let name = match item.part {
            Part::Board(board) => panel.board_name(board),
            part => panel.editor.part_name(part).unwrap_or_default(),
        };
        let response = ui.interact(place, ui.scope_id().with(item.part), Sense::hover());
        let is_selected = selection.contains(&item.part);
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::GraphicsObject, true, is_selected, &name)
        });
        if item.board().is_some() {
            let color = ui.visuals().strong_text_color();
            let words = painter.layout_no_wrap(name, egui::FontId::proportional(12.0), color);
            let at = place.left_top() - egui::vec2(0.0, 8.0);
            let tag = egui::Align2::LEFT_BOTTOM.anchor_size(at, words.size());
            let background = ui.visuals().extreme_bg_color.gamma_multiply(0.7);
            painter.rect_filled(tag.expand2(egui::vec2(4.0, 1.0)), 3.0, background);
            painter.galley(tag.min, words, color);
        }
    }
}
