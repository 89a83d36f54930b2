//! A glove whose bytes go straight through the pipeline, so that the result does not depend on the load of the machine.

use ademan::capture::hc11::{Framing, Hc11Decoder, PACKET_BYTES, body, encode};
use ademan::capture::protocol::{Decoder, Packet};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimator, EstimatorSettings, Rejection};
use ademan::kinematics::ArmModel;
use ademan::pipeline::PipelineState;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan::setup::{LoadedSetup, Setup};
use ademan::time::Timestamp;

use super::press::{Posture, glove_format, reading};

/// Loads a setup whose layout has this text.
pub fn load_layout(text: &str, setup: Setup) -> LoadedSetup {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("layout.ron");
    std::fs::write(&path, text).expect("a file");
    let layout = path.display().to_string();
    let setup = Setup { layout, ..setup };
    setup.load_files().unwrap_or_else(|error| panic!("{error}"))
}

/// Loads the default setup with a layout that comes with the program.
pub fn shipped_setup(layout: &str) -> LoadedSetup {
    let setup = Setup {
        layout: layout.into(),
        ..Setup::default()
    };
    setup.load_files().expect("a shipped layout")
}

/// Loads the default setup.
pub fn default_setup() -> LoadedSetup {
    Setup::default().load_files().expect("the default setup")
}

/// Creates a pipeline with this estimator that the first reading arms.
pub fn pipeline_with(setup: &LoadedSetup, estimator: Estimator) -> Pipeline {
    let arm: ArmModel = setup.arm.clone();
    let instance: LayoutInstance = LayoutInstance::from_layout(&setup.layout);
    let settings = PipelineSettings {
        arm_immediately: true,
        ..PipelineSettings::default()
    };
    Pipeline::new(estimator, arm, instance, settings)
}

/// A worn glove and its pipeline, armed by the first reading.
pub struct GloveWearer {
    pub pipeline: Pipeline,
    decoder: Hc11Decoder,
    bytes: usize,
    /// The time without bytes so far, in microseconds.
    silence: u64,
    /// The current time in microseconds; bytes take as long as on a serial line.
    pub now: u64,
    events: Vec<String>,
}

impl GloveWearer {
    /// Creates the default estimator and the pipeline of a setup.
    pub fn new(setup: &LoadedSetup) -> Self {
        let map = setup.glove.as_ref().expect("a glove").map.clone();
        let estimator = Estimator::new(EstimatorSettings::default()).with_channels(&map);
        Self::with_pipeline(pipeline_with(setup, estimator))
    }

    /// Uses this pipeline.
    pub fn with_pipeline(pipeline: Pipeline) -> Self {
        Self {
            pipeline,
            decoder: Hc11Decoder::new(Framing::Double06),
            bytes: 0,
            silence: 0,
            now: 0,
            events: Vec::new(),
        }
    }

    /// Sends bytes over the line.
    pub fn send(&mut self, bytes: &[u8]) {
        let mut bodies = Vec::new();
        for byte in bytes {
            self.bytes += 1;
            let time =
                self.silence + glove_format().transmission_time(self.bytes).as_micros() as u64;
            let push = &mut |packet: Packet| {
                bodies.push((time, body(&packet.sample).expect("channels")));
            };
            self.decoder.push(&[*byte], push);
        }
        for (time, body) in bodies {
            self.now = time;
            let _ = self.show(&body);
        }
    }

    /// Sends a packet for each posture.
    pub fn play(&mut self, postures: &[Posture]) {
        self.send(&packets(postures));
    }

    /// Gives the pipeline a posture at the current time.
    pub fn show(&mut self, posture: &Posture) -> Option<Rejection> {
        let reading = reading(Timestamp(self.now), posture);
        let mut events = Events::new();
        let rejection = self.pipeline.step(&reading, &mut events).err();
        self.write(&events);
        rejection
    }

    /// Gives the pipeline a posture some microseconds later.
    pub fn show_after(&mut self, microseconds: u64, posture: &Posture) -> Option<Rejection> {
        self.silence += microseconds;
        self.now += microseconds;
        self.show(posture)
    }

    fn write(&mut self, events: &Events) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.events.push(format!("down {key}")),
                EventKind::KeyUp(key) => self.events.push(format!("up {key}")),
                _ => {}
            }
        }
    }

    /// Removes and returns the key events since the last call.
    pub fn take_events(&mut self) -> String {
        std::mem::take(&mut self.events).join(", ")
    }

    /// Returns the number of packets so far.
    pub fn readings(&self) -> u64 {
        self.decoder.stats().readings
    }

    /// Returns `true` if the pipeline is armed and running.
    pub fn is_running(&self) -> bool {
        self.pipeline.state() == PipelineState::Running
    }
}

/// Returns the packets of these postures.
pub fn packets(postures: &[Posture]) -> Vec<u8> {
    let bytes: Vec<u8> = postures
        .iter()
        .flat_map(|posture| encode(Framing::Double06, posture))
        .collect();
    assert_eq!(bytes.len(), PACKET_BYTES * postures.len());
    bytes
}
