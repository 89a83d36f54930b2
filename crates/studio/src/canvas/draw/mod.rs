//! The picture of the canvas: grid, keys, selection and guides.

mod handles;
mod radius;

use parry3d::math::Vec2;

use super::board::Fingertip;
use super::gesture::Preview;
use super::selection::Selection;
use super::viewport::Viewport;
use super::{Bounds, CORNERS, Item, ItemShape, group};
use crate::fonts::{Fitted, fitted};
use crate::marks::{FrontView, add_marks, corner_steps, half_width, heated, rounded};
use crate::picture::{Color, Label, Picture, disc, with_known_signs};
use crate::scene::SceneColors;
use ademan_core::layout::{FrontMark, MarkRole, MarkShape};

/// Height of a label as a fraction of the smaller side of its item.
const LABEL_HEIGHT: f32 = 0.36;

/// Range of the height of labels, in points. Smaller ones are not drawn.
const LABEL_SIZES: (f32, f32) = (6.5, 22.0);

/// The room of a label, as a part of the width and height of its item.
const LABEL_ROOM: f32 = 0.88;

/// Side of an item on the screen below which it is drawn without an edge, in points.
const SMALL: f32 = 7.0;

/// Width of the outline of an item with an error, in points.
const FAULT: f32 = 3.0;

/// The width of a well as a part of its item from which it hides the front.
const HIDING: f32 = 0.8;

/// Everything that the picture shows.
pub struct CanvasScene<'a> {
    /// The keys and controls.
    pub items: &'a [Item],
    /// The selected ones.
    pub selected: &'a Selection,
    /// The outlines of items with an error.
    pub faulty: &'a [ItemShape],
    /// The strengths of a color over the items, 0..=1, in their order; items without one have none.
    pub heats: &'a [f32],
    /// Items that are pressed at present.
    pub pressed: &'a [usize],
    /// Fingertips over the board.
    pub fingertips: &'a [Fingertip],
    /// A gesture in progress.
    pub preview: &'a Preview,
    /// Radius of an arc or cylinder, in millimetres.
    pub radius: Option<f32>,
    /// A grid is drawn below the items.
    pub has_grid: bool,
}

impl<'a> CanvasScene<'a> {
    /// Creates a scene of items without anything over or below them.
    pub fn new(items: &'a [Item], selected: &'a Selection, preview: &'a Preview) -> Self {
        Self {
            items,
            selected,
            faulty: &[],
            heats: &[],
            pressed: &[],
            fingertips: &[],
            preview,
            radius: None,
            has_grid: false,
        }
    }
}

/// The pen of a picture.
struct Pen<'a> {
    picture: Picture,
    viewport: &'a Viewport,
    size: Vec2,
    colors: &'a SceneColors,
}

/// Draws the canvas in a picture of this size in points.
pub fn draw(scene: &CanvasScene, viewport: &Viewport, size: Vec2, colors: &SceneColors) -> Picture {
    let mut pen = Pen {
        picture: Picture::default(),
        viewport,
        size,
        colors,
    };
    if scene.has_grid {
        pen.add_grid();
    }
    if let Some(radius) = scene.radius {
        pen.add_bend(scene.items, radius);
    }
    let visible = viewport.visible(size);
    let mut shapes: Vec<ItemShape> = scene.items.iter().map(|item| item.shape).collect();
    for &(index, shape) in &scene.preview.shapes {
        if let Some(own) = shapes.get_mut(index) {
            *own = shape;
        }
    }
    // Dragged items are above everything, and selected ones above the rest.
    let is_dragged = |index: usize| scene.preview.shapes.iter().any(|(own, _)| *own == index);
    let mut order: Vec<usize> = (0..shapes.len()).collect();
    order.sort_by_key(|&index| (scene.selected.contains(index), is_dragged(index)));
    for index in order {
        let (item, shape) = (&scene.items[index], &shapes[index]);
        if shape.bounds().touches(visible) {
            let look = match (
                scene.pressed.contains(&index),
                scene.selected.contains(index),
            ) {
                (true, _) => Look::Pressed,
                (false, true) => Look::Selected,
                (false, false) => Look::Plain,
            };
            let heat = scene.heats.get(index).copied().unwrap_or_default();
            pen.add_item(item, shape, (look, heat));
        }
    }
    for shape in scene.faulty {
        pen.add_fault(shape);
    }
    if let Some(item) = scene.selected.single().and_then(|it| scene.items.get(it)) {
        let index = scene.selected.single().unwrap_or_default();
        pen.add_handles(&Item {
            shape: shapes[index],
            ..item.clone()
        });
    }
    if let Some(frame) = framed(scene, &shapes) {
        pen.add_frame(frame);
    }
    for guide in &scene.preview.guides {
        pen.add_line(guide.from, guide.to, 1.5, colors.lit);
    }
    for fingertip in scene.fingertips {
        pen.add_fingertip(fingertip);
    }
    if let Some(band) = scene.preview.band {
        pen.add_band(band);
    }
    pen.picture
}

/// Returns the frame around several selected items with these outlines.
fn framed(scene: &CanvasScene, shapes: &[ItemShape]) -> Option<Bounds> {
    let around = group::frame(scene.items, scene.selected)?;
    if let Some(scaling) = scene.preview.scaling {
        return Some(scaling.frame);
    }
    if scene.preview.shapes.is_empty() {
        return Some(around);
    }
    let selected = scene.selected.iter();
    Bounds::around(selected.filter_map(|index| shapes.get(index)))
}

/// The look of an item.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Look {
    Plain,
    Selected,
    Pressed,
}

impl Pen<'_> {
    fn to_screen(&self, point: Vec2) -> Vec2 {
        self.viewport.to_screen(point, self.size)
    }

    fn add_grid(&mut self) {
        let step = self.viewport.grid_mm();
        let visible = self.viewport.visible(self.size);
        let (weak, strong) = (
            self.colors.background.mix(self.colors.board, 0.35),
            self.colors.background.mix(self.colors.board, 0.9),
        );
        for axis in [0, 1] {
            let (first, last) = (visible.min[axis] / step, visible.max[axis] / step);
            for line in first.ceil() as i32..=last.floor() as i32 {
                let (mut from, mut to) = (visible.min, visible.max);
                from[axis] = line as f32 * step;
                to[axis] = from[axis];
                let color = if line % 5 == 0 { strong } else { weak };
                self.add_line(from, to, 1.0, color);
            }
        }
        let axis_color = self.colors.background.mix(self.colors.bone, 0.6);
        for (from, to) in [
            (Vec2::new(visible.min.x, 0.0), Vec2::new(visible.max.x, 0.0)),
            (Vec2::new(0.0, visible.min.y), Vec2::new(0.0, visible.max.y)),
        ] {
            self.add_line(from, to, 1.0, axis_color);
        }
    }

    /// Adds a line between two points of the board, of a width in points.
    fn add_line(&mut self, from: Vec2, to: Vec2, width: f32, color: Color) {
        let (from, to) = (self.to_screen(from), self.to_screen(to));
        let side = (to - from).normalize_or_zero().perp() * (width / 2.0);
        let corners = [from + side, to + side, to - side, from - side];
        self.picture.below.add_plain_polygon(&corners, color);
    }

    fn add_item(&mut self, item: &Item, shape: &ItemShape, (look, heat): (Look, f32)) {
        let colors = self.colors;
        let (front, side) = match look {
            Look::Plain => (heated(colors.key, heat, colors), colors.key_side),
            Look::Selected => (colors.key.mix(colors.ring, 0.35), colors.ring),
            Look::Pressed => (colors.lit, colors.lit_side),
        };
        let side_pt = shape.half.min_element() * 2.0 * self.viewport.scale;
        if side_pt < SMALL {
            let outline = self.outline(shape, (0.0, 0.0));
            self.picture.below.add_plain_polygon(&outline, front);
            return;
        }
        let edge = if look == Look::Selected { 2.0 } else { 1.2 };
        // As round as the well on it.
        let stretch = (shape.half / item.shape.half).min_element();
        let radius = corner_radius(item) * stretch;
        let outer = self.outline(shape, (0.0, radius));
        let inner = self.outline(shape, (edge, radius));
        self.picture.hide_labels(&outer);
        self.picture.below.add_flat_polygon(&outer, side);
        self.picture.below.add_flat_polygon(&inner, front);
        if item.marks.is_empty() {
            self.add_label(item, shape, look)
        } else {
            self.add_marks(item, shape, (look, heat))
        }
    }

    /// Adds handle, scale and label of a control. While it is resized, they are stretched.
    fn add_marks(&mut self, item: &Item, shape: &ItemShape, (look, heat): (Look, f32)) {
        let viewport = *self.viewport;
        let size = self.size;
        let stretch = shape.half / item.shape.half * item.mark_scale;
        let to_screen = |point: Vec2| {
            let on_board = shape.center + shape.rotated(point * stretch);
            Some(viewport.to_screen(on_board, size))
        };
        let view = FrontView {
            to_screen: &to_screen,
            scale: viewport.scale * stretch.min_element(),
            colors: self.colors,
            is_lit: look == Look::Pressed,
            heat: if look == Look::Plain { heat } else { 0.0 },
        };
        // The selection is seen in the front, which a well of its size would hide.
        let marks = item.marks.iter();
        let marks: Vec<FrontMark> = marks
            .filter(|mark| look == Look::Plain || !hides_front(item, mark))
            .cloned()
            .collect();
        add_marks(&mut self.picture, &marks, &view);
    }

    /// Adds the outline of an item with an error, above all items.
    fn add_fault(&mut self, shape: &ItemShape) {
        let color = self.colors.fault;
        if shape.is_disc {
            let radius = shape.half.x * self.viewport.scale;
            let center = self.to_screen(shape.center);
            self.picture.above.add_ring(center, radius, FAULT, color);
            return;
        }
        let corners = self.outline(shape, (0.0, 0.0));
        for (index, &from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            let ends = [(from, color), (to, color)];
            self.picture.above.add_line(ends, FAULT);
        }
    }

    /// Returns the outline on the screen, without an edge of a width in points, with corners of a radius in millimetres.
    fn outline(&self, shape: &ItemShape, (edge, radius): (f32, f32)) -> Vec<Vec2> {
        let inset = edge / self.viewport.scale;
        if shape.is_disc {
            let on_screen = (shape.half.x - inset) * self.viewport.scale;
            return disc(self.to_screen(shape.center), on_screen);
        }
        let half = shape.half - inset;
        let corners = match radius - inset {
            inner if inner > 0.0 => rounded(half, inner, corner_steps(inner * self.viewport.scale)),
            _ => CORNERS.map(|sign| sign * half).into(),
        };
        let corners = corners.into_iter();
        let on_board = corners.map(|corner| shape.center + shape.rotated(corner));
        on_board.map(|corner| self.to_screen(corner)).collect()
    }

    fn add_label(&mut self, item: &Item, shape: &ItemShape, look: Look) {
        let extent = shape.bounds().size() * self.viewport.scale;
        let largest = (extent.min_element() * LABEL_HEIGHT).min(LABEL_SIZES.1);
        let text = with_known_signs(&item.label);
        let Fitted { text, size } = fitted(text, extent * LABEL_ROOM, largest);
        if size < LABEL_SIZES.0 {
            return;
        }
        let color = match look {
            Look::Pressed => self.colors.lit_label,
            Look::Plain | Look::Selected => self.colors.label,
        };
        self.picture.labels.push(Label {
            position: self.to_screen(shape.center),
            right: Vec2::X * size,
            down: Vec2::Y * size,
            color,
            text,
        });
    }

    /// Adds a disc that is larger and paler the higher the fingertip is.
    fn add_fingertip(&mut self, fingertip: &Fingertip) {
        let height = fingertip.height_mm.max(0.0);
        let radius = (4.0 + height * 0.08) * self.viewport.scale;
        let color = self.colors.skin.with_opacity(0.8 / (1.0 + height * 0.08));
        let center = self.to_screen(fingertip.position);
        let (above, edge) = (&mut self.picture.above, self.colors.skin_edge);
        above.add_flat_polygon(&disc(center, radius), color);
        above.add_ring(center, radius, 1.0, edge.with_opacity(0.7));
    }

    fn add_band(&mut self, band: Bounds) {
        let corners = [
            band.min,
            Vec2::new(band.max.x, band.min.y),
            band.max,
            Vec2::new(band.min.x, band.max.y),
        ];
        let on_screen = corners.map(|corner| self.to_screen(corner));
        let fill = self.colors.ring.with_opacity(0.18);
        self.picture.above.add_plain_polygon(&on_screen, fill);
        for index in 0..corners.len() {
            let next = corners[(index + 1) % corners.len()];
            self.add_line(corners[index], next, 1.0, self.colors.ring);
        }
    }
}

/// Returns `true` if a mark is a well that hides the front of its item.
fn hides_front(item: &Item, mark: &FrontMark) -> bool {
    let half = half_width(&mark.shape) * item.mark_scale;
    mark.role == MarkRole::Well && half > HIDING * item.shape.half.x
}

/// Returns the radius of the corners of the well that hides the front of an item, in millimetres; 0 without one.
fn corner_radius(item: &Item) -> f32 {
    let mut wells = item.marks.iter().filter(|mark| hides_front(item, mark));
    match wells.next().map(|well| &well.shape) {
        Some(MarkShape::Box { radius, .. }) => radius * item.mark_scale,
        _ => 0.0,
    }
}

/// Returns half the width of the row that shows the bend: half the width of the items, and at least 60 mm.
pub fn bend_half_width(items: &[Item]) -> f32 {
    let bounds = Bounds::around(items.iter().map(|item| &item.shape));
    let reach = bounds.map_or(0.0, |bounds| bounds.max.x.abs().max(bounds.min.x.abs()));
    reach.max(60.0)
}

#[cfg(test)]
mod tests {
    use super::super::board::BoardItems;
    use super::super::tests::square;
    use super::*;
    use crate::marks::heated as heated_front;
    use ademan_core::layout::Layout;
    use ademan_runtime::files::Load;

    const SIZE: Vec2 = Vec2::new(800.0, 500.0);

    fn picture(items: &[Item], viewport: &Viewport) -> Picture {
        let (nothing, still) = (Selection::default(), Preview::default());
        let scene = CanvasScene {
            has_grid: true,
            ..CanvasScene::new(items, &nothing, &still)
        };
        draw(&scene, viewport, SIZE, &SceneColors::LIGHT)
    }

    #[test]
    fn labels_are_drawn_only_where_they_can_be_read() {
        let items = [square(0.0, 0.0), square(19.0, 0.0)];
        let near = picture(&items, &Viewport::default());
        assert_eq!(near.labels.len(), 2);
        let far = Viewport {
            scale: 0.4,
            ..Viewport::default()
        };
        assert!(picture(&items, &far).labels.is_empty());
    }

    #[test]
    fn an_item_that_is_often_missed_has_a_color() {
        let items = [square(0.0, 0.0), square(19.0, 0.0)];
        let (nothing, still) = (Selection::default(), Preview::default());
        let heated = |heats: &[f32]| {
            let scene = CanvasScene {
                heats,
                ..CanvasScene::new(&items, &nothing, &still)
            };
            let picture = draw(&scene, &Viewport::default(), SIZE, &SceneColors::LIGHT);
            let vertices = picture.below.vertices.into_iter();
            vertices.map(|(_, color)| color).collect::<Vec<_>>()
        };
        let (plain, one) = (heated(&[]), heated(&[0.0, 1.0]));
        assert_eq!(plain, heated(&[0.0; 2]));
        assert_ne!(plain, one);
        let hottest = heated_front(SceneColors::LIGHT.key, 1.0, &SceneColors::LIGHT);
        assert!(one.contains(&hottest) && one.contains(&SceneColors::LIGHT.key));
    }

    #[test]
    fn a_control_that_is_often_missed_has_the_color_in_its_front() {
        let layout = Layout::load("mixer").unwrap();
        let controls = BoardItems::new(&layout, &layout.boards[0], 1.0).items;
        let colors = &SceneColors::DARK;
        let (nothing, still) = (Selection::default(), Preview::default());
        for item in controls {
            assert!(!item.marks.is_empty());
            let viewport = Viewport {
                center: item.shape.center,
                scale: 8.0,
            };
            let area = |heat: f32| {
                let scene = CanvasScene {
                    heats: &[heat],
                    ..CanvasScene::new(std::slice::from_ref(&item), &nothing, &still)
                };
                let picture = draw(&scene, &viewport, SIZE, colors);
                let well = heated_front(colors.key.mix(colors.key_side, 0.3), heat, colors);
                let vertices = picture.below.vertices.iter();
                vertices.filter(|(_, color)| *color == well).count()
            };
            let (plain, hot) = (area(0.0), area(1.0));
            assert!(hot > 0 && hot == plain, "{}: {plain} {hot}", item.label);
        }
    }

    #[test]
    fn items_outside_the_picture_cost_nothing() {
        let empty = picture(&[], &Viewport::default());
        let outside = picture(&[square(900.0, 0.0)], &Viewport::default());
        assert_eq!(outside.below.vertices.len(), empty.below.vertices.len());
    }

    #[test]
    fn a_previewed_item_is_drawn_where_it_is_dragged() {
        let items = [square(0.0, 0.0)];
        let mut selected = Selection::default();
        selected.set([0]);
        let offset = Vec2::new(40.0, 0.0);
        let snap = super::super::snap::SnapSettings::OFF;
        let preview = super::super::gesture::moved(&items, &selected, offset, snap);
        let viewport = Viewport::default();
        let scene = CanvasScene {
            radius: Some(320.0),
            has_grid: true,
            ..CanvasScene::new(&items, &selected, &preview)
        };
        let picture = draw(&scene, &viewport, SIZE, &SceneColors::DARK);
        let label = picture.labels.iter().find(|label| label.text == "A");
        let expected = viewport.to_screen(offset, SIZE);
        assert_eq!(label.map(|label| label.position), Some(expected));
        let count = picture.above.vertices.len() as u32;
        assert!(count > 0 && picture.above.indices.iter().all(|&index| index < count));
    }
}
