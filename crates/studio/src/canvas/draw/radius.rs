//! The bend of an arc or cylinder, with its radius in words.

use parry3d::math::Vec2;

use super::{Pen, bend_half_width};
use crate::canvas::{Bounds, Item, bend};
use crate::fonts::text_width;
use crate::picture::{Label, disc};

/// Height of the radius of a bend, in points.
const RADIUS_LABEL: f32 = 9.0;

/// Distance of the radius from the end of the bend, in points, and the number of distances that are tried.
const RADIUS_GAP: f32 = 9.0;
const RADIUS_PLACES: u8 = 12;

impl Pen<'_> {
    /// Adds the bent row through the origin, with a handle at its end and the radius beside it.
    pub fn add_bend(&mut self, items: &[Item], radius: f32) {
        let curve = bend::curve(radius, bend_half_width(items));
        for ends in curve.windows(2) {
            self.add_line(ends[0], ends[1], 2.0, self.colors.ring.with_opacity(0.7));
        }
        if let Some(&end) = curve.last() {
            let end = self.to_screen(end);
            let (ring, fill) = (self.colors.ring, self.colors.background);
            self.picture.above.add_flat_polygon(&disc(end, 5.0), fill);
            self.picture.above.add_ring(end, 5.0, 2.0, ring);
            let text = format!("R {radius:.0} mm");
            let width = text_width(&text) * RADIUS_LABEL;
            let half = Vec2::new(width / 2.0, RADIUS_LABEL);
            self.picture.labels.push(Label {
                position: self.free_place(items, end, half),
                right: Vec2::X * RADIUS_LABEL,
                down: Vec2::Y * RADIUS_LABEL,
                color: self.colors.label,
                text,
            });
        }
    }

    /// Returns the center of a label beside a point of the picture: below it, at a side or above it, where the label covers no item.
    /// `half` are the half extents of the label.
    fn free_place(&self, items: &[Item], at: Vec2, half: Vec2) -> Vec2 {
        let beside = half + RADIUS_GAP;
        let ways = [Vec2::Y, Vec2::X, Vec2::NEG_X, Vec2::NEG_Y];
        // Farther from the point if there is no room beside it.
        let ways = (0..RADIUS_PLACES).flat_map(|step| {
            let farther = RADIUS_GAP * f32::from(step);
            ways.map(|way| way * (beside + farther))
        });
        let taken: Vec<Bounds> = items.iter().map(|item| item.shape.bounds()).collect();
        let is_free = |way: &Vec2| {
            let corners = [at + way - half, at + way + half];
            let [a, b] = corners.map(|corner| self.viewport.to_board(corner, self.size));
            let words = Bounds::between(a, b);
            !taken.iter().any(|item| item.touches(words))
        };
        at + ways.clone().find(is_free).unwrap_or(Vec2::Y * beside)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CanvasScene, draw};
    use super::*;
    use crate::canvas::gesture::Preview;
    use crate::canvas::selection::Selection;
    use crate::canvas::tests::square;
    use crate::canvas::viewport::Viewport;
    use crate::scene::SceneColors;

    const SIZE: Vec2 = Vec2::new(800.0, 500.0);

    #[test]
    fn the_radius_of_a_bend_is_written_beside_the_keys() {
        let viewport = Viewport {
            scale: 2.0,
            ..Viewport::default()
        };
        // Keys all around the end of the bend, at (60, −6).
        let place = |index: u8| [index % 5, index / 5].map(|step| 19.0 * f32::from(step));
        let around = (0..25).map(place);
        let items: Vec<Item> = around.map(|[x, y]| square(x + 22.0, y - 44.0)).collect();
        let (nothing, still) = (Selection::default(), Preview::default());
        let scene = CanvasScene {
            radius: Some(320.0),
            ..CanvasScene::new(&items, &nothing, &still)
        };
        let picture = draw(&scene, &viewport, SIZE, &SceneColors::LIGHT);
        let mut labels = picture.labels.iter();
        let radius = labels.find(|it| it.text == "R 320 mm").unwrap();
        let half = Vec2::new(text_width(&radius.text), 2.0) * RADIUS_LABEL / 2.0;
        let corners = [radius.position - half, radius.position + half];
        let [a, b] = corners.map(|corner| viewport.to_board(corner, SIZE));
        let words = Bounds::between(a, b);
        assert!(items.iter().all(|item| !item.shape.bounds().touches(words)));
    }
}
