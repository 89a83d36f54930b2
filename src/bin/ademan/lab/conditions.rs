//! The people, phrases and sensors of a run.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use ademan::document::Document;
use ademan::files::OpenDocument;
use ademan::layout::Person;
use ademan::measures::{
    Conditions, FORMAT, LabResult, PeopleSpec, PersonScore, ScoreError, score, summarize,
};
use ademan::message::{escape, escape_path};
use ademan::people::{Participant, People, Tier, population};
use ademan::phrases::{Corpus, PhraseSet};
use ademan::sim::fluent::SourceKind;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::outputs;
use crate::failure::Failure;
use crate::{complete, signals};

/// The people of the general population by default.
const PEOPLE: u32 = 20;
/// The most people: more give no narrower interval that matters.
const MAX_PEOPLE: i64 = 100_000;

/// Who types what, and how it is measured.
#[derive(Clone, clap::Args)]
pub struct ConditionArgs {
    /// Person: the name of one that comes with the program, or a file. Its size, fingers and errors apply; times and the differences from
    /// what the program assumes are drawn
    #[arg(long, value_name = "FILE", add = complete::person())]
    person: Option<String>,
    /// Number of people; of repetitions with --person, 1 by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_PEOPLE))]
    people: Option<u32>,
    /// What measures the hands: ideal, camera or glove
    #[arg(long, value_name = "SOURCE", default_value = "ideal", value_parser = source())]
    source: SourceKind,
    /// Quality of the touches instead of the people's own: T0 to T4 are 3, 5, 6, 8 and 10 mm of scatter, Toff an offset of 8 mm
    #[arg(long, value_name = "TIER", value_parser = tier())]
    tier: Option<Tier>,
    /// Phrases that come with the program
    #[arg(long, value_name = "SET", default_value = "en", value_parser = set())]
    phrases: PhraseSet,
    /// Text to type instead: a file with one phrase on each line
    #[arg(long, value_name = "FILE", conflicts_with = "phrases")]
    text: Option<PathBuf>,
    /// Phrases that each person types
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// Seed of the people and of their errors
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; by default one for each processor. The results do not depend on them
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

fn source() -> impl TypedValueParser<Value = SourceKind> {
    PossibleValuesParser::new(SourceKind::ALL.iter().map(|it| it.name()))
        .map(|name| name.parse().expect("the parser accepts only sources"))
}

fn tier() -> impl TypedValueParser<Value = Tier> {
    PossibleValuesParser::new(Tier::ALL.iter().map(|it| it.name()))
        .map(|name| name.parse().expect("the parser accepts only tiers"))
}

fn set() -> impl TypedValueParser<Value = PhraseSet> {
    PossibleValuesParser::new(PhraseSet::ALL.iter().map(|it| it.name()))
        .map(|name| name.parse().expect("the parser accepts only sets"))
}

/// Everything of a run but the layout.
pub struct Prepared {
    people: PeopleSpec,
    tier: Option<Tier>,
    source: SourceKind,
    corpus: Corpus,
    count: usize,
    seed: u64,
    jobs: NonZeroUsize,
    participants: Vec<Participant>,
    cancel: Arc<AtomicBool>,
}

impl Prepared {
    /// Reads the files that the arguments name.
    pub fn new(args: &ConditionArgs) -> Result<Self, Failure> {
        let people = match &args.person {
            None => PeopleSpec::Drawn(args.people.unwrap_or(PEOPLE)),
            Some(name) => {
                let document = Document::open(name)?;
                PeopleSpec::Person {
                    file: document.file.clone(),
                    text: document.text,
                    count: args.people.unwrap_or(1),
                }
            }
        };
        let corpus = match &args.text {
            None => Corpus::shipped(args.phrases),
            Some(path) => {
                let cannot = |error: String| {
                    Failure::wrong_use(format!("cannot use {}: {error}", escape_path(path)))
                };
                let text = outputs::read_text(path).map_err(cannot)?;
                let name = path.to_string_lossy();
                Corpus::from_text(&name, &text).map_err(|error| cannot(error.to_string()))?
            }
        };
        let count = usize::from(args.count);
        Self::with(
            people,
            args.tier,
            args.source,
            corpus,
            (count, args.seed),
            args.jobs,
        )
    }

    /// Prepares the run of a result again.
    pub fn again(result: &LabResult, jobs: Option<NonZeroUsize>) -> Result<Self, Failure> {
        let unknown = |error: ademan::names::UnknownName| Failure::wrong_use(error.to_string());
        let tier = result.tier.as_deref().map(str::parse).transpose();
        Self::with(
            result.people.clone(),
            tier.map_err(unknown)?,
            result.source.parse().map_err(unknown)?,
            result.corpus(),
            (result.phrases, result.seed),
            jobs,
        )
    }

    fn with(
        people: PeopleSpec,
        tier: Option<Tier>,
        source: SourceKind,
        corpus: Corpus,
        (count, seed): (usize, u64),
        jobs: Option<NonZeroUsize>,
    ) -> Result<Self, Failure> {
        let drawn = match &people {
            PeopleSpec::Drawn(count) => People::Drawn(*count),
            PeopleSpec::Person { file, text, count } => {
                let person = Person::parse(&Document::new(file.as_str(), text.as_str()))?;
                People::Person(Box::new(person), *count)
            }
        };
        let cancel = Arc::new(AtomicBool::new(false));
        signals::install()?;
        let stop = Arc::clone(&cancel);
        signals::on_stop(move || stop.store(true, Ordering::Relaxed));
        let processors = || thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        Ok(Self {
            participants: population(&drawn, tier, seed),
            people,
            tier,
            source,
            corpus,
            count,
            seed,
            jobs: jobs.unwrap_or_else(processors),
            cancel,
        })
    }

    /// Scores a layout: the name of a shipped one, or a file.
    pub fn score(&self, layout: &str) -> Result<LabResult, Failure> {
        let document = Document::open(layout)?;
        let scores = self.scores(&document)?;
        self.check(&document, &scores)?;
        Ok(LabResult {
            format: FORMAT.to_owned(),
            format_version: LabResult::format_version(),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            layout_file: layout.to_owned(),
            layout: document.text,
            people: self.people.clone(),
            tier: self.tier.map(|tier| tier.name().to_owned()),
            source: self.source.name().to_owned(),
            seed: self.seed,
            phrases: self.count,
            corpus: self.corpus.name.clone(),
            corpus_hash: LabResult::hash_of(&self.corpus),
            corpus_phrases: self.corpus.phrases.clone(),
            summary: summarize(&scores),
            scores,
            participants: self.participants.clone(),
            comparison: None,
        })
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
        score(&conditions, &self.cancel, progress).map_err(|error| match error {
            ScoreError::Trial(ademan::trials::TrialError::Document(error)) => error.into(),
            other => Failure::job(format!("cannot score {}: {other}", escape(&document.file))),
        })
    }

    /// Refuses a layout on which nobody could do anything, and names what was left out.
    fn check(&self, document: &Document, scores: &[PersonScore]) -> Result<(), Failure> {
        let file = escape(&document.file);
        let does_nothing = |it: &PersonScore| it.characters == 0 && it.tasks.is_empty();
        if scores.iter().all(does_nothing) {
            return Err(Failure::wrong_use(format!(
                "nobody can use {file}: it has no control within reach; `ademan layout check` says what is out of reach"
            )));
        }
        let Some(first) = scores.iter().max_by_key(|it| it.untypable.chars().count()) else {
            return Ok(());
        };
        if first.characters > 0 && !first.untypable.is_empty() {
            let characters: Vec<String> = first
                .untypable
                .chars()
                .map(|it| escape(&it.to_string()).to_string())
                .collect();
            complain!(
                "{file} cannot type these characters, which are left out of the phrases: {}",
                characters.join(" ")
            );
        }
        if !first.unreached.is_empty() {
            let names: Vec<String> = first
                .unreached
                .iter()
                .map(|it| escape(it).to_string())
                .collect();
            complain!(
                "out of reach of some people on {file}: {}",
                names.join(", ")
            );
        }
        Ok(())
    }
}
