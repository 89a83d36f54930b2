//! The results of earlier practice, one line of JSON each, in a file that only its owner can read.

use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use ademan::files::{self, FileError, LockedFile};
use ademan::measures::PointingResult;
use ademan::message::{escape, escape_path, quote_csv};
use ademan::session::counted;
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::new_file;

/// Sessions that are kept. Older ones are dropped.
const MAX_SESSIONS: usize = 1000;

/// The largest file that is read, in MiB: far more than [`MAX_SESSIONS`] lines.
const MAX_MIB: u64 = 1;

/// Sessions of the progress, and of the printed history.
const SHOWN: usize = 10;

/// The result of one practice. It does not contain what was typed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SessionResult {
    /// The end, in UTC.
    pub time: String,
    pub lesson: String,
    pub layout: String,
    pub is_simulated: bool,
    /// Characters of the text.
    pub characters: usize,
    pub seconds: f64,
    pub words_per_minute: f64,
    /// 0..=1.
    pub error_rate: f64,
    pub substitutions: usize,
    pub insertions: usize,
    pub deletions: usize,
    /// The figures of a pointing lesson, in place of the figures of a text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pointing: Option<PointingResult>,
    /// The correct and all attempts of each chord of a lesson of chords.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub chords: BTreeMap<char, [usize; 2]>,
}

/// The columns of the exported file.
const COLUMNS: &str = "time,lesson,layout,simulated,characters,seconds,words_per_minute,error_rate,substitutions,insertions,deletions,targets,misses,movement_s,path_efficiency,throughput_bits_per_s,axis_deviation_px,target_reentries,chords";

impl SessionResult {
    fn csv(&self) -> String {
        let figures = match &self.pointing {
            None => format!(
                "{},{},{},{},{},{},{},,,,,,,",
                self.characters,
                self.seconds,
                self.words_per_minute,
                self.error_rate,
                self.substitutions,
                self.insertions,
                self.deletions
            ),
            Some(pointing) => format!(
                ",{},,,,,,{},{},{},{},{},{},{}",
                self.seconds,
                pointing.targets,
                pointing.misses,
                pointing.movement_s,
                pointing.path_efficiency,
                pointing.throughput,
                pointing.axis_deviation_px,
                pointing.reentries
            ),
        };
        let chords = self.chords.iter();
        let chords =
            chords.map(|(chord, [correct, attempts])| format!("{chord} {correct}/{attempts}"));
        format!(
            "{},{},{},{},{figures},{}",
            quote_csv(&self.time),
            quote_csv(&self.lesson),
            quote_csv(&self.layout),
            self.is_simulated,
            quote_csv(&chords.collect::<Vec<_>>().join(" "))
        )
    }

    /// Returns `true` if both results are of one layout, one kind of task, and both of a person or both of a simulated hand.
    fn is_comparable(&self, other: &Self) -> bool {
        self.layout == other.layout
            && self.pointing.is_some() == other.pointing.is_some()
            && self.is_simulated == other.is_simulated
    }

    /// Returns the main figure with its unit, and the fraction of errors or misses.
    fn main_figures(&self) -> (f64, &'static str, f64) {
        match &self.pointing {
            Some(pointing) => (pointing.throughput, "bit/s", pointing.miss_rate()),
            None => (self.words_per_minute, "words/min", self.error_rate),
        }
    }
}

/// The results of earlier practice.
pub struct History {
    /// The file; `None` without a folder for it.
    path: Option<PathBuf>,
    sessions: Vec<SessionResult>,
    /// The reason why the file is not read as a whole.
    damage: Option<String>,
}

impl History {
    /// Reads the file in the state folder. A line or a file that cannot be read is reported, and kept at the next write.
    pub fn read() -> Self {
        let folder = files::state_folder();
        Self::read_from(folder.map(|folder| folder.join("practice").join("sessions.jsonl")))
    }

    fn read_from(path: Option<PathBuf>) -> Self {
        let mut history = Self {
            path,
            sessions: Vec::new(),
            damage: None,
        };
        let Some(file) = history.path.clone() else {
            return history;
        };
        history.read_file(&file);
        if let Some(damage) = &history.damage {
            let file = escape_path(&file);
            say!("cannot read all of {file}: {damage}; the file is kept beside the next one");
        }
        history
    }

    fn read_file(&mut self, file: &Path) {
        (self.sessions, self.damage) = match files::read_regular(file, MAX_MIB) {
            Ok(bytes) => parsed(&bytes),
            Err(FileError::Io(error)) if error.kind() == io::ErrorKind::NotFound => {
                (Vec::new(), None)
            }
            Err(error) => (Vec::new(), Some(error.to_string())),
        };
    }

    /// Returns the sessions, the oldest first.
    pub fn sessions(&self) -> &[SessionResult] {
        &self.sessions
    }

    /// Returns the number of sessions.
    pub fn count(&self) -> usize {
        self.sessions.len()
    }

    /// Keeps a result, and returns the latest comparable ones. Results that other processes have kept since the file was read stay. A
    /// file that cannot be written is reported.
    pub fn add(mut self, session: SessionResult) -> Option<Progress> {
        let latest = session.clone();
        if let Err(error) = self.add_to_file(session) {
            let place = self.path.as_deref().map(escape_path);
            let place = place.unwrap_or_else(|| "the state folder".to_owned());
            complain!(
                "cannot keep the result in {place}: {error}; make its folder writable, or set XDG_STATE_HOME to another one"
            );
            return None;
        }
        self.sessions.retain(|it| it.is_comparable(&latest));
        Some(Progress(self.sessions))
    }

    /// Adds a result to the file while no other process does.
    fn add_to_file(&mut self, session: SessionResult) -> Result<(), FileError> {
        let Some(path) = self.path.clone() else {
            return Err(io::Error::other("this system has no such folder").into());
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        if let Some(parent) = folder.parent() {
            fs::create_dir_all(parent)?;
        }
        files::create_private_folder(folder)?;
        // The file itself is replaced, so that its lock would be one of an old file.
        let _lock = LockedFile::lock(files::open_private(&path.with_extension("lock"))?)?;
        self.read_file(&path);
        self.sessions.push(session);
        let excess = self.sessions.len().saturating_sub(MAX_SESSIONS);
        self.sessions.drain(..excess);
        self.write(&path)
    }

    fn write(&self, path: &Path) -> Result<(), FileError> {
        if self.damage.is_some() {
            let damaged = |number: usize| path.with_extension(format!("damaged.{number}.jsonl"));
            let kept = new_file::first_free(damaged);
            fs::rename(path, &kept)?;
            say!("the damaged file is kept as {}", escape_path(&kept));
        }
        let lines = self.sessions.iter().map(|session| {
            let line = serde_json::to_string(session);
            line.map(|line| line + "\n").map_err(io::Error::from)
        });
        let text: Result<String, io::Error> = lines.collect();
        files::replace_private_text(path, &text?)
    }

    /// Prints the latest results as a table.
    pub fn print(&self) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        if self.sessions.is_empty() {
            writeln!(out, "no results yet; `ademan practice` makes the first one")?;
            return Ok(());
        }
        let first = self.sessions.len().saturating_sub(SHOWN);
        writeln!(
            out,
            "{:<21}{:>16}{:>9}  {:<11}layout",
            "time (UTC)", "result", "errors", "lesson"
        )?;
        for session in &self.sessions[first..] {
            let hand = if session.is_simulated {
                " (simulated)"
            } else {
                ""
            };
            let (figure, unit, errors) = session.main_figures();
            writeln!(
                out,
                "{:<21}{figure:>6.1} {unit:<9}{:>7.1} %  {:<11}{}{hand}",
                escape(&session.time),
                errors * 100.0,
                escape(&session.lesson),
                escape(&session.layout)
            )?;
        }
        if first > 0 {
            writeln!(
                out,
                "and {} before; --csv writes all",
                counted(first as u64, "session")
            )?;
        }
        Ok(())
    }

    /// Writes all results to a new file as CSV, or to the standard output.
    pub fn export(&self, path: &Path) -> Result<(), Failure> {
        let lines = self.sessions.iter().map(SessionResult::csv);
        let lines: Vec<String> = std::iter::once(COLUMNS.to_owned()).chain(lines).collect();
        let text = lines.join("\n") + "\n";
        if path == Path::new("-") {
            return Ok(io::stdout().write_all(text.as_bytes())?);
        }
        let written = files::write_new_private(path, text.as_bytes());
        written.map_err(|error| Failure::cannot_write(path, error))?;
        let shown = escape_path(path);
        let count = counted(self.sessions.len() as u64, "session");
        Ok(writeln!(io::stdout(), "wrote {count} to {shown}")?)
    }
}

/// Comparable results, the latest one last.
pub struct Progress(Vec<SessionResult>);

impl fmt::Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.0.len().saturating_sub(SHOWN);
        let latest = &self.0[first..];
        let figures = latest.iter().map(SessionResult::main_figures);
        let speeds: Vec<String> = figures
            .clone()
            .map(|(figure, ..)| format!("{figure:.1}"))
            .collect();
        let rates: Vec<String> = figures
            .map(|(_, _, errors)| format!("{:.1}", errors * 100.0))
            .collect();
        let unit = latest
            .first()
            .map_or("", |session| session.main_figures().1);
        writeln!(
            f,
            "progress   {unit} {} (oldest first, this layout)",
            speeds.join(" ")
        )?;
        writeln!(f, "           errors %  {}", rates.join(" "))?;
        self.write_chords(f)
    }
}

impl Progress {
    /// Writes the chords of the latest result that were worse or better before.
    fn write_chords(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((latest, earlier)) = self.0.split_last() else {
            return Ok(());
        };
        let mut changed = Vec::new();
        for (chord, now) in &latest.chords {
            let before = earlier.iter().rev().find_map(|it| it.chords.get(chord));
            if let Some(before) = before.filter(|before| *before != now) {
                changed.push(format!(
                    "{chord} {}/{} → {}/{}",
                    before[0], before[1], now[0], now[1]
                ));
            }
        }
        if changed.is_empty() {
            Ok(())
        } else {
            writeln!(
                f,
                "           chords    {} (correct of all, before → now)",
                changed.join(", ")
            )
        }
    }
}

/// Rounds to a multiple of 1/`scale`.
pub fn rounded(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale
}

/// Returns the sessions of a file, and the reason why there may be more in it.
fn parsed(bytes: &[u8]) -> (Vec<SessionResult>, Option<String>) {
    let (mut sessions, mut damaged) = (Vec::new(), Vec::new());
    let lines = bytes.split(|byte| *byte == b'\n').enumerate();
    for (index, line) in lines.filter(|(_, line)| !line.is_empty()) {
        match serde_json::from_slice(line) {
            Ok(session) => sessions.push(session),
            Err(_) => damaged.push(index + 1),
        }
    }
    let damage = damaged.first().map(|first| match damaged.len() {
        1 => format!("line {first} is damaged"),
        count => format!("{count} lines are damaged, the first is line {first}"),
    });
    (sessions, damage)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(words_per_minute: f64) -> SessionResult {
        SessionResult {
            time: "2026-01-02T03:04:05Z".into(),
            lesson: "text".into(),
            layout: "My, \"board\"".into(),
            is_simulated: false,
            characters: 10,
            seconds: 6.5,
            words_per_minute,
            error_rate: 0.1,
            substitutions: 1,
            insertions: 0,
            deletions: 0,
            ..SessionResult::default()
        }
    }

    #[test]
    fn results_are_kept_oldest_first_and_the_oldest_ones_are_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state/ademan/practice/sessions.jsonl");
        let line = |number: usize| serde_json::to_string(&session(number as f64)).unwrap() + "\n";
        let read = || History::read_from(Some(path.clone()));
        assert!(read().add(session(0.0)).is_some());
        let lines: String = (0..MAX_SESSIONS).map(line).collect();
        fs::write(&path, lines).unwrap();
        let progress = read().add(session(7.0)).unwrap().to_string();
        assert!(
            progress.contains("997.0 998.0 999.0 7.0 (oldest"),
            "{progress}"
        );
        let history = read();
        assert_eq!(history.count(), MAX_SESSIONS);
        assert_eq!(history.sessions[0], session(1.0));
    }

    #[test]
    fn the_progress_of_a_person_has_no_results_of_a_simulated_hand() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ademan/practice/sessions.jsonl");
        let mut simulated = session(30.0);
        simulated.is_simulated = true;
        let add = |it| History::read_from(Some(path.clone())).add(it).unwrap();
        add(simulated);
        let progress = add(session(12.0)).to_string();
        assert!(progress.contains("words/min 12.0 (oldest"), "{progress}");
    }

    #[test]
    fn results_of_sessions_at_the_same_time_are_all_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("state/ademan/practice/sessions.jsonl");
        let read = || History::read_from(Some(path.clone()));
        let at_once: Vec<History> = (0..7).map(|_| read()).collect();
        std::thread::scope(|scope| {
            for (number, history) in at_once.into_iter().enumerate() {
                scope.spawn(move || history.add(session(number as f64)).expect("it is kept"));
            }
        });
        let mut speeds: Vec<f64> = read()
            .sessions
            .iter()
            .map(|it| it.words_per_minute)
            .collect();
        speeds.sort_by(f64::total_cmp);
        assert_eq!(speeds, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn a_file_of_any_bytes_is_read_as_far_as_possible() {
        let line = serde_json::to_string(&session(1.0)).unwrap();
        for damage in [&b"{"[..], b"\xff\xfe", b"[1,2]", b"{\"time\":1}", b"\0\0\0"] {
            let bytes = [damage, b"\n", line.as_bytes(), b"\n", damage].concat();
            let (sessions, reason) = parsed(&bytes);
            assert_eq!(sessions, [session(1.0)]);
            assert_eq!(reason.unwrap(), "2 lines are damaged, the first is line 1");
        }
        assert_eq!(parsed(b""), (Vec::new(), None));
    }

    #[test]
    fn names_of_layouts_are_fields_of_csv_and_no_formulas() {
        let line = session(12.5).csv();
        let expected =
            "2026-01-02T03:04:05Z,text,\"My, \"\"board\"\"\",false,10,6.5,12.5,0.1,1,0,0,,,,,,,,";
        assert_eq!(line, expected);
        assert_eq!(COLUMNS.split(',').count(), 19);
        assert_eq!(quote_csv("=1+1"), "'=1+1");
    }

    #[test]
    fn pointing_and_chords_have_columns_of_their_own_and_old_files_are_read() {
        let old = r#"{"time":"t","lesson":"text","layout":"a","is_simulated":false,"characters":1,"seconds":1.0,"words_per_minute":1.0,"error_rate":0.0,"substitutions":0,"insertions":0,"deletions":0}"#;
        let old: SessionResult = serde_json::from_str(old).unwrap();
        assert_eq!(old.pointing, None);
        let pointing = SessionResult {
            pointing: Some(PointingResult {
                targets: 9,
                misses: 2,
                movement_s: 0.75,
                path_efficiency: 0.9,
                axis_deviation_px: 6.5,
                reentries: 0.25,
                throughput: 4.25,
            }),
            ..session(0.0)
        };
        let chords = SessionResult {
            chords: [('q', [1, 3]), (',', [3, 3])].into(),
            ..session(1.0)
        };
        for session in [&pointing, &chords] {
            let line = serde_json::to_string(session).unwrap();
            assert_eq!(
                serde_json::from_str::<SessionResult>(&line).unwrap(),
                *session
            );
        }
        let row = pointing.csv();
        let figures = "false,,6.5,,,,,,9,2,0.75,0.9,4.25,6.5,0.25,";
        assert!(row.ends_with(figures), "{row}");
        let chord_row = chords.csv();
        let end = ",,,,,,,,\", 3/3 q 1/3\"";
        assert!(chord_row.ends_with(end), "{chord_row}");
        let better = SessionResult {
            chords: [('q', [3, 3]), (',', [3, 3])].into(),
            ..session(2.0)
        };
        let text = Progress(vec![chords, better]).to_string();
        assert!(text.contains("q 1/3 → 3/3 (correct"), "{text}");
    }
}
