//! `ademan layout show`: a layout in the terminal, or as a picture in a file.

pub mod convert;
mod json;

use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use ademan::document::{Document, FileKind};
use ademan::files::{self, FileError, OpenDocument};
use ademan::layout::{Layout, LayoutDraft, Wearer};
use ademan::message::{escape, escape_lines, escape_path};
use ademan::report::heats;
use ademan::setup::{ArmSetup, LoadedSetup, Setup};

use crate::failure::Failure;
use crate::view::look::Look;
use crate::{complete, lab, layout_check, result_files};

/// Examples of the command.
pub const EXAMPLES: &str = "Examples:\n  ademan layout show qwerty-arc\n  ademan layout show qwerty-arc --svg board.svg\n  ademan layout show qwerty-arc --hand 165,230 --svg small.svg\n  ademan layout show qwerty-arc --pdf board.pdf\n  ademan layout show media --html media.html --overwrite\n  ademan layout show game --svg - > game.svg\n  ademan layout show game --json - | jq .boards\n  ademan layout show qwerty-flat --heat result.json --svg missed.svg";

/// A layout and the files to draw it to.
#[derive(clap::Args)]
pub struct Args {
    /// A layout file, or the name of a layout that comes with the program
    #[arg(add = complete::layout())]
    pub file: String,
    /// Write a picture for documents and browsers; - is standard output
    #[arg(long, value_name = "OUT.svg")]
    svg: Option<PathBuf>,
    /// Write a picture of pixels; needs a program built with the feature `pictures`; - is standard output
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,
    /// Write a page to print, at the real size; needs a program built with the feature `pictures`; - is standard output
    #[arg(long, value_name = "OUT.pdf")]
    pdf: Option<PathBuf>,
    /// Write a page for browsers with a choice of layers; - is standard output
    #[arg(long, value_name = "OUT.html")]
    html: Option<PathBuf>,
    /// Write the boards and targets with their geometry in metres, for programs; - is standard output
    #[arg(long, value_name = "OUT.json")]
    json: Option<PathBuf>,
    /// Color the targets of --svg, --png or --pdf by a result of `ademan lab score`: how often they were missed
    #[arg(long, value_name = "RESULT.json")]
    heat: Option<PathBuf>,
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

/// Returns the drawing of a layout for standard output, whose terminal may lack box characters. Files and pipes have no locale.
fn drawing(layout: &Layout) -> String {
    let text = layout.to_text();
    let escaped = escape_lines(&text);
    if io::stdout().is_terminal() {
        Look::from_environment().text(&escaped).into_owned()
    } else {
        escaped.into_owned()
    }
}

/// Draws a layout to standard output, or to each of the files.
pub fn show(args: &Args) -> Result<(), Failure> {
    let document = Document::open_kind(FileKind::Layout, &args.file)?;
    let draft = LayoutDraft::from_document(&document)?;
    // A layout with faults is drawn first and refused afterwards.
    let refused = draft.error().cloned().map_or(Ok(()), Err);
    let targets = [&args.svg, &args.png, &args.pdf, &args.html, &args.json];
    let pictures = [&args.svg, &args.png, &args.pdf];
    if args.heat.is_some() && pictures.iter().all(|target| target.is_none()) {
        return Err(Failure::wrong_use(
            "--heat colors a picture; name its file with --svg, --png or --pdf",
        ));
    }
    if targets.iter().all(|target| target.is_none()) {
        io::stdout().write_all(drawing(draft.layout()).as_bytes())?;
        return Ok(refused?);
    }
    let (setup, wearer) = match refused {
        Ok(()) => {
            let setup = load(args, Some(draft.layout()))?;
            let wearer = setup.wearer();
            (setup, wearer)
        }
        Err(_) => load_faulty(args, &document)?,
    };
    // The layout as the setup fits it to the hand.
    let layout = &setup.layout;
    let draw_svg = || match &args.heat {
        Some(result) => heat_svg(layout, &wearer, &document, result),
        None => svg(layout, &wearer),
    };
    let drawers: [&dyn Fn() -> Result<Picture, Failure>; 5] = [
        &|| Ok(draw_svg()?.into_bytes()),
        &|| convert::png(&draw_svg()?).map_err(Failure::job),
        &|| convert::pdf(&draw_svg()?).map_err(Failure::job),
        &|| {
            let page = layout.to_html(&wearer).map_err(cannot_draw)?;
            Ok(page.into_bytes())
        },
        &|| Ok(json::from_layout(layout).into_bytes()),
    ];
    let person = setup.setup.person.as_deref();
    let person = person.and_then(|name| Document::open_kind(FileKind::Person, name).ok()?.path);
    let files_read = document.path.iter().chain(&args.heat).chain(&person);
    let mut read: Vec<PathBuf> = files_read.cloned().collect();
    read.extend(args.setup.iter().map(PathBuf::from));
    let named: Vec<&PathBuf> = targets.into_iter().flatten().collect();
    for (index, path) in named.iter().enumerate() {
        let mut others = named[..index].iter();
        if others.any(|other| files::is_same_file(path, other)) {
            return Err(Failure::wrong_use(format!(
                "{} is named for two files; name another one",
                escape_path(path)
            )));
        }
        refuse_existing(path, args.overwrite)?;
        if !is_standard_output(path) {
            result_files::check_not_read(path, &read)?;
        }
    }
    for (target, draw) in targets.into_iter().zip(drawers) {
        if let Some(path) = target {
            write(path, &draw()?, args.overwrite)?;
        }
    }
    Ok(refused?)
}

/// Returns the setup whose hands are drawn, with a layout that has faults, and the hands.
fn load_faulty(args: &Args, document: &Document) -> Result<(LoadedSetup, Wearer), Failure> {
    let mut setup = load(args, None)?;
    let draft = LayoutDraft::read(document, setup.layout.fit)?;
    setup.layout = draft.layout().clone();
    let wearer = Wearer {
        faults: draft.faults().to_vec(),
        ..setup.wearer()
    };
    Ok((setup, wearer))
}

/// Returns the setup whose hands are drawn, with the layout that is drawn or with the default one. For a drawing it does not matter
/// which profiles the setup has, and which keys it allows.
fn load(args: &Args, drawn: Option<&Layout>) -> Result<LoadedSetup, Failure> {
    let setup = match &args.setup {
        Some(path) => Setup::load(path)?,
        None => Setup::default(),
    };
    let mut setup = Setup {
        layout: drawn.map_or(Setup::default().layout, |_| args.file.clone()),
        arm: args.hand.clone().unwrap_or_else(|| setup.arm.clone()),
        person: args.person.clone().or(setup.person),
        allow_system_keys: true,
        ..setup
    };
    if let Some(layout) = drawn {
        layout_check::assume_profiles(&mut setup, layout);
    }
    Ok(setup.load_files()?)
}

fn svg(layout: &Layout, wearer: &Wearer) -> Result<String, Failure> {
    layout.to_svg(wearer).map_err(cannot_draw)
}

/// Returns a drawing of a layout with the colors of a result of the lab.
fn heat_svg(
    layout: &Layout,
    wearer: &Wearer,
    document: &Document,
    path: &Path,
) -> Result<String, Failure> {
    let results = lab::read_results(path)?;
    let of_layout = results.iter().find(|it| it.layout == document.text);
    let result = of_layout.ok_or_else(|| {
        let named: Vec<String> = results
            .iter()
            .map(|it| escape(&it.layout_file).into())
            .collect();
        Failure::wrong_use(format!(
            "{} is of {}, or the layout was changed since; run `ademan lab score` again",
            escape_path(path),
            named.join(" and ")
        ))
    })?;
    let what = match result.summary.characters {
        0 => "tasks that were not done",
        _ => "strokes that did not press what was meant",
    };
    let note = format!(
        "In color: {what}, of {}, source {}, seed {}",
        result.subjects(),
        result.source,
        result.seed
    );
    let heats = heats(layout, &result.scores);
    layout
        .to_heat_svg(wearer, &heats, &note)
        .map_err(cannot_draw)
}

fn cannot_draw(error: impl std::fmt::Display) -> Failure {
    Failure::wrong_use(error.to_string())
}

/// Refuses a file that exists before the time to draw is spent.
fn refuse_existing(path: &Path, overwrite: bool) -> Result<(), Failure> {
    let replaces = overwrite && !path.is_dir();
    if !is_standard_output(path) && !replaces && fs::symlink_metadata(path).is_ok() {
        Err(exists(path))
    } else {
        Ok(())
    }
}

fn write(path: &Path, picture: &[u8], overwrite: bool) -> Result<(), Failure> {
    if is_standard_output(path) {
        io::stdout().write_all(picture)?;
        return Ok(());
    }
    let written = if overwrite {
        files::replace(path, picture)
    } else {
        files::write_new(path, picture)
    };
    written.map_err(|error| match error {
        FileError::Exists => exists(path),
        FileError::Io(error) => Failure::wrong_use(format!(
            "cannot write {}: {error}; name a file in a folder that you can write to",
            escape_path(path)
        )),
        error => Failure::cannot_write(path, error),
    })?;
    say!("wrote {}", escape_path(path));
    Ok(())
}

fn exists(path: &Path) -> Failure {
    let name = escape_path(path);
    Failure::wrong_use(if path.is_dir() {
        format!("cannot write {name}: it is a folder; name a file in it")
    } else {
        format!("{name} exists and is not overwritten; name another file or add --overwrite")
    })
}

fn is_standard_output(path: &Path) -> bool {
    path == Path::new("-")
}
