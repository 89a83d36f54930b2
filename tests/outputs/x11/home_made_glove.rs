//! A home-made glove of five curls, from its calibration to a text in a terminal.

use std::fs;
use std::thread;
use std::time::Duration;

use ademan::contact::TargetId;
use ademan::files::Load;
use ademan::hand::Finger;
use ademan::layout::Layout;
use ademan::sim::{HandAction, taps_for_text};

use crate::support::binary::ademan;
use crate::support::home_made_glove::{BUILD, Wearer};
use crate::support::program::Program;
use crate::support::x11::{TerminalWindow, XServer};

const TEXT: &str = "Hello, world 42!";

/// A bend of the fingers of a chord, beyond each threshold.
const BENT: f64 = 0.85;

/// Time of a chord, and of the open hand after it.
const HELD: Duration = Duration::from_millis(420);
const OPEN: Duration = Duration::from_millis(380);

/// Attempts: on a machine that is busy for a second a finger of a chord comes late.
const ATTEMPTS: usize = 3;

/// Returns the fingers of each stroke of a text, as a person finds them in the legend of the layout.
fn strokes(text: &str) -> Vec<Vec<Finger>> {
    let layout = Layout::load("chords-bend").expect("a layout");
    let actions = taps_for_text(text, &layout, false);
    let fingers = |action: &HandAction| {
        let targets: Vec<TargetId> = match action {
            HandAction::Chord(targets) => targets.clone(),
            action => action.target().into_iter().collect(),
        };
        let fingers = targets
            .into_iter()
            .filter_map(|target| layout.scene.target(target)?.0.bent_by(target));
        fingers.collect()
    };
    actions
        .expect("the layout types it")
        .iter()
        .map(fingers)
        .collect()
}

#[test]
fn five_curls_are_calibrated_and_type_into_a_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let wearer = Wearer::start(BUILD);
    let source = format!("serial:{}?protocol=lucidgloves", wearer.port());
    let mut command = ademan([
        "calibrate",
        "--countdown",
        "0.5",
        "--out",
        "mine",
        "--source",
        &source,
    ]);
    command.current_dir(folder.path());
    let calibrated = wearer.pose_for(command);
    assert!(calibrated.status.success(), "{calibrated:?}");
    let glove = folder.path().join("mine.ron").display().to_string();
    let setup = folder.path().join("setup.ron");
    // A busy machine must not cause a stall.
    fs::write(&setup, "Setup(stall_timeout_ms: 5000)").expect("a new file");
    let setup = setup.display().to_string();
    let strokes = strokes(TEXT);
    let mut last = (String::new(), Vec::new());
    for _ in 0..ATTEMPTS {
        let Some(server) = XServer::start() else {
            return;
        };
        let Some(terminal) = TerminalWindow::start(&server) else {
            return;
        };
        wearer.bend([0.0; 5]);
        let arguments = [
            "run",
            &setup,
            "--source",
            &source,
            "--glove",
            &glove,
            "--layout",
            "chords-bend",
            "--output",
            "desktop",
        ];
        let mut program = Program::start(&server, arguments);
        program.wait_for_line("armed", 1);
        for stroke in &strokes {
            let mut bends = [0.0; 5];
            for finger in stroke {
                bends[finger.index()] = BENT;
            }
            wearer.bend(bends);
            thread::sleep(HELD);
            wearer.bend([0.0; 5]);
            thread::sleep(OPEN);
        }
        program.signal(&["INT"]);
        assert_eq!(
            program.wait_for_exit().code(),
            Some(0),
            "{:#?}",
            program.stderr_lines()
        );
        assert_eq!(server.pressed_keys(), [0; 0]);
        last = (terminal.typed(TEXT), program.stderr_lines());
        println!("$ ademan {}", arguments.join(" "));
        println!("{}\nin the terminal: {}", last.1.join("\n"), last.0);
        if last.0 == TEXT {
            return;
        }
    }
    panic!("{}: {:#?}", last.0, last.1);
}
