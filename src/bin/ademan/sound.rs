//! Clicks of a run.

use std::thread;

use ademan::session::SessionHandle;
use ademan::sound::ClickPlayer;

use crate::failure::Failure;

/// The volume unless one is named, as in Studio.
pub const DEFAULT: &str = "0.5";

/// Parses a volume as a fraction of the full volume.
pub fn volume(text: &str) -> Result<f32, String> {
    let volume = text.parse::<f32>().ok();
    let volume = volume.filter(|volume| (0.0..=1.0).contains(volume));
    volume.ok_or_else(|| "the volume is a number from 0 to 1, such as 0.8".into())
}

/// Plays a click for each press at this volume until the session ends, and prints the first reason why clicks are not heard.
pub fn start(session: &SessionHandle, volume: f32) -> Result<(), Failure> {
    let player = ClickPlayer::start(session.snapshots().clone(), session.add_viewer(), None);
    let player = player.map_err(Failure::no_thread)?;
    player.set_volume(volume);
    let errors = player.errors().clone();
    let report = move || {
        if let Ok(error) = errors.recv() {
            complain!("{error}");
        }
    };
    let thread = thread::Builder::new()
        .name("sound errors".into())
        .spawn(report);
    thread.map(drop).map_err(Failure::no_thread)
}
