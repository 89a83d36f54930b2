//! The shipped models are what their lists and texts give.
#![allow(clippy::disallowed_types, reason = "the lists are made by a script")]

mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

use ademan_text::Model;
use ademan_text::build::{Builder, held_out};
use support::shared;

/// The language model of English that comes with a recognizer of speech.
const SPHINX: &str = "/usr/share/pocketsphinx/model/en-us/en-us.lm.bin";

/// Returns the bytes that the lists and the sentences give, with another model for English, or `None` without them.
fn built(language: &str, folder: &Path) -> Option<Vec<u8>> {
    let text = std::fs::read_to_string(shared(&format!("data/text/common_voice_{language}.txt"))?);
    let text = text.expect("the sentences");
    let list = std::fs::read_to_string(folder.join(format!("{language}.words"))).expect("a list");
    let mut builder = Builder::new();
    builder.words(&list).expect("a list");
    let kept: String = text
        .lines()
        .enumerate()
        .filter(|&(line, _)| !held_out(line))
        .flat_map(|(_, line)| [line, "\n"])
        .collect();
    builder.text(&kept);
    if language == "en" {
        let converted = Command::new(languages().join("arpa")).arg(SPHINX).output();
        let converted = converted.expect("Python");
        assert!(converted.status.success());
        let arpa = String::from_utf8(converted.stdout).expect("text");
        builder.arpa(&arpa).expect("a model in the ARPA format");
    }
    Some(builder.build().expect("a model"))
}

/// Returns the folder of the models.
fn languages() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("languages")
}

#[test]
fn the_shipped_models_are_rebuilt_byte_by_byte() {
    let sources = [
        "/usr/share/dict/scowl/english-words.10",
        "/usr/share/dict/spanish",
        SPHINX,
    ];
    if sources.iter().any(|source| !Path::new(source).exists()) {
        println!(
            "SKIPPED: Debian's packages scowl, wspanish and pocketsphinx-en-us are not installed"
        );
        return;
    }
    let folder = std::env::temp_dir().join(format!("ademan-languages-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let lists = Command::new(languages().join("lists"))
        .arg(&folder)
        .status();
    assert!(lists.expect("bash").success());
    for language in ["en", "es"] {
        let Some(bytes) = built(language, &folder) else {
            continue;
        };
        let model = Model::from_bytes(&bytes).expect("a model");
        println!(
            "{language}: {} bytes, {} letters, {} words, {} nodes, {} pairs",
            bytes.len(),
            model.alphabet.len(),
            model.lexicon.words(),
            model.lexicon.nodes(),
            model.bigrams.len(),
        );
        let path = languages().join(format!("{language}.adm"));
        if std::env::var_os("ADEMAN_WRITE").is_some() {
            std::fs::write(&path, &bytes).expect("a model");
        }
        let shipped = std::fs::read(&path).expect("the shipped model");
        assert!(
            shipped == bytes,
            "{language}.adm differs; ADEMAN_WRITE=1 writes it"
        );
        assert!(bytes.len() <= 4_000_000, "{} bytes", bytes.len());
    }
    std::fs::remove_dir_all(&folder).expect("a folder");
}

#[test]
fn plurals_and_forms_of_spanish_verbs_follow_the_rules() {
    let folder = std::env::temp_dir().join(format!("ademan-forms-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let [verbs, words] = ["verbs", "words"].map(|name| folder.join(name));
    let verb_list = "buscar\nconstruir\npedir i\ntener yo=teng past=tuv future=tendr ie\n";
    std::fs::write(&verbs, verb_list).expect("a file");
    std::fs::write(&words, "canción\nexamen\nlunes\nluz\npaís\nrojo\n").expect("a file");
    let mut inflect = Command::new("awk");
    inflect.env("LC_ALL", "C").arg("-f");
    inflect
        .arg(languages().join("inflect"))
        .args([&verbs, &words]);
    let ended = inflect.output().expect("awk");
    std::fs::remove_dir_all(&folder).expect("a folder");
    assert!(ended.status.success());
    let text = String::from_utf8(ended.stdout).expect("letters");
    let forms: Vec<_> = text
        .lines()
        .filter_map(|line| line.split('\t').next())
        .collect();
    for form in [
        "busco",
        "busqué",
        "buscó",
        "búscalo",
        "construyó",
        "construimos",
        "pido",
        "pidieron",
        "pidiéndole",
        "tengo",
        "tienes",
        "tuvo",
        "tendría",
        "tengamos",
        "canciones",
        "exámenes",
        "luces",
        "países",
        "rojos",
    ] {
        assert!(forms.contains(&form), "{form}");
    }
    for wrong in ["buscé", "construió", "pedió", "teno", "lúnes", "luneses"] {
        assert!(!forms.contains(&wrong), "{wrong}");
    }
}
