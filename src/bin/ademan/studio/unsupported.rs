//! `ademan studio` in a program that is built without its window.

use super::Args;
use crate::failure::Failure;

pub fn open(args: Args) -> Result<(), Failure> {
    // The fields are read where there is a window.
    let Args {
        setup: _,
        source: _,
        role: _,
        glove: _,
        person: _,
        layout: _,
        recording: _,
        attach: _,
        overlay: _,
        place: _,
        root: _,
    } = args;
    Err(Failure::wrong_use(
        "this program is built without Studio; build it with `cargo install --path . --features studio`, or watch the session with `ademan run --view board`",
    ))
}
