//! `ademan delay`: the delay of the arm's source behind the fingers' source.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use ademan::capture::{CaptureEvent, CaptureThread, Reading, SourceUri, spawn};
use ademan::estimate::delay::{Activity, estimate_delay};
use ademan::estimate::{Estimator, EstimatorSettings, Smoothing};
use ademan::message::escape;
use ademan::setup::LoadedSetup;
use ademan::time::Timestamp;
use crossbeam_channel::RecvTimeoutError;

use crate::failure::Failure;
use crate::setup_args::{SetupArgs, number_in};

/// The time for which a source may show nothing at first: a person starts the program that sends, or puts a headset on.
const MAX_WAIT: Duration = Duration::from_secs(60);

/// Measure the delay between two sources of one hand, from a movement that both see
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  ademan delay --source serial:/dev/ttyUSB0 --arm-source 'udp:127.0.0.1:5005?protocol=body-landmarks'"
)]
pub struct Args {
    /// Setup file. The default is setup.ron in the configuration folder, if it exists
    #[arg(long)]
    setup: Option<String>,
    /// Time of the movement, in seconds
    #[arg(long, value_name = "S", default_value = "10", value_parser = seconds)]
    seconds: f64,
    #[command(flatten)]
    flags: SetupArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let setup = args.flags.read_setup(args.setup.as_deref())?;
    let setup = setup.load_files()?;
    let (Some(source), Some(arm_source)) = (&setup.setup.source, &setup.setup.arm_source) else {
        return Err(Failure::wrong_use(
            "two sources are compared; name them with --source and --arm-source, or in a setup",
        ));
    };
    say!(
        "for {} s: open and close the hand and move the arm, both at once",
        args.seconds
    );
    let start = Instant::now();
    let mut records = [
        Record::start(&setup, source, start)?,
        Record::start(&setup, arm_source, start)?,
    ];
    let mut end = start + MAX_WAIT;
    let mut is_waiting = true;
    while Instant::now() < end && records.iter().any(|record| !record.has_ended) {
        for record in &mut records {
            record.receive()?;
        }
        if is_waiting && records.iter().all(|record| record.has_shown) {
            is_waiting = false;
            end = Instant::now() + Duration::from_secs_f64(args.seconds);
        }
    }
    if let Some(index) = records.iter().position(|record| !record.has_shown) {
        return Err(Failure::job(format!(
            "{} has shown no hand; start what sends to it, and keep the hand in view",
            escape(&[source, arm_source][index].to_string())
        )));
    }
    let [fingers, arm] = records;
    let delay = estimate_delay(&fingers.activity, &arm.activity).map_err(|error| {
        Failure::job(format!(
            "no delay found: {error}; repeat it with larger and irregular movements of hand and arm together"
        ))
    })?;
    let milliseconds = (delay.seconds.abs() * 1e3).round();
    let (late, early) = if delay.seconds >= 0.0 {
        (arm_source, source)
    } else {
        (source, arm_source)
    };
    let [late, early] = [late, early].map(|uri| escape(&uri.to_string()).into_owned());
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "{late} is {milliseconds} ms behind {early} (correlation {:.2})",
        delay.correlation
    )?;
    Ok(writeln!(
        out,
        "add `delay_ms={milliseconds}` to the options of {late}"
    )?)
}

/// The movement that a source sees.
struct Record {
    capture: CaptureThread,
    estimator: Estimator,
    activity: Activity,
    start: Instant,
    /// `true` once a reading was accepted.
    has_shown: bool,
    has_ended: bool,
}

impl Record {
    fn start(setup: &LoadedSetup, uri: &SourceUri, start: Instant) -> Result<Self, Failure> {
        // A filter delays, and a limit hides movement.
        let estimator = Estimator::new(EstimatorSettings::unchecked(Smoothing::Off));
        let estimator = match &setup.glove {
            Some(glove) => estimator.with_channels(&glove.map),
            None => estimator,
        };
        Ok(Self {
            capture: spawn(setup.open_source_alone(uri)?)?,
            estimator,
            activity: Activity::default(),
            start,
            has_shown: false,
            has_ended: false,
        })
    }

    /// Handles the events that have arrived.
    fn receive(&mut self) -> Result<(), Failure> {
        let event = self.capture.events().recv_timeout(Duration::from_millis(2));
        match event {
            Ok(CaptureEvent::Reading {
                reading,
                received_at,
                ..
            }) => self.push(&reading, received_at),
            // A thread that is gone sends no end.
            Ok(CaptureEvent::End(_)) | Err(RecvTimeoutError::Disconnected) => self.has_ended = true,
            Ok(CaptureEvent::Lost(error) | CaptureEvent::Failed(error)) => {
                return Err(error.into());
            }
            // Readings come one by one.
            Ok(
                CaptureEvent::Noise(_)
                | CaptureEvent::Elapsed(_)
                | CaptureEvent::Command(_)
                | CaptureEvent::Readings { .. },
            )
            | Err(RecvTimeoutError::Timeout) => {}
        }
        Ok(())
    }

    fn push(&mut self, reading: &Reading, received_at: Instant) {
        let time = if self.capture.is_live() {
            Timestamp(received_at.duration_since(self.start).as_micros() as u64)
        } else {
            reading.time
        };
        if let Ok(estimate) = self.estimator.update(reading) {
            self.activity.push(time, estimate);
            self.has_shown = true;
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    number_in(text, 3.0, 60.0, "seconds")
}
