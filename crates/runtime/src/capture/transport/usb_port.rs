//! Choice of the serial port on which a lost USB device returns.

use ademan_core::message::escape;

use serialport::{SerialPortInfo, SerialPortType};

/// Identity of a USB adapter. Adapters of one model without a serial number have the same identity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::capture) struct UsbIdentity {
    pub vendor: u16,
    pub product: u16,
    pub serial_number: Option<String>,
}

impl std::fmt::Display for UsbIdentity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "USB {:04x}:{:04x}", self.vendor, self.product)?;
        match &self.serial_number {
            Some(number) => write!(f, " serial number {}", escape(number)),
            None => Ok(()),
        }
    }
}

/// A present serial port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::capture) struct Port {
    pub name: String,
    pub usb: Option<UsbIdentity>,
}

impl From<SerialPortInfo> for Port {
    fn from(info: SerialPortInfo) -> Self {
        let usb = match info.port_type {
            SerialPortType::UsbPort(usb) => Some(UsbIdentity {
                vendor: usb.vid,
                product: usb.pid,
                serial_number: usb.serial_number,
            }),
            _ => None,
        };
        Self {
            name: info.port_name,
            usb,
        }
    }
}

/// Device that was on a port when the port was opened for the first time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::capture) struct KnownDevice {
    pub identity: UsbIdentity,
    /// `true` if another port had the same identity then, so that the device is identified by its port name.
    pub has_twin: bool,
}

impl KnownDevice {
    /// Finds the device on the port `name`. Returns `None` if it is not a USB device.
    pub fn find(name: &str, present: &[Port]) -> Option<Self> {
        let port = present.iter().find(|port| port.name == name)?;
        let identity = port.usb.clone()?;
        let same = present
            .iter()
            .filter(|other| other.usb.as_ref() == Some(&identity));
        let has_twin = same.count() > 1;
        Some(Self { identity, has_twin })
    }
}

/// Port to open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::capture) enum PortChoice {
    /// The port of this name.
    Open(String),
    /// No port has the identity of the device.
    Absent,
    /// No port has the identity of the device, and the port of its name has this one, if any.
    OtherDevice(Option<UsbIdentity>),
    /// Several ports have the identity of the device.
    Ambiguous(Vec<String>),
}

/// Chooses the port of a device that was on the port `name`, among the ports that are present.
///
/// A device of unknown identity is chosen by name. A known device is followed to another name, unless it has a twin.
pub(in crate::capture) fn choose_port(
    name: &str,
    known: Option<&KnownDevice>,
    present: &[Port],
) -> PortChoice {
    let Some(device) = known else {
        return PortChoice::Open(name.to_owned());
    };
    let matching: Vec<&Port> = present
        .iter()
        .filter(|port| port.usb.as_ref() == Some(&device.identity))
        .filter(|port| !device.has_twin || port.name == name)
        .collect();
    match matching.as_slice() {
        [port] => PortChoice::Open(port.name.clone()),
        [] => match present.iter().find(|port| port.name == name) {
            Some(other) => PortChoice::OtherDevice(other.usb.clone()),
            None => PortChoice::Absent,
        },
        several => PortChoice::Ambiguous(several.iter().map(|port| port.name.clone()).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(product: u16, serial_number: Option<&str>) -> UsbIdentity {
        UsbIdentity {
            vendor: 0x0403,
            product,
            serial_number: serial_number.map(str::to_owned),
        }
    }

    fn port(name: &str, usb: Option<UsbIdentity>) -> Port {
        Port {
            name: name.to_owned(),
            usb,
        }
    }

    #[test]
    fn a_lost_device_is_chosen_by_identity() {
        let glove = || Some(identity(0x6001, Some("A1")));
        let other = || Some(identity(0x6001, Some("B2")));
        let nameless = || Some(identity(0x6015, None));
        let known = KnownDevice {
            identity: glove().unwrap(),
            has_twin: false,
        };
        let known_nameless = KnownDevice {
            identity: nameless().unwrap(),
            has_twin: false,
        };
        let twin = KnownDevice {
            identity: nameless().unwrap(),
            has_twin: true,
        };
        let open = |name: &str| PortChoice::Open(name.to_owned());
        let (usb0, usb1) = ("/dev/ttyUSB0", "/dev/ttyUSB1");
        let table: [(&str, Option<&KnownDevice>, Vec<Port>, PortChoice); 12] = [
            ("identity unknown", None, vec![], open(usb0)),
            ("gone", Some(&known), vec![], PortChoice::Absent),
            (
                "same name",
                Some(&known),
                vec![port(usb0, glove())],
                open(usb0),
            ),
            (
                "new name",
                Some(&known),
                vec![port("/dev/ttyS0", None), port(usb1, glove())],
                open(usb1),
            ),
            (
                "other device beside it",
                Some(&known),
                vec![port(usb0, other()), port(usb1, glove())],
                open(usb1),
            ),
            (
                "other device only, other name",
                Some(&known),
                vec![port(usb1, other())],
                PortChoice::Absent,
            ),
            (
                "other device on its name",
                Some(&known),
                vec![port(usb0, other())],
                PortChoice::OtherDevice(other()),
            ),
            (
                "port without USB on its name",
                Some(&known),
                vec![port(usb0, None)],
                PortChoice::OtherDevice(None),
            ),
            (
                "two of one identity",
                Some(&known_nameless),
                vec![port(usb0, nameless()), port(usb1, nameless())],
                PortChoice::Ambiguous(vec![usb0.to_owned(), usb1.to_owned()]),
            ),
            (
                "twins, same name",
                Some(&twin),
                vec![port(usb0, nameless()), port(usb1, nameless())],
                open(usb0),
            ),
            (
                "twin, other name",
                Some(&twin),
                vec![port(usb1, nameless())],
                PortChoice::Absent,
            ),
            (
                "twin, other device on its name",
                Some(&twin),
                vec![port(usb0, glove()), port(usb1, nameless())],
                PortChoice::OtherDevice(glove()),
            ),
        ];
        for (case, device, present, expected) in table {
            assert_eq!(choose_port(usb0, device, &present), expected, "{case}");
        }
    }

    #[test]
    fn a_known_device_records_that_it_has_a_twin() {
        let alike = || Some(identity(0x6015, None));
        let present = [
            port("a", alike()),
            port("b", alike()),
            port("c", None),
            port("d", Some(identity(1, None))),
        ];
        assert!(KnownDevice::find("a", &present).unwrap().has_twin);
        assert!(!KnownDevice::find("d", &present).unwrap().has_twin);
        assert_eq!(KnownDevice::find("c", &present), None);
        assert_eq!(KnownDevice::find("absent", &present), None);
    }
}
