//! Free room on a board, for controls that are added or copied.

use parry3d::math::Vec2;

use super::{Bounds, ItemShape};

/// Gap between an added control and its neighbors, in millimetres.
const GAP_MM: f32 = 1.0;

/// The shortest step of the search, in millimetres.
const MIN_STEP_MM: f32 = 2.0;

/// Steps of the search in each direction.
const REACH: i32 = 250;

/// The largest number of pairs of outlines that are compared one by one; of more, the rectangle around what is added.
const MAX_PAIRS: usize = 200_000;

/// Returns the shortest offset at which outlines overlap no others, in multiples of the grid, in millimetres; to the right of all
/// others if there is no room near.
pub fn free_offset(shapes: &[ItemShape], others: &[ItemShape], grid_mm: f32) -> Vec2 {
    let (Some(own), Some(all)) = (Bounds::around(shapes.iter()), Bounds::around(others.iter()))
    else {
        return Vec2::ZERO;
    };
    let step = grid_mm.max(0.01) * (MIN_STEP_MM / grid_mm.max(0.01)).ceil();
    let moved: Vec<Bounds> = if shapes.len().saturating_mul(others.len()) > MAX_PAIRS {
        vec![own]
    } else {
        shapes.iter().map(ItemShape::bounds).collect()
    };
    let mut blocked = Blocked::new();
    for other in others.iter().map(ItemShape::bounds) {
        for shape in &moved {
            blocked.add(shape, &other, step);
        }
    }
    let nearest = blocked.nearest_free();
    nearest.map_or_else(
        || Vec2::new(all.max.x + GAP_MM - own.min.x, 0.0),
        |[x, y]| Vec2::new(x as f32, y as f32) * step,
    )
}

/// Offsets, in steps, at which something overlaps.
struct Blocked(Vec<bool>);

impl Blocked {
    const WIDTH: usize = 2 * REACH as usize + 1;

    fn new() -> Self {
        Self(vec![false; Self::WIDTH * Self::WIDTH])
    }

    fn add(&mut self, shape: &Bounds, other: &Bounds, step: f32) {
        let limit = |steps: f32| (steps as i32).clamp(-REACH - 1, REACH + 1);
        let low = (other.min - shape.max - GAP_MM) / step;
        let high = (other.max - shape.min + GAP_MM) / step;
        let [first_x, first_y] = [low.x, low.y].map(|low| limit(low.floor()) + 1);
        let [last_x, last_y] = [high.x, high.y].map(|high| limit(high.ceil()) - 1);
        for y in first_y.max(-REACH)..=last_y.min(REACH) {
            for x in first_x.max(-REACH)..=last_x.min(REACH) {
                self.0[Self::index([x, y])] = true;
            }
        }
    }

    fn index([x, y]: [i32; 2]) -> usize {
        (y + REACH) as usize * Self::WIDTH + (x + REACH) as usize
    }

    /// Returns the nearest offset that is free; of several at one distance the one to the right and towards the wearer.
    fn nearest_free(&self) -> Option<[i32; 2]> {
        let range = || -REACH..=REACH;
        let offsets = range().flat_map(|y| range().rev().map(move |x| [x, y]));
        let free = offsets.filter(|offset| !self.0[Self::index(*offset)]);
        free.min_by_key(|[x, y]| x * x + y * y)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::square;
    use super::*;

    fn shapes(places: &[(f32, f32)]) -> Vec<ItemShape> {
        places.iter().map(|&(x, y)| square(x, y).shape).collect()
    }

    fn is_free(shapes: &[ItemShape], others: &[ItemShape], offset: Vec2) -> bool {
        let moved = shapes.iter().map(|shape| ItemShape {
            center: shape.center + offset,
            ..*shape
        });
        let moved: Vec<Bounds> = moved.map(|shape| shape.bounds()).collect();
        let others: Vec<Bounds> = others.iter().map(ItemShape::bounds).collect();
        !moved
            .iter()
            .any(|own| others.iter().any(|other| own.touches(*other)))
    }

    #[test]
    fn a_place_that_is_free_is_kept() {
        let others = shapes(&[(0.0, 0.0)]);
        assert_eq!(
            free_offset(&shapes(&[(40.0, 0.0)]), &others, 1.0),
            Vec2::ZERO
        );
        assert_eq!(free_offset(&others, &[], 1.0), Vec2::ZERO);
    }

    #[test]
    fn a_copy_goes_beside_its_original_and_not_onto_the_next_key() {
        let row: Vec<(f32, f32)> = (0..10).map(|index| (19.0 * index as f32, 0.0)).collect();
        let others = shapes(&row);
        let copy = shapes(&row[4..6]);
        let offset = free_offset(&copy, &others, 1.0);
        assert!(is_free(&copy, &others, offset), "{offset}");
        assert_eq!(offset, Vec2::new(0.0, -18.0), "towards the wearer");
    }

    #[test]
    fn a_full_board_has_room_at_its_right() {
        let mut full = square(0.0, 0.0).shape;
        full.half = Vec2::splat(900.0);
        let key = shapes(&[(0.0, 0.0)]);
        let offset = free_offset(&key, &[full], 5.0);
        assert!(is_free(&key, &[full], offset), "{offset}");
    }

    #[test]
    fn ten_thousand_keys_are_searched() {
        let places =
            (0..10_000).map(|index| ((index % 100) as f32 * 19.0, (index / 100) as f32 * 19.0));
        let others = shapes(&places.collect::<Vec<_>>());
        let copies = &others[..200];
        let offset = free_offset(copies, &others, 1.0);
        assert!(is_free(copies, &others, offset), "{offset}");
    }
}
