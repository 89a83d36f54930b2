//! Checks of the files of words, and of the sources that use them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::*;

/// The keys of a language with the names of their values.
fn variables(source: &str) -> BTreeMap<&str, BTreeSet<&str>> {
    let mut found = BTreeMap::new();
    let mut key = "";
    for line in source.lines().filter(|line| !line.starts_with('#')) {
        key = keys(line).next().unwrap_or(key);
        let names: &mut BTreeSet<&str> = found.entry(key).or_default();
        for after in line.split('$').skip(1) {
            let end = after.find(|c: char| !c.is_alphanumeric() && c != '_');
            names.insert(&after[..end.unwrap_or(after.len())]);
        }
    }
    found.remove("");
    found
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder of sources");
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        match path.extension() {
            _ if path.is_dir() => files.extend(sources(&path)),
            Some(extension) if extension == "rs" => files.push(path),
            _ => {}
        }
    }
    files
}

/// The code of Studio and of its command without tests and without blanks.
fn code() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut code = String::new();
    for folder in ["src", "../../src/bin/ademan/studio"] {
        for path in sources(&root.join(folder)) {
            if path.ends_with("tests.rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a source");
            let text = text.split("#[cfg(test)]\nmod tests {").next();
            let lines = text.unwrap_or_default().lines().map(str::trim);
            let lines = lines.filter(|line| !line.starts_with("//"));
            // A quotation mark alone begins no literal.
            code.extend(lines.map(|line| line.replace("'\"'", "")));
        }
    }
    code
}

/// The keys in calls of `text` and `text_with`, and other literals that begin like a key, such as in tables.
fn used_keys(code: &str) -> BTreeSet<&str> {
    let english = keys(Language::English.source());
    let groups: BTreeSet<&str> = english
        .filter_map(|key| Some(key.split_once('-')?.0))
        .collect();
    let mut used = BTreeSet::new();
    let mut before = "";
    for (index, part) in code.split('"').enumerate() {
        let is_literal = index % 2 == 1;
        let is_key = part
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
        let is_in_group = part
            .split_once('-')
            .is_some_and(|(group, _)| groups.contains(group));
        let call = before
            .strip_suffix("text(")
            .or(before.strip_suffix("text_with("));
        // Not a longer name, such as `hint_text(`.
        let is_shown = call.is_some_and(|call| !call.ends_with(['_', '.']));
        if is_literal && (is_shown || is_key && is_in_group) {
            used.insert(part);
        }
        before = part;
    }
    used
}

#[test]
fn the_files_have_no_mistakes() {
    for language in Language::ALL {
        let source = language.source();
        if let Err((_, errors)) = FluentResource::try_new(source.to_owned()) {
            panic!("{}: {errors:?}", language.name());
        }
        let keys: Vec<&str> = keys(source).collect();
        let distinct: BTreeSet<&str> = keys.iter().copied().collect();
        assert_eq!(
            keys.len(),
            distinct.len(),
            "{}: a key twice",
            language.name()
        );
        for (key, names) in variables(source) {
            let message = catalog(language).bundle.get_message(key);
            assert!(message.is_some(), "{}: {key}", language.name());
            let values: FluentArgs = names.iter().map(|name| (*name, Value::from(2))).collect();
            let words = catalog(language).format(key, Some(&values));
            let words = words.unwrap_or_default();
            assert!(
                !words.trim().is_empty(),
                "{}: {key} is empty",
                language.name()
            );
        }
    }
}

#[test]
fn all_languages_have_the_same_keys_and_values() {
    let english = variables(Language::English.source());
    let spanish = variables(Language::Spanish.source());
    assert!(english.len() > 20, "{}", english.len());
    let only = |a: &BTreeMap<&str, BTreeSet<&str>>, b: &BTreeMap<&str, BTreeSet<&str>>| {
        let missing = a.iter().filter(|(key, names)| b.get(*key) != Some(names));
        missing
            .map(|(key, _)| (*key).to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(only(&english, &spanish), [""; 0], "not so in es.ftl");
    assert_eq!(only(&spanish, &english), [""; 0], "not so in en.ftl");
}

#[test]
fn every_key_in_the_sources_has_words_and_all_words_are_used() {
    let code = code();
    let used = used_keys(&code);
    let defined: BTreeSet<&str> = keys(Language::English.source()).collect();
    let without_words: Vec<_> = used.difference(&defined).collect();
    assert_eq!(without_words, [&""; 0], "add them to en.ftl and es.ftl");
    let unused = defined
        .iter()
        .filter(|key| !code.contains(&format!("\"{key}\"")));
    let unused: Vec<_> = unused.collect();
    assert_eq!(unused, [&""; 0], "remove them from en.ftl and es.ftl");
}

#[test]
fn one_of_something_is_singular() {
    for (language, one, several) in [
        (Language::Spanish, "0 de 1 persona", "0 de 2 personas"),
        (Language::English, "0 of 1 person", "0 of 2 people"),
    ] {
        set_language(language);
        let progress = |all: usize| {
            let values = [("done", Value::from(0_usize)), ("all", Value::from(all))];
            text_with("lab-progress", &values)
        };
        assert_eq!((progress(1).as_str(), progress(2).as_str()), (one, several));
    }
}

#[test]
fn a_missing_key_shows_itself() {
    assert_eq!(text("no-such-key"), "no-such-key");
    assert_eq!(text_with("no-such-key", &[]), "no-such-key");
}

#[test]
fn words_follow_the_language_of_the_thread() {
    assert_eq!(text("button-resume"), "Resume");
    set_language(Language::Spanish);
    assert_eq!(text("button-resume"), "Reanudar");
    let other = std::thread::spawn(|| text("button-resume")).join();
    assert_eq!(other.expect("a thread"), "Resume");
}

#[test]
fn a_locale_names_a_language() {
    for (locale, language) in [
        ("es_MX.UTF-8", Language::Spanish),
        ("es", Language::Spanish),
        ("ES-es", Language::Spanish),
        ("en_GB.UTF-8", Language::English),
        ("est_EE", Language::English),
        ("C", Language::English),
        ("", Language::English),
    ] {
        assert_eq!(Language::from_locale(locale), language, "{locale}");
    }
}
