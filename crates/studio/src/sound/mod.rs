//! Clicks on presses, played by the sound server of the desktop.
//!
//! ```text
//!  session ─ snapshots ─▶ thread: ClickChooser ─ Click ─▶ thread: SoundServer ─▶ PulseAudio or PipeWire
//!                            └─ snapshots ─▶ window
//! ```
//!
//! The window does not play the clicks: a desktop may stop drawing a window that is hidden, and typing into other programs goes on
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
use super::settings::SoundSettings;
use ademan_core::snapshot::Snapshot;
use ademan_runtime::session::view::{View, Viewer};

/// Clicks that wait for the sound server. More would be late.
const QUEUED_CLICKS: usize = 4;

/// Snapshots that wait for the window, as many as wait for this module.
const QUEUED_SNAPSHOTS: usize = 64;

/// Reason why clicks are not heard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SoundError {
    /// No sound server is reached.
    #[error(
        "no clicks are heard: {0}; start PulseAudio or PipeWire, or turn the clicks off under Settings"
    )]
    NoServer(String),
    /// The server does not play the click.
    #[error(
        "no clicks are heard: the sound server refuses them: {0}; check its sound device, or turn the clicks off under Settings"
    )]
    Refused(String),
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

/// The clicks of a session.
pub struct Sound {
    volume: Volume,
    /// The settings that the threads have; `None` before the first ones.
    applied: Option<SoundSettings>,
    clicks: Sender<Click>,
    errors: Receiver<SoundError>,
    /// The first error since the clicks were turned on.
    error: Option<SoundError>,
}

impl Sound {
    /// Starts the threads, with the clicks off, and returns the snapshots for the window. The viewer names the active layout.
    pub fn start(
        snapshots: Receiver<Snapshot>,
        viewer: Viewer,
    ) -> io::Result<(Self, Receiver<Snapshot>)> {
        let volume = Volume::default();
        let (clicks, queued) = bounded(QUEUED_CLICKS);
        let (report, errors) = bounded(1);
        let own = volume.clone();
        let player = thread::Builder::new().name("sound".into());
        player.spawn(move || play(&queued, &own, &report))?;
        let (window, shown) = bounded(QUEUED_SNAPSHOTS);
        let (own, chosen) = (volume.clone(), clicks.clone());
        let chooser = thread::Builder::new().name("clicks".into());
        chooser.spawn(move || choose(&snapshots, viewer.views(), &own, &chosen, &window))?;
        let sound = Self {
            volume,
            applied: None,
            clicks,
            errors,
            error: None,
        };
        Ok((sound, shown))
    }

    /// Applies the settings. A change that leaves the clicks on plays one, as a sample.
    pub fn apply(&mut self, settings: SoundSettings) {
        let error = self.errors.try_recv().ok();
        self.error = self.error.take().or(error).filter(|_| settings.is_on);
        if self.applied == Some(settings) {
            return;
        }
        self.volume.set(settings.level());
        if self.applied.replace(settings).is_some() && settings.level() > 0.0 {
            _ = self.clicks.try_send(Click::Key);
        }
    }

    /// Returns the reason why clicks are not heard, until they are turned off.
    pub fn error(&self) -> Option<&SoundError> {
        self.error.as_ref()
    }
}

/// Passes snapshots on to the window and their clicks to the player, until the session or the window ends.
fn choose(
    snapshots: &Receiver<Snapshot>,
    views: &Receiver<View>,
    volume: &Volume,
    clicks: &Sender<Click>,
    window: &Sender<Snapshot>,
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
        if let Err(TrySendError::Disconnected(_)) = window.try_send(snapshot) {
            return;
        }
    }
}

/// Plays clicks, and connects to the server at the first one and after it was lost.
fn play(clicks: &Receiver<Click>, volume: &Volume, errors: &Sender<SoundError>) {
    let mut server = None;
    for click in clicks {
        // A connection takes time; of the clicks before, the latest is played.
        let click = clicks.try_iter().last().unwrap_or(click);
        let connected = match server.take() {
            Some(server) => Ok(server),
            None => SoundServer::connect(),
        };
        let played = connected.and_then(|mut it: SoundServer| {
            it.play(click, volume.get())?;
            Ok(it)
        });
        match played {
            Ok(connected) => server = Some(connected),
            Err(error) => _ = errors.try_send(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::click::tests::step;
    use super::*;
    use ademan_runtime::session::{Session, SessionOptions};
    use ademan_runtime::setup::Setup;

    fn settings(is_on: bool) -> SoundSettings {
        SoundSettings { is_on, volume: 0.5 }
    }

    /// Sound without threads, with the ends of its channels.
    fn unplugged() -> (Sound, Receiver<Click>, Sender<SoundError>) {
        let (clicks, queued) = bounded(QUEUED_CLICKS);
        let (report, errors) = bounded(1);
        let sound = Sound {
            volume: Volume::default(),
            applied: None,
            clicks,
            errors,
            error: None,
        };
        (sound, queued, report)
    }

    #[test]
    fn a_change_of_the_settings_is_heard_and_the_start_is_not() {
        let (mut sound, queued, _errors) = unplugged();
        sound.apply(settings(true));
        assert_eq!(queued.len(), 0);
        assert_eq!(sound.volume.get(), 0.5);
        sound.apply(settings(false));
        assert_eq!((queued.len(), sound.volume.get()), (0, 0.0));
        sound.apply(settings(true));
        sound.apply(settings(true));
        assert_eq!(queued.len(), 1);
    }

    #[test]
    fn a_missing_server_is_reported_until_the_clicks_are_turned_off() {
        let (mut sound, _queued, errors) = unplugged();
        let error = |reason: &str| SoundError::NoServer(reason.into());
        sound.apply(settings(true));
        assert_eq!(sound.error(), None);
        for reason in ["gone", "still gone"] {
            errors.try_send(error(reason)).expect("room");
            sound.apply(settings(true));
            assert_eq!(sound.error(), Some(&error("gone")));
        }
        errors.try_send(error("late")).expect("room");
        sound.apply(settings(false));
        assert_eq!(sound.error(), None);
        sound.apply(settings(true));
        assert_eq!(sound.error(), None);
    }

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
        let (mut sound, window) = Sound::start(snapshots, viewer).expect("threads");
        sound.apply(settings(true));
        // The window receives nothing.
        for _ in 0..2 * QUEUED_SNAPSHOTS {
            sender.send(step()).expect("the thread receives");
        }
        assert_eq!(window.len(), QUEUED_SNAPSHOTS);
    }
}
