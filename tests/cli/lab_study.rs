//! `ademan lab study`: tasks, trials and tables of a study. Simulated hands stand for participants.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use super::lab_designs::run_unread;
use super::{Ended, ademan, file, run, run_to_end, text};

fn new(folder: &Path, arguments: &[&str]) -> PathBuf {
    let study = folder.join("study");
    let start = ["lab", "study", "new", text(&study)];
    run(start.iter().chain(arguments)).done();
    study
}

fn add(study: &Path, participant: &str, arguments: &[&str]) -> Ended {
    let start = [
        "lab",
        "study",
        "add",
        text(study),
        "--participant",
        participant,
    ];
    let mut command = ademan(start.iter().chain(arguments));
    command.env("XDG_STATE_HOME", study.with_file_name("state"));
    run_to_end(&mut command)
}

fn report(study: &Path) -> (String, Vec<Vec<String>>) {
    let table = study.with_file_name("trials.csv");
    let ended = run(["lab", "study", "report", text(study), "--csv", text(&table)]).done();
    let rows = fs::read_to_string(table).expect("a table");
    let fields = |line: &str| line.split(',').map(str::to_owned).collect();
    (ended.out, rows.lines().map(fields).collect())
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).expect("it exists").permissions().mode() & 0o777
}

/// Asserts that a report replaces neither the study and the trials that it reads nor its other result.
fn assert_keeps_the_study(study: &Path, html: &Path) {
    let own = study.join("study.json");
    let trial = study.join("trials/P01-0000.json");
    assert!(trial.exists());
    for (csv, words) in [
        (own.as_path(), "is read by this command"),
        (trial.as_path(), "is read by this command"),
        (html, "is named for two results"),
    ] {
        let report = ["lab", "study", "report", text(study)];
        let files = ["--html", text(html), "--csv", text(csv)];
        let refused = run(report.iter().chain(&files)).exited(2);
        refused.reported(words);
    }
    run(["lab", "study", "report", text(study)]).done();
}

#[test]
fn participants_do_their_tasks_in_turn_and_each_trial_is_a_row() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = new(
        folder.path(),
        &["qwerty-flat", "numpad", "--count", "1", "--text"]
            .iter()
            .copied()
            .chain([super::file(&folder, "phrases.txt", "go 12345\n").as_str()])
            .collect::<Vec<_>>(),
    );
    let ended = add(&study, "P01", &["--simulated", "--tasks", "1"]).done();
    ended.printed("P01 on qwerty-flat: ");
    ended.printed("P01: 1 task to go");
    let rest = add(&study, "P01", &["--simulated"]).done();
    rest.printed("P01 on numpad: ");
    rest.printed("has done all tasks");
    // The second participant begins with the second layout.
    let second = add(
        &study,
        "P02",
        &["--simulated", "--tasks", "1", "--no-recording"],
    )
    .done();
    second.printed("P02 on numpad: ");

    let trial = study.join("trials/P01-0000.json");
    assert_eq!(mode(&trial), 0o600);
    assert_eq!(mode(&study.join("trials/P01-0000.mcap")), 0o600);
    assert!(!study.join("trials/P02-0000.mcap").exists());
    run(["replay", text(&study.join("trials/P01-0000.mcap"))]).done();

    let (out, rows) = report(&study);
    assert!(
        out.contains("numpad: 2 participants, 2 trials, 2 of them by simulated hands"),
        "{out}"
    );
    assert!(out.contains("P02 has done 1 of 2 tasks"), "{out}");
    assert_eq!(rows.len(), 4);
    assert!(
        rows.iter().all(|row| row.len() == rows[0].len()),
        "{rows:?}"
    );
    let column = |name: &str| rows[0].iter().position(|it| it == name).expect(name);
    assert_eq!(rows[1][column("layout")], "qwerty-flat");
    assert_eq!(rows[1][column("characters")], "5");
    let errors = ["cer", "deleted", "uncorrected", "corrected"];
    assert_eq!(errors.map(|name| rows[1][column(name)].as_str()), ["0"; 4]);
    assert_eq!(rows[1][column("kspc")], "1");
    assert!(rows[1][column("wpm")].parse::<f64>().expect("a speed") > 5.0);
    // Both layouts have the same number of the task for a phrase.
    assert_eq!(rows[1][column("task")], rows[2][column("task")]);

    let html = study.with_file_name("study.html");
    run([
        "lab",
        "study",
        "report",
        text(&study),
        "--html",
        text(&html),
    ])
    .done();
    let page = fs::read_to_string(&html).expect("a page");
    assert!(page.contains("<h2>numpad</h2>"), "{page}");
    assert!(!page.contains("P01"), "no pseudonyms");
    assert_eq!(mode(&html), 0o600);

    assert_keeps_the_study(&study, &html);

    let damaged = fs::read_to_string(&trial).expect("a trial");
    fs::write(&trial, &damaged[..40]).expect("a cut file");
    let damaged_end = run(["lab", "study", "report", text(&study)]).exited(2);
    damaged_end.reported("P01-0000.json");
}

#[test]
fn trials_and_tables_are_kept_although_nobody_reads_the_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = super::file(&folder, "phrases.txt", "12\n");
    let study = new(folder.path(), &["numpad", "--text", &phrases]);
    let start = ["lab", "study", "add", text(&study), "--participant", "P01"];
    let errors = run_unread(ademan(start.iter().chain(&["--simulated"])));
    assert!(study.join("trials/P01-0000.json").exists(), "{errors}");
    let table = folder.path().join("trials.csv");
    let report = [
        "lab",
        "study",
        "report",
        text(&study),
        "--csv",
        text(&table),
    ];
    let errors_of_report = run_unread(ademan(report));
    assert!(table.exists(), "{errors_of_report}");
}

fn json(study: &Path) -> serde_json::Value {
    let written = fs::read_to_string(study.join("study.json")).expect("a study");
    serde_json::from_str(&written).expect("JSON")
}

#[test]
fn all_layouts_that_type_have_the_same_phrases() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = super::file(&folder, "phrases.txt", "go 12\ncall 345 now\n");
    let study = folder.path().join("study");
    let layouts = ["qwerty-flat", "numpad", "workshop"];
    let start = ["lab", "study", "new", text(&study)];
    let ended = run([&start[..], &layouts, &["--text", &phrases]].concat()).done();
    ended.reported("left out of all phrases: Space a c g l n o w");
    let made = json(&study);
    let tasks = |index: usize| &made["layouts"][index]["tasks"];
    assert_eq!(tasks(0), tasks(1));
    assert_eq!(tasks(0).as_array().map(Vec::len), Some(2), "{made}");
}

#[test]
fn a_knob_with_ends_has_goals_between_them_and_is_set_to_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = new(folder.path(), &["media", "--values", "4"]);
    let made = json(&study);
    let tasks = made["layouts"][0]["tasks"].as_array().expect("tasks");
    let values: Vec<&serde_json::Value> = tasks.iter().map(|it| &it["value"]).collect();
    let volume = values.iter().filter(|it| it["control"] == "Volume");
    let goals: Vec<f64> = volume.filter_map(|it| it["goal"].as_f64()).collect();
    assert_eq!(goals.len(), 4, "{made}");
    assert!(
        goals.iter().all(|goal| (0.05..=0.95).contains(goal)),
        "{goals:?}"
    );
    add(&study, "P01", &["--simulated", "--no-recording"]).done();
    let (out, rows) = report(&study);
    let column = |name: &str| rows[0].iter().position(|it| it == name).expect(name);
    for row in &rows[1..] {
        let error = row[column("value_error")].parse::<f64>().expect("an error");
        assert!(error < 0.1, "{row:?} {out}");
    }
}

#[test]
fn trials_of_another_study_do_not_count() {
    let folder = tempfile::tempdir().expect("a folder");
    let phrases = super::file(&folder, "phrases.txt", "12\n34\n56\n");
    let study = new(folder.path(), &["numpad", "--text", &phrases]);
    add(&study, "P01", &["--simulated", "--no-recording"]).done();
    let other = folder.path().join("other");
    fs::create_dir(&other).expect("a folder");
    let smaller = new(&other, &["numpad", "--text", &phrases, "--count", "1"]);
    fs::copy(smaller.join("study.json"), study.join("study.json")).expect("a copy");
    let ended = add(&study, "P01", &["--simulated", "--no-recording"]).done();
    ended.printed("P01 has done all tasks");

    fs::remove_file(study.join("study.json")).expect("it is there");
    let again = run([
        "lab",
        "study",
        "new",
        text(&study),
        "numpad",
        "--text",
        &phrases,
    ])
    .exited(2);
    again.reported("has trials of another study");
}

#[test]
fn rings_and_values_are_measured_where_a_layout_does_not_type() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = new(
        folder.path(),
        &["direct", "workshop", "--rings", "1", "--values", "1"],
    );
    let ended = add(&study, "P01", &["--simulated"]).done();
    ended.printed("bit/s");
    let (out, rows) = report(&study);
    assert!(out.contains("effective throughput, bit/s"), "{out}");
    assert!(out.contains("error of a value"), "{out}");
    let column = |name: &str| rows[0].iter().position(|it| it == name).expect(name);
    assert_eq!(rows[1][column("targets")], "13");
    let values: Vec<_> = rows
        .iter()
        .filter(|row| row[column("kind")] == "value")
        .collect();
    assert!(!values.is_empty());
    for row in values {
        let number = |name: &str| row[column(name)].parse::<f64>().expect(name);
        let error = (number("value") - number("goal")).abs();
        assert!((error - number("value_error")).abs() < 1e-9);
    }
}

#[test]
fn practice_sessions_are_added_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = new(folder.path(), &["qwerty-flat", "--count", "1"]);
    let mut practice = ademan(["practice", "--layout", "qwerty-flat", "--text", "hi"]);
    practice.env("XDG_STATE_HOME", folder.path().join("state"));
    run_to_end(&mut practice).done();
    let added = add(&study, "P01", &["--practice"]).done();
    added.printed("added 1 practice session of P01");
    let added_again = add(&study, "P01", &["--practice"]).done();
    added_again.printed("added 0 practice sessions");
    let (out, rows) = report(&study);
    assert!(out.contains("no trials yet"), "{out}");
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[1][2], "practice");
}

#[test]
fn names_folders_and_layouts_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = new(
        folder.path(),
        &["numpad", "--count", "1", "--phrases", "digits"],
    );
    let refused = |ended: Ended, words: &str| {
        ended.exited(2).reported(words);
    };
    refused(
        add(&study, "../P01", &["--simulated"]),
        "is not a pseudonym",
    );
    refused(
        add(&study, "P01", &[]),
        "no source: name the source of the participant",
    );
    refused(
        add(&study, "P01", &["--layout", "media"]),
        "leave out --layout",
    );
    let digits = ["numpad", "--phrases", "digits"];
    let again = run(["lab", "study", "new", text(&study)]
        .into_iter()
        .chain(digits));
    refused(again, "so that no trial is lost");
    let nothing = folder.path().join("nothing");
    let twice = [
        "lab",
        "study",
        "new",
        text(&nothing),
        "numpad",
        "arrows",
        "numpad",
    ];
    refused(run(twice), "numpad is named twice");
    let board = |name: &str, keys: &str| {
        let pose = "(anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45)";
        let row = format!(r#"(at_mm: (0, 0), keys: "{keys}")"#);
        let board = format!(
            r#"Layout(name: "{name}", boards: [(pose: {pose}, pitch_mm: 19, size_mm: Box(17, 17), rows: [{row}])])"#
        );
        file(&folder, &format!("{name}.ron"), &board)
    };
    let (first, second) = (board("first", "A B"), board("second", "C D"));
    let letters = file(&folder, "letters.txt", "abcd\n");
    let apart = ["lab", "study", "new", text(&nothing), &first, &second];
    let words = [&apart[..], &["--text", &letters]].concat();
    refused(run(words), "in common");
    let ended = run([
        "lab",
        "study",
        "new",
        text(&nothing),
        "space",
        "--rings",
        "0",
    ]);
    refused(ended, "there is nothing to measure");
    refused(
        run(["lab", "study", "report", text(&nothing)]),
        "cannot use the study",
    );
    assert_eq!(
        fs::read_dir(study.join("trials"))
            .expect("a folder")
            .count(),
        0
    );
}
