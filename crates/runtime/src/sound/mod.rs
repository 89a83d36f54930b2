//! Clicks on presses, played by the sound server of the desktop.
//!
//! ```text
//!  session ─ snapshots ─▶ thread: ClickChooser ─ Click ─▶ thread: SoundServer ─▶ PulseAudio or PipeWire
//!                            └─ snapshots ─▶ window of Studio
//! ```
//!
//! A window does not play the clicks: a desktop may stop drawing a window that is hidden, and typing into other programs continues
//! then. No channel waits: a click that the server cannot play in time is dropped, as a late click is worse than none.

pub mod click;
mod server;
pub mod waveform;

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use self::click::{Click, ClickChooser};
use self::server::SoundServer;
use crate::session::view::{View, Viewer};
use ademan_core::snapshot::Snapshot;

/// Maximum number of clicks that wait for the sound server. Further ones would be late.
const QUEUED_CLICKS: usize = 4;

/// Volume of the clicks before it is chosen, as a fraction of the full volume.
pub const DEFAULT_VOLUME: f32 = 0.5;

/// Reason why no clicks are heard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SoundError {
    /// No sound server can be reached.
    #[error("no clicks are heard: {0}; start PulseAudio or PipeWire, or turn the clicks off")]
    NoServer(String),
    /// The server does not play the click.
    #[error(
        "no clicks are heard: the sound server refuses them: {0}; check its sound device, or turn the clicks off"
    )]
    Refused(String),
    /// This build or system has no clicks.
    #[error("no clicks are heard: {0}")]
    Unsupported(&'static str),
}

/// The volume of the clicks, 0..=1, shared with the threads. 0 is off.
#[derive(Clone, Debug, Default)]
struct Volume(Arc<AtomicU32>);

impl Volume {
    fn get(&self) -> f32 {
        f32::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn set(&self, volume: f32) {
        self.0.store(volume.to_bits(), Ordering::Relaxed);
    }
}

/// Plays the clicks of a session.
pub struct ClickPlayer {
    volume: Volume,
    clicks: Sender<Click>,
    errors: Receiver<SoundError>,
}

/// The receiving end of a player, for its thread.
pub struct PlayerEnd {
    volume: Volume,
    clicks: Receiver<Click>,
    errors: Sender<SoundError>,
}

impl ClickPlayer {
    /// Creates a player that is off, without its threads.
    pub fn new() -> (Self, PlayerEnd) {
        let volume = Volume::default();
        let (clicks, queued) = bounded(QUEUED_CLICKS);
        let (report, errors) = bounded(1);
        let end = PlayerEnd {
            volume: volume.clone(),
            clicks: queued,
            errors: report,
        };
        let player = Self {
            volume,
            clicks,
            errors,
        };
        (player, end)
    }

    /// Starts the threads of a player that is off. They pass the snapshots on to `window`, if there is one, and end with it or with the
    /// session. The viewer names the active layout.
    pub fn start(
        snapshots: Receiver<Snapshot>,
        viewer: Viewer,
        window: Option<Sender<Snapshot>>,
    ) -> io::Result<Self> {
        let (player, end) = Self::new();
        let thread = thread::Builder::new().name("sound".into());
        thread.spawn(move || end.play())?;
        let (volume, chosen) = (player.volume.clone(), player.clicks.clone());
        let chooser = thread::Builder::new().name("clicks".into());
        chooser.spawn(move || {
            choose(
                &snapshots,
                viewer.views(),
                &volume,
                &chosen,
                window.as_ref(),
            );
        })?;
        Ok(player)
    }

    /// Sets the volume as a fraction of the full volume, on the scale that volume controls have. 0 turns the clicks off.
    pub fn set_volume(&self, volume: f32) {
        self.volume.set(volume);
    }

    /// Returns the volume.
    pub fn volume(&self) -> f32 {
        self.volume.get()
    }

    /// Plays a click, unless too many wait.
    pub fn play(&self, click: Click) {
        _ = self.clicks.try_send(click);
    }

    /// Returns the channel of errors, which holds one.
    pub fn errors(&self) -> &Receiver<SoundError> {
        &self.errors
    }
}

impl PlayerEnd {
    /// Returns the number of clicks that wait.
    pub fn waiting(&self) -> usize {
        self.clicks.len()
    }

    /// Reports an error, unless another one waits.
    pub fn report(&self, error: SoundError) {
        _ = self.errors.try_send(error);
    }

    /// Plays clicks, and connects to the server at the first one and after it was lost.
    fn play(&self) {
        let mut server = None;
        for click in &self.clicks {
            // A connection takes time; of the clicks that have waited, only the latest is played.
            let click = self.clicks.try_iter().last().unwrap_or(click);
            let connected = match server.take() {
                Some(server) => Ok(server),
                None => SoundServer::connect(),
            };
            let played = connected.and_then(|mut it: SoundServer| {
                it.play(click, self.volume.get())?;
                Ok(it)
            });
            match played {
                Ok(playing) => server = Some(playing),
                Err(error) => self.report(error),
            }
        }
    }
}

/// Passes snapshots on to the window and their clicks to the player, until the session or the window ends.
fn choose(
    snapshots: &Receiver<Snapshot>,
    views: &Receiver<View>,
    volume: &Volume,
    clicks: &Sender<Click>,
    window: Option<&Sender<Snapshot>>,
) {
    let mut chooser = ClickChooser::default();
    let Ok(View { mut layout, .. }) = views.recv() else {
        return;
    };
    for snapshot in snapshots {
        if let Some(view) = views.try_iter().last() {
            layout = view.layout;
        }
        let click = chooser.update(&snapshot, &layout);
        if let Some(click) = click.filter(|_| volume.get() > 0.0) {
            _ = clicks.try_send(click);
        }
        if let Some(window) = window
            && let Err(TrySendError::Disconnected(_)) = window.try_send(snapshot)
        {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::click::tests::step;
    use super::*;
    use crate::session::{Session, SessionOptions};
    use crate::setup::Setup;

    #[test]
    fn a_window_that_hangs_delays_neither_session_nor_clicks() {
        let setup = Setup {
            source: Some("typist:hello".parse().expect("a source")),
            output: "none".into(),
            ..Setup::default()
        };
        let setup = setup.load_files().expect("the shipped files");
        let session = Session::start(setup, SessionOptions::default()).expect("a session");
        let viewer = session.add_viewer();
        let (sender, snapshots) = bounded(0);
        let (window, shown) = bounded(8);
        let player = ClickPlayer::start(snapshots, viewer, Some(window)).expect("threads");
        player.set_volume(DEFAULT_VOLUME);
        // The window receives nothing.
        for _ in 0..20 {
            sender.send(step()).expect("the thread receives");
        }
        assert_eq!(shown.len(), 8);
    }
}
