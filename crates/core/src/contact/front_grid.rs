//! A grid over fronts that are parallel to their surface. It finds the fronts near a position in a time that does not depend on
//! their number.

use parry3d::math::{Mat3, Vec2, Vec3};

use super::target::{Shape, Target};

/// The padding of a front, in metres on every side. It covers the rounding of rotated fronts and of crossings, some 1e-6 m
/// at 2 m.
const PADDING: f32 = 1e-5;

/// The largest deviation of a normal from the surface normal, in radians. At a distance of 2 m it moves a crossing by less
/// than the padding.
const MAX_TILT: f32 = 1e-6;

/// The number of cells along the mean pitch of the fronts. With two, a cell of a regular board meets at most four keys and fewer
/// than two on average; a finer grid takes more memory than it saves time.
const CELLS_PER_PITCH: f32 = 2.0;

/// Maximum number of cells, and of entries, per front. A board that needs more has fronts of very different sizes or large gaps.
const MAX_PER_FRONT: usize = 16;

/// Number of cells, and of entries, that every board may have.
const MIN_CAPACITY: usize = 1_024;

/// Maximum number of fronts in a cell. Overlapping or crowded fronts are found faster in a tree.
const MAX_FRONTS_OF_CELL: usize = 12;

/// Lists of the fronts that meet each cell of a grid in the plane of a surface.
///
/// The grid has the axes of the first front, so that cells and fronts of a turned board are parallel.
#[derive(Clone, Debug)]
pub struct FrontGrid {
    /// The direction of the grid's X axis in the surface's frame.
    x_axis: Vec2,
    /// The corner of the first cell, in the axes of the grid.
    low: Vec2,
    cells_per_metre: f32,
    columns: usize,
    rows: usize,
    /// The heights of the lowest and the highest front above the origin of the surface, with the padding.
    heights: [f32; 2],
    /// The first entry of each cell, row by row, and the number of all entries.
    starts: Vec<u32>,
    /// The indices of the fronts of each cell, in increasing order.
    entries: Vec<u32>,
    /// The padded fronts in the axes of the grid: cheaper to test than the outlines.
    fronts: Vec<Rectangle>,
}

/// A rectangle from its lowest to its highest corner.
#[derive(Clone, Copy, Debug)]
struct Rectangle {
    low: Vec2,
    high: Vec2,
}

impl FrontGrid {
    /// Creates the grid of a surface with these targets. Returns `None` if there are none, if a front is not parallel to the
    /// surface, or if a grid does not fit them: fronts in many layers, or of very different sizes.
    pub fn new(targets: &[Target]) -> Option<Self> {
        let first = Mat3::from_quat(targets.first()?.surface_from_target.rotation);
        let x_axis = first.x_axis.truncate();
        let fronts = targets
            .iter()
            .map(|target| front(target, x_axis))
            .collect::<Option<Vec<Rectangle>>>()?;
        let board = fronts.iter().copied().reduce(Rectangle::merged)?;
        let size = board.high - board.low;
        let pitch = (size.x * size.y / targets.len() as f32).sqrt();
        let cells_per_metre = CELLS_PER_PITCH / pitch;
        let cells = (size * cells_per_metre).floor() + 1.0;
        let capacity = MIN_CAPACITY + MAX_PER_FRONT * targets.len();
        let is_small = cells.x * cells.y <= capacity as f32;
        if !is_small {
            return None;
        }
        let heights = targets
            .iter()
            .map(|target| target.surface_from_target.translation.z);
        let mut grid = Self {
            x_axis,
            low: board.low,
            cells_per_metre,
            columns: cells.x as usize,
            rows: cells.y as usize,
            heights: [
                heights.clone().fold(f32::INFINITY, f32::min) - PADDING,
                heights.fold(f32::NEG_INFINITY, f32::max) + PADDING,
            ],
            starts: Vec::new(),
            entries: Vec::new(),
            fronts,
        };
        grid.fill(capacity).then_some(grid)
    }

    /// Lists the fronts of each cell. Returns `false` if there are too many.
    fn fill(&mut self, capacity: usize) -> bool {
        let mut counts = vec![0_u32; self.columns * self.rows + 1];
        for front in &self.fronts {
            self.for_each_cell(*front, |cell| counts[cell] += 1);
        }
        if counts
            .iter()
            .any(|&count| count as usize > MAX_FRONTS_OF_CELL)
        {
            return false;
        }
        let mut end = 0;
        for count in &mut counts {
            end += *count;
            *count = end;
        }
        if end as usize > capacity {
            return false;
        }
        // From the last front to the first, so that each list is filled from its end and `starts` ends at its start.
        let mut entries = vec![0; end as usize];
        for (index, front) in self.fronts.iter().enumerate().rev() {
            self.for_each_cell(*front, |cell| {
                counts[cell] -= 1;
                entries[counts[cell] as usize] = index as u32;
            });
        }
        self.starts = counts;
        self.entries = entries;
        true
    }

    /// Calls `visit` with the index of each front that a pad may enter on a straight path, at least once for each. The
    /// positions of the pad are in the surface's frame, in metres.
    #[inline]
    pub fn for_each_entered(&self, from: Vec3, to: Vec3, visit: impl FnMut(u32)) {
        let [lowest, highest] = self.heights;
        // A pad enters a front from its plane or above, and ends below.
        if from.z < lowest || to.z > highest {
            return;
        }
        // Only the part between the highest and the lowest front counts.
        let descent = (from.z - to.z).max(0.0);
        // NaN if the pad moves in one of the two planes.
        let start = ((from.z - highest) / descent).max(0.0);
        let end = ((from.z - lowest) / descent).min(1.0);
        let (from, to) = (self.in_grid(from.truncate()), self.in_grid(to.truncate()));
        let (start, end) = (from.lerp(to, start), from.lerp(to, end));
        let way = Rectangle {
            low: start.min(end),
            high: start.max(end),
        };
        self.for_each_front(way, visit);
    }

    /// Calls `visit` with the index of each front that may contain a pad or have it behind, at least once for each.
    pub fn for_each_at(&self, pad: Vec3, visit: impl FnMut(u32)) {
        if pad.z <= self.heights[1] {
            let position = self.in_grid(pad.truncate());
            self.for_each_front(Rectangle::around(position, 0.0), visit);
        }
    }

    /// Calls `visit` with the index of each front whose padded bounding box is within `distance` metres of a position along
    /// each axis of the grid, at least once for each. Along Z, only the heights of the lowest and the highest front are
    /// compared. The position is in the surface's frame, in metres.
    pub fn for_each_near(&self, position: Vec3, distance: f32, visit: impl FnMut(u32)) {
        let [lowest, highest] = self.heights;
        if position.z + distance >= lowest && position.z - distance <= highest {
            let center = self.in_grid(position.truncate());
            self.for_each_front(Rectangle::around(center, distance), visit);
        }
    }

    /// Returns heights below and above all fronts, in the surface's frame, in metres.
    pub fn heights(&self) -> [f32; 2] {
        self.heights
    }

    fn in_grid(&self, position: Vec2) -> Vec2 {
        Vec2::new(self.x_axis.dot(position), self.x_axis.perp_dot(position))
    }

    fn for_each_front(&self, area: Rectangle, mut visit: impl FnMut(u32)) {
        let Some([columns, rows]) = self.cells(area) else {
            return;
        };
        for row in rows[0]..=rows[1] {
            // The lists of neighbors in a row follow each other.
            let cell = row * self.columns;
            let start = self.starts[cell + columns[0]] as usize;
            let end = self.starts[cell + columns[1] + 1] as usize;
            for &front in &self.entries[start..end] {
                if self.fronts[front as usize].meets(&area) {
                    visit(front);
                }
            }
        }
    }

    fn for_each_cell(&self, area: Rectangle, mut visit: impl FnMut(usize)) {
        if let Some([columns, rows]) = self.cells(area) {
            for row in rows[0]..=rows[1] {
                for column in columns[0]..=columns[1] {
                    visit(row * self.columns + column);
                }
            }
        }
    }

    /// Returns the first and the last column and row that an area meets, or `None` if it is beside the grid.
    fn cells(&self, area: Rectangle) -> Option<[[usize; 2]; 2]> {
        let low = (area.low - self.low) * self.cells_per_metre;
        let high = (area.high - self.low) * self.cells_per_metre;
        let size = Vec2::new(self.columns as f32, self.rows as f32);
        // `all`, so that NaN is beside the grid.
        if !(high.cmpge(Vec2::ZERO).all() && low.cmplt(size).all()) {
            return None;
        }
        // The conversion of a negative number is 0.
        let columns = [low.x as usize, (high.x as usize).min(self.columns - 1)];
        let rows = [low.y as usize, (high.y as usize).min(self.rows - 1)];
        Some([columns, rows])
    }
}

impl Rectangle {
    fn around(center: Vec2, half: f32) -> Self {
        Self {
            low: center - half,
            high: center + half,
        }
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    fn merged(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// Returns the padded bounding rectangle of a front in the axes of the grid, or `None` if the front is not parallel to the
/// surface or not finite.
fn front(target: &Target, x_axis: Vec2) -> Option<Rectangle> {
    let axes = Mat3::from_quat(target.surface_from_target.rotation);
    let is_parallel = axes.z_axis.z > 0.0 && axes.z_axis.truncate().abs().max_element() <= MAX_TILT;
    if !is_parallel {
        return None;
    }
    let in_grid = |vector: Vec3| {
        let vector = vector.truncate();
        Vec2::new(x_axis.dot(vector), x_axis.perp_dot(vector))
    };
    let (shift, half) = target.entrance();
    let (grid_x_axis, grid_y_axis) = (in_grid(axes.x_axis), in_grid(axes.y_axis));
    let extent = match target.shape {
        Shape::Box(_) => grid_x_axis.abs() * half.x + grid_y_axis.abs() * half.y,
        Shape::Disc(_) => half,
    };
    let center = target.surface_from_target.translation;
    if !center.is_finite() {
        return None;
    }
    let center = in_grid(center) + grid_x_axis * shift.x + grid_y_axis * shift.y;
    Some(Rectangle {
        low: center - extent - PADDING,
        high: center + extent + PADDING,
    })
}
