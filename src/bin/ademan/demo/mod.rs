//! `ademan demo`: a simulated hand types through the whole way, on a line that is real.

mod draw;
mod player;
mod screen;
mod text;

use std::io::{self, IsTerminal, Write};
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
    let text = text::to_type(args.text.as_deref(), &assembly.layout)?;
    let typist = assembly.typist(&text, &line, args.noise, args.seed)?;
    let (stopper, asked) = signals::stopper()?;
    let mut sink = output::open(&assembly.setup.output, &assembly.needs())?;
    let wire = open_wire(line)
        .map_err(|error| Failure::job(format!("cannot open a simulated serial line: {error}")))?;
    writeln!(
        io::stdout(),
        "a simulated hand types {text:?} on {} over {}",
        assembly.layout.name,
        wire.source
    )?;
    let source = capture::open(&wire.source)?;
    let (stop_sender, stop) = bounded(1);
    let mut screen = match io::stdout().is_terminal() && !output::is_on_stdout(&args.output) {
        true => Screen::open(&assembly.layout, &text, stopper),
        false => Screen::closed(&assembly.layout),
    };
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
    drop(screen);
    let played = player.join()?;
    let score = typed.score(&text);
    report(&score, &played, &ended?, &line)?;
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

fn report(
    score: &TypingScore,
    played: &Played,
    summary: &Summary,
    line: &LineSettings,
) -> io::Result<()> {
    let source = &summary.tally.source;
    let micros = |quantile: f64| summary.latency_ns.value_at_quantile(quantile) as f64 / 1e3;
    let mut out = io::stdout().lock();
    writeln!(out, "typed      {:?}", score.typed)?;
    writeln!(
        out,
        "quality    {:.1} words/min (simulated), {:.2} % character error rate",
        score.words_per_minute,
        score.error_rate * 100.0
    )?;
    writeln!(
        out,
        "line       {} baud, {:.2} ms a frame: {} frames sent, {} decoded, {} lost",
        line.baud,
        line.frame_period().as_secs_f64() * 1e3,
        played.frames,
        source.readings,
        // The last frame is never confirmed: no header comes after it.
        (played.frames.saturating_sub(1)).saturating_sub(source.readings),
    )?;
    writeln!(out, "account    {}", status::account(&summary.tally))?;
    writeln!(
        out,
        "latency    from a frame's last byte to its events: p50 {:.0} µs, p99 {:.0} µs, most {:.0} µs",
        micros(0.5),
        micros(0.99),
        micros(1.0)
    )
}
