//! The layout that a sensor can use.

use std::io::{self, Write};
use std::path::Path;

use ademan::document::Document;
use ademan::files::Load;
use ademan::layout::Layout;
use ademan::message::{escape, escape_path};
use ademan::setup::{MirroredLayout, Setup};

use super::question::Questions;
use crate::failure::Failure;
use crate::new_file;

/// A layout that was chosen.
pub struct Chosen {
    /// Its name, or the path of its file.
    pub name: String,
    /// The text of a file that is not there.
    text: Option<String>,
}

impl Chosen {
    fn existing(name: String) -> Self {
        Self { name, text: None }
    }

    /// Returns the mirror image of a layout, in a file beside the setup. A file that is there stays as it is.
    pub fn mirrored(mirrored: &MirroredLayout, beside: &Path) -> Result<Self, Failure> {
        let path = beside.with_file_name(format!("{}.ron", mirrored.name()));
        let file = path.to_string_lossy().into_owned();
        if path.exists() {
            return Ok(Self::existing(file));
        }
        let original = Layout::from_document(Document::shipped(mirrored.original)?)?;
        Ok(Self {
            name: file,
            text: Some(new_file::renamed(&mirrored.text, &original.name, &path)),
        })
    }

    /// Writes the file, if it is not there.
    pub fn write(&self) -> Result<(), Failure> {
        let Some(text) = &self.text else {
            return Ok(());
        };
        let path = Path::new(&self.name);
        new_file::write(path, text)?;
        Ok(writeln!(io::stdout(), "wrote {}", escape_path(path))?)
    }
}

/// Chooses the layout of a setup: the given one, or the answer to a proposal. The mirror image of a layout is for a file `beside` the
/// setup.
pub fn choose(
    given: Option<&str>,
    setup: &Setup,
    questions: &Questions,
    beside: &Path,
) -> Result<Chosen, Failure> {
    if let Some(name) = given {
        Layout::load(name)?;
        return Ok(Chosen::existing(name.to_owned()));
    }
    let mut out = io::stdout();
    let mirrored = setup.mirrored_layout()?;
    if let Some(mirrored) = &mirrored {
        let (original, name) = (mirrored.original, mirrored.name());
        writeln!(
            out,
            "{original} is for a right hand; {name}.ron is its mirror image"
        )?;
    }
    let mirrored = mirrored.map(|layout| Chosen::mirrored(&layout, beside));
    let mirrored = mirrored.transpose()?;
    let proposal = match &mirrored {
        Some(mirrored) => mirrored.name.clone(),
        None => setup.proposed_layout()?.to_owned(),
    };
    let is_new = |name: &str| {
        let file = mirrored.as_ref().filter(|it| it.text.is_some());
        file.is_some_and(|it| it.name == name)
    };
    let name = questions.ask("layout, or the file of one", &proposal, |name| {
        if is_new(name) {
            return Ok(name.to_owned());
        }
        let loaded = Layout::load(name).map(|_| name.to_owned());
        loaded.map_err(|error| error.to_string())
    })?;
    writeln!(out, "layout: {}", escape(&name))?;
    let chosen = mirrored.filter(|it| it.name == name);
    Ok(chosen.unwrap_or_else(|| Chosen::existing(name)))
}
