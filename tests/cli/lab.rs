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
fn more_threads_than_a_machine_runs_are_refused() {
    for (line, number) in [
        ("lab score qwerty-flat --jobs 1025", "1025"),
        ("lab run sweep --jobs 100000", "100000"),
        ("lab verify a.json --jobs 0", "0"),
    ] {
        let ended = run(line.split(' '));
        assert_eq!(ended.code, Some(2), "`{line}`: {}{}", ended.out, ended.err);
        let reason = format!("{number} is not in 1..=1024");
        assert!(ended.err.contains(&reason), "`{line}`: {}", ended.err);
    }
}

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
        ended.printed(words);
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
    verified.printed("the same figures for 3 people");

    let result = std::fs::read_to_string(&json).expect("a result");
    let ends = |code: i32, changed: &str, words: &str| {
        let changed = file(&folder, "changed.json", changed);
        run(["lab", "verify", &changed])
            .exited(code)
            .reported(words);
    };
    let refused = |changed: &str, words: &str| ends(2, changed, words);
    let differs = |changed: &str, words: &str| ends(1, changed, words);
    let hits = result.find("\"hits\": ").expect("a figure of a person");
    let last = result
        .rfind("\"keystrokes\": ")
        .expect("a figure of a person");
    assert!(hits < last);
    let changed = result[..last].to_owned() + "\"keystrokes\": 9" + &result[last + 14..];
    differs(&changed, "the figures differ, first of person");
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
    refused(
        &result.replacen("\"drawn\": 3", "\"drawn\": 4000000000", 1),
        "more people or phrases than a run may have",
    );
    let pace = result.rfind("\"pace_wpm\": ").expect("a parameter");
    let changed_pace = result[..pace].to_owned() + "\"pace_wpm\": 1" + &result[pace + 12..];
    differs(&changed_pace, "the parameters of the people differ");
    refused("{}", "this is not a lab file of the expected kind");
    refused("[]", "its list is empty");
}

#[test]
fn a_changed_comparison_is_not_verified() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("two.json");
    let layouts = ["qwerty-flat", "qwerty-flat-22"];
    let more = ["--people", "2", "--count", "1", "--json", text(&path)];
    run([&["lab", "compare"], &layouts[..], &more].concat()).done();
    let verified = run(["lab", "verify", text(&path)]).done();
    verified.printed("the same figures for 2 people");
    let result = std::fs::read_to_string(&path).expect("a result");
    let place = result.find("\"differences\": ").expect("a comparison");
    let changed =
        result[..place].to_owned() + &result[place..].replacen("\"value\": ", "\"value\": 9", 1);
    let changed = file(&folder, "changed.json", changed);
    let ended = run(["lab", "verify", &changed]).exited(1);
    ended.reported("the comparison of qwerty-flat-22 differs");
}

#[test]
fn two_layouts_are_compared_with_the_same_people() {
    let line = "lab compare qwerty-flat qwerty-flat-22 --people 6 --count 2";
    let ended = run(line.split(' ')).done();
    ended.printed("qwerty-flat-22 minus qwerty-flat");
    ended.printed("hands up to");
    let same = "lab compare qwerty-flat qwerty-flat --people 6 --count 1";
    let compared = run(same.split(' ')).done();
    compared.printed("is not clearly faster or slower and makes not clearly more or fewer errors");
    let tasks = "lab compare qwerty-flat workshop --people 1 --count 1";
    let compared_tasks = run(tasks.split(' ')).exited(2);
    compared_tasks.reported("scored by tasks");
    assert_eq!(compared_tasks.out, "", "it is refused before anybody types");
    let one = ["--people", "1", "--count", "1"];
    let of_one = run([&["lab", "compare", "qwerty-flat", "qwerty-arc"], &one[..]].concat()).done();
    for words in [
        "qwerty-flat: 1 simulated person,",
        "  1 person, hands up to",
        "One person cannot show a difference between qwerty-flat and qwerty-arc",
    ] {
        assert!(of_one.out.contains(words), "{words}: {}", of_one.out);
    }
    assert!(!of_one.out.contains("0 people"), "{}", of_one.out);
}

#[test]
fn the_ranges_of_a_repeated_person_are_over_repetitions_and_the_result_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let html = folder.path().join("a.html");
    let page_arguments = ["--html", text(&html)];
    let person = ["--person", "adult", "--people", "2", "--count", "1"];
    let scored = ["lab", "score", "qwerty-flat"];
    let repeated = run([&scored[..], &person, &page_arguments].concat()).done();
    for words in [
        "qwerty-flat: 2 repetitions of one simulated person,",
        "the ranges are over repetitions of one person",
    ] {
        repeated.printed(words);
    }
    let page = std::fs::read_to_string(&html).expect("a page");
    assert!(page.contains("from resampled repetitions of one person"));
    let people = run([&scored[..], &person[2..]].concat()).done();
    assert!(!people.out.contains("repetitions"), "{}", people.out);
}

#[test]
fn a_text_that_cannot_be_typed_names_its_characters_and_an_empty_one_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = file(&folder, "phrases.txt", "¿qué tal?\n");
    let score_text = |path: &str| run(SCORE.into_iter().chain(["--text", path]));
    let ended = score_text(&phrases).done();
    ended.reported("left out of the phrases: ¿ é");
    let empty = file(&folder, "empty.txt", "\n \n");
    let empty_end = score_text(&empty).exited(2);
    empty_end.reported("no phrase");
    // Nothing of these texts can be typed.
    for other in ["\u{1f600}\n", "да нет\n"] {
        let other = file(&folder, "other.txt", other);
        let ended_early = score_text(&other).exited(2);
        ended_early.reported("types no letter and no digit of");
    }
    run(["lab", "score", "no-such-layout"]).exited(2);
}

#[test]
fn a_layout_that_does_not_type_is_scored_by_tasks() {
    let ended = run(["lab", "score", "workshop", "--people", "2", "--tier", "T0"]).done();
    ended.printed("tasks done, %");
    ended.printed("error of a value");
    ended.reported("workshop.ron is scored by tasks: it types none of the phrases");
    assert!(!ended.err.contains("not tried"), "{}", ended.err);
}

#[test]
fn controls_that_no_simulated_hand_can_use_are_named_and_not_counted() {
    let score = |layout: &str| run(["lab", "score", layout, "--people", "1"]);
    for layout in ["space", "drive", "wrist-remote", "lucidgloves-controller"] {
        let ended = score(layout);
        assert_eq!(ended.code, Some(2), "{layout}: {}{}", ended.out, ended.err);
        let words = "a simulated hand of the lab cannot use its controls";
        assert!(ended.err.contains(words), "{layout}: {}", ended.err);
    }
    let some = score("gestures").done();
    some.reported("not tried on ");
    some.reported("Full screen");
}

#[cfg(unix)]
#[test]
fn the_figures_are_printed_although_a_result_cannot_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for option in ["--json", "--csv", "--html"] {
        let refused = run([&SCORE[..], &[option, "/no/folder/result"]].concat()).exited(2);
        refused.reported("cannot write /no/folder/result: there is no such folder; create it");
        assert_eq!(refused.out, "", "it is refused before anybody types");
        for (place, words) in [
            (text(folder.path()), "this is a directory"),
            ("-", "not to the standard output"),
        ] {
            let early = run([&SCORE[..], &[option, place]].concat()).exited(2);
            early.reported(words);
            assert_eq!(early.out, "", "it is refused before anybody types");
        }
    }
    // The limit of the size of files stands for a full disk: the result is longer than the table.
    let (json, table) = (folder.path().join("a.json"), folder.path().join("a.csv"));
    let files = ["--json", text(&json), "--csv", text(&table)];
    let ended = run_with_small_files(&[&SCORE[..], &files].concat()).exited(1);
    ended.reported("cannot write");
    ended.printed("wrong characters (CER), %");
    assert!(table.exists(), "the other files are written");
}

/// Runs the program without files of more than 1 KiB.
#[cfg(unix)]
pub fn run_with_small_files(arguments: &[&str]) -> super::Ended {
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    let mut shell = std::process::Command::new("bash");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_ademan")]);
    super::run_to_end(shell.args(arguments))
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
        ended.reported("name another file");
    }
    run(["lab", "replay", &recording, "--json", &recording]).exited(2);
    let read = |path: &str| std::fs::read_to_string(path).expect("the file is left");
    assert_eq!(read(&phrases), "hello world\n");
    assert_eq!(read(&layout), board);
    assert_eq!(read(&person), "Person(name: \"me\")");
    assert_eq!(read(&recording), "readings");
    assert!(!std::path::Path::new(&same).exists());
}
