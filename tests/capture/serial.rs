//! Serial ports on pseudo-terminals: bit rates, noise, unplugging and replugging.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, Framing, PACKET_BYTES, body, encode};
use ademan::capture::{
    CaptureError, CaptureEvent, Hc11Format, Source, SourceEvent, SourceUri, open, open_loopback,
    spawn,
};
use fastrand::Rng;
use serialport::{SerialPort, TTYPort};

use crate::support::source::next_within;

type Body = [u8; BODY_BYTES];

/// Longest wait on a busy machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A port whose cable can be unplugged. Its name is a link, as in `/dev/serial/by-id`, so that no other test gets
/// the same name.
struct Port {
    folder: tempfile::TempDir,
    /// Both ends, while the cable is plugged in.
    terminals: Option<(TTYPort, TTYPort)>,
}

impl Port {
    fn plugged_in() -> Self {
        let mut port = Self {
            folder: tempfile::tempdir().expect("a folder for the link"),
            terminals: None,
        };
        port.plug_in();
        port
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("glove")
    }

    /// Links the name to a new terminal.
    fn plug_in(&mut self) {
        let (mut master, slave) = TTYPort::pair().expect("a pseudo-terminal");
        master.set_timeout(TIMEOUT).expect("writes wait for room");
        let terminal = slave.name().expect("its name");
        std::os::unix::fs::symlink(terminal, self.path()).expect("a link to it");
        self.terminals = Some((master, slave));
    }

    fn unplug(&mut self) {
        std::fs::remove_file(self.path()).expect("the link exists");
        self.terminals = None;
    }

    fn send(&mut self, bytes: &[u8]) {
        let (master, _) = self.terminals.as_mut().expect("the port is plugged in");
        master.write_all(bytes).expect("the terminal accepts bytes");
    }

    fn uri(&self, baud: u32) -> SourceUri {
        uri(&self.path(), baud)
    }
}

fn uri(path: &Path, baud: u32) -> SourceUri {
    let text = format!("serial:{}?protocol=hc11&baud={baud}", path.display());
    text.parse().expect("a source URI")
}

fn random_bodies(random: &mut Rng, count: usize) -> Vec<Body> {
    let body = |_| [(); BODY_BYTES].map(|()| random.u8(..));
    (0..count).map(body).collect()
}

fn packets(bodies: &[Body]) -> Vec<u8> {
    bodies
        .iter()
        .flat_map(|body| encode(Framing::Double06, body))
        .collect()
}

fn next(source: &mut dyn Source) -> Result<SourceEvent, CaptureError> {
    next_within(source, TIMEOUT)
}

fn next_body(source: &mut dyn Source) -> Body {
    match next(source) {
        Ok(SourceEvent::Reading(reading)) => body(&reading.sample).expect("HC11 channels"),
        other => panic!("no reading: {other:?}"),
    }
}

/// Returns the log of this process.
pub fn log() -> &'static Mutex<Vec<u8>> {
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

/// Returns the number of log lines about `port` that contain `part`.
fn logged(port: &Port, part: &str) -> usize {
    let path = port.path().display().to_string();
    let text = String::from_utf8_lossy(&log().lock().unwrap()).into_owned();
    text.lines()
        .filter(|line| line.contains(&path) && line.contains(part))
        .count()
}

/// Reads a source at which nothing arrives until this warning is logged.
pub fn wait_for_warning(source: &mut dyn Source, warning: &str) {
    let is_logged = || String::from_utf8_lossy(&log().lock().unwrap()).contains(warning);
    assert!(!is_logged());
    let deadline = Instant::now() + TIMEOUT;
    while !is_logged() {
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        assert!(Instant::now() < deadline, "no warning");
    }
}

/// Sends noise and then `count` packets at the bit rate, in pieces of random size, and checks every reading.
fn check_packets_at(baud: u32, count: usize) {
    let mut random = Rng::with_seed(u64::from(baud));
    let noise: Vec<u8> = (0..100).map(|_| random.u8(..)).collect();
    let sent = random_bodies(&mut random, count);
    let mut bytes = noise.clone();
    bytes.extend(packets(&sent));
    bytes.extend([6, 6]);

    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(baud)).unwrap();
    let transmission_time =
        move |length: usize| Duration::from_secs_f64(length as f64 * 10.0 / f64::from(baud));
    let glove = std::thread::spawn(move || {
        let start = Instant::now();
        let mut sent_bytes = 0;
        while sent_bytes < bytes.len() {
            let piece = &bytes[sent_bytes..bytes.len().min(sent_bytes + 1 + random.usize(..90))];
            sent_bytes += piece.len();
            std::thread::sleep(transmission_time(sent_bytes).saturating_sub(start.elapsed()));
            port.send(piece);
        }
        port
    });

    let mut last_time = None;
    for (index, expected) in sent.iter().enumerate() {
        let Ok(SourceEvent::Reading(reading)) = next(&mut *source) else {
            panic!("no packet {index}");
        };
        let stats = source.stats();
        assert_eq!(body(&reading.sample).as_ref(), Some(expected), "{index}");
        assert_eq!(stats.readings as usize, index + 1);
        assert!(Some(reading.time) > last_time, "the time of {index}");
        last_time = Some(reading.time);
        // The source was opened before the first byte was sent, so no packet was complete earlier.
        let complete = transmission_time(noise.len() + (index + 1) * PACKET_BYTES);
        let stamped = Duration::from_micros(reading.time.0);
        assert!(
            stamped + Duration::from_millis(1) >= complete,
            "{index}: {stamped:?}"
        );
        assert!(stats.skipped_bytes as usize == noise.len() && stats.resyncs == 1);
    }
    glove.join().expect("everything was sent");
}

#[test]
fn every_packet_arrives_at_9600_baud() {
    check_packets_at(9600, 20);
}

#[test]
fn every_packet_arrives_at_115200_baud() {
    check_packets_at(115_200, 300);
}

#[test]
fn an_unplugged_glove_is_lost_once_and_followed_to_its_next_terminal() {
    log();
    let mut random = Rng::with_seed(4);
    let sent = random_bodies(&mut random, 4);
    let bytes = packets(&sent);
    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(115_200)).unwrap();
    port.send(&bytes[..PACKET_BYTES + 40]);
    assert_eq!(next_body(&mut *source), sent[0]);

    port.unplug();
    let error = next(&mut *source).unwrap_err();
    assert!(matches!(error, CaptureError::Lost { .. }), "{error}");
    let path = port.path().display().to_string();
    assert!(error.to_string().contains(&path), "{error}");
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(500) {
        let called_at = Instant::now();
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        assert!(
            called_at.elapsed() < TIMEOUT,
            "blocked for {:?}",
            called_at.elapsed()
        );
    }

    port.plug_in();
    let plugged_at = Instant::now();
    while logged(&port, "reconnected to") == 0 && plugged_at.elapsed() < TIMEOUT {
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
    }
    // The rest of the packet that was cut, and complete packets.
    port.send(&bytes[PACKET_BYTES + 40..]);
    port.send(&[6, 6]);
    assert_eq!(next_body(&mut *source), sent[2]);
    assert_eq!(next_body(&mut *source), sent[3]);
    assert_eq!(source.stats().losses, 1);
    assert_eq!(logged(&port, "reconnected to"), 1);
}

#[test]
fn a_loss_is_reported_right_after_the_last_reading() {
    let sent = random_bodies(&mut Rng::with_seed(9), 2);
    let mut port = Port::plugged_in();
    let capture = spawn(open(&port.uri(9600)).unwrap()).unwrap();
    let next = || capture.events().recv_timeout(TIMEOUT).expect("an event");
    port.send(&packets(&sent));
    let event = next();
    assert!(matches!(event, CaptureEvent::Reading { .. }), "{event:?}");
    port.unplug();
    let lost = next();
    assert!(matches!(lost, CaptureEvent::Lost(_)), "{lost:?}");
}

/// Returns the message of a source that does not open.
fn open_error(uri: &SourceUri) -> String {
    open(uri).err().expect("it does not open").to_string()
}

#[test]
fn a_port_in_use_is_reported() {
    let port = Port::plugged_in();
    let _first = open(&port.uri(9600)).unwrap();
    let error = open_error(&port.uri(9600));
    assert!(error.contains("in use by another program"), "{error}");
}

#[test]
fn an_absent_port_is_reported_with_the_present_ones() {
    let mut port = Port::plugged_in();
    port.unplug();
    let error = open_error(&port.uri(9600));
    assert!(error.contains("there is no such port"), "{error}");
    assert!(
        error.contains("serial port is present") || error.contains("present: "),
        "{error}"
    );
}

#[test]
fn a_device_other_than_a_serial_port_is_rejected() {
    let error = open_error(&uri(Path::new("/dev/null"), 9600));
    assert!(error.contains("does not work as a serial port"), "{error}");
}

/// Returns `true` after this time, or after a longer one on a busy machine that has not warned yet.
fn is_over(start: Instant, length: Duration, warnings: usize) -> bool {
    start.elapsed() >= if warnings == 0 { TIMEOUT } else { length }
}

#[test]
fn garbage_for_two_seconds_gives_one_warning() {
    log();
    let mut random = Rng::with_seed(5);
    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(9600)).unwrap();
    let start = Instant::now();
    let advice = "check baud and protocol";
    while !is_over(start, Duration::from_secs(3), logged(&port, advice)) {
        port.send(&[random.u8(..), 0]);
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        std::thread::sleep(Duration::from_millis(5));
        if start.elapsed() < Duration::from_millis(1900) {
            assert_eq!(logged(&port, "no valid packet"), 0);
        }
    }
    assert_eq!(logged(&port, advice), 1);
}

/// Sends pieces of a stream to a source with these options until it has had the time to warn, and returns how often the log has a
/// text.
fn warnings_with(options: &str, mut piece: impl FnMut() -> Vec<u8>, text: &str) -> usize {
    log();
    let mut port = Port::plugged_in();
    let uri = format!("serial:{}{options}", port.path().display());
    let mut source = open(&uri.parse().expect("a source URI")).unwrap();
    let start = Instant::now();
    while !is_over(start, Duration::from_secs(3), logged(&port, text)) {
        port.send(&piece());
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        std::thread::sleep(Duration::from_millis(10));
    }
    logged(&port, text)
}

#[test]
fn bytes_of_another_protocol_are_recognized() {
    let mut random = Rng::with_seed(6);
    let line = || format!("A957B{}C60D2047E1F2047G2047P0\n", random.u16(..4096)).into_bytes();
    let advice = "it looks like LucidGloves: add protocol=lucidgloves";
    assert_eq!(warnings_with("", line, advice), 1);

    let mut other_random = Rng::with_seed(6);
    let mut packet = |framing| encode(framing, &random_bodies(&mut other_random, 1)[0]).to_vec();
    let framing_advice = "looks like HC11: add protocol=hc11&framing=hash";
    assert_eq!(
        warnings_with("", || packet(Framing::Hash), framing_advice),
        1
    );
    let protocol_advice = "looks like HC11: set protocol=hc11";
    let options = "?protocol=lucidgloves";
    assert_eq!(
        warnings_with(options, || packet(Framing::Double06), protocol_advice),
        1
    );
}

#[test]
fn a_sender_at_a_lower_bit_rate_is_recognized() {
    // At 115200, a bit of 9600 lasts longer than a byte: its stop bit is low, and the byte arrives as 0.
    let advice = "it looks like a sender at a lower bit rate: set baud=9600";
    let options = "?protocol=hc11&baud=115200";
    assert_eq!(warnings_with(options, || vec![0; 4], advice), 1);
}

#[test]
fn packets_that_a_pause_confirms_are_no_garbage() {
    log();
    let mut random = Rng::with_seed(7);
    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(115_200)).unwrap();
    let (mut sent, mut received) = (0, 0);
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(4) {
        port.send(&packets(&random_bodies(&mut random, 1)));
        sent += 1;
        // The bytes, the pause after them, and the silence.
        let mut idle = 0;
        while idle < 2 {
            match source.next().unwrap() {
                SourceEvent::Reading(_) => received += 1,
                event => {
                    assert_eq!(event, SourceEvent::Idle);
                    idle += 1;
                }
            }
        }
    }
    // No header follows the last packet.
    assert_eq!(received, sent);
    assert_eq!(logged(&port, "no valid packet"), 0);
}

#[test]
fn a_port_without_a_byte_gives_one_warning() {
    log();
    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(9600)).unwrap();
    let start = Instant::now();
    let warning = "no byte has arrived";
    while !is_over(start, Duration::from_secs(8), logged(&port, warning)) {
        assert_eq!(source.next().unwrap(), SourceEvent::Idle);
        if start.elapsed() < Duration::from_secs(4) {
            assert_eq!(logged(&port, warning), 0);
        }
    }
    assert_eq!(logged(&port, warning), 1);
    // A cut packet, long after.
    port.send(&[6, 6, 1]);
    assert_eq!(source.next().unwrap(), SourceEvent::Idle);
    assert_eq!(logged(&port, "no valid packet"), 0);
}

#[test]
fn packets_after_a_megabyte_of_noise_are_decoded() {
    const NOISE: usize = 1 << 20;
    let mut random = Rng::with_seed(6);
    let noise: Vec<u8> = (0..NOISE).map(|_| random.u8(..)).collect();
    let sent = random_bodies(&mut random, 2);
    let mut port = Port::plugged_in();
    let mut source = open(&port.uri(115_200)).unwrap();
    let end = [packets(&sent), vec![6, 6]].concat();
    let glove = std::thread::spawn(move || {
        // A terminal accepts no more bytes than it has room for.
        noise.chunks(256).for_each(|piece| port.send(piece));
        port.send(&end);
        port
    });
    assert_eq!(next_body(&mut *source), sent[0]);
    assert_eq!(next_body(&mut *source), sent[1]);
    let stats = source.stats();
    assert_eq!(
        (stats.skipped_bytes, stats.readings, stats.resyncs),
        (NOISE as u64, 2, 1)
    );
    glove.join().expect("everything was sent");
}

#[test]
fn a_loopback_without_a_reader_does_not_block() {
    let mut loopback = open_loopback(Hc11Format::default()).unwrap();
    // More than the buffer of a terminal, 70 kB on Linux.
    loopback.writer.write_all(&[0; 90_000]).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_with_the_number_of_a_lost_one_is_not_opened() {
    let bodies = random_bodies(&mut Rng::with_seed(7), 4);
    for _ in 0..20 {
        let mut port = Port::plugged_in();
        let mut source = open(&port.uri(115_200)).expect("the port opens");
        port.send(&packets(&bodies));
        assert_eq!(next_body(&mut *source), bodies[0]);
        let number = std::fs::read_link(port.path()).expect("a link");
        // The terminal ends but the link stays, as after a program was killed.
        port.terminals = None;
        while !matches!(next(&mut *source), Err(CaptureError::Lost { .. })) {}
        let Some((mut other, _slave)) = terminal_with_the_number(&number) else {
            continue;
        };
        let short = Duration::from_millis(1);
        other.set_timeout(short).expect("writes may be incomplete");
        let start = Instant::now();
        while start.elapsed() < Duration::from_millis(1500) {
            let _ = other.write(&packets(&bodies));
            let event = source.next();
            assert!(matches!(event, Ok(SourceEvent::Idle)), "{event:?}");
        }
        return;
    }
    panic!("other programs have opened each terminal first");
}

/// Opens a terminal with a number that has become free; `None` if another test was faster. The kernel assigns the lowest free number.
#[cfg(target_os = "linux")]
fn terminal_with_the_number(number: &Path) -> Option<(TTYPort, TTYPort)> {
    let mut others = Vec::new();
    while others.len() < 100 {
        let pair = TTYPort::pair().expect("a pseudo-terminal");
        if pair.1.name().is_some_and(|name| Path::new(&name) == number) {
            return Some(pair);
        }
        others.push(pair);
    }
    None
}

#[test]
fn dropping_the_writer_of_a_loopback_unplugs_its_port() {
    let sent = random_bodies(&mut Rng::with_seed(8), 3);
    let mut loopback = open_loopback(Hc11Format::default()).unwrap();
    let mut source = open(&loopback.uri).unwrap();
    loopback.writer.write_all(&packets(&sent)).unwrap();
    assert_eq!(next_body(&mut *source), sent[0]);
    assert_eq!(next_body(&mut *source), sent[1]);
    drop(loopback.writer);
    let error = next(&mut *source).unwrap_err();
    assert!(matches!(error, CaptureError::Lost { .. }), "{error}");
    let port = loopback.uri.serial_port().expect("a serial port");
    assert!(!Path::new(port).is_symlink(), "{port} still exists");
}
