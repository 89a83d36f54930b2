//! Simulated hands and people for Ademán.
//!
//! - [`sim`] simulates hands that type and play scripts, for demos, tests and scores.
//! - [`people`] draws simulated people from published ranges.
//! - [`phrases`] are the texts that they type.
//! - [`trials`] let people type and do tasks through the whole pipeline.
//! - [`measures`] are figures of speed and errors, with intervals over people.
//! - [`import`] reads layouts of other programs.
//! - [`improve`] changes layouts until people do better on them.
//! - [`readings`] compare a text decoder with simpler ways to read the same taps.
//! - [`shards`] are parts of a run, for many machines.
//! - [`study`] measures real people with the same tasks.
//! - [`report`] writes results as HTML and CSV.
//! - [`batch`] computes forward kinematics and contact of many hands at once.
//!
//! Two people type a phrase each:
//!
//! ```
//! use std::num::NonZeroUsize;
//! use std::sync::atomic::AtomicBool;
//!
//! use ademan_core::document::Document;
//! use ademan_lab::measures::{Conditions, score, summarize};
//! use ademan_lab::people::{People, population};
//! use ademan_lab::phrases::{Corpus, PhraseSet};
//! use ademan_lab::sim::fluent::SourceKind;
//!
//! let conditions = Conditions {
//!     document: &Document::shipped("qwerty-flat")?,
//!     people: &population(&People::Drawn(2), None, 0),
//!     corpus: &Corpus::shipped(PhraseSet::En),
//!     phrases: 1,
//!     source: SourceKind::Ideal,
//!     seed: 0,
//!     jobs: NonZeroUsize::MIN,
//! };
//! let scores = score(&conditions, &AtomicBool::new(false), |people| println!("{people} done"))?;
//! let summary = summarize(&scores);
//! assert_eq!(summary.people, 2);
//! // Words per minute, with the 95 % interval over people.
//! assert!(summary.wpm.low < summary.wpm.value && summary.wpm.value < summary.wpm.high);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use ademan_core::{
    calibrate, capture, command, contact, device, document, editing, estimate, hand, kinematics,
    layout, message, names, pipeline, time,
};

pub mod batch;
pub mod import;
pub mod improve;
pub mod measures;
pub mod people;
pub mod phrases;
pub mod readings;
pub mod report;
pub mod shards;
pub mod sim;
pub mod study;
pub mod trials;
