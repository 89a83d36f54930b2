//! A recording played through the same session as a glove gives the same events each time.
//!
//! `cargo run --example replay_to_stdout -- FILE` plays a recording. Without a file it records a simulated hand first.

use std::path::Path;

use ademan::capture::recording::Replay;
use ademan::session::{Session, SessionOptions};
use ademan::setup::{LoadedSetup, ReplaySettings, Setup};

fn main() -> anyhow::Result<()> {
    if let Some(path) = std::env::args_os().nth(1) {
        return replay(Path::new(&path));
    }
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("hand.mcap");
    record("played twice", &path)?;
    replay(&path)
}

/// Plays a recording, which contains the setup that it was made with, and prints a transcript.
fn replay(path: &Path) -> anyhow::Result<()> {
    let recording = Replay::open(path)?;
    let mut setup = LoadedSetup::from_recording(recording.setup(), &ReplaySettings::default())?;
    setup.setup.output = "transcript".to_owned();
    let options = SessionOptions {
        source: Some(Box::new(recording)),
        ..SessionOptions::default()
    };
    Session::start(setup, options)?.join()?;
    Ok(())
}

/// Records a simulated hand that types `text`.
fn record(text: &str, path: &Path) -> anyhow::Result<()> {
    let setup = Setup {
        source: Some(format!("typist:{text}").parse()?),
        output: "none".to_owned(),
        ..Setup::default()
    };
    let options = SessionOptions {
        record_to: Some(path.to_owned()),
        ..SessionOptions::default()
    };
    Session::start(setup.load_files()?, options)?.join()?;
    Ok(())
}
