//! The order of boards that cover each other.

use super::tests::{drawn, editor, plan};
use super::*;

const ABOVE_EACH_OTHER: &str = "Layout(name: \"Two boards\", boards: [
    (
        pose: (anchor: elbow, forward_mm: 320, height_mm: -45),
        keys: [(code: \"A\", at_mm: (0, 0))],
    ),
    (
        pose: (anchor: elbow, forward_mm: 320, height_mm: -20),
        keys: [(code: \"B\", at_mm: (0, 0))],
    ),
])
";

/// Returns the label of the item that is drawn last.
fn topmost(edited: &LayoutEditor, view: PlanView) -> String {
    let pictures = drawn(edited, view);
    // Above the items are only what marks them.
    let items = &pictures[..pictures.len() - 1];
    let labels = items.last().unwrap().labels.iter();
    labels.map(|label| label.text.as_str()).collect()
}

#[test]
fn the_selected_board_is_seen_and_hit_from_above_though_it_is_lower() {
    let mut edited = editor(ABOVE_EACH_OTHER);
    let placed = plan(&edited);
    let hit = |view: PlanView, selected: &[Part]| {
        let point = view.flatten(placed.items[0].center());
        placed.item_at(view, (point, 2.5), selected).unwrap().part
    };
    let lower = Part::Board(0);
    assert_eq!(topmost(&edited, PlanView::Above), "B");
    assert_eq!(hit(PlanView::Above, &[]), Part::Board(1));
    edited.select([lower]);
    assert_eq!(topmost(&edited, PlanView::Above), "A");
    assert_eq!(hit(PlanView::Above, &[lower]), lower);
    // From elsewhere boards cover each other as in space.
    let free = PlanView::FREE.turned(Vec2::Y * 1e4);
    assert_eq!(topmost(&edited, free), "B");
    assert_eq!(hit(free, &[lower]), Part::Board(1));
}
