//! Reach: the targets that no hand of a setup can press, and commands that bring them within reach.

use std::fmt;

use parry3d::math::{Pose, Vec2};

use super::{LoadedSetup, layout_instance};
use crate::contact::TargetId;
use crate::contact::surface::Scene;
use crate::document::Document;
use crate::hand::Side;
use crate::layout::{ControlKind, Face, Layout, SpaceTargets, scale_boards};
use crate::message::escape;
use crate::sim::{REACH_TOLERANCE, TypingHand};

/// The number of targets that a report names.
const MAX_NAMES: usize = 12;

/// The factors that are tried to bring all keys within reach: in steps that are easy to type, as far as keys stay usable.
const SCALES: [f32; 8] = [0.95, 0.9, 0.85, 0.8, 0.75, 0.7, 0.6, 0.5];

/// The targets of a layout that no hand of a setup can press. It is displayed in one line.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachReport<'a> {
    /// The names, with the distance beyond the reach in metres; infinity for a target without a position.
    pub targets: Vec<(&'a str, f64)>,
    /// The commands that bring them within reach, if any do.
    pub remedy: Option<String>,
}

/// The hands of a setup, to find targets out of their reach without the setup.
#[derive(Clone, Debug)]
pub struct HandReach([TypingHand; 2]);

impl HandReach {
    /// Returns the targets on boards out of reach, with the distance beyond it in metres, nearest first. The rules are those of
    /// [`LoadedSetup::reach_report`]. Takes about 0.1 ms for each target.
    pub fn on_boards(&self, layout: &Layout) -> Vec<(TargetId, f64)> {
        let found = on_boards_out_of_reach(layout, &layout.scene, &self.0);
        let mut found: Vec<_> = found
            .map(|(face, distance)| (face.target, distance))
            .collect();
        found.sort_by(|a, b| a.1.total_cmp(&b.1));
        found
    }
}

impl LoadedSetup {
    /// Returns the hands, to find targets out of their reach.
    pub fn hand_reach(&self) -> HandReach {
        HandReach(self.both_hands())
    }

    /// Returns the targets of the first layout out of reach; see [`reach_report`](Self::reach_report).
    pub fn out_of_reach(&self) -> Vec<(&str, f64)> {
        let hands = self.both_hands();
        self.targets_out_of_reach(&self.layout, &hands)
    }

    /// Returns the report about a layout of the setup, or `None` if its hands reach everything.
    ///
    /// Tests the index finger of each hand within the range of its sensors. A hand that the setup lacks is the mirror image of
    /// the other one. Includes both ends of the track of a slider or lever, and the centers of targets in space that a
    /// fingertip selects. Excludes keys of chords, because each has a finger of its own, and keys that are pressed by bending.
    pub fn reach_report<'a>(&self, layout: &'a Layout) -> Option<ReachReport<'a>> {
        let hands = self.both_hands();
        let mut targets = self.targets_out_of_reach(layout, &hands);
        if targets.is_empty() {
            return None;
        }
        targets.sort_by(|a, b| a.1.total_cmp(&b.1));
        let can_move = spaces_out_of_reach(layout, &hands).is_empty();
        let remedy = can_move.then(|| remedy(layout, &hands)).flatten();
        Some(ReachReport { targets, remedy })
    }

    fn targets_out_of_reach<'a>(
        &self,
        layout: &'a Layout,
        hands: &[TypingHand],
    ) -> Vec<(&'a str, f64)> {
        let on_boards = on_boards_out_of_reach(layout, &layout.scene, hands);
        let on_boards = on_boards.map(|(face, distance)| (face.name.as_str(), distance));
        let in_space = spaces_out_of_reach(layout, hands);
        on_boards.chain(in_space).collect()
    }

    fn both_hands(&self) -> [TypingHand; 2] {
        let side = self.arm.side();
        [side, side.opposite()].map(|side| self.typing_hand(side))
    }

    /// Returns the simulated hand of a side. Without a hand on that side, it is the mirrored other hand; without a glove,
    /// every joint is measured.
    pub(super) fn typing_hand(&self, side: Side) -> TypingHand {
        let other = self.other_hand.as_ref();
        let other = other.filter(|other| other.arm.side() == side);
        let (arm, glove) = match other {
            Some(other) => (other.arm.clone(), &other.glove),
            None => (self.arm.clone().for_side(side), &self.glove),
        };
        match glove {
            Some(glove) => TypingHand::new(&arm, &glove.map),
            None => TypingHand::without_glove(&arm),
        }
    }
}

/// Iterates over the targets on boards out of reach, with the boards at the poses of `scene`.
fn on_boards_out_of_reach<'a, 'b>(
    layout: &'a Layout,
    scene: &'b Scene,
    hands: &'b [TypingHand],
) -> impl Iterator<Item = (&'a Face, f64)> + use<'a, 'b> {
    let keys = layout.keys.iter().map(|key| &key.face);
    let is_touched = |target| {
        let found = scene.target(target);
        found.is_none_or(|(surface, _)| !surface.is_bent()) && !layout.is_chord_key(target)
    };
    let keys = keys.filter(move |face| is_touched(face.target));
    let keys = keys.map(|face| (face, 0.0));
    let controls = layout.controls.iter().flat_map(|control| {
        let half_length = match &control.kind {
            ControlKind::Slider(slider) => slider.half_length,
            _ => 0.0,
        };
        control.faces.iter().map(move |face| (face, half_length))
    });
    keys.chain(controls)
        .filter_map(move |(face, half_length): (&'a Face, f32)| {
            let positions: &[f32] = match half_length > 0.0 {
                true => &[-half_length, half_length],
                false => &[0.0],
            };
            let distances = positions
                .iter()
                .filter_map(|x| distance_beyond(hands, scene, face.target, Vec2::X * *x));
            Some((face, distances.reduce(f64::max)?))
        })
}

/// Returns the distance of a position on a target beyond the reach of the nearer hand, in metres, or `None` if one reaches it.
fn distance_beyond(
    hands: &[TypingHand],
    scene: &Scene,
    target: TargetId,
    position: Vec2,
) -> Option<f64> {
    let mut nearest = f64::INFINITY;
    for hand in hands {
        match hand.tap_path_at(scene, target, position) {
            Ok(_) => return None,
            Err(distance) => nearest = nearest.min(distance),
        }
    }
    Some(nearest)
}

/// Returns the targets in space out of reach. A pointer reaches all that it selects.
fn spaces_out_of_reach<'a>(layout: &'a Layout, hands: &[TypingHand]) -> Vec<(&'a str, f64)> {
    let mut found = Vec::new();
    if layout.pointer.is_some() {
        return found;
    }
    for SpaceTargets { names, space } in &layout.spaces {
        for (name, volume) in names.iter().zip(space.volumes.iter()) {
            let distances = hands.iter().map(|hand| {
                let pose = hand.pose(&hand.rest_values());
                let center = space.frame.world_from_frame(&pose)? * volume.center;
                Some(hand.reach(center, &mut hand.rest_values(), &[]))
            });
            let nearest = distances.flatten().fold(f64::INFINITY, f64::min);
            if nearest > REACH_TOLERANCE {
                found.push((name.as_str(), nearest));
            }
        }
    }
    found
}

/// Returns the commands that bring all targets on boards within reach: `recenter`, a `scale`, or both.
fn remedy(layout: &Layout, hands: &[TypingHand]) -> Option<String> {
    let is_reached = |layout: &Layout, scene: &Scene| {
        on_boards_out_of_reach(layout, scene, hands)
            .next()
            .is_none()
    };
    if is_reached(layout, &recentered(layout, hands)) {
        return Some("`ademan ctl recenter`".into());
    }
    let document = Document::new(layout.file.as_str(), layout.text.as_str());
    let scaled = |factor: f32| {
        let text = scale_boards(&document, factor).ok()?;
        Some((factor, layout.with_text(&text).ok()?))
    };
    let candidates: Vec<(f32, Layout)> = SCALES.into_iter().filter_map(scaled).collect();
    let is_enough = |(_, layout): &&(f32, Layout)| is_reached(layout, &layout.scene);
    if let Some((factor, _)) = candidates.iter().find(is_enough) {
        return Some(format!("`ademan ctl scale {factor}`"));
    }
    let is_enough = |(_, layout): &&(f32, Layout)| is_reached(layout, &recentered(layout, hands));
    let (factor, _) = candidates.iter().find(is_enough)?;
    Some(format!(
        "`ademan ctl scale {factor}`, then `ademan ctl recenter`"
    ))
}

/// Returns the boards after `recenter` with each hand in the typing posture.
fn recentered(layout: &Layout, hands: &[TypingHand]) -> Scene {
    let mut scene = layout.scene.clone();
    for hand in hands {
        let pose = hand.pose(&hand.rest_values());
        let Ok(offset) = layout_instance(layout).recenter_offset(&pose) else {
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
        let noun = match count {
            1 => "control",
            _ => "controls",
        };
        write!(f, "{count} {noun} out of reach, nearest first: ")?;
        for (index, (name, metres)) in self.targets.iter().take(MAX_NAMES).enumerate() {
            let separator = match index {
                0 => "",
                _ => ", ",
            };
            write!(f, "{separator}`{}`", escape(name))?;
            match metres.is_finite() {
                true => write!(f, " ({:.0} mm)", metres * 1e3)?,
                false => write!(f, " (no position)")?,
            }
        }
        if count > MAX_NAMES {
            write!(f, ", and {} more", count - MAX_NAMES)?;
        }
        match &self.remedy {
            Some(remedy) => write!(f, "; try {remedy}"),
            None => write!(f, "; move the board nearer or make it smaller"),
        }
    }
}
