//! The results of each stage as JSON: the lines of `ademan trace`.
//!
//! | stage | one object per | form |
//! |---|---|---|
//! | `readings` | reading | `{"time_us":12500,"full_scale":255,"channels":[3,141]}` or `{"time_us":12500,"angles_rad":{"index-mcp-flexion":0.12}}` or `{"time_us":12500,"joints_m":{"wrist":[x,y,z]}}` or `{"time_us":12500,"side":"right","body_landmarks":[[x,y,z,confidence]]}` or `{"time_us":12500,"side":"right","bones":{"right":{"hand":[x,y,z,w]}}}` or `{"time_us":12500,"displacement":{"joint":"wrist","translation_m":[x,y,z],"rotation":[x,y,z,w]}}` |
//! | `angles` | accepted reading | `{"time_us":12500,"side":"right","angles":{"index-mcp-flexion":0.12}}` |
//! | `pose` | accepted reading | `{"time_us":12500,"side":"right","positions":{"wrist":[x,y,z]},"orientations":{"wrist":[x,y,z,w]}}` |
//! | `touches` | touch | `{"time_us":12400,"side":"right","finger":"index","target":"Q","phase":"pressed","depth":0.5,"position":[0.001,-0.002]}` |
//! | `presses` | press | `{"time_us":12400,"side":"right","finger":"index","target":"Q","point_mm":[12.1,40.3,-1.5],"depth_mm":1.5,"speed_mm_s":180.0,"neighbors":[{"target":"W","distance_mm":9.4}]}` |
//! | `events` | event | `{"time_us":12400,"event":"key-down","key":"Q"}`, `{"time_us":12400,"event":"depth","target":"ArrowUp","depth":0.5}` |
//! | `commands` | command | `{"time_us":12400,"command":"nudge","x_mm":0.0,"y_mm":0.0,"z_mm":-5.0}` |
//!
//! A command from outside the layout, such as one of `ademan ctl`, has `"origin":"external"`.
//!
//! Times are in microseconds, channels in wire order, angles in radians for the joints that the source measures. Positions
//! are in metres and orientations are unit quaternions in the world frame, for the joints of the arm model. A target has the
//! name from the layout, or its index if it has none. Objects keep their order and numbers their full precision.

pub mod bvh;
pub mod hand_signals;
pub mod signal;

use arrayvec::ArrayVec;
use serde::{Serialize, Serializer};

use crate::capture::{Reading, recording};
use ademan_core::command::Command;
use ademan_core::contact::press::MAX_NEIGHBORS;
use ademan_core::contact::{Neighbor, Press, TargetName, TargetNames};
use ademan_core::device::{OutputEvent, TimedCommand};
use ademan_core::estimate::JointAngles;
use ademan_core::hand::{Finger, Side};
use ademan_core::kinematics::HandPose;
use ademan_core::names::named_enum;
use ademan_core::objects::{EventObject, TouchObject, write_pose};
use ademan_core::snapshot::Snapshot;
use ademan_core::time::Timestamp;

const MM_PER_METRE: f32 = 1e3;

named_enum! {
    /// A stage with observable results, in the order of the data flow.
    pub enum Stage ("stage") {
        /// Readings of the sensor.
        Readings = "readings",
        /// Joint angles.
        Angles = "angles",
        /// Poses of arm and hand.
        Pose = "pose",
        /// Touches of the fingertips.
        Touches = "touches",
        /// Presses among the touches, with their evidence.
        Presses = "presses",
        /// Events sent to the output.
        Events = "events",
        /// Commands that the layout issued, and those from outside that the pipeline executed.
        Commands = "commands",
    }
}

impl Stage {
    /// Calls `write` with the time and the JSON of each result in `snapshot`, without line ends. `buffer` is overwritten.
    pub fn for_each_json<E>(
        self,
        snapshot: &Snapshot,
        buffer: &mut Vec<u8>,
        mut write: impl FnMut(Timestamp, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let names = &snapshot.target_names;
        match self {
            Self::Readings => snapshot
                .reading
                .iter()
                .try_for_each(|reading| write(reading.time, reading_json(reading, buffer))),
            Self::Angles => {
                let mut hands = snapshot.angles.iter().zip(&snapshot.pose);
                hands.try_for_each(|(angles, pose)| {
                    write(pose.time, angles_json(pose, angles, buffer))
                })
            }
            Self::Pose => snapshot
                .pose
                .iter()
                .try_for_each(|pose| write(pose.time, pose_json(pose, buffer))),
            Self::Touches => snapshot.touches.iter().try_for_each(|touch| {
                write(touch.time, json(&TouchObject::new(touch, names), buffer))
            }),
            Self::Presses => snapshot.presses.iter().try_for_each(|press| {
                write(press.time, json(&PressJson::new(press, names), buffer))
            }),
            Self::Events => snapshot
                .events
                .iter()
                .try_for_each(|event| write(event.time, event_json(event, names, buffer))),
            Self::Commands => {
                let issued = snapshot.commands.iter();
                issued
                    .clone()
                    .try_for_each(|issued| write(issued.time, command_json(issued, buffer)))?;
                snapshot.executed.iter().try_for_each(|executed| {
                    let object = CommandJson::new(executed, Some(recording::EXTERNAL_ORIGIN));
                    write(executed.time, json(&object, buffer))
                })
            }
        }
    }
}

/// Returns the object of [`Stage::Readings`] without a line end. `buffer` is overwritten.
pub fn reading_json<'a>(reading: &Reading, buffer: &'a mut Vec<u8>) -> &'a [u8] {
    json(reading, buffer)
}

/// Returns the object of [`Stage::Angles`] for a pose and its angles, without a line end. `buffer` is overwritten.
pub fn angles_json<'a>(pose: &HandPose, angles: &JointAngles, buffer: &'a mut Vec<u8>) -> &'a [u8] {
    let angles = AnglesJson {
        time_us: pose.time,
        side: pose.side,
        angles,
    };
    json(&angles, buffer)
}

/// Returns the object of [`Stage::Pose`] without a line end. `buffer` is overwritten.
pub fn pose_json<'a>(pose: &HandPose, buffer: &'a mut Vec<u8>) -> &'a [u8] {
    write_pose(pose, buffer);
    buffer
}

/// Returns one object of [`Stage::Events`] without a line end. `names` has the names of the targets; `buffer` is overwritten.
pub fn event_json<'a>(
    event: &OutputEvent,
    names: &TargetNames,
    buffer: &'a mut Vec<u8>,
) -> &'a [u8] {
    json(&EventObject::new(event, names), buffer)
}

/// Returns one object of [`Stage::Commands`] without a line end. `buffer` is overwritten.
pub fn command_json<'a>(issued: &TimedCommand, buffer: &'a mut Vec<u8>) -> &'a [u8] {
    json(&CommandJson::new(issued, None), buffer)
}

fn json<'a>(value: &impl Serialize, buffer: &'a mut Vec<u8>) -> &'a [u8] {
    buffer.clear();
    serde_json::to_writer(&mut *buffer, value)
        .expect("a vector accepts all bytes, and every key is a string");
    buffer
}

#[derive(Serialize)]
struct AnglesJson<'a> {
    time_us: Timestamp,
    side: Side,
    #[serde(serialize_with = "known_angles")]
    angles: &'a JointAngles,
}

fn known_angles<S: Serializer>(angles: &&JointAngles, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(angles.known())
}

/// The object of [`Stage::Presses`].
#[derive(Serialize)]
pub(crate) struct PressJson<'a> {
    time_us: Timestamp,
    side: Side,
    finger: Finger,
    target: TargetName<'a>,
    point_mm: [f32; 3],
    depth_mm: f32,
    speed_mm_s: f32,
    neighbors: ArrayVec<NeighborJson<'a>, MAX_NEIGHBORS>,
}

#[derive(Serialize)]
struct NeighborJson<'a> {
    target: TargetName<'a>,
    distance_mm: f32,
}

impl<'a> PressJson<'a> {
    /// Creates the object of a press. `names` has the names of the targets.
    pub(crate) fn new(press: &Press, names: &'a TargetNames) -> Self {
        let neighbor = |neighbor: &Neighbor| NeighborJson {
            target: names.get(neighbor.target),
            distance_mm: neighbor.distance * MM_PER_METRE,
        };
        Self {
            time_us: press.time,
            side: press.side,
            finger: press.finger,
            target: names.get(press.target),
            point_mm: (press.point * MM_PER_METRE).to_array(),
            depth_mm: press.depth * MM_PER_METRE,
            speed_mm_s: press.speed * MM_PER_METRE,
            neighbors: press.neighbors.iter().map(neighbor).collect(),
        }
    }
}

#[derive(Serialize)]
struct CommandJson {
    time_us: Timestamp,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<&'static str>,
    #[serde(flatten)]
    command: Command,
}

impl CommandJson {
    fn new(issued: &TimedCommand, origin: Option<&'static str>) -> Self {
        Self {
            time_us: issued.time,
            origin,
            command: issued.command,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channels, Sample};
    use ademan_core::contact::{Phase, Presses, TargetId, Touch, Touches};
    use ademan_core::device::{Axis, EventKind, Events, TimedCommands};
    use ademan_core::hand::{Dof, Joint};
    use parry3d::math::{Pose, Vec2, Vec3};
    use serde_json::Value;
    use std::convert::Infallible;

    fn snapshot() -> Snapshot {
        let time = Timestamp(12_500);
        let counts = [3, 141].into_iter().collect();
        let channels = Channels {
            full_scale: 255,
            counts,
            unsent: Default::default(),
        };
        let mut angles = JointAngles::default();
        angles.set(Dof::IndexMcpFlexion, 0.1 + 0.2);
        angles.set(Dof::ElbowFlexion, -1.0);
        let mut pose = HandPose::new(time, Side::Right, 0.008);
        let wrist = Pose::from_translation(Vec3::new(0.1, -0.25, 1e-7));
        pose.set(Joint::Wrist, wrist);
        let touch = Touch {
            time: Timestamp(12_400),
            side: Side::Left,
            finger: Finger::Index,
            target: TargetId(7),
            phase: Phase::Pressed,
            depth: 0.5,
            position: Vec2::new(0.25, -0.5),
        };
        let neighbor = Neighbor {
            target: TargetId(8),
            distance: 0.25,
        };
        let press = Press {
            time: Timestamp(12_400),
            side: Side::Left,
            finger: Finger::Index,
            target: TargetId(7),
            point: Vec3::new(0.5, -0.25, -0.125),
            depth: 0.125,
            speed: 0.5,
            neighbors: [neighbor].into_iter().collect(),
        };
        let event = |action| OutputEvent {
            time: Timestamp(12_400),
            kind: action,
        };
        let q = "Q".parse().unwrap();
        Snapshot {
            target_names: names(),
            reading: Some(Reading::new(time, None, Sample::Channels(channels))),
            angles: Some(angles),
            pose: Some(pose),
            touches: Touches::from_iter([touch]),
            presses: Presses::from_iter([press]),
            events: Events::from_iter([
                event(EventKind::KeyUp(q)),
                event(EventKind::KeyDown(q)),
                event(EventKind::Depth(TargetId(7), 0.1)),
                event(EventKind::Character('é')),
                event(EventKind::MoveBy(-3, 4)),
                event(EventKind::MoveTo(0.5, 1.0)),
                event(EventKind::Scroll(0, 120)),
                event(EventKind::Axis(Axis::LeftX, -0.5)),
                event(EventKind::Value(TargetId(7), 0.25)),
                event(EventKind::Select(TargetId(8))),
            ]),
            commands: TimedCommands::from_iter([TimedCommand {
                time: Timestamp(12_400),
                command: Command::Nudge {
                    x_mm: 0.0,
                    y_mm: -1.5,
                    z_mm: 2.0,
                },
            }]),
            ..Snapshot::default()
        }
    }

    /// Target 7 has a name, the following ones have none.
    fn names() -> TargetNames {
        TargetNames::new((0..8).map(|number| format!("key {number}")))
    }

    fn lines(stage: Stage, snapshot: &Snapshot) -> Vec<String> {
        let mut lines = Vec::new();
        let Ok(()) = stage.for_each_json(snapshot, &mut Vec::new(), |time, json| {
            let line = String::from_utf8(json.to_vec()).unwrap();
            let object: Value = serde_json::from_str(&line).unwrap();
            assert_eq!(object["time_us"], time.0, "{line}");
            lines.push(line);
            Ok::<_, Infallible>(())
        });
        lines
    }

    #[test]
    fn objects_keep_the_order_of_their_fields_and_full_precision() {
        let expected: [&[&str]; Stage::COUNT] = [
            &[r#"{"time_us":12500,"full_scale":255,"channels":[3,141]}"#],
            &[
                r#"{"time_us":12500,"side":"right","angles":{"elbow-flexion":-1.0,"index-mcp-flexion":0.30000000000000004}}"#,
            ],
            &[
                r#"{"time_us":12500,"side":"right","positions":{"wrist":[0.1,-0.25,1e-7]},"orientations":{"wrist":[0.0,0.0,0.0,1.0]}}"#,
            ],
            &[
                r#"{"time_us":12400,"side":"left","finger":"index","target":"key 7","phase":"pressed","depth":0.5,"position":[0.25,-0.5]}"#,
            ],
            &[
                r#"{"time_us":12400,"side":"left","finger":"index","target":"key 7","point_mm":[500.0,-250.0,-125.0],"depth_mm":125.0,"speed_mm_s":500.0,"neighbors":[{"target":8,"distance_mm":250.0}]}"#,
            ],
            &[
                r#"{"time_us":12400,"event":"key-up","key":"Q"}"#,
                r#"{"time_us":12400,"event":"key-down","key":"Q"}"#,
                r#"{"time_us":12400,"event":"depth","target":"key 7","depth":0.1}"#,
                r#"{"time_us":12400,"event":"character","character":"é"}"#,
                r#"{"time_us":12400,"event":"move-by","x":-3,"y":4}"#,
                r#"{"time_us":12400,"event":"move-to","x":0.5,"y":1.0}"#,
                r#"{"time_us":12400,"event":"scroll","x":0,"y":120}"#,
                r#"{"time_us":12400,"event":"axis","axis":"LeftX","value":-0.5}"#,
                r#"{"time_us":12400,"event":"value","target":"key 7","value":0.25}"#,
                r#"{"time_us":12400,"event":"select","target":8}"#,
            ],
            &[r#"{"time_us":12400,"command":"nudge","x_mm":0.0,"y_mm":-1.5,"z_mm":2.0}"#],
        ];
        for (stage, wanted) in Stage::ALL.iter().zip(expected) {
            assert_eq!(lines(*stage, &snapshot()), wanted, "{stage}");
        }
    }

    #[test]
    fn a_stage_without_results_gives_no_json() {
        for stage in Stage::ALL {
            assert_eq!(lines(*stage, &Snapshot::default()), [""; 0], "{stage}");
        }
    }

    #[test]
    fn an_error_of_the_writer_is_returned() {
        let outcome = Stage::Events.for_each_json(&snapshot(), &mut Vec::new(), |_, _| Err("full"));
        assert_eq!(outcome, Err("full"));
    }
}
