//! All boards and targets in space, without perspective, for the layout editor.

use std::collections::BTreeMap;

use parry3d::math::Vec2;

use super::boards::{FrontState, add_controls};
use super::spaces::{add_name, add_volume};
use super::{Canvas, SceneColors, SceneOptions, add_hand};
use crate::camera::Projection;
use crate::canvas::plan::handles::{self, PlanHandle};
use crate::canvas::plan::{Plan, PlanBoard, PlanItem, PlanShape, PlanView, is_raised};
use crate::canvas::viewport::Viewport;
use crate::editor::Part;
use crate::fonts::text_width;
use crate::picture::{Color, Label, Picture, capsule, convex_hull};
use ademan_core::contact::TargetId;
use ademan_core::contact::volume::VolumeShape;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;

/// Opacity of the resting hands, which are below the boards.
const HAND_OPACITY: f32 = 0.35;

/// Widths of lines, in points.
const EDGE: f32 = 1.2;
const SELECTED: f32 = 2.0;
const FAULT: f32 = 3.0;
const FAULTY_FRONT: f32 = 2.0;
const BEND: f32 = 2.0;

/// Radius of a handle, in points.
const HANDLE: f32 = 5.0;

/// Half the length of the lines of a cross, in points.
const CROSS: f32 = 5.0;

/// Height of the letters beside a handle and at an overlap, in points.
const LETTERS: f32 = 9.0;

/// Distance of the middle of the letters from a handle, in points.
const LETTERS_DISTANCE: f32 = 50.0;

/// Everything that the picture of a plan shows.
pub struct PlanScene<'a> {
    /// The layout of the plan.
    pub layout: &'a Layout,
    /// Its boards and targets in space.
    pub plan: &'a Plan,
    /// The hands around which they are placed.
    pub hands: &'a [HandPose],
    /// The direction from which they are seen.
    pub view: PlanView,
    /// The part of the plan that is seen.
    pub viewport: &'a Viewport,
    /// The selected parts.
    pub selected: &'a [Part],
    /// The values of controls in a session of the layout, which handles and numbers show.
    pub values: Option<&'a BTreeMap<TargetId, f32>>,
    /// Parts with an error, besides boards that overlap.
    pub faulty: &'a dyn Fn(Part) -> bool,
}

/// Draws a plan in pictures of this size in points, the lowest first: the hands, each item from the farthest to the nearest with
/// the raised ones above, and what marks them.
pub fn draw_plan(scene: &PlanScene, size: Vec2, colors: &SceneColors) -> Vec<Picture> {
    let projection = Projection::parallel(
        scene.view.axes(),
        scene.view.point(scene.viewport.center),
        scene.viewport.scale * 1e3,
        size,
    );
    let canvas = || Canvas::new(projection, size, colors);
    let mut hands = canvas();
    for hand in scene.hands {
        add_hand(&mut hands, hand, SceneOptions::default());
    }
    let mut pictures = vec![hands.finish(HAND_OPACITY)];
    let mut items: Vec<&PlanItem> = scene.plan.items.iter().collect();
    items.sort_by(|a, b| {
        let is_on_top = |item: &PlanItem| is_raised(scene.view, item.part, scene.selected);
        let nearness = |item: &PlanItem| item.nearness(scene.view);
        let by_nearness = nearness(a).total_cmp(&nearness(b));
        is_on_top(a).cmp(&is_on_top(b)).then(by_nearness)
    });
    for item in &items {
        let mut own = canvas();
        add_item(&mut own, scene, item);
        pictures.push(own.picture);
    }
    let mut marks = Marks {
        canvas: canvas(),
        scene,
    };
    for item in items {
        marks.add_outline(item);
        marks.add_faulty_fronts(item);
    }
    marks.add_overlaps();
    if let [part] = scene.selected
        && let Some(item) = scene.plan.item(*part)
        && let Some(board) = item.board()
    {
        marks.add_handles(item, board);
    }
    pictures.push(marks.canvas.picture);
    pictures
}

fn add_item(canvas: &mut Canvas, scene: &PlanScene, item: &PlanItem) {
    match &item.shape {
        PlanShape::Board(board) => {
            for strip in board.strips() {
                let corners = strip.map(|corner| canvas.project(corner));
                if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                    let positions = [a, b, c, d].map(|corner| corner.position);
                    let color = canvas.colors.board;
                    canvas.picture.below.add_plain_polygon(&positions, color);
                }
            }
            let state = |_| FrontState::at_rest(scene.values);
            add_controls(canvas, scene.layout, board.index, &board.pose, state);
        }
        PlanShape::Volume(pose, volume) => {
            add_volume(canvas, pose, volume, scene.selected.contains(&item.part));
            let name = match item.part {
                Part::SpaceTarget { space, index } => {
                    let names = scene.layout.spaces.get(space).map(|it| &it.names);
                    names.and_then(|names| names.get(index))
                }
                _ => None,
            };
            if let Some(name) = name {
                add_name(canvas, *pose * volume.center, volume, name);
            }
        }
    }
}

/// The marks of items, drawn above all items.
struct Marks<'a> {
    canvas: Canvas<'a>,
    scene: &'a PlanScene<'a>,
}

impl Marks<'_> {
    fn to_screen(&self, point: Vec2) -> Vec2 {
        self.scene.viewport.to_screen(point, self.canvas.size)
    }

    /// Adds the outline of an item: red with a problem, blue if it is selected.
    fn add_outline(&mut self, item: &PlanItem) {
        let colors = self.canvas.colors;
        let is_faulty = self.scene.plan.is_overlapping(item.part) || (self.scene.faulty)(item.part);
        let is_selected = self.scene.selected.contains(&item.part);
        let (width, color) = match (is_faulty, is_selected) {
            (true, _) => (FAULT, colors.fault),
            (false, true) => (SELECTED, colors.ring),
            (false, false) if item.board().is_some() => (EDGE, colors.key_side),
            (false, false) => return,
        };
        let view = self.scene.view;
        let outline: Vec<Vec2> = match &item.shape {
            PlanShape::Board(board) => board.outline().map(|at| view.flatten(at)).collect(),
            PlanShape::Volume(pose, volume) => match volume.shape {
                VolumeShape::Ball(radius) => {
                    let center = self.to_screen(view.flatten(*pose * volume.center));
                    let radius = radius * 1e3 * self.scene.viewport.scale;
                    let above = &mut self.canvas.picture.above;
                    above.add_ring(center, radius, width, color);
                    return;
                }
                VolumeShape::Box(_) => {
                    let corners = super::volume_corners(volume);
                    let corners = corners.map(|at| view.flatten(*pose * (volume.center + at)));
                    convex_hull(corners.to_vec())
                }
            },
        };
        self.add_lines(&outline, true, width, color);
    }

    /// Adds red outlines of the controls of a board that have an error.
    fn add_faulty_fronts(&mut self, item: &PlanItem) {
        let fronts = item.board().map_or(&[][..], |board| &board.faulty_fronts);
        let (view, color) = (self.scene.view, self.canvas.colors.fault);
        for front in fronts {
            let outline = front.map(|at| view.flatten(at));
            self.add_lines(&outline, true, FAULTY_FRONT, color);
        }
    }

    /// Adds lines between points of the plan.
    fn add_lines(&mut self, points: &[Vec2], is_closed: bool, width: f32, color: Color) {
        let points: Vec<Vec2> = points.iter().map(|at| self.to_screen(*at)).collect();
        let above = &mut self.canvas.picture.above;
        for ends in points.windows(2) {
            above.add_line([(ends[0], color), (ends[1], color)], width);
        }
        if let (true, [first, .., last]) = (is_closed, &points[..]) {
            above.add_line([(*last, color), (*first, color)], width);
        }
    }

    /// Adds the distance by which boards overlap, where they do.
    fn add_overlaps(&mut self) {
        for overlap in &self.scene.plan.overlaps {
            let at = self.to_screen(self.scene.view.flatten(overlap.at));
            let color = self.canvas.colors.fault;
            let text = format!("{:.1} mm", overlap.depth_mm);
            self.add_letters(at, color, text);
        }
    }

    /// Adds letters on a background of their own.
    fn add_letters(&mut self, at: Vec2, color: Color, text: String) {
        let half = text_width(&text) * LETTERS / 2.0;
        let background = self.canvas.colors.background.with_opacity(0.85);
        let plate = capsule(
            (at - Vec2::X * half, LETTERS),
            (at + Vec2::X * half, LETTERS),
        );
        let picture = &mut self.canvas.picture;
        picture.below.add_flat_polygon(&plate, background);
        picture.labels.push(Label {
            position: at,
            right: Vec2::X * LETTERS,
            down: Vec2::Y * LETTERS,
            color,
            text,
        });
    }

    fn add_handles(&mut self, item: &PlanItem, board: &PlanBoard) {
        let (view, scale) = (self.scene.view, self.scene.viewport.scale);
        let (ring, fill) = (self.canvas.colors.ring, self.canvas.colors.background);
        let origin = view.flatten(board.pose.translation);
        for (handle, at) in handles::handles(item, view, scale) {
            match handle {
                PlanHandle::Turn => {
                    let pivot = handles::pivot(board, view);
                    self.add_lines(&[origin, at], false, EDGE, ring);
                    self.add_cross(pivot, ring);
                }
                PlanHandle::Tilt => self.add_lines(&[origin, at], false, EDGE, ring),
                PlanHandle::Bend => {
                    let radius = handles::drawn_radius_mm(board.shape).unwrap_or_default();
                    let curve = handles::bend_curve(board, view, radius);
                    self.add_lines(&curve, false, BEND, ring.with_opacity(0.7));
                    if let Some(written) = board.radius_mm {
                        let beside = self.to_screen(at) + Vec2::X * LETTERS_DISTANCE;
                        let color = self.canvas.colors.label;
                        self.add_letters(beside, color, format!("R {written:.0} mm"));
                    }
                }
            }
            let at = self.to_screen(at);
            let above = &mut self.canvas.picture.above;
            above.add_flat_polygon(&capsule((at, HANDLE), (at, HANDLE)), fill);
            above.add_ring(at, HANDLE, SELECTED, ring);
        }
    }

    /// Adds a cross at the point about which a board turns.
    fn add_cross(&mut self, at: Vec2, color: Color) {
        let at = self.to_screen(at);
        for way in [Vec2::new(1.0, 1.0), Vec2::new(1.0, -1.0)] {
            let ends = [(at - way * CROSS, color), (at + way * CROSS, color)];
            self.canvas.picture.above.add_line(ends, EDGE);
        }
    }
}
