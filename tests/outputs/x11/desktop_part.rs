//! Absolute positions of the pointer in a part of the desktop, such as one of several monitors.

use std::fs;

use crate::support::program::Program;
use crate::support::x11::XServer;

/// Largest difference of two runs of one script, in pixels.
const TOLERANCE: i16 = 5;

#[test]
fn a_pointer_is_in_its_part_of_the_desktop() {
    let Some(server) = XServer::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("setup.ron").display().to_string();
    let pointer_after = |field: &str| {
        // A busy machine must not cause a stall.
        let setup = format!("Setup(stall_timeout_ms: 5000, {field})");
        fs::write(&path, setup).expect("a new file");
        let source = "script:point 150 0 -220; wait 300";
        let arguments = [
            "run", &path, "--source", source, "--layout", "direct", "--output", "desktop",
        ];
        let mut program = Program::start(&server, arguments);
        let status = program.wait_for_exit();
        assert!(status.success(), "{:#?}", program.stderr_lines());
        server.pointer()
    };
    let (x, y) = pointer_after("");
    assert!((1..400).contains(&x), "in the left half: {x}");
    let (x_in_part, y_in_part) = pointer_after("desktop_part: (left: 0.5)");
    let is_near = |position: i16, expected: i16| (position - expected).abs() <= TOLERANCE;
    assert!(
        is_near(x_in_part, 400 + x / 2) && is_near(y_in_part, y),
        "{x} {y}, in the right half: {x_in_part} {y_in_part}"
    );
}
