//! `ademan practice`: a text that a simulated hand types, its result, and earlier results.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

use super::{Ended, ademan, file, run_to_end, text};

/// The command with a state folder of its own.
fn practice(state: &Path, arguments: &[&str]) -> Command {
    let mut command = ademan(["practice"]);
    command
        .args(arguments)
        // Of Linux and macOS, then of Windows.
        .env("XDG_STATE_HOME", state)
        .env("LOCALAPPDATA", state);
    command
}

fn run(state: &Path, arguments: &[&str]) -> Ended {
    run_to_end(&mut practice(state, arguments))
}

fn json(state: &Path, arguments: &[&str]) -> Value {
    let ended = run(state, &[&["--json"], arguments].concat()).done();
    serde_json::from_str(&ended.out).expect("JSON")
}

fn history_file(state: &TempDir) -> PathBuf {
    state.path().join("ademan/practice/sessions.jsonl")
}

fn lines(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).expect("a file");
    text.lines().map(str::to_owned).collect()
}

#[test]
fn the_simulated_hand_types_the_text_and_the_result_is_printed_and_kept() {
    let state = tempfile::tempdir().unwrap();
    let ended = run(state.path(), &["--text", "secreto 1"]).done();
    for expected in [
        "text       secreto 1\ntyped      secreto 1\nspeed      ",
        "words/min of correct text in ",
        "(a simulated hand)\n",
        "quality    0.0 % errors: 0 substitutions, 0 insertions, 0 deletions\nworst keys none\n",
        "progress   words/min ",
    ] {
        assert!(ended.out.contains(expected), "{expected}: {}", ended.out);
    }
    let path = history_file(&state);
    let kept = lines(&path);
    assert_eq!(kept.len(), 1);
    assert!(!kept[0].contains("secreto"), "what was typed: {}", kept[0]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |kept_path: &Path| fs::metadata(kept_path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&path), 0o600);
        assert_eq!(mode(path.parent().unwrap()), 0o700);
    }
    run(state.path(), &["--text", "a", "--no-history"]).done();
    assert_eq!(lines(&path), kept);
}

#[test]
fn a_simulated_source_is_no_practice_of_the_person() {
    let state = tempfile::tempdir().unwrap();
    let report = json(state.path(), &["--text", "hola", "--source", "typist:hola"]);
    assert_eq!(report["is_simulated"], true, "{report}");
    let kept = lines(&history_file(&state));
    assert!(kept[0].contains("\"is_simulated\":true"), "{kept:?}");
}

#[test]
fn a_noisy_hand_makes_errors_that_add_up_to_the_typed_text() {
    let state = tempfile::tempdir().unwrap();
    let mut wrong = 0;
    for noise in ["0", "4", "8"] {
        let arguments = [
            "--text",
            "una mano abierta",
            "--noise",
            noise,
            "--seed",
            "2",
        ];
        let result = json(state.path(), &arguments);
        println!("{result}");
        let count = |name: &str| result[name].as_u64().expect("a number") as usize;
        let length = |name: &str| result[name].as_str().expect("a text").chars().count();
        let inserted = length("text") + count("insertions");
        assert_eq!(inserted, length("typed") + count("deletions"), "{result}");
        let errors = count("substitutions") + count("insertions") + count("deletions");
        let rate = result["error_rate"].as_f64().unwrap();
        let expected = errors as f64 / length("text").max(length("typed")) as f64;
        assert!((rate - expected).abs() < 1e-4, "{result}");
        let has_worst = !result["worst"].as_array().unwrap().is_empty();
        let has_errors = count("substitutions") + count("deletions") > 0;
        assert!(has_worst || !has_errors, "no key is worst: {result}");
        if noise == "0" {
            assert_eq!(errors, 0, "{result}");
            assert!(result["words_per_minute"].as_f64().unwrap() > 5.0);
        }
        wrong += errors;
    }
    assert!(wrong > 0, "noise has to show");
}

#[test]
fn lessons_come_from_files_languages_and_chords() {
    let state = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "lesson.txt", "  dos\nlineas\r\n");
    let result = json(state.path(), &["--file", &path]);
    assert_eq!(result["text"], "dos lineas");
    assert_eq!(result["typed"], result["text"]);
    let spanish = |layout| json(state.path(), &["--lesson", "spanish", "--layout", layout]);
    let first = spanish("qwerty-flat");
    let second = spanish("chords-bend");
    assert_eq!(first["lesson"], "spanish");
    assert_eq!(second["typed"], second["text"]);
    assert_ne!(first["text"], second["text"], "the next one");
    let numpad = json(state.path(), &["--layout", "numpad"]);
    assert_eq!(numpad["lesson"], "characters");
    assert_eq!(numpad["typed"], numpad["text"]);
}

#[test]
fn a_phone_pad_is_practiced_with_a_decoder_that_finds_the_letters() {
    let state = tempfile::tempdir().unwrap();
    let text = "hello world";
    for layout in ["phone-words", "phone-pad"] {
        let arguments = ["--layout", layout, "--text", text];
        let refused = run(state.path(), &arguments).exited(2);
        refused.reported("add `--decoder auto`");
        let result = json(
            state.path(),
            &[&arguments[..], &["--decoder", "auto"]].concat(),
        );
        assert_eq!(result["typed"], text, "{result}");
        let worst = result["worst"].as_array().expect("a list");
        assert!(worst.is_empty(), "{result}");
        let digit = ["--layout", layout, "--decoder", "auto", "--text", "2"];
        let refused_digit = run(state.path(), &digit);
        refused_digit.reported("cannot type");
    }
}

#[test]
fn a_pointing_lesson_is_measured_and_kept_with_its_figures() {
    let state = tempfile::tempdir().unwrap();
    let result = json(state.path(), &["--lesson", "pointing"]);
    println!("{result}");
    let figure = |name: &str| result[name].as_f64().expect("a number");
    assert_eq!(result["lesson"], "pointing");
    assert_eq!(result["is_complete"], true);
    assert_eq!(
        (figure("targets"), figure("misses")),
        (13.0, 0.0),
        "{result}"
    );
    // The hand moves for 0.6 s and pushes for 0.15 s, with rests between.
    assert!((0.8..2.5).contains(&figure("movement_s")), "{result}");
    assert!((0.7..=1.0).contains(&figure("path_efficiency")), "{result}");
    assert!(figure("throughput_bits_per_s") > 1.0, "{result}");
    let path = history_file(&state);
    let kept = lines(&path);
    assert_eq!(kept.len(), 1);
    assert!(
        kept[0].contains("\"pointing\":{\"targets\":13,"),
        "{}",
        kept[0]
    );
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        assert_eq!(
            fs::metadata(&path).unwrap().permissions().mode() & 0o777,
            0o600
        );
    }
    // A trembling hand misses, or clicks less precisely; the text of another lesson is no progress of this one.
    run(state.path(), &["--text", "a", "--layout", "qwerty-flat"]).done();
    let ended = run(
        state.path(),
        &["--lesson", "pointing", "--noise", "6", "--seed", "4"],
    );
    println!("{}", ended.out);
    ended.printed("throughput ");
    let csv = run(state.path(), &["--csv", "-"]).done().out;
    let rows: Vec<&str> = csv.lines().collect();
    let columns = ",targets,misses,movement_s,path_efficiency,throughput_bits_per_s,axis_deviation_px,target_reentries,chords";
    assert!(rows[0].ends_with(columns), "{csv}");
    assert!(rows[1].contains(",,,,,,13,0,"), "{csv}");
    let table = run(state.path(), &["--history"]).done().out;
    assert!(
        table.contains(" bit/s ") && table.contains(" words/min "),
        "{table}"
    );
}

#[test]
fn a_pointing_lesson_needs_a_pointer_that_the_hand_can_move() {
    let state = tempfile::tempdir().unwrap();
    for (layout, reason) in [
        (
            "qwerty-flat",
            "has no pointer; choose a layout such as `direct`",
        ),
        ("rate", "the simulated hand cannot point on"),
    ] {
        let ended = run(state.path(), &["--lesson", "pointing", "--layout", layout]).exited(2);
        assert!(ended.err.contains(reason), "{reason}: {}", ended.err);
    }
    assert!(!history_file(&state).exists());
}

#[test]
fn a_lesson_of_chords_names_the_fingers_and_counts_each_chord() {
    let state = tempfile::tempdir().unwrap();
    let arguments = ["--layout", "chords-bend", "--lesson", "chords"];
    let result = json(state.path(), &arguments);
    let chords = result["chords"].as_array().expect("chords");
    assert!(chords.len() >= 20, "{result}");
    for chord in chords {
        assert_eq!(
            (&chord["attempts"], &chord["errors"]),
            (&3.into(), &0.into()),
            "{chord}"
        );
        let fingers = chord["fingers"].as_str().expect("names").split(" + ");
        assert!(fingers.clone().count() >= 2, "{chord}");
        assert!(
            fingers
                .clone()
                .all(|name| ["thumb", "index", "middle", "ring", "little"].contains(&name)),
            "{chord}"
        );
    }
    let line = &lines(&history_file(&state))[0];
    assert!(line.contains("[3,3]"), "{line}");
    let other = json(state.path(), &["--text", "a", "--layout", "chords-bend"]);
    assert_eq!(other["chords"].as_array().map(Vec::len), Some(0), "{other}");
}

#[test]
fn a_text_that_cannot_be_typed_is_refused() {
    let state = tempfile::tempdir().unwrap();
    for (arguments, reason) in [
        (&["--text", "日本"][..], "cannot type this text"),
        (&["--text", "  "], "nothing to type"),
        (&["--layout", "arrows"], "no key of"),
        (&["--lesson", "chords"], "no chords of bent fingers"),
        (&["--file", "/nowhere/lesson"], "cannot read the text"),
        (&["--file", "/"], "this is a directory"),
    ] {
        let ended = run(state.path(), arguments).exited(2);
        assert!(ended.err.contains(reason), "{reason}: {}", ended.err);
    }
    assert!(!history_file(&state).exists());
}

#[test]
fn a_text_with_accents_is_practiced_with_plain_letters() {
    let state = tempfile::tempdir().unwrap();
    let ended = run(state.path(), &["--text", "¿ñandú?"]).done();
    ended.printed("text       nandu?\n");
    ended.reported("plain ones");
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_file_and_a_cut_is_said() {
    let state = tempfile::tempdir().unwrap();
    let marked = file(&state, "marked.txt", "\u{feff}hola\n");
    let ended = run(state.path(), &["--file", &marked]).done();
    ended.printed("text       hola\n");
    let long = "日".repeat(1001);
    for (typed, is_cut) in [(&long[..], true), (&long[..3000], false)] {
        let refused = run(state.path(), &["--text", typed]);
        let said = refused.err.contains("the first 1000 characters");
        assert_eq!(said, is_cut, "{}", refused.err);
    }
}

#[test]
fn a_damaged_history_is_reported_and_nothing_of_it_is_lost() {
    let state = tempfile::tempdir().unwrap();
    run(state.path(), &["--text", "a b"]).done();
    let path = history_file(&state);
    let valid = fs::read(&path).unwrap();
    let damaged = [b"{\"time\":\xff\n", &valid[..]].concat();
    fs::write(&path, &damaged).unwrap();
    let ended = run(state.path(), &["--text", "a b"]).done();
    ended.reported("line 1 is damaged");
    let kept = path.with_extension("damaged.1.jsonl");
    ended.reported("is kept as ");
    assert_eq!(fs::read(kept).unwrap(), damaged);
    let sessions = lines(&path);
    assert_eq!(sessions.len(), 2);
    assert_eq!(sessions[0].as_bytes(), valid.trim_ascii_end());
    // The next one is whole.
    let whole = run(state.path(), &["--text", "a b"]).done();
    assert!(!whole.err.contains("damaged"), "{}", whole.err);
    assert_eq!(lines(&path).len(), 3);
}

#[test]
fn a_state_folder_that_cannot_be_written_is_reported_and_the_end_is_normal() {
    let folder = tempfile::tempdir().unwrap();
    let state = file(&folder, "state", "a file");
    let ended = run(Path::new(&state), &["--text", "hola"]).done();
    ended.printed("typed      hola\n");
    assert!(!ended.out.contains("progress"), "{}", ended.out);
    ended.reported("cannot keep the result in ");
    ended.reported("XDG_STATE_HOME");
    assert_eq!(fs::read_to_string(state).unwrap(), "a file");
}

#[test]
fn results_are_exported_as_csv_and_printed() {
    let state = tempfile::tempdir().unwrap();
    let none = run(state.path(), &["--history"]).done();
    none.printed("no results yet");
    for text in ["hola", "mundo"] {
        run(state.path(), &["--text", text]).done();
    }
    let csv = state.path().join("progress.csv");
    let ended = run(state.path(), &["--csv", text(&csv)]).done();
    ended.printed("wrote 2 sessions");
    let rows = lines(&csv);
    assert_eq!(rows.len(), 3);
    let columns: Vec<&str> = rows[0].split(',').collect();
    let column = |row: &str, name: &str| -> String {
        // The name of the layout has a comma, and is the only quoted field.
        let (before, rest) = row.split_once('"').expect("a quote");
        let (layout, after) = rest.split_once('"').expect("a quote");
        let plain = format!("{before}{}{after}", layout.replace(',', ""));
        let index = columns.iter().position(|column| *column == name);
        let index = index.expect("a column");
        plain.split(',').nth(index).expect("a field").to_owned()
    };
    assert_eq!(column(&rows[1], "characters"), "4");
    assert_eq!(column(&rows[2], "characters"), "5");
    assert_eq!(column(&rows[2], "layout"), "QWERTY 19 mm");
    assert_eq!(column(&rows[2], "simulated"), "true");
    let again = run(state.path(), &["--csv", text(&csv)]).exited(2);
    again.reported("the file exists");
    assert_eq!(lines(&csv), rows);
    let printed = run(state.path(), &["--csv", "-"]).done().out;
    assert_eq!(printed.lines().collect::<Vec<_>>(), rows);
    let table = run(state.path(), &["--history"]).done().out;
    assert_eq!(table.lines().count(), 3, "{table}");
    assert!(table.contains("QWERTY, 19 mm (simulated)"), "{table}");
}

#[cfg(target_os = "linux")]
mod on_a_terminal {
    use super::*;
    use crate::view::screen::Screen;
    use crate::view::set_terminal;
    use vt100::Color;

    fn start(state: &TempDir, arguments: &[&str]) -> Screen {
        let mut command = practice(state.path(), arguments);
        set_terminal(&mut command);
        Screen::start(&command, 80, 40)
    }

    #[test]
    fn the_line_shows_the_progress_and_the_end_shows_the_result() {
        let state = tempfile::tempdir().unwrap();
        // The end comes long after the text that is waited for.
        let mut screen = start(&state, &["--text", "hola amigo"]);
        let text = screen.wait_until("the progress", |shown| {
            shown.contains("typed    ho") && shown.contains("words/min")
        });
        println!("{text}");
        assert!(text.contains("to type  hola·amigo"), "{text}");
        assert!(text.contains(" of 10 characters · "), "{text}");
        assert!(
            text.contains("this view only"),
            "nothing else receives it: {text}"
        );
        assert!(screen.wait().success());
        screen.assert_restored();
        let last = screen.text();
        println!("{last}");
        assert!(last.contains("typed      hola amigo"), "{last}");
        assert!(last.contains("progress   words/min"), "{last}");
        let messages = last.rfind("armed: nothing is typed");
        assert!(messages < last.find("text       hola"), "{last}");
        assert!(messages.is_some(), "{last}");
        assert_eq!(lines(&history_file(&state)).len(), 1);
    }

    #[test]
    fn a_pointing_lesson_shows_the_targets_and_the_pointer() {
        let state = tempfile::tempdir().unwrap();
        let mut screen = start(&state, &["--lesson", "pointing"]);
        let clock = "the first click starts the clock";
        let text = screen.wait_until(clock, |shown| {
            shown.contains(clock) && shown.contains("((O))")
        });
        println!("{text}");
        // A slow machine may not draw each of them.
        let clicked = screen.wait_until("clicked targets", |shown| {
            let has = |count| shown.contains(&format!("{count} of 13 targets · 0 missed"));
            (2..=4).any(has) && shown.contains('+') && shown.contains("bit/s")
        });
        println!("{clicked}");
        screen.type_keys("\x03");
        assert!(screen.wait().success());
        screen.assert_restored();
        let last = screen.text();
        assert!(last.contains("not all targets were clicked on"), "{last}");
        assert!(!history_file(&state).exists());
    }

    #[test]
    fn a_lesson_of_chords_shows_the_fingers_to_bend_and_the_progress() {
        let state = tempfile::tempdir().unwrap();
        let mut screen = start(&state, &["--layout", "chords-bend", "--lesson", "chords"]);
        let text = screen.wait_for_text("hold     ");
        println!("{text}");
        let hold = text
            .lines()
            .find(|line| line.contains("hold     "))
            .expect("a line");
        assert!(hold.contains(" + ") && hold.contains(" for "), "{hold}");
        let progress = screen.wait_for_text(" 3/3");
        println!("{progress}");
        screen.type_keys("\x03");
        assert!(screen.wait().success());
        screen.assert_restored();
    }

    #[test]
    fn the_keys_of_wrong_characters_are_colored() {
        let state = tempfile::tempdir().unwrap();
        // The noise that the test of errors uses too.
        let arguments = ["--text", "una mano", "--noise", "8", "--seed", "2"];
        let mut screen = start(&state, &arguments);
        screen.wait();
        println!("{}", screen.text());
        let text = screen.text();
        let hot = |cell: &vt100::Cell| [Color::Idx(1), Color::Idx(3)].contains(&cell.bgcolor());
        let colored = screen.text_where(hot);
        assert!(!text.contains("worst keys none"), "{text}");
        assert_ne!(colored.trim(), "", "{text}");
    }

    #[test]
    fn ctrl_c_ends_it_with_the_result_so_far_and_keeps_nothing() {
        let state = tempfile::tempdir().unwrap();
        let mut screen = start(&state, &["--text", "a long text that nobody ends"]);
        screen.wait_for_text("typed    a");
        screen.type_keys("\x03");
        assert!(screen.wait().success());
        screen.assert_restored();
        let text = screen.text();
        assert!(text.contains("the text was not completed"), "{text}");
        assert!(text.contains("0.0 % errors"), "{text}");
        assert!(!history_file(&state).exists());
    }
}
