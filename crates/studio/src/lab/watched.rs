//! One person of a run again, to be watched.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::outcome::LabOutcome;
use super::run::LabRequest;
use super::settings::LabSettings;
use crate::playback::Recording;
use ademan_core::document::Document;
use ademan_core::estimate::LANDMARK_SMOOTHING;
use ademan_core::hand::Side;
use ademan_core::kinematics::ArmModel;
use ademan_core::layout::{Fit, Layout};
use ademan_core::message::escape_path;
use ademan_core::time::Timestamp;
use ademan_lab::measures::{Failure, PersonScore, WatchedPhrase, watch_worst_phrase};
use ademan_lab::people::Participant;
use ademan_lab::phrases::Corpus;
use ademan_lab::sim::fluent::SourceKind;
use ademan_runtime::capture::recording::RecordedSetup;
use ademan_runtime::files;
use ademan_runtime::recorder::Recorder;
use ademan_runtime::setup::{
    ArmSetup, LoadedSetup, OtherHand, PositionSmoothingSetup, ReplaySettings, Setup,
};

/// The folder of the recordings, in the folder of states.
const FOLDER: &str = "lab";
/// The time before a failure at which it is watched from, in seconds.
const BEFORE: f64 = 1.0;

/// Counts the recordings of this program.
static RECORDINGS: AtomicU32 = AtomicU32::new(0);

/// A person who types the phrase again that went worst.
pub struct WatchedPerson {
    /// The figures of the person, over all phrases.
    pub score: PersonScore,
    /// The text to type.
    pub presented: String,
    /// The strokes that did not press what they meant.
    pub failures: Vec<Failure>,
    texts: Vec<(Timestamp, String)>,
    file: TemporaryFile,
}

/// A recording that is removed when it is no longer shown.
struct TemporaryFile(PathBuf);

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        // Nothing can be done about a file that stays.
        let _ = fs::remove_file(&self.0);
    }
}

impl WatchedPerson {
    /// Returns the text at a time.
    pub fn typed_at(&self, time: Timestamp) -> &str {
        let after = self.texts.partition_point(|(other, _)| *other <= time);
        match after.checked_sub(1) {
            Some(index) => &self.texts[index].1,
            None => "",
        }
    }

    /// Returns the next failure that is not watched yet at a time, and the time from which to watch it; the first one after the last.
    pub fn next_failure(&self, time: Timestamp) -> Option<(&Failure, Timestamp)> {
        let start =
            |failure: &Failure| Timestamp::from_seconds((failure.time.seconds() - BEFORE).max(0.0));
        let mut next = self.failures.iter().filter(|it| start(it) > time);
        let failure = next.next().or(self.failures.first())?;
        Some((failure, start(failure)))
    }

    /// The path of the recording.
    pub fn path(&self) -> &Path {
        &self.file.0
    }
}

/// Simulates a person of a run typing again, and returns the person with the recording of the phrase with the most errors, for a
/// [`Player`](crate::playback::Player). It takes as long as the score of this person. The error is a sentence for the user.
pub fn watch(
    request: &LabRequest,
    participants: &[Participant],
    (index, score): (usize, &PersonScore),
) -> Result<(WatchedPerson, Recording), String> {
    let corpus = Corpus::shipped(request.settings.corpus);
    let conditions = request.conditions(&request.layout, participants, &corpus);
    let phrase = request
        .settings
        .decoder
        .with(|decoding| watch_worst_phrase(&conditions, decoding, index))?;
    let phrase = phrase.map_err(|error| error.to_string())?;
    let phrase = phrase.ok_or("this layout does not type; tasks cannot be watched")?;
    let person = (&participants[index], phrase.arms.as_slice());
    let setup = setup(&request.settings, &request.layout, person)?;
    let file = record(&setup, &phrase)?;
    let recording = Recording {
        path: file.0.clone(),
        setup,
        // The text of a recording or of an unsaved copy has no file: its name is no path on this machine.
        has_own_layout: request.layout.path.is_some(),
    };
    let watched = WatchedPerson {
        score: score.clone(),
        presented: phrase.presented,
        failures: phrase.failures,
        texts: phrase.texts,
        file,
    };
    Ok((watched, recording))
}

impl LabOutcome {
    /// Returns what [`watch`] needs of this outcome for a person, for another thread.
    pub fn to_watch(&self, index: usize) -> Option<(LabRequest, Vec<Participant>, PersonScore)> {
        let score = self.own.scores.get(index)?.clone();
        Some((self.request.clone(), self.participants.clone(), score))
    }
}

/// Returns the setup of a person's pipeline, as the lab has it, without an output.
fn setup(
    settings: &LabSettings,
    layout: &Document,
    (person, arms): (&Participant, &[ArmModel]),
) -> Result<LoadedSetup, String> {
    let bones = person.assumed;
    let smoothing = LANDMARK_SMOOTHING;
    let arm = || ArmSetup::Measured {
        hand_length_mm: bones.hand * 1e3,
        forearm_length_mm: bones.forearm * 1e3,
    };
    let setup = Setup {
        arm: arm(),
        layout: layout.file.clone(),
        output: "none".into(),
        text: settings.decoder.setup(),
        other_hand: (arms.len() > 1).then(|| OtherHand {
            arm: arm(),
            ..OtherHand::default()
        }),
        // Nothing of it leaves the window.
        allow_system_keys: true,
        position_smoothing: match settings.source {
            SourceKind::Camera => PositionSmoothingSetup::OneEuro {
                min_cutoff_hz: smoothing.min_cutoff_hz,
                beta: smoothing.beta,
                derivative_cutoff_hz: smoothing.derivative_cutoff_hz,
            },
            _ => PositionSmoothingSetup::Off,
        },
        ..Setup::default()
    };
    let text = ron::ser::to_string(&setup).map_err(|error| error.to_string())?;
    let recorded = RecordedSetup::default().with("setup", "setup", &text).with(
        "layout",
        &layout.file,
        &layout.text,
    );
    let loaded = LoadedSetup::from_recording(&recorded, &ReplaySettings::default());
    let mut loaded = loaded.map_err(|error| error.to_string())?;
    // Lengths in millimetres are rounded; the boards fit exactly the arms of the lab.
    let fit = Fit::new(&arms[0], arms.get(1)).map_err(|error| error.to_string())?;
    loaded.layout = Layout::for_hands(layout.clone(), fit).map_err(|error| error.to_string())?;
    for own in arms {
        let is_left = own.side() == Side::Left;
        match &mut loaded.other_hand {
            Some(other) if is_left => other.arm = own.clone(),
            _ => loaded.arm = own.clone(),
        }
    }
    let other = loaded.other_hand.iter_mut();
    let gloves = other
        .map(|other| &mut other.glove)
        .chain([&mut loaded.glove]);
    for glove in gloves {
        *glove = glove.take().filter(|_| settings.source.is_glove());
        if let Some(glove) = glove {
            glove.map = settings.source.channel_map(glove.map.clone(), person);
        }
    }
    Ok(loaded)
}

/// Returns the path of a new recording. A program that was killed leaves its recording, and in a container the next one has its number.
fn free_path(folder: &Path) -> PathBuf {
    loop {
        let number = RECORDINGS.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!("person-{}-{number}.mcap", std::process::id()));
        if path.symlink_metadata().is_err() {
            return path;
        }
    }
}

/// Writes the readings of a phrase to a file that only this user can read.
fn record(setup: &LoadedSetup, phrase: &WatchedPhrase) -> Result<TemporaryFile, String> {
    let folder = files::state_folder()
        .ok_or("there is no home folder for the recording; set HOME")?
        .join(FOLDER);
    let cannot = |error: &dyn std::fmt::Display| {
        format!(
            "cannot keep the readings in {}: {error}",
            escape_path(&folder)
        )
    };
    if let Some(parent) = folder.parent() {
        fs::create_dir_all(parent).map_err(|error| cannot(&error))?;
    }
    files::create_private_folder(&folder).map_err(|error| cannot(&error))?;
    let file = TemporaryFile(free_path(&folder));
    let recorder = Recorder::create(&file.0, &setup.recorded_setup());
    let mut recorder = recorder.map_err(|error| error.to_string())?;
    for reading in &phrase.readings {
        let written = recorder.write_reading(reading);
        written.map_err(|error| error.to_string())?;
    }
    recorder.finish().map_err(|error| error.to_string())?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::super::run::tests::{finish, request};
    use super::super::{LabDecoder, LabRun};
    use super::*;
    use crate::playback::Player;
    use ademan_lab::sim::UsTextField;

    /// Watches a person of a run, and returns the person and the text that the pipeline of the player has typed.
    fn played(request: LabRequest, index: usize) -> (WatchedPerson, String) {
        let outcome = finish(&LabRun::start(request)).expect("a result");
        let (watched_request, people, score) = outcome.to_watch(index).expect("a person");
        let (watched, recording) =
            watch(&watched_request, &people, (index, &score)).expect("a person types");
        let mut model = recording.first_model();
        let mut player = Player::open(recording).expect("a thread");
        let deadline = Instant::now() + Duration::from_secs(60);
        while !player.is_complete() {
            assert!(Instant::now() < deadline, "not loaded");
            player.advance(Duration::ZERO, &mut model);
        }
        assert_eq!(player.problem(), None);
        let presses = player
            .recording()
            .presses()
            .expect("the recording is complete");
        assert!(!presses.is_empty());
        let typed = model_text(&player);
        (watched, typed)
    }

    /// Returns the text of all events of a recording.
    fn model_text(player: &Player) -> String {
        use ademan_core::pipeline::Pipeline;
        use ademan_core::snapshot::StepView;
        use ademan_runtime::capture::recording::Replay;
        use ademan_runtime::session::{self, command_channel};
        let recording = player.recording();
        let source = Replay::open(&recording.path).expect("a recording");
        let (_commands, receiver) = command_channel();
        let mut field = UsTextField::new();
        let mut observe = |step: &StepView, _: &Pipeline, _| {
            step.events.iter().for_each(|event| field.handle(event));
        };
        session::replay(&recording.setup, source, &receiver, &mut observe).expect("it plays");
        field.text().to_owned()
    }

    fn assert_same(request: LabRequest, index: usize) {
        let (watched, typed) = played(request, index);
        let last = watched.texts.last().map_or("", |(_, text)| text);
        assert_eq!(typed, last, "for {}", watched.presented);
        assert!(!typed.is_empty());
        let path = watched.path().to_owned();
        assert!(path.exists());
        drop(watched);
        assert!(!path.exists(), "the recording is removed");
    }

    #[test]
    fn the_pipeline_of_the_player_types_what_the_person_of_the_lab_types() {
        for &source in SourceKind::ALL {
            let mut request = request(None);
            request.settings.source = source;
            assert_same(request, 1);
        }
    }

    #[test]
    fn two_hands_and_a_decoder_are_watched_too() {
        let mut two = request(None);
        two.layout = Document::shipped("qwerty-two-arc").expect("a shipped layout");
        assert_same(two, 0);
        let mut decoded = request(None);
        decoded.settings.decoder = LabDecoder::English;
        assert_same(decoded, 2);
    }

    #[test]
    fn meshes_are_drawn_beside_a_layout_file_of_this_person_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        fs::write(folder.path().join("a.obj"), mesh).expect("a file");
        let shipped = Document::shipped("qwerty-flat").expect("a shipped layout");
        let end = shipped.text.rfind(')').expect("a bracket");
        let trigger = r#"triggers: [(name: "Wrist", when: Angle(dof: "wrist-flexion", on_deg: 60, off_deg: 50, zero_deg: 0, full_deg: 70), shape: (file: "a.obj", joint: "wrist"))])"#;
        let text = format!("{}{trigger}", &shipped.text[..end]);
        let path = folder.path().join("own.ron");
        fs::write(&path, &text).expect("a file");
        let mut typed = request(None);
        typed.layout = Document::new(path.display().to_string(), text);
        let outcome = finish(&LabRun::start(typed)).expect("a result");
        let (mut shown, people, score) = outcome.to_watch(0).expect("a person");
        for file in [None, Some(path)] {
            let is_file = file.is_some();
            shown.layout.path = file;
            let (_person, recording) = watch(&shown, &people, (0, &score)).expect("a person types");
            let shapes = recording.first_model().shapes;
            assert_eq!(shapes.mesh("a.obj").is_some(), is_file);
        }
    }

    #[test]
    fn a_recording_of_a_program_that_was_killed_is_in_no_ones_way() {
        let folder = tempfile::tempdir().expect("a folder");
        let next = RECORDINGS.load(Ordering::Relaxed);
        for number in next..next + 50 {
            let name = format!("person-{}-{number}.mcap", std::process::id());
            fs::write(folder.path().join(name), "").expect("a file");
        }
        let path = free_path(folder.path());
        assert!(!path.exists(), "{}", path.display());
    }

    #[test]
    fn the_next_failure_is_the_first_again_after_the_last() {
        let outcome = finish(&LabRun::start(request(None))).expect("a result");
        let index = outcome.bars()[0].index;
        let (request, people, score) = outcome.to_watch(index).expect("a person");
        let (watched, _) = watch(&request, &people, (index, &score)).expect("a person");
        let (first, start) = watched.next_failure(Timestamp(0)).expect("a failure");
        assert!(start < first.time);
        let (again, _) = watched
            .next_failure(Timestamp::from_seconds(1e6))
            .expect("a failure");
        assert_eq!(again, first);
        assert_eq!(watched.typed_at(Timestamp(0)), "");
    }
}
