//! `ademan arm between`.

use std::io::Write;
use std::path::PathBuf;

use ademan::estimate::arm_attributes::{HALF_POSE_ROWS, HalfPose, ImageSize, Trunk};

use super::values::{Line, both};
use super::{OutputArgs, poses, strip};
use crate::failure::Failure;
use crate::setup_args::number_in;

/// Generate the movement of both arms between two postures, in the space of their attributes
///
/// Angles take the short way, directions move on the sphere and lengths change linearly, so that no bone shrinks on the way. The
/// first pose of each file counts.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan arm between rest.jsonl wave.jsonl --ms 800 --output movement.jsonl\n  ademan arm between rest.jsonl wave.jsonl --form strip --output movement.svg"
)]
pub struct Args {
    /// File with the posture at the start: landmarks or attributes
    start: PathBuf,
    /// File with the posture at the end
    end: PathBuf,
    /// Postures on the way, in order
    #[arg(long, value_name = "FILE")]
    via: Vec<PathBuf>,
    /// Duration in milliseconds
    #[arg(long, value_name = "MS", default_value = "800", value_parser = duration)]
    ms: f64,
    /// Poses per second
    #[arg(long, value_name = "HZ", default_value = "60", value_parser = rate)]
    rate_hz: f64,
    /// Course of the speed between two postures
    #[arg(long, value_enum, default_value_t = Ease::MinimumJerk)]
    ease: Ease,
    /// Size of the image in pixels, for landmarks that are fractions of it
    #[arg(long, value_name = "W,H", value_parser = poses::image_size)]
    image_size: Option<ImageSize>,
    /// Form of the movement
    #[arg(long, value_enum, default_value_t = Form::Landmarks)]
    form: Form,
    #[command(flatten)]
    output: OutputArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Ease {
    /// Starts and ends at rest, as a person moves (Flash and Hogan 1985)
    MinimumJerk,
    /// Constant speed
    Linear,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Form {
    /// Lines of the protocol `body-landmarks`
    Landmarks,
    /// Lines of `ademan arm attributes --signed`
    Attributes,
    /// A strip of pictures as SVG, beside the movement of the landmarks themselves
    Strip,
}

/// The landmarks of a half pose.
const LANDMARKS: [&str; HALF_POSE_ROWS] = [
    "left-shoulder",
    "right-shoulder",
    "left-elbow",
    "right-elbow",
    "left-wrist",
    "right-wrist",
    "left-little",
    "right-little",
    "left-index",
    "right-index",
    "left-thumb",
    "right-thumb",
    "left-hip",
    "right-hip",
];

impl Ease {
    /// Returns the fraction of the way at a fraction of the time.
    fn way(self, time: f64) -> f64 {
        match self {
            Self::MinimumJerk => time.powi(3) * (10.0 - 15.0 * time + 6.0 * time * time),
            Self::Linear => time,
        }
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let files = std::iter::once(&args.start)
        .chain(&args.via)
        .chain([&args.end]);
    let postures: Vec<HalfPose> = files
        .map(|file| {
            let poses = poses::read(file, args.image_size)?;
            let half = poses[0].half;
            if let Some(row) = half.rows().iter().position(|row| !row.is_finite()) {
                return Err(Failure::wrong_use(format!(
                    "the first pose of {} lacks the landmark `{}`, which a movement needs; name a file whose first pose shows both arms",
                    poses::name(file),
                    LANDMARKS[row]
                )));
            }
            both(&half).map_err(|(side, error)| {
                Failure::wrong_use(format!(
                    "the {side} arm of {} has no attributes: {error}",
                    poses::name(file)
                ))
            })?;
            Ok(half)
        })
        .collect::<Result<_, Failure>>()?;
    args.output.write(|out| match args.form {
        Form::Strip => {
            let text = strip::draw(&postures, |way| pose_at(&postures, way))?;
            Ok(out.write_all(text.as_bytes())?)
        }
        Form::Landmarks | Form::Attributes => write_poses(args, &postures, out),
    })
}

/// Writes the poses of a movement through postures, one per line.
fn write_poses(args: &Args, postures: &[HalfPose], out: &mut dyn Write) -> Result<(), Failure> {
    let count = (args.ms * 1e-3 * args.rate_hz).round().max(1.0) as u64;
    let segments = postures.len() - 1;
    for index in 0..=count {
        let course = index as f64 / count as f64 * segments as f64;
        let segment = course.floor().min(segments as f64 - 1.0);
        let way = segment + args.ease.way(course - segment);
        let time_us = (index as f64 / count as f64 * args.ms * 1e3).round() as u64;
        let pose = pose_at(postures, way)?;
        let line = match args.form {
            Form::Attributes => Line::new(Some(time_us), &pose, true).json(),
            _ => poses::landmark_line(&pose, Some(time_us)),
        };
        writeln!(out, "{line}")?;
    }
    Ok(())
}

/// Returns the pose on the way through postures: `1.5` is half the way from the second to the third.
fn pose_at(postures: &[HalfPose], way: f64) -> Result<HalfPose, Failure> {
    let segment = (way.floor() as usize).min(postures.len() - 2);
    let fraction = way - segment as f64;
    let (start, end) = (&postures[segment], &postures[segment + 1]);
    // Exactly the posture, whose trunk and arms rounding would change.
    if fraction <= 0.0 {
        return Ok(*start);
    }
    if fraction >= 1.0 {
        return Ok(*end);
    }
    let impossible = |reason: String| Failure::job(format!("the movement is impossible: {reason}"));
    let arms = |pose| both(pose).map_err(|(_, error)| impossible(error.to_string()));
    let (from, to) = (arms(start)?, arms(end)?);
    let attributes = std::array::from_fn(|side| from[side].between(&to[side], fraction));
    HalfPose::from_attributes(&trunk_between(start, end, fraction), &attributes)
        .map_err(|error| impossible(error.to_string()))
}

fn trunk_between(start: &HalfPose, end: &HalfPose, fraction: f64) -> Trunk {
    let (from, to) = (start.trunk(), end.trunk());
    Trunk {
        shoulders: std::array::from_fn(|side| {
            from.shoulders[side].lerp(to.shoulders[side], fraction)
        }),
        hips: std::array::from_fn(|side| from.hips[side].lerp(to.hips[side], fraction)),
    }
}

fn duration(text: &str) -> Result<f64, String> {
    number_in(text, 1.0, 3_600_000.0, "milliseconds")
}

fn rate(text: &str) -> Result<f64, String> {
    number_in(text, 0.1, 10_000.0, "poses per second")
}
