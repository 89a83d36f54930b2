//! Lines as frames of a WebSocket. A frame from the server is the same for all clients.

use std::sync::Arc;

use tungstenite::protocol::frame::Frame;
use tungstenite::protocol::frame::coding::{Data, OpCode};

/// Returns a line as the frame of a text message, without the line end.
pub(super) fn text_frame(line: &[u8]) -> Arc<[u8]> {
    let text = line.strip_suffix(b"\n").unwrap_or(line).to_vec();
    let frame = Frame::message(text, OpCode::Data(Data::Text), true);
    let mut bytes = Vec::with_capacity(frame.len());
    frame
        .format(&mut bytes)
        .expect("a vector accepts all bytes");
    bytes.into()
}
