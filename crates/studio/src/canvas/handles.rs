//! The handles of a selected item: corners that resize it, and a round one that turns it.

use parry3d::math::Vec2;

use super::snap::on_grid;
use super::{CORNERS, Item, ItemShape};

/// Distance of the round handle from the item, in points.
const TURN_DISTANCE: f32 = 22.0;

/// Distance from the middle of a handle at which it is hit, in points.
pub(super) const HIT_RADIUS: f32 = 8.0;

/// Smallest and largest size of an item, in millimetres: the limits of the file format.
pub(super) const SIZES: (f32, f32) = (1.0, 500.0);

/// Angle at which an item that is turned snaps, in degrees.
const TURN_STEP: f32 = 5.0;

/// A handle of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// A corner, by its index in [`CORNERS`].
    Corner(usize),
    /// The round handle.
    Turn,
}

/// Returns the handles of an item with their positions, in millimetres, at a zoom in points per millimetre.
pub fn handles(item: &Item, scale: f32) -> Vec<(Handle, Vec2)> {
    let mut handles = Vec::with_capacity(5);
    let corners = item.shape.corners().into_iter().enumerate();
    handles.extend(corners.map(|(index, corner)| (Handle::Corner(index), corner)));
    if item.can_turn {
        let height = item.shape.half.y + TURN_DISTANCE / scale;
        let top = item.shape.center + item.shape.rotated(Vec2::new(0.0, height));
        handles.push((Handle::Turn, top));
    }
    handles
}

/// Returns the handle of an item at a point. However small an item is, its middle has none, where a drag moves it, nor has a neighbor of
/// its size.
pub fn handle_at(item: &Item, point: Vec2, scale: f32) -> Option<Handle> {
    let half = item.shape.half;
    let free = if item.shape.contains(point) {
        half.min_element() / 2.0
    } else {
        half.max_element()
    };
    let reach = HIT_RADIUS.min(free * scale);
    let near = |at: Vec2| (at - point).length() * scale <= reach;
    let mut handles = handles(item, scale).into_iter().rev();
    handles.find_map(|(handle, at)| near(at).then_some(handle))
}

/// Returns the item with a corner dragged to a point; the opposite corner stays. A disc keeps its center.
pub fn resize(shape: &ItemShape, corner: usize, point: Vec2, grid_mm: f32) -> ItemShape {
    if shape.is_disc {
        let reach = shape.local(point).abs().max_element();
        let size = on_grid(reach * 2.0, grid_mm).clamp(SIZES.0, SIZES.1);
        return ItemShape {
            half: Vec2::splat(size / 2.0),
            ..*shape
        };
    }
    let sign = CORNERS[corner % CORNERS.len()];
    let opposite = -sign * shape.half;
    let drawn = (shape.local(point) - opposite) * sign;
    let size = Vec2::new(on_grid(drawn.x, grid_mm), on_grid(drawn.y, grid_mm));
    let size = size.clamp(Vec2::splat(SIZES.0), Vec2::splat(SIZES.1));
    ItemShape {
        center: shape.center + shape.rotated(opposite + sign * size / 2.0),
        half: size / 2.0,
        ..*shape
    }
}

/// Returns the item turned so that its round handle points to a point.
pub fn turn(shape: &ItemShape, point: Vec2, is_snapped: bool) -> ItemShape {
    let direction = point - shape.center;
    let degrees = direction.y.atan2(direction.x).to_degrees() - 90.0;
    let step = if is_snapped { TURN_STEP } else { 0.1 };
    ItemShape {
        rotation_deg: wrapped((degrees / step).round() * step),
        ..*shape
    }
}

/// Returns an angle within −180°..=180°.
pub fn wrapped(degrees: f32) -> f32 {
    let turns = ((degrees + 180.0) / 360.0).floor();
    degrees - turns * 360.0
}

#[cfg(test)]
mod tests {
    use super::super::tests::square;
    use super::*;

    #[test]
    fn the_middle_of_a_small_item_and_of_its_neighbor_has_no_handle() {
        let item = square(0.0, 0.0);
        // An item of 10 points.
        let scale = 10.0 / 17.0;
        for at in [Vec2::ZERO, Vec2::new(19.0, 0.0)] {
            assert_eq!(handle_at(&item, at, scale), None, "{at}");
        }
        let corner = item.shape.corners()[2];
        for at in [corner, corner + Vec2::splat(3.0 / scale)] {
            assert_eq!(handle_at(&item, at, scale), Some(Handle::Corner(2)));
        }
    }

    #[test]
    fn the_opposite_corner_stays_also_on_a_turned_item() {
        for rotation_deg in [0.0, 30.0, -120.0] {
            let shape = ItemShape {
                rotation_deg,
                ..square(5.0, -3.0).shape
            };
            for (corner, sign) in CORNERS.into_iter().enumerate() {
                let point = shape.center + shape.rotated(sign * Vec2::new(20.0, 11.5));
                let resized = resize(&shape, corner, point, 0.0);
                let opposite = (corner + 2) % 4;
                let moved = resized.corners()[opposite] - shape.corners()[opposite];
                assert!(moved.length() < 1e-3);
                assert!((resized.half - Vec2::new(14.25, 10.0)).length() < 1e-3);
            }
        }
    }

    #[test]
    fn an_item_does_not_turn_inside_out() {
        let shape = square(0.0, 0.0).shape;
        let resized = resize(&shape, 2, Vec2::new(-50.0, -50.0), 1.0);
        assert_eq!(resized.half, Vec2::splat(0.5));
    }

    #[test]
    fn the_round_handle_points_to_the_mouse() {
        let shape = square(0.0, 0.0).shape;
        let left = turn(&shape, Vec2::new(-10.0, 0.1), true);
        assert_eq!(left.rotation_deg, 90.0);
        let below = turn(&shape, Vec2::new(1.0, -10.0), false);
        assert!((below.rotation_deg.abs() - 174.3).abs() < 0.1, "{below:?}");
    }

    #[test]
    fn handles_are_hit_where_they_are_drawn() {
        let mut item = square(0.0, 0.0);
        for (handle, at) in handles(&item, 3.0) {
            assert_eq!(handle_at(&item, at, 3.0), Some(handle));
        }
        let turn = handles(&item, 3.0)[4].1;
        item.can_turn = false;
        assert_eq!(handle_at(&item, turn, 3.0), None);
    }
}
