//! `ademan run` with a layout file of its own and a simulated glove on the network.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::Hc11Format;
use ademan::capture::hc11::{Framing, encode};
use ademan::contact::Phase;
use ademan::device::Events;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, unbounded};
use tempfile::TempDir;

use super::binary::ademan;
use super::press::{Posture, reading};
use super::process::Process;

/// The time after which a test gives up. Nothing takes as long, even on a busy machine.
pub const TIMEOUT: Duration = Duration::from_secs(60);

/// The time for the filters to follow a change of posture.
pub const MOVE_TIME: Duration = Duration::from_millis(500);

/// Returns two postures of the glove: the index finger over the H key, and on the pressed key.
pub fn postures() -> (Posture, Posture) {
    let loaded = Setup::default().load_files().expect("the default setup");
    let typist = loaded.typist("h", &Hc11Format::default(), 0.0, 0);
    let mut typist = typist.expect("h can be typed");
    let mut pipeline = loaded.pipeline();
    let mut over = None;
    for number in 1.. {
        let counts = typist.next_counts().expect("the hand presses the key");
        let posture = std::array::from_fn(|channel| counts[channel] as u8);
        over.get_or_insert(posture);
        let reading = reading(Timestamp(5_729 * number), &posture);
        let step = pipeline.step(&reading, &mut Events::new());
        let touches = &step.expect("an accepted reading").touches;
        if touches
            .iter()
            .any(|touch| touch.phase == Phase::Moved && touch.depth == 1.0)
        {
            return (over.expect("a first posture"), posture);
        }
    }
    unreachable!("the loop does not end");
}

/// A running program with a layout file of its own, and a glove that sends to it.
pub struct Run {
    pub program: Process,
    posture: Arc<Mutex<Posture>>,
    over: Posture,
    down: Posture,
    /// The lines of the transcript, on standard output.
    pub events: Receiver<String>,
    /// The lines on standard error.
    pub messages: Receiver<String>,
    pub folder: TempDir,
}

/// The message of a session that is armed and writes a transcript.
pub const ARMED: &str = "armed: nothing is typed into other programs, Ctrl-C ends";

impl Run {
    /// Starts the program with the layout `qwerty-flat`, and holds the key H.
    pub fn with_held_key(arguments: &[&str]) -> Self {
        // A busy machine that delays packets must not end the press.
        let run = Self::with_setup("role: Both, stall_timeout_ms: 10000", arguments);
        run.wait_for_message(ARMED);
        run.press();
        assert_eq!(run.next_event(), "down H");
        run
    }

    /// Starts the program with the layout `qwerty-flat` and these fields of a setup; the index finger is over the key H.
    pub fn with_setup(fields: &str, arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("my.ron"), shipped("qwerty-flat")).expect("a file");
        let setup = format!("Setup(layout: \"my.ron\", {fields})");
        std::fs::write(folder.path().join("setup.ron"), setup).expect("a file");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let source = format!("tcp:{}", listener.local_addr().expect("an address"));
        let mut command = ademan(["run", "setup.ron", "--source", &source]);
        command
            .args(arguments)
            .current_dir(folder.path())
            .env_remove("XDG_RUNTIME_DIR");
        let (program, events, messages) = start_with_lines(&mut command);
        let (over, down) = postures();
        let posture = Arc::new(Mutex::new(over));
        let sent = posture.clone();
        thread::spawn(move || send(&listener, &sent));
        Self {
            program,
            posture,
            over,
            down,
            events,
            messages,
            folder,
        }
    }

    /// Returns the path of the layout file.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join("my.ron")
    }

    /// Writes the layout file.
    pub fn save(&self, text: &str) -> Instant {
        std::fs::write(self.path(), text).expect("the file can be written");
        Instant::now()
    }

    /// Presses the key H.
    pub fn press(&self) {
        // A person needs longer than the debounce time of the keys to press again.
        std::thread::sleep(Duration::from_millis(60));
        *self.posture.lock().expect("no panic while it is locked") = self.down;
    }

    /// Lifts the finger off the key H.
    pub fn lift(&self) {
        *self.posture.lock().expect("no panic while it is locked") = self.over;
    }

    /// Takes another posture.
    pub fn take(&self, posture: Posture) {
        *self.posture.lock().expect("no panic while it is locked") = posture;
    }

    /// Waits for the next event, and returns it without its time.
    pub fn next_event(&self) -> String {
        next_event(&self.events)
    }

    /// Waits for the next message that is not about a busy machine, on which readings wait longer than they count.
    pub fn next_message(&self) -> String {
        loop {
            let line = self.messages.recv_timeout(TIMEOUT).expect("a message");
            if !line.contains("this machine is too busy") {
                return line;
            }
        }
    }

    /// Waits for a message.
    pub fn wait_for_message(&self, line: &str) {
        while self.next_message() != line {}
    }
}

/// Waits for the next client of a listener.
pub fn accept(listener: &TcpListener) -> TcpStream {
    let start = Instant::now();
    listener.set_nonblocking(true).expect("a socket");
    loop {
        match listener.accept() {
            Ok((client, _)) => {
                // Some systems let it inherit the mode of its listener.
                client.set_nonblocking(false).expect("a socket");
                return client;
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                assert!(start.elapsed() < TIMEOUT, "no client connects");
                thread::sleep(Duration::from_millis(1));
            }
            Err(error) => panic!("no client connects: {error}"),
        }
    }
}

/// Sends the posture at the pace of the line until the connection ends.
fn send(listener: &TcpListener, posture: &Mutex<Posture>) {
    let mut line = accept(listener);
    loop {
        let packet = encode(Framing::Double06, &posture.lock().expect("no panic"));
        if line.write_all(&packet).is_err() {
            return;
        }
        thread::sleep(Hc11Format::default().packet_period());
    }
}

/// Waits for the next event of a transcript, and returns it without its time.
pub fn next_event(transcript: &Receiver<String>) -> String {
    let line = transcript.recv_timeout(TIMEOUT);
    without_time(&line.expect("an event"))
}

/// Returns a line of a transcript without its time.
pub fn without_time(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    words.join(" ")
}

/// Starts a program. Returns it with the lines of its standard output and of its standard error.
pub fn start_with_lines(command: &mut Command) -> (Process, Receiver<String>, Receiver<String>) {
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut program = Process::start(command).expect("the program starts");
    let lines = line_receiver(program.0.stdout.take().expect("it is piped"));
    let messages = line_receiver(program.0.stderr.take().expect("it is piped"));
    (program, lines, messages)
}

/// Reads the lines of a stream in a thread of its own.
pub fn line_receiver(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, lines) = unbounded();
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    lines
}

/// Returns the text of a shipped layout.
pub fn shipped(name: &str) -> String {
    Layout::load(name).expect("a shipped layout").text
}
