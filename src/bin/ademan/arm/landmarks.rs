//! `ademan arm landmarks`.

use std::path::PathBuf;

use super::{OutputArgs, poses};
use crate::failure::Failure;

/// Print the landmarks of each pose of attributes, as lines of the protocol `body-landmarks`
///
/// Attributes without a sign do not say to which side of the full rotation the upper arm is turned; they give the pose on the usual
/// side. Attributes of `ademan arm attributes --signed` give the pose that they came from.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  ademan arm landmarks attributes.jsonl --output poses.jsonl")]
pub struct Args {
    /// Files with one line of `ademan arm attributes` per pose; `-` for standard input
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let mut lines = Vec::new();
    for file in &args.files {
        let poses = poses::read(file, None)?;
        lines.extend(
            poses
                .iter()
                .map(|pose| poses::landmark_line(&pose.half, pose.time_us)),
        );
    }
    args.output.write(|out| {
        for line in lines {
            writeln!(out, "{line}")?;
        }
        Ok(())
    })
}
