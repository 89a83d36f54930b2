//! One end of a device: the kernel's, or a stand-in for it.

use std::fs::File;
use std::io::{self, Write};
use std::os::fd::{AsFd, OwnedFd};

use arrayvec::ArrayVec;
use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AttributeSet, BusType, EventType, InputEvent, InputId, PropType, UinputAbsSetup,
};

use super::spec::{DeviceKind, DeviceSpec};
use crate::output::pressed_keys::PressedKeys;

/// The most events of a frame: every key down and up.
pub const FRAME: usize = 2 * PressedKeys::CAPACITY;

/// Who makes the devices, for rules about them; no maker of USB devices, as the bus is virtual.
const VENDOR: u16 = 0x0ade;

const VERSION: u16 = 1;

/// What the kernel takes an event as: the time, which it sets itself, then type, code and value.
const EVENT_BYTES: usize = size_of::<InputEvent>();

/// Takes frames of events.
pub trait DeviceNode: Send {
    /// Delivers the events of one frame, at most 320, and what ends a frame, in one go.
    fn emit(&mut self, events: &[InputEvent]) -> io::Result<()>;

    /// A second handle of the device.
    fn try_clone_fd(&self) -> io::Result<OwnedFd>;
}

/// A device of the kernel; it is there until this is dropped.
pub struct UinputNode(File);

impl UinputNode {
    /// Makes a device.
    pub fn open(name: &str, declared: &DeviceSpec) -> io::Result<Self> {
        let id = InputId::new(
            BusType::BUS_VIRTUAL,
            VENDOR,
            declared.kind.product(),
            VERSION,
        );
        let mut builder = VirtualDevice::builder()?
            .name(name)
            .input_id(id)
            .with_keys(&declared.keys)?;
        if declared.relative.iter().next().is_some() {
            builder = builder.with_relative_axes(&declared.relative)?;
        }
        for (axis, low, high) in &declared.absolute {
            let info = AbsInfo::new(0, *low, *high, 0, 0, 0);
            builder = builder.with_absolute_axis(&UinputAbsSetup::new(*axis, info))?;
        }
        if declared.kind == DeviceKind::Pointer {
            let properties = AttributeSet::from_iter([PropType::POINTER]);
            builder = builder.with_properties(&properties)?;
        }
        let device = builder.build()?;
        // The kernel keeps the device as long as anybody has it open.
        Ok(Self::from_fd(device.as_fd().try_clone_to_owned()?))
    }

    /// One that somebody else has made.
    pub fn from_fd(handle: OwnedFd) -> Self {
        Self(File::from(handle))
    }
}

impl DeviceNode for UinputNode {
    fn emit(&mut self, events: &[InputEvent]) -> io::Result<()> {
        self.0.write_all(&bytes(events))
    }

    fn try_clone_fd(&self) -> io::Result<OwnedFd> {
        self.0.as_fd().try_clone_to_owned()
    }
}

/// The bytes of a frame and its end, so that one system call delivers it.
fn bytes(events: &[InputEvent]) -> ArrayVec<u8, { (FRAME + 1) * EVENT_BYTES }> {
    let end = InputEvent::new(EventType::SYNCHRONIZATION.0, 0, 0);
    let mut bytes = ArrayVec::new();
    for event in events.iter().take(FRAME).chain([&end]) {
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
    fn a_frame_is_its_events_and_an_end_as_the_kernel_reads_them() {
        let frame = [InputEvent::new(1, 30, 1), InputEvent::new(2, 8, -120)];
        let bytes = bytes(&frame);
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
    fn the_longest_frame_has_room() {
        let frame = vec![InputEvent::new(1, 30, 1); FRAME];
        assert_eq!(bytes(&frame).len(), (FRAME + 1) * EVENT_BYTES);
    }
}
