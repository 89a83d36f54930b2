//! Clients that flood a server, leave at once, or take all file descriptors.

use std::ffi::OsStr;
use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::session::control_socket::Client;
use tempfile::TempDir;

use crate::ademan;
use crate::support::process::{Process, collect_lines};
use crate::support::run::TIMEOUT;

/// Most memory of the program under a flood, in MB. Without one, it takes about 30 MB.
const MAX_MEMORY_MB: u64 = 150;

/// Longest wait on a busy machine for what must come before the 30 s after which a client is disconnected that sends no request.
const SOON: Duration = Duration::from_secs(20);

/// Frames of a client, masked with zeros: a pong, a ping, the parts of a fragmented text, and an empty text.
const FRAMES: [(&str, &[u8], &[u8]); 4] = [
    ("pongs", &[], &[0x8a, 0x80, 0, 0, 0, 0]),
    ("pings", &[], &[0x89, 0x80, 0, 0, 0, 0]),
    (
        "fragments",
        &[0x01, 0x80, 0, 0, 0, 0],
        &[0x00, 0x80, 0, 0, 0, 0],
    ),
    ("texts", &[], &[0x81, 0x80, 0, 0, 0, 0]),
];

/// A simulated hand that types and is shared, with a control socket.
struct Shared {
    program: Process,
    address: String,
    folder: TempDir,
}

impl Shared {
    /// Shares a hand that types this text. `wrapper` is a command that starts the program.
    fn start(wrapper: &[&str], text: &str, format: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let (source, target) = (format!("typist:{text}"), format!("{format}:127.0.0.1:0"));
        let program = ademan([
            "run",
            "--control",
            "c.sock",
            "--output",
            "none",
            "--source",
            &source,
            "--share",
            &target,
        ]);
        let mut command = wrapped(wrapper, &program);
        command.current_dir(folder.path()).stderr(Stdio::piped());
        let mut sharing = Process::start(&mut command).expect("the program starts");
        let stderr = sharing.0.stderr.take().expect("it is piped");
        let lines = collect_lines(stderr);
        let start = Instant::now();
        let address = loop {
            let lines = lines.lock().expect("lines");
            let shared = lines.iter().find_map(|line| line.strip_prefix("sharing "));
            if let Some((shared, _)) = shared.and_then(|line| line.split_once(": ")) {
                break shared.split_once(':').expect("a format").1.to_owned();
            }
            assert!(start.elapsed() < TIMEOUT, "{lines:?}");
            drop(lines);
            thread::sleep(Duration::from_millis(5));
        };
        Self {
            program: sharing,
            address,
            folder,
        }
    }

    fn control(&self) -> PathBuf {
        self.folder.path().join("c.sock")
    }

    fn state(&self) -> String {
        let mut client = Client::connect(&self.control()).expect("the program listens");
        client.request(r#"{"command":"state"}"#).expect("a reply")
    }

    /// Returns a value in `/proc/PID/status`, in MB.
    fn memory_mb(&self, name: &str) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.program.0.id()));
        let status = status.expect("the program runs");
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        let kilobytes = line.and_then(|line| line.split_whitespace().nth(1));
        kilobytes.expect("a size").parse::<u64>().expect("a number") / 1000
    }

    fn descriptors(&self) -> usize {
        let folder = format!("/proc/{}/fd", self.program.0.id());
        fs::read_dir(folder).expect("the program runs").count()
    }
}

/// Returns a program as the argument of another one, if there is one.
fn wrapped(wrapper: &[&str], program: &Command) -> Command {
    let wrapper = wrapper.iter().map(OsStr::new);
    let mut words = wrapper
        .chain([program.get_program()])
        .chain(program.get_args());
    let mut command = Command::new(words.next().expect("a program"));
    command
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    for (name, value) in program.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command
}

/// Connects and sends a request of HTTP for a WebSocket. Returns the connection after the answer.
fn open_socket(address: &str) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(address).ok()?;
    stream.set_read_timeout(Some(TIMEOUT)).ok()?;
    stream.set_write_timeout(Some(TIMEOUT)).ok()?;
    let request = format!(
        "GET /ws HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    );
    stream.write_all(request.as_bytes()).ok()?;
    let mut answer = Vec::new();
    while !answer.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).ok()?;
        answer.push(byte[0]);
    }
    answer.starts_with(b"HTTP/1.1 101").then_some(stream)
}

/// Returns a text as a masked frame.
fn text_frame(text: &str) -> Vec<u8> {
    let length = u8::try_from(text.len()).expect("a short text");
    assert!(length < 126);
    [&[0x81, 0x80 | length, 0, 0, 0, 0], text.as_bytes()].concat()
}

/// Waits for bytes that the server sends.
fn read_some(stream: &mut TcpStream, count: usize) {
    let mut bytes = vec![0; count];
    stream.read_exact(&mut bytes).expect("the client is served");
}

/// Sends the same bytes until the client is disconnected. Returns `true` if it was.
fn flood(stream: &mut TcpStream, start: &[u8], bytes: &[u8]) -> bool {
    let many = bytes.repeat(10_000);
    let begin = Instant::now();
    let mut written = stream.write_all(start);
    while written.is_ok() && begin.elapsed() < SOON {
        written = stream.write_all(&many);
    }
    // A write that times out is one that the server does not read.
    let is_disconnected = |error: std::io::Error| {
        !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
    };
    written.is_err_and(is_disconnected)
}

#[test]
fn a_client_that_floods_frames_is_disconnected_and_the_others_are_served() {
    for (name, start, frame) in FRAMES {
        let shared = Shared::start(&[], &"hola ".repeat(100), "ws");
        let mut reader = open_socket(&shared.address).expect("a WebSocket");
        reader
            .write_all(&text_frame(r#"{"kinds":["pose"]}"#))
            .expect("it reads");
        read_some(&mut reader, 1000);
        let mut client = open_socket(&shared.address).expect("a WebSocket");
        let is_disconnected = flood(&mut client, start, frame);
        let memory_mb = shared.memory_mb("VmHWM");
        println!("{name}: {memory_mb} MB");
        assert!(is_disconnected, "{name}");
        assert!(memory_mb < MAX_MEMORY_MB, "{name}: {memory_mb} MB");
        // More than the buffers of the connection hold.
        for _ in 0..30 {
            read_some(&mut reader, 10_000);
        }
    }
}

#[test]
fn a_run_under_floods_ends_by_the_command_stop_and_with_its_source() {
    for (text, is_stopped) in [("hola ".repeat(100), true), ("hola".into(), false)] {
        let mut shared = Shared::start(&[], &text, "web");
        let is_over = Arc::new(AtomicBool::new(false));
        let floods: Vec<_> = FRAMES
            .into_iter()
            .map(|(_, start, frame)| {
                let (address, is_over) = (shared.address.clone(), Arc::clone(&is_over));
                thread::spawn(move || {
                    let many = frame.repeat(1000);
                    while !is_over.load(Ordering::Relaxed) {
                        let Some(mut stream) = open_socket(&address) else {
                            continue;
                        };
                        let _ = stream.write_all(start);
                        while !is_over.load(Ordering::Relaxed) && stream.write_all(&many).is_ok() {}
                    }
                })
            })
            .collect();
        if is_stopped {
            thread::sleep(Duration::from_millis(500));
            let mut client = Client::connect(&shared.control()).expect("the program listens");
            let reply = client.request(r#"{"command":"stop"}"#).expect("a reply");
            assert!(reply.contains("true"), "{reply}");
        }
        let status = shared.program.wait_for_exit();
        is_over.store(true, Ordering::Relaxed);
        for flood in floods {
            flood.join().expect("it ends");
        }
        assert!(status.success(), "{status}");
    }
}

#[test]
fn an_unsolicited_pong_does_not_disconnect_a_client() {
    let shared = Shared::start(&[], &"hola ".repeat(100), "ws");
    let mut client = open_socket(&shared.address).expect("a WebSocket");
    client.write_all(FRAMES[0].2).expect("it reads");
    thread::sleep(Duration::from_millis(100));
    client
        .write_all(&text_frame(r#"{"kinds":["pose"]}"#))
        .expect("it reads");
    read_some(&mut client, 1000);
}

#[test]
fn connections_that_close_at_once_leave_their_places_and_descriptors() {
    for format in ["json", "text-line", "ws"] {
        let shared = Shared::start(&[], &"hola ".repeat(100), format);
        let before = shared.descriptors();
        for _ in 0..300 {
            let _ = TcpStream::connect(&shared.address).expect("it listens");
        }
        let start = Instant::now();
        while shared.descriptors() > before + 2 {
            assert!(start.elapsed() < SOON, "{format}: {}", shared.descriptors());
            thread::sleep(Duration::from_millis(5));
        }
        if format == "ws" {
            assert!(open_socket(&shared.address).is_some());
            continue;
        }
        let mut client = TcpStream::connect(&shared.address).expect("it listens");
        client.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        if format == "json" {
            client
                .write_all(b"{\"kinds\":[\"pose\"]}\n")
                .expect("it reads");
        }
        let mut line = String::new();
        BufReader::new(client).read_line(&mut line).expect("a line");
        assert!(!line.is_empty(), "{format}");
    }
}

/// With 64 descriptors, clients of the hand leave some to the control socket. With 20, all are taken.
#[test]
fn a_command_gets_through_while_clients_take_all_descriptors() {
    for limit in ["--nofile=64:64", "--nofile=20:20"] {
        let wrapper = ["prlimit", limit];
        if let Err(error) = Command::new(wrapper[0]).arg("--version").output() {
            println!("SKIPPED: cannot set the limit of descriptors: {error}");
            return;
        }
        let shared = Shared::start(&wrapper, &"hola ".repeat(100), "json");
        println!("{} descriptors without clients", shared.descriptors());
        let clients: Vec<_> = (0..100)
            .map(|_| {
                let mut client = TcpStream::connect(&shared.address).expect("it listens");
                let _ = client.write_all(b"{\"kinds\":[\"pose\"]}\n");
                client
            })
            .collect();
        thread::sleep(Duration::from_millis(500));
        println!("{} descriptors with clients", shared.descriptors());
        assert!(shared.state().contains("\"ok\":true"), "{limit}");
        // Clients of the control socket that hold their connections open.
        let idle: Vec<_> = (0..40)
            .filter_map(|_| Client::connect(&shared.control()).ok())
            .collect();
        println!("{} descriptors at the end", shared.descriptors());
        assert!(shared.state().contains("\"ok\":true"), "{limit}");
        let mut client = Client::connect(&shared.control()).expect("the program listens");
        let reply = client.request(r#"{"command":"pause"}"#).expect("a reply");
        assert!(reply.contains("true"), "{limit}: {reply}");
        drop((clients, idle));
    }
}
