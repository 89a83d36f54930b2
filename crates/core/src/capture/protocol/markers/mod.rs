//! Optical markers: one line of JSON per instant with what each camera sees.
//!
//! ```json
//! {"time_us":12500,"cameras":[
//!   {"position":[0,1.5,2],"markers":[{"label":"elbow","point":[0.1,1.4,1.5]}]},
//!   {"position":[2,1.5,0],"markers":[{"label":"elbow","direction":[-1,-0.2,0.1]}]},
//!   {"position":[0,2,0],"orientation":[1,0,0,0],"focal_px":[900,900],"center_px":[640,360],
//!    "markers":[{"label":"elbow","image":[612.5,401]},{"image":[655,380.5]}]}]}
//! ```
//!
//! A marker is a `point` of the image plane in space, a `direction` in space, or an undistorted `image` position, u to the
//! right and v down, which needs the `orientation` of the camera: the quaternion x, y, z, w that turns its axes (X right,
//! Y down, Z along the view) into the axes of the world. Without a focal length, image positions are for a focal length of 1.
//!
//! A label is the name of a joint (`index-finger-tip`, `RightElbow`) or one of the names of Plug-in Gait (`RSHO RELB RWRA
//! RWRB RFIN`), `wrist-a` and `wrist-b` being the two sides of the wrist: on the thumb's side and on the little finger's. One
//! camera that labels a marker is enough, and a marker keeps its label while it is [followed](MarkerTracker).
//! `time_us` is the time of a file; other transports stamp the arrival.

mod encode;
mod hand_markers;
mod line;

use self::hand_markers::{HandMarkers, MarkerSite, NOT_SEEN_BY_TWO, SeenMarker};
use self::line::Line;
use super::bone_lengths::{self, BONES};
use super::encoder::{require_defaults, time_us};
use super::line_times::LineTimes;
use super::lines::{LineDecoder, LineParser};
use super::space::{self, Facing, HAND, UP, WorldFromSource};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions,
};
use crate::capture::markers::{LiveFit, MarkerTracker, Observation};
use crate::capture::{Sample, SampleKind};
use crate::hand::Side;

pub use self::encode::encode;

/// The marker protocol.
pub const PROTOCOL: Protocol = Protocol {
    name: "markers",
    summary: "markers that two or more cameras see, as lines of JSON",
    sample: SampleKind::Joints,
    has_both_hands: false,
    has_parts: false,
    position_noise: PositionNoise::Markers,
    carriers: Carriers::Any,
    // Two cameras that see a marker.
    min_packet_bytes: 128,
    default_baud: None,
    feedback: None,
    options: &[&HAND, &UNIT, &UP, &MAX_GAP, &ELBOW_OFFSET, &BONES, &RATE],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |options| Box::new(LineDecoder::with_parser(MarkerParser::new(options))),
    encoder: |options, _| {
        require_defaults(options, &[&UNIT, &UP, &ELBOW_OFFSET])?;
        Ok(Box::new(|readings, bytes| {
            for reading in readings {
                if let Sample::Joints { positions } = &reading.sample {
                    bytes.extend(encode(time_us(readings), positions).into_bytes());
                }
            }
        }))
    },
};

const UNIT: ProtocolOption = ProtocolOption {
    name: "unit_mm",
    default: "1000",
    summary: "millimetres in the unit of length: 1000 for metres",
    check: space::check_unit,
};

const MAX_GAP: ProtocolOption = ProtocolOption {
    name: "max_gap_mm",
    default: "10",
    summary: "largest distance between the rays of one marker, 0.1 to 1000",
    check: |value| space::check_range(value, 0.1..=1000.0, "millimetres"),
};

const ELBOW_OFFSET: ProtocolOption = ProtocolOption {
    name: "elbow_offset_mm",
    default: "0",
    summary: "from the elbow marker to the joint along (E − S) × (W − E), -200 to 200",
    check: |value| space::check_range(value, -200.0..=200.0, "millimetres"),
};

const RATE: ProtocolOption = ProtocolOption {
    name: "rate_hz",
    default: "100",
    summary: "lines per second of a file without times, 0.1 to 10000",
    check: |value| space::check_range(value, 0.1..=10_000.0, "lines per second"),
};

/// Parser of lines of one hand.
#[derive(Clone, Debug)]
struct MarkerParser {
    hand: Side,
    world: WorldFromSource,
    tracker: MarkerTracker,
    markers: HandMarkers,
    bones: Option<LiveFit>,
    times: LineTimes,
    /// The time of lines that state none, in seconds.
    time: f64,
    period: f64,
}

impl MarkerParser {
    fn new(options: &ProtocolOptions) -> Self {
        let unit_mm = space::number(options, &UNIT);
        Self {
            hand: space::hand(options),
            world: WorldFromSource::new(options, unit_mm, Facing::AwayFromViewer),
            tracker: MarkerTracker::new(
                space::number(options, &MAX_GAP) / unit_mm,
                1000.0 / unit_mm,
            ),
            markers: HandMarkers::new(space::number(options, &ELBOW_OFFSET) / 1000.0),
            bones: bone_lengths::fit(options, &RATE),
            times: LineTimes::default(),
            time: 0.0,
            period: 1.0 / space::number(options, &RATE),
        }
    }

    /// Follows the markers of all cameras. An error if the direction of one is not determined.
    fn follow(&mut self, line: &Line) -> Result<(), PacketError> {
        let cameras = line.cameras.iter().map(|camera| {
            camera.observations().ok_or_else(|| {
                let text = "a marker has more than one position, or `image` without `orientation`";
                PacketError::new(InvalidPacket::Unknown, text)
            })
        });
        let cameras: Vec<Vec<Observation>> = cameras.collect::<Result<_, _>>()?;
        self.time = match line.time_us {
            Some(time) => time as f64 * 1e-6,
            None => self.time + self.period,
        };
        self.tracker.update(self.time, &cameras);
        Ok(())
    }

    /// Returns the markers of the hand in the world, in metres.
    fn seen(&self) -> Vec<SeenMarker> {
        let seen = self.tracker.markers().filter_map(|marker| {
            Some(SeenMarker {
                site: MarkerSite::from_label(marker.label?, self.hand)?,
                position: self.world.position(marker.position),
                is_predicted: marker.is_predicted,
            })
        });
        seen.collect()
    }
}

impl LineParser for MarkerParser {
    /// 8 cameras that see 40 markers, at 160 bytes each.
    const MAX_LINE_BYTES: usize = 1 << 16;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_slice(line)?;
        let time = self.times.check(line.time_us)?;
        self.follow(&line)?;
        let seen = self.seen();
        let mut positions = self.markers.joints(&seen);
        if positions.is_empty() || seen.iter().all(|marker| marker.is_predicted) {
            let text = if line.hides_all() {
                "no marker has a `point`, `direction` or `image`".to_owned()
            } else if seen.is_empty() {
                hand_markers::why_no_marker(line.labels(), self.hand)
            } else {
                NOT_SEEN_BY_TWO.to_owned()
            };
            return Err(PacketError::new(InvalidPacket::Unknown, text));
        }
        if let Some(fit) = &mut self.bones {
            bone_lengths::fit_joints(fit, &mut positions);
        }
        emit(Packet {
            side: Some(self.hand),
            ..Packet::of_line(Sample::Joints { positions }, time)
        });
        Ok(())
    }

    fn reset(&mut self) {
        self.tracker.reset();
        self.markers.reset();
        if let Some(fit) = &mut self.bones {
            fit.reset();
        }
        self.times = LineTimes::default();
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tracking_tests;
