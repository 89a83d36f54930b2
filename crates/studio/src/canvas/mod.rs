//! The flat picture of a board on which a layout is edited: positions as written in the file, without a window.
//!
//! Lengths are in millimetres in row coordinates, +X along a row to the right and +Y away from the wearer, so that arcs and
//! cylinders are unrolled. An [`Item`] is a key or a control; indices are positions in the list of items of one board.

pub mod bend;
pub mod board;
pub mod choices;
pub mod draw;
pub mod free;
pub mod gesture;
pub mod group;
pub mod handles;
pub mod plan;
pub mod rulers;
pub mod selection;
pub mod snap;
pub mod viewport;

use parry3d::math::Vec2;

use super::editor::Place;
use ademan_core::layout::FrontMark;

/// The outline of a key or control in row coordinates, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ItemShape {
    /// The center.
    pub center: Vec2,
    /// Half of width and depth before the rotation; a disc has its radius in both.
    pub half: Vec2,
    /// Rotation about the center, in degrees, counter-clockwise.
    pub rotation_deg: f32,
    /// The outline is a disc.
    pub is_disc: bool,
}

/// A key or control on the canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its outline.
    pub shape: ItemShape,
    /// The text on it.
    pub label: String,
    /// Handle, scale and label of a control that is not a key; empty for a key.
    pub marks: Vec<FrontMark>,
    /// Millimetres of the outline per millimetre of the marks, which have the size of a board with a scale.
    pub mark_scale: f32,
    /// The file gives it a rotation.
    pub can_turn: bool,
}

impl Item {
    /// Creates the item of a control whose place is only known as it is written.
    pub fn written(place: &Place, label: String, can_turn: bool) -> Self {
        let point = |[x, y]: [f64; 2]| Vec2::new(x as f32, y as f32);
        Self {
            shape: ItemShape {
                center: point(place.center_mm),
                half: point(place.size_mm) / 2.0,
                rotation_deg: place.rotation_deg as f32,
                is_disc: place.is_round,
            },
            label,
            marks: Vec::new(),
            mark_scale: 1.0,
            can_turn,
        }
    }
}

/// An axis-aligned rectangle, in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner at the left, towards the wearer.
    pub min: Vec2,
    /// The corner at the right, away from the wearer.
    pub max: Vec2,
}

impl Bounds {
    /// Creates the rectangle between two corners in any order.
    pub fn between(a: Vec2, b: Vec2) -> Self {
        Self {
            min: a.min(b),
            max: a.max(b),
        }
    }

    /// Returns the smallest rectangle around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Returns the rectangle around outlines, or `None` without any.
    pub fn around<'a>(shapes: impl Iterator<Item = &'a ItemShape>) -> Option<Self> {
        shapes.map(ItemShape::bounds).reduce(Self::union)
    }

    /// Returns the center.
    pub fn center(self) -> Vec2 {
        (self.min + self.max) / 2.0
    }

    /// Returns width and depth.
    pub fn size(self) -> Vec2 {
        self.max - self.min
    }

    /// Returns `true` if the rectangles share a point.
    pub fn touches(self, other: Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Returns `true` if the other rectangle is within this one.
    pub fn encloses(self, other: Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }
}

impl ItemShape {
    /// Returns a vector of the item's own axes in row coordinates.
    pub fn rotated(&self, local: Vec2) -> Vec2 {
        Vec2::from_angle(self.rotation_deg.to_radians()).rotate(local)
    }

    /// Returns a point in the item's own axes, from its center.
    pub fn local(&self, point: Vec2) -> Vec2 {
        Vec2::from_angle(-self.rotation_deg.to_radians()).rotate(point - self.center)
    }

    /// Returns the four corners, counter-clockwise from the left corner towards the wearer.
    pub fn corners(&self) -> [Vec2; 4] {
        CORNERS.map(|sign| self.center + self.rotated(sign * self.half))
    }

    /// Returns the rectangle around the outline.
    pub fn bounds(&self) -> Bounds {
        let half = if self.is_disc {
            self.half
        } else {
            let (sin, cos) = self.rotation_deg.to_radians().sin_cos();
            let (sin, cos) = (sin.abs(), cos.abs());
            Vec2::new(
                self.half.x * cos + self.half.y * sin,
                self.half.x * sin + self.half.y * cos,
            )
        };
        Bounds {
            min: self.center - half,
            max: self.center + half,
        }
    }

    /// Returns `true` if a point is on the item.
    pub fn contains(&self, point: Vec2) -> bool {
        if self.is_disc {
            (point - self.center).length() <= self.half.x
        } else {
            self.local(point).abs().cmple(self.half).all()
        }
    }
}

/// Signs of the corners, counter-clockwise from the left corner towards the wearer.
pub const CORNERS: [Vec2; 4] = [
    Vec2::new(-1.0, -1.0),
    Vec2::new(1.0, -1.0),
    Vec2::new(1.0, 1.0),
    Vec2::new(-1.0, 1.0),
];

/// Returns the index of the item at a point; of several the one drawn last.
pub fn item_at(items: &[Item], point: Vec2) -> Option<usize> {
    items.iter().rposition(|item| item.shape.contains(point))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn square(x: f32, y: f32) -> Item {
        Item {
            shape: ItemShape {
                center: Vec2::new(x, y),
                half: Vec2::splat(8.5),
                rotation_deg: 0.0,
                is_disc: false,
            },
            label: "A".to_owned(),
            marks: Vec::new(),
            mark_scale: 1.0,
            can_turn: true,
        }
    }

    #[test]
    fn a_turned_item_is_hit_where_it_is_drawn() {
        let mut item = square(10.0, 0.0);
        item.shape.half = Vec2::new(30.0, 5.0);
        item.shape.rotation_deg = 90.0;
        assert!(item.shape.contains(Vec2::new(10.0, 28.0)));
        assert!(!item.shape.contains(Vec2::new(38.0, 0.0)));
        let bounds = item.shape.bounds();
        assert!((bounds.size() - Vec2::new(10.0, 60.0)).length() < 1e-4);
        item.shape.is_disc = true;
        item.shape.half = Vec2::splat(10.0);
        assert!(!item.shape.contains(Vec2::new(19.0, 9.0)), "beside a disc");
    }

    #[test]
    fn the_item_drawn_last_is_hit() {
        let items = [square(0.0, 0.0), square(5.0, 0.0)];
        assert_eq!(item_at(&items, Vec2::new(3.0, 0.0)), Some(1));
        assert_eq!(item_at(&items, Vec2::new(-6.0, 0.0)), Some(0));
        assert_eq!(item_at(&items, Vec2::new(30.0, 0.0)), None);
    }
}
