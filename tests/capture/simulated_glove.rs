//! The simulated glove of the demo, whose thread may be late.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use ademan::capture::Hc11Format;
use ademan::setup::Setup;
use ademan::sim::{PacketWriters, play};
use crossbeam_channel::bounded;

/// The index of the packet that is accepted late.
const LATE: usize = 20;

/// The time that it takes: 52 packets at 115 200 baud.
const DELAY: Duration = Duration::from_millis(300);

/// A line that accepts one packet late, and the times of all packets.
struct LateLine(Arc<Mutex<Vec<Instant>>>);

impl Write for LateLine {
    fn write(&mut self, packet: &[u8]) -> io::Result<usize> {
        let mut times = self.0.lock().expect("no panic");
        if times.len() == LATE {
            sleep(DELAY);
        }
        times.push(Instant::now());
        Ok(packet.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_simulated_glove_that_is_late_pauses_and_sends_no_burst() {
    let setup = Setup::default().load_files().expect("the default setup");
    let format = Hc11Format::default();
    let hand = setup.typist("h", &format, 0.0, 0);
    let times = Arc::new(Mutex::new(Vec::new()));
    let mut lines: PacketWriters = vec![Box::new(LateLine(Arc::clone(&times)))];
    let (_cancel, cancelled) = bounded(1);
    let played = play(hand.expect("a hand"), &mut lines, format, &cancelled);
    assert!(!played.expect("the line accepts all").is_cancelled);
    let times = times.lock().expect("no panic");
    // 20 packets after the delay. A burst takes no time, and a busy machine any.
    let taken = times[LATE + 21].duration_since(times[LATE + 1]);
    let on_the_line = format.packet_period() * 20;
    assert!(taken * 2 > on_the_line, "{taken:?}, not {on_the_line:?}");
}
