//! The injector of the watchdog, which only releases keys.

use crate::output::desktop::connect;
use crate::output::desktop::injector::Injector;
use crate::output::desktop::pending_motion::StatelessAction;
use crate::output::watchdog_process::release_thread::Releaser;
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::KeyDirection;

/// A connection to the desktop that releases keys and never presses one.
pub struct KeyReleaser(Box<dyn Injector>);

impl KeyReleaser {
    /// Connects to the desktop of the session.
    pub fn connect() -> Result<Self, String> {
        connect(None, false).map(Self)
    }
}

impl Injector for KeyReleaser {
    fn inject(&mut self, key: KeyCode, _: KeyDirection) -> Result<(), String> {
        self.0.inject(key, KeyDirection::Release)
    }

    fn perform(&mut self, _: StatelessAction) -> Result<(), String> {
        Err("the watchdog only releases keys".into())
    }
}

impl Releaser for KeyReleaser {
    /// Does nothing: a desktop has no axes.
    fn center_axes(&mut self) {}
}
