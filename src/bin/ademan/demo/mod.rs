//! `ademan demo`: a simulated hand plays through the whole way, on a line that is real.

mod draw;
mod player;
mod screen;
mod task;
mod text;

use std::io::{self, IsTerminal, Write};
use std::num::NonZeroU32;

use ademan::capture::{Hc11Format, Source, open_loopback};
use ademan::hand::Side;
use ademan::layout::Layout;
use ademan::output;
use ademan::session::{Summary, run_pipeline};
use ademan::setup::{LoadedSetup, OtherHand, Setup};
use ademan::sim::{PacketWriters, PlaybackStats};
use crossbeam_channel::bounded;

use crate::args::DemoArgs;
use crate::failure::Failure;
use crate::{signals, status, watchdog};
use player::Player;
use screen::Screen;
use task::Task;

/// A hand that is part of this program stays away only when the whole machine is busy: that is no reason to give up
/// what it types.
const STALL_MS: u32 = 1000;

pub fn run(args: &DemoArgs) -> Result<(), Failure> {
    let layout = Layout::load(&args.layout)?;
    let setup = Setup {
        layout: args.layout.clone(),
        output: args.output.clone(),
        stall_timeout_ms: STALL_MS,
        other_hand: layout.has_board_for(Side::Left).then(OtherHand::default),
        ..Setup::default()
    };
    let mut assembly = setup.load_files()?;
    let line = Hc11Format {
        baud: NonZeroU32::new(args.baud)
            .ok_or_else(|| Failure::wrong_use("a baud is more than 0"))?,
        ..Hc11Format::default()
    };
    let (mut task, hand) = match &args.script {
        Some(script) => (
            Task::play(script, &assembly.layout),
            assembly.scripted(script, &line, args.noise, args.seed)?,
        ),
        None => {
            let text = text::to_type(args.text.as_deref(), &assembly.layout)?;
            let hand = assembly.typist(&text, &line, args.noise, args.seed)?;
            (Task::type_text(text), hand)
        }
    };
    let (stopper, asked) = signals::stopper()?;
    let bell = stopper.clone();
    let mut sink = watchdog::open_outputs(
        &assembly.setup.output,
        &assembly.required_capabilities(),
        move || bell.ask_once(),
    )?;
    let (lines, source) = wires(&mut assembly, line, hand.hand_count())?;
    writeln!(
        io::stdout(),
        "a simulated hand {} on {} over {}",
        task.told(),
        assembly.layout.name,
        source.name()
    )?;
    let (stop_sender, stop) = bounded(1);
    let mut screen = match io::stdout().is_terminal() && !output::uses_stdout(&args.output) {
        true => Screen::open(&assembly.layout, task.wanted(), stopper),
        false => Screen::closed(&assembly.layout),
    };
    let hands = hand.hand_count() as u64;
    let player = Player::start(hand, lines, line, asked, stop_sender);
    let ended = run_pipeline(
        source,
        &mut assembly.pipeline(),
        &mut *sink,
        &stop,
        &mut |frame| {
            task.take(frame);
            screen.show(frame, || task.outcome());
        },
    );
    drop(screen);
    let played = player.join()?;
    let is_written = args.output == "transcript";
    task.report(&mut io::stdout().lock(), is_written)?;
    report(&played, &ended?, &line, hands)?;
    match task.is_done(&played) {
        true => Ok(()),
        false if played.is_cancelled => Err(Failure::job("interrupted before all was played")),
        false => Err(Failure::job("the text did not come out right")),
    }
}

/// A line for each hand: the ends that gloves write to, and the source that reads from them.
fn wires(
    assembly: &mut LoadedSetup,
    line: Hc11Format,
    hands: usize,
) -> Result<(PacketWriters, Box<dyn Source>), Failure> {
    let (mut lines, mut names) = (Vec::new(), Vec::new());
    for _ in 0..hands {
        let wire = open_loopback(line).map_err(|error| {
            Failure::job(format!("cannot open a simulated serial line: {error}"))
        })?;
        lines.push(wire.writer);
        names.push(wire.uri);
    }
    if let Some(other) = &mut assembly.setup.other_hand {
        other.source = names.pop();
    }
    Ok((lines, assembly.open_source(&names[0])?))
}

fn report(
    played: &PlaybackStats,
    summary: &Summary,
    line: &Hc11Format,
    hands: u64,
) -> io::Result<()> {
    let source = &summary.stats.source;
    let micros = |quantile: f64| summary.latency_ns.value_at_quantile(quantile) as f64 / 1e3;
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "line       {} baud, {:.2} ms a frame: {} frames sent, {} decoded, {} lost",
        line.baud,
        line.packet_period().as_secs_f64() * 1e3,
        hands * played.packets,
        source.readings,
        // The last frame is never confirmed: no header comes after it.
        (hands * played.packets.saturating_sub(1)).saturating_sub(source.readings),
    )?;
    writeln!(out, "account    {}", status::account(&summary.stats))?;
    writeln!(
        out,
        "latency    from a frame's last byte to its events: p50 {:.0} µs, p99 {:.0} µs, most {:.0} µs",
        micros(0.5),
        micros(0.99),
        micros(1.0)
    )
}
