//! Boards and targets in space on the plan, and drags of them.

use std::collections::BTreeMap;

use super::gesture::{PlanGesture, begin, moved};
use super::handles::{PlanHandle, handles, pivot, radius_at};
use super::*;
use crate::canvas::snap::SnapSettings;
use crate::canvas::viewport::Viewport;
use crate::picture::Picture;
use crate::scene::{PlanScene, SceneColors, draw_plan};
use ademan_core::contact::TargetId;
use ademan_core::hand::{Joint, Side};
use ademan_core::layout::Fit;
use ademan_core::time::Timestamp;

/// Points per millimetre.
const SCALE: f32 = 2.0;

const TWO_BOARDS: &str = "// mine
Layout(
    name: \"Two boards\",
    boards: [
        // fingers
        (
            pose: (anchor: elbow, forward_mm: 320, height_mm: -45, /* x */ right_mm: 4.50),
            keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (19, 0))],
        ),
        // thumb
        (
            pose: (anchor: elbow, bearing_deg: 35, forward_mm: 200, height_mm: -45),
            shape: Arc(radius_mm: 60),
            pitch_mm: 22,
            rows: [(at_mm: (-44, 0), keys: \"C D E F G\")],
        ),
    ],
)
";

const IN_SPACE: &str = "Layout(name: \"a\", spaces: [(pose: (anchor: elbow), targets: [
    (name: \"Moon\", at_mm: (120, 0, -300), shape: Ball(50)), // a ball
    (name: \"Door\", at_mm: (160, 50, -320), shape: Box(60, 40, 30)),
])])";

pub(crate) fn editor(text: &str) -> LayoutEditor {
    LayoutEditor::from_text("a.ron", text, Fit::default())
}

/// Returns the plan around a hand with its elbow in the origin and its wrist 0.25 m before it.
pub(crate) fn plan(editor: &LayoutEditor) -> Plan {
    let mut hand = HandPose::new(Timestamp(0), Side::Right, 0.005);
    hand.set(Joint::Elbow, Pose::IDENTITY);
    hand.set(Joint::Wrist, Pose::from_translation(Vec3::Z * -0.25));
    Plan::new(editor, editor.layout().unwrap(), &[hand])
}

/// Drags from one point to others, and makes the edits as the panel does.
fn drag(editor: &mut LayoutEditor, view: PlanView, from: Vec2, to: &[Vec2], snap: SnapSettings) {
    let before = plan(editor);
    let mut selected = editor.selection().to_vec();
    let gesture = begin(&before, &mut selected, view, (from, SCALE), false);
    editor.select(selected);
    let mut is_begun = false;
    for point in to {
        if let Some(edit) = gesture.change(view, *point, snap).edit {
            let edited = if is_begun {
                editor.amend(&edit)
            } else {
                editor.apply(&edit)
            };
            edited.unwrap();
            is_begun = true;
        }
    }
}

fn center(plan: &Plan, part: Part, view: PlanView) -> Vec2 {
    view.flatten(plan.item(part).unwrap().center())
}

fn position_of(handle: PlanHandle, plan: &Plan, part: Part, view: PlanView) -> Option<Vec2> {
    let found = handles(plan.item(part).unwrap(), view, SCALE);
    found
        .iter()
        .find(|(own, _)| *own == handle)
        .map(|(_, at)| *at)
}

#[test]
fn a_drag_in_the_front_view_changes_x_and_height_by_its_millimetres_and_nothing_else() {
    let mut editor = editor(TWO_BOARDS);
    let from = center(&plan(&editor), Part::Board(0), PlanView::Front);
    let to = [
        Vec2::new(3.0, 1.0),
        Vec2::new(30.25, 8.5),
        Vec2::new(12.3, -7.0),
    ];
    let to = to.map(|by| from + by);
    drag(&mut editor, PlanView::Front, from, &to, SnapSettings::OFF);
    let moved = TWO_BOARDS
        .replace("right_mm: 4.50", "right_mm: 16.8")
        .replacen("height_mm: -45", "height_mm: -52", 1);
    assert_eq!(editor.text(), moved);
    assert_eq!(editor.selection(), [Part::Board(0)]);
    assert!(editor.undo());
    assert_eq!(editor.text(), TWO_BOARDS, "a drag is one step");
    assert!(!editor.can_undo());
}

#[test]
fn a_moved_board_has_round_numbers_and_snaps_to_edges_of_others() {
    let mut editor = editor(TWO_BOARDS);
    let snap = SnapSettings {
        grid_mm: 1.0,
        reach_mm: 1.5,
    };
    let before = plan(&editor);
    let from = center(&before, Part::Board(0), PlanView::Above);
    let to = [from + Vec2::new(-300.3, 200.4)];
    drag(&mut editor, PlanView::Above, from, &to, snap);
    assert!(
        editor.text().contains("right_mm: -296"),
        "{}",
        editor.text()
    );
    assert!(
        editor.text().contains("forward_mm: 520"),
        "{}",
        editor.text()
    );
    let bounds = |part: Part| before.item(part).unwrap().bounds(PlanView::Above);
    let (own, other) = (bounds(Part::Board(0)), bounds(Part::Board(1)));
    let nearly = Vec2::new(other.min.x - own.min.x + 0.8, -60.0);
    let gesture = begin(
        &before,
        &mut Vec::new(),
        PlanView::Above,
        (from, SCALE),
        false,
    );
    let change = gesture.change(PlanView::Above, from + nearly, snap);
    assert_eq!(change.guides.len(), 1, "{change:?}");
    assert!((change.guides[0].from.x - other.min.x).abs() < 1e-3);
}

#[test]
fn a_press_without_a_motion_moves_nothing_to_the_grid_or_an_edge() {
    let mut editor = editor(TWO_BOARDS);
    let snap = SnapSettings {
        grid_mm: 1.0,
        reach_mm: 500.0,
    };
    for view in PlanView::ALL {
        for board in [Part::Board(0), Part::Board(1)] {
            let from = center(&plan(&editor), board, view);
            drag(&mut editor, view, from, &[from], snap);
        }
    }
    assert_eq!(editor.text(), TWO_BOARDS);
    assert!(!editor.can_undo());
}

#[test]
fn boards_with_different_bearings_move_together() {
    let mut editor = editor(TWO_BOARDS);
    editor.select([Part::Board(0), Part::Board(1)]);
    let before = plan(&editor);
    let from = center(&before, Part::Board(1), PlanView::Side);
    let to = [from + Vec2::new(25.0, 5.0)];
    drag(&mut editor, PlanView::Side, from, &to, SnapSettings::OFF);
    let after = plan(&editor);
    for board in [Part::Board(0), Part::Board(1)] {
        let center = |plan: &Plan| plan.item(board).unwrap().center() * 1e3;
        let way = center(&after) - center(&before);
        assert!(way.distance(Vec3::new(0.0, 5.0, -25.0)) < 0.02, "{way}");
    }
    assert!(editor.undo());
    assert_eq!(editor.text(), TWO_BOARDS);
}

#[test]
fn a_target_in_space_moves_in_the_plane_of_the_view() {
    let mut editor = editor(IN_SPACE);
    let moon = Part::SpaceTarget { space: 0, index: 0 };
    let from = center(&plan(&editor), moon, PlanView::Side);
    let to = [from + Vec2::new(40.0, 15.0)];
    drag(&mut editor, PlanView::Side, from, &to, SnapSettings::OFF);
    let expected = IN_SPACE.replace("(120, 0, -300)", "(120, 15, -340)");
    assert_eq!(editor.text(), expected);
    assert_eq!(editor.selection(), [moon]);
}

#[test]
fn the_rows_of_an_arc_are_curved_and_a_board_is_at_its_anchor() {
    let text = TWO_BOARDS.replace("anchor: elbow, bearing_deg: 35", "anchor: wrist");
    let plan = plan(&editor(&text));
    let thumb = plan.item(Part::Board(1)).unwrap();
    let center = PlanView::Above.flatten(thumb.center());
    assert!((center - Vec2::new(0.0, 450.0)).length() < 1e-2, "{center}");
    let [near, _] = &thumb.board().unwrap().edges;
    let [end, middle] = [0, CURVE_STEPS / 2].map(|index| PlanView::Above.flatten(near[index]));
    assert!(middle.y - end.y > 10.0, "{end} {middle}");
    // Beside the middle of the row, on the side of the wearer, there is no key.
    let hollow = center - Vec2::Y * 20.0;
    assert!(!thumb.contains(PlanView::Above, hollow, 2.0));
    assert!(thumb.contains(PlanView::Above, center, 2.0));
}

#[test]
fn the_nearest_of_several_items_is_hit_also_along_its_edge() {
    let higher = TWO_BOARDS.replace(
        "bearing_deg: 35, forward_mm: 200, height_mm: -45",
        "forward_mm: 320, height_mm: -20",
    );
    let plan = plan(&editor(&higher));
    let at = |view: PlanView, by: Vec2| {
        let point = center(&plan, Part::Board(0), view) + by;
        plan.item_at(view, (point, 2.5), &[]).map(|item| item.part)
    };
    assert_eq!(at(PlanView::Above, Vec2::ZERO), Some(Part::Board(1)));
    assert_eq!(at(PlanView::Front, Vec2::ZERO), Some(Part::Board(0)));
    assert_eq!(at(PlanView::Front, Vec2::Y * 25.0), Some(Part::Board(1)));
    assert_eq!(at(PlanView::Front, Vec2::Y * 12.0), None);
}

#[test]
fn a_rubber_band_selects_what_it_touches() {
    let plan = plan(&editor(IN_SPACE));
    let view = PlanView::Front;
    let mut selected = Vec::new();
    let from = (Vec2::new(0.0, -100.0), SCALE);
    let gesture = begin(&plan, &mut selected, view, from, false);
    assert!(matches!(gesture, PlanGesture::Band { .. }));
    let selected_at = |x: f32| {
        gesture
            .selected(&plan, view, Vec2::new(x, 100.0))
            .unwrap()
            .len()
    };
    assert_eq!(
        [selected_at(50.0), selected_at(100.0), selected_at(150.0)],
        [0, 1, 2]
    );
}

#[test]
fn the_round_handle_turns_a_board_in_the_view_from_above_only() {
    let mut editor = editor(TWO_BOARDS);
    editor.select([Part::Board(1)]);
    let before = plan(&editor);
    let (view, thumb) = (PlanView::Above, Part::Board(1));
    let from = position_of(PlanHandle::Turn, &before, thumb, view).unwrap();
    assert_eq!(
        position_of(PlanHandle::Turn, &before, thumb, PlanView::Front),
        None
    );
    let pivot_of = |plan: &Plan| pivot(plan.item(thumb).unwrap().board().unwrap(), view);
    let around = pivot_of(&before);
    let to = around + Vec2::from_angle(41.0_f32.to_radians()).rotate(from - around);
    let snap = SnapSettings {
        grid_mm: 1.0,
        reach_mm: 0.0,
    };
    drag(&mut editor, view, from, &[to], snap);
    let value = |field| editor.value(thumb, field);
    assert_eq!(
        value("pose.bearing_deg"),
        Some("-5"),
        "35° − 41°, in steps of 5°"
    );
    assert!(
        (pivot_of(&plan(&editor)) - around).length() < 0.05,
        "the center of the arcs stays"
    );
}

#[test]
fn a_handle_tilts_a_board_where_the_view_shows_it() {
    let mut editor = editor(TWO_BOARDS);
    editor.select([Part::Board(0)]);
    let before = plan(&editor);
    let (view, board) = (PlanView::Side, Part::Board(0));
    assert_eq!(
        position_of(PlanHandle::Tilt, &before, board, PlanView::Front),
        None
    );
    let from = position_of(PlanHandle::Tilt, &before, board, view).unwrap();
    let origin = center(&before, board, view);
    let to = origin + Vec2::from_angle(0.55) * 40.0;
    drag(&mut editor, view, from, &[to], SnapSettings::OFF);
    assert_eq!(editor.value(board, "pose.tilt_deg"), Some("31.5"));
    assert_eq!(center(&plan(&editor), board, view), origin);
}

#[test]
fn a_handle_bends_a_curved_board_to_the_mouse() {
    for (pose, view) in [
        ("forward_mm: 200, ", PlanView::Above),
        ("", PlanView::Above),
        ("forward_mm: 200, tilt_deg: 90, ", PlanView::Front),
    ] {
        let pose = format!("anchor: elbow, {pose}height_mm: -45");
        let text = TWO_BOARDS.replace(
            "anchor: elbow, bearing_deg: 35, forward_mm: 200, height_mm: -45",
            &pose,
        );
        let mut editor = editor(&text);
        let thumb = Part::Board(1);
        editor.select([thumb]);
        let before = plan(&editor);
        let from = position_of(PlanHandle::Bend, &before, thumb, view).unwrap();
        let board = before.item(thumb).unwrap().board().unwrap();
        assert!((radius_at(board, view, from) - 60.0).abs() < 0.5, "{pose}");
        let beside = from + Vec2::new(1.0, 1.0);
        drag(&mut editor, view, beside, &[beside], SnapSettings::OFF);
        assert_eq!(editor.text(), text, "a press beside the middle");
        let to = from + Vec2::new(4.0, 9.0);
        drag(&mut editor, view, from, &[to], SnapSettings::OFF);
        let radius: f64 = editor
            .value(thumb, "shape.radius_mm")
            .unwrap()
            .parse()
            .unwrap();
        assert!(radius > 62.0 && radius < 120.0, "{pose}: {radius}");
        let after = position_of(PlanHandle::Bend, &plan(&editor), thumb, view).unwrap();
        let distance = |at: Vec2| (at - to).length();
        assert!(
            distance(after) < distance(from),
            "{pose}: {after} {from} {to}"
        );
        assert!(editor.undo());
        assert_eq!(editor.text(), text);
    }
    let flat = plan(&editor(TWO_BOARDS));
    let edge = position_of(PlanHandle::Bend, &flat, Part::Board(1), PlanView::Side);
    assert_eq!(edge, None, "a flat board is seen along its plane");
    assert_eq!(
        position_of(PlanHandle::Bend, &flat, Part::Board(0), PlanView::Above),
        None
    );
}

/// Draws a plan on a picture in which everything fits.
pub(super) fn drawn(editor: &LayoutEditor, view: PlanView) -> Vec<Picture> {
    drawn_with(editor, view, None)
}

fn drawn_with(
    editor: &LayoutEditor,
    view: PlanView,
    values: Option<&BTreeMap<TargetId, f32>>,
) -> Vec<Picture> {
    let plan = plan(editor);
    let size = Vec2::new(800.0, 600.0);
    let viewport = Viewport::fit(plan.bounds(view, |_| true).unwrap(), size);
    let scene = PlanScene {
        layout: editor.layout().unwrap(),
        plan: &plan,
        hands: &[],
        view,
        viewport: &viewport,
        selected: editor.selection(),
        values,
        faulty: &|part| editor.is_faulty(part),
    };
    draw_plan(&scene, size, &SceneColors::LIGHT)
}

/// Returns `true` if something on the plan has the color of faults.
fn is_red(editor: &LayoutEditor) -> bool {
    let pictures = drawn(editor, PlanView::Above);
    let fault = SceneColors::LIGHT.fault;
    let mut corners = pictures.iter().flat_map(|it| &it.above.vertices);
    corners.any(|(_, color)| *color == fault)
}

#[test]
fn controls_that_overlap_are_red_while_they_do() {
    let mut editor = editor(TWO_BOARDS);
    let nearer = crate::editor::Edit::Move {
        parts: vec![crate::editor::tests::key(1)],
        by_mm: [-9.0, 0.0, 0.0],
    };
    editor.apply(&nearer).unwrap();
    let faulty = |edited: &LayoutEditor| {
        let placed = plan(edited);
        let boards = placed.items.iter().filter_map(PlanItem::board);
        boards
            .map(|board| board.faulty_fronts.len())
            .collect::<Vec<_>>()
    };
    assert!(is_red(&editor));
    assert_eq!(faulty(&editor), [2, 0]);
    editor.undo();
    assert!(!is_red(&editor));
    assert_eq!(faulty(&editor), [0, 0]);
}

#[test]
fn boards_in_one_place_are_red_and_say_the_distance_while_they_are() {
    let mut editor = editor(TWO_BOARDS);
    assert!(!is_red(&editor));
    assert_eq!(editor.problems(), []);
    let mover = moved(PlanView::Above, &[Part::Board(1)], Vec2::new(-110.0, 156.0));
    editor.apply(&mover.unwrap()).unwrap();
    assert!(is_red(&editor));
    let plan = plan(&editor);
    let [overlap] = plan.overlaps[..] else {
        panic!("{:?}", plan.overlaps);
    };
    assert_eq!(overlap.boards, [0, 1]);
    let [problem] = editor.problems() else {
        panic!("{:?}", editor.problems());
    };
    let distance = format!("overlap by {:.1} mm", overlap.depth_mm);
    assert!(problem.message.contains(&distance), "{problem:?}");
    assert_eq!(
        problem.part,
        Some(Part::Board(1)),
        "a click selects the board"
    );
    editor.undo();
    assert!(!is_red(&editor));
}

#[test]
fn a_corner_of_a_plate_without_keys_is_within_the_extent() {
    let corner = "Layout(name: \"a\", boards: [(
        pose: (anchor: elbow, bearing_deg: 45, forward_mm: 300),
        keys: [(code: \"A\", at_mm: (0, 0)), (code: \"B\", at_mm: (200, 0)), (code: \"C\", at_mm: (0, 100))],
    )])";
    let plan = plan(&editor(corner));
    let extent = plan.extent(PlanView::Above, |_| true).unwrap();
    let board = plan.items[0].board().unwrap();
    let mut corners = board.outline().map(|at| PlanView::Above.flatten(at));
    assert!(corners.all(|at| extent.min.cmple(at).all() && extent.max.cmpge(at).all()));
    let keys = plan.bounds(PlanView::Above, |_| true).unwrap();
    assert!(keys.size().max_element() < extent.size().max_element());
}

#[test]
fn keys_of_the_plan_are_where_they_are_hit() {
    let editor = editor(TWO_BOARDS);
    let pictures = drawn(&editor, PlanView::Above);
    let labels: Vec<&str> = pictures
        .iter()
        .flat_map(|picture| &picture.labels)
        .map(|label| label.text.as_str())
        .collect();
    for key in ["A", "B", "C", "D", "E", "F", "G"] {
        assert!(labels.contains(&key), "{key}: {labels:?}");
    }
}

#[test]
fn the_plan_of_a_running_session_has_the_numbers_of_values() {
    let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), sliders: [
        (name: \"Low\", at_mm: (0, 0), length_mm: 100, width_mm: 30)])])";
    let editor = editor(text);
    let values = BTreeMap::from([(TargetId(0), 0.25)]);
    let labels = |shown| -> Vec<String> {
        let pictures = drawn_with(&editor, PlanView::Above, shown);
        let labels = pictures.into_iter().flat_map(|it| it.labels);
        labels.map(|label| label.text).collect()
    };
    assert_eq!(labels(None), ["Low"]);
    assert_eq!(labels(Some(&values)), ["Low 0.25"]);
}
