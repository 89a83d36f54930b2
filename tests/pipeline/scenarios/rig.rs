//! The rig for a simulated hand with a glove: from the bytes of its packets to events, without a clock.

use std::time::Duration;

use ademan::capture::hc11::{self, BODY_BYTES, Hc11Decoder, PACKET_BYTES, encode};
use ademan::capture::protocol::Decoder;
use ademan::capture::{Hc11Format, Reading, Sample};
use ademan::command::CommandOrigin;
use ademan::contact::TargetNames;
use ademan::device::{Events, TimedCommand};
use ademan::estimate::Rejection;
use ademan::files::Load;
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

/// The time at which a scenario begins, in microseconds: far enough from 0 that the clock can be set back.
const START: u64 = 10_000_000_000;

/// Plays a scenario and replaces its transcript. The oracle checks every step.
pub fn play(scenario: &mut Scenario) {
    let setup = setup(&scenario.setup);
    let loaded = setup
        .load_files()
        .unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
    let mut rig = Rig::new(&loaded, scenario);
    let mut orders = 0;
    let count = scenario.lines.len();
    for (index, line) in scenario.lines.iter_mut().enumerate() {
        for step in line.steps() {
            match Directive::parse(step) {
                Some(directive) => rig.apply(directive),
                None => {
                    orders += 1;
                    rig.play_until(|typist| typist.has_finished(orders));
                }
            }
        }
        if index + 1 == count {
            rig.finish();
        }
        line.words = rig.transcript.take();
    }
}

/// Parses a setup: a shipped layout or a file of `tests/scenarios`, then, separated by commas, `armed`, `two hands`,
/// `profile NAME`, `stall MS` and `presses PER_SECOND`.
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
                text: None,
                layout: path_of(rest),
            }),
            "stall" => setup.stall_timeout_ms = rest.parse().expect("milliseconds"),
            "presses" => setup.max_presses_per_second = Some(rest.parse().expect("a number")),
            _ => panic!("unknown `{part}` in `setup: {text}`"),
        }
    }
    setup
}

fn path_of(layout: &str) -> String {
    let path = folder().join(layout);
    if path.is_file() {
        path.display().to_string()
    } else {
        layout.to_owned()
    }
}

/// A simulated glove and its decoder.
struct SimulatedGlove {
    side: Side,
    glove: Glove,
    decoder: Hc11Decoder,
    /// The time of its last reading, in microseconds on the monotonic clock.
    last: u64,
    /// The channel counts of the current posture.
    counts: GloveCounts,
}

struct Rig<'a> {
    setup: &'a LoadedSetup,
    typist: SimulatedTypist,
    pipeline: CheckedPipeline,
    gloves: Vec<SimulatedGlove>,
    format: Hc11Format,
    transcript: Transcript,
    /// The names of the targets of the active layout, and its index.
    names: TargetNames,
    profile: usize,
    has_new_names: bool,
    state: PipelineState,
    /// The time in microseconds on the monotonic clock.
    now: u64,
    /// The difference of the time stamps to the monotonic clock, in microseconds.
    clock_offset: i64,
    last_reading_at: u64,
    /// The fault of the next packet.
    next: Option<Directive>,
    elbow_offset: i32,
    rail: Option<(Finger, u8)>,
    is_swapped: bool,
    random: fastrand::Rng,
}

impl<'a> Rig<'a> {
    fn new(setup: &'a LoadedSetup, scenario: &Scenario) -> Self {
        let format = Hc11Format::default();
        let orders = scenario.lines.iter().flat_map(|line| line.steps());
        let orders = orders.filter(|step| Directive::parse(step).is_none());
        // A script needs at least one order of the hand.
        let orders = orders.chain(["wait 0"]);
        let script = orders.collect::<Vec<_>>().join("\n");
        let typist = setup.scripted(&script, &format, 0.0, 0);
        let typist = typist.unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
        let other = setup.other_hand.iter().map(|other| &other.glove);
        let simulated = |glove: &Glove| SimulatedGlove {
            side: glove.side,
            glove: glove.clone(),
            decoder: Hc11Decoder::new(format.framing),
            last: 0,
            counts: GloveCounts::new(),
        };
        Self {
            setup,
            typist,
            pipeline: CheckedPipeline::new(setup),
            gloves: std::iter::once(&setup.glove)
                .chain(other)
                .flatten()
                .map(simulated)
                .collect(),
            format,
            transcript: Transcript::new(Detail::Summary, Timestamp(START)),
            names: setup.layout.target_names(),
            profile: 0,
            has_new_names: false,
            state: PipelineState::Starting,
            now: START,
            clock_offset: 0,
            last_reading_at: START,
            next: None,
            elbow_offset: 0,
            rail: None,
            is_swapped: false,
            random: fastrand::Rng::with_seed(1),
        }
    }

    /// Plays packets until a condition holds or the hand has finished.
    fn play_until(&mut self, is_done: impl Fn(&SimulatedTypist) -> bool) {
        while !is_done(&self.typist) && self.play_packet() {}
    }

    /// Plays one packet of each glove; returns `false` if the hand has finished.
    fn play_packet(&mut self) -> bool {
        let moved = self.advance_hand();
        if moved {
            self.send_packets();
        }
        moved
    }

    /// Moves the hand to its next posture; returns `false` if it has finished.
    fn advance_hand(&mut self) -> bool {
        let Some(counts_by_hand) = self.typist.next_packets() else {
            return false;
        };
        for (line, counts) in self.gloves.iter_mut().zip(counts_by_hand) {
            line.counts = counts;
        }
        true
    }

    /// Plays to the end, stops the pipeline and adds the statistics.
    fn finish(&mut self) {
        self.play_until(|_| false);
        let before = self.pipeline.rejected();
        self.command(CheckedPipeline::stop);
        assert!(
            !self.pipeline.has_pressed(),
            "a key stays pressed after the end"
        );
        let mut stats: Vec<String> = Rejection::ALL
            .iter()
            .zip(before)
            .filter(|(_, count)| *count > 0)
            .map(|(reason, count)| format!("{reason} {count}"))
            .collect();
        let counts = self.gloves.iter().map(|line| line.decoder.stats());
        let skipped: u64 = counts.map(|counts| counts.skipped_bytes).sum();
        for (name, count) in [
            ("skipped", skipped),
            ("stalls", self.pipeline.stalls()),
            ("suppressed", self.pipeline.suppressed().total()),
        ] {
            if count > 0 {
                stats.push(format!("{name} {count}"));
            }
        }
        if !stats.is_empty() {
            self.transcript.note(format!("({})", stats.join(", ")));
        }
    }

    fn apply(&mut self, directive: Directive) {
        match directive {
            Directive::Play(milliseconds) => {
                let end = self.now + milliseconds * 1_000;
                while self.now < end && self.play_packet() {}
            }
            Directive::Hold(milliseconds) => {
                if self.gloves[0].counts.is_empty() {
                    self.advance_hand();
                }
                let end = self.now + milliseconds * 1_000;
                while self.now < end {
                    self.send_packets();
                }
            }
            Directive::Silent(milliseconds) => self.stay_silent(milliseconds * 1_000),
            Directive::Drop(milliseconds) => {
                let end = self.now + milliseconds * 1_000;
                while self.now < end && self.advance_hand() {
                    self.stay_silent(self.period());
                }
                self.drop_partial_packets();
            }
            Directive::Unplug(milliseconds) => {
                self.drop_partial_packets();
                self.command(CheckedPipeline::stall);
                self.stay_silent(milliseconds * 1_000);
            }
            Directive::Noise(bytes) => {
                let junk: Vec<u8> = (0..bytes).map(|_| self.random.u8(..)).collect();
                self.receive_noise(&junk);
            }
            Directive::Text(text) => self.receive_noise(format!("\r\n{text}\r\n").as_bytes()),
            Directive::Flip(_)
            | Directive::Truncate(_)
            | Directive::Skip(_)
            | Directive::Duplicate => {
                self.next = Some(directive);
            }
            Directive::Offset(counts) => self.elbow_offset = counts,
            Directive::Rail(finger, count) => self.rail = Some((finger, count)),
            Directive::Repair => (self.rail, self.elbow_offset) = (None, 0),
            Directive::Clock(seconds) => self.clock_offset += seconds * 1_000_000,
            Directive::Swap => self.is_swapped = !self.is_swapped,
            Directive::Pause => self.command(|pipeline, events| {
                pipeline.pause(CommandOrigin::Client, events);
            }),
            Directive::Resume => self.command(|pipeline, _| {
                pipeline.resume(CommandOrigin::Client);
            }),
            Directive::Stop => self.command(CheckedPipeline::stop),
            Directive::Reload(name) => self.reload(&name),
            Directive::Profile(index) => {
                self.command(|pipeline, events| pipeline.switch_profile(index, events))
            }
            Directive::Nudge(by) => self.move_boards(|pipeline, events| {
                pipeline.nudge(Vec3::from_array(by) * 1e-3, events).is_ok()
            }),
            Directive::Tilt(by) => {
                self.move_boards(|pipeline, events| pipeline.tilt(by.to_radians(), events).is_ok())
            }
            Directive::Recenter => {
                self.move_boards(|pipeline, events| pipeline.recenter(events).is_ok())
            }
        }
    }

    fn reload(&mut self, name: &str) {
        let layout = Layout::load(&path_of(name)).map_err(|error| error.to_string());
        let controls = layout.and_then(|layout| match self.setup.layout_instance(&layout) {
            Ok(controls) => Ok((layout, controls)),
            Err(error) => Err(error.to_string()),
        });
        match controls {
            Ok((built, mut controls)) => {
                self.has_new_names = true;
                self.command(|pipeline, events| {
                    pipeline.replace_profile(0, &mut controls, &built, events)
                });
            }
            Err(_) => self.transcript.note("(refused)".into()),
        }
    }

    fn move_boards(&mut self, command: impl FnOnce(&mut CheckedPipeline, &mut Events) -> bool) {
        let mut is_done = true;
        self.command(|pipeline, events| is_done = command(pipeline, events));
        if !is_done {
            self.transcript.note("(refused)".into());
        }
    }

    fn period(&self) -> u64 {
        self.format.packet_period().as_micros() as u64
    }

    /// Converts a time on the monotonic clock to a time stamp.
    fn time(&self, moment: u64) -> Timestamp {
        Timestamp(moment.saturating_add_signed(self.clock_offset))
    }

    fn drop_partial_packets(&mut self) {
        self.gloves.iter_mut().for_each(|line| line.decoder.reset());
    }

    /// Lets time pass without bytes.
    fn stay_silent(&mut self, microseconds: u64) {
        let end = self.now + microseconds;
        while self.now < end {
            self.now = (self.now + 1_000).min(end);
            self.check_stall();
        }
    }

    /// Reports a stall as the event loop does.
    fn check_stall(&mut self) {
        let silence = Duration::from_micros(self.now - self.last_reading_at);
        if self.pipeline.expects_readings() && silence >= self.pipeline.stall_timeout() {
            self.command(CheckedPipeline::stall);
        }
    }

    /// Sends a packet of each glove.
    fn send_packets(&mut self) {
        self.now += self.period();
        self.check_stall();
        let fault = self.next.take();
        for index in 0..self.gloves.len() {
            let mut packet = encode(self.format.framing, &self.body(index)).to_vec();
            match fault {
                Some(Directive::Flip(byte)) => packet[byte] ^= 0x80,
                Some(Directive::Truncate(bytes)) => packet.truncate(PACKET_BYTES - bytes),
                Some(Directive::Skip(bytes)) => drop(packet.drain(..bytes)),
                Some(Directive::Duplicate) => packet.extend_from_within(..),
                _ => {}
            }
            self.receive(index, &packet);
        }
    }

    fn body(&self, index: usize) -> [u8; BODY_BYTES] {
        let simulated = &self.gloves[index];
        let mut body = [0; BODY_BYTES];
        for (byte, count) in body.iter_mut().zip(&simulated.counts) {
            *byte = (*count).min(255) as u8;
        }
        let map = &simulated.glove.map;
        for row in map.rows() {
            if row.dof == Dof::ElbowFlexion {
                let shown = i32::from(simulated.counts[row.channel]);
                body[row.channel] = (shown + self.elbow_offset).clamp(1, 254) as u8;
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

    /// Receives bytes outside of packets on the line of the first glove.
    fn receive_noise(&mut self, bytes: &[u8]) {
        for piece in bytes.chunks(PACKET_BYTES) {
            self.now += self.format.transmission_time(piece.len()).as_micros() as u64;
            self.check_stall();
            self.receive(0, piece);
        }
    }

    /// Receives bytes; each packet is dated back by the bytes after it, as by a source.
    fn receive(&mut self, glove: usize, bytes: &[u8]) {
        let mut bodies = Vec::new();
        let simulated = &mut self.gloves[glove];
        simulated.decoder.push(bytes, &mut |packet| {
            bodies.push(hc11::body(&packet.sample).expect("channels"));
        });
        let waiting = simulated.decoder.pending_bytes();
        let side = if self.is_swapped {
            simulated.side.opposite()
        } else {
            simulated.side
        };
        for (index, body) in bodies.iter().enumerate() {
            let after = (bodies.len() - 1 - index) * PACKET_BYTES + waiting;
            let after = self.format.transmission_time(after).as_micros() as u64;
            let dated = &mut self.gloves[glove];
            dated.last = (self.now - after).max(dated.last + 1);
            let moment = dated.last;
            let reading = Reading::new(
                self.time(moment),
                (self.gloves.len() > 1).then_some(side),
                Sample::Channels(hc11::channels(body)),
            );
            let mut events = Events::new();
            let step = self.pipeline.step(&reading, &mut events);
            let commands = step.map(|step| step.commands.clone());
            if commands.is_ok() {
                self.last_reading_at = self.now;
            }
            self.write(&events, &commands.unwrap_or_default(), reading.time);
        }
    }

    fn command(&mut self, command: impl FnOnce(&mut CheckedPipeline, &mut Events)) {
        let mut events = Events::new();
        command(&mut self.pipeline, &mut events);
        self.write(&events, &[], self.time(self.now));
    }

    fn write(&mut self, events: &Events, commands: &[TimedCommand], time: Timestamp) {
        let state = self.pipeline.state();
        let has_armed = state == PipelineState::Running && self.state != state;
        if has_armed {
            self.write_state(state, time);
        }
        // The events belong to the layout that was active before.
        for command in commands {
            self.transcript.push_command(command);
        }
        for event in events {
            self.transcript.push(event, &self.names);
        }
        if self.profile != self.pipeline.active_profile() || self.has_new_names {
            self.profile = self.pipeline.active_profile();
            self.names = self.pipeline.target_names().clone();
            self.has_new_names = false;
        }
        if state != self.state {
            self.write_state(state, time);
        }
    }

    fn write_state(&mut self, state: PipelineState, time: Timestamp) {
        self.state = state;
        self.transcript.word(time, format!("={state}"));
    }
}
