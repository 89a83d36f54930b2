//! `ademan lab`: layouts are scored and compared, and results are checked.

use super::{file, run, text};

/// A score of one person and one phrase.
const SCORE: [&str; 7] = [
    "lab",
    "score",
    "qwerty-flat",
    "--people",
    "1",
    "--count",
    "1",
];

#[test]
fn a_score_is_printed_written_and_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, csv, html) = (path("a.json"), path("a.csv"), path("a.html"));
    let ended = run([
        "lab",
        "score",
        "qwerty-flat",
        "--people",
        "3",
        "--count",
        "2",
        "--tier",
        "T1",
        "--json",
        text(&json),
        "--csv",
        text(&csv),
        "--html",
        text(&html),
    ])
    .done();
    for words in [
        "qwerty-flat: 3 simulated people, tier T1",
        "wrong characters (CER), %",
        "an input",
        "keys hit worst",
    ] {
        assert!(ended.out.contains(words), "{}", ended.out);
    }
    let table = std::fs::read_to_string(&csv).expect("a table");
    assert_eq!(table.lines().count(), 4, "{table}");
    let page = std::fs::read_to_string(&html).expect("a page");
    assert!(
        page.contains("<svg") && page.contains("heat-") && page.contains("prefers-color-scheme")
    );
    assert!(!page.contains("From phrase to phrase"), "two phrases");
    for reference in ["src=", "href=", "@import", "url("] {
        assert!(!page.contains(reference), "{reference}");
    }
    let verified = run(["lab", "verify", text(&json), "--jobs", "2"]).done();
    assert!(
        verified.out.contains("the same figures for 3 people"),
        "{}",
        verified.out
    );

    let result = std::fs::read_to_string(&json).expect("a result");
    let refused = |changed: &str, words: &str| {
        let changed = file(&folder, "changed.json", changed);
        let changed_end = run(["lab", "verify", &changed]);
        assert!(
            changed_end.code == Some(1) || changed_end.code == Some(2),
            "{:?}",
            changed_end.code
        );
        assert!(changed_end.err.contains(words), "{}", changed_end.err);
    };
    let hits = result.find("\"hits\": ").expect("a figure of a person");
    let last = result
        .rfind("\"keystrokes\": ")
        .expect("a figure of a person");
    assert!(hits < last);
    let changed = result[..last].to_owned() + "\"keystrokes\": 9" + &result[last + 14..];
    refused(&changed, "the figures differ, first of person");
    refused(
        &result.replacen("\"format_version\": 2", "\"format_version\": 1", 1),
        "version 1 of the format",
    );
    let own = format!("\"program_version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    refused(
        &result.replacen(&own, "\"program_version\": \"9.9.9\"", 1),
        "version 9.9.9 of the program",
    );
    refused(
        &result.replacen("the kettle", "the teapot", 1),
        "do not have the hash",
    );
    refused("{}", "this is no file of the lab of this kind");
}

#[test]
fn two_layouts_are_compared_with_the_same_people() {
    let ended = run([
        "lab",
        "compare",
        "qwerty-flat",
        "qwerty-flat-22",
        "--people",
        "6",
        "--count",
        "2",
    ])
    .done();
    assert!(
        ended.out.contains("qwerty-flat-22 minus qwerty-flat"),
        "{}",
        ended.out
    );
    assert!(ended.out.contains("hands up to"), "{}", ended.out);
    let compared = run([
        "lab",
        "compare",
        "qwerty-flat",
        "qwerty-flat",
        "--people",
        "3",
        "--count",
        "1",
    ])
    .done();
    let verdict = "is not clearly faster or slower and makes not clearly more or fewer errors";
    assert!(compared.out.contains(verdict), "{}", compared.out);
    let compared_tasks = run([
        "lab",
        "compare",
        "qwerty-flat",
        "workshop",
        "--people",
        "1",
        "--count",
        "1",
    ]);
    assert_eq!(compared_tasks.code, Some(2), "{}", compared_tasks.err);
    assert!(
        compared_tasks.err.contains("scored by tasks"),
        "{}",
        compared_tasks.err
    );
}

#[test]
fn a_text_that_cannot_be_typed_names_its_characters_and_an_empty_one_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = file(&folder, "phrases.txt", "¿qué tal?\n");
    let score_text = |path: &str| run(SCORE.into_iter().chain(["--text", path]));
    let ended = score_text(&phrases).done();
    assert!(
        ended.err.contains("left out of the phrases: ¿ é"),
        "{}",
        ended.err
    );
    let empty = file(&folder, "empty.txt", "\n \n");
    let empty_end = score_text(&empty);
    assert_eq!(empty_end.code, Some(2));
    assert!(empty_end.err.contains("no phrase"), "{}", empty_end.err);
    let unknown = run(["lab", "score", "no-such-layout"]);
    assert_eq!(unknown.code, Some(2));
}

#[test]
fn a_layout_that_does_not_type_is_scored_by_tasks() {
    let ended = run(["lab", "score", "workshop", "--people", "2", "--tier", "T0"]).done();
    assert!(ended.out.contains("tasks done, %"), "{}", ended.out);
    assert!(ended.out.contains("error of a value"), "{}", ended.out);
}

#[test]
fn the_figures_are_printed_although_a_result_cannot_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for option in ["--json", "--csv", "--html"] {
        let refused = run([&SCORE[..], &[option, "/no/folder/result"]].concat());
        assert_eq!(refused.code, Some(2), "{}", refused.err);
        let reason = "cannot write /no/folder/result: there is no such folder";
        assert!(refused.err.contains(reason), "{}", refused.err);
        assert_eq!(refused.out, "", "it is refused before anybody types");
        // A file cannot replace a folder.
        let table = folder.path().join("table.csv");
        let mut arguments = [&SCORE[..], &[option, text(folder.path())]].concat();
        if option == "--json" {
            arguments.extend(["--csv", text(&table)]);
        }
        let ended = run(arguments);
        assert_eq!(ended.code, Some(1), "{}", ended.err);
        assert!(ended.err.contains("cannot write"), "{}", ended.err);
        let figures = "wrong characters (CER), %";
        assert!(ended.out.contains(figures), "{}{}", ended.out, ended.err);
        assert!(table.exists(), "the other files are written");
    }
}

#[test]
fn a_result_replaces_no_file_that_is_read_and_no_other_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = file(&folder, "p.txt", "hello world\n");
    let board = std::fs::read_to_string("layouts/keyboards/qwerty-flat.ron").expect("a layout");
    let layout = file(&folder, "lay.ron", &board);
    let person = file(&folder, "me.ron", "Person(name: \"me\")");
    let recording = file(&folder, "hand.mcap", "readings");
    let other = text(&folder.path().join("./b")).to_owned();
    let same = text(&folder.path().join("b")).to_owned();
    let score = ["lab", "score", &layout, "--people", "1", "--count", "1"];
    for more in [
        ["--text", &phrases, "--csv", &phrases],
        ["--text", &phrases, "--json", &layout],
        ["--person", &person, "--html", &person],
        ["--json", &other, "--csv", &same],
    ] {
        let ended = run([&score[..], &more].concat());
        assert_eq!(ended.code, Some(2), "{more:?}: {}", ended.err);
        assert!(ended.err.contains("name another file"), "{}", ended.err);
    }
    let ended = run(["lab", "replay", &recording, "--json", &recording]);
    assert_eq!(ended.code, Some(2), "{}", ended.err);
    let read = |path: &str| std::fs::read_to_string(path).expect("the file is left");
    assert_eq!(read(&phrases), "hello world\n");
    assert_eq!(read(&layout), board);
    assert_eq!(read(&person), "Person(name: \"me\")");
    assert_eq!(read(&recording), "readings");
    assert!(!std::path::Path::new(&same).exists());
}
