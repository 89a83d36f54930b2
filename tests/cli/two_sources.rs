//! One hand from two sources of the program: the fingers from one, the arm from another.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use crate::support::run::accept;
use crate::support::source::{TYPING_RATE_HZ, text_lines};
use crate::text_line::pressed_keys;
use crate::{ademan, file, run};

/// The indices of a text line that hold angles of the arm: the wrist, the forearm and the elbow.
const ARM_INDICES: [usize; 4] = [4, 17, 25, 41];

/// Returns a line with only the angles of the arm, or only the angles of the fingers; the others are 0.
fn part_of(line: &str, is_arm: bool) -> String {
    let values = line.split_ascii_whitespace().enumerate();
    let values = values.map(|(index, value)| {
        if ARM_INDICES.contains(&index) == is_arm {
            value
        } else {
            "0"
        }
    });
    values.collect::<Vec<_>>().join(" ") + "\n"
}

struct Server {
    listener: TcpListener,
    peer: Option<TcpStream>,
}

impl Server {
    fn start() -> Self {
        Self {
            listener: TcpListener::bind("127.0.0.1:0").expect("a free port"),
            peer: None,
        }
    }

    fn uri(&self, delay_ms: u64) -> String {
        let port = self.listener.local_addr().expect("it is bound").port();
        format!("tcp:127.0.0.1:{port}?protocol=text-line&delay_ms={delay_ms}")
    }

    fn accept(&mut self) {
        let peer = accept(&self.listener);
        peer.set_nodelay(true).expect("a TCP socket");
        self.peer = Some(peer);
    }

    fn send(&mut self, line: &str) {
        let peer = self.peer.as_mut().expect("it is connected");
        peer.write_all(line.as_bytes()).expect("it is read");
    }
}

/// The presses of "Hola".
const TYPED: [&str; 5] = ["ShiftLeft", "H", "O", "L", "A"];

/// The message about fingers whose arm is lost.
const NOT_TRACKED: &str =
    "the right hand is not tracked: what it held is released, and it touches nothing\n";

/// Number of attempts on a busy machine.
const ATTEMPTS: usize = 5;

/// A recording of fingers and of an arm that is late and is lost at the end.
struct Recorded {
    messages: String,
    transcript: String,
    /// The message about the source of the arm.
    lost: String,
    /// A busy machine has delayed lines.
    is_delayed: bool,
}

impl Recorded {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let recording = folder.path().join("hand.mcap");
        let (mut fingers, mut arm) = (Server::start(), Server::start());
        let program = ademan(["record"])
            .arg(&recording)
            .args(["--source", &fingers.uri(0), "--role", "both"])
            .args(["--arm-source", &arm.uri(150), "--arm-role", "both"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        fingers.accept();
        arm.accept();
        let is_late = send_hand(&mut fingers, &mut arm);
        crate::support::process::signal("INT", program.id());
        let output = program.wait_with_output().expect("the program ends");
        let messages = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{messages}");
        let replayed = ademan(["replay"])
            .arg(&recording)
            .output()
            .expect("the program starts");
        Self {
            is_delayed: is_late || messages.contains("stalled:"),
            messages,
            transcript: String::from_utf8(replayed.stdout).unwrap(),
            lost: format!("lost {}", arm.uri(150)),
        }
    }

    fn is_complete(&self) -> bool {
        pressed_keys(&self.transcript) == TYPED
            && self.messages.contains(&self.lost)
            && self.messages.contains(NOT_TRACKED)
    }
}

/// Sends a hand that types, and ends the arm. Returns `true` if a line was sent late.
fn send_hand(fingers: &mut Server, arm: &mut Server) -> bool {
    let lines = text_lines("Hola");
    let period = Duration::from_secs_f64(1.0 / TYPING_RATE_HZ);
    let delay = (0.15 * TYPING_RATE_HZ) as usize;
    let start = Instant::now();
    let mut is_late = false;
    for index in 0..lines.len() + delay {
        let planned = period * index as u32;
        thread::sleep(planned.saturating_sub(start.elapsed()));
        is_late |= start.elapsed() > planned + Duration::from_millis(50);
        if let Some(line) = lines.get(index) {
            fingers.send(&part_of(line, false));
        }
        if let Some(line) = index.checked_sub(delay).and_then(|index| lines.get(index)) {
            arm.send(&part_of(line, true));
        }
    }
    // Without the camera the fingers are nowhere; its server still listens.
    arm.peer = None;
    for _ in 0..60 {
        thread::sleep(period);
        fingers.send(&part_of(&lines[0], false));
    }
    is_late
}

#[test]
fn fingers_and_an_arm_that_is_late_type_together_until_the_arm_is_lost() {
    let mut recorded = Recorded::new();
    for _ in 1..ATTEMPTS {
        if recorded.is_complete() || !recorded.is_delayed {
            break;
        }
        println!("delayed: {}", recorded.messages);
        recorded = Recorded::new();
    }
    let messages = &recorded.messages;
    assert!(messages.contains(&recorded.lost), "{messages}");
    assert!(messages.contains(NOT_TRACKED), "{messages}");
    let typed = pressed_keys(&recorded.transcript);
    assert_eq!(typed, TYPED, "{messages}");
}

#[test]
fn the_delay_of_the_arm_is_measured_and_the_option_for_it_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let lines = text_lines("Hola amigos");
    let still = vec![part_of(&lines[0], true); (0.12 * TYPING_RATE_HZ) as usize];
    let moved = lines.iter().map(|line| part_of(line, true));
    let arm: Vec<_> = still.into_iter().chain(moved).collect();
    let uri = |name, content: Vec<String>| {
        let path = file(&folder, name, content.concat());
        format!("file:{path}?protocol=text-line&rate_hz=174.5")
    };
    let (fingers, arm) = (uri("fingers.txt", lines), uri("arm.txt", arm));
    let measured = run(["delay", "--source", &fingers, "--arm-source", &arm]).done();
    let late = "arm.txt?protocol=text-line&rate_hz=174.5";
    measured.printed(&format!("{late} is 11"));
    measured.printed("add `delay_ms=11");

    let swapped = run(["delay", "--source", &arm, "--arm-source", &fingers]).done();
    swapped.printed(&format!("{late} is 11"));

    let empty = uri("empty.txt", vec!["no angles\n".to_owned()]);
    let unseen = run(["delay", "--source", &fingers, "--arm-source", &empty]).exited(1);
    unseen.reported("empty.txt?protocol=text-line&rate_hz=174.5 has shown no hand");

    let one = run(["delay", "--source", &fingers]).exited(2);
    one.reported("name them with --source and --arm-source");
}
