//! The items of a board in the text of an editor, with those that have an error.

use super::group;
use crate::canvas::board::BoardItems;
use crate::canvas::{Item, ItemShape};
use crate::editor::{LayoutEditor, Part, can_turn};
use ademan_core::layout::Layout;

/// Returns the items of a board that are in the layout of the present text, where the file has them. `design` is that layout for the
/// design hand, if the hands of the session are others.
pub(super) fn placed(
    editor: &LayoutEditor,
    design: Option<&Layout>,
    board: usize,
) -> Option<BoardItems> {
    let used = editor.layout().filter(|_| editor.is_read())?;
    let used_board = used.boards.get(board)?;
    let scale = editor.number(Part::Board(board), "pose.scale");
    let scale = scale.unwrap_or(1.0) as f32;
    let Some(layout) = design else {
        return Some(BoardItems::new(used, used_board, scale));
    };
    let items = BoardItems::new(layout, layout.boards.get(board)?, scale);
    Some(items.below_fingertips(used, used_board))
}

/// Adds the items of a board that are not in the layout because of an error. Returns the parts of all items.
pub(super) fn add_unplaced(
    editor: &LayoutEditor,
    board: usize,
    items: &mut BoardItems,
) -> Vec<Option<Part>> {
    let targets = items.targets.iter();
    let mut parts: Vec<Option<Part>> = targets.map(|target| editor.part_of(*target)).collect();
    for (part, place) in editor.unplaced(board) {
        let name = editor.part_name(part).unwrap_or_default();
        let item = Item::written(&place, name, can_turn(part));
        items.items.push(item);
        parts.push(Some(part));
    }
    parts
}

/// Returns the items that have an error, or whose group has one.
pub(super) fn faulty(editor: &LayoutEditor, parts: &[Option<Part>]) -> Vec<usize> {
    let has_error =
        |part: Part| editor.is_faulty(part) || group(part).is_some_and(|it| editor.is_faulty(it));
    let indices = parts.iter().enumerate();
    let found = indices.filter(|(_, part)| part.is_some_and(has_error));
    found.map(|(index, _)| index).collect()
}

/// Returns the outlines of the items of a board that have an error.
pub(super) fn faulty_outlines(editor: &LayoutEditor, board: usize) -> Vec<ItemShape> {
    let design = editor.design_layout();
    let mut items = placed(editor, design.as_ref(), board).unwrap_or_default();
    let parts = add_unplaced(editor, board, &mut items);
    let indices = faulty(editor, &parts).into_iter();
    indices.map(|index| items.items[index].shape).collect()
}

#[cfg(test)]
mod tests {
    use parry3d::math::Vec2;

    use super::*;
    use ademan_core::hand::Side;
    use ademan_core::kinematics::{ArmModel, BoneLengths};
    use ademan_core::layout::Fit;

    #[test]
    fn a_board_for_another_hand_has_the_millimetres_of_its_file() {
        let bones = BoneLengths::from_hand_and_forearm(0.16, 0.2).unwrap();
        let arm = ArmModel::anthropometric(Side::Right, &bones).unwrap();
        let fit = Fit::new(&arm, None).unwrap();
        let text = "Layout(name: \"a\", boards: [(pose: (anchor: elbow), shape: Arc(radius_mm: 320), keys: [\n\
                    (code: \"A\", at_mm: (0, 0)),\n(code: \"B\", at_mm: (40, 10))])])";
        let editor = LayoutEditor::from_text("a.ron", text, fit);
        assert_eq!(editor.problems(), []);
        let used = &editor.layout().unwrap().keys[1].face;
        let in_file = Vec2::new(40.0, 10.0);
        assert!((used.row_position * 1e3 - in_file).length() > 1.0);
        let design = editor.design_layout();
        let items = placed(&editor, design.as_ref(), 0).unwrap();
        assert_eq!(items.radius, Some(320.0));
        let shape = items.items[1].shape;
        assert!((shape.center - in_file).length() < 1e-3, "{shape:?}");
        assert!((shape.half - 8.5).length() < 1e-3, "{shape:?}");
        let above = used.outline.center.extend(0.02);
        let tip = items.fingertip(above).unwrap();
        assert!((tip.position - in_file).length() < 0.1, "{tip:?}");
    }
}
