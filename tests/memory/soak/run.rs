//! The run: the bytes of the glove, the event loop around the pipeline, and the faults.

use std::time::Duration;

use ademan::capture::hc11::{self, Hc11Decoder, PACKET_BYTES, encode};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Reading, Sample};
use ademan::command::CommandOrigin;
use ademan::device::{EventKind, Events};
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;
use fastrand::Rng;
use parry3d::math::Vec3;

use super::schedule::{FaultKind, schedule};
use super::setup::{Body, SoakSetup};
use super::stats::{SoakStats, resident};
use crate::steady_state::live_bytes;
use crate::support::checked::CheckedPipeline;

const SECOND: u64 = 1_000_000;

pub struct SoakRun<'a> {
    setup: &'a SoakSetup,
    pipeline: CheckedPipeline,
    decoder: Hc11Decoder,
    random: Rng,
    stats: SoakStats,
    /// The time in microseconds on the monotonic clock.
    now: u64,
    clock_offset: i64,
    /// The time of the last reading.
    last: u64,
    last_reading_at: u64,
    state: PipelineState,
    was_paused: bool,
    /// The movement of the hand, and the index of its next packet.
    movement: (&'a [Body], usize),
    /// The end of a railed channel, its index and its count.
    rail: Option<(u64, usize, u8)>,
    /// The end of swapped sides.
    swapped: u64,
    /// The end of the current pause.
    paused: Option<u64>,
    /// The number of packets with a flipped bit that are still to come.
    flips: u32,
    /// The end of the time in which the process is stopped and drops readings.
    stopped_until: u64,
    copy: Option<&'a mut Vec<u8>>,
}

impl<'a> SoakRun<'a> {
    pub fn new(setup: &'a SoakSetup, seed: u64) -> Self {
        let mut pipeline = CheckedPipeline::new(&setup.loaded);
        pipeline.tolerate_packet_period(setup.format.packet_period());
        Self {
            pipeline,
            decoder: Hc11Decoder::new(setup.format.framing),
            random: Rng::with_seed(seed),
            stats: SoakStats::default(),
            // Far enough from 0 that the clock can be set back.
            now: 3_600 * SECOND,
            clock_offset: 0,
            last: 0,
            last_reading_at: 0,
            state: PipelineState::Starting,
            was_paused: false,
            movement: (&setup.movements[0][0], 0),
            rail: None,
            swapped: 0,
            paused: None,
            flips: 0,
            stopped_until: 0,
            copy: None,
            setup,
        }
    }

    /// Copies all bytes of the line to a buffer.
    pub fn copy_bytes(&mut self, bytes: &'a mut Vec<u8>) {
        self.copy = Some(bytes);
    }

    /// Plays this many hours with this many faults, then stops the pipeline, and returns the statistics.
    pub fn play(&mut self, hours: f64, faults: usize) -> SoakStats {
        let length = (hours * 3_600.0 * SECOND as f64) as u64;
        let start = self.now;
        let mut coming = schedule(&mut self.random, faults, length);
        let mut quarter = 1;
        // Silence makes a day longer than its packets; the rest of the schedule follows without delay.
        while self.now < start + length || !coming.is_empty() {
            while let Some((_, kind)) = coming.pop_if(|(time, _)| start + *time <= self.now) {
                *self.stats.faults.entry(kind).or_default() += 1;
                self.apply(kind);
            }
            self.send_packet();
            if quarter <= 4 && self.now >= start + length / 4 * quarter {
                self.stats.resident.extend(resident());
                // The copy of the bytes grows.
                if self.copy.is_none() {
                    self.stats.live_bytes.push(live_bytes());
                }
                quarter += 1;
            }
        }
        self.command(CheckedPipeline::stop);
        assert!(
            !self.pipeline.has_pressed(),
            "a key stays pressed after the end"
        );
        let mut stats = std::mem::take(&mut self.stats);
        stats.hours = hours;
        stats.line = self.decoder.stats();
        stats.waiting = self.decoder.pending_bytes() as u64;
        stats.accepted = self.pipeline.accepted();
        stats.rejected = self.pipeline.rejected();
        stats.stalls = self.pipeline.stalls();
        stats.suppressed = self.pipeline.suppressed().total();
        stats
    }

    fn apply(&mut self, kind: FaultKind) {
        let now = self.now;
        match kind {
            FaultKind::Stall => self.stay_silent(SECOND / 20, 3 * SECOND),
            FaultKind::Unplug => {
                self.decoder.reset();
                self.command(CheckedPipeline::stall);
                self.stay_silent(SECOND / 10, 5 * SECOND);
            }
            FaultKind::Noise => {
                let noise: Vec<u8> = (0..self.random.usize(1..2_000))
                    .map(|_| self.random.u8(..))
                    .collect();
                noise
                    .chunks(PACKET_BYTES)
                    .for_each(|piece| self.receive(piece));
            }
            FaultKind::FlippedBits => self.flips = self.random.u32(1..20),
            FaultKind::TruncatedPacket => {
                let packet = self.next_packet();
                let length = self.random.usize(1..PACKET_BYTES);
                let from = self.random.usize(..PACKET_BYTES - length);
                self.stats.sent += 1;
                self.receive(&packet[from..from + length]);
            }
            FaultKind::DuplicatePacket => {
                let packet = self.next_packet();
                self.stats.sent += 2;
                self.stats.whole += 2;
                self.receive(&packet);
                self.receive(&packet);
            }
            FaultKind::ClockAhead => {
                let longest = [SECOND / 100, SECOND, 3_600 * SECOND][self.random.usize(..3)];
                let by = self.random.u64(1..=longest);
                self.clock_offset += by as i64;
            }
            FaultKind::ClockBack => self.clock_offset -= self.random.u64(1..5 * SECOND) as i64,
            FaultKind::ValidLayout => self.reload(),
            FaultKind::InvalidLayout => self.read_invalid_layout(),
            FaultKind::Pause => {
                self.command(|pipeline, events| {
                    pipeline.pause(CommandOrigin::Client, events);
                });
                self.paused = Some(now + self.random.u64(SECOND / 2..5 * SECOND));
            }
            FaultKind::Profile => {
                let profile = self.random.usize(..self.pipeline.profile_count());
                self.command(|pipeline, events| pipeline.switch_profile(profile, events));
            }
            FaultKind::Rail => {
                let glove = self.setup.loaded.glove.as_ref().expect("a glove");
                let rows = glove.map.rows();
                let channel = rows[self.random.usize(..rows.len())].channel;
                let until = now + self.random.u64(SECOND / 5..4 * SECOND);
                self.rail = Some((until, channel, [0, 255][self.random.usize(..2)]));
            }
            FaultKind::SwappedSides => {
                self.swapped = now + self.random.u64(SECOND / 20..2 * SECOND);
            }
            FaultKind::StopProcess => {
                self.stopped_until = now + self.random.u64(SECOND / 20..2 * SECOND);
            }
            FaultKind::MovedBoards => self.move_boards(),
        }
    }

    fn reload(&mut self) {
        let layout = &self.setup.replacements[self.random.usize(..self.setup.replacements.len())];
        let controls = self.setup.loaded.layout_instance(layout);
        let mut controls = controls.expect("it names no other layout");
        self.command(|pipeline, events| pipeline.replace_profile(0, &mut controls, layout, events));
    }

    /// Reads a truncated layout file, which is refused.
    fn read_invalid_layout(&mut self) {
        let layout = &self.setup.loaded.layout;
        let end = layout.text.trim_end().len() - 1;
        let cut = (0..self.random.usize(..end)).rfind(|&at| layout.text.is_char_boundary(at));
        let text = &layout.text[..cut.unwrap_or(0)];
        assert!(Layout::parse(text, "half.ron").is_err(), "{text}");
    }

    fn move_boards(&mut self) {
        let by = [(); 3].map(|()| self.random.f32() * 0.01 - 0.005);
        let is_to_hand = by[0] > 0.003;
        // A refused move leaves the boards where they are.
        self.command(|pipeline, events| {
            let _ = if is_to_hand {
                pipeline.recenter(events)
            } else {
                pipeline.nudge(Vec3::from_array(by), events)
            };
        });
    }

    /// Sends the next packet of the hand, with its faults.
    fn send_packet(&mut self) {
        if self.paused.is_some_and(|until| until <= self.now) {
            self.paused = None;
            self.command(|pipeline, _| pipeline.resume(CommandOrigin::Client));
        }
        // Presses beyond the rate limit pause the session; the user resumes it.
        if self.paused.is_none() && self.pipeline.is_paused() {
            self.paused = Some(self.now + SECOND);
        }
        let mut packet = self.next_packet();
        self.stats.sent += 1;
        if self.flips > 0 {
            self.flips -= 1;
            packet[self.random.usize(..PACKET_BYTES)] ^= 1 << self.random.u32(..8);
        } else {
            self.stats.whole += 1;
        }
        self.receive(&packet);
    }

    fn next_packet(&mut self) -> [u8; PACKET_BYTES] {
        if self.movement.1 == self.movement.0.len() {
            let movements = &self.setup.movements[self.pipeline.active_profile()];
            let index = self.random.usize(..movements.len());
            self.movement = (&movements[index], 0);
        }
        let mut body = self.movement.0[self.movement.1];
        self.movement.1 += 1;
        let channel = self.random.usize(..body.len());
        body[channel] = body[channel]
            .saturating_add(self.random.u8(..2))
            .clamp(1, 254);
        match self.rail {
            Some((until, broken, count)) if self.now < until => body[broken] = count,
            _ => self.rail = None,
        }
        encode(self.setup.format.framing, &body)
    }

    /// Receives bytes; each packet is dated back by the bytes after it, as by a source.
    fn receive(&mut self, bytes: &[u8]) {
        self.now += self.setup.format.transmission_time(bytes.len()).as_micros() as u64;
        self.check_stall();
        self.stats.sent_bytes += bytes.len() as u64;
        if let Some(copy) = &mut self.copy {
            copy.extend_from_slice(bytes);
        }
        let mut bodies = arrayvec::ArrayVec::<Body, 2>::new();
        self.decoder.push(bytes, &mut |packet| {
            bodies.push(hc11::body(&packet.sample).expect("channels"));
        });
        let waiting = self.decoder.pending_bytes();
        for (index, body) in bodies.iter().enumerate() {
            let after = (bodies.len() - 1 - index) * PACKET_BYTES + waiting;
            self.read(
                body,
                self.setup.format.transmission_time(after).as_micros() as u64,
            );
        }
    }

    fn read(&mut self, body: &Body, microseconds_ago: u64) {
        if self.now < self.stopped_until {
            // A stopped process drops all but the newest reading.
            self.stats.dropped += 1;
            return;
        }
        let side = if self.now < self.swapped {
            Side::Left
        } else {
            Side::Right
        };
        self.last = (self.now - microseconds_ago).max(self.last + 1);
        let time = self.last.saturating_add_signed(self.clock_offset);
        let reading = Reading::new(
            Timestamp(time),
            Some(side),
            Sample::Channels(hc11::channels(body)),
        );
        let mut events = Events::new();
        if self.pipeline.step(&reading, &mut events).is_ok() {
            self.last_reading_at = self.now;
        }
        self.count(&events, false);
    }

    fn stay_silent(&mut self, shortest: u64, longest: u64) {
        let end = self.now + self.random.u64(shortest..longest);
        while self.now < end {
            self.now = (self.now + 10_000).min(end);
            self.check_stall();
        }
    }

    /// Reports a stall as the event loop does.
    fn check_stall(&mut self) {
        let silence = Duration::from_micros(self.now - self.last_reading_at);
        if self.pipeline.expects_readings()
            && silence >= self.pipeline.stall_timeout()
            && self.now >= self.stopped_until
        {
            self.command(CheckedPipeline::stall);
        }
    }

    fn command(&mut self, command: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        let mut events = Events::new();
        command(&mut self.pipeline, &mut events);
        self.count(&events, true);
    }

    fn count(&mut self, events: &Events, is_forced: bool) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.stats.keys.entry(key.name()).or_default().0 += 1,
                EventKind::KeyUp(key) => {
                    self.stats.keys.entry(key.name()).or_default().1 += 1;
                    self.stats.forced += u64::from(is_forced);
                }
                _ => self.stats.other_events += 1,
            }
        }
        let is_paused = self.pipeline.is_paused();
        self.stats.pauses += u64::from(is_paused && !self.was_paused);
        self.was_paused = is_paused;
        let state = self.pipeline.state();
        let has_armed = self.state != PipelineState::Running && state == PipelineState::Running;
        self.stats.armed += u64::from(has_armed);
        self.state = state;
    }
}
