//! A layout in force and the file that it is from.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use crossbeam_channel::{Receiver, Sender, bounded, select};

use super::watched_file::WatchedFile;
use super::{FileCall, FileOrder, Report};
use crate::contact::place::Place;
use crate::layout::{self, Document, Layout, LayoutError};
use crate::pipeline::Controls;
use crate::runtime::Replacement;

const SHIPPED: &str = "the layout comes with the program: there is no file of yours, begin one with \
     `ademan layout new`";

/// The run has ended.
pub(super) struct Over;

/// Looks after one layout of a setup.
pub(super) struct Keeper<A> {
    /// `None` where the layout comes with the program.
    pub file: Option<WatchedFile>,
    /// What is in force, apart from where its boards were moved to.
    pub layout: Layout,
    pub profile: usize,
    pub replacements: Sender<Replacement>,
    pub ended: Receiver<()>,
    /// Makes controls of a layout that this run can use.
    pub accept: A,
}

impl<A: Fn(&Layout) -> Result<Controls, String>> Keeper<A> {
    /// Looks whether the file was saved, and puts it in force if so.
    pub fn look(&mut self) -> Result<Option<Report>, Over> {
        let found = self.file.as_mut().and_then(|file| file.look(Instant::now()));
        found.map(|found| self.take(found)).transpose()
    }

    /// Does what it is asked for and says what came of it.
    pub fn obey(&mut self, call: FileCall) -> Result<Option<Report>, Over> {
        let mut outcome = None;
        let answer = match call.order {
            FileOrder::Reload => match &self.file {
                None => Err(SHIPPED.into()),
                Some(file) => {
                    let report = self.take(file.read_now())?;
                    let text = report.to_string();
                    let is_in_force = matches!(report, Report::Replaced(_));
                    outcome = Some(report);
                    if is_in_force { Ok(text) } else { Err(text) }
                }
            },
            FileOrder::Scale(factor) => self.scale(factor)?,
            FileOrder::Save(places) => self.save(&places),
        };
        // Whoever asked may have gone away.
        let _ = call.answer.try_send(answer);
        Ok(outcome)
    }

    fn take(&mut self, found: Result<Layout, LayoutError>) -> Result<Report, Over> {
        let layout = match found {
            Err(error) => return Ok(Report::Wrong(error)),
            Ok(layout) => layout,
        };
        match (self.accept)(&layout) {
            Err(reason) => return Ok(Report::Refused(reason)),
            Ok(controls) => self.replace(controls, false)?,
        }
        if let Some(file) = &mut self.file {
            file.is_in_force(&layout.text);
        }
        self.layout = layout.clone();
        Ok(Report::Replaced(layout))
    }

    fn scale(&mut self, factor: f32) -> Result<Result<String, String>, Over> {
        let layout = layout::scaled(&self.document(), factor)
            .and_then(|text| Layout::parse(&text, &self.layout.file));
        let layout = match layout {
            Err(error) => return Ok(Err(format!("{error}\nthe boards stay as large as they are"))),
            Ok(layout) => layout,
        };
        match (self.accept)(&layout) {
            Err(reason) => return Ok(Err(reason)),
            Ok(controls) => self.replace(controls, true)?,
        }
        self.layout = layout;
        Ok(Ok(format!("{factor} times as large")))
    }

    /// Writes where the boards are into the file, if nobody has changed it.
    fn save(&mut self, places: &[Place]) -> Result<String, String> {
        let file = self.file.as_mut().ok_or(SHIPPED)?;
        let name = &self.layout.file;
        let on_disk = Document::at(file.path()).map_err(|error| error.to_string())?;
        if on_disk.text != file.text() {
            return Err(format!(
                "{name}: not saved, as the file is not the one in force; `reload` puts it in force"
            ));
        }
        let in_force = Document::new(name.as_str(), self.layout.text.as_str());
        let text = layout::moved(&in_force, places).map_err(|error| error.to_string())?;
        if text == on_disk.text {
            return Err(format!("{name}: not saved, as nothing was moved"));
        }
        let layout = Layout::parse(&text, name).map_err(|error| error.to_string())?;
        write(Path::new(file.path()), &text)
            .map_err(|error| format!("{name}: cannot write the file: {error}"))?;
        file.is_in_force(&text);
        self.layout = layout;
        Ok(format!("{}: saved", self.layout.file))
    }

    fn document(&self) -> Document {
        Document::new(self.layout.file.as_str(), self.layout.text.as_str())
    }

    /// Hands controls to the loop, waits until they are in force, and frees the old ones.
    fn replace(&self, controls: Controls, keeps_places: bool) -> Result<(), Over> {
        let (replaced, old) = bounded(1);
        let replacement = Replacement {
            controls: Box::new(controls),
            profile: self.profile,
            keeps_places,
            replaced,
        };
        select! {
            send(self.replacements, replacement) -> sent => sent.map_err(|_| Over)?,
            recv(self.ended) -> _ => return Err(Over),
        }
        select! {
            recv(old) -> old => old.map(drop).map_err(|_| Over),
            recv(self.ended) -> _ => Err(Over),
        }
    }
}

/// Puts a text in the place of a file: whoever reads it sees the old one or the new one, also when the
/// machine stops halfway. Who may read and write it stays, and so does a link to it.
fn write(path: &Path, text: &str) -> io::Result<()> {
    let path = fs::canonicalize(path)?;
    let permissions = fs::metadata(&path)?.permissions();
    if permissions.readonly() {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "it may only be read",
        ));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".{name}.{}", std::process::id()));
    let written = fs::File::options()
        .write(true)
        .create_new(true)
        .open(&beside)
        .and_then(|mut file| {
            file.set_permissions(permissions)?;
            file.write_all(text.as_bytes())?;
            file.sync_all()
        })
        .and_then(|()| fs::rename(&beside, &path));
    if written.is_err() {
        let _ = fs::remove_file(&beside);
    }
    written
}
