//! `ademan layout`: begin, check, list and draw.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use ademan::layout::Layout;
use ademan::setup::Setup;

use crate::args::LayoutCommand;
use crate::failure::Failure;
use crate::status::counted;

pub fn run(command: &LayoutCommand) -> Result<(), Failure> {
    match command {
        LayoutCommand::New { file, from } => new(file, from),
        LayoutCommand::Check { files } => check(files),
        LayoutCommand::List => list(),
        LayoutCommand::Show { file, svg } => show(file, svg.as_deref()),
    }
}

/// Checks every file, also after one that is wrong.
fn check(files: &[String]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let mut wrong = 0;
    for file in files {
        match Layout::load(file) {
            Ok(layout) => {
                let keys = counted(layout.keys.len() as u64, "key");
                let layers = counted(layout.layers.len() as u64, "layer");
                let others = match layout.controls.len() as u64 {
                    0 => String::new(),
                    count => format!("{}, ", counted(count, "other control")),
                };
                writeln!(out, "{file}: right, {keys}, {others}{layers}")?;
                warn_of_reach(file)?;
            }
            Err(error) => {
                say!("error: {error}");
                wrong += 1;
            }
        }
    }
    match wrong {
        0 => Ok(()),
        _ => Err(Failure::wrong_use(format!(
            "{wrong} of {} cannot be used",
            counted(files.len() as u64, "file")
        ))),
    }
}

/// Names the keys and other controls that the default hand cannot press: the file is right all the same.
fn warn_of_reach(file: &str) -> Result<(), Failure> {
    let setup = Setup {
        layout: file.into(),
        ..Setup::default()
    };
    let assembly = setup.load_files()?;
    for (name, metres) in assembly.out_of_reach() {
        let far = match metres.is_finite() {
            true => format!("{:.0} mm beyond its reach", metres * 1e3),
            false => "it is nowhere".into(),
        };
        say!("warning: {file}: the default hand cannot press `{name}`: {far}");
    }
    Ok(())
}

/// Begins a layout of one's own as a copy of another, under a name of its own.
fn new(file: &Path, from: &str) -> Result<(), Failure> {
    let path = match file.extension() {
        Some(_) => file.to_owned(),
        None => file.with_extension("ron"),
    };
    let model = Layout::load(from)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let named = format!("name: {:?}", model.name);
    let text = model.text.replacen(&named, &format!("name: {name:?}"), 1);
    let refused = |error| Failure::wrong_use(format!("cannot write {}: {error}", path.display()));
    let mut created = File::create_new(&path).map_err(refused)?;
    created.write_all(text.as_bytes()).map_err(refused)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "wrote {} after {}", path.display(), model.file)?;
    writeln!(
        out,
        "change it, then: ademan layout check {0} && ademan demo --layout {0}",
        path.display()
    )?;
    Ok(())
}

fn list() -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    for (name, layout) in Layout::shipped()? {
        writeln!(out, "{name:18} {}", layout.description)?;
    }
    Ok(())
}

fn show(file: &str, svg: Option<&Path>) -> Result<(), Failure> {
    let layout = Layout::load(file)?;
    let Some(path) = svg else {
        std::io::stdout().write_all(layout.to_text().as_bytes())?;
        return Ok(());
    };
    std::fs::write(path, layout.to_svg())
        .map_err(|error| Failure::wrong_use(format!("cannot write {}: {error}", path.display())))?;
    writeln!(std::io::stdout(), "wrote {}", path.display())?;
    Ok(())
}
