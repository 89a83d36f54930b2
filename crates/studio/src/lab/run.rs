//! A run on threads of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use crossbeam_channel::{Receiver, TryRecvError, bounded};

use super::outcome::{LabOutcome, Scored};
use super::settings::{LabDecoder, LabSettings, jobs};
use crate::texts::{language, set_language, text};
use ademan_core::document::{Document, FileKind};
use ademan_core::layout::Layout;
use ademan_lab::measures::{
    Conditions, PersonScore, ScoreError, compare, score_decoded, summarize,
};
use ademan_lab::people::Participant;
use ademan_lab::phrases::Corpus;
use ademan_lab::trials::TrialError;
use ademan_runtime::files::OpenDocument;
use ademan_runtime::priority;

/// The layout and the people that are scored.
#[derive(Clone, Debug)]
pub struct LabRequest {
    /// The people, and the texts that they type.
    pub settings: LabSettings,
    /// The layout of the editor.
    pub layout: Document,
    /// The layout that it is compared with, if any.
    pub other: Option<Document>,
}

impl LabRequest {
    /// Returns the document of a layout that is compared: the name of one that comes with the program, or a path. The error is a
    /// sentence for the user.
    pub fn open_other(name: &str) -> Result<Document, String> {
        Document::open_kind(FileKind::Layout, name).map_err(|error| error.to_string())
    }

    /// Returns the conditions for one of the layouts.
    pub(super) fn conditions<'a>(
        &self,
        document: &'a Document,
        people: &'a [Participant],
        corpus: &'a Corpus,
    ) -> Conditions<'a> {
        Conditions {
            document,
            people,
            corpus,
            phrases: self.settings.phrases,
            source: self.settings.source,
            seed: self.settings.seed,
            jobs: jobs(),
        }
    }
}

/// A run in progress. It is cancelled when it is dropped.
pub struct LabRun {
    cancel: Arc<AtomicBool>,
    done: Arc<AtomicUsize>,
    all: usize,
    result: Receiver<Result<LabOutcome, String>>,
}

impl LabRun {
    /// Starts a run.
    pub fn start(request: LabRequest) -> Self {
        let (sender, result) = bounded(1);
        let cancel = Arc::new(AtomicBool::new(false));
        let done = Arc::new(AtomicUsize::new(0));
        let layouts = 1 + usize::from(request.other.is_some());
        let run = Self {
            cancel: Arc::clone(&cancel),
            done: Arc::clone(&done),
            all: request.settings.people as usize * layouts,
            result,
        };
        let window_language = language();
        let work = move || {
            // A reason names a list of the window, and each thread has a language of its own.
            set_language(window_language);
            // The threads of the session go first. The threads that score inherit this.
            priority::shorten_time_slice();
            // The window may be closed.
            let _ = sender.send(outcome(request, &cancel, &done));
        };
        // Without a thread, the channel is closed, which `poll` reports.
        let _ = thread::Builder::new().name("lab".into()).spawn(work);
        run
    }

    /// Returns the people who have used a layout so far, and how many there are.
    pub fn progress(&self) -> (usize, usize) {
        (self.done.load(Ordering::Relaxed).min(self.all), self.all)
    }

    /// Ends the run without a result. Each thread finishes the person that it is at.
    pub fn cancel(&self) {
        self.cancel.store(true, Ordering::Relaxed);
    }

    /// Returns `true` if the run was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Returns the result once, when it is there, or the reason why there is none. Does not wait.
    pub fn poll(&self) -> Option<Result<LabOutcome, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the run has ended without a result; try again".into()))
            }
        }
    }
}

impl Drop for LabRun {
    fn drop(&mut self) {
        self.cancel();
    }
}

fn outcome(
    request: LabRequest,
    cancel: &AtomicBool,
    done: &AtomicUsize,
) -> Result<LabOutcome, String> {
    let participants = request.settings.participants();
    let corpus = Corpus::shipped(request.settings.corpus);
    let scored = |document: &Document| {
        let layout = Layout::from_document(document.clone()).map_err(|error| error.to_string())?;
        let conditions = request.conditions(document, &participants, &corpus);
        let progress = |_| _ = done.fetch_add(1, Ordering::Relaxed);
        let scores = request
            .settings
            .decoder
            .with(|decoding| score_decoded(&conditions, decoding, cancel, progress))?;
        let scores = scores.map_err(|error| reason(&error))?;
        check(&scores)?;
        Ok::<_, String>(Scored {
            name: document.file.clone(),
            text: document.text.clone(),
            summary: summarize(&scores),
            layout,
            scores,
        })
    };
    let other = request.other.as_ref().map(&scored).transpose()?;
    let own = scored(&request.layout)?;
    let comparison = other.as_ref().map(|other| {
        compare((&other.name, &other.scores), (&own.name, &own.scores))
            .map_err(|error| error.to_string())
    });
    Ok(LabOutcome {
        comparison: comparison.transpose()?,
        other,
        own,
        participants,
        request,
    })
}

fn reason(error: &ScoreError) -> String {
    match error {
        ScoreError::Cancelled(_) => String::new(),
        ScoreError::Trial(TrialError::NoLetters) => {
            let (list, off) = (text("lab-decoder"), LabDecoder::Off.name());
            format!("{error}; choose `{off}` in the list “{list}”, or another layout")
        }
        other => other.to_string(),
    }
}

/// Refuses a layout on which nobody could do anything.
fn check(scores: &[PersonScore]) -> Result<(), String> {
    let does_nothing =
        |it: &PersonScore| it.characters == 0 && it.tasks.is_empty() && it.pointing.is_none();
    if scores.iter().all(does_nothing) {
        Err("nobody can use this layout: it has no control within reach".into())
    } else {
        Ok(())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::texts::Language;
    use ademan_lab::people::Tier;

    pub fn request(other: Option<&str>) -> LabRequest {
        LabRequest {
            settings: LabSettings {
                people: 3,
                phrases: 1,
                tier: Some(Tier::T3),
                ..LabSettings::default()
            },
            layout: Document::shipped("qwerty-flat").expect("a shipped layout"),
            other: other.map(|name| LabRequest::open_other(name).expect("a layout")),
        }
    }

    pub fn finish(run: &LabRun) -> Result<LabOutcome, String> {
        let deadline = Instant::now() + Duration::from_secs(120);
        loop {
            if let Some(result) = run.poll() {
                return result;
            }
            assert!(Instant::now() < deadline, "no result");
            thread::sleep(Duration::from_millis(2));
        }
    }

    #[test]
    fn a_layout_is_scored_and_compared_with_a_larger_one() {
        let run = LabRun::start(request(Some("qwerty-flat-22")));
        assert_eq!(run.progress().1, 6);
        let outcome = finish(&run).expect("a result");
        assert_eq!(run.progress(), (6, 6));
        assert_eq!(outcome.own.scores.len(), 3);
        let other = outcome.other.as_ref().expect("a second layout");
        assert!(outcome.own.summary.cer.value > other.summary.cer.value);
        let verdict = outcome.comparison.expect("a comparison").verdict();
        assert!(verdict.contains("qwerty-flat"), "{verdict}");
    }

    #[test]
    fn a_cancelled_run_has_no_result_and_no_reason() {
        let mut many = request(None);
        many.settings.people = 500;
        let run = LabRun::start(many);
        run.cancel();
        assert!(run.is_cancelled());
        assert_eq!(finish(&run).map(|_| ()), Err(String::new()));
    }

    #[test]
    fn a_decoder_needs_letters() {
        let mut request = request(None);
        request.layout = Document::shipped("ray").expect("a shipped layout");
        request.settings.decoder = super::super::LabDecoder::English;
        let reason = finish(&LabRun::start(request)).map(|_| ()).unwrap_err();
        assert!(
            reason.contains("ten keys of letters; choose `off`"),
            "{reason}"
        );
        assert!(!reason.contains("--decoder"), "{reason}");
    }

    #[test]
    fn a_reason_names_the_list_as_the_window_does() {
        let mut request = request(None);
        request.layout = Document::shipped("ray").expect("a shipped layout");
        request.settings.decoder = super::super::LabDecoder::English;
        set_language(Language::Spanish);
        let reason = finish(&LabRun::start(request)).map(|_| ()).unwrap_err();
        set_language(Language::English);
        assert!(
            reason.contains("the list “Decodificador de texto”"),
            "{reason}"
        );
    }
}
