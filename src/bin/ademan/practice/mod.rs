//! `ademan practice`: a text to type on the present layout, with the speed and the errors.

mod heat;
mod history;
mod lesson;
mod line;
mod report;

use std::path::PathBuf;

use ademan::capture::{Hc11Format, StreamFormat};
use ademan::command::Command;
use ademan::hand::Side;
use ademan::output;
use ademan::pipeline::SourceRole;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::LoadedSetup;
use ademan::sim::SimulatedStream;

use self::history::History;
use self::lesson::{Lesson, LessonKind};
use self::line::PracticeLine;
use self::report::Report;
use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::root_args::RootArgs;
use crate::setup_args::SetupArgs;
use crate::view::{self, LiveView, Views};
use crate::{complete, demo, person, session, signals, watchdog};

/// The output without another one: the practice line only.
const NO_OUTPUT: &str = "none";

/// Type a text, and see the speed, the errors and the keys that are hit worst
#[derive(Default, clap::Args)]
#[command(
    after_help = "Examples:\n  ademan practice                                     (a simulated hand shows it)\n  ademan practice --source serial:/dev/ttyUSB0\n  ademan practice --layout chords-bend --lesson chords\n  ademan practice my-setup.ron --text 'hola, mundo'\n  ademan practice --history\n  ademan practice --csv progress.csv\n\nNothing is typed into other programs unless --output names one. The text ends after as many characters as it has; Backspace corrects. The results of complete texts are kept on this machine, without what was typed."
)]
pub struct Args {
    /// Setup file, as for `ademan run`; the flags override it
    #[arg(add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
    /// Text to type, in characters of a US keyboard
    #[arg(long, conflicts_with_all = ["file", "lesson"])]
    text: Option<String>,
    /// File with the text to type; lines become one line of at most 1000 characters
    #[arg(long, value_name = "FILE", conflicts_with = "lesson")]
    file: Option<PathBuf>,
    /// Text that comes with the program; each practice takes the next one
    #[arg(long, value_name = "KIND")]
    lesson: Option<LessonKind>,
    /// Outputs besides the practice line, separated by commas
    #[arg(long, value_name = "OUTPUTS", default_value = NO_OUTPUT, add = complete::outputs(), value_parser = OutputList)]
    output: String,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Print the results of earlier practice, and end
    #[arg(long)]
    history: bool,
    /// Write the results of earlier practice to a new file as CSV, and end; `-` is the standard output
    #[arg(long, value_name = "FILE", conflicts_with = "history")]
    csv: Option<PathBuf>,
    /// Do not keep the result
    #[arg(long)]
    no_history: bool,
    /// Noise of the simulated hand on every channel of its glove: standard deviation in counts
    #[arg(long, default_value_t = 0.0, value_parser = demo::noise, allow_negative_numbers = true)]
    noise: f64,
    /// Seed of the noise
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    root: RootArgs,
}

impl Args {
    /// Creates the arguments for a setup file, or for a layout and the simulated hand.
    pub fn for_setup(setup: Option<String>, layout: Option<String>) -> Self {
        Self {
            setup,
            flags: layout.map(SetupArgs::for_layout).unwrap_or_default(),
            output: NO_OUTPUT.to_owned(),
            ..Self::default()
        }
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    let history = History::read();
    if args.history {
        return history.print();
    }
    if let Some(path) = &args.csv {
        return history.export(path);
    }
    args.root.check(output::has_effect(&args.output))?;
    let (setup, is_simulated) = load_setup(&args)?;
    let lesson = Lesson::choose(&args, &setup.layout, history.count())?;
    let mut report = practice(&args, setup, is_simulated, &lesson)?;
    let is_kept = report.is_complete && !args.no_history;
    if is_kept {
        report.progress = history.add(report.session());
    }
    report.print(args.json)?;
    match report.is_complete || signals::is_stop_requested() {
        true => Ok(()),
        false => Err(Failure::job("the source ended before the text was typed")),
    }
}

/// Loads the setup, with the gloves of the simulated hand if no source is named. Returns whether the hand is simulated.
fn load_setup(args: &Args) -> Result<(LoadedSetup, bool), Failure> {
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    setup.output = args.output.clone();
    let is_simulated = setup.source.is_none();
    if is_simulated {
        let person = setup.person.as_deref().map(person::load).transpose()?;
        let side = person.and_then(|person| person.side);
        setup = demo::with_simulated_gloves(setup, side.unwrap_or(Side::Right))?;
    } else if !output::has_effect(&setup.output) {
        // The role protects other programs, and there are none.
        setup.role.get_or_insert(SourceRole::Both);
    }
    Ok((setup.load_files()?, is_simulated))
}

/// Runs the session until the text is typed, its source ends or a signal ends it.
fn practice(
    args: &Args,
    setup: LoadedSetup,
    is_simulated: bool,
    lesson: &Lesson,
) -> Result<Report, Failure> {
    let layout = setup.layout.clone();
    let is_drawn = view::is_possible() && !args.json && !output::uses_stdout(&args.output);
    session::prepare()?;
    let mut options = SessionOptions {
        watchdog: Some(watchdog::program(Command::Stop)?),
        lossless_snapshots: true,
        report_status: true,
        use_panic_keys: output::has_effect(&args.output),
        speed: Some(1.0),
        on_notice: Some(session::print_notices()),
        ..SessionOptions::default()
    };
    if is_simulated {
        let format = Hc11Format::default();
        let hand = setup.typist(&lesson.text, &format, args.noise, args.seed)?;
        let stream = SimulatedStream::new(hand, &StreamFormat::from(format));
        options.source = Some(Box::new(stream.map_err(Failure::job)?));
        // Without a picture nobody waits for the hand.
        options.speed = is_drawn.then_some(1.0);
    }
    let session = session::start(setup, options)?;
    let line = follow(&session, &lesson.text, is_drawn)?;
    session.join()?;
    let is_complete = line.is_complete() || is_simulated && !signals::is_stop_requested();
    Ok(Report::new(
        lesson,
        layout,
        &line,
        is_complete,
        is_simulated,
    ))
}

/// Follows the events of a session, on the terminal if it is drawn, and stops the session when the text is typed.
fn follow(session: &SessionHandle, text: &str, is_drawn: bool) -> Result<PracticeLine, Failure> {
    let mut line = PracticeLine::new(text);
    let view = is_drawn.then(|| LiveView::open(Views::Session(session.add_viewer())));
    let show = |line: &PracticeLine| {
        if let Some(view) = &view {
            view.task().set(line.lines());
        }
    };
    show(&line);
    for snapshot in session.snapshots() {
        if snapshot.events.is_empty() {
            continue;
        }
        for event in &snapshot.events {
            line.handle(event);
        }
        show(&line);
        if line.is_complete() {
            // The session may have ended meanwhile.
            let _ = session.commands().send(Command::Stop);
            break;
        }
    }
    Ok(line)
}
