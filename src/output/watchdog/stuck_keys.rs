//! Keys of a character whose writer was ended in the middle of it.
//!
//! A character that the keymap lacks is written by a library, with a key that nobody else knows of, and the server itself waits
//! before it takes the key up again. When the program is gone by then, it does not.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::{ReplyError, RustConnection};

/// For how long a server may still do what it was sent: it waits 12 ms before a key of a new character, twice.
const AFTERMATH: Duration = Duration::from_millis(100);

/// How long to wait before the next look.
const PAUSE: Duration = Duration::from_millis(2);

/// Lets go of all keys that programs have pressed on the X server of the session, whoever they were: those of a real
/// keyboard are on a device of their own.
pub fn release_stuck_keys() -> Result<(), String> {
    let (server, screen) = x11rb::connect(None).map_err(|error| error.to_string())?;
    let root = server.setup().roots[screen].root;
    let start = Instant::now();
    while start.elapsed() < AFTERMATH {
        let_go(&server, root).map_err(|error| error.to_string())?;
        thread::sleep(PAUSE);
    }
    Ok(())
}

fn let_go(server: &RustConnection, root: u32) -> Result<(), ReplyError> {
    let bits = server.query_keymap()?.reply()?.keys;
    let is_down = |key: &u8| bits[usize::from(key / 8)] >> (key % 8) & 1 == 1;
    for key in (0..=u8::MAX).filter(is_down) {
        server.xtest_fake_input(KEY_RELEASE_EVENT, key, 0, root, 0, 0, 0)?;
    }
    server.flush()?;
    Ok(())
}
