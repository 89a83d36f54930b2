//! `ademan demo`: a simulated hand types through the whole way, on a line that is real.

mod player;
mod screen;

use std::num::NonZeroU32;

use ademan::capture::{self, LineSettings, open_wire};
use ademan::lab::{Played, TypingScore, UsKeymap};
use ademan::monitor::Snapshot;
use ademan::output;
use ademan::runtime::{Summary, drive};
use ademan::settings::Setup;
use ademan::time::Timestamp;
use crossbeam_channel::bounded;

use crate::args::DemoArgs;
use crate::failure::Failure;
use crate::{signals, status};
use player::Player;
use screen::Screen;

pub fn run(args: &DemoArgs) -> Result<(), Failure> {
    let setup = Setup {
        layout: args.layout.clone(),
        output: args.output.clone(),
        ..Setup::default()
    };
    let assembly = setup.assemble()?;
    let line = LineSettings {
        baud: NonZeroU32::new(args.baud)
            .ok_or_else(|| Failure::wrong_use("a baud is more than 0"))?,
        ..LineSettings::default()
    };
    let typist = assembly.typist(&args.text, &line, args.noise, args.seed)?;
    let asked = signals::stop_requests()?;
    let mut sink = output::open(&assembly.setup.output, &assembly.layout.codes())?;
    let wire = open_wire(line)
        .map_err(|error| Failure::job(format!("cannot open a simulated serial line: {error}")))?;
    println!(
        "a simulated hand types {:?} on {} over {}",
        args.text, assembly.layout.name, wire.source
    );
    let source = capture::open(&wire.source)?;
    let (stop_sender, stop) = bounded(1);
    let mut screen = Screen::open(&assembly.layout, &args.text)?;
    let player = Player::start(typist, wire.writer, line, asked, stop_sender);
    let mut typed = Typed::default();
    let ended = drive(
        source,
        &mut assembly.pipeline(),
        &mut *sink,
        &stop,
        &mut |frame| {
            typed.take(frame);
            screen.show(frame, typed.field.text());
        },
    );
    screen.close();
    let played = player.join()?;
    let score = typed.score(&args.text);
    report(&score, &played, &ended?, &line);
    match score.typed == score.presented {
        true => Ok(()),
        false if played.is_interrupted => Err(Failure::job("interrupted before all was typed")),
        false => Err(Failure::job("the text did not come out right")),
    }
}

/// What a receiver with a US keymap reads, and when.
#[derive(Default)]
struct Typed {
    field: UsKeymap,
    first: Option<Timestamp>,
    last: Timestamp,
}

impl Typed {
    fn take(&mut self, frame: &Snapshot) {
        for event in &frame.events {
            self.field.take(event);
            self.first.get_or_insert(event.time);
            self.last = event.time;
        }
    }

    fn score(&self, presented: &str) -> TypingScore {
        let first = self.first.unwrap_or_default();
        TypingScore::new(presented, self.field.text(), first, self.last)
    }
}

fn report(score: &TypingScore, played: &Played, summary: &Summary, line: &LineSettings) {
    let source = &summary.tally.source;
    let micros = |quantile: f64| summary.latency_ns.value_at_quantile(quantile) as f64 / 1e3;
    println!("typed      {:?}", score.typed);
    println!(
        "quality    {:.1} words/min (simulated), {:.2} % character error rate",
        score.words_per_minute,
        score.error_rate * 100.0
    );
    println!(
        "line       {} baud, {:.2} ms a frame: {} frames sent, {} decoded, {} lost",
        line.baud,
        line.frame_period().as_secs_f64() * 1e3,
        played.frames,
        source.readings,
        // The last frame is never confirmed: no header comes after it.
        (played.frames.saturating_sub(1)).saturating_sub(source.readings),
    );
    println!("account    {}", status::account(&summary.tally));
    println!(
        "latency    from a frame's last byte to its events: p50 {:.0} µs, p99 {:.0} µs, most {:.0} µs",
        micros(0.5),
        micros(0.99),
        micros(1.0)
    );
}
