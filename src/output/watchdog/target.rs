//! With what a guardian lets go of keys, and how it is handed that.

use std::io::{self, IoSlice, IoSliceMut};
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::net::UnixStream;

use rustix::cmsg_space;
use rustix::net::{
    RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, SendAncillaryBuffer,
    SendAncillaryMessage, SendFlags, recvmsg, sendmsg,
};

/// What a guardian needs. Where nobody else may let go of what a program holds, it is handed what the program itself
/// would do it with.
#[derive(Debug, Default)]
pub enum ReleaseTarget {
    /// A connection of its own to the display.
    #[default]
    Display,
    /// The program's connection to a compositor and the number of its keyboard there, for keys; and a connection
    /// of its own, for buttons.
    WaylandKeyboard(OwnedFd, u32),
    /// Devices of the kernel.
    Devices(Vec<DeviceHandle>),
}

/// A device of the kernel that the program has made.
#[derive(Debug)]
pub struct DeviceHandle {
    pub node: OwnedFd,
    /// Whether it has axes that come back to a rest.
    pub has_axes: bool,
}

/// The length of what goes with the handles: the kind of the means, and a number.
const BYTES: usize = 5;

/// More devices than a program makes.
const MOST: usize = 8;

impl ReleaseTarget {
    /// Hands them to whoever listens at the other end of the line.
    pub fn send(&self, line: &UnixStream) -> io::Result<()> {
        let (kind, number) = match self {
            Self::Display => (b'd', 0),
            Self::WaylandKeyboard(_, number) => (b'k', *number),
            Self::Devices(devices) => (b'u', axes_of(devices)),
        };
        let handles = self.handles();
        let mut space = [MaybeUninit::uninit(); cmsg_space!(ScmRights(MOST))];
        let mut ancillary = SendAncillaryBuffer::new(&mut space);
        if !handles.is_empty() && !ancillary.push(SendAncillaryMessage::ScmRights(&handles)) {
            return Err(io::Error::other("too many devices for a guardian"));
        }
        let [a, b, c, d] = number.to_be_bytes();
        let message = [kind, a, b, c, d];
        let flags = SendFlags::empty();
        match sendmsg(line, &[IoSlice::new(&message)], &mut ancillary, flags)? {
            BYTES => Ok(()),
            _ => Err(io::ErrorKind::WriteZero.into()),
        }
    }

    /// Takes them from whoever gives them at the other end of the line.
    pub fn receive(line: &UnixStream) -> io::Result<Self> {
        let mut message = [0; BYTES];
        let mut space = [MaybeUninit::uninit(); cmsg_space!(ScmRights(MOST))];
        let mut ancillary = RecvAncillaryBuffer::new(&mut space);
        let slices = &mut [IoSliceMut::new(&mut message)];
        let received = recvmsg(line, slices, &mut ancillary, RecvFlags::CMSG_CLOEXEC)?;
        let mut handles = Vec::new();
        for item in ancillary.drain() {
            if let RecvAncillaryMessage::ScmRights(rights) = item {
                handles.extend(rights);
            }
        }
        let [kind, number @ ..] = message;
        let number = u32::from_be_bytes(number);
        match (kind, received.bytes) {
            (b'd', BYTES) => Ok(Self::Display),
            (b'u', BYTES) => Ok(Self::Devices(devices(handles, number))),
            (b'k', BYTES) if handles.len() == 1 => {
                Ok(Self::WaylandKeyboard(handles.swap_remove(0), number))
            }
            _ => Err(io::ErrorKind::InvalidData.into()),
        }
    }

    fn handles(&self) -> Vec<BorrowedFd<'_>> {
        match self {
            Self::Display => Vec::new(),
            Self::WaylandKeyboard(connection, _) => vec![connection.as_fd()],
            Self::Devices(devices) => devices.iter().map(|device| device.node.as_fd()).collect(),
        }
    }
}

/// A bit for each device that has axes.
fn axes_of(devices: &[DeviceHandle]) -> u32 {
    let bits = devices.iter().enumerate();
    bits.map(|(place, device)| u32::from(device.has_axes) << place)
        .sum()
}

fn devices(nodes: Vec<OwnedFd>, axes: u32) -> Vec<DeviceHandle> {
    let device = |(place, node)| DeviceHandle {
        node,
        has_axes: axes >> place & 1 == 1,
    };
    nodes.into_iter().enumerate().map(device).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;
    use std::io::{Read, Write};

    fn handed(means: &ReleaseTarget) -> io::Result<ReleaseTarget> {
        let (program, guardian) = UnixStream::pair()?;
        means.send(&program)?;
        ReleaseTarget::receive(&guardian)
    }

    fn device(has_axes: bool) -> (std::io::PipeReader, DeviceHandle) {
        let (reader, writer) = std::io::pipe().unwrap();
        let node = OwnedFd::from(writer);
        (reader, DeviceHandle { node, has_axes })
    }

    #[test]
    fn devices_arrive_in_their_order_and_are_those_of_the_program() {
        let (mut keyboard, first) = device(false);
        let (mut gamepad, second) = device(true);
        let means = ReleaseTarget::Devices(vec![first, second]);
        let ReleaseTarget::Devices(arrived) = handed(&means).unwrap() else {
            panic!("they are devices");
        };
        drop(means);
        let axes: Vec<_> = arrived.iter().map(|device| device.has_axes).collect();
        assert_eq!(axes, [false, true]);
        for (text, device) in ["first", "second"].into_iter().zip(arrived) {
            File::from(device.node).write_all(text.as_bytes()).unwrap();
        }
        let mut heard = [String::new(), String::new()];
        keyboard.read_to_string(&mut heard[0]).unwrap();
        gamepad.read_to_string(&mut heard[1]).unwrap();
        assert_eq!(heard, ["first", "second"]);
    }

    #[test]
    fn a_keyboard_arrives_with_its_number_and_a_display_with_nothing() {
        let (_, connection) = device(false);
        let number = 0x0102_0304;
        let arrived = handed(&ReleaseTarget::WaylandKeyboard(connection.node, number)).unwrap();
        assert!(matches!(arrived, ReleaseTarget::WaylandKeyboard(_, given) if given == number));
        assert!(matches!(
            handed(&ReleaseTarget::Display).unwrap(),
            ReleaseTarget::Display
        ));
    }

    #[test]
    fn whoever_gives_nothing_or_nonsense_is_no_program() {
        let (program, guardian) = UnixStream::pair().unwrap();
        (&program).write_all(b"k\0\0\0\x01").unwrap();
        assert!(ReleaseTarget::receive(&guardian).is_err());
        (&program).write_all(b"x\0\0\0\0").unwrap();
        assert!(ReleaseTarget::receive(&guardian).is_err());
        drop(program);
        assert!(ReleaseTarget::receive(&guardian).is_err());
    }
}
