//! Devices made by the Linux kernel's `uinput` module: keyboard, mouse, pointer, gamepad.
//!
//! What the program presses goes through the kernel like the keys of any keyboard: X11, Wayland and
//! the console take it alike. When the program ends in any way, even killed, the kernel removes the
//! devices and lets go of their keys (`uinput_destroy_device`, `input_dev_release_keys`). It does not while the program
//! is stopped or stands still: for that there is a [guardian](super::guardian).

mod spec;
mod node;
mod tracked_device;
mod supervisor;

use std::io;

pub use node::{DeviceNode, UinputNode};
use spec::{DeviceKind, DeviceSpec};
use supervisor::WatchdogSupervisor;
use tracked_device::TrackedDevice;
pub(super) use tracked_device::{center_axes, release_key};

use super::watchdog::{ReleaseTarget, WatchdogSettings};
use super::{OutputError, OutputKind, Sink};
use crate::advice::{self, AccessDenied};
use crate::device::{Capabilities, Capability, EventKind, OutputEvent};

const OUTPUT: &str = "uinput";

/// The longest name of the devices, in bytes: `UINPUT_MAX_NAME_SIZE` less what ends it and what each
/// adds to it.
const NAME_LIMIT: usize = 78 - " keyboard".len();

/// Device not configured and no such device: what opening the node gives when nothing is behind it.
const NOTHING_BEHIND_NODE: [i32; 2] = [6, 19];

/// An output that is devices of its own, with just what a layout needs.
///
/// Each is made only when it is needed, and gets the events of a frame in one system call. The
/// keyboard does not repeat keys: whoever receives them does.
pub struct Uinput<N: DeviceNode = UinputNode> {
    needs: Capabilities,
    parts: Vec<TrackedDevice<N>>,
    /// Which of mouse and pointer has moved last, and takes the buttons. Whoever reads two devices may hear of
    /// the button before the place: a click must come from the device that brought the pointer there.
    leading: DeviceKind,
    refused: u64,
    ward: Option<WatchdogSupervisor>,
}

impl Uinput {
    /// Makes the devices that `needs` ask for; their names are `name` (at most 69 bytes) and what they
    /// are: `Ademan keyboard`, `Ademan mouse`, `Ademan pointer`, `Ademan gamepad`.
    pub fn open(name: &str, needs: &Capabilities) -> Result<Self, OutputError> {
        if name.is_empty() || name.len() > NAME_LIMIT || name.contains('\0') {
            return Err(refuse(format!(
                "`{name}` does not do as the name of devices: give 1 to {NAME_LIMIT} bytes"
            )));
        }
        let node = |declared: &DeviceSpec| {
            UinputNode::open(&format!("{name} {}", declared.kind.name()), declared)
        };
        Self::on(needs, node).map_err(|error| refuse(open_reason(&error)))
    }

    /// The same with a guardian, which lets go of keys and brings axes back when this program cannot.
    pub fn open_with_watchdog(
        name: &str,
        needs: &Capabilities,
        launch: &WatchdogSettings,
    ) -> Result<Self, OutputError> {
        let mut uinput = Self::open(name, needs)?;
        uinput.guard(launch).map_err(refuse)?;
        Ok(uinput)
    }
}

impl<N: DeviceNode> Uinput<N> {
    /// On nodes that `open` makes.
    fn on(needs: &Capabilities, open: impl Fn(&DeviceSpec) -> io::Result<N>) -> io::Result<Self> {
        let part =
            |declared: DeviceSpec| Ok(TrackedDevice::new(declared.clone(), open(&declared)?));
        let parts: io::Result<_> = DeviceSpec::for_capabilities(needs)
            .into_iter()
            .map(part)
            .collect();
        Ok(Self {
            needs: needs.clone(),
            parts: parts?,
            leading: DeviceKind::Mouse,
            refused: 0,
            ward: None,
        })
    }

    fn guard(&mut self, launch: &WatchdogSettings) -> Result<(), String> {
        if self.parts.is_empty() {
            return Ok(());
        }
        let devices: io::Result<_> = self
            .parts
            .iter()
            .map(TrackedDevice::watchdog_handle)
            .collect();
        let means = ReleaseTarget::Devices(devices.map_err(|error| error.to_string())?);
        self.ward = Some(WatchdogSupervisor::start(launch, means)?);
        Ok(())
    }

    /// Lets go of everything when the guardian is gone. An error when there will be no other.
    fn replace_lost_guardian(&mut self) -> io::Result<()> {
        let Some(ward) = &mut self.ward else {
            return Ok(());
        };
        if !ward.is_lost() {
            return ward
                .failure
                .clone()
                .map_or(Ok(()), |reason| Err(io::Error::other(reason)));
        }
        let released = self.each(TrackedDevice::release_all);
        if let Some(ward) = &mut self.ward {
            ward.replace();
        }
        released
    }

    /// Whether the guardian, if there is one, knows of what is about to happen.
    fn is_guarded(&mut self, action: EventKind) -> bool {
        match (&mut self.ward, action) {
            (Some(ward), EventKind::KeyDown(key)) => ward.may_go_down(key),
            (Some(ward), EventKind::Axis(_, value)) if value != 0.0 => ward.may_be_deflected(),
            _ => true,
        }
    }

    fn tell_guardian(&mut self) {
        if let Some(ward) = &mut self.ward {
            let parts = &self.parts;
            ward.note_rest(
                |key| parts.iter().any(|part| part.is_pressed(key)),
                parts.iter().any(TrackedDevice::is_deflected),
            );
        }
    }

    /// Puts an action into the frame of its device; one that is not among the needs is refused.
    fn take(&mut self, action: EventKind) -> io::Result<()> {
        let need = Capability::required_by(action).filter(|need| self.needs.contains(*need));
        let able = |part: &&mut TrackedDevice<N>| need.is_some_and(|need| part.declared.has(need));
        let mut able = self.parts.iter_mut().filter(able);
        if let EventKind::KeyUp(_) = action {
            // Those that do not hold it ignore it.
            return able.try_for_each(|part| part.push(action));
        }
        let is_leading = |part: &&mut TrackedDevice<N>| part.declared.kind == self.leading;
        match able.max_by_key(is_leading) {
            Some(part) => part.push(action),
            None => {
                self.refused += u64::from(matches!(action, EventKind::KeyDown(_)));
                Ok(())
            }
        }
    }

    /// Notes who moves the pointer in a frame, before anything is pressed there.
    fn note_leading(&mut self, events: &[OutputEvent]) {
        for event in events {
            match event.kind {
                EventKind::MoveBy(..) => self.leading = DeviceKind::Mouse,
                EventKind::MoveTo(..) => self.leading = DeviceKind::Pointer,
                _ => {}
            }
        }
    }

    /// Does something with every device, and tells the first failure.
    fn each(&mut self, call: impl Fn(&mut TrackedDevice<N>) -> io::Result<()>) -> io::Result<()> {
        let mut outcome = Ok(());
        for part in &mut self.parts {
            outcome = outcome.and(call(part));
        }
        outcome
    }
}

impl<N: DeviceNode> Sink for Uinput<N> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut outcome = self.replace_lost_guardian();
        self.note_leading(events);
        for event in events {
            match self.is_guarded(event.kind) {
                true => outcome = outcome.and(self.take(event.kind)),
                false => self.refused += u64::from(matches!(event.kind, EventKind::KeyDown(_))),
            }
        }
        outcome = outcome.and(self.each(TrackedDevice::flush));
        self.tell_guardian();
        outcome.map_err(failed)
    }

    fn kind(&self) -> OutputKind {
        OutputKind::Uinput
    }

    fn close(&mut self) -> Result<(), OutputError> {
        let outcome = self.each(TrackedDevice::release_all);
        self.tell_guardian();
        outcome.map_err(failed)
    }

    fn dropped_presses(&self) -> u64 {
        self.refused
    }
}

impl<N: DeviceNode> Drop for Uinput<N> {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

fn refuse(reason: String) -> OutputError {
    OutputError::Open {
        output: OUTPUT.into(),
        reason,
    }
}

fn failed(error: io::Error) -> OutputError {
    OutputError::Send {
        output: OUTPUT.into(),
        reason: error.to_string(),
    }
}

/// Whether the node is not there, or nothing behind it.
pub(crate) fn is_missing(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
        || error
            .raw_os_error()
            .is_some_and(|code| NOTHING_BEHIND_NODE.contains(&code))
}

/// Why the node cannot be opened and what to do about it.
fn open_reason(error: &io::Error) -> String {
    if is_missing(error) {
        return advice::uinput_not_loaded().to_string();
    }
    if error.kind() == io::ErrorKind::PermissionDenied {
        return advice::uinput_denied(&AccessDenied::Unknown).to_string();
    }
    format!("/dev/uinput: {error}")
}

#[cfg(test)]
mod tests;
