//! An output, opened and used for a moment so that nothing comes of it.

use std::thread;
use std::time::Duration;

use super::probe;
use crate::device::{Capabilities, Capability, EventKind, KeyCode, OutputEvent};
use crate::names::named_enum;
use crate::output::{self, OutputError, Sink};
use crate::time::Timestamp;

/// How long an output is open for a trial, in steps of [`STEP`].
const STEPS: usize = 10;
const STEP: Duration = Duration::from_millis(100);

/// What the keyboard has; it is not pressed.
const KEY: &str = "Escape";

named_enum! {
    /// An output that can be tried out.
    pub enum OutputTest ("output to try") {
        /// Connects, brings the pointer a pixel to the right and back ten times in a second, and presses nothing.
        Desktop = "desktop",
        /// Makes a keyboard, waits for its node at most a second, presses nothing, and takes it away.
        Uinput = "uinput",
    }
}

/// Opens an output for a second and does something harmless with it: what was seen, or why it does not work.
pub fn test_output(trial: OutputTest) -> Result<String, OutputError> {
    let needs: Capabilities = match trial {
        OutputTest::Desktop => [Capability::RelativeMotion].into_iter().collect(),
        OutputTest::Uinput => KEY
            .parse::<KeyCode>()
            .map(Capability::Key)
            .into_iter()
            .collect(),
    };
    match trial {
        OutputTest::Desktop => move_to_and_fro(&mut *output::open(trial.name(), &needs)?),
        OutputTest::Uinput => wait_for_node(&mut *probe::open_keyboard(&needs)?),
    }
}

fn move_to_and_fro(sink: &mut dyn Sink) -> Result<String, OutputError> {
    let by = |pixels| OutputEvent {
        time: Timestamp(0),
        kind: EventKind::MoveBy(pixels, 0),
    };
    for _ in 0..STEPS {
        sink.send(&[by(1)])?;
        sink.send(&[by(-1)])?;
        thread::sleep(STEP);
    }
    sink.close()?;
    Ok("connected, and the pointer went a pixel to the right and back".into())
}

fn wait_for_node(sink: &mut dyn Sink) -> Result<String, OutputError> {
    let mut came = false;
    for _ in 0..STEPS {
        thread::sleep(STEP);
        came |= probe::has_keyboard();
    }
    sink.close()?;
    match came {
        true => Ok("the kernel made a keyboard, and its node came up in /dev/input".into()),
        false => Err(OutputError::Send {
            output: OutputTest::Uinput.name().into(),
            reason: "the kernel made a keyboard, but no node for it came up in /dev/input: in a container, \
                     programs outside have it all the same"
                .into(),
        }),
    }
}
