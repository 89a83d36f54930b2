//! `ademan run` on a layout file of its own, and somebody who wears the glove.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, encode};
use ademan::capture::{Hc11Format, Reading, Sample, hc11};
use ademan::contact::Phase;
use ademan::device::Events;
use ademan::layout::Layout;
use ademan::setup::Setup;
use ademan::time::Timestamp;
use crossbeam_channel::{Receiver, unbounded};
use tempfile::TempDir;

use super::binary::ademan;
use super::process::Process;

/// How long anything on a busy machine may take before the test gives up.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// How long the hand takes to be seen in another posture.
pub const MOVE: Duration = Duration::from_millis(500);

type Posture = [u8; BODY_BYTES];

/// The glove with the index finger over the H key, and with the key pushed in.
pub fn postures() -> (Posture, Posture) {
    let assembly = Setup::default().load_files().expect("the default setup");
    let typist = assembly.typist("h", &Hc11Format::default(), 0.0, 0);
    let mut typist = typist.expect("h can be typed");
    let mut pipeline = assembly.pipeline();
    let mut over = None;
    for frame in 1.. {
        let counts = typist.next_counts().expect("the key goes down");
        let posture = std::array::from_fn(|channel| counts[channel] as u8);
        over.get_or_insert(posture);
        let reading = Reading {
            time: Timestamp(5_729 * frame),
            side: None,
            sample: Sample::Channels(hc11::channels(&posture)),
        };
        let frame = pipeline.step(&reading, &mut Events::new());
        let touches = &frame.expect("an able hand").touches;
        if touches
            .iter()
            .any(|touch| touch.phase == Phase::Moved && touch.depth == 1.0)
        {
            return (over.expect("it began over the key"), posture);
        }
    }
    unreachable!("the loop has no end of its own");
}

/// `ademan run` with a layout file of its own, and somebody who wears the glove.
pub struct Run {
    pub program: Process,
    posture: Arc<Mutex<Posture>>,
    over: Posture,
    down: Posture,
    pub typed: Receiver<String>,
    pub told: Receiver<String>,
    pub folder: TempDir,
}

/// What a run that is ready says.
pub const ARMED: &str = "armed: touches are typed, Ctrl-C ends";

impl Run {
    /// On the layout `qwerty-flat`, with the key H held.
    pub fn with_held_key(arguments: &[&str]) -> Self {
        // A machine that holds the hand up for a moment shall not end the press.
        let run = Self::of("role: Both, stall_timeout_ms: 10000", arguments);
        run.wait_until_told(ARMED);
        run.push_down();
        assert_eq!(run.typed(), "down H");
        run
    }

    /// On the layout `qwerty-flat`, with these fields of a setup and the index finger over the key H. The source
    /// is one on the network.
    pub fn of(fields: &str, arguments: &[&str]) -> Self {
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
            .env_remove("XDG_RUNTIME_DIR")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut program = Process::start(&mut command).expect("it starts");
        let (over, down) = postures();
        let posture = Arc::new(Mutex::new(over));
        let worn = posture.clone();
        thread::spawn(move || wear(&listener, &worn));
        let typed = lines(program.0.stdout.take().expect("it is piped"));
        let told = lines(program.0.stderr.take().expect("it is piped"));
        Self {
            program,
            posture,
            over,
            down,
            typed,
            told,
            folder,
        }
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().join("my.ron")
    }

    pub fn save(&self, text: &str) -> Instant {
        std::fs::write(self.path(), text).expect("the file can be written");
        Instant::now()
    }

    pub fn push_down(&self) {
        *self.posture.lock().expect("nobody panics with it") = self.down;
    }

    pub fn lift(&self) {
        *self.posture.lock().expect("nobody panics with it") = self.over;
    }

    /// The next event, without its time.
    pub fn typed(&self) -> String {
        next_event(&self.typed)
    }

    pub fn told(&self) -> String {
        let line = self.told.recv_timeout(PATIENCE);
        line.expect("something is told")
    }

    pub fn wait_until_told(&self, line: &str) {
        while self.told() != line {}
    }
}

/// Sends the posture at the pace of the line until nobody listens.
fn wear(listener: &TcpListener, posture: &Mutex<Posture>) {
    let (mut line, _) = listener.accept().expect("the program connects");
    loop {
        let packet = encode(Framing::Double06, &posture.lock().expect("no panic"));
        if line.write_all(&packet).is_err() {
            return;
        }
        thread::sleep(Hc11Format::default().packet_period());
    }
}

/// The next event of a transcript, without its time.
pub fn next_event(transcript: &Receiver<String>) -> String {
    let line = transcript.recv_timeout(PATIENCE);
    let line = line.expect("something is typed");
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    words.join(" ")
}

/// The lines of a stream, as they come.
pub fn lines(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, lines) = unbounded();
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    lines
}

/// The text of a layout that comes with the program.
pub fn shipped(name: &str) -> String {
    Layout::load(name).expect("a shipped layout").text
}
