//! Controls other than keys: script in, transcript out. Covers the layout file, the contact stage and the
//! devices.

mod invalid_values;
mod arm_axes;
mod chords;
mod dwell;
mod control_errors;
mod joysticks;
mod knobs;
mod levers;
mod full_event_list;
mod pointer;
mod pointer_clicks;
mod pointer_modes;
mod random_pointer;
mod radial_menus;
mod radios;
mod scroll_rings;
mod shipped;
mod reach;
mod sliders;
mod selection;
mod texts;
mod toggles;
mod touch_surfaces;
mod triggers;
mod valves;
mod xy_pads;
mod hand_gestures;
mod handle_errors;
mod pointer_errors;

use ademan::layout::Layout;

use crate::rig::Rig;

/// Returns the events of a script on one flat board with these fields, such as `toggles: [(…)]`.
fn simulate(controls: &str, script: &str) -> String {
    Rig::on_board(controls).run(script).events()
}

/// Returns the events of a script on one flat board; `fields` are further fields of the layout, such as
/// `triggers: [(…)]`.
fn simulate_layout(controls: &str, fields: &str, script: &str) -> String {
    Rig::with_fields(controls, fields).run(script).events()
}

/// Asserts that a script on one flat board has these events.
#[track_caller]
fn assert_events(controls: &str, script: &str, expected: &str) {
    assert_eq!(simulate(controls, script), expected, "{script}");
}

/// Asserts that a script on one flat board with further fields of the layout has these events.
#[track_caller]
fn assert_layout_events(controls: &str, fields: &str, script: &str, expected: &str) {
    let events = simulate_layout(controls, fields, script);
    assert_eq!(events, expected, "{script}");
}

/// Returns `LINE:COLUMN: message` of the error in a layout.
fn refusal_of(layout: &str) -> String {
    let error = Layout::parse(layout, "t.ron")
        .expect_err(layout)
        .to_string();
    let line = error.lines().next().expect("a line").to_owned();
    line.strip_prefix("t.ron:").expect("the file").to_owned()
}

/// Checks that the fields of each case are refused with its message.
fn check_refusals(cases: &[(&str, &str)], refusal: impl Fn(&str) -> String) {
    for (fields, expected) in cases {
        assert_eq!(refusal(fields), *expected, "{fields}");
    }
}
