//! `ademan layout`: creates, checks, lists and draws layouts.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::layout::Layout;
use ademan::message::escape;
use ademan::session::counted;
use ademan::setup::Setup;

use crate::failure::Failure;
use crate::list::{ListArgs, Row};
use crate::picture;

/// Create, check, list and draw layouts
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Create a layout as a copy of another one
    #[command(after_help = "Example: ademan layout new my-board --from qwerty-arc")]
    New {
        /// File to create (.ron is added); an existing file is not overwritten
        file: PathBuf,
        /// Layout to copy: the name of one that comes with the program, or a file
        #[arg(long, default_value = "qwerty-flat")]
        from: String,
    },
    /// Check files, report errors with line and column, and list keys out of reach of the default hand
    #[command(after_help = "Example: ademan layout check my-board.ron")]
    Check {
        /// Layout files, or names of layouts that come with the program
        #[arg(required = true)]
        files: Vec<String>,
    },
    /// List the layouts that come with the program
    #[command(after_help = "Example: ademan layout list")]
    List(ListArgs),
    /// Draw a layout in the terminal, or as a picture
    #[command(after_help = picture::EXAMPLES)]
    Show(picture::Args),
}

pub fn run(args: Args) -> Result<(), Failure> {
    match args.action {
        Action::New { file, from } => new(&file, &from),
        Action::Check { files } => check(&files),
        Action::List(args) => list(&args),
        Action::Show(args) => picture::show(&args),
    }
}

/// Checks every file, even after an invalid one.
fn check(files: &[String]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let mut invalid = 0;
    for file in files {
        match Layout::load(file) {
            Ok(layout) => {
                let keys = counted(layout.keys.len() as u64, "key");
                let layers = counted(layout.layers.len() as u64, "layer");
                let others = match layout.controls.len() as u64 {
                    0 => String::new(),
                    count => format!("{}, ", counted(count, "other control")),
                };
                let name = escape(file);
                writeln!(out, "{name}: valid, {keys}, {others}{layers}")?;
                warn_unreachable(file)?;
            }
            Err(error) => {
                say!("error: {error}");
                invalid += 1;
            }
        }
    }
    match invalid {
        0 => Ok(()),
        _ => Err(Failure::wrong_use(format!(
            "{invalid} of {} cannot be used",
            counted(files.len() as u64, "file")
        ))),
    }
}

/// Lists controls that the default hand cannot press. Such a layout is still valid.
fn warn_unreachable(file: &str) -> Result<(), Failure> {
    let setup = Setup {
        layout: file.into(),
        ..Setup::default()
    };
    let setup = setup.load_files()?;
    for (name, metres) in setup.out_of_reach() {
        let distance = match metres.is_finite() {
            true => format!("it is {:.0} mm out of reach", metres * 1e3),
            false => "it has no position".into(),
        };
        let (file, name) = (escape(file), escape(name));
        say!("warning: {file}: the default hand cannot press `{name}`: {distance}");
    }
    Ok(())
}

/// Copies a layout under the name of the new file.
fn new(file: &Path, from: &str) -> Result<(), Failure> {
    let path = match file.extension() {
        Some(_) => file.to_owned(),
        None => file.with_extension("ron"),
    };
    let original = Layout::load(from)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let name_field = format!("name: {:?}", original.name);
    let text = original
        .text
        .replacen(&name_field, &format!("name: {name:?}"), 1);
    let cannot_write =
        |error| Failure::wrong_use(format!("cannot write {}: {error}", path.display()));
    let mut created = File::create_new(&path).map_err(cannot_write)?;
    created.write_all(text.as_bytes()).map_err(cannot_write)?;
    let mut out = io::stdout().lock();
    let path = path.to_string_lossy();
    let (path, original) = (escape(&path), escape(&original.file));
    writeln!(out, "wrote {path}, a copy of {original}")?;
    writeln!(
        out,
        "edit it, then: ademan layout check {path} && ademan demo --layout {path}"
    )?;
    Ok(())
}

fn list(args: &ListArgs) -> Result<(), Failure> {
    let row = |(name, layout): (&str, Layout)| Row {
        name: name.into(),
        summary: escape(&layout.description).into_owned(),
        example: None,
    };
    let rows: Vec<Row> = Layout::shipped()?.into_iter().map(row).collect();
    args.print(&rows)
}
