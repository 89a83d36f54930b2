//! A layout at run time: its scene, contact trackers and devices.

use std::sync::Arc;
use std::time::Duration;

use super::auto_recenter::AutoRecenterState;
use super::hand_watch::HandWatch;
use super::release_order::move_releases_first;
use super::{PressFilter, StepOutput};
use crate::contact::surface::{Anchor, Scene};
use crate::contact::{BendTracker, ContactTracker, TargetId, TargetNames, Touches, bent_fingers};
use crate::device::key_arbiter::SequenceHand;
use crate::device::signals::Signals;
use crate::device::{
    CursorPosition, DeviceInput, DeviceOutput, Events, KeyArbiter, KeyCode, TimedCommands,
    VirtualDevice,
};
use crate::estimate::{BendRanges, FingerBends};
use crate::hand::{FingerSet, Side};
use crate::kinematics::HandPose;
use crate::layout::Layout;
use crate::time::Timestamp;

/// The presses that the sources of the hands permit in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct PressRules {
    /// The hand may point but not type, by side.
    pub(super) pointer_only: [bool; Side::COUNT],
    /// `true` during a pause, whose events are not sent.
    pub(super) is_paused: bool,
    /// Time between two presses of a sequence that the hand of the step has started, and between two taps of a control with a value.
    pub(super) sequence_gap: Duration,
}

/// A layout at run time, for both hands.
pub struct LayoutInstance {
    pub(super) scene: Scene,
    target_names: TargetNames,
    trackers: [ContactTracker; Side::COUNT],
    /// `true` if fingers press targets by bending instead of by touch.
    is_bent: bool,
    /// `true` if targets or devices depend on the bends of the fingers.
    needs_bends: bool,
    bend_trackers: [BendTracker; Side::COUNT],
    /// The tracking of each hand, by side.
    hands: [HandWatch; Side::COUNT],
    /// `true` if a hand was lost in the last step.
    has_lost_hand: bool,
    key_arbiter: KeyArbiter,
    devices: Vec<Box<dyn VirtualDevice>>,
    pub(super) auto_recenter: AutoRecenterState,
    layout: Option<Arc<Layout>>,
    /// `true` if something is anchored at the start.
    starts_at_hand: bool,
    /// `true` if something is anchored at the other hand.
    follows_other_hand: bool,
    /// `true` if something is anchored at a point of the body.
    follows_body: bool,
    /// The text decoder.
    filter: Option<Box<dyn PressFilter>>,
}

impl LayoutInstance {
    /// Creates a layout without pressed keys. A fingertip that is inside a target in the first pose must leave it before
    /// it can touch.
    ///
    /// `target_names` are the names of the targets of `scene`, for outputs that report them.
    pub fn new(
        scene: Scene,
        target_names: TargetNames,
        devices: Vec<Box<dyn VirtualDevice>>,
    ) -> Self {
        Self {
            trackers: [ContactTracker::new(&scene), ContactTracker::new(&scene)],
            is_bent: scene.has_bend_targets(),
            needs_bends: scene.has_bend_targets() || devices.iter().any(|it| it.needs_bends()),
            starts_at_hand: scene.starts_at_hand(),
            follows_other_hand: scene.follows_other_hand(),
            follows_body: scene.follows_body(),
            bend_trackers: Default::default(),
            hands: Default::default(),
            has_lost_hand: false,
            scene,
            target_names,
            key_arbiter: KeyArbiter::default(),
            devices,
            auto_recenter: AutoRecenterState::default(),
            layout: None,
            filter: None,
        }
    }

    /// Creates the run-time instance of a layout.
    pub fn from_layout(layout: &Layout) -> Self {
        let (scene, names) = (layout.scene.clone(), layout.target_names());
        let instance = Self::new(scene, names, layout.devices());
        let auto_recenter = layout.boards.iter().map(|board| board.auto_recenter);
        Self {
            key_arbiter: KeyArbiter::new(layout.texts.clone())
                .with_sequences(layout.sequences.clone())
                .with_multitaps(layout.multitaps.clone()),
            auto_recenter: AutoRecenterState::new(auto_recenter),
            starts_at_hand: instance.starts_at_hand || layout.has_frame_at(Anchor::Start),
            follows_other_hand: layout.follows_other_hand(),
            follows_body: layout.follows_body(),
            layout: Some(Arc::new(layout.clone())),
            ..instance
        }
    }

    /// Sets the text decoder, which is the first filter of presses.
    #[must_use]
    pub fn with_filter(self, filter: Option<Box<dyn PressFilter>>) -> Self {
        Self { filter, ..self }
    }

    /// Returns the text decoder.
    pub fn filter(&self) -> Option<&dyn PressFilter> {
        self.filter.as_deref()
    }

    /// Returns the text decoder, to change its state.
    pub(super) fn filter_mut(&mut self) -> Option<&mut (dyn PressFilter + 'static)> {
        self.filter.as_deref_mut()
    }

    /// Returns the text decoder, the targets, and the arbiter, which knows the keys that the devices hold and the hand that pressed
    /// each.
    pub(super) fn filter_parts(
        &mut self,
    ) -> (
        Option<&mut (dyn PressFilter + 'static)>,
        &Scene,
        &KeyArbiter,
    ) {
        let filter = self.filter.as_deref_mut();
        (filter, &self.scene, &self.key_arbiter)
    }

    /// Copies the mode of the text decoder, and what it has learned about the person, from the previous layout.
    pub(super) fn take_over_text(&mut self, before: &Self) {
        if let Some((filter, known)) = self.filter.as_mut().zip(before.filter()) {
            filter.take_over(known);
        }
    }

    /// Returns the names of the targets.
    pub fn target_names(&self) -> &TargetNames {
        &self.target_names
    }

    /// Returns the signals that its controls send to music and stage programs.
    pub fn signals(&self) -> Signals {
        let layout = self.layout.as_ref();
        layout.map_or_else(Signals::default, |layout| layout.signals.clone())
    }

    /// Returns the layout that this instance was made from, if it is known.
    pub fn layout(&self) -> Option<&Arc<Layout>> {
        self.layout.as_ref()
    }

    /// Returns `true` if a board, pointer or space is anchored at the position of the hand at the start.
    pub fn starts_at_hand(&self) -> bool {
        self.starts_at_hand
    }

    /// Returns `true` if a board, pointer or space is anchored at the other hand.
    pub(super) fn follows_other_hand(&self) -> bool {
        self.follows_other_hand
    }

    /// Returns `true` if a board, pointer or space is anchored at a point of the body.
    pub(super) fn follows_body(&self) -> bool {
        self.follows_body
    }

    /// Returns `true` if a device points somewhere.
    pub(super) fn is_pointing(&self) -> bool {
        self.devices.iter().any(|device| device.is_pointing())
    }

    /// Returns the targets with the present poses of the boards.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Iterates over the targets that fingertips of either hand press.
    pub fn pressed_targets(&self) -> impl Iterator<Item = TargetId> + '_ {
        let bent = self.bend_trackers.iter().flat_map(BendTracker::pressed);
        let touched = self.trackers.iter().flat_map(ContactTracker::pressed);
        touched.chain(bent)
    }

    /// Returns the position of the cursor; `None` for a layout without a pointer and targets in space.
    pub fn cursor(&self) -> Option<CursorPosition> {
        self.devices.iter().find_map(|device| device.cursor())
    }

    /// Updates the contacts of one hand and replaces its bends, touches and presses. Bends are not measured unless a target or
    /// a device depends on them, and have no evidence of presses.
    pub(super) fn track(&mut self, step: &mut StepOutput, ranges: &BendRanges) {
        step.touches.clear();
        step.presses.clear();
        step.bends = if self.needs_bends {
            ranges.bends(&step.estimate.angles)
        } else {
            FingerBends::default()
        };
        let side = step.pose.side.index();
        if self.is_bent {
            let tracker = &mut self.bend_trackers[side];
            tracker.update(&self.scene, &step.pose, &step.bends, &mut step.touches);
            return;
        }
        let tracker = &mut self.trackers[side];
        tracker.update(&self.scene, &step.pose, &mut step.touches);
        tracker.add_presses(&self.scene, &step.touches, &mut step.presses);
    }

    /// Returns `true` if the hand is clear of every control.
    pub(super) fn is_clear(&self, pose: &HandPose, bends: &FingerBends) -> bool {
        if self.is_bent {
            bent_fingers(&self.scene, pose, bends) == (FingerSet::NONE, true)
        } else {
            self.trackers[pose.side.index()].is_clear(&self.scene, pose)
        }
    }

    /// Returns the fingers of a hand that are not straight, if they press targets by bending.
    pub(super) fn bent_fingers(&self, pose: &HandPose, bends: &FingerBends) -> FingerSet {
        if self.is_bent {
            bent_fingers(&self.scene, pose, bends).0
        } else {
            FingerSet::NONE
        }
    }

    /// Returns `true` if a fingertip touches a target or a control holds a key.
    pub(super) fn is_in_use(&self) -> bool {
        self.is_touched() || !self.key_arbiter.is_idle()
    }

    fn is_touched(&self) -> bool {
        let is_bent = self.bend_trackers.iter().any(|tracker| !tracker.is_idle());
        is_bent || self.trackers.iter().any(|tracker| !tracker.is_idle())
    }

    /// Moves auto-recentering boards if the hand rests.
    pub(super) fn update_auto_recenter(&mut self, pose: &HandPose) {
        let is_touched = self.is_touched();
        self.auto_recenter.update(&mut self.scene, pose, is_touched);
    }

    /// Updates the devices for one hand and one step, and the sequence that it has started. Presses of keys by hands that may only
    /// point are dropped; returns their number. In the step that shows that the hand is lost, its one-shots and locks end, and its
    /// toggles and radio keys are released; presses, locks and toggles of the other hand stay. After a gap its one-shots end.
    pub(super) fn update_devices(
        &mut self,
        step: &mut StepOutput,
        rules: PressRules,
        events: &mut Events,
    ) -> u64 {
        let side = step.pose.side;
        self.key_arbiter.begin_step(side, rules.pointer_only);
        self.key_arbiter.set_paused(rules.is_paused);
        self.key_arbiter.set_tap_gap(rules.sequence_gap);
        let finds_letters = self.filter().is_some_and(PressFilter::finds_letters);
        self.key_arbiter.set_first_letters_only(finds_letters);
        let input = DeviceInput {
            scene: &self.scene,
            angles: &step.estimate.angles,
            bends: &step.bends,
            inputs: &step.estimate.inputs,
            pose: &step.pose,
            touches: &step.touches,
            presses: &step.presses,
        };
        let mut output = DeviceOutput {
            arbiter: &mut self.key_arbiter,
            events,
            commands: &mut step.commands,
        };
        let first = output.events.len();
        let had_sequence = output.arbiter.runs_sequence();
        // Releases that did not fit into the event list of the last step.
        let last_time = output.arbiter.last_event_time();
        output.arbiter.emit_changes(last_time, output.events);
        for device in &mut self.devices {
            device.update(&input, &mut output);
        }
        let is_lost = self.hands[side.index()].update(&step.estimate);
        self.has_lost_hand = is_lost;
        if is_lost {
            release_hand(&mut self.devices, side, step.pose.time, &mut output);
        } else if step.pose.may_hide_presses(self.is_bent) {
            // The key that they are meant for may have been missed.
            output.arbiter.end_one_shots(side);
        }
        let hand = SequenceHand {
            side,
            time: step.pose.time,
            is_placed: step.estimate.is_placed,
            is_seen: step.estimate.untrusted != FingerSet::ALL,
            press_gap: rules.sequence_gap,
        };
        self.key_arbiter.watch_multitap(&hand);
        self.key_arbiter.advance_sequence(&hand, events);
        if self.devices.len() > 1 || had_sequence || is_lost {
            move_releases_first(&mut events[first..]);
        }
        self.key_arbiter.take_dropped_presses()
    }

    /// Returns the hand that has asked last to be zeroed.
    pub(super) fn hand_to_zero(&self) -> Side {
        self.key_arbiter.hand_to_zero()
    }

    /// Returns `true` if the last step has shown that its hand is lost.
    pub(super) fn has_lost_hand(&self) -> bool {
        self.has_lost_hand
    }

    /// Notes that a source of a hand was lost: the next step releases what the hand has locked and switched on.
    pub(super) fn lose_hand(&mut self, side: Side) {
        self.hands[side.index()].lose();
    }

    /// Notes that the gate has suppressed the presses of keys.
    pub(super) fn suppress_keys(&mut self, keys: impl Iterator<Item = KeyCode>) {
        for key in keys {
            self.key_arbiter.suppress_key(key);
        }
    }

    /// Returns the number of presses that replaced letters since the last call; see [`KeyArbiter::take_replacing_presses`].
    pub(super) fn take_replacing_presses(&mut self) -> usize {
        self.key_arbiter.take_replacing_presses()
    }

    /// Ends the sequence that runs. The next step releases its keys.
    pub(super) fn abandon_sequence(&mut self) {
        self.key_arbiter.abandon_sequence();
    }

    /// Ends every touch and releases everything.
    pub(super) fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        for tracker in &mut self.trackers {
            tracker.reset(time, &mut Touches::new());
        }
        for tracker in &mut self.bend_trackers {
            tracker.reset(time, &mut Touches::new());
        }
        self.auto_recenter.reset();
        self.key_arbiter.release_all(time, events);
        let mut output = DeviceOutput {
            arbiter: &mut self.key_arbiter,
            events,
            commands: &mut TimedCommands::new(),
        };
        for device in &mut self.devices {
            device.release_all(time, &mut output);
        }
    }
}

/// Ends the one-shots and locks that a hand has set, and what it has switched on.
fn release_hand(
    devices: &mut [Box<dyn VirtualDevice>],
    side: Side,
    time: Timestamp,
    output: &mut DeviceOutput,
) {
    output.arbiter.release_hand(side);
    for device in devices {
        device.release_hand(side, time, output);
    }
    output.arbiter.emit_changes(time, output.events);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Presses;
    use crate::device::{Capabilities, EventKind, KeyAction, OutputEvent, PressSource};
    use crate::estimate::Estimate;
    use crate::hand::JointAngles;

    /// Presses A in its first step, and releases it in the second one, which it fills with movements.
    #[derive(Default)]
    struct Button {
        steps: usize,
    }

    impl VirtualDevice for Button {
        fn add_capabilities(&self, _: &mut Capabilities) {}

        fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
            let (time, source) = (input.pose.time, PressSource::Part(TargetId(0), 0));
            self.steps += 1;
            match self.steps {
                1 => {
                    let key = KeyAction::Key("A".parse().expect("a key"));
                    assert!(out.arbiter.press(source, key, time, out.events));
                }
                2 => {
                    let kind = EventKind::MoveBy(1, 0);
                    while out.events.try_push(OutputEvent { time, kind }).is_ok() {}
                    out.arbiter.release(|other| other == source);
                }
                _ => return,
            }
            out.arbiter.emit_changes(time, out.events);
        }

        fn release_all(&mut self, _: Timestamp, _: &mut DeviceOutput) {}
    }

    #[test]
    fn a_layout_without_a_keyboard_releases_in_the_next_step_what_had_no_room() {
        let devices: Vec<Box<dyn VirtualDevice>> = vec![Box::new(Button::default())];
        let mut layout = LayoutInstance::new(Scene::new(), TargetNames::default(), devices);
        let keys_of_step = |ms: u64| {
            let time = Timestamp(ms * 1_000);
            let mut step = StepOutput {
                estimate: Estimate::new(time, JointAngles::default()),
                pose: HandPose::new(time, Side::Right, 0.006),
                bends: FingerBends::default(),
                touches: Touches::new(),
                presses: Presses::new(),
                commands: TimedCommands::new(),
            };
            let rules = PressRules {
                pointer_only: [false; Side::COUNT],
                is_paused: false,
                sequence_gap: Duration::ZERO,
            };
            let mut events = Events::new();
            layout.update_devices(&mut step, rules, &mut events);
            let keys = events.iter().filter_map(|event| match event.kind {
                EventKind::KeyDown(key) => Some(format!("+{key}")),
                EventKind::KeyUp(key) => Some(format!("-{key}")),
                _ => None,
            });
            keys.collect::<String>()
        };
        assert_eq!([10, 20, 30, 40].map(keys_of_step), ["+A", "", "-A", ""]);
        assert!(!layout.is_in_use());
    }
}
