//! The part of a board that the canvas shows.

use parry3d::math::Vec2;

use super::Bounds;

/// Range of the zoom, in points per millimetre.
const SCALES: (f32, f32) = (0.05, 60.0);

/// Empty edge around the items when all are shown, as a fraction of the picture.
const EDGE: f32 = 0.08;

/// The largest zoom when all items are shown, in points per millimetre.
const MAX_FIT_SCALE: f32 = 5.0;

/// The map between row coordinates in millimetres and a picture in points, +Y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewport {
    /// The point in the middle of the picture, in millimetres.
    pub center: Vec2,
    /// Points per millimetre.
    pub scale: f32,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            center: Vec2::ZERO,
            scale: 3.0,
        }
    }
}

impl Viewport {
    /// Shows all of this rectangle in a picture of this size.
    pub fn fit(bounds: Bounds, size: Vec2) -> Self {
        let extent = bounds.size().max(Vec2::splat(20.0));
        let scales = size * (1.0 - 2.0 * EDGE) / extent;
        Self {
            center: bounds.center(),
            scale: scales.min_element().clamp(SCALES.0, MAX_FIT_SCALE),
        }
    }

    /// Returns the position of a point on a picture of this size.
    pub fn to_screen(&self, point: Vec2, size: Vec2) -> Vec2 {
        let offset = (point - self.center) * self.scale;
        size / 2.0 + Vec2::new(offset.x, -offset.y)
    }

    /// Returns the point at a position on a picture of this size.
    pub fn to_board(&self, position: Vec2, size: Vec2) -> Vec2 {
        let offset = (position - size / 2.0) / self.scale;
        self.center + Vec2::new(offset.x, -offset.y)
    }

    /// Returns the part of the board on a picture of this size.
    pub fn visible(&self, size: Vec2) -> Bounds {
        Bounds::between(self.to_board(Vec2::ZERO, size), self.to_board(size, size))
    }

    /// Multiplies the zoom; the point at a position of the picture stays there.
    pub fn zoom_at(&mut self, position: Vec2, size: Vec2, factor: f32) {
        let fixed = self.to_board(position, size);
        self.scale = (self.scale * factor).clamp(SCALES.0, SCALES.1);
        self.center += fixed - self.to_board(position, size);
    }

    /// Moves the picture by a drag in points.
    pub fn pan(&mut self, drag: Vec2) {
        self.center += Vec2::new(-drag.x, drag.y) / self.scale;
    }

    /// Returns the distance between the lines of the grid, in millimetres: at least 9 points apart.
    pub fn grid_mm(&self) -> f32 {
        const STEPS: [f32; 9] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
        let fits = |step: &f32| step * self.scale >= 9.0;
        STEPS.into_iter().find(fits).unwrap_or(1000.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Vec2 = Vec2::new(800.0, 500.0);

    #[test]
    fn the_point_below_the_mouse_stays_there_when_zooming() {
        let mut viewport = Viewport::default();
        let mouse = Vec2::new(120.0, 400.0);
        let before = viewport.to_board(mouse, SIZE);
        viewport.zoom_at(mouse, SIZE, 1.7);
        assert!((viewport.to_board(mouse, SIZE) - before).length() < 1e-3);
        assert!((viewport.to_screen(before, SIZE) - mouse).length() < 1e-2);
    }

    #[test]
    fn a_drag_moves_the_picture_with_the_mouse() {
        let mut viewport = Viewport::default();
        let before = viewport.to_screen(Vec2::ZERO, SIZE);
        viewport.pan(Vec2::new(30.0, -10.0));
        let moved = viewport.to_screen(Vec2::ZERO, SIZE) - before;
        assert!((moved - Vec2::new(30.0, -10.0)).length() < 1e-3);
    }

    #[test]
    fn everything_fits_and_up_is_away_from_the_wearer() {
        let bounds = Bounds::between(Vec2::new(-900.0, -50.0), Vec2::new(300.0, 60.0));
        let viewport = Viewport::fit(bounds, SIZE);
        let visible = viewport.visible(SIZE);
        assert!(visible.min.cmple(bounds.min).all() && visible.max.cmpge(bounds.max).all());
        let far = viewport.to_screen(Vec2::new(0.0, 60.0), SIZE);
        assert!(far.y < viewport.to_screen(Vec2::ZERO, SIZE).y);
    }

    #[test]
    fn lines_of_the_grid_stay_apart() {
        for scale in [0.05, 0.3, 3.0, 60.0] {
            let viewport = Viewport {
                scale,
                ..Viewport::default()
            };
            assert!(viewport.grid_mm() * scale >= 9.0);
        }
    }
}
