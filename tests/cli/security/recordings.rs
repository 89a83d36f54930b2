//! Recordings of strangers: their readings are played, and nothing else in them has an effect.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use ademan::capture::recording::RecordedSetup;
use ademan::layout::Layout;
use ademan::output;
use ademan::recorder::Recorder;
use ademan::session::{CommandReceiver, run_pipeline};
use ademan::setup::Setup;
use tempfile::TempDir;

use crate::support::binary::ademan;
use crate::support::press::x11_code;
use crate::support::process::Process;
use crate::support::program::Program;
use crate::support::x11::XServer;
use crate::{Ended, text};

const SYSTEM_CHORDS: &str = include_str!("../../scenarios/system-chords.ron");

/// Keys that move the board, save it to its file and read the file again.
const SAVING: &str = r#"Layout(name: "a", boards: [(
    pose: (anchor: elbow, bearing_deg: 35, forward_mm: 300, height_mm: -45),
    size_mm: Box(22, 20),
    keys: [
        (action: Command("nudge 0 0 5"), name: "nudge", at_mm: (-48, 24)),
        (action: Command("save"), name: "save", at_mm: (0, 24)),
        (action: Command("reload"), name: "reload", at_mm: (-24, -24)),
        (code: "A", at_mm: (-24, 0)),
    ],
)])"#;

/// Records a script on a layout, with setup texts of a stranger.
fn record(folder: &TempDir, layout: &str, script: &str, recorded: &RecordedSetup) -> PathBuf {
    let mut setup = Setup::default().load_files().expect("the default setup");
    setup.layout = Layout::parse(layout, "a.ron").expect("a valid layout");
    let source = format!("script:{script}").parse().expect("a source");
    let hand = setup.open_source(&source).expect("the hand can do it");
    let path = folder.path().join("stranger.mcap");
    let _ = fs::remove_file(&path);
    let mut recorder = Recorder::create(&path, recorded).expect("a file");
    let mut sink = output::open("none", &setup.required_capabilities()).expect("no output");
    run_pipeline(
        hand,
        &mut setup.pipeline(),
        &mut *sink,
        &CommandReceiver::disconnected(),
        &mut |step| {
            recorder
                .write(&step.to_snapshot())
                .expect("room on the disk")
        },
    )
    .expect("the hand ends");
    recorder.finish().expect("room on the disk");
    path
}

/// Runs `ademan replay`. Panics if it hangs.
fn replay(path: &Path, arguments: &[&str]) -> Ended {
    let folder = path.parent().expect("a folder");
    let [out, err] = ["out", "err"].map(|name| folder.join(name));
    let mut command = ademan(["replay", text(path)]);
    command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(fs::File::create(&out).expect("a file"))
        .stderr(fs::File::create(&err).expect("a file"));
    let mut process = Process::start(&mut command).expect("it starts");
    let code = process.wait_for_exit().code();
    let [out, err] = [out, err].map(|file| fs::read_to_string(file).expect("UTF-8"));
    Ended { code, out, err }
}

#[test]
fn no_file_is_opened_because_a_recording_names_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let secret = folder.path().join("secret");
    fs::write(&secret, "canary\n").expect("a file");
    let fifo = folder.path().join("fifo");
    let made = Command::new("mkfifo").arg(&fifo).status();
    assert!(made.expect("mkfifo is installed").success());
    let names = ["/etc/passwd", text(&secret), text(&fifo)];
    for name in names {
        for (kind, setup) in [
            ("layout", format!("Setup(layout: {name:?})")),
            ("glove", format!("Setup(glove: {name:?})")),
            ("arm", format!("Setup(arm: Model({name:?}))")),
            (
                "layout:b",
                format!("Setup(profiles: [(name: \"b\", layout: {name:?})])"),
            ),
        ] {
            let recorded = RecordedSetup::default().with("setup", "setup", &setup);
            let path = record(&folder, SYSTEM_CHORDS, "tap Delete", &recorded);
            for output in ["transcript", "desktop"] {
                let Ended { code, out, err } = replay(&path, &["--output", output]);
                assert_eq!(code, Some(2), "{setup}: {err}");
                let expected = format!("the recording names this {kind} but does not contain it");
                assert!(err.contains(&expected), "{setup}: {err}");
                assert!(!err.contains("root:") && !err.contains("canary"), "{err}");
                assert_eq!(out, "");
            }
        }
    }
}

#[test]
fn a_replay_neither_writes_nor_reads_the_layout_file_that_a_recording_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("victim.ron");
    fs::write(&file, SAVING).expect("a file");
    let recorded = RecordedSetup::default()
        .with("setup", "setup", "Setup(layout: \"victim.ron\")")
        .with("layout", text(&file), SAVING);
    let script = "tap nudge; tap save; tap reload; tap A";
    let path = record(&folder, SAVING, script, &recorded);
    let ended = replay(&path, &[]).done();
    ended.printed("down A");
    assert!(!ended.err.contains("active from now on"), "{}", ended.err);
    let after = fs::read_to_string(&file).expect("the file");
    assert_eq!(after, SAVING, "the recording has changed a file");
}

/// A recorded setup that permits everything.
fn greedy(layout: &str) -> RecordedSetup {
    RecordedSetup::default()
        .with(
            "setup",
            "setup",
            "Setup(layout: \"a\", allow_system_keys: true, max_presses_per_second: 1000, stall_timeout_ms: 10000, \
             output: \"desktop\")",
        )
        .with("layout", "a", layout)
}

#[test]
fn a_layout_with_system_keys_is_refused_for_an_output_that_types() {
    let folder = tempfile::tempdir().expect("a folder");
    let layout = SAVING.replace("code: \"A\"", "code: \"MetaLeft\"");
    let path = record(&folder, &layout, "tap MetaLeft", &greedy(&layout));
    let transcript = replay(&path, &["--output", "transcript"]).done();
    transcript.printed("down MetaLeft");
    let desktop = replay(&path, &["--output", "desktop"]).exited(2);
    desktop.reported("the key `MetaLeft` acts on the system");
}

#[test]
fn system_chords_of_a_replay_need_the_permission_of_the_person_who_replays_it() {
    let Some(server) = XServer::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let script = "tap Delete; tap Control; tap Alt; wait 60000";
    let path = record(&folder, SYSTEM_CHORDS, script, &greedy(SYSTEM_CHORDS));
    let own = folder.path().join("own.ron");
    fs::write(&own, "Setup(allow_system_keys: true)").expect("a file");
    let [delete, control, alt] = ["Delete", "ControlLeft", "AltLeft"].map(x11_code);
    for (arguments, keys, ignored) in [
        (
            &[][..],
            &[control, alt][..],
            "ignored in the setup of the recording: `stall_timeout_ms`, `max_presses_per_second`, `allow_system_keys`; ",
        ),
        (
            &["--setup", text(&own)],
            &[control, alt, delete],
            "ignored in the setup of the recording: `stall_timeout_ms`, `max_presses_per_second`; ",
        ),
    ] {
        let replay = ["replay", text(&path), "--output", "desktop"];
        let start = || Program::start(&server, [&replay, arguments].concat());
        let are_held = |program: &Program| {
            let are_held = server.wait_for_keys(keys);
            println!("{:?}: {:#?}", server.pressed_keys(), program.stderr_lines());
            are_held
        };
        // A busy machine drops a press that comes late.
        let started = std::iter::repeat_with(start).take(3).find(are_held);
        let mut program = started.expect("a replay that holds its keys");
        assert_eq!(
            program.count_lines(ignored),
            1,
            "{:?}",
            program.stderr_lines()
        );
        program.signal(&["TERM"]);
        program.wait_for_exit();
        assert_eq!(server.pressed_keys(), [0; 0]);
    }
}
