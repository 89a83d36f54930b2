//! How the program hands over what it types.

use std::os::fd::OwnedFd;
use std::os::unix::net::UnixDatagram;
use std::process::Stdio;
use std::time::Duration;

use crate::ademan;
/// The times at the beginnings of the lines of a write.
fn times(write: &[u8]) -> Vec<String> {
    let text = String::from_utf8(write.to_vec()).expect("it is text");
    assert!(text.ends_with('\n'), "whole lines: {text:?}");
    let time = |line: &str| line.split_whitespace().next().map(str::to_owned);
    text.lines().filter_map(time).collect()
}

#[test]
fn all_that_a_frame_types_is_written_by_one_system_call() {
    // Each write is a message of its own here.
    let (reader, writer) = UnixDatagram::pair().unwrap();
    reader
        .set_read_timeout(Some(Duration::from_millis(100)))
        .unwrap();
    let mut command = ademan([
        "run",
        "--armed",
        "--source",
        "typist:H?",
        "--output",
        "transcript",
    ]);
    command.stdout(OwnedFd::from(writer)).stderr(Stdio::null());
    let mut program = command.spawn().expect("it starts");
    // What it has of the writer would keep the line open.
    drop(command);
    let mut writes = Vec::new();
    let mut buffer = [0; 4096];
    loop {
        match reader.recv(&mut buffer) {
            Ok(0) => break,
            Ok(length) => writes.push(times(&buffer[..length])),
            Err(_) if program.try_wait().unwrap().is_some() => break,
            Err(_) => {}
        }
    }
    println!("{writes:?}");
    let frames: Vec<_> = writes.iter().map(|times| &times[0]).collect();
    assert!(
        frames.windows(2).all(|pair| pair[0] != pair[1]),
        "one write for a frame: {frames:?}"
    );
    for times in &writes {
        assert!(
            times.iter().all(|time| *time == times[0]),
            "one frame for a write: {times:?}"
        );
    }
    // Shift goes down with the key that needs it.
    assert!(
        writes.iter().any(|times| times.len() > 1),
        "frames of several events: {writes:?}"
    );
}
