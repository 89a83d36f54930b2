//! Sources for tests: waiting for an event, and a typing hand as text lines, markers and poses.

use std::time::{Duration, Instant};

use ademan::capture::protocol::{markers, text_line};
use ademan::capture::{CaptureError, Hc11Format, Source, SourceEvent};
use ademan::estimate::{Estimate, Estimator, EstimatorSettings, Smoothing};
use ademan::kinematics::{ArmModel, HandPose};
use ademan::setup::Setup;
use ademan::trace::bvh::{PoseOptions, PoseWriter};

/// Returns the next event that is not `Idle`. Panics after `timeout`.
pub fn next_within(
    source: &mut dyn Source,
    timeout: Duration,
) -> Result<SourceEvent, CaptureError> {
    let start = Instant::now();
    while start.elapsed() < timeout {
        match source.next() {
            Ok(SourceEvent::Idle) => {}
            event => return event,
        }
    }
    panic!("no event within {timeout:?}");
}

/// The packet rate of the simulated hand: 66 bytes at 115200 baud.
pub const TYPING_RATE_HZ: f64 = 11_520.0 / 66.0;

/// Returns the estimates of a hand that types `text` on the default layout, at [`TYPING_RATE_HZ`], and its arm.
pub fn typing_estimates(text: &str) -> (Vec<Estimate>, ArmModel) {
    let setup = Setup::default().load_files().expect("the default setup");
    let hand = setup.typist(text, &Hc11Format::default(), 0.0, 0);
    let mut hand = hand.expect("the text can be typed");
    let settings = EstimatorSettings::unchecked(Smoothing::Off);
    let mut estimator =
        Estimator::new(settings).with_channels(&setup.glove.as_ref().expect("a glove").map);
    let mut estimates = Vec::new();
    while let SourceEvent::Reading(reading) = hand.next().expect("the hand has no errors") {
        estimates.push(*estimator.update(&reading).expect("a valid reading"));
    }
    (estimates, setup.arm)
}

/// Returns the text lines of joint angles of a hand that types `text` on the default layout.
///
/// The angles of the thumb are not exact, because its MCP and IP joints share a wire index.
pub fn text_lines(text: &str) -> Vec<String> {
    let (estimates, _) = typing_estimates(text);
    let encode = |estimate: &Estimate| text_line::encode(&estimate.angles);
    estimates.iter().map(encode).collect()
}

/// Returns the poses of a hand that types `text` on the default layout.
pub fn typing_poses(text: &str) -> Vec<HandPose> {
    let (estimates, arm) = typing_estimates(text);
    estimates
        .iter()
        .map(|estimate| arm.forward(estimate))
        .collect()
}

/// Returns the motion capture of a hand that types `text` on the default layout: each frame is a pose.
pub fn bvh_text(text: &str) -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = PoseWriter::new(&mut file, PoseOptions::new(TYPING_RATE_HZ));
    for pose in typing_poses(text) {
        writer.push(&pose).expect("memory accepts all bytes");
    }
    writer.finish().expect("memory accepts all bytes");
    file.into_inner()
}

/// Returns the lines of three cameras around a hand that types `text` on the default layout. They see a marker over each
/// joint; only the first camera labels the fingers, and the third one labels nothing.
pub fn marker_lines(text: &str) -> Vec<String> {
    let line = |pose: &HandPose| markers::encode(Some(pose.time.0), &pose.positions());
    typing_poses(text).iter().map(line).collect()
}
