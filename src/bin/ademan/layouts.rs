//! `ademan layout`: check, list and draw.

use std::io::Write;
use std::path::Path;

use ademan::layout::Layout;

use crate::args::LayoutCommand;
use crate::failure::Failure;
use crate::status::counted;

pub fn run(command: &LayoutCommand) -> Result<(), Failure> {
    match command {
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
                writeln!(out, "{file}: right, {keys}, {layers}")?;
            }
            Err(error) => {
                eprintln!("error: {error}");
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

fn list() -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    for (name, layout) in Layout::shipped()? {
        writeln!(out, "{name:18} {}", layout.note)?;
    }
    Ok(())
}

fn show(file: &str, svg: Option<&Path>) -> Result<(), Failure> {
    let layout = Layout::load(file)?;
    let Some(path) = svg else {
        std::io::stdout().write_all(layout.draw().as_bytes())?;
        return Ok(());
    };
    std::fs::write(path, layout.svg())
        .map_err(|error| Failure::wrong_use(format!("cannot write {}: {error}", path.display())))?;
    writeln!(std::io::stdout(), "wrote {}", path.display())?;
    Ok(())
}
