//! All boards and targets in space, where they are with the hands at rest, without a window.
//!
//! Positions on the picture are in millimetres, +X to its right and +Y up; see [`PlanView`]. An item is a board or a target in space.

pub mod gesture;
pub mod handles;
mod view;

use parry3d::math::{Pose, Vec2, Vec3};

pub use self::view::PlanView;
use super::{Bounds, board};
use crate::editor::{LayoutEditor, Part};
use crate::picture::convex_hull;
use crate::scene::{front_corners, volume_corners};
use ademan_core::contact::surface::Surface;
use ademan_core::contact::volume::{Volume, VolumeShape};
use ademan_core::hand::Finger;
use ademan_core::kinematics::{HandPose, StartPlace};
use ademan_core::layout::{Board, BoardShape, Layout};

/// The edge of the plate of a board around its fronts, in millimetres.
const MARGIN_MM: f32 = 5.0;

/// Half the width of a board without keys, in millimetres.
const EMPTY_MM: f32 = 20.0;

/// Lines along a curved edge.
const CURVE_STEPS: usize = 32;

/// All boards and targets in space of a layout.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The boards, then the targets in space.
    pub items: Vec<PlanItem>,
    /// The pairs of boards in one place.
    pub overlaps: Vec<PlanOverlap>,
}

/// Two boards in one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanOverlap {
    /// Indices of the boards.
    pub boards: [usize; 2],
    /// The middle of the controls that overlap most, in the world.
    pub at: Vec3,
    /// The distance by which they overlap, in millimetres.
    pub depth_mm: f32,
}

/// A board or a target in space.
#[derive(Clone, Debug)]
pub struct PlanItem {
    /// Its part of the text.
    pub part: Part,
    /// Its outline in the world, in metres.
    pub shape: PlanShape,
    /// Its pose as written in the file.
    pub written: WrittenPose,
}

/// The shape of a board or target in the world, in metres.
#[derive(Clone, Debug)]
pub enum PlanShape {
    /// A board.
    Board(PlanBoard),
    /// A target in space, in its frame.
    Volume(Pose, Volume),
}

/// A board in the world, in metres.
#[derive(Clone, Debug)]
pub struct PlanBoard {
    /// Its index.
    pub index: usize,
    /// The pose of its frame.
    pub pose: Pose,
    /// Flat or curved.
    pub shape: BoardShape,
    /// Two opposite edges of its plate, with points at equal places: the near and the far one, or those at the left and the right
    /// of a board with curved columns.
    pub edges: [Vec<Vec3>; 2],
    /// The rectangle around its fronts in row coordinates, in millimetres.
    pub rows: Bounds,
    /// The corners of its fronts.
    fronts: Vec<[Vec3; 4]>,
    /// The corners of the fronts of controls with an error, such as an overlap.
    pub faulty_fronts: Vec<[Vec3; 4]>,
    /// The radius in the file, in millimetres.
    pub radius_mm: Option<f64>,
    /// Its distance follows from the radius of its arcs.
    pub is_at_radius: bool,
}

/// The pose of a board or target as written: of a target, its position in its space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WrittenPose {
    /// To the right, forward and up along the bearing, in millimetres.
    pub position_mm: [f64; 3],
    /// The bearing of the board or space, in degrees.
    pub bearing_deg: f64,
    /// The tilt of the board or space, in degrees.
    pub tilt_deg: f64,
}

/// Returns hands at rest that are also where they start: they are held where they are.
pub fn at_start(mut hands: Vec<HandPose>) -> Vec<HandPose> {
    let shared = hands.first().and_then(|it| it.fingertip(Finger::Index));
    for hand in &mut hands {
        hand.start = StartPlace {
            shared,
            ..StartPlace::from_pose(hand)
        };
    }
    hands
}

impl Plan {
    /// Places the boards and targets of the layout of an editor around hands. A board whose anchor no hand has is placed around
    /// the origin.
    pub fn new(editor: &LayoutEditor, layout: &Layout, hands: &[HandPose]) -> Self {
        let surfaces = layout.scene.surfaces().iter().zip(&layout.boards);
        let mut items: Vec<PlanItem> = surfaces
            .enumerate()
            .map(|(index, (surface, board))| {
                let poses = hands.iter();
                let pose = poses
                    .filter_map(|hand| surface.world_from_surface(hand))
                    .next();
                let pose = pose.unwrap_or(surface.anchor_from_surface());
                PlanItem {
                    part: Part::Board(index),
                    shape: PlanShape::Board(PlanBoard {
                        faulty_fronts: faulty_fronts(editor, surface, pose),
                        radius_mm: editor.number(Part::Board(index), "shape.radius_mm"),
                        is_at_radius: matches!(board.shape, BoardShape::Arc(_))
                            && editor
                                .number(Part::Board(index), "pose.forward_mm")
                                .is_none(),
                        ..PlanBoard::new(layout, board, surface, (index, pose))
                    }),
                    written: WrittenPose::of_board(editor, index),
                }
            })
            .collect();
        let overlaps = overlaps(layout, &items);
        for (index, targets) in layout.spaces.iter().enumerate() {
            let frame = &targets.space.frame;
            let pose = hands.iter().find_map(|hand| frame.world_from_frame(hand));
            let pose = pose.unwrap_or(frame.anchor_from_frame);
            let written = WrittenPose::of_targets(editor, index);
            let volumes = targets.space.volumes.iter().enumerate();
            items.extend(volumes.map(|(target, volume)| PlanItem {
                part: Part::SpaceTarget {
                    space: index,
                    index: target,
                },
                shape: PlanShape::Volume(pose, *volume),
                written: written.get(target).copied().unwrap_or_default(),
            }));
        }
        Self { items, overlaps }
    }

    /// Returns the item of a part.
    pub fn item(&self, part: Part) -> Option<&PlanItem> {
        self.items.iter().find(|item| item.part == part)
    }

    /// Returns the rectangle around those items for which `is_within` is true; `None` without any.
    pub fn bounds(&self, view: PlanView, is_within: impl Fn(Part) -> bool) -> Option<Bounds> {
        let items = self.items.iter().filter(|item| is_within(item.part));
        items.map(|item| item.bounds(view)).reduce(Bounds::union)
    }

    /// Returns the rectangle around all that is drawn of those items for which `is_within` is true; `None` without any.
    pub fn extent(&self, view: PlanView, is_within: impl Fn(Part) -> bool) -> Option<Bounds> {
        let items = self.items.iter().filter(|item| is_within(item.part));
        items.map(|item| item.extent(view)).reduce(Bounds::union)
    }

    /// Returns the item at a point; of several a raised one, or the one nearest to the eye. An item is hit up to `reach`
    /// millimetres beside it.
    pub fn item_at(
        &self,
        view: PlanView,
        (point, reach): (Vec2, f32),
        selected: &[Part],
    ) -> Option<&PlanItem> {
        let hit = self.items.iter();
        let hit = hit.filter(|item| item.contains(view, point, reach));
        let rank = |item: &PlanItem| {
            let is_on_top = is_raised(view, item.part, selected) && item.contains(view, point, 0.0);
            (is_on_top, item.nearness(view))
        };
        hit.max_by(|a, b| {
            let (first, second) = (rank(a), rank(b));
            first.0.cmp(&second.0).then(first.1.total_cmp(&second.1))
        })
    }

    /// Returns `true` if a board overlaps another one.
    pub fn is_overlapping(&self, part: Part) -> bool {
        let mut boards = self.overlaps.iter().flat_map(|it| it.boards);
        boards.any(|board| part == Part::Board(board))
    }
}

/// Returns `true` if an item is drawn above the others though it may be farther from the eye: a selected one, from above, where
/// it would be dragged below them.
pub fn is_raised(view: PlanView, part: Part, selected: &[Part]) -> bool {
    view == PlanView::Above && selected.contains(&part)
}

/// Returns the corners of the fronts of the controls of a board that have an error.
fn faulty_fronts(editor: &LayoutEditor, surface: &Surface, pose: Pose) -> Vec<[Vec3; 4]> {
    let is_faulty = |id| {
        editor
            .part_of(id)
            .is_some_and(|part| editor.is_faulty(part))
    };
    let faulty = surface.targets().filter(|(id, _)| is_faulty(*id));
    let fronts = faulty.map(|(_, target)| front_corners(target).map(|at| pose * at));
    fronts.collect()
}

fn overlaps(layout: &Layout, items: &[PlanItem]) -> Vec<PlanOverlap> {
    let found = layout.board_overlaps().into_iter();
    let place = |board: usize, target| {
        let item = items.get(board)?;
        let PlanShape::Board(plate) = &item.shape else {
            return None;
        };
        let (_, target) = layout.scene.target(target)?;
        Some(plate.pose * target.surface_from_target.translation)
    };
    let overlap = found.filter_map(|overlap| {
        let boards = [overlap.boards.0 - 1, overlap.boards.1 - 1];
        let first = place(boards[0], overlap.targets.0)?;
        let second = place(boards[1], overlap.targets.1)?;
        Some(PlanOverlap {
            boards,
            at: (first + second) / 2.0,
            depth_mm: overlap.depth * 1e3,
        })
    });
    overlap.collect()
}

impl PlanBoard {
    fn new(
        layout: &Layout,
        board: &Board,
        surface: &Surface,
        (index, pose): (usize, Pose),
    ) -> Self {
        let shapes = layout
            .faces(board)
            .map(|face| board::shape(face, board, 1e3));
        let bounds = shapes.map(|shape| shape.bounds()).reduce(Bounds::union);
        let empty = Bounds::between(Vec2::splat(-EMPTY_MM), Vec2::splat(EMPTY_MM));
        let rows = bounds.unwrap_or(empty);
        let fronts = surface.targets();
        let fronts = fronts.map(|(_, target)| front_corners(target).map(|at| pose * at));
        Self {
            index,
            pose,
            shape: board.shape,
            edges: edges(board.shape, rows).map(|edge| {
                let points = edge.into_iter();
                points.map(|at| pose * board.shape.bend(at)).collect()
            }),
            rows,
            fronts: fronts.collect(),
            faulty_fronts: Vec::new(),
            radius_mm: None,
            is_at_radius: false,
        }
    }

    /// Returns the outline of its plate.
    pub fn outline(&self) -> impl Iterator<Item = Vec3> {
        let [first, second] = &self.edges;
        first.iter().chain(second.iter().rev()).copied()
    }

    /// Returns the parts of its plate, from one end to the other.
    pub fn strips(&self) -> impl Iterator<Item = [Vec3; 4]> {
        let [first, second] = &self.edges;
        let pairs = first.windows(2).zip(second.windows(2));
        pairs.map(|(near, far)| [near[0], near[1], far[1], far[0]])
    }
}

/// Returns two opposite edges of a plate in row coordinates, in metres.
fn edges(shape: BoardShape, rows: Bounds) -> [Vec<Vec2>; 2] {
    let (low, high) = ((rows.min - MARGIN_MM) / 1e3, (rows.max + MARGIN_MM) / 1e3);
    let steps = match shape {
        BoardShape::Flat => 1,
        _ => CURVE_STEPS,
    };
    let part = |step: usize| step as f32 / steps as f32;
    let parts = (0..=steps).map(part);
    match shape {
        BoardShape::CurvedColumns(_) => [low.x, high.x].map(|x| {
            let along = parts.clone();
            along
                .map(|t| Vec2::new(x, low.y + (high.y - low.y) * t))
                .collect()
        }),
        _ => [low.y, high.y].map(|y| {
            let along = parts.clone();
            along
                .map(|t| Vec2::new(low.x + (high.x - low.x) * t, y))
                .collect()
        }),
    }
}

impl PlanItem {
    /// Returns the board, if it is one.
    pub fn board(&self) -> Option<&PlanBoard> {
        match &self.shape {
            PlanShape::Board(board) => Some(board),
            PlanShape::Volume(..) => None,
        }
    }

    /// Returns the rectangle around its fronts or its volume.
    pub fn bounds(&self, view: PlanView) -> Bounds {
        let around = |points: &mut dyn Iterator<Item = Vec3>| {
            let points = points.map(|point| view.flatten(point));
            let points = points.map(|point| Bounds::between(point, point));
            points.reduce(Bounds::union)
        };
        let bounds = match &self.shape {
            PlanShape::Board(board) if board.fronts.is_empty() => around(&mut board.outline()),
            PlanShape::Board(board) => around(&mut board.fronts.iter().flatten().copied()),
            PlanShape::Volume(pose, volume) => match volume.shape {
                VolumeShape::Ball(radius) => {
                    let center = view.flatten(*pose * volume.center);
                    let half = Vec2::splat(radius * 1e3);
                    Some(Bounds::between(center - half, center + half))
                }
                VolumeShape::Box(_) => around(&mut corners(pose, volume).into_iter()),
            },
        };
        let center = view.flatten(self.center());
        bounds.unwrap_or(Bounds::between(center, center))
    }

    /// Returns the rectangle around its fronts and its plate, which has corners without keys, or around its volume.
    pub fn extent(&self, view: PlanView) -> Bounds {
        let outline = self.board().into_iter().flat_map(PlanBoard::outline);
        let points = outline.map(|point| view.flatten(point));
        let points = points.map(|point| Bounds::between(point, point));
        points.fold(self.bounds(view), Bounds::union)
    }

    /// Returns its origin or center.
    pub fn center(&self) -> Vec3 {
        match &self.shape {
            PlanShape::Board(board) => board.pose.translation,
            PlanShape::Volume(pose, volume) => *pose * volume.center,
        }
    }

    /// Returns the nearness of its middle to the eye, in metres.
    pub fn nearness(&self, view: PlanView) -> f32 {
        let points: Vec<Vec3> = match &self.shape {
            PlanShape::Board(board) => board.outline().collect(),
            PlanShape::Volume(..) => vec![self.center()],
        };
        let nearness = points.iter().map(|point| view.nearness(*point));
        nearness.sum::<f32>() / points.len() as f32
    }

    /// Returns `true` if a point is on it, or up to `reach` millimetres beside it.
    pub fn contains(&self, view: PlanView, point: Vec2, reach: f32) -> bool {
        let is_on = |corners: [Vec3; 4]| {
            let corners = corners.map(|corner| view.flatten(corner));
            is_at(&corners, point, reach)
        };
        match &self.shape {
            PlanShape::Board(board) => {
                board.strips().any(is_on) || board.fronts.iter().copied().any(is_on)
            }
            PlanShape::Volume(pose, volume) => match volume.shape {
                VolumeShape::Ball(radius) => {
                    let distance = (view.flatten(*pose * volume.center) - point).length();
                    distance <= radius * 1e3 + reach
                }
                VolumeShape::Box(_) => {
                    let corners = corners(pose, volume).map(|corner| view.flatten(corner));
                    is_at(&convex_hull(corners.to_vec()), point, reach)
                }
            },
        }
    }
}

/// Returns the corners of a target in the world.
fn corners(pose: &Pose, volume: &Volume) -> [Vec3; 8] {
    volume_corners(volume).map(|corner| *pose * (volume.center + corner))
}

/// Returns `true` if a point is within a convex polygon, which may be a line, or up to `reach` beside its edges.
fn is_at(polygon: &[Vec2], point: Vec2, reach: f32) -> bool {
    let next = |index: usize| polygon[(index + 1) % polygon.len()];
    let sides = polygon
        .iter()
        .enumerate()
        .map(|(index, &from)| (from, next(index)));
    let turns = sides
        .clone()
        .map(|(from, to)| (to - from).perp_dot(point - from));
    let (low, high) = turns.fold((0.0_f32, 0.0_f32), |(low, high), turn| {
        (low.min(turn), high.max(turn))
    });
    let is_within = (low == 0.0) != (high == 0.0);
    is_within
        || sides.into_iter().any(|(from, to)| {
            let along = to - from;
            let t = (point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
            (from + along * t.clamp(0.0, 1.0) - point).length() <= reach
        })
}

impl WrittenPose {
    fn of_board(editor: &LayoutEditor, index: usize) -> Self {
        let part = Part::Board(index);
        let radius = || {
            let shape = editor.value(part, "shape")?;
            let is_arc = shape.starts_with("Arc");
            editor.number(part, "shape.radius_mm").filter(|_| is_arc)
        };
        let field = |name: &str| editor.number(part, name);
        let forward = field("pose.forward_mm").or_else(radius);
        Self {
            position_mm: [
                field("pose.right_mm").unwrap_or_default(),
                forward.unwrap_or_default(),
                field("pose.height_mm").unwrap_or_default(),
            ],
            ..Self::of_frame(editor, part)
        }
    }

    /// Returns the poses of the targets of a space.
    fn of_targets(editor: &LayoutEditor, space: usize) -> Vec<Self> {
        let frame = Self::of_frame(editor, Part::Space(space));
        let targets = editor.targets_in(space).into_iter();
        // No view has the axes of a tilted frame.
        let is_level = frame.tilt_deg == 0.0;
        let pose = |[x, y, z]: [f64; 3]| Self {
            position_mm: if is_level { [x, -z, y] } else { [0.0; 3] },
            ..frame
        };
        targets.map(pose).collect()
    }

    fn of_frame(editor: &LayoutEditor, part: Part) -> Self {
        let angle = |name: &str| editor.number(part, name).unwrap_or_default();
        Self {
            position_mm: [0.0; 3],
            bearing_deg: angle("pose.bearing_deg"),
            tilt_deg: angle("pose.tilt_deg"),
        }
    }
}

#[cfg(test)]
mod free_tests;
#[cfg(test)]
mod order_tests;
#[cfg(test)]
pub(crate) mod tests;
