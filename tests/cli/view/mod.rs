//! The live view of `run`, `watch` and `demo`, on the screen of a terminal.

pub mod screen;
mod watching;

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;

use ademan::hand::Finger;
use vt100::Color;

use self::screen::Screen;
use crate::ademan;
use crate::support::process::signal;

/// A text that takes longer than a test.
const LONG_TEXT: &str = "typist:hello hello hello hello hello hello hello hello hello hello hello hello hello hello hello";

/// A run of a simulated hand, in a UTF-8 locale with colors.
fn run(arguments: &[&str]) -> Command {
    run_typing(LONG_TEXT, arguments)
}

fn run_typing(source: &str, arguments: &[&str]) -> Command {
    let mut command = ademan(["run", "--source", source, "--control", "off"]);
    command.args(arguments);
    set_terminal(&mut command);
    command
}

/// Sets the environment of a terminal with colors, in a UTF-8 locale.
pub fn set_terminal(command: &mut Command) {
    command
        .env("TERM", "xterm-256color")
        .env("LC_ALL", "C.UTF-8")
        .env_remove("NO_COLOR")
        .env_remove("CLICOLOR")
        .env_remove("CLICOLOR_FORCE");
}

fn is_lit(screen: &Screen) -> bool {
    screen
        .text_where(|cell| cell.bgcolor() == Color::Idx(2))
        .contains('H')
}

/// The lines of a file that another program writes.
fn lines(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn a_run_on_a_terminal_shows_board_fingertips_keys_counts_and_messages() {
    let mut screen = Screen::start(&run(&[]), 80, 24);
    screen.wait_for("pressed key H", is_lit);
    let text = screen.wait_for_text("armed: nothing is typed");
    println!("{text}");
    for expected in [
        "running",
        "QWERTY, 19 mm",
        "typist:hello",
        "│ Q ││ W │",
        " readings",
        "no losses",
    ] {
        assert!(text.contains(expected), "{expected}:\n{text}");
    }
    for finger in Finger::ALL {
        assert!(text.contains(finger.name()), "{finger}:\n{text}");
    }
    screen.wait_for_text("typed \"hello");
    assert!(!text.contains("no room"), "{text}");
    // The transcript, which is the default output, does not mix with the picture.
    assert!(!text.contains("  down H"), "{text}");
    signal("TERM", screen.program.0.id());
    assert!(screen.wait().success());
    screen.assert_restored();
    let last = screen.text();
    println!("{last}");
    assert!(
        last.contains("│ Q ││ W │"),
        "the last picture stays:\n{last}"
    );
    assert!(
        last.contains("armed: nothing is typed"),
        "messages are kept:\n{last}"
    );
    assert!(last.contains("accepted"), "{last}");
}

#[test]
fn the_typed_text_is_shown_as_it_is_after_backspace_and_shift() {
    let script =
        "script:tap ShiftLeft; tap H; tap E; tap X; tap Backspace; tap A; press L; wait 20000";
    let mut command = ademan(["run", "--source", script, "--control", "off"]);
    set_terminal(&mut command);
    let mut screen = Screen::start(&command, 80, 24);
    let text = screen.wait_for_text("typed \"Heal\"");
    println!("{text}");
    signal("TERM", screen.program.0.id());
    assert!(screen.wait().success());
}

#[test]
fn a_small_window_shows_small_keys_and_says_what_it_leaves_out() {
    let screen = Screen::start(&run(&[]), 40, 12);
    screen.wait_for_text("armed");
    let text = screen.wait_for("pressed key H", is_lit);
    println!("{text}");
    // Fingertips stand between the keys.
    let is_row = |line: &str| line.contains("Q") && line.contains("P") && !line.contains('│');
    assert!(text.lines().any(is_row), "{text}");
    assert!(!text.contains('┌'), "{text}");
    screen.resize(24, 6);
    let small = screen.wait_for_text("no room for");
    println!("{small}");
    screen.resize(80, 24);
    screen.wait_for_text("│ Q ││ W │");
    screen.resize(1, 1);
    screen.resize(80, 30);
    screen.wait_for_text("│ Q ││ W │");
}

#[test]
fn labels_are_cut_at_their_end_only() {
    // Keys of the right hand only: this run has no other hand.
    let command = run_typing(
        "typist:hill hill hill hill",
        &["--layout", "qwerty-two-flat"],
    );
    let screen = Screen::start(&command, 80, 24);
    let text = screen.wait_for_text("│ Q ");
    println!("{text}");
    for line in text.lines().filter(|line| line.contains('│')) {
        for label in line.split('│').map(str::trim) {
            assert!(
                !label.starts_with("ackspace") && !label.starts_with("hift"),
                "{text}"
            );
        }
    }
}

#[test]
fn without_colors_a_pressed_key_is_reversed_and_without_utf_8_all_is_ascii() {
    let mut command = run(&[]);
    command.env("NO_COLOR", "1").env("LC_ALL", "C");
    let screen = Screen::start(&command, 80, 24);
    let text = screen.wait_for("pressed key H", |screen| {
        screen
            .text_where(|cell| cell.inverse() && cell.bold())
            .contains("| H |")
    });
    println!("{text}");
    assert!(text.contains("| Q || W |"), "{text}");
    let colored = screen
        .text_where(|cell| cell.fgcolor() != Color::Default || cell.bgcolor() != Color::Default);
    assert_eq!(colored, "");
    assert!(screen.written().is_ascii());
    let fingertips = screen.text_where(|cell| cell.underline());
    assert!(fingertips.contains('2'), "{fingertips}");
}

#[test]
fn typing_goes_on_in_a_terminal_that_is_not_read_and_one_signal_ends_it_in_order() {
    let folder = tempfile::tempdir().unwrap();
    let events = folder.path().join("events");
    let output = format!("transcript:{}", events.display());
    let mut screen = Screen::start_unread(&run(&["--output", &output]), 80, 24);
    // Two words take some seconds, in which hundreds of pictures do not fit into the terminal.
    let pressed = |key: &str| {
        lines(&events)
            .iter()
            .filter(|line| line.contains(key))
            .count()
    };
    while pressed("down Space") < 2 {
        assert!(screen.program.0.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    signal("TERM", screen.program.0.id());
    assert_eq!(
        screen.wait().code(),
        Some(0),
        "in order, and not by the time limit"
    );
    assert_eq!(pressed(" down "), pressed(" up "));
}

#[test]
fn ctrl_s_stops_the_picture_only_and_the_end_restores_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let events = folder.path().join("events");
    let output = format!("transcript:{}", events.display());
    let mut screen = Screen::start(&run(&["--output", &output]), 80, 24);
    screen.wait_for("pressed key H", is_lit);
    screen.type_keys("\x13");
    let before = lines(&events).len();
    while lines(&events).len() < before + 8 {
        assert!(screen.program.0.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    signal("TERM", screen.program.0.id());
    assert_eq!(screen.wait().code(), Some(0));
    screen.assert_restored();
}

#[test]
fn ctrl_z_gives_the_terminal_back_until_the_run_continues() {
    stop_and_continue(Screen::start(&run(&[]), 80, 24), KEYS);
}

#[test]
fn ctrl_z_gives_the_terminal_back_until_practice_or_a_demo_continues() {
    for arguments in [
        &["practice", "--no-history", "--text", &"hello ".repeat(20)][..],
        &["demo", "--repeat"],
    ] {
        let mut command = ademan(arguments);
        set_terminal(&mut command);
        stop_and_continue(Screen::start(&command, 80, 24), KEYS);
    }
}

#[test]
fn ctrl_backslash_gives_the_terminal_back_before_it_ends_the_program() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, shown) in [
        (["demo", "--repeat"], KEYS[0]),
        (["calibrate", "--demo"], "q quit"),
    ] {
        let mut command = ademan(arguments);
        // The system may write the memory of the program to a file there.
        command.current_dir(folder.path());
        set_terminal(&mut command);
        let mut screen = Screen::start(&command, 80, 24);
        screen.wait_for_text(shown);
        signal("QUIT", screen.program.0.id());
        assert_eq!(screen.wait().signal(), Some(3), "{arguments:?}");
        screen.assert_restored();
    }
}

/// Two keys of a keyboard, and the first of them.
const KEYS: [&str; 2] = ["│ Q ││ W │", "│ Q │"];

/// Stops a program that shows a text as Ctrl-Z does until not even a part of it is shown, continues and ends it.
fn stop_and_continue(mut screen: Screen, [shown, part]: [&str; 2]) {
    screen.wait_for_text(shown);
    // The parent of this process group is no shell that would be told of the stop.
    signal("TSTP", screen.program.0.id());
    screen.wait_for("the restored terminal", |screen| {
        !screen.text().contains(part)
    });
    screen.assert_restored();
    signal("CONT", screen.program.0.id());
    screen.wait_for_text(shown);
    signal("HUP", screen.program.0.id());
    assert_eq!(screen.wait().code(), Some(0));
    screen.assert_restored();
}

#[test]
fn the_result_of_a_demo_breaks_between_words() {
    let mut command = ademan(["demo", "--text", "a", "--fast"]);
    set_terminal(&mut command);
    let mut screen = Screen::start(&command, 80, 40);
    assert!(screen.wait().success());
    let text = screen.text();
    assert!(
        text.contains(" % character error\n           rate\n"),
        "{text}"
    );
}

#[test]
fn a_picture_and_a_transcript_do_not_share_a_terminal() {
    let mut screen = Screen::start(&run(&["--view", "board", "--output", "transcript"]), 80, 24);
    assert_eq!(screen.wait().code(), Some(2));
    let text = screen.text();
    assert!(text.contains("`--view log`"), "{text}");

    let plain = Screen::start(&run(&["--output", "transcript"]), 80, 24);
    plain.wait_for_text("down H");
    assert!(!plain.text().contains('┌'));

    let ended = crate::run(["run", "--source", "typist:h", "--view", "board"]).exited(2);
    ended.reported("standard output is not a terminal");
}

#[test]
fn the_other_views_print_messages_or_only_errors() {
    let log = crate::run(["run", "--source", "typist:h", "--view", "log"]).done();
    log.reported("armed: nothing is typed");
    let none = crate::run(["run", "--source", "typist:h", "--view", "none"]).done();
    assert!(!none.err.contains("armed"), "{}", none.err);
}

#[test]
fn pointers_targets_in_space_sliders_and_axes_are_shown() {
    let demo = |layout: &str| {
        let mut command = ademan(["demo", "--layout", layout]);
        set_terminal(&mut command);
        Screen::start(&command, 80, 24)
    };
    let media = demo("media");
    let text = media.wait_for("value of the knob", |screen| {
        let text = screen.text();
        text.contains("Volume") && text.contains("Seek") && text.contains('┃')
    });
    println!("{text}");
    let space = demo("space");
    let space_text = space.wait_for("cursor among the targets", |screen| {
        let seen = screen.text();
        seen.contains("Moon") && seen.contains('✛') && seen.contains(" mm ")
    });
    println!("{space_text}");
    let mut direct = demo("direct");
    let direct_text = direct.wait_for("position of the pointer", |screen| {
        screen.text().contains("pointer 0.") && screen.text().contains('✛')
    });
    println!("{direct_text}");
    direct.type_keys("\x03");
    assert_eq!(direct.wait().code(), Some(1));
    direct.assert_restored();
    let last = direct.text();
    assert!(
        last.contains("pointer 0."),
        "the last picture stays:\n{last}"
    );
}
