//! The output `ime` as the input method of `sway`, with text fields of GTK and the terminal `foot`.

use super::desk::{Field, has_gtk, write_setup};
use ademan::output::Desktop;

use crate::session_bus::PYTHON;
use crate::support::process::signal;
use crate::support::program::Program;
use crate::wayland::compositor::Compositor;
use crate::wayland::window::Terminal;

/// A compositor with a window that has a text field.
struct Desk {
    field: Field,
    /// Another keyboard, without which nothing has the focus before the program starts.
    _keyboard: Desktop,
    compositor: Compositor,
}

/// Opens a field of this kind. Returns `None` with a message if a program is missing.
fn open(kind: &str) -> Option<Desk> {
    if !has_gtk() {
        return None;
    }
    let compositor = Compositor::sway()?;
    Some(Desk {
        _keyboard: compositor.desktop(),
        field: Field::open_on_wayland(compositor.client(PYTHON), kind),
        compositor,
    })
}

/// Runs a simulated hand that types a text through the input method, with a text decoder.
fn type_text(compositor: &Compositor, text: &str) -> Program {
    let mut command = compositor.ademan(["run", "--control", "off"]);
    command
        .arg(write_setup(compositor.folder(), text))
        .env_remove("IBUS_ADDRESS")
        .env_remove("IBUS_ADDRESS_FILE");
    Program::from_command(command)
}

/// Returns the words that the field has shown, without repetitions.
fn words(lines: &[String]) -> Vec<&str> {
    let words = lines.iter().filter_map(|line| line.strip_prefix("word\t"));
    let mut words: Vec<&str> = words.collect();
    words.dedup();
    words
}

#[test]
fn a_word_is_shown_while_it_is_typed_and_taken_as_the_decoder_corrects_it() {
    let Some(desk) = open("text") else {
        return;
    };
    let mut program = type_text(&desk.compositor, "thw qick fox");
    let lines = desk.field.wait_for("text\tthe quick ");
    println!("{lines:#?}");
    let shown = ["t", "th", "thw", "", "q", "qi", "qic", "qick"];
    assert!(words(&lines).starts_with(&shown), "{lines:#?}");
    assert!(program.wait_for_exit().success());
    // The word that was open is taken as it is.
    assert_eq!(desk.field.text("fox"), "the quick fox");
}

#[test]
fn keys_follow_the_text_before_them_and_text_follows_the_keys_before_it() {
    let Some(desk) = open("text") else {
        return;
    };
    let mut program = type_text(&desk.compositor, "ab\\ncd\\nit ");
    assert!(program.wait_for_exit().success());
    assert_eq!(desk.field.text("it "), "abcdit ");
    let lines = desk.field.lines();
    println!("{lines:#?}");
    for text in ["ab", "abcd"] {
        assert!(lines.contains(&format!("activated\t{text}")), "{text}");
    }
}

#[test]
fn passwords_and_addresses_are_typed_as_keys_and_not_corrected() {
    for kind in ["password", "url"] {
        let Some(desk) = open(kind) else {
            return;
        };
        let mut program = type_text(&desk.compositor, "thw qick ");
        assert!(program.wait_for_exit().success());
        assert_eq!(desk.field.text("qick "), "thw qick ", "{kind}");
        let lines = desk.field.lines();
        assert!(words(&lines).is_empty(), "{kind}: {lines:#?}");
    }
}

#[test]
fn a_sentence_starts_with_a_capital_where_the_field_asks_for_it() {
    for (kind, expected) in [
        ("sentences", "Hello there. So it is "),
        // The decoder adds the capital after the full stop.
        ("text", "hello there. So it is "),
    ] {
        let Some(desk) = open(kind) else {
            return;
        };
        let mut program = type_text(&desk.compositor, "hello there. so it is ");
        assert!(program.wait_for_exit().success());
        assert_eq!(desk.field.text(expected), expected);
    }
}

#[test]
fn a_terminal_that_says_so_is_typed_into_as_keys_and_not_corrected() {
    let Some(compositor) = Compositor::sway() else {
        return;
    };
    let Some(terminal) = Terminal::start(&compositor) else {
        return;
    };
    let mut program = type_text(&compositor, "thw qick\\nfox");
    assert!(program.wait_for_exit().success());
    let expected = "thw qick\nfox";
    assert_eq!(terminal.typed(expected), expected);
}

#[test]
fn a_second_input_method_is_refused_with_the_remedy() {
    let Some(desk) = open("text") else {
        return;
    };
    let mut first = type_text(
        &desk.compositor,
        "on and on and on and on and on and on and on",
    );
    desk.field.wait_for("text\ton ");
    let mut second = type_text(&desk.compositor, "a");
    assert_eq!(second.wait_for_exit().code(), Some(2));
    let lines = second.stderr_lines().join("\n");
    println!("{lines}");
    let why = "cannot open the output `ime`: another program is the input method of the compositor";
    assert!(lines.contains(why), "{lines}");
    assert!(lines.contains("or use the output `desktop`"), "{lines}");
    first.signal(&["INT"]);
    first.wait_for_exit();
}

#[test]
fn a_killed_program_takes_its_word_along_and_the_next_one_types() {
    let Some(desk) = open("text") else {
        return;
    };
    let program = type_text(&desk.compositor, "hello there and more and more");
    desk.field.wait_for("text\thello ");
    signal("KILL", program.id());
    drop(program);
    let mut next = type_text(&desk.compositor, "again ");
    assert!(next.wait_for_exit().success());
    let (text, lines) = (desk.field.text("again "), desk.field.lines());
    println!("{lines:#?}");
    assert!(text.ends_with("again "), "{text:?}");
    assert!(text.starts_with("hello "), "{text:?}");
}

#[test]
fn a_run_ends_with_a_message_when_the_compositor_does() {
    let Some(mut desk) = open("text") else {
        return;
    };
    let mut program = type_text(&desk.compositor, "hello there and more and more and more");
    desk.field.wait_for("word\tt");
    desk.compositor.kill();
    assert!(!program.wait_for_exit().success());
    let lines = program.stderr_lines();
    println!("{lines:#?}");
    assert!(
        lines
            .iter()
            .any(|line| line.contains("the connection to the compositor failed")),
        "{lines:#?}"
    );
}
