//! The part of a board that the canvas shows.

use parry3d::math::Vec2;

use super::Bounds;

/// Range of the zoom, in points per millimetre.
const SCALES: (f32, f32) = (0.05, 60.0);

/// Empty edge around the items when all are shown, as a fraction of the picture.
const EDGE: f32 = 0.08;

/// Smallest width of this edge, in points: a ruler covers no item.
const MIN_EDGE: f32 = 20.0;

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
        let widest = size * (1.0 - 2.0 * EDGE);
        let room = widest.min(size - Vec2::splat(2.0 * MIN_EDGE));
        let scales = room.max(Vec2::ONE) / extent;
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

/// The viewport of an area on the screen. It shows everything, and is fitted again when the size of the area changes, until a person
/// pans, zooms or edits: what is below the mouse then stays there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaViewport {
    /// The viewport of the last frame; `None` until the next one, which shows everything.
    viewport: Option<Viewport>,
    /// The size of the area and the revision of the text for which it shows everything; `None` once it was chosen.
    fitted: Option<(Vec2, u64)>,
}

impl AreaViewport {
    /// Shows a part that was chosen.
    pub fn fixed(viewport: Viewport) -> Self {
        Self {
            viewport: Some(viewport),
            fitted: None,
        }
    }

    /// Returns the viewport for a picture of this size of a text of this revision, with all items in `bounds`. It stays while the mouse
    /// holds something.
    pub fn update(
        &mut self,
        bounds: Option<Bounds>,
        size: Vec2,
        revision: u64,
        is_held: bool,
    ) -> Viewport {
        let is_to_be_fitted = match (self.viewport, self.fitted) {
            (Some(_), Some((fitted, of))) => fitted != size && of == revision && !is_held,
            (Some(_), None) => false,
            (None, _) => true,
        };
        if is_to_be_fitted {
            let whole = bounds.map(|bounds| Viewport::fit(bounds, size));
            self.viewport = Some(whole.unwrap_or_default());
            self.fitted = Some((size, revision));
        }
        self.viewport.unwrap_or_default()
    }

    /// Returns the viewport of the last frame; `None` if the next one shows everything.
    pub fn viewport(&self) -> Option<Viewport> {
        self.viewport
    }

    /// Keeps a viewport that was moved.
    pub fn move_to(&mut self, viewport: Viewport) {
        if self.viewport != Some(viewport) {
            *self = Self::fixed(viewport);
        }
    }

    /// Returns the part of the board in the last frame, which had this size.
    pub fn visible(&self, size: Option<Vec2>) -> Option<Bounds> {
        Some(self.viewport?.visible(size?))
    }

    /// Returns the point in the middle of the last frame, in millimetres.
    pub fn center(&self) -> Option<Vec2> {
        self.viewport.map(|viewport| viewport.center)
    }
}

#[cfg(test)]
mod tests {
    use super::super::rulers;
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
    fn a_ruler_covers_no_item_of_a_low_picture() {
        let bounds = Bounds::between(Vec2::new(-20.0, -50.0), Vec2::new(20.0, 50.0));
        let low = Vec2::new(800.0, 120.0);
        let viewport = Viewport::fit(bounds, low);
        let top = viewport.to_screen(Vec2::new(0.0, 50.0), low).y;
        assert!(top >= rulers::WIDTH, "{top}");
    }

    #[test]
    fn an_area_that_changes_is_fitted_again_until_it_is_moved_or_edited() {
        let bounds = Some(Bounds::between(Vec2::splat(-200.0), Vec2::splat(200.0)));
        let smaller = SIZE - Vec2::new(0.0, 90.0);
        let mut area = AreaViewport::default();
        let first = area.update(bounds, SIZE, 1, false);
        assert_eq!(area.update(bounds, smaller, 1, true), first, "it is held");
        let second = area.update(bounds, smaller, 1, false);
        assert!(second.scale < first.scale, "{second:?}");
        assert_eq!(area.update(bounds, SIZE, 2, false), second, "an edit");
        area = AreaViewport::default();
        let mut moved = area.update(bounds, SIZE, 2, false);
        area.move_to(moved);
        assert_eq!(area.update(bounds, smaller, 2, false), second, "not moved");
        moved.pan(Vec2::new(5.0, 0.0));
        area.move_to(moved);
        assert_eq!(area.update(bounds, SIZE, 2, false), moved);
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
