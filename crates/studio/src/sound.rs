//! Clicks on presses, with the settings of Studio.

use std::io;

use crossbeam_channel::{Receiver, bounded};

use super::settings::SoundSettings;
use ademan_core::snapshot::Snapshot;
use ademan_runtime::session::view::Viewer;
use ademan_runtime::sound::click::Click;
use ademan_runtime::sound::{ClickPlayer, SoundError};

/// Snapshots that wait for the window, as many as wait for the player.
const QUEUED_SNAPSHOTS: usize = 64;

/// The clicks of a session.
pub struct Sound {
    player: ClickPlayer,
    /// The settings that the player has; `None` before the first ones.
    applied: Option<SoundSettings>,
    /// The first error since the clicks were turned on.
    error: Option<SoundError>,
}

impl Sound {
    /// Starts the player, with the clicks off, and returns the snapshots for the window. The viewer names the active layout.
    pub fn start(
        snapshots: Receiver<Snapshot>,
        viewer: Viewer,
    ) -> io::Result<(Self, Receiver<Snapshot>)> {
        let (window, shown) = bounded(QUEUED_SNAPSHOTS);
        let player = ClickPlayer::start(snapshots, viewer, Some(window))?;
        Ok((Self::new(player), shown))
    }

    fn new(player: ClickPlayer) -> Self {
        Self {
            player,
            applied: None,
            error: None,
        }
    }

    /// Applies the settings. A change that leaves the clicks on plays one, as a sample. Returns `true` if there is an
    /// [error](Self::error) that was not there before.
    pub fn apply(&mut self, settings: SoundSettings) -> bool {
        let had_error = self.error.is_some();
        let error = self.player.errors().try_recv().ok();
        self.error = self.error.take().or(error).filter(|_| settings.is_on);
        let is_new = self.error.is_some() && !had_error;
        if self.applied == Some(settings) {
            return is_new;
        }
        self.player.set_volume(settings.level());
        if self.applied.replace(settings).is_some() && settings.level() > 0.0 {
            self.player.play(Click::Key);
        }
        is_new
    }

    /// Returns the reason why clicks are not heard, until they are turned off.
    pub fn error(&self) -> Option<&SoundError> {
        self.error.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(is_on: bool) -> SoundSettings {
        SoundSettings { is_on, volume: 0.5 }
    }

    #[test]
    fn a_change_of_the_settings_is_heard_and_the_start_is_not() {
        let (player, end) = ClickPlayer::new();
        let mut sound = Sound::new(player);
        sound.apply(settings(true));
        assert_eq!(end.waiting(), 0);
        assert_eq!(sound.player.volume(), 0.5);
        sound.apply(settings(false));
        assert_eq!((end.waiting(), sound.player.volume()), (0, 0.0));
        sound.apply(settings(true));
        sound.apply(settings(true));
        assert_eq!(end.waiting(), 1);
    }

    #[test]
    fn a_missing_server_is_reported_until_the_clicks_are_turned_off() {
        let (player, end) = ClickPlayer::new();
        let mut sound = Sound::new(player);
        let error = |reason: &str| SoundError::NoServer(reason.into());
        assert!(!sound.apply(settings(true)));
        assert_eq!(sound.error(), None);
        for (reason, is_new) in [("gone", true), ("still gone", false)] {
            end.report(error(reason));
            assert_eq!(sound.apply(settings(true)), is_new, "{reason}");
            assert_eq!(sound.error(), Some(&error("gone")));
            assert!(!sound.apply(settings(true)), "it is said once");
        }
        end.report(error("late"));
        assert!(!sound.apply(settings(false)));
        assert_eq!(sound.error(), None);
        sound.apply(settings(true));
        assert_eq!(sound.error(), None);
        end.report(error("gone again"));
        assert!(sound.apply(settings(true)));
    }
}
