//! A run in which time and bytes are the scenario's: from the packets of simulated gloves to events.

use std::time::Duration;

use ademan::capture::hc11::{self, BODY_BYTES, Hc11Decoder, PACKET_BYTES, encode};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::contact::TargetNames;
use ademan::device::{Events, TimedCommand};
use ademan::estimate::Rejection;
use ademan::hand::{Dof, Finger, Side};
use ademan::layout::{Glove, Layout};
use ademan::pipeline::PipelineState;
use ademan::setup::{LoadedSetup, OtherHand, ProfileSetup, Setup};
use ademan::sim::{GloveCounts, SimulatedTypist};
use ademan::time::Timestamp;
use parry3d::math::Vec3;

use super::directive::Directive;
use super::file::Scenario;
use super::folder;
use crate::rig::transcript::{Detail, Transcript};
use crate::support::checked::CheckedPipeline;

/// When a scenario begins on the clock of its source: far enough from 0 that it can be set back.
const START: u64 = 10_000_000_000;

/// Plays a scenario under an oracle and writes down what goes out.
pub fn play(scenario: &mut Scenario) {
    let setup = setup(&scenario.setup);
    let assembly = setup
        .load_files()
        .unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
    let mut rig = Rig::new(&assembly, scenario);
    let mut orders = 0;
    let count = scenario.lines.len();
    for (place, line) in scenario.lines.iter_mut().enumerate() {
        for piece in line.pieces() {
            match Directive::parse(piece) {
                Some(fault) => rig.meet(fault),
                None => {
                    orders += 1;
                    rig.play_until(|typist| typist.has_finished(orders));
                }
            }
        }
        if place + 1 == count {
            rig.finish();
        }
        line.words = rig.transcript.take();
    }
}

/// `qwerty-flat`, or a file of this folder; then, apart by commas, `armed`, `two hands`, `profile NAME`,
/// `stall MS`, `presses PER_SECOND`.
fn setup(text: &str) -> Setup {
    let mut parts = text.split(',').map(str::trim);
    let mut setup = Setup {
        layout: path_of(parts.next().expect("a layout")),
        ..Setup::default()
    };
    for part in parts {
        let (word, rest) = part.split_once(' ').unwrap_or((part, ""));
        match word {
            "armed" => setup.arm_immediately = true,
            "two" => setup.other_hand = Some(OtherHand::default()),
            "profile" => setup.profiles.push(ProfileSetup {
                name: rest.trim_end_matches(".ron").into(),
                layout: path_of(rest),
            }),
            "stall" => setup.stall_timeout_ms = rest.parse().expect("milliseconds"),
            "presses" => setup.max_presses_per_second = Some(rest.parse().expect("a number")),
            _ => panic!("unknown `{part}` in `on: {text}`"),
        }
    }
    setup
}

fn path_of(layout: &str) -> String {
    let path = folder().join(layout);
    match path.is_file() {
        true => path.display().to_string(),
        false => layout.to_owned(),
    }
}

/// A glove's line and what is wrong with it.
struct SimulatedGlove {
    side: Side,
    glove: Glove,
    decoder: Hc11Decoder,
    /// When its last reading was complete, on the clock that nobody sets.
    last: u64,
    /// The counts that the glove shows.
    shown: GloveCounts,
}

struct Rig<'a> {
    assembly: &'a LoadedSetup,
    typist: SimulatedTypist,
    engine: CheckedPipeline,
    lines: Vec<SimulatedGlove>,
    settings: Hc11Format,
    transcript: Transcript,
    /// What targets are called, and of which layout that is.
    names: TargetNames,
    profile: usize,
    is_renamed: bool,
    state: PipelineState,
    /// In µs, on the clock that nobody sets.
    now: u64,
    /// By how much the times of readings are off it.
    clock_offset: i64,
    fed_at: u64,
    /// What is wrong with the next packet.
    next: Option<Directive>,
    jump: i32,
    rail: Option<(Finger, u8)>,
    is_swapped: bool,
    random: fastrand::Rng,
}

impl<'a> Rig<'a> {
    fn new(assembly: &'a LoadedSetup, scenario: &Scenario) -> Self {
        let settings = Hc11Format::default();
        let orders = scenario.lines.iter().flat_map(|line| line.pieces());
        let orders = orders.filter(|piece| Directive::parse(piece).is_none());
        // Somebody has to be there, even when the scenario is over before the hand is seen.
        let orders = orders.chain(["wait 0"]);
        let script = orders.collect::<Vec<_>>().join("\n");
        let typist = assembly.scripted(&script, &settings, 0.0, 0);
        let typist = typist.unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
        let other = assembly.other_hand.iter().map(|other| &other.glove);
        let line = |glove: &Glove| SimulatedGlove {
            side: glove.side,
            glove: glove.clone(),
            decoder: Hc11Decoder::new(settings.framing),
            last: 0,
            shown: GloveCounts::new(),
        };
        Self {
            assembly,
            typist,
            engine: CheckedPipeline::new(assembly),
            lines: std::iter::once(&assembly.glove)
                .chain(other)
                .map(line)
                .collect(),
            settings,
            transcript: Transcript::new(Detail::Summary, Timestamp(START)),
            names: assembly.layout.target_names(),
            profile: 0,
            is_renamed: false,
            state: PipelineState::Starting,
            now: START,
            clock_offset: 0,
            fed_at: START,
            next: None,
            jump: 0,
            rail: None,
            is_swapped: false,
            random: fastrand::Rng::with_seed(1),
        }
    }

    /// The hand goes on until something is so, or it has done everything.
    fn play_until(&mut self, is_enough: impl Fn(&SimulatedTypist) -> bool) {
        while !is_enough(&self.typist) && self.play_frame() {}
    }

    /// Whether there was a frame left.
    fn play_frame(&mut self) -> bool {
        let moved = self.move_on();
        if moved {
            self.send_packets();
        }
        moved
    }

    fn move_on(&mut self) -> bool {
        let Some(frame) = self.typist.next_packets() else {
            return false;
        };
        for (line, counts) in self.lines.iter_mut().zip(frame) {
            line.shown = counts;
        }
        true
    }

    /// The end of everything: all must be let go of.
    fn finish(&mut self) {
        self.play_until(|_| false);
        let before = self.engine.rejected();
        self.ask(CheckedPipeline::stop);
        assert!(
            !self.engine.has_pressed(),
            "something is down after the end"
        );
        let mut account: Vec<String> = Rejection::ALL
            .iter()
            .zip(before)
            .filter(|(_, count)| *count > 0)
            .map(|(reason, count)| format!("{reason} {count}"))
            .collect();
        let counts = self.lines.iter().map(|line| line.decoder.stats());
        let skipped: u64 = counts.map(|counts| counts.skipped_bytes).sum();
        for (what, count) in [
            ("skipped", skipped),
            ("stalls", self.engine.stalls()),
            ("withheld", self.engine.suppressed().total()),
        ] {
            if count > 0 {
                account.push(format!("{what} {count}"));
            }
        }
        if !account.is_empty() {
            self.transcript.note(format!("({})", account.join(", ")));
        }
    }

    fn meet(&mut self, fault: Directive) {
        match fault {
            Directive::Play(milliseconds) => {
                let end = self.now + milliseconds * 1_000;
                while self.now < end && self.play_frame() {}
            }
            Directive::Hold(milliseconds) => {
                if self.lines[0].shown.is_empty() {
                    self.move_on();
                }
                let end = self.now + milliseconds * 1_000;
                while self.now < end {
                    self.send_packets();
                }
            }
            Directive::Silent(milliseconds) => self.be_silent(milliseconds * 1_000),
            Directive::Drop(milliseconds) => {
                let end = self.now + milliseconds * 1_000;
                while self.now < end && self.move_on() {
                    self.be_silent(self.period());
                }
                self.abandon();
            }
            Directive::Unplug(milliseconds) => {
                self.abandon();
                self.ask(CheckedPipeline::stall);
                self.be_silent(milliseconds * 1_000);
            }
            Directive::Noise(bytes) => {
                let junk: Vec<u8> = (0..bytes).map(|_| self.random.u8(..)).collect();
                self.hear_elsewhere(&junk);
            }
            Directive::Text(text) => self.hear_elsewhere(format!("\r\n{text}\r\n").as_bytes()),
            Directive::Flip(_)
            | Directive::Truncate(_)
            | Directive::Skip(_)
            | Directive::Duplicate => {
                self.next = Some(fault);
            }
            Directive::Offset(counts) => self.jump = counts,
            Directive::Rail(finger, count) => self.rail = Some((finger, count)),
            Directive::Repair => (self.rail, self.jump) = (None, 0),
            Directive::Clock(seconds) => self.clock_offset += seconds * 1_000_000,
            Directive::Swap => self.is_swapped = !self.is_swapped,
            Directive::Pause => self.ask(CheckedPipeline::pause),
            Directive::Resume => self.ask(|engine, _| engine.resume()),
            Directive::Stop => self.ask(CheckedPipeline::stop),
            Directive::Reload(name) => self.reload(&name),
            Directive::Profile(place) => {
                self.ask(|engine, events| engine.switch_profile(place, events))
            }
            Directive::Nudge(by) => self
                .shift(|engine, events| engine.nudge(Vec3::from_array(by) * 1e-3, events).is_ok()),
            Directive::Tilt(by) => {
                self.shift(|engine, events| engine.tilt(by.to_radians(), events).is_ok())
            }
            Directive::Recenter => self.shift(|engine, events| engine.recenter(events).is_ok()),
        }
    }

    fn reload(&mut self, name: &str) {
        let layout = Layout::load(&path_of(name)).map_err(|error| error.to_string());
        let controls = layout.and_then(|layout| match self.assembly.controls(&layout) {
            Ok(controls) => Ok((layout, controls)),
            Err(error) => Err(error.to_string()),
        });
        match controls {
            Ok((layout, mut controls)) => {
                self.is_renamed = true;
                self.ask(|engine, events| {
                    engine.replace_profile(0, &mut controls, &layout, events)
                });
            }
            Err(_) => self.transcript.note("(refused)".into()),
        }
    }

    fn shift(&mut self, shift: impl FnOnce(&mut CheckedPipeline, &mut Events) -> bool) {
        let mut is_done = true;
        self.ask(|engine, events| is_done = shift(engine, events));
        if !is_done {
            self.transcript.note("(refused)".into());
        }
    }

    fn period(&self) -> u64 {
        self.settings.packet_period().as_micros() as u64
    }

    /// A moment on the clock of the readings.
    fn time(&self, moment: u64) -> Timestamp {
        Timestamp(moment.saturating_add_signed(self.clock_offset))
    }

    fn abandon(&mut self) {
        self.lines.iter_mut().for_each(|line| line.decoder.reset());
    }

    /// Nothing comes for so many microseconds.
    fn be_silent(&mut self, microseconds: u64) {
        let end = self.now + microseconds;
        while self.now < end {
            self.now = (self.now + 1_000).min(end);
            self.watch();
        }
    }

    /// What the loop around the engine does when readings stay away.
    fn watch(&mut self) {
        let silence = Duration::from_micros(self.now - self.fed_at);
        if self.engine.expects_readings() && silence >= self.engine.stall_timeout() {
            self.ask(CheckedPipeline::stall);
        }
    }

    /// Every glove sends what it shows.
    fn send_packets(&mut self) {
        self.now += self.period();
        self.watch();
        let fault = self.next.take();
        for place in 0..self.lines.len() {
            let mut packet = encode(self.settings.framing, &self.body(place)).to_vec();
            match fault {
                Some(Directive::Flip(byte)) => packet[byte] ^= 0x80,
                Some(Directive::Truncate(bytes)) => packet.truncate(PACKET_BYTES - bytes),
                Some(Directive::Skip(bytes)) => drop(packet.drain(..bytes)),
                Some(Directive::Duplicate) => packet.extend_from_within(..),
                _ => {}
            }
            self.hear(place, &packet);
        }
    }

    fn body(&self, place: usize) -> [u8; BODY_BYTES] {
        let line = &self.lines[place];
        let mut body = [0; BODY_BYTES];
        for (byte, count) in body.iter_mut().zip(&line.shown) {
            *byte = (*count).min(255) as u8;
        }
        let map = &line.glove.map;
        for row in map.rows() {
            if row.dof == Dof::ElbowFlexion {
                let shown = i32::from(line.shown[row.channel]);
                body[row.channel] = (shown + self.jump).clamp(1, 254) as u8;
            }
        }
        if let Some((finger, count)) = self.rail {
            for row in map
                .rows()
                .iter()
                .filter(|row| row.dof.finger() == Some(finger))
            {
                body[row.channel] = count;
            }
        }
        body
    }

    /// Bytes come on the first line that are no packets.
    fn hear_elsewhere(&mut self, bytes: &[u8]) {
        for piece in bytes.chunks(PACKET_BYTES) {
            self.now += self.settings.transmission_time(piece.len()).as_micros() as u64;
            self.watch();
            self.hear(0, piece);
        }
    }

    /// Dates each packet back by what came after it, as lines do.
    fn hear(&mut self, place: usize, bytes: &[u8]) {
        let mut bodies = Vec::new();
        let line = &mut self.lines[place];
        line.decoder.push(bytes, &mut |packet| {
            bodies.push(hc11::body(&packet.sample).expect("channels"));
        });
        let waiting = line.decoder.pending_bytes();
        let side = match self.is_swapped {
            true => line.side.opposite(),
            false => line.side,
        };
        for (index, body) in bodies.iter().enumerate() {
            let after = (bodies.len() - 1 - index) * PACKET_BYTES + waiting;
            let after = self.settings.transmission_time(after).as_micros() as u64;
            let line = &mut self.lines[place];
            line.last = (self.now - after).max(line.last + 1);
            let moment = line.last;
            let reading = Reading {
                time: self.time(moment),
                side: (self.lines.len() > 1).then_some(side),
                sample: Sample::Channels(hc11::channels(body)),
            };
            let mut events = Events::new();
            let step = self.engine.step(&reading, &mut events);
            let commands = step.map(|step| step.commands.clone());
            if commands.is_ok() {
                self.fed_at = self.now;
            }
            self.write(&events, &commands.unwrap_or_default(), reading.time);
        }
    }

    fn ask(&mut self, ask: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        let mut events = Events::new();
        ask(&mut self.engine, &mut events);
        self.write(&events, &[], self.time(self.now));
    }

    fn write(&mut self, events: &Events, commands: &[TimedCommand], time: Timestamp) {
        let state = self.engine.state();
        let has_armed = state == PipelineState::Running && self.state != state;
        if has_armed {
            self.tell_state(state, time);
        }
        // What went out is of the layout that was in force before.
        for command in commands {
            self.transcript.push_command(command);
        }
        for event in events {
            self.transcript.push(event, &self.names);
        }
        if self.profile != self.engine.active_profile() || self.is_renamed {
            self.profile = self.engine.active_profile();
            self.names = self.engine.target_names().clone();
            self.is_renamed = false;
        }
        if state != self.state {
            self.tell_state(state, time);
        }
    }

    fn tell_state(&mut self, state: PipelineState, time: Timestamp) {
        self.state = state;
        self.transcript.word(time, format!("={state}"));
    }
}
