//! Request for a connection to an X server, which may listen and still refuse its clients:
//! <https://www.x.org/releases/current/doc/xproto/x11protocol.html#Connection_Setup>.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use x11rb::reexports::x11rb_protocol::connect::Connect;
use x11rb::reexports::x11rb_protocol::xauth::{Family, get_auth};

use crate::output::socket;

/// Time-out of the request and of each part of the reply.
const TIMEOUT: Duration = Duration::from_secs(5);

/// The first byte of a reply with a reason why there is no connection.
const FAILED: u8 = 0;
/// The first byte of a reply that accepts the connection.
const ACCEPTED: u8 = 1;

/// Connects to the server at a socket, with the cookie of `XAUTHORITY` for this host and display. Returns the reason if the server refuses
/// the connection.
pub(super) fn refusal(path: &Path, host: &[u8], display: u16) -> io::Result<Option<String>> {
    let mut stream = socket::connect_to_any(path)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    // Without a cookie a server may still accept its own user, as in `x11rb::connect`.
    let cookie = get_auth(Family::LOCAL, host, display).ok().flatten();
    let (name, data) = cookie.unwrap_or_default();
    let (_, request) = Connect::with_authorization(name, data);
    stream.write_all(&request)?;
    let mut head = [0; 8];
    stream.read_exact(&mut head)?;
    let [status, length, .., low, high] = head;
    if status == ACCEPTED {
        return Ok(None);
    }
    let words = u16::from_ne_bytes([low, high]);
    let mut reason = vec![0; 4 * usize::from(words)];
    stream.read_exact(&mut reason)?;
    // Only a failure states the length of its reason.
    let length = if status == FAILED { length } else { u8::MAX };
    reason.truncate(length.into());
    let reason = String::from_utf8_lossy(&reason);
    Ok(Some(reason.trim_end_matches('\0').to_owned()))
}
