//! A custom control: a drum pad that reports the strength of each hit.
//!
//! Every control that turns touches into events (slider, knob, lever) is a [`VirtualDevice`]. A simulated hand
//! taps three keys, and the drum pad emits one depth event per hit, 0 to 1:
//! `cargo run --example custom_control`

use std::collections::BTreeMap;

use ademan::contact::{Phase, TargetId};
use ademan::device::{Capabilities, DeviceInput, DeviceOutput, EventKind, VirtualDevice};
use ademan::estimate::{Estimator, EstimatorSettings};
use ademan::output;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::Setup;
use ademan::time::Timestamp;

/// The speed of the strongest hit, in key travels per second.
const MAX_SPEED: f32 = 100.0;

/// The time at which each touched key was reached.
#[derive(Default)]
struct DrumPad {
    touched: BTreeMap<TargetId, Timestamp>,
}

impl VirtualDevice for DrumPad {
    /// Depth events need no capability: every output accepts them.
    fn add_capabilities(&self, _: &mut Capabilities) {}

    fn update(&mut self, input: &DeviceInput, out: &mut DeviceOutput) {
        for touch in input.touches {
            match touch.phase {
                Phase::Touched => {
                    self.touched.insert(touch.target, touch.time);
                }
                Phase::Pressed => {
                    let Some(touched) = self.touched.remove(&touch.target) else {
                        continue;
                    };
                    let seconds = touch.time.since(touched).as_secs_f32();
                    let strength = (touch.depth / seconds / MAX_SPEED).min(1.0);
                    out.emit(touch.time, EventKind::Depth(touch.target, strength));
                }
                _ => {}
            }
        }
    }

    /// A drum pad holds no keys.
    fn release_all(&mut self, _: Timestamp, _: &mut DeviceOutput) {
        self.touched.clear();
    }
}

fn main() -> anyhow::Result<()> {
    let setup = Setup {
        layout: "numpad".into(),
        ..Setup::default()
    };
    let loaded = setup.load_files()?;
    let mut pipeline = Pipeline::new(
        Estimator::new(EstimatorSettings::default())
            .with_channels(&loaded.glove.as_ref().expect("a glove").map),
        loaded.arm.clone(),
        LayoutInstance::new(
            loaded.layout.scene.clone(),
            loaded.layout.target_names(),
            vec![Box::new(DrumPad::default())],
        ),
        PipelineSettings::default(),
    );
    let hand = loaded.open_source(&"typist:159".parse()?)?;
    let mut sink = output::open("transcript", &loaded.required_capabilities())?;
    let commands = CommandReceiver::disconnected();
    run_pipeline(hand, &mut pipeline, &mut *sink, &commands, &mut |_| {})?;
    Ok(())
}
