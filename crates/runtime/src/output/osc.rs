//! The output `osc`: the signals of a layout as Open Sound Control messages over UDP.
//!
//! A message has the address of its control and one number (`f`): the value of a slider or a knob, the velocity of a key while it
//! is pressed, and the number for 0 at its release. A key that reports its depth sends it to its address with `/depth` at the end.
//! Only controls with a signal send anything.

use std::io;
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::thread;

use super::{Backend, OpenRequest, OutputError, RETRIES, RETRY_DELAY, Sink};
use crate::capture::protocol::osc;
use crate::network::canonical;
use ademan_core::contact::TargetId;
use ademan_core::device::signals::{Signal, Signals};
use ademan_core::device::{Capabilities, EventKind, OutputEvent};

/// The backend `osc`.
pub const BACKEND: Backend = Backend {
    name: "osc",
    argument: Some("HOST:PORT"),
    is_argument_required: true,
    summary: "the signals of a layout as OSC messages, over UDP to a program: osc:127.0.0.1:9000",
    capabilities: Capabilities::default,
    is_log: false,
    is_fixed_when_open: false,
    check: None,
    open,
};

/// Opens the output.
fn open(request: &OpenRequest) -> Result<Box<dyn Sink>, OutputError> {
    let Some(receiver) = request.argument else {
        let reason = "it has no receiver; write its address and port: osc:127.0.0.1:9000";
        return Err(OutputError::open(request.name, reason));
    };
    let osc = Osc::open(receiver).map_err(|error| {
        let reason =
            format!("{error}; write the address and the port of the receiver: osc:127.0.0.1:9000");
        OutputError::open(request.name, reason)
    })?;
    Ok(Box::new(osc))
}

/// A sink that sends OSC messages.
///
/// It never blocks. A message that the system does not accept is sent in the next step, with its latest value. A press that has ended
/// by then is [counted](Sink::dropped_presses) as dropped. UDP confirms nothing: the network may lose any message.
pub struct Osc {
    socket: UdpSocket,
    signals: Signals,
    /// The messages, in the order of the signals.
    messages: Vec<SignalMessages>,
    /// The messages of the previous signals that could not be sent, and whose addresses no present signal has.
    ended: Vec<Message>,
    /// `true` if a message could not be sent.
    has_due: bool,
    dropped_presses: u64,
}

/// The messages of one signal; `None` if it has no address.
#[derive(Default)]
struct SignalMessages {
    value: Option<Message>,
    depth: Option<Message>,
}

/// A message of one address, and the state of the values sent with it.
struct Message {
    /// The datagram. Its last four bytes are the number.
    datagram: Vec<u8>,
    range: (f32, f32),
    /// `true` if the value sent last ends with the session: a press or a depth.
    is_held: bool,
    /// The value that could not be sent.
    due: Option<f32>,
}

impl Osc {
    /// Opens a socket that sends to `HOST:PORT`.
    pub fn open(receiver: &str) -> io::Result<Self> {
        let addresses = receiver.to_socket_addrs()?;
        let mut refused = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
        for address in addresses.map(canonical) {
            if address.port() == 0 {
                let reason = "no program receives on port 0";
                return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
            }
            match connect(address) {
                Ok(socket) => {
                    if !address.ip().is_loopback() {
                        tracing::warn!(
                            "OSC messages to {address} are not encrypted: anyone who can read the network can read what you play"
                        );
                    }
                    return Ok(Self {
                        socket,
                        signals: Signals::default(),
                        messages: Vec::new(),
                        ended: Vec::new(),
                        has_due: false,
                        dropped_presses: 0,
                    });
                }
                Err(error) => refused = error,
            }
        }
        Err(refused)
    }

    /// Sends a value of the control of a target. `part` is the kind of the value: a press and a depth are held until they return to 0.
    fn set(&mut self, target: TargetId, value: f32, part: Part) {
        let Some(index) = self.signals.index(target) else {
            return;
        };
        let messages = &mut self.messages[index];
        let message = match part {
            Part::Depth => &mut messages.depth,
            Part::Value | Part::Press => &mut messages.value,
        };
        let Some(message) = message else { return };
        let is_ended_press = part == Part::Press && value == 0.0 && message.due.is_some();
        self.dropped_presses += u64::from(is_ended_press);
        message.is_held = part != Part::Value && value != 0.0;
        self.has_due |= !message.send(&self.socket, value);
    }

    /// Sends the messages that could not be sent before. Returns `true` if all are sent.
    fn send_due(&mut self) -> bool {
        if self.has_due {
            let mut is_sent = true;
            let present = self.messages.iter_mut().flat_map(SignalMessages::all);
            for message in self.ended.iter_mut().chain(present) {
                is_sent &= message
                    .due
                    .is_none_or(|due| message.send(&self.socket, due));
            }
            self.ended.retain(|message| message.due.is_some());
            self.has_due = !is_sent;
        }
        !self.has_due
    }

    /// Ends every press and depth.
    fn release_all(&mut self) {
        for message in self.messages.iter_mut().flat_map(SignalMessages::all) {
            if std::mem::take(&mut message.is_held) {
                self.has_due |= !message.send(&self.socket, 0.0);
            }
        }
    }
}

/// The meaning of a value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Value,
    Press,
    Depth,
}

impl SignalMessages {
    fn new(signal: &Signal) -> Self {
        let Some(address) = &signal.address else {
            return Self::default();
        };
        let message = |path: &str| Message {
            datagram: osc::encode(path, None, &[], &[0.0]),
            range: signal.range,
            is_held: false,
            due: None,
        };
        Self {
            value: Some(message(address)),
            depth: Some(message(&format!("{address}/depth"))),
        }
    }

    fn all(&mut self) -> impl Iterator<Item = &mut Message> {
        self.value.iter_mut().chain(&mut self.depth)
    }
}

impl Message {
    /// Returns the part of the datagram before the number.
    fn address(&self) -> &[u8] {
        let (address, _) = self.datagram.split_at(self.datagram.len() - 4);
        address
    }

    /// Sends a value, or keeps it. Returns `true` if it was sent.
    fn send(&mut self, socket: &UdpSocket, value: f32) -> bool {
        let (low, high) = self.range;
        let number = low + value * (high - low);
        if let Some(last) = self.datagram.last_chunk_mut() {
            *last = number.to_be_bytes();
        }
        let sent = match socket.send(&self.datagram) {
            // This error is the answer to an earlier message, which no program has received. This message was not sent.
            Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => {
                match socket.send(&self.datagram) {
                    Err(again) if again.kind() == io::ErrorKind::ConnectionRefused => Ok(0),
                    sent => sent,
                }
            }
            sent => sent,
        };
        self.due = sent.is_err().then_some(value);
        sent.is_ok()
    }
}

impl Sink for Osc {
    fn send(&mut self, events: &[OutputEvent]) -> Result<(), OutputError> {
        self.send_due();
        for event in events {
            match event.kind {
                EventKind::Value(target, value) => self.set(target, value, Part::Value),
                EventKind::Velocity(target, velocity) => self.set(target, velocity, Part::Press),
                EventKind::Depth(target, depth) => self.set(target, depth, Part::Depth),
                EventKind::Select(target) => self.set(target, 1.0, Part::Press),
                EventKind::Unselect(target) => self.set(target, 0.0, Part::Press),
                _ => {}
            }
        }
        Ok(())
    }

    fn capabilities(&self) -> Capabilities {
        Capabilities::default()
    }

    fn set_signals(&mut self, signals: &Signals) {
        self.release_all();
        self.send_due();
        let earlier = std::mem::take(&mut self.messages).into_iter();
        let earlier = earlier.flat_map(|it| [it.value, it.depth]).flatten();
        self.ended
            .extend(earlier.filter(|message| message.due.is_some()));
        self.messages = signals
            .iter()
            .map(|(_, signal)| SignalMessages::new(signal))
            .collect();
        for message in self.messages.iter_mut().flat_map(SignalMessages::all) {
            let same = |other: &Message| other.address() == message.address();
            if let Some(index) = self.ended.iter().position(same) {
                message.due = self.ended.swap_remove(index).due;
            }
        }
        self.signals = signals.clone();
    }

    fn void_presses(&mut self) {
        for message in self.messages.iter_mut().flat_map(SignalMessages::all) {
            if message.is_held && message.due.is_some() {
                message.due = None;
                self.dropped_presses += 1;
            }
        }
    }

    fn close(&mut self) -> Result<(), OutputError> {
        self.release_all();
        for _ in 0..RETRIES {
            if self.send_due() {
                return Ok(());
            }
            thread::sleep(RETRY_DELAY);
        }
        if self.send_due() {
            Ok(())
        } else {
            Err(OutputError::send(
                BACKEND.name,
                "the last releases cannot be sent",
            ))
        }
    }

    fn dropped_presses(&self) -> u64 {
        self.dropped_presses
    }
}

impl Drop for Osc {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

fn connect(address: SocketAddr) -> io::Result<UdpSocket> {
    let any_port: SocketAddr = match address {
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
    };
    let socket = UdpSocket::bind(any_port)?;
    socket.connect(address)?;
    socket.set_nonblocking(true)?;
    Ok(socket)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::tests::event;
    use ademan_core::device::signals::MidiKind;

    fn signal(address: Option<&str>, range: (f32, f32)) -> Signal {
        Signal {
            address: address.map(str::to_owned),
            range,
            channel: 0,
            midi: Some(MidiKind::Note(60)),
        }
    }

    /// A sink with a key (0), a slider (1) and a control without an address (2), and its receiver.
    fn sink() -> (Osc, UdpSocket) {
        let receiver = UdpSocket::bind("127.0.0.1:0").unwrap();
        receiver.set_nonblocking(true).unwrap();
        let mut sink = Osc::open(&receiver.local_addr().unwrap().to_string()).unwrap();
        sink.set_signals(&Signals::new([
            (TargetId(1), signal(Some("/mixer/1"), (-60.0, 0.0))),
            (TargetId(0), signal(Some("/key"), (0.0, 1.0))),
            (TargetId(2), signal(None, (0.0, 1.0))),
        ]));
        (sink, receiver)
    }

    #[test]
    fn port_0_is_no_receiver() {
        let error = Osc::open("127.0.0.1:0").err().expect("a refusal");
        assert_eq!(error.to_string(), "no program receives on port 0");
    }

    fn received(receiver: &UdpSocket) -> Vec<(String, f32)> {
        let mut buffer = [0; 200];
        std::iter::from_fn(|| {
            let length = receiver.recv(&mut buffer).ok()?;
            let end = buffer.iter().position(|byte| *byte == 0)?;
            let address = String::from_utf8(buffer[..end].to_vec()).unwrap();
            let number = *buffer[..length].last_chunk().unwrap();
            Some((address, f32::from_be_bytes(number)))
        })
        .collect()
    }

    #[test]
    fn a_control_sends_its_value_in_its_range_and_a_key_its_velocity_and_depth() {
        let (mut sink, receiver) = sink();
        let (key, slider) = (TargetId(0), TargetId(1));
        let events = [
            EventKind::Velocity(key, 0.75),
            EventKind::Depth(key, 0.5),
            EventKind::Value(slider, 0.5),
            EventKind::Value(TargetId(2), 0.5),
            EventKind::Value(TargetId(9), 0.5),
            EventKind::Velocity(key, 0.0),
        ];
        sink.send(&events.map(|kind| event(1, kind))).unwrap();
        let expected = [
            ("/key", 0.75),
            ("/key/depth", 0.5),
            ("/mixer/1", -30.0),
            ("/key", 0.0),
        ];
        let expected = expected.map(|(address, number)| (address.to_owned(), number));
        assert_eq!(received(&receiver), expected);
    }

    #[test]
    fn presses_and_depths_end_with_the_layout_and_with_the_session_and_values_stay() {
        let (mut sink, receiver) = sink();
        let press = [
            event(1, EventKind::Velocity(TargetId(0), 1.0)),
            event(1, EventKind::Depth(TargetId(0), 0.5)),
            event(1, EventKind::Value(TargetId(1), 1.0)),
        ];
        let ends = [("/key".to_owned(), 0.0), ("/key/depth".to_owned(), 0.0)];
        let signals = sink.signals.clone();
        sink.send(&press).unwrap();
        received(&receiver);
        sink.set_signals(&signals);
        assert_eq!(received(&receiver), ends);
        sink.send(&press).unwrap();
        received(&receiver);
        drop(sink);
        assert_eq!(received(&receiver), ends);
    }

    #[test]
    fn a_press_that_cannot_be_sent_is_void_after_a_stop_and_its_release_is_sent_later() {
        let (mut sink, receiver) = sink();
        let message = sink.messages[0].value.as_mut().unwrap();
        message.due = Some(1.0);
        message.is_held = true;
        sink.has_due = true;
        sink.void_presses();
        sink.send(&[event(2, EventKind::Velocity(TargetId(0), 0.0))])
            .unwrap();
        assert_eq!(received(&receiver), [("/key".to_owned(), 0.0)]);
        assert_eq!(sink.dropped_presses(), 1);
    }

    #[test]
    fn a_release_that_cannot_be_sent_when_the_layout_changes_is_sent_later() {
        for is_same_layout in [false, true] {
            let (mut sink, receiver) = sink();
            let key = TargetId(0);
            let press = [event(1, EventKind::Velocity(key, 1.0))];
            sink.send(&press).unwrap();
            received(&receiver);
            let later = if is_same_layout {
                sink.signals.clone()
            } else {
                Signals::default()
            };
            let unconnected = UdpSocket::bind("127.0.0.1:0").unwrap();
            let connected = std::mem::replace(&mut sink.socket, unconnected);
            sink.set_signals(&later);
            sink.socket = connected;
            sink.send(&press).unwrap();
            let mut expected = vec![("/key".to_owned(), 0.0)];
            expected.extend(is_same_layout.then(|| ("/key".to_owned(), 1.0)));
            assert_eq!(received(&receiver), expected);
            assert!(!sink.has_due);
        }
    }

    #[test]
    fn a_receiver_that_starts_late_gets_the_first_message_after_its_start() {
        let (mut sink, receiver) = sink();
        let address = receiver.local_addr().unwrap();
        drop(receiver);
        sink.send(&[event(1, EventKind::Value(TargetId(1), 0.1))])
            .unwrap();
        let later_receiver = UdpSocket::bind(address).unwrap();
        later_receiver.set_nonblocking(true).unwrap();
        sink.send(&[event(1, EventKind::Value(TargetId(1), 1.0))])
            .unwrap();
        assert_eq!(received(&later_receiver), [("/mixer/1".to_owned(), 0.0)]);
    }
}
