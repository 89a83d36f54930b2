//! The session loop's end of the views. It collects the state that a view shows, and publishes it when something has changed or a
//! view is due.

use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use arrayvec::ArrayVec;
use parry3d::math::Pose;

use super::board_poses;
use super::state::{FingerBend, Fingertip, ViewCounts, ViewState};
use crate::session::latest::LatestSender;
use crate::session::observer::Observer;
use crate::sim::UsTextField;
use ademan_core::command::CommandOrigin;
use ademan_core::contact::TargetId;
use ademan_core::device::pressed_keys::PressedKeys;
use ademan_core::device::{Axis, CursorPosition, EventKind, KeyCode};
use ademan_core::hand::Side;
use ademan_core::kinematics::HandPose;
use ademan_core::layout::Layout;
use ademan_core::pipeline::{LayoutInstance, Pipeline, PipelineState};
use ademan_core::snapshot::StepView;
use ademan_core::time::Timestamp;

/// Time between two views while nothing is pressed or released.
const PERIOD: Duration = Duration::from_millis(33);

/// Time over which the rate of readings is measured.
const RATE_PERIOD: Duration = Duration::from_secs(1);

/// Maximum number of keys and characters in [`ViewState::recent`].
const MAX_RECENT: usize = 24;

/// The longest [`ViewState::typed`], in bytes: a line of a wide terminal.
const MAX_TYPED_BYTES: usize = 240;

/// Values of controls for which there is room from the start: more than panels have.
const VALUES: usize = 64;

/// The maximum distance of a fingertip from a board that a view shows, in metres.
const MAX_HEIGHT: f32 = 0.3;

/// The maximum number of fingertips in a view: ten fingertips over eight boards.
const MAX_FINGERTIPS: usize = 80;

/// A layout and the state of the session that uses it.
pub(super) struct Published {
    pub layout: Arc<Layout>,
    pub boards: Arc<[Pose]>,
    /// The poses of the hands that are tracked.
    pub poses: [Option<HandPose>; Side::COUNT],
    /// The state, without its hands.
    pub state: ViewState,
}

/// Publishes views of the session loop. A step with a reading allocates only while there is a viewer, and for the values of more
/// than [`VALUES`] controls.
pub(in crate::session) struct ViewPublisher {
    views: LatestSender<Published>,
    /// The number of viewers.
    viewers: Arc<AtomicUsize>,
    /// The names of the profiles, the source and the outputs.
    names: SessionNames,
    layout: Arc<Layout>,
    profile: usize,
    /// The state of the last step, and the origin of a pause. The end of a pause changes the state only with the next reading.
    state: (PipelineState, Option<CommandOrigin>),
    poses: [Option<HandPose>; Side::COUNT],
    /// Time of the last reading of a hand.
    time: Timestamp,
    keys: PressedKeys,
    recent: ArrayVec<EventKind, MAX_RECENT>,
    typed: UsTextField,
    values: Vec<(TargetId, f32)>,
    axes: [f32; Axis::COUNT],
    selected: ArrayVec<TargetId, 8>,
    rate: Rate,
    last_published: Option<Instant>,
}

/// Names that do not change.
pub(in crate::session) struct SessionNames {
    /// Name of the session.
    pub session: String,
    /// Id of its process; `None` for a recording.
    pub process: Option<u32>,
    /// Names of the profiles, in order.
    pub profiles: Vec<String>,
    /// Name of the source.
    pub source: String,
    /// Names of the outputs.
    pub output: String,
}

impl ViewPublisher {
    pub(super) fn new(
        views: LatestSender<Published>,
        viewers: Arc<AtomicUsize>,
        names: SessionNames,
        layout: Arc<Layout>,
    ) -> Self {
        Self {
            views,
            viewers,
            names,
            layout,
            profile: 0,
            state: (PipelineState::Starting, None),
            poses: [None; Side::COUNT],
            time: Timestamp::default(),
            keys: PressedKeys::default(),
            recent: ArrayVec::new(),
            typed: UsTextField::with_capacity(MAX_TYPED_BYTES),
            values: Vec::with_capacity(VALUES),
            axes: [0.0; Axis::COUNT],
            selected: ArrayVec::new(),
            rate: Rate::default(),
            last_published: None,
        }
    }

    /// Keeps the latest pose of each hand that is tracked, and the time.
    fn update_poses(&mut self, step: &StepView) {
        if let Some(pose) = step.pose {
            self.poses[pose.side.index()] = Some(*pose);
        } else if step.state != PipelineState::Running {
            self.poses = Default::default();
        }
        for (pose, is_lost) in self.poses.iter_mut().zip(step.lost_hands) {
            if is_lost {
                *pose = None;
            }
        }
        let times = self.poses.iter().flatten().map(|pose| pose.time);
        self.time = times.max().unwrap_or(self.time);
    }

    /// Returns `true` if another layout became active.
    fn update_layout(&mut self, pipeline: &Pipeline) -> bool {
        let layout = pipeline.layout().layout();
        let Some(layout) = layout.filter(|layout| !Arc::ptr_eq(layout, &self.layout)) else {
            return false;
        };
        self.layout = Arc::clone(layout);
        self.profile = pipeline.active_profile();
        // These belong to targets of the previous layout.
        self.values.clear();
        self.selected.clear();
        true
    }

    /// Returns `true` if a key or target is pressed or released.
    fn handle(&mut self, event: EventKind) -> bool {
        match event {
            EventKind::KeyDown(key) => {
                self.keys.press(key);
                self.remember(event);
            }
            EventKind::KeyUp(key) => _ = self.keys.release(key),
            EventKind::Character(_) => self.remember(event),
            EventKind::Select(target) => _ = self.selected.try_push(target),
            EventKind::Unselect(target) => self.selected.retain(|selected| *selected != target),
            EventKind::Value(target, value) => {
                let known = self.values.iter_mut().find(|(known, _)| *known == target);
                match known {
                    Some((_, known)) => *known = value,
                    None => self.values.push((target, value)),
                }
                return false;
            }
            EventKind::Axis(axis, value) => {
                self.axes[axis.index()] = value;
                return false;
            }
            _ => return false,
        }
        true
    }

    fn remember(&mut self, event: EventKind) {
        if self.recent.is_full() {
            self.recent.remove(0);
        }
        self.recent.push(event);
    }

    fn publish(&self, step: &StepView, pipeline: &Pipeline) {
        let active = pipeline.layout();
        let CursorPosition {
            fractions,
            in_spaces,
        } = active.cursor().unwrap_or_default();
        let profile = self.names.profiles.get(self.profile);
        let axes = Axis::ALL
            .iter()
            .map(|axis| (*axis, self.axes[axis.index()]));
        let mut keys: Vec<KeyCode> = self.keys.release_order().collect();
        keys.reverse();
        let state = ViewState {
            name: self.names.session.clone(),
            process: self.names.process,
            time_us: self.time,
            state: step.state,
            paused_by: step.paused_by,
            profile: profile.cloned().unwrap_or_default(),
            source: self.names.source.clone(),
            // The hub adds it.
            headset: None,
            output: self.names.output.clone(),
            readings_per_second: self.rate.per_second,
            counts: ViewCounts::from(step.stats),
            awaits_hand: pipeline.awaits_start(),
            // The hub adds them.
            hands: Vec::new(),
            fingertips: self.fingertips(active),
            bends: bends(pipeline).collect(),
            pressed: active.pressed_targets().collect(),
            keys,
            recent: self.recent.iter().filter_map(key_name).collect(),
            typed: self.typed.text().to_owned(),
            text_mode: step.text.map(|text| text.mode),
            candidates: step.text.map_or(Vec::new(), |text| {
                text.candidates.iter().map(ToString::to_string).collect()
            }),
            values: self.values.clone(),
            axes: axes.filter(|(_, value)| *value != 0.0).collect(),
            pointer: fractions.map(|position| position.to_array()),
            in_spaces_mm: in_spaces
                .iter()
                .map(|position| position.map(|position| (position * 1e3).to_array()))
                .collect(),
            selected: self.selected.to_vec(),
        };
        let layout = Arc::clone(&self.layout);
        let boards = board_poses(active.scene());
        self.views.send(Published {
            layout,
            boards,
            poses: self.poses,
            state,
        });
    }

    fn fingertips(&self, active: &LayoutInstance) -> Vec<Fingertip> {
        let poses = self.poses.iter().flatten();
        let fingertips = poses.flat_map(|pose| {
            let hovers = self.layout.hovers(active.scene(), pose).into_iter();
            hovers.map(|hover| Fingertip {
                side: pose.side,
                finger: hover.finger,
                board: hover.board,
                x_mm: hover.row_position.x * 1e3,
                y_mm: hover.row_position.y * 1e3,
                height_mm: hover.height * 1e3,
            })
        });
        let near = fingertips.filter(|tip| tip.height_mm.abs() < MAX_HEIGHT * 1e3);
        near.take(MAX_FINGERTIPS).collect()
    }
}

/// Collects the changes, and publishes a view if it is due.
impl Observer for ViewPublisher {
    fn observe(&mut self, step: &StepView, now: Instant, pipeline: &Pipeline) {
        let state = (step.state, step.paused_by);
        let is_new_state = mem::replace(&mut self.state, state) != state;
        let mut is_pressed = false;
        for event in step.events {
            self.typed.handle(event);
            is_pressed |= self.handle(event.kind);
        }
        // After the events, which have targets of the layout before.
        let is_new_layout = self.update_layout(pipeline);
        if step.reading.is_none() && !pipeline.expects_readings() {
            // No step follows that would measure it.
            self.rate = Rate::default();
        }
        self.rate.update(step.stats.source.readings, now);
        if self.viewers.load(Ordering::Relaxed) == 0 {
            // The next viewer must not see an old pose. While no reading comes, no view follows the first one.
            self.poses = Default::default();
            if step.reading.is_none() {
                self.publish(step, pipeline);
            }
            return;
        }
        self.update_poses(step);
        let is_due = |last: Instant| now.duration_since(last) >= PERIOD;
        let is_due = self.last_published.is_none_or(is_due);
        if is_due || is_pressed || is_new_state || is_new_layout {
            self.last_published = Some(now);
            self.publish(step, pipeline);
        }
    }
}

fn bends(pipeline: &Pipeline) -> impl Iterator<Item = FingerBend> {
    let bends = pipeline.finger_bends();
    bends.map(|(side, finger, bend, target)| FingerBend {
        side,
        finger,
        bend,
        press_at: target.press_at,
        release_at: target.release_at,
    })
}

fn key_name(event: &EventKind) -> Option<String> {
    match event {
        EventKind::KeyDown(key) => Some(key.name().to_owned()),
        EventKind::Character(character) => Some(character.to_string()),
        _ => None,
    }
}

/// The number of readings per second.
#[derive(Default)]
struct Rate {
    per_second: f32,
    since: Option<(Instant, u64)>,
}

impl Rate {
    /// Updates the rate with the number of readings so far.
    fn update(&mut self, readings: u64, now: Instant) {
        let (since, before) = *self.since.get_or_insert((now, readings));
        let elapsed = now.duration_since(since);
        if elapsed >= RATE_PERIOD {
            self.per_second = readings.saturating_sub(before) as f32 / elapsed.as_secs_f32();
            self.since = Some((now, readings));
        }
    }
}
