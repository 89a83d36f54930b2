//! Hands through a router of zenoh: capture, a typist and viewers, each a process of its own, around a router.

use std::collections::BTreeSet;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Stdio;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use ::zenoh::{Config, Session, Wait};
use crossbeam_channel::Receiver;

use crate::ademan;
use crate::support::free_address::free_address;
use crate::support::process::{Process, signal};
use crate::support::run::line_receiver;

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Starts a router, which this process is. Returns it and its address.
fn router() -> (Session, String) {
    let address = free_address().to_string();
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
        let transcript = line_receiver(process.0.stdout.take().expect("it is piped"));
        let messages = line_receiver(process.0.stderr.take().expect("it is piped"));
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

/// A connection to a router that can be congested.
#[derive(Clone, Default)]
struct Link {
    /// The start of a congestion.
    congested_at: Arc<Mutex<Option<Instant>>>,
}

impl Link {
    /// Forwards one client to a router. Returns the address for the client.
    fn to(&self, router: &str) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("its address").to_string();
        let (router, link) = (router.to_owned(), self.clone());
        thread::spawn(move || {
            let (client, _) = listener.accept().expect("a client");
            let router = TcpStream::connect(router).expect("the router runs");
            let back = [&client, &router].map(|end| end.try_clone().expect("a descriptor"));
            thread::spawn(move || forward(client, router, Duration::default));
            let [client_end, router_end] = back;
            forward(router_end, client_end, move || link.delay());
        });
        address
    }

    /// Returns the delay: each second of a congestion adds a half, up to 3 s.
    fn delay(&self) -> Duration {
        let congested_at = *self.congested_at.lock().expect("no panic");
        let elapsed = congested_at.map_or(Duration::ZERO, |start| start.elapsed());
        (elapsed / 2).min(Duration::from_secs(3))
    }

    fn set_congested(&self, is_congested: bool) {
        *self.congested_at.lock().expect("no panic") = is_congested.then(Instant::now);
    }
}

/// Passes bytes on, each after a delay.
fn forward(mut from: TcpStream, mut to: TcpStream, delay: impl Fn() -> Duration) {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let mut buffer = vec![0; 1 << 16];
        while let Ok(count @ 1..) = from.read(&mut buffer) {
            if sender
                .send((Instant::now(), buffer[..count].to_vec()))
                .is_err()
            {
                return;
            }
        }
    });
    for (arrived_at, bytes) in receiver {
        while arrived_at.elapsed() < delay() {
            thread::sleep(Duration::from_millis(1));
        }
        if to.write_all(&bytes).is_err() {
            return;
        }
    }
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
fn a_hand_is_shared_with_all_of_many_keys() {
    let (router, address) = router();
    let keys: BTreeSet<String> = (0..6).map(|number| format!("lab/desk/{number}")).collect();
    let samples = router
        .declare_subscriber("lab/desk/*")
        .wait()
        .expect("a valid key");
    let source = format!("typist:{}", "hola ".repeat(200));
    let mut arguments = vec!["--output", "none", "--source", source.as_str()];
    let shares: Vec<String> = keys
        .iter()
        .map(|key| format!("zenoh:{key}?router={address}"))
        .collect();
    arguments.extend(shares.iter().flat_map(|share| ["--share", share.as_str()]));
    let _run = Run::start(&arguments);
    let mut shared = BTreeSet::new();
    let start = Instant::now();
    while shared != keys {
        assert!(start.elapsed() < TIMEOUT, "only {shared:?}");
        let sample = samples
            .recv_timeout(Duration::from_millis(100))
            .expect("the session is open");
        shared.extend(sample.map(|sample| sample.key_expr().to_string()));
    }
}

#[test]
fn without_a_router_the_message_says_what_to_start() {
    let run = Run::start(&["--source", "zenoh:lab/desk?router=127.0.0.1:1"]);
    Run::wait_for(&run.messages, "start `zenohd` on this machine");
}

#[test]
fn a_hand_behind_a_congested_router_types_nothing_until_its_readings_are_young_again() {
    let (_router, address) = router();
    let link = Link::default();
    let capture = capture(&format!("zenoh:lab/desk/right?router={address}"));
    Run::wait_for(&capture.messages, "sharing");
    let source = format!("zenoh:lab/desk/right?router={}", link.to(&address));
    let typist = Run::start(&["--source", &source, "--role", "both"]);
    Run::wait_for(&typist.messages, "armed");
    Run::wait_for(&typist.transcript, "down ");
    // In this time the clock of the sender is learned.
    for _ in 0..20 {
        Run::wait_for(&typist.transcript, "down ");
    }
    link.set_congested(true);
    while link.delay() < Duration::from_secs(1) {
        thread::sleep(Duration::from_millis(10));
    }
    // Events typed before are on their way.
    thread::sleep(Duration::from_millis(500));
    typist.transcript.try_iter().for_each(drop);
    thread::sleep(Duration::from_secs(2));
    let late: Vec<String> = typist.transcript.try_iter().collect();
    assert!(late.is_empty(), "{late:?}");
    Run::wait_for(&typist.messages, "arrive too late and are dropped");
    link.set_congested(false);
    Run::wait_for(&typist.messages, "armed");
    Run::wait_for(&typist.transcript, "down ");
    signal("TERM", typist.process.0.id());
    Run::wait_for(&typist.messages, "too-old");
}
