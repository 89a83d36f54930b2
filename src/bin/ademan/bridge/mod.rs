//! `ademan bridge`: programs that connect other programs, in the language of the other program.

mod blender;
mod webcam;

pub use webcam::CameraArgs;

use crate::failure::Failure;

/// Print a program that connects another one: a webcam, or Blender
#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  ademan bridge webcam --run | ademan run --source 'stdin:?protocol=hand-landmarks' --layout webcam-mouse\n  ademan bridge blender --output ademan_blender.py"
)]
pub enum Args {
    Webcam(webcam::Args),
    Blender(blender::Args),
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args {
        Args::Webcam(args) => webcam::run(&args),
        Args::Blender(args) => blender::run(&args),
    }
}
