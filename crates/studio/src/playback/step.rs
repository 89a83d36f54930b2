//! The results of a step, in the form in which many of them are kept.

use std::sync::Arc;

use crate::model::StudioModel;
use ademan_core::command::CommandOrigin;
use ademan_core::contact::{Press, TargetNames, Touch};
use ademan_core::device::{OutputEvent, TimedCommand};
use ademan_core::hand::{JointAngles, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::pipeline::{PipelineState, TextState};
use ademan_core::snapshot::{Snapshot, Stats, StepView};
use ademan_runtime::capture::recording::message::{decode_reading, encode_reading};
use ademan_runtime::session::view::View;

/// The results of a step. A [`Snapshot`] has room for the most events that a step can have.
#[derive(Clone, Debug)]
pub struct RecordedStep {
    state: PipelineState,
    paused_by: Option<CommandOrigin>,
    profile: usize,
    target_names: TargetNames,
    /// The reading as a message of a recording.
    reading: Box<[u8]>,
    hand: Option<Box<(JointAngles, HandPose)>>,
    touches: Box<[Touch]>,
    presses: Box<[Press]>,
    events: Box<[OutputEvent]>,
    commands: Box<[TimedCommand]>,
    executed: Option<TimedCommand>,
    lost_hands: [bool; Side::COUNT],
    text: Option<Box<TextState>>,
    stats: Box<Stats>,
    view: Option<Arc<View>>,
}

impl RecordedStep {
    /// Copies the results of a step, and the view after it if one is due.
    pub fn new(step: &StepView, view: Option<View>) -> Self {
        let mut reading = Vec::new();
        if let Some(present) = step.reading {
            encode_reading(present, &mut reading);
        }
        let hand = step.angles.zip(step.pose);
        Self {
            state: step.state,
            paused_by: step.paused_by,
            profile: step.profile,
            target_names: step.target_names.clone(),
            reading: reading.into(),
            hand: hand.map(|(angles, pose)| Box::new((*angles, *pose))),
            touches: step.touches.into(),
            presses: step.presses.into(),
            events: step.events.into(),
            commands: step.commands.into(),
            executed: step.executed.copied(),
            lost_hands: step.lost_hands,
            text: step.text.cloned().map(Box::new),
            stats: Box::new(*step.stats),
            view: view.map(Arc::new),
        }
    }

    /// Returns the results as a session sends them.
    pub fn to_snapshot(&self) -> Snapshot {
        // A step without a reading has no bytes, which are no reading either.
        let reading = decode_reading(&self.reading).ok();
        let hand = self.hand.as_deref();
        let view = StepView {
            state: self.state,
            paused_by: self.paused_by,
            profile: self.profile,
            target_names: &self.target_names,
            reading: reading.as_ref(),
            source_error: None,
            angles: hand.map(|(angles, _)| angles),
            pose: hand.map(|(_, pose)| pose),
            touches: &self.touches,
            presses: &self.presses,
            events: &self.events,
            commands: &self.commands,
            executed: self.executed.as_ref(),
            lost_hands: self.lost_hands,
            text: self.text.as_deref(),
            stats: &self.stats,
            latency: None,
        };
        view.to_snapshot()
    }

    /// Updates a model as the session does that sends this step.
    pub fn apply_to(&self, model: &mut StudioModel) {
        if let Some(view) = &self.view {
            model.set_view(View::clone(view));
        }
        model.update(&self.to_snapshot());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::tests::snapshot;
    use crate::scene::tests::model_of;
    use ademan_core::contact::{Phase, TargetId};
    use ademan_core::device::{EventKind, Events};
    use ademan_core::hand::Finger;
    use ademan_core::layout::Layout;
    use ademan_core::time::Timestamp;
    use ademan_runtime::files::Load;
    use parry3d::math::Vec2;

    #[test]
    fn a_profile_that_becomes_active_has_its_meshes() {
        let layout = |name: &str| Arc::new(Layout::load(name).unwrap());
        let mut model = model_of(layout("qwerty-flat"));
        let next = model_of(layout("claws")).view;
        let step = snapshot(PipelineState::Running);
        RecordedStep::new(&step.view(), Some(next)).apply_to(&mut model);
        assert_eq!(model.view.layout.name, layout("claws").name);
        assert!(model.shapes.mesh("claw.obj").is_some());
    }

    #[test]
    fn what_a_layout_ends_when_another_one_follows_is_neither_a_value_nor_a_contact_of_that() {
        let layout = |name: &str| Arc::new(Layout::load(name).unwrap());
        let mixer = layout("mixer");
        let fader = TargetId(3);
        let touch = Touch {
            time: Timestamp::default(),
            side: Side::Right,
            finger: Finger::Index,
            target: fader,
            phase: Phase::Pressed,
            depth: 1.0,
            position: Vec2::ZERO,
        };
        let emitted = |value| Snapshot {
            target_names: mixer.target_names(),
            touches: [touch].into_iter().collect(),
            events: Events::from_iter([OutputEvent {
                time: Timestamp::default(),
                kind: EventKind::Value(fader, value),
            }]),
            ..snapshot(PipelineState::Running)
        };
        let mut model = model_of(Arc::clone(&mixer));
        RecordedStep::new(&emitted(0.7).view(), None).apply_to(&mut model);
        assert_eq!(model.values.get(&fader), Some(&0.7));
        assert!(model.contact_with(fader).is_some());
        let mut next = model_of(layout("claws")).view;
        Arc::make_mut(&mut next.state).values = vec![(TargetId(0), 0.2)];
        RecordedStep::new(&emitted(0.5).view(), Some(next)).apply_to(&mut model);
        assert_eq!(model.contact_with(fader), None);
        let values: Vec<_> = model.values.into_iter().collect();
        assert_eq!(values, [(TargetId(0), 0.2)]);
    }
}
