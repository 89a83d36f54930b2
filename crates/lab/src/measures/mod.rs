//! Measures of what simulated people did, with intervals over people.

mod bootstrap;
mod compare;
mod keystrokes;
mod pointer_path;
mod pointing;
mod result_file;
mod score;
mod summary;
mod watch;

pub use bootstrap::{FEWEST_PEOPLE, Interval, bootstrap};
pub use compare::{Comparison, Difference, HandGroup, Measure, NotComparable, compare};
pub use keystrokes::KeystrokeClasses;
pub use pointer_path::PointerPath;
pub use pointing::{Movement, PointingResult, Ring, distance};
pub(crate) use result_file::Header;
pub use result_file::{
    CorpusHash, FORMAT, LabResult, MAX_PEOPLE, Partial, PeopleSpec, ReadError, has_possible_counts,
};
pub use score::{
    Conditions, KeyScore, PersonScore, PhraseScore, ScoreError, TaskScore, Wrong, score,
    score_decoded,
};
pub use summary::{PointingSummary, Summary, summarize};
pub use watch::{Failure, WatchedPhrase, watch_worst_phrase};
