//! Faults of a serial line: in use, without permission, noisy, or with a microcontroller that restarts.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::limit_descriptors;
use super::line::{PseudoTerminal, SerialRun};
use crate::support::binary::{ademan, copy_binary};
use crate::support::glove::Glove;
use crate::support::press::Press;
use crate::support::run::{TIMEOUT, start_with_lines};
use crate::support::wearer::packets;
use crate::{Ended, run};

#[test]
fn a_second_run_on_the_same_port_is_refused_at_once_and_the_first_goes_on() {
    let mut line = PseudoTerminal::open();
    let press = Press::for_text("h");
    let mut first = SerialRun::start(&line, &["--armed", "--control", "off"]);
    let source = line.source();
    let second = run(["run", "--source", &source, "--control", "off"]).exited(2);
    second.reported("in use by another program");
    assert_eq!(second.err.lines().count(), 1, "one message: {}", second.err);
    line.play(&press.approach);
    line.play(&press.lift);
    assert_eq!([first.next_event(), first.next_event()], ["down H", "up H"]);

    // A killed process keeps no lock.
    first.program.0.kill().expect("the process runs");
    first.program.0.wait().expect("the process ends");
    let mut third = SerialRun::start(&line, &["--control", "off"]);
    assert_eq!(third.end(), Some(0));
}

#[test]
fn a_port_without_permission_names_the_group_and_never_asks_for_root() {
    const NOBODY: u32 = 65_534;
    let line = PseudoTerminal::open();
    let device = line.folder.path().join("glove");
    fs::set_permissions(&device, Permissions::from_mode(0o000))
        .expect("the test owns the terminal");
    fs::set_permissions(line.folder.path(), Permissions::from_mode(0o755))
        .expect("the test owns the folder");
    // A copy that every user may run.
    let program = line.folder.path().join("ademan");
    copy_binary(&program);
    let run = |command: &mut Command| {
        let arguments = ["run", "--control", "off", "--source", &line.source()];
        command
            .args(arguments)
            .env_remove("XDG_RUNTIME_DIR")
            .output()
    };
    // Root may open everything, so another user tries.
    let ended = match run(Command::new(&program).uid(NOBODY).gid(NOBODY)) {
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {
            run(&mut Command::new(&program))
        }
        ended => ended,
    };
    let ended = Ended::from(ended.expect("the program starts")).exited(2);
    for word in ["usermod --append --groups", "$USER"] {
        ended.reported(word);
    }
    assert!(!ended.err.contains("as root"), "{}", ended.err);
}

#[test]
fn a_minute_of_noise_at_the_wrong_baud_types_nothing_is_reported_and_needs_no_memory() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::open();
    let mut run = SerialRun::start(&line, &["--armed", "--control", "off"]);
    let glove = packets(&[&press.approach[..], &press.lift[..]].concat());
    let received = [
        received_at(&glove, 9_600, 115_200),
        received_at(&glove, 115_200, 9_600),
        received_at(&glove, 57_600, 115_200),
    ];
    let mut random = fastrand::Rng::with_seed(12);
    let mut sent = 0;
    let start = Instant::now();
    let (mut memory, mut is_reported) = (None, false);
    // The bytes of a minute, and more until the warning: a busy machine reads late.
    while sent < 60 * 115_200 / 10 || !is_reported {
        assert!(start.elapsed() < TIMEOUT, "no warning of packets");
        is_reported |= run
            .messages
            .try_iter()
            .any(|message| message.contains("no valid packet"));
        let noise: Vec<u8> = (0..8_192).map(|_| random.u8(..)).collect();
        for bytes in received.iter().chain([&noise]) {
            line.send(bytes);
            sent += bytes.len();
        }
        if sent > 100_000 {
            memory.get_or_insert_with(|| run.memory());
        }
        thread::sleep(Duration::from_millis(5));
    }
    let before = memory.expect("enough noise");
    let growth = run.memory().saturating_sub(before);
    assert!(growth < 2_048, "memory grows by {growth} KiB");
    assert_eq!(run.end(), Some(1), "nothing was understood");
    let stats = run.wait_for_message("readings:");
    assert!(stats.starts_with("0 readings: 0 accepted"), "{stats}");
    assert!(stats.contains("bytes belonged to no packet"), "{stats}");
    println!("{sent} bytes of noise: {stats}");
    // Up to the end of the stream.
    assert_eq!(run.events.iter().next(), None);
}

#[test]
fn bytes_without_a_delimiter_need_no_memory_and_the_packets_after_them_are_decoded() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::open();
    let mut run = SerialRun::start(&line, &["--armed", "--control", "off"]);
    line.send(&[0x55; 100_000]);
    let before = run.memory();
    for _ in 0..40 {
        line.send(&[0x55; 100_000]);
    }
    let growth = run.memory().saturating_sub(before);
    assert!(growth < 2_048, "memory grows by {growth} KiB");
    line.play(&press.approach);
    line.play(&press.lift);
    assert_eq!([run.next_event(), run.next_event()], ["down H", "up H"]);
    assert_eq!(run.end(), Some(0));
    let stats = run.wait_for_message("belonged to no packet");
    assert!(stats.contains(" 4100000 of "), "{stats}");
}

#[test]
fn a_microcontroller_restart_releases_everything_and_disarms() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::open();
    let mut run = SerialRun::start(&line, &["--armed", "--control", "off"]);
    line.play(&press.approach);
    assert_eq!(run.next_event(), "down H");
    // It restarts in the middle of a packet, and sends its banner.
    line.send(&packets(&[press.pressed()])[..30]);
    line.send(b"\r\nBUFFALO 3.4 (ext) - Bit User Fast Friendly Aid to Logical Operation\r\n");
    line.play(&[press.pressed(); 20]);
    assert_eq!(run.next_event(), "up H");
    run.wait_for_message("it sent text, as a board does that restarts");
    run.wait_for_message("stalled");
    line.play(&[press.pressed(); 60]);
    assert!(run.events.is_empty(), "the finger has not left the key");
    line.play(&press.lift);
    line.play(&[press.clear(); 60]);
    run.wait_for_message("armed");
    line.play(&press.approach);
    assert_eq!(run.next_event(), "down H");
    assert_eq!(run.end(), Some(0));
}

#[test]
fn a_broken_wire_is_reported_with_its_finger() {
    const INDEX_MCP: usize = 12;
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::open();
    let mut run = SerialRun::start(&line, &["--armed", "--control", "off"]);
    line.play(&press.approach);
    assert_eq!(run.next_event(), "down H");
    let mut broken = press.pressed();
    broken[INDEX_MCP] = 0;
    line.play(&[broken; 240]);
    assert_eq!(run.next_event(), "up H");
    let message = run.wait_for_message("ignored and released");
    assert!(message.contains("released: index;"), "{message}");
    assert_eq!(run.end(), Some(0));
}

/// Returns the bytes that a receiver at one baud rate makes of bytes sent at another: a start bit, eight data bits, the
/// lowest first, and a stop bit, each sampled in its middle.
fn received_at(bytes: &[u8], sender_baud: u32, receiver_baud: u32) -> Vec<u8> {
    let bits: Vec<bool> = bytes
        .iter()
        .flat_map(|byte| {
            let data = (0..8).map(move |bit| byte >> bit & 1 == 1);
            std::iter::once(false).chain(data).chain([true])
        })
        .collect();
    let bit_time = f64::from(sender_baud) / f64::from(receiver_baud);
    let level = |time: f64| bits.get(time as usize).copied().unwrap_or(true);
    let (mut received, mut time) = (Vec::new(), 0.0);
    while (time as usize) < bits.len() {
        if level(time) {
            time += bit_time / 8.0;
            continue;
        }
        let sample = |bit: u8| level(time + (f64::from(bit) + 1.5) * bit_time);
        received.push((0..8).map(|bit| u8::from(sample(bit)) << bit).sum());
        time += 9.5 * bit_time;
        while (time as usize) < bits.len() && !level(time) {
            time += bit_time / 8.0;
        }
    }
    received
}

#[test]
fn at_the_right_baud_the_received_bytes_are_the_sent_ones() {
    let bytes: Vec<u8> = (0..=255).collect();
    assert_eq!(received_at(&bytes, 9_600, 9_600), bytes);
    assert_ne!(received_at(&bytes, 9_600, 115_200), bytes);
}

#[test]
fn a_glove_that_is_lost_while_no_file_descriptor_is_free_types_again_once_there_are_some() {
    let folder = tempfile::tempdir().expect("a folder");
    let port = folder.path().join("glove");
    let setup = folder.path().join("setup.ron");
    fs::write(&setup, "Setup(stall_timeout_ms: 10000)").expect("a file");
    let press = Press::for_text("h");
    let mut glove = Glove::plug_in(&port, press.clear());
    let source = format!("serial:{}", port.display());
    let setup = setup.to_str().expect("a plain path");
    let mut command = ademan(["run", setup, "--source", &source, "--control", "off", "-vv"]);
    command.env_remove("XDG_RUNTIME_DIR").stdin(Stdio::null());
    let (program, events, messages) = start_with_lines(&mut command);
    let mut run = SerialRun {
        program,
        events,
        messages,
    };
    run.wait_for_message("armed: ");
    // Standard input, output and error have the numbers below it.
    limit_descriptors(run.program.0.id(), 3);
    glove.unplug();
    run.wait_for_message("cannot list the serial ports: Too many open files");
    limit_descriptors(run.program.0.id(), 256);
    let replugged = Glove::plug_in(&port, press.clear());
    run.wait_for_message("reconnected to");
    run.wait_for_message("armed: ");
    replugged.play(&[&press.approach[..], &press.lift[..]].concat());
    assert_eq!([run.next_event(), run.next_event()], ["down H", "up H"]);
    assert_eq!(run.end(), Some(0));
}
