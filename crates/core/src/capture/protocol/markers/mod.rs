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
//! Y down, Z along the view) into those of the world. Without a focal length, image positions are for a focal length of 1.
//!
//! A label is the name of a joint (`index-finger-tip`, `RightElbow`) or one of the names of Plug-in Gait (`RSHO RELB RWRA
//! RWRB RFIN`), `wrist-a` and `wrist-b` being the two sides of the wrist. One camera that labels a marker is enough.
//! `time_us` is the time of a file; other transports stamp the arrival.

mod encode;
mod hand_markers;
mod line;
mod point_cloud;

use glam::DVec3;

use self::hand_markers::{HandMarkers, MarkerSite};
use self::line::Line;
use self::point_cloud::PointCloud;
use super::encoder::{require_defaults, time_us};
use super::line_times::LineTimes;
use super::lines::{LineDecoder, LineParser};
use super::space::{self, Facing, HAND, UP, WorldFromSource};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions,
};
use crate::capture::{Sample, SampleKind};
use crate::hand::Side;
use crate::time::Timestamp;

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
    options: &[&HAND, &UNIT, &UP, &MAX_GAP, &ELBOW_OFFSET, &RATE],
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
    /// In the unit of the source.
    max_gap: f64,
    points: PointCloud,
    markers: HandMarkers,
    times: LineTimes,
}

impl MarkerParser {
    fn new(options: &ProtocolOptions) -> Self {
        let unit_mm = space::number(options, &UNIT);
        Self {
            hand: space::hand(options),
            world: WorldFromSource::new(options, unit_mm, Facing::AwayFromViewer),
            max_gap: space::number(options, &MAX_GAP) / unit_mm,
            points: PointCloud::default(),
            markers: HandMarkers::new(space::number(options, &ELBOW_OFFSET) / 1000.0),
            times: LineTimes::default(),
        }
    }

    /// Returns the markers of the hand in the world, in metres.
    fn sites(&mut self, line: &Line) -> Result<Vec<(MarkerSite, DVec3)>, PacketError> {
        self.points.clear();
        for camera in &line.cameras {
            let observations = camera.observations().ok_or_else(|| {
                let text = "a marker has no direction, or `image` without `orientation`";
                PacketError::new(InvalidPacket::Unknown, text)
            })?;
            self.points.add_camera(&observations, self.max_gap);
        }
        let points = self.points.positions(self.max_gap);
        let sites = points.filter_map(|(label, position)| {
            let site = MarkerSite::from_label(label?, self.hand)?;
            Some((site, self.world.position(position)))
        });
        Ok(sites.collect())
    }
}

impl LineParser for MarkerParser {
    /// 8 cameras that see 40 markers, at 160 bytes each.
    const MAX_LINE_BYTES: usize = 1 << 16;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_slice(line)?;
        if let Some(time) = line.time_us {
            self.times.check(time)?;
        }
        let sites = self.sites(&line)?;
        let positions = self.markers.joints(&sites);
        if positions.is_empty() {
            let text = "no labelled marker of the hand is seen by two cameras";
            return Err(PacketError::new(InvalidPacket::Unknown, text));
        }
        let time = line.time_us.map(Timestamp);
        emit(Packet {
            time,
            sent_at: time,
            side: Some(self.hand),
            ..Packet::new(Sample::Joints { positions }, 0)
        });
        Ok(())
    }

    fn reset(&mut self) {
        self.markers.reset();
        self.times = LineTimes::default();
    }
}

#[cfg(test)]
mod tests;
