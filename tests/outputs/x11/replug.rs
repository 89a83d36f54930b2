//! A glove that is disconnected while a key is pressed, and connected again.

use std::thread;
use std::time::{Duration, Instant};

use super::{hold, wait_for_release};
use crate::support::glove::Glove;
use crate::support::key_log::KeyLog;
use crate::support::press::{Press, x11_code};
use crate::support::program::Program;
use crate::support::x11::XServer;

/// Time for which the hand must be clear of all keys, less the period of one packet.
const NEUTRAL: Duration = Duration::from_millis(300 - 6);

#[test]
fn after_a_reconnection_a_finger_on_a_key_presses_nothing_until_the_hand_is_clear_of_all_keys() {
    let Some(server) = XServer::start() else {
        return;
    };
    let press = Press::for_text("h");
    let folder = tempfile::tempdir().expect("a folder");
    let port = folder.path().join("glove");
    let source = format!("serial:{}", port.display());
    let mut glove = Glove::plug_in(&port, press.clear());
    let arguments = ["run", "--output", "desktop", "--source", &source];
    let program = Program::start(&server, arguments);
    program.wait_for_line("armed", 1);
    hold(&server, &program, &glove, &press, &[x11_code("H")]);

    let start = Instant::now();
    glove.unplug();
    wait_for_release(&server, start, "unplugged");
    let log = KeyLog::start(&server);
    let replugged = Glove::plug_in(&port, press.pressed());
    program.wait_for_line("reconnected to", 1);
    thread::sleep(Duration::from_secs(1));
    assert_eq!(log.presses_after(0), 0, "{:?}", log.events());

    let times_armed = program.count_lines("armed");
    let lifted_at = Instant::now();
    replugged.play(&[press.clear()]);
    program.wait_for_line("armed", times_armed + 1);
    let took = lifted_at.elapsed();
    println!("off all keys: armed after {took:.1?}");
    assert!(took >= NEUTRAL, "{took:?}");
    hold(&server, &program, &replugged, &press, &[x11_code("H")]);
    replugged.play(&press.lift);
    assert!(server.wait_for_keys(&[]));
}
