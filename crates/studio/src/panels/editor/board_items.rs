//! The items of a board in the text of an editor, with those that have an error.

use super::group;
use crate::canvas::board::BoardItems;
use crate::canvas::{Item, ItemShape};
use crate::editor::{LayoutEditor, Part, can_turn};

/// Returns the items of a board that are in the layout of the present text.
pub(super) fn placed(editor: &LayoutEditor, board: usize) -> Option<BoardItems> {
    let layout = editor.layout().filter(|_| editor.is_read())?;
    let scale = editor.number(Part::Board(board), "pose.scale");
    let scale = scale.unwrap_or(1.0) as f32;
    Some(BoardItems::new(layout, layout.boards.get(board)?, scale))
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
    let mut items = placed(editor, board).unwrap_or_default();
    let parts = add_unplaced(editor, board, &mut items);
    let indices = faulty(editor, &parts).into_iter();
    indices.map(|index| items.items[index].shape).collect()
}
