//! `ademan start`: the first start, step by step: the source, the hand, the layout, the calibration, the setup file and a practice line.

pub mod layout;
mod question;
mod source;

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use ademan::capture::SourceUri;
use ademan::document::Document;
use ademan::files::{self, Load};
use ademan::hand::Side;
use ademan::layout::Glove;
use ademan::message::{escape, escape_path, shell_word};
use ademan::setup::{OWN_SETUP, Setup};

use self::question::{Questions, interrupted};
use crate::calibrate::{self, destination::Destination};
use crate::complete;
use crate::failure::Failure;
use crate::setup_args::one_of;
use crate::source_value::SourceValue;
use crate::{practice, signals};

/// Set up a glove or another sensor step by step, and try it
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  ademan start\n  ademan start --simulated\n  ademan start --port /dev/ttyUSB0 --hand left\n  ademan start --yes --source 'serial:/dev/ttyUSB0?protocol=lucidgloves' --no-calibrate --out my-setup.ron\n\nEach option answers one question. Nothing is typed into other programs, and no file is replaced without a question. Ctrl-C ends it at any step."
)]
pub struct Args {
    /// Accept every proposal that no option answers
    #[arg(long)]
    yes: bool,
    /// Source of readings, instead of the search on the serial ports
    #[arg(long, value_name = "URI", value_parser = SourceValue, add = complete::source(), conflicts_with_all = ["port", "simulated"])]
    source: Option<SourceUri>,
    /// Serial port to listen to, instead of all
    #[arg(long, value_name = "PORT", conflicts_with = "simulated")]
    port: Option<String>,
    /// Use the simulated hand. No setup file is written
    #[arg(long)]
    simulated: bool,
    /// Hand that is measured
    #[arg(long, value_parser = one_of::<Side>(Side::NAMES))]
    hand: Option<Side>,
    /// Layout: the name of one that comes with the program, or a file
    #[arg(long, add = complete::layout())]
    layout: Option<String>,
    /// Glove file, instead of a calibration
    #[arg(long, add = complete::glove(), conflicts_with = "no_calibrate")]
    glove: Option<String>,
    /// Do not calibrate
    #[arg(long)]
    no_calibrate: bool,
    /// Time before each pose of the calibration, in seconds
    #[arg(long, value_name = "S", default_value = "3", value_parser = calibrate::seconds)]
    countdown: f64,
    /// Setup file to write. The default is setup.ron in the configuration folder, which every run finds
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace existing files without a question; the old ones are kept beside them
    #[arg(long)]
    force: bool,
    /// End without a practice line
    #[arg(long)]
    no_practice: bool,
}

pub fn run(args: Args) -> Result<(), Failure> {
    let questions = Questions::new(args.yes);
    signals::install()?;
    signals::end_at_once_on_stop();
    let Some(source) = source::find(&args, &questions)? else {
        return try_simulated(&args, &questions);
    };
    let mut out = io::stdout();
    writeln!(out, "source: {}", escape(&source.to_string()))?;
    let path = setup_path(&args)?;
    let destination = Destination::new(Some(path), &Document::new(OWN_SETUP, ""), args.force)?;
    let mut setup = worn(source, &args, &questions)?;
    let given = args.layout.as_deref();
    let layout = layout::choose(given, &setup, &questions, destination.path())?;
    setup.layout.clone_from(&layout.name);
    calibrate(&mut setup, &args, &questions, destination.path())?;
    // A file that is begun is written to its end.
    signals::only_note_stop();
    layout.write()?;
    if !destination.write(&setup.first_text(destination.path()), "")? {
        return Err(interrupted());
    }
    signals::end_at_once_on_stop();
    let own = files::in_config_folder(OWN_SETUP);
    let file = if own.as_deref() == Some(destination.path()) {
        String::new()
    } else {
        format!(" {}", destination.as_word())
    };
    let is_practiced = !args.no_practice && io::stdout().is_terminal();
    if is_practiced && questions.confirm("try it in a practice line")? {
        let setup_path = destination.path().to_string_lossy().into_owned();
        practice::run(practice::Args::for_setup(Some(setup_path), None))?;
    }
    writeln!(out, "practice:  ademan practice{file}")?;
    Ok(writeln!(
        out,
        "next time: ademan run{file} --output desktop"
    )?)
}

/// The commands that show a left hand, as the simulated hand of the first start is a right one.
const LEFT_HAND: &str = "a right hand is simulated here; for a left one: \
    ademan layout new mine --mirror && ademan practice --layout mine.ron --glove unam-hc11-left";

/// Shows the simulated hand on a layout, and the commands for a device.
fn try_simulated(args: &Args, questions: &Questions) -> Result<(), Failure> {
    let (given, setup) = (args.layout.as_deref(), Setup::default());
    let layout = layout::choose(given, &setup, questions, Path::new(OWN_SETUP))?.name;
    let word = shell_word(&layout).into_owned();
    let mut out = io::stdout();
    if args.hand == Some(Side::Left) {
        writeln!(out, "{LEFT_HAND}")?;
    }
    if !args.no_practice {
        practice::run(practice::Args::for_setup(None, Some(layout)))?;
    }
    writeln!(out, "practice:  ademan practice --layout {word}")?;
    let next = "with a device: connect it, then `ademan start`";
    Ok(writeln!(out, "{next}")?)
}

/// Returns the path of the setup file, in a folder that exists.
fn setup_path(args: &Args) -> Result<PathBuf, Failure> {
    if let Some(path) = &args.out {
        return Ok(path.clone());
    }
    let folder = files::config_folder().ok_or_else(|| {
        Failure::wrong_use(
            "this system has no configuration folder; name the setup file with --out",
        )
    })?;
    fs::create_dir_all(&folder).map_err(|error| {
        let folder = escape_path(&folder);
        Failure::wrong_use(format!(
            "cannot create {folder}: {error}; name another setup file with --out"
        ))
    })?;
    Ok(folder.join(OWN_SETUP))
}

/// Returns a setup with the source and the glove of the hand that is measured.
fn worn(source: SourceUri, args: &Args, questions: &Questions) -> Result<Setup, Failure> {
    let side = match (args.hand, side_of_glove(&source, args)?) {
        (Some(side), Some(worn)) if side != worn => {
            return Err(Failure::wrong_use(format!(
                "the glove of --glove is for the {worn} hand; leave out --hand, or name a glove for the {side} hand"
            )));
        }
        (Some(side), _) | (None, Some(side)) => side,
        (None, None) => {
            let proposal = source.hand().unwrap_or(Side::Right).name();
            questions.ask(
                "which hand is measured, right or left",
                proposal,
                |answer| {
                    answer
                        .parse()
                        .map_err(|_| "answer `right` or `left`".to_owned())
                },
            )?
        }
    };
    Ok(Setup::for_hand(Some(source), side, args.glove.clone()))
}

/// Returns the hand of the glove that is named, if the source needs one.
fn side_of_glove(source: &SourceUri, args: &Args) -> Result<Option<Side>, Failure> {
    match &args.glove {
        Some(name) if source.needs_glove() => Ok(Some(Glove::load(name)?.side)),
        _ => Ok(None),
    }
}

/// Calibrates a new glove file beside the setup file, if the source needs one and the person wants it.
fn calibrate(
    setup: &mut Setup,
    args: &Args,
    questions: &Questions,
    beside: &Path,
) -> Result<(), Failure> {
    let source = setup.source.clone().filter(SourceUri::needs_glove);
    let Some(source) = source.filter(|_| args.glove.is_none() && !args.no_calibrate) else {
        return Ok(());
    };
    let reason = "a glove fits a hand better after a calibration: a few poses, one or two minutes";
    let mut out = io::stdout();
    writeln!(out, "{reason}")?;
    if !questions.confirm("calibrate now")? {
        return Ok(());
    }
    let stem = beside.file_stem().unwrap_or_default().to_string_lossy();
    let path = beside.with_file_name(format!("{stem}-glove.ron"));
    let before = fs::read(&path).ok();
    let calibration =
        calibrate::Args::for_source(source, setup.glove.clone(), path.clone(), args.countdown);
    signals::only_note_stop();
    calibrate::calibrate(calibration.forced(args.force))?;
    if signals::is_stop_requested() {
        return Err(interrupted());
    }
    if fs::read(&path).ok() != before {
        setup.glove = Some(path.to_string_lossy().into_owned());
    } else {
        let kept = "the setup uses the glove as it comes with the program";
        writeln!(out, "{kept}")?;
    }
    Ok(())
}
