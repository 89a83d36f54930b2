//! `ademan layout show`: a layout in the terminal, or as a picture in a file.

mod json;
mod png;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::files::{self, FileError, Load};
use ademan::layout::{Layout, Wearer};
use ademan::message::{escape_lines, escape_path};
use ademan::setup::{ArmSetup, LoadedSetup, Setup};

use crate::failure::Failure;
use crate::{complete, layout_check};

/// Examples of the command.
pub const EXAMPLES: &str = "Examples:\n  ademan layout show qwerty-arc\n  ademan layout show qwerty-arc --svg board.svg\n  ademan layout show qwerty-arc --hand 165,230 --svg small.svg\n  ademan layout show media --html media.html --overwrite\n  ademan layout show game --svg - > game.svg\n  ademan layout show game --json - | jq .boards";

/// A layout and the files to draw it to.
#[derive(clap::Args)]
pub struct Args {
    /// A layout file, or the name of a layout that comes with the program
    #[arg(add = complete::layout())]
    pub file: String,
    /// Write a picture for documents and browsers; - is standard output
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Write a picture of pixels; needs a program built with the feature `png`; - is standard output
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,
    /// Write a page for browsers with a choice of layers; - is standard output
    #[arg(long, value_name = "OUT.html")]
    html: Option<PathBuf>,
    /// Write the boards and targets with their geometry in metres, for programs; - is standard output
    #[arg(long, value_name = "OUT.json")]
    json: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    overwrite: bool,
    /// Setup whose hands are drawn, with their reach. Default: the hand of a setup without a file
    #[arg(long, value_name = "SETUP.ron", add = complete::setup())]
    setup: Option<String>,
    /// The hand that is drawn, with its reach, by its hand and forearm length in mm; layouts are fitted to it
    #[arg(long, value_name = "HAND,FOREARM", value_parser = layout_check::hand, conflicts_with = "setup")]
    hand: Option<ArmSetup>,
    /// The person whose hands are drawn, with their reach: the name of one that comes with the program, or a file
    #[arg(long, value_name = "FILE", add = complete::person(), conflicts_with = "hand")]
    person: Option<String>,
}

/// A picture of a file format.
type Picture = Vec<u8>;

/// Draws a layout to standard output, or to each of the files.
pub fn show(args: &Args) -> Result<(), Failure> {
    let layout = Layout::load(&args.file)?;
    let targets = [&args.svg, &args.png, &args.html, &args.json];
    if targets.iter().all(|target| target.is_none()) {
        io::stdout().write_all(escape_lines(&layout.to_text()).as_bytes())?;
        return Ok(());
    }
    let setup = load(args)?;
    // As the setup fits it to the hand.
    let (layout, wearer) = (&setup.layout, setup.wearer());
    let drawers: [&dyn Fn() -> Result<Picture, Failure>; 4] = [
        &|| Ok(svg(layout, &wearer)?.into_bytes()),
        &|| png::from_svg(&svg(layout, &wearer)?).map_err(Failure::job),
        &|| {
            let page = layout.to_html(&wearer).map_err(cannot_draw)?;
            Ok(page.into_bytes())
        },
        &|| Ok(json::from_layout(layout).into_bytes()),
    ];
    for (target, draw) in targets.into_iter().zip(drawers) {
        if let Some(path) = target {
            refuse_existing(path, args.overwrite)?;
            write(path, &draw()?, args.overwrite)?;
        }
    }
    Ok(())
}

/// Returns the setup whose hands are drawn, with the layout.
fn load(args: &Args) -> Result<LoadedSetup, Failure> {
    let setup = match &args.setup {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    let setup = Setup {
        layout: args.file.clone(),
        arm: args.hand.clone().unwrap_or_else(|| setup.arm.clone()),
        person: args.person.clone().or(setup.person),
        ..setup
    };
    Ok(setup.load_files()?)
}

fn svg(layout: &Layout, wearer: &Wearer) -> Result<String, Failure> {
    layout.to_svg(wearer).map_err(cannot_draw)
}

fn cannot_draw(error: impl std::fmt::Display) -> Failure {
    Failure::wrong_use(error.to_string())
}

/// Refuses a file that exists before the time to draw is spent.
fn refuse_existing(path: &Path, overwrite: bool) -> Result<(), Failure> {
    let replaces = overwrite && !path.is_dir();
    match !is_standard_output(path) && !replaces && fs::symlink_metadata(path).is_ok() {
        true => Err(exists(path)),
        false => Ok(()),
    }
}

fn write(path: &Path, picture: &[u8], overwrite: bool) -> Result<(), Failure> {
    if is_standard_output(path) {
        io::stdout().write_all(picture)?;
        return Ok(());
    }
    let file = match overwrite {
        true => files::replace(path),
        false => files::create_new(path),
    };
    let written = file.and_then(|mut file| Ok(file.write_all(picture)?));
    written.map_err(|error| match error {
        FileError::Exists => exists(path),
        FileError::Io(error) => Failure::wrong_use(format!(
            "cannot write {}: {error}; name a file in a folder that you can write to",
            escape_path(path)
        )),
        error => Failure::wrong_use(format!("cannot write {}: {error}", escape_path(path))),
    })?;
    say!("wrote {}", escape_path(path));
    Ok(())
}

fn exists(path: &Path) -> Failure {
    let name = escape_path(path);
    Failure::wrong_use(match path.is_dir() {
        true => format!("cannot write {name}: it is a folder; name a file in it"),
        false => {
            format!("{name} exists and is not overwritten; name another file or add --overwrite")
        }
    })
}

fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-")
}
