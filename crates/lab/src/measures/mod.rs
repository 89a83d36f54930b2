//! Measures of what simulated people did, with intervals over people.

mod bootstrap;
mod compare;
mod result_file;
mod score;
mod summary;

pub use bootstrap::{Interval, bootstrap};
pub use compare::{Comparison, Difference, HandGroup, Measure, NotComparable, compare};
pub use result_file::{CorpusHash, FORMAT, LabResult, PeopleSpec, ReadError};
pub use score::{Conditions, KeyScore, PersonScore, ScoreError, TaskScore, Wrong, score};
pub use summary::{Summary, summarize};
