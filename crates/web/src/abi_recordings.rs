//! The boundary to JavaScript of recordings, as [`abi`](crate::abi) for the page.

#![allow(unsafe_code, reason = "a name that is not mangled is unsafe")]

use crate::abi::{reply, take_input, with_session};

/// Plays a recording, whose bytes are the input. Returns `{"readings":12}`, with its layout and the reason why its end is left out if
/// it has them, or `{"error":"…"}`.
#[unsafe(no_mangle)]
pub extern "C" fn page_play_recording(length: usize) -> usize {
    let bytes = take_input(length);
    with_session(0, |session, _| reply(session.play_recording(&bytes)))
}
