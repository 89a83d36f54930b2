//! `ademan webcam`: a session with a hand in front of a camera.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
use unix::connect;
#[cfg(not(unix))]
use unsupported::connect;

use crate::bridge::CameraArgs;
use crate::failure::Failure;
use crate::run;

/// The layout without another one.
const LAYOUT: &str = "webcam-mouse";

/// Move the pointer or type with a hand in front of a webcam
#[derive(clap::Args)]
#[group(id = "WebcamArgs")]
#[command(
    after_help = "Examples:\n  ademan webcam\n  ademan webcam --output desktop\n  ademan webcam --layout webcam-qwerty --output desktop\n  ademan webcam --camera 1 --model ~/hand_landmarker.task\n  ademan webcam --source 'stdin:?protocol=hand-landmarks&view_deg=78'\n\nHold your open hand still in front of the camera for a second: the layout is placed there, and again after `ademan ctl recenter`. `webcam-mouse`: move the hand, pinch thumb and index finger to click, hold the pinch to drag; middle finger: scroll; ring finger: right button. The pointer rests while the hand is closed or out of the picture."
)]
pub struct Args {
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    run: run::Args,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let source = format!("stdin:?protocol={}", args.camera.protocol());
    let run = args.run.with_defaults(&source, LAYOUT)?;
    let mut bridge = connect(&args.camera)?;
    let ended = run::run(run);
    // It would end at its next image.
    let _ = bridge.kill();
    let _ = bridge.wait();
    ended
}
