//! The handle with which the watchdog releases keys, and its transfer to the watchdog.

use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;

use rustix::cmsg_space;
use rustix::fs::OFlags;
use rustix::net::{
    RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, recvmsg, sendmsg,
};
use rustix::process::{PidfdFlags, pidfd_open};
use rustix::thread::gettid;

/// The handle with which the watchdog releases keys.
#[derive(Debug, Default)]
pub enum ReleaseTarget {
    /// A new connection to the display.
    #[default]
    Display,
    /// For keys, the connection of the client to a compositor and the id of its virtual keyboard; for buttons, a new
    /// connection.
    WaylandKeyboard(OwnedFd, u32),
    /// Devices of `uinput`.
    Devices(Vec<DeviceHandle>),
}

/// A device of `uinput` that the client has created.
#[derive(Debug)]
pub struct DeviceHandle {
    /// The file descriptor of `/dev/uinput`.
    pub node: OwnedFd,
    /// `true` if the device has axes that return to their center.
    pub has_axes: bool,
}

/// Length of the message beside the file descriptors: the kind of the target, a number, and the number of handles of
/// threads, 0 or 1.
const BYTES: usize = 6;

/// Maximum number of file descriptors in the message.
const MAX_DESCRIPTORS: usize = MAX_DEVICES + 1;

/// Maximum number of devices; a client creates fewer.
const MAX_DEVICES: usize = 8;

impl ReleaseTarget {
    /// Returns a handle of the calling thread that is readable when the thread has ended (`PIDFD_THREAD`, Linux 6.9).
    ///
    /// A killed process closes its socket when the last of its threads has ended, and threads of normal priority wait on a
    /// busy machine. The thread of a display has a high priority, and what the loop presses is reported before. `None` for
    /// devices, which other threads may use, and on an older kernel.
    pub fn thread_handle(&self) -> Option<OwnedFd> {
        // The flag has the value of another one, and no name in the library.
        let thread = PidfdFlags::from_bits_retain(OFlags::EXCL.bits());
        match self {
            Self::Display | Self::WaylandKeyboard(..) => pidfd_open(gettid(), thread).ok(),
            Self::Devices(_) => None,
        }
    }

    /// Sends the target with its file descriptors (`SCM_RIGHTS`), and the handle of the thread that presses keys.
    pub fn send(&self, socket: &UnixStream, thread: Option<&OwnedFd>) -> io::Result<()> {
        let (kind, number) = match self {
            Self::Display => (b'd', 0),
            Self::WaylandKeyboard(_, id) => (b'k', *id),
            Self::Devices(devices) => (b'u', axis_bits(devices)),
        };
        let mut descriptors = self.descriptors();
        descriptors.extend(thread.map(AsFd::as_fd));
        let mut space = [MaybeUninit::uninit(); cmsg_space!(ScmRights(MAX_DESCRIPTORS))];
        let mut ancillary = SendAncillaryBuffer::new(&mut space);
        if !descriptors.is_empty() && !ancillary.push(SendAncillaryMessage::ScmRights(&descriptors))
        {
            return Err(io::Error::other("too many devices for the watchdog"));
        }
        let [a, b, c, d] = number.to_be_bytes();
        let message = [kind, a, b, c, d, thread.is_some().into()];
        let flags = SendFlags::empty();
        match sendmsg(socket, &[IoSlice::new(&message)], &mut ancillary, flags)? {
            BYTES => Ok(()),
            _ => Err(io::ErrorKind::WriteZero.into()),
        }
    }

    /// Receives a target, and the handle of the thread that presses keys.
    pub fn receive(socket: &UnixStream) -> io::Result<(Self, Option<OwnedFd>)> {
        let mut message = [0; BYTES];
        let mut space = [MaybeUninit::uninit(); cmsg_space!(ScmRights(MAX_DESCRIPTORS))];
        let mut ancillary = RecvAncillaryBuffer::new(&mut space);
        let slices = &mut [IoSliceMut::new(&mut message)];
        let received = recvmsg(socket, slices, &mut ancillary, RecvFlags::CMSG_CLOEXEC)?;
        let mut descriptors = Vec::new();
        for item in ancillary.drain() {
            if let RecvAncillaryMessage::ScmRights(rights) = item {
                descriptors.extend(rights);
            }
        }
        let [kind, a, b, c, d, has_thread] = message;
        let number = u32::from_be_bytes([a, b, c, d]);
        let thread = descriptors.pop_if(|_| has_thread == 1);
        let target = match (kind, received.bytes) {
            (b'd', BYTES) => Self::Display,
            (b'u', BYTES) => Self::Devices(devices(descriptors, number)),
            (b'k', BYTES) if descriptors.len() == 1 => {
                Self::WaylandKeyboard(descriptors.swap_remove(0), number)
            }
            _ => return Err(io::ErrorKind::InvalidData.into()),
        };
        Ok((target, thread))
    }

    fn descriptors(&self) -> Vec<BorrowedFd<'_>> {
        match self {
            Self::Display => Vec::new(),
            Self::WaylandKeyboard(connection, _) => vec![connection.as_fd()],
            Self::Devices(devices) => devices.iter().map(|device| device.node.as_fd()).collect(),
        }
    }
}

/// Returns a bit set of the devices that have axes.
fn axis_bits(devices: &[DeviceHandle]) -> u32 {
    let bits = devices.iter().enumerate();
    bits.map(|(index, device)| u32::from(device.has_axes) << index)
        .sum()
}

fn devices(nodes: Vec<OwnedFd>, axis_bits: u32) -> Vec<DeviceHandle> {
    let device = |(index, node)| DeviceHandle {
        node,
        has_axes: axis_bits >> index & 1 == 1,
    };
    nodes.into_iter().enumerate().map(device).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::{Read, Write};

    fn transfer(target: &ReleaseTarget) -> io::Result<ReleaseTarget> {
        let (client, watchdog) = UnixStream::pair()?;
        target.send(&client, None)?;
        let (received, thread) = ReleaseTarget::receive(&watchdog)?;
        assert!(thread.is_none());
        Ok(received)
    }

    fn device(has_axes: bool) -> (std::io::PipeReader, DeviceHandle) {
        let (reader, writer) = std::io::pipe().unwrap();
        let node = OwnedFd::from(writer);
        (reader, DeviceHandle { node, has_axes })
    }

    #[test]
    fn devices_arrive_in_order_and_share_the_file_of_the_client() {
        let (mut keyboard, first) = device(false);
        let (mut gamepad, second) = device(true);
        let target = ReleaseTarget::Devices(vec![first, second]);
        let ReleaseTarget::Devices(arrived) = transfer(&target).unwrap() else {
            panic!("not devices");
        };
        drop(target);
        let axes: Vec<_> = arrived.iter().map(|device| device.has_axes).collect();
        assert_eq!(axes, [false, true]);
        for (text, device) in ["first", "second"].into_iter().zip(arrived) {
            File::from(device.node).write_all(text.as_bytes()).unwrap();
        }
        let mut texts = [String::new(), String::new()];
        keyboard.read_to_string(&mut texts[0]).unwrap();
        gamepad.read_to_string(&mut texts[1]).unwrap();
        assert_eq!(texts, ["first", "second"]);
    }

    #[test]
    fn a_keyboard_arrives_with_its_id_and_a_display_without_descriptors() {
        let (_, connection) = device(false);
        let id = 0x0102_0304;
        let arrived = transfer(&ReleaseTarget::WaylandKeyboard(connection.node, id)).unwrap();
        assert!(matches!(arrived, ReleaseTarget::WaylandKeyboard(_, received) if received == id));
        assert!(matches!(
            transfer(&ReleaseTarget::Display).unwrap(),
            ReleaseTarget::Display
        ));
    }

    #[test]
    fn an_incomplete_or_unknown_target_is_an_error() {
        let (client, watchdog) = UnixStream::pair().unwrap();
        (&client).write_all(b"k\0\0\0\x01\0").unwrap();
        assert!(ReleaseTarget::receive(&watchdog).is_err());
        (&client).write_all(b"x\0\0\0\0\0").unwrap();
        assert!(ReleaseTarget::receive(&watchdog).is_err());
        drop(client);
        assert!(ReleaseTarget::receive(&watchdog).is_err());
    }
}
