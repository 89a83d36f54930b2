//! A drag of the mouse on the canvas: what it moves, resizes, turns or selects.

use parry3d::math::Vec2;

use super::group::{self, Scaling};
use super::handles::{self, Handle};
use super::selection::{self, Selection};
use super::snap::{Guide, SnapSettings, snap_move};
use super::{Bounds, Item, ItemShape, item_at};

/// A drag of the primary button, from its start to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum Gesture {
    /// A rubber band from this point, in addition to what was selected before.
    Band {
        /// The start, in millimetres.
        from: Vec2,
        /// The selection to which it adds.
        before: Selection,
    },
    /// A motion of the selected items from this point.
    Move {
        /// The start, in millimetres.
        from: Vec2,
    },
    /// A drag of a handle of the only selected item from this point.
    Handle {
        /// The start, in millimetres.
        from: Vec2,
        /// The item.
        index: usize,
        /// The handle.
        handle: Handle,
    },
    /// A drag of a corner of the frame around several selected items from this point.
    Scale {
        /// The start, in millimetres.
        from: Vec2,
        /// The corner, by its index in [`CORNERS`](super::CORNERS).
        corner: usize,
    },
}

/// The result of a gesture so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preview {
    /// Items with the outline that they would have.
    pub shapes: Vec<(usize, ItemShape)>,
    /// Lines to which they have snapped.
    pub guides: Vec<Guide>,
    /// The rubber band.
    pub band: Option<Bounds>,
    /// The scaling of several items.
    pub scaling: Option<Scaling>,
}

/// Selects what a press is on, and starts a gesture. `adds` keeps what is selected, as with Shift.
pub fn begin(
    items: &[Item],
    selected: &mut Selection,
    point: Vec2,
    scale: f32,
    adds: bool,
) -> Gesture {
    if let Some(index) = selected.single()
        && let Some(item) = items.get(index)
        && let Some(handle) = handles::handle_at(item, point, scale)
    {
        let from = point;
        return Gesture::Handle {
            from,
            index,
            handle,
        };
    }
    if let Some(frame) = group::frame(items, selected)
        && let Some(corner) = group::handle_at(frame, point, scale)
    {
        let from = point;
        return Gesture::Scale { from, corner };
    }
    match item_at(items, point) {
        Some(index) => {
            match (adds, selected.contains(index)) {
                (true, _) => selected.toggle(index),
                // A drag of one of several selected items moves all of them.
                (false, true) => {}
                (false, false) => selected.set([index]),
            }
            Gesture::Move { from: point }
        }
        None => {
            if !adds {
                selected.clear();
            }
            Gesture::Band {
                from: point,
                before: selected.clone(),
            }
        }
    }
}

impl Gesture {
    /// Returns the point at which it has begun, in millimetres.
    pub const fn start(&self) -> Vec2 {
        match self {
            Self::Band { from, .. }
            | Self::Move { from }
            | Self::Handle { from, .. }
            | Self::Scale { from, .. } => *from,
        }
    }

    /// Returns the result with the mouse at a point. A rubber band changes the selection at once.
    pub fn preview(
        &self,
        items: &[Item],
        selected: &mut Selection,
        point: Vec2,
        snap: SnapSettings,
    ) -> Preview {
        if point == self.start() && !matches!(self, Self::Band { .. }) {
            // A long press counts as a drag: it alone moves nothing to the grid, and no corner to the mouse.
            return Preview::default();
        }
        match self {
            Self::Band { from, before } => {
                let band = Bounds::between(*from, point);
                *selected = before.clone();
                selected.extend(selection::items_in(items, band));
                Preview {
                    band: Some(band),
                    ..Preview::default()
                }
            }
            Self::Move { from } => moved(items, selected, point - *from, snap),
            Self::Scale { from, corner } => {
                scaled(items, selected, *corner, point - *from, snap.grid_mm)
            }
            Self::Handle { index, handle, .. } => {
                let shape = items.get(*index).map(|item| {
                    let shape = match handle {
                        Handle::Corner(corner) => {
                            handles::resize(&item.shape, *corner, point, snap.grid_mm)
                        }
                        Handle::Turn => handles::turn(&item.shape, point, snap.grid_mm > 0.0),
                    };
                    (*index, shape)
                });
                Preview {
                    shapes: shape.into_iter().collect(),
                    ..Preview::default()
                }
            }
        }
    }
}

/// Returns the selected items moved by a distance, in millimetres.
pub fn moved(items: &[Item], selected: &Selection, offset: Vec2, snap: SnapSettings) -> Preview {
    let mut shapes = selected.shapes(items);
    let Some(bounds) = Bounds::around(shapes.iter().map(|(_, shape)| shape)) else {
        return Preview::default();
    };
    let others = items.iter().enumerate();
    let others = others.filter(|(index, _)| !selected.contains(*index));
    let others = others.map(|(_, item)| item.shape.bounds());
    let snapped = snap_move(bounds, offset, bounds.center(), others, snap);
    for (_, shape) in &mut shapes {
        shape.center += snapped.offset;
    }
    Preview {
        shapes,
        guides: snapped.guides,
        ..Preview::default()
    }
}

/// Returns the selected items scaled by a drag of a corner of the frame around them.
fn scaled(
    items: &[Item],
    selected: &Selection,
    corner: usize,
    drag: Vec2,
    grid_mm: f32,
) -> Preview {
    let frame = group::frame(items, selected);
    let Some(frame) = frame.filter(|_| drag != Vec2::ZERO) else {
        return Preview::default();
    };
    let mut shapes = selected.shapes(items);
    let scaling = Scaling::new(frame, &shapes, corner, drag, grid_mm);
    for (_, shape) in &mut shapes {
        *shape = scaling.apply(shape);
    }
    Preview {
        shapes,
        scaling: Some(scaling),
        ..Preview::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::square;
    use super::*;

    fn row() -> Vec<Item> {
        (0..4)
            .map(|index| square(19.0 * index as f32, 0.0))
            .collect()
    }

    #[test]
    fn a_press_on_a_key_selects_it_and_a_drag_moves_it() {
        let (items, mut selected) = (row(), Selection::default());
        let gesture = begin(&items, &mut selected, Vec2::new(20.0, 1.0), 3.0, false);
        assert_eq!(selected.single(), Some(1));
        let to = Vec2::new(25.0, 41.0);
        let preview = gesture.preview(&items, &mut selected, to, SnapSettings::OFF);
        assert_eq!(preview.shapes.len(), 1);
        assert_eq!(preview.shapes[0].1.center, Vec2::new(24.0, 40.0));
    }

    #[test]
    fn several_selected_keys_move_together() {
        let (items, mut selected) = (row(), Selection::default());
        begin(&items, &mut selected, Vec2::ZERO, 3.0, false);
        begin(&items, &mut selected, Vec2::new(38.0, 0.0), 3.0, true);
        let gesture = begin(&items, &mut selected, Vec2::ZERO, 3.0, false);
        let to = Vec2::new(0.0, 5.0);
        let preview = gesture.preview(&items, &mut selected, to, SnapSettings::OFF);
        let indices: Vec<usize> = preview.shapes.iter().map(|(index, _)| *index).collect();
        assert_eq!(indices, [0, 2]);
    }

    #[test]
    fn a_rubber_band_follows_the_mouse_back() {
        let (items, mut selected) = (row(), Selection::default());
        selected.set([3]);
        let gesture = begin(&items, &mut selected, Vec2::new(-20.0, 20.0), 3.0, true);
        for (x, expected) in [(20.0, vec![0, 1, 3]), (0.0, vec![0, 3]), (-15.0, vec![3])] {
            let to = Vec2::new(x, -20.0);
            gesture.preview(&items, &mut selected, to, SnapSettings::OFF);
            assert_eq!(selected.iter().collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn a_handle_has_precedence_over_the_key_below_it() {
        let (items, mut selected) = (row(), Selection::default());
        selected.set([0]);
        let from = Vec2::new(8.4, 8.4);
        let gesture = begin(&items, &mut selected, from, 3.0, false);
        let expected = Gesture::Handle {
            from,
            index: 0,
            handle: Handle::Corner(2),
        };
        assert_eq!(gesture, expected);
    }

    #[test]
    fn a_press_that_does_not_move_changes_nothing() {
        let items = [square(0.4, 0.0)];
        let snap = SnapSettings {
            grid_mm: 1.0,
            reach_mm: 2.0,
        };
        let mut selected = Selection::default();
        // The item, and then one of its corners.
        for from in [Vec2::ZERO, Vec2::new(9.5, 8.0)] {
            let gesture = begin(&items, &mut selected, from, 3.0, false);
            let still = gesture.preview(&items, &mut selected, from, snap);
            assert_eq!(still, Preview::default(), "{from}");
            let to = from + Vec2::new(3.0, 0.0);
            let dragged = gesture.preview(&items, &mut selected, to, snap);
            assert_eq!(dragged.shapes.len(), 1, "{from}");
        }
    }

    #[test]
    fn a_corner_of_the_frame_around_several_keys_scales_them() {
        let (items, mut selected) = (row(), Selection::default());
        selected.set([0, 2]);
        let frame = group::frame(&items, &selected).unwrap();
        let from = group::handles(frame, 3.0)[2];
        let gesture = begin(&items, &mut selected, from, 3.0, false);
        assert_eq!(gesture, Gesture::Scale { from, corner: 2 });
        let still = gesture.preview(&items, &mut selected, from, SnapSettings::OFF);
        assert_eq!(still, Preview::default());
        let to = from + frame.size();
        let preview = gesture.preview(&items, &mut selected, to, SnapSettings::OFF);
        let centers: Vec<Vec2> = preview.shapes.iter().map(|(_, it)| it.center).collect();
        assert_eq!(centers, [Vec2::splat(8.5), Vec2::new(84.5, 8.5)]);
        assert!(
            preview
                .shapes
                .iter()
                .all(|(_, it)| it.half == Vec2::splat(17.0))
        );
    }

    #[test]
    fn a_press_beside_everything_deselects() {
        let (items, mut selected) = (row(), Selection::default());
        selected.set([1, 2]);
        begin(&items, &mut selected, Vec2::new(0.0, 80.0), 3.0, false);
        assert!(selected.is_empty());
    }
}
