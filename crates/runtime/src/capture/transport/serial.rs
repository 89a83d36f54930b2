//! Serial ports with 8 data bits, no parity and 1 stop bit, opened exclusively.

use std::fs::File;
use std::io::{Read, Write};
use std::num::NonZeroU32;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serialport::{ClearBuffer, DataBits, ErrorKind, FlowControl, Parity, SerialPort, StopBits};

use super::descriptor::{TerminalIdentity, open_to_read};
use super::usb_port::{KnownDevice, Port, PortChoice, choose_port};
use super::{Scheme, Transport, check_no_question_mark, open_stream};
use crate::advice::{self, AccessDenied};
use crate::capture::connection::{
    ByteStream, ConnectError, Connection, Connector, READ_TIMEOUT, WRITE_TIMEOUT, is_idle,
};
use crate::capture::poll::Readiness;
use ademan_core::message::escape;

/// The `serial` transport.
pub const TRANSPORT: Transport = Transport {
    scheme: Scheme {
        name: "serial",
        syntax: "serial:PORT",
        summary: "serial port",
        example: "serial:/dev/ttyUSB0?baud=9600",
    },
    is_remote: false,
    is_datagram: false,
    needs_token: false,
    is_device: true,
    has_address: true,
    default_baud: Some(DEFAULT_BAUD),
    probe: None,
    check_address: check_no_question_mark,
    open: |uri| {
        let baud = uri.format.baud.unwrap_or(DEFAULT_BAUD);
        open_stream(uri, SerialConnector::new(&uri.address, baud.get()))
    },
};

/// The bit rate if the URI states none.
pub const DEFAULT_BAUD: NonZeroU32 = NonZeroU32::new(115_200).unwrap();

/// Connector to a serial port, which follows a USB device to another port name.
#[derive(Clone)]
struct SerialConnector {
    port: String,
    baud: u32,
    known: Option<KnownDevice>,
    /// Identity of the pseudo-terminal that was opened last. Shared with the clone that reconnects.
    terminal: Arc<Mutex<Option<TerminalIdentity>>>,
}

impl SerialConnector {
    fn new(port: &str, baud: u32) -> Self {
        Self {
            port: port.to_owned(),
            baud,
            known: None,
            terminal: Arc::default(),
        }
    }
}

impl Connector for SerialConnector {
    const IS_LIVE: bool = true;
    const RECONNECTS: bool = true;
    const STARTS_ANYWHERE: bool = true;
    const FIRST_BYTE_TIMEOUT: Option<Duration> = Some(Duration::from_secs(5));

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let present = present_ports();
        let wanted = resolve(&self.port);
        let port_name = match choose_port(&wanted, self.known.as_ref(), &present) {
            PortChoice::Open(name) if name == wanted => self.port.clone(),
            PortChoice::Open(name) => name,
            choice => return Err(choice_error(choice, self)),
        };
        let identity = TerminalIdentity::read(&port_name);
        let mut terminal = self.terminal.lock().unwrap_or_else(PoisonError::into_inner);
        if identity.is_some() && *terminal == identity {
            // The number now belongs to another terminal, such as a shell, whose input is not a glove's.
            return Err(ConnectError::Absent(
                "that pseudo-terminal has ended; give its successor a link of the same name".into(),
            ));
        }
        let file = open_to_read(&port_name);
        let port = open(&port_name, self.baud)
            .map_err(|error| open_error(&error, &port_name, &present))?;
        *terminal = identity;
        if self.known.is_none() {
            self.known = KnownDevice::find(&wanted, &present);
        }
        Ok(connection(port, file, port_name))
    }
}

/// Returns a connection that reads through `file` if that reports when bytes can be read, else through `port`.
fn connection(port: Box<dyn SerialPort>, file: Option<File>, endpoint: String) -> Connection {
    let readiness = file.as_ref().and_then(Readiness::new);
    let bytes: Box<dyn ByteStream> = match file {
        Some(file) if readiness.is_some() => Box::new(SeparateReader { file, port }),
        _ => Box::new(port),
    };
    Connection {
        bytes,
        readiness,
        endpoint,
    }
}

/// Reader of a port through a file of its own.
struct SeparateReader {
    file: File,
    /// Keeps the port locked for other programs, and writes.
    port: Box<dyn SerialPort>,
}

impl Read for SeparateReader {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.file.read(buffer)
    }
}

impl ByteStream for SeparateReader {
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        self.port.writer()
    }
}

impl ByteStream for Box<dyn SerialPort> {
    fn writer(&self) -> Option<Box<dyn Write + Send>> {
        let mut port = self.try_clone().ok()?;
        port.set_timeout(WRITE_TIMEOUT).ok()?;
        Some(Box::new(PortWriter {
            port,
            is_blocked: false,
        }))
    }
}

/// Writer to a port.
struct PortWriter {
    port: Box<dyn SerialPort>,
    /// `true` if the device did not read the latest bytes.
    is_blocked: bool,
}

impl Write for PortWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.port.write(bytes);
        self.is_blocked = written.is_err();
        written
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.port.flush()
    }
}

impl Drop for PortWriter {
    /// Discards what the device does not read: the kernel may wait 30 s for that when a port is closed.
    fn drop(&mut self) {
        if self.is_blocked {
            let _ = self.port.clear(ClearBuffer::Output);
        }
    }
}

/// Returns the names of the serial ports of this machine.
pub fn port_names() -> Vec<String> {
    let ports = present_ports().into_iter();
    ports.map(|port| port.name).collect()
}

/// Passes the bytes of a port to `receive` until it returns `false`. `receive` is also called, without bytes, whenever none arrive
/// for [`READ_TIMEOUT`]. An error states the reason and the remedy.
pub fn listen(
    port_name: &str,
    baud: NonZeroU32,
    mut receive: impl FnMut(&[u8]) -> bool,
) -> Result<(), String> {
    let mut port = open(port_name, baud.get())
        .map_err(|error| open_error(&error, port_name, &present_ports()).into_reason())?;
    let mut buffer = [0; 512];
    loop {
        let length = match port.read(&mut buffer) {
            Ok(0) => return Ok(()),
            Ok(length) => length,
            Err(error) if is_idle(error.kind()) => 0,
            Err(error) => return Err(error.to_string()),
        };
        if !receive(&buffer[..length]) {
            return Ok(());
        }
    }
}

fn present_ports() -> Vec<Port> {
    let checked = check_port_list().map_err(serialport::Error::from);
    match checked.and_then(|()| serialport::available_ports()) {
        Ok(ports) => ports.into_iter().map(Port::from).collect(),
        Err(error) => {
            tracing::debug!("cannot list the serial ports: {error}");
            Vec::new()
        }
    }
}

/// Fails where `serialport` would panic: on Linux without a mounted `/sys`, or without a free file descriptor.
fn check_port_list() -> std::io::Result<()> {
    if cfg!(target_os = "linux") {
        std::fs::read_dir("/sys/class/tty").map(drop)?;
    }
    Ok(())
}

/// Returns the device behind a link such as the links in `/dev/serial/by-id`.
fn resolve(port: &str) -> String {
    let is_link = std::fs::read_link(port).is_ok();
    match std::fs::canonicalize(port) {
        Ok(path) if is_link => path.to_string_lossy().into_owned(),
        _ => port.to_owned(),
    }
}

fn open(port_name: &str, baud: u32) -> serialport::Result<Box<dyn SerialPort>> {
    let mut port = serialport::new(port_name, baud)
        .data_bits(DataBits::Eight)
        .parity(Parity::None)
        .stop_bits(StopBits::One)
        .flow_control(FlowControl::None)
        .timeout(READ_TIMEOUT)
        .open()?;
    // Some gloves are powered by these two lines; pseudo-terminals and some adapters do not have them.
    for (line, result) in [
        ("DTR", port.write_data_terminal_ready(true)),
        ("RTS", port.write_request_to_send(true)),
    ] {
        if let Err(error) = result {
            tracing::debug!("{port_name} does not set {line}: {error}");
        }
    }
    // Bytes received before now would be read as movement of the hand now.
    if let Err(error) = port.clear(ClearBuffer::Input) {
        tracing::debug!("cannot discard the old input of {port_name}: {error}");
    }
    Ok(port)
}

/// Returns the reason why no port is opened.
fn choice_error(choice: PortChoice, connector: &SerialConnector) -> ConnectError {
    let wanted = match &connector.known {
        Some(device) => device.identity.to_string(),
        None => "the device".to_owned(),
    };
    let port = escape(&connector.port);
    match choice {
        PortChoice::OtherDevice(Some(other)) => ConnectError::Unusable(format!(
            "{port} is now another device ({other}), plug in {wanted} or start again with the new one"
        )),
        PortChoice::OtherDevice(None) => ConnectError::Unusable(format!(
            "{port} is now another device, plug in {wanted} or start again with the new one"
        )),
        PortChoice::Ambiguous(names) => ConnectError::Unusable(format!(
            "{} are all {wanted}, unplug all but one or start again with the port to use",
            escape(&names.join(" and "))
        )),
        PortChoice::Absent | PortChoice::Open(_) => {
            ConnectError::Absent(format!("{wanted} is not plugged in"))
        }
    }
}

/// Returns the reason why `port_name` does not open, and the remedy.
fn open_error(error: &serialport::Error, port_name: &str, present: &[Port]) -> ConnectError {
    let path = Path::new(port_name);
    let exists = path.exists() || present.iter().any(|port| port.name == port_name);
    match error.kind {
        ErrorKind::NoDevice if exists => ConnectError::Unusable(
            "it is in use by another program, close that one first".to_owned(),
        ),
        ErrorKind::Io(std::io::ErrorKind::PermissionDenied) => ConnectError::Unusable(
            advice::serial_port_denied(port_name, &AccessDenied::Unknown).to_string(),
        ),
        ErrorKind::NoDevice | ErrorKind::Io(std::io::ErrorKind::NotFound) => {
            ConnectError::Absent(format!("there is no such port; {}", list(present)))
        }
        _ if path.is_dir() => {
            ConnectError::Unusable("it is a folder, not a serial port".to_owned())
        }
        _ if path.is_file() => ConnectError::Unusable(format!(
            "it is a file, not a serial port; to read bytes from a file write `file:{}`",
            escape(port_name)
        )),
        _ if exists => ConnectError::Unusable(format!(
            "it does not work as a serial port ({}); {}",
            error.description,
            list(present)
        )),
        _ => ConnectError::Absent(error.description.clone()),
    }
}

fn list(present: &[Port]) -> String {
    if present.is_empty() {
        return "no serial port is present, check the cable".to_owned();
    }
    let names: Vec<String> = present
        .iter()
        .map(|port| match &port.usb {
            Some(usb) => format!("{} ({usb})", escape(&port.name)),
            None => escape(&port.name).into_owned(),
        })
        .collect();
    format!("present: {}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::transport::usb_port::UsbIdentity;

    fn usb_port(name: &str) -> Port {
        Port {
            name: name.to_owned(),
            usb: Some(UsbIdentity {
                vendor: 0x0403,
                product: 0x6001,
                serial_number: Some("A1".to_owned()),
            }),
        }
    }

    #[test]
    fn each_reason_for_a_failed_open_has_a_remedy() {
        let io = |kind| ErrorKind::Io(kind);
        let present = [usb_port("/dev/ttyUSB7")];
        let folder = env!("CARGO_MANIFEST_DIR");
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
        let table = [
            (
                "/dev/ttyUSB0",
                io(std::io::ErrorKind::NotFound),
                "present: /dev/ttyUSB7 (USB 0403:6001 serial number A1)",
            ),
            ("/dev/ttyUSB0", ErrorKind::NoDevice, "there is no such port"),
            (
                "/dev/ttyUSB7",
                ErrorKind::NoDevice,
                "in use by another program",
            ),
            (
                "/dev/ttyUSB7",
                io(std::io::ErrorKind::PermissionDenied),
                "sudo usermod --append --groups dialout $USER",
            ),
            (
                "/dev/ttyUSB7",
                io(std::io::ErrorKind::PermissionDenied),
                "`ls -l /dev/ttyUSB7` shows its group",
            ),
            (
                "/dev/ttyUSB7",
                ErrorKind::Unknown,
                "does not work as a serial port (why)",
            ),
            (folder, ErrorKind::Unknown, "it is a folder"),
            (file, ErrorKind::Unknown, "write `file:"),
        ];
        for (port_name, kind, part) in table {
            let error = serialport::Error::new(kind, "why");
            let (ConnectError::Absent(reason) | ConnectError::Unusable(reason)) =
                open_error(&error, port_name, &present);
            assert!(reason.contains(part), "{port_name} {kind:?}: {reason}");
            assert!(!reason.contains("as root"), "{reason}");
        }
    }

    #[test]
    fn another_device_and_ambiguous_devices_are_rejected_by_name() {
        let mut connector = SerialConnector::new("/dev/ttyUSB0", 9600);
        connector.known = KnownDevice::find("/dev/ttyUSB0", &[usb_port("/dev/ttyUSB0")]);
        let other = choice_error(PortChoice::OtherDevice(None), &connector);
        let ConnectError::Unusable(reason) = other else {
            panic!("{other:?}");
        };
        assert_eq!(
            reason,
            "/dev/ttyUSB0 is now another device, plug in USB 0403:6001 serial number A1 or start again with the new one"
        );
        let ambiguous = choice_error(
            PortChoice::Ambiguous(vec!["a".to_owned(), "b".to_owned()]),
            &connector,
        );
        assert!(
            matches!(ambiguous, ConnectError::Unusable(text) if text.starts_with("a and b are all USB"))
        );
        assert!(matches!(
            choice_error(PortChoice::Absent, &connector),
            ConnectError::Absent(_)
        ));
    }
}
