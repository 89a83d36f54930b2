//! Motion capture files: the poses of a hand are exported, typed, recorded and replayed.

use std::path::Path;
use std::process::{Command, Stdio};

use ademan::capture::bvh::{Bvh, HandJoints, PositionChannels};
use ademan::hand::{Joint, Side};

use crate::body_landmarks::two_hands;
use crate::support::process::Process;
use crate::support::x11::wait_for;
use crate::text_line::{assert_typed_and_replayed, pressed_keys};
use crate::{Ended, ademan, file, run, run_to_end, text};

const KEYS: [&str; 4] = ["H", "O", "L", "A"];

#[test]
fn an_exported_hand_is_typed_recorded_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let exported = folder.path().join("hand.bvh");
    let exported = text(&exported);
    let export = ["export", exported, "--source", "typist:hola", "--rate-hz"];
    let export = run(export.into_iter().chain(["174.5454545"])).done();
    export.reported("frames written to");

    let source = format!("file:{exported}?protocol=bvh");
    assert_typed_and_replayed(&["--source", &source], &KEYS);
}

#[test]
fn both_arms_of_body_landmarks_are_exported_below_the_hips_without_a_folded_finger() {
    let folder = tempfile::tempdir().unwrap();
    let setup = two_hands(&folder);
    let export = |name: &str, options: &[&str]| {
        let path = folder.path().join(name);
        let arguments = ["export", text(&path), "--setup", &setup].into_iter();
        run(arguments.chain(options.iter().copied())).done();
        let bvh = Bvh::parse(&std::fs::read(&path).unwrap());
        bvh.unwrap_or_else(|error| panic!("{error}"))
    };
    let both = export("both.bvh", &["--order", "yxz"]);
    let skeleton = &both.motion().skeleton;
    assert_eq!(skeleton.nodes()[0].name.as_deref(), Some("Hips"));
    for side in [Side::Left, Side::Right] {
        let joints = HandJoints::find(skeleton, side).unwrap();
        assert_eq!(joints.node(Joint::IndexPhalanxIntermediate), None, "{side}");
        let [knuckle, tip] = [Joint::IndexPhalanxProximal, Joint::IndexTip];
        let [knuckle, tip] = [knuckle, tip].map(|joint| joints.node(joint).expect("seen"));
        for frame in 0..both.motion().frame_count {
            let positions = both.positions(frame, PositionChannels::Add);
            assert!(
                positions[knuckle].distance(positions[tip]) < 1e-3,
                "{side} {frame}"
            );
        }
    }
    let left = export("left.bvh", &["--hand", "left"]);
    assert!(HandJoints::find(&left.motion().skeleton, Side::Left).is_ok());
    assert!(HandJoints::find(&left.motion().skeleton, Side::Right).is_err());
    let path = folder.path().join("none.bvh");
    let ended = run(["export", text(&path), "--setup", &setup, "--order", "zxz"]).exited(2);
    ended.reported("three different axes");
}

#[test]
fn an_existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(&folder, "hand.bvh", "mine");
    let ended = run(["export", &path, "--source", "typist:hi"]).exited(2);
    ended.reported("the file exists");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn an_export_without_a_pose_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    // Nothing listens on its port once it is dropped.
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    drop(listener);
    let source = format!("tcp:127.0.0.1:{port}");
    let refused = run(["export", text(&path), "--source", &source]);
    assert_ne!(refused.code, Some(0));
    assert!(!path.exists(), "{}", refused.err);
    let left = ["--hand", "left", "--source", "typist:hi"];
    let absent = run(["export", text(&path)].into_iter().chain(left)).exited(1);
    absent.reported("hand.bvh is not written");
    assert!(!path.exists());
    run(["export", text(&path), "--source", "typist:hi"]).done();
    assert!(frames(&path) > 0);
}

#[test]
#[cfg(unix)]
fn an_export_that_fills_the_disk_names_its_file_which_opens() {
    let folder = tempfile::tempdir().unwrap();
    // A file may have 400 blocks, as on a full disk; then less than the skeleton.
    for (blocks, is_kept) in [(400, true), (1, false)] {
        let path = folder.path().join(format!("{blocks}.bvh"));
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let mut shell = Command::new("sh");
        shell
            .args(["-c", &script, env!("CARGO_BIN_EXE_ademan"), "export"])
            .args([text(&path), "--source", "typist:hola hola hola hola"])
            .stdin(Stdio::null());
        let ended = run_to_end(&mut shell).exited(1);
        ended.reported(&format!("cannot write {}: ", text(&path)));
        ended.reported("File too large");
        assert_eq!(path.exists(), is_kept);
        if is_kept {
            assert!(frames(&path) >= 100);
        }
    }
}

#[test]
fn a_cut_file_is_refused_with_and_without_a_line_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    run(["export", text(&path), "--source", "typist:hi"]).done();
    let whole = std::fs::read_to_string(&path).unwrap();
    let (head, _) = whole.trim_end().rsplit_once('\n').unwrap();
    for (name, end) in [("line.bvh", "\n"), ("number.bvh", "")] {
        let cut = file(&folder, name, format!("{head}{end}"));
        let source = format!("file:{cut}?protocol=bvh");
        let ended = run(["trace", "readings", "--source", &source]);
        assert_eq!(ended.code, Some(3), "{name}: {}", ended.err);
        let reason = "the text ends after";
        assert!(ended.err.contains(reason), "{name}: {}", ended.err);
    }
}

#[test]
fn a_damaged_file_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = file(
        &folder,
        "bad.bvh",
        "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0\n}\n",
    );
    let source = format!("file:{path}?protocol=bvh");
    let ended = run(["run", "--source", &source, "--output", "transcript"]);
    assert_ne!(ended.code, Some(0), "{}", ended.err);
    ended.reported("line 5: an offset is three finite numbers");
}

/// Returns the number of frames of a file, which has to be a whole one.
fn frames(path: &Path) -> u64 {
    let bytes = std::fs::read(path).expect("a file");
    let bvh = Bvh::parse(&bytes).unwrap_or_else(|error| panic!("{error}"));
    bvh.motion().frame_count
}

#[test]
fn a_run_is_recorded_as_it_types_and_the_file_is_typed_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    let arguments = ["run", "--source", "typist:hola", "--record-bvh"];
    let recorded = run(arguments.into_iter().chain([text(&path)])).done();
    assert_eq!(pressed_keys(&recorded.out), KEYS, "{}", recorded.err);
    assert!(frames(&path) > 100);
    let source = format!("file:{}?protocol=bvh", text(&path));
    let typed = run(["run", "--source", &source, "--output", "transcript"]).done();
    assert_eq!(pressed_keys(&typed.out), KEYS, "{}", typed.err);
    let again = run(arguments.into_iter().chain([text(&path)])).exited(2);
    again.reported("the file exists");
}

#[test]
#[cfg(unix)]
fn a_killed_run_leaves_a_whole_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hand.bvh");
    let source = format!("typist:{}", "hola ".repeat(20));
    let arguments = [
        "run",
        "--control",
        "off",
        "--source",
        &source,
        "--record-bvh",
    ];
    let mut command = ademan(arguments.into_iter().chain([text(&path)]));
    command.stdout(Stdio::null()).stderr(Stdio::null());
    let mut program = Process::start(&mut command).unwrap();
    let length = || path.metadata().map_or(0, |metadata| metadata.len());
    // The skeleton, then a block of frames.
    assert!(wait_for(|| length() >= 50_000), "{} bytes", length());
    program.0.kill().unwrap();
    program.0.wait().unwrap();
    assert!(frames(&path) >= 100);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_leaves_a_whole_file_and_the_typing_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let (disk, kept) = (folder.path().join("disk"), folder.path().join("kept.bvh"));
    std::fs::create_dir(&disk).unwrap();
    // A file system that only the program sees; the file is copied out of it.
    let script = "mount -t tmpfs -o size=256k none $1 || exit 77; \"$0\" run --allow-root --control off --source \
        'typist:hola hola hola hola' --record-bvh $1/hand.bvh; code=$?; cp $1/hand.bvh $2; exit $code";
    let mut command = Command::new("unshare");
    command
        .args(["--mount", "sh", "-c", script, env!("CARGO_BIN_EXE_ademan")])
        .args([&disk, &kept])
        .stdin(Stdio::null());
    let ended = match command.output() {
        Ok(output) => Ended::from(output),
        Err(error) => {
            println!("SKIPPED: no file system of its own: {error}");
            return;
        }
    };
    if ended.code == Some(77) || ended.err.starts_with("unshare:") {
        println!("SKIPPED: no file system of its own: {}", ended.err);
        return;
    }
    let ended = ended.exited(1);
    ended.reported("No space left");
    assert_eq!(pressed_keys(&ended.out).len(), 19, "{}", ended.out);
    let count = frames(&kept);
    println!("{count} frames fit");
    assert!(count >= 100 && count % 100 < 3, "whole blocks: {count}");
}
