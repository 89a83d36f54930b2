//! Messages that are asked for: `--verbose`, `--quiet`, `--log` and `RUST_LOG`.

use ademan::files::Load;
use std::fs;

use super::{Ended, ademan, run_to_end, text};

fn run_with(log: &str, line: &str) -> Ended {
    let mut command = ademan(line.split(' '));
    run_to_end(command.env("RUST_LOG", log))
}

const RUN: &str = "run --source typist:hi";

#[test]
fn a_quiet_run_prints_errors_only() {
    let loud = super::run(RUN.split(' ')).done();
    loud.reported("readings:");
    let quiet = super::run(format!("{RUN} --quiet").split(' ')).done();
    assert_eq!(quiet.err, "");
    assert_eq!(quiet.out.lines().count(), loud.out.lines().count());
    let failed = super::run(["-q", "layout", "check", "nowhere.ron"]);
    failed.reported("there is no such file");
}

#[test]
fn a_log_has_all_messages_with_their_time_and_is_private() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ademan.log");
    let line = format!("{RUN} -q --log {}", text(&path));
    for runs in 1..=2 {
        super::run(line.split(' ')).done();
        let log = fs::read_to_string(&path).unwrap();
        let stats = log.lines().filter(|entry| entry.contains("readings:"));
        assert_eq!(stats.count(), runs, "{log}");
        let has_time = |entry: &str| entry.starts_with("20") && entry[19..].starts_with("Z ");
        assert!(log.lines().all(has_time), "{log}");
        assert!(!log.contains("down"), "{log}");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let mode = fs::metadata(&path).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        let link = folder.path().join("link.log");
        symlink(&path, &link).unwrap();
        let ended = super::run(format!("{RUN} --log {}", text(&link)).split(' ')).exited(2);
        ended.reported("this is a symbolic link");
    }
}

#[test]
fn a_log_is_a_regular_file() {
    if !std::path::Path::new("/dev/full").exists() {
        println!("SKIPPED: there is no /dev/full here");
        return;
    }
    let ended = super::run(format!("{RUN} --log /dev/full").split(' '));
    ended.reported("not a regular file but a device");
}

#[test]
fn rust_log_is_honoured_and_an_invalid_one_is_reported() {
    let home = tempfile::tempdir().unwrap();
    fs::write(
        home.path().join("media.ron"),
        ademan::layout::Layout::load("media").unwrap().text,
    )
    .unwrap();
    let reported = |log: &str, flags: &str| {
        let line = format!("{flags}layout check media");
        let mut command = ademan(line.split(' '));
        command.env("RUST_LOG", log).current_dir(home.path());
        let ended = run_to_end(&mut command).done();
        ended.err.contains("comes with the program")
    };
    assert!(reported("", "") && reported("info", ""));
    assert!(!reported("warn", "") && !reported("ademan_runtime::files=off,info", ""));
    assert!(reported("warn", "-v "), "a flag precedes the variable");
    let ended = run_with("ademan=loud", "layouts").done();
    ended.reported("RUST_LOG has no effect");
}
