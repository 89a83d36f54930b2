//! The check of `ademan doctor --test uinput`.

use std::fs;
use std::path::Path;
use std::thread;
use std::time::Duration;

use super::super::BACKEND;
use super::Uinput;
use crate::output::{OutputError, Sink};
use ademan_core::device::{Capabilities, Capability, KeyCode};

/// The name of the keyboard.
const NAME: &str = "Ademan doctor";

/// A key of the keyboard; it is not pressed.
const KEY: &str = "Escape";

/// Number of looks for the device node, and the delay before each.
const STEPS: usize = 10;
const DELAY: Duration = Duration::from_millis(100);

/// Creates a keyboard, waits at most 1 s for its node in `/dev/input`, presses nothing, and removes it.
pub fn check() -> Result<String, OutputError> {
    let key = KEY.parse::<KeyCode>().map(Capability::Key);
    let required = Capabilities::from_iter(key);
    let mut uinput = Uinput::open(NAME, &required)?;
    let mut has_node = false;
    for _ in 0..STEPS {
        thread::sleep(DELAY);
        has_node |= has_keyboard_node();
    }
    uinput.close()?;
    if has_node {
        Ok("the kernel created a keyboard, and its node appeared in /dev/input".into())
    } else {
        Err(OutputError::send(
            BACKEND.name,
            "the kernel created a keyboard, but its node did not appear in /dev/input: in a container, \
         programs outside of it can use it nevertheless",
        ))
    }
}

/// Returns `true` if the keyboard exists and has a device node.
fn has_keyboard_node() -> bool {
    let name = format!("{NAME} keyboard");
    let Ok(entries) = fs::read_dir("/sys/class/input") else {
        return false;
    };
    entries.flatten().any(|entry| {
        let has_name = fs::read_to_string(entry.path().join("device/name"))
            .is_ok_and(|found| found.trim_end() == name);
        has_name && Path::new("/dev/input").join(entry.file_name()).exists()
    })
}
