//! The window that has the focus, asked on a connection of its own without waiting for the answer: the thread that asks must never
//! wait for a server that hangs, since it revokes presses.

use std::sync::Arc;

use x11rb::protocol::xproto::GetInputFocusRequest;

use super::direct::{Reader, Socket};
use crate::output::desktop::direct_keys::AnswerReader;
use crate::output::desktop::injector::WindowId;

/// A connection that asks which window has the focus.
pub struct FocusWatch {
    socket: Arc<Socket>,
    reader: Reader,
    is_asked: bool,
}

impl FocusWatch {
    /// Opens a connection. Returns `None` if the server does not answer.
    pub fn open(name: Option<&str>) -> Option<Self> {
        let (server, _) = x11rb::connect(name).ok()?;
        let socket = Socket::from_connection(&server)?;
        Some(Self {
            reader: Reader::new(Arc::clone(&socket)),
            socket,
            is_asked: false,
        })
    }

    /// Reads the answer to the last question if it has arrived, and asks again then. Returns the window of a new answer.
    pub fn poll(&mut self) -> Option<WindowId> {
        let is_open = self.reader.receive();
        let is_answered = self.reader.take_answer();
        if is_open && (is_answered || !self.is_asked) {
            let ([question], _) = GetInputFocusRequest.serialize();
            self.is_asked = self.socket.send(&question) == question.len();
        }
        is_answered.then(|| self.reader.focus()).flatten()
    }
}
