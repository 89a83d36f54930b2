//! `ademan calibrate`: fits a glove file to a hand.

pub mod destination;
mod discover;
mod feed;
mod figure;
mod hysteresis;
mod lengths;
mod positions;
mod recording;
mod report;
mod screen;
mod session;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use ademan::calibrate::{self, CalibrationError, Observations, Procedure};
use ademan::capture::SourceUri;
use ademan::document::Document;
use ademan::files::Load;
use ademan::hand::Side;
use ademan::layout::{self, Glove};
use ademan::message::{escape_path, shell_word};
use ademan::setup::{LoadedSetup, Setup};
use ademan::sim::{HomeMadeGlove, SimulatedWearer};

use self::destination::Destination;
use self::feed::Feed;
use self::hysteresis::Hysteresis;
use self::lengths::LengthArgs;
use self::session::{Outcome, Session};
use crate::failure::Failure;
use crate::setup_args::{SetupArgs, number_in, one_of};
use crate::source_value::{self, SourceValue};
use crate::{complete, messages, signals};

/// Fit a glove file to a hand: take the poses that are shown, and hold each for a second
#[derive(Default, clap::Args)]
#[command(
    after_help = "Examples:\n  ademan calibrate --demo\n  ademan calibrate --source serial:/dev/ttyUSB0 --out my-glove.ron\n  ademan calibrate --fingers --source 'serial:/dev/ttyUSB0?protocol=lucidgloves' --out my-glove.ron\n  ademan calibrate --from my-glove.mcap --out my-glove.ron\n  ademan calibrate --discover --source 'tcp:localhost:10002' --out new-glove.ron\n  ademan calibrate --hysteresis cycles.mcap --glove my-glove.ron\n\nNothing is typed during a calibration. The readings are kept beside the glove file, and --from calibrates with them again."
)]
pub struct Args {
    /// Setup file. The default is setup.ron in the configuration folder, if it exists
    #[arg(long, add = complete::setup())]
    setup: Option<String>,
    /// Glove file to write. The default is the glove itself, or a file in this folder for one that comes with the program
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace an existing file without a question; the old one is kept beside it
    #[arg(long)]
    force: bool,
    /// Recording of a calibration, instead of a source
    #[arg(long, value_name = "RECORDING", conflicts_with_all = ["source", "demo"], add = complete::recording())]
    from: Option<PathBuf>,
    /// Let a simulated person take the poses, in a glove that is not calibrated; another number is another person
    #[arg(long, value_name = "NUMBER", num_args = 0..=1, default_missing_value = "1", conflicts_with = "source")]
    demo: Option<u64>,
    /// Home-made glove of the simulated person: LucidGloves with a bend sensor for each finger
    #[arg(long, value_name = "KIND", requires = "demo", value_parser = one_of::<HomeMadeGlove>(HomeMadeGlove::NAMES))]
    demo_glove: Option<HomeMadeGlove>,
    /// Also bend each finger alone, which shows the sensor of each finger: exchanged ones are put right in the new file
    #[arg(long, conflicts_with_all = ["from", "discover", "hysteresis"])]
    fingers: bool,
    /// Find the channels of a glove without a file: bend one finger after the other. Calibrate with the new file afterwards
    #[arg(long, conflicts_with_all = ["from", "glove"])]
    discover: bool,
    /// Write how far the sensors lag behind the movement, which is compensated then: a recording of sensor cycles, or a typical
    /// percentage of the ranges of the fingers, such as 4%
    #[arg(long, value_name = "RECORDING|PERCENT", conflicts_with_all = ["from", "demo", "discover", "source"], add = complete::recording())]
    hysteresis: Option<Hysteresis>,
    /// Start from the glove for this hand that comes with the program; with --discover, the hand of the glove whose channels are found
    #[arg(long, conflicts_with_all = ["from", "glove", "hysteresis"], value_parser = one_of::<Side>(Side::NAMES))]
    hand: Option<Side>,
    /// Time before each pose, in seconds
    #[arg(long, value_name = "S", default_value = "3", value_parser = seconds)]
    countdown: f64,
    #[arg(long, value_name = "URI", value_parser = SourceValue, add = complete::source(), help = "Source of readings", long_help = source_value::help())]
    source: Option<SourceUri>,
    /// Glove to start from: the name of one that comes with the program, or a file
    #[arg(long, add = complete::glove())]
    glove: Option<String>,
    /// Person whose hand is calibrated: the name of one that comes with the program, or a file
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    #[command(flatten)]
    lengths: LengthArgs,
}

impl Args {
    /// Creates the arguments for a new glove file of a source, which starts from `glove` and may have exchanged sensors.
    pub fn for_source(
        source: SourceUri,
        glove: Option<String>,
        out: PathBuf,
        countdown: f64,
    ) -> Self {
        Self {
            out: Some(out),
            fingers: true,
            countdown,
            source: Some(source),
            glove,
            ..Self::default()
        }
    }

    /// Replaces an existing file without a question.
    #[must_use]
    pub fn forced(mut self, is_forced: bool) -> Self {
        self.force = is_forced;
        self
    }

    /// Returns the hand of a glove that is simulated or has no file.
    fn side(&self) -> Side {
        self.hand.unwrap_or(Side::Right)
    }

    fn load_setup(&self) -> Result<LoadedSetup, Failure> {
        let worn = self.demo_glove.map(|_| match self.side() {
            Side::Left => "lucidgloves-left".to_owned(),
            Side::Right => "lucidgloves".to_owned(),
        });
        let flags = SetupArgs::for_glove(self.source.clone(), None, self.person.clone());
        let mut setup = flags.read_setup(self.setup.as_deref())?;
        // The glove that is calibrated may have no ranges yet, and may be for the other hand of the setup.
        setup.learn_ranges = false;
        let is_live = self.from.is_none() && self.hysteresis.is_none() && self.demo.is_none();
        if is_live
            && self.source.is_none()
            && let Some(glove) = &self.glove
        {
            setup.source = source_of(glove, &setup)?;
        }
        if let Some(side) = self.hand.filter(|_| !self.discover) {
            setup.glove = Setup::for_hand(setup.source.clone(), side, None).glove;
        }
        setup.glove = self.glove.clone().or(worn).or(setup.glove);
        setup.other_hand = None;
        if self.demo.is_some() {
            // The simulated person wears a glove, also beside a setup with a camera.
            setup.source = setup.source.filter(SourceUri::needs_glove);
        }
        Ok(setup.load_files()?)
    }
}

/// Returns the source of a setup for a glove, which may be for the other hand.
fn source_of(glove: &str, setup: &Setup) -> Result<Option<SourceUri>, Failure> {
    let second = setup.other_hand.as_ref();
    let Some(second_source) = second.and_then(|hand| hand.source.clone()) else {
        return Ok(setup.source.clone());
    };
    let first_side = setup.clone().load_files()?.arm.side();
    if Glove::load(glove)?.side == first_side {
        Ok(setup.source.clone())
    } else {
        Ok(Some(second_source))
    }
}

pub fn run(args: Args) -> Result<(), Failure> {
    match calibrate(args)? {
        Outcome::Finished => Ok(()),
        Outcome::Quit => Err(Failure::job(
            "the calibration was ended early: no file was written",
        )),
    }
}

/// Calibrates a glove. A session that was quit returns [`Outcome::Quit`] and has written no file.
pub fn calibrate(args: Args) -> Result<Outcome, Failure> {
    if let Some(hysteresis) = args.hysteresis.clone() {
        return hysteresis::run(&hysteresis, args).map(|()| Outcome::Finished);
    }
    match args.from.clone() {
        Some(path) => calibrate_from(&path, args).map(|()| Outcome::Finished),
        None if args.discover => discover::run(args),
        None => calibrate_live(args),
    }
}

/// The glove from which a calibration starts.
struct Start {
    document: Document,
    glove: Glove,
}

impl Start {
    fn new(document: Document) -> Result<Self, Failure> {
        let glove = Glove::parse(&document)?;
        Ok(Self { document, glove })
    }

    /// Fits the glove, writes the file, and prints the report. Returns `true` if the file was written.
    fn finish(
        &self,
        observations: &Observations,
        destination: &Destination,
    ) -> Result<bool, Failure> {
        let sensors = calibrate::finger_sensors(observations, &self.glove.map);
        let matched = sensors
            .as_deref()
            .and_then(|all| calibrate::at_their_fingers(all, &self.glove.map));
        let guided = observations.without_single_fingers();
        let fingers = match &sensors {
            Some(all) => report::fingers(all, matched.is_some()),
            None if guided != *observations => report::NOT_COMPARED.to_owned(),
            None => String::new(),
        };
        // Without a reader the glove file is still written.
        let _ = io::stdout().write_all(fingers.as_bytes());
        let start = matched.as_ref().unwrap_or(&self.glove.map);
        let result = calibrate::fit(&guided, start)?;
        let text = report::report(&result, &guided, start);
        let rest = calibrate::rest_pose(&guided, &result.map);
        let glove_text = layout::write_calibration(&self.document, &result.map, &rest)?;
        destination.write(&glove_text, &format!("{}\n\n", text.trim_end()))
    }
}

fn calibrate_from(path: &Path, args: Args) -> Result<(), Failure> {
    let lengths = args.lengths.both()?;
    let mut recorded = recording::read(path)?;
    let document = match (&args.glove, recorded.glove.take()) {
        (None, Some(document)) => document,
        _ => glove_document(&args.load_setup()?)?,
    };
    let start = Start::new(document)?;
    let destination = Destination::new(args.out, &start.document, args.force)?;
    let readings = recorded.take_readings(start.glove.side)?;
    let observations = calibrate::observe_recording(&readings, &recorded.marks, &start.glove.map)?;
    if start.finish(&observations, &destination)? {
        print_setup_fields(&escape_path(destination.path()), lengths)?;
    }
    Ok(())
}

fn calibrate_live(args: Args) -> Result<Outcome, Failure> {
    let setup = args.load_setup()?;
    if let (None, Some(source)) = (setup.glove_document(), &setup.setup.source) {
        positions::run(&setup, source, args.lengths)?;
        return Ok(Outcome::Finished);
    }
    let lengths = args.lengths.both()?;
    let start = Start::new(glove_document(&setup)?)?;
    let destination = Destination::new(args.out, &start.document, args.force)?;
    messages::start()?;
    signals::install()?;
    let feed = open_feed(&setup, &start.glove, (args.demo, args.demo_glove))?;
    let prepare = Duration::from_secs_f64(args.countdown);
    let glove = &start.glove;
    let mut procedure = Procedure::for_glove(&glove.map, prepare);
    if args.fingers {
        procedure = procedure.with_single_fingers(&glove.map);
    }
    let mut session = Session::new(&glove.name, glove.side, Some(&glove.map), procedure, feed);
    if let Outcome::Quit = session.run()? {
        return Ok(Outcome::Quit);
    }
    let finished = start.finish(session.procedure.observations(), &destination);
    let kept = if session.procedure.marks().is_empty() {
        Ok(())
    } else {
        keep_recording(&session, &start.document, &destination)
    };
    if finished? {
        print_setup_fields(&escape_path(destination.path()), lengths)?;
        let file = destination.as_word();
        let mut out = io::stdout();
        let word = source_word(args.source.as_ref(), args.demo);
        let layout = layout_option(&setup, &start.glove);
        writeln!(
            out,
            "use it: ademan run --glove {file} --source {word}{layout}"
        )?;
        if !args.fingers {
            writeln!(
                out,
                "if another finger bends than yours: ademan calibrate --fingers --glove {file} --source {word}"
            )?;
        }
        if start.glove.map.hystereses().is_empty() && !start.glove.map.uses_full_range() {
            writeln!(
                out,
                "if bend sensors lag behind the fingers: ademan calibrate --hysteresis 4% --glove {file}"
            )?;
        }
    }
    // A failure to keep the recording is reported last: it loses less than a failure to write the glove file.
    kept.map(|()| Outcome::Finished)
}

/// Returns the source as a word of a command; a mark of omission for a simulated person or the source of a setup.
fn source_word(source: Option<&SourceUri>, demo: Option<u64>) -> String {
    source.filter(|_| demo.is_none()).map_or_else(
        || "…".to_owned(),
        |uri| shell_word(&uri.to_string()).into_owned(),
    )
}

/// Returns the option for a layout if a glove that measures no arm does not reach the keys of the layout of a run without the option.
fn layout_option(setup: &LoadedSetup, glove: &Glove) -> &'static str {
    let mut rows = glove.map.rows().iter();
    let measures_arm = rows.any(|row| row.dof.finger().is_none());
    if measures_arm || setup.reach_report(&setup.layout).is_none() {
        ""
    } else {
        " --layout chords-bend"
    }
}

/// Prints what to write in the setup file for a glove file and an arm, if its lengths are known.
fn print_setup_fields(glove: &str, arm: Option<String>) -> io::Result<()> {
    let Some(arm) = arm else {
        return Ok(());
    };
    let mut out = io::stdout();
    writeln!(out, "in the setup file: glove: \"{glove}\", arm: {arm}")
}

fn glove_document(setup: &LoadedSetup) -> Result<Document, Failure> {
    setup.glove_document().cloned().ok_or_else(|| {
        Failure::wrong_use("this source needs no glove file, so there is nothing to calibrate")
    })
}

/// Opens the source of a setup, or the feed of a simulated person with a number, who may wear a home-made glove.
fn open_feed(
    setup: &LoadedSetup,
    glove: &Glove,
    (demo, demo_glove): (Option<u64>, Option<HomeMadeGlove>),
) -> Result<Feed, Failure> {
    match demo {
        Some(number) => {
            let mut wearer = SimulatedWearer::new(number, &glove.map, glove.side);
            if let Some(kind) = demo_glove {
                wearer = wearer.in_home_made_glove(kind);
            }
            Ok(Feed::simulated(wearer, session::is_on_terminal()))
        }
        None => Feed::open(setup),
    }
}

/// Keeps the readings beside the glove file. An older recording keeps its name.
fn keep_recording(
    session: &Session,
    glove: &Document,
    destination: &Destination,
) -> Result<(), Failure> {
    let path = destination.free_recording();
    recording::write(&path, glove, session.procedure.marks(), &session.readings)?;
    let mut out = io::stdout();
    Ok(writeln!(out, "kept the readings: {}", escape_path(&path))?)
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::job(error.to_string())
    }
}

/// Parses the time before a pose.
pub fn seconds(text: &str) -> Result<f64, String> {
    number_in(text, 0.5, 30.0, "seconds")
}
