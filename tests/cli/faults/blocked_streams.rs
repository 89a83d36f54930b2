//! Standard output and standard error that are full, and that nobody reads.

use std::thread;
use std::time::{Duration, Instant};

use ademan::session::control_socket::Client;

use super::line::PseudoTerminal;
use crate::support::binary::ademan;
use crate::support::full_pipe::full_pipe;
use crate::support::press::Press;
use crate::support::process::{Process, signal};
use crate::support::run::TIMEOUT;

#[test]
fn a_run_with_full_streams_executes_commands_and_ends_in_order_on_one_signal() {
    let mut line = PseudoTerminal::open();
    let press = Press::for_text("h");
    let socket = line.folder.path().join("control.sock");
    let ((_out, stdout), (_err, stderr)) = (full_pipe(), full_pipe());
    let (source, path) = (line.source(), socket.to_str().expect("a plain path"));
    let mut command = ademan(["run", "--armed", "--source", &source, "--control", path]);
    command.stdout(stdout).stderr(stderr);
    let mut program = Process::start(&mut command).expect("the program starts");
    let mut client = connect(&socket);
    // A transcript of some presses, and of a device that restarts.
    for _ in 0..3 {
        line.play(&press.approach);
        line.play(&press.lift);
    }
    line.send(b"\r\nBUFFALO 3.4 (ext) - Bit User Fast Friendly Aid to Logical Operation\r\n");
    line.play(&press.lift);
    let start = Instant::now();
    let reply = client.request(r#"{"command":"pause"}"#);
    println!("paused after {:.1?}", start.elapsed());
    assert_eq!(reply.expect("a reply"), r#"{"ok":true}"#);
    let state = client.request(r#"{"command":"state"}"#).expect("a reply");
    assert!(state.contains(r#""paused":true"#), "{state}");

    let killed_at = Instant::now();
    signal("TERM", program.0.id());
    let code = program.wait_for_exit().code();
    println!("ended after {:.1?}", killed_at.elapsed());
    assert_eq!(code, Some(0), "in order, and not by the time limit");
}

/// Waits until the session accepts commands.
fn connect(socket: &std::path::Path) -> Client {
    let start = Instant::now();
    while start.elapsed() < TIMEOUT {
        if let Ok(mut client) = Client::connect(socket)
            && let Ok(reply) = client.request(r#"{"command":"state"}"#)
            && reply.contains(r#""ok":true"#)
        {
            return client;
        }
        thread::sleep(Duration::from_millis(10));
    }
    panic!("the session does not start");
}
