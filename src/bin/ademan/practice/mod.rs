//! `ademan practice`: a text to type on the present layout, with the speed and the errors.

mod heat;
mod history;
mod lesson;
mod line;
mod pointing;
mod report;

use std::path::PathBuf;

use ademan::capture::{Hc11Format, StreamFormat};
use ademan::command::Command;
use ademan::device::OutputEvent;
use ademan::hand::Side;
use ademan::output;
use ademan::pipeline::SourceRole;
use ademan::session::{SessionHandle, SessionOptions};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::{SimulatedStream, SimulatedTypist};
use ademan::time::Timestamp;

pub use self::history::SessionResult;
pub use self::line::PracticeLine;
pub use self::pointing::PointingTask;
pub use self::report::now;

use self::history::History;
use self::lesson::{Lesson, LessonKind};
use self::report::Report;
use crate::failure::Failure;
use crate::output_list::OutputList;
use crate::root_args::RootArgs;
use crate::setup_args::SetupArgs;
use crate::view::{self, LiveView, Views};
use crate::{complete, demo, pause_signals, person, session, signals, watchdog};

/// The output if none is named: only the practice line shows what is typed.
const NO_OUTPUT: &str = "none";

/// Type a text or point at targets, and see the speed and the errors
#[derive(Default, clap::Args)]
#[command(
    after_help = "Examples:\n  ademan practice                                     (a simulated hand shows it)\n  ademan practice --source serial:/dev/ttyUSB0\n  ademan practice --layout chords-bend --lesson chords\n  ademan practice --lesson pointing\n  ademan practice my-setup.ron --text 'hola, mundo'\n  ademan practice --history\n  ademan practice --csv progress.csv\n\nNothing is typed into other programs unless --output names one. The text ends after as many characters as it has; Backspace corrects. The results of complete texts are kept on this machine, without what was typed."
)]
pub struct Args {
    /// Setup file, as for `ademan run`; the flags override it
    #[arg(add = complete::setup())]
    setup: Option<String>,
    #[command(flatten)]
    flags: SetupArgs,
    /// Text to type, in characters of a US keyboard: one line of at most 1000 characters
    #[arg(long, conflicts_with_all = ["file", "lesson"])]
    text: Option<String>,
    /// File with the text to type; lines become one line of at most 1000 characters
    #[arg(long, value_name = "FILE", conflicts_with = "lesson")]
    file: Option<PathBuf>,
    /// Lesson that comes with the program; each practice takes the next text
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
    /// The file to which the readings are recorded, for a study.
    #[arg(skip)]
    record_to: Option<PathBuf>,
    #[command(flatten)]
    root: RootArgs,
}

/// The conditions of a task of a study.
pub struct Exercise {
    /// The source, the person and the layout.
    pub flags: SetupArgs,
    /// `true` if a simulated hand does it.
    pub is_simulated: bool,
    /// The file to which the readings are recorded.
    pub record_to: Option<PathBuf>,
    /// The task of a simulated hand, if there is no source.
    pub simulated: SimulatedTask,
}

/// The actions of a simulated hand in a task.
pub enum SimulatedTask {
    /// The hand types a text.
    Text(String),
    /// The hand points at the targets of the ring.
    Ring,
    /// The hand plays a script.
    Script(String),
}

/// Does a task of a study in a session that types into no other program. Returns `true` if it is complete.
pub fn perform(exercise: &Exercise, task: &mut impl PracticeTask) -> Result<bool, Failure> {
    let args = Args {
        flags: exercise.flags.clone(),
        record_to: exercise.record_to.clone(),
        ..Args::for_setup(None, None)
    };
    let (setup, has_no_source) = load_setup(&args)?;
    if has_no_source && !exercise.is_simulated {
        return Err(Failure::wrong_use(
            "no source: name the source of the participant with --source, or try the study with --simulated",
        ));
    }
    let format = Hc11Format::default();
    let hand = match (&exercise.simulated, has_no_source) {
        (_, false) => None,
        (SimulatedTask::Text(text), true) => Some(setup.typist(text, &format, 0.0, 0)?),
        (SimulatedTask::Ring, true) => {
            let script = pointing::script(&setup.layout)?;
            Some(setup.scripted(&script, &format, 0.0, 0)?)
        }
        (SimulatedTask::Script(script), true) => Some(setup.scripted(script, &format, 0.0, 0)?),
    };
    run_task(&args, setup, hand, task)?;
    Ok(task.is_complete())
}

/// Returns the results of earlier practice, the oldest first.
pub fn sessions() -> Vec<SessionResult> {
    History::read().sessions().to_vec()
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

/// The task of a practice, which follows the events of a session until it is complete.
pub trait PracticeTask {
    /// Adds an event. Returns `true` if it changes the lines.
    fn handle(&mut self, event: &OutputEvent) -> bool;

    /// Notes the time of a reading. Returns `true` if it changes the lines.
    fn tick(&mut self, _now: Timestamp) -> bool {
        false
    }

    /// Returns `true` if the practice has come to its end.
    fn is_complete(&self) -> bool;

    /// Returns the lines of the live view.
    fn lines(&self) -> Vec<String>;
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
    if args.lesson == Some(LessonKind::Pointing) {
        return pointing::run(&args, setup, is_simulated, history);
    }
    let lesson = Lesson::choose(&args, &setup, history.count())?;
    let mut report = practice(&args, setup, is_simulated, &lesson)?;
    let is_kept = report.is_complete && !args.no_history;
    if is_kept {
        report.progress = history.add(report.session());
    }
    report.print(args.json)?;
    if report.is_complete || signals::is_stop_requested() {
        Ok(())
    } else {
        Err(Failure::job("the source ended before the text was typed"))
    }
}

/// Loads the setup, with the gloves of the simulated hand if no source is named. Also returns `true` if the hand is simulated.
fn load_setup(args: &Args) -> Result<(LoadedSetup, bool), Failure> {
    let mut setup = args.flags.read_setup(args.setup.as_deref())?;
    setup.output = args.output.clone();
    let is_simulated = setup.source.is_none();
    let names_layout = args.setup.is_some() || args.flags.names_layout();
    if is_simulated && !names_layout && args.lesson == Some(LessonKind::Pointing) {
        pointing::SIMULATED_LAYOUT.clone_into(&mut setup.layout);
    }
    if is_simulated {
        let person = setup.person.as_deref().map(person::load).transpose()?;
        let side = person.and_then(|person| person.side);
        setup = demo::with_simulated_gloves(setup, side.unwrap_or(Side::Right))?;
    } else if !output::has_effect(&setup.output) {
        permit_keys(&mut setup);
    }
    Ok((setup.load_files()?, is_simulated))
}

/// Allows every source without a role to press keys. Roles protect other programs, and no output reaches one.
fn permit_keys(setup: &mut Setup) {
    setup.role.get_or_insert(SourceRole::Both);
    setup.arm_role.get_or_insert(SourceRole::Both);
    if let Some(other) = &mut setup.other_hand {
        other.arm_role.get_or_insert(SourceRole::Both);
        // Without a source of its own, the other hand has the role of the first one.
        if other.source.is_some() {
            other.role.get_or_insert(SourceRole::Both);
        }
    }
}

/// Types a text: runs the session until it is typed, the source ends or a signal ends it.
fn practice(
    args: &Args,
    setup: LoadedSetup,
    is_simulated: bool,
    lesson: &Lesson,
) -> Result<Report, Failure> {
    let layout = setup.layout.clone();
    let hand = if is_simulated {
        let format = Hc11Format::default();
        Some(setup.typist(&lesson.text, &format, args.noise, args.seed)?)
    } else {
        None
    };
    let is_by_simulation = is_by_simulation(&setup, is_simulated);
    let mut line = PracticeLine::new(&lesson.text)
        .with_fingers(lesson.fingers.clone())
        .with_rated_chords(lesson.rates_chords)
        .with_found_letters(lesson.finds_letters);
    run_task(args, setup, hand, &mut line)?;
    let is_complete = line.is_complete() || is_simulated && !signals::is_stop_requested();
    Ok(Report::new(
        lesson,
        layout,
        &line,
        is_complete,
        is_by_simulation,
    ))
}

/// Returns `true` if a simulated hand does the task: its own, without a source, or one that the setup names as the source.
fn is_by_simulation(setup: &LoadedSetup, has_no_source: bool) -> bool {
    has_no_source || setup.setup.has_simulated_hands()
}

/// Returns `true` if the live view is drawn.
fn is_drawn(args: &Args) -> bool {
    view::is_possible() && !args.json && !output::uses_stdout(&args.output)
}

/// Runs a session, with a simulated hand or with the source of the setup, until the task is complete, the source ends or a signal
/// ends it.
fn run_task(
    args: &Args,
    setup: LoadedSetup,
    hand: Option<SimulatedTypist>,
    task: &mut impl PracticeTask,
) -> Result<(), Failure> {
    let is_drawn = is_drawn(args);
    session::prepare()?;
    let mut options = SessionOptions {
        watchdog: Some(watchdog::program(Command::Stop)?),
        lossless_snapshots: true,
        report_status: true,
        use_panic_keys: output::has_effect(&args.output),
        record_to: args.record_to.clone(),
        speed: Some(1.0),
        on_notice: Some(session::print_notices()),
        ..SessionOptions::default()
    };
    if let Some(hand) = hand {
        let stream = SimulatedStream::new(hand, &StreamFormat::from(Hc11Format::default()));
        options.source = Some(Box::new(stream.map_err(Failure::job)?));
        // Without a picture the hand need not type in real time.
        options.speed = is_drawn.then_some(1.0);
    }
    let session = session::start(setup, options)?;
    pause_signals::install_for(&session, &args.output)?;
    follow(&session, task, is_drawn);
    session.join()?;
    Ok(())
}

/// Follows the events of a session, on the terminal if it is drawn, and stops the session when the task is complete.
fn follow(session: &SessionHandle, task: &mut impl PracticeTask, is_drawn: bool) {
    let view = is_drawn.then(|| LiveView::open(Views::Session(session.add_viewer())));
    let show = |shown: &dyn PracticeTask| {
        if let Some(view) = &view {
            view.task().set(shown.lines());
        }
    };
    show(task);
    for snapshot in session.snapshots() {
        let mut has_changed = false;
        for event in &snapshot.events {
            has_changed |= task.handle(event);
        }
        if let Some(pose) = &snapshot.pose {
            has_changed |= task.tick(pose.time);
        }
        if !has_changed {
            continue;
        }
        show(task);
        if task.is_complete() {
            // The session may have ended already.
            let _ = session.commands().send(Command::Stop);
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_practices_with_hands_and_arms_that_come_over_the_network() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("setup.ron");
        let text = "Setup(source: \"serial:/dev/ttyUSB0\", arm_source: \"udp:127.0.0.1:9000?protocol=markers\", \
                    other_hand: (source: \"tcp:127.0.0.1:4001\", arm_source: \"udp:127.0.0.1:9001?protocol=markers\"))";
        std::fs::write(&path, text).unwrap();
        let args = Args::for_setup(path.to_str().map(str::to_owned), None);
        let (setup, _) = load_setup(&args).unwrap();
        let roles = setup.sources().map(|(_, permissions)| permissions.role);
        assert_eq!(roles.collect::<Vec<_>>(), [SourceRole::Both; 2]);
    }
}
