//! The trials of a study: a file for each of them in the folder of the study, readable by its owner only.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use ademan::files;
use ademan::measures::has_possible_counts;
use ademan::message::{escape_line, escape_path};
use ademan::study::{Study, Trial, TrialKind};

use super::outputs;
use crate::failure::Failure;

/// The folder of the trials, in the folder of the study.
pub const FOLDER: &str = "trials";

/// Returns the files of the trials of a study, with their recordings; none if they cannot be listed.
pub fn paths(study: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(study.join(FOLDER)).into_iter().flatten();
    entries.flatten().map(|entry| entry.path()).collect()
}

/// The trials so far.
pub struct Trials {
    folder: PathBuf,
    /// In the order of their time.
    pub all: Vec<Trial>,
}

impl Trials {
    /// Reads the trials of a study.
    pub fn read(study: &Path) -> Result<Self, Failure> {
        let folder = study.join(FOLDER);
        files::create_private_folder(&folder).map_err(|error| {
            let folder = escape_path(&folder);
            Failure::job(format!("cannot use the folder {folder}: {error}"))
        })?;
        let mut all = Vec::new();
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            let is_hidden = path
                .file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if is_hidden || path.extension().is_none_or(|it| it != "json") {
                continue;
            }
            let cannot = |error: String| {
                let path = escape_path(&path);
                let error = escape_line(&error);
                Failure::wrong_use(format!(
                    "cannot read the trial {path}: {error}; move it and the recording beside it to another folder to continue without them, as the next trial may have their number"
                ))
            };
            let text = outputs::read_text(&path).map_err(cannot)?;
            let trial: Trial =
                serde_json::from_str(&text).map_err(|error| cannot(error.to_string()))?;
            if !has_possible_counts(&trial) {
                return Err(cannot("a count is larger than any trial gives".to_owned()));
            }
            all.push(trial);
        }
        all.sort_by(|a: &Trial, b| {
            let key = |it: &Trial| (it.time.clone(), it.participant.clone(), it.order);
            key(a).cmp(&key(b))
        });
        Ok(Self { folder, all })
    }

    /// Returns the trials of a participant.
    pub fn of<'a>(&'a self, participant: &'a str) -> impl Iterator<Item = &'a Trial> {
        self.all
            .iter()
            .filter(move |it| it.participant == participant)
    }

    /// Returns the tasks of a study that a participant has not done, in their order: the indices of the layout and of its task. Trials of
    /// other tasks do not count.
    pub fn remaining(&self, study: &Study, participant: &str) -> Vec<(usize, usize)> {
        let order = study.order(self.participants_before(participant));
        let remaining = order.into_iter().filter(|&(layout, task)| {
            let name = &study.layouts[layout].name;
            let mut done = self.of(participant);
            !done.any(|trial| trial.layout == *name && trial.task == Some(task))
        });
        remaining.collect()
    }

    /// Returns the number of participants whose first trial was before the first one of a participant. Practice does not count: it is
    /// older than the study, and added to it at any time.
    pub fn participants_before(&self, participant: &str) -> usize {
        let mut names: Vec<&str> = Vec::new();
        let tasks = self
            .all
            .iter()
            .filter(|trial| trial.kind != TrialKind::Practice);
        for trial in tasks {
            if trial.participant == participant {
                break;
            }
            if !names.contains(&trial.participant.as_str()) {
                names.push(&trial.participant);
            }
        }
        names.len()
    }

    /// Returns the number of the next trial of a participant.
    pub fn next_order(&self, participant: &str) -> usize {
        self.of(participant)
            .map(|it| it.order + 1)
            .max()
            .unwrap_or(0)
    }

    /// Returns the path of the recording of a trial.
    pub fn recording(&self, participant: &str, order: usize) -> PathBuf {
        self.folder.join(format!("{participant}-{order:04}.mcap"))
    }

    /// Keeps a trial. An existing one is never replaced.
    pub fn keep(&mut self, trial: Trial) -> Result<(), Failure> {
        let name = format!("{}-{:04}.json", trial.participant, trial.order);
        let path = self.folder.join(name);
        let text = serde_json::to_string_pretty(&trial).map_err(io::Error::from)? + "\n";
        let written = match path.symlink_metadata() {
            Ok(_) => Err(files::FileError::Exists),
            Err(_) => files::replace_private_text(&path, &text),
        };
        written.map_err(|error| {
            Failure::job(format!(
                "cannot keep the trial {}: {error}; run the command again to repeat the task, which replaces the recording beside it",
                escape_path(&path)
            ))
        })?;
        self.all.push(trial);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damaged_trial_is_named_with_the_recording_that_the_next_one_would_replace() {
        let study = tempfile::tempdir().unwrap();
        Trials::read(study.path()).unwrap();
        fs::write(study.path().join("trials/P01-0000.json"), "{").unwrap();
        let Err(failure) = Trials::read(study.path()) else {
            panic!("a damaged trial is read");
        };
        let refused = failure.to_string();
        for words in ["P01-0000.json", "move it and the recording beside it"] {
            assert!(refused.contains(words), "{refused}");
        }
        let empty = Trials {
            folder: study.path().join(FOLDER),
            all: Vec::new(),
        };
        let next = empty.recording("P01", empty.next_order("P01"));
        assert_eq!(next.file_name().unwrap(), "P01-0000.mcap");
    }

    #[test]
    fn a_trial_whose_number_has_no_next_one_is_refused() {
        let study = tempfile::tempdir().unwrap();
        Trials::read(study.path()).unwrap();
        let order = usize::MAX;
        let text = format!(
            "{{\"participant\":\"P01\",\"order\":{order},\"layout\":\"board\",\"kind\":\"phrase\",\"task\":0,\"time\":\"\",\
             \"is_simulated\":false,\"program_version\":\"\",\"seconds\":1.0}}"
        );
        fs::write(study.path().join("trials/P01-0000.json"), text).unwrap();
        let failure = Trials::read(study.path()).err().expect("a refusal");
        assert!(failure.to_string().contains("a count is larger"));
    }

    #[test]
    fn what_a_trial_states_begins_no_line_of_a_message() {
        let study = tempfile::tempdir().unwrap();
        Trials::read(study.path()).unwrap();
        let text = "{\"participant\":\"P01\",\"order\":0,\"layout\":\"board\",\"kind\":\"x\\nerror: forged\"}";
        fs::write(study.path().join("trials/P01-0000.json"), text).unwrap();
        let failure = Trials::read(study.path()).err().expect("a refusal");
        let refused = failure.to_string();
        assert!(refused.contains("error: forged"), "{refused}");
        assert!(!refused.contains('\n'), "{refused}");
    }

    #[test]
    fn practice_that_is_added_later_does_not_change_the_order_of_the_layouts() {
        let trial = |participant: &str, time: &str, kind: TrialKind| -> Trial {
            let kind = kind.name();
            let text = format!(
                "{{\"participant\":\"{participant}\",\"order\":0,\"layout\":\"board\",\"kind\":\"{kind}\",\"task\":null,\"time\":\"{time}\",\
                 \"is_simulated\":false,\"program_version\":\"\",\"seconds\":1.0}}"
            );
            serde_json::from_str(&text).expect("a trial")
        };
        // In the order of their times, as they are read.
        let trials = Trials {
            folder: PathBuf::new(),
            all: vec![
                trial("P03", "2026-01-01T00:00:00Z", TrialKind::Practice),
                trial("P01", "2026-01-02T00:00:00Z", TrialKind::Phrase),
                trial("P02", "2026-01-03T00:00:00Z", TrialKind::Phrase),
            ],
        };
        let before = ["P01", "P02", "P03"].map(|name| trials.participants_before(name));
        assert_eq!(before, [0, 1, 2]);
    }
}
