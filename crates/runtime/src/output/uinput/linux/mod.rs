//! Devices created through `/dev/uinput`.
//!
//! X11, Wayland and the console receive their events like the events of any keyboard. When the process exits for any reason,
//! the kernel removes the devices and releases their keys (`uinput_destroy_device`, `input_dev_release_keys`). It does
//! not while the process is stopped or hangs; the [watchdog](crate::output::watchdog) does.

mod check;
mod node;
mod spec;
mod supervisor;
mod tracked_device;

use std::io;

use super::{BACKEND, capabilities};
use crate::advice::{self, AccessDenied};
use crate::output::watchdog::{ReleaseTarget, WatchdogSettings};
use crate::output::{OpenRequest, OutputError, Sink};
use ademan_core::device::{Capabilities, Capability, EventKind, KeyCode, OutputEvent};
pub use check::check;
pub use node::{DeviceNode, UinputNode};
use spec::{DeviceKind, DeviceSpec};
use supervisor::WatchdogSupervisor;
use tracked_device::TrackedDevice;
pub use tracked_device::{center_axes, release_key};

/// Maximum length of the name of the devices, in bytes: `UINPUT_MAX_NAME_SIZE` without the NUL and the suffix of the
/// device.
const MAX_NAME: usize = 78 - " keyboard".len();

/// `ENXIO` and `ENODEV`: the errors of opening the node of a driver that is not loaded.
const NO_DRIVER: [i32; 2] = [6, 19];

/// A sink that creates the devices that a layout requires, with exactly the capabilities that it requires.
///
/// A device receives the events of a step in one system call, or in several if a button changes more than once, as in a click, or an
/// event of another device comes between them. The keyboard does not repeat keys; the receiver does.
pub struct Uinput<N: DeviceNode = UinputNode> {
    required: Capabilities,
    devices: Vec<TrackedDevice<N>>,
    /// The device that moved the pointer last, the mouse or the absolute pointer; it presses the buttons. A receiver
    /// that reads both devices may otherwise process the click before the motion.
    active_pointer: DeviceKind,
    dropped_presses: u64,
    /// `true` if a press was dropped, or keys were released, because of the watchdog.
    has_stalled: bool,
    watchdog: Option<WatchdogSupervisor>,
}

impl Uinput {
    /// Creates the devices that `required` needs. Their names are `name`, 1 to 69 bytes, and their kind: `Ademan
    /// keyboard`, `Ademan mouse`, `Ademan pointer`, `Ademan gamepad`.
    pub fn open(name: &str, required: &Capabilities) -> Result<Self, OutputError> {
        if name.is_empty() || name.len() > MAX_NAME || name.contains('\0') {
            return Err(open_error(format!(
                "invalid device name `{name}`: it must have 1 to {MAX_NAME} bytes"
            )));
        }
        let node =
            |spec: &DeviceSpec| UinputNode::create(&format!("{name} {}", spec.kind.name()), spec);
        Self::with_nodes(required, node).map_err(|error| open_error(open_message(&error)))
    }
}

impl<N: DeviceNode> Uinput<N> {
    /// Creates the devices with nodes from `create`.
    fn with_nodes(
        required: &Capabilities,
        create: impl Fn(&DeviceSpec) -> io::Result<N>,
    ) -> io::Result<Self> {
        let device = |spec: DeviceSpec| Ok(TrackedDevice::new(spec.clone(), create(&spec)?));
        let specs = DeviceSpec::for_capabilities(required).into_iter();
        Ok(Self {
            required: required.clone(),
            devices: specs.map(device).collect::<io::Result<_>>()?,
            active_pointer: DeviceKind::Mouse,
            dropped_presses: 0,
            has_stalled: false,
            watchdog: None,
        })
    }

    fn start_watchdog(&mut self, settings: &WatchdogSettings) -> Result<(), String> {
        if self.devices.is_empty() {
            return Ok(());
        }
        let handles = self.devices.iter().map(TrackedDevice::watchdog_handle);
        let handles: io::Result<_> = handles.collect();
        let target = ReleaseTarget::Devices(handles.map_err(|error| error.to_string())?);
        self.watchdog = Some(WatchdogSupervisor::start(settings, target)?);
        Ok(())
    }

    /// Releases everything and restarts the watchdog if it is lost. Fails if it will not be restarted.
    fn restart_lost_watchdog(&mut self) -> io::Result<()> {
        let Some(watchdog) = &mut self.watchdog else {
            return Ok(());
        };
        self.has_stalled |= watchdog.take_released();
        if !watchdog.is_lost() {
            return match watchdog.failure() {
                None => Ok(()),
                Some(reason) => Err(io::Error::other(reason)),
            };
        }
        self.has_stalled = true;
        let released = self.for_each_device(TrackedDevice::release_all);
        if let Some(client) = &mut self.watchdog {
            client.restart();
        }
        released
    }

    /// Reports an event to the watchdog before it is sent. Returns `false` if the watchdog does not know of it, so that
    /// it must not be sent.
    fn report_before(&mut self, event: EventKind) -> bool {
        let is_press = matches!(event, EventKind::KeyDown(_));
        if is_press && self.has_stalled {
            return false;
        }
        match (&mut self.watchdog, event) {
            (Some(watchdog), EventKind::KeyDown(key)) => watchdog.report_press(key),
            (Some(watchdog), EventKind::Axis(_, value)) if value != 0.0 => {
                watchdog.report_deflection()
            }
            _ => true,
        }
    }

    /// Reports to the watchdog what has been released.
    fn report_after(&mut self) {
        if let Some(watchdog) = &mut self.watchdog {
            let devices = &self.devices;
            watchdog.report_releases(
                |key| devices.iter().any(|device| device.is_pressed(key)),
                devices.iter().any(TrackedDevice::is_deflected),
            );
        }
    }

    /// Adds an event to the report of its device. A press that is not among the required capabilities is dropped, and so is a
    /// character: the input method has no field for it, and no device types it.
    fn push(&mut self, event: EventKind) -> io::Result<()> {
        if let EventKind::KeyUp(key) = event {
            return self.push_release(key);
        }
        let capability = Capability::required_by(event);
        let capability = capability.filter(|capability| self.required.contains(*capability));
        let supports = |(_, device): &(usize, &TrackedDevice<N>)| {
            capability.is_some_and(|capability| device.spec.supports(capability))
        };
        let devices = self.devices.iter().enumerate().filter(supports);
        let active = devices.max_by_key(|(_, device)| device.spec.kind == self.active_pointer);
        match active.map(|(index, _)| index) {
            Some(index) => self.push_to(index, event),
            None => {
                self.dropped_presses += u64::from(event.is_press());
                Ok(())
            }
        }
    }

    /// Adds the release of a key to the report of each device on which the key is pressed, also after one that fails.
    fn push_release(&mut self, key: KeyCode) -> io::Result<()> {
        let mut result = Ok(());
        for index in 0..self.devices.len() {
            if self.devices[index].is_pressed(key) {
                result = result.and(self.push_to(index, EventKind::KeyUp(key)));
            }
        }
        result
    }

    /// Adds an event to the report of the device at `index`, and sends the reports of the others, whose events precede it. A receiver
    /// reads first the device that reports first: Shift must not come up before the button with which something is dropped.
    fn push_to(&mut self, index: usize, event: EventKind) -> io::Result<()> {
        let mut result = Ok(());
        for (other, device) in self.devices.iter_mut().enumerate() {
            let pushed = if other == index {
                device.push(event)
            } else {
                device.flush()
            };
            result = result.and(pushed);
        }
        result
    }

    /// Sets the active pointer to the device that moves in this step, before a button is pressed on it.
    fn update_active_pointer(&mut self, events: &[OutputEvent]) {
        for event in events {
            match event.kind {
                EventKind::MoveBy(..) => self.active_pointer = DeviceKind::Mouse,
                EventKind::MoveTo(..) => self.active_pointer = DeviceKind::Pointer,
                _ => {}
            }
        }
    }

    /// Calls a function for every device, the keyboard last, so that modifiers are released after the buttons. Returns the first error.
    fn for_each_device(
        &mut self,
        call: impl Fn(&mut TrackedDevice<N>) -> io::Result<()>,
    ) -> io::Result<()> {
        let mut result = Ok(());
        for device in self.devices.iter_mut().rev() {
            result = result.and(call(device));
        }
        result
    }
}

impl<N: DeviceNode> Sink for Uinput<N> {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        let mut result = self.restart_lost_watchdog();
        self.update_active_pointer(events);
        for event in events {
            if self.report_before(event.kind) {
                result = result.and(self.push(event.kind))
            } else {
                let is_press = matches!(event.kind, EventKind::KeyDown(_));
                self.dropped_presses += u64::from(is_press);
                self.has_stalled |= is_press;
            }
        }
        result = result.and(self.for_each_device(TrackedDevice::flush));
        self.report_after();
        result.map_err(send_error)
    }

    fn capabilities(&self) -> Capabilities {
        capabilities()
    }

    fn void_presses(&mut self) {
        self.has_stalled = false;
    }

    fn has_stalled(&self) -> bool {
        self.has_stalled
    }

    fn close(&mut self) -> Result<(), OutputError> {
        let result = self.for_each_device(TrackedDevice::release_all);
        self.report_after();
        result.map_err(send_error)
    }

    fn dropped_presses(&self) -> u64 {
        self.dropped_presses
    }
}

impl<N: DeviceNode> Drop for Uinput<N> {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

/// Opens the output, with a watchdog, if there is one, that releases keys and centers axes if this process cannot.
pub fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let mut uinput = Uinput::open("Ademan", request.required)?;
    if let Some(watchdog) = request.watchdog {
        uinput.start_watchdog(watchdog).map_err(open_error)?;
    }
    Ok(Box::new(uinput))
}

/// Returns `true` if an error of opening `/dev/uinput` means that it does not exist or has no driver.
pub fn is_missing(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::NotFound
        || error
            .raw_os_error()
            .is_some_and(|code| NO_DRIVER.contains(&code))
}

/// Returns the cause and the remedy for an error of opening `/dev/uinput`.
fn open_message(error: &io::Error) -> String {
    if is_missing(error) {
        return advice::uinput_not_loaded().to_string();
    }
    if error.kind() == io::ErrorKind::PermissionDenied {
        return advice::uinput_denied(&AccessDenied::Unknown).to_string();
    }
    format!("/dev/uinput: {error}")
}

fn open_error(reason: String) -> OutputError {
    OutputError::open(BACKEND.name, reason)
}

fn send_error(error: io::Error) -> OutputError {
    OutputError::send(BACKEND.name, error)
}

#[cfg(test)]
mod tests;
