//! A layout at run time: its scene, contact trackers and devices.

use super::StepOutput;
use super::auto_recenter::AutoRecenterState;
use crate::contact::board_pose::AutoRecenter;
use crate::contact::surface::Scene;
use crate::contact::{ContactTracker, TargetNames, Touches};
use crate::device::{
    DeviceInput, DeviceOutput, EventKind, Events, KeyArbiter, OutputEvent, TimedCommands,
    VirtualDevice,
};
use crate::hand::Side;
use crate::kinematics::HandPose;
use crate::time::Timestamp;

/// A layout at run time, for both hands.
pub struct LayoutInstance {
    pub(super) scene: Scene,
    target_names: TargetNames,
    trackers: [ContactTracker; Side::COUNT],
    key_arbiter: KeyArbiter,
    devices: Vec<Box<dyn VirtualDevice>>,
    pub(super) auto_recenter: AutoRecenterState,
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
            scene,
            target_names,
            key_arbiter: KeyArbiter::default(),
            devices,
            auto_recenter: AutoRecenterState::default(),
        }
    }

    /// Sets the texts that keys write; see [`TextId`](crate::device::TextId).
    #[must_use]
    pub fn with_texts(self, texts: Vec<String>) -> Self {
        Self {
            key_arbiter: KeyArbiter::new(texts),
            ..self
        }
    }

    /// Sets the auto-recentering of the boards; `settings[i]` are those of board `i`, `None` if it stays.
    #[must_use]
    pub fn with_auto_recenter(
        self,
        settings: impl IntoIterator<Item = Option<AutoRecenter>>,
    ) -> Self {
        Self {
            auto_recenter: AutoRecenterState::new(settings),
            ..self
        }
    }

    /// Returns the names of the targets.
    pub fn target_names(&self) -> &TargetNames {
        &self.target_names
    }

    /// Updates the contacts of one hand and replaces `touches`.
    pub(super) fn track(&mut self, pose: &HandPose, touches: &mut Touches) {
        touches.clear();
        self.trackers[pose.side.index()].update(&self.scene, pose, touches);
    }

    /// Returns whether the hand is clear of every control.
    pub(super) fn is_clear(&self, pose: &HandPose) -> bool {
        self.trackers[pose.side.index()].is_clear(&self.scene, pose)
    }

    /// Moves auto-recentering boards if the hand rests.
    pub(super) fn update_auto_recenter(&mut self, pose: &HandPose) {
        let is_touched = self.trackers.iter().any(|tracker| !tracker.is_idle());
        self.auto_recenter.update(&mut self.scene, pose, is_touched);
    }

    /// Updates the devices for one hand and one step. Presses of keys by hands with `is_pointer_only`, by side, are
    /// dropped; returns their number.
    pub(super) fn update_devices(
        &mut self,
        step: &mut StepOutput,
        is_pointer_only: [bool; Side::COUNT],
        events: &mut Events,
    ) -> u64 {
        self.key_arbiter.set_pointing_hands(is_pointer_only);
        let input = DeviceInput {
            scene: &self.scene,
            angles: &step.estimate.angles,
            pose: &step.pose,
            touches: &step.touches,
        };
        let mut output = DeviceOutput {
            arbiter: &mut self.key_arbiter,
            events,
            commands: &mut step.commands,
        };
        let first = output.events.len();
        for device in &mut self.devices {
            device.update(&input, &mut output);
        }
        if self.devices.len() > 1 {
            move_releases_first(&mut events[first..]);
        }
        self.key_arbiter.take_dropped_presses()
    }

    /// Ends every touch and releases everything.
    pub(super) fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        for tracker in &mut self.trackers {
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

/// Moves releases before presses. Each device emits its releases first, but does not know the events of the others. A
/// release stays behind a press of the same key; times remain in order.
fn move_releases_first(events: &mut [OutputEvent]) {
    let is_press = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
    let Some(mut first_press) = events.iter().position(is_press) else {
        return;
    };
    for index in first_press + 1..events.len() {
        let EventKind::KeyUp(code) = events[index].kind else {
            continue;
        };
        let own_press = EventKind::KeyDown(code);
        if events[first_press..index]
            .iter()
            .any(|event| event.kind == own_press)
        {
            continue;
        }
        events[first_press..=index].rotate_right(1);
        let time = events[first_press].time;
        first_press += 1;
        for event in &mut events[first_press..=index] {
            event.time = event.time.max(time);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::KeyCode;

    /// Parses `+KEY` (press) or `-KEY` (release).
    fn event(time: u64, text: &str) -> OutputEvent {
        let code: KeyCode = text[1..].parse().unwrap();
        OutputEvent {
            time: Timestamp(time),
            kind: match text.as_bytes()[0] {
                b'+' => EventKind::KeyDown(code),
                _ => EventKind::KeyUp(code),
            },
        }
    }

    fn reordered(script: &str) -> String {
        let words = script.split_whitespace().enumerate();
        let mut events: Vec<_> = words.map(|(time, word)| event(time as u64, word)).collect();
        move_releases_first(&mut events);
        assert!(events.windows(2).all(|pair| pair[0].time <= pair[1].time));
        let words = events.iter().map(|event| match event.kind {
            EventKind::KeyDown(code) => format!("+{code}"),
            EventKind::KeyUp(code) => format!("-{code}"),
            _ => unreachable!(),
        });
        words.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn releases_precede_presses_except_those_of_the_same_key() {
        assert_eq!(reordered("+A -B +C -D -A"), "-B -D +A +C -A");
        assert_eq!(reordered("-A +A -A -B"), "-A -B +A -A");
        assert_eq!(reordered("+A +B"), "+A +B");
        assert_eq!(reordered("-A -B"), "-A -B");
    }
}
