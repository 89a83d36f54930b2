//! A control of one's own: here a drum pad that tells how hard it was hit.
//!
//! Whatever makes events out of touches (a slider, a knob, a lever) is a [`VirtualDevice`]. A simulated
//! hand taps three keys, and the pad answers each hit with one value from 0 to 1:
//! `cargo run --example custom_control`

use std::collections::BTreeMap;

use ademan::contact::{Phase, TargetId};
use ademan::device::{Capabilities, DeviceInput, DeviceOutput, EventKind, VirtualDevice};
use ademan::estimate::{Estimator, EstimatorSettings};
use ademan::output;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan::session::run_pipeline;
use ademan::setup::Setup;
use ademan::time::Timestamp;

/// The hit that counts as 1: so many travels of a key in a second.
const HARDEST: f32 = 100.0;

/// When each key that is touched was reached.
#[derive(Default)]
struct DrumPad {
    touched: BTreeMap<TargetId, Timestamp>,
}

impl VirtualDevice for DrumPad {
    /// What all outputs are told needs no output that can carry it.
    fn add_capabilities(&self, _: &mut Capabilities) {}

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        for touch in seen.touches {
            match touch.phase {
                Phase::Touched => {
                    self.touched.insert(touch.target, touch.time);
                }
                Phase::Pressed => {
                    let Some(touched) = self.touched.remove(&touch.target) else {
                        continue;
                    };
                    let seconds = touch.time.since(touched).as_secs_f32();
                    let hardness = (touch.depth / seconds / HARDEST).min(1.0);
                    out.emit(touch.time, EventKind::Depth(touch.target, hardness));
                }
                _ => {}
            }
        }
    }

    /// A pad holds nothing down.
    fn release_all(&mut self, _: Timestamp, _: &mut DeviceOutput) {
        self.touched.clear();
    }
}

fn main() -> anyhow::Result<()> {
    let setup = Setup {
        layout: "numpad".into(),
        ..Setup::default()
    };
    let assembly = setup.load_files()?;
    let mut pipeline = Pipeline::new(
        Estimator::new(EstimatorSettings::default()).with_channels(&assembly.glove.map),
        assembly.arm.clone(),
        LayoutInstance::new(
            assembly.layout.scene.clone(),
            assembly.layout.target_names(),
            vec![Box::new(DrumPad::default())],
        ),
        PipelineSettings::default(),
    );
    let hand = assembly.open_source(&"typist:159".parse()?)?;
    let mut sink = output::open("transcript", &assembly.required_capabilities())?;
    let never = crossbeam_channel::never();
    run_pipeline(hand, &mut pipeline, &mut *sink, &never, &mut |_| {})?;
    Ok(())
}
