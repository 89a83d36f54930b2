//! `ademan calibrate` on full disks, in folders without access, and with a closed or full standard output.

use std::fs;

use ademan::document::Document;
use ademan::layout::Glove;
use tempfile::TempDir;

use crate::ademan;
use crate::calibrate::{calibrate, ended, folder, read};

/// Runs `ademan calibrate` in a folder after the commands `before` of a shell.
fn calibrate_after(before: &str, folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
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
        .stdin(std::process::Stdio::null());
    ended(folder, &mut shell)
}

/// The start of a program that can write no file of more than a kilobyte, as on a full disk.
const FULL_DISK: &str = "trap '' XFSZ; ulimit -f 1;";

#[test]
fn a_full_disk_leaves_the_glove_file_and_its_backup_as_they_were() {
    let folder = folder();
    assert_eq!(calibrate(&folder, &["--demo", "--out", "mine"]).0, 0);
    fs::write(folder.path().join("mine.ron.bak"), "the first one").expect("a file");
    let before = read(&folder, "mine.ron");
    for _ in 0..2 {
        let again = ["--from", "mine.mcap", "--out", "mine", "--force"];
        let (code, out, errors) = calibrate_after(FULL_DISK, &folder, &again);
        assert_eq!(code, 2, "{out}{errors}");
        assert!(errors.contains("cannot write mine.ron: "), "{errors}");
        assert_eq!(read(&folder, "mine.ron"), before);
        assert_eq!(read(&folder, "mine.ron.bak"), "the first one");
    }
    let new = ["--from", "mine.mcap", "--out", "new"];
    let (code, out, errors) = calibrate_after(FULL_DISK, &folder, &new);
    assert_eq!(code, 2, "{out}{errors}");
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
        let (code, text, errors) = calibrate(&folder, &["--demo", "--force", "--out", out]);
        assert_eq!(code, 2, "{out}: {text}{errors}");
        assert!(errors.contains(reason), "{out}: {errors}");
        assert!(!text.contains("pose 1"), "{out}: {text}");
    }
}

#[test]
fn the_error_of_the_glove_file_is_reported_before_the_error_of_its_recording() {
    let folder = folder();
    let arguments = ["--demo", "--out", "mine"];
    let (code, out, errors) = calibrate_after(FULL_DISK, &folder, &arguments);
    assert_eq!(code, 2, "{out}{errors}");
    assert!(errors.contains("cannot write mine.ron: "), "{errors}");
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
        let full = [arguments, &["--out", name]].concat();
        let (code, _, errors) = calibrate_after("exec >/dev/full;", &folder, &full);
        assert_eq!(code, 1, "{name}: {errors}");
        assert!(errors.contains("No space left"), "{name}: {errors}");
        assert!(!errors.contains("panicked"), "{name}: {errors}");
        parse(name);

        let closed = format!("closed-{name}");
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = ademan(["calibrate"]);
        command
            .args(arguments)
            .args(["--out", &closed])
            .stdout(writer);
        let (closed_code, _, closed_errors) = ended(&folder, &mut command);
        assert_eq!(closed_code, 0, "{name}: {closed_errors}");
        assert!(!closed_errors.contains("panicked"), "{closed_errors}");
        parse(&closed);
    }
}
