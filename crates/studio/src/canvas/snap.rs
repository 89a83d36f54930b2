//! Snapping of moved items to the grid and to the edges and centers of other items.

use parry3d::math::Vec2;

use super::Bounds;

/// A line that shows to which edge or center items have snapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guide {
    /// One end, in millimetres.
    pub from: Vec2,
    /// The other end, in millimetres.
    pub to: Vec2,
}

/// The settings of snapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapSettings {
    /// Distance between positions on the grid, in millimetres; 0 for none.
    pub grid_mm: f32,
    /// Largest distance to an edge or center of another item that attracts, in millimetres; 0 for none.
    pub reach_mm: f32,
}

impl SnapSettings {
    /// No snapping.
    pub const OFF: Self = Self {
        grid_mm: 0.0,
        reach_mm: 0.0,
    };
}

/// A motion that ends on edges, centers or the grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapped {
    /// The corrected motion, in millimetres.
    pub offset: Vec2,
    /// The lines on which the items now lie.
    pub guides: Vec<Guide>,
}

/// Corrects a motion of what is within `moved` so that an edge or center lies on one of `others`, or the point `on_grid` of it on the
/// grid.
pub fn snap_move(
    moved: Bounds,
    offset: Vec2,
    on_grid: Vec2,
    others: impl Iterator<Item = Bounds>,
    settings: SnapSettings,
) -> Snapped {
    let target = Bounds {
        min: moved.min + offset,
        max: moved.max + offset,
    };
    let near = neighbors(target, others, settings.reach_mm);
    let mut snapped = Snapped {
        offset,
        guides: Vec::new(),
    };
    for axis in [0, 1] {
        let attracted = attraction(target, &near, axis, settings.reach_mm);
        match attracted {
            Some((shift, line, other)) => {
                snapped.offset[axis] += shift;
                snapped.guides.push(guide(target, other, axis, line));
            }
            None => {
                let place = on_grid[axis] + offset[axis];
                snapped.offset[axis] += grid_shift(place, settings.grid_mm);
            }
        }
    }
    snapped
}

/// Returns the value on the grid that is nearest, or the value itself without a grid.
pub fn on_grid(value: f32, grid_mm: f32) -> f32 {
    value + grid_shift(value, grid_mm)
}

fn grid_shift(value: f32, grid_mm: f32) -> f32 {
    if grid_mm > 0.0 {
        (value / grid_mm).round() * grid_mm - value
    } else {
        0.0
    }
}

/// Distance up to which items are neighbors, in sizes of what moves: others on a full board would attract everywhere.
const NEIGHBORHOOD: f32 = 2.5;

fn neighbors(target: Bounds, others: impl Iterator<Item = Bounds>, reach_mm: f32) -> Vec<Bounds> {
    if reach_mm <= 0.0 {
        return Vec::new();
    }
    let margin = Vec2::splat(target.size().max_element().clamp(20.0, 200.0) * NEIGHBORHOOD);
    let around = Bounds {
        min: target.min - margin,
        max: target.max + margin,
    };
    others.filter(|bounds| bounds.touches(around)).collect()
}

/// Returns the smallest correction along an axis, the line it leads to, and the item that attracts.
fn attraction(
    target: Bounds,
    near: &[Bounds],
    axis: usize,
    reach_mm: f32,
) -> Option<(f32, f32, Bounds)> {
    let lines = |bounds: Bounds| [bounds.min[axis], bounds.center()[axis], bounds.max[axis]];
    let own = lines(target);
    let mut best: Option<(f32, f32, Bounds)> = None;
    for &other in near {
        for (own_kind, own_line) in own.into_iter().enumerate() {
            for (kind, line) in lines(other).into_iter().enumerate() {
                // A center on an edge is chance, not alignment.
                if (own_kind == 1) != (kind == 1) {
                    continue;
                }
                let shift = line - own_line;
                let is_nearer = best.is_none_or(|(shortest, ..)| shift.abs() < shortest.abs());
                if shift.abs() <= reach_mm && is_nearer {
                    best = Some((shift, line, other));
                }
            }
        }
    }
    best
}

fn guide(target: Bounds, other: Bounds, axis: usize, line: f32) -> Guide {
    let across = 1 - axis;
    let both = target.union(other);
    let point = |along: f32| {
        let mut point = Vec2::splat(line);
        point[across] = along;
        point
    };
    Guide {
        from: point(both.min[across]),
        to: point(both.max[across]),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::square;
    use super::*;

    const BOTH: SnapSettings = SnapSettings {
        grid_mm: 1.0,
        reach_mm: 1.5,
    };

    fn moved(offset: Vec2, settings: SnapSettings) -> Snapped {
        let items = [square(0.0, 0.0), square(50.0, 0.3)];
        let bounds = items[0].shape.bounds();
        let others = items[1..].iter().map(|item| item.shape.bounds());
        snap_move(bounds, offset, bounds.center(), others, settings)
    }

    #[test]
    fn an_edge_of_a_neighbor_attracts_and_is_shown() {
        let snapped = moved(Vec2::new(32.2, 10.0), BOTH);
        assert!((snapped.offset.x - 33.0).abs() < 1e-4, "{snapped:?}");
        assert!((snapped.offset.y - 10.0).abs() < 1e-4, "the grid");
        assert_eq!(snapped.guides.len(), 1);
        assert!((snapped.guides[0].from.x - 41.5).abs() < 1e-4);
    }

    #[test]
    fn far_from_neighbors_the_center_is_on_the_grid() {
        let snapped = moved(Vec2::new(-20.4, 23.6), BOTH);
        assert!((snapped.offset - Vec2::new(-20.0, 24.0)).length() < 1e-4);
        assert_eq!(snapped.guides, []);
    }

    #[test]
    fn without_snapping_the_motion_is_exact() {
        let offset = Vec2::new(32.217, 0.331);
        assert_eq!(moved(offset, SnapSettings::OFF).offset, offset);
    }

    #[test]
    fn centers_align_across_the_board() {
        let snapped = moved(Vec2::new(20.0, 0.9), BOTH);
        assert!((snapped.offset.y - 0.3).abs() < 1e-4);
    }
}
