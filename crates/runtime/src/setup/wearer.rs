//! The hands of a setup for a drawing of its layout: their poses at rest, and what they reach.

use std::collections::BTreeMap;

use parry3d::math::{Pose, Vec2, Vec3};

use super::LoadedSetup;
use crate::sim::{TypingHand, pressing_fingers};
use ademan_core::contact::TargetId;
use ademan_core::contact::surface::{Surface, Target};
use ademan_core::hand::{FingerSet, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::layout::{BoardShape, Layout, ReachArea, Wearer};

/// The distance of the area beyond the outermost targets of a board, in metres: inside the panel of the drawing.
const MARGIN: f32 = 0.004;

/// Half the distance between the elbows of two hands, in metres: as when a person types. No source measures it.
const HALF_DISTANCE: f32 = 0.2;

/// The largest number of samples along each side of a board.
const MAX_SAMPLES: f32 = 48.0;

/// The distance between two samples on a small board, in metres.
const MIN_STEP: f32 = 0.004;

/// The number of bisections between two samples, which leave a sixteenth of their distance.
const BISECTIONS: usize = 4;

impl LoadedSetup {
    /// Returns the hands at rest with the part of each board that their fingers reach, and the targets out of reach. It tests the
    /// fingers of [`reach_report`](Self::reach_report), and all that the layout names on the board.
    ///
    /// A cylinder has no such part, because its targets are not in one plane, and neither has a board whose keys are pressed by
    /// bending.
    pub fn wearer(&self) -> Wearer {
        let first = self.arm.side();
        let surfaces = self.layout.scene.surfaces();
        let hands = self.hands_of(&self.layout);
        let hand_of = |surface: &Surface| {
            let side = surface.side().unwrap_or(first);
            let mut hands = hands.iter();
            hands
                .find(|(other, _)| *other == side)
                .map(|(_, hand)| hand)
        };
        let areas = surfaces.iter().enumerate().filter_map(|(board, surface)| {
            let outlines = Samples::new(self, board, hand_of(surface)?)?.outlines();
            Some(ReachArea { board, outlines })
        });
        let out_of_reach = self.out_of_reach().into_iter();
        Wearer {
            areas: areas.collect(),
            out_of_reach: out_of_reach
                .map(|(name, metres)| (name.to_owned(), metres))
                .collect(),
            faults: Vec::new(),
            hands: poses(&hands),
        }
    }

    /// Returns the hands that use a layout, at rest: the first hand of the setup, and the other one if a board is reserved for it.
    pub fn hands_at_rest(&self, layout: &Layout) -> Vec<HandPose> {
        poses(&self.hands_of(layout))
    }

    fn hands_of(&self, layout: &Layout) -> Vec<(Side, TypingHand)> {
        let first = self.arm.side();
        let sides = [first, first.opposite()].into_iter();
        let used = sides.filter(|side| *side == first || layout.has_board_for(*side));
        used.map(|side| (side, self.typing_hand(side))).collect()
    }
}

/// Returns the poses at rest, two hands apart.
fn poses(hands: &[(Side, TypingHand)]) -> Vec<HandPose> {
    let at_rest = |(side, hand): &(Side, TypingHand)| {
        let pose = hand.pose(&hand.rest_values());
        let x = match side {
            _ if hands.len() < 2 => 0.0,
            Side::Left => -HALF_DISTANCE,
            Side::Right => HALF_DISTANCE,
        };
        let mut moved = pose;
        moved.other_wrist = pose.other_wrist.map(|wrist| wrist + Vec3::X * x);
        for (joint, world_from_joint) in pose.known() {
            let position = world_from_joint.translation + Vec3::X * x;
            moved.set(joint, Pose::from_parts(position, world_from_joint.rotation));
        }
        moved
    };
    hands.iter().map(at_rest).collect()
}

/// A grid of points on a board, each within or out of reach. The points at the edge count as out of reach.
struct Samples<'a> {
    setup: &'a LoadedSetup,
    hand: &'a TypingHand,
    /// A target in the plane of the board, from which positions are measured.
    target: (TargetId, &'a Target),
    /// The fingers that press targets of the board.
    fingers: FingerSet,
    corner: Vec2,
    step: Vec2,
    columns: usize,
    is_within: Vec<bool>,
}

/// A pair of adjacent samples, the one within reach first: their indices.
type Edge = (usize, usize);

impl<'a> Samples<'a> {
    /// Returns `None` for a board that is pressed by bending, for a cylinder, and for a board without a target in its plane.
    fn new(setup: &'a LoadedSetup, board: usize, hand: &'a TypingHand) -> Option<Self> {
        let surface = setup.layout.scene.surfaces().get(board)?;
        let board = setup.layout.boards.get(board)?;
        let is_flat = matches!(board.shape, BoardShape::Flat | BoardShape::Arc(_));
        if surface.is_bent() || !is_flat {
            return None;
        }
        let target = surface.targets().find(|(_, target)| is_in_plane(target))?;
        let scene = &setup.layout.scene;
        let pressing = surface.targets();
        let pressing = pressing.map(|(id, _)| pressing_fingers(scene, id, setup.person.fingers));
        let fingers = pressing.fold(FingerSet::NONE, FingerSet::union);
        let (min, max) = setup.layout.extent(board);
        let (min, max) = (min - MARGIN, max + MARGIN);
        let steps = ((max - min) / MIN_STEP)
            .ceil()
            .clamp(Vec2::ONE, Vec2::splat(MAX_SAMPLES));
        let step = (max - min) / steps;
        let counts = steps + 3.0;
        let (columns, rows) = (counts.x as usize, counts.y as usize);
        let mut samples = Self {
            setup,
            hand,
            target,
            fingers,
            corner: min - step,
            step,
            columns,
            is_within: vec![false; columns * rows],
        };
        for row in 1..rows - 1 {
            for column in 1..columns - 1 {
                let index = row * columns + column;
                samples.is_within[index] = samples.is_reached(samples.position(index));
            }
        }
        Some(samples)
    }

    fn position(&self, index: usize) -> Vec2 {
        let (column, row) = (index % self.columns, index / self.columns);
        self.corner + Vec2::new(column as f32, row as f32) * self.step
    }

    fn is_reached(&self, point: Vec2) -> bool {
        let (id, target) = self.target;
        let offset = target
            .surface_from_target
            .inverse_transform_point(point.extend(0.0));
        let scene = &self.setup.layout.scene;
        let offset = offset.truncate();
        let miss = self.hand.miss_of_fingers(scene, id, offset, self.fingers);
        miss.is_none()
    }

    /// Returns the outlines of the area within reach: marching squares, with each crossing found by bisection.
    fn outlines(&self) -> Vec<Vec<Vec2>> {
        let mut next = self.segments();
        let mut outlines = Vec::new();
        while let Some((&start, _)) = next.first_key_value() {
            let mut outline = Vec::new();
            let mut edge = start;
            while let Some(following) = next.remove(&edge) {
                outline.push(self.crossing(edge));
                edge = following;
            }
            outlines.push(outline);
        }
        outlines
    }

    /// Returns the edge that follows each edge along an outline.
    fn segments(&self) -> BTreeMap<Edge, Edge> {
        let rows = self.is_within.len() / self.columns;
        let mut next = BTreeMap::new();
        for row in 0..rows - 1 {
            for column in 0..self.columns - 1 {
                let index = row * self.columns + column;
                let square = [
                    index,
                    index + 1,
                    index + 1 + self.columns,
                    index + self.columns,
                ];
                self.add_segments(square, &mut next);
            }
        }
        next
    }

    /// Adds the segments in a square of four samples: one from each side at which the area begins, going around, to the next
    /// side at which it ends.
    fn add_segments(&self, square: [usize; 4], next: &mut BTreeMap<Edge, Edge>) {
        for side in 0..4 {
            let (from, to) = (square[side], square[(side + 1) % 4]);
            if self.is_within[from] || !self.is_within[to] {
                continue;
            }
            let ends = (1..4).map(|ahead| {
                let at = (side + ahead) % 4;
                (square[at], square[(at + 1) % 4])
            });
            let mut ends = ends.filter(|(a, b)| self.is_within[*a] && !self.is_within[*b]);
            if let Some((within, beyond)) = ends.next() {
                next.insert((to, from), (within, beyond));
            }
        }
    }

    fn crossing(&self, (within, beyond): Edge) -> Vec2 {
        let (mut reached, mut unreached) = (self.position(within), self.position(beyond));
        for _ in 0..BISECTIONS {
            let middle = (reached + unreached) / 2.0;
            if self.is_inside(middle) && self.is_reached(middle) {
                reached = middle
            } else {
                unreached = middle
            }
        }
        reached
    }

    /// Returns `true` for a point that is not at the edge of the grid.
    fn is_inside(&self, point: Vec2) -> bool {
        let rows = self.is_within.len() / self.columns;
        let counts = Vec2::new(self.columns as f32, rows as f32);
        let cell = (point - self.corner) / self.step;
        cell.min_element() >= 1.0 && (counts - 2.0 - cell).min_element() >= 0.0
    }
}

fn is_in_plane(target: &Target) -> bool {
    let pose = target.surface_from_target;
    pose.translation.z == 0.0 && (pose.rotation * Vec3::Z - Vec3::Z).length() < 1e-4
}
