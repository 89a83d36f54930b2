//! Names of files and peers that contain escape sequences and line breaks.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixListener;
use std::process::Output;
use std::thread;

use crate::support::binary::ademan;

/// Clears the screen, reverses the direction of the text, and looks like a message on a line of its own.
const NAME: &str = "x\u{1b}[2J\u{202e}\nerror: false";

/// Its printed form.
const PRINTED: &str = r"x\u{1b}[2J\u{202e}\nerror: false";

/// Runs the program and asserts that the name is printed, and only escaped.
fn run(arguments: &[&str], printed: &str) {
    let output = ademan(arguments)
        .env_remove("XDG_RUNTIME_DIR")
        .env_remove("DISPLAY")
        .output()
        .expect("the program starts");
    let Output { stdout, stderr, .. } = &output;
    let text = String::from_utf8_lossy(&[&stdout[..], stderr].concat()).into_owned();
    assert!(text.contains(printed), "{arguments:?}: {text:?}");
    assert!(
        !text.contains(['\u{1b}', '\u{202e}']),
        "{arguments:?}: {text:?}"
    );
    let is_false = |line: &str| line.starts_with("error: false");
    assert!(!text.lines().any(is_false), "{arguments:?}: {text:?}");
}

#[test]
fn names_of_layouts_files_and_sources_are_printed_escaped() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = folder.path().join("board.ron");
    let text = r#"Layout(name: "NAME", boards: [(
        pose: (anchor: elbow, bearing_deg: 35, forward_mm: 320, height_mm: -45),
        rows: [(at_mm: (-19, 0), keys: "Y N Enter")],
    )])"#;
    // A layout with control characters is invalid, or they become blanks.
    std::fs::write(&layout, text.replace("NAME", "x\u{202e}draob")).expect("a file");
    let layout = layout.to_str().expect("a plain path");
    let demo = ["demo", "--layout", layout, "--text", "y"];
    run(&demo, r"on x\u{202e}draob over");

    run(&["layout", "check", NAME], PRINTED);
    let source = format!("file:{NAME}");
    run(&["run", "--source", &source, "--control", "off"], PRINTED);
}

#[test]
fn the_answers_of_a_session_are_printed_escaped() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("control.sock");
    let listener = UnixListener::bind(&path).expect("a new socket");
    thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a client");
        let mut request = String::new();
        let mut reader = BufReader::new(stream.try_clone().expect("a socket"));
        reader.read_line(&mut request).expect("a request");
        let reply = serde_json::json!({"ok": true, "state": NAME, "stats": {}});
        writeln!(stream, "{reply}").expect("the client reads");
    });
    let path = path.to_str().expect("a plain path");
    run(&["ctl", "state", "--socket", path], PRINTED);
}
