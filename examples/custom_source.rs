//! A source of joint angles, such as a camera or another glove: a hand that nods with its index finger.
//!
//! Everything after a [`Source`] stays as it is. Prints the events of the key below the finger:
//! `cargo run --example custom_source`

use std::f64::consts::TAU;

use ademan::capture::{CaptureError, Reading, Sample, Source, SourceEvent};
use ademan::hand::{Dof, JointAngles};
use ademan::session::{Session, SessionOptions};
use ademan::setup::Setup;
use ademan::time::Timestamp;

const LAYOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/one-key.ron");
const READINGS_PER_SECOND: u64 = 100;
const NODS: u64 = 3;

/// Nods once per second.
#[derive(Default)]
struct NoddingHand {
    readings: u64,
}

impl Source for NoddingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.readings == NODS * READINGS_PER_SECOND {
            return Ok(SourceEvent::End);
        }
        let seconds = self.readings as f64 / READINGS_PER_SECOND as f64;
        self.readings += 1;
        let mut angles = JointAngles::default();
        // From 0 to 1.2 rad and back.
        angles.set(Dof::IndexMcpFlexion, 0.6 - 0.6 * (TAU * seconds).cos());
        Ok(SourceEvent::Reading(Reading::new(
            Timestamp::from_seconds(seconds),
            None,
            Sample::Angles { angles },
        )))
    }

    fn name(&self) -> &str {
        "nodding hand"
    }

    /// A source that is not live waits for the session, which then loses no reading.
    fn is_live(&self) -> bool {
        false
    }
}

fn main() -> anyhow::Result<()> {
    let setup = Setup {
        layout: LAYOUT.into(),
        output: "transcript".into(),
        ..Setup::default()
    };
    let options = SessionOptions {
        source: Some(Box::new(NoddingHand::default())),
        ..SessionOptions::default()
    };
    Session::start(setup.load_files()?, options)?.join()?;
    Ok(())
}
