//! A glove on a pseudo terminal that types in a loop.

use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ademan::capture::hc11::{BODY_BYTES, PACKET_BYTES};
use ademan::capture::{Hc11Format, Loopback, open_loopback};
use ademan::priority::raise_thread_priority;

use super::packets::packets;

/// Packets per second: as many as the line carries.
const RATE_HZ: u32 = 175;

/// A glove whose thread sends packets until this is dropped.
pub struct Glove {
    /// The source for the program.
    pub source: String,
    state: Arc<State>,
}

struct State {
    start: Instant,
    /// Time at which the latest packet was complete, in nanoseconds since the start.
    sent_at: AtomicU64,
    is_silent: AtomicBool,
    is_stopped: AtomicBool,
}

impl Glove {
    pub fn start() -> Self {
        let loopback = open_loopback(Hc11Format::default()).expect("a pseudo terminal");
        let source = loopback.uri.to_string();
        let packets: Vec<_> = packets().collect();
        let state = Arc::new(State {
            start: Instant::now(),
            sent_at: AtomicU64::new(0),
            is_silent: AtomicBool::new(false),
            is_stopped: AtomicBool::new(false),
        });
        let sender = Arc::clone(&state);
        thread::spawn(move || send(&sender, loopback, packets));
        Self { source, state }
    }

    /// Sends no more packets, and keeps the line open.
    pub fn fall_silent(&self) {
        self.state.is_silent.store(true, Ordering::Relaxed);
    }

    /// Returns the time since the latest packet was complete.
    pub fn since_packet(&self) -> Duration {
        let now = self.state.start.elapsed();
        let sent_at = Duration::from_nanos(self.state.sent_at.load(Ordering::Relaxed));
        now.saturating_sub(sent_at)
    }
}

impl Drop for Glove {
    fn drop(&mut self) {
        // The thread may wait for a program that has ended.
        self.state.is_stopped.store(true, Ordering::Relaxed);
    }
}

fn send(state: &State, mut loopback: Loopback, mut packets: Vec<[u8; PACKET_BYTES]>) {
    raise_thread_priority();
    // The header of the next packet, which completes one, follows at once.
    let header = &packets[0][..PACKET_BYTES - BODY_BYTES];
    loopback.writer.write_all(header).expect("the line is open");
    for packet in &mut packets {
        packet.rotate_left(PACKET_BYTES - BODY_BYTES);
    }
    for (number, packet) in (0..).zip(packets.iter().cycle()) {
        let due = Duration::from_secs(1) * number / RATE_HZ;
        thread::sleep(due.saturating_sub(state.start.elapsed()));
        if state.is_stopped.load(Ordering::Relaxed) {
            return;
        }
        if state.is_silent.load(Ordering::Relaxed) {
            continue;
        }
        let now = state.start.elapsed().as_nanos() as u64;
        state.sent_at.store(now, Ordering::Relaxed);
        if loopback.writer.write_all(packet).is_err() {
            return;
        }
    }
}
