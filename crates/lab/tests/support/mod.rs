//! Helpers that the tests of the lab share.
#![allow(dead_code, reason = "each test program uses a part")]

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use ademan_core::document::Document;
use ademan_lab::measures::{Conditions, PersonScore, score};
use ademan_lab::people::{Participant, People, population};
use ademan_lab::phrases::{Corpus, PhraseSet};
use ademan_lab::sim::fluent::SourceKind;

/// A score of a shipped layout.
pub struct Run {
    pub document: Document,
    pub corpus: Corpus,
    pub phrases: usize,
    pub jobs: NonZeroUsize,
}

impl Run {
    pub fn new(layout: &str) -> Self {
        Self {
            document: Document::shipped(layout).expect("a shipped layout"),
            corpus: Corpus::shipped(PhraseSet::En),
            phrases: 4,
            jobs: NonZeroUsize::MIN,
        }
    }

    pub fn of(&self, people: &[Participant], source: SourceKind) -> Vec<PersonScore> {
        let conditions = Conditions {
            document: &self.document,
            people,
            corpus: &self.corpus,
            phrases: self.phrases,
            source,
            seed: 1,
            jobs: self.jobs,
        };
        score(&conditions, &AtomicBool::new(false), |_| {}).expect("a score")
    }
}

/// A person whose hand differs from what the pipeline assumes, and who makes no errors.
pub fn steady(fingers: &[&str]) -> Participant {
    let mut person = population(&People::Drawn(1), None, 2).remove(0);
    person.fingers = fingers.iter().map(|&it| it.to_owned()).collect();
    person.scatter = [0.0; 2];
    person.scatter_parts = [0.0; 2];
    person.depth = 4.0;
    person.depth_scatter = 0.0;
    person.offsets = [[0.0; 2]; 5];
    person.drift = 0.0;
    person.tremor = 0.0;
    person.sway = 0.0;
    person.slip = 0.0;
    person.enslaving = 0.0;
    person.missed = 0.0;
    person.spurious = 0.0;
    person.adaptation = 1.0;
    person
}

/// Returns the path of material that is not part of the project: below `ADEMAN_SHARED`, or `shared` beside the project. Prints SKIPPED
/// if it is absent.
pub fn shared(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("ADEMAN_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let path = folder.join(path);
    if path.exists() {
        return Some(path);
    }
    println!("SKIPPED: there is no {}", path.display());
    None
}
