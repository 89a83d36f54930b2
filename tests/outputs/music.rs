//! The outputs `osc` and `midi`, received by python-osc, mido and aseqdump.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::net::UdpSocket;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::binary::ademan;
use crate::support::process::{Process, signal};
use crate::support::python::python;
use crate::support::x11::wait_for;
use ademan::capture::protocol::osc;

/// Prints the messages until `/end`.
const OSC_RECEIVER: &str = r#"
import socket
from pythonosc import dispatcher, osc_server

class Ended(Exception):
    pass

def handle(address, *arguments):
    if address == "/end":
        raise SystemExit
    print(address, *(f"{argument:.3f}" for argument in arguments), flush=True)

known = dispatcher.Dispatcher()
known.set_default_handler(handle)

class Server(osc_server.BlockingOSCUDPServer):
    def handle_error(self, request, client_address):
        raise

server = Server(("127.0.0.1", 0), known)
# On a busy machine all messages may wait at once. SO_RCVBUFFORCE needs root, SO_RCVBUF has a limit.
for option in [socket.SO_RCVBUF, 33]:
    try:
        server.socket.setsockopt(socket.SOL_SOCKET, option, 1 << 24)
    except OSError:
        pass
print(server.server_address[1], flush=True)
server.serve_forever()
"#;

/// Prints the messages of a pipe.
const MIDI_RECEIVER: &str = r"
import os, sys, time, mido

parser = mido.Parser()
pipe = os.open(sys.argv[1], os.O_RDONLY | os.O_NONBLOCK)
print('open', flush=True)
is_open = False
while True:
    try:
        piece = os.read(pipe, 4096)
    except BlockingIOError:
        is_open = True
        time.sleep(0.002)
        continue
    if not piece:
        if is_open:
            break
        time.sleep(0.002)
        continue
    is_open = True
    parser.feed(piece)
    for message in parser:
        print(message, flush=True)
";

/// Plays the script of a layout to an output and returns the transcript.
fn play(layout: &str, output: &str, folder: &Path) -> String {
    let transcript = folder.join("transcript");
    let outputs = format!("transcript:{},{output}", transcript.display());
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scripts/{layout}.txt"));
    let mut demo = ademan(["demo", "--fast", "--layout", layout, "--output", &outputs]);
    demo.arg("--script").arg(script);
    let played = demo
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let message = String::from_utf8_lossy(&played.stderr);
    assert!(played.status.success(), "{message}");
    fs::read_to_string(transcript).expect("a transcript")
}

/// Returns what python-osc receives of a layout, with the transcript; `None` if it cannot be installed.
fn received_osc(layout: &str) -> Option<(Vec<String>, String)> {
    let python = match python("osc-receiver", "pythonosc", &["python-osc==1.10.2"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package python-osc: {reason}");
            return None;
        }
    };
    let mut receiver = Command::new(python);
    receiver.args(["-c", OSC_RECEIVER]).stdout(Stdio::piped());
    let mut receiver = Process::start(&mut receiver).expect("Python starts");
    let stdout = receiver.0.stdout.take().expect("stdout is piped");
    let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
    let port = lines.next().expect("a port");
    let folder = tempfile::tempdir().expect("a folder");
    let transcript = play(layout, &format!("osc:127.0.0.1:{port}"), folder.path());
    let end = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let message = osc::encode("/end", None, &[], &[0.0]);
    end.send_to(&message, format!("127.0.0.1:{port}"))
        .expect("the message is sent");
    Some((lines.collect(), transcript))
}

/// Returns the numbers of an event in a transcript, by the name of its target.
fn numbers<'a>(transcript: &'a str, event: &str) -> Vec<(&'a str, &'a str)> {
    let lines = transcript.lines().filter_map(|line| {
        let (name, number) = line[13..].strip_prefix(event)?.trim().rsplit_once(' ')?;
        Some((name.trim_matches('\''), number))
    });
    lines.collect()
}

#[test]
fn python_osc_receives_the_notes_of_a_piano_with_velocity_depth_and_end() {
    let Some((lines, transcript)) = received_osc("piano") else {
        return;
    };
    println!("{}", lines.join("\n"));
    let notes = lines.iter().filter(|line| !line.contains("/depth"));
    let expected = numbers(&transcript, "velocity ").into_iter();
    let expected =
        expected.map(|(name, number)| format!("/piano/{} {number}", name.replace('#', "s")));
    let expected: Vec<_> = expected.collect();
    assert!(notes.eq(&expected), "{expected:#?}");
    let ends = expected.iter().filter(|line| line.ends_with(" 0.000"));
    assert_eq!((ends.count(), expected.len()), (6, 12));
    let last_depth = lines
        .iter()
        .rfind(|line| line.starts_with("/piano/G4/depth"));
    assert_eq!(
        last_depth.map(String::as_str),
        Some("/piano/G4/depth 0.000")
    );
}

#[test]
fn python_osc_receives_the_values_of_a_mixer_in_their_ranges() {
    let Some((lines, transcript)) = received_osc("mixer") else {
        return;
    };
    let values = numbers(&transcript, "value ");
    assert!(
        values.len() > 10 && values.len() == lines.len(),
        "{transcript}"
    );
    for (line, (name, value)) in lines.iter().zip(values) {
        let value: f32 = value.parse().expect("a number");
        let (control, channel) = name.split_once(' ').expect("a number of a channel");
        let number = match control {
            "Fader" => 60.0 * value - 60.0,
            "Balance" => 2.0 * value - 1.0,
            _ => value,
        };
        let (address, received) = line.split_once(' ').expect("a number");
        assert_eq!(
            address,
            format!("/mixer/{channel}/{}", control.to_lowercase())
        );
        let received: f32 = received.parse().expect("a number");
        assert!((received - number).abs() < 0.04, "{line}: {number}");
    }
}

/// A pipe that this process reads.
struct Pipe {
    folder: tempfile::TempDir,
    reader: File,
    bytes: Vec<u8>,
}

impl Pipe {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        make_pipe(folder.path());
        let mut options = File::options();
        // It has no writer yet.
        options.read(true).custom_flags(libc::O_NONBLOCK);
        let reader = options.open(folder.path().join("midi")).expect("a pipe");
        Self {
            folder,
            reader,
            bytes: Vec::new(),
        }
    }

    /// Reads the bytes that have arrived.
    fn read(&mut self) {
        let mut buffer = [0; 4096];
        while let Ok(length @ 1..) = self.reader.read(&mut buffer) {
            self.bytes.extend(&buffer[..length]);
        }
    }

    /// Starts a hand that holds C4, and waits until the output has sent the note and active sensing after it.
    fn hold_a_note(&mut self) -> Process {
        let output = format!("midi:{}", self.folder.path().join("midi").display());
        let script = "press C4; wait 30000; lift";
        let mut demo = ademan([
            "demo", "--layout", "piano", "--script", script, "--output", &output,
        ]);
        demo.stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let mut demo = Process::start(&mut demo).expect("the program starts");
        let sounds = wait_for(|| {
            let status = demo.0.try_wait().expect("a child process");
            assert_eq!(status, None, "the demo has ended: {:x?}", self.bytes);
            self.read();
            self.bytes.len() >= START.len() && self.bytes.ends_with(&[ACTIVE_SENSING])
        });
        assert!(sounds, "no note with active sensing: {:x?}", self.bytes);
        assert_eq!(self.bytes[..START.len()], START, "{:x?}", self.bytes);
        demo
    }
}

const ACTIVE_SENSING: u8 = 0xfe;

/// The first bytes: active sensing, then the start of the note C4.
const START: [u8; 3] = [ACTIVE_SENSING, 0x90, 60];

fn make_pipe(folder: &Path) {
    let made = Command::new("mkfifo").arg(folder.join("midi")).status();
    assert!(made.expect("mkfifo is installed").success());
}

#[test]
fn a_stop_while_a_note_sounds_ends_it() {
    let mut pipe = Pipe::new();
    let mut demo = pipe.hold_a_note();
    signal("TERM", demo.0.id());
    demo.0.wait().expect("it exits");
    pipe.read();
    assert!(pipe.bytes.ends_with(&[0x80, 60, 64]), "{:x?}", pipe.bytes);
}

#[test]
fn a_program_that_is_killed_stops_active_sensing_so_that_a_synthesizer_ends_its_notes() {
    let mut pipe = Pipe::new();
    let mut demo = pipe.hold_a_note();
    signal("KILL", demo.0.id());
    demo.0.wait().expect("it exits");
    pipe.read();
    let is_alive = |byte: &u8| *byte == ACTIVE_SENSING || *byte < 0x80 || *byte == 0xa0;
    assert!(
        pipe.bytes[START.len()..].iter().all(is_alive),
        "{:x?}",
        pipe.bytes
    );
}

#[test]
fn mido_reads_the_notes_of_drums_and_pianos_from_a_raw_device() {
    let python = match python("midi-receiver", "mido", &["mido==1.3.3"]) {
        Ok(python) => python,
        Err(reason) => {
            println!("SKIPPED: cannot install the package mido: {reason}");
            return;
        }
    };
    for layout in ["piano", "drum-pads"] {
        let folder = tempfile::tempdir().expect("a folder");
        make_pipe(folder.path());
        let device = folder.path().join("midi");
        let mut receiver = Command::new(&python);
        receiver
            .args(["-c", MIDI_RECEIVER])
            .arg(&device)
            .stdout(Stdio::piped());
        let mut receiver = Process::start(&mut receiver).expect("Python starts");
        let stdout = receiver.0.stdout.take().expect("stdout is piped");
        let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
        assert_eq!(lines.next().as_deref(), Some("open"));
        let transcript = play(layout, &format!("midi:{}", device.display()), folder.path());
        let lines: Vec<_> = lines.collect();
        println!("{}", lines.join("\n"));
        let notes = lines.iter().filter(|line| line.starts_with("note_o"));
        let notes: Vec<_> = notes
            .map(|line| line.trim_end_matches(" time=0"))
            .filter_map(|line| line.split_once(" velocity="))
            .collect();
        let expected = numbers(&transcript, "velocity ");
        assert_eq!(notes.len(), expected.len());
        for ((message, velocity), (name, number)) in notes.into_iter().zip(expected) {
            let (channel, note) = note(name);
            // The transcript has three decimals.
            let number = number.parse::<f32>().expect("a number") * 127.0;
            let (kind, wanted) = match number {
                0.0 => ("off", 64.0),
                _ => ("on", number),
            };
            assert_eq!(
                message,
                format!("note_{kind} channel={channel} note={note}")
            );
            let velocity: f32 = velocity.parse().expect("a number");
            assert!((velocity - wanted).abs() < 0.6, "{message} {velocity}");
        }
        let is_pressure = |line: &&String| line.starts_with("polytouch");
        let pressures = lines.iter().filter(is_pressure).count();
        assert_eq!(pressures > 10, layout == "piano", "{pressures}");
    }
}

/// Returns the channel, from 0, and the note of a key.
fn note(name: &str) -> (u8, u8) {
    match name {
        "C4" => (0, 60),
        "D4" => (0, 62),
        "E4" => (0, 64),
        "F#4" => (0, 66),
        "G4" => (0, 67),
        "F5" => (0, 77),
        "Kick" => (9, 36),
        "Snare" => (9, 38),
        "Closed hat" => (9, 42),
        "Open hat" => (9, 46),
        "Crash" => (9, 49),
        other => panic!("{other}"),
    }
}

#[cfg(feature = "midi")]
#[test]
fn aseqdump_receives_the_notes_of_a_virtual_port() {
    if !Path::new("/dev/snd/seq").exists() {
        println!("SKIPPED: this kernel has no ALSA sequencer, /dev/snd/seq");
        return;
    }
    let mut demo = ademan(["demo", "--layout", "piano", "--repeat", "--output", "midi"]);
    demo.stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let _demo = Process::start(&mut demo).expect("the program starts");
    let has_note = || {
        let mut dump = Command::new("aseqdump");
        dump.args(["-p", "Ademan"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut dump = Process::start(&mut dump).expect("aseqdump is installed");
        let stdout = dump.0.stdout.take().expect("stdout is piped");
        let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
        lines.any(|line| line.contains("Note on"))
    };
    // The port exists a moment after the start.
    assert!(wait_for(has_note), "no note arrives");
}
