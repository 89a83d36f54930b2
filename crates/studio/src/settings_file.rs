//! The file of the settings. A write waits for the disk, so that a thread of its own makes it while the window is open.

use std::fs;
use std::io::{self, Read};
use std::mem;
use std::path::{Path, PathBuf};

use super::playback::{Job, JobLost};
use super::settings::Settings;
use ademan_core::message::escape_path;
use ademan_runtime::files::{self, FileError};

/// Shortest time between two writes, in seconds.
const WRITE_PERIOD: f64 = 5.0;

/// The most that is read, in bytes.
const MAX_BYTES: u64 = 64 * 1024;

/// Reason why settings are not read or not kept.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// The file exists and cannot be read.
    #[error("the settings are not read: {0}; Studio starts with its defaults, and renames the file to end in .broken before it writes others: {path}", path = escape_path(.1))]
    Read(String, PathBuf),
    /// The file cannot be written.
    #[error("the settings are not kept: {0}; free the disk or change the permissions: {path}", path = escape_path(.1))]
    Write(String, PathBuf),
}

/// The file, or none: then nothing is remembered.
#[derive(Default)]
pub struct SettingsFile {
    path: Option<PathBuf>,
    /// The content of the file, or of the last attempt to write it.
    saved: Settings,
    /// Time of the last write, in seconds of the window.
    written_at: f64,
    /// The last write, until it has ended.
    writing: Option<Job<Result<(), String>>>,
}

/// Settings that are to be written.
struct Write {
    path: PathBuf,
    settings: Settings,
    /// The settings that were written before.
    before: Settings,
}

impl SettingsFile {
    /// Returns the path of the file of this person. `None` if the system has no folder for it.
    pub fn default_path() -> Option<PathBuf> {
        Some(files::config_folder()?.join("studio.ron"))
    }

    /// Reads a file. One that does not exist has the defaults, and so does a broken one, with the reason.
    pub fn open(path: PathBuf) -> (Self, Settings, Option<SettingsError>) {
        let (settings, error) = match read(&path) {
            Ok(settings) => (settings.unwrap_or_default().checked(), None),
            Err(reason) => (
                Settings {
                    // There is a file because Studio has been started before.
                    has_seen_tour: true,
                    ..Settings::default()
                },
                Some(SettingsError::Read(reason, path.clone())),
            ),
        };
        let file = Self {
            path: Some(path),
            saved: settings.clone(),
            written_at: f64::MIN,
            writing: None,
        };
        (file, settings, error)
    }

    /// Writes settings that have changed, on a thread of its own, unless the last write was less than 5 s ago or has not ended. Returns
    /// the error of the last write. `now` is in seconds.
    pub fn save_at(&mut self, now: f64, settings: &Settings) -> Result<(), SettingsError> {
        if let Some(writing) = &self.writing {
            let Some(written) = writing.poll() else {
                return Ok(());
            };
            self.writing = None;
            self.check(written)?;
        }
        if now - self.written_at < WRITE_PERIOD {
            return Ok(());
        }
        if let Some(write) = self.next_write(settings) {
            self.written_at = now;
            self.writing = Some(Job::start(|| write.run()));
        }
        Ok(())
    }

    /// Writes settings that have changed, and waits until they are on the disk. Recent files that another window has written are kept, and
    /// so is a file that cannot be read: its name ends in `.broken` then.
    pub fn save(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        let last = self.finish();
        match self.next_write(settings) {
            Some(write) => self.check(Ok(write.run())),
            None => last,
        }
    }

    /// Waits for the last write, and returns its error.
    fn finish(&mut self) -> Result<(), SettingsError> {
        match self.writing.take() {
            Some(writing) => self.check(writing.wait()),
            None => Ok(()),
        }
    }

    /// Returns the write of settings that have changed, which counts as made.
    fn next_write(&mut self, settings: &Settings) -> Option<Write> {
        let path = self.path.clone().filter(|_| *settings != self.saved)?;
        // A disk that is full is reported once, and tried again after the next change.
        let before = mem::replace(&mut self.saved, settings.clone());
        Some(Write {
            path,
            settings: settings.clone(),
            before,
        })
    }

    /// Returns the error of a write.
    fn check(&self, written: Result<Result<(), String>, JobLost>) -> Result<(), SettingsError> {
        let result = written.unwrap_or_else(|lost| Err(lost.to_string()));
        result.map_err(|reason| SettingsError::Write(reason, self.path.clone().unwrap_or_default()))
    }
}

impl Write {
    fn run(self) -> Result<(), String> {
        let merged = kept_beside(&self.path, &self.settings, &self.before)?;
        write(&self.path, &merged)
    }
}

fn read(path: &Path) -> Result<Option<Settings>, String> {
    let file = match files::open_regular(path) {
        Err(FileError::Io(error)) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        file => file.map_err(|error| error.to_string())?,
    };
    let mut text = String::new();
    let read = file.take(MAX_BYTES).read_to_string(&mut text);
    read.map_err(|error| error.to_string())?;
    ron::from_str(&text)
        .map(Some)
        .map_err(|error| error.to_string())
}

/// Returns the settings with the recent files that another window has written since `before` was read. A file that cannot be read is
/// renamed.
fn kept_beside(path: &Path, settings: &Settings, before: &Settings) -> Result<Settings, String> {
    let mut kept = settings.clone();
    match read(path) {
        Ok(Some(present)) => kept.merge_recent(&present, before),
        Ok(None) => {}
        Err(_) => fs::rename(path, broken_name(path)).map_err(|error| error.to_string())?,
    }
    Ok(kept)
}

/// Returns the name that a file which cannot be read is given: the first one without a file.
fn broken_name(path: &Path) -> PathBuf {
    let name = |number: u32| match number {
        1 => path.with_added_extension("broken"),
        _ => path.with_added_extension(format!("broken.{number}")),
    };
    let mut number = 1;
    while name(number).symlink_metadata().is_ok() {
        number += 1;
    }
    name(number)
}

/// Writes the file. A reader finds the old or the new content, also after a loss of power.
fn write(path: &Path, settings: &Settings) -> Result<(), String> {
    let config = ron::ser::PrettyConfig::default();
    let text = ron::ser::to_string_pretty(settings, config).map_err(|error| error.to_string())?;
    fs::create_dir_all(files::folder_of(path)).map_err(|error| error.to_string())?;
    files::replace_private_text(path, &text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scaled(scale: f32) -> Settings {
        Settings {
            scale,
            ..Settings::default()
        }
    }

    #[test]
    fn settings_are_read_as_they_were_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("ademan/studio.ron");
        let (mut file, first, error) = SettingsFile::open(path.clone());
        assert!(error.is_none(), "{error:?}");
        assert_eq!(first, Settings::default());
        file.save(&scaled(1.5)).expect("a write");
        let (_, again, again_error) = SettingsFile::open(path);
        assert!(again_error.is_none(), "{again_error:?}");
        assert_eq!(again, scaled(1.5));
        let left = fs::read_dir(folder.path().join("ademan")).expect("the folder");
        assert_eq!(left.count(), 1, "the temporary file is renamed");
    }

    #[test]
    fn a_broken_file_is_reported_and_the_defaults_are_used() {
        let folder = tempfile::tempdir().expect("a folder");
        for broken in ["(scale: \"large\")", "(", "\u{1}"] {
            let path = folder.path().join("studio.ron");
            fs::write(&path, broken).expect("a write");
            let (_, settings, error) = SettingsFile::open(path);
            assert_eq!(settings.scale, Settings::default().scale);
            assert!(settings.has_seen_tour);
            let message = error.expect("a message").to_string();
            assert!(message.contains("studio.ron"), "{message}");
        }
    }

    #[test]
    fn a_broken_file_is_renamed_before_others_are_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("studio.ron");
        let text = |name: &str| fs::read_to_string(folder.path().join(name));
        for (broken, name) in [
            ("(scale: \"large\")", "studio.ron.broken"),
            ("(", "studio.ron.broken.2"),
        ] {
            fs::write(&path, broken).expect("a write");
            let (mut file, settings, error) = SettingsFile::open(path.clone());
            let message = error.expect("a message").to_string();
            assert!(message.contains(".broken"), "{message}");
            file.save(&settings).expect("nothing has changed");
            assert_eq!(text("studio.ron").expect("the file"), broken);
            file.save(&scaled(1.5)).expect("a write");
            assert_eq!(text(name).expect("the broken file"), broken);
            assert_eq!(SettingsFile::open(path.clone()).1, scaled(1.5));
        }
        let first = text("studio.ron.broken").expect("the first broken file");
        assert_eq!(first, "(scale: \"large\")");
    }

    #[test]
    fn two_windows_keep_the_recent_files_of_each_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("studio.ron");
        let (mut one, mut of_one, _) = SettingsFile::open(path.clone());
        let (mut other, mut of_other, _) = SettingsFile::open(path.clone());
        of_one.recent_layouts.push(Path::new("/one.ron"));
        one.save(&of_one).expect("a write");
        of_other.recent_layouts.push(Path::new("/other.ron"));
        of_other.recent_recordings.push(Path::new("/other.mcap"));
        other.save(&of_other).expect("a write");
        of_one.scale = 1.5;
        one.save(&of_one).expect("a write");
        let (_, kept, _) = SettingsFile::open(path);
        let layouts: Vec<&str> = kept.recent_layouts.iter().collect();
        assert_eq!(layouts, ["/other.ron", "/one.ron"]);
        assert_eq!(kept.recent_recordings, of_other.recent_recordings);
        assert_eq!(kept.scale, 1.5);
    }

    #[test]
    fn changes_are_written_every_few_seconds() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("studio.ron");
        let scale = || SettingsFile::open(path.clone()).1.scale;
        let (mut file, ..) = SettingsFile::open(path.clone());
        file.save_at(10.0, &scaled(1.25)).expect("a write");
        file.finish().expect("the write");
        file.save_at(12.0, &scaled(1.5)).expect("no write");
        file.finish().expect("no write");
        assert_eq!(scale(), 1.25);
        file.save_at(15.0, &scaled(1.5)).expect("a write");
        file.finish().expect("the write");
        assert_eq!(scale(), 1.5);
    }

    #[test]
    fn the_last_settings_are_on_the_disk_although_a_write_has_not_ended() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("studio.ron");
        let (mut file, ..) = SettingsFile::open(path.clone());
        file.save_at(10.0, &scaled(1.25)).expect("a write");
        file.save(&scaled(1.5)).expect("a write");
        assert_eq!(SettingsFile::open(path).1, scaled(1.5));
    }

    #[test]
    fn a_file_that_cannot_be_written_is_reported_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut file, ..) = SettingsFile::open(folder.path().join("no-folder/studio.ron"));
        fs::write(folder.path().join("no-folder"), "a file").expect("a write");
        assert!(file.save(&scaled(1.5)).is_err());
        assert!(file.save(&scaled(1.5)).is_ok());
        assert!(file.save_at(10.0, &scaled(2.0)).is_ok(), "it is written");
        assert!(file.finish().is_err());
        assert!(file.save(&scaled(2.0)).is_ok());
    }
}
