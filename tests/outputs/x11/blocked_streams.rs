//! Keys are released while standard output and standard error are full, and nobody reads them.

use std::process::Stdio;
use std::time::{Duration, Instant};

use super::wait_for_release;
use crate::support::binary::ademan;
use crate::support::full_pipe::full_pipe;
use crate::support::glove::Glove;
use crate::support::press::{Press, x11_code};
use crate::support::process::{Process, collect_lines, signal};
use crate::support::x11::{XServer, wait_at_most, wait_for};

#[test]
fn a_key_is_released_when_the_finger_lifts_or_the_cable_is_pulled_and_the_run_ends_on_one_signal() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("h");
    let (_folder, mut glove, source) = Glove::in_new_folder(press.clear());
    let ((_out, stdout), (_err, stderr)) = (full_pipe(), full_pipe());
    // The transcript comes first, so that the other output waits for it, if anything does.
    let output = "transcript,desktop";
    let mut command = ademan(["run", "--armed", "--output", output, "--source", &source]);
    command
        .args(["--control", "off"])
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(stderr);
    let mut program = Process::start(&mut command).expect("the program starts");
    let key = [x11_code("H")];
    let hold = |used: &Glove| {
        assert!(wait_for(|| {
            used.play(&press.approach);
            wait_at_most(Duration::from_secs(5), || server.pressed_keys() == key)
        }));
    };
    hold(&glove);
    let start = Instant::now();
    glove.play(&press.lift);
    wait_for_release(&server, start, "lifted");
    hold(&glove);
    let unplugged_at = Instant::now();
    glove.unplug();
    wait_for_release(&server, unplugged_at, "unplugged");
    let killed_at = Instant::now();
    signal("TERM", program.0.id());
    let status = program.wait_for_exit();
    println!("ended after {:.1?}", killed_at.elapsed());
    assert_eq!(
        status.code(),
        Some(0),
        "in order, and not by the time limit"
    );
    assert_eq!(server.pressed_keys(), [0; 0]);
}

#[test]
fn a_transcript_on_a_full_disk_is_reported_and_the_desktop_continues() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("h");
    let (_folder, glove, source) = Glove::in_new_folder(press.clear());
    let full = std::fs::File::options().write(true).open("/dev/full");
    let arguments = [
        "run",
        "--armed",
        "--output",
        "transcript,desktop",
        "--source",
        &source,
    ];
    let mut command = ademan(arguments);
    command
        .args(["--control", "off"])
        .env("DISPLAY", server.display())
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("XDG_RUNTIME_DIR")
        .stdin(Stdio::null())
        .stdout(full.expect("Linux has /dev/full"))
        .stderr(Stdio::piped());
    let mut program = Process::start(&mut command).expect("the program starts");
    let messages = collect_lines(program.0.stderr.take().expect("it is piped"));
    let is_reported = || {
        let messages = messages.lock().unwrap();
        messages.iter().any(|line| {
            line.contains("No space left") && line.contains("the session continues without it")
        })
    };
    // The first press fills the disk, the others come after the report.
    for _ in 0..3 {
        let is_pressed = wait_for(|| {
            glove.play(&press.approach);
            wait_at_most(Duration::from_secs(5), || {
                server.pressed_keys() == [x11_code("H")]
            })
        });
        assert!(is_pressed, "{messages:?}");
        glove.play(&press.lift);
        assert!(server.wait_for_keys(&[]), "{messages:?}");
        assert!(wait_for(is_reported), "{messages:?}");
    }
    assert!(program.0.try_wait().expect("a child process").is_none());
    signal("INT", program.0.id());
    assert_eq!(program.wait_for_exit().code(), Some(1));
}
