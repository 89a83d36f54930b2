//! A drag of the primary button on the plan: its edit follows the mouse.

use eframe::egui;
use parry3d::math::Vec2;

use super::{EditorPanel, canvas, pointer};
use crate::canvas::plan::gesture::{self, PlanChange, PlanGesture};
use crate::editor::Edit;

/// A drag from its press on.
pub(super) struct PlanDrag {
    /// The point at which it has begun.
    from: Vec2,
    pub gesture: PlanGesture,
    /// The edit of the drag so far, which is the last one of the history.
    pub edit: Option<Edit>,
    /// Revision of the text after it. With another one the last edit does not belong to the drag.
    pub revision: u64,
}

/// Begins the drag of a press at a point, at a scale in points per millimetre. `adds` keeps what is selected.
pub(super) fn begin(panel: &mut EditorPanel, (point, scale): (Vec2, f32), adds: bool) {
    let view = panel.plan.view;
    let mut selected = panel.selected_in_plan();
    let plan = &panel.plan.plan;
    let gesture = gesture::begin(plan, &mut selected, view, (point, scale), adds);
    panel.editor.select(selected);
    panel.plan.drag = Some(PlanDrag {
        from: point,
        gesture,
        edit: None,
        revision: panel.editor.revision(),
    });
}

/// Makes the edit of a drag to a point.
pub(super) fn follow(
    panel: &mut EditorPanel,
    (point, scale): (Vec2, f32),
    modifiers: egui::Modifiers,
) {
    let Some(drag) = &panel.plan.drag else {
        return;
    };
    if !panel.is_current(drag) {
        panel.end_drag();
        return;
    }
    let view = panel.plan.view;
    let snap = canvas::snap_settings(panel, modifiers, scale);
    let selected = drag.gesture.selected(&panel.plan.plan, view, point);
    let change = drag.gesture.change(view, point, snap);
    if let Some(selected) = selected {
        panel.editor.select(selected);
    }
    make(panel, change);
}

/// Ends a drag by a release at a point.
pub(super) fn end(
    panel: &mut EditorPanel,
    response: &egui::Response,
    place: (Vec2, f32),
    modifiers: egui::Modifiers,
) {
    let from = panel.plan.drag.as_ref().map(|drag| drag.from);
    // The mouse has moved on since the last frame, which may have been before the drag.
    let is_drag = from.is_some_and(|from| pointer::is_drag(from, place));
    if is_drag || response.drag_stopped() {
        follow(panel, place, modifiers);
    }
    panel.end_drag();
}

/// Makes the edit of a drag, in place of its edit so far: one step of undo.
fn make(panel: &mut EditorPanel, change: PlanChange) {
    panel.plan.preview.guides = change.guides;
    panel.plan.preview.band = change.band;
    let Some(mut drag) = panel.plan.drag.take() else {
        return;
    };
    if drag.edit != change.edit {
        let result = match (&drag.edit, &change.edit) {
            (Some(_), Some(edit)) => panel.editor.amend(edit),
            (None, Some(edit)) => panel.editor.apply(edit),
            (_, None) => {
                panel.editor.take_back();
                Ok(())
            }
        };
        if result.is_ok() {
            drag.edit = change.edit;
        }
        panel.report(result);
        drag.revision = panel.editor.revision();
    }
    panel.plan.drag = Some(drag);
}
