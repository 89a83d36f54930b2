//! The frame around several selected items: its corners scale all of them about the opposite corner.

use parry3d::math::Vec2;

use super::handles::{HIT_RADIUS, SIZES};
use super::selection::Selection;
use super::snap::on_grid;
use super::{Bounds, CORNERS, Item, ItemShape};

/// Distance of the handles from the items, in points: the corners of keys below them stay free.
const MARGIN: f32 = 8.0;

/// Several items that are scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    /// The rectangle around them, scaled.
    pub frame: Bounds,
    /// The factors along the rows and away from the wearer.
    pub factors: Vec2,
    /// The point that stays.
    about: Vec2,
}

/// Returns the rectangle around the selected items; `None` unless there are several.
pub fn frame(items: &[Item], selected: &Selection) -> Option<Bounds> {
    let is_group = selected.len() > 1;
    let shapes = selected.iter().filter_map(|index| items.get(index));
    Bounds::around(shapes.map(|item| &item.shape)).filter(|_| is_group)
}

/// Returns the corners of a frame with handles, in the order of [`CORNERS`], at a zoom in points per millimetre.
pub fn handles(frame: Bounds, scale: f32) -> [Vec2; 4] {
    let half = frame.size() / 2.0 + MARGIN / scale;
    CORNERS.map(|sign| frame.center() + sign * half)
}

/// Returns the index of the corner of a frame at a point.
pub fn handle_at(frame: Bounds, point: Vec2, scale: f32) -> Option<usize> {
    let near = |at: &Vec2| (*at - point).length() * scale <= HIT_RADIUS;
    handles(frame, scale).iter().position(near)
}

impl Scaling {
    /// Returns the scaling by a drag of a corner of the frame around outlines. The size of the frame is on the grid, and no outline
    /// leaves the sizes of the format.
    pub fn new(
        frame: Bounds,
        shapes: &[(usize, ItemShape)],
        corner: usize,
        drag: Vec2,
        grid_mm: f32,
    ) -> Self {
        let sign = CORNERS[corner % CORNERS.len()];
        let about = frame.center() - sign * frame.size() / 2.0;
        let drawn = frame.size() + drag * sign;
        let size = Vec2::new(on_grid(drawn.x, grid_mm), on_grid(drawn.y, grid_mm));
        let (low, high) = limits(shapes);
        let factors = (size / frame.size()).clamp(low, high);
        let opposite = about + sign * frame.size() * factors;
        Self {
            frame: Bounds::between(about, opposite),
            factors,
            about,
        }
    }

    /// Returns an outline that is scaled. A disc stays a disc, and a turned item keeps its angle.
    pub fn apply(&self, shape: &ItemShape) -> ItemShape {
        let factors = self.factors;
        let own = if shape.is_disc {
            Vec2::splat(factors.min_element())
        } else {
            let axis = |axis: Vec2| (shape.rotated(axis) * factors).length();
            Vec2::new(axis(Vec2::X), axis(Vec2::Y))
        };
        ItemShape {
            center: self.about + (shape.center - self.about) * factors,
            half: shape.half * own,
            ..*shape
        }
    }
}

/// Returns the smallest and the largest factors with which all sizes stay within the format.
fn limits(shapes: &[(usize, ItemShape)]) -> (Vec2, Vec2) {
    let (mut low, mut high) = (Vec2::ZERO, Vec2::MAX);
    for (_, shape) in shapes {
        let size = shape.half * 2.0;
        let is_straight = !shape.is_disc && shape.rotation_deg == 0.0;
        // Both directions change both sizes of an item that is turned.
        let (smaller, larger) = if is_straight {
            (size, size)
        } else {
            (
                Vec2::splat(size.min_element()),
                Vec2::splat(size.max_element()),
            )
        };
        low = low.max(SIZES.0 / smaller);
        high = high.min(SIZES.1 / larger);
    }
    // What is beyond the format already may stay as it is.
    (low.min(Vec2::ONE), high.max(Vec2::ONE))
}

#[cfg(test)]
mod tests {
    use super::super::tests::square;
    use super::*;

    fn group() -> (Vec<Item>, Selection) {
        let mut turned = square(50.0, 0.0);
        turned.shape.half = Vec2::new(10.0, 5.0);
        turned.shape.rotation_deg = 90.0;
        let mut disc = square(30.0, 20.0);
        disc.shape.is_disc = true;
        let items = vec![square(0.0, 0.0), turned, disc, square(200.0, 0.0)];
        let mut selected = Selection::default();
        selected.set([0, 1, 2]);
        (items, selected)
    }

    fn scaled(corner: usize, drag: Vec2, grid_mm: f32) -> (Scaling, Vec<ItemShape>) {
        let (items, selected) = group();
        let shapes = selected.shapes(&items);
        let frame = frame(&items, &selected).unwrap();
        let scaling = Scaling::new(frame, &shapes, corner, drag, grid_mm);
        let shapes = shapes.iter().map(|(_, shape)| scaling.apply(shape));
        (scaling, shapes.collect())
    }

    #[test]
    fn the_frame_is_around_several_items_and_its_handles_are_hit() {
        let (items, mut selected) = group();
        let frame = frame(&items, &selected).unwrap();
        assert_eq!(frame.min, Vec2::new(-8.5, -10.0));
        assert_eq!(frame.max, Vec2::new(55.0, 28.5));
        for (corner, at) in handles(frame, 3.0).into_iter().enumerate() {
            assert_eq!(handle_at(frame, at, 3.0), Some(corner));
        }
        assert_eq!(handle_at(frame, frame.center(), 3.0), None);
        selected.set([0]);
        assert_eq!(super::frame(&items, &selected), None);
    }

    #[test]
    fn the_opposite_corner_stays_and_everything_is_scaled_about_it() {
        let size = Vec2::new(63.5, 38.5);
        for (corner, sign) in CORNERS.into_iter().enumerate() {
            let (scaling, shapes) = scaled(corner, sign * size * Vec2::new(1.0, 0.5), 0.0);
            let factors = Vec2::new(2.0, 1.5);
            assert!((scaling.factors - factors).length() < 1e-5, "{scaling:?}");
            let opposite = Vec2::new(23.25, 9.25) - sign * size / 2.0;
            assert!((scaling.about - opposite).length() < 1e-4, "{corner}");
            assert!((scaling.frame.size() - size * factors).length() < 1e-3);
            let way = (shapes[1].center - shapes[0].center) / factors;
            assert!((way - Vec2::new(50.0, 0.0)).length() < 1e-3, "{corner}");
            assert!((shapes[0].half - Vec2::new(17.0, 12.75)).length() < 1e-4);
            // Its own X axis is across the rows.
            assert!((shapes[1].half - Vec2::new(15.0, 10.0)).length() < 1e-4);
            assert_eq!(shapes[1].rotation_deg, 90.0);
            assert!((shapes[2].half - Vec2::splat(12.75)).length() < 1e-4);
        }
    }

    #[test]
    fn the_size_of_the_frame_is_on_the_grid() {
        let (scaling, _) = scaled(2, Vec2::new(10.3, 0.2), 1.0);
        let size = scaling.frame.size();
        assert!((size - Vec2::new(74.0, 39.0)).length() < 1e-3, "{size}");
    }

    #[test]
    fn no_item_leaves_the_sizes_of_the_format_or_turns_inside_out() {
        for drag in [Vec2::splat(-900.0), Vec2::splat(90_000.0)] {
            let (_, shapes) = scaled(2, drag, 1.0);
            for shape in shapes {
                let size = shape.half * 2.0;
                let is_within = size.cmpge(Vec2::splat(SIZES.0 - 1e-3)).all()
                    && size.cmple(Vec2::splat(SIZES.1 + 1e-2)).all();
                assert!(is_within, "{shape:?}");
            }
        }
    }
}
