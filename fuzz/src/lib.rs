//! The fuzz targets, shared with `tests/fuzzing/`.

#[path = "../../tests/fuzzing/hostile.rs"]
pub mod hostile;
mod support;
#[path = "../../tests/fuzzing/lines.rs"]
pub mod lines;
#[path = "../../tests/fuzzing/motion.rs"]
pub mod motion;
#[path = "../../tests/fuzzing/network.rs"]
pub mod network;
#[path = "../../tests/fuzzing/packets.rs"]
pub mod packets;
#[path = "../../tests/fuzzing/pipeline.rs"]
pub mod pipeline;
#[path = "../../tests/fuzzing/recordings.rs"]
pub mod recordings;
#[path = "../../tests/fuzzing/secure.rs"]
pub mod secure;
#[path = "../../tests/fuzzing/seeds.rs"]
pub mod seeds;
#[path = "../../tests/fuzzing/texts.rs"]
pub mod texts;
