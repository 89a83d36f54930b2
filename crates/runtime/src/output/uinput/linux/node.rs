//! Device nodes, which accept reports of input events.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::{AsFd, OwnedFd};

use arrayvec::ArrayVec;
use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AttributeSet, BusType, EventType, InputEvent, InputId, PropType, UinputAbsSetup,
};

use super::spec::{DeviceKind, DeviceSpec};
use ademan_core::device::pressed_keys::PressedKeys;

/// Maximum number of events in a report: a press and a release of every key.
pub const MAX_EVENTS: usize = 2 * PressedKeys::CAPACITY;

/// Vendor id for udev rules. No vendor of USB devices has it, and the bus is virtual.
const VENDOR: u16 = 0x0ade;

const VERSION: u16 = 1;

/// Size of `struct input_event`: the time, which the kernel sets, type, code and value.
const EVENT_BYTES: usize = size_of::<InputEvent>();

/// A receiver of reports: a device node, or a stand-in for it in tests.
pub trait DeviceNode: Send {
    /// Writes a report of at most 320 events, followed by `SYN_REPORT`, in one system call.
    fn write_report(&mut self, events: &[InputEvent]) -> io::Result<()>;

    /// Duplicates the file descriptor of the device.
    fn try_clone_fd(&self) -> io::Result<OwnedFd>;
}

/// A device created through `/dev/uinput`; it exists until all its file descriptors are closed.
pub struct UinputNode(File);

impl UinputNode {
    /// Creates a device.
    pub fn create(name: &str, spec: &DeviceSpec) -> io::Result<Self> {
        let id = InputId::new(BusType::BUS_VIRTUAL, VENDOR, spec.kind.product(), VERSION);
        let mut builder = VirtualDevice::builder()?
            .name(name)
            .input_id(id)
            .with_keys(&spec.keys)?;
        if spec.relative_axes.iter().next().is_some() {
            builder = builder.with_relative_axes(&spec.relative_axes)?;
        }
        for (axis, minimum, maximum) in &spec.absolute_axes {
            let info = AbsInfo::new(0, *minimum, *maximum, 0, 0, 0);
            builder = builder.with_absolute_axis(&UinputAbsSetup::new(*axis, info))?;
        }
        if spec.kind == DeviceKind::Pointer {
            let properties = AttributeSet::from_iter([PropType::POINTER]);
            builder = builder.with_properties(&properties)?;
        }
        let device = builder.build()?;
        // The kernel keeps the device until its last file descriptor is closed.
        Ok(Self::from_fd(device.as_fd().try_clone_to_owned()?))
    }

    /// Uses a device created by another process.
    pub fn from_fd(descriptor: OwnedFd) -> Self {
        Self(File::from(descriptor))
    }
}

impl DeviceNode for UinputNode {
    fn write_report(&mut self, events: &[InputEvent]) -> io::Result<()> {
        self.0.write_all(&encode_report(events))
    }

    fn try_clone_fd(&self) -> io::Result<OwnedFd> {
        self.0.as_fd().try_clone_to_owned()
    }
}

/// Encodes a report and its `SYN_REPORT`.
fn encode_report(events: &[InputEvent]) -> ArrayVec<u8, { (MAX_EVENTS + 1) * EVENT_BYTES }> {
    let syn = InputEvent::new(EventType::SYNCHRONIZATION.0, 0, 0);
    let mut bytes = ArrayVec::new();
    for event in events.iter().take(MAX_EVENTS).chain([&syn]) {
        bytes.extend([0; EVENT_BYTES - 8]);
        bytes.extend(event.event_type().0.to_ne_bytes());
        bytes.extend(event.code().to_ne_bytes());
        bytes.extend(event.value().to_ne_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_is_its_events_and_syn_report_in_the_format_of_the_kernel() {
        let report = [InputEvent::new(1, 30, 1), InputEvent::new(2, 8, -120)];
        let bytes = encode_report(&report);
        let fields: Vec<_> = bytes
            .chunks(EVENT_BYTES)
            .map(|event| {
                let (time, rest) = event.split_at(EVENT_BYTES - 8);
                assert!(time.iter().all(|byte| *byte == 0));
                let short = |at| u16::from_ne_bytes([rest[at], rest[at + 1]]);
                let value = i32::from_ne_bytes(rest[4..8].try_into().unwrap());
                (short(0), short(2), value)
            })
            .collect();
        assert_eq!(fields, [(1, 30, 1), (2, 8, -120), (0, 0, 0)]);
        #[cfg(target_pointer_width = "64")]
        assert_eq!(EVENT_BYTES, 24);
    }

    #[test]
    fn the_longest_report_fits_the_buffer() {
        let report = vec![InputEvent::new(1, 30, 1); MAX_EVENTS];
        assert_eq!(encode_report(&report).len(), (MAX_EVENTS + 1) * EVENT_BYTES);
    }
}
