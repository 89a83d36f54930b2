//! What there is to be touched, and what comes of it.

use super::StepOutput;
use super::auto_recenter::Drifting;
use crate::command::ProfileName;
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

/// Brings what comes up before what goes down: each device keeps that order, but one knows nothing of
/// the next. A code that went down in the same frame stays where it is; times do not go back.
fn put_releases_first(events: &mut [OutputEvent]) {
    let is_down = |event: &OutputEvent| matches!(event.kind, EventKind::KeyDown(_));
    let Some(mut first_down) = events.iter().position(is_down) else {
        return;
    };
    for place in first_down + 1..events.len() {
        let EventKind::KeyUp(code) = events[place].kind else {
            continue;
        };
        let own = EventKind::KeyDown(code);
        if events[first_down..place]
            .iter()
            .any(|event| event.kind == own)
        {
            continue;
        }
        events[first_down..=place].rotate_right(1);
        let time = events[first_down].time;
        first_down += 1;
        for event in &mut events[first_down..=place] {
            event.time = event.time.max(time);
        }
    }
}

/// The controls of one layout, for both hands.
pub struct LayoutInstance {
    pub(super) scene: Scene,
    names: TargetNames,
    trackers: [ContactTracker; Side::COUNT],
    switchboard: KeyArbiter,
    devices: Vec<Box<dyn VirtualDevice>>,
    /// The layouts of the setup that its keys activate, by name and index.
    profiles: Vec<(ProfileName, usize)>,
    pub(super) drifting: Drifting,
}

impl LayoutInstance {
    /// Controls that have not seen a hand yet: a fingertip that is in one of them at first has to come
    /// out before it touches anything.
    ///
    /// `names` are those of the targets, for outputs that write them.
    pub fn new(scene: Scene, names: TargetNames, devices: Vec<Box<dyn VirtualDevice>>) -> Self {
        Self {
            trackers: [ContactTracker::new(&scene), ContactTracker::new(&scene)],
            scene,
            names,
            switchboard: KeyArbiter::default(),
            devices,
            profiles: Vec::new(),
            drifting: Drifting::default(),
        }
    }

    /// The same with texts that keys write; see [`TextId`](crate::device::TextId).
    #[must_use]
    pub fn with_texts(self, texts: Vec<String>) -> Self {
        Self {
            switchboard: KeyArbiter::new(texts),
            ..self
        }
    }

    /// Sets the layouts of the setup that its keys activate: the name in
    /// [`Command::Profile`](crate::command::Command::Profile) and the index in the setup.
    #[must_use]
    pub fn with_profiles(self, profiles: Vec<(ProfileName, usize)>) -> Self {
        Self { profiles, ..self }
    }

    /// The same with boards that creep under a resting hand: board `i` as `drifts[i]` says.
    #[must_use]
    pub fn with_auto_recenter(
        self,
        drifts: impl IntoIterator<Item = Option<AutoRecenter>>,
    ) -> Self {
        Self {
            drifting: Drifting::new(drifts),
            ..self
        }
    }

    /// What the targets are called.
    pub fn target_names(&self) -> &TargetNames {
        &self.names
    }

    /// Returns the index of the layout of the setup with a name.
    pub(super) fn profile(&self, name: &str) -> Option<usize> {
        let mut profiles = self.profiles.iter();
        profiles.find_map(|(other, index)| (other.as_str() == name).then_some(*index))
    }

    /// Follows the fingertips of one hand.
    pub(super) fn touch(&mut self, pose: &HandPose, touches: &mut Touches) {
        touches.clear();
        self.trackers[pose.side.index()].update(&self.scene, pose, touches);
    }

    /// Whether the hand is seen off all controls.
    pub(super) fn is_clear(&self, pose: &HandPose) -> bool {
        self.trackers[pose.side.index()].is_clear(&self.scene, pose)
    }

    /// Lets boards creep under a hand that rests.
    pub(super) fn drift(&mut self, pose: &HandPose) {
        let is_touched = self.trackers.iter().any(|tracker| !tracker.is_idle());
        self.drifting.advance(&mut self.scene, pose, is_touched);
    }

    /// Shows the devices one frame of one hand. Keys that fingers of hands that `only_point`, by side, press are
    /// dropped; how many that were.
    pub(super) fn update(
        &mut self,
        frame: &mut StepOutput,
        only_point: [bool; Side::COUNT],
        events: &mut Events,
    ) -> u64 {
        self.switchboard.set_pointing_hands(only_point);
        let seen = DeviceInput {
            scene: &self.scene,
            angles: &frame.estimate.angles,
            pose: &frame.pose,
            touches: &frame.touches,
        };
        let mut out = DeviceOutput {
            arbiter: &mut self.switchboard,
            events,
            commands: &mut frame.commands,
        };
        let first = out.events.len();
        for device in &mut self.devices {
            device.update(&seen, &mut out);
        }
        if self.devices.len() > 1 {
            put_releases_first(&mut events[first..]);
        }
        self.switchboard.take_dropped_presses()
    }

    /// Ends every touch and lets go of everything.
    pub(super) fn release_all(&mut self, time: Timestamp, events: &mut Events) {
        for tracker in &mut self.trackers {
            tracker.reset(time, &mut Touches::new());
        }
        self.drifting.forget();
        self.switchboard.release_all(time, events);
        let mut out = DeviceOutput {
            arbiter: &mut self.switchboard,
            events,
            commands: &mut TimedCommands::new(),
        };
        for device in &mut self.devices {
            device.release_all(time, &mut out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::KeyCode;

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

    fn ordered(script: &str) -> String {
        let words = script.split_whitespace().enumerate();
        let mut events: Vec<_> = words.map(|(time, word)| event(time as u64, word)).collect();
        put_releases_first(&mut events);
        assert!(events.windows(2).all(|pair| pair[0].time <= pair[1].time));
        let told = events.iter().map(|event| match event.kind {
            EventKind::KeyDown(code) => format!("+{code}"),
            EventKind::KeyUp(code) => format!("-{code}"),
            _ => unreachable!(),
        });
        told.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn what_comes_up_goes_before_what_goes_down_but_for_its_own_press() {
        assert_eq!(ordered("+A -B +C -D -A"), "-B -D +A +C -A");
        assert_eq!(ordered("-A +A -A -B"), "-A -B +A -A");
        assert_eq!(ordered("+A +B"), "+A +B");
        assert_eq!(ordered("-A -B"), "-A -B");
    }
}
