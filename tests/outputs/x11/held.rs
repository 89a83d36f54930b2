//! A key that is held for 1.5 s.

use std::time::Duration;

use ademan::output::{Desktop, Router, Sink, open};
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::Setup;

use super::repeat;
use crate::support::hand::HoldingHand;
use crate::support::press::Press;
use crate::support::x11::{TerminalWindow, XServer};

#[test]
fn a_held_key_is_pressed_once_and_repeated_by_the_receiver() {
    repeat(is_pressed_once);
}

/// Checks what a terminal makes of a held key. Returns `false` if a busy machine has dropped the press.
fn is_pressed_once() -> bool {
    let Some(server) = XServer::start() else {
        return true;
    };
    let Some(terminal) = TerminalWindow::start(&server) else {
        return true;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("transcript");
    let setup = Setup {
        // A busy machine must not cause a stall.
        stall_timeout_ms: 10_000,
        ..Setup::default()
    };
    let loaded = setup.load_files().expect("the default setup");
    let needs = loaded.required_capabilities();
    let mut sink = Router::new(vec![
        Box::new(Desktop::open(Some(server.display()), &needs).expect("the server runs")),
        open(&format!("transcript:{}", path.display()), &needs).expect("a new file"),
    ]);
    let hand = HoldingHand::new(&Press::for_text("h"), Duration::from_millis(1500));
    let mut pipeline = loaded.pipeline();
    run_pipeline(
        hand,
        &mut pipeline,
        &mut sink,
        &CommandReceiver::disconnected(),
        &mut |_| {},
    )
    .expect("the source ends");
    assert_eq!(server.pressed_keys(), [0; 0]);
    if sink.dropped_presses() > 0 {
        return false;
    }

    let transcript = std::fs::read_to_string(&path).expect("the transcript");
    let events: Vec<_> = transcript.lines().map(|line| &line[13..]).collect();
    assert_eq!(events, ["down H", "up   H"]);
    let typed = terminal.typed("h");
    println!(
        "held for 1.5 s: the terminal made {} characters of it",
        typed.len()
    );
    assert!(
        !typed.is_empty() && typed.chars().all(|character| character == 'h'),
        "{typed:?}"
    );
    true
}
