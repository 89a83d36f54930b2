//! The functions that are fuzzed: those of the random runs in `tests/fuzzing/`.

#[path = "../../tests/fuzzing/engine.rs"]
pub mod engine;
mod support;
#[path = "../../tests/fuzzing/packets.rs"]
pub mod packets;
#[path = "../../tests/fuzzing/recordings.rs"]
pub mod recordings;
#[path = "../../tests/fuzzing/seeds.rs"]
pub mod seeds;
#[path = "../../tests/fuzzing/texts.rs"]
pub mod texts;
