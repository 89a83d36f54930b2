//! The output `ime` with the IBus daemon, text fields of GTK and Qt and a terminal, and on a Wayland compositor.

#[cfg(feature = "wayland")]
mod compositor;
mod desk;

use std::fs;
use std::process::Stdio;
use std::time::Duration;

use self::desk::{Desk, Field, GTK_4, QT_5, QT_6, Toolkit, start_if_installed};
use crate::support::process::signal;
use crate::support::x11::{wait_at_most, wait_for};

#[test]
fn a_word_is_shown_while_it_is_typed_and_taken_as_the_decoder_corrects_it() {
    let Some(desk) = Desk::start() else { return };
    let field = Field::open(&desk, "text");
    let mut program = desk.type_text("thw qick fox");
    let lines = field.wait_for("text\tthe quick ");
    println!("{lines:#?}");
    let words: Vec<&str> = lines
        .iter()
        .filter_map(|line| line.strip_prefix("word\t"))
        .collect();
    assert_eq!(words, ["t", "th", "thw", "", "q", "qi", "qic", "qick", ""]);
    assert!(program.wait_for_exit().success());
    // The word that was open is taken as it is.
    assert_eq!(field.text("fox"), "the quick fox");
    assert_eq!(desk.engine(), "xkb:us::eng");
}

#[test]
fn keys_follow_the_text_before_them_and_text_follows_the_keys_before_it() {
    let Some(desk) = Desk::start() else { return };
    let field = Field::open(&desk, "text");
    let mut program = desk.type_text("ab\\ncd\\nit ");
    assert!(program.wait_for_exit().success());
    assert_eq!(field.text("it "), "abcdit ");
    let lines = field.lines();
    println!("{lines:#?}");
    for text in ["ab", "abcd"] {
        assert!(lines.contains(&format!("activated\t{text}")), "{text}");
    }
}

#[test]
fn a_password_is_typed_as_keys_and_not_corrected() {
    let Some(desk) = Desk::start() else { return };
    let field = Field::open(&desk, "password");
    let mut program = desk.type_text("thw qick ");
    assert!(program.wait_for_exit().success());
    assert_eq!(field.text("qick "), "thw qick ");
    let lines = field.lines();
    assert!(
        !lines.iter().any(|line| line.starts_with("word")),
        "{lines:#?}"
    );
}

/// Checks that fields take text, its corrections and keys in the order in which they were typed, and passwords as they are.
fn check_fields(toolkit: &Toolkit) {
    if !toolkit.is_installed() {
        return;
    }
    let Some(desk) = Desk::start() else { return };
    let field = Field::open_with(toolkit, &desk, "text");
    let mut program = desk.type_text("thw ab\\nit ");
    assert!(program.wait_for_exit().success());
    assert_eq!(field.text("it "), "the abit ");
    let lines = field.lines();
    println!("{lines:#?}");
    for line in ["word\tthw", "text\tthe ", "activated\tthe ab"] {
        assert!(
            lines.iter().any(|said| said == line),
            "{line:?}: {lines:#?}"
        );
    }
    drop(field);
    let secret = Field::open_with(toolkit, &desk, "password");
    let mut next = desk.type_text("thw ");
    assert!(next.wait_for_exit().success());
    assert_eq!(secret.text("thw "), "thw ");
    let secret_lines = secret.lines();
    assert!(
        !secret_lines.iter().any(|line| line.starts_with("word")),
        "{secret_lines:#?}"
    );
}

#[test]
fn fields_of_gtk_4_take_text_in_the_order_of_the_keys() {
    check_fields(&GTK_4);
}

#[test]
fn fields_of_qt_5_take_text_in_the_order_of_the_keys() {
    check_fields(&QT_5);
}

#[test]
fn fields_of_qt_6_take_text_in_the_order_of_the_keys() {
    check_fields(&QT_6);
}

#[test]
fn a_terminal_takes_text_through_the_protocol_of_x() {
    let Some(desk) = Desk::start() else { return };
    // A program that starts before the bridge to the protocol of X goes without it.
    let servers = || {
        desk.command("xprop")
            .args(["-root", "XIM_SERVERS"])
            .output()
    };
    let is_served =
        || servers().is_ok_and(|it| String::from_utf8_lossy(&it.stdout).contains("ibus"));
    if servers().is_err() {
        return println!("SKIPPED: Debian's x11-utils is not installed");
    }
    assert!(wait_for(is_served), "ibus-x11 does not start");
    let mut command = desk.command("xterm");
    command
        .args([
            "-u8",
            "-e",
            "sh",
            "-c",
            "stty -icanon -echo; exec cat > typed",
        ])
        .current_dir(desk.folder.path())
        .stderr(Stdio::null());
    let Some(_terminal) = start_if_installed(&mut command, "xterm") else {
        return;
    };
    let typed = || fs::read_to_string(desk.folder.path().join("typed"));
    assert!(wait_for(|| typed().is_ok()), "xterm runs its script");
    desk.server.focus_visible_window();
    // Enter ends a word without correcting it.
    let is_typed = || {
        let text = typed().unwrap_or_default();
        text.ends_with("the qick\rfox") || text.ends_with("the qick\nfox")
    };
    // On a busy machine, the daemon learns late that the terminal has the focus, and keys are typed until then.
    let has_typed = (0..5).any(|_| {
        let mut program = desk.type_text("thw qick\\nfox");
        assert!(program.wait_for_exit().success());
        wait_at_most(Duration::from_secs(5), is_typed)
    });
    assert!(has_typed, "{:?}", typed());
}

#[test]
fn the_panel_of_the_desktop_lists_candidates_and_a_click_takes_one() {
    let Some(desk) = Desk::with_panel("quick") else {
        return;
    };
    let field = Field::open(&desk, "text");
    let mut program = desk.type_text("qick");
    // With its space, before the word is ended.
    field.wait_for("text\tquick ");
    assert!(program.wait_for_exit().success());
    let lists = desk.lists();
    println!("{lists:#?}");
    assert!(
        lists.iter().any(|list| list.contains("quick")),
        "{lists:#?}"
    );
    assert_eq!(lists.last().map(String::as_str), Some(""));
}

#[test]
fn keys_go_on_while_the_daemon_is_away_and_text_after_it_is_back() {
    let Some(mut desk) = Desk::start() else {
        return;
    };
    let field = Field::open(&desk, "text");
    let mut program = desk.type_text("on and on and on and on and on and on and on and on and on");
    field.wait_for("text\ton ");
    desk.kill_daemon();
    program.wait_for_line("IBus has ended", 1);
    desk.start_daemon("disable");
    program.wait_for_line("IBus is back", 1);
    assert!(program.wait_for_exit().success());
    assert!(
        desk.server.wait_for_keys(&[]),
        "{:?}",
        desk.server.pressed_keys()
    );
    // A word at most is lost on each side of the gap.
    let (text, lines) = (field.text("on"), field.lines());
    println!("{text:?}\n{lines:#?}");
    let words: Vec<&str> = text.split_whitespace().collect();
    assert!(words.len() >= 10, "{text:?}");
}

#[test]
fn a_program_that_is_killed_leaves_no_key_pressed_and_the_field_usable() {
    let Some(desk) = Desk::start() else { return };
    let field = Field::open(&desk, "text");
    let program = desk.type_text("hello there and more and more");
    field.wait_for("text\thello ");
    signal("KILL", program.id());
    assert!(
        desk.server.wait_for_keys(&[]),
        "{:?}",
        desk.server.pressed_keys()
    );
    drop(program);
    let mut next = desk.type_text("again ");
    assert!(next.wait_for_exit().success());
    let text = field.text("again ");
    assert!(text.ends_with("again "), "{text:?}");
}

#[test]
fn without_a_daemon_the_message_says_how_to_start_it() {
    let Some(mut desk) = Desk::start() else {
        return;
    };
    desk.kill_daemon();
    fs::remove_dir_all(desk.folder.path().join("config")).expect("it is there");
    let mut program = desk.type_text("a");
    assert!(!program.wait_for_exit().success());
    let lines = program.stderr_lines().join("\n");
    println!("{lines}");
    assert!(
        lines.contains("IBus does not run for this display"),
        "{lines}"
    );
    assert!(lines.contains("ibus-daemon --daemonize"), "{lines}");
}
