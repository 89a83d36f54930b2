//! The focus of sway, through its IPC socket (`man sway-ipc`).

use std::ffi::OsStr;
use std::io::{ErrorKind, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use serde_json::Value;

use super::Desktop;
use ademan_core::message::escape_path;

/// The start of each message; the length of the text and the type follow, 32 bits each in the order of the machine.
const MAGIC: &[u8] = b"i3-ipc";
const HEADER: usize = MAGIC.len() + 8;

/// The longest text: the tree of some thousand windows.
const MAX_TEXT: usize = 16 << 20;

/// The longest wait for the replies at the start.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Bytes of one read.
const CHUNK: usize = 4096;

const CLOSED: &str = "sway has closed its connection";

/// Types of messages.
const SUBSCRIBE: u32 = 2;
const GET_TREE: u32 = 4;
const WINDOW_EVENT: u32 = 0x8000_0003;

pub struct Sway {
    socket: UnixStream,
    received: Vec<u8>,
}

impl Sway {
    /// Connects to the socket at this path, and asks for the focus, at first and after each change.
    pub fn connect(path: &OsStr) -> Result<Self, String> {
        let unreachable = |error| {
            let path = escape_path(Path::new(path));
            format!("sway does not answer at {path} (SWAYSOCK): {error}")
        };
        let mut socket = UnixStream::connect(path).map_err(unreachable)?;
        socket
            .set_read_timeout(Some(TIMEOUT))
            .map_err(unreachable)?;
        let mut received = Vec::new();
        for (kind, text) in [(SUBSCRIBE, r#"["window"]"#), (GET_TREE, "")] {
            socket
                .write_all(&request(kind, text))
                .map_err(unreachable)?;
            while messages(&received)? < 1 + usize::from(kind == GET_TREE) {
                let mut bytes = [0; CHUNK];
                match socket.read(&mut bytes).map_err(unreachable)? {
                    0 => return Err(CLOSED.into()),
                    count => received.extend_from_slice(&bytes[..count]),
                }
            }
        }
        socket.set_nonblocking(true).map_err(unreachable)?;
        Ok(Self { socket, received })
    }

    /// Appends the bytes that have arrived.
    fn receive(&mut self) -> Result<(), String> {
        let mut bytes = [0; CHUNK];
        loop {
            match self.socket.read(&mut bytes) {
                Ok(0) => return Err(CLOSED.into()),
                Ok(count) => self.received.extend_from_slice(&bytes[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(format!("the connection to sway failed: {error}")),
            }
        }
    }
}

impl Desktop for Sway {
    fn name(&self) -> &'static str {
        "sway"
    }

    fn socket(&self) -> BorrowedFd<'_> {
        self.socket.as_fd()
    }

    fn read(&mut self) -> Result<Option<Vec<String>>, String> {
        self.receive()?;
        let mut names = None;
        let mut rest = &self.received[..];
        while let Some((kind, text, after)) = first_message(rest)? {
            rest = after;
            names = focused(kind, text)?.or(names);
        }
        let left = rest.len();
        self.received.drain(..self.received.len() - left);
        Ok(names)
    }
}

fn request(kind: u32, text: &str) -> Vec<u8> {
    let length = (text.len() as u32).to_ne_bytes();
    [MAGIC, &length, &kind.to_ne_bytes(), text.as_bytes()].concat()
}

/// Returns the number of complete messages.
fn messages(bytes: &[u8]) -> Result<usize, String> {
    let (mut rest, mut count) = (bytes, 0);
    while let Some((_, _, after)) = first_message(rest)? {
        (rest, count) = (after, count + 1);
    }
    Ok(count)
}

/// The type of a message, its text, and the bytes after it.
type Message<'a> = (u32, &'a [u8], &'a [u8]);

/// Splits the first message off. `None` if it is incomplete.
fn first_message(bytes: &[u8]) -> Result<Option<Message<'_>>, String> {
    let Some((header, rest)) = bytes.split_at_checked(HEADER) else {
        return Ok(None);
    };
    let number = |at: usize| {
        let word = header[at..at + 4].try_into();
        u32::from_ne_bytes(word.expect("four bytes"))
    };
    let length = number(MAGIC.len()) as usize;
    if !header.starts_with(MAGIC) || length > MAX_TEXT {
        return Err("the socket in SWAYSOCK does not speak the protocol of sway".into());
    }
    let message = rest.split_at_checked(length);
    Ok(message.map(|(text, after)| (number(MAGIC.len() + 4), text, after)))
}

/// Returns the names of the application that a message says has the focus, if it is about one.
fn focused(kind: u32, text: &[u8]) -> Result<Option<Vec<String>>, String> {
    if !matches!(kind, SUBSCRIBE | GET_TREE | WINDOW_EVENT) {
        return Ok(None);
    }
    let message: Value = serde_json::from_slice(text)
        .map_err(|_| "sway has sent a message that is not JSON".to_owned())?;
    match kind {
        SUBSCRIBE if message["success"] != true => Err("sway refuses to report the focus".into()),
        GET_TREE => Ok(focused_node(&message).and_then(names)),
        WINDOW_EVENT if message["change"] == "focus" => Ok(names(&message["container"])),
        _ => Ok(None),
    }
}

/// Returns the node with the focus in a tree.
fn focused_node(node: &Value) -> Option<&Value> {
    if node["focused"] == true {
        return Some(node);
    }
    let children = |name: &str| node[name].as_array().into_iter().flatten();
    let mut children = children("nodes").chain(children("floating_nodes"));
    children.find_map(focused_node)
}

/// Returns the names of a window: `app_id`, or class and instance of one on XWayland. `None` for a node that is not a window.
fn names(node: &Value) -> Option<Vec<String>> {
    let properties = &node["window_properties"];
    let names = [
        &node["app_id"],
        &properties["class"],
        &properties["instance"],
    ];
    let names = names.into_iter().filter_map(Value::as_str);
    let names: Vec<_> = names.map(str::to_owned).collect();
    (node["pid"].is_u64() || !names.is_empty()).then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages of sway 1.7, shortened.
    const TREE: &str = r#"{"type":"root","focused":false,"nodes":[{"type":"output","focused":false,"nodes":[{"type":"workspace",
        "focused":false,"nodes":[{"type":"con","app_id":"foot","pid":7,"focused":false,"nodes":[]}],"floating_nodes":[{"type":
        "floating_con","app_id":null,"pid":8,"focused":true,"nodes":[],"window_properties":{"class":"XTerm","instance":"xterm"}}]}]}]}"#;
    const FOCUS: &str =
        r#"{"change":"focus","container":{"app_id":"foot","pid":7,"focused":true}}"#;
    const TITLE: &str =
        r#"{"change":"title","container":{"app_id":"gimp","pid":9,"focused":true}}"#;

    fn read(bytes: &[u8]) -> Vec<Option<Vec<String>>> {
        let mut rest = bytes;
        let mut all = Vec::new();
        while let Some((kind, text, after)) = first_message(rest).unwrap() {
            all.push(focused(kind, text).unwrap());
            rest = after;
        }
        all
    }

    #[test]
    fn the_focus_is_that_of_the_tree_and_then_of_each_event_about_it() {
        let messages = [
            request(SUBSCRIBE, r#"{"success": true}"#),
            request(GET_TREE, TREE),
            request(WINDOW_EVENT, FOCUS),
            request(WINDOW_EVENT, TITLE),
        ];
        let names = |names: &[&str]| Some(names.iter().map(ToString::to_string).collect());
        let all = messages.concat();
        let expected = [None, names(&["XTerm", "xterm"]), names(&["foot"]), None];
        assert_eq!(read(&all), expected);
        assert_eq!(read(&all[..all.len() - 1]), expected[..3], "cut");
    }

    #[test]
    fn what_is_no_message_of_sway_is_refused() {
        assert!(first_message(b"HTTP/1.1 400 Bad Request").is_err());
        let endless = [MAGIC, &[0xff; 8]].concat();
        assert!(first_message(&endless).is_err());
        assert!(focused(GET_TREE, b"{").is_err());
        assert!(focused(SUBSCRIBE, br#"{"success": false}"#).is_err());
    }
}
