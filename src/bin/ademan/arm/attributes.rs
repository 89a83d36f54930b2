//! `ademan arm attributes`.

use std::path::PathBuf;

use ademan::estimate::arm_attributes::ImageSize;

use super::values::Line;
use super::{OutputArgs, csv, poses};
use crate::failure::Failure;

/// Print the attributes of both arms of each pose of landmarks, as lines of JSON or CSV
///
/// A pose is a line: an object with `pose_world_landmarks` as the protocol `body-landmarks` has it, a list of 33 landmarks or of the
/// 14 from the shoulders to the hips, or their numbers separated by commas, semicolons, tabs or blanks. Lengths have the unit of the
/// landmarks, angles are in radians. What missing landmarks would determine is null.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan arm attributes poses.jsonl\n  ademan arm attributes --image-size 1280,720 --csv --output attributes.csv poses.jsonl"
)]
pub struct Args {
    /// Files with one pose per line; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Size of the image in pixels, for landmarks that are fractions of it
    #[arg(long, value_name = "W,H", value_parser = poses::image_size)]
    image_size: Option<ImageSize>,
    /// Print a shoulder rotation with a sign, so that `ademan arm landmarks` gives every pose back
    #[arg(long)]
    signed: bool,
    /// Print comma-separated values with a line of names
    #[arg(long)]
    csv: bool,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let mut lines = Vec::new();
    for file in &args.files {
        let poses = poses::read(file, args.image_size)?;
        lines.extend(
            poses
                .iter()
                .map(|pose| Line::new(pose.time_us, &pose.half, args.signed)),
        );
    }
    args.output.write(|out| {
        if args.csv {
            csv::write_header(out)?;
        }
        for line in &lines {
            if args.csv {
                csv::write_line(line, out)?
            } else {
                writeln!(out, "{}", line.json())?
            }
        }
        Ok(())
    })
}
