//! A recording is played through the same loop as a glove, and gives the same events each time.
//!
//! `cargo run --example replay_to_stdout -- FILE` plays a recording; without a file a simulated hand
//! is recorded first.

use std::path::Path;

use ademan::capture::recording::Replay;
use ademan::output;
use ademan::recorder::Recorder;
use ademan::session::run_pipeline;
use ademan::setup::{LoadedSetup, Setup};

fn main() -> anyhow::Result<()> {
    if let Some(path) = std::env::args_os().nth(1) {
        return replay(Path::new(&path));
    }
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("hand.mcap");
    record("played twice", &path)?;
    replay(&path)
}

/// The setup that a recording was made with is in it, so it needs nothing beside itself.
fn replay(path: &Path) -> anyhow::Result<()> {
    let recording = Replay::open(path)?;
    let assembly = LoadedSetup::from_recording(recording.setup(), None, None)?;
    let mut sink = output::open("transcript", &assembly.required_capabilities())?;
    let never = crossbeam_channel::never();
    run_pipeline(
        recording,
        &mut assembly.pipeline(),
        &mut *sink,
        &never,
        &mut |_| {},
    )?;
    Ok(())
}

/// Whoever observes the loop sees what every stage made of a frame; a recorder writes that down.
fn record(text: &str, path: &Path) -> anyhow::Result<()> {
    let assembly = Setup::default().load_files()?;
    let hand = assembly.open_source(&format!("typist:{text}").parse()?)?;
    let mut recorder = Recorder::create(path, &assembly.recorded_setup())?;
    let mut written = Ok(());
    let mut nowhere = output::open("none", &assembly.required_capabilities())?;
    let never = crossbeam_channel::never();
    run_pipeline(
        hand,
        &mut assembly.pipeline(),
        &mut *nowhere,
        &never,
        &mut |frame| {
            if written.is_ok() {
                written = recorder.write(frame);
            }
        },
    )?;
    written?;
    recorder.finish()?;
    Ok(())
}
