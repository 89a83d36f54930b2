//! Keys of a character that was being typed when the client exited.
//!
//! The display library types a character that the keymap lacks with a key that it chooses itself, and the X server
//! waits before it releases the key. If the client has exited by then, the key stays pressed.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::{ReplyError, RustConnection};

/// Time for which the server may still execute requests: it waits 12 ms before each of the two keys of a new character.
const SETTLE_TIME: Duration = Duration::from_millis(100);

/// Delay before the next query.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Releases all keys that any client has pressed on the X server of the session. Those of the user's keyboard are not
/// affected: they belong to another device.
pub fn release_stuck_keys() -> Result<(), String> {
    let (server, screen) = x11rb::connect(None).map_err(|error| error.to_string())?;
    let root = server.setup().roots[screen].root;
    let start = Instant::now();
    while start.elapsed() < SETTLE_TIME {
        release_pressed(&server, root).map_err(|error| error.to_string())?;
        thread::sleep(POLL_INTERVAL);
    }
    Ok(())
}

fn release_pressed(server: &RustConnection, root: u32) -> Result<(), ReplyError> {
    let bits = server.query_keymap()?.reply()?.keys;
    let is_pressed = |key: &u8| bits[usize::from(key / 8)] >> (key % 8) & 1 == 1;
    for key in (0..=u8::MAX).filter(is_pressed) {
        server.xtest_fake_input(KEY_RELEASE_EVENT, key, 0, root, 0, 0, 0)?;
    }
    server.flush()?;
    Ok(())
}
