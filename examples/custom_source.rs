//! A source of one's own: here a hand that nods with its index finger, three times.
//!
//! Whatever gives readings (a glove, a camera, a network) is a [`Source`]; all that follows it stays
//! as it is. Prints the key events of the one key that lies under the finger:
//! `cargo run --example custom_source`

use std::f64::consts::TAU;

use ademan::capture::{CaptureError, Channels, MAX_CHANNELS, Reading, Sample, Source, SourceEvent};
use ademan::estimate::ChannelMap;
use ademan::hand::Dof;
use ademan::output;
use ademan::session::run_pipeline;
use ademan::setup::Setup;
use ademan::time::Timestamp;

const LAYOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/one-key.ron");
const FRAMES_A_SECOND: u64 = 100;
const NODS: u64 = 3;

struct NoddingHand {
    map: ChannelMap,
    frame: u64,
}

impl Source for NoddingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        if self.frame == NODS * FRAMES_A_SECOND {
            return Ok(SourceEvent::End);
        }
        let seconds = self.frame as f64 / FRAMES_A_SECOND as f64;
        self.frame += 1;
        let bent = 0.5 - 0.5 * (TAU * seconds).cos();
        let mut counts = [0; MAX_CHANNELS];
        for row in self.map.rows() {
            let angle = if row.dof == Dof::IndexMcpFlexion {
                bent
            } else {
                0.0
            };
            let count = row.calibration.apply_inverse(angle).round();
            counts[row.channel] = count.clamp(0.0, 255.0) as u16;
        }
        Ok(SourceEvent::Reading(Reading {
            time: Timestamp::from_seconds(seconds),
            side: None,
            sample: Sample::Channels(Channels {
                full_scale: self.map.full_scale(),
                counts: counts.into(),
            }),
        }))
    }

    fn name(&self) -> &str {
        "a nodding hand"
    }

    /// Nothing is lost when nobody takes the readings, so they come as fast as they are taken.
    fn is_live(&self) -> bool {
        false
    }
}

fn main() -> anyhow::Result<()> {
    let setup = Setup {
        layout: LAYOUT.into(),
        ..Setup::default()
    };
    let assembly = setup.load_files()?;
    let hand = NoddingHand {
        map: assembly.glove.map.clone(),
        frame: 0,
    };
    let mut sink = output::open("transcript", &assembly.required_capabilities())?;
    let never = crossbeam_channel::never();
    run_pipeline(
        hand,
        &mut assembly.pipeline(),
        &mut *sink,
        &never,
        &mut |_| {},
    )?;
    Ok(())
}
