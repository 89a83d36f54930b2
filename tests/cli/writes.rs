//! System calls of the transcript.

use std::os::fd::OwnedFd;
use std::os::unix::net::UnixDatagram;
use std::process::Stdio;
use std::time::Duration;

use crate::ademan;

/// Time stamps of the lines of one write.
fn times(write: &[u8]) -> Vec<String> {
    let text = String::from_utf8(write.to_vec()).expect("a transcript is text");
    assert!(text.ends_with('\n'), "whole lines: {text:?}");
    let time = |line: &str| line.split_whitespace().next().map(str::to_owned);
    text.lines().filter_map(time).collect()
}

#[test]
fn all_events_of_a_step_are_written_by_one_system_call() {
    // A datagram socket keeps the boundaries of writes.
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
    // The command holds a copy of the writer, which would keep the socket open.
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
    let steps: Vec<_> = writes.iter().map(|times| &times[0]).collect();
    assert!(
        steps.windows(2).all(|pair| pair[0] != pair[1]),
        "one write per step: {steps:?}"
    );
    for times in &writes {
        assert!(
            times.iter().all(|time| *time == times[0]),
            "one step per write: {times:?}"
        );
    }
    // Shift is pressed in the same step as the key.
    assert!(
        writes.iter().any(|times| times.len() > 1),
        "some steps have several events: {writes:?}"
    );
}
