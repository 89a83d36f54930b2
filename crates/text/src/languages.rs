//! The models that come with this crate. `languages/README.md` states their sources and how to build them.

/// English: 130 000 words.
pub const ENGLISH: &[u8] = include_bytes!("../languages/en.adm");

/// Spanish: 204 000 words, from little text.
pub const SPANISH: &[u8] = include_bytes!("../languages/es.adm");
