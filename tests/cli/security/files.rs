//! Files that are pipes or devices, that belong to another user, or that others can read.

use std::ffi::OsStr;
use std::fs::{self, Permissions};
use std::io::{Read, Write};
use std::net::Shutdown;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::Stdio;
use std::thread;

use rustix::fs::{CWD, Mode};
use rustix::thread::set_thread_res_uid;

use super::strangers::{NOBODY, give_away};
use crate::support::process::Process;
use crate::support::run::{Run, TIMEOUT};
use crate::{Ended, ademan};

/// Runs the program in a folder. Fails if it does not end.
fn run_in(folder: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Ended {
    let mut command = ademan(arguments);
    command
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    println!("{command:?}");
    let mut process = Process::start(&mut command).expect("it starts");
    let code = process.wait_for_exit().code();
    let mut err = String::new();
    let mut stderr = process.0.stderr.take().expect("it is piped");
    stderr.read_to_string(&mut err).expect("UTF-8");
    let out = String::new();
    Ended { code, out, err }
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).expect("it exists").permissions().mode() & 0o777
}

#[test]
fn a_pipe_or_a_device_is_refused_as_any_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for pipe in ["pipe", "lock.lock"] {
        let mode = Mode::RUSR | Mode::WUSR;
        rustix::fs::mkfifoat(CWD, path(pipe), mode).expect("the file system has pipes");
    }
    fs::write(path("setup.ron"), "Setup(layout: \"./pipe\")").expect("space");
    let typist = ["--source", "typist:hi"];
    let with = |first: &[&'static str], last: &[&'static str]| [first, &typist, last].concat();
    let cases = [
        vec!["layout", "check", "./pipe"],
        vec!["layout", "check", "/dev/zero"],
        vec!["run", "./pipe"],
        with(&["run", "setup.ron"], &[]),
        with(&["run"], &["--layout", "./pipe"]),
        with(&["run"], &["--glove", "./pipe"]),
        vec!["demo", "--script", "pipe"],
        vec!["run", "--source", "script:pipe"],
        vec!["replay", "pipe"],
        vec!["run", "--source", "file:pipe"],
        with(&["run"], &["--output", "transcript:pipe"]),
        with(&["run"], &["--output", "transcript:/dev/null"]),
        with(&["run"], &["--output", "none", "--record", "pipe"]),
        with(&["run"], &["--control", "lock"]),
        vec!["text", "build", "--words", "pipe", "-o", "my.adm"],
        vec!["text", "decode", "pipe"],
    ];
    for arguments in cases {
        let ended = run_in(folder.path(), &arguments);
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.err);
        let reason = "not a regular file but a ";
        assert!(ended.err.contains(reason), "{arguments:?}: {}", ended.err);
    }
}

/// A pipe whose other end is open delays nothing, and would be filled with what is typed.
#[test]
fn a_transcript_is_not_written_to_a_pipe_that_somebody_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("pipe");
    rustix::fs::mkfifoat(CWD, &pipe, Mode::RUSR | Mode::WUSR).expect("the file system has pipes");
    let _both_ends = fs::File::options().read(true).write(true).open(&pipe);
    let arguments = [
        "run",
        "--source",
        "typist:hi",
        "--output",
        "transcript:pipe",
    ];
    let ended = run_in(folder.path(), arguments).exited(2);
    ended.reported("but a pipe");
}

#[test]
fn an_existing_transcript_becomes_private_and_links_and_files_of_others_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let transcript = |name: &str| {
        let output = format!("transcript:{name}");
        let arguments = ["run", "--source", "typist:hi", "--output", &output];
        run_in(folder.path(), arguments)
    };
    transcript("own").done();
    assert_eq!(mode(&path("own")), 0o600);
    let text = fs::read_to_string(path("own")).expect("a transcript");
    assert!(text.contains("down H"), "{text}");

    let refused = |name: &str, reason: &str, untouched: &str| {
        fs::write(path(untouched), "theirs").expect("space");
        let ended = transcript(name).exited(2);
        ended.reported(reason);
        let kept = fs::read_to_string(path(untouched)).expect("it exists");
        assert_eq!(kept, "theirs", "{name}");
    };
    refused("own", "the file exists; choose another name", "own");
    fs::write(path("target"), "").expect("space");
    symlink(path("target"), path("link")).expect("the file system has links");
    refused("link", "a symbolic link, name the file itself", "target");
    symlink(path("absent"), path("dangling")).expect("the file system has links");
    assert_eq!(transcript("dangling").code, Some(2));
    assert!(!path("absent").exists());
    fs::hard_link(path("target"), path("name")).expect("the file system has links");
    refused("name", "the file exists", "target");
}

#[test]
fn a_layout_of_another_user_is_not_saved() {
    let run = Run::with_held_key(&["--control", "c.sock"]);
    let layout = run.path();
    let before = fs::read(&layout).expect("it exists");
    if !give_away(&layout, Some(NOBODY), None) {
        return;
    }
    let ctl = |arguments: &[&str]| {
        let arguments = [&["ctl", "--socket", "c.sock"], arguments].concat();
        run_in(run.folder.path(), arguments)
    };
    ctl(&["nudge", "0", "0", "-5"]).done();
    let ended = ctl(&["save"]).exited(1);
    ended.reported("belongs to another user");
    assert_eq!(fs::read(&layout).expect("it exists"), before);
}

#[test]
fn a_server_of_another_user_gets_no_command() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::set_permissions(folder.path(), Permissions::from_mode(0o777)).expect("an own folder");
    let path = folder.path().join("c.sock");
    let bound = path.clone();
    // The kernel keeps the user of the thread that listens.
    let listening = thread::spawn(move || {
        let nobody = rustix::fs::Uid::from_raw(NOBODY);
        set_thread_res_uid(nobody, nobody, nobody).ok()?;
        UnixListener::bind(bound).ok()
    });
    let Some(listener) = listening.join().expect("no panic") else {
        println!("SKIPPED: only root can be another user");
        return;
    };
    let server = thread::spawn(move || {
        let (mut client, _) = listener.accept().expect("a client");
        client.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        let mut request = vec![0; 64];
        let length = client.read(&mut request).unwrap_or(0);
        let _ = client.write_all(b"{\"ok\":true}\n");
        let _ = client.shutdown(Shutdown::Both);
        request.truncate(length);
        request
    });
    let ended = run_in(folder.path(), ["ctl", "pause", "--socket", "c.sock"]).exited(2);
    ended.reported("belongs to another user");
    // A program that does not even connect leaves the server waiting.
    drop(UnixStream::connect(&path));
    assert_eq!(server.join().expect("no panic"), [0; 0], "no request");
}
