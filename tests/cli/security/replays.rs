//! A replay types only on request.

use std::path::Path;
use std::process::Stdio;

use crate::support::binary::ademan;
use crate::support::key_log::KeyLog;
use crate::support::x11::{TerminalWindow, XServer};

/// Number of attempts: a busy machine may drop keystrokes, which the program reports.
const ATTEMPTS: usize = 5;

/// Replays a recording with more arguments. Returns what it writes, and its messages.
fn replay(recording: &Path, arguments: &[&str], server: &XServer) -> [String; 2] {
    let mut command = ademan(["replay"]);
    command
        .arg(recording)
        .args(arguments)
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY");
    let output = command.output().expect("it starts");
    assert!(output.status.success());
    [output.stdout, output.stderr].map(|text| String::from_utf8(text).expect("it writes UTF-8"))
}

#[test]
fn a_replay_presses_nothing_unless_the_output_desktop_is_named() {
    let Some(server) = XServer::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("typed.mcap");
    let mut record = ademan(["record", "--source", "typist:hello"]);
    let recorded = record.arg(&path).stderr(Stdio::null()).status();
    assert!(recorded.expect("it starts").success());
    for _ in 0..ATTEMPTS {
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        let log = KeyLog::start(&server);
        let [written, _] = replay(&path, &[], &server);
        assert!(written.contains("down H"), "{written}");
        let [_, messages] = replay(&path, &["--output", "desktop"], &server);
        assert_eq!(server.pressed_keys(), [0; 0]);
        if !messages.contains("dropped") {
            // The second replay types, the first one does not.
            assert_eq!(terminal.typed("hello"), "hello");
            assert!(log.presses_after(0) <= "hello".len(), "{:?}", log.events());
            return;
        }
    }
    panic!("the machine is too busy");
}
