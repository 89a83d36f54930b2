//! The items of a board of a checked layout, and fingertips over it.

use std::collections::BTreeMap;

use parry3d::math::{Vec2, Vec3};

use super::{Item, ItemShape};
use crate::marks::valued_marks;
use ademan_core::contact::TargetId;
use ademan_core::contact::surface::Shape;
use ademan_core::layout::{Board, BoardShape, Face, Handle, Layout};

/// Largest height of a fingertip that is drawn over a board, in millimetres.
const MAX_HEIGHT_MM: f32 = 120.0;

/// A board as the canvas shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoardItems {
    /// Its keys and controls, and then those that are not in the layout because of an error.
    pub items: Vec<Item>,
    /// The targets of the items of the layout, in the same order.
    pub targets: Vec<TargetId>,
    /// Radius of an arc or cylinder in the file, in millimetres.
    pub radius: Option<f32>,
    shape: Option<BoardShape>,
    /// Millimetres of the file per metre.
    mm_per_metre: f32,
}

/// A fingertip over a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fingertip {
    /// Position in row coordinates of the file, in millimetres.
    pub position: Vec2,
    /// Height over the board, in millimetres.
    pub height_mm: f32,
}

impl BoardItems {
    /// Returns the items of a board with a scale in its file.
    pub fn new(layout: &Layout, board: &Board, scale: f32) -> Self {
        let mm_per_metre = 1000.0 / scale;
        let item = |face: &Face, can_turn| item(face, board, mm_per_metre, can_turn);
        let keys = layout.keys[board.keys.clone()].iter();
        let keys = keys.map(|key| (key.face.target, item(&key.face, true)));
        let controls = layout.controls[board.controls.clone()].iter();
        let faces = controls.flat_map(|control| {
            let can_turn = matches!(control.kind.handle(), Handle::Line { .. });
            control.faces.iter().map(move |face| (face, can_turn))
        });
        let placed = faces.map(|(face, can_turn)| {
            let marks = layout.front_marks(face.target, |_| None);
            let item = Item {
                marks: marks.unwrap_or_default(),
                ..item(face, can_turn)
            };
            (face.target, item)
        });
        let (targets, items) = keys.chain(placed).unzip();
        // The radius of a board does not scale with what is on it.
        let radius = match board.shape {
            BoardShape::Flat => None,
            BoardShape::Arc(radius)
            | BoardShape::CurvedRows(radius)
            | BoardShape::CurvedColumns(radius) => Some(radius * 1000.0),
        };
        Self {
            items,
            targets,
            radius,
            shape: Some(board.shape),
            mm_per_metre,
        }
    }

    /// Returns the items with the board on which fingertips are: as it is for another hand than the one for which its file is drawn.
    #[must_use]
    pub fn below_fingertips(mut self, layout: &Layout, board: &Board) -> Self {
        let first = layout.faces(board).next();
        let pair = first.zip(self.items.first());
        let scale = pair.map(|(face, item)| item.shape.half.x / face.outline.half_extents().x);
        self.mm_per_metre = scale.unwrap_or(self.mm_per_metre);
        self.shape = Some(board.shape);
        self
    }

    /// Returns the items with the handles and numbers of values in a session of their layout, at a number of points per millimetre.
    pub fn with_values(
        &self,
        layout: &Layout,
        values: &BTreeMap<TargetId, f32>,
        scale: f32,
    ) -> Vec<Item> {
        let mut items = self.items.clone();
        for (item, target) in items.iter_mut().zip(&self.targets) {
            let marks = valued_marks(layout, *target, values, scale * item.mark_scale);
            item.marks = marks.unwrap_or_default();
        }
        items
    }

    /// Drops all items, and keeps the shape of the board.
    pub fn clear(&mut self) {
        self.items.clear();
        self.targets.clear();
    }

    /// Returns a fingertip at a point in the frame of the board, or `None` far above it.
    pub fn fingertip(&self, point: Vec3) -> Option<Fingertip> {
        let shape = self.shape?;
        let unbent = shape.unbend(point);
        let position = unbent.truncate() * self.mm_per_metre;
        let height_mm = unbent.z * 1000.0;
        (height_mm < MAX_HEIGHT_MM).then_some(Fingertip {
            position,
            height_mm,
        })
    }
}

fn item(face: &Face, board: &Board, mm_per_metre: f32, can_turn: bool) -> Item {
    Item {
        shape: shape(face, board, mm_per_metre),
        label: face.label.clone(),
        marks: Vec::new(),
        mark_scale: mm_per_metre / 1000.0,
        can_turn,
    }
}

/// Returns the outline of a front in row coordinates, at a number of millimetres per metre.
pub(super) fn shape(face: &Face, board: &Board, mm_per_metre: f32) -> ItemShape {
    let outline = &face.outline;
    let rotation = outline.rotation - board.shape.row_rotation(face.row_position);
    ItemShape {
        center: face.row_position * mm_per_metre,
        half: outline.half_extents() * mm_per_metre,
        rotation_deg: rotation.to_degrees(),
        is_disc: matches!(outline.shape, Shape::Disc(_)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::draw::{CanvasScene, draw};
    use super::super::gesture::Preview;
    use super::super::selection::Selection;
    use super::super::viewport::Viewport;
    use super::*;
    use crate::marks::half_width;
    use crate::scene::SceneColors;
    use ademan_core::layout::MarkShape;
    use ademan_runtime::files::Load;

    fn items(name: &str, scale: f32) -> BoardItems {
        let layout = Layout::load(name).unwrap();
        BoardItems::new(&layout, &layout.boards[0], scale)
    }

    #[test]
    fn the_rows_of_an_arc_are_straight() {
        let board = items("qwerty-arc", 1.0);
        let q = &board.items[0];
        assert_eq!(q.label, "Q");
        assert!((q.shape.center - Vec2::new(-95.0, 28.5)).length() < 1e-3);
        assert!(q.shape.rotation_deg.abs() < 1e-3);
        assert_eq!(board.radius, Some(320.0));
    }

    #[test]
    fn positions_are_those_of_the_file_on_a_scaled_board() {
        let name = "keyboards/qwerty-flat-22";
        let text = ademan_core::document::Document::shipped(name).unwrap().text;
        let unscaled = Layout::parse(&text, name).unwrap();
        let larger = text.replacen("anchor: elbow", "anchor: elbow, scale: 1.5", 1);
        let scaled = Layout::parse(&larger, name).unwrap();
        let positions = |layout: &Layout, scale| {
            let board = BoardItems::new(layout, &layout.boards[0], scale);
            board.items[3].shape
        };
        let (a, b) = (positions(&unscaled, 1.0), positions(&scaled, 1.5));
        assert!((a.center - b.center).length() < 1e-3 && (a.half - b.half).length() < 1e-3);
    }

    #[test]
    fn the_marks_of_a_control_fit_into_it_on_a_scaled_board() {
        let text = ademan_core::document::Document::shipped("mixer")
            .unwrap()
            .text;
        let halves = |content: &str, scale: f32| -> Vec<f32> {
            let layout = Layout::parse(content, "mixer").unwrap();
            let board = BoardItems::new(&layout, &layout.boards[0], scale);
            let half = |item: &Item| {
                let marks = item.marks.iter().map(|mark| half_width(&mark.shape));
                marks.fold(0.0, f32::max) * item.mark_scale
            };
            board.items.iter().map(half).collect()
        };
        let larger = text.replacen("anchor: elbow", "anchor: elbow, scale: 1.5", 1);
        let (plain, scaled) = (halves(&text, 1.0), halves(&larger, 1.5));
        assert_eq!(plain.len(), scaled.len());
        for (a, b) in plain.iter().zip(&scaled) {
            assert!(*a > 5.0 && (a - b).abs() < 0.2 * a, "{a} {b}");
        }
    }

    #[test]
    fn every_target_of_a_board_is_an_item() {
        for name in ["workshop", "media", "switches", "game"] {
            let layout = Layout::load(name).unwrap();
            for board in &layout.boards {
                let items = BoardItems::new(&layout, board, 1.0);
                assert_eq!(items.items.len(), layout.faces(board).count(), "{name}");
            }
        }
    }

    #[test]
    fn a_fingertip_over_a_key_of_an_arc_is_over_its_item() {
        let layout = Layout::load("qwerty-arc").unwrap();
        let face = &layout.keys[0].face;
        let above = face.outline.center.extend(0.02);
        let tip = items("qwerty-arc", 1.0).fingertip(above).unwrap();
        assert!((tip.position - face.row_position * 1000.0).length() < 0.1);
        assert!((tip.height_mm - 20.0).abs() < 1e-3);
    }

    #[test]
    fn a_control_of_a_running_session_has_its_handle_and_number_at_its_value() {
        let layout = Layout::load("mixer").unwrap();
        let board = items("mixer", 1.0);
        let fader = layout.target_names().find("Fader 2").unwrap();
        let index = board.targets.iter().position(|it| *it == fader).unwrap();
        let texts = |item: &Item| -> String {
            let texts = item.marks.iter().filter_map(|mark| match &mark.shape {
                MarkShape::Text { text, .. } => Some(text.as_str()),
                _ => None,
            });
            texts.collect()
        };
        assert!(!texts(&board.items[index]).contains('.'), "a drawing");
        let valued = board.with_values(&layout, &BTreeMap::from([(fader, 0.75)]), 8.0);
        assert!(texts(&valued[index]).contains("0.75"));
        assert_ne!(valued[index].marks, board.items[index].marks);
        assert_eq!(valued.len(), board.items.len());
    }

    #[test]
    fn a_scroll_ring_is_drawn_within_its_outline() {
        let board = items("scroll-rings", 1.0);
        let rings = board.items.iter().filter(|item| item.shape.is_disc);
        let rings: Vec<_> = rings.filter(|item| !item.marks.is_empty()).collect();
        assert!(!rings.is_empty());
        for ring in rings {
            let (nothing, still) = (Selection::default(), Preview::default());
            let scene = CanvasScene::new(std::slice::from_ref(ring), &nothing, &still);
            let viewport = Viewport::default();
            let size = Vec2::new(8000.0, 8000.0);
            let picture = draw(&scene, &viewport, size, &SceneColors::LIGHT);
            let center = viewport.to_screen(ring.shape.center, size);
            let layers = [&picture.below, &picture.above];
            let corners = layers.iter().flat_map(|layer| &layer.vertices);
            let farthest = corners.map(|(at, _)| (*at - center).length());
            let farthest = farthest.fold(0.0, f32::max);
            let radius = ring.shape.half.x * viewport.scale;
            assert!((farthest - radius).abs() < 2.0, "{farthest} of {radius}");
        }
    }

    #[test]
    fn the_corners_of_a_front_are_as_round_as_those_of_its_well() {
        for name in ["mixer", "steering-wheel"] {
            let board = items(name, 1.0);
            let boxes = board.items.iter().filter(|item| !item.shape.is_disc);
            for item in boxes {
                let (nothing, still) = (Selection::default(), Preview::default());
                let scene = CanvasScene::new(std::slice::from_ref(item), &nothing, &still);
                let viewport = Viewport {
                    center: item.shape.center,
                    scale: 8.0,
                };
                let size = Vec2::new(8000.0, 8000.0);
                let picture = draw(&scene, &viewport, size, &SceneColors::LIGHT);
                let corners = item.shape.corners().map(|at| viewport.to_screen(at, size));
                let mut drawn = picture.below.vertices.iter();
                let in_corner = drawn.find(|(at, color)| {
                    let is_near = corners.iter().any(|corner| (*corner - *at).length() < 2.0);
                    is_near && color.0[3] > 0
                });
                assert_eq!(in_corner, None, "{name}: {}", item.label);
            }
        }
    }
}
