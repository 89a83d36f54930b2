//! A line that is not what the program expects: in use, not allowed, noisy, or of a board that starts anew.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use super::line::{PseudoTerminal, SerialRun};
use crate::support::binary::ademan;
use crate::support::press::Press;
use crate::support::wearer::stream;

#[test]
fn a_second_run_on_the_same_port_is_refused_at_once_and_the_first_goes_on() {
    let mut line = PseudoTerminal::plugged_in();
    let press = Press::for_text("h");
    let mut first = SerialRun::on(&line, &["--armed", "--control", "off"]);
    let source = line.source();
    let second = ademan(["run", "--source", &source, "--control", "off"])
        .env_remove("XDG_RUNTIME_DIR")
        .output()
        .expect("it starts");
    let err = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(2), "{err}");
    assert!(err.contains("in use by another program"), "{err}");
    assert_eq!(err.lines().count(), 1, "said once: {err}");
    line.play(&press.approach);
    line.play(&press.lift);
    assert_eq!([first.typed(), first.typed()], ["down H", "up H"]);

    // A run that is killed keeps no lock.
    first.program.0.kill().expect("it runs");
    first.program.0.wait().expect("it ends");
    let mut third = SerialRun::on(&line, &["--control", "off"]);
    assert_eq!(third.end(), Some(0));
}

#[test]
fn a_port_that_may_not_be_opened_names_the_group_and_never_asks_for_root() {
    const NOBODY: u32 = 65_534;
    let line = PseudoTerminal::plugged_in();
    let device = line.folder.path().join("glove");
    fs::set_permissions(&device, Permissions::from_mode(0o000)).expect("the terminal is ours");
    fs::set_permissions(line.folder.path(), Permissions::from_mode(0o755)).expect("it is ours");
    // A copy where everybody gets at it.
    let program = line.folder.path().join("ademan");
    fs::copy(env!("CARGO_BIN_EXE_ademan"), &program).expect("there is room");
    let run = |command: &mut Command| {
        let arguments = ["run", "--control", "off", "--source", &line.source()];
        command
            .args(arguments)
            .env_remove("XDG_RUNTIME_DIR")
            .output()
    };
    // Root may open everything: somebody else tries.
    let ended = match run(Command::new(&program).uid(NOBODY).gid(NOBODY)) {
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {
            run(&mut Command::new(&program))
        }
        ended => ended,
    };
    let ended = ended.expect("it starts");
    let err = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{err}");
    for word in ["usermod --append --groups", "$USER"] {
        assert!(err.contains(word), "{err}");
    }
    assert!(!err.contains("as root"), "{err}");
}

#[test]
fn a_minute_of_noise_at_the_wrong_baud_types_nothing_says_so_and_takes_no_memory() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::plugged_in();
    let mut run = SerialRun::on(&line, &["--armed", "--control", "off"]);
    let glove = stream(&[&press.approach[..], &press.lift[..]].concat());
    let heard = [
        misheard(&glove, 9_600, 115_200),
        misheard(&glove, 115_200, 9_600),
        misheard(&glove, 57_600, 115_200),
    ];
    let mut random = fastrand::Rng::with_seed(12);
    let mut sent = 0;
    let start = Instant::now();
    let mut memory = None;
    // As much as comes in a minute, and for longer than it takes to be noticed.
    while sent < 60 * 115_200 / 10 || start.elapsed() < Duration::from_secs(3) {
        let noise: Vec<u8> = (0..8_192).map(|_| random.u8(..)).collect();
        for bytes in heard.iter().chain([&noise]) {
            line.send(bytes);
            sent += bytes.len();
        }
        if sent > 100_000 {
            memory.get_or_insert_with(|| run.memory());
        }
        thread::sleep(Duration::from_millis(5));
    }
    let before = memory.expect("there was enough of it");
    let growth = run.memory().saturating_sub(before);
    assert!(growth < 2_048, "{growth} KiB more than before");
    run.wait_until_told("no valid packet");
    assert_eq!(run.end(), Some(0));
    let account = run.wait_until_told("readings:");
    assert!(account.starts_with("0 readings: 0 accepted"), "{account}");
    assert!(account.contains("bytes belonged to no frame"), "{account}");
    println!("{sent} bytes of noise: {account}");
    assert!(run.typed.is_empty(), "nothing was typed");
}

#[test]
fn bytes_without_a_delimiter_take_no_memory_and_the_glove_is_understood_after_them() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::plugged_in();
    let mut run = SerialRun::on(&line, &["--armed", "--control", "off"]);
    line.send(&[0x55; 100_000]);
    let before = run.memory();
    for _ in 0..40 {
        line.send(&[0x55; 100_000]);
    }
    let growth = run.memory().saturating_sub(before);
    assert!(growth < 2_048, "{growth} KiB more than before");
    line.play(&press.approach);
    line.play(&press.lift);
    assert_eq!([run.typed(), run.typed()], ["down H", "up H"]);
    assert_eq!(run.end(), Some(0));
    let account = run.wait_until_told("belonged to no frame");
    assert!(account.contains(" 4100000 of "), "{account}");
}

#[test]
fn a_board_that_starts_anew_lets_go_and_has_to_be_armed_again() {
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::plugged_in();
    let mut run = SerialRun::on(&line, &["--armed", "--control", "off"]);
    line.play(&press.approach);
    assert_eq!(run.typed(), "down H");
    // In the middle of a frame it resets, and says who it is.
    line.send(&stream(&[press.pressed()])[..30]);
    line.send(b"\r\nBUFFALO 3.4 (ext) - Bit User Fast Friendly Aid to Logical Operation\r\n");
    line.play(&[press.pressed(); 20]);
    assert_eq!(run.typed(), "up H");
    run.wait_until_told("starts anew");
    run.wait_until_told("stalled");
    line.play(&[press.pressed(); 60]);
    assert!(run.typed.is_empty(), "the finger has not left the key");
    line.play(&press.lift);
    line.play(&[press.clear(); 60]);
    run.wait_until_told("armed");
    line.play(&press.approach);
    assert_eq!(run.typed(), "down H");
    assert_eq!(run.end(), Some(0));
}

#[test]
fn a_wire_that_breaks_is_told_with_its_finger() {
    const INDEX_MCP: usize = 12;
    let press = Press::for_text("h");
    let mut line = PseudoTerminal::plugged_in();
    let mut run = SerialRun::on(&line, &["--armed", "--control", "off"]);
    line.play(&press.approach);
    assert_eq!(run.typed(), "down H");
    let mut broken = press.pressed();
    broken[INDEX_MCP] = 0;
    line.play(&[broken; 240]);
    assert_eq!(run.typed(), "up H");
    let told = run.wait_until_told("ignored and released");
    assert!(told.contains("released: index;"), "{told}");
    assert_eq!(run.end(), Some(0));
}

/// What is heard of bytes that are sent at one baud and heard at another, bit by bit: a start bit, eight bits, the
/// lowest first, a stop bit; a receiver samples the middle of each of its bits.
fn misheard(bytes: &[u8], sent_at: u32, heard_at: u32) -> Vec<u8> {
    let bits: Vec<bool> = bytes
        .iter()
        .flat_map(|byte| {
            let data = (0..8).map(move |place| byte >> place & 1 == 1);
            std::iter::once(false).chain(data).chain([true])
        })
        .collect();
    let bit_time = f64::from(sent_at) / f64::from(heard_at);
    let level = |time: f64| bits.get(time as usize).copied().unwrap_or(true);
    let (mut heard, mut time) = (Vec::new(), 0.0);
    while (time as usize) < bits.len() {
        if level(time) {
            time += bit_time / 8.0;
            continue;
        }
        let sample = |place: u8| level(time + (f64::from(place) + 1.5) * bit_time);
        heard.push((0..8).map(|place| u8::from(sample(place)) << place).sum());
        time += 9.5 * bit_time;
        while (time as usize) < bits.len() && !level(time) {
            time += bit_time / 8.0;
        }
    }
    heard
}

#[test]
fn what_is_heard_at_the_right_baud_is_what_was_sent() {
    let bytes: Vec<u8> = (0..=255).collect();
    assert_eq!(misheard(&bytes, 9_600, 9_600), bytes);
    assert_ne!(misheard(&bytes, 9_600, 115_200), bytes);
}
