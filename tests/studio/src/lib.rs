//! Tests of Studio in a window without a display: the program itself on a real session with a simulated hand.
//!
//! [`window`] opens Studio and operates it through the accessibility tree, as a screen reader does. [`picture`] writes what
//! it shows to `target/studio`, and compares it with the reviewed pictures in `docs/pictures`. After a change that is meant to be
//! seen, `UPDATE_SNAPSHOTS=1 cargo test -p ademan-studio-tests` replaces them; look at each before a commit.

#![cfg(test)]

mod accessibility;
mod attached;
mod calibration;
mod changing_window;
mod devices;
mod editor;
mod editor_faults;
mod fingertip;
mod first_start;
mod hand;
mod headset;
mod keyboard;
mod lab;
mod layouts;
mod open_layout;
mod phone_pad;
mod picture;
mod plan;
mod played_hand;
mod posing_hand;
mod recording;
mod scope;
mod sensors;
mod settings;
mod space;
mod texts;
mod toolbar;
mod window;
