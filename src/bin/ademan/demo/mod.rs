//! `ademan demo`: a simulated hand types or plays a script, from glove bytes to events.

pub mod looping;
mod player;
pub mod script;
mod setup;
mod task;
pub mod text;

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::sync::{Arc, Mutex, PoisonError};

use ademan::capture::hc11::{BODY_BYTES, PACKET_BYTES};
use ademan::capture::protocol::{body_landmarks, joint_sets, lucidgloves};
use ademan::capture::{Hc11Format, Source, StreamFormat, open_loopback};
use ademan::command::Command;
use ademan::document::shipped_layouts;
use ademan::hand::Side;
use ademan::layout::{Layout, Motion};
use ademan::message::{escape, shell_word};
use ademan::output;
use ademan::session::{Session, SessionHandle, SessionOptions, Summary};
use ademan::setup::LoadedSetup;
use ademan::sim::{PacketWriters, PlaybackStats, SimulatedStream, SimulatedTypist};

use crate::complete;
use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::root_args::RootArgs;
use crate::setup_args::{number_in, one_of};
use crate::view::{self, LiveView, Views};
use crate::{messages, pause_signals, session, signals, stats, watchdog};
pub use setup::with_simulated_gloves;

use player::Player;
use task::{Task, write_row};
use text::TextChoice;

/// Watch a simulated hand type a text or play a script, from glove bytes to events
#[derive(Clone, clap::Args)]
#[command(
    after_help = "Examples:\n  ademan demo\n  ademan demo --layout media\n  ademan demo --all\n  ademan demo --person adult\n  ademan demo --layout my-mixer.ron --repeat\n  ademan demo --text 'ademan: a gesture of the hand' --layout qwerty-arc --baud 9600\n  ademan demo --layout arrows --script 'push ArrowUp 0.6; wait 500; lift; tap ArrowLeft'\n  sleep 3; ademan demo --output desktop     (types into the window that has the focus by then)"
)]
pub struct Args {
    /// Text to type, in characters of a US keyboard. By default the demo chooses a text or a script for the layout
    #[arg(long)]
    text: Option<String>,
    /// Script to play instead: a file, or a text such as 'press Q; wait 300; lift' (docs/scripts.md)
    #[arg(long, value_name = "FILE_OR_TEXT", conflicts_with = "text")]
    script: Option<String>,
    /// Layout: the name of one that comes with the program (see `ademan layout list`), a file, or a link of the page. The default
    /// is the layout of the setup, or `qwerty-flat`
    #[arg(long, add = complete::layout())]
    layout: Option<String>,
    /// Use the layout of a link, which somebody else made, with an output
    #[arg(long)]
    trust: bool,
    /// Setup whose arms, gloves, layout and filters apply; its source and output do not
    #[arg(long, value_name = "SETUP.ron", add = complete::setup())]
    setup: Option<String>,
    /// Person who is simulated: the name of one that comes with the program (see `ademan person list`), or a file
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    /// Glove of the first hand: the name of one that comes with the program, or a file
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Play every layout that comes with the program for a few seconds
    #[arg(long, conflicts_with_all = ["layout", "text", "script"])]
    all: bool,
    /// Start again at the end, until Ctrl-C. The hand follows the layout file when it is saved
    #[arg(long, conflicts_with = "all")]
    repeat: bool,
    /// Play faster than real time, without the simulated serial line
    #[arg(long, conflicts_with = "repeat")]
    fast: bool,
    /// The first hand, for boards that are for either. The default is the hand of the person, or right
    #[arg(long, value_name = "SIDE", value_parser = one_of::<Side>(Side::NAMES))]
    hand: Option<Side>,
    /// Bits per second on the simulated serial line
    #[arg(long, default_value_t = 115_200, value_parser = clap::value_parser!(u32).range(1200..=4_000_000))]
    baud: u32,
    /// Outputs besides the screen, separated by commas
    #[arg(long, value_name = "OUTPUTS", default_value = "none", add = complete::outputs(), value_parser = OutputList)]
    output: String,
    /// Noise on every channel of the glove: standard deviation in counts
    #[arg(long, default_value_t = 0.0, value_parser = noise, allow_negative_numbers = true)]
    noise: f64,
    /// Seed of the noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    root: RootArgs,
}

pub fn run(args: Args) -> Result<(), Failure> {
    args.root.check(output::has_effect(&args.output))?;
    messages::start()?;
    signals::install()?;
    // The players come and go, and signals have one action.
    let player = Arc::new(Mutex::new(None));
    let current = Arc::clone(&player);
    signals::on_stop(move || cancel(&current));
    if !args.all {
        return play(&args, &player);
    }
    let mut failed = Vec::new();
    for layout in shipped_layouts() {
        let args = Args {
            layout: Some(layout.to_owned()),
            ..args.clone()
        };
        match play(&args, &player) {
            Ok(()) => {}
            Err(failure) if signals::is_stop_requested() => return Err(failure),
            Err(failure) => failed.push(format!("{layout}: {failure}")),
        }
        writeln!(io::stdout())?;
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(Failure::job(failed.join("\n")))
    }
}

/// The action that cancels the current player.
type CurrentPlayer = Arc<Mutex<Option<Box<dyn Fn() + Send>>>>;

fn cancel(player: &CurrentPlayer) {
    let player = player.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(cancel) = &*player {
        cancel();
    }
}

/// Sets the action of a signal to stop, and takes it at once if such a signal has come before.
fn on_stop(current: &CurrentPlayer, action: impl Fn() + Send + 'static) {
    *current.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(action));
    if signals::is_stop_requested() {
        cancel(current);
    }
}

/// Plays one demo to its end.
fn play(args: &Args, current: &CurrentPlayer) -> Result<(), Failure> {
    let (setup, line) = (setup::load(args)?, line_format(args));
    let (task, hand) = simulated_hand(args, &setup, &line)?;
    let task = task.repeated(args.repeat);
    let hand = if args.repeat { hand.repeated() } else { hand };
    if args.fast || shows_more_than_a_line(&setup.layout) {
        play_bytes(args, current, setup, &line, task, hand)
    } else {
        play_on_line(args, current, setup, line, task, hand)
    }
}

/// Plays over simulated serial lines, in real time.
fn play_on_line(
    args: &Args,
    current: &CurrentPlayer,
    mut setup: LoadedSetup,
    line: Hc11Format,
    mut task: Task,
    hand: SimulatedTypist,
) -> Result<(), Failure> {
    let hands = hand.hand_count();
    let (writers, source) = open_loopbacks(&mut setup, line, hands)?;
    announce(&task, &setup, source.name())?;
    let options = SessionOptions {
        source: Some(source),
        watch_layouts: true,
        ..session_options()?
    };
    let session = Session::start(setup, options)?;
    pause_signals::install_for(&session, &args.output)?;
    session.wait_until_started();
    let player = Player::start(hand, writers, line, session.commands().clone())?;
    on_stop(current, player.canceller());
    watch(args, &session, &mut task);
    // The session may have ended first, by an error or the loss of the watchdog.
    player.cancel();
    let playback = player.join()?;
    let summary = session.join()?;
    finish(args, &task, &summary, &playback, Some((&line, hands)))
}

/// Writes the result of the demo, with the number of hands on a serial line. An interruption is the way to end one that repeats.
fn finish(
    args: &Args,
    task: &Task,
    summary: &Summary,
    playback: &PlaybackStats,
    line: Option<(&Hc11Format, usize)>,
) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    task.report(&mut out, playback, args.output == "transcript")?;
    match line {
        Some((line, hands)) => report(&mut out, playback, summary, line, hands as u64)?,
        None => write_row(&mut out, "readings   ", &stats::line(&summary.stats))?,
    }
    // At an interruption the readings that wait count as dropped.
    if !playback.is_cancelled
        && let Some(warning) = stats::missing_keys(&summary.stats)
    {
        complain!("warning: {warning}; see `readings`");
    }
    if task.is_done(playback) || (playback.is_cancelled && args.repeat) {
        Ok(())
    } else if playback.is_cancelled {
        Err(Failure::job("interrupted before the end"))
    } else {
        Err(Failure::job("the typed text differs from the given one"))
    }
}

/// Plays the bytes of the gloves without a line.
fn play_bytes(
    args: &Args,
    current: &CurrentPlayer,
    setup: LoadedSetup,
    line: &Hc11Format,
    mut task: Task,
    hand: SimulatedTypist,
) -> Result<(), Failure> {
    let stream = SimulatedStream::new(hand, &byte_format(&setup, line)?).map_err(Failure::job)?;
    let pace = if args.fast {
        "its bytes, faster than real time"
    } else {
        "its bytes"
    };
    announce(&task, &setup, pace)?;
    let options = SessionOptions {
        source: Some(Box::new(stream)),
        speed: (!args.fast).then_some(1.0),
        watch_layouts: args.repeat,
        ..session_options()?
    };
    let session = Session::start(setup, options)?;
    pause_signals::install_for(&session, &args.output)?;
    let commands = session.commands().clone();
    on_stop(current, move || _ = commands.send(Command::Stop));
    watch(args, &session, &mut task);
    let summary = session.join()?;
    let playback = PlaybackStats {
        is_cancelled: signals::is_stop_requested(),
        ..PlaybackStats::default()
    };
    finish(args, &task, &summary, &playback, None)
}

/// Returns `true` if a layout needs more than the simulated serial lines carry: packets without sticks and buttons, of a glove that
/// knows nothing of the body and of the other hand.
fn shows_more_than_a_line(layout: &Layout) -> bool {
    layout.uses_inputs() || layout.uses_body() || layout.follows_other_hand()
}

/// Returns the format of the bytes: the line's, or lines of LucidGloves at its rate for a glove with a stick and buttons, of body
/// landmarks for head and feet, or of a headset for both hands in one room.
fn byte_format(setup: &LoadedSetup, line: &Hc11Format) -> Result<StreamFormat, Failure> {
    let layout = &setup.layout;
    let protocol = if layout.uses_body() {
        &body_landmarks::PROTOCOL
    } else if layout.follows_other_hand() {
        &joint_sets::OPENXR
    } else if layout.uses_inputs() {
        &lucidgloves::PROTOCOL
    } else {
        return Ok(StreamFormat::from(*line));
    };
    let mut format = StreamFormat::new(protocol);
    if let Some(rate) = format.protocol.option("rate_hz") {
        let rate_hz = 1.0 / line.packet_period().as_secs_f64();
        let set = format.options.set(rate, &format!("{rate_hz:.3}"));
        set.map_err(Failure::job)?;
    }
    Ok(format)
}

fn announce(task: &Task, setup: &LoadedSetup, source: &str) -> io::Result<()> {
    let sentence = format!(
        "a simulated hand {} on {} over {source}",
        task.description(),
        escape(&setup.layout.name),
    );
    write_row(&mut io::stdout(), "", &sentence)
}

fn session_options() -> Result<SessionOptions, Failure> {
    Ok(SessionOptions {
        watchdog: Some(watchdog::program(Command::Stop)?),
        lossless_snapshots: true,
        on_notice: Some(session::print_notices()),
        ..SessionOptions::default()
    })
}

/// Shows a session and its task until the session ends.
fn watch(args: &Args, session: &SessionHandle, task: &mut Task) {
    let is_drawn = view::is_possible() && !output::uses_stdout(&args.output);
    let view = is_drawn.then(|| LiveView::open(Views::Session(session.add_viewer())));
    let show = |shown: &Task| {
        if let Some(view) = &view {
            view.task().set(vec![shown.goal(), shown.result()]);
        }
    };
    show(task);
    for snapshot in session.snapshots() {
        task.update(&snapshot);
        if !snapshot.events.is_empty() {
            show(task);
        }
    }
}

fn line_format(args: &Args) -> Hc11Format {
    Hc11Format {
        baud: NonZeroU32::new(args.baud).expect("the range begins at 1200"),
        ..Hc11Format::default()
    }
}

fn simulated_hand(
    args: &Args,
    setup: &LoadedSetup,
    line: &Hc11Format,
) -> Result<(Task, SimulatedTypist), Failure> {
    let play = |script: &str, title: &str| {
        let hand = setup.scripted(script, line, args.noise, args.seed)?;
        Ok((Task::play(title, &setup.layout), hand))
    };
    if let Some(script) = &args.script {
        return play(script, script);
    }
    let choice = match &args.text {
        Some(text) => TextChoice::Given(text),
        None => match script::for_layout(&setup.setup.layout) {
            Some(script) => return play(script, &script::title(script)),
            None if args.all => TextChoice::Short,
            None => TextChoice::Default,
        },
    };
    let text = match text::choose(choice, &setup.layout) {
        Err(_) if args.text.is_none() => {
            let tour = setup.tour();
            return play(&tour, &script::title(&tour));
        }
        text => text?,
    };
    let hand = setup.typist(&text, line, args.noise, args.seed)?;
    let has_errors = args.noise > 0.0 || setup.simulated_person.motion != Motion::default();
    let others = if has_errors {
        "; other seeds give other figures"
    } else {
        ""
    };
    let person = args.person.as_deref().or(setup.setup.person.as_deref());
    let person = person.map_or(String::new(), |name| {
        format!(" --person {}", shell_word(name))
    });
    let conditions = format!(
        "--noise {} --seed {}{person}{others}",
        args.noise, args.seed
    );
    Ok((Task::type_text(text, conditions), hand))
}

/// Parses the noise of a simulated hand.
pub fn noise(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 50.0, "counts")
}

/// Opens a loopback line for each hand and returns the ends of the gloves and the source at the other ends.
fn open_loopbacks(
    setup: &mut LoadedSetup,
    line: Hc11Format,
    hands: usize,
) -> Result<(PacketWriters, Box<dyn Source>), Failure> {
    let (mut writers, mut uris) = (Vec::new(), Vec::new());
    for _ in 0..hands {
        let loopback = open_loopback(line).map_err(|error| {
            Failure::job(format!("cannot open a simulated serial line: {error}"))
        })?;
        writers.push(loopback.writer);
        uris.push(loopback.uri);
    }
    if let Some(other_hand) = &mut setup.setup.other_hand {
        other_hand.source = uris.pop();
    }
    Ok((writers, setup.open_source(&uris[0])?))
}

fn report(
    out: &mut impl Write,
    playback: &PlaybackStats,
    summary: &Summary,
    line: &Hc11Format,
    hands: u64,
) -> io::Result<()> {
    let source = &summary.stats.source;
    let micros = |quantile: f64| summary.latency_ns.value_at_quantile(quantile) as f64 / 1e3;
    let packets = format!(
        "{} baud, {:.2} ms per packet: {} packets sent, {} decoded, {} lost",
        line.baud,
        line.packet_period().as_secs_f64() * 1e3,
        hands * playback.packets,
        source.readings,
        // The header of the next packet confirms a packet, and the last one has no next.
        (hands * playback.packets.saturating_sub(1)).saturating_sub(source.readings),
    );
    write_row(out, "line       ", &packets)?;
    write_row(out, "readings   ", &stats::line(&summary.stats))?;
    let latency = format!(
        "from the confirmation of a packet to its events: p50 {:.0} µs, p99 {:.0} µs, max {:.0} µs",
        micros(0.5),
        micros(0.99),
        micros(1.0)
    );
    write_row(out, "latency    ", &latency)?;
    let confirmed = format!(
        "by the header of the next packet, {:.2} ms after it, or by a pause",
        line.transmission_time(PACKET_BYTES - BODY_BYTES)
            .as_secs_f64()
            * 1e3
    );
    write_row(out, "confirmed  ", &confirmed)
}
