//! The focus of an X server: the window manager names the active window in a property of the root window (EWMH).

use std::env;
use std::os::fd::{AsFd, BorrowedFd};

use x11rb::connection::Connection;
use x11rb::errors::{ConnectionError, ReplyError};
use x11rb::properties::WmClass;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ChangeWindowAttributesAux, ConnectionExt, EventMask, Window,
};
use x11rb::rust_connection::RustConnection;

use super::Desktop;
use crate::advice;

/// The most atoms of `_NET_SUPPORTED`; a window manager has about a hundred.
const MAX_SUPPORTED: u32 = 4096;

pub struct XServer {
    connection: RustConnection,
    root: Window,
    active_window: Atom,
    /// `true` if the property has not been read since it changed.
    has_changed: bool,
}

impl XServer {
    /// Connects to the server that `DISPLAY` names.
    pub fn connect() -> Result<Self, String> {
        let (connection, screen) = x11rb::connect(None).map_err(|error| {
            let refusal = advice::refused_by_display(&error);
            let no_focus = || advice::no_focus(env::var("DISPLAY").ok().as_deref());
            refusal.unwrap_or_else(no_focus).to_string()
        })?;
        let root = connection.setup().roots[screen].root;
        let server = Self {
            active_window: atom(&connection, b"_NET_ACTIVE_WINDOW").map_err(message)?,
            connection,
            root,
            has_changed: true,
        };
        if !server.has_window_manager().map_err(message)? {
            return Err("no window manager tells which window has the focus (`_NET_ACTIVE_WINDOW`); start one before this program".into());
        }
        let mask = ChangeWindowAttributesAux::new().event_mask(EventMask::PROPERTY_CHANGE);
        let request = server.connection.change_window_attributes(root, &mask);
        request
            .map_err(ReplyError::from)
            .and_then(|request| request.check())
            .map_err(message)?;
        Ok(server)
    }

    fn has_window_manager(&self) -> Result<bool, ReplyError> {
        let supported = atom(&self.connection, b"_NET_SUPPORTED")?;
        let list = self.connection.get_property(
            false,
            self.root,
            supported,
            AtomEnum::ATOM,
            0,
            MAX_SUPPORTED,
        )?;
        let list = list.reply()?;
        let mut atoms = list.value32().into_iter().flatten();
        Ok(atoms.any(|atom| atom == self.active_window))
    }

    /// Returns class and instance of the active window, or `None` if there is none or it has just been closed.
    fn active_application(&self) -> Result<Option<Vec<String>>, ReplyError> {
        let property = self.connection.get_property(
            false,
            self.root,
            self.active_window,
            AtomEnum::WINDOW,
            0,
            1,
        )?;
        let property = property.reply()?;
        let window = property.value32().and_then(|mut windows| windows.next());
        let Some(window) = window.filter(|window| *window != x11rb::NONE) else {
            return Ok(None);
        };
        match WmClass::get(&self.connection, window)?.reply() {
            Ok(class) => Ok(Some(class.as_ref().map_or(Vec::new(), names))),
            Err(ReplyError::X11Error(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Notes changes of the property among the events that have arrived.
    fn receive(&mut self) -> Result<(), ConnectionError> {
        while let Some(event) = self.connection.poll_for_event()? {
            let is_change =
                matches!(event, Event::PropertyNotify(event) if event.atom == self.active_window);
            self.has_changed |= is_change;
        }
        Ok(())
    }
}

impl Desktop for XServer {
    fn name(&self) -> &'static str {
        "the X server"
    }

    fn socket(&self) -> BorrowedFd<'_> {
        self.connection.stream().as_fd()
    }

    fn read(&mut self) -> Result<Option<Vec<String>>, String> {
        let mut names = None;
        self.receive().map_err(message)?;
        // An event that arrives before a reply waits in this process and not at the socket.
        while std::mem::take(&mut self.has_changed) {
            names = self.active_application().map_err(message)?;
            self.receive().map_err(message)?;
        }
        Ok(names)
    }
}

fn names(class: &WmClass) -> Vec<String> {
    let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    vec![name(class.class()), name(class.instance())]
}

fn atom(connection: &RustConnection, name: &[u8]) -> Result<Atom, ReplyError> {
    Ok(connection.intern_atom(false, name)?.reply()?.atom)
}

fn message(error: impl ToString) -> String {
    format!("the X server failed: {}", error.to_string())
}
