//! Persons on the command line: files, checks, demos.

use super::files::recorded;
use super::{file, run, text};

/// Mirrors a layout for the left hand and returns its path.
fn mirrored(folder: &tempfile::TempDir, layout: &str) -> String {
    let path = folder.path().join(format!("left-{layout}.ron"));
    run(["layout", "new", text(&path), "--from", layout, "--mirror"]).done();
    text(&path).to_owned()
}

#[test]
fn a_new_person_is_shown_with_bones_and_reach() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("me");
    let path = text(&path);
    let created = run(["person", "new", path, "--hand", "left", "--length", "172"]).done();
    created.printed("ademan demo --person");
    let shown = run(["person", "show", &format!("{path}.ron")]).done().out;
    for part in [
        "me\n",
        "left hand first",
        "172 mm long",
        "forearm 233 mm",
        "reach",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    run(["person", "new", path]).exited(2);
}

#[test]
fn the_fields_of_a_person_are_listed_with_their_sources() {
    let fields = run(["person", "fields"]).done().out;
    for part in [
        "hand_length_mm",
        "100 to 300 mm",
        "Buryanov & Kotiuk",
        "amplitude_mm",
        "Scatter:",
    ] {
        assert!(fields.contains(part), "{part}: {fields}");
    }
    let tremor = run(["person", "fields", "tremor"]).done().out;
    assert!(
        tremor.contains("frequency_hz") && !tremor.contains("hand_length_mm"),
        "{tremor}"
    );
    let listed = run(["person", "list"]).done().out;
    assert!(
        listed.contains("left-small") && listed.contains("only the left hand"),
        "{listed}"
    );
}

#[test]
fn a_contradictory_person_is_refused_with_line_reason_and_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let content = "Person(\n    hand_length_mm: 160,\n    hand_breadth_mm: 120,\n)";
    let path = file(&folder, "odd.ron", content);
    for arguments in [
        vec!["person", "show", &path],
        vec!["demo", "--fast", "--person", &path],
        vec!["layout", "check", "qwerty-flat", "--person", &path],
        vec!["run", "--source", "typist:a", "--person", &path],
    ] {
        let refused = run(&arguments);
        assert_eq!(refused.code, Some(2), "{arguments:?}: {}", refused.err);
        assert!(
            refused.err.contains("odd.ron:3:") && refused.err.contains("measure both again"),
            "{arguments:?}: {}",
            refused.err
        );
    }
}

#[test]
fn a_left_handed_person_checks_and_plays_a_mirrored_layout() {
    let folder = tempfile::tempdir().unwrap();
    let board = mirrored(&folder, "qwerty-flat");
    let checked = run(["layout", "check", &board, "--person", "left-small"]).done();
    assert_eq!(checked.err, "");
    let right = run(["layout", "check", "qwerty-flat", "--person", "left-small"]).done();
    right.reported("--mirror");
    let arguments = [
        "demo",
        "--fast",
        "--person",
        "left-small",
        "--layout",
        &board,
        "--text",
        "Left",
    ];
    let played = run(arguments).done().out;
    assert!(played.contains("0.00 % character error rate"), "{played}");
    assert!(played.contains("--person left-small"), "{played}");
    let contradiction = run([
        "demo",
        "--fast",
        "--person",
        "left-small",
        "--hand",
        "right",
    ])
    .exited(2);
    contradiction.reported("leave out --hand");
}

#[test]
fn an_explicit_arm_of_a_setup_wins_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    file(&folder, "me.ron", "Person(hand_length_mm: 160)");
    let explicit = "Setup(person: \"me.ron\", arm: Model(\"unam\"))";
    let explicit = file(&folder, "explicit.ron", explicit);
    let checked = run(["layout", "check", "qwerty-flat", "--setup", &explicit]).done();
    checked.reported("not the lengths of the person");
    let own = file(&folder, "own.ron", "Setup(person: \"me.ron\")");
    let own_checked = run(["layout", "check", "qwerty-flat", "--setup", &own]).done();
    assert_eq!(own_checked.err, "");
}

#[test]
fn the_demo_takes_a_setup_and_a_glove_and_simulates_another_person() {
    let folder = tempfile::tempdir().unwrap();
    let setup = "Setup(layout: \"qwerty-arc\", arm: Measured(hand_length_mm: 185, forearm_length_mm: 250), source: \"serial:/dev/none\")";
    let setup = file(&folder, "setup.ron", setup);
    let common = [
        "demo",
        "--fast",
        "--setup",
        &setup,
        "--text",
        "ab",
        "--glove",
        "unam-hc11",
    ];
    let own = run(common).done().out;
    assert!(own.contains("typed      \"ab\""), "{own}");
    let person = file(
        &folder,
        "wild.ron",
        "Person(hand_length_mm: 185, forearm_length_mm: 250, scatter: (x_mm: 25, y_mm: 25))",
    );
    let wild = run(common
        .into_iter()
        .chain(["--person", &person, "--seed", "3"]))
    .exited(1);
    wild.reported("differs from the given one");
    let glove = run(["demo", "--fast", "--glove", "lucidgloves"]).exited(2);
    glove.reported("protocol=lucidgloves");
}

#[test]
fn a_run_with_a_person_simulates_that_person() {
    let folder = tempfile::tempdir().unwrap();
    let board = mirrored(&folder, "qwerty-flat");
    let arguments = [
        "run",
        "--source",
        "typist:ab",
        "--person",
        "left-small",
        "--layout",
        &board,
        "--output",
        "transcript",
        "--armed",
    ];
    let played = run(arguments).done();
    for event in ["down A", "up   A", "down B", "up   B"] {
        played.printed(event);
    }
}

#[test]
fn only_files_of_the_kind_that_is_missing_are_suggested() {
    for (option, name) in [
        ("--person", "me.ron"),
        ("--glove", "numpda"),
        ("--layout", "unam-hc11-lfet"),
    ] {
        let ended = run(["demo", option, name, "--fast"]).exited(2);
        ended.reported("there is no such file");
        assert!(!ended.err.contains("did you mean"), "{}", ended.err);
    }
    for (option, name, nearest) in [
        ("--person", "adutl", "adult"),
        ("--glove", "unam-hc11-lfet", "unam-hc11-left"),
        ("--layout", "numpda", "numpad"),
    ] {
        let ended = run(["demo", option, name, "--fast"]);
        ended.reported(&format!("did you mean `{nearest}`?"));
    }
    let ended = run(["run", "numpda.ron"]);
    assert!(!ended.err.contains("did you mean"), "{}", ended.err);
}

#[test]
fn a_trace_of_a_recording_has_the_person_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let source = format!("recording:{}", recorded(&folder));
    let small = file(&folder, "small.ron", "Person(hand_length_mm: 165)");
    let trace = |person: &[&str]| {
        let arguments = [&["trace", "pose", "--source", &source][..], person];
        run(arguments.concat())
    };
    let poses = trace(&[]).done().out;
    let smaller = trace(&["--person", &small]).done().out;
    assert_eq!(poses.lines().count(), smaller.lines().count());
    assert!(poses != smaller, "the hand has its recorded size");
    let missing = trace(&["--person", "nosuch"]).exited(2);
    missing.reported("nosuch: there is no such file");
}
