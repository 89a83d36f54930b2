//! The interface to a display.

use super::burst::Stroke;
#[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
use super::composing::Composing;
use super::direct_keys::DirectConnection;
use super::key_reporter::KeyReporter;
use super::pending_motion::StatelessAction;
use crate::output::character_key::CharacterKey;
use crate::output::watchdog::ReleaseTarget;
use ademan_core::device::KeyCode;
use ademan_core::device::pressed_keys::{KeyDirection, PressedKeys};

/// The identifier of a window on a display.
pub type WindowId = u32;

/// A connection to a display, which presses and releases keys and buttons.
pub trait Injector {
    /// Presses or releases `key`. Returns `Ok` only if the display has accepted it.
    fn inject(&mut self, key: KeyCode, direction: KeyDirection) -> Result<(), String>;

    /// Performs an action that leaves nothing pressed.
    fn perform(&mut self, action: StatelessAction) -> Result<(), String>;

    /// Reads what the display has sent, without waiting. Fails if the connection is closed.
    fn check_connection(&mut self) -> Result<(), String> {
        Ok(())
    }

    /// Executes a burst entirely. Returns `false` if it has executed nothing, as the display cannot type all of it now. Reports
    /// the keys that it adds to the keymap of the display.
    fn type_burst(&mut self, _: &[Stroke], _reporter: &mut KeyReporter) -> Result<bool, String> {
        Ok(false)
    }

    /// Writes text to the focused field. Returns `false` if the field is another one by now, or the display takes no text.
    #[cfg(all(feature = "ime", feature = "wayland", target_os = "linux"))]
    fn compose(&mut self, _: &Composing) -> Result<bool, String> {
        Ok(false)
    }

    /// Removes the keys that it has added to the keymap, after receivers had time to look them up.
    fn restore_keymap(&mut self, _reporter: &mut KeyReporter) {}

    /// Removes the keys from the keymap that another process has added, unless the user has changed them since.
    #[cfg_attr(
        not(target_os = "linux"),
        allow(dead_code, reason = "only the watchdog and the next run ask")
    )]
    fn remove_character_keys(&mut self, _keys: &[CharacterKey]) -> Result<(), String> {
        Ok(())
    }

    /// Waits until the display has executed all requests, so that the next is executed at once.
    fn wait_until_responsive(&mut self) -> Result<(), String> {
        Ok(())
    }

    /// Returns the window that had the focus at the end of the last [`wait_until_responsive`](Self::wait_until_responsive), or `None`
    /// if the display does not report it.
    fn focus(&self) -> Option<WindowId> {
        None
    }

    /// Prepares to ask for the focus, and for presses of other devices, without waiting.
    fn watch_focus(&mut self) {}

    /// Returns the window that had the focus at the last call that returned one, or at the first call, if the answer has arrived
    /// since. Does not wait.
    fn poll_focus(&mut self) -> Option<WindowId> {
        None
    }

    /// Returns `true` if a keyboard, mouse or touch screen other than this injector was pressed since the last call. The first call
    /// starts the watch. Does not wait.
    fn poll_foreign_press(&mut self) -> bool {
        false
    }

    /// Returns the keys among `keys` that are pressed on the display, or `None` if it does not report them.
    #[cfg_attr(
        not(target_os = "linux"),
        allow(dead_code, reason = "only the watchdog asks")
    )]
    fn query_pressed(&mut self, _: &PressedKeys) -> Result<Option<PressedKeys>, String> {
        Ok(None)
    }

    /// Opens a connection on which the loop itself presses and releases keys, or returns `None` if the display cannot revoke
    /// a press that is too late.
    fn open_direct_connection(&mut self) -> Option<DirectConnection> {
        None
    }

    /// Returns the handle with which the watchdog releases keys that this injector has pressed.
    fn release_target(&self) -> ReleaseTarget {
        ReleaseTarget::default()
    }
}
