//! Outlines that were dragged while the text is invalid, such as a key on top of another.

use crate::studio::canvas::ItemShape;
use crate::studio::canvas::board::BoardItems;

/// The outlines of the last valid layout that were dragged elsewhere since.
#[derive(Debug, Default)]
pub struct InvalidDrag {
    /// Revision of the text and index of the board that the outlines belong to.
    shown: Option<(u64, usize)>,
    shapes: Vec<(usize, ItemShape)>,
}

impl InvalidDrag {
    /// Adds the outlines of a drag that made the text invalid or left it so, to those of the text before it.
    pub fn add(
        &mut self,
        before: (u64, usize),
        after: (u64, usize),
        dragged: &[(usize, ItemShape)],
    ) {
        if self.shown != Some(before) {
            self.shapes.clear();
        }
        let is_dragged = |index: &usize| dragged.iter().any(|(other, _)| other == index);
        self.shapes.retain(|(index, _)| !is_dragged(index));
        self.shapes.extend(dragged);
        self.shown = Some(after);
    }

    /// Moves the items of a board to where they were dragged, if the text has not changed since.
    pub fn place(&self, shown: (u64, usize), items: &mut BoardItems) {
        if self.shown != Some(shown) {
            return;
        }
        for (index, shape) in &self.shapes {
            if let Some(item) = items.items.get_mut(*index) {
                item.shape = *shape;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Load;
    use crate::layout::Layout;

    fn items() -> BoardItems {
        let layout = Layout::load("qwerty-flat").unwrap();
        BoardItems::new(&layout, &layout.boards[0], 1.0)
    }

    fn moved(index: usize, by: f32) -> (usize, ItemShape) {
        let mut shape = items().items[index].shape;
        shape.center.x += by;
        (index, shape)
    }

    fn x_of(drag: &InvalidDrag, revision: u64, index: usize) -> f32 {
        let mut items = items();
        let old = items.items[index].shape.center.x;
        drag.place((revision, 0), &mut items);
        items.items[index].shape.center.x - old
    }

    #[test]
    fn dragged_items_stay_where_they_are_until_the_text_changes() {
        let mut drag = InvalidDrag::default();
        drag.add((1, 0), (2, 0), &[moved(0, 5.0)]);
        drag.add((2, 0), (3, 0), &[moved(1, 7.0)]);
        assert_eq!(
            [0, 1, 2].map(|index| x_of(&drag, 3, index)),
            [5.0, 7.0, 0.0]
        );
        assert_eq!(x_of(&drag, 4, 0), 0.0, "an undo restores the picture");
        drag.add((4, 0), (5, 0), &[moved(1, 2.0)]);
        assert_eq!([0, 1].map(|index| x_of(&drag, 5, index)), [0.0, 2.0]);
    }
}
