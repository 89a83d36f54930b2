//! `ademan body`: joint angles of a body of twelve points, and the positions that they give.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

use ademan::capture::body::BodyLandmarks;
use ademan::capture::markers::median;
use ademan::estimate::t_pose::{BodyJoint, BodyPoint, BodyPoints, BodyRotations};
use ademan::geometry::EulerOrder;
use glam::{DMat3, DVec3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::arm::{OutputArgs, poses};
use crate::failure::Failure;

/// Joint angles of a body of twelve points, from its T pose, and back
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan body angles poses.jsonl --order zxy > angles.jsonl\n  ademan body positions angles.jsonl > poses.jsonl"
)]
pub enum Args {
    Angles(AnglesArgs),
    Positions(PositionsArgs),
}

/// Print the angles of the eleven joints of each pose, as lines of JSON or CSV
///
/// A pose is a line: an object with the positions of `left-hip`, `right-hip`, `left-knee` and so on in a frame with Y up, a list of
/// the twelve in this order, or 33 landmarks in `pose_world_landmarks`. Angles are in degrees, first axis first.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan body angles poses.jsonl\n  ademan body angles poses.jsonl --order xyz --csv --check"
)]
pub struct AnglesArgs {
    /// Files with one pose per line, or `.npy` arrays; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Order of the axes; `zxy` is R = Rz · Rx · Ry, and `zxz` turns about Z again
    #[arg(long, default_value = "zxy", value_parser = order)]
    order: EulerOrder,
    /// Print comma-separated values with a line of names
    #[arg(long)]
    csv: bool,
    /// Give each bone its median length, and move the points as little as that needs
    #[arg(long)]
    fit: bool,
    /// Say how far the positions are that the angles give back
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// Print the positions of the twelve points that lines of `ademan body angles` give
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  ademan body positions angles.jsonl --output poses.jsonl")]
pub struct PositionsArgs {
    /// Files with one line of angles per pose; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

/// A line of angles.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnglesLine {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time_us: Option<u64>,
    #[serde(deserialize_with = "deserialize_order")]
    order: EulerOrder,
    root: [f64; 3],
    lengths: BTreeMap<BodyJoint, f64>,
    angles_deg: BTreeMap<BodyJoint, [f64; 3]>,
}

/// A line of positions.
#[derive(Serialize)]
struct PositionsLine {
    #[serde(skip_serializing_if = "Option::is_none")]
    time_us: Option<u64>,
    #[serde(flatten)]
    positions: BTreeMap<BodyPoint, [f64; 3]>,
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Angles(args) => print_angles(&args),
        Args::Positions(args) => print_positions(&args),
    }
}

fn print_angles(args: &AnglesArgs) -> Result<(), Failure> {
    let mut largest: f64 = 0.0;
    let mut lines = Vec::new();
    let mut left_out = Vec::new();
    let lengths = args.fit.then(|| median_lengths(&args.files)).transpose()?;
    for_each_line(&args.files, |place, text| {
        let (time_us, mut body) = parse_body(text)?;
        let mut line = AnglesLine::new(time_us, args.order, &body);
        if let (Some(lengths), Ok(_)) = (&lengths, &line) {
            body = body.fitted(lengths);
            line = AnglesLine::new(time_us, args.order, &body);
        }
        let line = match line {
            Ok(line) => line,
            // One hidden limb says nothing about the other poses.
            Err(reason) => {
                left_out.push(format!("{place}: {reason}"));
                return Ok(());
            }
        };
        let back = line.body()?;
        for &point in BodyPoint::ALL {
            largest = largest.max(back.get(point).distance(body.get(point)));
        }
        lines.push(line);
        Ok(())
    })?;
    if let Some(reason) = left_out.first() {
        let (count, all) = (left_out.len(), left_out.len() + lines.len());
        if lines.is_empty() {
            let message = format!("no pose has angles; the first one is {reason}");
            return Err(Failure::wrong_use(message));
        }
        complain!(
            "{count} of {all} poses have no angles and are left out; the first one is {reason}"
        );
    }
    args.output.write(|out| {
        if args.csv {
            write_csv(&lines, out)?;
        } else {
            for line in &lines {
                writeln!(out, "{}", json(line))?;
            }
        }
        Ok(())
    })?;
    if args.check {
        say!(
            "{} poses; the positions that the angles give differ by {largest:.1e} at most",
            lines.len()
        );
    }
    Ok(())
}

/// Returns the median length of each bone in the poses that have angles.
fn median_lengths(files: &[PathBuf]) -> Result<[f64; BodyJoint::COUNT], Failure> {
    if files.iter().any(|file| file.as_os_str() == "-") {
        let message = "`--fit` reads the poses twice, which standard input cannot be; write them to a file first";
        return Err(Failure::wrong_use(message));
    }
    let mut seen: [Vec<f64>; BodyJoint::COUNT] = Default::default();
    for_each_line(files, |_, text| {
        let (_, body) = parse_body(text)?;
        if body.rotations().is_err() {
            return Ok(());
        }
        for (bone_lengths, length) in seen.iter_mut().zip(body.lengths()) {
            bone_lengths.push(length);
        }
        Ok(())
    })?;
    Ok(seen.map(|mut lengths| median(&mut lengths).unwrap_or_default()))
}

fn print_positions(args: &PositionsArgs) -> Result<(), Failure> {
    let mut lines = Vec::new();
    for_each_line(&args.files, |_, text| {
        let line = parse_angles(text)?;
        let body = line.body()?;
        let points = BodyPoint::ALL.iter();
        let positions: BTreeMap<BodyPoint, [f64; 3]> = points
            .map(|&point| (point, body.get(point).to_array()))
            .collect();
        lines.push(json(&PositionsLine {
            time_us: line.time_us,
            positions,
        }));
        Ok(())
    })?;
    args.output.write(|out| {
        for line in lines {
            writeln!(out, "{line}")?;
        }
        Ok(())
    })
}

/// Parses a line of angles.
fn parse_angles(text: &str) -> Result<AnglesLine, String> {
    let not_angles = |reason: &str| format!("{reason}; expected a line of `ademan body angles`");
    let line: Value = serde_json::from_str(text).map_err(|_| not_angles("this is not JSON"))?;
    if !line.is_object() {
        return Err(not_angles("this is not an object"));
    }
    serde_json::from_value(line).map_err(|error| not_angles(&error.to_string()))
}

/// Calls a function with the place and the text of each line of the files. Its error is reported with the place.
fn for_each_line(
    files: &[PathBuf],
    mut read: impl FnMut(&str, &str) -> Result<(), String>,
) -> Result<(), Failure> {
    for file in files {
        let lines = poses::lines(file)?;
        if lines.is_empty() {
            let message = format!("{} holds no pose; write one per line", poses::name(file));
            return Err(Failure::wrong_use(message));
        }
        for (number, text) in lines {
            let place = format!("{}:{number}", poses::name(file));
            read(&place, &text).map_err(|reason| poses::at_line(file, number, &reason))?;
        }
    }
    Ok(())
}

impl AnglesLine {
    /// Returns the line of a body; an error if its points do not determine all joints.
    pub fn new(time_us: Option<u64>, order: EulerOrder, body: &BodyPoints) -> Result<Self, String> {
        let mut points = BodyPoint::ALL.iter();
        if let Some(&hidden) = points.find(|&&point| !body.get(point).is_finite()) {
            return Err(missing(hidden));
        }
        let rotations = body.rotations().map_err(|error| error.to_string())?;
        let lengths = body.lengths();
        let joints = || BodyJoint::ALL.iter();
        let angles = |joint| {
            let angles = order.angles(rotations.get(joint));
            let angles = angles.expect("rotations of finite points are finite");
            angles.map(f64::to_degrees)
        };
        Ok(Self {
            time_us,
            order,
            root: body.root_position().to_array(),
            lengths: joints()
                .map(|&joint| (joint, lengths[joint.index()]))
                .collect(),
            angles_deg: joints().map(|&joint| (joint, angles(joint))).collect(),
        })
    }

    /// Returns the positions that the angles give.
    fn body(&self) -> Result<BodyPoints, String> {
        let mut local = [DMat3::IDENTITY; BodyJoint::COUNT];
        let mut lengths = [0.0; BodyJoint::COUNT];
        for &joint in BodyJoint::ALL {
            let missing = || format!("the line lacks the joint `{joint}`");
            let angles = self.angles_deg.get(&joint).ok_or_else(missing)?;
            local[joint.index()] = self.order.rotation(angles.map(f64::to_radians));
            let length = *self.lengths.get(&joint).ok_or_else(missing)?;
            if length < 0.0 {
                return Err(format!(
                    "the length of `{joint}` is {length}; a length is 0 or more"
                ));
            }
            lengths[joint.index()] = length;
        }
        let root = DVec3::from_array(self.root);
        Ok(BodyRotations::new(local).points(root, &lengths))
    }
}

/// The landmarks of a pose of 33 points that are the points of a body.
const LANDMARKS: [(usize, BodyPoint); BodyPoint::COUNT] = [
    (11, BodyPoint::LeftShoulder),
    (12, BodyPoint::RightShoulder),
    (13, BodyPoint::LeftElbow),
    (14, BodyPoint::RightElbow),
    (15, BodyPoint::LeftWrist),
    (16, BodyPoint::RightWrist),
    (23, BodyPoint::LeftHip),
    (24, BodyPoint::RightHip),
    (25, BodyPoint::LeftKnee),
    (26, BodyPoint::RightKnee),
    (27, BodyPoint::LeftFoot),
    (28, BodyPoint::RightFoot),
];

/// Returns the points of a body of 33 landmarks, which have y down and z away from the camera.
pub fn body_of_landmarks(landmarks: &BodyLandmarks) -> BodyPoints {
    let mut positions = [DVec3::NAN; BodyPoint::COUNT];
    for (row, point) in LANDMARKS {
        if let Some(landmark) = landmarks.points.get(row) {
            let position = DVec3::from(landmark.position.map(f64::from));
            positions[point.index()] = position * DVec3::new(1.0, -1.0, -1.0);
        }
    }
    BodyPoints { positions }
}

/// Parses a pose. Points that are `null` are NaN, and without a person all of them.
fn parse_body(text: &str) -> Result<(Option<u64>, BodyPoints), String> {
    let value = poses::json(text).map_err(|error| {
        format!(
            "neither an object with the twelve points, a list of them, nor `pose_world_landmarks`: {}; `ademan body angles --help` lists \
             the formats",
            poses::json_reason(&error)
        )
    })?;
    let time_us = poses::time_us(&value)?;
    let mut positions = [DVec3::NAN; BodyPoint::COUNT];
    if let Some(field) = value.get("pose_world_landmarks") {
        let Some(landmarks) = poses::landmarks(field)? else {
            return Ok((time_us, BodyPoints { positions }));
        };
        for (row, point) in LANDMARKS {
            let landmark = landmarks.get(row).ok_or_else(|| missing(point))?;
            // `ademan arm landmarks` fills in points that it does not know, which are not visible.
            if landmark.get(3).and_then(Value::as_f64) == Some(0.0) {
                continue;
            }
            let position = poses::row(landmark);
            // The image has y down and z away from the camera.
            positions[point.index()] = position * DVec3::new(1.0, -1.0, -1.0);
        }
        return Ok((time_us, BodyPoints { positions }));
    }
    if value
        .as_array()
        .is_some_and(|list| list.len() != BodyPoint::COUNT)
    {
        return Err(format!(
            "a list of a body has {} positions",
            BodyPoint::COUNT
        ));
    }
    for (index, &point) in BodyPoint::ALL.iter().enumerate() {
        let underscored = point.name().replace('-', "_");
        let found = value.get(index).or_else(|| value.get(point.name()));
        let found = found.or_else(|| value.get(underscored));
        positions[point.index()] = found.map(poses::row).ok_or_else(|| missing(point))?;
    }
    Ok((time_us, BodyPoints { positions }))
}

fn missing(point: BodyPoint) -> String {
    format!("the pose lacks the position of `{point}`")
}

fn write_csv(lines: &[AnglesLine], out: &mut dyn Write) -> std::io::Result<()> {
    write!(out, "time_us")?;
    let order = lines.first().map_or("", |line| line.order.name());
    for &joint in BodyJoint::ALL {
        for axis in order.to_ascii_lowercase().chars() {
            write!(out, ",{joint}_{axis}_deg")?;
        }
    }
    writeln!(out)?;
    for line in lines {
        if let Some(time_us) = line.time_us {
            write!(out, "{time_us}")?;
        }
        let joints = BodyJoint::ALL.iter();
        for angle in joints.flat_map(|joint| &line.angles_deg[joint]) {
            write!(out, ",{angle}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Returns a value as JSON.
pub fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("every key is a string")
}

fn deserialize_order<'de, D: Deserializer<'de>>(deserializer: D) -> Result<EulerOrder, D::Error> {
    let text = String::deserialize(deserializer)?;
    order(&text).map_err(D::Error::custom)
}

/// Reads the order of Euler angles.
pub fn order(text: &str) -> Result<EulerOrder, String> {
    let order = text.to_ascii_uppercase().parse::<EulerOrder>();
    order.map_err(|error| error.to_string())
}
