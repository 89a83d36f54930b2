//! The check of `ademan doctor --test desktop`.

use std::thread;
use std::time::Duration;

use super::Desktop;
use crate::output::{OutputError, Sink};
use ademan_core::device::{Capabilities, Capability, EventKind, OutputEvent};
use ademan_core::time::Timestamp;

/// Number of pointer motions, and the delay after each.
const STEPS: usize = 10;
const DELAY: Duration = Duration::from_millis(100);

/// Connects, moves the pointer by one pixel to the right and back ten times within 1 s, and presses nothing.
pub fn run() -> Result<String, OutputError> {
    let required = Capabilities::from_iter([Capability::RelativeMotion]);
    let mut desktop = Desktop::open(None, &required)?;
    let motion = |pixels| OutputEvent {
        time: Timestamp(0),
        kind: EventKind::MoveBy(pixels, 0),
    };
    for _ in 0..STEPS {
        desktop.send(&[motion(1)])?;
        desktop.send(&[motion(-1)])?;
        thread::sleep(DELAY);
    }
    desktop.close()?;
    Ok("connected, and the pointer moved by one pixel to the right and back".into())
}
