//! Panics of a source, a device and an observer while keys are pressed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Source, SourceEvent};
use ademan::device::keyboard::Keyboard;
use ademan::device::{Capabilities, DeviceInput, DeviceOutput, VirtualDevice};
use ademan::estimate::{Estimator, EstimatorSettings};
use ademan::output::{Desktop, Sink};
use ademan::pipeline::{LayoutInstance, Pipeline, PipelineSettings};
use ademan::session::{CommandReceiver, SessionError, run_pipeline};
use ademan::setup::Setup;
use ademan::snapshot::StepView;
use ademan::time::Timestamp;

use super::{repeat, wait_for_release};
use crate::support::hand::HoldingHand;
use crate::support::press::{Press, x11_code};
use crate::support::x11::XServer;

/// A flag that makes a thread panic.
#[derive(Clone, Default)]
struct Fuse(Arc<AtomicBool>);

impl Fuse {
    fn blow(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn check(&self) {
        assert!(!self.0.load(Ordering::Relaxed), "meant to happen");
    }
}

/// A value whose methods panic when its fuse has blown.
struct Fused<T>(T, Fuse);

impl Source for Fused<HoldingHand> {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.1.check();
        self.0.next()
    }

    fn name(&self) -> &str {
        self.0.name()
    }
}

impl VirtualDevice for Fused<Keyboard> {
    fn add_capabilities(&self, needs: &mut Capabilities) {
        self.0.add_capabilities(needs);
    }

    fn update(&mut self, seen: &DeviceInput, out: &mut DeviceOutput) {
        self.1.check();
        self.0.update(seen, out);
    }

    fn release_all(&mut self, time: Timestamp, out: &mut DeviceOutput) {
        self.1.check();
        self.0.release_all(time, out);
    }
}

/// The fuses of a run.
#[derive(Default)]
struct Fuses {
    source: Fuse,
    device: Fuse,
    observer: Fuse,
}

fn pipeline(fuse: Fuse) -> Pipeline {
    let loaded = Setup::default().load_files().expect("the default setup");
    let keyboard = Keyboard::new(loaded.layout.key_bindings());
    Pipeline::new(
        Estimator::new(EstimatorSettings::default())
            .with_channels(&loaded.glove.as_ref().expect("a glove").map),
        loaded.arm.clone(),
        LayoutInstance::new(
            loaded.layout.scene.clone(),
            loaded.layout.target_names(),
            vec![Box::new(Fused(keyboard, fuse))],
        ),
        // A busy machine must not cause a stall.
        PipelineSettings {
            stall_timeout: Duration::from_secs(10),
            ..PipelineSettings::default()
        },
    )
}

/// The result of a run, and its sink, so that dropping the sink does not release the keys.
type Ended = (thread::Result<Result<(), SessionError>>, Desktop);

/// Starts a run in a thread, with a hand that holds Shift and H.
fn start(server: &XServer, fuses: &Fuses) -> JoinHandle<Ended> {
    let mut sink =
        Desktop::open(Some(server.display()), &Capabilities::default()).expect("the server runs");
    let source = Fused(
        HoldingHand::new(&Press::for_text("H"), Duration::MAX),
        fuses.source.clone(),
    );
    let mut pipeline = pipeline(fuses.device.clone());
    let observer = fuses.observer.clone();
    thread::spawn(move || {
        let run = || {
            let mut observe = |_: &StepView| observer.check();
            run_pipeline(
                source,
                &mut pipeline,
                &mut sink,
                &CommandReceiver::disconnected(),
                &mut observe,
            )
            .map(drop)
        };
        let outcome = catch_unwind(AssertUnwindSafe(run));
        (outcome, sink)
    })
}

/// Blows a fuse while keys are pressed and returns the result of the run.
fn outcome_of(what: &str, fuse: fn(&Fuses) -> &Fuse) -> Option<Ended> {
    let mut outcome = None;
    repeat(|| {
        let Some(server) = XServer::start() else {
            return true;
        };
        let fuses = Fuses::default();
        let running = start(&server, &fuses);
        let are_pressed = server.wait_for_keys(&[x11_code("H"), x11_code("ShiftLeft")]);
        let start = Instant::now();
        fuse(&fuses).blow();
        wait_for_release(&server, start, what);
        let ended = running.join().expect("the panic was caught");
        assert_eq!(server.pressed_keys(), [0; 0]);
        // A busy machine drops a press.
        assert!(are_pressed || ended.1.dropped_presses() > 0);
        outcome = are_pressed.then_some(ended);
        are_pressed
    });
    outcome
}

#[test]
fn all_keys_are_released_after_a_panic_of_the_source() {
    let Some((outcome, _sink)) = outcome_of("the source panicked", |fuses| &fuses.source) else {
        return;
    };
    let Ok(Err(SessionError::Capture(error))) = outcome else {
        panic!("not an error of the source: {outcome:?}");
    };
    assert!(error.to_string().contains("meant to happen"), "{error}");
}

#[test]
fn all_keys_are_released_after_a_panic_of_a_device() {
    let Some((outcome, _sink)) = outcome_of("the device panicked", |fuses| &fuses.device) else {
        return;
    };
    assert!(outcome.is_err());
}

#[test]
fn all_keys_are_released_after_a_panic_of_the_observer() {
    let Some((outcome, _sink)) = outcome_of("the observer panicked", |fuses| &fuses.observer)
    else {
        return;
    };
    assert!(outcome.is_err());
}
