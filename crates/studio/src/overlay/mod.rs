//! The overlay: boards and fingertips over other programs, for typing into them. It lets clicks through and takes no focus.
//!
//! Its picture is computed from the [`View`] alone, without a window toolkit: boards beside each other, to scale and unrolled, as in
//! the layout editor. `window` shows it.

mod desktop;
pub(super) mod window;

use std::sync::Arc;

use parry3d::math::Vec2;

use super::canvas::board::{BoardItems, Fingertip};
use super::canvas::draw::{self, CanvasScene};
use super::canvas::gesture::Preview;
use super::canvas::selection::Selection;
use super::canvas::viewport::Viewport;
use super::canvas::{Bounds, Item};
use super::picture::{Color, Picture, Triangles};
use super::scene::SceneColors;
use ademan_core::contact::TargetId;
use ademan_core::layout::Layout;
use ademan_runtime::session::view::View;

/// Points per millimetre of the overlay, and of the small window where the desktop has no transparent ones.
const SCALE: f32 = 2.2;
const SMALL_SCALE: f32 = 1.2;

/// Empty edge of a board around its keys, in millimetres.
const EDGE_MM: f32 = 6.0;

/// Largest size of the boards, in points.
const MAX_SIZE: Vec2 = Vec2::new(1100.0, 420.0);

/// Height of the strip above the boards for the candidates of the text decoder, in points.
pub const CANDIDATES_HEIGHT: f32 = 28.0;

/// Height of the strip below the boards with the state, in points.
pub const STATE_HEIGHT: f32 = 22.0;

/// Largest height of a fingertip that is shown, in millimetres.
const MAX_HEIGHT_MM: f32 = 60.0;

/// Opacity of the plate below the keys, relative to theirs.
const PLATE_OPACITY: f32 = 0.55;

/// The boards of a layout beside each other.
pub struct OverlayBoards {
    layout: Arc<Layout>,
    boards: Vec<PlacedBoard>,
    /// Width and height of all boards, in millimetres.
    size_mm: Vec2,
}

/// A board, and its place in the picture.
struct PlacedBoard {
    items: BoardItems,
    bounds: Bounds,
    /// Distance of its left edge from the left edge of the first board, in millimetres.
    left_mm: f32,
}

impl OverlayBoards {
    /// Places the boards of a layout that have keys or controls.
    pub fn new(layout: &Arc<Layout>) -> Self {
        let mut size_mm = Vec2::ZERO;
        let mut boards = Vec::new();
        for board in &layout.boards {
            // The positions of fingertips are those on the board as it is, scaled or not.
            let items = BoardItems::new(layout, board, 1.0);
            let bounds = bounds_of(&items.items);
            let placed = PlacedBoard {
                left_mm: size_mm.x,
                bounds,
                items,
            };
            size_mm.x += bounds.size().x;
            size_mm.y = size_mm.y.max(bounds.size().y);
            boards.push(placed);
        }
        Self {
            layout: Arc::clone(layout),
            boards,
            size_mm,
        }
    }

    /// Returns `true` if the boards belong to this layout.
    pub fn are_of(&self, layout: &Arc<Layout>) -> bool {
        Arc::ptr_eq(&self.layout, layout)
    }

    /// Returns the size of the boards, in points. Large boards are scaled down.
    pub fn size(&self, is_small: bool) -> Vec2 {
        let scale = if is_small { SMALL_SCALE } else { SCALE };
        let size = self.size_mm * scale;
        let shrink = (MAX_SIZE / size.max(Vec2::ONE)).min_element().min(1.0);
        size * shrink
    }

    /// Draws the boards in a picture of this size in points, with pressed keys and fingertips.
    pub fn picture(&self, view: &View, size: Vec2, colors: &SceneColors, opacity: f32) -> Picture {
        let mut picture = Picture::default();
        let scale = (size / self.size_mm.max(Vec2::ONE)).min_element();
        for (index, board) in self.boards.iter().enumerate() {
            let area = board.bounds.size() * scale;
            let viewport = Viewport {
                center: board.bounds.center(),
                scale,
            };
            let offset = Vec2::new(board.left_mm * scale, (size.y - area.y) / 2.0);
            let drawn = draw_board(&board.items, index, view, &viewport, area, colors);
            append(&mut picture, drawn, offset, opacity);
        }
        picture
    }
}

/// Returns the rectangle around the items, with an edge.
fn bounds_of(items: &[Item]) -> Bounds {
    let shapes = items.iter().map(|item| &item.shape);
    let bounds = Bounds::around(shapes).unwrap_or(Bounds::between(Vec2::ZERO, Vec2::ZERO));
    Bounds {
        min: bounds.min - EDGE_MM,
        max: bounds.max + EDGE_MM,
    }
}

fn draw_board(
    items: &BoardItems,
    index: usize,
    view: &View,
    viewport: &Viewport,
    size: Vec2,
    colors: &SceneColors,
) -> Picture {
    let is_pressed = |target: &TargetId| view.state.pressed.contains(target);
    let pressed = items.targets.iter().enumerate();
    let pressed = pressed.filter(|(_, target)| is_pressed(target));
    let pressed: Vec<usize> = pressed.map(|(item, _)| item).collect();
    let own = view.state.fingertips.iter();
    let own = own.filter(|tip| tip.board == index && tip.height_mm <= MAX_HEIGHT_MM);
    let fingertips: Vec<_> = own
        .map(|tip| Fingertip {
            position: Vec2::new(tip.x_mm, tip.y_mm),
            height_mm: tip.height_mm,
        })
        .collect();
    let (nothing, still) = (Selection::default(), Preview::default());
    let scene = CanvasScene {
        pressed: &pressed,
        fingertips: &fingertips,
        ..CanvasScene::new(&items.items, &nothing, &still)
    };
    // Fingertips in the color of skin are not seen on dark keys over a dark program.
    let colors = SceneColors {
        skin: colors.ring,
        skin_edge: colors.label,
        ..*colors
    };
    let mut picture = plate(size, colors.background.with_opacity(PLATE_OPACITY));
    let drawn = draw::draw(&scene, viewport, size, &colors);
    append(&mut picture, drawn, Vec2::ZERO, 1.0);
    picture
}

/// Returns the plate below the keys of a board.
fn plate(size: Vec2, color: Color) -> Picture {
    let corners = [
        Vec2::ZERO,
        Vec2::new(size.x, 0.0),
        size,
        Vec2::new(0.0, size.y),
    ];
    let mut picture = Picture::default();
    picture.below.add_flat_polygon(&corners, color);
    picture
}

/// Adds a picture to another one, moved by an offset.
fn append(picture: &mut Picture, other: Picture, offset: Vec2, opacity: f32) {
    let fade = |color: Color| color.with_opacity(f32::from(color.0[3]) / 255.0 * opacity);
    let add = |to: &mut Triangles, from: Triangles| {
        let first = to.vertices.len() as u32;
        let vertices = from.vertices.into_iter();
        to.vertices
            .extend(vertices.map(|(at, color)| (at + offset, fade(color))));
        let indices = from.indices.into_iter();
        to.indices.extend(indices.map(|index| first + index));
    };
    add(&mut picture.below, other.below);
    add(&mut picture.above, other.above);
    add(&mut picture.marks, other.marks);
    for mut label in other.labels {
        label.position += offset;
        label.color = fade(label.color);
        picture.labels.push(label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_core::hand::{Finger, Side};
    use ademan_runtime::files::Load;
    use ademan_runtime::session::view::{Fingertip as ViewFingertip, ViewState};

    fn view(layout: &Arc<Layout>) -> View {
        View {
            layout: Arc::clone(layout),
            state: Arc::new(ViewState::starting("main", "typist", "none")),
            boards: Arc::new([]),
            messages: Arc::new([]),
            missed: 0,
        }
    }

    fn layout(name: &str) -> Arc<Layout> {
        Arc::new(Layout::load(name).unwrap())
    }

    fn picture(view: &View, opacity: f32) -> Picture {
        let boards = OverlayBoards::new(&view.layout);
        let size = boards.size(false);
        boards.picture(view, size, &SceneColors::DARK, opacity)
    }

    #[test]
    fn a_pressed_key_lights_up_and_a_fingertip_is_over_its_key() {
        let layout = layout("qwerty-flat");
        let mut view = view(&layout);
        let has_lit = |picture: &Picture| {
            let lit = SceneColors::DARK.lit;
            picture
                .below
                .vertices
                .iter()
                .any(|(_, color)| *color == lit)
        };
        assert!(!has_lit(&picture(&view, 1.0)));
        let key = &layout.keys[3].face;
        let state = Arc::make_mut(&mut view.state);
        state.pressed = vec![key.target];
        state.fingertips = vec![ViewFingertip {
            side: Side::Right,
            finger: Finger::Index,
            board: 0,
            x_mm: key.row_position.x * 1000.0,
            y_mm: key.row_position.y * 1000.0,
            height_mm: -2.0,
        }];
        let picture = picture(&view, 1.0);
        assert!(has_lit(&picture));
        let label = picture.labels.iter().find(|it| it.text == key.label);
        let tips = &picture.above.vertices;
        let middle = tips.iter().map(|(at, _)| *at).sum::<Vec2>() / tips.len() as f32;
        assert!((middle - label.unwrap().position).length() < 1.0);
    }

    #[test]
    fn boards_of_two_hands_stand_beside_each_other() {
        let layout = layout("qwerty-two-flat");
        let picture = picture(&view(&layout), 1.0);
        let places = |text: &str| {
            let label = picture.labels.iter().find(|label| label.text == text);
            label.unwrap().position.x
        };
        assert!(
            places("Q") < places("T") && places("T") < places("Y") && places("Y") < places("P")
        );
    }

    #[test]
    fn every_layout_has_its_place_and_its_size() {
        for name in ademan_core::document::shipped_layouts() {
            let layout = layout(name);
            for is_small in [false, true] {
                let size = OverlayBoards::new(&layout).size(is_small);
                assert!(size.cmple(MAX_SIZE + 0.1).all(), "{name}: {size}");
            }
        }
    }

    #[test]
    fn a_lower_opacity_fades_everything() {
        let layout = layout("numpad");
        let faded = picture(&view(&layout), 0.5);
        let opacities = faded.below.vertices.iter().map(|(_, color)| color.0[3]);
        assert_eq!(opacities.max(), Some(127));
        assert!(faded.labels.iter().all(|label| label.color.0[3] == 127));
    }
}
