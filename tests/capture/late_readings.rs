//! Readings that a network has held back, on a real socket.

use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::protocol::text_line;
use ademan::capture::{InvalidPacket, Sample, Source, SourceEvent, SourceUri, open};
use ademan::hand::{Dof, JointAngles};
use ademan::time::Timestamp;

const PERIOD: Duration = Duration::from_millis(10);

/// Age of a reading that must not arrive, twice the limit.
const OLD: Duration = Duration::from_millis(400);

/// A sender of numbered text lines.
struct Sender {
    stream: TcpStream,
    start: Instant,
    /// The times of all lines so far.
    times: Vec<Duration>,
}

impl Sender {
    /// Returns the next line, whose number is an angle in hundredths of a degree.
    fn line(&mut self) -> Vec<u8> {
        let mut angles = JointAngles::default();
        angles.set(
            Dof::WristFlexion,
            (self.times.len() as f64 / 100.0).to_radians(),
        );
        let time = self.start.elapsed();
        self.times.push(time);
        let mut line = Vec::new();
        text_line::write(&angles, Some(Timestamp(time.as_micros() as u64)), &mut line);
        line
    }

    /// Sends a line every 10 ms.
    fn send_for(&mut self, length: Duration) {
        let end = Instant::now() + length;
        while Instant::now() < end {
            let line = self.line();
            self.stream.write_all(&line).expect("the source reads");
            thread::sleep(PERIOD);
        }
    }

    /// Holds the lines of this time back, and sends them at once.
    fn hold_back(&mut self, length: Duration) {
        let end = Instant::now() + length;
        let mut held = Vec::new();
        while Instant::now() < end {
            held.extend(self.line());
            thread::sleep(PERIOD);
        }
        self.stream.write_all(&held).expect("the source reads");
    }
}

/// Returns the numbers of the readings that arrive until the sender ends.
fn numbers(source: &mut dyn Source) -> Vec<usize> {
    let mut numbers = Vec::new();
    loop {
        match source.next() {
            Ok(SourceEvent::Reading(reading)) => {
                let Sample::Angles { angles } = reading.sample else {
                    panic!("{reading:?}");
                };
                let degrees = angles.get(Dof::WristFlexion).to_degrees();
                numbers.push((degrees * 100.0).round() as usize);
            }
            Ok(_) => {}
            // The sender has closed the connection.
            Err(_) => return numbers,
        }
    }
}

#[test]
fn readings_that_the_network_held_back_are_dropped_and_counted_and_later_ones_pass() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    let uri: SourceUri = format!("tcp:{address}?protocol=text-line")
        .parse()
        .expect("a source URI");
    let mut source = open(&uri).expect("the server listens");
    let stream = listener.accept().expect("the source connects").0;
    let sender = thread::spawn(move || {
        let mut sender = Sender {
            stream,
            start: Instant::now(),
            times: Vec::new(),
        };
        // Twice the time in which the clock of a sender is tried.
        sender.send_for(Duration::from_millis(4500));
        let first_held = sender.times.len();
        sender.hold_back(Duration::from_millis(1500));
        let held = first_held..sender.times.len();
        sender.send_for(Duration::from_secs(1));
        (held, sender.times)
    });
    let numbers = numbers(&mut *source);
    let (held, times) = sender.join().expect("no panic");
    let released_at = times[held.end - 1];
    let is_old = |number: &&usize| held.contains(number) && released_at - times[**number] > OLD;
    let old: Vec<_> = numbers.iter().filter(is_old).collect();
    assert!(old.is_empty(), "{} readings of the past", old.len());
    assert!(numbers.contains(&0), "the first reading arrives");
    assert!(numbers.iter().any(|&number| number >= held.end));
    let stats = source.stats();
    let too_old = stats.invalid.get(InvalidPacket::TooOld);
    assert_eq!(numbers.len() as u64 + too_old, times.len() as u64);
    assert_eq!(stats.readings, numbers.len() as u64);
}
