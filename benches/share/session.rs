//! The session with its servers.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::{CaptureError, Hc11Format, Reading, Sample, Source, SourceEvent, hc11};
use ademan::command::Command as SessionCommand;
use ademan::device::OutputEvent;
use ademan::output::{OutputError, Sink};
use ademan::session::{Notice, Session, SessionOptions};
use ademan::setup::Setup;
use ademan::share::{ShareFormat, ShareTarget};
use ademan::time::Timestamp;

use super::clients::{SOCKET_CLIENTS, TCP_CLIENTS};
use super::process::limit_lifetimes;

const PERIOD: Duration = Duration::from_millis(1);

/// A hand that types, with a reading each millisecond.
struct TypingHand {
    packets: Vec<[u8; hc11::BODY_BYTES]>,
    start: Instant,
    readings: u64,
    /// The time of the latest reading, in nanoseconds since the start.
    sent_at: Arc<AtomicU64>,
}

impl Source for TypingHand {
    fn next(&mut self) -> Result<SourceEvent, CaptureError> {
        self.readings += 1;
        let due = PERIOD * self.readings as u32;
        thread::sleep(due.saturating_sub(self.start.elapsed()));
        let body = &self.packets[self.readings as usize % self.packets.len()];
        let now = self.start.elapsed();
        self.sent_at.store(now.as_nanos() as u64, Ordering::Relaxed);
        Ok(SourceEvent::Reading(Reading::new(
            Timestamp(now.as_micros() as u64),
            None,
            Sample::Channels(hc11::channels(body)),
        )))
    }

    fn name(&self) -> &str {
        "typing hand"
    }
}

/// Times from readings to calls of the output, without and with clients, in nanoseconds.
type Times = Arc<Mutex<[Vec<u64>; 2]>>;

/// An output that notes the time of each call.
struct Clock {
    start: Instant,
    sent_at: Arc<AtomicU64>,
    has_clients: Arc<AtomicBool>,
    times: Times,
}

impl Sink for Clock {
    fn send(&mut self, _: &[OutputEvent]) -> Result<(), OutputError> {
        let now = self.start.elapsed().as_nanos() as u64;
        let time = now.saturating_sub(self.sent_at.load(Ordering::Relaxed));
        let part = usize::from(self.has_clients.load(Ordering::Relaxed));
        self.times.lock().expect("no panic")[part].push(time);
        Ok(())
    }

    fn close(&mut self) -> Result<(), OutputError> {
        Ok(())
    }
}

pub fn main() {
    limit_lifetimes();
    let is_bench = std::env::args().any(|argument| argument == "--bench");
    let (parts, length) = if is_bench {
        (8, Duration::from_secs(4))
    } else {
        (2, Duration::from_millis(300))
    };
    let start = Instant::now();
    let (sent_at, has_clients, times) = (
        Arc::default(),
        Arc::<AtomicBool>::default(),
        Times::default(),
    );
    let setup = Setup {
        max_presses_per_second: Some(1000),
        ..Setup::default()
    };
    let setup = setup.load_files().expect("the default setup");
    let source = TypingHand {
        packets: packets(),
        start,
        readings: 0,
        sent_at: Arc::clone(&sent_at),
    };
    let sink = Clock {
        start,
        sent_at,
        has_clients: Arc::clone(&has_clients),
        times: Arc::clone(&times),
    };
    let (notices, targets) = crossbeam_channel::unbounded();
    let target = |format| ShareTarget {
        format,
        ..format!("{format}:127.0.0.1:0").parse().expect("a target")
    };
    let options = SessionOptions {
        source: Some(Box::new(source)),
        output: Some(Box::new(sink)),
        share: vec![target(ShareFormat::TextLine), target(ShareFormat::Ws)],
        report_status: true,
        on_notice: Some(Box::new(move |notice| {
            if let Notice::Sharing(shared) = notice {
                let _ = notices.send(shared.address.to_string());
            }
        })),
        ..SessionOptions::default()
    };
    let session = Session::start(setup, options).expect("a session");
    let address = || {
        targets
            .recv_timeout(Duration::from_secs(60))
            .expect("a server")
    };
    let addresses = format!("{} {}", address(), address());
    let mut cpu = Vec::new();
    for part in 0..parts {
        let clients = (part % 2 == 1).then(|| start_clients(&addresses));
        // The first lines report connections.
        thread::sleep(length / 10);
        has_clients.store(clients.is_some(), Ordering::Relaxed);
        let (before, began) = (processor_time(), Instant::now());
        thread::sleep(length);
        let share = (processor_time() - before) / began.elapsed().as_secs_f64();
        if let Some(clients) = clients {
            has_clients.store(false, Ordering::Relaxed);
            cpu.push(share);
            stop_clients(clients, is_bench);
        }
    }
    session
        .commands()
        .send(SessionCommand::Stop)
        .expect("it runs");
    session.join().expect("it ends");
    report(&times, &mut cpu);
}

/// Prints the table.
fn report(times: &Times, cpu: &mut [f64]) {
    cpu.sort_by(f64::total_cmp);
    println!("{TCP_CLIENTS} TCP and {SOCKET_CLIENTS} WebSocket clients, 1000 readings per second");
    println!(
        "thread that shares: {:.1} % of a core (median)",
        cpu[cpu.len() / 2] * 100.0
    );
    let mut times = times.lock().expect("no panic");
    let mut rows = times.iter_mut().map(|times| {
        times.sort_unstable();
        let at = |percent: usize| times[times.len() * percent / 100] as f64 / 1e3;
        (times.len(), at(50), at(99))
    });
    let (without, with) = (rows.next().expect("a row"), rows.next().expect("a row"));
    println!("reading to output, µs      steps      p50      p99");
    for (name, (count, p50, p99)) in [("without clients", without), ("with clients", with)] {
        println!("{name:22} {count:9} {p50:8.1} {p99:8.1}");
    }
    println!("ratio of p99: {:.2}", with.2 / without.2);
}

/// Returns the packets of a hand that types a text.
fn packets() -> Vec<[u8; hc11::BODY_BYTES]> {
    let setup = Setup::default().load_files().expect("the default setup");
    let typist = setup.typist("hello world", &Hc11Format::default(), 0.5, 1);
    let mut typist = typist.expect("the hand can type the text");
    std::iter::from_fn(|| typist.next_counts())
        .map(|counts| std::array::from_fn(|channel| counts[channel] as u8))
        .collect()
}

fn start_clients(addresses: &str) -> Child {
    let program = std::env::current_exe().expect("this program");
    let mut clients = Command::new(program)
        .env("ADEMAN_SHARE_CLIENTS", addresses)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the clients start");
    let stdout = clients.stdout.as_mut().expect("it is piped");
    let mut line = [0; "connected\n".len()];
    stdout.read_exact(&mut line).expect("they connect");
    clients
}

fn stop_clients(mut clients: Child, is_bench: bool) {
    drop(clients.stdin.take());
    let stdout = BufReader::new(clients.stdout.take().expect("it is piped"));
    for line in stdout.lines().map_while(Result::ok).filter(|_| is_bench) {
        println!("{line}");
    }
    assert!(clients.wait().expect("a child").success());
}

/// Returns the processor time of the threads that share, in seconds.
fn processor_time() -> f64 {
    let tasks = fs::read_dir("/proc/self/task").expect("Linux").flatten();
    let time = |task: fs::DirEntry| {
        let name = fs::read_to_string(task.path().join("comm")).ok()?;
        // Nanoseconds on a processor, then nanoseconds of waiting for one.
        let times = fs::read_to_string(task.path().join("schedstat")).ok()?;
        let time: f64 = times.split_ascii_whitespace().next()?.parse().ok()?;
        name.starts_with("share").then_some(time / 1e9)
    };
    tasks.filter_map(time).sum()
}
