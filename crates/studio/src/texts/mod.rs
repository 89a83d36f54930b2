//! The words on the screen, in English and Spanish, in the format of [Project Fluent](https://projectfluent.org).
//!
//! To add words, write `my-key = …` into `en.ftl` and `es.ftl` and show `text("my-key")`; a test names whatever is missing.
//! With values: `my-key = { $count } keys`, and `text_with("my-key", &[("count", count.into())])`.
//!
//! A key that a language lacks is shown in English, and one that English lacks is shown itself.

mod language;

use std::cell::Cell;
use std::collections::HashMap;
use std::sync::LazyLock;

use fluent_bundle::concurrent::FluentBundle;
use fluent_bundle::{FluentArgs, FluentResource};

pub use self::language::Language;
pub use fluent_bundle::FluentValue as Value;

thread_local! {
    /// The language of the words that this thread shows: windows belong to one thread.
    static LANGUAGE: Cell<Language> = const { Cell::new(Language::English) };
}

/// Changes the language of the words that this thread shows.
pub fn set_language(language: Language) {
    LANGUAGE.set(language);
}

/// Returns the language of the words that this thread shows.
pub fn language() -> Language {
    LANGUAGE.get()
}

/// Returns words without values.
pub fn text(key: &'static str) -> &'static str {
    let find = |language| catalog(language).plain.get(key);
    let found = find(language()).or_else(|| find(Language::English));
    found.map_or(key, String::as_str)
}

/// Returns words with values, which their key names in braces.
pub fn text_with(key: &'static str, values: &[(&'static str, Value)]) -> String {
    let values: FluentArgs = values.iter().cloned().collect();
    let format = |language| catalog(language).format(key, Some(&values));
    let formatted = format(language()).or_else(|| format(Language::English));
    formatted.unwrap_or_else(|| key.to_owned())
}

/// The words of a language.
struct Catalog {
    bundle: FluentBundle<FluentResource>,
    /// Words without values, by key.
    plain: HashMap<&'static str, String>,
}

impl Catalog {
    fn new(language: Language) -> Self {
        let source = language.source();
        // The text after a mistake in a file is still read; a test finds the mistake.
        let resource = match FluentResource::try_new(source.to_owned()) {
            Ok(resource) | Err((resource, _)) => resource,
        };
        let mut bundle = FluentBundle::new_concurrent(vec![language.identifier()]);
        // The marks would be drawn as boxes, and both languages are written from left to right.
        bundle.set_use_isolating(false);
        bundle.add_resource_overriding(resource);
        let mut catalog = Self {
            bundle,
            plain: HashMap::new(),
        };
        for key in keys(source) {
            if let Some(words) = catalog.format(key, None) {
                catalog.plain.insert(key, words);
            }
        }
        catalog
    }

    /// Returns the words of a key, or `None` if the key or one of its values is missing.
    fn format(&self, key: &str, values: Option<&FluentArgs>) -> Option<String> {
        let words = self.bundle.get_message(key)?.value()?;
        let mut errors = Vec::new();
        let formatted = self.bundle.format_pattern(words, values, &mut errors);
        errors.is_empty().then(|| formatted.into_owned())
    }
}

fn catalog(language: Language) -> &'static Catalog {
    static CATALOGS: LazyLock<[Catalog; Language::ALL.len()]> =
        LazyLock::new(|| Language::ALL.map(Catalog::new));
    &CATALOGS[language as usize]
}

/// Returns the keys of a file: the words before an equals sign at the start of a line.
fn keys(source: &str) -> impl Iterator<Item = &str> {
    let lines = source.lines().filter_map(|line| line.split_once('='));
    lines
        .map(|(key, _)| key)
        .filter(|key| key.starts_with(|first: char| first.is_ascii_lowercase()))
        .map(str::trim_end)
}

#[cfg(test)]
mod tests;
