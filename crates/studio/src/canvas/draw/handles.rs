//! The handles of what is selected.

use parry3d::math::Vec2;

use super::Pen;
use crate::canvas::handles::{self, Handle};
use crate::canvas::{Bounds, CORNERS, Item, group};
use crate::picture::disc;

/// Half the side of a square handle, in points.
const HANDLE: f32 = 4.0;

impl Pen<'_> {
    /// Adds the handles of the only selected item.
    pub fn add_handles(&mut self, item: &Item) {
        let (ring, fill) = (self.colors.ring, self.colors.background);
        for (handle, at) in handles::handles(item, self.viewport.scale) {
            let at = self.to_screen(at);
            match handle {
                Handle::Corner(_) => self.add_corner(at),
                Handle::Turn => {
                    let center = self.to_screen(item.shape.center);
                    let rim = center.lerp(
                        at,
                        item.shape.half.y * self.viewport.scale / (at - center).length(),
                    );
                    let side = (at - center).normalize_or_zero().perp() * 0.75;
                    let stem = [rim + side, at + side, at - side, rim - side];
                    self.picture.above.add_plain_polygon(&stem, ring);
                    self.picture
                        .above
                        .add_flat_polygon(&disc(at, HANDLE + 1.0), fill);
                    self.picture.above.add_ring(at, HANDLE, 2.0, ring);
                }
            }
        }
    }

    /// Adds the frame around several selected items, with a handle at each corner.
    pub fn add_frame(&mut self, frame: Bounds) {
        let corners = group::handles(frame, self.viewport.scale);
        let corners = corners.map(|corner| self.to_screen(corner));
        let color = self.colors.ring.with_opacity(0.7);
        for index in 0..CORNERS.len() {
            let next = corners[(index + 1) % CORNERS.len()];
            let ends = [(corners[index], color), (next, color)];
            self.picture.above.add_line(ends, 1.0);
        }
        for corner in corners {
            self.add_corner(corner);
        }
    }

    fn add_corner(&mut self, at: Vec2) {
        let (ring, fill) = (self.colors.ring, self.colors.background);
        for (half, color) in [(HANDLE + 1.5, ring), (HANDLE, fill)] {
            let corners = CORNERS.map(|sign| at + sign * half);
            self.picture.above.add_flat_polygon(&corners, color);
        }
    }
}
