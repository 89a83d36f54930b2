//! Asks a Wayland compositor what it has. Of the protocol that takes two requests and one kind of answer:
//! <https://wayland.freedesktop.org/docs/html/ch04.html#sect-Protocol-Wire-Format>.

use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use rustix::net::sockopt::socket_peercred;

/// How long a compositor may take for a message.
const LIMIT: Duration = Duration::from_secs(1);

/// More than any compositor has to say.
const MOST_MESSAGES: usize = 4096;

/// The object that every conversation begins with.
const DISPLAY: u32 = 1;
const REGISTRY: u32 = 2;
const CALLBACK: u32 = 3;

/// The process at the other end, where it can be seen, and the names of the interfaces that it offers.
pub(super) fn globals(socket: &Path) -> io::Result<(Option<i32>, Vec<String>)> {
    let mut stream = UnixStream::connect(socket)?;
    stream.set_read_timeout(Some(LIMIT))?;
    stream.set_write_timeout(Some(LIMIT))?;
    let get_registry = message(DISPLAY, 1, REGISTRY);
    let sync = message(DISPLAY, 0, CALLBACK);
    stream.write_all(&[get_registry, sync].concat())?;
    let mut globals = Vec::new();
    for _ in 0..MOST_MESSAGES {
        match read_message(&mut stream)? {
            (REGISTRY, 0, body) => globals.extend(interface(&body)),
            (CALLBACK, ..) => return Ok((peer(&stream), globals)),
            (DISPLAY, 0, _) => return Err(io::Error::other("it refuses this program")),
            _ => {}
        }
    }
    Err(io::Error::other("it does not come to an end"))
}

/// The process at the other end of a socket; `None` where it is in another world, as in a container.
pub(super) fn peer(stream: &UnixStream) -> Option<i32> {
    let process = socket_peercred(stream).ok()?.pid;
    Some(process.as_raw_nonzero().get())
}

/// A request with one number.
fn message(object: u32, request: u16, number: u32) -> Vec<u8> {
    const SIZE: u32 = 12;
    let head = SIZE << 16 | u32::from(request);
    [object, head, number].map(u32::to_ne_bytes).concat()
}

/// Object, kind and body of the next message.
fn read_message(stream: &mut impl Read) -> io::Result<(u32, u16, Vec<u8>)> {
    let mut head = [0; 8];
    stream.read_exact(&mut head)?;
    let (object, rest) = (word(&head, 0), word(&head, 4));
    let (object, rest) = (object.unwrap_or(0), rest.unwrap_or(0));
    let size = (rest >> 16) as usize;
    let length = size
        .checked_sub(head.len())
        .ok_or_else(|| io::Error::other("it does not speak Wayland"))?;
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    Ok((object, rest as u16, body))
}

/// The name in the body of a `global`: its number, the length of the name with its end, the name, its version.
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

    fn global(number: u32, name: &str) -> Vec<u8> {
        let mut text = name.as_bytes().to_vec();
        text.push(0);
        let length = text.len() as u32;
        text.resize(text.len().next_multiple_of(4), 0);
        let size = 8 + 4 + 4 + text.len() as u32 + 4;
        let head = [REGISTRY, size << 16, number, length].map(u32::to_ne_bytes);
        [head.concat(), text, 1u32.to_ne_bytes().to_vec()].concat()
    }

    /// Somebody who answers the two requests with these bytes and hangs up.
    fn answered(bytes: Vec<u8>) -> io::Result<(Option<i32>, Vec<String>)> {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("wayland-0");
        let listener = UnixListener::bind(&socket).unwrap();
        let compositor = thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let mut requests = [0; 24];
            stream.read_exact(&mut requests).unwrap();
            stream.write_all(&bytes).unwrap();
            requests
        });
        let told = globals(&socket);
        let requests = compositor.join().unwrap();
        let words: Vec<_> = (0..6).filter_map(|at| word(&requests, 4 * at)).collect();
        assert_eq!(words, [1, 12 << 16 | 1, 2, 1, 12 << 16, 3]);
        told
    }

    #[test]
    fn a_compositor_is_asked_for_what_it_has() {
        let names = ["wl_seat", "zwp_virtual_keyboard_manager_v1"];
        let mut bytes = [global(1, names[0]), global(2, names[1])].concat();
        bytes.extend(message(CALLBACK, 0, 7));
        let (process, globals) = answered(bytes).unwrap();
        assert_eq!(globals, names);
        assert_eq!(process, Some(std::process::id() as i32));
    }

    #[test]
    fn who_speaks_otherwise_is_not_believed() {
        let refused = |bytes| answered(bytes).unwrap_err().to_string();
        assert_eq!(refused(vec![0; 8]), "it does not speak Wayland");
        assert_eq!(refused(message(DISPLAY, 0, 1)), "it refuses this program");
        let cut = global(1, "wl_seat")[..20].to_vec();
        assert_eq!(refused(cut), "failed to fill whole buffer");
        let mut odd = global(1, "wl_seat");
        odd[12..16].copy_from_slice(&u32::MAX.to_ne_bytes());
        odd.extend(message(CALLBACK, 0, 7));
        assert_eq!(answered(odd).unwrap().1, [""; 0]);
    }
}
