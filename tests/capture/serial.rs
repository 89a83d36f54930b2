//! A real serial device: a pseudo terminal that is paced, cut, filled with noise, unplugged and plugged in again.
#![cfg(unix)]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use crate::support::source::next_within;
use ademan::capture::hc11::{BODY_BYTES, Framing, PACKET_BYTES, encode};
use ademan::capture::{
    CaptureError, CaptureEvent, Hc11Format, Sample, Source, SourceEvent, SourceUri, open,
    open_loopback, spawn,
};
use fastrand::Rng;
use serialport::{SerialPort, TTYPort};

/// Longer than anything here takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(60);

/// A port whose cable can be pulled. Its name is a link, as in `/dev/serial/by-id`, so that no other test gets
/// the same one.
struct Port {
    folder: tempfile::TempDir,
    glove: Option<(TTYPort, TTYPort)>,
}

impl Port {
    fn plugged_in() -> Self {
        let folder = tempfile::tempdir().expect("a folder for the port");
        let mut port = Self {
            folder,
            glove: None,
        };
        port.plug_in();
        port
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("glove")
    }

    /// Comes back as another device of the system, under the same link.
    fn plug_in(&mut self) {
        let (mut master, slave) = TTYPort::pair().expect("a pseudo terminal");
        master
            .set_timeout(LIMIT)
            .expect("a terminal that waits for room");
        let device = slave.name().expect("its name");
        std::os::unix::fs::symlink(device, self.path()).expect("a link to it");
        self.glove = Some((master, slave));
    }

    fn unplug(&mut self) {
        std::fs::remove_file(self.path()).expect("the link was there");
        self.glove = None;
    }

    fn send(&mut self, bytes: &[u8]) {
        let (master, _) = self.glove.as_mut().expect("the port is plugged in");
        master.write_all(bytes).expect("the terminal takes bytes");
    }

    fn name(&self, baud: u32) -> SourceUri {
        name(&self.path(), baud)
    }
}

fn name(path: &Path, baud: u32) -> SourceUri {
    let text = format!("serial:{}?protocol=hc11&baud={baud}", path.display());
    text.parse().expect("the name of a source")
}

fn bodies(random: &mut Rng, count: usize) -> Vec<[u8; BODY_BYTES]> {
    let body = |_| [(); BODY_BYTES].map(|()| random.u8(..));
    (0..count).map(body).collect()
}

fn stream(bodies: &[[u8; BODY_BYTES]]) -> Vec<u8> {
    let frames = bodies.iter();
    frames
        .flat_map(|body| encode(Framing::Double06, body))
        .collect()
}

fn body(sample: &Sample) -> Vec<u8> {
    match sample {
        Sample::Channels(channels) => channels.counts.iter().map(|&count| count as u8).collect(),
        other => panic!("not channels: {other:?}"),
    }
}

fn next(source: &mut dyn Source) -> Result<SourceEvent, CaptureError> {
    next_within(source, LIMIT)
}

fn next_body(source: &mut dyn Source) -> Vec<u8> {
    match next(source) {
        Ok(SourceEvent::Reading(reading)) => body(&reading.sample),
        other => panic!("no reading: {other:?}"),
    }
}

/// What is logged in this process, as text.
fn log() -> &'static Mutex<Vec<u8>> {
    static LOG: OnceLock<Mutex<Vec<u8>>> = OnceLock::new();
    LOG.get_or_init(|| {
        let writer = || LogWriter;
        tracing_subscriber::fmt()
            .with_writer(writer)
            .with_ansi(false)
            .init();
        Mutex::default()
    })
}

struct LogWriter;

impl Write for LogWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        log().lock().unwrap().extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The lines logged about `port` that contain `part`.
fn logged(port: &Port, part: &str) -> usize {
    let path = port.path().display().to_string();
    let text = String::from_utf8_lossy(&log().lock().unwrap()).into_owned();
    text.lines()
        .filter(|line| line.contains(&path) && line.contains(part))
        .count()
}

/// Sends noise and then `frames` frames at the pace of the line, in pieces of random size.
fn every_frame_arrives_at_the_pace_of(baud: u32, frames: usize) {
    let mut random = Rng::with_seed(u64::from(baud));
    let noise: Vec<u8> = (0..100).map(|_| random.u8(..)).collect();
    let sent = bodies(&mut random, frames);
    let mut bytes = noise.clone();
    bytes.extend(stream(&sent));
    bytes.extend([6, 6]);

    let mut port = Port::plugged_in();
    let mut source = open(&port.name(baud)).unwrap();
    let wire_time =
        move |bytes: usize| Duration::from_secs_f64(bytes as f64 * 10.0 / f64::from(baud));
    let pieces = std::thread::spawn(move || {
        let start = Instant::now();
        let mut at = 0;
        while at < bytes.len() {
            let piece = &bytes[at..bytes.len().min(at + 1 + random.usize(..90))];
            at += piece.len();
            std::thread::sleep(wire_time(at).saturating_sub(start.elapsed()));
            port.send(piece);
        }
        port
    });

    let mut last_time = None;
    for (number, expected) in sent.iter().enumerate() {
        let Ok(SourceEvent::Reading(reading)) = next(&mut *source) else {
            panic!("no frame {number}");
        };
        let counts = source.stats();
        assert_eq!(body(&reading.sample), expected, "frame {number}");
        assert_eq!(counts.readings as usize, number + 1);
        assert!(
            Some(reading.time) > last_time,
            "time stands still at {number}"
        );
        last_time = Some(reading.time);
        // The source was opened before the first byte was sent: no frame can have been complete earlier.
        let complete = wire_time(noise.len() + (number + 1) * PACKET_BYTES);
        let stamped = Duration::from_micros(reading.time.0);
        assert!(
            stamped + Duration::from_millis(1) >= complete,
            "{number}: {stamped:?}"
        );
        assert!(counts.skipped_bytes as usize == noise.len() && counts.resyncs == 1);
    }
    pieces.join().expect("the glove sent everything");
}

#[test]
fn every_frame_arrives_at_9600_baud() {
    every_frame_arrives_at_the_pace_of(9600, 20);
}

#[test]
fn every_frame_arrives_at_115200_baud() {
    every_frame_arrives_at_the_pace_of(115_200, 300);
}

#[test]
fn an_unplugged_glove_is_lost_once_and_followed_to_its_next_device() {
    log();
    let mut random = Rng::with_seed(4);
    let sent = bodies(&mut random, 4);
    let bytes = stream(&sent);
    let mut port = Port::plugged_in();
    let mut source = open(&port.name(115_200)).unwrap();
    port.send(&bytes[..PACKET_BYTES + 40]);
    assert_eq!(next_body(&mut *source), sent[0]);

    port.unplug();
    let error = next(&mut *source).unwrap_err();
    assert!(matches!(error, CaptureError::Lost { .. }), "{error}");
    assert!(
        error
            .to_string()
            .contains(&port.path().display().to_string()),
        "{error}"
    );
    // Without a device, the source stays idle and never blocks for good.
    for _ in 0..5 {
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
    }

    port.plug_in();
    let start = Instant::now();
    while logged(&port, "reconnected to") == 0 && start.elapsed() < LIMIT {
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
    }
    // The rest of the frame that was cut, and whole frames.
    port.send(&bytes[PACKET_BYTES + 40..]);
    port.send(&[6, 6]);
    assert_eq!(next_body(&mut *source), sent[2]);
    assert_eq!(next_body(&mut *source), sent[3]);
    assert_eq!(source.stats().losses, 1);
    assert_eq!(logged(&port, "reconnected to"), 1);
}

/// `benches/release.rs` measures the time.
#[test]
fn a_loss_is_reported_right_after_the_last_reading() {
    let mut random = Rng::with_seed(8);
    let mut port = Port::plugged_in();
    let captured = spawn(open(&port.name(115_200)).unwrap()).unwrap();
    let next = || captured.events().recv_timeout(LIMIT).expect("an event");
    port.send(&stream(&bodies(&mut random, 3)));
    for _ in 0..2 {
        let event = next();
        assert!(matches!(event, CaptureEvent::Reading { .. }), "{event:?}");
    }
    port.unplug();
    // The last packet may count as complete at the end of the stream.
    let events = std::iter::repeat_with(next);
    let mut others = events.filter(|event| !matches!(event, CaptureEvent::Reading { .. }));
    let event = others.next().expect("an event");
    assert!(matches!(event, CaptureEvent::Lost(_)), "{event:?}");
}

#[test]
fn a_port_that_is_in_use_says_so() {
    let port = Port::plugged_in();
    let _first = open(&port.name(9600)).unwrap();
    let error = open(&port.name(9600))
        .err()
        .expect("the port is taken")
        .to_string();
    assert!(error.contains("in use by another program"), "{error}");
}

#[test]
fn a_port_that_is_absent_says_so() {
    let mut port = Port::plugged_in();
    port.unplug();
    let error = open(&port.name(9600))
        .err()
        .expect("the port is gone")
        .to_string();
    assert!(error.contains("there is no such port"), "{error}");
    assert!(
        error.contains("serial port is present") || error.contains("present: "),
        "{error}"
    );
}

#[test]
fn what_is_no_serial_port_is_refused() {
    let error = open(&name(Path::new("/dev/null"), 9600))
        .err()
        .expect("no port")
        .to_string();
    assert!(error.contains("does not work as a serial port"), "{error}");
}

#[test]
fn garbage_for_two_seconds_is_warned_of_once() {
    log();
    let mut random = Rng::with_seed(5);
    let mut port = Port::plugged_in();
    let mut source = open(&port.name(9600)).unwrap();
    let start = Instant::now();
    let mut receive_noise = |port: &mut Port| {
        port.send(&[random.u8(..), 0]);
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        std::thread::sleep(Duration::from_millis(5));
    };
    while logged(&port, "check baud and protocol") == 0 {
        receive_noise(&mut port);
        assert!(start.elapsed() < LIMIT, "no warning");
    }
    assert!(start.elapsed() > Duration::from_millis(1900));
    (0..100).for_each(|_| receive_noise(&mut port));
    assert_eq!(logged(&port, "check baud and protocol"), 1);
}

#[test]
fn a_megabyte_of_noise_gives_no_frame_and_the_next_frames_do() {
    const NOISE: usize = 1 << 20;
    let mut random = Rng::with_seed(6);
    let noise: Vec<u8> = (0..NOISE).map(|_| random.u8(..)).collect();
    let sent = bodies(&mut random, 2);
    let mut port = Port::plugged_in();
    let mut source = open(&port.name(115_200)).unwrap();
    let tail = [stream(&sent), vec![6, 6]].concat();
    let glove = std::thread::spawn(move || {
        // Small pieces: a terminal takes no more than it has room for.
        noise.chunks(256).for_each(|piece| port.send(piece));
        port.send(&tail);
        port
    });
    assert_eq!(next_body(&mut *source), sent[0]);
    assert_eq!(next_body(&mut *source), sent[1]);
    let counts = source.stats();
    assert_eq!(
        (counts.skipped_bytes, counts.readings, counts.resyncs),
        (NOISE as u64, 2, 1)
    );
    glove.join().expect("the glove sent everything");
}

#[test]
fn a_wire_that_nobody_reads_takes_bytes_all_the_same() {
    let mut wire = open_loopback(Hc11Format::default()).unwrap();
    // More than the terminal holds, 70 kB on Linux.
    wire.writer.write_all(&[0; 90_000]).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_that_got_the_number_of_a_lost_one_is_left_alone() {
    let mut port = Port::plugged_in();
    let mut source = open(&port.name(115_200)).expect("the port opens");
    let bodies = bodies(&mut Rng::with_seed(7), 4);
    port.send(&stream(&bodies));
    assert_eq!(next_body(&mut *source), bodies[0]);
    let number = std::fs::read_link(port.path()).expect("a link");
    // It ends without taking the link away, as a program that was killed does.
    port.glove = None;
    while !matches!(next(&mut *source), Err(CaptureError::Lost { .. })) {}
    // The kernel gives the lowest number that is free; other tests may be faster.
    let mut others = Vec::new();
    let (mut shell, _its_end) = loop {
        let pair = TTYPort::pair().expect("a pseudo terminal");
        if pair.1.name().map(PathBuf::from) == Some(number.clone()) {
            break pair;
        }
        others.push(pair);
        if others.len() == 100 {
            println!("SKIPPED: another program has got {}", number.display());
            return;
        }
    };
    let short = Duration::from_millis(1);
    shell.set_timeout(short).expect("it need not take all");
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(1500) {
        let _ = shell.write(&stream(&bodies));
        let news = source.next();
        assert!(matches!(news, Ok(SourceEvent::Idle)), "{news:?}");
    }
}

#[test]
fn a_wire_is_a_serial_port_whose_cable_is_its_writer() {
    let sent = bodies(&mut Rng::with_seed(8), 3);
    let mut wire = open_loopback(Hc11Format::default()).unwrap();
    let mut source = open(&wire.uri).unwrap();
    wire.writer.write_all(&stream(&sent)).unwrap();
    assert_eq!(next_body(&mut *source), sent[0]);
    assert_eq!(next_body(&mut *source), sent[1]);
    drop(wire.writer);
    let error = next(&mut *source).unwrap_err();
    assert!(matches!(error, CaptureError::Lost { .. }), "{error}");
    let port = wire.uri.serial_port().expect("a serial port");
    assert!(!Path::new(port).is_symlink(), "the port keeps its name");
}
