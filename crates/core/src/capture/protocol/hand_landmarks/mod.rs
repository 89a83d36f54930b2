//! Lines of JSON with the landmarks of hands, as MediaPipe finds them in the images of a camera.
//!
//! ```json
//! {"time_us":12500,"image_size":[640,480],"hands":[
//!   {"label":"Right","score":0.97,"image":[[0.52,0.81,0.0],…],"world":[[0.01,0.07,0.02],…]}]}
//! ```
//!
//! Each line is one object for one image, with [`HAND_LANDMARKS`] landmarks of each hand that is seen; `hands` is empty if none
//! is seen.
//!
//! - `image`: points of the image, from 0 to 1 or in pixels, x to the right and y down, z as deep as x is wide. They need
//!   `image_size`: width and height differ, and nothing else tells whether they are pixels.
//! - `world`: positions in metres about the middle of the hand, x to the right of the image, y down, z away from the camera.
//!
//! With both, the hand has the shape of `world` and the position that its points in the image show. With `image` alone, the
//! length of its palm gives its distance. With `world` alone, its position is not known: joints are relative to the wrist.

mod camera;
mod line;

use std::fmt::Write;

use glam::DVec3;

use self::camera::{Camera, Landmarks, Mount};
pub(super) use self::line::Hand;
use self::line::Line;
use super::encoder::{hands, require_defaults, time_us};
use super::lines::{LineDecoder, LineParser};
use super::space::{self, HAND};
use super::tracked_hands::{
    BestHands, MIN_SCORE, Position, RATE, TrackedHands, check_score, check_yes_or_no,
};
use super::{
    Carriers, InvalidPacket, Packet, PacketError, PositionNoise, Protocol, ProtocolOption,
    ProtocolOptions,
};
use crate::capture::SampleKind;
use crate::hand::{Finger, Joint, JointPositions, Side};

pub use self::camera::HAND_LANDMARKS;

/// The protocol of hand landmarks.
pub const PROTOCOL: Protocol = Protocol {
    name: "hand-landmarks",
    summary: "21 landmarks of MediaPipe for each hand, as lines of JSON",
    sample: SampleKind::Joints,
    has_both_hands: true,
    has_parts: false,
    position_noise: PositionNoise::Landmarks,
    carriers: Carriers::Any,
    // Half of a line with two hands whose numbers have one digit. Lines without hands are shorter, and they are few.
    min_packet_bytes: 8 * HAND_LANDMARKS,
    default_baud: None,
    feedback: None,
    options: &[
        &HAND,
        &CAMERA,
        &MIRRORED,
        &SWAP_HANDS,
        &ANGLE_OF_VIEW,
        &PALM,
        &MIN_SCORE,
        &RATE,
    ],
    nominal_rate_hz: |options| Some(space::number(options, &RATE)),
    decoder: |options| Box::new(LineDecoder::with_parser(HandParser::new(options))),
    encoder: |options, _| {
        require_defaults(options, &[&MIRRORED, &SWAP_HANDS, &ANGLE_OF_VIEW])?;
        match options.get(&CAMERA) {
            "head" => Ok(Box::new(|readings, bytes| {
                let line = encode(time_us(readings), &hands(readings));
                bytes.extend(line.into_bytes());
            })),
            _ => Err("a simulated camera is worn on the head; write `camera=head`".to_owned()),
        }
    },
};

/// The option for the place of the camera.
pub const CAMERA: ProtocolOption = ProtocolOption {
    name: "camera",
    default: "front",
    summary: "place of the camera: `front`, `head` or `above`",
    check: |value| match Mount::from_name(value) {
        Some(_) => Ok(()),
        None => Err(format!(
            "`{value}` is not a place of the camera, write `front`, `head` or `above`"
        )),
    },
};

pub(super) const MIRRORED: ProtocolOption = ProtocolOption {
    name: "mirrored",
    default: "no",
    summary: "`yes` if the image is flipped left to right before hands are found in it",
    check: check_yes_or_no,
};

pub(super) const SWAP_HANDS: ProtocolOption = ProtocolOption {
    name: "swap_hands",
    default: "no",
    summary: "`yes` for a tracker whose labels assume a mirrored image",
    check: check_yes_or_no,
};

pub(super) const ANGLE_OF_VIEW: ProtocolOption = ProtocolOption {
    name: "view_deg",
    default: "60",
    summary: "horizontal angle of view of the camera, 10 to 170",
    check: |value| space::check_range(value, 10.0..=170.0, "degrees"),
};

pub(super) const PALM: ProtocolOption = ProtocolOption {
    name: "palm_mm",
    default: "85",
    summary: "from the wrist to the knuckle of the middle finger, for `image` alone, 30 to 150",
    check: |value| space::check_range(value, 30.0..=150.0, "millimetres"),
};

/// Largest coordinate of a world landmark about the middle of the hand, in metres.
const MAX_EXTENT: f64 = 1.0;

/// Largest coordinate of a point from 0 to 1; a larger one is in pixels. No image shows a hand at four times its width.
const MAX_NORMALIZED: f64 = 4.0;

/// Largest coordinate of a point, in pixels.
const MAX_PIXELS: f64 = 1e6;

/// Largest backward bend of the fingers, as a sum of sines. A hand beyond it has the wrong label.
const MAX_BACKWARD_BEND: f64 = 1.0;

/// Parser of lines of hands.
#[derive(Clone, Debug)]
pub(super) struct HandParser {
    camera: Camera,
    /// `true` if a label names the other hand.
    is_swapped: bool,
    min_score: f64,
    pub(super) hands: TrackedHands,
}

impl HandParser {
    pub(super) fn new(options: &ProtocolOptions) -> Self {
        let is_yes = |option| options.get(option) == "yes";
        let mount = Mount::from_name(options.get(&CAMERA));
        let camera = Camera {
            mount: mount.expect("options are checked when they are set"),
            is_mirrored: is_yes(&MIRRORED),
            focal: Camera::focal_of(space::number(options, &ANGLE_OF_VIEW)),
            palm: space::number(options, &PALM) / 1000.0,
        };
        Self {
            camera,
            is_swapped: is_yes(&SWAP_HANDS) != camera.is_mirrored,
            min_score: space::number(options, &MIN_SCORE),
            hands: TrackedHands::new(space::number(options, &RATE)),
        }
    }

    /// Returns `true` if the image was flipped left to right before hands were found in it.
    pub(super) fn is_mirrored(&self) -> bool {
        self.camera.is_mirrored
    }

    /// Returns `true` if the camera looks at the person.
    pub(super) fn is_camera_in_front(&self) -> bool {
        self.camera.mount == Mount::Front
    }

    /// Returns the hands of an image, by side. One that shows no hand, as with a wrong label where hands cross, is an error only without
    /// another one that does.
    pub(super) fn best_hands(
        &self,
        hands: &[Hand],
        image_size: Option<[f64; 2]>,
    ) -> Result<BestHands, PacketError> {
        let mut best = BestHands::new(self.min_score);
        let mut refused = None;
        for hand in hands {
            check_score(hand.score)?;
            let side = self.side(hand);
            if best.admits(side, hand.score) {
                match self.positions(hand, image_size) {
                    Ok(positions) => best.add(side, hand.score, positions),
                    Err(error) => refused = refused.or(Some(error)),
                }
            }
        }
        match refused {
            Some(error) if best.hands().iter().all(Option::is_none) => Err(error),
            _ => Ok(best),
        }
    }

    fn side(&self, hand: &Hand) -> Side {
        if self.is_swapped {
            hand.label.0.opposite()
        } else {
            hand.label.0
        }
    }

    /// Returns the positions of a hand in the world, in metres.
    fn positions(
        &self,
        hand: &Hand,
        image_size: Option<[f64; 2]>,
    ) -> Result<JointPositions, PacketError> {
        let shape = hand.world.as_deref().map(landmarks).transpose()?;
        if let Some(shape) = &shape {
            check_extent(shape, MAX_EXTENT)?;
        }
        let points = hand.image.as_deref().map(landmarks).transpose()?;
        let landmarks = match (points, shape) {
            (Some(points), shape) => {
                let points = centered(&points, image_size)?;
                self.camera.place(&points, shape.as_ref()).ok_or_else(|| {
                    PacketError::new(
                        InvalidPacket::NotFinite,
                        "the landmarks of a hand show no place in front of the camera",
                    )
                })?
            }
            (None, Some(shape)) => self.camera.turn(&shape),
            (None, None) => {
                let text = "a hand has neither `world` nor `image` landmarks";
                return Err(PacketError::new(InvalidPacket::Unknown, text));
            }
        };
        let positions = joints(&landmarks);
        if backward_bend(&positions, self.side(hand)) > MAX_BACKWARD_BEND {
            let other = |is_yes: bool| if is_yes { "no" } else { "yes" };
            let is_mirrored = self.camera.is_mirrored;
            let text = format!(
                "the fingers of a hand bend backwards, so that its label is wrong; try `swap_hands={}` or `mirrored={}`",
                other(self.is_swapped != is_mirrored),
                other(is_mirrored)
            );
            Err(PacketError::new(InvalidPacket::Unknown, text))
        } else {
            Ok(positions)
        }
    }
}

impl LineParser for HandParser {
    /// Four hands of 42 landmarks of three numbers with 22 digits are 12 kB; the rest is for other fields.
    const MAX_LINE_BYTES: usize = 24 * 1024;

    fn parse(&mut self, line: &[u8], emit: &mut dyn FnMut(Packet)) -> Result<(), PacketError> {
        let line: Line = serde_json::from_slice(line)?;
        let hands = self.best_hands(&line.hands, line.image_size)?;
        let time = self.hands.start_line(line.time_us)?;
        self.hands.emit(time, hands.hands(), emit);
        Ok(())
    }

    fn reset(&mut self) {
        self.hands.reset();
    }
}

fn landmarks(positions: &[Position]) -> Result<Landmarks, PacketError> {
    let all = <&[Position; HAND_LANDMARKS]>::try_from(positions).map_err(|_| {
        let text = format!("{} landmarks instead of {HAND_LANDMARKS}", positions.len());
        PacketError::new(InvalidPacket::WrongSize, text)
    })?;
    Ok(all.map(|Position(position)| position.into()))
}

fn check_extent(landmarks: &Landmarks, limit: f64) -> Result<(), PacketError> {
    let is_near = |landmark: &DVec3| landmark.abs().max_element() <= limit;
    if landmarks.iter().all(is_near) {
        Ok(())
    } else {
        Err(PacketError::new(
            InvalidPacket::NotFinite,
            "a landmark is too far away from the others",
        ))
    }
}

/// Returns points of the image in multiples of its width from its center.
fn centered(points: &Landmarks, image_size: Option<[f64; 2]>) -> Result<Landmarks, PacketError> {
    let Some([width, height]) = image_size else {
        return Err(PacketError::new(
            InvalidPacket::Unknown,
            "points of the image need `image_size`, its width and height in pixels",
        ));
    };
    if !(1.0..=MAX_PIXELS).contains(&width) || !(1.0..=MAX_PIXELS).contains(&height) {
        let text = "`image_size` is not a width and a height in pixels";
        return Err(PacketError::new(InvalidPacket::NotFinite, text));
    }
    check_extent(points, MAX_PIXELS)?;
    let is_pixel = |point: &DVec3| point.truncate().abs().max_element() > MAX_NORMALIZED;
    let scale = if points.iter().any(is_pixel) {
        DVec3::splat(1.0 / width)
    } else {
        DVec3::new(1.0, height / width, 1.0)
    };
    let center = DVec3::new(0.5, 0.5 * height / width, 0.0);
    Ok(points.map(|point| point * scale - center))
}

/// Returns the joints of the landmarks. Of the bases of the metacarpals MediaPipe has only the thumb's.
fn joints(landmarks: &Landmarks) -> JointPositions {
    let mut positions = JointPositions::default();
    positions.set(Joint::Wrist, landmarks[0]);
    for (&finger, chain) in Finger::ALL.iter().zip(landmarks[1..].chunks_exact(4)) {
        let joints = finger.joints();
        let joints = &joints[joints.len() - chain.len()..];
        for (&joint, &landmark) in joints.iter().zip(chain) {
            positions.set(joint, landmark);
        }
    }
    positions
}

/// Returns the sum of the sines by which the fingers bend away from the palm at their middle joints; negative towards it.
fn backward_bend(positions: &JointPositions, side: Side) -> f64 {
    let get = |joint| positions.get(joint).unwrap_or_default();
    let across = get(Joint::IndexPhalanxProximal) - get(Joint::LittlePhalanxProximal);
    // Towards the thumb of a right hand: the axis about which its fingers bend towards the palm.
    let axis = match side {
        Side::Right => across.normalize_or_zero(),
        Side::Left => -across.normalize_or_zero(),
    };
    let bend = |finger: &Finger| {
        let joints = finger.joints();
        let bone = |from: usize| (get(joints[from + 1]) - get(joints[from])).normalize_or_zero();
        bone(1).cross(bone(2)).dot(axis)
    };
    -Finger::ALL[1..].iter().map(bend).sum::<f64>()
}

/// Returns a line, with its line end, of hands whose positions are in the world, seen by a camera at the origin that looks where
/// the person looks (`camera=head`). All joints must be known: an unknown one is left out, which makes the line invalid.
pub fn encode(time_us: Option<u64>, hands: &[(Side, JointPositions)]) -> String {
    const SIZE: [f64; 2] = [640.0, 480.0];
    let focal = Camera::focal_of(60.0);
    let mut line = String::from("{");
    if let Some(time) = time_us {
        let _ = write!(line, "\"time_us\":{time},");
    }
    let hands = hands.iter().map(|(side, positions)| {
        let joints = Finger::ALL.iter().flat_map(|finger| {
            let joints = finger.joints();
            &joints[joints.len() - 4..]
        });
        let known = std::iter::once(&Joint::Wrist).chain(joints);
        let seen: Vec<DVec3> = known
            .filter_map(|&joint| positions.get(joint))
            .map(|world| DVec3::new(world.x, -world.y, -world.z))
            .collect();
        let middle = seen.iter().sum::<DVec3>() / seen.len().max(1) as f64;
        let world: Vec<_> = seen.iter().map(|at| (at - middle).to_array()).collect();
        let image = seen.iter().map(|at| {
            let point = at / at.z * focal;
            let height = SIZE[1] / SIZE[0];
            [
                point.x + 0.5,
                point.y / height + 0.5,
                (at.z - middle.z) * focal / middle.z,
            ]
        });
        let image: Vec<_> = image.collect();
        serde_json::json!({ "label": side, "score": 1.0, "image": image, "world": world })
    });
    let hands: Vec<_> = hands.collect();
    let _ = writeln!(
        line,
        "\"image_size\":[{},{}],\"hands\":{}}}",
        SIZE[0],
        SIZE[1],
        serde_json::Value::from(hands)
    );
    line
}

#[cfg(test)]
mod tests;
