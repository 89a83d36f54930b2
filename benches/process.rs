//! Start-up time of the program up to the first line of output, and its memory, processor time and wake-ups during a run.
//!
//! Prints tables. What a run needs is read from `/proc` and skipped on other systems. Without `--bench` (as in
//! `cargo test --benches`) it measures one start and a short run.
//!
//! `null` is the minimum for the processor time: a program that waits for the bytes of the line, reads them and does nothing.
//! `ADEMAN_BASELINE=PATH` names an earlier build of the program. The runs of all of them alternate.

#[path = "support/packets.rs"]
mod packets;

#[path = "../tests/support/process.rs"]
#[allow(dead_code)]
mod process;

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, PACKET_BYTES};
use ademan::capture::{Hc11Format, open_loopback};

use packets::packets;
use process::limit_lifetimes;

const ADEMAN: &str = env!("CARGO_BIN_EXE_ademan");

/// The argument with which this program starts itself as `null`, before the port.
const NULL: &str = "--null";

fn main() {
    let arguments: Vec<_> = std::env::args().collect();
    if let [_, mode, port] = &arguments[..]
        && mode == NULL
    {
        return read_only(port);
    }
    limit_lifetimes();
    let is_test = !std::env::args().any(|argument| argument == "--bench");
    let (starts, feed) = if is_test {
        (1, Duration::from_millis(300))
    } else {
        (21, Duration::from_secs(5))
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("glove.bin");
    std::fs::write(&path, packets().collect::<Vec<_>>().concat()).expect("space on the disk");

    println!("process                              median      slowest     goal");
    row("help (no reading)", starts, "", || {
        time_to_first_line(&["--help"])
    });
    let source = format!("file:{}", path.display());
    row("start to first reading", starts, "50 ms", || {
        time_to_first_line(&["trace", "readings", "--source", &source])
    });
    row("start to first touch of a key", starts, "", || {
        time_to_first_line(&["trace", "touches", "--source", &source])
    });
    memory(feed);
    if !Path::new("/proc/self/task").exists() {
        println!("processor time and wake-ups of `run`: SKIPPED: no /proc");
        return;
    }
    let baseline = std::env::var("ADEMAN_BASELINE").ok();
    let null = std::env::current_exe().expect("a path");
    let programs = [
        ("null", null.to_str()),
        ("now", Some(ADEMAN)),
        ("baseline", baseline.as_deref()),
    ];
    let programs: Vec<(&str, &str)> = programs
        .into_iter()
        .filter_map(|(name, program)| Some((name, program?)))
        .collect();
    println!("run                              processor   wake-ups    goal");
    for (rate_hz, goal) in [(175, "0.4 %"), (1_000, "1.2 %")] {
        for _ in 0..if is_test { 1 } else { 3 } {
            for (name, program) in &programs {
                effort(name, program, rate_hz, feed, goal);
            }
        }
    }
}

fn row(what: &str, times: usize, goal: &str, mut measure: impl FnMut() -> Duration) {
    let mut found: Vec<Duration> = (0..times).map(|_| measure()).collect();
    found.sort_unstable();
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    println!(
        "{what:32} {:8.2} ms {:9.2} ms     {goal}",
        millis(found[times / 2]),
        millis(found[times - 1])
    );
}

fn start(arguments: &[&str]) -> Child {
    start_program(ADEMAN, arguments)
}

fn start_program(program: &str, arguments: &[&str]) -> Child {
    Command::new(program)
        .args(arguments)
        .env_remove("XDG_RUNTIME_DIR")
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

fn time_to_first_line(arguments: &[&str]) -> Duration {
    let begun = Instant::now();
    let mut child = start(arguments);
    let mut line = String::new();
    let output = child.stdout.take().expect("stdout is piped");
    let length = BufReader::new(output).read_line(&mut line);
    let took = begun.elapsed();
    assert!(length.is_ok_and(|length| length > 0), "no line came");
    // It may have exited.
    let _ = child.kill();
    let _ = child.wait();
    took
}

/// Feeds `ademan run` through a pseudo terminal and prints its memory.
fn memory(feed: Duration) {
    if !Path::new("/proc/self/status").exists() {
        println!("resident memory of `run`: SKIPPED: no /proc");
        return;
    }
    let mut loopback = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let mut child = start(&[
        "run",
        "--allow-root",
        "--armed",
        "--source",
        &loopback.uri.to_string(),
    ]);
    let begun = Instant::now();
    'feeding: loop {
        for packet in packets() {
            let written = loopback.writer.write_all(&packet);
            if written.is_err() || begun.elapsed() > feed {
                break 'feeding;
            }
            sleep(Duration::from_micros(5_700));
        }
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
    let status = status.expect("the program is still running");
    for (field, what, goal) in [
        ("VmHWM:", "resident memory of `run`, peak", "12 MB"),
        ("RssAnon:", "  of which anonymous", ""),
        ("VmData:", "  data segment", ""),
    ] {
        let line = status.lines().find(|line| line.starts_with(field));
        let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
        match kilobytes {
            Some(kilobytes) => println!(
                "{what:32} {:8.2} MB                  {goal}",
                kilobytes / 1e3
            ),
            None => println!("{what:32} SKIPPED: no {field}"),
        }
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// Feeds `run` at `rate_hz` packets per second and prints its share of a core and the wake-ups of its threads per second.
fn effort(name: &str, program: &str, rate_hz: u32, feed: Duration, goal: &str) {
    let mut loopback = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
    let uri = loopback.uri.to_string();
    let port = loopback.uri.serial_port().expect("a serial port");
    let mut child = match name {
        "null" => start_program(program, &[NULL, port]),
        _ => start_program(
            program,
            &["run", "--allow-root", "--armed", "--source", &uri],
        ),
    };
    let mut packets: Vec<_> = packets().collect();
    // On a line without pauses the header of the next packet follows at once.
    let header = &packets[0][..PACKET_BYTES - BODY_BYTES];
    loopback.writer.write_all(header).expect("the line is open");
    packets
        .iter_mut()
        .for_each(|packet| packet.rotate_left(PACKET_BYTES - BODY_BYTES));
    let begun = Instant::now();
    let mut at_half = None;
    for (number, packet) in (0..).zip(packets.iter().cycle()) {
        let due = Duration::from_secs(1) * number / rate_hz;
        sleep(due.saturating_sub(begun.elapsed()));
        loopback.writer.write_all(packet).expect("the line is open");
        // The start of the program does not count.
        if at_half.is_none() && due > feed / 2 {
            at_half = Some((Instant::now(), Effort::of(child.id())));
        }
        if due > feed {
            break;
        }
    }
    let (half, before) = at_half.expect("half of the time has passed");
    let (seconds, after) = (half.elapsed().as_secs_f64(), Effort::of(child.id()));
    println!(
        "{rate_hz:5} packets/s, {name:12} {:15.2} % {:8.0}/s    {goal}",
        (after.processor - before.processor).as_secs_f64() / seconds * 1e2,
        (after.wake_ups - before.wake_ups) as f64 / seconds
    );
    // It may have exited.
    let _ = child.kill();
    let _ = child.wait();
}

/// Waits for bytes and reads them until the line is closed.
fn read_only(port: &str) {
    let port = serialport::new(port, Hc11Format::default().baud.get());
    let port = port.timeout(Duration::from_secs(3600)).open();
    let mut port = port.expect("the port opens");
    while port.read(&mut [0; 512]).is_ok_and(|length| length > 0) {}
}

/// The processor time and the wake-ups of all threads of a process so far.
#[derive(Default)]
struct Effort {
    processor: Duration,
    wake_ups: u64,
}

impl Effort {
    fn of(process: u32) -> Self {
        let tasks = std::fs::read_dir(format!("/proc/{process}/task"));
        let mut sum = Self::default();
        for task in tasks.expect("the program is still running").flatten() {
            let read = |file| std::fs::read_to_string(task.path().join(file)).unwrap_or_default();
            let nanoseconds = read("schedstat");
            let nanoseconds = nanoseconds.split(' ').next().and_then(|it| it.parse().ok());
            sum.processor += Duration::from_nanos(nanoseconds.unwrap_or(0));
            let status = read("status");
            let field = "voluntary_ctxt_switches:";
            let line = status.lines().find_map(|line| line.strip_prefix(field));
            sum.wake_ups += line
                .and_then(|it| it.trim().parse::<u64>().ok())
                .unwrap_or(0);
        }
        sum
    }
}
