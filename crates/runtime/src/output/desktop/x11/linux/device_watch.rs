//! Presses of other devices: another keyboard types into the text that a correction would replace, and a click moves the cursor in it.
//!
//! The X Input extension reports them as raw events, also during a grab. Only the device of an event is read: not which key or
//! button it is, so a modifier and the wheel count, too. With a modifier down, a Backspace may delete a whole word, and a
//! full-screen editor in a terminal receives the wheel as arrow keys.

use std::cell::Cell;

use x11rb::connection::Connection;
use x11rb::errors::ReplyError;
use x11rb::protocol::Event;
use x11rb::protocol::xinput::{ConnectionExt as _, Device, DeviceId, EventMask, XIEventMask};
use x11rb::rust_connection::RustConnection;

/// The version of the extension that reports raw events of a touch screen, and all of them during a grab.
const VERSION: (u16, u16) = (2, 2);

/// The names of the devices whose events XTEST injects.
const XTEST_DEVICES: [&[u8]; 2] = [
    b"Virtual core XTEST keyboard",
    b"Virtual core XTEST pointer",
];

/// A notice of presses of devices other than the XTEST devices.
pub struct DeviceWatch {
    /// The devices of XTEST, or `None` if the server lacks the extension.
    xtest_devices: Option<Vec<DeviceId>>,
    is_started: bool,
    has_press: Cell<bool>,
}

impl DeviceWatch {
    /// Creates a watch that is not started.
    pub fn new(server: &RustConnection) -> Self {
        Self {
            xtest_devices: xtest_devices(server).ok().flatten(),
            is_started: false,
            has_press: Cell::new(false),
        }
    }

    /// Starts the watch unless it is started, without waiting for the server. Says if the server lacks the extension.
    pub fn start(&mut self, server: &RustConnection, root: u32) -> Result<(), ReplyError> {
        if std::mem::replace(&mut self.is_started, true) {
            return Ok(());
        }
        if self.xtest_devices.is_none() {
            let (major, minor) = VERSION;
            tracing::warn!(
                "the X server has no X Input extension {major}.{minor}: a correction may delete what another keyboard types, or follow \
                 a click; stop typing for 10 s before you use another keyboard or mouse in the same text"
            );
            return Ok(());
        }
        let events = XIEventMask::RAW_KEY_PRESS
            | XIEventMask::RAW_BUTTON_PRESS
            | XIEventMask::RAW_TOUCH_BEGIN;
        let mask = EventMask {
            // Their events contain the device that they come from.
            deviceid: Device::ALL_MASTER.into(),
            mask: vec![events],
        };
        server.xinput_xi_select_events(root, &[mask])?;
        server.flush()?;
        Ok(())
    }

    /// Notes an event that the server has sent.
    pub fn observe(&self, event: &Event) {
        let device = match event {
            Event::XinputRawKeyPress(press) => press.sourceid,
            Event::XinputRawButtonPress(press) => press.sourceid,
            Event::XinputRawTouchBegin(touch) => touch.sourceid,
            _ => return,
        };
        let is_xtest = |devices: &Vec<DeviceId>| devices.contains(&device);
        if !self.xtest_devices.as_ref().is_some_and(is_xtest) {
            self.has_press.set(true);
        }
    }

    /// Returns `true` if a press was noted since the last call.
    pub fn take_press(&self) -> bool {
        self.has_press.take()
    }
}

/// Returns the devices of XTEST, or `None` if the extension is too old.
fn xtest_devices(server: &RustConnection) -> Result<Option<Vec<DeviceId>>, ReplyError> {
    let (major, minor) = VERSION;
    let version = server.xinput_xi_query_version(major, minor)?.reply()?;
    if (version.major_version, version.minor_version) < VERSION {
        return Ok(None);
    }
    let devices = server.xinput_xi_query_device(Device::ALL)?.reply()?.infos;
    let xtest = devices
        .iter()
        .filter(|device| XTEST_DEVICES.contains(&device.name.as_slice()));
    Ok(Some(xtest.map(|device| device.deviceid).collect()))
}
