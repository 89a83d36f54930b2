//! The state that the panels show: the latest of everything, and the last seconds.

use std::collections::BTreeMap;
use std::sync::Arc;

use parry3d::math::{Pose, Vec3};

use super::history::{History, Moment, SentEvent, SentKey};
use super::latency::LatencyLog;
use super::sensors::SensorTable;
use super::shapes::Shapes;
use super::trails::Trail;
use ademan_core::contact::surface::Anchor;
use ademan_core::contact::{Phase, TargetId, TargetNames};
use ademan_core::device::{EventKind, KeyCode};
use ademan_core::estimate::Rejection;
use ademan_core::hand::{Dof, Finger, FingerSet, JointAngles, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::pipeline::PipelineState;
use ademan_core::snapshot::{Snapshot, Stats};
use ademan_runtime::capture::Sample;
use ademan_runtime::session::view::{View, ViewCounts, ViewHand, ViewState};

/// The contact of a fingertip with a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The target.
    pub target: TargetId,
    /// Depth as a fraction of the travel, 0..=1.
    pub depth: f32,
    /// The target is pressed.
    pub is_pressed: bool,
}

/// The state of a session, as far as Studio has received it.
#[derive(Clone)]
pub struct StudioModel {
    /// The latest view.
    pub view: View,
    /// The latest pose of each hand that is tracked, by side.
    pub poses: [Option<HandPose>; Side::COUNT],
    /// A hand beside the boards that touches nothing and is only drawn.
    pub resting: Option<HandPose>,
    /// The paths of the fingertips, by side and finger.
    pub trails: [[Trail; Finger::COUNT]; Side::COUNT],
    /// Contacts, by side and finger.
    pub contacts: [[Option<Contact>; Finger::COUNT]; Side::COUNT],
    /// The latest joint angles of the first hand.
    pub angles: Option<JointAngles>,
    /// Statistics of all readings so far.
    pub stats: Stats,
    /// The rejected readings at the latest pose, by reason.
    rejected_before: [u64; Rejection::COUNT],
    /// The channels of the glove.
    pub sensors: SensorTable,
    /// Latency of the session.
    pub latency: LatencyLog,
    /// The latest values of controls of the layout: positions of sliders and knobs, 1 for what is on.
    pub values: BTreeMap<TargetId, f32>,
    /// The meshes of the layout.
    pub shapes: Shapes,
    /// The names of the targets of the layout, to which `contacts` and `values` belong.
    target_names: TargetNames,
    /// The last seconds.
    pub history: History,
    /// The session is in another process, which sends views only.
    pub is_from_views: bool,
    /// The session has ended.
    pub has_ended: bool,
}

impl StudioModel {
    /// Creates the state before the first snapshot.
    pub fn new(view: View, sensors: SensorTable) -> Self {
        Self::with_shapes(view, sensors, Shapes::default())
    }

    /// Creates the state before the first snapshot. `shapes` are the meshes of no layout yet.
    pub fn with_shapes(view: View, sensors: SensorTable, mut shapes: Shapes) -> Self {
        shapes.update(&view.layout);
        Self {
            values: view.state.values.iter().copied().collect(),
            target_names: view.layout.target_names(),
            view,
            poses: [None; Side::COUNT],
            resting: None,
            trails: Default::default(),
            contacts: Default::default(),
            angles: None,
            stats: Stats::default(),
            rejected_before: [0; Rejection::COUNT],
            sensors,
            latency: LatencyLog::default(),
            shapes,
            history: History::default(),
            is_from_views: false,
            has_ended: false,
        }
    }

    /// Replaces the view, and reads the meshes of a new layout, whose values are the ones of the view.
    pub fn set_view(&mut self, view: View) {
        self.shapes.update(&view.layout);
        if !Arc::ptr_eq(&self.view.layout, &view.layout) {
            self.values = view.state.values.iter().copied().collect();
            self.target_names = view.layout.target_names();
            self.clear_contacts();
        }
        self.view = view;
    }

    /// Replaces the view of a session in another process, and updates the rest as far as the view carries it: hands, values, heights,
    /// keys and counts. Angles, channels and latencies are not known.
    pub fn update_from_view(&mut self, view: View) {
        let (before, state) = (Arc::clone(&self.view.state), Arc::clone(&view.state));
        self.set_view(view);
        self.is_from_views = true;
        self.stats = stats_of(&state.counts);
        self.values = state.values.iter().copied().collect();
        for &side in Side::ALL {
            let hands = state.hands.iter().map(ViewHand::pose);
            let known = &self.poses[side.index()];
            match hands.into_iter().find(|pose| pose.side == side) {
                // A press causes a view of its own, which shows the hand of the previous view.
                Some(pose) if known.is_some_and(|known| known.time == pose.time) => {}
                Some(pose) => self.set_pose(&pose),
                None if state.state == PipelineState::Running => self.poses[side.index()] = None,
                None => {}
            }
        }
        if state.hands.is_empty() {
            self.history.push_gap(state.time_us);
        } else if state.time_us != before.time_us {
            self.history.push(Moment {
                time: state.time_us,
                degrees: [f32::NAN; Dof::COUNT],
                heights_mm: self.heights_mm(),
                pressing: self.pressing(),
                latency_ms: f32::NAN,
            });
        }
        self.remember_keys(&before.keys, &state);
    }

    /// Adds a press for each key that is down only in the new view, and a release for each key that is down only in the previous view.
    fn remember_keys(&mut self, before: &[KeyCode], state: &ViewState) {
        // A view without a hand may have no time.
        let end = self.history.end().filter(|_| state.hands.is_empty());
        let time = state.time_us.max(end.unwrap_or_default());
        let event = |key: &KeyCode, is_press| SentEvent {
            time,
            key: SentKey::Code(*key),
            is_press,
        };
        for key in before.iter().filter(|key| !state.keys.contains(key)) {
            self.history.push_event(event(key, false));
        }
        for key in state.keys.iter().filter(|key| !before.contains(key)) {
            self.history.push_event(event(key, true));
        }
    }

    /// Adds the results of a step.
    pub fn update(&mut self, snapshot: &Snapshot) {
        self.catch_up(snapshot);
        self.stats = snapshot.stats;
        if snapshot.pose.is_some() {
            self.rejected_before = snapshot.stats.rejected;
        }
        if let Some(latency) = snapshot.latency {
            self.latency.push(latency);
        }
        let reading = snapshot.reading.as_ref();
        if reading.is_none_or(|it| self.sensors.is_of(it)) {
            if let Some(reading) = reading
                && let Sample::Channels(channels) = &reading.sample
            {
                self.sensors.update(reading.time, channels);
            }
            self.angles = snapshot.angles.or(self.angles);
        }
        match &snapshot.pose {
            Some(pose) => self.set_pose(pose),
            None if snapshot.state != PipelineState::Running => self.clear_contacts(),
            None => {}
        }
        for (pose, is_lost) in self.poses.iter_mut().zip(snapshot.lost_hands) {
            *pose = pose.filter(|_| !is_lost);
        }
        // A snapshot may be older than the view, and the step that exchanges layouts resets controls of the previous layout, whose targets
        // have the ids of others now.
        if snapshot.target_names == self.target_names {
            self.keep_contacts(snapshot);
            self.keep_values(snapshot);
        }
        self.remember(snapshot);
    }

    fn keep_contacts(&mut self, snapshot: &Snapshot) {
        for touch in &snapshot.touches {
            let contact = &mut self.contacts[touch.side.index()][touch.finger.index()];
            let pressed = &self.view.state.pressed;
            let was_pressed = match &*contact {
                Some(known) => known.is_pressed,
                // The press was missed.
                None => touch.phase == Phase::Moved && pressed.contains(&touch.target),
            };
            *contact = match touch.phase {
                Phase::Left | Phase::Cancelled => None,
                phase => Some(Contact {
                    target: touch.target,
                    depth: touch.depth,
                    is_pressed: match phase {
                        Phase::Pressed => true,
                        Phase::Released => false,
                        _ => was_pressed,
                    },
                }),
            };
        }
    }

    fn keep_values(&mut self, snapshot: &Snapshot) {
        for event in &snapshot.events {
            if let EventKind::Value(target, value) = event.kind {
                self.values.insert(target, value);
            }
        }
    }

    fn set_pose(&mut self, pose: &HandPose) {
        self.poses[pose.side.index()] = Some(*pose);
        for &finger in Finger::ALL {
            let trail = &mut self.trails[pose.side.index()][finger.index()];
            match pose.fingertip(finger).filter(|_| !pose.jumped) {
                Some(tip) => trail.push(pose.time, tip),
                None => trail.clear(),
            }
        }
    }

    fn clear_contacts(&mut self) {
        self.contacts = Default::default();
    }

    fn remember(&mut self, snapshot: &Snapshot) {
        if snapshot.pose.is_none() && snapshot.state != PipelineState::Running {
            let released = snapshot.events.first().map(|event| event.time);
            self.history.push_gap(released.unwrap_or_default());
        }
        if let (Some(pose), Some(_)) = (&snapshot.pose, &snapshot.angles) {
            self.history.push(Moment {
                time: pose.time,
                degrees: self.degrees(),
                heights_mm: self.heights_mm(),
                pressing: self.pressing(),
                latency_ms: snapshot
                    .latency
                    .map_or(f32::NAN, |latency| latency.as_secs_f32() * 1e3),
            });
        }
        self.history.push_values(snapshot);
        for event in snapshot.events.iter().filter_map(SentEvent::new) {
            self.history.push_event(event);
        }
    }

    /// Returns the angles of the first hand in degrees; NaN for those that are not known, and for all while it is lost.
    fn degrees(&self) -> [f32; Dof::COUNT] {
        let first = self.sensors.side_of_two();
        let is_lost = first.is_some_and(|side| self.poses[side.index()].is_none());
        let angles = self.angles.filter(|_| !is_lost);
        std::array::from_fn(|index| {
            let dof = Dof::ALL[index];
            let known = angles.filter(|it| it.is_known(dof));
            known.map_or(f32::NAN, |it| it.get(dof).to_degrees() as f32)
        })
    }

    /// Returns the heights of the pads of all fingertips over the first board; NaN for those that are not known.
    fn heights_mm(&self) -> [[f32; Finger::COUNT]; Side::COUNT] {
        let mut heights = [[f32::NAN; Finger::COUNT]; Side::COUNT];
        let Some(world_from_board) = self.world_from_board(0) else {
            return heights;
        };
        let surface_from_world = world_from_board.inverse();
        for pose in self.poses.iter().flatten() {
            for &finger in Finger::ALL {
                if let Some(tip) = pose.fingertip(finger) {
                    let height = (surface_from_world * tip).z - pose.tip_radius;
                    heights[pose.side.index()][finger.index()] = height * 1e3;
                }
            }
        }
        heights
    }

    /// Returns the fingers that press a target, by side.
    fn pressing(&self) -> [FingerSet; Side::COUNT] {
        self.contacts.map(|contacts| {
            let fingers = Finger::ALL.iter().copied().zip(contacts);
            let pressing =
                fingers.filter(|(_, contact)| contact.is_some_and(|contact| contact.is_pressed));
            pressing.fold(FingerSet::NONE, |set, (finger, _)| set.with(finger))
        })
    }

    /// Returns the present pose of a board in the world, or `None` while the hand that it follows is not known.
    pub fn world_from_board(&self, index: usize) -> Option<Pose> {
        let surface = self.view.layout.scene.surfaces().get(index)?;
        let anchor_from_board = self.view.boards.get(index)?;
        let origin = match surface.anchor() {
            Anchor::World => Vec3::ZERO,
            anchor @ (Anchor::Joint(_) | Anchor::Start | Anchor::OtherHand | Anchor::Body(_)) => {
                let is_own = |pose: &&HandPose| surface.side().is_none_or(|side| side == pose.side);
                let mut poses = self.poses.iter().rev().flatten().filter(is_own);
                poses.find_map(|pose| anchor.position(pose, surface.side().is_none()))?
            }
        };
        let translation = origin + anchor_from_board.translation;
        Some(Pose::from_parts(translation, anchor_from_board.rotation))
    }

    /// Returns the most frequent reason for which readings since the latest pose were rejected; `None` if none arrived.
    pub fn latest_rejection(&self) -> Option<Rejection> {
        let counts = self.stats.rejected.iter().zip(self.rejected_before);
        let counts = counts.map(|(now, before)| now.saturating_sub(before));
        let most = counts.zip(Rejection::ALL).max_by_key(|(count, _)| *count);
        most.filter(|(count, _)| *count > 0)
            .map(|(_, reason)| *reason)
    }

    /// Returns the deepest contact with a target.
    pub fn contact_with(&self, target: TargetId) -> Option<Contact> {
        let contacts = self.contacts.iter().flatten().flatten();
        let own = contacts.filter(|contact| contact.target == target);
        let deepest = own.copied().max_by(|a, b| a.depth.total_cmp(&b.depth));
        let is_pressed = self.is_from_views && self.view.state.pressed.contains(&target);
        deepest.or_else(|| {
            is_pressed.then_some(Contact {
                target,
                depth: 1.0,
                is_pressed,
            })
        })
    }
}

/// Returns the statistics that the counts of a view have: all but reasons.
fn stats_of(counts: &ViewCounts) -> Stats {
    let mut stats = Stats {
        accepted: counts.accepted,
        stalls: counts.stalls,
        dropped_presses: counts.dropped_presses,
        ..Stats::default()
    };
    stats.source.readings = counts.received;
    stats.source.dropped = counts.dropped;
    stats.source.losses = counts.losses;
    stats
}

#[cfg(test)]
pub(crate) mod tests {
    use ademan_core::contact::Touch;
    use ademan_core::device::{EventKind, OutputEvent};
    use ademan_core::hand::Joint;
    use ademan_core::layout::Layout;
    use ademan_core::time::Timestamp;
    use ademan_runtime::files::Load;
    use parry3d::math::Vec2;

    use super::*;
    use crate::scene::tests::model_of;

    fn model() -> StudioModel {
        model_of(Arc::new(Layout::load("qwerty-flat").unwrap()))
    }

    pub(crate) fn hand(seconds: u64) -> HandPose {
        let mut pose = HandPose::new(Timestamp(seconds * 1_000_000), Side::Right, 0.005);
        pose.set(Joint::Elbow, Pose::from_translation(Vec3::ZERO));
        let tip = Joint::tip(Finger::Index);
        pose.set(tip, Pose::from_translation(Vec3::new(0.0, 0.3, 0.0)));
        pose
    }

    fn key() -> KeyCode {
        "A".parse().unwrap()
    }

    /// Returns the view of a session in another process, with a key that is down while the hand is there.
    fn view(model: &StudioModel, state: PipelineState, seconds: Option<u64>) -> View {
        let mut new = ViewState::starting("", "", "");
        new.state = state;
        if let Some(time) = seconds {
            let pose = hand(time);
            new.time_us = pose.time;
            new.hands = vec![ViewHand::from(&pose)];
            new.keys = vec![key()];
        }
        View {
            state: Arc::new(new),
            ..model.view.clone()
        }
    }

    fn knows_heights(moment: &Moment) -> bool {
        moment.heights_mm.iter().flatten().any(|mm| !mm.is_nan())
    }

    #[test]
    fn a_watched_session_that_pauses_or_ends_keeps_its_hand_and_its_scope() {
        for state in [
            PipelineState::Paused,
            PipelineState::Stalled,
            PipelineState::Stopped,
        ] {
            let mut model = model();
            for second in 1..=5 {
                let next = view(&model, PipelineState::Running, Some(second));
                model.update_from_view(next);
            }
            for _ in 0..3 {
                let next = view(&model, state, None);
                model.update_from_view(next);
            }
            assert!(model.world_from_board(0).is_some(), "{state}");
            let moments: Vec<&Moment> = model.history.moments().collect();
            let known = moments.iter().filter(|moment| knows_heights(moment));
            assert_eq!((known.count(), moments.len()), (5, 6), "{state}");
            assert!(!knows_heights(moments[5]), "{state}");
            let last = model.history.events().last().unwrap();
            assert_eq!((last.is_press, last.time), (false, Timestamp(5_000_000)));
            let next = view(&model, PipelineState::Running, Some(9));
            model.update_from_view(next);
            assert_eq!(model.history.moments().count(), 7, "{state}");
        }
    }

    #[test]
    fn a_hand_that_a_running_session_has_lost_is_not_shown() {
        let mut model = model();
        for seconds in [Some(1), None] {
            let next = view(&model, PipelineState::Running, seconds);
            model.update_from_view(next);
            let is_shown = model.poses.iter().any(Option::is_some);
            assert_eq!(is_shown, seconds.is_some());
        }
    }

    pub(crate) fn snapshot(state: PipelineState) -> Snapshot {
        Snapshot {
            state,
            ..Snapshot::default()
        }
    }

    #[test]
    fn a_press_ends_where_readings_end() {
        let mut model = model();
        let touch = Touch {
            time: Timestamp(1_000_000),
            side: Side::Right,
            finger: Finger::Index,
            target: TargetId(0),
            phase: Phase::Pressed,
            depth: 1.0,
            position: Vec2::ZERO,
        };
        model.update(&Snapshot {
            pose: Some(hand(1)),
            angles: Some(JointAngles::default()),
            target_names: model.target_names.clone(),
            touches: [touch].into_iter().collect(),
            ..snapshot(PipelineState::Running)
        });
        let release = OutputEvent {
            time: Timestamp(1_200_000),
            kind: EventKind::KeyUp(key()),
        };
        model.update(&Snapshot {
            events: [release].into_iter().collect(),
            ..snapshot(PipelineState::Stalled)
        });
        model.update(&snapshot(PipelineState::Paused));
        let moments: Vec<&Moment> = model.history.moments().collect();
        assert_eq!(moments.len(), 2);
        let presses = moments
            .iter()
            .map(|moment| moment.pressing[1].contains(Finger::Index));
        assert_eq!(presses.collect::<Vec<_>>(), [true, false]);
        assert_eq!(moments[1].time, release.time);
        assert!(!knows_heights(moments[1]));
    }
}
