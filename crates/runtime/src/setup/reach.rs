//! Reach: the targets that no hand of a setup can press, and what brings them within reach.

use std::fmt;

use parry3d::math::{Pose, Vec2};

use super::{LoadedSetup, reach_advice};
use crate::sim::{Miss, TypingHand, pressing_fingers};
use ademan_core::contact::TargetId;
use ademan_core::contact::surface::Scene;
use ademan_core::document::{Document, shipped_layouts};
use ademan_core::hand::{FingerSet, Side};
use ademan_core::layout::{Face, Handle, Layout, SpaceTargets, scale_boards};
use ademan_core::message::escape;
use ademan_core::pipeline::LayoutInstance;

/// The number of targets that a report names.
const MAX_NAMES: usize = 12;

/// The factors that are tried to bring all keys within reach: in steps that are easy to type, as far as keys stay usable.
const SCALES: [f32; 8] = [0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.6, 0.5];

/// The targets of a layout that no hand of a setup can press. It is displayed in one line.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachReport<'a> {
    /// The names, with the distance beyond the reach in metres; infinity for a target without a position.
    pub targets: Vec<(&'a str, f64)>,
    /// The step that brings them within reach, or the reason why none does.
    pub advice: String,
}

/// A target on a board that no hand reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetOutOfReach {
    /// The target.
    pub target: TargetId,
    miss: Miss,
}

impl TargetOutOfReach {
    /// Returns the distance beyond the reach in metres; infinity for a target without a position.
    pub fn metres(&self) -> f64 {
        self.miss.distance
    }

    /// Returns the direction in which the target comes within reach, such as `nearer`.
    pub fn step(&self) -> &'static str {
        reach_advice::step(&self.miss)
    }

    /// Returns the step that brings most of several targets within reach.
    pub fn common_step(targets: &[Self]) -> String {
        reach_advice::by_direction(targets.iter().map(|target| &target.miss), false)
    }
}

/// The hands of a setup, to find targets out of their reach without the setup.
#[derive(Clone, Debug)]
pub struct HandReach(Hands);

/// The hands of a setup, and the mirror image of a single one, which uses only boards that are reserved for its side.
#[derive(Clone, Debug)]
pub(super) struct Hands {
    /// The fingers that press; empty if the layout decides.
    pub(super) fingers: FingerSet,
    pub(super) own: Vec<TypingHand>,
    pub(super) mirrored: Option<TypingHand>,
}

impl Hands {
    /// Returns the hands that may use a board.
    fn of_board(&self, side: Option<Side>) -> impl Iterator<Item = &TypingHand> {
        let mirrored = self.mirrored.iter();
        let mirrored = mirrored.filter(move |hand| side == Some(hand.side()));
        self.own.iter().chain(mirrored)
    }
}

impl HandReach {
    /// Returns the targets on boards out of reach, nearest first. Follows the rules of [`LoadedSetup::reach_report`]. Takes
    /// about 0.1 ms for each target.
    pub fn on_boards(&self, layout: &Layout) -> Vec<TargetOutOfReach> {
        let found = on_boards_out_of_reach(layout, &layout.scene, &self.0);
        let mut found: Vec<_> = found
            .map(|(face, miss)| TargetOutOfReach {
                target: face.target,
                miss,
            })
            .collect();
        found.sort_by(|a, b| a.metres().total_cmp(&b.metres()));
        found
    }
}

impl LoadedSetup {
    /// Returns the hands, to find targets out of their reach.
    pub fn hand_reach(&self) -> HandReach {
        HandReach(self.reaching_hands())
    }

    /// Returns the targets of the first layout out of reach; see [`reach_report`](Self::reach_report).
    pub fn out_of_reach(&self) -> Vec<(&str, f64)> {
        let missed = targets_out_of_reach(&self.layout, &self.reaching_hands());
        let missed = missed.into_iter();
        missed.map(|(name, miss)| (name, miss.distance)).collect()
    }

    /// Returns the report about a layout of the setup, or `None` if its hands reach everything.
    ///
    /// Tests the finger that the layout names for a target, or the person's fingers, or else the index finger, and any finger on a
    /// board that moves with the wrist, within the range of the sensors of each hand. Boards that are reserved for a hand that the setup
    /// lacks are tested with the mirror image of the other one. Includes both ends of the track of a slider or lever, and the
    /// centers of targets in space that a fingertip selects. Excludes keys of chords, because each has a finger of its own, and
    /// keys that are pressed by bending.
    pub fn reach_report<'a>(&self, layout: &'a Layout) -> Option<ReachReport<'a>> {
        let hands = self.reaching_hands();
        let mut missed = targets_out_of_reach(layout, &hands);
        if missed.is_empty() {
            return None;
        }
        missed.sort_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
        let advice = self.reach_advice(layout, &hands, &missed);
        let targets = missed.into_iter();
        let targets = targets.map(|(name, miss)| (name, miss.distance)).collect();
        Some(ReachReport { targets, advice })
    }

    /// Returns the step that brings targets within reach.
    fn reach_advice(&self, layout: &Layout, hands: &Hands, missed: &[(&str, Miss)]) -> String {
        if self.measures_no_arm() {
            return reach_advice::without_arm(&self.layouts_within_reach(hands));
        }
        if let (Some(mirrored), [hand]) = (&hands.mirrored, &*hands.own) {
            let side = hand.side();
            let hands = Hands {
                fingers: hands.fingers,
                own: vec![mirrored.clone()],
                mirrored: Some(hand.clone()),
            };
            if is_within_reach(layout, &hands) {
                return reach_advice::mirror(&layout.file, side);
            }
        }
        let can_move = spaces_out_of_reach(layout, hands).is_empty();
        let remedy = can_move.then(|| remedy(layout, hands)).flatten();
        let fits = remedy.as_deref() == Some(RECENTER);
        let step = reach_advice::by_direction(missed.iter().map(|(_, miss)| miss), fits);
        match remedy {
            Some(remedy) => format!("{step}; try {remedy}"),
            None => step,
        }
    }

    /// Returns the names of the shipped layouts that the hands can use without an arm.
    fn layouts_within_reach(&self, hands: &Hands) -> Vec<&'static str> {
        let fit = self.layout.fit;
        let load = |name| Layout::for_hands(Document::shipped(name).ok()?, fit).ok();
        let is_usable = |layout: &Layout| {
            let has_targets = !layout.scene.surfaces().is_empty() || !layout.triggers.is_empty();
            has_targets
                && layout.pointer.is_none()
                && !layout.uses_body()
                && is_within_reach(layout, hands)
        };
        shipped_layouts()
            .filter(|&name| load(name).is_some_and(|layout| is_usable(&layout)))
            .collect()
    }

    fn reaching_hands(&self) -> Hands {
        let side = self.arm.side();
        let own = |own_side| self.typing_hand(own_side);
        match self.other_hand {
            Some(_) => Hands {
                fingers: self.person.fingers,
                own: vec![own(side), own(side.opposite())],
                mirrored: None,
            },
            None => Hands {
                fingers: self.person.fingers,
                own: vec![own(side)],
                mirrored: Some(own(side.opposite())),
            },
        }
    }

    /// Returns the simulated hand of a side. Without a hand on that side, it is the mirrored other hand; without a glove, or
    /// with a source of its own for the arm, every joint is measured.
    pub(super) fn typing_hand(&self, side: Side) -> TypingHand {
        let other = self.other_hand.as_ref();
        let other = other.filter(|other| other.arm.side() == side);
        let (arm, glove, arm_source) = match other {
            Some(other) => (other.arm.clone(), &other.glove, self.other_arm_source()),
            None => (
                self.arm.clone().for_side(side),
                &self.glove,
                self.setup.arm_source.as_ref(),
            ),
        };
        match glove {
            Some(glove) if arm_source.is_none() => TypingHand::new(&arm, &glove.map),
            _ => TypingHand::without_glove(&arm),
        }
        .with_limits(&self.person.limits)
    }
}

fn targets_out_of_reach<'a>(layout: &'a Layout, hands: &Hands) -> Vec<(&'a str, Miss)> {
    let on_boards = on_boards_out_of_reach(layout, &layout.scene, hands);
    let on_boards = on_boards.map(|(face, miss)| (face.name.as_str(), miss));
    on_boards
        .chain(spaces_out_of_reach(layout, hands))
        .collect()
}

fn is_within_reach(layout: &Layout, hands: &Hands) -> bool {
    let mut on_boards = on_boards_out_of_reach(layout, &layout.scene, hands);
    on_boards.next().is_none() && spaces_out_of_reach(layout, hands).is_empty()
}

/// Iterates over the targets on boards out of reach, with the boards at the poses of `scene`.
fn on_boards_out_of_reach<'a, 'b>(
    layout: &'a Layout,
    scene: &'b Scene,
    hands: &'b Hands,
) -> impl Iterator<Item = (&'a Face, Miss)> + use<'a, 'b> {
    let keys = layout.keys.iter().map(|key| &key.face);
    let is_touched = |target| {
        let found = scene.target(target);
        found.is_none_or(|(surface, _)| !surface.is_bent()) && !layout.is_chord_key(target)
    };
    let keys = keys.filter(move |face| is_touched(face.target));
    let keys = keys.map(|face| (face, Vec2::ZERO));
    let controls = layout.controls.iter().flat_map(|control| {
        let half = match control.kind.handle() {
            Handle::Line { half_length } => Vec2::X * half_length,
            Handle::Pad { half } => half,
            _ => Vec2::ZERO,
        };
        control.faces.iter().map(move |face| (face, half))
    });
    keys.chain(controls)
        .filter_map(move |(face, half): (&'a Face, Vec2)| {
            let [low, high] = [-half, half];
            let corners = [
                low,
                high,
                Vec2::new(low.x, high.y),
                Vec2::new(high.x, low.y),
            ];
            // The ends of a track, or the middle, are the first corners.
            let count = match half.to_array() {
                [0.0, 0.0] => 1,
                [_, 0.0] => 2,
                _ => corners.len(),
            };
            let corners = corners[..count].iter();
            let misses = corners.filter_map(|at| miss(hands, scene, face.target, *at));
            Some((face, misses.reduce(farther)?))
        })
}

/// Returns the way of the nearer hand to a position on a target out of reach, or `None` if one reaches it.
fn miss(hands: &Hands, scene: &Scene, target: TargetId, position: Vec2) -> Option<Miss> {
    let side = scene.target(target).and_then(|(surface, _)| surface.side());
    let fingers = pressing_fingers(scene, target, hands.fingers);
    let mut nearest: Option<Miss> = None;
    for hand in hands.of_board(side) {
        let miss = hand.miss_of_fingers(scene, target, position, fingers)?;
        nearest = Some(nearest.map_or(miss, |other| nearer(other, miss)));
    }
    nearest
}

fn nearer(one: Miss, other: Miss) -> Miss {
    if other.distance < one.distance {
        other
    } else {
        one
    }
}

fn farther(one: Miss, other: Miss) -> Miss {
    if other.distance > one.distance {
        other
    } else {
        one
    }
}

/// Returns the targets in space out of reach. A pointer reaches all that it selects.
fn spaces_out_of_reach<'a>(layout: &'a Layout, hands: &Hands) -> Vec<(&'a str, Miss)> {
    let mut found = Vec::new();
    if layout.pointer.is_some() {
        return found;
    }
    for SpaceTargets { names, space } in &layout.spaces {
        for (name, volume) in names.iter().zip(space.volumes.iter()) {
            let miss = |hand: &TypingHand| {
                let pose = hand.pose(&hand.rest_values());
                match space.frame.world_from_frame(&pose) {
                    Some(world_from_frame) => hand.miss(world_from_frame * volume.center),
                    None => Some(Miss::NO_POSITION),
                }
            };
            let misses: Option<Vec<Miss>> = hands.own.iter().map(miss).collect();
            let nearest = misses.and_then(|misses| misses.into_iter().reduce(nearer));
            found.extend(nearest.map(|missed| (name.as_str(), missed)));
        }
    }
    found
}

/// The command that brings the boards below the hand, if no scale is needed.
const RECENTER: &str = "`ademan ctl recenter`";

/// Returns the commands that bring all targets on boards within reach: `recenter`, a `scale`, or both.
fn remedy(layout: &Layout, hands: &Hands) -> Option<String> {
    let is_reached = |candidate: &Layout, scene: &Scene| {
        on_boards_out_of_reach(candidate, scene, hands)
            .next()
            .is_none()
    };
    if is_reached(layout, &recentered(layout, hands)) {
        return Some(RECENTER.into());
    }
    let document = Document::new(layout.file.as_str(), layout.text.as_str());
    let scaled = |factor: f32| {
        let text = scale_boards(&document, factor).ok()?;
        Some((factor, layout.with_text(&text).ok()?))
    };
    let candidates: Vec<(f32, Layout)> = SCALES.into_iter().filter_map(scaled).collect();
    let is_enough =
        |(_, scaled_layout): &&(f32, Layout)| is_reached(scaled_layout, &scaled_layout.scene);
    if let Some((factor, _)) = candidates.iter().find(is_enough) {
        return Some(format!("`ademan ctl scale {factor}`"));
    }
    let is_enough_recentered = |(_, scaled_layout): &&(f32, Layout)| {
        is_reached(scaled_layout, &recentered(scaled_layout, hands))
    };
    let (factor, _) = candidates.iter().find(is_enough_recentered)?;
    Some(format!(
        "`ademan ctl scale {factor}`, then `ademan ctl recenter`"
    ))
}

/// Returns the boards after `recenter` with each hand in the typing posture.
fn recentered(layout: &Layout, hands: &Hands) -> Scene {
    let mut scene = layout.scene.clone();
    for hand in hands.own.iter().chain(&hands.mirrored) {
        let pose = hand.pose(&hand.rest_values());
        let Ok(offset) = LayoutInstance::from_layout(layout).recenter_offset(&pose) else {
            continue;
        };
        for (index, surface) in layout.scene.surfaces().iter().enumerate() {
            // Both hands may use a board without a side: the first one keeps it.
            let is_moved =
                scene.surfaces()[index].anchor_from_surface() != surface.anchor_from_surface();
            if surface.world_from_surface(&pose).is_some() && !is_moved {
                let old = surface.anchor_from_surface();
                let moved = Pose::from_parts(old.translation + offset, old.rotation);
                scene.set_surface_pose(index, moved);
            }
        }
    }
    scene
}

impl fmt::Display for ReachReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.targets.len();
        let noun = if count == 1 { "control" } else { "controls" };
        let shown = |(name, metres): &(&str, f64)| {
            let name = escape(name);
            if metres.is_finite() {
                format!("`{name}` ({:.0} mm)", metres * 1e3)
            } else {
                format!("`{name}` (no position)")
            }
        };
        let targets: Vec<String> = self.targets.iter().take(MAX_NAMES).map(shown).collect();
        let targets = targets.join(", ");
        write!(f, "{count} {noun} out of reach, nearest first: {targets}")?;
        if count > MAX_NAMES {
            write!(f, ", and {} more", count - MAX_NAMES)?;
        }
        write!(f, "; {}", self.advice)
    }
}
