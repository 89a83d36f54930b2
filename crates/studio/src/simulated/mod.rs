//! The simulated hand of a session without a source: it does a task again and again, and its person, speed and noise change while it
//! continues.
//!
//! ```text
//!  settings ─▶ HandControl ─ HandChange ──▶ SimulatedHand ─ readings ──▶ session
//! ```

mod source;

use crossbeam_channel::{Sender, unbounded};

pub use self::source::SimulatedHand;
use crate::settings::HandSettings;
use ademan_core::document::{Document, FileKind};
use ademan_core::layout::Person;
use ademan_lab::sim::HandTask;
use ademan_runtime::files::OpenDocument;
use ademan_runtime::setup::{LoadedSetup, SetupError};

/// Factors of the speed that a person file permits.
const SPEEDS: (f64, f64) = (0.1, 4.0);

/// A change of the simulated person.
#[derive(Clone, Debug, PartialEq)]
pub struct HandChange {
    person: Person,
    /// Standard deviation of the noise of the sensors.
    noise: f64,
}

/// The changes of a [`SimulatedHand`], which may belong to a session that has ended.
pub struct HandControl {
    setup: LoadedSetup,
    /// The person at the start.
    own: Person,
    /// The person of the settings, at the usual speed.
    person: Person,
    applied: HandSettings,
    changes: Sender<HandChange>,
}

/// Creates the simulated hand of a setup, and its control. The hand does a task on the active layout without end; it leaves out what is
/// beyond its reach, and says so.
pub fn simulate(
    setup: &LoadedSetup,
    task: HandTask,
) -> Result<(SimulatedHand, HandControl), SetupError> {
    let (sender, changes) = unbounded();
    let hand = SimulatedHand::new(setup.clone(), task, changes)?;
    let control = HandControl {
        own: setup.simulated_person.clone(),
        person: setup.simulated_person.clone(),
        setup: setup.clone(),
        applied: HandSettings::default(),
        changes: sender,
    };
    Ok((hand, control))
}

impl HandControl {
    /// Returns `true` if the setup or the command line names the person.
    pub fn has_own_person(&self) -> bool {
        self.setup.setup.person.is_some()
    }

    /// Returns the settings that the hand has.
    pub fn applied(&self) -> &HandSettings {
        &self.applied
    }

    /// Changes the hand to other settings. A person that cannot be simulated changes nothing.
    pub fn apply(&mut self, settings: &HandSettings) -> Result<(), SetupError> {
        if *settings == self.applied {
            return Ok(());
        }
        let person = match &settings.person {
            same if *same == self.applied.person => self.person.clone(),
            Some(name) => Person::parse(&Document::open_kind(FileKind::Person, name)?)?,
            None => self.own.clone(),
        };
        self.setup.simulate(&person)?;
        self.person = person;
        self.applied = settings.clone();
        let mut moved = self.setup.simulated_person.clone();
        let speed = moved.motion.speed * f64::from(settings.speed);
        moved.motion.speed = speed.clamp(SPEEDS.0, SPEEDS.1);
        let noise = f64::from(settings.noise);
        // A session that has ended has no hand.
        let _ = self.changes.send(HandChange {
            person: moved,
            noise,
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ademan_runtime::capture::{Sample, Source, SourceEvent};
    use ademan_runtime::setup::Setup;

    fn simulated() -> (SimulatedHand, HandControl) {
        let setup = Setup::default().load_files().expect("the default setup");
        simulate(&setup, HandTask::text("hola".to_owned())).expect("a hand")
    }

    fn next(hand: &mut SimulatedHand) -> Sample {
        match hand.next() {
            Ok(SourceEvent::Reading(reading)) => reading.sample,
            other => panic!("{other:?}"),
        }
    }

    /// Returns how many of 2000 readings differ from their predecessor, once the hand has begun to move.
    fn moves(settings: &HandSettings) -> usize {
        let (mut hand, mut control) = simulated();
        control.apply(settings).expect("settings");
        let readings: Vec<Sample> = (0..3001).map(|_| next(&mut hand)).collect();
        let pairs = readings[1000..].windows(2);
        pairs.filter(|pair| pair[0] != pair[1]).count()
    }

    #[test]
    fn a_fast_hand_rests_for_a_longer_part_of_its_time_and_noise_never_rests() {
        let with = |speed, noise| HandSettings {
            speed,
            noise,
            person: None,
        };
        let (slow, fast) = (moves(&with(0.5, 0.0)), moves(&with(3.0, 0.0)));
        assert!(slow > fast, "{slow} {fast}");
        assert_eq!(moves(&with(3.0, 5.0)), 2000);
    }

    #[test]
    fn a_person_is_read_once_and_one_who_cannot_be_simulated_changes_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("slow.ron");
        std::fs::write(&path, "Person(speed: 0.5)").expect("a write");
        let (_hand, mut control) = simulated();
        let mut settings = HandSettings {
            person: Some(path.to_string_lossy().into_owned()),
            ..HandSettings::default()
        };
        control.apply(&settings).expect("a person");
        assert_eq!(control.person.motion.speed, 0.5);
        std::fs::remove_file(&path).expect("a file");
        settings.noise = 2.0;
        control.apply(&settings).expect("the same person");
        for wrong in ["left-small", "no-such-person"] {
            let other = HandSettings {
                person: Some(wrong.to_owned()),
                ..settings.clone()
            };
            let error = control.apply(&other).expect_err(wrong).to_string();
            assert!(error.contains("left") || error.contains(wrong), "{error}");
            assert_eq!(control.applied(), &settings);
            assert_eq!(control.person.motion.speed, 0.5);
        }
        settings.person = None;
        control.apply(&settings).expect("the person at the start");
        assert_eq!(control.person, control.own);
    }
}
