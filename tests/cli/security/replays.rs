//! A replay types only on request.

use std::process::Stdio;

use crate::support::binary::ademan;
use crate::support::x11::{TerminalWindow, XServer};

#[test]
fn a_replay_presses_nothing_unless_the_output_desktop_is_named() {
    let Some(server) = XServer::start() else {
        return;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("typed.mcap");
    let mut record = ademan(["record", "--source", "typist:hello"]);
    let recorded = record.arg(&path).stderr(Stdio::null()).status();
    assert!(recorded.expect("it starts").success());

    let replay = |arguments: &[&str]| {
        let mut command = ademan(["replay"]);
        command
            .arg(&path)
            .args(arguments)
            .env("DISPLAY", server.display())
            .env_remove("WAYLAND_DISPLAY")
            .stderr(Stdio::null());
        let output = command.output().expect("it starts");
        assert!(output.status.success());
        String::from_utf8(output.stdout).expect("it writes UTF-8")
    };
    let written = replay(&[]);
    assert!(written.contains("down H"), "{written}");
    replay(&["--output", "desktop"]);
    // The second replay types, the first one does not.
    assert_eq!(terminal.typed("hello"), "hello");
    assert_eq!(server.pressed_keys(), [0; 0]);
}
