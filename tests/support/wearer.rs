//! A glove whose bytes go straight through the engine: what is typed does not depend on how busy the machine is.

use ademan::capture::hc11::{Framing, Hc11Decoder, PACKET_BYTES, body, channels, encode};
use ademan::capture::protocol::{Decoder, Packet};
use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::estimate::{Estimator, EstimatorSettings, Rejection};
use ademan::kinematics::ArmModel;
use ademan::pipeline::PipelineState;
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan::setup::{LoadedSetup, Setup};
use ademan::time::Timestamp;

use super::press::{Posture, glove_format};

/// The default setup.
pub fn assembly() -> LoadedSetup {
    Setup::default().load_files().expect("the default setup")
}

/// A pipeline that the first reading arms, with an estimator of its own.
pub fn pipeline_with(assembly: &LoadedSetup, estimator: Estimator) -> Pipeline {
    let arm: ArmModel = assembly.arm.clone();
    let controls: LayoutInstance = ademan::setup::controls(&assembly.layout);
    let arming = PipelineSettings {
        arm_immediately: true,
        ..PipelineSettings::default()
    };
    Pipeline::new(estimator, arm, controls, arming)
}

/// Somebody who wears the glove, armed by the first reading.
pub struct GloveWearer {
    pub pipeline: Pipeline,
    decoder: Hc11Decoder,
    bytes: usize,
    /// Time that passed without bytes, in microseconds.
    silence: u64,
    /// In microseconds; a frame takes as long as on a line.
    pub now: u64,
    typed: Vec<String>,
}

impl GloveWearer {
    pub fn on(assembly: &LoadedSetup) -> Self {
        let map = assembly.glove.map.clone();
        let estimator = Estimator::new(EstimatorSettings::default()).with_channels(&map);
        Self::with(pipeline_with(assembly, estimator))
    }

    pub fn with(pipeline: Pipeline) -> Self {
        Self {
            pipeline,
            decoder: Hc11Decoder::new(Framing::Double06),
            bytes: 0,
            silence: 0,
            now: 0,
            typed: Vec::new(),
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
            let _ = self.see(&body);
        }
    }

    /// Frames on the line.
    pub fn play(&mut self, postures: &[Posture]) {
        self.send(&stream(postures));
    }

    /// Takes a posture at this very moment.
    pub fn see(&mut self, posture: &Posture) -> Option<Rejection> {
        let reading = Reading {
            time: Timestamp(self.now),
            side: None,
            sample: Sample::Channels(channels(posture)),
        };
        let mut events = Events::new();
        let rejection = self.pipeline.step(&reading, &mut events).err();
        self.note(&events);
        rejection
    }

    /// Takes a posture some microseconds later.
    pub fn see_after(&mut self, microseconds: u64, posture: &Posture) -> Option<Rejection> {
        self.silence += microseconds;
        self.now += microseconds;
        self.see(posture)
    }

    fn note(&mut self, events: &Events) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.typed.push(format!("down {key}")),
                EventKind::KeyUp(key) => self.typed.push(format!("up {key}")),
                _ => {}
            }
        }
    }

    /// What was typed since the last call.
    pub fn typed(&mut self) -> String {
        std::mem::take(&mut self.typed).join(", ")
    }

    pub fn readings(&self) -> u64 {
        self.decoder.stats().readings
    }

    pub fn runs(&self) -> bool {
        self.pipeline.state() == PipelineState::Running
    }
}

/// What the glove sends in these postures, one after the other.
pub fn stream(postures: &[Posture]) -> Vec<u8> {
    let frames = postures.iter();
    let bytes: Vec<u8> = frames
        .flat_map(|posture| encode(Framing::Double06, posture))
        .collect();
    assert_eq!(bytes.len(), PACKET_BYTES * postures.len());
    bytes
}
