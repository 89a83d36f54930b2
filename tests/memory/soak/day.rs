//! A run through a day: the glove's bytes, the loop around the engine, and what goes wrong.

use std::time::Duration;

use ademan::capture::hc11::{self, Hc11Decoder, PACKET_BYTES, encode};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Reading, Sample};
use ademan::device::{EventKind, Events};
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::pipeline::PipelineState;
use ademan::time::Timestamp;
use fastrand::Rng;
use parry3d::math::Vec3;

use super::account::{SoakStats, resident};
use super::hands::{Body, SoakSetup};
use super::schedule::{FaultKind, schedule};
use crate::support::checked::CheckedPipeline;

const SECOND: u64 = 1_000_000;

pub struct SoakRun<'a> {
    hands: &'a SoakSetup,
    engine: CheckedPipeline,
    decoder: Hc11Decoder,
    random: Rng,
    account: SoakStats,
    /// On the clock that nobody sets, in µs.
    now: u64,
    clock_offset: i64,
    /// When the last reading was complete.
    last: u64,
    fed_at: u64,
    state: PipelineState,
    was_paused: bool,
    /// What the hand plays: the movement, and how far it is.
    movement: (&'a [Body], usize),
    /// Until when a channel reads something else.
    rail: Option<(u64, usize, u8)>,
    /// Until when the sides are swapped.
    swapped: u64,
    /// Until when the run is paused, if it is.
    paused: Option<u64>,
    /// How many more packets have a wrong bit.
    flips: u32,
    /// Until when nobody takes readings.
    standing: u64,
    kept: Option<&'a mut Vec<u8>>,
}

impl<'a> SoakRun<'a> {
    pub fn new(hands: &'a SoakSetup, seed: u64) -> Self {
        let mut engine = CheckedPipeline::new(&hands.assembly);
        engine.tolerate_packet_period(hands.line.packet_period());
        Self {
            engine,
            decoder: Hc11Decoder::new(hands.line.framing),
            random: Rng::with_seed(seed),
            account: SoakStats::default(),
            // So far from 0 that the clock can be set back.
            now: 3_600 * SECOND,
            clock_offset: 0,
            last: 0,
            fed_at: 0,
            state: PipelineState::Starting,
            was_paused: false,
            movement: (&hands.movements[0][0], 0),
            rail: None,
            swapped: 0,
            paused: None,
            flips: 0,
            standing: 0,
            kept: None,
            hands,
        }
    }

    /// Keeps all bytes that come over the line.
    pub fn keep(&mut self, bytes: &'a mut Vec<u8>) {
        self.kept = Some(bytes);
    }

    /// Plays so many hours with so many faults, then stops the run.
    pub fn play(&mut self, hours: f64, faults: usize) -> SoakStats {
        let length = (hours * 3_600.0 * SECOND as f64) as u64;
        let start = self.now;
        let mut coming = schedule(&mut self.random, faults, length);
        let mut quarter = 1;
        // Silence makes a day longer than its packets; what is left of the schedule comes at once.
        while self.now < start + length || !coming.is_empty() {
            while let Some((_, kind)) = coming.pop_if(|(time, _)| start + *time <= self.now) {
                *self.account.faults.entry(kind).or_default() += 1;
                self.meet(kind);
            }
            self.go_on();
            if quarter <= 4 && self.now >= start + length / 4 * quarter {
                self.account.resident.extend(resident());
                quarter += 1;
            }
        }
        self.ask(CheckedPipeline::stop);
        assert!(
            !self.engine.has_pressed(),
            "something is down after the end"
        );
        let mut account = std::mem::take(&mut self.account);
        account.hours = hours;
        account.line = self.decoder.stats();
        account.waiting = self.decoder.pending_bytes() as u64;
        account.accepted = self.engine.accepted();
        account.rejected = self.engine.rejected();
        account.stalls = self.engine.stalls();
        account.withheld = self.engine.suppressed().total();
        account
    }

    fn meet(&mut self, kind: FaultKind) {
        let now = self.now;
        match kind {
            FaultKind::Stall => self.be_silent(SECOND / 20, 3 * SECOND),
            FaultKind::Unplug => {
                self.decoder.reset();
                self.ask(CheckedPipeline::stall);
                self.be_silent(SECOND / 10, 5 * SECOND);
            }
            FaultKind::Noise => {
                let noise: Vec<u8> = (0..self.random.usize(1..2_000))
                    .map(|_| self.random.u8(..))
                    .collect();
                noise
                    .chunks(PACKET_BYTES)
                    .for_each(|piece| self.hear(piece));
            }
            FaultKind::FlippedBits => self.flips = self.random.u32(1..20),
            FaultKind::CutFrame => {
                let packet = self.next_packet();
                let length = self.random.usize(1..PACKET_BYTES);
                let from = self.random.usize(..PACKET_BYTES - length);
                self.account.sent += 1;
                self.hear(&packet[from..from + length]);
            }
            FaultKind::FrameTwice => {
                let packet = self.next_packet();
                self.account.sent += 2;
                self.account.whole += 2;
                self.hear(&packet);
                self.hear(&packet);
            }
            FaultKind::ClockAhead => {
                let longest = [SECOND / 100, SECOND, 3_600 * SECOND][self.random.usize(..3)];
                let by = self.random.u64(1..=longest);
                self.clock_offset += by as i64;
            }
            FaultKind::ClockBack => self.clock_offset -= self.random.u64(1..5 * SECOND) as i64,
            FaultKind::GoodLayout => self.reload(),
            FaultKind::BadLayout => self.read_bad_layout(),
            FaultKind::Pause => {
                self.ask(CheckedPipeline::pause);
                self.paused = Some(now + self.random.u64(SECOND / 2..5 * SECOND));
            }
            FaultKind::Profile => {
                let profile = self.random.usize(..self.engine.profile_count());
                self.ask(|engine, events| engine.switch_profile(profile, events));
            }
            FaultKind::Rail => {
                let rows = self
                    .hands
                    .assembly
                    .glove
                    .as_ref()
                    .expect("a glove")
                    .map
                    .rows();
                let channel = rows[self.random.usize(..rows.len())].channel;
                let until = now + self.random.u64(SECOND / 5..4 * SECOND);
                self.rail = Some((until, channel, [0, 255][self.random.usize(..2)]));
            }
            FaultKind::SwappedSides => {
                self.swapped = now + self.random.u64(SECOND / 20..2 * SECOND);
            }
            FaultKind::StandStill => {
                self.standing = now + self.random.u64(SECOND / 20..2 * SECOND);
            }
            FaultKind::MovedBoards => self.move_boards(),
        }
    }

    fn reload(&mut self) {
        let layout = &self.hands.others[self.random.usize(..self.hands.others.len())];
        let controls = self.hands.assembly.layout_instance(layout);
        let mut controls = controls.expect("it names no other layout");
        self.ask(|engine, events| engine.replace_profile(0, &mut controls, layout, events));
    }

    /// A file that is cut off in its middle is told, and nothing becomes of it.
    fn read_bad_layout(&mut self) {
        let layout = &self.hands.assembly.layout;
        let end = layout.text.trim_end().len() - 1;
        let cut = (0..self.random.usize(..end)).rfind(|&at| layout.text.is_char_boundary(at));
        let text = &layout.text[..cut.unwrap_or(0)];
        assert!(Layout::parse(text, "half.ron").is_err(), "{text}");
    }

    fn move_boards(&mut self) {
        let by = [(); 3].map(|()| self.random.f32() * 0.01 - 0.005);
        let is_to_hand = by[0] > 0.003;
        // Where it cannot be done the boards stay.
        self.ask(|engine, events| {
            let _ = match is_to_hand {
                true => engine.recenter(events),
                false => engine.nudge(Vec3::from_array(by), events),
            };
        });
    }

    /// The next packet of the hand, with what may be wrong with it.
    fn go_on(&mut self) {
        if self.paused.is_some_and(|until| until <= self.now) {
            self.paused = None;
            self.ask(|engine, _| engine.resume());
        }
        // Presses that came too fast pause a run; somebody ends that.
        if self.paused.is_none() && self.engine.is_paused() {
            self.paused = Some(self.now + SECOND);
        }
        let mut packet = self.next_packet();
        self.account.sent += 1;
        if self.flips > 0 {
            self.flips -= 1;
            packet[self.random.usize(..PACKET_BYTES)] ^= 1 << self.random.u32(..8);
        } else {
            self.account.whole += 1;
        }
        self.hear(&packet);
    }

    fn next_packet(&mut self) -> [u8; PACKET_BYTES] {
        if self.movement.1 == self.movement.0.len() {
            let movements = &self.hands.movements[self.engine.active_profile()];
            let place = self.random.usize(..movements.len());
            self.movement = (&movements[place], 0);
        }
        let mut body = self.movement.0[self.movement.1];
        self.movement.1 += 1;
        let channel = self.random.usize(..body.len());
        body[channel] = body[channel]
            .saturating_add(self.random.u8(..2))
            .clamp(1, 254);
        match self.rail {
            Some((until, channel, count)) if self.now < until => body[channel] = count,
            _ => self.rail = None,
        }
        encode(self.hands.line.framing, &body)
    }

    /// Bytes come over the line, and readings of it, dated back by what came after them.
    fn hear(&mut self, bytes: &[u8]) {
        self.now += self.hands.line.transmission_time(bytes.len()).as_micros() as u64;
        self.watch();
        self.account.sent_bytes += bytes.len() as u64;
        if let Some(kept) = &mut self.kept {
            kept.extend_from_slice(bytes);
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
                self.hands.line.transmission_time(after).as_micros() as u64,
            );
        }
    }

    fn read(&mut self, body: &Body, microseconds_ago: u64) {
        if self.now < self.standing {
            // Whoever stands still takes none, and the newer one supersedes it.
            self.account.superseded += 1;
            return;
        }
        let side = match self.now < self.swapped {
            true => Side::Left,
            false => Side::Right,
        };
        self.last = (self.now - microseconds_ago).max(self.last + 1);
        let time = self.last.saturating_add_signed(self.clock_offset);
        let reading = Reading {
            time: Timestamp(time),
            side: Some(side),
            sample: Sample::Channels(hc11::channels(body)),
        };
        let mut events = Events::new();
        if self.engine.step(&reading, &mut events).is_ok() {
            self.fed_at = self.now;
        }
        self.count(&events, false);
    }

    fn be_silent(&mut self, shortest: u64, longest: u64) {
        let end = self.now + self.random.u64(shortest..longest);
        while self.now < end {
            self.now = (self.now + 10_000).min(end);
            self.watch();
        }
    }

    /// What the loop around the engine does when readings stay away.
    fn watch(&mut self) {
        let silence = Duration::from_micros(self.now - self.fed_at);
        if self.engine.expects_readings()
            && silence >= self.engine.stall_timeout()
            && self.now >= self.standing
        {
            self.ask(CheckedPipeline::stall);
        }
    }

    fn ask(&mut self, ask: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        let mut events = Events::new();
        ask(&mut self.engine, &mut events);
        self.count(&events, true);
    }

    fn count(&mut self, events: &Events, is_forced: bool) {
        for event in events {
            match event.kind {
                EventKind::KeyDown(key) => self.account.keys.entry(key.name()).or_default().0 += 1,
                EventKind::KeyUp(key) => {
                    self.account.keys.entry(key.name()).or_default().1 += 1;
                    self.account.forced += u64::from(is_forced);
                }
                _ => self.account.other_events += 1,
            }
        }
        let is_paused = self.engine.is_paused();
        self.account.pauses += u64::from(is_paused && !self.was_paused);
        self.was_paused = is_paused;
        let state = self.engine.state();
        let has_armed = self.state != PipelineState::Running && state == PipelineState::Running;
        self.account.armed += u64::from(has_armed);
        self.state = state;
    }
}
