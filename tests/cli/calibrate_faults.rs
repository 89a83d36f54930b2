//! `ademan calibrate` on full disks, in folders without access, and with a closed or full standard output.

use std::fs;

use ademan::document::Document;
use ademan::layout::Glove;
use tempfile::TempDir;

use crate::calibrate::{calibrate, folder, read};
use crate::{Ended, ademan, run_to_end};

/// Runs `ademan calibrate` in a folder after the commands `before` of a shell.
fn calibrate_after(before: &str, folder: &TempDir, arguments: &[&str]) -> Ended {
    let program = ademan(["calibrate"]);
    let mut shell = std::process::Command::new("sh");
    shell
        .args(["-c", &format!("{before} exec \"$0\" \"$@\"")])
        .arg(program.get_program())
        .args(program.get_args())
        .args(arguments)
        .envs(
            program
                .get_envs()
                .filter_map(|(name, value)| Some((name, value?))),
        )
        .stdin(std::process::Stdio::null())
        .current_dir(folder.path());
    run_to_end(&mut shell)
}

/// The start of a program that can write no file of more than a kilobyte, as on a full disk.
const FULL_DISK: &str = "trap '' XFSZ; ulimit -f 1;";

#[test]
fn a_full_disk_leaves_the_glove_file_and_its_backup_as_they_were() {
    let folder = folder();
    calibrate(&folder, &["--demo", "--out", "mine"]).done();
    fs::write(folder.path().join("mine.ron.bak"), "the first one").expect("a file");
    let before = read(&folder, "mine.ron");
    for _ in 0..2 {
        let again = ["--from", "mine.mcap", "--out", "mine", "--force"];
        let ended = calibrate_after(FULL_DISK, &folder, &again).exited(2);
        ended.reported("cannot write mine.ron: ");
        assert_eq!(read(&folder, "mine.ron"), before);
        assert_eq!(read(&folder, "mine.ron.bak"), "the first one");
    }
    let new = ["--from", "mine.mcap", "--out", "new"];
    calibrate_after(FULL_DISK, &folder, &new).exited(2);
    let left = fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(left, 3, "the glove file, its backup and the readings");
}

#[test]
fn a_folder_that_is_missing_or_refuses_files_is_reported_before_the_session() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").expect("a file");
    fs::create_dir(folder.path().join("taken.ron")).expect("a folder");
    let mut places = vec![
        ("nodir/mine", "there is no folder nodir; create it"),
        ("file/mine", "cannot write file/mine.ron: "),
        ("taken", "this is a directory"),
    ];
    let read_only = folder.path().join("read-only");
    fs::create_dir(&read_only).expect("a folder");
    let mut permissions = fs::metadata(&read_only).expect("a folder").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&read_only, permissions).expect("a folder of this user");
    // Root may write there.
    if fs::write(read_only.join("file"), "").is_err() {
        places.push(("read-only/mine", "cannot write read-only/mine.ron: "));
    }
    for (out, reason) in places {
        let ended = calibrate(&folder, &["--demo", "--force", "--out", out]).exited(2);
        ended.reported(reason);
        assert!(!ended.out.contains("pose 1"), "{out}: {}", ended.out);
    }
}

#[test]
fn the_error_of_the_glove_file_is_reported_before_the_error_of_its_recording() {
    let folder = folder();
    let arguments = ["--demo", "--out", "mine"];
    let ended = calibrate_after(FULL_DISK, &folder, &arguments).exited(2);
    ended.reported("cannot write mine.ron: ");
}

#[test]
fn a_full_or_closed_standard_output_does_not_lose_the_glove_file() {
    let folder = folder();
    let parse = |name: &str| {
        let name = format!("{name}.ron");
        Glove::parse(&Document::new(&name, read(&folder, &name))).expect("a glove");
    };
    for (name, arguments) in [
        ("lines", &["--demo"][..]),
        ("table", &["--from", "lines.mcap"]),
        ("found", &["--discover", "--demo"]),
    ] {
        println!("{name}");
        let full = [arguments, &["--out", name]].concat();
        let ended = calibrate_after("exec >/dev/full;", &folder, &full).exited(1);
        ended.reported("No space left");
        assert!(!ended.err.contains("panicked"), "{name}: {}", ended.err);
        parse(name);

        let closed = format!("closed-{name}");
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = ademan(["calibrate"]);
        command
            .args(arguments)
            .args(["--out", &closed])
            .current_dir(folder.path())
            .stdout(writer);
        let closed_end = run_to_end(&mut command).done();
        let errors = closed_end.err;
        assert!(!errors.contains("panicked"), "{name}: {errors}");
        parse(&closed);
    }
}
