//! One hand of a fluent typist.

use std::collections::BTreeMap;

use parry3d::math::{Vec2, Vec3};

use super::aim::Aim;
use super::sensors::{SourceKind, SourceModel};
use super::timeline::Timeline;
use crate::contact::TargetId;
use crate::contact::surface::{Anchor, Scene};
use crate::estimate::{ChannelMap, Estimator, EstimatorSettings, JointAngles, Smoothing};
use crate::hand::{Finger, Joint, Side};
use crate::kinematics::{ArmModel, HandPose, StartPlace, typing_angle};
use crate::layout::{Motion, Tremor};
use crate::people::{Draw, Participant};
use crate::sim::assignment::FingerAssignment;
use crate::sim::motor::TypingKeys;
use crate::sim::typing_hand::TypingHand;
use crate::sim::unsteadiness::Unsteadiness;

/// Flexion of the knuckles of fingers that are out of the way, in radians.
const RAISED: f64 = -0.5;
/// Bend of fingers that do not press by bending, as a fraction of their range.
pub(super) const STRAIGHT: f64 = 0.1;
/// Frequency of the sway of an unsupported arm, in hertz: below 2 Hz.
const SWAY_HZ: f64 = 0.8;

/// A planned stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct StrokePlan {
    /// The intended target; the first one of a chord.
    pub target: TargetId,
    /// The finger; the first one of a chord.
    pub finger: Finger,
    /// The time of the lowest point, in seconds.
    pub bottom: f64,
    /// The time at which the finger is up again, in seconds.
    pub end: f64,
    /// The distance that the hand moves for it, in metres.
    pub distance: f64,
    /// The position of the tap relative to the center of the target, in metres; zero for bends.
    pub point: Vec2,
}

/// The load of the joints of a hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// The sum of all turns of all joints, in radians.
    pub travel: f64,
    /// The time in which a joint was outside its comfortable range, in seconds.
    pub uncomfortable: f64,
    /// The time, in seconds.
    pub seconds: f64,
}

impl Load {
    /// Adds the load of another hand.
    pub fn add(&mut self, other: Self) {
        self.travel += other.travel;
        self.uncomfortable += other.uncomfortable;
        self.seconds += other.seconds;
    }
}

/// A hand with its arm, its sensors and its habits.
#[derive(Clone)]
pub struct FluentHand {
    pub(super) side: Side,
    pub(super) person: Participant,
    pub(super) own: ArmModel,
    pub(super) assumed: ArmModel,
    /// An estimator without filters: the hand as the program shows it.
    pub(super) unfiltered: Estimator,
    pub(super) sensors: SourceModel,
    /// The hand for each pressing finger: the others are out of its way.
    fingers: Vec<TypingHand>,
    keys: TypingKeys,
    pub(super) aims: BTreeMap<(TargetId, Finger), Aim>,
    pub(super) references: [Option<Vec3>; Finger::COUNT],
    pub(super) start: StartPlace,
    pub(super) timeline: Timeline,
    /// The posture at the start.
    pub(super) initial: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) unsteadiness: [Unsteadiness; 2],
    pub(super) drift: Vec2,
    pub(super) draw: Draw,
    /// The position of the hand above the last target, given by its index fingertip (world, metres).
    pub(super) last_place: Option<Vec3>,
    /// The target and the finger of the last tap, and its position relative to the center of the target.
    pub(super) last_tap: Option<(TargetId, Finger, Vec2)>,
    /// The time from which the hand is free for the next target.
    pub(super) free_at: f64,
    pub(super) last_angles: Option<JointAngles>,
    /// The hand with half bent fingers.
    pub(super) half_bent: HandPose,
    /// The load so far.
    pub load: Load,
}

/// The posture of a hand at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartPosture {
    /// Above the keys.
    Relaxed,
    /// Straight fingers, which press by bending.
    Straight,
    /// Open and still, where a board is placed below it.
    Open,
}

/// The parts of a hand.
#[derive(Clone, Copy, Debug)]
pub struct HandSetup<'a> {
    /// The arm that the pipeline assumes.
    pub assumed: &'a ArmModel,
    /// The arm of the person.
    pub own: &'a ArmModel,
    /// The channels of a glove.
    pub map: Option<&'a ChannelMap>,
    /// The sensors.
    pub source: SourceKind,
}

impl FluentHand {
    /// Creates a hand of a person at time 0. [`restart`](Self::restart) begins a run.
    pub fn new(
        setup: HandSetup,
        person: &Participant,
        keys: &TypingKeys,
        posture: StartPosture,
    ) -> Self {
        let side = setup.assumed.side();
        let map = setup.map.filter(|_| setup.source.is_glove());
        let hand = match map {
            Some(map) => TypingHand::new(setup.own, map),
            None => TypingHand::without_glove(setup.own),
        };
        let fingers: Vec<TypingHand> = Finger::ALL
            .iter()
            .map(|finger| pressing_with(&hand, *finger))
            .collect();
        let estimator = Estimator::new(EstimatorSettings::unchecked(Smoothing::Off));
        let unfiltered = match map {
            // What the sensors show on average has no direction.
            Some(map) => estimator.with_channels(&map.clone().with_hystereses(Vec::new())),
            None => estimator,
        };
        let index = &fingers[Finger::Index.index()];
        let mut values = match posture {
            StartPosture::Open => index.open_values(),
            _ => index.rest_values(),
        };
        if posture == StartPosture::Straight {
            for &finger in Finger::ALL {
                for (channel, value) in index.values_at_bend(finger, STRAIGHT) {
                    values[channel] = value;
                }
            }
        }
        let tremor = |amplitude: f64, frequency_hz: f64, salt: u64| {
            let motion = Motion {
                tremor: Tremor {
                    amplitude: amplitude * 1e-3,
                    frequency_hz,
                },
                ..Motion::default()
            };
            Unsteadiness::new(&motion, setup.own, person.seed ^ salt)
        };
        let start = StartPlace::from_pose(&index.pose(&index.open_values()));
        Self {
            side,
            half_bent: index.half_bent_pose(),
            own: setup.own.clone(),
            assumed: setup.assumed.clone(),
            unfiltered,
            sensors: SourceModel::new(setup.source, person, map, person.seed),
            fingers,
            keys: keys.clone(),
            aims: BTreeMap::new(),
            references: [None; Finger::COUNT],
            start,
            timeline: Timeline::new(values.clone()),
            initial: values.clone(),
            values,
            unsteadiness: [
                tremor(person.tremor, person.tremor_hz, 1),
                tremor(person.sway, SWAY_HZ, 2),
            ],
            drift: Vec2::ZERO,
            draw: Draw::new(person.seed, 0x4a1d + side.index() as u64),
            person: person.clone(),
            last_place: None,
            last_tap: None,
            free_at: 0.0,
            last_angles: None,
            load: Load::default(),
        }
    }

    /// Starts another run of the same person at time 0. The person keeps what was learned. `seed` is the seed of the run.
    pub fn restart(&mut self, seed: u64) {
        self.timeline = Timeline::new(self.initial.clone());
        self.draw = Draw::new(seed, 0x4a1d + self.side.index() as u64);
        self.sensors.restart(seed ^ self.side.index() as u64);
        self.drift = Vec2::ZERO;
        self.last_place = None;
        self.last_tap = None;
        self.free_at = 0.0;
        self.last_angles = None;
    }

    /// Returns the hand that presses with a finger.
    pub(super) fn typing_hand(&self, finger: Finger) -> &TypingHand {
        &self.fingers[finger.index()]
    }

    /// Returns the side.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Returns the time from which the hand is free for the next target, in seconds.
    pub fn free_at(&self) -> f64 {
        self.free_at
    }

    /// Returns the place of the open hand at the start.
    pub fn start(&self) -> StartPlace {
        self.start
    }

    /// Sets the place of the open hand at the start, as the pipeline has seen it.
    pub fn set_start(&mut self, start: StartPlace) {
        self.start = start;
        self.aims.clear();
    }

    /// Returns the finger for a target: the finger that bends for it; the finger that the layout names; or else the first one of the
    /// person's that reaches it, if possible with the other fingers clear of keys. `None` if no finger reaches it.
    pub fn finger_for(&mut self, scene: &Scene, target: TargetId) -> Option<Finger> {
        let (surface, _) = scene.target(target)?;
        if let Some(finger) = surface.bent_by(target) {
            return Some(finger);
        }
        let mut reached = None;
        for finger in self.candidates(scene, target)? {
            let aim = self.learn(scene, target, finger);
            match aim.filter(Aim::is_reached) {
                Some(aim) if aim.is_clear => return Some(finger),
                // With other fingers on keys, if there is no better one.
                Some(_) => _ = reached.get_or_insert(finger),
                None => {}
            }
        }
        reached
    }

    fn candidates(&self, scene: &Scene, target: TargetId) -> Option<Vec<Finger>> {
        let (surface, found) = scene.target(target)?;
        let used = self.person.finger_set();
        let named = scene.finger(target);
        let named = named.filter(|finger| used.is_empty() || used.contains(*finger));
        if let Some(finger) = named {
            return Some(vec![finger]);
        }
        let hand = self.typing_hand(Finger::Index);
        if surface.anchor() == Anchor::Joint(Joint::Wrist) {
            let pose = hand.half_bent_pose();
            let world_from_surface = surface.world_from_surface(&pose)?;
            let goal = (world_from_surface * found.surface_from_target).translation;
            let distance = |finger: &Finger| {
                let tip = pose.fingertip(*finger);
                tip.map_or(f32::INFINITY, |tip| tip.distance(goal))
            };
            let all = Finger::ALL.iter().copied();
            let mut fingers: Vec<Finger> = all
                .filter(|finger| used.is_empty() || used.contains(*finger))
                .collect();
            fingers.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            return Some(fingers);
        }
        if used.is_empty() {
            return Some(vec![Finger::Index, Finger::Thumb]);
        }
        let assignment = FingerAssignment {
            hand,
            fingers: used,
            keys: &self.keys,
        };
        Some(assignment.fingers_for(surface, target))
    }
}

/// Returns a hand whose `finger` is half flexed above the keys, and whose other fingers are extended out of its way.
fn pressing_with(hand: &TypingHand, finger: Finger) -> TypingHand {
    let mut hand = hand.clone();
    for index in 0..hand.variables.len() {
        let Some((dof, map)) = hand.variables[index].mappings.first().copied() else {
            continue;
        };
        let Some(own) = dof.finger() else { continue };
        let is_knuckle = Finger::FLEXIONS[own.index()].first() == Some(&dof);
        let radians = match (own == finger, own) {
            (true, Finger::Thumb) => 0.0,
            (false, Finger::Thumb) => typing_angle(dof),
            (true, _) if Finger::FLEXIONS[own.index()].contains(&dof) => 0.45,
            (true, _) => 0.0,
            (false, _) if is_knuckle => RAISED,
            (false, _) => 0.0,
        };
        let (low, high) = hand.variables[index].range;
        hand.set_rest(index, map.apply_inverse(radians).clamp(low, high));
    }
    hand.at_rest()
}
