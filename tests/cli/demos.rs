//! The demo of every shipped layout.

use std::path::Path;
use std::thread;

use ademan::document::shipped_layouts;

use super::run;

/// Attempts for a demo. A machine that is busy for a second stalls the session, which releases everything; the demos of all layouts
/// at once keep it busy.
const ATTEMPTS: usize = 6;

/// Plays the demo of a layout to its end and returns what it printed.
fn play(layout: &str) -> String {
    let mut arguments = vec!["demo", "--layout", layout];
    if !has_script(layout) {
        // The default text takes twenty seconds.
        arguments.extend(["--text", if layout == "numpad" { "12" } else { "Hi" }]);
    }
    for _ in 1..ATTEMPTS {
        let ended = run(&arguments);
        // A demo with a script has no text to miss, and only warns.
        if ended.code == Some(0) && !ended.err.contains("keys may be missing") {
            return ended.out;
        }
    }
    run(&arguments).done().out
}

fn has_script(layout: &str) -> bool {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scripts");
    Path::new(folder).join(format!("{layout}.txt")).exists()
}

#[test]
fn every_shipped_layout_has_a_demo() {
    let layouts: Vec<&str> = shipped_layouts().collect();
    let printed: Vec<String> = thread::scope(|scope| {
        let demos: Vec<_> = layouts
            .iter()
            .map(|layout| scope.spawn(|| play(layout)))
            .collect();
        demos.into_iter().map(|demo| demo.join().unwrap()).collect()
    });
    for (layout, output) in layouts.iter().zip(printed) {
        let expected = if has_script(layout) {
            "played "
        } else {
            "0.00 % character error rate"
        };
        assert!(output.contains(expected), "{layout}: {output}");
        assert!(!output.contains("played     0 events"), "{layout}");
    }
}
