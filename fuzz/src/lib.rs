//! The functions that are fuzzed: those of the random runs in `tests/fuzzing/`.

#[path = "../../tests/fuzzing/engine.rs"]
pub mod engine;
#[path = "../../tests/support/judged.rs"]
mod judged;
#[path = "../../tests/fuzzing/packets.rs"]
pub mod packets;
#[path = "../../tests/fuzzing/recordings.rs"]
pub mod recordings;
#[path = "../../tests/fuzzing/seeds.rs"]
pub mod seeds;
#[path = "../../tests/fuzzing/texts.rs"]
pub mod texts;
