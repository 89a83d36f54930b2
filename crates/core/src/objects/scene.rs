//! The state of the session that a viewer draws beside the hand.

use arrayvec::ArrayVec;
use parry3d::math::Pose;
use serde::Serialize;

use super::layout::numbers;
use crate::contact::TargetId;
use crate::device::pressed_keys::PressedKeys;
use crate::device::{EventKind, KeyCode, OutputEvent};
use crate::hand::FINGERS_OF_BOTH_HANDS;
use crate::pipeline::{Pipeline, PipelineState};
use crate::snapshot::StepView;
use crate::time::Timestamp;

/// Most boards whose positions are shared. Further ones stay where the layout has them.
const MAX_BOARDS: usize = 16;

/// The state of a session after a step.
#[derive(Clone, Debug, Default)]
pub struct SceneState {
    time: Timestamp,
    state: PipelineState,
    /// The profile whose boards they are.
    profile: usize,
    /// The poses of the boards in the world; `None` for one that follows a hand that was not seen.
    boards: ArrayVec<Option<Pose>, MAX_BOARDS>,
    /// The targets that fingertips press.
    pressed: ArrayVec<TargetId, FINGERS_OF_BOTH_HANDS>,
    keys: PressedKeys,
}

impl SceneState {
    /// Follows the keys of a step. Every step has to pass, also while there is no client.
    pub fn follow_keys(&mut self, step: &StepView) {
        step.events
            .iter()
            .for_each(|event| self.follow_event(event));
    }

    /// Follows the key of an event.
    pub fn follow_event(&mut self, event: &OutputEvent) {
        match event.kind {
            EventKind::KeyDown(key) => _ = self.keys.press(key),
            EventKind::KeyUp(key) => _ = self.keys.release(key),
            _ => {}
        }
    }

    /// Reads the rest of the state from the pipeline after a step.
    pub fn update(&mut self, step: &StepView, pipeline: &Pipeline) {
        if let Some(reading) = step.reading {
            self.time = reading.time;
        }
        self.state = step.state;
        let profile = pipeline.active_profile();
        if std::mem::replace(&mut self.profile, profile) != profile {
            self.boards.clear();
        }
        let active = pipeline.layout();
        let surfaces = active.scene().surfaces();
        self.boards.truncate(surfaces.len());
        for (index, surface) in surfaces.iter().take(MAX_BOARDS).enumerate() {
            let pose = step.pose;
            let pose = pose.and_then(|pose| surface.world_from_surface(pose));
            match self.boards.get_mut(index) {
                Some(board) => *board = pose.or(*board),
                None => self.boards.push(pose),
            }
        }
        let pressed = active.pressed_targets();
        self.pressed = pressed.take(FINGERS_OF_BOTH_HANDS).collect();
    }

    /// Appends the object with the line end.
    pub fn write(&self, line: &mut Vec<u8>) {
        let mut keys: Vec<KeyCode> = self.keys.release_order().collect();
        keys.reverse();
        let object = SceneObject {
            kind: "scene",
            time_us: self.time,
            state: self.state,
            boards: self
                .boards
                .iter()
                .map(|it| it.as_ref().map(numbers))
                .collect(),
            pressed: &self.pressed,
            keys,
        };
        serde_json::to_writer(&mut *line, &object).expect("a vector accepts all bytes");
        line.push(b'\n');
    }
}

#[derive(Serialize)]
struct SceneObject<'a> {
    kind: &'static str,
    time_us: Timestamp,
    state: PipelineState,
    boards: Vec<Option<[f32; 7]>>,
    pressed: &'a [TargetId],
    keys: Vec<KeyCode>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::ProfileName;
    use crate::device::Events;
    use crate::estimate::{Estimator, EstimatorSettings};
    use crate::hand::{Joint, Side};
    use crate::kinematics::{ArmModel, BoneLengths, HandPose};
    use crate::layout::Layout;
    use crate::pipeline::{LayoutInstance, PipelineSettings};
    use crate::snapshot::Snapshot;

    /// Returns a layout with one board, for this hand.
    fn board_of(side: Side) -> LayoutInstance {
        let text = format!(
            "Layout(name: \"a\", boards: [(pose: (anchor: elbow), hand: \"{side}\", keys: [(code: \"A\", at_mm: (0, 0))])])"
        );
        LayoutInstance::from_layout(&Layout::parse(&text, "a.ron").unwrap())
    }

    #[test]
    fn a_board_of_another_profile_has_no_pose_before_its_hand_is_seen() {
        let bones = BoneLengths::from_hand_and_forearm(0.19, 0.255).unwrap();
        let mut pipeline = Pipeline::new(
            Estimator::new(EstimatorSettings::default()),
            ArmModel::anthropometric(Side::Right, &bones).unwrap(),
            board_of(Side::Right),
            PipelineSettings::default(),
        );
        let name = ProfileName::from("left").unwrap();
        pipeline = pipeline.with_profiles([(name, board_of(Side::Left))]);
        let mut pose = HandPose::new(Timestamp(0), Side::Right, 0.005);
        pose.set(Joint::Elbow, Pose::IDENTITY);
        let step = Snapshot {
            state: PipelineState::Running,
            pose: Some(pose),
            ..Snapshot::default()
        };
        let mut scene = SceneState::default();
        scene.update(&step.view(), &pipeline);
        assert!(scene.boards[0].is_some());
        pipeline.switch_profile(1, &mut Events::new());
        scene.update(&step.view(), &pipeline);
        assert_eq!(scene.boards[..], [None]);
    }
}
