//! The free view of the plan: drags and handles.

use super::gesture::begin;
use super::handles::{PlanHandle, handles, pivot};
use super::tests::{editor, plan};
use super::*;
use crate::canvas::snap::SnapSettings;
use ademan_core::layout::Fit;

/// Points per millimetre.
const SCALE: f32 = 2.0;

const TWO_BOARDS: &str = "Layout(name: \"Two boards\", boards: [
    (
        pose: (anchor: elbow, bearing_deg: 20, forward_mm: 320, height_mm: -45),
        keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (19, 0))],
    ),
    (
        pose: (anchor: elbow, forward_mm: 200, height_mm: -45),
        keys: [(code: \"C\", at_mm: (0, 0))],
    ),
])
";

const BOARD: Part = Part::Board(0);

/// Drags from one point to another with the first board selected, and makes the edit.
fn drag(editor: &mut LayoutEditor, view: PlanView, [from, to]: [Vec2; 2], snap: SnapSettings) {
    let mut selected = vec![BOARD];
    let gesture = begin(&plan(editor), &mut selected, view, (from, SCALE), false);
    assert_eq!(selected, [BOARD]);
    let edit = gesture.change(view, to, snap).edit.expect("an edit");
    editor.apply(&edit).unwrap();
}

fn center(editor: &LayoutEditor) -> Vec3 {
    plan(editor).item(BOARD).unwrap().center()
}

fn handle(editor: &LayoutEditor, view: PlanView, kind: PlanHandle) -> Option<Vec2> {
    let found = handles(plan(editor).item(BOARD).unwrap(), view, SCALE);
    found.iter().find(|(own, _)| *own == kind).map(|it| it.1)
}

fn number_of(editor: &LayoutEditor, field: &str) -> f64 {
    editor.number(BOARD, field).unwrap()
}

#[test]
fn a_board_follows_the_mouse_in_the_plane_of_the_picture() {
    let views = [Vec2::ZERO, Vec2::new(140.0, -60.0), Vec2::new(-90.0, -90.0)];
    for view in views.map(|by| PlanView::FREE.turned(by)) {
        let mut editor = editor(TWO_BOARDS);
        let before = center(&editor);
        let from = view.flatten(before);
        let by = Vec2::new(33.0, -21.0);
        drag(&mut editor, view, [from, from + by], SnapSettings::OFF);
        let moved = center(&editor) - before;
        assert!((view.flatten(moved) - by).length() < 0.02, "{view:?}");
        assert!(view.nearness(moved).abs() < 2e-5, "not towards the eye");
        assert!(editor.undo() && !editor.can_undo(), "one step");
    }
}

#[test]
fn edges_attract_only_along_the_axes_of_the_world() {
    let snap = SnapSettings {
        grid_mm: 0.0,
        reach_mm: 50.0,
    };
    for (view, is_attracted) in [(PlanView::Above, true), (PlanView::FREE, false)] {
        let mut editor = editor(TWO_BOARDS);
        let from = view.flatten(center(&editor));
        let by = Vec2::new(-60.0, -60.0);
        let mut selected = vec![BOARD];
        let gesture = begin(&plan(&editor), &mut selected, view, (from, SCALE), false);
        let change = gesture.change(view, from + by, snap);
        assert_eq!(!change.guides.is_empty(), is_attracted, "{view:?}");
        editor.apply(&change.edit.unwrap()).unwrap();
    }
}

#[test]
fn the_handle_on_the_ground_turns_a_board_by_the_angle_on_the_ground() {
    let view = PlanView::FREE;
    let mut editor = editor(TWO_BOARDS);
    let from = handle(&editor, view, PlanHandle::Turn).unwrap();
    let before = plan(&editor);
    let origin = pivot(before.item(BOARD).unwrap().board().unwrap(), view);
    // To a bearing of 65°: 45° to the right of its own.
    let (sin, cos) = 65_f32.to_radians().sin_cos();
    let to = origin + view.flatten(Vec3::new(sin, 0.0, -cos)) * 0.1;
    drag(&mut editor, view, [from, to], SnapSettings::OFF);
    assert!((number_of(&editor, "pose.bearing_deg") - 65.0).abs() < 0.15);
}

#[test]
fn the_upright_handle_tilts_a_board_to_the_mouse() {
    let view = PlanView::Free {
        azimuth: 1.2,
        elevation: 0.4,
    };
    let mut editor = editor(TWO_BOARDS);
    let from = handle(&editor, view, PlanHandle::Tilt).unwrap();
    let (sin, cos) = 20_f32.to_radians().sin_cos();
    let (rise, run) = 30_f32.to_radians().sin_cos();
    let away = Vec3::new(sin * run, rise, -cos * run);
    let to = view.flatten(center(&editor) + away * 0.1);
    drag(&mut editor, view, [from, to], SnapSettings::OFF);
    assert!((number_of(&editor, "pose.tilt_deg") - 30.0).abs() < 0.15);
}

#[test]
fn handles_that_a_view_cannot_drag_are_hidden() {
    let editor = LayoutEditor::from_text("a.ron", TWO_BOARDS, Fit::default());
    let from = |azimuth: f32, elevation: f32| {
        let view = PlanView::Free { azimuth, elevation };
        [PlanHandle::Turn, PlanHandle::Tilt].map(|kind| handle(&editor, view, kind).is_some())
    };
    assert_eq!(from(0.3, 1.57), [true, false], "from above");
    assert_eq!(from(1.2, 0.0), [false, true], "from the side");
    assert_eq!(from(-0.35, 0.2), [false, false], "along its bearing");
    assert_eq!(from(1.0, 0.7), [true, true]);
}
