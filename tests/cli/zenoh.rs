//! Hands through a router of zenoh: capture, a typist and viewers, each a process of its own, around a router.

use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::process::Stdio;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use ::zenoh::{Config, Session, Wait};

use crate::ademan;
use crate::support::process::{Process, signal};

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Starts a router, which this process is. Returns it and its address.
fn router() -> (Session, String) {
    let port = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = port.local_addr().expect("its address").to_string();
    drop(port);
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"router\""),
        ("listen/endpoints", &format!("[\"tcp/{address}\"]")),
        ("scouting/multicast/enabled", "false"),
    ] {
        config.insert_json5(key, value).expect("a setting of zenoh");
    }
    (
        ::zenoh::open(config).wait().expect("the port is free"),
        address,
    )
}

/// A run, with the lines of its transcript and of its messages.
struct Run {
    process: Process,
    transcript: Receiver<String>,
    messages: Receiver<String>,
}

impl Run {
    fn start(arguments: &[&str]) -> Self {
        let mut command = ademan(["run", "--control", "off"]);
        command
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command).expect("the program starts");
        let transcript = receiver(process.0.stdout.take().expect("it is piped"));
        let messages = receiver(process.0.stderr.take().expect("it is piped"));
        Self {
            process,
            transcript,
            messages,
        }
    }

    fn wait_for(lines: &Receiver<String>, part: &str) {
        let next = || {
            lines
                .recv_timeout(TIMEOUT)
                .unwrap_or_else(|_| panic!("no line with {part:?}"))
        };
        while !next().contains(part) {}
    }
}

fn receiver(stream: impl Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            let _ = sender.send(line);
        }
    });
    receiver
}

/// A hand that types for minutes and shares.
fn capture(share: &str) -> Run {
    let source = format!("typist:{}", "hola ".repeat(200));
    Run::start(&["--output", "none", "--source", &source, "--share", share])
}

#[test]
fn a_typist_and_viewers_follow_a_hand_that_is_killed_and_comes_back() {
    let (_router, address) = router();
    let share = format!("zenoh:lab/desk/right?router={address}");
    let source = format!("zenoh:lab/desk/right?router={address}");
    let first = capture(&share);
    Run::wait_for(&first.messages, "sharing text-line+zenoh:lab/desk/right");
    let arguments = ["--output", "transcript", "--source", &source];
    let typist = Run::start(&[&arguments[..], &["--role", "both"]].concat());
    let viewers = [(); 2].map(|()| Run::start(&arguments));
    Run::wait_for(&typist.messages, "armed");
    Run::wait_for(&typist.transcript, "down ");
    signal("KILL", first.process.0.id());
    Run::wait_for(&typist.messages, "stalled");
    let second = capture(&share);
    Run::wait_for(&typist.messages, "armed");
    Run::wait_for(&typist.transcript, "down ");
    signal("TERM", typist.process.0.id());
    let events: Vec<String> = typist.transcript.iter().collect();
    let count = |word: &str| events.iter().filter(|line| line.contains(word)).count();
    assert!(count("up ") >= count("down "), "{events:?}");
    for viewer in &viewers {
        Run::wait_for(&viewer.messages, "armed");
        let keys = viewer
            .transcript
            .try_iter()
            .filter(|line| line.contains("down "));
        assert_eq!(keys.count(), 0, "a source on the network only points");
    }
    drop((second, viewers));
}

#[test]
fn without_a_router_the_message_says_what_to_start() {
    let run = Run::start(&["--source", "zenoh:lab/desk?router=127.0.0.1:1"]);
    Run::wait_for(&run.messages, "start `zenohd` on this machine");
}
