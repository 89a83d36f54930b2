//! `ademan start`: the first start with a glove that a test wears, with flags and on a terminal.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use ademan::capture::SourceUri;
use ademan::hand::Side;
use ademan::setup::Setup;
use tempfile::TempDir;

use crate::support::glove::Glove;
use crate::support::home_made_glove::{BUILD, Wearer};
use crate::support::process::signal;
use crate::support::run::postures;
use crate::view::{screen::Screen, set_terminal};
use crate::{Ended, ademan, run_to_end, text};

/// The command in a folder, which is its state folder and its configuration folder too.
fn start(folder: &TempDir, arguments: &[&str]) -> Command {
    let mut command = ademan(["start"]);
    command
        .args(arguments)
        .current_dir(folder.path())
        .env("XDG_CONFIG_HOME", folder.path().join("config"))
        .env("XDG_STATE_HOME", folder.path().join("state"));
    command
}

fn run(folder: &TempDir, arguments: &[&str]) -> Ended {
    run_to_end(&mut start(folder, arguments))
}

fn on_terminal(folder: &TempDir, arguments: &[&str]) -> Screen {
    let mut command = start(folder, arguments);
    set_terminal(&mut command);
    Screen::start(&command, 100, 40)
}

fn load(path: &Path) -> Setup {
    println!("{}", fs::read_to_string(path).expect("a file"));
    Setup::load(text(path)).expect("a setup")
}

/// Returns the names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn a_glove_of_curls_is_recognized_calibrated_and_gets_a_layout_of_chords() {
    let folder = tempfile::tempdir().expect("a folder");
    let wearer = Wearer::start(BUILD);
    let port = wearer.port();
    let arguments = ["--yes", "--port", &port, "--countdown", "0.5"];
    let posed = wearer.pose_for(start(&folder, &arguments));
    let out = Ended::from(posed).done().out;
    assert!(out.contains("looks like LucidGloves"), "{out}");
    assert!(out.contains("layout: chords-bend"), "{out}");
    // It is the setup of every run without another one.
    assert!(
        out.ends_with("next time: ademan run --output desktop\n"),
        "{out}"
    );
    let config = folder.path().join("config/ademan");
    assert_eq!(
        names(&config),
        ["setup-glove.mcap", "setup-glove.ron", "setup.ron"]
    );
    let setup = load(&config.join("setup.ron"));
    let source = setup.source.clone().expect("a source").to_string();
    assert!(
        source.starts_with(&format!("serial:{port}?protocol=lucidgloves")),
        "{source}"
    );
    assert_eq!(setup.layout, "chords-bend");
    assert_eq!(
        setup.output,
        Setup::default().output,
        "it types into no program"
    );
    let loaded = setup.load_files().expect("all files");
    assert_eq!(loaded.glove_path(), config.join("setup-glove.ron").to_str());
}

#[test]
fn the_glove_with_an_arm_gets_a_keyboard_and_nothing_is_replaced_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let (clear, _) = postures();
    let port = folder.path().join("port");
    let _glove = Glove::plug_in(&port, clear);
    let arguments = [
        "--yes",
        "--port",
        text(&port),
        "--no-calibrate",
        "--out",
        "mine.ron",
    ];
    let ended = run(&folder, &arguments).done();
    assert!(
        ended
            .out
            .ends_with("next time: ademan run mine.ron --output desktop\n"),
        "{}",
        ended.out
    );
    let path = folder.path().join("mine.ron");
    let setup = load(&path);
    assert_eq!(setup.layout, "qwerty-flat");
    assert_eq!(setup.glove, None, "the protocol's glove");
    let before = fs::read(&path).expect("a file");
    let again = run(&folder, &arguments).exited(2);
    again.reported("mine.ron exists");
    assert_eq!(fs::read(&path).expect("a file"), before);
    let left = [&arguments[..], &["--hand", "left", "--force"]].concat();
    run(&folder, &left).done();
    let left_setup = load(&path);
    assert_eq!(left_setup.glove.as_deref(), Some("unam-hc11-left"));
    let layout = folder.path().join("qwerty-flat-left.ron");
    assert_eq!(left_setup.layout, text(&layout));
    let loaded = left_setup.load_files().expect("all files");
    assert_eq!(loaded.layout.name, "qwerty-flat-left");
    assert!(loaded.reach_report(&loaded.layout).is_none());
    assert_eq!(
        fs::read(folder.path().join("mine.ron.bak")).expect("a file"),
        before
    );
}

#[test]
fn the_hand_of_a_source_or_a_glove_that_is_named_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let camera = "udp:127.0.0.1:9000?protocol=hand-landmarks&hand=left";
    let chords = ["--yes", "--layout", "chords-bend", "--source"];
    let left = [&chords[..], &[camera, "--out", "left.ron"]].concat();
    run(&folder, &left).done();
    let setup = load(&folder.path().join("left.ron"));
    let hand = setup.source.as_ref().and_then(SourceUri::hand);
    assert_eq!(hand, Some(Side::Left));
    let serial = "serial:/dev/ttyNOWHERE?protocol=lucidgloves";
    let worn = [&chords[..], &[serial, "--glove", "lucidgloves-left"]].concat();
    run(&folder, &[&worn[..], &["--out", "worn.ron"]].concat()).done();
    let glove = load(&folder.path().join("worn.ron")).glove;
    assert_eq!(glove.as_deref(), Some("lucidgloves-left"));
    let wrong = [&worn[..], &["--out", "wrong.ron", "--hand", "right"]].concat();
    let refused = run(&folder, &wrong).exited(2);
    refused.reported("is for the left hand");
    assert_eq!(names(folder.path()), ["left.ron", "worn.ron"]);
}

#[test]
fn each_question_has_a_proposal_and_the_practice_line_comes_last() {
    let folder = tempfile::tempdir().expect("a folder");
    let wearer = Wearer::start(BUILD);
    let port = wearer.port();
    let mut screen = on_terminal(&folder, &["--port", &port, "--out", "mine.ron"]);
    screen.wait_for_text("which hand is measured, right or left [right]:");
    screen.type_keys("both\r");
    screen.wait_for_text("answer `right` or `left`");
    screen.type_keys("\r");
    screen.wait_for_text("layout, or the file of one [chords-bend]:");
    screen.type_keys("\r");
    screen.wait_for_text("calibrate now [yes]:");
    screen.type_keys("no\r");
    screen.wait_for_text("try it in a practice line [yes]:");
    assert_eq!(names(folder.path()), ["mine.ron"]);
    screen.type_keys("\r");
    let shown = screen.wait_for_text("to type  ");
    println!("{shown}");
    screen.type_keys("\x03");
    assert!(screen.wait().success());
    screen.assert_restored();
    let last = screen.text();
    assert!(
        last.contains("next time: ademan run mine.ron --output desktop"),
        "{last}"
    );
    assert_eq!(load(&folder.path().join("mine.ron")).layout, "chords-bend");
}

#[test]
fn ctrl_c_at_any_step_leaves_no_file() {
    let wearer = Wearer::start(BUILD);
    let port = wearer.port();
    let arguments = ["--port", &port, "--out", "mine.ron"];
    for (answers, last) in [
        (0, "for a few seconds"),
        (0, "which hand"),
        (1, "layout, or the file"),
        (2, "calibrate now"),
        (3, "pose 1 of "),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut screen = on_terminal(&folder, &arguments);
        for question in ["which hand", "layout, or the file", "calibrate now"]
            .iter()
            .take(answers)
        {
            screen.wait_for_text(question);
            screen.type_keys("\r");
        }
        screen.wait_for_text(last);
        screen.type_keys("\x03");
        screen.wait();
        screen.assert_restored();
        assert_eq!(names(folder.path()), [""; 0], "{last}");
    }
}

#[test]
fn the_question_whether_to_replace_a_setup_is_a_no_by_default() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mine.ron"), "precious").expect("a file");
    let wearer = Wearer::start(BUILD);
    let port = wearer.port();
    let arguments = [
        "--yes",
        "--port",
        &port,
        "--out",
        "mine.ron",
        "--no-calibrate",
    ];
    let mut screen = on_terminal(&folder, &arguments);
    screen.wait_for_text("replace mine.ron? [y/N]");
    screen.type_keys("\r");
    assert_eq!(screen.wait().code(), Some(1));
    let shown = screen.text();
    assert!(shown.contains("mine.ron is unchanged"), "{shown}");
    let text = fs::read_to_string(folder.path().join("mine.ron"));
    assert_eq!(text.expect("a file"), "precious");
    assert_eq!(names(folder.path()), ["mine.ron"]);
}

#[test]
fn without_a_device_the_simulated_hand_types() {
    let folder = tempfile::tempdir().expect("a folder");
    let ended = run(&folder, &["--simulated", "--layout", "numpad"]).done();
    ended.printed("typed      3.14159*2-0.5");
    ended.printed("practice:  ademan practice --layout numpad\n");
    assert!(!ended.out.contains("left"), "{}", ended.out);
    assert!(
        !folder.path().join("config").exists(),
        "no setup is written"
    );
    let arguments = ["--simulated", "--no-practice", "--yes", "--hand", "left"];
    let left = run(&folder, &arguments).done().out;
    assert!(left.contains("a right hand is simulated here"), "{left}");
    assert!(left.contains("--glove unam-hc11-left"), "{left}");
    let absent = run(&folder, &["--port", "/dev/ttyNOWHERE"]).exited(2);
    absent.printed("cannot listen: there is no such port");
    absent.reported("no device was recognized");
}

#[test]
fn a_full_or_closed_standard_output_ends_it_without_a_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let (reader, closed) = std::io::pipe().expect("a pipe");
    drop(reader);
    let full = fs::File::options().write(true).open("/dev/full");
    let full = full.expect("a device");
    for (stdout, code) in [(Stdio::from(closed), 0), (Stdio::from(full), 1)] {
        let mut command = start(&folder, &["--simulated", "--no-practice"]);
        let ended = run_to_end(command.stdout(stdout)).exited(code);
        assert!(!ended.err.contains("panicked"), "{}", ended.err);
    }
}

#[test]
fn a_signal_during_the_search_ends_it_unless_it_is_the_emergency_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let port = folder.path().join("port");
    let (clear, _) = postures();
    let glove = Glove::plug_in(&port, clear);
    glove.stop_sending();
    let mut screen = on_terminal(&folder, &["--port", text(&port)]);
    screen.wait_for_text("listening to ");
    signal("USR1", screen.program.0.id());
    signal("TERM", screen.program.0.id());
    // A program that a signal kills has no code.
    let code = screen.wait().code();
    assert!(code.is_some_and(|it| it != 0), "{code:?}");
    assert!(!folder.path().join("config").exists());
}
