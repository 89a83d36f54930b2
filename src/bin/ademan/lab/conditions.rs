//! The people, phrases and sensors of a run.

use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use ademan::document::{Document, FileKind};
use ademan::files::OpenDocument;
use ademan::layout::{Layout, Person};
use ademan::measures::{
    Conditions, FORMAT, LabResult, MAX_PEOPLE, PeopleSpec, PersonScore, ScoreError, score,
    score_decoded, summarize,
};
use ademan::message::escape;
use ademan::people::{Participant, People, Tier, population};
use ademan::phrases::{Corpus, PhraseSet};
use ademan::sim::backspace_of;
use ademan::sim::fluent::SourceKind;
use clap::builder::TypedValueParser;

use super::decoder::{Decoder, DecoderArg};
use super::outputs;
use crate::failure::Failure;
use crate::setup_args::{number_in, one_of};
use crate::{complete, signals};

/// Most threads: as many as large machines have processors.
const MAX_JOBS: i64 = 1024;

/// The people of the general population by default.
const PEOPLE: u32 = 20;

/// The difference between the seeds of held-out people and of the others.
const HELD_OUT: u64 = 0x4e1d_0075;

/// The people, the texts that they type, and the measurement.
#[derive(Clone, clap::Args)]
pub struct ConditionArgs {
    /// Person: the name of one that comes with the program, or a file. Its size, fingers and errors apply; times and the differences from
    /// what the program assumes are drawn
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    /// Number of people, 20 by default; with --person of repetitions, 1 by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_PEOPLE)))]
    people: Option<u32>,
    /// Sensor of the hands: ideal, camera, glove or measured-glove
    #[arg(long, value_name = "SOURCE", default_value = "ideal", value_parser = one_of::<SourceKind>(SourceKind::NAMES))]
    source: SourceKind,
    /// Quality of the touches instead of the people's own: T0 to T4 are 3, 5, 6, 8 and 10 mm of scatter, Toff an offset of 8 mm
    #[arg(long, value_name = "TIER", value_parser = one_of::<Tier>(Tier::NAMES))]
    tier: Option<Tier>,
    /// Phrases that come with the program
    #[arg(long, value_name = "SET", default_value = "en", value_parser = one_of::<PhraseSet>(PhraseSet::NAMES))]
    phrases: PhraseSet,
    /// Text to type instead: a file with one phrase on each line
    #[arg(long, value_name = "FILE", conflicts_with = "phrases")]
    text: Option<PathBuf>,
    /// Text decoder after the devices, compared with other readings of the same taps: off, literal, suggest or auto, with another
    /// language as in auto:es
    #[arg(long, value_name = "MODE", default_value = "off")]
    decoder: DecoderArg,
    /// Probability that a person sees an error in the text and corrects it with Backspace
    #[arg(long, value_name = "0..1", default_value_t = 0.0, value_parser = probability)]
    corrections: f64,
    /// Phrases that each person types
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// Seed of the people and of their errors
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; by default one for each processor. The results do not depend on them
    #[arg(long, value_name = "N", value_parser = jobs())]
    jobs: Option<NonZeroUsize>,
}

/// Returns the parser of a number of threads. A system refuses to start ever more of them.
pub(super) fn jobs() -> impl TypedValueParser<Value = NonZeroUsize> {
    clap::value_parser!(u16)
        .range(1..=MAX_JOBS)
        .map(|number| NonZeroUsize::new(number.into()).expect("the range begins at 1"))
}

fn probability(text: &str) -> Result<f64, String> {
    number_in(text, 0.0, 1.0, "as a probability")
}

fn open_person(name: &str) -> Result<Document, Failure> {
    Ok(Document::open_kind(FileKind::Person, name)?)
}

/// A run without its layout.
pub struct Prepared {
    people: PeopleSpec,
    tier: Option<Tier>,
    pub(super) source: SourceKind,
    pub(super) decoder: Option<Decoder>,
    corrections: f64,
    pub(super) corpus: Corpus,
    pub(super) count: usize,
    pub(super) seed: u64,
    pub(super) jobs: NonZeroUsize,
    pub(super) participants: Vec<Participant>,
    pub(super) cancel: Arc<AtomicBool>,
}

impl ConditionArgs {
    /// Returns the paths of the files that are read.
    pub fn files(&self) -> Result<Vec<PathBuf>, Failure> {
        let person = self.person.as_deref().map(open_person).transpose()?;
        let person = person.and_then(|document| document.path);
        Ok(person.into_iter().chain(self.text.clone()).collect())
    }

    /// Returns the arguments with a number of people, unless one is given.
    pub fn with_people(&self, people: u32) -> Self {
        Self {
            people: self.people.or(Some(people)),
            ..self.clone()
        }
    }
}

impl Prepared {
    /// Returns a run with half of the phrases. The held-out half has other people, and errors from another seed.
    pub fn half(&self, is_held_out: bool) -> Result<Self, Failure> {
        let seed = if is_held_out {
            self.seed.wrapping_add(HELD_OUT)
        } else {
            self.seed
        };
        Self::with(
            self.people.clone(),
            self.tier,
            (self.source, self.decoder.clone(), self.corrections),
            self.corpus.half(is_held_out),
            (self.count, seed),
            Some(self.jobs),
        )
    }

    /// Reads the files that the arguments name.
    pub fn new(args: &ConditionArgs) -> Result<Self, Failure> {
        let people = match &args.person {
            None => PeopleSpec::Drawn(args.people.unwrap_or(PEOPLE)),
            Some(name) => {
                let document = open_person(name)?;
                PeopleSpec::Person {
                    file: document.file.clone(),
                    text: document.text,
                    count: args.people.unwrap_or(1),
                }
            }
        };
        let corpus = match &args.text {
            None => Corpus::shipped(args.phrases),
            Some(path) => outputs::read_corpus(path)?,
        };
        let count = usize::from(args.count);
        Self::with(
            people,
            args.tier,
            (args.source, Decoder::load(&args.decoder)?, args.corrections),
            corpus,
            (count, args.seed),
            args.jobs,
        )
    }

    /// Prepares the run of a result again.
    pub fn again(result: &LabResult, jobs: Option<NonZeroUsize>) -> Result<Self, Failure> {
        let unknown = |error: ademan::names::UnknownName| Failure::wrong_use(error.to_string());
        let tier = result.tier.as_deref().map(str::parse).transpose();
        let decoder = match &result.decoder {
            None => None,
            Some(name) => Decoder::load(&name.parse().map_err(Failure::wrong_use)?)?,
        };
        Self::with(
            result.people.clone(),
            tier.map_err(unknown)?,
            (
                result.source.parse().map_err(unknown)?,
                decoder,
                result.corrections,
            ),
            result.corpus(),
            (result.phrases, result.seed),
            jobs,
        )
    }

    fn with(
        people: PeopleSpec,
        tier: Option<Tier>,
        (source, decoder, corrections): (SourceKind, Option<Decoder>, f64),
        corpus: Corpus,
        (count, seed): (usize, u64),
        jobs: Option<NonZeroUsize>,
    ) -> Result<Self, Failure> {
        if decoder.is_some() && corrections > 0.0 {
            return Err(Failure::wrong_use(
                "people correct no errors with a text decoder; use either --corrections or --decoder",
            ));
        }
        let drawn = match &people {
            PeopleSpec::Drawn(number) => People::Drawn(*number),
            PeopleSpec::Person {
                file,
                text,
                count: repeats,
            } => {
                let person = Person::parse(&Document::new(file.as_str(), text.as_str()))?;
                People::Person(Box::new(person), *repeats)
            }
        };
        let cancel = Arc::new(AtomicBool::new(false));
        signals::install()?;
        let stop = Arc::clone(&cancel);
        signals::on_stop(move || stop.store(true, Ordering::Relaxed));
        let processors = || thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let mut participants = population(&drawn, tier, seed);
        for person in &mut participants {
            person.corrects = corrections;
        }
        Ok(Self {
            participants,
            people,
            tier,
            source,
            decoder,
            corrections,
            corpus,
            count,
            seed,
            jobs: jobs.unwrap_or_else(processors),
            cancel,
        })
    }

    /// Scores the text of a layout, which results call by a name.
    pub fn score_document(&self, name: &str, document: Document) -> Result<LabResult, Failure> {
        let result = self.unscored_document(name, document.clone());
        let scores = self.scores(&document)?;
        self.check(&document, &scores)?;
        Ok(LabResult {
            summary: summarize(&scores),
            scores,
            participants: self.participants.clone(),
            ..result
        })
    }

    /// Returns `true` if the phrases are a text of the user, and none that come with the program.
    pub fn has_own_text(&self) -> bool {
        self.corpus.name.parse::<PhraseSet>().is_err()
    }

    /// Returns the number of people.
    pub fn people(&self) -> usize {
        self.participants.len()
    }

    /// Returns the run of a part of the people, by their indices.
    pub fn with_people(mut self, indices: Range<usize>) -> Self {
        self.participants.truncate(indices.end);
        self.participants.drain(..indices.start.min(indices.end));
        self
    }

    /// Returns the run of those people who have a score, for a result of a part of them.
    pub fn with_people_of(mut self, scores: &[PersonScore]) -> Self {
        self.participants
            .retain(|person| scores.iter().any(|score| score.number == person.number));
        self
    }

    /// Returns the result of a layout before anybody has typed on it.
    pub fn unscored(&self, layout: &str) -> Result<LabResult, Failure> {
        Ok(self.unscored_document(layout, Document::open_kind(FileKind::Layout, layout)?))
    }

    fn unscored_document(&self, name: &str, document: Document) -> LabResult {
        LabResult {
            format: FORMAT.to_owned(),
            format_version: LabResult::format_version(),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            layout_file: name.to_owned(),
            layout: document.text,
            people: self.people.clone(),
            tier: self.tier.map(|tier| tier.name().to_owned()),
            source: self.source.name().to_owned(),
            corrections: self.corrections,
            decoder: self.decoder.as_ref().map(|decoder| decoder.name.clone()),
            seed: self.seed,
            phrases: self.count,
            corpus: self.corpus.name.clone(),
            corpus_hash: LabResult::hash_of(&self.corpus),
            corpus_phrases: self.corpus.phrases.clone(),
            summary: summarize(&[]),
            scores: Vec::new(),
            participants: Vec::new(),
            comparison: None,
            partial: None,
        }
    }

    /// Returns what each person does on a layout.
    pub fn scores(&self, document: &Document) -> Result<Vec<PersonScore>, Failure> {
        let conditions = Conditions {
            document,
            people: &self.participants,
            corpus: &self.corpus,
            phrases: self.count,
            source: self.source,
            seed: self.seed,
            jobs: self.jobs,
        };
        let mut said = 0;
        let all = self.participants.len();
        let progress = |done: usize| {
            // A line for each tenth, for runs that take a while.
            let tenth = done * 10 / all;
            if all >= 50 && tenth > said && done < all {
                said = tenth;
                say!("{}: {done} of {all} people", escape(&document.file));
            }
        };
        let scored = match &self.decoder {
            None => score(&conditions, &self.cancel, progress),
            Some(decoder) => decoder.with(|decoding| {
                score_decoded(&conditions, Some(decoding), &self.cancel, progress)
            }),
        };
        scored.map_err(|error| match error {
            ScoreError::Trial(ademan::trials::TrialError::Document(error)) => error.into(),
            ScoreError::Cancelled(error) => Failure::job(format!(
                "cannot score {}: {error}; divide a long run into parts with `ademan lab plan`: an interruption loses no part that is done",
                escape(&document.file)
            )),
            ScoreError::Trial(error @ ademan::trials::TrialError::NoLetters) => Failure::job(format!(
                "cannot score {}: {error}; use --decoder off",
                escape(&document.file)
            )),
            other => Failure::job(format!("cannot score {}: {other}", escape(&document.file))),
        })
    }

    /// Refuses a layout on which no person could do anything, and names what was left out.
    pub fn check(&self, document: &Document, scores: &[PersonScore]) -> Result<(), Failure> {
        let file = escape(&document.file);
        let does_nothing =
            |it: &PersonScore| it.characters == 0 && it.tasks.is_empty() && it.pointing.is_none();
        let untried = each_once(scores.iter().flat_map(|it| it.untried.iter().cloned()));
        if scores.iter().all(does_nothing) && !untried.is_empty() {
            return Err(Failure::wrong_use(format!(
                "cannot score {file}: a simulated hand of the lab cannot use its controls ({}); try the layout with a real hand: `ademan run`",
                listed(&untried)
            )));
        }
        if scores.iter().all(does_nothing) {
            return Err(Failure::wrong_use(format!(
                "nobody can use {file}: it has no control within reach; `ademan layout check` says what is out of reach"
            )));
        }
        let untypable = each_once(scores.iter().flat_map(|it| it.untypable.chars()));
        if scores.iter().all(|it| it.characters == 0) {
            say!("{file} is scored by tasks: it types none of the phrases");
        } else if !untypable.is_empty() {
            let characters: Vec<String> = untypable
                .into_iter()
                .map(|it| escape(&it.to_string()).to_string())
                .collect();
            complain!(
                "{file} cannot type these characters, which are left out of the phrases: {}",
                characters.join(" ")
            );
        }
        if self.corrections > 0.0 && scores.iter().any(|it| it.characters > 0) {
            let layout = Layout::from_document(document.clone())?;
            if backspace_of(&layout).is_none() {
                complain!("people correct no error on {file}: it has no Backspace");
            }
        }
        let unreached = each_once(scores.iter().flat_map(|it| it.unreached.iter().cloned()));
        if !unreached.is_empty() {
            complain!(
                "out of reach of some people on {file}: {}",
                listed(&unreached)
            );
        }
        if !untried.is_empty() {
            complain!(
                "not tried on {file}, as a hand without errors cannot use them either: {}",
                listed(&untried)
            );
        }
        Ok(())
    }
}

/// Returns what all people have, each once.
fn each_once<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut different: Vec<T> = Vec::new();
    for one in all {
        if !different.contains(&one) {
            different.push(one);
        }
    }
    different
}

fn listed(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|it| escape(it).to_string()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_people_lack_is_named_once_in_the_order_of_the_people() {
        assert_eq!(each_once(["Q", "P", "Q", "O"].into_iter()), ["Q", "P", "O"]);
    }
}
