//! Serial ports: 8 data bits, no parity, 1 stop bit, opened for this program alone.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use serialport::{ClearBuffer, DataBits, ErrorKind, FlowControl, Parity, SerialPort, StopBits};

use super::usb_port::{KnownDevice, Port, PortChoice, choose_port};
use super::{ConnectError, Connection, Connector, READ_TIMEOUT};
use crate::advice::{self, AccessDenied};
use crate::capture::lists_serial_ports;
use crate::capture::poll::{self, Readiness, TerminalName};

/// Opens a serial port, and finds its device again under another name.
#[derive(Clone)]
pub(in crate::capture) struct SerialConnector {
    port: String,
    baud: u32,
    known: Option<KnownDevice>,
    /// The pseudo-terminal that was opened last, if it was one; the search for it opens the next.
    terminal: Arc<Mutex<Option<TerminalName>>>,
}

impl SerialConnector {
    pub fn new(port: &str, baud: u32) -> Self {
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

    fn connect(&mut self) -> Result<Connection, ConnectError> {
        let present = present_ports();
        let wanted = resolve(&self.port);
        let place = match choose_port(&wanted, self.known.as_ref(), &present) {
            PortChoice::Open(name) if name == wanted => self.port.clone(),
            PortChoice::Open(name) => name,
            refused => return Err(refuse(refused, self)),
        };
        let name = TerminalName::of(&place);
        let mut terminal = self.terminal.lock().unwrap_or_else(PoisonError::into_inner);
        if name.is_some() && *terminal == name {
            // Whoever has that number now is somebody else, such as a shell: what is typed there is not for us.
            return Err(ConnectError::Absent(
                "that pseudo-terminal has ended; give its successor a link of the same name".into(),
            ));
        }
        let file = poll::open_to_read(&place);
        let port = open(&place, self.baud).map_err(|error| explain(&error, &place, &present))?;
        *terminal = name;
        if self.known.is_none() {
            self.known = KnownDevice::on(&wanted, &present);
        }
        Ok(connection(port, file, place))
    }
}

/// The port, read through `file` where that says when there is something.
fn connection(port: Box<dyn SerialPort>, file: Option<File>, place: String) -> Connection {
    let readiness = file.as_ref().and_then(Readiness::of);
    let bytes: Box<dyn Read + Send> = match file {
        Some(file) if readiness.is_some() => Box::new(ReadApart { file, _port: port }),
        _ => Box::new(port),
    };
    Connection {
        bytes,
        readiness,
        endpoint: place,
    }
}

/// A port that is read through a file of its own.
struct ReadApart {
    file: File,
    /// Keeps the port this program's alone.
    _port: Box<dyn SerialPort>,
}

impl Read for ReadApart {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.file.read(buffer)
    }
}

fn present_ports() -> Vec<Port> {
    if !lists_serial_ports() {
        return Vec::new();
    }
    match serialport::available_ports() {
        Ok(ports) => ports.into_iter().map(Port::from).collect(),
        Err(error) => {
            tracing::debug!("the serial ports cannot be listed: {error}");
            Vec::new()
        }
    }
}

/// The device behind a link such as those in `/dev/serial/by-id`.
fn resolve(port: &str) -> String {
    let is_link = std::fs::read_link(port).is_ok();
    match std::fs::canonicalize(port) {
        Ok(path) if is_link => path.to_string_lossy().into_owned(),
        _ => port.to_owned(),
    }
}

fn open(place: &str, baud: u32) -> serialport::Result<Box<dyn SerialPort>> {
    let mut port = serialport::new(place, baud)
        .data_bits(DataBits::Eight)
        .parity(Parity::None)
        .stop_bits(StopBits::One)
        .flow_control(FlowControl::None)
        .timeout(READ_TIMEOUT)
        .open()?;
    // Some gloves are fed by these two lines; pseudo terminals and some adapters do not have them.
    for (line, result) in [
        ("DTR", port.write_data_terminal_ready(true)),
        ("RTS", port.write_request_to_send(true)),
    ] {
        if let Err(error) = result {
            tracing::debug!("{place} does not set {line}: {error}");
        }
    }
    // What waited from before would be taken for a hand that moves now.
    if let Err(error) = port.clear(ClearBuffer::Input) {
        tracing::debug!("{place} keeps what came before it was opened: {error}");
    }
    Ok(port)
}

fn refuse(choice: PortChoice, connector: &SerialConnector) -> ConnectError {
    let wanted = match &connector.known {
        Some(device) => device.identity.to_string(),
        None => "the device".to_owned(),
    };
    let port = &connector.port;
    match choice {
        PortChoice::OtherDevice(Some(other)) => ConnectError::Unusable(format!(
            "{port} is now another device ({other}), plug in {wanted} or start again with the new one"
        )),
        PortChoice::OtherDevice(None) => ConnectError::Unusable(format!(
            "{port} is now another device, plug in {wanted} or start again with the new one"
        )),
        PortChoice::Ambiguous(names) => ConnectError::Unusable(format!(
            "{} are all {wanted}, unplug all but one or start again with the port to use",
            names.join(" and ")
        )),
        PortChoice::Absent | PortChoice::Open(_) => {
            ConnectError::Absent(format!("{wanted} is not plugged in"))
        }
    }
}

/// Says what happened at opening and what to do.
fn explain(error: &serialport::Error, place: &str, present: &[Port]) -> ConnectError {
    let path = Path::new(place);
    let exists = path.exists() || present.iter().any(|port| port.name == place);
    match error.kind {
        ErrorKind::NoDevice if exists => ConnectError::Unusable(
            "it is in use by another program, close that one first".to_owned(),
        ),
        ErrorKind::Io(std::io::ErrorKind::PermissionDenied) => ConnectError::Unusable(
            advice::serial_port_denied(place, &AccessDenied::Unknown).to_string(),
        ),
        ErrorKind::NoDevice | ErrorKind::Io(std::io::ErrorKind::NotFound) => {
            ConnectError::Absent(format!("there is no such port; {}", list(present)))
        }
        _ if path.is_dir() => {
            ConnectError::Unusable("it is a folder, not a serial port".to_owned())
        }
        _ if path.is_file() => ConnectError::Unusable(format!(
            "it is a file, not a serial port; to read bytes from a file write `file:{place}`"
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
            Some(usb) => format!("{} ({usb})", port.name),
            None => port.name.clone(),
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
    fn each_way_of_not_opening_says_what_to_do() {
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
                "`ls -l /dev/ttyUSB7` shows the group",
            ),
            (
                "/dev/ttyUSB7",
                ErrorKind::Unknown,
                "does not work as a serial port (why)",
            ),
            (folder, ErrorKind::Unknown, "it is a folder"),
            (file, ErrorKind::Unknown, "write `file:"),
        ];
        for (place, kind, part) in table {
            let error = serialport::Error::new(kind, "why");
            let (ConnectError::Absent(reason) | ConnectError::Unusable(reason)) =
                explain(&error, place, &present);
            assert!(reason.contains(part), "{place} {kind:?}: {reason}");
            assert!(!reason.contains("as root"), "{reason}");
        }
    }

    #[test]
    fn a_stranger_and_twins_are_refused_by_name() {
        let mut connector = SerialConnector::new("/dev/ttyUSB0", 9600);
        connector.known = KnownDevice::on("/dev/ttyUSB0", &[usb_port("/dev/ttyUSB0")]);
        let stranger = refuse(PortChoice::OtherDevice(None), &connector);
        let ConnectError::Unusable(reason) = stranger else {
            panic!("{stranger:?}");
        };
        assert_eq!(
            reason,
            "/dev/ttyUSB0 is now another device, plug in USB 0403:6001 serial number A1 or start again with the new one"
        );
        let twins = refuse(
            PortChoice::Ambiguous(vec!["a".to_owned(), "b".to_owned()]),
            &connector,
        );
        assert!(
            matches!(twins, ConnectError::Unusable(reason) if reason.starts_with("a and b are all USB"))
        );
        assert!(matches!(
            refuse(PortChoice::Absent, &connector),
            ConnectError::Absent(_)
        ));
    }
}
