//! Query of the globals of a Wayland compositor. It needs two requests and one event of the protocol:
//! <https://wayland.freedesktop.org/docs/html/ch04.html#sect-Protocol-Wire-Format>.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use rustix::net::sockopt::socket_peercred;

use crate::output::socket;

/// Time-out of one message.
const TIMEOUT: Duration = Duration::from_secs(1);

/// Largest number of messages; more than any compositor sends.
const MAX_MESSAGES: usize = 4096;

/// Id of the object that exists from the start.
const DISPLAY: u32 = 1;
const REGISTRY: u32 = 2;
const CALLBACK: u32 = 3;

/// Returns the process id of the compositor, if visible, and the names of its interfaces.
pub(super) fn globals(path: &Path) -> io::Result<(Option<i32>, Vec<String>)> {
    let mut stream = socket::connect_to_any(path)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    let get_registry = message(DISPLAY, 1, REGISTRY);
    let sync = message(DISPLAY, 0, CALLBACK);
    stream.write_all(&[get_registry, sync].concat())?;
    let mut globals = Vec::new();
    for _ in 0..MAX_MESSAGES {
        match read_message(&mut stream)? {
            (REGISTRY, 0, body) => globals.extend(interface(&body)),
            (CALLBACK, ..) => return Ok((peer_process(&stream), globals)),
            (DISPLAY, 0, _) => return Err(io::Error::other("the compositor reported an error")),
            _ => {}
        }
    }
    Err(io::Error::other("the list of interfaces is too long"))
}

/// Returns the process id of the peer of a socket; `None` if it is not visible, as in a container.
pub(super) fn peer_process(stream: &UnixStream) -> Option<i32> {
    let process = socket_peercred(stream).ok()?.pid;
    Some(process.as_raw_nonzero().get())
}

/// Returns a request with one argument.
fn message(object: u32, opcode: u16, argument: u32) -> Vec<u8> {
    const SIZE: u32 = 12;
    let head = SIZE << 16 | u32::from(opcode);
    [object, head, argument].map(u32::to_ne_bytes).concat()
}

/// Reads the next message: object id, opcode and body.
fn read_message(stream: &mut impl Read) -> io::Result<(u32, u16, Vec<u8>)> {
    let mut head = [0; 8];
    stream.read_exact(&mut head)?;
    let (object, rest) = (word(&head, 0), word(&head, 4));
    let (object, rest) = (object.unwrap_or(0), rest.unwrap_or(0));
    let size = (rest >> 16) as usize;
    let length = size
        .checked_sub(head.len())
        .ok_or_else(|| io::Error::other("not a Wayland message"))?;
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((object, rest as u16, body))
}

/// Returns the interface of a `global` event: numeric name, length with the final NUL, interface, version.
fn interface(body: &[u8]) -> Option<String> {
    let length = word(body, 4)? as usize;
    let name = body.get(8..8 + length.checked_sub(1)?)?;
    Some(String::from_utf8_lossy(name).into_owned())
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at + 4)?;
    Some(u32::from_ne_bytes(word.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use std::os::unix::net::UnixListener;
    use std::thread;

    use super::*;

    fn global(id: u32, name: &str) -> Vec<u8> {
        let mut text = name.as_bytes().to_vec();
        text.push(0);
        let length = text.len() as u32;
        text.resize(text.len().next_multiple_of(4), 0);
        let size = 8 + 4 + 4 + text.len() as u32 + 4;
        let head = [REGISTRY, size << 16, id, length].map(u32::to_ne_bytes);
        [head.concat(), text, 1u32.to_ne_bytes().to_vec()].concat()
    }

    /// Queries a compositor that answers with these bytes and closes the connection.
    fn query(bytes: Vec<u8>) -> io::Result<(Option<i32>, Vec<String>)> {
        let dir = tempfile::tempdir().unwrap();
        let socket = dir.path().join("wayland-0");
        let listener = UnixListener::bind(&socket).unwrap();
        let compositor = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut requests = [0; 24];
            stream.read_exact(&mut requests).unwrap();
            stream.write_all(&bytes).unwrap();
            requests
        });
        let result = globals(&socket);
        let requests = compositor.join().unwrap();
        let words: Vec<_> = (0..6).filter_map(|at| word(&requests, 4 * at)).collect();
        assert_eq!(words, [1, 12 << 16 | 1, 2, 1, 12 << 16, 3]);
        result
    }

    #[test]
    fn the_interfaces_and_the_process_of_a_compositor_are_returned() {
        let names = ["wl_seat", "zwp_virtual_keyboard_manager_v1"];
        let mut bytes = [global(1, names[0]), global(2, names[1])].concat();
        bytes.extend(message(CALLBACK, 0, 7));
        let (process, globals) = query(bytes).unwrap();
        assert_eq!(globals, names);
        assert_eq!(process, Some(std::process::id() as i32));
    }

    #[test]
    fn invalid_messages_are_errors() {
        let error = |bytes| query(bytes).unwrap_err().to_string();
        assert_eq!(error(vec![0; 8]), "not a Wayland message");
        assert_eq!(
            error(message(DISPLAY, 0, 1)),
            "the compositor reported an error"
        );
        let cut = global(1, "wl_seat")[..20].to_vec();
        assert_eq!(error(cut), "failed to fill whole buffer");
        let mut wrong_length = global(1, "wl_seat");
        wrong_length[12..16].copy_from_slice(&u32::MAX.to_ne_bytes());
        wrong_length.extend(message(CALLBACK, 0, 7));
        assert_eq!(query(wrong_length).unwrap().1, [""; 0]);
    }
}
