//! Request for a connection to an X server, which may listen and still refuse its clients:
//! <https://www.x.org/releases/current/doc/xproto/x11protocol.html#Connection_Setup>.

use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use x11rb::reexports::x11rb_protocol::connect::Connect;
use x11rb::reexports::x11rb_protocol::xauth::{Family, get_auth};

use crate::advice;
use crate::output::socket;

/// Time-out of the request and of each part of the reply.
const TIMEOUT: Duration = Duration::from_secs(5);

/// Connects to the server at a socket, with the cookie of `XAUTHORITY` for this host and display. Returns the reason if the server refuses
/// the connection.
pub(super) fn refusal(path: &Path, host: &[u8], display: u16) -> io::Result<Option<String>> {
    let mut stream = socket::connect_to_any(path)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    // Without a cookie a server may still accept its own user, as in `x11rb::connect`.
    let cookie = get_auth(Family::LOCAL, host, display).ok().flatten();
    let (name, data) = cookie.unwrap_or_default();
    let (mut connect, request) = Connect::with_authorization(name, data);
    stream.write_all(&request)?;
    // The head of the reply, then the rest, whose length the head states.
    while !connect.buffer().is_empty() {
        let part = connect.buffer();
        stream.read_exact(part)?;
        let length = part.len();
        connect.advance(length);
    }
    match connect.into_setup() {
        Ok(_) => Ok(None),
        Err(error) => {
            let refusal = advice::refusal_of_display(&error);
            refusal.map(Some).ok_or_else(|| io::Error::other(error))
        }
    }
}
