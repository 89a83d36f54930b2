//! Keys of devices of the kernel, and the readers of their events.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::os::fd::AsFd;
use std::thread;
use std::time::{Duration, Instant};

use ademan::device::{Capabilities, EventKind, KeyCode, OutputEvent};
use ademan::output::Sink;
use ademan::output::uinput::Uinput;
use ademan::time::Timestamp;
use crossbeam_channel::{Sender, bounded};
use evdev::uinput::VirtualDevice;
use evdev::{AttributeSet, Device, EventType, InputEvent};

use super::programs::{Output, Writer};

/// Polling interval while a device node is created.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

/// Names of the devices, which programs have in turn.
const PLAIN_DEVICES: [&str; 2] = ["Plain 1 keyboard", "Plain 2 keyboard"];
const OWN_DEVICES: [&str; 2] = ["Own 1", "Own 2"];

/// Size of `struct input_event`: its time, which the kernel sets, type, code and value.
const EVENT_BYTES: usize = size_of::<InputEvent>();

/// Creates a device for each program. Returns `None` without access to `/dev/uinput`.
pub fn output() -> Option<Output> {
    if let Err(error) = OpenOptions::new().write(true).open("/dev/uinput") {
        println!("uinput: SKIPPED: /dev/uinput: {error}");
        return None;
    }
    let (done, arrivals) = bounded(16);
    let plain = PLAIN_DEVICES.map(|name| -> Box<dyn Writer> { Box::new(Plain::new(name)) });
    let own = OWN_DEVICES.map(|name| -> Box<dyn Writer> { Box::new(Own::new(name)) });
    for name in PLAIN_DEVICES {
        listen(name, done.clone());
    }
    for name in OWN_DEVICES {
        listen(&format!("{name} keyboard"), done.clone());
    }
    Some(Output {
        name: "a reader of uinput",
        writers: plain.into_iter().chain(own).collect(),
        arrivals,
    })
}

/// Reports the time of each key event of the device with this name.
fn listen(name: &str, done: Sender<Instant>) {
    let mut device = find(name);
    thread::spawn(move || {
        while let Ok(events) = device.fetch_events() {
            let end = Instant::now();
            let mut events = events;
            if events.any(|event| event.event_type() == EventType::KEY) {
                let _ = done.try_send(end);
            }
        }
    });
}

/// Opens the device with this name as soon as it has a node.
fn find(name: &str) -> Device {
    loop {
        let mut devices = evdev::enumerate().map(|(_, device)| device);
        if let Some(device) = devices.find(|device| device.name() == Some(name)) {
            return device;
        }
        thread::sleep(POLL_INTERVAL);
    }
}

/// The minimum: one system call with the event and its `SYN_REPORT`.
struct Plain {
    node: File,
    is_pressed: bool,
}

impl Plain {
    fn new(name: &str) -> Self {
        let keys = AttributeSet::from_iter([evdev::KeyCode::KEY_A]);
        let builder = VirtualDevice::builder().expect("access to /dev/uinput");
        let builder = builder.name(name).with_keys(&keys).expect("a key");
        let device = builder.build().expect("a device");
        let node = device.as_fd().try_clone_to_owned();
        Self {
            node: File::from(node.expect("a duplicate")),
            is_pressed: false,
        }
    }
}

impl Writer for Plain {
    fn write(&mut self) {
        self.is_pressed = !self.is_pressed;
        let mut report = [0; 2 * EVENT_BYTES];
        let words = EVENT_BYTES - 8;
        report[words..words + 2].copy_from_slice(&EventType::KEY.0.to_ne_bytes());
        report[words + 2..words + 4].copy_from_slice(&evdev::KeyCode::KEY_A.0.to_ne_bytes());
        report[words + 4] = u8::from(self.is_pressed);
        self.node.write_all(&report).expect("the device exists");
    }
}

/// The output `uinput`.
struct Own {
    sink: Uinput,
    key: KeyCode,
    is_pressed: bool,
}

impl Own {
    fn new(name: &str) -> Self {
        let key = "A".parse().expect("a key");
        let required = Capabilities {
            keys: [key].into(),
            ..Capabilities::default()
        };
        Self {
            sink: Uinput::open(name, &required).expect("a device"),
            key,
            is_pressed: false,
        }
    }
}

impl Writer for Own {
    fn write(&mut self) {
        self.is_pressed = !self.is_pressed;
        let kind = if self.is_pressed {
            EventKind::KeyDown(self.key)
        } else {
            EventKind::KeyUp(self.key)
        };
        let time = Timestamp(0);
        let sent = self.sink.send(&[OutputEvent { time, kind }]);
        sent.expect("the device exists");
    }
}
